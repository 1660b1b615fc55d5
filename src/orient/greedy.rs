//! The choice of Xu 2013: contact by contact, the axis of its cone that fits best to those already chosen.
//!
//! Each axis is drawn from the normal towards the axis that adds least energy (22), the more the stronger the surface
//! bends there: the weight is the absolute logarithm of the curvature over the mean of all (Xu 5).

use super::energy::Energy;
use crate::geom::EllipticCone;
use nalgebra::{Vector2, Vector3};
use std::f64::consts::TAU;

/// Rings and axes on a ring that are tried in a cone.
const RINGS: usize = 4;
const AROUND: usize = 16;

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
/// a finite one.
pub fn weight(curvature: f64, mean: f64) -> f64 {
    let ratio = (curvature / mean).abs();
    if ratio > 0.0 && ratio.is_finite() { libm::log(ratio).abs().min(3.0) } else { 3.0 }
}

/// Axes of a row of contacts `spacing` apart, mm, in their order. `neighbours` are the axes of the row before, where
/// there is one: the energy counts across rows as along them.
pub fn choose(
    contacts: &[Contact],
    neighbours: Option<&[Vector3<f64>]>,
    energy: &Energy,
    spacing: f64,
) -> Vec<Vector3<f64>> {
    let mut chosen: Vec<Vector3<f64>> = Vec::with_capacity(contacts.len());
    for (i, contact) in contacts.iter().enumerate() {
        let beside = neighbours.and_then(|n| n.get(i)).copied();
        let cost = |axis: &Vector3<f64>| {
            let along = energy.next(&chosen, axis, spacing);
            let across = beside.map_or(0.0, |b| energy.next(&[b], axis, spacing));
            // Without neighbours the normal alone decides, which is the paper's start.
            let upright = (axis - contact.normal).norm_squared() / (1.0 + contact.weight);
            along + across + UPRIGHT * upright
        };
        let mut best = contact.cone.axis();
        let mut least = cost(&best);
        for ring in 1..=RINGS {
            // The rim itself is left out: rounding could fall on either side.
            let radius = 0.999 * ring as f64 / RINGS as f64;
            for k in 0..AROUND {
                let (sin, cos) = libm::sincos(TAU * k as f64 / AROUND as f64);
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

/// Share of the square distance to the normal in the cost, against the energies of mm.
const UPRIGHT: f64 = 0.02;
