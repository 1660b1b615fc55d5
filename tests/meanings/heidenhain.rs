//! Changes of texts for iTNC 530 and TNC 640 by functions.

use super::changes::{Dialect, Named, TextChange, block_at_feed};

pub const DIALECT: Dialect =
    Dialect { begins: |lines, i| lines[i].starts_with("* - "), in_the_cut: block_at_feed, texts: TEXTS };

const TEXTS: &[Named<TextChange>] = &[
    ("TA0.1 in finishing", |t| super::siemens::wide_turn(t, "HSC-MODE:0 TA", "\n")),
    ("no rotary axes at the start", without_rotary),
    ("no X and Y at the start", without_station),
    ("the station without M91", station_in_part),
    ("with M128", with_m128),
    ("with M128 F", |t| with_m128(t).replacen("\nM128\n", "\nM128 F1000\n", 1)),
    ("with M128 F30000", |t| with_m128(t).replacen("\nM128\n", "\nM128 F30000\n", 1)),
    ("with L M128", |t| with_m128(t).replacen("\nM128\n", "\nL M128 F30000\n", 1)),
    ("M128 in a move", |t| with_m128(t).replacen("\nM128\n", "\nL X+0 Y+0 R0 FMAX M128\n", 1)),
    ("M128 without M129", |t| with_m128(t).replace("M129\n", "")),
    ("M128 to the tool change", m128_to_change),
    ("M128 and M116", |t| with_m128(t).replacen("\nM128\n", "\nM116\nM128\n", 1)),
    ("blank lines", |t| t.replace('\n', "\n\n").replace("~\n\n", "~\n")),
    ("a cycle of 600 characters", |t| t.replacen("DATUM SETTING ~", &format!("DATUM {}~", "A".repeat(600)), 1)),
    ("no M5, no M30", |t| t.rfind("M5\n").map(|at| format!("{}{}", &t[..at], &t[at + 7..])).unwrap()),
    ("all that switches off is missing", |t| {
        t.rfind("FUNCTION RESET TCPM\n").map(|at| format!("{}M30\nEND PGM SMALL MM\n", &t[..at])).unwrap()
    }),
    ("TX before X", vector_first),
    ("the other side", |t| changed_sign(t, " TZ")),
];

fn line_removed(text: &str, is_it: impl Fn(&str) -> bool) -> String {
    let at = text.lines().position(is_it).unwrap();
    text.lines().enumerate().filter(|(i, _)| *i != at).map(|(_, line)| format!("{line}\n")).collect()
}

fn without_rotary(text: &str) -> String {
    line_removed(text, |line| line.starts_with("L A"))
}

fn without_station(text: &str) -> String {
    line_removed(text, |line| line.starts_with("L X") && line.ends_with("M91"))
}

fn station_in_part(text: &str) -> String {
    let at = text.find("L X").unwrap();
    let end = at + text[at..].find(" M91").unwrap();
    format!("{}{}", &text[..end], &text[end + " M91".len()..])
}

fn with_m128(text: &str) -> String {
    text.replace("FUNCTION RESET TCPM\n", "M129\n").replace("FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS\n", "M128\n")
}

fn m128_to_change(text: &str) -> String {
    let text = with_m128(text);
    let on = text.find("\nM128\n").unwrap();
    let off = on + text[on..].find("M129\n").unwrap();
    format!("{}{}", &text[..off], &text[off + "M129\n".len()..])
}

/// The third block of LN.
fn block(text: &str) -> (usize, &str) {
    let at = text.match_indices("\nLN X").nth(2).unwrap().0 + 1;
    (at, &text[at..at + text[at..].find('\n').unwrap()])
}

fn with_block(text: &str, change: impl Fn(&str) -> String) -> String {
    let (at, line) = block(text);
    format!("{}{}{}", &text[..at], change(line), &text[at + line.len()..])
}

fn vector_first(text: &str) -> String {
    with_block(text, |line| {
        let words: Vec<&str> = line.split(' ').collect();
        [&words[..1], &words[4..7], &words[1..4], &words[7..]].concat().join(" ")
    })
}

fn changed_sign(text: &str, word: &str) -> String {
    with_block(text, |line| {
        let at = line.find(word).unwrap() + word.len();
        let sign = if &line[at..=at] == "+" { "-" } else { "+" };
        format!("{}{sign}{}", &line[..at], &line[at + 1..])
    })
}
