//! Lines of a text with their places, and numbers in them.

use base::source::{SourceId, Span};
use diagnostics::Diag;
use diagnostics::codes::import as codes;

/// A text with its place in the map of sources.
#[derive(Clone, Copy, Debug)]
pub(super) struct Text<'t> {
    source: SourceId,
    text: &'t str,
}

/// A line without the blanks around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'t> {
    pub(super) text: &'t str,
    pub(super) span: Span,
}

impl<'t> Text<'t> {
    pub(super) fn new(source: SourceId, text: &'t str) -> Self {
        Self { source, text }
    }

    /// Its place in the map of sources, and all of it.
    pub(super) fn whole(self) -> (SourceId, &'t str) {
        (self.source, self.text)
    }

    /// The lines that are not empty. A byte order mark is left out.
    pub(super) fn lines(self) -> impl Iterator<Item = Line<'t>> {
        let mut start = 0;
        self.text.split_inclusive('\n').filter_map(move |raw| {
            let from = start;
            start += raw.len();
            let blank = |c: char| c.is_whitespace() || c == '\u{feff}' || c == '\0';
            let text = raw.trim_matches(blank);
            let at = from + (raw.len() - raw.trim_start_matches(blank).len());
            (!text.is_empty()).then(|| Line { text, span: Span::new(self.source, at..at + text.len()) })
        })
    }

    /// The place behind the last line that is not empty.
    pub(super) fn end(self) -> Span {
        let last = self.lines().last();
        last.map_or(Span::new(self.source, 0..0), |line| line.span)
    }
}

/// Whether a character stands between numbers.
pub(super) fn separates(c: char) -> bool {
    c.is_whitespace() || matches!(c, ',' | ';')
}

impl<'t> Line<'t> {
    /// The words of a line of numbers: between blanks, tabs, commas and semicolons. Two commas have an empty word
    /// between them.
    pub(super) fn fields(self) -> Vec<&'t str> {
        if self.text.contains([',', ';']) {
            self.text.trim_end_matches([',', ';']).split([',', ';']).map(str::trim).collect()
        } else {
            self.text.split_whitespace().collect()
        }
    }

    /// How many words a line of numbers has.
    pub(super) fn count_of_words(self) -> usize {
        self.text.split(separates).filter(|field| !field.is_empty()).count()
    }

    /// The first `N` numbers of a line that has no more.
    pub(super) fn numbers<const N: usize>(self, what: &str) -> Result<[f64; N], Diag> {
        let mut fields = self.text.split(separates).filter(|field| !field.is_empty());
        let mut numbers = [0.0; N];
        let mut count = 0;
        for (k, number) in numbers.iter_mut().enumerate() {
            let Some(field) = fields.next() else { break };
            *number = self.number(field)?;
            count = k + 1;
        }
        let more = fields.count();
        if count < N || more > 0 {
            return Err(self.fault(format!("the line has {} numbers, not {N}", count + more), what));
        }
        Ok(numbers)
    }

    /// A finite number. The exponent may begin with D, as Fortran writes it.
    pub(super) fn number(self, field: &str) -> Result<f64, Diag> {
        // Words such as `inf` and `nan` are numbers of Rust.
        let plain = field.chars().all(|c| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E' | 'd' | 'D'));
        let value = plain.then(|| field.replace(['d', 'D'], "e").parse::<f64>().ok()).flatten();
        match value {
            Some(value) if value.is_finite() => Ok(value),
            Some(_) => Err(self.fault("a number is too large", "a finite number is expected")),
            None => Err(self.fault("this is not a number", "finite numbers are expected")),
        }
    }

    /// A whole number from 0 to `most`.
    pub(super) fn count(self, field: &str, what: &str, most: usize) -> Result<usize, Diag> {
        let value = field.parse::<usize>().ok().filter(|n| *n <= most);
        value.ok_or_else(|| self.fault(format!("the number of {what} is expected"), &format!("from 0 to {most}")))
    }

    /// The fault of a line that is not of the format.
    pub(super) fn fault(self, message: impl Into<String>, due: &str) -> Diag {
        malformed(message, self.span, due)
    }
}

/// The fault of a place that is not of the format.
pub(super) fn malformed(message: impl Into<String>, at: Span, due: &str) -> Diag {
    Diag::error(codes::MALFORMED, message).label(at, due).help("correct the line, or export the file again")
}

/// The fault of a text that ends too early.
pub(super) fn ends(text: Text<'_>, missing: &str) -> Diag {
    cut_off(missing, text.end(), "the last line")
}

/// The same with a place at its end and what that place is.
pub(super) fn cut_off(missing: &str, at: Span, what: &str) -> Diag {
    Diag::error(codes::ENDS_EARLY, format!("the file ends before {missing}"))
        .label(at, what)
        .help("the file was cut off: copy or export it again")
}
