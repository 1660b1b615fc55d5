//! Faces of STEP files that meet in a line at the edges of the blade: lofts through closed sections.

use super::{faults, good, noted};
use crate::support::round_trip::part_files;
use crate::support::step_text::{HubKind, MadeWheel, OVAL};
use impellerc::blade::outline::DividedSection;
use impellerc::blade::{EdgeForm, SectionForm};
use impellerc::blade_files::job_frame::Zero;
use impellerc::blade_files::outlines::outlines;
use impellerc::blade_files::part_source::PartSource;
use impellerc::blade_files::{BladeSurfaces, FaceChoice, Imported, Options, Start};
use nalgebra::Point3;
use std::f64::consts::PI;

const WHEEL: MadeWheel = MadeWheel { seam: false, holes: 1, ..OVAL };

/// A blade that is cut off at the end of the hub, on a plane across the axis.
const CUT: MadeWheel = MadeWheel { ends: [0.0, 0.8 * PI], ..WHEEL };

fn options(start: Start) -> Options {
    let picks = ["hub=hub", "pressure=pressure", "suction=suction"];
    let faces = picks.iter().map(|text| FaceChoice::parsed(text).unwrap()).collect();
    Options { blades: Some(5), faces, start: Some(start), ..Options::default() }
}

fn read(wheel: &MadeWheel, start: Start) -> Imported {
    good(&[("a.step", &wheel.text())], 1, &options(start))
}

fn divided(made: &Imported) -> Vec<DividedSection> {
    outlines(&made.rows[0], made.hub.as_deref(), &Options::default()).unwrap().remove(0)
}

fn points(made: &Imported, section: usize) -> &[Point3<f64>] {
    match &made.rows[0].blades[0].sections[section].form {
        SectionForm::DividedLoop { points, .. } => points,
        other => panic!("{other:?}"),
    }
}

/// The distance that the reader tells, um.
fn told(made: &Imported) -> f64 {
    let note = made.notes.iter().find(|note| note.text.starts_with("faces of the job lie within ")).unwrap();
    note.text.split(' ').find_map(|word| word.parse().ok()).unwrap()
}

/// Largest deviation of a point of the root from the oval, as a share of its half axes: 10 mm along the axis and 0.12 rad.
fn off_oval(made: &Imported) -> f64 {
    let value = |p: &Point3<f64>| ((p.z - 15.0) / 10.0).hypot(p.y.atan2(p.x) / 0.12);
    points(made, 0).iter().map(|p| (value(p) - 1.0).abs()).fold(0.0, f64::max)
}

/// Both faces meet at both noses: closed sections with two round edges, on the oval of the file. `--start` tells which is first.
#[test]
fn faces_that_meet_have_round_edges() {
    for (start, inlet) in [(Start::LeadingEdge, 5.0), (Start::TrailingEdge, 25.0)] {
        let made = read(&WHEEL, start);
        assert!(matches!(made.surfaces, BladeSurfaces::Loops { extend, .. } if extend < 1e-5), "{:?}", made.surfaces);
        assert_eq!(made.rows[0].blades[0].edges, [Some(EdgeForm::Round); 2]);
        let (off, told) = (off_oval(&made), told(&made));
        println!("{off:.1e} {told} um");
        assert!(off < 1e-5 && told < 0.5, "{off} {told}");
        // The part states no less than that.
        assert!((1e3 * made.moved - told) > -0.01 && made.moved < 2e-3, "{} {told}", made.moved);
        for section in divided(&made) {
            let [leading, trailing] = &section.outline.edges;
            // Each edge goes round its nose.
            assert!(leading.iter().any(|p| (p.z - inlet).abs() < 0.01), "{leading:?}");
            assert!(trailing.iter().any(|p| (p.z - (30.0 - inlet)).abs() < 0.01), "{trailing:?}");
        }
        assert!(noted(&made, "both faces meet at the inlet without a face between them"));
        let (read, row) = (["a.step".to_owned()], &made.rows[0]);
        let sections = [divided(&made)];
        let part = PartSource::new(&made, row, &sections, &read, "again", Zero::File);
        let diag = part.lies_within(0.9 * made.moved).expect_err("the limit is smaller");
        let help = diag.help.unwrap();
        let (_, enough) = help.split_once("`--within ").unwrap_or_else(|| panic!("{help}"));
        let enough: f64 = enough.split_once("mm`").unwrap().0.parse().unwrap();
        assert!(diag.code.id() == "IMP1011" && part.lies_within(enough).is_ok(), "{help}");
        let job = part_files(&made).job;
        for words in ["sections loops from", "leading-edge round", "trailing-edge round"] {
            assert!(job.contains(words), "{words} is not in\n{job}");
        }
    }
}

/// The edges are those that the same points have as a table of closed sections.
#[test]
fn edges_are_those_of_closed_sections() {
    let made = read(&WHEEL, Start::LeadingEdge);
    let mut table = made.clone();
    for section in &mut table.rows[0].blades[0].sections {
        let SectionForm::DividedLoop { points, .. } = &section.form else { panic!() };
        section.form = SectionForm::Loop(points.clone());
    }
    assert_eq!(divided(&made), divided(&table));
}

/// Where both faces meet beside the nose, the edge goes round the nose all the same.
#[test]
fn faces_may_meet_beside_the_nose() {
    let made = read(&MadeWheel { ends: [0.1, 0.1 + PI], ..WHEEL }, Start::LeadingEdge);
    let (off, told) = (off_oval(&made), told(&made));
    println!("{off:.1e} {told} um");
    assert!(off < 1e-5 && told < 0.5, "{off} {told}");
    for section in divided(&made) {
        for (edge, z) in section.outline.edges.iter().zip([5.0, 25.0]) {
            let [first, last] = [edge[0], edge[edge.len() - 1]];
            // The nose is inside of the edge, and its ends lie on both faces.
            assert!(edge.iter().any(|p| (p.z - z).abs() < 0.01) && first.y * last.y < 0.0, "{edge:?}");
        }
    }
}

/// Faces that meet at the inlet alone: the other edge is cut off by the lathe, with a face of its own or without.
#[test]
fn an_outlet_may_be_cut_off() {
    let bare = CUT.text().replace("ADVANCED_FACE('outlet'", "ORIENTED_FACE('outlet'");
    for text in [CUT.text(), bare] {
        let made = good(&[("a.step", &text)], 1, &options(Start::LeadingEdge));
        assert_eq!(made.rows[0].blades[0].edges, [Some(EdgeForm::Round), Some(EdgeForm::CutOff)]);
        assert!(told(&made) < 0.5 && off_oval(&made) < 1e-5, "{} {}", told(&made), off_oval(&made));
        let end = 15.0 - 10.0 * (0.8 * PI).cos();
        let width = 2.0 * 20.0 * (0.12 * (0.8 * PI).sin()).sin();
        let root = &divided(&made)[0];
        assert!((root.edges[1].width - width).abs() < 1e-4, "{} {width}", root.edges[1].width);
        // The hub ends there, and at the inlet it goes on.
        let hub = made.hub.as_ref().unwrap();
        assert!((hub[hub.len() - 1][1] - end).abs() < 1e-6 && hub[0][1].abs() < 1e-9, "{hub:?}");
    }
}

/// The same from the other side: the nose is the outlet.
#[test]
fn an_inlet_may_be_cut_off() {
    let made = read(&CUT, Start::TrailingEdge);
    assert_eq!(made.rows[0].blades[0].edges, [Some(EdgeForm::CutOff), Some(EdgeForm::Round)]);
    assert!(told(&made) < 0.5 && off_oval(&made) < 1e-5);
}

/// Other senses of faces, and the other face as pressure face, give the same points.
#[test]
fn senses_change_nothing() {
    let due = read(&WHEEL, Start::LeadingEdge);
    let given = WHEEL.text();
    let text = given.lines().map(|line| {
        let other = line.contains("ADVANCED_FACE") || line.contains("FACE_BOUND");
        if other { line.replace(",.T.);", ",.F.);") } else { line.to_owned() }
    });
    let text: String = text.map(|line| line + "\n").collect();
    let made = good(&[("a.step", &text)], 1, &options(Start::LeadingEdge));
    for section in 0..due.rows[0].blades[0].sections.len() {
        let [a, b] = [&due, &made].map(|read| points(read, section));
        let apart = a.iter().zip(b).map(|(p, q)| nalgebra::distance(p, q)).fold(0.0, f64::max);
        assert!(a.len() == b.len() && apart < 1e-9, "{apart}");
    }
    let picks = ["hub=hub", "pressure=suction", "suction=pressure"];
    let faces = picks.iter().map(|text| FaceChoice::parsed(text).unwrap()).collect();
    let other = good(&[("a.step", &WHEEL.text())], 1, &Options { faces, ..options(Start::LeadingEdge) });
    for (a, b) in divided(&due).iter().zip(&divided(&other)) {
        assert_ne!(a.pressure, b.pressure);
        assert_eq!(a.edges.map(|edge| edge.form), b.edges.map(|edge| edge.form));
    }
}

/// Radial wheels and cones: the radii tell the inlet, and the faces meet as well.
#[test]
fn noses_stand_on_all_hubs() {
    for hub in [HubKind::Cone, HubKind::Torus, HubKind::Turned, HubKind::Plane] {
        let picks = Options { start: None, ..options(Start::LeadingEdge) };
        let made = good(&[("a.step", &MadeWheel { hub, ..WHEEL }.text())], 1, &picks);
        assert_eq!(made.rows[0].blades[0].edges, [Some(EdgeForm::Round); 2]);
        println!("{hub:?} {} um", told(&made));
        assert!(told(&made) < 2.0, "{hub:?}: {}", told(&made));
    }
}

/// Faces that meet in a sharp edge are no blade: no tool leaves one.
#[test]
fn sharp_edges_are_refused() {
    let even = |angle: f64| (1.0 + 4.0 * (1.0 - (angle / PI - 1.0).abs())) / 6.0;
    let wheel = MadeWheel { along: even, ..WHEEL };
    let fault = &faults(&[("a.step", &wheel.text())], 1, &options(Start::LeadingEdge))[0];
    assert_eq!(fault.code.id(), "IMP1007");
    assert!(format!("{fault:?}").contains("the edge has no thickness"), "{fault:?}");
}

/// An edge that is picked must be at the end that `--start` says.
#[test]
fn start_and_a_picked_edge_may_not_contradict() {
    let text = CUT.text();
    let with = |start| {
        let mut stated = options(start);
        stated.faces.push(FaceChoice::parsed("outlet=outlet").unwrap());
        stated
    };
    assert_eq!(faults(&[("a.step", &text)], 1, &with(Start::TrailingEdge))[0].code.id(), "IMP1005");
    assert!(noted(&good(&[("a.step", &text)], 1, &with(Start::LeadingEdge)), "`outlet` tells the inlet"));
}
