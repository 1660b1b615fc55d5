//! The engine of proof: cutters swept over continuous time, and bounds of their distance to cells of surfaces.
//!
//! | file | holds |
//! |---|---|
//! | `piece` | a part of a move, and how far points of the tool deviate from their tangent over it |
//! | `capsule` | the ball of a cutter over a piece |
//! | `turns` | pieces that are the same, turned by pitches |
//! | `hierarchy` | a tree over the pieces of a sweep |
//! | `sweep` | the cutter of an operation over all of its pieces |
//! | `nearest` | which pieces are nearest to a point, or may be below a cutoff |
//! | `hull` | a cell of a surface |
//! | `cutoff` | distance over the blocks of a patch above which a piece cannot matter |
//! | `lower_bound`, `upper_bound` | bounds of the distance over a whole cell and a whole piece |
//! | `grid` | cells without gaps |
//! | `cells` | values at corners, then the proof over every cell |

mod capsule;
pub(crate) mod cells;
mod cutoff;
pub(crate) mod grid;
mod hierarchy;
mod hull;
mod lower_bound;
pub(crate) mod nearest;
pub mod piece;
pub mod sweep;
pub mod turns;
mod upper_bound;
