//! NURBS curves and surfaces: the front page is the README.
#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub mod angle;
pub mod basis;
pub mod bezier;
pub mod bracket;
pub mod chords;
pub mod curvature;
pub mod curve;
pub mod dual;
pub mod elliptic_cone;
mod envelope_cholesky;
pub mod geodesic;
pub mod interpolate;
pub mod knots;
mod least_squares;
pub mod lofted;
pub mod moving_least_squares;
pub mod proximity;
pub mod quadrature;
pub mod range;
pub mod revolution;
pub mod row_fit;
pub mod ruled;
pub mod spline_fit;
#[cfg(all(test, feature = "serde"))]
mod stored;
pub mod surface;
pub mod triangulation;

pub use curvature::SurfaceCurvature;
pub use curve::{CurveDerivatives, NurbsCurve};
pub use dual::{AxisAt, DualCurve, Pieces};
pub use elliptic_cone::EllipticCone;
pub use geodesic::BandMetric;
pub use interpolate::{interpolate, interpolate_at, interpolate_grid};
pub use lofted::LoftedSurface;
pub use revolution::Revolution;
pub use ruled::RuledSurface;
pub use surface::{NurbsSurface, SurfaceDerivatives};
pub use triangulation::Triangulation;

/// Why a geometric entity cannot be constructed.
#[derive(Clone, Debug, PartialEq)]
pub enum GeomError {
    /// Fewer points than the degree needs.
    TooFewPoints {
        /// Points given.
        given: usize,
        /// Points needed.
        needed: usize,
    },
    /// Two neighbouring data points coincide (index of the first).
    CoincidentPoints(usize),
    /// A coordinate, weight or knot is not a finite number (index).
    NotFinite(usize),
    /// Knots decrease, have the wrong number, are not clamped to [0, 1] or make the curve discontinuous.
    Knots,
    /// A weight is not positive (index).
    Weight(usize),
    /// Degree outside 1..=3.
    Degree(usize),
    /// The system of equations has no solution.
    Singular,
    /// Two guide curves with different weight functions: the ruled surface between them has a higher degree.
    GuideWeights,
    /// The side of a surface is neither +1 nor -1.
    Orientation,
    /// More sections than a lofted surface that is read may have.
    TooManySections(usize),
    /// A control point of a lofted surface does not follow from its sections (index).
    Control(usize),
}

impl std::fmt::Display for GeomError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::TooFewPoints { given, needed } => write!(f, "{given} points where at least {needed} are needed"),
            Self::CoincidentPoints(i) => write!(f, "points {} and {} coincide", i + 1, i + 2),
            Self::NotFinite(i) => write!(f, "value {} is not a finite number", i + 1),
            Self::Knots => write!(f, "the knots are not an ascending clamped sequence on [0, 1] of the right count"),
            Self::Weight(i) => write!(f, "weight {} is not positive", i + 1),
            Self::Degree(p) => write!(f, "degree {p} is not one of 1, 2, 3"),
            Self::Singular => write!(f, "the interpolation has no unique solution"),
            Self::GuideWeights => write!(f, "the guide curves have different weights"),
            Self::Orientation => write!(f, "the side of the surface is neither 1 nor -1"),
            Self::TooManySections(n) => write!(f, "{n} sections are too many"),
            Self::Control(i) => write!(f, "control point {} does not follow from the sections", i + 1),
        }
    }
}

impl std::error::Error for GeomError {}
