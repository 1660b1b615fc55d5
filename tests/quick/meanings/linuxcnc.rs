//! Changes for LinuxCNC 2.9 with the kinematics xyzac-trt. Reasons come from its manual, from runs of its interpreter,
//! and from runs of its controller.

use super::Change::{All, Cut, First, Job, Last, Machine, Move, Text, Word};
use super::How::{Address, Double, Number};
use super::Kind;
use super::Verdict::{Found, Harmless, Refused};
use super::operations;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;

pub fn kinds() -> Vec<Kind> {
    let mut all = Vec::new();
    all.extend(head());
    all.extend(change());
    all.extend(perimeter());
    all.extend(transformation());
    all.extend(path());
    all.extend(moves());
    all.extend(spelling());
    all.extend(end());
    all.extend(operations::kinds(parts));
    all.extend(wrong());
    all
}

fn head() -> Vec<Kind> {
    const C: &str = "head";
    vec![
        (C, First("G21 ", ""), Refused, "G20 can be left over: inches"),
        (C, First("G21 ", "G20 "), Refused, "inches"),
        (C, First("G21 ", "G21 G21 "), Refused, "two words of one group are an error"),
        (C, First("G21 ", "G21 G20 "), Refused, "two words of one group"),
        (C, First("G21 ", "G021 "), Harmless, "leading zeros mean nothing"),
        (C, First("G17 ", ""), Refused, "the plane is left over"),
        (C, First("G17 ", "G18 "), Refused, "another plane"),
        (C, First("G17 ", "G19 "), Refused, "another plane"),
        (C, First("G17 ", "G17.1 "), Refused, "a plane of U V W"),
        (C, First("G17 ", "G17 G17 "), Refused, "two words of one group"),
        (C, First("G90 ", ""), Refused, "G91 can be left over"),
        (C, First("G90 ", "G91 "), Refused, "words would be distances"),
        (C, First("G90 ", "G90 G91 "), Refused, "two words of one group"),
        (C, First("G90 ", "G90 G91.1 "), Harmless, "distance mode of arcs only"),
        (C, First("G90 ", "G90.1 "), Refused, "absolute arcs are another group; G91 can be left over"),
        (C, First("G40 ", ""), Refused, "cutter compensation can be left over"),
        (C, First("G40 ", "G41 "), Refused, "cutter compensation"),
        (C, First("G40 ", "G42 "), Refused, "cutter compensation"),
        (C, First("G40 ", "G41.1 "), Refused, "cutter compensation"),
        (C, First("G49 ", ""), Harmless, "G53 leaves the length out, and G43 takes the right one before M428"),
        (C, First("G49 ", "G43 "), Refused, "the length of an unknown tool"),
        (C, First("G49 ", "G43 G49 "), Refused, "two words of one group"),
        (C, First("G80 ", ""), Harmless, "G0 ends a cycle as well"),
        (C, First("G80 ", "G81 "), Refused, "a cycle"),
        (C, First("G80 ", "G0 "), Harmless, "no axis word: nothing moves"),
        (C, First("G80 ", "G0 G80 "), Refused, "two words of one group"),
        (C, First("G94 ", ""), Harmless, "every operation begins with G93 and says G94 with its first feed"),
        (C, First("G94 ", "G93 "), Harmless, "the same"),
        (C, First("G94 ", "G95 "), Harmless, "the same"),
        (C, First("G94 ", "G94 G93 "), Refused, "two words of one group"),
        (C, First("G97 ", ""), Refused, "constant cutting speed can be left over"),
        (C, First("G97 ", "G96 "), Refused, "S would be a cutting speed"),
        (C, First("G8 ", ""), Refused, "diameter mode can be left over: X counts half"),
        (C, First("G8 ", "G7 "), Refused, "X is a diameter"),
        (C, First(" G54", ""), Refused, "another offset can be left over"),
        (C, First(" G54", " G55"), Refused, "another offset"),
        (C, First(" G54", " G56"), Refused, "another offset"),
        (C, First(" G54", " G57"), Refused, "another offset"),
        (C, First(" G54", " G58"), Refused, "another offset"),
        (C, First(" G54", " G59"), Refused, "another offset"),
        (C, First(" G54", " G59.1"), Refused, "another offset"),
        (C, First(" G54", " G59.3"), Refused, "another offset"),
        (C, First(" G54", " G54 G55"), Refused, "two words of one group"),
        (C, First(" G54", " G54 G98"), Harmless, "retract of cycles only"),
        (C, First("G92.1\n", ""), Refused, "an offset of G92 is kept in the parameter file"),
        (C, First("G92.1\n", "G92.2\n"), Harmless, "suspends the offset"),
        (C, First("G92.1\n", "G92.3\n"), Refused, "takes the offset up again"),
        (C, First("G92.1\n", "G92 X1\n"), Refused, "shifts the frame"),
        (C, First("G92.1\n", "G92.1\nG92.3\n"), Refused, "takes the offset up again"),
        (C, First("G92.1\n", "G92.1\nG92.1\n"), Harmless, "said twice"),
        (C, First("G92.1\n", "G52 X0\n"), Refused, "shifts the frame"),
        (C, First("G10 L2 P1 R0\n", ""), Refused, "a rotation of the offset is kept in the parameter file"),
        (C, First("G10 L2 P1 R0\n", "G10 L2 P1 R10\n"), Refused, "turns the frame"),
        (C, First("G10 L2 P1 R0\n", "G10 L2 P2 R0\n"), Refused, "the rotation of another offset"),
        (C, First("G10 L2 P1 R0\n", "G10 L20 P1 R0\n"), Refused, "sets the offset from the position"),
        (C, First("G10 L2 P1 R0\n", "G10 L1 P1 Z5\n"), Refused, "changes the tool table"),
        (C, First("G10 L2 P1 R0\n", "G10 L2 P1 X1 R0\n"), Refused, "changes the offset"),
        (C, First("G10 L2 P1 R0\n", "G10 L2 P1 Z1\n"), Refused, "changes the offset"),
        (C, First("G64 P0.0010 Q0\nG94", "G94"), Harmless, "G61.1 stays: each block stops at its end"),
        (C, First("G64 P0.0010 Q0\nG94", "G64\nG94"), Refused, "blends as far as the speed asks for"),
        (C, First("G64 P0.0010 Q0\nG94", "G64 P0\nG94"), Refused, "0 is no tolerance, not none"),
        (C, First("G64 P0.0010 Q0\nG94", "G64 P0.5 Q0\nG94"), Refused, "more than the job allows"),
        (C, First("G64 P0.0010 Q0\nG94", "G64 P0.0010 Q0.5\nG94"), Refused, "joins blocks by more than the job allows"),
        (C, All("G64 P0.0010 Q0\n", "G64 P0.0010\n"), Refused, "Q is P then: twice what the job allows"),
        (C, First("G64 P0.0010 Q0\nG94", "G64 Q0\nG94"), Refused, "no tolerance at corners"),
        (C, First("G64 P0.0010 Q0\nG94", "G64 P-1 Q0\nG94"), Refused, "a negative tolerance"),
        (C, First("G64 P0.0010 Q0\nG94", "G61\nG94"), Harmless, "exact path"),
        (C, First("G64 P0.0010 Q0\nG94", "G61.1\nG94"), Harmless, "exact stop"),
        (C, First("G64 P0.0010 Q0\nG94", "G61 G64 P0.001 Q0\nG94"), Refused, "two words of one group"),
        (C, First("G64 P0.0010 Q0\nG94", "P0.001\nG94"), Refused, "P of nothing"),
    ]
}

fn change() -> Vec<Kind> {
    const C: &str = "tool change";
    vec![
        (C, First("T1 M6", "M6"), Refused, "no tool was made ready"),
        (C, First("T1 M6", "T1"), Refused, "the tool does not come into the spindle"),
        (C, First("T1 M6\n", ""), Refused, "whichever tool is in the spindle"),
        (C, First("T1 M6", "T2 M6"), Refused, "another tool, with the length of this one"),
        (C, First("T1 M6", "T0 M6"), Refused, "no tool"),
        (C, First("T1 M6", "T1 T2 M6"), Refused, "a word twice"),
        (C, First("T1 M6", "T1 M6 M6"), Refused, "a word twice"),
        (C, First("T1 M6", "T1\nM6"), Harmless, "in two blocks"),
        (C, First("T1 M6", "M6 T1"), Harmless, "T is executed before M6"),
        (C, First("T1 M6", "T01 M06"), Harmless, "leading zeros"),
        (C, First("T1 M6", "T1.0 M6"), Harmless, "a whole number"),
        (C, First("T1 M6", "T1.5 M6"), Refused, "no whole number"),
        (C, First("T1 M6", "T-1 M6"), Refused, "a negative number"),
        (C, First("T1 M6", "T M6"), Refused, "a number is missing"),
        (C, First("T1 M6", "T1 M61"), Refused, "sets the number without a change"),
        (C, First("T1 M6", "T1 M6\nT2 M6"), Refused, "the length of the tool before"),
        (C, First("T1 M6", "T2 M6\nT1 M6"), Harmless, "the last change counts"),
        (C, First("T1 M6", "T1 M6\nT2"), Harmless, "the next tool is made ready, no more"),
        (C, First("G43 H1", "G43 H2"), Refused, "the length of another tool"),
        (C, First("G43 H1", "G43"), Harmless, "the tool in the spindle"),
        (C, First("G43 H1", "G43 H0"), Refused, "no length"),
        (C, First("G43 H1", "G43 H"), Refused, "a number is missing"),
        (C, First("G43 H1", "H1"), Refused, "H of nothing"),
        (C, First("G43 H1", "G49"), Refused, "no length"),
        (C, First("G43 H1\n", ""), Refused, "no length: the table of the control and ours differ by it"),
        (C, First("G43 H1", "G43.1 Z10"), Refused, "a length beside the tool table"),
        (C, First("G43 H1", "G43.2 H2"), Refused, "one length more"),
        (C, First("G43 H1", "G43 H1 H1"), Refused, "a word twice"),
        (C, First("G43 H1\n", "G43 H1\nG49\n"), Refused, "taken back"),
        (C, First("G43 H1\n", "G43 H1\nG43 H2\n"), Refused, "the last one counts"),
        (C, First("G43 H1\n", "G49\nG43 H1\n"), Harmless, "the last one counts"),
        (C, Last("G43 H2", "G43 H1"), Refused, "the length of the tool before"),
        (C, Last("G43 H2\n", ""), Refused, "G49 of the operation before"),
        (C, Last("T2 M6", "T1 M6"), Refused, "another tool"),
        (C, Move("G43 H1", "M428"), Refused, "with the kinematics on the axes jump"),
        (C, Move("G43 H1", "T1 M6"), Harmless, "the length counts for nothing but the kinematics: G53 leaves it out"),
        (C, First("M8\nM428", "M428 G43 H1 M8"), Refused, "M428 runs before G43: the axes jump"),
        (C, First("S12000 M3", "M3"), Refused, "the speed is left over"),
        (C, First("S12000 M3", "S0 M3"), Refused, "standstill"),
        (C, First("S12000 M3", "S-12000 M3"), Refused, "a negative speed"),
        (C, First("S12000 M3", "S6000 M3"), Refused, "another speed than that of the job"),
        (C, First("S12000 M3", "S12000"), Refused, "the spindle stands since M6"),
        (C, First("S12000 M3", "S12000 M4"), Refused, "the wrong way round"),
        (C, First("S12000 M3", "S12000 M5"), Refused, "standstill"),
        (C, First("S12000 M3", "S12000 M3 M4"), Refused, "two words of one group"),
        (C, First("S12000 M3\n", ""), Refused, "the spindle stands since M6"),
        (C, First("S12000 M3", "M3 S12000"), Harmless, "S is executed before M3"),
        (C, First("S12000 M3", "S12000\nM3"), Harmless, "in two blocks"),
        (C, Move("S12000 M3", "T1 M6"), Harmless, "where it stood"),
        (C, First("T1 M6\nS12000 M3", "S12000 M3\nT1 M6"), Refused, "M6 stops the spindle"),
        (C, First("M8\n", ""), Refused, "no coolant"),
        (C, First("M8\n", "M9\n"), Refused, "no coolant"),
        (C, First("M8\n", "M7\n"), Harmless, "mist"),
        (C, First("M8\n", "M08\n"), Harmless, "leading zeros"),
        (C, First("M8\n", "M8 M9\n"), Refused, "two words of one group"),
        (C, First("M8\n", "M8\nM8\n"), Harmless, "said twice"),
        (C, First("M8\n", "M8\nG4 P2\n"), Harmless, "waits before the cut"),
        (C, First("M8\n", "M8\nG4\n"), Refused, "how long is left over"),
        (C, First("M8\n", "M8\nM0\n"), Harmless, "stops with the tool retracted"),
        (C, First("M8\n", "M8\nM1\n"), Harmless, "stops with the tool retracted"),
        (C, First("M8\n", "M8\nM48\n"), Harmless, "overrides by hand, as ever"),
    ]
}

fn perimeter() -> Vec<Kind> {
    const C: &str = "perimeter";
    vec![
        (C, First("G53 G0 Z650.0000\n", ""), Refused, "tool change at an unknown height"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z0"), Refused, "lower than where tools are changed"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z649"), Refused, "lower than where tools are changed"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z651"), Refused, "beyond the travel"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z-650"), Refused, "beyond the travel"),
        (C, First("G53 G0 Z650.0000", "G0 Z650"), Refused, "in the work frame: another height"),
        (C, First("G53 G0 Z650.0000", "G53 Z650"), Refused, "no G0 or G1 since G80"),
        (C, First("G53 G0 Z650.0000", "G53 G1 Z650 F500"), Refused, "at feed from an unknown place"),
        (C, First("G53 G0 Z650.0000", "G53 G0 X0 Z650"), Refused, "sideways on the way up"),
        (C, First("G53 G0 Z650.0000", "G53 G0 A0 Z650"), Refused, "the table turns on the way up"),
        (C, First("G53 G0 Z650.0000", "G53 G0 X0\nG53 G0 Z650"), Refused, "sideways at an unknown height"),
        (C, First("G53 G0 Z650.0000", "G53 G0 C0\nG53 G0 Z650"), Refused, "the table turns at an unknown height"),
        (C, First("G53 G0 Z650.0000", "G28 Z650"), Refused, "a place set at the control"),
        (C, First("G53 G0 Z650.0000", "G30"), Refused, "a place set at the control"),
        (C, First("G53 G0 Z650.0000", "G0 G53 Z650"), Harmless, "order in a block means nothing"),
        (C, First("G53 G0 Z650.0000", "G53 G00 Z+650."), Harmless, "another spelling"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z650\nG53 G0 Z650"), Harmless, "said twice"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z 6 5 0"), Harmless, "blanks in numbers mean nothing"),
        (C, First("G53 G0 Z650.0000", "G53 G53 G0 Z650"), Refused, "a word twice"),
        (C, First("G53 G0 Z650.0000", "G53 G0"), Refused, "no axis word"),
        (C, First("\nG53 G0 A", "\nG53 G0 Z650\nG53 G0 A"), Harmless, "where it stands already"),
        (C, First("\nG53 G0 A", "\nG53 G0 Z600\nG53 G0 A"), Refused, "sideways lower than proved"),
        (C, First("\nG53 G0 A", "\nG53 G0 X0 Y0\nG53 G0 A"), Harmless, "another way at the retract height"),
        (C, First("\nG53 G0 A", "\nG53 G0 X999\nG53 G0 A"), Refused, "beyond the travel"),
        (C, First("\nG53 G0 A", "\nG0 A"), Harmless, "the rotary zero of G54 is that of the machine"),
        (C, First("\nG53 G0 A", "\nG1 F100 A"), Refused, "at feed"),
        (C, First("\nG53 G0 A", "\nG53 G0 B1 A"), Refused, "no such axis"),
        (C, First("\nG53 G0 X", "\nG0 X"), Refused, "in the work frame: another place"),
        (C, First("\nG53 G0 X", "\nG53 G0 Z650 X"), Refused, "Z with it"),
        (C, First("\nG53 G0 X", "\nG53 G1 F100 X"), Refused, "at feed"),
        (C, First("\nG53 G0 X", "\nG53 G0 X1 X"), Refused, "a word twice"),
        (C, First("\nG53 G0 X", "\n(G53 G0 X) G53 G0 X"), Harmless, "a comment"),
        (C, Text("no A and C before M428", |t| without(t, "G53 G0 A")), Refused, "the table turns on the way down"),
        (C, Text("no X and Y before M428", |t| without(t, "G53 G0 X")), Refused, "an unknown place on the way down"),
        (C, Text("X and Y before A and C", swap_stations), Harmless, "both at the retract height"),
        (
            C,
            Text("A with another sign", |t| t.replacen("G53 G0 A", "G53 G0 A-", 1).replace("A--", "A")),
            Refused,
            "the table turns on the way down",
        ),
        (
            C,
            First("M429\nG49\nG53 G0 Z650.0000\n", "M429\nG49\n"),
            Refused,
            "the spindle stops in the part, and the next operation retracts with it at rest",
        ),
        (C, Last("G53 G0 Z650.0000\n", ""), Refused, "the program ends in the part"),
        (C, Last("G53 G0 Z650.0000", "G53 G0 Z0"), Refused, "lower than proved"),
        (C, Last("G53 G0 Z650.0000", "G0 Z650"), Refused, "in the work frame"),
        (C, Last("G53 G0 Z650.0000", "G53 G0 X0 Y0"), Refused, "sideways out of the part"),
        (C, Last("G53 G0 Z650.0000", "G53 G0 Z650\nG53 G0 X0 Y0 A0 C0"), Harmless, "parks behind the retract"),
        (C, Last("G53 G0 Z650.0000", "G53 G0 Z650\nG53 G0 Z0"), Refused, "down again"),
    ]
}

fn without(text: &str, start: &str) -> String {
    text.lines().filter(|l| !l.starts_with(start)).map(|l| format!("{l}\n")).collect()
}

fn swap_stations(text: &str) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    let at = lines.iter().position(|l| l.starts_with("G53 G0 A")).unwrap();
    lines.swap(at, at + 1);
    lines.join("\n") + "\n"
}

fn transformation() -> Vec<Kind> {
    const C: &str = "transformation";
    vec![
        (C, First("M429\n", ""), Refused, "the kinematics can be on since an aborted run"),
        (C, First("M429\n", "M428\n"), Refused, "switched on where the axes are unknown"),
        (C, First("M429\n", "M429\nM429\n"), Harmless, "said twice"),
        (C, First("M429\n", "m 429 ; off\n"), Harmless, "another spelling"),
        (C, First("M429\nG21", "G49\nM429\nG21"), Refused, "G49 before M429: the axes jump"),
        (C, First("M429\nG21", "G43 H1\nM429\nG21"), Refused, "G43 before M429: the axes jump"),
        (C, First("M429\nG21", "G53 G0 Z650\nM429\nG21"), Refused, "a move under unknown kinematics"),
        (C, First("M429\nG21", "T1 M6\nM429\nG21"), Refused, "a change at an unknown height"),
        (C, Move("M429", "G21"), Refused, "G49 before M429: the axes jump"),
        (C, First("M428\n", ""), Refused, "words of the part are those of the machine then"),
        (C, First("M428\n", "M429\n"), Refused, "words of the part are those of the machine then"),
        (C, First("M428\n", "M428\nM428\n"), Refused, "switched on twice: something is missing between"),
        (C, First("M428\n", "M428 M429\n"), Refused, "two words of one group"),
        (C, First("M428\n", "M430\n"), Refused, "kinematics of the user"),
        (C, First("M428\n", "M428 G0 X0\n"), Refused, "switched in a move"),
        (C, First("M428\n", "M428\nG53 G0 Z650\n"), Refused, "machine frame with the kinematics on"),
        (C, First("M428\n", "M428\nG0 Z10\n"), Refused, "X and Y are no longer what they were"),
        (C, First("M428\n", "M428\nT1 M6\n"), Refused, "a change with the kinematics on"),
        (C, First("M428\n", "M428\nG49\n"), Refused, "the axes jump"),
        (C, First("M428\n", "M428\nG92 X0\n"), Refused, "shifts the frame"),
        (C, First("M428\n", "M428\nG55\n"), Refused, "another offset"),
        (C, First("M428\n", "M428\nG54\n"), Harmless, "the same offset"),
        (C, First("M428\n", "M428\nM0\n"), Refused, "waits on the way down"),
        (C, First("M429\nG49\n", "G49\nM429\n"), Refused, "G49 before M429: the axes jump"),
        (C, First("M429\nG49\n", "M429 G49\n"), Harmless, "M429 runs before G49"),
        (C, First("M429\nG49\n", "G49\n"), Refused, "G49 with the kinematics on"),
        (C, First("M429\nG49\n", "M429\n"), Harmless, "G53 leaves the length out"),
        (
            C,
            First("M429\nG49\nG53 G0 Z650.0000\n", "M429\nG53 G0 Z650.0000\nG49\n"),
            Harmless,
            "G53 leaves the length out",
        ),
        (
            C,
            First("M429\nG49\nG53 G0 Z650.0000\n", "M429\nG49 G53 G0 Z650.0000\n"),
            Harmless,
            "G49 runs before the move",
        ),
        (C, Cut("\nG1 X", "\nM429\nG1 X"), Refused, "words of the part are those of the machine then"),
        (C, Cut("\nG1 X", "\nM429\nM428\nG1 X"), Refused, "switched on in the part"),
    ]
}

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

fn path() -> Vec<Kind> {
    const C: &str = "modal in the path";
    vec![
        (C, Cut("\nG1 X", "\nG20\nG1 X"), Refused, "inches"),
        (C, Cut("\nG1 X", "\nG91\nG1 X"), Refused, "distances"),
        (C, Cut("\nG1 X", "\nG18\nG1 X"), Refused, "another plane"),
        (C, Cut("\nG1 X", "\nG41 D1\nG1 X"), Refused, "cutter compensation"),
        (C, Cut("\nG1 X", "\nG93\nG1 X"), Refused, "F is missing then"),
        (C, Cut("\nG1 X", "\nG95\nG1 X"), Refused, "feed a revolution"),
        (
            C,
            First("G61.1 G93 G1", "G61.1 G94 G1"),
            Refused,
            "its F is one over minutes: the tool would come down at feed",
        ),
        (C, First("\nG94 G1", "\nG1"), Refused, "F of the feed would be one over minutes"),
        (C, First("\nG94 G1", "\nG94\nG1"), Harmless, "in a block of its own"),
        (C, All("G61.1 ", "G61 "), Harmless, "exact path keeps to the lines as well"),
        (C, Text("rapids without G93", |t| t.replace("G93 ", "")), Refused, "one over minutes is read as a feed"),
        (C, Text("rapids by G0", rapids_by_g0), Found, "G0 keeps the speed of the tip and not those of the joints"),
        (C, Text("rapids in half of their time", |t| inverse_times(t, 2.0)), Found, "axes twice as fast as they can"),
        (C, Text("rapids without F", |t| inverse_times(t, f64::NAN)), Refused, "inverse time needs F in each block"),
        (C, Cut("\nG1 X", "\nG96\nG1 X"), Refused, "constant cutting speed"),
        (C, Cut("\nG1 X", "\nG7\nG1 X"), Refused, "X is a diameter"),
        (C, Cut("\nG1 X", "\nG55\nG1 X"), Refused, "another offset"),
        (C, Cut("\nG1 X", "\nG92.3\nG1 X"), Refused, "an offset is taken up"),
        (C, Cut("\nG1 X", "\nG52 Z-1\nG1 X"), Refused, "the frame is shifted"),
        (C, Cut("\nG1 X", "\nG10 L2 P1 R5\nG1 X"), Refused, "the frame is turned"),
        (C, Cut("\nG1 X", "\nG10 L2 P1 R0\nG1 X"), Harmless, "is not turned"),
        (C, Cut("\nG1 X", "\nG64\nG1 X"), Refused, "blends as far as the speed asks for"),
        (C, Cut("\nG1 X", "\nG64 P0.9 Q0\nG1 X"), Refused, "more than the job allows"),
        (C, Cut("\nG1 X", "\nG61\nG1 X"), Harmless, "exact path"),
        (C, Cut("\nG1 X", "\nM5\nG1 X"), Refused, "the spindle stands"),
        (C, First("\nM429\nG49\nG53", "\nS1\nM429\nG49\nG53"), Refused, "it nearly stands in the part"),
        (C, Cut("\nG1 X", "\nM4\nG1 X"), Refused, "the wrong way round"),
        (C, Cut("\nG1 X", "\nM9\nG1 X"), Refused, "no coolant"),
        (C, Cut("\nG1 X", "\nM7\nG1 X"), Harmless, "mist"),
        (C, Cut("\nG1 X", "\nS1\nG1 X"), Refused, "another speed than that of the job"),
        (C, Cut("\nG1 X", "\nT2\nG1 X"), Harmless, "the next tool is made ready, no more"),
        (C, Cut("\nG1 X", "\nM6\nG1 X"), Refused, "a change in the part"),
        (C, Cut("\nG1 X", "\nG43 H2\nG1 X"), Refused, "the axes jump"),
        (C, Cut("\nG1 X", "\nM0\nG1 X"), Refused, "the tool rubs while the program waits"),
        (C, Cut("\nG1 X", "\nG4 P9\nG1 X"), Refused, "the tool rubs while the program waits"),
        (C, Cut("\nG1 X", "\nM2\nG1 X"), Refused, "ends in the part"),
        (C, Cut("\nG1 X", "\nM30\nG1 X"), Refused, "ends in the part"),
        (C, Cut("\nG1 X", "\n%\nG1 X"), Refused, "ends in the part"),
        (C, Cut("\nG1 X", "\nG80\nG1 X"), Harmless, "G1 is said again"),
        (C, Cut("\nG1 X", "\nG80\nX"), Refused, "no motion word"),
        (C, Cut("\nG1 X", "\nX"), Harmless, "G1 is modal"),
        (C, Cut("\nG1 X", "\nG17 G21 G90\nG1 X"), Harmless, "said again"),
    ]
}

fn moves() -> Vec<Kind> {
    const C: &str = "block of the path";
    vec![
        (C, Cut("\nG1 X", "\nG0 G1 X"), Refused, "two words of one group"),
        (C, Cut("\nG1 X", "\nG2 X"), Refused, "an arc"),
        (C, Cut("\nG1 X", "\nG3 X"), Refused, "an arc"),
        (C, Cut("\nG1 X", "\nG5 X"), Refused, "a spline, in which Z A C are swallowed"),
        (C, Cut("\nG1 X", "\nG5.2 X"), Refused, "a spline, in which Z A C are swallowed"),
        (C, Cut("\nG1 X", "\nG33 X"), Refused, "follows the spindle"),
        (C, Cut("\nG1 X", "\nG38.2 X"), Refused, "probes"),
        (C, Cut("\nG1 X", "\nG81 X"), Refused, "a cycle beside a move"),
        (C, Cut("\nG1 X", "\nG28 X"), Refused, "goes to a place set at the control"),
        (C, Cut("\nG1 X", "\nG53 G1 X"), Refused, "machine frame with the kinematics on"),
        (C, Cut("\nG1 X", "\n/G1 X"), Refused, "depends on a switch"),
        (C, Cut("\nG1 X", "\n#1=5\nG1 X"), Refused, "a parameter"),
        (C, Cut("\nG1 X", "\no1 if [1]\nG1 X"), Refused, "flow of the program"),
        (C, Cut("\nG1 X", "\nG1 M8 X"), Harmless, "coolant is on"),
        (C, Word("X", Double), Refused, "a word twice"),
        (C, Word("Y", Double), Refused, "a word twice"),
        (C, Word("Z", Double), Refused, "a word twice"),
        (C, Word("A", Double), Refused, "a word twice"),
        (C, Word("C", Double), Refused, "a word twice"),
        (C, Word("X", Address("Y")), Refused, "a word twice"),
        (C, Word("X", Address("U")), Refused, "no such axis"),
        (C, Word("A", Address("B")), Refused, "no such axis"),
        (C, Word("C", Address("A")), Refused, "a word twice"),
        (C, Word("X", Number("NAN")), Refused, "no number"),
        (C, Word("X", Number("INF")), Refused, "no number"),
        (C, Word("X", Number("")), Refused, "a number is missing"),
        (C, Word("X", Number("-")), Refused, "no number"),
        (C, Word("X", Number("--1")), Refused, "the interpreter takes it for 1"),
        (C, Word("X", Number("1e2")), Refused, "no exponents"),
        (C, Word("X", Number("1,5")), Refused, "no comma"),
        (C, Word("X", Number("1.2.3")), Refused, "two points"),
        (C, Word("X", Number("[1+2]")), Refused, "an expression"),
        (C, Word("X", Number("#5420")), Refused, "a parameter"),
        (C, Word("X", Number("999999")), Refused, "beyond any machine"),
        (C, Word("A", Number("200")), Refused, "beyond the travel"),
        (C, Word("C", Number("400")), Refused, "beyond the travel"),
        (C, Word("Z", Number("-60")), Found, "through part and table"),
        (C, Word("Z", Number("900")), Found, "beyond the travel"),
        (C, Cut(" F", " F0 F"), Refused, "a word twice"),
        (C, First("F150.000", "F0"), Refused, "no feed"),
        (C, First("F150.000", "F-150"), Refused, "a negative feed"),
        (C, First("F150.000", "F15000"), Refused, "above the feeds of the job"),
        (C, First("F150.000", "F"), Refused, "a number is missing"),
    ]
}

fn spelling() -> Vec<Kind> {
    const C: &str = "alphabet";
    vec![
        (C, Text("lower case", str::to_lowercase), Harmless, "case means nothing"),
        (C, Text("CRLF", |t| t.replace('\n', "\r\n")), Harmless, "a carriage return is a blank"),
        (C, Text("lone CR", |t| t.replacen(" G90", "\rG90", 1)), Refused, "a control character"),
        (C, Text("tabs", |t| t.replace(' ', "\t")), Harmless, "tabs are blanks"),
        (C, Text("glued", |t| t.replace(' ', "")), Harmless, "blanks mean nothing"),
        (C, Text("wide", |t| t.replace(' ', "   ")), Harmless, "blanks mean nothing"),
        (C, Text("blank lines", |t| t.replace('\n', "\n\n")), Harmless, "blank lines mean nothing"),
        (C, Text("no last line feed", |t| t.trim_end().to_owned()), Harmless, "M2 ends the program"),
        (C, Text("byte order mark", |t| format!("\u{feff}{t}")), Refused, "no character of the language"),
        (C, Text("no-break blank", |t| t.replacen(" G90", "\u{a0}G90", 1)), Refused, "no blank of the language"),
        (C, Text("wide blank", |t| t.replacen(" G90", "\u{3000}G90", 1)), Refused, "no blank of the language"),
        (C, Text("vertical tab", |t| t.replacen(" G90", "\u{b}G90", 1)), Refused, "a control character"),
        (C, Text("zero byte", |t| t.replacen(" G90", "\0G90", 1)), Refused, "a control character"),
        (C, Cut("G1 X", "G1 \u{425}"), Refused, "a Cyrillic letter"),
        (C, Cut("G1 X", "G1 \u{3a7}"), Refused, "a Greek letter"),
        (C, Cut("G1 X", "G\u{661} X"), Refused, "an Arabic digit"),
        (C, Cut("G1 X", "G\u{ff11} X"), Refused, "a wide digit"),
        (C, Cut("Y-", "Y\u{2212}"), Refused, "a minus of typography"),
        (C, Cut("Y-", "Y\u{2013}"), Refused, "a dash"),
        (C, First("T1 M6", "T1 \u{41c}6"), Refused, "a Cyrillic letter"),
        (C, First("G43 H1", "G43 \u{41d}1"), Refused, "a Cyrillic letter"),
        (C, First("(groove: a restart point)", "(groove"), Refused, "a comment without end"),
        (C, First("(groove: a restart point)", "groove)"), Refused, "an end without comment"),
        (C, First("(groove: a restart point)", "(gr(oo)ve)"), Refused, "a comment in a comment"),
        (C, First("(groove: a restart point)", "(py,import os)"), Refused, "runs Python"),
        (C, First("(groove: a restart point)", ";py,import os"), Refused, "runs Python"),
        (C, First("(groove: a restart point)", "(pyrun,x)"), Refused, "runs Python"),
        (C, First("(groove: a restart point)", "(DEBUG,#5420)"), Refused, "reads parameters"),
        (C, First("(groove: a restart point)", "( debug,x)"), Refused, "reads parameters"),
        (C, First("(groove: a restart point)", "(PRINT,x)"), Refused, "writes"),
        (C, First("(groove: a restart point)", "(LOG,x)"), Refused, "writes a file"),
        (C, First("(groove: a restart point)", "(LOGOPEN,x)"), Refused, "opens a file"),
        (C, First("(groove: a restart point)", "(LOGAPPEND,x)"), Refused, "opens a file"),
        (C, First("(groove: a restart point)", "(LOGCLOSE)"), Refused, "closes a file"),
        (C, First("(groove: a restart point)", "(PROBEOPEN x)"), Refused, "opens a file"),
        (C, First("(groove: a restart point)", "(PROBECLOSE)"), Refused, "closes a file"),
        (C, First("(groove: a restart point)", "(AXIS,stop)"), Refused, "an order to the screen"),
        (C, First("(groove: a restart point)", "(MSG,groove)"), Harmless, "shown on the screen"),
        (C, First("(groove: a restart point)", "; groove"), Harmless, "a comment"),
        (C, First("(groove: a restart point)", "(\u{43f}\u{430}\u{437})"), Harmless, "any letters in a comment"),
        (C, First("(groove: a restart point)", ""), Harmless, "no comment"),
        (C, First("(groove: a restart point)", "N10 (groove)"), Harmless, "a block number"),
        (C, First("(groove: a restart point)", "N10.5"), Harmless, "a block number"),
        (C, First("(groove: a restart point)", "N-10"), Refused, "no block number"),
        (C, First("S12000 M3", "S12000 N5 M3"), Refused, "a block number inside of a block"),
        (C, First("(groove: a restart point)", "*5"), Refused, "no word"),
        (C, First("(groove: a restart point)", "TRAORI"), Refused, "a word of another control"),
        (C, First("(groove: a restart point)", "G43.4 H1"), Refused, "a word of another control"),
        (C, First("(groove: a restart point)", "M128"), Refused, "a program of the user"),
        (C, First("(groove: a restart point)", "M100"), Refused, "a program of the user"),
        (C, First("(groove: a restart point)", "G1.5"), Refused, "no such word"),
        (C, First("(groove: a restart point)", "G"), Refused, "a number is missing"),
        (
            C,
            Text("253 characters", |t| t.replacen("(groove: a restart point)", &format!("({})", "x".repeat(251)), 1)),
            Refused,
            "longer than a line may be",
        ),
        (
            C,
            Text("252 characters", |t| t.replacen("(groove: a restart point)", &format!("({})", "x".repeat(250)), 1)),
            Harmless,
            "as long as a line may be",
        ),
    ]
}

fn end() -> Vec<Kind> {
    const C: &str = "end";
    vec![
        (C, Last("M2\n", ""), Refused, "no end"),
        (C, Last("M2\n", "M30\n"), Harmless, "an end as well"),
        (C, Last("M2\n", "M02\n"), Harmless, "leading zeros"),
        (C, Last("M2\n", "M2\nM2\n"), Refused, "text behind the end"),
        (C, Last("M2\n", "M2\nG0 X0\n"), Refused, "text behind the end"),
        (C, Last("M2\n", "M2\n(done)\n"), Harmless, "a comment"),
        (C, Last("M2\n", "M2 M30\n"), Refused, "two words of one group"),
        (C, Last("M2\n", "M99\n"), Refused, "the end of a subroutine"),
        (C, Last("M5\n", ""), Harmless, "M2 stops the spindle"),
        (C, Last("M9\n", ""), Harmless, "M2 stops the coolant"),
        (C, Text("no M5 before %", |t| tape(&t.replacen("M5\nM2\n", "M2\n", 1))), Refused, "`%` stops nothing"),
        (C, Text("no M9 before %", |t| tape(&t.replacen("M9\nM5\nM2\n", "M5\nM2\n", 1))), Refused, "`%` stops nothing"),
        (C, Text("between %", tape), Harmless, "`%` ends a program as well"),
        (C, Text("one %", |t| format!("%\n{t}")), Harmless, "M2 ends it"),
        (C, Text("% at the end only", |t| t.replace("M2\n", "%\n")), Refused, "`%` stands in the first line too"),
        (C, Text("blocks before %", |t| format!("G21\n%\n{t}")), Refused, "text before the first `%`"),
        (C, Text("cut in the middle", |t| t[..t.len() / 2].to_owned()), Refused, "no end"),
        (C, Text("empty", |_| String::new()), Refused, "no program"),
        (C, Last("M429\n", ""), Refused, "ends with the kinematics on"),
        (C, Last("M429\nG49\nG53 G0 Z650.0000\nM9\nM5\n", ""), Refused, "ends in a cut, all on"),
    ]
}

fn tape(text: &str) -> String {
    format!("%\n{}", text.replace("M2\n", "%\n"))
}

/// The head and the operations.
fn parts(text: &str) -> Vec<String> {
    operations::parts(text, |lines, i| lines[i].ends_with("a restart point)"))
}

fn wrong() -> Vec<Kind> {
    const C: &str = "wrong job, machine";
    vec![
        (
            C,
            Machine("sense iso", |m| (m.rotary[0].word_sign, m.rotary[1].word_sign) = (1.0, 1.0)),
            Refused,
            "these kinematics have the other sense",
        ),
        (C, Machine("A iso", |m| m.rotary[0].word_sign = 1.0), Refused, "these kinematics have the other sense"),
        (C, Machine("C iso", |m| m.rotary[1].word_sign = 1.0), Refused, "these kinematics have the other sense"),
        (C, Machine("tools are changed higher", |m| m.retract += 50.0), Refused, "lower than where tools are changed"),
        (C, Machine("Z ends lower", |m| m.linear[2].max -= 50.0), Refused, "beyond the travel"),
        (
            C,
            Machine("A ends earlier", |m| (m.rotary[0].min, m.rotary[0].max) = (-0.1, 0.1)),
            Refused,
            "beyond the travel",
        ),
        (
            C,
            Machine("C ends earlier", |m| (m.rotary[1].min, m.rotary[1].max) = (-0.1, 0.1)),
            Refused,
            "beyond the travel",
        ),
        (
            C,
            Machine("X ends earlier", |m| (m.linear[0].min, m.linear[0].max) = (-1.0, 1.0)),
            Refused,
            "beyond the travel",
        ),
        (C, Job("no operation", |p| p.operations = PrimaryMap::new()), Refused, "more operations than the job"),
        (C, Job("finer tolerance", |p| p.tolerances.chord = Mm(1e-4)), Refused, "smooths by more than the job allows"),
        (C, All("S12000", "S12001"), Refused, "another speed"),
        (C, All("T1 M6", "T3 M6"), Refused, "no such tool in the job"),
    ]
}
