//! How a tool leans.

/// How the axes of channel finishing and point milling stand to the rulings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Lean {
    /// Outward as far as the pole of the rotary axes needs, and away from the nearer wall by an angle at the wall; at a
    /// contact of a vane by that angle off its face.
    Away(f64),
    /// Not at all.
    Along,
}
