//! A convex body of revolution over one step, or over a run of steps, with its bounds, against lines along Z.
//!
//! Times run from 0 to 1. What the function of the body does over a piece of that time is bounded from below by its
//! tangents at both ends of the piece, with their bend: for turns are not convex. Where that decides nothing, the piece is
//! divided.

use super::ray::SKIN;
use super::shape::Shape;
use super::sweep::{GAP, Line, Look, Pose, Stretch, Sweep};
use nalgebra::Vector3;

/// Bow from which the time is divided, mm: below it two tangents that meet in between are off by a quarter of it.
const FLAT: f64 = 1e-3;

/// What may be left inside the sweep beyond the end of a chip, as a distance to its surface, mm.
const LEFT: f64 = 6e-4;

/// Newton steps along a ray. Each is a tangent step on a convex function, so that even a grazing ray is at rest far
/// below.
const MOST_NEWTON: u32 = 40;

/// What is taken from a stretch of a line, and the times at which its ends are cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chip {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) times: [f64; 2],
}

/// A body in motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moving {
    pub(super) sweep: Sweep,
    pub(super) shape: Shape,
    /// Speed at which the true motion may leave `sweep` from both of its ends, mm in the unit of time; 0 for a step.
    drift: f64,
    /// Largest turning speed.
    turn: f64,
    /// Largest speed of a point of the body.
    speed: f64,
    /// [`Sweep::bow`] and [`Sweep::twist`] of the body.
    bow: f64,
    twist: f64,
    /// Corners of a box around all of it.
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    /// Pose at half time.
    pub(super) tip: Vector3<f64>,
    pub(super) axis: Vector3<f64>,
    /// Cylinder about the middle pose that holds the whole sweep: heights and radius.
    from: f64,
    to: f64,
    radius: f64,
    /// Unit vector across way and axis.
    pub(super) side: Vector3<f64>,
    /// Poses at start and end.
    ends: [Pose; 2],
}

impl Moving {
    pub(super) fn new(sweep: Sweep, shape: Shape, drift: f64) -> Self {
        let (from, to, radius) = shape.extent();
        let reach = from.abs().max(to.abs()) + radius;
        let poses = [0.0, 0.5, 1.0].map(|t| sweep.pose(t));
        let [(_, start), (tip, axis), (_, end)] = poses;
        let (way, turn) = (sweep.way().norm(), sweep.turn());
        let (bow, twist) = (sweep.bow(reach + way), sweep.twist(reach + way));
        // Points run on arcs between the three poses.
        let sag = 0.125 * bow + 0.5 * drift + 1e-6;
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for (tip, axis) in poses {
            for k in 0..3 {
                let wide = radius * (1.0 - axis[k] * axis[k]).max(0.0).sqrt() + sag;
                let (a, b) = (tip[k] + axis[k] * from, tip[k] + axis[k] * to);
                low[k] = low[k].min(a.min(b) - wide);
                high[k] = high[k].max(a.max(b) + wide);
            }
        }
        let moved = 0.5 * way + (start - axis).norm().max((end - axis).norm()) * reach + sag;
        let across = axis.cross(sweep.way());
        // A plunge has no side: any will do.
        let side = across.try_normalize(0.05 * way + 1e-12).unwrap_or_else(|| {
            let least = axis.iamin();
            let mut unit = Vector3::zeros();
            unit[least] = 1.0;
            axis.cross(&unit).normalize()
        });
        let (from, to, radius) = (from - moved, to + moved, radius + moved);
        let ends = [sweep.stand(0.0), sweep.stand(1.0)];
        let speed = way + turn * reach + drift;
        Self { sweep, shape, drift, turn, speed, bow, twist, low, high, tip, axis, from, to, radius, side, ends }
    }

    /// By how much depths below its surface may be wrong, mm.
    pub(super) fn error(&self) -> f64 {
        self.bow + 0.5 * self.drift
    }

    /// Part of a line that can lie within `lateral` of the sweep.
    pub(super) fn window(&self, line: &Line, lateral: f64) -> Option<[f64; 2]> {
        let w = line.point(0.0) - self.tip;
        let (along, s0) = (self.axis.z, w.dot(&self.axis));
        let a = 1.0 - along * along;
        let b = w.z - s0 * along;
        let radius = self.radius + lateral;
        let c = w.norm_squared() - s0 * s0 - radius * radius;
        let (mut low, mut high) = (self.low[2] - lateral, self.high[2] + lateral);
        if a > 1e-9 {
            let root = b * b - a * c;
            if root < 0.0 {
                return None;
            }
            let (middle, half) = (-b / a, root.sqrt() / a);
            (low, high) = (low.max(middle - half), high.min(middle + half));
        } else if c > 1e-3 {
            return None;
        }
        if along.abs() > 1e-6 {
            let (p, q) = ((self.from - lateral - s0) / along, (self.to + lateral - s0) / along);
            (low, high) = (low.max(p.min(q)), high.min(p.max(q)));
        }
        (low < high).then_some([low, high])
    }

    /// True when no point within `lateral` of the stretch a..b of a line can lie inside the sweep.
    pub(super) fn clear(&self, line: &Line, [a, b]: [f64; 2], lateral: f64, guess: &mut f64) -> bool {
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
            // Where the tangents meet lies below the least.
            let share = db / (db - da);
            return first.f * share + last.f * (1.0 - share) + (b - a) * share * da > limit;
        }
        false
    }

    /// True when the sweep takes nothing from lines within `lateral` that have material from `starts` on, `sign` telling
    /// the direction, and none of it inside of the body at its start: from there on it moves away.
    pub(super) fn behind(&self, line: &Line, starts: [f64; 2], sign: f64, lateral: f64) -> bool {
        let reach = lateral.hypot(0.5 * (starts[1] - starts[0]));
        let p = line.point(0.5 * (starts[0] + starts[1]));
        let look = self.ends[0].look(&self.shape, line, 0.5 * (starts[0] + starts[1]));
        if look.slope <= 0.0 || look.rise * sign <= self.turn {
            return false;
        }
        let (rho, s) = self.sweep.at_start(&p);
        let bend = self.shape.bend(rho, s, reach);
        let speed = self.sweep.way().norm() + self.turn * (rho.hypot(s) + reach);
        look.slope > bend * speed + self.turn * reach + self.bow + self.drift && look.rise * sign > bend + self.turn
    }

    /// True when nothing is taken of the stretch of material a..b. The end of time that settled the last question is
    /// asked first, and told.
    #[inline]
    pub(super) fn leaves(&self, line: &Line, [a, b]: [f64; 2], settled: &mut usize) -> bool {
        let piece = Piece { moving: self, line, times: [0.0, 1.0], poses: &self.ends };
        let first = *settled;
        if matches!(piece.verdict([a, b], first), Verdict::Untouched) {
            return true;
        }
        *settled = 1 - first;
        matches!(piece.verdict([a, b], 1 - first), Verdict::Untouched)
    }

    /// Adds what the sweep takes of the stretch of material a..b.
    pub(super) fn cut(&self, line: &Line, [a, b]: [f64; 2], settled: &mut usize, chips: &mut Vec<Chip>) {
        let (a, b) = (a.max(self.low[2]), b.min(self.high[2]));
        if a < b {
            Piece { moving: self, line, times: [0.0, 1.0], poses: &self.ends }.cut([a, b], settled, chips);
        }
    }

    /// Place of the deepest point inside the sweep on a stretch, and its depth; `None` when none is deeper than `least`.
    pub(super) fn deepest(&self, line: &Line, [a, b]: [f64; 2], least: f64, guess: &mut f64) -> Option<(f64, f64)> {
        let look = |x: f64, guess: f64| self.sweep.least(&self.shape, line, x, [0.0, 1.0], guess, f64::INFINITY);
        let (mut low, mut high) = ((a, look(a, *guess)), (b, look(b, *guess)));
        *guess = low.1.t;
        let mut best = if low.1.f < high.1.f { (low.0, low.1.f) } else { (high.0, high.1.f) };
        // Tangents again, now along the ray.
        for k in 0..MOST_NEWTON {
            let (da, db) = (low.1.rise, high.1.rise);
            if da >= 0.0 || db <= 0.0 {
                break;
            }
            let share = db / (db - da);
            let bound = (low.1.f - da * low.0) * share + (high.1.f - db * high.0) * (1.0 - share);
            if bound > -least || best.1 - bound < GAP {
                break;
            }
            let x = if k % 2 == 0 {
                low.0 + (high.0 - low.0) * (1.0 - share)
            } else {
                (high.1.f - low.1.f + da * low.0 - db * high.0) / (da - db)
            };
            let middle = (x.clamp(low.0, high.0), look(x.clamp(low.0, high.0), low.1.t));
            if middle.1.f < best.1 {
                best = (middle.0, middle.1.f);
            }
            if middle.1.rise > 0.0 { high = middle } else { low = middle }
        }
        (-best.1 > least).then_some((best.0, -best.1))
    }
}

/// A body against a line over a piece of its time.
struct Piece<'a> {
    moving: &'a Moving,
    line: &'a Line,
    times: [f64; 2],
    poses: &'a [Pose; 2],
}

/// What one end of the time tells about a stretch of material.
enum Verdict {
    /// Nothing is taken of it.
    Untouched,
    /// This is taken.
    Cut(Chip),
    /// Not known; the place where the body is nearest, or leaves.
    Open { x: f64, inside: bool },
}

impl Piece<'_> {
    fn span(&self) -> f64 {
        self.times[1] - self.times[0]
    }

    /// [`Sweep::bow`] of a stretch.
    fn bow(&self, [a, b]: [f64; 2]) -> f64 {
        let span = self.span();
        let far = |z: f64| (self.line.point(z) - self.poses[0].tip()).norm();
        self.moving.sweep.bow(far(a).max(far(b)) + self.moving.speed * span) * span * span
    }

    /// Least over time at a place of a look from one end of the time.
    #[inline(always)]
    fn bound(&self, look: &Look, end: usize) -> f64 {
        let span = self.span();
        let run = if end == 0 { span } else { -span };
        // A parabola over the share of the time.
        let slope = look.slope * run - (self.moving.drift + self.moving.twist * span * span) * span;
        let bend = look.bend * span * span;
        let far = slope + bend;
        if slope < 0.0 && bend > -0.5 * slope { look.f - 0.25 * slope * slope / bend } else { look.f + far.min(0.0) }
    }

    /// What the pose at one end of the time tells about the stretch a..b.
    #[inline]
    fn verdict(&self, [a, b]: [f64; 2], end: usize) -> Verdict {
        let (pose, shape) = (&self.poses[end], &self.moving.shape);
        let look = |x: f64| pose.look(shape, self.line, x);
        let turn = self.moving.turn * self.span();
        match pose.stretch(shape, self.line, [a, b], self.moving.speed * self.span()) {
            Stretch::Away => Verdict::Untouched,
            Stretch::Inside([low, high]) if high <= a || low >= b => {
                let (near, sign) = if high <= a { (a, 1.0) } else { (b, -1.0) };
                let look = look(near);
                let leaving = look.rise * sign - turn;
                let untouched = leaving >= 0.0 && self.bound(&look, end) > -LEFT;
                if untouched { Verdict::Untouched } else { Verdict::Open { x: near, inside: false } }
            }
            Stretch::Inside([low, high]) => {
                // Where the body only leaves from both its ends, no other time reaches farther.
                for (x, inner, sign) in [(high, high < b, 1.0), (low, low > a, -1.0)] {
                    if inner {
                        let look = look(x);
                        if look.rise * sign < turn || self.bound(&look, end) < -LEFT {
                            return Verdict::Open { x, inside: true };
                        }
                    }
                }
                Verdict::Cut(Chip { from: low.max(a), to: high.min(b), times: [self.times[end]; 2] })
            }
            Stretch::Near { x, within } => {
                let look = look(x);
                let rise = look.rise;
                let along = ((turn - rise).max(0.0) * (within[1] - x)).max((turn + rise).max(0.0) * (x - within[0]));
                if self.bound(&look, end) > along { Verdict::Untouched } else { Verdict::Open { x, inside: false } }
            }
        }
    }

    /// Adds what is taken of the stretch a..b.
    fn cut(&self, [a, b]: [f64; 2], settled: &mut usize, chips: &mut Vec<Chip>) {
        let mut nearest = 0.5 * (a + b);
        let first = *settled;
        for end in [first, 1 - first] {
            match self.verdict([a, b], end) {
                Verdict::Open { x, inside } if inside || end == first => nearest = x,
                Verdict::Open { .. } => {}
                Verdict::Untouched => {
                    *settled = end;
                    return;
                }
                Verdict::Cut(chip) => {
                    *settled = end;
                    if chip.to - chip.from > SKIN {
                        chips.push(chip);
                    }
                    return;
                }
            }
        }
        if self.bow([a, b]) > FLAT {
            self.divide([a, b], nearest, settled, chips);
        } else if let Some(chip) = self.cut_from_both([a, b]) {
            chips.push(chip);
        }
    }

    /// The same in two pieces of the time.
    fn divide(&self, [a, b]: [f64; 2], x: f64, settled: &mut usize, chips: &mut Vec<Chip>) {
        // Where the body comes nearest to the place, by the slopes there.
        let [sa, sb] = [0, 1].map(|end: usize| self.poses[end].look(&self.moving.shape, self.line, x).slope);
        let share = if sa < 0.0 && sb > 0.0 { (sa / (sa - sb)).clamp(0.2, 0.8) } else { 0.5 };
        let t = self.times[0] + share * self.span();
        let middle = self.moving.sweep.stand(t);
        let first = Piece { times: [self.times[0], t], poses: &[self.poses[0], middle], ..*self };
        let second = Piece { times: [t, self.times[1]], poses: &[middle, self.poses[1]], ..*self };
        let before = chips.len();
        first.cut([a, b], settled, chips);
        let after = chips.len();
        chips[before..after].sort_by(|x, y| x.from.total_cmp(&y.from));
        let mut from = a;
        for n in before..after {
            let Chip { from: start, to, .. } = chips[n];
            if start > from + SKIN {
                second.cut([from, start], settled, chips);
            }
            from = to;
        }
        if b > from + SKIN {
            second.cut([from, b], settled, chips);
        }
    }

    /// What is taken of a stretch by tangents from both ends of it, as if the body were convex in place and time.
    fn cut_from_both(&self, [a, b]: [f64; 2]) -> Option<Chip> {
        let (shape, turn) = (&self.moving.shape, self.moving.turn * self.span());
        let least =
            |x: f64, guess: f64, cutoff: f64| self.moving.sweep.least(shape, self.line, x, self.times, guess, cutoff);
        let guess = 0.5 * (self.times[0] + self.times[1]);
        let first = least(a, guess, GAP);
        let leaving = first.rise - turn;
        if leaving >= 0.0 && (first.f > GAP || -first.f < SKIN * leaving) {
            return None;
        }
        let last = least(b, first.t, GAP);
        let leaving = -last.rise - turn;
        if leaving >= 0.0 && (last.f > GAP || -last.f < SKIN * leaving) {
            return None;
        }
        // Tangent steps from an end that lies outside, steeper by the turn. Should one end inside all the same, it is
        // taken back by the secant, which lies between.
        let approach = |mut x: f64, mut look: Look, sign: f64| {
            let mut outside: Option<(f64, f64)> = None;
            for _ in 0..MOST_NEWTON {
                match outside {
                    _ if look.f.abs() <= GAP => return Some((x, look.t)),
                    None if look.f < 0.0 => return Some((x, look.t)),
                    Some((far, f)) if look.f < 0.0 => x += (far - x) * look.f / (look.f - f),
                    _ => {
                        outside = Some((x, look.f));
                        let down = look.rise * sign - turn;
                        if down >= 0.0 {
                            return None;
                        }
                        x -= sign * look.f / down;
                    }
                }
                if !(a..=b).contains(&x) {
                    return None;
                }
                look = least(x, look.t, f64::INFINITY);
            }
            Some((x, look.t))
        };
        let (from, t_from) = approach(a, first, 1.0)?;
        let (to, t_to) = approach(b, last, -1.0)?;
        (to - from > SKIN).then_some(Chip { from, to, times: [t_from, t_to] })
    }
}
