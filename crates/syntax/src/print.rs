//! Text form of the syntax tree: one line for each item or entry, with its place in bytes.

use super::ast::{
    Block, Expr, ExprKind, File, ItemKind, Name, Operator, Point, Revolved, ScopeTarget, Spline, SplinePoints,
    ToolSource, Value,
};
use std::fmt::Write;

/// The tree as text.
pub fn print(file: &File) -> String {
    let mut out = String::new();
    for item in &file.items {
        let (head, block) = match &item.kind {
            ItemKind::Edition(n) => (format!("edition {}", n.text), None),
            ItemKind::Use { kind, what } => (format!("use {} {:?}", kind.text, what.text), None),
            ItemKind::Let { name, value } => (format!("let {} = {}", name.text, expr(value)), None),
            ItemKind::Part { name, body } => (format!("part {}", name.text), Some(body)),
            ItemKind::Stock { kind, body } => (format!("stock {}", kind.text), Some(body)),
            ItemKind::Tool { name, source: ToolSource::Library(t) } => {
                (format!("tool {} = {:?}", name.text, t.text), None)
            }
            ItemKind::Tool { name, source: ToolSource::Shape(kind, body) } => {
                (format!("tool {} = {}", name.text, kind.text), Some(body))
            }
            ItemKind::Operation { kind, name, body } => {
                let name = name.as_ref().map_or(String::new(), |n| format!(" {}", n.text));
                (format!("operation {}{name}", kind.text), Some(body))
            }
            ItemKind::Operations(word) => (format!("operations {}", word.text), None),
            ItemKind::Tolerance(values) => (format!("tolerance {}", line(values)), None),
            ItemKind::Require { what, body, relation, bound, outside, scope } => {
                let what = quantity(what, body.as_ref());
                let outside = outside.as_ref().map_or(String::new(), |o| format!(" outside of {}", o.text));
                (format!("require {what} {} {}{outside}{}", relation.text, expr(bound), targets(scope)), None)
            }
            ItemKind::Allow { what, body, scope, reason } => {
                (format!("allow {}{} {:?}", quantity(what, body.as_ref()), targets(scope), reason.text), None)
            }
            ItemKind::Post { name, body } => (format!("post {}", name.text), body.as_ref()),
        };
        let _ = writeln!(out, "{head} ; {}..{}", item.span.start, item.span.end);
        if let Some(block) = block {
            entries(&mut out, block, 1);
        }
    }
    out
}

fn quantity(what: &Name, body: Option<&Name>) -> String {
    body.map_or_else(|| what.text.clone(), |b| format!("{} {}", what.text, b.text))
}

fn targets(scope: &[ScopeTarget]) -> String {
    let words: Vec<String> = scope
        .iter()
        .map(|t| if t.operation { format!("operation {}", t.name.text) } else { t.name.text.clone() })
        .collect();
    if words.is_empty() { String::new() } else { format!(" on {}", words.join(", ")) }
}

fn entries(out: &mut String, block: &Block, depth: usize) {
    for entry in &block.entries {
        let indent = "  ".repeat(depth);
        let values = line(&entry.values);
        let _ = writeln!(out, "{indent}{} {values} ; {}..{}", entry.name.text, entry.span.start, entry.span.end);
        for value in &entry.values {
            if let Value::Block(_, inner) | Value::Placed(_, inner) = value {
                entries(out, inner, depth + 1);
            }
        }
    }
}

fn line(values: &[Value]) -> String {
    values.iter().map(value).collect::<Vec<_>>().join(", ")
}

fn value(value: &Value) -> String {
    match value {
        Value::Expr(e) => expr(e),
        Value::Labelled(name, e) => format!("{}: {}", name.text, expr(e)),
        Value::Range(name, [from, to]) => format!("{}: {} .. {}", name.text, expr(from), expr(to)),
        Value::Text(t) => format!("{:?}", t.text),
        Value::Block(name, _) => name.as_ref().map_or("block".to_owned(), |n| format!("{} block", n.text)),
        Value::Placed(at, _) => format!("{} block", expr(at)),
        Value::List(points, _) => {
            let point = |p: &Point| format!("({})", p.coordinates.iter().map(expr).collect::<Vec<_>>().join(", "));
            format!("[{}]", points.iter().map(point).collect::<Vec<_>>().join(" "))
        }
        Value::Revolve(Revolved::OfBlade(path), _) => format!("revolve {}", path.text()),
        Value::Revolve(Revolved::Own(s), _) => format!("revolve {}", curve("spline", s)),
        Value::Loops { file, unit, .. } => {
            format!("loops from {:?} {}", file.text, unit.as_ref().map_or("", |u| u.text.as_str()))
        }
        Value::Loop(s) => curve("loop", s),
        Value::Spline(s) => curve("spline", s),
    }
}

fn curve(word: &str, s: &Spline) -> String {
    let unit = s.unit.as_ref().map_or("", |u| u.text.as_str());
    match &s.points {
        SplinePoints::Inline(points) => format!("{word} of {} points {unit}", points.len()),
        SplinePoints::File { file, curve } => format!("{word} from {:?} curve {} {unit}", file.text, curve.text),
    }
}

fn expr(e: &Expr) -> String {
    match &e.kind {
        ExprKind::Number(n, unit) => unit.as_ref().map_or(n.to_string(), |u| format!("{n} {}", u.text)),
        ExprKind::Path(path) => path.text(),
        ExprKind::Negative(inner) => format!("-{}", expr(inner)),
        ExprKind::Chain(first, rest) => {
            let mut text = format!("({}", expr(first));
            for (operator, operand) in rest {
                let sign = match operator {
                    Operator::Add => '+',
                    Operator::Subtract => '-',
                    Operator::Multiply => '*',
                    Operator::Divide => '/',
                };
                let _ = write!(text, " {sign} {}", expr(operand));
            }
            text + ")"
        }
    }
}
