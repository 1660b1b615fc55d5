//! Forward and inverse transformation between joints and cutter locations.

use super::Machine;
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// Joint positions: mm and radians, ISO sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joints {
    /// X, Y, Z of the tool tip in the machine frame.
    pub xyz: Vector3<f64>,
    /// A.
    pub a: f64,
    /// C.
    pub c: f64,
}

/// Tool in the part frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Tool tip.
    pub tip: Point3<f64>,
    /// Unit vector from the tip to the holder.
    pub axis: Vector3<f64>,
}

/// Tool axis in the part frame at rotary angles (ISO).
pub fn axis_at(a: f64, c: f64) -> Vector3<f64> {
    let (sa, ca) = libm::sincos(a);
    let (sc, cc) = libm::sincos(c);
    Vector3::new(sa * sc, -sa * cc, ca)
}

/// Both (A, C) that give a tool axis: A >= 0 first, C in (-pi, pi]. At the pole, where C is free, `c_pole` is taken.
pub fn inverse(axis: &Vector3<f64>, c_pole: f64) -> [(f64, f64); 2] {
    let radial = libm::hypot(axis.x, axis.y);
    let a = libm::atan2(radial, axis.z);
    // Below this the azimuth of a unit vector is rounding noise.
    if radial < 1e-12 {
        return [(a, c_pole), (-a, c_pole)];
    }
    let c = libm::atan2(axis.x, -axis.y);
    let opposite = if c > 0.0 { c - std::f64::consts::PI } else { c + std::f64::consts::PI };
    [(a, c), (-a, opposite)]
}

impl Machine {
    /// Motion of the part at rotary angles: part frame to machine frame.
    pub fn part_to_machine(&self, a: f64, c: f64) -> Isometry3<f64> {
        let about = |point: &Point3<f64>, rotation: Rotation3<f64>| {
            let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
            Translation3::from(point.coords) * rotation * Translation3::from(-point.coords)
        };
        let tilt = about(&self.tilt_point, Rotation3::from_axis_angle(&Vector3::x_axis(), -a));
        let turn = about(&self.turn_point, Rotation3::from_axis_angle(&Vector3::z_axis(), -c));
        tilt * turn * Translation3::from(self.part_origin)
    }

    /// Cutter location of joint positions.
    pub fn forward(&self, joints: &Joints) -> Pose {
        let tip = self.part_to_machine(joints.a, joints.c).inverse_transform_point(&Point3::from(joints.xyz));
        Pose { tip, axis: axis_at(joints.a, joints.c) }
    }

    /// Joints that put the tip at a point of the part with the rotary axes at (a, c).
    pub fn joints(&self, tip: &Point3<f64>, a: f64, c: f64) -> Joints {
        Joints { xyz: (self.part_to_machine(a, c) * tip).coords, a, c }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_branches_give_the_axis_back() {
        for (a, c) in [(0.3, 0.2), (1.2, -3.0), (0.05, 2.9), (1.5, 0.0)] {
            let axis = axis_at(a, c);
            for (a2, c2) in inverse(&axis, 0.0) {
                assert!((axis_at(a2, c2) - axis).norm() < 1e-14);
                assert!(c2.abs() <= std::f64::consts::PI);
            }
        }
    }
}
