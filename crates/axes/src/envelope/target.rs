//! Bounds of the swept tool at points.

use nalgebra::Point3;

/// Part or property of the tool that a target bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Of {
    /// Signed distance of the swept cutter to the point.
    Cutter,
    /// Distance of shank and holder from the point, less the required clearance of each.
    Body,
    /// Remaining tilt of the axis against Z at a parameter, up to an angle in radians; as the motion of the axis point
    /// at the height [`LEVER`].
    Tilt {
        /// Parameter of the curves.
        t: f64,
        /// Largest angle between the axis and Z, radians.
        most: f64,
    },
}

/// Length that converts an angle to a motion, mm.
pub const LEVER: f64 = 100.0;

/// A point of the design with the bounds of its deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Position; for [`Of::Tilt`] that of the tool.
    pub point: Point3<f64>,
    /// Part or property of the tool.
    pub of: Of,
    /// Least deviation, mm: a positive value is a clearance, minus infinity is no bound.
    pub low: f64,
    /// Largest deviation, mm; infinite where the tool need not reach the point.
    pub high: f64,
    /// Shares by which both bounds give way where not all bounds can be kept: 1 like all others, 0 never.
    pub give: [f64; 2],
}

impl Target {
    /// A point that the tool has to touch.
    pub fn touched(point: Point3<f64>) -> Self {
        Self { point, of: Of::Cutter, low: 0.0, high: 0.0, give: [1.0; 2] }
    }

    /// A point that the tool keeps a distance from.
    pub fn clear(point: Point3<f64>, distance: f64) -> Self {
        Self { point, of: Of::Cutter, low: distance, high: f64::INFINITY, give: [1.0; 2] }
    }

    /// With wider bounds below and above.
    #[must_use]
    pub fn widened(self, below: f64, above: f64) -> Self {
        Self { low: self.low - below, high: self.high + above, ..self }
    }
}
