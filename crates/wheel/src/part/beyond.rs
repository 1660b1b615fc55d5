//! Walls of passages before and behind edges that lie far inside of the part.
//!
//! A wall goes straight on beyond its ends. Blades at a slant leave hub and shroud there: with blades at 60 deg to the meridian a
//! straight line never comes to the inlet of the hub. Where an edge is far from the end of the hub, the wall follows hub and shroud
//! instead, and turns into their meridian, so that lines of the channel reach the end of the part.

use super::surface::{FaceLine, FaceSurface, Surface};
use nalgebra::{Point3, Vector2, Vector3};
use nurbs::{NurbsCurve, Revolution, interpolate};

/// Share of the meridian of the hub between an edge and the end of the hub from which on the wall follows the hub.
const LEAST_SHARE: f64 = 0.1;

/// Steps along the continued wall.
const STEPS: usize = 64;

/// Steps between two of them.
const STEPS_BETWEEN: usize = 8;

/// Places at which a meridian is measured.
const MERIDIAN_PLACES: usize = 200;

/// Length on which the wall turns into the meridian, as a share of the pitch.
const TURNING_SHARE: f64 = 0.5;

/// A wall beyond one of its ends.
#[derive(Clone, Debug)]
pub(super) struct Beyond {
    /// u of the end: 0 or 1.
    end: f64,
    root: Continuation,
    tip: Continuation,
}

/// A curve beyond the end of a root or a tip.
#[derive(Clone, Debug)]
struct Continuation {
    curve: NurbsCurve,
    /// Parameter of the curve for a change of u by 1.
    speed: f64,
}

impl Beyond {
    /// A wall beyond its inlet (`end` 0) or outlet (1) along hub and shroud; `None` where it is near to their end and goes straight on.
    pub(super) fn new([hub, shroud]: [&Revolution; 2], pitch: f64, wall: &FaceSurface, end: usize) -> Option<Self> {
        let u = end as f64;
        let whole = Place { surface: hub, t: 1.0 - u }.length_to(u);
        if Place::on(hub, &wall.point(u, 0.0)).length_to(u) < LEAST_SHARE * whole {
            return None;
        }
        let of = |surface: &Revolution, v: f64| Continuation::new(surface, pitch, wall, u, v);
        Some(Self { end: u, root: of(hub, 0.0)?, tip: of(shroud, 1.0)? })
    }

    /// Root and vector to the tip at a u beyond the end.
    pub(super) fn line(&self, u: f64) -> FaceLine<'_> {
        let beyond = (u - self.end).abs();
        let root = self.root.point(beyond);
        FaceLine::Ruled(root, self.tip.point(beyond) - root)
    }

    /// Whether u is beyond the end.
    pub(super) fn holds(&self, u: f64) -> bool {
        if self.end < 0.5 { u < self.end } else { u > self.end }
    }
}

/// A place on the meridian of a surface.
struct Place<'a> {
    surface: &'a Revolution,
    t: f64,
}

impl<'a> Place<'a> {
    fn on(surface: &'a Revolution, p: &Point3<f64>) -> Self {
        Self { surface, t: surface.closest(Vector2::new(libm::hypot(p.x, p.y), p.z)).0 }
    }

    /// Length of the meridian to another parameter, mm.
    fn length_to(&self, t: f64) -> f64 {
        let step = (t - self.t) / MERIDIAN_PLACES as f64;
        let speed = |k: usize| self.surface.meridian(self.t + (k as f64 + 0.5) * step).first.norm();
        (0..MERIDIAN_PLACES).map(speed).sum::<f64>() * step.abs()
    }
}

impl Continuation {
    /// Beyond u = `end` at height v of a wall, along a surface: the slant against the meridian falls evenly to zero over a share of
    /// the pitch.
    fn new(surface: &Revolution, pitch: f64, wall: &FaceSurface, end: f64, v: f64) -> Option<Self> {
        let outward = if end < 0.5 { -1.0 } else { 1.0 };
        let (p, along, _) = wall.tangents(end, v);
        let along = along * outward;
        let r = libm::hypot(p.x, p.y);
        let mut place = Place::on(surface, &p);
        let around = Vector3::new(-p.y, p.x, 0.0) / r;
        let across = along.dot(&around);
        let slant = libm::atan2(across, libm::sqrt((along.norm_squared() - across * across).max(0.0)));
        let turning = TURNING_SHARE * pitch * r;
        // Past its end the meridian goes straight on.
        let length = place.length_to(end) + turning;
        let step = length / (STEPS * STEPS_BETWEEN) as f64;
        let mut azimuth = libm::atan2(p.y, p.x);
        let mut points = vec![p];
        for k in 1..=STEPS * STEPS_BETWEEN {
            let x = (k as f64 - 0.5) * step;
            let (sin, cos) = libm::sincos(slant * (1.0 - x / turning).max(0.0));
            let at = surface.meridian(place.t);
            azimuth += sin * step / at.point.x.max(step);
            place.t += outward * cos * step / at.first.norm();
            if k % STEPS_BETWEEN == 0 {
                points.push(surface.point(place.t, azimuth));
            }
        }
        // A root off the surface, by a gap of the part, comes to it gradually.
        let gap = p - surface.point(Place::on(surface, &p).t, libm::atan2(p.y, p.x));
        let count = points.len() as f64;
        let eased = points.iter().enumerate().skip(1).map(|(k, q)| q + gap * (1.0 - k as f64 / count));
        let points: Vec<Point3<f64>> = std::iter::once(p).chain(eased).collect();
        Some(Self { curve: interpolate(&points, 3).ok()?, speed: along.norm() / length })
    }

    fn point(&self, beyond: f64) -> Point3<f64> {
        self.curve.point_extended(beyond * self.speed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nurbs::RuledSurface;
    use std::f64::consts::TAU;

    /// A turned surface of one radius from z = 0 down to -40 mm.
    fn cylinder(radius: f64) -> Revolution {
        let points: Vec<Point3<f64>> = (0..5).map(|k| Point3::new(radius, 0.0, -10.0 * f64::from(k))).collect();
        Revolution::new(interpolate(&points, 3).unwrap(), Vector2::new(2.0 * radius, -20.0))
    }

    /// A blade at 60 deg to the meridian from z = -20 mm to -40 mm.
    fn blade(hub: f64, shroud: f64) -> FaceSurface {
        let line = |radius: f64| {
            let at = |k: i32| {
                let z = f64::from(k);
                let azimuth = 60f64.to_radians().tan() * z / hub;
                Point3::new(radius * azimuth.cos(), radius * azimuth.sin(), -20.0 - z)
            };
            interpolate(&(0..=20).map(at).collect::<Vec<_>>(), 3).unwrap()
        };
        FaceSurface::Ruled(RuledSurface { root: line(hub), tip: line(shroud) })
    }

    #[test]
    fn a_wall_follows_the_hub_to_its_inlet() {
        let [hub, shroud] = [cylinder(20.0), cylinder(30.0)];
        let wall = blade(20.0, 30.0);
        let beyond = Beyond::new([&hub, &shroud], TAU / 6.0, &wall, 0).expect("the edge is far from the inlet");
        assert!(beyond.holds(-1e-9) && !beyond.holds(0.0));
        let at = |u: f64, v: f64| if u < 0.0 { beyond.line(u).point(v) } else { wall.point(u, v) };
        let mut heights = Vec::new();
        for k in 0..=300 {
            let u = -f64::from(k) / 100.0;
            for (v, radius) in [(0.0, 20.0), (1.0, 30.0)] {
                let p = at(u, v);
                assert!((libm::hypot(p.x, p.y) - radius).abs() < 2e-3, "{u} {v}: {p}");
            }
            heights.push(at(u, 0.0).z);
        }
        // Up to the inlet and over it, without a turn back; a straight line leaves the hub by 9 mm there.
        assert!(heights.windows(2).all(|pair| pair[1] > pair[0]) && heights.last().is_some_and(|z| *z > 0.0));
        // The line does not turn where the blade ends.
        let [before, after] = [[-2e-3, 0.0], [0.0, 2e-3]].map(|[a, b]| (at(b, 0.0) - at(a, 0.0)).normalize());
        assert!(before.angle(&after) < 0.02, "{}", before.angle(&after));
        // Near to the end of the hub a wall goes straight on.
        assert!(Beyond::new([&hub, &shroud], TAU / 6.0, &wall, 1).is_none());
    }
}
