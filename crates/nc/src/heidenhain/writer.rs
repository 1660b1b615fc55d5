//! From the moves of an operation to blocks.

use super::Heidenhain;
use crate::dialect::WriteBlock;
use crate::form::{ModuloForm, NumberForm, TextForm};
use crate::modulo;
use crate::words::{self, fixed};
use crate::write::{self, FeedWord};
use diagnostics::{Diag, Sink, codes::post};
use five_axis::control::ModuloWay;
use five_axis::{RotaryAxis, TurnCurve};
use ir::{Motion, MotionOperation, MoveKind, Program, SplineBlock};
use std::f64::consts::TAU;
use wheel::control::{Orientation, SplineForm, on_step};

/// Largest tool number of the tool table.
const MAX_TOOL_NUMBER: u32 = 32_767;

/// Refuses a motion that the dialect cannot express.
pub(super) fn check(program: &Program, motion: &Motion, sink: &mut Sink) {
    words::check_vectors(program, motion, sink);
    for operation in &motion.operations {
        let declared = &program.operations[operation.operation];
        let tool = &program.tools[declared.tool];
        words::check_tool_number(tool, MAX_TOOL_NUMBER, "the control takes numbers", sink);
    }
    modulo::check_way(program, motion, |axis: &RotaryAxis| axis.max - axis.min > TAU, sink);
    check_spline_axes(program, sink);
}

/// Refuses SPL of an axis modulo 360 deg: no manual that the project knows says how its polynomials count beyond a turn.
fn check_spline_axes(program: &Program, sink: &mut Sink) {
    let axis = program.machine.rotary.iter().find(|axis| axis.modulo.is_some());
    let Some(axis) = axis.filter(|_| program.post.control.spline_form() == Some(SplineForm::Spl)) else { return };
    let text = format!("SPL has polynomials of axis {}, which is modulo 360 deg", axis.name);
    let diag = Diag::error(post::CONTROL, text)
        .note("no manual that the project knows says how such a polynomial counts beyond 360 deg")
        .help("write `path lines` in the post of the job, or `travel` of the axis in the machine file");
    sink.push(words::at(program.post.span, diag));
}

/// Text of the dialect.
pub(super) const FORM: TextForm = TextForm {
    comment: ["; ", ""],
    rotary: "",
    // With M126 the control goes the shorter way, whatever a machine parameter says (user's manual, "Shorter-path traverse
    // of rotary axes: M126").
    modulo: Ok(ModuloForm {
        ways: &[ModuloWay::Shortest, ModuloWay::Direct],
        about: ["", ""],
        assumed: "its display is reduced to values below 360 deg, and M126 makes it go the shorter way",
    }),
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
    let mut feed = FeedWord::new(fixed);
    for (i, m) in write::between(operation) {
        if let Some((_, spline)) = operation.spline(i) {
            if i == spline.first {
                spline_block(program, spline, &feed.word(program, m), &mut |text| write(text, Some(i)));
            }
            continue;
        }
        let tip = write::tip(post, program, &m.joints);
        let rotary = || write::rotary(post, program, m.joints.rotary);
        if m.kind == MoveKind::Rapid {
            feed.forget();
            write(format!("L {tip} {} R0 FMAX", rotary()), Some(i));
            continue;
        }
        let word = feed.word(program, m);
        let text = match program.post.control.orientation {
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
const MAX_COEFFICIENT: f64 = 9.99999999;

/// Writes SPL: the ends of all axes, then the coefficients of the powers 3, 2 and 1 of each, for a parameter that runs from 1
/// to 0. They count from the end of the block before as it is written, since the control refuses a start that is more than
/// 1 um away.
fn spline_block(program: &Program, spline: &SplineBlock, feed: &str, write: &mut dyn FnMut(String)) {
    let TurnCurve::Rotary(turns) = spline.curve.turn() else { return };
    let (digits, machine) = (&program.post.control.decimals, &program.machine);
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
    while mantissa.abs() > MAX_COEFFICIENT {
        mantissa /= 10.0;
        exponent += 1;
    }
    let text = number(mantissa, COEFFICIENT_DECIMALS);
    if exponent == 0 { text } else { format!("{text}E+{exponent}") }
}
