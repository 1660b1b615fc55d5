//! Surfaces of revolution about Z, as the meridian of a generating curve.

use super::NurbsCurve;
use nalgebra::{Point3, Vector2, Vector3};

/// A curve turned about Z. The parameter u runs along the curve; in the meridian plane (r, z) the surface is a curve
/// whose unit normal `orientation * (z', -r')` points out of the material.
#[derive(Clone, Debug, PartialEq)]
pub struct Revolution {
    generator: NurbsCurve,
    orientation: f64,
    /// Meridian points at equal steps of u, seeds of the closest point search.
    seeds: Vec<Vector2<f64>>,
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

/// Seeds of the closest point search: the meridian of a blade turns by about a right angle, so that each of 64 pieces
/// turns by one or two degrees and Newton starts inside its basin.
const SEEDS: usize = 64;

impl Revolution {
    /// The surface of a generating curve. `outside` is a point (r, z) on the side that the normal points to.
    pub fn new(generator: NurbsCurve, outside: Vector2<f64>) -> Self {
        let mut surface = Self { generator, orientation: 1.0, seeds: Vec::new() };
        surface.seeds = (0..=SEEDS).map(|i| surface.meridian(i as f64 / SEEDS as f64).point).collect();
        let (u, _) = surface.closest(outside);
        let here = surface.meridian(u);
        if (outside - here.point).dot(&surface.normal_2d(&here)) < 0.0 {
            surface.orientation = -1.0;
        }
        surface
    }

    /// The curve that is turned.
    pub fn generator(&self) -> &NurbsCurve {
        &self.generator
    }

    /// Meridian at u; outside of [0, 1] it goes on along its tangent.
    pub fn meridian(&self, u: f64) -> Meridian {
        let [lo, hi] = self.generator.domain();
        let inside = u.clamp(lo, hi);
        let d = self.generator.derivatives(inside);
        let r = d.point.x.hypot(d.point.y);
        let dr = (d.point.x * d.first.x + d.point.y * d.first.y) / r;
        let along = d.first.x * d.first.x + d.first.y * d.first.y + d.point.x * d.second.x + d.point.y * d.second.y;
        let ddr = (along - dr * dr) / r;
        let mut m = Meridian {
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

    /// Curvature 1/mm of the surface across the meridian at u, positive where it bulges out of the material.
    pub fn ring_curvature(&self, u: f64) -> f64 {
        let m = self.meridian(u);
        self.normal_2d(&m).x / m.point.x
    }

    /// Point at u and azimuth.
    pub fn point(&self, u: f64, azimuth: f64) -> Point3<f64> {
        let m = self.meridian(u).point;
        Point3::new(m.x * azimuth.cos(), m.x * azimuth.sin(), m.y)
    }

    /// Unit normal out of the material at u and azimuth.
    pub fn normal(&self, u: f64, azimuth: f64) -> Vector3<f64> {
        let n = self.meridian_normal(u);
        Vector3::new(n.x * azimuth.cos(), n.x * azimuth.sin(), n.y)
    }

    /// Parameter of the meridian point that is closest to (r, z), ends continued along their tangents, and the signed
    /// distance, positive out of the material.
    pub fn closest(&self, at: Vector2<f64>) -> (f64, f64) {
        let mut best = (0, f64::INFINITY);
        for (i, seed) in self.seeds.iter().enumerate() {
            let d = (at - seed).norm_squared();
            if d < best.1 {
                best = (i, d);
            }
        }
        let step = 1.0 / SEEDS as f64;
        let mut u = best.0 as f64 * step;
        // Newton on (m - at) . m' = 0, steps bounded by the seed spacing inside; it converges in 3 to 5.
        for _ in 0..20 {
            let m = self.meridian(u);
            let gap = m.point - at;
            let slope = m.first.norm_squared() + gap.dot(&m.second);
            let newton = gap.dot(&m.first) / if slope > 0.0 { slope } else { m.first.norm_squared() };
            let outside = !(0.0..=1.0).contains(&u) || !(0.0..=1.0).contains(&(u - newton));
            let change = if outside { newton } else { newton.clamp(-step, step) };
            u -= change;
            if change.abs() < 1e-14 {
                break;
            }
        }
        let m = self.meridian(u);
        let gap = at - m.point;
        let side = gap.dot(&self.normal_2d(&m));
        (u, gap.norm() * if side < 0.0 { -1.0 } else { 1.0 })
    }

    /// Signed distance of a point to the surface, positive out of the material.
    pub fn distance(&self, p: &Point3<f64>) -> f64 {
        self.closest(Vector2::new(p.x.hypot(p.y), p.z)).1
    }
}
