//! Rational B-spline surfaces (Wei 2).

use super::basis::{self, MAX_DEGREE};
use super::curve::{check_control, weighted};
use super::{GeomError, NurbsCurve};
use nalgebra::{Point3, Rotation3, Vector3, Vector4};

/// A NURBS surface of degrees 1 to 3 on [0, 1] x [0, 1] (clamped knots).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "StoredSurface"))]
pub struct NurbsSurface {
    degree: [usize; 2],
    knots: [Vec<f64>; 2],
    /// Homogeneous control points (w x, w y, w z, w), row after row of equal u.
    control: Vec<Vector4<f64>>,
}

/// Point and partial derivatives of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceDerivatives {
    /// S.
    pub point: Point3<f64>,
    /// S_u.
    pub su: Vector3<f64>,
    /// S_v.
    pub sv: Vector3<f64>,
    /// S_uu.
    pub suu: Vector3<f64>,
    /// S_uv.
    pub suv: Vector3<f64>,
    /// S_vv.
    pub svv: Vector3<f64>,
}

impl NurbsSurface {
    /// A surface from control points and weights, row after row of equal u, and the knots of both directions.
    ///
    /// # Errors
    /// Any input for which evaluation is undefined, see [`GeomError`].
    pub fn try_new(
        degree: [usize; 2],
        knots: [Vec<f64>; 2],
        points: &[Point3<f64>],
        weights: Option<&[f64]>,
    ) -> Result<Self, GeomError> {
        Self::checked(degree, knots, weighted(points, weights)?)
    }

    /// A surface from homogeneous control points that may be faulty.
    fn checked(degree: [usize; 2], knots: [Vec<f64>; 2], control: Vec<Vector4<f64>>) -> Result<Self, GeomError> {
        if let Some(p) = degree.iter().find(|p| !(1..=MAX_DEGREE).contains(*p)) {
            return Err(GeomError::Degree(*p));
        }
        let count = |k: usize| knots[k].len().checked_sub(degree[k] + 1);
        let (Some(rows), Some(columns)) = (count(0), count(1)) else { return Err(GeomError::Knots) };
        if !basis::valid_knots(&knots[0], degree[0], rows) || !basis::valid_knots(&knots[1], degree[1], columns) {
            return Err(GeomError::Knots);
        }
        if rows.checked_mul(columns) != Some(control.len()) {
            return Err(GeomError::TooFewPoints { given: control.len(), needed: rows.saturating_mul(columns) });
        }
        check_control(&control)?;
        Ok(Self::from_homogeneous(degree, knots, control))
    }

    /// A surface from valid parts.
    pub(super) fn from_homogeneous(degree: [usize; 2], knots: [Vec<f64>; 2], control: Vec<Vector4<f64>>) -> Self {
        Self { degree, knots, control }
    }

    /// Degrees in u and v.
    pub fn degree(&self) -> [usize; 2] {
        self.degree
    }

    /// Knots in u and v.
    pub fn knots(&self) -> &[Vec<f64>; 2] {
        &self.knots
    }

    /// Homogeneous control points (w x, w y, w z, w), row after row of equal u.
    pub fn control(&self) -> &[Vector4<f64>] {
        &self.control
    }

    /// Numbers of control points in u and v.
    pub fn counts(&self) -> [usize; 2] {
        [self.knots[0].len() - self.degree[0] - 1, self.knots[1].len() - self.degree[1] - 1]
    }

    /// Weighted sums of the control points with the derivatives of the basis: entry `[i][j]` is the homogeneous
    /// derivative of order i in u and j in v, for i + j <= order.
    fn sums(&self, u: f64, v: f64, order: usize) -> [[Vector4<f64>; 3]; 3] {
        let bu = basis::evaluate(&self.knots[0], self.degree[0], u, order);
        let bv = basis::evaluate(&self.knots[1], self.degree[1], v, order);
        let [_, columns] = self.counts();
        let mut sums = [[Vector4::zeros(); 3]; 3];
        for a in 0..=self.degree[0] {
            let start = (bu.first + a) * columns + bv.first;
            let mut row = [Vector4::zeros(); 3];
            for (b, c) in self.control[start..=start + self.degree[1]].iter().enumerate() {
                for (sum, n) in row.iter_mut().zip(&bv.values).take(order + 1) {
                    *sum += c * n[b];
                }
            }
            for (i, by_u) in sums.iter_mut().enumerate().take(order + 1) {
                for (sum, r) in by_u.iter_mut().zip(&row).take(order + 1 - i) {
                    *sum += r * bu.values[i][a];
                }
            }
        }
        sums
    }

    /// Point at parameters of the domain.
    pub fn point(&self, u: f64, v: f64) -> Point3<f64> {
        let s = self.sums(u, v, 0)[0][0];
        Point3::from(s.xyz() / s.w)
    }

    /// Point, first and second derivatives at parameters of the domain (The NURBS Book, 4.20).
    pub fn derivatives(&self, u: f64, v: f64) -> SurfaceDerivatives {
        let [[a, av, avv], [au, auv, _], [auu, _, _]] = self.sums(u, v, 2);
        let w = a.w;
        let s = a.xyz() / w;
        let su = (au.xyz() - s * au.w) / w;
        let sv = (av.xyz() - s * av.w) / w;
        SurfaceDerivatives {
            point: Point3::from(s),
            su,
            sv,
            suu: (auu.xyz() - su * (2.0 * au.w) - s * auu.w) / w,
            suv: (auv.xyz() - sv * au.w - su * av.w - s * auv.w) / w,
            svv: (avv.xyz() - sv * (2.0 * av.w) - s * avv.w) / w,
        }
    }

    /// The surface turned about Z by an angle in radians (Wei 18).
    #[must_use]
    pub fn rotated(&self, angle: f64) -> Self {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
        let control = self.control.iter().map(|c| (turn * c.xyz()).push(c.w)).collect();
        Self { degree: self.degree, knots: self.knots.clone(), control }
    }

    /// The curve at v = 0 or at v = 1.
    pub fn border(&self, v_end: bool) -> NurbsCurve {
        let [_, columns] = self.counts();
        let column = if v_end { columns - 1 } else { 0 };
        let control = self.control.iter().skip(column).step_by(columns).copied().collect();
        NurbsCurve::from_homogeneous(self.degree[0], self.knots[0].clone(), control)
    }

    /// The curve at u = 0 or at u = 1.
    pub fn side(&self, u_end: bool) -> NurbsCurve {
        let [rows, columns] = self.counts();
        let start = if u_end { (rows - 1) * columns } else { 0 };
        let control = self.control[start..start + columns].to_vec();
        NurbsCurve::from_homogeneous(self.degree[1], self.knots[1].clone(), control)
    }
}

/// A surface with homogeneous control points.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredSurface {
    degree: [usize; 2],
    knots: [Vec<f64>; 2],
    control: Vec<Vector4<f64>>,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredSurface> for NurbsSurface {
    type Error = GeomError;

    fn try_from(StoredSurface { degree, knots, control }: StoredSurface) -> Result<Self, GeomError> {
        Self::checked(degree, knots, control)
    }
}
