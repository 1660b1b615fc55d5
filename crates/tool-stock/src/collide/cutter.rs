//! The cutting part of a tool as a convex body of revolution.
//!
//! A point is given by its distance `rho` from the axis and its height `s` over the tip. The signed distance to a
//! convex body is convex; the proof of the verifier between samples relies on this.

/// Cutting part, up to the end of the flutes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "kebab-case", try_from = "StoredCutter")
)]
pub enum Cutter {
    /// Flat end mill.
    Flat {
        /// Radius.
        radius: f64,
    },
    /// Ball end mill.
    Ball {
        /// Radius.
        radius: f64,
    },
    /// Bull nose end mill.
    Bull {
        /// Radius.
        radius: f64,
        /// Corner radius, below the radius.
        corner: f64,
    },
    /// Tapered ball end mill.
    TaperedBall {
        /// Radius of the ball.
        ball: f64,
        /// Angle between axis and side, radians, in (0, pi/4).
        half_angle: f64,
    },
    /// Barrel: a ball tip, a tangent arc that bulges to the largest radius, and a cylinder above.
    Barrel {
        /// Largest radius.
        radius: f64,
        /// Radius of the arc, above the largest radius.
        barrel: f64,
        /// Radius of the ball tip, below the largest radius.
        tip: f64,
    },
    /// Lollipop: a ball on a thinner neck. The ball ends where the neck begins, see [`Cutter::neck_height`].
    Lollipop {
        /// Radius of the ball.
        radius: f64,
    },
}

/// A signed distance with its gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// Signed distance.
    pub value: f64,
    /// Derivative by the distance from the axis.
    pub rho: f64,
    /// Derivative by the height.
    pub s: f64,
}

/// A point of the profile of a cutter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePoint {
    /// Distance from the axis.
    pub rho: f64,
    /// Height over the tip.
    pub s: f64,
    /// Radius of curvature of the profile.
    pub arc_radius: f64,
}

impl Cutter {
    /// The point of the rounded profile whose outward normal is inclined from the radial direction towards the tip by
    /// an angle, radians in (0, pi/2]; `None` for a flat end, which has no such point.
    #[inline]
    pub fn profile_at(&self, angle: f64) -> Option<ProfilePoint> {
        let (sin, cos) = libm::sincos(angle);
        let on_arc = |rho: f64, s: f64, arc_radius: f64| {
            Some(ProfilePoint { rho: rho + arc_radius * cos, s: s - arc_radius * sin, arc_radius })
        };
        match *self {
            Self::Flat { .. } => None,
            Self::Ball { radius } | Self::Lollipop { radius } => on_arc(0.0, radius, radius),
            Self::TaperedBall { ball, .. } => on_arc(0.0, ball, ball),
            Self::Bull { radius, corner } => on_arc(radius - corner, corner, corner),
            Self::Barrel { radius, barrel, tip } => {
                if self.barrel_angle().is_some_and(|end| angle < end) {
                    on_arc(radius - barrel, barrel_height(radius, barrel, tip), barrel)
                } else {
                    on_arc(0.0, tip, tip)
                }
            }
        }
    }

    /// Angle of the normal, radians, from the radial direction towards the tip, at which the arc of a barrel meets its ball tip;
    /// `None` for other cutters.
    #[inline]
    pub fn barrel_angle(&self) -> Option<f64> {
        match *self {
            Self::Barrel { radius, barrel, tip } => {
                Some(libm::asin((barrel_height(radius, barrel, tip) - tip) / (barrel - tip)))
            }
            _ => None,
        }
    }

    /// True when the rounded part is a ball on the axis: the tool may turn about its centre at a contact.
    #[inline]
    pub fn ends_in_ball(&self) -> bool {
        matches!(self, Self::Ball { .. } | Self::Lollipop { .. } | Self::TaperedBall { .. })
    }

    /// Signed distance to the cutter with its side continued upward without end. Exact inside and outside.
    #[inline]
    pub fn distance(&self, rho: f64, s: f64) -> f64 {
        match *self {
            Self::Flat { radius } => rounded_box(rho, s, radius, 0.0),
            Self::Bull { radius, corner } => rounded_box(rho, s, radius, corner),
            Self::Ball { radius } => {
                if s < radius {
                    norm(rho, s - radius) - radius
                } else {
                    rho - radius
                }
            }
            _ => self.slope(rho, s).value,
        }
    }

    /// [`Self::distance`] with its gradient; at a kink the gradient of one side.
    pub fn slope(&self, rho: f64, s: f64) -> Slope {
        let side = |value: f64| Slope { value, rho: 1.0, s: 0.0 };
        match *self {
            Self::Flat { radius } => rounded_box_slope(rho, s, radius, 0.0),
            Self::Bull { radius, corner } => rounded_box_slope(rho, s, radius, corner),
            Self::Ball { radius } if s >= radius => side(rho - radius),
            Self::Ball { radius } | Self::Lollipop { radius } => from_centre(rho, s - radius, radius),
            Self::TaperedBall { ball, half_angle } => {
                // Side line through the tangent point of the ball; its region begins at the normal of the ball there.
                let (sin, cos) = libm::sincos(half_angle);
                let height = s - ball;
                if height * cos + rho * sin > 0.0 {
                    Slope { value: rho * cos - height * sin - ball, rho: cos, s: -sin }
                } else {
                    from_centre(rho, height, ball)
                }
            }
            Self::Barrel { radius, barrel, tip } => {
                let (inward, height) = (barrel - radius, barrel_height(radius, barrel, tip));
                if s >= height {
                    side(rho - radius)
                } else if (rho + inward) * (tip - height) < (s - height) * inward {
                    // Above the line through the centres of arc and ball, on which both are tangent.
                    from_centre(rho + inward, s - height, barrel)
                } else {
                    from_centre(rho, s - tip, tip)
                }
            }
        }
    }

    /// Radius at a height over the tip, zero below it.
    pub fn radius_at(&self, s: f64) -> f64 {
        if s < 0.0 {
            return 0.0;
        }
        match *self {
            Self::Flat { radius } => radius,
            Self::Ball { radius } => cap(radius, s),
            Self::Bull { radius, corner } => radius - corner + cap(corner, s),
            Self::TaperedBall { ball, half_angle } => {
                let tangent = ball * (1.0 - libm::sin(half_angle));
                if s < tangent {
                    cap(ball, s)
                } else {
                    (ball + (s - ball) * libm::sin(half_angle)) / libm::cos(half_angle)
                }
            }
            Self::Barrel { radius, barrel, tip } => {
                let height = barrel_height(radius, barrel, tip);
                // The ball ends on the line through both centres.
                let tangent = tip - tip * (height - tip) / (barrel - tip);
                if s < tangent {
                    cap(tip, s)
                } else if s < height {
                    ((barrel - (height - s)) * (barrel + (height - s))).max(0.0).sqrt() - (barrel - radius)
                } else {
                    radius
                }
            }
            Self::Lollipop { radius } => (s * (2.0 * radius - s)).max(0.0).sqrt(),
        }
    }

    /// Largest radius below a height.
    #[inline]
    pub fn widest_below(&self, s: f64) -> f64 {
        match *self {
            Self::Lollipop { radius } => self.radius_at(s.min(radius)),
            _ => self.radius_at(s),
        }
    }

    /// Nominal radius of the tool: its largest radius, or that of the ball of a tapered tool.
    #[inline]
    pub fn nominal_radius(&self) -> f64 {
        match *self {
            Self::Flat { radius }
            | Self::Ball { radius }
            | Self::Bull { radius, .. }
            | Self::Barrel { radius, .. }
            | Self::Lollipop { radius } => radius,
            Self::TaperedBall { ball, .. } => ball,
        }
    }

    /// Radius of the rounding that touches the floor: the ball radius, or the corner radius; zero for a flat end.
    #[inline]
    pub fn tip_radius(&self) -> f64 {
        match *self {
            Self::Flat { .. } => 0.0,
            Self::Ball { radius } | Self::Lollipop { radius } => radius,
            Self::Bull { corner, .. } => corner,
            Self::TaperedBall { ball, .. } => ball,
            Self::Barrel { tip, .. } => tip,
        }
    }

    /// Least radius of curvature of the cutter below the end of the flutes; zero with a sharp edge.
    #[inline]
    pub fn least_curvature_radius(&self) -> f64 {
        self.tip_radius()
    }

    /// Height at which a neck of a given radius meets the ball of a lollipop; `None` for other cutters or for a neck
    /// that is too thick.
    #[inline]
    pub fn neck_height(&self, neck: f64) -> Option<f64> {
        match *self {
            Self::Lollipop { radius } if neck > 0.0 && neck < radius => {
                Some(radius + ((radius - neck) * (radius + neck)).sqrt())
            }
            _ => None,
        }
    }

    /// Height over the tip at which a barrel has its largest radius; `None` for other cutters.
    #[inline]
    pub fn barrel_height(&self) -> Option<f64> {
        match *self {
            Self::Barrel { radius, barrel, tip } => Some(barrel_height(radius, barrel, tip)),
            _ => None,
        }
    }

    /// The cutter in another size: all lengths times `by`, the same angles.
    #[must_use]
    #[inline]
    pub fn scaled(&self, by: f64) -> Self {
        match *self {
            Self::Flat { radius } => Self::Flat { radius: radius * by },
            Self::Ball { radius } => Self::Ball { radius: radius * by },
            Self::Bull { radius, corner } => Self::Bull { radius: radius * by, corner: corner * by },
            Self::TaperedBall { ball, half_angle } => Self::TaperedBall { ball: ball * by, half_angle },
            Self::Barrel { radius, barrel, tip } => {
                Self::Barrel { radius: radius * by, barrel: barrel * by, tip: tip * by }
            }
            Self::Lollipop { radius } => Self::Lollipop { radius: radius * by },
        }
    }

    /// The cutter enlarged by a distance on all sides; heights count from its new tip. A flat cutter keeps its corner.
    #[must_use]
    #[inline]
    pub fn enlarged(&self, by: f64) -> Self {
        match *self {
            Self::Flat { radius } => Self::Flat { radius: radius + by },
            Self::Ball { radius } => Self::Ball { radius: radius + by },
            Self::Bull { radius, corner } => Self::Bull { radius: radius + by, corner: corner + by },
            Self::TaperedBall { ball, half_angle } => Self::TaperedBall { ball: ball + by, half_angle },
            Self::Barrel { radius, barrel, tip } => {
                Self::Barrel { radius: radius + by, barrel: barrel + by, tip: tip + by }
            }
            Self::Lollipop { radius } => Self::Lollipop { radius: radius + by },
        }
    }

    /// The cutter as an end across the axis, a corner arc and a straight side: diameter where the lines of end and side
    /// meet, radius of the arc, distance of its centre from the axis and from the end, and angle between side and axis
    /// (radians). Lengths in mm. `None` for cutters with more arcs or a neck.
    #[inline]
    pub fn corner_arc(&self) -> Option<[f64; 5]> {
        match *self {
            Self::Flat { radius } => Some([2.0 * radius, 0.0, radius, 0.0, 0.0]),
            Self::Ball { radius } => Some([2.0 * radius, radius, 0.0, radius, 0.0]),
            Self::Bull { radius, corner } => Some([2.0 * radius, corner, radius - corner, corner, 0.0]),
            Self::TaperedBall { ball, half_angle } => {
                let meeting = ball * (1.0 - libm::sin(half_angle)) / libm::cos(half_angle);
                Some([2.0 * meeting, ball, 0.0, ball, half_angle])
            }
            Self::Barrel { .. } | Self::Lollipop { .. } => None,
        }
    }

    /// Name of its kind.
    #[inline]
    pub fn keyword(&self) -> &'static str {
        match self {
            Self::Flat { .. } => "flat",
            Self::Ball { .. } => "ball",
            Self::Bull { .. } => "bull",
            Self::TaperedBall { .. } => "tapered-ball",
            Self::Barrel { .. } => "barrel",
            Self::Lollipop { .. } => "lollipop",
        }
    }
}

/// Length of a vector of moderate size: several times as fast as `hypot`, which avoids overflow.
#[inline]
pub(super) fn norm(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// Radius of a ball at the height s over its lowest point; above its centre the radius of the ball.
#[inline]
fn cap(radius: f64, s: f64) -> f64 {
    if s < radius { (s * (2.0 * radius - s)).max(0.0).sqrt() } else { radius }
}

/// Height of the centre of the arc of a barrel: the arc touches the ball from inside.
#[inline]
fn barrel_height(radius: f64, barrel: f64, tip: f64) -> f64 {
    let (between, inward) = (barrel - tip, barrel - radius);
    tip + ((between - inward) * (between + inward)).max(0.0).sqrt()
}

/// Distance to a circle, by the position relative to its centre.
#[inline]
fn from_centre(rho: f64, height: f64, radius: f64) -> Slope {
    let length = norm(rho, height);
    // At the centre any direction is valid.
    let (r, s) = if length > 0.0 { (rho / length, height / length) } else { (0.0, -1.0) };
    Slope { value: length - radius, rho: r, s }
}

/// Cylinder over s >= 0, open upward, with a rounded lower corner.
#[inline]
fn rounded_box(rho: f64, s: f64, radius: f64, corner: f64) -> f64 {
    let out = rho - (radius - corner);
    let below = corner - s;
    norm(out.max(0.0), below.max(0.0)) + out.max(below).min(0.0) - corner
}

#[inline]
fn rounded_box_slope(rho: f64, s: f64, radius: f64, corner: f64) -> Slope {
    let out = rho - (radius - corner);
    let below = corner - s;
    if out > 0.0 && below > 0.0 {
        let length = norm(out, below);
        Slope { value: length - corner, rho: out / length, s: -below / length }
    } else if out >= below {
        Slope { value: out - corner, rho: 1.0, s: 0.0 }
    } else {
        Slope { value: below - corner, rho: 0.0, s: -1.0 }
    }
}

/// A cutter by its kind and sizes.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
enum StoredCutter {
    Flat { radius: f64 },
    Ball { radius: f64 },
    Bull { radius: f64, corner: f64 },
    TaperedBall { ball: f64, half_angle: f64 },
    Barrel { radius: f64, barrel: f64, tip: f64 },
    Lollipop { radius: f64 },
}

#[cfg(feature = "serde")]
impl TryFrom<StoredCutter> for Cutter {
    type Error = &'static str;

    fn try_from(stored: StoredCutter) -> Result<Self, Self::Error> {
        let length = |x: f64| x.is_finite() && x > 0.0;
        let (cutter, sound) = match stored {
            StoredCutter::Flat { radius } => (Self::Flat { radius }, length(radius)),
            StoredCutter::Ball { radius } => (Self::Ball { radius }, length(radius)),
            StoredCutter::Lollipop { radius } => (Self::Lollipop { radius }, length(radius)),
            StoredCutter::Bull { radius, corner } => {
                (Self::Bull { radius, corner }, length(radius) && length(corner) && corner <= radius)
            }
            StoredCutter::TaperedBall { ball, half_angle } => (
                Self::TaperedBall { ball, half_angle },
                length(ball) && half_angle > 0.0 && half_angle < std::f64::consts::FRAC_PI_4,
            ),
            StoredCutter::Barrel { radius, barrel, tip } => {
                let sound = length(tip) && length(barrel) && tip < radius && radius < barrel;
                (Self::Barrel { radius, barrel, tip }, sound)
            }
        };
        if sound { Ok(cutter) } else { Err("the sizes of a cutter give no cutter of its kind") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collide::ToolSolid;

    fn solids() -> Vec<ToolSolid> {
        let solid = |cutter, flute_length| ToolSolid { cutter, flute_length, shank: Vec::new(), holder: Vec::new() };
        let lollipop = Cutter::Lollipop { radius: 3.0 };
        vec![
            solid(Cutter::Flat { radius: 4.0 }, 12.0),
            solid(Cutter::Ball { radius: 3.0 }, 12.0),
            solid(Cutter::Bull { radius: 4.0, corner: 1.0 }, 12.0),
            solid(Cutter::TaperedBall { ball: 1.5, half_angle: 0.1 }, 12.0),
            solid(Cutter::Barrel { radius: 5.0, barrel: 40.0, tip: 1.0 }, 14.0),
            solid(lollipop, lollipop.neck_height(2.0).unwrap()),
        ]
    }

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
                let corner = matches!(cutter, Cutter::Flat { .. }) && nearer > BY && nearer < 2.0_f64.sqrt() * BY;
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
                    assert!(matches!(solid.cutter, Cutter::Flat { .. }));
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
