//! Tip and axis at the stations of a pass along the floor.

use super::lead;
use crate::passes::context::{AxisTilt, ChannelChart};
use ir::{CcPass, CcPoint, ClPoint, Drive, Operation, Program};
use nalgebra::{Point3, Vector3};
use wheel::part::PassageId;

/// Channel finishing: the tool stands on the hub. The axis of a ball blends the rulings of both walls, and tilts away from
/// the nearer wall: by `tilt` at the wall, less towards the middle. That of a bull nose has its lead.
pub(crate) fn hub_points(
    program: &Program,
    operation: &Operation,
    pass: &CcPass,
    tilt: impl Fn(usize) -> AxisTilt,
) -> Vec<ClPoint> {
    let part = &program.part;
    let cutter = &program.tools[operation.tool].solid.cutter;
    let passage = match pass.drive {
        Drive::Hub(passage) | Drive::HubWithLead(passage, _) => passage,
        Drive::Channel | Drive::Face { .. } | Drive::Contact(_) | Drive::Round(_) => PassageId::FIRST,
    };
    let chart = ChannelChart::new(part, passage);
    let at = |(i, p): (usize, &CcPoint)| {
        // On the leads the axis is constant, so that the tool moves straight along the tangent of the hub.
        let u = p.u.clamp(0.0, 1.0);
        let at = if u == p.u { p.position } else { edge(program, pass, u) };
        let axis = match pass.drive {
            Drive::HubWithLead(_, angle) => lead::axis(&chart, u, p.w, libm::atan2(at.y, at.x), angle),
            Drive::Channel | Drive::Face { .. } | Drive::Hub(_) | Drive::Contact(_) | Drive::Round(_) => {
                hub_axis(&chart, u, p.w, &at, tilt(i))
            }
        };
        let tip = cutter.tip_at(&p.position, &p.normal, &axis)?;
        Some(ClPoint { tip, axis, contact: Some(p.position) })
    };
    pass.points.iter().enumerate().filter_map(at).collect()
}

/// Contact of a pass at inlet or outlet.
fn edge(program: &Program, pass: &CcPass, u: f64) -> Point3<f64> {
    let found = pass.points.iter().find(|p| p.u == u);
    found.map_or_else(|| program.part.hub.point(u, 0.0), |p| p.position)
}

fn hub_axis(chart: &ChannelChart<'_>, u: f64, w: f64, at: &Point3<f64>, tilt: AxisTilt) -> Vector3<f64> {
    let AxisTilt::Away(tilt) = tilt else { return chart.ruling(u, w) };
    let ruling = chart.tilted_ruling(u, w, w);
    // Across the channel, from the first wall to the second: about Z, counter-clockwise.
    let across = Vector3::new(-at.y, at.x, 0.0).normalize();
    let across = (across - ruling * across.dot(&ruling)).normalize();
    (ruling + across * libm::tan(tilt * (1.0 - 2.0 * w))).normalize()
}
