//! LinuxCNC with the xyzac-trt kinematics.
//!
//! M428 switches tool centre point kinematics on, M429 off (remaps of the trt simulations). The words A and C have the
//! opposite of the ISO sense. Feed is G94: under these kinematics X Y Z are the tip in the part frame, so that F is the
//! feed of the tip, as in the motion; all blocks at feed move the tip. Every block carries all five words.

use super::words::{self, ANGLE_DECIMALS, LENGTH_DECIMALS, feed, fixed};
use super::{NcLine, NcMove, NcProgram, Post, ReadError, read_linuxcnc};
use crate::diag::{Diag, Sink, codes::post};
use crate::ir::{JointMove, Motion, MoveKind, Program};
use crate::kin::{Joints, Machine};
use crate::verify::Verified;

/// The dialect.
pub(super) struct LinuxCnc;

/// Longest line that the interpreter takes.
const LONGEST_LINE: usize = 252;

/// Largest tool number of the standard tool table.
const LARGEST_TOOL: u32 = 99_999;

impl Post for LinuxCnc {
    fn name(&self) -> &'static str {
        "linuxcnc"
    }

    fn about(&self) -> &'static str {
        "LinuxCNC with xyzac-trt kinematics: M428, rotary words, G94"
    }

    fn check(&self, program: &Program, motion: &Motion, sink: &mut Sink) {
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

    fn emit(&self, program: &Program, motion: &Verified<Motion>, header: &[String]) -> NcProgram {
        emit(program, motion.get(), header)
    }

    fn read(&self, text: &str, _machine: &Machine) -> Result<Vec<NcMove>, Vec<ReadError>> {
        read_linuxcnc::read(text)
    }

    fn recognises(&self, code: &str) -> bool {
        const OWN: [&str; 6] = ["M428", "M429", "G43", "G53", "G64", "G21"];
        let mut words = code.split_whitespace();
        let first = words.next().unwrap_or_default().to_ascii_uppercase();
        // On the other control rotary words have an equals sign.
        let number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+');
        let rotary = |w: &str| w.strip_prefix(['A', 'C']).is_some_and(|n| !n.is_empty() && n.chars().all(number));
        OWN.contains(&first.as_str()) || words.any(rotary)
    }
}

fn emit(program: &Program, motion: &Motion, header: &[String]) -> NcProgram {
    let mut nc = NcProgram::default();
    nc.line(format!("({})", words::comment(&program.name)));
    for line in header {
        nc.line(format!("({})", words::comment(line)));
    }
    // Q0: the naive cam detector would merge five-axis blocks.
    let chord = fixed(program.tolerances.chord.get(), 4);
    nc.line(format!("G21 G17 G90 G40 G49 G80 G94 G54 G64 P{chord} Q0"));
    for (o, operation) in motion.operations.iter().enumerate() {
        let declared = &program.operations[operation.operation];
        let tool = &program.tools[declared.tool];
        nc.line(format!("({})", words::comment(&declared.name)));
        nc.line("M429");
        nc.line("G53 G0 Z0");
        nc.line(format!("T{} M6", tool.number));
        nc.line(format!("G43 H{}", tool.number));
        nc.line(format!("S{} M3", fixed(declared.speed.get(), 0)));
        nc.line("M8");
        if let Some(first) = operation.moves.first() {
            nc.line(format!("G0 {}", rotary(&first.joints)));
        }
        nc.line("M428");
        let mut last_feed = String::new();
        for (i, m) in operation.moves.iter().enumerate() {
            let source = Some((u32::try_from(o).unwrap_or(u32::MAX), u32::try_from(i).unwrap_or(u32::MAX)));
            let text = block(program, m, &mut last_feed);
            debug_assert!(text.len() <= LONGEST_LINE);
            nc.lines.push(NcLine { text, source });
        }
        nc.line("M429");
        nc.line("G53 G0 Z0");
        nc.line("M9");
        nc.line("M5");
    }
    nc.line("M2");
    nc
}

fn block(program: &Program, m: &JointMove, last_feed: &mut String) -> String {
    let p = program.machine.forward(&m.joints).tip;
    let w = |x: f64| fixed(x, LENGTH_DECIMALS);
    let words = format!("X{} Y{} Z{} {}", w(p.x), w(p.y), w(p.z), rotary(&m.joints));
    if m.kind == MoveKind::Rapid {
        return format!("G0 {words}");
    }
    let f = feed(m.feed.unwrap_or(0.0));
    if f == *last_feed {
        return format!("G1 {words}");
    }
    let text = format!("G1 {words} F{f}");
    *last_feed = f;
    text
}

/// Rotary words: the opposite of the ISO sense.
fn rotary(joints: &Joints) -> String {
    let w = |x: f64| fixed(-x.to_degrees(), ANGLE_DECIMALS);
    format!("A{} C{}", w(joints.a), w(joints.c))
}
