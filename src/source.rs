//! Source texts and places in them.

use std::ops::Range;

/// One file that takes part in a compilation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceFile {
    /// Name as the user wrote it.
    pub name: String,
    /// Whole text.
    pub text: String,
    /// Where it lies, seen from the working folder, when the name does not say that.
    pub path: Option<String>,
}

impl SourceFile {
    /// Where it lies, seen from the working folder.
    pub fn path(&self) -> &str {
        self.path.as_deref().unwrap_or(&self.name)
    }
}

/// Index of a file in the [`SourceMap`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct SourceId(pub u32);

/// Byte range in one file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Span {
    /// File of the range.
    pub source: SourceId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// A span from byte offsets.
    pub fn new(source: SourceId, range: Range<usize>) -> Self {
        let clamp = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Self { source, start: clamp(range.start), end: clamp(range.end) }
    }

    /// The byte range.
    pub fn range(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// A value with the place that it was read from.
#[derive(Clone, Debug, PartialEq)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Its place.
    pub span: Span,
}

impl<T> Spanned<T> {
    /// Pairs a value with its place.
    pub fn new(value: T, span: Span) -> Self {
        Self { value, span }
    }
}

/// All files of a compilation: the job first, then what it uses.
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
}

impl SourceMap {
    /// Adds a file and returns its id.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<String>) -> SourceId {
        self.add_at(name, text, None)
    }

    /// [`Self::add`] for a file whose name does not say where it lies, seen from the working folder.
    pub fn add_at(&mut self, name: impl Into<String>, text: impl Into<String>, path: Option<String>) -> SourceId {
        self.files.push(SourceFile { name: name.into(), text: text.into(), path });
        SourceId(u32::try_from(self.files.len() - 1).unwrap_or(u32::MAX))
    }

    /// The file of an id; `None` for an id of another map.
    pub fn get(&self, id: SourceId) -> Option<&SourceFile> {
        self.files.get(id.0 as usize)
    }

    /// All files in order.
    pub fn files(&self) -> &[SourceFile] {
        &self.files
    }

    /// The span of a line, from 1, without its end and the blanks around it; `None` when there is no such line.
    pub fn line_span(&self, id: SourceId, line: usize) -> Option<Span> {
        let text = &self.get(id)?.text;
        let found = text.lines().nth(line.checked_sub(1)?)?;
        let start = found.as_ptr() as usize - text.as_ptr() as usize;
        let trimmed = found.trim();
        let start = start + (found.len() - found.trim_start().len());
        Some(Span::new(id, start..start + trimmed.len()))
    }

    /// One-based line and column (in characters) of the start of a span.
    pub fn line_column(&self, span: Span) -> (usize, usize) {
        let Some(file) = self.get(span.source) else { return (1, 1) };
        let start = (span.start as usize).min(file.text.len());
        let before = file.text.as_bytes().get(..start).unwrap_or_default();
        let line = before.iter().filter(|b| **b == b'\n').count() + 1;
        let line_start = before.iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
        let column = String::from_utf8_lossy(&before[line_start..]).chars().count() + 1;
        (line, column)
    }
}
