//! The run by the planner of LinuxCNC, which does not plan by joints.

use super::active::{ActiveTimes, MotionLimit, NO_CORNER, Pace, active};
use super::{At, BlockError, CornerError, MotionCell, Peak, Run, RunLimits, jerk, number};
use base::units::{Sec, Share};
use five_axis::linuxcnc::{self, Ran};
use ir::{JointMove, MoveKind};

/// Share of its programmed speed below which an axis limits a line: the rest is rounding.
const MIN_LIMITING_SHARE: f64 = 0.999;

/// Replaces times, active limits, corners and speeds by those of LinuxCNC.
pub(super) fn replace(
    settings: &linuxcnc::Settings,
    operation: u32,
    moves: &[JointMove],
    limits: &RunLimits,
    cells: &[MotionCell],
    report: &mut Run,
    errors: &mut [BlockError],
) {
    let lines = linuxcnc::lines(settings.machine, moves.iter().map(|m| (m.joints, m.time, m.stop)));
    let ran = linuxcnc::run(&lines, settings);
    report.time = [Sec(0.0); 3];
    report.corners = Peak::none();
    report.slowest = Peak { value: Share(1.0), at: None };
    let rapid = |index: usize| moves.get(index).is_none_or(|m| m.kind == MoveKind::Rapid);
    // The corner at the end of a move. Between two rapids the deviation does not matter, since nothing is near.
    let corner = |index: usize| {
        let ran = index.checked_sub(1).and_then(|i| ran.get(i)).filter(|_| !rapid(index) || !rapid(index + 1));
        ran.map_or_else(CornerError::default, |r| CornerError {
            flutes: r.deviation[0],
            axis: r.deviation[1].to_degrees(),
        })
    };
    let mut times = ActiveTimes::default();
    for (m, (ran, index)) in moves.iter().skip(1).zip(ran.iter().zip(1_u32..)) {
        let at = At { operation, index };
        report.time[number(m.kind)] += Sec(ran.time);
        if let Some(time) = report.move_times.get_mut(index as usize) {
            *time = Sec(ran.time);
        }
        add(limits, cells, index, number(m.kind), ran, &mut times);
        if m.kind == MoveKind::Cut && m.time < report.slowest.value.get() * ran.time {
            report.slowest = Peak { value: Share(m.time / ran.time), at: Some(at) };
        }
        report.corners.raise(corner(index as usize).flutes, at);
        for (most, share) in report.speed.iter_mut().zip(ran.speed) {
            most.raise(share, at);
        }
    }
    (report.limits, report.of_moves) = times.named(settings.machine.names());
    for error in errors {
        // The corner of an error is the corner at the start of its block.
        error.corner = (error.at.index as usize).checked_sub(1).map_or_else(CornerError::default, corner);
    }
}

/// Adds the time of the line of a block by active limit. At its largest speed the limits are those of the joints, as
/// for any control; while it accelerates or brakes, the acceleration of the axis with the largest share of it; in the
/// transition from line to line the corner.
fn add(limits: &RunLimits, cells: &[MotionCell], index: u32, kind: usize, ran: &Ran, times: &mut ActiveTimes) {
    let [speed, acceleration] = ran.axes;
    let first = cells.partition_point(|c| c.block < index);
    let own = first..first + cells[first..].partition_point(|c| c.block == index);
    let whole: f64 = cells[own.clone()].iter().map(|c| c.width).sum();
    let mut steady = 0.0;
    for i in own {
        let (cell, rate) = (&cells[i], ran.pace);
        let acceleration = cell.second.map(|q| q * rate * rate);
        let jerk = jerk::twist(cells, i).map(|q| q * rate.powi(3));
        let by_joints = active(limits, &Pace { cell, rate, acceleration, jerk, corner: NO_CORNER });
        let limited = matches!(by_joints.0, MotionLimit::Rest | MotionLimit::BlockFeed) && rate < MIN_LIMITING_SHARE;
        let active = if limited { (MotionLimit::Speed, Some(speed)) } else { by_joints };
        let time = ran.steady * cell.width / whole;
        times.add(index, active, kind, time);
        steady += time;
    }
    times.add(index, (MotionLimit::Corner, None), kind, ran.blends);
    times.add(index, (MotionLimit::Acceleration, Some(acceleration)), kind, ran.time - steady - ran.blends);
}
