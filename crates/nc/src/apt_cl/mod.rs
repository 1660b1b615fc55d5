//! CL data in the words of APT (ISO 3592 and ISO 4343): poses of the tool in the part frame, for a later post-processor.
//!
//! CL data know no machine: neither rotary axes, nor their branch, nor positions in the machine frame. `GOTO` gives tip and
//! axis; what the rotary axes do between two poses is the choice of the post-processor. The proof is one for the machine
//! file of the job, whose axes turn evenly between poses.
//!
//! Each operation stands between two stations at retract height. They are poses as well: behind the tool change `FROM` says
//! where the tool stands. A move in its place would be one that nobody proved, from the last station of the operation
//! before, in another direction of the tool. A post-processor that skips `FROM` finds the same pose in the GOTO at rapid
//! behind it, and does not go from the tool change straight down to the first target. `GOHOME` is not written, since its way
//! is that of the post-processor. `RAPID` stands before each GOTO at rapid, and `FEDRAT` behind it.

mod curve_statements;
mod reader;
mod statements;
mod writer;

use crate::dialect::{Dialect, Post, WriteBlock};
use crate::nc::ReadResult;
use crate::words;
use base::source::Span;
use diagnostics::Sink;
use five_axis::Machine;
use ir::{Motion, MotionOperation, Program};
use wheel::control::SplineForm;

static DIALECT: Dialect = Dialect {
    name: "apt-cl",
    about: "CL data of APT for a later post-processor: GOTO with tool axis, FEDRAT, RAPID",
    family: "apt-cl",
    assumptions: &[
        "between two poses the tip goes straight; how the rotary axes turn is the choice of the post-processor",
        "this proof holds where both rotary axes of the machine file turn evenly between the poses",
        "from LOADTL to FROM all axes but Z stay at the retract height; the post-processor sees to it",
        "MOVNRB, where it stands, is its curves, or the GOTO within it along the same curves",
        "FEDRAT is the speed of the tip, 100 % at most; the first feed waits for the spindle",
        "zero and axes of the work offset are those of the part frame; the length of LOADTL acts",
    ],
    form: writer::FORM,
    splines: Some(SplineForm::Movnrb),
    no_subprograms: Some("CL data have no calls that every later post-processor expands alike"),
    offsets: None,
};

/// The dialect.
pub(super) struct AptCl;

impl Post for AptCl {
    fn dialect(&self) -> &'static Dialect {
        &DIALECT
    }

    fn check_machine(&self, machine: &Machine, chosen: Option<Span>, sink: &mut Sink) {
        words::check_planning(machine, chosen, sink);
    }

    fn check_motion(&self, program: &Program, motion: &Motion, sink: &mut Sink) {
        writer::check(program, motion, sink);
    }

    fn moves(&self, program: &Program, operation: &MotionOperation, _smoothing: &str, write: &mut WriteBlock<'_>) {
        writer::moves(program, operation, write);
    }

    fn sections(&self, text: &str, machine: &Machine, _offset: &str) -> ReadResult {
        reader::read(text, machine)
    }

    fn recognises(&self, code: &str) -> bool {
        reader::recognises(code)
    }
}
