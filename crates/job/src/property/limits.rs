//! Least and largest sizes in job and library files: sizes that machines and tools have. A size far below all other
//! sizes of a job would be lost in rounding.

use super::quantity::Dimension;
use super::{Form, Range};

/// Feeds, mm/min; machines limit them further. The F word of a control has three decimals, and a cut of a metre takes a week at
/// the slowest one.
pub(crate) const FEED: Range = Range::Between(0.1, 1e5);

/// Arcs of engagement that loops may have, rad. Below the first one the loops lie too near to each other; above the second one a
/// loop is no longer much less than a slot.
pub(crate) const ENGAGEMENT: Range = Range::Between(20f64.to_radians(), 120f64.to_radians());

/// Largest diameter of stock and clamping, and largest height, mm.
pub(crate) const LARGEST_SIZE: f64 = 10_000.0;

/// Heights of stock and clamping.
pub(crate) const HEIGHT: Form = Form::Quantity(Dimension::LENGTH, Range::Within(LARGEST_SIZE));

/// Diameters of the clamping.
pub(crate) const CLAMPING: Form = Form::Quantity(Dimension::LENGTH, Range::Between(0.1, LARGEST_SIZE));

/// Tolerances. Below 10 nm rounding errors of the interpolation matter; above 1 mm the value is not a tolerance.
pub(crate) const TOLERANCE: Form = Form::Quantity(Dimension::LENGTH, Range::Between(1e-5, 1.0));

/// Largest distance of fitted surfaces from what they are fitted to.
pub(crate) const FIT: Form = Form::Quantity(Dimension::LENGTH, Range::Between(1e-4, 1.0));

/// Slowest spindle, rpm.
pub(crate) const LEAST_SPINDLE: f64 = 1.0;

/// Diameters of cutter, neck and shank, mm: end mills are made from 0.1 mm on.
pub(crate) const DIAMETER: [f64; 2] = [0.1, 500.0];

/// Radii of a corner and of the tip of a barrel, mm: an edge below the least radius counts as sharp.
pub(crate) const CORNER: [f64; 2] = [0.01, 250.0];

/// Lengths along a tool, and the radius of a barrel, mm.
pub(crate) const LENGTH: [f64; 2] = [0.01, 1000.0];

/// Feeds per tooth, mm.
pub(crate) const CHIP: [f64; 2] = [1e-5, 100.0];

/// Removal rates of a tool, mm3/min.
pub(crate) const RATE: [f64; 2] = [1e-3, 1e8];

/// Powers of a spindle, kW.
pub(crate) const POWER: [f64; 2] = [0.01, 1000.0];

/// Half angles of tapered cutters, rad. Below 0.1 deg the cutter is a cylinder within its tolerance. A side steeper
/// than 45 deg to the axis would be a point mill, which the contact search does not support.
pub(crate) const TAPER: [f64; 2] = [0.1f64.to_radians(), 45f64.to_radians()];

/// Angles at which a tool may go down while it moves sideways, rad: from 0.1 deg, since paths keep their tolerance only, to
/// straight down.
pub(crate) const RAMP: [f64; 2] = [0.1f64.to_radians(), 90f64.to_radians()];

/// Numbers of flutes.
pub(crate) const FLUTES: [u32; 2] = [1, 20];

/// Least fillet radius, mm, where there is a fillet.
pub(crate) const LEAST_FILLET: f64 = 0.01;

/// Largest fillet radius, mm.
pub(crate) const LARGEST_FILLET: f64 = 1000.0;

/// Steps of block numbers; 0 is none.
pub(crate) const BLOCK_NUMBERS: [u32; 2] = [0, 1000];

/// Program numbers of controls that call programs by number.
pub(crate) const PROGRAM_NUMBERS: [u32; 2] = [1, 99_999_999];

/// Orientation tolerances, rad.
pub(crate) const TURN: [f64; 2] = [1e-4f64.to_radians(), 0.1f64.to_radians()];

/// Least step down, mm: thinner chips are dust.
pub(crate) const LEAST_DEPTH: f64 = 0.01;

/// Heights of the levels of point milling, mm.
pub(crate) const LEVEL_HEIGHT: [f64; 2] = [LEAST_DEPTH, 1000.0];

/// Stock that rest machining cuts, mm. The ends of the stock are known to a micrometre and paths to their tolerances; stock above
/// the upper limit does not count as a rest.
pub(crate) const REST: [f64; 2] = [0.02, 10.0];

/// Distances of neighbouring strokes of plunging, as shares of the diameter: closer ones are a cut with the side of the tool.
pub(crate) const STROKE_STEP: [f64; 2] = [0.01, 0.5];

/// Most strips of a face by minimax, where the error falls with the cube of their height and each strip takes about a second; and
/// with the other methods.
pub(crate) const MAX_STRIPS: [u32; 2] = [20, 100];

/// Least residual of roughing, mm.
pub(crate) const LEAST_RESIDUAL: f64 = 0.001;

/// Least scallop height, mm: a tenth of a micrometre is below the roughness of any milled surface.
pub(crate) const LEAST_SCALLOP: f64 = 1e-4;
