//! A machine as numbers: its axes, their limits, and the position of the part.

use super::heights::{Ring, Swing, farthest};
use super::{Angles, AxisLine, Carried, Carries, Chain};
use crate::control::{LengthTo, ModuloWay, Planning};
use nalgebra::{Point3, Rotation3, Unit, Vector3};
use nurbs::bracket::Bracket;
use std::f64::consts::{PI, TAU};

/// A linear axis. Lengths in mm, speed in mm/s, acceleration in mm/s2, jerk in mm/s3.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct LinearAxis {
    /// Least position.
    pub min: f64,
    /// Largest position.
    pub max: f64,
    /// Largest speed.
    pub speed: f64,
    /// Largest acceleration.
    pub acceleration: f64,
    /// Largest jerk; infinite where the control has no limit.
    #[cfg_attr(feature = "serde", serde(with = "crate::unlimited::above"))]
    pub jerk: f64,
}

/// A rotary axis. Angles in radians in the ISO sense, speed in rad/s, acceleration in rad/s2, jerk in rad/s3.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct RotaryAxis {
    /// Its address in NC texts, from the machine file.
    pub name: String,
    /// Least position.
    #[cfg_attr(feature = "serde", serde(with = "crate::unlimited::below"))]
    pub min: f64,
    /// Largest position.
    #[cfg_attr(feature = "serde", serde(with = "crate::unlimited::above"))]
    pub max: f64,
    /// Largest speed.
    pub speed: f64,
    /// Largest acceleration.
    pub acceleration: f64,
    /// Largest jerk; infinite where the control has no limit.
    #[cfg_attr(feature = "serde", serde(with = "crate::unlimited::above"))]
    pub jerk: f64,
    /// +1 when the address of the machine has the ISO sense, -1 when it has the opposite sense.
    pub word_sign: f64,
    /// For an axis whose words the control reduces modulo 360 deg: the way that it takes. The travel of such an axis is
    /// infinite. A post writes its words from 0 to 360 deg, with what makes the control go the way of the motion.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serde::Deserialize::deserialize"))]
    pub modulo: Option<ModuloWay>,
    /// Words that clamp and unclamp the axis, for posts. A clamped axis must not move.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serde::Deserialize::deserialize"))]
    pub clamp: Option<[String; 2]>,
}

/// A machine with three linear and two rotary axes. Travel and heights of Z refer to the gauge line: the face of the
/// spindle that tool lengths are measured from.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Machine {
    /// Name of its file.
    pub name: String,
    /// X, Y, Z.
    pub linear: [LinearAxis; 3],
    /// The rotary axes: next to the tool, and next to the part.
    pub rotary: [RotaryAxis; 2],
    /// Positions of the rotary axes.
    pub chain: Chain,
    /// Origin of the part with the rotary axes at zero, machine frame.
    pub part_origin: Vector3<f64>,
    /// Retract height: height of the gauge line, machine frame, at which tools change, and at which all axes except Z
    /// move without tool centre point control; mm. No program begins with Z above it.
    pub retract: f64,
    /// Least and largest spindle speed, rpm.
    pub spindle: [f64; 2],
    /// Power of the spindle at the cutter, kW, where the machine file states it.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "serde::Deserialize::deserialize"))]
    pub power: Option<f64>,
    /// Speed of rapid moves of the tip that the planner assumes for times, mm/s.
    pub rapid: f64,
    /// Time between two positions that the control gives to its drives, s; between them each joint moves evenly.
    pub cycle: f64,
    /// How the control plans speeds.
    pub planning: Planning,
    /// Point that the lengths in the tool table of the control refer to. A post that writes positions of the tip refuses
    /// the centre.
    pub length_to: LengthTo,
    /// Positions of X, Y and Z at which the machine parks at the end of a program, mm, for posts: Z first up to the retract
    /// height. An axis without a value remains where it is.
    pub home: [Option<f64>; 3],
    /// Table and fixtures, which turn with the part.
    pub carried: Vec<Carried>,
    /// M words of the machine builder that change neither the path nor anything else that is checked, for posts.
    pub own_words: Vec<String>,
    /// Values that the machine file marks as assumed.
    pub assumed: Vec<String>,
}

/// Azimuths at which the reach of the rotary axes is tried, and steps of the angle to Z, radians.
const AZIMUTHS: usize = 360;
const TILT_STEP: f64 = PI / 180.0;
const TILT_HALVINGS: usize = 12;

/// Angle from axis 2 of the directions near it that are tried, radians.
const NEAR_POLE: f64 = 1e-3;

/// Excess over the travel of a rotary axis that is rounding, radians.
const ANGLE_ROUNDING: f64 = 1e-9;

/// Direction at an angle to Z, and one of [`AZIMUTHS`].
fn tilted(tilt: f64, azimuth: usize) -> Vector3<f64> {
    let (sine, cosine) = libm::sincos(tilt);
    let (y, x) = libm::sincos(TAU * azimuth as f64 / AZIMUTHS as f64);
    Vector3::new(sine * x, sine * y, cosine)
}

/// Share of the speed limits that plans for LinuxCNC use.
const BLENDED: f64 = 0.97;

impl LinearAxis {
    /// An axis without effective limits.
    pub const UNLIMITED: Self = Self { min: -1e6, max: 1e6, speed: 1e6, acceleration: 1e9, jerk: f64::INFINITY };
}

impl RotaryAxis {
    /// An axis without effective limits.
    pub fn unlimited(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            min: -1e3,
            max: 1e3,
            speed: 1e3,
            acceleration: 1e6,
            jerk: f64::INFINITY,
            word_sign: 1.0,
            modulo: None,
            clamp: None,
        }
    }
}

impl Machine {
    /// A machine without effective limits, for queries that need only the chain. The origin of the part is that of the
    /// machine frame.
    pub fn unlimited(chain: Chain) -> Self {
        Self {
            name: String::new(),
            linear: [LinearAxis::UNLIMITED; 3],
            rotary: ["A", "C"].map(RotaryAxis::unlimited),
            chain,
            part_origin: Vector3::zeros(),
            retract: 1e6,
            spindle: [1.0, 1e6],
            power: None,
            rapid: 1e6,
            cycle: 1.0,
            planning: Planning::Joints,
            length_to: LengthTo::Tip,
            home: [None; 3],
            carried: Vec::new(),
            own_words: Vec::new(),
            assumed: Vec::new(),
        }
    }

    /// Speed limits of X, Y, Z (mm/s) and of both rotary axes (rad/s).
    pub fn speeds(&self) -> [f64; 5] {
        let [x, y, z] = self.linear.map(|l| l.speed);
        [x, y, z, self.rotary[0].speed, self.rotary[1].speed]
    }

    /// The speeds for plans. LinuxCNC adds the end of a block and the start of the next one, and the sum may be faster
    /// than both: for LinuxCNC a share of the limits.
    pub fn planned_speeds(&self) -> [f64; 5] {
        let share = if self.planning == Planning::LinuxCnc { BLENDED } else { 1.0 };
        self.speeds().map(|speed| speed * share)
    }

    /// Travel of all axes, mm and radians; that of Z for the gauge line.
    pub fn travel(&self) -> [[f64; 2]; 5] {
        let [x, y, z] = [0, 1, 2].map(|k| [self.linear[k].min, self.linear[k].max]);
        let [first, second] = [0, 1].map(|k| [self.rotary[k].min, self.rotary[k].max]);
        [x, y, z, first, second]
    }

    /// Names of all axes.
    pub fn names(&self) -> [&str; 5] {
        ["X", "Y", "Z", &self.rotary[0].name, &self.rotary[1].name]
    }

    /// Index of the rotary axis with a name.
    pub fn rotary_axis(&self, name: &str) -> Option<usize> {
        self.rotary.iter().position(|axis| axis.name == name)
    }

    /// Where the axis of the table meets the x-y plane of the part frame, mm. The origin for a machine without a table,
    /// or with a table that does not turn about the Z axis of the part.
    pub fn table_axis(&self) -> [f64; 2] {
        let table = &self.chain.axes()[1];
        if table.carries == Carries::Tool || self.chain.directions_in_part()[1].z.abs() != 1.0 {
            return [0.0; 2];
        }
        let at = self.chain.part_axes().inverse() * (table.point.coords - self.part_origin);
        [at.x, at.y]
    }

    /// True when rotary axis 2 turns the part about its Z axis: places that are turned about this axis then have equal positions of
    /// X, Y and Z.
    pub fn turns_part_about_its_axis(&self) -> bool {
        let table = &self.chain.axes()[1];
        let along = self.chain.directions_in_part()[1].z.abs() == 1.0;
        table.carries == Carries::Part && along && self.table_axis() == [0.0; 2]
    }

    /// Largest angle between the tool and the Z axis of the part up to which the rotary axes give the tool every direction,
    /// radians. Where axis 2 turns about Z, it is the largest angle at all: `link-moves` chooses branch and winding for each
    /// pass, and refuses what the travel does not permit. For other axes azimuths of 1 deg decide: between two of them a corner
    /// of the travel may lie up to 1 deg nearer to Z.
    pub fn max_tilt(&self) -> f64 {
        let [first, _] = &self.rotary;
        let upright = self.chain.directions_in_part()[1].z;
        if upright.abs() == 1.0 {
            let ends = self.chain.polar_angle_range(first.min, first.max);
            return if upright > 0.0 { ends[1] } else { PI - ends[0] };
        }
        let near_poles = self.least_tilt_near_poles();
        let reached = |tilt: f64| tilt < near_poles && (0..AZIMUTHS).all(|k| self.reaches(&tilted(tilt, k)));
        let mut low = 0.0;
        while low + TILT_STEP <= PI && reached(low + TILT_STEP) {
            low += TILT_STEP;
        }
        Bracket { holds: low, fails: low + TILT_STEP }.halved(TILT_HALVINGS, reached).holds
    }

    /// Least angle to Z of the directions near axis 2 that the travel does not give the tool, radians. A gap in the travel of
    /// axis 2 begins at its direction with no width, so that few azimuths about Z would meet it.
    fn least_tilt_near_poles(&self) -> f64 {
        let second = self.chain.directions_in_part()[1];
        let poles = [second, -second];
        let around = poles.iter().flat_map(|pole| {
            let turn = Rotation3::rotation_between(&Vector3::z(), pole)
                .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), PI));
            (0..AZIMUTHS).map(move |k| turn * tilted(NEAR_POLE, k))
        });
        around.filter(|axis| !self.reaches(axis)).map(|axis| libm::acos(axis.z.clamp(-1.0, 1.0))).fold(PI, f64::min)
    }

    /// Whether the rotary axes give the tool a direction within their travel, on either branch and any winding.
    pub fn reaches(&self, tool_axis: &Vector3<f64>) -> bool {
        self.angles_within_travel(tool_axis).next().is_some()
    }

    /// The pairs of angles that give the tool a direction and have a winding within the travel of the rotary axes.
    pub(super) fn angles_within_travel(&self, tool_axis: &Vector3<f64>) -> impl Iterator<Item = Angles> + '_ {
        let within = |k: usize, angle: f64| {
            let RotaryAxis { min, max, .. } = self.rotary[k];
            // Whole turns that bring the angle over the lower end of the travel.
            angle + TAU * ((min - ANGLE_ROUNDING - angle) / TAU).ceil() <= max + ANGLE_ROUNDING || max - min >= TAU
        };
        let free = 0.0_f64.clamp(self.rotary[1].min, self.rotary[1].max);
        let pairs = self.chain.inverse(tool_axis, free);
        pairs.into_iter().flatten().filter(move |[first, second]| within(0, *first) && within(1, *second))
    }

    /// Largest height, machine frame, mm, that a solid about the Z axis of the part reaches under any angles of the
    /// rotary axes within their travel. `profile` holds its corners as (r, z) in the part frame, mm. The height is
    /// exact where no table tilts, and for two tables that turn about the vertical and about a horizontal axis. For others
    /// it is an upper bound, some hundredths of a millimetre over the largest height.
    pub fn highest(&self, profile: &[[f64; 2]]) -> f64 {
        if !self.chain.holds_part_upright() {
            return self.highest_off_upright(profile);
        }
        let [first, second] = self.chain.axes();
        let corners = |height: &dyn Fn(f64, f64) -> f64| {
            profile.iter().map(|[r, z]| height(*r, *z)).fold(f64::NEG_INFINITY, f64::max)
        };
        let upright = second.direction.z.abs() == 1.0;
        if second.carries == Carries::Tool {
            return self.part_origin.z + corners(&|_, z| z);
        }
        if first.carries == Carries::Tool && upright {
            return self.part_origin.z + corners(&|_, z| z);
        }
        if first.carries == Carries::Part && upright && first.direction.z == 0.0 {
            let [x, y] = self.table_axis();
            let eccentric = libm::hypot(x, y);
            // Horizontal direction, across the axis that tilts the table.
            let across = Vector3::z().cross(&first.direction);
            let across = across.dot(&(second.point - first.point));
            let above = self.part_origin.z - first.point.z;
            return first.point.z
                + corners(&|r, z| {
                    // A whole turn of the table takes a point to both sides of its axis.
                    let sides = [across - r - eccentric, across + r + eccentric];
                    sides.map(|y| self.risen(y, z + above)).into_iter().fold(f64::NEG_INFINITY, f64::max)
                });
        }
        let [x, y] = self.table_axis();
        let eccentric = libm::hypot(x, y);
        let rings: Vec<Ring> =
            profile.iter().map(|[r, z]| ((self.part_origin + Vector3::z() * *z).into(), r + eccentric)).collect();
        // A table turns opposite to its angle.
        let swings = self.swings(Carries::Part, [1, 0], |[min, max]| [-max, -min]);
        farthest(&swings, &Vector3::z(), &rings)
    }

    /// [`Self::highest`] for a part whose axis is not along Z with all axes at zero: an upper bound.
    fn highest_off_upright(&self, profile: &[[f64; 2]]) -> f64 {
        let to_part = self.chain.part_axes().inverse();
        let [x, y] = self.table_axis();
        let eccentric = libm::hypot(x, y);
        let origin = Point3::from(to_part * self.part_origin);
        let rings: Vec<Ring> = profile.iter().map(|[r, z]| (origin + Vector3::z() * *z, r + eccentric)).collect();
        // Rings count about Z: so the tables are turned into axes parallel to those of the part.
        let mut swings = self.swings(Carries::Part, [1, 0], |[min, max]| [-max, -min]);
        for swing in &mut swings {
            swing.direction = Unit::new_unchecked(to_part * swing.direction.into_inner());
            swing.point = to_part * swing.point;
        }
        farthest(&swings, &(to_part * Vector3::z()), &rings)
    }

    /// Directions of X, Y and Z of the part with all axes at zero, machine frame.
    pub fn part_directions(&self) -> [Vector3<f64>; 3] {
        let axes = self.chain.part_axes().matrix();
        [0, 1, 2].map(|k| axes.column(k).into())
    }

    /// The directions of a part that does not stand upright, in words.
    pub fn part_turned(&self) -> Option<String> {
        if self.chain.holds_part_upright() {
            return None;
        }
        // Without the sign of a zero.
        let [x, _, z] = self
            .part_directions()
            .map(|v| [v.x, v.y, v.z].map(|x| ((x * 1e6).round() / 1e6 + 0.0).to_string()).join(", "));
        Some(format!("Z of the part points along ({z}), X of the part along ({x})"))
    }

    /// The direction of the axis of a part that is clamped the other way, machine frame, where the rotary axes set the tool along
    /// this axis from below alone.
    pub fn reached_from_below(&self) -> Option<Vector3<f64>> {
        let up = Vector3::z();
        // Without the sign of a zero.
        (!self.reaches(&up) && self.reaches(&-up)).then(|| (self.chain.part_axes() * -up).map(|x| x + 0.0))
    }

    /// The machine with the part in the work frame of its control: its origin is that of the part, its axes are those of the
    /// machine with all axes at zero. The joints of a motion are the same; poses are in this frame.
    pub fn in_work_frame(&self) -> Self {
        Self { chain: self.chain.with_part(Rotation3::identity()), ..self.clone() }
    }

    /// Lowest height of any point of a tool under any angles of the head within their travel, mm, against the gauge line
    /// with the head upright. `profile` holds the corners of the whole tool as (r, s), s from the tip, and `length` is that
    /// of the tool, mm. Without a head the height is that of the tip; with a head it is a lower bound.
    pub fn lowest(&self, profile: &[[f64; 2]], length: f64) -> f64 {
        if !self.chain.has_head() {
            return -length;
        }
        let rings: Vec<Ring> = profile.iter().map(|[r, s]| (Point3::new(0.0, 0.0, s - length), *r)).collect();
        -farthest(&self.swings(Carries::Tool, [0, 1], |range| range), &-Vector3::z(), &rings)
    }

    /// The axes that carry the tool or the part, in an order from the innermost, each with the range of its turn.
    fn swings(&self, carries: Carries, order: [usize; 2], turn: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<Swing> {
        let axes = order.into_iter().map(|k| (self.chain.axes()[k], &self.rotary[k]));
        axes.filter(|(line, _)| line.carries == carries)
            .map(|(AxisLine { direction, point, .. }, axis)| Swing {
                direction,
                point,
                range: turn([axis.min, axis.max]),
            })
            .collect()
    }

    /// Largest height over the tilting axis, over the travel of this axis, of a point with a position across and above
    /// the axis at angle zero.
    fn risen(&self, across: f64, above: f64) -> f64 {
        let tilt = &self.rotary[0];
        let height = |a: f64| above * libm::cos(a) - across * libm::sin(a);
        let top = libm::atan2(-across, above);
        let ends = height(tilt.min).max(height(tilt.max));
        let turns = ((tilt.min - top) / TAU).ceil();
        if top + turns * TAU <= tilt.max { libm::hypot(across, above) } else { ends }
    }

    /// Upper bound of the turn of the tool against the part between angles, see [`Chain::turn`].
    pub fn turn(&self, from: Angles, to: Angles) -> f64 {
        self.chain.turn(from, to)
    }

    /// Acceleration limits of X, Y, Z (mm/s2) and of both rotary axes (rad/s2).
    pub fn accelerations(&self) -> [f64; 5] {
        let [x, y, z] = self.linear.map(|l| l.acceleration);
        [x, y, z, self.rotary[0].acceleration, self.rotary[1].acceleration]
    }

    /// Jerk limits of X, Y, Z (mm/s3) and of both rotary axes (rad/s3); infinite where the control has none.
    pub fn jerks(&self) -> [f64; 5] {
        let [x, y, z] = self.linear.map(|l| l.jerk);
        [x, y, z, self.rotary[0].jerk, self.rotary[1].jerk]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AxisLine;
    use crate::Pose;
    use nalgebra::Point3;
    use proptest::prelude::*;

    fn machine([min, max]: [f64; 2], lines: [AxisLine; 2], origin: [f64; 3]) -> Machine {
        let rotary = ["A", "C"].map(|name| RotaryAxis { min, max, ..RotaryAxis::unlimited(name) });
        Machine { rotary, part_origin: Vector3::from(origin), ..Machine::unlimited(Chain::new(lines).unwrap()) }
    }

    fn line(carries: Carries, direction: Vector3<f64>, point: [f64; 3]) -> AxisLine {
        AxisLine { carries, direction: Unit::new_normalize(direction), point: Point3::from(point) }
    }

    /// Largest height of a ring under all angles, by brute force.
    fn reached(m: &Machine, [low, high]: [f64; 2], r: f64, height: f64) -> f64 {
        let mut most = f64::NEG_INFINITY;
        for i in 0..=200 {
            let a = low + (high - low) * f64::from(i) / 200.0;
            for k in 0..360 {
                let turn = f64::from(k).to_radians();
                let p = Point3::new(r, 0.0, height);
                most = most.max((m.part_to_machine([a, turn]) * p).z);
            }
        }
        most
    }

    proptest! {
        /// The height is the maximum by brute force, for a table that tilts about any horizontal axis.
        #[test]
        fn highest_is_reached_and_not_passed(
            low in -2.0..0.0_f64, range in 0.1..3.0_f64, y in -30.0..30.0_f64, z in -30.0..30.0_f64,
            r in 1.0..80.0_f64, height in -60.0..60.0_f64, up in -40.0..40.0_f64, azimuth in prop_oneof![Just(0.0), -3.0..3.0_f64]
        ) {
            let tilt = Vector3::new(libm::cos(azimuth), libm::sin(azimuth), 0.0);
            let lines = [
                line(Carries::Part, tilt, [3.0, y, z]), line(Carries::Part, Vector3::z(), [5.0, -4.0, 0.0])
            ];
            let m = machine([low, low + range], lines, [5.0, -4.0, up]);
            let bound = m.highest(&[[r, height]]);
            let most = reached(&m, [low, low + range], r, height);
            prop_assert!(most <= bound + 1e-9 && most > bound - 0.05, "{most} {bound}");
        }

        /// Joints within the travel give a place that is within it; with X, Y or Z moved beyond the end it is not, where the
        /// angles are the only ones. A turn about the axis of the part changes nothing for a table about this axis.
        #[test]
        fn places_within_the_travel_are_reached(
            xyz in [-99.0..99.0_f64, -99.0..99.0, -99.0..99.0], a in 0.2..1.5_f64, c in -3.0..3.0_f64, out in 1.0..50.0_f64,
            k in 0..3_usize, turn in -3.0..3.0_f64
        ) {
            let lines = [line(Carries::Part, Vector3::x(), [0.0, 7.0, 5.0]), line(Carries::Part, Vector3::z(), [0.0; 3])];
            let mut m = machine([0.1, 1.6], lines, [0.0, 0.0, 9.0]);
            (m.rotary[1].min, m.rotary[1].max) = (-10.0, 10.0);
            for axis in &mut m.linear {
                (axis.min, axis.max) = (-100.0, 100.0);
            }
            let placed = |xyz: [f64; 3]| m.forward(&m.joints_at(&Vector3::from(xyz), [a, c], 30.0));
            let at = placed(xyz);
            prop_assert!(m.reaches_place(&at, 30.0, 0.0) && !m.reaches_place(&at, 30.0, 100.0));
            let about = Rotation3::from_axis_angle(&Vector3::z_axis(), turn);
            let turned = Pose { tip: about * at.tip, axis: about * at.axis };
            prop_assert!(m.turns_part_about_its_axis());
            let [one, other] = [at, turned].map(|at| m.farthest_out(&at, 30.0).map_or(f64::NAN, |x| x.2));
            prop_assert!((one - other).abs() < 1e-9, "{one} {other}");
            let mut beyond = xyz;
            beyond[k] = 100.0 + out;
            let (which, position, by) = m.farthest_out(&placed(beyond), 30.0).unwrap();
            prop_assert!(which == k && (position - beyond[k]).abs() < 1e-9 && (by - out).abs() < 1e-9);
        }

        /// For other tables the height is an upper bound.
        #[test]
        fn highest_is_not_passed_by_any_table(
            first in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], second in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0],
            point in [-50.0..50.0_f64, -50.0..50.0, -50.0..50.0], head in any::<bool>(), r in 1.0..80.0_f64,
            part in prop_oneof![Just([0.0; 3]), [-3.0..3.0_f64, -1.5..1.5, -3.0..3.0]]
        ) {
            let [k1, k2] = [first, second].map(Vector3::from);
            prop_assume!(k1.norm() > 0.1 && k2.norm() > 0.1);
            let carries = if head { Carries::Tool } else { Carries::Part };
            let lines = [line(carries, k1, point), line(Carries::Part, k2, [1.0, 2.0, 3.0])];
            prop_assume!(Chain::new(lines).is_ok());
            let mut m = machine([-2.0, 2.0], lines, [5.0, -4.0, 9.0]);
            m.chain = m.chain.with_part(Rotation3::from_euler_angles(part[0], part[1], part[2]));
            let bound = m.highest(&[[r, 20.0]]);
            // Both axes within their travel, and each point of the ring.
            let mut most = f64::NEG_INFINITY;
            for (i, k) in (0..=60).flat_map(|i| (0..=60).map(move |k| (i, k))) {
                let turned = m.part_to_machine([i, k].map(|i| -2.0 + f64::from(i) / 15.0));
                let up = turned.rotation.inverse() * Vector3::z();
                most = most.max((turned * Point3::new(0.0, 0.0, 20.0)).z + r * libm::hypot(up.x, up.y));
            }
            prop_assert!(most <= bound + 1e-9 && most > bound - 0.3, "{most} {bound}");
        }

        /// The lowest point of a tool is that by brute force, for heads of one and of two axes.
        #[test]
        fn lowest_is_reached_and_not_passed(
            first in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], second in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0],
            point in [-50.0..50.0_f64, -50.0..50.0, 100.0..250.0], two in any::<bool>(),
            low in -2.0..0.5_f64, range in 0.1..3.0_f64, r in 1.0..30.0_f64, length in 40.0..200.0_f64
        ) {
            let [k1, k2] = [first, second].map(Vector3::from);
            prop_assume!(k1.norm() > 0.1 && k2.norm() > 0.1);
            let carries = if two { Carries::Tool } else { Carries::Part };
            let lines = [line(Carries::Tool, k1, point), line(carries, k2, [4.0, -3.0, 180.0])];
            prop_assume!(Chain::new(lines).is_ok());
            let m = machine([low, low + range], lines, [0.0; 3]);
            let bound = m.lowest(&[[r, 0.0], [r, length]], length);
            let mut least = f64::INFINITY;
            let steps = if two { 60 } else { 0 };
            for (i, k) in (0..=60).flat_map(|i| (0..=steps).map(move |k| (i, k))) {
                let rotary = [i, k].map(|i| low + range * f64::from(i) / 60.0);
                let turned = m.chain.tool(rotary);
                for turn in 0..90 {
                    let (sine, cosine) = libm::sincos(f64::from(turn) * TAU / 90.0);
                    for z in [-length, 0.0] {
                        least = least.min((turned * Point3::new(r * cosine, r * sine, z)).z);
                    }
                }
            }
            prop_assert!(bound <= least + 1e-9 && bound > least - 0.5, "{bound} {least}");
        }

        /// A part that is turned on any machine is where plain vectors put it that are all turned back with it, and its poses
        /// come back.
        #[test]
        fn a_turned_part_is_a_machine_turned_the_other_way(
            first in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], second in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0],
            point in [-50.0..50.0_f64, -50.0..50.0, -50.0..50.0], heads in 0..3_usize,
            part in [-3.0..3.0_f64, -1.5..1.5, -3.0..3.0], angles in [-3.0..3.0_f64, -3.0..3.0],
            tip in [-60.0..60.0_f64, -60.0..60.0, -60.0..60.0]
        ) {
            let [k1, k2] = [first, second].map(Vector3::from);
            prop_assume!(k1.norm() > 0.1 && k2.norm() > 0.1);
            let carries = |k: usize| if k < heads { Carries::Tool } else { Carries::Part };
            let lines = [line(carries(0), k1, point), line(carries(1), k2, [4.0, -3.0, 80.0])];
            prop_assume!(Chain::new(lines).is_ok());
            let mut m = machine([-9.0, 9.0], lines, [5.0, -4.0, 9.0]);
            let turn = Rotation3::from_euler_angles(part[0], part[1], part[2]);
            m.chain = m.chain.with_part(turn);
            let pose = Pose { tip: Point3::from(tip), axis: m.chain.tool_axis(angles) };
            // All of the machine turned back: the part stands along Z, the tool does not.
            let back = turn.inverse();
            let about = |k: usize, p: Point3<f64>| {
                let at = back * lines[k].point;
                at + Rotation3::from_axis_angle(&(back * lines[k].direction), angles[k]) * (p - at)
            };
            let joints = m.joints(&pose.tip, angles);
            // The tip, and a point of the tool above it: tables turn the part against their angles.
            let tool = (0..2).fold(back * Vector3::z(), |v, k| {
                Rotation3::from_axis_angle(&(back * lines[k].direction), angles[k]) * v
            });
            let at = (heads.min(2)..2).fold(back * Point3::from(joints.xyz), |p, k| about(k, p)) - back * m.part_origin;
            prop_assert!((at - pose.tip).norm() < 1e-9 && (tool - pose.axis).norm() < 1e-9, "{at} {tool}");
            let found = m.chain.inverse(&pose.axis, angles[1]);
            prop_assert!(found.is_some());
            for rotary in found.unwrap() {
                let again = m.forward(&m.joints(&pose.tip, rotary));
                prop_assert!((again.tip - pose.tip).norm() < 1e-9 && (again.axis - pose.axis).norm() < 1e-7);
            }
            // The same joints in the work frame: the pose is turned.
            let words = m.in_work_frame().forward(&joints);
            prop_assert!((words.tip - turn * pose.tip).norm() < 1e-9 && (words.axis - turn * pose.axis).norm() < 1e-9);
        }

        /// A turn of the part about Z is a turn of the machine about Z, which needs no turned part.
        #[test]
        fn a_part_turned_about_z_has_the_joints_of_a_turned_machine(
            first in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], second in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0],
            heads in 0..3_usize, turn in -3.0..3.0_f64, angles in [-3.0..3.0_f64, -3.0..3.0],
            tip in [-60.0..60.0_f64, -60.0..60.0, -60.0..60.0]
        ) {
            let [k1, k2] = [first, second].map(Vector3::from);
            prop_assume!(k1.norm() > 0.1 && k2.norm() > 0.1);
            let carries = |k: usize| if k < heads { Carries::Tool } else { Carries::Part };
            let lines = [line(carries(0), k1, [7.0, 1.0, 2.0]), line(carries(1), k2, [4.0, -3.0, 80.0])];
            prop_assume!(Chain::new(lines).is_ok());
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), turn);
            let back = turn.inverse();
            let mut m = machine([-9.0, 9.0], lines, [5.0, -4.0, 9.0]);
            m.chain = m.chain.with_part(turn);
            let turned = lines.map(|l| AxisLine { direction: back * l.direction, point: back * l.point, ..l });
            let other = machine([-9.0, 9.0], turned, (back * m.part_origin).into());
            let axis = other.chain.tool_axis(angles);
            let tip = Point3::from(tip);
            let [a, b] = [&m, &other].map(|m| m.joints(&tip, angles).xyz);
            prop_assert!((back * a - b).norm() < 1e-9 && (m.chain.tool_axis(angles) - axis).norm() < 1e-12);
            let [a, b] = [&m, &other].map(|m| m.chain.inverse(&axis, 0.3).unwrap());
            let apart = (0..2).map(|k| crate::most_turn(a[k], b[k])).fold(0.0, f64::max);
            // At the poles of axis 2 its angle is free.
            let pole = axis.cross(&other.chain.axes()[1].direction).norm();
            prop_assert!(pole < 1e-3 || apart < 1e-6 || (apart - TAU).abs() < 1e-6, "{a:?} {b:?}");
            let reach = [&m, &other].map(|m| [m.max_tilt(), m.highest(&[[30.0, 20.0]])]);
            prop_assert!((reach[0][0] - reach[1][0]).abs() < 0.03, "{reach:?}");
            prop_assert!((reach[0][1] - reach[1][1]).abs() < 0.1, "{reach:?}");
        }

        /// Up to this angle every direction is reached within the travel, and not every one a little beyond.
        #[test]
        fn max_tilt_is_the_largest_cone(
            nutating in -0.9..0.9_f64, level in any::<bool>(), low in -2.5..-0.2_f64, range in 0.3..5.0_f64
        ) {
            let [k1, k2] = if level {
                [Vector3::x(), Vector3::y()]
            } else {
                [Vector3::new(0.0, libm::cos(nutating), libm::sin(nutating)), Vector3::z()]
            };
            let lines = [line(Carries::Tool, k1, [0.0; 3]), line(Carries::Tool, k2, [0.0; 3])];
            let mut m = machine([low, low + range], lines, [0.0; 3]);
            if !level {
                prop_assume!(low + range > 0.05);
                (m.rotary[1].min, m.rotary[1].max) = (-10.0, 10.0);
            }
            let most = m.max_tilt();
            let all = |tilt: f64| (0..1000).all(|k| {
                let (sine, cosine) = libm::sincos(tilt);
                let (y, x) = libm::sincos(f64::from(k) * TAU / 1000.0);
                m.reaches(&Vector3::new(sine * x, sine * y, cosine))
            });
            prop_assert!(most < 0.01 || all(0.5 * most) && all(most - PI / 180.0), "{most}");
            // At the pole a gap has no width: a little beyond it has.
            prop_assert!(most > PI - 0.05 || !all(most + 0.03), "{most}");
        }

        /// A tool that hangs from its positions is where the joints put it, and comes back to its positions.
        #[test]
        fn positions_and_joints_are_inverse(
            angles in [-1.5..1.5_f64, -3.0..3.0], xyz in [-50.0..50.0_f64, -50.0..50.0, -50.0..50.0],
            length in 20.0..200.0_f64, z in 300.0..600.0_f64
        ) {
            let lines = [
                line(Carries::Tool, Vector3::new(0.0, 1.0, 1.0), [3.0, 2.0, 150.0]),
                line(Carries::Part, Vector3::z(), [0.0; 3])
            ];
            let m = machine([-2.0, 2.0], lines, [0.0; 3]);
            let joints = m.joints_at(&Vector3::from(xyz), angles, length);
            let positions = m.positions(&joints, length);
            prop_assert!((0..3).all(|k| (positions[k] - xyz[k]).abs() < 1e-9));
            let raised = m.positions(&m.at_height(&joints, z, length), length);
            prop_assert!((raised[2] - z).abs() < 1e-9 && (0..2).all(|k| (raised[k] - xyz[k]).abs() < 1e-9));
        }

        /// With a head, gauge line and tool follow the angles: the tip is where the joints put it.
        #[test]
        fn positions_carry_the_tool(
            angles in [-1.5..1.5_f64, -3.0..3.0], tip in [-50.0..50.0_f64, -50.0..50.0, -50.0..50.0],
            pivot in 50.0..300.0_f64, length in 20.0..200.0_f64
        ) {
            let lines = [
                line(Carries::Tool, Vector3::new(1.0, 0.0, 1.0), [0.0, 0.0, pivot]),
                line(Carries::Tool, Vector3::z(), [0.0, 0.0, pivot])
            ];
            let m = machine([-2.0, 2.0], lines, [0.0; 3]);
            let tip = Point3::from(tip);
            let joints = m.joints(&tip, angles);
            let [x, y, z, ..] = m.positions(&joints, length);
            // From the gauge line through the pivot, by vectors.
            let axis = m.chain.tool_axis(angles);
            let pivoted = Point3::new(x, y, z + pivot) - axis * (pivot + length);
            prop_assert!((pivoted - tip).norm() < 1e-9, "{pivoted} {tip}");
        }
    }
}
