//! Tilt of a tool against the rulings.

/// Tilt of the axes of channel finishing and point milling against the rulings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum AxisTilt {
    /// Outward as far as the pole of the rotary axes requires. In the channel also away from the nearer wall, by this
    /// angle at the wall; at a contact of a vane, off its face by this angle.
    Away(f64),
    /// No tilt.
    Along,
}
