//! Items that were read before: an editor changes one item of a text at a time, and pest takes most of the time of reading.

use super::ast::{
    Block, Entry, Expr, ExprKind, Item, ItemKind, Name, Path, Point, Revolved, Spline, SplinePoints, Text, ToolSource,
    Value,
};
use base::source::Span;
use std::collections::HashMap;

/// Items without faults by their text, with their places as if each were alone in a text.
#[derive(Clone, Debug, Default)]
pub struct KnownItems {
    of_last: HashMap<String, Item>,
    of_this: HashMap<String, Item>,
}

impl KnownItems {
    /// A text is read: its items are kept, those of the text before it go.
    pub(super) fn begin(&mut self) {
        self.of_last = std::mem::take(&mut self.of_this);
    }

    /// The item of a text that begins at a byte.
    pub(super) fn get(&mut self, text: &str, start: usize) -> Option<Item> {
        if let Some((text, item)) = self.of_last.remove_entry(text) {
            self.of_this.insert(text, item);
        }
        self.of_this.get(text).map(|item| moved(item.clone(), |at| at + start))
    }

    /// Keeps an item that begins at a byte.
    pub(super) fn keep(&mut self, text: &str, start: usize, item: &Item) {
        self.of_this.insert(text.to_owned(), moved(item.clone(), |at| at.saturating_sub(start)));
    }
}

/// An item with its places moved.
fn moved(mut item: Item, to: impl Fn(usize) -> usize) -> Item {
    Mover { to }.item(&mut item);
    item
}

/// Moves places.
struct Mover<F> {
    to: F,
}

impl<F: Fn(usize) -> usize> Mover<F> {
    fn span(&self, span: &mut Span) {
        let range = span.range();
        *span = Span::new(span.source, (self.to)(range.start)..(self.to)(range.end));
    }

    fn name(&self, name: &mut Name) {
        self.span(&mut name.span);
    }

    fn text(&self, text: &mut Text) {
        self.span(&mut text.span);
    }

    fn item(&self, item: &mut Item) {
        self.span(&mut item.span);
        match &mut item.kind {
            ItemKind::Edition(name) => self.name(name),
            ItemKind::Use { kind, what } => {
                self.name(kind);
                self.text(what);
            }
            ItemKind::Let { name, value } => {
                self.name(name);
                self.expr(value);
            }
            ItemKind::Part { name, body } | ItemKind::Stock { kind: name, body } => {
                self.name(name);
                self.block(body);
            }
            ItemKind::Tool { name, source } => {
                self.name(name);
                match source {
                    ToolSource::Library(text) => self.text(text),
                    ToolSource::Shape(kind, body) => {
                        self.name(kind);
                        self.block(body);
                    }
                }
            }
            ItemKind::Operation { kind, name, body } => {
                self.name(kind);
                name.iter_mut().for_each(|name| self.name(name));
                self.block(body);
            }
            ItemKind::Tolerance(values) => values.iter_mut().for_each(|value| self.value(value)),
            ItemKind::Require { what, body, relation, bound, outside, scope } => {
                let names = [Some(what), body.as_mut(), Some(relation), outside.as_mut()];
                names.into_iter().flatten().for_each(|name| self.name(name));
                self.expr(bound);
                scope.iter_mut().for_each(|target| self.name(&mut target.name));
            }
            ItemKind::Allow { what, body, scope, reason } => {
                [Some(what), body.as_mut()].into_iter().flatten().for_each(|name| self.name(name));
                scope.iter_mut().for_each(|target| self.name(&mut target.name));
                self.text(reason);
            }
            ItemKind::Post { name, body } => {
                self.name(name);
                body.iter_mut().for_each(|body| self.block(body));
            }
        }
    }

    fn block(&self, block: &mut Block) {
        self.span(&mut block.span);
        for Entry { name, values, span } in &mut block.entries {
            self.name(name);
            values.iter_mut().for_each(|value| self.value(value));
            self.span(span);
        }
    }

    fn value(&self, value: &mut Value) {
        match value {
            Value::Expr(e) => self.expr(e),
            Value::Labelled(name, e) => {
                self.name(name);
                self.expr(e);
            }
            Value::Range(name, ends) => {
                self.name(name);
                ends.iter_mut().for_each(|e| self.expr(e));
            }
            Value::Text(text) => self.text(text),
            Value::Block(name, block) => {
                name.iter_mut().for_each(|name| self.name(name));
                self.block(block);
            }
            Value::Placed(e, block) => {
                self.expr(e);
                self.block(block);
            }
            Value::List(points, span) => {
                self.points(points);
                self.span(span);
            }
            Value::Spline(spline) | Value::Loop(spline) => self.spline(spline),
            Value::Loops { file, unit, span } => {
                self.text(file);
                unit.iter_mut().for_each(|unit| self.name(unit));
                self.span(span);
            }
            Value::Revolve(revolved, span) => {
                match revolved {
                    Revolved::OfBlade(path) => self.path(path),
                    Revolved::Own(spline) => self.spline(spline),
                }
                self.span(span);
            }
        }
    }

    fn points(&self, points: &mut [Point]) {
        for Point { coordinates, span } in points {
            coordinates.iter_mut().for_each(|e| self.expr(e));
            self.span(span);
        }
    }

    fn spline(&self, Spline { points, unit, span }: &mut Spline) {
        match points {
            SplinePoints::Inline(points) => self.points(points),
            SplinePoints::File { file, curve } => {
                self.text(file);
                self.name(curve);
            }
        }
        unit.iter_mut().for_each(|unit| self.name(unit));
        self.span(span);
    }

    fn path(&self, Path { names, span }: &mut Path) {
        names.iter_mut().for_each(|name| self.name(name));
        self.span(span);
    }

    fn expr(&self, Expr { kind, span }: &mut Expr) {
        self.span(span);
        match kind {
            ExprKind::Number(_, unit) => unit.iter_mut().for_each(|unit| self.name(unit)),
            ExprKind::Path(path) => self.path(path),
            ExprKind::Negative(inner) => self.expr(inner),
            ExprKind::Chain(first, rest) => {
                self.expr(first);
                rest.iter_mut().for_each(|(_, operand)| self.expr(operand));
            }
        }
    }
}
