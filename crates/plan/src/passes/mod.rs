//! From the program to the motion. [`pipeline`] holds the order of the passes and the reasons for it.
//!
//! A pass never reads what a later pass makes. Passes between types (`plan`, `orient-tool`, `link-moves`) make a new
//! value; the others change the value that they receive.
//!
//! | module | holds | uses |
//! |---|---|---|
//! | `context` | program, obstacles, coordinates of the channel, limits of size, tools that would be clear | |
//! | `lines` | lines of constant scallop on any surface | `context` |
//! | `rough`, `flank`, `point`, `channel` | one operation each: its lines and its tool axes | `lines`, `context` |
//! | `axis` | collision-free and smooth tool axes | the modules of the operations |
//! | `sample_to_tolerance`, `copy_sectors` | stations that the machine needs; one sector to all | `context` |
//! | `link` | rest machining, links between passes, joints | `axis`, `context` |
//! | `feed` | feeds, times, exact stops | |

mod axis;
mod channel;
mod context;
mod copy_sectors;
mod feed;
mod fit_splines;
mod link;
mod point;
mod rough;
mod round_to_words;
mod sample_to_tolerance;

pub mod flank;
pub mod lines;
pub mod pipeline;

pub use context::{MotionBound, Obstacles};
pub use link::rest_machining;
