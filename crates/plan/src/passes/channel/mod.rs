//! Finishing of the channel floor.

mod axes;
mod finished;
mod floor;
mod lead;
pub(crate) mod middle;
pub(crate) mod plan;

pub(crate) use axes::hub_points;
