//! Second derivatives of both curves by their parameter. Their term keeps a path from running to and fro along itself
//! where this changes no deviation.
//!
//! The sum approximates the integral of the squares of both second derivatives, mm2: each of their control points
//! counts for one knot span.

use crate::quadratic::Band;
use nurbs::DualCurve;

/// Entries of a row: one coordinate of three neighbouring control points of one curve.
const ROW: usize = 13;

/// Adds `weight` times the quadratic model of half of the sum: its Hessian, with at least `ROW - 1` places beside the
/// diagonal, and its gradient.
pub(super) fn add_model(curve: &DualCurve, weight: f64, hessian: &mut Band, slope: &mut [f64]) {
    for (first, entries, value) in rows(curve) {
        hessian.add_square(first, &entries, weight);
        for (to, a) in slope[first..first + ROW].iter_mut().zip(&entries) {
            *to += weight * a * value;
        }
    }
}

/// Places beside the diagonal that the model needs.
pub(super) const WIDTH: usize = ROW - 1;

/// For each coordinate of the second derivatives: first unknown, weights from there on, and value.
fn rows(curve: &DualCurve) -> impl Iterator<Item = (usize, [f64; ROW], f64)> + '_ {
    let share = (1.0 / (curve.control_count() - 3) as f64).sqrt();
    curve.second_derivative().into_iter().enumerate().flat_map(move |(i, weights)| {
        (0..6).map(move |k| {
            let mut entries = [0.0; ROW];
            let mut value = 0.0;
            for (j, weight) in weights.iter().enumerate() {
                let points = if k < 3 { curve.lower() } else { curve.upper() };
                entries[6 * j] = share * weight;
                value += share * weight * points[i + j][k % 3];
            }
            (6 * i + k, entries, value)
        })
    })
}
