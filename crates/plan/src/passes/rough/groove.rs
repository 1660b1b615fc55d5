//! Plan of the operation `groove`: one line in the middle of each channel, layer by layer (Wei 3.1.1).
//!
//! Before: an operation. After: passes from inlet to outlet, one per layer, from the shroud down to the hub allowance
//! or to the lowest layer that the tool can complete.

use super::layers::{Layers, LayersEnd, Level, Roughing};
use super::{NamedLine, PassagePlan, Roughings, step};
use crate::passes::context::{PassContext, in_passage};
use diagnostics::{Aborted, Diag, codes::planning};
use ir::{CcOperation, CcPass, CcPoint, Drive, Operation, OperationId};
use nalgebra::Point3;
use nurbs::interpolate;

/// Longest step of a roughing line, mm. The tool axis turns along the line, which the law of the curvature does not
/// consider.
const LONGEST_STEP: f64 = 1.0;

/// Plans a groove operation from the levels of earlier roughing in each passage; sets the levels that it reaches.
///
/// # Errors
/// The tool does not fit into the first layer; the sink holds the diagnostic.
pub(crate) fn plan(
    cx: &mut PassContext<'_>,
    roughings: &Roughings<'_>,
    id: OperationId,
    levels: &mut [f64],
) -> Result<CcOperation, Aborted> {
    let operation = &cx.program.operations[id];
    let mut levels = levels.iter_mut();
    super::each_passage(cx, roughings, id, |cx, roughing| {
        let level = levels.next().ok_or(Aborted)?;
        plan_passage(cx, roughing, operation, level)
    })
}

fn plan_passage(
    cx: &mut PassContext<'_>,
    roughing: &Roughing<'_>,
    operation: &Operation,
    level: &mut f64,
) -> Result<PassagePlan, Aborted> {
    let layers = roughing.layers(*level, &operation.name, cx.progress);
    cx.go_on()?;
    *level = check_fit(cx, roughing, operation, &layers)?;
    let mut notes = vec![describe(&layers)];
    let mut line_lengths = 0;
    let mut lines = Vec::new();
    let work = cx.progress.begin(format!("{}, lines", operation.name), layers.all.len());
    for layer in &layers.all {
        cx.go_on()?;
        let points: Vec<CcPoint> =
            layer.stations.iter().map(|s| roughing.cc_point(s.u, Level::Share(layer.level), s.middle())).collect();
        let points = restep(roughing, Level::Share(layer.level), &points, cx.program.tolerances.chord_rough.get());
        line_lengths += points.len();
        lines.push(NamedLine { name: format!("layer {}", layer.number), points: work.step(points) });
    }
    notes.push(format!("{line_lengths} stations per channel by the step law (6), {} lines", lines.len()));
    Ok(PassagePlan { passes: passes(roughing, lines), notes })
}

/// The level that the layers reach; an error when there are no layers.
pub(crate) fn check_fit(
    cx: &mut PassContext<'_>,
    roughing: &Roughing<'_>,
    operation: &Operation,
    layers: &Layers,
) -> Result<f64, Aborted> {
    let Some(last) = layers.all.last() else {
        if let LayersEnd::Narrow { level, u } = layers.end {
            let tool = &cx.program.tools[operation.tool];
            let place = roughing.chart.point(u, level, 0.0);
            cx.sink.push(
                Diag::error(
                    planning::NO_ROOM,
                    format!(
                        "tool {} does not fit into the first layer of `{}`, {:.1} % of the height above the hub",
                        tool.name,
                        operation.name,
                        level * 100.0
                    ),
                )
                .label(operation.span, "this operation starts there")
                .label(tool.span, "this tool is too large there")
                .place(format!("channel at u = {u:.3}, from level {:.3}", layers.top), place)
                .help("use a thinner tool, a longer reach, or smaller allowances"),
            );
        }
        return Err(Aborted);
    };
    Ok(last.level)
}

/// Describes the layers in one line.
pub(crate) fn describe(layers: &Layers) -> String {
    let Layers { top, all, end } = layers;
    let reached = all.last().map_or(*top, |l| l.level);
    let range = format!("{} layers from level {:.3} down to {:.3} (1 shroud, 0 hub)", all.len(), top, reached);
    match end {
        LayersEnd::Floor => format!("{range}: the hub allowance is reached"),
        LayersEnd::Narrow { level, u } => {
            format!("{range}: at level {level:.3} the tool does not fit at u = {u:.3} with its allowances")
        }
    }
}

/// Spaces the stations of a line by its curvature (Wei 4 to 7). A NURBS curve through the stations gives the curvature;
/// the new stations lie on the chart.
pub(crate) fn restep(roughing: &Roughing<'_>, level: Level, points: &[CcPoint], epsilon: f64) -> Vec<CcPoint> {
    let positions: Vec<Point3<f64>> = points.iter().map(|p| p.position).collect();
    // Data points a few millimetres apart keep the shape; all stations would add the noise of the lifts.
    let stride = (positions.len() / 16).max(1);
    let mut data: Vec<Point3<f64>> = positions.iter().step_by(stride).copied().collect();
    if !(positions.len() - 1).is_multiple_of(stride) {
        data.extend(positions.last());
    }
    let Ok(curve) = interpolate(&data, 3.min(data.len().saturating_sub(1))) else { return points.to_vec() };
    let length: Vec<f64> = std::iter::once(0.0)
        .chain(positions.windows(2).scan(0.0, |sum, p| {
            *sum += (p[1] - p[0]).norm();
            Some(*sum)
        }))
        .collect();
    let total = length.last().copied().unwrap_or(0.0);
    step::stations(&curve, epsilon, LONGEST_STEP)
        .into_iter()
        .map(|t| {
            // The parameter is the share of the length.
            let at = t * total;
            let i = length.partition_point(|l| *l < at).clamp(1, length.len() - 1);
            let share = ((at - length[i - 1]) / (length[i] - length[i - 1]).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            let mix = |a: f64, b: f64| a + (b - a) * share;
            let (p, q) = (&points[i - 1], &points[i]);
            roughing.cc_point(mix(p.u, q.u), level, mix(p.w, q.w))
        })
        .collect()
}

/// Turns named lines in a passage into passes.
pub(crate) fn passes(roughing: &Roughing<'_>, lines: Vec<NamedLine>) -> Vec<CcPass> {
    let label = |label: String| in_passage(roughing.chart.part(), roughing.passage, label);
    let pass =
        |line: NamedLine| CcPass { path: None, label: label(line.name), drive: Drive::Channel, points: line.points };
    lines.into_iter().map(pass).collect()
}
