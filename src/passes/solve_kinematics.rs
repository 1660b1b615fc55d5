//! `solve-kinematics`: joint positions, branch and winding of the rotary axes.
//!
//! Before: tip and axis of every move. After: joints. A pass with its approach and retract keeps one branch and runs
//! without unwinding; branch and winding change only on the way over the clearance sphere, which is put in here since it
//! depends on both.

use super::link_moves::ClearanceSphere;
use super::pipeline::PassContext;
use crate::diag::{Aborted, Diag, codes::kinematics};
use crate::ir::motion::MotionOperation;
use crate::ir::{ClMove, ClOperation, ClPlan, JointMove, Motion, MoveKind};
use crate::kin::{Angles, Machine, RotaryPose};
use nalgebra::Point3;
use std::f64::consts::TAU;

/// Makes the motion.
///
/// # Errors
/// A pass that no branch and winding keep within the travel of the axes.
pub(super) fn run(cx: &mut PassContext<'_>, cl: &ClPlan) -> Result<Motion, Aborted> {
    let mut motion = Motion::default();
    let mut failed = false;
    let mut at = [0.0; 2];
    for operation in &cl.operations {
        let mut solved = MotionOperation {
            operation: operation.operation,
            labels: operation.passes.iter().map(|p| p.label.clone()).collect(),
            moves: Vec::with_capacity(operation.moves.len()),
        };
        let tool = &cx.program.tools[cx.program.operations[operation.operation].tool];
        let sphere = ClearanceSphere::new(cx.program, &tool.solid);
        for run in contiguous(&operation.moves) {
            match solve_run(&cx.program.machine, run, tool.length(), at) {
                Ok(rotary) => {
                    append(&cx.program.machine, &sphere, run, &rotary, &mut solved.moves);
                    at = rotary.last().copied().unwrap_or(at);
                }
                Err(reason) => {
                    failed = true;
                    report(cx, operation, run, &reason);
                }
            }
        }
        add_stations(&cx.program.machine, tool.length(), &mut solved.moves);
        motion.operations.push(solved);
    }
    if failed { Err(Aborted) } else { Ok(motion) }
}

/// Puts the stations at retract height before the first and behind the last move.
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

/// Splits the moves into runs: each from a rapid up to the next.
fn contiguous(moves: &[ClMove]) -> Vec<&[ClMove]> {
    let mut runs = Vec::new();
    let mut start = 0;
    for i in 1..=moves.len() {
        let begins = i < moves.len() && moves[i].kind == MoveKind::Rapid && moves[i - 1].kind != MoveKind::Rapid;
        if begins || i == moves.len() {
            runs.push(&moves[start..i]);
            start = i;
        }
    }
    runs
}

/// Why no joints were found.
struct OutOfTravel {
    index: usize,
    axis: String,
    value: f64,
    range: [f64; 2],
    unit: &'static str,
}

/// True when some branch and winding keep a run within the travel of all axes, with a tool of a length (mm).
pub(super) fn within_travel(machine: &Machine, run: &[ClMove], length: f64) -> bool {
    solve_run(machine, run, length, [0.0; 2]).is_ok()
}

/// Rotary angles of a run.
fn solve_run(machine: &Machine, run: &[ClMove], length: f64, at: Angles) -> Result<Vec<Angles>, OutOfTravel> {
    let mut best: Option<(f64, Vec<Angles>)> = None;
    let [_, last] = &machine.rotary;
    let mut nearest_miss: Option<OutOfTravel> = None;
    for branch in 0..2 {
        let mut angles: Vec<Angles> = Vec::with_capacity(run.len());
        for m in run {
            let before = angles.last().map_or(at[1], |x| x[1]);
            angles.push(machine.chain.unwound(&m.to.axis, branch, before));
        }
        let ends = angles.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x[1]), h.max(x[1])));
        // Whole turns that bring the run into the travel, those near the middle of the travel included.
        let middle = 0.5 * (last.min.max(-1e3) + last.max.min(1e3));
        let shift = TAU * ((middle - 0.5 * (ends.0 + ends.1)) / TAU).round();
        for turns in [0.0, shift, shift - TAU, shift + TAU] {
            let moved: Vec<Angles> = angles.iter().map(|[first, second]| [*first, second + turns]).collect();
            if let Some(miss) = out_of_travel(machine, run, length, &moved) {
                if nearest_miss.as_ref().is_none_or(|n| miss.index > n.index) {
                    nearest_miss = Some(miss);
                }
                continue;
            }
            let time = |k: usize| (moved[0][k] - at[k]).abs() / machine.rotary[k].speed;
            let cost = time(1) + time(0);
            if best.as_ref().is_none_or(|b| cost < b.0) {
                best = Some((cost, moved));
            }
        }
    }
    match (best, nearest_miss) {
        (Some((_, angles)), _) => Ok(angles),
        (None, Some(miss)) => Err(miss),
        (None, None) => Ok(Vec::new()),
    }
}

/// The first place where an axis leaves its travel: the rotary axes are asked first.
fn out_of_travel(machine: &Machine, run: &[ClMove], length: f64, angles: &[Angles]) -> Option<OutOfTravel> {
    let travel = machine.travel();
    run.iter().zip(angles).enumerate().find_map(|(index, (m, rotary))| {
        let positions = machine.positions(&machine.joints(&m.to.tip, *rotary), length);
        let k = [3, 4, 0, 1, 2].into_iter().find(|k| !(travel[*k][0]..=travel[*k][1]).contains(&positions[*k]))?;
        let (unit, scale) = if k < 3 { ("mm", 1.0) } else { ("deg", 1.0_f64.to_degrees()) };
        let axis = machine.names()[k].to_owned();
        Some(OutOfTravel { index, axis, value: positions[k] * scale, range: travel[k].map(|x| x * scale), unit })
    })
}

/// Appends the moves of a run, and in front of them the way over the sphere.
fn append(machine: &Machine, sphere: &ClearanceSphere, run: &[ClMove], rotary: &[Angles], out: &mut Vec<JointMove>) {
    let (Some(first), Some(start)) = (run.first(), rotary.first().copied()) else { return };
    let push = |m: &ClMove, tip: &Point3<f64>, rotary: Angles, out: &mut Vec<JointMove>| {
        out.push(JointMove {
            kind: m.kind,
            joints: machine.joints(tip, rotary),
            feed: m.feed,
            time: 0.0,
            pass: m.pass,
            stop: false,
        });
    };
    if let Some(last) = out.last().map(|m| m.joints).filter(|_| first.kind == MoveKind::Rapid) {
        let from = RotaryPose { tip: machine.forward(&last).tip, rotary: last.rotary };
        for place in sphere.around(&machine.chain, &from, &RotaryPose { tip: first.to.tip, rotary: start }) {
            push(first, &place.tip, place.rotary, out);
        }
    }
    for (m, angles) in run.iter().zip(rotary) {
        push(m, &m.to.tip, *angles, out);
    }
}

fn report(cx: &mut PassContext<'_>, operation: &ClOperation, run: &[ClMove], miss: &OutOfTravel) {
    let declared = &cx.program.operations[operation.operation];
    let names = cx.program.machine.names();
    let (label, tip) = run.get(miss.index).map_or((String::new(), Point3::origin()), |m| {
        (operation.passes.get(m.pass as usize).map_or(String::new(), |p| p.label.clone()), m.to.tip)
    });
    cx.sink.push(
        Diag::error(
            kinematics::OUT_OF_TRAVEL,
            format!(
                "`{}` needs {} = {:.3} {unit}; the axis of {} goes from {:.3} to {:.3} {unit}",
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
        .place(label, tip)
        .note(format!("both branches of {} and all windings of {} were tried", names[3], names[4]))
        .help("take a machine with more travel, or mount the part elsewhere on the table"),
    );
}
