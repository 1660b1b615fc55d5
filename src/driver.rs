//! The pipeline on one page: from a job file to verified NC, stage by stage, and the only place that reads files.

mod library;
mod stages;

use crate::diag::codes::{files, syntax};
use crate::diag::{Aborted, Diag, Sink};
use crate::ir::Program;
use crate::job::Job;
use crate::source::SourceMap;
use crate::{job, lower};
pub use library::DiskFiles;
pub use stages::{Emit, Stages};
use std::path::{Path, PathBuf};

/// What a run is asked to do.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Job file.
    pub job: PathBuf,
    /// Where to write the NC text.
    pub output: Option<PathBuf>,
    /// Folder with `machines` and `tools`, before any other.
    pub library: Option<PathBuf>,
    /// Dialect instead of the job's.
    pub post: Option<String>,
    /// Print this stage value and stop there.
    pub emit: Option<Emit>,
}

/// What a run made.
#[derive(Debug, Default)]
pub struct Outcome {
    /// All texts that took part.
    pub sources: SourceMap,
    /// Everything that there is to say.
    pub sink: Sink,
    /// Stage value that was asked for, as text.
    pub emitted: Option<String>,
}

/// Compiles a job. Faults are in the sink of the outcome.
pub fn compile(options: &Options, stages: &mut Stages) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = run(options, stages, &mut outcome);
    outcome
}

fn run(options: &Options, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Aborted> {
    let Outcome { sources, sink, emitted } = outcome;
    let emit = options.emit;

    let text = read_job(&options.job, sink)?;
    let source = sources.add(options.job.display().to_string(), text.clone());
    let ast = stages.run("read", || crate::syntax::parse(&text, source, sink));
    if emit == Some(Emit::Ast) {
        *emitted = Some(crate::syntax::print::print(&ast));
        return Ok(());
    }

    let mut files = DiskFiles::new(&options.job, options.library.clone());
    let job: Job = stages.run("resolve", || job::resolve(&ast, &mut files, sources, sink))?;
    if emit == Some(Emit::Job) {
        *emitted = Some(job::print::print(&job));
        return Ok(());
    }

    let _program: Program = stages.run("lower", || lower::lower(&job, sink))?;
    Ok(())
}

/// Text of the job file.
fn read_job(path: &Path, sink: &mut Sink) -> Result<String, Aborted> {
    let shown = path.display();
    match std::fs::read(path).map(String::from_utf8) {
        Ok(Ok(text)) => return Ok(text),
        Ok(Err(error)) => sink.push(
            Diag::error(syntax::NOT_TEXT, format!("{shown} is not a text file"))
                .note(format!("byte {} is not UTF-8", error.utf8_error().valid_up_to()))
                .help("give the job file itself, a text like jobs/wei2021/wei2021.imp"),
        ),
        Err(error) => sink.push(
            Diag::error(files::CANNOT_READ, format!("{shown} cannot be read: {error}"))
                .help("check the path; `impellerc JOB -o part.nc` takes the job file first"),
        ),
    }
    Err(Aborted)
}
