//! Changes of texts for SINUMERIK 840D by functions.

use super::changes::{Dialect, Named, TextChange, block_at_feed};

pub const DIALECT: Dialect =
    Dialect { begins: |lines, i| lines[i].ends_with("a restart point"), in_the_cut: block_at_feed, texts: TEXTS };

const TEXTS: &[Named<TextChange>] = &[
    ("an orientation tolerance of 0.1 deg in finishing", |t| wide_turn(t, "_ORI_FINISH,", ")")),
    ("A without sign", |t| t.replacen("SUPA G0 A=-", "SUPA G0 A=", 1).replacen("SUPA G0 A=6", "SUPA G0 A=5", 1)),
    ("a vector of no length", zero_vector),
    ("513 characters", |t| t.replacen("G500", &format!("G500{}", " ".repeat(509)), 1)),
    ("all that switches off is missing", |t| t.rfind("TRAFOOF\n").map(|at| format!("{}M30\n", &t[..at])).unwrap()),
];

fn zero_vector(text: &str) -> String {
    let at = text.find(" A3=").unwrap();
    let end = at + text[at..].find(" C3=").unwrap();
    let end = end + 1 + text[end + 1..].find([' ', '\n']).unwrap();
    format!("{} A3=0 B3=0 C3=0{}", &text[..at], &text[end..])
}

/// The last number between two pieces is 0.1.
pub(super) fn wide_turn(text: &str, before: &str, behind: &str) -> String {
    let from = text.rfind(before).unwrap() + before.len();
    let to = from + text[from..].find(behind).unwrap();
    assert!(text[from..to].parse::<f64>().unwrap() < 0.09);
    format!("{}0.1{}", &text[..from], &text[to..])
}
