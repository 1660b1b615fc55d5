//! A cutter that touches a surface from outside: its tip, and its curvature at the contact.

use super::Cutter;
use nalgebra::{Point3, Vector3};

/// Sine of the angle between normal and axis below which the contact has no side.
const SIDELESS_SINE: f64 = 1e-9;

/// Principal directions and curvatures of a cutter at a contact, directions of unit length, curvatures 1/mm.
#[derive(Clone, Copy, Debug)]
pub struct CutterCurvature {
    /// Direction of the profile of the cutter.
    pub along: Vector3<f64>,
    /// Curvature of the profile.
    pub of_profile: f64,
    /// Direction round the axis.
    pub around: Vector3<f64>,
    /// Curvature round the axis.
    pub of_ring: f64,
}

impl Cutter {
    /// Tip of the cutter with a given unit axis where it touches a contact from outside. The unit normal points out of the
    /// material. `None` for a flat end.
    pub fn tip_at(&self, contact: &Point3<f64>, normal: &Vector3<f64>, axis: &Vector3<f64>) -> Option<Point3<f64>> {
        let sin = normal.dot(axis).clamp(-1.0, 1.0);
        if self.ends_in_ball() {
            return Some(contact + (normal - axis) * self.tip_radius());
        }
        let at = self.profile_at(libm::asin(sin))?;
        // From the axis to the contact.
        let outward = (axis * sin - normal).try_normalize(SIDELESS_SINE)?;
        Some(contact - outward * at.rho - axis * at.s)
    }

    /// Curvature of the cutter where a surface with a unit normal touches it. `None` for a flat end, and for a cutter that
    /// stands square on the surface.
    pub fn curvature_at(&self, normal: &Vector3<f64>, axis: &Vector3<f64>) -> Option<CutterCurvature> {
        let sin = axis.dot(normal).clamp(-1.0, 1.0);
        let profile = self.profile_at(libm::asin(sin))?;
        let along = (axis - normal * sin).try_normalize(SIDELESS_SINE)?;
        Some(CutterCurvature {
            along,
            of_profile: 1.0 / profile.arc_radius,
            around: normal.cross(&along),
            of_ring: (1.0 - sin * sin).sqrt() / profile.rho,
        })
    }
}
