//! `.geomTurbo` files with the traps of the format.

use super::{axial_loop, faults, good, line, noted};
use impellerc::blade::SectionForm;
use impellerc::blade_files::outlines::outlines;
use impellerc::blade_files::{LengthUnit, Options};

/// A section of a face.
fn section(points: &[[f64; 3]], scale: f64, comment: bool, number: usize) -> String {
    let lines: String =
        points.iter().map(|p| format!("{:.10} {:.10}\t{:.10}\n", p[0] * scale, p[1] * scale, p[2] * scale)).collect();
    let head = if comment { format!("# section {number}\n") } else { String::new() };
    format!("{head}XYZ\n{}\n{lines}", points.len())
}

/// A blade, its faces in one of both orders. `units` are metres.
fn blade(name: &str, units: f64, pressure_first: bool) -> String {
    let comment = !pressure_first;
    let mut faces = [String::from(" suction\n SECTIONAL\n 2\n"), String::from(" pressure\n SECTIONAL\n 2\n")];
    for (k, radius) in [50.0, 70.0].into_iter().enumerate() {
        let points = axial_loop(radius, 64, 0);
        // Both from the leading to the trailing edge, which they share.
        let mut from_edge: Vec<_> = points[33..].iter().rev().copied().collect();
        from_edge.insert(0, points[0]);
        from_edge.push(points[32]);
        faces[0].push_str(&section(&points[..=32], 0.001 / units, comment, k + 1));
        faces[1].push_str(&section(&from_edge, 0.001 / units, comment, k + 1));
    }
    if pressure_first {
        faces.swap(0, 1);
    }
    format!(
        "NI_BEGIN NIBlade\n NAME {name}\n NI_BEGIN NITipGap\n  WIDTH_AT_LEADING_EDGE {gap}\n  WIDTH_AT_TRAILING_EDGE {gap}\n \
         NI_END NITipGap\n NI_BEGIN nibladegeometry\n  TYPE GEOMTURBO\n  GEOMETRY_MODIFIED 0\n  GEOMETRY TURBO VERSION 5\n  \
         blade_expansion_factor_hub 0.01\n  units {units}\n  number_of_blades 7\n{}{} NI_END nibladegeometry\nNI_END NIBlade\n",
        faces[0],
        faces[1],
        gap = 0.0004 / units
    )
}

fn file(units: f64, pressure_first: bool) -> String {
    let curve = |name: &str, radius: f64| {
        let lines: String =
            (0..4).map(|k| format!("{} {}\n", f64::from(k) * 0.01 / units, radius * 0.001 / units)).collect();
        format!(
            "  NI_BEGIN basic_curve\n   NAME {name}\n   DISCRETISATION 10\n   NI_BEGIN zrcurve\n    ZR\n    4\n{lines}   NI_END \
             zrcurve\n  NI_END basic_curve\n"
        )
    };
    format!(
        "GEOMETRY TURBO\nVERSION 5.3\nTOLERANCE 1e-006\nNI_BEGIN CHANNEL\n{}{} NI_BEGIN channel_curve hub\n  NAME hub\n  VERTEX \
         CURVE_P hub 0\n NI_END channel_curve hub\nNI_END CHANNEL\nNI_BEGIN nirow\n NAME row 1\n TYPE normal\n PERIODICITY 7\n \
         NI_BEGIN NINonAxiSurfaces hub\n  REPETITION 0\n NI_END NINonAxiSurfaces hub\n{}{}NI_END nirow\nNI_END GEOMTURBO\n\
         NI_BEGIN GEOMETRY\nNI_END GEOMETRY\n",
        curve("hub", 49.0),
        curve("shroud", 71.0),
        blade("Main Blade", units, pressure_first),
        blade("Splitter1", units, pressure_first)
    )
}

#[test]
fn units_and_the_order_of_faces_change_nothing() {
    let due = good(&[("a.geomTurbo", &file(1.0, false))], 1, &Options::default());
    let row = &due.rows[0];
    assert_eq!((row.name.as_str(), row.count), ("row 1", 7));
    let names: Vec<_> = row.blades.iter().map(|b| (b.name.as_str(), b.sections.len())).collect();
    assert_eq!(names, [("Main Blade", 2), ("Splitter1", 2)]);
    for gap in row.blades[0].tip_gap.unwrap() {
        assert!((gap - 0.4).abs() < 1e-9);
    }
    assert_eq!(due.hub.as_ref().unwrap().len(), 4);
    assert!(noted(&due, "a unit of length is 1 m"));
    for (units, pressure_first) in [(0.001, false), (0.0254, true), (1.0, true)] {
        let read = good(&[("a.GEOMTURBO", &file(units, pressure_first).replace('\n', "\r\n"))], 1, &Options::default());
        for (a, b) in read.rows[0].blades.iter().zip(&row.blades) {
            for (a, b) in a.sections.iter().zip(&b.sections) {
                let (SectionForm::Loop(a), SectionForm::Loop(b)) = (&a.form, &b.form) else { panic!() };
                for (a, b) in a.iter().zip(b) {
                    assert!((a - b).norm() < 1e-5, "{units}");
                }
            }
        }
    }
    let inches = Options { unit: Some(LengthUnit::Inch), ..Options::default() };
    good(&[("a.geomTurbo", &file(0.0254, false))], 1, &inches);
    assert_eq!(line(&[("a.geomTurbo", &file(1.0, false))], 1, &inches).0, "IMP1005");
    let without = file(0.0254, false).replace("units 0.0254", "");
    assert_eq!(line(&[("a.geomTurbo", &without)], 1, &Options::default()).0, "IMP1004");
    let read = good(&[("a.geomTurbo", &without)], 1, &inches);
    assert!((read.hub.unwrap()[0][0] - 49.0).abs() < 1e-9);
}

/// Faces that meet at both edges are closed sections, whose edges are found; the pressure face is that of the file, whichever side it has.
#[test]
fn faces_that_meet_are_closed_sections() {
    let read = |text: &str| good(&[("a.geomTurbo", text)], 1, &Options::default());
    let text = file(1.0, false);
    let exchanged =
        text.replace(" suction\n", " other\n").replace(" pressure\n", " suction\n").replace(" other\n", " pressure\n");
    let sides = [&text, &exchanged].map(|text| {
        let read = read(text);
        assert!(noted(&read, "the faces of its sections meet"), "{:?}", read.notes);
        let blade = &read.rows[0].blades[0];
        for (section, radius) in blade.sections.iter().zip([50.0, 70.0]) {
            let SectionForm::Loop(points) = &section.form else { panic!("{section:?}") };
            // Each point once, and all of them those of the file.
            assert_eq!(points.len(), 64);
            let due = axial_loop(radius, 64, 0);
            for p in points {
                let off =
                    due.iter().map(|d| (p.coords - nalgebra::Vector3::from(*d)).norm()).fold(f64::INFINITY, f64::min);
                assert!(off < 1e-5, "{p} {off}");
            }
        }
        blade.pressure.unwrap()
    });
    assert!(sides[0] != sides[1], "{sides:?}");
    // The edges that the loops have, and the faces as the file names them.
    let read = read(&text);
    let divided = outlines(&read.rows[0], read.hub.as_deref(), &Options::default()).unwrap();
    let first = axial_loop(50.0, 64, 0);
    let middle = nalgebra::Point3::from(first[16]);
    let distance =
        |face: &[nalgebra::Point3<f64>]| face.iter().map(|p| (p - middle).norm()).fold(f64::INFINITY, f64::min);
    let [pressure, suction] = &divided[0][0].outline.faces;
    // Point 16 is of the face that the file calls `suction`.
    assert!(distance(suction) < 1e-5 && distance(pressure) > 0.1, "{} {}", distance(suction), distance(pressure));
}

/// The file with curves of other names, the hub in two pieces of which the second runs from the outlet.
fn by_vertices(gap: f64) -> String {
    let text = file(0.001, false);
    let from = text.find("  NI_BEGIN basic_curve").unwrap();
    let to = text.find("NI_END CHANNEL").unwrap();
    let curve = |name: &str, points: &[[f64; 2]]| {
        let lines: String = points.iter().map(|[z, r]| format!("{z} {r}\n")).collect();
        format!(
            "NI_BEGIN basic_curve\nNAME {name}\nNI_BEGIN zrcurve\nZR\n{}\n{lines}NI_END zrcurve\nNI_END basic_curve\n",
            points.len()
        )
    };
    let curves = [
        curve("c 1", &[[0.0, 49.0], [10.0, 49.0]]),
        curve("c 2", &[[30.0, 49.0], [20.0, 49.0], [10.0 + gap, 49.0]]),
        curve("c 3", &[[0.0, 71.0], [30.0, 71.0]]),
        curve("hub", &[[0.0, 1.0], [30.0, 1.0]]),
    ];
    let channel = |of: &str, vertices: &[&str]| {
        let lines: String = vertices.iter().map(|v| format!("VERTEX CURVE_P {v}\n")).collect();
        format!("NI_BEGIN channel_curve {of}\nNAME {of}\n{lines}NI_END channel_curve {of}\n")
    };
    let channels =
        [channel("hub", &["c 1 0", "c 1 1", "c 2 1", "c 2 0"]), channel("shroud", &["c 3 0", "c 3 1"])].concat();
    format!("{}{}{channels}{}", &text[..from], curves.concat(), &text[to..])
}

/// Hub and shroud are the curves that the vertices name, whatever the names are.
#[test]
fn vertices_tell_hub_and_shroud() {
    let read = good(&[("a.geomTurbo", &by_vertices(0.0))], 1, &Options::default());
    let heights: Vec<[f64; 2]> = read.hub.clone().unwrap();
    assert_eq!(heights.iter().map(|p| p[1].round()).collect::<Vec<_>>(), [0.0, 10.0, 20.0, 30.0], "{heights:?}");
    assert!(heights.iter().all(|p| (p[0] - 49.0).abs() < 1e-9), "{heights:?}");
    assert!(read.shroud.as_ref().unwrap().iter().all(|p| (p[0] - 71.0).abs() < 1e-9));
    assert!(noted(&read, "the hub is `c 1`, then `c 2`, by its vertices"), "{:?}", read.notes);
    assert!(noted(&read, "the curve `hub` is not used"), "{:?}", read.notes);
    let at = |text: &str, words: &str| text.lines().position(|l| l.trim() == words).unwrap() + 1;
    let apart = by_vertices(0.5);
    let found = line(&[("a.geomTurbo", &apart)], 1, &Options::default());
    assert_eq!((found.0, found.2), ("IMP1005", at(&apart, "VERTEX CURVE_P c 2 1")));
    for bad in ["VERTEX CURVE_P c 4 1", "VERTEX CURVE_P c 3 0.5", "VERTEX SURFACE c 3 1"] {
        let text = by_vertices(0.0).replace("VERTEX CURVE_P c 3 1", bad);
        let found = line(&[("a.geomTurbo", &text)], 1, &Options::default());
        assert_eq!((found.0, found.2), ("IMP1002", at(&text, bad)), "{bad}");
    }
}

/// The head may state the unit; nothing may contradict it.
#[test]
fn the_head_may_state_the_unit() {
    let head = |factor: &str, text: &str| text.replace("TOLERANCE", &format!("UNITS-FACTOR {factor}\nTOLERANCE"));
    let without = file(0.001, false).replace("units 0.001", "");
    let due = good(&[("a.geomTurbo", &file(0.001, false))], 1, &Options::default());
    let read = good(&[("a.geomTurbo", &head("0.001", &without))], 1, &Options::default());
    assert!(read.hub == due.hub && read.rows[0].blades[0].sections == due.rows[0].blades[0].sections);
    let millimetres = Options { unit: Some(LengthUnit::Millimetre), ..Options::default() };
    assert_eq!(line(&[("a.geomTurbo", &head("1", &without))], 1, &millimetres).0, "IMP1005");
    assert_eq!(line(&[("a.geomTurbo", &head("1", &file(0.001, false)))], 1, &Options::default()).0, "IMP1005");
    assert_eq!(line(&[("a.geomTurbo", &head("0", &without))], 1, &Options::default()).0, "IMP1002");
}

#[test]
fn faults_are_told_with_their_line() {
    let text = file(1.0, false);
    let at = |words: &str| text.lines().position(|l| l.trim() == words).unwrap() + 1;
    for (from, to, code, due) in [
        ("  units 1\n", "  units -1\n", "IMP1002", at("units 1")),
        ("  units 1\n", "  units one\n", "IMP1002", at("units 1")),
        (" PERIODICITY 7\n", " PERIODICITY 7.5\n", "IMP1002", at("PERIODICITY 7")),
        (" PERIODICITY 7\n", " PERIODICITY 0\n", "IMP1002", at("PERIODICITY 7")),
        ("XYZ\n33\n", "XYZ\n34\n", "IMP1002", at("XYZ") + 34 + 2),
        ("XYZ\n33\n", "XYZ\n32\n", "IMP1002", at("XYZ") + 32 + 2),
        ("XYZ\n33\n", "XYZ\n100000000\n", "IMP1006", at("XYZ") + 1),
        ("XYZ\n33\n", "XYZ\n-1\n", "IMP1002", at("XYZ") + 1),
        (" SECTIONAL\n 2\n", " SECTIONAL\n 3\n", "IMP1002", at("pressure")),
        (" SECTIONAL\n 2\n", " SECTIONAL\n 99999\n", "IMP1006", at("SECTIONAL") + 1),
        (" suction\n", " sucking\n", "IMP1002", at("SECTIONAL")),
        (" NI_END nibladegeometry\n", "", "IMP1002", at("NI_END NIBlade") - 1),
        ("   NI_END zrcurve\n", "   NI_END curve\n", "IMP1002", at("NI_END zrcurve")),
    ] {
        assert!(text.contains(from), "{from}");
        let changed = text.replacen(from, to, 1);
        let found = line(&[("a.geomTurbo", &changed)], 1, &Options::default());
        assert_eq!((found.0, found.2), (code, due), "{from:?} {to:?}");
    }
    let deep = format!("{text}{}", "NI_BEGIN x\n".repeat(100));
    assert_eq!(line(&[("a.geomTurbo", &deep)], 1, &Options::default()).0, "IMP1002");
}

/// A file that is cut off anywhere before the end of its row is refused.
#[test]
fn cut_files_are_refused() {
    let text = file(1.0, false);
    let lines: Vec<&str> = text.lines().collect();
    let whole = lines.iter().position(|l| *l == "NI_END nirow").unwrap() + 1;
    for count in 0..lines.len() {
        let cut = lines[..count].join("\n");
        let files = [("a.geomTurbo", cut.as_str())];
        let open = lines[..count].last() == Some(&"NI_BEGIN GEOMETRY");
        if count < whole || open {
            faults(&files, 1, &Options::default());
        } else {
            good(&files, 1, &Options::default());
        }
    }
}

/// An example for other tests.
pub fn example() -> Vec<(String, String)> {
    vec![("a.geomTurbo".to_owned(), file(0.001, false))]
}
