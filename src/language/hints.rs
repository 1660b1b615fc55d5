//! Figures beside the text that follow from it: cutting speed, feed per tooth, values of arithmetic.

use super::Understood;
use crate::job::model::{OperationSpec, ToolSpec};
use crate::syntax::ast::{Block, Expr, ExprKind, ItemKind, Value};
use crate::units::trim;

/// A figure behind a place of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hint {
    /// Byte behind which it stands.
    pub at: usize,
    /// The figure.
    pub text: String,
    /// What it is, in a sentence.
    pub meaning: &'static str,
}

/// The figures of a text, in its order. Those of operations need a text without faults.
pub fn hints(understood: &Understood) -> Vec<Hint> {
    let mut found = Vec::new();
    let mut operations = understood.job.operations.iter().filter(|_| understood.job.whole);
    for item in &understood.tree.items {
        match &item.kind {
            ItemKind::Let { name, value } if computed(value) => {
                let value = understood.job.values.get(&name.text);
                found.extend(value.map(|value| Hint {
                    at: item.span.range().end,
                    text: format!("= {value}"),
                    meaning: "The value of the expression.",
                }));
            }
            ItemKind::Operation { body, .. } => {
                let Some(operation) = operations.next() else { continue };
                let tool = understood.job.tools.get(operation.tool).and_then(Option::as_ref);
                found.extend(tool.into_iter().flat_map(|tool| of_operation(body, operation, tool)));
            }
            _ => {}
        }
    }
    found.sort_by_key(|hint| hint.at);
    found
}

/// True for an expression that is more than a number.
fn computed(value: &Expr) -> bool {
    !matches!(&value.kind, ExprKind::Number(..))
}

/// Cutting speed behind `speed`, feed per tooth or feed behind `feed`.
fn of_operation(body: &Block, operation: &OperationSpec, tool: &ToolSpec) -> Vec<Hint> {
    let value_of = |name: &str| {
        let entry = body.entries.iter().find(|entry| entry.name.text == name)?;
        match entry.values.as_slice() {
            [Value::Expr(value)] => Some(value),
            _ => None,
        }
    };
    let (speed, feed) = (operation.speed.get(), operation.feed.get());
    let mut found = Vec::new();
    found.extend(value_of("speed").map(|value| Hint {
        at: value.span.range().end,
        text: format!("= {} m/min", trim(std::f64::consts::PI * tool.diameter.get() * speed / 1e3, 1)),
        meaning: "Cutting speed at the largest diameter of the tool.",
    }));
    found.extend(value_of("feed").map(|value| {
        let by_tooth = matches!(&value.kind, ExprKind::Number(_, Some(unit)) if unit.text == "mm/tooth");
        match by_tooth {
            true => Hint {
                at: value.span.range().end,
                text: format!("= {} mm/min", trim(feed, 1)),
                meaning: "Feed at the speed of the operation.",
            },
            false => Hint {
                at: value.span.range().end,
                text: format!("= {} mm/tooth", trim(feed / speed / f64::from(tool.flutes), 4)),
                meaning: "Feed per tooth at the speed of the operation.",
            },
        }
    }));
    found
}
