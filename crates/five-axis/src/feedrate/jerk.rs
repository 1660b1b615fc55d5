//! A run below a given run within the limits of jerk.
//!
//! Along a path parameter s with y = (ds/dt)^2 the jerk of an axis is (q''' y + 3/2 q'' y' + q' y''/2) sqrt(y). Here y
//! is a spline of degree two with a knot at every end of a span. Therefore y'' is constant over a span, and the bracket
//! is a quadratic polynomial where q' is one. With upper bounds of y and |y'| in a span, the first two terms have an
//! upper bound; the rest of the jerk gives an upper bound of |y''|. Three sweeps over the coefficients, which are below
//! the given run, find the largest such spline. A forward and a backward sweep limit the growth of the slope by y''
//! (valleys). The third sweep subtracts the least convex change where y has too much negative curvature (crests).
//! Afterwards the bounds are tightened around the result.
//!
//! A run within its bounds satisfies the rows by the construction of the bounds. Where the run leaves its bounds, the
//! exact rows of the caller decide. Where rows are violated, the bounds are widened and the sweeps repeated. Violations
//! that remain at the end are removed by slowing down the whole run, so that every returned run satisfies every row.

use super::ramp::Most;
use super::{AT_BOUND, AXES, Axes, CURVATURE, LIMIT_ROUNDING, Limits};
use rayon::prelude::*;

/// Most sweeps; each tightens the bounds around the last run, or widens them.
const SWEEPS: usize = 10;

/// Number of sweeps without a violation that is enough: the gain falls to a quarter from one sweep to the next.
const ROUNDS: usize = 4;

/// Least gain of time, as a share, for which another sweep is made.
const GAIN: f64 = 1e-3;

/// Factor by which the slope may grow from one sweep to the next; then the ratio of a widened bound to the value that
/// violated it.
const LEEWAY: f64 = 1.3;
const MARGIN: f64 = 1.02;

/// Number of sweeps after which a violation reduces the share of the limits, and the factor of this reduction.
const STUBBORN: usize = 3;
const SMALLER: f64 = 0.9;

/// Least number of spans for a thread.
const CHUNK: usize = 4096;

/// Bounds of the derivatives of y over a span.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Whether a run within these bounds satisfies the rows.
    pub holds: bool,
    /// Bound of |y'|.
    pub slope: f64,
    /// Bound of |y''|.
    pub second: f64,
}

/// Share of the jerk, after the term of curvature, that is reserved for a change of y'.
const CHANGE: f64 = 0.2;

impl Bounds {
    /// Bounds for a share of acceleration and jerk in a span with these largest derivatives, where y is at most `y` and
    /// |y'| at most `steep`.
    pub fn new([rate, second, twist]: &Most, limits: &Limits, y: f64, steep: f64, share: f64) -> Self {
        let over = share / y.sqrt();
        let left: Axes = std::array::from_fn(|k| limits.jerk[k] * over - twist[k] * y);
        let mut slope = f64::INFINITY;
        for k in 0..AXES {
            slope = slope
                .min(2.0 * (share * limits.acceleration[k] - second[k] * y).max(0.0) / rate[k])
                .min((1.0 - CHANGE) * left[k].max(0.0) / (1.5 * second[k]));
        }
        // When a steady run already exceeds a limit, bounds of its changes are useless.
        let steady = |k: usize| left[k] >= 0.0 && second[k] * y <= share * limits.acceleration[k];
        let holds = (0..AXES).all(steady);
        let steep = steep.min(slope);
        let change = |k: usize| 2.0 * (left[k] - 1.5 * second[k] * steep).max(0.0) / rate[k];
        Self { holds, slope, second: (0..AXES).map(change).fold(f64::INFINITY, f64::min) }
    }
}

/// Largest y of a steady run through a span with these largest derivatives.
pub fn steady([_, second, twist]: &Most, limits: &Limits) -> f64 {
    let acceleration = (0..AXES).map(|k| limits.acceleration[k] / second[k]).fold(f64::INFINITY, f64::min);
    let jerk = (0..AXES).map(|k| limits.jerk[k] / twist[k]).fold(f64::INFINITY, f64::min);
    acceleration.min(libm::cbrt(CURVATURE * jerk).powi(2))
}

/// Constraints of a run, span by span.
pub trait Rows: Sync {
    /// Bounds for a share of acceleration and jerk where y is at most `most` and |y'| at most `steep` in a span.
    fn bounds(&self, span: usize, most: f64, steep: f64, share: f64) -> Bounds;

    /// Upper bounds of the shares of the limits of acceleration and of jerk that the run takes in a span: `y` are the
    /// Bernstein coefficients of y there.
    fn shares(&self, span: usize, y: &[f64; 3]) -> [f64; 2];
}

/// Bernstein coefficients of the spline in a span; `c` has one coefficient for each span and one more at either end.
pub fn over_span(widths: &[f64], c: &[f64], span: usize) -> [f64; 3] {
    let knot = |j: usize| {
        if j == 0 {
            c[0]
        } else if j == widths.len() {
            c[j + 1]
        } else {
            // Between the middles of two spans.
            let (a, b) = (widths[j - 1], widths[j]);
            (c[j] * b + c[j + 1] * a) / (a + b)
        }
    };
    [knot(span), c[span + 1], knot(span + 1)]
}

/// Upper bound of half of y'' over the square of the sum of the roots at both ends: at 1 y touches zero, and the time
/// is infinite.
const LARGEST_SECOND: f64 = 1.0 - 1e-12;

/// Time over a span in which y is quadratic and positive, from its Bernstein coefficients.
pub fn time(width: f64, [from, middle, to]: [f64; 3]) -> f64 {
    let sum = from.sqrt() + to.sqrt();
    // Half of y'' over the square of the sum. This is below 1 where y is positive; rounding may exceed 1 where y nearly
    // vanishes.
    let second = ((from - 2.0 * middle + to) / (sum * sum)).min(LARGEST_SECOND);
    let root = second.abs().sqrt();
    // Area hyperbolic tangent or arc tangent, over its argument.
    let shape = if root < 1e-3 {
        1.0 + second / 3.0 + second * second / 5.0
    } else if second > 0.0 {
        libm::atanh(root) / root
    } else {
        libm::atan(root) / root
    };
    2.0 * width / sum * shape
}

/// Largest coefficients below `ceiling` whose slope grows no faster than `mass` and `slope` allow.
fn grown(step: &[f64], ceiling: &[f64], mass: &[f64], slope: &[f64], backward: bool) -> Vec<f64> {
    let n = ceiling.len();
    let mut c = ceiling.to_vec();
    let mut rising = 0.0_f64;
    for i in 1..n {
        let (here, next, gap) = if backward { (n - i, n - 1 - i, n - 1 - i) } else { (i - 1, i, i - 1) };
        // From a valley on, half of the second derivative is reserved for the other side.
        let grow = if rising < 0.0 { 0.5 * mass[here] } else { rising + mass[here] };
        c[next] = ceiling[next].min(c[here] + grow.min(slope[gap]) * step[gap]);
        rising = (c[next] - c[here]) / step[gap];
    }
    c
}

/// Reduces crests whose negative curvature exceeds `mass`: the result is the largest sequence below `c` without them.
fn rounded(step: &[f64], c: &mut [f64], mass: &[f64]) {
    /// A vertex of the convex hull of c plus a function whose second derivative is the mass. This function is given
    /// relative to the previous vertex: `lift` is its height over the line there, `turn` its change of slope.
    struct Kept {
        at: usize,
        way: f64,
        lift: f64,
        turn: f64,
    }
    let mut hull: Vec<Kept> = vec![Kept { at: 0, way: 0.0, lift: 0.0, turn: 0.0 }];
    for i in 1..c.len() {
        let mut next = Kept { at: i, way: step[i - 1], lift: 0.0, turn: mass[i] };
        while let [.., before, last] = &hull[..] {
            let slope_in = (c[last.at] - c[before.at] + last.lift) / last.way;
            let slope_out = (c[i] - c[last.at] + next.lift) / next.way + last.turn;
            if slope_out >= slope_in {
                break;
            }
            next.lift += last.lift + last.turn * next.way;
            next.way += last.way;
            next.turn += last.turn;
            hull.pop();
        }
        hull.push(next);
    }
    for pair in hull.windows(2) {
        let [from, to] = pair else { continue };
        let slope = (c[to.at] - c[from.at] + to.lift) / to.way;
        let (start, mut way, mut lift, mut turn) = (c[from.at], 0.0, 0.0, 0.0);
        for i in from.at + 1..to.at {
            lift += turn * step[i - 1];
            way += step[i - 1];
            turn += mass[i];
            c[i] = c[i].min(start + slope * way - lift);
        }
    }
}

/// Assumptions of the bounds of each span: largest y and |y'|, and the share of the limits that the run may take.
struct SearchBounds {
    most: Vec<f64>,
    steep: Vec<f64>,
    share: Vec<f64>,
}

/// Values of a run in a span: largest y and |y'|, and whether rows are violated.
type Held = ([f64; 2], bool);

impl SearchBounds {
    fn new(most: Vec<f64>) -> Self {
        let n = most.len();
        Self { most, steep: vec![f64::INFINITY; n], share: vec![1.0; n] }
    }

    fn bounds(&self, rows: &impl Rows) -> Vec<Bounds> {
        let bounds = |j| rows.bounds(j, self.most[j], self.steep[j], self.share[j]);
        (0..self.most.len()).into_par_iter().with_min_len(CHUNK).map(bounds).collect()
    }

    /// Evaluates a run span by span. The rows are evaluated only where the run leaves the bounds.
    fn held(&self, widths: &[f64], c: &[f64], bounds: &[Bounds], rows: &impl Rows) -> Vec<Held> {
        let held = |j: usize| {
            let y = over_span(widths, c, j);
            let found = y[0].max(y[1]).max(y[2]);
            let slope = (y[1] - y[0]).abs().max((y[2] - y[1]).abs()) * 2.0 / widths[j];
            let inside = bounds[j].holds && found <= self.most[j] && slope <= bounds[j].slope.min(self.steep[j]);
            let broken = !inside && rows.shares(j, &y).iter().any(|s| *s > 1.0);
            ([found, slope], broken)
        };
        (0..widths.len()).into_par_iter().with_min_len(CHUNK).map(held).collect()
    }

    /// Tightens the bounds around a run that satisfies the rows, or widens them where the run violates rows.
    fn adapt(&mut self, held: Vec<Held>, sweep: usize) {
        let n = held.len();
        let broken = held.iter().any(|h| h.1);
        for (j, ([found, slope], fault)) in held.into_iter().enumerate() {
            if fault {
                // Where wider bounds did not help, a smaller share of the limits does.
                if sweep >= STUBBORN {
                    for s in &mut self.share[j.saturating_sub(1)..(j + 2).min(n)] {
                        *s *= SMALLER;
                    }
                }
                self.most[j] = self.most[j].max(MARGIN * found);
                self.steep[j] = self.steep[j].max(LEEWAY * slope);
            } else if !broken {
                self.most[j] = (self.most[j] * found).sqrt().max(found);
                self.steep[j] = LEEWAY * slope;
            }
        }
    }

    /// Returns to bounds that no run below the ceiling leaves.
    fn retreat(&mut self, ceiling: &[f64], edge: f64) {
        for (most, c) in self.most.iter_mut().zip(ceiling) {
            *most = c.max(edge);
        }
        self.steep.fill(f64::INFINITY);
    }
}

/// Distances between neighbouring coefficients; their places are the middles of the spans, and both ends.
fn steps(widths: &[f64]) -> Vec<f64> {
    let width = |c: usize| if c == 0 { 0.0 } else { widths[c - 1] };
    (0..=widths.len()).map(|i| 0.5 * (width(i) + widths.get(i).copied().unwrap_or(0.0))).collect()
}

/// Coefficients of y, one for each span and one at either end, below `ceiling` (largest y of each span). At both ends y
/// is `edge`, which must be below every ceiling, and the acceleration y'/2 in the direction away from the end is given
/// by `accelerations`. `guess` is the approximate largest y of each span. `None` where no run continues from these
/// accelerations; from zero a run always exists.
pub fn limit(
    widths: &[f64],
    ceiling: &[f64],
    guess: &[f64],
    edge: f64,
    accelerations: [f64; 2],
    rows: &impl Rows,
) -> Option<Vec<f64>> {
    let n = widths.len();
    let accelerated = accelerations != [0.0; 2];
    if n == 0 {
        return Some(Vec::new());
    }
    if accelerated && n < 4 {
        return None;
    }
    let step = steps(widths);
    let mut top = vec![edge; n + 2];
    for j in 1..n.saturating_sub(1) {
        top[j + 1] = ceiling[j].max(edge);
    }
    let ends = [(1, widths[0] * accelerations[0]), (n, widths[n - 1] * accelerations[1])];
    if accelerated {
        for (c, rise) in ends {
            top[c] = edge + rise;
            if top[c] > ceiling[c - 1] {
                return None;
            }
        }
    }
    let first = [2.0 * accelerations[0], 2.0 * accelerations[1]];
    let mut search = SearchBounds::new(guess.iter().zip(ceiling).map(|(g, c)| g.min(*c).max(edge)).collect());
    let mut best: Option<(f64, Vec<f64>)> = None;
    let mut last = top.clone();
    let (mut rounds, mut before) = (0, f64::INFINITY);
    for sweep in 0..SWEEPS {
        let bounds = search.bounds(rows);
        last = swept(widths, &step, &top, &bounds, first);
        if ends.iter().any(|(k, _)| last[*k] < top[*k] * (1.0 - LIMIT_ROUNDING)) {
            return None;
        }
        let held = search.held(widths, &last, &bounds, rows);
        if held.iter().all(|h| !h.1) {
            rounds += 1;
            let spent: f64 = (0..n).map(|j| time(widths[j], over_span(widths, &last, j))).sum();
            if best.as_ref().is_none_or(|(time, _)| spent < *time) {
                best = Some((spent, last.clone()));
            }
            if rounds == ROUNDS || spent > (1.0 - GAIN) * before {
                break;
            }
            before = spent;
        }
        // If no run was found, the last sweep but one returns to the widest bounds.
        if best.is_none() && sweep + 2 == SWEEPS {
            search.retreat(ceiling, edge);
        } else {
            search.adapt(held, sweep);
        }
    }
    match best {
        Some((_, c)) => Some(c),
        None if accelerated => None,
        None => Some(slowed(widths, &last, rows)),
    }
}

/// The whole run slowed down until it satisfies the rows: acceleration is proportional to y, jerk to its power 3/2.
fn slowed(widths: &[f64], c: &[f64], rows: &impl Rows) -> Vec<f64> {
    let over = |j: usize| {
        let [acceleration, jerk] = rows.shares(j, &over_span(widths, c, j));
        acceleration.max(libm::cbrt(jerk).powi(2))
    };
    let slower = (0..widths.len()).map(over).fold(1.0, f64::max) * (1.0 + AT_BOUND);
    c.iter().map(|c| c / slower).collect()
}

/// The three sweeps: the largest coefficients below `top` within the bounds of the spans.
fn swept(widths: &[f64], step: &[f64], top: &[f64], bounds: &[Bounds], first: [f64; 2]) -> Vec<f64> {
    let n = widths.len();
    let mut mass = vec![0.0; n + 2];
    // Slopes of the run at both ends.
    (mass[0], mass[n + 1]) = (first[0], first[1]);
    for j in 0..n {
        mass[j + 1] = bounds[j].second * widths[j];
    }
    let side = |j: Option<usize>| j.and_then(|j| bounds.get(j)).map_or(f64::INFINITY, |b| b.slope);
    let slope: Vec<f64> = (0..=n).map(|i| side(i.checked_sub(1)).min(side(Some(i)))).collect();
    let mut c = grown(step, top, &mass, &slope, false);
    for (c, back) in c.iter_mut().zip(grown(step, top, &mass, &slope, true)) {
        *c = c.min(back);
    }
    rounded(step, &mut c, &mass);
    c
}
