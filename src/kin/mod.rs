//! Kinematics of five-axis machines: three linear axes and two rotary ones, of which each carries tool or part.
//!
//! Rotary angles are in radians and in the ISO sense: the word describes the tool relative to the part, a table turns the
//! other way. What the axes are called is known to machine files and to texts; here they are rotary axis 1, next to the
//! tool, and rotary axis 2, next to the part.

pub mod chain;
pub mod feedrate;
pub mod interpolation;
pub mod linuxcnc;
pub mod machine;
mod rates;
pub mod transform;

pub use chain::{Angles, AxisLine, Carries, Chain};
pub use interpolation::Interpolation;
pub use machine::{Carried, LinearAxis, Machine, RotaryAxis};
pub use transform::{Joints, Pose, RotaryPose, between, most_turn};
