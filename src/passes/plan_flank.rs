//! `plan-flank`: bands along the rulings of the vane faces (Wei 3.2).
//!
//! Before: an operation. After: per face and band a pass from inlet to outlet, from the top band to the root. The
//! lowest band ends where the ball of the tool, rolling in the fillet, touches the face.

use super::pipeline::PassContext;
use crate::diag::{Aborted, Diag, codes::planning};
use crate::ir::{CcOperation, CcPass, CcPoint, Drive, Operation, OperationId, OperationKind};

/// Stations along a face: a dense set that `sample-to-tolerance` thins. At 400 a station lies about 0.15 mm from the
/// next, so that the chord between two is below 0.1 um for the radii of a vane.
pub(super) const STATIONS: usize = 400;

/// Cutter radii beyond inlet and outlet for which the pass follows the continued face. From there a shift that parts
/// from the tangents by less than 45 deg only takes the tool away from the edge.
const LEAVE: f64 = 1.0;

/// Plans a flank operation.
///
/// # Errors
/// The ball of the tool does not fit the fillet; the diagnostic is in the sink.
pub(super) fn plan(cx: &mut PassContext<'_>, id: OperationId, operation: &Operation) -> Result<CcOperation, Aborted> {
    let OperationKind::Flank { ref faces, strips } = operation.kind else { return Err(Aborted) };
    let part = &cx.program.part;
    let tool = &cx.program.tools[operation.tool];
    let radius = tool.solid.cutter.tip_radius();
    let rolling = part.fillet.map_or(radius, |f| f.get());
    if radius > rolling + 1e-9 {
        cx.sink.push(
            Diag::error(
                planning::BALL_TOO_BIG,
                format!("the ball of {} (radius {radius} mm) is bigger than the fillet ({rolling} mm)", tool.name),
            )
            .label(operation.span, "this operation rolls the ball in the fillet")
            .label(tool.span, "this ball leaves more material than the fillet")
            .help(format!("take a ball of at most {} mm diameter, or declare the bigger fillet", 2.0 * rolling)),
        );
        return Err(Aborted);
    }
    let mut bands = Vec::new();
    for side in faces {
        let face = part.face(*side);
        // On the face and, on its continuation, until the ball has left hub and edge behind.
        let (from, to) =
            (-part.root_step(*side, 0.0, LEAVE * radius), 1.0 + part.root_step(*side, 1.0, LEAVE * radius));
        let lowest: Option<Vec<(f64, f64)>> = (0..=STATIONS)
            .map(|i| from + (to - from) * i as f64 / STATIONS as f64)
            .map(|u| part.fillet_tangent(*side, u, rolling).map(|v| (u, v)))
            .collect();
        let Some(lowest) = lowest else {
            cx.sink.push(
                Diag::error(
                    planning::NO_FILLET,
                    format!(
                        "a ball of radius {rolling} mm touches hub and {} face nowhere along a ruling",
                        side.name()
                    ),
                )
                .label(operation.span, "this operation rolls the ball in the fillet")
                .help("take a smaller ball, or a smaller fillet"),
            );
            return Err(Aborted);
        };
        // What is left of the lead: there the tool only shifts.
        let rest = |lead: f64| (lead - LEAVE * radius).max(0.0);
        let before = part.root_step(*side, 0.0, rest(operation.lead_in.get()));
        let after = part.root_step(*side, 1.0, rest(operation.lead_out.get()));
        for strip in (0..strips).rev() {
            let band = |v: f64, k: u32| v + (1.0 - v) * f64::from(k) / f64::from(strips);
            let point = |u: f64, v: f64| CcPoint {
                u,
                v: band(v, strip),
                w: band(v, strip + 1),
                position: face.surface.point(u, band(v, strip)),
                normal: face.normal(u, band(v, strip)),
            };
            let ends = (lowest.first().map(|x| x.1), lowest.last().map(|x| x.1));
            let (Some(first), Some(last)) = ends else { return Err(Aborted) };
            let mut points = vec![point(from - before, first)];
            points.extend(lowest.iter().map(|(u, v)| point(*u, *v)));
            points.push(point(to + after, last));
            bands.push((*side, strip, points));
        }
    }
    let notes = vec![format!(
        "{strips} bands a face by two-point offsets (formulas 10 to 12), ball radius {radius} mm, fillet {rolling} mm"
    )];
    let mut passes = Vec::new();
    for sector in &operation.sectors {
        let turn = part.sector_rotation(*sector);
        for (side, strip, points) in &bands {
            passes.push(CcPass {
                label: format!("sector {} {} strip {}", sector + 1, side.name(), strip + 1),
                sector: *sector,
                drive: Drive::Face { side: *side, strip: *strip },
                points: points
                    .iter()
                    .map(|p| CcPoint { position: turn * p.position, normal: turn * p.normal, ..*p })
                    .collect(),
            });
        }
    }
    Ok(CcOperation { operation: id, passes, notes })
}
