//! Diagnostics for people (miette) and for tools (JSON lines).

use super::excerpt::Excerpt;
use super::shown::{self, bounded, visible};
use super::{Diag, Label, Severity, Sink};
use base::source::{SourceMap, Span};
use base::units::trim;
use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, SourceCode};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::fmt::{self, Write as _};

/// Most diagnostics of a severity that the human report shows.
const MAX_SHOWN: usize = 100;

/// Width of the human report in columns.
const REPORT_COLUMNS: usize = 120;

/// A diagnostic as miette sees it, with its text.
#[derive(Debug)]
struct Report<'a> {
    diag: &'a Diag,
    message: Cow<'a, str>,
    help: Option<Cow<'a, str>>,
    excerpt: Option<Excerpt>,
}

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
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
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|s| s as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let labels = &self.excerpt.as_ref()?.labels;
        (!labels.is_empty()).then(|| Box::new(labels.iter().cloned()) as Box<dyn Iterator<Item = LabeledSpan>>)
    }
}

/// All diagnostics of a run as text: remarks and warnings, then errors, then a line with their numbers. The errors,
/// which stop the compilation, are therefore last on the screen.
pub fn human(sink: &Sink, sources: &SourceMap, colour: bool) -> String {
    let theme = if colour { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
    let handler =
        GraphicalReportHandler::new_themed(theme).with_width(REPORT_COLUMNS).with_links(false).with_cause_chain();
    let mut out = String::new();
    let mut counts = Vec::new();
    for (severity, word) in [(Severity::Remark, "remark"), (Severity::Warning, "warning"), (Severity::Error, "error")] {
        let all: Vec<&Diag> = sink.diags().iter().filter(|d| d.severity == severity).collect();
        for diag in all.iter().take(MAX_SHOWN).map(|d| bounded(d)) {
            let report = report(&diag, sources);
            if handler.render_report(&mut out, &report).is_err() {
                out.push_str(&report.message);
            }
            out.push_str(&facts(&diag, report.excerpt.as_ref().map_or(&[], |e| &e.unseen), sources));
            out.push('\n');
        }
        let count = all.len() + sink.further(severity);
        if count > MAX_SHOWN {
            out.push_str(&format!("... and {} more\n", count - MAX_SHOWN));
        }
        match count {
            0 => {}
            1 => counts.insert(0, format!("1 {word}")),
            n => counts.insert(0, format!("{n} {word}s")),
        }
    }
    if let Some(code) = sink.diags().iter().rfind(|d| d.severity == Severity::Error).map(|d| d.code) {
        out.push_str(&format!("{}; see `impellerc explain {code}`\n", counts.join(", ")));
    } else if !counts.is_empty() {
        out.push_str(&format!("{}\n", counts.join(", ")));
    }
    out
}

/// One diagnostic with the labels that lie in the file of its first label.
fn report<'a>(diag: &'a Diag, sources: &SourceMap) -> Report<'a> {
    let primary = diag.labels.first().map(|l| l.span.source);
    let labels: Vec<&Label> = diag.labels.iter().filter(|l| Some(l.span.source) == primary).collect();
    let excerpt = primary.and_then(|file| Excerpt::new(file, &labels, sources));
    Report { diag, message: visible(&diag.message), help: diag.help.as_deref().map(visible), excerpt }
}

/// Lines below the report: the place on the part, labels in other files, labels that the marked text does not show,
/// notes.
fn facts(diag: &Diag, unseen: &[Label], sources: &SourceMap) -> String {
    let mut out = String::new();
    if let Some(place) = &diag.place {
        let [x, y, z] = [place.point.x, place.point.y, place.point.z].map(|v| trim(v, 4));
        let _ = writeln!(out, "  place: {} at ({x}, {y}, {z}) mm", visible(&place.what));
    }
    let primary = diag.labels.first().map(|l| l.span.source);
    let elsewhere = diag.labels.iter().filter(|l| Some(l.span.source) != primary);
    for label in elsewhere.chain(unseen) {
        let name = sources.get(label.span.source).map_or("?", |f| f.name.as_str());
        let (line, column) = sources.line_column(label.span);
        let _ = writeln!(out, "  {}:{line}:{column}: {}", visible(name), visible(&label.text));
    }
    for note in &diag.notes {
        let _ = writeln!(out, "  note: {}", visible(note));
    }
    out
}

/// All diagnostics of a run as JSON, one object per line: `code`, `severity`, `message`, `labels` (file, byte range,
/// line and column from 1, text), `help`, `notes`, `fix` (file, byte range, replacement), `place`.
pub fn json(sink: &Sink, sources: &SourceMap) -> String {
    let mut out = String::new();
    for diag in shown::all(sink) {
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
        out.push_str(&shown::json(&value.to_string()));
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
