//! Hub and shroud as points (r, z) from points in space.

use super::found::Found;
use super::repeated::ONE_POINT;
use base::source::Span;
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use nalgebra::Point3;

/// Range of angles from which a curve does not lie in one plane, rad. Files have five digits or more.
const PLANE: f64 = 1e-4;

/// Reduces points of a curve to (r, z). The angle about the axis says nothing of a surface of revolution; a note tells when
/// it varies.
pub(super) fn reduced(name: &str, points: &[Point3<f64>], at: Span, found: &mut Found) -> Result<Vec<[f64; 2]>, Diag> {
    let meridian: Vec<[f64; 2]> = points.iter().map(|p| [libm::hypot(p.x, p.y), p.z]).collect();
    let off_axis = points.iter().filter(|p| p.x != 0.0 || p.y != 0.0);
    let mut range: Option<[f64; 2]> = None;
    for angle in off_axis.map(|p| libm::atan2(p.y, p.x)) {
        // A curve that crosses the half plane opposite of X has its angles in the next turn.
        let before = range.map_or(angle, |r| r[1]);
        let turns = libm::round((before - angle) / std::f64::consts::TAU);
        let angle = angle + turns * std::f64::consts::TAU;
        let [low, high] = range.unwrap_or([angle; 2]);
        range = Some([low.min(angle), high.max(angle)]);
    }
    if let Some([low, high]) = range
        && high - low > PLANE
    {
        let [low, high] = [low, high].map(f64::to_degrees);
        found.note(
            at,
            format!("the angle of the {name} about the axis varies from {low:.3} to {high:.3} deg and is left out"),
        );
    }
    checked(name, meridian, at, found)
}

/// A meridian with at least two different points. Points that repeat the one before are left out.
pub(super) fn checked(
    name: &str,
    mut meridian: Vec<[f64; 2]>,
    at: Span,
    found: &mut Found,
) -> Result<Vec<[f64; 2]>, Diag> {
    let given = meridian.len();
    meridian.dedup_by(|b, a| libm::hypot(a[0] - b[0], a[1] - b[1]) <= ONE_POINT);
    if meridian.len() < 2 {
        let message = format!("the {name} has {} points: at least 2 are needed", meridian.len());
        return Err(Diag::error(codes::ENDS_EARLY, message)
            .label(at, "the last line")
            .help("a meridian is given as points from inlet to outlet; export the file again"));
    }
    if meridian.len() < given {
        found.note(
            at,
            format!("{} points of the {name} repeat the one before and are left out", given - meridian.len()),
        );
    }
    let [low, high] = meridian.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], p| [l.min(p[0]), h.max(p[0])]);
    found.note(
        at,
        format!(
            "{name}: {} points, r from {low:.3} to {high:.3} mm, taken to run from inlet to outlet",
            meridian.len()
        ),
    );
    Ok(meridian)
}
