//! The meridian of a cutter: a convex profile of arcs and the lines that touch them, from the tip to the end of the flutes.
//!
//! A point is given by its distance `rho` from the axis and its height `s` over the tip. A normal is given by its angle from the radial
//! direction towards the tip: it is pi/2 at a flat end and 0 at a side along the axis.
//!
//! The signed distance to a convex body is the largest, over all unit normals, of the signed distance to the tangent with this normal. It
//! has a local maximum for each arc that sees the point within its normals, and for each line that has the foot of the point between its
//! ends. All functions follow from this list; none knows the kind of a cutter.

use std::f64::consts::FRAC_PI_2;

/// Most arcs of a meridian.
const MAX_ARCS: usize = 4;

/// Largest gap between a line and the arc that it touches, share of the size of the cutter.
const SAME_TANGENT: f64 = 1e-9;

/// An arc of the meridian, and the line that touches it above. An arc of radius zero is a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Distance of its centre from the axis, mm; negative beyond the axis.
    pub ring: f64,
    /// Height of its centre over the tip, mm.
    pub height: f64,
    /// Radius, mm.
    pub radius: f64,
    /// Angle of the normal at its upper end and on the line above, radians. The arc begins with the angle of the line below.
    pub to: f64,
    /// Cosine and sine of that angle.
    pub(super) normal: [f64; 2],
}

impl Arc {
    /// An arc by its centre (distance from the axis, height over the tip) and its radius, mm, and by the angle of the normal at its upper
    /// end, radians.
    pub fn new([ring, height]: [f64; 2], radius: f64, to: f64) -> Self {
        let (sin, cos) = libm::sincos(to);
        // Half a turn from the end of the cutter: exactly upward.
        let normal = if to <= -FRAC_PI_2 { [0.0, -1.0] } else { [cos, sin] };
        Self { ring, height, radius, to, normal }
    }

    /// Sine of the angle of the normal at the upper end.
    pub fn sine(&self) -> f64 {
        self.normal[1]
    }

    /// Height at which the arc ends and the line above begins.
    fn end(&self) -> f64 {
        self.height - self.radius + self.radius * (1.0 - self.normal[1])
    }
}

/// A convex profile of arcs and lines, with the angle of the normal decreasing from pi/2 at the tip. The last line goes on upward without end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meridian {
    arcs: [Arc; MAX_ARCS],
    count: usize,
    /// Nominal radius.
    pub(super) radius: f64,
    /// Distance of a last line along the axis from the axis.
    pub(super) side: f64,
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

/// Cosine and sine of the normal of a flat end.
const DOWN: [f64; 2] = [0.0, 1.0];

impl Meridian {
    /// The meridian of one to four arcs that are known to form one.
    pub(super) fn of(arcs: &[Arc]) -> Self {
        let count = arcs.len();
        let last = arcs[count - 1];
        let side = last.ring + last.radius;
        Self { arcs: std::array::from_fn(|i| arcs[i.min(count - 1)]), count, radius: side, side }
    }

    /// The meridian of one to four arcs from the tip upward. `None` unless they begin at the tip with a normal along the axis, each line
    /// touches the arcs at both of its ends, and the normals turn from the tip to the side.
    pub fn new(arcs: &[Arc]) -> Option<Self> {
        let (first, last) = (arcs.first()?, arcs.last()?);
        let size = arcs.iter().map(|a| a.ring.abs() + a.height.abs() + a.radius).fold(0.0, f64::max);
        let small = SAME_TANGENT * size;
        let sound = |a: &Arc| [a.ring, a.height, a.radius, a.to].iter().all(|x| x.is_finite()) && a.radius >= 0.0;
        let joined = arcs.windows(2).all(|pair| {
            let [below, above] = [&pair[0], &pair[1]];
            let ([cos, sin], x, h) = (below.normal, above.ring - below.ring, above.height - below.height);
            (x * cos - h * sin + above.radius - below.radius).abs() <= small
                && x * sin + h * cos >= -small
                && above.to < below.to
        });
        let whole = first.ring >= 0.0 && (first.height - first.radius).abs() <= small && first.to < FRAC_PI_2;
        let ends = last.to >= -FRAC_PI_2 && last.ring + last.radius > 0.0;
        let holds = arcs.len() <= MAX_ARCS && arcs.iter().all(sound) && joined && whole && ends;
        holds.then(|| Self::of(arcs))
    }

    /// Its arcs from the tip upward, at least one.
    #[inline]
    pub fn arcs(&self) -> &[Arc] {
        &self.arcs[..self.count]
    }

    /// The arc at the tip.
    #[inline]
    pub fn first(&self) -> &Arc {
        &self.arcs[0]
    }

    #[inline]
    fn last(&self) -> &Arc {
        &self.arcs[self.count - 1]
    }

    /// The only arc of a cutter whose side is along the axis: a flat, ball or bull nose end.
    #[inline]
    pub fn only_corner(&self) -> Option<&Arc> {
        (self.count == 1 && self.arcs[0].to == 0.0).then_some(&self.arcs[0])
    }

    /// The arc above that of the tip, as barrels have it; `None` for other cutters.
    #[inline]
    pub fn barrel_arc(&self) -> Option<&Arc> {
        (self.count > 1 && self.arcs[1].radius > 0.0).then_some(&self.arcs[1])
    }

    /// Angle of the normal, radians, from the radial direction towards the tip, at which the arc of a barrel meets its ball tip;
    /// `None` for other cutters.
    #[inline]
    pub fn barrel_angle(&self) -> Option<f64> {
        self.barrel_arc().map(|_| self.arcs[0].to)
    }

    /// The point of the rounded profile whose outward normal is inclined from the radial direction towards the tip by
    /// an angle, radians in (0, pi/2]; `None` for a corner, which has no such point.
    #[inline]
    pub fn profile_at(&self, angle: f64) -> Option<ProfilePoint> {
        let arc = self.arcs().iter().find(|arc| angle >= arc.to).unwrap_or_else(|| self.last());
        let (sin, cos) = libm::sincos(angle);
        (arc.radius > 0.0).then_some(ProfilePoint {
            rho: arc.ring + arc.radius * cos,
            s: arc.height - arc.radius * sin,
            arc_radius: arc.radius,
        })
    }

    /// True when the rounded part is a ball on the axis: the tool may turn about its centre at a contact.
    #[inline]
    pub fn ends_in_ball(&self) -> bool {
        self.count == 1 && self.arcs[0].ring == 0.0 && self.arcs[0].radius > 0.0
    }

    /// Signed distance to the cutter with its side continued upward without end. Exact inside and outside.
    #[inline]
    pub fn distance(&self, rho: f64, s: f64) -> f64 {
        // Most cutters have one corner and a side along the axis; without a branch the query is inlined into its loops.
        if let Some(arc) = self.only_corner() {
            let (out, below) = (rho - arc.ring, arc.radius - s);
            return norm(out.max(0.0), below.max(0.0)) + out.max(below).min(0.0) - arc.radius;
        }
        self.slope(rho, s).value
    }

    /// [`Self::distance`] with its gradient; at a kink the gradient of one side.
    pub fn slope(&self, rho: f64, s: f64) -> Slope {
        if let Some(arc) = self.only_corner() {
            return corner_slope(rho - arc.ring, arc.radius - s, arc.radius);
        }
        let mut largest = Slope { value: f64::NEG_INFINITY, rho: 0.0, s: -1.0 };
        let mut candidate = |slope: Slope| {
            if slope.value > largest.value {
                largest = slope;
            }
        };
        let on_line = |arc: &Arc, [cos, sin]: [f64; 2]| Slope {
            value: (rho - arc.ring) * cos - (s - arc.height) * sin - arc.radius,
            rho: cos,
            s: -sin,
        };
        // The line below an arc: its normal, and the arc from which it comes if the foot is beyond that arc.
        let (mut below, mut on_line_from) = (DOWN, Some(self.first()));
        for arc in self.arcs() {
            let (x, h) = (rho - arc.ring, s - arc.height);
            let past = |[cos, sin]: [f64; 2]| h * cos + x * sin;
            if past(below) < 0.0 {
                if let Some(line) = on_line_from {
                    candidate(on_line(line, below));
                }
            } else if past(arc.normal) <= 0.0 {
                candidate(from_centre(x, h, arc.radius));
            }
            on_line_from = (past(arc.normal) > 0.0).then_some(arc);
            below = arc.normal;
        }
        match on_line_from {
            Some(last) if last.to == 0.0 => candidate(Slope { value: rho - self.side, rho: 1.0, s: 0.0 }),
            Some(last) => candidate(on_line(last, below)),
            None => {}
        }
        largest
    }

    /// Radius at a height over the tip, zero below it.
    pub fn radius_at(&self, s: f64) -> f64 {
        if s < 0.0 {
            return 0.0;
        }
        for (i, arc) in self.arcs().iter().enumerate() {
            let over = arc.height - s;
            if i > 0 && s < arc.height - arc.radius * self.arcs[i - 1].normal[1] {
                return on_line(&self.arcs[i - 1], s);
            }
            if s < arc.end() || arc.to <= -FRAC_PI_2 {
                // The first arc begins at height 0: there this product is exact for small heights.
                let square =
                    if i == 0 { s * (2.0 * arc.radius - s) } else { (arc.radius - over) * (arc.radius + over) };
                return arc.ring + square.max(0.0).sqrt();
            }
        }
        if self.last().to == 0.0 { self.side } else { on_line(self.last(), s) }
    }

    /// Largest radius below a height.
    #[inline]
    pub fn widest_below(&self, s: f64) -> f64 {
        let last = self.last();
        self.radius_at(if last.to < 0.0 { s.min(last.height) } else { s })
    }

    /// Nominal radius of the tool: its largest radius, or that of the ball of a tapered tool.
    #[inline]
    pub fn nominal_radius(&self) -> f64 {
        self.radius
    }

    /// Radius of the rounding that touches the floor: the ball radius, or the corner radius; zero for a flat end.
    #[inline]
    pub fn tip_radius(&self) -> f64 {
        self.arcs[0].radius
    }

    /// Radius of the end at the floor: of the flat end with the rounding about it.
    #[inline]
    pub fn end_radius(&self) -> f64 {
        if self.count == 1 { self.radius } else { self.arcs[0].ring + self.arcs[0].radius }
    }

    /// True when the cutter grows wider than its end with the height, as a taper or barrel.
    #[inline]
    pub fn widens(&self) -> bool {
        self.count > 1 || self.arcs[0].to > 0.0
    }

    /// Height at which a neck of a given radius meets the ball of a lollipop; `None` for other cutters or for a neck
    /// that is too thick.
    #[inline]
    pub fn neck_height(&self, neck: f64) -> Option<f64> {
        let last = self.last();
        let neck = neck - last.ring;
        (last.to < 0.0 && neck > 0.0 && neck < last.radius)
            .then(|| last.height + ((last.radius - neck) * (last.radius + neck)).sqrt())
    }

    /// The cutter as an end across the axis, a corner arc and a straight side: diameter where the lines of end and side
    /// meet, radius of the arc, distance of its centre from the axis and from the end, and angle between side and axis
    /// (radians). Lengths in mm. `None` for cutters with more arcs or a neck.
    #[inline]
    pub fn corner_arc(&self) -> Option<[f64; 5]> {
        let arc = self.first();
        let [cos, sin] = arc.normal;
        let meeting = if arc.to == 0.0 { self.radius } else { arc.ring + arc.radius * (1.0 - sin) / cos };
        (self.count == 1 && arc.to >= 0.0).then_some([2.0 * meeting, arc.radius, arc.ring, arc.height, arc.to])
    }

    /// Least value of `along` s - `across` rho over the cutter below a height; `across` is not negative.
    pub(super) fn least(&self, along: f64, across: f64, top: f64) -> f64 {
        let point = |rho: f64, s: f64| along * s - across * rho;
        let (length, angle) = (libm::hypot(along, across), libm::atan2(along, across));
        let mut least = point(self.radius_at(top), top);
        let mut from = FRAC_PI_2;
        for arc in self.arcs() {
            let [_, sin] = arc.normal;
            // The arc where its normal points against the direction, unless the plane at the end of the flutes cuts this off.
            if (arc.to..=from).contains(&angle) && arc.height - arc.radius * along / length <= top {
                least = least.min(point(arc.ring, arc.height) - arc.radius * length);
            }
            let end = arc.height - arc.radius * sin;
            if end < top {
                least = least.min(point(self.radius_at(end), end));
            }
            from = arc.to;
        }
        least
    }

    /// All lengths times `by`, the same angles.
    pub(super) fn scaled(&self, by: f64) -> Self {
        let scaled = |a: Arc| Arc { ring: a.ring * by, height: a.height * by, radius: a.radius * by, ..a };
        Self { arcs: self.arcs.map(scaled), radius: self.radius * by, side: self.side * by, ..*self }
    }

    /// Another radius of the end. A round end is scaled with the whole cutter; a flat end keeps all corners.
    pub(super) fn with_end_radius(&self, radius: f64) -> Self {
        let more = radius - self.end_radius();
        if self.arcs[0].ring == 0.0 && self.arcs[0].radius > 0.0 {
            return self.scaled(radius / self.arcs[0].radius);
        }
        let moved = |a: Arc| Arc { ring: a.ring + more, ..a };
        Self { arcs: self.arcs.map(moved), radius: self.radius + more, side: self.side + more, ..*self }
    }

    /// Enlarged by a distance on all sides; heights count from the new tip. Corners stay sharp.
    pub(super) fn enlarged(&self, by: f64) -> Self {
        let mut arcs = self.arcs;
        let mut below = DOWN;
        for arc in &mut arcs[..self.count] {
            let above = arc.normal;
            if arc.radius > 0.0 {
                arc.radius += by;
                arc.height += by;
            } else {
                // Where both lines meet after they have moved.
                let share = by / (1.0 + below[0] * above[0] + below[1] * above[1]);
                arc.ring += share * (below[0] + above[0]);
                arc.height += by - share * (below[1] + above[1]);
            }
            below = above;
        }
        Self { arcs, radius: self.radius + by, side: self.side + by, ..*self }
    }
}

/// Length of a vector of moderate size: several times as fast as `hypot`, which avoids overflow.
#[inline]
pub(super) fn norm(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// Radius at a height on the line above an arc.
fn on_line(arc: &Arc, s: f64) -> f64 {
    let [cos, sin] = arc.normal;
    arc.ring + (arc.radius + (s - arc.height) * sin) / cos
}

/// Distance to a circle, by the position relative to its centre.
#[inline]
fn from_centre(rho: f64, height: f64, radius: f64) -> Slope {
    let length = norm(rho, height);
    // At the centre any direction is valid.
    let (r, s) = if length > 0.0 { (rho / length, height / length) } else { (0.0, -1.0) };
    Slope { value: length - radius, rho: r, s }
}

/// Distance to an end across the axis, a corner and a side along the axis, by the position outward of and below the centre of the corner.
#[inline]
fn corner_slope(out: f64, below: f64, corner: f64) -> Slope {
    if out > 0.0 && below > 0.0 {
        let length = norm(out, below);
        Slope { value: length - corner, rho: out / length, s: -below / length }
    } else if out >= below {
        Slope { value: out - corner, rho: 1.0, s: 0.0 }
    } else {
        Slope { value: below - corner, rho: 0.0, s: -1.0 }
    }
}
