//! The path of a tool axis as dual NURBS: two curves on common knots and parameter (Wei 1 for both).

use super::basis::{self, MAX_DEGREE};
use nalgebra::{Point3, Rotation3, Vector3};

/// Degree of both curves.
const DEGREE: usize = 3;

/// Two cubic B-splines on common knots: a point of the tool axis near the tip, and a point further up.
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
    /// Unit vector from the lower point to the point of the upper curve.
    pub axis: Vector3<f64>,
    /// Distance between both points.
    pub length: f64,
}

impl DualCurve {
    /// The curves on uniform knots nearest to pairs of points at equally spaced parameters in [0, 1], by least squares.
    /// `None` for fewer pairs than control points, or fewer than four control points.
    pub fn through(pairs: &[[Point3<f64>; 2]], control: usize) -> Option<Self> {
        let last = pairs.len().saturating_sub(1).max(1) as f64;
        if control <= DEGREE || pairs.len() < control {
            return None;
        }
        let spans = control - DEGREE;
        let mut knots = vec![0.0; DEGREE];
        knots.extend((0..=spans).map(|i| i as f64 / spans as f64));
        knots.extend([1.0; DEGREE]);
        let mut normal = nalgebra::DMatrix::<f64>::zeros(control, control);
        let mut right = nalgebra::DMatrix::<f64>::zeros(control, 6);
        for (i, pair) in pairs.iter().enumerate() {
            let basis = basis::evaluate(&knots, DEGREE, i as f64 / last, 0);
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

    /// The same curves in the opposite direction.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self {
            knots: self.knots.iter().rev().map(|knot| 1.0 - knot).collect(),
            lower: self.lower.iter().rev().copied().collect(),
            upper: self.upper.iter().rev().copied().collect(),
        }
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

    /// Number of control points of one curve.
    pub fn control_count(&self) -> usize {
        self.lower.len()
    }

    /// Number of unknowns: six for each pair of control points.
    pub fn unknowns(&self) -> usize {
        6 * self.lower.len()
    }

    /// Index of the first control point with a weight at `t`, and the weights of four control points.
    pub fn weights(&self, t: f64) -> (usize, [f64; MAX_DEGREE + 1]) {
        let basis = basis::evaluate(&self.knots, DEGREE, t, 0);
        (basis.first, basis.values[0])
    }

    /// The axis at `t` in [0, 1].
    pub fn at(&self, t: f64) -> AxisAt {
        let (first, weights) = self.weights(t);
        let (lower, upper) = (mix(&self.lower[first..], &weights), mix(&self.upper[first..], &weights));
        AxisAt::between(lower, upper)
    }

    /// The axis at `t` and the derivatives of both curves by t.
    pub fn moving(&self, t: f64) -> (AxisAt, [Vector3<f64>; 2]) {
        let basis = basis::evaluate(&self.knots, DEGREE, t, 1);
        let [values, first, _] = &basis.values;
        let (lower, upper) = (mix(&self.lower[basis.first..], values), mix(&self.upper[basis.first..], values));
        (
            AxisAt::between(lower, upper),
            [mix(&self.lower[basis.first..], first), mix(&self.upper[basis.first..], first)],
        )
    }

    /// For each control point of the second derivative by t, the weights of three neighbouring control points.
    pub fn second_derivative(&self) -> Vec<[f64; 3]> {
        let k = &self.knots;
        let first = |i: usize| DEGREE as f64 / (k[i + DEGREE + 1] - k[i + 1]);
        let second = |i: usize| (DEGREE - 1) as f64 / (k[i + DEGREE + 1] - k[i + 2]);
        let weights = |i: usize| [first(i), -first(i) - first(i + 1), first(i + 1)].map(|w| second(i) * w);
        (0..self.control_count() - 2).map(weights).collect()
    }

    /// The same curves with an additional knot in the middle of each span.
    #[must_use]
    pub fn refined(&self) -> Self {
        let mut out = self.clone();
        let inner = self.knots.windows(2).filter(|k| k[1] > k[0]).map(|k| 0.5 * (k[0] + k[1]));
        for knot in inner {
            // Boehm: the control points whose functions contain the knot move towards their neighbours.
            let span = basis::span(&out.knots, DEGREE, knot);
            let insert = |points: &[Point3<f64>]| -> Vec<Point3<f64>> {
                let share = |i: usize| (knot - out.knots[i]) / (out.knots[i + DEGREE] - out.knots[i]);
                let new = (span + 1 - DEGREE..=span).map(|i| points[i - 1] + (points[i] - points[i - 1]) * share(i));
                points[..=span - DEGREE].iter().copied().chain(new).chain(points[span..].iter().copied()).collect()
            };
            let (lower, upper) = (insert(&out.lower), insert(&out.upper));
            out.knots.insert(span + 1, knot);
            (out.lower, out.upper) = (lower, upper);
        }
        out
    }

    /// The curves as polynomials, for many evaluations.
    pub fn pieces(&self) -> Pieces {
        let inner = &self.knots[DEGREE..self.knots.len() - DEGREE];
        let piece = |ends: &[f64]| {
            let width = ends[1] - ends[0];
            let (from, to) =
                (basis::evaluate(&self.knots, DEGREE, ends[0], 2), basis::evaluate(&self.knots, DEGREE, ends[1], 0));
            let coefficients = |points: &[Point3<f64>]| {
                let [value, first, second] = from.values.map(|w| mix(&points[from.first..], &w));
                let (first, second) = (first * width, second * (0.5 * width * width));
                let end = mix(&points[to.first..], &to.values[0]);
                [value, first, second, end - value - first - second]
            };
            DualPiece { lower: coefficients(&self.lower), upper: coefficients(&self.upper) }
        };
        Pieces { breaks: inner.to_vec(), pieces: inner.windows(2).map(piece).collect() }
    }

    /// The curves with shifted control points: for each pair three numbers for the lower point and three for the upper
    /// point.
    #[must_use]
    pub fn shifted(&self, by: &[f64], share: f64) -> Self {
        let mut out = self.clone();
        for ((lower, upper), by) in out.lower.iter_mut().zip(&mut out.upper).zip(by.chunks_exact(6)) {
            *lower += Vector3::new(by[0], by[1], by[2]) * share;
            *upper += Vector3::new(by[3], by[4], by[5]) * share;
        }
        out
    }

    /// The curves after a rotation.
    #[must_use]
    pub fn turned(&self, turn: &Rotation3<f64>) -> Self {
        Self {
            knots: self.knots.clone(),
            lower: self.lower.iter().map(|p| turn * p).collect(),
            upper: self.upper.iter().map(|p| turn * p).collect(),
        }
    }
}

/// Both curves over one span, as polynomials of the share of the span.
#[derive(Clone, Copy, Debug)]
struct DualPiece {
    lower: [Vector3<f64>; 4],
    upper: [Vector3<f64>; 4],
}

/// A [`DualCurve`] as polynomials, one per knot span: several times as fast to evaluate.
#[derive(Clone, Debug)]
pub struct Pieces {
    breaks: Vec<f64>,
    pieces: Vec<DualPiece>,
}

impl Pieces {
    /// Share of the span at `t` in [0, 1], the inverse of the width of the span, and the polynomials.
    fn local(&self, t: f64) -> (f64, f64, &DualPiece) {
        let last = self.pieces.len() - 1;
        let i = self.breaks[1..=last].partition_point(|b| *b <= t);
        let inverse = 1.0 / (self.breaks[i + 1] - self.breaks[i]);
        ((t - self.breaks[i]) * inverse, inverse, &self.pieces[i])
    }

    /// The axis at `t` in [0, 1].
    pub fn at(&self, t: f64) -> AxisAt {
        let (x, _, piece) = self.local(t);
        AxisAt::between(value(&piece.lower, x), value(&piece.upper, x))
    }

    /// The axis at `t` and the derivatives of both curves by t.
    pub fn moving(&self, t: f64) -> (AxisAt, [Vector3<f64>; 2]) {
        let (x, inverse, piece) = self.local(t);
        let rate = |c: &[Vector3<f64>; 4]| ((c[3] * (3.0 * x) + c[2] * 2.0) * x + c[1]) * inverse;
        let at = AxisAt::between(value(&piece.lower, x), value(&piece.upper, x));
        (at, [rate(&piece.lower), rate(&piece.upper)])
    }
}

fn value(c: &[Vector3<f64>; 4], x: f64) -> Vector3<f64> {
    ((c[3] * x + c[2]) * x + c[1]) * x + c[0]
}

impl AxisAt {
    fn between(lower: Vector3<f64>, upper: Vector3<f64>) -> Self {
        let between = upper - lower;
        let length = between.norm_squared().sqrt();
        Self { lower: Point3::from(lower), axis: between / length, length }
    }
}

fn mix(points: &[Point3<f64>], weights: &[f64; MAX_DEGREE + 1]) -> Vector3<f64> {
    points.iter().zip(weights).fold(Vector3::zeros(), |sum, (p, w)| sum + p.coords * *w)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve() -> DualCurve {
        let at = |t: f64| Point3::new(40.0 * t, 9.0 * (5.0 * t).sin(), 6.0 * (4.0 * t).cos());
        let pairs: Vec<[Point3<f64>; 2]> = (0..=80)
            .map(|i| at(f64::from(i) / 80.0))
            .map(|p| [p, p + Vector3::new(3.0, 0.3 * p.y, 20.0 + p.x * 0.1)])
            .collect();
        DualCurve::through(&pairs, 9).unwrap()
    }

    #[test]
    fn polynomials_and_finer_knots_give_the_same_curves() {
        let curve = curve();
        let (pieces, refined) = (curve.pieces(), curve.refined());
        assert_eq!(refined.control_count(), 15);
        for i in 0..=500 {
            let t = f64::from(i) / 500.0;
            let (at, rates) = curve.moving(t);
            let (same, same_rates) = pieces.moving(t);
            let finer = refined.moving(t);
            for (other, other_rates) in [(same, same_rates), finer] {
                assert!((other.lower - at.lower).norm() < 1e-12, "{t}");
                assert!((other.axis - at.axis).norm() < 1e-12, "{t}");
                assert!((other.length - at.length).abs() < 1e-12, "{t}");
                for k in 0..2 {
                    assert!((other_rates[k] - rates[k]).norm() < 1e-10, "{t}");
                }
            }
            assert_eq!(pieces.at(t), same);
        }
    }
}
