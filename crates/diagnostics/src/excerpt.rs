//! The lines around the marks of a diagnostic, made safe for the renderer and the terminal.
//!
//! The renderer accepts columns up to 65 535 and reads the whole text that it receives, once for each mark. It
//! therefore receives only the lines near the marks. Long lines are cut around a mark, tabs are replaced by blanks, and
//! characters that would control the terminal by escapes. The reported line and column are those of the whole text.

use super::Label;
use super::shown::{escape, steers};
use base::source::{SourceId, SourceMap, Span};
use miette::{LabeledSpan, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

/// Number of lines kept before and after a mark; the renderer shows one.
const LINES_AROUND: usize = 2;

/// Most lines between two marks with which both are shown in one block.
const MAX_LINES_BETWEEN: usize = 40;

/// Longest line that is shown whole, bytes.
const MAX_WHOLE_LINE_BYTES: usize = 400;

/// Number of characters shown before and after a mark in a longer line.
const CHARACTERS_BEFORE: usize = 60;
const CHARACTERS_BEHIND: usize = 140;

/// Columns of a tab.
const TAB_COLUMNS: usize = 4;

/// Consecutive lines, as they are shown.
#[derive(Debug)]
struct ExcerptBlock {
    /// First byte in the excerpt.
    offset: usize,
    /// Index of the first line in the file.
    line: usize,
    text: String,
}

/// The shown part of a file.
#[derive(Debug)]
pub(super) struct Excerpt {
    name: String,
    blocks: Vec<ExcerptBlock>,
    /// Position in the excerpt, and column in the file from 0, of each mark.
    columns: Vec<(usize, usize)>,
    /// Marks in the excerpt, the primary one first.
    pub(super) labels: Vec<LabeledSpan>,
    /// Marks that the cut lines do not contain.
    pub(super) unseen: Vec<Label>,
}

/// A mark to show: bytes in the file, and line.
struct Mark<'a> {
    label: &'a Label,
    start: usize,
    end: usize,
    line: usize,
    column: usize,
}

impl Excerpt {
    /// The excerpt for the marks `labels` of a file; `None` for a file of another map.
    pub(super) fn new(file: SourceId, labels: &[&Label], sources: &SourceMap) -> Option<Self> {
        let source = sources.get(file)?;
        let text = source.text.as_str();
        let marks: Vec<Mark<'_>> = labels
            .iter()
            .map(|label| {
                let start = boundary(text, label.span.start as usize);
                let (line, column) = sources.line_column(Span::new(file, start..start));
                // Of a block or a list of points the first line is marked.
                let line_end = sources
                    .line_range(file, line)
                    .map_or(start, |r| text[r.clone()].trim_end_matches('\n').len() + r.start);
                let end = boundary(text, label.span.end as usize).clamp(start, line_end.max(start));
                Mark { label, start, end, line: line - 1, column: column - 1 }
            })
            .collect();
        let name = super::shown::visible(&source.name).into_owned();
        let mut this = Self { name, blocks: Vec::new(), columns: Vec::new(), labels: Vec::new(), unseen: Vec::new() };
        let mut shown = vec![None; marks.len()];
        let mut offset = 0;
        for lines in blocks(&marks, sources.line_count(file)) {
            let mut block = ExcerptBlock { offset, line: lines.start, text: String::new() };
            for line in lines {
                let Some(range) = sources.line_range(file, line + 1) else { continue };
                let of_line: Vec<usize> = (0..marks.len()).filter(|i| marks[*i].line == line).collect();
                let anchor = of_line.first().map(|i| marks[*i].start - range.start);
                let row = ExcerptRow::new(&text[range.clone()], anchor);
                for i in of_line {
                    let place = |at: usize| row.place(at - range.start).map(|p| offset + block.text.len() + p);
                    if let Some(start) = place(marks[i].start) {
                        let end = place(marks[i].end).unwrap_or(offset + block.text.len() + row.shown);
                        shown[i] = Some((start, end.max(start)));
                    }
                }
                block.text.push_str(&row.text);
            }
            offset += block.text.len();
            this.blocks.push(block);
        }
        for (mark, shown) in marks.iter().zip(shown) {
            let Some((start, end)) = shown else {
                this.unseen.push(mark.label.clone());
                continue;
            };
            let text = Some(super::shown::visible(&mark.label.text).into_owned());
            let make =
                if this.labels.is_empty() { LabeledSpan::new_primary_with_span } else { LabeledSpan::new_with_span };
            this.labels.push(make(text, start..end));
            this.columns.push((start, mark.column));
        }
        Some(this)
    }
}

/// The nearest start of a character at or before a byte.
fn boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// Indices of the shown lines, in runs; `count` is the number of all lines.
fn blocks(marks: &[Mark<'_>], count: usize) -> Vec<std::ops::Range<usize>> {
    let mut lines: Vec<usize> = marks.iter().map(|m| m.line).collect();
    lines.sort_unstable();
    let mut blocks: Vec<std::ops::Range<usize>> = Vec::new();
    for line in lines {
        let range = line.saturating_sub(LINES_AROUND)..(line + LINES_AROUND + 1).min(count);
        match blocks.last_mut() {
            Some(last) if range.start <= last.end + MAX_LINES_BETWEEN => last.end = last.end.max(range.end),
            _ => blocks.push(range),
        }
    }
    blocks
}

/// A line as it is shown.
struct ExcerptRow {
    /// Text with its line end, where there is one.
    text: String,
    /// Number of bytes of the text without the line end.
    shown: usize,
    /// Pairs of a byte of the line and a byte of the shown text: the start of each character, and the end of the last
    /// one.
    places: Vec<(usize, usize)>,
}

impl ExcerptRow {
    /// `anchor` is the byte around which a long line is cut.
    fn new(line: &str, anchor: Option<usize>) -> Self {
        let body = line.strip_suffix('\n').unwrap_or(line);
        let body = body.strip_suffix('\r').unwrap_or(body);
        let mut range = 0..body.len();
        if body.len() > MAX_WHOLE_LINE_BYTES {
            let anchor = boundary(body, anchor.unwrap_or(0));
            range.start =
                body[..anchor].char_indices().rev().take(CHARACTERS_BEFORE).last().map_or(anchor, |(at, _)| at);
            range.end = body[anchor..].char_indices().nth(CHARACTERS_BEHIND).map_or(body.len(), |(at, _)| anchor + at);
        }
        let mut text = String::new();
        let mut places = Vec::new();
        if range.start > 0 {
            text.push_str("... ");
        }
        let mut column = 0;
        for (at, c) in body[range.clone()].char_indices() {
            places.push((range.start + at, text.len()));
            match c {
                '\t' => {
                    let blanks = TAB_COLUMNS - column % TAB_COLUMNS;
                    text.extend(std::iter::repeat_n(' ', blanks));
                    column += blanks - 1;
                }
                c if steers(c) => text.push_str(&escape(c)),
                c => text.push(c),
            }
            column += 1;
        }
        places.push((range.end, text.len()));
        if range.end < body.len() {
            text.push_str(" ...");
        }
        let shown = text.len();
        if line.ends_with('\n') {
            text.push('\n');
        }
        Self { text, shown, places }
    }

    /// Position in the shown text of a byte of the line; `None` when this part was cut away.
    fn place(&self, at: usize) -> Option<usize> {
        let (first, last) = (self.places.first()?, self.places.last()?);
        if at < first.0 || at > last.0 && self.shown > last.1 {
            return None;
        }
        // A byte after the text of the line counts as the end of the text.
        let i = self.places.partition_point(|(from, _)| *from <= at);
        self.places.get(i.checked_sub(1)?).map(|p| p.1)
    }
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let end = span.offset() + span.len();
        let block = self.blocks.iter().rfind(|b| b.offset <= span.offset()).ok_or(MietteError::OutOfBounds)?;
        if end > block.offset + block.text.len() {
            // Marks in different blocks are shown separately.
            return Err(MietteError::OutOfBounds);
        }
        let inner = SourceSpan::new((span.offset() - block.offset).into(), span.len());
        let contents = block.text.read_span(&inner, before, after)?;
        let inner = contents.span();
        let outer = SourceSpan::new((inner.offset() + block.offset).into(), inner.len());
        let column = match self.columns.iter().find(|(at, _)| before == 0 && *at == span.offset()) {
            Some((_, column)) => *column,
            None => contents.column(),
        };
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            contents.data(),
            outer,
            block.line + contents.line(),
            column,
            block.line + contents.line_count(),
        )))
    }
}
