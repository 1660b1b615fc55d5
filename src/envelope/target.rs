//! What is asked of the swept tool at points, and how shifts of the control points change it.

use super::deviation::{Deviation, Mounted, deviations};
use crate::geom::DualCurve;
use nalgebra::{Point3, Vector3};

/// A point of the design with the deviation that it may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Position.
    pub point: Point3<f64>,
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
        Self { point, low: 0.0, high: 0.0, give: [1.0; 2] }
    }

    /// A point that the tool keeps a distance from.
    pub fn clear(point: Point3<f64>, distance: f64) -> Self {
        Self { point, low: distance, high: f64::INFINITY, give: [1.0; 2] }
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
    pub fn new(curve: &DualCurve, tool: &Mounted, targets: &[Target]) -> Self {
        Self { at: deviations(curve, tool, targets, None) }
    }

    /// Measures a curve that runs near the one measured here.
    #[must_use]
    pub fn again(&self, curve: &DualCurve, tool: &Mounted, targets: &[Target]) -> Self {
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
const ROUNDING: f64 = 2e-6;

/// The change of one deviation with the shifts of the control points: those of four points of each curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// First control point that counts.
    first: usize,
    /// Change with the points of the lower curve, x y z each, then with those of the upper one.
    change: [[f64; 12]; 2],
}

impl Row {
    pub(super) fn new(curve: &DualCurve, at: &Deviation) -> Self {
        let (first, weights) = curve.weights(at.t);
        let part = |v: &Vector3<f64>| std::array::from_fn(|i| weights[i / 3] * v[i % 3]);
        Self { first, change: [part(&at.lower), part(&at.upper)] }
    }

    pub(super) fn all(curve: &DualCurve, measured: &Measured) -> Vec<Self> {
        measured.at.iter().map(|d| Self::new(curve, d)).collect()
    }

    /// Number of the unknown and change with it, for all that count; `control` points make a curve.
    pub(super) fn entries(&self, control: usize) -> impl Iterator<Item = (usize, f64)> {
        let (first, change) = (self.first, self.change);
        (0..2).flat_map(move |k| (0..12).map(move |i| (3 * (first + k * control) + i, change[k][i])))
    }

    /// Change by a shift of all unknowns.
    pub(super) fn times(&self, shift: &[f64]) -> f64 {
        let control = shift.len() / 6;
        let part = |k: usize| {
            let at = 3 * (self.first + k * control);
            self.change[k].iter().zip(&shift[at..at + 12]).map(|(a, b)| a * b).sum::<f64>()
        };
        part(0) + part(1)
    }

    /// Largest change by shifts of at most one.
    pub(super) fn reach(&self) -> f64 {
        self.change.iter().flatten().map(|x| x.abs()).sum()
    }
}
