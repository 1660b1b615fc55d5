//! Plan of the operation `expand`: inverted V lines on both sides of the groove (Wei 3.1.2).
//!
//! Before: an operation. After: per layer a set of V lines. Each leg runs at a constant distance from the boundary on
//! its side; the legs of a V meet on the groove line where the channel is as narrow as the V. Lines are therefore one
//! step apart everywhere, also at the narrow inlet. Order: from the groove outward to the walls.

use super::groove::{check_fit, describe, passes};
use super::layers::{Layer, Level, Roughing};
use super::{NamedLine, PassagePlan, Roughings};
use crate::passes::context::PassContext;
use crate::passes::lines::scallop;
use base::units::Mm;
use diagnostics::Aborted;
use ir::{CcOperation, Operation, OperationId};

/// Plans an expand operation from the levels of earlier expanding in each passage; sets the levels that it reaches.
///
/// # Errors
/// The tool does not fit into the first layer; the sink holds the diagnostic.
pub(crate) fn plan(
    cx: &mut PassContext<'_>,
    roughings: &Roughings<'_>,
    id: OperationId,
    residual: Mm,
    levels: &mut [f64],
) -> Result<CcOperation, Aborted> {
    let operation = &cx.program.operations[id];
    let mut levels = levels.iter_mut();
    super::each_passage(cx, roughings, id, |cx, roughing| {
        let level = levels.next().ok_or(Aborted)?;
        plan_passage(cx, roughing, operation, residual, level)
    })
}

fn plan_passage(
    cx: &mut PassContext<'_>,
    roughing: &Roughing<'_>,
    operation: &Operation,
    residual: Mm,
    level: &mut f64,
) -> Result<PassagePlan, Aborted> {
    let layers = roughing.layers(*level, &operation.name, cx.progress);
    cx.go_on()?;
    *level = check_fit(cx, roughing, operation, &layers)?;
    let solid = &cx.program.tools[operation.tool].solid;
    let step = scallop::formula_9_step(solid.radius(), residual.get());
    let mut notes = vec![describe(&layers)];
    let layers = layers.all;
    let mut lines = Vec::new();
    let widest =
        layers.iter().flat_map(|l| l.stations.iter().map(|s| roughing.chart.width(s.u, l.level))).fold(0.0, f64::max);
    let stations: usize = layers.iter().map(|l| l.stations.len()).sum();
    cx.check_points(operation, widest / step * stations as f64)?;
    let work = cx.progress.begin(format!("{}, lines", operation.name), layers.len());
    for layer in &layers {
        cx.go_on()?;
        let count = work.step(v_lines(roughing, layer, step, &mut lines));
        if layer.number == layers.len() {
            notes.push(format!(
                "formula (9): {count} V lines per layer, {step:.3} mm apart; exact step of a ball for a residual of {:.3} mm: {:.3} mm",
                residual.get(),
                scallop::flat_step(solid.radius(), residual.get())
            ));
        }
    }
    Ok(PassagePlan { passes: passes(roughing, lines), notes })
}

/// Adds the V lines of a layer, the innermost first; returns their number.
fn v_lines(roughing: &Roughing<'_>, layer: &Layer, step: f64, lines: &mut Vec<NamedLine>) -> usize {
    let Some(outlet) = layer.stations.iter().rfind(|s| s.u <= 1.0) else { return 0 };
    let width = |s: &super::layers::LayerStation| (s.free[1] - s.free[0]) * roughing.chart.width(s.u, layer.level);
    // The lines of both sides and the groove divide the arc between the boundaries (S of formula 9).
    let pairs = (0.5 * width(outlet) / step).ceil().max(1.0);
    let spacing = 0.5 * width(outlet) / pairs;
    for i in (0..pairs as usize).rev() {
        let offset = i as f64 * spacing;
        // From the outlet to the apex: stations where the leg is still on its own side of the groove.
        let legs: Vec<(f64, [f64; 2])> = layer
            .stations
            .iter()
            .rev()
            .map(|s| (s, offset / roughing.chart.width(s.u, layer.level)))
            .take_while(|(s, share)| s.free[0] + share < s.middle())
            .map(|(s, share)| (s.u, [s.free[0] + share, s.free[1] - share]))
            .collect();
        let Some((apex, apex_legs)) = legs.last().copied() else { continue };
        // The crossing at the apex: on the groove line inside the channel, in air before the inlet.
        let width = (apex_legs[1] - apex_legs[0]) * roughing.chart.width(apex, layer.level);
        let crossing = (width / step).ceil().max(1.0) as usize;
        let across = (1..crossing).map(|k| {
            let w = apex_legs[0] + (apex_legs[1] - apex_legs[0]) * k as f64 / crossing as f64;
            (apex, w)
        });
        let up = legs.iter().map(|(u, w)| (*u, w[0]));
        let down = legs.iter().rev().map(|(u, w)| (*u, w[1]));
        let points = up
            .chain(across)
            .chain(down)
            .map(|(u, w)| roughing.cc_point(u, Level::Share(layer.level), w))
            .collect::<Vec<_>>();
        let name = format!("layer {} line {}", layer.number, pairs as usize - i);
        lines.push(NamedLine { name, points });
    }
    pairs as usize
}
