//! Shank and holder that keep the tools of `rough` from the floor of the channel, and the tools that would reach it.
//!
//! `rough` plans its lines where the whole tool fits. So a holder that does not go into the channel takes levels away, and
//! no line collides. The lines that the cutter alone would have show what the rest of the tool lacks: it is long enough
//! when it is clear on all of these lines.

use super::orient_tool::{fits_over_hub, positions, roughing};
use super::remedy::remedy;
use crate::collide::tool::tool_coordinates;
use crate::collide::{Section, ToolSolid};
use crate::contract::ContractKind;
use crate::diag::{Aborted, Diag, codes::orientation};
use crate::ir::{ClPoint, Operation, OperationKind, Program};
use crate::part::Clamping;
use crate::passes::context::{Obstacles, PassContext, maximal_ranges};
use nalgebra::Point3;
use rayon::prelude::*;
use std::cell::RefCell;

/// Refuses `rough` operations of which none comes as near to the hub as the contract on the rest demands, where a cutter
/// alone would. A stretch of the channel counts when it is longer than the widest tool.
///
/// # Errors
/// One for each of these operations, in the sink.
pub(crate) fn check(cx: &mut PassContext<'_>) -> Result<(), Aborted> {
    let program = cx.program;
    let roughs: Vec<&Operation> = program.operations.iter().map(|(_, o)| o).filter(|o| !o.kind.finishes()).collect();
    let rest = program.contracts.iter().find(|c| c.kind == ContractKind::Rest && c.scope.is_whole());
    let Some(rest) = rest.map(|c| c.bound.value()) else { return Ok(()) };
    if roughs.is_empty() || !roughs.iter().all(|o| matches!(o.kind, OperationKind::Rough { .. })) {
        return Ok(());
    }
    let Some(closed) = closed_to_all(program, cx.obstacles, &roughs, rest) else { return Ok(()) };
    let free = roughs.iter().fold(program.clone(), |program, operation| {
        let solid = cutter_alone(&program.tools[operation.tool].solid);
        program.with_solid(operation.tool, &solid)
    });
    // The cutters alone do not reach the same places either: other messages say so.
    if closed_to_all(&free, cx.obstacles, &roughs, rest).is_some_and(|of_cutters| of_cutters >= closed) {
        return Ok(());
    }
    // Levels without number are refused first.
    for operation in &roughs {
        roughing(cx, operation)?;
    }
    let refusals: Vec<Diag> = roughs.iter().filter_map(|operation| refusal(cx, operation)).collect();
    if refusals.is_empty() {
        return Ok(());
    }
    refusals.into_iter().for_each(|diag| cx.sink.push(diag));
    Err(Aborted)
}

/// Length of the longest stretch of the channel, mm, where no tool comes to `rest` over the hub; `None` where it is
/// shorter than the widest tool.
fn closed_to_all(program: &Program, obstacles: &Obstacles, roughs: &[&Operation], rest: f64) -> Option<f64> {
    let radii = || roughs.iter().map(|o| program.tools[o.tool].solid.radius());
    let (thinnest, widest) = (radii().fold(f64::INFINITY, f64::min), radii().fold(0.0, f64::max));
    let (mut closed, mut longest): (Option<Vec<bool>>, f64) = (None, 0.0);
    // The last tool comes nearest, in most jobs.
    for operation in roughs.iter().rev() {
        let (fits, step) = fits_over_hub(program, operation, obstacles, [rest, thinnest]);
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

/// The tool without shank and holder.
fn cutter_alone(solid: &ToolSolid) -> ToolSolid {
    ToolSolid { shank: Vec::new(), holder: Vec::new(), ..solid.clone() }
}

/// The error of an operation whose shank or holder is too near to the part on a line that the cutter alone would have,
/// with the worst place and a tool that is clear on all lines; `None` where there is no such line.
pub(crate) fn refusal(cx: &PassContext<'_>, operation: &Operation) -> Option<Diag> {
    let (program, obstacles) = (cx.program, cx.obstacles);
    let tool = &program.tools[operation.tool];
    let clearance = program.clearance.get();
    let lines_of =
        |solid: &ToolSolid| positions(&program.with_solid(operation.tool, &cutter_alone(solid)), operation, obstacles);
    let lack = |solid: &ToolSolid, p: &ClPoint| {
        let slack = |rho: f64, s: f64| solid.body_distance(rho, s) - clearance;
        let nearest = obstacles.nearest((&p.tip, &p.axis), slack, 0.0);
        nearest.reduce(|a, b| if b.0 < a.0 { b } else { a })
    };
    let lines = lines_of(&tool.solid);
    let of_line = |(label, points): &(String, Vec<ClPoint>)| {
        let worst = points.iter().filter_map(|p| lack(&tool.solid, p).map(|(lack, at)| (lack, at, *p)));
        worst.reduce(|a, b| if b.0 < a.0 { b } else { a }).map(|worst| (worst, label.clone()))
    };
    let found: Vec<_> = lines.par_iter().filter_map(of_line).collect();
    let count = found.len();
    let ((violation, at, point), label) = found.into_iter().reduce(|a, b| if b.0.0 < a.0.0 { b } else { a })?;
    let (rho, s) = tool_coordinates(&at, &point.tip, &point.axis);
    let nearest = |sections: &[Section]| sections.iter().map(|x| x.distance(rho, s)).fold(f64::INFINITY, f64::min);
    let body = if nearest(&tool.solid.holder) < nearest(&tool.solid.shank) { "holder" } else { "shank" };
    // Lines depend on the cutter, so that a longer reach changes none.
    let known = RefCell::new((tool.solid.flute_length, lines.clone()));
    let help = remedy(&tool.solid, false, |solid| {
        let mut known = known.borrow_mut();
        if known.0.total_cmp(&solid.flute_length).is_ne() {
            *known = (solid.flute_length, lines_of(solid));
        }
        let clear = |p: &ClPoint| lack(solid, p).is_none() && is_over_clamping(&program.stock.clamping, solid, p);
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

/// True when shank and holder stay over the clamping or beside it.
fn is_over_clamping(clamping: &Clamping, solid: &ToolSolid, p: &ClPoint) -> bool {
    let level = libm::hypot(p.axis.x, p.axis.y);
    let rings = |x: &Section| [(x.from, x.radius_from), (x.to, x.radius_to)];
    let sections = || solid.shank.iter().chain(&solid.holder);
    let centre = |s: f64| -> Point3<f64> { p.tip + p.axis * s };
    let over = |(s, r): (f64, f64)| centre(s).z - r * level >= clamping.below.get();
    let beside = |x: &Section, radius: f64| {
        // The nearest point of the axis of the section to the axis of the part.
        let [from, to] = [x.from, x.to].map(centre);
        let (a, along) = (from.coords.xy(), (to - from).xy());
        let square = along.norm_squared();
        let t = if square > 0.0 { (-a.dot(&along) / square).clamp(0.0, 1.0) } else { 0.0 };
        (a + along * t).norm() - x.radius_from.max(x.radius_to) >= radius
    };
    sections().all(|x| rings(x).into_iter().all(over) || clamping.radius.is_some_and(|r| beside(x, r.get())))
}
