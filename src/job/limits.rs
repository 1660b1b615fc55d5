//! Least and largest sizes that job and library files may give: what machines do and tools are made in. A size that is
//! far below all others of a job leaves no digits for them.

/// Slowest feed, mm/min: a control runs no slower with three decimals in its F word, and a cut of a metre takes a week.
pub(super) const LEAST_FEED: f64 = 0.1;

/// Largest feed, mm/min; machines limit it further.
pub(super) const LARGEST_FEED: f64 = 1e5;

/// Slowest spindle, rpm.
pub(super) const LEAST_SPINDLE: f64 = 1.0;

/// Thinnest cutter, neck or shank, mm: end mills are made from 0.1 mm on.
pub(super) const LEAST_DIAMETER: f64 = 0.1;

/// Thickest cutter, mm.
pub(super) const LARGEST_DIAMETER: f64 = 500.0;

/// Least radius of a corner or a tip, mm: below it an edge is called sharp.
pub(super) const LEAST_CORNER: f64 = 0.01;

/// Least length of a section of a tool, mm.
pub(super) const LEAST_SECTION: f64 = 0.01;

/// Longest tool, mm.
pub(super) const LONGEST_TOOL: f64 = 1000.0;

/// Least half angle of a tapered cutter, rad: 0.1 deg; below it is a cylinder within its tolerance.
pub(super) const LEAST_ANGLE: f64 = 0.001_745;

/// Least fillet, mm, where there is one.
pub(super) const LEAST_FILLET: f64 = 0.01;
