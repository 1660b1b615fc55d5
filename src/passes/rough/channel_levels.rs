//! Plan of the operation `rough`: lines along the channel, level by level.
//!
//! Before: an operation. After: for each level lines at whole stepovers from one wall, as far as the free space goes,
//! and a line along the other wall, the far wall. The first line that the tool cuts at a place is a slot; it is the line
//! one stepover from the near wall, where there is one, so that both walls are milled in the sense of the job. The line
//! along the near wall runs back, all others run in one direction, and the material lies to the same side of the tool.
//! A line ends where it meets the far wall. The near wall is chosen such that lines begin at the wide end.
//!
//! A line begins outside of the stock, or on its neighbour, which is cut by then.

use super::groove::passes;
use super::layers::{LayerStation, Roughing, STATION_SPACING};
use super::levels::{LevelRun, RoughLevel};
use crate::diag::{Aborted, Diag, codes::planning};
use crate::ir::{CcOperation, CcPoint, Operation, OperationId, OperationKind};
use crate::method::Milling;
use crate::passes::context::{PassContext, limits::check_points};
use std::ops::Range;

/// Plans a rough operation.
///
/// # Errors
/// The tool fits nowhere; the lines would be too many. The sink holds the reason.
pub(crate) fn plan(cx: &mut PassContext<'_>, id: OperationId, operation: &Operation) -> Result<CcOperation, Aborted> {
    let OperationKind::Rough { stepover, levels: form, milling, .. } = operation.kind else { return Err(Aborted) };
    let roughing = super::roughing(cx, operation)?;
    let levels = roughing.levels(form, &operation.name, cx.progress);
    if levels.iter().all(|level| level.runs.is_empty()) {
        return Err(fits_nowhere(cx, operation));
    }
    let stations: usize = levels.iter().flat_map(|l| &l.runs).map(|run| run.stations.len()).sum();
    let free = |run: &LevelRun| run.stations.iter().map(|s| free(&roughing, run, s)).fold(0.0, f64::max);
    let widest = levels.iter().flat_map(|l| &l.runs).map(free).fold(0.0, f64::max);
    check_points(cx, operation, (widest / stepover.get() + 2.0) * stations as f64)?;
    let work = cx.progress.begin(format!("{}, lines", operation.name), levels.len());
    let mut lines = Vec::new();
    for level in &levels {
        for (k, run) in level.runs.iter().enumerate() {
            let name = if level.runs.len() > 1 {
                format!("level {} part {}", level.number, k + 1)
            } else {
                format!("level {}", level.number)
            };
            let run_lines = RunLines::new(&roughing, run, stepover.get(), milling);
            lines.extend(run_lines.all().into_iter().map(|(line, points)| (format!("{name} {line}"), points)));
        }
        work.step(());
    }
    Ok(CcOperation { operation: id, passes: passes(lines), notes: notes(&levels, operation) })
}

fn notes(levels: &[RoughLevel], operation: &Operation) -> Vec<String> {
    let OperationKind::Rough { depth, stepover, levels: form, milling, .. } = operation.kind else { return Vec::new() };
    let [all, cut] = [0, 1].map(|k| levels.iter().map(|l| l.length[k]).sum::<f64>());
    let slots: usize = levels.iter().map(|l| l.runs.len()).sum();
    vec![
        format!(
            "{} levels {}, {depth} deep; lines at most {stepover} apart, {}",
            levels.len(),
            form.name(),
            milling.name()
        ),
        format!(
            "in one channel the levels are {all:.0} mm long; the tool fits on {cut:.0} mm of them, in {slots} parts"
        ),
    ]
}

fn fits_nowhere(cx: &mut PassContext<'_>, operation: &Operation) -> Aborted {
    let tool = &cx.program.tools[operation.tool];
    cx.sink.push(
        Diag::error(
            planning::NO_ROOM,
            format!("tool {} fits on no level of `{}` with its allowances", tool.name, operation.name),
        )
        .label(operation.span, "this operation has nothing to cut")
        .label(tool.span, "this tool is too big for the channel")
        .help("take a thinner tool, a longer reach, or smaller allowances"),
    );
    Aborted
}

/// Free space across the channel at a station, mm.
fn free(roughing: &Roughing<'_>, run: &LevelRun, s: &LayerStation) -> f64 {
    (s.room[1] - s.room[0]) * across(roughing, run, s.u)
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
    /// Free space across the channel at each station, mm.
    free: Vec<f64>,
    /// Index of the near wall.
    near: usize,
    /// True when the lines run towards higher stations.
    forward: bool,
}

impl<'a> RunLines<'a> {
    fn new(roughing: &'a Roughing<'a>, run: &'a LevelRun, stepover: f64, milling: Milling) -> Self {
        let free: Vec<f64> = run.stations.iter().map(|s| free(roughing, run, s)).collect();
        let forward = match run.open {
            [true, true] => free.first() > free.last(),
            [first, _] => first,
        };
        let far_second = (second_to_the_right(roughing, run) == forward) == (milling == Milling::Climb);
        Self { roughing, run, stepover, free, near: usize::from(!far_second), forward }
    }

    /// All lines with their names, in the order of cutting.
    fn all(&self) -> Vec<(String, Vec<CcPoint>)> {
        let whole = 0..self.run.stations.len();
        let (slots, beside): (Vec<_>, Vec<_>) = self
            .pieces(1)
            .into_iter()
            .partition(|piece| [true, false].iter().any(|way| self.starts_outside(piece, *way)));
        let mut lines = Vec::new();
        for piece in &slots {
            let way = if self.starts_outside(piece, self.forward) { self.forward } else { !self.forward };
            lines.push(self.line(piece, way, 1));
        }
        let slotted = lines.len();
        let back = if self.starts_outside(&whole, !self.forward) { !self.forward } else { self.forward };
        lines.push(self.line(&whole, back, 0));
        lines.extend(beside.iter().map(|piece| self.line(piece, self.forward, 1)));
        let most = (self.free.iter().copied().fold(0.0, f64::max) / self.stepover).ceil() as usize;
        for k in 2..most {
            lines.extend(self.pieces(k).iter().map(|piece| self.line(piece, self.forward, k)));
        }
        let far = self.directed(whole, self.forward).map(|i| (i, self.run.stations[i].room[1 - self.near]));
        lines.push(self.points(far));
        let name =
            |i: usize| if i < slotted.max(1) { "slot".to_owned() } else { format!("line {}", i + 1 - slotted.max(1)) };
        lines.into_iter().enumerate().map(|(i, points)| (name(i), points)).collect()
    }

    /// Ranges of stations at which the free space is wider than `k` stepovers.
    fn pieces(&self, k: usize) -> Vec<Range<usize>> {
        let least = k as f64 * self.stepover;
        let mut pieces = Vec::new();
        let mut first = 0;
        while let Some(start) = (first..self.free.len()).find(|i| self.free[*i] > least) {
            let end = (start..self.free.len()).find(|i| self.free[*i] <= least).unwrap_or(self.free.len());
            first = end;
            if end - start > 1 {
                pieces.push(start..end);
            }
        }
        pieces
    }

    /// True when a line over a piece begins outside of the stock.
    fn starts_outside(&self, piece: &Range<usize>, forward: bool) -> bool {
        if forward { piece.start == 0 && self.run.open[0] } else { piece.end == self.free.len() && self.run.open[1] }
    }

    fn directed(&self, piece: Range<usize>, forward: bool) -> impl Iterator<Item = usize> + use<> {
        let count = piece.len();
        (0..count).map(move |i| if forward { piece.start + i } else { piece.end - 1 - i })
    }

    /// Place across the channel at a distance from the near wall.
    fn beside_near(&self, station: usize, distance: f64) -> f64 {
        let s = &self.run.stations[station];
        let share = (distance / self.free[station].max(f64::MIN_POSITIVE)).min(1.0);
        s.room[self.near] + share * (s.room[1 - self.near] - s.room[self.near])
    }

    /// The line `k` stepovers from the near wall over a piece. A line that cannot begin outside begins on its neighbour
    /// nearer to that wall.
    fn line(&self, piece: &Range<usize>, forward: bool, k: usize) -> Vec<CcPoint> {
        let distance = k as f64 * self.stepover;
        let start = self.directed(piece.clone(), forward).next().unwrap_or(0);
        let crossing = if k > 0 && !self.starts_outside(piece, forward) {
            (self.stepover / STATION_SPACING).ceil() as usize
        } else {
            0
        };
        let over = (0..crossing).map(|i| distance - self.stepover * (1.0 - i as f64 / crossing as f64));
        let over = over.map(|d| (start, self.beside_near(start, d)));
        self.points(over.chain(self.directed(piece.clone(), forward).map(|i| (i, self.beside_near(i, distance)))))
    }

    fn points(&self, places: impl Iterator<Item = (usize, f64)>) -> Vec<CcPoint> {
        places.map(|(i, w)| self.roughing.cc_point(self.run.stations[i].u, self.run.level, w)).collect()
    }
}

/// True when the second wall lies to the right of a tool that runs towards higher stations, seen along the axis from
/// holder to tip.
fn second_to_the_right(roughing: &Roughing<'_>, run: &LevelRun) -> bool {
    const STEP: f64 = 1e-3;
    let middle = &run.stations[run.stations.len() / 2];
    let at = |u: f64, w: f64| roughing.chart.point(u, run.level.v(&roughing.chart, u, w), w);
    let w = middle.middle();
    let motion = at(middle.u + STEP, w) - at(middle.u, w);
    let to_second = at(middle.u, w + STEP) - at(middle.u, w);
    let axis = roughing.axis(middle.u, run.level.v(&roughing.chart, middle.u, w), w);
    motion.cross(&axis).dot(&to_second) > 0.0
}
