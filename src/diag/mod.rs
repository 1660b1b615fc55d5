//! Diagnostics: one structure for every message that a user sees.
//!
//! A diagnostic has a stable [`Code`] with a manual page, a message in the words of the machinist, labels on the
//! text, a help line with the way out and, for a geometric fault, a [`Place`] on the part.

pub mod code;
pub mod codes;
pub mod junit;
pub mod render;
pub mod sarif;

pub use code::Code;

use crate::source::Span;
use nalgebra::Point3;

/// How grave a diagnostic is. An error stops the compilation; nothing is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// A fact that the reader should know.
    Remark,
    /// Likely not what was meant; the compilation goes on.
    Warning,
    /// Stops the compilation.
    Error,
}

/// A mark on the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Where.
    pub span: Span,
    /// What is to be seen there.
    pub text: String,
}

/// A place on the part or on the path, in the part frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// What lies there: the operation, pass and block, or the face and its parameters.
    pub what: String,
    /// Position in mm.
    pub point: Point3<f64>,
    /// Operation of the motion and its move, where the place lies on the path.
    pub block: Option<(u32, u32)>,
}

/// A change of the text that mends the fault.
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
    /// The way out.
    pub help: Option<String>,
    /// Further facts, one a line.
    pub notes: Vec<String>,
    /// A machine-applicable change.
    pub fix: Option<Fix>,
    /// Place on the part.
    pub place: Option<Place>,
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

    /// Adds a mark on the text; the first one is the primary one.
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

    /// Adds to the place the operation of the motion and the index of its move, so that the block of an NC text that
    /// was read can be named. Without a place this does nothing.
    #[must_use]
    pub fn block(mut self, operation: u32, index: u32) -> Self {
        if let Some(place) = &mut self.place {
            place.block = Some((operation, index));
        }
        self
    }
}

/// Collects diagnostics of a run; equal ones are kept once.
#[derive(Clone, Debug, Default)]
pub struct Sink {
    diags: Vec<Diag>,
}

impl Sink {
    /// Adds a diagnostic unless an equal one is there.
    pub fn push(&mut self, diag: Diag) {
        if !self.diags.contains(&diag) {
            self.diags.push(diag);
        }
    }

    /// Changes every diagnostic, in the order of their discovery.
    pub fn map(&mut self, change: impl FnMut(Diag) -> Diag) {
        self.diags = std::mem::take(&mut self.diags).into_iter().map(change).collect();
    }

    /// True when at least one error is there.
    pub fn has_errors(&self) -> bool {
        self.diags.iter().any(|d| d.severity == Severity::Error)
    }

    /// All diagnostics in the order of their discovery.
    pub fn diags(&self) -> &[Diag] {
        &self.diags
    }
}

/// A stage gave up; the errors that say why are in the [`Sink`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aborted;
