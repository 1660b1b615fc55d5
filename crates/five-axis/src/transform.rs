//! Forward and inverse transformation between joints and cutter locations.

use super::{Angles, LinearAxis, Machine};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

/// Joint positions: mm and radians, ISO sense.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Joints {
    /// X, Y, Z of the tool tip in the machine frame.
    pub xyz: Vector3<f64>,
    /// Angles of the rotary axes.
    pub rotary: Angles,
}

impl Joints {
    /// X, Y, Z of the tip and both rotary axes.
    pub fn all(&self) -> [f64; 5] {
        [self.xyz.x, self.xyz.y, self.xyz.z, self.rotary[0], self.rotary[1]]
    }
}

/// Tool in the part frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Tool tip.
    pub tip: Point3<f64>,
    /// Unit vector from the tip to the holder.
    pub axis: Vector3<f64>,
}

/// A tool tip on the part with the angles of the rotary axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotaryPose {
    /// Tip, part frame.
    pub tip: Point3<f64>,
    /// Angles of the rotary axes.
    pub rotary: Angles,
}

impl RotaryPose {
    /// Pose at a share of a move to another pose: the tip straight on the part, the rotary axes linear.
    pub fn towards(&self, to: &Self, share: f64) -> Self {
        Self { tip: self.tip + (to.tip - self.tip) * share, rotary: between(self.rotary, to.rotary, share) }
    }
}

/// Largest turn of a rotary axis between angles, radians.
pub fn most_turn(from: Angles, to: Angles) -> f64 {
    (to[0] - from[0]).abs().max((to[1] - from[1]).abs())
}

/// Angles at a share of an even turn.
pub fn between(from: Angles, to: Angles, share: f64) -> Angles {
    [0, 1].map(|k| from[k] + (to[k] - from[k]) * share)
}

impl Machine {
    /// Motion of the part at rotary angles: part frame to machine frame.
    pub fn part_to_machine(&self, angles: Angles) -> Isometry3<f64> {
        let placed = self.chain.part(angles) * Translation3::from(self.part_origin);
        if self.chain.holds_part_upright() {
            return placed;
        }
        placed * UnitQuaternion::from_rotation_matrix(self.chain.part_axes())
    }

    /// Cutter location of joint positions.
    pub fn forward(&self, joints: &Joints) -> Pose {
        let tip = self.part_to_machine(joints.rotary).inverse_transform_point(&Point3::from(joints.xyz));
        Pose { tip, axis: self.chain.tool_axis(joints.rotary) }
    }

    /// Joints that put the tip at a point of the part, for given angles of the rotary axes.
    pub fn joints(&self, tip: &Point3<f64>, rotary: Angles) -> Joints {
        Joints { xyz: (self.part_to_machine(rotary) * tip).coords, rotary }
    }

    /// Positions of all axes for a tool of a given length, mm and radians. X, Y and Z are those of the gauge line of the
    /// spindle with the head upright: the words of the machine. At zero the gauge line is then at the origin of the machine
    /// frame.
    pub fn positions(&self, joints: &Joints, length: f64) -> [f64; 5] {
        let [x, y, z, first, second] = joints.all();
        let tip = self.hanging(joints.rotary, length);
        [x - tip.x, y - tip.y, z - tip.z, first, second]
    }

    /// Joints of positions of X, Y and Z ([`Self::positions`]) and of the rotary axes, for a tool of a given length.
    pub fn joints_at(&self, xyz: &Vector3<f64>, rotary: Angles, length: f64) -> Joints {
        Joints { xyz: xyz + self.hanging(rotary, length), rotary }
    }

    /// The joints with Z at another position ([`Self::positions`]).
    pub fn at_height(&self, joints: &Joints, z: f64, length: f64) -> Joints {
        let mut moved = *joints;
        moved.xyz.z = z + self.hanging(joints.rotary, length).z;
        moved
    }

    /// Whether all axes stay within their travel with a tool of a length (mm) at a place, on either branch and any winding: X, Y
    /// and Z by at least `slack` (mm).
    pub fn reaches_place(&self, at: &Pose, length: f64, slack: f64) -> bool {
        self.farthest_out(at, length).is_some_and(|(_, _, beyond)| beyond <= -slack)
    }

    /// Of X, Y and Z the one that goes farthest towards or beyond the end of its travel with a tool of a length (mm) at a place, on
    /// the better branch: its index, its position (mm), and how far it is beyond the end, negative within the travel (mm). `None`
    /// where the rotary axes do not give the direction.
    pub fn farthest_out(&self, at: &Pose, length: f64) -> Option<(usize, f64, f64)> {
        let of_branch = |rotary: Angles| {
            let positions = self.positions(&self.joints(&at.tip, rotary), length);
            let beyond = |k: usize| {
                let LinearAxis { min, max, .. } = self.linear[k];
                (k, positions[k], (min - positions[k]).max(positions[k] - max))
            };
            (1..3).map(beyond).fold(beyond(0), |a, b| if b.2 > a.2 { b } else { a })
        };
        self.angles_within_travel(&at.axis).map(of_branch).min_by(|a, b| a.2.total_cmp(&b.2))
    }

    /// Positions of all axes but for constants of X, Y and Z: for speeds, accelerations and jerks.
    pub fn travelled(&self, joints: &Joints, length: f64) -> [f64; 5] {
        // Without a head the length of the tool is such a constant.
        if self.chain.has_head() { self.positions(joints, length) } else { joints.all() }
    }

    /// Tip of a tool that hangs from the head, with the linear axes at zero, machine frame, mm.
    fn hanging(&self, rotary: Angles, length: f64) -> Vector3<f64> {
        let tip = Point3::new(0.0, 0.0, -length);
        if self.chain.has_head() { (self.chain.tool(rotary) * tip).coords } else { tip.coords }
    }
}
