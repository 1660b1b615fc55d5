//! Changes of texts for LinuxCNC by functions.

use super::changes::{Dialect, Named, TextChange, block_at_feed};

pub const DIALECT: Dialect =
    Dialect { begins: |lines, i| lines[i].ends_with("a restart point)"), in_the_cut: block_at_feed, texts: TEXTS };

const TEXTS: &[Named<TextChange>] = &[
    ("A with another sign", |t| t.replacen("G53 G0 A", "G53 G0 A-", 1).replace("A--", "A")),
    ("rapids by G0", rapids_by_g0),
    ("rapids in half of their time", |t| inverse_times(t, 2.0)),
    ("rapids without F", |t| inverse_times(t, f64::NAN)),
    ("253 characters", |t| t.replacen("(groove: a restart point)", &format!("({})", "x".repeat(251)), 1)),
    ("252 characters", |t| t.replacen("(groove: a restart point)", &format!("({})", "x".repeat(250)), 1)),
    ("no M5 before %", |t| tape(&t.replacen("M5\nM2\n", "M2\n", 1))),
    ("no M9 before %", |t| tape(&t.replacen("M9\nM5\nM2\n", "M5\nM2\n", 1))),
    ("between %", tape),
];

/// Blocks in inverse time as the words of a rapid.
fn rapids_by_g0(text: &str) -> String {
    by_inverse_blocks(text, |line| {
        let words: Vec<&str> = line.split(' ').filter(|w| !["G93", "G1"].contains(w) && !w.starts_with('F')).collect();
        format!("G0 {}", words.join(" "))
    })
}

/// Blocks in inverse time with F times a factor, or without F.
fn inverse_times(text: &str, factor: f64) -> String {
    by_inverse_blocks(text, |line| {
        let (words, f) = line.rsplit_once(" F").unwrap_or_default();
        if factor.is_nan() { words.to_owned() } else { format!("{words} F{:.5}", f.parse().unwrap_or(0.0) * factor) }
    })
}

fn by_inverse_blocks(text: &str, change: impl Fn(&str) -> String) -> String {
    let mut inverse = false;
    let mut changed = String::new();
    for line in text.lines() {
        inverse = line.contains("G93 ") || inverse && !line.contains("G94");
        let moves = inverse && line.contains(" X") && line.contains(" F");
        changed.push_str(&if moves { change(line) } else { line.to_owned() });
        changed.push('\n');
    }
    changed
}

fn tape(text: &str) -> String {
    format!("%\n{}", text.replace("M2\n", "%\n"))
}
