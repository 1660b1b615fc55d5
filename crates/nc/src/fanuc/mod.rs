//! Fanuc 30i and 31i, Mitsubishi M700 and M800, Makino: one family, whose members differ by data.
//!
//! Tool centre point control is G43.4 with rotary words. G43.4 also activates the tool length, and G49 cancels both. With
//! G43.4 the control fixes the work frame to the table as the table stands in that block (Fanuc A-79348E, page 19;
//! Mitsubishi M700V 13.24). So the tables stand at zero there. Then they turn to the start of the path in small blocks, in
//! which the other axes stand still: each block gives X Y Z of the place on the part that is below the tool.
//!
//! A number has a decimal point always: without a point the unit depends on a setting of the control.
//!
//! The head of the program resets what an aborted program can have left active. G49 comes first: the axes jump with any
//! change of tool length under tool centre point control. `G92.1` takes back shifts of the work frame. With the control off, axes move in
//! the machine frame (G53).

mod control;
mod reader;
mod text;
mod writer;

#[cfg(test)]
mod tests;

use crate::dialect::{Dialect, Post, WriteBlock};
use crate::nc::ReadResult;
use control::Member;
use diagnostics::Sink;
use five_axis::{Angles, Machine};
use ir::{Motion, MotionOperation, Program};

/// A dialect of the family.
pub(super) struct Family {
    member: &'static Member,
}

impl Family {
    /// Fanuc, and Makino with the words of its machine in a post file.
    pub(super) const FANUC: Self = Self { member: &control::FANUC };
    /// Mitsubishi.
    pub(super) const MITSUBISHI: Self = Self { member: &control::MITSUBISHI };
}

impl Post for Family {
    fn dialect(&self) -> &'static Dialect {
        &self.member.dialect
    }

    fn check_motion(&self, program: &Program, motion: &Motion, sink: &mut Sink) {
        writer::check(self.member, program, motion, sink);
    }

    fn at_switch(&self, machine: &Machine, start: Angles) -> Angles {
        writer::at_switch(machine, start)
    }

    fn number(&self, value: f64, decimals: usize) -> String {
        writer::number(value, decimals)
    }

    fn moves(&self, program: &Program, operation: &MotionOperation, _smoothing: &str, write: &mut WriteBlock<'_>) {
        writer::moves(self, program, operation, write);
    }

    fn sections(&self, text: &str, machine: &Machine, offset: &str) -> ReadResult {
        reader::read(text, machine, offset, self.member)
    }

    fn recognises(&self, code: &str) -> bool {
        reader::recognises(code)
    }
}
