//! Tools of the job, from the library or described in the job.

use crate::block::context::{Context, head};
use crate::block::eval::{suggest, unknown};
use crate::block::properties::Properties;
use crate::library::tool_file::ToolLibrary;
use crate::model::tool::{PROPERTIES, Sizes, shape_fault};
use crate::model::{OperationSpec, ToolSpec};
use crate::vocabulary::{self, TopicKind};
use base::source::Span;
use base::units::Mm;
use diagnostics::codes::job as codes;
use diagnostics::{Diag, Sink};
use std::collections::{BTreeMap, BTreeSet};
use syntax::ast::{Block, Entry, File, Item, ItemKind, Name, ToolSource, Value};

/// A declared tool; `spec` is `None` when its declaration is faulty.
pub(crate) struct Declared {
    pub(crate) name: Name,
    pub(crate) spec: Option<ToolSpec>,
}

pub(crate) fn resolve(file: &File, library: &ToolLibrary, cx: &mut Context<'_>) -> Vec<Declared> {
    let mut tools: Vec<Declared> = Vec::new();
    let mut names: BTreeMap<&str, Span> = BTreeMap::new();
    let mut numbers: BTreeMap<u32, Span> = BTreeMap::new();
    for item in &file.items {
        let ItemKind::Tool { name, source } = &item.kind else { continue };
        if let Some(first) = names.get(name.text.as_str()) {
            cx.sink.push(
                Diag::error(codes::GIVEN_TWICE, format!("the tool `{}` is declared twice", name.text))
                    .label(name.span, "declared again")
                    .label(*first, "first declared here")
                    .help(format!("give the second tool another name, such as `{}`", free_name(&name.text, file))),
            );
            // The name that was meant is missing elsewhere; that is the same fault.
            cx.scope.damaged = true;
            continue;
        }
        names.insert(&name.text, name.span);
        let spec = match source {
            ToolSource::Library(text) => {
                let found = library.tools.get(&text.text).cloned();
                if found.is_none() && !library.faulty {
                    let inner = Span { start: text.span.start + 1, end: text.span.end.saturating_sub(1), ..text.span };
                    let known = library.tools.keys().map(String::as_str);
                    let mut diag = unknown(&text.text, inner, "library tool", known);
                    if library.tools.is_empty() {
                        diag = diag.help("name a tool library first: `use tools \"carbide\"`");
                    }
                    cx.sink.push(diag);
                }
                found
            }
            ToolSource::Shape(kind, block) => shape(name, kind, block, head(item), library, cx),
        };
        let order = u32::try_from(tools.len()).unwrap_or(u32::MAX);
        let spec = spec.map(|mut spec| {
            if spec.number == 0 {
                spec.number = order + 1;
            }
            ToolSpec { name: name.text.clone(), span: head(item), ..spec }
        });
        if let Some(spec) = &spec
            && let Some(other) = numbers.insert(spec.number, name.span)
        {
            // The first tool keeps its number.
            numbers.insert(spec.number, other);
            cx.sink.push(
                Diag::error(codes::GIVEN_TWICE, format!("two tools have the number {}", spec.number))
                    .label(name.span, format!("number {}", spec.number))
                    .label(other, "the same number")
                    .help("give each tool its own number: `number 7`"),
            );
        }
        tools.push(Declared { name: name.clone(), spec });
    }
    if tools.is_empty() && !file.damaged && !file.is_open() {
        cx.sink.push(
            Diag::error(codes::MISSING_ITEM, "the job has no tool")
                .help("add `tool t1 = ball { diameter 6 mm  flutes 4  flute 30 mm  reach 40 mm }`"),
        );
    }
    tools
}

/// Warns of tools that no operation uses.
pub(crate) fn warn_unused(tools: &[Declared], operations: &[OperationSpec], sink: &mut Sink) {
    let used: BTreeSet<usize> = operations.iter().map(|o| o.tool).collect();
    for (at, tool) in tools.iter().enumerate() {
        if !used.contains(&at) {
            sink.push(
                Diag::warning(codes::UNUSED, format!("the tool `{}` is not used", tool.name.text))
                    .label(tool.name.span, "declared here")
                    .help("remove the tool, or use it in an operation"),
            );
        }
    }
}

/// A name that no tool has: `t1` becomes `t2`, `t3` and so on.
fn free_name(name: &str, file: &File) -> String {
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let taken = |text: &str| {
        let of = |item: &Item| matches!(&item.kind, ItemKind::Tool { name, .. } if name.text == text);
        file.items.iter().any(of)
    };
    (2..).map(|n| format!("{stem}{n}")).find(|text| !taken(text)).unwrap_or_default()
}

/// Names of the properties that tools of a kind may have.
fn known(kind: &str) -> Vec<&'static str> {
    let mut known = vocabulary::properties(TopicKind::Tool, kind);
    // `flute` of a lollipop has a message of its own.
    if kind == "lollipop" {
        known.push("flute");
    }
    known
}

/// A tool that the job describes.
fn shape(
    name: &Name,
    kind: &Name,
    block: &Block,
    head: Span,
    library: &ToolLibrary,
    cx: &mut Context<'_>,
) -> Option<ToolSpec> {
    let kinds = vocabulary::names(TopicKind::Tool);
    if !kinds.contains(&kind.text.as_str()) {
        let diag =
            Diag::error(codes::NOT_IN_LANGUAGE, format!("tools of the kind `{}` are not in the language", kind.text));
        cx.sink.push(suggest(diag, &kind.text, kind.span, "kind of tool", &kinds));
        return None;
    }
    let owner = format!("tool {}", name.text);
    let mut p = Properties::new(owner, head, block, &known(&kind.text), &mut cx.scope, cx.sink);
    let mut sizes = Sizes::default();
    let mut whole = true;
    for property in PROPERTIES.iter().filter(|property| property.is_of(&kind.text)) {
        match p.read(property) {
            Some(Some((value, _))) => sizes.add(property.name, value),
            Some(None) => {}
            None => whole = false,
        }
    }
    no_flute(name, kind, &mut p);
    let holder = holder(library, &mut p)?;
    let spec = ToolSpec { holder, span: head, ..ToolSpec::of(&kind.text, &sizes).filter(|_| whole)? };
    if let Some(fault) = shape_fault(&spec) {
        let named = |entry: &&Entry| fault.contains(entry.name.text.as_str());
        let faulty = block.entries.iter().filter(named).min_by_key(|entry| fault.find(entry.name.text.as_str()));
        let end = |entry: &Entry| entry.values.last().map_or(entry.name.span.end, |value| value.span().end);
        let faulty = faulty.map(|entry| Span { end: end(entry), ..entry.name.span });
        cx.sink.push(
            Diag::error(codes::OUT_OF_RANGE, format!("tool {}: {fault}", name.text))
                .label(faulty.unwrap_or(block.span), "this size contradicts another one")
                .help("correct this size, or the one that the message compares it with"),
        );
        return None;
    }
    Some(spec)
}

/// Refuses `flute` of a lollipop, whose flutes end at the neck.
fn no_flute(name: &Name, kind: &Name, p: &mut Properties<'_, '_>) {
    if kind.text != "lollipop" {
        return;
    }
    if let Some((word, _)) = p.take("flute") {
        p.sink.push(
            Diag::error(
                codes::UNKNOWN_PROPERTY,
                format!("{} has `flute`, but the flutes of a lollipop end at its neck", name.text),
            )
            .label(word.span, "not for a lollipop")
            .help("remove `flute`; `neck` determines where the ball ends"),
        );
    }
}

/// Outer `None`: faulty; inner `None`: the tool has no holder.
fn holder(library: &ToolLibrary, p: &mut Properties<'_, '_>) -> Option<Option<(String, Vec<[Mm; 3]>)>> {
    let Some((word, values)) = p.take("holder") else { return Some(None) };
    let [Value::Text(text)] = values.as_slice() else {
        p.wrong_form(word.span, "holder", "a quoted name", "holder \"er16-mini\"");
        return None;
    };
    if let Some(sections) = library.holders.get(&text.text) {
        return Some(Some((text.text.clone(), sections.clone())));
    }
    if library.faulty {
        return None;
    }
    let inner = Span { start: text.span.start + 1, end: text.span.end.saturating_sub(1), ..text.span };
    let diag = unknown(&text.text, inner, "holder", library.holders.keys().map(String::as_str));
    if library.holders.is_empty() {
        // Once for all tools.
        p.sink.push_first(diag.help("name a library first: `use tools \"carbide\"`; `impellerc tools` lists them"));
    } else {
        p.sink.push(diag);
    }
    None
}
