//! Deviations of all targets, and their derivatives by the control points.

use super::deviation::{Deviation, Mounted, deviations};
use super::target::Target;
use crate::quadratic::dot;
use nurbs::DualCurve;
use nurbs::bezier::MAX_BEZIER_DEGREE;

/// Control points on which a deviation depends, as coordinates of both curves, at most.
pub(super) const MAX_ENTRIES: usize = 6 * (MAX_BEZIER_DEGREE + 1);

/// Deviations of all targets for one curve.
#[derive(Clone, Debug)]
pub struct Measured {
    /// One deviation per target.
    pub at: Vec<Deviation>,
}

impl Measured {
    /// Measures a curve.
    pub fn new(curve: &DualCurve, tool: &Mounted<'_>, targets: &[Target]) -> Self {
        Self { at: deviations(curve, tool, targets, None) }
    }

    /// Measures a curve similar to the one measured here.
    #[must_use]
    pub fn again(&self, curve: &DualCurve, tool: &Mounted<'_>, targets: &[Target]) -> Self {
        Self { at: deviations(curve, tool, targets, Some(&self.at)) }
    }

    /// Largest violation of the lower bounds and of the upper bounds, each at least zero.
    pub fn violation(&self, targets: &[Target]) -> [f64; 2] {
        let mut most = [0.0_f64; 2];
        for (d, t) in self.at.iter().zip(targets) {
            most[0] = most[0].max(t.low - d.value);
            most[1] = most[1].max(d.value - t.high);
        }
        most
    }

    /// Largest violation of any bound, mm, at least zero.
    pub fn worst(&self, targets: &[Target]) -> f64 {
        let [below, above] = self.violation(targets);
        below.max(above)
    }

    /// Least widening, in proportion to the shares `give`, with which all bounds hold; infinite when a bound that may
    /// not give way is violated.
    pub fn widening(&self, targets: &[Target]) -> f64 {
        let share = |violation: f64, give: f64| if violation <= VIOLATION_ROUNDING_MM { 0.0 } else { violation / give };
        self.at.iter().zip(targets).fold(0.0, |most, (d, t)| {
            most.max(share(t.low - d.value, t.give[0])).max(share(d.value - t.high, t.give[1]))
        })
    }
}

/// Violation below which a bound that may not give way counts as kept, mm: the error of programs and linear models.
pub(super) const VIOLATION_ROUNDING_MM: f64 = 2e-6;

/// Derivative of one deviation by the shifts of the control points of each curve on which it depends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// First unknown of the row.
    pub(super) first: usize,
    /// Derivatives by this unknown and the next ones: for each control point x, y, z of the lower and of the upper
    /// curve.
    change: [f64; MAX_ENTRIES],
    /// How many of these entries count.
    count: usize,
}

impl Row {
    pub(super) fn new(curve: &DualCurve, at: &Deviation) -> Self {
        let (first, weights) = curve.weights(at.t);
        let parts = [at.lower, at.upper];
        let change = std::array::from_fn(|i| weights[i / 6] * parts[i % 6 / 3][i % 3]);
        Self { first: 6 * first, change, count: curve.entries() }
    }

    pub(super) fn all(curve: &DualCurve, measured: &Measured) -> Vec<Self> {
        measured.at.iter().map(|d| Self::new(curve, d)).collect()
    }

    /// Change for a shift of all unknowns.
    pub(super) fn times(&self, shift: &[f64]) -> f64 {
        dot(self.entries(), &shift[self.first..self.first + self.count])
    }

    /// Largest change for shifts of at most one.
    pub(super) fn reach(&self) -> f64 {
        self.entries().iter().map(|x| x.abs()).sum()
    }

    /// The derivatives.
    pub(super) fn entries(&self) -> &[f64] {
        &self.change[..self.count]
    }

    /// The derivatives times a number, with zeros behind them.
    pub(super) fn scaled(&self, by: f64) -> [f64; MAX_ENTRIES] {
        self.change.map(|x| x * by)
    }
}
