//! Tilt of a tool against the rulings, and against the axis of the part.

use nalgebra::Vector3;

/// Reserve of the travel of rotary axis 1, radians: smooth axes go a little beyond the places that were checked, by 0.12 deg at most of
/// what was measured.
pub(crate) const TILT_RESERVE: f64 = 5e-3;

/// A unit axis whose angle to Z is at most `most`, radians: over it, the nearest one at the same azimuth.
pub(crate) fn within_tilt(axis: Vector3<f64>, most: f64) -> Vector3<f64> {
    let level = libm::hypot(axis.x, axis.y);
    if level == 0.0 || libm::atan2(level, axis.z) <= most {
        return axis;
    }
    let (sin, cos) = libm::sincos(most);
    Vector3::new(axis.x / level * sin, axis.y / level * sin, cos)
}

/// Tilt of the axes of channel finishing and point milling against the rulings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum AxisTilt {
    /// Outward as far as the pole of the rotary axes requires. In the channel also away from the nearer wall, by this
    /// angle at the wall; at a contact of a vane, off its face by this angle.
    Away(f64),
    /// No tilt.
    Along,
}
