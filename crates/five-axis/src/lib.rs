//! Kinematics of five-axis machines: the front page is the README.
#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

mod carried;
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
#[cfg(feature = "serde")]
mod unlimited;

pub use carried::{Carried, CarriedKind};
pub use chain::{Angles, AxisLine, Carries, Chain};
pub use interpolation::Interpolation;
pub use machine::{LinearAxis, Machine, RotaryAxis};
pub use pose_curve::{CurveDirection, PoseCurve, TurnCurve};
pub use transform::{Joints, Pose, RotaryPose, between, most_turn};
