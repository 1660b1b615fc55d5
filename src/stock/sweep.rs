//! A convex body of revolution over one step of motion.
//!
//! For a step that only shifts, the function of place and time is convex in both together, so that tangents bound it
//! from below: the least over time is found with a known gap, and a ray that leaves the body never meets it again.
//! Under a turn by w a point at a distance h from the tip runs on an arc: there the same holds but for h w^2 / 2, which
//! [`super::most_turn`] keeps below [`super::END_ERROR`].

use super::Step;
use super::shape::Shape;
use nalgebra::Vector3;

/// Gap at which the search in time stops, mm.
pub(super) const GAP: f64 = 1e-4;

/// Steps of the search in time: the bracket halves at least every third one.
const MOST_LOOKS: u32 = 42;

/// Motion of a tool over a step, time from 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sweep {
    tip: Vector3<f64>,
    way: Vector3<f64>,
    /// Coefficients of 1, t and t^2 of the axis.
    axis: [Vector3<f64>; 3],
}

/// The function of a moving body at a place, as a plane that lies below it around there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// Value.
    pub(super) f: f64,
    /// Derivative by the place.
    pub(super) normal: Vector3<f64>,
    /// Derivative by time.
    pub(super) slope: f64,
    /// Time.
    pub(super) t: f64,
}

/// A pose of a moving tool with the speeds there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    tip: Vector3<f64>,
    axis: Vector3<f64>,
    way: Vector3<f64>,
    /// Derivative of the axis by time.
    turning: Vector3<f64>,
    t: f64,
}

impl Pose {
    /// The function at a place.
    #[inline]
    pub(super) fn look(&self, shape: &Shape, p: &Vector3<f64>) -> Look {
        let d = p - self.tip;
        let s = d.dot(&self.axis);
        let across = d - self.axis * s;
        let rho = across.norm();
        let out = if rho > 1e-12 { across / rho } else { Vector3::zeros() };
        let v = shape.at(rho, s);
        let turn = out.dot(&self.turning);
        let slope = v.by_rho * (-out.dot(&self.way) - s * turn) + v.by_s * (rho * turn - self.axis.dot(&self.way));
        Look { f: v.f, normal: out * v.by_rho + self.axis * v.by_s, slope, t: self.t }
    }

    /// Stretch of a line along a coordinate axis inside the body, its place given by `o` with zero along the line;
    /// `None` when the line misses it, or when the shape has no closed form.
    #[inline]
    pub(super) fn inside(&self, shape: &Shape, axis: usize, o: &Vector3<f64>) -> Option<[f64; 2]> {
        let d = o - self.tip;
        let (along, s0) = (self.axis[axis], d.dot(&self.axis));
        let disc = |from: f64, to: f64, radius: f64| {
            // Between two planes across the axis, then inside the cylinder.
            let (mut low, mut high) = if along.abs() > PARALLEL {
                let (p, q) = ((from - s0) / along, (to - s0) / along);
                (p.min(q), p.max(q))
            } else if s0 > from && s0 < to {
                (f64::NEG_INFINITY, f64::INFINITY)
            } else {
                return None;
            };
            let a = 1.0 - along * along;
            let c = d.norm_squared() - s0 * s0 - radius * radius;
            if a > PARALLEL {
                let b = d[axis] - s0 * along;
                let root = b * b - a * c;
                if root <= 0.0 {
                    return None;
                }
                let root = root.sqrt();
                (low, high) = (low.max((-b - root) / a), high.min((-b + root) / a));
            } else if c >= 0.0 {
                return None;
            }
            (low < high).then_some([low, high])
        };
        match *shape {
            Shape::Flat { radius, top } => disc(0.0, top, radius),
            Shape::Ball { radius, top } if top > 2.0 * radius => {
                let e = d - self.axis * radius;
                let root = e[axis] * e[axis] - e.norm_squared() + radius * radius;
                let ball = (root > 0.0).then(|| {
                    let root = root.sqrt();
                    [-e[axis] - root, -e[axis] + root]
                });
                // The ball lies inside the hull, which is convex: both stretches touch or one is empty.
                match (ball, disc(radius, top, radius)) {
                    (Some(a), Some(b)) => Some([a[0].min(b[0]), a[1].max(b[1])]),
                    (one, None) | (None, one) => one,
                }
            }
            _ => None,
        }
    }
}

/// Square of a component below which a line is taken as parallel.
const PARALLEL: f64 = 1e-9;

impl Sweep {
    /// The pose at a time with its speeds.
    pub(super) fn stand(&self, t: f64) -> Pose {
        let (tip, axis) = self.pose(t);
        Pose { tip, axis, way: self.way, turning: self.axis[1] + self.axis[2] * (2.0 * t), t }
    }

    pub(super) fn new(step: &Step) -> Self {
        let [a, m, b] = step.axes;
        Self {
            tip: step.tips[0].coords,
            way: step.tips[1] - step.tips[0],
            axis: [a, m * 4.0 - a * 3.0 - b, (a + b) * 2.0 - m * 4.0],
        }
    }

    /// Tip and axis at a time.
    #[inline]
    pub(super) fn pose(&self, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        (self.tip + self.way * t, self.axis[0] + (self.axis[1] + self.axis[2] * t) * t)
    }

    /// Distance from the axis and height over the tip of a place at the start.
    pub(super) fn at_start(&self, p: &Vector3<f64>) -> (f64, f64) {
        let d = p - self.tip;
        let s = d.dot(&self.axis[0]);
        ((d - self.axis[0] * s).norm(), s)
    }

    /// Way of the tip.
    pub(super) fn way(&self) -> &Vector3<f64> {
        &self.way
    }

    /// The function at a place and a time.
    #[inline]
    pub(super) fn look(&self, shape: &Shape, p: &Vector3<f64>, t: f64) -> Look {
        self.stand(t).look(shape, p)
    }

    /// Least over time at a place, from a first guess of the time. The value lies at most [`GAP`] below the true one,
    /// or anywhere between `cutoff` and the true one.
    #[inline]
    pub(super) fn least(&self, shape: &Shape, p: &Vector3<f64>, guess: f64, cutoff: f64) -> Look {
        let first = self.look(shape, p, guess);
        let end = if first.slope > 0.0 { 0.0 } else { 1.0 };
        let gap = first.slope * (first.t - end);
        if gap < GAP || first.f - gap > cutoff {
            return Look { f: first.f - gap, ..first };
        }
        let other = self.look(shape, p, end);
        if other.slope * (end - 0.5) <= 0.0 {
            // Still falling at the end of the time.
            return other;
        }
        let (mut low, mut high) = if end > 0.5 { (first, other) } else { (other, first) };
        for k in 0..MOST_LOOKS {
            // Tangents in time that cancel: a plane below the least over time.
            let share = high.slope / (high.slope - low.slope);
            let bound = (low.f - low.slope * low.t) * share + (high.f - high.slope * high.t) * (1.0 - share);
            let best = if low.f < high.f { low } else { high };
            if best.f - bound < GAP || bound > cutoff {
                let normal = low.normal * share + high.normal * (1.0 - share);
                return Look { f: bound, normal, slope: 0.0, t: best.t };
            }
            // Where the slope would vanish if it were linear; where the tangents meet, for kinks; the middle, for all.
            let t = match k % 3 {
                0 => low.t + (high.t - low.t) * (1.0 - share),
                1 => (high.f - low.f + low.slope * low.t - high.slope * high.t) / (low.slope - high.slope),
                _ => 0.5 * (low.t + high.t),
            };
            let middle = self.look(shape, p, t.clamp(low.t, high.t));
            if middle.slope > 0.0 {
                high = middle
            } else {
                low = middle
            }
            if high.t - low.t < 1e-9 {
                break;
            }
        }
        if low.f < high.f { low } else { high }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    /// Against 20 000 poses of the same motion.
    #[test]
    fn least_over_time_equals_brute_force() {
        let axis = |a: f64, c: f64| Vector3::new(a.sin() * c.sin(), -a.sin() * c.cos(), a.cos());
        let step = Step {
            block: 0,
            kind: super::super::StepKind::Cut,
            tips: [Point3::new(1.0, 2.0, -1.0), Point3::new(3.5, 2.4, -1.5)],
            axes: [axis(0.5, 0.3), axis(0.505, 0.305), axis(0.51, 0.31)],
        };
        let sweep = Sweep::new(&step);
        let turn = step.axes[0].angle(&step.axes[2]);
        for shape in [Shape::Flat { radius: 3.0, top: 20.0 }, Shape::Ball { radius: 3.0, top: 20.0 }] {
            for k in 0..400 {
                let x = f64::from(k);
                let p = Vector3::new(2.0 + 6.0 * (x * 0.7).sin(), 2.0 + 6.0 * (x * 1.3).cos(), -4.0 + x * 0.06);
                let brute =
                    (0..=20_000).map(|i| sweep.look(&shape, &p, f64::from(i) / 20_000.0).f).fold(f64::MAX, f64::min);
                for guess in [0.0, 0.4, 1.0] {
                    let found = sweep.least(&shape, &p, guess, f64::INFINITY).f;
                    // The bound of the module, at the turn of this step.
                    let bound = GAP + 0.5 * (p - step.tips[0].coords).norm() * turn * turn + 1e-5;
                    assert!((found - brute).abs() < bound, "{k} {guess}: {found} {brute}");
                }
            }
        }
    }
}
