//! A convex body of revolution over one step of motion.
//!
//! For a step without turn, the function is convex in place and time together, so that tangents bound it from below.
//! The least value over time is found within a known gap, and a ray that leaves the body never meets it again. During a
//! turn, the path of a point in the frame of the body deviates from its tangent; the same holds up to [`StepSweep::bow`].

use super::shape::{RadiusProfile, SolidShape};
use nalgebra::Vector3;

/// Distance from the tool axis at which a point counts as on it, mm.
const ON_AXIS: f64 = 1e-12;

/// Share of a step at which the search for the nearest time ends.
const INSTANT: f64 = 1e-9;

/// Gap at which the search in time ends, mm.
pub(super) const SEARCH_GAP_MM: f64 = 1e-4;

/// Steps of the search in time: at least every third step halves the bracket.
const MAX_QUERIES: u32 = 42;

/// Motion of a tool over a step, time from 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepSweep {
    tip: Vector3<f64>,
    way: Vector3<f64>,
    /// Coefficients of 1, t and t^2 of the axis.
    axis: [Vector3<f64>; 3],
}

/// The function of a moving body at a place, as a plane that lies below the function near this place.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepQuery {
    /// Value.
    pub(super) f: f64,
    /// Derivative along Z.
    pub(super) rise: f64,
    /// Derivative by time.
    pub(super) slope: f64,
    /// Half the second derivative by time, without the contribution of the surface of the body, which is never
    /// negative.
    pub(super) second: f64,
    /// Time.
    pub(super) t: f64,
}

/// A line along Z.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayLine {
    pub(super) x: f64,
    pub(super) y: f64,
}

impl RayLine {
    /// The point at a height.
    #[inline]
    pub(super) fn point(&self, z: f64) -> Vector3<f64> {
        Vector3::new(self.x, self.y, z)
    }
}

/// A pose of a moving tool with its speeds.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepPose {
    pub(super) tip: Vector3<f64>,
    pub(super) axis: Vector3<f64>,
    way: Vector3<f64>,
    /// First and second derivative of the axis by time.
    turning: Vector3<f64>,
    pull: Vector3<f64>,
    /// Components of the tip motion along the axis and along the derivative of the axis.
    advance: f64,
    swing: f64,
    /// Square of the component of Z across the axis, and its inverse; inverse of the component along the axis. Inverses
    /// are zero for zero components.
    pub(super) square: f64,
    pub(super) by_square: f64,
    pub(super) by_along: f64,
    pub(super) t: f64,
}

impl StepPose {
    /// Numbers of a pose, without its time.
    pub(super) const NUMBERS: usize = 20;

    /// The pose as numbers.
    pub(super) fn numbers(&self) -> [f64; Self::NUMBERS] {
        let Self { tip, axis, way, turning, pull, advance, swing, square, by_square, by_along, .. } = self;
        let mut numbers = [0.0; Self::NUMBERS];
        for (place, v) in numbers.chunks_exact_mut(3).zip([tip, axis, way, turning, pull]) {
            place.copy_from_slice(v.as_slice());
        }
        numbers[15..].copy_from_slice(&[*advance, *swing, *square, *by_square, *by_along]);
        numbers
    }

    /// The pose of some numbers at a time.
    #[inline(always)]
    pub(super) fn from_numbers(of: impl Fn(usize) -> f64, t: f64) -> Self {
        let vector = |k: usize| Vector3::new(of(k), of(k + 1), of(k + 2));
        Self {
            tip: vector(0),
            axis: vector(3),
            way: vector(6),
            turning: vector(9),
            pull: vector(12),
            advance: of(15),
            swing: of(16),
            square: of(17),
            by_square: of(18),
            by_along: of(19),
            t,
        }
    }

    /// The function on a line at a height.
    #[inline(always)]
    pub(super) fn query(&self, body: &impl RadiusProfile, line: &RayLine, z: f64) -> StepQuery {
        let d = line.point(z) - self.tip;
        let s = d.dot(&self.axis);
        let across = d - self.axis * s;
        // Not `norm`: its root may prevent vectorisation.
        let rho = across.norm_squared().sqrt();
        // On the axis the direction across is zero.
        let share = 1.0 / if rho > ON_AXIS { rho } else { f64::INFINITY };
        let v = body.at(rho, s);
        // First and second derivative of the height, then of the distance from the axis.
        let (s1, s2) = (d.dot(&self.turning) - self.advance, d.dot(&self.pull) - 2.0 * self.swing);
        let turn = across.dot(&self.turning) * share;
        let (r1, r2) =
            (-across.dot(&self.way) * share - s * turn, -2.0 * s1 * turn - s * across.dot(&self.pull) * share);
        StepQuery {
            f: v.f,
            rise: across.z * share * v.by_rho + self.axis.z * v.by_s,
            slope: v.by_rho * r1 + v.by_s * s1,
            second: 0.5 * (v.by_rho * r2 + v.by_s * s2),
            t: self.t,
        }
    }

    /// The part of a line inside of the body, by tangents from both ends of an interval, and approximately the place
    /// where the body is nearest.
    pub(super) fn interval_by_tangents(&self, shape: &SolidShape, line: &RayLine, [a, b]: [f64; 2]) -> ([f64; 2], f64) {
        let query = |z: f64| {
            let query = self.query(shape, line, z);
            (z, query.f, query.rise)
        };
        let near = |x: f64| (EMPTY, x);
        let (first, last) = (query(a), query(b));
        // Search for a place inside.
        let (mut low, mut high) = (first, last);
        let mut inside = if first.1 < 0.0 { first } else { last };
        for k in 0..MAX_QUERIES {
            let best = if low.1 < high.1 { low } else { high };
            if best.1 < 0.0 {
                inside = best;
                break;
            }
            if low.2 >= 0.0 || high.2 <= 0.0 {
                return near(if low.2 >= 0.0 { low.0 } else { high.0 });
            }
            // Intersection of the tangents.
            let x = (high.1 - low.1 + low.2 * low.0 - high.2 * high.0) / (low.2 - high.2);
            if low.1 + low.2 * (x - low.0) > 0.0 || high.0 - low.0 < SEARCH_GAP_MM || k + 1 == MAX_QUERIES {
                return near(best.0);
            }
            let x = if k % 3 == 2 { 0.5 * (low.0 + high.0) } else { x };
            let middle = query(x.clamp(low.0, high.0));
            if middle.2 > 0.0 { high = middle } else { low = middle }
        }
        // From outside, tangent steps approach the surface without passing it.
        let leave = |mut at: (f64, f64, f64), beyond: f64| {
            if at.1 <= 0.0 {
                return beyond;
            }
            for _ in 0..MAX_QUERIES {
                let next = at.0 - at.1 / at.2;
                if !next.is_finite() || (next - inside.0) * (at.0 - inside.0) <= 0.0 {
                    return inside.0;
                }
                at = query(next);
                if at.1 < SEARCH_GAP_MM {
                    break;
                }
            }
            at.0
        };
        ([leave(first, f64::NEG_INFINITY), leave(last, f64::INFINITY)], inside.0)
    }
}

/// Part of a line that misses the body.
const EMPTY: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// Square of a component below which a line counts as parallel.
const PARALLEL_SQUARED: f64 = 1e-9;

impl StepSweep {
    /// The pose at a time with its speeds.
    #[inline(always)]
    pub(super) fn stand(&self, t: f64) -> StepPose {
        let (tip, axis) = self.pose(t);
        let turning = self.axis[1] + self.axis[2] * (2.0 * t);
        let (advance, swing) = (axis.dot(&self.way), turning.dot(&self.way));
        let square = 1.0 - axis.z * axis.z;
        let by_square = 1.0 / if square > PARALLEL_SQUARED { square } else { f64::INFINITY };
        let by_along = 1.0 / if axis.z.abs() > PARALLEL_SQUARED { axis.z } else { f64::INFINITY };
        StepPose {
            tip,
            axis,
            way: self.way,
            turning,
            pull: self.axis[2] * 2.0,
            advance,
            swing,
            square,
            by_square,
            by_along,
            t,
        }
    }

    /// The motion through a pose at the start, an axis at half time, and a pose at the end.
    pub(super) fn through(tips: [Vector3<f64>; 2], [a, m, b]: [Vector3<f64>; 3]) -> Self {
        Self { tip: tips[0], way: tips[1] - tips[0], axis: [a, m * 4.0 - a * 3.0 - b, (a + b) * 2.0 - m * 4.0] }
    }

    /// The motion between two times.
    pub(super) fn part(&self, from: f64, to: f64) -> Self {
        let d = to - from;
        let [_, linear, square] = self.axis;
        Self {
            tip: self.tip + self.way * from,
            way: self.way * d,
            axis: [self.pose(from).1, (linear + square * (2.0 * from)) * d, square * (d * d)],
        }
    }

    /// Tip and axis at a time.
    #[inline]
    pub(super) fn pose(&self, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        (self.tip + self.way * t, self.axis[0] + (self.axis[1] + self.axis[2] * t) * t)
    }

    /// Largest speed of the axis, radians in the time of the step.
    pub(super) fn turn(&self) -> f64 {
        let [_, linear, square] = self.axis;
        // The derivative is linear in time: its largest length is at an end.
        linear.norm().max((linear + square * 2.0).norm())
    }

    /// Half the largest acceleration, in the frame of the body, of a place within `reach` of the tip: over a time t the
    /// function may fall below its tangent by this value times t^2. In a frame that turns by w and moves by v the
    /// acceleration is r (w' + w^2) + 2 w v.
    pub(super) fn bow(&self, reach: f64) -> f64 {
        let turn = self.turn();
        let pull = self.axis[2] * 2.0;
        let middle = self.pose(0.5).1;
        // The component that keeps the axis on the sphere is no acceleration of the turn. The axis deviates from the
        // middle by half the turn.
        let gain = (pull - middle * pull.dot(&middle)).norm() + 0.5 * turn * pull.norm();
        0.5 * (reach * (gain + turn * turn) + 2.0 * turn * self.way.norm())
    }

    /// Upper bound of the error of a parabola with slope and second derivative, for a time of 1; it grows with the cube
    /// of the time.
    ///
    /// The body is convex in the vector r from the axis and the height s over the tip. Its tangent in (r, s) lies below
    /// it while r and s move. The parabola neglects the third derivatives of r, across the axis, and of s. With speed
    /// v, axis speed w and the derivative p of the latter these are at most 3 w (2 v w + h p) + 3 p (v + h w) + 3 v p
    /// (1 + w).
    pub(super) fn twist(&self, reach: f64) -> f64 {
        let (v, w, p) = (self.way.norm(), self.turn(), 2.0 * self.axis[2].norm());
        0.5 * (w * (2.0 * v * w + reach * p) + p * (v + reach * w) + v * p * (1.0 + w))
    }

    /// Vector of the tip motion.
    pub(super) fn way(&self) -> &Vector3<f64> {
        &self.way
    }

    /// The function at a place and a time.
    #[inline]
    fn query(&self, shape: &SolidShape, line: &RayLine, z: f64, t: f64) -> StepQuery {
        self.stand(t).query(shape, line, z)
    }

    /// Least value over a piece of time at a place, by tangents from a first guess of the time. The result is at most
    /// [`SEARCH_GAP_MM`] below the true value, or anywhere between `cutoff` and the true value.
    pub(super) fn least(
        &self,
        shape: &SolidShape,
        line: &RayLine,
        z: f64,
        [from, to]: [f64; 2],
        guess: f64,
        cutoff: f64,
    ) -> StepQuery {
        let first = self.query(shape, line, z, guess);
        let end = if first.slope > 0.0 { from } else { to };
        // Largest fall of the function to both sides.
        let fall = |run: f64| (first.slope + first.second.min(0.0) * run) * run;
        let gap = -fall(from - first.t).min(fall(to - first.t)).min(0.0);
        if gap < SEARCH_GAP_MM || first.f - gap > cutoff {
            return StepQuery { f: first.f - gap, ..first };
        }
        let other = self.query(shape, line, z, end);
        if other.slope * (end - 0.5 * (from + to)) <= 0.0 {
            // The function still falls at the end of the time.
            return other;
        }
        let (mut low, mut high) = if end > guess { (first, other) } else { (other, first) };
        for k in 0..MAX_QUERIES {
            // The mean of the tangents with zero slope in time: a plane below the least value over time.
            let share = high.slope / (high.slope - low.slope);
            let bound = (low.f - low.slope * low.t) * share + (high.f - high.slope * high.t) * (1.0 - share);
            let best = if low.f < high.f { low } else { high };
            if best.f - bound < SEARCH_GAP_MM || bound > cutoff {
                let rise = low.rise * share + high.rise * (1.0 - share);
                return StepQuery { f: bound, rise, slope: 0.0, ..best };
            }
            // Three candidates in turn: zero of a linear slope; intersection of the tangents, for kinks; the middle,
            // for all cases.
            let t = match k % 3 {
                0 => low.t + (high.t - low.t) * (1.0 - share),
                1 => (high.f - low.f + low.slope * low.t - high.slope * high.t) / (low.slope - high.slope),
                _ => 0.5 * (low.t + high.t),
            };
            let middle = self.query(shape, line, z, t.clamp(low.t, high.t));
            if middle.slope > 0.0 {
                high = middle
            } else {
                low = middle
            }
            if high.t - low.t < INSTANT {
                break;
            }
        }
        if low.f < high.f { low } else { high }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compared with 20 000 poses of the same motion.
    #[test]
    fn least_over_time_equals_brute_force() {
        let axis = |a: f64, c: f64| Vector3::new(a.sin() * c.sin(), -a.sin() * c.cos(), a.cos());
        let tips = [Vector3::new(1.0, 2.0, -1.0), Vector3::new(3.5, 2.4, -1.5)];
        for turn in [0.01, 0.035] {
            let sweep = StepSweep::through(tips, [0.0, 0.5, 1.0].map(|t| axis(0.5 + turn * t, 0.3 + turn * t)));
            agrees(&sweep, &tips);
        }
    }

    fn agrees(sweep: &StepSweep, tips: &[Vector3<f64>; 2]) {
        for shape in [SolidShape::Flat { radius: 3.0, top: 20.0 }, SolidShape::Ball { radius: 3.0, top: 20.0 }] {
            for k in 0..400 {
                let x = f64::from(k);
                let p = Vector3::new(2.0 + 6.0 * (x * 0.7).sin(), 2.0 + 6.0 * (x * 1.3).cos(), -4.0 + x * 0.06);
                let line = RayLine { x: p.x, y: p.y };
                let brute = (0..=20_000)
                    .map(|i| sweep.query(&shape, &line, p.z, f64::from(i) / 20_000.0).f)
                    .fold(f64::MAX, f64::min);
                let reach = (p - tips[0]).norm() + sweep.way.norm();
                let (bow, twist) = (sweep.bow(reach), sweep.twist(reach));
                for guess in [0.0, 0.4, 1.0] {
                    let found = sweep.least(&shape, &line, p.z, [0.0, 1.0], guess, f64::INFINITY).f;
                    assert!((found - brute).abs() < SEARCH_GAP_MM + bow, "{k} {guess}: {found} {brute}");
                }
                // No value lies below its tangent by more than the bow allows.
                for i in 0..=20 {
                    let (s, e) = (sweep.query(&shape, &line, p.z, f64::from(i) / 20.0), [0.0, 0.3, 1.0]);
                    for t in e {
                        let query = sweep.query(&shape, &line, p.z, t);
                        let run = s.t - t;
                        assert!(s.f > query.f + query.slope * run - bow * run * run - 1e-9, "{k} {i} {t}");
                        let parabola = query.f + (query.slope + query.second * run) * run;
                        assert!(s.f > parabola - twist * run.abs().powi(3) - 1e-9, "{k} {i} {t}");
                    }
                }
            }
        }
    }
}
