//! Cutter contact plan: where each pass runs on the part, before the tool has an axis.

use crate::program::OperationId;
use nalgebra::{Point3, Vector3};
use nurbs::DualCurve;
use serde::{Deserialize, Serialize};
use wheel::part::{BladeId, FaceId, PassageId, SurfaceKind};

/// Passes of all operations, in sector 0; their cutter locations are copied to the other sectors.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CcPlan {
    /// Operations in machining order.
    pub operations: Vec<CcOperation>,
}

/// Passes of one operation.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CcOperation {
    /// Id of the operation.
    pub operation: OperationId,
    /// Passes in cutting order.
    pub passes: Vec<CcPass>,
    /// Decisions for the reader: counts, steps, and the rules behind them.
    pub notes: Vec<String>,
}

/// One pass: a curve on the surface or in the channel that drives the tool.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CcPass {
    /// Name within the operation and a sector, such as `layer 3 line 2`.
    pub label: String,
    /// Surface or channel that drives the tool.
    pub drive: Drive,
    /// Stations in cutting order.
    pub points: Vec<CcPoint>,
    /// Path of the tool axis, where the pass was computed as a whole path: the lower curve is that of the tip. The
    /// stations are at evenly spaced parameters; the first and the last are the ends of the leads.
    #[serde(deserialize_with = "Deserialize::deserialize")]
    pub path: Option<DualCurve>,
}

/// Surface or channel that drives the tool of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Drive {
    /// The channel: the tip runs through its inside.
    Channel,
    /// The strip of a vane face with this number, from 0 at the root.
    Face {
        /// Face of the vane.
        side: FaceId,
        /// Strip.
        strip: u32,
    },
    /// The hub in a passage, under a ball.
    Hub(PassageId),
    /// The hub in a passage, under a bull nose: its axis leans ahead of the normal by this angle, radians, along the channel.
    HubWithLead(PassageId, f64),
    /// A face, fillet or edge of a vane, by its contact points.
    Contact(SurfaceKind),
    /// A blade, by contact points round it.
    Round(BladeId),
}

/// One station.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CcPoint {
    /// Along the channel from inlet (0) to outlet (1); outside of this range on a lead.
    pub u: f64,
    /// From hub (0) to shroud (1).
    pub v: f64,
    /// Across the channel from its first wall (0) to its second (1). In a strip: the upper end of the strip. Round a
    /// vane: the position along the line; 0 on the first face, 0 to 2 over the inlet edge, 2 on the other face, 2 to 4
    /// over the outlet edge.
    pub w: f64,
    /// Contact or drive point in the part frame.
    pub position: Point3<f64>,
    /// Outward normal of the drive surface there.
    pub normal: Vector3<f64>,
}
