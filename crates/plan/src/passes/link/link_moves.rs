//! `link-moves`: links between passes, and the joints of all moves.
//!
//! Before: passes that begin and end with the tool outside of the stock. After: the motion, one sequence of moves per
//! operation. The tool comes down along its axis to the start of a pass, runs the pass, leaves along its axis to the
//! clearance surface, and goes over it to the next pass (see [`super::clearance_surface`]). Where a finishing pass
//! begins near the end of its predecessor, a direct link replaces this (see [`super::direct_link`]). Passes with
//! direct links between them keep one branch and do not unwind; branch and winding of all sequences of an operation
//! are chosen together. Where the travel does not allow this, the tool goes over the surface in the middle of them.
//! Branch and winding change only there. Where the travel does not allow a single pass, the tool leaves within it
//! along its axis to the surface, turns, and comes back to the same place ([`super::pieces`]).
//!
//! A tool that leaves along its own axis sweeps only space that it already occupied. After rest machining, passes begin
//! and end in space without stock, and nothing above the cutter is thinner than the cutter.

use super::branch::{self, OnBranch, OutOfTravel, Winding};
use super::clearance_surface::ClearanceSurface;
use super::direct_link::DirectLinks;
use super::pieces::{self, LinkMove, Solved};
use crate::passes::context::PassContext;
use base::units::trim;
use diagnostics::{Aborted, Diag, codes::kinematics};
use five_axis::{Angles, Joints, Machine, RotaryPose};
use ir::motion::MotionOperation;
use ir::{ClOperation, ClPass, ClPlan, ClPoint, JointMove, Motion, MoveKind, Operation, Program};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use std::ops::Range;

/// Time that the changes from feed to rapid and back cost, s: the axes nearly stop at both ends, and start and stop with the
/// jerk of usual axes. With a third of it, links round the edges of the small job go to rapid and save nothing.
const FEED_CHANGES_S: f64 = 0.3;

/// Passes with the direct links between neighbours, and the sphere for all other links.
struct Links<'a> {
    passes: &'a [ClPass],
    /// For each pass and its successor the places between them on the direct link, if there is one.
    direct: Vec<Option<Vec<ClPoint>>>,
    surface: ClearanceSurface<'a>,
}

/// Makes the motion; feeds are those of the process.
///
/// # Errors
/// A pass that no branch and winding keep within the travel of the axes.
pub(crate) fn run(cx: &mut PassContext<'_>, cl: &ClPlan) -> Result<Motion, Aborted> {
    let mut motion = Motion::default();
    let mut failed = false;
    let machine = &cx.program.machine;
    let mut at = machine.rotary.each_ref().map(|axis| 0.0_f64.clamp(axis.min, axis.max));
    for planned in &cl.operations {
        cx.go_on()?;
        let operation = &cx.program.operations[planned.operation];
        let length = cx.program.tools[operation.tool].length();
        let links = Links::new(cx, operation, &planned.passes);
        let (mut moves, mut faults) = (Vec::new(), Faults::default());
        // Branches count their windings from where the operation begins.
        let start = at;
        cx.go_on()?;
        for part in links.parts(cx, length, start) {
            cx.go_on()?;
            let solved = match part {
                OperationPart::Runs(runs) => links.over(machine, &runs, start, at),
                OperationPart::OutOfTravel(missed) => {
                    let pieces = links.in_pieces(machine, missed.pass, length, at);
                    let turns = pieces.iter().flatten().skip(1).filter_map(|piece| piece.moves.get(1));
                    faults.turns.extend(turns.map(|m| (m.pass, m.to.tip)));
                    if pieces.is_none() {
                        faults.misses.push(missed);
                    }
                    pieces.unwrap_or_default()
                }
            };
            for piece in &solved {
                append(machine, &links.surface, operation, piece, &mut moves);
                at = piece.rotary.last().copied().unwrap_or(at);
            }
        }
        failed |= !faults.misses.is_empty();
        report(cx, planned, &faults.misses);
        report_turns(cx, planned, &faults.turns);
        rise(machine, &links.surface, &mut moves);
        add_stations(machine, length, &mut moves);
        let mut labels: Vec<String> = planned.passes.iter().map(|p| p.label.clone()).collect();
        if planned.passes.is_empty() {
            labels.push("no pass".to_owned());
            moves = aloft(cx.program, length, motion.operations.last(), at);
        }
        motion.operations.push(MotionOperation { operation: planned.operation, labels, moves, splines: Vec::new() });
    }
    if failed { Err(Aborted) } else { Ok(motion) }
}

/// A part of an operation.
enum OperationPart {
    /// Sequences of passes, each with the branches on which it stays within the travel.
    Runs(Vec<(Range<usize>, Vec<OnBranch>)>),
    /// A pass that no branch and winding keep within the travel in one go.
    OutOfTravel(MissedPass),
}

/// A pass that leaves the travel: its index, the place, and the axis that leaves its travel there.
pub(super) struct MissedPass {
    pub(super) pass: usize,
    pub(super) place: Point3<f64>,
    pub(super) miss: OutOfTravel,
}

/// What an operation cannot do in one go, or not at all.
#[derive(Default)]
struct Faults {
    /// Passes with places that no branch and winding reach.
    misses: Vec<MissedPass>,
    /// Passes within which the tool turns outside of the stock, with the place.
    turns: Vec<(u32, Point3<f64>)>,
}

impl<'a> Links<'a> {
    fn new(cx: &PassContext<'a>, operation: &Operation, passes: &'a [ClPass]) -> Self {
        let program = cx.program;
        let surface = ClearanceSurface::new(program, &program.tools[operation.tool].solid);
        let direct_links = DirectLinks::new(program, cx.obstacles, operation);
        let progress = cx.progress;
        let direct = passes
            .par_windows(2)
            .map(|pair| {
                // The caller ends a cancelled run.
                if progress.is_cancelled() {
                    return None;
                }
                let (from, to) = pair[0].points.last().zip(pair[1].points.first())?;
                let finishing = || operation.kind.finishes().then(|| direct_links.between(from, to)).flatten();
                let link = pair[1].link.clone().or_else(finishing)?;
                // No direct link where the link over the clearance surface takes less time.
                let length = |points: &[ClPoint]| points.windows(2).map(|w| (w[1].tip - w[0].tip).norm()).sum::<f64>();
                let feed = operation.link_feed.get();
                let path: Vec<ClPoint> = [*from].into_iter().chain(link.iter().copied()).chain([*to]).collect();
                (length(&path) / (feed / 60.0) <= surface.time(from, to, feed) + FEED_CHANGES_S).then_some(link)
            })
            .collect();
        Self { passes, direct, surface }
    }

    /// Sequences of passes with direct links between them; passes without points are left out.
    fn runs(&self) -> Vec<Range<usize>> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        for index in (0..self.passes.len()).filter(|i| !self.passes[*i].points.is_empty()) {
            match runs.last_mut() {
                Some(run) if run.end == index && self.direct[index - 1].is_some() => run.end = index + 1,
                _ => runs.push(index..index + 1),
            }
        }
        runs
    }

    /// The operation as sequences that stay within the travel, for a tool of the given length (mm). Sequences that do not are halved.
    /// Of a cancelled run only the first ones.
    fn parts(&self, cx: &PassContext<'_>, length: f64, at: Angles) -> Vec<OperationPart> {
        let machine = &cx.program.machine;
        let mut parts = Vec::new();
        // The last sequence is at the top of the stack.
        let mut open = self.runs();
        open.reverse();
        while let Some(run) = open.pop().filter(|_| !cx.progress.is_cancelled()) {
            let linked = self.linked(run.clone());
            let places: Vec<ClPoint> = linked.iter().map(|m| m.to).collect();
            match (branch::on_branches(machine, &places, length, at), parts.last_mut()) {
                (Ok(found), Some(OperationPart::Runs(runs))) => runs.push((run, found)),
                (Ok(found), _) => parts.push(OperationPart::Runs(vec![(run, found)])),
                (Err(_), _) if run.len() > 1 => {
                    let middle = run.start + run.len() / 2;
                    open.extend([middle..run.end, run.start..middle]);
                }
                (Err(miss), _) => {
                    let place = places.get(miss.index).map_or(Point3::origin(), |p| p.tip);
                    parts.push(OperationPart::OutOfTravel(MissedPass { pass: run.start, place, miss }));
                }
            }
        }
        parts
    }

    /// Sequences of passes on the branches and windings between which the rotary axes turn least. `start` is where the operation begins,
    /// `at` where the first of these sequences begins.
    fn over(
        &self,
        machine: &Machine,
        runs: &[(Range<usize>, Vec<OnBranch>)],
        start: Angles,
        at: Angles,
    ) -> Vec<Solved> {
        let found: Vec<&[OnBranch]> = runs.iter().map(|(_, found)| found.as_slice()).collect();
        let windings = branch::shortest(machine, &found, at);
        let solved = |((run, _), winding): (&(Range<usize>, Vec<OnBranch>), Winding)| {
            let moves = self.linked(run.clone());
            let places: Vec<ClPoint> = moves.iter().map(|m| m.to).collect();
            Solved { rotary: winding.angles(machine, &places, start), moves }
        };
        runs.iter().zip(windings).map(solved).collect()
    }

    /// The moves of passes with direct links between them, from the clearance surface and back to it.
    fn linked(&self, run: Range<usize>) -> Vec<LinkMove> {
        let mut moves: Vec<LinkMove> = Vec::new();
        for index in run.clone() {
            let points = &self.passes[index].points;
            let (Some(first), Some(last)) = (points.first(), points.last()) else { continue };
            let pass = u32::try_from(index).unwrap_or(u32::MAX);
            let start = ClPoint { contact: None, ..*first };
            match index.checked_sub(1).and_then(|before| self.direct[before].as_ref()) {
                Some(over) if index > run.start => {
                    let before = self.passes[index - 1].points.last();
                    let same_place = before.is_some_and(|p| p.tip == start.tip && p.axis == start.axis);
                    let places = over.iter().copied().chain((!same_place).then_some(start));
                    moves.extend(places.map(|to| LinkMove { kind: MoveKind::Link, to, pass }));
                }
                _ => pieces::approach(&self.surface, first, pass, &mut moves),
            }
            pieces::along(&self.passes[index], pass, 1..=points.len() - 1, &mut moves);
            if index + 1 == run.end {
                pieces::retract(&self.surface, last, pass, &mut moves);
            }
        }
        moves
    }

    /// The pieces of a pass that does not stay within the travel in one go.
    fn in_pieces(&self, machine: &Machine, index: usize, length: f64, at: Angles) -> Option<Vec<Solved>> {
        let pass = u32::try_from(index).unwrap_or(u32::MAX);
        pieces::pieces(machine, &self.surface, self.passes.get(index)?, pass, length, at)
    }
}

/// With a head that tilts, Z moves the tool across its axis. The tool goes out first until it is clear of the blank up to the
/// retract height, and comes back on the same path.
fn rise(machine: &Machine, surface: &ClearanceSurface<'_>, moves: &mut Vec<JointMove>) {
    if !machine.chain.has_head() {
        return;
    }
    let (Some(first), Some(last)) = (moves.first().copied(), moves.last().copied()) else { return };
    let over = |m: &JointMove| {
        let from = RotaryPose { tip: machine.forward(&m.joints).tip, rotary: m.joints.rotary };
        let places = surface.path_to_rise(&from).into_iter().map(|place| machine.joints(&place.tip, place.rotary));
        let pass = m.pass;
        let rapid = move |joints| JointMove { kind: MoveKind::Rapid, joints, feed: None, time: 0.0, pass, stop: false };
        places.map(rapid).collect::<Vec<_>>()
    };
    let (mut before, behind) = (over(&first), over(&last));
    before.reverse();
    moves.splice(0..0, before);
    moves.extend(behind);
}

/// Adds the stations at retract height in front of the first and behind the last move.
fn add_stations(machine: &Machine, length: f64, moves: &mut Vec<JointMove>) {
    let (Some(first), Some(last)) = (moves.first().copied(), moves.last().copied()) else { return };
    let over = |m: JointMove| {
        let joints = machine.at_height(&m.joints, machine.retract, length);
        JointMove { kind: MoveKind::Rapid, joints, feed: None, time: 0.0, pass: m.pass, stop: false }
    };
    moves.insert(0, over(first));
    moves.push(over(last));
}

/// Height of the motion down of an operation that cuts nothing, mm: a reader of NC text knows an operation by its moves.
const DOWN_MM: f64 = 1.0;

/// The moves of an operation that cuts nothing: both stations, where the operation before ended, with a short motion
/// down between them.
fn aloft(program: &Program, length: f64, before: Option<&MotionOperation>, rotary: Angles) -> Vec<JointMove> {
    let machine = &program.machine;
    let before = before.and_then(|o| {
        let length = program.tools[program.operations[o.operation].tool].length();
        o.moves.last().map(|m| machine.positions(&m.joints, length))
    });
    let [x, y] = [0, 1].map(|k: usize| {
        let axis = &machine.linear[k];
        before.map_or_else(|| 0.0_f64.clamp(axis.min, axis.max), |positions| positions[k])
    });
    let at = |z: f64| {
        let joints = machine.joints_at(&Vector3::new(x, y, z), rotary, length);
        JointMove { kind: MoveKind::Rapid, joints, feed: None, time: 0.0, pass: 0, stop: false }
    };
    vec![at(machine.retract), at(machine.retract - DOWN_MM), at(machine.retract)]
}

/// Whether two places of the axes differ by no more than rounding, mm and rad. Two passes along one axis come to the same place of the
/// clearance surface from different heights: a rapid between them would have a time of rounding, and speeds without bound.
fn stands_at(a: &Joints, b: &Joints) -> bool {
    /// Far below the step of any word.
    const ROUNDING: f64 = 1e-9;
    a.all().iter().zip(b.all()).all(|(a, b)| (a - b).abs() < ROUNDING)
}

/// Appends the moves of a sequence, preceded by the link over the clearance surface.
fn append(
    machine: &Machine,
    surface: &ClearanceSurface<'_>,
    operation: &Operation,
    Solved { moves: run, rotary }: &Solved,
    out: &mut Vec<JointMove>,
) {
    let (Some(first), Some(start)) = (run.first(), rotary.first().copied()) else { return };
    let push = |m: &LinkMove, tip: &Point3<f64>, rotary: Angles, out: &mut Vec<JointMove>| {
        let joints = machine.joints(tip, rotary);
        if m.kind == MoveKind::Rapid && out.last().is_some_and(|last| stands_at(&last.joints, &joints)) {
            return;
        }
        out.push(JointMove {
            kind: m.kind,
            joints,
            feed: match m.kind {
                MoveKind::Rapid => None,
                MoveKind::Link => Some(operation.link_feed.get()),
                MoveKind::Cut => Some(operation.feed.get()),
            },
            time: 0.0,
            pass: m.pass,
            stop: false,
        });
    };
    if let Some(last) = out.last().map(|m| m.joints).filter(|_| first.kind == MoveKind::Rapid) {
        let from = RotaryPose { tip: machine.forward(&last).tip, rotary: last.rotary };
        for place in surface.path_over(&from, &RotaryPose { tip: first.to.tip, rotary: start }) {
            push(first, &place.tip, place.rotary, out);
        }
    }
    for (m, angles) in run.iter().zip(rotary) {
        push(m, &m.to.tip, *angles, out);
    }
}

/// Reports the pass of an operation that goes farthest out of the travel.
pub(super) fn report(cx: &mut PassContext<'_>, operation: &ClOperation, misses: &[MissedPass]) {
    let beyond = |miss: &OutOfTravel| (miss.linear, (miss.range[0] - miss.value).max(miss.value - miss.range[1]));
    let farthest = misses.iter().reduce(|a, b| if beyond(&b.miss) > beyond(&a.miss) { b } else { a });
    let Some(MissedPass { pass, place, miss }) = farthest else { return };
    let declared = &cx.program.operations[operation.operation];
    let names = cx.program.machine.names();
    let sector = |pass: usize| operation.passes.get(pass).map(|p| p.sector);
    let missed: Vec<u32> = misses.iter().filter_map(|m| sector(m.pass)).collect();
    let possible: Vec<String> =
        declared.sectors.iter().filter(|s| !missed.contains(s)).map(|s| (s + 1).to_string()).collect();
    let within = match possible.as_slice() {
        [] => "in no sector all of them stay within it".to_owned(),
        sectors => format!("all of them stay within it in the sectors {}", sectors.join(", ")),
    };
    let diag = Diag::error(
        kinematics::OUT_OF_TRAVEL,
        format!(
            "`{}` needs {} = {:.3} {unit}; the travel of this axis of {} is {:.3} to {:.3} {unit}",
            declared.name,
            miss.axis,
            miss.value,
            cx.program.machine.name,
            miss.range[0],
            miss.range[1],
            unit = miss.unit
        ),
    )
    .label(declared.span, "in this operation")
    .place(operation.passes.get(*pass).map_or(String::new(), |p| p.label.clone()), *place)
    .note(format!("both branches of {} and all windings of {} were tried", names[3], names[4]))
    .note(format!(
        "{} of {} passes leave the travel, and this one goes farthest; {within}",
        misses.len(),
        operation.passes.len()
    ))
    .help(format!(
        "use a machine on which {} travels to {:.3} {}, or mount the part at another position{}",
        miss.axis,
        miss.value,
        miss.unit,
        if cx.program.machine.chain.has_head() { "" } else { " of the table" }
    ));
    let other = cx.program.machine.reached_from_below().map(|v| [v.x, v.y, v.z].map(|x| trim(x, 4)));
    cx.sink.push(match other {
        Some([x, y, z]) => diag.note(format!(
            "the tool reaches this part along its axis from below alone: look at the `sense` of {} and {}; a part that is \
             clamped the other way has `[part] direction = [{x}, {y}, {z}]`",
            names[3], names[4]
        )),
        None => diag,
    });
}

/// Reports the passes within which the tool leaves the part to turn: each place of a finished surface keeps a mark.
fn report_turns(cx: &mut PassContext<'_>, operation: &ClOperation, turns: &[(u32, Point3<f64>)]) {
    let Some((pass, tip)) = turns.first() else { return };
    let declared = &cx.program.operations[operation.operation];
    let [.., first, second] = cx.program.machine.names();
    let times = if turns.len() == 1 { "once".to_owned() } else { format!("{} times", turns.len()) };
    let text = format!(
        "`{}` leaves the part {times} within passes, to turn {first} and {second} where their travel ends",
        declared.name
    );
    let diag = if declared.kind.finishes() {
        Diag::warning(kinematics::TURNS_IN_PASS, text)
            .note("the tool comes back to the same place, and may leave a mark there")
    } else {
        Diag::remark(kinematics::TURNS_IN_PASS, text)
    };
    let label = operation.passes.get(*pass as usize).map_or(String::new(), |p| p.label.clone());
    cx.sink.push(
        diag.label(declared.span, "in this operation")
            .place(label, *tip)
            .help("use a machine with more travel of these axes, or cut in sectors that need no such turn"),
    );
}
