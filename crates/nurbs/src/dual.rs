//! The path of a tool axis as dual NURBS: two curves on common knots and parameter (Wei 1 for both).

use super::basis::{self, Basis};
use super::bezier::MAX_BEZIER_DEGREE;
use super::knots::{bezier, clamped, inserted, with_knot};
use super::least_squares::SoughtSpline;
use super::spline_fit;
use nalgebra::{Point3, Rotation3, SVector, Vector3};

/// Places of the basis functions.
const BASIS_PLACES: usize = MAX_BEZIER_DEGREE + 1;

/// Two B-splines of degree 3 or 5 on common knots: a point of the tool axis near the tip, and a point further up.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "StoredDual"))]
pub struct DualCurve {
    degree: usize,
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
    /// The cubics on even knots nearest to pairs of points at equally spaced parameters in [0, 1], by least squares.
    /// `None` for fewer pairs than control points, or fewer than four control points.
    pub fn through(pairs: &[[Point3<f64>; 2]], control: usize) -> Option<Self> {
        let spans = control.checked_sub(3).filter(|spans| *spans > 0)?;
        let inner: Vec<f64> = (1..spans).map(|i| i as f64 / spans as f64).collect();
        Self::nearest_to(pairs, 3, &inner)
    }

    /// The quintics nearest to pairs of points at equally spaced parameters in [0, 1]. Their fourth derivative is continuous, and
    /// their spans end where the error of all of them is about the same. `None` for too few pairs.
    pub fn quintics(pairs: &[[Point3<f64>; 2]], spans: usize) -> Option<Self> {
        let (places, parameters): (Vec<_>, Vec<f64>) = places(pairs).zip(parameters(pairs)).unzip();
        let inner = spline_fit::even_knots(&places, &parameters, MAX_BEZIER_DEGREE, spans)?;
        Self::nearest_to(pairs, MAX_BEZIER_DEGREE, &inner)
    }

    /// The curves with single inner knots.
    fn nearest_to(pairs: &[[Point3<f64>; 2]], degree: usize, inner: &[f64]) -> Option<Self> {
        let control = degree + 1 + inner.len();
        if pairs.len() < control {
            return None;
        }
        let knots = clamped([0.0, 1.0], inner.iter().copied(), degree);
        let sought = SoughtSpline { knots: &knots, degree, closed: false, ends: None, smoothing: 0.0 };
        let solved = sought.nearest_to(places(pairs), parameters(pairs))?;
        let points = |at: usize| solved.iter().map(|row| Point3::new(row[at], row[at + 1], row[at + 2])).collect();
        let [lower, upper] = [0, 3].map(points);
        Some(Self { degree, knots, lower, upper })
    }

    /// The curves of valid parts.
    #[cfg(feature = "serde")]
    pub(crate) fn of_parts(degree: usize, knots: Vec<f64>, lower: Vec<Point3<f64>>, upper: Vec<Point3<f64>>) -> Self {
        Self { degree, knots, lower, upper }
    }

    /// The same curves in the opposite direction.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self {
            degree: self.degree,
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

    /// Degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Number of unknowns on which a place of the curves depends: six for each of its control points.
    pub fn entries(&self) -> usize {
        6 * (self.degree + 1)
    }

    fn basis(&self, t: f64, order: usize) -> Basis<BASIS_PLACES> {
        // A degree that the compiler knows unrolls the loops.
        match self.degree {
            3 => basis::of_degree(&self.knots, 3, t, order),
            _ => basis::of_degree(&self.knots, self.degree, t, order),
        }
    }

    /// Index of the first control point with a weight at `t`, and the weights of as many as the degree and one more.
    pub fn weights(&self, t: f64) -> (usize, [f64; BASIS_PLACES]) {
        let basis = self.basis(t, 0);
        (basis.first, basis.values[0])
    }

    /// The axis at `t` in [0, 1].
    pub fn at(&self, t: f64) -> AxisAt {
        let (first, weights) = self.weights(t);
        AxisAt::between(mix(&self.lower[first..], &weights), mix(&self.upper[first..], &weights))
    }

    /// The axis at `t` and the derivatives of both curves by t.
    pub fn moving(&self, t: f64) -> (AxisAt, [Vector3<f64>; 2]) {
        let basis = self.basis(t, 1);
        let [values, first, _] = &basis.values;
        let (lower, upper) = (mix(&self.lower[basis.first..], values), mix(&self.upper[basis.first..], values));
        let rates = [mix(&self.lower[basis.first..], first), mix(&self.upper[basis.first..], first)];
        (AxisAt::between(lower, upper), rates)
    }

    /// For each control point of the second derivative by t, the weights of three neighbouring control points.
    pub fn second_derivative(&self) -> Vec<[f64; 3]> {
        let (k, p) = (&self.knots, self.degree);
        let first = |i: usize| p as f64 / (k[i + p + 1] - k[i + 1]);
        let second = |i: usize| (p - 1) as f64 / (k[i + p + 1] - k[i + 2]);
        let weights = |i: usize| [first(i), -first(i) - first(i + 1), first(i + 1)].map(|w| second(i) * w);
        (0..self.control_count() - 2).map(weights).collect()
    }

    /// The same curves with an additional knot in the middle of each span.
    #[must_use]
    pub fn refined(&self) -> Self {
        let p = self.degree;
        let mut out = self.clone();
        let inner = self.knots.windows(2).filter(|k| k[1] > k[0]).map(|k| 0.5 * (k[0] + k[1]));
        for knot in inner {
            let insert = |points: &[Point3<f64>]| inserted(&out.knots, p, knot, points, |a, b, t| a + (b - a) * t);
            let (lower, upper) = (insert(&out.lower), insert(&out.upper));
            out.knots = with_knot(&out.knots, p, knot);
            (out.lower, out.upper) = (lower, upper);
        }
        out
    }

    /// Ends of the spans.
    fn breaks(&self) -> Vec<f64> {
        let mut breaks = self.knots[self.degree..self.knots.len() - self.degree].to_vec();
        breaks.dedup();
        breaks
    }

    /// Bezier control points of the lower and the upper curve over each span.
    fn beziers(&self) -> Vec<[Vec<Vector3<f64>>; 2]> {
        let p = self.degree;
        let of_span = |ends: &[f64]| {
            let span = basis::span(&self.knots, p, 0.5 * (ends[0] + ends[1]));
            [&self.lower, &self.upper].map(|points| {
                let control: Vec<Vector3<f64>> = points[span - p..=span].iter().map(|point| point.coords).collect();
                bezier(&self.knots, &control, span)
            })
        };
        self.breaks().windows(2).map(of_span).collect()
    }

    /// The curves as polynomials, for many evaluations.
    pub fn pieces(&self) -> Pieces {
        let breaks = self.breaks();
        let polynomials = match self.degree {
            3 => Polynomials::Cubic(breaks.windows(2).map(|ends| self.cubic(ends)).collect()),
            _ => Polynomials::Quintic(
                self.beziers()
                    .iter()
                    .map(|[lower, upper]| DualPiece { lower: powers(lower), upper: powers(upper) })
                    .collect(),
            ),
        };
        Pieces { breaks, polynomials }
    }

    /// A span of cubics by value and derivatives at its start, and the value at its end.
    fn cubic(&self, ends: &[f64]) -> DualPiece<4> {
        let width = ends[1] - ends[0];
        let (from, to) = (self.basis(ends[0], 2), self.basis(ends[1], 0));
        let coefficients = |points: &[Point3<f64>]| {
            let [value, first, second] = from.values.map(|w| mix(&points[from.first..], &w));
            let (first, second) = (first * width, second * (0.5 * width * width));
            let end = mix(&points[to.first..], &to.values[0]);
            [value, first, second, end - value - first - second]
        };
        DualPiece { lower: coefficients(&self.lower), upper: coefficients(&self.upper) }
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
            degree: self.degree,
            knots: self.knots.clone(),
            lower: self.lower.iter().map(|p| turn * p).collect(),
            upper: self.upper.iter().map(|p| turn * p).collect(),
        }
    }
}

/// Both curves over one span, as polynomials of the share of the span; the coefficient of the power 0 first.
#[derive(Clone, Copy, Debug)]
struct DualPiece<const P: usize> {
    lower: [Vector3<f64>; P],
    upper: [Vector3<f64>; P],
}

/// A [`DualCurve`] as polynomials, one per knot span: several times as fast to evaluate.
#[derive(Clone, Debug)]
pub struct Pieces {
    breaks: Vec<f64>,
    polynomials: Polynomials,
}

/// The polynomials of all spans.
#[derive(Clone, Debug)]
enum Polynomials {
    Cubic(Vec<DualPiece<4>>),
    Quintic(Vec<DualPiece<BASIS_PLACES>>),
}

impl Pieces {
    /// Index of the span at `t` in [0, 1], the share of it, and the inverse of its width.
    fn local(&self, t: f64) -> (usize, f64, f64) {
        let last = self.breaks.len() - 2;
        let i = self.breaks[1..=last].partition_point(|b| *b <= t);
        let inverse = 1.0 / (self.breaks[i + 1] - self.breaks[i]);
        (i, (t - self.breaks[i]) * inverse, inverse)
    }

    /// The axis at `t` in [0, 1].
    pub fn at(&self, t: f64) -> AxisAt {
        let (i, x, _) = self.local(t);
        match &self.polynomials {
            Polynomials::Cubic(pieces) => pieces[i].at(x),
            Polynomials::Quintic(pieces) => pieces[i].at(x),
        }
    }

    /// The axis at `t` and the derivatives of both curves by t.
    pub fn moving(&self, t: f64) -> (AxisAt, [Vector3<f64>; 2]) {
        let (i, x, inverse) = self.local(t);
        match &self.polynomials {
            Polynomials::Cubic(pieces) => pieces[i].moving(x, inverse),
            Polynomials::Quintic(pieces) => pieces[i].moving(x, inverse),
        }
    }
}

impl<const P: usize> DualPiece<P> {
    fn at(&self, x: f64) -> AxisAt {
        AxisAt::between(value(&self.lower, x), value(&self.upper, x))
    }

    fn moving(&self, x: f64, inverse: f64) -> (AxisAt, [Vector3<f64>; 2]) {
        (self.at(x), [rate(&self.lower, x) * inverse, rate(&self.upper, x) * inverse])
    }
}

#[inline(always)]
fn value<const P: usize>(c: &[Vector3<f64>; P], x: f64) -> Vector3<f64> {
    c[..P - 1].iter().rev().fold(c[P - 1], |sum, c| sum * x + c)
}

/// Derivative by the share of the span.
#[inline(always)]
fn rate<const P: usize>(c: &[Vector3<f64>; P], x: f64) -> Vector3<f64> {
    let high = c[P - 1] * ((P - 1) as f64 * x) + c[P - 2] * (P - 2) as f64;
    (1..P - 2).rev().fold(high, |sum, k| sum * x + c[k] * k as f64)
}

/// Coefficients of the powers by Bezier control points; those above the degree are zero.
fn powers(control: &[Vector3<f64>]) -> [Vector3<f64>; BASIS_PLACES] {
    let powers = super::bezier::powers(control);
    std::array::from_fn(|k| powers.get(k).copied().unwrap_or_else(Vector3::zeros))
}

/// Both points of each pair in a row.
fn places(pairs: &[[Point3<f64>; 2]]) -> impl Iterator<Item = SVector<f64, 6>> {
    pairs.iter().map(|[p, q]| SVector::from_column_slice(&[p.x, p.y, p.z, q.x, q.y, q.z]))
}

/// Parameters of pairs at equal steps.
fn parameters(pairs: &[[Point3<f64>; 2]]) -> impl Iterator<Item = f64> {
    let last = pairs.len().saturating_sub(1).max(1) as f64;
    (0..pairs.len()).map(move |i| i as f64 / last)
}

impl AxisAt {
    fn between(lower: Vector3<f64>, upper: Vector3<f64>) -> Self {
        let between = upper - lower;
        let length = between.norm_squared().sqrt();
        Self { lower: Point3::from(lower), axis: between / length, length }
    }
}

fn mix(points: &[Point3<f64>], weights: &[f64; BASIS_PLACES]) -> Vector3<f64> {
    points.iter().zip(weights).fold(Vector3::zeros(), |sum, (p, w)| sum + p.coords * *w)
}

/// Two B-splines on common knots.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredDual {
    degree: usize,
    knots: Vec<f64>,
    lower: Vec<Point3<f64>>,
    upper: Vec<Point3<f64>>,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredDual> for DualCurve {
    type Error = crate::GeomError;

    fn try_from(StoredDual { degree, knots, lower, upper }: StoredDual) -> Result<Self, crate::GeomError> {
        if ![basis::MAX_DEGREE, MAX_BEZIER_DEGREE].contains(&degree) {
            return Err(crate::GeomError::Degree(degree));
        }
        if lower.len() != upper.len() {
            return Err(crate::GeomError::TooFewPoints { given: upper.len(), needed: lower.len() });
        }
        if !basis::valid_knots(&knots, degree, lower.len()) {
            return Err(crate::GeomError::Knots);
        }
        if let Some(i) = lower.iter().chain(&upper).position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(crate::GeomError::NotFinite(i));
        }
        Ok(Self::of_parts(degree, knots, lower, upper))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bezier;

    fn curves() -> [DualCurve; 2] {
        let at = |t: f64| Point3::new(40.0 * t, 9.0 * (5.0 * t).sin(), 6.0 * (4.0 * t).cos());
        let pairs: Vec<[Point3<f64>; 2]> = (0..=80)
            .map(|i| at(f64::from(i) / 80.0))
            .map(|p| [p, p + Vector3::new(3.0, 0.3 * p.y, 20.0 + p.x * 0.1)])
            .collect();
        [DualCurve::through(&pairs, 9), DualCurve::quintics(&pairs, 4)].map(|curve| curve.unwrap())
    }

    #[test]
    fn polynomials_and_finer_knots_give_the_same_curves() {
        for (curve, finer) in curves().iter().zip([15, 13]) {
            let (pieces, refined, beziers) = (curve.pieces(), curve.refined(), curve.beziers());
            assert_eq!((curve.control_count(), refined.control_count()), (9, finer));
            let breaks = curve.breaks();
            assert_eq!(beziers.len() + 1, breaks.len());
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
                // De Casteljau's steps know no knots.
                let span = breaks[1..beziers.len()].partition_point(|b| *b <= t);
                let share = (t - breaks[span]) / (breaks[span + 1] - breaks[span]);
                let [lower, upper] = [0, 1].map(|k| bezier::value(&beziers[span][k], share));
                assert!((lower - at.lower.coords).norm() < 1e-12, "{t}");
                assert!(((upper - lower).normalize() - at.axis).norm() < 1e-12, "{t}");
            }
        }
    }

    /// Second derivatives by differences of the first.
    #[test]
    fn second_derivatives_are_those_of_differences() {
        for curve in curves() {
            // At the start the first control point of the derivative counts alone.
            let weights = curve.second_derivative()[0];
            let due: Vector3<f64> = weights.iter().zip(curve.lower()).map(|(w, p)| p.coords * *w).sum();
            let rate = |t: f64| curve.moving(t).1[0];
            let found = (rate(0.0) * -3.0 + rate(1e-4) * 4.0 - rate(2e-4)) / 2e-4;
            assert!((due - found).norm() < 1e-3 * due.norm(), "{due} {found}");
        }
    }
}
