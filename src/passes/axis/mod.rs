//! Tool axes: from the operations, then collision-free, then smooth.

pub(crate) mod avoid_collision;
pub(crate) mod orient_tool;
mod room;
pub(crate) mod run;
pub(crate) mod smooth_axis;
mod way;
mod way_out;
