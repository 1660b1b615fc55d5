//! Cutter location plan: tip and axis of every move in the part frame.

use crate::ir::program::OperationId;
use nalgebra::{Point3, Rotation3, Vector3};

/// All moves of the program, operation by operation.
#[derive(Clone, Debug, Default)]
pub struct ClPlan {
    /// Operations in machining order.
    pub operations: Vec<ClOperation>,
}

/// Moves of one operation. Passes come from `orient-tool`; `link-moves` turns them into the one sequence of moves.
#[derive(Clone, Debug)]
pub struct ClOperation {
    /// Which one.
    pub operation: OperationId,
    /// Cutting passes in order; kept as the reference of what was meant.
    pub passes: Vec<ClPass>,
    /// Every move in order, links included; empty before `link-moves`.
    pub moves: Vec<ClMove>,
    /// Decisions worth reading.
    pub notes: Vec<String>,
}

/// One cutting pass.
#[derive(Clone, Debug)]
pub struct ClPass {
    /// Name within the operation; without the sector before `copy-sectors`.
    pub label: String,
    /// Sector that it lies in; 0 before `copy-sectors`.
    pub sector: u32,
    /// Stations in cutting order.
    pub points: Vec<ClPoint>,
}

/// Tip and axis of the tool, and where it touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClPoint {
    /// Tool tip.
    pub tip: Point3<f64>,
    /// Unit vector from the tip to the holder.
    pub axis: Vector3<f64>,
    /// Contact point on the design, where there is one.
    pub contact: Option<Point3<f64>>,
}

impl ClPoint {
    /// The same place in another sector.
    #[must_use]
    pub fn turned(&self, turn: &Rotation3<f64>) -> Self {
        Self { tip: turn * self.tip, axis: turn * self.axis, contact: self.contact.map(|c| turn * c) }
    }
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

/// A move to a cutter location.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClMove {
    /// How.
    pub kind: MoveKind,
    /// Where to.
    pub to: ClPoint,
    /// Index of the pass that it belongs to or leads to.
    pub pass: u32,
    /// Feed in mm/min; `None` at rapid.
    pub feed: Option<f64>,
}
