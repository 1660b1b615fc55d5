//! `orient-tool`: tip and axis of every station.
//!
//! Before: contact or drive points of a sector. After: its cutter locations, stations where they were.

use super::chart::Chart;
use super::layers::Roughing;
use super::pipeline::PassContext;
use super::vane_axis::{VaneAxis, tip_at};
use crate::diag::Aborted;
use crate::geom::DualCurve;
use crate::ir::{
    CcOperation, CcPass, CcPlan, CcPoint, ClOperation, ClPass, ClPlan, ClPoint, Drive, Operation, OperationKind,
    Program,
};
use crate::method::{AxisMethod, Flank, FlankMethod};
use crate::part::{FaceId, Surface};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Makes cutter locations.
///
/// # Errors
/// None of its own; it passes on those of the roughing set-up.
pub(super) fn run(cx: &mut PassContext<'_>, cc: &CcPlan) -> Result<ClPlan, Aborted> {
    let mut plan = ClPlan::default();
    for operation in &cc.operations {
        plan.operations.push(orient_operation(cx, operation)?);
    }
    Ok(plan)
}

fn orient_operation(cx: &mut PassContext<'_>, cc: &CcOperation) -> Result<ClOperation, Aborted> {
    let program = cx.program;
    let operation = &program.operations[cc.operation];
    let roughing = if operation.kind.finishes() { None } else { Some(cx.roughing(operation)?) };
    let work = cx.progress.begin(format!("{}, tool axes", operation.name), cc.passes.len());
    let passes = cc
        .passes
        .par_iter()
        .map(|pass| ClPass {
            label: pass.label.clone(),
            sector: 0,
            points: match pass.drive {
                Drive::Channel => roughing.as_ref().map_or_else(Vec::new, |r| channel_points(r, pass)),
                Drive::Face { side, .. } => match &pass.path {
                    Some(path) => path_points(path, pass),
                    None => flank_points(program, operation, pass, side),
                },
                Drive::Hub | Drive::Contact(_) | Drive::Round => {
                    leaning_points(program, operation, pass, lean(operation))
                }
            },
        })
        .map(|pass| work.step(pass))
        .collect();
    Ok(ClOperation { operation: cc.operation, passes, moves: Vec::new(), notes: cc.notes.clone() })
}

/// Roughing: the tip is the drive point, the axis blends the rulings of both walls.
fn channel_points(roughing: &Roughing<'_>, pass: &CcPass) -> Vec<ClPoint> {
    let point = |p: &CcPoint| ClPoint { tip: p.position, axis: roughing.axis(p.u, p.v, p.w), contact: None };
    pass.points.iter().map(point).collect()
}

/// A pass that was found as a path of the axis: its stations at even parameters, with the leads, on which the tool
/// shifts without turning.
fn path_points(path: &DualCurve, pass: &CcPass) -> Vec<ClPoint> {
    let count = pass.points.len().saturating_sub(3).max(1) as f64;
    let [enters, on_path @ .., leaves] = pass.points.as_slice() else { return Vec::new() };
    let ends = [(enters, 0.0), (leaves, 1.0)].map(|(p, end)| ClPoint {
        tip: p.position,
        axis: path.at(end).axis,
        contact: None,
    });
    let stations = on_path.iter().enumerate().map(|(i, p)| {
        let at = path.at(i as f64 / count);
        let on_face = (0.0..=1.0).contains(&p.u);
        ClPoint { tip: at.lower, axis: at.axis, contact: on_face.then_some(p.position) }
    });
    std::iter::once(ends[0]).chain(stations).chain(std::iter::once(ends[1])).collect()
}

/// Flank: offsets of both ends of the band by the tool radius, joined (Wei 10 to 12), or the offset of its middle with
/// the axis along the ruling (Liu 1995). The first and the last station
/// lie on the lead, where the tool shifts along its path without turning.
fn flank_points(program: &Program, operation: &Operation, pass: &CcPass, side: FaceId) -> Vec<ClPoint> {
    let part = &program.part;
    let OperationKind::Flank { flank: Flank { method, .. }, .. } = operation.kind else { return Vec::new() };
    let radius = program.tools[operation.tool].solid.cutter.tip_radius();
    let face = part.face(side);
    let offset = |u: f64, v: f64| face.surface.point(u, v) + face.normal(u, v) * radius;
    let [first, on_face @ .., last] = pass.points.as_slice() else { return Vec::new() };
    let mut points: Vec<ClPoint> = on_face
        .iter()
        .map(|p| {
            let (low, axis) = if method == FlankMethod::OnePoint {
                let middle = 0.5 * (p.v + p.w);
                let axis = face.surface.ruling(p.u);
                let reach = face.surface.point(p.u, middle) - face.surface.point(p.u, p.v);
                (offset(p.u, middle) - reach, axis)
            } else {
                let (low, high) = (offset(p.u, p.v), offset(p.u, p.w));
                (low, (high - low).normalize())
            };
            ClPoint {
                tip: low - axis * radius,
                axis,
                contact: (0.0..=1.0).contains(&p.u).then_some(p.position),
            }
        })
        .collect();
    let [a, b, .., y, z] = points.as_slice() else { return points };
    let [ua, ub, uy, uz] = [0, 1, on_face.len() - 2, on_face.len() - 1].map(|i| on_face[i].u);
    let shifted = |from: &ClPoint, to: &ClPoint, share: f64| ClPoint {
        tip: to.tip + (to.tip - from.tip) * share,
        axis: to.axis,
        contact: None,
    };
    let enters = shifted(b, a, (ua - first.u) / (ub - ua));
    let leaves = shifted(y, z, (last.u - uz) / (uz - uy));
    points.insert(0, enters);
    points.push(leaves);
    points
}

/// How the axes of channel finishing and point milling stand to the rulings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lean {
    /// Outward as far as the pole of the rotary axes needs, and away from the nearer wall by an angle at the wall; at a
    /// contact of a vane by that angle off its face.
    Away(f64),
    /// Not at all.
    Along,
}

/// How axes stand before anything is avoided.
fn lean(operation: &Operation) -> Lean {
    match operation.kind {
        _ if operation.kind.axis_method() == Some(AxisMethod::Ruling) => Lean::Along,
        OperationKind::Point { .. } => Lean::Away(FIRST_TILT),
        _ => Lean::Away(0.0),
    }
}

/// Tilt off a face before anything is avoided, radians: the twist of a vane has some room behind it.
const FIRST_TILT: f64 = 0.25;

/// Stations of a pass whose axes lean by a lean.
pub(super) fn leaning_points(program: &Program, operation: &Operation, pass: &CcPass, lean: Lean) -> Vec<ClPoint> {
    match pass.drive {
        Drive::Contact(surface) => vane_points(program, operation, pass, |axes, p| axes.axis(surface, p.u, p.v, lean)),
        Drive::Round => vane_points(program, operation, pass, |axes, p| axes.round(p.w, p.u, p.v, lean)),
        _ => hub_points(program, operation, pass, lean),
    }
}

/// Point milling of a vane: the rounded part of the cutter stands on the contact.
fn vane_points(
    program: &Program,
    operation: &Operation,
    pass: &CcPass,
    axis: impl Fn(&VaneAxis<'_>, &CcPoint) -> Vector3<f64>,
) -> Vec<ClPoint> {
    let cutter = &program.tools[operation.tool].solid.cutter;
    let axes = VaneAxis::new(&program.part);
    let at = |p: &CcPoint| {
        let axis = axis(&axes, p);
        let tip = tip_at(cutter, &p.position, &p.normal, &axis)?;
        Some(ClPoint { tip, axis, contact: Some(p.position) })
    };
    pass.points.iter().filter_map(at).collect()
}

/// Channel finishing: the ball stands on the hub; the axis blends the rulings of both walls, and leans away from the
/// nearer wall by `lean` at the wall, less towards the middle.
fn hub_points(program: &Program, operation: &Operation, pass: &CcPass, lean: Lean) -> Vec<ClPoint> {
    let part = &program.part;
    let radius = program.tools[operation.tool].solid.cutter.tip_radius();
    let chart = Chart::new(part);
    pass.points
        .iter()
        .map(|p| {
            // On the leads the axis stays, so that the ball shifts straight along the tangent of the hub.
            let u = p.u.clamp(0.0, 1.0);
            let at = if u == p.u { p.position } else { edge(program, pass, u) };
            let axis = hub_axis(&chart, u, p.w, &at, lean);
            let centre = p.position + p.normal * radius;
            ClPoint { tip: centre - axis * radius, axis, contact: Some(p.position) }
        })
        .collect()
}

/// Contact of a pass at inlet or outlet.
fn edge(program: &Program, pass: &CcPass, u: f64) -> Point3<f64> {
    let found = pass.points.iter().find(|p| p.u == u);
    found.map_or_else(|| program.part.hub.point(u, 0.0), |p| p.position)
}

fn hub_axis(chart: &Chart<'_>, u: f64, w: f64, at: &Point3<f64>, lean: Lean) -> Vector3<f64> {
    let Lean::Away(lean) = lean else { return chart.ruling(u, w) };
    let ruling = chart.leaning(u, w, w);
    // Across the channel, from the first wall to the second: about Z, counter-clockwise.
    let across = Vector3::new(-at.y, at.x, 0.0).normalize();
    let across = (across - ruling * across.dot(&ruling)).normalize();
    (ruling + across * libm::tan(lean * (1.0 - 2.0 * w))).normalize()
}
