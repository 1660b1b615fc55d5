//! Finishing of the channel floor.

mod axes;
pub(crate) mod plan;

pub(crate) use axes::hub_points;
