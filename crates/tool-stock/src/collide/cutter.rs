//! The cutting part of a tool as a convex body of revolution: its meridian, and the kind that texts call it by.
//!
//! A point is given by its distance `rho` from the axis and its height `s` over the tip. The signed distance to a
//! convex body is convex; the proof of the verifier between samples relies on this.

use super::meridian::{Arc, Meridian};
use std::f64::consts::FRAC_PI_2;

/// What texts call a cutter. Nothing is computed from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Flat end mill.
    Flat,
    /// Ball end mill.
    Ball,
    /// Bull nose end mill.
    Bull,
    /// Tapered ball end mill.
    TaperedBall,
    /// Barrel: a ball tip, a tangent arc that bulges to the largest radius, and a cylinder above.
    Barrel,
    /// Lollipop: a ball on a thinner neck.
    Lollipop,
    /// Any other turned shape.
    Turned,
}

/// Cutting part, up to the end of the flutes. Its distances and sizes are those of its meridian.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "StoredCutter", into = "StoredCutter")
)]
pub struct Cutter {
    kind: Kind,
    meridian: Meridian,
}

impl std::ops::Deref for Cutter {
    type Target = Meridian;

    #[inline]
    fn deref(&self) -> &Meridian {
        &self.meridian
    }
}

impl Cutter {
    /// Flat end mill of a radius, mm.
    pub fn flat(radius: f64) -> Self {
        Self { kind: Kind::Flat, meridian: Meridian::of(&[Arc::new([radius, 0.0], 0.0, 0.0)]) }
    }

    /// Ball end mill of a radius, mm.
    pub fn ball(radius: f64) -> Self {
        Self { kind: Kind::Ball, meridian: Meridian::of(&[Arc::new([0.0, radius], radius, 0.0)]) }
    }

    /// Bull nose end mill of a radius and a smaller corner radius, mm.
    pub fn bull(radius: f64, corner: f64) -> Self {
        let mut meridian = Meridian::of(&[Arc::new([radius - corner, corner], corner, 0.0)]);
        meridian.radius = radius;
        Self { kind: Kind::Bull, meridian }
    }

    /// Tapered ball end mill of the radius of its ball, mm, and the angle between axis and side, radians in (0, pi/4).
    pub fn tapered_ball(ball: f64, half_angle: f64) -> Self {
        Self { kind: Kind::TaperedBall, meridian: Meridian::of(&[Arc::new([0.0, ball], ball, half_angle)]) }
    }

    /// Barrel of its largest radius, a larger radius of its arc, and a smaller radius of its ball tip, mm. The arc touches the ball from
    /// outside.
    pub fn barrel(radius: f64, barrel: f64, tip: f64) -> Self {
        let (between, inward) = (barrel - tip, barrel - radius);
        let height = tip + ((between - inward) * (between + inward)).max(0.0).sqrt();
        // Both are tangent on the line through their centres.
        let sine = (height - tip) / between;
        let ball = Arc { normal: [inward / between, sine], ..Arc::new([0.0, tip], tip, libm::asin(sine)) };
        let mut meridian = Meridian::of(&[ball, Arc::new([radius - barrel, height], barrel, 0.0)]);
        (meridian.radius, meridian.side) = (radius, radius);
        Self { kind: Kind::Barrel, meridian }
    }

    /// Lollipop of the radius of its ball, mm. The ball ends where the neck begins, see [`Meridian::neck_height`].
    pub fn lollipop(radius: f64) -> Self {
        Self { kind: Kind::Lollipop, meridian: Meridian::of(&[Arc::new([0.0, radius], radius, -FRAC_PI_2)]) }
    }

    /// Cutter of any convex meridian.
    pub fn turned(meridian: Meridian) -> Self {
        Self { kind: Kind::Turned, meridian }
    }

    /// What texts call it.
    #[inline]
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Name of its kind.
    #[inline]
    pub fn keyword(&self) -> &'static str {
        match self.kind {
            Kind::Flat => "flat",
            Kind::Ball => "ball",
            Kind::Bull => "bull",
            Kind::TaperedBall => "tapered-ball",
            Kind::Barrel => "barrel",
            Kind::Lollipop => "lollipop",
            Kind::Turned => "turned",
        }
    }

    /// The cutter in another size: all lengths times `by`, the same angles.
    #[must_use]
    pub fn scaled(&self, by: f64) -> Self {
        Self { meridian: self.meridian.scaled(by), ..*self }
    }

    /// The cutter with another radius of its end, mm, and with the same corner radius and taper. A barrel keeps its proportions.
    #[must_use]
    pub fn with_end_radius(&self, radius: f64) -> Self {
        Self { meridian: self.meridian.with_end_radius(radius), ..*self }
    }

    /// The cutter enlarged by a distance on all sides; heights count from its new tip. Corners stay sharp.
    #[must_use]
    pub fn enlarged(&self, by: f64) -> Self {
        Self { meridian: self.meridian.enlarged(by), ..*self }
    }
}

/// An arc by its centre, its radius and the normal at its upper end.
#[cfg(feature = "serde")]
#[derive(Clone, Copy, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredArc {
    ring: f64,
    height: f64,
    radius: f64,
    to: f64,
}

/// A cutter by its kind and sizes.
#[cfg(feature = "serde")]
#[derive(Clone, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
enum StoredCutter {
    Flat { radius: f64 },
    Ball { radius: f64 },
    Bull { radius: f64, corner: f64 },
    TaperedBall { ball: f64, half_angle: f64 },
    Barrel { radius: f64, barrel: f64, tip: f64 },
    Lollipop { radius: f64 },
    Turned { arcs: Vec<StoredArc> },
}

#[cfg(feature = "serde")]
impl From<Cutter> for StoredCutter {
    fn from(cutter: Cutter) -> Self {
        let (radius, tip) = (cutter.nominal_radius(), cutter.tip_radius());
        match cutter.kind {
            Kind::Flat => Self::Flat { radius },
            Kind::Ball => Self::Ball { radius },
            Kind::Bull => Self::Bull { radius, corner: tip },
            Kind::TaperedBall => Self::TaperedBall { ball: radius, half_angle: cutter.first().to },
            Kind::Barrel => Self::Barrel { radius, barrel: cutter.arcs()[1].radius, tip },
            Kind::Lollipop => Self::Lollipop { radius },
            Kind::Turned => {
                let stored = |a: &Arc| StoredArc { ring: a.ring, height: a.height, radius: a.radius, to: a.to };
                Self::Turned { arcs: cutter.arcs().iter().map(stored).collect() }
            }
        }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<StoredCutter> for Cutter {
    type Error = &'static str;

    fn try_from(stored: StoredCutter) -> Result<Self, Self::Error> {
        let length = |x: f64| x.is_finite() && x > 0.0;
        let cutter = match stored {
            StoredCutter::Flat { radius } => length(radius).then(|| Self::flat(radius)),
            StoredCutter::Ball { radius } => length(radius).then(|| Self::ball(radius)),
            StoredCutter::Lollipop { radius } => length(radius).then(|| Self::lollipop(radius)),
            StoredCutter::Bull { radius, corner } => {
                (length(radius) && length(corner) && corner <= radius).then(|| Self::bull(radius, corner))
            }
            StoredCutter::TaperedBall { ball, half_angle } => {
                let sound = length(ball) && half_angle > 0.0 && half_angle < std::f64::consts::FRAC_PI_4;
                sound.then(|| Self::tapered_ball(ball, half_angle))
            }
            StoredCutter::Barrel { radius, barrel, tip } => {
                let sound = length(tip) && length(barrel) && tip < radius && radius < barrel;
                sound.then(|| Self::barrel(radius, barrel, tip))
            }
            StoredCutter::Turned { arcs } => {
                let arcs: Vec<Arc> = arcs.iter().map(|a| Arc::new([a.ring, a.height], a.radius, a.to)).collect();
                Meridian::new(&arcs).map(Self::turned)
            }
        };
        cutter.ok_or("the sizes of a cutter give no cutter of its kind")
    }
}

#[cfg(test)]
mod tests {

    use crate::collide::ToolSolid;
    use crate::collide::meridian::norm;
    use crate::collide::samples::solids;

    /// Dense points of the outline of a solid in the half plane, from its radius only.
    fn outline(solid: &ToolSolid) -> Vec<(f64, f64)> {
        let n = 60_000;
        let top = solid.flute_length;
        // Heights are denser at the tip, where the radius grows fastest.
        let side = (0..=n).map(|i| top * (f64::from(i) / f64::from(n)).powi(2)).map(|s| (solid.cutter.radius_at(s), s));
        let lid = (0..=n).map(|i| (solid.radius() * f64::from(i) / f64::from(n), top));
        let floor = (0..=n).map(|i| (solid.cutter.radius_at(0.0) * f64::from(i) / f64::from(n), 0.0));
        side.chain(lid).chain(floor).collect()
    }

    #[test]
    fn distances_equal_the_nearest_point_of_the_outline() {
        for solid in solids() {
            let outline = outline(&solid);
            for k in 0..400 {
                let (rho, s) = (f64::from(k % 20) * 0.45 + 0.01, f64::from(k / 20) * 0.95 - 2.0);
                let brute = outline.iter().map(|(r, h)| norm(rho - r, s - h)).fold(f64::INFINITY, f64::min);
                let inside = s > 0.0 && s < solid.flute_length && rho < solid.cutter.radius_at(s);
                let expected = if inside { -brute } else { brute };
                let found = solid.cutter_distance(rho, s);
                assert!((found - expected).abs() < 2e-3, "{:?} {rho} {s}: {found} {expected}", solid.cutter);
            }
        }
    }

    #[test]
    fn distances_grow_with_the_size() {
        for solid in solids() {
            for k in 0..100 {
                let (rho, s) = (f64::from(k % 10) * 0.7, f64::from(k / 10) * 1.3 - 2.0);
                let (small, large) =
                    (solid.cutter.distance(rho, s), solid.cutter.scaled(1.7).distance(1.7 * rho, 1.7 * s));
                assert!((large - 1.7 * small).abs() < 1e-9, "{:?}", solid.cutter);
            }
        }
    }

    #[test]
    fn an_enlarged_cutter_is_nearer_by_the_enlargement() {
        const BY: f64 = 0.3;
        for solid in solids() {
            let (cutter, enlarged) = (solid.cutter, solid.cutter.enlarged(BY));
            let outside = (0..100).map(|k| (f64::from(k % 10) * 0.7, f64::from(k / 10) * 1.3 - 2.0));
            for (rho, s) in outside.filter(|(rho, s)| cutter.distance(*rho, *s) > BY) {
                let nearer = cutter.distance(rho, s) - enlarged.distance(rho, s + BY);
                // Beyond the corner of a flat cutter, which stays sharp, a point is nearer than to a rounded one.
                let corner = cutter.tip_radius() == 0.0 && nearer > BY && nearer < 2.0_f64.sqrt() * BY;
                assert!((nearer - BY).abs() < 1e-9 || corner, "{cutter:?} at {rho}, {s}: {nearer}");
            }
        }
    }

    #[test]
    fn profile_points_lie_on_the_surface_with_their_normals_and_curvature() {
        for solid in solids() {
            for k in 1..9 {
                let angle = f64::from(k) * 0.17;
                let Some(p) = solid.cutter.profile_at(angle) else {
                    assert!(solid.cutter.tip_radius() == 0.0);
                    continue;
                };
                let at = solid.cutter.slope(p.rho, p.s);
                assert!(at.value.abs() < 1e-9, "{:?} {angle}: {}", solid.cutter, at.value);
                assert!((at.rho - angle.cos()).hypot(at.s + angle.sin()) < 1e-6, "{:?} {angle}", solid.cutter);
                // The arc between two normals is their angle times the radius.
                let q = solid.cutter.profile_at(angle + 1e-5).unwrap();
                assert!(
                    ((q.rho - p.rho).hypot(q.s - p.s) / 1e-5 - p.arc_radius).abs() < 1e-3,
                    "{:?} {angle}",
                    solid.cutter
                );
            }
        }
    }

    #[test]
    fn slopes_equal_differences_and_carry_the_body() {
        for solid in solids() {
            let mut checked = 0;
            for k in 0..400 {
                let (rho, s) = (f64::from(k % 20) * 0.45 + 0.013, f64::from(k / 20) * 0.95 - 2.017);
                let at = solid.cutter_slope(rho, s);
                assert!((at.value - solid.cutter_distance(rho, s)).abs() < 1e-12);
                let h = 1e-6;
                let difference = |a: f64, b: f64| (a - b) / (2.0 * h);
                let dr = difference(solid.cutter_distance(rho + h, s), solid.cutter_distance(rho - h, s));
                let ds = difference(solid.cutter_distance(rho, s + h), solid.cutter_distance(rho, s - h));
                if (dr - at.rho).abs() < 1e-4 && (ds - at.s).abs() < 1e-4 {
                    checked += 1;
                }
                // Convex: the tangent lies below the function everywhere.
                for j in 0..400 {
                    let (r2, s2) = (f64::from(j % 20) * 0.47, f64::from(j / 20) * 0.9 - 1.9);
                    let tangent = at.value + at.rho * (r2 - rho) + at.s * (s2 - s);
                    assert!(solid.cutter_distance(r2, s2) >= tangent - 1e-12, "{:?}", solid.cutter);
                }
            }
            // Kinks inside of the body have no gradient.
            assert!(checked > 380, "{:?} {checked}", solid.cutter);
        }
    }
}
