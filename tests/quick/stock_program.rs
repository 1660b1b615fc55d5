//! The stock of a planned program: compared with the surface verifier, with its own mesh, and with other numbers of
//! threads.

use crate::support::jobs::simulated;
use crate::support::pinned;
use impellerc::diagnostics::Sink;
use impellerc::ir::{Motion, Program};
use impellerc::tool_stock::stock::{END_ERROR, Field};
use impellerc::verify::proof::sweep::Sweep;
use impellerc::verify::stock::report;
use impellerc::wheel::part::{Sample, sample};
use nalgebra::{Point3, Vector3};

/// Cells of these tests, mm.
const CELL: f64 = 1.0;

/// Poses of the surface verifier and of the stock follow the same motion by curves of their own.
const POSES: f64 = 1e-3;

fn planned() -> (Program, Motion) {
    let (program, motion) = pinned::flank().planned();
    (program.clone(), motion.clone())
}

/// All ends of intervals with the centres of the cells on their rays.
fn each_ray(field: &Field, mut visit: impl FnMut(usize, [usize; 2], &dyn Fn(f64) -> Point3<f64>)) {
    for axis in 0..3 {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        for i in 0..field.cells()[u] {
            for j in 0..field.cells()[v] {
                let (a, b) = (field.centre(u, i), field.centre(v, j));
                visit(axis, [i, j], &|x| {
                    let mut p = Point3::origin();
                    (p[u], p[v], p[axis]) = (a, b, x);
                    p
                });
            }
        }
    }
}

#[test]
fn agrees_with_the_surface_verifier() {
    let (program, motion) = planned();
    let (found, field) = simulated(&program, &motion, CELL);
    let fresh = Field::turned(&program.stock.profile, CELL).unwrap();
    let sweep = Sweep::new(&program, &motion, 0).unwrap();
    let distance = |p: &Point3<f64>| sweep.nearest(p, 5.0).map_or(5.0, |n| n.distance);
    let mut ends: Vec<Point3<f64>> = Vec::new();
    let mut centres = 0;
    each_ray(&field, |axis, [i, j], point| {
        let (left, was) = (field.intervals(axis, i, j), fresh.intervals(axis, i, j));
        if left == was {
            return;
        }
        for x in left.iter().flatten().filter(|x| !was.iter().flatten().any(|w| w == *x)) {
            let p = point(*x);
            assert!(distance(&p).abs() < END_ERROR + POSES, "{p}: {}", distance(&p));
            ends.push(p);
        }
        for k in 0..field.cells()[axis] {
            let x = field.centre(axis, k);
            let inside = |list: &[[f64; 2]]| list.iter().any(|[a, b]| *a < x && x < *b);
            if inside(&was) {
                let d = distance(&point(x));
                assert!(d.abs() < END_ERROR + POSES || inside(&left) == (d > 0.0), "{}: {d}", point(x));
                centres += 1;
            }
        }
    });
    assert!(ends.len() > 1000 && centres > 1000, "{} {centres}", ends.len());
    // On the design surfaces: the stock left is where the verifier says, within the diagonal of a cell.
    let samples: Vec<Sample> = sample::sample(&program.part, 1.0)
        .into_iter()
        .filter(|s| s.surface.milled() && design_depth(&fresh, &s.position) && distance(&s.position) < 0.5)
        .collect();
    assert!(samples.len() > 300, "{}", samples.len());
    let mut seen = 0;
    for s in &samples {
        let d = distance(&s.position);
        let nearest = ends.iter().map(|e| (e - s.position).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest > d - END_ERROR - POSES, "{}: {nearest} {d}", s.position);
        seen += usize::from(nearest < d.abs() + CELL * 3.0_f64.sqrt());
    }
    // At the rims of the cut the nearest surface is that of the blank, which is no end of a cut.
    assert!(seen * 20 > samples.len() * 19, "{seen} of {}", samples.len());
    let removed = found.operations[0].removed.get();
    assert!(removed > 100.0 && found.operations[0].collisions.is_empty(), "{removed}");
}

/// True deep enough inside the blank that cells around are whole.
fn design_depth(fresh: &Field, p: &Point3<f64>) -> bool {
    (0..3).all(|axis| {
        [-2.0, 2.0].into_iter().all(|by| {
            let mut q = *p;
            q[axis] += by * CELL;
            let index = |axis: usize| ((q[axis] - fresh.centre(axis, 0)) / CELL).round().max(0.0) as usize;
            fresh.intervals(2, index(0), index(1)).iter().any(|[a, b]| *a < q.z && q.z < *b)
        })
    })
}

#[test]
fn volumes_agree_and_threads_do_not_matter() {
    let (program, motion) = planned();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| simulated(&program, &motion, CELL))
    };
    let ((one, field), (two, other)) = (run(1), run(2));
    assert!(one == two && field == other && field.fingerprint() == other.fingerprint());
    let operation = &one.operations[0];
    assert!((one.blank.get() - operation.removed.get() - operation.rest.get()).abs() < 1e-6);
    assert!(operation.air.get() > 0.0 && operation.air < operation.time);
    // Another way to the same volume: the divergence theorem over the triangles. Edges are rounded within a cell.
    let fresh = Field::turned(&program.stock.profile, CELL).unwrap();
    let by_mesh = fresh.mesh().volume() - field.mesh().volume();
    assert!(
        (by_mesh - operation.removed.get()).abs() < 0.1 * operation.removed.get(),
        "{by_mesh} {}",
        operation.removed.get()
    );
}

/// A coarser field has rays of the field, so that its mesh shows the same stock.
#[test]
fn a_coarser_field_shows_the_same_stock() {
    let (program, motion) = planned();
    let (_, field) = simulated(&program, &motion, CELL);
    assert_eq!(field.coarser(CELL).fingerprint(), field.fingerprint());
    let coarse = field.coarser(3.9 * CELL);
    assert!((coarse.cell() - 3.0 * field.cell()).abs() < 1e-12, "{}", coarse.cell());
    assert_eq!(coarse.intervals(2, 5, 4), field.intervals(2, 16, 13));
    let (own, all) = (coarse.mesh().volume(), field.mesh().volume());
    assert!((own - all).abs() < 0.02 * all, "{own} {all}");
    // As many cells as fit: one more would be larger than allowed.
    assert!(coarse.cells().iter().zip(field.cells()).all(|(c, n)| *c == n.div_ceil(3)));
}

/// A rapid straight down through the blank is found with its block, and named in a diagnostic.
#[test]
fn a_rapid_through_the_stock_is_an_error() {
    let (program, mut motion) = planned();
    let moves = &mut motion.operations[0].moves;
    let index = moves.len() / 2;
    let joints = moves[index].joints;
    let tip = program.machine.forward(&joints).tip;
    // Aside into the next channel, which nothing opens.
    let aside = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), 0.8) * tip;
    moves[index].joints = program.machine.joints(&aside, joints.rotary);
    moves[index].kind = impellerc::ir::MoveKind::Rapid;
    moves[index].feed = None;
    let (found, _) = simulated(&program, &motion, CELL);
    let deepest = found.collisions().max_by(|a, b| a.depth.get().total_cmp(&b.depth.get())).expect("a collision");
    assert_eq!((&*deepest.part, deepest.at.index as usize), ("cutter at rapid", index));
    assert!(deepest.depth.get() > 1.0 && deepest.depth.get() <= 3.0 + END_ERROR, "{deepest:?}");
    let mut sink = Sink::default();
    report(&program, &motion, &found, &mut sink);
    assert!(sink.diags().iter().any(|d| d.code.id() == "IMP0730" && d.place.as_ref().unwrap().block.is_some()));
}
