//! How deep a tool would lie in the stock on its way, without cutting it.

use super::run::{self, Frame, Swept};
use super::shape::SolidShape;
use super::simulate::{CONTACT, body, touch};
use super::{Field, Step, Touched};
use crate::collide::ToolSolid;
use rayon::prelude::*;
use std::ops::Range;

/// Depths of a tool in the stock over a step, mm: zero where it only touches, infinite where it lies deeper than the caller
/// wants to know.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Depth {
    /// Of the cutter.
    pub cutter: f64,
    /// Of shank and holder; not searched where the depth of the cutter is infinite.
    pub body: f64,
}

/// A tool on its way through the stock.
struct Probe<'a> {
    field: &'a Field,
    frames: [Frame; 3],
    parts: Vec<(Touched, SolidShape)>,
    steps: &'a [Step],
    /// Depths from which on the depth of cutter and body is infinite, mm.
    enough: [f64; 2],
}

/// The depths of a tool over steps, whatever their kind. Where the stock lies deeper than `enough` inside of a part, mm, the
/// depth is infinite.
pub fn depths(field: &Field, tool: &ToolSolid, steps: &[Step], enough: f64) -> Vec<Depth> {
    let (probe, runs) = Probe::new(field, tool, steps, [enough; 2]);
    match &runs[..] {
        // The threads would cost more than the run.
        [] | [_] => runs.iter().flat_map(|run| probe.depths(run)).collect(),
        _ => runs.par_iter().flat_map_iter(|run| probe.depths(run)).collect(),
    }
}

/// Whether stock lies no deeper than `most` inside of the cutter of a tool over steps, mm, and touches no other part of it.
pub fn is_free(field: &Field, tool: &ToolSolid, steps: &[Step], most: f64) -> bool {
    let (probe, runs) = Probe::new(field, tool, steps, [most, 0.0]);
    let is_free = |run: &Range<usize>| probe.depths(run).iter().all(|d| d.cutter <= most && d.body == 0.0);
    match &runs[..] {
        [] | [_] => runs.iter().all(is_free),
        _ => runs.par_iter().all(is_free),
    }
}

impl<'a> Probe<'a> {
    /// The probe, and the runs of its steps.
    fn new(field: &'a Field, tool: &ToolSolid, steps: &'a [Step], enough: [f64; 2]) -> (Self, Vec<Range<usize>>) {
        let cutter = SolidShape::cutter(tool);
        let mut parts = vec![(Touched::Cutter, cutter)];
        parts.extend(body(tool));
        let frames = [0, 1, 2].map(|axis| Frame::of(field, axis));
        (Self { field, frames, parts, steps, enough }, run::split(steps, cutter.reach()))
    }

    /// The depths over the steps of a run.
    fn depths(&self, run: &Range<usize>) -> Vec<Depth> {
        let steps = &self.steps[run.clone()];
        let mut found = vec![Depth::default(); steps.len()];
        let swept = self.frames.each_ref().map(|frame| Swept::new(steps, frame));
        for (what, shape) in &self.parts {
            for ((family, frame), swept) in self.field.families.iter().zip(&self.frames).zip(&swept) {
                let Some(whole) = swept.whole(shape, frame) else { continue };
                for t in family.near(frame.low, self.field.cell, &whole) {
                    let tile = &family.tiles[t];
                    // A part that touches nothing over the run touches nothing in its steps.
                    if !tile.meets(&whole.low, &whole.high) || !tile.touches(&whole, CONTACT - whole.error()) {
                        continue;
                    }
                    for (depth, sweep) in found.iter_mut().zip(&swept.sweeps) {
                        if depth.cutter == f64::INFINITY || depth.body == f64::INFINITY {
                            continue;
                        }
                        let [cutter, body] = self.enough;
                        let (of_part, enough) = match what {
                            Touched::Cutter => (&mut depth.cutter, cutter),
                            Touched::Shank | Touched::Holder => (&mut depth.body, body),
                        };
                        if let Some(overlap) = touch(tile, sweep, shape, of_part.max(CONTACT), enough) {
                            *of_part = if overlap.depth > enough { f64::INFINITY } else { overlap.depth };
                        }
                    }
                }
            }
        }
        found
    }
}
