//! Steps of the stock simulation: the moves of an operation, divided where they are long, and taken together where they are
//! too short to show a chip.

use super::super::proof::piece::part_count;
use five_axis::{Pose, between};
use ir::{JointMove, MoveKind, Program};
use nalgebra::{Point3, Vector3};
use std::ops::{Range, RangeInclusive};
use tool_stock::stock::{self, Step, StepKind};

/// Longest tip motion of a step, mm; this is the resolution of air cuts and engagement.
const MAX_STEP_LENGTH: f64 = 2.0;

/// Tip motion of a move, mm, under which moves are taken together: the ends of rays are known to [`stock::END_ERROR`], and a
/// chip counts from twice of it on. In a move of ten times of it, chips up to 12 deg from the sides of a slot do not.
const MIN_MOVE_LENGTH: f64 = 10.0 * stock::END_ERROR;

/// Longest tip motion of moves that are taken together, mm.
const MAX_JOINED_LENGTH: f64 = 2.0 * MIN_MOVE_LENGTH;

/// Most moves that are taken together: their number must not decide on the time of a check.
const MAX_JOINED_MOVES: usize = 64;

/// Place of a step.
pub(super) struct StepPlace {
    /// First move of the step.
    first: u32,
    /// Its last move, which is the first one as well unless short moves were taken together.
    pub(super) index: u32,
    pub(super) kind: MoveKind,
    /// Tip at the end of the step.
    pub(super) tip: Point3<f64>,
    /// Tip motion, mm.
    pub(super) step: Vector3<f64>,
    /// Length of the tip motion, mm.
    pub(super) way: f64,
    /// Part of the tip motion along the axis, mm, positive towards the tip.
    pub(super) down: f64,
    /// Time, s.
    pub(super) time: f64,
    /// Turn of the unit tool axis.
    turn: Vector3<f64>,
}

/// A value with the step in which it is found.
#[derive(Clone, Copy)]
pub(super) struct StepValue {
    pub(super) value: f64,
    pub(super) step: u32,
}

impl StepPlace {
    /// Part of the tip motion square to the axis, mm.
    pub(super) fn across(&self) -> f64 {
        (self.way * self.way - self.down * self.down).max(0.0).sqrt()
    }

    /// Way of the axis of the tool at a height over the tip, mm.
    pub(super) fn way_at(&self, height: f64) -> f64 {
        (self.step + self.turn * height).norm()
    }

    /// Indices of its moves.
    pub(super) fn moves(&self) -> RangeInclusive<usize> {
        self.first as usize..=self.index as usize
    }
}

/// The steps of the moves of an operation of a tool that cuts up to the height `reach`, mm, with turn and tip motion within the
/// limits of the stock simulation.
pub(super) fn steps<'a>(
    program: &'a Program,
    moves: &'a [JointMove],
    reach: f64,
) -> impl Iterator<Item = (StepPlace, Step)> + use<'a> {
    let mut next = 1;
    let pieces = std::iter::from_fn(move || {
        let first = next;
        next = (first < moves.len()).then(|| end_of_piece(program, moves, first, reach))?;
        Some(first..next)
    });
    pieces.flat_map(move |piece| steps_of(program, moves, &piece))
}

/// Where the moves end that are taken together from a move on: short ones of one kind whose poses lie within
/// [`stock::END_ERROR`] of the motion from the first to the last.
fn end_of_piece(program: &Program, moves: &[JointMove], first: usize, reach: f64) -> usize {
    let kind = moves[first].kind;
    let pose = |i: usize| program.machine.forward(&moves[i].joints);
    if kind == MoveKind::Rapid {
        return first + 1;
    }
    let start = pose(first - 1);
    let mut passed: Vec<Pose> = Vec::new();
    for (i, m) in moves.iter().enumerate().skip(first).take(MAX_JOINED_MOVES) {
        let next = pose(i);
        let last = passed.last().unwrap_or(&start);
        let short = (next.tip - last.tip).norm() < MIN_MOVE_LENGTH && (next.tip - start.tip).norm() < MAX_JOINED_LENGTH;
        if m.kind != kind || !short || !passed.iter().all(|p| lies_between([&start, &next], p, reach)) {
            break;
        }
        passed.push(next);
    }
    first + passed.len().max(1)
}

/// Whether a pose lies on the way from one to another, for a tool up to the height `reach`.
fn lies_between([from, to]: [&Pose; 2], pose: &Pose, reach: f64) -> bool {
    let way = to.tip - from.tip;
    let square = way.norm_squared();
    let d = pose.tip - from.tip;
    let share = if square > 0.0 { (d.dot(&way) / square).clamp(0.0, 1.0) } else { 0.0 };
    let axis = from.axis + (to.axis - from.axis) * share;
    (d - way * share).norm() + (pose.axis - axis).norm() * reach <= stock::END_ERROR
}

/// The steps of some moves that count as one.
fn steps_of<'a>(
    program: &'a Program,
    moves: &'a [JointMove],
    piece: &Range<usize>,
) -> impl Iterator<Item = (StepPlace, Step)> + use<'a> {
    let (from, to) = (moves[piece.start - 1].joints, moves[piece.end - 1].joints);
    let kind = moves[piece.start].kind;
    let time: f64 = moves[piece.clone()].iter().map(|m| m.time).sum();
    let tips = [program.machine.forward(&from).tip, program.machine.forward(&to).tip];
    let way = tips[1] - tips[0];
    let turn = program.machine.turn(from.rotary, to.rotary);
    let count = part_count((turn / stock::MAX_STEP_TURN).max(way.norm() / MAX_STEP_LENGTH));
    let axis = move |t: f64| program.machine.chain.tool_axis(between(from.rotary, to.rotary, t));
    let [first, index] = [piece.start, piece.end - 1].map(|i| u32::try_from(i).unwrap_or(u32::MAX));
    (0..count as usize).map(move |k| {
        let (a, b) = (k as f64 / count, (k + 1) as f64 / count);
        let ends = [tips[0] + way * a, tips[0] + way * b];
        let (step, time) = (way / count, time / count);
        let axes = [axis(a), axis(0.5 * (a + b)), axis(b)];
        let down = -step.dot(&axes[1]);
        let turn = axes[2] - axes[0];
        let place = StepPlace { first, index, kind, tip: ends[1], step, way: step.norm(), down, time, turn };
        let kind = match kind {
            MoveKind::Cut => StepKind::Cut,
            MoveKind::Link => StepKind::Link,
            MoveKind::Rapid => StepKind::Rapid,
        };
        (place, Step { block: 0, kind, tips: ends, axes })
    })
}
