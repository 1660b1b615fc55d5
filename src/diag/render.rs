//! Diagnostics for people (miette) and for tools (JSON lines).

use super::{Diag, Severity, Sink};
use crate::source::{SourceMap, Span};
use crate::units::trim;
use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, SourceCode};
use serde_json::{Value, json};
use std::fmt::{self, Write as _};

/// Most diagnostics of a severity that the human report shows.
const SHOWN: usize = 100;

/// Width of the human report in columns.
const WIDTH: usize = 120;

/// A diagnostic as miette sees it, with its text.
#[derive(Debug)]
struct Report<'a> {
    diag: &'a Diag,
    source: Option<NamedSource<String>>,
    labels: Vec<LabeledSpan>,
}

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.diag.message)
    }
}

impl std::error::Error for Report<'_> {}

impl miette::Diagnostic for Report<'_> {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.diag.code))
    }

    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.diag.severity {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
            Severity::Remark => miette::Severity::Advice,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.diag.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|s| s as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        (!self.labels.is_empty())
            .then(|| Box::new(self.labels.iter().cloned()) as Box<dyn Iterator<Item = LabeledSpan>>)
    }
}

/// All diagnostics of a run as text: remarks and warnings first, then errors, then a line that counts them, so that
/// what stops the compilation stands last on the screen.
pub fn human(sink: &Sink, sources: &SourceMap, colour: bool) -> String {
    let theme = if colour { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
    let handler = GraphicalReportHandler::new_themed(theme).with_width(WIDTH).with_links(false).with_cause_chain();
    let mut out = String::new();
    let mut counts = Vec::new();
    for (severity, word) in [(Severity::Remark, "remark"), (Severity::Warning, "warning"), (Severity::Error, "error")] {
        let all: Vec<&Diag> = sink.diags().iter().filter(|d| d.severity == severity).collect();
        for diag in all.iter().take(SHOWN) {
            if handler.render_report(&mut out, &report(diag, sources)).is_err() {
                out.push_str(&diag.message);
            }
            out.push_str(&facts(diag, sources));
            out.push('\n');
        }
        if all.len() > SHOWN {
            out.push_str(&format!("... and {} more\n", all.len() - SHOWN));
        }
        match all.len() {
            0 => {}
            1 => counts.insert(0, format!("1 {word}")),
            n => counts.insert(0, format!("{n} {word}s")),
        }
    }
    if let Some(code) = sink.diags().iter().rfind(|d| d.severity == Severity::Error).map(|d| d.code) {
        out.push_str(&format!("{}; for more try `impellerc explain {code}`\n", counts.join(", ")));
    } else if !counts.is_empty() {
        out.push_str(&format!("{}\n", counts.join(", ")));
    }
    out
}

/// One diagnostic with the labels that lie in the file of the first one.
fn report<'a>(diag: &'a Diag, sources: &SourceMap) -> Report<'a> {
    let primary = diag.labels.first().map(|l| l.span.source);
    let Some(file) = primary.and_then(|id| sources.get(id)) else {
        return Report { diag, source: None, labels: Vec::new() };
    };
    let mut labels = Vec::new();
    for label in diag.labels.iter().filter(|l| Some(l.span.source) == primary) {
        let range = inside(label.span, &file.text);
        let text = Some(label.text.clone());
        labels.push(if labels.is_empty() {
            LabeledSpan::new_primary_with_span(text, range)
        } else {
            LabeledSpan::new_with_span(text, range)
        });
    }
    Report { diag, source: Some(NamedSource::new(&file.name, file.text.clone())), labels }
}

/// Lines below the report: the place on the part, labels in other files, notes.
fn facts(diag: &Diag, sources: &SourceMap) -> String {
    let mut out = String::new();
    if let Some(place) = &diag.place {
        let [x, y, z] = [place.point.x, place.point.y, place.point.z].map(|v| trim(v, 4));
        let _ = writeln!(out, "  place: {} at ({x}, {y}, {z}) mm", place.what);
    }
    let primary = diag.labels.first().map(|l| l.span.source);
    for label in diag.labels.iter().filter(|l| Some(l.span.source) != primary) {
        let name = sources.get(label.span.source).map_or("?", |f| f.name.as_str());
        let (line, column) = sources.line_column(label.span);
        let _ = writeln!(out, "  {name}:{line}:{column}: {}", label.text);
    }
    for note in &diag.notes {
        let _ = writeln!(out, "  note: {note}");
    }
    out
}

/// A range that lies in the text, on character boundaries.
fn inside(span: Span, text: &str) -> std::ops::Range<usize> {
    let range = span.range();
    let snap = |mut at: usize| {
        at = at.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let start = snap(range.start);
    let end = snap(range.end).max(start);
    // A block or a list of points is marked by its first line.
    let line = text[start..end].find('\n').map_or(end, |n| start + n);
    start..line
}

/// All diagnostics of a run as JSON, one object a line: `code`, `severity`, `message`, `labels` (file, byte range,
/// line and column from 1, text), `help`, `notes`, `fix` (file, byte range, replacement), `place`.
pub fn json(sink: &Sink, sources: &SourceMap) -> String {
    let mut out = String::new();
    for diag in sink.diags() {
        let labels: Vec<Value> = diag
            .labels
            .iter()
            .map(|label| {
                let mut value = range(label.span, sources);
                value["text"] = json!(label.text);
                value
            })
            .collect();
        let fix = diag.fix.as_ref().map(|fix| {
            let mut value = range(fix.span, sources);
            value["replacement"] = json!(fix.replacement);
            value
        });
        let place = diag.place.as_ref().map(|p| json!({ "what": p.what, "point": [p.point.x, p.point.y, p.point.z] }));
        let value = json!({
            "code": diag.code.id(),
            "severity": severity(diag.severity),
            "message": diag.message,
            "labels": labels,
            "help": diag.help,
            "notes": diag.notes,
            "fix": fix,
            "place": place,
        });
        out.push_str(&value.to_string());
        out.push('\n');
    }
    out
}

fn severity(severity: Severity) -> &'static str {
    match severity {
        Severity::Remark => "remark",
        Severity::Warning => "warning",
        Severity::Error => "error",
    }
}

fn range(span: Span, sources: &SourceMap) -> Value {
    let (line, column) = sources.line_column(span);
    let file = sources.get(span.source).map(|f| f.path());
    json!({ "file": file, "start": span.start, "end": span.end, "line": line, "column": column })
}
