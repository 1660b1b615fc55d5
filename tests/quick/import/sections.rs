//! Sections against shapes whose faces and edges are known.

use super::axial_loop;
use impellerc::blade::facts::{SectionFact, facts};
use impellerc::blade::outline::{DividedSection, Inlet, Known, OutlineFault, Side, outline, pressure_side};
use impellerc::blade::{EdgeForm, MeanPoint, Section, SectionForm, ThicknessDirection};
use nalgebra::Point3;
use proptest::prelude::*;

const KNOWN: Known<'_> = Known { inlet: Inlet::Meridian(&[[50.0, -5.0], [50.0, 25.0]]), pressure: Side::Greater };

fn section(points: &[[f64; 3]]) -> Section {
    Section { span: None, form: SectionForm::Loop(points.iter().map(|p| Point3::from(*p)).collect()) }
}

fn divided(points: &[[f64; 3]]) -> DividedSection {
    outline(&section(points), &KNOWN).unwrap()
}

/// A loop in the plane y, z far from the axis, as a blade of thickness 2 with a half ellipse at its start and a cut at its
/// end.
fn ellipse_and_cut(depth: f64, points_of_edge: usize) -> Vec<[f64; 3]> {
    let at = |y: f64, z: f64| [1000.0, y, z];
    let mut points: Vec<[f64; 3]> = (0..=points_of_edge)
        .map(|k| {
            let t = std::f64::consts::PI * k as f64 / points_of_edge as f64;
            at(-t.cos(), depth - depth * t.sin())
        })
        .collect();
    points.extend((1..=30).map(|k| at(1.0, depth + 40.0 * f64::from(k) / 30.0)));
    points.extend((0..30).map(|k| at(-1.0, depth + 40.0 - 40.0 * f64::from(k) / 30.0)));
    points
}

#[test]
fn round_edges_have_their_radius_from_any_start() {
    // The bend of the mean line is slight, so that both edges are half circles of radius 1.
    for shift in [0, 1, 7, 60, 100, 133, 199] {
        let points = axial_loop(50.0, 200, shift);
        let d = divided(&points);
        // Where the mean line is along Z the edge is a half circle, within a step of 0.24 mm; at the other end it is sheared.
        let [edge, other] = d.edges;
        assert_eq!((edge.form, other.form), (EdgeForm::Round, EdgeForm::Round));
        assert!((edge.radius - 1.0).abs() < 0.2 && (edge.width - 2.0).abs() < 0.1, "{edge:?}");
        assert!((edge.depth - 1.0).abs() < 0.25 && edge.residual < 0.15, "{edge:?}");
        assert!((d.thickness - 2.0).abs() < 0.05, "{}", d.thickness);
        let [pressure, suction] = &d.outline.faces;
        assert!(pressure[0].z < 2.0 && pressure.last().unwrap().z > 18.0);
        assert!(pressure[20].y / 50.0 > suction[20].y / 50.0, "the pressure face is at the greater angle");
        // The mean line turns from 0 to 2 * 0.01 * 20 mm per mm; without a tenth at each end.
        assert!(d.turn > 0.2 && d.turn < 0.4 && d.wrap > 0.0, "{} {}", d.turn, d.wrap);
    }
}

#[test]
fn an_ellipse_and_a_cut_are_found() {
    for (depth, count) in [(0.5, 24), (1.0, 24), (2.0, 40)] {
        let points = ellipse_and_cut(depth, count);
        let inlet = Inlet::Meridian(&[[1000.0, -1.0], [1000.0, 50.0]]);
        let d = outline(&section(&points), &Known { inlet, ..KNOWN }).unwrap();
        let [leading, trailing] = d.edges;
        assert_eq!((leading.form, trailing.form), (EdgeForm::Round, EdgeForm::CutOff));
        assert!((leading.width - 2.0).abs() < 1e-9 && (leading.depth - depth).abs() < 1e-9, "{leading:?}");
        assert!((leading.radius - 1.0 / depth).abs() < 1e-9 && leading.residual < 1e-9, "{leading:?}");
        assert_eq!(leading.points, count + 1);
        assert!((trailing.width - 2.0).abs() < 1e-9 && trailing.residual < 1e-12, "{trailing:?}");
        assert_eq!(d.outline.faces.each_ref().map(Vec::len), [31, 31]);
        assert!((d.thickness - 2.0).abs() < 1e-9);
    }
    // A cut with points on it is the same.
    let mut points = ellipse_and_cut(2.0, 40);
    let at = points.iter().position(|p| p[1] == 1.0 && p[2] == 42.0).unwrap();
    for y in [-0.5, 0.0, 0.5] {
        points.insert(at + 1, [1000.0, y, 42.0]);
    }
    let inlet = Inlet::Meridian(&[[1000.0, -1.0], [1000.0, 50.0]]);
    let d = outline(&section(&points), &Known { inlet, ..KNOWN }).unwrap();
    assert_eq!((d.edges[1].form, d.edges[1].points, d.outline.edges[1].len()), (EdgeForm::CutOff, 2, 2));
}

#[test]
fn a_lens_has_sharp_edges() {
    let arc = |sign: f64| {
        (0..=20).map(move |k| [1000.0, sign * (f64::from(k) / 20.0 * std::f64::consts::PI).sin(), f64::from(k)])
    };
    let mut points: Vec<[f64; 3]> = arc(1.0).collect();
    points.extend(arc(-1.0).rev().skip(1).take(19));
    let inlet = Inlet::Meridian(&[[1000.0, -1.0], [1000.0, 50.0]]);
    let d = outline(&section(&points), &Known { inlet, ..KNOWN }).unwrap();
    assert_eq!(d.edges.map(|e| e.form), [EdgeForm::Sharp; 2]);
    assert_eq!(d.outline.edges.each_ref().map(Vec::len), [1, 1]);
    assert_eq!(d.outline.faces.each_ref().map(Vec::len), [21, 21]);
}

#[test]
fn the_inlet_tells_the_leading_edge() {
    let points = axial_loop(50.0, 200, 0);
    let with = |inlet| outline(&section(&points), &Known { inlet, ..KNOWN });
    let first = |d: &DividedSection| d.outline.faces[0][0].z;
    assert!(first(&with(Inlet::Meridian(&[[50.0, 25.0], [50.0, -5.0]])).unwrap()) > 18.0);
    assert!(first(&with(Inlet::BeginsThere).unwrap()) < 2.0);
    assert!(first(&with(Inlet::BeginsAtOutlet).unwrap()) > 18.0);
    assert_eq!(with(Inlet::Unknown).unwrap_err(), OutlineFault::NoInlet);
}

/// From one end the made-up blade is that of a compressor, from the other one that of a turbine.
#[test]
fn a_blade_that_takes_up_work_shows_its_pressure_face() {
    let points = axial_loop(50.0, 200, 0);
    let mirrored: Vec<[f64; 3]> = points.iter().map(|p| [p[0], -p[1], p[2]]).collect();
    for (points, due) in [(&points, Side::Greater), (&mirrored, Side::Smaller)] {
        let from = |inlet| vec![outline(&section(points), &Known { inlet, ..KNOWN }).unwrap()];
        assert_eq!(pressure_side(&from(Inlet::Meridian(&[[50.0, 25.0], [50.0, -5.0]]))), Some(due));
        assert_eq!(pressure_side(&from(KNOWN.inlet)), None);
    }
}

/// The side of the pressure face changes the order of faces and edges, and nothing else.
#[test]
fn the_pressure_face_is_on_the_stated_side() {
    let points = axial_loop(50.0, 200, 0);
    let with = |pressure| outline(&section(&points), &Known { pressure, ..KNOWN }).unwrap();
    let (greater, smaller) = (with(Side::Greater), with(Side::Smaller));
    let [a, b] = greater.outline.faces.clone();
    assert_eq!(smaller.outline.faces, [b, a]);
    for (edge, other) in greater.outline.edges.iter().zip(&smaller.outline.edges) {
        assert_eq!(edge.iter().rev().collect::<Vec<_>>(), other.iter().collect::<Vec<_>>());
    }
    for d in [greater, smaller] {
        for end in 0..2 {
            let of_face = |face: usize| {
                let face = &d.outline.faces[face];
                if end == 0 { face.first() } else { face.last() }
            };
            assert_eq!((d.outline.edges[end].first(), d.outline.edges[end].last()), (of_face(0), of_face(1)));
        }
    }
}

#[test]
fn faces_that_are_given_keep_their_names() {
    let points: Vec<Point3<f64>> = axial_loop(50.0, 200, 0).into_iter().map(Point3::from).collect();
    let half = points.iter().position(|p| (p.z - 20.0).abs() < 1e-9).unwrap_or(100);
    let suction = points[..=half].to_vec();
    let mut pressure: Vec<_> = points[half..].iter().rev().copied().collect();
    pressure.insert(0, points[0]);
    let form = SectionForm::Faces([pressure.clone(), suction.clone()]);
    let d = outline(&Section { span: None, form }, &KNOWN).unwrap();
    assert_eq!(d.pressure, Side::Smaller);
    assert!(d.outline.faces[0].iter().all(|p| pressure.contains(p)));
    assert!(d.outline.faces[1].iter().all(|p| suction.contains(p)));
    assert!(d.edges.iter().all(|e| e.form == EdgeForm::Round && (e.width - 2.0).abs() < 0.1));
    // Without their ends they are cut off.
    let open = |face: &[Point3<f64>]| face[20..face.len() - 20].to_vec();
    let form = SectionForm::Faces([open(&pressure), open(&suction)]);
    let d = outline(&Section { span: None, form }, &KNOWN).unwrap();
    assert_eq!(d.edges.map(|e| e.form), [EdgeForm::CutOff; 2]);
    assert_eq!(d.outline.faces, [open(&pressure), open(&suction)]);
}

#[test]
fn a_mean_line_gets_half_of_its_thickness_on_each_side() {
    let mean = |k: i32| {
        let (t, r) = (f64::from(k) / 20.0, 50.0);
        let theta: f64 = 0.5 * t;
        Point3::new(r * theta.cos(), r * theta.sin(), 40.0 * t)
    };
    let points: Vec<MeanPoint> = (0..=20).map(|k| MeanPoint { position: mean(k), thickness: 2.0 }).collect();
    for (thickness, due) in [
        // On the cylinder the mean line rises by 25 mm of arc over 40 mm.
        (ThicknessDirection::Normal, 2.0),
        (ThicknessDirection::Tangential, 2.0 * 40.0 / 40.0_f64.hypot(25.0)),
    ] {
        let form = SectionForm::MeanLine { points: points.clone(), thickness };
        let d = outline(&Section { span: Some(0.5), form }, &KNOWN).unwrap();
        assert!((d.thickness - due).abs() < 0.01, "{thickness:?}: {} is not {due}", d.thickness);
        for (a, b) in d.outline.faces[0].iter().zip(&d.outline.faces[1]) {
            for p in [a, b] {
                assert!((p.x.hypot(p.y) - 50.0).abs() < 1e-9, "on the stream surface");
            }
        }
        assert_eq!(d.edges.map(|e| e.form), [EdgeForm::CutOff; 2]);
    }
    // No direction.
    let form = SectionForm::MeanLine { points: vec![points[0]; 5], thickness: ThicknessDirection::Normal };
    assert_eq!(outline(&Section { span: None, form }, &KNOWN).unwrap_err(), OutlineFault::MeanLine(0));
}

#[test]
fn facts_name_their_points() {
    let clean = axial_loop(50.0, 200, 0);
    let found = |points: &[[f64; 3]]| {
        let section = section(points);
        let outline = outline(&section, &KNOWN).ok();
        facts(&section, outline.as_ref().map(|d| &d.outline))
    };
    assert_eq!(found(&clean), []);
    let mut twice = clean.clone();
    twice.insert(30, twice[29]);
    assert_eq!(found(&twice), [SectionFact::Repeated(30)]);
    let mut bump = clean.clone();
    bump[40][0] += 0.05;
    assert!(
        matches!(found(&bump).as_slice(), [SectionFact::OffCurve(40, off)] if (off - 0.05).abs() < 0.01),
        "{:?}",
        found(&bump)
    );
    let mut gap = clean.clone();
    gap.drain(41..49);
    assert!(matches!(found(&gap)[..], [SectionFact::Gap(40, length)] if length > 1.5), "{:?}", found(&gap));
    let mut crossing = clean;
    crossing.swap(50, 53);
    assert!(
        found(&crossing).iter().any(|f| matches!(f, SectionFact::Crossing(a, b) if *a >= 48 && *b <= 55)),
        "{:?}",
        found(&crossing)
    );
}

#[test]
fn what_is_no_blade_is_refused() {
    for points in [vec![], vec![[1.0, 2.0, 3.0]; 20], vec![[50.0, 0.0, 0.0], [50.0, 1.0, 0.0], [50.0, 1.0, 5.0]]] {
        assert!(matches!(outline(&section(&points), &KNOWN), Err(OutlineFault::TooFewPoints(_))));
    }
    assert_eq!(outline(&section(&[[f64::NAN, 0.0, 0.0]; 20]), &KNOWN).unwrap_err(), OutlineFault::NoLength);
}

/// A loop whose edges are stated is divided there, also over the end of its list.
#[test]
fn stated_edges_are_kept() {
    let points: Vec<Point3<f64>> = axial_loop(50.0, 200, 0).iter().map(|p| Point3::from(*p)).collect();
    let at = |edges: [[usize; 2]; 2]| {
        let form = SectionForm::DividedLoop { points: points.clone(), edges };
        outline(&Section { span: None, form }, &KNOWN)
    };
    // The loop begins in the middle of its leading edge.
    let made = at([[195, 4], [97, 103]]).unwrap();
    assert_eq!(made.outline.edges.each_ref().map(Vec::len), [10, 7]);
    assert_eq!(made.outline.faces.each_ref().map(Vec::len), [94, 93]);
    assert_eq!(made.outline.faces.each_ref().map(|face| face[0]), [points[4], points[195]]);
    for faces in [[[4, 195], [97, 103]], [[97, 103], [97, 103]], [[195, 4], [97, 200]]] {
        assert_eq!(at(faces).unwrap_err(), OutlineFault::NoFaces, "{faces:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any points are divided or refused, and what is divided holds together.
    #[test]
    fn any_points(points in prop::collection::vec(prop::array::uniform3(-100.0..100.0_f64), 0..60), faces in any::<bool>()) {
        let all: Vec<Point3<f64>> = points.iter().map(|p| Point3::from(*p)).collect();
        let form = if faces {
            let (a, b) = all.split_at(all.len() / 3);
            SectionForm::Faces([a.to_vec(), b.to_vec()])
        } else {
            SectionForm::Loop(all)
        };
        let section = Section { span: None, form };
        if let Ok(d) = outline(&section, &KNOWN) {
            prop_assert!(d.thickness.is_finite() && d.turn.is_finite() && d.edges.iter().all(|e| e.residual.is_finite()));
            prop_assert!(d.outline.faces.iter().all(|f| f.len() >= 2) && d.outline.edges.iter().all(|e| !e.is_empty()));
            facts(&section, Some(&d.outline));
        }
        facts(&section, None);
    }
}
