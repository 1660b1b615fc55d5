//! From the moves of an operation to blocks.

use super::Siemens840d;
use crate::diag::Sink;
use crate::ir::{Motion, MotionOperation, MoveKind, Program};
use crate::post::dialect::WriteBlock;
use crate::post::form::{NumberForm, TextForm};
use crate::post::words::{self, feed, fixed};
use crate::post::write;
use crate::post_file::Orientation;

/// Refuses a motion that the dialect cannot express.
pub(super) fn check(program: &Program, motion: &Motion, sink: &mut Sink) {
    words::check(program, motion, sink);
    words::check_vectors(program, motion, sink);
}

/// Text of the dialect.
pub(super) const FORM: TextForm = TextForm {
    comment: ["; ", ""],
    rotary: "=",
    numbers: NumberForm { prefix: "N", largest: u64::MAX, always: false, comments: false, without: &["%"] },
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
            MoveKind::Rapid => format!("G0 {tip} {}", write::rotary(post, program, m.joints.rotary)),
            MoveKind::Link | MoveKind::Cut => {
                let f = fixed(feed(m.feed.unwrap_or(0.0), decimals), decimals);
                // After a rapid F is written again, so that every pass can be read by itself.
                let say = f != last_feed || last_kind == Some(MoveKind::Rapid);
                let word = if say { format!(" F{f}") } else { String::new() };
                last_feed = f;
                let direction = match program.post.orientation {
                    Orientation::Vectors => write::vector(post, program, &m.joints, ["A3=", "B3=", "C3="]),
                    Orientation::Angles => write::rotary(post, program, m.joints.rotary),
                };
                format!("G1 {tip} {direction}{word}")
            }
        };
        last_kind = Some(m.kind);
        write(text, Some(i));
    }
}
