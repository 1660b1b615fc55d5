//! Pieces of the text of a block. A text has millions of blocks, so that none of them takes memory of its own.

use std::ops::Deref;

/// Most words of a [`WordList`] that need no memory of their own: almost all blocks have fewer.
const FEW: usize = 16;

/// Longest [`CodeName`]: a letter, nine digits, a point and a digit.
const LONGEST_CODE: usize = 12;

/// The words of a block.
pub(crate) struct WordList<'a> {
    few: [&'a str; FEW],
    count: usize,
    /// All words, where they are more than a few.
    many: Vec<&'a str>,
}

impl<'a> FromIterator<&'a str> for WordList<'a> {
    fn from_iter<I: IntoIterator<Item = &'a str>>(words: I) -> Self {
        let mut list = Self { few: [""; FEW], count: 0, many: Vec::new() };
        for word in words {
            match list.few.get_mut(list.count) {
                Some(place) => *place = word,
                None if list.many.is_empty() => list.many.extend(list.few.into_iter().chain([word])),
                None => list.many.push(word),
            }
            list.count += 1;
        }
        list
    }
}

impl<'a> Deref for WordList<'a> {
    type Target = [&'a str];

    fn deref(&self) -> &[&'a str] {
        if self.many.is_empty() { &self.few[..self.count] } else { &self.many }
    }
}

/// A G or M word in one spelling, such as `G43.4`.
pub(crate) struct CodeName {
    text: [u8; LONGEST_CODE],
    length: usize,
}

impl CodeName {
    /// The name with a letter of ASCII, a number below 10^9, and the digit behind its point.
    pub(crate) fn new(letter: char, whole: u32, tenth: Option<u8>) -> Self {
        let mut name = Self { text: [0; LONGEST_CODE], length: 0 };
        name.push(letter as u8);
        let mut unit = 1;
        while whole / unit >= 10 {
            unit *= 10;
        }
        while unit > 0 {
            name.push(b'0' + (whole / unit % 10) as u8);
            unit /= 10;
        }
        if let Some(tenth) = tenth {
            name.push(b'.');
            name.push(b'0' + tenth);
        }
        name
    }

    fn push(&mut self, byte: u8) {
        if let Some(place) = self.text.get_mut(self.length) {
            *place = byte;
            self.length += 1;
        }
    }
}

impl Deref for CodeName {
    type Target = str;

    fn deref(&self) -> &str {
        std::str::from_utf8(&self.text[..self.length]).unwrap_or_default()
    }
}

/// Where the digits, points and signs at the start of a text end.
pub(crate) fn number_end(text: &str) -> usize {
    let in_number = |byte: u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'+');
    text.bytes().position(|byte| !in_number(byte)).unwrap_or(text.len())
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t')
}

/// A text from its first byte on that is neither blank nor tab.
pub(crate) fn trim_start(text: &str) -> &str {
    &text[text.bytes().position(|byte| !is_blank(byte)).unwrap_or(text.len())..]
}

/// The words between the blanks and tabs of a text.
pub(crate) fn words(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = text;
    std::iter::from_fn(move || {
        let from = trim_start(rest);
        let (word, behind) = from.split_at(from.bytes().position(is_blank).unwrap_or(from.len()));
        rest = behind;
        Some(word).filter(|word| !word.is_empty())
    })
}

/// A text without its blanks and tabs, its other bytes spelt by a function that changes letters of ASCII alone.
pub(crate) fn without_blanks<'b>(text: &str, spelt: impl Fn(u8) -> u8, buffer: &'b mut Vec<u8>) -> &'b str {
    buffer.clear();
    buffer.resize(text.len(), 0);
    let mut length = 0;
    for byte in text.bytes() {
        // The next byte takes the place of a blank: no branch depends on the text.
        buffer[length] = spelt(byte);
        length += usize::from(!is_blank(byte));
    }
    std::str::from_utf8(&buffer[..length]).unwrap_or_default()
}

/// Whether a byte of a text fulfils a condition. All of them are asked, several at once: lines are short.
pub(crate) fn has_byte(text: &str, is: impl Fn(u8) -> bool) -> bool {
    text.bytes().fold(false, |found, byte| found | is(byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_has_all_words_of_any_number() {
        for count in [0, 1, FEW - 1, FEW, FEW + 1, 3 * FEW] {
            let words: Vec<String> = (0..count).map(|k| k.to_string()).collect();
            let list: WordList<'_> = words.iter().map(String::as_str).collect();
            assert_eq!(&*list, words, "{count}");
        }
    }

    #[test]
    fn blanks_and_tabs_divide_words() {
        assert_eq!(words(" \t10 L\t\tX+1 \u{c4}\u{a0}b ").collect::<Vec<_>>(), ["10", "L", "X+1", "\u{c4}\u{a0}b"]);
        assert_eq!(words(" \t ").count(), 0);
        let mut buffer = Vec::new();
        assert_eq!(without_blanks(" g1\tx 1\u{c4} ", |b| b.to_ascii_uppercase(), &mut buffer), "G1X1\u{c4}");
        assert_eq!(without_blanks("", |b| b, &mut buffer), "");
    }

    #[test]
    fn names_of_codes() {
        for (name, due) in [
            (CodeName::new('G', 0, None), "G0"),
            (CodeName::new('G', 43, Some(4)), "G43.4"),
            (CodeName::new('M', 1000, None), "M1000"),
            (CodeName::new('G', 999_999_999, Some(9)), "G999999999.9"),
        ] {
            assert_eq!(&*name, due);
        }
    }
}
