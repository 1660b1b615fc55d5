//! A machine as numbers: axes, their limits, where the part sits.

use nalgebra::{Point3, Vector3};

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

/// A table-table machine with axes X Y Z A C.
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
    /// Least and largest spindle speed, rpm.
    pub spindle: [f64; 2],
    /// Speed of rapid moves of the tip that the planner assumes for times, mm/s.
    pub rapid: f64,
    /// Time between two positions that the control gives to its drives, s; between them each joint runs evenly.
    pub cycle: f64,
    /// Table and fixtures, which turn with the part.
    pub carried: Vec<Carried>,
    /// What its file marks as assumed.
    pub assumed: Vec<String>,
}

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

    /// The C axis in the part frame, x and y.
    pub fn turn_axis(&self) -> [f64; 2] {
        let at = self.turn_point.coords - self.part_origin;
        [at.x, at.y]
    }

    /// Largest angle between tool axis and Z of the part that the travel of A has, radians, on either of its branches.
    pub fn most_lean(&self) -> f64 {
        self.tilt.max.max(-self.tilt.min)
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
