//! Shank and holder that keep the tools of `rough` from the floor of the channel, and the tools that would reach it.
//!
//! `rough` plans its lines where the whole tool fits. So a holder that does not go into the channel takes levels away, and
//! no line collides. The lines of the cutter alone show whether the rest of the tool is long enough: then it is clear
//! on all of these lines.

use super::floor::{fits_over_hub, positions};
use super::layers::Roughing;
use super::{Roughings, roughing};
use crate::passes::context::{PassContext, maximal_ranges, remedy};
use base::progress::Progress;
use diagnostics::{Aborted, Diag, codes::orientation};
use ir::{ClPoint, Operation, OperationId, RoughingStrategy};
use rayon::prelude::*;
use std::borrow::Borrow;
use std::cell::RefCell;
use tool_stock::collide::tool::tool_coordinates;
use tool_stock::collide::{Section, ToolSolid};
use wheel::contract::ContractKind;
use wheel::part::Passage;

/// Refuses `rough` operations where none comes as near to the hub as the contract on the rest requires, but their cutters alone
/// would. An interval of the channel counts when it is longer than the widest tool.
///
/// # Errors
/// One for each of these operations, in the sink.
pub(crate) fn check(cx: &mut PassContext<'_>, roughings: &Roughings<'_>) -> Result<(), Aborted> {
    let program = cx.program;
    let roughs: Vec<(OperationId, &Operation)> =
        program.operations.iter().filter(|(_, operation)| !operation.kind.finishes()).collect();
    let rest = program.contracts.iter().find(|c| c.kind == ContractKind::Rest && c.scope.is_whole());
    let Some(rest) = rest.map(|c| c.bound.value()) else { return Ok(()) };
    if roughs.is_empty()
        || !roughs.iter().all(|(_, o)| matches!(o.kind.strategy(), Some(RoughingStrategy::Rough { .. })))
    {
        return Ok(());
    }
    let radii = || roughs.iter().map(|(_, o)| program.tools[o.tool].solid.radius());
    let sizes = [radii().fold(f64::INFINITY, f64::min), radii().fold(0.0, f64::max)];
    // The last tool comes nearest, in most jobs.
    let last_first = || roughs.iter().rev();
    let free = roughs.iter().fold(program.clone(), |program, (_, operation)| {
        let cutter = program.tools[operation.tool].solid.cutter_alone(0.0);
        program.with_solid(operation.tool, &cutter)
    });
    let kept_out = |passage: Passage| {
        let planned = last_first().filter_map(|(id, _)| roughings[*id].get(passage.id.index()));
        let Some(closed) = closed_to_all(planned, rest, sizes, cx.progress) else { return false };
        let roughing = |operation| Roughing::new(&free, operation, passage.id, cx.obstacles, cx.progress);
        let cutters = last_first().filter_map(|(_, operation)| roughing(operation));
        // Where the cutters alone do not reach the same places either, other messages say so.
        closed_to_all(cutters, rest, sizes, cx.progress).is_none_or(|of_cutters| of_cutters < closed)
    };
    let is_kept_out = program.part.passages().any(kept_out);
    cx.go_on()?;
    if !is_kept_out {
        return Ok(());
    }
    // Levels without number are refused first.
    for (id, _) in &roughs {
        roughing(cx, roughings, *id)?;
    }
    let refusals: Vec<Diag> = roughs.iter().filter_map(|(_, operation)| refusal(cx, operation)).collect();
    cx.go_on()?;
    if refusals.is_empty() {
        return Ok(());
    }
    refusals.into_iter().for_each(|diag| cx.sink.push(diag));
    Err(Aborted)
}

/// Length of the longest interval of the channel, mm, where no tool comes to `rest` over the hub; `None` where it is
/// shorter than the widest tool. `thinnest` and `widest` are the radii of the tools.
fn closed_to_all<'a>(
    roughings: impl Iterator<Item = impl Borrow<Roughing<'a>>>,
    rest: f64,
    [thinnest, widest]: [f64; 2],
    progress: &Progress,
) -> Option<f64> {
    let (mut closed, mut longest): (Option<Vec<bool>>, f64) = (None, 0.0);
    for roughing in roughings {
        let (fits, step) = fits_over_hub(roughing.borrow(), rest, thinnest, progress);
        let before = closed.unwrap_or_else(|| vec![true; fits.len()]);
        let now: Vec<bool> = before.iter().zip(&fits).map(|(closed, fits)| *closed && !fits).collect();
        let most = maximal_ranges(now.len(), |i| now[i]).iter().map(|r| r.len() - 1).max();
        longest = most.map_or(0.0, |count| count as f64 * step);
        if longest <= 2.0 * widest {
            return None;
        }
        closed = Some(now);
    }
    Some(longest)
}

/// The error of an operation whose shank or holder is too near to the part on a line that the cutter alone would have,
/// with the worst place and a tool that is clear on all lines; `None` where there is no such line, and for operations
/// other than `rough`.
pub(crate) fn refusal(cx: &PassContext<'_>, operation: &Operation) -> Option<Diag> {
    let (program, obstacles) = (cx.program, cx.obstacles);
    let tool = &program.tools[operation.tool];
    let clearance = program.clearance.get();
    let lines_of = |solid: &ToolSolid| {
        positions(&program.with_solid(operation.tool, &solid.cutter_alone(0.0)), operation, obstacles, cx.progress)
    };
    let worst_of_body = |solid: &ToolSolid, p: &ClPoint| {
        let slack = |rho: f64, s: f64| solid.body_distance(rho, s) - clearance;
        let nearest = obstacles.nearest(&p.tip, &p.axis, slack, 0.0);
        nearest.reduce(|a, b| if b.0 < a.0 { b } else { a })
    };
    let lines = lines_of(&tool.solid);
    let of_line = |(label, points): &(String, Vec<ClPoint>)| {
        let worst = points.iter().filter_map(|p| worst_of_body(&tool.solid, p).map(|(least, at)| (least, at, *p)));
        worst.reduce(|a, b| if b.0 < a.0 { b } else { a }).map(|worst| (worst, label.clone()))
    };
    let found: Vec<_> = lines.par_iter().filter_map(of_line).collect();
    let count = found.len();
    let ((violation, at, point), label) = found.into_iter().reduce(|a, b| if b.0.0 < a.0.0 { b } else { a })?;
    let (rho, s) = tool_coordinates(&at, &point.tip, &point.axis);
    let nearest = |sections: &[Section]| Section::least_distance(sections, rho, s);
    let body = if nearest(&tool.solid.holder) < nearest(&tool.solid.shank) { "holder" } else { "shank" };
    // Lines depend on the cutter, so that a longer reach changes none.
    let known = RefCell::new((tool.solid.flute_length, lines.clone()));
    let help = remedy(&tool.solid, false, |solid| {
        let mut known = known.borrow_mut();
        if known.0.total_cmp(&solid.flute_length).is_ne() {
            *known = (solid.flute_length, lines_of(solid));
        }
        let clear = |p: &ClPoint| {
            worst_of_body(solid, p).is_none() && program.stock.clamping.clears_body(solid, &p.tip, &p.axis)
        };
        known.1.par_iter().all(|(_, points)| points.iter().all(clear))
    });
    let (label, at) = cx.in_first_sector(operation, &label, point.tip);
    Some(
        Diag::error(
            orientation::COLLISION,
            format!(
                "`{}`: where {} has to cut, its {body} would be {:.2} mm too near to the part; required clearance of \
                 shank and holder {clearance:.2} mm",
                operation.name, tool.name, -violation
            ),
        )
        .label(operation.span, "in this operation")
        .label(tool.span, format!("the {body} of this tool keeps its cutter from these lines"))
        .place(label, at)
        .note(format!(
            "the cutter alone would have {} lines in a channel; on {count} of them shank or holder is too near; this is \
             the worst place",
            lines.len()
        ))
        .help(help),
    )
}
