//! TurboGrid files with the traps of the format.

use super::{axial_loop, faults, good, line, noted, points};
use impellerc::blade::EdgeForm;
use impellerc::blade::outline::Side;
use impellerc::blade_files::outlines::outlines;
use impellerc::blade_files::{Axis, LengthUnit, Options};
use impellerc::diagnostics::codes;

/// Points of lines of the profile, hub or shroud.
fn lines(points: &[[f64; 3]], scale: f64) -> String {
    points.iter().map(|p| format!("  {:.9} {:.9} {:.9}\n", p[0] * scale, p[1] * scale, p[2] * scale)).collect()
}

const INF: &str = "\
! made up
Profile Data File:profile.curve
Geometry Units: CM
Axis of Rotation: Z
Number of Blade Sets: 12
Hub Data File: hub.curve
Shroud Data File:   shroud.curve
";

/// Hub with an angle that varies; mm.
fn meridian(radius: f64) -> Vec<[f64; 3]> {
    let point = |k: i32| {
        let theta = 0.02 * f64::from(k);
        [radius * theta.cos(), radius * theta.sin(), 5.0 * f64::from(k)]
    };
    (-1..=5).map(point).collect()
}

fn profile(closed: bool) -> String {
    let section = |(k, radius): (usize, f64)| {
        let mut points = axial_loop(radius, 80, 3);
        if closed {
            points.push(points[0]);
        }
        format!("# Profile {} at {:.4}%\n{}", k + 1, 50.0 * k as f64, lines(&points, 0.1))
    };
    [50.0, 60.0, 70.0].into_iter().enumerate().map(section).collect()
}

fn files(inf: &str, profile: &str) -> [(String, String); 4] {
    [
        ("BladeGen.inf", inf.to_owned()),
        ("hub.curve", lines(&meridian(49.0), 0.1)),
        ("shroud.curve", lines(&meridian(71.0), 0.1)),
        ("profile.curve", profile.to_owned()),
    ]
    .map(|(name, text)| (name.to_owned(), text))
}

fn borrowed(files: &[(String, String)]) -> Vec<(&str, &str)> {
    files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect()
}

#[test]
fn open_and_closed_loops_are_the_same() {
    let read = |closed| good(&borrowed(&files(INF, &profile(closed))), 1, &Options::default());
    let (open, closed) = (read(false), read(true));
    assert!(open.rows[0].blades[0].sections == closed.rows[0].blades[0].sections);
    assert!(noted(&closed, "repeat their first") && noted(&open, "do not repeat their first"));
    let row = &open.rows[0];
    assert_eq!((row.count, row.blades.len(), row.blades[0].name.as_str()), (12, 1, "main"));
    assert_eq!(row.blades[0].sections.iter().map(|s| s.span.unwrap()).collect::<Vec<_>>(), [0.0, 0.5, 1.0]);
    for (section, radius) in row.blades[0].sections.iter().zip([50.0, 60.0, 70.0]) {
        for (found, due) in points(&section.form).iter().zip(axial_loop(radius, 80, 3)) {
            assert!((found.coords - nalgebra::Vector3::from(due)).norm() < 1e-6, "{found} {due:?}");
        }
    }
    // The angle varies by 6 times 0.02 rad, and only radius and height count.
    assert!(noted(&open, "the angle of the hub about the axis varies from -1.146 to 5.730 deg"));
    for (found, k) in open.hub.unwrap().iter().zip(-1..=5) {
        assert!((found[0] - 49.0).abs() < 1e-6 && (found[1] - 5.0 * f64::from(k)).abs() < 1e-6);
    }
}

#[test]
fn each_unit_and_axis_gives_the_same_part() {
    let due = good(&borrowed(&files(INF, &profile(true))), 1, &Options::default());
    for (word, factor) in [("M", 0.01), ("mm", 10.0), ("IN", 1.0 / 2.54)] {
        let scaled = |text: &str| {
            let line = |line: &str| {
                let numbers: Option<Vec<f64>> = line.split_whitespace().map(|w| w.parse().ok()).collect();
                numbers.map_or_else(
                    || line.to_owned(),
                    |n| n.iter().map(|x| format!("{:.12} ", x * factor)).collect::<String>(),
                ) + "\r\n"
            };
            text.lines().map(line).collect::<String>()
        };
        let files = files(INF, &profile(true)).map(|(name, text)| (name, format!("\u{feff}{}", scaled(&text))));
        let files = files.map(|(name, text)| (name, text.replace("Units: CM", &format!("Units: {word}"))));
        let read = good(&borrowed(&files), 1, &Options::default());
        for (a, b) in read.rows[0].blades[0].sections.iter().zip(&due.rows[0].blades[0].sections) {
            for (a, b) in points(&a.form).iter().zip(points(&b.form)) {
                assert!((a - b).norm() < 1e-6, "{word}");
            }
        }
    }
    // Axis X: the coordinates of a line go on by one place.
    let turned = |text: &str| {
        let line = |line: &str| match line.split_whitespace().collect::<Vec<_>>().as_slice() {
            [x, y, z] if z.parse::<f64>().is_ok() => format!("{z}, {x},\t{y}\n"),
            _ => format!("{line}\n"),
        };
        text.lines().map(line).collect::<String>()
    };
    let files = files(&INF.replace("Rotation: Z", "Rotation: X"), &profile(true));
    let files = files.map(|(name, text)| (name, turned(&text)));
    let read = good(&borrowed(&files), 1, &Options::default());
    assert!(read.rows[0].blades[0].sections == due.rows[0].blades[0].sections && read.hub == due.hub);
}

#[test]
fn a_second_block_is_a_splitter() {
    let splitter = |k: usize, radius: f64| {
        let points: Vec<[f64; 3]> = axial_loop(radius, 60, 0).iter().map(|p| [p[1], -p[0], p[2]]).collect();
        format!("#splitter, {k}\n{}", lines(&points, 0.1))
    };
    let both = format!("## Main Blade\n{}## Splitter\n{}{}", profile(false), splitter(1, 50.0), splitter(2, 70.0));
    let inf = format!("{INF}Number of Blades Per Set: 2\nBlade 1 LE: CutOffEnd\nBlade 0 TE:EllipseEnd\n");
    let read = good(&borrowed(&files(&inf, &both)), 1, &Options::default());
    let names: Vec<_> = read.rows[0].blades.iter().map(|b| (b.name.as_str(), b.sections.len())).collect();
    assert_eq!(names, [("Main Blade", 3), ("Splitter", 2)]);
    assert_eq!(read.rows[0].blades[0].edges, [None, Some(EdgeForm::Round)]);
    assert_eq!(read.rows[0].blades[1].edges, [Some(EdgeForm::CutOff), None]);
    // The number of blades in a set must be that of the blocks.
    let wrong = inf.replace("Per Set: 2", "Per Set: 1");
    assert_eq!(line(&borrowed(&files(&wrong, &both)), 1, &Options::default()).0, "IMP1005");
}

#[test]
fn a_left_handed_frame_is_mirrored() {
    let inf = format!("{INF}Coordinate System Orientation: Lefthanded\n");
    let [right, left] = [INF, &inf].map(|inf| good(&borrowed(&files(inf, &profile(true))), 1, &Options::default()));
    for (a, b) in right.rows[0].blades[0].sections.iter().zip(&left.rows[0].blades[0].sections) {
        assert!(points(&a.form).iter().zip(points(&b.form)).all(|(a, b)| a.x == b.x && a.y == -b.y && a.z == b.z));
    }
}

#[test]
fn what_is_not_stated_is_asked_for() {
    for (without, option) in [
        ("Geometry Units: CM\n", "--unit"),
        ("Axis of Rotation: Z\n", "--axis"),
        ("Number of Blade Sets: 12\n", "--blades"),
    ] {
        let inf = INF.replace(without, "");
        let found = faults(&borrowed(&files(&inf, &profile(true))), 1, &Options::default());
        assert_eq!(found[0].code.id(), "IMP1004");
        assert!(found[0].help.as_ref().unwrap().contains(option), "{found:?}");
        let options =
            Options { unit: Some(LengthUnit::Centimetre), axis: Some(Axis::Z), blades: Some(12), ..Options::default() };
        let due = good(&borrowed(&files(INF, &profile(true))), 1, &options);
        let read = good(&borrowed(&files(&inf, &profile(true))), 1, &options);
        assert!(read.rows[0].blades[0].sections == due.rows[0].blades[0].sections && read.rows[0].count == 12);
    }
    // All at once.
    let inf = "Hub Data File: hub.curve\nShroud Data File: shroud.curve\nProfile Data File: profile.curve\n";
    assert_eq!(faults(&borrowed(&files(inf, &profile(true))), 1, &Options::default()).len(), 3);
    // An option that says something else.
    let options = Options { unit: Some(LengthUnit::Millimetre), ..Options::default() };
    assert_eq!(line(&borrowed(&files(INF, &profile(true))), 1, &options).0, "IMP1005");
}

#[test]
fn faults_are_told_with_their_line() {
    let cases = [
        ("BladeGen.inf", INF.replace("Units: CM", "Units: FURLONG"), profile(true), "IMP1002", 3),
        ("BladeGen.inf", INF.replace("Geometry Units: CM", "Geometry Units CM"), profile(true), "IMP1002", 3),
        ("BladeGen.inf", INF.replace("Sets: 12", "Sets: 12.5"), profile(true), "IMP1002", 5),
        ("BladeGen.inf", INF.replace("Sets: 12", "Sets: 0"), profile(true), "IMP1002", 5),
        ("BladeGen.inf", INF.replace("hub.curve", "bub.curve"), profile(true), "IMP0901", 6),
        ("BladeGen.inf", INF.replace("hub.curve", "C:\\a\\hub.curve"), profile(true), "IMP0901", 6),
        ("BladeGen.inf", format!("{INF}Geometry Units: MM\n"), profile(true), "IMP1005", 8),
        ("BladeGen.inf", INF.replace("Hub Data File: hub.curve\n", ""), profile(true), "IMP1003", 6),
    ];
    for (file, inf, profile, code, at) in cases {
        let found = line(&borrowed(&files(&inf, &profile)), 1, &Options::default());
        assert_eq!(found, (code, file.to_owned(), at), "{inf}");
    }
    // In the third section.
    let begins = 2 * 82 + 1;
    let lines: Vec<String> = profile(true).lines().map(str::to_owned).collect();
    let with = |at: usize, text: &str| {
        let mut lines = lines.clone();
        lines[at - 1] = text.to_owned();
        lines.join("\n")
    };
    for (at, text) in [
        (begins + 3, "1.0 2.0"),
        (begins + 3, "1.0 2.0 3.0 4.0"),
        (begins + 3, "1.0 NaN 3.0"),
        (begins + 3, "1.0 inf 3.0"),
        (begins + 3, "1.0 1e400 3.0"),
        (begins + 3, "1.0 2.O 3.0"),
        (begins + 3, "1,0 2,0 3,0"),
    ] {
        let found = line(&borrowed(&files(INF, &with(at, text))), 1, &Options::default());
        assert_eq!(found, ("IMP1002", "profile.curve".to_owned(), at), "{text}");
    }
    let found = line(&borrowed(&files(INF, &with(begins + 3, "1e9 2.0 3.0"))), 1, &Options::default());
    assert_eq!(found, ("IMP1006", "profile.curve".to_owned(), begins + 3));
    let found = line(&borrowed(&files(INF, &with(begins, "# at 20 %"))), 1, &Options::default());
    assert_eq!(found, ("IMP1005", "profile.curve".to_owned(), begins));
}

/// The profile with a word behind a point of the second section.
fn tagged(at: usize, word: &str) -> String {
    let line =
        |(k, line): (usize, &str)| if k == 82 + 1 + at { format!("{line} {word}\n") } else { format!("{line}\n") };
    profile(true).lines().enumerate().map(line).collect()
}

/// A tag is taken where the shape of the section has this edge, and nowhere else; the points are those of the file without tags.
#[test]
fn tags_of_edges_stand_at_them() {
    let options = Options { side: Some(Side::Greater), ..Options::default() };
    let due = good(&borrowed(&files(INF, &profile(true))), 1, &options);
    let taken = |word: &str| -> Vec<usize> {
        let holds = |at: &usize| {
            let read = good(&borrowed(&files(INF, &tagged(*at, word))), 1, &options);
            assert!(read.rows[0].blades[0].sections == due.rows[0].blades[0].sections);
            match outlines(&read.rows[0], read.hub.as_deref(), &options) {
                Ok(_) => true,
                Err(diag) => {
                    assert!(diag.code == codes::import::CONTRADICTS && diag.help.is_some(), "{}", diag.message);
                    false
                }
            }
        };
        (0..80).filter(holds).collect()
    };
    let heights: Vec<f64> = axial_loop(60.0, 80, 3).iter().take(80).map(|p| p[2]).collect();
    let end = |sign: f64| (0..80).max_by(|a, b| (sign * heights[*a]).total_cmp(&(sign * heights[*b]))).unwrap();
    let (leading, trailing) = (taken("le"), taken("te"));
    println!("le at {leading:?}, te at {trailing:?}, ends at {} and {}", end(-1.0), end(1.0));
    assert!(leading.contains(&end(-1.0)) && trailing.contains(&end(1.0)));
    assert!(leading.len() < 24 && trailing.len() < 24 && leading.iter().all(|at| !trailing.contains(at)));
    // Corners tell an edge that is cut off.
    let read = good(&borrowed(&files(INF, &tagged(end(1.0), "te2"))), 1, &options);
    assert_eq!(read.rows[0].blades[0].edges, [None, Some(EdgeForm::CutOff)]);
    let stated = format!("{INF}Blade 0 TE: EllipseEnd\n");
    assert_eq!(line(&borrowed(&files(&stated, &tagged(end(1.0), "TE1"))), 1, &options).0, "IMP1005");
    // Other words are no tags.
    for word in ["xx", "le3", "1.0e", "le te"] {
        let found = line(&borrowed(&files(INF, &tagged(3, word))), 1, &options);
        assert_eq!(found, ("IMP1002", "profile.curve".to_owned(), 82 + 5), "{word}");
    }
}

/// A profile that is cut off within a section is refused, wherever the cut is; one without whole sections is refused down to
/// two of them.
#[test]
fn cut_profiles_are_refused() {
    let whole = profile(true);
    let lines: Vec<&str> = whole.lines().collect();
    for count in 0..lines.len() {
        let cut = lines[..count].join("\n");
        let (read, _) = super::read(&borrowed(&files(INF, &cut)), 1, &Options::default());
        // After two whole sections the file ends as files do.
        assert_eq!(read.is_ok(), count == 2 * 82, "{count} lines");
        if count != 2 * 82 {
            faults(&borrowed(&files(INF, &cut)), 1, &Options::default());
        }
    }
}

#[test]
fn sections_from_the_shroud_are_refused() {
    let files = files(INF, &profile(true)).map(|(name, text)| {
        let name = match name.as_str() {
            "hub.curve" => "shroud.curve".to_owned(),
            "shroud.curve" => "hub.curve".to_owned(),
            _ => name,
        };
        (name, text)
    });
    assert_eq!(line(&borrowed(&files), 1, &Options::default()).0, "IMP1005");
}

/// An example for other tests.
pub fn example() -> Vec<(String, String)> {
    files(INF, &profile(true)).to_vec()
}
