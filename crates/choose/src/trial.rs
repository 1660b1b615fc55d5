//! Trials of what was chosen, each on the text of a job.

use crate::Front;
use base::entity::EntityId;
use base::progress::Progress;
use diagnostics::{Aborted, Severity, Sink};
use ir::{OperationId, Program};
use plan::budget;
use plan::facts;
use plan::passes::pipeline;

/// Memory that a trial may plan with, over the estimate.
const MEMORY_RESERVE: f64 = 10.0;

/// Something that was tried.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tried {
    /// What: the operation with its tool and method.
    pub what: String,
    /// Why it does not hold; `None` where it does.
    pub fault: Option<String>,
}

/// How much a trial of operations does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Depth {
    /// Nothing: what fits by its sizes is taken to hold.
    Sizes,
    /// Facts about part and tools, as `impellerc check` finds them.
    Facts,
    /// Tool axes.
    Axes,
}

/// Trials on a job whose part, machine and contracts are given.
pub(crate) struct Trials<'a, 'f> {
    /// The text of the job.
    pub(crate) job: &'a str,
    /// The same without operations, with what is added to it.
    pub(crate) head: String,
    /// Names of its tools.
    pub(crate) taken: Vec<&'a str>,
    pub(crate) front: &'a mut Front<'f>,
    pub(crate) progress: &'a Progress,
    /// How much is tried.
    pub(crate) depth: Depth,
    pub(crate) tried: Vec<Tried>,
}

impl Trials<'_, '_> {
    /// Whether operations have paths with free and smooth axes in the sectors that they name.
    pub(crate) fn have_axes(&mut self, what: &str, items: &str) -> bool {
        self.planned(what, items, pipeline::axes).is_some()
    }

    /// Which of the operations of roughing find nothing to cut, by their order.
    pub(crate) fn needless(&mut self, what: &str, items: &str) -> Vec<usize> {
        let needless = self.planned(what, items, pipeline::needless).unwrap_or_default();
        needless.into_iter().map(OperationId::index).collect()
    }

    /// What a plan of operations says; `None` where it is refused.
    fn planned<T: Default>(
        &mut self,
        what: &str,
        items: &str,
        plan: impl FnOnce(&Program, &Progress, &mut Sink) -> Result<T, Aborted>,
    ) -> Option<T> {
        if self.depth == Depth::Sizes {
            return Some(T::default());
        }
        let mut sink = Sink::default();
        // The passes of the planner count their own work; this names it where they do not.
        let _work = self.progress.begin(what.to_owned(), 1);
        let planned = (self.front)(&format!("{}\n{items}", self.head), &mut sink).and_then(|mut program| {
            // A trial of one operation takes little; what the whole job takes is told with the choice.
            program.memory = program.memory.max(MEMORY_RESERVE * budget::needed(&program));
            facts::check(&program, self.progress, &mut sink);
            match self.depth {
                _ if sink.has_errors() => Err(Aborted),
                Depth::Axes => plan(&program, self.progress, &mut sink),
                Depth::Sizes | Depth::Facts => Ok(T::default()),
            }
        });
        let fault = planned.is_err().then(|| first_error(&sink));
        self.tried.push(Tried { what: what.to_owned(), fault });
        planned.ok()
    }
}

/// The first error of a sink in one line.
pub fn first_error(sink: &Sink) -> String {
    let error = sink.diags().iter().find(|diag| diag.severity == Severity::Error);
    error.map_or_else(|| "the run was cancelled".to_owned(), |diag| format!("{}: {}", diag.code.id(), diag.message))
}
