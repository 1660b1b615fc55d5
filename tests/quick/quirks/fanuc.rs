//! Quirks of the Fanuc family: what is written, and what is said of texts that ignore them.

use crate::support;
use crate::support::golden::check;
use crate::support::pinned::{self, Pinned};
use impellerc::base::source::Span;
use impellerc::diagnostics::Sink;
use impellerc::five_axis::{AxisLine, Carries, Chain, Machine, RotaryAxis};
use impellerc::ir::Program;
use impellerc::nc::{self, NcProgram};
use impellerc::wheel::control::Orientation;
use impellerc::wheel::post_file::Template;
use nalgebra::{Point3, Vector3};

/// An operation that begins with the tables at zero.
pub const PROGRAM: &str = "\
%
O1000 (QUIRKS)
G49
G21 G17 G90 G94 G40 G80 G69 G64 G54
G92.1 X0. Y0. Z0. A0. C0.
G53 G0 Z350.
T2 M6
S8000 M3
G53 G0 A0. C0.
G53 G0 X50. Y-40.
G05.1 Q1
M8
G43.4 H2
G0 X50. Y-40. Z60. A0. C0.
G1 X30. Y-17. Z4. A1. C2. F1000.
X29. Y-18. Z3. A1.5 C2.5 F250.
G49
G05.1 Q0
G53 G0 Z350.
M9
M5
M30
%
";

/// A head that tilts about Y over a table that turns about Z.
fn head() -> Machine {
    let line = |carries, direction| AxisLine { carries, direction, point: Point3::origin() };
    let axes = [line(Carries::Tool, Vector3::y_axis()), line(Carries::Part, Vector3::z_axis())];
    let rotary = ["B", "C"].map(RotaryAxis::unlimited);
    Machine { rotary, retract: 350.0, ..Machine::unlimited(Chain::new(axes).unwrap()) }
}

fn said(dialect: &str, machine: &Machine, text: &str) -> String {
    match nc::find(dialect).unwrap().read(text, machine) {
        Ok(sections) => format!("read, {} moves", sections.iter().map(|s| s.moves.len()).sum::<usize>()),
        Err(faults) => format!("line {}: {}", faults[0].line, faults[0].reason),
    }
}

/// What is said of a text with pieces replaced, a line each.
fn variants(dialect: &str, machine: &Machine, program: &str, changes: &[(&str, &str)]) -> String {
    let mut all = format!("as it is\n    {}\n", said(dialect, machine, program));
    for (from, to) in changes {
        assert!(program.contains(from), "{from:?}");
        let changed = program.replacen(from, to, 1);
        all.push_str(&format!("{from:?} -> {to:?}\n    {}\n", said(dialect, machine, &changed)));
    }
    all
}

fn of(dialect: &str, changes: &[(&str, &str)]) -> String {
    variants(dialect, &support::machine_for(dialect, &support::machine()), PROGRAM, changes)
}

#[test]
fn a_number_without_its_point_has_no_unit() {
    let changes = [("X30.", "X30"), ("A1.", "A1"), ("F250.", "F250"), ("Z350.", "Z350"), ("A0. C0.", "A0 C0")];
    for dialect in ["fanuc", "mitsubishi"] {
        check("posts", &format!("missing-point.{dialect}"), &of(dialect, &changes));
    }
}

#[test]
fn digits_that_the_control_drops_or_refuses() {
    let changes = [
        ("X30.", "X30.1234"),
        ("X30.", "X30.12345"),
        ("X30.", "X30.00000"),
        ("X30.", "X30.000000000"),
        ("A1.", "A1.00001"),
        ("F250.", "F250.1234"),
        ("S8000", "S8000."),
        ("M3", "M3."),
    ];
    check("posts", "digits.fanuc", &of("fanuc", &changes));
}

#[test]
fn programs_have_numbers() {
    let changes = [
        ("O1000 (QUIRKS)", "O1"),
        ("O1000", "O0"),
        ("O1000", "O10000"),
        ("O1000", "O123456789"),
        ("O1000 (QUIRKS)", "<VANE-1>"),
        ("O1000 (QUIRKS)\n", ""),
        ("%\nO1000", "O1000"),
        ("M30\n%\n", "M30\n"),
        ("M30\n", ""),
    ];
    for dialect in ["fanuc", "mitsubishi"] {
        check("posts", &format!("program-number.{dialect}"), &of(dialect, &changes));
    }
}

#[test]
fn the_length_comes_with_tool_centre_point_control() {
    let changes = [
        ("G43.4 H2\n", ""),
        ("G43.4 H2", "G43 H2"),
        ("G43.4 H2", "G43.4"),
        ("G43.4 H2", "G43.4 H1"),
        ("G43.4 H2", "G43.4 X50. Y-40. Z100. H2"),
        ("G43.4 H2", "G43.4 H2\nG43.4 H2"),
        ("G05.1 Q1\nM8\nG43.4 H2\n", "G43.4 H2\nG05.1 Q1\nM8\n"),
        ("G49\nG21", "G21"),
        ("G49\nG05.1 Q0\n", "G05.1 Q0\n"),
        ("G49\nG05.1 Q0\nG53 G0 Z350.\n", "G05.1 Q0\nG53 G0 Z350.\nG49\n"),
    ];
    check("posts", "length-order.fanuc", &of("fanuc", &changes));
}

#[test]
fn a_missing_component_of_a_vector_is_zero_for_the_control() {
    let program = PROGRAM
        .replace("A0. C0.", "B0. C0.")
        .replace("G43.4 H2", "G43.5 H2 P0")
        .replace("Z60. B0. C0.", "Z60.")
        .replace("A1. C2.", "I0.1736 J0. K0.9848")
        .replace("A1.5 C2.5", "I0.1822 J0.002 K0.9833");
    let changes = [
        (" J0. ", " "),
        (" I0.1822 J0.002", ""),
        (" I0.1822 J0.002 K0.9833", ""),
        ("I0.1736", "I0"),
        ("I0.1736 J0. K0.9848", "B10. C0."),
        ("I0.1736 J0. K0.9848", "I0. J0. K0."),
        ("H2 P0", "H2"),
        ("H2 P0", "H2 P0 I0. J0. K1."),
        ("G43.5 H2 P0", "G43.4 H2"),
    ];
    check("posts", "vector-components.fanuc", &variants("fanuc", &head(), &program, &changes));
}

/// The small job as a dialect writes it, with a step of block numbers.
fn written(dialect: &str, step: u32) -> NcProgram {
    let Pinned { program, motion, .. } = pinned::small(dialect);
    let mut program = support::with_post(dialect, program);
    program.post.block_numbers = step;
    nc::emit(nc::find(dialect).unwrap(), &program, motion, &[])
}

#[test]
fn block_numbers_begin_again_before_they_have_too_many_digits() {
    for dialect in ["fanuc", "mitsubishi"] {
        let nc = written(dialect, 1000);
        let lines: Vec<&str> = nc.lines.iter().map(|l| l.text.as_str()).collect();
        let number = |line: &str| line.strip_prefix('N')?.split(' ').next()?.parse::<u32>().ok();
        let numbers: Vec<u32> = lines.iter().filter_map(|l| number(l)).collect();
        assert!(numbers.len() > 1500);
        let again = lines.windows(2).position(|w| number(w[0]) > number(w[1]) && number(w[1]).is_some());
        assert_eq!(again.is_some(), dialect == "mitsubishi");
        let at = again.unwrap_or(2);
        let text = format!("{}\n...\n{}\n", lines[..6].join("\n"), lines[at - 1..at + 3].join("\n"));
        check("posts", &format!("block-numbers.{dialect}"), &text);
        let machine = &pinned::small(dialect).program.machine;
        assert!(nc::find(dialect).unwrap().read(&nc.text(), machine).is_ok());
    }
}

#[test]
fn the_tables_turn_after_the_control_has_fixed_the_frame_to_them() {
    let nc = written("fanuc", 0);
    let lines: Vec<&str> = nc.lines.iter().map(|l| l.text.as_str()).collect();
    let at = lines.iter().position(|l| l.starts_with("G43.4")).unwrap();
    let first = nc.lines.iter().position(|l| l.source == Some((0, 1))).unwrap();
    let text = format!(
        "{}\n...\n{}\n\n{}",
        lines[at - 8..at + 3].join("\n"),
        lines[first - 2..first + 2].join("\n"),
        of(
            "fanuc",
            &[("G53 G0 A0. C0.", "G53 G0 A0. C2."), ("G0 X50. Y-40. Z60. A0. C0.", "G0 X50. Y-40. Z60. A1. C0.")]
        )
    );
    check("posts", "frame-at-switch.fanuc", &text);
}

/// The frames are those of a machine with a head as well, and vectors direct its tool.
#[test]
fn the_trial_of_the_frames_holds_for_a_machine_with_a_head() {
    for (dialect, orientation) in [
        ("fanuc", Orientation::Angles),
        ("fanuc", Orientation::Vectors),
        ("mitsubishi", Orientation::Angles),
        ("mitsubishi", Orientation::Vectors),
    ] {
        let mut program = support::with_post(dialect, &support::flank_only(&[0]));
        program.machine = head();
        program.post.control.orientation = orientation;
        let mut sink = Sink::default();
        nc::trial::check(nc::find(dialect).unwrap(), &program, &mut sink);
        assert!(!sink.has_errors(), "{dialect}: {:?}", sink.diags());
    }
}

/// A frame with a word of the machine builder is refused until the machine file names the word.
#[test]
fn frames_may_have_the_own_words_of_the_machine() {
    let mut program = support::with_post("fanuc", &support::flank_only(&[0]));
    let word = Template::new("M200", Span::default()).unwrap();
    program.post.frames[2].insert(5, word);
    let trial = |program: &Program| {
        let mut sink = Sink::default();
        nc::trial::check(nc::find("fanuc").unwrap(), program, &mut sink);
        sink.diags().first().map(|d| d.message.clone())
    };
    let said = trial(&program).unwrap();
    assert!(said.contains("`M200` is not understood") && said.contains("own-words"), "{said}");
    program.machine.own_words = vec!["M200".to_owned()];
    assert_eq!(trial(&program), None);
}
