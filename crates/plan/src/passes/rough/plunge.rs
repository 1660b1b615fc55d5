//! Plan of the operation `plunge`: strokes along the tool axis, for channels that are deep and narrow.
//!
//! Before: an operation. After: for each stroke a pass of two points, above the stock and at the floor, with one axis. The
//! side of a tool yields under the load of a cut across its axis; along its axis it is stiff.
//!
//! *Places.* Rows lie across the channel, from outside of the stock at one end to the other. At each row the tip stands on
//! the allowance of the hub, or on the lowest level above it on which the tool fits. The row goes from the place beside
//! one wall to the place beside the other. The axes are those of `rough`: they follow the rulings, tilt away from the
//! walls, and fan out with them. So the distance of two strokes is measured at their lower and at their upper ends; the
//! larger one is at most the step. Every other row runs backwards, so that a stroke begins beside the stroke before.
//!
//! Where a wall is hollow or twisted, strokes from the floor do not come near to all of it. Beside such a wall a row has
//! strokes that end higher, each where the tool comes nearer to the wall than the strokes before by the step.
//!
//! *The middle of the end.* Most tools do not cut at their centre. A stroke that lies at most the width of the teeth beside
//! strokes that are done has the middle of its end over the space that these have cleared; the first row stands outside of
//! the stock. Where floors rise from row to row, a stroke would meet the floor of the row before with its middle; the row
//! begins at the end from which fewer do. What is left of such places the stock decides, see
//! [`crate::passes::link`]: it ends a stroke before its middle meets material.
//!
//! *Distances.* A tool that goes up along its axis sweeps only space above it. A solid with longer flutes, and with a shank
//! and holder that are nowhere thinner than below, holds all places of a stroke. Its distances at the floor are those of
//! the whole stroke.

use super::NamedLine;
use super::groove::passes;
use super::layers::{LayerStation, Level, Roughing, length_of, limit_leads};
use crate::passes::context::{PassContext, maximal_ranges};
use base::units::{Mm, length};
use diagnostics::Aborted;
use ir::{CcOperation, CcPoint, Operation, OperationId, Program};
use nalgebra::Point3;
use rayon::prelude::*;
use std::ops::Range;

/// Places along the channel at which the free space is measured, for each step.
const PLACES_PER_STEP: f64 = 8.0;

/// Steps between heights at which the end of a stroke is tried, as a share of the radius.
const STROKE_HEIGHT_STEP: f64 = 0.5;

/// Step of the search for the height at which a stroke leaves the blank, mm.
const HEIGHT_STEP_MM: f64 = 0.5;

/// Where the steps of a row are measured: beside both walls and in the middle.
const ACROSS_SHARES: [f64; 3] = [0.0, 0.5, 1.0];

/// Plans a plunge operation.
///
/// # Errors
/// The tool fits nowhere; the strokes would be too many. The sink holds the reason.
pub(crate) fn plan(cx: &mut PassContext<'_>, id: OperationId, stepover: Mm) -> Result<CcOperation, Aborted> {
    let operation = &cx.program.operations[id];
    let tool = &cx.program.tools[operation.tool];
    let swept = tool.solid.swept_along_axis(2.0 * cx.program.stock.profile.iter().map(|p| p[0]).fold(0.0, f64::max));
    let program = cx.program.with_solid(operation.tool, &swept);
    let depth = STROKE_HEIGHT_STEP * tool.solid.radius();
    let (mut all, mut rows) = (Vec::new(), 0);
    for passage in cx.program.part.passages() {
        let upright = Roughing::with_depth(&program, operation, passage.id, cx.obstacles, depth, cx.progress);
        let roughing = upright.ok_or(Aborted)?.tilted(cx.progress);
        cx.go_on()?;
        let strokes = ChannelStrokes {
            program: &program,
            roughing: &roughing,
            ends: roughing.ends(Level::Share(0.0)),
            step: stepover.get(),
            lead: operation.lead_in.get(),
        };
        let (lines, of_passage) = strokes.all(cx, operation)?;
        rows += of_passage;
        all.extend(passes(&roughing, lines));
    }
    if all.is_empty() {
        return Err(fits_nowhere(cx, operation));
    }
    let middle = match tool.toothless_radius() {
        Some(radius) if radius > 0.0 => format!("the middle of its end, {} across, has no teeth", length(2.0 * radius)),
        _ => "the tool cuts at its centre".to_owned(),
    };
    let channels = if cx.program.part.blades.len() == 1 { "a channel" } else { "the channels of a sector" };
    let notes = vec![format!("{} strokes in {rows} rows of {channels}, at most {stepover} apart; {middle}", all.len())];
    Ok(CcOperation { operation: id, passes: all, notes })
}

fn fits_nowhere(cx: &mut PassContext<'_>, operation: &Operation) -> Aborted {
    let tool = &cx.program.tools[operation.tool];
    let text =
        format!("no stroke of {} in `{}` keeps the allowances along its whole length", tool.name, operation.name);
    super::nothing_to_cut(cx, operation, text)
}

/// Where the tool may stand across the channel at one place along it.
#[derive(Clone, Copy)]
struct Stand {
    station: LayerStation,
    level: Level,
    /// The channel lies in the stock here.
    inside: bool,
}

/// A stroke: its ends, and where its axis leaves the blank.
#[derive(Clone, Copy)]
struct Stroke {
    bottom: CcPoint,
    top: CcPoint,
    /// Height over the bottom at which the middle of the tool leaves the blank, mm.
    height: f64,
}

impl Stroke {
    /// Larger distance of the axes of two strokes at the higher one of their lower ends and at the higher one of their
    /// upper ends, mm.
    fn distance(&self, other: &Self) -> f64 {
        let (tip, axis) = (other.bottom.position, other.bottom.normal);
        let from = |p: Point3<f64>| (p - tip - axis * (p - tip).dot(&axis)).norm();
        let at = |h: f64| from(self.bottom.position + self.bottom.normal * h);
        let foot = (tip - self.bottom.position).dot(&self.bottom.normal).max(0.0);
        at(foot).max(at(self.height.max(foot + other.height)))
    }
}

/// The strokes of one channel.
struct ChannelStrokes<'a> {
    program: &'a Program,
    roughing: &'a Roughing<'a>,
    /// u at which the channel comes into the blank and leaves it.
    ends: [f64; 2],
    /// Largest distance of neighbouring strokes, mm.
    step: f64,
    lead: f64,
}

impl ChannelStrokes<'_> {
    /// All strokes with their names, and the number of rows.
    fn all(&self, cx: &mut PassContext<'_>, operation: &Operation) -> Result<(Vec<NamedLine>, usize), Aborted> {
        let grid = self.grid();
        // Each place of the grid takes about as long as a point of a line; a row has a stroke for each step across.
        let widest = grid.iter().map(|u| self.roughing.chart.width(*u, 1.0)).fold(0.0, f64::max);
        cx.check_points(operation, grid.len() as f64 * (widest / self.step + 1.0))?;
        let work = cx.progress.begin(format!("{}, places", operation.name), grid.len());
        let stands: Vec<Option<Stand>> = grid.par_iter().map(|u| work.do_step(|| self.stand(*u)).flatten()).collect();
        drop(work);
        cx.go_on()?;
        let mut lines: Vec<NamedLine> = Vec::new();
        let mut rows = 0;
        for part in self.parts(&stands) {
            for row in self.rows(&part) {
                rows += 1;
                let stroke = |(k, stroke): (usize, Stroke)| NamedLine {
                    name: format!("row {rows} stroke {}", k + 1),
                    points: vec![stroke.top, stroke.bottom],
                };
                lines.extend(row.into_iter().enumerate().map(stroke));
            }
        }
        Ok((lines, rows))
    }

    /// Places along the channel, from outside of the stock to outside of it.
    fn grid(&self) -> Vec<f64> {
        let chart = &self.roughing.chart;
        // A tool outside of the stock has its whole end there, also where the channel ends at a slant of 60 deg.
        let lead = 2.0 * self.roughing.radius() + self.step;
        let ends = self.ends;
        let [from, to] = [ends[0] - chart.lead(0.0, 0.0, lead), ends[1] + chart.lead(1.0, 0.0, lead)];
        let length =
            [0.0, 1.0].map(|v| length_of(|u| chart.point(u, v, 0.5), from, to)).into_iter().fold(0.0, f64::max);
        let count = (PLACES_PER_STEP * length / self.step).ceil().max(8.0) as usize;
        (0..=count).map(|i| from + (to - from) * i as f64 / count as f64).collect()
    }

    /// The lowest level on which the tool fits at a place; `None` where it fits on none.
    fn stand(&self, u: f64) -> Option<Stand> {
        let roughing = self.roughing;
        let inside = (self.ends[0]..=self.ends[1]).contains(&u);
        let lowest = roughing.hub_allowance();
        for k in 0.. {
            let level = Level::OverHub(lowest + k as f64 * roughing.depth);
            if k > 0 && level.v(&roughing.chart, u, 0.5) >= 1.0 {
                return None;
            }
            if let Some(free) = roughing.free_interval(u, level) {
                return Some(Stand { station: LayerStation { u, free }, level, inside });
            }
        }
        None
    }

    /// Parts of the channel in which the tool fits, each from the end at which it begins.
    fn parts(&self, stands: &[Option<Stand>]) -> Vec<Vec<Stand>> {
        let mut parts = Vec::new();
        for range in maximal_ranges(stands.len(), |i| stands[i].is_some()) {
            let mut part: Vec<Stand> = stands[range].iter().flatten().copied().collect();
            let mut stations: Vec<LayerStation> = part.iter().map(|s| s.station).collect();
            if limit_leads(&mut stations, self.roughing.free_ends(), |k, _| part[k].inside).is_err()
                || !part.iter().any(|s| s.inside)
            {
                continue;
            }
            part.iter_mut().zip(stations).for_each(|(stand, station)| stand.station = station);
            let open = [part.first(), part.last()].map(|end| end.is_some_and(|s| !s.inside));
            if open == [false, true] || (open == [true; 2] && self.rises_backwards(&part)) {
                part.reverse();
            }
            parts.push(part);
        }
        parts
    }

    /// True where the floors of the strokes rise more from the last place to the first than from the first to the last.
    fn rises_backwards(&self, part: &[Stand]) -> bool {
        let stroke = |s: &Stand| self.stroke(s, 0.5);
        let rise =
            |a: &Stroke, b: &Stroke| (b.bottom.position - a.bottom.position).dot(&(a.bottom.normal + b.bottom.normal));
        part.windows(2).map(|w| rise(&stroke(&w[0]), &stroke(&w[1]))).sum::<f64>() < 0.0
    }

    /// The stroke at a share of the distance across from the place beside the first wall to the place beside the second.
    fn stroke(&self, stand: &Stand, share: f64) -> Stroke {
        let [from, to] = stand.station.free;
        let bottom = self.roughing.cc_point(stand.station.u, stand.level, from + (to - from) * share);
        let profile = &self.program.stock.profile;
        let over = |height: f64| {
            let p = bottom.position + bottom.normal * height;
            profile.distance([libm::hypot(p.x, p.y), p.z])
        };
        let (mut height, mut top) = (0.0, HEIGHT_STEP_MM);
        let free = self.roughing.radius() + self.lead + HEIGHT_STEP_MM;
        // Outside of the blank the distance grows from some place on; inside of it a stroke has passed through.
        let most = 4.0 * profile.iter().map(|p| libm::hypot(p[0], p[1])).fold(0.0, f64::max);
        while top < most && over(top) < free {
            if over(top) < 0.0 {
                height = top;
            }
            top += HEIGHT_STEP_MM;
        }
        let position = bottom.position + bottom.normal * top;
        Stroke { bottom, top: CcPoint { position, ..bottom }, height }
    }

    /// The strokes of a row across the channel from the floor, and beside each wall those that end higher. Backwards the
    /// row goes from the second wall to the first.
    fn row(&self, stand: &Stand, backwards: bool) -> Vec<Stroke> {
        let mut floor =
            self.between([self.stroke(stand, 0.0), self.stroke(stand, 1.0)], |share| self.stroke(stand, share));
        let (Some(first), Some(last)) = (floor.first().copied(), floor.last().copied()) else { return floor };
        let mut sides = self.at_walls(stand, [first, last]);
        if backwards {
            floor.reverse();
            sides.reverse();
        }
        let [mut row, end] = sides;
        row.splice(0..0, floor.drain(..1));
        row.extend(floor);
        row.extend(end);
        row
    }

    /// The strokes beside both walls that end higher than those of the floor, from the floor up.
    fn at_walls(&self, stand: &Stand, mut nearest: [Stroke; 2]) -> [Vec<Stroke>; 2] {
        let roughing = self.roughing;
        let mut sides = [Vec::new(), Vec::new()];
        let Level::OverHub(lowest) = stand.level else { return sides };
        for k in 1.. {
            let level = Level::OverHub(lowest + k as f64 * roughing.depth);
            if !stand.inside || level.v(&roughing.chart, stand.station.u, 0.5) >= 1.0 {
                break;
            }
            let Some(free) = roughing.free_interval(stand.station.u, level) else { continue };
            let higher = Stand { station: LayerStation { free, ..stand.station }, level, ..*stand };
            for (side, near) in nearest.iter_mut().enumerate() {
                let found = self.stroke(&higher, side as f64);
                // Distance of the end from the axis of the nearest stroke so far.
                let offset = found.bottom.position - near.bottom.position;
                let gained = (offset - near.bottom.normal * offset.dot(&near.bottom.normal)).norm();
                let from = near.bottom.w - found.bottom.w;
                let outward = if side == 0 { from > 0.0 } else { from < 0.0 };
                if !outward || gained < self.step {
                    continue;
                }
                let at = |share: f64| {
                    let w = near.bottom.w + (found.bottom.w - near.bottom.w) * share;
                    let free = if side == 0 { [w, free[1]] } else { [free[0], w] };
                    self.stroke(&Stand { station: LayerStation { free, ..higher.station }, ..higher }, side as f64)
                };
                sides[side].extend(self.between([*near, found], at).into_iter().skip(1));
                *near = found;
            }
        }
        sides
    }

    /// Strokes at even shares of the distance from one to another, both included, so many that none is farther from the next
    /// than the step.
    fn between(&self, ends: [Stroke; 2], at: impl Fn(f64) -> Stroke) -> Vec<Stroke> {
        let fewest = (ends[0].distance(&ends[1]) / self.step).ceil().max(1.0) as usize;
        let mut count = fewest;
        loop {
            let inner = (1..count).map(|k| at(k as f64 / count as f64));
            let row: Vec<Stroke> = std::iter::once(ends[0]).chain(inner).chain([ends[1]]).collect();
            // Axes blend unevenly, so that some steps are larger than the mean. Between two levels more strokes do not help.
            if row.windows(2).all(|w| w[0].distance(&w[1]) <= self.step) || count > 2 * fewest {
                return row;
            }
            count += 1;
        }
    }

    /// The rows of a part, every other one backwards: as far apart as the step permits, and the last at its end.
    fn rows(&self, part: &[Stand]) -> Vec<Vec<Stroke>> {
        let probes: Vec<[Stroke; 3]> =
            part.par_iter().map(|s| ACROSS_SHARES.map(|share| self.stroke(s, share))).collect();
        let near = |i: usize, j: usize| probes[i].iter().zip(&probes[j]).all(|(a, b)| a.distance(b) <= self.step);
        let mut chosen = vec![0];
        while let Some(at) = chosen.last().copied().filter(|at| at + 1 < part.len()) {
            let Range { start, end } = at + 1..part.len();
            let next = (start..end).take_while(|j| near(at, *j)).last().unwrap_or(start);
            chosen.push(next);
        }
        chosen.par_iter().enumerate().map(|(k, i)| self.row(&part[*i], k % 2 == 1)).collect()
    }
}
