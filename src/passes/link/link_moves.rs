//! `link-moves`: links between passes, and the joints of all moves.
//!
//! Before: passes that begin and end with the tool outside of the stock. After: the motion, one sequence of moves per
//! operation. The tool comes down along its axis to the start of a pass, runs the pass, leaves along its axis to the
//! clearance surface, and goes over it to the next pass (see [`super::clearance_surface`]). Where a finishing pass begins
//! near the end of its predecessor, a direct link replaces this (see [`super::direct_link`]). Passes with direct links
//! between them keep one branch and do not unwind. Where the travel does not allow this, the tool goes over the surface in
//! the middle of them. Branch and winding change only there.
//!
//! A tool that leaves along its own axis sweeps only space that it already occupied. After rest machining, passes begin
//! and end in space without stock, and nothing above the cutter is thinner than the cutter.

use super::branch::{self, OutOfTravel};
use super::clearance_surface::ClearanceSurface;
use super::direct_link::DirectLinks;
use crate::diag::{Aborted, Diag, codes::kinematics};
use crate::ir::motion::MotionOperation;
use crate::ir::{ClOperation, ClPass, ClPlan, ClPoint, JointMove, Motion, MoveKind, Operation};
use crate::kin::{Angles, Joints, Machine, RotaryPose};
use crate::passes::context::PassContext;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use std::ops::Range;

/// Time that the changes from feed to rapid and back cost, s: the axes nearly stop at both ends, and start and stop with the
/// jerk of usual axes. With a third of it, links round the edges of the small job go to rapid and save nothing.
const CHANGES: f64 = 0.3;

/// A move to a cutter location.
struct LinkMove {
    kind: MoveKind,
    to: ClPoint,
    /// Index of the pass that the move belongs to or leads to.
    pass: u32,
}

/// Passes with the direct links between neighbours, and the sphere for all other links.
struct Links<'a> {
    passes: &'a [ClPass],
    /// For each pass and its successor the places between them on the direct link, if there is one.
    short: Vec<Option<Vec<ClPoint>>>,
    surface: ClearanceSurface<'a>,
}

/// Makes the motion; feeds are those of the process.
///
/// # Errors
/// A pass that no branch and winding keep within the travel of the axes.
pub(crate) fn run(cx: &mut PassContext<'_>, cl: &ClPlan) -> Result<Motion, Aborted> {
    let mut motion = Motion::default();
    let mut failed = false;
    let mut at = [0.0; 2];
    let machine = &cx.program.machine;
    for planned in &cl.operations {
        let operation = &cx.program.operations[planned.operation];
        let length = cx.program.tools[operation.tool].length();
        let links = Links::new(cx, operation, &planned.passes);
        let (mut moves, mut misses) = (Vec::new(), Vec::new());
        // The last sequence is at the top of the stack.
        let mut open = links.runs();
        open.reverse();
        while let Some(run) = open.pop() {
            let linked = links.linked(run.clone());
            let places: Vec<ClPoint> = linked.iter().map(|m| m.to).collect();
            match branch::solve(machine, &places, length, at) {
                Ok(rotary) => {
                    append(machine, &links.surface, operation, (&linked, &rotary), &mut moves);
                    at = rotary.last().copied().unwrap_or(at);
                }
                Err(_) if run.len() > 1 => {
                    let middle = run.start + run.len() / 2;
                    open.extend([middle..run.end, run.start..middle]);
                }
                Err(miss) => misses.extend(linked.get(miss.index).map(|m| (m.to.tip, m.pass as usize, miss))),
            }
        }
        failed |= !misses.is_empty();
        report(cx, planned, &misses);
        add_stations(machine, length, &mut moves);
        let mut labels: Vec<String> = planned.passes.iter().map(|p| p.label.clone()).collect();
        if planned.passes.is_empty() {
            labels.push("no pass".to_owned());
            moves = aloft(machine, length, motion.operations.last(), at);
        }
        motion.operations.push(MotionOperation { operation: planned.operation, labels, moves });
    }
    if failed { Err(Aborted) } else { Ok(motion) }
}

impl<'a> Links<'a> {
    fn new(cx: &PassContext<'a>, operation: &Operation, passes: &'a [ClPass]) -> Self {
        let program = cx.program;
        let surface = ClearanceSurface::new(program, &program.tools[operation.tool].solid);
        let direct_links = DirectLinks::new(program, cx.obstacles, operation);
        let short = passes
            .par_windows(2)
            .map(|pair| {
                let (from, to) = pair[0].points.last().zip(pair[1].points.first())?;
                let finishing = || operation.kind.finishes().then(|| direct_links.between(from, to)).flatten();
                let link = pair[1].link.clone().or_else(finishing)?;
                // No direct link where the link over the clearance surface takes less time.
                let length = |points: &[ClPoint]| points.windows(2).map(|w| (w[1].tip - w[0].tip).norm()).sum::<f64>();
                let feed = operation.link_feed.get();
                let path: Vec<ClPoint> = [*from].into_iter().chain(link.iter().copied()).chain([*to]).collect();
                (length(&path) / (feed / 60.0) <= surface.time(from, to, feed) + CHANGES).then_some(link)
            })
            .collect();
        Self { passes, short, surface }
    }

    /// Sequences of passes with direct links between them; passes without points are left out.
    fn runs(&self) -> Vec<Range<usize>> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        for index in (0..self.passes.len()).filter(|i| !self.passes[*i].points.is_empty()) {
            match runs.last_mut() {
                Some(run) if run.end == index && self.short[index - 1].is_some() => run.end = index + 1,
                _ => runs.push(index..index + 1),
            }
        }
        runs
    }

    /// The moves of passes with direct links between them, from the clearance surface and back to it.
    fn linked(&self, run: Range<usize>) -> Vec<LinkMove> {
        let mut moves: Vec<LinkMove> = Vec::new();
        for index in run.clone() {
            let points = &self.passes[index].points;
            let (Some(first), Some(last)) = (points.first(), points.last()) else { continue };
            let pass = u32::try_from(index).unwrap_or(u32::MAX);
            let mut add = |kind: MoveKind, to: ClPoint| moves.push(LinkMove { kind, to, pass });
            let start = ClPoint { contact: None, ..*first };
            match index.checked_sub(1).and_then(|before| self.short[before].as_ref()) {
                Some(over) if index > run.start => {
                    let before = self.passes[index - 1].points.last();
                    let stays = before.is_some_and(|p| p.tip == start.tip && p.axis == start.axis);
                    for to in over.iter().copied().chain((!stays).then_some(start)) {
                        add(MoveKind::Link, to);
                    }
                }
                _ => {
                    let over = self.surface.lifted(first);
                    add(MoveKind::Rapid, over);
                    if over.tip != first.tip {
                        add(MoveKind::Link, start);
                    }
                }
            }
            let air = &self.passes[index].air;
            for (i, p) in points.iter().enumerate().skip(1) {
                add(if air.binary_search(&i).is_ok() { MoveKind::Link } else { MoveKind::Cut }, *p);
            }
            let out = self.surface.lifted(last);
            if index + 1 == run.end && out.tip != last.tip {
                add(MoveKind::Link, out);
            }
        }
        moves
    }
}

/// Adds the stations at retract height in front of the first and behind the last move.
fn add_stations(machine: &Machine, length: f64, moves: &mut Vec<JointMove>) {
    let (Some(first), Some(last)) = (moves.first().copied(), moves.last().copied()) else { return };
    let over = |m: JointMove| {
        let mut joints = m.joints;
        joints.xyz.z = machine.retract - length;
        JointMove { kind: MoveKind::Rapid, joints, feed: None, time: 0.0, pass: m.pass, stop: false }
    };
    moves.insert(0, over(first));
    moves.push(over(last));
}

/// Way down of an operation that cuts nothing, mm: a reader of NC text knows an operation by its moves.
const DOWN: f64 = 1.0;

/// The moves of an operation that cuts nothing: both stations, where the operation before ended, with a short way down
/// between them.
fn aloft(machine: &Machine, length: f64, before: Option<&MotionOperation>, rotary: Angles) -> Vec<JointMove> {
    let before = before.and_then(|o| o.moves.last()).map(|m| m.joints.xyz);
    let [x, y] = [0, 1].map(|k: usize| {
        let axis = &machine.linear[k];
        before.map_or_else(|| 0.0_f64.clamp(axis.min, axis.max), |xyz| xyz[k])
    });
    let at = |z: f64| {
        let joints = Joints { xyz: Vector3::new(x, y, z), rotary };
        JointMove { kind: MoveKind::Rapid, joints, feed: None, time: 0.0, pass: 0, stop: false }
    };
    let height = machine.retract - length;
    vec![at(height), at(height - DOWN), at(height)]
}

/// Appends the moves of a sequence, preceded by the link over the clearance surface.
fn append(
    machine: &Machine,
    surface: &ClearanceSurface<'_>,
    operation: &Operation,
    (run, rotary): (&[LinkMove], &[Angles]),
    out: &mut Vec<JointMove>,
) {
    let (Some(first), Some(start)) = (run.first(), rotary.first().copied()) else { return };
    let push = |m: &LinkMove, tip: &Point3<f64>, rotary: Angles, out: &mut Vec<JointMove>| {
        out.push(JointMove {
            kind: m.kind,
            joints: machine.joints(tip, rotary),
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
        for place in surface.way_round(&from, &RotaryPose { tip: first.to.tip, rotary: start }) {
            push(first, &place.tip, place.rotary, out);
        }
    }
    for (m, angles) in run.iter().zip(rotary) {
        push(m, &m.to.tip, *angles, out);
    }
}

/// Reports the pass of an operation that goes farthest out of the travel.
fn report(cx: &mut PassContext<'_>, operation: &ClOperation, misses: &[(Point3<f64>, usize, OutOfTravel)]) {
    let beyond = |miss: &OutOfTravel| (miss.range[0] - miss.value).max(miss.value - miss.range[1]);
    let farthest = misses.iter().reduce(|a, b| if beyond(&b.2) > beyond(&a.2) { b } else { a });
    let Some((tip, pass, miss)) = farthest else { return };
    let declared = &cx.program.operations[operation.operation];
    let names = cx.program.machine.names();
    let sector = |pass: usize| operation.passes.get(pass).map(|p| p.sector);
    let missed: Vec<u32> = misses.iter().filter_map(|m| sector(m.1)).collect();
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
    .place(operation.passes.get(*pass).map_or(String::new(), |p| p.label.clone()), *tip)
    .note(format!("both branches of {} and all windings of {} were tried", names[3], names[4]))
    .note(format!(
        "{} of {} passes leave the travel, and this one goes farthest; {within}",
        misses.len(),
        operation.passes.len()
    ))
    .help("use a machine with more travel, or mount the part at another position of the table");
    cx.sink.push(diag);
}
