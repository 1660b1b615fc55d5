//! From the moves of an operation to blocks.

use super::Heidenhain;
use crate::diag::{Diag, Sink, codes::post};
use crate::ir::{Motion, MotionOperation, MoveKind, Program, SplineBlock};
use crate::kin::TurnCurve;
use crate::post::dialect::WriteBlock;
use crate::post::form::{NumberForm, TextForm};
use crate::post::words::{self, feed, fixed};
use crate::post::write;
use crate::post_file::{Orientation, on_step};
use std::f64::consts::{PI, TAU};

/// Largest tool number of the tool table.
const LARGEST_TOOL: u32 = 32_767;

/// Refuses a motion that the dialect cannot express.
pub(super) fn check(program: &Program, motion: &Motion, sink: &mut Sink) {
    words::check(program, motion, sink);
    words::check_vectors(program, motion, sink);
    for operation in &motion.operations {
        let declared = &program.operations[operation.operation];
        let tool = &program.tools[declared.tool];
        words::check_tool_number(tool, LARGEST_TOOL, "the control takes numbers", sink);
        check_way(program, operation, sink);
    }
}

/// Refuses half a turn in one block: with M126 an axis without end takes the shorter way.
fn check_way(program: &Program, operation: &MotionOperation, sink: &mut Sink) {
    let machine = &program.machine;
    let declared = &program.operations[operation.operation];
    for (k, axis) in machine.rotary.iter().enumerate().filter(|(_, axis)| axis.max - axis.min > TAU) {
        let far = operation.moves.windows(2).find(|m| (m[1].joints.rotary[k] - m[0].joints.rotary[k]).abs() >= PI);
        let Some(m) = far else { continue };
        let turn = (m[1].joints.rotary[k] - m[0].joints.rotary[k]).to_degrees().abs();
        let label = operation.labels.get(m[1].pass as usize).cloned().unwrap_or_default();
        sink.push(
            Diag::error(
                post::LONG_TURN,
                format!("`{}` turns {} by {turn:.1} deg in one block", declared.name, axis.name),
            )
            .label(declared.span, "in this operation")
            .place(label, machine.forward(&m[1].joints).tip)
            .note("with M126 the axis takes the shorter way, which is the other direction")
            .help("let the axis travel one turn at most in the machine file, or use another post"),
        );
    }
}

/// Text of the dialect.
pub(super) const FORM: TextForm = TextForm {
    comment: ["; ", ""],
    rotary: "",
    numbers: NumberForm { prefix: "", largest: u64::MAX, always: true, comments: true, without: &[] },
    continued: "~",
    longest: 128,
};

/// A number with its sign.
pub(super) fn number(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if text.starts_with('-') { text } else { format!("+{text}") }
}

/// Writes the blocks of the moves of an operation.
pub(super) fn moves(program: &Program, operation: &MotionOperation, write: &mut WriteBlock<'_>) {
    let post = &Heidenhain;
    let decimals = program.post.decimals.feed;
    let mut last_feed = String::new();
    for (i, m) in write::between(operation) {
        if let Some((_, spline)) = operation.spline(i) {
            if i == spline.first {
                let f = fixed(feed(m.feed.unwrap_or(0.0), decimals), decimals);
                let word = if f == last_feed { String::new() } else { format!(" F{f}") };
                last_feed = f;
                spline_block(program, spline, &word, &mut |text| write(text, Some(i)));
            }
            continue;
        }
        let tip = write::tip(post, program, &m.joints);
        let rotary = || write::rotary(post, program, m.joints.rotary);
        if m.kind == MoveKind::Rapid {
            // After a rapid F is written again, so that every pass can be read by itself.
            last_feed.clear();
            write(format!("L {tip} {} R0 FMAX", rotary()), Some(i));
            continue;
        }
        let f = fixed(feed(m.feed.unwrap_or(0.0), decimals), decimals);
        let word = if f == last_feed { String::new() } else { format!(" F{f}") };
        last_feed = f;
        let text = match program.post.orientation {
            Orientation::Angles => format!("L {tip} {}{word}", rotary()),
            // LN has nothing modal: every block has all six words.
            Orientation::Vectors => {
                format!("LN {tip} {}{word}", write::vector(post, program, &m.joints, ["TX", "TY", "TZ"]))
            }
        };
        write(text, Some(i));
    }
}

/// Digits behind the point of the coefficients of a spline, and the largest without an exponent (iTNC 530).
const COEFFICIENT_DECIMALS: usize = 8;
const LARGEST_COEFFICIENT: f64 = 9.99999999;

/// Writes SPL: the ends of all axes, then the coefficients of the powers 3, 2 and 1 of each, for a parameter that runs from 1
/// to 0. They count from the end of the block before as it is written, since the control refuses a start that is more than
/// 1 um away.
fn spline_block(program: &Program, spline: &SplineBlock, feed: &str, write: &mut dyn FnMut(String)) {
    let TurnCurve::Rotary(turns) = spline.curve.turn() else { return };
    let (digits, machine) = (&program.post.decimals, &program.machine);
    let word = |k: usize| -> (String, [f64; 4], usize) {
        if k < 3 {
            let points: [f64; 4] = std::array::from_fn(|j| spline.curve.tip()[j][k]);
            (["X", "Y", "Z"][k].to_owned(), points, digits.length)
        } else {
            let axis = &machine.rotary[k - 3];
            let points = std::array::from_fn(|j| turns[j][k - 3].to_degrees() * axis.word_sign);
            (axis.name.clone(), points, digits.angle)
        }
    };
    let mut ends = String::new();
    let mut lines = Vec::new();
    for k in 0..5 {
        let (name, [p0, p1, p2, p3], decimals) = word(k);
        let (start, end) = (on_step(p0, decimals), on_step(p3, decimals));
        let coefficient = |value: f64| on_step(value, COEFFICIENT_DECIMALS);
        let (third, second) = (coefficient(p0 - 3.0 * p1 + 3.0 * p2 - p3), coefficient(3.0 * (p1 - 2.0 * p2 + p3)));
        let first = start - end - third - second;
        ends.push_str(&format!(" {name}{}", number(end, decimals)));
        let [third, second, first] = [third, second, first].map(scaled);
        lines.push(format!("  K3{name}{third} K2{name}{second} K1{name}{first}"));
    }
    write(format!("SPL{ends} ~"));
    let last = lines.len() - 1;
    for (k, line) in lines.into_iter().enumerate() {
        write(if k == last { format!("{line}{feed}") } else { format!("{line} ~") });
    }
}

/// A coefficient, with an exponent where it is large.
fn scaled(value: f64) -> String {
    let mut exponent = 0;
    let mut mantissa = value;
    // Rounding must not lead beyond the largest mantissa.
    while mantissa.abs() > LARGEST_COEFFICIENT {
        mantissa /= 10.0;
        exponent += 1;
    }
    let text = number(mantissa, COEFFICIENT_DECIMALS);
    if exponent == 0 { text } else { format!("{text}E+{exponent}") }
}
