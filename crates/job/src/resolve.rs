//! From the syntax tree to the [`Job`].

use crate::block::context::{Context, head};
use crate::block::eval::{LetScope, suggest};
use crate::block::properties::{Properties, Range, name_of};
use crate::contracts;
use crate::doubts::{self, Stated};
use crate::files::{Fault, Files, MissingFile};
use crate::library::tool_file::{self, ToolLibrary};
use crate::library::{machine, post_file};
use crate::model::{ClampingSpec, Job, MachineSpec, PartSpec, PartialJob, StockSpec};
use crate::operation::{self, Workpiece, tools};
use crate::part::{self, stock_file};
use crate::property::Form;
use crate::property::quantity::Dimension;
use crate::vocabulary::items::{BACK, BORE, CHORD, CHORD_ROUGH};
use crate::vocabulary::part::{BELOW, CLAMPING_DIAMETER};
use crate::vocabulary::{self, TopicKind};
use base::source::{SourceMap, Span, Spanned};
use base::units::Mm;
use diagnostics::codes::{files as file_codes, job as codes};
use diagnostics::{Aborted, Diag, Sink};
use syntax::ast::{Block, File, Item, ItemKind, Name, Text, Value};
use wheel::material::Material;
use wheel::post_file::PostFile;

/// The edition that this compiler reads.
pub(super) const EDITION: &str = "2026";

/// Resolves a job. Every fault goes to the sink.
///
/// # Errors
/// [`Aborted`] when the sink has errors, and for a job that leaves something open: that is chosen before.
pub fn resolve(file: &File, files: &mut dyn Files, sources: &mut SourceMap, sink: &mut Sink) -> Result<Job, Aborted> {
    understand(file, files, sources, sink).job().ok_or(Aborted)
}

/// The readable content of a job. Every fault goes to the sink.
pub fn understand(file: &File, files: &mut dyn Files, sources: &mut SourceMap, sink: &mut Sink) -> PartialJob {
    let mut cx = Context { scope: LetScope::new(file.damaged), files, sources, sink, searched_bytes: 0 };
    edition(file, &mut cx);
    lets(file, &mut cx);
    let machine = machine(file, &mut cx);
    let library = tool_library(file, &mut cx);
    let part = part_item(file, &mut cx);
    let stock = stock(file, &mut cx);
    let tools = tools::resolve(file, &library, &mut cx);
    let workpiece = Workpiece {
        vanes: part.as_ref().map(|p| p.vanes.value),
        blades: part.iter().flat_map(|p| &p.blades).map(|blade| blade.name.clone()).collect(),
        cut_before: stock.as_ref().is_some_and(|s| s.left.is_some()),
        material: stock.as_ref().and_then(|s| s.material),
    };
    let operations = operation::resolve(file, &tools, machine.as_ref(), &workpiece, &mut cx);
    let [chord, chord_rough] = tolerances(file, &mut cx);
    let (contracts, allowed) = contracts::resolve(file, &operations, &mut cx);
    let post = post(file, &mut cx);
    if !cx.sink.has_errors() && !file.damaged && !file.is_open() {
        cx.scope.warn_unused(cx.sink);
        tools::warn_unused(&tools, &operations, cx.sink);
        let used = |at: &usize| operations.iter().any(|o| o.tool == *at);
        let specs: Vec<_> = (0..tools.len()).filter(used).filter_map(|at| tools[at].spec.as_ref()).collect();
        let all_tools: Vec<_> = tools.iter().map(|tool| tool.spec.as_ref()).collect();
        let stated = Stated {
            stock: stock.as_ref(),
            tools: &specs,
            all_tools: &all_tools,
            operations: &operations,
            contracts: &contracts,
            chord,
        };
        doubts::warn(&stated, cx.sink);
    }
    let whole = !cx.sink.has_errors() && !file.damaged && !file.faulty && !file.is_open();
    let tools = tools.into_iter().map(|t| t.spec).collect();
    let values = cx.scope.values();
    let libraries = file.items.iter().filter_map(|item| match &item.kind {
        ItemKind::Use { kind, what } if kind.text == "tools" => Some(what.text.clone()),
        _ => None,
    });
    let libraries = libraries.collect();
    PartialJob {
        values,
        machine,
        libraries,
        part,
        stock,
        tools,
        operations,
        contracts,
        allowed,
        chord,
        chord_rough,
        post,
        whole,
    }
}

/// The only item of a kind; reports a second one, and a missing one with an example.
fn single<'f, T>(
    file: &'f File,
    what: &str,
    example: &str,
    pick: impl Fn(&'f Item) -> Option<T>,
    cx: &mut Context<'_>,
) -> Option<Spanned<T>> {
    let mut found: Option<Spanned<T>> = None;
    for item in &file.items {
        let Some(value) = pick(item) else { continue };
        let head = head(item);
        if let Some(first) = &found {
            cx.sink.push(
                Diag::error(codes::GIVEN_TWICE, format!("the job has a second {what}"))
                    .label(head, "given again")
                    .label(first.span, "first given here")
                    .help("keep one of them"),
            );
        } else {
            found = Some(Spanned::new(value, head));
        }
    }
    if found.is_none() && !file.damaged {
        let mut diag = Diag::error(codes::MISSING_ITEM, format!("the job has no {what}"));
        if let Some(last) = file.items.last() {
            // The label stands on the line of the last item, before its line end.
            let text = cx.sources.get(last.span.source).map_or("", |f| f.text.as_str());
            let before = text.get(..last.span.range().end).map_or(last.span.range().end, |t| t.trim_end().len());
            diag = diag.label(Span::new(last.span.source, before..before), "the job ends here");
        }
        cx.sink.push(diag.help(format!("add `{example}`")));
    }
    found
}

fn edition(file: &File, cx: &mut Context<'_>) {
    let pick = |item: &'_ Item| if let ItemKind::Edition(name) = &item.kind { Some(name.clone()) } else { None };
    let Some(Spanned { value: name, .. }) = single(file, "edition", "edition 2026", pick, cx) else { return };
    if name.text != EDITION {
        cx.sink.push(
            Diag::error(codes::EDITION, format!("edition {} is unknown", name.text))
                .label(name.span, "unknown to this compiler")
                .help(format!("write `edition {EDITION}`"))
                .fix(name.span, EDITION),
        );
    }
}

/// Names are declared before they are used, so that a reader meets the value first.
fn lets(file: &File, cx: &mut Context<'_>) {
    for (at, item) in file.items.iter().enumerate() {
        if let ItemKind::Let { name, value } = &item.kind {
            cx.scope.declared_below(file.items[at..].iter().filter_map(|item| match &item.kind {
                ItemKind::Let { name, .. } => Some((name.text.clone(), name.span)),
                _ => None,
            }));
            let value = cx.scope.value(value, cx.sink);
            cx.scope.bind(name, value, cx.sink);
        }
    }
    cx.scope.declared_below(std::iter::empty());
    for item in &file.items {
        if let ItemKind::Part { body, .. } | ItemKind::Stock { body, .. } | ItemKind::Operation { body, .. } =
            &item.kind
        {
            misplaced_lets(body, cx);
        }
    }
}

/// Names that are declared inside of a block. The block refuses the line; the names are known, so that their use is no
/// second fault.
fn misplaced_lets(body: &Block, cx: &mut Context<'_>) {
    for entry in &body.entries {
        for value in &entry.values {
            match value {
                Value::Labelled(name, value) if entry.name.text == "let" => {
                    let value = cx.scope.value(value, cx.sink);
                    cx.scope.bind(name, value, cx.sink);
                }
                Value::Block(_, inner) | Value::Placed(_, inner) => misplaced_lets(inner, cx),
                _ => {}
            }
        }
    }
}

fn machine(file: &File, cx: &mut Context<'_>) -> Option<MachineSpec> {
    for item in &file.items {
        if let ItemKind::Use { kind, .. } = &item.kind
            && !["machine", "tools"].contains(&kind.text.as_str())
        {
            let diag = Diag::error(codes::NOT_IN_LANGUAGE, format!("`use {}` is not in the language", kind.text));
            cx.sink.push(suggest(diag, &kind.text, kind.span, "kind", &["machine", "tools"]));
        }
    }
    let pick = |item: &'_ Item| match &item.kind {
        ItemKind::Use { kind, what } if kind.text == "machine" => Some(what.clone()),
        _ => None,
    };
    let Spanned { value: what, .. } = single(file, "machine", "use machine \"5mc850-c\"", pick, cx)?;
    match cx.files.machine(&what.text) {
        Ok(found) => {
            let source = cx.sources.add_file(found);
            machine::machine(&what.text, source, cx.sources, what.span, cx.sink)
        }
        Err(missing) => {
            cx.sink.push(not_in_library("machine", &what.text, inner(&what), &missing));
            None
        }
    }
}

/// The diagnostic for a file that the library does not have; `span` is that of its name without quotes.
fn not_in_library(kind: &str, name: &str, span: Span, missing: &MissingFile) -> Diag {
    if missing.fault == Fault::Unreadable {
        return Diag::error(file_codes::CANNOT_READ, format!("the {kind} file `{name}` cannot be read"))
            .label(span, missing.reason.clone())
            .help("correct the file in the library, or name another one");
    }
    let diag = Diag::error(file_codes::NOT_IN_LIBRARY, format!("there is no {kind} file `{name}`"));
    let known: Vec<_> = missing.known.iter().map(String::as_str).collect();
    let diag = suggest(diag, name, span, "file", &known).note(missing.reason.clone());
    match kind {
        "machine" => diag.note(
            "`impellerc machines` tells what each of them is; docs/machines.md shows how to describe another one",
        ),
        _ => diag,
    }
}

/// Span of a quoted text without its quotes.
fn inner(what: &Text) -> Span {
    Span { start: what.span.start + 1, end: what.span.end.saturating_sub(1), ..what.span }
}

fn tool_library(file: &File, cx: &mut Context<'_>) -> ToolLibrary {
    let mut library = ToolLibrary::default();
    for item in &file.items {
        let ItemKind::Use { kind, what } = &item.kind else { continue };
        if kind.text != "tools" {
            continue;
        }
        match cx.files.tools(&what.text) {
            Ok(found) => {
                let source = cx.sources.add_file(found);
                tool_file::tools(source, cx.sources, what.span, &mut library, cx.sink);
            }
            Err(missing) => cx.sink.push(not_in_library("tool", &what.text, inner(what), &missing)),
        }
    }
    library
}

fn part_item(file: &File, cx: &mut Context<'_>) -> Option<PartSpec> {
    let pick = |item: &'_ Item| match &item.kind {
        ItemKind::Part { name, body } => Some((name.clone(), body.clone())),
        _ => None,
    };
    let Spanned { value: (name, body), span: head } =
        single(file, "part", "part NAME { vanes 8  vane main { ... } hub ... shroud ... }", pick, cx)?;
    part::resolve(&name, &body, head, cx)
}

fn stock(file: &File, cx: &mut Context<'_>) -> Option<StockSpec> {
    let example = "stock turned { over shroud 0 mm  bore 10 mm  back -40 mm }";
    let pick = |item: &'_ Item| match &item.kind {
        ItemKind::Stock { kind, body } => Some((kind.clone(), body.clone())),
        _ => None,
    };
    let Spanned { value: (kind, body), span }: Spanned<(Name, Block)> = single(file, "stock", example, pick, cx)?;
    if kind.text != "turned" {
        let diag = Diag::error(codes::NOT_IN_LANGUAGE, format!("stock `{}` is not in the language", kind.text));
        cx.sink.push(suggest(diag, &kind.text, kind.span, "kind of stock", &["turned"]));
        return None;
    }
    let known = vocabulary::properties(TopicKind::Item, "stock");
    let mut p = Properties::new("the stock".to_owned(), span, &body, &known, &mut cx.scope, cx.sink);
    if !p.has("over") {
        p.missing("over", "over shroud 0 mm");
    }
    let over = p.labelled("over", &["shroud"], "over shroud 0 mm");
    let over =
        over.first().and_then(|(_, e)| p.value_of(e, "over shroud", Dimension::LENGTH, Range::NotNegative(100.0)));
    let [bore, back] = [BORE, BACK].map(|property| p.read_or_default(&property));
    let from = stock_file::path(&mut p);
    let material = name_of(&mut p, "material", &Material::ALL, Material::name);
    let clamping = p.take("clamping");
    let (over, bore, back) = (Mm(over?), Mm(bore?), Mm(back?));
    let clamping = match clamping {
        None => ClampingSpec { below: back, diameter: None, span: None },
        Some((word, values)) => clamping_of(word, &values, back, cx)?,
    };
    let left = match from? {
        None => None,
        Some(path) => Some(stock_file::read(path, cx)?),
    };
    Some(StockSpec { over_shroud: over, bore, back, clamping, left, material: material?, span })
}

/// `clamping { below -42 mm  diameter 60 mm }`: both may be left out.
fn clamping_of(word: &Name, values: &[&Value], back: Mm, cx: &mut Context<'_>) -> Option<ClampingSpec> {
    let example = "clamping { diameter 60 mm }";
    let [Value::Block(None, block)] = values else {
        cx.sink.push(
            Diag::error(codes::WRONG_FORM, "`clamping` of the stock takes a block")
                .label(word.span, "a block is expected")
                .help(format!("write it like `{example}`")),
        );
        return None;
    };
    let known = vocabulary::properties(TopicKind::Block, "clamping");
    let mut p = Properties::new("the clamping".to_owned(), word.span, block, &known, &mut cx.scope, cx.sink);
    let below = p.read(&BELOW)?.map_or(back, |below| Mm(below.0));
    let diameter = p.read(&CLAMPING_DIAMETER)?.map(|diameter| Mm(diameter.0));
    Some(ClampingSpec { below, diameter, span: Some(word.span) })
}

/// Tolerances of finishing and of roughing.
fn tolerances(file: &File, cx: &mut Context<'_>) -> [Mm; 2] {
    let rows = [CHORD, CHORD_ROUGH];
    let mut found = rows.map(|row| row.default().unwrap_or_default());
    let mut seen: Vec<(&str, Span)> = Vec::new();
    for item in &file.items {
        let ItemKind::Tolerance(values) = &item.kind else { continue };
        for value in values {
            let Value::Labelled(label, expr) = value else {
                let range = matches!(value, Value::Range(..));
                let fault = if range { "a tolerance is one length" } else { "a tolerance needs a label" };
                cx.sink.push(
                    Diag::error(codes::WRONG_FORM, fault)
                        .label(value.span(), "a label and a length are expected")
                        .help("write `tolerance chord 1 um, rough 10 um`"),
                );
                continue;
            };
            let Some(row) = rows.iter().position(|row| row.name == label.text) else {
                let diag = Diag::error(codes::UNKNOWN_PROPERTY, format!("no tolerance is called `{}`", label.text));
                cx.sink.push(suggest(diag, &label.text, label.span, "tolerance", &rows.map(|row| row.name)));
                continue;
            };
            if let Some((_, first)) = seen.iter().find(|(n, _)| *n == label.text) {
                cx.sink.push(
                    Diag::error(codes::GIVEN_TWICE, format!("the tolerance `{}` is given twice", label.text))
                        .label(label.span, "given again")
                        .label(*first, "first given here")
                        .help("keep one of them"),
                );
            }
            seen.push((&label.text, label.span));
            let what = format!("the tolerance `{}`", label.text);
            let Form::Quantity(due, range) = rows[row].form else { continue };
            if let Some(value) = cx.scope.expect(expr, due, &what, cx.sink) {
                if range.holds(value) {
                    found[row] = value;
                } else {
                    cx.sink.push(
                        Diag::error(codes::OUT_OF_RANGE, format!("{what} must be {}", range.text(due)))
                            .label(expr.span, "out of range")
                            .help("1 um is usual in finishing, 10 um in roughing"),
                    );
                }
            }
        }
    }
    found.map(Mm)
}

/// The post file that the job names, with the properties of the job over it.
fn post(file: &File, cx: &mut Context<'_>) -> Option<PostFile> {
    let pick = |item: &'_ Item| match &item.kind {
        ItemKind::Post { name, body } => Some((name.clone(), body.clone())),
        _ => None,
    };
    let Spanned { value: (name, body), span: head } = single(file, "post", "post siemens-840d", pick, cx)?;
    let found = match cx.files.post(&name.text) {
        Ok(found) => found,
        Err(missing) => {
            cx.sink.push(not_in_library("post", &name.text, name.span, &missing));
            return None;
        }
    };
    let source = cx.sources.add_file(found);
    let post = post_file::read(&name.text, source, cx.sources, Some(name.span), cx.sink)?;
    Some(match &body {
        Some(body) => post_file::with_properties(post, head, body, &mut cx.scope, cx.sink),
        None => post,
    })
}
