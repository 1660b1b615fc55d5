//! Kinematics of five-axis machines: three linear and two rotary axes, each of which carries tool or part.
//!
//! Rotary angles are in radians and in the ISO sense: the angle describes the tool relative to the part, and a table
//! turns the other way. Only machine files and texts know the letters of the axes; here they are rotary axis 1, next to
//! the tool, and rotary axis 2, next to the part.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub mod chain;
pub mod control;
pub mod feedrate;
mod heights;
pub mod interpolation;
pub mod linuxcnc;
pub mod machine;
pub mod pose_curve;
mod rates;
pub mod transform;

pub use chain::{Angles, AxisLine, Carries, Chain};
pub use interpolation::Interpolation;
pub use machine::{Carried, LinearAxis, Machine, RotaryAxis};
pub use pose_curve::{CurveDirection, PoseCurve, TurnCurve};
pub use transform::{Joints, Pose, RotaryPose, between, most_turn};
