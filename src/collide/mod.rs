//! Distances between tool solids and part surfaces. Knows nothing of jobs, IR or diagnostics.

pub mod tool;

pub use tool::{Cutter, Section, ToolSolid};
