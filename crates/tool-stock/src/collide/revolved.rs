//! Samples of the outside of a turned solid.

use super::CloudPoint;
use nalgebra::{Point3, Vector3};
use std::f64::consts::TAU;

/// Fewest samples of a ring. With fewer of them on a small ring, a point of the next edge could lie farther from all
/// samples than half a diagonal of the spacing.
const LEAST_AROUND: f64 = 8.0;

/// Samples of a turned solid about an axis along Z through a point (x, y), for queries of distance.
///
/// `profile` has the points (radius, z) of its outside, mm. Samples lie at most `spacing` apart, mm, in both directions; on a
/// solid that would have more than `most` of them they lie farther apart. Returns the samples and the spacing.
pub fn revolved(profile: &[[f64; 2]], [x, y]: [f64; 2], spacing: f64, most: f64) -> (Vec<CloudPoint>, f64) {
    let edges = || profile.windows(2).map(|e| (e[0], e[1], libm::hypot(e[1][0] - e[0][0], e[1][1] - e[0][1])));
    let area: f64 = edges().map(|(a, b, length)| 0.5 * TAU * (a[0] + b[0]) * length).sum();
    let spacing = spacing.max((area / most).sqrt());
    let mut points = Vec::new();
    for (a, b, length) in edges() {
        let rings = (length / spacing).ceil().max(1.0) as usize;
        for i in 0..=rings {
            let t = i as f64 / rings as f64;
            let (r, z) = (a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t);
            let around = (TAU * r / spacing).ceil().max(LEAST_AROUND) as usize;
            points.extend((0..around).map(|k| {
                let angle = TAU * k as f64 / around as f64;
                let position = Point3::new(x + r * libm::cos(angle), y + r * libm::sin(angle), z);
                CloudPoint { position, normal: Vector3::z(), tag: 0 }
            }));
        }
    }
    (points, spacing)
}
