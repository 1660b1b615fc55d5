//! Cutter location plan: tip and axis at every station of the passes, in the part frame.

use crate::program::OperationId;
use nalgebra::{Point3, Rotation3, Vector3};
use serde::{Deserialize, Serialize};

/// Cutter locations of all passes, operation by operation.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClPlan {
    /// Operations in machining order.
    pub operations: Vec<ClOperation>,
}

/// Cutter locations of one operation; `link-moves` joins them to one sequence of moves.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClOperation {
    /// Id of the operation.
    pub operation: OperationId,
    /// Passes in cutting order; kept as the reference of the intended result.
    pub passes: Vec<ClPass>,
    /// Decisions for the reader.
    pub notes: Vec<String>,
}

/// One cutting pass.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClPass {
    /// Name within the operation; without the sector before `copy-sectors`.
    pub label: String,
    /// Sector of the pass; 0 before `copy-sectors`.
    pub sector: u32,
    /// Stations in cutting order.
    pub points: Vec<ClPoint>,
    /// Indices of the stations that the tool reaches from the station before through air, at link feed; in order.
    pub air: Vec<usize>,
    /// Places between the end of the pass before and the start of this one; the tool goes straight from each to the next.
    /// `None` where the link is not decided yet.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub link: Option<Vec<ClPoint>>,
}

/// Tip and axis of the tool, and its contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClPoint {
    /// Tool tip.
    pub tip: Point3<f64>,
    /// Unit vector from the tip to the holder.
    pub axis: Vector3<f64>,
    /// Contact point on the design, where there is one.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub contact: Option<Point3<f64>>,
}

impl ClPoint {
    /// The same place in another sector.
    #[must_use]
    pub fn turned(&self, turn: &Rotation3<f64>) -> Self {
        Self { tip: turn * self.tip, axis: turn * self.axis, contact: self.contact.map(|c| turn * c) }
    }
}
