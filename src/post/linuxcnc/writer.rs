//! From a motion to NC text.

use crate::diag::{Diag, Sink, codes::post};
use crate::ir::{JointMove, Motion, MoveKind, Program};
use crate::kin::{Joints, Machine};
use crate::method::Planning;
use crate::post::nc::{NcLine, NcProgram};
use crate::post::words::{self, LENGTH_DECIMALS, feed, fixed, inverse_time};

/// Longest line of the interpreter.
const LONGEST_LINE: usize = 252;

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
        let tool = &program.tools[program.operations[operation.operation].tool];
        if tool.number == 0 || tool.number > LARGEST_TOOL {
            sink.push(
                Diag::error(post::TOOL_NUMBER, format!("tool {} has the number {}", tool.name, tool.number))
                    .label(tool.span, "declared here")
                    .help(format!("LinuxCNC takes numbers from 1 to {LARGEST_TOOL}: `number 1`")),
            );
        }
    }
}

/// The program as text.
pub(super) fn emit(program: &Program, motion: &Motion, header: &[String]) -> NcProgram {
    let mut nc = NcProgram::default();
    nc.line(format!("({})", words::comment(&program.name)));
    for line in header {
        nc.line(format!("({})", words::comment(line)));
    }
    for line in ["M429", "G21 G17 G90 G40 G49 G80 G94 G97 G8 G54", "G92.1", "G10 L2 P1 R0"] {
        nc.line(line);
    }
    // Q0 switches the naive cam detector off, which would merge five-axis blocks.
    let smoothing = format!("G64 P{} Q0", fixed(program.tolerances.chord.get(), 4));
    nc.line(smoothing.clone());
    let retract = format!("G53 G0 Z{}", fixed(program.machine.retract, LENGTH_DECIMALS));
    for (o, operation) in motion.operations.iter().enumerate() {
        let declared = &program.operations[operation.operation];
        let tool = &program.tools[declared.tool];
        let machine = &program.machine;
        let Some((first, rest)) = operation.moves.split_first() else { continue };
        let Some((last, between)) = rest.split_last() else { continue };
        let source = |i: usize| Some((u32::try_from(o).unwrap_or(u32::MAX), u32::try_from(i).unwrap_or(u32::MAX)));
        nc.line(format!("({})", words::comment(&declared.name)));
        nc.line(retract.clone());
        nc.line(format!("T{} M6", tool.number));
        nc.line(format!("S{} M3", fixed(declared.speed.get(), 0)));
        nc.line(format!("G53 G0 {}", rotary(machine, &first.joints)));
        let [x, y] = [first.joints.xyz.x, first.joints.xyz.y].map(|x| fixed(x, LENGTH_DECIMALS));
        nc.lines.push(NcLine { text: format!("G53 G0 X{x} Y{y}"), source: source(0) });
        nc.line(format!("G43 H{}", tool.number));
        nc.line("M8");
        nc.line("M428");
        let mut modes = Modes::default();
        for (i, m) in between.iter().enumerate() {
            // After the last block M429 waits until the axes rest.
            let stop = m.stop && i + 1 < between.len();
            if modes.stop && !stop {
                nc.line(smoothing.clone());
            }
            let text = block(machine, m, stop, &mut modes);
            debug_assert!(text.len() <= LONGEST_LINE);
            nc.lines.push(NcLine { text, source: source(i + 1) });
        }
        if modes.stop {
            nc.line(smoothing.clone());
        }
        if modes.inverse {
            nc.line("G94");
        }
        nc.line("M429");
        nc.line("G49");
        let height = last.joints.xyz.z + tool.length();
        nc.lines.push(NcLine {
            text: format!("G53 G0 Z{}", fixed(height, LENGTH_DECIMALS)),
            source: source(between.len() + 1),
        });
        nc.line("M9");
        nc.line("M5");
    }
    nc.line("M2");
    nc
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

fn block(machine: &Machine, m: &JointMove, stop: bool, modes: &mut Modes) -> String {
    let p = machine.forward(&m.joints).tip;
    let w = |x: f64| fixed(x, LENGTH_DECIMALS);
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
    text.push_str(&format!("G1 X{} Y{} Z{} {}", w(p.x), w(p.y), w(p.z), rotary(machine, &m.joints)));
    let f = if inverse { inverse_time(m.time) } else { feed(m.feed.unwrap_or(0.0)) };
    if inverse || f != modes.feed {
        text.push_str(&format!(" F{f}"));
        modes.feed = f;
    }
    text
}

/// Rotary words in the sense of the machine.
fn rotary(machine: &Machine, joints: &Joints) -> String {
    words::rotary(machine, joints, "")
}
