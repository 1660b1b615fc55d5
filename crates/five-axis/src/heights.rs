//! Largest heights of turned solids under all angles of rotary axes within their travel.

use nalgebra::{Point3, Rotation3, Unit, Vector3};
use std::f64::consts::{PI, TAU};

/// Largest step between two angles that are sampled, radians. A point 500 mm from the axis rises by at most 0.025 mm
/// between them; the result includes this amount.
const MAX_ANGLE_STEP: f64 = 0.02;

/// A rotary axis with the range of its angle, radians. Axes are given the innermost first.
pub(super) struct Swing {
    pub(super) direction: Unit<Vector3<f64>>,
    pub(super) point: Point3<f64>,
    pub(super) range: [f64; 2],
}

/// A circle about a parallel of Z, with all axes at zero: centre and radius, mm.
pub(super) type Ring = (Point3<f64>, f64);

/// Upper bound of the component along `up` of any point of the rings, under any angles; mm.
///
/// For fixed other angles the component of a point is a sinusoid of the angle. Its amplitude is at most the distance of
/// the point from the axis. Between two samples it therefore exceeds the larger one by at most
/// (1 - cos(step/2)) times this distance.
pub(super) fn farthest(swings: &[Swing], up: &Vector3<f64>, rings: &[Ring]) -> f64 {
    let Some((outer, inner)) = swings.split_last() else {
        let across = libm::hypot(up.x, up.y);
        return rings.iter().map(|(c, r)| up.dot(&c.coords) + r * across).fold(f64::NEG_INFINITY, f64::max);
    };
    let [low, high] = outer.range;
    let (low, width) = if high - low < TAU { (low, high - low) } else { (-PI, TAU) };
    let count = (width / MAX_ANGLE_STEP).ceil().max(1.0);
    let between = reach(swings, rings) * (1.0 - libm::cos(0.5 * width / count));
    let at = |k: usize| {
        let turn = Rotation3::from_axis_angle(&outer.direction, low + width * k as f64 / count);
        let own = turn.inverse() * up;
        farthest(inner, &own, rings) + (up - own).dot(&outer.point.coords)
    };
    (0..=count as usize).map(at).fold(f64::NEG_INFINITY, f64::max) + between
}

/// Upper bound of the distance of any point of the rings from the outermost axis, mm.
fn reach(swings: &[Swing], rings: &[Ring]) -> f64 {
    match swings {
        [] => 0.0,
        [axis] => rings.iter().map(|(c, r)| (c - axis.point).norm() + r).fold(0.0, f64::max),
        [.., before, outer] => reach(&swings[..swings.len() - 1], rings) + (before.point - outer.point).norm(),
    }
}
