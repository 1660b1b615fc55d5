//! Copies of a face about the axis: how many blades the wheel has.

use super::face::{EDGE_GAP_MM, EDGE_STEPS, StepFace};
use nalgebra::{Point3, Rotation3, Vector3};
use nurbs::angle::nearest_turn;
use std::f64::consts::TAU;

/// Ends and middles of the edges of a face: points that its copies have as well.
fn marks(face: &StepFace) -> Vec<Point3<f64>> {
    let edges = face.borders.iter().flatten();
    edges.flat_map(|edge| [edge.points.first(), edge.points.get(EDGE_STEPS / 2)]).flatten().copied().collect()
}

fn middle(marks: &[Point3<f64>]) -> Vector3<f64> {
    marks.iter().map(|p| p.coords).sum::<Vector3<f64>>() / marks.len().max(1) as f64
}

/// Number of copies of a face, itself included, that other faces of the file are: each turned about Z, all at equal
/// angles round it. `None` where there are none, or their angles are not equal.
pub(super) fn count(face: &StepFace, others: impl Iterator<Item = StepFace>) -> Option<u32> {
    let own = marks(face);
    let at = middle(&own);
    let mut angles = vec![0.0];
    for other in others {
        let theirs = marks(&other);
        let there = middle(&theirs);
        let same = theirs.len() == own.len()
            && (libm::hypot(there.x, there.y) - libm::hypot(at.x, at.y)).abs() < EDGE_GAP_MM
            && (there.z - at.z).abs() < EDGE_GAP_MM;
        if !same {
            continue;
        }
        let angle = libm::atan2(there.y, there.x) - libm::atan2(at.y, at.x);
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
        let has = |p: &Point3<f64>| theirs.iter().any(|q| nalgebra::distance(&(turn * p), q) < EDGE_GAP_MM);
        if own.iter().all(has) {
            angles.push(angle.rem_euclid(TAU));
        }
    }
    let pitch = TAU / angles.len() as f64;
    let far = EDGE_GAP_MM / libm::hypot(at.x, at.y).max(EDGE_GAP_MM);
    let mut places: Vec<f64> = angles.iter().map(|a| (a / pitch).round() * pitch).collect();
    let even = angles.iter().zip(&places).all(|(a, place)| nearest_turn(a - place, 0.0).abs() < far);
    places.iter_mut().for_each(|place| *place = place.rem_euclid(TAU));
    places.sort_by(f64::total_cmp);
    let different = places.windows(2).all(|pair| pair[1] - pair[0] > 0.5 * pitch);
    (angles.len() > 1 && even && different).then(|| u32::try_from(angles.len()).ok()).flatten()
}
