# What OpenCASCADE finds in the STEP file that STEPFILE names; gate.py judges it. The search for crossings takes most of the
# time and runs where CROSSINGS is set: `all`, or numbers of faces among which it searches.
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
    set faces [explode $shape f]
    if {[info exists ::env(CROSSINGS)]} {
        if {$::env(CROSSINGS) == "all"} {
            puts [bopargcheck $shape]
        } else {
            set chosen {}
            foreach number $::env(CROSSINGS) { lappend chosen [lindex $faces [expr {$number - 1}]] }
            compound {*}$chosen some
            puts [bopargcheck some]
        }
    }
    foreach face $faces {
        mksurface surface $face
        puts "KIND [lindex [split [dump surface] \n] 3]"
    }
}
exit
