//! Rest machining, links between passes, and the joints of all moves.

mod blank;
mod branch;
mod clearance_sphere;
mod clearance_surface;
mod cleared;
mod direct_link;
pub(crate) mod fast_leads;
pub(crate) mod first_travel;
mod lifted_lines;
mod like_sectors;
pub(crate) mod link_moves;
mod pieces;
pub mod rest_machining;
mod stock_links;
mod stock_order;
mod stock_steps;
mod strokes;
mod through_air;
