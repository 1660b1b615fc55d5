//! Bad NC text: every fault is an error with its line; no panic, no endless loop, bounded memory.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod support;

use impellerc::diag::Sink;
use impellerc::kin::Machine;
use impellerc::post::{self, Direction, NcMove, Post, ReadError, motion_of::motion_of};
use impellerc::source::Span;
use proptest::prelude::*;
use std::process::Command;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

/// For the dialects as in `POSTS`.
static MACHINES: LazyLock<[Machine; 2]> =
    LazyLock::new(|| ["siemens-840d", "linuxcnc"].map(|d| support::machine_for(d, &support::machine())));

const SIEMENS: &str = "\
; %_N_TEST_MPF
N10 G17 G710 G90 G94 G40 G500
N20 SUPA G0 Z0 D0
N30 T=\"t2\" M6 ; flank
N40 D1 S8000 M3
N50 G54
N60 CYCLE832(0.0010,_ORI_FINISH,0.1)
N70 G0 A=30 C=20
N80 TRAORI
N90 G54 ORIWKS ORIAXES M8
N100 G0 X50 Y-40 Z10 A=30 C=20
N110 G1 X30 Y-17 Z4 A3=0.17101007 B3=-0.46984631 C3=0.86602540 F1000
N120 G1 X29 Y-18 Z3 A3=0.18101007 B3=-0.46984631 C3=0.86602540 F250
N130 G1 X28 Y-19 Z2 A3=0.19101007 B3=-0.46984631 C3=0.86602540
N140 TRAFOOF
N150 CYCLE832(0,_OFF,1)
N160 SUPA G0 Z0 D0 M9
N170 M5
N180 M30
";

const LINUXCNC: &str = "\
(test)
G21 G17 G90 G40 G49 G80 G94 G54 G64 P0.001 Q0
(flank)
M429
G53 G0 Z0
T2 M6
G43 H2
S8000 M3
M8
G0 A-30 C-20
M428
G0 X50 Y-40 Z10 A-30 C-20
G1 X30 Y-17 Z4 A-30 C-20 F1000
G1 X29 Y-18 Z3 A-31 C-21 F250
G1 X28 Y-19 Z2 A-32 C-22
M429
G53 G0 Z0
M9
M5
M2
";

fn read(dialect: &str, text: &str) -> Result<Vec<NcMove>, Vec<ReadError>> {
    let machine = &MACHINES[usize::from(dialect == "linuxcnc")];
    post::find(dialect).unwrap().read(text, machine)
}

fn original(dialect: &str) -> &'static str {
    if dialect == "siemens-840d" { SIEMENS } else { LINUXCNC }
}

/// Replaces one piece of the text and expects the first fault in the line of it (or one given) with these words.
fn refused(dialect: &str, from: &str, to: &str, words: &str) {
    let text = original(dialect);
    let at = text.find(from).unwrap_or_else(|| panic!("{from} is not in the text"));
    let line = text[..at].matches('\n').count() + 1;
    refused_at(dialect, from, to, line, words);
}

fn refused_at(dialect: &str, from: &str, to: &str, line: usize, words: &str) {
    let text = original(dialect).replacen(from, to, 1);
    let faults = read(dialect, &text).expect_err(to);
    assert_eq!(faults[0].line, line, "{dialect} {to}: {faults:?}");
    assert!(faults[0].reason.contains(words), "{dialect} {to}: {faults:?}");
}

#[test]
fn the_originals_are_read() {
    for (dialect, lines) in [("siemens-840d", 11..=14), ("linuxcnc", 12..=15)] {
        let moves = read(dialect, original(dialect)).unwrap();
        assert_eq!(moves.iter().map(|m| m.line).collect::<Vec<_>>(), lines.collect::<Vec<_>>());
        assert_eq!(moves.iter().map(|m| m.feed).collect::<Vec<_>>(), [None, Some(1000.0), Some(250.0), Some(250.0)]);
        assert!(moves[0].start.is_some() && moves[1..].iter().all(|m| m.start.is_none()));
    }
}

#[test]
fn numbers_that_are_none() {
    for (bad, words) in [
        ("NAN", "not"),
        ("nan", "not"),
        ("INF", "not"),
        ("1e5", "not"),
        ("1E5", "not"),
        ("", "a number is missing"),
        ("-", "not a number"),
        (".", "not a number"),
        ("1.2.3", "not a number"),
        ("1-2", "not a number"),
        ("--1", "not a number"),
        ("0x10", "not"),
        ("1,5", "not"),
        ("[1+1]", "not"),
        ("#1", "not"),
        ("=R1", "not"),
        ("1000000000000000000000000000000", "not a number"),
        ("100000.1", "out of range"),
        ("-99999999", "out of range"),
    ] {
        for dialect in ["siemens-840d", "linuxcnc"] {
            // What the other dialect's brackets and blanks make of it is a fault as well, with other words.
            let words = if dialect == "linuxcnc" && words == "not" { "" } else { words };
            refused(dialect, "X29", &format!("X{bad}"), words);
        }
    }
}

#[test]
fn values_beyond_all_measure() {
    refused("siemens-840d", "A=30", "A=99999", "out of range");
    refused("linuxcnc", "C-20", "C-99999", "out of range");
    for dialect in ["siemens-840d", "linuxcnc"] {
        refused(dialect, "F1000", "F0", "feed");
        refused(dialect, "F1000", "F-5", "feed");
        refused(dialect, "F1000", "F10000000", "out of range");
        refused(dialect, "S8000", "S-1", "speed");
    }
    refused("siemens-840d", "0.0010,_ORI_FINISH", "50,_ORI_FINISH", "CYCLE832");
    refused("linuxcnc", "P0.001", "P50", "G64");
}

#[test]
fn words_that_are_unknown_or_twice() {
    for dialect in ["siemens-840d", "linuxcnc"] {
        for unknown in ["G2 X29", "G91 X29", "M98 X29", "B5 X29", "/X29", "X29 §"] {
            refused(dialect, "X29", unknown, "");
        }
        refused(dialect, "X29", "X29 X29", "twice");
        refused(dialect, "F250", "F250 F250", "twice");
        refused(dialect, "G1 X29", "G0 G1 X29", "twice");
        refused(dialect, "X29", "\u{0}X29", "control character");
    }
    refused("siemens-840d", "X29", "x29", "not understood");
    refused("siemens-840d", "X29", "IF R1==1 GOTOF X29", "");
    refused("siemens-840d", "ORIAXES", "ORIVECT", "not understood");
    refused("siemens-840d", "_ORI_FINISH", "_ORI_SOMEHOW", "CYCLE832");
    refused("linuxcnc", "G64 P0.001 Q0", "G64", "G64");
    refused("linuxcnc", "G43 H2", "G43", "belong together");
    refused("linuxcnc", "G43 H2", "G43 H3", "another tool");
    refused("linuxcnc", "(flank)", "(flank", "comment");
    refused("linuxcnc", "(flank)", "(fl(ank)", "comment");
}

#[test]
fn mixed_modes_of_the_transformation() {
    refused_at("siemens-840d", "N80 TRAORI\n", "", 9, "ORIAXES before TRAORI");
    refused_at("siemens-840d", "N90 G54 ORIWKS ORIAXES M8\n", "", 11, "without ORIAXES");
    refused("siemens-840d", "N130 G1", "N125 TRAORI\nN130 G1", "twice");
    refused_at("siemens-840d", "N130 G1", "N125 TRAFOOF\nN130 G1", 15, "transformation off");
    refused_at("siemens-840d", "N130 G1", "N125 TRAFOOF\nN126 TRAORI\nN130 G1", 15, "Z0 of the machine");
    refused_at("siemens-840d", "N140 TRAFOOF\n", "", 16, "transformation on");
    refused_at("siemens-840d", "N70 G0 A=30 C=20\n", "", 8, "before A and C");
    refused_at("siemens-840d", "N20 SUPA G0 Z0 D0\n", "", 3, "Z0 of the machine");
    refused("siemens-840d", "SUPA G0 Z0 D0", "SUPA G0 Z-50 D0", "machine frame");
    refused("siemens-840d", "SUPA G0 Z0 D0", "SUPA G0 X0 Z0 D0", "machine frame");
    refused("siemens-840d", "SUPA G0 Z0 D0", "SUPA G1 Z0 D0", "machine frame");
    refused("siemens-840d", "N80 TRAORI", "N80 TRAORI X5", "switched in a move");
    refused_at("linuxcnc", "M428\n", "", 11, "transformation off");
    refused("linuxcnc", "G1 X28", "M428\nG1 X28", "twice");
    refused_at("linuxcnc", "G1 X28", "M429\nG1 X28", 16, "transformation off");
    refused_at("linuxcnc", "G1 X28", "M429\nM428\nG1 X28", 16, "Z0 of the machine");
    refused_at("linuxcnc", "M429\nG53 G0 Z0\nM9", "M9\nG53 G0 Z0\nM429", 17, "transformation on");
    refused_at("linuxcnc", "G0 A-30 C-20\n", "", 10, "before A and C");
}

#[test]
fn what_a_move_needs_is_said_before_it() {
    refused_at("siemens-840d", "G710 ", "", 11, "lengths in mm");
    refused_at("siemens-840d", "G90 ", "", 11, "absolute");
    refused_at("siemens-840d", "G94 ", "", 11, "feed a minute");
    refused_at("siemens-840d", " F1000", "", 12, "without a feed");
    refused_at("siemens-840d", "D1 ", "", 11, "length of the tool");
    refused_at("siemens-840d", " M3", "", 12, "spindle");
    refused_at("siemens-840d", "T=\"t2\" ", "", 4, "before any T");
    refused("siemens-840d", "X50 Y-40 Z10", "X50 Y-40", "needs X Y Z");
    refused("siemens-840d", "C3=0.86602540 F250", "F250", "direction");
    refused("siemens-840d", "A3=0.18101007 B3=-0.46984631 C3=0.86602540", "A3=0 B3=0 C3=0", "length 0");
    refused("siemens-840d", "A3=0.18101007 B3=-0.46984631 C3=0.86602540", "C=5", "only one of A and C");
    refused_at("linuxcnc", "G43 H2\n", "", 11, "length of the tool");
    refused_at("linuxcnc", "G54 ", "", 12, "G54");
    refused_at("linuxcnc", " F1000", "", 13, "without a feed");
    refused("linuxcnc", "X50 Y-40 Z10", "X50 Z10", "needs X Y Z");
}

/// Hand edits that a control would run, otherwise than it looks: each was read as if nothing had changed.
#[test]
fn edits_with_which_the_control_does_something_else() {
    let siemens = |from: &str, to: &str, line, words: &str| refused_at("siemens-840d", from, to, line, words);
    // Without a tolerance, or with smoothing off, the control takes its own; a wide one for the axis tilts the flutes.
    siemens("N60 CYCLE832(0.0010,_ORI_FINISH,0.1)\n", "", 11, "how far the control may leave the path");
    siemens("0.0010,_ORI_FINISH,0.1", "0,_OFF,1", 12, "how far the control may leave the path");
    siemens("_ORI_FINISH,0.1", "_ORI_FINISH,0.11", 7, "lean by 0.11 deg");
    siemens("_ORI_FINISH,0.1", "_ORI_ROUGH,5", 7, "lean by 5 deg");
    // Whose vectors, and what lies between them.
    siemens(" ORIWKS", "", 12, "without ORIWKS");
    siemens(" ORIAXES", "", 12, "without ORIAXES");
    let rotary =
        SIEMENS.replacen(" ORIAXES", "", 1).replacen("A3=0.17101007 B3=-0.46984631 C3=0.86602540", "A=31 C=20", 1);
    let faults = read("siemens-840d", &rotary).unwrap_err();
    assert!(faults[0].line == 12 && faults[0].reason.contains("without ORIAXES"), "{faults:?}");
    // Z0 of the machine with the length of a tool is another height; before the first tool there is none.
    siemens("SUPA G0 Z0 D0 M9", "SUPA G0 Z0 M9", 17, "without D0");
    siemens("SUPA G0 Z0 D0 M9", "SUPA G0 Z0 D1 M9", 17, "without D0");
    assert!(read("siemens-840d", &SIEMENS.replacen("SUPA G0 Z0 D0\n", "SUPA G0 Z0\n", 1)).is_ok());
    // A vector word that lost its sign is no angle.
    siemens("N70 G0 A=30 C=20", "N70 G0 A3 C=20", 8, "`=` is missing");
    siemens("Z10 A=30 C=20", "Z10 A=30 C3", 11, "`=` is missing");
    // States that end too early.
    siemens("N120 G1", "N120 M5 G1", 13, "spindle at rest");
    siemens("N120 G1", "N120 G500 G1", 13, "work offset");
    siemens("N120 G1", "N120 M6 G1", 13, "tool change before");
    siemens("N120 G1", "N120 D0 G1", 13, "tool length changes");
    siemens("N120 G1", "N120 SUPA D0 G0", 13, "transformation on");
    siemens(" M6 ;", " ;", 11, "without a tool");
    siemens("N140 TRAFOOF", "N140 M30", 16, "after the end");
    // Signs that look like others, and one that is not seen at all.
    siemens("Y-18", "Y\u{2212}18", 13, "<U+2212>18");
    siemens("X29", "\u{0425}29", 13, "<U+0425>");
    siemens("; %_N", "\u{feff}; %_N", 1, "<U+FEFF>");
    siemens("X29", "X 29", 13, "a number is missing");

    let linuxcnc = |from: &str, to: &str, line, words: &str| refused_at("linuxcnc", from, to, line, words);
    linuxcnc(" G64 P0.001 Q0", "", 13, "how far the control may leave the path");
    linuxcnc("Q0", "Q10.5", 2, "Q of G64");
    linuxcnc("Q0", "Q-1", 2, "Q of G64");
    linuxcnc("T2 M6", "T M6", 6, "`T`: a number is missing");
    linuxcnc("T2 M6", "T2", 7, "another tool");
    linuxcnc("G43 H2", "G43 H", 7, "`H`: a number is missing");
    linuxcnc("G1 X29", "G49 G1 X29", 14, "tool length changes");
    linuxcnc("G1 X29", "M2 G1 X29", 15, "after the end");
    linuxcnc("G53 G0 Z0\nM9", "G0 Z0\nM9", 17, "transformation off");
    linuxcnc("Y-18", "Y\u{2212}18", 14, "`Y`: a number is missing");
    linuxcnc("Y-18", "\u{0423}-18", 14, "`<U+0423>` where a word begins");
}

/// What LinuxCNC may leave of the path: it blends corners within P and joins moves within Q, which is P unless said.
#[test]
fn both_tolerances_of_blending_count() {
    for (words, due) in [("P0.001 Q0", 0.001), ("P0.001", 0.002), ("P0.001 Q0.004", 0.005), ("Q0.25 P0", 0.25)] {
        let moves = read("linuxcnc", &LINUXCNC.replacen("P0.001 Q0", words, 1)).unwrap();
        assert!(moves.iter().all(|m| (m.smoothing - due).abs() < 1e-12), "{words}: {}", moves[0].smoothing);
    }
}

#[test]
fn every_truncation_is_noticed() {
    for dialect in ["siemens-840d", "linuxcnc"] {
        let text = original(dialect);
        // Without the last line feed, or with it, the text is whole.
        for end in 0..text.len() - 1 {
            let cut = &text[..end];
            let faults = read(dialect, cut).expect_err(cut);
            assert!(faults[0].line <= cut.lines().count().max(1), "{faults:?}");
        }
        let more = format!("{text}G1 X5\n");
        assert!(read(dialect, &more).unwrap_err()[0].reason.contains("after the end"));
    }
}

/// Hand-edited text: what a block leaves unsaid keeps its value.
#[test]
fn missing_words_keep_their_modal_values() {
    let text = LINUXCNC.replacen("G1 X28 Y-19 Z2 A-32 C-22", "X28\nG1 Z1 C-23\n\n; a comment\nN5 y-20 (back)", 1);
    let moves = read("linuxcnc", &text).unwrap();
    let at = |m: &NcMove| [m.tip.x, m.tip.y, m.tip.z];
    assert_eq!(moves[4..].iter().map(at).collect::<Vec<_>>(), [[28.0, -18.0, 1.0], [28.0, -20.0, 1.0]]);
    assert_eq!(at(&moves[3]), [28.0, -18.0, 3.0]);
    let Direction::Rotary(a, c) = moves[5].direction else { panic!("rotary") };
    assert!((a.to_degrees() - 31.0).abs() < 1e-12 && (c.to_degrees() - 23.0).abs() < 1e-12);
    let edited = "N130 G1 X28 Z2\nN131 Y-19\nN132\nN133 G0 Z5 A=30 C=20\nN134 Z6 C=21";
    let from = "N130 G1 X28 Y-19 Z2 A3=0.19101007 B3=-0.46984631 C3=0.86602540";
    let moves = read("siemens-840d", &SIEMENS.replacen(from, edited, 1)).unwrap();
    let found: Vec<_> = moves[3..].iter().map(at).collect();
    assert_eq!(found, [[28.0, -18.0, 2.0], [28.0, -19.0, 2.0], [28.0, -19.0, 5.0], [28.0, -19.0, 6.0]]);
    assert_eq!(moves[3].direction, moves[2].direction, "the direction is kept");
    assert_eq!(moves[3].feed, Some(250.0));
    let Direction::Rotary(a, c) = moves[6].direction else { panic!("rotary") };
    assert!((a.to_degrees() - 30.0).abs() < 1e-12 && (c.to_degrees() - 21.0).abs() < 1e-12);
}

#[test]
fn several_faults_are_told_in_one_run_and_never_too_many() {
    let text = SIEMENS.replacen("X29", "XNAN", 1).replacen("X28", "G33 X28", 1);
    let faults = read("siemens-840d", &text).unwrap_err();
    assert_eq!(faults.iter().map(|f| f.line).collect::<Vec<_>>(), [13, 14]);
    let garbage = "garbage\n".repeat(1 << 20);
    for dialect in ["siemens-840d", "linuxcnc"] {
        let start = Instant::now();
        assert!(read(dialect, &garbage).unwrap_err().len() <= 20);
        assert!(start.elapsed() < Duration::from_secs(2));
    }
}

/// A million blocks are read; and with a fault in the last one it is found there.
#[test]
fn a_million_blocks() {
    for (dialect, last) in [("siemens-840d", "N140 TRAFOOF"), ("linuxcnc", "M429\nG53 G0 Z0\nM9")] {
        let text = original(dialect);
        let at = text.find(last).unwrap();
        let mut long = text[..at].to_owned();
        for i in 0..1_000_000 {
            long.push_str(["X28.5\n", "X28.6 Z2.1\n"][i % 2]);
        }
        let whole = format!("{long}{}", &text[at..]);
        let start = Instant::now();
        assert_eq!(read(dialect, &whole).unwrap().len(), 1_000_004);
        let bad = format!("{long}Q\n{}", &text[at..]);
        let faults = read(dialect, &bad).unwrap_err();
        assert_eq!(faults[0].line, text[..at].lines().count() + 1_000_001);
        assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
    }
}

fn verify(nc: &std::path::Path) -> (Option<i32>, String) {
    let start = Instant::now();
    let run = Command::new(env!("CARGO_BIN_EXE_impellerc"))
        .arg("verify")
        .arg(nc)
        .args(["--job", "jobs/reduced/reduced.imp"])
        .output()
        .unwrap();
    assert!(start.elapsed() < Duration::from_secs(20), "took {:?}", start.elapsed());
    let text = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(run.stdout.is_empty() && !text.contains("panicked"), "{text}");
    (run.status.code(), text)
}

/// Each of many blocks is understood and wrong: turns of C that nobody can be sure of.
#[test]
fn many_wrong_blocks_are_told_in_short() {
    let at = SIEMENS.find("N130").unwrap();
    let mut long = SIEMENS[..at].to_owned();
    for i in 0..200_000 {
        let (x, y) = [(0.5, 0.0), (0.0, 0.5), (-0.5, 0.0), (0.0, -0.5)][i * 3 % 4];
        long.push_str(&format!("N9 G1 X{} A3={x} B3={y} C3=0.8660254\n", 20 + i % 7));
    }
    long.push_str(&SIEMENS[SIEMENS.find("N140").unwrap()..]);
    let start = Instant::now();
    let moves = read("siemens-840d", &long).unwrap();
    let program = support::flank_only(&[0]);
    let mut sink = Sink::default();
    let lines = std::cell::Cell::new(0);
    let span = |line: usize| {
        lines.set(lines.get() + 1);
        Span::new(impellerc::source::SourceId(0), line..line)
    };
    assert!(motion_of(&program, &moves, &span, &mut sink).is_none());
    assert!(sink.has_errors() && sink.diags().len() <= 20 && lines.get() <= 20, "{}", sink.diags().len());
    assert!(start.elapsed() < Duration::from_secs(20));
}

#[test]
fn files_that_are_no_text_or_too_large_or_missing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.nc");
    let fails = |code: &str, words: &str| {
        let (status, text) = verify(&path);
        let exit = [("IMP0901", 3), ("IMP0822", 1)].into_iter().find(|(c, _)| *c == code).map_or(2, |(_, exit)| exit);
        assert_eq!(status, Some(exit), "{text}");
        assert!(text.contains(code) && text.contains(words) && text.contains("help:"), "{text}");
    };
    fails("IMP0901", "cannot be read");
    std::fs::write(&path, b"N10 G17\nN20 \xff\xfe\n").unwrap();
    fails("IMP0820", "line 2 is not UTF-8");
    std::fs::File::create(&path).unwrap().set_len((256 << 20) + 1).unwrap();
    fails("IMP0820", "larger than 256 MB");
    std::fs::write(&path, "").unwrap();
    fails("IMP0820", "has no block");
    std::fs::write(&path, "; a comment\n\n(another)\n").unwrap();
    fails("IMP0820", "has no block");
    std::fs::write(&path, "\0".repeat(1 << 20)).unwrap();
    fails("IMP0821", "control character");
    std::fs::write(&path, "N".repeat(1 << 20)).unwrap();
    fails("IMP0821", "longer than");
    // The job's dialect is the other one: the text is recognised; as an unknown one it is read as the job's.
    std::fs::write(&path, LINUXCNC).unwrap();
    fails("IMP0822", "operation 1 of the text uses tool 2");
    std::fs::write(&path, "O1\nG91 G28 Z0\n").unwrap();
    fails("IMP0821", "line 1 is not understood");
    std::fs::write(&path, SIEMENS).unwrap();
    fails("IMP0822", "operation 1 of the text uses tool t2");
    // What is no NC text at all is told once.
    std::fs::copy("jobs/reduced/reduced.imp", &path).unwrap();
    fails("IMP0821", "give NC text");
    assert_eq!(verify(&path).1.matches("is not understood:").count(), 1);
    // A device without an end.
    if cfg!(unix) {
        let (status, text) = verify(std::path::Path::new("/dev/zero"));
        assert!(status == Some(2) && text.contains("larger than 256 MB"), "{text}");
    }
    let (status, text) = verify(folder.path());
    assert!(status == Some(3) && text.contains("it is a folder") && text.contains("give the NC text"), "{text}");
}

/// Text of a dialect with small changes of every kind.
fn mutated() -> impl Strategy<Value = (usize, String)> {
    let change = (any::<prop::sample::Index>(), 0..4_u8, "[A-Z0-9=.()\" ;+-]{1,3}");
    (0..2_usize, prop::collection::vec(change, 1..4)).prop_map(|(which, changes)| {
        let mut text = [SIEMENS, LINUXCNC][which].to_owned();
        for (at, kind, piece) in changes {
            let i = at.index(text.len());
            match kind {
                0 => text.insert_str(i, &piece),
                1 => {
                    text.remove(i);
                }
                2 => text.replace_range(i..=i, &piece[..1]),
                _ => {
                    let mut lines: Vec<&str> = text.lines().collect();
                    let k = at.index(lines.len());
                    if piece.len() > 1 {
                        lines.remove(k);
                    } else {
                        lines.insert(k, lines[0]);
                    }
                    text = lines.join("\n") + "\n";
                }
            }
        }
        (which, text)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn changed_text_is_read_or_refused_with_a_line_of_it((which, text) in mutated()) {
        let post: &dyn Post = post::POSTS[which];
        match post.read(&text, &MACHINES[which]) {
            Ok(moves) => {
                for m in &moves {
                    prop_assert!(m.tip.iter().all(|x| x.is_finite() && x.abs() <= 1e5));
                    prop_assert!(m.line >= 1 && m.line <= text.lines().count());
                }
                let program = support::flank_only(&[0]);
                let mut sink = Sink::default();
                if let Some(nc) = motion_of(&program, &moves, &|_| Span::default(), &mut sink) {
                    let all: Vec<_> = nc.motion.operations.iter().flat_map(|o| &o.moves).collect();
                    prop_assert_eq!(all.len(), moves.len());
                    prop_assert!(all.iter().all(|m| m.time >= 0.0 && m.joints.xyz.iter().all(|x| x.is_finite())));
                } else {
                    prop_assert!(sink.has_errors());
                }
            }
            Err(faults) => {
                prop_assert!(!faults.is_empty() && faults.len() <= 20);
                for fault in faults {
                    prop_assert!(fault.line >= 1 && fault.line <= text.lines().count().max(1));
                    prop_assert!(!fault.reason.is_empty());
                }
            }
        }
    }
}
