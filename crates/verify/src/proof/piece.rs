//! Pieces of moves: the poses of the tool over a part of a move, and how far its points move.

use five_axis::chain::Turning;
use five_axis::{Angles, Chain, Joints, Machine, Pose, RotaryPose, between};
use ir::{Motion, MoveKind};
use nalgebra::{Point3, Vector3};

/// Share of a part by which the number of parts of a move may exceed a whole number through rounding: moves of whole parts
/// are divided alike in all sectors.
const COUNT_ROUNDING: f64 = 1e-6;

/// Largest turn of a piece when the rotary axes are at a right angle, radians: 1 deg.
const MAX_PIECE_TURN: f64 = std::f64::consts::PI / 180.0;

/// Longest tip motion in a piece, mm: a long link would lie in one node with everything that it passes.
pub(crate) const MAX_PIECE_LENGTH: f64 = 3.0;

/// A place in the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub struct At {
    /// Index of the operation in the motion.
    pub operation: u32,
    /// Index of the move that ends the piece.
    pub index: u32,
}

/// Half of the motion of a piece.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfMotion {
    /// Half of the tip motion, mm.
    pub(crate) way: f64,
    /// Half of the turn, radians.
    pub(crate) turn: f64,
}

/// Derivatives of a pose by the share.
pub(crate) struct PoseSpeed {
    pub(crate) tip: Vector3<f64>,
    pub(crate) axis: Vector3<f64>,
}

/// The parabola of a piece at one share.
pub(crate) struct QuickPose {
    pub(crate) tip: Point3<f64>,
    pub(crate) axis: Vector3<f64>,
    /// Derivative of the axis by the share.
    pub(crate) change: Vector3<f64>,
}

/// A part of one move.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'a> {
    chain: &'a Chain,
    /// Move that the piece belongs to.
    pub at: At,
    /// Kind of that move.
    pub kind: MoveKind,
    pub(crate) tips: [Point3<f64>; 2],
    rotary: [Angles; 2],
    /// Middle pose.
    middle: Pose,
    /// Parabola through the axis at both ends and in the middle: value, and factors of the share and of its square.
    curve: [Vector3<f64>; 3],
    half: HalfMotion,
    /// Index among the pieces of the operation, in the order of time.
    pub(crate) order: u32,
}

impl<'a> Piece<'a> {
    /// Tip and axis at a share of the piece.
    pub fn pose(&self, t: f64) -> Pose {
        let axis = self.chain.tool_axis(between(self.rotary[0], self.rotary[1], t));
        Pose { tip: self.tips[0] + (self.tips[1] - self.tips[0]) * t, axis }
    }

    fn new(chain: &'a Chain, at: At, kind: MoveKind, ends: [RotaryPose; 2]) -> Self {
        let (tips, rotary) = (ends.map(|e| e.tip), ends.map(|e| e.rotary));
        let [first, last] = rotary.map(|angles| chain.tool_axis(angles));
        let mut piece = Self {
            chain,
            at,
            kind,
            tips,
            rotary,
            curve: [first; 3],
            middle: Pose { tip: tips[0], axis: Vector3::z() },
            half: HalfMotion { way: 0.5 * (tips[1] - tips[0]).norm(), turn: 0.5 * chain.turn(rotary[0], rotary[1]) },
            order: 0,
        };
        piece.middle = piece.pose(0.5);
        let middle = piece.middle.axis;
        piece.curve = [first, middle * 4.0 - first * 3.0 - last, (first + last) * 2.0 - middle * 4.0];
        piece
    }

    /// Pose at a share of the piece. The axis is the parabola
    /// through its ends and its middle, for pieces of at most [`MAX_PIECE_TURN`]; it deviates from the true curve by at
    /// most [`Self::parabola_error`].
    pub(crate) fn quick_pose(&self, t: f64) -> QuickPose {
        let [start, slope, second] = &self.curve;
        let axis = start + (slope + second * t) * t;
        let change = slope + second * (2.0 * t);
        QuickPose { tip: self.tips[0] + (self.tips[1] - self.tips[0]) * t, axis, change }
    }

    /// Upper bound of the distance between the parabola and the true axis: the largest |t (t - 1/2) (t - 1)| / 6 times
    /// the third derivative.
    fn parabola_error(&self) -> f64 {
        let turn = 2.0 * self.half.turn;
        0.0081 * self.chain.turning().third * turn * turn * turn
    }

    /// The same for the derivative of the axis by the share: at most a twelfth of the third derivative.
    fn parabola_slope_error(&self) -> f64 {
        let turn = 2.0 * self.half.turn;
        self.chain.turning().third / 12.0 * turn * turn * turn
    }

    /// Bound of the second derivative of the path of the touched point, and of all points within a radius of it, over
    /// the piece.
    pub fn drift(&self, touch: &Touch, radius: f64) -> Drift {
        let (way, turn) = (2.0 * self.half.way, 2.0 * self.half.turn);
        // Largest distance of these points from the tip.
        let arm = touch.arm() + way + radius;
        let second = self.chain.turning().second * turn * turn * arm + 2.0 * turn * way;
        Drift { second, turn, flaw: self.parabola_error() * arm, slope_flaw: self.parabola_slope_error() * arm, radius }
    }

    /// Centre of a tip ball of a given radius.
    pub fn ball_centre(&self, t: f64, radius: f64) -> Point3<f64> {
        let QuickPose { tip, axis, .. } = self.quick_pose(t);
        tip + axis * radius
    }

    /// Derivative of this centre by the share.
    pub fn ball_speed(&self, t: f64, radius: f64) -> Vector3<f64> {
        self.tips[1] - self.tips[0] + self.quick_pose(t).change * radius
    }

    /// Bound of the second derivative of the path of this centre over the piece; turning about its centre does not move
    /// a ball.
    pub fn ball_drift(&self, radius: f64) -> Drift {
        let turn = 2.0 * self.half.turn;
        let (flaw, slope_flaw) = (self.parabola_error() * radius, self.parabola_slope_error() * radius);
        Drift { second: self.chain.turning().second * turn * turn * radius, turn: 0.0, flaw, slope_flaw, radius: 0.0 }
    }

    /// How a tangent at a touch moves with the share, see [`TangentTwist`]; valid for points within a radius.
    pub(crate) fn twist(&self, touch: &Touch, radius: f64) -> TangentTwist {
        let (way, turn) = (2.0 * self.half.way, 2.0 * self.half.turn);
        let QuickPose { axis, change, .. } = self.quick_pose(touch.t);
        let arm = touch.arm() + way + radius;
        TangentTwist {
            change: change * axis.dot(&touch.gradient) - axis * change.dot(&touch.gradient),
            second: self.chain.turning().shortest * turn * turn * arm + 2.0 * turn * way,
            // Once in the derivative of the axis, and twice in that of the gradient.
            slope_flaw: 3.0 * self.parabola_slope_error() * arm,
            flaw: self.parabola_error() * arm,
        }
    }

    /// Derivatives by the share, at the middle.
    pub(crate) fn speed(&self) -> PoseSpeed {
        PoseSpeed { tip: self.tips[1] - self.tips[0], axis: self.curve[1] + self.curve[2] }
    }

    /// The two halves.
    pub fn halves(&self) -> [Self; 2] {
        let [from, to] = [0, 1].map(|k| RotaryPose { tip: self.tips[k], rotary: self.rotary[k] });
        let rotary = [0, 1].map(|k| 0.5 * (from.rotary[k] + to.rotary[k]));
        let middle = RotaryPose { tip: self.middle.tip, rotary };
        [[from, middle], [middle, to]].map(|ends| Self::new(self.chain, self.at, self.kind, ends))
    }

    /// Turns of both rotary axes, radians.
    pub(crate) fn rotary_turns(&self) -> [f64; 2] {
        [0, 1].map(|k| (self.rotary[1][k] - self.rotary[0][k]).abs())
    }

    /// Half of its motion.
    pub(crate) fn half(&self) -> HalfMotion {
        self.half
    }

    /// Middle pose.
    pub fn middle(&self) -> &Pose {
        &self.middle
    }

    /// Upper bound of the distance of a tool point from its middle position; `arm` is its distance from the tip.
    pub fn displacement(&self, arm: f64) -> f64 {
        self.half.way + self.half.turn * arm
    }
}

/// Pieces of the moves of an operation, in order.
pub fn pieces<'a>(machine: &'a Machine, motion: &Motion, operation: usize) -> Vec<Piece<'a>> {
    let mut pieces = Vec::new();
    each_move(machine, motion, operation, |at, kind, ends| divide(&machine.chain, at, kind, ends, &mut pieces));
    pieces
}

/// Calls a function with the place, the kind and the ends of each move of an operation, in order.
pub(crate) fn each_move(
    machine: &Machine,
    motion: &Motion,
    operation: usize,
    mut act: impl FnMut(At, MoveKind, [RotaryPose; 2]),
) {
    let Some(moves) = motion.operations.get(operation).map(|o| &o.moves) else { return };
    for (i, pair) in moves.windows(2).enumerate() {
        let at = At {
            operation: u32::try_from(operation).unwrap_or(u32::MAX),
            index: u32::try_from(i + 1).unwrap_or(u32::MAX),
        };
        let pose = |joints: &Joints| RotaryPose { tip: machine.forward(joints).tip, rotary: joints.rotary };
        act(at, pair[1].kind, [pose(&pair[0].joints), pose(&pair[1].joints)]);
    }
}

/// Number of pieces of a move.
pub(crate) fn piece_count(chain: &Chain, [from, to]: &[RotaryPose; 2]) -> f64 {
    // At a sharper angle of the rotary axes the same turn curves the path of the tool axis more; more pieces keep the
    // error.
    let sharper = libm::cbrt(chain.turning().third / Turning::RIGHT_ANGLE.third);
    let turns = chain.turn(from.rotary, to.rotary) / MAX_PIECE_TURN * sharper;
    part_count(turns.max((to.tip - from.tip).norm() / MAX_PIECE_LENGTH))
}

/// Number of parts of a move that is so many times as long as the longest part.
pub(crate) fn part_count(lengths: f64) -> f64 {
    (lengths - COUNT_ROUNDING).ceil().max(1.0)
}

/// Divides a move into pieces.
pub(crate) fn divide<'a>(chain: &'a Chain, at: At, kind: MoveKind, ends: [RotaryPose; 2], pieces: &mut Vec<Piece<'a>>) {
    let count = piece_count(chain, &ends);
    let [from, to] = ends;
    for k in 0..count as usize {
        let (t0, t1) = (k as f64 / count, (k + 1) as f64 / count);
        pieces.push(Piece::new(chain, at, kind, [from.towards(&to, t0), from.towards(&to, t1)]));
    }
}

/// A cutter against a point at one time.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// Share of the piece.
    pub t: f64,
    /// Signed distance, mm.
    pub value: f64,
    /// Derivative by the point, part frame.
    pub gradient: Vector3<f64>,
    /// Derivative by the share.
    pub rate: f64,
    /// Distance of the point from the tool axis.
    pub rho: f64,
    /// Height of the point over the tip.
    pub s: f64,
}

impl Touch {
    /// No touch.
    pub const FAR: Self =
        Self { t: 0.0, value: f64::INFINITY, gradient: Vector3::new(0.0, 0.0, 0.0), rate: 0.0, rho: 0.0, s: 0.0 };

    /// Distance of the point from the tip.
    pub fn arm(&self) -> f64 {
        (self.rho * self.rho + self.s * self.s).sqrt()
    }
}

/// How a tangent plane of the cutter moves over a piece.
///
/// Let R(t) be the shortest rotation of the axis at the touch into the axis at t, at any time, and n the gradient at
/// the touch. The cutter is a convex body about its axis, so that f(p, t) >= f* + (R n) . (p - tip) - n . (p* - tip*).
/// Up to half its second derivative, the right side is n . (p - p*) + (t - t*) (rate + change . (p - p*)), with change
/// = w x n and w = a x a' for the axis a. (R n)'' is at most |w'| + |w|^2. For rotary axes at a right angle |w'|^2 = K
/// (Q + 4 P) and |w|^2 = P + Q. Here P is the square of the turn of axis 1, Q that of the turn of axis 2 across the
/// tool, and K that of its turn along the tool. The sum is at most (1 + sqrt 5) / 2 (P + Q + K). For other angles
/// [`Turning`] has a wider bound.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TangentTwist {
    /// Derivative of the gradient by the share.
    pub(crate) change: Vector3<f64>,
    /// Upper bound of the second derivative by the share, mm.
    pub(crate) second: f64,
    /// Error of the slope of the quick poses, mm per share.
    pub(crate) slope_flaw: f64,
    /// Error of the quick poses, mm.
    pub(crate) flaw: f64,
}

/// How far the path of a point, in the frame of the tool, may deviate from a straight line within a piece.
#[derive(Clone, Copy, Debug)]
pub struct Drift {
    /// Upper bound of the second derivative by the share, mm.
    pub second: f64,
    /// Turn over the whole piece, radians.
    pub turn: f64,
    /// Error of the quick poses, mm.
    pub flaw: f64,
    /// Error of the slopes of the quick poses, mm per share.
    pub slope_flaw: f64,
    /// Distance of the farthest queried point from the touched point, mm.
    pub radius: f64,
}

impl Drift {
    /// Loss of the tangent in the share at a touch, between two shares, mm.
    pub fn loss(&self, touch: &Touch, (from, to): (f64, f64)) -> f64 {
        let (before, after) = (touch.t - from, to - touch.t);
        let down = (touch.rate * before).max(-touch.rate * after).max(0.0);
        let h = before.max(after);
        down + 0.5 * self.second * h * h + (self.turn * self.radius + self.slope_flaw) * h + self.flaw
    }
}

/// Intervals of shares that are still to be searched; halving an interval needs at most one more place.
pub struct Spans {
    open: [(f64, f64); Self::MAX_OPEN],
    count: usize,
}

impl Spans {
    const MAX_OPEN: usize = 24;

    /// The whole piece.
    pub fn whole() -> Self {
        Self { open: [(0.0, 1.0); Self::MAX_OPEN], count: 1 }
    }

    /// The next interval.
    pub fn pop(&mut self) -> Option<(f64, f64)> {
        self.count = self.count.checked_sub(1)?;
        Some(self.open[self.count])
    }

    /// Adds both halves of an interval. False when the intervals have become too short.
    pub fn halve(&mut self, (from, to): (f64, f64)) -> bool {
        if self.count + 2 > Self::MAX_OPEN {
            return false;
        }
        let middle = 0.5 * (from + to);
        self.open[self.count] = (middle, to);
        self.open[self.count + 1] = (from, middle);
        self.count += 2;
        true
    }
}
