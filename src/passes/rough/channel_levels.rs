//! Plan of the operation `rough`: each level from the middle of the channel out to its walls.
//!
//! Before: an operation. After: for each level a slot along the middle of the channel, then lines on both sides of the
//! slot at constant distances from the walls, the innermost first. Each line runs in along one wall and out along the
//! other, so that the material lies on the same side of the tool everywhere. The two legs of a line meet over the slot
//! where the channel is as narrow as the line (an inverted V, Wei 3.1.2). Every line begins outside of the stock, or in
//! the slot, which is cut by then.

use super::groove::{passes, restep};
use super::layers::{LayerStation, Roughing, STATION_SPACING};
use super::levels::{LevelRun, RoughLevel};
use crate::diag::{Aborted, Diag, codes::planning};
use crate::ir::{CcOperation, CcPoint, Operation, OperationId, OperationKind};
use crate::method::Milling;
use crate::passes::context::{PassContext, limits::check_points};

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
    let widest = levels.iter().flat_map(|l| &l.runs).map(|run| half_width(&roughing, run)).fold(0.0, f64::max);
    check_points(cx, operation, (widest / stepover.get() + 1.0) * 2.0 * stations as f64)?;
    let work = cx.progress.begin(format!("{}, lines", operation.name), levels.len());
    let chord = cx.program.tolerances.chord_rough.get();
    let mut lines = Vec::new();
    for level in &levels {
        for (k, run) in level.runs.iter().enumerate() {
            let name = if level.runs.len() > 1 {
                format!("level {} part {}", level.number, k + 1)
            } else {
                format!("level {}", level.number)
            };
            lines.push((format!("{name} slot"), slot(&roughing, run, chord)));
            beside_slot(&roughing, run, stepover.get(), milling, &name, &mut lines);
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
    (s.room[1] - s.room[0]) * width(roughing, run, s.u)
}

fn width(roughing: &Roughing<'_>, run: &LevelRun, u: f64) -> f64 {
    roughing.chart.width(u, run.level.v(&roughing.chart, u, 0.5))
}

/// Largest distance from the middle to the outermost line, mm.
fn half_width(roughing: &Roughing<'_>, run: &LevelRun) -> f64 {
    0.5 * run.stations.iter().map(|s| free(roughing, run, s)).fold(0.0, f64::max)
}

/// The line in the middle, from an open end.
fn slot(roughing: &Roughing<'_>, run: &LevelRun, chord: f64) -> Vec<CcPoint> {
    let mut points: Vec<CcPoint> = run.stations.iter().map(|s| roughing.cc_point(s.u, run.level, s.middle())).collect();
    if !run.open[0] {
        points.reverse();
    }
    restep(roughing, run.level, &points, chord)
}

/// Lines on both sides of the slot, the innermost first.
fn beside_slot(
    roughing: &Roughing<'_>,
    run: &LevelRun,
    stepover: f64,
    milling: Milling,
    name: &str,
    lines: &mut Vec<(String, Vec<CcPoint>)>,
) {
    let half = half_width(roughing, run);
    let count = (half / stepover).ceil().max(1.0) as usize;
    let spacing = half / count as f64;
    for i in (0..count).rev() {
        let offset = i as f64 * spacing;
        let wide = |s: &LayerStation| free(roughing, run, s) > 2.0 * offset;
        let mut first = 0;
        while let Some(start) = (first..run.stations.len()).find(|k| wide(&run.stations[*k])) {
            let end = (start..run.stations.len()).find(|k| !wide(&run.stations[*k])).unwrap_or(run.stations.len()) - 1;
            first = end + 1;
            if end == start {
                continue;
            }
            let part = &run.stations[start..=end];
            // The tool comes in from outside, or over the slot where the line is as wide as the channel.
            let entries = [start > 0 || run.open[0], end + 1 < run.stations.len() || run.open[1]];
            let outside = [start == 0 && run.open[0], end + 1 == run.stations.len() && run.open[1]];
            let from_outlet = if outside[0] != outside[1] { outside[1] } else { entries[1] };
            let points = round(roughing, run, (part, from_outlet), offset, milling);
            lines.push((format!("{name} line {}", count - i), points));
        }
    }
}

/// A line along both walls of a part of a run: in along one wall, across, and out along the other. It begins at the
/// outlet side of the part or at the inlet side.
fn round(
    roughing: &Roughing<'_>,
    run: &LevelRun,
    (part, from_outlet): (&[LayerStation], bool),
    offset: f64,
    milling: Milling,
) -> Vec<CcPoint> {
    let legs = |s: &LayerStation| {
        let share = offset / width(roughing, run, s.u);
        [s.room[0] + share, s.room[1] - share]
    };
    // From the end at which the line begins to the end at which it crosses.
    let inward: Vec<&LayerStation> = if from_outlet { part.iter().rev().collect() } else { part.iter().collect() };
    let Some(apex) = inward.last() else { return Vec::new() };
    let in_on = usize::from(right_hand_wall(roughing, run, &inward) == (milling == Milling::Climb));
    let across = {
        let [from, to] = [legs(apex)[in_on], legs(apex)[1 - in_on]];
        let length = (to - from).abs() * width(roughing, run, apex.u);
        let count = (length / STATION_SPACING).ceil().max(1.0) as usize;
        (1..count).map(move |k| from + (to - from) * k as f64 / count as f64)
    };
    let up = inward.iter().map(|s| (s.u, legs(s)[in_on]));
    let down = inward.iter().rev().map(|s| (s.u, legs(s)[1 - in_on]));
    let u = apex.u;
    up.chain(across.map(|w| (u, w))).chain(down).map(|(u, w)| roughing.cc_point(u, run.level, w)).collect()
}

/// True when the second wall lies to the right of a tool that runs inward, seen along the axis from holder to tip.
fn right_hand_wall(roughing: &Roughing<'_>, run: &LevelRun, inward: &[&LayerStation]) -> bool {
    let (Some(from), Some(to)) = (inward.first(), inward.last()) else { return false };
    let middle = &inward[inward.len() / 2];
    let at = |u: f64, w: f64| roughing.chart.point(u, run.level.v(&roughing.chart, u, w), w);
    let w = middle.middle();
    let step = 1e-3 * (to.u - from.u).signum();
    let motion = at(middle.u + step, w) - at(middle.u, w);
    let to_second = at(middle.u, w + 1e-3) - at(middle.u, w);
    let axis = roughing.axis(middle.u, run.level.v(&roughing.chart, middle.u, w), w);
    motion.cross(&axis).dot(&to_second) > 0.0
}
