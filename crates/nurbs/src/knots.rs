//! Knot insertion, merging of knot vectors and degree elevation; they do not change the curve.

use super::NurbsCurve;
use super::basis::{self, MAX_DEGREE};
use nalgebra::Vector4;

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
        let k = basis::span(knots, p, u);
        let old = self.control();
        let mut control = Vec::with_capacity(old.len() + 1);
        control.extend_from_slice(&old[..=k - p]);
        for i in k - p + 1..=k - times {
            // Convex combination in the homogeneous space.
            let t = (u - knots[i]) / (knots[i + p] - knots[i]);
            control.push(old[i] * t + old[i - 1] * (1.0 - t));
        }
        control.extend_from_slice(&old[k - times..]);
        let mut more = knots.to_vec();
        more.insert(k + 1, u);
        Self::from_homogeneous(p, more, control)
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
        let mut d = [Vector4::zeros(); MAX_DEGREE + 1];
        d[..=p].copy_from_slice(&self.control()[i - p..=i]);
        for (r, arg) in args.iter().enumerate() {
            for j in (r + 1..=p).rev() {
                let (left, right) = (knots[i - p + j], knots[i + j - r]);
                let t = (arg - left) / (right - left);
                d[j] = d[j - 1] * (1.0 - t) + d[j] * t;
            }
        }
        d[p]
    }
}
