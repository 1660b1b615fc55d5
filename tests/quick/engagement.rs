//! The arc of engagement against a simulation of its own kind: points of a grid that the cutter meets one after the
//! other. It shares only the positions of the tool with the stock of the verifier.

use crate::support::{self, jobs};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::units::Deg;
use impellerc::diagnostics::Sink;
use impellerc::ir::{Contract, JointMove, Motion, MotionOperation, MoveKind, Operation, Program, Tool};
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::collide::{Cutter, ToolSolid};
use impellerc::tool_stock::stock::{SLICES, Slices};
use impellerc::verify::stock::{Engagement, OperationStock, Settings, TimeAndPath, default_cell, simulate};
use impellerc::wheel::contract::{ContractKind, Cuts};
use impellerc::wheel::part::TurnedProfile;
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;
use std::ops::Range;

/// Largest way and turn over which contacts count as one engagement, mm and radians, as the certificate defines.
const PIECE: [f64; 2] = [2.0, 2.0 * std::f64::consts::PI / 180.0];

/// A pose of the tool: tip and axis.
type Pose = (Point3<f64>, Vector3<f64>);

/// Points of a grid at some heights, and whether each is material.
struct PointGrid {
    low: [f64; 2],
    /// Distance of points in x and y.
    step: f64,
    count: [usize; 2],
    heights: Vec<f64>,
    material: Vec<bool>,
}

impl PointGrid {
    /// A turned blank: `inside` gets the index of a height, and the distance from the axis of Z.
    fn new(low: [f64; 2], high: [f64; 2], step: f64, heights: Vec<f64>, inside: impl Fn(usize, f64) -> bool) -> Self {
        let count = [0, 1].map(|k| ((high[k] - low[k]) / step) as usize + 1);
        let mut grid = Self { low, step, count, heights, material: Vec::new() };
        for k in 0..grid.heights.len() {
            for j in 0..count[1] {
                for i in 0..count[0] {
                    let p = grid.point(i, j, k);
                    grid.material.push(inside(k, p.x.hypot(p.y)));
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

    /// Removes the points inside of a flat cutter that has come from one pose to the next, and adds their distances from the
    /// tool axis, across the direction of feed, to the sides at their height.
    fn cut(&mut self, before: &Pose, to: &Pose, (radius, flute): (f64, f64), sides: &mut Sides) {
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
                    let height = q.dot(axis);
                    if !(0.0..=flute).contains(&height) {
                        continue;
                    }
                    self.material[first + i] = false;
                    if let Some(feed) = feed {
                        sides.add(height, q.dot(&axis.cross(&feed)));
                    }
                }
            }
        }
    }

    /// Diameter of a ball that always holds a point, mm: the diagonal between neighbouring points.
    fn unseen(&self) -> f64 {
        let rise = self.heights.windows(2).map(|h| h[1] - h[0]).fold(0.0, f64::max);
        (2.0 * self.step * self.step + rise * rise).sqrt()
    }
}

/// Pose at a share of a move.
fn pose(program: &Program, pair: &[JointMove], t: f64) -> Pose {
    let machine = &program.machine;
    let [a, b] = [0, 1].map(|k| (machine.forward(&pair[k].joints).tip, pair[k].joints.rotary));
    let turn = [0, 1].map(|k| a.1[k] + (b.1[k] - a.1[k]) * t);
    (a.0 + (b.0 - a.0) * t, machine.chain.tool_axis(turn))
}

/// Heights over which removed points are put together, mm: less than the verifier takes together for its bound.
const THICK: f64 = 0.25;

/// Least and largest distance of removed points from the tool axis, across the direction of feed, mm, for each piece of
/// [`THICK`] of the height over the tip.
#[derive(Clone, Default)]
struct Sides(BTreeMap<usize, [f64; 2]>);

impl Sides {
    fn add(&mut self, height: f64, across: f64) {
        let own = self.0.entry((height / THICK) as usize).or_insert([f64::INFINITY, f64::NEG_INFINITY]);
        *own = [own[0].min(across), own[1].max(across)];
    }

    fn join(&mut self, other: &Self) {
        for (k, side) in &other.0 {
            let own = self.0.entry(*k).or_insert([f64::INFINITY, f64::NEG_INFINITY]);
            *own = [own[0].min(side[0]), own[1].max(side[1])];
        }
    }

    /// The largest arc, degrees, when all points within `around` of a height count for it, and sides are wider by
    /// `unseen`.
    fn arc(&self, around: f64, unseen: f64, radius: f64) -> f64 {
        let angle = |s: f64| (s / radius).clamp(-1.0, 1.0).asin().to_degrees();
        let reach = (around / THICK).ceil() as usize;
        let near = |k: usize| self.0.range(k.saturating_sub(reach)..=k + reach).map(|(_, s)| *s);
        let all =
            |k: &usize| near(*k).fold([f64::INFINITY, f64::NEG_INFINITY], |a, s| [a[0].min(s[0]), a[1].max(s[1])]);
        let arcs = self.0.keys().map(all).map(|[from, to]| angle(to + unseen) - angle(from - unseen));
        arcs.fold(0.0, f64::max)
    }
}

/// Sides of each piece of each move, and the turn of the tool over a piece, radians; `advance` is the way between two
/// poses, mm.
fn sides_on(
    grid: &mut PointGrid,
    program: &Program,
    moves: &[JointMove],
    tool: (f64, f64),
    advance: f64,
) -> Vec<Pieces> {
    let mut all = vec![Pieces::default()];
    for pair in moves.windows(2) {
        let mut found = Pieces::default();
        let [start, end] = [0.0, 1.0].map(|t| pose(program, pair, t));
        let (way, turn) =
            ((end.0 - start.0).norm(), program.machine.turn(pair[0].joints.rotary, pair[1].joints.rotary));
        found.way = way;
        if pair[1].kind != MoveKind::Rapid {
            let pieces = (way / PIECE[0]).max(turn / PIECE[1]).ceil().max(1.0);
            found.turn = turn / pieces;
            // The end of the flutes moves by the turn as well.
            let steps = ((way + turn * tool.1) / pieces / advance).ceil().max(1.0);
            for piece in 0..pieces as usize {
                let mut sides = Sides::default();
                for k in 0..steps as usize {
                    let at = |k: usize| pose(program, pair, (piece as f64 + k as f64 / steps) / pieces);
                    grid.cut(&at(k), &at(k + 1), tool, &mut sides);
                }
                found.sides.push(sides);
            }
        }
        all.push(found);
    }
    all
}

/// Pieces of a move.
#[derive(Clone, Default)]
struct Pieces {
    way: f64,
    turn: f64,
    sides: Vec<Sides>,
}

/// The largest arc of the points of each move: no more than the true arc of a piece.
fn found_by_points(pieces: &[Pieces], radius: f64) -> Vec<f64> {
    pieces.iter().map(|p| p.sides.iter().map(|s| s.arc(0.0, 0.0, radius)).fold(0.0, f64::max)).collect()
}

fn by_verifier(program: &Program, motion: &Motion, cell: Option<f64>) -> OperationStock {
    let mut settings = Settings { cell, ..Settings::default() };
    let report = simulate(program, motion, &mut settings, &Progress::default(), &mut Sink::default());
    report.expect("a stock").operations.swap_remove(0)
}

/// Cylinder about Z with its top at zero: radius and height, in radii of the cutter.
const BLANK: [f64; 2] = [2.8, 1.2];

/// Distance of the passes from the first one, and their radial depth of cut, in radii of the cutter; the last one is far
/// from all.
const PASSES: [(f64, f64); 3] = [(-0.8, 2.0), (-0.55, 0.25), (0.25, 0.8)];

/// Machine, tool and blank of the closed forms, with a contract on the engagement.
fn plate(radius: f64) -> Program {
    let mut program = support::channel_only(0.01);
    let solid =
        ToolSolid { cutter: Cutter::flat(radius), flute_length: 4.0 * radius, shank: Vec::new(), holder: Vec::new() };
    let mut tools = PrimaryMap::new();
    for (_, tool) in program.tools.iter() {
        tools.push(Tool { solid: solid.clone(), ..tool.clone() });
    }
    let [r, height] = BLANK.map(|x| x * radius);
    program.stock.profile = TurnedProfile::new(vec![[0.0, -height], [r, -height], [r, 0.0], [0.0, 0.0]]);
    program.contracts.push(Contract::whole(ContractKind::Engagement(Cuts::All), 60.0));
    Program { tools, machine: support::machine(), ..program }
}

/// Straight passes in moves of a given length, at an angle to the rays and to the grid; rapids between them.
fn passes(program: &Program, radius: f64, angle: f64, length: f64) -> Motion {
    let place = |along: f64, across: f64, z: f64| {
        let (s, c) = angle.sin_cos();
        program.machine.joints(&Point3::new(along * c - across * s, along * s + across * c, z), [0.0, 0.0])
    };
    let mut moves: Vec<JointMove> = Vec::new();
    let half = (4.4 * radius / length).ceil() as i32;
    for (across, _) in PASSES {
        for k in -half..=half {
            let kind = if k == -half { MoveKind::Rapid } else { MoveKind::Cut };
            let joints = place(length * f64::from(k), across * radius, -0.8 * radius);
            moves.push(JointMove { kind, joints, feed: None, time: 1.0, pass: 0, stop: false });
        }
        let up = place(length * f64::from(half), across * radius, 2.0 * radius);
        moves.push(JointMove { kind: MoveKind::Rapid, joints: up, feed: None, time: 1.0, pass: 0, stop: false });
    }
    let operation = program.operations.ids().next().unwrap();
    Motion { operations: vec![MotionOperation { operation, labels: vec![String::new()], moves, splines: Vec::new() }] }
}

/// Arc of a radial depth of cut, in radii of the cutter, degrees.
fn closed_form(depth: f64) -> f64 {
    (1.0 - depth).acos().to_degrees()
}

/// A slot of 180 deg, and side cuts of acos(1 - a_e/r) below and above half of the diameter, with the cells that the
/// verifier takes by default, for long and short moves.
#[test]
fn arcs_of_slots_and_side_cuts_lie_within_their_bounds_for_all_cutters() {
    for (radius, angle, length) in
        [(0.5, 0.3, 0.4), (1.0, 0.7, 0.1), (2.0, 0.0, 0.4), (5.0, 0.3, 0.05), (10.0, 1.1, 0.2)]
    {
        let program = plate(radius);
        let motion = passes(&program, radius, angle, length * radius);
        let count = motion.operations[0].moves.len();
        let cell = default_cell(&program);
        assert!(cell <= 0.05 * radius + 1e-12, "{cell}");
        let found = by_verifier(&program, &motion, None);
        for (pass, (_, depth)) in PASSES.into_iter().enumerate() {
            let m = &found.moves[pass * count / PASSES.len() + count / PASSES.len() / 2];
            let (arc, bound, truth) = (m.arc.get(), m.arc_bound.get(), closed_form(depth));
            // The bound is that of a depth of cut larger by a diagonal of a cell.
            let widest = closed_form((depth + 2.0_f64.sqrt() * cell / radius + 2e-3).min(2.0));
            println!("r {radius}, a_e {depth}: {truth:.2} deg, stock {arc:.2}, bound {bound:.2}");
            assert!(arc < truth + 1.0 && arc > truth - 8.0, "{arc} {truth}");
            assert!(bound >= truth && bound < widest + 1.0, "{bound} {truth} {widest}");
        }
    }
}

/// Cells of half of the radius show less than the true arc; the bound does not.
#[test]
fn coarse_cells_never_bound_an_arc_too_low() {
    for (angle, length) in [(0.3, 2.0), (0.3, 0.3), (0.0, 0.5), (0.785, 0.1)] {
        let program = plate(1.0);
        let motion = passes(&program, 1.0, angle, length);
        let count = motion.operations[0].moves.len() / PASSES.len();
        let found = by_verifier(&program, &motion, Some(1.0));
        for (pass, (_, depth)) in PASSES.into_iter().enumerate() {
            let cuts = &found.moves[pass * count..(pass + 1) * count];
            let largest = |arc: fn(&Engagement) -> Deg| cuts.iter().map(|m| arc(m).get()).fold(0.0, f64::max);
            let [arc, bound] = [largest(|m| m.arc), largest(|m| m.arc_bound)];
            println!("{length}: a_e {depth}: {:.2} deg, stock {arc:.2}, bound {bound:.2}", closed_form(depth));
            assert!(bound >= closed_form(depth), "{bound}");
        }
    }
}

/// Only the first pass is a slot. The stock shows its time, and its arc does not count outside of slots.
#[test]
fn a_channel_is_a_slot_from_where_the_cutter_enters() {
    let program = plate(2.0);
    let motion = passes(&program, 2.0, 0.3, 0.4);
    let found = by_verifier(&program, &motion, None);
    let [blank, _] = BLANK;
    // From the first contact to the last one, on a chord of the blank at 0.8 of the radius of the cutter.
    let chord = 2.0 * 2.0 * ((blank + 1.0_f64).powi(2) - 0.64).sqrt();
    let [time, way] = [found.arcs.slots.time.get(), found.arcs.slots.path.get()];
    println!("slot {way:.2} mm, {time:.0} s; contact {chord:.2} mm");
    assert!((way - chord).abs() < 2.0 && (time - way / 0.4).abs() < 1e-6);
    assert!(found.arc_bound.unwrap().value.get() > 179.9);
    // The slot loads the cutter most: the full depth of 0.8 radii, where the side cuts have less than half of the arc.
    let load = found.slot_depth.unwrap();
    assert!((load.value.get() - 1.6).abs() < 0.05 && load.depth.get() < 1.601 && load.arc.get() > 175.0, "{load:?}");
    let outside = found.arc_outside_slots.unwrap();
    let widest = closed_form(0.8 + 0.075);
    println!("outside {outside:?}");
    assert!(outside.value.get() >= closed_form(0.8) && outside.value.get() < widest + 1.0, "{outside:?}");
    // A cut of 80 % of the diameter is no slot.
    let wide = Program { stock: program.stock.clone(), ..program.clone() };
    let moves = &motion.operations[0].moves;
    let shifted: Vec<JointMove> = moves
        .iter()
        .map(|m| {
            let tip = wide.machine.forward(&m.joints).tip;
            let (s, c) = 0.3_f64.sin_cos();
            let by = nalgebra::Vector3::new(-s, c, 0.0) * (2.0 * (-2.8 - 1.0 + 1.6 + 0.8));
            JointMove { joints: wide.machine.joints(&(tip + by), [0.0, 0.0]), ..*m }
        })
        .collect();
    let count = moves.len() / PASSES.len();
    let operation = MotionOperation { moves: shifted[..count].to_vec(), ..motion.operations[0].clone() };
    let side = by_verifier(&wide, &Motion { operations: vec![operation] }, None);
    println!("side cut {:?} {:?}", side.arcs.slots, side.arc_outside_slots);
    assert_eq!(side.arcs.slots, TimeAndPath::default());
    assert!(side.arc_outside_slots.unwrap().value.get() > 120.0);
}

/// A wall at one height and a floor at another are no slot: each height has its own arc.
#[test]
fn each_height_has_its_own_arc() {
    let radius = 2.0;
    let program = plate(radius);
    // A slot; then a pass beside it that runs deeper: at its tip it cuts over the full width, above only beside the slot.
    let motion = passes(&program, radius, 0.3, 0.4);
    let moves = &motion.operations[0].moves;
    let count = moves.len() / PASSES.len();
    let (beside, deeper) = (0.5, 0.3);
    let second: Vec<JointMove> = moves[..count]
        .iter()
        .map(|m| {
            let tip = program.machine.forward(&m.joints).tip;
            let (s, c) = 0.3_f64.sin_cos();
            let by = Vector3::new(-s * beside * radius, c * beside * radius, -deeper);
            JointMove { joints: program.machine.joints(&(tip + by), [0.0, 0.0]), ..*m }
        })
        .collect();
    let operation = MotionOperation { moves: [&moves[..count], &second].concat(), ..motion.operations[0].clone() };
    let found = by_verifier(&program, &Motion { operations: vec![operation.clone()] }, None);
    let middle = &found.moves[count + count / 2];
    assert!(middle.arc.get() > 170.0, "the floor is cut over the full width: {middle:?}");
    // The same pass at the height of the slot has the arc of its stepover.
    let level: Vec<JointMove> = second
        .iter()
        .map(|m| {
            let tip = program.machine.forward(&m.joints).tip + Vector3::new(0.0, 0.0, deeper + 0.01);
            JointMove { joints: program.machine.joints(&tip, [0.0, 0.0]), ..*m }
        })
        .collect();
    let operation = MotionOperation { moves: [&moves[..count], &level].concat(), ..operation };
    let found = by_verifier(&program, &Motion { operations: vec![operation] }, None);
    let middle = &found.moves[count + count / 2];
    println!("at the height of the slot {middle:?}");
    assert!(
        (middle.arc.get() - closed_form(beside)).abs() < 4.0 && middle.arc_bound.get() >= closed_form(beside),
        "{middle:?}"
    );
}

/// Straight passes by the points of a grid: each way to find an arc stays below the bound of the other.
#[test]
fn points_and_rays_find_no_more_than_the_bound_of_the_other() {
    let radius = 5.0;
    let program = plate(radius);
    let motion = passes(&program, radius, 0.3, 2.0);
    let moves = &motion.operations[0].moves;
    let [blank, _] = BLANK.map(|x| x * radius);
    let inside = |_: usize, r: f64| r < blank;
    let heights = (0..40).map(|k| -0.1 * (f64::from(k) + 0.5)).collect();
    let mut grid = PointGrid::new([-blank; 2], [blank; 2], 0.05, heights, inside);
    let pieces = sides_on(&mut grid, &program, moves, (radius, 20.0), 0.05);
    let found = by_verifier(&program, &motion, None);
    agree(&pieces, &found, &grid, (radius, thickest_slice(20.0, 0.05 * radius)), &|_| true);
}

/// The first passes of the first tool of a roughing: tilted axes, passes beside each other, a turned blank.
#[test]
fn passes_of_roughing_have_the_arcs_of_the_points() {
    let (program, motion) = rough_passes();
    let operation = &motion.operations[0];
    let solid = &program.tools[program.operations[operation.operation].tool].solid;
    let radius = solid.cutter.nominal_radius();
    let mut grid = around(&program, &operation.moves, radius, 0.04);
    let pieces = sides_on(&mut grid, &program, &operation.moves, (radius, solid.flute_length), 0.03);
    let found = by_verifier(&program, &motion, Some(0.05 * radius));
    // Where the tool goes along its axis more than across it, the feed has no side.
    let across = |i: usize| {
        let [start, end] = [0.0, 1.0].map(|t| pose(&program, &operation.moves[i - 1..=i], t));
        let way = end.0 - start.0;
        way.dot(&end.1).abs() < 0.5 * way.norm()
    };
    let slice = thickest_slice(solid.flute_length, 0.05 * radius);
    agree(&pieces, &found, &grid, (radius, slice), &across);
}

/// Thickness of the thickest slice of a cutter with flutes of a length, mm.
fn thickest_slice(flutes: f64, cell: f64) -> f64 {
    let slices = Slices::new(flutes, cell);
    (0..SLICES).map(|k| slices.edge(k + 1) - slices.edge(k)).fold(0.0, f64::max)
}

/// Asserts for each chosen move that points and rays find no more than the bound of the other. Both find the places of
/// true chips, so that both arcs are at most the true one, and each bound adds the diameter of the ball that its points or
/// rays cannot miss. Beside that the direction of feed may differ by the turn of the tool within a piece, and the rays
/// show the moves before as well, over four cells of way.
fn agree(
    pieces: &[Pieces],
    found: &OperationStock,
    grid: &PointGrid,
    (radius, slice): (f64, f64),
    chosen: &dyn Fn(usize) -> bool,
) {
    let points = found_by_points(pieces, radius);
    let window = 0.2 * radius + 1e-9;
    let bound_of_points = |i: usize| {
        let mut sides = Sides::default();
        let mut way = 0.0;
        for p in pieces[..=i].iter().rev() {
            p.sides.iter().for_each(|s| sides.join(s));
            way += p.way;
            if way - pieces[i].way > window {
                break;
            }
        }
        // As high as a slice in which the verifier takes the material together, and the chips that points miss.
        sides.arc(slice + grid.unseen(), grid.unseen(), radius)
    };
    // Both ends of the arc; with the angle between motion and axis over 60 deg, the side turns by 1.16 of the turn.
    let turned = |i: usize| 2.0 * 1.16 * pieces[i].turn.to_degrees() + 0.1;
    let cuts: Vec<usize> = (1..points.len()).filter(|i| points[*i] > 5.0 && chosen(*i)).collect();
    let (mut worst, mut spread) = ([f64::NEG_INFINITY; 2], 0.0);
    let mut over = 0;
    for i in cuts.iter().copied() {
        let (m, bound) = (&found.moves[i], bound_of_points(i));
        let (arc, arc_bound) = (m.arc.get(), m.arc_bound.get());
        println!("{i}: points {:.1} to {bound:.1}, rays {arc:.1} to {arc_bound:.1}, turn {:.2}", points[i], turned(i));
        assert!(points[i] <= arc_bound + turned(i), "{i}: points {} rays {arc_bound}", points[i]);
        assert!(arc <= bound + turned(i), "{i}: rays {arc} points {bound}");
        worst = [worst[0].max(points[i] - arc_bound), worst[1].max(arc - bound)];
        spread += arc_bound - arc;
        // The comparison sees an arc of the rays that is 30 deg short.
        over += usize::from(points[i] > arc_bound - 30.0 + turned(i));
    }
    println!(
        "{} moves; found over the other's bound by {worst:.1?}, mean spread {:.1}, {over} seen",
        cuts.len(),
        spread / cuts.len() as f64
    );
    assert!(cuts.len() > 15 && over * 2 > cuts.len());
}

/// Points round the cuts, at a hundred heights from the lowest tip to the top of the blank.
fn around(program: &Program, moves: &[JointMove], radius: f64, step: f64) -> PointGrid {
    let cuts = moves.iter().filter(|m| m.kind != MoveKind::Rapid);
    let tips: Vec<Point3<f64>> = cuts.map(|m| program.machine.forward(&m.joints).tip).collect();
    let profile = &program.stock.profile;
    let top = profile.iter().map(|p| p[1]).fold(f64::NEG_INFINITY, f64::max);
    let outer = profile.iter().map(|p| p[0]).fold(0.0, f64::max);
    let ends = |k: usize| {
        let all = tips.iter().map(|t| t[k]);
        [all.clone().fold(f64::INFINITY, f64::min), all.fold(f64::NEG_INFINITY, f64::max)]
    };
    let ([x, y, z], wide) = ([ends(0), ends(1), ends(2)], 6.0 * radius);
    let low = [x, y].map(|e| (e[0] - wide).max(-outer));
    let high = [x, y].map(|e| (e[1] + wide).min(outer));
    let heights: Vec<f64> = (0..100).map(|k| z[0] + (top - z[0]) * (f64::from(k) + 0.5) / 100.0).collect();
    // Radii at which the profile crosses each height: material where an odd number of them lies outside.
    let crossings = |z: f64| -> Vec<f64> {
        let edges = (0..profile.len()).map(|i| (profile[i], profile[(i + 1) % profile.len()]));
        let crossed = edges.filter(|(a, b)| (a[1] > z) != (b[1] > z));
        crossed.map(|(a, b)| a[0] + (z - a[1]) / (b[1] - a[1]) * (b[0] - a[0])).collect()
    };
    let radii: Vec<Vec<f64>> = heights.iter().map(|z| crossings(*z)).collect();
    let inside = |k: usize, r: f64| radii[k].iter().filter(|x| r < **x).count() % 2 == 1;
    PointGrid::new(low, high, step, heights, inside)
}

/// The first passes that the first tool of the job `rough` cuts in one sector.
fn rough_passes() -> (Program, Motion) {
    let mut program = jobs::program("rough", None);
    let first = program.operations.iter().next().unwrap().1.clone();
    program.operations = PrimaryMap::new();
    program.operations.push(Operation { sectors: vec![0], ..first });
    program.contracts.clear();
    let mut motion = pipeline::run(&program, &mut Sink::default()).expect("a plan").motion;
    let operation = &mut motion.operations[0];
    let count = operation.moves.len();
    let end = operation.moves.iter().position(|m| m.kind == MoveKind::Cut && m.pass >= 5);
    operation.moves.truncate(end.unwrap_or(count));
    (program, motion)
}
