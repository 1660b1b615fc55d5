//! Words of a Part 21 file (ISO 10303-21), with their places.

use crate::lines::{cut_off, malformed};
use base::source::{SourceId, Span};
use diagnostics::{Diag, printable};

/// A word of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token<'t> {
    /// `CARTESIAN_POINT`, `ENDSEC`, `END-ISO-10303-21`.
    Keyword(&'t str),
    /// `#12`.
    Reference(u64),
    /// `12`, `-1.5E-3`.
    Number(f64),
    /// `'hub'`, as it stands between its apostrophes.
    Text(&'t str),
    /// `.T.`, without its points.
    Enumeration(&'t str),
    /// `"0FF"`, which nothing here needs.
    Binary,
    Open,
    Close,
    Comma,
    Semicolon,
    Equals,
    /// `$`.
    Omitted,
    /// `*`.
    Derived,
    /// The end of the text.
    End,
}

/// Reads the words of a text one by one.
#[derive(Clone, Debug)]
pub(super) struct Lexer<'t> {
    source: SourceId,
    text: &'t str,
    at: usize,
}

impl<'t> Lexer<'t> {
    /// Reads from a byte on, where a word begins.
    pub(super) fn new(source: SourceId, text: &'t str, at: usize) -> Self {
        Self { source, text, at }
    }

    /// The byte behind the last word.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    pub(super) fn span(&self, from: usize, to: usize) -> Span {
        Span::new(self.source, from..to)
    }

    fn byte(&self, at: usize) -> Option<u8> {
        self.text.as_bytes().get(at).copied()
    }

    /// Goes over blanks and comments.
    fn skip(&mut self) -> Result<(), Diag> {
        loop {
            match (self.byte(self.at), self.byte(self.at + 1)) {
                (Some(b'/'), Some(b'*')) => {
                    let inside = self.at + 2;
                    let Some(length) = self.text.get(inside..).and_then(|rest| rest.find("*/")) else {
                        return Err(self.cut("the end of a comment", self.at));
                    };
                    self.at = inside + length + 2;
                }
                (Some(b), _) if b.is_ascii_whitespace() || b == 0 => self.at += 1,
                _ if self.text.get(self.at..).is_some_and(|rest| rest.starts_with('\u{feff}')) => {
                    self.at += '\u{feff}'.len_utf8();
                }
                _ => return Ok(()),
            }
        }
    }

    /// The fault of a file that ends before something that began at a byte.
    pub(super) fn cut(&self, missing: &str, began: usize) -> Diag {
        let end = self.text.trim_end().len();
        let last = self.text.get(..end).map_or(0, |text| text.char_indices().next_back().map_or(0, |(at, _)| at));
        cut_off(missing, self.span(last, end), "the end of the file")
            .label(self.span(began.min(end), began.min(end)), "this is not complete")
    }

    /// Bytes from `from` on that satisfy a condition.
    fn run(&self, from: usize, is: impl Fn(u8) -> bool) -> usize {
        let bytes = self.text.as_bytes().get(from..).unwrap_or_default();
        from + bytes.iter().position(|b| !is(*b)).unwrap_or(bytes.len())
    }

    /// The next word and its place.
    pub(super) fn next(&mut self) -> Result<(Token<'t>, Span), Diag> {
        self.skip()?;
        let start = self.at;
        let Some(first) = self.byte(start) else { return Ok((Token::End, self.span(start, start))) };
        let one = |token| (token, start + 1);
        let (token, end) = match first {
            b'(' => one(Token::Open),
            b')' => one(Token::Close),
            b',' => one(Token::Comma),
            b';' => one(Token::Semicolon),
            b'=' => one(Token::Equals),
            b'$' => one(Token::Omitted),
            b'*' => one(Token::Derived),
            b'#' => self.reference(start)?,
            b'\'' => self.string(start)?,
            b'"' => {
                let end = self.run(start + 1, |b| b.is_ascii_hexdigit());
                match self.byte(end) {
                    Some(b'"') => (Token::Binary, end + 1),
                    _ => return Err(self.unknown(start)),
                }
            }
            b'.' => {
                let end = self.run(start + 1, |b| b.is_ascii_alphanumeric() || b == b'_');
                match self.byte(end) {
                    Some(b'.') if end > start + 1 => (Token::Enumeration(&self.text[start + 1..end]), end + 1),
                    _ => return Err(self.unknown(start)),
                }
            }
            b'0'..=b'9' | b'+' | b'-' => self.number(start)?,
            b if b.is_ascii_alphabetic() || b == b'_' || b == b'!' => {
                let end = self.run(start + 1, |b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-'));
                (Token::Keyword(&self.text[start..end]), end)
            }
            _ => return Err(self.unknown(start)),
        };
        self.at = end;
        Ok((token, self.span(start, end)))
    }

    fn unknown(&self, at: usize) -> Diag {
        let c = self.text[at..].chars().next().unwrap_or_default();
        let span = self.span(at, at + c.len_utf8());
        malformed(format!("`{}` begins no word of a STEP file", printable(&c.to_string())), span, "this character")
    }

    fn reference(&self, start: usize) -> Result<(Token<'t>, usize), Diag> {
        let end = self.run(start + 1, |b| b.is_ascii_digit());
        let number = self.text[start + 1..end].parse().ok();
        let fault = || malformed("an entity has no number", self.span(start, end), "`#` and a number are expected");
        Ok((Token::Reference(number.ok_or_else(fault)?), end))
    }

    fn number(&self, start: usize) -> Result<(Token<'t>, usize), Diag> {
        let end = self.run(start + 1, |b| matches!(b, b'0'..=b'9' | b'.' | b'+' | b'-' | b'e' | b'E'));
        let fault = |due| malformed("this is not a number", self.span(start, end), due);
        let value: f64 = self.text[start..end].parse().map_err(|_| fault("a number is expected"))?;
        if value.is_finite() { Ok((Token::Number(value), end)) } else { Err(fault("a finite number is expected")) }
    }

    fn string(&self, start: usize) -> Result<(Token<'t>, usize), Diag> {
        let mut at = start + 1;
        loop {
            at = self.run(at, |b| b != b'\'');
            match (self.byte(at), self.byte(at + 1)) {
                (None, _) => return Err(self.cut("the end of a string", start)),
                // An apostrophe of the string is written twice.
                (_, Some(b'\'')) => at += 2,
                _ => return Ok((Token::Text(&self.text[start + 1..at]), at + 1)),
            }
        }
    }
}

/// The text of a string: apostrophes and backslashes that are written twice, and characters by their codes. Directives
/// that are not known stay as they are.
pub(super) fn decoded(raw: &str) -> String {
    let mut out = String::new();
    let mut rest = raw;
    while let Some(c) = rest.chars().next() {
        let (text, length) = match c {
            '\'' if rest.starts_with("''") => ("'".to_owned(), 2),
            '\\' => directive(rest).unwrap_or_else(|| (c.to_string(), 1)),
            _ => (c.to_string(), c.len_utf8()),
        };
        out.push_str(&text);
        rest = rest.get(length..).unwrap_or_default();
    }
    out
}

/// The characters of a directive at the start of a text, and its bytes.
fn directive(text: &str) -> Option<(String, usize)> {
    if text.starts_with("\\\\") {
        return Some(("\\".to_owned(), 2));
    }
    for (begin, digits) in [("\\X2\\", 4), ("\\X4\\", 8)] {
        let Some(rest) = text.strip_prefix(begin) else { continue };
        let inside = rest.get(..rest.find("\\X0\\")?)?;
        let codes: Vec<u32> = inside.as_bytes().chunks(digits).map(hexadecimal).collect::<Option<Vec<_>>>()?;
        let decoded = if digits == 4 {
            let units: Vec<u16> = codes.iter().map(|c| u16::try_from(*c).ok()).collect::<Option<_>>()?;
            String::from_utf16(&units).ok()?
        } else {
            codes.into_iter().map(char::from_u32).collect::<Option<String>>()?
        };
        return Some((decoded, begin.len() + inside.len() + "\\X0\\".len()));
    }
    if let Some(rest) = text.strip_prefix("\\X\\") {
        return Some((char::from_u32(hexadecimal(rest.as_bytes().get(..2)?)?)?.to_string(), 5));
    }
    if let Some(rest) = text.strip_prefix("\\S\\") {
        let c = rest.chars().next().filter(char::is_ascii)?;
        return Some((char::from_u32(c as u32 + 128)?.to_string(), 4));
    }
    None
}

fn hexadecimal(digits: &[u8]) -> Option<u32> {
    u32::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read() {
        let text = "#12 = B('a''b',.T.,$,*,-1.5E-3,(2.)) /* ; */;";
        let mut lexer = Lexer::new(SourceId::default(), text, 0);
        let mut found = Vec::new();
        loop {
            let (token, _) = lexer.next().unwrap();
            if token == Token::End {
                break;
            }
            found.push(token);
        }
        use Token::*;
        let due = [
            Reference(12),
            Equals,
            Keyword("B"),
            Open,
            Text("a''b"),
            Comma,
            Enumeration("T"),
            Comma,
            Omitted,
            Comma,
            Derived,
            Comma,
            Number(-0.0015),
            Comma,
            Open,
            Number(2.0),
            Close,
            Close,
            Semicolon,
        ];
        assert_eq!(found, due);
        for faulty in ["'a", "/* a", "#", "1e999", ".T", "\"0", "ü", "1-2"] {
            assert!(Lexer::new(SourceId::default(), faulty, 0).next().is_err(), "{faulty}");
        }
    }

    #[test]
    fn strings_are_decoded() {
        for (raw, text) in [
            ("it''s", "it's"),
            ("a\\\\b", "a\\b"),
            ("\\X2\\00FC03B1\\X0\\!", "\u{fc}\u{3b1}!"),
            ("\\X4\\0001F600\\X0\\", "\u{1f600}"),
            ("\\X\\FCx", "\u{fc}x"),
            ("\\S\\|", "\u{fc}"),
            ("\\Q\\", "\\Q\\"),
            ("\\X2\\00F", "\\X2\\00F"),
        ] {
            assert_eq!(decoded(raw), text);
        }
    }
}
