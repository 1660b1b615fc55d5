//! LinuxCNC with the kinematics xyzac-trt or xyzbc-trt, after the names of the rotary axes of the machine.
//!
//! M428 switches tool centre point kinematics on, M429 switches them off (remaps of the trt simulations). The feed mode
//! is G94: under these kinematics X Y Z are the tip in the part frame, so F is the feed of the tip, as in the motion.
//! All blocks at feed move the tip. Every block with the kinematics on carries all five words.
//!
//! Under these kinematics G0 keeps the speed limits of the tip and not those of the joints. Moves at rapid are
//! therefore written as G1 in inverse time (G93), where F gives the time that was proved for all joints. Where the
//! motion stops, the block is one of exact stop (G61.1).
//!
//! The head of the program resets what an aborted program can have left active. M429 comes first and alone, since any
//! change of tool length with the kinematics on makes the axes jump. Tool length, offsets and rotation follow. With the
//! kinematics off, axes move in the machine frame (G53), in which neither offsets nor tool length act: Z alone to the
//! retract height, there the rotary axes, then X and Y.

mod comments;
mod reader;
mod subprograms;
mod writer;

use crate::dialect::{Dialect, Post, WriteBlock};
use crate::divided::Divided;
use crate::nc::ReadResult;
use base::source::Span;
use diagnostics::Sink;
use five_axis::Machine;
use ir::{Motion, MotionOperation, Program};

static DIALECT: Dialect = Dialect {
    name: "linuxcnc",
    about: "LinuxCNC with xyzac-trt or xyzbc-trt kinematics: M428, rotary words, G94",
    family: "linuxcnc",
    assumptions: &[
        "LinuxCNC 2.9 with xyzac-trt or xyzbc-trt and the points of the machine file; M428 and M429 switch and wait",
        "a positive rotary word turns its table right-handed; no pin conventional-directions is set",
        "[AXIS_A], [AXIS_B] and [AXIS_C] have no WRAPPED_ROTARY = 1: the sign of a word would be its direction",
        "M6 moves no axis: [EMCIO] has no TOOL_CHANGE_POSITION, TOOL_CHANGE_QUILL_UP and TOOL_CHANGE_AT_G30",
        "no REMAP changes a word but M428 and M429",
        "no external offsets (eoffset) act, and feed override is 100 % at most",
        "spindle.0.at-speed tells that the spindle has its speed, so that the first feed waits for it",
        "{work-offset} is the part origin in the machine frame, without rotary offsets; all axes are homed",
        "the tool table has the lengths of the head as Z and nothing in X, Y, A, B, C, U, V, W, which G43 takes too",
        "tool lengths drive the kinematics (motion.tooloffset.z to tool-offset)",
        "rapids are G1 in inverse time: G0 with M428 would keep no limit of a joint",
    ],
    form: writer::FORM,
    splines: None,
    no_subprograms: None,
    offsets: Some(&reader::OFFSETS),
};

/// The dialect.
pub(super) struct LinuxCnc;

impl Post for LinuxCnc {
    fn dialect(&self) -> &'static Dialect {
        &DIALECT
    }

    fn check_machine(&self, machine: &Machine, chosen: Option<Span>, sink: &mut Sink) {
        writer::check_machine(machine, chosen, sink);
    }

    fn check_motion(&self, program: &Program, motion: &Motion, sink: &mut Sink) {
        writer::check(program, motion, sink);
    }

    fn moves(&self, program: &Program, operation: &MotionOperation, smoothing: &str, write: &mut WriteBlock<'_>) {
        writer::moves(program, operation, smoothing, write);
    }

    fn subprograms(&self, program: &Program, divided: &Divided<'_>, smoothing: &str, write: &mut WriteBlock<'_>) {
        writer::subprograms(program, divided, smoothing, write);
    }

    fn sections(&self, text: &str, machine: &Machine, offset: &str) -> ReadResult {
        reader::read(text, machine, offset)
    }

    fn offset_number(&self, name: &str) -> Option<u32> {
        reader::offset_number(name)
    }

    fn recognises(&self, code: &str) -> bool {
        reader::recognises(code)
    }
}
