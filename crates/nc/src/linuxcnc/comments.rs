//! Lines of LinuxCNC text before their words, for the reader: length, comments, block number. Comments stand in brackets or
//! behind a semicolon, and some are commands.

use crate::control::{LONGEST_NUMBER, has_byte, shown, without_blanks};
use std::borrow::Cow;

/// Longest line of the interpreter, without its line feed; a carriage return counts.
const MAX_LINE_LENGTH: usize = 252;

/// Beginnings of comments that the control or its screen executes.
const EXECUTED: [&str; 12] = [
    "debug,",
    "print,",
    "log,",
    "logopen",
    "logappend",
    "logclose",
    "probeopen",
    "probeclose",
    "abort",
    "axis,",
    "py",
    "preview,",
];

/// What stands in the place of a comment: the control ends a word there.
pub(super) const COMMENT: char = '(';

/// A line without blanks, in upper case, with [`COMMENT`] in the place of each comment; in a buffer where it has none.
///
/// # Errors
/// What the control refuses in a line that it reads without executing it as well.
pub(super) fn code_of<'b>(line: &str, buffer: &'b mut Vec<u8>) -> Result<Cow<'b, str>, String> {
    if line.len() > MAX_LINE_LENGTH {
        return Err(format!("longer than {MAX_LINE_LENGTH} characters: the control refuses the line"));
    }
    let code = if has_byte(line, |byte| matches!(byte, b'(' | b')' | b';')) {
        without_comments(line)?.into()
    } else {
        let line = line.strip_suffix('\r').unwrap_or(line);
        Cow::from(without_blanks(line, |byte| byte.to_ascii_uppercase(), buffer))
    };
    behind_number(&code)?;
    Ok(code)
}

/// The text behind the block number of a line, which is digits and may have a fraction.
pub(super) fn behind_number(code: &str) -> Result<&str, String> {
    let Some(text) = code.strip_prefix('N') else { return Ok(code) };
    let digits = |text: &str| text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let bad = || format!("`N{}` is no block number: write digits", shown(text, 20));
    let whole = digits(text);
    let (_, rest) = text.split_at_checked(whole).filter(|_| whole > 0 && whole <= LONGEST_NUMBER).ok_or_else(bad)?;
    match rest.strip_prefix('.') {
        None => Ok(rest),
        Some(fraction) => match digits(fraction) {
            0 => Err(bad()),
            count => Ok(&fraction[count..]),
        },
    }
}

/// A line without blanks, in upper case, with [`COMMENT`] in the place of each comment.
fn without_comments(line: &str) -> Result<String, String> {
    let mut code = String::with_capacity(line.len());
    let mut inside: Option<usize> = None;
    let line = line.strip_suffix('\r').unwrap_or(line);
    for (i, c) in line.char_indices() {
        match (inside, c) {
            (None, ';') => {
                harmless(&line[i + 1..])?;
                code.push(COMMENT);
                break;
            }
            (None, '(') => inside = Some(i + 1),
            (Some(from), ')') => {
                harmless(&line[from..i])?;
                code.push(COMMENT);
                inside = None;
            }
            (Some(_), '(') => return Err("a comment inside a comment".to_owned()),
            (None, ')') => return Err("a comment has an end, but no beginning".to_owned()),
            (None, ' ' | '\t') => {}
            (None, c) => code.push(c.to_ascii_uppercase()),
            (Some(_), _) => {}
        }
    }
    if inside.is_some() { Err("a comment does not end".to_owned()) } else { Ok(code) }
}

/// Refuses comments that are commands.
fn harmless(comment: &str) -> Result<(), String> {
    let start: String =
        comment.chars().filter(|c| !c.is_whitespace()).take(12).collect::<String>().to_ascii_lowercase();
    let order = EXECUTED.iter().find(|order| match **order {
        // The name of the language, then its code.
        "py" => ["py,", "pyrun,", "pyreload"].iter().any(|p| start.starts_with(p)),
        order => start.starts_with(order),
    });
    match order {
        Some(order) => Err(format!(
            "`({})` is not a comment: the control executes the text behind `{}`",
            shown(comment.trim(), 30),
            order.trim_end_matches(',')
        )),
        None => Ok(()),
    }
}
