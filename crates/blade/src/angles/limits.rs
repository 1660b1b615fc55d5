//! What blades by angles and thicknesses may have, in the language and in files.

/// Most values along a curve. Designers give 2 to 10, files some 60.
pub const VALUES: usize = 200;

/// Most spans of a blade. Designers give 2 to 11.
pub const MAX_SPANS: usize = 30;

/// Least step from one share to the next.
pub const MIN_SHARE_STEP: f64 = 1e-4;

/// Half axes of an elliptic edge along the camber line, as a multiple of half the thickness: flatter edges are cut off, longer
/// ones are part of the thickness.
pub const RATIOS: [f64; 2] = [0.5, 10.0];

/// Thinnest and thickest blade, mm.
pub const THICKNESSES: [f64; 2] = [0.001, 1000.0];

/// Largest distance of the ends of a meridional edge from hub and shroud, mm.
pub const OFF_ENDS: f64 = 0.05;

/// Least length of a blade along hub and shroud, mm.
pub const LEAST_LENGTH: f64 = 0.1;
