//! From the moves of an operation to blocks.

use super::Siemens840d;
use crate::diag::{Diag, Sink, codes::post};
use crate::ir::{Motion, MotionOperation, MoveKind, Program};
use crate::post::dialect::WriteBlock;
use crate::post::form::{NumberForm, TextForm};
use crate::post::words::{self, feed, fixed};
use crate::post::write;
use crate::post_file::Orientation;

/// Turn of rotary axis 2 between blocks from which on the nearest rotary position is not certain to be the right one.
const CERTAIN_TURN: f64 = std::f64::consts::FRAC_PI_2;

/// Refuses a motion that the dialect cannot express.
pub(super) fn check(program: &Program, motion: &Motion, sink: &mut Sink) {
    words::check(program, motion, sink);
    // Positions of the rotary axes leave no choice to the control.
    if program.post.orientation == Orientation::Angles {
        return;
    }
    for operation in &motion.operations {
        let declared = &program.operations[operation.operation];
        let unsure = operation.moves.windows(2).find(|m| {
            let [a, b] = [m[0].joints.rotary, m[1].joints.rotary];
            m[1].kind != MoveKind::Rapid && (a[0] * b[0] < 0.0 || (a[1] - b[1]).abs() >= CERTAIN_TURN)
        });
        if let Some(m) = unsure {
            let label = operation.labels.get(m[1].pass as usize).cloned().unwrap_or_default();
            sink.push(
                Diag::error(
                    post::AMBIGUOUS_VECTOR,
                    format!(
                        "`{}` turns {} by {:.1} deg in one block, or runs through the pole",
                        declared.name,
                        program.machine.rotary[1].name,
                        (m[0].joints.rotary[1] - m[1].joints.rotary[1]).to_degrees().abs()
                    ),
                )
                .label(declared.span, "in this operation")
                .place(label, program.machine.forward(&m[1].joints).tip)
                .note("a direction vector fits two rotary positions; the control takes the nearer one")
                .help("use a finer chord tolerance, or tool axes farther from the pole"),
            );
        }
    }
}

/// Text of the dialect.
pub(super) const FORM: TextForm = TextForm {
    comment: ["; ", ""],
    rotary: "=",
    numbers: NumberForm { prefix: "N", always: false, comments: false, without: &["%"] },
    continued: "",
    longest: 512,
};

/// Writes the blocks of the moves of an operation.
pub(super) fn moves(program: &Program, operation: &MotionOperation, write: &mut WriteBlock<'_>) {
    let post = &Siemens840d;
    let decimals = program.post.decimals.feed;
    let mut last_feed = String::new();
    let mut last_kind = None;
    for (i, m) in write::between(operation) {
        let tip = write::tip(post, program, &m.joints);
        let text = match m.kind {
            MoveKind::Rapid => format!("G0 {tip} {}", write::rotary(post, program, &m.joints)),
            MoveKind::Link | MoveKind::Cut => {
                let f = fixed(feed(m.feed.unwrap_or(0.0), decimals), decimals);
                // After a rapid F is written again, so that every pass can be read by itself.
                let say = f != last_feed || last_kind == Some(MoveKind::Rapid);
                let word = if say { format!(" F{f}") } else { String::new() };
                last_feed = f;
                let direction = match program.post.orientation {
                    Orientation::Vectors => write::vector(post, program, &m.joints, ["A3=", "B3=", "C3="]),
                    Orientation::Angles => write::rotary(post, program, &m.joints),
                };
                format!("G1 {tip} {direction}{word}")
            }
        };
        last_kind = Some(m.kind);
        write(text, Some(i));
    }
}
