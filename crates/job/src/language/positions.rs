//! Bytes of a text as lines and columns of an editor, which counts columns in units of UTF-16.

use std::ops::Range;

/// A place of a text: its line, and the units of UTF-16 before it in the line; both from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Position {
    /// Line from 0.
    pub line: usize,
    /// Units of UTF-16 before the place.
    pub column: usize,
}

/// A text with the beginnings of its lines.
#[derive(Clone, Debug)]
pub struct Positions<'a> {
    text: &'a str,
    lines: Vec<usize>,
}

impl<'a> Positions<'a> {
    /// The places of a text.
    pub fn new(text: &'a str) -> Self {
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Self { text, lines }
    }

    /// The line of a byte, without its line end.
    fn line(&self, number: usize) -> &'a str {
        let start = self.lines.get(number).copied().unwrap_or(self.text.len());
        let end = self.lines.get(number + 1).map_or(self.text.len(), |next| next - 1);
        self.text[start..end.max(start)].trim_end_matches('\r')
    }

    /// The place of a byte; a byte inside of a letter is the beginning of the letter.
    pub fn of(&self, byte: usize) -> Position {
        let mut byte = byte.min(self.text.len());
        while !self.text.is_char_boundary(byte) {
            byte -= 1;
        }
        let line = self.lines.partition_point(|start| *start <= byte) - 1;
        let column = self.text[self.lines[line]..byte].chars().map(char::len_utf16).sum();
        Position { line, column }
    }

    /// The byte of a place; behind the end of a line it is this end, behind the last line the end of the text.
    pub fn byte(&self, at: Position) -> usize {
        let Some(start) = self.lines.get(at.line) else { return self.text.len() };
        let mut units = 0;
        for (offset, letter) in self.line(at.line).char_indices() {
            if units >= at.column {
                return start + offset;
            }
            units += letter.len_utf16();
        }
        start + self.line(at.line).len()
    }

    /// The places of a range of bytes.
    pub fn range(&self, range: Range<usize>) -> [Position; 2] {
        [self.of(range.start), self.of(range.end)]
    }

    /// The place behind the last letter.
    pub fn end(&self) -> Position {
        self.of(self.text.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn letters_of_two_units_and_line_ends() {
        let text = "a\u{1D11E}b\r\n\nµ x";
        let positions = Positions::new(text);
        let at = |line, column| Position { line, column };
        assert_eq!(positions.of(text.find('b').unwrap()), at(0, 3));
        assert_eq!(positions.byte(at(0, 3)), text.find('b').unwrap());
        assert_eq!(positions.byte(at(0, 99)), text.find('\r').unwrap());
        assert_eq!(positions.byte(at(2, 2)), text.find('x').unwrap());
        assert_eq!(positions.byte(at(9, 0)), text.len());
        assert_eq!(positions.end(), at(2, 3));
    }

    proptest! {
        #[test]
        fn a_place_is_that_of_its_byte(text in "[a-cµ\u{1D11E}\n]{0,40}", byte in 0..60_usize) {
            let positions = Positions::new(&text);
            let at = positions.of(byte);
            prop_assert_eq!(positions.of(positions.byte(at)), at);
            let before: String = text.char_indices().take_while(|(i, c)| i + c.len_utf8() <= byte).map(|(_, c)| c).collect();
            prop_assert_eq!(positions.byte(at), before.len());
            prop_assert_eq!(at.line, before.matches('\n').count());
        }
    }
}
