//! Engines of tool orientation against closed forms and brute force.

use crate::support;
use impellerc::axes::orient::inscribe::{Proof, covered, inscribe};
use impellerc::axes::orient::{AxisCandidate, Corridor, Costs, Energy, Weights, greedy};
use impellerc::five_axis::Chain;
use impellerc::nurbs::elliptic_cone::{EllipticCone, frame_about};
use impellerc::nurbs::moving_least_squares::{Patch, curvatures};
use impellerc::nurbs::{SurfaceCurvature, Triangulation};
use impellerc::tool_stock::collide::{Cloud, CloudPoint, Cutter};
use impellerc::wheel::part::{BladeId, Surface};
use nalgebra::{Point3, Vector2, Vector3};
use std::f64::consts::{PI, TAU};

/// Places of a grid with every second row shifted, mm.
fn places(width: f64, height: f64, spacing: f64) -> Vec<[f64; 2]> {
    let (columns, rows) = ((width / spacing).round() as usize, (height / spacing).round() as usize);
    (0..=rows).flat_map(|j| (0..=columns).map(move |i| [i as f64 * spacing, j as f64 * spacing])).collect()
}

#[test]
fn no_circle_about_a_triangle_holds_a_point() {
    // A spiral of points, which is in no way a grid.
    let chart: Vec<[f64; 2]> = (0..120)
        .map(|k| {
            let (r, angle) = (f64::from(k).sqrt(), f64::from(k) * 2.4);
            [r * angle.cos(), r * angle.sin()]
        })
        .collect();
    let points: Vec<Point3<f64>> = chart.iter().map(|c| Point3::new(c[0], c[1], 0.0)).collect();
    let mesh = Triangulation::delaunay(points.clone(), &chart, f64::INFINITY).unwrap();
    let mut area = 0.0;
    for face in 0..mesh.faces().len() {
        let [a, b, c] = mesh.corners(face);
        let (p, q) = (b - a, c - a);
        let twice = p.x * q.y - p.y * q.x;
        assert!(twice > 0.0);
        area += 0.5 * twice;
        let centre = a + Vector3::new(
            q.y * p.norm_squared() - p.y * q.norm_squared(),
            p.x * q.norm_squared() - q.x * p.norm_squared(),
            0.0,
        ) / (2.0 * twice);
        let radius = (centre - a).norm();
        assert!(points.iter().all(|x| (x - centre).norm() > radius - 1e-9));
    }
    // Euler: 2 n - 2 - k triangles with k points on the hull (Xu 11); each inner edge has two triangles.
    let edges: usize = (0..points.len()).map(|i| mesh.neighbours(i).len()).sum::<usize>() / 2;
    let hull = 2 * edges - 3 * mesh.faces().len();
    assert_eq!(mesh.faces().len(), 2 * points.len() - 2 - hull);
    assert!(area > 0.9 * PI * 119.0 && area < PI * 119.0, "{area}");
    let twice = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 0.0]];
    assert!(Triangulation::delaunay(points[..4].to_vec(), &twice, f64::INFINITY).is_err());
    let line = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]];
    assert!(Triangulation::delaunay(points[..3].to_vec(), &line, f64::INFINITY).is_err());
}

#[test]
fn over_and_under_a_mesh_are_told_apart() {
    let chart = places(10.0, 10.0, 0.5);
    let height = |x: f64, y: f64| 0.05 * (x - 5.0) * (y - 5.0);
    let points = chart.iter().map(|c| Point3::new(c[0], c[1], height(c[0], c[1]))).collect();
    let mesh = Triangulation::delaunay(points, &chart, 1.25).unwrap();
    for k in 0..100 {
        let (x, y) = (1.0 + 8.0 * f64::from(k % 10) / 9.0, 1.0 + 8.0 * f64::from(k / 10) / 9.0);
        assert!(mesh.lies_under(&Point3::new(x, y, height(x, y) + 0.3)));
        assert!(!mesh.lies_under(&Point3::new(x, y, height(x, y) - 0.3)));
        let foot = mesh.nearest(&Point3::new(x, y, height(x, y))).unwrap();
        assert!((foot.point - Point3::new(x, y, height(x, y))).norm() < 0.05 * 0.25 * 0.25 + 1e-9);
    }
}

/// Largest error of principal curvatures, as a share of the larger one in size, sorted; where the surface is nearly
/// flat, as a share of a tenth of its strongest curvature.
fn errors(mesh: &Triangulation, patch: Patch, truth: &[[f64; 2]]) -> Vec<f64> {
    let strongest = truth.iter().flatten().fold(0.0_f64, |m, k| m.max(k.abs()));
    let mut errors: Vec<f64> = curvatures(mesh, patch)
        .into_iter()
        .zip(truth)
        .map(|(found, true_)| {
            let found: SurfaceCurvature = found.expect("a patch");
            let scale = true_[0].abs().max(true_[1].abs()).max(0.1 * strongest);
            (found.principal[0] - true_[0]).abs().max((found.principal[1] - true_[1]).abs()) / scale
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    errors
}

#[test]
fn curvatures_of_closed_forms_are_found() {
    let spacing = 0.5;
    let (r, tube) = (20.0, 6.0);
    // Name, point over a place of 12 mm x 12 mm that keeps lengths as well as it can, principal curvatures with the
    // normal on the side of d/dx x d/dy.
    type Shape<'a> = (&'a str, Box<dyn Fn(f64, f64) -> (Point3<f64>, [f64; 2])>);
    let shapes: [Shape<'_>; 4] = [
        (
            "sphere",
            Box::new(move |x, y| {
                let (u, v) = ((x - 6.0) / r, (y - 6.0) / r);
                (Point3::new(r * v.cos() * u.cos(), r * v.cos() * u.sin(), r * v.sin()), [-1.0 / r, -1.0 / r])
            }),
        ),
        ("cylinder", Box::new(move |x, y| (Point3::new(r * (x / r).cos(), r * (x / r).sin(), y), [0.0, -1.0 / r]))),
        (
            "torus",
            Box::new(move |x, y| {
                // Both sides of the tube: x around, y about the tube over the top.
                let (u, v) = (x / r, (y - 6.0) / tube + 0.5 * PI);
                let out = r + tube * v.cos();
                let point = Point3::new(out * u.cos(), out * u.sin(), tube * v.sin());
                let (around, about) = (-v.cos() / out, -1.0 / tube);
                (point, [around.max(about), around.min(about)])
            }),
        ),
        (
            "saddle",
            Box::new(move |x, y| {
                let (x, y) = (x - 6.0, y - 6.0);
                let k = 0.04;
                let w = 1.0 + k * k * (x * x + y * y);
                // z = k x y: H = -k^3 x y / w^1.5, K = -k^2 / w^2.
                let (mean, gauss) = (-k * k * k * x * y / w.powf(1.5), -k * k / (w * w));
                let root = (mean * mean - gauss).sqrt();
                (Point3::new(x, y, k * x * y), [mean + root, mean - root])
            }),
        ),
    ];
    for (name, shape) in shapes {
        let chart = places(12.0, 12.0, spacing);
        let (points, truth): (Vec<_>, Vec<_>) = chart.iter().map(|c| shape(c[0], c[1])).unzip();
        let mesh = Triangulation::delaunay(points, &chart, 1.25).unwrap();
        for patch in [Patch::Quadratic, Patch::Cubic] {
            let found = errors(&mesh, patch, &truth);
            let (median, most) = (found[found.len() / 2], found[found.len() - 1]);
            println!("{name} {patch:?}: median {median:.5}, most {most:.5}");
            if patch == Patch::Cubic {
                assert!(median < 0.01 && most < 0.03, "{name} {median} {most}");
            }
        }
    }
}

#[test]
fn curvatures_of_the_paper_vanes_are_found() {
    let part = support::wei_part(None);
    for side in BladeId::MAIN.faces() {
        let surface = &part.face(side).surface;
        // Rows 0.5 mm apart along the rulings, points 0.5 mm apart along the middle of a row.
        let length = surface.root().length(0.0, 1.0).max(surface.tip().length(0.0, 1.0));
        let columns = (length / 0.5).ceil() as usize;
        let (mut points, mut chart, mut truth) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..=columns {
            let u = i as f64 / columns as f64;
            let height = (surface.point(u, 1.0) - surface.point(u, 0.0)).norm();
            let rows = (height / 0.5).ceil() as usize;
            for j in 0..=rows {
                let v = j as f64 / rows as f64;
                points.push(surface.point(u, v));
                // Along the chart lengths of the middle.
                let at = surface.root().length(0.0, u) * (1.0 - v) + surface.tip().length(0.0, u) * v;
                chart.push([at, height * v]);
                truth.push(surface.derivatives(u, v).curvature().unwrap().principal);
            }
        }
        let mesh = Triangulation::delaunay(points, &chart, 1.25).unwrap();
        for patch in [Patch::Quadratic, Patch::Cubic] {
            let found = errors(&mesh, patch, &truth);
            let (median, most) = (found[found.len() / 2], found[found.len() - 1]);
            let beyond = found.iter().filter(|e| **e > 0.05).count();
            println!(
                "{} {patch:?}: {} points, median {:.3} %, most {:.3} %, {beyond} beyond 5 %",
                side.name(),
                found.len(),
                median * 100.0,
                most * 100.0
            );
            if patch == Patch::Cubic {
                assert!(median < 0.01 && most < 0.05, "{median} {most}");
            }
        }
    }
}

fn cone() -> EllipticCone {
    let w = Vector3::new(0.3, -0.5, 0.8).normalize();
    EllipticCone {
        frame: frame_about(&w, &Vector3::x()),
        centre: Vector2::new(0.25, -0.4),
        half_axes: [0.5, 0.2],
        roll: 0.7,
    }
}

#[test]
fn the_rational_cone_is_exact() {
    let cone = cone();
    let vertex = Point3::new(10.0, -20.0, 5.0);
    let surface = cone.to_surface(&vertex, 30.0);
    assert_eq!(surface.degree(), [2, 2]);
    let quadric = cone.quadric();
    for i in 1..=20 {
        for j in 0..=80 {
            let p = surface.point(f64::from(i) / 20.0, f64::from(j) / 80.0);
            let d = p - vertex;
            // On the cone by its quadric, by its ellipse, and at its share of the height.
            assert!(d.dot(&(quadric * d)).abs() < 1e-11 * d.norm_squared() * quadric.norm());
            assert!((cone.level(&d) - 1.0).abs() < 1e-13);
            assert!((d.dot(&cone.frame[2]) - 30.0 * f64::from(i) / 20.0).abs() < 1e-12);
        }
    }
    assert!((surface.point(0.0, 0.3) - vertex).norm() < 1e-14);
    // Inside and outside agree between ellipse and quadric.
    for k in 0..2000 {
        let (z, angle) = (1.0 - 2.0 * (f64::from(k) + 0.5) / 2000.0, f64::from(k) * 2.399_963);
        let d = Vector3::new((1.0 - z * z).sqrt() * angle.cos(), (1.0 - z * z).sqrt() * angle.sin(), z);
        if d.dot(&cone.frame[2]) > 1e-3 {
            assert_eq!(cone.holds(&d), d.dot(&(quadric * d)) <= 0.0);
        }
    }
    // The ellipse has its half axes where they are said to be.
    let end = cone.from_disc(&Vector2::new(1.0, 0.0)) - cone.centre;
    assert!((end.norm() - 0.5).abs() < 1e-14 && (end.y.atan2(end.x) - 0.7).abs() < 1e-14);
}

/// Directions all over the sphere, nearly even.
fn sphere(count: u32) -> impl Iterator<Item = Vector3<f64>> {
    (0..count).map(move |k| {
        let z = 1.0 - 2.0 * (f64::from(k) + 0.5) / f64::from(count);
        let angle = f64::from(k) * PI * (3.0 - 5.0_f64.sqrt());
        Vector3::new((1.0 - z * z).sqrt() * angle.cos(), (1.0 - z * z).sqrt() * angle.sin(), z)
    })
}

#[test]
fn the_largest_ellipse_in_a_known_set_is_found() {
    // Clear is an elliptic cone itself: the inscribed one has nearly its size.
    let truth = cone();
    let margin = |d: &Vector3<f64>, cap: f64| {
        // Brute force over the cap's rim, which suffices for a convex set.
        let side = frame_about(d, &Vector3::y());
        (0..24).all(|k| {
            let (sin, cos) = (TAU * f64::from(k) / 24.0).sin_cos();
            truth.holds(&(d + (side[0] * cos + side[1] * sin) * (cap.tan() * 1.01)))
        })
    };
    let seed = truth.centre + Vector2::new(0.1, 0.05);
    let found = inscribe(&truth.frame, seed, 2.0, Proof::Covered, &margin).unwrap();
    let rays = inscribe(&truth.frame, seed, 2.0, Proof::Rays, &margin).unwrap();
    println!("areas: {:.4} true, {:.4} by rays, {:.4} covered", truth.area(), rays.area(), found.area());
    assert!(rays.area() > 0.9 * truth.area());
    assert!(found.area() > 0.6 * truth.area());
    for d in sphere(200_000) {
        assert!(!found.holds(&d) || truth.holds(&d));
    }
    assert!(inscribe(&truth.frame, Vector2::new(3.0, 3.0), 2.0, Proof::Covered, &margin).is_none());
}

#[test]
fn a_cone_is_inscribed_between_two_walls() {
    // A ball-ended tool with shank and holder in a slot between two walls that lean towards each other by 6 deg, on a
    // floor: 14 mm wide at the bottom, 25 mm deep.
    let tool = support::tool("t", 1, Cutter::ball(3.0), 20.0, 40.0);
    let solid = &tool.solid;
    let mut points = Vec::new();
    for i in 0..=120 {
        for j in 0..=100 {
            let (y, z) = (-15.0 + f64::from(i) * 0.25, f64::from(j) * 0.25);
            for side in [-1.0, 1.0] {
                let position = Point3::new(side * (7.0 - z * 6.0_f64.to_radians().tan()), y, z);
                points.push(CloudPoint { position, normal: Vector3::x(), tag: 0 });
            }
        }
    }
    let brute = points.clone();
    let cloud = Cloud::new(points);
    let centre = Point3::new(-1.5, 0.0, 3.0);
    let asked = 0.5;
    let distance = |d: &Vector3<f64>, p: &Point3<f64>| {
        let tip = centre - d * 3.0;
        let (rho, s) = impellerc::tool_stock::collide::tool::tool_coordinates(p, &tip, d);
        solid.distance(rho, s)
    };
    // Turned by less than cap, a point at r from the centre of the ball moves by at most cap r.
    let clear = |d: &Vector3<f64>, cap: f64| {
        let value = |p: &Point3<f64>| (distance(d, p) - asked - cap * (p - centre).norm()) / (1.0 + cap);
        cloud.least(value, 0.0).is_none()
    };
    let frame = frame_about(&Vector3::z(), &Vector3::x());
    // Upright the cutter would come too near to the wall at its left, high up: the seed leans away from it.
    let found = inscribe(&frame, Vector2::new(0.0, 0.07), 1.0, Proof::Covered, &clear).expect("a cone");
    assert!(covered(&found, &clear));
    println!(
        "half axes {:.2} and {:.2} deg",
        found.half_axes[0].atan().to_degrees(),
        found.half_axes[1].atan().to_degrees()
    );
    // Wide along the slot, narrow across, leaning away from the nearer wall.
    assert!(found.half_axes[0] > 2.0 * found.half_axes[1] && found.axis().x > 0.0);
    let mut inside = 0;
    for d in sphere(40_000).filter(|d| found.holds(d)) {
        inside += 1;
        let least = brute.iter().map(|p| distance(&d, &p.position)).fold(f64::INFINITY, f64::min);
        assert!(least >= asked, "{least} at {d:?}");
    }
    assert!(inside > 100, "{inside}");
    // And it is not small: a direction a degree beyond each end of the short axis is not clear.
    for end in [-1.0, 1.0] {
        let rim = found.from_disc(&Vector2::new(0.0, end));
        let beyond = rim + (rim - found.centre).normalize() * 0.05;
        assert!(!clear(&found.direction(&beyond), 0.0));
    }
}

#[test]
fn the_way_of_least_cost_is_that_of_brute_force() {
    let costs = Costs {
        speed: [500.0, 500.0, 500.0, 1.6, 3.1],
        acceleration: [5000.0, 5000.0, 5000.0, 20.0, 20.0],
        smoothness: 3.0,
        most_turn: 2.0,
    };
    // Four candidates at six stations by a recurrence without pattern.
    let mut state = 12345_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1_u64 << 31) as f64
    };
    for _ in 0..20 {
        let stations: Vec<Vec<AxisCandidate>> = (0..6)
            .map(|_| {
                (0..4)
                    .map(|_| AxisCandidate {
                        joints: [next() * 50.0, next() * 50.0, next() * 20.0, next(), next() * 7.0 - 3.5],
                        penalty: next() * 0.1,
                    })
                    .collect()
            })
            .collect();
        let reachable = |choice: &[usize]| {
            (1..6).all(|i| {
                let (p, q) = (stations[i - 1][choice[i - 1]].joints, stations[i][choice[i]].joints);
                let turn = (q[4] - p[4] + PI).rem_euclid(TAU) - PI;
                turn.abs() <= 2.0 && (q[3] - p[3]).abs() <= 2.0
            })
        };
        let best = (0..4_usize.pow(6))
            .map(|k| (0..6).map(|i| k / 4_usize.pow(i) % 4).collect::<Vec<usize>>())
            .filter(|choice| reachable(choice))
            .map(|choice| costs.of(&stations, &choice))
            .fold(f64::INFINITY, f64::min);
        match costs.shortest(&stations) {
            Ok(choice) => {
                assert!(reachable(&choice));
                let cost = costs.of(&stations, &choice);
                assert!((cost - best).abs() < 1e-12, "{cost} {best}");
            }
            Err(_) => assert!(best.is_infinite()),
        }
    }
    assert_eq!(costs.shortest(&[vec![], vec![]]), Err(0));
}

/// Round cones of a half angle about given directions.
fn tube(directions: &[Vector3<f64>], half: f64) -> Corridor {
    let cones = directions.iter().map(|d| EllipticCone {
        frame: frame_about(d, &Vector3::z()),
        centre: Vector2::zeros(),
        half_axes: [half.tan(); 2],
        roll: 0.0,
    });
    Corridor { cones: cones.collect(), spacing: 1.0, length: 6.0 }
}

const WEIGHTS: Weights = Weights { first: 0.05, second: 1.0, third: 1.0, peak: 1.0, middle: 0.003, least_tilt: 0.05 };

#[test]
fn a_smooth_run_stays_in_its_corridor() {
    // A slow sweep with a wobble of 3 deg on it; the corridor is 4 deg wide to all sides.
    let chain = Chain::tilting_table();
    let axis_at = |angles: [f64; 2]| chain.tool_axis(angles);
    let rough: Vec<[f64; 2]> = (0..60)
        .map(|k| {
            let s = f64::from(k);
            let wobble = 3.0_f64.to_radians() * (s * 1.9).sin();
            [0.5 + 0.004 * s + wobble, 0.3 + 0.02 * s + wobble]
        })
        .collect();
    let directions: Vec<Vector3<f64>> = rough.iter().map(|q| axis_at(*q)).collect();
    let corridor = tube(&directions, 4.0_f64.to_radians());
    let run = corridor.smooth(&rough, &WEIGHTS, &axis_at).unwrap();
    let bend = |run: &[[f64; 2]]| run.windows(3).map(|w| (w[2][1] - 2.0 * w[1][1] + w[0][1]).abs()).fold(0.0, f64::max);
    println!("bend {:.5} before, {:.5} after", bend(&rough), bend(&run));
    assert!(bend(&run) < 0.02 * bend(&rough));
    for (d, q) in directions.iter().zip(&run) {
        assert!(d.angle(&axis_at(*q)) < 4.0_f64.to_radians());
    }
    // Axes at the far end keep their winding.
    assert!(run.windows(2).all(|w| (w[1][1] - w[0][1]).abs() < 0.1));
}

/// Both branches of a table give the same tool axes: negative angles of axis 1 keep away from the pole as positive ones do.
#[test]
fn a_smooth_run_on_the_other_branch_has_the_same_axes() {
    let chain = Chain::tilting_table();
    let axis_at = |angles: [f64; 2]| chain.tool_axis(angles);
    let rough: Vec<[f64; 2]> = (0..40).map(f64::from).map(|s| [0.3 + 0.04 * (s * 1.9).sin(), 0.02 * s]).collect();
    let other: Vec<[f64; 2]> = rough.iter().map(|q| [-q[0], q[1] + PI]).collect();
    let directions: Vec<Vector3<f64>> = rough.iter().map(|q| axis_at(*q)).collect();
    let corridor = tube(&directions, 6.0_f64.to_radians());
    let [one, two] = [&rough, &other].map(|start| corridor.smooth(start, &WEIGHTS, &axis_at).unwrap());
    for (p, q) in one.iter().zip(&two) {
        assert!((p[0] + q[0]).abs() < 1e-4 && (p[1] + PI - q[1]).abs() < 1e-4, "{p:?} {q:?}");
        assert!(axis_at(*p).angle(&axis_at(*q)) < 1e-4);
    }
}

#[test]
fn a_corridor_without_a_way_is_told() {
    // Neighbouring cones 60 deg apart in A with a tilt that may not fall below its least: the last one points down.
    let chain = Chain::tilting_table();
    let axis_at = |angles: [f64; 2]| chain.tool_axis(angles);
    let directions: Vec<Vector3<f64>> = (0..12).map(|k| axis_at([0.4, if k < 6 { 0.0 } else { 2.5 }])).collect();
    let corridor = tube(&directions, 0.02);
    let start = vec![[0.4, 0.0]; 12];
    let residual = corridor.smooth(&start, &WEIGHTS, &axis_at);
    // The start is 2.5 rad away from half of the cones: one round moves by at most 0.2 rad.
    let failed = residual.is_err();
    let reached = residual.is_ok_and(|run| corridor.worst(&run, &axis_at).1 <= 1.0);
    assert!(failed || reached);
    let nearer = Corridor { cones: corridor.cones[..3].to_vec(), spacing: 1.0, length: 6.0 };
    assert!(nearer.smooth(&start[..3], &WEIGHTS, &axis_at).is_err(), "three stations have no third difference");
}

#[test]
fn energies_are_those_of_closed_forms() {
    // r = (a u, b v, c u v): membrane 1/2 (a^2 + c^2 v^2 + b^2 + c^2 u^2), thin plate 1/2 2 c^2, over [0, 2] x [0, 1].
    let (a, b, c, h) = (0.3, -0.2, 0.5, 0.002);
    let rows: Vec<Vec<Vector3<f64>>> = (0..=500)
        .map(|i| {
            (0..=1000)
                .map(|j| {
                    let (u, v) = (f64::from(j) * h, f64::from(i) * h);
                    Vector3::new(a * u, b * v, c * u * v)
                })
                .collect()
        })
        .collect();
    let [membrane, plate] = Energy::parts(&rows, [h, h]);
    let exact = 0.5 * (2.0 * (a * a + b * b) + c * c * 2.0 / 3.0 + c * c * 8.0 / 3.0);
    assert!((membrane - exact).abs() < 0.005 * exact, "{membrane} {exact}");
    assert!((plate - 2.0 * c * c).abs() < 0.005 * plate, "{plate}");
    let energy = Energy { membrane: 0.25, thin_plate: 0.75 };
    assert!((energy.of(&rows, [h, h]) - 0.25 * membrane - 0.75 * plate).abs() < 1e-12);
}

#[test]
fn the_greedy_choice_stays_in_its_cones_and_near_its_neighbours() {
    let contacts: Vec<greedy::Contact> = (0..30)
        .map(|k| {
            let w = Chain::tilting_table().tool_axis([0.4 + 0.2 * (f64::from(k) * 1.7).sin(), 0.1 * f64::from(k)]);
            greedy::Contact {
                normal: Vector3::z(),
                cone: EllipticCone {
                    frame: frame_about(&w, &Vector3::x()),
                    centre: Vector2::new(0.05, 0.0),
                    half_axes: [0.5, 0.3],
                    roll: 0.3,
                },
                weight: greedy::weight(0.1, 0.2),
            }
        })
        .collect();
    let energy = Energy { membrane: 0.5, thin_plate: 0.5 };
    let chosen = greedy::choose(&contacts, None, &energy, 1.0);
    let turn = |axes: &[Vector3<f64>]| axes.windows(2).map(|w| w[0].angle(&w[1])).sum::<f64>();
    let middles: Vec<Vector3<f64>> = contacts.iter().map(|c| c.cone.axis()).collect();
    assert!(contacts.iter().zip(&chosen).all(|(c, d)| c.cone.holds(d)));
    println!("turn {:.3} of the middles, {:.3} chosen", turn(&middles), turn(&chosen));
    assert!(turn(&chosen) < 0.6 * turn(&middles));
    assert!((greedy::weight(0.1, 0.2) - 2.0_f64.ln()).abs() < 1e-15 && greedy::weight(0.0, 1.0) == 3.0);
}
