//! Files of a reader: the caller gives them, the reader sees their texts.

use super::lines::Text;
use base::source::{SourceFile, SourceId, SourceMap, Span};
use diagnostics::codes::{files, import as codes};
use diagnostics::{Diag, printable};

/// Why there is no file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoFile {
    /// It cannot be read, for this reason.
    Unreadable(String),
    /// It has more bytes than the limit. It was not read.
    TooLarge,
}

impl From<String> for NoFile {
    fn from(reason: String) -> Self {
        Self::Unreadable(reason)
    }
}

/// Gives the file of a path with at most so many bytes, or the reason why there is none.
pub type Fetch<'a> = dyn FnMut(&str, usize) -> Result<SourceFile, NoFile> + 'a;

/// Loads files and keeps their texts.
pub(super) struct Loader<'a> {
    fetch: &'a mut Fetch<'a>,
    sources: &'a mut SourceMap,
    bytes: usize,
    /// Most bytes of all files together.
    most: usize,
}

impl<'a> Loader<'a> {
    pub(super) fn new(fetch: &'a mut Fetch<'_>, most: usize, sources: &'a mut SourceMap) -> Self {
        Self { fetch, sources, bytes: 0, most }
    }

    /// Loads a file that the caller gives, or that a line names.
    pub(super) fn load(&mut self, name: &str, named_at: Option<Span>) -> Result<SourceId, Diag> {
        let at = |diag: Diag, what: &str| match named_at {
            Some(span) => diag.label(span, what),
            None => diag.note(what.to_owned()),
        };
        let too_large = |message: String, what: &str| {
            at(Diag::error(codes::TOO_MUCH, message), what)
                .help("export fewer points or sections; sections of smooth blades need some hundred points")
        };
        let file = (self.fetch)(name, self.most).map_err(|fault| match fault {
            NoFile::Unreadable(reason) => {
                at(Diag::error(files::CANNOT_READ, format!("the file `{}` cannot be read", printable(name))), &reason)
                    .help("give the path of the file; a file that another one names lies beside it")
            }
            NoFile::TooLarge => {
                let message = format!("the file `{}` has more than {} MB, the limit", printable(name), self.most >> 20);
                too_large(message, "it was not read")
            }
        })?;
        self.bytes = self.bytes.saturating_add(file.text.len());
        if self.bytes > self.most {
            let message = format!("the blade files have more than {} MB together, the limit", self.most >> 20);
            return Err(too_large(message, "with this file"));
        }
        Ok(self.sources.add_file(file))
    }

    /// Loads a file from the folder of another one.
    pub(super) fn in_same_folder(&mut self, other: SourceId, name: &str, named_at: Span) -> Result<SourceId, Diag> {
        let own = self.name(other).replace('\\', "/");
        let name = name.replace('\\', "/");
        let path = match own.rsplit_once('/') {
            Some((folder, _)) if !name.starts_with('/') => format!("{folder}/{name}"),
            _ => name,
        };
        self.load(&path, Some(named_at))
    }

    /// Name of a file as the caller gave it.
    pub(super) fn name(&self, id: SourceId) -> &str {
        self.sources.get(id).map_or("", |file| &file.name)
    }

    /// Text of a file.
    pub(super) fn text(&self, id: SourceId) -> Text<'_> {
        Text::new(id, self.sources.get(id).map_or("", |file| &file.text))
    }
}
