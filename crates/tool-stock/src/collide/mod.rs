//! Distances between tool solids and part surfaces.

pub mod cloud;
mod contact;
pub mod cutter;
mod distance_table;
pub mod meridian;
mod revolved;
#[cfg(test)]
pub(crate) mod samples;
#[cfg(all(test, feature = "serde"))]
mod stored;
pub mod support;
pub mod tool;

pub use cloud::{Cloud, CloudPoint};
pub use contact::CutterCurvature;
pub use cutter::{Cutter, Kind};
pub use distance_table::DistanceTable;
pub use meridian::{Arc, Meridian, Slope};
pub use revolved::revolved;
pub use support::Body;
pub use tool::{Section, ToolSolid};
