//! Roughing passes against the stock that they find, one after the other.
//!
//! Before: the passes of a `rough` operation in all sectors. After: passes that cut, from the first contact with the
//! stock to the last, with their leads. On leads and between two cuts the tool runs through air at link feed, except for
//! the last millimetre before a cut and the first behind it. A pass whose start the tool reaches from the end of the pass before on a straight way through air, clear of the part, is joined to it.
//!
//! The stock is simulated pass by pass, so that each pass finds what all passes before it have left. A cutter that is
//! enlarged by the error between the rays of the stock decides where it is in air; its shank and holder count as well.

use super::direct_link::DirectLinks;
use super::stock_steps::{PathPoint, cutter_alone, error_between_rays, stations, steps_of};
use crate::collide::ToolSolid;
use crate::ir::{ClOperation, ClPass, ClPoint, Operation, Program};
use crate::progress::Work;
use crate::stock::{self, Field, StepKind, Touched};
use std::ops::Range;

/// Way at cutting feed before a cut and behind it, mm: the tool slows down from link feed, and the stock is known to the
/// cell of the simulation.
const BESIDE_CUT: f64 = 0.5;

/// Least length of a run through air, mm: on a shorter one the change of feed gains no time.
const LEAST_AIR: f64 = 1.0;

/// Longest straight link through air, mm.
const LONGEST_LINK: f64 = 80.0;

/// Passes of one operation, reduced one after the other.
struct Reduction<'a> {
    program: &'a Program,
    operation: &'a Operation,
    direct: &'a DirectLinks<'a>,
    /// Stock that is no deeper in the tool is left to the next operation, mm.
    thickness: f64,
    /// Error of the depth between the rays of the stock, mm.
    by: f64,
    /// The cutter, and the tool with its cutter enlarged by this error.
    cutter: ToolSolid,
    grown: ToolSolid,
}

/// A pass that cuts.
struct Reduced {
    pass: ClPass,
    /// Dense stations from the first to the last.
    line: Vec<PathPoint>,
    /// Length of the path through stock and through air, mm.
    lengths: [f64; 2],
}

/// Reduces the passes of an operation, and removes their cuts from the stock.
pub(super) fn reduce(
    program: &Program,
    operation: &Operation,
    direct: &DirectLinks<'_>,
    planned: &mut ClOperation,
    (field, work): (&mut Field, &Work),
) {
    let solid = &program.tools[operation.tool].solid;
    let by = error_between_rays(field, solid);
    let reduction = Reduction {
        program,
        operation,
        direct,
        thickness: operation.rest.map_or(0.0, |t| t.get()),
        by,
        cutter: cutter_alone(solid, 0.0),
        grown: ToolSolid { shank: solid.shank.clone(), holder: solid.holder.clone(), ..cutter_alone(solid, by) },
    };
    let mut kept: Vec<ClPass> = Vec::new();
    let (mut lengths, mut joined) = ([0.0; 2], 0);
    let count = planned.passes.len();
    for pass in std::mem::take(&mut planned.passes) {
        work.step(());
        let Some(mut reduced) = reduction.reduced(pass, field) else { continue };
        if let Some(end) = kept.last().and_then(|before| before.points.last()) {
            reduced.pass.direct = reduction.joins(end, &reduced.pass, field);
        }
        joined += usize::from(reduced.pass.direct);
        lengths = [0, 1].map(|k: usize| lengths[k] + reduced.lengths[k]);
        let machine = &program.machine;
        stock::simulate(field, &reduction.cutter, steps_of(machine, &reduced.line, StepKind::Cut, 0.0));
        kept.push(reduced.pass);
    }
    let [cut, air] = lengths;
    planned.notes.push(format!(
        "of {count} passes {} cut, {joined} of them joined to the pass before through air; {cut:.0} mm at cutting feed, {air:.0} mm through air at link feed; stock in cells of {:.2} mm",
        kept.len(),
        field.cell()
    ));
    planned.passes = kept;
}

impl Reduction<'_> {
    /// The part of a pass from the first cut to the last with its leads; `None` for a pass that cuts nothing.
    fn reduced(&self, pass: ClPass, field: &mut Field) -> Option<Reduced> {
        let mut line = stations(&self.program.machine, &pass);
        let depths = self.depths(field, &line)?;
        if !depths.iter().any(|depth| *depth > self.thickness) {
            return None;
        }
        let run = self.with_leads(&line, &depths);
        let fast = through_air(&line[run.clone()], &depths[run.start..run.end - 1]);
        line = line[run].to_vec();
        let mut reduced = ClPass { points: Vec::new(), air: Vec::new(), direct: false, ..pass };
        let mut lengths = [0.0; 2];
        for (i, station) in line.iter().enumerate() {
            let [before, after] = [i.checked_sub(1).map(|b| fast[b]), fast.get(i).copied()];
            if let Some(fast) = before {
                lengths[usize::from(fast)] += (station.point.tip - line[i - 1].point.tip).norm();
            }
            if station.planned || before != after {
                if before == Some(true) {
                    reduced.air.push(reduced.points.len());
                }
                reduced.points.push(station.point);
            }
        }
        Some(Reduced { pass: reduced, line, lengths })
    }

    /// True when the tool goes straight from the end of a pass to the start of the next through air, clear of the part.
    fn joins(&self, end: &ClPoint, next: &ClPass, field: &mut Field) -> bool {
        let Some(start) = next.points.first() else { return false };
        let near = (start.tip - end.tip).norm() <= LONGEST_LINK;
        near && self.direct.straight(end, start) && {
            let link = ClPass { points: vec![*end, *start], air: Vec::new(), direct: false, ..next.clone() };
            let line = stations(&self.program.machine, &link);
            self.depths(field, &line).is_some_and(|depths| depths.iter().all(|d| *d == 0.0))
        }
    }

    /// Depth of the tool in the stock on each step between stations, mm; `None` without steps.
    fn depths(&self, field: &mut Field, line: &[PathPoint]) -> Option<Vec<f64>> {
        let mut depths = vec![0.0_f64; line.len().checked_sub(1).filter(|n| *n > 0)?];
        let steps = steps_of(&self.program.machine, line, StepKind::Rapid, self.by);
        for met in stock::simulate(field, &self.grown, steps).collisions {
            let depth = if met.what == Touched::Cutter { met.depth } else { met.depth.max(self.by) };
            let at = &mut depths[met.block as usize];
            *at = at.max(depth);
        }
        Some(depths)
    }

    /// From the first cut to the last, with the leads; as a range of stations.
    fn with_leads(&self, line: &[PathPoint], depths: &[f64]) -> Range<usize> {
        let deep = |d: &f64| *d > self.thickness;
        let first = depths.iter().position(deep).unwrap_or(0);
        let last = depths.iter().rposition(deep).unwrap_or(depths.len() - 1);
        // A pass begins and ends in air.
        let first = depths[..first].iter().rposition(|d| *d == 0.0).map_or(0, |i| i + 1);
        let last = depths[last..].iter().position(|d| *d == 0.0).map_or(depths.len(), |i| last + i);
        let (mut start, mut lead) = (first, 0.0);
        while start > 0 && lead < self.operation.lead_in.get() {
            start -= 1;
            lead += length(line, start);
        }
        let (mut end, mut lead) = (last, 0.0);
        while end < depths.len() && lead < self.operation.lead_out.get() {
            lead += length(line, end);
            end += 1;
        }
        start..end + 1
    }
}

/// Length of a step, mm.
fn length(line: &[PathPoint], step: usize) -> f64 {
    (line[step + 1].point.tip - line[step].point.tip).norm()
}

/// For each step whether the tool runs through air at link feed: leads and gaps between cuts, less the way beside cuts.
fn through_air(line: &[PathPoint], depths: &[f64]) -> Vec<bool> {
    let mut fast = vec![false; depths.len()];
    let mut next = 0;
    while let Some(start) = (next..depths.len()).find(|i| depths[*i] == 0.0) {
        let end = (start..depths.len()).find(|i| depths[*i] > 0.0).unwrap_or(depths.len());
        next = end;
        let (mut from, mut to) = (start, end);
        let mut beside = 0.0;
        while start > 0 && from < to && beside < BESIDE_CUT {
            beside += length(line, from);
            from += 1;
        }
        beside = 0.0;
        while end < depths.len() && from < to && beside < BESIDE_CUT {
            to -= 1;
            beside += length(line, to);
        }
        if (from..to).map(|i| length(line, i)).sum::<f64>() >= LEAST_AIR {
            fast[from..to].fill(true);
        }
    }
    fast
}
