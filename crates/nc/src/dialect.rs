//! A dialect: what it is, as data, and what it does: refuse, write, read, recognise.

use super::control::WorkOffsets;
use super::divided::Divided;
use super::form::TextForm;
use super::nc::ReadResult;
use super::{modulo, words};
use base::source::Span;
use diagnostics::Sink;
use five_axis::{Angles, Machine};
use ir::{Motion, MotionOperation, Program};
use wheel::control::SplineForm;

/// A dialect, as data.
pub struct Dialect {
    /// Name in post files.
    pub name: &'static str,
    /// One line for the help.
    pub about: &'static str,
    /// Dialects with the same words have one family; its first dialect in the table stands for a text in these words.
    pub family: &'static str,
    /// What the proof assumes of those who take the text further and of the settings of the control, a line each; for the
    /// head and the certificate. `{work-offset}` stands for the work offset of the program, `{transformation}` for the words
    /// that switch tool centre point control on.
    pub assumptions: &'static [&'static str],
    /// How the dialect writes text.
    pub form: TextForm,
    /// Spline blocks that the dialect has.
    pub splines: Option<SplineForm>,
    /// Why the dialect has no subprograms for what sectors repeat; `None` where it has them.
    pub no_subprograms: Option<&'static str>,
    /// The work offsets of the control; `None` where a text has none.
    pub offsets: Option<&'static WorkOffsets>,
}

/// Why a dialect has no subprograms whose manuals say too little.
pub(super) const NO_TURNED_FRAME: Option<&str> = Some(
    "no manual that the project knows says how a turned work frame acts in this control with tool centre point control on",
);

/// What a dialect does.
pub trait Post: Sync {
    /// The dialect.
    fn dialect(&self) -> &'static Dialect;
    /// Name in post files.
    fn name(&self) -> &'static str {
        self.dialect().name
    }
    /// Refuses a machine that the transformation of the control does not support. `chosen` is the place that names the post.
    /// The sense of each rotary axis is a setting of most controls.
    fn check_machine(&self, machine: &Machine, chosen: Option<Span>, sink: &mut Sink) {
        words::check_planning(machine, chosen, sink);
        words::check_length_to(machine, chosen, sink);
        modulo::check_machine(&self.dialect().form, machine, chosen, sink);
    }
    /// Refuses a motion that the dialect cannot express, on a machine and with words that it has.
    fn check_motion(&self, program: &Program, motion: &Motion, sink: &mut Sink);
    /// Refuses all that the dialect cannot express.
    fn check(&self, program: &Program, motion: &Motion, sink: &mut Sink) {
        self.check_machine(&program.machine, program.post.span, sink);
        words::check(program, motion, sink);
        self.check_motion(program, motion, sink);
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
    /// Writes the blocks of an operation as [`Self::moves`] does, and each subprogram once, with a call for each place. A block
    /// of a subprogram has the index of its move in the first place.
    fn subprograms(&self, program: &Program, divided: &Divided<'_>, smoothing: &str, write: &mut WriteBlock<'_>) {
        self.moves(program, divided.operation, smoothing, write);
    }
    /// Motion that a text in this dialect commands, section by section: from the block that switches the transformation
    /// on to the retract after it. `offset` is the work offset that holds the part origin.
    ///
    /// # Errors
    /// The lines that are not understood or that make the program invalid, at least one, at most
    /// [`super::MAX_FAULTS`].
    fn sections(&self, text: &str, machine: &Machine, offset: &str) -> ReadResult;
    /// As [`Self::sections`], with the usual work offset of the dialect.
    ///
    /// # Errors
    /// As [`Self::sections`].
    fn read(&self, text: &str, machine: &Machine) -> ReadResult {
        self.read_with_offset(text, machine, None)
    }
    /// As [`Self::read`]; `None` for the usual work offset.
    ///
    /// # Errors
    /// As [`Self::sections`].
    fn read_with_offset(&self, text: &str, machine: &Machine, offset: Option<&str>) -> ReadResult {
        self.sections(text, machine, offset.or(self.dialect().offsets.map(|all| all.usual)).unwrap_or_default())
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
