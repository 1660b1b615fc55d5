//! Four-sided patches: directions, places of points in each of them, and the points of a patch.

use super::SurfaceKind;
use nalgebra::{Point3, Vector3};
use nurbs::bracket::Bracket;

/// A direction of patches. All patches that meet in a border have the same steps along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PatchDirection {
    /// Along a blade.
    Along,
    /// From the hub up a fillet.
    Fillet,
    /// Up a face.
    Face,
    /// Across a channel.
    Channel,
    /// Across a blade.
    Blade,
    /// Along a rounded edge, from a face to the middle part of the edge.
    Shoulder,
    /// From a blade that ends inside of the part to the circle at the inlet or the outlet of the hub.
    Before,
}

/// Of each [`PatchDirection`], the places of the points of patches: shares of the length, which ascend from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shares(pub [Vec<f64>; 7]);

impl Shares {
    /// So many equal steps in each direction.
    pub(super) fn equal(steps: [usize; 7]) -> Self {
        Self(steps.map(|n| (0..=n).map(|k| k as f64 / n as f64).collect()))
    }

    /// Places of a direction.
    pub(super) fn of(&self, direction: PatchDirection) -> &[f64] {
        &self.0[direction as usize]
    }
}

/// Spacing of the places along a blade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AlongSpacing {
    /// Places are shares of the blade.
    Equal,
    /// Shorter steps near both ends, where a fillet bends: the ball rolls beyond the ends of the face, which goes on straight.
    FineEnds,
}

impl AlongSpacing {
    /// Shares of the way along a blade at places; their derivatives are continuous.
    pub(super) fn shares(self, places: &[f64]) -> Vec<f64> {
        /// Share of the length near an end that is fine: fillets of the shipped wheels bend within a twentieth.
        const NEAR_END: f64 = 0.06;
        /// Density of places at an end, over that in the middle.
        const DENSER: f64 = 10.0;
        // Integral of 1 + DENSER (exp(-(s / NEAR_END)^2) + exp(-((1 - s) / NEAR_END)^2)).
        let bell = DENSER * NEAR_END / std::f64::consts::FRAC_2_SQRT_PI;
        let [at_end, whole] = [0.0, 1.0 / NEAR_END].map(libm::erf);
        let sum = |s: f64| s + bell * (libm::erf(s / NEAR_END) + whole - at_end - libm::erf((1.0 - s) / NEAR_END));
        let share = |t: f64| {
            // Bisection down to rounding.
            Bracket { holds: 0.0, fails: 1.0 }.halved(54, |s| sum(s) < t * sum(1.0)).middle()
        };
        match self {
            Self::Equal => places.to_vec(),
            Self::FineEnds => places.iter().map(|t| if *t == 0.0 || *t == 1.0 { *t } else { share(*t) }).collect(),
        }
    }
}

/// Rows of points, all of one length.
pub(super) type PointRows = Vec<Vec<Point3<f64>>>;

/// A surface over the unit square by points at the places of its directions.
#[derive(Clone, Debug)]
pub(super) struct SheetPatch {
    /// Kind of the surface.
    pub kind: SurfaceKind,
    /// Directions of its columns and of its rows.
    pub directions: [PatchDirection; 2],
    /// Rows of points.
    pub rows: PointRows,
    /// True when columns and rows run clockwise as seen from outside.
    pub turned: bool,
}

/// Why a part has no patches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PatchFault {
    /// A fillet does not extend along this surface from end to end.
    Fillet(SurfaceKind),
    /// The edge leaves the border of a face of its blade by this distance, mm.
    Gap(SurfaceKind, f64),
    /// Lines between the borders of the surface cross each other.
    Folded(SurfaceKind),
}

/// True when columns and rows run clockwise as seen against a normal, at the middle of a grid.
pub(super) fn clockwise(rows: &[Vec<Point3<f64>>], normal: &Vector3<f64>) -> bool {
    let (i, j) = ((rows.len() - 1) / 2, (rows[0].len() - 1) / 2);
    let [p, q, s] = [rows[i][j], rows[i][j + 1], rows[i + 1][j]];
    (q - p).cross(&(s - p)).dot(normal) < 0.0
}
