//! Tables of points: section files of NASA and comma separated values.

use super::{axial_loop, faults, good, line, millimetres, noted, points};
use impellerc::blade::{SectionForm, ThicknessDirection};
use impellerc::blade_files::{Axis, LengthUnit, Options};

/// A section file as NASA writes them.
fn nasa(radius: f64, shift: usize) -> String {
    let line = |p: &[f64; 3]| {
        let theta = p[1].atan2(p[0]);
        format!("   {:.9}   {:.9}   {:.9}\r\n", p[2] / 25.4, theta * radius / 25.4, radius / 25.4)
    };
    let lines: String = axial_loop(radius, 64, shift).iter().map(line).collect();
    format!("        X           R*THETA          R\r\n{lines}")
}

fn meridian(radius: f64, separator: &str) -> String {
    let line = |k: i32| format!("{:.9}{separator}{:.9}\r\n", f64::from(5 * k) / 25.4, radius / 25.4);
    format!("\u{feff}x{separator}r\r\n{}", (-1..=5).map(line).collect::<String>())
}

fn inches() -> Options {
    Options { unit: Some(LengthUnit::Inch), blades: Some(5), ..Options::default() }
}

#[test]
fn section_files_are_grouped_by_name_and_ordered_by_number() {
    let (hub, shroud) = (meridian(49.0, "\t"), meridian(71.0, ","));
    let sections = [50.0, 60.0, 70.0].map(|r| nasa(r, 5));
    let files = [
        ("main_section_10.txt", sections[2].as_str()),
        ("main_section_2.txt", &sections[1]),
        ("main_section_1.txt", &sections[0]),
        ("splitter_section_1.txt", &sections[0]),
        ("splitter_section_2.txt", &sections[2]),
        ("path_hub.txt", &hub),
        ("path_shroud.txt", &shroud),
    ];
    let read = good(&files, files.len(), &inches());
    assert_eq!(read.rows[0].count, 5);
    let names: Vec<_> = read.rows[0].blades.iter().map(|b| (b.name.as_str(), b.sections.len())).collect();
    assert_eq!(names, [("main", 3), ("splitter", 2)]);
    for (section, radius) in read.rows[0].blades[0].sections.iter().zip([50.0, 60.0, 70.0]) {
        for (found, due) in points(&section.form).iter().zip(axial_loop(radius, 64, 5)) {
            assert!((found.coords - nalgebra::Vector3::from(due)).norm() < 1e-6);
        }
    }
    assert_eq!((read.hub.unwrap().len(), read.shroud.unwrap().len()), (7, 7));
    // The columns name the axis.
    let other = Options { axis: Some(Axis::Z), ..inches() };
    assert_eq!(line(&files, files.len(), &other).0, "IMP1005");
}

/// Sets of NASA lack the header of a file.
#[test]
fn a_header_counts_for_all_files() {
    let [a, b] = [50.0, 60.0].map(|r| nasa(r, 5));
    let without = b.split_once('\n').unwrap().1;
    let due = good(&[("main_1.txt", &a), ("main_2.txt", &b)], 2, &inches());
    let read = good(&[("main_1.txt", &a), ("main_2.txt", without)], 2, &inches());
    assert!(read.rows[0].blades[0].sections == due.rows[0].blades[0].sections);
    assert!(noted(&read, "the file has no header"));
    // Not where the headers differ.
    let other = a.replace("R*THETA", "theta-deg");
    let files = [("main_1.txt", a.as_str()), ("main_2.txt", without), ("main_3.txt", &other)];
    assert_eq!(line(&files, 3, &inches()), ("IMP1004", "main_2.txt".to_owned(), 1));
}

/// Lines of a table `blade,section,span,face,x,y,z`.
fn with_faces() -> String {
    let mut text = "blade;section;span;face;x;y;z\n# a comment\n".to_owned();
    for (k, radius) in [50.0, 70.0].into_iter().enumerate() {
        let points = axial_loop(radius, 64, 0);
        let suction: Vec<_> = points[..=32].to_vec();
        let pressure: Vec<_> = points[32..].iter().rev().chain(&points[..0]).copied().collect();
        for (face, points) in [("pressure", pressure), ("Suction", suction)] {
            for [x, y, z] in points {
                text.push_str(&format!("main;{};{};{face};{x};{y};{z}\n", k + 1, k));
            }
        }
    }
    text
}

#[test]
fn a_table_has_faces_spans_and_blades() {
    let text = with_faces();
    let read = good(&[("blade.csv", &text)], 1, &millimetres());
    let sections = &read.rows[0].blades[0].sections;
    assert_eq!(sections.iter().map(|s| s.span).collect::<Vec<_>>(), [Some(0.0), Some(1.0)]);
    let SectionForm::Faces([pressure, suction]) = &sections[1].form else { panic!("{sections:?}") };
    assert_eq!((pressure.len(), suction.len()), (32, 33));
    assert!(pressure[0].z < pressure[31].z && suction[0].z < suction[32].z);
    // A section without one of its faces.
    let half: String = text.lines().filter(|l| !l.contains("2;1;pressure")).map(|l| format!("{l}\n")).collect();
    assert_eq!(faults(&[("blade.csv", &half)], 1, &millimetres())[0].code.id(), "IMP1003");
}

#[test]
fn a_mean_line_needs_the_direction_of_its_thickness() {
    let line = |s: i32, k: i32| format!("{s},{},{},{},{}\n", 40 + 20 * s, 3 * k, 10 * k, 2 + k % 3);
    let lines: String = (0..2).flat_map(|s| (0..9).map(move |k| line(s, k))).collect();
    let text = format!("section,r,theta-deg,z,thickness\n{lines}");
    let options = Options { axis: None, ..millimetres() };
    let found = faults(&[("mean.csv", &text)], 1, &options);
    assert!(found[0].code.id() == "IMP1004" && found[0].help.as_ref().unwrap().contains("--thickness"), "{found:?}");
    let options = Options { thickness: Some(ThicknessDirection::Normal), ..options };
    let read = good(&[("mean.csv", &text)], 1, &options);
    let SectionForm::MeanLine { points, thickness } = &read.rows[0].blades[0].sections[1].form else { panic!() };
    assert_eq!((points.len(), *thickness), (9, ThicknessDirection::Normal));
    let p = points[4].position;
    assert!((p.x.hypot(p.y) - 60.0).abs() < 1e-9 && (p.y.atan2(p.x).to_degrees() - 12.0).abs() < 1e-9);
    assert!((points[4].thickness - 3.0).abs() < 1e-12 && (p.z - 40.0).abs() < 1e-12);
}

#[test]
fn columns_are_stated_or_in_the_header() {
    let rows = |r: f64| -> String { axial_loop(r, 40, 0).iter().map(|[x, y, z]| format!("{z} {x} {y}\n")).collect() };
    let (a, b) = (rows(50.0), rows(70.0));
    let files = [("wing1.dat", a.as_str()), ("wing2.dat", b.as_str())];
    let found = faults(&files, 2, &millimetres());
    assert!(found[0].code.id() == "IMP1004" && found[0].help.as_ref().unwrap().contains("--columns"), "{found:?}");
    let columns = Some(["z", "x", "y"].map(str::to_owned).to_vec());
    let read = good(&files, 2, &Options { columns, ..millimetres() });
    assert!(noted(&read, "the columns are z, x, y, by `--columns`"));
    assert_eq!(read.rows[0].blades[0].name, "wing");
    // An angle has a unit, points have three coordinates, and columns differ.
    for (header, code) in [("x,r,theta", "IMP1004"), ("x,y", "IMP1004"), ("x,x,y", "IMP1005"), ("y,foo,bar", "IMP1004")]
    {
        let text = format!("{header}\n1,2,3\n");
        assert_eq!(line(&[("wing1.csv", &text)], 1, &millimetres()).0, code, "{header}");
    }
    // Without the axis.
    let text = format!("x y z\n{a}");
    let found = faults(&[("wing1.dat", &text)], 1, &Options { axis: None, ..millimetres() });
    assert!(found[0].help.as_ref().unwrap().contains("--axis"));
}

#[test]
fn faults_are_told_with_their_line() {
    let text = nasa(50.0, 0);
    let lines: Vec<&str> = text.lines().collect();
    for bad in ["1.0 2.0", "1.0 2.0 3.0 4.0", "1.0 2.0 nan", "1.0 2.0 -3.0", "1.0 2.0 0.0", "1.0 2.0 1e400", "a b c"] {
        let mut lines = lines.clone();
        lines[17] = bad;
        let text = lines.join("\n");
        let found = line(&[("main_section_1.txt", &text), ("main_section_2.txt", &text)], 2, &inches());
        assert_eq!(found, ("IMP1002", "main_section_1.txt".to_owned(), 18), "{bad}");
    }
    let same = [("a/main_1.txt", text.as_str()), ("b/main_1.txt", &text)];
    assert_eq!(line(&same, 2, &inches()), ("IMP1005", "b/main_1.txt".to_owned(), 2));
    let two = [("one_1.txt", text.as_str()), ("two_1.txt", &text)];
    assert_eq!(line(&two, 2, &inches()).0, "IMP1004");
    let unnamed = meridian(49.0, " ");
    assert_eq!(line(&[("main_1.txt", &text), ("path.txt", &unnamed)], 2, &inches()).0, "IMP1004");
    assert_eq!(line(&[("main_1.txt", &text), ("hub.txt", &unnamed), ("hub.dat", &unnamed)], 3, &inches()).0, "IMP1005");
    // One section is no blade; neither are files without points.
    assert_eq!(line(&[("main_1.txt", &text)], 1, &inches()).0, "IMP1003");
    for nothing in ["", "\n\n", "X R*THETA R\n", "# only a comment\n"] {
        assert_eq!(line(&[("main_1.txt", nothing)], 1, &inches()).0, "IMP1003", "{nothing:?}");
    }
}

#[test]
fn formats_are_told_by_their_endings() {
    let text = nasa(50.0, 0);
    for (files, given) in [
        (vec![("rotor.igs", text.as_str())], 1),
        (vec![("rotor", text.as_str())], 1),
        (vec![("a.inf", text.as_str()), ("b.txt", &text)], 2),
        (vec![("a.inf", text.as_str()), ("b.inf", &text)], 2),
        (vec![], 0),
    ] {
        assert_eq!(faults(&files, given, &inches())[0].code.id(), "IMP1001");
    }
    let options = Options { format: Some("table".to_owned()), ..inches() };
    good(&[("main.1", &text), ("main.2", &nasa(60.0, 0))], 2, &options);
    let options = Options { format: Some("iges".to_owned()), ..inches() };
    assert_eq!(faults(&[("rotor.igs", &text)], 1, &options)[0].code.id(), "IMP1001");
    assert_eq!(faults(&[], 1, &inches())[0].code.id(), "IMP1001");
}

/// An example for other tests.
pub fn example() -> Vec<(String, String)> {
    let files = [
        ("main_section_1.txt", nasa(50.0, 5)),
        ("main_section_2.txt", nasa(70.0, 5)),
        ("hub.txt", meridian(49.0, "\t")),
        ("shroud.csv", meridian(71.0, ",")),
        ("splitter_faces.csv", with_faces().replace("main;", "splitter;").replace(";", ",")),
    ];
    files.map(|(name, text)| (name.to_owned(), text)).to_vec()
}
