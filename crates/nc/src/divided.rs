//! An operation with parts that sectors repeat, as writers need it.

use base::units::trim;
use ir::repeats::Division;
use ir::{MotionOperation, Program};

/// Digits of turns and shifts, degrees. They are finer than the words of positions, since a pitch of 360/7 deg has no end.
const TURN_AND_SHIFT_DIGITS: usize = 9;

/// First number of a subprogram.
const FIRST_SUBPROGRAM: usize = 101;

/// An operation with parts that sectors repeat.
pub struct Divided<'a> {
    /// The operation.
    pub operation: &'a MotionOperation,
    /// Its intervals.
    pub division: Division,
    /// Subprograms of operations before.
    pub before: usize,
}

impl Divided<'_> {
    /// Number of a subprogram in the text.
    pub(super) fn number(&self, subprogram: usize) -> usize {
        FIRST_SUBPROGRAM + self.before + subprogram
    }

    /// Whether some places of a subprogram have the other branch of the rotary axes.
    pub(super) fn changes_branch(&self, subprogram: usize) -> bool {
        self.division.places(subprogram).any(|(_, turned)| turned.first < 0.0)
    }
}

/// An angle in a turn or a shift, degrees.
pub(super) fn degrees(angle: f64) -> String {
    trim(angle, TURN_AND_SHIFT_DIGITS)
}

/// Turn of the work frame, degrees.
pub(super) fn frame_degrees(program: &Program, pitches: u32) -> String {
    degrees(360.0 * f64::from(pitches) / f64::from(program.part.vane_count))
}
