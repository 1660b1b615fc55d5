//! `first-travel`: refuses a machine that is too small for the first roughing before the tool axes of finishing are planned, which
//! takes minutes.
//!
//! Before: the stations of all passes in sector 0. After: the same, or an error. The tool axes of roughing are those of the plan, and
//! the first roughing meets the whole blank. A place within the blank that no branch and no winding reach is therefore out of travel in
//! the program too. `link-moves` judges all other places.

use super::branch::OutOfTravel;
use super::link_moves::{self, MissedPass};
use crate::passes::context::PassContext;
use crate::passes::copy_sectors;
use diagnostics::Aborted;
use five_axis::Pose;
use ir::{ClPass, ClPlan, ClPoint};
use nalgebra::Point3;

/// Judges the passes of the first operation.
///
/// # Errors
/// A place within the blank where X, Y or Z leave their travel.
pub(crate) fn check(cx: &mut PassContext<'_>, cl: &ClPlan) -> Result<(), Aborted> {
    let program = cx.program;
    let Some(first) = cl.operations.first().filter(|o| !program.operations[o.operation].kind.finishes()) else {
        return Ok(());
    };
    let mut plan = ClPlan { operations: vec![first.clone()] };
    copy_sectors::run(program, &mut plan);
    let Some(first) = plan.operations.first() else { return Ok(()) };
    let (machine, length) = (&program.machine, program.tools[program.operations[first.operation].tool].length());
    let in_blank = |tip: &Point3<f64>| program.stock.profile.distance([libm::hypot(tip.x, tip.y), tip.z]) < 0.0;
    let miss = |(index, p): (usize, &ClPoint)| {
        let (k, value, beyond) = machine.farthest_out(&Pose { tip: p.tip, axis: p.axis }, length)?;
        let (axis, range, unit) = (machine.names()[k].to_owned(), machine.travel()[k], "mm");
        let miss = OutOfTravel { index, linear: true, axis, value, range, unit };
        (beyond > 0.0).then_some((p.tip, beyond, miss))
    };
    let mut places = first.passes.iter().flat_map(|pass| &pass.points).filter(|p| in_blank(&p.tip));
    if !places.any(|p| miss((0, p)).is_some()) {
        return Ok(());
    }
    // The remedy is to serve leads outside of the blank as well.
    let farthest = |(pass, planned): (usize, &ClPass)| {
        let misses = planned.points.iter().enumerate().filter_map(miss);
        misses.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(place, _, miss)| MissedPass { pass, place, miss })
    };
    let misses: Vec<_> = first.passes.iter().enumerate().filter_map(farthest).collect();
    link_moves::report(cx, first, &misses);
    Err(Aborted)
}
