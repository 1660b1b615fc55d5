//! Machine motion: joint positions of every move.
//!
//! Meaning of a move, shared by planner, verifier and posts: tool centre point control is on. Between two moves of
//! one operation the tip, in the part frame, runs on a straight line and the rotary axes run linearly with it; the
//! linear joints follow from both.
//!
//! The first and the last move of an operation lead to stations at the retract height of the machine. The tool goes down
//! from the first station and up to the last one along Z. Between operations the tool stays at that height, where X, Y and
//! the rotary axes move with tool centre point control off, from wherever they stand.

use crate::ir::program::OperationId;
use crate::kin::Joints;

/// All moves, operation by operation.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    /// Operations in machining order.
    pub operations: Vec<MotionOperation>,
}

/// Moves of one operation, with one tool.
#[derive(Clone, Debug)]
pub struct MotionOperation {
    /// Which one.
    pub operation: OperationId,
    /// Labels of the passes that [`JointMove::pass`] indexes.
    pub labels: Vec<String>,
    /// Moves in order.
    pub moves: Vec<JointMove>,
}

/// How a move is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveKind {
    /// At rapid, in air.
    Rapid,
    /// At link feed: into and out of the channel along the tool axis, and between passes.
    Link,
    /// Cutting.
    Cut,
}

/// A move to a joint position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointMove {
    /// How.
    pub kind: MoveKind,
    /// Where to, in the ISO sense of the rotary axes.
    pub joints: Joints,
    /// Feed of the tip along the part in mm/min; `None` at rapid. Never above what the axes can follow.
    pub feed: Option<f64>,
    /// Time of the move in seconds, from the feed and the axis speeds.
    pub time: f64,
    /// Index into the labels.
    pub pass: u32,
    /// The control comes to rest at its end. Said for controls that are told where to stop (LinuxCNC), false for others.
    pub stop: bool,
}
