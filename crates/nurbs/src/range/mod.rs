//! Ranges of derivatives: intervals that contain every value over a range of parameters, for proofs that hold between
//! points.
//!
//! | file | holds |
//! |---|---|
//! | `interval` | arithmetic of intervals |
//! | `jet` | a function of one parameter with its derivatives up to the third, as intervals |
//! | `segment` | control points of a spline and its derivatives over a part of a span |
//! | `curve` | jets of NURBS curves and of meridians |
//! | `partials` | partial derivatives of faces, and jets along a line of a face |
//! | `thickness` | how far a function lies from the parabola through three of its points |
//!
//! Arithmetic is that of `f64`, without directed rounding. Rounding errors are below 1e-9 mm, the reserve that every
//! comparison of distances has.

mod curve;
mod interval;
mod jet;
mod partials;
mod segment;
mod thickness;

pub use interval::Interval;
pub use jet::{Jet, great_arc, turned};
pub use partials::Partials;
pub use thickness::CellThickness;
