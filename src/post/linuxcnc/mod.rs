//! LinuxCNC with the xyzac-trt kinematics.
//!
//! M428 switches tool centre point kinematics on, M429 off (remaps of the trt simulations). Feed is G94: under these
//! kinematics X Y Z are the tip in the part frame, so that F is the feed of the tip, as in the motion; all blocks at feed
//! move the tip. Every block with the kinematics on carries all five words.
//!
//! Under these kinematics G0 keeps the speeds of the tip and not those of the joints. Ways at rapid are written as G1 in
//! inverse time (G93), in which F says the time of the block that was proved for all joints. Where the motion stops, the
//! block is one of exact stop (G61.1).
//!
//! The head takes back what a program that was aborted can have left: M429 alone first, since any change of tool length with
//! the kinematics on makes the axes jump; then tool length, offsets and rotation. Axes move with the kinematics off in the
//! machine frame (G53), which leaves offsets and tool length out: Z alone to the retract height, there the rotary axes, then X and Y.

mod reader;
mod writer;

use crate::diag::Sink;
use crate::ir::{Motion, Program};
use crate::kin::Machine;
use crate::post::dialect::Post;
use crate::post::nc::{NcProgram, NcSection, ReadError};
use crate::verify::Verified;

/// The dialect.
pub(super) struct LinuxCnc;

impl Post for LinuxCnc {
    fn name(&self) -> &'static str {
        "linuxcnc"
    }

    fn about(&self) -> &'static str {
        "LinuxCNC with xyzac-trt kinematics: M428, rotary words, G94"
    }

    fn check_machine(&self, machine: &Machine, sink: &mut Sink) {
        writer::check_machine(machine, sink);
    }

    fn check(&self, program: &Program, motion: &Motion, sink: &mut Sink) {
        writer::check(program, motion, sink);
    }

    fn emit(&self, program: &Program, motion: &Verified<Motion>, header: &[String]) -> NcProgram {
        writer::emit(program, motion.get(), header)
    }

    fn read(&self, text: &str, machine: &Machine) -> Result<Vec<NcSection>, Vec<ReadError>> {
        reader::read(text, machine)
    }

    fn recognises(&self, code: &str) -> bool {
        reader::recognises(code)
    }
}
