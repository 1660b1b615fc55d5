//! The operations of a dialect: refuse, write, read, recognise.

use super::nc::{NcProgram, NcSection, ReadError};
use crate::diag::Sink;
use crate::ir::{Motion, Program};
use crate::kin::Machine;
use crate::verify::Verified;

/// A dialect.
pub trait Post: Sync {
    /// Name in the job language and on the command line.
    fn name(&self) -> &'static str;
    /// One line for the help.
    fn about(&self) -> &'static str;
    /// Refuses a machine that the transformation of the control does not support.
    fn check_machine(&self, machine: &Machine, sink: &mut Sink);
    /// Refuses a motion that the dialect cannot express; also refuses what [`Self::check_machine`] refuses.
    fn check(&self, program: &Program, motion: &Motion, sink: &mut Sink);
    /// The program as text. `header` holds lines of the comment block at its head.
    fn emit(&self, program: &Program, motion: &Verified<Motion>, header: &[String]) -> NcProgram;
    /// Motion that a text in this dialect commands, section by section: from the block that switches the transformation
    /// on to the retract after it.
    ///
    /// # Errors
    /// The lines that are not understood or that make the program invalid, at least one, at most
    /// [`super::MOST_FAULTS`].
    fn read(&self, text: &str, machine: &Machine) -> Result<Vec<NcSection>, Vec<ReadError>>;
    /// Whether a block holds a word that only this dialect has. `code` ends at the first bracket or comment.
    fn recognises(&self, code: &str) -> bool;
}
