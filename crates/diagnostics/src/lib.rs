//! Diagnostics: one structure for all messages to the user.
//!
//! A diagnostic has a stable [`Code`] with a manual page, a message in the words of the machinist, labels on the text,
//! a help line with a remedy and, for a geometric fault, a [`Place`] on the part.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub mod code;
pub mod codes;
mod excerpt;
pub mod exit;
pub mod junit;
pub mod render;
pub mod sarif;
mod shown;

pub use code::Code;
pub use exit::Exit;

use base::source::Span;
use nalgebra::Point3;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Severity of a diagnostic. After an error the compilation stops and writes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// A fact that the reader should know.
    Remark,
    /// Probably not intended; the compilation continues.
    Warning,
    /// Stops the compilation.
    Error,
}

/// A mark on the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Range of the text.
    pub span: Span,
    /// Text of the mark.
    pub text: String,
}

/// A place on the part or on the path, in the part frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Name of the place: the operation, pass and block, or the face and its parameters.
    pub what: String,
    /// Position in mm.
    pub point: Point3<f64>,
    /// Operation of the motion and its move, where the place lies on the path.
    pub block: Option<(u32, u32)>,
}

/// A change of the text that removes the fault.
#[derive(Clone, Debug, PartialEq)]
pub struct Fix {
    /// Range to replace; empty for an insertion.
    pub span: Span,
    /// Text to put there.
    pub replacement: String,
}

/// One message.
#[derive(Clone, Debug, PartialEq)]
pub struct Diag {
    /// Stable code.
    pub code: Code,
    /// Severity.
    pub severity: Severity,
    /// One sentence.
    pub message: String,
    /// Marks on the text, the primary one first.
    pub labels: Vec<Label>,
    /// A remedy.
    pub help: Option<String>,
    /// Further facts, one per line.
    pub notes: Vec<String>,
    /// A machine-applicable change.
    pub fix: Option<Fix>,
    /// Place on the part.
    pub place: Option<Place>,
    /// Words that are known where an unknown one stands. Editors offer them; reports leave them out.
    pub known: Vec<String>,
}

/// A text of several lines for a terminal. Names and contents of files may hold characters that control the terminal;
/// these are escaped.
pub fn printable(text: &str) -> Cow<'_, str> {
    shown::visible(text)
}

impl Diag {
    fn new(severity: Severity, code: Code, message: impl Into<String>) -> Self {
        Self {
            code,
            severity,
            message: message.into(),
            labels: Vec::new(),
            help: None,
            notes: Vec::new(),
            fix: None,
            place: None,
            known: Vec::new(),
        }
    }

    /// An error.
    pub fn error(code: Code, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, code, message)
    }

    /// A warning.
    pub fn warning(code: Code, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, code, message)
    }

    /// A remark.
    pub fn remark(code: Code, message: impl Into<String>) -> Self {
        Self::new(Severity::Remark, code, message)
    }

    /// Adds a mark on the text; the first mark is the primary one.
    #[must_use]
    pub fn label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into() });
        self
    }

    /// Sets the help line.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Sets the words that are known where an unknown one stands.
    #[must_use]
    pub fn known<'a>(mut self, words: impl IntoIterator<Item = &'a str>) -> Self {
        self.known = words.into_iter().map(str::to_owned).collect();
        self
    }

    /// Adds a fact.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// Sets the machine-applicable change.
    #[must_use]
    pub fn fix(mut self, span: Span, replacement: impl Into<String>) -> Self {
        self.fix = Some(Fix { span, replacement: replacement.into() });
        self
    }

    /// Sets the place on the part.
    #[must_use]
    pub fn place(mut self, what: impl Into<String>, point: Point3<f64>) -> Self {
        self.place = Some(Place { what: what.into(), point, block: None });
        self
    }

    /// Adds the operation of the motion and the index of its move to the place, so that a message can name the block of
    /// the NC text. Has no effect without a place.
    #[must_use]
    pub fn block(mut self, operation: u32, index: u32) -> Self {
        if let Some(place) = &mut self.place {
            place.block = Some((operation, index));
        }
        self
    }
}

/// Most diagnostics of a severity that a run keeps; further ones are only counted.
const MAX_KEPT: usize = 1000;

/// Collects diagnostics of a run; equal ones are kept once.
#[derive(Clone, Debug, Default)]
pub struct Sink {
    diags: Vec<Diag>,
    /// Indices of diagnostics that may be equal: with the same code, message and primary mark.
    known: BTreeMap<Likeness, Vec<usize>>,
    /// Numbers of kept and of further diagnostics, by severity.
    counts: [Count; 3],
}

type Likeness = (&'static str, String, Option<Span>);

#[derive(Clone, Copy, Debug, Default)]
struct Count {
    kept: usize,
    further: usize,
}

impl Sink {
    /// Adds a diagnostic unless an equal one exists. Of each severity the first 1000 are kept; further ones are only
    /// counted.
    pub fn push(&mut self, diag: Diag) {
        let key = (diag.code.id(), diag.message.clone(), diag.labels.first().map(|l| l.span));
        let alike = self.known.get(&key).map_or(&[][..], Vec::as_slice);
        if alike.iter().any(|at| self.diags.get(*at) == Some(&diag)) {
            return;
        }
        let count = &mut self.counts[diag.severity as usize];
        if count.kept >= MAX_KEPT {
            count.further += 1;
            return;
        }
        count.kept += 1;
        self.known.entry(key).or_default().push(self.diags.len());
        self.diags.push(diag);
    }

    /// Adds a diagnostic unless one with the same code and message exists: for a fault that shows in many places.
    pub fn push_first(&mut self, diag: Diag) {
        let first = (diag.code.id(), diag.message.clone(), None);
        let known = self.known.range(first..).next();
        if known.is_none_or(|(key, _)| key.0 != diag.code.id() || key.1 != diag.message) {
            self.push(diag);
        }
    }

    /// Adds the diagnostics of another sink.
    pub fn append(&mut self, other: Self) {
        other.diags.into_iter().for_each(|diag| self.push(diag));
        for (count, more) in self.counts.iter_mut().zip(other.counts) {
            count.further += more.further;
        }
    }

    /// Changes every diagnostic, in the order in which they were added.
    pub fn change_all(&mut self, change: impl FnMut(Diag) -> Diag) {
        let before = std::mem::take(self);
        self.append(Self { diags: before.diags.into_iter().map(change).collect(), ..before });
    }

    /// True when there is at least one error.
    pub fn has_errors(&self) -> bool {
        self.counts[Severity::Error as usize].kept > 0
    }

    /// Number of errors, including those that are only counted.
    pub fn errors(&self) -> usize {
        let errors = &self.counts[Severity::Error as usize];
        errors.kept + errors.further
    }

    /// The kept diagnostics, in the order in which they were added.
    pub fn diags(&self) -> &[Diag] {
        &self.diags
    }

    /// Number of diagnostics, including those that are only counted.
    pub fn count(&self) -> usize {
        self.counts.iter().map(|c| c.kept + c.further).sum()
    }

    /// Number of diagnostics of a severity that are only counted.
    pub fn further(&self, severity: Severity) -> usize {
        self.counts[severity as usize].further
    }
}

/// A stage stopped: the errors in the [`Sink`] give the reason, or the run was cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aborted;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_ones_are_kept_once_and_many_are_counted() {
        let mut sink = Sink::default();
        let error = |n: usize| Diag::error(codes::files::INTERNAL, format!("fault {n}"));
        for n in (0..MAX_KEPT).chain(0..MAX_KEPT) {
            sink.push(error(n));
        }
        assert_eq!((sink.diags().len(), sink.count()), (MAX_KEPT, MAX_KEPT));
        for n in 0..10 {
            sink.push(error(MAX_KEPT + n));
            sink.push(Diag::remark(codes::files::INTERNAL, format!("remark {n}")));
        }
        assert_eq!((sink.diags().len(), sink.count()), (MAX_KEPT + 10, MAX_KEPT + 20));
        assert_eq!([Severity::Error, Severity::Remark].map(|s| sink.further(s)), [10, 0]);
        sink.change_all(|d| d.note("x"));
        assert_eq!((sink.diags().len(), sink.count()), (MAX_KEPT + 10, MAX_KEPT + 20));
    }
}
