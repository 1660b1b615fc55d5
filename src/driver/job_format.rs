//! `impellerc fmt`: jobs in their usual form.

use super::{MAX_JOB, Outcome, read_job, save, shown_path};
use crate::output::Outputs;
use ::syntax::Unformatted;
use base::source::SourceFile;
use diagnostics::codes::{files, syntax};
use diagnostics::{Aborted, Diag, Sink};
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Jobs to format.
#[derive(Clone, Debug, Default)]
pub struct Format {
    /// Job files; `-` alone is standard input, whose form goes to standard output.
    pub jobs: Vec<PathBuf>,
    /// Only tell which jobs are not in their usual form.
    pub only_check: bool,
}

/// Formats jobs. The files of jobs with faults stay as they are; the files of all others are written all together or not
/// at all.
pub fn format(options: &Format) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = run(options, &mut outcome);
    outcome
}

fn run(options: &Format, outcome: &mut Outcome) -> Result<(), Aborted> {
    let stdin = options.jobs.iter().any(|path| path == Path::new("-"));
    if stdin && options.jobs.len() > 1 {
        outcome.sink.push(
            Diag::error(files::CANNOT_READ, "standard input is not formatted together with files")
                .help("run `impellerc fmt -` for the text of standard input, and `impellerc fmt` again for the files"),
        );
        return Err(Aborted);
    }
    let mut changed: Vec<(&Path, String)> = Vec::new();
    let mut faults = false;
    for path in &options.jobs {
        match formatted(path, stdin, outcome) {
            Ok((_, after)) if stdin && !options.only_check => outcome.emitted = Some(after),
            Ok((before, after)) if before != after => changed.push((path, after)),
            Ok(_) => {}
            Err(Aborted) => faults = true,
        }
    }
    if options.only_check {
        for (path, _) in &changed {
            outcome.sink.push(
                Diag::error(syntax::NOT_FORMATTED, format!("{} is not in its usual form", shown_path(path)))
                    .help("run `impellerc fmt` on the file"),
            );
        }
    } else if let Err(fault) = written(&changed) {
        outcome.sink.push(fault);
        return Err(Aborted);
    } else if !changed.is_empty() {
        outcome.emitted = Some(changed.iter().map(|(path, _)| format!("formatted {}\n", shown_path(path))).collect());
    }
    if faults { Err(Aborted) } else { Ok(()) }
}

/// The text of a job before and after.
fn formatted(path: &Path, stdin: bool, outcome: &mut Outcome) -> Result<(String, String), Aborted> {
    let Outcome { sources, sink, .. } = outcome;
    let text = if stdin { standard_input(sink)? } else { read_job(path, sink)? };
    let name = if stdin { "standard input".to_owned() } else { shown_path(path) };
    let source = sources.add_file(SourceFile::text(name.clone(), text.clone()));
    match ::syntax::format(&text, source, sink) {
        Ok(after) => Ok((text, after)),
        Err(Unformatted::Faulty) => Err(Aborted),
        Err(Unformatted::Differs) => {
            sink.push(
                Diag::error(files::INTERNAL, format!("{name} cannot be formatted: the result would be another job"))
                    .note("the file was not changed")
                    .help("report the job to the authors of the compiler; it can be compiled as it is"),
            );
            Err(Aborted)
        }
    }
}

fn standard_input(sink: &mut Sink) -> Result<String, Aborted> {
    let mut bytes = Vec::new();
    let read = std::io::stdin().lock().take(MAX_JOB + 1).read_to_end(&mut bytes);
    let reason = match read.map_err(|e| e.to_string()).and_then(|length| {
        let within = u64::try_from(length).is_ok_and(|n| n <= MAX_JOB);
        if within { Ok(()) } else { Err(format!("it has more than {} MB", MAX_JOB >> 20)) }
    }) {
        Ok(()) => match String::from_utf8(bytes) {
            Ok(text) => return Ok(text),
            Err(e) => format!("byte {} is not UTF-8", e.utf8_error().valid_up_to()),
        },
        Err(reason) => reason,
    };
    let diag = Diag::error(files::CANNOT_READ, format!("standard input cannot be read: {reason}"));
    sink.push(diag.help("give the text of a job"));
    Err(Aborted)
}

fn written(changed: &[(&Path, String)]) -> Result<(), Diag> {
    let mut outputs = Outputs::default();
    for (path, _) in changed {
        outputs.announce("fmt", path)?;
    }
    save(outputs, changed.iter().map(|(path, text)| ("fmt", *path, text.as_bytes())))
}
