//! Radius of the fillet along the foot of a blade.

use super::surface::{FaceSurface, Surface};
use base::units::{Mm, trim};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Radius of a fillet: one value, or values along the foot of each face, from its leading to its trailing edge. Round the edges the
/// fillet has the radius of the end of the faces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "StoredFillet", into = "StoredFillet")]
pub struct Fillet {
    /// Shares of the length of the foot, from 0 to 1, and radii, mm. One value holds everywhere.
    values: Vec<[f64; 2]>,
    /// For each face the radius over u, where the radius changes; before the faces are known over the share of the foot.
    radii: Option<[RadiusSpline; 2]>,
}

/// What defines a fillet: values along the foot, and over u where the faces are known. Slopes follow from them.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredFillet {
    values: Vec<[f64; 2]>,
    #[serde(deserialize_with = "Deserialize::deserialize")]
    radii: Option<[Vec<[f64; 2]>; 2]>,
}

impl From<Fillet> for StoredFillet {
    fn from(Fillet { values, radii }: Fillet) -> Self {
        Self { values, radii: radii.map(|radii| radii.map(|spline| spline.values)) }
    }
}

impl TryFrom<StoredFillet> for Fillet {
    type Error = &'static str;

    fn try_from(StoredFillet { values, radii }: StoredFillet) -> Result<Self, Self::Error> {
        let sound = |values: &[[f64; 2]]| {
            let radius = |value: &[f64; 2]| value[1].is_finite() && value[1] > 0.0;
            let inside = |value: &[f64; 2]| (0.0..=1.0).contains(&value[0]);
            values.iter().all(|value| radius(value) && inside(value)) && values.windows(2).all(|w| w[0][0] < w[1][0])
        };
        if values.is_empty() || !sound(&values) || radii.iter().flatten().any(|values| !sound(values)) {
            return Err("the radii of a fillet are not positive, or their places do not ascend from 0 to 1");
        }
        if radii.is_some() != (values.len() > 1) || radii.iter().flatten().any(|own| own.len() != values.len()) {
            return Err("a fillet has not as many radii over its faces as along its foot");
        }
        Ok(Self { values, radii: radii.map(|radii| radii.map(RadiusSpline::new)) })
    }
}

impl From<Mm> for Fillet {
    fn from(radius: Mm) -> Self {
        Self { values: vec![[0.0, radius.get()]], radii: None }
    }
}

impl Fillet {
    /// A fillet with values along the foot: shares that grow from 0 to 1, and radii, mm. One value holds everywhere.
    pub fn along(values: Vec<[f64; 2]>) -> Self {
        let radii = (values.len() > 1).then(|| [0, 1].map(|_| RadiusSpline::new(values.clone())));
        Self { values, radii }
    }

    /// Shares of the length of the foot and radii, mm; one value holds everywhere.
    pub fn values(&self) -> &[[f64; 2]] {
        &self.values
    }

    /// The same fillet at the foot of these faces.
    pub(super) fn at_foot(self, faces: [&FaceSurface; 2]) -> Self {
        let radii = self.radii.as_ref().map(|_| faces.map(|face| self.over_foot(face)));
        Self { radii, ..self }
    }

    fn over_foot(&self, face: &FaceSurface) -> RadiusSpline {
        /// Chords along the foot: for a blade they differ from its length by less than a thousandth.
        const FOOT_CHORDS: usize = 400;
        let at = |k: usize| face.point(k as f64 / FOOT_CHORDS as f64, 0.0);
        let lengths: Vec<f64> = std::iter::once(0.0)
            .chain((0..FOOT_CHORDS).scan(0.0, |sum, k| {
                *sum += (at(k + 1) - at(k)).norm();
                Some(*sum)
            }))
            .collect();
        let place = |share: f64| {
            let length = share * lengths[FOOT_CHORDS];
            let k = lengths.partition_point(|l| *l <= length).clamp(1, FOOT_CHORDS);
            let rest = (length - lengths[k - 1]) / (lengths[k] - lengths[k - 1]);
            (k as f64 - 1.0 + rest) / FOOT_CHORDS as f64
        };
        RadiusSpline::new(self.values.iter().map(|[share, radius]| [place(*share), *radius]).collect())
    }

    /// Radius at u of a face, mm; beyond an end of the face that of the place as far before the end.
    pub(super) fn at(&self, face: usize, u: f64) -> f64 {
        self.radii.as_ref().map_or(self.values[0][1], |radii| radii[face].at(u))
    }

    /// Radius round the leading (`end` 0) or trailing edge (1), mm.
    pub(super) fn at_edge(&self, end: usize) -> f64 {
        if end == 0 { self.values[0][1] } else { self.values[self.values.len() - 1][1] }
    }

    /// The radius where it is the same everywhere.
    pub fn constant(&self) -> Option<Mm> {
        (self.values.len() == 1).then(|| Mm(self.values[0][1]))
    }

    /// The least radius.
    pub fn least(&self) -> Mm {
        self.extreme(f64::min)
    }

    /// The largest radius.
    pub fn most(&self) -> Mm {
        self.extreme(f64::max)
    }

    fn extreme(&self, pick: fn(f64, f64) -> f64) -> Mm {
        let given = self.values.iter().map(|value| value[1]);
        let between = self.radii.iter().flatten().flat_map(RadiusSpline::turns);
        let found = given.chain(between).reduce(pick);
        Mm(found.unwrap_or(0.0))
    }
}

impl fmt::Display for Fillet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(radius) = self.constant() {
            return write!(f, "{radius}");
        }
        let value = |[share, radius]: &[f64; 2]| format!("({} %, {} mm)", trim(100.0 * share, 4), trim(*radius, 6));
        write!(f, "[{}]", self.values.iter().map(value).collect::<Vec<_>>().join(" "))
    }
}

/// Radius over u: the cubic spline through the values that is level at both ends. Its second derivative has no jumps between them.
#[derive(Clone, Debug, PartialEq)]
struct RadiusSpline {
    values: Vec<[f64; 2]>,
    /// Slope at each value.
    slopes: Vec<f64>,
}

impl RadiusSpline {
    /// The spline through at least two values.
    fn new(values: Vec<[f64; 2]>) -> Self {
        let n = values.len();
        let width = |k: usize| values[k + 1][0] - values[k][0];
        let rise = |k: usize| (values[k + 1][1] - values[k][1]) / width(k);
        // Equal second derivatives on both sides of each inner value: elimination of a band.
        let (mut shares, mut slopes) = (vec![0.0; n], vec![0.0; n]);
        for k in 1..n - 1 {
            let (before, after) = (1.0 / width(k - 1), 1.0 / width(k));
            let pivot = 2.0 * (before + after) - before * shares[k - 1];
            shares[k] = after / pivot;
            slopes[k] = (3.0 * (before * rise(k - 1) + after * rise(k)) - before * slopes[k - 1]) / pivot;
        }
        for k in (1..n - 1).rev() {
            slopes[k] -= shares[k] * slopes[k + 1];
        }
        Self { values, slopes }
    }

    fn at(&self, u: f64) -> f64 {
        // Mirrored at both ends, where it is level, the spline stays as smooth as it is.
        let u = if u < 0.0 {
            -u
        } else if u > 1.0 {
            2.0 - u
        } else {
            u
        }
        .clamp(0.0, 1.0);
        let k = self.values.partition_point(|value| value[0] <= u).clamp(1, self.values.len() - 1) - 1;
        let ([from, a], [to, b]) = (self.values[k], self.values[k + 1]);
        let (width, t) = (to - from, (u - from) / (to - from));
        let (square, cube) = (t * t, t * t * t);
        let ends = a + (b - a) * (3.0 * square - 2.0 * cube);
        ends + width * (self.slopes[k] * (t - 2.0 * square + cube) + self.slopes[k + 1] * (cube - square))
    }

    /// Radii at the places between the values where the radius neither grows nor shrinks.
    fn turns(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.values.len() - 1).flat_map(move |k| {
            let ([from, a], [to, b]) = (self.values[k], self.values[k + 1]);
            let (rise, slopes) = ((b - a) / (to - from), [self.slopes[k], self.slopes[k + 1]]);
            // The slope over the span, p t^2 + 2 q t + c.
            let (p, q, c) =
                (3.0 * (slopes[0] + slopes[1] - 2.0 * rise), 3.0 * rise - 2.0 * slopes[0] - slopes[1], slopes[0]);
            let root = (q * q - p * c).max(0.0).sqrt();
            let places = [(-q + root) / p, (-q - root) / p, -0.5 * c / q];
            places.into_iter().filter(|t| (0.0..=1.0).contains(t)).map(move |t| self.at(from + (to - from) * t))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_run_smoothly_through_the_values_and_level_at_both_ends() {
        let values = vec![[0.0, 2.0], [0.3, 3.5], [0.7, 3.0], [1.0, 4.0]];
        let spline = RadiusSpline::new(values.clone());
        for [u, radius] in &values {
            assert!((spline.at(*u) - radius).abs() < 1e-14);
        }
        const DIFFERENCE_STEP: f64 = 1e-4;
        let slope =
            |u: f64| (spline.at(u + DIFFERENCE_STEP) - spline.at(u - DIFFERENCE_STEP)) / (2.0 * DIFFERENCE_STEP);
        let second_derivative = |u: f64| {
            (spline.at(u + DIFFERENCE_STEP) - 2.0 * spline.at(u) + spline.at(u - DIFFERENCE_STEP))
                / (DIFFERENCE_STEP * DIFFERENCE_STEP)
        };
        assert!(slope(2.0 * DIFFERENCE_STEP).abs() < 0.05 && slope(1.0 - 2.0 * DIFFERENCE_STEP).abs() < 0.05);
        for u in [0.3, 0.7] {
            assert!((slope(u - DIFFERENCE_STEP) - slope(u + DIFFERENCE_STEP)).abs() < 0.05);
            assert!(
                (second_derivative(u - 2.0 * DIFFERENCE_STEP) - second_derivative(u + 2.0 * DIFFERENCE_STEP)).abs()
                    < 0.5,
                "{}",
                second_derivative(u)
            );
        }
        // What the search for extremes finds is what dense samples find.
        let turns: Vec<f64> = spline.turns().collect();
        let dense = || (0..=100_000).map(|k| spline.at(f64::from(k) * 1e-5));
        let both = |pick: fn(f64, f64) -> f64| {
            let all = values.iter().map(|v| v[1]).chain(turns.iter().copied());
            [all.reduce(pick).unwrap(), dense().reduce(pick).unwrap()]
        };
        for [found, sampled] in [both(f64::min), both(f64::max)] {
            assert!((found - sampled).abs() < 1e-8, "{found} {sampled}");
        }
    }
}
