//! The two rotary axes of a five-axis machine as a chain between tool and part.
//!
//! Axis 1 is next to the tool, axis 2 is next to the part. Each axis carries the tool (head) or the part (table), so
//! that there are three kinds of chain:
//!
//! | kind | axis 1 | axis 2 |
//! |---|---|---|
//! | table-table | carries axis 2 and the part | carries the part |
//! | head-table | carries the tool | carries the part |
//! | head-head | carries the tool | carries axis 1 and the tool |
//!
//! Angles are in radians. A positive angle turns the tool relative to the part as a right-hand screw along the
//! direction of the axis; a table turns the other way. In all three kinds the tool axis in the part frame is therefore
//! R(k2, q2) R(k1, q1) z, where z is the tool axis with both angles at zero. One solution by subproblems is valid for
//! any two directions that are not parallel (Paden and Kahan; Murray, Li and Sastry, A Mathematical Introduction to
//! Robotic Manipulation, 1994, 3.3).

#[cfg(feature = "serde")]
use nalgebra::Matrix3;
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use nurbs::angle::nearest_turn;
use std::f64::consts::{PI, TAU};

/// Angles of both rotary axes, radians: axis 1 next to the tool, axis 2 next to the part.
pub type Angles = [f64; 2];

/// What a rotary axis carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Carries {
    /// The tool: the axis is part of the head.
    Tool,
    /// The part: the axis is a table.
    Part,
}

/// Position of a rotary axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct AxisLine {
    /// Tool or part.
    pub carries: Carries,
    /// Direction, machine frame, with all rotary axes at zero.
    pub direction: Unit<Vector3<f64>>,
    /// A point on the axis, machine frame, with all axes at zero, mm.
    pub point: Point3<f64>,
}

/// Largest sine of an angle between directions that count as parallel.
const PARALLEL_SINE: f64 = 1e-6;

/// Distance of a unit vector from a direction below which the azimuth about that direction is rounding noise.
const POLE: f64 = 1e-12;

/// Largest amount by which the square of a sine falls below zero through rounding.
const SINE_SQUARE_ROUNDING: f64 = 1e-12;

/// Two rotary axes with values derived from their directions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "StoredChain", into = "StoredChain")
)]
pub struct Chain {
    axes: [AxisLine; 2],
    /// The axes of the part with all axes at zero, machine frame: its columns.
    part_axes: Rotation3<f64>,
    /// Directions of both axes with all axes at zero, part frame. All values below are in this frame too.
    directions: [Unit<Vector3<f64>>; 2],
    /// Cosine of the angle between both directions; exactly zero at a right angle.
    cosine: f64,
    /// The tool axis at zero: its component along axis 1, its component across, and the derivative of the latter by the
    /// turn.
    along: Vector3<f64>,
    across: Vector3<f64>,
    aside: Vector3<f64>,
    /// Component of the tool axis along axis 2 over the angle q of axis 1: `mean + swing * cos(q - start)`.
    mean: f64,
    swing: f64,
    start: f64,
    /// Two directions across axis 2, from which azimuths about it count.
    basis: [Vector3<f64>; 2],
    turning: Turning,
}

/// What defines a chain: all other values of it follow.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredChain {
    axes: [AxisLine; 2],
    part_axes: Rotation3<f64>,
}

#[cfg(feature = "serde")]
impl From<Chain> for StoredChain {
    fn from(chain: Chain) -> Self {
        Self { axes: chain.axes, part_axes: chain.part_axes }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<StoredChain> for Chain {
    type Error = String;

    fn try_from(StoredChain { axes, part_axes }: StoredChain) -> Result<Self, String> {
        /// Largest difference of a product of unit vectors from its value that is rounding.
        const UNIT_PRODUCT_ROUNDING: f64 = 1e-9;
        for axis in &axes {
            if axis.direction.iter().chain(axis.point.iter()).any(|x| !x.is_finite()) {
                return Err("a rotary axis has a number that is not finite".to_owned());
            }
            if (axis.direction.norm() - 1.0).abs() >= UNIT_PRODUCT_ROUNDING {
                return Err("the direction of a rotary axis has not the length 1".to_owned());
            }
        }
        let matrix = part_axes.matrix();
        let off = (matrix.transpose() * matrix - Matrix3::identity()).amax();
        let finite = matrix.iter().all(|x| x.is_finite());
        if !finite || off >= UNIT_PRODUCT_ROUNDING || matrix.determinant() <= 0.0 {
            return Err("the axes of the part are no right-handed frame".to_owned());
        }
        let chain = Self::new(axes).map_err(|fault| {
            let reason = match fault {
                ChainFault::Parallel => "the rotary axes are parallel",
                ChainFault::AlongTool => "rotary axis 1 is parallel to the tool",
                ChainFault::Order => "rotary axis 1 carries the part and rotary axis 2 carries the tool",
            };
            reason.to_owned()
        })?;
        Ok(chain.with_part(part_axes))
    }
}

/// Upper bounds of the motion of the tool axis while both rotary axes turn evenly, as factors of powers of
/// [`Chain::turn`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turning {
    /// For the second derivative of a direction that turns with the tool, factor of the square: 3/2 at a right angle.
    pub second: f64,
    /// For its third derivative, factor of the cube: 3 at a right angle.
    pub third: f64,
    /// For the second derivative of the shortest rotation that takes the tool axis along, factor of the square.
    pub shortest: f64,
}

impl Turning {
    /// The bounds for axes at a right angle.
    pub const RIGHT_ANGLE: Self = Self { second: 1.5, third: 3.0, shortest: Self::GOLDEN };

    /// Slightly more than (1 + sqrt 5) / 2; `TangentTwist` in `verify/proof/piece.rs` gives the reason.
    const GOLDEN: f64 = 1.6181;

    /// The bounds for a cosine of the angle between both axes.
    ///
    /// With the angular velocity w and the angular acceleration w', the second derivative of a direction is at most
    /// w^2 + |w'|. The acceleration is the cross product of both angular velocities. For a given rate it is largest where
    /// both are equal and opposed: sin / (2 (1 - |cos|)) w^2. The third derivative is at most the cube of the sum of
    /// both rates, and this sum is at most sqrt(2 / (1 - |cos|)) w.
    fn new(cosine: f64) -> Self {
        if cosine == 0.0 {
            return Self::RIGHT_ANGLE;
        }
        let sine = (1.0 - cosine * cosine).sqrt();
        let narrow = 1.0 - cosine.abs();
        let acceleration = 0.5 * sine / narrow;
        Self {
            second: 1.0 + acceleration,
            third: 3.0 / (narrow * narrow.sqrt()),
            // The axis across w changes by at most half of w^2, plus the acceleration.
            shortest: 1.5 + acceleration,
        }
    }
}

/// Why two axes do not form a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChainFault {
    /// The axes are parallel: the tool could not take every direction.
    Parallel,
    /// Axis 1 is parallel to the tool: it would turn the tool about itself.
    AlongTool,
    /// The axis next to the tool carries the part, and the axis next to the part carries the tool.
    Order,
}

/// A vector rotated about a unit vector by an angle in radians.
fn turned(about: &Vector3<f64>, v: &Vector3<f64>, angle: f64) -> Vector3<f64> {
    let (sine, cosine) = libm::sincos(angle);
    let along = about * about.dot(v);
    along + (v - along) * cosine + about.cross(v) * sine
}

impl Chain {
    /// Chain from the axis next to the tool and the axis next to the part.
    ///
    /// # Errors
    /// The axes cannot direct the tool.
    pub fn new(axes: [AxisLine; 2]) -> Result<Self, ChainFault> {
        let [first, second] = axes.map(|a| a.direction.into_inner());
        if axes[0].carries == Carries::Part && axes[1].carries == Carries::Tool {
            return Err(ChainFault::Order);
        }
        let tool = Vector3::z();
        if first.cross(&second).norm() < PARALLEL_SINE {
            return Err(ChainFault::Parallel);
        }
        if first.cross(&tool).norm() < PARALLEL_SINE {
            return Err(ChainFault::AlongTool);
        }
        Ok(Self::of(axes, Rotation3::identity()))
    }

    /// The chain with a part that is clamped with its axes along the columns of a rotation, machine frame, all axes at
    /// zero. A new chain has a part whose axes are those of the machine.
    pub fn with_part(&self, part_axes: Rotation3<f64>) -> Self {
        Self::of(self.axes, part_axes)
    }

    /// The chain of valid axes.
    fn of(axes: [AxisLine; 2], part_axes: Rotation3<f64>) -> Self {
        // Products with the matrix keep directions along an axis exact.
        let to_part = |v: Vector3<f64>| {
            if part_axes == Rotation3::identity() { v } else { part_axes.matrix().tr_mul(&v) }
        };
        let directions = axes.map(|a| Unit::new_unchecked(to_part(a.direction.into_inner())));
        let [first, second] = directions.map(Unit::into_inner);
        let tool = to_part(Vector3::z());
        let aside = first.cross(&tool);
        let along = first * first.dot(&tool);
        let across = tool - along;
        let e1 = {
            // Direction in which a small turn first moves the tool; where it is along axis 2, any direction across it.
            let level = |v: &Vector3<f64>| v - second * second.dot(v);
            let e = level(&aside);
            if e.norm() < PARALLEL_SINE { level(&across).normalize() } else { e.normalize() }
        };
        let (level, slope) = (second.dot(&across), second.dot(&aside));
        Self {
            axes,
            part_axes,
            directions,
            cosine: first.dot(&second),
            along,
            across,
            aside,
            mean: second.dot(&along),
            swing: libm::hypot(level, slope),
            start: libm::atan2(slope, level),
            basis: [e1, second.cross(&e1)],
            turning: Turning::new(first.dot(&second)),
        }
    }

    /// A table that turns about Z on a table that tilts about X; both axes run through the origin of the machine frame.
    pub fn tilting_table() -> Self {
        let line = |direction| AxisLine { carries: Carries::Part, direction, point: Point3::origin() };
        let axes = [line(Vector3::x_axis()), line(Vector3::z_axis())];
        Self::of(axes, Rotation3::identity())
    }

    /// The axes of the part with all axes at zero, machine frame: the columns.
    pub fn part_axes(&self) -> &Rotation3<f64> {
        &self.part_axes
    }

    /// True when the axes of the part are those of the machine with all axes at zero.
    pub fn holds_part_upright(&self) -> bool {
        self.part_axes == Rotation3::identity()
    }

    /// Directions of both axes with all axes at zero, part frame.
    pub fn directions_in_part(&self) -> &[Unit<Vector3<f64>>; 2] {
        &self.directions
    }

    /// The axes; the first is next to the tool.
    pub fn axes(&self) -> &[AxisLine; 2] {
        &self.axes
    }

    /// True when an axis carries the tool.
    pub fn has_head(&self) -> bool {
        self.axes[0].carries == Carries::Tool
    }

    /// Tool axis after a turn of axis 1 only.
    fn tilted(&self, first: f64) -> Vector3<f64> {
        let (sine, cosine) = libm::sincos(first);
        self.along + self.across * cosine + self.aside * sine
    }

    /// Unit vector from the tool tip to the holder in the part frame.
    pub fn tool_axis(&self, [first, second]: Angles) -> Vector3<f64> {
        turned(&self.directions[1], &self.tilted(first), second)
    }

    /// Rotation from the tool axis at zero to the tool axis at the angles, in the part frame.
    pub fn rotation(&self, [first, second]: Angles) -> Rotation3<f64> {
        let [k1, k2] = self.directions;
        Rotation3::from_axis_angle(&k2, second) * Rotation3::from_axis_angle(&k1, first)
    }

    /// Both pairs of angles that give a tool axis; `None` when no pair does. Axis 2 lies in (-pi, pi]. At a pole, where
    /// axis 2 is not determined, it takes the value `free`.
    pub fn inverse(&self, tool_axis: &Vector3<f64>, free: f64) -> Option<[Angles; 2]> {
        let (square, angles) = self.solve(tool_axis, free);
        (square >= -SINE_SQUARE_ROUNDING).then_some(angles)
    }

    /// As [`Self::inverse`]; where no angles give the tool axis, the nearest angles.
    pub fn nearest(&self, tool_axis: &Vector3<f64>, free: f64) -> [Angles; 2] {
        self.solve(tool_axis, free).1
    }

    /// The rotary positions for a direction that are nearest to other positions, of both solutions with all their windings:
    /// those that a control takes. `None` where no positions give the direction.
    pub fn near(&self, tool_axis: &Vector3<f64>, before: Angles) -> Option<Angles> {
        let way = |p: &Angles| libm::hypot(p[0] - before[0], p[1] - before[1]);
        let found = self.inverse(tool_axis, before[1])?;
        let unwound = found.map(|[first, second]| [first, nearest_turn(second, before[1])]);
        unwound.into_iter().min_by(|a, b| way(a).total_cmp(&way(b)))
    }

    /// The angles nearest to a tool axis on a branch, with axis 2 on the winding nearest to `before`.
    pub fn unwound(&self, tool_axis: &Vector3<f64>, branch: usize, before: f64) -> Angles {
        let [first, second] = self.nearest(tool_axis, before)[branch];
        [first, nearest_turn(second, before)]
    }

    /// Angles for a tool axis on both branches, and the square of the sine that gives axis 1. If this is negative, no
    /// angles give the tool axis, and the result is the nearest.
    fn solve(&self, tool_axis: &Vector3<f64>, free: f64) -> (f64, [Angles; 2]) {
        let second = &self.directions[1];
        let azimuth = |v: &Vector3<f64>| libm::atan2(v.dot(&self.basis[1]), v.dot(&self.basis[0]));
        let radial = libm::hypot(tool_axis.dot(&self.basis[0]), tool_axis.dot(&self.basis[1]));
        let height = second.dot(tool_axis);
        // swing^2 - (height - mean)^2 in this form, so that the square of the sine of a small angle keeps its digits.
        let rest = self.swing * self.swing - 1.0 - self.mean * self.mean + 2.0 * height * self.mean;
        let square = radial * radial + rest;
        let sine = if rest == 0.0 { radial } else { square.max(0.0).sqrt() };
        let from_start = libm::atan2(sine, height - self.mean);
        let to = azimuth(tool_axis);
        let angles = [from_start, -from_start].map(|from_start| {
            let first = self.start + from_start;
            if radial < POLE {
                return [first, free];
            }
            let from = azimuth(&self.tilted(first));
            let turn = to - from;
            let turn = if turn <= -PI {
                to - (from - TAU)
            } else if turn > PI {
                to - (from + TAU)
            } else {
                turn
            };
            [first, turn]
        });
        (square, angles)
    }

    /// The angles of the first branch for a tool axis, and the derivative of each by the tool axis.
    pub fn gradients(&self, tool_axis: &Vector3<f64>) -> [(f64, Vector3<f64>); 2] {
        /// Below this value the tool lies along axis 2, which is then not determined.
        const ALONG_AXIS_2_SINE: f64 = 1e-6;
        let [[first, second], _] = self.nearest(tool_axis, 0.0);
        let k2 = self.directions[1].into_inner();
        let height = k2.dot(tool_axis);
        let radial = libm::hypot(tool_axis.dot(&self.basis[0]), tool_axis.dot(&self.basis[1])).max(ALONG_AXIS_2_SINE);
        let outward = (tool_axis - k2 * height) / radial;
        // Only axis 1 changes the height; axis 2 turns the rest.
        let polar_angle = outward * height - k2 * radial;
        let around = k2.cross(&outward) / radial;
        if self.swings_straight() {
            return [(first, polar_angle), (second, around)];
        }
        // d(height) = -swing sin(first - start) d(first), and axis 2 compensates the turn of the tool by axis 1 about
        // it.
        let slope = -self.swing * libm::sin(first - self.start);
        let slope = if slope.abs() < ALONG_AXIS_2_SINE { ALONG_AXIS_2_SINE.copysign(slope) } else { slope };
        let of_first = polar_angle * (-radial / slope);
        let tilted = self.tilted(first);
        let moved = self.directions[0].cross(&tilted);
        let turned = k2.cross(&tilted).dot(&moved) / (radial * radial);
        [(first, of_first), (second, around - of_first * turned)]
    }

    /// True when the tool lies along axis 2 at zero, and axis 1 turns the tool straight away from it.
    fn swings_straight(&self) -> bool {
        self.mean == 0.0 && self.swing == 1.0 && self.start == 0.0
    }

    /// Angle between the tool axis and axis 2 at an angle of axis 1, radians.
    pub fn polar_angle(&self, first: f64) -> f64 {
        // Where the tool lies along axis 2 at zero and turns straight away from it, the result is the angle of axis 1.
        if self.swings_straight() && first.abs() <= PI {
            return first.abs();
        }
        let axis = self.tilted(first);
        let second = &self.directions[1];
        libm::atan2(axis.cross(second).norm(), axis.dot(second))
    }

    /// Least and largest angle between the tool axis and axis 2 over a range of the angle of axis 1, radians.
    pub fn polar_angle_range(&self, from: f64, to: f64) -> [f64; 2] {
        // Between its ends the angle is least or largest where the tool turns back, at `start` and half a turn from it.
        let turning = (0..2).filter_map(|half| {
            let place = self.start + PI * f64::from(half);
            let first = place + TAU * ((from - place) / TAU).ceil();
            (first <= to).then_some(first)
        });
        let angles: Vec<f64> = if to - from < TAU {
            [from, to].into_iter().chain(turning).map(|first| self.polar_angle(first)).collect()
        } else {
            [self.start, self.start + PI].map(|first| self.polar_angle(first)).into()
        };
        [angles.iter().copied().fold(PI, f64::min), angles.into_iter().fold(0.0, f64::max)]
    }

    /// Whether two angles of axis 1 are on different branches: the pairs of angles that give one tool axis lie on both
    /// sides of the turning points of axis 1.
    pub fn changes_branch(&self, from: f64, to: f64) -> bool {
        libm::sin(from - self.start) * libm::sin(to - self.start) < 0.0
    }

    /// Largest ratio of [`Self::turn`] to the root of the sum of the squares of both turns.
    pub fn most_turn_ratio(&self) -> f64 {
        if self.cosine == 0.0 { 1.0 } else { (1.0 + self.cosine.abs()).sqrt() }
    }

    /// Whether the tool passes through the direction of axis 2 or its opposite while axis 1 turns from one angle to
    /// another.
    pub fn poles_between(&self, from: f64, to: f64) -> bool {
        // At a pole `mean + swing cos(q - start)` is 1 or -1.
        let poles = [1.0, -1.0].map(|height| (height - self.mean) / self.swing);
        poles.into_iter().filter(|cosine| cosine.abs() <= 1.0 + POLE).any(|cosine| {
            let from_start = libm::acos(cosine.clamp(-1.0, 1.0));
            [self.start + from_start, self.start - from_start].into_iter().any(|pole| {
                let turns = |q: f64| ((q - pole) / TAU).floor();
                turns(from) != turns(to)
            })
        })
    }

    /// Turn of the tool against the part while both axes turn evenly, radians: exact for the rate, an upper bound for
    /// the angle between the ends.
    pub fn turn(&self, from: Angles, to: Angles) -> f64 {
        let [first, second] = [to[0] - from[0], to[1] - from[1]];
        if self.cosine == 0.0 {
            return libm::hypot(first, second);
        }
        (first * first + second * second + 2.0 * self.cosine * first * second).max(0.0).sqrt()
    }

    /// Upper bounds of the motion of the tool axis.
    pub fn turning(&self) -> &Turning {
        &self.turning
    }

    /// Motion of the part at the angles: from the position of the part at zero, machine frame.
    pub(super) fn part(&self, angles: Angles) -> Isometry3<f64> {
        let mut motion: Option<Isometry3<f64>> = None;
        for (axis, angle) in self.axes.iter().zip(angles) {
            if axis.carries == Carries::Part {
                let next = axis.turned(-angle);
                motion = Some(motion.map_or(next, |m| m * next));
            }
        }
        motion.unwrap_or_else(Isometry3::identity)
    }

    /// Motion of the tool at the angles: from the position of the tool at zero, machine frame, linear axes at zero.
    pub(super) fn tool(&self, angles: Angles) -> Isometry3<f64> {
        let mut motion: Option<Isometry3<f64>> = None;
        for (axis, angle) in self.axes.iter().zip(angles) {
            if axis.carries == Carries::Tool {
                let next = axis.turned(angle);
                motion = Some(motion.map_or(next, |m| next * m));
            }
        }
        motion.unwrap_or_else(Isometry3::identity)
    }
}

impl AxisLine {
    /// Rotation about the line by an angle in radians.
    fn turned(&self, angle: f64) -> Isometry3<f64> {
        let rotation = Rotation3::from_axis_angle(&self.direction, angle);
        let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
        Translation3::from(self.point.coords) * rotation * Translation3::from(-self.point.coords)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn line(carries: Carries, direction: [f64; 3], point: [f64; 3]) -> AxisLine {
        AxisLine { carries, direction: Unit::new_normalize(Vector3::from(direction)), point: Point3::from(point) }
    }

    /// A tilted by C: the closed form of textbooks.
    #[test]
    fn orthogonal_tables_have_the_known_closed_form() {
        let chain = Chain::new([
            line(Carries::Part, [1.0, 0.0, 0.0], [0.0; 3]),
            line(Carries::Part, [0.0, 0.0, 1.0], [0.0; 3]),
        ])
        .unwrap();
        for k in 0..1000 {
            let (a, c) = (0.003 * f64::from(k) - 1.4, 0.0061 * f64::from(k) - 3.0);
            let known = Vector3::new(a.sin() * c.sin(), -a.sin() * c.cos(), a.cos());
            assert!((chain.tool_axis([a, c]) - known).norm() < 1e-15);
            let [one, other] = chain.inverse(&known, 0.7).unwrap();
            let nearest = if a >= 0.0 { one } else { other };
            assert!((nearest[0] - a).abs() < 1e-14 && (a.abs() < 1e-9 || (nearest[1] - c).abs() < 1e-12), "{a} {c}");
        }
        assert_eq!(chain.inverse(&Vector3::z(), 0.7), Some([[0.0, 0.7], [-0.0, 0.7]]));
        assert_eq!(*chain.turning(), Turning::RIGHT_ANGLE);
        let near = Turning::new(1e-9);
        assert!(
            (near.second - 1.5).abs() < 1e-8 && (near.third - 3.0).abs() < 1e-7 && near.shortest >= Turning::GOLDEN
        );
    }

    #[test]
    fn axes_that_cannot_direct_the_tool_are_refused() {
        let (x, z) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        let fault = |axes: [(Carries, [f64; 3]); 2]| Chain::new(axes.map(|(c, d)| line(c, d, [0.0; 3]))).unwrap_err();
        assert_eq!(fault([(Carries::Part, x), (Carries::Part, x)]), ChainFault::Parallel);
        assert_eq!(fault([(Carries::Part, z), (Carries::Part, x)]), ChainFault::AlongTool);
        assert_eq!(fault([(Carries::Part, x), (Carries::Tool, z)]), ChainFault::Order);
    }

    /// Directions of real machines, orthogonal and nutating, and any others that are not nearly parallel.
    fn direction() -> impl Strategy<Value = [f64; 3]> {
        let h = std::f64::consts::FRAC_1_SQRT_2;
        prop_oneof![
            Just([1.0, 0.0, 0.0]),
            Just([0.0, 1.0, 0.0]),
            Just([0.0, 0.0, 1.0]),
            Just([h, 0.0, h]),
            Just([0.0, h, h]),
            Just([0.0, -h, h]),
            [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0].prop_filter("a direction", |d| Vector3::from(*d).norm() > 0.2),
        ]
    }

    fn chain() -> impl Strategy<Value = Chain> {
        use Carries::{Part, Tool};
        let kinds = prop_oneof![Just([Part, Part]), Just([Tool, Part]), Just([Tool, Tool])];
        let point = || [-300.0..300.0_f64, -300.0..300.0, -300.0..300.0];
        (kinds, [direction(), direction()], [point(), point()]).prop_filter_map(
            "the axes direct the tool well",
            |(kind, directions, points)| {
                let [k1, k2] = directions.map(|d| Vector3::from(d).normalize());
                let well = k1.cross(&k2).norm() > 0.2 && k1.cross(&Vector3::z()).norm() > 0.2;
                let axes = [0, 1].map(|i| line(kind[i], directions[i], points[i]));
                well.then(|| Chain::new(axes).ok()).flatten()
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// Angles of the inverse reproduce the axis to 1e-12 on both branches; one branch has the original angles.
        #[test]
        fn chains_go_forward_and_back(chain in chain(), angles in [-3.0..3.0_f64, -3.1..3.1]) {
            let axis = chain.tool_axis(angles);
            prop_assert!((axis.norm() - 1.0).abs() < 1e-14);
            let found = chain.inverse(&axis, angles[1]);
            prop_assert!(found.is_some());
            let found = found.unwrap();
            for pair in found {
                prop_assert!((chain.tool_axis(pair) - axis).norm() < 1e-12, "{pair:?}");
            }
            let same = |pair: &Angles| [0, 1].iter().all(|k| {
                let off = (pair[*k] - angles[*k]) / TAU;
                // Near a turning point of axis 1 the square root loses half of the digits of the angle.
                (off - off.round()).abs() < 1e-6
            });
            let pole = axis.cross(&chain.axes()[1].direction).norm() < 1e-4;
            prop_assert!(pole || found.iter().any(same), "{found:?} for {angles:?}");
        }

        /// Within a quarter turn of axis 2, and away from the pole, a vector leads to the intended position.
        #[test]
        fn a_vector_comes_back_as_the_near_position(
            a in 0.1..1.6_f64, c in -9.0..9.0_f64, da in -0.05..0.05_f64, dc in -1.4..1.4_f64, branch in any::<bool>()
        ) {
            let a = if branch { -a } else { a };
            let chain = Chain::tilting_table();
            let found = chain.near(&chain.tool_axis([a + da, c + dc]), [a, c]).unwrap();
            prop_assert!((found[0] - a - da).abs() < 1e-9 && (found[1] - c - dc).abs() < 1e-8);
        }

        /// The derivatives of the angles by the tool axis, compared with differences.
        #[test]
        fn gradients_are_those_of_the_inverse(chain in chain(), angles in [-3.0..3.0_f64, -3.0..3.0], aside in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0]) {
            let axis = chain.tool_axis(angles);
            let [k1, k2] = chain.axes().map(|a| a.direction);
            let regular = k1.cross(&chain.tilted(angles[0])).cross(&k2.cross(&chain.tilted(angles[0]))).norm();
            prop_assume!(regular > 0.05 && axis.cross(&k2).norm() > 0.05);
            let aside = Vector3::from(aside);
            let aside = aside - axis * axis.dot(&aside);
            let h = 1e-6;
            let [p, q] = [h, -h].map(|h| chain.unwound(&(axis + aside * h).normalize(), 0, chain.nearest(&axis, 0.0)[0][1]));
            for (k, (_, gradient)) in chain.gradients(&axis).iter().enumerate() {
                let change = (p[k] - q[k]) / (2.0 * h);
                prop_assert!((change - gradient.dot(&aside)).abs() < 1e-3 * (1.0 + change.abs()), "{k}: {change} {}", gradient.dot(&aside));
            }
        }

        /// The turn is the angular speed, and the bounds of the derivatives of the axis hold; compared with differences
        /// of the true rotation.
        #[test]
        fn turns_bound_what_the_tool_axis_does(
            chain in chain(), from in [-3.0..3.0_f64, -3.0..3.0], rate in [-1.0..1.0_f64, -1.0..1.0]
        ) {
            let [k1, k2] = chain.axes().map(|a| a.direction);
            let at = |t: f64| {
                Rotation3::from_axis_angle(&k2, from[1] + rate[1] * t) * Rotation3::from_axis_angle(&k1, from[0] + rate[0] * t)
            };
            let turn = chain.turn([0.0; 2], rate);
            let h = 1e-3;
            let spin = (at(h) * at(-h).inverse()).scaled_axis().norm() / (2.0 * h);
            prop_assert!((spin - turn).abs() < 1e-5 * (1.0 + turn), "{spin} {turn}");
            let axis = |t: f64| chain.tool_axis([from[0] + rate[0] * t, from[1] + rate[1] * t]);
            let second = (axis(h) - axis(0.0) * 2.0 + axis(-h)).norm() / (h * h);
            let third = (axis(2.0 * h) - axis(h) * 2.0 + axis(-h) * 2.0 - axis(-2.0 * h)).norm() / (2.0 * h * h * h);
            let bounds = chain.turning();
            prop_assert!(second <= bounds.second * turn * turn + 1e-5, "{second}");
            prop_assert!(third <= bounds.third * turn.powi(3) + 1e-4, "{third}");
        }

        /// The angle to axis 2, compared with the angle of the vectors.
        #[test]
        fn polar_angle_is_the_angle_to_axis_2(chain in chain(), angles in [-3.0..3.0_f64, -3.0..3.0]) {
            let angle = chain.tool_axis(angles).angle(&chain.axes()[1].direction);
            prop_assert!((chain.polar_angle(angles[0]) - angle).abs() < 1e-7);
        }
    }
}
