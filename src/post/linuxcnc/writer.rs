//! From the moves of an operation to blocks.

use super::LinuxCnc;
use crate::diag::{Diag, Sink, codes::post};
use crate::ir::{JointMove, Motion, MotionOperation, MoveKind, Operation, Program};
use crate::kin::Machine;
use crate::method::Planning;
use crate::post::dialect::WriteBlock;
use crate::post::form::{NumberForm, TextForm};
use crate::post::words::{self, feed, fixed, inverse_time};
use crate::post::write;

/// Rotary axes of the kinematics xyzac-trt.
const ROTARY: [&str; 2] = ["A", "C"];

/// Largest tool number of the standard tool table.
const LARGEST_TOOL: u32 = 99_999;

/// Refuses a machine that the transformation of the control does not support.
pub(super) fn check_machine(machine: &Machine, sink: &mut Sink) {
    if machine.planning != Planning::LinuxCnc {
        sink.push(
            Diag::error(
                post::CONTROL,
                format!("the file of machine {} has no `planning = \"linuxcnc-2.9\"`", machine.name),
            )
            .note("joint speeds, times and path deviations would be those of another control")
            .help(
                "use a machine file with `planning = \"linuxcnc-2.9\"`, such as `5mc850-c-linuxcnc`, or another post",
            ),
        );
    }
    let [.., first, second] = machine.names();
    if [first, second] != ROTARY {
        sink.push(
            Diag::error(
                post::CONTROL,
                format!(
                    "the machine {} turns {first} and {second}; this post writes for xyzac-trt kinematics",
                    machine.name
                ),
            )
            .help("use a machine file whose table tilts about A and turns about C, or another post"),
        );
    }
    for axis in &machine.rotary {
        let name = &axis.name;
        if axis.word_sign > 0.0 {
            sink.push(
                Diag::error(
                    post::SENSE,
                    format!("axis {name} of the machine {} has the sense \"iso\"; LinuxCNC needs \"opposite\"", machine.name),
                )
                .note("under xyzac-trt kinematics a positive word turns the work right-handed")
                .help("use a machine file with `sense = \"opposite\"` for both rotary axes if the machine turns so, or another post"),
            );
        }
    }
}

/// Refuses a motion that the dialect cannot express.
pub(super) fn check(program: &Program, motion: &Motion, sink: &mut Sink) {
    check_machine(&program.machine, sink);
    words::check(program, motion, sink);
    for operation in &motion.operations {
        let declared = &program.operations[operation.operation];
        check_smoothing(program, declared, operation, sink);
        let tool = &program.tools[declared.tool];
        if tool.number == 0 || tool.number > LARGEST_TOOL {
            sink.push(
                Diag::error(post::TOOL_NUMBER, format!("tool {} has the number {}", tool.name, tool.number))
                    .label(tool.span, "declared here")
                    .help(format!("LinuxCNC takes numbers from 1 to {LARGEST_TOOL}: `number 1`")),
            );
        }
    }
}

/// Refuses words of smoothing with another tolerance than that of the model of the control.
fn check_smoothing(program: &Program, declared: &Operation, operation: &MotionOperation, sink: &mut Sink) {
    let words = write::smoothing(&LinuxCnc, program, declared, operation);
    let tolerance = fixed(program.tolerances.chord.get(), 4);
    let same = |word: &str| word.strip_prefix('P').is_some_and(|p| p == tolerance);
    if !words.split(' ').any(same) {
        sink.push(
            Diag::error(post::FRAME, format!("`{}` smooths with `{words}`", declared.name))
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
    numbers: NumberForm { prefix: "N", largest: u64::MAX, always: false, comments: false, without: &["%"] },
    continued: "",
    longest: 252,
};

/// Writes the blocks of the moves of an operation.
pub(super) fn moves(program: &Program, operation: &MotionOperation, smoothing: &str, write: &mut WriteBlock<'_>) {
    let mut modes = Modes::default();
    let count = operation.moves.len();
    for (i, m) in write::between(operation) {
        // After the last block M429 waits until the axes rest.
        let stop = m.stop && i + 2 < count;
        if modes.stop && !stop {
            write(smoothing.to_owned(), None);
        }
        write(block(program, m, stop, &mut modes), Some(i));
    }
    if modes.stop {
        write(smoothing.to_owned(), None);
    }
    if modes.inverse {
        write("G94".to_owned(), None);
    }
}

/// Modal state from block to block.
#[derive(Default)]
struct Modes {
    /// G93.
    inverse: bool,
    /// G61.1.
    stop: bool,
    /// F of G94.
    feed: String,
}

fn block(program: &Program, m: &JointMove, stop: bool, modes: &mut Modes) -> String {
    let post = &LinuxCnc;
    let decimals = program.post.decimals.feed;
    let mut text = String::new();
    if stop && !modes.stop {
        text.push_str("G61.1 ");
    }
    modes.stop = stop;
    let inverse = m.kind == MoveKind::Rapid;
    if inverse != modes.inverse {
        text.push_str(if inverse { "G93 " } else { "G94 " });
        // The control forgets F when the feed mode changes.
        modes.feed.clear();
    }
    modes.inverse = inverse;
    let [tip, rotary] = [write::tip(post, program, &m.joints), write::rotary(post, program, m.joints.rotary)];
    text.push_str(&format!("G1 {tip} {rotary}"));
    let f = if inverse { inverse_time(m.time) } else { fixed(feed(m.feed.unwrap_or(0.0), decimals), decimals) };
    if inverse || f != modes.feed {
        text.push_str(&format!(" F{f}"));
        modes.feed = f;
    }
    text
}
