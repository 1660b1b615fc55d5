//! Choice of tool axes: an elliptic cone of clear axes at a station, the cheapest sequence of axes along a pass in the
//! coordinates of the machine, and a smooth curve inside the corridor of cones. Pure mathematics over the query "is
//! this axis clear"; independent of jobs, IR and diagnostics.

pub mod corridor;
pub mod energy;
pub mod greedy;
pub mod inscribe;
pub mod way;

pub use corridor::{Corridor, Residual, Weights};
pub use energy::Energy;
pub use inscribe::inscribe;
pub use way::{AxisCandidate, Costs};
