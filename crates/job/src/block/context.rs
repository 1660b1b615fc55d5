//! Context for resolving an item.

use super::eval::LetScope;
use crate::files::Files;
use base::source::{SourceMap, Span};
use diagnostics::Sink;
use syntax::ast::{Item, ItemKind};

/// Context for resolving an item.
pub(crate) struct Context<'a> {
    pub(crate) scope: LetScope,
    pub(crate) files: &'a mut dyn Files,
    pub(crate) sources: &'a mut SourceMap,
    pub(crate) sink: &'a mut Sink,
    /// Length of the texts in which curves were looked up, bytes.
    pub(crate) searched_bytes: usize,
}

/// The span of an item in messages: up to its block.
pub(crate) fn head(item: &Item) -> Span {
    let end = match &item.kind {
        ItemKind::Part { name, .. } | ItemKind::Post { name, .. } => name.span.end,
        ItemKind::Stock { kind, .. } => kind.span.end,
        ItemKind::Operation { kind, name, .. } => name.as_ref().unwrap_or(kind).span.end,
        ItemKind::Tool { name, .. } => name.span.end,
        _ => item.span.end,
    };
    Span { end, ..item.span }
}
