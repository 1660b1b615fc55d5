//! What is required of the swept tool at points.

use nalgebra::Point3;

/// What of the tool a target is about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Of {
    /// Signed distance of the swept cutter to the point.
    Cutter,
    /// What shank and holder have to spare there beyond the clearance that is asked of each.
    Body,
    /// How much further from Z the axis could lean at a parameter, up to an angle in radians; as the way of the point of
    /// the axis [`LEVER`] up.
    Lean {
        /// Parameter of the curves.
        t: f64,
        /// Largest angle between the axis and Z, radians.
        most: f64,
    },
}

/// Length that makes an angle a way, mm.
pub const LEVER: f64 = 100.0;

/// A point of the design with the deviation that it may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Position; for a lean where the tool is.
    pub point: Point3<f64>,
    /// What of the tool it is about.
    pub of: Of,
    /// Least deviation, mm: above zero keeps clear, minus infinity asks for nothing.
    pub low: f64,
    /// Largest deviation, mm; infinite where the tool need not reach.
    pub high: f64,
    /// Shares in which both bounds give way where they cannot all be kept: 1 evenly with others, 0 not at all.
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

    /// With more room below and above.
    #[must_use]
    pub fn widened(self, below: f64, above: f64) -> Self {
        Self { low: self.low - below, high: self.high + above, ..self }
    }
}
