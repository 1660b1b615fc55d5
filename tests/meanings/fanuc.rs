//! Changes of texts for Fanuc 30i and 31i, and for Mitsubishi M700 and M800, by functions.

use super::changes::{Dialect, Named, TextChange, block_at_feed};

pub const DIALECT: Dialect =
    Dialect { begins: |lines, i| lines[i].ends_with("a restart point)"), in_the_cut: block_at_feed, texts: TEXTS };

const TEXTS: &[Named<TextChange>] = &[
    ("no turns", |t| turns_without(t, |_, _| true)),
    ("the third turn is missing", |t| turns_without(t, |k, _| k == 2)),
    ("no last turn", |t| turns_without(t, |k, n| k + 1 == n)),
    ("a turn twice", |t| third_turn(t, |l| format!("{l}\n{l}"))),
    ("a turn at feed", |t| third_turn(t, |l| l.replace("G0", "G1 F100."))),
    ("a turn lower", |t| third_turn(t, |l| l.replace(" Z", " Z-"))),
    ("a turn beside", |t| third_turn(t, |l| l.replace(" X", " X1"))),
    ("turns modally", |t| third_turn(t, |l| l.replace("G0 ", ""))),
    ("all turns lower", turns_lower),
    ("all that switches off is missing", |t| t.rfind("G49\n").map(|at| format!("{}M30\n%\n", &t[..at])).unwrap()),
];

/// Places of the blocks that turn the tables to the start of the first operation.
fn turning(text: &str) -> std::ops::Range<usize> {
    let lines: Vec<&str> = text.lines().collect();
    let begin = lines.iter().position(|l| l.starts_with("G43.4")).unwrap() + 1;
    let rotary = |i: usize| lines[i][lines[i].find(" A").unwrap()..].to_owned();
    // The first target has the angles of the last turn.
    let end = (begin..).find(|i| rotary(*i) == rotary(i + 1)).unwrap() + 1;
    assert!(end > begin + 10, "{begin} to {end}");
    begin..end
}

/// The text with its lines changed.
fn lines_changed(text: &str, change: impl Fn(usize, &str) -> Option<String>) -> String {
    text.lines().enumerate().filter_map(|(i, line)| change(i, line)).map(|line| line + "\n").collect()
}

/// The text without some of the turning blocks, counted from the first one.
fn turns_without(text: &str, which: impl Fn(usize, usize) -> bool) -> String {
    let turning = turning(text);
    lines_changed(text, |i, line| {
        let gone = turning.contains(&i) && which(i - turning.start, turning.len());
        (!gone).then(|| line.to_owned())
    })
}

/// The text with a piece of its third turning block replaced.
fn third_turn(text: &str, change: impl Fn(&str) -> String) -> String {
    let at = turning(text).start + 2;
    lines_changed(text, |i, line| Some(if i == at { change(line) } else { line.to_owned() }))
}

/// All turning blocks for a tool that is 5 mm longer.
fn turns_lower(text: &str) -> String {
    let turning = turning(text);
    lines_changed(text, |i, line| {
        if !turning.contains(&i) {
            return Some(line.to_owned());
        }
        let word = |letter: &str| {
            let at = line.find(&format!(" {letter}")).unwrap() + 2;
            let end = line[at..].find(' ').map_or(line.len(), |n| at + n);
            line[at..end].parse::<f64>().unwrap()
        };
        let (a, c) = (word("A").to_radians(), word("C").to_radians());
        let axis = crate::support::axis_at(a, c);
        // The tool stays upright in the machine: its axis on the part is that of the table.
        Some(format!(
            "G0 X{:.4} Y{:.4} Z{:.4} A{:.4} C{:.4}",
            word("X") - 5.0 * axis.x,
            word("Y") - 5.0 * axis.y,
            word("Z") - 5.0 * axis.z,
            word("A"),
            word("C")
        ))
    })
}
