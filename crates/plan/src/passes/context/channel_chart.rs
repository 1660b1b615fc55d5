//! Coordinates of a channel: u from inlet to outlet, v from hub to shroud, w from its first wall to its second.

use nalgebra::{Point3, Rotation3, Vector3};
use nurbs::angle::nearest_turn;
use std::cell::OnceCell;
use wheel::part::{Across, FaceLine, Part, PassageId, WholeWall};

/// Least outward tilt of tool axes in the channel, as the sine of the angle to the axis of rotation (11.5 deg). Where
/// the rulings stand upright, the axis would otherwise come near the pole of a tilting table, and rotary axis 2 would
/// have to turn through.
pub(crate) const MIN_OUTWARD: f64 = 0.2;

/// Share of the opposite wall's ruling in the axis at a wall. If the axis were parallel to the ruling, the side of the
/// cutter would rest on the twisted wall far above the tip, and the tip could not reach the root.
const OPPOSITE_RULING_SHARE: f64 = 0.12;

/// Step of differences of the map, as a share of the channel.
const DIFFERENCE_STEP: f64 = 1e-3;

/// Width over which the outward tilt sets in, so that the axes remain smooth.
const TILT_SOFTNESS: f64 = 0.05;

/// A passage of sector 0 as a map from (u, v, w) to points. Its walls are the facing faces of two neighbouring blades; a
/// splitter's is continued to inlet and outlet. Between them points lie on arcs about Z, so that the map keeps the walls and
/// the symmetry of the part.
#[derive(Clone, Copy)]
pub(crate) struct ChannelChart<'a> {
    part: &'a Part,
    first: &'a WholeWall,
    second: &'a WholeWall,
    /// Angle from the sector of the first wall to that of the second, radians.
    turn: f64,
    /// Sense in which the channel runs outward: 1 from inlet to outlet, -1 where it runs inward, as in a turbine.
    outward: f64,
}

/// Radius of the outlet as a share of that of the inlet below which a channel runs inward.
const INWARD: f64 = 0.8;

impl<'a> ChannelChart<'a> {
    pub(crate) fn new(part: &'a Part, passage: PassageId) -> Self {
        let [first, second] = part.walls(passage);
        let [inlet, outlet] = [0.0, 1.0].map(|u| part.hub.meridian(u).point.x);
        let outward = if outlet < INWARD * inlet { -1.0 } else { 1.0 };
        Self { part, first, second, turn: part.turn(&part.passage(passage)), outward }
    }

    /// The part.
    pub(crate) fn part(&self) -> &'a Part {
        self.part
    }

    /// The channel at u.
    pub(crate) fn crossing(&self, u: f64) -> Crossing<'a> {
        let lines = [self.first, self.second].map(|wall| wall.line(u));
        Crossing { chart: *self, u, lines, middle: OnceCell::new() }
    }

    /// Point at (u, v, w).
    pub(crate) fn point(&self, u: f64, v: f64, w: f64) -> Point3<f64> {
        self.crossing(u).point(v, w)
    }

    /// Length of the arc between the walls at (u, v).
    pub(crate) fn width(&self, u: f64, v: f64) -> f64 {
        self.crossing(u).width(v)
    }

    /// Distance of the walls square to the direction of the channel at (u, v).
    pub(crate) fn across(&self, u: f64, v: f64) -> f64 {
        let at = self.crossing(u);
        let middle = at.point(v, 0.5);
        let along = self.point(u + DIFFERENCE_STEP, v, 0.5) - middle;
        let across = (at.point(v, 0.5 + DIFFERENCE_STEP) - middle).normalize();
        at.width(v) * across.cross(&along).norm() / along.norm()
    }

    /// Direction of the channel on the hub at (u, w), from inlet to outlet: its parts along the meridian and around Z, of unit
    /// length together.
    pub(crate) fn direction(&self, u: f64, w: f64) -> [f64; 2] {
        let [a, b] = [u - DIFFERENCE_STEP, u + DIFFERENCE_STEP].map(|u| self.point(u, 0.0, w));
        let [from, to] = [a, b].map(|p| libm::hypot(p.x, p.y));
        let along = libm::hypot(to - from, b.z - a.z);
        let turn = nearest_turn(libm::atan2(b.y, b.x) - libm::atan2(a.y, a.x), 0.0);
        let around = 0.5 * (from + to) * turn;
        let length = libm::hypot(along, around);
        [along / length, around / length]
    }

    /// Direction from hub to shroud: the rulings of both neighbouring vanes, blended by `blend` from the first (0) to
    /// the second (1).
    pub(crate) fn ruling(&self, u: f64, blend: f64) -> Vector3<f64> {
        blended(&self.rulings(u), blend)
    }

    /// Rulings of both walls.
    fn rulings(&self, u: f64) -> [Vector3<f64>; 2] {
        [self.first.ruling(u), self.second_turn() * self.second.ruling(u)]
    }

    /// The turn from the sector of the first wall to that of the second.
    pub(crate) fn second_turn(self) -> Rotation3<f64> {
        Rotation3::from_axis_angle(&Vector3::z_axis(), self.turn)
    }

    /// Blended ruling with an outward tilt, see [`Crossing::axis`].
    pub(crate) fn tilted_ruling(&self, u: f64, w: f64, blend: f64) -> Vector3<f64> {
        self.crossing(u).tilted_ruling(w, blend)
    }

    /// Largest length of a ruling of either wall.
    pub(crate) fn height(&self) -> f64 {
        (0..=40)
            .map(|i| f64::from(i) / 40.0)
            .flat_map(|u| [self.first, self.second].map(|f| (f.point(u, 1.0) - f.point(u, 0.0)).norm()))
            .fold(0.0, f64::max)
    }

    /// Change of u that moves the middle of the channel by a given length at the inlet (u = 0) or the outlet (u = 1).
    pub(crate) fn lead(&self, u: f64, v: f64, length: f64) -> f64 {
        let step = 1e-3;
        length * step / (self.point(u + step, v, 0.5) - self.point(u, v, 0.5)).norm()
    }
}

/// The channel at one u. What places at this u share is computed once.
pub(crate) struct Crossing<'a> {
    chart: ChannelChart<'a>,
    u: f64,
    /// Both walls.
    lines: [FaceLine<'a>; 2],
    middle: OnceCell<MiddleHeight>,
}

/// What the tool axes at one u depend on.
struct MiddleHeight {
    /// Walls at half height here, and a step before and behind.
    walls: Across,
    before: Across,
    behind: Across,
    rulings: [Vector3<f64>; 2],
}

/// Step of differences along and across the channel.
const AXIS_STEP: f64 = 1e-3;

impl Crossing<'_> {
    pub(crate) fn u(&self) -> f64 {
        self.u
    }

    pub(crate) fn chart(&self) -> &ChannelChart<'_> {
        &self.chart
    }

    pub(crate) fn part(&self) -> &Part {
        self.chart.part
    }

    /// Point at (v, w).
    pub(crate) fn point(&self, v: f64, w: f64) -> Point3<f64> {
        self.walls(v).point(w)
    }

    /// Length of the arc between the walls at v.
    pub(crate) fn width(&self, v: f64) -> f64 {
        self.walls(v).length()
    }

    fn walls(&self, v: f64) -> Across {
        Across::between(self.lines.map(|line| line.point(v)), self.chart.turn)
    }

    fn middle(&self) -> &MiddleHeight {
        self.middle.get_or_init(|| {
            let walls = |u: f64| self.chart.crossing(u).walls(0.5);
            let [before, behind] = [self.u - AXIS_STEP, self.u + AXIS_STEP].map(walls);
            MiddleHeight { walls: self.walls(0.5), before, behind, rulings: self.chart.rulings(self.u) }
        })
    }

    /// Tool axis at (v, w) for a tool whose axis is `edge` away from a wall that it touches. At a wall the axis is
    /// parallel to its ruling except for the share [`OPPOSITE_RULING_SHARE`]; between the walls it is blended.
    ///
    /// At each wall the axis tilts away from it by a further angle, `tilts`; in the middle it does not.
    pub(crate) fn axis(&self, v: f64, w: f64, edge: f64, tilts: [f64; 2]) -> Vector3<f64> {
        // A channel narrower than the tool cannot blend; the axis of the middle is the best choice.
        let e = (edge / self.width(v)).min(0.49);
        let across = ((w - e) / (1.0 - 2.0 * e)).clamp(0.0, 1.0);
        let axis = self.tilted_ruling(w, OPPOSITE_RULING_SHARE + (1.0 - 2.0 * OPPOSITE_RULING_SHARE) * across);
        let [first, second] = tilts.map(libm::tan);
        let walls = &self.middle().walls;
        let to_second = walls.point(w + AXIS_STEP) - walls.point(w - AXIS_STEP);
        let to_second = (to_second - axis * axis.dot(&to_second)).normalize();
        (axis + to_second * (first * (1.0 - across) - second * across)).normalize()
    }

    /// Blended ruling with an outward tilt, along the channel, of at least [`MIN_OUTWARD`].
    fn tilted_ruling(&self, w: f64, blend: f64) -> Vector3<f64> {
        let middle = self.middle();
        let ruling = blended(&middle.rulings, blend);
        let at = middle.walls.point(w);
        let outward = Vector3::new(at.x, at.y, 0.0).normalize();
        let along = (middle.behind.point(w) - middle.before.point(w)).normalize() * self.chart.outward;
        let along = (along - ruling * along.dot(&ruling)).normalize();
        let missing = MIN_OUTWARD - ruling.dot(&outward);
        let soft = 0.5 * (missing + libm::hypot(missing, TILT_SOFTNESS));
        // At the inlet the channel does not run outward, but there the tilt is large enough.
        (ruling + along * (soft / along.dot(&outward).max(0.3))).normalize()
    }
}

fn blended([first, second]: &[Vector3<f64>; 2], blend: f64) -> Vector3<f64> {
    (first * (1.0 - blend) + second * blend).normalize()
}
