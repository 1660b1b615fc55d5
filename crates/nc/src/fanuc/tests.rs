//! Texts as a reader meets them: what is understood, and the reason for what is not.

use super::control::{FANUC, MITSUBISHI, Member};
use super::reader;
use crate::nc::{Direction, NcPlace, NcRetract, NcSection};
use five_axis::{Angles, AxisLine, Carries, Chain, Interpolation, Joints, Machine, RotaryAxis};
use nalgebra::{Point3, Vector3};

const TOOL: f64 = 120.0;

/// A C table on an A table, with tools changed at Z350.
fn machine() -> Machine {
    Machine { retract: 350.0, part_origin: Vector3::new(0.0, 0.0, 50.0), ..Machine::unlimited(Chain::tilting_table()) }
}

/// A B head over a C table.
fn head() -> Machine {
    let line = |carries, direction| AxisLine { carries, direction, point: Point3::origin() };
    let axes = [line(Carries::Tool, Vector3::y_axis()), line(Carries::Part, Vector3::z_axis())];
    let rotary = ["B", "C"].map(RotaryAxis::unlimited);
    Machine { rotary, retract: 350.0, ..Machine::unlimited(Chain::new(axes).unwrap()) }
}

/// Blocks that turn the tables to some angles (deg) over X50 Y-40, in steps.
fn turns(machine: &Machine, to: Angles, step: f64) -> String {
    let count = (to[0].abs().max(to[1].abs()) / step).ceil() as u32;
    let blocks = (1..=count).map(|k| {
        let rotary = to.map(|angle| angle * f64::from(k) / f64::from(count));
        let xyz = Vector3::new(50.0, -40.0, machine.retract - TOOL);
        let p = machine.forward(&Joints { xyz, rotary: rotary.map(f64::to_radians) }).tip;
        format!("G0 X{:.4} Y{:.4} Z{:.4} A{:.4} C{:.4}\n", p.x, p.y, p.z, rotary[0], rotary[1])
    });
    blocks.collect()
}

/// A program with one operation at A30 C20.
fn program(turns: &str) -> String {
    format!(
        "%\nO1000 (TEST)\nG21 G17 G90 G94 G40 G49 G80 G69 G64 G54\nG92.1 X0. Y0. Z0. A0. C0.\nG53 G0 Z350.\nT2 M6\n\
         S8000 M3\nG53 G0 A0. C0.\nG53 G0 X50. Y-40.\nG05.1 Q1 R2\nM8\nG43.4 H2\n{turns}\
         G0 X30. Y-20. Z10. A30. C20.\nG1 X30. Y-17. Z4. A30. C20. F1000.\nX29. Y-18. Z3. A31. C21. F250.\n\
         X28. Y-19. Z2. A32. C22.\nG49\nG53 G0 Z350. M9\nM5\nM30\n%\n"
    )
}

fn good() -> String {
    program(&turns(&machine(), [30.0, 20.0], 1.0))
}

/// The sections of a text, or the first fault.
fn read_for(member: &Member, text: &str) -> Result<Vec<NcSection>, (usize, String)> {
    reader::read(text, &machine(), "G54", member).map_err(|faults| (faults[0].line, faults[0].reason.clone()))
}

fn sections(text: &str) -> Vec<NcSection> {
    read_for(&FANUC, text).unwrap()
}

/// Asserts that a text is refused, with a part of the first reason.
fn refused(text: &str, part: &str) {
    match read_for(&FANUC, text) {
        Ok(_) => panic!("accepted, not refused with {part:?}:\n{text}"),
        Err((line, reason)) => assert!(reason.contains(part), "{part:?} in line {line}: {reason}"),
    }
}

/// The text with its first occurrence of a piece replaced.
fn with(from: &str, to: &str) -> String {
    let text = good();
    assert!(text.contains(from), "{from:?}");
    text.replacen(from, to, 1)
}

#[test]
fn a_program_is_read() {
    let sections = sections(&good());
    let [section] = sections.as_slice() else { panic!("{} sections", sections.len()) };
    let NcPlace::Axes { xyz, rotary, turned } = section.start.place else { panic!("axes") };
    let [a, c] = rotary.map(f64::to_degrees);
    assert!((a - 30.0).abs() < 1e-9 && (c - 20.0).abs() < 1e-9, "{a} {c}");
    assert_eq!(xyz, Vector3::new(50.0, -40.0, 350.0));
    let turned = turned.unwrap();
    assert!((turned - Vector3::new(50.0, -40.0, 230.0)).amax() < 1e-3, "{turned}");
    assert_eq!(section.moves.len(), 4);
    let last = &section.moves[3];
    assert_eq!(
        (last.tip, last.rapid, last.feed, last.smoothing),
        (Point3::new(28.0, -19.0, 2.0), false, Some(250.0), None)
    );
    assert_eq!(last.interpolation, Interpolation::RotaryLinear);
    assert!(section.retract.is_some_and(|(_, z)| z == NcRetract::Height(350.0)));
}

#[test]
fn the_table_stands_at_zero_where_the_control_fixes_the_frame() {
    let turned = with("G53 G0 A0. C0.", "G53 G0 A0. C20.");
    refused(&turned, "the control fixes the work frame to the table");
    // One block that turns the table as far is a motion of the linear axes.
    let at_once = program(&turns(&machine(), [30.0, 20.0], 40.0));
    assert!(matches!(sections(&at_once)[0].start.place, NcPlace::Axes { turned: None, .. }));
    // A head does not carry the part.
    let text = "G21 G17 G90 G94 G40 G49 G69 G64 G54\nG92.1 X0. Y0. Z0. B0. C0.\nG53 G0 Z350.\nT1 M6\nS900 M3\n\
                G53 G0 B30. C0.\nG53 G0 X5. Y5.\nG05.1 Q1\nM8\nG43.4 H1\nG0 X0. Y0. Z99. B30. C0.\nG1 Z9. F90.\nG49\n\
                G53 G0 Z350.\nM9\nM5\nM30\n%\n";
    let text = format!("%\nO1\n{text}");
    assert!(reader::read(&text, &head(), "G54", &FANUC).is_ok_and(|s| s[0].moves.len() == 2));
    let turned = text.replacen("B30. C0.", "B30. C9.", 1);
    let faults = reader::read(&turned, &head(), "G54", &FANUC).unwrap_err();
    assert!(faults[0].reason.contains("with C at 9 deg"), "{}", faults[0].reason);
}

#[test]
fn numbers_need_their_point_and_no_more_digits_than_the_control_takes() {
    for (from, to) in [("X30. Y-17.", "X30 Y-17."), ("A31.", "A31"), ("F250.", "F250"), ("Z350.", "Z350")] {
        refused(&with(from, to), "without a decimal point the unit depends on a setting of the control");
    }
    assert!(read_for(&FANUC, &with("A0. C0.", "A0 C0")).is_ok());
    refused(&with("X29.", "X29.00001"), "5 decimals, and the control takes 4");
    assert!(read_for(&FANUC, &with("X29.", "X+29.00000")).is_ok());
    refused(&with("X29.", "X29.000000000"), "more than 9 digits");
    refused(&with("S8000", "S8000."), "not a whole number");
    refused(&with("M3\n", "M3.\n"), "is no word of the control");
    let coarse = Member { decimals: 3, ..FANUC };
    assert!(read_for(&coarse, &good()).unwrap_err().1.contains("the control takes 3"));
}

#[test]
fn vectors_are_complete_and_follow_g43_5() {
    let vectors = |block: &str| {
        format!(
            "%\nO1\nG21 G17 G90 G94 G40 G49 G69 G64 G54\nG92.1 X0. Y0. Z0. B0. C0.\nG53 G0 Z350.\nT1 M6\nS900 M3\n\
             G53 G0 B30. C0.\nG53 G0 X5. Y5.\nG05.1 Q1\nM8\n{block}\nG0 X0. Y0. Z99.\nG1 Z9. I.5 J0. K.866 F90.\nG49\n\
             G53 G0 Z350.\nM9\nM5\nM30\n%\n"
        )
    };
    let read = |text: &str, member: &Member| {
        reader::read(text, &head(), "G54", member).map_err(|faults| faults[0].reason.clone())
    };
    let found = read(&vectors("G43.5 H1 P0"), &FANUC).unwrap();
    assert!(matches!(found[0].moves[1].direction, Direction::Axis(axis) if axis.x > 0.49));
    assert_eq!(found[0].moves[1].interpolation, Interpolation::RotaryLinear);
    let circle = read(&vectors("G43.5 H1 P1"), &FANUC).unwrap();
    assert_eq!(circle[0].moves[1].interpolation, Interpolation::GreatCircle);
    assert!(read(&vectors("G43.5 H1"), &MITSUBISHI).is_ok());
    let reason = |text: String, member: &Member| read(&text, member).unwrap_err();
    assert!(reason(vectors("G43.5 H1"), &FANUC).contains("write P0"));
    assert!(reason(vectors("G43.5 H1 P0"), &MITSUBISHI).contains("the control has no such word"));
    assert!(reason(vectors("G43.4 H1"), &FANUC).contains("only after G43.5"));
    assert!(reason(vectors("G43.5 H1 P0 I0. J0. K1."), &FANUC).contains("PS5421"));
    assert!(reason(vectors("G43.5 H1 P0 B30."), &FANUC).contains("not tool centre point control"));
    assert!(reason(vectors("G43.5 H1 P0").replace(" J0.", ""), &FANUC).contains("takes a missing one as 0"));
    assert!(reason(vectors("G43.5 H1 P0").replace("J0.", "C0."), &FANUC).contains("incomplete"));
    assert!(
        reason(vectors("G43.5 H1 P0").replace("I.5 J0. K.866", "B30."), &FANUC).contains("a rotary word after G43.5")
    );
}

#[test]
fn the_tape_has_marks_a_number_and_an_end() {
    refused(&with("%\n", ""), "does not begin with `%`");
    refused(&with("O1000 (TEST)\n", ""), "must be the program number");
    refused(&with("O1000", "O0000"), "no program number");
    refused(&with("O1000", "O10000"), "no program number");
    assert!(read_for(&MITSUBISHI, &with("O1000", "O12345678").replace(" R2", "")).is_ok());
    assert!(read_for(&FANUC, &with("O1000 (TEST)", "<VANE-1.X>")).is_ok());
    assert!(read_for(&MITSUBISHI, &with("O1000 (TEST)", "<VANE>")).is_err());
    refused(&with("M30\n%", "M30"), "without `%` in its last line");
    refused(&with("M30\n%", "%"), "`%` before M30");
    refused(&with("%\n", "%\n%\n"), "`%` before M30");
    refused(&format!("{}X1.\n", good()), "text after the end");
    refused(&with("M30\n", "M30\nM30\n"), "text after the end");
    assert!(read_for(&FANUC, &good().replace('\n', "\r\n")).is_ok());
    assert!(read_for(&FANUC, &with("G21 ", "N99999999 G21 ")).is_ok());
    refused(&with("G21 ", "N0 G21 "), "no block number");
    refused(&with("G21 ", "N123456789 G21 "), "no block number");
    assert!(read_for(&MITSUBISHI, &with("G21 ", "N1234567 G21 ")).unwrap_err().1.contains("1 to 6 digits"));
    refused(&with("G21 ", "g21 "), "capital letters");
    refused(&with("G21 ", "/G21 "), "depends on a switch");
    refused(&with("(TEST)", "(50%)"), "the end of the text");
    refused(&with("G21 ", "#1=5\nG21 "), "macro");
    refused(&with("G21 ", "IF[#1EQ2]GOTO5\nG21 "), "macro statements");
    refused(&with("G21 ", "GOTO5\nG21 "), "macro statements");
}

#[test]
fn words_stand_where_their_meaning_is_certain() {
    refused(&with("G43.4 H2", "G43.4 Z300. H2"), "not tool centre point control");
    refused(&with("G43.4 H2", "G43.4"), "without H");
    refused(&with("G43.4 H2", "G43.4 H0"), "sets no length");
    refused(&with("G43.4 H2", "G43.4 H1"), "with the length of another tool");
    refused(&with("G43.4 H2", "G43.4 H2 M8"), "write G43.4 and H alone");
    refused(&with("G43.4 H2", "G43 H2"), "without tool centre point control");
    refused(&with("G49\nG53", "G53"), "write G49 before this block");
    refused(&with(" G49", ""), "write G49");
    refused(&with("G05.1 Q1 R2\nM8\nG43.4 H2\n", "M8\nG43.4 H2\nG05.1 Q1\n"), "write G49 before");
    refused(&with("G05.1 Q1 R2\n", ""), "write G05.1 Q1 before");
    refused(&with("G05.1 Q1 R2", "G05.1 Q1 R11"), "1 to 10");
    refused(&with("G05.1 Q1 R2", "G05.1 Q3"), "another Q");
    assert!(read_for(&MITSUBISHI, &with("G05.1 Q1 R2", "G05 P10000")).is_ok());
    assert!(read_for(&MITSUBISHI, &good()).unwrap_err().1.contains("R in the block"));
    refused(&with("G92.1 X0. Y0. Z0. A0. C0.\n", ""), "G92.1");
    refused(&with("G92.1 X0. Y0. Z0. A0. C0.", "G92.1 X0. Y0. Z0."), "G92.1 is understood as");
    refused(&with("G92.1 X0.", "G92.1 X5."), "G92.1 is understood as");
    refused(&with(" G94", " G93"), "G93");
    refused(&with("G53 G0 Z350. M9", "G91 G28 Z0. M9"), "set at the control");
    refused(&with("Z3. A31. C21. F250.", "Z3. A31. C21. F250. M8"), "depends on the machine");
    refused(&with("S8000 M3", "S8000 M3 M8"), "two M words");
    refused(&with(" G17", " G17 G17"), "both set");
    refused(&with("X29.", "X29. X29."), "twice");
    refused(&with("M30", "M99"), "subprograms");
    refused(&with("M5\n", ""), "spindle on");
}

#[test]
fn words_of_the_machine_builder_are_those_of_the_machine_file() {
    let text = with("M8\n", "M8\nM0200\n");
    refused(&text, "add it to `own-words` of the machine file");
    let machine = Machine { own_words: vec!["M200".to_owned()], ..machine() };
    assert!(reader::read(&text, &machine, "G54", &FANUC).is_ok());
    let added = with("F250.", "F250. M200");
    let faults = reader::read(&added, &machine, "G54", &FANUC).unwrap_err();
    assert!(faults[0].reason.contains("depends on the machine"), "{}", faults[0].reason);
}
