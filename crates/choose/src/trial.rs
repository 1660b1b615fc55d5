//! Trials of what was chosen, each on the text of a job.

use crate::Front;
use base::progress::Progress;
use diagnostics::{Severity, Sink};
use plan::facts;
use plan::passes::pipeline;

/// Something that was tried.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tried {
    /// What: the operation with its tool and method.
    pub what: String,
    /// Why it does not hold; `None` where it does.
    pub fault: Option<String>,
}

/// Trials on a job whose part, machine and contracts are given.
pub(crate) struct Trials<'a, 'f> {
    /// The text before tools and operations.
    pub(crate) head: String,
    pub(crate) front: &'a mut Front<'f>,
    pub(crate) progress: &'a Progress,
    pub(crate) tried: Vec<Tried>,
}

impl Trials<'_, '_> {
    /// Whether operations have paths with free and smooth axes in the sectors that they name.
    pub(crate) fn have_axes(&mut self, what: &str, items: &str) -> bool {
        let mut sink = Sink::default();
        // The passes of the planner count their own work; this names it where they do not.
        let _work = self.progress.begin(what.to_owned(), 1);
        let planned = (self.front)(&format!("{}\n{items}", self.head), &mut sink).and_then(|program| {
            facts::check(&program, self.progress, &mut sink);
            if sink.has_errors() {
                Err(diagnostics::Aborted)
            } else {
                pipeline::axes(&program, self.progress, &mut sink)
            }
        });
        let fault = planned.err().map(|_| first_error(&sink));
        self.tried.push(Tried { what: what.to_owned(), fault: fault.clone() });
        fault.is_none()
    }
}

/// The first error of a sink in one line.
pub fn first_error(sink: &Sink) -> String {
    let error = sink.diags().iter().find(|diag| diag.severity == Severity::Error);
    error.map_or_else(|| "the run was cancelled".to_owned(), |diag| format!("{}: {}", diag.code.id(), diag.message))
}
