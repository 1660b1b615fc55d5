//! Flank milling as an optimisation over the swept envelope: finds the path of the tool axis for which the swept tool
//! is nearest to points of a design surface. Pure mathematics in mm, independent of jobs and parts.
//!
//! | step | file | minimises |
//! |---|---|---|
//! | least squares | `fit` | sum of squared violations |
//! | minimax | `minimax` | the largest violation |
//! | ease | `ease` | the motion of the rotary axes, while each violation stays within its bound |
//!
//! A violation is the amount by which a deviation of the swept tool exceeds the bounds of a point. The deviation is
//! that of the whole sweep, not that of one ruling from one axis.

pub mod deviation;
pub mod ease;
pub mod fit;
pub mod measured;
pub mod minimax;
mod second_derivative;
mod step;
pub mod target;

pub use deviation::{Deviation, Mounted};
pub use ease::{Eased, ease};
pub use fit::{best_least_squares, least_squares};
pub use measured::Measured;
pub use minimax::{Best, Finest, finest, minimax};
pub use target::Target;
