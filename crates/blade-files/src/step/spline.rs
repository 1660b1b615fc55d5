//! Splines of STEP files: B-splines of any degree on any knots, and weighted sums with their basis. Outside of its knots a spline goes
//! on with the polynomial of its last span.

use nalgebra::{Point3, Vector3, Vector4};
use nurbs::basis::{self, Basis};

/// Highest degree. Programs for design write up to some 15.
pub(super) const HIGHEST_DEGREE: usize = 25;

/// Degree and knots of a direction of a spline.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SplineKnots {
    degree: usize,
    knots: Vec<f64>,
}

/// Basis functions that are not zero at a parameter.
#[derive(Clone, Debug)]
pub(super) struct SplineWeights {
    /// Index of the first one.
    pub(super) first: usize,
    pub(super) values: Vec<f64>,
    /// Their derivatives by the parameter.
    pub(super) slopes: Vec<f64>,
}

impl SplineKnots {
    /// Knots, each with its multiplicity, for a number of control points. `None` where they do not ascend, or are not
    /// `count + degree + 1` in all, or leave the spline without a span.
    pub(super) fn new(degree: usize, multiplicities: &[usize], values: &[f64], count: usize) -> Option<Self> {
        let sum: usize = multiplicities.iter().try_fold(0_usize, |sum, m| sum.checked_add(*m))?;
        let fits = (1..=HIGHEST_DEGREE).contains(&degree)
            && multiplicities.len() == values.len()
            && count > degree
            && sum == count + degree + 1
            && multiplicities.iter().all(|m| (1..=degree + 1).contains(m))
            && values.iter().all(|x| x.is_finite())
            && values.windows(2).all(|pair| pair[0] < pair[1]);
        if !fits {
            return None;
        }
        let knots: Vec<f64> =
            values.iter().zip(multiplicities).flat_map(|(x, m)| std::iter::repeat_n(*x, *m)).collect();
        (knots[degree] < knots[count]).then_some(Self { degree, knots })
    }

    /// Ends of the parameter.
    pub(super) fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.knots.len() - self.degree - 1]]
    }

    /// Number of spans between different knots.
    pub(super) fn spans(&self) -> usize {
        self.knots.windows(2).filter(|pair| pair[0] < pair[1]).count()
    }

    /// Basis functions at a parameter.
    pub(super) fn at(&self, u: f64) -> SplineWeights {
        let (p, knots) = (self.degree, &self.knots);
        let [lo, hi] = self.domain();
        let span = basis::span(knots, p, u.clamp(lo, hi));
        let Basis { first, values: [values, slopes, _] } =
            basis::in_span::<{ HIGHEST_DEGREE + 1 }>(knots, p, span, u, 1);
        SplineWeights { first, values: values[..=p].to_vec(), slopes: slopes[..=p].to_vec() }
    }
}

/// Point of homogeneous coordinates, and derivatives of it.
pub(super) fn projected<const N: usize>(
    sum: Vector4<f64>,
    slopes: [Vector4<f64>; N],
) -> (Point3<f64>, [Vector3<f64>; N]) {
    let point = sum.xyz() / sum.w;
    (Point3::from(point), slopes.map(|slope| (slope.xyz() - point * slope.w) / sum.w))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Basis functions sum up to one and their derivatives to zero; derivatives agree with differences.
    #[test]
    fn basis_is_a_partition_of_one() {
        let cases: [(usize, &[usize], &[f64], usize); 5] = [
            (3, &[4, 1, 2, 4], &[0.0, 0.3, 0.7, 2.0], 7),
            (2, &[1, 1, 1, 1, 1, 1, 1], &[-1.0, 0.0, 1.0, 2.0, 3.5, 4.0, 5.0], 4),
            (5, &[6, 6], &[1.0, 2.0], 6),
            (1, &[2, 1, 2], &[0.0, 1.0, 4.0], 3),
            (2, &[1, 1, 1, 1, 2, 1, 1], &[-1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0], 5),
        ];
        for (degree, multiplicities, values, count) in cases {
            let knots = SplineKnots::new(degree, multiplicities, values, count).expect("knots");
            let [lo, hi] = knots.domain();
            for k in 0..=20 {
                let u = lo + (hi - lo) * (f64::from(k) + 0.3) / 21.0;
                let at = knots.at(u);
                assert!(
                    (at.values.iter().sum::<f64>() - 1.0).abs() < 1e-12 && at.slopes.iter().sum::<f64>().abs() < 1e-9
                );
                let step = 1e-6;
                let (next, before) = (knots.at(u + step), knots.at(u - step));
                if next.first == before.first {
                    for (j, slope) in at.slopes.iter().enumerate() {
                        let difference = (next.values[j] - before.values[j]) / (2.0 * step);
                        assert!(
                            (slope - difference).abs() < 1e-6 * (1.0 + slope.abs()),
                            "{degree} {u} {slope} {difference}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn faulty_knots_are_refused() {
        assert!(SplineKnots::new(3, &[4, 4], &[0.0, 1.0], 5).is_none());
        assert!(SplineKnots::new(3, &[4, 4], &[1.0, 1.0], 4).is_none());
        assert!(SplineKnots::new(0, &[1, 1], &[0.0, 1.0], 1).is_none());
        assert!(SplineKnots::new(26, &[27, 27], &[0.0, 1.0], 27).is_none());
        assert!(SplineKnots::new(2, &[usize::MAX, 3], &[0.0, 1.0], 3).is_none());
        assert!(SplineKnots::new(2, &[3, 3], &[0.0, f64::NAN], 3).is_none());
    }
}
