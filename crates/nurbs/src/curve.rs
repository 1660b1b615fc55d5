//! NURBS curves (Wei 1).

use super::GeomError;
use super::basis::{self, Basis, MAX_DEGREE};
use super::quadrature::integral;
use nalgebra::{Point3, Rotation3, Vector3, Vector4};

/// A NURBS curve of degree 1 to 3 on [0, 1] (clamped knots).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "StoredCurve"))]
pub struct NurbsCurve {
    degree: usize,
    knots: Vec<f64>,
    /// Homogeneous control points (w x, w y, w z, w).
    control: Vec<Vector4<f64>>,
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    rational: bool,
}

/// Point and derivatives by the parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveDerivatives {
    /// C(u).
    pub point: Point3<f64>,
    /// C'(u).
    pub first: Vector3<f64>,
    /// C''(u).
    pub second: Vector3<f64>,
}

/// Refuses homogeneous control points that are not finite or have no positive weight.
pub(super) fn check_control(control: &[Vector4<f64>]) -> Result<(), GeomError> {
    if let Some(i) = control.iter().position(|c| !c.iter().all(|x| x.is_finite())) {
        return Err(GeomError::NotFinite(i));
    }
    control.iter().position(|c| c.w <= 0.0).map_or(Ok(()), |i| Err(GeomError::Weight(i)))
}

/// Homogeneous control points. Refuses another number of weights, and weights that are not positive.
pub(super) fn weighted(points: &[Point3<f64>], weights: Option<&[f64]>) -> Result<Vec<Vector4<f64>>, GeomError> {
    if let Some(weights) = weights {
        if weights.len() != points.len() {
            return Err(GeomError::TooFewPoints { given: weights.len(), needed: points.len() });
        }
        if let Some(i) = weights.iter().position(|w| !(w.is_finite() && *w > 0.0)) {
            return Err(GeomError::Weight(i));
        }
    }
    let weight = |i: usize| weights.map_or(1.0, |w| w[i]);
    Ok(points.iter().enumerate().map(|(i, p)| (p.coords * weight(i)).push(weight(i))).collect())
}

impl NurbsCurve {
    /// A curve from control points, weights and knots.
    ///
    /// # Errors
    /// Any input for which evaluation is undefined, see [`GeomError`].
    pub fn try_new(
        degree: usize,
        knots: Vec<f64>,
        points: &[Point3<f64>],
        weights: Option<&[f64]>,
    ) -> Result<Self, GeomError> {
        Self::checked(degree, knots, weighted(points, weights)?)
    }

    /// A curve from homogeneous control points that may be faulty.
    fn checked(degree: usize, knots: Vec<f64>, control: Vec<Vector4<f64>>) -> Result<Self, GeomError> {
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err(GeomError::Degree(degree));
        }
        if control.len() < degree + 1 {
            return Err(GeomError::TooFewPoints { given: control.len(), needed: degree + 1 });
        }
        check_control(&control)?;
        if !basis::valid_knots(&knots, degree, control.len()) {
            return Err(GeomError::Knots);
        }
        Ok(Self::from_homogeneous(degree, knots, control))
    }

    /// A curve from valid parts: valid knots, finite control points, positive weights.
    pub(super) fn from_homogeneous(degree: usize, knots: Vec<f64>, control: Vec<Vector4<f64>>) -> Self {
        let rational = control.iter().any(|c| c.w != 1.0);
        Self { degree, knots, control, rational }
    }

    /// True when a weight differs from one.
    pub fn is_rational(&self) -> bool {
        self.rational
    }

    /// The curve turned about Z by an angle in radians (Wei 18).
    #[must_use]
    pub fn rotated(&self, angle: f64) -> Self {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
        let control = self.control.iter().map(|c| (turn * c.xyz()).push(c.w)).collect();
        Self { degree: self.degree, knots: self.knots.clone(), control, rational: self.rational }
    }

    /// The curve from its last to its first point.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let [lo, hi] = self.domain();
        let knots = self.knots.iter().rev().map(|k| lo + hi - k).collect();
        let control = self.control.iter().rev().copied().collect();
        Self { degree: self.degree, knots, control, rational: self.rational }
    }

    /// Length in mm between two parameters, by Gauss-Legendre quadrature with eight nodes per knot span.
    pub fn length(&self, from: f64, to: f64) -> f64 {
        let (lo, hi, sign) = if from <= to { (from, to, 1.0) } else { (to, from, -1.0) };
        let mut stops = vec![lo];
        stops.extend(self.knots.iter().copied().filter(|k| lo < *k && *k < hi));
        stops.push(hi);
        stops.dedup();
        let speed = |u: f64| self.derivatives(u).first.norm();
        sign * stops.windows(2).map(|s| integral(s[0], s[1], &speed)).sum::<f64>()
    }

    /// Degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Knots, clamped.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Homogeneous control points (w x, w y, w z, w).
    pub fn control(&self) -> &[Vector4<f64>] {
        &self.control
    }

    /// Ends of the parameter.
    pub fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.control.len()]]
    }

    /// Point at a parameter of the domain.
    pub fn point(&self, u: f64) -> Point3<f64> {
        let basis = basis::evaluate(&self.knots, self.degree, u, 0);
        let mut sum = Vector4::zeros();
        for (c, n) in self.control[basis.first..].iter().zip(&basis.values[0][..=self.degree]) {
            sum += c * *n;
        }
        Point3::from(if self.rational { sum.xyz() / sum.w } else { sum.xyz() })
    }

    /// Point, first and second derivative at a parameter of the domain.
    pub fn derivatives(&self, u: f64) -> CurveDerivatives {
        self.weighted(&basis::evaluate(&self.knots, self.degree, u, 2))
    }

    /// [`Self::derivatives`] of a curve of the degree of the kernel at places in a row: `span` is that of the place before, and becomes
    /// that of this one.
    pub(super) fn next_derivatives(&self, u: f64, span: &mut usize) -> CurveDerivatives {
        *span = basis::span_from(&self.knots, self.degree, u, *span);
        self.weighted(&basis::cubic_in_span(&self.knots, *span, u))
    }

    /// Point and derivatives by the basis functions.
    fn weighted(&self, basis: &Basis) -> CurveDerivatives {
        let mut sums = [Vector4::zeros(); 3];
        for (c, j) in self.control[basis.first..=basis.first + self.degree].iter().zip(0..=MAX_DEGREE) {
            for (sum, n) in sums.iter_mut().zip(&basis.values) {
                *sum += c * n[j];
            }
        }
        let [a, b, c] = sums;
        if !self.rational {
            return CurveDerivatives { point: Point3::from(a.xyz()), first: b.xyz(), second: c.xyz() };
        }
        // Quotient rule on the homogeneous curve (The NURBS Book, 4.8).
        let point = a.xyz() / a.w;
        let first = (b.xyz() - point * b.w) / a.w;
        let second = (c.xyz() - first * (2.0 * b.w) - point * c.w) / a.w;
        CurveDerivatives { point: Point3::from(point), first, second }
    }

    /// As [`Self::point`], continued along the end tangents outside of the domain.
    pub fn point_extended(&self, u: f64) -> Point3<f64> {
        let [lo, hi] = self.domain();
        if (lo..=hi).contains(&u) { self.point(u) } else { self.derivatives_extended(u).point }
    }

    /// As [`Self::derivatives`], continued along the end tangents outside of the domain.
    pub fn derivatives_extended(&self, u: f64) -> CurveDerivatives {
        let [lo, hi] = self.domain();
        let inside = u.clamp(lo, hi);
        let mut d = self.derivatives(inside);
        if u != inside {
            d.point += d.first * (u - inside);
            d.second = Vector3::zeros();
        }
        d
    }

    /// Curvature 1/mm at a parameter (Wei 5 for a curve).
    pub fn curvature(&self, u: f64) -> f64 {
        let d = self.derivatives(u);
        let speed = d.first.norm();
        if speed > 0.0 { d.first.cross(&d.second).norm() / speed.powi(3) } else { 0.0 }
    }
}

/// A curve with homogeneous control points.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredCurve {
    degree: usize,
    knots: Vec<f64>,
    control: Vec<Vector4<f64>>,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredCurve> for NurbsCurve {
    type Error = GeomError;

    fn try_from(StoredCurve { degree, knots, control }: StoredCurve) -> Result<Self, GeomError> {
        Self::checked(degree, knots, control)
    }
}
