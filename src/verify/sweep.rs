//! The cutters of a whole program, swept over continuous time, with lower bounds that are proved.
//!
//! Poses come from the joints by forward kinematics alone. Between moves the tip runs straight in the part frame and
//! the rotary axes run linearly.
//!
//! Seen from the tool, a fixed point p runs on a path q(t) with q' and q''. The signed distance f to a convex cutter is
//! convex, so at any time s the tangent bounds it: f(q(t)) >= f(q(s)) + (t - s) df/dt(s) - 1/2 (t - s)^2 max|q''|. With
//! the turn w of a piece and the way v of its tip, |q''| <= k w^2 |q| + 2 w v, where k follows from the angle between the
//! rotary axes ([`Turning`]: 3/2 where they stand at a right angle). The first term vanishes
//! at a minimum, the last is made small by halving. No assumption about the number of minima is needed.

use super::capsule::{Ball, Capsule};
use super::hierarchy::Hierarchy;
use crate::collide::{Slope, ToolSolid};
use crate::ir::{Motion, MoveKind, Program};
use crate::kin::chain::Turning;
use crate::kin::{Angles, Chain, Joints, Machine, RotaryPose, between};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Largest turn of a piece where the rotary axes stand at a right angle.
const PIECE_TURN: f64 = std::f64::consts::PI / 180.0;

/// Longest way of the tip in a piece, mm: long links would lie in one node with everything that they pass.
pub(super) const PIECE_LENGTH: f64 = 3.0;

/// What the search for the nearest time may miss through the turn of a piece, mm; pieces are halved down to it.
pub(super) const TURN_SLACK: f64 = 2e-5;

/// Slope over time, in mm over a piece, that counts as none.
const FLAT: f64 = 1e-6;

/// Steps of the search for a minimum: bisection alone would need 30.
const STEPS: usize = 60;

/// Where in the program something happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct At {
    /// Index of the operation in the motion.
    pub operation: u32,
    /// Index of the move that ends the piece.
    pub index: u32,
}

/// A part of one move.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'a> {
    chain: &'a Chain,
    /// Move that it belongs to.
    pub at: At,
    /// Kind of that move.
    pub kind: MoveKind,
    tips: [Point3<f64>; 2],
    rotary: [Angles; 2],
    /// Middle pose.
    middle: (Point3<f64>, Vector3<f64>),
    /// Parabola through the axis at both ends and in the middle: value, and factors of the share and of its square.
    curve: [Vector3<f64>; 3],
    /// Half of the tip's way, and half of the turn, radians.
    reach: (f64, f64),
    /// Place among the pieces of the operation in the order of time.
    order: u32,
}

impl<'a> Piece<'a> {
    /// Tip and axis at a share of the piece.
    pub fn pose(&self, t: f64) -> (Point3<f64>, Vector3<f64>) {
        let axis = self.chain.tool_axis(between(self.rotary[0], self.rotary[1], t));
        (self.tips[0] + (self.tips[1] - self.tips[0]) * t, axis)
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
            middle: (tips[0], Vector3::z()),
            reach: (0.0, 0.0),
            order: 0,
        };
        piece.middle = piece.pose(0.5);
        let middle = piece.middle.1;
        piece.curve = [first, middle * 4.0 - first * 3.0 - last, (first + last) * 2.0 - middle * 4.0];
        piece.reach = (0.5 * (tips[1] - tips[0]).norm(), 0.5 * chain.turn(rotary[0], rotary[1]));
        piece
    }

    /// Tip and axis at a share of the piece, and the change of the axis over the share. For pieces of at most
    /// [`PIECE_TURN`]: the axis as the parabola through its ends and its middle, which leaves the true curve by at most
    /// [`Self::parabola_error`].
    fn quick_pose(&self, t: f64) -> (Point3<f64>, Vector3<f64>, Vector3<f64>) {
        let [start, slope, bend] = &self.curve;
        let axis = start + (slope + bend * t) * t;
        let change = slope + bend * (2.0 * t);
        (self.tips[0] + (self.tips[1] - self.tips[0]) * t, axis, change)
    }

    /// Tip and axis of [`Self::quick_pose`].
    pub(super) fn quick_axis(&self, t: f64) -> (Point3<f64>, Vector3<f64>) {
        let (tip, axis, _) = self.quick_pose(t);
        (tip, axis)
    }

    /// Bound of the distance between the parabola of the axis and the axis: the largest |t (t - 1/2) (t - 1)| / 6 times
    /// the third derivative.
    fn parabola_error(&self) -> f64 {
        let turn = 2.0 * self.reach.1;
        0.0081 * self.chain.turning().third * turn * turn * turn
    }

    /// The same for the change of the axis over the share: at most a twelfth of the third derivative.
    fn parabola_slope_error(&self) -> f64 {
        let turn = 2.0 * self.reach.1;
        self.chain.turning().third / 12.0 * turn * turn * turn
    }

    /// How the way of the touched point, and of all within a radius about it, may bend over the piece.
    pub fn drift(&self, touch: &Touch, radius: f64) -> Drift {
        let (way, turn) = (2.0 * self.reach.0, 2.0 * self.reach.1);
        // Farthest that any of the points gets from the tip.
        let arm = touch.arm() + way + radius;
        let bend = self.chain.turning().second * turn * turn * arm + 2.0 * turn * way;
        Drift { bend, turn, flaw: self.parabola_error() * arm, slope_flaw: self.parabola_slope_error() * arm, radius }
    }

    /// Centre of a ball of a radius at the tip, and its change over the share.
    pub fn ball_centre(&self, t: f64, radius: f64) -> (Point3<f64>, Vector3<f64>) {
        let (tip, axis, change) = self.quick_pose(t);
        (tip + axis * radius, self.tips[1] - self.tips[0] + change * radius)
    }

    /// How the way of that centre may bend over the piece; turning does not move a ball about it.
    pub fn ball_drift(&self, radius: f64) -> Drift {
        let turn = 2.0 * self.reach.1;
        let (flaw, slope_flaw) = (self.parabola_error() * radius, self.parabola_slope_error() * radius);
        Drift { bend: self.chain.turning().second * turn * turn * radius, turn: 0.0, flaw, slope_flaw, radius: 0.0 }
    }

    /// How a tangent at a touch moves with the share, see [`Twist`]; it is to hold for points within a radius.
    pub(super) fn twist(&self, touch: &Touch, radius: f64) -> Twist {
        let (way, turn) = (2.0 * self.reach.0, 2.0 * self.reach.1);
        let (_, axis, change) = self.quick_pose(touch.t);
        let arm = touch.arm() + way + radius;
        Twist {
            change: change * axis.dot(&touch.gradient) - axis * change.dot(&touch.gradient),
            bend: self.chain.turning().shortest * turn * turn * arm + 2.0 * turn * way,
            // In the change of the axis, and twice in that of the gradient.
            slope_flaw: 3.0 * self.parabola_slope_error() * arm,
            flaw: self.parabola_error() * arm,
        }
    }

    /// Change of tip and axis over the share, at the middle.
    pub fn speed(&self) -> (Vector3<f64>, Vector3<f64>) {
        (self.tips[1] - self.tips[0], self.curve[1] + self.curve[2])
    }

    /// The two halves.
    pub fn halves(&self) -> [Self; 2] {
        let [from, to] = [0, 1].map(|k| RotaryPose { tip: self.tips[k], rotary: self.rotary[k] });
        let rotary = [0, 1].map(|k| 0.5 * (from.rotary[k] + to.rotary[k]));
        let middle = RotaryPose { tip: self.middle.0, rotary };
        [[from, middle], [middle, to]].map(|ends| Self::new(self.chain, self.at, self.kind, ends))
    }

    /// Half of the tip's way, and half of the turn, radians.
    pub(super) fn reach(&self) -> (f64, f64) {
        self.reach
    }

    /// Middle pose.
    pub fn middle(&self) -> &(Point3<f64>, Vector3<f64>) {
        &self.middle
    }

    /// Bound on how far a point of the tool at a distance from the tip moves from its middle position.
    pub fn displacement(&self, arm: f64) -> f64 {
        self.reach.0 + self.reach.1 * arm
    }
}

/// Pieces of the moves of an operation, in order.
pub fn pieces<'a>(machine: &'a Machine, motion: &Motion, operation: usize) -> Vec<Piece<'a>> {
    let mut pieces = Vec::new();
    each_move(machine, motion, operation, |at, kind, ends| divide(&machine.chain, at, kind, ends, &mut pieces));
    pieces
}

/// Calls a function with the place, the kind and the ends of each move of an operation, in order.
pub(super) fn each_move(
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
pub(super) fn piece_count(chain: &Chain, [from, to]: &[RotaryPose; 2]) -> f64 {
    // Where the axes stand at a sharper angle the tool axis bends more for the same turn: the error of a piece stays.
    let sharper = libm::cbrt(chain.turning().third / Turning::RIGHT_ANGLE.third);
    let turns = chain.turn(from.rotary, to.rotary) / PIECE_TURN * sharper;
    turns.max((to.tip - from.tip).norm() / PIECE_LENGTH).ceil().max(1.0)
}

/// Divides a move into pieces.
fn divide<'a>(chain: &'a Chain, at: At, kind: MoveKind, ends: [RotaryPose; 2], pieces: &mut Vec<Piece<'a>>) {
    let count = piece_count(chain, &ends);
    let [from, to] = ends;
    for k in 0..count as usize {
        let (t0, t1) = (k as f64 / count, (k + 1) as f64 / count);
        pieces.push(Piece::new(chain, at, kind, [from.towards(&to, t0), from.towards(&to, t1)]));
    }
}

/// The cutter of one tool over all pieces of one operation.
#[derive(Clone, Debug)]
pub struct Sweep<'a> {
    solid: &'a ToolSolid,
    pieces: Vec<Piece<'a>>,
    /// Index of each piece in the order of time.
    in_order: Vec<u32>,
    /// What lies where.
    pub(super) hierarchy: Hierarchy,
    ball: Option<Ball>,
    /// The ball over each piece; none without a ball.
    capsules: Vec<Capsule>,
}

/// Least signed distance of a point to a swept cutter.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// Signed distance, negative inside.
    pub distance: f64,
    /// Where in the program.
    pub at: At,
}

impl<'a> Sweep<'a> {
    /// The cutter of an operation over its pieces.
    pub fn new(program: &'a Program, motion: &Motion, operation: usize) -> Option<Self> {
        let id = motion.operations.get(operation)?.operation;
        let solid = &program.tools[program.operations[id].tool].solid;
        Self::over(solid, pieces(&program.machine, motion, operation))
    }

    /// A cutter that passes poses in turn; each move counts as one of operation 0.
    pub fn through(solid: &'a ToolSolid, chain: &'a Chain, poses: &[RotaryPose]) -> Option<Self> {
        let mut pieces = Vec::new();
        for (i, pair) in poses.windows(2).enumerate() {
            let at = At { operation: 0, index: u32::try_from(i + 1).unwrap_or(u32::MAX) };
            divide(chain, at, MoveKind::Cut, [pair[0], pair[1]], &mut pieces);
        }
        Self::over(solid, pieces)
    }

    /// Builds the hierarchy over pieces in the order of time.
    fn over(solid: &'a ToolSolid, mut pieces: Vec<Piece<'a>>) -> Option<Self> {
        if pieces.is_empty() {
            return None;
        }
        for (order, piece) in pieces.iter_mut().enumerate() {
            piece.order = u32::try_from(order).unwrap_or(u32::MAX);
        }
        let height = solid.cutter.tip_radius();
        let centres: Vec<Capsule> = pieces.par_iter().map(|p| Capsule::new(p, height)).collect();
        let (hierarchy, sorted) = Hierarchy::over(solid, &pieces, &centres);
        let mut in_order = vec![0; pieces.len()];
        for (index, order) in sorted.iter().enumerate() {
            in_order[*order as usize] = u32::try_from(index).unwrap_or(u32::MAX);
        }
        let ball = Ball::of(solid);
        let capsules = sorted.iter().filter(|_| ball.is_some()).map(|k| centres[*k as usize]).collect();
        let pieces = sorted.iter().map(|k| pieces[*k as usize]).collect();
        Some(Self { solid, pieces, in_order, hierarchy, ball, capsules })
    }

    /// The cutter against a point at a share of a piece.
    pub(super) fn touch(&self, piece: &Piece, t: f64, p: &Point3<f64>) -> Touch {
        let (tip, axis, turning) = piece.quick_pose(t);
        let d = p - tip;
        let s = d.dot(&axis);
        let radial = d - axis * s;
        let rho = radial.norm();
        let Slope { value, rho: out, s: up } = self.solid.cutter_slope(rho, s);
        // On the axis any radial direction will do; there the slope across is none by symmetry.
        let gradient = if rho > 1e-12 { radial * (out / rho) + axis * up } else { axis * up };
        let travel = piece.tips[1] - piece.tips[0];
        let ds = d.dot(&turning) - travel.dot(&axis);
        let drho = if rho > 1e-12 { -(radial.dot(&travel) + s * radial.dot(&turning)) / rho } else { 0.0 };
        Touch { t, value, gradient, rate: out * drho + up * ds, rho, s }
    }

    /// Where a point is nearest to the cutter over a piece, if nearer than `least`; nowhere is it nearer by `slack`.
    pub fn least(&self, index: u32, p: &Point3<f64>, mut least: f64, slack: f64) -> Option<Touch> {
        let piece = &self.pieces[index as usize];
        if let Some((ball, capsule)) = self.capsule(index) {
            let foot = capsule.foot(p);
            let below = foot.length - ball.radius - capsule.flaw();
            // Seldom does either decide when the other does not: the dearer question last.
            if (below >= least || 2.0 * capsule.flaw() <= slack) && capsule.rules(ball, p, 0.0) {
                let touch = (below < least).then(|| self.touch(piece, foot.t, p));
                return touch.filter(|touch| touch.value < least);
            }
        }
        let mut best = None;
        let mut spans = Spans::whole();
        while let Some((from, to)) = spans.pop() {
            let start = self.touch(piece, 0.5 * (from + to), p);
            let drift = piece.drift(&start, 0.0);
            if start.value - drift.loss(&start, (from, to)) >= least {
                continue;
            }
            let found = self.minimum(piece, start, p, (from, to));
            if found.value < least {
                (least, best) = (found.value, Some(found));
            }
            let loss = drift.loss(&found, (from, to));
            if loss > slack && found.value - loss < least {
                spans.halve((from, to));
            }
        }
        best
    }

    /// Where the distance is least between two shares, if it has one minimum there: a root of its rate by secants
    /// between brackets that never grow.
    pub(super) fn minimum(&self, piece: &Piece, start: Touch, p: &Point3<f64>, (from, to): (f64, f64)) -> Touch {
        if start.rate.abs() <= FLAT {
            return start;
        }
        let falls = start.rate < 0.0;
        let end = self.touch(piece, if falls { to } else { from }, p);
        if (end.rate < 0.0) == falls || end.rate.abs() <= FLAT {
            return end;
        }
        // Rates at the brackets: below zero at the low, above at the high.
        let (mut low, mut high) = if falls { (start, end) } else { (end, start) };
        let (mut weight_low, mut weight_high) = (low.rate, high.rate);
        let mut last_low = None;
        for _ in 0..STEPS {
            let t = (low.t * weight_high - high.t * weight_low) / (weight_high - weight_low);
            let t = if t > low.t && t < high.t { t } else { 0.5 * (low.t + high.t) };
            let next = self.touch(piece, t, p);
            if next.rate.abs() <= FLAT || high.t - low.t < 1e-9 {
                return next;
            }
            // Halving the weight of an end that stays keeps the secants from creeping (Illinois).
            if next.rate < 0.0 {
                (low, weight_low) = (next, next.rate);
                if last_low == Some(true) {
                    weight_high *= 0.5;
                }
                last_low = Some(true);
            } else {
                (high, weight_high) = (next, next.rate);
                if last_low == Some(false) {
                    weight_low *= 0.5;
                }
                last_low = Some(false);
            }
        }
        if low.value < high.value { low } else { high }
    }

    /// The ball at the tip, over a piece by its index here.
    pub(super) fn capsule(&self, index: u32) -> Option<(Ball, &Capsule)> {
        Some((self.ball?, &self.capsules[index as usize]))
    }

    /// The ball at the tip.
    pub(super) fn ball(&self) -> Option<Ball> {
        self.ball
    }

    /// A piece, by its index here.
    pub fn piece(&self, index: u32) -> &Piece<'a> {
        &self.pieces[index as usize]
    }

    /// The piece that follows another in time.
    pub fn after(&self, index: u32) -> Option<u32> {
        self.in_order.get(self.pieces[index as usize].order as usize + 1).copied()
    }

    /// The piece before another in time.
    pub fn before(&self, index: u32) -> Option<u32> {
        self.in_order.get((self.pieces[index as usize].order as usize).checked_sub(1)?).copied()
    }

    /// Move of a piece.
    pub fn at(&self, piece: u32) -> At {
        self.pieces[piece as usize].at
    }

    /// The tool.
    pub fn solid(&self) -> &ToolSolid {
        self.solid
    }
}

/// A cutter against a point at one time.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// Share of the piece.
    pub t: f64,
    /// Signed distance.
    pub value: f64,
    /// How it changes with the point, part frame.
    pub gradient: Vector3<f64>,
    /// How it changes with the share.
    pub rate: f64,
    /// Distance of the point from the tool axis.
    pub rho: f64,
    /// Height of the point over the tip.
    pub s: f64,
}

impl Touch {
    /// Nothing near.
    pub const FAR: Self =
        Self { t: 0.0, value: f64::INFINITY, gradient: Vector3::new(0.0, 0.0, 0.0), rate: 0.0, rho: 0.0, s: 0.0 };

    /// Distance of the point from the tip.
    pub fn arm(&self) -> f64 {
        (self.rho * self.rho + self.s * self.s).sqrt()
    }
}

/// How a tangent plane of the cutter moves over a piece.
///
/// Let R(t) turn the axis at the touch into that at t, the shortest way at any time, and n be the gradient there. The
/// cutter is a convex body about its axis, so that f(p, t) >= f* + (R n) . (p - tip) - n . (p* - tip*). The right side is
/// n . (p - p*) + (t - t*) (rate + change . (p - p*)) up to half its second derivative, with change = w x n and
/// w = a x a' for the axis a. (R n)'' is at most |w'| + |w|^2. For rotary axes at a right angle |w'|^2 = K (Q + 4 P) and
/// |w|^2 = P + Q, with the squares P of the turn of axis 1, Q of that of axis 2 across the tool and K of that along it: at most
/// (1 + sqrt 5) / 2 (P + Q + K). For others [`Turning`] has a wider bound.
#[derive(Clone, Copy, Debug)]
pub(super) struct Twist {
    /// Change of the gradient over the share.
    pub(super) change: Vector3<f64>,
    /// Bound of the second derivative over the share, mm.
    pub(super) bend: f64,
    /// Error of the slope of the quick poses, mm over the share.
    pub(super) slope_flaw: f64,
    /// Error of the quick poses, mm.
    pub(super) flaw: f64,
}

/// How far the way of a point, seen from the tool, may leave a straight line within a piece.
#[derive(Clone, Copy, Debug)]
pub struct Drift {
    /// Bound of the second derivative over the share, mm.
    pub bend: f64,
    /// Turn over the whole piece, radians.
    pub turn: f64,
    /// Error of the quick poses, mm.
    pub flaw: f64,
    /// Error of their slopes, mm over the share.
    pub slope_flaw: f64,
    /// Distance of the farthest point that is asked about from the touched one, mm.
    pub radius: f64,
}

impl Drift {
    /// What the tangent in the share at a touch gives away between two shares, mm.
    pub fn loss(&self, touch: &Touch, (from, to): (f64, f64)) -> f64 {
        let (before, after) = (touch.t - from, to - touch.t);
        let down = (touch.rate * before).max(-touch.rate * after).max(0.0);
        let h = before.max(after);
        down + 0.5 * self.bend * h * h + (self.turn * self.radius + self.slope_flaw) * h + self.flaw
    }
}

/// Spans of shares that are still to be searched: halving one takes one more place at most.
pub struct Spans {
    open: [(f64, f64); Self::MOST],
    count: usize,
}

impl Spans {
    const MOST: usize = 24;

    /// The whole piece.
    pub fn whole() -> Self {
        Self { open: [(0.0, 1.0); Self::MOST], count: 1 }
    }

    /// The next span.
    pub fn pop(&mut self) -> Option<(f64, f64)> {
        self.count = self.count.checked_sub(1)?;
        Some(self.open[self.count])
    }

    /// Both halves of a span are still to be searched. False when spans have become too short.
    pub fn halve(&mut self, (from, to): (f64, f64)) -> bool {
        if self.count + 2 > Self::MOST {
            return false;
        }
        let middle = 0.5 * (from + to);
        self.open[self.count] = (middle, to);
        self.open[self.count + 1] = (from, middle);
        self.count += 2;
        true
    }
}
