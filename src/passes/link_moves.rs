//! `link-moves`: the ways between passes.
//!
//! Before: passes that begin and end with the tool outside of the stock. After: one sequence of moves: down along the
//! tool axis to the start of a pass, the pass, up along the tool axis to the clearance sphere, over it to the next; or,
//! between finishing passes of which one begins where the other ends, the short way over (see [`super::hop`]).
//! A tool that leaves along its own axis sweeps nothing but the room that it stands in. After rest machining passes
//! begin and end in room that is free of stock already, with a tool that nothing above its cutter makes thinner.

use super::hop::Hops;
use super::pipeline::PassContext;
use super::solve_kinematics::within_travel;
use crate::collide::ToolSolid;
use crate::diag::Aborted;
use crate::ir::{ClMove, ClPass, ClPlan, ClPoint, MoveKind, Program};
use crate::kin::{Chain, RotaryPose, between};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use std::ops::Range;

/// Distance of the tip on the clearance sphere from the farthest corner of the stock, mm.
const SPHERE_GAP: f64 = 10.0;

/// Distance of shank and holder from the sphere of that corner, mm.
const BODY_GAP: f64 = 5.0;

/// Longest step on the sphere, radians: its chord goes 1.5 % of the radius inside. Shorter ones would make more corners, at
/// each of which the control slows down.
const SPHERE_STEP: f64 = 0.35;

/// Sphere around the stock on which rapids run, about a point of the axis of the table. A tool with its tip on it and its axis
/// not inward has all of its points outside of the sphere of the stock's farthest corner.
pub(super) struct ClearanceSphere {
    centre: Point3<f64>,
    radius: f64,
}

impl ClearanceSphere {
    pub(super) fn new(program: &Program, tool: &ToolSolid) -> Self {
        let profile = &program.stock.profile;
        let (low, high) =
            profile.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p[1]), h.max(p[1])));
        let centre = Point3::new(0.0, 0.0, 0.5 * (low + high));
        let far = profile.iter().map(|p| libm::hypot(p[0], p[1] - centre.z)).fold(0.0, f64::max);
        // A point s over the tip and r beside the axis, which is at worst at right angles to the radius of the tip.
        let sections = tool.shank.iter().chain(&tool.holder);
        let corners = sections.flat_map(|x| [(x.radius_from, x.from), (x.radius_to, x.to)]);
        let cutter = [(tool.cutter.widest_below(tool.flute_length), 0.0)];
        let wide = corners.chain(cutter).map(|(r, s)| ((far + r + BODY_GAP).powi(2) - s * s).max(0.0).sqrt());
        // Chords between steps lie inside.
        let wide = wide.fold(0.0, f64::max) / libm::cos(0.5 * SPHERE_STEP);
        Self { centre, radius: wide.max(far + SPHERE_GAP) }
    }

    /// Distance to go from a point along a direction until outside, and on until the direction is not inward.
    pub(super) fn exit(&self, from: &Point3<f64>, direction: &Vector3<f64>) -> f64 {
        let d = from - self.centre;
        let b = d.dot(direction);
        let c = d.norm_squared() - self.radius * self.radius;
        if c >= 0.0 && b >= 0.0 { 0.0 } else { -b + (b * b - c).max(0.0).sqrt() }
    }

    /// Length of the way from one outside point to another.
    pub(super) fn way(&self, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
        let (a, b) = (from - self.centre, to - self.centre);
        let (ra, rb) = (a.norm(), b.norm());
        libm::hypot(ra - rb, a.angle(&b) * 0.5 * (ra + rb))
    }

    /// Tips and rotary angles on the way from one place outside to another, both excluded. The rotary axes turn evenly;
    /// the tip, as the machine sees it, goes straight round the sphere: where the tool axis is not inward at both ends,
    /// it is nowhere on the way, and the table turns below a tool that hardly moves.
    pub(super) fn around(&self, chain: &Chain, from: &RotaryPose, to: &RotaryPose) -> Vec<RotaryPose> {
        let [start, end] = [from, to].map(|p| chain.rotation(p.rotary).inverse() * (p.tip - self.centre));
        let (rs, re) = (start.norm(), end.norm());
        let (s, mut e) = (start / rs, end / re);
        // Opposite directions leave the way open: go over the top.
        if s.dot(&e) < -0.999 {
            e = (e + Vector3::z() * 0.1).normalize();
        }
        let angle = libm::acos(s.dot(&e).clamp(-1.0, 1.0));
        let turn = [0, 1].map(|k| (to.rotary[k] - from.rotary[k]).abs()).iter().sum::<f64>();
        let count = ((angle + turn) / SPHERE_STEP).ceil() as usize;
        (1..count)
            .map(|i| {
                let t = i as f64 / count as f64;
                let direction = if angle > 1e-9 {
                    (s * libm::sin((1.0 - t) * angle) + e * libm::sin(t * angle)) / libm::sin(angle)
                } else {
                    s
                };
                let rotary = between(from.rotary, to.rotary, t);
                let tip = self.centre + chain.rotation(rotary) * direction * (rs + (re - rs) * t);
                RotaryPose { tip, rotary }
            })
            .collect()
    }
}

/// Fills in the moves of every operation.
///
/// # Errors
/// None today; a way that is not clear of the stock is found by the verifier.
pub(super) fn run(cx: &mut PassContext<'_>, cl: &mut ClPlan) -> Result<(), Aborted> {
    let program = cx.program;
    for planned in &mut cl.operations {
        let operation = &program.operations[planned.operation];
        let tool = &program.tools[operation.tool];
        let sphere = ClearanceSphere::new(program, &tool.solid);
        let lifted = |p: &ClPoint| {
            let tip = p.tip + p.axis * sphere.exit(&p.tip, &p.axis);
            ClPoint { tip, axis: p.axis, contact: None }
        };
        let hops = Hops::new(program, cx.obstacles, operation);
        let short: Vec<Option<[ClPoint; 2]>> = planned
            .passes
            .par_windows(2)
            .map(|pair| {
                let (from, to) = pair[0].points.last().zip(pair[1].points.first())?;
                let hop = hops.between(from, to).filter(|_| operation.kind.finishes())?;
                // Not where the way over the sphere takes less time.
                let length = |points: &[ClPoint]| points.windows(2).map(|w| (w[1].tip - w[0].tip).norm()).sum::<f64>();
                let feed = operation.link_feed.get() / 60.0;
                let [out, back] = [from, to].map(lifted);
                let over = (length(&[*from, out]) + length(&[back, *to])) / feed
                    + sphere.way(&out.tip, &back.tip) / program.machine.rapid;
                (length(&[*from, hop[0], hop[1], *to]) / feed <= over).then_some(hop)
            })
            .collect();
        let mut moves: Vec<ClMove> = Vec::new();
        for run in runs(&planned.passes, &short) {
            // The machine keeps branch and winding over a run: where no travel holds it, it is left half way.
            let mut open = vec![run];
            while let Some(run) = open.pop() {
                let linked = linked(&planned.passes, &short, run.clone(), &lifted);
                if run.len() > 1 && !within_travel(&program.machine, &linked, tool.length()) {
                    let middle = run.start + run.len() / 2;
                    open.extend([middle..run.end, run.start..middle]);
                } else {
                    moves.extend(linked);
                }
            }
        }
        planned.moves = moves;
    }
    Ok(())
}

/// Passes in a row that short ways join; passes without points are left out.
fn runs(passes: &[ClPass], short: &[Option<[ClPoint; 2]>]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for index in (0..passes.len()).filter(|i| !passes[*i].points.is_empty()) {
        match runs.last_mut() {
            Some(run) if run.end == index && short[index - 1].is_some() => run.end = index + 1,
            _ => runs.push(index..index + 1),
        }
    }
    runs
}

/// The moves of passes that short ways join, from the clearance sphere and back to it.
fn linked(
    passes: &[ClPass],
    short: &[Option<[ClPoint; 2]>],
    run: Range<usize>,
    lifted: &dyn Fn(&ClPoint) -> ClPoint,
) -> Vec<ClMove> {
    let mut moves: Vec<ClMove> = Vec::new();
    for index in run.clone() {
        let points = &passes[index].points;
        let (Some(first), Some(last)) = (points.first(), points.last()) else { continue };
        let pass = u32::try_from(index).unwrap_or(u32::MAX);
        let mut add = |kind: MoveKind, to: ClPoint| moves.push(ClMove { kind, to, pass, feed: None });
        let start = ClPoint { contact: None, ..*first };
        match index.checked_sub(1).and_then(|before| short[before]) {
            Some(over) if index > run.start => {
                for to in [over[0], over[1], start] {
                    add(MoveKind::Link, to);
                }
            }
            _ => {
                let over = lifted(first);
                add(MoveKind::Rapid, over);
                if over.tip != first.tip {
                    add(MoveKind::Link, start);
                }
            }
        }
        for p in points.iter().skip(1) {
            add(MoveKind::Cut, *p);
        }
        let out = lifted(last);
        if index + 1 == run.end && out.tip != last.tip {
            add(MoveKind::Link, out);
        }
    }
    moves
}
