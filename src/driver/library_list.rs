//! `impellerc machines`, `tools` and `posts`: what the library has, and where it comes from.

use super::library::Listed;
use super::{DiskFiles, Outcome, or_reported};
use base::source::Origin;
use diagnostics::codes::files;
use diagnostics::{Aborted, Diag};
use job::{Files, LibraryFile};
use std::path::Path;

/// Kind of library file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LibraryKind {
    /// Machines with their axes, limits and controls.
    Machines,
    /// End mills and holders.
    Tools,
    /// Dialects with their frames.
    Posts,
}

impl LibraryKind {
    /// The folder of the library.
    pub fn folder(self) -> &'static str {
        match self {
            Self::Machines => "machines",
            Self::Tools => "tools",
            Self::Posts => "posts",
        }
    }
}

/// The JSON schema of the files of a kind.
pub fn library_schema(kind: LibraryKind) -> String {
    let kind = match kind {
        LibraryKind::Machines => LibraryFile::Machine,
        LibraryKind::Tools => LibraryFile::Tools,
        LibraryKind::Posts => LibraryFile::Post,
    };
    format!("{:#}\n", job::library_schema(kind))
}

/// Lists the files of a kind for jobs in the working folder, or gives the text of one of them.
pub fn list_library(kind: LibraryKind, name: Option<&str>, library: Option<&Path>) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = run(kind, name, library, &mut outcome);
    outcome
}

fn run(kind: LibraryKind, name: Option<&str>, library: Option<&Path>, outcome: &mut Outcome) -> Result<(), Aborted> {
    // As for a job of the working folder.
    let mut disk = or_reported(DiskFiles::new(Path::new("job.imp"), library, None), &mut outcome.sink)?;
    let Some(name) = name else {
        let listed = disk.list(kind.folder());
        let widest = listed.iter().map(|file| file.name.chars().count()).max().unwrap_or(0);
        let line = |file: &Listed| {
            let from = file.folder.as_ref().map_or_else(|| file.origin.word().to_owned(), |f| f.display().to_string());
            format!("{:widest$}  {}\n{:widest$}  from: {from}\n", file.name, file.about, "")
        };
        outcome.emitted = Some(listed.iter().map(line).collect());
        return Ok(());
    };
    let found = match kind {
        LibraryKind::Machines => disk.machine(name),
        LibraryKind::Tools => disk.tools(name),
        LibraryKind::Posts => disk.post(name),
    };
    let file = found.map_err(|missing| {
        outcome.sink.push(
            Diag::error(files::NOT_IN_LIBRARY, format!("the library has no {}/{name}.toml", kind.folder()))
                .note(missing.reason)
                .help(format!("it has {}", missing.known.join(", "))),
        );
        Aborted
    })?;
    let from = match (&file.disk, file.origin) {
        (_, Origin::Shipped) | (None, _) => "shipped with the compiler".to_owned(),
        (Some(path), _) => path.display().to_string(),
    };
    outcome.emitted = Some(format!("# from: {from}\n{}", file.text));
    Ok(())
}
