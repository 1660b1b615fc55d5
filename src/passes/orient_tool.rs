//! `orient-tool`: tip and axis of every station.
//!
//! Before: contact or drive points. After: cutter locations, stations where they were.

use super::chart::Chart;
use super::layers::Roughing;
use super::pipeline::PassContext;
use crate::diag::Aborted;
use crate::ir::{CcOperation, CcPass, CcPlan, ClOperation, ClPass, ClPlan, ClPoint, Drive, Operation, Program, Side};
use nalgebra::{Point3, Rotation3, Vector3};
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
    let passes = cc
        .passes
        .par_iter()
        .map(|pass| ClPass {
            label: pass.label.clone(),
            sector: pass.sector,
            points: match pass.drive {
                Drive::Channel => roughing.as_ref().map_or_else(Vec::new, |r| channel_points(program, r, pass)),
                Drive::Face { side, .. } => flank_points(program, operation, pass, side),
                Drive::Hub => hub_points(program, operation, pass, 0.0),
            },
        })
        .collect();
    Ok(ClOperation { operation: cc.operation, passes, moves: Vec::new(), notes: cc.notes.clone() })
}

/// Roughing: the tip is the drive point, the axis blends the rulings of both walls.
fn channel_points(program: &Program, roughing: &Roughing<'_>, pass: &CcPass) -> Vec<ClPoint> {
    let turn = program.part.sector_rotation(pass.sector);
    pass.points
        .iter()
        .map(|p| ClPoint { tip: p.position, axis: turn * roughing.axis(p.u, p.v, p.w), contact: None })
        .collect()
}

/// Flank: offsets of both ends of the band by the tool radius, joined (Wei 10 to 12). Beyond inlet and outlet both
/// offset curves go on along their tangents up to the next station; from there the tool shifts without turning, since
/// the tangents of the two curves part.
fn flank_points(program: &Program, operation: &Operation, pass: &CcPass, side: Side) -> Vec<ClPoint> {
    let part = &program.part;
    let turn = part.sector_rotation(pass.sector);
    let radius = program.tools[operation.tool].solid.cutter.tip_radius();
    let face = part.face(side);
    let offset = |u: f64, v: f64| face.surface.point(u, v) + face.normal(u, v) * radius;
    let inside: Vec<(f64, [Point3<f64>; 2])> = pass
        .points
        .iter()
        .filter(|p| (0.0..=1.0).contains(&p.u))
        .map(|p| (p.u, [offset(p.u, p.v), offset(p.u, p.w)]))
        .collect();
    let [Some(start), Some(end)] = [tangent(&inside, 0, 1), tangent(&inside, inside.len() - 1, inside.len() - 2)]
    else {
        return Vec::new();
    };
    let outside = |before: bool| {
        let mut us = pass.points.iter().map(|p| p.u).filter(|u| if before { *u < 0.0 } else { *u > 1.0 });
        if before { us.next_back() } else { us.next() }
    };
    let (enters, leaves) = (outside(true).unwrap_or(0.0), outside(false).unwrap_or(1.0));
    let mut guides = inside.iter();
    pass.points
        .iter()
        .filter_map(|p| {
            let [low, high] = if p.u < 0.0 {
                along(&start, p.u, enters)
            } else if p.u > 1.0 {
                along(&end, p.u, leaves)
            } else {
                guides.next()?.1
            };
            let axis = (high - low).normalize();
            Some(ClPoint {
                tip: turn * (low - axis * radius),
                axis: turn * axis,
                contact: (0.0..=1.0).contains(&p.u).then_some(p.position),
            })
        })
        .collect()
}

/// End of both guides with their derivatives by u.
type GuideEnd = (f64, [(Point3<f64>, Vector3<f64>); 2]);

/// Tangents at an end from its neighbour, which lies a few hundredths of the curve's radius away.
fn tangent(guides: &[(f64, [Point3<f64>; 2])], end: usize, next: usize) -> Option<GuideEnd> {
    let (e, n) = (guides.get(end)?, guides.get(next)?);
    let slope = |k: usize| (e.1[k], (n.1[k] - e.1[k]) / (n.0 - e.0));
    Some((e.0, [slope(0), slope(1)]))
}

/// Both guides at u, turning up to `turns_until` and shifting along the lower one from there.
fn along(end: &GuideEnd, u: f64, turns_until: f64) -> [Point3<f64>; 2] {
    let turned = if u < end.0 { u.max(turns_until) } else { u.min(turns_until) };
    let shift = end.1[0].1 * (u - turned);
    end.1.map(|(p, d)| p + d * (turned - end.0) + shift)
}

/// Channel finishing: the ball stands on the hub; the axis blends the rulings of both walls, and leans away from the
/// nearer wall by `lean` at the wall, less towards the middle.
pub(super) fn hub_points(program: &Program, operation: &Operation, pass: &CcPass, lean: f64) -> Vec<ClPoint> {
    let part = &program.part;
    let turn = part.sector_rotation(pass.sector);
    let radius = program.tools[operation.tool].solid.cutter.tip_radius();
    let chart = Chart::new(part);
    pass.points
        .iter()
        .map(|p| {
            let axis = hub_axis(&chart, &turn, p.u, p.w, &p.position, lean);
            let centre = p.position + p.normal * radius;
            ClPoint { tip: centre - axis * radius, axis, contact: Some(p.position) }
        })
        .collect()
}

fn hub_axis(chart: &Chart<'_>, turn: &Rotation3<f64>, u: f64, w: f64, at: &Point3<f64>, lean: f64) -> Vector3<f64> {
    let ruling = turn * chart.leaning(u, w, w);
    // Across the channel, from the first wall to the second: about Z, counter-clockwise.
    let across = Vector3::new(-at.y, at.x, 0.0).normalize();
    let across = (across - ruling * across.dot(&ruling)).normalize();
    (ruling + across * (lean * (1.0 - 2.0 * w)).tan()).normalize()
}
