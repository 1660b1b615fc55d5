//! Statements of CL data: lines put together, and their words and numbers.
//!
//! A statement is `WORD` or `WORD/argument,argument`. `$$` begins a comment. `$` at the end of a line goes on in the next
//! one. What stands after column 72 is the name of the card for a processor, so that it would be lost.

use crate::control::{WordList, control_character, has_byte, shown};

/// Last column of a statement.
const LAST_COLUMN: usize = 72;

/// Longest statement, in characters.
const MAX_STATEMENT_LENGTH: usize = 1000;

/// Words behind which the rest of the line is text.
const TEXTS: [&str; 2] = ["PARTNO", "PPRINT"];

/// One statement.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Statement<'a> {
    /// Line that it begins in, from 1.
    pub(super) line: usize,
    /// Major word.
    pub(super) word: &'a str,
    /// What stands behind the stroke; `None` without a stroke.
    arguments: Option<&'a str>,
}

impl<'a> Statement<'a> {
    /// Whether it has a stroke.
    pub(super) fn has_stroke(&self) -> bool {
        self.arguments.is_some()
    }

    /// What stands between the commas behind the stroke, without blanks around.
    pub(super) fn values(&self) -> WordList<'a> {
        let commas = self.arguments.into_iter().flat_map(|text| text.split(','));
        commas.map(|value| value.trim_matches([' ', '\t'])).collect()
    }
}

/// Gives every statement of a text to a function, with its line; or what is wrong with a line.
pub(super) fn each(text: &str, mut found: impl FnMut(usize, Result<Statement<'_>, String>) -> bool) {
    let mut open: Option<(usize, String)> = None;
    let mut last = 1;
    for (i, line) in text.strip_suffix('\n').unwrap_or(text).split('\n').enumerate() {
        last = i + 1;
        let line = line.strip_suffix('\r').unwrap_or(line);
        let goes_on = match code(line, open.is_some()) {
            Ok((part, false)) if open.is_none() => {
                if !part.is_empty() && !found(last, split(last, part)) {
                    return;
                }
                continue;
            }
            Ok((part, goes_on)) => {
                let (first, whole) = open.get_or_insert_with(|| (i + 1, String::new()));
                if part.is_empty() && !whole.is_empty() && !goes_on {
                    let reason = format!("the statement that line {first} continues by `$` does not go on here");
                    open = None;
                    if !found(i + 1, Err(reason)) {
                        return;
                    }
                    continue;
                }
                whole.push_str(part);
                if whole.len() > MAX_STATEMENT_LENGTH {
                    let reason = format!("a statement of more than {MAX_STATEMENT_LENGTH} characters");
                    open = None;
                    if !found(i + 1, Err(reason)) {
                        return;
                    }
                    continue;
                }
                goes_on
            }
            Err(reason) => {
                open = None;
                if !found(i + 1, Err(reason)) {
                    return;
                }
                continue;
            }
        };
        if goes_on {
            continue;
        }
        let Some((first, whole)) = open.take() else { continue };
        if !whole.is_empty() && !found(first, split(first, &whole)) {
            return;
        }
    }
    if let Some((first, _)) = open {
        found(last, Err(format!("the text ends in the statement that line {first} continues by `$`")));
    }
}

/// The code of a line without blanks around, and whether the statement goes on in the next line.
fn code(line: &str, inside: bool) -> Result<(&str, bool), String> {
    if let Some(reason) = control_character(line) {
        return Err(reason);
    }
    // A line of one statement that ends with it.
    if !has_byte(line, |byte| byte == b'$') && line.len() <= LAST_COLUMN {
        return Ok((line.trim_matches([' ', '\t']), false));
    }
    let is_text = !inside && TEXTS.iter().any(|word| line.trim_start().starts_with(word));
    let code = if is_text { line } else { line.split("$$").next().unwrap_or_default() };
    let code = code.trim_end_matches([' ', '\t']);
    if code.chars().count() > LAST_COLUMN {
        return Err(format!(
            "text behind column {LAST_COLUMN}: a processor takes it for the name of the line; continue by `$`"
        ));
    }
    let code = code.trim_start_matches([' ', '\t']);
    if is_text {
        return Ok((code, false));
    }
    match code.split_once('$') {
        None => Ok((code, false)),
        Some((part, "")) => Ok((part.trim_end_matches([' ', '\t']), true)),
        Some((_, rest)) => Err(format!(
            "`{}` behind `$`: a processor does not read it; write `$` at the end of the line, `$$` before a comment",
            shown(rest.trim_start(), 20)
        )),
    }
}

/// Word and arguments of a statement.
fn split(line: usize, text: &str) -> Result<Statement<'_>, String> {
    if let Some(word) = TEXTS.into_iter().find(|word| text.starts_with(word)) {
        return Ok(Statement { line, word, arguments: None });
    }
    let (word, rest) = match text.split_once('/') {
        Some((word, rest)) => (word, Some(rest)),
        None => (text, None),
    };
    let word = word.trim_matches([' ', '\t']);
    if word.is_empty() || !word.bytes().all(|b| b.is_ascii_uppercase() || b.is_ascii_digit()) {
        return Err(format!("`{}` is no word: words are capitals and digits", shown(word, 20)));
    }
    Ok(Statement { line, word, arguments: rest })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Vec<String> {
        let mut list = Vec::new();
        each(text, |line, found| {
            list.push(match found {
                Ok(s) => format!("{line}: {} {:?}", s.word, &*s.values()),
                Err(reason) => format!("{line}! {reason}"),
            });
            true
        });
        list
    }

    #[test]
    fn lines_make_statements() {
        assert_eq!(
            all("RAPID\n\n  GOTO / 1 ,2,\t3 $$ far $ $$ away\n"),
            ["1: RAPID []", "3: GOTO [\"1\", \"2\", \"3\"]"]
        );
        assert_eq!(all("GOTO/1,2, $ $$ more\n  3,4\nFINI"), ["1: GOTO [\"1\", \"2\", \"3\", \"4\"]", "3: FINI []"]);
        assert_eq!(all("PARTNO A $ B $$ C / D\n$$ all\nFINI\r\n"), ["1: PARTNO []", "3: FINI []"]);
        let starts = [
            ("GOTO/1,$\n\nFINI", "2! the statement that line 1 continues"),
            ("GOTO/1,$\n$$ what\nFINI", "2! the statement that line 1 continues"),
            ("GOTO/1,$", "1! the text ends in the statement"),
            ("GOTO/1, $ 2", "1! `2` behind `$`"),
            ("goto/1", "1! `goto` is no word"),
            ("/1", "1! `` is no word"),
            ("RAPID GOTO/1", "1! `RAPID GOTO` is no word"),
            ("GOTO/1\u{7}", "1! the control character U+0007"),
        ];
        for (text, due) in starts {
            assert!(all(text)[0].starts_with(due), "{:?}", all(text));
        }
        let long = format!("GOTO/{}", "1".repeat(68));
        assert!(all(&long)[0].contains("behind column 72") && all(&long[..72])[0].starts_with("1: GOTO"));
        assert!(all(&format!("RAPID{} $$ {}", " ".repeat(60), "x".repeat(60)))[0].starts_with("1: RAPID"));
        assert!(all(&"GOTO/1111111111111,$\n".repeat(80)).iter().any(|l| l.contains("more than 1000 characters")));
    }
}
