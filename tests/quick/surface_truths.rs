//! The surface certificate against exact shapes: found values are within 0.1 um of the closed form, and proved bounds
//! hold.

use impellerc::five_axis::{AxisLine, Carries, Chain, RotaryPose};
use impellerc::nurbs::range::{CellThickness, Interval, Jet};
use impellerc::tool_stock::collide::{Cutter, Kind, Section, ToolSolid};
use impellerc::verify::proof::sweep::Sweep;
use impellerc::verify::surface::{SLACK, SurfaceReport, UNPROVED_GOUGE, certify_shape};
use impellerc::wheel::part::{
    PassageId, SurfaceId, SurfaceKind,
    chart::{Place, Shape},
};
use nalgebra::{Point3, Unit, Vector3};

/// What the certificate may be wrong by, mm.
const TENTH: f64 = 1e-4;

fn tool(cutter: Cutter, flute_length: f64) -> ToolSolid {
    let radius = cutter.radius_at(flute_length);
    let shank = Section { from: flute_length, to: flute_length + 30.0, radius_from: radius, radius_to: radius };
    ToolSolid { cutter, flute_length, shank: vec![shank], holder: Vec::new() }
}

/// A shape by its place, and the largest lengths of its third derivatives by x and by y.
struct By<F>(F, [f64; 2]);

impl<F: Fn(f64, f64) -> (Point3<f64>, Vector3<f64>) + Sync> Shape for By<F> {
    fn place(&self, x: f64, y: f64) -> Place {
        let (position, normal) = self.0(x, y);
        Place { position, normal: normal.normalize(), parameters: [x, y] }
    }

    fn thickness(&self, rectangle: [[f64; 2]; 2]) -> CellThickness {
        CellThickness::of_surface([0, 1].map(|k| {
            let mut along = [Jet::constant(Interval::ZERO); 3];
            along[0].orders[3] = Interval::new([-self.1[k], self.1[k]]);
            along[0].orders[1..3].fill(Interval::ALL);
            CellThickness::of(&along, 0.5 * (rectangle[k][1] - rectangle[k][0]))
        }))
    }
}

fn certify(shape: &dyn Shape, solid: &ToolSolid, poses: &[RotaryPose]) -> SurfaceReport {
    certify_on(&Chain::tilting_table(), shape, solid, poses)
}

fn certify_on(chain: &Chain, shape: &dyn Shape, solid: &ToolSolid, poses: &[RotaryPose]) -> SurfaceReport {
    let sweep = Sweep::through(solid, chain, poses).expect("a way");
    let id = SurfaceId { kind: SurfaceKind::Hub(PassageId::FIRST), sector: 0 };
    certify_shape(shape, id, &[sweep], 0.25).expect("a report")
}

/// Found figures equal the truth, and bounds hold without giving away more than they may.
#[track_caller]
fn agrees(report: &SurfaceReport, gouge: f64, excess: f64) {
    let found = (report.gouge.value.get(), report.excess.value.get());
    assert!((found.0 + gouge).abs() < TENTH, "gouge {} um, truth {} um", -found.0 * 1e3, gouge * 1e3);
    assert!((found.1 - excess).abs() < TENTH, "excess {} um, truth {} um", found.1 * 1e3, excess * 1e3);
    let slack = SLACK + TENTH;
    assert!((gouge.max(0.0) - 1e-9..gouge.max(0.0) + slack).contains(&report.gouge_bound.get()), "{report:?}");
    let most = excess.max(0.0);
    assert!((most - 1e-9..most * 1.02 + slack).contains(&report.excess_bound.get()), "{report:?}");
}

fn plane(side: f64) -> impl Shape {
    By(move |x, y| (Point3::new(x * side, y * side, 0.0), Vector3::z()), [0.0; 2])
}

/// Lines along x, `step` apart, with the tool tilted so that the contact is not at the tip. `level` is the height of the
/// lowest point of the cutter over the plane.
fn lines(radius: f64, side: f64, step: f64, level: f64, rotary: [f64; 2]) -> Vec<RotaryPose> {
    let axis = Chain::tilting_table().tool_axis(rotary);
    let mut poses = Vec::new();
    let count = (side / step).ceil() as i32 + 8;
    for k in -4..count {
        let y = f64::from(k) * step;
        let ends = if k % 2 == 0 { [-5.0, side + 5.0] } else { [side + 5.0, -5.0] };
        for x in ends {
            let centre = Point3::new(x, y, radius + level);
            poses.push(RotaryPose { tip: centre - axis * radius, rotary });
        }
    }
    poses
}

#[test]
fn ball_over_plane() {
    let (radius, step, side) = (3.0_f64, 0.4_f64, 6.0_f64);
    let ridge = radius - (radius * radius - 0.25 * step * step).sqrt();
    for (a, c) in [(0.0, 0.0), (0.5, 0.3), (-0.9, 2.0)] {
        for level in [0.0, -0.0025, 0.004] {
            for cutter in [
                Cutter::ball(radius),
                Cutter::tapered_ball(radius, 0.1),
                Cutter::lollipop(radius),
                Cutter::barrel(5.0, 60.0, radius),
            ] {
                // A barrel stands wider than its tip: upright only.
                if cutter.barrel_arc().is_some() && a != 0.0 {
                    continue;
                }
                let flutes = if cutter.kind() == Kind::Lollipop { 1.9 * radius } else { 40.0 };
                let report = certify(&plane(side), &tool(cutter, flutes), &lines(radius, side, step, level, [a, c]));
                agrees(&report, -level, ridge + level);
            }
        }
    }
}

#[test]
fn bull_nose_over_plane_leaves_the_ridge_of_its_corner() {
    // Upright and wide passes: flat floors that overlap, and nothing is left.
    let solid = tool(Cutter::bull(4.0, 1.0), 20.0);
    let mut poses = Vec::new();
    for k in -1..4 {
        let y = f64::from(k) * 5.0;
        for x in if k % 2 == 0 { [-6.0, 16.0] } else { [16.0, -6.0] } {
            poses.push(RotaryPose { tip: Point3::new(x, y, -0.002), rotary: [0.0; 2] });
        }
    }
    agrees(&certify(&plane(10.0), &solid, &poses), 0.002, -0.002);
}

#[test]
fn cylinder_beside_plane() {
    // A wall x = 0 with material behind it; the mill leans by a small angle towards it, so that the cut deepens upward.
    let (radius, lean, low, high) = (5.0_f64, 1e-3_f64, 2.0, 12.0);
    let wall = By(move |x: f64, y: f64| (Point3::new(0.0, x * 10.0, low + y * (high - low)), Vector3::x()), [0.0; 2]);
    for cutter in [Cutter::flat(radius), Cutter::bull(radius, 1.0)] {
        let solid = tool(cutter, 30.0);
        // Axis in the plane of y = 0 leaning to -x: A about x after C = pi/2 about z.
        let c = -std::f64::consts::FRAC_PI_2;
        let axis = Chain::tilting_table().tool_axis([lean, c]);
        assert!((axis - Vector3::new(-lean.sin(), 0.0, lean.cos())).norm() < 1e-12);
        let pose = |y: f64| RotaryPose { tip: Point3::new(radius, y, 0.0), rotary: [lean, c] };
        let report = certify(&wall, &solid, &[pose(-20.0), pose(30.0)]);
        // Distance of (0, 0, h) to the axis, less the radius.
        let g = |h: f64| radius * lean.cos() - h * lean.sin() - radius;
        agrees(&report, -g(high), g(low));
    }
}

#[test]
fn cone_on_cone() {
    // The tip stands still on the axis of C while C turns: the side of the cutter sweeps a cone about that axis.
    let (ball, half, tilt) = (2.0_f64, 0.08_f64, 0.5_f64);
    let solid = tool(Cutter::tapered_ball(ball, half), 40.0);
    let poses: Vec<RotaryPose> =
        (0..=8).map(|k| RotaryPose { tip: Point3::origin(), rotary: [tilt, f64::from(k) * 0.3] }).collect();
    // Outer side of the section through the axis: a line at tilt + half, `ball` beyond the centre of the ball.
    let (along, out) = ((tilt + half).sin_cos(), (tilt + half).cos());
    let centre = (ball * tilt.sin(), ball * tilt.cos());
    let depth = 0.0031;
    let widest = centre.0 + along.0 * 25.0 + ball;
    let at = move |x: f64, y: f64| {
        let l = 5.0 + 20.0 * y;
        // Material outside of the cone; the cutter reaches `depth` into it.
        let r = centre.0 + along.0 * l + (ball - depth) * out;
        let z = centre.1 + along.1 * l - (ball - depth) * along.0;
        // The axis leans to azimuth C - pi/2.
        let azimuth = -std::f64::consts::FRAC_PI_2 + 0.2 + 1.8 * x;
        let radial = Vector3::new(azimuth.cos(), azimuth.sin(), 0.0);
        (Point3::from(radial * r + Vector3::z() * z), -radial * out + Vector3::z() * along.0)
    };
    let socket = By(at, [widest * 1.8_f64.powi(3), 0.0]);
    agrees(&certify(&socket, &solid, &poses), depth, -depth);
}

/// What is found is exact at any depth. A cut by far over its contract (here none is asked for) is proved no closer than by the
/// radius of the cutter.
#[test]
fn plunge_of_an_exact_depth() {
    const RADIUS: f64 = 3.0;
    for cutter in [Cutter::ball(RADIUS), Cutter::bull(RADIUS, 0.5), Cutter::flat(RADIUS)] {
        for depth in [0.9 * UNPROVED_GOUGE, 1.0] {
            let solid = tool(cutter, 20.0);
            let pose = |z: f64| RotaryPose { tip: Point3::new(5.3, 4.1, z), rotary: [0.0; 2] };
            let report = certify(&plane(10.0), &solid, &[pose(30.0), pose(-depth), pose(30.0)]);
            assert!((report.gouge.depth.get() - depth).abs() < TENTH, "{} mm", report.gouge.depth.get());
            let most = if depth > UNPROVED_GOUGE { RADIUS } else { depth + SLACK };
            assert!(
                (depth - 1e-9..most + TENTH).contains(&report.gouge_bound.get()),
                "{} mm",
                report.gouge_bound.get()
            );
            assert_eq!(report.gouge.at.map(|at| at.index.min(1)), Some(1));
        }
    }
}

#[test]
fn swept_helix() {
    // A ball on a helix, its axis turning along: the design is the tube about the helix, `depth` narrower.
    let (ball, r, pitch, depth) = (2.0_f64, 15.0_f64, 6.0_f64, 0.0017);
    let solid = tool(Cutter::tapered_ball(ball, 0.05), 25.0);
    let centre = move |t: f64| Point3::new(r * t.cos(), r * t.sin(), pitch * t / std::f64::consts::TAU);
    let at = move |x: f64, y: f64| {
        let t = 0.8 * x;
        let forward = Vector3::new(-r * t.sin(), r * t.cos(), pitch / std::f64::consts::TAU).normalize();
        let out = Vector3::new(t.cos(), t.sin(), 0.0);
        let up = forward.cross(&out);
        // The lower side, where the ball is all of the cutter.
        let up = if up.z > 0.0 { up } else { -up };
        let angle = -0.9 + 1.8 * y;
        let direction = out * angle.sin() - up * angle.cos();
        (centre(t) + direction * (ball - depth), -direction)
    };
    // Along x the whole tube turns about Z and moves evenly.
    let tube = By(at, [(r + ball) * 0.8_f64.powi(3), ball * 1.8_f64.powi(3)]);
    for chain in chains() {
        // Chords leave the helix by 15 (1e-3)^2 / 8 mm, 2 nm.
        let poses: Vec<RotaryPose> = (-200..=1000)
            .map(|k| {
                let t = f64::from(k) * 1e-3;
                let rotary = [0.4 + 0.1 * t, t];
                RotaryPose { tip: centre(t) - chain.tool_axis(rotary) * ball, rotary }
            })
            .collect();
        agrees(&certify_on(&chain, &tube, &solid, &poses), depth, -depth);
    }
}

/// A tilting table, a nutating head over a table, and a nutating table: the verifier takes no angle between axes for granted.
fn chains() -> Vec<Chain> {
    let line = |carries, direction: [f64; 3]| AxisLine {
        carries,
        direction: Unit::new_normalize(Vector3::from(direction)),
        point: Point3::origin(),
    };
    let nutating =
        |carries| Chain::new([line(carries, [1.0, 0.0, 1.0]), line(Carries::Part, [0.0, 0.0, 1.0])]).expect("a chain");
    vec![Chain::tilting_table(), nutating(Carries::Tool), nutating(Carries::Part)]
}
