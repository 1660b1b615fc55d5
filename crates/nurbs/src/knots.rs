//! Knot insertion, merging of knot vectors and degree elevation; they do not change the curve.

use super::NurbsCurve;
use super::basis::{self, MAX_DEGREE};
use super::bezier::MAX_BEZIER_DEGREE;
use nalgebra::{SVector, Vector4};

/// The smallest knot vector that contains both, each knot with the larger of both multiplicities.
pub fn merge_knots(a: &[f64], b: &[f64]) -> Vec<f64> {
    let (mut i, mut j) = (0, 0);
    let mut merged = Vec::with_capacity(a.len() + b.len());
    while i < a.len() || j < b.len() {
        match (a.get(i), b.get(j)) {
            (Some(x), Some(y)) if x == y => {
                merged.push(*x);
                i += 1;
                j += 1;
            }
            (Some(x), y) if y.is_none_or(|y| x < y) => {
                merged.push(*x);
                i += 1;
            }
            (_, Some(y)) => {
                merged.push(*y);
                j += 1;
            }
            (_, None) => break,
        }
    }
    merged
}

/// Knots of a clamped spline of a degree from `from` to `to`, with inner knots that ascend.
pub(super) fn clamped([from, to]: [f64; 2], inner: impl IntoIterator<Item = f64>, degree: usize) -> Vec<f64> {
    let end = |u: f64| std::iter::repeat_n(u, degree + 1);
    end(from).chain(inner).chain(end(to)).collect()
}

/// Knots with an additional one inside of the domain.
pub(super) fn with_knot(knots: &[f64], degree: usize, u: f64) -> Vec<f64> {
    let mut more = knots.to_vec();
    more.insert(basis::span(knots, degree, u) + 1, u);
    more
}

/// Control points of the same spline with an additional knot inside of the domain (Boehm 1980): those whose functions contain the knot
/// move towards their neighbours. `mix` gives a (1 - t) + b t for a, b and t.
pub(super) fn inserted<T: Copy>(
    knots: &[f64],
    degree: usize,
    u: f64,
    control: &[T],
    mix: impl Fn(T, T, f64) -> T,
) -> Vec<T> {
    let span = basis::span(knots, degree, u);
    let times = knots.iter().filter(|k| **k == u).count();
    let share = |i: usize| (u - knots[i]) / (knots[i + degree] - knots[i]);
    let moved = (span - degree + 1..=span - times).map(|i| mix(control[i - 1], control[i], share(i)));
    control[..=span - degree].iter().copied().chain(moved).chain(control[span - times..].iter().copied()).collect()
}

/// Bezier control points of a span that is not empty: point k has k times its end as argument of the symmetric form, and otherwise its
/// start (The NURBS Book, 5.6). `control` are the points with a weight there, one more than the degree, which is at most five.
pub fn bezier<const N: usize>(knots: &[f64], control: &[SVector<f64, N>], span: usize) -> Vec<SVector<f64, N>> {
    let degree = control.len() - 1;
    let mut own = [SVector::zeros(); MAX_BEZIER_DEGREE + 1];
    own[..=degree].copy_from_slice(control);
    let point = |k: usize| {
        let end = |step: usize| knots[if step < degree - k { span } else { span + 1 }];
        basis::blossom(knots, degree, span, own, end, |a: SVector<f64, N>, b, t| a.lerp(&b, t))
    };
    (0..=degree).map(point).collect()
}

impl NurbsCurve {
    /// The same curve with an additional knot at `u` (Boehm 1980). A knot at an end of the domain, or with multiplicity
    /// `degree` already, is not added.
    #[must_use]
    pub fn with_knot(&self, u: f64) -> Self {
        let p = self.degree();
        let knots = self.knots();
        let times = knots.iter().filter(|k| **k == u).count();
        if !(u > 0.0 && u < 1.0) || times >= p {
            return self.clone();
        }
        // Convex combinations in the homogeneous space.
        let control = inserted(knots, p, u, self.control(), |a, b, t| b * t + a * (1.0 - t));
        Self::from_homogeneous(p, with_knot(knots, p, u), control)
    }

    /// The same curve on a finer knot vector: inserts every knot of `target` with a higher multiplicity than in the
    /// curve.
    #[must_use]
    pub fn refined(&self, target: &[f64]) -> Self {
        let mut curve = self.clone();
        for (i, u) in target.iter().enumerate() {
            let wanted = target[..=i].iter().filter(|k| *k == u).count();
            if curve.knots().iter().filter(|k| *k == u).count() < wanted {
                curve = curve.with_knot(*u);
            }
        }
        curve
    }

    /// The same curve with a degree higher by one; a cubic remains unchanged. Each new control point is the mean of
    /// blossom values at the new knots that it depends on, with one knot left out in turn (Ramshaw 1987).
    #[must_use]
    pub fn elevated(&self) -> Self {
        let p = self.degree();
        if p == MAX_DEGREE {
            return self.clone();
        }
        let mut knots = Vec::new();
        for k in self.knots() {
            if knots.last() != Some(k) {
                knots.push(*k);
            }
            knots.push(*k);
        }
        let q = p + 1;
        let control = (0..knots.len() - q - 1).map(|j| {
            let around = &knots[j + 1..=j + q];
            let mut sum = Vector4::zeros();
            for left_out in 0..q {
                let mut args = [0.0; MAX_DEGREE];
                let rest = around.iter().enumerate().filter(|(i, _)| *i != left_out);
                for (arg, (_, k)) in args.iter_mut().zip(rest) {
                    *arg = *k;
                }
                sum += self.blossom(&args[..p], 0.5 * (around[0] + around[q - 1]));
            }
            sum / q as f64
        });
        let control = control.collect();
        Self::from_homogeneous(q, knots, control)
    }

    /// Polar form of the polynomial piece that contains `inside`, for as many arguments as the degree.
    pub(super) fn blossom(&self, args: &[f64], inside: f64) -> Vector4<f64> {
        let p = self.degree();
        let knots = self.knots();
        let i = basis::span(knots, p, inside);
        let mut control = [Vector4::zeros(); MAX_DEGREE + 1];
        control[..=p].copy_from_slice(&self.control()[i - p..=i]);
        basis::blossom(knots, p, i, control, |step| args[step], |a, b, t| a * (1.0 - t) + b * t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bezier;
    use nalgebra::{Point3, Vector3};

    /// Bezier curves of the spans, and control points on finer knots, are the curve that the basis gives; also where a knot repeats.
    #[test]
    fn spans_and_finer_knots_are_the_curve() {
        let knots = vec![0.0, 0.0, 0.0, 0.0, 0.2, 0.5, 0.5, 1.0, 1.0, 1.0, 1.0];
        let points: Vec<Vector3<f64>> =
            (0..7).map(|k| Vector3::new(f64::from(k), f64::from(k * k % 5), f64::from(k % 3))).collect();
        let places: Vec<Point3<f64>> = points.iter().map(|p| Point3::from(*p)).collect();
        let curve = NurbsCurve::try_new(3, knots.clone(), &places, None).unwrap();
        let finer = curve.with_knot(0.5).with_knot(0.35);
        assert_eq!((finer.control().len(), finer.with_knot(0.5).control().len()), (9, 9));
        for span in [3, 4, 6] {
            let control = super::bezier(&knots, &points[span - 3..=span], span);
            for k in 0..=10 {
                let t = f64::from(k) / 10.0;
                let u = knots[span] + (knots[span + 1] - knots[span]) * t;
                assert!((bezier::value(&control, t) - curve.point(u).coords).norm() < 1e-12, "{span} {t}");
                assert!((finer.point(u) - curve.point(u)).norm() < 1e-12, "{span} {t}");
            }
        }
    }
}
