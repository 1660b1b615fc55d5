//! The operations of a dialect: refuse, write, read, recognise.

use super::control::WorkOffsets;
use super::divided::Divided;
use super::form::TextForm;
use super::nc::{NcSection, ReadError};
use super::words;
use base::source::Span;
use diagnostics::Sink;
use five_axis::{Angles, Machine};
use ir::{Motion, MotionOperation, Program};
use wheel::control::SplineForm;

/// A dialect.
pub trait Post: Sync {
    /// Name in post files.
    fn name(&self) -> &'static str;
    /// One line for the help.
    fn about(&self) -> &'static str;
    /// Dialects with the same words have one family; its first dialect in the table stands for a text in these words.
    fn family(&self) -> &'static str {
        self.name()
    }
    /// Refuses a machine that the transformation of the control does not support. `chosen` is the place that names the post.
    fn check_machine(&self, machine: &Machine, chosen: Option<Span>, sink: &mut Sink);
    /// Refuses a motion that the dialect cannot express; also refuses what [`Self::check_machine`] refuses.
    fn check(&self, program: &Program, motion: &Motion, sink: &mut Sink);
    /// What the proof assumes of those who take the text further and of the settings of the control, a line each; for the
    /// head and the certificate. `{work-offset}` stands for the work offset of the program, `{transformation}` for the words
    /// that switch tool centre point control on.
    fn assumptions(&self) -> &'static [&'static str] {
        &[]
    }
    /// How the dialect writes text.
    fn form(&self) -> &'static TextForm;
    /// Spline blocks that the dialect has.
    fn splines(&self) -> Option<SplineForm> {
        None
    }
    /// Positions of the rotary axes, radians, with which tool centre point control is switched on for a path that begins
    /// at the positions `start`.
    fn at_switch(&self, _machine: &Machine, start: Angles) -> Angles {
        start
    }
    /// A number in a word, with at most some digits behind the point.
    fn number(&self, value: f64, decimals: usize) -> String {
        words::fixed(value, decimals)
    }
    /// Writes the blocks of the moves of an operation between its stations, each with the index of the move that it
    /// ends, or `None` for a block without motion. `smoothing` has the words that smooth within the tolerances of the
    /// operation.
    fn moves(&self, program: &Program, operation: &MotionOperation, smoothing: &str, write: &mut WriteBlock<'_>);
    /// Why the dialect has no subprograms for what sectors repeat; `None` where it has them.
    fn no_subprograms(&self) -> Option<&'static str> {
        Some(
            "no manual that the project knows says how a turned work frame acts in this control with tool centre point control on",
        )
    }
    /// Writes the blocks of an operation as [`Self::moves`] does, and each subprogram once, with a call for each place. A block
    /// of a subprogram has the index of its move in the first place.
    fn subprograms(&self, program: &Program, divided: &Divided<'_>, smoothing: &str, write: &mut WriteBlock<'_>) {
        self.moves(program, divided.operation, smoothing, write);
    }
    /// Motion that a text in this dialect commands, section by section: from the block that switches the transformation
    /// on to the retract after it.
    ///
    /// # Errors
    /// The lines that are not understood or that make the program invalid, at least one, at most
    /// [`super::MOST_FAULTS`].
    fn read(&self, text: &str, machine: &Machine) -> Result<Vec<NcSection>, Vec<ReadError>> {
        self.read_with_offset(text, machine, None)
    }
    /// As [`Self::read`], with the work offset that holds the part origin; `None` for the usual one of the dialect.
    ///
    /// # Errors
    /// As [`Self::read`].
    fn read_with_offset(
        &self,
        text: &str,
        machine: &Machine,
        offset: Option<&str>,
    ) -> Result<Vec<NcSection>, Vec<ReadError>>;
    /// The work offsets of the control; `None` where a text has none.
    fn offsets(&self) -> Option<&'static WorkOffsets> {
        None
    }
    /// Number of a work offset in words that change it, where the dialect writes such words.
    fn offset_number(&self, _name: &str) -> Option<u32> {
        None
    }
    /// Whether a block holds a word that only this dialect has. `code` ends at the first bracket or comment.
    fn recognises(&self, code: &str) -> bool;
}

/// Receives the blocks of moves.
pub type WriteBlock<'a> = dyn FnMut(String, Option<usize>) + 'a;
