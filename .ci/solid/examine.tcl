# What OpenCASCADE finds in the STEP file that STEPFILE names; gate.py judges it. The search for crossings takes most of the
# time and runs where CROSSINGS is set.
pload MODELING
pload XSDRAW
catch {stepread $::env(STEPFILE) s *} read
puts "READ\n$read"
foreach shape [directory s_*] {
    puts "SHAPE $shape"
    puts [nbshapes $shape]
    puts [checkshape $shape]
    puts [maxtolerance $shape]
    puts [vprops $shape 1e-9 -full]
    freebounds $shape 1e-7
    foreach bounds [list ${shape}_o ${shape}_c] { puts "FREE\n[nbshapes $bounds]" }
    if {[info exists ::env(CROSSINGS)]} { puts [bopargcheck $shape] }
    foreach face [explode $shape f] {
        mksurface surface $face
        puts "KIND [lindex [split [dump surface] \n] 3]"
    }
}
exit
