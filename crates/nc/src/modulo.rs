//! Rotary axes whose words a control reduces modulo 360 deg: which of them a post takes, and what it writes.
//!
//! The words are from 0 to 360 deg, and the control goes the shorter way to each. That is the way of the motion as long as
//! no block turns such an axis by half a turn.

use super::form::{ModuloForm, TextForm};
use super::words;
use base::source::Span;
use diagnostics::{Diag, Sink, codes::post};
use five_axis::{Machine, RotaryAxis};
use ir::{Motion, MotionOperation, Program};
use std::f64::consts::PI;
use wheel::control::on_step;

/// Degrees of a turn.
const FULL_TURN_DEG: f64 = 360.0;

/// Share of half a turn that the rounding of the words of two blocks can take, radians: one step of two decimals.
const TURN_ROUNDING_RAD: f64 = 2e-4;

/// Refuses an axis modulo 360 deg for which the dialect knows no words, or whose control turns by another rule.
pub(super) fn check_machine(form: &TextForm, machine: &Machine, chosen: Option<Span>, sink: &mut Sink) {
    for axis in &machine.rotary {
        let (Some(way), name) = (axis.modulo, &axis.name) else { continue };
        let why = match &form.modulo {
            Ok(known) if known.ways.contains(&way) => continue,
            Ok(known) => {
                let ways: Vec<String> = known.ways.iter().map(|way| format!("\"{}\"", way.name())).collect();
                format!("this post takes `way` {}; the machine file says \"{}\"", ways.join(" and "), way.name())
            }
            Err(why) => (*why).to_owned(),
        };
        let text =
            format!("this post does not write axis {name} of the machine {}, which is modulo 360 deg", machine.name);
        sink.push(words::at(
            chosen,
            Diag::error(post::CONTROL, text)
                .note(why)
                .note("the control would reduce the word, and may turn the axis the other way")
                .help(format!(
                    "write `travel` of {name} in the machine file if the control permits it, such as [\"-3600 deg\", \"3600 deg\"]"
                )),
        ));
    }
}

/// What must be set at the control for the axes modulo 360 deg of a machine, a line each.
pub(super) fn assumptions(form: &TextForm, machine: &Machine) -> Vec<String> {
    let Ok(ModuloForm { assumed, .. }) = &form.modulo else { return Vec::new() };
    let axes = machine.rotary.iter().filter(|axis| axis.modulo.is_some());
    axes.map(|axis| format!("{} is an axis modulo 360 deg: {assumed}", axis.name)).collect()
}

/// The word, degrees, of an angle in radians; for an axis modulo 360 deg from 0 to below a turn.
pub(super) fn degrees(axis: &RotaryAxis, angle: f64, decimals: usize) -> f64 {
    let word = angle.to_degrees() * axis.word_sign;
    if axis.modulo.is_none() {
        return word;
    }
    let within = on_step(on_step(word, decimals).rem_euclid(FULL_TURN_DEG), decimals);
    if within >= FULL_TURN_DEG { 0.0 } else { within }
}

/// Refuses half a turn in one block of the axes for which the control takes the shorter way.
pub(super) fn check_way(
    program: &Program,
    motion: &Motion,
    takes_shorter: impl Fn(&RotaryAxis) -> bool,
    sink: &mut Sink,
) {
    for operation in &motion.operations {
        for (k, _) in program.machine.rotary.iter().enumerate().filter(|(_, axis)| takes_shorter(axis)) {
            check_axis(program, operation, k, sink);
        }
    }
}

fn check_axis(program: &Program, operation: &MotionOperation, k: usize, sink: &mut Sink) {
    let axis = &program.machine.rotary[k];
    let declared = &program.operations[operation.operation];
    let turn = |m: &[ir::JointMove]| (m[1].joints.rotary[k] - m[0].joints.rotary[k]).abs();
    let Some(m) = operation.moves.windows(2).find(|m| turn(m) >= PI - TURN_ROUNDING_RAD) else { return };
    let label = operation.labels.get(m[1].pass as usize).cloned().unwrap_or_default();
    let help = if axis.modulo.is_some() {
        "report the job file; write `travel` of the axis in the machine file if the control permits it, or use another post"
    } else {
        "let the axis travel one turn at most in the machine file, or use another post"
    };
    sink.push(
        Diag::error(
            post::LONG_TURN,
            format!("`{}` turns {} by {:.1} deg in one block", declared.name, axis.name, turn(m).to_degrees()),
        )
        .label(declared.span, "in this operation")
        .place(label, program.machine.forward(&m[1].joints).tip)
        .note("the control takes the shorter way, which is the other direction")
        .help(help),
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use five_axis::control::ModuloWay;
    use proptest::prelude::*;

    proptest! {
        /// A word is on its step, within a turn, and the same position.
        #[test]
        fn words_are_within_a_turn(angle in -60.0..60.0_f64, decimals in 2..7_usize, opposite in any::<bool>()) {
            let word_sign = if opposite { -1.0 } else { 1.0 };
            let axis = RotaryAxis { word_sign, modulo: Some(ModuloWay::Shortest), ..RotaryAxis::unlimited("C") };
            let word = degrees(&axis, angle, decimals);
            let turns = (word - angle.to_degrees() * word_sign) / FULL_TURN_DEG;
            prop_assert!((0.0..FULL_TURN_DEG).contains(&word) && !words::fixed(word, decimals).starts_with("360"));
            let half = 0.5 * 10f64.powi(-i32::try_from(decimals).unwrap());
            prop_assert!((turns - turns.round()).abs() * FULL_TURN_DEG <= half + 1e-9, "{angle} {word}");
        }
    }

    #[test]
    fn rounding_does_not_lead_to_a_whole_turn() {
        let axis = RotaryAxis { modulo: Some(ModuloWay::Shortest), ..RotaryAxis::unlimited("C") };
        for degree in [-0.000_04_f64, 359.999_97, 719.999_97, 360.0, -360.0] {
            assert_eq!(words::fixed(degrees(&axis, degree.to_radians(), 4), 4), "0.0000", "{degree}");
        }
    }
}
