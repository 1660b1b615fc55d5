//! The frame that the words of a text count in.
//!
//! With tool centre point control X, Y, Z and direction vectors count in the work frame of the control: its origin is that of
//! the part, its axes are those of the machine with all axes at zero. It is not the part frame where the machine file states
//! how the part is turned on the table (`[part] direction`). Joints are the same in both, so a program with the machine of the
//! work frame writes and reads such words; only the polynomials of spline blocks are turned. CL data know no machine: their
//! poses are in the part frame.

use ir::{Motion, Program};
use nalgebra::Rotation3;
use std::borrow::Cow;
use wheel::control::counts_in_part_frame;

/// Turn from the part frame to the frame of the words of a dialect; `None` where both are the same.
fn turn(dialect: &str, program: &Program) -> Option<Rotation3<f64>> {
    let chain = &program.machine.chain;
    (!counts_in_part_frame(dialect) && !chain.holds_part_upright()).then(|| *chain.part_axes())
}

/// The program with its machine in the frame of the words.
pub(super) fn program<'a>(dialect: &str, program: &'a Program) -> Cow<'a, Program> {
    match turn(dialect, program) {
        Some(_) => Cow::Owned(Program { machine: program.machine.in_work_frame(), ..program.clone() }),
        None => Cow::Borrowed(program),
    }
}

/// A motion with its polynomials in the frame of the words. `program` is that of the part frame.
pub(super) fn motion<'a>(dialect: &str, program: &Program, motion: &'a Motion) -> Cow<'a, Motion> {
    match turn(dialect, program) {
        Some(turn) => Cow::Owned(turned(motion.clone(), &turn)),
        None => Cow::Borrowed(motion),
    }
}

/// A motion that was read, with its polynomials in the part frame. `program` is that of the part frame.
pub(super) fn read(dialect: &str, program: &Program, motion: Motion) -> Motion {
    match turn(dialect, program) {
        Some(turn) => turned(motion, &turn.inverse()),
        None => motion,
    }
}

fn turned(mut motion: Motion, turn: &Rotation3<f64>) -> Motion {
    for spline in motion.operations.iter_mut().flat_map(|operation| &mut operation.splines) {
        spline.curve = spline.curve.turned(turn);
    }
    motion
}

/// How the part is turned in the frame of the words, for the head.
pub(super) fn assumptions(dialect: &str, program: &Program) -> Vec<String> {
    let turned = program.machine.part_turned().filter(|_| turn(dialect, program).is_some());
    let words = "X Y Z and directions count along the axes of the machine with the rotary axes at 0";
    turned.map_or_else(Vec::new, |turned| vec![words.to_owned(), format!("there {turned}")])
}
