//! `avoid-collision`: tool, shank and holder clear of the part.
//!
//! Before: cutter locations with the axes that the geometry suggests. After: the same contacts with collision-free
//! axes. With `method blend` the axes of channel finishing tilt away from the nearer wall as little as necessary.
//! `corridor` takes the cheapest sequence of clear axes in the coordinates of the machine, `xu` the greedy sequence;
//! `ruling` changes nothing. Layers have already made roughing lines clear. A pass without a clear axis is an error
//! that names the place.

use super::clear_axes::{ClearAxes, LEAST_TILT, StandingBall, is_steep};
use super::orient_tool::tilted_points;
use super::sequence::{self, Blocked, Gap};
use crate::analysis::flank::SIDE_CLEARANCE;
use crate::diag::{Aborted, Diag, codes::orientation};
use crate::ir::{CcOperation, CcPass, CcPlan, ClOperation, ClPlan, ClPoint, Drive, Operation, Program};
use crate::method::AxisMethod;
use crate::part::SurfaceKind;
use crate::passes::context::{AxisTilt, Obstacles, PassContext, remedy};
use nalgebra::Point3;
use rayon::prelude::*;

/// Tilt angles that are tried, degrees. A line keeps one tilt angle, so that its axes remain as smooth as the rulings.
pub(super) const TILTS: [f64; 14] = [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 24.0, 28.0, 32.0];

/// Station at which a pass is not clear, and by how much the tool is too near there, mm.
type Miss = (usize, f64);

/// Tells why the tool of an operation is too near to the part, where the operation itself knows.
pub(crate) type TooNear = fn(&PassContext<'_>, &Operation) -> Option<Diag>;

/// Makes axes collision-free, or reports where this is impossible: with the reason of the operation, where it has one.
///
/// # Errors
/// A pass whose shank or holder is nearer to the part than the clearance of the job.
pub(crate) fn run(cx: &mut PassContext<'_>, reason: TooNear, cc: &CcPlan, cl: &mut ClPlan) -> Result<(), Aborted> {
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
        let mut steepest = 0.0_f64;
        let mut blocked = Vec::new();
        for (index, tilt) in tilts.into_iter().enumerate() {
            match tilt {
                Ok(tilt) => {
                    steepest = steepest.max(tilt);
                    if tilts_away(operation, &planned.passes[index]) {
                        let tilt = AxisTilt::Away(tilt.to_radians());
                        oriented.passes[index].points = tilted_points(program, operation, &planned.passes[index], tilt);
                    }
                }
                Err(miss) => blocked.push((index, miss)),
            }
        }
        if !blocked.is_empty() {
            failed = true;
            let diag = reason(cx, operation).unwrap_or_else(|| too_near(cx, operation, (planned, oriented), &blocked));
            cx.sink.push(diag);
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
    matches!(cc.drive, Drive::Hub(_) | Drive::Contact(_) | Drive::Round(_)) && !along
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
        sequence::shortest(&clear, &program.machine, (passes, operation.kind.is_on_floor()), &work)
    };
    let (found, blocked) = match chosen {
        Ok(points) => (points, Vec::new()),
        Err(faults) => (Vec::new(), faults),
    };
    let tool = &program.tools[operation.tool];
    for (i, blocked) in &blocked {
        let label = oriented.passes.get(*i).map_or("", |p| p.label.as_str());
        let (label, place) = cx.in_first_sector(operation, label, blocked.at);
        cx.sink.push(
            no_sequence(&clear, (&operation.name, &tool.name), blocked)
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

/// The error of a pass whose sequence of clear axes ends.
fn no_sequence(clear: &ClearAxes<'_>, (operation, tool): (&str, &str), blocked: &Blocked) -> Diag {
    let reason = match blocked.why {
        Gap::NoAxis => {
            return clear.no_axis((operation, tool), &blocked.at, (&blocked.about, "the channel's direction"));
        }
        Gap::NearPole => {
            let least = LEAST_TILT.to_degrees();
            format!("are less than {least:.1} deg from Z, where the second rotary axis would turn through")
        }
        Gap::Apart => {
            let [turn, step] = [sequence::MOST_TURN.to_degrees(), sequence::STEP];
            format!("are more than {turn:.0} deg away from those {step} mm before")
        }
    };
    Diag::error(orientation::NO_AXIS, format!("`{operation}`: the axes here that keep {tool} clear of the part {reason}"))
        .help("use a slimmer tool or a longer reach, which leaves more clear axes; or other surfaces or `blades` for this tool")
}

/// The error of an operation: its worst place, and a tool that would clear all of its passes. For passes along the rulings
/// the cutter stays: the surface that they cut determines its size.
fn too_near(
    cx: &PassContext<'_>,
    operation: &Operation,
    (planned, oriented): (&CcOperation, &ClOperation),
    blocked: &[(usize, Miss)],
) -> Diag {
    let (program, obstacles) = (cx.program, cx.obstacles);
    let tool = &program.tools[operation.tool];
    let worst = blocked.iter().copied().reduce(|a, b| if b.1.1 > a.1.1 { b } else { a });
    let (index, (station, violation)) = worst.unwrap_or_default();
    let place = oriented.passes.get(index).and_then(|pass| Some((pass, pass.points.get(station)?.tip)));
    let (label, at) =
        place.map_or((String::new(), Point3::origin()), |(pass, tip)| cx.in_first_sector(operation, &pass.label, tip));
    let cutter_free = blocked.iter().all(|(k, _)| tilts_away(operation, &planned.passes[*k]));
    let help = remedy(&tool.solid, cutter_free, |solid| {
        let program = program.with_solid(operation.tool, solid);
        let clear = |k: usize| {
            clearing_tilt(&program, obstacles, operation, &planned.passes[k], &oriented.passes[k].points).is_ok()
        };
        blocked.par_iter().all(|(k, _)| clear(*k))
    });
    let help = if corridor_is_clear(cx, operation, oriented, blocked) {
        format!("`method corridor` finds a clear tool axis at these places; with `method blend`, {help}")
    } else {
        help
    };
    let diag = Diag::error(
        orientation::COLLISION,
        format!(
            "`{}`: {} is {violation:.2} mm too near to the part; required clearance of shank and holder {:.2} mm",
            operation.name,
            tool.name,
            program.clearance.get()
        ),
    )
    .label(operation.span, "in this operation")
    .label(tool.span, "with this tool")
    .place(label, at)
    .help(help);
    match blocked.len() {
        1 => diag,
        count => diag.note(format!("{count} of {} passes are too near; this is the worst place", planned.passes.len())),
    }
}

/// True where `method corridor` would find a clear axis at the worst place of each pass, and another method is chosen.
fn corridor_is_clear(
    cx: &PassContext<'_>,
    operation: &Operation,
    oriented: &ClOperation,
    blocked: &[(usize, Miss)],
) -> bool {
    let ball = cx.program.tools[operation.tool].solid.cutter.ends_in_ball();
    if operation.kind.axis_method() != Some(AxisMethod::Blend) || !ball {
        return false;
    }
    let clear = ClearAxes::new(cx.program, cx.obstacles, operation);
    blocked.par_iter().all(|(pass, (station, _))| {
        let point = oriented.passes.get(*pass).and_then(|pass| pass.points.get(*station));
        point.is_some_and(|p| {
            let ball = StandingBall::at(p, clear.radius());
            clear.candidates(&ball, &p.axis, sequence::MARGIN).iter().any(is_steep)
        })
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
    let on_vane = matches!(cc.drive, Drive::Contact(_) | Drive::Round(_));
    let violation = |p: &ClPoint| {
        let ball = solid.cutter.ends_in_ball();
        // A ball on an edge that the lathe makes: nothing of the part is near the side of the cutter.
        let edge = match cc.drive {
            Drive::Contact(SurfaceKind::InletEdge(blade)) => program.part.edge(blade, 0).is_none(),
            Drive::Contact(SurfaceKind::OutletEdge(blade)) => program.part.edge(blade, 1).is_none(),
            _ => false,
        };
        let beside = on_vane && !(ball && edge);
        let inside = if beside || matches!(cc.drive, Drive::HubWithLead(..)) {
            obstacles.cutter_inside(solid, &p.tip, &p.axis)
        } else {
            None
        };
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
