//! How fast the joints move within a block, bounded by proof and not by samples.

use super::{Joints, Machine};
use nalgebra::{Rotation3, Vector3};

/// Turn of A and C together over which the speed of a joint is taken between two exact values, radians: the proof adds
/// less than a thousandth of the speeds that those of tip, A and C add up from.
const CELL_TURN: f64 = 0.015;

/// Most cells of a block. Blocks that turn farther are bounded as well, but less closely.
const MOST_CELLS: f64 = 2000.0;

impl Machine {
    /// Upper bounds of |dq/ds| of X, Y, Z (mm), A and C (radians) over a block, s running evenly from 0 to 1: the tip
    /// straight on the part, A and C linear.
    ///
    /// In cells of s the exact speeds at both ends are taken; between them a speed lies over its chord by at most h^2/8
    /// times the largest third derivative of the joint, which the lever arms bound in closed form.
    pub fn largest_rates(&self, from: &Joints, to: &Joints) -> [f64; 5] {
        let [start, end] = [from, to].map(|j| self.forward(j).tip.coords + self.part_origin - self.turn_point.coords);
        let way = end - start;
        let (tilt, turn) = (to.a - from.a, to.c - from.c);
        let lever = self.turn_point - self.tilt_point;
        let count = ((tilt.abs() + turn.abs()) / CELL_TURN).ceil().clamp(1.0, MOST_CELLS);
        // Speeds of X, Y, Z: u turns with C, u + lever with A. Both rotations are those of the table, against the words.
        let rates = |s: f64| {
            let carried = Rotation3::from_axis_angle(&Vector3::z_axis(), -(from.c + turn * s));
            let tilted = Rotation3::from_axis_angle(&Vector3::x_axis(), -(from.a + tilt * s));
            let u = carried * (start + way * s);
            let of_u = carried * way - Vector3::z().cross(&u) * turn;
            tilted * (of_u - Vector3::x().cross(&(u + lever)) * tilt)
        };
        let (tilt, turn) = (tilt.abs(), turn.abs());
        let (speed, reach) = (way.norm(), start.norm().max(end.norm()));
        let [first, second, third] =
            [speed + turn * reach, turn * (2.0 * speed + turn * reach), turn * turn * (3.0 * speed + turn * reach)];
        let all = tilt.powi(3) * (reach + lever.norm()) + 3.0 * tilt * tilt * first + 3.0 * tilt * second + third;
        let between = all / (8.0 * count * count);
        let mut most = Vector3::zeros();
        for k in 0..=count as usize {
            most = most.sup(&rates(k as f64 / count).abs());
        }
        [most.x + between, most.y + between, most.z + between, tilt, turn]
    }

    /// Least time of a block that runs evenly and keeps the speed of every axis, s. At this time no axis is over its limit
    /// anywhere in the block.
    pub fn least_time(&self, from: &Joints, to: &Joints) -> f64 {
        self.time_within(self.speeds(), from, to)
    }

    /// The same within the speeds that a plan uses ([`Machine::planned_speeds`]), s.
    pub fn planned_time(&self, from: &Joints, to: &Joints) -> f64 {
        self.time_within(self.planned_speeds(), from, to)
    }

    fn time_within(&self, speeds: [f64; 5], from: &Joints, to: &Joints) -> f64 {
        self.largest_rates(from, to).iter().zip(speeds).map(|(rate, speed)| rate / speed).fold(0.0, f64::max)
    }
}
