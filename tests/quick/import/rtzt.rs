//! `.rtzt` files with the traps of the format.

use super::{faults, good, line};
use impellerc::blade::{SectionForm, ThicknessDirection};
use impellerc::blade_files::{LengthUnit, Options};

/// Main blade and splitter of a radial impeller.
fn file(direction: &str, uses: &str) -> String {
    let mut text = "9\n1\n".to_owned();
    for pitch in ["0.0", "0.5"] {
        text.push_str(&format!("{pitch}\n2\n{direction}"));
        for layer in 0..2 {
            text.push_str(&format!("{layer}.0 11{uses}\n"));
            for k in 0..=10 {
                let t = f64::from(k) / 10.0;
                let r = 20.0 + 10.0 * f64::from(layer) + 40.0 * t * t;
                text.push_str(&format!("{r:.6}  {:.6}  {:.6} {:.6}\n", 0.8 * t, 30.0 * t, 2.0 + t));
            }
        }
    }
    text
}

fn millimetres() -> Options {
    Options { unit: Some(LengthUnit::Millimetre), ..Options::default() }
}

#[test]
fn mean_lines_have_radius_angle_height_and_thickness() {
    for (direction, due) in [("N\n", ThicknessDirection::Normal), ("T\n", ThicknessDirection::Tangential)] {
        let read = good(&[("a.rtzt", &file(direction, " b"))], 1, &millimetres());
        let row = &read.rows[0];
        assert_eq!((row.count, row.blades.len()), (9, 2));
        assert_eq!(row.blades.iter().map(|b| b.pitch_share).collect::<Vec<_>>(), [None, Some(0.5)]);
        let section = &row.blades[1].sections[1];
        assert_eq!(section.span, Some(1.0));
        let SectionForm::MeanLine { points, thickness } = &section.form else { panic!() };
        assert_eq!((*thickness, points.len()), (due, 11));
        let p = points[5].position;
        assert!(
            (p.x.hypot(p.y) - 40.0).abs() < 1e-9 && (p.y.atan2(p.x) - 0.4).abs() < 1e-9 && (p.z - 15.0).abs() < 1e-9
        );
        assert!((points[5].thickness - 2.5).abs() < 1e-9);
    }
}

#[test]
fn the_direction_of_thickness_is_asked_for() {
    let text = file("", " a");
    let found = faults(&[("a.rtzt", &text)], 1, &millimetres());
    assert!(found[0].code.id() == "IMP1004" && found[0].help.as_ref().unwrap().contains("--thickness"), "{found:?}");
    let options = Options { thickness: Some(ThicknessDirection::Normal), ..millimetres() };
    good(&[("a.rtzt", &text)], 1, &options);
    assert_eq!(line(&[("a.rtzt", &file("T\n", ""))], 1, &options).0, "IMP1005");
    assert_eq!(faults(&[("a.rtzt", &file("N\n", ""))], 1, &Options::default())[0].code.id(), "IMP1004");
}

#[test]
fn faults_are_told_with_their_line() {
    let text = file("N\n", "");
    let lines: Vec<&str> = text.lines().collect();
    for (at, bad, code, due) in [
        (1, "9.5", "IMP1002", 1),
        (1, "0", "IMP1002", 1),
        (2, "-1", "IMP1002", 2),
        (2, "400", "IMP1006", 2),
        (4, "100000", "IMP1006", 4),
        (6, "0.0", "IMP1002", 6),
        (6, "0.0 12", "IMP1002", 18),
        (6, "0.0 10", "IMP1002", 17),
        (6, "0.0 11 t", "IMP1007", 6),
        (6, "0.0 11 q", "IMP1002", 6),
        (9, "1 2 3", "IMP1002", 9),
        (9, "1 2 3 -4", "IMP1002", 9),
        (9, "-1 2 3 4", "IMP1002", 9),
        (9, "1 2 3 inf", "IMP1002", 9),
        (9, "1 2 3 1e400", "IMP1002", 9),
    ] {
        let mut lines = lines.clone();
        lines[at - 1] = bad;
        let found = line(&[("a.rtzt", &lines.join("\n"))], 1, &millimetres());
        assert_eq!((found.0, found.2), (code, due), "{bad:?} in line {at}");
    }
    for count in 0..lines.len() {
        faults(&[("a.rtzt", &lines[..count].join("\n"))], 1, &millimetres());
    }
    let more = format!("{text}1 2 3 4\n");
    assert_eq!(line(&[("a.rtzt", &more)], 1, &millimetres()).2, lines.len() + 1);
}

/// An example for other tests.
pub fn example() -> Vec<(String, String)> {
    vec![("a.rtzt".to_owned(), file("N\n", " a"))]
}
