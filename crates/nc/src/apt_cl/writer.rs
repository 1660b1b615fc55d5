//! From the moves of an operation to statements.

use super::{AptCl, curve_statements};
use crate::dialect::WriteBlock;
use crate::form::{NumberForm, TextForm};
use crate::words::{self, fixed};
use crate::write::{self, FeedWord};
use diagnostics::{Diag, Sink, codes::post};
use ir::{Motion, MotionOperation, MoveKind, Program};
use wheel::control::Decimals;

/// Text of the dialect.
pub(super) const FORM: TextForm = TextForm {
    comment: ["$$ ", ""],
    rotary: "",
    modulo: Err("CL data have no words of axes"),
    numbers: NumberForm { prefix: "", largest: u64::MAX, always: false, comments: false, without: &[] },
    continued: "$",
    longest: 72,
};

/// Refuses a motion that CL data cannot express.
pub(super) fn check(program: &Program, motion: &Motion, sink: &mut Sink) {
    words::check_vectors(program, motion, sink);
    let (digits, fine) = (&program.post.control.decimals, Decimals::FINE);
    if digits.length < fine.length || digits.vector < fine.vector {
        // Rounding on the way to the control adds to what a post-processor rounds.
        sink.push(
            Diag::error(
                post::FRAME,
                format!("post {} writes poses with {} and {} digits", program.post.name, digits.length, digits.vector),
            )
            .label(program.post.dialect_span, "CL data are written by this post file")
            .note("a post-processor computes positions of axes from the poses, and rounds once more")
            .help(format!("write `length = {}` and `vector = {}` in `decimals`", fine.length, fine.vector)),
        );
    }
    for operation in &motion.operations {
        let tool = &program.tools[program.operations[operation.operation].tool];
        if tool.number == 0 {
            sink.push(
                Diag::error(post::TOOL_NUMBER, format!("tool {} has the number 0", tool.name))
                    .label(tool.span, "declared here")
                    .help("LOADTL takes numbers from 1: `number 1`"),
            );
        }
    }
}

/// Writes the statements of the moves of an operation.
pub(super) fn moves(program: &Program, operation: &MotionOperation, write: &mut WriteBlock<'_>) {
    let mut feed = FeedWord::new(fixed);
    for (i, m) in write::between(operation) {
        let spline = operation.spline(i).map(|(_, spline)| spline);
        if m.kind == MoveKind::Rapid {
            write("RAPID".to_owned(), None);
            feed.forget();
        } else if spline.is_none_or(|spline| spline.first == i)
            // A spline block has one feed.
            && let Some(feed) = feed.changed(program, m)
        {
            write(format!("FEDRAT/{feed},MMPM"), None);
        }
        if let Some(spline) = spline.filter(|spline| spline.first == i) {
            curve_statements::begin(spline, program.post.control.decimals.length, |values| {
                statement("MOVNRB", &values, write);
            });
        }
        let [tip, axis] = write::pose(&AptCl, program, &m.joints);
        let text = format!("GOTO/{tip},{axis}");
        if text.len() <= FORM.longest {
            write(text, Some(i));
        } else {
            write(format!("GOTO/{tip},$"), Some(i));
            write(format!("  {axis}"), None);
        }
        if spline.is_some_and(|spline| spline.last == i) {
            write("MOVNRB/OFF".to_owned(), None);
        }
    }
}

/// Writes a statement with as many values on a line as fit on it.
fn statement(word: &str, values: &[String], write: &mut WriteBlock<'_>) {
    let mut line = format!("{word}/");
    for (k, value) in values.iter().enumerate() {
        // The comma behind it and the `$`.
        if line.len() + value.len() + 2 > FORM.longest {
            write(format!("{line}$"), None);
            line = "  ".to_owned();
        }
        line.push_str(value);
        if k + 1 < values.len() {
            line.push(',');
        }
    }
    write(line, None);
}
