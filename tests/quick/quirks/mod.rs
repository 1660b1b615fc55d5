//! Quirks of controls as goldens: what the writer makes of a few moves, and what the reader says to texts that a control
//! would misunderstand or refuse.

mod apt_cl;
mod fanuc;
mod heidenhain;
mod linuxcnc;
mod modulo;
mod refusals;
mod siemens_840d;
mod splines;

use crate::support::{self, golden};
use impellerc::diagnostics::Sink;
use impellerc::driver::check_frames;
use impellerc::five_axis::{Machine, PoseCurve, TurnCurve};
use impellerc::ir::{JointMove, Motion, MotionOperation, MoveKind, Program, SplineBlock};
use impellerc::job::shipped_post;
use impellerc::nc;
use impellerc::wheel::control::Orientation;
use impellerc::wheel::post_file::Field;
use nalgebra::{Point3, Vector2, Vector3};

/// A quirk of a dialect.
pub struct Quirk {
    /// Name of the golden.
    name: &'static str,
    /// Blocks that show how the writer keeps clear of it.
    written: Vec<String>,
    /// Texts that differ from one that is read: what is replaced, in the first place, by what.
    texts: Vec<(String, &'static str, &'static str)>,
}

/// A text with each of some changes.
fn changed(text: &str, changes: &[(&'static str, &'static str)]) -> Vec<(String, &'static str, &'static str)> {
    changes.iter().map(|(from, to)| (text.to_owned(), *from, *to)).collect()
}

/// A move: tip (mm), rotary axes (degrees), and feed (mm/min) or a rapid.
pub type Step = ([f64; 3], [f64; 2], Option<f64>);

fn program(dialect: &str) -> Program {
    support::program_for(dialect, &support::flank_only(&[0]))
}

/// An operation of a few moves.
fn operation(program: &Program, moves: &[Step]) -> MotionOperation {
    let step = |(tip, rotary, feed): &Step| JointMove {
        kind: if feed.is_some() { MoveKind::Cut } else { MoveKind::Rapid },
        joints: program.machine.joints(&Point3::from(*tip), rotary.map(f64::to_radians)),
        feed: *feed,
        time: 1.0,
        pass: 0,
        stop: false,
    };
    let station = step(&([0.0; 3], [0.0; 2], None));
    let mut all = vec![station];
    all.extend(moves.iter().map(step));
    all.push(station);
    let operation = program.operations.iter().next().unwrap().0;
    MotionOperation { operation, labels: vec![String::new()], moves: all, splines: Vec::new() }
}

/// The blocks of a few moves.
pub fn blocks(dialect: &str, orientation: Orientation, moves: &[Step]) -> Vec<String> {
    let mut program = program(dialect);
    program.post.control.orientation = orientation;
    let mut blocks = Vec::new();
    let operation = operation(&program, moves);
    nc::find(dialect).unwrap().moves(&program, &operation, "", &mut |text, _| blocks.push(text));
    blocks
}

/// The blocks of a cubic.
fn spline_blocks(dialect: &str) -> Vec<String> {
    let mut program = program(dialect);
    let spl = dialect == "heidenhain";
    if spl {
        program.post = shipped_post("heidenhain-itnc530").unwrap();
    }
    let start = ([40.0, 0.0, 10.0], [30.0, 20.0], Some(1800.0));
    let mut operation = operation(&program, &[start, ([36.4, 6.1, 8.3], [32.2, 28.5], Some(1800.0))]);
    let tip = [[40.0, 0.0, 10.0], [39.0, 2.0, 9.2], [37.6, 4.4, 8.7], [36.4, 6.1, 8.3]].map(Vector3::from).to_vec();
    let turn = if spl {
        let angles = [[30.0, 20.0], [30.7, 22.9], [31.5, 25.7], [32.2, 28.5]];
        TurnCurve::Rotary(angles.map(|a| Vector2::from(a.map(f64::to_radians))).to_vec())
    } else {
        TurnCurve::Second(tip.iter().map(|p| p + Vector3::new(5.0, -8.0, 17.0)).collect())
    };
    let curve = PoseCurve::new(tip, turn).unwrap();
    operation.splines.push(SplineBlock { first: 2, last: 2, curve, shares: vec![1.0] });
    let mut blocks = Vec::new();
    nc::find(dialect).unwrap().moves(&program, &operation, "", &mut |text, _| blocks.push(text));
    blocks
}

fn shown(dialect: &str, machine: &Machine, quirk: &Quirk) -> String {
    let post = nc::find(dialect).unwrap();
    let mut golden: Vec<String> = Vec::new();
    if !quirk.written.is_empty() {
        golden.push("written:".to_owned());
        golden.extend(quirk.written.iter().map(|line| format!("    {line}")));
    }
    for (text, from, to) in &quirk.texts {
        assert!(post.read(text, machine).is_ok(), "{}: {:?}", quirk.name, post.read(text, machine));
        let at = text.find(from).unwrap_or_else(|| panic!("{from:?} is not in the text"));
        let changed = text.replacen(from, to, 1);
        let said = match post.read(&changed, machine) {
            Ok(_) => "is read".to_owned(),
            Err(faults) => format!("line {}: {}", faults[0].line, faults[0].reason),
        };
        let first = text[..at].matches('\n').count();
        let lines = changed.lines().skip(first).take(to.matches('\n').count().max(1));
        golden.push("text:".to_owned());
        golden.extend(lines.map(|line| format!("    {line}")));
        golden.push(format!("  {said}"));
    }
    golden.join("\n") + "\n"
}

fn check(dialect: &str, quirks: &[Quirk]) {
    let machine = support::machine_for(dialect, &support::machine());
    for quirk in quirks {
        golden::check("posts", &format!("{}.{dialect}", quirk.name), &shown(dialect, &machine, quirk));
    }
}

#[test]
fn heidenhain() {
    check("heidenhain", &heidenhain::quirks());
    check("heidenhain", &splines::heidenhain());
}

#[test]
fn siemens() {
    check("siemens-840d", &siemens_840d::quirks());
    check("siemens-840d", &splines::siemens());
}

#[test]
fn linuxcnc_trt() {
    check("linuxcnc", &linuxcnc::quirks());
}

/// With M126 an axis without end takes the shorter way: the post refuses what would go the other way.
#[test]
fn half_a_turn_in_one_block_is_refused() {
    let said = |travel: f64, turn: f64| {
        let mut program = program("heidenhain");
        (program.machine.rotary[1].min, program.machine.rotary[1].max) = (-travel, travel);
        let moves = [([50.0, -40.0, 10.0], [30.0, 0.0], None), ([50.0, -40.0, 12.0], [30.0, turn], None)];
        let motion = Motion { operations: vec![operation(&program, &moves)] };
        let mut sink = Sink::default();
        nc::find("heidenhain").unwrap().check(&program, &motion, &mut sink);
        sink.diags().iter().map(|d| d.code.id()).collect::<Vec<_>>()
    };
    assert_eq!(said(50.0, 200.0), ["IMP0811"]);
    assert!(said(50.0, 170.0).is_empty());
    // An axis of at most one turn has no other way.
    assert!(said(3.1, 200.0).is_empty());
}

/// An axis with a clamp is unclamped before it turns: the frames that ship do it, and a frame that does not is refused before
/// planning.
#[test]
fn a_clamped_axis_does_not_turn() {
    for name in ["siemens-840d", "heidenhain", "heidenhain-itnc530", "fanuc", "makino", "mitsubishi"] {
        let mut program = program("siemens-840d");
        program.post = shipped_post(name).unwrap();
        let said = |program: &Program| {
            let mut sink = Sink::default();
            check_frames(program, &mut sink).unwrap();
            sink.diags().iter().map(|d| format!("{} {}", d.code.id(), d.message)).collect::<Vec<_>>()
        };
        assert!(said(&program).is_empty(), "{name}: {:?}", said(&program));
        let clamp = |words: [&str; 2]| Some(words.map(str::to_owned));
        program.machine.rotary[0].clamp = clamp(["M10", "M11"]);
        program.machine.rotary[1].clamp = clamp(["M78", "M79"]);
        assert!(said(&program).is_empty(), "{name}: {:?}", said(&program));
        let [_, _, start, ..] = &mut program.post.frames;
        start.retain(|template| !template.fields().any(|field| field == Field::Unclamp2));
        let refused = said(&program);
        assert!(refused.len() == 1 && refused[0].starts_with("IMP0810"), "{name}: {refused:?}");
        assert!(refused[0].contains("clamped") && refused[0].contains("M79"), "{name}: {refused:?}");
    }
}
