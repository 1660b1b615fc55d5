//! A square of 64 x 64 rays along Z, with maps of where along them material is left: one of groups of 4 x 4 rays, one
//! of groups of 16 x 16.

use super::moving::{Chip, Moving};
use super::ray::Ray;
use super::sweep::Line;

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

    /// Adds what a step takes from a line.
    fn take(&mut self, step: &Moving, line: &Line, chip: &Chip) {
        self.length += chip.to - chip.from;
        if chip.to - chip.from < NOTABLE {
            return;
        }
        for (x, t) in [(chip.from, chip.times[0]), (chip.to, chip.times[1])] {
            let (tip, axis) = step.sweep.pose(t);
            let d = line.point(x) - tip;
            let s = d.dot(&axis);
            let across = (d - axis * s).dot(&step.side);
            self.height = [self.height[0].min(s), self.height[1].max(s)];
            self.side = [self.side[0].min(across), self.side[1].max(across)];
        }
    }

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
    /// Place of the first ray.
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
        origin: [f64; 2],
        cell: f64,
        depth: [f64; 2],
        count: [usize; 2],
        make: impl Fn(usize, usize) -> Vec<[f64; 2]>,
    ) -> Self {
        let brick = cell * GROUP as f64;
        let words = ((depth[1] - depth[0]) / brick / 64.0).floor() as usize + 1;
        let mut tile = Self {
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
        if self.is_empty() || low[2] > self.extent[1] || high[2] < self.extent[0] {
            return false;
        }
        (0..2).all(|k| {
            let last = self.origin[k] + self.cell * (self.count[k] as f64 - 1.0);
            low[k] <= last && high[k] >= self.origin[k]
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

    /// Visits the rays that a moving body may meet; what the visitor says tells whether the ray was changed. `follows`
    /// tells that no material lies inside of the body at its start.
    fn visit(
        &mut self,
        moving: &Moving,
        follows: bool,
        mut visitor: impl FnMut(&mut Ray, &Line, &Group, &mut f64) -> bool,
    ) {
        // Rays of the tile inside the box of the sweep.
        let span = |k: usize| {
            let first = ((moving.low[k] - self.origin[k]) / self.cell).ceil().max(0.0) as usize;
            let last = ((moving.high[k] - self.origin[k]) / self.cell).floor();
            (last >= 0.0).then(|| (first, (last as usize).min(self.count[k] - 1))).filter(|(a, b)| a <= b)
        };
        let (Some(iu), Some(iv)) = (span(0), span(1)) else { return };
        let (origin, cell) = (self.origin, self.cell);
        let line = |i: f64, j: f64| Line { x: origin[0] + cell * i, y: origin[1] + cell * j };
        let half = |rays: usize| 0.5 * (rays as f64 - 1.0);
        let lateral = |rays: usize| half(rays) * self.cell * std::f64::consts::SQRT_2;
        let (lateral_fine, lateral_coarse) = (lateral(GROUP), lateral(GROUP * GROUP));
        let mut guess = 1.0;
        const WIDE: usize = GROUP * GROUP;
        for cj in iv.0 / WIDE..=iv.1 / WIDE {
            for ci in iu.0 / WIDE..=iu.1 / WIDE {
                let coarse = cj * COARSE + ci;
                let o = line((ci * WIDE) as f64 + half(WIDE), (cj * WIDE) as f64 + half(WIDE));
                let Some([a, b]) = moving.window(&o, lateral_coarse) else { continue };
                if !any(&self.coarse[coarse * self.words..][..self.words], [self.bit(a), self.bit(b)]) {
                    continue;
                }
                let mut changed = false;
                for fj in (cj * GROUP).max(iv.0 / GROUP)..=(cj * GROUP + GROUP - 1).min(iv.1 / GROUP) {
                    for fi in (ci * GROUP).max(iu.0 / GROUP)..=(ci * GROUP + GROUP - 1).min(iu.1 / GROUP) {
                        let number = fj * FINE + fi;
                        let middle = line((fi * GROUP) as f64 + half(GROUP), (fj * GROUP) as f64 + half(GROUP));
                        let Some(window) = moving.window(&middle, lateral_fine) else { continue };
                        let bits = [self.bit(window[0]), self.bit(window[1])];
                        if !any(&self.fine[number * self.words..][..self.words], bits) {
                            continue;
                        }
                        let members = &mut self.rays[number * MEMBERS..(number + 1) * MEMBERS];
                        let centre = 0.5 * (window[0] + window[1]);
                        let mut group = Group { middle, lateral: lateral_fine, window, centre };
                        match group.narrow(members, moving, follows, &mut guess) {
                            Some(part) => group.window = part,
                            None => continue,
                        }
                        let mut cut = false;
                        for (n, ray) in members.iter_mut().enumerate() {
                            if ray.is_empty() {
                                continue;
                            }
                            let (i, j) = (fi * GROUP + n % GROUP, fj * GROUP + n / GROUP);
                            cut |= visitor(ray, &line(i as f64, j as f64), &group, &mut guess);
                        }
                        if cut {
                            self.map_fine(number);
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

    /// Takes away what a cutter sweeps in the steps of a run, and adds to the removal of each.
    pub(super) fn remove(&mut self, run: &Run, work: &mut Work, removals: &mut [Removal]) {
        let steps = run.steps;
        self.visit(run.whole, run.follows, |ray, line, group, _| {
            let part = |[a, b]: [f64; 2]| [a.max(group.window[0]), b.min(group.window[1])];
            if steps.len() > 1
                && ray.intervals().map(part).all(|p| p[0] >= p[1] || run.whole.leaves(line, p, &mut work.settled))
            {
                return false;
            }
            let mut changed = false;
            for (step, removal) in steps.iter().zip(removals.iter_mut()) {
                work.chips.clear();
                for p in ray.intervals().map(part).filter(|p| p[0] < p[1]) {
                    step.cut(line, p, &mut work.settled, &mut work.chips);
                }
                if work.chips.is_empty() {
                    continue;
                }
                changed = true;
                for chip in &work.chips {
                    removal.take(step, line, chip);
                }
                work.chips.sort_by(|x, y| x.from.total_cmp(&y.from));
                work.cuts.clear();
                work.cuts.extend(work.chips.iter().map(|c| [c.from, c.to]));
                ray.subtract(&work.cuts);
            }
            changed
        });
    }

    /// The deepest place of material inside a moving body, when deeper than `least`.
    pub(super) fn overlap(&mut self, moving: &Moving, least: f64) -> Option<Overlap> {
        let mut worst: Option<Overlap> = None;
        self.visit(moving, false, |ray, line, group, guess| {
            for [a, b] in ray.intervals() {
                let part = [a.max(group.window[0]), b.min(group.window[1])];
                if part[0] >= part[1] {
                    continue;
                }
                let least = worst.map_or(least, |w| w.depth);
                if let Some((x, depth)) = moving.deepest(line, part, least, guess) {
                    let p = line.point(x);
                    let height = (p - moving.tip).dot(&moving.axis);
                    worst = Some(Overlap { depth, point: [p.x, p.y, p.z], height });
                }
            }
            false
        });
        worst
    }
}

/// A run of steps of a cutter.
pub(super) struct Run<'a> {
    /// All of it as one motion.
    pub(super) whole: &'a Moving,
    /// Its steps in order.
    pub(super) steps: &'a [Moving],
    /// True when the same body has just swept to where this one starts: no material is inside of it there.
    pub(super) follows: bool,
}

/// Room that the removal works in.
#[derive(Default)]
pub(super) struct Work {
    chips: Vec<Chip>,
    cuts: Vec<[f64; 2]>,
    /// End of time that settled the last question.
    settled: usize,
}

/// A fine group of rays with the stretch in which a body may meet it.
struct Group {
    /// Line amid the rays, which lie within `lateral` of it.
    middle: Line,
    lateral: f64,
    window: [f64; 2],
    /// About where the body is.
    centre: f64,
}

impl Group {
    /// The half or whole of the window in which the rays may meet the sweep; `None` when they do not.
    fn narrow(&self, members: &[Ray], moving: &Moving, follows: bool, guess: &mut f64) -> Option<[f64; 2]> {
        let ([a, b], middle) = (self.window, self.centre);
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
                && !(follows && moving.behind(&self.middle, ends, sign, self.lateral))
                && !moving.clear(&self.middle, part, self.lateral, guess)
        };
        match (open(below, ends, -1.0), open(above, starts, 1.0)) {
            (false, false) => None,
            (true, false) => Some([a, middle]),
            (false, true) => Some([middle, b]),
            (true, true) => Some([a, b]),
        }
    }
}
