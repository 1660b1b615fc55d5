//! From the moves of an operation to blocks.

use super::LinuxCnc;
use crate::dialect::WriteBlock;
use crate::divided::{Divided, degrees, frame_degrees};
use crate::form::{NumberForm, TextForm};
use crate::modulo;
use crate::words::{self, fixed, inverse_time};
use crate::write::{self, FeedWord};
use base::source::Span;
use diagnostics::{Diag, Sink, codes::post};
use five_axis::control::Planning;
use five_axis::{Carries, Machine};
use ir::repeats::MoveInterval;
use ir::{JointMove, Motion, MotionOperation, MoveKind, Operation, Program};
use nalgebra::Vector3;
use std::ops::Range;

/// A kinematics module of LinuxCNC.
struct Kinematics {
    name: &'static str,
    /// Names of the rotary axes: of the table that tilts, and of the table on it.
    rotary: [&'static str; 2],
    /// Directions that these axes turn about, machine frame.
    directions: [[f64; 3]; 2],
}

/// The kinematics with tool centre point control that the post writes for. In all of them both tables turn the work
/// right-handed with a positive word.
const KINEMATICS: [Kinematics; 2] = [
    Kinematics { name: "xyzac-trt", rotary: ["A", "C"], directions: [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] },
    Kinematics { name: "xyzbc-trt", rotary: ["B", "C"], directions: [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] },
];

/// Largest tool number of the standard tool table.
const MAX_TOOL_NUMBER: u32 = 99_999;

/// Refuses a machine that the transformation of the control does not support.
pub(super) fn check_machine(machine: &Machine, chosen: Option<Span>, sink: &mut Sink) {
    words::check_length_to(machine, chosen, sink);
    modulo::check_machine(&FORM, machine, chosen, sink);
    if machine.planning != Planning::LinuxCnc {
        sink.push(words::at(
            chosen,
            Diag::error(
                post::CONTROL,
                format!("the file of machine {} has no `planning = \"linuxcnc-2.9\"`", machine.name),
            )
            .note("joint speeds, times and path deviations would be those of another control")
            .help(
                "use a machine file with `planning = \"linuxcnc-2.9\"`, such as `5mc850-c-linuxcnc`, or another post",
            ),
        ));
    }
    let Some(kinematics) = kinematics(machine, chosen, sink) else { return };
    for axis in &machine.rotary {
        let name = &axis.name;
        if axis.word_sign > 0.0 {
            sink.push(words::at(
                chosen,
                Diag::error(
                    post::SENSE,
                    format!("axis {name} of the machine {} has the sense \"iso\"; LinuxCNC needs \"opposite\"", machine.name),
                )
                .note(format!("under {} kinematics a positive word turns the work right-handed", kinematics.name))
                .help("use a machine file with `sense = \"opposite\"` for both rotary axes if the machine turns so, or another post"),
            ));
        }
    }
}

/// The kinematics with the rotary axes of a machine; refuses other axes.
fn kinematics(machine: &Machine, chosen: Option<Span>, sink: &mut Sink) -> Option<&'static Kinematics> {
    let [.., first, second] = machine.names();
    let axes = machine.chain.axes();
    let fault = match KINEMATICS.iter().find(|k| k.rotary == [first, second]) {
        None => format!("the machine {} turns {first} and {second}", machine.name),
        Some(_) if axes.iter().any(|axis| axis.carries != Carries::Part) => {
            format!("the machine {} turns the tool", machine.name)
        }
        Some(kinematics) => {
            let other = (0..2).find(|k| axes[*k].direction.into_inner() != Vector3::from(kinematics.directions[*k]));
            let Some(other) = other else { return Some(kinematics) };
            let [x, y, z] = axes[other].direction.into_inner().into();
            let name = kinematics.rotary[other];
            format!("axis {name} of the machine {} has the direction [{x:.4}, {y:.4}, {z:.4}]", machine.name)
        }
    };
    sink.push(words::at(
        chosen,
        Diag::error(post::CONTROL, fault)
            .note(
                "this post writes for the kinematics xyzac-trt and xyzbc-trt of LinuxCNC: a table tilts about X (A) or \
                 Y (B) and carries the table C, which turns about Z",
            )
            .help("use a machine file of such a machine, such as `linuxcnc-xyzac-trt` or `linuxcnc-xyzbc-trt`, or another post"),
    ));
    None
}

/// Refuses a motion that the dialect cannot express.
pub(super) fn check(program: &Program, motion: &Motion, sink: &mut Sink) {
    for operation in &motion.operations {
        let declared = &program.operations[operation.operation];
        check_smoothing(program, declared, operation, sink);
        let tool = &program.tools[declared.tool];
        words::check_tool_number(tool, MAX_TOOL_NUMBER, "LinuxCNC takes numbers", sink);
    }
}

/// Refuses words of smoothing with another tolerance than that of the model of the control.
fn check_smoothing(program: &Program, declared: &Operation, operation: &MotionOperation, sink: &mut Sink) {
    let words = write::smoothing(&LinuxCnc, program, declared, operation);
    let template = &program.post.smoothing[usize::from(!declared.kind.finishes())];
    let tolerance = fixed(program.tolerances.chord.get(), 4);
    let same = |word: &str| word.strip_prefix('P').is_some_and(|p| p == tolerance);
    if !words.split(' ').any(same) {
        sink.push(
            Diag::error(post::FRAME, format!("`{}` smooths with `{words}`", declared.name))
                .label(template.span, "this template")
                .label(declared.span, "in this operation")
                .note(format!("how far LinuxCNC leaves the path was computed with a tolerance of {tolerance} mm"))
                .help("write `G64 P{finish-tolerance} Q0` for finish and rough in the post file"),
        );
    }
}

/// Text of the dialect.
pub(super) const FORM: TextForm = TextForm {
    comment: ["(", ")"],
    rotary: "",
    modulo: Err(
        "the sign of a word gives the direction, so that a word behind which rounding has put the axis means a whole turn more",
    ),
    numbers: NumberForm { prefix: "N", largest: u64::MAX, always: false, comments: false, without: &["%", "o"] },
    continued: "",
    longest: 252,
};

/// Writes the blocks of the moves of an operation.
pub(super) fn moves(program: &Program, operation: &MotionOperation, smoothing: &str, write: &mut WriteBlock<'_>) {
    write_interval(program, operation, 1..operation.moves.len().saturating_sub(1), CallWords::Fixed, smoothing, write);
}

/// Writes the blocks of some moves. Before and behind them the feed mode is G94, and the control smooths.
fn write_interval(
    program: &Program,
    operation: &MotionOperation,
    range: Range<usize>,
    words: CallWords,
    smoothing: &str,
    write: &mut WriteBlock<'_>,
) {
    let mut modes = Modes { inverse: false, stop: false, feed: FeedWord::new(fixed) };
    let count = operation.moves.len();
    for i in range {
        let m = &operation.moves[i];
        // After the last block M429 waits until the axes rest.
        let stop = m.stop && i + 2 < count;
        if modes.stop && !stop {
            write(smoothing.to_owned(), None);
        }
        write(block(program, m, stop, words, &mut modes), Some(i));
    }
    if modes.stop {
        write(smoothing.to_owned(), None);
    }
    if modes.inverse {
        write("G94".to_owned(), None);
    }
}

/// Writes the blocks of an operation, and each subprogram as a subprogram before its first call.
///
/// R of the work offset turns X and Y about the axis of the part. No offset turns rotary axes as well: their words count
/// with the values of the call. So nothing but R remains after an abort, and each operation resets it at its start.
pub(super) fn subprograms(program: &Program, divided: &Divided<'_>, smoothing: &str, write: &mut WriteBlock<'_>) {
    let operation = divided.operation;
    let offset = write::offset_number(&LinuxCnc, program);
    let mut frame = 0;
    let mut turn_frame = |pitches: u32, write: &mut WriteBlock<'_>| {
        if pitches != frame {
            write(format!("G10 L2 P{offset} R{}", frame_degrees(program, pitches)), None);
            frame = pitches;
        }
    };
    let mut written = 0;
    for MoveInterval { moves, repeats } in &divided.division.intervals {
        let Some((subprogram, turned)) = repeats else {
            turn_frame(0, write);
            write_interval(program, operation, moves.clone(), CallWords::Fixed, smoothing, write);
            continue;
        };
        let (name, branches) = (divided.number(*subprogram), divided.changes_branch(*subprogram));
        if *subprogram == written {
            let places = divided.division.places(*subprogram).count();
            let words = if branches { CallWords::BranchOfCall } else { CallWords::ShiftOfCall };
            write(format!("(o{name}: the same in {places} places)"), None);
            write(format!("o{name} sub"), None);
            write_interval(program, operation, moves.clone(), words, smoothing, write);
            write(format!("o{name} endsub"), None);
            written += 1;
        }
        turn_frame(turned.pitches, write);
        let shift = degrees(turned.second.to_degrees() * program.machine.rotary[1].word_sign);
        let branch = if branches { format!(" [{}]", degrees(turned.first)) } else { String::new() };
        write(format!("o{name} call [{shift}]{branch}"), None);
    }
    turn_frame(0, write);
}

/// How blocks state the rotary axes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum CallWords {
    /// Positions.
    Fixed,
    /// Axis 2 counts from the first value of the call.
    ShiftOfCall,
    /// The second value of the call is the sign of axis 1 as well.
    BranchOfCall,
}

/// Modal state from block to block.
struct Modes {
    /// G93.
    inverse: bool,
    /// G61.1.
    stop: bool,
    /// F of G94.
    feed: FeedWord,
}

fn block(program: &Program, m: &JointMove, stop: bool, words: CallWords, modes: &mut Modes) -> String {
    let post = &LinuxCnc;
    let mut text = String::new();
    if stop && !modes.stop {
        text.push_str("G61.1 ");
    }
    modes.stop = stop;
    let inverse = m.kind == MoveKind::Rapid;
    if inverse != modes.inverse {
        text.push_str(if inverse { "G93 " } else { "G94 " });
        // The control forgets F when the feed mode changes.
        modes.feed.forget();
    }
    modes.inverse = inverse;
    let tip = write::tip(post, program, &m.joints);
    let [.., a, b] = program.machine.names();
    let [first, second] = write::rotary_numbers(post, program, m.joints.rotary);
    let rotary = match words {
        CallWords::Fixed => format!("{a}{first} {b}{second}"),
        CallWords::ShiftOfCall => format!("{a}{first} {b}[{second}+#1]"),
        CallWords::BranchOfCall => format!("{a}[{first}*#2] {b}[{second}+#1]"),
    };
    let word = if inverse { format!(" F{}", inverse_time(m.time)) } else { modes.feed.word(program, m) };
    text.push_str(&format!("G1 {tip} {rotary}{word}"));
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use five_axis::{AxisLine, Chain, RotaryAxis};
    use nalgebra::{Point3, Unit};

    /// What is said of a machine of LinuxCNC with these axes.
    fn messages(names: [&str; 2], carries: [Carries; 2], directions: [[f64; 3]; 2], word_sign: f64) -> Vec<String> {
        let line = |k: usize| AxisLine {
            carries: carries[k],
            direction: Unit::new_normalize(Vector3::from(directions[k])),
            point: Point3::new(3.0, -2.0, 7.0),
        };
        let rotary = names.map(|name| RotaryAxis { word_sign, ..RotaryAxis::unlimited(name) });
        let chain = Chain::new([line(0), line(1)]).unwrap();
        let machine = Machine { planning: Planning::LinuxCnc, rotary, ..Machine::unlimited(chain) };
        let mut sink = Sink::default();
        check_machine(&machine, None, &mut sink);
        sink.diags().iter().map(|d| d.message.clone()).collect()
    }

    #[test]
    fn the_axes_of_a_machine_decide_its_kinematics() {
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let tables = [Carries::Part; 2];
        assert!(messages(["A", "C"], tables, [x, z], -1.0).is_empty());
        assert!(messages(["B", "C"], tables, [y, z], -1.0).is_empty());
        let cases = [
            (["A", "B"], tables, [x, y], "turns A and B"),
            (["C", "A"], tables, [y, x], "turns C and A"),
            (["B", "C"], tables, [x, z], "axis B of the machine  has the direction [1.0000, 0.0000, 0.0000]"),
            (["A", "C"], tables, [y, z], "axis A of the machine  has the direction"),
            (["B", "C"], tables, [[0.0, 1.0, 1.0], z], "has the direction [0.0000, 0.7071, 0.7071]"),
            (["A", "C"], tables, [x, [0.0, 0.0, -1.0]], "axis C"),
            (["B", "C"], [Carries::Tool, Carries::Part], [y, z], "turns the tool"),
            (["B", "C"], [Carries::Tool; 2], [y, z], "turns the tool"),
        ];
        for (names, carries, directions, said) in cases {
            let found = messages(names, carries, directions, -1.0);
            assert!(found.len() == 1 && found[0].contains(said), "{said}: {found:?}");
        }
        for names in [["A", "C"], ["B", "C"]] {
            let found = messages(names, tables, [if names[0] == "A" { x } else { y }, z], 1.0);
            assert!(found.len() == 2 && found.iter().all(|f| f.contains("needs \"opposite\"")), "{found:?}");
        }
    }
}
