//! Trial of the frames of a post file, before anything is planned.
//!
//! A program with a few small moves at the retract height is written with the frames, read by the reader of the dialect,
//! and compared with its motion. So a frame that leaves out a retract, an offset or the transformation is refused at its
//! line of the post file, and not after a minute of planning.

use super::dialect::Post;
use super::judgement::TextFault;
use super::nc::{ENDS_HERE, NcProgram};
use super::read_back::{at_template, read_back};
use super::write::emit;
use diagnostics::{Diag, Sink, codes::post as codes};
use five_axis::Joints;
use ir::{JointMove, Motion, MotionOperation, MoveKind, Operation, OperationId, Program};
use nalgebra::Vector3;
use wheel::post_file::PostFile;

/// Length of the moves, mm.
const MOVE_LENGTH_MM: f64 = 1.0;

/// Turn of rotary axis 1 within a block, radians: it shows by which rule the control turns the axes.
const BLOCK_TURN_RAD: f64 = 0.05;

/// Refuses what the dialect has no words for, as far as tools, machine and post file say it, and frames with which the
/// dialect would not do what the program means.
pub fn check(post: &dyn Post, program: &Program, sink: &mut Sink) {
    let operations = program.operations.iter().map(|(id, operation)| moves(program, id, operation)).collect();
    let motion = Motion { operations };
    let mut refusals = Sink::default();
    post.check(program, &motion, &mut refusals);
    check_splines(post, program, &mut refusals);
    check_offset(post, program, &mut refusals);
    if refusals.has_errors() {
        refusals.diags().iter().cloned().for_each(|diag| sink.push(diag));
        return;
    }
    let nc = emit(post, program, &motion, &[]);
    let longest = post.dialect().form.longest;
    let long = nc.lines.iter().position(|line| line.text.len() > longest);
    let fault = match (long, read_back(post, program, &motion, &nc.text())) {
        (Some(at), _) => {
            let reason = format!("the line has {} characters; the control takes {longest}", nc.lines[at].text.len());
            TextFault { line: at + 1, code: codes::FRAME, reason, help: None }
        }
        (None, Err(fault)) => fault,
        (None, Ok(_)) => return,
    };
    sink.push(refused(program, &nc, &fault));
}

/// Refuses a work offset that the control does not have.
fn check_offset(post: &dyn Post, program: &Program, sink: &mut Sink) {
    let Some((name, span)) = &program.post.offset else { return };
    let help = match post.dialect().offsets {
        Some(offsets) if (offsets.has)(name) => return,
        Some(offsets) => format!("the work offsets of the control are {}", offsets.all),
        None => "remove the line: poses of this dialect count from the part origin".to_owned(),
    };
    sink.push(
        Diag::error(codes::FRAME, format!("the dialect {} has no work offset `{name}`", post.name()))
            .label(*span, "stated here")
            .help(help),
    );
}

/// Refuses spline blocks that the dialect does not have.
fn check_splines(post: &dyn Post, program: &Program, sink: &mut Sink) {
    let PostFile { control, splines_span, .. } = &program.post;
    let Some(form) = control.splines.filter(|form| post.dialect().splines != Some(*form)) else { return };
    let help = match post.dialect().splines {
        Some(own) => format!("write `splines = \"{}\"`, or remove the line", own.name()),
        None => "remove the line: the dialect has straight blocks".to_owned(),
    };
    sink.push(
        Diag::error(codes::FRAME, format!("the dialect {} has no spline blocks `{}`", post.name(), form.name()))
            .label(splines_span.unwrap_or_default(), "in the post file")
            .help(help),
    );
}

/// The diagnostic for a fault, at the line of the post file from which it comes.
fn refused(program: &Program, nc: &NcProgram, fault: &TextFault) -> Diag {
    let TextFault { line, code, reason, help } = fault;
    // What the reader does not understand is a fault of the frame; what the job does not allow keeps its own code.
    let code = if [codes::NC_BLOCK, codes::TEXT_DIFFERS].contains(code) { codes::FRAME } else { *code };
    let message = format!("the frames of post {} make a program that is refused: {reason}", program.post.name);
    if let Some(missing) = reason.strip_prefix(ENDS_HERE) {
        return Diag::error(code, message).label(program.post.end_span, format!("{missing} is missing here")).help(
            format!(
                "add it to the frame `end`; `impellerc posts {}` prints a file whose frames are understood",
                program.post.dialect
            ),
        );
    }
    let diag = at_template(Diag::error(code, message), nc, *line, "a trial program");
    match help.as_ref().filter(|_| code != codes::FRAME) {
        Some(help) => diag.help(help),
        None => diag.help(format!(
            "correct the frame; `impellerc posts {}` prints a file whose frames are understood",
            program.post.dialect
        )),
    }
}

/// A few moves below the retract height, in the middle of the travel: along a line, and with a turn of rotary axis 1.
fn moves(program: &Program, id: OperationId, operation: &Operation) -> MotionOperation {
    let machine = &program.machine;
    let length = program.tools[operation.tool].length();
    let middle = |k: usize| 0.5 * (machine.linear[k].min + machine.linear[k].max);
    let rotary = [0, 1].map(|k: usize| 0.0_f64.clamp(machine.rotary[k].min, machine.rotary[k].max));
    let turn = if rotary[0] + BLOCK_TURN_RAD <= machine.rotary[0].max { BLOCK_TURN_RAD } else { -BLOCK_TURN_RAD };
    // The tip for the gauge line at zero.
    let from_gauge = machine.positions(&Joints { xyz: Vector3::zeros(), rotary }, length);
    let at = |sideways: f64, below: f64| {
        let gauge = [middle(0) + sideways, middle(1), machine.retract - below];
        Joints { xyz: Vector3::from_fn(|k, _| gauge[k] - from_gauge[k]), rotary }
    };
    let turned =
        machine.joints(&machine.forward(&at(2.0 * MOVE_LENGTH_MM, MOVE_LENGTH_MM)).tip, [rotary[0] + turn, rotary[1]]);
    let feed = operation.feed.get();
    let places = [
        (MoveKind::Rapid, at(0.0, 0.0)),
        (MoveKind::Rapid, at(0.0, MOVE_LENGTH_MM)),
        (MoveKind::Cut, at(MOVE_LENGTH_MM, MOVE_LENGTH_MM)),
        (MoveKind::Cut, turned),
        (MoveKind::Cut, at(0.0, MOVE_LENGTH_MM)),
        (MoveKind::Rapid, at(0.0, 0.0)),
    ];
    let before = places.iter().take(1).chain(&places);
    let moves = before.zip(&places).map(|((_, from), (kind, joints))| {
        let way = (machine.forward(joints).tip - machine.forward(from).tip).norm();
        // Blocks in inverse time give it.
        let time = machine.planned_time(from, joints, length).max(way / machine.rapid);
        let feed = (*kind != MoveKind::Rapid).then_some(feed);
        JointMove { kind: *kind, joints: *joints, feed, time, pass: 0, stop: false }
    });
    MotionOperation { operation: id, labels: vec![String::new()], moves: moves.collect(), splines: Vec::new() }
}
