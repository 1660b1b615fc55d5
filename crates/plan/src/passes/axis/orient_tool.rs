//! `orient-tool`: tip and axis of every station.
//!
//! Before: contact or drive points of a sector. After: its cutter locations at the same stations. The modules of the
//! operations determine the axes.

use crate::passes::channel::hub_points;
pub(crate) use crate::passes::channel::middle::{Middle, Middles};
use crate::passes::context::{AxisTilt, PassContext};
use crate::passes::flank::{flank_points, path_points};
use crate::passes::point::vane_points;
use crate::passes::rough::channel_points;
use diagnostics::Aborted;
use ir::{CcOperation, CcPass, CcPlan, ClOperation, ClPass, ClPlan, ClPoint, Drive, Operation, OperationKind, Program};
use rayon::prelude::*;
use wheel::method::AxisMethod;

/// Makes cutter locations.
///
/// # Errors
/// The run was cancelled.
pub(crate) fn run(cx: &mut PassContext<'_>, cc: &CcPlan) -> Result<ClPlan, Aborted> {
    let mut plan = ClPlan::default();
    for operation in &cc.operations {
        cx.go_on()?;
        plan.operations.push(orient_operation(cx, operation)?);
    }
    Ok(plan)
}

fn orient_operation(cx: &mut PassContext<'_>, cc: &CcOperation) -> Result<ClOperation, Aborted> {
    let program = cx.program;
    let operation = &program.operations[cc.operation];
    let work = cx.progress.begin(format!("{}, tool axes", operation.name), cc.passes.len());
    let points = |pass: &CcPass| match pass.drive {
        Drive::Channel => channel_points(pass),
        Drive::Face { side, .. } => match &pass.path {
            Some(path) => path_points(path, pass),
            None => flank_points(program, operation, pass, side),
        },
        Drive::Hub(_) | Drive::HubWithLead(..) | Drive::Contact(_) | Drive::Round(_) => {
            tilted_points(program, operation, pass, |_| tilt(operation))
        }
    };
    let oriented = |pass: &CcPass| {
        work.do_step(|| ClPass {
            label: pass.label.clone(),
            sector: 0,
            air: Vec::new(),
            link: None,
            points: points(pass),
        })
    };
    let passes = cc.passes.par_iter().map(oriented).collect::<Option<Vec<_>>>().ok_or(Aborted)?;
    Ok(ClOperation { operation: cc.operation, passes, notes: cc.notes.clone() })
}

/// Tilt before collision avoidance.
fn tilt(operation: &Operation) -> AxisTilt {
    if operation.kind.axis_method() == Some(AxisMethod::Ruling) {
        return AxisTilt::Along;
    }
    match operation.kind {
        OperationKind::Point { .. } => AxisTilt::Away(FIRST_TILT),
        OperationKind::Roughing { .. } | OperationKind::Flank { .. } | OperationKind::Channel { .. } => {
            AxisTilt::Away(0.0)
        }
    }
}

/// Tilt off a face before collision avoidance, radians. It leaves some free space for the twist of a vane.
const FIRST_TILT: f64 = 0.25;

/// Stations of a pass, each with its tilt.
pub(crate) fn tilted_points(
    program: &Program,
    operation: &Operation,
    pass: &CcPass,
    tilt: impl Fn(usize) -> AxisTilt,
) -> Vec<ClPoint> {
    match pass.drive {
        Drive::Contact(surface) => {
            vane_points(program, operation, pass, |axes, i, p| axes.axis(surface, p.u, p.v, tilt(i)))
        }
        Drive::Round(blade) => {
            vane_points(program, operation, pass, |axes, i, p| axes.round(blade, p.w, [p.u, p.v], tilt(i)))
        }
        Drive::Channel | Drive::Face { .. } | Drive::Hub(_) | Drive::HubWithLead(..) => {
            hub_points(program, operation, pass, tilt)
        }
    }
}
