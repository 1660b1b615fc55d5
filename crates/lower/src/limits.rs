//! Limits of the points of a part.

/// Largest coordinate, mm. No impeller is larger; beyond this value squares are no longer exact to a micrometre.
pub(super) const MAX_COORDINATE: f64 = 10_000.0;

/// Distance below which two data points count as one, mm: a tenth of the finest unit of drawings.
pub(super) const SAME_POINT: f64 = 1e-5;

/// Least distance of a curve from the axis of rotation, mm; on the axis a hub has no azimuth.
pub(super) const MIN_RADIUS: f64 = 0.1;
