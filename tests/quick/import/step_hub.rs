//! Hub and shroud of STEP files by their surfaces: with and without seams, with feet of blades as holes.

use super::{faults, good, noted};
use crate::support::step_text::{HubKind, MadeWheel, OVAL};
use impellerc::blade_files::{FaceChoice, Imported, Options, Start};
use nalgebra::Vector2;

const KINDS: [HubKind; 8] = [
    HubKind::Cylinder,
    HubKind::Cone,
    HubKind::Torus,
    HubKind::Sphere,
    HubKind::Turned,
    HubKind::Moved,
    HubKind::Spline,
    HubKind::Plane,
];

/// Picks of hub, pressure and suction face by name, with the inlet at the lower end along the axis; a plane tells it by its radii.
fn options(wheel: &MadeWheel) -> Options {
    let mut picks = vec!["hub=hub", "pressure=pressure", "suction=suction"];
    if wheel.shroud {
        picks.push("shroud=shroud");
    }
    let faces = picks.iter().map(|text| FaceChoice::parsed(text).unwrap()).collect();
    let start = (wheel.hub != HubKind::Plane).then_some(Start::LeadingEdge);
    Options { blades: Some(5), faces, start, ..Options::default() }
}

fn read(wheel: &MadeWheel) -> Imported {
    good(&[("a.step", &wheel.text())], 1, &options(wheel))
}

/// Largest distance of points of a meridian from a curve, and of the ends of both from each other, mm.
fn off(points: &[[f64; 2]], curve: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let dense: Vec<Vector2<f64>> = (0..=20_000).map(|k| curve(f64::from(k) / 20_000.0).into()).collect();
    let chord = |p: Vector2<f64>, w: &[Vector2<f64>]| {
        let way = w[1] - w[0];
        (p - w[0] - way * ((p - w[0]).dot(&way) / way.norm_squared()).clamp(0.0, 1.0)).norm()
    };
    let from = |p: &[f64; 2]| dense.windows(2).map(|w| chord(Vector2::from(*p), w)).fold(f64::INFINITY, f64::min);
    let ends = [(points[0], dense[0]), (points[points.len() - 1], dense[dense.len() - 1])];
    let ends = ends.map(|(p, q)| (Vector2::from(p) - q).norm());
    [points.iter().map(from).fold(0.0, f64::max), ends[0].max(ends[1])]
}

/// A hub of every kind of surface has its own meridian: with a seam and without, with no foot of a blade as a hole, one and four. The
/// foot of the blade takes two thirds of the meridian, so its border is longer there and back than the meridian.
#[test]
fn hubs_have_the_meridian_of_their_surface() {
    for hub in KINDS {
        for (seam, holes) in [(true, 0), (true, 1), (false, 0), (false, 1)] {
            let wheel = MadeWheel { hub, seam, holes, ..OVAL };
            let made = read(&wheel);
            let [far, ends] = off(made.hub.as_ref().unwrap(), |s| hub.at(s));
            println!("{hub:?} {seam} {holes}: {far:.1e} {ends:.1e}");
            assert!(far < 1e-4 && ends < 1e-6, "{hub:?}, seam {seam}, {holes} holes: {far} mm, ends {ends} mm");
            assert!(noted(&made, "the axis of rotation is z: the hub is turned about it alone"), "{hub:?}");
        }
    }
}

/// Feet of several blades are holes as well.
#[test]
fn a_hub_may_have_several_holes() {
    for hub in [HubKind::Cylinder, HubKind::Spline, HubKind::Plane] {
        let made = read(&MadeWheel { hub, seam: false, holes: 4, ..OVAL });
        let [far, ends] = off(made.hub.as_ref().unwrap(), |s| hub.at(s));
        assert!(far < 1e-4 && ends < 1e-6, "{hub:?}: {far} {ends}");
    }
}

/// A shroud between two rings, with the tips as a hole, has the meridian of its surface.
#[test]
fn shrouds_with_holes_are_read() {
    for hub in [HubKind::Cylinder, HubKind::Torus, HubKind::Plane] {
        let wheel = MadeWheel { hub, seam: false, holes: 1, shroud: true, ..OVAL };
        let made = read(&wheel);
        let [far, ends] = off(made.shroud.as_ref().unwrap(), |s| wheel.hub.above(s));
        assert!(far < 1e-4 && ends < 1e-5, "{hub:?}: {far} {ends}");
    }
}

/// Other senses of faces and borders change nothing.
#[test]
fn senses_of_hubs_change_nothing() {
    for hub in KINDS {
        let wheel = MadeWheel { hub, seam: false, holes: 1, ..OVAL };
        let text = wheel.text();
        let turned = |words: &[&str]| -> String {
            let line = |line: &str| {
                let other = words.iter().any(|word| line.contains(word));
                if other { line.replace(",.T.);", ",.F.);") } else { line.to_owned() }
            };
            text.lines().map(|text| line(text) + "\n").collect()
        };
        let due = read(&wheel);
        for words in [&["FACE_BOUND"][..], &["ADVANCED_FACE"], &["FACE_BOUND", "ADVANCED_FACE"]] {
            let made = good(&[("a.step", &turned(words))], 1, &options(&wheel));
            let [made, due] = [&made, &due].map(|read| read.hub.as_ref().unwrap());
            let apart = made.iter().zip(due).map(|(p, q)| (Vector2::from(*p) - Vector2::from(*q)).norm());
            assert!(made.len() == due.len() && apart.fold(0.0, f64::max) < 1e-9, "{hub:?} {words:?}");
        }
    }
}

/// A hub that holds the axis goes on to it: a plane and the cap of a sphere inside of one ring.
#[test]
fn hubs_go_on_to_the_axis() {
    let plane = MadeWheel { hub: HubKind::Plane, seam: false, holes: 1, ..OVAL };
    let text = without_first_ring(&plane.text());
    let made = good(&[("a.step", &text)], 1, &options(&plane));
    let line = made.hub.unwrap();
    let [first, last] = [line[0], line[line.len() - 1]];
    assert!(first[0].abs() < 1e-9 && (last[0] - 50.0).abs() < 1e-9, "{first:?} {last:?}");
    let sphere = MadeWheel { hub: HubKind::Sphere, seam: false, holes: 1, ..OVAL };
    let made = good(&[("a.step", &without_first_ring(&sphere.text()))], 1, &options(&sphere));
    let line = made.hub.unwrap();
    let [first, last] = [line[0], line[line.len() - 1]];
    // The ring that is left is the upper one, and the foot of the blade is below it: so is the pole.
    assert!(first[0].abs() < 1e-6 && (first[1] + 10.0).abs() < 1e-6, "{first:?}");
    assert!((last[0] - 20.0).abs() < 1e-6 && (last[1] - 30.0).abs() < 1e-6, "{last:?}");
    let cone = MadeWheel { hub: HubKind::Cone, seam: false, holes: 1, ..OVAL };
    let made = good(&[("a.step", &without_first_ring(&cone.text()))], 1, &options(&cone));
    let line = made.hub.unwrap();
    assert!(line[0][0] < 1e-6 && (line[0][1] + 20.0 / 0.3).abs() < 1e-6, "{:?}", line[0]);
}

/// The file with a hub that lacks the first of its rings.
fn without_first_ring(text: &str) -> String {
    let hub = text.lines().find(|line| line.contains("ADVANCED_FACE('hub'")).unwrap();
    let (head, bounds) = hub.split_once("('hub',(").unwrap();
    let (_, rest) = bounds.split_once(',').unwrap();
    text.replace(hub, &format!("{head}('hub',({rest}"))
}

/// A hub whose surface is not turned about the axis of its rings is refused, with finite distances.
#[test]
fn what_is_not_turned_is_refused_with_figures() {
    let wheel = MadeWheel { seam: false, holes: 1, ..OVAL };
    let text = wheel.text();
    // The cylinder about another axis, and a plane along the axis.
    let line = text.lines().find(|line| line.contains("CYLINDRICAL_SURFACE")).unwrap();
    let (number, _) = line.split_once('=').unwrap();
    let frame = "#9000=CARTESIAN_POINT('',(0.,0.,0.));\n#9001=DIRECTION('',(1.,0.,0.));\n#9002=DIRECTION('',(0.,1.,0.));\n\
                 #9003=AXIS2_PLACEMENT_3D('',#9000,#9001,#9002);\n";
    for surface in ["CYLINDRICAL_SURFACE('',#9003,20.)", "PLANE('',#9003)"] {
        let other = text.replace(line, &format!("{frame}{number}={surface};"));
        let fault = &faults(&[("a.step", &other)], 1, &options(&wheel))[0];
        let told: Vec<&str> = fault.labels.iter().map(|label| label.text.as_str()).collect();
        let told = format!("{} {}", fault.message, told.join(" "));
        assert!(["IMP1005", "IMP1007"].contains(&fault.code.id()) && !told.contains("inf"), "{told}");
    }
}

/// Both ends of the blade have one radius: the fault names their heights, and `--start` answers.
#[test]
fn start_tells_the_inlet_along_the_axis() {
    let wheel = MadeWheel { seam: false, holes: 1, ..OVAL };
    let text = wheel.text();
    let unknown = Options { start: None, ..options(&wheel) };
    let fault = &faults(&[("a.step", &text)], 1, &unknown)[0];
    let help = fault.help.as_deref().unwrap();
    assert_eq!(fault.code.id(), "IMP1004");
    assert!(help.contains("`--start leading` where the inlet is at z = 5 mm"), "{help}");
    assert!(help.contains("`--start trailing` where it is at z = 25 mm"), "{help}");
    for (start, first) in [(Start::LeadingEdge, 0.0), (Start::TrailingEdge, 30.0)] {
        let made = good(&[("a.step", &text)], 1, &Options { start: Some(start), ..options(&wheel) });
        assert!((made.hub.unwrap()[0][1] - first).abs() < 1e-9);
    }
    // A plane across the axis has no height along it.
    let plane = MadeWheel { hub: HubKind::Plane, ..wheel };
    let stated = Options { start: Some(Start::LeadingEdge), ..options(&plane) };
    assert_eq!(faults(&[("a.step", &plane.text())], 1, &stated)[0].code.id(), "IMP1005");
}
