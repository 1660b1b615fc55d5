//! Figures beside the text that follow from it: cutting speed, feed per tooth, values of arithmetic.

use super::Understood;
use crate::model::{OperationSpec, ToolSpec};
use base::units::trim;
use syntax::ast::{Block, Expr, ExprKind, ItemKind, Value};

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
            ItemKind::Operation { body, .. } if understood.job.whole => {
                // An item with several tools is as many operations.
                let begins = |operation: &&OperationSpec| operation.span.start == item.span.start;
                let cuts = understood.job.operations.iter().filter(begins).filter_map(|operation| {
                    let tool = understood.job.tools.get(operation.tool)?.as_ref()?;
                    Some(ToolInCut { speed: operation.speed.get(), feed: operation.feed.get(), tool })
                });
                found.extend(of_operation(body, &cuts.collect::<Vec<_>>()));
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

/// An operation with one of its tools.
struct ToolInCut<'j> {
    /// rpm.
    speed: f64,
    /// mm/min.
    feed: f64,
    tool: &'j ToolSpec,
}

/// Cutting speed behind `speed`, feed per tooth or feed behind `feed`; of several tools each figure once.
fn of_operation(body: &Block, cuts: &[ToolInCut<'_>]) -> Vec<Hint> {
    let value_of = |name: &str| {
        let entry = body.entries.iter().find(|entry| entry.name.text == name)?;
        match entry.values.as_slice() {
            [Value::Expr(value)] => Some(value),
            _ => None,
        }
    };
    let has_unit = |value: &Expr, due: &str| matches!(&value.kind, ExprKind::Number(_, Some(unit)) if unit.text == due);
    let figures = |figure: &dyn Fn(&ToolInCut<'_>) -> f64, digits: usize, unit: &str| {
        let mut texts: Vec<String> = cuts.iter().map(|cut| trim(figure(cut), digits)).collect();
        texts.dedup();
        format!("= {} {unit}", texts.join(", "))
    };
    let mut found = Vec::new();
    if cuts.is_empty() {
        return found;
    }
    if let Some(value) = value_of("speed") {
        let (text, meaning) = if has_unit(value, "m/min") {
            (figures(&|cut| cut.speed, 0, "rpm"), "Spindle speed.")
        } else {
            let speed = |cut: &ToolInCut<'_>| std::f64::consts::PI * cut.tool.diameter.get() * cut.speed / 1e3;
            (figures(&speed, 1, "m/min"), "Cutting speed at `diameter` of the tool.")
        };
        found.push(Hint { at: value.span.range().end, text, meaning });
    }
    if let Some(value) = value_of("feed") {
        let (text, meaning) = if has_unit(value, "mm/tooth") {
            (figures(&|cut| cut.feed, 1, "mm/min"), "Feed at the speed of the operation.")
        } else {
            let of_tooth = |cut: &ToolInCut<'_>| cut.feed / cut.speed / f64::from(cut.tool.flutes);
            (figures(&of_tooth, 4, "mm/tooth"), "Feed per tooth at the speed of the operation.")
        };
        found.push(Hint { at: value.span.range().end, text, meaning });
    }
    found
}
