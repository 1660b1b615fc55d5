//! Comments in LinuxCNC text, for the reader: they stand in brackets or behind a semicolon, and some are commands.

use crate::post::control::shown;

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

/// A line without comments and blanks, in upper case.
pub(super) fn without_comments(line: &str) -> Result<String, String> {
    let mut code = String::with_capacity(line.len());
    let mut inside: Option<usize> = None;
    let line = line.strip_suffix('\r').unwrap_or(line);
    for (i, c) in line.char_indices() {
        match (inside, c) {
            (None, ';') => {
                harmless(&line[i + 1..])?;
                break;
            }
            (None, '(') => inside = Some(i + 1),
            (Some(from), ')') => {
                harmless(&line[from..i])?;
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
