//! Places of a text that belong together: names and their definitions, items, blocks.

use super::names::{self, Named};
use super::{JOB, Understood, word_round};
use crate::vocabulary::{self, Topic, TopicKind};
use base::source::Span;
use std::ops::Range;
use syntax::ast::{Block, File, Item, ItemKind, Spline, SplinePoints, ToolSource, Value};

/// What a place means, and the bytes that it holds for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Meaning {
    /// Markdown.
    pub text: String,
    /// The word.
    pub range: Range<usize>,
}

/// An item of the outline.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outlined {
    /// Its words: `operation flank`.
    pub name: String,
    /// The whole item.
    pub range: Range<usize>,
}

/// The item that gives the name at a place.
fn giver(understood: &Understood, at: usize) -> Option<&Item> {
    let place = names::definition(understood, at)?;
    understood.tree.items.iter().find(|item| item.span.range().contains(&place.start))
}

/// What stands at a place: a fault with the page of its code, or the item that gives the name.
pub fn meaning(understood: &Understood, text: &str, at: usize) -> Option<Meaning> {
    let holds = |span: &Span| span.source == JOB && span.range().contains(&at);
    let at_fault = understood.diags.iter().find_map(|diag| {
        let span = diag.labels.iter().map(|label| label.span).find(holds)?;
        let text = format!("**{}: {}**\n\n{}", diag.code.id(), diag.code.0.title, diag.code.0.page.trim_end());
        Some(Meaning { text, range: span.range() })
    });
    let by_name = || {
        let mention = names::mention_at(&understood.tree, at)?;
        let item = giver(understood, at)?;
        // A blade is as long as the part: its name says enough.
        let written = match mention.named {
            Named::Blade => format!("blade `{}` of the part", mention.name.text),
            _ => format!("```impeller\n{}\n```", text.get(item.span.range())?.trim_end()),
        };
        let value = understood.job.values.get(&mention.name.text).filter(|_| mention.named == Named::Value);
        let value = value.map_or_else(String::new, |value| format!("\n\nvalue {value}"));
        Some(Meaning { text: written + &value, range: mention.name.span.range() })
    };
    at_fault.or_else(by_name).or_else(|| of_language(&understood.tree, text, at))
}

/// What the language means by the word at a place: the property of the item there, or the word alone.
fn of_language(tree: &File, text: &str, at: usize) -> Option<Meaning> {
    let range = word_round(text, at, |c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '/' | '%'));
    let digits = text.get(range.clone())?.chars().take_while(char::is_ascii_digit).count();
    let range = range.start + digits..range.end;
    let word = text.get(range.clone()).filter(|word| !word.is_empty())?;
    let item = tree.items.iter().find(|item| item.span.range().contains(&at))?;
    let property = topic_of(item).and_then(|topic| topic.property(word)).map(|p| p.text());
    Some(Meaning { text: property.or_else(|| vocabulary::explain(word))?, range })
}

/// The topic of an item.
fn topic_of(item: &Item) -> Option<&'static Topic> {
    let (kind, name) = match &item.kind {
        ItemKind::Operation { kind, .. } => (TopicKind::Operation, kind.text.as_str()),
        ItemKind::Tool { source: ToolSource::Shape(kind, _), .. } => (TopicKind::Tool, kind.text.as_str()),
        ItemKind::Part { .. } => (TopicKind::Item, "part"),
        ItemKind::Stock { .. } => (TopicKind::Item, "stock"),
        ItemKind::Operations(_) => (TopicKind::Item, "operations"),
        ItemKind::Tolerance(_) => (TopicKind::Item, "tolerance"),
        ItemKind::Post { .. } => (TopicKind::Item, "post"),
        _ => return None,
    };
    vocabulary::topic(kind, name)
}

/// A file that the text names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NamedFile {
    /// A machine.
    Machine(String),
    /// A library of tools.
    Tools(String),
    /// A post file.
    Post(String),
    /// A tool of the libraries.
    Tool(String),
    /// A holder of the libraries.
    Holder(String),
    /// A curve of a file beside the job.
    Curve {
        /// Path beside the job.
        file: String,
        /// Name of the curve, where the text gives one.
        curve: Option<String>,
    },
}

/// The file that the text names at a place, and the bytes of the name.
pub fn named_file(tree: &File, at: usize) -> Option<(NamedFile, Range<usize>)> {
    let item = tree.items.iter().find(|item| item.span.range().contains(&at))?;
    let here = |span: Span| Some(span.range()).filter(|range| range.contains(&at));
    match &item.kind {
        ItemKind::Use { kind, what } => {
            let name = what.text.clone();
            let file = if kind.text == "machine" { NamedFile::Machine(name) } else { NamedFile::Tools(name) };
            Some((file, here(what.span)?))
        }
        ItemKind::Post { name, .. } if here(name.span).is_some() => {
            Some((NamedFile::Post(name.text.clone()), name.span.range()))
        }
        ItemKind::Tool { source: ToolSource::Library(text), .. } => {
            Some((NamedFile::Tool(text.text.clone()), here(text.span)?))
        }
        ItemKind::Tool { source: ToolSource::Shape(_, body), .. }
        | ItemKind::Part { body, .. }
        | ItemKind::Stock { body, .. } => in_block(body, at),
        _ => None,
    }
}

/// The file that an entry of a block names at a place.
fn in_block(block: &Block, at: usize) -> Option<(NamedFile, Range<usize>)> {
    let entry = block.entries.iter().find(|entry| entry.span.range().contains(&at))?;
    entry.values.iter().find_map(|value| match value {
        Value::Block(_, inner) | Value::Placed(_, inner) => in_block(inner, at),
        Value::Text(text) if entry.name.text == "holder" && text.span.range().contains(&at) => {
            Some((NamedFile::Holder(text.text.clone()), text.span.range()))
        }
        Value::Spline(Spline { points: SplinePoints::File { file, curve }, .. })
        | Value::Loop(Spline { points: SplinePoints::File { file, curve }, .. }) => {
            let span = [file.span, curve.span].into_iter().find(|span| span.range().contains(&at))?;
            Some((NamedFile::Curve { file: file.text.clone(), curve: Some(curve.text.clone()) }, span.range()))
        }
        Value::Loops { file, .. } if file.span.range().contains(&at) => {
            Some((NamedFile::Curve { file: file.text.clone(), curve: None }, file.span.range()))
        }
        _ => None,
    })
}

/// The items in the order of the text.
pub fn outline(tree: &File) -> Vec<Outlined> {
    let name = |item: &Item| match &item.kind {
        ItemKind::Edition(name) => format!("edition {}", name.text),
        ItemKind::Use { kind, what } => format!("use {} {}", kind.text, what.text),
        ItemKind::Let { name, .. } => format!("let {}", name.text),
        ItemKind::Part { name, .. } => format!("part {}", name.text),
        ItemKind::Stock { kind, .. } => format!("stock {}", kind.text),
        ItemKind::Tool { name, source: ToolSource::Shape(kind, _) } => format!("tool {} ({})", name.text, kind.text),
        ItemKind::Tool { name, .. } => format!("tool {}", name.text),
        ItemKind::Operation { kind, name: Some(name), .. } => format!("operation {} {}", kind.text, name.text),
        ItemKind::Operation { kind, .. } => format!("operation {}", kind.text),
        ItemKind::Operations(word) => format!("operations {}", word.text),
        ItemKind::Tolerance(_) => "tolerance".to_owned(),
        ItemKind::Require { what, .. } => format!("require {}", what.text),
        ItemKind::Allow { what, .. } => format!("allow {}", what.text),
        ItemKind::Post { name, .. } => format!("post {}", name.text),
    };
    tree.items.iter().map(|item| Outlined { name: name(item), range: item.span.range() }).collect()
}

/// Bytes of brackets that are closed on a later line, from the opening to the closing one.
pub fn folds(text: &str) -> Vec<Range<usize>> {
    let (mut open, mut found) = (Vec::new(), Vec::new());
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let mut quoted = false;
        for (at, letter) in line.char_indices() {
            quoted ^= letter == '"';
            if quoted {
                continue;
            }
            if line[at..].starts_with("//") {
                break;
            }
            match letter {
                '{' | '[' => open.push(start + at),
                '}' | ']' => {
                    let from = open.pop().filter(|from| text[*from..start + at].contains('\n'));
                    found.extend(from.map(|from| from..start + at));
                }
                _ => {}
            }
        }
        start += line.len();
    }
    found
}
