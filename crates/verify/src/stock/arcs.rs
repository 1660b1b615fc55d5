//! Arc of engagement: the arc of the circle of the cutter that meets stock, with an upper bound; slots; time and path
//! at feed over the arc.

use super::{MIN_FULL_ARC, StepPlace, StepRemoval};
use crate::proof::piece::At;
use base::units::{Deg, Mm, Sec};
use ir::MoveKind;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use tool_stock::stock::{BlockCut, END_ERROR, Lune, SLICES, Sides, Slices};

/// Width of a class, degrees.
pub const CLASS_WIDTH: f64 = 15.0;

/// Number of classes, from 0 to 180 degrees.
pub const CLASSES: usize = 12;

/// Arc of a slot, degrees.
const SLOT_ARC: f64 = 180.0;

/// Cosine of the turn of the direction of feed from which earlier steps show another engagement, 30 degrees.
const MIN_FEED_COSINE: f64 = 0.866;

/// Largest upper bound of the arc over some steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArcBound {
    /// Bound.
    pub value: Deg,
    /// Arc that the rays show there.
    pub found: Deg,
    /// Move.
    pub at: At,
    /// Tool tip at this move, part frame, mm.
    pub tip: [f64; 3],
}

/// Time of the feeds of some blocks, and length of their tip path; in a file a list of both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "(Sec, Mm)", into = "(Sec, Mm)")]
pub struct TimeAndPath {
    /// Time.
    pub time: Sec,
    /// Length of the tip path.
    pub path: Mm,
}

impl From<(Sec, Mm)> for TimeAndPath {
    fn from((time, path): (Sec, Mm)) -> Self {
        Self { time, path }
    }
}

impl From<TimeAndPath> for (Sec, Mm) {
    fn from(of: TimeAndPath) -> Self {
        (of.time, of.path)
    }
}

/// Time and path of an operation at feed, by the arc of engagement. Class k holds arcs over k times 15 degrees up to
/// k + 1 times 15 degrees; the first one holds arcs of zero as well.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ArcTimes {
    /// Time of each class by the feeds of the blocks.
    pub time: [Sec; CLASSES],
    /// Length of the tip path of each class.
    #[serde(rename = "way")]
    pub path: [Mm; CLASSES],
    /// Where nothing is removed.
    pub air: TimeAndPath,
    /// In slots.
    pub slots: TimeAndPath,
}

/// Circle of a cutter in a stock of rays.
pub(super) struct Circle {
    /// Largest radius of the cutter, mm.
    pub(super) radius: f64,
    /// Distance of the rays, mm.
    pub(super) cell: f64,
    /// Tip motion whose chips show the engagement at its end, mm.
    pub(super) window: f64,
    /// Slices in which the engagement is measured.
    pub(super) slices: Slices,
}

impl Circle {
    /// How much farther to the side than the chips on the rays material may reach, mm. A ray along each axis passes any
    /// place within half of the diagonal of a cell, so that a ball of a diagonal of a cell in diameter meets a ray.
    fn unseen(&self) -> f64 {
        std::f64::consts::SQRT_2 * self.cell + END_ERROR
    }

    /// The arc that loads the cutter in a slice, degrees: that between the outermost chips on the rays, of an arc `found`,
    /// without what is free about the axis wherever material may lie that meets no ray.
    fn loaded(&self, found: f64, free: Option<[f64; 2]>) -> f64 {
        let Some([from, to]) = free.map(|[from, to]| [from + self.unseen(), to - self.unseen()]) else { return found };
        if from < to { found - self.arc([from, to]) } else { found }
    }

    /// Arc between two distances from the tool axis, across the direction of feed, degrees.
    fn arc(&self, side: [f64; 2]) -> f64 {
        let angle = |side: f64| libm::asin((side / self.radius).clamp(-1.0, 1.0));
        (angle(side[1]) - angle(side[0])).to_degrees()
    }

    /// For each slice the slices at whose heights material lies that can belong to chips which the rays show in it, or
    /// which they do not show although it lies in the slice.
    fn neighbours(&self) -> Vec<RangeInclusive<usize>> {
        let at = |height: f64| self.slices.at(height);
        let unseen = self.unseen();
        (0..SLICES).map(|k| at(self.slices.edge(k) - unseen)..=at(self.slices.edge(k + 1) + unseen)).collect()
    }
}

/// Arc of a step. Of a step across the axis up to 180 degrees; of one along the axis up to a whole turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct StepArc {
    /// Arc of the chips on the rays, degrees, in the slice with the largest one: no more than the true arc there.
    pub(super) found: f64,
    /// Upper bound, degrees.
    pub(super) bound: f64,
    /// Depth of cut at full width that loads the cutter as much, mm: the sum of the arcs of all slices, each times its
    /// thickness, over 180 deg.
    pub(super) load: f64,
    /// Extent of the removed material along the tool axis, over the same steps, mm.
    pub(super) depth: f64,
    /// Sum of the thicknesses of the slices in which the arc is that of a slot, mm.
    pub(super) full_depth: f64,
    /// Material on both sides at full width.
    full: bool,
    /// Part of a slot.
    pub(super) slot: bool,
}

/// Arcs of all steps. Chips of all steps at feed in the same direction over the tip motion `window` that ends with a
/// step show its arc: the rays seldom meet all chips of a step that is shorter than a cell.
pub(super) fn of_steps(
    places: &[StepPlace],
    removal: &StepRemoval,
    cuts: &[BlockCut],
    circle: &Circle,
) -> Vec<StepArc> {
    let mut own: Vec<Option<&BlockCut>> = vec![None; places.len()];
    for c in cuts.iter().filter(|c| c.height[0] <= c.height[1]) {
        if let Some(cut) = own.get_mut(c.block as usize) {
            *cut = Some(c);
        }
    }
    let neighbours = circle.neighbours();
    let at_feed = |i: usize| places[i].kind != MoveKind::Rapid;
    let arc = |i: usize| {
        if !at_feed(i) || !removal.cuts[i] {
            return StepArc::default();
        }
        let (mut sides, mut heights) = (Sides::NONE, [f64::INFINITY, f64::NEG_INFINITY]);
        let mut lune = None::<Lune>;
        let mut way = 0.0;
        for k in (0..=i).rev() {
            let turned = places[k].step.dot(&places[i].step) < MIN_FEED_COSINE * places[k].way * places[i].way;
            if !at_feed(k) || turned {
                break;
            }
            match own[k].map(|cut| (cut, &cut.lune)) {
                Some((_, Some(own))) => lune.get_or_insert(Lune::NONE).join(own),
                Some((cut, None)) => {
                    sides.join(&cut.sides);
                    heights = [heights[0].min(cut.height[0]), heights[1].max(cut.height[1])];
                }
                None => {}
            }
            way += places[k].way;
            if way >= circle.window {
                break;
            }
        }
        match lune {
            Some(lune) => StepArc::about_axis(&lune, circle),
            None => StepArc::new(&sides, heights, circle, &neighbours),
        }
    };
    let mut arcs: Vec<StepArc> = (0..places.len()).into_par_iter().map(arc).collect();
    mark_slots(places, removal, &mut arcs, 2.0 * circle.radius);
    arcs
}

impl StepArc {
    /// The arc of a stroke along the axis: that part of the circle of the cutter, about its axis, which meets material. It
    /// may be a whole turn. A stroke is no slot.
    fn about_axis(lune: &Lune, circle: &Circle) -> Self {
        let found = lune.arc();
        let unseen = libm::asin((circle.unseen() / circle.radius).min(1.0)).to_degrees();
        Self { found, bound: (found + 2.0 * unseen).min(360.0), ..Self::default() }
    }

    /// `heights`: between which material is removed, mm.
    fn new(sides: &Sides, heights: [f64; 2], circle: &Circle, neighbours: &[RangeInclusive<usize>]) -> Self {
        let unseen = circle.unseen();
        let rim = circle.radius - unseen;
        let mut arc = Self { depth: (heights[1] - heights[0]).max(0.0), ..Self::default() };
        let mut last = Sides::NONE.over(0..=0);
        for (k, neighbours) in neighbours.iter().enumerate() {
            let [from, to] = sides.over(k..=k);
            if from <= to {
                let found = circle.arc([from, to]);
                let [low, high] = [circle.slices.edge(k).max(heights[0]), circle.slices.edge(k + 1).min(heights[1])];
                let thickness = (high - low).max(0.0);
                let loaded = circle.loaded(found, sides.free_between(k));
                arc.load += loaded / SLOT_ARC * thickness;
                arc.full_depth += if loaded >= MIN_FULL_ARC { thickness } else { 0.0 };
                arc.found = arc.found.max(found);
                arc.full |= rim > 0.0 && from <= -rim && to >= rim;
            }
            let wider = sides.over(neighbours.clone());
            // Neighbours with the same sides have the same bound.
            if wider[0] <= wider[1] && (wider[0] < last[0] || wider[1] > last[1]) {
                arc.bound = arc.bound.max(circle.arc([wider[0] - unseen, wider[1] + unseen]));
                last = wider;
            }
        }
        arc
    }
}

/// Marks the slots: steps at full width, and the cuts without a break up to the tip motion `reach` before and behind
/// such a step, in which the cutter runs into the channel and out of it.
fn mark_slots(places: &[StepPlace], removal: &StepRemoval, arcs: &mut [StepArc], reach: f64) {
    for full in (0..arcs.len()).filter(|i| arcs[*i].full).collect::<Vec<_>>() {
        let cuts = |i: &usize| removal.cuts[*i] && places[*i].kind != MoveKind::Rapid;
        arcs[full].slot = true;
        let mut way = 0.0;
        for i in (0..full).rev().take_while(cuts) {
            way += places[i + 1].way;
            if way > reach || arcs[i].full {
                break;
            }
            arcs[i].slot = true;
        }
        way = 0.0;
        for i in (full + 1..arcs.len()).take_while(cuts) {
            way += places[i].way;
            if way > reach || arcs[i].full {
                break;
            }
            arcs[i].slot = true;
        }
    }
}

impl ArcTimes {
    /// The classes of all steps at feed.
    pub(super) fn new(places: &[StepPlace], removal: &StepRemoval, arcs: &[StepArc]) -> Self {
        let mut found = Self::default();
        for (i, place) in places.iter().enumerate().filter(|(_, p)| p.kind != MoveKind::Rapid) {
            let (time, path) = (Sec(place.time), Mm(place.way));
            let add = |to: &mut TimeAndPath| {
                to.time += time;
                to.path += path;
            };
            if !removal.cuts[i] {
                add(&mut found.air);
                continue;
            }
            if arcs[i].slot {
                add(&mut found.slots);
            }
            let class = ((arcs[i].found / CLASS_WIDTH).ceil() as usize).clamp(1, CLASSES) - 1;
            found.time[class] += time;
            found.path[class] += path;
        }
        found
    }

    /// Time in which the cutter is engaged.
    pub fn cutting(&self) -> Sec {
        self.time.into_iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wall to the left at one height and a floor to the right at another: the arc is the larger one of both, not that
    /// from the wall to the floor. At the same height it is.
    #[test]
    fn heights_far_apart_are_not_one_arc() {
        let slices = Slices::new(10.0, 0.05);
        let circle = Circle { radius: 2.0, cell: 0.05, window: 0.2, slices };
        let arc = |floor: f64, wall: f64| {
            let mut sides = Sides::NONE;
            sides.add(&slices, [[floor, 1.0], [floor, 2.0]]);
            sides.add(&slices, [[wall, -2.0], [wall, -1.0]]);
            StepArc::new(&sides, [floor.min(wall), floor.max(wall)], &circle, &circle.neighbours())
        };
        let separate = arc(0.1, 5.0);
        assert!((separate.found - 60.0).abs() < 1e-3 && separate.bound > 60.0 && separate.bound < 65.0, "{separate:?}");
        assert!(!separate.full);
        for one in [arc(0.1, 0.1), arc(5.0, 5.0)] {
            assert!(one.found > 179.9 && one.full, "{one:?}");
        }
        // Rays may have missed material up to a diagonal of a cell over a chip, so that both may lie at one height.
        let near = arc(5.0, slices.edge(slices.at(5.0) + 1) + 0.5 * circle.unseen());
        assert!(near.found < 60.1 && near.bound > 179.9, "{near:?}");
    }
}
