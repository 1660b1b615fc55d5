//! From the program to the motion. The order of the passes, with a reason a line, stands in [`pipeline`].
//!
//! A pass never reads what a later one makes. Steps between types (`plan`, `orient-tool`, `link-moves`) make a new
//! value; the others improve the one that they are given.
//!
//! | room | holds | uses |
//! |---|---|---|
//! | `context` | program, obstacles, coordinates of the channel, limits of size | |
//! | `lines` | lines of constant scallop on any surface | `context` |
//! | `rough`, `flank`, `point`, `channel` | one operation each: where passes run, how the tool stands on them | `lines`, `context` |
//! | `axis` | tool axes clear of the part, and smooth | the rooms of the operations |
//! | `sample_to_tolerance`, `copy_sectors` | stations that the machine needs; one sector to all | `context` |
//! | `link` | rest machining, the ways between passes, joints | `axis`, `context` |
//! | `feed` | feeds, times, exact stops | |

mod axis;
mod channel;
mod context;
mod copy_sectors;
mod feed;
mod link;
mod point;
mod rough;
mod sample_to_tolerance;

pub mod flank;
pub mod lines;
pub mod pipeline;

pub use context::Obstacles;
pub use link::rest_machining;
