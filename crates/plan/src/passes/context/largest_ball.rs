//! The size of a ball against the fillet.

use super::PassContext;
use diagnostics::{Aborted, Diag, codes::planning};
use ir::Operation;

/// Difference of radii that is rounding, mm.
const SAME_RADIUS: f64 = 1e-9;

/// Refuses a ball that is bigger than the fillet in which it rolls or beside which it stands, with the reasons at the
/// operation and at its tool.
pub(crate) fn check_fillet(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    at_operation: &str,
    at_tool: &str,
) -> Result<(), Aborted> {
    let tool = &cx.program.tools[operation.tool];
    let radius = tool.solid.cutter.tip_radius();
    let least =
        operation.kind.blades(&cx.program.part).filter_map(|blade| cx.program.part.blade(blade).fillet.as_ref());
    let least = least.map(wheel::part::Fillet::least);
    let least = least.min_by(|a, b| a.get().total_cmp(&b.get()));
    let Some(fillet) = least.filter(|f| radius > f.get() + SAME_RADIUS) else { return Ok(()) };
    cx.sink.push(
        Diag::error(
            planning::BALL_TOO_BIG,
            format!("the ball of {} (radius {radius} mm) is larger than the fillet ({fillet})", tool.name),
        )
        .label(operation.span, at_operation)
        .label(tool.span, at_tool)
        .help(format!("use a ball of at most {} mm diameter, or declare a larger fillet", 2.0 * fillet.get())),
    );
    Err(Aborted)
}

/// The remedy for a ball that is larger than a hollow: a diameter of less than twice the radius, mm.
pub(crate) fn less_than_radius(radius: f64) -> String {
    format!("use a ball of less than {:.2} mm diameter", (200.0 * radius).floor() / 100.0)
}
