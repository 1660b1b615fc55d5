//! `impellerc verify`: NC text against its job.

use super::{Options, Outcome, Stages, find_post, front};
use crate::diag::codes::{files, post as codes};
use crate::diag::{Aborted, Diag, Sink};
use crate::ir::Program;
use crate::post::Post;
use crate::post::motion_of::{NcMotion, motion_of};
use crate::source::{SourceId, SourceMap, Span};
use crate::verify;
use std::path::{Path, PathBuf};

/// What a check of NC text is asked to do.
#[derive(Clone, Debug, Default)]
pub struct NcCheck {
    /// NC text.
    pub nc: PathBuf,
    /// Job that it must fulfil.
    pub job: Option<PathBuf>,
    /// Folder with `machines` and `tools`, before any other.
    pub library: Option<PathBuf>,
    /// Dialect of the text instead of the job's.
    pub post: Option<String>,
    /// Certificate that the text must belong to.
    pub certificate: Option<PathBuf>,
}

/// Largest NC text, bytes.
const MAX_BYTES: u64 = 256 << 20;

/// Checks NC text. Faults are in the sink of the outcome; its text is the certificate as measured.
pub fn verify(check: &NcCheck, stages: &mut Stages) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = run(check, stages, &mut outcome);
    outcome
}

fn run(check: &NcCheck, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Aborted> {
    let Some(job) = &check.job else {
        outcome.sink.push(
            Diag::error(codes::USAGE, "neither a job nor a certificate is given")
                .help("add `--job job.imp`, `--certificate part.json`, or both"),
        );
        return Err(Aborted);
    };
    let text = read_nc(&check.nc, &mut outcome.sink)?;
    let options =
        Options { job: job.clone(), library: check.library.clone(), post: check.post.clone(), ..Options::default() };
    let Some(program) = front(&options, stages, outcome)? else { return Err(Aborted) };
    let Outcome { sources, sink, emitted } = outcome;
    let post = find_post(&program, sink)?;
    let shown = check.nc.display().to_string();
    let source = sources.add(shown.clone(), text);
    let motion = stages.run("read NC", || read_motion(post, &program, sources, source, sink))?;
    let before = sink.clone();
    let certificate = stages.run("verify", || verify::certify(&program, &motion.motion, sink))?;
    let known = before.diags().len();
    let mut index = 0;
    sink.map(|diag| {
        index += 1;
        if index > known { with_line(diag, &program, &motion, sources, source, &shown) } else { diag }
    });
    let mut text = certificate.text(&program, &motion.motion);
    let moves: usize = motion.lines.iter().map(Vec::len).sum();
    text.push_str(&format!("\n{shown}: {moves} moves read as {}\n", post.name()));
    *emitted = Some(text);
    Ok(())
}

/// The motion that a text says.
fn read_motion(
    post: &dyn Post,
    program: &Program,
    sources: &SourceMap,
    source: SourceId,
    sink: &mut Sink,
) -> Result<NcMotion, Aborted> {
    let text = sources.get(source).map_or("", |f| f.text.as_str());
    let span = |line: usize| sources.line_span(source, line).unwrap_or(Span::new(source, 0..0));
    let moves = post.read(text, &program.machine).map_err(|faults| {
        for fault in faults {
            sink.push(
                Diag::error(codes::NC_BLOCK, format!("line {} is not understood: {}", fault.line, fault.reason))
                    .label(span(fault.line), "this block")
                    .help(format!("correct the block, or name the dialect: `--post`; it was read as {}", post.name())),
            );
        }
        Aborted
    })?;
    motion_of(program, &moves, &span, sink).ok_or(Aborted)
}

/// A finding with the NC block that makes it in front, and the job line of its operation behind.
fn with_line(
    mut diag: Diag,
    program: &Program,
    motion: &NcMotion,
    sources: &SourceMap,
    source: SourceId,
    shown: &str,
) -> Diag {
    let Some((operation, index)) = diag.place.as_ref().and_then(|p| p.block) else { return diag };
    let Some(line) = motion.line(operation, index) else { return diag };
    if let Some(place) = &mut diag.place {
        place.what = format!("{shown} line {line}: {}", place.what);
    }
    if let Some(made) = motion.motion.operations.get(operation as usize) {
        let span = program.operations[made.operation].span;
        if diag.labels.iter().all(|l| l.span != span) {
            diag = diag.label(span, "in this operation");
        }
    }
    if let Some(span) = sources.line_span(source, line) {
        let label = crate::diag::Label { span, text: "this block".to_owned() };
        diag.labels.insert(0, label);
    }
    diag
}

/// The NC text.
fn read_nc(path: &Path, sink: &mut Sink) -> Result<String, Aborted> {
    let shown = path.display();
    let help = "give the NC text that the control would run";
    let size = std::fs::metadata(path).map(|m| m.len());
    let diag = match size.and_then(|size| if size > MAX_BYTES { Ok(None) } else { std::fs::read(path).map(Some) }) {
        Ok(Some(bytes)) => match String::from_utf8(bytes) {
            Ok(text) => return Ok(text),
            Err(error) => {
                let valid = error.utf8_error().valid_up_to();
                let line = error.as_bytes().iter().take(valid).filter(|b| **b == b'\n').count() + 1;
                Diag::error(codes::NC_FILE, format!("{shown} is not a text file: line {line} is not UTF-8")).help(help)
            }
        },
        Ok(None) => Diag::error(codes::NC_FILE, format!("{shown} is larger than {} MB", MAX_BYTES >> 20))
            .help("split the program by operations, or write it with fewer digits or comments"),
        Err(error) => {
            Diag::error(files::CANNOT_READ, format!("{shown} cannot be read: {error}")).help("check the path")
        }
    };
    sink.push(diag);
    Err(Aborted)
}
