//! The command `import`: the part that it writes, and when it writes nothing.

use super::{axial_loop, bladegen, data, rtzt, table, turbogrid};
use crate::support::bounded;
use std::path::Path;
use std::process::Output;

fn folder(files: &[(String, String)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn import(arguments: &[&str], folder: &Path) -> Output {
    bounded::program().current_dir(folder).arg("import").args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// What a part lacks to be a job.
const REST: &str = "stock turned { over shroud 0 mm  bore 10 mm  back -200 mm }
tool t1 = ball { diameter 2 mm  flutes 4  flute 12 mm  reach 25 mm  holder \"er16-mini\" }
operation flank { tool t1  speed 12000 rpm  feed 250 mm/min  faces pressure, suction  sectors 1 }
post siemens-840d
";

/// The part with stock, tool and operation is a program: its blades are modelled from the sections.
fn is_modelled(folder: &Path, name: &str) -> String {
    let job = std::fs::read_to_string(folder.join(name)).unwrap();
    let head = "edition 2026\nuse machine \"5mc850-c\"\nuse tools \"carbide\"\n";
    std::fs::write(folder.join("whole.imp"), job.replace("edition 2026\n", head) + REST).unwrap();
    let run = bounded::program().current_dir(folder).args(["whole.imp", "--emit", "ir"]).output().unwrap();
    assert!(run.status.success(), "{}", text(&run.stderr));
    text(&run.stderr)
}

/// With `--zero top` all points move by one length along Z, and the highest one has the height zero.
#[test]
fn the_zero_of_the_part_is_at_the_top() {
    let folder = folder(&turbogrid::example());
    let heights = |options: &[&str], name: &str| -> (Vec<f64>, String) {
        let job = format!("{name}.imp");
        let arguments = [&["BladeGen.inf", "-o", &job, "--pressure", "greater"], options].concat();
        let run = import(&arguments, folder.path());
        assert!(run.status.success(), "{}", text(&run.stderr));
        let read = |table: &str| std::fs::read_to_string(folder.path().join(format!("{name}.{table}.csv"))).unwrap();
        let lines = ["main", "curves"].map(read).concat();
        let points = lines.lines().filter(|l| !l.starts_with('#'));
        let heights = points.map(|l| l.rsplit(',').next().unwrap().parse().unwrap()).collect();
        (heights, std::fs::read_to_string(folder.path().join(job)).unwrap())
    };
    let (of_file, job) = heights(&["--zero", "file"], "of_file");
    assert!(!job.contains("Moved"), "{job}");
    assert_eq!(of_file, heights(&[], "unstated").0);
    let (at_top, job) = heights(&["--zero", "top"], "at_top");
    assert!(job.contains("// Moved by "), "{job}");
    let highest = |heights: &[f64]| heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!(highest(&of_file).abs() > 0.5, "the example needs no shift: {}", highest(&of_file));
    assert!(highest(&at_top).abs() < 1e-6, "{}", highest(&at_top));
    for (file, top) in of_file.iter().zip(&at_top) {
        assert!((file - highest(&of_file) - top).abs() < 1e-6, "{file} {top}");
    }
}

/// Points that a file repeats, at an edge and at the end of hub and shroud, do not come into the part: `check` takes what the
/// import writes.
#[test]
fn repeated_points_do_not_come_into_the_part() {
    let files: Vec<(String, String)> = turbogrid::example()
        .into_iter()
        .map(|(name, text)| {
            let twice = |(k, line): (usize, &str)| {
                let again = name.ends_with(".curve") && !line.starts_with('#') && k % 40 == 3;
                format!("{line}\n").repeat(if again { 2 } else { 1 })
            };
            let text = text.lines().enumerate().map(twice).collect();
            (name, text)
        })
        .collect();
    let folder = folder(&files);
    let run = import(&["BladeGen.inf", "-o", "wheel.imp", "--pressure", "greater"], folder.path());
    let said = text(&run.stdout);
    assert!(run.status.success(), "{said}{}", text(&run.stderr));
    assert!(said.contains("repeat the one before and are left out"), "{said}");
    is_modelled(folder.path(), "wheel.imp");
    let run = bounded::program().current_dir(folder.path()).args(["check", "whole.imp"]).output().unwrap();
    assert!(!text(&run.stderr).contains("IMP0303"), "{}", text(&run.stderr));
    assert!(run.status.success(), "{}", text(&run.stderr));
}

/// What the part of a job states as the largest distance from its files, mm.
fn within(folder: &Path, name: &str) -> f64 {
    let job = std::fs::read_to_string(folder.join(name)).unwrap();
    let line = job.lines().find(|line| line.starts_with("  imported ")).unwrap_or_else(|| panic!("{job}"));
    let (_, value) = line.split_once(", within ").unwrap();
    let (number, unit) = value.split_once(' ').unwrap();
    let scale = match unit {
        "mm" => 1.0,
        "um" => 1e-3,
        other => panic!("{other}"),
    };
    number.parse::<f64>().unwrap() * scale
}

/// The front end misses only what is not the part.
fn only_the_part_is_there(folder: &Path, name: &str) {
    let run = bounded::program().current_dir(folder).args([name, "--emit", "job"]).output().unwrap();
    let faults: Vec<String> = text(&run.stderr).lines().filter(|l| l.starts_with("IMP")).map(str::to_owned).collect();
    assert!(!faults.is_empty() && faults.iter().all(|f| f == "IMP0201"), "{}", text(&run.stderr));
}

/// Faces that do not meet make ruled faces, for which root and tip are hub and shroud. Those of the file, and sections that are longer
/// than the ruled faces, are left out with their distance; what lies on the part is not refused.
#[test]
fn what_ruled_faces_leave_out_is_told_with_its_distance() {
    // Two faces of radial lines on three cylinders, 2 mm apart at both ends.
    let table = |longer: f64, bow: f64| {
        let mut text = "section,face,x,y,z\n".to_owned();
        for (k, radius) in [50.0_f64, 60.0, 70.0].into_iter().enumerate() {
            for (face, y) in [("pressure", 1.0), ("suction", -1.0)] {
                for i in 0..=20 {
                    let end = if k == 1 { longer } else { 0.0 };
                    let z = -0.5 * end + (20.0 + end) * f64::from(i) / 20.0;
                    let y = y + if k == 1 { bow } else { 0.0 };
                    text.push_str(&format!("{},{face},{radius},{y:.6},{z:.6}\n", k + 1));
                }
            }
        }
        text
    };
    let meridian = |hub: f64| format!("curve,r,z\nhub,{hub},-5\nhub,{hub},25\nshroud,70.007,-5\nshroud,70.007,25\n");
    let of = |longer: f64, bow: f64, hub: f64, ruled: &[&str]| {
        let files = [("main.csv", table(longer, bow)), ("wheel_meridian.csv", meridian(hub))];
        let folder = folder(&files.map(|(name, text)| (name.to_owned(), text)));
        let stated =
            ["main.csv", "wheel_meridian.csv", "-o", "wheel.imp", "--unit", "mm", "--axis", "z", "--blades", "7"];
        let run = import(&[&stated[..], ruled].concat(), folder.path());
        (run, folder)
    };
    let (run, on) = of(0.0, 0.0, 50.01, &[]);
    assert!(run.status.success(), "{}{}", text(&run.stdout), text(&run.stderr));
    // Of hub and shroud; the pressure face is 1 mm beside the radius of its section.
    assert!(within(on.path(), "wheel.imp") <= 0.011, "{}", within(on.path(), "wheel.imp"));
    for (longer, bow, hub, words, far) in [
        (0.0, 0.0, 48.5, "the hub lies up to 1.51 mm beside the root", 1.51),
        (3.0, 0.0, 50.01, "section 2 of the blade", 1.5),
        (0.0, 0.1, 50.01, "section 2 of the blade", 0.1),
    ] {
        let (run, _) = of(longer, bow, hub, &[]);
        let said = text(&run.stderr);
        assert!(!run.status.success() && said.contains("IMP1011") && said.contains(words), "{words}: {said}");
        let (run, folder) = of(longer, bow, hub, &["--ruled"]);
        assert!(run.status.success(), "{}", text(&run.stderr));
        let stated = within(folder.path(), "wheel.imp");
        assert!((stated - far).abs() < 0.01, "{words}: {stated}");
        only_the_part_is_there(folder.path(), "wheel.imp");
    }
}

/// A part of ruled faces leaves out the sections between the first and the last one: it says how far they lie beside the faces, and is
/// not written where that is far, unless it is meant.
#[test]
fn sections_beside_ruled_faces_are_told() {
    let table = |off: f64| {
        let mut text = "section,x,y,z\n".to_owned();
        for (k, radius) in [50.0, 60.0, 70.0].into_iter().enumerate() {
            for [x, y, z] in axial_loop(radius, 40, 0) {
                // Across the faces, which look along y where x is large.
                let y = y + if k == 1 { off } else { 0.0 };
                text.push_str(&format!("{},{x:.6},{y:.6},{z:.6}\n", k + 1));
            }
        }
        text
    };
    let stated = ["main.csv", "-o", "wheel.imp", "--unit", "mm", "--axis", "z", "--blades", "7", "--start", "leading"];
    let stated = [&stated[..], &["--pressure", "greater"]].concat();
    let distance = |said: &str| {
        let (_, rest) = said.split_once("their points lie up to ").unwrap_or_else(|| panic!("{said}"));
        rest.split_once(" mm").unwrap().0.parse::<f64>().unwrap()
    };
    let on = folder(&[("main.csv".to_owned(), table(0.0))]);
    // Its edges are round with a radius of 1 mm, and those of a part of ruled faces are straight.
    let run = import(&stated, on.path());
    let said = text(&run.stderr);
    assert!(!run.status.success() && said.contains("IMP1011") && said.contains("the edges of section"), "{said}");
    let run = import(&[&stated[..], &["--within", "2mm"]].concat(), on.path());
    assert!(run.status.success(), "{}", text(&run.stderr));
    for wrong in ["0.1", "5 cm", "1m", "0mm"] {
        assert_eq!(
            import(&[&stated[..], &["--force", "--within", wrong]].concat(), on.path()).status.code(),
            Some(2),
            "{wrong}"
        );
    }
    let run = import(&[&stated[..], &["--force", "--ruled"]].concat(), on.path());
    // The ends of the faces are found in the points of each section, here within 1.5 um along the face.
    assert!(run.status.success() && distance(&text(&run.stdout)) < 2e-3, "{}{}", text(&run.stdout), text(&run.stderr));
    assert!((0.5..1.1).contains(&within(on.path(), "wheel.imp")), "{}", within(on.path(), "wheel.imp"));
    let beside = folder(&[("main.csv".to_owned(), table(3.0))]);
    let run = import(&stated, beside.path());
    let said = text(&run.stderr);
    assert!(!run.status.success() && said.contains("IMP1011") && said.contains("section 2"), "{said}");
    assert_eq!(names(beside.path()), ["main.csv"]);
    let run = import(&[&stated[..], &["--ruled"]].concat(), beside.path());
    let said = text(&run.stdout);
    assert!(run.status.success(), "{}", text(&run.stderr));
    // No farther than the shift, and nearly as far where the face looks along it.
    assert!((2.4..3.01).contains(&distance(&said)), "{said}");
    let job = std::fs::read_to_string(beside.path().join("wheel.imp")).unwrap();
    assert_eq!(distance(&job), distance(&said), "{job}");
    assert!((within(beside.path(), "wheel.imp") - distance(&said)).abs() < 0.3, "{job}");
}

/// The blades of the part have the sections of the file, which read back are the same.
#[test]
fn a_part_and_its_tables_are_written() {
    let folder = folder(&turbogrid::example());
    let run = import(&["BladeGen.inf", "-o", "wheel.imp", "--pressure", "greater"], folder.path());
    let said = text(&run.stdout);
    assert!(run.status.success(), "{said}{}", text(&run.stderr));
    for words in
        ["12 main blades", "tip radius 70 mm", "3 round", "wrote wheel.imp", "hub.curve:7: the angle of the hub"]
    {
        assert!(said.contains(words), "{words} is not in\n{said}");
    }
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let job = read("wheel.imp");
    assert!(job.contains("part wheel {") && job.contains("vanes 12"), "{job}");
    let curves = read("wheel.curves.csv");
    for curve in ["hub", "shroud"] {
        assert!(job.contains(&format!("revolve spline from \"wheel.curves.csv\" curve {curve} mm")), "{job}");
        assert!(curves.contains(&format!("{curve},1,")), "{curves}");
    }
    assert!(job.contains("sections loops from \"wheel.main.csv\" mm"), "{job}");
    // The sections of the example end 1 mm short of its hub and shroud: the part says it, and extends its faces.
    assert!(
        said.contains("the first section ends up to 1 mm short of the hub; `extend` continues the faces to it"),
        "{said}"
    );
    assert!(said.contains("the last section ends up to 1 mm short of the shroud"), "{said}");
    assert!(job.contains("\n  extend 1.02 mm\n"), "{job}");
    // Where the shroud is the casing, the hint is followed to the letter: the vanes end at the tips.
    for words in
        ["take the curve `tips` for the shroud, which goes through the tips within 0", "mm, and write `extend 1.02 mm`"]
    {
        assert!(said.contains(words), "{said}");
    }
    let tips = job.replace("curve shroud mm", "curve tips mm");
    std::fs::write(folder.path().join("tips.imp"), &tips).unwrap();
    assert_ne!(tips, job);
    let of_tips: Vec<f64> = curves
        .lines()
        .filter_map(|line| line.strip_prefix("tips,"))
        .map(|line| line.split(',').nth(1).unwrap().parse::<f64>().unwrap())
        .collect();
    // The shroud of the example is a cylinder, and the last section ends 1 mm below it.
    assert!(of_tips.len() > 10 && of_tips.iter().all(|r| (r - 70.0).abs() < 1e-3), "{of_tips:?}");
    let of_casing = is_modelled(folder.path(), "tips.imp");
    assert!(of_casing.contains("IMP0319"), "{of_casing}");
    let said = is_modelled(folder.path(), "wheel.imp");
    assert!(said.contains("IMP0319"), "{said}");
    only_the_part_is_there(folder.path(), "wheel.imp");
    // The table is read back to the same sections. In the frame of the job, turned over about X, the pressure face is on the
    // other side.
    let arguments = "wheel.sections.csv wheel.meridian.csv --unit mm --axis z --blades 12 --pressure smaller -o b.imp";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let run = import(&arguments, folder.path());
    assert!(run.status.success(), "{}", text(&run.stderr));
    assert_eq!(read("b.sections.csv"), read("wheel.sections.csv"));
    assert_eq!(read("b.curves.csv").lines().skip(1).collect::<Vec<_>>(), curves.lines().skip(1).collect::<Vec<_>>());
}

/// The wheels of public data become parts whose surfaces go through their points within 5 um.
#[test]
fn public_wheels_are_modelled() {
    for (set, stated) in
        [("nasa_hecc/hot_design_intent", "--unit in --blades 15"), ("nasa_rotor37", ""), ("hannover_tfd4ac_rotor1", "")]
    {
        let Some(data) = data::folder(set) else { continue };
        let folder = tempfile::tempdir().unwrap();
        let given = data.display().to_string();
        let arguments: Vec<&str> =
            [given.as_str(), "-o", "wheel.imp"].into_iter().chain(stated.split_whitespace()).collect();
        let run = import(&arguments, folder.path());
        assert!(run.status.success(), "{}", text(&run.stderr));
        let said = is_modelled(folder.path(), "wheel.imp");
        let found = said.lines().filter_map(|line| line.split(" sections within ").nth(1));
        let found: Vec<f64> = found.map(|rest| rest.split_whitespace().next().unwrap().parse().unwrap()).collect();
        println!("{set}: {found:?} um");
        assert!(!found.is_empty() && found.iter().all(|residual| *residual < 5.0), "{said}");
    }
}

#[test]
fn files_are_replaced_only_by_force() {
    let folder = folder(&turbogrid::example());
    std::fs::write(folder.path().join("wheel.curves.csv"), "old").unwrap();
    let before = names(folder.path());
    let run = import(&["BladeGen.inf", "-o", "wheel.imp", "--pressure", "greater"], folder.path());
    assert_eq!(run.status.code(), Some(2));
    assert!(text(&run.stderr).contains("IMP1010"), "{}", text(&run.stderr));
    assert_eq!(names(folder.path()), before);
    assert!(
        import(&["BladeGen.inf", "-o", "wheel.imp", "--pressure", "greater", "--force"], folder.path())
            .status
            .success()
    );
    assert_ne!(std::fs::read_to_string(folder.path().join("wheel.curves.csv")).unwrap(), "old");
    // Not even by force are the files that were read.
    let run = import(&["BladeGen.inf", "-o", "BladeGen.inf", "--pressure", "greater", "--force"], folder.path());
    assert!(text(&run.stderr).contains("IMP0903"), "{}", text(&run.stderr));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("BladeGen.inf", folder.path().join("alias.imp")).unwrap();
        let run = import(&["BladeGen.inf", "-o", "alias.imp", "--pressure", "greater", "--force"], folder.path());
        assert!(text(&run.stderr).contains("IMP0904"), "{}", text(&run.stderr));
    }
    assert_eq!(std::fs::read_to_string(folder.path().join("BladeGen.inf")).unwrap(), turbogrid::example()[0].1);
}

#[test]
fn a_folder_stands_for_its_files() {
    let of_tables = folder(&table::example()[..4]);
    let run = import(&[".", "--unit", "in", "--blades", "5", "--pressure", "greater"], of_tables.path());
    assert!(run.status.success(), "{}", text(&run.stderr));
    assert!(text(&run.stdout).contains("5 main blades") && text(&run.stdout).contains("nothing written"));
    assert_eq!(names(of_tables.path()).len(), 4);
    let of_index = folder(&turbogrid::example());
    assert!(import(&[".", "--pressure", "smaller"], of_index.path()).status.success());
    // Without the side: the made-up blade turns like that of a turbine.
    let run = import(&["."], of_index.path());
    assert!(run.status.code() == Some(2) && text(&run.stderr).contains("IMP1008"), "{}", text(&run.stderr));
    let empty = folder(&[]);
    let run = import(&["."], empty.path());
    assert!(run.status.code() == Some(2) && text(&run.stderr).contains("IMP1001"), "{}", text(&run.stderr));
    let run = import(&["no.inf"], empty.path());
    assert!(run.status.code() == Some(3) && text(&run.stderr).contains("IMP0901"), "{}", text(&run.stderr));
}

/// Whether the angles of a splitter hold its pitch fraction is not known: what is read is told, and nothing is written.
#[test]
fn splitters_without_a_place_are_not_written() {
    let folder = folder(&rtzt::example());
    let arguments = ["a.rtzt", "--unit", "mm", "--start", "leading", "--pressure", "greater"];
    assert!(import(&arguments, folder.path()).status.success());
    let run = import(&[&arguments[..], &["-o", "wheel.imp"]].concat(), folder.path());
    assert!(run.status.code() == Some(2) && text(&run.stderr).contains("IMP1007"), "{}", text(&run.stderr));
    assert_eq!(names(folder.path()), ["a.rtzt"]);
}

/// A model by angles becomes a part by angles: its blades are modelled, and their sections, written and read back, are those that
/// were imported.
#[test]
fn angles_are_written_as_angles() {
    let folder = folder(&bladegen::example());
    let run = import(&["a.bgi", "-o", "wheel.imp"], folder.path());
    assert!(run.status.success(), "{}", text(&run.stderr));
    let job = std::fs::read_to_string(folder.path().join("wheel.imp")).unwrap();
    // The flow goes towards +Z, so the wheel is turned over, and angles have the other sense.
    for words in [
        "beta [(0 %, -30 deg)",
        "start -5 deg",
        "0 mm behind the trailing edges",
        "angle 55 %",
        "from spline from \"wheel.curves.csv\" curve splitter_1_leading mm",
        "leading-edge elliptic 2",
        "trailing-edge cut-off",
        "// Note: a splitter is the main blade",
    ] {
        assert!(job.contains(words), "{words} is not in\n{job}");
    }
    let said = is_modelled(folder.path(), "wheel.imp");
    assert_eq!(said.matches("IMP0319").count(), 2, "{said}");
    let emit = ["whole.imp", "--emit", "sections", "--sections", "5", "-o", "back.inf"];
    let run = bounded::program().current_dir(folder.path()).args(emit).output().unwrap();
    assert!(run.status.success(), "{}", text(&run.stderr));
    // Sections between hub and shroud lie at equal steps up the rulings, not on the layers.
    let mut back = points_of("back.inf", folder.path());
    back.retain(|(section, _)| section.ends_with(" 1") || section.ends_with(" 5"));
    // 45 % of the pitch, turned over, are 55 % behind the blade before.
    let (sin, cos) = (std::f64::consts::TAU / 7.0).sin_cos();
    for (_, p) in back.iter_mut().filter(|(section, _)| section.starts_with("splitter")) {
        *p = [cos * p[0] + sin * p[1], cos * p[1] - sin * p[0], p[2]];
    }
    let worst = off_chords(&back, &points_of("a.bgi", folder.path()));
    // Points of the stated sections are some 0.2 mm apart, so chords are within 2 um of the faces.
    assert!(worst < 0.004, "{worst}");
}

/// Points of the sections of a file with their blade and section, in the frame of the job.
fn points_of(given: &str, folder: &Path) -> Vec<(String, [f64; 3])> {
    let run = import(&[given, "-o", "b.imp", "--force"], folder);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let table = std::fs::read_to_string(folder.join("b.sections.csv")).unwrap();
    let point = |line: &str| -> Option<(String, [f64; 3])> {
        let fields: Vec<&str> = line.split(',').collect();
        let p: Vec<f64> = fields.get(4..7)?.iter().map_while(|x| x.parse().ok()).collect();
        Some((format!("{} {}", fields[0], fields[1]), p.try_into().ok()?))
    };
    let points: Vec<_> = table.lines().filter_map(point).collect();
    assert!(points.len() > 1000, "{}", points.len());
    points
}

/// Largest distance of points from the chords between points of the same section.
fn off_chords(points: &[(String, [f64; 3])], stated: &[(String, [f64; 3])]) -> f64 {
    let mut worst = 0.0_f64;
    for (section, p) in points {
        let of: Vec<_> = stated.iter().filter(|(s, _)| s == section).map(|(_, q)| q).collect();
        let chords = of.iter().zip(of.iter().cycle().skip(1)).map(|(a, b)| {
            let along: Vec<f64> = (0..3).map(|i| b[i] - a[i]).collect();
            let square: f64 = along.iter().map(|x| x * x).sum();
            let dot: f64 = (0..3).map(|i| (p[i] - a[i]) * along[i]).sum();
            let t = (dot / square.max(1e-300)).clamp(0.0, 1.0);
            (0..3).map(|i| (p[i] - a[i] - t * along[i]).powi(2)).sum::<f64>().sqrt()
        });
        worst = worst.max(chords.fold(f64::INFINITY, f64::min));
    }
    worst
}

/// More points than a job can have are told before anything is written.
#[test]
fn what_no_job_can_have_is_not_written() {
    let mut table = "section,x,y,z\n".to_owned();
    for (k, radius) in [50.0, 60.0].into_iter().enumerate() {
        for [x, y, z] in super::axial_loop(radius, 2400, 0) {
            table.push_str(&format!("{},{x:.7},{y:.7},{z:.7}\n", k + 1));
        }
    }
    let folder = folder(&[("main.csv".to_owned(), table)]);
    let arguments =
        ["main.csv", "--unit", "mm", "--axis", "z", "--blades", "5", "--start", "leading", "--pressure", "greater"];
    assert!(import(&arguments, folder.path()).status.success());
    let run = import(&[&arguments[..], &["-o", "wheel.imp"]].concat(), folder.path());
    let said = text(&run.stderr);
    assert!(run.status.code() == Some(2) && said.contains("IMP1006") && said.contains("at most 2000"), "{said}");
    assert_eq!(names(folder.path()), ["main.csv"]);
}

/// Wheels of many blades are read and modelled; a STEP file of them is refused with its limit before it takes memory.
#[test]
fn wheels_of_many_blades_have_limits() {
    let mut sections = "section,x,y,z\n".to_owned();
    for (k, radius) in [500.0, 510.0].into_iter().enumerate() {
        for [x, y, z] in super::axial_loop(radius, 160, 0) {
            sections.push_str(&format!("{},{x:.7},{y:.7},{z:.7}\n", k + 1));
        }
    }
    let meridian = |name: &str, r: u32| {
        let points: String = (-5..=25).map(|z| format!("{name},{r},{z}\n")).collect();
        (format!("{name}.csv"), format!("curve,r,z\n{points}"))
    };
    let folder = folder(&[("main.csv".to_owned(), sections), meridian("hub", 500), meridian("shroud", 510)]);
    let arguments = |blades: &'static str| {
        let files = ["main.csv", "hub.csv", "shroud.csv", "-o", "wheel.imp", "--force"];
        let stated = ["--unit", "mm", "--axis", "z", "--pressure", "greater", "--blades", blades];
        [&files[..], &stated].concat()
    };
    let run = import(&arguments("10001"), folder.path());
    assert!(text(&run.stderr).contains("from 1 to 10000"), "{}", text(&run.stderr));
    let run = import(&arguments("1000"), folder.path());
    assert!(run.status.success(), "{}", text(&run.stderr));
    is_modelled(folder.path(), "wheel.imp");
    let emit = ["whole.imp", "--emit", "step", "-o", "wheel.step"];
    let run = bounded::program().current_dir(folder.path()).args(emit).output().unwrap();
    let said = text(&run.stderr);
    assert!(said.contains("IMP0903") && said.contains("at most 300 blades"), "{said}");
    assert!(!folder.path().join("wheel.step").exists());
}

/// 100 MB of sections are refused with the limit, within the memory of [`bounded`].
#[test]
fn large_files_are_refused() {
    let folder = folder(&turbogrid::example());
    let line = "1.0000000 2.0000000 3.0000000\n";
    for size in [100 << 20, 60 << 20] {
        let text = format!("# Profile 1\n{}", line.repeat(size / line.len()));
        std::fs::write(folder.path().join("profile.curve"), text).unwrap();
        let run = import(&["BladeGen.inf"], folder.path());
        let said = self::text(&run.stderr);
        assert!(said.contains("64 MB, the limit") || said.contains("more than 10000 points of a curve"), "{said}");
        assert!(said.contains("IMP1006") && said.contains("export fewer points"), "{said}");
        assert!(!run.status.success() && !said.contains("panicked"));
    }
}
