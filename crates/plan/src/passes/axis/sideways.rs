//! The second angle of the tool axes of a pass: where no tilt away from the nearer wall is clear, all axes turn to one side.
//!
//! The ball of the tool stays where it is. Its axis turns towards the motion of the ball or against it, or square to the motion. Along
//! an edge the axis runs with the motion; there it turns round the edge.

use ir::ClPoint;
use nalgebra::{Point3, Vector3};

/// Least part of the motion that is square to the axis, everywhere on a pass that turns along the motion.
const MIN_SQUARE_MOTION: f64 = 0.15;

/// Least sine of the angle between axis and normal, everywhere on a pass that turns round an edge.
const MIN_EDGE_SINE: f64 = 0.3;

/// Half of the distance over which the direction of the motion is measured, as a share of the radius of the ball.
const HALF_STEP_SHARE: f64 = 0.25;

/// A side to which the axes of a pass turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TurnSide {
    /// Towards the motion; round an edge where the axis runs with the motion.
    Along,
    /// Square to the motion.
    Across,
}

/// Stations of a pass whose axes turn to a side by an angle, radians; the ball of this radius stays. `None` where a station has no
/// such side.
pub(super) fn turned(points: &[ClPoint], radius: f64, to: TurnSide, angle: f64) -> Option<Vec<ClPoint>> {
    let centres: Vec<Point3<f64>> = points.iter().map(|p| p.tip + p.axis * radius).collect();
    let along = along(points, &centres, radius);
    let sides = match to {
        TurnSide::Along => along.or_else(|| round(points, &centres))?,
        TurnSide::Across => along?.iter().zip(points).map(|(side, p)| p.axis.cross(side)).collect(),
    };
    let (sin, cos) = libm::sincos(angle);
    let turn = |((p, centre), side): ((&ClPoint, &Point3<f64>), &Vector3<f64>)| {
        let axis = (p.axis * cos + side * sin).normalize();
        ClPoint { tip: centre - axis * radius, axis, contact: p.contact }
    };
    Some(points.iter().zip(&centres).zip(&sides).map(turn).collect())
}

/// The direction of the motion square to the axis at each station.
fn along(points: &[ClPoint], centres: &[Point3<f64>], radius: f64) -> Option<Vec<Vector3<f64>>> {
    let is_far = |i: usize, k: usize| nalgebra::distance(&centres[i], &centres[k]) >= HALF_STEP_SHARE * radius;
    let last = centres.len().checked_sub(1)?;
    let side = |i: usize| {
        let before = (0..i).rev().find(|k| is_far(i, *k)).unwrap_or(0);
        let behind = (i + 1..=last).find(|k| is_far(i, *k)).unwrap_or(last);
        let motion = (centres[behind] - centres[before]).try_normalize(0.0)?;
        let square = motion - points[i].axis * motion.dot(&points[i].axis);
        if square.norm() >= MIN_SQUARE_MOTION { square.try_normalize(0.0) } else { None }
    };
    (0..=last).map(side).collect()
}

/// The direction square to axis and normal at each station.
fn round(points: &[ClPoint], centres: &[Point3<f64>]) -> Option<Vec<Vector3<f64>>> {
    let side = |(p, centre): (&ClPoint, &Point3<f64>)| {
        let side = (centre - p.contact?).try_normalize(0.0)?.cross(&p.axis);
        if side.norm() >= MIN_EDGE_SINE { side.try_normalize(0.0) } else { None }
    };
    points.iter().zip(centres).map(side).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pass(axis: Vector3<f64>) -> Vec<ClPoint> {
        let centre = |k: u32| Point3::new(0.3 * f64::from(k), 0.0, 0.0);
        let contact = |k: u32| Some(centre(k) - Vector3::new(0.0, 2.0, 0.0));
        (0..20).map(|k| ClPoint { tip: centre(k) - axis * 2.0, axis, contact: contact(k) }).collect()
    }

    /// The axis turns towards the motion by the whole angle; the centre of the ball stays.
    #[test]
    fn axes_turn_along_the_motion() {
        let points = pass(Vector3::z());
        let made = turned(&points, 2.0, TurnSide::Along, 0.3).unwrap();
        for (p, q) in points.iter().zip(&made) {
            assert!((q.axis - Vector3::new(libm::sin(0.3), 0.0, libm::cos(0.3))).norm() < 1e-12);
            assert!((p.tip + p.axis * 2.0 - (q.tip + q.axis * 2.0)).norm() < 1e-12);
        }
        let made = turned(&points, 2.0, TurnSide::Across, 0.3).unwrap();
        assert!(made.iter().all(|p| (p.axis - Vector3::new(0.0, libm::sin(0.3), libm::cos(0.3))).norm() < 1e-12));
    }

    /// Where the axis runs with the motion it turns square to the normal; without a contact there is no such side.
    #[test]
    fn axes_along_an_edge_turn_round_it() {
        let mut points = pass(Vector3::x());
        let made = turned(&points, 2.0, TurnSide::Along, -0.3).unwrap();
        assert!(made.iter().all(|p| (p.axis - Vector3::new(libm::cos(0.3), 0.0, libm::sin(0.3))).norm() < 1e-12));
        assert!(turned(&points, 2.0, TurnSide::Across, 0.3).is_none());
        points[7].contact = None;
        assert!(turned(&points, 2.0, TurnSide::Along, 0.3).is_none());
    }
}
