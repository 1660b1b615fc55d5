//! Whether every number of a certificate is finite. JSON writes `null` for a number that is not finite, as for an
//! absent value, so that nobody would notice it.

use super::Certificate;
use ciborium::Value;
use diagnostics::{Diag, Sink, codes::verification};
use ir::{Motion, Program};
use serde::Serialize;

/// Reports figures that are not finite: they prove nothing, and no text shows them.
pub fn report(program: &Program, motion: &Motion, certificate: &Certificate, sink: &mut Sink) {
    let mut unknown = match not_finite(certificate) {
        Ok(unknown) => unknown,
        Err(reason) => vec![vec![reason]],
    };
    // Figures that appear only in the report.
    let shown = certificate.stock.iter().flat_map(|s| &s.operations);
    let curves = shown.filter(|o| o.moves.iter().any(|m| !(m.rate.get().is_finite() && m.arc.get().is_finite())));
    unknown
        .extend(curves.map(|o| ["stock", "operations", &o.operation.to_string(), "moves"].map(str::to_owned).into()));
    let Some(first) = unknown.first() else { return };
    let operation =
        first.windows(2).find(|w| ["operations", "runs", "other_rules", "fastest"].contains(&w[0].as_str()));
    let operation = operation.and_then(|w| w[1].parse::<usize>().ok()).and_then(|o| motion.operations.get(o));
    let name = operation.map_or(String::new(), |o| format!(" of `{}`", program.operations[o.operation].name));
    let mut diag = Diag::error(
        verification::NOT_A_NUMBER,
        format!("`{}`{name} cannot be computed: it is not a finite number", first.join(".")),
    )
    .help("compare feeds and sizes with the limits of the machine; if they are usual, report the job file");
    if unknown.len() > 1 {
        diag = diag.note(format!("{} further figures of the certificate are no numbers", unknown.len() - 1));
    }
    if let Some(o) = operation {
        diag = diag.label(program.operations[o.operation].span, "this operation");
    }
    sink.push(diag);
}

/// Places of numbers that are not finite: names of fields and indices, from the outside inward.
///
/// # Errors
/// A value that cannot be serialized, with the reason; no such value is known.
pub fn not_finite(value: &impl Serialize) -> Result<Vec<Vec<String>>, String> {
    let value = Value::serialized(value).map_err(|e| e.to_string())?;
    let mut found = Vec::new();
    visit(&value, &mut Vec::new(), &mut found);
    Ok(found)
}

fn visit(value: &Value, path: &mut Vec<String>, found: &mut Vec<Vec<String>>) {
    match value {
        Value::Float(number) if !number.is_finite() => found.push(path.clone()),
        Value::Array(values) => {
            for (i, value) in values.iter().enumerate() {
                step(i.to_string(), value, path, found);
            }
        }
        Value::Map(fields) => {
            for (key, value) in fields {
                step(key.as_text().unwrap_or_default().to_owned(), value, path, found);
            }
        }
        _ => {}
    }
}

fn step(name: String, value: &Value, path: &mut Vec<String>, found: &mut Vec<Vec<String>>) {
    path.push(name);
    visit(value, path, found);
    path.pop();
}
