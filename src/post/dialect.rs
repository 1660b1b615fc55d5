//! What a dialect does: refuse, write, read, recognise.

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
    /// Refuses a machine that the transformation of the control cannot have.
    fn check_machine(&self, machine: &Machine, sink: &mut Sink);
    /// Refuses what the dialect cannot say, on a machine that it cannot have too.
    fn check(&self, program: &Program, motion: &Motion, sink: &mut Sink);
    /// The program as text. `header` holds lines of the comment block at its head.
    fn emit(&self, program: &Program, motion: &Verified<Motion>, header: &[String]) -> NcProgram;
    /// What a text in this dialect makes the machine do, from where the transformation is switched on to the retract
    /// after it, section by section.
    ///
    /// # Errors
    /// The lines that are not understood or that are no sound program, at least one, at most [`super::MOST_FAULTS`].
    fn read(&self, text: &str, machine: &Machine) -> Result<Vec<NcSection>, Vec<ReadError>>;
    /// Whether a block holds a word that no other dialect knows. `code` ends where a bracket or a
    /// comment begins.
    fn recognises(&self, code: &str) -> bool;
}
