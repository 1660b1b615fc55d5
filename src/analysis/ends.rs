//! Distances of the ends of the faces from hub and shroud. The lowering reports them at the text of the curve.

use crate::part::{BladeId, FaceId, Part, RulingEnd, Surface};
use nalgebra::Point3;

/// Distance of a guide curve from the surface on which the face should end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndGap {
    /// Face.
    pub side: FaceId,
    /// End of the rulings: the root belongs to the hub, the tip to the shroud.
    pub end: RulingEnd,
    /// Place of the largest distance, from inlet (0) to outlet (1).
    pub u: f64,
    /// Signed distance there, mm, positive out of the hub or over the shroud.
    pub distance: f64,
    /// The point.
    pub point: Point3<f64>,
}

/// Number of intervals along a curve.
const STATIONS: usize = 400;

/// Measures all four ends.
pub fn measure(part: &Part) -> Vec<EndGap> {
    let mut gaps = Vec::new();
    for side in BladeId::MAIN.faces() {
        for (end, v, surface) in [(RulingEnd::Root, 0.0, &part.hub), (RulingEnd::Tip, 1.0, &part.shroud)] {
            let all = (0..=STATIONS).map(|i| i as f64 / STATIONS as f64).map(|u| {
                let point = part.face(side).surface.point(u, v);
                EndGap { side, end, u, distance: surface.distance(&point), point }
            });
            gaps.extend(all.max_by(|a, b| a.distance.abs().total_cmp(&b.distance.abs())));
        }
    }
    gaps
}
