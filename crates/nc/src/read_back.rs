//! V5: interprets the NC text and compares it with the motion.

use super::dialect::Post;
use super::judgement::{NcCommands, TextFault, judged};
use super::motion_of::says_tool;
use super::nc::{Direction, NcMove, NcPlace, NcPose, NcProgram, NcRetract, NcSection, STANDS};
use super::tool_shape;
use super::words::INVERSE_DECIMALS;
use super::work_frame;
use diagnostics::{Diag, codes::post as codes};
use five_axis::{Angles, PoseCurve, TurnCurve, most_turn};
use ir::repeats;
use ir::{JointMove, Motion, MotionOperation, MoveKind, Program};
use nalgebra::{SVector, Vector3};
use nurbs::bezier;
use std::f64::consts::{SQRT_2, TAU};
use wheel::control::Decimals;

/// Share of a time that rounding may take.
const TIME_ROUNDING: f64 = 1e-12;

/// Margin of moves whose words are those of another place, tip in mm and angles in radians. A move of a subprogram differs
/// from its first place by at most the rounding of the arithmetic, and so does the turn of each unit of it from that of the
/// whole, in both positions.
const SUBPROGRAM_ROUNDING: (f64, f64) = (4.0 * repeats::POSITION_ROUNDING.0, 4.0 * repeats::POSITION_ROUNDING.1);

/// What reading back found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadBack {
    /// Moves compared.
    pub moves: usize,
    /// Largest difference of a tip coordinate, mm.
    pub tip: f64,
    /// Largest difference of the tool axis, radians.
    pub axis: f64,
}

/// Half a step of a word, plus a margin for the rounding of the arithmetic.
fn half_step(decimals: usize) -> f64 {
    0.5 * 10f64.powi(-i32::try_from(decimals).unwrap_or(0)) + 1e-11
}

/// The diagnostic for a fault of a text that was written. What the job does not allow comes from the post file: it is labelled
/// at the template that made the line, or the last one before it.
pub fn refused(program: &Program, nc: &NcProgram, fault: &TextFault) -> Diag {
    let TextFault { line, code, reason, help } = fault;
    let own = if *code == codes::TEXT_DIFFERS {
        Some((*code, format!("line {line} of the NC text does not agree with the motion: {reason}")))
    } else if [codes::NC_BLOCK, codes::NOT_UNDERSTOOD].contains(code) {
        Some((codes::NOT_UNDERSTOOD, format!("line {line} of the NC text: {reason}")))
    } else {
        None
    };
    if let Some((code, message)) = own {
        let diag = Diag::error(code, message).note("nothing was written");
        return diag.help("report the job file: this is a fault of the compiler");
    }
    let diag = Diag::error(*code, format!("post {} makes a program that is refused: {reason}", program.post.name));
    let diag = at_template(diag, nc, *line, "the program");
    match help {
        Some(help) => diag.help(format!("correct the post file: {help}")),
        None => diag,
    }
}

/// Adds the template of the post file that made a line of a text, or the last one before it, and the line.
pub(super) fn at_template(mut diag: Diag, nc: &NcProgram, line: usize, of: &str) -> Diag {
    let line = if line == 0 { nc.lines.len() } else { line.min(nc.lines.len()) };
    let own = nc.lines.get(line.wrapping_sub(1));
    if let Some(span) = nc.lines[..line].iter().rev().find_map(|l| l.frame) {
        let made = own.is_some_and(|l| l.frame.is_some());
        diag = diag.label(span, if made { "this line" } else { "what the program does behind this line is refused" });
    }
    match own {
        Some(own) => diag.note(format!("line {line} of {of}: {}", own.text)),
        None => diag,
    }
}

fn differs(line: usize, reason: String) -> TextFault {
    TextFault { line, code: codes::TEXT_DIFFERS, reason, help: None }
}

/// Judges the text as `impellerc verify` judges it, and compares every move with the motion: kind, tip, axis, rotary
/// positions, feed, tool and spindle speed.
///
/// # Errors
/// The first line that is refused, or that differs from the motion.
pub fn read_back(post: &dyn Post, program: &Program, motion: &Motion, text: &str) -> Result<ReadBack, TextFault> {
    let NcCommands { sections, .. } = judged(post, program, text)?;
    let (motion, program) =
        (&*work_frame::motion(post.name(), program, motion), &*work_frame::program(post.name(), program));
    let mut result = ReadBack { moves: 0, tip: 0.0, axis: 0.0 };
    let mut found = sections.iter();
    for operation in &motion.operations {
        let Some(section) = found.next() else {
            return Err(differs(0, "the text ends before the motion".to_owned()));
        };
        let (line, retract) = section.retract.ok_or_else(|| differs(0, "an operation without a retract".to_owned()))?;
        let turns = whole_turns(program, operation, section);
        stations(program, operation, section, turns, &retract)
            .map_err(|fault| differs(if fault.in_last { line } else { section.start.line }, fault.reason))?;
        let declared = &program.operations[operation.operation];
        let tool = &program.tools[declared.tool];
        if let Some(why) = tool_shape::difference(&section.shape, tool) {
            return Err(differs(section.start.line, why));
        }
        let end = operation.moves.len().saturating_sub(1);
        let mut index = 1;
        for read in &section.moves {
            let Some(meant) = operation.moves.get(index).filter(|_| index < end) else {
                return Err(differs(read.line, "a move that the motion does not have".to_owned()));
            };
            let spline = operation.spline(index).map(|(_, spline)| spline);
            match (spline, &read.curve) {
                (Some(spline), Some(curve)) => {
                    same_curve(program, &spline.curve, curve, &mut result).map_err(|why| differs(read.line, why))?;
                    same_feed(program, meant, read).map_err(|why| differs(read.line, why))?;
                    index = spline.last;
                }
                (None, None) => {
                    compare(program, meant, read, turns, &mut result).map_err(|why| differs(read.line, why))?
                }
                _ => return Err(differs(read.line, "a spline and a straight block are exchanged".to_owned())),
            }
            // After the last move the transformation is switched off, at rest.
            if meant.stop && read.smoothing != Some(0.0) && index + 2 < end {
                return Err(differs(read.line, "an exact stop is missing".to_owned()));
            }
            if !says_tool(read, tool) || (read.speed - declared.speed.get()).abs() > 0.5 {
                return Err(differs(read.line, format!("tool {} at {} rpm", read.tool, read.speed)));
            }
            index += 1;
        }
        if index < end {
            return Err(differs(line, "the operation ends before the motion".to_owned()));
        }
        result.moves += section.moves.len() + 2;
    }
    match found.next() {
        Some(more) => Err(differs(more.start.line, "an operation that the motion does not have".to_owned())),
        None => Ok(result),
    }
}

/// Largest error of a control point by the rounding of all coefficients, mm and radians: they have eight digits behind the
/// point, one fewer from 10 on.
const CONTROL_POINT_ROUNDING: f64 = 1e-6;

/// Compares the polynomials of a block. Two curves of one degree are nowhere farther apart than their control points.
fn same_curve(program: &Program, meant: &PoseCurve, read: &PoseCurve, result: &mut ReadBack) -> Result<(), String> {
    fn distance<const N: usize>(a: &[SVector<f64, N>], b: &[SVector<f64, N>]) -> f64 {
        let [a, b] = [a, b].map(|control| bezier::elevated(control, bezier::MAX_BEZIER_DEGREE));
        a.iter().zip(&b).map(|(p, q)| (p - q).amax()).fold(0.0, f64::max)
    }
    let digits = &program.post.control.decimals;
    let tip = distance(meant.tip(), read.tip());
    if tip > half_step(digits.length) + CONTROL_POINT_ROUNDING {
        return Err(format!("the tip is off by {tip:.6} mm"));
    }
    let axis = match (meant.turn(), read.turn()) {
        (TurnCurve::Rotary(a), TurnCurve::Rotary(b)) => {
            let off = distance(a, b);
            if off > half_step(digits.angle).to_radians() + CONTROL_POINT_ROUNDING {
                return Err(format!("a rotary axis is off by {:.7} deg", off.to_degrees()));
            }
            off
        }
        (TurnCurve::Second(a), TurnCurve::Second(b)) => {
            let off = distance(a, b);
            if off > half_step(digits.length) + CONTROL_POINT_ROUNDING {
                return Err(format!("the second point is off by {off:.6} mm"));
            }
            3f64.sqrt() * (tip + off) / meant.least_length()
        }
        _ => return Err("the directions of two kinds of splines are exchanged".to_owned()),
    };
    (result.tip, result.axis) = (result.tip.max(tip), result.axis.max(axis));
    Ok(())
}

/// Whole turns of axes modulo 360 deg between a text, which begins an operation within one turn, and the motion.
fn whole_turns(program: &Program, operation: &MotionOperation, section: &NcSection) -> Angles {
    let (Some(first), NcPlace::Axes { rotary, .. }) = (operation.moves.first(), &section.start.place) else {
        return [0.0; 2];
    };
    [0, 1].map(|k| match program.machine.rotary[k].modulo {
        Some(_) => TAU * ((first.joints.rotary[k] - rotary[k]) / TAU).round(),
        None => 0.0,
    })
}

fn wound(angles: Angles, turns: Angles) -> Angles {
    [angles[0] + turns[0], angles[1] + turns[1]]
}

/// A station at retract height that differs from its move.
struct StationFault {
    /// It is that of the last move, not of the first.
    in_last: bool,
    reason: String,
}

/// Compares the stations at retract height with the first and the last move.
fn stations(
    program: &Program,
    operation: &MotionOperation,
    section: &NcSection,
    turns: Angles,
    retract: &NcRetract,
) -> Result<(), StationFault> {
    let at_start = |reason: String| StationFault { in_last: false, reason };
    let at_end = |reason: String| StationFault { in_last: true, reason };
    let digits = &program.post.control.decimals;
    let length = program.tools[program.operations[operation.operation].tool].length();
    let (Some(first), Some(last)) = (operation.moves.first(), operation.moves.last()) else {
        return Err(at_start("an operation without moves".to_owned()));
    };
    let positions = |m: &JointMove| program.machine.positions(&m.joints, length);
    match &section.start.place {
        NcPlace::Pose(pose) => {
            same_pose(program, first, pose).map_err(|why| at_start(format!("at the start, {why}")))?
        }
        NcPlace::Axes { xyz, rotary, turned } => {
            if let Some(tip) = turned.filter(|tip| (tip - first.joints.xyz).amax() > STANDS) {
                let off = (tip - first.joints.xyz).amax();
                let reason = format!("the axes are {off:.6} mm away from the first station while the tables turn");
                return Err(at_start(reason));
            }
            let [x, y, z, ..] = positions(first);
            let off = (xyz - Vector3::new(x, y, z)).amax();
            if off > half_step(digits.length) {
                return Err(at_start(format!("the axes are {off:.6} mm away from the first station")));
            }
            let turned = most_turn(wound(*rotary, turns), first.joints.rotary).to_degrees();
            if turned > half_step(digits.angle) {
                return Err(at_start(format!("a rotary axis is {turned:.7} deg away from the first station")));
            }
        }
    }
    match retract {
        NcRetract::Pose(pose) => same_pose(program, last, pose).map_err(|why| at_end(format!("at the end, {why}")))?,
        NcRetract::Height(height) => {
            let off = (height - positions(last)[2]).abs();
            if off > half_step(digits.length) {
                return Err(at_end(format!("the retract is off by {off:.6} mm")));
            }
        }
    }
    // Above the last target, where the text has no word of an axis but Z.
    let over = operation.moves.get(operation.moves.len().saturating_sub(2)).unwrap_or(last);
    let across = (last.joints.xyz - over.joints.xyz).xy().amax();
    let turned = most_turn(last.joints.rotary, over.joints.rotary);
    if across > half_step(digits.length) || turned > 0.0 {
        return Err(at_end("the last station is not above the last target".to_owned()));
    }
    Ok(())
}

/// Compares a pose of a text with that of a move.
fn same_pose(program: &Program, meant: &JointMove, read: &NcPose) -> Result<(), String> {
    let pose = program.machine.forward(&meant.joints);
    let tip = (read.tip - pose.tip).amax();
    if tip > half_step(program.post.control.decimals.length) {
        return Err(format!("the tip is off by {tip:.6} mm"));
    }
    let axis = (read.axis - pose.axis).norm();
    if axis > half_step(program.post.control.decimals.vector) * 3f64.sqrt() {
        return Err(format!("the tool axis is off by {axis:.3e} rad"));
    }
    Ok(())
}

fn compare(
    program: &Program,
    meant: &JointMove,
    read: &NcMove,
    turns: Angles,
    result: &mut ReadBack,
) -> Result<(), String> {
    let digits: &Decimals = &program.post.control.decimals;
    let pose = program.machine.forward(&meant.joints);
    let inverse = meant.kind == MoveKind::Rapid && read.time.is_some();
    if !inverse && read.rapid != (meant.kind == MoveKind::Rapid) {
        return Err("rapid and feed are exchanged".to_owned());
    }
    // A turned frame turns the errors of two rounded words into one coordinate.
    let (most, margin) = if read.frame_turned {
        (half_step(digits.length) * SQRT_2, SUBPROGRAM_ROUNDING)
    } else {
        (half_step(digits.length), (0.0, 0.0))
    };
    let tip = (read.tip - pose.tip).amax();
    if tip > most + margin.0 {
        return Err(format!("the tip is off by {tip:.6} mm"));
    }
    result.tip = result.tip.max(tip);
    let close = |angles: Angles| {
        let off = most_turn(wound(angles, turns), meant.joints.rotary).to_degrees();
        let most = half_step(digits.angle) + margin.1.to_degrees();
        if off > most { Err(format!("a rotary axis is off by {off:.7} deg")) } else { Ok(()) }
    };
    let axis = match read.direction {
        Direction::Axis(axis) => axis,
        Direction::Rotary(angles) => {
            close(angles)?;
            program.machine.chain.tool_axis(angles)
        }
    };
    let off = (axis - pose.axis).norm();
    // Three components, or two angles, each with an error of half a step; two axes that are not square turn the tool farther.
    let ratio = program.machine.chain.most_turn_ratio();
    let bound = match read.direction {
        Direction::Axis(_) => half_step(digits.vector) * 3f64.sqrt(),
        Direction::Rotary(..) => half_step(digits.angle).to_radians() * 2f64.sqrt() * ratio,
    };
    if off > bound + margin.1 {
        return Err(format!("the tool axis is off by {off:.3e} rad"));
    }
    result.axis = result.axis.max(off);
    if let Some(time) = read.time.filter(|_| inverse) {
        // One step of F, and the shortest time that is written.
        let longest = meant.time * (1.0 + meant.time / 60.0 * 10f64.powi(-INVERSE_DECIMALS)) + 1e-3;
        let fits = time >= meant.time * (1.0 - TIME_ROUNDING) && time <= longest;
        return if fits { Ok(()) } else { Err(format!("a rapid takes {time} s instead of {} s", meant.time)) };
    }
    same_feed(program, meant, read)
}

fn same_feed(program: &Program, meant: &JointMove, read: &NcMove) -> Result<(), String> {
    let digits = &program.post.control.decimals;
    match (meant.feed, read.feed) {
        (None, None) => Ok(()),
        (Some(m), Some(r)) if (m - r).abs() <= 2.0 * half_step(digits.feed) && r <= m + 1e-8 => Ok(()),
        (m, r) => Err(format!("the feed is {r:?} instead of {m:?}")),
    }
}
