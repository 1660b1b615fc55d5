//! What a reader gathers in addition to the blades, and counts against the limits.

use super::{Note, limits};
use base::source::Span;
use diagnostics::Diag;
use diagnostics::codes::import as codes;

/// Notes, further faults and counts of a run of a reader.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub(super) notes: Vec<Note>,
    /// Faults other than the one that stops the reader.
    pub(super) faults: Vec<Diag>,
    /// Largest distance between the files and what is read of them, mm.
    pub(super) moved: f64,
    points: usize,
}

impl Found {
    /// Adds a note on a line.
    pub(super) fn note(&mut self, span: impl Into<Option<Span>>, text: impl Into<String>) {
        let span = span.into();
        match self.notes.len() {
            n if n < limits::NOTES => self.notes.push(Note { text: text.into(), span }),
            limits::NOTES => self.notes.push(Note { text: "there are more notes than are kept".to_owned(), span }),
            _ => {}
        }
    }

    /// Keeps the largest distance, mm, between something of the files and what is read of it.
    pub(super) fn moved(&mut self, distance: f64) {
        self.moved = self.moved.max(distance);
    }

    /// Counts a point of a curve that has `own` points with it.
    pub(super) fn point(&mut self, own: usize, span: Span) -> Result<(), Diag> {
        self.points += 1;
        if own > limits::POINTS_OF_CURVE {
            return Err(too_many("points of a curve", limits::POINTS_OF_CURVE, span));
        }
        if self.points > limits::POINTS {
            return Err(too_many("points of all files", limits::POINTS, span));
        }
        Ok(())
    }
}

/// The fault of something that exceeds a limit.
pub(super) fn too_many(what: &str, most: usize, span: Span) -> Diag {
    Diag::error(codes::TOO_MUCH, format!("more than {most} {what}, the limit"))
        .label(span, "this one exceeds it")
        .help("export fewer points or sections; sections of smooth blades need some hundred points")
}

/// Refuses one more than `most` of something.
pub(super) fn within(count: usize, most: usize, what: &str, span: Span) -> Result<(), Diag> {
    if count > most { Err(too_many(what, most, span)) } else { Ok(()) }
}
