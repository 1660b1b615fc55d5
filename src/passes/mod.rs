//! From the program to the motion: one file a pass. The order, with a reason a line, stands in [`pipeline`].
//!
//! A pass never reads what a later one makes. Steps between types (`plan-*`, `orient-tool`, `solve-kinematics`) make
//! a new value; the others improve the one that they are given.

mod axis_room;
mod axis_way;
mod chart;
mod constant_scallop;
mod copy_sectors;
mod exact_stops;
mod flank_clearance;
mod flank_sweep;
mod layers;
mod obstacles;
mod spiral;
mod surface_lines;
mod vane_axis;
mod vane_ground;
mod way_out;

pub mod assign_feeds;
pub mod avoid_collision;
pub mod hop;
mod link_moves;
pub mod orient_tool;
pub mod pipeline;
pub mod plan_channel;
pub mod plan_expand;
pub mod plan_flank;
pub mod plan_groove;
pub mod plan_point;
pub mod rest_machining;
pub mod sample_to_tolerance;
pub mod scallop;
pub mod smooth_axis;
pub mod solve_kinematics;
pub mod step;
pub mod time_feeds;

pub use obstacles::Obstacles;
