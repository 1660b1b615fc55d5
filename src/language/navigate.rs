//! Places of a text that belong together: names and their definitions, items, blocks.

use super::{JOB, Understood, word_round};
use crate::job::vocabulary::{self, Topic, TopicKind};
use crate::source::Span;
use crate::syntax::ast::{File, Item, ItemKind, Name, ToolSource};
use std::ops::Range;

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

/// The name that an item gives to what it states.
fn given(item: &Item) -> Option<&Name> {
    match &item.kind {
        ItemKind::Let { name, .. } | ItemKind::Tool { name, .. } => Some(name),
        ItemKind::Operation { name, .. } => name.as_ref(),
        _ => None,
    }
}

/// The bytes of the name at a place.
fn word(text: &str, at: usize) -> Range<usize> {
    word_round(text, at, |c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_'))
}

/// The item that gives the name at a place, and the bytes of the name in it.
fn named<'f>(tree: &'f File, text: &str, at: usize) -> Option<(&'f Item, Range<usize>)> {
    let word = text.get(word(text, at)).filter(|word| !word.is_empty())?;
    let mut found = tree.items.iter().filter_map(|item| Some((item, given(item)?)));
    found.find(|(_, name)| name.text == word).map(|(item, name)| (item, name.span.range()))
}

/// The bytes at which the name at a place is given.
pub fn definition(understood: &Understood, text: &str, at: usize) -> Option<Range<usize>> {
    named(&understood.tree, text, at).map(|(_, range)| range)
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
        let (item, _) = named(&understood.tree, text, at)?;
        let written = text.get(item.span.range())?;
        Some(Meaning { text: format!("```impeller\n{}\n```", written.trim_end()), range: word(text, at) })
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
        ItemKind::Tolerance(_) => (TopicKind::Item, "tolerance"),
        ItemKind::Post { .. } => (TopicKind::Item, "post"),
        _ => return None,
    };
    vocabulary::topic(kind, name)
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
