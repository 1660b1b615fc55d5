//! Cuts the text into items and checks the brackets, in one pass over the bytes.
//!
//! An item begins at a line that begins with a letter outside of all brackets. When a line inside brackets reads like
//! the head of an item, an earlier bracket was not closed. The scanner then closes the item before this line, so that
//! the following items are read as intended.

use base::source::{SourceId, Span};
use diagnostics::codes::syntax as codes;
use diagnostics::{Diag, Sink};
use std::ops::Range;

/// Deepest nesting of brackets. The language needs 5; the bound limits the recursion of the parser.
const MAX_DEPTH: usize = 64;

/// Most items of a job. Usual jobs have some tens.
const MAX_ITEMS: usize = 1000;

/// Most numbers and names of a job outside of comments: ten times the number in four curves of 1000 points. The parser
/// takes about a kilobyte for each.
const MAX_WORDS: usize = 120_000;

/// Most faults of the text that a run reports; a text with more faults is not a job.
pub(super) const MAX_FAULTS: usize = 50;

/// Words that begin an item.
pub(super) const ITEMS: &[&str] = &[
    "edition",
    "use",
    "let",
    "part",
    "stock",
    "tool",
    "operation",
    "operations",
    "tolerance",
    "require",
    "allow",
    "post",
];

/// One item of the text.
#[derive(Debug)]
pub(super) struct ItemText {
    /// Its range in bytes.
    pub(super) range: Range<usize>,
    /// Brackets to add at its end, in order.
    pub(super) closers: String,
    /// True when a fault of a bracket or quote was reported in it.
    pub(super) damaged: bool,
    /// True when it cannot be parsed at all.
    pub(super) unreadable: bool,
}

struct Scanner<'a> {
    text: &'a str,
    source: SourceId,
    sink: &'a mut Sink,
    open: Vec<(u8, usize)>,
    pieces: Vec<ItemText>,
    comments: Vec<Span>,
    start: Option<usize>,
    damaged: bool,
    unreadable: bool,
    words: usize,
}

/// Cuts the text into items and finds its comments. `None` when the text is nested too deeply, is too long, or has too
/// many faults.
pub(super) fn scan(text: &str, source: SourceId, sink: &mut Sink) -> Option<(Vec<ItemText>, Vec<Span>)> {
    let mut scanner = Scanner {
        text,
        source,
        sink,
        open: Vec::new(),
        pieces: Vec::new(),
        comments: Vec::new(),
        start: None,
        damaged: false,
        unreadable: false,
        words: 0,
    };
    scanner.run().then_some((scanner.pieces, scanner.comments))
}

impl Scanner<'_> {
    fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.source, range)
    }

    fn run(&mut self) -> bool {
        let bytes = self.text.as_bytes();
        let mut i = 0;
        let (mut line_start, mut in_word) = (true, false);
        while let Some(&byte) = bytes.get(i) {
            if line_start {
                line_start = false;
                if self.begins_item(i) {
                    self.finish(i);
                    self.start = Some(i);
                    if self.pieces.len() == MAX_ITEMS {
                        let help = "divide the job into several jobs; usual jobs have fewer than 100 items";
                        self.too_many(i, format!("more than {MAX_ITEMS} items"), help);
                        return false;
                    }
                }
                if self.sink.count() >= MAX_FAULTS {
                    return false;
                }
            }
            let before = std::mem::replace(&mut in_word, byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.'));
            if in_word && !before {
                self.words += 1;
                if self.words > MAX_WORDS {
                    let help = "put long lists of points into a file: `spline from \"file.csv\" curve NAME mm`";
                    self.too_many(i, format!("more than {MAX_WORDS} numbers and names"), help);
                    return false;
                }
            }
            match byte {
                b'\n' => line_start = true,
                b'/' if bytes.get(i + 1) == Some(&b'/') => {
                    let end = line_end(bytes, i);
                    // A line may end with a carriage return.
                    let comment = self.text[i..end].trim_end();
                    self.comments.push(self.span(i..i + comment.len()));
                    i = end;
                    continue;
                }
                b'"' => {
                    i = self.quoted(i);
                    continue;
                }
                b'{' | b'[' | b'(' => {
                    if self.open.len() == MAX_DEPTH {
                        self.too_deep(i);
                        return false;
                    }
                    self.open.push((byte, i));
                }
                b'}' | b']' | b')' => self.close(byte, i),
                _ => {}
            }
            if self.start.is_none() && !byte.is_ascii_whitespace() && !self.text[i..].starts_with('\u{feff}') {
                self.start = Some(i);
            }
            // A byte of a longer character matches none of the cases above, so that stepping by characters skips
            // nothing.
            i += self.text[i..].chars().next().map_or(1, char::len_utf8);
        }
        self.finish(bytes.len());
        true
    }

    /// True when the line at `i` begins an item.
    fn begins_item(&self, i: usize) -> bool {
        let bytes = self.text.as_bytes();
        let rest = &self.text[i..];
        if self.open.is_empty() {
            if bytes.get(i).is_some_and(u8::is_ascii_alphabetic) {
                return true;
            }
            let word = first_word(rest.trim_start_matches([' ', '\t']));
            return ITEMS.contains(&word);
        }
        reads_like_item(rest)
    }

    /// Skips a quoted text; returns the place after it.
    fn quoted(&mut self, i: usize) -> usize {
        let bytes = self.text.as_bytes();
        if self.start.is_none() {
            self.start = Some(i);
        }
        // The first of both, so that a line with many texts is read once.
        if let Some(close) = self.text[i + 1..].find(['"', '\n']).filter(|close| bytes[i + 1 + close] == b'"') {
            return i + close + 2;
        }
        let end = line_end(bytes, i + 1);
        self.refuse(
            Diag::error(codes::TEXT_NOT_CLOSED, "a quoted text is not closed on its line")
                .label(self.span(i..end), "the text begins here")
                .help("add the closing quote"),
        );
        end
    }

    /// Reports a fault with which the item cannot be parsed.
    fn refuse(&mut self, diag: Diag) {
        self.sink.push(diag);
        (self.damaged, self.unreadable) = (true, true);
    }

    fn close(&mut self, byte: u8, i: usize) {
        let close = char::from(byte);
        // A bracket that closes an outer one closes the inner ones as well.
        let outer = self.open.iter().rposition(|(b, _)| closer(*b) == close);
        match self.open.last().map(|(b, at)| (closer(*b), *at)) {
            // After a wrong bracket, the following brackets of the item have no meaning.
            _ if self.unreadable => {}
            Some((right, at)) if right != close => self.refuse(
                Diag::error(codes::BRACKET_MISMATCH, format!("`{close}` does not match; `{right}` is expected"))
                    .label(self.span(i..i + 1), format!("`{right}` is expected before this"))
                    .label(self.span(at..at + 1), "opened here")
                    .help(format!("close the inner bracket with `{right}` first, or remove one of the two")),
            ),
            Some(_) => {}
            None => self.refuse(
                Diag::error(codes::BRACKET_MISMATCH, format!("`{close}` has no opening bracket"))
                    .label(self.span(i..i + 1), "no bracket is open here")
                    .help("remove the bracket, or add its opening bracket"),
            ),
        }
        if let Some(outer) = outer {
            self.open.truncate(outer);
        }
    }

    fn too_many(&mut self, i: usize, what: String, help: &str) {
        let word = first_word(&self.text[i..]).len().max(1);
        self.sink.push(
            Diag::error(codes::TOO_MANY, format!("the job has {what}"))
                .label(self.span(i..i + word), "one too many")
                .help(help),
        );
    }

    fn too_deep(&mut self, i: usize) {
        let outer = self.open.first().map_or(i, |(_, at)| *at);
        self.sink.push(
            Diag::error(codes::NESTING, format!("brackets are nested deeper than {MAX_DEPTH} levels"))
                .label(self.span(i..i + 1), "one too many")
                .label(self.span(outer..outer + 1), "the outermost one")
                .help("close the open brackets; no job needs more than 5 levels"),
        );
    }

    /// Ends the open item at `end`.
    fn finish(&mut self, end: usize) {
        let damaged = std::mem::take(&mut self.damaged);
        let unreadable = std::mem::take(&mut self.unreadable);
        let open = std::mem::take(&mut self.open);
        let Some(start) = self.start.take() else { return };
        if let Some((bracket, at)) = open.last().filter(|_| !unreadable) {
            let next = end < self.text.len();
            let mut diag = Diag::error(
                codes::BRACKET_OPEN,
                format!(
                    "`{}` is not closed before the {}",
                    char::from(*bracket),
                    if next { "next item" } else { "end" }
                ),
            )
            .label(self.span(*at..at + 1), "opened here");
            if next {
                let word = first_word(&self.text[end..]).len();
                diag = diag.label(self.span(end..end + word), "the next item begins here");
            }
            self.sink.push(diag.help(format!("add `{}`", closer(*bracket))));
        }
        let closers = open.iter().rev().map(|(b, _)| closer(*b)).collect::<String>();
        let damaged = damaged || !closers.is_empty();
        self.pieces.push(ItemText { range: start..end, closers, damaged, unreadable });
    }
}

fn closer(open: u8) -> char {
    match open {
        b'{' => '}',
        b'[' => ']',
        _ => ')',
    }
}

fn line_end(bytes: &[u8], from: usize) -> usize {
    bytes.get(from..).and_then(|b| b.iter().position(|b| *b == b'\n')).map_or(bytes.len(), |n| from + n)
}

/// The word at the start of a text.
pub(super) fn first_word(text: &str) -> &str {
    let end = text.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '-')).unwrap_or(text.len());
    &text[..end]
}

/// True when a line reads like the head of an item and not like an entry of a block.
fn reads_like_item(line: &str) -> bool {
    let keyword = first_word(line);
    if !ITEMS.contains(&keyword) {
        return false;
    }
    let skip = |text: &str| -> String { text.chars().take(200).collect::<String>().trim_start().to_owned() };
    let rest = skip(&line[keyword.len()..]);
    let word = first_word(&rest).to_owned();
    let after = skip(&rest[word.len()..]);
    match keyword {
        "edition" => rest.starts_with(|c: char| c.is_ascii_digit()),
        "use" => (word == "machine" || word == "tools") && after.starts_with('"'),
        "let" | "tool" => !word.is_empty() && after.starts_with('='),
        "part" | "stock" | "operation" => {
            let second = first_word(&after);
            !word.is_empty() && skip(&after[second.len()..]).starts_with('{')
        }
        "tolerance" => word == "chord" || word == "rough",
        "require" => {
            let second = first_word(&after);
            after.starts_with(['<', '>']) || skip(&after[second.len()..]).starts_with(['<', '>'])
        }
        "allow" => {
            let second = first_word(&after);
            second == "on" || first_word(&skip(&after[second.len()..])) == "on"
        }
        "post" => !word.is_empty() && (after.is_empty() || after.starts_with(['{', '/'])),
        _ => false,
    }
}
