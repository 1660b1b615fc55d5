//! The tool along a pass: rotary angles without jumps, and the length of its path.

use five_axis::{Angles, Chain};
use nalgebra::{Point3, Vector3};

/// Angles of successive tool axes, on one branch and winding.
pub(crate) fn rotary(chain: &Chain, axes: impl Iterator<Item = Vector3<f64>>) -> Vec<Angles> {
    let mut angles: Vec<Angles> = Vec::new();
    for axis in axes {
        let before = angles.last().map_or(0.0, |q| q[1]);
        angles.push(chain.unwound(&axis, 0, before));
    }
    angles
}

/// Length of the path of the ball centre up to each station of a pass.
pub(crate) fn lengths(centres: &[Point3<f64>]) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = centres.windows(2).map(|w| {
        sum += (w[1] - w[0]).norm();
        sum
    });
    std::iter::once(0.0).chain(steps).collect()
}

/// The interval of a table that contains a value, and the share of the value in the interval.
pub(crate) fn interval_at(table: &[f64], value: f64) -> (usize, f64) {
    let i = table.partition_point(|x| *x <= value).clamp(1, table.len() - 1) - 1;
    let length = table[i + 1] - table[i];
    (i, if length > 0.0 { ((value - table[i]) / length).clamp(0.0, 1.0) } else { 0.0 })
}
