//! Trial of the frames of a post file, before anything is planned.
//!
//! A program with a few small moves at the retract height is written with the frames, read by the reader of the dialect,
//! and compared with its motion. So a frame that leaves out a retract, an offset or the transformation is refused at its
//! line of the post file, and not after a minute of planning.

use super::dialect::Post;
use super::nc::NcProgram;
use super::read_back::{TextFault, compare_text};
use super::write::text_of;
use crate::diag::{Diag, Sink, codes::post as codes};
use crate::ir::{JointMove, Motion, MotionOperation, MoveKind, Operation, OperationId, Program};
use crate::kin::Joints;
use nalgebra::Vector3;

/// Length of the moves, mm.
const STEP: f64 = 1.0;

/// Time of a move, s. The comparison of texts uses it where blocks give times.
const TIME: f64 = 1.0;

/// Refuses what the dialect has no words for, as far as tools, machine and post file say it, and frames with which the
/// dialect would not do what the program means.
pub fn check(post: &dyn Post, program: &Program, sink: &mut Sink) {
    let operations = program.operations.iter().map(|(id, operation)| moves(program, id, operation)).collect();
    let motion = Motion { operations };
    let mut refusals = Sink::default();
    post.check(program, &motion, &mut refusals);
    check_splines(post, program, &mut refusals);
    if refusals.has_errors() {
        refusals.diags().iter().cloned().for_each(|diag| sink.push(diag));
        return;
    }
    let nc = text_of(post, program, &motion, &[]);
    let longest = post.form().longest;
    let long = nc.lines.iter().position(|line| line.text.len() > longest);
    let fault = match (long, compare_text(post, program, &motion, &nc.text())) {
        (Some(at), _) => {
            let reason = format!("the line has {} characters; the control takes {longest}", nc.lines[at].text.len());
            TextFault { line: at + 1, reason, understood: true }
        }
        (None, Err(fault)) => fault,
        (None, Ok(_)) => return,
    };
    sink.push(refused(program, &nc, &fault));
}

/// Refuses spline blocks that the dialect does not have.
fn check_splines(post: &dyn Post, program: &Program, sink: &mut Sink) {
    let Some((form, span)) = program.post.splines.filter(|(form, _)| post.splines() != Some(*form)) else { return };
    let help = match post.splines() {
        Some(own) => format!("write `splines = \"{}\"`, or remove the line", own.name()),
        None => "remove the line: the dialect has straight blocks".to_owned(),
    };
    sink.push(
        Diag::error(codes::FRAME, format!("the dialect {} has no spline blocks `{}`", post.name(), form.name()))
            .label(span, "in the post file")
            .help(help),
    );
}

/// The diagnostic for a fault, at the line of the post file from which it comes.
fn refused(program: &Program, nc: &NcProgram, fault: &TextFault) -> Diag {
    let line = if fault.line == 0 { nc.lines.len() } else { fault.line.min(nc.lines.len()) };
    let own = nc.lines.get(line.wrapping_sub(1));
    let before = nc.lines[..line].iter().rev().find_map(|l| l.frame);
    let mut diag = Diag::error(
        codes::FRAME,
        format!("the frames of post {} make a program that is refused: {}", program.post.name, fault.reason),
    );
    if let Some(span) = before {
        let made = own.is_some_and(|l| l.frame.is_some());
        diag = diag.label(span, if made { "this line" } else { "what the program does behind this line is refused" });
    }
    if let Some(own) = own {
        diag = diag.note(format!("line {line} of a trial program: {}", own.text));
    }
    diag.help("correct the frame; the file of the same dialect in jobs/_lib/posts is understood")
}

/// A few moves below the retract height, in the middle of the travel.
fn moves(program: &Program, id: OperationId, operation: &Operation) -> MotionOperation {
    let machine = &program.machine;
    let length = program.tools[operation.tool].length();
    let middle = |k: usize| 0.5 * (machine.linear[k].min + machine.linear[k].max);
    let rotary = [0, 1].map(|k: usize| 0.0_f64.clamp(machine.rotary[k].min, machine.rotary[k].max));
    // The tip for the gauge line at zero.
    let from_gauge = machine.positions(&Joints { xyz: Vector3::zeros(), rotary }, length);
    let at = |sideways: f64, below: f64| {
        let gauge = [middle(0) + sideways, middle(1), machine.retract - below];
        Joints { xyz: Vector3::from_fn(|k, _| gauge[k] - from_gauge[k]), rotary }
    };
    let feed = operation.feed.get();
    let step = |kind: MoveKind, joints: Joints| {
        let feed = (kind != MoveKind::Rapid).then_some(feed);
        JointMove { kind, joints, feed, time: TIME, pass: 0, stop: false }
    };
    let moves = vec![
        step(MoveKind::Rapid, at(0.0, 0.0)),
        step(MoveKind::Rapid, at(0.0, STEP)),
        step(MoveKind::Cut, at(STEP, STEP)),
        step(MoveKind::Cut, at(0.0, STEP)),
        step(MoveKind::Rapid, at(0.0, 0.0)),
    ];
    MotionOperation { operation: id, labels: vec![String::new()], moves, splines: Vec::new() }
}
