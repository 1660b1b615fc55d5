//! `.ibl` files with the traps of the format.

use super::{axial_loop, faults, good, line, millimetres, noted, points};
use impellerc::blade_files::Options;

fn lines(points: &[[f64; 3]], index: bool) -> String {
    let line = |(k, p): (usize, &[f64; 3])| {
        let number = if index { format!("{}\t", k + 1) } else { String::new() };
        format!("{number}{:.9}\t{:.9} {:.9}\n", p[0], p[1], p[2])
    };
    points.iter().enumerate().map(line).collect()
}

/// Two sections, each as loops of so many curves.
fn file(head: &str, curves: usize, index: bool) -> String {
    let mut text = format!("{head}\n");
    for (k, radius) in [50.0, 70.0].into_iter().enumerate() {
        let mut points = axial_loop(radius, 60, 0);
        points.push(points[0]);
        text.push_str(&format!("begin section !{}\n", k + 1));
        for c in 0..curves {
            let (from, to) = (c * 60 / curves, (c + 1) * 60 / curves);
            text.push_str(&format!("Begin Curve ! {}\n{}", c + 1, lines(&points[from..=to], index)));
        }
    }
    text
}

#[test]
fn heads_and_pieces_change_nothing() {
    let due = good(&[("a.ibl", &file("Open Arclength", 1, false))], 1, &millimetres());
    assert_eq!((due.rows[0].count, due.hub.is_none()), (5, true));
    for (section, radius) in due.rows[0].blades[0].sections.iter().zip([50.0, 70.0]) {
        assert_eq!(points(&section.form).len(), 60);
        assert!(points(&section.form).iter().all(|p| (p.x.hypot(p.y) - radius).abs() < 1e-6));
    }
    for (head, curves, index) in
        [("OPEN\nARCLENGTH", 2, false), ("open index arclength", 3, true), ("Closed Arclength ! a comment", 4, false)]
    {
        let read = good(&[("a.IBL", &file(head, curves, index))], 1, &millimetres());
        assert!(read.rows[0].blades[0].sections == due.rows[0].blades[0].sections, "{head}");
    }
    // Two sides that begin at the leading edge.
    let mut text = "Open Arclength\n".to_owned();
    for radius in [50.0, 70.0] {
        let points = axial_loop(radius, 60, 0);
        let back: Vec<_> = points[30..].iter().rev().copied().collect();
        let back: Vec<_> = std::iter::once(points[0]).chain(back).collect();
        let sides = [lines(&points[..=30], false), lines(&back, false)].map(|l| format!("begin curve\n{l}"));
        text.push_str(&format!("begin section\n{}", sides.concat()));
    }
    let read = good(&[("a.ibl", &text)], 1, &millimetres());
    let found = points(&read.rows[0].blades[0].sections[0].form).to_vec();
    let mut of_due = points(&due.rows[0].blades[0].sections[0].form).to_vec();
    of_due.dedup();
    assert!(found.iter().all(|p| of_due.contains(p)));
}

/// The lines tell whether points have numbers, whatever the head says.
#[test]
fn lines_tell_whether_points_are_numbered() {
    let due = good(&[("a.ibl", &file("Open Arclength", 1, false))], 1, &millimetres());
    for (head, index, told) in [
        ("Closed Index arclength", false, "the head says `Index`, but the lines have x, y and z alone"),
        ("Open Arclength", true, "the head does not say `Index`, but the lines have the number of a point"),
    ] {
        let text = file(head, 1, index);
        let read = good(&[("a.ibl", &text)], 1, &millimetres());
        assert!(read.rows[0].blades[0].sections == due.rows[0].blades[0].sections, "{head}");
        assert!(noted(&read, told), "{:?}", read.notes);
        // All lines are alike.
        let mut lines: Vec<&str> = text.lines().collect();
        let other = if index { "1.0 2.0 3.0" } else { "9 1.0 2.0 3.0" };
        lines[9] = other;
        let found = line(&[("a.ibl", &lines.join("\n"))], 1, &millimetres());
        assert_eq!((found.0, found.2), ("IMP1002", 10), "{head}");
    }
    // A fourth number in front that is not the number of a point.
    let text = file("Open Arclength", 1, true).replace("\n1\t", "\n1.5\t");
    assert_eq!(line(&[("a.ibl", &text)], 1, &millimetres()).0, "IMP1002");
}

/// The sections of a second blade begin at the hub again.
#[test]
fn two_blades_in_a_file_are_refused() {
    let one = file("Open Arclength", 1, false);
    let second: String = one.lines().skip(1).map(|l| format!("{l}\n")).collect();
    let found = line(&[("a.ibl", &format!("{one}{second}"))], 1, &millimetres());
    // The mark is on the first curve of the section, the line below `begin section`.
    assert_eq!((found.0, found.2), ("IMP1005", one.lines().count() + 2));
}

#[test]
fn what_the_file_does_not_say_is_asked_for() {
    let text = file("Open Arclength", 1, false);
    let found = faults(&[("a.ibl", &text)], 1, &Options::default());
    let helps: String = found.iter().filter_map(|d| d.help.clone()).collect();
    assert!(["--unit", "--axis", "--blades"].iter().all(|option| helps.contains(option)), "{helps}");
}

#[test]
fn faults_are_told_with_their_line() {
    let text = file("Open Arclength", 1, false);
    let lines: Vec<&str> = text.lines().collect();
    for (at, bad, code) in [
        (10, "1.0 2.0", "IMP1002"),
        (10, "1.0 2.0 nan", "IMP1002"),
        (10, "1.0 2.0 1e400", "IMP1002"),
        (10, "1.0 2,0 3,0", "IMP1002"),
        (10, "begin curve", "IMP1005"),
        (2, "", "IMP1002"),
        (3, "", "IMP1002"),
        (10, "word", "IMP1002"),
    ] {
        let mut lines = lines.clone();
        lines[at - 1] = bad;
        let found = line(&[("a.ibl", &lines.join("\n"))], 1, &millimetres());
        assert_eq!(found.0, code, "{bad:?} in line {at}");
        assert!(found.2.abs_diff(at) <= 1, "{bad:?}: line {}", found.2);
    }
    for count in 0..lines.len() {
        faults(&[("a.ibl", &lines[..count].join("\n"))], 1, &millimetres());
    }
}

/// An example for other tests.
pub fn example() -> Vec<(String, String)> {
    vec![("a.ibl".to_owned(), file("Open Index Arclength", 2, true))]
}
