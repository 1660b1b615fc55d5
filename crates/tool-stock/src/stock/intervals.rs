//! What a body in motion removes of the intervals of material on a group of lines.
//!
//! Each interval is queried for the whole time from both ends of the time. An undecided interval is queried at the time
//! when the body is nearest, then for the times before and after, and so on. Queries of all intervals are combined,
//! eight at once; the removed parts are united at the end.

use super::lanes::{self, Answers, EndQuestion, LANES, Lanes, Lines, Question};
use super::moving::{MAX_NEWTON, Moving};
use super::ray::SKIN;
use super::reach::{ReachQuestion, StepLanes};
use super::sweep::{RayLine, SEARCH_GAP_MM, StepQuery};

/// Bow below which a piece of time is not divided, mm: two tangents that intersect inside have an error of a quarter of
/// it.
const MAX_BOW_MM: f64 = 1e-3;

/// A part removed from a ray, and the times at which its ends are cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chip {
    pub(super) line: RayLine,
    /// Index of the ray in its group.
    pub(super) ray: u8,
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) times: [f64; 2],
}

/// Intervals of material, as columns.
pub(super) struct Intervals {
    x: Vec<f64>,
    y: Vec<f64>,
    a: Vec<f64>,
    b: Vec<f64>,
    ray: Vec<u8>,
    /// Undecided intervals.
    open: Vec<Open>,
    /// Intervals that the last round of queries did not decide.
    unsettled: Vec<Open>,
    /// Removed parts, interval by interval.
    parts: Vec<IntervalPart>,
    /// Parts removed from the rays since the last [`Self::clear`].
    pub(super) chips: Vec<Chip>,
    vectors: pulp::Arch,
}

/// An undecided interval over a piece of time.
#[derive(Clone, Copy)]
struct Open {
    interval: usize,
    times: [f64; 2],
    /// Derivatives by time where the body is nearest: at both ends of the piece, and at the last queried time.
    slopes: [f64; 2],
    slope: f64,
    /// Time of the next query.
    t: f64,
}

/// A part removed from an interval, and the times at which its ends are cut.
#[derive(Clone, Copy)]
struct IntervalPart {
    interval: usize,
    from: f64,
    to: f64,
    times: [f64; 2],
}

impl Default for Intervals {
    fn default() -> Self {
        Self {
            x: Vec::new(),
            y: Vec::new(),
            a: Vec::new(),
            b: Vec::new(),
            ray: Vec::new(),
            open: Vec::new(),
            unsettled: Vec::new(),
            parts: Vec::new(),
            chips: Vec::new(),
            vectors: pulp::Arch::new(),
        }
    }
}

impl Intervals {
    pub(super) fn clear(&mut self) {
        self.keep(0);
        self.chips.clear();
    }

    /// Drops all intervals except the first `count`.
    fn keep(&mut self, count: usize) {
        self.x.truncate(count);
        self.y.truncate(count);
        self.a.truncate(count);
        self.b.truncate(count);
        self.ray.truncate(count);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Adds an interval of a ray.
    pub(super) fn push(&mut self, line: &RayLine, ray: u8, [a, b]: [f64; 2]) {
        self.x.push(line.x);
        self.y.push(line.y);
        self.a.push(a);
        self.b.push(b);
        self.ray.push(ray);
    }

    /// Which steps may reach the intervals on all lines within `lateral` of their middle. The window is what a body may meet;
    /// on both sides of the place where it is nearest, the material is bounded for itself.
    pub(super) fn reached(&self, steps: &StepLanes, middle: &RayLine, lateral: f64, window: [f64; 2]) -> [bool; LANES] {
        let mut reached = [false; LANES];
        let twice = window[0] + window[1];
        for upper in [false, true] {
            let mut within = [f64::INFINITY, f64::NEG_INFINITY];
            for (a, b) in self.a.iter().zip(&self.b).filter(|(a, b)| (*a + *b > twice) == upper) {
                within = [within[0].min(*a), within[1].max(*b)];
            }
            if within[0] < within[1] {
                let found = self.vectors.dispatch(ReachQuestion { steps, line: middle, lateral, within });
                reached.iter_mut().zip(found).for_each(|(all, one)| *all |= one);
            }
        }
        reached
    }

    /// Drops the intervals from which the body removes nothing.
    pub(super) fn sift(&mut self, moving: &Moving) {
        self.ask_ends(moving, false);
        // The undecided intervals are in ascending order: no entry is overwritten before it is moved.
        for (kept, open) in self.unsettled.iter().enumerate() {
            let n = open.interval;
            (self.x[kept], self.y[kept], self.ray[kept]) = (self.x[n], self.y[n], self.ray[n]);
            (self.a[kept], self.b[kept]) = (self.a[n], self.b[n]);
        }
        self.keep(self.unsettled.len());
    }

    /// Removes what the body sweeps, and adds it to the chips.
    pub(super) fn cut(&mut self, moving: &Moving) {
        self.parts.clear();
        self.ask_ends(moving, true);
        for open in &mut self.unsettled {
            open.t = open.inside();
        }
        std::mem::swap(&mut self.open, &mut self.unsettled);
        while !self.open.is_empty() {
            self.ask(moving);
            self.open.clear();
            for k in 0..self.unsettled.len() {
                self.divide(moving, self.unsettled[k]);
            }
        }
        self.unite();
    }

    /// Queries all intervals for the whole time, first from its end, then the undecided rest from its start. The order never
    /// depends on other queries: where both ends decide, it decides about the last digits.
    fn ask_ends(&mut self, moving: &Moving, take: bool) {
        let count = self.x.len();
        let all = |n: usize| Open { interval: n, times: [0.0, 1.0], slopes: [0.0; 2], slope: 0.0, t: 1.0 };
        self.unsettled.clear();
        for start in (0..count).step_by(LANES) {
            let lanes = LANES.min(count - start);
            let mut lines = Lines::default();
            for (lane, column) in
                [&mut lines.x, &mut lines.y, &mut lines.a, &mut lines.b].into_iter().zip(self.columns())
            {
                lane[..lanes].copy_from_slice(&column[start..start + lanes]);
            }
            let answers = self.vectors.dispatch(EndQuestion { moving, lines: &lines, end: 1 });
            self.sort_out(&answers, take, (start..start + lanes).map(all));
        }
        std::mem::swap(&mut self.open, &mut self.unsettled);
        self.unsettled.clear();
        let mut open = std::mem::take(&mut self.open);
        for open in open.chunks_mut(LANES) {
            let mut lines = Lines::default();
            for (i, open) in open.iter_mut().enumerate() {
                open.slopes[1] = open.slope;
                open.t = 0.0;
                let n = open.interval;
                (lines.x[i], lines.y[i], lines.a[i], lines.b[i]) = (self.x[n], self.y[n], self.a[n], self.b[n]);
            }
            let answers = self.vectors.dispatch(EndQuestion { moving, lines: &lines, end: 0 });
            self.sort_out(&answers, take, open.iter().copied());
        }
        self.open = open;
        for open in &mut self.unsettled {
            open.slopes[0] = open.slope;
        }
    }

    /// Places and ends of the intervals.
    fn columns(&self) -> [&[f64]; 4] {
        [&self.x, &self.y, &self.a, &self.b]
    }

    /// Keeps the removed parts of answers, and lists the intervals that remain undecided.
    fn sort_out(&mut self, answers: &Answers, take: bool, asked: impl Iterator<Item = Open>) {
        for (i, open) in asked.enumerate() {
            match answers.state[i] {
                lanes::UNTOUCHED => {}
                lanes::CUT if take => {
                    let (from, to) = (answers.from[i], answers.to[i]);
                    self.parts.push(IntervalPart { interval: open.interval, from, to, times: [open.t; 2] });
                }
                _ => self.unsettled.push(Open { slope: answers.slope[i], ..open }),
            }
        }
    }

    /// Queries all undecided intervals, keeps the removed parts, and lists the intervals that remain undecided.
    fn ask(&mut self, moving: &Moving) {
        self.unsettled.clear();
        let mut next = 0;
        while next < self.open.len() {
            let (mut lanes, mut who, mut count) = (Lanes::default(), [0; LANES], 0);
            while next < self.open.len() && count < LANES {
                let open = &self.open[next];
                let n = open.interval;
                let [a, b] = moving.part([self.a[n], self.b[n]]);
                if a < b {
                    (lanes.x[count], lanes.y[count], lanes.a[count], lanes.b[count]) = (self.x[n], self.y[n], a, b);
                    (lanes.start[count], lanes.end[count], lanes.t[count]) = (open.times[0], open.times[1], open.t);
                    who[count] = next;
                    count += 1;
                }
                next += 1;
            }
            if count == 0 {
                return;
            }
            let answers = self.vectors.dispatch(Question { moving, lanes: &lanes });
            let asked = who.map(|n| self.open[n.min(self.open.len() - 1)]);
            self.sort_out(&answers, true, asked.into_iter().take(count));
        }
    }

    /// Divides the time of an undecided interval into pieces for further queries.
    fn divide(&mut self, moving: &Moving, open: Open) {
        let n = open.interval;
        let line = RayLine { x: self.x[n], y: self.y[n] };
        let part = moving.part([self.a[n], self.b[n]]);
        if open.bow(moving, &line, part) < MAX_BOW_MM {
            if let Some(([from, to], times)) = cut_from_both(moving, open.times, &line, part) {
                self.parts.push(IntervalPart { interval: n, from, to, times });
            }
            return;
        }
        let [start, end] = open.times;
        if open.t == start || open.t == end {
            self.open.push(Open { t: open.inside(), ..open });
            return;
        }
        let middle = open.t;
        let mut push = |piece: Open| self.open.push(Open { t: piece.nearest(), ..piece });
        push(Open { times: [start, middle], slopes: [open.slopes[0], open.slope], ..open });
        push(Open { times: [middle, end], slopes: [open.slope, open.slopes[1]], ..open });
    }

    /// Removes all parts; overlapping parts count as one.
    fn unite(&mut self) {
        self.parts.retain(|p| p.to - p.from > SKIN);
        // From the far end, so that the material beyond a part is not processed again.
        self.parts.sort_unstable_by(|p, q| p.interval.cmp(&q.interval).then(q.to.total_cmp(&p.to)));
        let mut next = 0;
        while let Some(&first) = self.parts.get(next) {
            let mut whole = first;
            next += 1;
            while let Some(p) = self.parts.get(next).filter(|p| p.interval == whole.interval && p.to >= whole.from) {
                if p.from < whole.from {
                    (whole.from, whole.times[0]) = (p.from, p.times[0]);
                }
                next += 1;
            }
            let IntervalPart { interval: n, from, to, times } = whole;
            let line = RayLine { x: self.x[n], y: self.y[n] };
            self.chips.push(Chip { line, ray: self.ray[n], from, to, times });
            let (head, tail) = (from > self.a[n] + SKIN, to < self.b[n] - SKIN);
            if head && tail {
                self.push(&line, self.ray[n], [to, self.b[n]]);
            }
            match (head, tail) {
                (true, _) => self.b[n] = from,
                (_, true) => self.a[n] = to,
                _ => self.b[n] = self.a[n],
            }
        }
    }
}

impl Open {
    /// Time at which the body is nearest.
    fn nearest(&self) -> f64 {
        match self.slopes.map(|s| s < 0.0) {
            [true, true] => self.times[1],
            [false, false] => self.times[0],
            _ => self.inside(),
        }
    }

    /// The same for a linear derivative, at some distance from both ends.
    fn inside(&self) -> f64 {
        let [a, b] = self.slopes;
        let share = if a < 0.0 && b > 0.0 { (a / (a - b)).clamp(0.1, 0.9) } else { 0.5 };
        self.times[0] + share * (self.times[1] - self.times[0])
    }

    /// [`super::sweep::Sweep::bow`] for an interval.
    fn bow(&self, moving: &Moving, line: &RayLine, [a, b]: [f64; 2]) -> f64 {
        let span = self.times[1] - self.times[0];
        let tip = moving.sweep.pose(self.times[0]).0;
        let far = |z: f64| (line.point(z) - tip).norm_squared();
        let far = far(a).max(far(b)).sqrt();
        moving.sweep.bow(far + moving.speed * span) * span * span
    }
}

/// The part removed from an interval, by tangents from both of its ends, as if the body were convex in place and time.
fn cut_from_both(moving: &Moving, times: [f64; 2], line: &RayLine, [a, b]: [f64; 2]) -> Option<([f64; 2], [f64; 2])> {
    let (shape, turn) = (&moving.shape, moving.turn * (times[1] - times[0]));
    let least = |x: f64, guess: f64, cutoff: f64| moving.sweep.least(shape, line, x, times, guess, cutoff);
    let guess = 0.5 * (times[0] + times[1]);
    let first = least(a, guess, SEARCH_GAP_MM);
    let leaving = first.rise - turn;
    if leaving >= 0.0 && (first.f > SEARCH_GAP_MM || -first.f < SKIN * leaving) {
        return None;
    }
    let last = least(b, first.t, SEARCH_GAP_MM);
    let leaving = -last.rise - turn;
    if leaving >= 0.0 && (last.f > SEARCH_GAP_MM || -last.f < SKIN * leaving) {
        return None;
    }
    // Tangent steps from an end outside of the body, steeper by the turn. If a step still ends inside, a secant brings
    // it back.
    let approach = |mut x: f64, mut query: StepQuery, sign: f64| {
        let mut outside: Option<(f64, f64)> = None;
        for _ in 0..MAX_NEWTON {
            match outside {
                _ if query.f.abs() <= SEARCH_GAP_MM => return Some((x, query.t)),
                None if query.f < 0.0 => return Some((x, query.t)),
                Some((far, f)) if query.f < 0.0 => x += (far - x) * query.f / (query.f - f),
                _ => {
                    outside = Some((x, query.f));
                    let down = query.rise * sign - turn;
                    if down >= 0.0 {
                        return None;
                    }
                    x -= sign * query.f / down;
                }
            }
            if !(a..=b).contains(&x) {
                return None;
            }
            query = least(x, query.t, f64::INFINITY);
        }
        Some((x, query.t))
    };
    let (from, t_from) = approach(a, first, 1.0)?;
    let (to, t_to) = approach(b, last, -1.0)?;
    Some(([from, to], [t_from, t_to]))
}
