//! The run within the jerk of every axis, including the corners.
//!
//! In a cell, |q'| and |q''| are its bounds. |q'''| is the change of q'' from the middle of one cell to the middle of
//! the next, including curvature that is divided into chords. The run satisfies |q''| y + |q'| |y'|/2 <= acceleration
//! and (|q'''| y + 3/2 |q''| |y'| + |q'| |y''|/2) sqrt(y) <= jerk over every part of a cell.
//!
//! The rest of a corner, which is not such curvature, is rounded by a pulse of acceleration that rises and falls with
//! the jerk. A change of speed v takes v/a + a/j where the acceleration a is reached, and 2 sqrt(v/j) otherwise. As
//! without limits of jerk, the rounding remains within the chord tolerance and between the middles of both blocks.
//!
//! The rate of the parameter is continuous over corners. Its scale therefore drifts where many blocks in a row end
//! faster than they begin. Before digits are lost, the run comes to rest at a corner: this run is feasible as well, and
//! takes longer.

use super::active::{LimitOfAxis, MotionLimit, NO_CORNER};
use super::{CornerError, Joint5, MotionCell, MovePart, RunLimits};
use five_axis::feedrate;
use five_axis::feedrate::jerk::{self, Bounds, Rows};
use five_axis::feedrate::ramp::{self, Creep, Even, Most, Ramp};
use ir::repeats::first_alike;
use nurbs::bracket::Bracket;
use rayon::prelude::*;
use std::ops::Range;

/// Share by which a sum that meets its bound may exceed it by rounding.
const SUM_ROUNDING: f64 = 1e-9;

/// Share of a limit, or of a time, by which cells of a sector differ from those of another that it repeats: positions are
/// the same to some 1e-13 mm, which is 1e-9 of an acceleration in the shortest blocks.
const CELL_ROUNDING: f64 = 1e-7;

/// Halvings in the search of the speed at which a corner can be rounded.
const CORNER_SPEED_HALVINGS: usize = 40;

/// Largest ratio of two scales in a run.
const MAX_SCALE_RATIO: f64 = 16_777_216.0;

/// A cell or a part of a cell, by a parameter whose rate is continuous over corners.
#[derive(Clone)]
struct JerkSpan {
    cell: usize,
    /// Ratio of the parameter to the programmed time.
    scale: f64,
    width: f64,
    most: Most,
    cap: f64,
}

/// The largest of five values, and its place.
fn largest(values: &Joint5) -> (f64, usize) {
    (0..5).fold((0.0, 0), |most, k| if values[k] > most.0 { (values[k], k) } else { most })
}

/// Time to change the speed of each axis by `change`, s.
fn pulse(limits: &RunLimits, change: &Joint5) -> f64 {
    slowest(limits, change).0
}

/// The same with the axis that takes this time.
fn slowest(limits: &RunLimits, change: &Joint5) -> (f64, usize) {
    let one = |k: usize| {
        let (v, a, j) = (change[k].abs(), limits.acceleration[k], limits.jerk[k]);
        if v * j >= a * a { v / a + a / j } else { 2.0 * (v / j).sqrt() }
    };
    largest(&std::array::from_fn(|k| if limits.jerk[k].is_finite() { one(k) } else { 0.0 }))
}

/// Part of a corner that is not curvature, by the time of the block before it.
fn excess(before: &MotionCell, cell: &MotionCell) -> Joint5 {
    if cell.runs_on {
        return [0.0; 5];
    }
    std::array::from_fn(|k| {
        let jump = cell.jump[k] * cell.ratio;
        jump - 0.5 * (before.shared[k] + cell.shared[k] * cell.ratio)
    })
}

/// Deviation at a corner with y before it.
pub(super) fn rounding(limits: &RunLimits, before: Option<&MotionCell>, cell: &MotionCell, y: f64) -> CornerError {
    let root = y.sqrt();
    let time = before.map_or(0.0, |b| pulse(limits, &excess(b, cell).map(|e| e * root)));
    let turn = limits.chain.turn([0.0; 2], [cell.jump[3] * cell.ratio, cell.jump[4] * cell.ratio]);
    let tilt = turn * root * time / 8.0;
    CornerError {
        flutes: (cell.flutes * root * time / 8.0).max(y * cell.rounding),
        axis: tilt.max(y * cell.tilting).to_degrees(),
    }
}

/// Limits of the corner at the start of a cell with the shares that a run with y before the corner takes: of the
/// tolerance by the deviation, and of the time between the middles of both blocks by the axis that takes longest to
/// change its speed.
pub(super) fn corner_shares(
    limits: &RunLimits,
    cells: &[MotionCell],
    corner: usize,
    y: f64,
) -> [(f64, LimitOfAxis); 3] {
    let before = corner.checked_sub(1).and_then(|b| cells.get(b));
    let cell = cells.get(corner).filter(|c| c.ratio > 0.0);
    let Some((before, cell)) = before.zip(cell) else { return NO_CORNER };
    let root = y.sqrt();
    let change = excess(before, cell).map(|e| e * root);
    let (time, slow) = slowest(limits, &change);
    let (a, j) = (limits.acceleration[slow], limits.jerk[slow]);
    let by = if change[slow].abs() * j >= a * a { MotionLimit::Acceleration } else { MotionLimit::Jerk };
    let jump: Joint5 = std::array::from_fn(|k| (cell.jump[k] * cell.ratio).abs() / limits.acceleration[k]);
    let (most, axis) = largest(&jump);
    [
        ((cell.flutes * root * time / 8.0).max(y * cell.rounding) / limits.chord, (MotionLimit::Corner, None)),
        (time * root / cell.rounding_time, (by, Some(slow))),
        (most * y / cell.rounding_time, (MotionLimit::Acceleration, Some(axis))),
    ]
}

/// Largest y before a corner.
fn corner(limits: &RunLimits, before: &MotionCell, cell: &MotionCell) -> f64 {
    let excess = excess(before, cell);
    let fits = |y: f64| {
        let root = y.sqrt();
        let time = pulse(limits, &excess.map(|e| e * root));
        time * root <= cell.rounding_time && cell.flutes * root * time / 8.0 <= limits.chord
    };
    let most = cell.corner.min(before.cap).min(cell.cap / (cell.ratio * cell.ratio));
    if fits(most) {
        return most;
    }
    let Bracket { holds, fails } = Bracket { holds: 0.0, fails: most }.halved(CORNER_SPEED_HALVINGS, fits);
    // The result is never a stop: below the resolution of the search every y fits.
    holds.max(0.5 * (fails - holds))
}

/// Largest change of q'' by the time of a cell, between the middles of the cell and of its neighbours; cells beyond a
/// stop do not count.
pub(super) fn twist(cells: &[MotionCell], i: usize) -> Joint5 {
    let cell = &cells[i];
    let mut most = [0.0_f64; 5];
    let behind = i.checked_sub(1).filter(|_| cell.ratio > 0.0).map(|b| (&cells[b], 1.0 / cell.ratio));
    let ahead = cells.get(i + 1).filter(|n| n.ratio > 0.0).map(|n| (n, n.ratio));
    for (other, ratio) in behind.into_iter().chain(ahead) {
        let way = 0.5 * (cell.width + other.width / ratio);
        for (k, most) in most.iter_mut().enumerate() {
            *most = most.max((other.level[k] * ratio * ratio - cell.level[k]).abs() / way);
        }
    }
    most
}

/// Bounds of the spans for the engine, judged by sums of absolute values.
struct JerkRows<'a> {
    spans: &'a [JerkSpan],
    limits: feedrate::Limits,
}

impl JerkRows<'_> {
    /// Largest acceleration and jerk of each axis.
    fn largest(&self, span: usize, y: &[f64; 3]) -> [Joint5; 2] {
        let JerkSpan { width, most: [rate, second, twist], .. } = &self.spans[span];
        let top = y[0].max(y[1]).max(y[2]);
        let [first, last] = [2.0 * (y[1] - y[0]) / width, 2.0 * (y[2] - y[1]) / width];
        let (slope, turn) = (first.abs().max(last.abs()), ((last - first) / width).abs());
        [
            std::array::from_fn(|k| second[k] * top + 0.5 * rate[k] * slope),
            std::array::from_fn(|k| (twist[k] * top + 1.5 * second[k] * slope + 0.5 * rate[k] * turn) * top.sqrt()),
        ]
    }

    /// The run over a span, by the time of its cell.
    fn part(&self, span: usize, y: [f64; 3]) -> MovePart {
        let JerkSpan { cell, scale, width, .. } = self.spans[span];
        let square = scale * scale;
        let [acceleration, jerk] = self.largest(span, &y);
        MovePart {
            cell,
            width: width / scale,
            time: jerk::time(width, y),
            from: y[0] / square,
            peak: y[0].max(y[1]).max(y[2]) / square,
            acceleration,
            jerk,
        }
    }
}

impl Rows for JerkRows<'_> {
    fn bounds(&self, span: usize, most: f64, steep: f64, share: f64) -> Bounds {
        Bounds::new(&self.spans[span].most, &self.limits, most, steep, share)
    }

    fn shares(&self, span: usize, y: &[f64; 3]) -> [f64; 2] {
        let [acceleration, jerk] = self.largest(span, y);
        let share = |found: &Joint5, limit: &Joint5| (0..5).map(|k| found[k] / limit[k]).fold(0.0, f64::max);
        let all = [share(&acceleration, &self.limits.acceleration), share(&jerk, &self.limits.jerk)];
        // Sums that meet their bound do so to the last digits only.
        all.map(|s| if s < 1.0 + SUM_ROUNDING { s.min(1.0) } else { s })
    }
}

/// The run through cells, from rest to rest. What is alike is run once.
pub(super) fn run(limits: &RunLimits, cells: &[MotionCell]) -> Vec<MovePart> {
    let ranges = from_rest_to_rest(cells);
    // By the number of cells and the programmed time in steps of 10 us.
    let key = |range: &Range<usize>| {
        let time: f64 = cells[range.clone()].iter().map(|cell| cell.width).sum();
        (range.len(), (time * 1e5).round() as i64)
    };
    let like = first_alike(&ranges, key, |a, b| {
        let pairs = cells[a.clone()].iter().zip(&cells[b.clone()]);
        pairs.enumerate().all(|(i, (a, b))| run_alike(limits, a, b, i == 0))
    });
    let own: Vec<Vec<MovePart>> = (0..ranges.len())
        .into_par_iter()
        .map(|r| if like[r] == r { moving(limits, &cells[ranges[r].clone()]) } else { Vec::new() })
        .collect();
    let mut parts = Vec::with_capacity(cells.len());
    for (range, like) in ranges.into_iter().zip(like) {
        let (first, start) = (range.start, parts.len());
        parts.extend(own[like].iter().map(|part| MovePart { cell: first + part.cell, ..*part }));
        // A control that does not stop here deviates from the corner as at its largest speed.
        if let (Some(before), Some(part)) = (first.checked_sub(1), parts.get_mut(start))
            && cells[first].ratio > 0.0
        {
            part.from = corner(limits, &cells[before], &cells[first]) * cells[first].ratio * cells[first].ratio;
        }
    }
    parts
}

/// The cells between the places at which the run comes to rest.
fn from_rest_to_rest(cells: &[MotionCell]) -> Vec<Range<usize>> {
    let mut ranges = Vec::new();
    let mut first = 0;
    while first < cells.len() {
        let (mut scale, mut least, mut most) = (1.0, 1.0_f64, 1.0_f64);
        let ends = |i: &usize| {
            scale /= cells[*i].ratio;
            (least, most) = (least.min(scale), most.max(scale));
            cells[*i].rests || cells[*i].ratio <= 0.0 || most > MAX_SCALE_RATIO * least
        };
        let stop = (first + 1..cells.len()).find(ends).unwrap_or(cells.len());
        ranges.push(first..stop);
        first = stop;
    }
    ranges
}

/// Whether two cells are run alike: all that the run takes from them is the same to [`CELL_ROUNDING`] of the limits. At the
/// start of a range the corner behind does not count.
fn run_alike(limits: &RunLimits, a: &MotionCell, b: &MotionCell, at_start: bool) -> bool {
    let near = |a: f64, b: f64, scale: f64| a == b || (a - b).abs() <= CELL_ROUNDING * scale;
    let all = |a: &Joint5, b: &Joint5, scale: &Joint5| (0..5).all(|k| near(a[k], b[k], scale[k]));
    let corner = || {
        // y is at most 1.
        near(a.corner.min(1.0), b.corner.min(1.0), a.corner.min(1.0))
            && near(a.ratio, b.ratio, a.ratio)
            && near(a.rounding_time, b.rounding_time, a.rounding_time)
            && near(a.flutes, b.flutes, limits.feeds[0])
            && all(&a.jump, &b.jump, &limits.speed)
            && a.runs_on == b.runs_on
    };
    near(a.width, b.width, a.width)
        && near(a.cap, b.cap, a.cap)
        && all(&a.rate, &b.rate, &limits.speed)
        && all(&a.second, &b.second, &limits.acceleration)
        && all(&a.level, &b.level, &limits.acceleration)
        && all(&a.shared, &b.shared, &limits.speed)
        && (at_start || corner())
}

/// Largest y that the run reaches from y over a span, within the acceleration.
fn rise(limits: &RunLimits, span: &JerkSpan, y: f64) -> f64 {
    let [rate, second, _] = &span.most;
    (0..5)
        .filter(|k| rate[*k] > 0.0)
        .map(|k| {
            let way = 2.0 * span.width / rate[k];
            (y + way * limits.acceleration[k]) / (1.0 + way * second[k])
        })
        .fold(span.cap, f64::min)
}

/// Largest y at the knots within the accelerations.
fn within_accelerations(limits: &RunLimits, spans: &[JerkSpan], knots: &[f64]) -> Vec<f64> {
    let n = spans.len();
    let mut y = knots.to_vec();
    (y[0], y[n]) = (0.0, 0.0);
    for i in 0..n {
        y[i + 1] = y[i + 1].min(rise(limits, &spans[i], y[i]));
    }
    for i in (0..n).rev() {
        y[i] = y[i].min(rise(limits, &spans[i], y[i + 1]));
    }
    y
}

/// The cells from one rest to the next.
struct SpanChain {
    spans: Vec<JerkSpan>,
    /// Largest y at the knots, corners included.
    knots: Vec<f64>,
}

/// A chain with the places of its knots and the changes of speed that need them.
struct DividedChain {
    chain: SpanChain,
    at: Vec<f64>,
    ramps: Vec<Ramp>,
}

impl SpanChain {
    /// Each cell as a span, by a parameter whose rate is continuous over corners.
    fn new(limits: &RunLimits, axes: &feedrate::Limits, cells: &[MotionCell]) -> Self {
        let mut spans: Vec<JerkSpan> = Vec::with_capacity(cells.len());
        let mut knots = vec![f64::INFINITY];
        let mut scale = 1.0;
        for (i, cell) in cells.iter().enumerate() {
            if i > 0 {
                knots.push(corner(limits, &cells[i - 1], cell) * scale * scale);
                scale /= cell.ratio;
            }
            let most: Most = [cell.rate, cell.second, twist(cells, i)];
            let cap = cell.cap.min(jerk::steady(&most, axes)) * scale * scale;
            let by = |d: usize, power: i32| most[d].map(|m| m / scale.powi(power));
            spans.push(JerkSpan {
                cell: i,
                scale,
                width: cell.width * scale,
                most: [by(0, 1), by(1, 2), by(2, 3)],
                cap,
            });
        }
        knots.push(f64::INFINITY);
        let side = |j: Option<usize>| j.and_then(|j| spans.get(j)).map_or(f64::INFINITY, |s: &JerkSpan| s.cap);
        for (i, knot) in knots.iter_mut().enumerate() {
            *knot = knot.min(side(i.checked_sub(1)).min(side(Some(i))));
        }
        Self { spans, knots }
    }

    /// Divides the cells where changes of speed need more knots.
    fn divided(&self, limits: &RunLimits) -> DividedChain {
        let mut at = vec![0.0];
        for s in &self.spans {
            at.push(at.last().copied().unwrap_or(0.0) + s.width);
        }
        let even = |s: &JerkSpan| {
            let least = |most: &Joint5| (0..5).map(|k| most[k] / s.most[0][k]).fold(f64::INFINITY, f64::min);
            Even { cap: s.cap, acceleration: least(&limits.acceleration), jerk: least(&limits.jerk) }
        };
        let y = within_accelerations(limits, &self.spans, &self.knots);
        let (fine, ramps) = ramp::resolve(&at, &y, &self.spans.iter().map(even).collect::<Vec<_>>());
        let mut spans: Vec<JerkSpan> = Vec::with_capacity(fine.len());
        let mut knots = vec![self.knots[0]];
        for pair in fine.windows(2) {
            let whole = &self.spans[pair[1].1 as usize];
            spans.push(JerkSpan { width: pair[1].0 - pair[0].0, ..whole.clone() });
            // A knot inside of a cell has the cap of the cell.
            let end = pair[1].1 as usize + 1;
            knots.push(if pair[1].0 >= at[end] { self.knots[end] } else { whole.cap });
        }
        DividedChain { chain: Self { spans, knots }, at: fine.iter().map(|k| k.0).collect(), ramps }
    }

    /// Upper bound of y of each span within the accelerations.
    fn upper_bounds(&self, limits: &RunLimits) -> Vec<f64> {
        let Self { spans, knots } = self;
        let y = within_accelerations(limits, spans, knots);
        let mean = |i: usize| 0.5 * (y[i] + y[i + 1]);
        (0..spans.len()).map(|i| mean(i).min(knots[i]).min(knots[i + 1]).min(spans[i].cap)).collect()
    }
}

/// The run from one rest to the next.
fn moving(limits: &RunLimits, cells: &[MotionCell]) -> Vec<MovePart> {
    let axes = feedrate::Limits { speed: limits.speed, acceleration: limits.acceleration, jerk: limits.jerk };
    let DividedChain { chain, at, ramps } = SpanChain::new(limits, &axes, cells).divided(limits);
    let bounds = chain.upper_bounds(limits);
    let guess = ramp::guess(&at, &bounds, &ramps);
    let whole = chain.spans;
    let n = whole.len();
    // Start from rest, and stop.
    let slowest = 0.9 * bounds.iter().copied().fold(f64::INFINITY, f64::min).sqrt();
    let half = if n == 1 { 0.25 } else { 0.5 };
    let mut spans = whole.clone();
    for still in [false, true] {
        let creep = |i: usize, rate: f64| Creep::new(&whole[i].most, &axes, rate, half * whole[i].width, still);
        let rate = creep(0, slowest).rate.min(creep(n - 1, slowest).rate);
        let ends = [creep(0, rate), creep(n - 1, rate)];
        spans.clone_from(&whole);
        spans[0].width -= ends[0].way;
        spans[n - 1].width -= ends[1].way;
        let widths: Vec<f64> = spans.iter().map(|s| s.width).collect();
        let rows = JerkRows { spans: &spans, limits: axes };
        let accelerations = [ends[0].acceleration, ends[1].acceleration];
        let Some(c) = jerk::limit(&widths, &bounds, &guess, rate * rate, accelerations, &rows) else { continue };
        let mut parts: Vec<MovePart> = (0..n).map(|i| rows.part(i, jerk::over_span(&widths, &c, i))).collect();
        // The factor by which the run was slowed down applies to both ends as well.
        let slower = rate / c[0].sqrt();
        for (i, end) in [(0, &ends[0]), (n - 1, &ends[1])] {
            let part = &mut parts[i];
            part.width += end.way / spans[i].scale;
            part.time += end.time * slower;
        }
        return parts;
    }
    Vec::new()
}
