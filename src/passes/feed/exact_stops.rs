//! `exact-stops`: places where the control comes to rest, for a control whose tolerance of smoothing does not bound what
//! rotary axes do (LinuxCNC).
//!
//! Before: moves with times. After: a move has a stop at its end where a way at rapid meets one at feed, and where going
//! over into the next move would take tip or flutes off the path by more than the tolerance of the operation, or an axis
//! beyond its speed. What the control does is that of [`crate::kin::linuxcnc`].

use crate::contract::ContractKind;
use crate::ir::{JointMove, Motion, MoveKind, OperationId, Program};
use crate::kin::linuxcnc;
use crate::method::Planning;
use rayon::prelude::*;

/// Most times that the run is looked at again with the stops that it needed.
const MOST_RUNS: usize = 64;

/// Sets the stops.
pub(crate) fn run(program: &Program, motion: &mut Motion) {
    if program.machine.planning != Planning::LinuxCnc {
        return;
    }
    motion.operations.par_iter_mut().for_each(|operation| {
        let declared = &program.operations[operation.operation];
        let settings = linuxcnc::Settings {
            machine: &program.machine,
            tolerance: program.tolerances.chord.get(),
            height: program.tools[declared.tool].solid.flute_length,
        };
        let moves = &mut operation.moves;
        at_joins(moves);
        let allowed = allowed(program, operation.operation);
        let mut lines = linuxcnc::lines(&program.machine, moves.iter().map(|m| (m.joints, m.time, m.stop)));
        for _ in 0..MOST_RUNS {
            if !at_corners(&settings, allowed, moves, &mut lines) {
                break;
            }
        }
    });
}

/// How far the control may leave the path of an operation, mm: its tolerance, and what contracts on it ask for.
fn allowed(program: &Program, id: OperationId) -> f64 {
    let t = &program.tolerances;
    let finishes = program.operations[id].kind.finishes();
    let tolerance = if finishes { t.chord.get() } else { t.chord_rough.get().max(t.chord.get()) };
    let contracts = program.contracts.iter().filter(|c| c.kind == ContractKind::ContourError);
    let here = contracts.filter(|c| c.scope.operations.is_empty() || c.scope.operations.contains(&id));
    here.map(|c| c.bound.value()).fold(tolerance, f64::min)
}

/// Stops where a way at rapid meets one at feed, and before the retract, which waits for the kinematics to be switched.
fn at_joins(moves: &mut [JointMove]) {
    for i in 1..moves.len() {
        let joins = (moves[i - 1].kind == MoveKind::Rapid) != (moves[i].kind == MoveKind::Rapid);
        moves[i - 1].stop = joins || i + 1 == moves.len();
    }
}

/// Stops at corners where the tool leaves the path by more than is allowed, or where an axis goes faster than it can,
/// since the end of one move and the start of the next add up. Whether there was one.
fn at_corners(
    settings: &linuxcnc::Settings,
    allowed: f64,
    moves: &mut [JointMove],
    lines: &mut [linuxcnc::Line],
) -> bool {
    let mut more = false;
    for (i, ran) in linuxcnc::run(lines, settings).iter().enumerate() {
        // At rapid nothing is near that would mind a deviation.
        let leaves = ran.deviation[0] > allowed && moves[i + 1].kind != MoveKind::Rapid;
        if leaves || ran.speed.iter().any(|share| *share > 1.0) {
            (moves[i + 1].stop, lines[i].stop) = (true, true);
            more = true;
        }
    }
    more
}
