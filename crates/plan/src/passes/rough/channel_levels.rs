//! Plan of the operation `rough`: lines along the channel, level by level.
//!
//! Before: an operation. After: for each level lines at whole stepovers from both walls, the innermost first. A line
//! runs in along one wall and out along the other, so that the material lies on the same side of the tool everywhere.
//! Where the channel is narrower than the line, both of its legs run in the middle, as far as the next line outward
//! leaves more than a stepover between its legs; the second leg then finds air. So each place has as few lines as its
//! width needs. The first line that the tool cuts at a place is a slot. Both legs are passes of their own, so that the
//! second is reduced against the stock that the first leaves.
//!
//! A line begins outside of the stock, or on its neighbour, which is cut by then.

use super::groove::passes;
use super::layers::{LayerStation, Roughing};
use super::levels::{LevelRun, RoughLevel};
use super::trochoid::{OpenedSlot, Trochoid};
use super::{NamedLine, PassagePlan, Roughings};
use crate::passes::context::{PassContext, maximal_ranges};
use crate::spacing;
use base::progress::Work;
use diagnostics::Aborted;
use ir::{CcOperation, CcPoint, Operation, OperationId, RoughingStrategy};
use rayon::prelude::*;
use std::ops::Range;
use wheel::method::{Milling, Slots};

/// Plans a rough operation.
///
/// # Errors
/// The tool fits nowhere; the lines would be too many. The sink holds the reason.
pub(crate) fn plan(
    cx: &mut PassContext<'_>,
    roughings: &Roughings<'_>,
    id: OperationId,
) -> Result<CcOperation, Aborted> {
    let operation = &cx.program.operations[id];
    let planned = super::each_passage(cx, roughings, id, |cx, roughing| plan_passage(cx, roughing, operation))?;
    if planned.passes.is_empty() {
        return Err(fits_nowhere(cx, operation));
    }
    Ok(planned)
}

fn plan_passage(
    cx: &mut PassContext<'_>,
    roughing: &Roughing<'_>,
    operation: &Operation,
) -> Result<PassagePlan, Aborted> {
    let Some(RoughingStrategy::Rough { stepover, levels: form, .. }) = operation.kind.strategy() else {
        return Err(Aborted);
    };
    let levels = roughing.levels(form, &operation.name, cx.progress);
    cx.go_on()?;
    if levels.iter().all(|level| level.runs.is_empty()) {
        return Ok(PassagePlan { passes: Vec::new(), notes: vec!["the tool fits on no level".to_owned()] });
    }
    let stations: usize = levels.iter().flat_map(|l| &l.runs).map(|run| run.stations.len()).sum();
    let free = |run: &LevelRun| run.stations.iter().map(|s| free(roughing, run, s)).fold(0.0, f64::max);
    let widest = levels.iter().flat_map(|l| &l.runs).map(free).fold(0.0, f64::max);
    let loops = spacing::loop_stations(cx.program, operation, roughing.spacing * stations as f64);
    cx.check_points(operation, (widest / stepover.get() + 3.0) * stations as f64 + loops)?;
    let work = cx.progress.begin(format!("{}, lines", operation.name), levels.len());
    let lines = lines(roughing, &levels, operation, &work);
    cx.go_on()?;
    let notes = notes(&levels, &lines, operation);
    Ok(PassagePlan { passes: passes(roughing, lines.named), notes })
}

/// The lines of an operation.
#[derive(Default)]
pub(super) struct LevelLines {
    /// In the order of cutting.
    pub(super) named: Vec<NamedLine>,
    loops: usize,
    /// Length of the channel, in all levels, that loops open, and that in which the first line cuts a slot, mm.
    opened: [f64; 2],
}

/// The lines of all levels.
pub(super) fn lines(roughing: &Roughing<'_>, levels: &[RoughLevel], operation: &Operation, work: &Work) -> LevelLines {
    let Some(RoughingStrategy::Rough { stepover, milling, slots, .. }) = operation.kind.strategy() else {
        return LevelLines::default();
    };
    let of_level = |level: &RoughLevel| {
        let mut lines = LevelLines::default();
        for (k, run) in level.runs.iter().enumerate().take_while(|_| !work.is_cancelled()) {
            let name = if level.runs.len() > 1 {
                format!("level {} part {}", level.number, k + 1)
            } else {
                format!("level {}", level.number)
            };
            let mut run_lines = RunLines::new(roughing, run, stepover.get(), milling);
            let loops = run_lines.open(slots, milling);
            lines.loops += loops.len();
            lines.named.extend(loops.into_iter().map(|points| NamedLine { name: format!("{name} slot"), points }));
            let opened = run_lines.opened_length();
            lines.opened = [0, 1].map(|k: usize| lines.opened[k] + opened[k]);
            let named = |(i, points)| NamedLine { name: format!("{name} line {}", i + 1), points };
            lines.named.extend(run_lines.all().into_iter().enumerate().map(named));
        }
        work.step(lines)
    };
    let of_levels: Vec<LevelLines> = levels.par_iter().map(of_level).collect();
    of_levels.into_iter().fold(LevelLines::default(), |mut all, lines| {
        all.named.extend(lines.named);
        all.loops += lines.loops;
        all.opened = [0, 1].map(|k: usize| all.opened[k] + lines.opened[k]);
        all
    })
}

fn notes(levels: &[RoughLevel], lines: &LevelLines, operation: &Operation) -> Vec<String> {
    let Some(RoughingStrategy::Rough { depth, stepover, levels: form, milling, slots }) = operation.kind.strategy()
    else {
        return Vec::new();
    };
    let [all, cut] = [0, 1].map(|k| levels.iter().map(|l| l.length[k]).sum::<f64>());
    let parts: usize = levels.iter().map(|l| l.runs.len()).sum();
    let mut notes = vec![
        format!(
            "{} levels {}, {depth} deep; lines at most {stepover} apart, {}",
            levels.len(),
            form.name(),
            milling.name()
        ),
        format!(
            "in one channel the levels are {all:.0} mm long; the tool fits on {cut:.0} mm of them, in {parts} parts"
        ),
    ];
    if let Some(arc) = slots.engagement() {
        let [opened, slot] = lines.opened;
        notes.push(format!(
            "{} loops with at most {:.0} deg of engagement open {opened:.0} mm; on {slot:.0} mm the first line cuts a slot, where the channel is too narrow for loops or has no way in from outside",
            lines.loops,
            arc.deg()
        ));
    }
    notes
}

fn fits_nowhere(cx: &mut PassContext<'_>, operation: &Operation) -> Aborted {
    let tool = &cx.program.tools[operation.tool];
    let text = format!("tool {} fits on no level of `{}` with its allowances", tool.name, operation.name);
    super::nothing_to_cut(cx, operation, text)
}

/// Free space across the channel at a station, mm.
fn free(roughing: &Roughing<'_>, run: &LevelRun, s: &LayerStation) -> f64 {
    (s.free[1] - s.free[0]) * across(roughing, run, s.u)
}

/// Distance of the walls square to the channel, mm.
fn across(roughing: &Roughing<'_>, run: &LevelRun, u: f64) -> f64 {
    roughing.chart.across(u, run.level.v(&roughing.chart, u, 0.5))
}

/// The lines of a run.
struct RunLines<'a> {
    roughing: &'a Roughing<'a>,
    run: &'a LevelRun,
    stepover: f64,
    /// Index of the wall along which a line runs towards higher stations.
    wall_forward: usize,
    /// Free space across the channel at each station, mm.
    free: Vec<f64>,
    /// Half width that loops open at each station, as a motion of the tip, mm; zero where the first line cuts a slot.
    opened: Vec<f64>,
}

impl<'a> RunLines<'a> {
    fn new(roughing: &'a Roughing<'a>, run: &'a LevelRun, stepover: f64, milling: Milling) -> Self {
        let free: Vec<f64> = run.stations.iter().map(|s| free(roughing, run, s)).collect();
        let climbs = milling == Milling::Climb;
        let opened = vec![0.0; free.len()];
        let wall_forward = usize::from(second_to_the_right(roughing, run) == climbs);
        Self { roughing, run, stepover, wall_forward, free, opened }
    }

    /// Opens the slot by loops, where there is space for them and they are wanted; returns the loops.
    fn open(&mut self, slots: Slots, milling: Milling) -> Vec<Vec<CcPoint>> {
        let Some(arc) = slots.engagement() else { return Vec::new() };
        let limits = Trochoid { engagement: arc.get(), milling, wall_forward: self.wall_forward };
        let opening = OpenedSlot::new(self.roughing, self.run, limits);
        self.opened = opening.half;
        opening.loops
    }

    /// Length of the channel that loops open, and that in which the first line cuts a slot, mm.
    fn opened_length(&self) -> [f64; 2] {
        let stations = &self.run.stations;
        let mut length = [0.0; 2];
        for (i, pair) in stations.windows(2).enumerate() {
            if pair.iter().all(|s| (0.0..=1.0).contains(&s.u)) {
                let at = |s: &LayerStation| self.roughing.cc_point(s.u, self.run.level, s.middle()).position;
                let opened = self.opened[i] > 0.0 && self.opened[i + 1] > 0.0;
                length[usize::from(!opened)] += (at(&pair[1]) - at(&pair[0])).norm();
            }
        }
        length
    }

    /// All legs in the order of cutting: from the middle to the walls, then those that begin on a neighbour.
    fn all(&self) -> Vec<Vec<CcPoint>> {
        let widest = self.free.iter().copied().fold(0.0, f64::max);
        let most = (0.5 * (widest / self.stepover + 1.0)).ceil() as usize;
        let (mut lines, mut late) = (Vec::new(), Vec::new());
        for k in (0..most).rev() {
            for piece in self.pieces(k) {
                if self.outside(&piece) == [false; 2] {
                    late.insert(0, (piece, k));
                } else {
                    lines.extend(self.legs(&piece, k));
                }
            }
        }
        lines.extend(late.iter().flat_map(|(piece, k)| self.legs(piece, *k)));
        lines
    }

    /// Ranges of stations of the line `k` stepovers from the walls: there the next line outward leaves more than a
    /// stepover between its legs, or the line lies beside the loops. The line along the walls goes everywhere.
    fn pieces(&self, k: usize) -> Vec<Range<usize>> {
        let legs = 2.0 * k as f64 * self.stepover;
        let cuts = |i: usize| {
            let opened = self.opened[i];
            k == 0
                || if opened > 0.0 { self.free[i] - 2.0 * opened > legs } else { self.free[i] > legs - self.stepover }
        };
        let ranges = maximal_ranges(self.free.len(), cuts);
        ranges.into_iter().filter(|piece| piece.len() > 1).collect()
    }

    /// Ends of a piece that lie outside of the stock.
    fn outside(&self, piece: &Range<usize>) -> [bool; 2] {
        [piece.start == 0 && self.run.open[0], piece.end == self.free.len() && self.run.open[1]]
    }

    /// Place across the channel at a distance from a wall, at most in the middle.
    fn leg(&self, station: usize, wall: usize, distance: f64) -> f64 {
        let s = &self.run.stations[station];
        let share = (distance / self.free[station].max(f64::MIN_POSITIVE)).min(0.5);
        s.free[wall] + share * (s.free[1 - wall] - s.free[wall])
    }

    /// The line `k` stepovers from the walls over a piece: from the outside, or from the wider end, to the other end and
    /// across, and back. A line that cannot begin outside begins on the next line outward.
    fn legs(&self, piece: &Range<usize>, k: usize) -> Vec<Vec<CcPoint>> {
        let ends = [piece.start, piece.end - 1];
        let outside = self.outside(piece);
        let forward = match outside {
            [true, false] => true,
            [false, true] => false,
            _ => self.free[ends[0]] > self.free[ends[1]],
        };
        let inward: Vec<usize> = if forward { piece.clone().collect() } else { piece.clone().rev().collect() };
        let (Some(first), Some(last)) = (inward.first().copied(), inward.last().copied()) else { return Vec::new() };
        // The wall of the leg inward.
        let wall = if forward { self.wall_forward } else { 1 - self.wall_forward };
        let distance = k as f64 * self.stepover;
        let leg = |i: usize, wall: usize| (i, self.leg(i, wall, distance));
        let neighbour = if k > 0 && outside == [false; 2] { distance - self.stepover } else { distance };
        let entry = self.across(first, self.leg(first, wall, neighbour), self.leg(first, wall, distance));
        let turn = self.across(last, leg(last, wall).1, leg(last, 1 - wall).1);
        let up = inward.iter().map(|i| leg(*i, wall));
        let down = inward.iter().rev().map(|i| leg(*i, 1 - wall));
        let crossed = (!turn.is_empty()).then(|| leg(last, 1 - wall));
        let legs: [Vec<(usize, f64)>; 2] =
            [entry.into_iter().chain(up).chain(turn).chain(crossed).collect(), down.collect()];
        legs.map(|mut places| {
            places.dedup();
            places.into_iter().map(|(i, w)| self.roughing.cc_point(self.run.stations[i].u, self.run.level, w)).collect()
        })
        .into()
    }

    /// Places across the channel from one to another, without the last.
    fn across(&self, station: usize, from: f64, to: f64) -> Vec<(usize, f64)> {
        /// Width that is none, mm: there both legs are one place.
        const ZERO_WIDTH_MM: f64 = 1e-3;
        let length = (to - from).abs() * across(self.roughing, self.run, self.run.stations[station].u);
        let count = if length < ZERO_WIDTH_MM { 0 } else { (length / self.roughing.spacing).ceil() as usize };
        (0..count).map(|k| (station, from + (to - from) * k as f64 / count as f64)).collect()
    }
}

/// True when the second wall lies to the right of a tool that runs towards higher stations, seen along the axis from
/// holder to tip.
fn second_to_the_right(roughing: &Roughing<'_>, run: &LevelRun) -> bool {
    const DIFFERENCE_STEP: f64 = 1e-3;
    let middle = &run.stations[run.stations.len() / 2];
    let at = |u: f64, w: f64| roughing.chart.point(u, run.level.v(&roughing.chart, u, w), w);
    let w = middle.middle();
    let motion = at(middle.u + DIFFERENCE_STEP, w) - at(middle.u, w);
    let to_second = at(middle.u, w + DIFFERENCE_STEP) - at(middle.u, w);
    let axis = roughing.axis(middle.u, run.level.v(&roughing.chart, middle.u, w), w);
    motion.cross(&axis).dot(&to_second) > 0.0
}
