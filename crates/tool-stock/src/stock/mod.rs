//! The real stock as rays along X, Y and Z with their intervals of material, and tools that cut it block by block.
//!
//! | file | what |
//! |---|---|
//! | [`field`] | the rays: made from a turned blank or a mesh inside of it, volume |
//! | `slice` | rows of rays through a closed mesh |
//! | `ray` | sorted disjoint intervals of material |
//! | `shape` | convex bodies of revolution: cutter, frusta of shank and holder |
//! | `sweep` | such a body in motion: its signed distance, and the least value over time |
//! | `moving` | such a body in motion with bounds, against a line |
//! | `lanes` | queries about eight intervals of material at once against such a body |
//! | `reach` | which steps may reach a group of lines |
//! | `intervals` | what such a body removes of the intervals of a group of lines |
//! | [`lune`] | material about the axis that a step along the axis removes |
//! | [`slices`] | slices of a cutter along its axis: sides to which it removes material |
//! | `run` | successive steps as one motion |
//! | `tile` | 64 x 64 rays with a coarse map of the material |
//! | [`simulate()`] | a stream of steps through all tiles |
//! | [`depths`] | how deep a tool would lie in the material |
//! | [`mesh`] | closed triangle meshes |
//! | `surface_nets` | mesh of the stock |
//! | [`stl`] | STL files: writer and reader |
//!
//! Only ends of intervals are stored, each within [`END_ERROR`] of the surface of the tool that cut it, so that the
//! errors of many cuts do not add up. Between the rays nothing is known: features smaller than a cell may exist there.
//! Lengths are in mm.

mod depth;
pub mod field;
mod intervals;
mod lanes;
pub mod lune;
pub mod mesh;
mod moving;
mod ray;
mod reach;
mod run;
mod shape;
pub mod simulate;
mod slice;
pub mod slices;
pub mod stl;
mod surface_nets;
mod sweep;
mod tile;

pub use depth::{Depth, depths, is_free};
pub use field::{Field, FieldError, Uncut};
pub use lune::Lune;
pub use mesh::Mesh;
pub use simulate::{BlockCut, Collision, Outcome, cut, simulate};
pub use slices::{SLICES, Sides, Slices};

use nalgebra::{Point3, Vector3};

/// Largest distance between the end of an interval and the surface of the swept tool, mm: the accuracy of the search in
/// time and along a ray.
pub const END_ERROR: f64 = 1e-3;

/// Largest turn of a step, radians: up to this turn, three axes describe the step to a fraction of [`END_ERROR`].
pub const MAX_STEP_TURN: f64 = 2.0 * std::f64::consts::PI / 180.0;

/// Kind of motion of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepKind {
    /// Cutting feed.
    Cut,
    /// Between passes, at feed.
    Link,
    /// At rapid, where the tool must not touch anything.
    Rapid,
}

/// A short piece of motion of one tool: a turn of at most [`MAX_STEP_TURN`], and a few millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Number of its block; it never decreases along a stream.
    pub block: u32,
    /// Kind of motion.
    pub kind: StepKind,
    /// Tool tip at start and end; the tip runs straight.
    pub tips: [Point3<f64>; 2],
    /// Unit vector from tip to holder at start, half time and end.
    pub axes: [Vector3<f64>; 3],
}

/// Part of the tool with a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Touched {
    /// The cutter, at rapid.
    Cutter,
    /// The shank.
    Shank,
    /// The holder.
    Holder,
}
