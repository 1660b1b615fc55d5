//! Faces of a section that is given as a mean line with thicknesses.

use super::stream::near;
use super::{MeanPoint, ThicknessDirection};
use nalgebra::Point3;

/// The faces at the greater and at the smaller angle about the axis, mm, in the order of the mean line. Half of the
/// thickness is laid to each side on the stream surface: along the meridian and round the axis, so that the surface is left
/// by second order only.
///
/// # Errors
/// The index of a point without direction.
pub(super) fn sides(points: &[MeanPoint], direction: ThicknessDirection) -> Result<[Vec<Point3<f64>>; 2], usize> {
    let mut before = None;
    let line: Vec<[f64; 3]> = points
        .iter()
        .map(|p| {
            let angle = near(libm::atan2(p.position.y, p.position.x), before);
            before = Some(angle);
            [libm::hypot(p.position.x, p.position.y), angle, p.position.z]
        })
        .collect();
    let mut sides = [Vec::new(), Vec::new()];
    for (k, point) in points.iter().enumerate() {
        let [r, theta, z] = line[k];
        let [a, b] = [line[k.saturating_sub(1)], line[(k + 1).min(points.len() - 1)]];
        // Along the meridian and round the axis.
        let [dr, dz, arc] = [b[0] - a[0], b[2] - a[2], r * (b[1] - a[1])];
        let dm = libm::hypot(dr, dz);
        let step = libm::hypot(dm, arc);
        let half = 0.5 * point.thickness;
        if !(r > 0.0 && step > 0.0 && half.is_finite()) || (direction == ThicknessDirection::Normal && dm == 0.0) {
            return Err(k);
        }
        for (side, sign) in sides.iter_mut().zip([1.0, -1.0]) {
            let (along, round) = match direction {
                ThicknessDirection::Tangential => (0.0, sign * half),
                ThicknessDirection::Normal => (-sign * half * arc / step, sign * half * dm / step),
            };
            let share = if dm > 0.0 { along / dm } else { 0.0 };
            let angle = theta + round / r;
            let (sin, cos) = libm::sincos(angle);
            let radius = r + share * dr;
            side.push(Point3::new(radius * cos, radius * sin, z + share * dz));
        }
    }
    Ok(sides)
}
