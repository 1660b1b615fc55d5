//! What roughing must leave as the lathe made it, on wheels whose channels end in other ways than those of compressors.

use crate::support::bounded;

/// A part with one roughing of one sector; the verdict, and what was said.
fn roughed(part: &str, tools: [&str; 2], steps: &str, stock: &str) -> (bool, String) {
    let folder = tempfile::tempdir().unwrap();
    let job = format!(
        "edition 2026\nuse machine \"generic-ac-table\"\nuse tools \"five-axis\"\n{part}\n{stock}\ntool t1 = \"{}\"\ntool t2 = \"{}\"\n\
         operation rough {{ tools t1, t2  speed 15000 rpm  {steps} \
         allowance vane 0.2 mm, hub 0.2 mm  lead-in 1.5 mm  lead-out 1.5 mm  sectors 1 }}\nrequire gouge <= 5 um\npost siemens-840d\n",
        tools[0], tools[1]
    );
    std::fs::write(folder.path().join("wheel.imp"), job).unwrap();
    let run = bounded::program().current_dir(folder.path()).args(["wheel.imp", "-o", "wheel.nc"]).output().unwrap();
    let said = String::from_utf8_lossy(&run.stdout).into_owned() + &String::from_utf8_lossy(&run.stderr);
    (run.status.success(), said)
}

/// Feeds and steps for balls from 3 mm on, and for those of 2 mm.
const COARSE: &str = "feed 1500 mm/min  link-feed 1500 mm/min  depth 0.9 mm  stepover 1.2 mm";
const FINE: &str = "feed 500 mm/min  link-feed 500 mm/min  depth 0.6 mm  stepover 0.8 mm";

/// The channels of an axial rotor end over a rim: lines that run on behind the blades went 83 um into it.
#[test]
fn lines_of_an_axial_rotor_keep_off_its_rim() {
    let part = "part rotor { vanes 12
        hub revolve spline [(18, 0, 2) (18, 0, -20)] mm
        shroud revolve spline [(30, 0, 2) (30, 0, -20)] mm
        vane main { beta-from meridian
            span 0 % { beta [(0 %, 35 deg) (100 %, 22 deg)] start 0 deg thickness [(0 %, 0.6 mm) (40 %, 1.8 mm) (100 %, 0.5 mm)] }
            span 100 % { beta [(0 %, 50 deg) (100 %, 44 deg)] start 0 deg thickness [(0 %, 0.5 mm) (40 %, 1.2 mm) (100 %, 0.4 mm)] }
            from 20 % to 85 % leading-edge elliptic 2 trailing-edge round fillet 1.2 mm } }";
    let stock = "stock turned { over shroud 0 mm bore 0 mm back -27 mm clamping { below -27 mm diameter 31 mm } }";
    let (holds, said) = roughed(part, ["ball-6x50", "ball-3x30"], COARSE, stock);
    assert!(holds, "{said}");
}

/// The channels of a turbine run inward. At the rim its blades stand upright: the axes leaned inward there, through the pole.
#[test]
fn axes_of_a_turbine_keep_off_the_pole() {
    let part = "part turbine { vanes 11
        hub revolve spline [(25, 0, -17) (20, 0, -16.6) (15, 0, -15) (11, 0, -11.5) (8.6, 0, -6.5) (7.4, 0, -2) (7, 0, 0)] mm
        shroud revolve spline [(25, 0, -12) (21.5, 0, -11.4) (18.7, 0, -9.5) (17, 0, -6.5) (16.3, 0, -3) (16, 0, 0)] mm
        vane main { beta-from meridian
            span 0 % { beta [(0 %, 0 deg) (50 %, -10 deg) (100 %, -36 deg)] start 0 deg thickness [(0 %, 1.4 mm) (50 %, 1.3 mm) (100 %, 0.9 mm)] }
            span 100 % { beta [(0 %, 0 deg) (50 %, -20 deg) (100 %, -56 deg)] start 0 deg thickness [(0 %, 1.2 mm) (50 %, 1 mm) (100 %, 0.6 mm)] }
            from hub 0.8 mm, shroud 0.6 mm leading-edge elliptic 2 trailing-edge cut-off pressure clockwise fillet 0.85 mm } }";
    let stock = "stock turned { over shroud 0 mm bore 0 mm back -22 mm clamping { below -22 mm diameter 24 mm } }";
    let (holds, said) = roughed(part, ["ball-4x40", "ball-2x24"], FINE, stock);
    assert!(holds, "{said}");
}

/// An inducer whose blades lean back needs axes near the travel of the table, and lines that end in the middle of its blank.
#[test]
fn an_inducer_is_roughed_within_the_travel() {
    let part = "part inducer { vanes 3
        hub revolve spline [(4.5, 0, 2) (4.8, 0, -5) (5.4, 0, -12) (6.2, 0, -18) (7, 0, -24)] mm
        shroud revolve spline [(15, 0, 2) (15, 0, -24)] mm
        vane main {
            span 0 % { theta [(0 %, 0 deg) (100 %, 170 deg)] thickness [(0 %, 1.2 mm) (30 %, 2 mm) (100 %, 1.4 mm)] }
            span 100 % { theta [(0 %, 20 deg) (100 %, 170 deg)] thickness [(0 %, 0.8 mm) (30 %, 1.2 mm) (100 %, 0.9 mm)] }
            from hub 3 mm, shroud 6 mm to hub 90 %, shroud 88 %
            leading-edge elliptic 3 trailing-edge round pressure clockwise fillet 1.3 mm } }";
    let stock = "stock turned { over shroud 0 mm bore 0 mm back -39 mm clamping { below -39 mm diameter 16 mm } }";
    let (holds, said) = roughed(part, ["ball-4x40", "ball-3x30"], COARSE, stock);
    assert!(holds, "{said}");
}

/// Edges that begin far behind the inlet of the hub, with blades at a slant: the channel went straight on before them, off the hub, and
/// the second ball met 21 mm of stock.
#[test]
fn roughing_follows_the_hub_before_edges_far_behind_its_inlet() {
    let part = "part pump { vanes 6
        hub revolve spline [(28, 0, 0) (30, 0, -14) (38, 0, -28) (52, 0, -38) (75, 0, -43) (104.5, 0, -44)] mm
        shroud revolve spline [(56, 0, 0) (57, 0, -6) (61, 0, -13) (70, 0, -19.5) (85, 0, -25) (104.5, 0, -28)] mm
        vane main { beta-from meridian
            span 0 % { beta [(0 %, -58 deg) (50 %, -60 deg) (100 %, -64 deg)] end 0 deg thickness [(0 %, 3 mm) (40 %, 6 mm) (100 %, 5 mm)] }
            span 100 % { beta [(0 %, -66 deg) (50 %, -65 deg) (100 %, -64 deg)] end 0 deg thickness [(0 %, 3 mm) (40 %, 5 mm) (100 %, 4 mm)] }
            from hub 38 %, shroud 12 % leading-edge elliptic 2 trailing-edge cut-off fillet 4.2 mm } }";
    let stock = "stock turned { over shroud 0 mm bore 0 mm back -65 mm clamping { below -65 mm diameter 105 mm } }";
    let steps = "feed 4000 mm/min  link-feed 4000 mm/min  depth 5 mm, 2.6 mm  stepover 6 mm, 3.2 mm";
    let (holds, said) = roughed(part, ["ball-16x110", "ball-8x60"], steps, stock);
    assert!(holds, "{said}");
}

/// Two passes of this wheel come to the same place of the clearance surface from different heights: the rapid between them had a time
/// of 1e-16 s, and the program 82 h.
#[test]
fn no_rapid_has_the_length_of_rounding() {
    let part = "part blower { vanes 12
        hub revolve spline [(55, 0, -30) (62, 0, -42) (80, 0, -52) (110, 0, -57) (150, 0, -60)] mm
        shroud revolve spline [(85, 0, 0) (87, 0, -8) (95, 0, -17) (115, 0, -26) (150, 0, -32)] mm
        vane main { beta-from meridian
            span 0 % { beta [(0 %, 55 deg) (50 %, 50 deg) (100 %, 48 deg)] end 0 deg thickness 5 mm }
            span 100 % { beta [(0 %, 58 deg) (50 %, 52 deg) (100 %, 48 deg)] end 0 deg thickness 3.5 mm }
            from hub 32 %, shroud 16 % leading-edge elliptic 2 trailing-edge cut-off fillet 4.2 mm } }";
    let stock = "stock turned { over shroud 0 mm bore 0 mm back -91 mm clamping { below -91 mm diameter 150 mm } }";
    let steps = "feed 4000 mm/min  link-feed 4000 mm/min  depth 5.2 mm, 2.6 mm  stepover 6.4 mm, 3.2 mm";
    let (holds, said) = roughed(part, ["ball-16x110", "ball-8x60"], steps, stock);
    assert!(holds, "{said}");
}
