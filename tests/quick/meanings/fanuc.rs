//! Changes for Fanuc 30i and 31i, and for Mitsubishi M700 and M800. Reasons come from Fanuc B-63944EN/02 (format, G53,
//! G92.1), A-79348E (tool centre point control), A-79294E (P0, P1), and from the M700V/M70V programming manual.

use super::Change::{All, Cut, First, Job, Last, Machine, Move, Text, Word};
use super::How::{Address, Double, Number};
use super::Kind;
use super::Verdict::{Found, Harmless, Refused};
use super::operations;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;

pub fn kinds() -> Vec<Kind> {
    let mut all = Vec::new();
    all.extend(tape());
    all.extend(head());
    all.extend(change());
    all.extend(length());
    all.extend(perimeter());
    all.extend(turns());
    all.extend(transformation());
    all.extend(smoothing());
    all.extend(path());
    all.extend(moves());
    all.extend(numbers());
    all.extend(spelling());
    all.extend(end());
    // Without its head the text has neither mark nor number.
    all.extend(operations::kinds(parts).into_iter().filter(|kind| kind.1.shown() != "no head"));
    all.extend(wrong());
    all
}

/// What differs on Mitsubishi.
pub fn mitsubishi() -> Vec<Kind> {
    const C: &str = "mitsubishi";
    vec![
        (C, First("O1001", "O12345678"), Harmless, "eight digits of a program number"),
        (C, First("O1001", "O123456789"), Refused, "nine digits"),
        (C, First("O1001 (small)", "<SMALL>"), Refused, "programs have numbers"),
        (C, First("G49\nG21", "N123456 G49\nG21"), Harmless, "six digits of a block number"),
        (C, First("G49\nG21", "N1234567 G49\nG21"), Refused, "seven digits"),
        (C, First("G05.1 Q1\n", "G05 P10000\n"), Harmless, "the other mode"),
        (C, First("G05.1 Q1\n", "G05.1 Q1 R5\n"), Refused, "there are no levels"),
        (C, First("G05.1 Q1\n", ""), Refused, "no smoothing of which the deviation is set"),
        (C, First("G43.4 H1\n", "G43.4 H1 P0\n"), Refused, "a parameter chooses the interpolation, no word"),
        (C, First("G43.4 H1\n", "G43.5 H1\n"), Refused, "vectors are due in the blocks"),
        (C, First("G43.4 H1\n", "G43.4 H1 C0.\n"), Refused, "an axis word beside it"),
        (C, First("Z650.0000", "Z650"), Refused, "#1078 decides on the unit"),
        (C, First("\nG53 G0 A0.0000", "\nG53 G0 A5."), Refused, "the frame would be that of a tilted table"),
    ]
}

fn tape() -> Vec<Kind> {
    const C: &str = "tape";
    vec![
        (C, First("%\n", ""), Refused, "the control reads from the first mark on"),
        (C, Text("no last mark", |t| t.trim_end().trim_end_matches('%').to_owned()), Refused, "the text has no end"),
        (C, Text("two first marks", |t| format!("%\n{t}")), Refused, "the second one ends the text"),
        (C, Text("a mark in the path", |t| t.replacen("\nG1 X", "\n%\nG1 X", 1)), Refused, "it ends the text"),
        (C, Text("blank lines before", |t| format!("\n\n{t}")), Harmless, "they mean nothing"),
        (C, Text("text before", |t| format!("vane\n{t}")), Refused, "the first line is no mark"),
        (C, Text("text behind", |t| format!("{t}G0 X0.\n")), Refused, "behind the end"),
        (C, Text("blank lines behind", |t| format!("{t}\n\n")), Harmless, "they mean nothing"),
        (C, First("O1001 (small)", "O1001"), Harmless, "the name is a comment"),
        (C, First("O1001 (small)", "o1001"), Refused, "a small letter"),
        (C, First("O1001 (small)", "O0"), Refused, "0 is no number of a program"),
        (C, First("O1001 (small)", "O10010"), Refused, "five digits"),
        (C, First("O1001 (small)", "O"), Refused, "a number is missing"),
        (C, First("O1001 (small)", "<SMALL-1.NC>"), Harmless, "a name in the place of the number"),
        (C, First("O1001 (small)", "<SMALL 1>"), Harmless, "blanks mean nothing"),
        (C, First("O1001 (small)", "<>"), Refused, "no name"),
        (C, First("O1001 (small)", "<SMALL*>"), Refused, "no character of a name"),
        (C, First("O1001 (small)", "N1001"), Refused, "the number of a block becomes that of the program"),
        (C, First("O1001 (small)\n", ""), Refused, "no number"),
        (C, First("%\nO1001 (small)\n", ""), Refused, "neither mark nor number"),
        (C, First("O1001 (small)\n", "O1001\nO1002\n"), Refused, "another program begins"),
    ]
}

fn head() -> Vec<Kind> {
    const C: &str = "head";
    const PRESET: &str = "G92.1 X0. Y0. Z0. A0.0000 C0.0000\n";
    vec![
        (C, First("G21 ", ""), Refused, "inches can be left over"),
        (C, First("G21 ", "G20 "), Refused, "inches"),
        (C, First("G21 ", "G21 G21 "), Refused, "two words of one group"),
        (C, First("G21 ", "G21 G20 "), Refused, "two words of one group: the last one counts"),
        (C, First("G21 ", "G021 "), Harmless, "leading zeros"),
        (C, First("G21 ", "G21. "), Refused, "no such word"),
        (C, First("G17 ", ""), Refused, "the length can act on another axis"),
        (C, First("G17 ", "G18 "), Refused, "the length acts on Y"),
        (C, First("G17 ", "G19 "), Refused, "the length acts on X"),
        (C, First("G90 ", ""), Refused, "G91 can be left over"),
        (C, First("G90 ", "G91 "), Refused, "words would be distances"),
        (C, First("G90 ", "G90 G91 "), Refused, "two words of one group"),
        (C, First("G94 ", ""), Refused, "another feed type can be left over"),
        (C, First("G94 ", "G93 "), Refused, "no manual says what F means under G43.4 then"),
        (C, First("G94 ", "G95 "), Refused, "feed a revolution"),
        (C, First("G40 ", ""), Refused, "compensation can be left over"),
        (C, First("G40 ", "G41 "), Refused, "compensation"),
        (C, First("G40 ", "G42 "), Refused, "compensation"),
        (C, First("G80 ", ""), Harmless, "G0 ends a cycle as well"),
        (C, First("G80 ", "G81 "), Refused, "a cycle"),
        (C, First("G80 ", "G80 G15 G50 G67 "), Harmless, "cancels what no move has"),
        (C, First("G80 ", "G16 "), Refused, "polar coordinates"),
        (C, First("G80 ", "G51 X0. Y0. Z0. P2000 "), Refused, "scales the frame"),
        (C, First("G80 ", "G97 "), Harmless, "rpm"),
        (C, First("G80 ", "G96 "), Refused, "constant cutting speed"),
        (C, First("G69 ", ""), Refused, "a rotation can be left over"),
        (C, First("G69 ", "G68 X0. Y0. R10. "), Refused, "turns the frame"),
        (C, First("G69 ", "G68.2 X0. Y0. Z0. I0. J30. K0. "), Refused, "tilts the frame"),
        (C, First("G64 ", ""), Refused, "exact stops or G63 can be left over"),
        (C, First("G64 ", "G61 "), Refused, "an exact stop in every block"),
        (C, First("G64 ", "G63 "), Refused, "no feed hold"),
        (C, First(" G54", ""), Refused, "another offset can be left over"),
        (C, First(" G54", " G55"), Refused, "another offset"),
        (C, First(" G54", " G59"), Refused, "another offset"),
        (C, First(" G54", " G54.1 P1"), Refused, "another offset"),
        (C, First(" G54", " G54 G55"), Refused, "two words of one group"),
        (C, First(PRESET, ""), Refused, "a shift of G92 or by hand can be left over"),
        (C, First(PRESET, "G92.1 X0 Y0 Z0 A0 C0\n"), Harmless, "0 is 0 in every unit"),
        (C, First(PRESET, "G92.1 X5. Y0. Z0. A0. C0.\n"), Refused, "only 0 is understood"),
        (C, First(PRESET, "G92.1 X0. Y0. Z0.\n"), Refused, "a shift of a rotary axis can be left over"),
        (C, First(PRESET, "G54 G92.1 X0. Y0. Z0. A0. C0.\n"), Refused, "which acts first is not stated"),
        (C, First(PRESET, "G92 X0. Y0. Z0.\n"), Refused, "shifts the frame"),
        (C, First(PRESET, "G52 X0. Y0. Z0.\n"), Refused, "leaves a shift of G92"),
        (C, First(PRESET, "G92.1 X0. Y0. Z0. A0. C0.\nG92.1 X0. Y0. Z0. A0. C0.\n"), Harmless, "said twice"),
        (C, First("G53 G0 Z650.0000\n", "G50.1 X0. Y0. Z0.\nG53 G0 Z650.\n"), Harmless, "no mirror"),
        (C, First("G53 G0 Z650.0000\n", "G51.1 X0.\nG53 G0 Z650.\n"), Refused, "mirrors the frame"),
        (C, First("G53 G0 Z650.0000\n", "G10 L2 P1 X1.\nG53 G0 Z650.\n"), Refused, "changes the offset"),
        (C, First("G49\nG21", "G21"), Refused, "G43.4 can be on since an aborted run"),
        (C, First("G49\nG21", "G49\nG49\nG21"), Harmless, "said twice"),
        (C, First("G49\nG21", "G49 G21"), Harmless, "in one block"),
        (C, First("G49\nG21", "G43.4 H1\nG21"), Refused, "switched on where the axes are unknown"),
        (C, First("G49\nG21", "G43 H1\nG21"), Refused, "the length of an unknown tool"),
        (C, First("G49\nG21", "G92.1 X0. Y0. Z0. A0. C0.\nG49\nG21"), Refused, "G43.4 can be on"),
        (C, First("G49\nG21", "G05.1 Q1\nG49\nG21"), Refused, "G43.4 can be on"),
        (C, First("G49\nG21", "G53 G0 Z650.\nG49\nG21"), Refused, "G43.4 can be on"),
        (C, First("G49\nG21", "T1 M6\nG49\nG21"), Refused, "a change at an unknown height"),
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
        (C, First("T1 M6", "T1 M6 M6"), Refused, "two M words"),
        (C, First("T1 M6", "T1\nM6"), Harmless, "in two blocks"),
        (C, First("T1 M6", "M6 T1"), Harmless, "the order of words means nothing"),
        (C, First("T1 M6", "T01 M06"), Harmless, "leading zeros"),
        (C, First("T1 M6", "T1. M6"), Refused, "no point in T"),
        (C, First("T1 M6", "T-1 M6"), Refused, "a negative number"),
        (C, First("T1 M6", "T M6"), Refused, "a number is missing"),
        (C, First("T1 M6", "T1 M61"), Refused, "a word of the machine builder"),
        (C, First("T1 M6", "T1 M6\nT2 M6"), Refused, "the length of the tool before"),
        (C, First("T1 M6", "T2 M6\nT1 M6"), Harmless, "the last change counts"),
        (C, First("T1 M6", "T1 M6\nT2"), Harmless, "the next tool is made ready, no more"),
        (C, First("T1 M6", "T1 M6\nD1"), Harmless, "a number for G41, which no move has"),
        (C, Last("T2 M6", "T1 M6"), Refused, "another tool"),
        (C, First("S12000 M3", "M3"), Refused, "the speed is left over"),
        (C, First("S12000 M3", "S0 M3"), Refused, "standstill"),
        (C, First("S12000 M3", "S12000. M3"), Refused, "no point in S"),
        (C, First("S12000 M3", "S-12000 M3"), Refused, "a negative speed"),
        (C, First("S12000 M3", "S6000 M3"), Refused, "another speed than that of the job"),
        (C, First("S12000 M3", "S12000"), Refused, "the spindle stands since M6"),
        (C, First("S12000 M3", "S12000 M4"), Refused, "the wrong way round"),
        (C, First("S12000 M3", "S12000 M5"), Refused, "standstill"),
        (C, First("S12000 M3", "S12000 M3 M8"), Refused, "how many M words count is a parameter"),
        (C, First("S12000 M3\n", ""), Refused, "the spindle stands since M6"),
        (C, First("S12000 M3", "M03 S12000"), Harmless, "the order of words means nothing"),
        (C, First("T1 M6\nS12000 M3", "S12000 M3\nT1 M6"), Refused, "M6 stops the spindle"),
        (C, First("M8\n", ""), Refused, "no coolant"),
        (C, First("M8\n", "M9\n"), Refused, "no coolant"),
        (C, First("M8\n", "M7\n"), Harmless, "mist"),
        (C, First("M8\n", "M08\n"), Harmless, "leading zeros"),
        (C, First("M8\n", "M8\nM8\n"), Harmless, "said twice"),
        (C, First("M8\n", "M8\nG04 P1000\n"), Harmless, "waits before the cut"),
        (C, First("M8\n", "M8\nG04\n"), Refused, "how long is left over"),
        (C, First("M8\n", "M8\nM0\n"), Harmless, "stops with the tool retracted"),
        (C, First("M8\n", "M8\nM01\n"), Harmless, "stops with the tool retracted"),
        (C, First("M8\n", "M8\nM19\n"), Refused, "a word of the machine builder"),
        (C, First("M8\n", "M8\nM98 P2000\n"), Refused, "another program"),
        (C, First("M8\n", "M8\nG65 P9810 X1.\n"), Refused, "another program"),
    ]
}

fn length() -> Vec<Kind> {
    const C: &str = "tool length";
    vec![
        (C, First("G43.4 H1", "G43.4 H2"), Refused, "the length of another tool"),
        (C, First("G43.4 H1", "G43.4"), Refused, "the number of an earlier block"),
        (C, First("G43.4 H1", "G43.4 H0"), Refused, "no length"),
        (C, First("G43.4 H1", "G43.4 H1."), Refused, "no point in H"),
        (C, First("G43.4 H1", "H1"), Refused, "H of nothing"),
        (C, First("G43.4 H1", "G43.4 H1 H1"), Refused, "a word twice"),
        (C, First("G43.4 H1", "H01 G43.4"), Harmless, "the order of words means nothing"),
        (C, First("G43.4 H1", "G43 H1"), Refused, "X Y Z would not follow the table"),
        (C, First("G43.4 H1", "G44 H1"), Refused, "the length to the other side"),
        (C, First("G43.4 H1", "G43.1 H1"), Refused, "along the tool, but without the table"),
        (C, First("G43.4 H1", "G43.4 H1 P0"), Harmless, "rotary axes run linearly"),
        (C, First("G43.4 H1", "G43.4 H1 P1"), Refused, "the axis stays in a plane: another motion"),
        (C, First("G43.4 H1", "G43.4 H1 P2"), Refused, "no such value"),
        (C, First("G43.4 H1", "G43.4 H1 L1"), Refused, "another function"),
        (C, First("G43.4 H1", "G43.4 H1 Q5"), Refused, "an inclination"),
        (C, First("G43.4 H1", "G43.4 H1 M8"), Refused, "an M word beside it"),
        (C, First("G43.4 H1", "G43.4 H1 G54"), Refused, "which acts first is not stated"),
        (C, First("G43.4 H1", "G43.4 X0. Y0. Z500. H1"), Refused, "this move has the length only"),
        (C, First("G43.4 H1", "G43.5 H1 I0. J0. K1."), Refused, "alarm PS5421"),
        (C, First("G43.4 H1", "G43.5 H1 P0"), Refused, "rotary words under type 2"),
        (C, First("G43.4 H1", "G43.5 H1"), Refused, "19604#0 decides how a block turns the tool"),
        (C, First("G43.4 H1", "G43.4 G43.5 H1"), Refused, "two words of one group"),
        (C, First("G43.4 H1\n", "G43.4 H1\nG43.4 H1\n"), Refused, "G49 is due between"),
        (C, First("G43.4 H1\n", "G43.4 H1\nG43.4 H2\n"), Refused, "the axes jump"),
        (C, First("G43.4 H1\n", "G43.4 H1\nG49\n"), Refused, "taken back"),
        (C, First("G43.4 H1\n", "G49\nG43.4 H1\n"), Harmless, "off as before"),
        (C, Last("G43.4 H2", "G43.4 H1"), Refused, "the length of the tool before"),
        (C, Last("G43.4 H2\n", ""), Refused, "no length"),
        (C, Move("G43.4 H1", "T1 M6"), Refused, "switched on where X and Y are unknown"),
    ]
}

fn perimeter() -> Vec<Kind> {
    const C: &str = "perimeter";
    vec![
        (C, First("G53 G0 Z650.0000\n", ""), Refused, "tool change at an unknown height"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z0."), Refused, "lower than where tools are changed"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z649."), Refused, "lower than where tools are changed"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z651."), Refused, "beyond the travel"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z-650."), Refused, "beyond the travel"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z650"), Refused, "0.65 mm, or 650 mm"),
        (C, First("G53 G0 Z650.0000", "G0 Z650."), Refused, "in the work frame: another height"),
        (C, First("G53 G0 Z650.0000", "G53 Z650."), Refused, "G0 or G1 is left over"),
        (C, First("G53 G0 Z650.0000", "G53 G1 Z650. F500."), Refused, "at feed from an unknown place"),
        (C, First("G53 G0 Z650.0000", "G53 G0 X0. Z650."), Refused, "sideways on the way up"),
        (C, First("G53 G0 Z650.0000", "G53 G0 A0. Z650."), Refused, "the table turns on the way up"),
        (C, First("G53 G0 Z650.0000", "G53 G0 X0.\nG53 G0 Z650."), Refused, "sideways at an unknown height"),
        (C, First("G53 G0 Z650.0000", "G53 G0 C0.\nG53 G0 Z650."), Refused, "the table turns at an unknown height"),
        (C, First("G53 G0 Z650.0000", "G28 Z650."), Refused, "a place set at the control"),
        (C, First("G53 G0 Z650.0000", "G91 G28 Z0."), Refused, "a place set at the control"),
        (C, First("G53 G0 Z650.0000", "G30 Z650."), Refused, "a place set at the control"),
        (C, First("G53 G0 Z650.0000", "G91 G53 G0 Z650.\nG90"), Refused, "G53 needs G90"),
        (C, First("G53 G0 Z650.0000", "G0 G53 Z650."), Harmless, "the order of words means nothing"),
        (C, First("G53 G0 Z650.0000", "G53 G00 Z+650."), Harmless, "another spelling"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z650. M9"), Harmless, "coolant beside a rapid"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z650. M5"), Refused, "before or after the move, as the builder chose"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z650.\nG53 G0 Z650."), Harmless, "said twice"),
        (C, First("G53 G0 Z650.0000", "G53 G0 Z 6 5 0 ."), Harmless, "blanks mean nothing"),
        (C, First("G53 G0 Z650.0000", "G53 G53 G0 Z650."), Refused, "a word twice"),
        (C, First("G53 G0 Z650.0000", "G53 G0"), Refused, "no axis word"),
        (C, First("\nG53 G0 A", "\nG53 G0 Z650.\nG53 G0 A"), Harmless, "where it stands already"),
        (C, First("\nG53 G0 A", "\nG53 G0 Z600.\nG53 G0 A"), Refused, "sideways lower than proved"),
        (C, First("\nG53 G0 A", "\nG53 G0 X0. Y0.\nG53 G0 A"), Harmless, "another way at the retract height"),
        (C, First("\nG53 G0 A", "\nG53 G0 X999.\nG53 G0 A"), Refused, "beyond the travel"),
        (C, First("\nG53 G0 A", "\nG0 A"), Harmless, "G54 has no offset of a rotary axis"),
        (C, First("\nG53 G0 A", "\nG1 F100. A"), Refused, "at feed"),
        (C, First("\nG53 G0 A", "\nG53 G0 B1. A"), Refused, "no such axis"),
        (C, First("\nG53 G0 X", "\nG0 X"), Refused, "in the work frame: another place"),
        (C, First("\nG53 G0 X", "\nG53 G0 Z650. X"), Refused, "Z with it"),
        (C, First("\nG53 G0 X", "\nG53 G1 F100. X"), Refused, "at feed"),
        (C, First("\nG53 G0 X", "\nG53 G0 X1. X"), Refused, "a word twice"),
        (C, Text("no A and C before G43.4", |t| without(t, "G53 G0 A")), Refused, "the frame of an unknown table"),
        (C, Text("no X and Y before G43.4", |t| without(t, "G53 G0 X")), Refused, "an unknown place on the way down"),
        (C, Text("X and Y before A and C", swap_stations), Harmless, "both at the retract height"),
        (C, First("G49\nG05.1 Q0\nG53 G0 Z650.0000\n", "G49\nG05.1 Q0\n"), Refused, "the spindle stops in the part"),
        (C, Last("G53 G0 Z650.0000\n", ""), Refused, "the program ends in the part"),
        (C, Last("G53 G0 Z650.0000", "G53 G0 Z0."), Refused, "lower than proved"),
        (C, Last("G53 G0 Z650.0000", "G0 Z650."), Refused, "in the work frame"),
        (C, Last("G53 G0 Z650.0000", "G53 G0 X0. Y0."), Refused, "sideways out of the part"),
        (C, Last("G53 G0 Z650.0000", "G53 G0 Z650.\nG53 G0 X0. Y0. A0. C0."), Harmless, "parks behind the retract"),
        (C, Last("G53 G0 Z650.0000", "G53 G0 Z650.\nG53 G0 Z0."), Refused, "down again"),
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

fn turns() -> Vec<Kind> {
    const C: &str = "turn of the tables";
    vec![
        (C, First("\nG53 G0 A0.0000", "\nG53 G0 A5."), Refused, "the frame would be that of a tilted table"),
        (C, First("G0 A0.0000 C0.0000", "G0 A0. C5."), Refused, "the frame would be that of a turned table"),
        (C, First("G0 A0.0000 C0.0000", "G0 A0 C0"), Harmless, "0 is 0 in every unit"),
        (C, Text("no turns", |t| turns_without(t, |_, _| true)), Refused, "the table turns on the way down"),
        (C, Text("the third turn is missing", |t| turns_without(t, |k, _| k == 2)), Refused, "axes leave their places"),
        (C, Text("no last turn", |t| turns_without(t, |k, n| k + 1 == n)), Refused, "the table turns on the way down"),
        (C, Text("a turn twice", |t| third_turn(t, |l| format!("{l}\n{l}"))), Harmless, "nothing moves"),
        (C, Text("a turn at feed", |t| third_turn(t, |l| l.replace("G0", "G1 F100."))), Refused, "at feed"),
        (C, Text("a turn lower", |t| third_turn(t, |l| l.replace(" Z", " Z-"))), Refused, "Z goes down"),
        (C, Text("a turn beside", |t| third_turn(t, |l| l.replace(" X", " X1"))), Refused, "X moves"),
        (C, Text("turns modally", |t| third_turn(t, |l| l.replace("G0 ", ""))), Harmless, "G0 is modal"),
        (C, Text("all turns lower", turns_lower), Refused, "Z goes down before the tables turn"),
    ]
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

fn transformation() -> Vec<Kind> {
    const C: &str = "transformation";
    vec![
        (C, First("G43.4 H1\n", "G43.4 H1\nG69\n"), Refused, "no manual has it under tool centre point control"),
        (C, First("G43.4 H1\n", ""), Refused, "words of the part are those of the machine then"),
        (C, First("G43.4 H1\n", "G43.4 H1\nG53 G0 Z650.\n"), Refused, "machine frame under G43.4"),
        (C, First("G43.4 H1\n", "G43.4 H1\nG0 Z10.\n"), Refused, "X and Y are no longer what they were"),
        (C, First("G43.4 H1\n", "G43.4 H1\nT1 M6\n"), Refused, "a change under G43.4"),
        (C, First("G43.4 H1\n", "G43.4 H1\nG92 X0.\n"), Refused, "shifts the frame"),
        (C, First("G43.4 H1\n", "G43.4 H1\nG92.1 X0. Y0. Z0. A0. C0.\n"), Refused, "not stated under G43.4"),
        (C, First("G43.4 H1\n", "G43.4 H1\nG55\n"), Refused, "another offset"),
        (C, First("G43.4 H1\n", "G43.4 H1\nG54\n"), Harmless, "the same offset"),
        (C, First("G43.4 H1\n", "G43.4 H1\nM0\n"), Refused, "waits on the way down"),
        (C, First("G43.4 H1\n", "G43.4 H1\nG68 X0. Y0. R5.\n"), Refused, "turns the frame"),
        (C, First("G43.4 H1\n", "G43.4 H1\nG53.1\n"), Refused, "turns the axes"),
        (C, First("G49\nG05.1 Q0\n", "G05.1 Q0\n"), Refused, "machine frame under G43.4"),
        (C, First("G49\nG05.1 Q0\n", "G49 G05.1 Q0\n"), Refused, "G05.1 has a block of its own"),
        (C, First("G49\nG05.1 Q0\n", "G49\n"), Harmless, "smoothing goes on; no move needs its end"),
        (C, First("G49\nG05.1 Q0\n", "G05.1 Q0\nG49\n"), Refused, "G05.1 with the length active"),
        (
            C,
            First("G49\nG05.1 Q0\nG53 G0 Z650.0000\n", "G49 G53 G0 Z650.\nG05.1 Q0\n"),
            Refused,
            "which acts first is not stated",
        ),
        (C, First("G49\nG05.1 Q0\n", "G49 H0\nG05.1 Q0\n"), Refused, "H beside G49"),
        (C, Cut("\nG1 X", "\nG49\nG1 X"), Refused, "words of the part are those of the machine then"),
        (C, Cut("\nG1 X", "\nG49\nG43.4 H1\nG1 X"), Refused, "switched on in the part"),
    ]
}

fn smoothing() -> Vec<Kind> {
    const C: &str = "smoothing";
    vec![
        (C, First("G05.1 Q1\n", ""), Refused, "corners are rounded as far as accelerations ask for"),
        (C, First("G05.1 Q1\n", "G05.1 Q0\n"), Refused, "the same"),
        (C, First("G05.1 Q1\n", "G5.1 Q1\n"), Harmless, "without the zero"),
        (C, First("G05.1 Q1\n", "G05.1 Q1 R5\n"), Harmless, "a level, whose tolerance is a setting as well"),
        (C, First("G05.1 Q1\n", "G05.1 Q1 R11\n"), Refused, "no such level"),
        (C, First("G05.1 Q1\n", "G05.1 Q1 R0\n"), Refused, "no such level"),
        (C, First("G05.1 Q1\n", "G05.1 Q1 R5.\n"), Refused, "no whole number"),
        (C, First("G05.1 Q1\n", "G05.1 Q1 X0. Y0. Z0.\n"), Refused, "another function"),
        (C, First("G05.1 Q1\n", "G05.1 Q2 X0. Y0. Z0.\n"), Refused, "another function"),
        (C, First("G05.1 Q1\n", "G05.1 Q3 X0. Y0. Z0.\n"), Refused, "another function"),
        (C, First("G05.1 Q1\n", "G05.1\n"), Refused, "Q is missing"),
        (C, First("G05.1 Q1\n", "G05.1 Q1 M8\n"), Refused, "it has a block of its own"),
        (C, First("G05.1 Q1\n", "G05 P10000\n"), Harmless, "the mode of other series"),
        (C, First("G05.1 Q1\n", "G05 P2\n"), Refused, "another function"),
        (C, First("G05.1 Q1\n", "G08 P1\n"), Refused, "is not read"),
        (C, Move("G05.1 Q1", "G43.4"), Refused, "with the length active"),
        (C, Move("G05.1 Q1", "T1 M6"), Harmless, "before G43.4 as well"),
    ]
}

fn path() -> Vec<Kind> {
    const C: &str = "modal in the path";
    vec![
        (C, Cut("\nG1 X", "\nG20\nG1 X"), Refused, "inches"),
        (C, Cut("\nG1 X", "\nG91\nG1 X"), Refused, "distances"),
        (C, Cut("\nG1 X", "\nG18\nG1 X"), Refused, "another plane"),
        (C, Cut("\nG1 X", "\nG41 D1\nG1 X"), Refused, "compensation"),
        (C, Cut("\nG1 X", "\nG93\nG1 X"), Refused, "F is one over minutes"),
        (C, Cut("\nG1 X", "\nG95\nG1 X"), Refused, "feed a revolution"),
        (C, Cut("\nG1 X", "\nG94\nG1 X"), Harmless, "as before"),
        (C, Cut("\nG1 X", "\nG64\nG1 X"), Harmless, "as before"),
        (C, Cut("\nG1 X", "\nG61\nG1 X"), Refused, "exact stops"),
        (C, Cut("\nG1 X", "\nG52 X1.\nG1 X"), Refused, "shifts the frame"),
        (C, Cut("\nG1 X", "\nG55\nG1 X"), Refused, "another offset"),
        (C, Cut("\nG1 X", "\nG43.4 H2\nG1 X"), Refused, "another length"),
        (C, Cut("\nG1 X", "\nG43.5 H1 P0\nG1 X"), Refused, "vectors are due"),
        (C, Cut("\nG1 X", "\nM5\nG1 X"), Refused, "the spindle stands"),
        (C, First("\nG49\nG05.1 Q0", "\nS1\nG49\nG05.1 Q0"), Refused, "it nearly stands in the part"),
        (C, Cut("\nG1 X", "\nM4\nG1 X"), Refused, "the wrong way round"),
        (C, Cut("\nG1 X", "\nM3\nG1 X"), Harmless, "as before"),
        (C, Cut("\nG1 X", "\nM9\nG1 X"), Refused, "no coolant"),
        (C, Cut("\nG1 X", "\nM8\nG1 X"), Harmless, "as before"),
        (C, Cut("\nG1 X", "\nM0\nG1 X"), Refused, "waits in the part"),
        (C, Cut("\nG1 X", "\nG04 P100\nG1 X"), Refused, "waits in the part"),
        (C, Cut("\nG1 X", "\nS9000\nG1 X"), Refused, "another speed"),
        (C, Cut("\nG1 X", "\nS12000\nG1 X"), Harmless, "as before"),
        (C, Cut("\nG1 X", "\nT2\nG1 X"), Harmless, "the next tool is made ready"),
        (C, Cut("\nG1 X", "\nT2 M6\nG1 X"), Refused, "a change in the part"),
        (C, Cut("\nG1 X", "\nM98 P2\nG1 X"), Refused, "another program"),
        (C, Cut("\nG1 X", "\nG05.1 Q0\nG1 X"), Refused, "with the length active"),
        (C, Cut("\nG1 X", "\n(a comment)\nG1 X"), Harmless, "a comment"),
        (C, Cut("\nG1 X", "\nG0\nG1 X"), Harmless, "no axis word: nothing moves"),
    ]
}

fn moves() -> Vec<Kind> {
    const C: &str = "moves";
    vec![
        (C, Cut("\nG1 X", "\nX"), Harmless, "G1 is modal"),
        (C, Cut("\nG1 X", "\nG01 X"), Harmless, "leading zeros"),
        (C, Cut("\nG1 X", "\nG1 G1 X"), Refused, "a word twice"),
        (C, Cut("\nG1 X", "\nG0 G1 X"), Refused, "two words of one group"),
        (C, Cut("\nG1 X", "\nG2 X"), Refused, "an arc"),
        (C, Cut("\nG1 X", "\nG03 X"), Refused, "an arc"),
        (C, Cut("\nG1 X", "\nG02.4 X"), Refused, "an arc"),
        (C, Cut("\nG1 X", "\nG06.2 P4 K0. X"), Refused, "a spline"),
        (C, Cut("\nG1 X", "\nG33 X"), Refused, "follows the spindle"),
        (C, Cut("\nG1 X", "\nG53 G1 X"), Refused, "machine frame under G43.4"),
        (C, Cut("\nG1 X", "\nG1 M8 X"), Refused, "before or after the move, as the builder chose"),
        (C, Cut("\nG1 X", "\nG1 M3 X"), Refused, "before or after the move, as the builder chose"),
        (C, Cut("\nG1 X", "\n/G1 X"), Refused, "depends on a switch"),
        (C, Cut("\nG1 X", "\n/2 G1 X"), Refused, "depends on a switch"),
        (C, Cut("\nG1 X", "\nIF[#1EQ1]GOTO9\nG1 X"), Refused, "flow of the program"),
        (C, Cut("\nG1 X", "\nGOTO9\nG1 X"), Refused, "flow of the program"),
        (C, Cut("\nG1 X", "\nWHILE[#1LT9]DO1\nG1 X"), Refused, "flow of the program"),
        (C, Cut("\nG1 X", "\n#100=5.\nG1 X"), Refused, "a variable"),
        (C, Cut("\nG1 X", "\nG1 N10 X"), Refused, "a block number inside of a block"),
        (C, Cut("\nG1 X", "\nN10 G1 X"), Harmless, "a block number"),
        (C, Word("X", Double), Refused, "a word twice"),
        (C, Word("Y", Double), Refused, "a word twice"),
        (C, Word("Z", Double), Refused, "a word twice"),
        (C, Word("A", Double), Refused, "a word twice"),
        (C, Word("C", Double), Refused, "a word twice"),
        (C, Word("A", Address("B")), Refused, "no such axis"),
        (C, Word("A", Address("I")), Refused, "a vector under type 1"),
        (C, Word("C", Address("A")), Refused, "a word twice"),
        (C, Word("X", Address("Y")), Refused, "a word twice"),
        (C, Word("X", Address("U")), Refused, "no such axis"),
        (C, Word("X", Address("x")), Refused, "a small letter"),
        (C, Word("A", Number("200.")), Refused, "beyond the travel"),
        (C, Word("Z", Number("-60.")), Found, "through part and table"),
        (C, Word("Z", Number("900.")), Found, "beyond the travel"),
    ]
}

fn numbers() -> Vec<Kind> {
    const C: &str = "numbers";
    vec![
        (C, Word("X", Number("5")), Refused, "3401#0: 5 mm or 5 steps"),
        (C, Word("Y", Number("-5")), Refused, "3401#0: 5 mm or 5 steps"),
        (C, Word("A", Number("5")), Refused, "3401#0: 5 deg or 5 steps"),
        (C, Word("X", Number("")), Refused, "a number is missing"),
        (C, Word("X", Number("-")), Refused, "no number"),
        (C, Word("X", Number("--1.")), Refused, "no number"),
        (C, Word("X", Number(".")), Refused, "no number"),
        (C, Word("X", Number("1E2")), Refused, "no exponents"),
        (C, Word("X", Number("1,5")), Refused, "no comma"),
        (C, Word("X", Number("1.2.3")), Refused, "two points"),
        (C, Word("X", Number("#1")), Refused, "a variable"),
        (C, Word("X", Number("[1.+2.]")), Refused, "an expression"),
        (C, Word("X", Number("999999.")), Refused, "beyond any machine"),
        (C, Word("X", Number("1.23456")), Refused, "the control drops the fifth decimal"),
        (C, Word("A", Number("1.23456")), Refused, "the control drops the fifth decimal"),
        (C, First("F150.000", "F0."), Refused, "no feed"),
        (C, First("F150.000", "F-150."), Refused, "a negative feed"),
        (C, First("F150.000", "F15000."), Refused, "above the feeds of the job"),
        (C, First("F150.000", "F"), Refused, "a number is missing"),
        (C, First("F150.000", "F150"), Refused, "the unit is a setting"),
        (C, First("F150.000", "F150."), Harmless, "digits behind the point may be left out"),
        (C, First("F150.000", "F+150.0"), Harmless, "a sign"),
        (C, First("F150.000", "F150.0001"), Refused, "more decimals than F has"),
        (C, First("F150.000", "F150. F150."), Refused, "a word twice"),
        (C, First("F150.000", "E150."), Refused, "is not read"),
    ]
}

fn spelling() -> Vec<Kind> {
    const C: &str = "alphabet";
    vec![
        (C, Text("lower case", |t| t.to_lowercase()), Refused, "the control reads capital letters"),
        (C, Text("CRLF", |t| t.replace('\n', "\r\n")), Harmless, "the end of a line"),
        (C, Text("lone CR", |t| t.replacen(" G90", "\rG90", 1)), Refused, "a control character"),
        (C, Text("tabs", |t| t.replace(' ', "\t")), Harmless, "tabs are blanks"),
        (C, Text("wide", |t| t.replace(' ', "   ")), Harmless, "blanks mean nothing"),
        (C, Text("glued", |t| t.replace(' ', "")), Harmless, "blanks mean nothing"),
        (C, Text("blank lines", |t| t.replace('\n', "\n\n")), Harmless, "blank lines mean nothing"),
        (C, Text("no last line feed", |t| t.trim_end().to_owned()), Harmless, "`%` ends the text"),
        (C, Text("byte order mark", |t| format!("\u{feff}{t}")), Refused, "the first line is no mark"),
        (C, Text("no-break blank", |t| t.replacen(" G90", "\u{a0}G90", 1)), Refused, "no blank of the control"),
        (C, Text("zero byte", |t| t.replacen(" G90", "\0G90", 1)), Refused, "a control character"),
        (C, Cut("G1 X", "G1 \u{425}"), Refused, "a Cyrillic letter"),
        (C, Cut("G1 X", "G\u{661} X"), Refused, "an Arabic digit"),
        (C, Cut("G1 X", "G\u{ff11} X"), Refused, "a wide digit"),
        (C, Cut("Y-", "Y\u{2212}"), Refused, "a minus of typography"),
        (C, First("(groove: a restart point)", ""), Harmless, "no comment"),
        (C, First("(groove: a restart point)", "(groove) (1)"), Harmless, "two comments"),
        (C, First("(groove: a restart point)", "((groove))"), Refused, "a comment in a comment"),
        (C, First("(groove: a restart point)", "(groove"), Refused, "a comment without an end"),
        (C, First("(groove: a restart point)", "groove)"), Refused, "a comment without a beginning"),
        (C, First("(groove: a restart point)", "(50%)"), Refused, "the end of the text"),
        (C, First("(groove: a restart point)", "(a;b)"), Refused, "the end of the block"),
        (C, First("(groove: a restart point)", "; groove"), Refused, "a comment has brackets"),
        (C, First("(groove: a restart point)", "(\u{43f}\u{430}\u{437})"), Refused, "no character of the control"),
        (C, First("G49\nG21", "N5 G49\nG21"), Harmless, "a block number"),
        (C, First("G49\nG21", "N5\nG49\nG21"), Harmless, "a block number alone"),
        (C, First("G49\nG21", "N99999999 G49\nG21"), Harmless, "eight digits"),
        (C, First("G49\nG21", "N123456789 G49\nG21"), Refused, "nine digits"),
        (C, First("G49\nG21", "N0 G49\nG21"), Refused, "0 is no block number"),
        (C, First("G49\nG21", "N1.5 G49\nG21"), Refused, "no block number"),
        (C, First("G49\nG21", "G49 N5\nG21"), Refused, "a block number inside of a block"),
        (C, First("G49\nG21", "TRAFOOF\nG21"), Refused, "a word of another control"),
        (C, First("G49\nG21", "G49\nM428\nG21"), Refused, "a word of another control"),
        (C, First("G49\nG21", "G49\nG49.5\nG21"), Refused, "no such word"),
        (C, First("G49\nG21", "G\nG49\nG21"), Refused, "a number is missing"),
    ]
}

fn end() -> Vec<Kind> {
    const C: &str = "end";
    vec![
        (C, Last("M30\n", ""), Refused, "`%` alone is an alarm"),
        (C, Last("M30\n", "M2\n"), Harmless, "an end as well"),
        (C, Last("M30\n", "M02\n"), Harmless, "leading zeros"),
        (C, Last("M30\n", "M99\n"), Refused, "begins again"),
        (C, Last("M30\n", "M30\nM30\n"), Refused, "text behind the end"),
        (C, Last("M30\n", "M30\nG0 X0.\n"), Refused, "text behind the end"),
        (C, Last("M30\n", "M30\n(done)\n"), Harmless, "a comment"),
        (C, Last("M30\n", "M30 M2\n"), Refused, "two M words"),
        (C, Last("M5\n", ""), Refused, "whether M30 stops the spindle is up to the builder"),
        (C, First("M5\n", ""), Harmless, "the next change stops the spindle"),
        (C, Last("M9\n", ""), Refused, "whether M30 stops the coolant is up to the builder"),
        (C, First("M9\n", ""), Harmless, "coolant over the change"),
        (C, Last("G49\n", ""), Refused, "machine frame under G43.4"),
        (
            C,
            Text("all that switches off is missing", |t| {
                t.rfind("G49\n").map(|at| format!("{}M30\n%\n", &t[..at])).unwrap()
            }),
            Refused,
            "ends in a cut, all on",
        ),
        (C, Text("cut in the middle", |t| t[..t.len() / 2].to_owned()), Refused, "no end"),
        (C, Text("empty", |_| String::new()), Refused, "no program"),
    ]
}

/// The head and the operations.
fn parts(text: &str) -> Vec<String> {
    operations::parts(text, |lines, i| lines[i].ends_with("a restart point)"))
}

fn wrong() -> Vec<Kind> {
    const C: &str = "wrong job, machine";
    vec![
        (C, Machine("A opposite", |m| m.rotary[0].word_sign = -1.0), Refused, "the axes move while the tables turn"),
        (C, Machine("C opposite", |m| m.rotary[1].word_sign = -1.0), Refused, "the axes move while the tables turn"),
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
            Machine("X ends earlier", |m| (m.linear[0].min, m.linear[0].max) = (-1.0, 1.0)),
            Refused,
            "beyond the travel",
        ),
        (C, Machine("part higher", |m| m.part_origin.z += 3.0), Refused, "the axes move while the tables turn"),
        (C, Job("no operation", |p| p.operations = PrimaryMap::new()), Refused, "more operations than the job"),
        (
            C,
            Job("finer tolerance", |p| p.tolerances.chord = Mm(1e-4)),
            Harmless,
            "the tolerance is a setting of the control, as the head says",
        ),
        (C, All("S12000", "S12001"), Refused, "another speed"),
        (C, All("T1 M6", "T3 M6"), Refused, "another tool than that of the length"),
    ]
}
