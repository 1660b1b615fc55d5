//! Limits of a report, whatever a file adds to a message, and characters that must not reach a terminal.

use super::codes::files;
use super::{Diag, Label, Place, Severity, Sink};
use std::borrow::Cow;

/// Most marks of one diagnostic.
const MAX_LABELS: usize = 20;

/// Most notes of one diagnostic.
const MAX_NOTES: usize = 40;

/// Longest text of a message, mark, help or note, in characters: a few screens.
const MAX_TEXT_LENGTH: usize = 4000;

/// The diagnostics of a run as a report for tools shows them. When a run has more than it keeps, remarks at the end
/// give the number.
pub(super) fn all(sink: &Sink) -> Vec<Diag> {
    let mut shown: Vec<Diag> = sink.diags().iter().map(bounded).collect();
    for (severity, word) in
        [(Severity::Error, "errors"), (Severity::Warning, "warnings"), (Severity::Remark, "remarks")]
    {
        let further = sink.further(severity);
        if further > 0 {
            shown.push(Diag::remark(files::NOT_SHOWN, format!("{further} further {word} are not shown")));
        }
    }
    shown
}

/// The diagnostic within the limits for marks, notes and characters; it says what was left out.
pub(super) fn bounded(diag: &Diag) -> Diag {
    let label = |l: &Label| Label { span: l.span, text: cut(&l.text).into_owned() };
    let place = |p: &Place| Place { what: cut(&p.what).into_owned(), ..p.clone() };
    let mut notes: Vec<String> = diag.notes.iter().take(MAX_NOTES).map(|n| cut(n).into_owned()).collect();
    if diag.notes.len() > MAX_NOTES {
        notes.push(format!("{} further facts are not shown", diag.notes.len() - MAX_NOTES));
    }
    if diag.labels.len() > MAX_LABELS {
        notes.push(format!("{} further places are not marked", diag.labels.len() - MAX_LABELS));
    }
    Diag {
        code: diag.code,
        severity: diag.severity,
        message: cut(&diag.message).into_owned(),
        labels: diag.labels.iter().take(MAX_LABELS).map(label).collect(),
        help: diag.help.as_deref().map(|h| cut(h).into_owned()),
        notes,
        // A change of the text is kept only as a whole.
        fix: diag.fix.clone().filter(|f| f.replacement.len() <= MAX_TEXT_LENGTH),
        place: diag.place.as_ref().map(place),
        known: diag.known.clone(),
    }
}

fn cut(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(MAX_TEXT_LENGTH) {
        None => text.into(),
        Some((end, _)) => format!("{} ... ({} bytes more)", &text[..end], text.len() - end).into(),
    }
}

/// Whether a character controls a terminal or changes the direction of text: controls, line separators, bidirectional
/// marks, tags.
pub(super) fn steers(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
            | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

/// The shown form of such a character.
pub(super) fn escape(c: char) -> String {
    format!("<U+{:04X}>", u32::from(c))
}

/// A text of several lines for a terminal.
pub(super) fn visible(text: &str) -> Cow<'_, str> {
    if !text.chars().any(|c| steers(c) && c != '\n') {
        return text.into();
    }
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if steers(c) && c != '\n' { out.push_str(&escape(c)) } else { out.push(c) }
    }
    out.into()
}

/// JSON in which these characters are escaped; its strings have the same value.
pub(super) fn json(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if steers(c) && c != '\n' {
            let mut units = [0; 2];
            for unit in c.encode_utf16(&mut units) {
                out.push_str(&format!("\\u{unit:04x}"));
            }
        } else {
            out.push(c);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codes::files::INTERNAL;
    use base::source::Span;

    #[test]
    fn what_is_left_out_is_said() {
        let mut diag =
            Diag::error(INTERNAL, "\u{e4}".repeat(1_000_000)).help("h").fix(Span::default(), "x".repeat(10_000));
        for i in 0..1000 {
            diag = diag.label(Span::default(), "l").note(format!("n{i}"));
        }
        let shown = bounded(&diag);
        assert!(shown.message.ends_with(" ... (1992000 bytes more)"), "{}", shown.message);
        assert_eq!(shown.labels.len(), MAX_LABELS);
        assert_eq!(shown.notes[MAX_NOTES..], ["960 further facts are not shown", "980 further places are not marked"]);
        assert_eq!((shown.help.as_deref(), shown.fix), (Some("h"), None));
    }

    #[test]
    fn no_character_steers_the_terminal() {
        let text = "a\u{1b}[2Jb\u{202e}c\td\ne\u{9b}\u{e0041}";
        assert_eq!(visible(text), "a<U+001B>[2Jb<U+202E>c<U+0009>d\ne<U+009B><U+E0041>");
        let value = serde_json::Value::String(text.to_owned());
        let shown = json(&value.to_string());
        assert!(!shown.contains(steers));
        assert_eq!(serde_json::from_str::<serde_json::Value>(&shown).unwrap(), value);
    }
}
