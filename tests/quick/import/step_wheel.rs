//! Wheels from the faces of STEP files: our own export read back, a wheel of planes and cylinders, and what is refused.

use super::{faults, good, line, noted, read};
use crate::support::bounded;
use crate::support::round_trip::{assert_same_part, round_trip};
use impellerc::blade::SectionForm;
use impellerc::blade_files::{Axis, BladeSurfaces, FaceChoice, LengthUnit, Options};

/// A blade of two planes, 2 mm thick, between cylinders of 20 mm and 30 mm: the faces have the names of our own export.
pub const WHEEL: &str = include_str!("../../../fuzz/corpus/step/wheel");

/// The same for the changes of files.
pub fn example() -> Vec<(String, String)> {
    vec![("wheel.step".to_owned(), WHEEL.to_owned())]
}

pub fn five() -> Options {
    Options { blades: Some(5), ..Options::default() }
}

fn choices(texts: &[&str]) -> Vec<FaceChoice> {
    texts.iter().map(|text| FaceChoice::parsed(text).expect("a choice")).collect()
}

/// The export of our own jobs is read back to the same part: faces, edges, hub and shroud within 1 um, and the volume with them.
#[test]
fn our_own_export_is_read_back_to_the_same_part() {
    for (name, edges) in [("small", "turned"), ("curved", "turned"), ("blisk", "round")] {
        let (program, read, again) = round_trip(name, false);
        assert!(noted(&read, "the axis of rotation is z") && noted(&read, "the blades are counted"));
        for end in ["inlet", "outlet"] {
            assert!(noted(&read, &format!("the {end} edge is {edges}")), "{name}: {:?}", read.notes);
        }
        assert_same_part(name, &program, &again);
    }
}

/// The blade of planes has the points that its dimensions give.
#[test]
fn planes_and_cylinders_are_a_wheel() {
    let made = good(&[("a.step", WHEEL)], 1, &five());
    assert!(matches!(made.surfaces, BladeSurfaces::Ruled { extend } if extend < 1e-6), "{:?}", made.surfaces);
    let (hub, shroud) = (made.hub.unwrap(), made.shroud.unwrap());
    for (line, r) in [(&hub, 20.0), (&shroud, 30.0)] {
        let ends = [line[0], line[line.len() - 1]];
        for ([found_r, found_z], z) in ends.into_iter().zip([20.0, 0.0]) {
            assert!((found_r - r).abs() < 1e-6 && (found_z - z).abs() < 1e-6, "{ends:?}");
        }
    }
    let SectionForm::Faces([pressure, suction]) = &made.rows[0].blades[0].sections[0].form else { panic!() };
    for (face, y) in [(pressure, 1.0), (suction, -1.0)] {
        assert!(face.iter().all(|p| (p.y - y).abs() < 1e-9 && (p.x.hypot(p.y) - 20.0).abs() < 1e-6));
        assert!((face[0].z - 20.0).abs() < 1e-6 && face[face.len() - 1].z.abs() < 1e-6);
    }
}

/// The same wheel about another axis, without names, picked by number: the same sections.
#[test]
fn faces_are_picked_by_number_and_the_axis_is_found() {
    let due = good(&[("a.step", WHEEL)], 1, &five());
    let turned: String = WHEEL.lines().map(|text| format!("{}\n", to_x(text))).collect();
    let bare = ["vane 1 pressure face", "vane 1 suction face", "vane 1 inlet edge", "hub of channel 1"]
        .iter()
        .fold(turned, |text, name| text.replace(name, ""));
    assert!(good(&[("a.step", &bare)], 1, &five()).rows.is_empty(), "without names the faces are listed");
    let number = |name: &str| {
        let text = WHEEL.lines().find(|text| text.contains(name)).unwrap();
        text.split('=').next().unwrap().to_owned()
    };
    let picks = [
        format!("hub={}", number("hub of")),
        format!("pressure={}", number("pressure face")),
        format!("suction={}", number("suction face")),
        format!("inlet={}", number("inlet edge")),
    ];
    let picks: Vec<&str> = picks.iter().map(String::as_str).collect();
    let made = good(&[("a.step", &bare)], 1, &Options { faces: choices(&picks), ..five() });
    assert!(noted(&made, "the axis of rotation is x"));
    for (a, b) in due.rows[0].blades[0].sections.iter().zip(&made.rows[0].blades[0].sections) {
        let (SectionForm::Faces(a), SectionForm::Faces(b)) = (&a.form, &b.form) else { panic!() };
        assert!(a.iter().flatten().zip(b.iter().flatten()).all(|(p, q)| nalgebra::distance(p, q) < 1e-6));
    }
    // Without the edge nothing tells the inlet: both ends have the same radius.
    let (code, _, _) = line(&[("a.step", &bare)], 1, &Options { faces: choices(&picks[..3]), ..five() });
    assert_eq!(code, "IMP1004");
    let wrong = Options { faces: choices(&picks), axis: Some(Axis::Z), ..five() };
    assert_eq!(line(&[("a.step", &bare)], 1, &wrong).0, "IMP1005");
}

/// A line of the file with (x, y, z) as (z, x, y): what was Z is X.
fn to_x(text: &str) -> String {
    let Some(at) =
        ["CARTESIAN_POINT('',(", "DIRECTION('',("].into_iter().find_map(|head| Some(text.find(head)? + head.len()))
    else {
        return text.to_owned();
    };
    let end = at + text[at..].find(')').unwrap();
    let [x, y, z] = text[at..end].split(',').collect::<Vec<_>>()[..] else { panic!("{text}") };
    format!("{}{z},{x},{y}{}", &text[..at], &text[end..])
}

/// Faults name what is wrong in its line, and the way out.
#[test]
fn faults_have_their_lines() {
    let with = |from: &str, to: &str| {
        assert!(WHEEL.contains(from), "{from}");
        WHEEL.replacen(from, to, 1)
    };
    let at = |words: &str| WHEEL.lines().position(|text| text.contains(words)).unwrap() + 1;
    let last = WHEEL.lines().count();
    let cases = [
        (with("'hub of channel 1'", "''"), "IMP1004", last),
        (with("'vane 1 suction face'", "''"), "IMP1004", last),
        (with("CYLINDRICAL_SURFACE('',", "OFFSET_SURFACE('',"), "IMP1007", at("CYLINDRICAL_SURFACE")),
        (with("=LINE(", "=HYPERBOLA("), "IMP1007", at("=LINE(")),
        (with(",20.);", ",-20.);"), "IMP1002", at(",20.);")),
    ];
    for (text, due, due_line) in &cases {
        let (code, _, found) = line(&[("a.step", text)], 1, &five());
        assert_eq!((code, found), (*due, *due_line));
        assert!(faults(&[("a.step", text)], 1, &five())[0].help.is_some());
    }
    // Without `--blades` one sector does not tell their number.
    assert_eq!(line(&[("a.step", WHEEL)], 1, &Options::default()).0, "IMP1004");
    let none = Options { faces: choices(&["hub=#999999"]), ..five() };
    let fault = &faults(&[("a.step", WHEEL)], 1, &none)[0];
    assert!(fault.notes.iter().any(|note| note.contains("vane 1 pressure face")), "{fault:?}");
    let twice = Options { faces: choices(&["pressure=vane 1 suction face", "suction=vane 1 suction face"]), ..five() };
    assert_eq!(line(&[("a.step", WHEEL)], 1, &twice).0, "IMP1005");
    let inch = Options { unit: Some(LengthUnit::Inch), ..five() };
    assert_eq!(line(&[("a.step", WHEEL)], 1, &inch).0, "IMP1005");
}

/// Wherever the file is cut off, it is refused.
#[test]
fn cut_wheels_are_refused() {
    for end in (0..WHEEL.trim_end().len()).step_by(97) {
        assert!(read(&[("a.step", &WHEEL[..end])], 1, &five()).0.is_err(), "{end}");
    }
}

/// The command writes the part with what it found as comments.
#[test]
fn the_command_writes_the_part_of_faces() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("wheel.step"), WHEEL).unwrap();
    let arguments = ["import", "wheel.step", "--blades", "5", "-o", "wheel.imp"];
    let run = bounded::program().current_dir(folder.path()).args(arguments).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let job = std::fs::read_to_string(folder.path().join("wheel.imp")).unwrap();
    for words in [
        "vanes 5",
        "pressure ruled {",
        "hub revolve spline from \"wheel.curves.csv\" curve hub mm",
        "um of those of the file",
    ] {
        assert!(job.contains(words), "{words} is not in\n{job}");
    }
}
