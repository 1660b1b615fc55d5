//! Roughing passes against the stock that they find, one after the other.
//!
//! Before: the passes of a `rough` operation in all sectors. After: passes that cut, from the first contact with the
//! stock to the last, with their leads. Between two cuts the tool runs through air at link feed. A pass whose start the
//! tool reaches from the end of the pass before on a straight way through air, clear of the part, is joined to it.
//!
//! The stock is simulated pass by pass, so that each pass finds what all passes before it have left. A cutter that is
//! enlarged by the error between the rays of the stock decides where it is in air; its shank and holder count as well.

use super::direct_link::DirectLinks;
use super::stock_steps::{PathPoint, cutter_alone, error_between_rays, stations, steps_of};
use crate::collide::ToolSolid;
use crate::ir::{ClOperation, ClPass, Operation, Program};
use crate::progress::Work;
use crate::stock::{self, Field, StepKind, Touched};
use std::ops::Range;

/// Least length of a run through air inside of a pass, mm: on a shorter one the change of feed gains no time.
const LEAST_AIR: f64 = 3.0;

/// Longest straight link through air, mm.
const LONGEST_LINK: f64 = 80.0;

/// Reduces the passes of an operation, and removes their cuts from the stock.
pub(super) fn reduce(
    program: &Program,
    operation: &Operation,
    direct: &DirectLinks<'_>,
    planned: &mut ClOperation,
    (field, work): (&mut Field, &Work),
) {
    let solid = &program.tools[operation.tool].solid;
    let thickness = operation.rest.map_or(0.0, |t| t.get());
    let by = error_between_rays(field, solid);
    let cutter = cutter_alone(solid, 0.0);
    let grown = ToolSolid { shank: solid.shank.clone(), holder: solid.holder.clone(), ..cutter_alone(solid, by) };
    let mut kept: Vec<ClPass> = Vec::new();
    let (mut cut, mut air, mut joined) = (0.0, 0.0, 0);
    let count = planned.passes.len();
    for pass in std::mem::take(&mut planned.passes) {
        work.step(());
        let line = stations(&program.machine, &pass);
        let Some(found) = look(program, field, &grown, by, &line) else { continue };
        if !found.iter().any(|depth| *depth > thickness) {
            continue;
        }
        let run = with_leads(operation, &line, &found);
        let line = &line[run.clone()];
        let gaps = gaps(operation, line, &found[run.start..run.end - 1]);
        let mut pass = ClPass { points: Vec::new(), air: Vec::new(), direct: false, ..pass };
        for (i, station) in line.iter().enumerate() {
            let in_gap = gaps.iter().any(|gap| gap.start < i && i <= gap.end);
            let border = gaps.iter().any(|gap| gap.start == i || gap.end == i);
            if station.planned || border || i == 0 || i + 1 == line.len() {
                if in_gap {
                    pass.air.push(pass.points.len());
                }
                pass.points.push(station.point);
            }
        }
        for (i, w) in line.windows(2).enumerate() {
            let way = (w[1].point.tip - w[0].point.tip).norm();
            if gaps.iter().any(|gap| gap.contains(&i)) { air += way } else { cut += way }
        }
        if let Some(end) = kept.last().and_then(|before| before.points.last()) {
            let start = pass.points[0];
            let near = (start.tip - end.tip).norm() <= LONGEST_LINK;
            pass.direct = near && direct.straight(end, &start) && {
                let link = ClPass { points: vec![*end, start], air: Vec::new(), direct: false, ..pass.clone() };
                let line = stations(&program.machine, &link);
                look(program, field, &grown, by, &line).is_some_and(|found| found.iter().all(|d| *d == 0.0))
            };
        }
        joined += usize::from(pass.direct);
        stock::simulate(field, &cutter, steps_of(&program.machine, line, StepKind::Cut, 0.0));
        kept.push(pass);
    }
    planned.notes.push(format!(
        "of {count} passes {} cut, {joined} of them joined to the pass before through air; {cut:.0} mm at cutting feed, {air:.0} mm through air at link feed; stock in cells of {:.2} mm",
        kept.len(),
        field.cell()
    ));
    planned.passes = kept;
}

/// Depth of the tool in the stock on each step between stations, mm; `None` without steps.
fn look(program: &Program, field: &mut Field, grown: &ToolSolid, by: f64, line: &[PathPoint]) -> Option<Vec<f64>> {
    let mut depths = vec![0.0_f64; line.len().checked_sub(1).filter(|n| *n > 0)?];
    for met in stock::simulate(field, grown, steps_of(&program.machine, line, StepKind::Rapid, by)).collisions {
        let depth = if met.what == Touched::Cutter { met.depth } else { met.depth.max(by) };
        let at = &mut depths[met.block as usize];
        *at = at.max(depth);
    }
    Some(depths)
}

/// From the first cut to the last, with the leads; as a range of stations.
fn with_leads(operation: &Operation, line: &[PathPoint], depths: &[f64]) -> Range<usize> {
    let deep = |d: &f64| *d > operation.rest.map_or(0.0, |t| t.get());
    let first = depths.iter().position(deep).unwrap_or(0);
    let last = depths.iter().rposition(deep).unwrap_or(depths.len() - 1);
    // A pass begins and ends in air.
    let first = depths[..first].iter().rposition(|d| *d == 0.0).map_or(0, |i| i + 1);
    let last = depths[last..].iter().position(|d| *d == 0.0).map_or(depths.len(), |i| last + i);
    let step = |i: usize| (line[i + 1].point.tip - line[i].point.tip).norm();
    let (mut start, mut lead) = (first, 0.0);
    while start > 0 && lead < operation.lead_in.get() {
        start -= 1;
        lead += step(start);
    }
    let (mut end, mut lead) = (last, 0.0);
    while end < depths.len() && lead < operation.lead_out.get() {
        lead += step(end);
        end += 1;
    }
    start..end + 1
}

/// Ranges of steps through air between two cuts, without the leads of these cuts.
fn gaps(operation: &Operation, line: &[PathPoint], depths: &[f64]) -> Vec<Range<usize>> {
    let step = |i: usize| (line[i + 1].point.tip - line[i].point.tip).norm();
    let mut gaps = Vec::new();
    let mut i = 0;
    while i < depths.len() {
        if depths[i] > 0.0 {
            i += 1;
            continue;
        }
        let (mut start, mut end) = (i, (i..depths.len()).find(|k| depths[*k] > 0.0).unwrap_or(depths.len()));
        i = end;
        // The first and the last steps of a pass are its leads.
        if start == 0 || end == depths.len() {
            continue;
        }
        let mut lead = 0.0;
        while start < end && lead < operation.lead_out.get() {
            lead += step(start);
            start += 1;
        }
        lead = 0.0;
        while start < end && lead < operation.lead_in.get() {
            end -= 1;
            lead += step(end);
        }
        if (start..end).map(step).sum::<f64>() >= LEAST_AIR {
            gaps.push(start..end);
        }
    }
    gaps
}
