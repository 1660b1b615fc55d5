//! Changes of speed as isolated S-curves: where a run needs more knots, and its approximate speed there.

use super::{AXES, CURVATURE, LIMIT_ROUNDING, Limits};
use nurbs::bracket::Bracket;

/// Time steps in which a change of speed is resolved.
const RAMP_STEPS: usize = 32;

/// Steps behind such a change; each is half as long again as its predecessor.
const STEPS_BEHIND: usize = 8;

/// Factor by which a guess of the square of the speed exceeds that of an S-curve.
const LOOSE: f64 = 1.2;

/// Ratio of squares of the speed below which a change is ignored.
const SLIGHT: f64 = 1.05;

/// Knots closer than this share of a span count as one knot.
const SAME_KNOT_SHARE: f64 = 1e-5;

/// Places of the knots, as shares of a span from its end, where a whole change of speed is too short for its own knots.
/// Without a knot inside, a span from rest to rest would have zero speed.
const SHORT: [f64; 4] = [2.0 * SAME_KNOT_SHARE, 4.0 * SAME_KNOT_SHARE, 8.0 * SAME_KNOT_SHARE, 16.0 * SAME_KNOT_SHARE];

/// An isolated change of speed: an S-curve within an acceleration and a jerk.
#[derive(Clone, Copy)]
pub struct Ramp {
    /// Place of its start, and whether it runs against the direction of the path.
    at: f64,
    backward: bool,
    /// Rate of the parameter at its start and end.
    from: f64,
    to: f64,
    jerk: f64,
    /// Time in which the acceleration grows, and time in which it is constant.
    rise: f64,
    even: f64,
}

impl Ramp {
    fn new(from: f64, to: f64, acceleration: f64, jerk: f64) -> Self {
        let change = to - from;
        let (rise, even) = if jerk.is_finite() {
            let rise = (acceleration / jerk).min((change / jerk).sqrt());
            (rise, (change / (rise * jerk) - rise).max(0.0))
        } else {
            (0.0, change / acceleration)
        };
        Self { at: 0.0, backward: false, from, to, jerk, rise, even }
    }

    /// Ramp to the highest speed that is reached over a length.
    fn within(from: f64, to: f64, acceleration: f64, jerk: f64, way: f64) -> Self {
        let ramp = |to: f64| Self::new(from, to, acceleration, jerk);
        let fits = |r: &Self| r.after(r.time())[0] <= way;
        let whole = ramp(to);
        if fits(&whole) {
            return whole;
        }
        ramp(Bracket { holds: from, fails: to }.halved(30, |speed| fits(&ramp(speed))).fails)
    }

    /// Length and speed after a time.
    fn after(&self, t: f64) -> [f64; 2] {
        if self.rise <= 0.0 {
            let gained = (self.to - self.from) * t / self.even;
            return [(self.from + 0.5 * gained) * t, self.from + gained];
        }
        // The jerk changes at the start and at the end of the constant acceleration.
        let since = [t, t - self.rise, t - self.rise - self.even].map(|t| t.max(0.0));
        let sum = |power: i32| since[0].powi(power) - since[1].powi(power) - since[2].powi(power);
        [self.from * t + self.jerk * sum(3) / 6.0, self.from + self.jerk * sum(2) / 2.0]
    }

    fn time(&self) -> f64 {
        2.0 * self.rise + self.even
    }

    /// Lengths from its start at equal time steps, and then at growing steps up to `most`.
    fn places(&self, mut place: impl FnMut(f64), most: f64) {
        let (steps, level) =
            if self.to > 2.0 * self.from { (RAMP_STEPS, STEPS_BEHIND) } else { (RAMP_STEPS / 8, STEPS_BEHIND / 4) };
        let mut before = 0.0;
        let mut way = 0.0;
        // From rest, the start from standstill covers the first steps.
        let first = if self.from > 0.0 { 1 } else { steps / 8 };
        for step in first..=steps {
            before = way;
            way = self.after(self.time() * step as f64 / steps as f64)[0];
            place(way);
        }
        let mut gap = way - before;
        for _ in 0..level {
            way += gap;
            if way >= most {
                break;
            }
            place(way);
            gap *= 1.5;
        }
    }
}

/// A span with constant bounds, for [`resolve`]: the largest y, half of the largest |y'|, and the largest third
/// derivative of the parameter by time.
#[derive(Clone, Copy, Debug)]
pub struct Even {
    /// Largest y.
    pub cap: f64,
    /// Largest acceleration of the parameter.
    pub acceleration: f64,
    /// Largest jerk of the parameter.
    pub jerk: f64,
}

/// Additional knots where a run accelerates or brakes: at equal time steps of an isolated S-curve. `at` are the knots,
/// `y` the run there. Returns all knots, each with the span that ends there (the first with span 0), and the S-curves.
pub fn resolve(at: &[f64], y: &[f64], spans: &[Even]) -> (Vec<(f64, u32)>, Vec<Ramp>) {
    let n = spans.len();
    let (mut places, mut ramps): (Vec<f64>, Vec<Ramp>) = (Vec::new(), Vec::new());
    for backward in [false, true] {
        // Knot and span in the direction of the pass.
        let knot = |i: usize| if backward { n - i } else { i };
        let span = |i: usize| if backward { n - 1 - i } else { i };
        let width = |i: usize| (at[knot(i + 1)] - at[knot(i)]).abs();
        let slope = |i: usize| 2.0 * spans[span(i)].acceleration;
        let end = at[knot(n)];
        let mut i = 0;
        while i < n {
            let (from, start) = (y[knot(i)], at[knot(i)]);
            // The speed grows from here to the place where it is highest.
            let (mut top, mut to, mut distance) = (i, from, 0.0);
            while top < n {
                let [a, b] = [y[knot(top)], y[knot(top + 1)]];
                let inside = (0.5 * (a + b + slope(top) * width(top))).min(spans[span(top)].cap);
                to = to.max(inside).max(b);
                distance = (at[knot(top)] - start).abs()
                    + 0.5 * (width(top) + ((b - a) / slope(top)).max(-width(top)).min(width(top)));
                if inside > b * 1.001 || b <= a * 1.001 {
                    break;
                }
                top += 1;
            }
            if to > SLIGHT * from {
                let first = &spans[span(i)];
                let ramp = Ramp::within(from.sqrt(), to.sqrt(), first.acceleration, first.jerk, distance);
                ramp.places(|way| places.push(if backward { start - way } else { start + way }), (end - start).abs());
                ramps.push(Ramp { at: start, backward, ..ramp });
            }
            i = top + 1;
        }
    }
    places.sort_by(f64::total_cmp);
    let mut all = Vec::with_capacity(at.len() + places.len());
    let mut places = places.into_iter().peekable();
    all.push((at[0], 0));
    for (i, pair) in at.windows(2).enumerate() {
        let (from, to) = (pair[0], pair[1]);
        let span = u32::try_from(i).unwrap_or(u32::MAX);
        let near = SAME_KNOT_SHARE * (to - from);
        let short = SHORT.map(|share| share * (to - from));
        let (mut last, mut ends) = (from, [false; 2]);
        let mut inside: Vec<f64> = Vec::new();
        while let Some(place) = places.next_if(|p| *p < to) {
            if place - last > near && to - place > near {
                inside.push(place);
                last = place;
            }
            ends = [ends[0] || place - from <= near && place > from, ends[1] || to - place <= near];
        }
        // A change of speed that is hardly longer than the short knots has too few knots: the short knots replace them.
        let begins = inside.partition_point(|p| p - from <= short[3]);
        if ends[0] && begins < SHORT.len() {
            inside.splice(..begins, short.map(|way| from + way));
        }
        let stops = inside.partition_point(|p| to - p > short[3]);
        if ends[1] && inside.len() - stops < SHORT.len() {
            inside.truncate(stops);
            inside.extend(short.iter().rev().map(|way| to - way));
        }
        all.extend(inside.into_iter().map(|place| (place, span)));
        all.push((to, span));
    }
    (all, ramps)
}

/// Approximate largest y of each span between knots `at`: the upper bound `ceiling`, reduced by the S-curves.
pub fn guess(at: &[f64], ceiling: &[f64], ramps: &[Ramp]) -> Vec<f64> {
    let mut most = ceiling.to_vec();
    let n = most.len();
    for ramp in ramps {
        let first = at.partition_point(|k| *k < ramp.at - LIMIT_ROUNDING * ramp.at.abs());
        let (mut t, all) = (0.0, ramp.time());
        for i in 0..n {
            // The far end of the next span.
            let (span, far) = if ramp.backward {
                let Some(span) = first.checked_sub(1 + i) else { break };
                (span, ramp.at - at[span])
            } else {
                let span = first + i;
                if span >= n {
                    break;
                }
                (span, at[span + 1] - ramp.at)
            };
            while t < all && ramp.after(t)[0] < far {
                t += all / (4 * RAMP_STEPS) as f64;
            }
            if t >= all {
                break;
            }
            most[span] = most[span].min(LOOSE * ramp.after(t)[1].powi(2));
        }
    }
    most
}

/// Largest |q'|, |q''| and |q'''| of each axis over a span, by the parameter.
pub type Most = [[f64; AXES]; 3];

/// Start from rest: rate and acceleration of the parameter at its end, its length and its time.
#[derive(Clone, Copy, Debug)]
pub struct Creep {
    /// Rate.
    pub rate: f64,
    /// Acceleration.
    pub acceleration: f64,
    /// Length.
    pub way: f64,
    /// Time, s.
    pub time: f64,
}

impl Creep {
    /// Start from rest within a span with these derivatives, up to a rate and a length. The jerk is constant up to the
    /// end. For `still`, the jerk is positive in the first half of the time and negative in the second, so that the
    /// acceleration at the end is zero.
    pub fn new(most: &Most, limits: &Limits, rate: f64, way: f64, still: bool) -> Self {
        let [first, second, twist] = most;
        let jerk = (0..AXES).map(|k| limits.jerk[k] / first[k]).fold(f64::INFINITY, f64::min);
        // Curvature takes the rest of the jerk.
        let straight = second.iter().chain(twist).all(|x| *x == 0.0);
        let jerk = if straight { jerk } else { CURVATURE * jerk };
        let reach = |rate: f64| {
            let time = if still { 2.0 * (rate / jerk).sqrt() } else { (2.0 * rate / jerk).sqrt() };
            let (most, end) = if still { (0.5 * jerk * time, 0.0) } else { (jerk * time, jerk * time) };
            let way = if still { 0.5 * rate * time } else { rate * time / 3.0 };
            (most, Self { rate, acceleration: end, way, time })
        };
        let over = if still { way * jerk.sqrt() } else { 3.0 * way * (0.5 * jerk).sqrt() };
        let mut rate = rate.min(libm::cbrt(over).powi(2));
        let fits = |rate: f64| {
            let (rise, _) = reach(rate);
            (0..AXES).all(|k| {
                first[k] * rise + second[k] * rate * rate <= limits.acceleration[k]
                    && first[k] * jerk + 3.0 * second[k] * rate * rise + twist[k] * rate.powi(3)
                        <= limits.jerk[k] * (1.0 + LIMIT_ROUNDING)
            })
        };
        // The loop ends, since all but the first term of the jerk fall with the rate.
        for _ in 0..100 {
            if fits(rate) {
                break;
            }
            rate *= 0.5;
        }
        reach(rate).1
    }
}
