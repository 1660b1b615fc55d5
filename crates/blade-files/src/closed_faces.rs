//! Sections that are given by their faces and are closed all the same: the faces meet at their ends.

use super::ImportedBlade;
use blade::outline::Side;
use blade::{Section, SectionForm};
use nalgebra::{Point2, Point3};
use nurbs::chords;

/// Faces meet where their ends are nearer than this share of their length. Files have six digits or more.
const SAME_END_SHARE: f64 = 1e-5;

/// An end where faces do not meet is cut off where the gap is at most this share of their length.
const CUT: f64 = 0.1;

/// Gives a blade its sections as loops, and the side of its pressure face, where the faces of all sections meet at the leading edge and
/// meet or are cut off at the trailing edge. Faces alone hold no rounded edges, and a part of faces is ruled from the first to the
/// last section. Returns whether it did.
pub(super) fn as_loops(blade: &mut ImportedBlade) -> bool {
    let Some(closed) = blade.sections.iter().map(closed).collect::<Option<Vec<_>>>() else { return false };
    // Positive where the pressure face is ahead by the angle about the axis.
    let ahead: f64 = closed.iter().map(|(_, ahead)| ahead).sum();
    if closed.is_empty() || ahead == 0.0 {
        return false;
    }
    blade.pressure = Some(if ahead > 0.0 { Side::Greater } else { Side::Smaller });
    for (section, (points, _)) in blade.sections.iter_mut().zip(closed) {
        section.form = SectionForm::Loop(points);
    }
    true
}

/// The loop of a section, and how far its pressure face is ahead of the suction face.
fn closed(section: &Section) -> Option<(Vec<Point3<f64>>, f64)> {
    let SectionForm::Faces([pressure, suction]) = &section.form else { return None };
    let length: f64 = pressure.windows(2).map(|w| nalgebra::distance(&w[0], &w[1])).sum();
    let gap = |a: Option<&Point3<f64>>, b: Option<&Point3<f64>>| Some(nalgebra::distance(a?, b?));
    let [leading, trailing] = [gap(pressure.first(), suction.first())?, gap(pressure.last(), suction.last())?];
    if leading > SAME_END_SHARE * length || trailing > CUT * length {
        return None;
    }
    let same = usize::from(trailing <= SAME_END_SHARE * length);
    let back = suction.iter().skip(1).rev().skip(same);
    let points: Vec<Point3<f64>> = pressure.iter().chain(back).copied().collect();
    let middle = &pressure[pressure.len() / 4..pressure.len() - pressure.len() / 4];
    let flat: Vec<Point2<f64>> = suction.iter().map(in_meridian_plane).collect();
    Some((points, middle.iter().filter_map(|p| ahead(p, suction, &flat)).sum()))
}

/// The angle about the axis, rad, by which a point is ahead of a face, at the place of the face with its radius and height. `flat` has
/// the points of the face in the meridian plane.
fn ahead(p: &Point3<f64>, face: &[Point3<f64>], flat: &[Point2<f64>]) -> Option<f64> {
    let near = chords::nearest(&in_meridian_plane(p), flat)?;
    let (a, b) = (face.get(near.chord)?, face.get(near.chord + 1)?);
    let foot = a + (b - a) * near.share;
    Some(libm::atan2(foot.x * p.y - foot.y * p.x, foot.x * p.x + foot.y * p.y))
}

fn in_meridian_plane(p: &Point3<f64>) -> Point2<f64> {
    Point2::new(libm::hypot(p.x, p.y), p.z)
}
