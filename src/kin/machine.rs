//! A machine as numbers: axes, their limits, where the part sits.

use crate::method::Planning;
use nalgebra::{Point3, Vector3};
use std::f64::consts::TAU;

/// A linear axis. Lengths in mm, speed in mm/s, acceleration in mm/s2, jerk in mm/s3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearAxis {
    /// Least position.
    pub min: f64,
    /// Largest position.
    pub max: f64,
    /// Largest speed.
    pub speed: f64,
    /// Largest acceleration.
    pub acceleration: f64,
    /// Largest change of acceleration a second; infinite where the control has no limit.
    pub jerk: f64,
}

/// A rotary axis. Angles in radians in the ISO sense, speed in rad/s, acceleration in rad/s2, jerk in rad/s3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotaryAxis {
    /// Least position.
    pub min: f64,
    /// Largest position.
    pub max: f64,
    /// Largest speed.
    pub speed: f64,
    /// Largest acceleration.
    pub acceleration: f64,
    /// Largest change of acceleration a second; infinite where the control has no limit.
    pub jerk: f64,
    /// +1 when the machine's word has the ISO sense, -1 when it has the opposite.
    pub word_sign: f64,
}

/// A table-table machine with axes X Y Z A C. Positions of Z, where a travel or a height is given, are those of the gauge
/// line: the face of the spindle that tool lengths are measured from.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// Name of its file.
    pub name: String,
    /// X, Y, Z.
    pub linear: [LinearAxis; 3],
    /// A, about machine X.
    pub tilt: RotaryAxis,
    /// C, about machine Z at A = 0, carried by A.
    pub turn: RotaryAxis,
    /// A point of the A axis, machine frame.
    pub tilt_point: Point3<f64>,
    /// A point of the C axis at A = 0, machine frame.
    pub turn_point: Point3<f64>,
    /// Origin of the part at A = C = 0, machine frame.
    pub part_origin: Vector3<f64>,
    /// Height of the gauge line, machine frame, at which tools are changed, and at which X, Y, A and C move with tool centre
    /// point control off; mm. No program begins with Z above it.
    pub retract: f64,
    /// Least and largest spindle speed, rpm.
    pub spindle: [f64; 2],
    /// Speed of rapid moves of the tip that the planner assumes for times, mm/s.
    pub rapid: f64,
    /// Time between two positions that the control gives to its drives, s; between them each joint runs evenly.
    pub cycle: f64,
    /// How the control plans speeds.
    pub planning: Planning,
    /// Table and fixtures, which turn with the part.
    pub carried: Vec<Carried>,
    /// What its file marks as assumed.
    pub assumed: Vec<String>,
}

/// Share of the limits of speed that plans for LinuxCNC use.
const BLENDED: f64 = 0.97;

/// A solid of revolution about the C axis that turns with the part.
#[derive(Clone, Debug, PartialEq)]
pub struct Carried {
    /// `table` or `fixture`.
    pub name: &'static str,
    /// Outside as (r, z), straight between the points, from the axis at its top to the axis at its bottom; mm, z in the
    /// part frame.
    pub profile: Vec<[f64; 2]>,
}

impl Machine {
    /// Speed limits of X, Y, Z (mm/s), A and C (rad/s).
    pub fn speeds(&self) -> [f64; 5] {
        let [x, y, z] = self.linear.map(|l| l.speed);
        [x, y, z, self.tilt.speed, self.turn.speed]
    }

    /// The speeds that a plan uses. LinuxCNC adds up the end of a block and the start of the next one, and the sum may be
    /// faster than both: there, a share of the limits.
    pub fn planned_speeds(&self) -> [f64; 5] {
        let share = if self.planning == Planning::LinuxCnc { BLENDED } else { 1.0 };
        self.speeds().map(|speed| speed * share)
    }

    /// The C axis in the part frame, x and y.
    pub fn turn_axis(&self) -> [f64; 2] {
        let at = self.turn_point.coords - self.part_origin;
        [at.x, at.y]
    }

    /// Largest angle between tool axis and Z of the part that the travel of A has, radians, on either of its branches.
    pub fn most_lean(&self) -> f64 {
        self.tilt.max.max(-self.tilt.min)
    }

    /// Largest height, machine frame, mm, that a solid about the Z axis of the part reaches under any A and C of their
    /// travel. `profile` holds its corners as (r, z) in the part frame, mm.
    pub fn highest(&self, profile: &[[f64; 2]]) -> f64 {
        let [x, y] = self.turn_axis();
        let eccentric = libm::hypot(x, y);
        let beside = self.turn_point.y - self.tilt_point.y;
        let above = self.part_origin.z - self.tilt_point.z;
        let corner = |[r, z]: [f64; 2]| {
            // A whole turn of C takes a point to both sides of the C axis.
            let sides = [beside - r - eccentric, beside + r + eccentric];
            sides.map(|y| self.risen(y, z + above)).into_iter().fold(f64::NEG_INFINITY, f64::max)
        };
        self.tilt_point.z + profile.iter().map(|p| corner(*p)).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Largest height over the A axis of a point beside and above it (at A = 0) over the travel of A.
    fn risen(&self, beside: f64, above: f64) -> f64 {
        let height = |a: f64| above * libm::cos(a) - beside * libm::sin(a);
        let top = libm::atan2(-beside, above);
        let ends = height(self.tilt.min).max(height(self.tilt.max));
        let turns = ((self.tilt.min - top) / TAU).ceil();
        if top + turns * TAU <= self.tilt.max { libm::hypot(beside, above) } else { ends }
    }

    /// Acceleration limits of X, Y, Z (mm/s2), A and C (rad/s2).
    pub fn accelerations(&self) -> [f64; 5] {
        let [x, y, z] = self.linear.map(|l| l.acceleration);
        [x, y, z, self.tilt.acceleration, self.turn.acceleration]
    }

    /// Jerk limits of X, Y, Z (mm/s3), A and C (rad/s3); infinite where the control has none.
    pub fn jerks(&self) -> [f64; 5] {
        let [x, y, z] = self.linear.map(|l| l.jerk);
        [x, y, z, self.tilt.jerk, self.turn.jerk]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn machine(travel: [f64; 2], tilt_point: [f64; 3], turn_point: [f64; 3], origin: [f64; 3]) -> Machine {
        let linear = LinearAxis { min: -1e3, max: 1e3, speed: 1.0, acceleration: 1.0, jerk: 1.0 };
        let rotary =
            RotaryAxis { min: travel[0], max: travel[1], speed: 1.0, acceleration: 1.0, jerk: 1.0, word_sign: 1.0 };
        Machine {
            name: String::new(),
            linear: [linear; 3],
            tilt: rotary,
            turn: rotary,
            tilt_point: Point3::from(tilt_point),
            turn_point: Point3::from(turn_point),
            part_origin: Vector3::from(origin),
            retract: 1e3,
            spindle: [1.0, 2.0],
            rapid: 1.0,
            cycle: 1.0,
            planning: Planning::Joints,
            carried: Vec::new(),
            assumed: Vec::new(),
        }
    }

    proptest! {
        /// No point of the solid comes higher, and some point comes as high, by brute force over A and C.
        #[test]
        fn highest_is_reached_and_not_passed(
            low in -2.0..0.0_f64, range in 0.1..3.0_f64, y in -30.0..30.0_f64, z in -30.0..30.0_f64,
            r in 1.0..80.0_f64, height in -60.0..60.0_f64, up in -40.0..40.0_f64
        ) {
            let m = machine([low, low + range], [3.0, y, z], [5.0, -4.0, 0.0], [5.0, -4.0, up]);
            let bound = m.highest(&[[r, height]]);
            let mut most = f64::NEG_INFINITY;
            for i in 0..=200 {
                let a = low + range * f64::from(i) / 200.0;
                for k in 0..360 {
                    let turn = f64::from(k).to_radians();
                    let p = Point3::new(r, 0.0, height);
                    most = most.max((m.part_to_machine(a, turn) * p).z);
                }
            }
            prop_assert!(most <= bound + 1e-9 && most > bound - 0.05, "{most} {bound}");
        }
    }
}
