//! `exact-stops`: exact stops for a control whose smoothing tolerance does not bound the rotary axes (LinuxCNC).
//!
//! Before: moves with times. After: a move ends with an exact stop in three cases. A rapid meets a move at feed; corner
//! rounding into the next move would take tip or flutes off the path by more than the tolerance of the operation; or
//! the rounding would exceed the speed of an axis. [`five_axis::linuxcnc`] models the control.

use base::progress::Progress;
use five_axis::control::Planning;
use five_axis::linuxcnc;
use ir::{JointMove, Motion, MoveKind, OperationId, Program};
use rayon::prelude::*;
use wheel::contract::ContractKind;

/// Most rounds in which the run is simulated again with the new stops.
const MAX_RUNS: usize = 64;

/// Sets the stops.
pub(crate) fn run(program: &Program, progress: &Progress, motion: &mut Motion) {
    if program.machine.planning != Planning::LinuxCnc {
        return;
    }
    // The planner of the control limits the tip along the axes of the work frame.
    let machine = &program.machine.in_work_frame();
    motion.operations.par_iter_mut().for_each(|operation| {
        let declared = &program.operations[operation.operation];
        let settings = linuxcnc::Settings {
            machine,
            tolerance: program.tolerances.chord.get(),
            height: program.tools[declared.tool].solid.flute_length,
            length: program.tools[declared.tool].length(),
        };
        let moves = &mut operation.moves;
        at_joins(moves);
        let allowed = allowed(program, operation.operation);
        let mut lines = linuxcnc::lines(machine, moves.iter().map(|m| (m.joints, m.time, m.stop)));
        for _ in 0..MAX_RUNS {
            // The caller ends a cancelled run.
            if progress.is_cancelled() || !at_corners(&settings, allowed, moves, &mut lines) {
                break;
            }
        }
    });
}

/// Largest deviation of the control from the path of an operation, mm: its tolerance, and the contracts on contour error.
fn allowed(program: &Program, id: OperationId) -> f64 {
    let t = &program.tolerances;
    let finishes = program.operations[id].kind.finishes();
    let tolerance = if finishes { t.chord.get() } else { t.chord_rough.get().max(t.chord.get()) };
    let contracts = program.contracts.iter().filter(|c| c.kind == ContractKind::ContourError);
    let here = contracts.filter(|c| c.scope.operations.is_empty() || c.scope.operations.contains(&id));
    here.map(|c| c.bound.value()).fold(tolerance, f64::min)
}

/// Stops where a rapid meets a move at feed, and before the retract, which waits for the switch of the kinematics.
fn at_joins(moves: &mut [JointMove]) {
    for i in 1..moves.len() {
        let joins = (moves[i - 1].kind == MoveKind::Rapid) != (moves[i].kind == MoveKind::Rapid);
        moves[i - 1].stop = joins || i + 1 == moves.len();
    }
}

/// Stops at corners where the tool leaves the path by more than allowed, or where an axis exceeds its speed, since the
/// end of one move and the start of the next add up. Returns true when a stop was added.
fn at_corners(
    settings: &linuxcnc::Settings,
    allowed: f64,
    moves: &mut [JointMove],
    lines: &mut [linuxcnc::Line],
) -> bool {
    let mut more = false;
    for (i, ran) in linuxcnc::run(lines, settings).iter().enumerate() {
        // During rapids nothing is near, so that a deviation does no harm.
        let leaves = ran.deviation[0] > allowed && moves[i + 1].kind != MoveKind::Rapid;
        if leaves || ran.speed.iter().any(|share| *share > 1.0) {
            (moves[i + 1].stop, lines[i].stop) = (true, true);
            more = true;
        }
    }
    more
}
