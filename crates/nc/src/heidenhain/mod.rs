//! HEIDENHAIN iTNC 530 and TNC 640, Klartext.
//!
//! Tool centre point control is FUNCTION TCPM (TNC 640) or M128 (iTNC 530); the frames of the post file say which. F is the
//! feed of the tip then, and the rotary axes run linearly between blocks, as in the motion. Blocks carry the positions of
//! the rotary axes (L), or the tool direction as a vector of length 1 (LN). Nothing in LN is modal: each block has all six
//! words. The iTNC 530 also takes cubics of tip and rotary axes (SPL). Rapids carry the positions of the rotary axes in any case, and thus select one of the two positions that a
//! vector fits; [`Post::check`] makes sure that the nearest position is the right one in every later block.
//!
//! Each operation first resets what an aborted program can have left active. With tool centre point control off, axes
//! move in the machine frame (M91), in which the tool length is not compensated: Z alone to the retract height, there the
//! rotary axes, then X and Y. The rotary axes have the words of the preset there too, as in the path. TOOL CALL activates
//! the length of its tool at once; M128 must be off before M91 and before TOOL CALL.

mod reader;
mod spline;
mod straight;
mod writer;

use crate::dialect::{Dialect, NO_TURNED_FRAME, Post, WriteBlock};
use crate::nc::ReadResult;
use diagnostics::Sink;
use five_axis::Machine;
use ir::{Motion, MotionOperation, Program};
use wheel::control::SplineForm;

static DIALECT: Dialect = Dialect {
    name: "heidenhain",
    about: "HEIDENHAIN iTNC 530 and TNC 640: Klartext with FUNCTION TCPM or M128, angles or LN vectors",
    family: "heidenhain",
    assumptions: &[
        "preset {work-offset} is the part origin with the rotary axes at 0, and has no rotary offsets",
        "L of the tool table is the length to the tip, also of ball end mills; DL, DR and DR2 are 0",
        "no pallet preset, no global program settings and no handwheel superimposition (M118) act",
        "positions with M91 count from the machine datum of the machine file, Z without the tool length",
        "the kinematics of the control are those of the machine file; cycle 32 is enabled, and nothing else smooths",
        "feed override is 100 % at most, and no adaptive feed control (AFC) acts",
        "M3 ends when the spindle has its speed; TOOL CALL leaves Z at the retract height",
    ],
    form: writer::FORM,
    splines: Some(SplineForm::Spl),
    no_subprograms: NO_TURNED_FRAME,
    offsets: Some(&reader::OFFSETS),
};

/// The dialect.
pub(super) struct Heidenhain;

impl Post for Heidenhain {
    fn dialect(&self) -> &'static Dialect {
        &DIALECT
    }

    fn check_motion(&self, program: &Program, motion: &Motion, sink: &mut Sink) {
        writer::check(program, motion, sink);
    }

    fn number(&self, value: f64, decimals: usize) -> String {
        writer::number(value, decimals)
    }

    fn moves(&self, program: &Program, operation: &MotionOperation, _smoothing: &str, write: &mut WriteBlock<'_>) {
        writer::moves(program, operation, write);
    }

    fn sections(&self, text: &str, machine: &Machine, offset: &str) -> ReadResult {
        reader::read(text, machine, offset)
    }

    fn recognises(&self, code: &str) -> bool {
        reader::recognises(code)
    }
}
