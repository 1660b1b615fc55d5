//! Ruled surfaces between two curves on equal parameters (Wei 17).

use super::knots::merge_knots;
use super::{GeomError, NurbsCurve, NurbsSurface, SurfaceDerivatives};
use nalgebra::{Point3, Vector3};

/// Share by which weights may differ by rounding.
const SAME_WEIGHT: f64 = 1e-12;

/// S(u, v) = (1 - v) root(u) + v tip(u).
///
/// The paper writes the tip first; here v runs from root to tip, in the direction of the tool axis.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct RuledSurface {
    /// Curve at v = 0.
    pub root: NurbsCurve,
    /// Curve at v = 1.
    pub tip: NurbsCurve,
}

impl RuledSurface {
    /// Point; outside of u in [0, 1] the guides continue along their tangents, outside of v in [0, 1] the ruling
    /// continues.
    pub fn point(&self, u: f64, v: f64) -> Point3<f64> {
        let root = self.root.point_extended(u);
        root + (self.tip.point_extended(u) - root) * v
    }

    /// Unit vector of the ruling at u, from root to tip (Wei 10).
    pub fn ruling(&self, u: f64) -> Vector3<f64> {
        (self.tip.point_extended(u) - self.root.point_extended(u)).normalize()
    }

    /// Point, S_u and S_v.
    pub fn tangents(&self, u: f64, v: f64) -> (Point3<f64>, Vector3<f64>, Vector3<f64>) {
        let root = self.root.derivatives_extended(u);
        let tip = self.tip.derivatives_extended(u);
        let ruling = tip.point - root.point;
        (root.point + ruling * v, root.first * (1.0 - v) + tip.first * v, ruling)
    }

    /// Unit normal along S_u x S_v.
    pub fn normal(&self, u: f64, v: f64) -> Vector3<f64> {
        let (_, su, sv) = self.tangents(u, v);
        su.cross(&sv).normalize()
    }

    /// Point with first and second derivatives.
    pub fn derivatives(&self, u: f64, v: f64) -> SurfaceDerivatives {
        let root = self.root.derivatives_extended(u);
        let tip = self.tip.derivatives_extended(u);
        let ruling = tip.point - root.point;
        SurfaceDerivatives {
            point: root.point + ruling * v,
            su: root.first * (1.0 - v) + tip.first * v,
            sv: ruling,
            suu: root.second * (1.0 - v) + tip.second * v,
            suv: tip.first - root.first,
            svv: Vector3::zeros(),
        }
    }

    /// The surface turned about Z by an angle in radians (Wei 18).
    #[must_use]
    pub fn rotated(&self, angle: f64) -> Self {
        Self { root: self.root.rotated(angle), tip: self.tip.rotated(angle) }
    }

    /// The same surface as a NURBS surface, degree 1 in v, on the merged knots of its guides (Wei 17).
    ///
    /// # Errors
    /// [`GeomError::GuideWeights`] when the guides have different weight functions.
    pub fn to_surface(&self) -> Result<NurbsSurface, GeomError> {
        let degree = self.root.degree().max(self.tip.degree());
        let raised = |curve: &NurbsCurve| {
            let mut curve = curve.clone();
            while curve.degree() < degree {
                curve = curve.elevated();
            }
            curve
        };
        let (root, tip) = (raised(&self.root), raised(&self.tip));
        let knots = merge_knots(root.knots(), tip.knots());
        let (root, tip) = (root.refined(&knots), tip.refined(&knots));
        let pairs = || root.control().iter().zip(tip.control());
        if pairs().any(|(a, b)| (a.w - b.w).abs() > SAME_WEIGHT * a.w.max(b.w)) {
            return Err(GeomError::GuideWeights);
        }
        let control = pairs().flat_map(|(a, b)| [*a, *b]).collect();
        Ok(NurbsSurface::from_homogeneous([degree, 1], [knots, vec![0.0, 0.0, 1.0, 1.0]], control))
    }
}
