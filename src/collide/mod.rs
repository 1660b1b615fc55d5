//! Distances between tool solids and part surfaces. Knows nothing of jobs, IR or diagnostics.

pub mod cloud;
pub mod cutter;
mod revolved;
pub mod support;
pub mod tool;

pub use cloud::{Cloud, CloudPoint};
pub use cutter::{Cutter, Slope};
pub use revolved::revolved;
pub use support::Body;
pub use tool::{Section, ToolSolid};
