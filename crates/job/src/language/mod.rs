//! What an editor asks about a text of the job language: diagnostics, words that fit a place, meanings, definitions, outline.
//!
//! Nothing here reads the disk or knows a protocol: files come through [`Files`], places are bytes of the text, and
//! [`Positions`] turns them into lines and columns of an editor.

mod complete;
mod hints;
mod names;
mod navigate;
mod positions;

pub use complete::words_at;
pub use hints::{Hint, hints};
pub use names::{definition, places, rename};
pub use navigate::{Meaning, NamedFile, Outlined, folds, meaning, named_file, outline};
pub use positions::{Position, Positions};

use crate::{Files, PartialJob};
use base::source::{SourceId, SourceMap};
use diagnostics::{Diag, Sink};
use std::ops::Range;
use syntax::ast::File;

/// A text as the front end sees it.
#[derive(Debug)]
pub struct Understood {
    /// The texts; the first one is that of the job.
    pub sources: SourceMap,
    /// Its tree.
    pub tree: File,
    /// What of the job is readable.
    pub job: PartialJob,
    /// What the front end says of it.
    pub diags: Vec<Diag>,
}

/// The text of the job in [`Understood`].
pub const JOB: SourceId = SourceId(0);

/// The bytes of the word round a place. A place inside of a letter is the beginning of the letter.
fn word_round(text: &str, at: usize, of_word: impl Fn(char) -> bool) -> Range<usize> {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    // Letters of words have one byte each.
    let start = at - text[..at].chars().rev().take_while(|c| of_word(*c)).count();
    start..at + text[at..].chars().take_while(|c| of_word(*c)).count()
}

/// Reads a text with the front end, which needs some milliseconds.
pub fn understand(name: &str, text: &str, files: &mut dyn Files) -> Understood {
    let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
    let source = sources.add(name, text);
    let tree = syntax::parse(text, source, &mut sink);
    let job = crate::understand(&tree, files, &mut sources, &mut sink);
    Understood { sources, tree, job, diags: sink.diags().to_vec() }
}
