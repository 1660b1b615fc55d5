//! The choice of Xu 2013: contact by contact, the axis of its cone that fits best to the axes already chosen.
//!
//! Each axis is a compromise between the normal and the axis that adds least energy (22). The more the surface is
//! curved, the less weight the normal has: the weight is the absolute logarithm of the curvature over the mean of all
//! curvatures (Xu 5).

use super::energy::Energy;
use nalgebra::{Vector2, Vector3};
use nurbs::EllipticCone;
use std::f64::consts::TAU;

/// Rings, and axes per ring, that are tried in a cone.
const CONE_RINGS: usize = 4;
const AXES_PER_RING: usize = 16;

/// A contact of the greedy choice.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Unit normal of the surface.
    pub normal: Vector3<f64>,
    /// Clear axes.
    pub cone: EllipticCone,
    /// Weight of the curvature, see [`weight`].
    pub weight: f64,
}

/// Weight of a curvature against the mean of all, both of any sign: |ln |k / mean||, at most 3 so that a flat place has
/// a finite weight.
pub fn weight(curvature: f64, mean: f64) -> f64 {
    let ratio = (curvature / mean).abs();
    if ratio > 0.0 && ratio.is_finite() { libm::log(ratio).abs().min(3.0) } else { 3.0 }
}

/// Axes of a row of contacts `spacing` apart, mm, in their order. `neighbours` are the axes of the previous row, if
/// any; the energy then counts across rows as well as along them.
pub fn choose(
    contacts: &[Contact],
    neighbours: Option<&[Vector3<f64>]>,
    energy: &Energy,
    spacing: f64,
) -> Vec<Vector3<f64>> {
    let mut chosen: Vec<Vector3<f64>> = Vec::with_capacity(contacts.len());
    for (i, contact) in contacts.iter().enumerate() {
        let neighbour = neighbours.and_then(|n| n.get(i)).copied();
        let cost = |axis: &Vector3<f64>| {
            let along = energy.next(&chosen, axis, spacing);
            let across = neighbour.map_or(0.0, |b| energy.next(&[b], axis, spacing));
            // Without neighbours the normal alone decides: the start in the paper.
            let upright = (axis - contact.normal).norm_squared() / (1.0 + contact.weight);
            along + across + UPRIGHT * upright
        };
        let mut best = contact.cone.axis();
        let mut least = cost(&best);
        for ring in 1..=CONE_RINGS {
            // The rim itself is left out, since rounding could put it on either side.
            let radius = 0.999 * ring as f64 / CONE_RINGS as f64;
            for k in 0..AXES_PER_RING {
                let (sin, cos) = libm::sincos(TAU * k as f64 / AXES_PER_RING as f64);
                let at = contact.cone.from_disc(&Vector2::new(radius * cos, radius * sin));
                let axis = contact.cone.direction(&at);
                let found = cost(&axis);
                if found < least {
                    (best, least) = (axis, found);
                }
            }
        }
        chosen.push(best);
    }
    chosen
}

/// Weight of the squared distance to the normal in the cost, relative to the energies in mm.
const UPRIGHT: f64 = 0.02;
