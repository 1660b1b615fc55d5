//! The words of the language: items, operations, tools, their properties, and units. The compiler takes the names that it
//! accepts from these tables; `explain`, the hover of editors and the reference page print them.

pub(crate) mod items;
pub(crate) mod operations;
pub(crate) mod other_names;
pub(crate) mod part;
mod tools;

use crate::property::property;
use crate::property::quantity::{Dimension, JOB_UNITS};
pub use crate::property::{Form, Property, Without};
use std::fmt::Write as _;
use wheel::contract::ContractKind;

/// What a topic is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TopicKind {
    /// An item of a job.
    Item,
    /// A block of the part or of the stock.
    Block,
    /// A kind of tool.
    Tool,
    /// A kind of operation.
    Operation,
}

impl TopicKind {
    /// All kinds with their titles, in the order of the reference.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::Item, "Items"),
        (Self::Block, "Blocks of the part and the stock"),
        (Self::Tool, "Tools"),
        (Self::Operation, "Operations"),
    ];
}

/// An item, a block, a kind of tool or of operation.
#[derive(Clone, Copy, Debug)]
pub struct Topic {
    /// Its word.
    pub name: &'static str,
    /// What it is.
    pub kind: TopicKind,
    /// Meaning.
    pub meaning: &'static str,
    /// A text that compiles in its place.
    pub example: &'static str,
    /// Properties, in groups that topics share.
    pub properties: &'static [&'static [Property]],
}

const fn topic_of(
    kind: TopicKind,
    name: &'static str,
    meaning: &'static str,
    example: &'static str,
    properties: &'static [&'static [Property]],
) -> Topic {
    Topic { name, kind, meaning, example, properties }
}

/// All topics.
pub fn topics() -> impl Iterator<Item = &'static Topic> {
    [items::TOPICS, part::TOPICS, tools::TOPICS, operations::TOPICS].into_iter().flatten()
}

/// The topic of a kind with this name.
pub fn topic(kind: TopicKind, name: &str) -> Option<&'static Topic> {
    topics().find(|t| t.kind == kind && t.name == name)
}

impl Topic {
    /// Its properties.
    pub fn all(&self) -> impl Iterator<Item = &'static Property> {
        self.properties.iter().copied().flatten().filter(|p| p.is_of(self.name))
    }

    /// The property with this name.
    pub fn property(&self, name: &str) -> Option<&'static Property> {
        self.all().find(|p| p.name == name)
    }
}

/// Names of the topics of a kind.
pub(super) fn names(kind: TopicKind) -> Vec<&'static str> {
    topics().filter(|t| t.kind == kind).map(|t| t.name).collect()
}

/// Names of the properties of a topic; none where there is no such topic.
pub(super) fn properties(kind: TopicKind, name: &str) -> Vec<&'static str> {
    topic(kind, name).into_iter().flat_map(Topic::all).map(|p| p.name).collect()
}

/// The text on a word: of each topic and property with this name, or of a unit. `None` for other words.
pub fn explain(word: &str) -> Option<String> {
    let mut pages: Vec<String> = topics().filter(|t| t.name == word).map(page).collect();
    // A property that several topics share is described once for all of them.
    let mut known: Vec<(&Property, Vec<&str>)> = Vec::new();
    for topic in topics() {
        let Some(property) = topic.property(word) else { continue };
        match known.iter_mut().find(|(other, _)| other.text() == property.text()) {
            Some((_, of)) => of.push(topic.name),
            None => known.push((property, vec![topic.name])),
        }
    }
    pages.extend(known.into_iter().map(|(p, of)| {
        format!("`{}`, a property of {}\n\n  {}\n  {}\n", p.name, of.join(", "), p.value_and_default(), p.meaning)
    }));
    pages.extend(ContractKind::ALL.into_iter().filter(|k| k.quantity() == word).take(1).map(quantity));
    pages.extend(JOB_UNITS.iter().find(|u| u.0 == word).map(|u| unit(word, u.2)));
    (!pages.is_empty()).then(|| pages.join("\n"))
}

/// All words that [`explain`] knows.
pub fn words() -> Vec<&'static str> {
    let mut all: Vec<&str> = topics().flat_map(|t| std::iter::once(t.name).chain(t.all().map(|p| p.name))).collect();
    all.extend(ContractKind::ALL.map(ContractKind::quantity));
    all.extend(JOB_UNITS.iter().map(|u| u.0));
    all.sort_unstable();
    all.dedup();
    all
}

/// The text on a topic.
fn page(topic: &Topic) -> String {
    let mut text = format!("`{}`{}: {}\n", topic.name, article(topic.kind), topic.meaning);
    let width = topic.all().map(|p| p.name.len()).max().unwrap_or(0);
    if width > 0 {
        text.push('\n');
    }
    for p in topic.all() {
        // Writing to a string does not fail.
        let _ = writeln!(text, "  {:<width$}  {}\n  {:<width$}  {}", p.name, p.value_and_default(), "", p.meaning);
    }
    text.push_str("\nExample:\n\n");
    for line in topic.example.lines() {
        let _ = writeln!(text, "  {line}");
    }
    text
}

fn article(kind: TopicKind) -> &'static str {
    match kind {
        TopicKind::Item => ", an item of a job",
        TopicKind::Block => ", a block",
        TopicKind::Tool => ", a kind of tool",
        TopicKind::Operation => ", an operation",
    }
}

/// The text on a quantity of contracts.
fn quantity(kind: ContractKind) -> String {
    let bound = kind
        .default_bound()
        .map_or_else(String::new, |b| format!("; without a contract {} {b}", kind.relation().sign()));
    format!(
        "`{}`, a quantity of `require` and `allow`: {}{bound}\n\nExample:\n\n  require {}\n",
        kind.quantity(),
        kind.meaning(),
        kind.usual()
    )
}

/// The text on a unit.
fn unit(name: &str, dimension: Dimension) -> String {
    let of = if dimension == Dimension::NONE { "a share".to_owned() } else { dimension.name() };
    format!("`{name}`, a unit of {of}; the units of {of}: {}\n", dimension.units().join(", "))
}

/// The reference of the language, as a page of the documents.
pub fn reference() -> String {
    let mut text = String::from(
        "# Reference of the language\n\n`impellerc explain --reference` writes this page from the tables of the compiler. \
         [language.md](language.md) introduces the language.\n",
    );
    for (kind, title) in TopicKind::ALL {
        let _ = write!(text, "\n## {title}\n");
        for topic in topics().filter(|t| t.kind == kind) {
            // A block, and a form with `...`, is no job.
            let form = kind == TopicKind::Block || topic.example.contains("...");
            let [open, close] = if form { ["`", "`"] } else { ["```\n", "\n```"] };
            let _ = write!(text, "\n### `{}`\n\n{}\n\n{open}{}{close}\n", topic.name, topic.meaning, topic.example);
            if topic.all().next().is_some() {
                text.push_str("\n| property | value | without it | meaning |\n|---|---|---|---|\n");
            }
            for p in topic.all() {
                let without = match p.without {
                    Without::Required => "required".to_owned(),
                    Without::Is(value) => format!("`{value}`"),
                    Without::Means(words) => words.to_owned(),
                    Without::Nothing => "-".to_owned(),
                };
                let _ = writeln!(text, "| `{}` | {} | {without} | {} |", p.name, p.value(), p.meaning);
            }
        }
    }
    text.push_str(
        "\n## Quantities of `require` and `allow`\n\n| quantity | without a contract | meaning |\n|---|---|---|\n",
    );
    for kind in ContractKind::ALL {
        let bound =
            kind.default_bound().map_or_else(|| "not judged".to_owned(), |b| format!("{} {b}", kind.relation().sign()));
        let _ = writeln!(text, "| `{}` | {bound} | {} |", kind.name(), kind.meaning());
    }
    text.push_str("\n## Units\n\n| quantity | units |\n|---|---|\n");
    let mut dimensions: Vec<Dimension> = Vec::new();
    for (_, _, dimension) in JOB_UNITS {
        if !dimensions.contains(dimension) {
            dimensions.push(*dimension);
        }
    }
    for dimension in dimensions {
        let units: Vec<String> = dimension.units().iter().map(|u| format!("`{u}`")).collect();
        let _ = writeln!(
            text,
            "| {} | {} |",
            if dimension == Dimension::NONE { "a share".to_owned() } else { dimension.name() },
            units.join(", ")
        );
    }
    text
}
