//! Flank milling as an optimisation over the swept envelope: where the axis of a tool has to run, so that what it
//! sweeps comes nearest to points of a design surface. Pure mathematics in mm: knows nothing of jobs or parts.
//!
//! | step | file | what it makes least |
//! |---|---|---|
//! | least squares | `fit` | sum of squared faults |
//! | minimax | `minimax` | the largest fault |
//! | ease | `ease` | the motion of the rotary axes, with every fault kept within its bound |
//!
//! A fault is how far the deviation of the swept tool, not that of one ruling from one axis, leaves what a point allows.

mod band;
mod bend;
pub mod deviation;
pub mod ease;
pub mod fit;
pub mod measured;
pub mod minimax;
mod program;
mod step;
pub mod target;

pub use deviation::{Deviation, Mounted};
pub use ease::{Eased, ease};
pub use fit::least_squares;
pub use measured::Measured;
pub use minimax::{Best, Finest, finest, minimax};
pub use target::Target;
