//! Stock simulation against volumes in closed form, against brute force, and against itself on other numbers of
//! threads.

use impellerc::tool_stock::collide::{Cutter, Section, ToolSolid};
use impellerc::tool_stock::stock::{END_ERROR, Field, FieldError, Outcome, SLICES, Step, StepKind, Touched, simulate};
use nalgebra::{Point3, Vector3};
use std::f64::consts::PI;

/// Cylinder about Z with its top at zero.
fn blank(radius: f64, height: f64, cell: f64) -> Field {
    Field::turned(&[[0.0, -height], [radius, -height], [radius, 0.0], [0.0, 0.0]], cell).unwrap()
}

fn bare(cutter: Cutter, flute_length: f64) -> ToolSolid {
    ToolSolid { cutter, flute_length, shank: Vec::new(), holder: Vec::new() }
}

/// A block of steps without turn, straight from a to b.
fn straight(block: u32, kind: StepKind, a: [f64; 3], b: [f64; 3], axis: Vector3<f64>) -> Vec<Step> {
    let (a, b) = (Point3::from(a), Point3::from(b));
    let count = ((b - a).norm() / 2.0).ceil().max(1.0);
    (0..count as usize)
        .map(|k| Step {
            block,
            kind,
            tips: [a + (b - a) * (k as f64 / count), a + (b - a) * ((k + 1) as f64 / count)],
            axes: [axis; 3],
        })
        .collect()
}

/// Removed volume by the rays along X, Y, Z.
fn removed(field: &mut Field, solid: &ToolSolid, steps: Vec<Step>) -> ([f64; 3], Outcome) {
    let before = field.volumes();
    let outcome = simulate(field, solid, steps);
    let after = field.volumes();
    ([0, 1, 2].map(|k| before[k] - after[k]), outcome)
}

/// Each family sums rays over the outline of the removed body as seen along them. Rays near the `outline`, mm of
/// length, miss or meet at random: the bound takes a tenth of a cell all along it, at the largest `chord` there. A flat
/// `floor`, mm2, may lie anywhere between two rows of the rays along X and Y.
fn check(found: [f64; 3], expected: f64, outline: f64, chord: f64, floor: f64, cell: f64) {
    let bound = 0.1 * cell * outline * chord + 1e-3 * outline * outline;
    for (v, flat) in found.into_iter().zip([1.0, 1.0, 0.0]) {
        let bound = bound + flat * floor * 0.5 * cell;
        assert!((v - expected).abs() < bound, "{found:?} {expected} {bound}");
    }
}

#[test]
fn volumes_of_turned_blanks() {
    for cell in [0.5, 0.2] {
        let field = blank(20.0, 10.0, cell);
        check(field.volumes(), PI * 400.0 * 10.0, 120.0, 10.0, 0.0, cell);
        // A tube with a conical outside.
        let tube = Field::turned(&[[5.0, -10.0], [20.0, -10.0], [10.0, 0.0], [5.0, 0.0]], cell).unwrap();
        let expected = PI * 10.0 / 3.0 * (400.0 + 200.0 + 100.0) - PI * 25.0 * 10.0;
        check(tube.volumes(), expected, 200.0, 10.0, 0.0, cell);
        let mesh = tube.mesh();
        assert!((mesh.volume() - expected).abs() < 0.01 * expected, "{} {expected}", mesh.volume());
    }
}

#[test]
fn bad_fields_are_refused() {
    let square = [[0.0, 0.0], [5.0, 0.0], [5.0, 5.0], [0.0, 5.0]];
    for cell in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(Field::turned(&square, cell), Err(FieldError::BadCell));
    }
    assert_eq!(Field::turned(&[], 1.0), Err(FieldError::BadProfile));
    assert_eq!(Field::turned(&[[0.0, 0.0], [f64::NAN, 1.0]], 1.0), Err(FieldError::BadProfile));
    let Err(FieldError::TooFine { least_cell, .. }) = Field::turned(&square, 1e-6) else { panic!("a field") };
    assert!(Field::turned(&square, least_cell).is_ok());
}

#[test]
fn a_plunge_of_a_ball_removes_capsule() {
    let solid = bare(Cutter::ball(3.0), 30.0);
    let expected = PI * 9.0 * 5.0 + 2.0 / 3.0 * PI * 27.0;
    for cell in [0.4, 0.1] {
        let mut field = blank(10.0, 12.0, cell);
        let steps = straight(7, StepKind::Cut, [0.01, 0.02, 4.0], [0.01, 0.02, -8.0], Vector3::z());
        let (found, outcome) = removed(&mut field, &solid, steps);
        check(found, expected, 30.0, 8.0, 0.0, cell);
        assert!(outcome.collisions.is_empty());
        assert_eq!(outcome.cuts.len(), 1);
        let cut = &outcome.cuts[0];
        assert_eq!(cut.block, 7);
        let mean = found.iter().sum::<f64>() / 3.0;
        assert!((cut.volume - mean).abs() < 1e-6 * mean, "{} {mean}", cut.volume);
        assert!(cut.height[0] >= -1e-3 && cut.height[0] < 0.1 && cut.height[1] < 8.1);
        let [left, right] = cut.sides.over(0..=SLICES - 1);
        assert!(left > -3.002 && right < 3.002 && right - left > 5.7);
    }
}

#[test]
fn a_slot_of_a_flat_end_mill() {
    let solid = bare(Cutter::flat(4.0), 20.0);
    let (length, depth) = (17.3, 5.03);
    let expected = (8.0 * length + PI * 16.0) * depth;
    for (cell, angle) in [(0.4, 0.3_f64), (0.1, 0.3), (0.2, 1.1)] {
        let mut field = blank(20.0, 12.0, cell);
        let end = |s: f64| [s * angle.cos(), s * angle.sin(), -depth];
        let steps = straight(0, StepKind::Cut, end(-0.5 * length), end(0.5 * length), Vector3::z());
        let (found, outcome) = removed(&mut field, &solid, steps);
        check(found, expected, 70.0, depth, expected / depth, cell);
        let cut = &outcome.cuts[0];
        assert!((cut.height[1] - depth).abs() < cell && cut.height[0].abs() < cell);
        let [left, right] = cut.sides.over(0..=SLICES - 1);
        assert!((right - left - 8.0).abs() < cell, "{left} {right}");
    }
}

/// A ball cutter turns about the centre of its ball, in the middle of a ball of stock. Cut at a height n over the plane
/// of turn, what it sweeps is a sector, two strips beside it, and the rest of a disc.
#[test]
fn a_cutter_that_turns_about_the_centre_of_its_ball() {
    let (radius, outer, turn) = (2.0_f64, 15.0_f64, 0.8_f64);
    let profile: Vec<[f64; 2]> = (0..=2000)
        .map(|k| PI * (f64::from(k) / 2000.0 - 0.5))
        .map(|a| [(outer * a.cos()).max(0.0), outer * a.sin()])
        .collect();
    let expected = {
        let area = |n: f64| {
            let (w, far) = ((radius * radius - n * n).sqrt(), (outer * outer - n * n).sqrt());
            let strip = 0.5 * (w * (far * far - w * w).sqrt() + far * far * (w / far).asin());
            0.5 * turn * far * far + 2.0 * strip + 0.5 * w * w * (PI - turn)
        };
        // By the angle on the ball, where the area is smooth.
        let places = 4000;
        (0..places)
            .map(|k| PI * ((f64::from(k) + 0.5) / f64::from(places) - 0.5))
            .map(|a| area(radius * a.sin()) * radius * a.cos() * PI / f64::from(places))
            .sum::<f64>()
    };
    let solid = bare(Cutter::ball(radius), 40.0);
    // Turned out of the planes of the grid.
    let first = Vector3::new(0.3, 0.2, 1.0).normalize();
    let second = first.cross(&Vector3::new(1.0, -0.4, 0.3)).normalize();
    let axis = |a: f64| first * a.cos() + second * a.sin();
    let count = 80;
    let steps: Vec<Step> = (0..count)
        .map(|k| {
            let at = |h: f64| axis(turn * (f64::from(k) + h) / f64::from(count));
            let axes = [at(0.0), at(0.5), at(1.0)];
            Step {
                block: k,
                kind: StepKind::Cut,
                tips: [Point3::from(-axes[0] * radius), Point3::from(-axes[2] * radius)],
                axes,
            }
        })
        .collect();
    for cell in [0.3, 0.1] {
        let mut field = Field::turned(&profile, cell).unwrap();
        let (found, outcome) = removed(&mut field, &solid, steps.clone());
        check(found, expected, 60.0, 8.0, 0.0, cell);
        assert!(outcome.cuts.len() as u32 == count);
        let sum: f64 = outcome.cuts.iter().map(|c| c.volume).sum();
        assert!((sum - found.iter().sum::<f64>() / 3.0).abs() < 1e-6 * sum);
    }
}

/// Every kind of cutter over a tilted bent way: each end that cutting left lies on the swept cutter, and every ray
/// point is solid exactly where no pose comes, by brute force over poses.
#[test]
fn ends_lie_on_the_swept_cutter() {
    let pose = |t: f64| {
        let tip = Point3::new(-6.0 + 12.0 * t, 2.0 * (2.0 * t).sin(), -3.0 - t);
        (tip, Vector3::new(0.3 * (3.0 * t).sin(), 0.25 * t, 1.0).normalize())
    };
    // Half a degree of turn in a step, and as much as a step may turn.
    for count in [120_u32, 32] {
        ends_lie_on(count, pose);
    }
    // Leaning against its way, and along itself while it turns: here turn and way add up.
    ends_lie_on(32, |t| {
        let a = 0.9 * t - 0.3;
        (Point3::new(-6.0 + 10.0 * t, 1.0, -3.0 - 2.0 * t * t), Vector3::new(-a.sin(), 0.1, a.cos()).normalize())
    });
}

fn ends_lie_on(count: u32, pose: impl Fn(f64) -> (Point3<f64>, Vector3<f64>)) {
    let steps: Vec<Step> = (0..count)
        .map(|k| {
            let at = |h: f64| pose((f64::from(k) + h) / f64::from(count));
            let axes = [at(0.0).1, at(0.5).1, at(1.0).1];
            Step { block: k, kind: StepKind::Cut, tips: [at(0.0).0, at(1.0).0], axes }
        })
        .collect();
    for cutter in [
        Cutter::flat(2.0),
        Cutter::ball(2.0),
        Cutter::bull(2.5, 0.7),
        Cutter::tapered_ball(1.0, 0.12),
        Cutter::barrel(3.0, 25.0, 1.0),
        Cutter::lollipop(2.0),
    ] {
        let top = cutter.neck_height(1.2).unwrap_or(14.0);
        let solid = bare(cutter, top);
        let mut field = blank(14.0, 8.0, 0.7);
        let fresh = field.clone();
        simulate(&mut field, &solid, steps.clone());
        // The same poses that the steps run through: straight tip, axis on the parabola.
        let distance = |p: &Point3<f64>| {
            let look = |s: &Step, t: f64| {
                let axis = s.axes[0] * ((1.0 - t) * (1.0 - 2.0 * t))
                    + s.axes[1] * (4.0 * t * (1.0 - t))
                    + s.axes[2] * (t * (2.0 * t - 1.0));
                let d = p - (s.tips[0] + (s.tips[1] - s.tips[0]) * t);
                let h = d.dot(&axis);
                solid.cutter_distance((d - axis * h).norm(), h)
            };
            let coarse: Vec<f64> = steps.iter().map(|s| look(s, 0.5)).collect();
            let least = coarse.iter().copied().fold(f64::INFINITY, f64::min);
            // A point of the cutter moves less than 0.3 mm in half a step of 120.
            let near = steps.iter().zip(&coarse).filter(|(_, c)| **c < least + 36.0 / f64::from(count));
            // Corners of the cutter come and go with its speed: poses lie 2 um of way apart.
            let poses = 24_000 / count;
            near.flat_map(|(s, _)| (0..=poses).map(move |k| look(s, f64::from(k) / f64::from(poses))))
                .fold(least, f64::min)
        };
        let mut ends = 0;
        for axis in 0..3 {
            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
            for i in 0..field.cells()[u] {
                for j in 0..field.cells()[v] {
                    let point = |x: f64| {
                        let mut p = Point3::origin();
                        (p[u], p[v], p[axis]) = (field.centre(u, i), field.centre(v, j), x);
                        p
                    };
                    let (left, was) = (field.intervals(axis, i, j), fresh.intervals(axis, i, j));
                    for x in left.iter().flatten().filter(|x| !was.iter().flatten().any(|w| w == *x)) {
                        let d = distance(&point(*x));
                        assert!(d.abs() < END_ERROR, "{cutter:?} {axis} {i} {j} {x}: {d}");
                        ends += 1;
                    }
                    for k in (0..field.cells()[axis]).step_by(7) {
                        let x = field.centre(axis, k);
                        let inside = |list: &[[f64; 2]]| list.iter().any(|[a, b]| *a < x && x < *b);
                        if inside(&was) {
                            let d = distance(&point(x));
                            assert!(
                                d.abs() < END_ERROR || inside(&left) == (d > 0.0),
                                "{cutter:?} {axis} {i} {j} {k}: {d}"
                            );
                        }
                    }
                }
            }
        }
        assert!(ends > 300, "{ends}");
    }
}

#[test]
fn shank_holder_and_rapids_meet_what_is_still_there() {
    let section = |from, to, radius| Section { from, to, radius_from: radius, radius_to: radius };
    let solid = ToolSolid {
        cutter: Cutter::flat(3.0),
        flute_length: 5.0,
        shank: vec![section(5.0, 20.0, 3.0)],
        holder: vec![section(20.0, 40.0, 10.0)],
    };
    let touched = |steps: Vec<Step>| {
        let mut field = blank(30.0, 12.0, 0.5);
        let outcome = simulate(&mut field, &solid, steps);
        outcome.collisions.iter().map(|c| (c.block, c.what, (c.depth * 100.0).round() / 100.0)).collect::<Vec<_>>()
    };
    let cut = |block, a: [f64; 3], b: [f64; 3]| straight(block, StepKind::Cut, a, b, Vector3::z());
    // A slot 4.9 mm deep, and a second pass 3 mm deeper in it: the shank fits.
    let slot = |block, z: f64| cut(block, [-40.0, 0.0, z], [40.0, 0.0, z]);
    assert_eq!(touched([slot(0, -4.9), slot(1, -7.9)].concat()), []);
    // At once: the shank rubs the top three millimetres, inside the width of its own slot. Seen along Z the corner of the
    // shank is in the stock all through the slot.
    let found = touched(slot(3, -7.9));
    assert_eq!(found.len(), 1);
    assert!(found[0].0 == 3 && found[0].1 == Touched::Shank && found[0].2 > 2.3 && found[0].2 <= 2.91, "{found:?}");
    // The same at rapid: cutter as well.
    let rapid = straight(4, StepKind::Rapid, [-40.0, 0.0, -4.9], [40.0, 0.0, -4.9], Vector3::z());
    let found = touched(rapid.clone());
    assert_eq!(found.len(), 1);
    assert!(found[0].0 == 4 && found[0].1 == Touched::Cutter && found[0].2 > 2.2 && found[0].2 <= 2.5, "{found:?}");
    // At rapid through the slot that was milled, and 1 mm off its middle.
    assert_eq!(touched([slot(0, -4.9), rapid].concat()), []);
    let beside = straight(4, StepKind::Rapid, [-40.0, 1.0, -4.9], [40.0, 1.0, -4.9], Vector3::z());
    let found = touched([slot(0, -4.9), beside].concat());
    assert_eq!(found.len(), 1);
    assert!((found[0].2 - 1.0).abs() < 0.5, "{found:?}");
    // The holder, when the way was milled for the shank layer by layer.
    let layers: Vec<Step> = (0..3).flat_map(|k| slot(k, -4.0 * f64::from(k + 1))).collect();
    let short =
        ToolSolid { holder: vec![section(8.0, 30.0, 10.0)], shank: vec![section(5.0, 8.0, 3.0)], ..solid.clone() };
    let mut field = blank(30.0, 12.0, 0.5);
    let outcome = simulate(&mut field, &short, layers);
    let worst = outcome.collisions.iter().max_by(|a, b| a.depth.total_cmp(&b.depth)).unwrap();
    assert_eq!((worst.block, worst.what), (2, Touched::Holder));
    assert!((worst.depth - 4.0).abs() < 1e-2, "{worst:?}");
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let solid = bare(Cutter::ball(3.0), 20.0);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut field = blank(20.0, 12.0, 0.1);
            let steps: Vec<Step> = (0..40)
                .flat_map(|k| {
                    let y = -10.0 + 0.5 * f64::from(k);
                    let axis = Vector3::new(0.02 * f64::from(k), 0.3, 1.0).normalize();
                    straight(k, StepKind::Cut, [-25.0, y, -4.0], [25.0, y + 1.0, -5.0], axis)
                })
                .collect();
            let outcome = simulate(&mut field, &solid, steps);
            (field.fingerprint(), outcome, field.mesh())
        })
    };
    let (one, two, three) = (run(1), run(2), run(3));
    assert!(one == two && one == three);
}

#[test]
fn meshes_are_closed_and_have_the_volume_of_the_stock() {
    let mut field = blank(15.0, 10.0, 0.3);
    let solid = bare(Cutter::ball(3.0), 20.0);
    let steps =
        straight(0, StepKind::Cut, [-20.0, 1.0, -4.0], [20.0, 3.0, -5.0], Vector3::new(0.2, 0.3, 1.0).normalize());
    simulate(&mut field, &solid, steps);
    let mesh = field.mesh();
    // Every directed edge has as many partners as copies.
    let mut edges = std::collections::BTreeMap::new();
    for t in &mesh.triangles {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            *edges.entry((a.min(b), a.max(b))).or_insert(0_i32) += if a < b { 1 } else { -1 };
        }
    }
    assert!(edges.values().all(|balance| *balance == 0));
    let volume = field.volume();
    // Edges are rounded within a cell: about an eighth of a cell squared along some 250 mm.
    // Half a cell of the floor of the slot, 30 mm by 6 mm, is open between the rows.
    let bound = 0.5 * 0.3 * 0.3 * 250.0 + 0.5 * 0.3 * 180.0;
    assert!((mesh.volume() - volume).abs() < bound, "{} {volume}", mesh.volume());
    let stl = mesh.stl("stock");
    assert_eq!(stl.len(), 84 + 50 * mesh.triangles.len());
    assert_eq!(u32::from_le_bytes(stl[80..84].try_into().unwrap()) as usize, mesh.triangles.len());
}
