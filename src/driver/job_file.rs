//! The text of a job file, and the machine and post of the command line in the place of those of the job.

use super::reading;
use super::{DiskFiles, RunOptions};
use ::syntax::ast::{File, ItemKind};
use base::source::SourceFile;
use diagnostics::codes::{files, syntax};
use diagnostics::{Aborted, Diag, Sink};
use job::{Fault, Files, MissingFile};
use std::path::Path;

/// Largest job file, bytes. The parser refuses far smaller files, with a reason.
pub(super) const MAX_JOB: u64 = 64 << 20;

/// Text of the job file.
pub(super) fn read_job(path: &Path, sink: &mut Sink) -> Result<String, Aborted> {
    let shown = path.display();
    let with_ending = path.with_extension("imp");
    let due = if path.extension().is_none() && with_ending.is_file() {
        format!("there is a job `{}`", with_ending.display())
    } else {
        "a job is a text file; `impellerc new part.imp` writes one".to_owned()
    };
    let diag = match reading::read(path, MAX_JOB).map(|bytes| bytes.map(String::from_utf8)) {
        Ok(Some(Ok(text))) if ir::stage_file::recognise(&text) => {
            Diag::error(syntax::NOT_TEXT, format!("{shown} is a stage file, not a job"))
                .help(format!("go on from it: `impellerc --from {shown}`"))
        }
        Ok(Some(Ok(text))) => match nc::recognise(&text).filter(|_| !text.contains("edition")) {
            None => return Ok(text),
            Some(post) => Diag::error(syntax::NOT_TEXT, format!("{shown} is NC text of {}, not a job", post.name()))
                .help("give the job file: `impellerc job.imp`, or `impellerc verify part.nc --job job.imp`"),
        },
        Ok(Some(Err(error))) => Diag::error(syntax::NOT_TEXT, format!("{shown} is not a text file"))
            .note(reading::no_text(&error))
            .help("give the job file itself, a text file; `impellerc new part.imp` writes one"),
        Ok(None) => Diag::error(syntax::TOO_LARGE, format!("{shown} has more than {} MB", MAX_JOB >> 20))
            .help(format!("give the job file itself: {due}")),
        Err(error) => reading::unreadable(path, &error, &due),
    };
    sink.push(diag);
    Err(Aborted)
}

/// Machine and post of the command line in the place of those of a job.
pub(super) fn take_names(
    run: &RunOptions,
    ast: &mut File,
    library: &mut DiskFiles,
    sink: &mut Sink,
) -> Result<(), Aborted> {
    if let Some(name) = &run.machine {
        take_machine(name, ast, library, sink)?;
    }
    if let Some(name) = &run.post {
        take_post(name, ast, library, sink)?;
    }
    Ok(())
}

/// Refuses a file of the library that the command line names and that does not exist.
fn in_library(found: Result<SourceFile, MissingFile>, kind: &str, name: &str, sink: &mut Sink) -> Result<(), Aborted> {
    let Err(missing) = found else { return Ok(()) };
    let (code, fault) = match missing.fault {
        Fault::Absent => (files::NOT_IN_LIBRARY, format!("there is no {kind} file `{name}`")),
        Fault::Unreadable | Fault::Outside => (files::CANNOT_READ, format!("the {kind} file `{name}` cannot be read")),
    };
    let mut diag = Diag::error(code, fault).note(missing.reason).note(format!("required by `--{kind}`"));
    if !missing.known.is_empty() {
        diag = diag.help(format!("the {kind}s are {}", missing.known.join(", ")));
    }
    sink.push(diag);
    Err(Aborted)
}

/// Replaces the post of the job by the post of the command line. The properties of the post of the job go with it.
fn take_post(name: &str, ast: &mut File, library: &mut DiskFiles, sink: &mut Sink) -> Result<(), Aborted> {
    in_library(library.post(name), "post", name, sink)?;
    for item in &mut ast.items {
        if let ItemKind::Post { name: of_job, body } = &mut item.kind {
            name.clone_into(&mut of_job.text);
            *body = None;
        }
    }
    Ok(())
}

/// Replaces the machine of the job by the machine of the command line.
fn take_machine(name: &str, ast: &mut File, library: &mut DiskFiles, sink: &mut Sink) -> Result<(), Aborted> {
    in_library(library.machine(name), "machine", name, sink)?;
    for item in &mut ast.items {
        if let ItemKind::Use { kind, what } = &mut item.kind
            && kind.text == "machine"
        {
            name.clone_into(&mut what.text);
        }
    }
    Ok(())
}
