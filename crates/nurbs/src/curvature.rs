//! Curvature of surfaces (Xu 1 to 7).

use super::SurfaceDerivatives;
use nalgebra::Vector3;

/// Fundamental forms and curvatures at a point of a surface.
///
/// Signs follow the normal S_u x S_v: a curvature is positive where the surface is curved towards the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceCurvature {
    /// Unit normal along S_u x S_v (Xu 3).
    pub normal: Vector3<f64>,
    /// E, F, G of the first fundamental form (Xu 7).
    pub first_form: [f64; 3],
    /// L, M, N of the second fundamental form (Xu 7).
    pub second_form: [f64; 3],
    /// Gaussian curvature, 1/mm^2 (Xu 5).
    pub gauss: f64,
    /// Mean curvature, 1/mm (Xu 5).
    pub mean: f64,
    /// Principal curvatures, the larger first, 1/mm (Xu 6).
    pub principal: [f64; 2],
    /// Unit tangents of the principal curvatures; at an umbilic any two perpendicular tangents.
    pub directions: [Vector3<f64>; 2],
}

impl SurfaceDerivatives {
    /// Unit normal along S_u x S_v (Xu 3); `None` where the tangents are parallel.
    pub fn normal(&self) -> Option<Vector3<f64>> {
        self.su.cross(&self.sv).try_normalize(0.0)
    }

    /// Curvatures; `None` where the tangents are parallel.
    pub fn curvature(&self) -> Option<SurfaceCurvature> {
        let normal = self.normal()?;
        let [e, f, g] = [self.su.norm_squared(), self.su.dot(&self.sv), self.sv.norm_squared()];
        let [l, m, n] = [self.suu.dot(&normal), self.suv.dot(&normal), self.svv.dot(&normal)];
        // In an orthonormal tangent frame the shape operator is a symmetric matrix. Its eigenvalues avoid the
        // cancellation of H^2 - K near an umbilic.
        let x = self.su / e.sqrt();
        let y = normal.cross(&x);
        let (sx, sy) = (self.sv.dot(&x), self.sv.dot(&y));
        let xx = l / e;
        let xy = (m / e.sqrt() - sx * xx) / sy;
        let yy = (n - sx * sx * xx - 2.0 * sx * sy * xy) / (sy * sy);
        let mean = 0.5 * (xx + yy);
        let half = 0.5 * (xx - yy);
        let radius = libm::hypot(half, xy);
        let angle = 0.5 * libm::atan2(xy, half);
        let (sin, cos) = libm::sincos(angle);
        Some(SurfaceCurvature {
            normal,
            first_form: [e, f, g],
            second_form: [l, m, n],
            gauss: xx * yy - xy * xy,
            mean,
            principal: [mean + radius, mean - radius],
            directions: [x * cos + y * sin, y * cos - x * sin],
        })
    }
}

impl SurfaceCurvature {
    /// Normal curvature along a tangent of any length, 1/mm (Euler).
    pub fn along(&self, tangent: &Vector3<f64>) -> f64 {
        let [a, b] = self.directions.map(|d| d.dot(tangent));
        let square = a * a + b * b;
        if square > 0.0 { (self.principal[0] * a * a + self.principal[1] * b * b) / square } else { 0.0 }
    }
}
