//! From the moves of an operation to blocks.

use super::Family;
use super::control::Member;
use crate::dialect::WriteBlock;
use crate::modulo;
use crate::words::{self, fixed};
use crate::write::{self, FeedWord};
use diagnostics::{Diag, Sink, codes::job, codes::post};
use five_axis::{Angles, Carries, Joints, Machine, between, most_turn};
use ir::{JointMove, Motion, MotionOperation, MoveKind, Program};
use wheel::control::Orientation;
use wheel::post_file::{Field, Template};

/// Largest number of a tool and of its length.
const MAX_TOOL_NUMBER: u32 = 999;

/// Turn of the tables in one block before the start of a path, radians: 1 deg.
const BLOCK_TURN_RAD: f64 = std::f64::consts::PI / 180.0;

/// A number that has its point also without digits behind it.
pub(super) fn number(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if text.contains('.') { text } else { format!("{text}.") }
}

/// The rotary axes with the tables at zero.
pub(super) fn at_switch(machine: &Machine, start: Angles) -> Angles {
    let axes = machine.chain.axes();
    [0, 1].map(|k| if axes[k].carries == Carries::Part { 0.0 } else { start[k] })
}

/// Refuses a program number with more digits than the control takes, where the frames write it.
fn check_program_number(member: &Member, program: &Program, sink: &mut Sink) {
    let (post, largest) = (&program.post, 10_u32.pow(member.program_digits) - 1);
    let written = |template: &Template| template.fields().any(|field| field == Field::ProgramNumber);
    if post.program_number <= largest || !post.frames.iter().flatten().any(written) {
        return;
    }
    let number = post.program_number;
    let diag = Diag::error(job::OUT_OF_RANGE, format!("post {} cannot write the program number {number}", post.name))
        .note(format!("the control takes program numbers of at most {} digits", member.program_digits))
        .help(format!("write `program-number` from 1 to {largest} in the post of the job, or in the post file"));
    sink.push(words::at(post.span, diag));
}

/// Refuses a motion that the dialect cannot express.
pub(super) fn check(member: &Member, program: &Program, motion: &Motion, sink: &mut Sink) {
    check_program_number(member, program, sink);
    modulo::check_way(program, motion, |axis| axis.modulo.is_some(), sink);
    let vectors = program.post.control.orientation == Orientation::Vectors;
    let tables = program.machine.chain.axes().iter().all(|axis| axis.carries == Carries::Part);
    if vectors && tables {
        let mut diag = Diag::error(
            post::AMBIGUOUS_VECTOR,
            format!("post {} cannot write vectors for a machine with two tables", program.post.name),
        )
        .note("G43.5 is switched on with the tables at zero; from there two pairs of angles have the same way, and the control chooses")
        .help("write `orientation angles`");
        if let Some(span) = program.post.span {
            diag = diag.label(span, "required here");
        }
        sink.push(diag);
        return;
    }
    for operation in &motion.operations {
        let declared = &program.operations[operation.operation];
        let tool = &program.tools[declared.tool];
        words::check_tool_number(tool, MAX_TOOL_NUMBER, "T and H take numbers", sink);
        let unsure = |pair: &&[JointMove]| {
            words::fits_two_positions(&program.machine, pair[0].joints.rotary, pair[1].joints.rotary)
        };
        if let Some(pair) = operation.moves.windows(2).find(unsure).filter(|_| vectors) {
            let label = operation.labels.get(pair[1].pass as usize).cloned().unwrap_or_default();
            let name = &program.machine.rotary[1].name;
            sink.push(
                Diag::error(
                    post::AMBIGUOUS_VECTOR,
                    format!(
                        "`{}` turns {name} by 90 deg or more in one block, or runs through the pole",
                        declared.name
                    ),
                )
                .label(declared.span, "in this operation")
                .place(label, program.machine.forward(&pair[1].joints).tip)
                .note("after G43.5 every block has a vector, also a rapid; the control chooses the angles")
                .help("write `orientation angles`"),
            );
        }
    }
}

/// Writes the blocks of the moves of an operation.
pub(super) fn moves(post: &Family, program: &Program, operation: &MotionOperation, write: &mut WriteBlock<'_>) {
    let mut feed = FeedWord::new(number);
    if let Some(first) = operation.moves.first() {
        turns(post, program, &first.joints, write);
    }
    for (i, m) in write::between(operation) {
        let tip = write::tip(post, program, &m.joints);
        let direction = direction(post, program, &m.joints);
        let text = match m.kind {
            MoveKind::Rapid => {
                feed.forget();
                format!("G0 {tip} {direction}")
            }
            MoveKind::Link | MoveKind::Cut => format!("G1 {tip} {direction}{}", feed.word(program, m)),
        };
        write(text, Some(i));
    }
}

/// Turns the tables to the start of a path. X Y Z of each block are the place on the part below the tool, which stands
/// still.
fn turns(post: &Family, program: &Program, start: &Joints, write: &mut WriteBlock<'_>) {
    let from = at_switch(&program.machine, start.rotary);
    let count = (most_turn(from, start.rotary) / BLOCK_TURN_RAD).ceil() as u32;
    for k in 1..=count {
        let rotary = between(from, start.rotary, f64::from(k) / f64::from(count));
        let joints = Joints { rotary, ..*start };
        write(format!("G0 {} {}", write::tip(post, program, &joints), direction(post, program, &joints)), None);
    }
}

fn direction(post: &Family, program: &Program, joints: &Joints) -> String {
    match program.post.control.orientation {
        Orientation::Angles => write::rotary(post, program, joints.rotary),
        Orientation::Vectors => write::vector(post, program, joints, ["I", "J", "K"]),
    }
}
