//! The ball at the tip of a cutter over a piece of motion: a capsule.
//!
//! The ball lies inside of the cutter, and turning does not move it about its centre. Its centres over a piece lie within
//! fractions of a micrometre of a segment, so that the distance of a point to the swept ball is closed in form. Where the
//! cutter is its ball, seen from a place, that is the distance to the cutter.

use super::piece::Piece;
use crate::collide::{Cutter, ToolSolid};
use nalgebra::{Point3, Vector3};

/// The ball at the tip of a cutter; it lies inside of the cutter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    /// Radius, mm.
    pub(crate) radius: f64,
    /// Largest s-component of the normal at which the cutter is this ball.
    pub(crate) upper: f64,
}

impl Ball {
    /// The ball of a tool, if it has one.
    pub(crate) fn of(solid: &ToolSolid) -> Option<Self> {
        let radius = solid.cutter.tip_radius();
        let upper = match solid.cutter {
            Cutter::Flat { .. } | Cutter::Bull { .. } => return None,
            Cutter::Ball { .. } | Cutter::Lollipop { .. } => 0.0,
            Cutter::TaperedBall { half_angle, .. } => -libm::sin(half_angle),
            Cutter::Barrel { barrel, .. } => -(solid.cutter.barrel_height()? - radius) / (barrel - radius),
        };
        (solid.flute_length >= 2.0 * radius).then_some(Self { radius, upper })
    }
}

/// A ball over a piece.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Capsule {
    /// Centre at the start.
    start: Point3<f64>,
    /// From there to the centre at the end.
    way: Vector3<f64>,
    /// One over its length squared; zero for a ball that stands still.
    per_way: f64,
    /// No centre leaves the segment by more, mm.
    flaw: f64,
    /// Axis in the middle of the piece.
    axis: Vector3<f64>,
    /// Half of the turn, radians.
    turn: f64,
    /// Most that the height of a point over the centre differs from that in the middle, but for the turn, mm.
    lift: f64,
}

/// The place of a capsule that is nearest to a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    /// Share of the piece.
    pub(crate) t: f64,
    /// From the centre there to the point.
    pub(crate) out: Vector3<f64>,
    /// Its length.
    pub(crate) length: f64,
}

impl Foot {
    /// Direction of the point; none in the centre.
    pub(crate) fn direction(&self) -> Vector3<f64> {
        if self.length > 0.0 { self.out / self.length } else { Vector3::zeros() }
    }
}

impl Capsule {
    /// The capsule of a ball of a radius at the tip over a piece.
    pub(crate) fn new(piece: &Piece, radius: f64) -> Self {
        let [start, end] = [0.0, 1.0].map(|t| piece.ball_centre(t, radius).0);
        let way = end - start;
        let square = way.norm_squared();
        let (_, axis) = piece.middle();
        let (half_way, turn) = piece.reach();
        // A curve leaves its chord by an eighth of its second derivative.
        let flaw = 0.125 * piece.ball_drift(radius).bend;
        Self {
            start,
            way,
            per_way: if square > 0.0 { 1.0 / square } else { 0.0 },
            flaw,
            axis: *axis,
            turn,
            lift: 0.5 * piece.speed().0.dot(axis).abs() + half_way * turn + flaw,
        }
    }

    /// The nearest place to a point. The ball comes nowhere nearer than the length there, less the radius and
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

    /// True if the cutter reaches no farther in a direction than its ball, at any time of the piece: then a half-space
    /// along it that holds the balls holds the cutters, and the ball is what is nearest to a point that lies that way.
    pub(crate) fn bears(&self, ball: Ball, direction: &Vector3<f64>) -> bool {
        direction.dot(&self.axis) + self.turn <= ball.upper
    }

    /// From the centre at the start to that at the end.
    pub(crate) fn way(&self) -> &Vector3<f64> {
        &self.way
    }

    /// How far the true centres may lie from the segment, mm.
    pub(crate) fn flaw(&self) -> f64 {
        self.flaw
    }

    /// True if the cutter is its ball, seen from all points within a radius of one, over the whole piece.
    ///
    /// The height of p over the centre is (p - tip) . axis - ball radius. From the middle of the piece on, the axis
    /// changes by at most the turn and the tip by its way.
    pub(crate) fn rules(&self, ball: Ball, p: &Point3<f64>, radius: f64) -> bool {
        let from = p - (self.start + self.way * 0.5);
        let far = from.norm();
        let highest = from.dot(&self.axis) + self.turn * (far + radius + ball.radius) + self.lift + radius;
        let most = if ball.upper < 0.0 { far + radius + 0.5 * self.way.norm() + self.flaw } else { 0.0 };
        highest <= ball.upper * most
    }
}
