//! Tool files.

use super::form;
use super::machine::LibraryReader;
use super::schema::LibraryFile;
use super::table::{FileTable, SpannedText};
use crate::block::eval::nearest;
use crate::model::tool::{KINDS, Sizes, ToolSpec, shape_fault};
use crate::property::{Property, Without};
use base::source::{SourceId, SourceMap, Span};
use base::units::Mm;
use diagnostics::codes::job as codes;
use diagnostics::{Diag, Sink};
use std::collections::BTreeMap;

/// Holders and tools of all tool files of a job.
#[derive(Debug, Default)]
pub(crate) struct ToolLibrary {
    /// True for a file that is read by itself: its holders may stand in another file.
    pub(crate) alone: bool,
    /// True when a file has a fault, which was reported: holders and tools may be missing by it.
    pub(crate) faulty: bool,
    /// Sections by holder name: length, lower and upper diameter.
    pub(crate) holders: BTreeMap<String, Vec<[Mm; 3]>>,
    /// Tools by name; number and span come from the job.
    pub(crate) tools: BTreeMap<String, ToolSpec>,
}

/// Adds a tool file that is already in the source map to the library.
pub(crate) fn tools(source: SourceId, sources: &SourceMap, used: Span, into: &mut ToolLibrary, sink: &mut Sink) {
    let whole = form::read(LibraryFile::Tools, source, sources, Some(used), sink, |table, sink| {
        let mut reader = LibraryReader { source, sink, faults: false };
        for (name, holder) in table.named("holder") {
            library_holder(name, holder, into, &mut reader);
        }
        for (name, tool) in table.named("tool") {
            if let Some(spec) = library_tool(name, tool, into, &mut reader) {
                into.tools.insert(name.to_owned(), spec);
            }
        }
        (!reader.faults).then_some(())
    });
    into.faulty |= whole.is_none();
}

/// Names of the tools of tool files, by name, each once. Faults of a file are those
/// that a job which uses it has.
pub fn library_tools(files: &[SourceId], sources: &SourceMap) -> Vec<String> {
    let mut library = ToolLibrary::default();
    for file in files {
        tools(*file, sources, Span::default(), &mut library, &mut Sink::default());
    }
    library.tools.into_keys().collect()
}

fn library_holder(name: &str, holder: FileTable<'_, '_>, into: &mut ToolLibrary, reader: &mut LibraryReader<'_>) {
    let sections = reader.sections(holder, ["length", "lower", "upper"]);
    if let [first, .., last] = &sections[..]
        && !reader.faults
        && is_upside_down(&sections)
        && let Some(span) = holder.tables("section").first().and_then(|nose| nose.span("length", reader.source))
    {
        reader
            .sink
            .push(upside_down(name, first[1], last[2]).label(span, "this section is at the nose, beside the cutter"));
    }
    into.holders.insert(name.to_owned(), sections);
}

/// True for sections that never grow from the nose upwards and are thinnest at the spindle, as in a list from the spindle down.
fn is_upside_down(sections: &[[Mm; 3]]) -> bool {
    let ends: Vec<f64> = sections.iter().flat_map(|[_, lower, upper]| [lower.get(), upper.get()]).collect();
    sections.len() > 1 && ends.windows(2).all(|pair| pair[1] <= pair[0]) && ends.first() > ends.last()
}

fn upside_down(name: &str, nose: Mm, top: Mm) -> Diag {
    Diag::warning(
        codes::DOUBTFUL,
        format!("the holder {name} is {nose} wide at its nose and {top} at the spindle: it seems to be listed from the spindle down"),
    )
    .help("list the sections from the nose upwards: the one beside the cutter first; `lower` is the end of a section nearer to the cutter")
}

fn library_tool(
    name: &str,
    tool: FileTable<'_, '_>,
    library: &ToolLibrary,
    reader: &mut LibraryReader<'_>,
) -> Option<ToolSpec> {
    let kind = tool.text("kind")?;
    if is_wrong_kind(name, &kind, tool, reader) {
        return None;
    }
    let before = std::mem::take(&mut reader.faults);
    let mut sizes = Sizes::default();
    for key in tool.keys {
        if let Some(value) = reader.number(tool, key.name) {
            sizes.add(key.name, value);
        }
    }
    let sound = !reader.faults;
    reader.faults |= before;
    let holder = match tool.text("holder") {
        Some(holder) => library_holder_of(&holder, library, reader)?,
        None => None,
    };
    let span = reader.span(&kind);
    let spec = ToolSpec::of(kind.get_ref(), &sizes).filter(|_| sound)?;
    let spec = ToolSpec { name: name.to_owned(), holder, span, ..spec };
    if let Some(fault) = shape_fault(&spec) {
        reader.fault(span, format!("tool `{name}`: {fault}"), "this tool".to_owned(), "correct its sizes");
        return None;
    }
    Some(spec)
}

/// The holder of a name. Outer `None`: faulty; inner `None`: the name may stand in another file.
fn library_holder_of(
    holder: &SpannedText,
    library: &ToolLibrary,
    reader: &mut LibraryReader<'_>,
) -> Option<Option<(String, Vec<[Mm; 3]>)>> {
    let own = holder.get_ref();
    if let Some(sections) = library.holders.get(own) {
        return Some(Some((own.clone(), sections.clone())));
    }
    if library.alone {
        return Some(None);
    }
    let message = format!("no holder is called `{own}`");
    let known: Vec<&str> = library.holders.keys().map(String::as_str).collect();
    let help = match nearest(own, known.iter().copied()) {
        Some(near) => format!("write \"{near}\", or add `[holder.{own}]` with its sections"),
        None => format!("write one of {}, or add `[holder.{own}]` with its sections", known.join(", ")),
    };
    reader.fault(reader.span(holder), message, "not in this library".to_owned(), &help);
    None
}

/// Reports a kind of cutter that does not exist, or its first property that is missing or not its own.
fn is_wrong_kind(name: &str, kind: &SpannedText, tool: FileTable<'_, '_>, reader: &mut LibraryReader<'_>) -> bool {
    let span = reader.span(kind);
    let kind = kind.get_ref().as_str();
    if !KINDS.contains(&kind) {
        let (label, help) = match nearest(kind, KINDS.into_iter()) {
            Some(near) => (format!("did you mean \"{near}\"?"), format!("write `kind = \"{near}\"`")),
            None => ("not known".to_owned(), format!("kinds are {}", KINDS.join(", "))),
        };
        reader.fault(span, format!("`{kind}` is not a kind of cutter"), label, &help);
        return true;
    }
    let missing = |key: &&Property| key.without == Without::Required && key.is_of(kind) && !tool.has(key.name);
    if let Some(Property { name: missing, example, .. }) = tool.keys.iter().find(missing) {
        let help = format!("add `{missing} = \"{example}\"` with its value");
        let label = format!("`{missing}` is missing");
        reader.fault(span, format!("tool `{name}` of kind {kind} needs `{missing}`"), label, &help);
        return true;
    }
    let foreign = tool.keys.iter().find(|key| !key.is_of(kind) && tool.has(key.name));
    if let Some((Property { name: key, of, .. }, value)) = foreign.and_then(|key| tool.get(key.name)) {
        reader.fault(
            Span::new(reader.source, value.span()),
            format!("tool `{name}` of kind {kind} has `{key}`"),
            format!("not of a {kind}"),
            &format!("remove `{key}`, or correct `kind`: {} has it", of.join(", ")),
        );
        return true;
    }
    false
}
