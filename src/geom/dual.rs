//! The path of a tool axis as dual NURBS: two curves on common knots and parameter (Wei 1 for both).

use super::basis::{self, MAX_DEGREE};
use nalgebra::{Point3, Rotation3, Vector3};

/// Degree of both curves.
const DEGREE: usize = 3;

/// Two cubic B-splines on common knots: a point of the tool axis near the tip, and one further up.
#[derive(Clone, Debug, PartialEq)]
pub struct DualCurve {
    knots: Vec<f64>,
    lower: Vec<Point3<f64>>,
    upper: Vec<Point3<f64>>,
}

/// The tool axis at a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisAt {
    /// Point of the lower curve.
    pub lower: Point3<f64>,
    /// Unit vector from there to the point of the upper curve.
    pub axis: Vector3<f64>,
    /// Distance of both points.
    pub length: f64,
}

impl DualCurve {
    /// The curves on even knots that come nearest to pairs of points at evenly spaced parameters in [0, 1], by least
    /// squares. `None` for fewer pairs than control points, or fewer than four of these.
    pub fn through(pairs: &[[Point3<f64>; 2]], control: usize) -> Option<Self> {
        let last = pairs.len().saturating_sub(1).max(1) as f64;
        let parameters: Vec<f64> = (0..pairs.len()).map(|i| i as f64 / last).collect();
        Self::fitted(&parameters, pairs, control)
    }

    /// The same at parameters of their own. `None` as well where a span of the knots has too few of them.
    pub fn fitted(parameters: &[f64], pairs: &[[Point3<f64>; 2]], control: usize) -> Option<Self> {
        if control <= DEGREE || pairs.len() < control {
            return None;
        }
        let spans = control - DEGREE;
        let mut knots = vec![0.0; DEGREE];
        knots.extend((0..=spans).map(|i| i as f64 / spans as f64));
        knots.extend([1.0; DEGREE]);
        let mut normal = nalgebra::DMatrix::<f64>::zeros(control, control);
        let mut right = nalgebra::DMatrix::<f64>::zeros(control, 6);
        for (t, pair) in parameters.iter().zip(pairs) {
            let basis = basis::evaluate(&knots, DEGREE, *t, 0);
            for (j, a) in basis.values[0].iter().enumerate() {
                for (k, b) in basis.values[0].iter().enumerate() {
                    normal[(basis.first + j, basis.first + k)] += a * b;
                }
                for axis in 0..3 {
                    right[(basis.first + j, axis)] += a * pair[0][axis];
                    right[(basis.first + j, axis + 3)] += a * pair[1][axis];
                }
            }
        }
        let solved = normal.cholesky()?.solve(&right);
        let row = |i: usize, at: usize| Point3::new(solved[(i, at)], solved[(i, at + 1)], solved[(i, at + 2)]);
        Some(Self {
            knots,
            lower: (0..control).map(|i| row(i, 0)).collect(),
            upper: (0..control).map(|i| row(i, 3)).collect(),
        })
    }

    /// Knots, clamped to [0, 1].
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Control points of the lower curve.
    pub fn lower(&self) -> &[Point3<f64>] {
        &self.lower
    }

    /// Control points of the upper curve.
    pub fn upper(&self) -> &[Point3<f64>] {
        &self.upper
    }

    /// Control points of one curve.
    pub fn control_count(&self) -> usize {
        self.lower.len()
    }

    /// Numbers that say where the curves run: six for each pair of control points.
    pub fn unknowns(&self) -> usize {
        6 * self.lower.len()
    }

    /// Index of the first control point that counts at `t`, and the weights of the four.
    pub fn weights(&self, t: f64) -> (usize, [f64; MAX_DEGREE + 1]) {
        let basis = basis::evaluate(&self.knots, DEGREE, t, 0);
        (basis.first, basis.values[0])
    }

    /// The axis at `t` in [0, 1].
    pub fn at(&self, t: f64) -> AxisAt {
        let (first, weights) = self.weights(t);
        let (lower, upper) = (mix(&self.lower[first..], &weights), mix(&self.upper[first..], &weights));
        let between = upper - lower;
        let length = between.norm_squared().sqrt();
        AxisAt { lower: Point3::from(lower), axis: between / length, length }
    }

    /// The axis at `t` and the derivatives of both curves by t.
    pub fn moving(&self, t: f64) -> (AxisAt, [Vector3<f64>; 2]) {
        let basis = basis::evaluate(&self.knots, DEGREE, t, 1);
        let [values, first, _] = &basis.values;
        let (lower, upper) = (mix(&self.lower[basis.first..], values), mix(&self.upper[basis.first..], values));
        let between = upper - lower;
        let length = between.norm_squared().sqrt();
        let at = AxisAt { lower: Point3::from(lower), axis: between / length, length };
        (at, [mix(&self.lower[basis.first..], first), mix(&self.upper[basis.first..], first)])
    }

    /// The curves with their control points shifted: three numbers for each lower and then for each upper point.
    #[must_use]
    pub fn shifted(&self, by: &[f64], share: f64) -> Self {
        let mut out = self.clone();
        let n = self.lower.len();
        for (i, p) in out.lower.iter_mut().chain(&mut out.upper).enumerate().take(2 * n) {
            *p += Vector3::new(by[3 * i], by[3 * i + 1], by[3 * i + 2]) * share;
        }
        out
    }

    /// The curves turned.
    #[must_use]
    pub fn turned(&self, turn: &Rotation3<f64>) -> Self {
        Self {
            knots: self.knots.clone(),
            lower: self.lower.iter().map(|p| turn * p).collect(),
            upper: self.upper.iter().map(|p| turn * p).collect(),
        }
    }
}

fn mix(points: &[Point3<f64>], weights: &[f64; MAX_DEGREE + 1]) -> Vector3<f64> {
    points.iter().zip(weights).fold(Vector3::zeros(), |sum, (p, w)| sum + p.coords * *w)
}
