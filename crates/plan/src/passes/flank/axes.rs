//! Tip and axis at the stations of a flank pass.

use ir::{CcPass, ClPoint, Operation, OperationKind, Program};
use nurbs::DualCurve;
use wheel::method::{Flank, FlankMethod};
use wheel::part::{FaceId, Surface};

/// Stations of a pass whose axis path was optimised: at equal parameters of the path, and the ends of the leads, on
/// which the tool moves without turning.
pub(crate) fn path_points(path: &DualCurve, pass: &CcPass) -> Vec<ClPoint> {
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

/// Flank: offsets of both edges of the strip by the tool radius, joined (Wei 10 to 12), or the offset of its middle
/// with the axis along the ruling (Liu 1995). The first and the last station lie on the leads, where the tool moves
/// along its path without turning.
pub(crate) fn flank_points(program: &Program, operation: &Operation, pass: &CcPass, side: FaceId) -> Vec<ClPoint> {
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
            ClPoint { tip: low - axis * radius, axis, contact: (0.0..=1.0).contains(&p.u).then_some(p.position) }
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
