//! Tools with which passes of a ball would have tool axes, found by a trial of each tool on all of these passes.

use super::clear_axes::{ClearAxes, StandingBall};
use super::sequence::has_candidates;
use crate::passes::context::{PassContext, remedy};
use ir::{ClPass, ClPoint, Operation, Program};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Tools that are tried, at most.
const MAX_TRIED: usize = 54;

/// Describes the smallest changes of the tool of an operation with which each of these passes has axes. `has_axes` decides this for
/// the clear axes of the changed tool, the program with it, and the pass with its index. At the places, each with the direction about which
/// axes are tried, the tool has no axis: a changed tool with the same ball needs one there first.
pub(super) fn remedy_for(
    cx: &PassContext<'_>,
    operation: &Operation,
    passes: &[(usize, &ClPass)],
    places: &[(Point3<f64>, Vector3<f64>)],
    has_axes: impl Fn(&ClearAxes<'_>, &Program, (usize, &ClPass)) -> bool + Sync,
) -> String {
    let tool = &cx.program.tools[operation.tool];
    let radius = ClearAxes::new(cx.program, cx.obstacles, operation).radius();
    let work = cx.progress.begin(format!("{}, tools that would do", operation.name), MAX_TRIED);
    remedy(&tool.solid, true, |solid| {
        work.advance(1);
        let program = cx.program.with_solid(operation.tool, solid);
        let clear = ClearAxes::new(&program, cx.obstacles, operation);
        let tried = |(index, pass): &(usize, &ClPass)| {
            !cx.progress.is_cancelled()
                && has_axes(&clear, &program, (*index, &with_ball(pass, [radius, clear.radius()])))
        };
        let [_, least] = clear.with_less_side_distance();
        let has_axis = |(centre, about): &(Point3<f64>, Vector3<f64>)| {
            let ball = StandingBall { centre: *centre, normal: None };
            least.has_candidates(&ball, about)
        };
        let may_have_axes =
            |(_, pass): &(usize, &ClPass)| has_candidates(&least, &with_ball(pass, [radius, clear.radius()]));
        (clear.radius() != radius || places.par_iter().all(has_axis))
            && passes.par_iter().all(may_have_axes)
            && passes.par_iter().all(tried)
    })
}

/// The pass with the same contacts and axes and a ball of another radius.
fn with_ball(pass: &ClPass, [from, to]: [f64; 2]) -> ClPass {
    let moved = |point: &ClPoint| {
        let ball = StandingBall::at(point, from);
        let Some(normal) = ball.normal else { return *point };
        let centre = ball.centre - normal * (from - to);
        ClPoint { tip: centre - point.axis * to, ..*point }
    };
    ClPass { points: pass.points.iter().map(moved).collect(), ..pass.clone() }
}
