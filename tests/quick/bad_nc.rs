//! Bad NC text: every fault is an error with its line; no panic, no endless loop, bounded memory.

use crate::support;
use crate::support::bounded;
use impellerc::base::source::Span;
use impellerc::diagnostics::Sink;
use impellerc::five_axis::Machine;
use impellerc::nc::{
    self, Direction, MAX_FAULTS, NcMove, NcPlace, NcRetract, NcSection, Post, ReadError, motion_of::motion_of,
};
use proptest::prelude::*;
use std::sync::LazyLock;

/// For the dialects as in `POSTS`.
static MACHINES: LazyLock<[Machine; 2]> =
    LazyLock::new(|| ["siemens-840d", "linuxcnc"].map(|d| support::machine_for(d, &support::machine())));

pub const SIEMENS: &str = "\
; %_N_TEST_MPF
N10 G17 G710 G90 G94 G40
N20 TRAFOOF
N30 SUPA G0 Z350 D0
N40 T=\"t2\" M6 ; flank
N50 S8000 M3
N60 SUPA G0 A=30 C=20 D0
N70 SUPA G0 X50 Y-40 D0
N80 G54 D1
N90 CYCLE832(0.0010,_ORI_FINISH,0.1)
N100 TRAORI
N110 G54 ORIWKS ORIAXES M8
N120 G0 X50 Y-40 Z10 A=30 C=20
N130 G1 X30 Y-17 Z4 A3=0.17101007 B3=-0.46984631 C3=0.86602540 F1000
N140 G1 X29 Y-18 Z3 A3=0.18101007 B3=-0.46984631 C3=0.86602540 F250
N150 G1 X28 Y-19 Z2 A3=0.19101007 B3=-0.46984631 C3=0.86602540
N160 TRAFOOF
N170 SUPA G0 Z350 D0 M9
N180 M5
N190 M30
";

pub const LINUXCNC: &str = "\
(test)
M429
G21 G17 G90 G40 G49 G80 G94 G97 G8 G54
G92.1
G10 L2 P1 R0
G64 P0.001 Q0
(flank)
G53 G0 Z350
T2 M6
S8000 M3
G53 G0 A-30 C-20
G53 G0 X50 Y-40
G43 H2
M8
M428
G0 X50 Y-40 Z10 A-30 C-20
G1 X30 Y-17 Z4 A-30 C-20 F1000
G1 X29 Y-18 Z3 A-31 C-21 F250
G1 X28 Y-19 Z2 A-32 C-22
M429
G49
G53 G0 Z350
M9
M5
M2
";

pub const HEIDENHAIN: &str = "\
0 BEGIN PGM TEST MM
1 ; a test
2 BLK FORM 0.1 Z X-60 Y-60 Z-40
3 BLK FORM 0.2 X+60 Y+60 Z+0
4 FUNCTION RESET TCPM
5 PLANE RESET STAY
6 M126
7 L Z+350 R0 FMAX M91
8 TOOL CALL 2 Z S8000
9 CYCL DEF 247 DATUM SETTING ~
  Q339=+1 ;DATUM NUMBER
10 L A+30 C+20 R0 FMAX
11 L X+50 Y-40 R0 FMAX M91
12 CYCL DEF 32.0 TOLERANCE
13 CYCL DEF 32.1 T0.001
14 CYCL DEF 32.2 HSC-MODE:0 TA0.05
15 M3
16 FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS
17 M8
18 L X+50 Y-40 Z+10 A+30 C+20 R0 FMAX
19 LN X+30 Y-17 Z+4 TX+0.17101007 TY-0.46984631 TZ+0.8660254 F1000
20 L X+29 Y-18 Z+3 A+31 C+21 F250
21 L X+28 Y-19 Z+2 A+32 C+22
22 FUNCTION RESET TCPM
23 L Z+350 R0 FMAX M91 M9
24 M5
25 M30
26 END PGM TEST MM
";

fn machine(dialect: &str) -> &'static Machine {
    &MACHINES[usize::from(dialect == "linuxcnc")]
}

fn sections(dialect: &str, text: &str) -> Result<Vec<NcSection>, Vec<ReadError>> {
    nc::find(dialect).unwrap().read(text, machine(dialect))
}

fn read(dialect: &str, text: &str) -> Result<Vec<NcMove>, Vec<ReadError>> {
    Ok(sections(dialect, text)?.into_iter().flat_map(|s| s.moves).collect())
}

fn original(dialect: &str) -> &'static str {
    match dialect {
        "siemens-840d" => SIEMENS,
        "linuxcnc" => LINUXCNC,
        _ => HEIDENHAIN,
    }
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
fn klartext_by_m128_and_by_tcpm_is_the_same() {
    let m128 = HEIDENHAIN
        .replace("FUNCTION RESET TCPM", "M129")
        .replace("FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS", "L M128");
    let moves = read("heidenhain", HEIDENHAIN).unwrap();
    assert_eq!(moves.len(), 4);
    assert_eq!(read("heidenhain", &m128).unwrap(), moves);
    assert!(moves[0].rapid && moves[1].feed == Some(1000.0) && moves[3].feed == Some(250.0));
    // FMAX acts in its block alone.
    let rapid = HEIDENHAIN.replacen("C+21 F250", "C+21 FMAX", 1);
    let moves = read("heidenhain", &rapid).unwrap();
    assert!(moves[2].rapid && moves[3].feed == Some(1000.0));
    // A word of the machine builder, and one of the control that no machine file can allow.
    let own = Machine { own_words: vec!["M25".to_owned(), "M116".to_owned()], ..machine("heidenhain").clone() };
    let with = |word: &str| HEIDENHAIN.replace("6 M126", &format!("6 M126 {word}"));
    refused("heidenhain", "6 M126", "6 M126 M25", "add it to `own-words`");
    assert_eq!(nc::find("heidenhain").unwrap().read(&with("M25"), &own).unwrap()[0].moves.len(), 4);
    assert!(nc::find("heidenhain").unwrap().read(&with("M116"), &own).is_err());
    // On an axis without end M126 takes the other way.
    let far = HEIDENHAIN.replace("C+22", "C+222");
    let mut endless = machine("heidenhain").clone();
    (endless.rotary[1].min, endless.rotary[1].max) = (-50.0, 50.0);
    let faults = nc::find("heidenhain").unwrap().read(&far, &endless).unwrap_err();
    assert!(faults[0].line == 23 && faults[0].reason.contains("on the shorter way"), "{faults:?}");
    refused("heidenhain", "TX+0.17101007", "TX+0.18", "length");
    refused("heidenhain", "TX+0.17101007 ", "", "LN without TX");
    refused_at(
        "heidenhain",
        "7 L Z+350 R0 FMAX M91\n",
        "",
        8,
        "a tool change before the tool is at the retract height",
    );
}

#[test]
fn the_originals_are_read() {
    for (dialect, lines, placed, up) in [("siemens-840d", 13..=16, 8, 18), ("linuxcnc", 16..=19, 12, 22)] {
        let sections = sections(dialect, original(dialect)).unwrap();
        let [section] = sections.as_slice() else { panic!("{sections:?}") };
        let moves = &section.moves;
        assert_eq!(moves.iter().map(|m| m.line).collect::<Vec<_>>(), lines.collect::<Vec<_>>());
        assert_eq!(moves.iter().map(|m| m.feed).collect::<Vec<_>>(), [None, Some(1000.0), Some(250.0), Some(250.0)]);
        let NcPlace::Axes { xyz, rotary, .. } = section.start.place else { panic!("{section:?}") };
        assert_eq!((section.start.line, xyz.as_slice()), (placed, &[50.0, -40.0, 350.0][..]));
        assert!((rotary[0].to_degrees() - 30.0).abs() < 1e-12 && (rotary[1].to_degrees() - 20.0).abs() < 1e-12);
        assert_eq!(section.retract, Some((up, NcRetract::Height(350.0))));
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
            let words = if words == "not" && (dialect == "linuxcnc" || bad == "0x10") { "" } else { words };
            refused(dialect, "X29", &format!("X{bad}"), words);
        }
    }
}

#[test]
fn values_beyond_all_measure() {
    refused("siemens-840d", "A=30", "A=99999", "out of range: the travel of the axis is -100 to 100 deg");
    refused("linuxcnc", "C-20", "C-99999", "out of range");
    refused("linuxcnc", "A-31", "A100.1", "the travel of the axis is -100 to 100 deg");
    refused("siemens-840d", "SUPA G0 X50", "SUPA G0 X400.1", "outside its travel of -400 to 400");
    refused("linuxcnc", "G53 G0 Z350", "G53 G0 Z350.1", "outside its travel of -350 to 350");
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
        for unknown in ["G2 X29", "M98 X29", "B5 X29", "/X29", "X29 §"] {
            refused(dialect, "X29", unknown, "not understood");
        }
        refused(dialect, "X29", "X29 X29", "twice");
        refused(dialect, "F250", "F250 F250", "twice");
        refused(dialect, "G1 X29", "G0 G1 X29", "two of G0");
        refused(dialect, "G17", "G17 G17", "both set the plane");
        refused(dialect, "M3", "M3 M5", "both set the spindle");
        refused(dialect, "X29", "\u{0}X29", "control character");
    }
    refused("siemens-840d", "X29", "IF R1==1 GOTOF X29", "");
    refused("siemens-840d", "_ORI_FINISH", "_ORI_SOMEHOW", "CYCLE832");
    refused("linuxcnc", "(flank)", "(flank", "comment");
    refused("linuxcnc", "(flank)", "(fl(ank)", "comment");
}

#[test]
fn the_way_to_the_first_target_is_known() {
    refused_at("siemens-840d", "N20 TRAFOOF\n", "", 3, "may still be on");
    refused_at("siemens-840d", "N30 SUPA G0 Z350 D0\n", "", 4, "a tool change before");
    refused_at(
        "siemens-840d",
        "N60 SUPA G0 A=30 C=20 D0\n",
        "",
        10,
        "depends on an unknown A: move A at the retract height",
    );
    refused_at("siemens-840d", "A=30 C=20 D0", "A=30 D0", 11, "unknown C");
    refused_at("siemens-840d", "X50 Y-40 D0", "X50 D0", 11, "unknown Y");
    refused("siemens-840d", "SUPA G0 Z350 D0", "SUPA G0 Z-50 D0", "retract height of the machine file is Z350");
    refused("siemens-840d", "SUPA G0 Z350 D0", "SUPA G0 X0 Z350 D0", "X and Z move together");
    refused("siemens-840d", "SUPA G0 Z350 D0", "SUPA G1 Z350 D0", "at feed with the transformation off");
    refused("siemens-840d", "SUPA G0 Z350 D0", "SUPA G0 Z350", "a tool length may still be active");
    refused("siemens-840d", "SUPA G0 Z350 D0", "G0 Z350 D0", "in the work frame with the transformation off");
    refused("siemens-840d", "SUPA G0 Z350 D0", "SUPA G0 A=0 D0", "at an unknown height");
    refused_at("siemens-840d", "N160 TRAFOOF\n", "", 17, "with the transformation on");
    refused_at("siemens-840d", "N170 SUPA G0 Z350 D0 M9\n", "N170 SUPA G0 A=0 D0 M9\n", 18, "unknown height");
    refused_at("siemens-840d", "N150 G1", "N145 TRAFOOF\nN146 TRAORI\nN150 G1", 17, "unknown height");
    refused_at("linuxcnc", "M429\n", "", 2, "M429 alone in a block before");
    refused_at("linuxcnc", "G53 G0 Z350\n", "", 8, "a tool change before");
    refused_at("linuxcnc", "G53 G0 A-30 C-20\n", "", 14, "unknown A");
    refused_at("linuxcnc", "G53 G0 X50 Y-40\n", "", 14, "unknown X");
    refused("linuxcnc", "G53 G0 Z350", "G53 G0 Z0", "goes to Z0 of the machine, but the retract height");
    refused("linuxcnc", "G53 G0 Z350", "G0 Z350", "in the work frame");
    refused("linuxcnc", "G53 G0 Z350\n", "G53 G0 X0\nG53 G0 Z350\n", "unknown height");
    refused_at("linuxcnc", "M428\n", "", 15, "in the work frame with the transformation off");
    refused_at("linuxcnc", "M429\nG49\nG53 G0 Z350\nM9", "G53 G0 Z350\nM429\nM9", 20, "write M429 before");
    refused_at("linuxcnc", "M429\nG49\nG53 G0 Z350\nM9", "G49\nM429\nG53 G0 Z350\nM9", 20, "the axes jump");
    refused_at("linuxcnc", "G43 H2\nM8\nM428\n", "M8\nM428 G43 H2\n", 14, "without the length of the tool");
    refused("siemens-840d", "N100 TRAORI", "N100 TRAORI X5", "alone in its block");
    refused("linuxcnc", "G1 X28", "M428\nG1 X28", "twice");
    refused("siemens-840d", "N150 G1", "N145 TRAORI\nN150 G1", "twice");
}

#[test]
fn what_a_program_leaves_behind_is_judged() {
    refused_at("linuxcnc", "M429\nG49\nG53 G0 Z350\nM9\nM5\n", "", 20, "ends with the transformation on");
    refused_at("linuxcnc", "G49\nG53 G0 Z350\nM9\nM5\n", "M9\n", 22, "ends with the tool in the part");
    refused_at("siemens-840d", "N180 M5\n", "", 19, "ends with the spindle on, by M3 in line 6");
    refused_at("siemens-840d", " M9\n", "\n", 20, "ends with the coolant on, by M8");
    // The end of a program switches both off there.
    for piece in ["M9\n", "M5\n", "M9\nM5\n"] {
        let at = LINUXCNC.find("M9\n").unwrap();
        let (body, end) = LINUXCNC.split_at(at);
        assert!(read("linuxcnc", &format!("{body}{}", end.replacen(piece, "", 1))).is_ok(), "{piece}");
    }
    let tape = format!("%\n{}", LINUXCNC.replacen("M2\n", "%\n", 1));
    assert!(read("linuxcnc", &tape).is_ok());
    let faults = read("linuxcnc", &tape.replacen("M5\n", "", 1)).unwrap_err();
    assert!(faults[0].reason.contains("ends with the spindle on"), "{faults:?}");
    assert!(read("linuxcnc", &format!("{LINUXCNC}%\n")).is_err());
}

/// A text with the numbers of its blocks anew, where the control counts them.
fn numbered(dialect: &str, text: &str) -> String {
    if dialect != "heidenhain" {
        return text.to_owned();
    }
    let mut number = 0;
    let lines = text.lines().map(|line| {
        let Some((_, words)) = line.split_once(' ').filter(|_| !line.starts_with(' ')) else {
            return format!("{line}\n");
        };
        number += 1;
        format!("{} {words}\n", number - 1)
    });
    lines.collect()
}

/// No cutter touches stock while the spindle stands, turns the wrong way, or waits: from the switch of the transformation to
/// the retract.
#[test]
fn the_spindle_turns_until_the_retract() {
    let [stops, waits] = ["stops the spindle or turns it round with the tool in the part", "wait with the tool"];
    for (dialect, cut, off, retract) in [
        ("siemens-840d", "N150 G1 X28", "N160 TRAFOOF\n", ["SUPA G0 Z350 D0 M9", "M9"]),
        ("linuxcnc", "G1 X28", "M429\nG49\nG53 G0 Z350", ["G53 G0 Z350\nM9", "M9"]),
        ("heidenhain", "21 L X+28", "22 FUNCTION RESET TCPM\n", ["L Z+350 R0 FMAX M91 M9", "M9"]),
    ] {
        let text = original(dialect);
        let behind = off.split_inclusive('\n').next().unwrap();
        let places = [cut, off].map(|piece| text.find(piece).unwrap());
        let places = [places[0], places[1], places[1] + behind.len()];
        let line = |at: usize| text[..at].matches('\n').count() + 1;
        let judge = |at: usize, words: &str| {
            let words: String = words
                .split('\n')
                .map(|word| format!("{}{word}\n", if dialect == "heidenhain" { "0 " } else { "" }))
                .collect();
            read(dialect, &numbered(dialect, &format!("{}{words}{}", &text[..at], &text[at..])))
        };
        // Between two cuts, behind the last cut, and behind the end of the transformation, whatever follows.
        for at in places {
            for (words, why) in [("M5", stops), ("M4", stops), ("M5\nM3", stops), ("M4\nM3", stops), ("M0", waits)] {
                let faults = judge(at, words).expect_err(words);
                assert!(faults[0].line == line(at) && faults[0].reason.contains(why), "{dialect} {words}: {faults:?}");
                assert_eq!(faults.len(), 1, "{dialect} {words}: {faults:?}");
            }
            if dialect != "heidenhain" {
                let faults = judge(at, "S0").expect_err("S0");
                assert!(faults[0].line == line(at) && faults[0].reason.contains(stops), "{dialect} S0: {faults:?}");
            }
            // What changes nothing.
            assert!(judge(at, "M3").is_ok(), "{dialect}: {:?}", judge(at, "M3"));
        }
        let faults = read(dialect, &text.replacen(retract[0], retract[1], 1)).expect_err(retract[0]);
        assert!(faults[0].reason.contains(stops) && faults.len() == 1, "{dialect}: {faults:?}");
    }
    // M5 acts at the end of its block on HEIDENHAIN controls, on others before it.
    let text = numbered("heidenhain", &HEIDENHAIN.replacen("M91 M9\n24 M5", "M91 M5\n24 M9", 1));
    assert!(read("heidenhain", &text).is_ok(), "{:?}", read("heidenhain", &text));
    refused_at("siemens-840d", "D0 M9\nN180 M5", "D0 M5\nN180 M9", 18, stops);
}

/// Each modal group that a move needs: dropped, and set to another value.
#[test]
fn what_a_move_needs_is_said_before_it() {
    refused_at("siemens-840d", "G710 ", "", 4, "no block before this move ensures lengths and feeds in mm: write G710");
    refused_at("siemens-840d", "G710 ", "G700 ", 4, "a move with G700, which line 2 sets: lengths and feeds in mm");
    refused_at("siemens-840d", "G710 ", "G71 ", 4, "G71");
    refused_at("siemens-840d", "G90 ", "", 4, "absolute");
    refused_at("siemens-840d", "G90 ", "G91 ", 4, "G91");
    refused_at("siemens-840d", " G40", "", 4, "write G40");
    refused_at("siemens-840d", " G40", " G41", 4, "G41");
    refused_at("siemens-840d", "G17 ", "", 13, "the plane");
    refused_at("siemens-840d", "G17 ", "G18 ", 13, "G18");
    refused_at("siemens-840d", "G94 ", "", 14, "feed per minute");
    refused_at("siemens-840d", "G94 ", "G95 ", 14, "G95");
    refused_at("siemens-840d", "N110 G54 ", "N110 ", 13, "the work offset, which TRAORI and TRAFOOF reset");
    refused_at("siemens-840d", "N110 G54 ", "N110 G55 ", 13, "G55");
    refused_at("siemens-840d", "ORIWKS", "ORIMKS", 13, "ORIMKS");
    refused_at("siemens-840d", " ORIWKS", "", 13, "ORIWKS");
    refused_at("siemens-840d", "ORIAXES", "ORIVECT", 13, "ORIVECT");
    refused_at("siemens-840d", " ORIAXES", "", 13, "ORIAXES");
    refused_at("siemens-840d", " M8", "", 14, "coolant on: write M8");
    refused_at("siemens-840d", " M3", "", 14, "the spindle on, clockwise: write M3");
    refused_at("siemens-840d", " M3", " M4", 14, "a move with M4");
    refused_at("siemens-840d", "S8000 ", "", 14, "no S before this block");
    refused_at("siemens-840d", " F1000", "", 14, "without a feed");
    refused_at("siemens-840d", " D1", "", 11, "without the length of the tool");
    refused_at("siemens-840d", "D1", "D2", 9, "another cutting edge");
    refused_at("siemens-840d", "T=\"t2\" ", "", 5, "before any T");
    refused_at("siemens-840d", " M6 ;", " ;", 9, "before a tool change");
    refused("siemens-840d", "X50 Y-40 Z10", "X50 Y-40", "Z is missing");
    refused("siemens-840d", "A3=0.18101007 B3=-0.46984631 C3=0.86602540", "A3=0 B3=0 C3=0", "length 0");
    refused("siemens-840d", "A3=0.18101007 B3=-0.46984631 C3=0.86602540", "C=5", "only one of A and C");
    refused("siemens-840d", "C3=0.86602540 F250", "F250", "direction");
    refused_at("linuxcnc", "G21 ", "", 8, "write G21");
    refused_at("linuxcnc", "G21 ", "G20 ", 8, "G20");
    refused_at("linuxcnc", "G90 ", "G91 ", 8, "G91");
    refused_at("linuxcnc", "G8 ", "", 8, "diameter");
    refused_at("linuxcnc", "G8 ", "G7 ", 8, "G7");
    refused_at("linuxcnc", "G40 ", "", 8, "G40");
    refused_at("linuxcnc", "G17 ", "G19 ", 16, "G19");
    refused_at("linuxcnc", " G54", "", 16, "G54");
    refused_at("linuxcnc", " G54", " G59.3", 16, "G59.3");
    refused_at("linuxcnc", "G92.1\n", "", 15, "G92 or G52: write G92.1");
    refused_at("linuxcnc", "G92.1", "G92.3", 16, "G92.3");
    refused_at("linuxcnc", "G10 L2 P1 R0\n", "", 15, "rotation of the work offset");
    refused_at("linuxcnc", "G94 ", "", 17, "feed per minute");
    refused_at("linuxcnc", "G97 ", "G96 S8000 ", 17, "G96");
    refused_at("linuxcnc", " M3", "", 17, "write M3");
    refused_at("linuxcnc", "M8\n", "", 16, "write M8");
    refused_at("linuxcnc", "M8\n", "M9\n", 17, "a move with M9");
    refused_at("linuxcnc", " F1000", "", 17, "without a feed");
    refused_at("linuxcnc", "G43 H2\n", "", 14, "without the length of the tool");
    refused("linuxcnc", "X50 Y-40 Z10", "X50 Z10", "Y is missing");
}

/// Hand edits that a control would run, otherwise than it looks: each was read as if nothing had changed.
#[test]
fn edits_with_which_the_control_does_something_else() {
    let siemens = |from: &str, to: &str, line, words: &str| refused_at("siemens-840d", from, to, line, words);
    // Without a tolerance, or with smoothing off, the control takes its own; a wide one for the axis tilts the flutes.
    siemens("N90 CYCLE832(0.0010,_ORI_FINISH,0.1)\n", "", 13, "the tolerance of the path is unknown");
    siemens("0.0010,_ORI_FINISH,0.1", "0,_OFF,1", 14, "deviate from the path without a limit");
    siemens("0.0010,_ORI_FINISH,0.1", "0,_ORI_FINISH,0.1", 10, "makes the control use its own tolerance");
    siemens("_ORI_FINISH,0.1", "_ORI_FINISH,0.11", 10, "a tilt error of 0.11 deg");
    siemens("_ORI_FINISH,0.1", "_ORI_ROUGH,5", 10, "a tilt error of 5 deg");
    siemens("N110 G54", "N105 G64\nN110 G54", 15, "with G64 the control may deviate from the path");
    siemens("CYCLE832(0.0010,_ORI_FINISH,0.1)", "CYCLE832(0.0010,_ORI_FINISH,0.1) M8", 10, "alone in its block");
    // The length of a tool acts, or is that of another edge.
    siemens("SUPA G0 Z350 D0 M9", "SUPA G0 Z350 M9", 18, "the tool length is still active");
    siemens("SUPA G0 Z350 D0 M9", "SUPA G0 Z350 D1 M9", 18, "the tool length is still active");
    siemens("SUPA G0 Z350 D0", "G53 G0 Z350 D0", 4, "write SUPA");
    // A vector word that lost its sign is no angle.
    siemens("G0 A=30 C=20", "G0 A3 C=20", 7, "`=` is missing");
    siemens("Z10 A=30 C=20", "Z10 A=30 C3", 13, "`=` is missing");
    // States that end too early.
    siemens("N140 G1", "N140 M5 G1", 15, "`M5` stops the spindle");
    siemens("N140 G1", "N140 G500 G1", 15, "a move with G500");
    siemens("N140 G1", "N140 M6 G1", 15, "tool change before");
    siemens("N140 G1", "N140 D0 G1", 15, "the axes jump");
    siemens("N140 G1", "N140 SUPA D0 G0", 15, "the axes jump");
    siemens("N140 G1", "N140 SUPA G0", 15, "machine frame with the transformation on");
    siemens("N140 G1", "N140 M0 G1", 15, "wait with the tool in the part");
    siemens("N140 G1", "N135 G4 F2\nN140 G1", 15, "wait with the tool in the part");
    siemens("N160 TRAFOOF", "N160 M30", 17, "ends with the transformation on");
    siemens("N110 G54", "N105 ROT Z10\nN110 G54", 18, "the work frame is still turned by 10 deg here");
    siemens("N110 G54", "N105 ROT X10\nN110 G54", 12, "read about Z only");
    siemens("N110 G54", "N105 ATRANS X1\nN110 G54", 12, "not understood");
    siemens("N50 S8000", "N50 BRISK S8000", 6, "jerk");
    // Signs that look like others, and one that is not seen at all.
    siemens("Y-18", "Y\u{2212}18", 15, "<U+2212>18");
    siemens("X29", "\u{0425}29", 15, "<U+0425>");
    siemens("X29 ", "X29\u{a0}", 15, "<U+00A0>");
    siemens("; %_N", "\u{feff}; %_N", 1, "<U+FEFF>");
    siemens("X29", "X 29", 15, "a number is missing");

    let linuxcnc = |from: &str, to: &str, line, words: &str| refused_at("linuxcnc", from, to, line, words);
    linuxcnc("G64 P0.001 Q0\n", "", 16, "the tolerance of the path is unknown");
    linuxcnc("G64 P0.001 Q0", "G64", 17, "with G64 without P");
    linuxcnc("G64 P0.001 Q0", "G64 P0 Q0", 17, "with G64 P0 the control may deviate");
    linuxcnc("Q0", "Q10.5", 6, "Q of G64");
    linuxcnc("Q0", "Q-1", 6, "Q of G64");
    linuxcnc("G64 P0.001 Q0", "G61 G64 P0.001", 6, "set the path mode");
    linuxcnc("G92.1", "G92 X5", 4, "shifts the work frame");
    linuxcnc("G10 L2 P1 R0", "G10 L2 P1 R10", 5, "turned with the transformation off");
    linuxcnc("G10 L2 P1 R0", "G10 L2 P2 R0", 5, "only G10 L2 P1 R0");
    linuxcnc("G10 L2 P1 R0", "G10 L2 P1 X5 R0", 5, "changes the work offset");
    linuxcnc("T2 M6", "T M6", 9, "`T`: a number is missing");
    linuxcnc("T2 M6", "T2", 15, "length of another tool");
    linuxcnc("G43 H2", "G43 H", 13, "`H`: a number is missing");
    linuxcnc("G43 H2", "G43 H3", 13, "tool 2 is in the spindle with the length of another tool, 3");
    linuxcnc("G43 H2", "G43 H0", 13, "sets no length");
    linuxcnc("T2 M6", "T1 M6", 13, "length of another tool");
    linuxcnc("G1 X29", "G49 G1 X29", 18, "tool length changes");
    linuxcnc("G1 X29", "G80\nX29", 19, "before any G0 or G1");
    linuxcnc("G1 X29", "M2 G1 X29", 18, "ends with the transformation on");
    linuxcnc("G53 G0 Z350\nM9", "G0 Z350\nM9", 22, "work frame with the transformation off");
    linuxcnc("Y-18", "Y\u{2212}18", 18, "`Y`: a number is missing");
    linuxcnc("Y-18", "\u{0423}-18", 18, "`<U+0423>` is not understood at the beginning of a word");
    linuxcnc("X29 ", "X29\u{a0}", 18, "`<U+00A0>` is not understood at the beginning of a word");
    linuxcnc("G1 X29", "G81 X29", 18, "cycles are not read");
    linuxcnc("G1 X29", "G28 X29", 18, "set at the control");
}

/// Comments that the control executes are none.
#[test]
fn comments_that_are_orders() {
    for order in [
        "(py,import os)",
        ";py,import os",
        "( DEBUG,#1)",
        "(print,x)",
        "(LOG,x)",
        "(LOGOPEN,f)",
        "(PROBEOPEN f)",
        "(AXIS,stop)",
        "(abort,now)",
        "; PY,x",
    ] {
        refused("linuxcnc", "(flank)", order, "is not a comment: the control executes");
    }
    for comment in ["(MSG,tool 2)", "(python)", "(log of changes)", "(axis of the tool)", "; printed"] {
        assert!(read("linuxcnc", &LINUXCNC.replacen("(flank)", comment, 1)).is_ok(), "{comment}");
    }
}

/// What real programs use and what changes nothing.
#[test]
fn harmless_spellings_are_understood() {
    let same = |dialect: &str, text: &str, what: &str| {
        let meant = sections(dialect, original(dialect)).unwrap();
        let found = sections(dialect, text).unwrap_or_else(|f| panic!("{what}: {f:?}"));
        let bare = |all: &[NcSection]| {
            let of = |m: &NcMove| (m.rapid, m.tip, m.direction, m.feed, m.speed);
            all.iter()
                .map(|s| (s.start.place, s.moves.iter().map(of).collect::<Vec<_>>(), s.retract.map(|r| r.1)))
                .collect::<Vec<_>>()
        };
        assert_eq!(bare(&found), bare(&meant), "{what}");
    };
    for (from, to) in [
        ("N190 M30", "N190 M2"),
        ("N190 M30", "N190 M02"),
        ("N150 G1", "N150 G01"),
        ("G0 X50 Y-40 Z10 A=30 C=20", "G00X50Y-40Z10A=30C=20"),
        ("G0 X50 Y-40 Z10 A=30 C=20", "g0 x=50 y = -40 Z=10.0 a=+30 c=20."),
        ("N50 S8000 M3", "N45 MSG(\"tool; t2\")\nN50 S8000 M3\nN51 G4 F1\nN52 M1\nN53 STOPRE"),
        ("N90 CYCLE832", "N85 SOFT FFWON G642\nN90 CYCLE832"),
        ("0.0010,_ORI_FINISH,0.1", " 0.0010, _ori_finish , 0.1"),
        ("N10 G17", "N5 TRANS\nN10 G17"),
        ("; %_N_TEST_MPF", "%_N_TEST_MPF\n;$PATH=/_N_WKS_DIR/_N_X_WPD"),
        ("M8\n", "M7\n"),
        ("N150 G1 X28 Y-19 Z2", "X28 Y-19 Z2"),
    ] {
        assert!(SIEMENS.contains(from), "{from}");
        same("siemens-840d", &SIEMENS.replacen(from, to, 1), to);
    }
    for (from, to) in [
        ("M2\n", "M30\n"),
        ("G1 X28", "G01X28"),
        ("G1 X28 Y-19 Z2 A-32 C-22", "g 1 x 28 y -1 9 z2. a -32.0 c-22"),
        ("S8000 M3", "S8000 M3\nG4 P1.5\nM1\nM0"),
        ("M8\n", "M7\n"),
        ("T2 M6\n", "T02\nM6\n"),
        ("T2 M6\n", "M6 T2\n"),
        ("G43 H2", "G43"),
        ("G64 P0.001 Q0", "G61"),
        ("G64 P0.001 Q0", "G61.1"),
        ("G92.1", "G92.2"),
        ("M429\nG49\nG53 G0 Z350\nM9", "M429\nG53 G0 Z350\nG49\nM9"),
        ("M429\nG49\nG53 G0 Z350\nM9", "M429\nG49 G53 G0 Z350 M9"),
        ("G1 X28", "N10 G1 X28"),
        ("G1 X28", "\tG1 (x) X28"),
    ] {
        assert!(LINUXCNC.contains(from), "{from}");
        same("linuxcnc", &LINUXCNC.replacen(from, to, 1), to);
    }
    // The tool that comes in is the one whose length is taken, in one block too.
    let later =
        LINUXCNC.replacen("T2 M6\n", "T2\n", 1).replacen("G43 H2", "M6 G43 H2", 1).replacen("S8000 M3\n", "", 1);
    same("linuxcnc", &later.replacen("M8\n", "M8\nS8000 M3\n", 1), "M6 G43 H2 in one block");
    for dialect in ["siemens-840d", "linuxcnc"] {
        same(dialect, &original(dialect).replace('\n', "\r\n"), "CRLF");
        same(dialect, original(dialect).trim_end(), "no line feed at the end");
        same(dialect, &original(dialect).replace('\n', " \n\n"), "blank lines");
    }
}

/// In inverse time F is the share of a block in a minute, said in every block.
#[test]
fn inverse_time_is_understood() {
    let text = LINUXCNC.replacen("G0 X50 Y-40 Z10 A-30 C-20\n", "G0 X50 Y-40 Z10 A-30 C-20\nG93\n", 1).replacen(
        "G1 X28 Y-19 Z2 A-32 C-22",
        "G1 X28 Y-19 Z2 A-32 C-22 F10",
        1,
    );
    let moves = read("linuxcnc", &text).unwrap();
    assert!((moves[3].feed.unwrap() - 10.0 * 3f64.sqrt()).abs() < 1e-9, "{moves:?}");
    for (from, to, words) in [
        (" F10\n", "\n", "needs F in its own block"),
        (" F10\n", " F0.01\n", "less than 0.1 mm/min"),
        ("A-32 C-22 F10\n", "A-32 C-22 F10\nG94 G1 X27\n", "without a feed"),
    ] {
        let faults = read("linuxcnc", &text.replacen(from, to, 1)).unwrap_err();
        assert!(faults[0].reason.contains(words), "{to}: {faults:?}");
    }
}

/// What LinuxCNC may leave of the path: it blends corners within P and joins moves within Q, which is P unless said.
#[test]
fn both_tolerances_of_blending_count() {
    for (words, due) in [("P0.001 Q0", 0.001), ("P0.001", 0.002), ("P0.001 Q0.004", 0.005)] {
        let moves = read("linuxcnc", &LINUXCNC.replacen("P0.001 Q0", words, 1)).unwrap();
        assert!(moves.iter().all(|m| (m.smoothing.unwrap() - due).abs() < 1e-12), "{words}: {:?}", moves[0].smoothing);
    }
}

#[test]
fn every_truncation_is_noticed() {
    for dialect in ["siemens-840d", "linuxcnc"] {
        let text = original(dialect);
        // Without the last line feed, or with it, the text is whole.
        for end in 0..text.len() - 1 {
            let cut = &text[..end];
            // Of M30 the beginning is a word that switches the spindle on.
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
    let Direction::Rotary([a, c]) = moves[5].direction else { panic!("rotary") };
    assert!((a.to_degrees() - 31.0).abs() < 1e-12 && (c.to_degrees() - 23.0).abs() < 1e-12);
    let edited = "N130 G1 X28 Z2\nN131 Y-19\nN132\nN133 G0 Z5 A=30 C=20\nN134 Z6 C=21";
    let from = "N150 G1 X28 Y-19 Z2 A3=0.19101007 B3=-0.46984631 C3=0.86602540";
    let moves = read("siemens-840d", &SIEMENS.replacen(from, edited, 1)).unwrap();
    let found: Vec<_> = moves[3..].iter().map(at).collect();
    assert_eq!(found, [[28.0, -18.0, 2.0], [28.0, -19.0, 2.0], [28.0, -19.0, 5.0], [28.0, -19.0, 6.0]]);
    assert_eq!(moves[3].direction, moves[2].direction, "the direction is kept");
    assert_eq!(moves[3].feed, Some(250.0));
    let Direction::Rotary([a, c]) = moves[6].direction else { panic!("rotary") };
    assert!((a.to_degrees() - 30.0).abs() < 1e-12 && (c.to_degrees() - 21.0).abs() < 1e-12);
}

#[test]
fn all_faults_are_told_in_one_run_and_never_too_many() {
    let text = SIEMENS.replacen("X29", "XNAN", 1).replacen("X28", "G33 X28", 1);
    let faults = read("siemens-840d", &text).unwrap_err();
    assert_eq!(faults.iter().map(|f| f.line).collect::<Vec<_>>(), [15, 16]);
    // Faults of the state as well, each once, at the block that meets it.
    let text = LINUXCNC
        .replacen("G21 ", "", 1)
        .replacen("G92.1\n", "", 1)
        .replacen("G97 ", "", 1)
        .replacen("H2", "H7", 1)
        .replacen("M9\nM5\n", "", 1)
        .replacen("G49\nG53 G0 Z350\n", "", 1);
    let faults = read("linuxcnc", &text).unwrap_err();
    let lines: Vec<usize> = faults.iter().map(|f| f.line).collect();
    assert_eq!(lines, [7, 12, 15, 16, 20], "{faults:#?}");
    let garbage = "garbage\n".repeat(1 << 20);
    for dialect in ["siemens-840d", "linuxcnc"] {
        assert!(read(dialect, &garbage).unwrap_err().len() <= MAX_FAULTS);
    }
}

/// A million blocks are read; and with a fault in the last one it is found there.
#[test]
fn a_million_blocks() {
    for (dialect, last) in [("siemens-840d", "N160 TRAFOOF"), ("linuxcnc", "M429\nG49\n")] {
        let text = original(dialect);
        let at = text.find(last).unwrap();
        let mut long = text[..at].to_owned();
        for i in 0..1_000_000 {
            long.push_str(["X28.5\n", "X28.6 Z2.1\n"][i % 2]);
        }
        let whole = format!("{long}{}", &text[at..]);
        assert_eq!(read(dialect, &whole).unwrap().len(), 1_000_004);
        let bad = format!("{long}Q\n{}", &text[at..]);
        let faults = read(dialect, &bad).unwrap_err();
        assert_eq!(faults[0].line, text[..at].lines().count() + 1_000_001);
    }
}

fn verify(nc: &std::path::Path) -> (Option<i32>, String) {
    let run = bounded::program().arg("verify").arg(nc).args(["--job", "jobs/reduced/reduced.imp"]).output().unwrap();
    let text = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(run.stdout.is_empty() && !text.contains("panicked"), "{text}");
    (run.status.code(), text)
}

/// Each of many blocks is understood and wrong: turns of C that nobody can be sure of.
#[test]
fn many_wrong_blocks_are_told_in_short() {
    let at = SIEMENS.find("N150").unwrap();
    let mut long = SIEMENS[..at].to_owned();
    for i in 0..200_000 {
        let (x, y) = [(0.5, 0.0), (0.0, 0.5), (-0.5, 0.0), (0.0, -0.5)][i * 3 % 4];
        long.push_str(&format!("N9 G1 X{} A3={x} B3={y} C3=0.8660254\n", 20 + i % 7));
    }
    long.push_str(&SIEMENS[SIEMENS.find("N160").unwrap()..]);
    let moves = sections("siemens-840d", &long).unwrap();
    let program = support::flank_only(&[0]);
    let mut sink = Sink::default();
    let lines = std::cell::Cell::new(0);
    let span = |line: usize| {
        lines.set(lines.get() + 1);
        Span::new(impellerc::base::source::SourceId(0), line..line)
    };
    assert!(motion_of(&program, &moves, &span, &mut sink).is_none());
    assert!(
        sink.has_errors() && sink.diags().len() <= MAX_FAULTS && lines.get() <= MAX_FAULTS,
        "{}",
        sink.diags().len()
    );
}

/// Blocks that end a text of the reduced job for LinuxCNC, put in behind its first cut.
fn with_blocks(text: &str, blocks: impl Iterator<Item = (f64, f64)>) -> String {
    // The first block of a cut, behind its positioning in inverse time.
    let cut = text.lines().skip_while(|l| !l.contains("M428")).position(|l| l.starts_with("G94 G1 ")).unwrap();
    let from = text.lines().position(|l| l.contains("M428")).unwrap() + cut;
    let line = text.lines().nth(from).unwrap();
    let of = |word: char| line.split(' ').find_map(|w| w.strip_prefix(word)?.parse::<f64>().ok()).unwrap();
    let (z, c) = (of('Z'), of('C'));
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines.splice(from + 1..=from, blocks.map(|(up, turn)| format!("G1 Z{:.4} C{:.5}", z + up, c + turn)));
    lines.join("\n")
}

/// Memory is told before it is taken, and texts within it are measured.
#[test]
fn a_text_that_would_take_too_much_memory_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.ngc");
    let job = ["jobs/small/small.imp", "--post", "linuxcnc", "--machine", "5mc850-c-linuxcnc"];
    let made = bounded::program().args(job).args(["--stock-cell", "1"]).arg("-o").arg(&path).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let text = std::fs::read_to_string(&path).unwrap();
    let verify = |text: &str| {
        std::fs::write(&path, text).unwrap();
        let run = bounded::program().arg("verify").arg(&path).arg("--job").args(job).output().unwrap();
        (run.status.code(), String::from_utf8_lossy(&run.stderr).into_owned())
    };
    // 1 mm up and down: the axes change their speed at each block.
    let (status, said) = verify(&with_blocks(&text, (0..60_000).map(|k| (f64::from(30 + k % 2), 0.0))));
    assert_eq!(status, Some(1), "{said}");
    assert!(said.contains("IMP0747") && said.contains("`--memory 4GB`") && said.contains("changes of speed"), "{said}");
    assert!(!said.contains("IMP0701"), "{said}");
    // A tip at rest under a turn, in inverse time or not, is the fault of the text and is told as such.
    let (status, said) = verify(&with_blocks(&text, [(0.0, 10.0), (0.0, 0.0)].into_iter()));
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("moves only rotary axes") && !said.contains("malformed"), "{said}");
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
    // The job's dialect is the other one: the text is recognised, and its machine is none of LinuxCNC; as an unknown one it is
    // read as the job's.
    std::fs::write(&path, LINUXCNC).unwrap();
    fails("IMP0808", "LinuxCNC needs");
    std::fs::write(&path, "Q1\nG91 G28 Z0\n").unwrap();
    fails("IMP0821", "line 1: `Q1` is not understood");
    std::fs::write(&path, "%\nO1\nG91 G28 Z0\nM30\n%\n").unwrap();
    fails("IMP0821", "line 3: `G28` is not understood: its target is set at the control");
    std::fs::write(&path, SIEMENS.replace("Z350", "Z650")).unwrap();
    fails("IMP0822", "operation 1 of the text uses tool \"t2\"");
    // What is no NC text at all is told once.
    std::fs::copy("jobs/reduced/reduced.imp", &path).unwrap();
    fails("IMP0821", "give NC text");
    assert_eq!(verify(&path).1.matches("give NC text").count(), 1);
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
    (0..3_usize, prop::collection::vec(change, 1..4)).prop_map(|(which, changes)| {
        let mut text = [SIEMENS, LINUXCNC, HEIDENHAIN][which].to_owned();
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
        let post: &dyn Post = nc::POSTS[which];
        match post.read(&text, machine(post.name())) {
            Ok(sections) => {
                for m in sections.iter().flat_map(|s| &s.moves) {
                    prop_assert!(m.tip.iter().all(|x| x.is_finite() && x.abs() <= 1e5));
                    prop_assert!(m.line >= 1 && m.line <= text.lines().count());
                }
                let program = support::flank_only(&[0]);
                let mut sink = Sink::default();
                if let Some(nc) = motion_of(&program, &sections, &|_| Span::default(), &mut sink) {
                    let all: Vec<_> = nc.motion.operations.iter().flat_map(|o| &o.moves).collect();
                    let read = sections.iter().map(|s| s.moves.len() + 2).sum::<usize>();
                    prop_assert!(all.len() <= read && all.len() + 2 >= read);
                    prop_assert_eq!(all.len(), nc.lines.iter().map(Vec::len).sum::<usize>());
                    prop_assert!(all.iter().all(|m| m.time >= 0.0 && m.joints.xyz.iter().all(|x| x.is_finite())));
                } else {
                    prop_assert!(sink.has_errors());
                }
            }
            Err(faults) => {
                prop_assert!(!faults.is_empty() && faults.len() <= MAX_FAULTS);
                for fault in faults {
                    prop_assert!(fault.line >= 1 && fault.line <= text.lines().count().max(1));
                    prop_assert!(!fault.reason.is_empty());
                }
            }
        }
    }
}

/// What switches tool centre point control and is not understood is one fault: moves behind it mean what it would have done.
#[test]
fn nothing_follows_from_a_switch_that_is_not_understood() {
    let cases: [(&str, &str, &[&str]); 5] = [
        (
            "siemens-840d",
            "TRAORI\n",
            &["TRAORI(1,0,0,0)", "TRAORI(99)", "TRAORI(X)", "TRAORI G54", "TRACYL(40)", "L1234", "CYCLE800()"],
        ),
        ("siemens-840d", "TRAFOOF\nN170", &["TRAFOOF(1)\nN170", "TRAFOFF\nN170", "L1235\nN170"]),
        ("linuxcnc", "M428", &["M428.5", "M499", "M128", "G43.4 H1", "M428 Q1", "M428 X1"]),
        ("linuxcnc", "X28 Y-19 Z2 A-32 C-22\nM429", &["X28 Y-19 Z2 A-32 C-22\nM430", "X28 Y-19 Z2 A-32 C-22\nM429 P1"]),
        (
            "heidenhain",
            "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS",
            &[
                "FUNCTION TCPM F CONT AXIS POS PATHCTRL AXIS",
                "FUNCTION TCPM F TCP AXIS SPAT PATHCTRL AXIS",
                "FUNCTION TCPM",
                "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS REFPNT CNT-CNT",
                "M144",
                "CALL PGM TCPM",
            ],
        ),
    ];
    for (dialect, from, all) in cases {
        let text = original(dialect);
        assert!(text.contains(from), "{dialect}: {from}");
        for to in all {
            // The last one in the text: others stand before any move.
            let at = text.rfind(from).unwrap();
            let to = if from.ends_with('\n') && !to.ends_with('\n') { format!("{to}\n") } else { (*to).to_owned() };
            let changed = format!("{}{to}{}", &text[..at], &text[at + from.len()..]);
            let faults = sections(dialect, &changed).expect_err(&to);
            assert_eq!(faults.len(), 1, "{dialect} {to}: {faults:#?}");
        }
    }
}

/// TRAORI(n) is the transformation of the machine file, one in a program.
#[test]
fn transformations_have_numbers() {
    let numbered = |to: &str| SIEMENS.replace("TRAORI\n", &format!("{to}\n"));
    let plain = read("siemens-840d", SIEMENS).unwrap();
    for to in ["TRAORI()", "TRAORI(1)", "TRAORI(2)", "TRAORI( 2 )", "traori(4)"] {
        assert_eq!(read("siemens-840d", &numbered(to)).unwrap(), plain, "{to}");
    }
    for (to, why) in [
        ("TRAORI(0)", "1 to 10"),
        ("TRAORI(11)", "1 to 10"),
        ("TRAORI(1.5)", "TRAORI(1.5)"),
        ("TRAORI(-1)", "TRAORI(-1)"),
        ("TRAORI(1,0,0,1)", "another base orientation"),
        ("TRAORI(,,,,0,0)", "another base orientation"),
        ("TRAORI(1) G54", "alone"),
    ] {
        let faults = read("siemens-840d", &numbered(to)).unwrap_err();
        assert!(faults.len() == 1 && faults[0].reason.contains(why), "{to}: {faults:?}");
    }
}

/// What the interpreter of LinuxCNC refuses within words, numbers and blocks; `linuxcnc_edits` asks it about thousands.
#[test]
fn linuxcnc_words_end_at_comments_and_blocks_have_one_word_of_a_group() {
    for (from, to) in [
        ("X29", "X2(x)9"),
        ("X29", "X(x)29"),
        ("G1 X29", "G(x)1 X29"),
        ("G1 X29", "(x)N10 G1 X29"),
        ("G1 X29", "N1(x)0 G1 X29"),
        ("G1 X29", "N10. G1 X29"),
        ("G1 X29", "N+10 G1 X29"),
        ("(test)", "(test)\n%"),
        ("(test)", "%;x\n(test)"),
        ("G43 H2", "G43 H(x)2"),
        ("M8", "M8 M48 M48"),
        ("M2", "M0 M2"),
        ("G54", "G54 G98 G99"),
        ("G54", "G54 G91.1 G91.1"),
        ("G10 L2 P1 R0", "G1 G10 L2 P1 R0"),
        ("G53 G0 Z350", "G53 G4 P1 G0 Z350"),
        ("M9\nM5", "M9 M5 M48 M1 M429"),
        ("M8", "M8\nT99"),
        ("M8", "G1 M8"),
        ("M8", "G96\nG97\nM8"),
    ] {
        let text = LINUXCNC.replacen(from, to, 1);
        assert_ne!(text, LINUXCNC);
        let faults = read("linuxcnc", &text).expect_err(to);
        assert_eq!(faults.len(), 1, "{to}: {faults:#?}");
    }
    for (from, to) in
        [("X29", "(x)X29(y) (z)"), ("G1 X29", "N010.5(x)G1 X29"), ("X29", "x 2 9 ;c"), ("(test)", "%\n(test)")]
    {
        let text = LINUXCNC.replacen(from, to, 1);
        assert!(read("linuxcnc", &text).is_ok_and(|moves| moves.len() == 4), "{to}");
    }
}
