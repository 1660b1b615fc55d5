//! Which steps of a run may reach the material of a group of rays: a query about all of its steps at once.
//!
//! At the middle of a step the tangent plane of the body bounds its function from below: over the time of the step as in
//! [`super::lanes`], and across the rays of the group since the function changes no faster than the place.

use super::lanes::{LANES, Lane, Standing, fall, larger, least, smaller};
use super::moving::Moving;
use super::shape::{Round, SolidShape};
use super::sweep::{RayLine, StepPose, StepQuery};

/// Distance from which a body is away, mm: more than the searches in time and along a ray may be off, so that no search would
/// find a chip.
const AWAY: f64 = 1.2e-3;

/// Half the time of a step.
const HALF: f64 = 0.5;

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

/// True when a plane that turns by `turn` stays away over the half times of a step.
#[inline(always)]
fn away(plane: &StepQuery, twist: f64, turn: f64, lateral: f64, x: f64, part: [f64; 2]) -> bool {
    let over_time = smaller(least(plane, -HALF, 0.0, twist), least(plane, HALF, 0.0, twist));
    let across = larger(1.0 - plane.rise * plane.rise, 0.0).sqrt() + turn;
    over_time - lateral * across > fall(plane, turn, x, part) + AWAY
}

impl ReachQuestion<'_> {
    #[inline(always)]
    fn answers(&self, body: &impl Standing) -> [bool; LANES] {
        let Self { steps, line, lateral, within } = self;
        let mut reached = [0_u64; LANES];
        for (i, reached) in reached.iter_mut().enumerate() {
            let pose = StepPose::from_numbers(|k| steps.pose[k][i], HALF);
            let (a, b) = (larger(within[0], steps.low[i]), smaller(within[1], steps.high[i]));
            let hit = body.stand(&pose, line, [a, b], steps.speed[i] * HALF + lateral);
            let x = larger(smaller(hit.nearest, hit.to), hit.from);
            let query = pose.query(body, line, x);
            let turn = steps.turn[i] * HALF;
            let level = body.level(&pose, line, x, &query);
            let (twist, part) = (steps.twist[i], [hit.from, hit.to]);
            let far = away(&query, twist, turn, *lateral, x, part) | away(&level, twist, turn, *lateral, x, part);
            let missed = (a >= b) | (hit.from >= hit.to) | far;
            *reached = if missed { 0 } else { 1 };
        }
        reached.map(|r| r != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::sweep::StepSweep;
    use super::*;
    use nalgebra::Vector3;

    /// Against places and times all over the material and the steps that are said to miss it.
    #[test]
    fn steps_that_miss_stay_away() {
        let axis = |a: f64| Vector3::new(a.sin() * 0.6, 0.8 * a.sin(), a.cos());
        let tip = |k: f64| Vector3::new(1.0 + 0.7 * k, 2.0 + 0.1 * k * k, -1.0 - 0.1 * k);
        let sweep =
            |k: f64| StepSweep::through([tip(k), tip(k + 1.0)], [0.0, 0.5, 1.0].map(|h| axis(0.4 + 0.03 * (k + h))));
        let share = |n: u32| [0.0, 0.25, 0.5, 0.75, 1.0].map(|h| h * f64::from(n));
        let (half, mut missed, mut met) = (0.15, 0, 0);
        for shape in [SolidShape::Flat { radius: 3.0, top: 20.0 }, SolidShape::Ball { radius: 3.0, top: 20.0 }] {
            let steps: Vec<Moving> = (0..3).map(|k| Moving::new(sweep(f64::from(k)), shape, 0.0)).collect();
            let lanes = StepLanes::new(&steps).unwrap();
            for k in 0..600 {
                let at = |f: f64| (f64::from(k) * f).sin();
                let line = RayLine { x: 2.2 + 5.0 * at(0.7), y: 2.5 + 5.0 * at(1.3) };
                let from = 8.0 * at(1.9) - 4.0;
                let within = [from, from + 1.0 + at(0.3)];
                let lateral = half * std::f64::consts::SQRT_2;
                let ask =
                    |arch: pulp::Arch| arch.dispatch(ReachQuestion { steps: &lanes, line: &line, lateral, within });
                let reached = ask(pulp::Arch::new());
                assert_eq!(reached, ask(pulp::Arch::Scalar));
                for (step, reached) in steps.iter().zip(reached) {
                    if reached {
                        met += 1;
                        continue;
                    }
                    missed += 1;
                    let places = share(1).into_iter().flat_map(|t| share(1).map(|z| (t, z)));
                    for (t, z) in places {
                        let (pose, z) = (step.sweep.stand(t), within[0] + (within[1] - within[0]) * z);
                        for (dx, dy) in [(-half, -half), (-half, half), (half, -half), (half, half), (0.0, 0.0)] {
                            let near = RayLine { x: line.x + dx, y: line.y + dy };
                            assert!(pose.query(&shape, &near, z).f > 0.9 * AWAY, "{shape:?} {k} {t} {z}");
                        }
                    }
                }
            }
        }
        assert!(missed > 500 && met > 300, "{missed} {met}");
    }
}
