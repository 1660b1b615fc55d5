//! Which steps of a run may reach the material of a group of rays: a query about all of its steps at once.
//!
//! At the middle of a step the tangent plane of the body bounds its function from below: over the time of the step as in
//! [`super::lanes`], and across the rays of the group since the function changes no faster than the place.

use super::lanes::{LANES, Lane, Standing, larger, smaller, least};
use super::moving::Moving;
use super::shape::{Round, SolidShape};
use super::sweep::{RayLine, StepPose};

/// Distance from which a body is away, mm: more than the searches in time and along a ray may be off, so that no search would
/// find a chip.
const AWAY: f64 = 1.2e-3;

/// The steps of a run at half time, as columns. Lanes beyond the last step repeat it.
pub(super) struct StepLanes {
    shape: SolidShape,
    pose: [Lane; StepPose::NUMBERS],
    speed: Lane,
    turn: Lane,
    twist: Lane,
    low: Lane,
    high: Lane,
}

impl StepLanes {
    /// `None` without steps.
    pub(super) fn new(steps: &[Moving]) -> Option<Self> {
        let last = steps.last()?;
        let at = |i: usize| steps.get(i).unwrap_or(last);
        let poses: [_; LANES] = std::array::from_fn(|i| at(i).sweep.stand(0.5).numbers());
        let column = |of: fn(&Moving) -> f64| std::array::from_fn(|i| of(at(i)));
        Some(Self {
            shape: last.shape,
            pose: std::array::from_fn(|k| poses.map(|p| p[k])),
            speed: column(|m| m.speed),
            turn: column(|m| m.turn),
            twist: column(|m| m.twist),
            low: column(|m| m.low[2]),
            high: column(|m| m.high[2]),
        })
    }
}

/// A query about material between two heights on all lines within `lateral` of a line.
pub(super) struct ReachQuestion<'a> {
    pub(super) steps: &'a StepLanes,
    pub(super) line: &'a RayLine,
    pub(super) lateral: f64,
    pub(super) within: [f64; 2],
}

/// Whether each step may reach the material.
impl pulp::WithSimd for ReachQuestion<'_> {
    type Output = [bool; LANES];

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> [bool; LANES] {
        match self.steps.shape {
            SolidShape::Flat { radius, top } => self.answers(&Round::<false> { radius, top }),
            SolidShape::Ball { radius, top } if top > 2.0 * radius => self.answers(&Round::<true> { radius, top }),
            shape => self.answers(&shape),
        }
    }
}

impl ReachQuestion<'_> {
    #[inline(always)]
    fn answers(&self, body: &impl Standing) -> [bool; LANES] {
        const HALF: f64 = 0.5;
        let Self { steps, line, lateral, within } = self;
        let mut reached = [0_u64; LANES];
        for (i, reached) in reached.iter_mut().enumerate() {
            let pose = StepPose::from_numbers(|k| steps.pose[k][i], HALF);
            let (a, b) = (larger(within[0], steps.low[i]), smaller(within[1], steps.high[i]));
            let hit = body.stand(&pose, line, [a, b], steps.speed[i] * HALF + lateral);
            let x = larger(smaller(hit.nearest, hit.to), hit.from);
            let query = pose.query(body, line, x);
            let turn = steps.turn[i] * HALF;
            let over_time = smaller(least(&query, -HALF, 0.0, steps.twist[i]), least(&query, HALF, 0.0, steps.twist[i]));
            let rising = larger(turn - query.rise, 0.0) * (hit.to - x);
            let falling = larger(turn + query.rise, 0.0) * (x - hit.from);
            let across = larger(1.0 - query.rise * query.rise, 0.0).sqrt() + turn;
            let away = over_time - lateral * across > larger(rising, falling) + AWAY;
            let missed = (a >= b) | (hit.from >= hit.to) | away;
            *reached = if missed { 0 } else { 1 };
        }
        reached.map(|r| r != 0)
    }
}
