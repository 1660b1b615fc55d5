//! Parts with more than one ruled vane for each sector: a splitter with a lofted face is modelled, sampled and
//! measured.

use crate::support::{jobs, pinned};
use impellerc::base::progress::Progress;
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::ir::Program;
use impellerc::nurbs::proximity::Patch;
use impellerc::verify::proof::sweep::Sweep;
use impellerc::verify::surface::{self, Limits};
use impellerc::wheel::part::chart::{self, Shape};
use impellerc::wheel::part::{
    Across, BladeId, FaceId, FaceSurface, Part, Sample, Surface, SurfaceKind, kept, sample, solid,
};
use nalgebra::{Point3, Rotation3, Vector3};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::LazyLock;

fn job() -> Options {
    Options { job: PathBuf::from("jobs/_errors/IMP0313-splitter.imp"), ..Options::default() }
}

fn front() -> (Program, Outcome) {
    let mut outcome = Outcome::default();
    let program = driver::front(&job(), &mut Stages::default(), &mut outcome).unwrap().unwrap();
    (program, outcome)
}

static SPLITTER: LazyLock<Program> = LazyLock::new(|| front().0);

/// The two faces of the splitter.
fn faces() -> [FaceId; 2] {
    BladeId::new(1).faces()
}

#[test]
fn the_program_names_blades_and_passages() {
    let text = impellerc::ir::print::program(&SPLITTER);
    for line in [
        "face half pressure = ruled root (4.1728, -12.4892, -11.4546)",
        "face half suction = lofted through 3 sections root (5.4425, -11.9243, -11.4261)",
        "passage from main suction to half pressure\n",
        "passage from half suction to main pressure of the next sector\n",
        "fillet 1.2 mm\nfillet of half 1 mm\n",
    ] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
    // The first point of the splitter's pressure root in the job is (-0.9243, -13.1354, -11.4546), 22.5 deg behind.
    let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), 22.5_f64.to_radians())
        * Point3::new(-0.9243, -13.1354, -11.4546);
    assert!((SPLITTER.part.face(faces()[0]).surface.point(0.0, 0.0) - turned).norm() < 1e-12);
}

/// The continued walls of both passages follow the faces of the splitter, and keep their share of the way before it.
#[test]
fn walls_of_splitters_are_continued() {
    let part = &SPLITTER.part;
    let whole = Patch { u: [-0.1, 1.1], v: [-0.1, 1.1] };
    for face in faces() {
        let (passage, side) = part.passage_of(face);
        let wall = part.walls(passage)[side];
        let begins = part.along_channel(face, 0.0);
        assert!((0.3..0.6).contains(&begins), "{begins}");
        for (i, j) in (1..10).flat_map(|i| (0..=10).map(move |j| (i, j))) {
            let [u, v] = [f64::from(i) / 10.0, f64::from(j) / 10.0];
            let p = part.face(face).surface.point(u, v);
            let found = wall.surface().closest(&p, whole);
            assert!(found.distance < 0.03, "{face:?} at {u}, {v}: {} off the wall", found.distance);
            // u of the channel is that of the middle of the blade.
            if j == 5 {
                assert!((found.u - part.along_channel(face, u)).abs() < 0.01, "{} {u}", found.u);
            }
        }
        let share = |u: f64| {
            let main = part.face_ahead(BladeId::MAIN);
            let ends = [main, main.other()].map(|id| part.face(id).surface.point(u, 0.5));
            let across = Across::between(ends, part.pitch());
            let p = wall.point(u, 0.5);
            // By azimuths, since radius and height change a little on the way.
            let [from, to, at] = [across.point(0.0), across.point(1.0), p].map(|p| libm::atan2(p.y, p.x));
            (at - from).rem_euclid(std::f64::consts::TAU) / (to - from).rem_euclid(std::f64::consts::TAU)
        };
        let shares: Vec<f64> = (1..6).map(|k| share(f64::from(k) * 0.06 * begins / 0.5)).collect();
        assert!(shares.iter().all(|s| (s - shares[0]).abs() < 1e-3 && (0.3..0.7).contains(s)), "{shares:?}");
    }
}

#[test]
fn its_flat_edge_is_not_finished() {
    let errors: Vec<String> = errors_with(&[]).iter().map(|e| e[..7].to_owned()).collect();
    assert_eq!(errors, ["IMP0313"]);
}

/// A lofted face goes through its middle section, and bulges over the ruled face between its ends.
#[test]
fn the_lofted_face_goes_through_its_sections() {
    let FaceSurface::Lofted(lofted) = &SPLITTER.part.face(faces()[1]).surface else { panic!("a lofted face") };
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 22.5_f64.to_radians());
    let first = turn * Point3::new(1.0023, -15.3125, -8.4603);
    assert!((lofted.derivatives(0.0, lofted.places()[1]).point - first).norm() < 1e-12);
    let (root, tip) = (lofted.derivatives(0.5, 0.0).point, lofted.derivatives(0.5, 1.0).point);
    let chord = tip - root;
    let middle = lofted.derivatives(0.5, 0.5).point - root;
    let bulge = (middle - chord * (middle.dot(&chord) / chord.norm_squared())).norm();
    assert!((0.1..0.2).contains(&bulge), "{bulge}");
}

/// A fillet has a sample within 0.71 spacings of each of its places, up to the rim that it leaves at an oblique angle. A row of
/// points that ended before the rim left up to a spacing without one.
#[test]
fn samples_reach_all_places_of_a_fillet() {
    const SPACING: f64 = 0.4;
    const PLACES: [usize; 2] = [400, 24];
    for job in ["pump", "splitter"] {
        let program = crate::support::jobs::program(job, None);
        let part = &program.part;
        for chart in chart::charts(part).into_iter().filter(|c| matches!(c.kind, SurfaceKind::Fillet(_))) {
            let samples = sample::sample(part, SPACING);
            let own: Vec<Point3<f64>> = samples
                .iter()
                .filter(|s| s.surface.sector == 0 && s.surface.kind == chart.kind)
                .map(|s| s.position)
                .collect();
            let mut farthest = 0.0_f64;
            for (i, j) in (0..=PLACES[0]).flat_map(|i| (0..=PLACES[1]).map(move |j| (i, j))) {
                let xy = [i as f64 / PLACES[0] as f64, j as f64 / PLACES[1] as f64];
                let place = chart.place(xy[0], xy[1]).position;
                if chart.is_milled(xy, &place) {
                    farthest = farthest.max(own.iter().map(|s| (s - place).norm()).fold(f64::INFINITY, f64::min));
                }
            }
            println!("{job} {:?}: {farthest:.4} mm", chart.kind);
            assert!(farthest < 0.71 * SPACING, "{job} {:?}: {farthest} mm", chart.kind);
        }
    }
}

/// Edges and tips as the lathe makes them have samples near each of their places too: a lofted face ends beyond hub and shroud or before
/// them, so that its own border is not theirs.
#[test]
fn samples_reach_all_places_of_turned_edges_and_tips() {
    const SPACING: f64 = 0.4;
    const PLACES: [usize; 2] = [100, 20];
    for job in ["sections", "splitter", "curved", "small"] {
        let program = crate::support::jobs::program(job, None);
        let part = &program.part;
        let samples = sample::sample(part, SPACING);
        let own: Vec<Point3<f64>> = samples.iter().filter(|s| s.surface.sector == 0).map(|s| s.position).collect();
        for chart in chart::edges(part).chain(chart::tips(part)) {
            let mut farthest = [0.0_f64; 2];
            for (i, j) in (0..=PLACES[0]).flat_map(|i| (0..=PLACES[1]).map(move |j| (i, j))) {
                let place = chart.place(i as f64 / PLACES[0] as f64, j as f64 / PLACES[1] as f64).position;
                let on_border = i == PLACES[0] || j == 0 || j == PLACES[1];
                let found = own.iter().map(|s| (s - place).norm()).fold(f64::INFINITY, f64::min);
                farthest[usize::from(on_border)] = farthest[usize::from(on_border)].max(found);
            }
            println!("{job} {:?}: {farthest:.4?} mm", chart.kind);
            // A border that the samples only come near to would be wrong to the first order: it has rows of its own.
            assert!(
                farthest[0] < 0.71 * SPACING && farthest[1] < 0.55 * SPACING,
                "{job} {:?}: {farthest:?} mm",
                chart.kind
            );
        }
    }
}

/// Every sample lies on its surface and outside of all blades, by distances to the surfaces themselves.
#[test]
fn samples_lie_on_the_part() {
    let part = &SPLITTER.part;
    let mut count: BTreeMap<SurfaceKind, usize> = BTreeMap::new();
    for s in sample::sample(part, 0.5).iter().filter(|s| s.surface.sector == 2) {
        *count.entry(s.surface.kind).or_default() += 1;
        let own = part.sector_rotation(2).inverse() * s.position;
        match s.surface.kind {
            SurfaceKind::Face(face) => {
                let foot = part.face(face).surface.closest(&own, Patch { u: [0.0, 1.0], v: [-0.2, 1.2] });
                assert!(foot.distance < 1e-9, "{face:?} {}", foot.distance);
            }
            SurfaceKind::Fillet(face) => {
                let centre =
                    own + (part.sector_rotation(2).inverse() * s.normal) * part.fillet(face).unwrap().least().get();
                let foot = part.face(face).surface.closest(&centre, Patch { u: [-0.3, 1.3], v: [-0.3, 1.3] });
                let radius = part.fillet(face).unwrap().least().get();
                assert!((foot.distance - radius).abs() < 1e-6 && (part.hub.distance(&centre) - radius).abs() < 1e-6);
            }
            SurfaceKind::Hub(_) => {
                assert!(part.hub.distance(&own).abs() < 1e-9);
                for face in part.faces() {
                    for turn in [-part.pitch(), 0.0, part.pitch()] {
                        let near = Rotation3::from_axis_angle(&Vector3::z_axis(), -turn) * own;
                        let foot = part.face(face).surface.closest(&near, Patch { u: [0.0, 1.0], v: [-0.2, 1.0] });
                        let inside = (near - foot.point).dot(&part.face(face).normal(foot.u, foot.v)) < -1e-6;
                        let other =
                            part.face(face.other()).surface.closest(&near, Patch { u: [0.0, 1.0], v: [-0.2, 1.0] });
                        let behind =
                            (near - other.point).dot(&part.face(face.other()).normal(other.u, other.v)) < -1e-6;
                        // Before and behind a blade its faces go on as planes.
                        let within = [foot.u, other.u].iter().all(|u| *u > 0.0 && *u < 1.0);
                        assert!(!(inside && behind && within), "{:?} lies in a blade", s.position);
                    }
                }
            }
            _ => {}
        }
    }
    let kinds: Vec<String> = count.keys().map(|k| k.in_sectors(&[2])).collect();
    assert_eq!(
        kinds,
        [
            "vane 3 pressure face",
            "vane 3 suction face",
            "splitter 3.1 pressure face",
            "splitter 3.1 suction face",
            "vane 3 pressure fillet",
            "vane 3 suction fillet",
            "splitter 3.1 pressure fillet",
            "splitter 3.1 suction fillet",
            "hub of channel 3",
            "hub of channel 3.1",
            "vane 3 tip",
            "splitter 3.1 tip",
            "vane 3 inlet edge",
            "splitter 3.1 inlet edge",
            "vane 3 outlet edge",
            "splitter 3.1 outlet edge",
        ]
    );
}

/// Area vectors of a shape over the whole part, and its share of the volume, by differences of its places.
fn flux(shape: &dyn Shape, times: f64) -> [f64; 2] {
    const N: usize = 160;
    let at = |k: usize| k as f64 / N as f64;
    let mut sum = [0.0; 2];
    for i in 0..N {
        for j in 0..N {
            let corner = |a: usize, b: usize| shape.place(at(a), at(b)).position;
            let (p, q) = (corner(i + 1, j + 1) - corner(i, j), corner(i, j + 1) - corner(i + 1, j));
            let xy = [(i as f64 + 0.5) / N as f64, (j as f64 + 0.5) / N as f64];
            let middle = shape.place(xy[0], xy[1]);
            if !shape.is_milled(xy, &middle.position) {
                continue;
            }
            let area = 0.5 * p.cross(&q);
            let area = if area.dot(&middle.normal) < 0.0 { -area } else { area };
            sum[0] += area.z * times;
            sum[1] += area.dot(&middle.position.coords) / 3.0 * times;
        }
    }
    sum
}

/// What all surfaces of a part enclose, and what they lack to be closed, seen along Z, mm2.
pub fn enclosed(program: &Program) -> [f64; 2] {
    let (part, sectors) = (&program.part, f64::from(program.part.vane_count));
    let milled = chart::charts(part);
    let kept = kept::kept(part, &program.stock, kept::MilledTurned::default());
    let milled = milled.iter().map(|shape| flux(shape, sectors));
    let kept = kept.iter().map(|shape| flux(shape, if shape.is_ring() { 1.0 } else { sectors }));
    milled.chain(kept).fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
}

/// Volume of a blade between its faces, hub and shroud, without fillets.
fn blade_volume(part: &Part, blade: BladeId) -> f64 {
    const N: usize = 100;
    let [p, s] = blade.faces();
    let wall = |face: FaceId, u: f64, w: f64| {
        let (low, high) = (part.ruling_meets(face, u, &part.hub, 0.0), part.ruling_meets(face, u, &part.shroud, 1.0));
        part.face(face).surface.point(u, low + (high - low) * w)
    };
    let at = |k: usize| k as f64 / N as f64;
    let mut volume = 0.0;
    for i in 0..N {
        for j in 0..N {
            let [a, b] = [p, s].map(|f| {
                let [x, y, z, w] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| wall(f, at(i), at(j)));
                (0.5 * (z - x).cross(&(w - y)), Point3::from((x.coords + y.coords + z.coords + w.coords) / 4.0))
            });
            volume += (0.5 * (a.0 + b.0)).dot(&(b.1 - a.1)).abs();
        }
    }
    volume
}

/// The surfaces of the vane wheel close: they enclose the volume of its mesh, of which they share no grid. Those of the
/// wheel with the splitter enclose the splitter more, with its fillets.
#[test]
fn surfaces_of_the_wheel_close() {
    let small = jobs::program("small", None);
    let [open, volume] = enclosed(&small);
    let mesh = solid::volume(&small.part, &small.stock, 1e-6).unwrap().value;
    println!("small: open {open:.3} mm2, volume {volume:.2}, by the mesh {mesh:.2} mm3");
    assert!((volume / mesh - 1.0).abs() < 2e-3 && open.abs() < 5.0, "{open} {volume} {mesh}");
    let [open, with] = enclosed(&SPLITTER);
    let least = f64::from(small.part.vane_count) * blade_volume(&SPLITTER.part, BladeId::new(1));
    println!(
        "splitter: open {open:.3} mm2, volume {with:.2}, {:.2} more; the splitters hold {least:.2}",
        with - volume
    );
    assert!(open.abs() < 9.0, "{open}");
    assert!(with - volume > least && with - volume < 1.1 * least, "{} {least}", with - volume);
    assert!(solid::volume(&SPLITTER.part, &SPLITTER.stock, 1e-6).is_none());
}

/// The verifier divides, samples and bounds the surfaces of the splitter as any others: paths of the wheel without it cut
/// through it as deep as the brute force of all samples says.
#[test]
fn the_verifier_measures_the_splitter() {
    let (program, motion) = pinned::small("siemens-840d").planned();
    let sweeps: Vec<Sweep<'_>> = (0..motion.operations.len()).filter_map(|o| Sweep::new(program, motion, o)).collect();
    let part = &SPLITTER.part;
    let reports = surface::certify(
        part,
        kept::MilledTurned { edges: [true; 2], tips: false },
        &sweeps,
        0.5,
        &Limits::default(),
        &Progress::default(),
    );
    assert_eq!(reports.len(), 8 * (4 + 4 + 2 + 4));
    let samples = sample::sample(part, 0.25);
    for report in reports.iter().filter(|r| r.id.sector == 0) {
        let own: Vec<&Sample> = samples.iter().filter(|s| s.surface == report.id).collect();
        let area: f64 = own.iter().map(|s| s.area).sum();
        println!(
            "{}: area {:.2} and {area:.2} mm2, gouge {:.3}",
            report.surface,
            report.area.get(),
            report.gouge.value.get()
        );
        if report.id.milled() {
            assert!((area / report.area.get() - 1.0).abs() < 0.08, "{}: {area} {}", report.surface, report.area);
        }
        let SurfaceKind::Face(face) = report.id.kind else { continue };
        let distance =
            |s: &&Sample| sweeps.iter().fold(5.0, |d, w| w.nearest(&s.position, d).map_or(d, |n| n.distance));
        let least = own.iter().map(distance).fold(f64::INFINITY, f64::min);
        assert!(report.gouge_bound.get() >= -least - 1e-3, "{}: {} {least}", report.surface, report.gouge_bound.get());
        if face.blade != BladeId::MAIN {
            assert!(least < -0.5, "the paths go through the splitter: {least}");
            // A cut that is broken is not followed to its deepest place.
            assert!(report.gouge.value.get() < -surface::UNPROVED_GOUGE, "{} {least}", report.gouge.value.get());
        }
    }
}

/// The job with texts replaced, and the errors that the compiler finds in it.
fn errors_with(changes: &[(&str, &str)]) -> Vec<String> {
    let mut text = include_str!("../../jobs/_errors/IMP0313-splitter.imp").to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("job.imp"), text).unwrap();
    let mut options = Options { job: folder.path().join("job.imp"), ..Options::default() };
    options.run.library = Some(PathBuf::from("jobs/_lib"));
    let outcome = driver::compile(&options, &mut Stages::default());
    let errors = outcome.sink.diags().iter().filter(|d| d.severity == impellerc::diagnostics::Severity::Error);
    errors.map(|d| format!("{}: {}", d.code.id(), d.message)).collect()
}

#[test]
fn faults_of_splitters_and_sections_are_named() {
    let second = "  extend 1 mm\n  splitter third {\n    angle 10 deg\n    pressure ruled { tip spline [(0, -17.583, -5.4944) (-2.9424, -23.4536, -9.8)] mm  root spline [(-0.9243, -13.1354, -11.4546) (-3.2121, -23.4182, -13)] mm }\n    suction ruled { tip spline [(1.2401, -17.5422, -5.4944) (-1.711, -23.5755, -9.8)] mm  root spline [(0.465, -13.0994, -11.4261) (-1.5707, -23.5852, -13)] mm }\n  }\n  hub ";
    let many = "  splitter a { }\n".repeat(9) + "  hub ";
    for (changes, found) in [
        (vec![], "IMP0313: the inlet edge of `half` is flat and lies inside of the part"),
        // Another splitter beside it, without a fillet, and one inside of it.
        (vec![("  hub ", second)], "IMP0313: the inlet edge of `half` is flat and lies inside of the part"),
        (
            vec![("angle 22.5 deg", "angle 4 deg")],
            "IMP0302: the half pressure face reaches into the suction face beside it",
        ),
        (
            vec![("angle 22.5 deg", "angle 41 deg")],
            "IMP0302: the half suction face reaches into the pressure face beside it",
        ),
        (
            vec![("  hub ", second), ("angle 10 deg", "angle 20 deg")],
            "IMP0302: the third suction face reaches into the half pressure face beside it",
        ),
        (vec![("splitter half", "splitter main")], "IMP0202: two blades are called `main`"),
        (
            vec![("sections spline", "sections 3 mm, spline")],
            "IMP0210: `sections` of the suction face needs a list of splines",
        ),
        (vec![("suction lofted", "suction loft")], "IMP0211: faces of the kind `loft` are not in the language"),
        (vec![("  hub ", many.as_str())], "IMP0209: `splitter` of part splitter must be given at most 8 times"),
    ] {
        assert_eq!(errors_with(&changes).first().map(String::as_str), Some(found), "{changes:?}");
    }
}
