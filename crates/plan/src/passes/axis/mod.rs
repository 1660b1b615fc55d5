//! Tool axes: from the operations, then collision-free, then smooth.

pub(crate) mod avoid_collision;
mod clear_axes;
pub(crate) mod clear_floor;
pub(crate) mod orient_tool;
mod other_tools;
pub(crate) mod run;
mod sequence;
mod sideways;
pub(crate) mod smooth_axis;
mod varied_tilt;
