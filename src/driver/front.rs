//! From the job file to the program: text, tree, job, with the machine and the post of the command line.

use super::job_file::{read_job, take_names};
use super::{DiskFiles, Emit, Options, Outcome, Stages, open_job, or_reported, shown_path, stage_file};
use base::source::{SourceFile, SourceId};
use diagnostics::{Aborted, Sink};
use ir::Program;
use ir::stage_file::StageValue;
use job::Job;

/// The program and the value that a run begins at; `None` when the stage value to print comes before the program.
pub(super) fn start(
    options: &Options,
    stages: &mut Stages,
    outcome: &mut Outcome,
) -> Result<Option<(Program, StageValue)>, Aborted> {
    match &options.from {
        Some(path) => stage_file::read(options, path, stages, &mut outcome.sources, &mut outcome.sink).map(Some),
        None => Ok(front(options, stages, outcome)?.map(|program| (program, StageValue::Ir))),
    }
}

/// The stages from the text to the program; `None` when the stage value to print comes before the program.
///
/// # Errors
/// [`Aborted`] when the job is faulty; the faults are in the sink of the outcome.
pub fn front(options: &Options, stages: &mut Stages, outcome: &mut Outcome) -> Result<Option<Program>, Aborted> {
    let Outcome { sources, sink, emitted, .. } = outcome;

    let text = read_job(&options.job, sink)?;
    let source = sources.add_file(SourceFile {
        disk: options.job.canonicalize().ok(),
        ..SourceFile::text(shown_path(&options.job), text.clone())
    });
    let mut ast = stages.run("read", || ::syntax::parse(&text, source, sink));
    if options.emit == Some(Emit::Ast) {
        *emitted = Some(::syntax::print::print(&ast));
        return Ok(None);
    }

    if ast.is_open() && !sink.has_errors() {
        ast = open_job::completed(options, text, &ast, stages, outcome)?;
    }
    let Outcome { sources, sink, emitted, missing_files, .. } = outcome;
    let files = DiskFiles::new(&options.job, options.run.library.as_deref(), options.run.curves.as_deref());
    let mut files = or_reported(files, sink)?;
    take_names(&options.run, &mut ast, &mut files, sink)?;
    let resolved = stages.run("resolve", || job::resolve(&ast, &mut files, sources, sink));
    *missing_files = files.missing_files();
    let mut job: Job = resolved?;
    if options.run.post.is_some() {
        job.post.span = None;
    }
    if options.emit == Some(Emit::Job) {
        let text = job::print::print(&job);
        // A text of this printer has a usual form.
        let usual = ::syntax::format(&text, SourceId::default(), &mut Sink::default());
        *emitted = Some(usual.unwrap_or(text));
        return Ok(None);
    }

    let mut program: Program = stages.run("lower", || lower::lower(&job, sink))?;
    program.memory = options.run.memory.unwrap_or(program.memory);
    Ok(Some(program))
}
