//! Surfaces of revolution about Z, by the meridian of a generating curve.

use super::bracket::root;
use super::{NurbsCurve, NurbsSurface};
use nalgebra::{Point3, Vector2, Vector3, Vector4};

/// A curve rotated about Z. The parameter u runs along the curve. In the meridian plane (r, z) the surface is a curve
/// whose unit normal `orientation * (z', -r')` points out of the material.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "StoredRevolution"))]
pub struct Revolution {
    generator: NurbsCurve,
    orientation: f64,
    /// Meridian points at equal steps of u: seeds of the closest point search.
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    seeds: Vec<Vector2<f64>>,
    /// Meridian at both ends, for the same search.
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    ends: [Meridian; 2],
}

/// Point of the meridian with derivatives by u.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meridian {
    /// (r, z).
    pub point: Vector2<f64>,
    /// First derivative.
    pub first: Vector2<f64>,
    /// Second derivative.
    pub second: Vector2<f64>,
}

impl Meridian {
    /// Meridian of a curve at u; outside of [0, 1] it continues along its tangent.
    fn of(generator: &NurbsCurve, u: f64) -> Self {
        let [lo, hi] = generator.domain();
        let inside = u.clamp(lo, hi);
        let d = generator.derivatives(inside);
        let r = libm::hypot(d.point.x, d.point.y);
        let (dr, ddr) = if r > 0.0 {
            let dr = (d.point.x * d.first.x + d.point.y * d.first.y) / r;
            let along = d.first.x * d.first.x + d.first.y * d.first.y + d.point.x * d.second.x + d.point.y * d.second.y;
            (dr, (along - dr * dr) / r)
        } else {
            // On the axis the derivative of the radius is the speed across the axis.
            (libm::hypot(d.first.x, d.first.y), 0.0)
        };
        let mut m = Self {
            point: Vector2::new(r, d.point.z),
            first: Vector2::new(dr, d.first.z),
            second: Vector2::new(ddr, d.second.z),
        };
        if u != inside {
            m.point += m.first * (u - inside);
            m.second = Vector2::zeros();
        }
        m
    }
}

/// Seeds of the closest point search. A meridian turns by about a right angle. Each of 64 pieces turns by
/// 1 or 2 deg, and contains no second minimum.
const MERIDIAN_SEEDS: usize = 64;

impl Revolution {
    /// The surface of a generating curve. `outside` is a point (r, z) on the side to which the normal points.
    pub fn new(generator: NurbsCurve, outside: Vector2<f64>) -> Self {
        let mut surface = Self::oriented(generator, 1.0);
        let (u, _) = surface.closest(outside);
        let here = surface.meridian(u);
        if (outside - here.point).dot(&surface.normal_2d(&here)) < 0.0 {
            surface.orientation = -1.0;
        }
        surface
    }

    /// The surface of a generating curve with its side: +1 or -1.
    pub(crate) fn oriented(generator: NurbsCurve, orientation: f64) -> Self {
        let seeds =
            (0..=MERIDIAN_SEEDS).map(|i| Meridian::of(&generator, i as f64 / MERIDIAN_SEEDS as f64).point).collect();
        let ends = [0.0, 1.0].map(|u| Meridian::of(&generator, u));
        Self { generator, orientation, seeds, ends }
    }

    /// The generating curve.
    pub fn generator(&self) -> &NurbsCurve {
        &self.generator
    }

    /// Meridian at u; outside of [0, 1] it continues along its tangent.
    pub fn meridian(&self, u: f64) -> Meridian {
        Meridian::of(&self.generator, u)
    }

    fn normal_2d(&self, m: &Meridian) -> Vector2<f64> {
        Vector2::new(m.first.y, -m.first.x).normalize() * self.orientation
    }

    /// Unit normal (r, z) out of the material at u.
    pub fn meridian_normal(&self, u: f64) -> Vector2<f64> {
        self.normal_2d(&self.meridian(u))
    }

    /// Curvature 1/mm of the meridian at u, positive where the surface bulges out of the material.
    pub fn meridian_curvature(&self, u: f64) -> f64 {
        let m = self.meridian(u);
        let speed = m.first.norm();
        -m.second.dot(&self.normal_2d(&m)) / (speed * speed)
    }

    /// Curvature 1/mm of the surface across the meridian at u, positive where the surface bulges out of the material.
    pub fn ring_curvature(&self, u: f64) -> f64 {
        let m = self.meridian(u);
        self.normal_2d(&m).x / m.point.x
    }

    /// Point at u and azimuth.
    pub fn point(&self, u: f64, azimuth: f64) -> Point3<f64> {
        let m = self.meridian(u).point;
        Point3::new(m.x * libm::cos(azimuth), m.x * libm::sin(azimuth), m.y)
    }

    /// Unit normal out of the material at u and azimuth.
    pub fn normal(&self, u: f64, azimuth: f64) -> Vector3<f64> {
        let n = self.meridian_normal(u);
        Vector3::new(n.x * libm::cos(azimuth), n.x * libm::sin(azimuth), n.y)
    }

    /// Parameter of the meridian point closest to (r, z), with both ends continued along their tangents, and the signed
    /// distance, positive out of the material.
    pub fn closest(&self, at: Vector2<f64>) -> (f64, f64) {
        let square = |i: usize| (at - self.seeds[i]).norm_squared();
        let mut best = (0.0, f64::INFINITY, self.ends[0]);
        let mut take = |u: f64| {
            let m = self.meridian(u);
            let d = (at - m.point).norm_squared();
            if d < best.1 {
                best = (u, d, m);
            }
        };
        // Each seed that is nearer than its neighbours starts a search between these neighbours.
        let mut before = f64::INFINITY;
        let mut here = square(0);
        for i in 0..=MERIDIAN_SEEDS {
            let after = if i < MERIDIAN_SEEDS { square(i + 1) } else { f64::INFINITY };
            if here <= before && here <= after {
                take(self.stationary_near(at, i));
            }
            (before, here) = (here, after);
        }
        // The feet on both tangents beyond the ends.
        for (end, m) in [0.0, 1.0].into_iter().zip(&self.ends) {
            let foot = end + (at - m.point).dot(&m.first) / m.first.norm_squared();
            if (end == 0.0 && foot < 0.0) || (end == 1.0 && foot > 1.0) {
                take(foot);
            }
        }
        let (u, _, m) = best;
        let gap = at - m.point;
        let side = gap.dot(&self.normal_2d(&m));
        (u, gap.norm() * if side < 0.0 { -1.0 } else { 1.0 })
    }

    /// Parameter near a seed where the vector to a point is perpendicular to the meridian, or the end of the curve.
    /// Newton's method inside the bracket of the neighbouring seeds, with bisection where it leaves the bracket.
    fn stationary_near(&self, at: Vector2<f64>, seed: usize) -> f64 {
        let step = 1.0 / MERIDIAN_SEEDS as f64;
        let start = seed as f64 * step;
        let slope = |u: f64| {
            let m = self.meridian(u);
            let gap = m.point - at;
            [gap.dot(&m.first), m.first.norm_squared() + gap.dot(&m.second)]
        };
        root([(start - step).max(0.0), (start + step).min(1.0)], start, slope)
    }

    /// Signed distance of a point to the surface, positive out of the material.
    pub fn distance(&self, p: &Point3<f64>) -> f64 {
        self.closest(Vector2::new(libm::hypot(p.x, p.y), p.z)).1
    }

    /// The whole surface as a NURBS surface: u along the generator, v once around, counter-clockwise from the
    /// generator. The circle is the quadratic one with nine control points and weights 1, sqrt(1/2), ... (Xu 15). It is
    /// rotated about Z through each control point of the generator, which may be a space curve.
    pub fn to_surface(&self) -> NurbsSurface {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let mut control = Vec::with_capacity(self.generator.control().len() * 9);
        for c in self.generator.control() {
            let (mut x, mut y) = (c.x, c.y);
            for _ in 0..4 {
                control.push(Vector4::new(x, y, c.z, c.w));
                // The corner of the square around the circle, half way to the next quarter.
                control.push(Vector4::new(x - y, x + y, c.z, c.w) * half);
                (x, y) = (-y, x);
            }
            control.push(*c);
        }
        let circle = vec![0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0, 1.0, 1.0];
        NurbsSurface::from_homogeneous([self.generator.degree(), 2], [self.generator.knots().to_vec(), circle], control)
    }
}

/// A surface of revolution: its seeds follow from the curve.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredRevolution {
    generator: NurbsCurve,
    orientation: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredRevolution> for Revolution {
    type Error = crate::GeomError;

    fn try_from(StoredRevolution { generator, orientation }: StoredRevolution) -> Result<Self, crate::GeomError> {
        if orientation.abs() == 1.0 {
            Ok(Self::oriented(generator, orientation))
        } else {
            Err(crate::GeomError::Orientation)
        }
    }
}
