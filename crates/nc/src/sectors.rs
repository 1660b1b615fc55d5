//! What sectors repeat, as a subprogram: when the text has it, and what it says where it has not.
//!
//! The motion stays what was verified. The words of a subprogram are those of the place where its moves come first; the
//! control turns them to the other places. A rounded coordinate that is turned is off by at most half a step times the root
//! of 2 in each direction, where an inline word is off by half a step. So only posts with exact digits have subprograms: see
//! [`Decimals::EXACT`](wheel::control::Decimals::EXACT).

use super::dialect::Post;
use super::divided::Divided;
use super::work_frame;
use diagnostics::{Diag, Sink, codes::post as codes};
use five_axis::control::Planning;
use ir::repeats::{Division, NoSymmetry, Symmetry};
use ir::{JointMove, Motion, MotionOperation, MoveKind, Program};
use wheel::control::Sectors;

/// Difference of feeds (mm/min) and times (s) that is rounding of the arithmetic, as a share.
const FEED_AND_TIME_ROUNDING: f64 = 1e-9;

/// Divides an operation; `None` where its text is inline.
pub(super) fn divided<'a>(
    post: &dyn Post,
    program: &Program,
    operation: &'a MotionOperation,
    before: usize,
) -> Option<Divided<'a>> {
    // Polynomials have no words that count with a turn, and words within one turn do not.
    if endless(program).is_some()
        || program.post.control.sectors == Sectors::Inline
        || post.dialect().no_subprograms.is_some()
        || !operation.splines.is_empty()
    {
        return None;
    }
    let division = division(program, operation)?;
    (division.subprograms > 0).then_some(Divided { operation, division, before })
}

/// Name of an axis modulo 360 deg.
fn endless(program: &Program) -> Option<&str> {
    program.machine.rotary.iter().find(|axis| axis.modulo.is_some()).map(|axis| axis.name.as_str())
}

fn division(program: &Program, operation: &MotionOperation) -> Option<Division> {
    let symmetry = Symmetry::of(program).ok()?;
    let moves = &operation.moves;
    let rapid = |i: usize| moves[i].kind == MoveKind::Rapid;
    // LinuxCNC takes a turn of the work frame when the axes rest. Other controls may rest there: at rapid it does no harm.
    let stops = program.machine.planning == Planning::LinuxCnc;
    let cut = |i: usize| if stops { moves[i - 1].stop } else { rapid(i - 1) || rapid(i) };
    let near = |a: f64, b: f64| (a - b).abs() <= FEED_AND_TIME_ROUNDING * a.max(b);
    let same = |a: &JointMove, b: &JointMove| {
        let feeds = match (a.feed, b.feed) {
            (Some(a), Some(b)) => near(a, b),
            // Only LinuxCNC has words for the times of rapids.
            (None, None) => !stops || near(a.time, b.time),
            _ => false,
        };
        a.kind == b.kind && a.stop == b.stop && feeds
    };
    Some(symmetry.divide(moves, &cut, &same))
}

/// Tells what a job that asks for subprograms does not get, and why.
pub fn remark(post: &dyn Post, program: &Program, motion: &Motion, sink: &mut Sink) {
    if program.post.control.sectors == Sectors::Inline {
        return;
    }
    let turned = !program.machine.chain.holds_part_upright();
    let program = &*work_frame::program(post.name(), program);
    let tell = |message: String, note: String| {
        let mut diag = Diag::remark(codes::SECTORS_INLINE, message).note(note);
        if let Some(span) = program.post.span {
            diag = diag.label(span, "subprograms are required here");
        }
        diag
    };
    let all = "the text has every sector move by move, without subprograms";
    let why = match (post.dialect().no_subprograms, Symmetry::of(program).err()) {
        (Some(why), _) => Some(why.to_owned()),
        (None, Some(_)) if turned => Some(
            "a turn of the work frame about the axis of a part that does not stand along Z is not written yet"
                .to_owned(),
        ),
        (None, Some(NoSymmetry::Axis)) => Some(format!(
            "axis {} of the machine {} does not turn the part about its axis",
            program.machine.rotary[1].name, program.machine.name
        )),
        (None, Some(NoSymmetry::Digits)) => Some(
            "the words of the post have too few digits: turned words would be others than those that are proved"
                .to_owned(),
        ),
        (None, None) => endless(program)
            .map(|axis| format!("words of axis {axis}, which is modulo 360 deg, cannot count with the turn of a call")),
    };
    if let Some(why) = why {
        sink.push(tell(all.to_owned(), why).help("write `sectors inline`, or leave the property out"));
        return;
    }
    let inline = motion.operations.iter().filter(|o| {
        let several = program.operations[o.operation].sectors.len() > 1;
        several && divided(post, program, o, 0).is_none()
    });
    let names: Vec<String> = inline.map(|o| format!("`{}`", program.operations[o.operation].name)).collect();
    if !names.is_empty() {
        let message = format!("the text has every sector of {} move by move", names.join(", "));
        sink.push(tell(
            message,
            "no part of these operations is the same in two sectors, or it is too short, or it has splines".to_owned(),
        ));
    }
}
