//! Time and way at feed over the arc of engagement.

use super::{Removal, StepPlace};
use crate::ir::MoveKind;
use crate::stock::BlockCut;
use serde::Serialize;

/// Width of a class, degrees.
pub const CLASS: f64 = 15.0;

/// Number of classes, from 0 to 180 degrees.
pub const CLASSES: usize = 12;

/// Time and way of an operation at feed, by the arc of engagement. Class k holds arcs over k times 15 degrees up to
/// k + 1 times 15 degrees; the first one holds arcs of zero as well.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ArcTimes {
    /// Time of each class by the feeds of the blocks, s.
    pub time: [f64; CLASSES],
    /// Length of the tip path of each class, mm.
    pub way: [f64; CLASSES],
    /// Time, s, and way, mm, in which nothing is removed.
    pub air: [f64; 2],
}

impl ArcTimes {
    /// The classes of all steps at feed. The arc of a step is the largest one of the steps with chips over the tip
    /// motion `window`, mm, that ends with it: the rays seldom meet all chips of a step that is shorter than a cell.
    pub(super) fn new(
        places: &[StepPlace],
        removal: &Removal,
        cuts: &[BlockCut],
        window: f64,
        arc: &dyn Fn(&BlockCut) -> f64,
    ) -> Self {
        let mut arcs = vec![0.0; places.len()];
        for c in cuts.iter().filter(|c| c.height[0] <= c.height[1]) {
            if let Some(a) = arcs.get_mut(c.block as usize) {
                *a = arc(c);
            }
        }
        let mut found = Self::default();
        for (i, place) in places.iter().enumerate().filter(|(_, p)| p.kind != MoveKind::Rapid) {
            if !removal.cuts[i] {
                found.air = [found.air[0] + place.time, found.air[1] + place.way];
                continue;
            }
            let (mut most, mut way) = (0.0_f64, 0.0);
            for k in (0..=i).rev() {
                most = most.max(arcs[k]);
                way += places[k].way;
                if way >= window {
                    break;
                }
            }
            let class = ((most / CLASS).ceil() as usize).clamp(1, CLASSES) - 1;
            found.time[class] += place.time;
            found.way[class] += place.way;
        }
        found
    }

    /// Time in which the cutter is engaged, s.
    pub fn cutting(&self) -> f64 {
        self.time.iter().sum()
    }
}
