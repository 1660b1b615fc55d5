//! Motion of a control inside of a block, and the distance between two rules.

use super::{Joints, Machine, Pose, between};
use nalgebra::Vector3;
use nurbs::angle::great_arc;

/// Rule by which a control interpolates between the ends of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Tool centre point control: the tip straight on the part, the rotary axes linear with the path of the tip
    /// (Siemens ORIAXES, LinuxCNC under its kinematics). This crate plans motions with this meaning.
    RotaryLinear,
    /// Tool centre point control with the tool axis on a great circle (Siemens ORIVECT, Heidenhain vectors).
    GreatCircle,
    /// No tool centre point control: all joints linear.
    JointsLinear,
}

impl Interpolation {
    /// Tool at a share `t` of the block, in [0, 1]; `length` is that of the tool, mm.
    pub fn pose(self, machine: &Machine, [from, to]: [&Joints; 2], length: f64, t: f64) -> Pose {
        let rotary = between(from.rotary, to.rotary, t);
        if self == Self::JointsLinear {
            if !machine.chain.has_head() {
                return machine.forward(&Joints { xyz: from.xyz + (to.xyz - from.xyz) * t, rotary });
            }
            let [start, end] = [from, to].map(|joints| {
                let [x, y, z, ..] = machine.positions(joints, length);
                Vector3::new(x, y, z)
            });
            return machine.forward(&machine.joints_at(&start.lerp(&end, t), rotary, length));
        }
        let ends = [machine.forward(from), machine.forward(to)];
        let tip = ends[0].tip + (ends[1].tip - ends[0].tip) * t;
        let axis = if self == Self::GreatCircle {
            great_arc(&ends[0].axis, &ends[1].axis, t)
        } else {
            machine.chain.tool_axis(rotary)
        };
        Pose { tip, axis }
    }

    /// Largest distance between the tool under this rule and under [`Self::RotaryLinear`], at equal shares of the
    /// block, for points of the tool axis from the tip to a height over it, mm. Measured at the quarters of the block.
    /// `length` is that of the tool, mm.
    pub fn deviation(self, machine: &Machine, [from, to]: [&Joints; 2], length: f64, height: f64) -> f64 {
        // The rules differ only where an axis turns.
        if self == Self::RotaryLinear || from.rotary == to.rotary {
            return 0.0;
        }
        let off = |t: f64| {
            let [p, q] = [self, Self::RotaryLinear].map(|rule| rule.pose(machine, [from, to], length, t));
            let tip = p.tip - q.tip;
            // The distance is convex over the height.
            tip.norm().max((tip + (p.axis - q.axis) * height).norm())
        };
        off(0.25).max(off(0.5)).max(off(0.75))
    }
}
