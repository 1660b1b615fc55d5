//! Machine motion: joint positions of every move.
//!
//! Meaning of a move, shared by planner, verifier and posts: tool centre point control is on. Between two moves of
//! one operation the tip, in the part frame, runs on a straight line and the rotary axes run linearly with it; the
//! linear joints follow from both.
//!
//! The first and the last move of an operation lead to stations at the retract height of the machine. The tool goes
//! down from the first station and up to the last station along Z. Between operations the tool stays at that height; X,
//! Y and the rotary axes move there with tool centre point control off, from their present positions.

use crate::program::OperationId;
use five_axis::{Joints, PoseCurve};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// All moves, operation by operation.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// Operations in machining order.
    pub operations: Vec<MotionOperation>,
}

/// Moves of one operation, with one tool.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionOperation {
    /// Id of the operation.
    pub operation: OperationId,
    /// Labels of the passes that [`JointMove::pass`] indexes.
    pub labels: Vec<String>,
    /// Moves in order.
    pub moves: Vec<JointMove>,
    /// Blocks that the control interpolates as polynomials, in order.
    pub splines: Vec<SplineBlock>,
}

/// A block that the control interpolates as polynomials. Some moves in a row are its chords: the tool leaves them by no more
/// than [`five_axis::pose_curve::MAX_CHORD_ERROR_MM`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SplineBlock {
    /// Index of its first chord.
    pub first: usize,
    /// Index of its last chord.
    pub last: usize,
    /// Path of the tool.
    pub curve: PoseCurve,
    /// Shares of the curve at the ends of the chords; the last is 1.
    pub shares: Vec<f64>,
}

impl SplineBlock {
    /// Indices of its chords.
    pub fn chords(&self) -> RangeInclusive<usize> {
        self.first..=self.last
    }
}

impl MotionOperation {
    /// The spline block of a move, and its index.
    pub fn spline(&self, index: usize) -> Option<(usize, &SplineBlock)> {
        let at = self.splines.partition_point(|spline| spline.last < index);
        self.splines.get(at).filter(|spline| spline.first <= index).map(|spline| (at, spline))
    }

    /// Whether the axes come to rest before a move: before the last rapid of several in a row. There the tool turns
    /// from its way over the part to its way in, at a speed near zero. What comes behind such a rest does not depend on what
    /// is before it.
    pub fn rests_before(&self, index: usize) -> bool {
        let rapid = |i: usize| self.moves.get(i).is_some_and(|m| m.kind == MoveKind::Rapid);
        index > 0 && rapid(index - 1) && rapid(index) && !rapid(index + 1)
    }

    /// Whether a move goes on in the direction of the move before it: both are chords of one spline block, or of two that
    /// have no corner between them.
    pub fn runs_on(&self, index: usize) -> bool {
        let Some((at, spline)) = self.spline(index) else { return false };
        if index > spline.first {
            return true;
        }
        let before = at.checked_sub(1).and_then(|before| self.splines.get(before));
        before.is_some_and(|before| before.last + 1 == index && before.curve.runs_on(&spline.curve))
    }
}

/// Kind of a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MoveKind {
    /// At rapid, in air.
    Rapid,
    /// At link feed: into and out of the channel along the tool axis, and between passes.
    Link,
    /// Cutting.
    Cut,
}

/// A move to a joint position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointMove {
    /// Kind.
    pub kind: MoveKind,
    /// Target, in the ISO sense of the rotary axes.
    pub joints: Joints,
    /// Feed of the tip along the part in mm/min; `None` at rapid. The axes can follow it at every place of the move.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub feed: Option<f64>,
    /// Time of the move in seconds, from the feed and the axis speeds.
    pub time: f64,
    /// Index into the labels.
    pub pass: u32,
    /// The control comes to rest at the end of the move. Set for a control that needs commands to stop (LinuxCNC),
    /// false for others.
    pub stop: bool,
}
