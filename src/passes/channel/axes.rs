//! Tip and axis at the stations of a pass along the floor.

use crate::ir::{CcPass, ClPoint, Operation, Program};
use crate::passes::context::{AxisTilt, ChannelChart};
use nalgebra::{Point3, Vector3};

/// Channel finishing: the ball stands on the hub. The axis blends the rulings of both walls, and tilts away from the
/// nearer wall: by `tilt` at the wall, less towards the middle.
pub(crate) fn hub_points(program: &Program, operation: &Operation, pass: &CcPass, tilt: AxisTilt) -> Vec<ClPoint> {
    let part = &program.part;
    let radius = program.tools[operation.tool].solid.cutter.tip_radius();
    let chart = ChannelChart::new(part);
    pass.points
        .iter()
        .map(|p| {
            // On the leads the axis is constant, so that the ball moves straight along the tangent of the hub.
            let u = p.u.clamp(0.0, 1.0);
            let at = if u == p.u { p.position } else { edge(program, pass, u) };
            let axis = hub_axis(&chart, u, p.w, &at, tilt);
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

fn hub_axis(chart: &ChannelChart<'_>, u: f64, w: f64, at: &Point3<f64>, tilt: AxisTilt) -> Vector3<f64> {
    let AxisTilt::Away(tilt) = tilt else { return chart.ruling(u, w) };
    let ruling = chart.tilted_ruling(u, w, w);
    // Across the channel, from the first wall to the second: about Z, counter-clockwise.
    let across = Vector3::new(-at.y, at.x, 0.0).normalize();
    let across = (across - ruling * across.dot(&ruling)).normalize();
    (ruling + across * libm::tan(tilt * (1.0 - 2.0 * w))).normalize()
}
