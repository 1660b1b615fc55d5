//! Fastest run of five axes through stations, within speed, acceleration and jerk of every axis and never above the
//! process feed.
//!
//! **Feasible feed of a block.** F is feasible for a block if there is a run through all blocks of the operation, from
//! rest to rest, with the following properties. Corners are rounded by no more than the tolerance of the control. In
//! this block the tip reaches F. No axis exceeds its speed, acceleration or jerk anywhere. F is the largest feed of the
//! block in this run. Where the run is slower inside of the block, the control slows down by its own look-ahead.
//!
//! 1. `path`: corners are rounded in a closed form; between knots joints are cubic polynomials.
//! 2. `passes`: the time-optimal run within speed and acceleration, by two passes over the knots.
//! 3. [`jerk`]: a slower run that keeps the jerk, proved over each span by Bernstein coefficients.
//!
//! Methods: Pham and Pham, TOPP-RA, 2018 (two passes); the rows of jerk with an upper bound of sqrt(y) as in the feed
//! scheduling by linear programs of Fan, Gao, Zhang and Erkorkmaz. The time of step 2 is a lower bound of that of step
//! 3.

mod bound;
pub mod jerk;
mod passes;
mod path;
pub mod ramp;

use jerk::{Bounds, Rows};
use path::{PathSpan, SpeedPath};
use ramp::{Creep, Even, Most, Ramp};
use rayon::prelude::*;
use std::ops::Range;

/// Share by which rounding may exceed a limit.
const LIMIT_ROUNDING: f64 = 1e-12;

/// Share by which a product that reaches its bound may exceed it by rounding.
const AT_BOUND: f64 = 1e-9;

/// Axes: X, Y, Z and both rotary axes.
pub const AXES: usize = 5;

/// A value for each axis: mm or radians, with seconds in speeds, accelerations and jerks.
pub type Axes = [f64; AXES];

/// Least number of spans that one thread prepares.
const CHUNK: usize = 4096;

/// Largest share of the jerk that the curvature of a steady run may take.
const CURVATURE: f64 = 0.8;

/// A place that the axes run through.
#[derive(Clone, Copy, Debug)]
pub struct Station {
    /// Joints.
    pub joints: Axes,
    /// Tip on the part, mm.
    pub tip: [f64; 3],
    /// Least time from the previous station, s, by the process feed.
    pub time: f64,
}

/// Limits of the axes.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Speed.
    pub speed: Axes,
    /// Acceleration.
    pub acceleration: Axes,
    /// Jerk; infinite where there is no limit.
    pub jerk: Axes,
}

/// Limits of the rounding of corners.
#[derive(Clone, Copy, Debug)]
pub struct Rounding {
    /// Largest distance of tip or flutes from the corner, mm.
    pub tolerance: f64,
    /// Length of the flutes, mm.
    pub height: f64,
}

/// Run of a segment between two stations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Time, s.
    pub time: f64,
    /// Largest speed, as a share of the speed at the least time.
    pub share: f64,
}

/// A span of the run.
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    /// Segment: index of the station at its end.
    pub segment: u32,
    /// Start, in the parameter s of the path.
    pub from: f64,
    /// Length, in the parameter s of the path.
    pub width: f64,
    /// Bernstein coefficients of the first derivatives of the joints by s.
    pub rate: [Axes; 3],
    /// Bernstein coefficients of (ds/dt)^2.
    pub y: [f64; 3],
}

impl Leg {
    /// Upper bound of ds/dt.
    fn most(&self) -> f64 {
        self.y.iter().fold(0.0_f64, |a, b| a.max(*b)).sqrt()
    }
}

/// Result of [`plan`].
#[derive(Clone, Debug)]
pub struct Profile {
    /// Segments; the first leads to the first station and has no motion.
    pub segments: Vec<Segment>,
    /// Total time, s.
    pub time: f64,
    /// Time within speeds and accelerations only, s: a lower bound for every run along this path with a limit of jerk.
    pub least: f64,
    /// Largest share of the limits of speed, acceleration and jerk for each axis, by bounds over whole spans.
    pub shares: [Axes; 3],
    /// Spans in order, without the first and the last part of the path, in which the axes start from and come to rest.
    pub legs: Vec<Leg>,
    /// Length of these two parts, in s of the path, and the time of each, s.
    pub creep: [[f64; 2]; 2],
}

/// The spans of a run as rows of the jerk.
struct SpanRows<'a> {
    spans: &'a [PathSpan],
    limits: &'a Limits,
    /// For each span and axis the largest |q'|, |q''| and |q'''|.
    most: Vec<Most>,
}

impl<'a> SpanRows<'a> {
    fn new(spans: &'a [PathSpan], limits: &'a Limits) -> Self {
        let most = |s: &PathSpan| {
            let seconds: [[f64; 2]; AXES] = std::array::from_fn(|k| s.second(k));
            [
                std::array::from_fn(|k| s.most_rate(k)),
                seconds.map(|[a, b]| a.abs().max(b.abs())),
                std::array::from_fn(|k| s.twist(k).abs()),
            ]
        };
        Self { spans, limits, most: spans.par_iter().with_min_len(CHUNK).map(most).collect() }
    }
}

impl SpanRows<'_> {
    /// Largest acceleration and jerk of an axis over a span.
    fn largest(&self, span: usize, k: usize, y: &[f64; 3]) -> [f64; 2] {
        let s = &self.spans[span];
        let r = s.rate.map(|r| r[k]);
        let [second, end] = s.second(k);
        let twist = s.twist(k);
        let [slope, last] = [2.0 * (y[1] - y[0]) / s.width, 2.0 * (y[2] - y[1]) / s.width];
        let turn = (last - slope) / s.width;
        // q'' y + q' y'/2, of degree three.
        let a = [
            second * y[0] + 0.5 * r[0] * slope,
            (end * y[0] + 2.0 * second * y[1]) / 3.0 + 0.5 * (r[0] * last + 2.0 * r[1] * slope) / 3.0,
            (2.0 * end * y[1] + second * y[2]) / 3.0 + 0.5 * (2.0 * r[1] * last + r[2] * slope) / 3.0,
            end * y[2] + 0.5 * r[2] * last,
        ];
        // q''' y + 3/2 q'' y' + q' y''/2, of degree two.
        let j = [
            twist * y[0] + 1.5 * second * slope + 0.5 * r[0] * turn,
            twist * y[1] + 0.75 * (second * last + end * slope) + 0.5 * r[1] * turn,
            twist * y[2] + 1.5 * end * last + 0.5 * r[2] * turn,
        ];
        let most = |all: &[f64]| all.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        [most(&a), most(&j) * most(y).sqrt()]
    }
}

impl Rows for SpanRows<'_> {
    fn bounds(&self, span: usize, most: f64, steep: f64, share: f64) -> Bounds {
        Bounds::new(&self.most[span], self.limits, most, steep, share)
    }

    fn shares(&self, span: usize, y: &[f64; 3]) -> [f64; 2] {
        let mut most = [0.0_f64; 2];
        for k in 0..AXES {
            let [acceleration, jerk] = self.largest(span, k, y);
            most[0] = most[0].max(acceleration / self.limits.acceleration[k]);
            most[1] = most[1].max(jerk / self.limits.jerk[k]);
        }
        // Products that reach their bound may exceed it by rounding.
        most.map(|m| if m < 1.0 + AT_BOUND { m.min(1.0) } else { m })
    }
}

/// Square of the largest rate of the parameter in a span, by process feed and axis speeds.
fn cap(span: &PathSpan, feed: f64, speed: &Axes) -> f64 {
    (0..AXES).map(|k| speed[k] / span.most_rate(k)).fold(feed, f64::min).powi(2)
}

/// Largest y at each knot, from the spans beside it.
fn knot_caps(caps: &[f64]) -> Vec<f64> {
    let side = |j: Option<usize>| j.and_then(|j| caps.get(j)).copied().unwrap_or(f64::INFINITY);
    (0..=caps.len()).map(|i| side(i.checked_sub(1)).min(side(Some(i)))).collect()
}

/// Knots with the spans between them.
struct SpeedGrid {
    knots: Vec<(f64, u32)>,
    spans: Vec<PathSpan>,
    caps: Vec<f64>,
}

impl SpeedGrid {
    fn new(path: &SpeedPath, knots: Vec<(f64, u32)>, speed: &Axes) -> Self {
        let spans: Vec<PathSpan> =
            knots.par_windows(2).with_min_len(CHUNK).map(|pair| path.span(pair[1].1, pair[0].0, pair[1].0)).collect();
        let caps = spans.iter().zip(&knots[1..]).map(|(s, k)| cap(s, path.rate[k.1 as usize], speed)).collect();
        Self { knots, spans, caps }
    }

    fn places(&self) -> Vec<f64> {
        self.knots.iter().map(|k| k.0).collect()
    }

    /// The knots with the additional knots for changes of speed, and these changes.
    fn resolved(&self, y: &[f64], limits: &Limits) -> (Vec<(f64, u32)>, Vec<Ramp>) {
        let even = |(span, cap): (&PathSpan, &f64)| {
            let least = |most: &Axes| (0..AXES).map(|k| most[k] / span.most_rate(k)).fold(f64::INFINITY, f64::min);
            Even { cap: *cap, acceleration: least(&limits.acceleration), jerk: least(&limits.jerk) }
        };
        let spans: Vec<Even> = self.spans.iter().zip(&self.caps).map(even).collect();
        let (mut knots, ramps) = ramp::resolve(&self.places(), y, &spans);
        for knot in &mut knots {
            knot.1 = self.knots[knot.1 as usize + 1].1;
        }
        (knots, ramps)
    }

    /// Reduces the largest y of each span to the value that acceleration and jerk allow for a steady run.
    fn keep_steady(&mut self, limits: &Limits) {
        let rows = SpanRows::new(&self.spans, limits);
        for (i, cap) in self.caps.iter_mut().enumerate() {
            *cap = cap.min(jerk::steady(&rows.most[i], limits));
        }
    }
}

/// Plans the fastest run from rest to rest through stations. A station with the same joints as its predecessor takes
/// its least time without motion. Every time must be positive.
pub fn plan(stations: &[Station], limits: &Limits, rounding: &Rounding) -> Profile {
    let mut profile = Profile {
        segments: stations.iter().map(|s| Segment { time: s.time, share: 1.0 }).collect(),
        time: 0.0,
        least: 0.0,
        shares: [[0.0; AXES]; 3],
        legs: Vec::new(),
        creep: [[0.0; 2]; 2],
    };
    for moving in between_standstills(stations) {
        let run = Run::new(&stations[moving.clone()], limits, rounding);
        profile.least += run.least_time(limits);
        profile.creep = run.creep;
        settle(&run, limits, moving.start, &mut profile);
    }
    // The first station of each part but the first is a standstill.
    for i in standstills(stations) {
        profile.time += stations[i].time;
        profile.least += stations[i].time;
    }
    if let Some(segment) = profile.segments.first_mut() {
        *segment = Segment { time: 0.0, share: 0.0 };
    }
    profile
}

/// The largest speed of each segment in the run that [`plan`] finds, as a share of the speed at the least time of the
/// segment; 0 for the first, which has no motion.
pub fn speed_shares(stations: &[Station], limits: &Limits, rounding: &Rounding) -> Vec<f64> {
    let mut shares = vec![1.0; stations.len()];
    for moving in between_standstills(stations) {
        let run = Run::new(&stations[moving.clone()], limits, rounding);
        let shares = &mut shares[moving];
        shares[1..].fill(0.0);
        for leg in &run.legs {
            let share: &mut f64 = &mut shares[leg.segment as usize];
            *share = share.max(run.share(leg));
        }
    }
    if let Some(share) = shares.first_mut() {
        *share = 0.0;
    }
    shares
}

/// Stations with the joints of their predecessors: a standstill divides the path, and the run comes to rest there.
fn standstills(stations: &[Station]) -> impl Iterator<Item = usize> {
    (1..stations.len()).filter(|i| stations[*i].joints == stations[*i - 1].joints)
}

/// The stations between standstills, as far as the axes move there.
fn between_standstills(stations: &[Station]) -> impl Iterator<Item = Range<usize>> {
    let mut first = 0;
    standstills(stations).chain([stations.len()]).filter_map(move |end| {
        let moving = std::mem::replace(&mut first, end)..end;
        (moving.len() > 1).then_some(moving)
    })
}

/// A run through stations that all differ from their predecessors.
struct Run {
    path: SpeedPath,
    grid: SpeedGrid,
    legs: Vec<Leg>,
    /// Length and time of its start from rest and of its end to rest.
    creep: [[f64; 2]; 2],
}

impl Run {
    fn new(stations: &[Station], limits: &Limits, rounding: &Rounding) -> Self {
        let path = SpeedPath::new(stations, &limits.acceleration, rounding);
        let mut grid = SpeedGrid::new(&path, path.knots(), &limits.speed);
        let limited = limits.jerk.iter().any(|j| j.is_finite());
        if limited {
            grid.keep_steady(limits);
        }
        let y = passes::run(&grid.spans, &limits.acceleration, &knot_caps(&grid.caps));
        let (knots, ramps) = grid.resolved(&y, limits);
        grid = SpeedGrid::new(&path, knots, &limits.speed);
        if limited {
            grid.keep_steady(limits);
        }
        let y = passes::run(&grid.spans, &limits.acceleration, &knot_caps(&grid.caps));
        let mut legs: Vec<Leg> = Vec::with_capacity(grid.spans.len());
        let creep = if limited {
            smooth(&path, &grid, &y, &ramps, limits, &mut legs)
        } else {
            legs.extend(grid.spans.iter().enumerate().map(|(i, span)| Leg {
                segment: grid.knots[i + 1].1,
                from: grid.knots[i].0,
                width: span.width,
                rate: span.rate,
                y: [y[i], 0.5 * (y[i] + y[i + 1]), y[i + 1]],
            }));
            [[0.0; 2]; 2]
        };
        Self { path, grid, legs, creep }
    }

    /// Lower bound of the time of every run along this path.
    fn least_time(&self, limits: &Limits) -> f64 {
        let feeds: Vec<f64> = self.grid.knots[1..].iter().map(|k| self.path.rate[k.1 as usize].powi(2)).collect();
        bound::least_time(&self.grid.spans, limits, &feeds)
    }

    /// Largest speed of a leg, as a share of the speed at the least time of its segment.
    fn share(&self, leg: &Leg) -> f64 {
        (leg.most() / self.path.rate[leg.segment as usize]).min(1.0)
    }
}

/// The run within the jerk: adds its legs; returns length and time of its start from rest and of its end to rest.
fn smooth(
    path: &SpeedPath,
    grid: &SpeedGrid,
    y: &[f64],
    ramps: &[Ramp],
    limits: &Limits,
    legs: &mut Vec<Leg>,
) -> [[f64; 2]; 2] {
    let n = grid.spans.len();
    // Both spans at a knot share its upper bound.
    let caps = knot_caps(&grid.caps);
    let ceiling: Vec<f64> = (0..n).map(|i| (0.5 * (y[i] + y[i + 1])).min(caps[i]).min(caps[i + 1])).collect();
    let guess = ramp::guess(&grid.places(), &ceiling, ramps);
    let slowest = ceiling.iter().copied().fold(f64::INFINITY, f64::min).sqrt();
    let half = if n == 1 { 0.25 } else { 0.5 };
    for still in [false, true] {
        let rows = SpanRows::new(&grid.spans, limits);
        let creep = |i: usize, rate: f64| Creep::new(&rows.most[i], limits, rate, half * grid.spans[i].width, still);
        let rate = creep(0, 0.9 * slowest).rate.min(creep(n - 1, 0.9 * slowest).rate);
        let [start, end] = [creep(0, rate), creep(n - 1, rate)];
        // The parts in which the axes start from and come to rest are not part of the spline.
        let (knots, mut spans) = (&grid.knots, grid.spans.clone());
        let (from, to) = (knots[0].0 + start.way, knots[n].0 - end.way);
        spans[0] = path.span(knots[1].1, from, if n == 1 { to } else { knots[1].0 });
        if n > 1 {
            spans[n - 1] = path.span(knots[n].1, knots[n - 1].0, to);
        }
        let widths: Vec<f64> = spans.iter().map(|s| s.width).collect();
        let rows = SpanRows::new(&spans, limits);
        let accelerations = [start.acceleration, end.acceleration];
        let Some(c) = jerk::limit(&widths, &ceiling, &guess, rate * rate, accelerations, &rows) else { continue };
        for (i, span) in spans.iter().enumerate() {
            let y = jerk::over_span(&widths, &c, i);
            let from = if i == 0 { from } else { knots[i].0 };
            legs.push(Leg { segment: knots[i + 1].1, from, width: span.width, rate: span.rate, y });
        }
        // Where the whole run had to slow down, these parts keep their length and take more time.
        let slower = rate / c[0].sqrt();
        return [[start.way, start.time * slower], [end.way, end.time * slower]];
    }
    [[0.0; 2]; 2]
}

/// Computes times, speeds and shares of a run from station `first` on.
fn settle(run: &Run, limits: &Limits, first: usize, profile: &mut Profile) {
    let Run { path, legs, .. } = run;
    let spans: Vec<PathSpan> = legs.iter().map(|l| path.span(l.segment, l.from, l.from + l.width)).collect();
    let rows = SpanRows::new(&spans, limits);
    for segment in &mut profile.segments[first + 1..first + path.at.len()] {
        *segment = Segment { time: 0.0, share: 0.0 };
    }
    for (i, leg) in legs.iter().enumerate() {
        let most = leg.most();
        let time = jerk::time(leg.width, leg.y);
        let segment = &mut profile.segments[first + leg.segment as usize];
        segment.time += time;
        segment.share = segment.share.max(run.share(leg));
        for k in 0..AXES {
            let [acceleration, jerk] = rows.largest(i, k, &leg.y);
            let shares = [
                most * rows.spans[i].most_rate(k) / limits.speed[k],
                acceleration / limits.acceleration[k],
                jerk / limits.jerk[k],
            ];
            for (most, share) in profile.shares.iter_mut().zip(shares) {
                most[k] = most[k].max(share);
            }
        }
        profile.time += time;
    }
    let ends = [legs.first(), legs.last()];
    for (leg, [_, time]) in ends.into_iter().flatten().zip(run.creep) {
        profile.segments[first + leg.segment as usize].time += time;
        profile.time += time;
    }
    profile
        .legs
        .extend(legs.iter().map(|leg| Leg { segment: leg.segment + u32::try_from(first).unwrap_or(0), ..*leg }));
}
