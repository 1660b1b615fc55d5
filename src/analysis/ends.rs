//! How far the ends of the faces lie off hub and shroud. The lowering says it under the text of the curve.

use crate::part::{BladeId, FaceId, Part, RulingEnd, Surface};
use nalgebra::Point3;

/// Distance of one guide curve to the surface that the face should end on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndGap {
    /// Face.
    pub side: FaceId,
    /// End of its rulings: root to hub, tip to shroud.
    pub end: RulingEnd,
    /// Where the distance is largest, from inlet (0) to outlet (1).
    pub u: f64,
    /// Signed distance there, mm, positive out of the hub or over the shroud.
    pub distance: f64,
    /// The point.
    pub point: Point3<f64>,
}

/// Stations along a curve, less one.
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
