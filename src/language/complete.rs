//! Words that fit a place. A word that no job knows is put there, and the front end is asked what it would have known: so
//! the words are those of the tables that the compiler uses.

use super::{JOB, understand};
use crate::job::Files;
use crate::source::Span;
use std::ops::Range;

/// A word that is near to no word of the language.
const PROBE: &str = "zqzqzqzqzqzq";

/// The word that is begun at a byte, and the words that the front end knows there.
pub fn words_at(text: &str, at: usize, files: &mut dyn Files) -> (Range<usize>, Vec<String>) {
    let at = at.min(text.len());
    let Some(before) = text.get(..at) else { return (at..at, Vec::new()) };
    let of_word = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '/');
    let start = at - before.chars().rev().take_while(|c| of_word(*c)).count();
    let end = at + text[at..].chars().take_while(|c| of_word(*c)).count();
    let word = start..end;
    // Behind a number stands a unit, glued to it or not.
    let begun = &text[start..at];
    let digits = begun.chars().take_while(|c| c.is_ascii_digit()).count();
    let word = if digits > 0 { start + digits..end } else { word };
    // A property needs a value, an item more than that; where these are there already, one more is a fault of another kind.
    for behind in ["", " 1", " 1 mm", " q { }"] {
        let probed = format!("{}{PROBE}{behind}{}", &text[..word.start], &text[word.end..]);
        let found = understand("job.imp", &probed, files);
        let place = word.start..word.start + PROBE.len();
        let touches = |span: Span| {
            let range = span.range();
            span.source == JOB && range.start < place.end && place.start < range.end
        };
        let known = found
            .diags
            .iter()
            .find(|diag| !diag.known.is_empty() && diag.labels.first().is_some_and(|label| touches(label.span)));
        if let Some(diag) = known {
            return (word, diag.known.clone());
        }
    }
    (word, Vec::new())
}
