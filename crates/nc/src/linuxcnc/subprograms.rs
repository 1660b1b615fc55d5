//! Subprograms in LinuxCNC text, for the reader: `o101 sub`, `o101 endsub`, `o101 call [45] [1]`.
//!
//! The interpreter knows a subprogram of the same file from its line `sub` on, and skips it there (manual, "O Codes"). Its
//! words may count with the values of a call. Other O words, which branch and loop, are refused.

use super::comments::{COMMENT, behind_number, code_of};
use crate::control::flow::{Flow, Step};
use crate::control::{has_byte, number, shown};
use std::collections::BTreeMap;
use std::ops::Range;

/// Most values of a call.
const MAX_ARGUMENTS: usize = 30;

/// What a line with an O word says.
enum OWord {
    Sub,
    EndSub,
    Call(Vec<f64>),
}

/// A subprogram that has begun.
struct OpenSubprogram {
    name: String,
    line: usize,
    /// What the control refuses in one of its lines, before any call.
    fault: Option<String>,
}

/// Finds the subprograms of a text and their calls.
pub(super) fn flow(text: &str) -> Flow {
    let mut flow = Flow::default();
    let mut known: BTreeMap<String, Range<usize>> = BTreeMap::new();
    let mut open: Option<OpenSubprogram> = None;
    let mut buffer = Vec::new();
    for (at, line) in text.split('\n').enumerate() {
        let start = line.trim_start_matches([' ', '\t']).as_bytes().first().copied().unwrap_or(b' ');
        let may_begin =
            matches!(start, b'o' | b'O' | b'n' | b'N') && has_byte(line, |byte| matches!(byte, b'o' | b'O'));
        if !may_begin && open.is_none() {
            continue;
        }
        let code = match (code_of(line, &mut buffer), &mut open) {
            (Ok(code), _) => code,
            // Nothing executes the lines of a subprogram that nobody calls, and the control reads them all the same.
            (Err(reason), Some(begun)) => {
                begun.fault.get_or_insert(format!("line {}: {reason}", at + 1));
                continue;
            }
            // The reader reports it.
            (Err(_), None) => continue,
        };
        let Some(word) = behind_number(&code).unwrap_or(&code).strip_prefix('O') else { continue };
        let step = match o_word(word) {
            Err(reason) => Step::Fault(reason),
            Ok((name, OWord::Sub)) => match &open {
                Some(OpenSubprogram { name: outer, line, .. }) => Step::Fault(format!(
                    "`o{name} sub` inside of the subprogram o{outer}, which begins in line {}: write `o{outer} endsub` before",
                    line + 1
                )),
                None if known.contains_key(&name) => {
                    Step::Fault(format!("`o{name} sub` twice in one text: give each subprogram a name of its own"))
                }
                None => {
                    open = Some(OpenSubprogram { name, line: at, fault: None });
                    continue;
                }
            },
            Ok((name, OWord::EndSub)) => match open.take() {
                Some(begun) if begun.name == name => {
                    known.insert(name, begun.line + 1..at);
                    flow.0.insert(begun.line, begun.fault.map_or(Step::SkipTo(at + 1), Step::Fault));
                    Step::Label
                }
                begun => {
                    open = begun;
                    Step::Fault(format!("`o{name} endsub` without `o{name} sub` before"))
                }
            },
            Ok((name, OWord::Call(arguments))) => match (&open, known.get(&name)) {
                (Some(_), _) => {
                    Step::Fault(format!("`o{name} call` inside of a subprogram: call it from the program itself"))
                }
                (None, Some(lines)) => Step::Call { lines: lines.clone(), times: 1, arguments },
                (None, None) => Step::Fault(format!(
                    "`o{name} call`, and no `o{name} sub` before: the control looks for a file of this name; write the subprogram before its call"
                )),
            },
        };
        flow.0.insert(at, step);
    }
    if let Some(OpenSubprogram { name, line, .. }) = open {
        flow.0.insert(line, Step::Fault(format!("`o{name} sub` without `o{name} endsub` behind")));
    }
    flow
}

/// Name and meaning of the text behind the letter O, in upper case and without blanks.
fn o_word(text: &str) -> Result<(String, OWord), String> {
    let (name, rest) = match text.strip_prefix('<') {
        Some(inside) => inside.split_once('>').ok_or("the name of a subprogram has no `>`")?,
        None => text.split_at(text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len())),
    };
    // Behind the word only comments stand.
    let rest = rest.trim_end_matches(COMMENT);
    let plain = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if !plain {
        return Err(format!("`O{}` is no name of a subprogram", shown(text, 20)));
    }
    let word = if rest == "SUB" {
        OWord::Sub
    } else if rest == "ENDSUB" {
        OWord::EndSub
    } else if let Some(values) = rest.strip_prefix("CALL") {
        OWord::Call(arguments(values)?)
    } else {
        return Err(format!(
            "`o{} {}` is not read: of O words only sub, endsub and call",
            shown(name, 20),
            shown(rest, 20)
        ));
    };
    // The control compares numbers as numbers: o0101 is o101.
    let number = if text.starts_with('<') { None } else { Some(name.trim_start_matches('0')) };
    let name = number.map_or(name, |digits| if digits.is_empty() { "0" } else { digits });
    Ok((name.to_owned(), word))
}

/// Values in square brackets.
fn arguments(mut text: &str) -> Result<Vec<f64>, String> {
    let mut values = Vec::new();
    while !text.is_empty() {
        let inside = text.strip_prefix('[').and_then(|t| t.split_once(']'));
        let (value, rest) =
            inside.ok_or_else(|| format!("`{}` is no value of a call: write `[45]`", shown(text, 20)))?;
        values.push(number(value).map_err(|reason| format!("a value of a call: {reason}"))?);
        text = rest;
    }
    if values.len() > MAX_ARGUMENTS { Err(format!("more than {MAX_ARGUMENTS} values in a call")) } else { Ok(values) }
}

/// The written number of `[12.5+#1]` or `[12.5*#2]` without its brackets, and its value.
pub(super) fn computed(text: &str, arguments: &[f64]) -> Result<[f64; 2], String> {
    let due = || format!("`[{}]` is not read: write a number, `[12.5+#1]` or `[12.5*#1]`", shown(text, 20));
    let (value, parameter) = text.split_once('#').ok_or_else(due)?;
    let (value, sum) = match (value.strip_suffix('+'), value.strip_suffix('*')) {
        (Some(value), _) => (value, true),
        (_, Some(value)) => (value, false),
        _ => return Err(due()),
    };
    let value = number(value)?;
    let index: usize = parameter.parse().ok().filter(|_| parameter.len() <= 2).ok_or_else(due)?;
    let given = index.checked_sub(1).and_then(|k| arguments.get(k));
    let given = given.ok_or_else(|| format!("`#{index}` has no value: the call of the subprogram gives it"))?;
    Ok([value, if sum { value + given } else { value * given }])
}
