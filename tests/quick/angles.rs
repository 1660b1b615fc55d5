//! Blades by angles and thicknesses: the made surfaces against what the job states.

use impellerc::diag::{Severity, Sink, render};
use impellerc::geom::proximity::Patch;
use impellerc::ir::Program;
use impellerc::job::{self, InMemory};
use impellerc::lower;
use impellerc::part::{BladeId, Face, FaceId, Part, Surface};
use impellerc::source::SourceMap;
use impellerc::syntax;
use nalgebra::{Point3, Rotation3, Vector3};
use std::sync::LazyLock;

const JOB: &str = include_str!("../../jobs/splitter/splitter.imp");

/// The program of a text, or what was reported.
fn read(text: &str) -> Result<Program, String> {
    let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
    let source = sources.add("job.imp", text);
    let ast = syntax::parse(text, source, &mut sink);
    let job = job::resolve(&ast, &mut InMemory::default(), &mut sources, &mut sink);
    let program = job.and_then(|job| lower::lower(&job, &mut sink));
    let errors = sink.diags().iter().any(|d| d.severity == Severity::Error);
    program.ok().filter(|_| !errors).ok_or_else(|| render::human(&sink, &sources, false))
}

/// The job with changes, each of which must occur.
fn changed(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(JOB.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in\n{text}");
        text.replace(from, to)
    })
}

fn made(text: &str) -> Part {
    read(text).unwrap_or_else(|fault| panic!("{fault}")).part
}

static WHEEL: LazyLock<Part> = LazyLock::new(|| made(JOB));

const WHOLE: Patch = Patch { u: [0.0, 1.0], v: [0.0, 1.0] };

/// Twice the distance within which surfaces keep the stated form, mm: two surfaces of the same form differ by no more.
const FIT: f64 = 0.004;

fn off(face: &Face, p: &Point3<f64>) -> f64 {
    face.surface.closest(p, WHOLE).distance
}

fn grid() -> impl Iterator<Item = (f64, f64)> {
    (0..=10).flat_map(|i| (0..=4).map(move |j| (f64::from(i) / 10.0, f64::from(j) / 4.0)))
}

fn faces(part: &Part, blade: usize) -> [&Face; 2] {
    BladeId::new(blade).faces().map(|id| part.face(id))
}

/// A splitter with the thickness of the main blade lies on the faces of the main blade, turned by its share of the pitch; and
/// only there.
#[test]
fn a_splitter_lies_on_the_turned_main_blade() {
    let same = [
        ("[(0 %, root) (50 %, 1.3 * root) (100 %, root)]", "root"),
        ("[(0 %, tip)  (50 %, 1.2 * tip)  (100 %, tip)]", "tip"),
    ];
    let half = made(&changed(&same));
    let third = made(&changed(&[&same[..], &[("angle 46 %", "angle 24 deg")]].concat()));
    for (part, angle) in [(&half, 0.46_f64 * 72.0), (&third, 24.0)] {
        let back = Rotation3::from_axis_angle(&Vector3::z_axis(), -angle.to_radians());
        let mains = faces(part, 0);
        let mut worst = 0.0_f64;
        for (main, splitter) in mains.into_iter().zip(faces(part, 1)) {
            for (u, v) in grid() {
                worst = worst.max(off(main, &(back * splitter.surface.point(u, v))));
            }
        }
        println!("{angle} deg: {worst:.5} mm");
        assert!(worst < FIT, "{worst}");
        let elsewhere = off(mains[0], &faces(part, 1)[0].surface.point(0.5, 0.5));
        assert!(elsewhere > 3.0, "{elsewhere}");
    }
}

/// Splitters that are cut off begin where the cut of the main blade is: at shares of the lengths of hub and shroud from the leading
/// edge of the main blade on.
#[test]
fn the_splitter_begins_at_its_cut() {
    let text = changed(&[("elliptic 2", "cut-off"), ("from hub 45 %, shroud 36 %", "from hub 40 %, shroud 55 %")]);
    let part = made(&text);
    for (surface, from, share, v) in [(&part.hub, 3.0, 0.4, 0.0), (&part.shroud, 2.0, 0.55, 1.0)] {
        // Lengths along the meridian by chords.
        let at = |k: u32| surface.meridian(f64::from(k) / 20_000.0).point;
        let mut lengths = vec![0.0];
        for k in 0..20_000 {
            lengths.push(lengths[k as usize] + (at(k + 1) - at(k)).norm());
        }
        let due = from + share * (lengths[20_000] - from);
        let due = at(u32::try_from(lengths.partition_point(|l| *l < due)).unwrap());
        for face in faces(&part, 1) {
            let p = face.surface.point(0.0, v);
            let found = nalgebra::Vector2::new(libm::hypot(p.x, p.y), p.z);
            assert!((found - due).norm() < 0.005, "{found:?} {due:?}");
        }
    }
}

/// Points of the sections of a blade, given as closed loops, make the same blade.
#[test]
fn loops_of_its_points_make_the_same_blade() {
    let part = &*WHEEL;
    let mut loops = Vec::new();
    for k in 0..=8 {
        let v = f64::from(k) / 8.0;
        let [p, s] = faces(part, 0);
        let edge = part.face(part.edge(BladeId::MAIN, 0).unwrap());
        let at = |face: &Face, i: u32, n: u32| face.surface.point(f64::from(i) / f64::from(n), v);
        let mut points: Vec<Point3<f64>> = (0..120).map(|i| at(p, 120 - i, 120)).collect();
        points.extend((0..60).map(|i| at(edge, i, 60)));
        points.extend((0..=120).map(|i| at(s, i, 120)));
        let text: Vec<String> = points.iter().map(|p| format!("({:.7}, {:.7}, {:.7})", p.x, p.y, p.z)).collect();
        loops.push(format!("loop [{}] mm", text.join(" ")));
    }
    let [from, to] = ["  vane main {", "  splitter half {"].map(|word| JOB.find(word).unwrap());
    let end = to + JOB[to..].find("\n  }\n").unwrap() + 5;
    let vane = format!("  vane main {{\n    sections {}\n    fillet 1.5 mm\n  }}\n", loops.join(",\n"));
    let again = made(&format!("{}{vane}{}", &JOB[..from], &JOB[end..]));
    let mut worst = 0.0_f64;
    for (one, other) in faces(part, 0).into_iter().zip(faces(&again, 0)) {
        for (u, v) in grid() {
            worst = worst.max(off(other, &one.surface.point(u, v)));
        }
    }
    println!("{worst:.5} mm");
    // The default of `fit` for loops is 5 um.
    assert!(worst < 0.007, "{worst}");
}

/// Distances across the passages at the hub and at the shroud, along the outlet half of the main blade: the balls of the job fit.
#[test]
fn the_passages_are_wide_enough_for_the_tools() {
    let part = &*WHEEL;
    let turned = |face: FaceId, angle: f64, u: f64, v: f64| {
        Rotation3::from_axis_angle(&Vector3::z_axis(), angle) * part.face(face).surface.point(u, v)
    };
    for passage in part.passages() {
        let [first, second] = passage.walls;
        let turn = part.pitch() * f64::from(passage.sectors);
        for v in [0.05, 0.5, 0.95] {
            let width = (0..=40)
                .flat_map(|i| (0..=40).map(move |j| (f64::from(i) / 40.0, f64::from(j) / 40.0)))
                .map(|(a, b)| (turned(first, 0.0, a, v) - turned(second, turn, b, v)).norm())
                .fold(f64::INFINITY, f64::min);
            println!("{first:?} to {second:?} at {v}: {width:.3} mm");
            assert!(width > 5.0, "{width}");
        }
    }
}
