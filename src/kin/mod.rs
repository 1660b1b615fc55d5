//! Kinematics of table-table machines with axes A and C: C is carried by A, both carry the part; the tool is fixed
//! along machine +Z.
//!
//! Rotary angles are in radians and in the ISO sense: the word describes the tool relative to the part, the table
//! turns the other way. At (A, C) the tool axis in the part frame is (sin A sin C, -sin A cos C, cos A).

pub mod feedrate;
pub mod interpolation;
pub mod linuxcnc;
pub mod machine;
mod rates;
pub mod transform;

pub use interpolation::Interpolation;
pub use machine::{Carried, LinearAxis, Machine, RotaryAxis};
pub use transform::{Joints, Pose, inverse};
