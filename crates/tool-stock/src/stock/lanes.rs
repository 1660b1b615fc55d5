//! Queries about eight intervals of material at once: what a body at one pose removes over a piece of time.
//!
//! Loops over lanes have no branches, so that the compiler vectorises them. No operation is reordered or fused: results
//! are the same, bit by bit, for vectors of any width.

use super::moving::Moving;
use super::shape::{RadiusProfile, RadiusValue, Round, SolidShape};
use super::sweep::{RayLine, StepPose, StepQuery};

/// Reserve for rounding, mm.
const LENGTH_ROUNDING_MM: f64 = 1e-9;

/// Number of intervals per query.
pub(super) const LANES: usize = 8;

/// A number for each interval.
pub(super) type Lane = [f64; LANES];

/// Depth of material that may remain inside the sweep beyond the end of a chip, as a distance to the surface, mm.
const LEFT: f64 = 6e-4;

/// Intervals of lines along Z, from `a` to `b`; the piece of time of the query, and the time of the pose.
#[derive(Default)]
pub(super) struct Lanes {
    pub(super) x: Lane,
    pub(super) y: Lane,
    pub(super) a: Lane,
    pub(super) b: Lane,
    pub(super) start: Lane,
    pub(super) end: Lane,
    pub(super) t: Lane,
}

/// Intervals of lines along Z, from `a` to `b`.
#[derive(Default)]
pub(super) struct Lines {
    pub(super) x: Lane,
    pub(super) y: Lane,
    pub(super) a: Lane,
    pub(super) b: Lane,
}

/// Position of a body relative to a line.
pub(super) struct LaneHit {
    /// Part of the line inside of the body; `high` is below `low` when the line misses the body.
    pub(super) low: f64,
    pub(super) high: f64,
    /// Part of the interval that the body may reach, and approximately the place where it is nearest.
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) nearest: f64,
}

/// The body removes nothing of the interval.
pub(super) const UNTOUCHED: u64 = 0;
/// The body removes the part inside.
pub(super) const CUT: u64 = 1;
/// Undecided.
pub(super) const UNDECIDED: u64 = 2;
/// As [`CUT`], if the lower end of the part is confirmed as well.
const HALF_CUT: u64 = 3;

/// Result of a query: what one pose decides about the intervals over the piece of time.
#[derive(Default)]
pub(super) struct Answers {
    pub(super) state: [u64; LANES],
    /// The removed part.
    pub(super) from: Lane,
    pub(super) to: Lane,
    /// Derivative by time at the evaluated place: where the body is nearest, or where it leaves the line.
    pub(super) slope: Lane,
}

/// Least value over a time before or after of a parabola with a value, slope and second derivative, less linear and
/// cubic terms with the factors `drift` and `twist`.
#[inline(always)]
pub(super) fn least(query: &StepQuery, run: f64, drift: f64, twist: f64) -> f64 {
    let square = run * run;
    let slope = query.slope * run - (drift + twist * square) * run.abs();
    let second = query.second * square;
    let far = slope + second;
    let dips = (slope < 0.0) & (second > -0.5 * slope);
    let dip = -0.25 * slope * slope / if dips { second } else { 1.0 };
    query.f + if dips { dip } else { smaller(far, 0.0) }
}

/// The smaller of two numbers, neither of which is NaN; unlike `min` a single instruction.
#[inline(always)]
pub(super) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger of two numbers, neither of which is NaN.
#[inline(always)]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// A query about a moving body.
pub(super) struct Question<'a> {
    pub(super) moving: &'a Moving,
    pub(super) lanes: &'a Lanes,
}

/// Run by [`pulp::Arch::dispatch`], which compiles the query for the vectors of the processor.
impl pulp::WithSimd for Question<'_> {
    type Output = Answers;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Answers {
        match self.moving.shape {
            SolidShape::Flat { radius, top } => self.answers(&Round::<false> { radius, top }),
            SolidShape::Ball { radius, top } if top > 2.0 * radius => self.answers(&Round::<true> { radius, top }),
            shape => self.answers(&shape),
        }
    }
}

impl Question<'_> {
    #[inline(always)]
    fn answers(&self, body: &impl Standing) -> Answers {
        let Self { moving, lanes } = self;
        let mut answers = Answers::default();
        for i in 0..LANES {
            let pose = moving.sweep.stand(lanes.t[i]);
            let line = RayLine { x: lanes.x[i], y: lanes.y[i] };
            let (back, ahead) = (lanes.start[i] - lanes.t[i], lanes.end[i] - lanes.t[i]);
            let times = Times { span: larger(-back, ahead), back, ahead };
            answers.set(i, answer(body, moving, &pose, &line, [lanes.a[i], lanes.b[i]], &times));
        }
        for i in 0..LANES {
            if answers.state[i] == HALF_CUT {
                let pose = moving.sweep.stand(lanes.t[i]);
                let (back, ahead) = (lanes.start[i] - lanes.t[i], lanes.end[i] - lanes.t[i]);
                let times = Times { span: larger(-back, ahead), back, ahead };
                answers.confirm(i, body, moving, &pose, &RayLine { x: lanes.x[i], y: lanes.y[i] }, &times);
            }
        }
        answers
    }
}

/// A query about the whole time of a moving body from one of its ends, the same for all lanes.
pub(super) struct EndQuestion<'a> {
    pub(super) moving: &'a Moving,
    pub(super) lines: &'a Lines,
    /// 0 for the start and 1 for the end of the time.
    pub(super) end: usize,
}

impl pulp::WithSimd for EndQuestion<'_> {
    type Output = Answers;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Answers {
        match self.moving.shape {
            SolidShape::Flat { radius, top } => self.answers(&Round::<false> { radius, top }),
            SolidShape::Ball { radius, top } if top > 2.0 * radius => self.answers(&Round::<true> { radius, top }),
            shape => self.answers(&shape),
        }
    }
}

impl EndQuestion<'_> {
    #[inline(always)]
    fn answers(&self, body: &impl Standing) -> Answers {
        let Self { moving, lines, end } = self;
        let pose = &moving.ends[*end];
        let run = OneRun(if *end == 0 { 1.0 } else { -1.0 });
        let mut answers = Answers::default();
        for i in 0..LANES {
            let line = RayLine { x: lines.x[i], y: lines.y[i] };
            let (a, b) = (larger(lines.a[i], moving.low[2]), smaller(lines.b[i], moving.high[2]));
            let mut found = answer(body, moving, pose, &line, [a, b], &run);
            found.state = if a < b { found.state } else { UNTOUCHED };
            answers.set(i, found);
        }
        for i in 0..LANES {
            if answers.state[i] == HALF_CUT {
                answers.confirm(i, body, moving, pose, &RayLine { x: lines.x[i], y: lines.y[i] }, &run);
            }
        }
        answers
    }
}

/// The time that a query covers, from the time of its pose.
trait Runs {
    /// The longer one of the times before and after.
    fn span(&self) -> f64;
    /// Least value over the time.
    fn least(&self, query: &StepQuery, moving: &Moving) -> f64;
}

/// Times before and after.
struct Times {
    span: f64,
    back: f64,
    ahead: f64,
}

impl Runs for Times {
    #[inline(always)]
    fn span(&self) -> f64 {
        self.span
    }

    #[inline(always)]
    fn least(&self, query: &StepQuery, moving: &Moving) -> f64 {
        let least = |run: f64| least(query, run, moving.drift, moving.twist);
        smaller(least(self.back), least(self.ahead))
    }
}

/// The whole time to one side; to the other side there is none, where the value itself is the least.
struct OneRun(f64);

impl Runs for OneRun {
    #[inline(always)]
    fn span(&self) -> f64 {
        1.0
    }

    #[inline(always)]
    fn least(&self, query: &StepQuery, moving: &Moving) -> f64 {
        smaller(query.f, least(query, self.0, moving.drift, moving.twist))
    }
}

/// Result of a query about one interval.
struct OneAnswer {
    state: u64,
    slope: f64,
    from: f64,
    to: f64,
}

impl Answers {
    #[inline(always)]
    fn set(&mut self, i: usize, one: OneAnswer) {
        (self.state[i], self.slope[i], self.from[i], self.to[i]) = (one.state, one.slope, one.from, one.to);
    }

    /// Confirms the lower end of a part, or leaves the interval undecided.
    #[inline(always)]
    fn confirm(
        &mut self,
        i: usize,
        body: &impl Standing,
        moving: &Moving,
        pose: &StepPose,
        line: &RayLine,
        runs: &impl Runs,
    ) {
        let query = pose.query(body, line, self.from[i]);
        let leaves = -query.rise >= moving.turn * runs.span() && runs.least(&query, moving) > -LEFT;
        self.state[i] = if leaves { CUT } else { UNDECIDED };
        self.slope[i] = query.slope;
    }
}

/// Largest fall along a line of a plane at a place, which turns by `turn`, over a part of the line.
#[inline(always)]
pub(super) fn fall(query: &StepQuery, turn: f64, x: f64, [from, to]: [f64; 2]) -> f64 {
    let rising = larger(turn - query.rise, 0.0) * (to - x);
    let falling = larger(turn + query.rise, 0.0) * (x - from);
    larger(rising, falling)
}

/// What a body at one pose decides about an interval.
#[inline(always)]
fn answer(
    body: &impl Standing,
    moving: &Moving,
    pose: &StepPose,
    line: &RayLine,
    [a, b]: [f64; 2],
    runs: &impl Runs,
) -> OneAnswer {
    let LaneHit { low, high, from, to, nearest } = body.stand(pose, line, [a, b], moving.speed * runs.span());
    let inside = low < high;
    let (before, after) = (high <= a, low >= b);
    let outside = inside & (before | after);
    let through = inside & !(before | after);
    let (upper, lower) = (high < b, low > a);
    // The place to evaluate: the end of the interval on the side of the body, the end of the part inside, or
    // the nearest place.
    let x = larger(smaller(nearest, to), from);
    let x = if outside { if before { a } else { b } } else { x };
    let x = if through { if upper { high } else { low } } else { x };
    let sign = if outside & before | through & upper { 1.0 } else { -1.0 };
    let query = pose.query(body, line, x);
    let turn = moving.turn * runs.span();
    let least = runs.least(&query, moving);
    // Where the body leaves the line at this time, it reaches farther at no other time.
    let leaves = (query.rise * sign >= turn) & (least > -LEFT);
    let part = [from, to];
    let level = body.level(pose, line, x, &query);
    let away = (from >= to)
        | (least > fall(&query, turn, x, part))
        | (runs.least(&level, moving) > fall(&level, turn, x, part));
    let settled = if inside { leaves } else { away };
    let untouched = if settled { UNTOUCHED } else { UNDECIDED };
    let cut = if upper & lower { HALF_CUT } else { CUT };
    let cut = if leaves | !(upper | lower) { cut } else { UNDECIDED };
    OneAnswer {
        state: if through { cut } else { untouched },
        slope: if inside { query.slope } else { level.slope },
        from: larger(low, a),
        to: smaller(high, b),
    }
}

/// A body with its position relative to a line.
pub(super) trait Standing: RadiusProfile {
    /// `from` and `to` bound the part that the body may reach while no point of it moves farther than `margin`.
    fn stand(&self, pose: &StepPose, line: &RayLine, interval: [f64; 2], margin: f64) -> LaneHit;

    /// A plane below the function that rises as little as possible along a line, from a query at a place: where the line passes
    /// an edge, one face rises along it and the other falls.
    #[inline(always)]
    fn level(&self, _pose: &StepPose, _line: &RayLine, _x: f64, query: &StepQuery) -> StepQuery {
        *query
    }
}

/// The side of a cutter without its ends.
struct Side {
    radius: f64,
}

impl RadiusProfile for Side {
    #[inline(always)]
    fn at(&self, rho: f64, _: f64) -> RadiusValue {
        RadiusValue { f: rho - self.radius, by_rho: 1.0, by_s: 0.0 }
    }
}

/// The space over the plane at the tip.
struct Bottom;

impl RadiusProfile for Bottom {
    #[inline(always)]
    fn at(&self, _: f64, s: f64) -> RadiusValue {
        RadiusValue { f: -s, by_rho: 0.0, by_s: -1.0 }
    }
}

impl Standing for SolidShape {
    #[inline(always)]
    fn stand(&self, pose: &StepPose, line: &RayLine, [from, to]: [f64; 2], _margin: f64) -> LaneHit {
        let ([low, high], nearest) = pose.interval_by_tangents(self, line, [from, to]);
        LaneHit { low, high, from, to, nearest }
    }
}

impl<const BALL: bool> Standing for Round<BALL> {
    #[inline(always)]
    fn stand(&self, pose: &StepPose, line: &RayLine, [a, b]: [f64; 2], margin: f64) -> LaneHit {
        const FAR: f64 = f64::INFINITY;
        let (radius, top) = (self.radius, self.top);
        let along = pose.axis.z;
        let (crosses, tilted) = (pose.by_square > 0.0, pose.by_along != 0.0);
        let d = line.point(0.0) - pose.tip;
        let (s, far) = (d.dot(&pose.axis), d.norm_squared());
        // The cylinder: squared distance from its axis, less its squared radius.
        let (across, off) = (d.z - s * along, far - s * s - radius * radius);
        let root = across * across - pose.square * off;
        let centre = if crosses { -across * pose.by_square } else { 0.5 * (a + b) };
        let half = if crosses { larger(root, 0.0).sqrt() * pose.by_square } else { FAR };
        let meets = if crosses { root > 0.0 } else { off < 0.0 };
        let (low, high) = if meets { (centre - half, centre + half) } else { (FAR, -FAR) };
        // The space between two planes across the axis.
        let planes = |from: f64, to: f64| {
            let (p, q) = ((from - s) * pose.by_along, (to - s) * pose.by_along);
            let flat = if (s > from) & (s < to) { FAR } else { -FAR };
            (if tilted { smaller(p, q) } else { -flat }, if tilted { larger(p, q) } else { flat })
        };
        let (bottom, end) = planes(if BALL { radius } else { 0.0 }, top);
        let (mut low, mut high) = (larger(low, bottom), smaller(high, end));
        let mut nearest = larger(smaller(centre, end), bottom);
        if !BALL {
            // Past the edge, between the side and the plane.
            nearest = if meets & (low >= high) { 0.5 * (low + high) } else { nearest };
        }
        if BALL {
            let middle = radius * along - d.z;
            let root = middle * middle - far + 2.0 * radius * s;
            let half = larger(root, 0.0).sqrt();
            // The ball lies inside of the convex hull: both intervals touch, or one is empty.
            let hull = low < high;
            let (l, h) = (if hull { low } else { FAR }, if hull { high } else { -FAR });
            let below = s + along * nearest <= radius + LENGTH_ROUNDING_MM;
            nearest = if (root <= 0.0) & below { middle } else { nearest };
            low = if root > 0.0 { smaller(l, middle - half) } else { low };
            high = if root > 0.0 { larger(h, middle + half) } else { high };
        }
        // The part that the body may reach.
        let wider = margin * (2.0 * radius + margin);
        let wider_root = root + pose.square * wider;
        let half = if crosses { larger(wider_root, 0.0).sqrt() * pose.by_square } else { FAR };
        let may = if crosses { wider_root > 0.0 } else { off < wider };
        let (bottom, end) = planes(-margin, top + margin);
        let from = larger(larger(a, bottom), centre - half);
        let to = smaller(smaller(b, end), centre + half);
        LaneHit { low, high, from, to: if may { to } else { -FAR }, nearest }
    }

    #[inline(always)]
    fn level(&self, pose: &StepPose, line: &RayLine, x: f64, query: &StepQuery) -> StepQuery {
        if BALL {
            return *query;
        }
        let (side, bottom) = (pose.query(&Side { radius: self.radius }, line, x), pose.query(&Bottom, line, x));
        let opposed = (side.rise < 0.0) != (bottom.rise < 0.0);
        // A mean of both lies below the larger one.
        let share = bottom.rise / if opposed { bottom.rise - side.rise } else { 1.0 };
        let mean = |a: f64, b: f64, own: f64| if opposed { b + (a - b) * share } else { own };
        StepQuery {
            f: mean(side.f, bottom.f, query.f),
            rise: mean(side.rise, bottom.rise, query.rise),
            slope: mean(side.slope, bottom.slope, query.slope),
            second: mean(side.second, bottom.second, query.second),
            t: query.t,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sweep::StepSweep;
    use super::*;
    use nalgebra::Vector3;

    /// Vectors of any width give the same bits.
    #[test]
    fn vectors_change_no_bit() {
        let axis = |a: f64| Vector3::new(a.sin() * 0.6, 0.8 * a.sin(), a.cos());
        let tips = [Vector3::new(1.0, 2.0, -1.0), Vector3::new(2.5, 2.4, -1.2)];
        let sweep = StepSweep::through(tips, [0.3, 0.31, 0.325].map(axis));
        let mut states = [0; 4];
        for shape in [SolidShape::Flat { radius: 3.0, top: 20.0 }, SolidShape::Ball { radius: 3.0, top: 20.0 }] {
            let moving = Moving::new(sweep, shape, 0.0);
            for k in 0..200 {
                let at = |i: usize, f: f64| (f64::from(k) * f + i as f64).sin();
                let low: Lane = std::array::from_fn(|i| 6.0 * at(i, 1.9));
                let lanes = Lanes {
                    x: std::array::from_fn(|i| 1.7 + 6.0 * at(i, 0.7)),
                    y: std::array::from_fn(|i| 2.2 + 6.0 * at(i, 1.3)),
                    a: low,
                    b: low.map(|z| z + 5.0),
                    start: [0.0; LANES],
                    end: [1.0; LANES],
                    t: std::array::from_fn(|i| 0.5 + 0.5 * at(i, 0.1)),
                };
                let ask = |arch: pulp::Arch| arch.dispatch(Question { moving: &moving, lanes: &lanes });
                let (one, many) = (ask(pulp::Arch::Scalar), ask(pulp::Arch::new()));
                assert_eq!(one.state, many.state);
                for (a, b) in [(one.from, many.from), (one.to, many.to), (one.slope, many.slope)] {
                    assert_eq!(a.map(f64::to_bits), b.map(f64::to_bits), "{shape:?} {k}");
                }
                one.state.iter().for_each(|s| states[*s as usize] += 1);
            }
        }
        assert!(states[..3].iter().all(|n| *n > 50), "{states:?}");
    }

    /// Against places and times all over the material that a decided interval keeps.
    #[test]
    fn little_is_left_inside() {
        let axis = |a: f64| Vector3::new(a.sin() * 0.6, 0.8 * a.sin(), a.cos());
        let tips = [Vector3::new(1.0, 2.0, -1.0), Vector3::new(1.9, 2.4, -1.2)];
        let sweep = StepSweep::through(tips, [0.3, 0.31, 0.325].map(axis));
        let mut states = [0; 3];
        for shape in [SolidShape::Flat { radius: 3.0, top: 20.0 }, SolidShape::Ball { radius: 3.0, top: 20.0 }] {
            let moving = Moving::new(sweep, shape, 0.0);
            for k in 0..400 {
                let at = |i: usize, f: f64| (f64::from(k) * f + i as f64).sin();
                let low: Lane = std::array::from_fn(|i| 6.0 * at(i, 1.9) - 3.0);
                let (x, y) =
                    (std::array::from_fn(|i| 1.7 + 4.0 * at(i, 0.7)), std::array::from_fn(|i| 2.2 + 4.0 * at(i, 1.3)));
                let lines = Lines { x, y, a: low, b: low.map(|z| z + 4.0) };
                for end in [0, 1] {
                    let said = pulp::Arch::new().dispatch(EndQuestion { moving: &moving, lines: &lines, end });
                    for i in 0..LANES {
                        states[said.state[i] as usize] += 1;
                        let removed = if said.state[i] == CUT { [said.from[i], said.to[i]] } else { [f64::MAX; 2] };
                        if said.state[i] == UNDECIDED {
                            continue;
                        }
                        for (t, z) in (0..=20).flat_map(|t| (0..=40).map(move |z| (t, z))) {
                            let z = lines.a[i] + 0.1 * f64::from(z);
                            if removed[0] <= z && z <= removed[1] {
                                continue;
                            }
                            let pose = sweep.stand(0.05 * f64::from(t));
                            let depth = -pose.query(&shape, &RayLine { x: x[i], y: y[i] }, z).f;
                            assert!(depth < LEFT + LENGTH_ROUNDING_MM, "{shape:?} {k} {i} {end} {t} {z}: {depth}");
                        }
                    }
                }
            }
        }
        assert!(states.iter().all(|n| *n > 100), "{states:?}");
    }
}
