//! The oblique elliptic cone with its vertex at the contact point (Xu 3): a set of tool axes in exact form.
//!
//! The plane at height one over the vertex, along a reference direction, cuts the cone in an ellipse. The cone is
//! oblique when the ellipse is not centred on the reference direction. A direction d belongs to the cone when its
//! intersection with the plane lies in the ellipse. For directions with d . w > 0 this is a quadratic form in d.

use super::NurbsSurface;
use nalgebra::{Matrix2, Matrix3, Point3, Vector2, Vector3, Vector4};

/// Sine of an angle below which two directions are one.
const PARALLEL_SINE: f64 = 1e-9;

/// A cone of directions over an ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipticCone {
    /// Unit vectors (x, y, reference direction w), right-handed.
    pub frame: [Vector3<f64>; 3],
    /// Middle of the ellipse in the plane w = 1.
    pub centre: Vector2<f64>,
    /// Half axes of the ellipse in the plane w = 1, the larger first, as tangents of angles from the vertex.
    pub half_axes: [f64; 2],
    /// Angle from x to the first half axis, radians.
    pub roll: f64,
}

/// A right-handed frame about a unit vector; x is perpendicular to `across` where `across` is not parallel to the
/// vector.
pub fn frame_about(w: &Vector3<f64>, across: &Vector3<f64>) -> [Vector3<f64>; 3] {
    let mut least = Vector3::zeros();
    least[w.iamin()] = 1.0;
    let y = (across - w * across.dot(w)).try_normalize(PARALLEL_SINE).unwrap_or_else(|| w.cross(&least).normalize());
    [y.cross(w), y, *w]
}

impl EllipticCone {
    /// Intersection of a direction with the plane w = 1; `None` for directions that do not meet the plane.
    pub fn project(&self, d: &Vector3<f64>) -> Option<Vector2<f64>> {
        project(&self.frame, d)
    }

    /// Unit direction through a point of the plane w = 1.
    pub fn direction(&self, at: &Vector2<f64>) -> Vector3<f64> {
        let [x, y, w] = &self.frame;
        (w + x * at.x + y * at.y).normalize()
    }

    /// Unit direction of the axis, through the middle of the ellipse.
    pub fn axis(&self) -> Vector3<f64> {
        self.direction(&self.centre)
    }

    /// The map from the ellipse to the unit circle about the origin.
    pub fn to_circle(&self) -> Matrix2<f64> {
        let (sin, cos) = libm::sincos(self.roll);
        let [a, b] = self.half_axes;
        Matrix2::new(cos / a, sin / a, -sin / b, cos / b)
    }

    /// The point of the plane w = 1 for a point of the unit disc.
    pub fn from_disc(&self, at: &Vector2<f64>) -> Vector2<f64> {
        let (sin, cos) = libm::sincos(self.roll);
        let (p, q) = (at.x * self.half_axes[0], at.y * self.half_axes[1]);
        self.centre + Vector2::new(cos * p - sin * q, sin * p + cos * q)
    }

    /// Level of a direction: 0 on the axis, 1 on the cone; infinite for directions that do not meet the plane.
    pub fn level(&self, d: &Vector3<f64>) -> f64 {
        self.project(d).map_or(f64::INFINITY, |p| (self.to_circle() * (p - self.centre)).norm())
    }

    /// True for directions in the cone.
    pub fn holds(&self, d: &Vector3<f64>) -> bool {
        self.level(d) <= 1.0
    }

    /// Symmetric matrix Q of the cone: d . Q d is zero on it and negative inside.
    pub fn quadric(&self) -> Matrix3<f64> {
        let m = self.to_circle();
        let inner = m.transpose() * m;
        let k = inner * self.centre;
        let local = Matrix3::new(
            inner[(0, 0)],
            inner[(0, 1)],
            -k.x,
            inner[(1, 0)],
            inner[(1, 1)],
            -k.y,
            -k.x,
            -k.y,
            self.centre.dot(&k) - 1.0,
        );
        let turn = Matrix3::from_columns(&self.frame);
        turn * local * turn.transpose()
    }

    /// The cone from its vertex to the plane at a height, mm, as a rational surface. The generatrix (17) is a straight
    /// line as a curve of degree two. The directrix is the circle of nine control points with weights 1, sqrt(1/2), ...
    /// (15), each scaled to the ellipse and sheared to its centre (16). u runs from the vertex, v around.
    pub fn to_surface(&self, vertex: &Point3<f64>, height: f64) -> NurbsSurface {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let [x, y, w] = &self.frame;
        let corners: [(f64, f64, f64); 9] = [
            (1.0, 0.0, 1.0),
            (1.0, 1.0, half),
            (0.0, 1.0, 1.0),
            (-1.0, 1.0, half),
            (-1.0, 0.0, 1.0),
            (-1.0, -1.0, half),
            (0.0, -1.0, 1.0),
            (1.0, -1.0, half),
            (1.0, 0.0, 1.0),
        ];
        let mut control = Vec::with_capacity(27);
        for share in [0.0, 0.5, 1.0] {
            for (p, q, weight) in corners {
                let at = self.from_disc(&Vector2::new(p, q));
                let point = vertex + (w + x * at.x + y * at.y) * (height * share);
                control.push(Vector4::new(point.x, point.y, point.z, 1.0) * weight);
            }
        }
        let line = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let circle = vec![0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0, 1.0, 1.0];
        NurbsSurface::from_homogeneous([2, 2], [line, circle], control)
    }

    /// Area of the ellipse in the plane w = 1, pi a b: the quantity that fitting maximises.
    pub fn area(&self) -> f64 {
        std::f64::consts::PI * self.half_axes[0] * self.half_axes[1]
    }
}

/// Intersection of a direction with the plane at height one of a frame; `None` for directions that do not meet the
/// plane.
pub fn project(frame: &[Vector3<f64>; 3], d: &Vector3<f64>) -> Option<Vector2<f64>> {
    let [x, y, w] = frame;
    let height = d.dot(w);
    (height > PARALLEL_SINE * d.norm()).then(|| Vector2::new(d.dot(x), d.dot(y)) / height)
}
