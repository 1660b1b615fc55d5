//! Sections of blades, as designers give them and before they are surfaces. Pure geometry: lengths in mm, angles in
//! radians, the frame of the part (right handed, Z is the axis of rotation).
//!
//! A section is what a blade has on one surface between hub and shroud. Files give it as a closed loop of points, as two
//! faces, or as a mean line with thicknesses. Each form becomes an [`Outline`], from which the faces and edges of the
//! blade are made.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub mod angles;
mod edges;
pub mod facts;
mod fold;
pub mod foot;
mod joined;
pub mod loft;
mod mean_line;
pub mod outline;
mod ring;
mod stream;

pub use edges::{CORNER_TURN, EdgeForm, FoundEdge, is_cut_off};

use nalgebra::Point3;

/// A section of a blade.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Share of the height from hub (0) to shroud (1), where the source states it.
    pub span: Option<f64>,
    /// What the source gives.
    pub form: SectionForm,
}

/// What a source gives of a section.
#[derive(Clone, Debug, PartialEq)]
pub enum SectionForm {
    /// Points once round the blade, from any start. The first point is not repeated at the end.
    Loop(Vec<Point3<f64>>),
    /// Such points, and which of them are edges.
    DividedLoop {
        /// Points once round the blade.
        points: Vec<Point3<f64>>,
        /// Leading and trailing edge.
        edges: LoopEdges,
    },
    /// Points of the pressure and of the suction face, each from the leading to the trailing edge.
    Faces([Vec<Point3<f64>>; 2]),
    /// Points of the mean line from the leading to the trailing edge.
    MeanLine {
        /// Points with their thicknesses.
        points: Vec<MeanPoint>,
        /// Direction in which the thickness is measured.
        thickness: ThicknessDirection,
    },
}

/// Indices of the first and of the last point of the leading and of the trailing edge, in the order of a loop. These points end the
/// faces as well. An edge may go over the end of the list.
pub type LoopEdges = [[usize; 2]; 2];

/// Words for the points of the leading and of the trailing edge of a loop in a file of points.
pub const LOOP_EDGES: [&str; 2] = ["leading-edge", "trailing-edge"];

/// A point of a mean line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanPoint {
    /// Its position.
    pub position: Point3<f64>,
    /// Thickness of the blade there, mm.
    pub thickness: f64,
}

/// Direction in which a thickness is measured, on the surface of the section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThicknessDirection {
    /// Across the mean line.
    Normal,
    /// Round the axis of rotation.
    Tangential,
}

/// A section divided into its two faces and its two edges. Neighbours share their end points.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Share of the height from hub (0) to shroud (1), where the source states it.
    pub span: Option<f64>,
    /// Points of the pressure and of the suction face, each from the leading to the trailing edge.
    pub faces: [Vec<Point3<f64>>; 2],
    /// Points of the leading and of the trailing edge, each from the pressure to the suction face with the end points of
    /// both. Two points are an edge that is cut off.
    pub edges: [Vec<Point3<f64>>; 2],
}
