//! `impellerc new`: a commented job that compiles, to begin with.

use super::{Outcome, or_reported, save, shown_path};
use crate::output::Outputs;
use diagnostics::codes::files;
use diagnostics::{Aborted, Diag};
use std::path::{Path, PathBuf};

/// A job to begin with.
#[derive(Clone, Copy, Debug)]
pub struct Beginning {
    /// Its word on the command line.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    text: &'static str,
}

/// All jobs to begin with. The first one is the default.
pub const BEGINNINGS: [Beginning; 3] = [
    Beginning {
        name: "vanes",
        about: "eight ruled vanes from curves of points, all operations",
        text: include_str!("../../jobs/new/vanes.imp"),
    },
    Beginning {
        name: "pump",
        about: "a pump wheel with five long vanes, roughed with three tools",
        text: include_str!("../../jobs/pump/pump.imp"),
    },
    Beginning {
        name: "turbo",
        about: "a compressor wheel with splitters, written by angles and thicknesses",
        text: include_str!("../../jobs/splitter/splitter.imp"),
    },
];

/// Writes a job of this kind to a file that does not exist yet. Its part gets the name of the file.
pub fn new_job(file: &Path, kind: &Beginning) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = run(file, kind, &mut outcome);
    outcome
}

fn run(file: &Path, kind: &Beginning, outcome: &mut Outcome) -> Result<(), Aborted> {
    let file = or_reported(new_file(file), &mut outcome.sink)?;
    or_reported(write_new(&file, &named(kind.text, &file), &[]), &mut outcome.sink)?;
    outcome.emitted = Some(next_steps(&file, kind));
    Ok(())
}

/// The file of a new job, with the ending of a job where it has none.
///
/// # Errors
/// A file that exists.
pub(super) fn new_file(file: &Path) -> Result<PathBuf, Diag> {
    let file = if file.extension().is_none() { file.with_extension("imp") } else { file.to_path_buf() };
    if std::fs::symlink_metadata(&file).is_err() {
        return Ok(file);
    }
    Err(Diag::error(files::CANNOT_WRITE, format!("{} exists already", shown_path(&file)))
        .note("nothing was written; no file was changed")
        .help("give a name that no file has"))
}

/// Writes a job and its tables to files that do not exist, all or none.
pub(super) fn write_new(file: &Path, text: &str, tables: &[(PathBuf, String)]) -> Result<(), Diag> {
    let all = || std::iter::once((file, text)).chain(tables.iter().map(|(path, text)| (path.as_path(), text.as_str())));
    let mut outputs = Outputs::default();
    for (path, _) in all() {
        new_file(path)?;
        outputs.announce("new", path)?;
    }
    save(outputs, all().map(|(path, text)| ("new", path, text.as_bytes())))
}

/// The job with the stem of the file as the name of its part, where the stem is a name of the language.
fn named(text: &str, file: &Path) -> String {
    let stem = file.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
    let letters = stem.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !letters || !stem.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return text.to_owned();
    }
    let lines = text
        .lines()
        .map(|line| if line.starts_with("part ") { format!("part {stem} {{\n") } else { format!("{line}\n") });
    lines.collect()
}

fn next_steps(file: &Path, kind: &Beginning) -> String {
    let shown = |path: PathBuf| shown_path(&path);
    let job = shown_path(file);
    format!(
        "wrote {job}: {}\n\
         impellerc check {job}    judges text, machine and part without a plan\n\
         impellerc {job} -o {}    plans, verifies and writes the NC program\n",
        kind.about,
        shown(file.with_extension("nc")),
    )
}
