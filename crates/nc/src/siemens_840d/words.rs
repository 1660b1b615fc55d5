//! Words of 840D blocks: name, value, and the text behind them.

use crate::control::{number_end, shown, trim_start};
use std::borrow::Cow;

/// Value of a word.
pub(super) enum WordValue<'a> {
    /// Nothing.
    None,
    /// A number, or other text in the place of a number.
    Number(&'a str),
    /// A number that an R parameter is added to, or that is multiplied with it.
    Computed {
        /// Number.
        number: &'a str,
        /// Sum, or product.
        sum: bool,
        /// Number of the parameter.
        parameter: &'a str,
    },
    /// A position `DC(...)` of an axis modulo 360 deg, to which the axis goes the shorter way.
    Shorter(&'a str),
    /// A name in quotes.
    Quoted(&'a str),
    /// Text between brackets.
    Arguments(&'a str),
    /// Text between brackets behind an address with an index, `PO[X]=(...)`.
    Polynomial(&'a str),
}

/// First word of a text: its name in upper case, its value, and the rest.
pub(super) fn split(text: &str) -> Result<(Cow<'_, str>, WordValue<'_>, &str), String> {
    let letter = text.chars().next().unwrap_or(' ');
    if !letter.is_ascii_alphabetic() {
        let why = match letter {
            '/' => ": a switch at the control decides whether this block runs",
            '(' => ": brackets are not comments in this dialect",
            '%' => ": only the first line of a transferred file may have it",
            _ => "",
        };
        return Err(format!("`{}` is not understood at the beginning of a word{why}", shown(text, 1)));
    }
    if matches!(letter, 'P' | 'p')
        && let Some(found) = polynomial(text)
    {
        return found;
    }
    let is_name = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
    let second = text.as_bytes().get(1).copied().unwrap_or(b' ');
    if second.is_ascii_alphabetic() || second == b'_' {
        let end = text.bytes().position(|byte| !is_name(byte)).unwrap_or(text.len());
        let (name, rest) = text.split_at(end);
        let name = upper(name);
        if let Some(inside) = rest.strip_prefix('(') {
            let (arguments, rest) = arguments(inside)?;
            return Ok((name, WordValue::Arguments(arguments), rest));
        }
        if let Some(behind) = after_equals(rest).filter(|_| ["XH", "YH", "ZH"].contains(&&*name)) {
            let (value, rest) = value(behind)?;
            return Ok((name, value, rest));
        }
        if rest.trim_start_matches([' ', '\t']).starts_with('=') {
            return Err(format!("`{}=` is not understood", shown(&name, 40)));
        }
        return Ok((name, WordValue::None, rest));
    }
    let digits = 1 + text.bytes().skip(1).take_while(u8::is_ascii_digit).count();
    if let Some(behind) = after_equals(&text[digits..]).filter(|_| digits > 1) {
        let (value, rest) = value(behind)?;
        return Ok((upper(&text[..digits]), value, rest));
    }
    // The control takes the digit after these letters as part of the name.
    if matches!(letter.to_ascii_uppercase(), 'A'..='C') && second == b'3' {
        let word = text.split([' ', '\t']).next().unwrap_or_default();
        return Err(format!("`{}`: `=` is missing behind the address", shown(word, 20)));
    }
    let behind = &text[1..];
    let (value, rest) = value(after_equals(behind).unwrap_or(behind))?;
    Ok((upper(&text[..1]), value, rest))
}

/// Name of an axis, coefficients, and the rest of a text.
type FirstWord<'a> = Result<(Cow<'a, str>, WordValue<'a>, &'a str), String>;

/// A word `PO[axis]=(...)` at the start of a text; `None` where there is another word.
fn polynomial(text: &str) -> Option<FirstWord<'_>> {
    let head = text.get(..3).filter(|head| head.eq_ignore_ascii_case("PO["))?;
    let (axis, rest) = text[head.len()..].split_once(']')?;
    let Some(inside) = after_equals(rest).and_then(|rest| rest.strip_prefix('(')) else {
        return Some(Err("`PO[..]` without `=(...)`".to_owned()));
    };
    Some(arguments(inside).map(|(coefficients, rest)| (upper(axis), WordValue::Polynomial(coefficients), rest)))
}

/// Text after an equals sign.
fn after_equals(text: &str) -> Option<&str> {
    trim_start(text).strip_prefix("=").map(trim_start)
}

/// The value at the start of a text, and the rest.
fn value(text: &str) -> Result<(WordValue<'_>, &str), String> {
    let end = number_end(text);
    if end > 0 {
        // The sign behind the number of a computed one counts as a part of it.
        let expression = matches!(text.as_bytes().get(end), Some(b'*' | b'R' | b'r'));
        let found = if expression { computed(text) } else { None };
        return Ok(found.unwrap_or_else(|| (WordValue::Number(&text[..end]), &text[end..])));
    }
    if let Some(inside) = text.strip_prefix('"') {
        let end = inside.find('"').ok_or("a quoted text is not closed")?;
        return Ok((WordValue::Quoted(&inside[..end]), &inside[end + 1..]));
    }
    if let Some(inside) = text.get(..3).filter(|head| head.eq_ignore_ascii_case("DC(")).map(|head| &text[head.len()..])
    {
        let (position, rest) = arguments(inside)?;
        return Ok((WordValue::Shorter(position), rest));
    }
    let wrong = text.split([' ', '\t', ';']).next().unwrap_or_default();
    if wrong.is_empty() {
        return Ok((WordValue::Number(""), text));
    }
    Err(format!("`{}` is not a number: parameters and expressions are not read", shown(wrong, 20)))
}

/// A number with an R parameter at the start of a text, such as `12.5+R90` or `12.5*R91`, and the rest.
fn computed(text: &str) -> Option<(WordValue<'_>, &str)> {
    let signed = text.strip_prefix('-').unwrap_or(text);
    let digits = signed.find(|c: char| !(c.is_ascii_digit() || c == '.')).filter(|n| *n > 0)?;
    let (number, behind) = text.split_at(text.len() - signed.len() + digits);
    let sum = behind.starts_with('+');
    let behind = behind.strip_prefix(['+', '*'])?.strip_prefix(['R', 'r'])?;
    let end = behind.find(|c: char| !c.is_ascii_digit()).unwrap_or(behind.len());
    let (parameter, rest) = behind.split_at(end);
    Some((WordValue::Computed { number, sum, parameter }, rest))
}

/// Text between brackets, and the rest.
fn arguments(inside: &str) -> Result<(&str, &str), String> {
    let mut quoted = false;
    for (i, c) in inside.char_indices() {
        match c {
            '"' => quoted = !quoted,
            ')' if !quoted => return Ok((&inside[..i], &inside[i + 1..])),
            _ => {}
        }
    }
    Err("a bracket is not closed".to_owned())
}

pub(super) fn upper(name: &str) -> Cow<'_, str> {
    if name.bytes().any(|b| b.is_ascii_lowercase()) { name.to_ascii_uppercase().into() } else { name.into() }
}

pub(super) fn is_count(text: &str) -> bool {
    (1..=9).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit())
}

/// A whole number.
pub(super) fn count(text: &str) -> Result<u32, String> {
    match text {
        "" => Err("a number is missing".to_owned()),
        text if is_count(text) => text.parse().map_err(|_| "not a count".to_owned()),
        _ => Err("not a count".to_owned()),
    }
}
