//! Values along a curve or over the span: `[(0 %, 2 mm) (100 %, 1 mm)]`, or one value.

use crate::block::context::Context;
use crate::model::{DistributionSpec, SpanSpec};
use crate::property::quantity::Dimension;
use base::source::Span;
use blade::angles::limits;
use diagnostics::codes::{geometry, job as codes};
use diagnostics::{Code, Diag};
use syntax::ast::{Expr, ExprKind, Name, Value};

/// The value of an entry that takes one.
pub(super) fn single<'a>(word: &Name, values: &[&'a Value], cx: &mut Context<'_>) -> Option<&'a Value> {
    if let [value] = values {
        return Some(value);
    }
    cx.sink.push(
        Diag::error(codes::WRONG_FORM, format!("`{}` takes one list of values", word.text))
            .label(word.span, "one list is expected")
            .help("put all values into one list: `[(0 %, ...) (100 %, ...)]`"),
    );
    None
}

/// A share from 0 to 1; a fault of its value has a code of its own.
pub(super) fn share(expr: &Expr, what: &str, code: Code, cx: &mut Context<'_>) -> Option<f64> {
    let value = cx.scope.expect(expr, Dimension::NONE, what, cx.sink)?;
    if (0.0..=1.0).contains(&value) {
        return Some(value);
    }
    cx.sink.push(
        Diag::error(code, format!("{what} must be from 0 % to 100 %"))
            .label(expr.span, format!("this is {} %", base::units::trim(value * 100.0, 4)))
            .help(match &expr.kind {
                ExprKind::Number(number, None) if (1.0..=100.0).contains(number) => {
                    format!("write `{} %`: a number without `%` is a share of 1", base::units::trim(*number, 4))
                }
                _ => "give a share from 0 % to 100 %".to_owned(),
            }),
    );
    None
}

/// A distribution of a dimension, by its name.
pub(super) fn distribution(
    value: &Value,
    name: &str,
    due: Dimension,
    example: &str,
    cx: &mut Context<'_>,
) -> Option<DistributionSpec> {
    let what = format!("`{name}`");
    let (given, span) = match value {
        Value::Expr(expr) => {
            let constant = cx.scope.expect(expr, due, &what, cx.sink)?;
            return Some(DistributionSpec { points: vec![[0.0, constant]], span: expr.span });
        }
        Value::List(points, span) => (points, *span),
        other => {
            cx.sink.push(
                Diag::error(codes::WRONG_FORM, format!("{what} takes a value or a list of values"))
                    .label(other.span(), "shares and values in brackets are expected")
                    .help(format!("write it like `{example}`")),
            );
            return None;
        }
    };
    let fault = |at: Span, label: String, cx: &mut Context<'_>| {
        cx.sink.push(
            Diag::error(geometry::DISTRIBUTION, format!("the values of {what} do not cover 0 % to 100 %"))
                .label(at, label)
                .help(format!("give values with growing shares, the first at 0 %, the last at 100 %: `{example}`")),
        );
    };
    if !(2..=limits::VALUES).contains(&given.len()) {
        fault(span, format!("2 to {} values are expected, not {}", limits::VALUES, given.len()), cx);
        return None;
    }
    let mut points: Vec<[f64; 2]> = Vec::new();
    for (k, point) in given.iter().enumerate() {
        let [at, value] = point.coordinates.as_slice() else {
            cx.sink.push(
                Diag::error(codes::WRONG_FORM, format!("a value of {what} has a share and a value"))
                    .label(point.span, "two numbers are expected")
                    .help(format!("write it like `{example}`")),
            );
            return None;
        };
        let share_at = share(at, &format!("a share of {what}"), geometry::DISTRIBUTION, cx)?;
        let value = cx.scope.expect(value, due, &what, cx.sink)?;
        if (k == 0 && share_at != 0.0) || (k + 1 == given.len() && share_at != 1.0) {
            fault(at.span, if k == 0 { "0 % is expected" } else { "100 % is expected" }.to_owned(), cx);
            return None;
        }
        if points.last().is_some_and(|[before, _]| share_at - before < limits::MIN_SHARE_STEP) {
            fault(at.span, "this share is not greater than the one before by 0.01 % or more".to_owned(), cx);
            return None;
        }
        points.push([share_at, value]);
    }
    Some(DistributionSpec { points, span })
}

/// Checks that what is given at spans is given from hub to shroud, or once for all spans.
pub(super) fn at_spans<T>(
    rows: Vec<SpanSpec<T>>,
    what: &str,
    head: Span,
    cx: &mut Context<'_>,
) -> Option<Vec<SpanSpec<T>>> {
    let help = "give the spans from `span 0 %` to `span 100 %` in order; one span alone holds for all";
    let (at, label) = match rows.as_slice() {
        [] => (head, format!("no span has {what}")),
        [_] => return Some(rows),
        [.., last] if rows.len() > limits::MAX_SPANS => (last.span, format!("more than {} spans", limits::MAX_SPANS)),
        [first, .., last] => {
            let falls = rows.windows(2).find(|pair| pair[1].at - pair[0].at < limits::MIN_SHARE_STEP);
            if let Some(pair) = falls {
                (pair[1].span, "this span is not above the one before by 0.01 % or more".to_owned())
            } else if first.at != 0.0 {
                (first.span, format!("the first span with {what} is not 0 %"))
            } else if last.at != 1.0 {
                (last.span, format!("the last span with {what} is not 100 %"))
            } else {
                return Some(rows);
            }
        }
    };
    let diag = Diag::error(geometry::SPANS, format!("the spans with {what} do not go from hub to shroud"));
    cx.sink.push(diag.label(at, label).help(help));
    None
}
