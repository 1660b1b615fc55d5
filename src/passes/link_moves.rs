//! `link-moves`: the ways between passes.
//!
//! Before: passes that begin and end with the tool outside of the stock. After: one sequence of moves: down along the
//! tool axis to the start of a pass, the pass, up along the tool axis to the clearance sphere, over it to the next.
//! A tool that leaves along its own axis sweeps nothing but the room that it stands in. After rest machining passes
//! begin and end in room that is free of stock already, with a tool that nothing above its cutter makes thinner.

use super::pipeline::PassContext;
use crate::diag::Aborted;
use crate::ir::{ClMove, ClPlan, ClPoint, MoveKind, Program};
use nalgebra::{Point3, Vector3};

/// Distance of the clearance sphere from the farthest corner of the stock, mm.
const SPHERE_GAP: f64 = 10.0;

/// Longest step on the sphere, radians: its chord stays 0.4 % of the radius inside.
const SPHERE_STEP: f64 = 0.18;

/// Sphere around the stock on which rapids run.
pub(super) struct ClearanceSphere {
    centre: Point3<f64>,
    radius: f64,
}

impl ClearanceSphere {
    pub(super) fn new(program: &Program) -> Self {
        let profile = &program.stock.profile;
        let (low, high) =
            profile.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p[1]), h.max(p[1])));
        let centre = Point3::new(0.0, 0.0, 0.5 * (low + high));
        let far = profile.iter().map(|p| p[0].hypot(p[1] - centre.z)).fold(0.0, f64::max);
        Self { centre, radius: (far + SPHERE_GAP) / (0.5 * SPHERE_STEP).cos() }
    }

    /// Distance to go from a point along a direction until outside.
    pub(super) fn exit(&self, from: &Point3<f64>, direction: &Vector3<f64>) -> f64 {
        let d = from - self.centre;
        let b = d.dot(direction);
        let c = d.norm_squared() - self.radius * self.radius;
        if c >= 0.0 { 0.0 } else { -b + (b * b - c).sqrt() }
    }

    /// Length of the way from one outside point to another.
    pub(super) fn way(&self, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
        let (around, mut at, mut length) = (self.around(from, to), *from, 0.0);
        for next in around.iter().chain([to]) {
            length += (next - at).norm();
            at = *next;
        }
        length
    }

    /// Points on the way from one outside point to another, both excluded, none inside the sphere.
    fn around(&self, from: &Point3<f64>, to: &Point3<f64>) -> Vec<Point3<f64>> {
        let (a, b) = (from - self.centre, to - self.centre);
        let (ra, rb) = (a.norm(), b.norm());
        let mut end = b / rb;
        let start = a / ra;
        // Opposite directions leave the way open: go over the top.
        if start.dot(&end) < -0.999 {
            end = (end + Vector3::z() * 0.1).normalize();
        }
        let angle = start.dot(&end).clamp(-1.0, 1.0).acos();
        let count = (angle / SPHERE_STEP).ceil() as usize;
        (1..count)
            .map(|i| {
                let t = i as f64 / count as f64;
                let direction = (start * ((1.0 - t) * angle).sin() + end * (t * angle).sin()) / angle.sin();
                self.centre + direction * (ra + (rb - ra) * t)
            })
            .collect()
    }
}

/// Fills in the moves of every operation.
///
/// # Errors
/// None today; a way that is not clear of the stock is found by the verifier.
pub(super) fn run(cx: &mut PassContext<'_>, cl: &mut ClPlan) -> Result<(), Aborted> {
    let sphere = ClearanceSphere::new(cx.program);
    for operation in &mut cl.operations {
        let mut moves: Vec<ClMove> = Vec::new();
        for (index, pass) in operation.passes.iter().enumerate() {
            let (Some(first), Some(last)) = (pass.points.first(), pass.points.last()) else { continue };
            let index = u32::try_from(index).unwrap_or(u32::MAX);
            let lifted = |p: &ClPoint| {
                let tip = p.tip + p.axis * sphere.exit(&p.tip, &p.axis);
                ClPoint { tip, axis: p.axis, contact: None }
            };
            let mut add = |kind: MoveKind, to: ClPoint| moves.push(ClMove { kind, to, pass: index, feed: None });
            let over = lifted(first);
            add(MoveKind::Rapid, over);
            if over.tip != first.tip {
                add(MoveKind::Link, ClPoint { contact: None, ..*first });
            }
            for p in pass.points.iter().skip(1) {
                add(MoveKind::Cut, *p);
            }
            let out = lifted(last);
            if out.tip != last.tip {
                add(MoveKind::Link, out);
            }
        }
        operation.moves = with_ways(&sphere, moves);
    }
    Ok(())
}

/// Puts the way over the sphere in front of each rapid that follows another move.
fn with_ways(sphere: &ClearanceSphere, moves: Vec<ClMove>) -> Vec<ClMove> {
    let mut all: Vec<ClMove> = Vec::with_capacity(moves.len());
    for next in moves {
        if let (MoveKind::Rapid, Some(last)) = (next.kind, all.last().copied()) {
            let tips = sphere.around(&last.to.tip, &next.to.tip);
            let count = tips.len() as f64 + 1.0;
            for (i, tip) in tips.into_iter().enumerate() {
                // Nominal axis; solve-kinematics turns the rotary axes evenly over the way.
                let share = (i as f64 + 1.0) / count;
                let axis = (last.to.axis * (1.0 - share) + next.to.axis * share).try_normalize(1e-6);
                let axis = axis.unwrap_or(next.to.axis);
                all.push(ClMove { to: ClPoint { tip, axis, contact: None }, ..next });
            }
        }
        all.push(next);
    }
    all
}
