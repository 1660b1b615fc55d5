//! A square of 64 x 64 rays along Z, with two maps of the material along the rays: for groups of 4 x 4 rays, and for
//! groups of 16 x 16 rays.

use super::intervals::{Chip, Intervals};
use super::lune::{self, Lune};
use super::moving::Moving;
use super::ray::Ray;
use super::reach::StepLanes;
use super::slices::{Sides, Slices};
use super::sweep::RayLine;
use std::ops::ControlFlow;

/// Rays along an edge of a tile.
pub(super) const SIDE: usize = 64;

/// Rays along an edge of a fine group, and fine groups along an edge of a coarse one.
const GROUP: usize = 4;

/// Fine groups along an edge of a tile.
const FINE_GROUPS: usize = SIDE / GROUP;

/// Coarse groups along an edge of a tile.
const COARSE_GROUPS: usize = FINE_GROUPS / GROUP;

/// As [`GROUP`], in the type of the index of a ray in its group.
const ROW: u8 = GROUP as u8;

/// Rays of a fine group.
const MEMBERS: usize = GROUP * GROUP;

/// Length of a chip along a ray from which the chip counts for the engagement of the cutter, as a share of the tip motion
/// of its step, with its least and largest value, mm. Shorter chips come from rubbing along a surface that was cut
/// before. A chip at the angle a from the direction of feed has the share cos a, so a slot ends 6 deg short.
const NOTABLE: f64 = 0.1;
const NOTABLE_WITHIN: [f64; 2] = [2.0 * super::END_ERROR, 10.0 * super::END_ERROR];

/// Material that a block removes from the rays of a tile, or of a family.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Removal {
    /// Length along the rays.
    pub(super) length: f64,
    /// Lowest and highest height over the tip; infinity and minus infinity when no chip counts.
    pub(super) height: [f64; 2],
    /// Extent across tip motion and axis, from the axis.
    pub(super) sides: Sides,
    /// Extent about the axis, for steps along it.
    pub(super) lune: Option<Box<Lune>>,
    /// Least distance from the axis at which material is cut, mm; infinity without any.
    pub(super) nearest: f64,
}

impl Removal {
    pub(super) const NONE: Self = Self {
        length: 0.0,
        height: [f64::INFINITY, f64::NEG_INFINITY],
        sides: Sides::NONE,
        lune: None,
        nearest: f64::INFINITY,
    };

    /// Adds the part that a step removes from a line.
    fn take(&mut self, step: &Moving, slices: &Slices, chip: &Chip) {
        self.length += chip.to - chip.from;
        let [least, most] = NOTABLE_WITHIN;
        if chip.to - chip.from < least {
            return;
        }
        let ends = [(chip.from, chip.times[0]), (chip.to, chip.times[1])].map(|(x, t)| {
            let (tip, axis) = step.sweep.pose(t);
            let d = chip.line.point(x) - tip;
            let height = d.dot(&axis);
            let across = d - axis * height;
            self.nearest = self.nearest.min(across.norm());
            [height, across.dot(&step.side)]
        });
        if chip.to - chip.from < (NOTABLE * step.sweep.way().norm()).clamp(least, most) {
            return;
        }
        for [height, _] in ends {
            self.height = [self.height[0].min(height), self.height[1].max(height)];
        }
        self.sides.add(slices, ends);
        if let Some(around) = &step.around {
            let (tip, axis) = step.sweep.pose(1.0);
            let ends = [chip.from, chip.to].map(|x| chip.line.point(x));
            self.lune.get_or_insert_with(|| Box::new(Lune::NONE)).add(ends, (&tip, &axis), around);
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.length += other.length;
        self.height = [self.height[0].min(other.height[0]), self.height[1].max(other.height[1])];
        self.sides.join(&other.sides);
        lune::join(&mut self.lune, other.lune.as_deref());
        self.nearest = self.nearest.min(other.nearest);
    }
}

/// The deepest place of stock inside a part of the tool that must not touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Overlap {
    pub(super) depth: f64,
    pub(super) point: [f64; 3],
    pub(super) height: f64,
}

/// 64 x 64 rays.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tile {
    /// Position of the first ray.
    origin: [f64; 2],
    cell: f64,
    /// Number of rays along both edges, at most [`SIDE`]; the other rays are empty.
    count: [usize; 2],
    /// Start of the maps, and length of one bit.
    start: f64,
    brick: f64,
    words: usize,
    /// Rays, group by group; empty in a tile without material.
    rays: Vec<Ray>,
    fine: Vec<u64>,
    coarse: Vec<u64>,
    /// Lowest and highest place of material.
    extent: [f64; 2],
}

/// Index of a ray: groups in rows, and rays in rows inside a group.
fn index(i: usize, j: usize) -> usize {
    (j / GROUP * FINE_GROUPS + i / GROUP) * MEMBERS + j % GROUP * GROUP + i % GROUP
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
    /// A tile of `count` rays; `make` returns the intervals of each ray.
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
            fine: vec![0; FINE_GROUPS * FINE_GROUPS * words],
            coarse: vec![0; COARSE_GROUPS * COARSE_GROUPS * words],
            extent: [f64::INFINITY, f64::NEG_INFINITY],
        };
        for j in 0..count[1] {
            for i in 0..count[0] {
                tile.rays[index(i, j)] = Ray::new(&make(i, j));
            }
        }
        for group in 0..FINE_GROUPS * FINE_GROUPS {
            tile.map_fine(group);
        }
        for group in 0..COARSE_GROUPS * COARSE_GROUPS {
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

    /// Total length of the material.
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

    /// Computes the map of a fine group.
    fn map_fine(&mut self, group: usize) {
        let mut words = std::mem::take(&mut self.fine);
        let own = &mut words[group * self.words..(group + 1) * self.words];
        own.fill(0);
        for [a, b] in self.rays[group * MEMBERS..(group + 1) * MEMBERS].iter().flat_map(Ray::intervals) {
            set(own, [self.bit(a), self.bit(b)]);
        }
        self.fine = words;
    }

    /// Computes the map of a coarse group from its fine groups.
    fn map_coarse(&mut self, group: usize) {
        let own = &mut self.coarse[group * self.words..(group + 1) * self.words];
        own.fill(0);
        let (i, j) = (group % COARSE_GROUPS * GROUP, group / COARSE_GROUPS * GROUP);
        for fine in (0..MEMBERS).map(|k| (j + k / GROUP) * FINE_GROUPS + i + k % GROUP) {
            for (w, f) in own.iter_mut().zip(&self.fine[fine * self.words..]) {
                *w |= f;
            }
        }
    }

    /// Visits the groups of rays that a moving body may meet, with their numbers.
    fn visit(&self, moving: &Moving, mut visitor: impl FnMut(usize, &RayGroup) -> ControlFlow<()>) {
        // Rays of the tile inside the box of the sweep.
        let span = |k: usize| {
            let first = ((moving.low[k] - self.origin[k]) / self.cell).ceil().max(0.0) as usize;
            let last = ((moving.high[k] - self.origin[k]) / self.cell).floor();
            (last >= 0.0).then(|| (first, (last as usize).min(self.count[k] - 1))).filter(|(a, b)| a <= b)
        };
        let (Some(iu), Some(iv)) = (span(0), span(1)) else { return };
        let (origin, cell) = (self.origin, self.cell);
        let line = |i: f64, j: f64| RayLine { x: origin[0] + cell * i, y: origin[1] + cell * j };
        let half = |rays: usize| 0.5 * (rays as f64 - 1.0);
        let lateral = |rays: usize| half(rays) * cell * std::f64::consts::SQRT_2;
        let (lateral_fine, lateral_coarse) = (lateral(GROUP), lateral(GROUP * GROUP));
        const BLOCK: usize = GROUP * GROUP;
        for cj in iv.0 / BLOCK..=iv.1 / BLOCK {
            for ci in iu.0 / BLOCK..=iu.1 / BLOCK {
                let coarse = cj * COARSE_GROUPS + ci;
                let o = line((ci * BLOCK) as f64 + half(BLOCK), (cj * BLOCK) as f64 + half(BLOCK));
                let Some([a, b]) = moving.window(&o, lateral_coarse) else { continue };
                if !any(&self.coarse[coarse * self.words..][..self.words], [self.bit(a), self.bit(b)]) {
                    continue;
                }
                for fj in (cj * GROUP).max(iv.0 / GROUP)..=(cj * GROUP + GROUP - 1).min(iv.1 / GROUP) {
                    for fi in (ci * GROUP).max(iu.0 / GROUP)..=(ci * GROUP + GROUP - 1).min(iu.1 / GROUP) {
                        let number = fj * FINE_GROUPS + fi;
                        let first = line((fi * GROUP) as f64, (fj * GROUP) as f64);
                        let middle = RayLine { x: first.x + half(GROUP) * cell, y: first.y + half(GROUP) * cell };
                        let Some(window) = moving.window(&middle, lateral_fine) else { continue };
                        let bits = [self.bit(window[0]), self.bit(window[1])];
                        if !any(&self.fine[number * self.words..][..self.words], bits) {
                            continue;
                        }
                        let group = RayGroup { first, cell, middle, lateral: lateral_fine, window };
                        if visitor(number, &group).is_break() {
                            return;
                        }
                    }
                }
            }
        }
    }

    /// Rays of a fine group.
    fn members(&self, group: usize) -> &[Ray] {
        &self.rays[group * MEMBERS..(group + 1) * MEMBERS]
    }

    /// Removes what a cutter sweeps in the steps of a run, and adds to the removal of each step, for the slices of the cutter.
    pub(super) fn remove(
        &mut self,
        run: &RayRun,
        memory: &mut TileMemory,
        mut removals: Option<(&Slices, &mut [Removal])>,
    ) {
        let TileMemory { intervals: work, groups } = memory;
        groups.clear();
        self.visit(run.whole, |number, group| {
            groups.push((number, *group));
            ControlFlow::Continue(())
        });
        // The coarse group of which a fine one has changed.
        let mut changed = None;
        for (number, group) in groups.iter() {
            work.clear();
            group.intervals(self.members(*number), |ray, line, part| work.push(line, ray, part));
            let reached = work.reached(run.lanes, &group.middle, group.lateral, group.window);
            let near = run.range.clone().filter(|k| reached[*k]);
            if near.clone().nth(1).is_some() {
                work.sift(run.whole);
            }
            if work.is_empty() {
                continue;
            }
            for k in near {
                let step = &run.steps[k];
                let first = work.chips.len();
                work.cut(step);
                if let Some((slices, removals)) = &mut removals {
                    for chip in &work.chips[first..] {
                        removals[k].take(step, slices, chip);
                    }
                }
            }
            let chips = &mut work.chips;
            if chips.is_empty() {
                continue;
            }
            chips.sort_unstable_by(|a, b| a.ray.cmp(&b.ray).then(a.from.total_cmp(&b.from)));
            for chips in chips.chunk_by(|a, b| a.ray == b.ray) {
                let ray = &mut self.rays[number * MEMBERS + usize::from(chips[0].ray)];
                ray.subtract(chips.iter().map(|c| [c.from, c.to]));
            }
            self.map_fine(*number);
            let coarse = number / FINE_GROUPS / GROUP * COARSE_GROUPS + number % FINE_GROUPS / GROUP;
            if let Some(before) = changed.replace(coarse).filter(|before| *before != coarse) {
                self.map_coarse(before);
            }
        }
        if let Some(coarse) = changed {
            self.map_coarse(coarse);
        }
    }

    /// The deepest place of material inside a moving body, when deeper than `least`; a place deeper than `enough` ends the
    /// search.
    pub(super) fn overlap(&self, moving: &Moving, least: f64, enough: f64) -> Option<Overlap> {
        let mut worst: Option<Overlap> = None;
        let mut guess = 1.0;
        self.visit(moving, |number, group| {
            if moving.clear(&group.middle, group.window, group.lateral, &mut guess) {
                return ControlFlow::Continue(());
            }
            let found = |worst: &Option<Overlap>| worst.is_some_and(|w| w.depth > enough);
            group.intervals(self.members(number), |_, line, part| {
                let least = worst.map_or(least, |w| w.depth);
                if found(&worst) {
                    return;
                }
                if let Some((x, depth)) = moving.deepest(line, part, least, &mut guess) {
                    let p = line.point(x);
                    let height = (p - moving.tip).dot(&moving.axis);
                    worst = Some(Overlap { depth, point: [p.x, p.y, p.z], height });
                }
            });
            if found(&worst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        worst
    }

    /// True when [`Self::overlap`] would find a place: the search ends at the first one.
    pub(super) fn touches(&self, moving: &Moving, least: f64) -> bool {
        let mut found = false;
        let mut guess = 1.0;
        self.visit(moving, |number, group| {
            if moving.clear(&group.middle, group.window, group.lateral, &mut guess) {
                return ControlFlow::Continue(());
            }
            group.intervals(self.members(number), |_, line, part| {
                found = found || moving.deepest(line, part, least, &mut guess).is_some();
            });
            if found { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        found
    }
}

/// Memory that one run leaves to the next.
#[derive(Default)]
pub(super) struct TileMemory {
    intervals: Intervals,
    /// Groups of rays that the run may meet, with their numbers.
    groups: Vec<(usize, RayGroup)>,
}

/// A run of steps of a cutter.
pub(super) struct RayRun<'a> {
    /// The whole run as one motion.
    pub(super) whole: &'a Moving,
    /// Its steps, in order, and those of them that count.
    pub(super) steps: &'a [Moving],
    pub(super) range: std::ops::Range<usize>,
    /// The steps as columns.
    pub(super) lanes: &'a StepLanes,
}

/// A fine group of rays, with the interval in which a body may meet it.
#[derive(Clone, Copy)]
struct RayGroup {
    /// Line of the first ray, and distance between rays.
    first: RayLine,
    cell: f64,
    /// Line in the middle of the rays; all rays lie within `lateral` of it.
    middle: RayLine,
    lateral: f64,
    window: [f64; 2],
}

impl RayGroup {
    /// Visits the material in the window: index of the ray, its line, and the interval.
    fn intervals(&self, rays: &[Ray], mut visitor: impl FnMut(u8, &RayLine, [f64; 2])) {
        let [low, high] = self.window;
        for (n, ray) in (0_u8..).zip(rays) {
            let at = |k: u8| self.cell * f64::from(k);
            let line = RayLine { x: self.first.x + at(n % ROW), y: self.first.y + at(n / ROW) };
            for [a, b] in ray.intervals() {
                if a >= high {
                    break;
                }
                if b > low {
                    visitor(n, &line, [a.max(low), b.min(high)]);
                }
            }
        }
    }
}
