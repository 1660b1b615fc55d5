//! Machine motion: joint positions of every move.
//!
//! Meaning of a move, shared by planner, verifier and posts: tool centre point control is on. Between two moves of
//! one operation the tip, in the part frame, runs on a straight line and the rotary axes run linearly with it; the
//! linear joints follow from both.
//!
//! The first and the last move of an operation lead to stations at the retract height of the machine. The tool goes
//! down from the first station and up to the last station along Z. Between operations the tool stays at that height; X,
//! Y and the rotary axes move there with tool centre point control off, from their present positions.

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
    /// Id of the operation.
    pub operation: OperationId,
    /// Labels of the passes that [`JointMove::pass`] indexes.
    pub labels: Vec<String>,
    /// Moves in order.
    pub moves: Vec<JointMove>,
}

/// Kind of a move.
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
    /// Kind.
    pub kind: MoveKind,
    /// Target, in the ISO sense of the rotary axes.
    pub joints: Joints,
    /// Feed of the tip along the part in mm/min; `None` at rapid. The axes can follow it at every place of the move.
    pub feed: Option<f64>,
    /// Time of the move in seconds, from the feed and the axis speeds.
    pub time: f64,
    /// Index into the labels.
    pub pass: u32,
    /// The control comes to rest at the end of the move. Set for a control that needs commands to stop (LinuxCNC),
    /// false for others.
    pub stop: bool,
}
