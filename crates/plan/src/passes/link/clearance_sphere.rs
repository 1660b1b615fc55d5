//! The sphere about the stock on which rapids run.

use five_axis::{Chain, RotaryPose, between};
use ir::Program;
use nalgebra::{Point3, Vector3};
use nurbs::angle::great_arc;
use tool_stock::collide::ToolSolid;

/// Distance of the tool tip on the clearance sphere from the sphere through the farthest corner of the stock, mm.
const SPHERE_GAP: f64 = 10.0;

/// Distance of shank and holder from the sphere through that corner, mm.
const BODY_GAP: f64 = 5.0;

/// Longest step on the sphere, radians: its chord lies 1.5 % of the radius inside. Shorter steps would make more
/// corners, and the control slows down at each corner.
const SPHERE_STEP: f64 = 0.35;

/// Sphere about the stock on which rapids run. Its centre lies on the axis of the table. When the tool tip is on this
/// sphere and the tool axis does not point inward, all tool points lie outside of the sphere through the farthest
/// corner of the stock.
pub(crate) struct ClearanceSphere {
    centre: Point3<f64>,
    radius: f64,
}

impl ClearanceSphere {
    pub(crate) fn new(program: &Program, tool: &ToolSolid) -> Self {
        let [height, far] = program.stock.sphere();
        let centre = Point3::new(0.0, 0.0, height);
        // A point s over the tip and r beside the axis; the worst case is an axis at right angles to the radius of the
        // tip.
        let sections = tool.shank.iter().chain(&tool.holder);
        let corners = sections.flat_map(|x| [(x.radius_from, x.from), (x.radius_to, x.to)]);
        let cutter = [(tool.cutter.widest_below(tool.flute_length), 0.0)];
        let radii = corners.chain(cutter).map(|(r, s)| ((far + r + BODY_GAP).powi(2) - s * s).max(0.0).sqrt());
        // Chords between steps lie inside of the sphere.
        let radius = radii.fold(0.0, f64::max) / libm::cos(0.5 * SPHERE_STEP);
        Self { centre, radius: radius.max(far + SPHERE_GAP) }
    }

    /// Distance from a point along a direction until it is outside and the direction no longer points inward.
    pub(crate) fn exit(&self, from: &Point3<f64>, direction: &Vector3<f64>) -> f64 {
        let d = from - self.centre;
        let b = d.dot(direction);
        let c = d.norm_squared() - self.radius * self.radius;
        if c >= 0.0 && b >= 0.0 { 0.0 } else { -b + (b * b - c).max(0.0).sqrt() }
    }

    /// Diameter, mm.
    pub(crate) fn size(&self) -> f64 {
        2.0 * self.radius
    }

    /// The place on the sphere between the directions of a tool axis and of the vertical. A tool there does not point
    /// inward, nor does it on the way up, unless it points down.
    pub(crate) fn above(&self, axis: &Vector3<f64>, up: &Vector3<f64>) -> Point3<f64> {
        let direction = (axis + up).try_normalize(0.1).unwrap_or(*up);
        self.centre + direction * self.radius
    }

    /// Length of the path from one outside point to another.
    pub(crate) fn path_length(&self, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
        let (a, b) = (from - self.centre, to - self.centre);
        let (ra, rb) = (a.norm(), b.norm());
        libm::hypot(ra - rb, a.angle(&b) * 0.5 * (ra + rb))
    }

    /// Tips and rotary angles on the path between two outside places, without both ends. The rotary axes turn evenly.
    /// In the frame of the machine the tip goes straight round the sphere. When the tool axis does not point inward at
    /// both ends, it does so nowhere on the path; the table turns below a tool that hardly moves.
    pub(crate) fn around(&self, chain: &Chain, from: &RotaryPose, to: &RotaryPose) -> Vec<RotaryPose> {
        let [start, end] = [from, to].map(|p| chain.rotation(p.rotary).inverse() * (p.tip - self.centre));
        let (rs, re) = (start.norm(), end.norm());
        let (s, mut e) = (start / rs, end / re);
        // Opposite directions do not determine the path: go over the top.
        if s.dot(&e) < -0.999 {
            e = (e + Vector3::z() * 0.1).normalize();
        }
        let angle = libm::acos(s.dot(&e).clamp(-1.0, 1.0));
        let turn = [0, 1].map(|k| (to.rotary[k] - from.rotary[k]).abs()).iter().sum::<f64>();
        let count = ((angle + turn) / SPHERE_STEP).ceil() as usize;
        (1..count)
            .map(|i| {
                let t = i as f64 / count as f64;
                let direction = great_arc(&s, &e, t);
                let rotary = between(from.rotary, to.rotary, t);
                let tip = self.centre + chain.rotation(rotary) * direction * (rs + (re - rs) * t);
                RotaryPose { tip, rotary }
            })
            .collect()
    }
}
