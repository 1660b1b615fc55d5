//! A square of 64 x 64 parallel rays, with maps of where along them material is left: one of groups of 4 x 4 rays, one
//! of groups of 16 x 16.

use super::ray::{Ray, SKIN};
use super::shape::Shape;
use super::sweep::{GAP, Look, Pose, Sweep};
use super::{Step, StepKind};
use nalgebra::Vector3;

/// Rays along an edge of a tile.
pub(super) const SIDE: usize = 64;

/// Rays along an edge of a fine group, and fine groups along an edge of a coarse one.
const GROUP: usize = 4;

/// Fine groups along an edge of a tile.
const FINE: usize = SIDE / GROUP;

/// Coarse groups along an edge of a tile.
const COARSE: usize = FINE / GROUP;

/// Rays of a fine group.
const MEMBERS: usize = GROUP * GROUP;

/// Length along a ray from which a chip tells where the cutter is engaged, mm: shorter ones come from rubbing along a
/// surface that was cut before.
const NOTABLE: f64 = 0.01;

/// Newton steps along a ray. Each is a tangent step on a convex function, so that even a grazing ray is at rest far
/// below.
const MOST_NEWTON: u32 = 40;

/// A body of one tool over one step, with its bounds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moving {
    pub(super) sweep: Sweep,
    pub(super) shape: Shape,
    pub(super) kind: StepKind,
    /// True when the same body has just swept to where this one starts: no material is inside of it there.
    pub(super) follows: bool,
    /// Turn of the axis, radians, a little more: by as much less than convex is the function along a line and in time.
    turn: f64,
    /// Corners of a box around all of it.
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    /// Pose at half time.
    tip: Vector3<f64>,
    axis: Vector3<f64>,
    /// Cylinder about the middle pose that holds the whole sweep: heights and radius.
    from: f64,
    to: f64,
    radius: f64,
    /// Unit vector across way and axis.
    side: Vector3<f64>,
    /// Poses at start and end.
    ends: [Pose; 2],
}

/// Added to bounds for the sag of the arcs that points run on between the three poses: 1e-3 of 100 mm at a degree.
const SAG: f64 = 5e-3;

impl Moving {
    pub(super) fn new(step: &Step, shape: Shape, follows: bool) -> Self {
        let sweep = Sweep::new(step);
        let (from, to, radius) = shape.extent();
        let (tip, axis) = sweep.pose(0.5);
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for t in [0.0, 0.5, 1.0] {
            let (tip, axis) = sweep.pose(t);
            for k in 0..3 {
                let wide = radius * (1.0 - axis[k] * axis[k]).max(0.0).sqrt() + SAG;
                let (a, b) = (tip[k] + axis[k] * from, tip[k] + axis[k] * to);
                low[k] = low[k].min(a.min(b) - wide);
                high[k] = high[k].max(a.max(b) + wide);
            }
        }
        let turn = (step.axes[0] - axis).norm().max((step.axes[2] - axis).norm());
        let whole = 1.01 * ((step.axes[0] - axis).norm() + (step.axes[2] - axis).norm());
        let moved = 0.5 * sweep.way().norm() + turn * (from.abs().max(to.abs()) + radius) + SAG;
        let across = axis.cross(sweep.way());
        // A plunge has no side: any will do.
        let side = across.try_normalize(0.05 * sweep.way().norm() + 1e-12).unwrap_or_else(|| {
            let least = axis.iamin();
            let mut unit = Vector3::zeros();
            unit[least] = 1.0;
            axis.cross(&unit).normalize()
        });
        let (from, to, radius) = (from - moved, to + moved, radius + moved);
        let ends = [sweep.stand(0.0), sweep.stand(1.0)];
        Self { ends, sweep, shape, kind: step.kind, follows, turn: whole, low, high, tip, axis, from, to, radius, side }
    }

    /// Part of a line along an axis that can lie within `lateral` of the sweep; `o` has zero along the axis.
    fn window(&self, axis: usize, o: &Vector3<f64>, lateral: f64) -> Option<[f64; 2]> {
        let w = o - self.tip;
        let (along, s0) = (self.axis[axis], w.dot(&self.axis));
        let a = 1.0 - along * along;
        let b = w[axis] - s0 * along;
        let radius = self.radius + lateral;
        let c = w.norm_squared() - s0 * s0 - radius * radius;
        let (mut low, mut high) = (self.low[axis] - lateral, self.high[axis] + lateral);
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
    fn clear(&self, axis: usize, o: &Vector3<f64>, [a, b]: [f64; 2], lateral: f64, guess: &mut f64) -> bool {
        let at = |x: f64| {
            let mut p = *o;
            p[axis] = x;
            p
        };
        let first = self.sweep.least(&self.shape, &at(a), *guess, lateral);
        *guess = first.t;
        if first.f > lateral && first.normal[axis] >= self.turn {
            return true;
        }
        let last = self.sweep.least(&self.shape, &at(b), *guess, lateral);
        *guess = last.t;
        if last.f > lateral && last.normal[axis] <= -self.turn {
            return true;
        }
        let (da, db) = (first.normal[axis] - self.turn, last.normal[axis] + self.turn);
        if da < 0.0 && db > 0.0 {
            // Where the tangents meet lies below the least.
            let share = db / (db - da);
            return first.f * share + last.f * (1.0 - share) + (b - a) * share * da > lateral;
        }
        false
    }

    /// The stretch of material a..b that lies inside the sweep, with the times at its ends; `middle` is about where the
    /// body is.
    fn cut(&self, axis: usize, o: &Vector3<f64>, [a, b]: [f64; 2], middle: f64, guess: &mut f64) -> Option<Chip> {
        let (near, far, sign) = if a >= middle {
            (a, b, 1.0)
        } else if b <= middle {
            (b, a, -1.0)
        } else {
            return self.cut_from_both(axis, o, [a, b], guess);
        };
        let at = |x: f64| {
            let mut p = *o;
            p[axis] = x;
            p
        };
        // Tangents at a look: no place of the material comes deeper than the skin at any time.
        let untouched = |look: &Look| {
            let leaving = look.normal[axis] * sign - self.turn;
            let end = if look.slope > 0.0 { 0.0 } else { 1.0 };
            leaving >= 0.0 && look.f + look.slope * (end - look.t) > -SKIN * leaving
        };
        let first = usize::from(*guess > 0.5);
        let mut inside = false;
        for n in [first, 1 - first] {
            let look = self.ends[n].look(&self.shape, &at(near));
            if untouched(&look) {
                *guess = look.t;
                return None;
            }
            inside |= n == 1 && look.f < 0.0;
        }
        if inside && let Some([low, high]) = self.ends[1].inside(&self.shape, axis, o) {
            let exit = if sign > 0.0 { high } else { low };
            let whole = (exit - far) * sign >= 0.0;
            // Where the body still comes nearer at its end, no other time reaches farther.
            if whole || {
                let look = self.ends[1].look(&self.shape, &at(exit));
                look.slope < GAP && look.f.abs() < GAP
            } {
                *guess = 1.0;
                let exit = if whole { far } else { exit };
                let chip = Chip { from: near.min(exit), to: near.max(exit), times: [1.0; 2] };
                return (chip.to - chip.from > SKIN).then_some(chip);
            }
        }
        self.cut_from_both(axis, o, [a, b], guess)
    }

    /// The same by tangents from both ends of the stretch.
    fn cut_from_both(&self, axis: usize, o: &Vector3<f64>, [a, b]: [f64; 2], guess: &mut f64) -> Option<Chip> {
        let at = |x: f64| {
            let mut p = *o;
            p[axis] = x;
            p
        };
        let least = |x: f64, guess: f64, cutoff: f64| self.sweep.least(&self.shape, &at(x), guess, cutoff);
        let first = least(a, *guess, GAP);
        *guess = first.t;
        let leaving = first.normal[axis] - self.turn;
        if leaving >= 0.0 && (first.f > GAP || -first.f < SKIN * leaving) {
            return None;
        }
        let last = least(b, *guess, GAP);
        let leaving = -last.normal[axis] - self.turn;
        if leaving >= 0.0 && (last.f > GAP || -last.f < SKIN * leaving) {
            *guess = last.t;
            return None;
        }
        // Tangent steps from an end that lies outside, steeper by the turn. Should one end inside all the same, it is
        // taken back by the secant, which lies between.
        let approach = |mut x: f64, mut look: super::sweep::Look, sign: f64| {
            let mut outside: Option<(f64, f64)> = None;
            for _ in 0..MOST_NEWTON {
                match outside {
                    _ if look.f.abs() <= GAP => return Some((x, look.t)),
                    None if look.f < 0.0 => return Some((x, look.t)),
                    Some((far, f)) if look.f < 0.0 => x += (far - x) * look.f / (look.f - f),
                    _ => {
                        outside = Some((x, look.f));
                        let down = look.normal[axis] * sign - self.turn;
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
        *guess = t_from;
        (to - from > SKIN).then_some(Chip { from, to, times: [t_from, t_to] })
    }

    /// True when the sweep takes nothing from the rays of a group that has material from `starts` on, `sign` telling the
    /// direction: at its start the body was outside of all of it, and from there on it moves away.
    fn behind(&self, axis: usize, o: &Vector3<f64>, starts: [f64; 2], sign: f64, lateral: f64) -> bool {
        let reach = lateral.hypot(0.5 * (starts[1] - starts[0]));
        let mut p = *o;
        p[axis] = 0.5 * (starts[0] + starts[1]);
        let look = self.sweep.look(&self.shape, &p, 0.0);
        if look.slope <= 0.0 || look.normal[axis] * sign <= self.turn {
            return false;
        }
        let (rho, s) = self.sweep.at_start(&p);
        let bend = self.shape.bend(rho, s, reach);
        let speed = self.sweep.way().norm() + self.turn * (rho.hypot(s) + reach);
        look.slope > bend * speed + self.turn * reach && look.normal[axis] * sign > bend + self.turn
    }

    /// Place of the deepest point inside the sweep on a stretch, and its depth; `None` when none is deeper than `least`.
    fn deepest(
        &self,
        axis: usize,
        o: &Vector3<f64>,
        [a, b]: [f64; 2],
        least: f64,
        guess: &mut f64,
    ) -> Option<(f64, f64)> {
        let look = |x: f64, guess: f64| {
            let mut p = *o;
            p[axis] = x;
            self.sweep.least(&self.shape, &p, guess, f64::INFINITY)
        };
        let (mut low, mut high) = ((a, look(a, *guess)), (b, look(b, *guess)));
        *guess = low.1.t;
        let mut best = if low.1.f < high.1.f { (low.0, low.1.f) } else { (high.0, high.1.f) };
        // Tangents again, now along the ray.
        for k in 0..MOST_NEWTON {
            let (da, db) = (low.1.normal[axis], high.1.normal[axis]);
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
            if middle.1.normal[axis] > 0.0 { high = middle } else { low = middle }
        }
        (-best.1 > least).then_some((best.0, -best.1))
    }
}

/// What one step takes from one stretch of a ray.
struct Chip {
    from: f64,
    to: f64,
    times: [f64; 2],
}

/// What a block takes from the rays of a tile, or of a family.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Removal {
    /// Length along the rays.
    pub(super) length: f64,
    /// Lowest and highest height over the tip; reversed infinities when nothing notable was removed.
    pub(super) height: [f64; 2],
    /// Extent across way and axis, from the axis.
    pub(super) side: [f64; 2],
}

impl Removal {
    pub(super) const NONE: Self =
        Self { length: 0.0, height: [f64::INFINITY, f64::NEG_INFINITY], side: [f64::INFINITY, f64::NEG_INFINITY] };

    pub(super) fn add(&mut self, other: &Self) {
        self.length += other.length;
        let join = |a: &mut [f64; 2], b: &[f64; 2]| *a = [a[0].min(b[0]), a[1].max(b[1])];
        join(&mut self.height, &other.height);
        join(&mut self.side, &other.side);
    }
}

/// The deepest place of stock inside a part of the tool that must not be there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Overlap {
    pub(super) depth: f64,
    pub(super) point: [f64; 3],
    pub(super) height: f64,
}

/// 64 x 64 rays.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tile {
    axis: usize,
    /// Place of the first ray on the next two axes.
    origin: [f64; 2],
    cell: f64,
    /// Rays along both edges, at most [`SIDE`]; the others are empty.
    count: [usize; 2],
    /// Where the maps begin, and the length of one bit.
    start: f64,
    brick: f64,
    words: usize,
    /// Rays, group by group; none in a tile without material.
    rays: Vec<Ray>,
    fine: Vec<u64>,
    coarse: Vec<u64>,
    /// Least and greatest place of material.
    extent: [f64; 2],
}

/// Index of a ray: groups in rows, and rays in rows inside a group.
fn index(i: usize, j: usize) -> usize {
    (j / GROUP * FINE + i / GROUP) * MEMBERS + j % GROUP * GROUP + i % GROUP
}

/// True when any bit of a run is set.
fn any(words: &[u64], [from, to]: [usize; 2]) -> bool {
    let (first, last) = (from / 64, to / 64);
    let head = u64::MAX << (from % 64);
    let tail = u64::MAX >> (63 - to % 64);
    if first == last {
        return words[first] & head & tail != 0;
    }
    words[first] & head != 0 || words[last] & tail != 0 || words[first + 1..last].iter().any(|w| *w != 0)
}

/// Sets a run of bits.
fn set(words: &mut [u64], [from, to]: [usize; 2]) {
    let (first, last) = (from / 64, to / 64);
    let head = u64::MAX << (from % 64);
    let tail = u64::MAX >> (63 - to % 64);
    if first == last {
        words[first] |= head & tail;
        return;
    }
    words[first] |= head;
    words[last] |= tail;
    words[first + 1..last].fill(u64::MAX);
}

impl Tile {
    /// A tile of `count` rays whose intervals `make` gives.
    pub(super) fn new(
        axis: usize,
        origin: [f64; 2],
        cell: f64,
        depth: [f64; 2],
        count: [usize; 2],
        make: impl Fn(usize, usize) -> Vec<[f64; 2]>,
    ) -> Self {
        let brick = cell * GROUP as f64;
        let words = ((depth[1] - depth[0]) / brick / 64.0).floor() as usize + 1;
        let mut tile = Self {
            axis,
            origin,
            cell,
            count,
            start: depth[0],
            brick,
            words,
            rays: vec![Ray::new(&[]); SIDE * SIDE],
            fine: vec![0; FINE * FINE * words],
            coarse: vec![0; COARSE * COARSE * words],
            extent: [f64::INFINITY, f64::NEG_INFINITY],
        };
        for j in 0..count[1] {
            for i in 0..count[0] {
                tile.rays[index(i, j)] = Ray::new(&make(i, j));
            }
        }
        for group in 0..FINE * FINE {
            tile.map_fine(group);
        }
        for group in 0..COARSE * COARSE {
            tile.map_coarse(group);
        }
        for [a, b] in tile.rays.iter().flat_map(Ray::intervals) {
            tile.extent = [tile.extent[0].min(a), tile.extent[1].max(b)];
        }
        if tile.is_empty() {
            (tile.rays, tile.fine, tile.coarse) = (Vec::new(), Vec::new(), Vec::new());
        }
        tile
    }

    pub(super) fn is_empty(&self) -> bool {
        self.extent[0] >= self.extent[1]
    }

    pub(super) fn ray(&self, i: usize, j: usize) -> Option<&Ray> {
        self.rays.get(index(i, j))
    }

    pub(super) fn rays(&self) -> impl Iterator<Item = &Ray> {
        self.rays.iter()
    }

    /// Length of all material.
    pub(super) fn length(&self) -> f64 {
        self.rays.iter().map(Ray::length).sum()
    }

    /// True when a box can meet material of the tile.
    pub(super) fn meets(&self, low: &[f64; 3], high: &[f64; 3]) -> bool {
        if self.is_empty() || low[self.axis] > self.extent[1] || high[self.axis] < self.extent[0] {
            return false;
        }
        let across = super::field::across(self.axis);
        (0..2).all(|k| {
            let last = self.origin[k] + self.cell * (self.count[k] as f64 - 1.0);
            low[across[k]] <= last && high[across[k]] >= self.origin[k]
        })
    }

    fn bit(&self, x: f64) -> usize {
        // Casts saturate: places outside of the grid give its first or last bit.
        (((x - self.start) / self.brick) as usize).min(self.words * 64 - 1)
    }

    /// Draws the map of a fine group anew.
    fn map_fine(&mut self, group: usize) {
        let mut words = std::mem::take(&mut self.fine);
        let own = &mut words[group * self.words..(group + 1) * self.words];
        own.fill(0);
        for [a, b] in self.rays[group * MEMBERS..(group + 1) * MEMBERS].iter().flat_map(Ray::intervals) {
            set(own, [self.bit(a), self.bit(b)]);
        }
        self.fine = words;
    }

    /// Draws the map of a coarse group anew from its fine ones.
    fn map_coarse(&mut self, group: usize) {
        let own = &mut self.coarse[group * self.words..(group + 1) * self.words];
        own.fill(0);
        let (i, j) = (group % COARSE * GROUP, group / COARSE * GROUP);
        for fine in (0..MEMBERS).map(|k| (j + k / GROUP) * FINE + i + k % GROUP) {
            for (w, f) in own.iter_mut().zip(&self.fine[fine * self.words..]) {
                *w |= f;
            }
        }
    }

    /// Visits the rays that a moving body may meet, each with the line of the ray and the stretch in question; what the
    /// visitor says tells whether the ray was changed.
    fn visit(
        &mut self,
        moving: &Moving,
        mut visitor: impl FnMut(&mut Ray, &Vector3<f64>, [f64; 2], f64, &mut f64) -> bool,
    ) {
        let [u, v] = super::field::across(self.axis);
        // Rays of the tile inside the box of the sweep.
        let span = |k: usize, axis: usize| {
            let first = ((moving.low[axis] - self.origin[k]) / self.cell).ceil().max(0.0) as usize;
            let last = ((moving.high[axis] - self.origin[k]) / self.cell).floor();
            (last >= 0.0).then(|| (first, (last as usize).min(self.count[k] - 1))).filter(|(a, b)| a <= b)
        };
        let (Some(iu), Some(iv)) = (span(0, u), span(1, v)) else { return };
        let (origin, cell) = (self.origin, self.cell);
        let line = |i: f64, j: f64| {
            let mut o = Vector3::zeros();
            o[u] = origin[0] + cell * i;
            o[v] = origin[1] + cell * j;
            o
        };
        let half = |rays: usize| 0.5 * (rays as f64 - 1.0);
        let lateral = |rays: usize| half(rays) * self.cell * std::f64::consts::SQRT_2;
        let (lateral_fine, lateral_coarse) = (lateral(GROUP), lateral(GROUP * GROUP));
        let mut guess = 1.0;
        const WIDE: usize = GROUP * GROUP;
        for cj in iv.0 / WIDE..=iv.1 / WIDE {
            for ci in iu.0 / WIDE..=iu.1 / WIDE {
                let coarse = cj * COARSE + ci;
                let o = line((ci * WIDE) as f64 + half(WIDE), (cj * WIDE) as f64 + half(WIDE));
                let Some([a, b]) = moving.window(self.axis, &o, lateral_coarse) else { continue };
                if !any(&self.coarse[coarse * self.words..][..self.words], [self.bit(a), self.bit(b)]) {
                    continue;
                }
                let mut changed = false;
                for fj in (cj * GROUP).max(iv.0 / GROUP)..=(cj * GROUP + GROUP - 1).min(iv.1 / GROUP) {
                    for fi in (ci * GROUP).max(iu.0 / GROUP)..=(ci * GROUP + GROUP - 1).min(iu.1 / GROUP) {
                        let group = fj * FINE + fi;
                        let o = line((fi * GROUP) as f64 + half(GROUP), (fj * GROUP) as f64 + half(GROUP));
                        let Some(window) = moving.window(self.axis, &o, lateral_fine) else { continue };
                        let middle = 0.5 * (window[0] + window[1]);
                        let bits = [self.bit(window[0]), self.bit(window[1])];
                        if !any(&self.fine[group * self.words..][..self.words], bits) {
                            continue;
                        }
                        let members = &mut self.rays[group * MEMBERS..(group + 1) * MEMBERS];
                        let Some(window) = narrow(members, moving, self.axis, &o, window, lateral_fine, &mut guess)
                        else {
                            continue;
                        };
                        let mut cut = false;
                        for (n, ray) in members.iter_mut().enumerate() {
                            if ray.is_empty() {
                                continue;
                            }
                            let (i, j) = (fi * GROUP + n % GROUP, fj * GROUP + n / GROUP);
                            cut |= visitor(ray, &line(i as f64, j as f64), window, middle, &mut guess);
                        }
                        if cut {
                            self.map_fine(group);
                            changed = true;
                        }
                    }
                }
                if changed {
                    self.map_coarse(coarse);
                }
            }
        }
    }

    /// Takes away what a moving cutter sweeps.
    pub(super) fn remove(&mut self, moving: &Moving, cuts: &mut Vec<[f64; 2]>) -> Removal {
        let axis = self.axis;
        let mut removal = Removal::NONE;
        self.visit(moving, |ray, o, window, middle, guess| {
            cuts.clear();
            for [a, b] in ray.intervals() {
                let part = [a.max(window[0]), b.min(window[1])];
                if part[0] >= part[1] {
                    continue;
                }
                let Some(chip) = moving.cut(axis, o, part, middle, guess) else { continue };
                cuts.push([chip.from, chip.to]);
                removal.length += chip.to - chip.from;
                if chip.to - chip.from < NOTABLE {
                    continue;
                }
                for (x, t) in [(chip.from, chip.times[0]), (chip.to, chip.times[1])] {
                    let (tip, axis_now) = moving.sweep.pose(t);
                    let mut d = o - tip;
                    d[axis] += x;
                    let (s, across) = (d.dot(&axis_now), d.dot(&moving.side));
                    removal.height = [removal.height[0].min(s), removal.height[1].max(s)];
                    removal.side = [removal.side[0].min(across), removal.side[1].max(across)];
                }
            }
            if !cuts.is_empty() {
                ray.subtract(cuts);
            }
            !cuts.is_empty()
        });
        removal
    }

    /// The deepest place of material inside a moving body, when deeper than `least`.
    pub(super) fn overlap(&mut self, moving: &Moving, least: f64) -> Option<Overlap> {
        let axis = self.axis;
        let mut worst: Option<Overlap> = None;
        self.visit(moving, |ray, o, window, _, guess| {
            for [a, b] in ray.intervals() {
                let part = [a.max(window[0]), b.min(window[1])];
                if part[0] >= part[1] {
                    continue;
                }
                let least = worst.map_or(least, |w| w.depth);
                if let Some((x, depth)) = moving.deepest(axis, o, part, least, guess) {
                    let mut p = *o;
                    p[axis] = x;
                    let height = (p - moving.tip).dot(&moving.axis);
                    worst = Some(Overlap { depth, point: [p.x, p.y, p.z], height });
                }
            }
            false
        });
        worst
    }
}

/// The half or whole of a window in which the rays of a group may meet the sweep; `None` when they do not.
fn narrow(
    members: &[Ray],
    moving: &Moving,
    axis: usize,
    o: &Vector3<f64>,
    [a, b]: [f64; 2],
    lateral: f64,
    guess: &mut f64,
) -> Option<[f64; 2]> {
    let middle = 0.5 * (a + b);
    const NONE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];
    // Extents of the material, and of its ends towards the middle.
    let (mut below, mut above, mut ends, mut starts) = (NONE, NONE, NONE, NONE);
    let join = |x: &mut [f64; 2], from: f64, to: f64| *x = [x[0].min(from), x[1].max(to)];
    for [from, to] in members.iter().flat_map(Ray::intervals) {
        let (from, to) = (from.max(a), to.min(b));
        if from >= to {
            continue;
        }
        if from < middle {
            let end = to.min(middle);
            join(&mut below, from, end);
            join(&mut ends, end, end);
        }
        if to > middle {
            let start = from.max(middle);
            join(&mut above, start, to);
            join(&mut starts, start, start);
        }
    }
    let mut open = |part: [f64; 2], ends: [f64; 2], sign: f64| {
        part[0] < part[1]
            && !(moving.follows && moving.behind(axis, o, ends, sign, lateral))
            && !moving.clear(axis, o, part, lateral, guess)
    };
    match (open(below, ends, -1.0), open(above, starts, 1.0)) {
        (false, false) => None,
        (true, false) => Some([a, middle]),
        (false, true) => Some([middle, b]),
        (true, true) => Some([a, b]),
    }
}
