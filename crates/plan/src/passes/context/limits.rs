//! Limits of planning: samples, points, memory, and the size of a ball against the fillet.

use super::PassContext;
use crate::memory;
use base::units;
use diagnostics::{Aborted, Diag, Sink, codes::planning};
use ir::program::DEFAULT_MEMORY;
use ir::{Operation, Program};
use wheel::part::sample;

/// Difference of radii that is rounding, mm.
const SAME_RADIUS: f64 = 1e-9;

/// Refuses parts that cannot be sampled within the memory. The limit of samples is that of the default memory.
pub(crate) fn check_size(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    let samples = sample::estimate(&program.part, FINEST_SPACING);
    let most = sample::MOST_SAMPLES * (program.memory / DEFAULT_MEMORY).max(1.0);
    if samples <= most {
        return Ok(());
    }
    let enough = units::bytes(1e9 * (samples / sample::MOST_SAMPLES * DEFAULT_MEMORY / 1e9).ceil());
    let outlet = program.part.hub.meridian(1.0).point.x;
    sink.push(
        Diag::error(
            planning::TOO_LARGE,
            format!("a part of {outlet:.0} mm radius needs {samples:.1e} samples; the limit is {most:.1e}"),
        )
        .help(format!("check the units of the points; or allow {enough} of memory with `--memory`")),
    );
    Err(Aborted)
}

/// Spacing of the samples that verification will need, mm.
const FINEST_SPACING: f64 = 0.25;

/// Refuses an operation whose points in a sector, together with those of earlier operations, exceed the memory. The
/// estimate before planning knows only the sizes of the part; this check knows the lines.
pub(crate) fn check_points(cx: &mut PassContext<'_>, operation: &Operation, points: f64) -> Result<(), Aborted> {
    let needed = memory::of_stations(cx.program, cx.stations.and(points, operation));
    check_memory(cx, Some(operation), needed)
}

/// Refuses a plan that needs more than the allowed memory; `needed` is in bytes, `operation` is the planned operation.
pub(crate) fn check_memory(
    cx: &mut PassContext<'_>,
    operation: Option<&Operation>,
    needed: f64,
) -> Result<(), Aborted> {
    if needed <= cx.program.memory {
        return Ok(());
    }
    let (needed, most) = (units::bytes(needed), units::bytes(cx.program.memory));
    let mut diag =
        Diag::error(planning::OVER_MEMORY, format!("the plan needs about {needed} of memory; the limit is {most}"));
    if let Some(operation) = operation {
        diag = diag.label(operation.span, "planned up to this operation");
    }
    let help = "use a larger `depth`, `residual` or `scallop`, fewer `sectors` or operations in one job, or more memory: `--memory`";
    cx.sink.push(diag.help(help));
    Err(Aborted)
}

/// Refuses a ball that is bigger than the fillet in which it rolls or beside which it stands. `why` gives the reasons
/// at the operation and at its tool.
pub(crate) fn check_fillet(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    [at_operation, at_tool]: [&str; 2],
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
