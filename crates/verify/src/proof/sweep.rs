//! The cutters of a whole program, swept over continuous time, with proved lower bounds.
//!
//! Poses come from the joints by forward kinematics alone. Between moves the tip runs straight in the part frame and
//! the rotary axes run linearly.
//!
//! In the frame of the tool, a fixed point p runs on a path q(t) with derivatives q' and q''. The signed distance f to
//! a convex cutter is convex, so that the tangent at any time s bounds it: f(q(t)) >= f(q(s)) + (t - s) df/dt(s) - 1/2
//! (t - s)^2 max|q''|. With the turn w of a piece and the motion v of its tip, |q''| <= k w^2 |q| + 2 w v, where k
//! follows from the angle between the rotary axes (`Turning` of the kinematics: 3/2 at a right angle). The first term
//! vanishes at a minimum; halving makes the last term small. The number of minima does not matter.

use super::capsule::{Ball, Capsule};
use super::hierarchy::Hierarchy;
use super::piece::{At, Piece, QuickPose, Spans, Touch, divide, pieces};
use super::turns::{PartnerRounding, TurnClasses};
use five_axis::{Chain, RotaryPose};
use ir::{Motion, MoveKind, Program};
use nalgebra::Point3;
use rayon::prelude::*;
use std::sync::Arc;
use tool_stock::collide::{Slope, ToolSolid};

/// Distance from the tool axis at which a point counts as on it, mm.
pub(super) const MIN_AXIS_DISTANCE: f64 = 1e-12;

/// Share of a piece at which the search for the nearest time ends.
const TIME_RESOLUTION: f64 = 1e-9;

/// Allowed error of the search for the nearest time through the turn of a piece, mm; pieces are halved until they meet
/// it.
pub(crate) const TURN_SLACK: f64 = 2e-5;

/// Slope, in mm over a piece, below which the distance counts as constant.
const MIN_SLOPE: f64 = 1e-6;

/// Largest number of iterations of the search for a minimum; bisection alone would need 30.
const MAX_MINIMUM_STEPS: usize = 60;

/// The cutter of one tool over all pieces of one operation. A clone shares the pieces.
#[derive(Clone, Debug)]
pub struct Sweep<'a> {
    solid: &'a ToolSolid,
    pieces: Arc<[Piece<'a>]>,
    /// Index of each piece in the order of time.
    in_order: Arc<[u32]>,
    /// Hierarchy over the pieces.
    pub(crate) hierarchy: Arc<Hierarchy>,
    ball: Option<Ball>,
    /// The ball over each piece; empty without a ball.
    capsules: Arc<[Capsule]>,
    /// Which pieces are each other, turned; none for a sweep that is to be judged in each sector by itself.
    turns: Option<Arc<TurnClasses>>,
}

/// Least signed distance of a point to a swept cutter.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// Signed distance, negative inside.
    pub distance: f64,
    /// Place in the program.
    pub at: At,
}

impl<'a> Sweep<'a> {
    /// The cutter of an operation over its pieces.
    pub fn new(program: &'a Program, motion: &Motion, operation: usize) -> Option<Self> {
        Self::rounded(program, motion, operation, PartnerRounding::ARITHMETIC)
    }

    /// The same, where sectors are the same, turned, up to a rounding.
    pub fn rounded(program: &'a Program, motion: &Motion, operation: usize, rounding: PartnerRounding) -> Option<Self> {
        let id = motion.operations.get(operation)?.operation;
        let solid = &program.tools[program.operations[id].tool].solid;
        let pieces = pieces(&program.machine, motion, operation);
        let turns: Vec<_> = (0..program.part.vane_count).map(|k| program.part.sector_rotation(k)).collect();
        let classes = TurnClasses::of(&pieces, &turns, rounding);
        Some(Self { turns: Some(Arc::new(classes)), ..Self::over(solid, pieces)? })
    }

    /// The same, to be judged in each sector by itself.
    pub fn in_each_sector(self) -> Self {
        Self { turns: None, ..self }
    }

    /// A cutter that passes poses in turn; each move counts as a move of operation 0.
    pub fn through(solid: &'a ToolSolid, chain: &'a Chain, poses: &[RotaryPose]) -> Option<Self> {
        let mut pieces = Vec::new();
        for (i, pair) in poses.windows(2).enumerate() {
            let at = At { operation: 0, index: u32::try_from(i + 1).unwrap_or(u32::MAX) };
            divide(chain, at, MoveKind::Cut, [pair[0], pair[1]], &mut pieces);
        }
        Self::over(solid, pieces)
    }

    /// Number of the sectors whose pieces are known to be partners or not.
    pub(crate) fn sectors(&self) -> Option<u32> {
        self.turns.as_ref().map(|classes| classes.vanes())
    }

    /// The pieces without a partner turned by a number of pitches, in the order of time; `None` where no partners are known.
    pub(crate) fn without_partner(&self, pitches: u32) -> Option<Vec<Piece<'a>>> {
        let alone = self.turns.as_ref()?.without_partner(pitches);
        Some(alone.map(|order| self.pieces[self.in_order[order as usize] as usize]).collect())
    }

    /// The same cutter over other pieces, in the order of time; `None` without a piece.
    pub(crate) fn of_pieces(&self, pieces: Vec<Piece<'a>>) -> Option<Self> {
        Self::over(self.solid, pieces)
    }

    /// Number of pieces.
    pub(crate) fn len(&self) -> usize {
        self.pieces.len()
    }

    /// Upper bound of the distance between the tools of partners at any time, mm.
    pub(crate) fn partner_error(&self) -> f64 {
        self.turns.as_ref().map_or(0.0, |classes| classes.error(self.solid.arm()))
    }

    /// The same over all partners of several sweeps.
    pub(crate) fn largest_partner_error(sweeps: &[Self]) -> f64 {
        sweeps.iter().map(Self::partner_error).fold(0.0, f64::max)
    }

    /// The move of the partner of a move, turned by a number of pitches.
    pub(crate) fn partner_at(&self, at: At, pitches: u32) -> Option<At> {
        let order = self.in_order.partition_point(|index| self.pieces[*index as usize].at.index < at.index);
        let index = *self.in_order.get(order)?;
        let partner = self.turns.as_ref()?.partner(self.pieces[index as usize].order, pitches)?;
        Some(self.pieces[*self.in_order.get(partner as usize)? as usize].at)
    }

    /// The operation of the sweep in the motion.
    pub(crate) fn operation(&self) -> Option<u32> {
        self.pieces.first().map(|piece| piece.at.operation)
    }

    /// The pieces in the order of time.
    pub(crate) fn in_time(&self) -> impl Iterator<Item = &Piece<'a>> {
        self.in_order.iter().map(|index| &self.pieces[*index as usize])
    }

    /// Of pieces that are each other, turned, the first one each, in the order of time. What holds for them holds for all,
    /// less [`Self::partner_error`].
    pub(crate) fn first_pieces(&self) -> Vec<Piece<'a>> {
        let first = |piece: &&Piece<'a>| self.turns.as_ref().is_none_or(|classes| classes.is_first(piece.order));
        self.in_time().filter(first).copied().collect()
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
        let (in_order, hierarchy) = (in_order.into(), Arc::new(hierarchy));
        Some(Self { solid, pieces, in_order, hierarchy, ball, capsules, turns: None })
    }

    /// The cutter against a point at a share of a piece.
    pub(crate) fn touch(&self, piece: &Piece, t: f64, p: &Point3<f64>) -> Touch {
        let QuickPose { tip, axis, change } = piece.quick_pose(t);
        let d = p - tip;
        let s = d.dot(&axis);
        let radial = d - axis * s;
        let rho = radial.norm();
        let Slope { value, rho: out, s: up } = self.solid.cutter_slope(rho, s);
        // On the axis any radial direction is valid; the slope across the axis is zero there by symmetry.
        let gradient = if rho > MIN_AXIS_DISTANCE { radial * (out / rho) + axis * up } else { axis * up };
        let travel = piece.tips[1] - piece.tips[0];
        let ds = d.dot(&change) - travel.dot(&axis);
        let drho = if rho > MIN_AXIS_DISTANCE { -(radial.dot(&travel) + s * radial.dot(&change)) / rho } else { 0.0 };
        Touch { t, value, gradient, rate: out * drho + up * ds, rho, s }
    }

    /// The touch nearest to a point over a piece, if nearer than `least`. The true distance is less by at most `slack`.
    pub fn least(&self, index: u32, p: &Point3<f64>, mut least: f64, slack: f64) -> Option<Touch> {
        let piece = &self.pieces[index as usize];
        if let Some((ball, capsule)) = self.capsule(index) {
            let foot = capsule.foot(p);
            let below = foot.length - ball.radius - capsule.flaw();
            // One of the two conditions nearly always decides both: the more expensive one comes last.
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

    /// The least distance between two shares, if there is one minimum between them: a root of its rate by secants
    /// between brackets that never grow.
    pub(crate) fn minimum(&self, piece: &Piece, start: Touch, p: &Point3<f64>, (from, to): (f64, f64)) -> Touch {
        if start.rate.abs() <= MIN_SLOPE {
            return start;
        }
        let falls = start.rate < 0.0;
        let end = self.touch(piece, if falls { to } else { from }, p);
        if (end.rate < 0.0) == falls || end.rate.abs() <= MIN_SLOPE {
            return end;
        }
        // Rates at the brackets: negative at the low end, positive at the high end.
        let (mut low, mut high) = if falls { (start, end) } else { (end, start) };
        let (mut weight_low, mut weight_high) = (low.rate, high.rate);
        let mut last_low = None;
        for _ in 0..MAX_MINIMUM_STEPS {
            let t = (low.t * weight_high - high.t * weight_low) / (weight_high - weight_low);
            let t = if t > low.t && t < high.t { t } else { 0.5 * (low.t + high.t) };
            let next = self.touch(piece, t, p);
            if next.rate.abs() <= MIN_SLOPE || high.t - low.t < TIME_RESOLUTION {
                return next;
            }
            // Halving the weight of an end that does not move keeps the secants from stalling (Illinois).
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

    /// The tip ball over a piece; `index` is the index of the piece in this sweep.
    pub(crate) fn capsule(&self, index: u32) -> Option<(Ball, &Capsule)> {
        Some((self.ball?, &self.capsules[index as usize]))
    }

    /// The tip ball.
    pub(crate) fn ball(&self) -> Option<Ball> {
        self.ball
    }

    /// A piece by its index in this sweep.
    pub fn piece(&self, index: u32) -> &Piece<'a> {
        &self.pieces[index as usize]
    }

    /// The next piece in time.
    pub fn after(&self, index: u32) -> Option<u32> {
        self.in_order.get(self.pieces[index as usize].order as usize + 1).copied()
    }

    /// The previous piece in time.
    pub fn before(&self, index: u32) -> Option<u32> {
        self.in_order.get((self.pieces[index as usize].order as usize).checked_sub(1)?).copied()
    }

    /// Move that a piece belongs to.
    pub fn at(&self, piece: u32) -> At {
        self.pieces[piece as usize].at
    }

    /// The tool.
    pub fn solid(&self) -> &ToolSolid {
        self.solid
    }
}
