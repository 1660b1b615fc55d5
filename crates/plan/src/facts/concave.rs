//! Smallest concave radius of faces and edges: what a cutter must fit into.

use nalgebra::Point3;
use wheel::part::{FaceId, Part, Surface};

/// Place of a surface at which it is most concave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Concave {
    /// Face, or edge that is a surface of its own.
    pub side: FaceId,
    /// Concave radius, mm.
    pub radius: f64,
    /// Parameters of the place.
    pub at: [f64; 2],
    /// The place, sector 0.
    pub point: Point3<f64>,
}

/// Places along a surface and up to its tip, minus one.
const SURFACE_INTERVALS: [usize; 2] = [400, 24];

/// Radius from which a surface counts as flat, mm.
pub const FLAT_RADIUS_MM: f64 = 1000.0;

/// The most concave place of a surface over its fillet, among places of a grid; `None` where no radius is below [`FLAT_RADIUS_MM`].
pub fn measure(part: &Part, side: FaceId) -> Option<Concave> {
    let face = part.face(side);
    let columns = (0..=SURFACE_INTERVALS[0]).map(|i| i as f64 / SURFACE_INTERVALS[0] as f64);
    let places = columns.flat_map(|u| {
        let foot = part.fillet_top(side, u).unwrap_or(0.0);
        (0..=SURFACE_INTERVALS[1]).map(move |j| [u, foot + (1.0 - foot) * j as f64 / SURFACE_INTERVALS[1] as f64])
    });
    let curvature_at = |[u, v]: [f64; 2]| {
        // Towards the outside of the material.
        let [more, less] = face.surface.derivatives(u, v).curvature()?.principal;
        Some(if face.orientation > 0.0 { more } else { -less })
    };
    let most = places.filter_map(|at| Some((curvature_at(at)?, at))).max_by(|a, b| a.0.total_cmp(&b.0));
    let (curvature, at) = most.filter(|(curvature, _)| *curvature > 1.0 / FLAT_RADIUS_MM)?;
    Some(Concave { side, radius: 1.0 / curvature, at, point: face.surface.point(at[0], at[1]) })
}
