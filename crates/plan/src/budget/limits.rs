//! Refusal of what does not fit.

use super::counts::{Figure, estimate, with_figure};
use super::{Cost, SAMPLE_SPACING, Stations, of_moves, of_stations, peak, sum};
use base::units::{bytes, trim};
use diagnostics::{Aborted, Diag, Sink, codes::planning};
use ir::program::DEFAULT_MEMORY;
use ir::{Motion, Operation, OperationKind, Program};
use wheel::method::FlankMethod;
use wheel::part::sample;

/// Most strips that a plan may optimise: each takes about a second of a processor.
const MAX_STRIPS: u32 = 200;

/// Strips of a face that `strips auto` may try.
const AUTO_STRIPS: u32 = 8;

/// Refuses a plan that would take too much memory or optimise too many strips, before it starts.
///
/// # Errors
/// The plan is refused; the reason is in the sink, with a value that would fit.
pub fn check(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    check_strips(program, sink)?;
    let costs = estimate(program);
    let needed = sum(program, &costs);
    if needed <= program.memory {
        return Ok(());
    }
    let mut ranked: Vec<(&Operation, Cost)> = program.operations.iter().map(|(_, o)| o).zip(costs).collect();
    ranked.sort_by(|a, b| b.1.bytes().total_cmp(&a.1.bytes()));
    let Some((operation, cost)) = ranked.first() else { return Ok(()) };
    let more = format!("`--memory {}GB`", (1.2 * needed / 1e9).ceil());
    // What the part needs without any motion: no operation lowers it.
    let of_part = peak(program, 0.0);
    let help = match fitting(program, operation) {
        _ if of_part > program.memory => format!("allow more memory: {more}; the part alone needs more than the limit"),
        Some(fits) => format!("use {fits} or more, fewer `sectors`, or more memory: {more}"),
        None => {
            format!("divide the job into several jobs with fewer operations or `sectors`, or allow more memory: {more}")
        }
    };
    let mut diag = Diag::error(
        planning::OVER_MEMORY,
        format!("the plan needs about {} of memory; the limit is {}", bytes(needed), bytes(program.memory)),
    )
    .help(help)
    .note(format!("the part with samples of the surfaces of all its sectors: about {}", bytes(of_part)));
    diag = if of_part > cost.bytes() {
        diag.label(program.name_span, "most of it for this part")
    } else {
        diag.label(operation.span, format!("{:.0} lines with {:.0} points", cost.lines, cost.stations.copied))
    };
    for (operation, cost) in ranked.iter().take(5) {
        diag = diag.note(format!("`{}`: about {}", operation.name, bytes(cost.bytes())));
    }
    sink.push(diag);
    Err(Aborted)
}

/// The least usual value of a figure with which the plan fits, when no operation has a lower one.
fn fitting(program: &Program, operation: &Operation) -> Option<String> {
    let solid = &program.tools[operation.tool].solid;
    let radius = solid.cutter.nominal_radius();
    let figures = [
        (Figure::Residual, radius),
        (Figure::Stepover, 2.0 * radius),
        (Figure::Scallop, radius),
        (Figure::Depth, solid.flute_length),
    ];
    figures.into_iter().find_map(|(figure, most)| {
        let now = figure.of(&mut operation.kind.clone())?.get();
        let usual = (-4..=2).flat_map(|e| [1.0, 1.5, 2.0, 3.0, 5.0, 7.0].map(|m: f64| m * 10f64.powi(e)));
        let fits = |value: &f64| sum(program, &with_figure(program, Some((figure, *value)))) <= program.memory;
        let value = usual.filter(|v| *v > now && *v <= most).find(fits)?;
        let text = if value < 0.2 { format!("{} um", trim(value * 1e3, 3)) } else { format!("{} mm", trim(value, 3)) };
        Some(format!("`{} {text}`", figure.name()))
    })
}

/// Refuses more strips than can be optimised in minutes.
fn check_strips(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    let strips_of = |o: &Operation| match &o.kind {
        OperationKind::Flank { faces, flank } if flank.method == FlankMethod::Minimax => {
            flank.strips.unwrap_or(AUTO_STRIPS).saturating_mul(u32::try_from(faces.len()).unwrap_or(u32::MAX))
        }
        OperationKind::Flank { .. } => 0,
        OperationKind::Roughing { .. } | OperationKind::Channel { .. } | OperationKind::Point { .. } => 0,
    };
    let all = program.operations.iter().map(|(_, o)| strips_of(o)).fold(0, u32::saturating_add);
    let Some((_, operation)) = program.operations.iter().filter(|_| all > MAX_STRIPS).max_by_key(|(_, o)| strips_of(o))
    else {
        return Ok(());
    };
    sink.push(
        Diag::error(
            planning::OVER_MEMORY,
            format!("the job optimises up to {all} strips of flank milling; the limit is {MAX_STRIPS}"),
        )
        .label(operation.span, format!("{} of them", strips_of(operation)))
        .help(format!(
            "use fewer `strips` (`strips auto` counts as {AUTO_STRIPS} per face), or fewer operations with `method minimax` in one job"
        )),
    );
    Err(Aborted)
}

/// Refuses parts that cannot be sampled within the memory. The limit of samples is that of the default memory.
pub(crate) fn check_size(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    let samples = sample::estimate(&program.part, SAMPLE_SPACING);
    let most = sample::MAX_SAMPLES * (program.memory / DEFAULT_MEMORY).max(1.0);
    if samples <= most {
        return Ok(());
    }
    let enough = bytes(1e9 * (samples / sample::MAX_SAMPLES * DEFAULT_MEMORY / 1e9).ceil());
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

/// Refuses an operation whose points in a sector, together with those of earlier operations, exceed the memory; `stations` has
/// all of them. The estimate before planning knows only the sizes of the part; this check knows the lines.
pub(crate) fn check_points(
    program: &Program,
    stations: Stations,
    operation: &Operation,
    sink: &mut Sink,
) -> Result<(), Aborted> {
    check_memory(program, Some(operation), of_stations(program, stations), sink)
}

/// Refuses a motion whose run of the axes exceeds the memory, with `planned` stations in a sector.
pub(crate) fn check_motion(program: &Program, motion: &Motion, planned: f64, sink: &mut Sink) -> Result<(), Aborted> {
    check_memory(program, None, of_moves(program, motion, planned), sink)
}

/// Refuses a plan that needs more than the allowed memory; `needed` is in bytes, `operation` is the planned operation.
fn check_memory(program: &Program, operation: Option<&Operation>, needed: f64, sink: &mut Sink) -> Result<(), Aborted> {
    if needed <= program.memory {
        return Ok(());
    }
    let (needed, most) = (bytes(needed), bytes(program.memory));
    let mut diag =
        Diag::error(planning::OVER_MEMORY, format!("the plan needs about {needed} of memory; the limit is {most}"));
    if let Some(operation) = operation {
        diag = diag.label(operation.span, "planned up to this operation");
    }
    let help = "use a larger `depth`, `residual` or `scallop`, fewer `sectors` or operations in one job, or more memory: `--memory`";
    sink.push(diag.help(help));
    Err(Aborted)
}
