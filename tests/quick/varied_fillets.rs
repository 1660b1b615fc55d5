//! Fillets whose radius changes along the foot: on `jobs/splitter` with other fillets.

use crate::support::jobs;
use impellerc::ir::Program;
use impellerc::wheel::part::chart::{self, Chart, Shape};
use impellerc::wheel::part::{BladeId, FaceId, Part, Surface, SurfaceKind, hub_normal, sample, solid};
use std::sync::LazyLock;

/// Shares of the foot and radii of the main blade, mm.
const MAIN: [[f64; 2]; 3] = [[0.0, 1.2], [0.6, 2.0], [1.0, 1.5]];

/// Largest error of the tables of charts, mm.
const OFF: f64 = 5e-5;

static PROGRAM: LazyLock<Program> = LazyLock::new(|| {
    jobs::program_with(
        "jobs/splitter/splitter.imp",
        &[
            ("fillet 1.5 mm\n  }\n  splitter", "fillet [(0 %, 1.2 mm) (60 %, 2 mm) (100 %, 1.5 mm)]\n  }\n  splitter"),
            ("fillet 1.5 mm\n  }\n}", "fillet [(0 %, 1.1 mm) (100 %, 1.7 mm)]\n  }\n}"),
        ],
    )
});

fn part() -> &'static Part {
    &PROGRAM.part
}

fn fillets() -> Vec<(FaceId, Chart<'static>)> {
    let charts = chart::charts(part()).into_iter();
    let found: Vec<_> = charts
        .filter_map(|chart| if let SurfaceKind::Fillet(face) = chart.kind { Some((face, chart)) } else { None })
        .collect();
    // Two faces and the leading edge of both blades.
    assert_eq!(found.len(), 6);
    found
}

/// Both borders touch face and hub, and a ball of the radius stands at each place.
#[test]
fn the_ball_touches_face_and_hub() {
    for (id, chart) in fillets() {
        for i in 0..=200 {
            let x = f64::from(i) / 200.0;
            let radius = chart.fillet_radius(x).unwrap();
            let [upper, lower] = [0.0, 1.0].map(|y| chart.place(x, y));
            let centres = [0.0, 0.3, 0.8, 1.0].map(|y| {
                let place = chart.place(x, y);
                place.position + place.normal * radius
            });
            for centre in &centres {
                assert!((centre - centres[0]).norm() < 1e-9, "{id:?} {x}");
            }
            assert!((part().hub.distance(&centres[0]) - radius).abs() < OFF, "{id:?} {x}");
            assert!(part().hub.distance(&lower.position).abs() < OFF, "{id:?} {x}");
            assert!(lower.normal.angle(&hub_normal(part(), &lower.position)) < 1e-5, "{id:?} {x}");
            let u = upper.parameters[0];
            let v = part().fillet_top(id, u).unwrap();
            let face = part().face(id);
            let off = (face.surface.point(u, v) - upper.position).norm();
            assert!(off < OFF, "{id:?} {x}: {off:e}");
            assert!(face.normal(u, v).angle(&upper.normal) < 1e-5, "{id:?} {x}");
        }
    }
}

/// The stated normal is that of the surface, by differences of its points: the surface is the envelope of the balls.
#[test]
fn normals_are_those_of_the_surface() {
    const STEP: f64 = 1e-5;
    let mut leaning = 0.0_f64;
    for (id, chart) in fillets() {
        for (i, j) in (1..100).flat_map(|i| (1..10).map(move |j| (i, j))) {
            let [x, y] = [f64::from(i) / 100.0, f64::from(j) / 10.0];
            let [a, b] = [x - STEP, x + STEP].map(|x| chart.place(x, y).position);
            let [c, d] = [y - STEP, y + STEP].map(|y| chart.place(x, y).position);
            let normal = (b - a).cross(&(d - c)).normalize();
            let place = chart.place(x, y);
            let sine = normal.cross(&place.normal).norm();
            assert!(sine < 1e-4, "{id:?} {x} {y}: {sine:e}");
            // A normal square to the way of the centre, as with one radius, would be off by this angle.
            let [before, after] = [x - STEP, x + STEP].map(|x| {
                let place = chart.place(x, y);
                place.position + place.normal * chart.fillet_radius(x).unwrap()
            });
            leaning = leaning.max((after - before).normalize().dot(&place.normal).abs());
        }
    }
    assert!(leaning > 0.03, "{leaning}");
}

/// No ball reaches into the fillet between its neighbours: places lie at least a radius from the centres of all balls.
#[test]
fn no_ball_cuts_into_the_fillet() {
    for (id, chart) in fillets() {
        let balls: Vec<_> = (0..=400)
            .map(|i| {
                let x = f64::from(i) / 400.0;
                let (place, radius) = (chart.place(x, 0.5), chart.fillet_radius(x).unwrap());
                (place.position + place.normal * radius, radius)
            })
            .collect();
        for (i, j) in (0..=40).flat_map(|i| (0..=8).map(move |j| (i, j))) {
            let place = chart.place(f64::from(i) / 40.0, f64::from(j) / 8.0).position;
            let deepest =
                balls.iter().map(|(centre, radius)| radius - (place - centre).norm()).fold(f64::MIN, f64::max);
            assert!(deepest < 1e-6, "{id:?}: {deepest:e}");
        }
    }
}

/// The radius has the stated values at the stated shares of the foot, by its length.
#[test]
fn values_stand_at_shares_of_the_length() {
    for id in BladeId::MAIN.faces() {
        let root = |u: f64| part().face(id).surface.point(u, 0.0);
        let length = |u: f64| -> f64 {
            (0..4000).map(|k| (root(u * f64::from(k + 1) / 4000.0) - root(u * f64::from(k) / 4000.0)).norm()).sum()
        };
        let whole = length(1.0);
        for [share, radius] in MAIN {
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if length(middle) < share * whole { low = middle } else { high = middle }
            }
            let found = part().fillet_radius(id, low).unwrap();
            assert!((found - radius).abs() < 1e-4, "{id:?}: {found} at {share}");
        }
    }
    let main = part().main().fillet.as_ref().unwrap();
    assert_eq!((main.least().get(), main.constant()), (1.2, None));
    assert!((2.0..2.05).contains(&main.most().get()));
    assert_eq!(main.to_string(), "[(0 %, 1.2 mm) (60 %, 2 mm) (100 %, 1.5 mm)]");
}

/// Samples of the fillets, which are made without charts, lie on the charts.
#[test]
fn samples_lie_on_the_charts() {
    let charts = fillets();
    let mut count = 0;
    for s in sample::sample(part(), 0.4).iter().filter(|s| s.surface.sector == 0) {
        let SurfaceKind::Fillet(id) = s.surface.kind else { continue };
        let (_, chart) = charts.iter().find(|(face, _)| *face == id).unwrap();
        let [from, to] = [0.0, 1.0].map(|x| chart.place(x, 0.0).parameters[0]);
        let [u, share] = s.parameters;
        if (from..=to).contains(&u) {
            let place = chart.place((u - from) / (to - from), share);
            assert!((place.position - s.position).norm() < OFF, "{id:?}: {:e}", (place.position - s.position).norm());
            assert!(place.normal.angle(&s.normal) < 1e-4);
            count += 1;
        }
    }
    assert!(count > 1000, "{count}");
}

/// The finished part is closed, and its volume lies between those with the least and the largest radius everywhere.
#[test]
fn the_part_is_closed() {
    let volume = |radius: &str| {
        let program =
            jobs::program_with("jobs/splitter/splitter.imp", &[("fillet 1.5 mm", &format!("fillet {radius}"))]);
        let mesh = solid::mesh(&program.part, &program.stock, [8, 8, 60, 12]).unwrap();
        assert!(mesh.is_closed());
        mesh.volume()
    };
    let [least, varied, most] = ["1.1 mm", "[(0 %, 1.1 mm) (50 %, 1.5 mm) (100 %, 1.3 mm)]", "1.5 mm"].map(volume);
    assert!(least + 1.0 < varied && varied + 1.0 < most, "{least} {varied} {most}");
}
