//! Flank milling: strips of the faces for the side of the cutter.

mod axes;
mod clearance;
pub mod plan;
mod refusals;
pub mod strip;
mod sweep;

pub(crate) use axes::{flank_points, path_points};
