//! Cutter location plan: tip and axis at every station of the passes, in the part frame.

use crate::ir::program::OperationId;
use nalgebra::{Point3, Rotation3, Vector3};

/// Cutter locations of all passes, operation by operation.
#[derive(Clone, Debug, Default)]
pub struct ClPlan {
    /// Operations in machining order.
    pub operations: Vec<ClOperation>,
}

/// Cutter locations of one operation; `link-moves` makes one sequence of moves of them.
#[derive(Clone, Debug)]
pub struct ClOperation {
    /// Which one.
    pub operation: OperationId,
    /// Passes in cutting order; kept as the reference of what was meant.
    pub passes: Vec<ClPass>,
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
