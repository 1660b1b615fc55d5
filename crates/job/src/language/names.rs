//! Names that a job gives to values, tools, operations and blades, and the places that mention them.

use super::{Understood, understand, word_round};
use crate::Files;
use base::source::Span;
use diagnostics::Diag;
use std::collections::BTreeSet;
use std::ops::Range;
use syntax::ast::{Block, Entry, Expr, ExprKind, File, ItemKind, Name, Path, Revolved, ScopeTarget, ToolSource, Value};

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Named {
    /// A value of `let`.
    Value,
    /// A tool.
    Tool,
    /// An operation.
    Operation,
    /// A blade of a sector.
    Blade,
}

/// A place that gives or mentions a name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mention<'f> {
    pub(super) named: Named,
    pub(super) name: &'f Name,
    /// True where the item gives the name.
    gives: bool,
}

/// Walks over a tree.
struct Walk<'f> {
    values: BTreeSet<&'f str>,
    blades: BTreeSet<&'f str>,
    found: Vec<Mention<'f>>,
}

/// The names that the `part` gives to its blades: `vane main { }`, `splitter second { }`.
fn blades(body: &Block) -> impl Iterator<Item = &Name> {
    let blades = body.entries.iter().filter(|entry| ["vane", "splitter"].contains(&entry.name.text.as_str()));
    blades.flat_map(|entry| &entry.values).filter_map(|value| match value {
        Value::Block(name, _) => name.as_ref(),
        _ => None,
    })
}

/// All mentions in the order of the text.
fn mentions(tree: &File) -> Vec<Mention<'_>> {
    let mut walk = Walk { values: BTreeSet::new(), blades: BTreeSet::new(), found: Vec::new() };
    for item in &tree.items {
        match &item.kind {
            ItemKind::Let { name, .. } => drop(walk.values.insert(&name.text)),
            ItemKind::Part { body, .. } => walk.blades.extend(blades(body).map(|name| name.text.as_str())),
            _ => {}
        }
    }
    for item in &tree.items {
        walk.item(&item.kind);
    }
    walk.found.sort_by_key(|mention| mention.name.span.start);
    walk.found
}

impl<'f> Walk<'f> {
    fn gives(&mut self, named: Named, name: &'f Name) {
        self.found.push(Mention { named, name, gives: true });
    }

    fn mentions(&mut self, named: Named, name: &'f Name) {
        self.found.push(Mention { named, name, gives: false });
    }

    fn item(&mut self, item: &'f ItemKind) {
        match item {
            ItemKind::Let { name, value } => {
                self.gives(Named::Value, name);
                self.expr(value);
            }
            ItemKind::Part { body, .. } => {
                blades(body).for_each(|name| self.gives(Named::Blade, name));
                self.block(body, false);
            }
            ItemKind::Stock { body, .. } | ItemKind::Post { body: Some(body), .. } => self.block(body, false),
            ItemKind::Tool { name, source } => {
                self.gives(Named::Tool, name);
                if let ToolSource::Shape(_, body) = source {
                    self.block(body, false);
                }
            }
            ItemKind::Operation { name, body, .. } => {
                name.iter().for_each(|name| self.gives(Named::Operation, name));
                self.block(body, true);
            }
            ItemKind::Tolerance(values) => values.iter().for_each(|value| self.value(value)),
            ItemKind::Require { bound, scope, .. } => {
                self.expr(bound);
                self.scope(scope);
            }
            ItemKind::Allow { scope, .. } => self.scope(scope),
            ItemKind::Edition(_) | ItemKind::Use { .. } | ItemKind::Operations(_) | ItemKind::Post { .. } => {}
        }
    }

    fn scope(&mut self, scope: &'f [ScopeTarget]) {
        for target in scope {
            if target.operation {
                self.mentions(Named::Operation, &target.name);
            } else if self.blades.contains(target.name.text.as_str()) {
                self.mentions(Named::Blade, &target.name);
            }
        }
    }

    fn block(&mut self, block: &'f Block, of_operation: bool) {
        for Entry { name, values, .. } in &block.entries {
            let names_tools = of_operation && ["tool", "tools"].contains(&name.text.as_str());
            for value in values {
                match value {
                    Value::Expr(Expr { kind: ExprKind::Path(path), .. }) if names_tools => {
                        path.names.first().into_iter().for_each(|name| self.mentions(Named::Tool, name));
                    }
                    value => self.value(value),
                }
            }
        }
    }

    fn value(&mut self, value: &'f Value) {
        match value {
            Value::Expr(e) | Value::Labelled(_, e) => self.expr(e),
            Value::Range(_, ends) => ends.iter().for_each(|e| self.expr(e)),
            Value::Block(_, block) => self.block(block, false),
            Value::Placed(e, block) => {
                self.expr(e);
                self.block(block, false);
            }
            Value::List(points, _) => points.iter().flat_map(|p| &p.coordinates).for_each(|e| self.expr(e)),
            Value::Revolve(Revolved::OfBlade(path), _) => self.path(path),
            Value::Spline(_) | Value::Loop(_) | Value::Loops { .. } | Value::Revolve(..) | Value::Text(_) => {}
        }
    }

    fn path(&mut self, path: &'f Path) {
        let Some(first) = path.names.first() else { return };
        if path.names.len() == 1 && self.values.contains(first.text.as_str()) {
            self.mentions(Named::Value, first);
        } else if self.blades.contains(first.text.as_str()) {
            self.mentions(Named::Blade, first);
        }
    }

    fn expr(&mut self, expr: &'f Expr) {
        match &expr.kind {
            ExprKind::Number(..) => {}
            ExprKind::Path(path) => self.path(path),
            ExprKind::Negative(inner) => self.expr(inner),
            ExprKind::Chain(first, rest) => {
                self.expr(first);
                rest.iter().for_each(|(_, operand)| self.expr(operand));
            }
        }
    }
}

/// True for a place inside of a name or at its end, where the cursor stands behind the last letter.
fn touches(span: Span, at: usize) -> bool {
    let range = span.range();
    (range.start..=range.end).contains(&at)
}

/// The mention at a place.
pub(super) fn mention_at(tree: &File, at: usize) -> Option<Mention<'_>> {
    mentions(tree).into_iter().find(|mention| touches(mention.name.span, at))
}

/// All places of the name at a place, the one that gives it first; none where no name is or no item gives it.
pub fn places(understood: &Understood, at: usize) -> Vec<Range<usize>> {
    let Some(pointed) = mention_at(&understood.tree, at) else { return Vec::new() };
    let same = |m: &Mention<'_>| m.named == pointed.named && m.name.text == pointed.name.text;
    let mut found: Vec<Mention<'_>> = mentions(&understood.tree).into_iter().filter(same).collect();
    // Stable: the mentions stay in the order of the text.
    found.sort_by_key(|mention| !mention.gives);
    match found.first() {
        Some(first) if first.gives => found.iter().map(|mention| mention.name.span.range()).collect(),
        _ => Vec::new(),
    }
}

/// The bytes at which the name at a place is given.
pub fn definition(understood: &Understood, at: usize) -> Option<Range<usize>> {
    places(understood, at).into_iter().next()
}

/// The places to change, so that the name at a place becomes another one.
///
/// # Errors
/// A place without a name of the job, or a new name with which the text has another fault; the reason is for people.
pub fn rename(
    understood: &Understood,
    text: &str,
    at: usize,
    new: &str,
    files: &mut dyn Files,
) -> Result<Vec<Range<usize>>, String> {
    let places = places(understood, at);
    if places.is_empty() {
        return Err("only names that the job gives can be renamed: of values, tools, operations and blades".to_owned());
    }
    if new.is_empty() || word_round(new, 0, of_name) != (0..new.len()) {
        return Err(format!("`{new}` is no name: letters, digits, `-` and `_` are allowed"));
    }
    if understood.tree.faulty || understood.tree.damaged {
        return Err("the text has faults: some places of the name may not be known; correct the text first".to_owned());
    }
    let mut renamed = text.to_owned();
    let mut in_order = places.clone();
    in_order.sort_by_key(|place| place.start);
    for place in in_order.iter().rev() {
        renamed.replace_range(place.clone(), new);
    }
    let after = understand("job.imp", &renamed, files);
    let is_new = |diag: &&Diag| understood.diags.iter().all(|before| before.message != diag.message);
    if let Some(fault) = after.diags.iter().find(is_new).filter(|_| after.diags.len() > understood.diags.len()) {
        return Err(format!("with the name `{new}` the compiler says more of the job, such as: {}", fault.message));
    }
    // The same places, moved by the letters that the places before them have got or lost.
    let moved = |k: usize, place: &Range<usize>| {
        let start = place.start + k * new.len() - in_order[..k].iter().map(|before| before.len()).sum::<usize>();
        start..start + new.len()
    };
    let due: Vec<Range<usize>> = in_order.iter().enumerate().map(|(k, place)| moved(k, place)).collect();
    let mut found = self::places(&after, due[0].start);
    found.sort_by_key(|place| place.start);
    if found != due {
        return Err(format!("`{new}` is a name or a word of the job already"));
    }
    Ok(places)
}

/// Letters of names.
fn of_name(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || matches!(letter, '-' | '_')
}
