//! NC text of a verified motion: the one place where a text is made that is handed on.

use base::units::Sec;
use ir::{Motion, Program};
use nc::compare::{ComparedMotion, OperationDifference};
use nc::{NcProgram, Post};
use verify::Verified;

/// The program as text. `header` holds lines of the comment block at its head.
pub fn write(post: &dyn Post, program: &Program, motion: &Verified<Motion>, header: &[String]) -> NcProgram {
    nc::emit(post, program, motion, header)
}

/// Compares two motions of the operations of one job. The times are those of the certificate: of the run of the control,
/// since limits of removal change no time.
pub fn compare(sides: [ComparedMotion<'_>; 2]) -> Vec<OperationDifference> {
    nc::compare::compare(sides, &|side, index| {
        verify::dynamics::run(side.program, side.motion, index, &[]).time.map(Sec::get)
    })
}
