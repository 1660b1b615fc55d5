//! The messages of faulty files as goldens, one for each code.

use super::{axial_loop, human};
use impellerc::base::source::{SourceFile, SourceMap};
use impellerc::blade_files::outlines::{doubtful, outlines};
use impellerc::blade_files::{self, Axis, LengthUnit, Options};
use impellerc::diagnostics::codes::import as codes;

/// An example: code, files, options. The first file is given.
type Example = (&'static str, Vec<(&'static str, String)>, Options);

fn examples() -> Vec<Example> {
    let all =
        Options { unit: Some(LengthUnit::Millimetre), axis: Some(Axis::Z), blades: Some(7), ..Options::default() };
    let loops = |shift: usize, change: fn(&mut Vec<[f64; 3]>)| {
        let mut text = "section,x,y,z\n".to_owned();
        for (k, radius) in [50.0, 60.0].into_iter().enumerate() {
            let mut points = axial_loop(radius, 40, shift);
            change(&mut points);
            for [x, y, z] in points {
                text.push_str(&format!("{},{x:.4},{y:.4},{z:.4}\n", k + 1));
            }
        }
        text
    };
    let keep: fn(&mut Vec<[f64; 3]>) = |_| {};
    vec![
        ("IMP1001", vec![("rotor.cft", "Begin Model\n".to_owned())], Options::default()),
        ("IMP1002", vec![("main.csv", loops(0, keep).replacen("2,60", "2,6O", 1))], all.clone()),
        ("IMP1003", vec![("main.csv", loops(0, |points| points.truncate(25)))], all.clone()),
        ("IMP1004", vec![("main.csv", loops(0, keep))], Options::default()),
        (
            "IMP1005",
            vec![("a.inf", "Geometry Units: CM\nAxis of Rotation: Z\nNumber of Blade Sets: 7\n".to_owned())],
            Options { unit: Some(LengthUnit::Millimetre), ..Options::default() },
        ),
        (
            "IMP1006",
            vec![("main.csv", loops(0, keep).replacen("2,60", "2,60e9", 1).replacen("60e9.", "60", 1))],
            all.clone(),
        ),
        (
            "IMP1007",
            vec![("a.rtzt", "7\n0\n0.0\n2\nN\n0.0 3 t\n".to_owned())],
            Options { axis: None, blades: None, ..all.clone() },
        ),
        ("IMP1008", vec![("main.csv", loops(0, keep))], all.clone()),
        (
            "IMP1009",
            vec![("main.csv", loops(0, |points| points[12][0] += 0.2))],
            Options {
                start: Some(blade_files::Start::LeadingEdge),
                side: Some(impellerc::blade::outline::Side::Greater),
                ..all
            },
        ),
    ]
}

/// All that is said of an example.
fn said((_, files, options): &Example) -> String {
    let mut sources = SourceMap::default();
    let mut fetch = |name: &str, _: usize| {
        let found = files.iter().find(|(n, _)| *n == name);
        found
            .map(|(n, text)| SourceFile::text(*n, text))
            .ok_or_else(|| blade_files::NoFile::from("there is no such file".to_owned()))
    };
    let names = vec![files[0].0.to_owned()];
    let diags = match blade_files::read(&names, &mut fetch, options, &mut sources) {
        Err(diags) => diags,
        Ok(imported) => match outlines(&imported.rows[0], imported.hub.as_deref(), options) {
            Err(diag) => vec![diag],
            Ok(divided) => doubtful(&imported.rows[0].blades[0], &divided[0]),
        },
    };
    human(&diags, &sources)
}

#[test]
fn each_code_is_told_as_pinned() {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../../../golden/import");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    let examples = examples();
    for example in &examples {
        let said = said(example);
        assert!(said.contains(example.0), "{} is not in {said}", example.0);
        settings.bind(|| insta::assert_snapshot!(example.0, said));
    }
    // The command alone makes the last two, see `command`.
    for code in codes::ALL.iter().filter(|code| ![codes::EXISTS, codes::LEFT_OUT].contains(*code)) {
        assert!(examples.iter().any(|(id, ..)| *id == code.id()), "{code} has no example");
    }
}
