//! Ruled surfaces between two curves on equal parameters (Wei 17).

use super::NurbsCurve;
use nalgebra::{Point3, Vector3};

/// S(u, v) = (1 - v) root(u) + v tip(u).
///
/// The paper writes the tip first; here v runs from root to tip, as the tool stands on the hub.
#[derive(Clone, Debug, PartialEq)]
pub struct RuledSurface {
    /// Curve at v = 0.
    pub root: NurbsCurve,
    /// Curve at v = 1.
    pub tip: NurbsCurve,
}

impl RuledSurface {
    /// Point; outside of u in [0, 1] the guides go on along their tangents, outside of v in [0, 1] the ruling does.
    pub fn point(&self, u: f64, v: f64) -> Point3<f64> {
        let root = self.root.derivatives_extended(u).point;
        let tip = self.tip.derivatives_extended(u).point;
        root + (tip - root) * v
    }

    /// Unit vector of the ruling at u, from root to tip (Wei 10).
    pub fn ruling(&self, u: f64) -> Vector3<f64> {
        (self.tip.derivatives_extended(u).point - self.root.derivatives_extended(u).point).normalize()
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
}
