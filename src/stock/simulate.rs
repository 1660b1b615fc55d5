//! A stream of steps of one tool through the stock.
//!
//! Steps are taken in batches; of each batch every tile gets the list of the steps whose boxes meet it and works them
//! off in program order. Tiles share nothing, so that the result does not depend on the number of threads; sums over
//! tiles are made in the order of the tiles.

use super::field::across;
use super::shape::Shape;
use super::tile::{Moving, Overlap, Removal, SIDE, Tile};
use super::{Field, Step, StepKind};
use crate::collide::ToolSolid;
use nalgebra::Point3;
use rayon::prelude::*;

/// Steps of a batch: some ten megabytes with all that is prepared for them.
const BATCH: usize = 1 << 16;

/// Depth from which stock inside shank, holder or a cutter at rapid counts, mm: contact with a wall that the same tool
/// has just cut, on the chords of its path, is shallower.
pub const CONTACT: f64 = 5e-3;

/// What a block removes. Blocks that remove nothing have none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockCut {
    /// Number of the block.
    pub block: u32,
    /// Removed volume, mean of the three families, mm3.
    pub volume: f64,
    /// Lowest and highest height over the tip where material was removed; above and below all when it only rubbed.
    pub height: [f64; 2],
    /// Extent of the removed material across way and axis, from the axis.
    pub side: [f64; 2],
}

/// Part of the tool that touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Touched {
    /// The cutter, at rapid.
    Cutter,
    /// The shank.
    Shank,
    /// The holder.
    Holder,
}

/// Stock inside a part of the tool that must not be there. One for each block and part, the deepest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// Number of the block.
    pub block: u32,
    /// Part of the tool.
    pub what: Touched,
    /// Depth below its surface, mm.
    pub depth: f64,
    /// The place.
    pub point: Point3<f64>,
    /// Height of the place over the tip at half time of the step.
    pub height: f64,
}

/// What a stream did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Removal of the blocks that removed something, in order.
    pub cuts: Vec<BlockCut>,
    /// Collisions in the order of blocks.
    pub collisions: Vec<Collision>,
}

/// A step prepared: its bodies, those that must not touch first.
struct Prepared {
    /// Blocks before its own in the batch.
    ordinal: u32,
    bodies: Vec<(Option<Touched>, Moving)>,
}

/// What a tile says of a batch.
#[derive(Default)]
struct Said {
    removals: Vec<(u32, Removal)>,
    overlaps: Vec<(u32, Touched, Overlap)>,
}

/// Sends a tool through the stock. Before a step removes what its cutter sweeps, stock inside shank and holder is
/// reported, and inside the cutter at rapid. Only the cutter at feed removes: so depths do not depend on how a way is
/// divided into steps.
pub fn simulate(field: &mut Field, solid: &ToolSolid, steps: impl IntoIterator<Item = Step>) -> Outcome {
    let cutter = Shape::cutter(solid);
    let body: Vec<(Touched, Shape)> = solid
        .shank
        .iter()
        .map(|s| (Touched::Shank, s))
        .chain(solid.holder.iter().map(|s| (Touched::Holder, s)))
        .filter_map(|(what, s)| Shape::section(s).map(|shape| (what, shape)))
        .collect();
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

fn run_batch(field: &mut Field, cutter: &Shape, body: &[(Touched, Shape)], steps: &[Step], outcome: &mut Outcome) {
    // Blocks of the batch, and for each step its ordinal among them.
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
    let high: [f64; 3] = std::array::from_fn(|k| field.low[k] + field.cell * field.count[k] as f64);
    let outside = |m: &Moving| (0..3).any(|k| m.high[k] < field.low[k] || m.low[k] > high[k]);
    let prepared: Vec<Prepared> = steps
        .par_iter()
        .enumerate()
        .zip(&ordinals)
        .map(|((n, step), &ordinal)| {
            let before = n.checked_sub(1).map(|n| &steps[n]);
            let follows = before
                .is_some_and(|b| b.kind != StepKind::Rapid && b.tips[1] == step.tips[0] && b.axes[2] == step.axes[0]);
            let bodies = body
                .iter()
                .map(|(what, shape)| (Some(*what), Moving::new(step, *shape, false)))
                .chain(std::iter::once((None, Moving::new(step, *cutter, follows))))
                .filter(|(_, m)| !outside(m))
                .collect();
            Prepared { ordinal, bodies }
        })
        .collect();

    let area = field.cell * field.cell;
    let (low, cell) = (field.low, field.cell);
    let mut work: Vec<(&mut Tile, Vec<(u32, u32)>)> = Vec::new();
    for family in &mut field.families {
        let [u, v] = across(family.axis);
        let mut lists: Vec<Vec<(u32, u32)>> = vec![Vec::new(); family.tiles.len()];
        for (n, p) in prepared.iter().enumerate() {
            for (k, (_, m)) in p.bodies.iter().enumerate() {
                let span = |axis: usize, count: usize| {
                    let tile = |x: f64| (x - low[axis]) / cell / SIDE as f64;
                    // Casts saturate at zero.
                    tile(m.low[axis]) as usize..=(tile(m.high[axis]) as usize).min(count - 1)
                };
                for j in span(v, family.across[1]) {
                    for i in span(u, family.across[0]) {
                        let t = j * family.across[0] + i;
                        if family.tiles[t].meets(&m.low, &m.high) {
                            lists[t].push((index32(n), index32(k)));
                        }
                    }
                }
            }
        }
        work.extend(family.tiles.iter_mut().zip(lists).filter(|(_, l)| !l.is_empty()));
    }
    let said: Vec<Said> = work.par_iter_mut().map(|(tile, list)| run_tile(tile, list, &prepared)).collect();

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
                BlockCut { block: *block, volume: r.length * area / 3.0, height: r.height, side: r.side },
            );
        }
    }
    // Stable: of equal depths the first tile wins.
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

/// Number of a step, body or block in 32 bits; batches are far smaller.
fn index32(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

/// A block may reach from one batch into the next.
fn push_cut(outcome: &mut Outcome, cut: BlockCut) {
    match outcome.cuts.last_mut() {
        Some(last) if last.block == cut.block => {
            last.volume += cut.volume;
            last.height = [last.height[0].min(cut.height[0]), last.height[1].max(cut.height[1])];
            last.side = [last.side[0].min(cut.side[0]), last.side[1].max(cut.side[1])];
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

/// Works off the steps of a tile in order.
fn run_tile(tile: &mut Tile, list: &[(u32, u32)], prepared: &[Prepared]) -> Said {
    let mut said = Said::default();
    let mut cuts: Vec<[f64; 2]> = Vec::new();
    for &(n, k) in list {
        let step = &prepared[n as usize];
        let (what, moving) = &step.bodies[k as usize];
        let forbidden = what.or((moving.kind == StepKind::Rapid).then_some(Touched::Cutter));
        if let Some(what) = forbidden
            && let Some(overlap) = tile.overlap(moving, CONTACT)
        {
            let before = said.overlaps.iter_mut().rev().take_while(|o| o.0 == step.ordinal);
            match before.into_iter().find(|o| o.1 == what) {
                Some(o) if o.2.depth < overlap.depth => o.2 = overlap,
                Some(_) => {}
                None => said.overlaps.push((step.ordinal, what, overlap)),
            }
        }
        if forbidden.is_none() {
            let removal = tile.remove(moving, &mut cuts);
            if removal.length > 0.0 {
                match said.removals.last_mut() {
                    Some((ordinal, r)) if *ordinal == step.ordinal => r.add(&removal),
                    _ => said.removals.push((step.ordinal, removal)),
                }
            }
        }
    }
    said
}
