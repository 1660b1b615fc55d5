//! Diagnostics as a JUnit XML report, the form that build servers show as test results.

use super::{Diag, Severity, Sink};
use crate::source::SourceMap;

/// One report: a passed case for each name in `held`, a failed case for each error, and the warnings and remarks as the
/// output of the suite. Without any error a case `no errors` passes, so that an empty run is not taken for a lost one.
pub fn junit(sink: &Sink, sources: &SourceMap, held: &[String]) -> String {
    let errors: Vec<&Diag> = sink.diags().iter().filter(|d| d.severity == Severity::Error).collect();
    let mut cases = String::new();
    for name in held {
        cases.push_str(&format!("    <testcase classname=\"contract\" name=\"{}\"/>\n", escape(name)));
    }
    for diag in &errors {
        let (place, attributes) = place(diag, sources);
        let mut body = place;
        for note in &diag.notes {
            body.push_str(&format!("note: {note}\n"));
        }
        if let Some(help) = &diag.help {
            body.push_str(&format!("help: {help}\n"));
        }
        cases.push_str(&format!(
            "    <testcase classname=\"{code}\" name=\"{name}\"{attributes}>\n      <failure type=\"{code}\" message=\"{message}\">{body}</failure>\n    </testcase>\n",
            code = diag.code.id(),
            name = escape(&format!("{}: {}", diag.code.0.title, diag.message)),
            message = escape(&diag.message),
            body = escape(&body),
        ));
    }
    if errors.is_empty() {
        cases.push_str("    <testcase classname=\"run\" name=\"no errors\"/>\n");
    }
    let count = held.len() + errors.len().max(1);
    let mut others = String::new();
    for diag in sink.diags().iter().filter(|d| d.severity != Severity::Error) {
        let word = if diag.severity == Severity::Warning { "warning" } else { "remark" };
        others.push_str(&format!("{word} {}: {}\n{}", diag.code.id(), diag.message, place(diag, sources).0));
    }
    let output =
        if others.is_empty() { String::new() } else { format!("    <system-out>{}</system-out>\n", escape(&others)) };
    let counts = format!("tests=\"{count}\" failures=\"{}\" errors=\"0\"", errors.len());
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {counts}>\n  <testsuite name=\"impellerc\" {counts} skipped=\"0\">\n{cases}{output}  </testsuite>\n</testsuites>\n"
    )
}

/// Lines that say where a diagnostic lies, and the attributes of its first place.
fn place(diag: &Diag, sources: &SourceMap) -> (String, String) {
    let mut lines = String::new();
    let mut attributes = String::new();
    for label in &diag.labels {
        let Some(file) = sources.get(label.span.source) else { continue };
        let (line, column) = sources.line_column(label.span);
        lines.push_str(&format!("{}:{line}:{column}: {}\n", file.name, label.text));
        if attributes.is_empty() {
            attributes = format!(" file=\"{}\" line=\"{line}\"", escape(&file.name));
        }
    }
    if let Some(place) = &diag.place {
        let p = place.point;
        lines.push_str(&format!("place: {} at ({:.4}, {:.4}, {:.4}) mm\n", place.what, p.x, p.y, p.z));
    }
    (lines, attributes)
}

/// Text of an element or an attribute. Characters that XML 1.0 does not have become question marks.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' => out.push(c),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('?'),
            c => out.push(c),
        }
    }
    out
}
