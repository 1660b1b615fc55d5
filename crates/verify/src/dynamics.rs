//! Feed that the machine reaches: the fastest run through the blocks of an operation within the speed and the
//! acceleration of every axis, as with a control with look-ahead.
//!
//! A block is divided into cells in which the joints are parabolas of the programmed time tau, the time that follows
//! from feed and axis speeds. The run is y(tau) = (dtau/dt)^2, at most 1. With the derivatives q' and q'' by tau, the
//! axis speed is q' sqrt(y) and its acceleration is q'' y + q' y'/2. Every cell satisfies |q'| sqrt(y) <= speed and
//! |q''| y + |q'| |y'|/2 <= acceleration. The time is therefore that of a feasible run and never below the true
//! minimum. A forward and a backward pass find y; within a cell, phases of rising, constant and falling speed have a
//! closed form.
//!
//! At the end of a block the direction jumps. The control rounds the corner with the acceleration of its slowest axis
//! in a time T, and deviates from it by |jump of velocity| T / 8. The speed at the corner is limited: neither tip nor
//! flutes deviate by more than the chord tolerance, which the posts give to the control, and T fits between the middles
//! of both blocks. The part of a jump that both ends of a block share is curvature divided into chords; this part
//! counts as q'' of the block. The program of an operation begins and ends at rest.
//!
//! LinuxCNC plans differently, see [`five_axis::linuxcnc`]: for machines with LinuxCNC, times and deviations are those
//! of its planner.
//!
//! Where the axes have limits of jerk, the run is a slower one, see `jerk`, which also comes to rest before the last rapid
//! of several. The time without these limits is kept as a
//! lower bound.

mod active;
mod by_linuxcnc;
mod jerk;

pub use active::{ActiveLimit, MotionLimit, MoveLimit};

use super::proof::piece::{At, part_count};
use active::ActiveTimes;
use base::units::{Deg, Mm, Sec, Share};
use five_axis::control::Planning;
use five_axis::{Chain, Joints, Machine, between, linuxcnc};
use ir::motion::MotionOperation;
use ir::{JointMove, Motion, MoveKind, Program};
use nalgebra::{Point3, Vector3};
use serde::{Deserialize, Serialize};

/// Turn of a cell, radians: over this turn, the third derivative of a joint 300 mm from a rotary axis makes a deviation
/// of 0.1 um.
const MAX_CELL_TURN: f64 = std::f64::consts::PI / 90.0;

/// Most cells of a block; a block with a turn of 2000 deg needs no more.
const MAX_CELLS_PER_BLOCK: f64 = 1000.0;

/// A largest value and its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Peak<Q> {
    /// Value.
    pub value: Q,
    /// Move.
    pub at: Option<At>,
}

impl<Q: Copy + From<f64> + Into<f64>> Peak<Q> {
    /// No value yet.
    pub fn none() -> Self {
        Self { value: Q::from(0.0), at: None }
    }

    /// Takes a larger value. Keeps a value that is not a number, so that nothing hides it.
    pub fn raise(&mut self, value: f64, at: At) {
        if value > self.value.into() || value.is_nan() {
            *self = Self { value: Q::from(value), at: Some(at) };
        }
    }
}

/// Run of one operation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Run {
    /// Time of cutting, links and rapids within the limits of speed, acceleration and jerk.
    pub time: [Sec; 3],
    /// Time of the same without limits of jerk: no run of these blocks within the limits of acceleration is faster.
    pub within_accelerations: [Sec; 3],
    /// Time of the same without limits of acceleration.
    pub programmed: [Sec; 3],
    /// Time of cutting, links and rapids by active limit. The sum of all is `time`.
    pub limits: Vec<ActiveLimit>,
    /// The limit of each move that takes time, in their order; not part of the file.
    #[serde(skip)]
    pub of_moves: Vec<MoveLimit>,
    /// Time of each move of the operation; their sum is that of `time`. Not part of the file.
    #[serde(skip)]
    pub move_times: Vec<Sec>,
    /// Least share of the programmed feed that a cutting block reaches, and this block.
    pub slowest: Peak<Share>,
    /// Largest reached speed of X, Y, Z and the rotary axes, as a share of the limit.
    pub speed: [Peak<Share>; 5],
    /// Largest acceleration of the axes inside of blocks at the programmed feed, as a share of the limit: above 1 the
    /// control slows down.
    #[serde(rename = "asked")]
    pub required_acceleration: [Peak<Share>; 5],
    /// Largest jerk of the axes in the run, as a share of the limit; zero without a limit.
    pub jerk: [Peak<Share>; 5],
    /// Largest deviation of tip or flutes from the programmed corners at the reached speed. Rapids count neither
    /// here nor in the next figure.
    pub corners: Peak<Mm>,
    /// Largest deviation of the tool from the path between two positions that the control gives to its drives.
    pub cycle: Peak<Mm>,
    /// Total deviation of tip or flutes from the programmed motion: the larger corner of a block plus its cycle.
    pub contour: Deviation<Mm>,
    /// Deviation of the tool axis from the programmed motion where corners are rounded. Inside of a block the
    /// rotary axes are linear in the path of the tip, so that the cycle does not tilt the axis.
    pub orientation: Deviation<Deg>,
}

/// Largest deviation from the verified motion, with its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deviation<Q> {
    /// Total deviation.
    pub value: Q,
    /// Share of the deviation from rounding a corner.
    pub corner: Q,
    /// Move.
    pub at: Option<At>,
    /// Tip at the end of this move, part frame, mm; the origin where there is no deviation.
    pub tip: [f64; 3],
}

impl<Q: Copy + From<f64> + Into<f64>> Deviation<Q> {
    /// No deviation.
    pub fn none() -> Self {
        Self { value: Q::from(0.0), corner: Q::from(0.0), at: None, tip: [0.0; 3] }
    }

    /// The block with the largest deviation, the sum of its larger corner and its cycle.
    fn largest(blocks: &[BlockError], parts: impl Fn(&BlockError) -> [f64; 2]) -> Self {
        let mut most = Self::none();
        for (i, block) in blocks.iter().enumerate() {
            // The corner at the end of a block is the corner at the start of the next block.
            let end = blocks.get(i + 1).map_or(0.0, |next| parts(next)[0]);
            let [start, cycle] = parts(block);
            let corner = start.max(end);
            if corner + cycle > most.value.into() || (corner + cycle).is_nan() {
                let (value, corner) = (Q::from(corner + cycle), Q::from(corner));
                most = Self { value, corner, at: Some(block.at), ..Self::none() };
            }
        }
        most
    }

    /// With the tip at the end of the move.
    fn placed(self, machine: &Machine, moves: &[JointMove]) -> Self {
        let end = self.at.and_then(|at| moves.get(at.index as usize));
        let tip = end.map_or([0.0; 3], |m| machine.forward(&m.joints).tip.coords.into());
        Self { tip, ..self }
    }
}

/// Deviations where a corner is rounded.
#[derive(Clone, Copy, Default)]
pub(super) struct CornerError {
    /// Of tip or flutes, mm.
    flutes: f64,
    /// Of the tool axis, degrees.
    axis: f64,
}

/// Deviations of a block from the programmed motion.
struct BlockError {
    at: At,
    /// Rounding of the corner at the start.
    corner: CornerError,
    /// Deviation between two cycles of the control, mm.
    cycle: f64,
}

/// A part of a block in which the joints are parabolas.
#[derive(Clone, Copy)]
pub(super) struct MotionCell {
    block: u32,
    kind: MoveKind,
    /// Programmed time, s.
    width: f64,
    /// Programmed speed of the tip as a share of the feed of the job for this kind of move.
    feed: f64,
    /// Programmed speed of the tip as a share of the feed at which tool or spindle reach a limit of removal.
    removal: f64,
    /// Largest |q'| and |q''|, the latter with the curvature that is divided into chords.
    rate: [f64; 5],
    second: [f64; 5],
    /// Largest y.
    cap: f64,
    /// Ratio of dtau/dt after its start to dtau/dt before; zero where the axes must come to rest.
    ratio: f64,
    /// Largest y that the corner at its start allows before it, and deviation at this corner for y = 1.
    corner: f64,
    rounding: f64,
    /// Deviation of the tool axis at the corner for y = 1, radians.
    tilting: f64,
    /// Norm of q'' of the linear joints as a vector.
    sag: f64,
    /// Signed q'' with the curvature that is divided into chords.
    level: Joint5,
    /// The block goes on from its predecessor without a corner: both are chords of spline blocks.
    runs_on: bool,
    /// The run within the jerk starts from rest here ([`MotionOperation::rests_before`]).
    rests: bool,
    /// Jump of q' at the start of a block by the time of this block, and the share of such curvature in it.
    jump: Joint5,
    shared: Joint5,
    /// Jump of the velocity of tip and flutes at the corner for y = 1 before it, mm/s, and the time available for
    /// rounding.
    flutes: f64,
    rounding_time: f64,
}

/// A part of a cell in the run.
#[derive(Clone, Copy)]
pub(super) struct MovePart {
    cell: usize,
    /// Programmed time, and real time, s.
    width: f64,
    time: f64,
    /// y at its start, and largest y.
    from: f64,
    peak: f64,
    /// Largest acceleration and jerk of each axis.
    acceleration: Joint5,
    jerk: Joint5,
}

/// Limits of a run.
pub(super) struct RunLimits {
    speed: [f64; 5],
    acceleration: [f64; 5],
    jerk: [f64; 5],
    /// Process feed, link feed, and rapid speed of the tip, mm/s.
    feeds: [f64; 3],
    chord: f64,
    /// Length of the flutes, and of the whole tool to the gauge line, mm.
    height: f64,
    length: f64,
    chain: Chain,
}

pub(super) type Joint5 = [f64; 5];

/// Start and end of a block.
struct MotionBlock {
    time: f64,
    cells: std::ops::Range<usize>,
    /// q' at start and end.
    ends: [Joint5; 2],
    /// Velocity of the tip on the part, by tau.
    tip: Vector3<f64>,
    /// Jump of q' at its start, by the time of this block.
    jump: Joint5,
    /// q'' of the spline at its start, by the time of this block, where the block goes on without a corner.
    second: Option<Joint5>,
}

/// What a block has at its end, by the time of this block: the jump of q' there, and q'' of the spline where the next block
/// goes on without a corner.
struct BlockEnd {
    jump: Joint5,
    second: Option<Joint5>,
}

impl BlockEnd {
    const STOP: Self = Self { jump: [0.0; 5], second: None };
}

impl Run {
    /// Run of an operation without moves.
    fn none() -> Self {
        Self {
            time: [Sec(0.0); 3],
            within_accelerations: [Sec(0.0); 3],
            programmed: [Sec(0.0); 3],
            limits: Vec::new(),
            of_moves: Vec::new(),
            move_times: Vec::new(),
            slowest: Peak { value: Share(1.0), at: None },
            speed: [Peak::none(); 5],
            required_acceleration: [Peak::none(); 5],
            jerk: [Peak::none(); 5],
            corners: Peak::none(),
            cycle: Peak::none(),
            contour: Deviation::none(),
            orientation: Deviation::none(),
        }
    }

    /// Collects times, shares of the limits and deviations from all parts of a run; `cycle` is the cycle of the
    /// control, s. Returns the deviations of each block from the programmed motion.
    fn measure(
        &mut self,
        limits: &RunLimits,
        cells: &[MotionCell],
        parts: &[MovePart],
        operation: u32,
        cycle: f64,
    ) -> Vec<BlockError> {
        let (mut programmed, mut spent) = (0.0, 0.0);
        let mut errors: Vec<BlockError> = Vec::new();
        for (i, part) in parts.iter().enumerate() {
            let cell = &cells[part.cell];
            let at = At { operation, index: cell.block };
            let kind = number(cell.kind);
            self.time[kind] += Sec(part.time);
            self.programmed[kind] += Sec(part.width);
            self.raise_shares(limits, cell, part, at);
            let first = i.checked_sub(1).is_none_or(|b| parts[b].cell != part.cell);
            let corner = if first { rounded_corner(limits, cells, part) } else { CornerError::default() };
            self.corners.raise(corner.flutes, at);
            if errors.last().is_none_or(|e| e.at != at) {
                errors.push(BlockError { at, corner, cycle: 0.0 });
            }
            if cell.kind != MoveKind::Rapid {
                let away = cell.sag * part.peak * cycle * cycle / 8.0;
                self.cycle.raise(away, at);
                if let Some(error) = errors.last_mut() {
                    error.cycle = error.cycle.max(away);
                }
            }
            (programmed, spent) = (programmed + part.width, spent + part.time);
            if parts.get(i + 1).is_none_or(|next| cells[next.cell].block != cell.block) {
                if cell.kind == MoveKind::Cut && programmed < self.slowest.value.get() * spent {
                    self.slowest = Peak { value: Share(programmed / spent), at: Some(at) };
                }
                (programmed, spent) = (0.0, 0.0);
            }
        }
        errors
    }

    /// Collects the shares of the limits in a part of a cell.
    fn raise_shares(&mut self, limits: &RunLimits, cell: &MotionCell, part: &MovePart, at: At) {
        for k in 0..5 {
            self.speed[k].raise((part.peak.sqrt() * cell.rate[k] / limits.speed[k]).min(1.0), at);
            self.required_acceleration[k].raise(cell.second[k] / limits.acceleration[k], at);
            self.jerk[k].raise(part.jerk[k] / limits.jerk[k], at);
        }
    }
}

/// Index of a kind of moves among the times of a run.
fn number(kind: MoveKind) -> usize {
    match kind {
        MoveKind::Cut => 0,
        MoveKind::Link => 1,
        MoveKind::Rapid => 2,
    }
}

/// Deviation at the corner at the start of a cell; `part` is the first part of this cell. Next to a rapid the deviation
/// does not matter, since nothing is near.
fn rounded_corner(limits: &RunLimits, cells: &[MotionCell], part: &MovePart) -> CornerError {
    let cell = &cells[part.cell];
    let rapid = |c: &MotionCell| c.kind == MoveKind::Rapid;
    let behind = part.cell.checked_sub(1).and_then(|b| cells.get(b));
    if cell.ratio > 0.0 && !rapid(cell) && behind.is_some_and(|c| !rapid(c)) {
        jerk::rounding(limits, behind, cell, part.from / (cell.ratio * cell.ratio))
    } else {
        CornerError::default()
    }
}

/// Run of one operation of a motion. `removal`: for each move its feed as a share of the feed at which tool or spindle reach a
/// limit of removal; moves without an entry reach none.
pub fn run(program: &Program, motion: &Motion, operation: usize, removal: &[Share]) -> Run {
    let mut report = Run::none();
    let Some(moves) = motion.operations.get(operation) else { return report };
    let declared = &program.operations[moves.operation];
    let (machine, t) = (&program.machine, &program.tolerances);
    let limits = RunLimits {
        chain: machine.chain,
        speed: machine.speeds(),
        acceleration: machine.accelerations(),
        jerk: machine.jerks(),
        feeds: [declared.feed.get() / 60.0, declared.link_feed.get() / 60.0, machine.rapid],
        chord: if declared.kind.finishes() { t.chord.get() } else { t.chord_rough.get() },
        height: program.tools[declared.tool].solid.flute_length,
        length: program.tools[declared.tool].length(),
    };
    let cells = cells(machine, &limits, moves, removal);
    let trapezoids = trapezoids(&limits, &cells);
    for part in &trapezoids {
        report.within_accelerations[number(cells[part.cell].kind)] += Sec(part.time);
    }
    let limited = limits.jerk.iter().any(|j| j.is_finite());
    let parts = if limited { jerk::run(&limits, &cells) } else { trapezoids };
    let operation = u32::try_from(operation).unwrap_or(u32::MAX);
    let mut errors = report.measure(&limits, &cells, &parts, operation, machine.cycle);
    report.move_times = vec![Sec(0.0); moves.moves.len()];
    for part in &parts {
        if let Some(time) = report.move_times.get_mut(cells[part.cell].block as usize) {
            *time += Sec(part.time);
        }
    }
    let corner = |at: usize, rate: f64| jerk::corner_shares(&limits, &cells, at, rate * rate);
    (report.limits, report.of_moves) = ActiveTimes::of_run(&limits, &cells, &parts, corner).named(machine.names());
    // Runs with a limit of jerk use smaller parts of the blocks, which may permit a faster run.
    for (least, time) in report.within_accelerations.iter_mut().zip(report.time) {
        *least = Sec(least.get().min(time.get()));
    }
    if machine.planning == Planning::LinuxCnc {
        // The tolerance that the post writes for the whole program.
        // It limits the tip along the axes of its work frame.
        let machine = &machine.in_work_frame();
        let settings =
            linuxcnc::Settings { machine, tolerance: t.chord.get(), height: limits.height, length: limits.length };
        by_linuxcnc::replace(&settings, operation, &moves.moves, &limits, &cells, &mut report, &mut errors);
    }
    report.contour = Deviation::largest(&errors, |e| [e.corner.flutes, e.cycle]).placed(machine, &moves.moves);
    report.orientation = Deviation::largest(&errors, |e| [e.corner.axis, 0.0]).placed(machine, &moves.moves);
    report
}

/// Cells of all blocks with a time, and the corners between them.
fn cells(machine: &Machine, limits: &RunLimits, operation: &MotionOperation, removal: &[Share]) -> Vec<MotionCell> {
    let moves = &operation.moves;
    let mut cells = Vec::new();
    let mut last: Option<MotionBlock> = None;
    for (i, pair) in moves.windows(2).enumerate() {
        let m = &pair[1];
        if m.time > 0.0 {
            let index = u32::try_from(i + 1).unwrap_or(u32::MAX);
            let mut block = block(machine, limits.length, &pair[0].joints, m, index, &mut cells);
            let feed = block.tip.norm() / limits.feeds[number(m.kind)];
            let removal = removal.get(i + 1).map_or(0.0, |share| share.get());
            cells[block.cells.clone()].iter_mut().for_each(|cell| (cell.feed, cell.removal) = (feed, removal));
            join(limits, last.as_ref(), &mut block, operation.runs_on(i + 1), &mut cells);
            cells[block.cells.start].rests = operation.rests_before(i + 1);
            last = Some(block);
        }
    }
    if let Some(last) = &last {
        finish(limits, last, &BlockEnd::STOP, &mut cells);
    }
    cells
}

/// The run without limits of jerk: up to three parts a cell.
fn trapezoids(limits: &RunLimits, cells: &[MotionCell]) -> Vec<MovePart> {
    let nodes = passes(limits, cells);
    let mut parts = Vec::with_capacity(cells.len());
    for (i, (cell, [from, to])) in cells.iter().zip(nodes).enumerate() {
        let Phases { peak, slope, widths: [up, even, down] } = phases(limits, cell, from, to);
        let top = peak.sqrt();
        let over = |width: f64, y: f64| 2.0 * width / (y.sqrt() + top);
        let first = parts.len();
        for (width, time, slope) in
            [(up, over(up, from), slope), (even, even / top, 0.0), (down, over(down, to), slope)]
        {
            if width > 0.0 {
                let acceleration = std::array::from_fn(|k| cell.second[k] * peak + 0.5 * cell.rate[k] * slope);
                let from = if parts.len() == first { from } else { peak };
                parts.push(MovePart { cell: i, width, time, from, peak, acceleration, jerk: [0.0; 5] });
            }
        }
    }
    parts
}

/// Cells of the block of a move from joints on; the corner at its start is set later.
fn block(
    machine: &Machine,
    length: f64,
    from: &Joints,
    &JointMove { joints: ref to, kind, time, .. }: &JointMove,
    index: u32,
    cells: &mut Vec<MotionCell>,
) -> MotionBlock {
    let tips: [Point3<f64>; 2] = [machine.forward(from).tip, machine.forward(to).tip];
    let at = |t: f64| {
        let tip = tips[0] + (tips[1] - tips[0]) * t;
        machine.travelled(&machine.joints(&tip, between(from.rotary, to.rotary, t)), length)
    };
    let count = part_count(machine.turn(from.rotary, to.rotary) / MAX_CELL_TURN).min(MAX_CELLS_PER_BLOCK);
    let width = time / count;
    let first = cells.len();
    let mut ends = [[0.0; 5]; 2];
    let mut q0 = machine.travelled(from, length);
    for cell in 0..count as usize {
        let (middle, end) = (at((cell as f64 + 0.5) / count), at((cell as f64 + 1.0) / count));
        let each =
            |f: &dyn Fn(f64, f64, f64) -> f64| -> Joint5 { std::array::from_fn(|k| f(q0[k], middle[k], end[k])) };
        let start_rate = each(&|a, b, c| (4.0 * b - 3.0 * a - c) / width);
        let end_rate = each(&|a, b, c| (a - 4.0 * b + 3.0 * c) / width);
        let level = each(&|a, b, c| 4.0 * (a - 2.0 * b + c) / (width * width));
        let second = level.map(f64::abs);
        if cell == 0 {
            ends[0] = start_rate;
        }
        ends[1] = end_rate;
        cells.push(MotionCell {
            block: index,
            kind,
            width,
            feed: 0.0,
            removal: 0.0,
            rate: std::array::from_fn(|k| start_rate[k].abs().max(end_rate[k].abs())),
            second,
            cap: 1.0,
            ratio: 1.0,
            corner: f64::INFINITY,
            rounding: 0.0,
            tilting: 0.0,
            sag: Vector3::new(second[0], second[1], second[2]).norm(),
            level,
            runs_on: false,
            rests: false,
            jump: [0.0; 5],
            shared: [0.0; 5],
            flutes: 0.0,
            rounding_time: f64::INFINITY,
        });
        q0 = end;
    }
    MotionBlock { time, cells: first..cells.len(), ends, tip: (tips[1] - tips[0]) / time, jump: [0.0; 5], second: None }
}

/// Sets the corner between two blocks, and finishes the first block. Where the block runs on along a spline there is no
/// corner: the jump between the chords is the second derivative of the spline.
fn join(
    limits: &RunLimits,
    before: Option<&MotionBlock>,
    block: &mut MotionBlock,
    runs_on: bool,
    cells: &mut [MotionCell],
) {
    let at = block.cells.start;
    let Some(before) = before else {
        cells[at].ratio = 0.0;
        return;
    };
    let (v1, v2) = (&before.ends[1], &block.ends[0]);
    // The joint speed as a whole is constant over the corner; the norm weighs each joint by its acceleration.
    let size = |v: &Joint5| (0..5).map(|k| (v[k] / limits.acceleration[k]).powi(2)).sum::<f64>().sqrt();
    let ratio = size(v1) / size(v2);
    // A block without motion is a stop.
    if ratio <= 0.0 || !ratio.is_finite() {
        cells[at].ratio = 0.0;
        finish(limits, before, &BlockEnd::STOP, cells);
        return;
    }
    let jump: Joint5 = std::array::from_fn(|k| v2[k] * ratio - v1[k]);
    let turn = limits.chain.turn([0.0; 2], [jump[3], jump[4]]);
    let rounded = (0..5).map(|k| jump[k].abs() / limits.acceleration[k]).fold(0.0, f64::max);
    let flutes = (block.tip * ratio - before.tip).norm() + limits.height * turn;
    let cell = &mut cells[at];
    cell.ratio = ratio;
    block.jump = jump.map(|j| j / ratio);
    if runs_on {
        // From the middle of the chord before to the middle of this one.
        let way = 0.5 * (before.time + block.time / ratio);
        let second = jump.map(|j| j / way);
        (cell.runs_on, block.second) = (true, Some(second.map(|b| b / (ratio * ratio))));
        return finish(limits, before, &BlockEnd { jump, second: Some(second) }, cells);
    }
    cell.rounding = rounded * flutes / 8.0;
    cell.tilting = rounded * turn / 8.0;
    cell.flutes = flutes;
    cell.rounding_time = 0.5 * (before.time + block.time / ratio);
    if rounded > 0.0 {
        cell.corner = cell.rounding_time / rounded;
        cell.corner = cell.corner.min(limits.chord / cell.rounding);
    }
    cell.jump = block.jump;
    finish(limits, before, &BlockEnd { jump, second: None }, cells);
}

/// Curvature and largest y of a block.
fn finish(limits: &RunLimits, block: &MotionBlock, end: &BlockEnd, cells: &mut [MotionCell]) {
    // Along a spline q'' runs from its value at one end to that at the other.
    let second_at = [block.second.or(end.second), end.second.or(block.second)];
    for cell in &mut cells[block.cells.clone()] {
        if let [Some(start), Some(last)] = second_at {
            let most: Joint5 = std::array::from_fn(|k| start[k].abs().max(last[k].abs()));
            for k in 0..5 {
                cell.second[k] += most[k];
                cell.level[k] += 0.5 * (start[k] + last[k]);
            }
            cell.sag += Vector3::new(most[0], most[1], most[2]).norm();
        }
        for (k, (start, end)) in block.jump.iter().zip(&end.jump).enumerate() {
            // Both ends share curvature only where their jumps have the same sign.
            if second_at[0].is_none() {
                cell.second[k] += start.abs().min(end.abs()) / block.time;
                if start * end > 0.0 {
                    cell.shared[k] = start.signum() * start.abs().min(end.abs());
                    cell.level[k] += cell.shared[k] / block.time;
                }
            }
            if cell.rate[k] > 0.0 {
                cell.cap = cell.cap.min((limits.speed[k] / cell.rate[k]).powi(2));
            }
            if cell.second[k] > 0.0 {
                cell.cap = cell.cap.min(limits.acceleration[k] / cell.second[k]);
            }
        }
    }
}

/// Largest y that the run reaches from y over a part of a cell.
fn rise(limits: &RunLimits, cell: &MotionCell, y: f64, width: f64) -> f64 {
    (0..5)
        .filter(|k| cell.rate[*k] > 0.0)
        .map(|k| {
            let way = 2.0 * width / cell.rate[k];
            (y + way * limits.acceleration[k]) / (1.0 + way * cell.second[k])
        })
        .fold(cell.cap, f64::min)
}

/// y at start and end of every cell.
fn passes(limits: &RunLimits, cells: &[MotionCell]) -> Vec<[f64; 2]> {
    let mut nodes = vec![[0.0; 2]; cells.len()];
    let mut start = 0.0;
    for (i, cell) in cells.iter().enumerate() {
        let next = cells.get(i + 1).filter(|n| n.ratio > 0.0);
        let node = next.map_or(0.0, |n| n.corner.min(n.cap / (n.ratio * n.ratio)));
        let end = rise(limits, cell, start, cell.width).min(node);
        nodes[i] = [start, end];
        start = next.map_or(0.0, |n| end * n.ratio * n.ratio);
    }
    let mut end = 0.0;
    for (i, cell) in cells.iter().enumerate().rev() {
        let [before, after] = nodes[i];
        let after = after.min(end);
        let before = before.min(rise(limits, cell, after, cell.width));
        nodes[i] = [before, after];
        end = if cell.ratio > 0.0 { before / (cell.ratio * cell.ratio) } else { 0.0 };
    }
    nodes
}

/// The run in a cell between two values of y.
struct Phases {
    /// Largest y.
    peak: f64,
    /// Largest slope of y.
    slope: f64,
    /// Programmed time with rising, constant and falling y, s.
    widths: [f64; 3],
}

fn phases(limits: &RunLimits, cell: &MotionCell, from: f64, to: f64) -> Phases {
    // Both slopes intersect at the peak, unless the cap is lower.
    let peak = rise(limits, cell, 0.5 * (from + to), 0.5 * cell.width).max(from).max(to);
    let slope = (0..5)
        .filter(|k| cell.rate[*k] > 0.0)
        .map(|k| 2.0 * (limits.acceleration[k] - cell.second[k] * peak).max(0.0) / cell.rate[k])
        .fold(f64::INFINITY, f64::min);
    // The slope is zero only where y cannot change.
    let leg = |y: f64| if slope > 0.0 { (peak - y) / slope } else { 0.0 };
    let (mut up, mut down) = (leg(from), leg(to));
    let sum = up + down;
    if sum > cell.width {
        (up, down) = (up * cell.width / sum, down * cell.width / sum);
    }
    Phases { peak, slope, widths: [up, (cell.width - up - down).max(0.0), down] }
}
