//! Surfaces of blades: the common interface of all kinds.

use nalgebra::{Point3, Vector3};
use nurbs::lofted::LoftedSearch;
use nurbs::proximity::{ClosestPair, Patch, Projection};
use nurbs::range::Partials;
use nurbs::{LoftedSurface, NurbsCurve, RuledSurface, SurfaceDerivatives};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// A surface over u, from inlet (0) to outlet (1), and v, from root (0) to tip (1). Outside of both ranges it continues
/// straight.
pub trait Surface {
    /// Point with first and second derivatives.
    fn derivatives(&self, u: f64, v: f64) -> SurfaceDerivatives;

    /// Closest point of a patch.
    fn closest(&self, p: &Point3<f64>, patch: Patch) -> Projection;

    /// The surface turned about Z by an angle in radians (Wei 18).
    #[must_use]
    fn rotated(&self, angle: f64) -> Self
    where
        Self: Sized;

    /// Point, `S_u` and `S_v`.
    fn tangents(&self, u: f64, v: f64) -> (Point3<f64>, Vector3<f64>, Vector3<f64>) {
        let d = self.derivatives(u, v);
        (d.point, d.su, d.sv)
    }

    /// Point.
    fn point(&self, u: f64, v: f64) -> Point3<f64> {
        self.tangents(u, v).0
    }

    /// Unit normal along `S_u` x `S_v`.
    fn normal(&self, u: f64, v: f64) -> Vector3<f64> {
        let (_, su, sv) = self.tangents(u, v);
        su.cross(&sv).normalize()
    }
}

/// The surfaces have the methods already, some of them faster than those that the trait gives.
macro_rules! is_surface {
    ($surface:ty) => {
        impl Surface for $surface {
            fn derivatives(&self, u: f64, v: f64) -> SurfaceDerivatives {
                self.derivatives(u, v)
            }
            fn closest(&self, p: &Point3<f64>, patch: Patch) -> Projection {
                self.closest(p, patch)
            }
            fn rotated(&self, angle: f64) -> Self {
                self.rotated(angle)
            }
            // Computes no second derivatives.
            fn tangents(&self, u: f64, v: f64) -> (Point3<f64>, Vector3<f64>, Vector3<f64>) {
                self.tangents(u, v)
            }
            fn point(&self, u: f64, v: f64) -> Point3<f64> {
                self.point(u, v)
            }
        }
    };
}

is_surface!(RuledSurface);
is_surface!(LoftedSurface);

/// The surface of a face of a blade, by its kind. A new kind needs one line in each table below.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaceSurface {
    /// Straight lines between a root curve and a tip curve.
    Ruled(RuledSurface),
    /// A spline through sections.
    Lofted(LoftedSurface),
}

macro_rules! of_its_kind {
    ($surface:expr, $s:ident => $result:expr) => {
        match $surface {
            FaceSurface::Ruled($s) => $result,
            FaceSurface::Lofted($s) => $result,
        }
    };
}

impl Surface for FaceSurface {
    fn derivatives(&self, u: f64, v: f64) -> SurfaceDerivatives {
        of_its_kind!(self, s => s.derivatives(u, v))
    }
    fn closest(&self, p: &Point3<f64>, patch: Patch) -> Projection {
        of_its_kind!(self, s => s.closest(p, patch))
    }
    fn rotated(&self, angle: f64) -> Self {
        match self {
            Self::Ruled(s) => Self::Ruled(s.rotated(angle)),
            Self::Lofted(s) => Self::Lofted(s.rotated(angle)),
        }
    }
    fn tangents(&self, u: f64, v: f64) -> (Point3<f64>, Vector3<f64>, Vector3<f64>) {
        of_its_kind!(self, s => s.tangents(u, v))
    }
    fn point(&self, u: f64, v: f64) -> Point3<f64> {
        of_its_kind!(self, s => s.point(u, v))
    }
}

/// A face at one u, for many places along v.
#[derive(Clone, Copy, Debug)]
pub enum FaceLine<'a> {
    /// Root and vector to the tip.
    Ruled(Point3<f64>, Vector3<f64>),
    /// The surface and u.
    Lofted(&'a LoftedSurface, f64),
}

impl FaceLine<'_> {
    /// Point at v, as [`Surface::point`].
    pub fn point(&self, v: f64) -> Point3<f64> {
        match self {
            Self::Ruled(root, ruling) => root + ruling * v,
            Self::Lofted(surface, u) => Surface::point(*surface, *u, v),
        }
    }
}

/// A search for closest points of a patch of a face, for many points.
#[derive(Clone, Debug)]
pub enum FaceSearch<'a> {
    /// The surface and the patch.
    Ruled(&'a RuledSurface, Patch),
    /// With seeds of the patch.
    Lofted(LoftedSearch<'a>),
}

impl FaceSearch<'_> {
    /// Closest point, as [`Surface::closest`].
    pub fn closest(&self, p: &Point3<f64>) -> Projection {
        match self {
            Self::Ruled(surface, patch) => surface.closest(p, *patch),
            Self::Lofted(search) => search.closest(p),
        }
    }
}

impl FaceSurface {
    /// A search for closest points of a patch.
    pub fn search(&self, patch: Patch) -> FaceSearch<'_> {
        match self {
            Self::Ruled(s) => FaceSearch::Ruled(s, patch),
            Self::Lofted(s) => FaceSearch::Lofted(s.search(patch)),
        }
    }

    /// The line of equal u.
    pub fn line(&self, u: f64) -> FaceLine<'_> {
        match self {
            Self::Ruled(s) => {
                let root = s.root.point_extended(u);
                FaceLine::Ruled(root, s.tip.point_extended(u) - root)
            }
            Self::Lofted(s) => FaceLine::Lofted(s, u),
        }
    }

    /// Partial derivatives over a range of u within [0, 1] and a range of v.
    pub fn partials(&self, u: [f64; 2], v: [f64; 2]) -> Partials {
        of_its_kind!(self, s => s.partials(u, v))
    }

    /// Name of the kind in the job language.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Ruled(_) => "ruled",
            Self::Lofted(_) => "lofted",
        }
    }

    /// Curves that the surface contains, from the root (v = 0) to the tip (v = 1).
    pub fn sections(&self) -> Vec<&NurbsCurve> {
        match self {
            Self::Ruled(s) => vec![&s.root, &s.tip],
            Self::Lofted(s) => s.sections().iter().collect(),
        }
    }

    /// The curve at v = 0.
    pub fn root(&self) -> &NurbsCurve {
        match self {
            Self::Ruled(s) => &s.root,
            Self::Lofted(s) => &s.sections()[0],
        }
    }

    /// The curve at v = 1.
    pub fn tip(&self) -> &NurbsCurve {
        match self {
            Self::Ruled(s) => &s.tip,
            Self::Lofted(s) => &s.sections()[s.sections().len() - 1],
        }
    }

    /// Unit vector from root to tip at u: along the ruling of a ruled face (Wei 10).
    pub fn ruling(&self, u: f64) -> Vector3<f64> {
        match self {
            Self::Ruled(s) => s.ruling(u),
            Self::Lofted(_) => (self.point(u, 1.0) - self.point(u, 0.0)).normalize(),
        }
    }

    /// Largest length of the derivative by v along the line of equal u, mm per unit of v.
    pub fn height(&self, u: f64) -> f64 {
        /// Stations along v of a lofted face: about ten between two sections.
        const LOFT_STATIONS: u32 = 64;
        match self {
            Self::Ruled(s) => s.tangents(u, 0.0).2.norm(),
            Self::Lofted(s) => (0..=LOFT_STATIONS)
                .map(|i| s.tangents(u, f64::from(i) / f64::from(LOFT_STATIONS)).2.norm())
                .fold(0.0, f64::max),
        }
    }

    /// The closest pair of points of a patch of this surface and a patch of another.
    pub fn closest_pair(&self, patch: Patch, other: &Self, other_patch: Patch) -> ClosestPair {
        if let (Some(a), Some(b)) = (self.as_ruled(), other.as_ruled()) {
            return a.closest_pair(patch, b, other_patch);
        }
        /// Seeds along u and v.
        const PROJECTION_SEEDS: [u32; 2] = [40, 12];
        /// Largest number of projections from one surface to the other and back; each reduces the distance.
        const MAX_PROJECTIONS: usize = 200;
        /// Gain below which the search ends, mm.
        const LEAST_GAIN_MM: f64 = 1e-12;
        let at =
            |range: [f64; 2], i: u32, n: u32| range[0] + (range[1] - range[0]) * f64::from(i) / f64::from(n.max(1));
        // A patch that is a line has all its places with the first v.
        let across = if patch.v[0] < patch.v[1] { PROJECTION_SEEDS[1] } else { 0 };
        let (own, others) = (self.search(patch), other.search(other_patch));
        let from = |p: &Point3<f64>| {
            let second = others.closest(p);
            let first = own.closest(&second.point);
            ClosestPair { first, second, distance: first.distance }
        };
        let seeds: Vec<(u32, u32)> =
            (0..=PROJECTION_SEEDS[0]).flat_map(|i| (0..=across).map(move |j| (i, j))).collect();
        let start =
            |(i, j): (u32, u32)| self.point(at(patch.u, i, PROJECTION_SEEDS[0]), at(patch.v, j, PROJECTION_SEEDS[1]));
        let starts: Vec<ClosestPair> = seeds.into_par_iter().map(|seed| from(&start(seed))).collect();
        let nearest = starts.into_iter().min_by(|a, b| a.distance.total_cmp(&b.distance));
        let mut best = nearest.unwrap_or_else(|| from(&self.point(patch.u[0], patch.v[0])));
        for _ in 0..MAX_PROJECTIONS {
            let next = from(&best.first.point);
            let nearer = next.distance < best.distance - LEAST_GAIN_MM;
            if next.distance < best.distance {
                best = next;
            }
            if !nearer {
                break;
            }
        }
        best
    }

    /// The ruled surface, if the face is ruled.
    pub fn as_ruled(&self) -> Option<&RuledSurface> {
        match self {
            Self::Ruled(s) => Some(s),
            Self::Lofted(_) => None,
        }
    }
}
