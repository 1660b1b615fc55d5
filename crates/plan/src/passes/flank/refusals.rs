//! Refusals of flank milling, with their remedies.

use super::strip::{self, Surroundings, WorstError};
use super::sweep::StripTask;
use crate::passes::context::PassContext;
use crate::tolerance_budget::{SLACK, kept};
use base::units::length;
use diagnostics::{Aborted, Diag, codes::planning};
use ir::Operation;
use rayon::prelude::*;
use tool_stock::collide::Cutter;
use wheel::part::{FaceId, SurfaceKind};

/// Ratio by which a quick search may miss the tolerance budget; the full search still succeeds.
pub(crate) const NEARLY: f64 = 1.1;

/// Largest number of strips that `strips auto` tries.
pub(crate) const MAX_STRIPS: u32 = 8;

/// The law behind the help of both diagnostics.
const LAW: &str =
    "the error of a strip grows with the radius of the cutter, and with the cube of the height of the strip";

pub(crate) fn no_ball(cx: &mut PassContext<'_>, operation: &Operation, side: FaceId, rolling: f64) -> Aborted {
    cx.sink.push(
        Diag::error(
            planning::NO_FILLET,
            format!("at a ruling no ball of radius {rolling} mm touches hub and {} face together", side.name()),
        )
        .label(operation.span, "this operation rolls the ball in the fillet")
        .help("use a smaller ball, or a smaller fillet"),
    );
    Aborted
}

/// The largest cutter that keeps an error with a number of strips, as a share of its size; `None` where no cutter does.
pub(crate) struct FittingSize {
    strips: u32,
    share: Option<f64>,
}

/// Describes the sizes of the cutter that would keep the contracts.
fn sizes(cutter: &Cutter, fitting: &[FittingSize]) -> Option<String> {
    let size = |FittingSize { strips, share }: &FittingSize| {
        // Rounded down to tenths of a millimetre.
        let diameter = share.map(|s| (20.0 * s * cutter.nominal_radius()).floor() / 10.0).filter(|d| *d > 0.0)?;
        Some(format!("{diameter} mm diameter with {strips} strip{}", if *strips == 1 { "" } else { "s" }))
    };
    let all: Vec<String> = fitting.iter().filter_map(size).collect();
    (!all.is_empty())
        .then(|| format!("use a {} cutter of this shape of at most {}", cutter.keyword(), all.join(", or ")))
}

/// Reports that no number of strips keeps the contracts.
pub(crate) fn never(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    side: FaceId,
    worst: &WorstError,
    needed: f64,
    fitting: &[FittingSize],
) {
    let program = cx.program;
    let tool = &program.tools[operation.tool];
    let [u, v] = worst.placed.parameters;
    let place = match worst.placed.kind {
        SurfaceKind::Face(_) => format!("{} face at u = {u:.3}, v = {v:.3}", side.name()),
        _ => format!("beside the {} face", side.name()),
    };
    let diag = Diag::error(
        planning::NOT_FLANK_MILLABLE,
        format!(
            "{MAX_STRIPS} strips with {} leave a deviation of {} on the {} face; the tolerance budget is {} on each side",
            tool.name,
            length(worst.error),
            side.name(),
            length(needed)
        ),
    )
    .label(operation.span, "in this operation")
    .label(tool.span, "with this cutter")
    .place(place, worst.placed.target.point)
    .note(LAW)
    .note(format!("each bound is reduced by {}: the chord tolerance, and a reserve for the proof", length(kept(program))));
    let help = match sizes(&tool.solid.cutter, fitting) {
        Some(sizes) => format!("{sizes}; or use wider contracts on this face, or point milling"),
        None if needed < SLACK => "use a finer `tolerance chord`, or wider contracts on this face".to_owned(),
        None => "use wider contracts on this face, or point milling; no smaller cutter of this shape is sufficient"
            .to_owned(),
    };
    cx.sink.push(diag.help(help));
}

/// Reports the violation of the contracts with the number of strips from the job.
pub(crate) fn out_of_tolerance(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    task: &StripTask<'_>,
    around: &Surroundings<'_>,
    side: FaceId,
    strips: u32,
    violation: f64,
) {
    let tool = &cx.program.tools[operation.tool];
    let cutter = tool.solid.cutter;
    let found = task
        .budget(SurfaceKind::Face(side), side)
        .map(|[below, above]| fitting(around, side, cutter, &[strips], 0.5 * (below + above)));
    let sizes = found.and_then(|f| sizes(&cutter, &f)).map_or("use a smaller cutter".to_owned(), |s| s);
    cx.sink.push(
        Diag::warning(
            planning::NOT_FLANK_MILLABLE,
            format!(
                "{strips} strip{} with {}: the deviation on the {} face exceeds the tolerance budget by {}",
                if strips == 1 { "" } else { "s" },
                tool.name,
                side.name(),
                length(violation)
            ),
        )
        .help(format!("use more strips (`strips auto` finds the number); {sizes}; or use wider contracts on this face"))
        .label(operation.span, "in this operation")
        .label(tool.span, "with this cutter")
        .note(LAW),
    );
}

/// For each number of strips the largest cutter that keeps an error, as a share of its size.
pub(crate) fn fitting(
    around: &Surroundings<'_>,
    side: FaceId,
    cutter: Cutter,
    strips: &[u32],
    error: f64,
) -> Vec<FittingSize> {
    // The factor leaves a reserve for easing and for the full search.
    let size = |k: &u32| FittingSize { strips: *k, share: strip::fitting(around, side, *k, cutter, error / NEARLY) };
    if error > SLACK { strips.par_iter().map(size).collect() } else { Vec::new() }
}
