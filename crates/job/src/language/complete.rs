//! Words that fit a place. A word that no job knows is put there, and the front end says what it would have known: so
//! the words are those of the tables that the compiler uses.

use super::{JOB, understand, word_round};
use crate::Files;
use base::source::Span;
use diagnostics::Sink;
use diagnostics::codes::job as codes;
use std::ops::Range;
use syntax::ast::{Block, ItemKind, ToolSource, Value};

/// A word that is near to no word of the language.
const PROBE: &str = "zqzqzqzqzqzq";

/// Properties that the block round a byte has already, other than those that may stand in it several times. A text is read
/// while it is being written: only the names of entries on their way matter.
fn given(text: &str, at: usize) -> Vec<String> {
    let tree = syntax::parse(text, JOB, &mut Sink::default());
    let mut blocks: Vec<&Block> = tree
        .items
        .iter()
        .filter_map(|item| match &item.kind {
            ItemKind::Tool { source: ToolSource::Shape(_, body), .. }
            | ItemKind::Operation { body, .. }
            | ItemKind::Part { body, .. }
            | ItemKind::Stock { body, .. }
            | ItemKind::Post { body: Some(body), .. } => Some(body),
            _ => None,
        })
        .collect();
    let mut inner = None;
    while let Some(block) = blocks.into_iter().find(|block| block.span.range().contains(&at)) {
        inner = Some(block);
        let values = block.entries.iter().flat_map(|entry| &entry.values);
        blocks = values
            .filter_map(|value| match value {
                Value::Block(_, block) | Value::Placed(_, block) => Some(block),
                _ => None,
            })
            .collect();
    }
    let entries = inner.into_iter().flat_map(|block| &block.entries);
    let elsewhere = entries.filter(|entry| !entry.name.span.range().contains(&at) && entry.name.span.range().end != at);
    elsewhere.map(|entry| entry.name.text.clone()).filter(|name| !SEVERAL.contains(&name.as_str())).collect()
}

/// Entries that may stand in a block several times.
const SEVERAL: [&str; 2] = ["splitter", "span"];

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
    for behind in ["", " 1", " 1 mm", " q { }", " { }", " <= 1 um", " on hub \"q\""] {
        let probed = format!("{}{PROBE}{behind}{}", &text[..word.start], &text[word.end..]);
        let probe = understand("job.imp", &probed, files);
        let place = word.start..word.start + PROBE.len();
        let touches = |span: Span| {
            let range = span.range();
            span.source == JOB && range.start < place.end && place.start < range.end
        };
        let fault = probe
            .diags
            .iter()
            .find(|diag| !diag.known.is_empty() && diag.labels.first().is_some_and(|label| touches(label.span)));
        match fault {
            Some(diag) if diag.code == codes::UNKNOWN_UNIT => units.clone_from(&diag.known),
            Some(diag) => {
                let mut words = diag.known.clone();
                if diag.code == codes::UNKNOWN_PROPERTY {
                    let given = given(text, word.start);
                    words.retain(|word| !given.contains(word));
                }
                words.extend(units.into_iter().filter(|_| behind_number));
                return (word, words);
            }
            None => {}
        }
    }
    (word, units)
}
