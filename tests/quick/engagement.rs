//! The arc of engagement against a simulation of its own kind: points of a grid that the cutter meets one after the
//! other. It shares only the positions of the tool with the stock of the verifier.

use crate::support;
use impellerc::collide::{Cutter, ToolSolid};
use impellerc::diag::Sink;
use impellerc::entity::PrimaryMap;
use impellerc::ir::{JointMove, Motion, MotionOperation, MoveKind, Program, Tool};
use impellerc::progress::Progress;
use impellerc::verify::stock::{OperationStock, Settings, simulate};
use nalgebra::{Point3, Vector3};
use std::ops::Range;

/// Largest way and turn over which contacts count as one engagement, mm and radians, as the certificate defines.
const PIECE: [f64; 2] = [2.0, 2.0 * std::f64::consts::PI / 180.0];

/// Cells of the verifier's stock in these tests, mm.
const CELL: f64 = 0.5;

/// A pose of the tool: tip and axis.
type Pose = (Point3<f64>, Vector3<f64>);

/// Points of a grid at some heights, and whether each is material.
struct Grid {
    low: [f64; 2],
    /// Distance of points in x and y.
    step: f64,
    count: [usize; 2],
    heights: Vec<f64>,
    material: Vec<bool>,
}

impl Grid {
    fn new(low: [f64; 2], high: [f64; 2], step: f64, heights: Vec<f64>, inside: impl Fn(&Point3<f64>) -> bool) -> Self {
        let count = [0, 1].map(|k| ((high[k] - low[k]) / step) as usize + 1);
        let mut grid = Self { low, step, count, heights, material: Vec::new() };
        for k in 0..grid.heights.len() {
            for j in 0..count[1] {
                for i in 0..count[0] {
                    let p = grid.point(i, j, k);
                    grid.material.push(inside(&p));
                }
            }
        }
        grid
    }

    fn point(&self, i: usize, j: usize, k: usize) -> Point3<f64> {
        let at = |axis: usize, n: usize| self.low[axis] + self.step * n as f64;
        Point3::new(at(0, i), at(1, j), self.heights[k])
    }

    /// Points of a row inside of the endless cylinder of the cutter: |q|^2 - (q a)^2 <= r^2 is a quadratic of x.
    fn row(&self, j: usize, k: usize, (tip, axis): &Pose, radius: f64) -> Range<usize> {
        let q = self.point(0, j, k) - tip;
        let [square, half, rest] = [
            1.0 - axis.x * axis.x,
            q.x - axis.x * q.dot(axis),
            q.norm_squared() - q.dot(axis).powi(2) - radius * radius,
        ];
        let under = half * half - square * rest;
        if under < 0.0 {
            return 0..0;
        }
        let at = |sign: f64| ((-half + sign * under.sqrt()) / square / self.step).clamp(-1.0, self.count[0] as f64);
        ((at(-1.0).ceil() as usize).min(self.count[0]))..(((at(1.0).floor() + 1.0) as usize).min(self.count[0]))
    }

    /// Removes the points inside of a flat cutter that has come from one pose to the next, and adds the angles of their
    /// contacts round the tool axis to `span`, from the direction of feed.
    fn cut(&mut self, before: &Pose, to: &Pose, (radius, flute): (f64, f64), span: &mut [f64; 2]) {
        let (tip, axis) = to;
        let way = to.0 - before.0;
        let feed = (way - axis * way.dot(axis)).try_normalize(1e-9);
        for k in 0..self.heights.len() {
            // The axis at this height, and the rows that the cutter can reach there.
            let (y, wide) = (tip.y + axis.y / axis.z * (self.heights[k] - tip.z), radius / axis.z + self.step);
            let [from, to_row] = [y - wide, y + wide].map(|y| ((y - self.low[1]) / self.step).max(0.0) as usize);
            for j in from..(to_row + 1).min(self.count[1]) {
                let row = self.row(j, k, to, radius);
                let first = (k * self.count[1] + j) * self.count[0];
                if !self.material[first + row.start..first + row.end.max(row.start)].contains(&true) {
                    continue;
                }
                for i in row.filter(|i| self.material[first + i]).collect::<Vec<_>>() {
                    let q = self.point(i, j, k) - tip;
                    let s = q.dot(axis);
                    if !(0.0..=flute).contains(&s) {
                        continue;
                    }
                    self.material[first + i] = false;
                    if let Some(feed) = feed {
                        let r = q - axis * s;
                        // A contact up to one advance late; what lies behind is not in the advancing half.
                        let ahead = r.dot(&feed);
                        if ahead < -way.norm() {
                            continue;
                        }
                        let angle = r.dot(&axis.cross(&feed)).atan2(ahead.max(0.0));
                        *span = [span[0].min(angle), span[1].max(angle)];
                    }
                }
            }
        }
    }
}

/// Pose at a share of a move.
fn pose(program: &Program, pair: &[JointMove], t: f64) -> Pose {
    let machine = &program.machine;
    let [a, b] = [0, 1].map(|k| (machine.forward(&pair[k].joints).tip, pair[k].joints.rotary));
    let turn = [0, 1].map(|k| a.1[k] + (b.1[k] - a.1[k]) * t);
    (a.0 + (b.0 - a.0) * t, machine.chain.tool_axis(turn))
}

/// For each move the largest arc, in degrees, of the material that the cutter meets over a piece of the move; `advance`
/// is the way between two poses, mm.
fn arcs_on(grid: &mut Grid, program: &Program, moves: &[JointMove], tool: (f64, f64), advance: f64) -> Vec<f64> {
    let mut arcs = vec![0.0; moves.len()];
    for (pair, arc) in moves.windows(2).zip(&mut arcs[1..]) {
        if pair[1].kind == MoveKind::Rapid {
            continue;
        }
        let [start, end] = [0.0, 1.0].map(|t| pose(program, pair, t));
        let (way, turn) =
            ((end.0 - start.0).norm(), program.machine.turn(pair[0].joints.rotary, pair[1].joints.rotary));
        let pieces = (way / PIECE[0]).max(turn / PIECE[1]).ceil().max(1.0);
        // The end of the flutes moves by the turn as well.
        let steps = ((way + turn * tool.1) / pieces / advance).ceil().max(1.0);
        for piece in 0..pieces as usize {
            let mut span = [f64::INFINITY, f64::NEG_INFINITY];
            for k in 0..steps as usize {
                let at = |k: usize| pose(program, pair, (piece as f64 + k as f64 / steps) / pieces);
                grid.cut(&at(k), &at(k + 1), tool, &mut span);
            }
            *arc = f64::max(*arc, (span[1] - span[0]).to_degrees());
        }
    }
    arcs
}

fn by_verifier(program: &Program, motion: &Motion) -> OperationStock {
    let mut settings = Settings { cell: Some(CELL), after: None };
    let report = simulate(program, motion, &mut settings, &Progress::default(), &mut Sink::default());
    report.expect("a stock").operations.swap_remove(0)
}

/// Largest error of an arc on a grid, degrees: a point may lie half a diagonal of a cell from the edge of the material,
/// across the feed, so that an arc that ends at 90 deg ends short by acos(1 - e/r); and the cutter meets it up to one
/// advance late, so that the angle is wrong by the advance over r.
fn grid_error(radius: f64, step: f64, advance: f64) -> f64 {
    let across = step * 0.5_f64.sqrt();
    2.0 * ((1.0 - across / radius).acos() + advance / radius).to_degrees()
}

/// Cylinder about Z with its top at zero.
const BLANK: [f64; 2] = [14.0, 6.0];

/// Flat cutter: radius and flute length.
const TOOL: (f64, f64) = (5.0, 20.0);

/// Distance of the passes from the first one, and their radial depth of cut; the last one is far from all.
const PASSES: [(f64, f64); 3] = [(-4.0, 10.0), (-2.75, 1.25), (1.25, 4.0)];

/// Machine, tool and blank of the closed forms.
fn plate() -> Program {
    let mut program = support::channel_only(0.01);
    let solid = ToolSolid {
        cutter: Cutter::Flat { radius: TOOL.0 },
        flute_length: TOOL.1,
        shank: Vec::new(),
        holder: Vec::new(),
    };
    let mut tools = PrimaryMap::new();
    for (_, tool) in program.tools.iter() {
        tools.push(Tool { solid: solid.clone(), ..tool.clone() });
    }
    let [radius, height] = BLANK;
    program.stock.profile = vec![[0.0, -height], [radius, -height], [radius, 0.0], [0.0, 0.0]];
    Program { tools, machine: support::machine(), ..program }
}

/// Straight passes in moves of 2 mm, at an angle to the rays and to the grid; rapids between them.
fn passes(program: &Program, angle: f64) -> Motion {
    let place = |along: f64, across: f64, z: f64| {
        let (s, c) = angle.sin_cos();
        program.machine.joints(&Point3::new(along * c - across * s, along * s + across * c, z), [0.0, 0.0])
    };
    let mut moves: Vec<JointMove> = Vec::new();
    for (across, _) in PASSES {
        for k in -11..=11 {
            let kind = if k == -11 { MoveKind::Rapid } else { MoveKind::Cut };
            let joints = place(2.0 * f64::from(k), across, -4.0);
            moves.push(JointMove { kind, joints, feed: None, time: 1.0, pass: 0, stop: false });
        }
        let up = place(22.0, across, 10.0);
        moves.push(JointMove { kind: MoveKind::Rapid, joints: up, feed: None, time: 1.0, pass: 0, stop: false });
    }
    let operation = program.operations.ids().next().unwrap();
    Motion { operations: vec![MotionOperation { operation, labels: vec![String::new()], moves }] }
}

/// Moves whose arcs differ by more than `error`, with both arcs.
fn differences(one: &[f64], other: &[f64], error: f64) -> Vec<(usize, f64, f64)> {
    let pairs = one.iter().zip(other).enumerate().map(|(i, (a, b))| (i, *a, *b));
    pairs.filter(|(_, a, b)| (a - b).abs() > error).collect()
}

/// A slot of 180 deg, side cuts of acos(1 - a_e/r) below and above half of the diameter, and whatever the round rim gives
/// at both ends of the passes.
#[test]
fn slots_and_side_cuts_have_the_arcs_of_the_closed_form_and_of_the_points() {
    let program = plate();
    let motion = passes(&program, 0.3);
    let moves = &motion.operations[0].moves;
    let (step, advance) = (0.0125, 0.05);
    let [radius, height] = BLANK;
    let inside = |p: &Point3<f64>| p.x.hypot(p.y) < radius && p.z < 0.0 && p.z > -height;
    let mut grid = Grid::new([-radius; 2], [radius; 2], step, vec![-2.0], inside);
    let points = arcs_on(&mut grid, &program, moves, TOOL, advance);
    let found = by_verifier(&program, &motion);
    let arcs: Vec<f64> = found.moves.iter().map(|m| m.arc).collect();
    let error = grid_error(TOOL.0, step, advance);
    println!("error of the grid {error:.2} deg");
    assert!(error < 10.0);
    for (pass, (_, depth)) in PASSES.into_iter().enumerate() {
        let middle = pass * moves.len() / PASSES.len() + 12;
        let truth = (1.0 - depth / TOOL.0).acos().to_degrees();
        println!("a_e {depth}: {truth:.2} deg, points {:.2}, stock {:.2}", points[middle], arcs[middle]);
        assert!((points[middle] - truth).abs() < error, "{} {truth}", points[middle]);
        assert!((arcs[middle] - truth).abs() < 2.0, "{} {truth}", arcs[middle]);
    }
    let wrong = differences(&points, &arcs, error);
    assert!(wrong.is_empty(), "{wrong:?}");
    // The comparison sees 10 deg.
    for by in [-10.0, 10.0] {
        let shifted: Vec<f64> = arcs.iter().map(|a| if *a > 0.0 { a + by } else { *a }).collect();
        assert!(!differences(&points, &shifted, error).is_empty(), "{by}");
    }
}
