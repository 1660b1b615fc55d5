//! Simulation of a stream of steps of one tool.
//!
//! Steps are processed in batches. For each batch, every tile gets the list of the steps whose boxes intersect it, and
//! processes them in program order. Tiles share no data, so that the result does not depend on the number of threads;
//! sums over tiles are computed in the order of the tiles.

use super::lune::{self, Lune};
use super::moving::Moving;
use super::run::{self, Frame, MAX_RUN_STEPS, Prepared};
use super::shape::SolidShape;
use super::slices::{Sides, Slices};
use super::sweep::StepSweep;
use super::tile::{Overlap, Removal, Tile, TileMemory};
use super::{END_ERROR, Field, Step, Touched};
use crate::collide::ToolSolid;
use nalgebra::Point3;
use rayon::prelude::*;

/// Steps of a batch: some ten megabytes with all prepared data.
const BATCH: usize = 1 << 14;

/// Depth from which stock inside shank, holder or a cutter at rapid counts, mm. Contact with a wall that the same tool
/// has just cut, on the chords of its path, is shallower.
pub const CONTACT: f64 = 5e-3;

/// Removal of a block. Blocks without removal have no entry.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockCut {
    /// Number of the block.
    pub block: u32,
    /// Removed volume, mean of the three families, mm3.
    pub volume: f64,
    /// Lowest and highest height over the tip where material was removed; the lowest is above the highest when the tool
    /// only rubbed.
    pub height: [f64; 2],
    /// Extent of the removed material across tip motion and axis, from the axis, in each slice of the cutter.
    pub sides: Sides,
    /// Extent of the removed material about the axis, for steps along it.
    pub lune: Option<Box<Lune>>,
    /// Least distance from the axis, at the time of the cut, at which material is removed, mm; infinity without any.
    pub nearest: f64,
}

/// Stock inside a part of the tool that must not touch it: the deepest place for each block and part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// Number of the block.
    pub block: u32,
    /// Part of the tool.
    pub what: Touched,
    /// Depth below the surface of this part, mm.
    pub depth: f64,
    /// The deepest place.
    pub point: Point3<f64>,
    /// Height of the place over the tip in the middle of the step.
    pub height: f64,
}

/// Result of a stream.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Removal of the blocks that removed material, in order.
    pub cuts: Vec<BlockCut>,
    /// Collisions in the order of blocks.
    pub collisions: Vec<Collision>,
}

/// Largest error of the depth for parts that must not touch, mm.
const FORBIDDEN_ERROR: f64 = 3.0 * END_ERROR;

/// Result of a tile for a batch.
#[derive(Default)]
struct Said {
    removals: Vec<(u32, Removal)>,
    overlaps: Vec<(u32, Touched, Overlap)>,
}

/// Sends a tool through the stock. Before a step removes the material that its cutter sweeps, stock inside shank and
/// holder is reported; at rapid, stock inside the cutter is reported as well. Only the cutter at feed removes material,
/// so that depths do not depend on the division of a path into steps.
pub fn simulate(field: &mut Field, solid: &ToolSolid, steps: impl IntoIterator<Item = Step>) -> Outcome {
    let cutter = SolidShape::cutter(solid);
    let body = body(solid);
    let mut outcome = Outcome::default();
    let mut steps = steps.into_iter();
    loop {
        let batch: Vec<Step> = steps.by_ref().take(BATCH).collect();
        if batch.is_empty() {
            return outcome;
        }
        run_batch(field, &cutter, &body, &batch, &mut outcome);
    }
}

/// The parts of a tool that must not touch.
pub(super) fn body(solid: &ToolSolid) -> Vec<(Touched, SolidShape)> {
    solid
        .shank
        .iter()
        .map(|s| (Touched::Shank, s))
        .chain(solid.holder.iter().map(|s| (Touched::Holder, s)))
        .filter_map(|(what, s)| SolidShape::section(s).map(|shape| (what, shape)))
        .collect()
}

/// Removes what the cutter of a tool sweeps, as [`simulate()`] does, without saying what each block removes.
pub fn cut(field: &mut Field, solid: &ToolSolid, steps: impl IntoIterator<Item = Step>) {
    let cutter = SolidShape::cutter(solid);
    let mut steps = steps.into_iter();
    loop {
        let batch: Vec<Step> = steps.by_ref().take(BATCH).collect();
        if batch.is_empty() {
            return;
        }
        let runs = run::split(&batch, cutter.reach());
        let ordinals = vec![0; batch.len()];
        let frames = [0, 1, 2].map(|axis| Frame::of(field, axis));
        let prepared = frames.each_ref().map(|frame| run::prepare(&batch, &ordinals, &runs, &cutter, &[], frame));
        let each = |(tile, axis, list): &mut TileWork<'_>| {
            let mut work = TileMemory::default();
            for run in list.iter().map(|n| &prepared[*axis][*n as usize]) {
                if let Some(run) = run.removing(0..run.steps.len()) {
                    tile.remove(&run, &mut work, None);
                }
            }
        };
        let mut work = tile_work(field, &frames, &prepared);
        match &runs[..] {
            // The threads would cost more than the run.
            [_] => work.iter_mut().for_each(each),
            _ => work.par_iter_mut().for_each(each),
        }
    }
}

/// Processes the steps of a batch in all tiles.
fn run_batch(
    field: &mut Field,
    cutter: &SolidShape,
    body: &[(Touched, SolidShape)],
    steps: &[Step],
    outcome: &mut Outcome,
) {
    // Blocks of the batch, and for each step the index of its block in this list.
    let mut blocks: Vec<u32> = Vec::new();
    let ordinals: Vec<u32> = steps
        .iter()
        .map(|s| {
            if blocks.last() != Some(&s.block) {
                blocks.push(s.block);
            }
            index32(blocks.len() - 1)
        })
        .collect();
    let runs = run::split(steps, cutter.reach());
    let area = field.cell * field.cell;
    let slices = Slices::new(cutter.extent().to, field.cell);
    let frames = [0, 1, 2].map(|axis| Frame::of(field, axis));
    let prepared = frames.each_ref().map(|frame| run::prepare(steps, &ordinals, &runs, cutter, body, frame));
    let said: Vec<Said> = tile_work(field, &frames, &prepared)
        .par_iter_mut()
        .map(|(tile, axis, list)| {
            let mut said = run_tile(tile, list, &prepared[*axis], &slices);
            for (_, _, overlap) in &mut said.overlaps {
                let own = overlap.point;
                frames[*axis].order.iter().zip(own).for_each(|(k, x)| overlap.point[*k] = x);
            }
            said
        })
        .collect();
    gather(said, &blocks, area, outcome);
}

/// A tile, its family, and the runs whose boxes meet it, in order.
type TileWork<'a> = (&'a mut Tile, usize, Vec<u32>);

/// The tiles of all families that intersect a run.
fn tile_work<'a>(field: &'a mut Field, frames: &[Frame; 3], prepared: &[Vec<Prepared>; 3]) -> Vec<TileWork<'a>> {
    let cell = field.cell;
    let mut work: Vec<TileWork<'a>> = Vec::new();
    for (axis, family) in field.families.iter_mut().enumerate() {
        let low = frames[axis].low;
        let mut lists: Vec<Vec<u32>> = vec![Vec::new(); family.tiles.len()];
        for (n, p) in prepared[axis].iter().enumerate() {
            for m in p.forbidden.iter().map(|(_, m)| m).chain(&p.whole) {
                for t in family.near(low, cell, m) {
                    if lists[t].last() != Some(&index32(n)) && family.tiles[t].meets(&m.low, &m.high) {
                        lists[t].push(index32(n));
                    }
                }
            }
        }
        work.extend(family.tiles.iter_mut().zip(lists).filter(|(_, l)| !l.is_empty()).map(|(t, l)| (t, axis, l)));
    }
    work
}

/// Adds the results of the tiles for a batch to the outcome. `area` is that of a cell, mm2.
fn gather(said: Vec<Said>, blocks: &[u32], area: f64, outcome: &mut Outcome) {
    let mut removals = vec![Removal::NONE; blocks.len()];
    let mut overlaps: Vec<(u32, Touched, Overlap)> = Vec::new();
    for s in said {
        for (ordinal, r) in s.removals {
            removals[ordinal as usize].add(&r);
        }
        overlaps.extend(s.overlaps);
    }
    for (block, r) in blocks.iter().zip(&removals) {
        if r.length > 0.0 {
            push_cut(
                outcome,
                BlockCut {
                    block: *block,
                    volume: r.length * area / 3.0,
                    height: r.height,
                    sides: r.sides,
                    lune: r.lune.clone(),
                    nearest: r.nearest,
                },
            );
        }
    }
    // A stable sort: of equal depths the first tile remains.
    overlaps.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(b.2.depth.total_cmp(&a.2.depth)));
    overlaps.dedup_by(|b, a| (a.0, a.1) == (b.0, b.1));
    for (ordinal, what, o) in overlaps {
        let found = Collision {
            block: blocks[ordinal as usize],
            what,
            depth: o.depth,
            point: Point3::from(o.point),
            height: o.height,
        };
        push_collision(outcome, found);
    }
}

/// Index of a step, body or block in 32 bits; batches are far smaller.
fn index32(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

/// Adds a cut; a block may extend from one batch into the next.
fn push_cut(outcome: &mut Outcome, cut: BlockCut) {
    match outcome.cuts.last_mut() {
        Some(last) if last.block == cut.block => {
            last.volume += cut.volume;
            last.height = [last.height[0].min(cut.height[0]), last.height[1].max(cut.height[1])];
            last.sides.join(&cut.sides);
            lune::join(&mut last.lune, cut.lune.as_deref());
            last.nearest = last.nearest.min(cut.nearest);
        }
        _ => outcome.cuts.push(cut),
    }
}

fn push_collision(outcome: &mut Outcome, found: Collision) {
    let before = outcome.collisions.iter_mut().rev().take_while(|c| c.block == found.block);
    match before.into_iter().find(|c| c.what == found.what) {
        Some(c) if c.depth < found.depth => *c = found,
        Some(_) => {}
        None => outcome.collisions.push(found),
    }
}

/// Processes the runs of a tile in order.
fn run_tile(tile: &mut Tile, list: &[u32], prepared: &[Prepared], slices: &Slices) -> Said {
    let mut said = Said::default();
    let mut work = TileMemory::default();
    for &n in list {
        let run = &prepared[n as usize];
        // A part that touches no stock before the run touches none during the run, since the run adds no stock.
        let near: Vec<(Touched, SolidShape)> = run
            .forbidden
            .iter()
            .filter(|(_, m)| tile.meets(&m.low, &m.high) && tile.touches(m, CONTACT - m.error()))
            .map(|(what, m)| (*what, m.shape))
            .collect();
        let touches = run.sweeps.iter().any(|s| near.iter().any(|(_, shape)| touches(tile, s, shape)));
        if !touches {
            said.remove(tile, run, 0..run.steps.len(), slices, &mut work);
            continue;
        }
        for (k, (sweep, ordinal)) in run.sweeps.iter().zip(&run.ordinals).enumerate() {
            for (what, shape) in &near {
                let least = said.deepest(*ordinal, *what).map_or(CONTACT, |o| o.depth);
                if let Some(overlap) = touch(tile, sweep, shape, least, f64::INFINITY) {
                    said.overlap(*ordinal, *what, overlap);
                }
            }
            if !run.steps.is_empty() {
                said.remove(tile, run, k..k + 1, slices, &mut work);
            }
        }
    }
    said
}

/// The deepest place of stock inside a part that must not touch, over a step; `None` when it is no deeper than `least`. A
/// place deeper than `enough` ends the search. The step is divided until the depth is exact to [`FORBIDDEN_ERROR`].
pub(super) fn touch(tile: &Tile, sweep: &StepSweep, shape: &SolidShape, least: f64, enough: f64) -> Option<Overlap> {
    let moving = Moving::new(*sweep, *shape, 0.0);
    let error = moving.error();
    if error <= FORBIDDEN_ERROR {
        return tile.overlap(&moving, least, enough);
    }
    if !tile.touches(&moving, least - error) {
        return None;
    }
    let first = touch(tile, &sweep.part(0.0, 0.5), shape, least, enough);
    if first.is_some_and(|o| o.depth > enough) {
        return first;
    }
    touch(tile, &sweep.part(0.5, 1.0), shape, first.map_or(least, |o| o.depth), enough).or(first)
}

/// True when [`touch`] would find a place.
fn touches(tile: &Tile, sweep: &StepSweep, shape: &SolidShape) -> bool {
    let moving = Moving::new(*sweep, *shape, 0.0);
    let error = moving.error();
    let exact = error <= FORBIDDEN_ERROR;
    tile.touches(&moving, if exact { CONTACT } else { CONTACT - error })
        && (exact || [sweep.part(0.0, 0.5), sweep.part(0.5, 1.0)].iter().any(|half| touches(tile, half, shape)))
}

impl Said {
    /// The deepest place of a block and a part so far.
    fn deepest(&mut self, ordinal: u32, what: Touched) -> Option<&mut Overlap> {
        let before = self.overlaps.iter_mut().rev().take_while(|o| o.0 == ordinal);
        before.into_iter().find(|o| o.1 == what).map(|o| &mut o.2)
    }

    fn overlap(&mut self, ordinal: u32, what: Touched, overlap: Overlap) {
        match self.deepest(ordinal, what) {
            Some(deepest) if deepest.depth < overlap.depth => *deepest = overlap,
            Some(_) => {}
            None => self.overlaps.push((ordinal, what, overlap)),
        }
    }

    /// Removes what the cutter sweeps in some of the steps of a run.
    fn remove(
        &mut self,
        tile: &mut Tile,
        run: &Prepared,
        steps: std::ops::Range<usize>,
        slices: &Slices,
        work: &mut TileMemory,
    ) {
        let Some(removing) = run.removing(steps) else { return };
        let mut removals = [Removal::NONE; MAX_RUN_STEPS];
        tile.remove(&removing, work, Some((slices, &mut removals)));
        for (ordinal, removal) in run.ordinals.iter().zip(&removals) {
            if removal.length > 0.0 {
                match self.removals.last_mut() {
                    Some((last, r)) if last == ordinal => r.add(removal),
                    _ => self.removals.push((*ordinal, removal.clone())),
                }
            }
        }
    }
}
