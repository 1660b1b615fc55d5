//! `avoid-collision`: tool, shank and holder clear of the part.
//!
//! Before: cutter locations with the axes that the geometry suggests. After: the same contacts with collision-free
//! axes. With `method blend` the axes of channel finishing tilt away from the nearer wall as little as necessary.
//! `corridor` takes the cheapest sequence of clear axes in the coordinates of the machine, `xu` the greedy sequence;
//! `ruling` changes nothing. Layers have already made roughing lines clear. A pass without a clear axis is an error
//! that names the place.

use super::clear_axes::ClearAxes;
use super::orient_tool::tilted_points;
use super::remedy::remedy;
use super::sequence;
use crate::analysis::flank::SIDE_CLEARANCE;
use crate::diag::{Aborted, Diag, codes::orientation};
use crate::entity::PrimaryMap;
use crate::ir::{
    CcOperation, CcPass, CcPlan, ClOperation, ClPlan, ClPoint, Drive, Operation, OperationKind, Program, Tool,
};
use crate::method::AxisMethod;
use crate::part::SurfaceKind;
use crate::passes::context::{AxisTilt, Obstacles, PassContext};
use rayon::prelude::*;

/// Tilt angles that are tried, degrees. A line keeps one tilt angle, so that its axes remain as smooth as the rulings.
const TILTS: [f64; 14] = [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 24.0, 28.0, 32.0];

/// Station at which a pass is not clear, and by how much the tool is too near there, mm.
type Miss = (usize, f64);

/// Makes axes collision-free, or reports where this is impossible.
///
/// # Errors
/// A pass whose shank or holder is nearer to the part than the clearance of the job.
pub(crate) fn run(cx: &mut PassContext<'_>, cc: &CcPlan, cl: &mut ClPlan) -> Result<(), Aborted> {
    let mut failed = false;
    for (planned, oriented) in cc.operations.iter().zip(&mut cl.operations) {
        cx.go_on()?;
        let operation = &cx.program.operations[planned.operation];
        let (program, obstacles) = (cx.program, cx.obstacles);
        if let Some(method @ (AxisMethod::Corridor | AxisMethod::Xu)) = operation.kind.axis_method() {
            failed |= clear_axes(cx, operation, method, planned, oriented).is_err();
            continue;
        }
        let work = cx.progress.begin(format!("{}, clearance", operation.name), planned.passes.len());
        let pairs = || planned.passes.par_iter().zip(&oriented.passes);
        let tilts: Vec<Result<f64, Miss>> =
            pairs().map(|(cc, cl)| work.step(clearing_tilt(program, obstacles, operation, cc, &cl.points))).collect();
        let remedies: Vec<Option<String>> = pairs()
            .zip(&tilts)
            .map(|((cc, cl), tilt)| {
                tilt.is_err().then(|| tool_that_clears(program, obstacles, operation, cc, &cl.points))
            })
            .collect();
        let mut steepest = 0.0_f64;
        let passes = planned.passes.iter().zip(&mut oriented.passes);
        for ((cc, pass), (tilt, remedy)) in passes.zip(tilts.into_iter().zip(remedies)) {
            match tilt {
                Ok(tilt) => {
                    steepest = steepest.max(tilt);
                    if tilts_away(operation, cc) {
                        pass.points = tilted_points(program, operation, cc, AxisTilt::Away(tilt.to_radians()));
                    }
                }
                Err((index, violation)) => {
                    failed = true;
                    let tool = &cx.program.tools[operation.tool];
                    let at = pass.points.get(index).map_or_else(nalgebra::Point3::origin, |p| p.tip);
                    let (label, at) = cx.in_first_sector(operation, &pass.label, at);
                    let diag = Diag::error(
                        orientation::COLLISION,
                        format!(
                            "`{}`: {} is {violation:.2} mm too near to the part; required clearance of shank and holder {:.2} mm",
                            operation.name,
                            tool.name,
                            cx.program.clearance.get()
                        ),
                    )
                    .label(operation.span, "in this operation")
                    .label(tool.span, "with this tool")
                    .place(label, at);
                    cx.sink.push(remedy.into_iter().fold(diag, Diag::help));
                }
            }
        }
        if steepest > 0.0 {
            oriented
                .notes
                .push(format!("tool axes tilt away from the nearer wall by up to {steepest} deg at the wall"));
        }
    }
    if failed { Err(Aborted) } else { Ok(()) }
}

/// True when a pass tilts away from walls as far as necessary.
fn tilts_away(operation: &Operation, cc: &CcPass) -> bool {
    let along = operation.kind.axis_method() == Some(AxisMethod::Ruling);
    matches!(cc.drive, Drive::Hub | Drive::Contact(_) | Drive::Round) && !along
}

/// Chooses clear axes for all passes of an operation.
fn clear_axes(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    method: AxisMethod,
    planned: &CcOperation,
    oriented: &mut ClOperation,
) -> Result<(), Aborted> {
    let program = cx.program;
    let clear = ClearAxes::new(program, cx.obstacles, operation);
    let work = cx.progress.begin(format!("{}, collision-free axes", operation.name), planned.passes.len());
    let (passes, planned) = (&oriented.passes, &planned.passes);
    let chosen = if method == AxisMethod::Xu {
        sequence::greedy_axes(&clear, &program.machine.chain, planned, passes)
    } else {
        let on_floor = matches!(operation.kind, OperationKind::Channel { .. });
        sequence::shortest(&clear, &program.machine, (passes, on_floor), &work)
    };
    let (found, blocked) = match chosen {
        Ok(points) => (points, Vec::new()),
        Err(faults) => (Vec::new(), faults),
    };
    let tool = &program.tools[operation.tool];
    for (i, (at, about)) in &blocked {
        let label = oriented.passes.get(*i).map_or("", |p| p.label.as_str());
        let (label, place) = cx.in_first_sector(operation, label, *at);
        cx.sink.push(
            clear
                .no_axis(&operation.name, &tool.name, at, about)
                .place(label, place)
                .label(operation.span, "in this operation")
                .label(tool.span, "with this tool"),
        );
    }
    if !blocked.is_empty() {
        return Err(Aborted);
    }
    for (pass, points) in oriented.passes.iter_mut().zip(found) {
        pass.points = points;
    }
    Ok(())
}

/// Describes a tool that would clear the pass. For a pass along the rulings the cutter stays: the surface that the pass
/// cuts determines its size.
fn tool_that_clears(
    program: &Program,
    obstacles: &Obstacles,
    operation: &Operation,
    cc: &CcPass,
    points: &[ClPoint],
) -> String {
    let free = tilts_away(operation, cc);
    remedy(&program.tools[operation.tool].solid, free, |solid| {
        let mut program = program.clone();
        let mut tools = PrimaryMap::new();
        for (id, tool) in program.tools.iter() {
            let solid = if id == operation.tool { solid } else { &tool.solid };
            tools.push(Tool { solid: solid.clone(), ..tool.clone() });
        }
        program.tools = tools;
        clearing_tilt(&program, obstacles, operation, cc, points).is_ok()
    })
}

/// The least tilt angle, degrees, that clears a pass, or the worst place and by how much the tool is too near there, mm.
fn clearing_tilt(
    program: &Program,
    obstacles: &Obstacles,
    operation: &Operation,
    cc: &CcPass,
    points: &[ClPoint],
) -> Result<f64, Miss> {
    let solid = &program.tools[operation.tool].solid;
    let tilts_away_here = tilts_away(operation, cc);
    let on_vane = matches!(cc.drive, Drive::Contact(_) | Drive::Round);
    let violation = |p: &ClPoint| {
        let ball = solid.cutter.ends_in_ball();
        // A ball on an edge: nothing of the part is near the side of the cutter.
        let edge = matches!(cc.drive, Drive::Contact(SurfaceKind::InletEdge(_) | SurfaceKind::OutletEdge(_)));
        let beside = on_vane && !(ball && edge);
        let inside = if beside { obstacles.cutter_inside(solid, &p.tip, &p.axis) } else { None };
        let side = (tilts_away_here && ball).then_some(SIDE_CLEARANCE);
        let body = obstacles.body_lack(solid, &p.tip, &p.axis, program.clearance.get(), side);
        inside.into_iter().chain(body).reduce(f64::min)
    };
    let worst = |points: &[ClPoint]| {
        points
            .iter()
            .enumerate()
            .filter_map(|(i, p)| violation(p).map(|d| (i, d)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(i, distance)| (i, -distance))
    };
    if !tilts_away_here {
        return worst(points).map_or(Ok(0.0), Err);
    }
    let mut last = (0, 0.0);
    // The contact is on the arc of a barrel and not on its tip.
    let end = if on_vane { solid.cutter.barrel_angle() } else { None };
    for tilt in TILTS.into_iter().filter(|tilt| end.is_none_or(|end| *tilt > 0.0 && tilt.to_radians() < end)) {
        match worst(&tilted_points(program, operation, cc, AxisTilt::Away(tilt.to_radians()))) {
            None => return Ok(tilt),
            Some(miss) => last = miss,
        }
    }
    Err(last)
}
