//! Options of a run, and its outcome.

use super::{Emit, EmitForm, OutputFile, PartOptions, RunOptions};
use ::report::proof::contracts::bound_and_found;
use base::source::{SourceMap, Span};
use diagnostics::Sink;
use diagnostics::junit::Judged;
use std::path::PathBuf;
use verify::certificate::{ContractReport, OperationReport};

/// Options of a compilation.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Job file; of no effect with a stage file.
    pub job: PathBuf,
    /// Stage file to go on from, in the place of a job.
    pub from: Option<PathBuf>,
    /// File to write the NC text to.
    pub output: Option<PathBuf>,
    /// Files to write beside the NC text, none twice.
    pub other_outputs: Vec<OutputFile>,
    /// Stage value to print; the compilation stops after this stage.
    pub emit: Option<Emit>,
    /// How a stage value is written.
    pub form: EmitForm,
    /// How the part is written.
    pub part: PartOptions,
    /// Whether a check tells what flank milling would leave on the faces.
    pub fits: bool,
    /// Shared options.
    pub run: RunOptions,
}

/// Result of a run.
#[derive(Debug, Default)]
pub struct Outcome {
    /// All texts of the run.
    pub sources: SourceMap,
    /// All diagnostics.
    pub sink: Sink,
    /// The stage value to print, as text.
    pub emitted: Option<String>,
    /// Contracts that were judged, including those that failed.
    pub contracts: Vec<ContractReport>,
    /// Operations that were judged, each with its place in the job. An item with several tools is as many operations.
    pub operations: Vec<(Span, OperationReport)>,
    /// Name of an operation, and a decision of its planning.
    pub notes: Vec<(String, String)>,
    /// Files that the front end looked for and did not find: one that is made later is another job.
    pub missing_files: Vec<PathBuf>,
}

impl Outcome {
    /// The contracts as cases of a test report. Their names come from the job, so they are the same in every run.
    pub fn judged(&self) -> Vec<Judged> {
        let judged = |c: &ContractReport| {
            let [bound, found] = bound_and_found(c);
            let name = format!("{} {} {bound}", c.name(), c.relation.sign());
            Judged { name, found, span: c.span, holds: c.holds }
        };
        self.contracts.iter().map(judged).collect()
    }
}
