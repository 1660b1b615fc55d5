//! How fast the joints move within a block, bounded by proof and not by samples.

use super::{Joints, Machine};
use nalgebra::{Rotation3, Vector3};

/// Turn of A and C together over which the speed of a joint is taken between two exact values, radians: the proof adds
/// less than a ten-thousandth of the speed.
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
        self.largest_rates(from, to).iter().zip(self.speeds()).map(|(rate, speed)| rate / speed).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kin::{LinearAxis, RotaryAxis};
    use nalgebra::Point3;
    use proptest::prelude::*;

    fn machine() -> Machine {
        let linear = LinearAxis { min: -500.0, max: 500.0, speed: 20.0, acceleration: 300.0, jerk: f64::INFINITY };
        let rotary =
            RotaryAxis { min: -9.0, max: 9.0, speed: 0.5, acceleration: 5.0, jerk: f64::INFINITY, word_sign: 1.0 };
        Machine {
            name: "test".to_owned(),
            linear: [linear; 3],
            tilt: rotary,
            turn: rotary,
            tilt_point: Point3::new(3.0, 20.0, 10.0),
            turn_point: Point3::new(-2.0, 1.0, 0.0),
            part_origin: Vector3::new(0.0, 0.0, 50.0),
            retract: 1e3,
            spindle: [1.0, 2.0],
            rapid: 20.0,
            cycle: 0.001,
            carried: Vec::new(),
            assumed: Vec::new(),
        }
    }

    proptest! {
        /// No sample of a dense one is over the bound, and the bound is hardly over the samples.
        #[test]
        fn no_sample_of_the_joints_is_faster_than_the_bound(
            tip in prop::array::uniform3(-80.0..80.0_f64), way in prop::array::uniform3(-1.0..1.0_f64),
            length in 0.0..200.0_f64, a in -1.5..1.5_f64, c in -6.0..6.0_f64,
            tilt in -2.0..2.0_f64, turn in -7.0..7.0_f64, share in 0.0..1.0_f64,
        ) {
            let machine = machine();
            let (tip, way) = (Point3::from(tip), Vector3::from(way) * length);
            let at = |s: f64| machine.joints(&(tip + way * s), a + tilt * share * s, c + turn * share * s);
            let found = machine.largest_rates(&at(0.0), &at(1.0));
            let mut most = [0.0_f64; 5];
            let places = 4000;
            for k in 0..places {
                let [p, q] = [k, k + 1].map(|k| at(f64::from(k) / f64::from(places)));
                let d = (q.xyz - p.xyz).abs() * f64::from(places);
                let [a, c] = [q.a - p.a, q.c - p.c].map(|d| d.abs() * f64::from(places));
                for (most, d) in most.iter_mut().zip([d.x, d.y, d.z, a, c]) {
                    *most = most.max(d);
                }
            }
            let scale = most.iter().fold(1e-9_f64, |m, x| m.max(*x));
            for (found, most) in found.iter().zip(most) {
                prop_assert!(most <= found + 1e-9 * scale, "{found} {most}");
                prop_assert!(found - most <= 1e-3 * scale, "{found} {most}");
            }
        }
    }
}
