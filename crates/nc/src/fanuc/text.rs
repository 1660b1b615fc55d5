//! Lines of the family as words: tape marks, comments, addresses and numbers.

use super::control::Member;
use crate::control::{CodeName, has_byte, number, number_end, shown, without_blanks};
use std::borrow::Cow;

/// Most digits of a number: the control refuses more (alarm PS0003).
const MAX_DIGITS: usize = 9;

/// Decimals of F.
const FEED_DECIMALS: usize = 3;

/// Beginnings of macro statements.
const STATEMENTS: [&str; 7] = ["IF", "WHILE", "GOTO", "DO", "END", "THEN", "SETVN"];

/// A line without comments and blanks, in a buffer where it has no comment. Blanks and tabs have no meaning, also inside of
/// words.
pub(super) fn without_comments<'b>(line: &str, buffer: &'b mut Vec<u8>) -> Result<Cow<'b, str>, String> {
    let line = line.strip_suffix('\r').unwrap_or(line);
    if !has_byte(line, |byte| matches!(byte, b'(' | b')')) {
        return Ok(without_blanks(line, |byte| byte, buffer).into());
    }
    let mut code = String::with_capacity(line.len());
    let mut inside = false;
    for c in line.chars() {
        match (inside, c) {
            (false, '(') => inside = true,
            (true, ')') => inside = false,
            (true, '(') => return Err("a comment inside a comment".to_owned()),
            (false, ')') => return Err("a comment has an end, but no beginning".to_owned()),
            (true, '%') => return Err("`%` in a comment: the control takes it for the end of the text".to_owned()),
            (true, ';') => return Err("`;` in a comment: the control takes it for the end of the block".to_owned()),
            (true, c) if !c.is_ascii() => {
                return Err(format!("`{}` in a comment: the control reads ASCII only", shown(&c.to_string(), 1)));
            }
            (true, _) | (false, ' ' | '\t') => {}
            (false, c) => code.push(c),
        }
    }
    if inside { Err("a comment does not end".to_owned()) } else { Ok(code.into()) }
}

/// First word of a text without blanks: its letter, its number as written, and the rest.
pub(super) fn first_word(code: &str) -> Result<(char, &str, &str), String> {
    let letter = code.chars().next().unwrap_or(' ');
    // The second letter of a statement is none of a word.
    let letters = code.as_bytes().get(1).is_some_and(u8::is_ascii_uppercase);
    if let Some(statement) = STATEMENTS.iter().find(|s| letters && code.starts_with(**s)) {
        return Err(format!("`{statement}` is not understood: macro statements are not read"));
    }
    if !letter.is_ascii_uppercase() {
        let why = match letter {
            '/' => ": whether a skipped block runs depends on a switch at the control",
            '#' | '[' | ']' | '=' | '*' => ": macro variables and expressions are not read",
            '%' => ": the end of the text must be alone in its line",
            'a'..='z' => ": the control reads capital letters only",
            ';' => ": a comment stands in brackets",
            _ => "",
        };
        return Err(format!("`{}` is not understood at the beginning of a word{why}", shown(code, 1)));
    }
    let tail = &code[1..];
    let (text, rest) = tail.split_at(number_end(tail));
    if text.is_empty() && rest.starts_with(['#', '[', '-']) {
        return Err(format!(
            "`{letter}{}` is not understood: macro variables and expressions are not read",
            shown(rest, 8)
        ));
    }
    Ok((letter, text, rest))
}

/// A whole number, which the control takes only without a decimal point.
pub(super) fn count(text: &str) -> Result<u32, String> {
    if text.is_empty() {
        return Err("a number is missing".to_owned());
    }
    if !(1..=9).contains(&text.len()) || !text.bytes().all(|b| b.is_ascii_digit()) {
        return Err("not a whole number without sign and decimal point".to_owned());
    }
    text.parse().map_err(|_| "not a whole number".to_owned())
}

/// A length, an angle or a component of a direction: the decimal point is necessary, and no digit may be behind the last one
/// that the control takes.
pub(super) fn decimal(letter: char, text: &str, member: &Member) -> Result<f64, String> {
    let value = number(text)?;
    let decimals = if letter == 'F' { FEED_DECIMALS } else { member.decimals };
    let digits = text.bytes().filter(u8::is_ascii_digit).count();
    let Some(point) = text.bytes().position(|byte| byte == b'.') else {
        // Zero is zero in every unit.
        if value == 0.0 && letter != 'F' {
            return Ok(value);
        }
        return Err(format!(
            "without a decimal point the unit depends on a setting of the control ({}): write `{letter}{}.`",
            member.point,
            shown(text, 20)
        ));
    };
    if digits > MAX_DIGITS {
        return Err(format!("more than {MAX_DIGITS} digits: the control refuses the word"));
    }
    let behind = text.len() - (point + 1) - text.bytes().rev().take_while(|byte| *byte == b'0').count();
    if behind > decimals {
        return Err(format!(
            "{behind} decimals, and the control takes {decimals}: it drops the others; write {decimals} decimals"
        ));
    }
    Ok(value)
}

/// The name of a G or M word in one spelling: G00 and G0 are one word.
pub(super) fn code_name(letter: char, text: &str) -> Result<CodeName, String> {
    let (whole, tenth) = text.split_once('.').map_or((text, None), |(whole, tenth)| (whole, Some(tenth)));
    let plain =
        |digits: &str, most: usize| (1..=most).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit());
    let good = plain(whole, if letter == 'M' { 4 } else { 3 }) && tenth.is_none_or(|t| letter == 'G' && plain(t, 1));
    if text.is_empty() {
        return Err(format!("`{letter}`: a number is missing"));
    }
    if !good {
        return Err(format!("`{letter}{}` is no word of the control", shown(text, 20)));
    }
    let value = |digits: &str| digits.bytes().fold(0, |value, digit| 10 * value + u32::from(digit - b'0'));
    Ok(CodeName::new(letter, value(whole), tenth.map(|tenth| value(tenth) as u8)))
}

/// Checks the number or the name of a program in the first block.
pub(super) fn program_name(code: &str, member: &Member) -> Result<(), String> {
    let Member { program_digits: most, program_names, .. } = *member;
    let names = if program_names { ", or `<NAME>`" } else { "" };
    if let Some(digits) = code.strip_prefix('O') {
        let plain = (1..=most as usize).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit());
        return if plain && digits.bytes().any(|b| b != b'0') {
            Ok(())
        } else {
            Err(format!(
                "`{}` is no program number: write `O` and 1 to {most} digits that are not all 0",
                shown(code, 20)
            ))
        };
    }
    if let Some(name) = code.strip_prefix('<').and_then(|c| c.strip_suffix('>')).filter(|_| program_names) {
        let plain = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'+' | b'_' | b'.');
        return if (1..=32).contains(&name.len()) && name.bytes().all(plain) {
            Ok(())
        } else {
            Err(format!("`<{}>` is no program name: 1 to 32 letters, digits, `-`, `+`, `_` and `.`", shown(name, 40)))
        };
    }
    Err(format!("the first block after `%` must be the program number, such as `O1000`{names}"))
}
