//! The ball at the tip of a cutter over a piece of motion: a capsule.
//!
//! The ball lies inside of the cutter, and turning about the centre of the ball does not move the ball. Over a piece
//! the centres lie within fractions of 1 um of a segment, so that the distance of a point to the swept ball has a
//! closed form. Where the ball is the nearest part of the cutter, this is the distance to the cutter.

use super::piece::{HalfMotion, Piece};
use nalgebra::{Point3, Vector3};
use tool_stock::collide::ToolSolid;

/// The ball at the tip of a cutter; it lies inside of the cutter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    /// Radius, mm.
    pub(crate) radius: f64,
    /// Largest s-component of the normal at which the surface of the cutter is this ball.
    pub(crate) upper: f64,
}

impl Ball {
    /// The ball of a tool, if it has one.
    pub(crate) fn of(solid: &ToolSolid) -> Option<Self> {
        let radius = solid.cutter.tip_radius();
        // The first arc of the meridian is a ball where its centre is on the axis. Above the equator shank or neck may be nearer.
        let arc = solid.cutter.arcs().first()?;
        let upper = (-arc.sine()).min(0.0);
        let is_ball = arc.ring == 0.0 && radius > 0.0;
        (is_ball && solid.flute_length >= 2.0 * radius).then_some(Self { radius, upper })
    }
}

/// The ball over a piece.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Capsule {
    /// Centre at the start.
    start: Point3<f64>,
    /// Vector from there to the centre at the end.
    way: Vector3<f64>,
    /// Inverse of the squared length of this vector; zero for a ball that stands still.
    per_way: f64,
    /// Largest distance of a centre from the segment, mm.
    flaw: f64,
    /// Axis in the middle of the piece.
    axis: Vector3<f64>,
    /// Half of the turn, radians.
    turn: f64,
    /// Largest change of the height of a point over the centre from the middle of the piece on, apart from the turn,
    /// mm.
    lift: f64,
}

/// The place on a capsule nearest to a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    /// Share of the piece.
    pub(crate) t: f64,
    /// Vector from the centre there to the point.
    pub(crate) out: Vector3<f64>,
    /// Length of this vector.
    pub(crate) length: f64,
}

impl Foot {
    /// Direction to the point; zero in the centre.
    pub(crate) fn direction(&self) -> Vector3<f64> {
        if self.length > 0.0 { self.out / self.length } else { Vector3::zeros() }
    }
}

impl Capsule {
    /// The capsule of a tip ball of a given radius over a piece.
    pub(crate) fn new(piece: &Piece, radius: f64) -> Self {
        let [start, end] = [0.0, 1.0].map(|t| piece.ball_centre(t, radius));
        let way = end - start;
        let square = way.norm_squared();
        let axis = &piece.middle().axis;
        let HalfMotion { way: half_way, turn } = piece.half();
        // A curve deviates from its chord by at most an eighth of its second derivative.
        let flaw = 0.125 * piece.ball_drift(radius).second;
        Self {
            start,
            way,
            per_way: if square > 0.0 { 1.0 / square } else { 0.0 },
            flaw,
            axis: *axis,
            turn,
            lift: 0.5 * piece.speed().tip.dot(axis).abs() + half_way * turn + flaw,
        }
    }

    /// The nearest place to a point. A lower bound of the distance to the ball is the length there, less the radius and
    /// [`Self::flaw`].
    pub(crate) fn foot(&self, p: &Point3<f64>) -> Foot {
        let from = p - self.start;
        let t = (from.dot(&self.way) * self.per_way).clamp(0.0, 1.0);
        let out = from - self.way * t;
        Foot { t, out, length: out.norm() }
    }

    /// Centres at both ends.
    pub(crate) fn ends(&self) -> [Point3<f64>; 2] {
        [self.start, self.start + self.way]
    }

    /// True if at any time of the piece the cutter reaches no farther in a direction than its ball. A half-space along
    /// this direction that contains the balls then contains the cutters, and the ball is the part nearest to a point in
    /// this direction.
    pub(crate) fn bears(&self, ball: Ball, direction: &Vector3<f64>) -> bool {
        direction.dot(&self.axis) + self.turn <= ball.upper
    }

    /// Vector from the centre at the start to the centre at the end.
    pub(crate) fn way(&self) -> &Vector3<f64> {
        &self.way
    }

    /// Largest distance of a true centre from the segment, mm.
    pub(crate) fn flaw(&self) -> f64 {
        self.flaw
    }

    /// True if the ball is the nearest part of the cutter over the whole piece, for all points within a radius of `p`.
    ///
    /// The height of p over the centre is (p - tip) . axis - ball radius. From the middle of the piece on, the axis
    /// changes by at most the turn, and the tip by at most its motion.
    pub(crate) fn rules(&self, ball: Ball, p: &Point3<f64>, radius: f64) -> bool {
        let from = p - (self.start + self.way * 0.5);
        let far = from.norm();
        let highest = from.dot(&self.axis) + self.turn * (far + radius + ball.radius) + self.lift + radius;
        let most = if ball.upper < 0.0 { far + radius + 0.5 * self.way.norm() + self.flaw } else { 0.0 };
        highest <= ball.upper * most
    }
}
