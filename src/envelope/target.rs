//! What is asked of the swept tool at points, and how shifts of the control points change it.

use super::band::dot;
use super::deviation::{Deviation, Mounted, deviations};
use super::program::ENTRIES;
use crate::geom::DualCurve;
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

/// Deviations of all targets for one curve.
#[derive(Clone, Debug)]
pub struct Measured {
    /// One for each target.
    pub at: Vec<Deviation>,
}

impl Measured {
    /// Measures a curve.
    pub fn new(curve: &DualCurve, tool: &Mounted<'_>, targets: &[Target]) -> Self {
        Self { at: deviations(curve, tool, targets, None) }
    }

    /// Measures a curve that runs near the one measured here.
    #[must_use]
    pub fn again(&self, curve: &DualCurve, tool: &Mounted<'_>, targets: &[Target]) -> Self {
        Self { at: deviations(curve, tool, targets, Some(&self.at)) }
    }

    /// Most that any target lacks below and above, each at least zero.
    pub fn lack(&self, targets: &[Target]) -> [f64; 2] {
        let mut most = [0.0_f64; 2];
        for (d, t) in self.at.iter().zip(targets) {
            most[0] = most[0].max(t.low - d.value);
            most[1] = most[1].max(d.value - t.high);
        }
        most
    }

    /// Most that any target lacks on either side, mm, at least zero.
    pub fn worst(&self, targets: &[Target]) -> f64 {
        let [below, above] = self.lack(targets);
        below.max(above)
    }

    /// Least widening of all bounds, each in its share, that makes them hold; infinite when one that does not give way
    /// is broken.
    pub fn widening(&self, targets: &[Target]) -> f64 {
        let share = |lack: f64, give: f64| if lack <= ROUNDING { 0.0 } else { lack / give };
        self.at.iter().zip(targets).fold(0.0, |most, (d, t)| {
            most.max(share(t.low - d.value, t.give[0])).max(share(d.value - t.high, t.give[1]))
        })
    }
}

/// A bound that does not give way holds to this much, mm: what programs and their linear models leave.
pub(super) const ROUNDING: f64 = 2e-6;

/// The change of one deviation with the shifts of the control points: those of four points of each curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// First unknown that counts.
    pub(super) first: usize,
    /// Change with it and the next ones: for each control point with the lower and with the upper one, x y z each.
    pub(super) change: [f64; ENTRIES],
}

impl Row {
    pub(super) fn new(curve: &DualCurve, at: &Deviation) -> Self {
        let (first, weights) = curve.weights(at.t);
        let parts = [at.lower, at.upper];
        Self { first: 6 * first, change: std::array::from_fn(|i| weights[i / 6] * parts[i % 6 / 3][i % 3]) }
    }

    pub(super) fn all(curve: &DualCurve, measured: &Measured) -> Vec<Self> {
        measured.at.iter().map(|d| Self::new(curve, d)).collect()
    }

    /// Change by a shift of all unknowns.
    pub(super) fn times(&self, shift: &[f64]) -> f64 {
        dot(&self.change, &shift[self.first..self.first + ENTRIES])
    }

    /// Largest change by shifts of at most one.
    pub(super) fn reach(&self) -> f64 {
        self.change.iter().map(|x| x.abs()).sum()
    }
}
