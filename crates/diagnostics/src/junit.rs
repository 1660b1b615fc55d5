//! Diagnostics as a JUnit XML report, the form that build servers show as test results.

use super::{Diag, Severity, Sink, shown};
use base::source::{SourceMap, Span};

/// A contract that was judged, as a case of the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Judged {
    /// Name that is the same in every run, since servers compare by it: `gouge on hub <= 0.0050 mm`.
    pub name: String,
    /// Found value, for people.
    pub found: String,
    /// Its text in the job.
    pub span: Span,
    /// Whether the contract holds.
    pub holds: bool,
}

/// One report with a case for each contract that was judged, passed or failed, and a failed case for each further
/// error. Warnings and remarks are the output of the suite. Without any error a case `no errors` passes, so that an
/// empty run is not mistaken for a lost one.
pub fn junit(sink: &Sink, sources: &SourceMap, contracts: &[Judged]) -> String {
    let shown = shown::all(sink);
    let mut errors: Vec<&Diag> = shown.iter().filter(|d| d.severity == Severity::Error).collect();
    let failures = errors.len();
    let mut cases = String::new();
    for contract in contracts {
        let name = escape(&contract.name);
        let (_, attributes) = located(std::iter::once(contract.span), sources);
        let is_own = |d: &&Diag| !contract.holds && d.labels.iter().any(|l| l.span == contract.span);
        let body = match errors.iter().position(is_own) {
            Some(index) => failure(errors.remove(index), sources),
            None => format!("      <system-out>found {}</system-out>\n", escape(&contract.found)),
        };
        cases.push_str(&format!(
            "    <testcase classname=\"contract\" name=\"{name}\"{attributes}>\n{body}    </testcase>\n"
        ));
    }
    for diag in &errors {
        cases.push_str(&format!(
            "    <testcase classname=\"{}\" name=\"{}\"{}>\n{}    </testcase>\n",
            diag.code.id(),
            escape(&format!("{}: {}", diag.code.0.title, diag.message)),
            place(diag, sources).1,
            failure(diag, sources),
        ));
    }
    let mut count = contracts.len() + errors.len();
    if failures == 0 {
        cases.push_str("    <testcase classname=\"run\" name=\"no errors\"/>\n");
        count += 1;
    }
    let mut others = String::new();
    for diag in shown.iter().filter(|d| d.severity != Severity::Error) {
        let word = if diag.severity == Severity::Warning { "warning" } else { "remark" };
        others.push_str(&format!("{word} {}: {}\n{}", diag.code.id(), diag.message, place(diag, sources).0));
    }
    let output =
        if others.is_empty() { String::new() } else { format!("    <system-out>{}</system-out>\n", escape(&others)) };
    let counts = format!("tests=\"{count}\" failures=\"{failures}\" errors=\"0\"");
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {counts}>\n  <testsuite name=\"impellerc\" {counts} skipped=\"0\">\n{cases}{output}  </testsuite>\n</testsuites>\n"
    )
}

/// The failure, with its place, its facts and the help line.
fn failure(diag: &Diag, sources: &SourceMap) -> String {
    let mut body = place(diag, sources).0;
    for note in &diag.notes {
        body.push_str(&format!("note: {note}\n"));
    }
    if let Some(help) = &diag.help {
        body.push_str(&format!("help: {help}\n"));
    }
    let (code, message, body) = (diag.code.id(), escape(&diag.message), escape(&body));
    format!("      <failure type=\"{code}\" message=\"{message}\">{body}</failure>\n")
}

/// Lines with the positions of a diagnostic, and the attributes of its first position.
fn place(diag: &Diag, sources: &SourceMap) -> (String, String) {
    let (places, attributes) = located(diag.labels.iter().map(|l| l.span), sources);
    let marked = places.iter().zip(&diag.labels).filter_map(|(p, l)| Some(format!("{}: {}\n", p.as_ref()?, l.text)));
    let mut lines: String = marked.collect();
    if let Some(place) = &diag.place {
        let p = place.point;
        lines.push_str(&format!("place: {} at ({:.4}, {:.4}, {:.4}) mm\n", place.what, p.x, p.y, p.z));
    }
    (lines, attributes)
}

/// Each span as `file:line:column`, and the attributes of the first.
fn located(spans: impl Iterator<Item = Span>, sources: &SourceMap) -> (Vec<Option<String>>, String) {
    let mut attributes = String::new();
    let mut places = Vec::new();
    for span in spans {
        let Some(file) = sources.get(span.source) else {
            places.push(None);
            continue;
        };
        let (line, column) = sources.line_column(span);
        places.push(Some(format!("{}:{line}:{column}", file.path())));
        if attributes.is_empty() {
            attributes = format!(" file=\"{}\" line=\"{line}\"", escape(file.path()));
        }
    }
    (places, attributes)
}

/// Text of an element or an attribute. Characters that XML 1.0 does not allow become question marks; others that would
/// control a terminal become references.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' => out.push(c),
            '\t' => out.push_str("&#9;"),
            c if c < ' ' || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('?'),
            c if shown::steers(c) => out.push_str(&format!("&#x{:x};", u32::from(c))),
            c => out.push(c),
        }
    }
    out
}
