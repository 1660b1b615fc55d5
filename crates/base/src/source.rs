//! Source texts and positions in them.

use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Origin of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// Named on the command line: the job or NC text.
    #[default]
    Given,
    /// Below the folder of the job, or in a folder `_lib` in this folder or above it.
    BesideJob,
    /// In the folder of `--library`.
    Library,
    /// In the folder of `--curves`.
    Curves,
    /// Part of the compiler.
    Shipped,
}

impl Origin {
    /// The word for the origin in certificates and NC text.
    pub fn word(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::BesideJob => "beside job",
            Self::Library => "library",
            Self::Curves => "curves",
            Self::Shipped => "shipped",
        }
    }
}

/// One file that takes part in a compilation.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct SourceFile {
    /// Name as the user wrote it.
    pub name: String,
    /// Whole text.
    pub text: String,
    /// Bytes of a file that is no text, such as a mesh; its `text` is empty.
    pub data: Vec<u8>,
    /// Path seen from the working folder, where the name is not this path.
    pub path: Option<String>,
    /// Origin.
    pub origin: Origin,
    /// Path of the file with symbolic links resolved; `None` for a text without a file.
    pub disk: Option<PathBuf>,
}

impl SourceFile {
    /// A text without a file.
    pub fn text(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self { name: name.into(), text: text.into(), ..Self::default() }
    }

    /// The bytes of the file.
    pub fn bytes(&self) -> &[u8] {
        if self.data.is_empty() { self.text.as_bytes() } else { &self.data }
    }

    /// Name without the folder for a file of the command line, else the name as the job writes it: the same from any folder.
    pub fn own_name(&self) -> String {
        let path = self.disk.as_deref().unwrap_or(Path::new(&self.name));
        let file = path.file_name().filter(|_| self.origin == Origin::Given);
        file.map_or_else(|| self.name.clone(), |file| file.display().to_string())
    }

    /// Path seen from the working folder.
    pub fn path(&self) -> &str {
        self.path.as_deref().unwrap_or(&self.name)
    }
}

/// Index of a file in the [`SourceMap`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SourceId(pub u32);

/// Byte range in one file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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

/// A value with its position in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Its position.
    pub span: Span,
}

impl<T> Spanned<T> {
    /// Pairs a value with its position.
    pub fn new(value: T, span: Span) -> Self {
        Self { value, span }
    }
}

/// All files of a compilation: the job first, then the files that it uses.
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
    /// One table for each file.
    tables: Vec<Table>,
}

/// Bytes between two entries of [`Table::characters`].
const STRIDE: usize = 1024;

/// Tables with which the position of a byte is found quickly, also in long texts with long lines.
#[derive(Clone, Debug)]
struct Table {
    /// First byte of each line.
    lines: Vec<u32>,
    /// Characters that begin before byte `i * STRIDE`.
    characters: Vec<u32>,
}

impl Table {
    fn new(text: &str) -> Self {
        let mut table = Self { lines: vec![0], characters: Vec::new() };
        let (mut at, mut characters) = (0_u32, 0_u32);
        for piece in text.as_bytes().chunks(STRIDE) {
            table.characters.push(characters);
            for byte in piece {
                at = at.saturating_add(1);
                characters += u32::from(begins_character(*byte));
                if *byte == b'\n' {
                    table.lines.push(at);
                }
            }
        }
        table.characters.push(characters);
        table
    }

    /// Number of characters that begin before a byte of the text.
    fn characters_before(&self, text: &[u8], at: usize) -> usize {
        let piece = at / STRIDE;
        let counted = self.characters.get(piece).copied().unwrap_or(0) as usize;
        let rest = text.get(piece * STRIDE..at).unwrap_or_default();
        counted + rest.iter().filter(|b| begins_character(**b)).count()
    }
}

/// Whether a byte of UTF-8 is the first of its character.
fn begins_character(byte: u8) -> bool {
    byte & 0xc0 != 0x80
}

impl SourceMap {
    /// Adds a text without a file and returns its id.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<String>) -> SourceId {
        self.add_file(SourceFile::text(name, text))
    }

    /// Adds a file and returns its id.
    pub fn add_file(&mut self, file: SourceFile) -> SourceId {
        self.tables.push(Table::new(&file.text));
        self.files.push(file);
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

    /// Number of lines of a file; the text after the last line end counts as a line, even when it is empty. 0 for an id
    /// of another map.
    pub fn line_count(&self, id: SourceId) -> usize {
        self.tables.get(id.0 as usize).map_or(0, |t| t.lines.len())
    }

    /// Bytes of a line with its end, by its number from 1; `None` when there is no such line.
    pub fn line_range(&self, id: SourceId, line: usize) -> Option<Range<usize>> {
        let lines = &self.tables.get(id.0 as usize)?.lines;
        let start = *lines.get(line.checked_sub(1)?)? as usize;
        let end = lines.get(line).map_or(self.get(id)?.text.len(), |next| *next as usize);
        Some(start..end)
    }

    /// The span of a line without its end and the blanks around it, by its number from 1; `None` when there is no such
    /// line.
    pub fn line_span(&self, id: SourceId, line: usize) -> Option<Span> {
        let range = self.line_range(id, line)?;
        let found = self.get(id)?.text.get(range.clone())?;
        let start = range.start + (found.len() - found.trim_start().len());
        let trimmed = found.trim();
        // The empty text after the last line end is no line that a message can mark.
        let is_line = !found.is_empty();
        is_line
            .then(|| if trimmed.is_empty() { range.start..range.start } else { start..start + trimmed.len() })
            .map(|range| Span::new(id, range))
    }

    /// One-based line and column (in characters) of the start of a span.
    pub fn line_column(&self, span: Span) -> (usize, usize) {
        let at = span.source.0 as usize;
        let (Some(file), Some(table)) = (self.files.get(at), self.tables.get(at)) else { return (1, 1) };
        let start = (span.start as usize).min(file.text.len());
        let line = table.lines.partition_point(|first| *first as usize <= start).max(1);
        let first = table.lines.get(line - 1).map_or(0, |first| *first as usize);
        let characters = |at| table.characters_before(file.text.as_bytes(), at);
        (line, characters(start) - characters(first) + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Line and column by a search through the text before the position.
    fn by_search(text: &str, at: usize) -> (usize, usize) {
        let before = &text[..at];
        let line = before.matches('\n').count() + 1;
        (line, before.rsplit('\n').next().unwrap().chars().count() + 1)
    }

    #[test]
    fn places_are_those_of_a_search() {
        let long = "\u{e4}b\u{1f980}".repeat(2000);
        for text in ["", "a", "a\n", "\n\n", "a\r\nb", "\u{feff}x\ny", &format!("{long}\n\n {long}\n\t{long}")] {
            let mut sources = SourceMap::default();
            let id = sources.add("x", text);
            for at in (0..=text.len()).filter(|at| text.is_char_boundary(*at)) {
                assert_eq!(sources.line_column(Span::new(id, at..at)), by_search(text, at), "byte {at}");
            }
            for (i, line) in text.lines().enumerate() {
                let span = sources.line_span(id, i + 1).unwrap();
                assert_eq!(&text[span.range()], line.trim(), "line {}", i + 1);
            }
            assert_eq!(sources.line_span(id, text.lines().count() + 1), None);
            assert_eq!(sources.line_span(id, 0), None);
        }
    }
}
