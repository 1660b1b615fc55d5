//! Runs that begin at a stage file, and the stage files that runs write.

use super::file_form::Form;
use super::{Emit, Options, Stages, or_reported, output_names, reading, shown_path};
use crate::output::Outputs;
use base::source::{SourceFile, SourceMap, Span};
use diagnostics::codes::files;
use diagnostics::{Aborted, Diag, Sink};
use ir::Program;
use ir::stage_file::{self, StageFault, StageFile, StageValue, VERSION};
use std::path::Path;

/// Largest stage file, bytes: that of a million moves has 300 MB.
const MAX_STAGE_FILE_BYTES: u64 = 1 << 30;

/// How a stage file is made.
const DUE: &str = "write it from the job: `impellerc job.imp --emit motion --format json -o motion.json`";

/// The program and the value of a stage file; the texts of its job go to `sources`.
///
/// # Errors
/// A file that is no stage file, or a stage behind the one that is to be printed; the reason is in the sink.
pub(super) fn read(
    options: &Options,
    path: &Path,
    stages: &mut Stages,
    sources: &mut SourceMap,
    sink: &mut Sink,
) -> Result<(Program, StageValue), Aborted> {
    let text = stages.run("read", || text(path));
    let text = or_reported(text, sink)?;
    let found = stages.run("check", || stage_file::read(&text));
    let StageFile { sources: files, mut program, value } = match found {
        Ok(file) => file,
        Err(fault) => {
            sink.push(refused(path, text, fault, sources));
            return Err(Aborted);
        }
    };
    if let Some(fault) = options.emit.and_then(|emit| behind(emit, &value, path)) {
        sink.push(fault);
        return Err(Aborted);
    }
    for file in files {
        sources.add_file(file);
    }
    program.memory = options.run.memory.unwrap_or(program.memory);
    Ok((program, value))
}

/// Text of a stage file.
fn text(path: &Path) -> Result<String, Diag> {
    let shown = shown_path(path);
    match reading::read(path, MAX_STAGE_FILE_BYTES).map(|bytes| bytes.map(String::from_utf8)) {
        Ok(Some(Ok(text))) => Ok(text),
        Ok(Some(Err(error))) => Err(Diag::error(files::STAGE_FILE, format!("{shown} is no stage file"))
            .note(reading::no_text(&error))
            .help(DUE)),
        Ok(None) => {
            Err(Diag::error(files::STAGE_FILE, format!("{shown} has more than {} MB", MAX_STAGE_FILE_BYTES >> 20))
                .help(DUE))
        }
        Err(error) => Err(reading::unreadable(path, &error, "give the file that `--emit STAGE --format json` wrote")),
    }
}

/// The diagnostic for a text that is no stage file; the text goes to `sources`, for the place.
fn refused(path: &Path, text: String, fault: StageFault, sources: &mut SourceMap) -> Diag {
    let shown = shown_path(path);
    let refused = |message: String| Diag::error(files::STAGE_FILE, message);
    match fault {
        StageFault::Other => refused(format!("{shown} is no stage file, but another JSON text")).help(DUE),
        StageFault::Version(version) => refused(format!(
            "{shown} has version {version} of the stage files, and this program reads version {VERSION}"
        ))
        .help(DUE),
        StageFault::Malformed(reason) => {
            refused(format!("{shown} holds what no run writes: {reason}")).help(format!("{DUE}, and do not change it"))
        }
        StageFault::Damaged { .. } if !text.trim_start().starts_with('{') => {
            let job = "a job is compiled without `--from`: `impellerc job.imp`";
            refused(format!("{shown} is no stage file: it does not begin with `{{`")).help(format!("{DUE}; {job}"))
        }
        StageFault::Damaged { at, reason } => {
            let source = sources.add_file(SourceFile::text(shown.clone(), text));
            refused(format!("{shown} is damaged"))
                .label(Span::new(source, at..at + 1), reason)
                .help(format!("{DUE}, and do not change it"))
        }
    }
}

/// The fault of a stage to print that lies before the one of the file.
fn behind(emit: Emit, value: &StageValue, path: &Path) -> Option<Diag> {
    let too_early = match emit {
        Emit::Ast | Emit::Job => true,
        Emit::Cc => matches!(value, StageValue::Cl(_) | StageValue::Motion(_)),
        Emit::Cl => matches!(value, StageValue::Motion(_)),
        Emit::Ir | Emit::Motion | Emit::Nc | Emit::Part(_) => false,
    };
    let message = || format!("{} begins at `{}`, behind the stage that `--emit` names", shown_path(path), value.name());
    too_early.then(|| Diag::error(files::STAGE_FILE, message()).help("give the job, or a file of an earlier stage"))
}

/// Writes the value of a stage to the file of `-o`; returns what was written, or the value itself where no file is named.
pub(super) fn write(
    options: &Options,
    program: &Program,
    value: &StageValue,
    sources: &SourceMap,
    sink: &mut Sink,
) -> Result<String, Aborted> {
    let text = stage_file::write(sources, program, value).map_err(|reason| {
        Diag::error(files::INTERNAL, format!("the stage file cannot be written: {reason}"))
            .help("report the job file: this is a fault of the compiler")
    });
    let text = or_reported(text, sink)?;
    let Some(path) = &options.output else { return Ok(text) };
    let mut outputs = Outputs::default();
    protect(options, &mut outputs);
    outputs.protect_sources(sources);
    or_reported(output_names::check("-o", path, Form::Json), sink)?;
    or_reported(outputs.stage("-o", path, text.as_bytes()), sink)?;
    or_reported(outputs.commit(), sink)?;
    Ok(format!("wrote {}: stage {}, {} bytes\n", shown_path(path), value.name(), text.len()))
}

/// Adds the stage file that the run begins at.
pub(super) fn protect(options: &Options, outputs: &mut Outputs) {
    if let Some(path) = &options.from {
        outputs.protect("the stage file", path);
    }
}
