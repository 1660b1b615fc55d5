//! A convex body of revolution over one step, or over a run of steps, with its bounds, against lines along Z.
//!
//! Times run from 0 to 1. Tangents with their second derivatives bound the function of the body from below over this
//! time, since the function of a turning body is not convex.

use super::shape::{Extent, SolidShape};
use super::sweep::{RayLine, SEARCH_GAP_MM, StepPose, StepSweep};
use nalgebra::Vector3;

/// Reserve for rounding of poses, mm.
const POSE_ROUNDING_MM: f64 = 1e-6;

/// Length below which a vector has no direction, mm.
const MIN_VECTOR_MM: f64 = 1e-12;

/// Slope of a line against the axis, squared, below which they are parallel.
const PARALLEL_SLOPE_SQUARED: f64 = 1e-9;

/// Cosine below which a line runs across the axis.
const ACROSS_AXIS_COSINE: f64 = 1e-6;

/// Newton steps along a ray. Each is a tangent step on a convex function, so that even a grazing ray converges in far
/// fewer steps.
pub(super) const MAX_NEWTON: u32 = 40;

/// A body in motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moving {
    pub(super) sweep: StepSweep,
    pub(super) shape: SolidShape,
    /// Speed at which the true motion may deviate from `sweep` from both of its ends on, mm per unit of time; 0 for a
    /// step.
    pub(super) drift: f64,
    /// Largest turning speed, radians per unit of time.
    pub(super) turn: f64,
    /// Largest speed of a point of the body.
    pub(super) speed: f64,
    /// [`StepSweep::bow`] and [`StepSweep::twist`] of the body.
    bow: f64,
    pub(super) twist: f64,
    /// Corners of a box around the whole sweep.
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    /// Poses with their speeds at both ends of the time.
    pub(super) ends: [StepPose; 2],
    /// Pose at half time.
    pub(super) tip: Vector3<f64>,
    pub(super) axis: Vector3<f64>,
    /// Cylinder about the middle pose that contains the whole sweep: heights and radius.
    from: f64,
    to: f64,
    radius: f64,
    /// Unit vector across tip motion and axis.
    pub(super) side: Vector3<f64>,
    /// For a step along the axis, towards the tip: the unit vector from which angles about the axis count.
    pub(super) around: Option<Vector3<f64>>,
}

/// A unit vector square to another.
pub(super) fn square_to(axis: &Vector3<f64>) -> Vector3<f64> {
    let mut unit = Vector3::zeros();
    unit[axis.iamin()] = 1.0;
    axis.cross(&unit).normalize()
}

impl Moving {
    pub(super) fn new(sweep: StepSweep, shape: SolidShape, drift: f64) -> Self {
        let Extent { from, to, radius } = shape.extent();
        let reach = shape.reach();
        let poses = [0.0, 0.5, 1.0].map(|t| sweep.pose(t));
        let [(_, start), (tip, axis), (_, end)] = poses;
        let (way, turn) = (sweep.way().norm(), sweep.turn());
        let (bow, twist) = (sweep.bow(reach + way), sweep.twist(reach + way));
        // Points run on arcs between the three poses.
        let sag = 0.125 * bow + 0.5 * drift + POSE_ROUNDING_MM;
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for (tip, axis) in poses {
            for k in 0..3 {
                let half_width = radius * (1.0 - axis[k] * axis[k]).max(0.0).sqrt() + sag;
                let (a, b) = (tip[k] + axis[k] * from, tip[k] + axis[k] * to);
                low[k] = low[k].min(a.min(b) - half_width);
                high[k] = high[k].max(a.max(b) + half_width);
            }
        }
        let moved = 0.5 * way + (start - axis).norm().max((end - axis).norm()) * reach + sag;
        let across = axis.cross(sweep.way());
        // For a plunge any direction across the axis is valid.
        let crosses = across.try_normalize(0.05 * way + MIN_VECTOR_MM);
        let side = crosses.unwrap_or_else(|| square_to(&axis));
        let plunges = crosses.is_none() && axis.dot(sweep.way()) < -MIN_VECTOR_MM;
        let around = plunges.then_some(side);
        let (from, to, radius) = (from - moved, to + moved, radius + moved);
        let speed = way + turn * reach + drift;
        let ends = [sweep.stand(0.0), sweep.stand(1.0)];
        Self {
            sweep,
            shape,
            drift,
            turn,
            speed,
            bow,
            twist,
            low,
            high,
            ends,
            tip,
            axis,
            from,
            to,
            radius,
            side,
            around,
        }
    }

    /// Largest error of depths below its surface, mm.
    pub(super) fn error(&self) -> f64 {
        self.bow + 0.5 * self.drift
    }

    /// Part of a line that can lie within `lateral` of the sweep.
    pub(super) fn window(&self, line: &RayLine, lateral: f64) -> Option<[f64; 2]> {
        let w = line.point(0.0) - self.tip;
        let (along, s0) = (self.axis.z, w.dot(&self.axis));
        let a = 1.0 - along * along;
        let b = w.z - s0 * along;
        let radius = self.radius + lateral;
        let c = w.norm_squared() - s0 * s0 - radius * radius;
        let (mut low, mut high) = (self.low[2] - lateral, self.high[2] + lateral);
        if a > PARALLEL_SLOPE_SQUARED {
            let root = b * b - a * c;
            if root < 0.0 {
                return None;
            }
            let (middle, half) = (-b / a, root.sqrt() / a);
            (low, high) = (low.max(middle - half), high.min(middle + half));
        } else if c > 1e-3 {
            return None;
        }
        if along.abs() > ACROSS_AXIS_COSINE {
            let (p, q) = ((self.from - lateral - s0) / along, (self.to + lateral - s0) / along);
            (low, high) = (low.max(p.min(q)), high.min(p.max(q)));
        }
        (low < high).then_some([low, high])
    }

    /// True when no point within `lateral` of the interval a..b of a line can lie inside the sweep.
    pub(super) fn clear(&self, line: &RayLine, [a, b]: [f64; 2], lateral: f64, guess: &mut f64) -> bool {
        let limit = lateral + self.error();
        let first = self.sweep.least(&self.shape, line, a, [0.0, 1.0], *guess, limit);
        *guess = first.t;
        if first.f > limit && first.rise >= self.turn {
            return true;
        }
        let last = self.sweep.least(&self.shape, line, b, [0.0, 1.0], *guess, limit);
        *guess = last.t;
        if last.f > limit && last.rise <= -self.turn {
            return true;
        }
        let (da, db) = (first.rise - self.turn, last.rise + self.turn);
        if da < 0.0 && db > 0.0 {
            // The tangents intersect below the least value.
            let share = db / (db - da);
            return first.f * share + last.f * (1.0 - share) + (b - a) * share * da > limit;
        }
        false
    }

    /// The part of an interval within the heights of the sweep.
    pub(super) fn part(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        [a.max(self.low[2]), b.min(self.high[2])]
    }

    /// True when no point of an interval of a line lies deeper inside the sweep than `least`, by queries that end as soon as
    /// they show that.
    fn shallow(&self, line: &RayLine, [a, b]: [f64; 2], least: f64, guess: &mut f64) -> bool {
        // A query may be this much too low.
        let limit = SEARCH_GAP_MM - least;
        let query = |x: f64, guess: f64| self.sweep.least(&self.shape, line, x, [0.0, 1.0], guess, limit);
        let mut low = (a, query(a, *guess));
        *guess = low.1.t;
        if low.1.f <= limit || low.1.rise >= 0.0 {
            return low.1.f > limit;
        }
        let mut high = (b, query(b, *guess));
        for _ in 0..MAX_NEWTON {
            let (da, db) = (low.1.rise, high.1.rise);
            if high.1.f <= limit || low.1.f <= limit {
                return false;
            }
            if da >= 0.0 || db <= 0.0 {
                return true;
            }
            let share = db / (db - da);
            if (low.1.f - da * low.0) * share + (high.1.f - db * high.0) * (1.0 - share) > limit {
                return true;
            }
            let x = (high.1.f - low.1.f + da * low.0 - db * high.0) / (da - db);
            let middle = (x.clamp(low.0, high.0), query(x.clamp(low.0, high.0), low.1.t));
            if middle.1.rise > 0.0 { high = middle } else { low = middle }
        }
        false
    }

    /// Place of the deepest point inside the sweep on an interval, and its depth; `None` when no depth exceeds `least`.
    pub(super) fn deepest(&self, line: &RayLine, [a, b]: [f64; 2], least: f64, guess: &mut f64) -> Option<(f64, f64)> {
        if self.shallow(line, [a, b], least, guess) {
            return None;
        }
        let query = |x: f64, guess: f64| self.sweep.least(&self.shape, line, x, [0.0, 1.0], guess, f64::INFINITY);
        let (mut low, mut high) = ((a, query(a, *guess)), (b, query(b, *guess)));
        *guess = low.1.t;
        let mut best = if low.1.f < high.1.f { (low.0, low.1.f) } else { (high.0, high.1.f) };
        // Tangents along the ray.
        for k in 0..MAX_NEWTON {
            let (da, db) = (low.1.rise, high.1.rise);
            if da >= 0.0 || db <= 0.0 {
                break;
            }
            let share = db / (db - da);
            let bound = (low.1.f - da * low.0) * share + (high.1.f - db * high.0) * (1.0 - share);
            if bound > -least || best.1 - bound < SEARCH_GAP_MM {
                break;
            }
            let x = if k % 2 == 0 {
                low.0 + (high.0 - low.0) * (1.0 - share)
            } else {
                (high.1.f - low.1.f + da * low.0 - db * high.0) / (da - db)
            };
            let middle = (x.clamp(low.0, high.0), query(x.clamp(low.0, high.0), low.1.t));
            if middle.1.f < best.1 {
                best = (middle.0, middle.1.f);
            }
            if middle.1.rise > 0.0 { high = middle } else { low = middle }
        }
        (-best.1 > least).then_some((best.0, -best.1))
    }
}
