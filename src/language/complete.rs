//! Words that fit a place. A word that no job knows is put there, and the front end is asked what it would have known: so
//! the words are those of the tables that the compiler uses.

use super::{JOB, understand, word_round};
use crate::diag::codes::job as codes;
use crate::job::Files;
use crate::source::Span;
use std::ops::Range;

/// A word that is near to no word of the language.
const PROBE: &str = "zqzqzqzqzqzq";

/// The word that is begun at a byte, and the words that the front end knows there.
pub fn words_at(text: &str, at: usize, files: &mut dyn Files) -> (Range<usize>, Vec<String>) {
    let word = word_round(text, at, |c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '/'));
    // Behind a number stands a unit, glued to it or not.
    let digits = text[word.start..at.clamp(word.start, word.end)].chars().take_while(char::is_ascii_digit).count();
    let word = word.start + digits..word.end;
    // A property needs a value, an item more than that; where these are there already, one more is a fault of another kind.
    // Behind a bare number a word reads as its unit, also where the number is a count and the next property is begun.
    let mut units: Vec<String> = Vec::new();
    let behind_number = text[..word.start].trim_end_matches(' ').ends_with(|c: char| c.is_ascii_digit());
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
        match known {
            Some(diag) if diag.code == codes::UNKNOWN_UNIT => units.clone_from(&diag.known),
            Some(diag) => {
                let mut words = diag.known.clone();
                words.extend(units.into_iter().filter(|_| behind_number));
                return (word, words);
            }
            None => {}
        }
    }
    (word, units)
}
