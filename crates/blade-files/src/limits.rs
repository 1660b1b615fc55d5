//! Largest blade files that are read.

/// Most text of all files together, bytes. A point takes some 40 bytes, so this is more than [`POINTS`].
pub const BYTES: usize = 64 << 20;

/// Most text of a STEP file, bytes. Besides the faces that are picked it holds all others, curves on surfaces and names: our own
/// of a wheel with 15 blades and 15 splitters, without fillets, has 256 MB.
pub const STEP_BYTES: usize = 512 << 20;

/// Most points of all curves and sections together; they take 24 bytes each.
pub const POINTS: usize = 1_000_000;

/// Most points of a curve or section. Designers give 50 to 500.
pub const POINTS_OF_CURVE: usize = 10_000;

/// Most sections of a blade. Designers give 2 to 50.
pub const SECTIONS: usize = 500;

/// Most blades of a row: the main blade and its splitters.
pub const BLADES: usize = 9;

/// Most rows of a file.
pub const ROWS: usize = 100;

/// Most main blades round the axis.
pub const COUNT: u32 = 10_000;

/// Largest distance of a point from the origin, mm. Larger ones have a wrong unit.
pub const LENGTH: f64 = 100_000.0;

/// Most notes; of further ones only the last says that they exist.
pub const NOTES: usize = 1000;

/// Most lines of a BladeGen model that are not points; they take 50 bytes each.
pub const ENTRIES: usize = 100_000;

/// Most points of a curve in a job.
pub const POINTS_OF_JOB_CURVE: usize = 2000;

/// Most closed sections of a blade in a job.
pub const SECTIONS_OF_JOB: usize = 200;
