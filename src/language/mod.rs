//! What an editor asks about a text of the job language: diagnostics, words that fit a place, meanings, definitions, outline.
//!
//! Nothing here reads the disk or knows a protocol: files come through [`Files`], places are bytes of the text, and
//! [`Positions`] turns them into lines and columns of an editor.

mod complete;
mod navigate;
mod positions;

pub use complete::words_at;
pub use navigate::{Meaning, Outlined, definition, folds, meaning, outline};
pub use positions::{Position, Positions};

use crate::diag::{Diag, Sink};
use crate::job::{self, Files};
use crate::source::{SourceId, SourceMap};
use crate::syntax::ast::File;
use std::ops::Range;

/// A text as the front end sees it.
#[derive(Debug)]
pub struct Understood {
    /// The texts; the first one is that of the job.
    pub sources: SourceMap,
    /// Its tree.
    pub tree: File,
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
    let tree = crate::syntax::parse(text, source, &mut sink);
    job::understand(&tree, files, &mut sources, &mut sink);
    Understood { sources, tree, diags: sink.diags().to_vec() }
}
