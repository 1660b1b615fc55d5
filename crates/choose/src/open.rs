//! What a job leaves open, and its text with what was chosen in these places.

use crate::text::{ChosenOperation, ToolNames, value};
use diagnostics::{Diag, codes::job as codes};
use std::ops::Range;
use syntax::ast::{Block, Entry, File, Item, ItemKind, Name, OPEN_PROPERTIES, ScopeTarget, ToolSource, Value};
use wheel::part::SurfaceClass;

/// A job with open places.
#[derive(Clone, Copy)]
pub(crate) struct OpenJob<'a> {
    pub(crate) text: &'a str,
    pub(crate) ast: &'a File,
}

/// An open place of a job.
#[derive(Clone, Copy)]
pub(crate) enum Opening<'a> {
    /// `operations auto`.
    Operations(&'a Item),
    /// An operation with open values.
    Operation(OpenOperation<'a>),
}

/// An operation with open values.
#[derive(Clone, Copy)]
pub(crate) struct OpenOperation<'a> {
    pub(crate) item: &'a Item,
    pub(crate) kind: &'a Name,
    body: &'a Block,
}

/// A new text for a range of a text.
pub(crate) struct Edit {
    range: Range<usize>,
    text: String,
}

/// A tool with which the values of an open operation are read before they are chosen: a ball, which all kinds take.
const PLACEHOLDER: &str = "ball { diameter 1 mm  flutes 2  flute 5 mm  reach 6 mm }";

impl<'a> OpenJob<'a> {
    /// Its open places in the order of the text.
    pub(crate) fn openings(&self) -> Vec<Opening<'a>> {
        let open = |item: &'a Item| match &item.kind {
            ItemKind::Operations(_) => Some(Opening::Operations(item)),
            ItemKind::Operation { kind, body, .. } if item.is_open() => {
                Some(Opening::Operation(OpenOperation { item, kind, body }))
            }
            _ => None,
        };
        self.ast.items.iter().filter_map(open).collect()
    }

    /// Declared tools: name, and name in the library.
    pub(crate) fn declared(&self) -> Vec<(&'a str, Option<&'a str>)> {
        let tool = |item: &'a Item| match &item.kind {
            ItemKind::Tool { name, source: ToolSource::Library(text) } => Some((&name.text[..], Some(&text.text[..]))),
            ItemKind::Tool { name, source: ToolSource::Shape(..) } => Some((&name.text[..], None)),
            _ => None,
        };
        self.ast.items.iter().filter_map(tool).collect()
    }

    /// The name with the next free number of a tool or an operation.
    pub(crate) fn free_name(&self, stem: &str) -> String {
        let taken = |text: &str| {
            self.ast.items.iter().any(|item| match &item.kind {
                ItemKind::Tool { name, .. } | ItemKind::Operation { name: Some(name), .. } => name.text == text,
                _ => false,
            })
        };
        (1..).map(|n| format!("{stem}{n}")).find(|text| !taken(text)).unwrap_or_default()
    }

    /// The job with all tools of its libraries, named in this order, and with values in the open places that can be read but mean
    /// nothing: what it fixes is found from it. The last name is that of an operation that stands for what is chosen.
    pub(crate) fn readable(&self, library: &[(String, &str)], placeholder: &str, operation: &str) -> String {
        let mut edits = Vec::new();
        let openings = self.openings();
        for opening in &openings {
            match opening {
                Opening::Operations(item) => edits.push(Edit { range: item.span.range(), text: String::new() }),
                Opening::Operation(open) => edits.extend(open.readable(placeholder)),
            }
        }
        // They may speak of operations that are not chosen yet.
        let of_operations = self.ast.items.iter().filter(|item| match &item.kind {
            ItemKind::Require { what, scope, .. } => what.text != "excess" && names_operations(scope),
            ItemKind::Allow { scope, .. } => names_operations(scope),
            _ => false,
        });
        edits.extend(of_operations.map(|item| Edit { range: item.span.range(), text: String::new() }));
        let mut added = format!("tool {placeholder} = {PLACEHOLDER}\n");
        added.extend(library.iter().map(|(name, tool)| format!("tool {name} = \"{tool}\"\n")));
        // Front ends make no program without an operation.
        added += &format!(
            "operation channel {operation} {{ tool {placeholder}  speed 1000 rpm  feed 1 mm/min  link-feed 1 mm/min  scallop 10 um }}\n"
        );
        let at = openings.first().map_or(self.text.len(), |opening| opening.item().span.range().start);
        edits.push(Edit { range: at..at, text: added });
        edited(self.text, edits)
    }

    /// The job without its operations, without what is said of them alone and without contracts on excess: for trials.
    pub(crate) fn without_operations(&self) -> String {
        let of_operation = |item: &&Item| match &item.kind {
            ItemKind::Operation { .. } | ItemKind::Operations(_) => true,
            // A trial with few lines leaves more.
            ItemKind::Require { what, .. } if what.text == "excess" => true,
            ItemKind::Require { scope, .. } | ItemKind::Allow { scope, .. } => names_operations(scope),
            _ => false,
        };
        let left_out = self.ast.items.iter().filter(of_operation);
        edited(self.text, left_out.map(|item| Edit { range: item.span.range(), text: String::new() }).collect())
    }

    /// The job with what was chosen: a text for each open place, and declarations of tools before the first one.
    pub(crate) fn with(
        &self,
        declarations: &str,
        chosen: &[(Opening<'_>, Vec<ChosenOperation>)],
        names: &ToolNames,
    ) -> String {
        let mut edits = Vec::new();
        let mut declarations = Some(declarations).filter(|text| !text.is_empty());
        for (opening, operations) in chosen {
            let range = opening.item().span.range();
            let declared = declarations.take().unwrap_or_default();
            match opening {
                Opening::Operations(_) => {
                    let text = format!("{declared}{}", crate::text::items(operations, names));
                    edits.push(Edit { range, text: usual(&text) });
                }
                Opening::Operation(open) => {
                    let mut why: Vec<&str> = operations.iter().map(|operation| operation.why.as_str()).collect();
                    why.dedup();
                    let text = usual(declared) + &format!("// {}\n", why.join("; "));
                    edits.push(Edit { range: range.start..range.start, text });
                    edits.extend(open.edits(&|name| value(name, operations, names)));
                }
            }
        }
        edited(self.text, edits)
    }

    /// Its operations in the order of the text: true for an open place, which may stand for several, false for one that is given.
    pub(crate) fn order(&self) -> Vec<bool> {
        let mut order = Vec::new();
        for item in &self.ast.items {
            if item.is_open() {
                order.push(true);
            } else if let ItemKind::Operation { body, .. } = &item.kind {
                let tools = body.entries.iter().find(|entry| entry.name.text == "tools").map_or(1, |e| e.values.len());
                order.extend((0..tools).map(|_| false));
            }
        }
        order
    }

    /// Refuses a roughing that takes all tools of the job: it would take those that are chosen as well.
    pub(crate) fn takes_all_tools(&self) -> Option<Diag> {
        let of_all = self.ast.items.iter().find_map(|item| match &item.kind {
            ItemKind::Operation { kind, body, .. }
                if kind.text == "rough"
                    && !body.entries.iter().any(|entry| ["tool", "tools"].contains(&entry.name.text.as_str())) =>
            {
                Some(kind)
            }
            _ => None,
        });
        let kind = of_all?;
        Some(
            Diag::error(codes::WRONG_FORM, "this `rough` takes all tools of the job, and tools are chosen beside it")
                .label(kind.span, "no `tools`")
                .help("name its tools, such as `tools t1, t2`; or leave them open: `tools auto`"),
        )
    }
}

impl<'a> Opening<'a> {
    pub(crate) fn item(&self) -> &'a Item {
        match self {
            Self::Operations(item) => item,
            Self::Operation(open) => open.item,
        }
    }
}

impl<'a> OpenOperation<'a> {
    fn entry(&self, name: &str) -> Option<&'a Entry> {
        self.body.entries.iter().find(|entry| entry.name.text == name)
    }

    /// Whether the value of a property is chosen.
    pub(crate) fn leaves(&self, property: &str) -> bool {
        self.entry(property).is_some_and(Entry::is_open)
    }

    /// Names of the tools that it fixes.
    pub(crate) fn tools(&self) -> Vec<String> {
        let entry = self.entry("tools").or_else(|| self.entry("tool")).filter(|entry| !entry.is_open());
        let name = |value: &Value| match value {
            Value::Expr(syntax::ast::Expr { kind: syntax::ast::ExprKind::Path(path), .. }) => Some(path.text()),
            _ => None,
        };
        entry.into_iter().flat_map(|entry| &entry.values).filter_map(name).collect()
    }

    /// The first open property that is not among those that are chosen for its kind.
    pub(crate) fn left_beyond(&self, chosen: &[&str]) -> Option<&'a Entry> {
        self.open_entries().find(|entry| !chosen.contains(&entry.name.text.as_str()))
    }

    /// Values that can be read in the places of the open ones, and of those that must go with them.
    fn readable(&self, tool: &str) -> Vec<Edit> {
        let edit = |entry: &Entry| {
            let name = entry.name.text.as_str();
            // What the larger tools of a list leave says nothing of the last one.
            if self.kind.text == "channel" && name == "allowance" {
                return Some(Edit { range: entry.span.range(), text: String::new() });
            }
            if !entry.is_open() && !WITH_TOOL.contains(&name) {
                return None;
            }
            let range = entry.values.first()?.span().range().start..entry.values.last()?.span().range().end;
            Some(Edit { range, text: readable_value(name, tool) })
        };
        self.body.entries.iter().filter_map(edit).collect()
    }

    /// Its open properties.
    pub(crate) fn left(&self) -> Vec<&'a str> {
        self.open_entries().map(|entry| entry.name.text.as_str()).collect()
    }

    fn open_entries(&self) -> impl Iterator<Item = &'a Entry> {
        self.body.entries.iter().filter(|entry| entry.is_open())
    }

    /// Values in the places of the open ones.
    fn edits(&self, value: &dyn Fn(&str) -> String) -> Vec<Edit> {
        let edit = |entry: &'a Entry| {
            let range = entry.values.first()?.span().range();
            Some(Edit { range, text: value(&entry.name.text) })
        };
        self.open_entries().filter_map(edit).collect()
    }

    /// Its text in one sector with what was chosen.
    pub(crate) fn in_one_sector(&self, text: &str, operations: &[ChosenOperation], names: &ToolNames) -> String {
        let mut edits = self.edits(&|name| value(name, operations, names));
        match self.entry("sectors").and_then(|entry| Some((entry.values.first()?, entry.values.last()?))) {
            Some((first, last)) => {
                edits.push(Edit { range: first.span().range().start..last.span().range().end, text: "1".to_owned() });
            }
            None => {
                let end = self.body.span.range().end.saturating_sub(1);
                edits.push(Edit { range: end..end, text: " sectors 1 ".to_owned() });
            }
        }
        let item = self.item.span.range();
        for edit in &mut edits {
            edit.range = edit.range.start - item.start..edit.range.end - item.start;
        }
        edited(&text[item], edits)
    }
}

/// Whether a scope names operations, by kind or name.
fn names_operations(scope: &[ScopeTarget]) -> bool {
    let is_surface = |word: &str| SurfaceClass::ALL.iter().any(|surface| surface.name() == word);
    scope.iter().any(|target| target.operation || !is_surface(&target.name.text))
}

/// Properties whose values must fit the tool.
const WITH_TOOL: [&str; 8] = ["tool", "tools", "speed", "feed", "link-feed", "depth", "stepover", "scallop"];

/// A value that can be read in the place of an open one.
fn readable_value(property: &str, tool: &str) -> String {
    match property {
        "tool" | "tools" => tool.to_owned(),
        "speed" => "1000 rpm".to_owned(),
        "feed" | "link-feed" => "1 mm/min".to_owned(),
        "method" => "blend".to_owned(),
        "allowance" => "vane 0.1 mm, hub 0.1 mm".to_owned(),
        "scallop" => "10 um".to_owned(),
        property => {
            debug_assert!(OPEN_PROPERTIES.contains(&property), "{property}");
            "0.1 mm".to_owned()
        }
    }
}

/// A text with its edits, which do not overlap.
fn edited(text: &str, mut edits: Vec<Edit>) -> String {
    edits.sort_by_key(|edit| (edit.range.start, edit.range.end));
    let (mut out, mut at) = (String::with_capacity(text.len()), 0);
    for edit in edits {
        out += text.get(at..edit.range.start).unwrap_or_default();
        out += &edit.text;
        at = edit.range.end;
    }
    out + text.get(at..).unwrap_or_default()
}

/// Items in their usual form.
fn usual(items: &str) -> String {
    let formatted = syntax::format(items, base::source::SourceId::default(), &mut diagnostics::Sink::default());
    formatted.unwrap_or_else(|_| items.to_owned())
}
