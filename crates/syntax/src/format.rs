//! The job in its usual form: indentation, blanks and blank lines. Words, numbers, comments and line ends stay as they are
//! written; no line is broken or joined.
//!
//! The text is cut into tokens apart from the parser, so that comments are tokens too. The tree only says where items and
//! entries begin. The result is compared with the text before it is returned: token by token, and by its tree.

use super::ast::{Block, Entry, File, Item, ItemKind, ToolSource, Value};
use super::{parse, print};
use base::source::SourceId;
use diagnostics::Sink;
use diagnostics::codes::syntax as codes;
use std::collections::BTreeSet;
use std::ops::Range;

/// Blanks of one level of indentation.
const INDENT: usize = 2;

/// Blanks before a comment at the end of a line, and between two entries on one line.
const WIDE_GAP: usize = 2;

/// Why a text has no usual form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unformatted {
    /// The text has faults, which are in the sink.
    Faulty,
    /// The result would not be the same job: a fault of this module.
    Differs,
}

/// The text in its usual form. Faults of the text go to the sink.
///
/// # Errors
/// [`Unformatted`] when the text has faults, or the result would not say the same.
pub fn format(text: &str, source: SourceId, sink: &mut Sink) -> Result<String, Unformatted> {
    let mut faults = Sink::default();
    let before = parse(text, source, &mut faults);
    let tokens = tokens(text);
    // Comments alone are no job yet, but they have a form.
    let comments = !tokens.is_empty()
        && tokens.iter().all(|token| token.kind == TokenKind::Comment)
        && faults.diags().iter().all(|diag| diag.code == codes::EMPTY);
    if !comments {
        faults.diags().iter().for_each(|diag| sink.push(diag.clone()));
    }
    if !comments && (before.faulty || before.damaged) {
        return Err(Unformatted::Faulty);
    }
    let lines = JobLayout { starts: starts(&before), text, tokens: &tokens }.lines();
    let formatted = written(lines);
    let after = parse(&formatted, source, &mut Sink::default());
    let texts = |text: &str, tokens: &[FormToken]| -> Vec<String> {
        tokens.iter().map(|token| text[token.range.clone()].to_owned()).collect()
    };
    let same = (comments || !after.faulty)
        && texts(text, &tokens) == texts(&formatted, &self::tokens(&formatted))
        && without_places(&before) == without_places(&after);
    if same { Ok(formatted) } else { Err(Unformatted::Differs) }
}

/// The tree as text, without the places of its items and entries.
fn without_places(file: &File) -> Vec<String> {
    let cut = |line: &str| line.rsplit_once(" ; ").map_or(line, |(words, _)| words).to_owned();
    print::print(file).lines().map(cut).collect()
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TokenKind {
    Comment,
    Text,
    Open(u8),
    Close(u8),
    Comma,
    Relation,
    Word,
}

#[derive(Clone, Debug)]
struct FormToken {
    kind: TokenKind,
    range: Range<usize>,
    /// True when nothing stands between it and the token before.
    glued: bool,
    /// Line ends between it and the token before.
    line_ends: usize,
}

/// Length of the token at the beginning of a text, and its kind.
fn token(text: &str) -> (TokenKind, usize) {
    let bytes = text.as_bytes();
    let until_line_end = || text.find('\n').unwrap_or(text.len());
    match bytes[0] {
        b'/' if bytes.get(1) == Some(&b'/') => (TokenKind::Comment, text[..until_line_end()].trim_end().len()),
        // A text ends in its line; the parser refuses others.
        b'"' => (TokenKind::Text, text[1..].find('"').map_or_else(until_line_end, |end| end + 2)),
        open @ (b'{' | b'[' | b'(') => (TokenKind::Open(open), 1),
        close @ (b'}' | b']' | b')') => (TokenKind::Close(close), 1),
        b',' => (TokenKind::Comma, 1),
        b'<' | b'>' | b'=' => {
            (TokenKind::Relation, bytes.iter().take(2).take_while(|b| matches!(b, b'<' | b'>' | b'=')).count())
        }
        _ => {
            let ends = |(i, c): (usize, char)| is_blank(c) || "{}[](),\"<>=".contains(c) || text[i..].starts_with("//");
            (TokenKind::Word, text.char_indices().find(|at| ends(*at)).map_or(text.len(), |(i, _)| i))
        }
    }
}

/// What the grammar takes as a blank.
fn is_blank(c: char) -> bool {
    matches!(c, ' ' | '\t' | '\r' | '\n' | '\u{FEFF}')
}

fn tokens(text: &str) -> Vec<FormToken> {
    let mut found = Vec::new();
    let mut at = 0;
    loop {
        let rest = text[at..].trim_start_matches(is_blank);
        if rest.is_empty() {
            return found;
        }
        let start = text.len() - rest.len();
        let (kind, length) = token(rest);
        let line_ends = text[at..start].matches('\n').count();
        found.push(FormToken { kind, range: start..start + length, glued: at == start && at > 0, line_ends });
        at = start + length;
    }
}

/// Bytes at which items and entries begin.
fn starts(file: &File) -> BTreeSet<u32> {
    let mut found: BTreeSet<u32> = file.items.iter().map(|item| item.span.start).collect();
    for block in file.items.iter().filter_map(block) {
        entries(block, &mut found);
    }
    found
}

fn block(item: &Item) -> Option<&Block> {
    match &item.kind {
        ItemKind::Part { body, .. } | ItemKind::Stock { body, .. } | ItemKind::Operation { body, .. } => Some(body),
        ItemKind::Tool { source: ToolSource::Shape(_, body), .. } => Some(body),
        ItemKind::Post { body, .. } => body.as_ref(),
        _ => None,
    }
}

fn entries(block: &Block, found: &mut BTreeSet<u32>) {
    for Entry { values, span, .. } in &block.entries {
        found.insert(span.start);
        for value in values {
            if let Value::Block(_, inner) | Value::Placed(_, inner) = value {
                entries(inner, found);
            }
        }
    }
}

/// A token of a line.
#[derive(Clone, Debug)]
struct LinePiece<'a> {
    /// Blanks before it; of the first one of a line, none.
    gap: usize,
    kind: TokenKind,
    text: &'a str,
    /// True when an item or entry begins with it.
    starts: bool,
}

/// A bracket that is open: its line, and its place among the pieces of the line.
type Opening = (usize, usize);

#[derive(Debug)]
struct JobLine<'a> {
    pieces: Vec<LinePiece<'a>>,
    blank_before: bool,
    /// The innermost bracket that is open where the line begins.
    within: Option<Opening>,
    /// True when the line goes on with an entry or item of a line before, outside of round and square brackets.
    goes_on: bool,
}

struct JobLayout<'a> {
    starts: BTreeSet<u32>,
    text: &'a str,
    tokens: &'a [FormToken],
}

impl<'a> JobLayout<'a> {
    /// The lines with the blanks between their tokens.
    fn lines(&self) -> Vec<JobLine<'a>> {
        let mut lines: Vec<JobLine<'a>> = Vec::new();
        let mut open: Vec<(Opening, u8)> = Vec::new();
        for (k, token) in self.tokens.iter().enumerate() {
            let starts = u32::try_from(token.range.start).is_ok_and(|at| self.starts.contains(&at));
            if k == 0 || token.line_ends > 0 {
                let inner = open.last().copied();
                let in_block = inner.is_none_or(|(_, bracket)| bracket == b'{');
                let goes_on = in_block && !starts && !matches!(token.kind, TokenKind::Comment | TokenKind::Close(_));
                let after_opening =
                    lines.last().and_then(|l| l.pieces.last()).is_none_or(|p| matches!(p.kind, TokenKind::Open(_)));
                let closes = matches!(token.kind, TokenKind::Close(_));
                let blank_before = token.line_ends > 1 && !after_opening && !closes;
                lines.push(JobLine { pieces: Vec::new(), blank_before, within: inner.map(|(o, _)| o), goes_on });
            }
            let number = lines.len() - 1;
            let Some(line) = lines.last_mut() else { continue };
            let gap = line.pieces.last().map_or(0, |before| gap(before, token, starts));
            match token.kind {
                TokenKind::Open(bracket) => open.push(((number, line.pieces.len()), bracket)),
                TokenKind::Close(_) => {
                    open.pop();
                }
                _ => {}
            }
            line.pieces.push(LinePiece { gap, kind: token.kind, text: &self.text[token.range.clone()], starts });
        }
        lines
    }
}

/// Blanks between two tokens of a line.
fn gap(before: &LinePiece<'_>, token: &FormToken, starts: bool) -> usize {
    match (before.kind, token.kind) {
        (_, TokenKind::Comment) => WIDE_GAP,
        (_, TokenKind::Comma) | (TokenKind::Open(b'[' | b'('), _) | (_, TokenKind::Close(b']' | b')')) => 0,
        (TokenKind::Open(b'{'), _) => 1,
        _ if starts => WIDE_GAP,
        (TokenKind::Comma | TokenKind::Relation | TokenKind::Close(b'}'), _)
        | (_, TokenKind::Relation | TokenKind::Open(b'{') | TokenKind::Close(b'}')) => 1,
        (TokenKind::Close(b']'), _) | (TokenKind::Close(b')'), TokenKind::Open(b'(')) => 1,
        _ => usize::from(!token.glued),
    }
}

impl JobLine<'_> {
    /// Columns from the first piece to the piece of a number, which is left out.
    fn width(&self, until: usize) -> usize {
        self.pieces[..until].iter().map(|piece| piece.gap + piece.text.chars().count()).sum()
    }

    /// The piece that stands below that of the line before, and the word that both lines begin with.
    fn aligned(&self) -> Option<(&str, usize)> {
        let first = self.pieces.first().filter(|piece| piece.starts)?;
        let find = |kind: TokenKind| self.pieces.iter().position(|piece| piece.kind == kind);
        match first.text {
            "require" | "let" | "tool" => Some((first.text, find(TokenKind::Relation)?)),
            "use" => Some((first.text, find(TokenKind::Text)?)),
            _ => {
                let word = self.pieces.get(1)?.text;
                ["spline", "revolve", "loop", "loops"].contains(&word).then_some((word, 1))
            }
        }
    }

    /// The words with which the items and entries of the line begin, where it has several.
    fn words(&self) -> Option<Vec<String>> {
        let words: Vec<String> = self.pieces.iter().filter(|piece| piece.starts).map(|p| p.text.to_owned()).collect();
        (self.pieces.first().is_some_and(|piece| piece.starts) && words.len() > 1).then_some(words)
    }

    /// The piece before which blanks move the entry of a number: its brace, where it is the first one of a block.
    fn entry(&self, number: usize) -> Option<usize> {
        let (piece, _) = self.pieces.iter().enumerate().filter(|(_, piece)| piece.starts).nth(number)?;
        let brace = piece > 1 && self.pieces[piece - 1].kind == TokenKind::Open(b'{');
        Some(if brace { piece - 1 } else { piece })
    }

    /// First pieces of the coordinates, where the line is one point of a list.
    fn coordinates(&self) -> Option<Vec<Range<usize>>> {
        let (first, last) = (self.pieces.first()?, self.pieces.last()?);
        let brackets =
            self.pieces.iter().filter(|p| matches!(p.kind, TokenKind::Open(_) | TokenKind::Close(_))).count();
        if first.kind != TokenKind::Open(b'(') || last.kind != TokenKind::Close(b')') || brackets != 2 {
            return None;
        }
        let mut from = 1;
        let mut found = Vec::new();
        for k in 1..self.pieces.len() {
            if self.pieces[k].kind == TokenKind::Comma || k + 1 == self.pieces.len() {
                found.push(from..k);
                from = k + 1;
            }
        }
        Some(found)
    }
}

/// Runs of successive lines without a blank line between, in the same bracket, which `key` puts together.
fn runs<'l, 't, K: PartialEq>(
    lines: &'l [JobLine<'t>],
    key: impl Fn(&'l JobLine<'t>) -> Option<K>,
) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    let mut before: Option<K> = None;
    for (k, line) in lines.iter().enumerate() {
        let now = key(line);
        if now.is_some() {
            let joins = now == before && !line.blank_before && lines[k - 1].within == line.within;
            match found.last_mut() {
                Some(run) if joins => run.end = k + 1,
                _ => found.push(k..k + 1),
            }
        }
        before = now;
    }
    found
}

/// Widens the gaps before a piece of each line so that these pieces stand below each other; the others of a run stay.
fn below(lines: &mut [JobLine<'_>], piece: impl Fn(&JobLine<'_>) -> Option<usize>) {
    let of = |line: &JobLine<'_>| piece(line).map(|piece| (piece, line.width(piece) + line.pieces[piece].gap));
    let most = lines.iter().filter_map(of).map(|(_, column)| column).max().unwrap_or(0);
    for line in lines {
        if let Some((piece, column)) = of(line) {
            line.pieces[piece].gap += most - column;
        }
    }
}

/// Puts below each other: the coordinates of points, the relations of requirements and the like, and the entries of lines
/// that have the same entries.
fn align(lines: &mut [JobLine<'_>]) {
    for run in runs(lines, |line| line.coordinates().map(|c| c.len())) {
        let cell = |line: &JobLine<'_>, column: usize| {
            line.coordinates().and_then(|c| c.get(column).cloned()).filter(|cell| !cell.is_empty())
        };
        let columns = lines[run.start].coordinates().map_or(0, |c| c.len());
        for column in 0..columns {
            let width = |line: &JobLine<'_>| {
                cell(line, column)
                    .map(|c| (c.start, line.width(c.end) - line.width(c.start) - line.pieces[c.start].gap))
            };
            let most = lines[run.clone()].iter().filter_map(width).map(|(_, w)| w).max().unwrap_or(0);
            for line in &mut lines[run.clone()] {
                if let Some((piece, width)) = width(line) {
                    line.pieces[piece].gap += most - width;
                }
            }
        }
    }
    for run in runs(lines, |line| line.aligned().map(|(word, _)| word.to_owned())) {
        below(&mut lines[run], |line| line.aligned().map(|(_, piece)| piece));
    }
    for run in runs(lines, JobLine::words) {
        let entries = lines[run.start].words().map_or(0, |words| words.len());
        for number in 1..entries {
            below(&mut lines[run.clone()], |line| line.entry(number));
        }
    }
}

/// Blanks before each line.
fn indents(lines: &[JobLine<'_>]) -> Vec<usize> {
    let mut indents: Vec<usize> = Vec::new();
    for line in lines {
        let closes = line.pieces.first().is_some_and(|piece| matches!(piece.kind, TokenKind::Close(_)));
        let base = line.within.map_or(0, |(number, piece)| {
            let (outer, from) = (&lines[number], indents[number]);
            // A list that begins behind its bracket has its next lines below its first point.
            let ends_line = outer.pieces.iter().rposition(|p| p.kind != TokenKind::Comment) == Some(piece);
            match outer.pieces[piece].kind {
                TokenKind::Open(b'[' | b'(') if !ends_line => from + outer.width(piece) + outer.pieces[piece].gap + 1,
                _ if closes => from,
                _ => from + INDENT,
            }
        });
        indents.push(base + if line.goes_on { INDENT } else { 0 });
    }
    indents
}

/// Puts the comments at the ends of successive lines below each other.
fn align_comments(lines: &mut [JobLine<'_>], indents: &[usize]) {
    let ends_in_comment =
        |line: &JobLine<'_>| line.pieces.len() > 1 && line.pieces.last().is_some_and(|p| p.kind == TokenKind::Comment);
    let mut k = 0;
    while k < lines.len() {
        let of_run = |i: &usize| ends_in_comment(&lines[*i]) && (*i == k || !lines[*i].blank_before);
        let run = k..k + (k..lines.len()).take_while(of_run).count();
        let ends: Vec<usize> = run.clone().map(|i| indents[i] + lines[i].width(lines[i].pieces.len() - 1)).collect();
        let most = ends.iter().max().copied().unwrap_or(0);
        for (line, end) in lines[run.clone()].iter_mut().zip(ends) {
            if let Some(comment) = line.pieces.last_mut() {
                comment.gap = WIDE_GAP + most - end;
            }
        }
        k = run.end.max(k + 1);
    }
}

/// The text of the lines.
fn written(mut lines: Vec<JobLine<'_>>) -> String {
    align(&mut lines);
    let indents = indents(&lines);
    align_comments(&mut lines, &indents);
    let mut out = String::new();
    for (line, indent) in lines.iter().zip(&indents) {
        if line.blank_before && !out.is_empty() {
            out.push('\n');
        }
        out.extend(std::iter::repeat_n(' ', *indent));
        for piece in &line.pieces {
            out.extend(std::iter::repeat_n(' ', piece.gap));
            out.push_str(piece.text);
        }
        out.push('\n');
    }
    out
}
