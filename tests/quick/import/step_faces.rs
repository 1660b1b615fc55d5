//! Faces of STEP files as other programs write them: without names, in the other sense, with fillets.

use super::{faults, good, noted};
use crate::support::jobs;
use crate::support::round_trip::{compiled, differences, foreign, imported, number, part_files, step_file};
use impellerc::blade::SectionForm;
use impellerc::blade_files::{BladeSurfaces, FaceChoice, Imported, Options};
use nalgebra::Point3;

fn picks(texts: &[String]) -> Options {
    let faces = texts.iter().map(|text| FaceChoice::parsed(text).expect("a choice")).collect();
    Options { faces, ..Options::default() }
}

/// Points of all sections of a wheel.
fn points(imported: &Imported) -> Vec<Point3<f64>> {
    let of = |form: &SectionForm| match form {
        SectionForm::Loop(points) | SectionForm::DividedLoop { points, .. } => points.clone(),
        SectionForm::Faces(faces) => faces.concat(),
        SectionForm::MeanLine { .. } => panic!("a mean line"),
    };
    imported.rows[0].blades.iter().flat_map(|blade| &blade.sections).flat_map(|section| of(&section.form)).collect()
}

/// Largest distance of points of one wheel from those with the same number of the other one.
fn apart(a: &Imported, b: &Imported) -> f64 {
    let (a, b) = (points(a), points(b));
    assert_eq!(a.len(), b.len());
    a.iter().zip(&b).map(|(p, q)| nalgebra::distance(p, q)).fold(0.0, f64::max)
}

/// Picks of hub, both faces and a face at the inlet, by number.
fn by_number(file: &str) -> Vec<String> {
    let hub = file.lines().filter(|line| line.contains("ADVANCED_FACE('hub of channel"));
    let hub = hub.map(|line| format!("hub={}", line.split('=').next().unwrap()));
    let main =
        [("pressure", "vane 1 pressure face"), ("suction", "vane 1 suction face"), ("inlet", "vane 1 inlet edge")];
    hub.chain(main.map(|(role, name)| format!("{role}={}", number(file, name)))).collect()
}

/// Faces that are picked by number in a file without names, with all senses the other way, give the same wheel. The faces of the
/// edges are not picked: they are found by the edges that they share.
#[test]
fn sense_order_and_names_change_nothing() {
    for name in ["small", "blisk"] {
        let program = jobs::program(name, None);
        let file = step_file(&program.part.without_fillets(), &program);
        let due = imported(&file, &Options::default());
        let made = imported(&foreign(&file), &picks(&by_number(&file)));
        assert_eq!(made.rows[0].count, due.rows[0].count);
        assert_eq!(std::mem::discriminant(&made.surfaces), std::mem::discriminant(&due.surfaces));
        let off = apart(&due, &made);
        assert!(off < 1e-6, "{name}: {off}");
    }
}

/// The radius of a fillet is found from its faces; faces of blades that end at a fillet go on to the hub.
#[test]
fn fillets_are_found_by_their_faces() {
    let program = jobs::program("small", None);
    let file = step_file(&program.part, &program);
    let read = imported(&file, &Options::default());
    let fillet = read.rows[0].blades[0].fillet.unwrap_or_else(|| panic!("{:?}", read.notes));
    let due = program.part.main().fillet.as_ref().unwrap().least().get();
    assert!((fillet - due).abs() < 1e-3, "{fillet}");
    assert!(
        matches!(read.surfaces, BladeSurfaces::Ruled { extend } | BladeSurfaces::Lofted { extend } if extend > 0.5)
    );
    assert!(noted(&read, "the fillet of the main blade is 1.2 mm by 2 faces"), "{:?}", read.notes);
    assert!(part_files(&read).job.contains("    fillet 1.2 mm\n"));
    let again = compiled(&read, &std::fs::read_to_string("jobs/small/small.imp").unwrap());
    let off = differences(&program, &again);
    println!("{off:?}");
    // The faces that were read are those of the part; below them they go on straight to the hub.
    assert!(off.blades[1] < 1e-3 && off.blades[0] < 0.02 && off.turned < 1e-3, "{off:?}");
    // Without names and picks of the fillets the user is told where the faces end.
    let made = imported(&foreign(&file), &picks(&by_number(&file)));
    assert_eq!(made.rows[0].blades[0].fillet, None);
    assert!(noted(&made, "which is no face of the hub: its faces are extended to the hub"), "{:?}", made.notes);
}

/// A face that is no fillet of a rolling ball gives no fillet, and the user is told.
#[test]
fn what_is_no_fillet_gives_none() {
    let program = jobs::program("small", None);
    let file = step_file(&program.part.without_fillets(), &program);
    let tip = imported(&file, &picks(&["fillet=vane 1 outlet edge".to_owned()]));
    assert_eq!(tip.rows[0].blades[0].fillet, None);
    assert!(noted(&tip, "the fillet of the main blade is not constant"), "{:?}", tip.notes);
    let hub = picks(&["fillet=hub of channel 1".to_owned(), "hub=hub of channel 2".to_owned()]);
    let fault = &faults(&[("a.step", &file)], 1, &hub)[0];
    assert_eq!((fault.code.id(), fault.message.contains("are no fillets")), ("IMP1007", true), "{fault:?}");
}

/// Faces of two blades are not one blade, and an edge without faces that lead round it is asked for.
#[test]
fn faces_that_do_not_belong_together_are_refused() {
    let program = jobs::program("blisk", None);
    let file = step_file(&program.part.without_fillets(), &program);
    let other = picks(&["suction=vane 3 suction face".to_owned()]);
    let fault = &faults(&[("a.step", &file)], 1, &other)[0];
    assert_eq!((fault.code.id(), fault.message.contains("different blades")), ("IMP1005", true), "{fault:?}");
    // The faces of the edges are nothing that is read.
    let bare = ["inlet", "outlet"].iter().fold(file.clone(), |text, end| {
        text.replace(&format!("ADVANCED_FACE('vane 1 {end} edge'"), &format!("ORIENTED_FACE('vane 1 {end} edge'"))
    });
    let inlet = picks(&["inlet=vane 2 inlet edge".to_owned()]);
    let fault = &faults(&[("a.step", &bare)], 1, &inlet)[0];
    assert_eq!((fault.code.id(), fault.message.contains("the inlet edge")), ("IMP1004", true), "{fault:?}");
    assert!(good(&[("a.step", &file)], 1, &Options::default()).rows.len() == 1);
}
