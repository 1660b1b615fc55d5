//! Least and largest sizes that job and library files may give: what machines do and tools are made in. A size that is
//! far below all others of a job leaves no digits for them.

/// Slowest feed, mm/min: a control runs no slower with three decimals in its F word, and a cut of a metre takes a week.
pub(super) const LEAST_FEED: f64 = 0.1;

/// Largest feed, mm/min; machines limit it further.
pub(super) const LARGEST_FEED: f64 = 1e5;

/// Slowest spindle, rpm.
pub(super) const LEAST_SPINDLE: f64 = 1.0;

/// Diameters of cutter, neck and shank, mm: end mills are made from 0.1 mm on.
pub(super) const DIAMETER: [f64; 2] = [0.1, 500.0];

/// Radii of a corner and of the tip of a barrel, mm: below the least an edge is called sharp.
pub(super) const CORNER: [f64; 2] = [0.01, 250.0];

/// Lengths along a tool, and the radius of a barrel, mm.
pub(super) const LENGTH: [f64; 2] = [0.01, 1000.0];

/// Half angles of tapered cutters, rad. Below 0.1 deg the cutter is a cylinder within its tolerance. Steeper than 45 deg to
/// the axis the side would be a point mill, which the contact search does not know.
pub(super) const TAPER: [f64; 2] = [0.001_745, 0.785];

/// Numbers of flutes.
pub(super) const FLUTES: [u32; 2] = [1, 20];

/// Least fillet, mm, where there is one.
pub(super) const LEAST_FILLET: f64 = 0.01;
