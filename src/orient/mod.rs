//! Choice of tool axes: the clear axes at a station as an elliptic cone, the best way through the stations of a pass in
//! the machine's axes, and a smooth curve inside the corridor of cones. Pure mathematics over a question "is this axis
//! clear"; knows nothing of jobs, IR or diagnostics.

pub mod corridor;
pub mod energy;
pub mod greedy;
pub mod inscribe;
pub mod way;

pub use corridor::{Corridor, Residual, Weights};
pub use energy::Energy;
pub use inscribe::inscribe;
pub use way::{Candidate, Costs};
