//! Space without material, known from the blank and from the cuts before it.
//!
//! Rays of the stock miss an edge of material that is thinner than a cell. Where the middle of an end without teeth goes
//! down along the axis, such an edge would be hit. The blank is known exactly, and so are the poses of all cuts: a
//! point is free when it lies outside of the blank or inside of a cutter at one of these poses.

use super::stock_steps::PathPoint;
use ir::{ClPoint, Program};
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use tool_stock::collide::ToolSolid;

/// Height over the tip from which material counts, mm: floors of cuts beside one another differ by less.
const MIN_HEIGHT_MM: f64 = 0.02;

/// Points on a rim, and rings of points in the middle of the end.
const ON_RIM: usize = 12;
const RINGS: usize = 3;

/// Distance of the heights at which points are checked, as a share of the radius of the middle.
const RADIUS_HEIGHT_STEP: f64 = 0.5;

/// Poses of cuts, sector by sector.
#[derive(Default)]
pub(super) struct Cleared {
    cutters: Vec<ToolSolid>,
    cuts: BTreeMap<u32, Vec<CutPose>>,
}

/// Pose of a cutter in a cut.
struct CutPose {
    tip: Point3<f64>,
    axis: Vector3<f64>,
    cutter: usize,
}

impl Cleared {
    /// The cutter of the next cuts.
    pub(super) fn change_tool(&mut self, cutter: ToolSolid) {
        self.cutters.push(cutter);
    }

    /// Adds a cut.
    pub(super) fn add(&mut self, sector: u32, line: &[PathPoint]) {
        let Some(cutter) = self.cutters.len().checked_sub(1) else { return };
        let poses = line.iter().map(|s| CutPose { tip: s.point.tip, axis: s.point.axis, cutter });
        self.cuts.entry(sector).or_default().extend(poses);
    }

    /// True when a cylinder above the tip of a tool holds no material: with the radius of the middle of its end, and as high
    /// as its flutes are long, mm.
    pub(super) fn holds(&self, program: &Program, sector: u32, at: &ClPoint, radius: f64, height: f64) -> bool {
        let profile = &program.stock.profile;
        let outside = |p: &Point3<f64>| profile.distance([libm::hypot(p.x, p.y), p.z]);
        let step = RADIUS_HEIGHT_STEP * radius;
        let count = (height / step).ceil() as usize;
        let height = |k: usize| MIN_HEIGHT_MM + k as f64 * step;
        let in_blank = |k: &usize| outside(&(at.tip + at.axis * height(*k))) <= libm::hypot(radius, step);
        let Some(top) = (0..=count).rev().find(in_blank) else { return true };
        let across = at.axis.cross(&Vector3::ith(at.axis.iamin(), 1.0)).normalize();
        let other = at.axis.cross(&across);
        let point = |radius: f64, k: usize, height: f64| {
            let (sin, cos) = libm::sincos(TAU * k as f64 / ON_RIM as f64);
            at.tip + (across * cos + other * sin) * radius + at.axis * height
        };
        let near = self.near(sector, at, radius);
        // Cutters are convex: a cutter that holds the polygons about both ends of the cylinder holds the cylinder.
        let about = radius / libm::cos(PI / ON_RIM as f64);
        let ends: Vec<Point3<f64>> =
            [0, top].iter().flat_map(|n| (0..ON_RIM).map(|k| point(about, k, height(*n)))).collect();
        if near.iter().any(|pose| ends.iter().all(|p| self.within(pose, p))) {
            return true;
        }
        let free = |p: &Point3<f64>| outside(p) > 0.0 || near.iter().any(|pose| self.within(pose, p));
        (0..=top).all(|n| {
            free(&point(0.0, 0, height(n)))
                && (1..=RINGS).all(|ring| {
                    let radius = radius * ring as f64 / RINGS as f64;
                    (0..ON_RIM).all(|k| free(&point(radius, k, height(n))))
                })
        })
    }

    /// The poses whose cutters may come near to the axis of a tool, the last one first.
    fn near(&self, sector: u32, at: &ClPoint, radius: f64) -> Vec<&CutPose> {
        let meets = |pose: &&CutPose| {
            let d = pose.tip - at.tip;
            let cutter = &self.cutters[pose.cutter];
            // A pose with another axis comes nearer higher up.
            let tilted = (pose.axis - at.axis).norm() * cutter.flute_length;
            (d - at.axis * d.dot(&at.axis)).norm() <= cutter.radius() + radius + tilted
        };
        self.cuts.get(&sector).map_or_else(Vec::new, |poses| poses.iter().rev().filter(meets).collect())
    }

    /// True when the cutter at a pose holds a point.
    fn within(&self, pose: &CutPose, p: &Point3<f64>) -> bool {
        let d = p - pose.tip;
        let s = d.dot(&pose.axis);
        self.cutters[pose.cutter].cutter_distance((d - pose.axis * s).norm(), s) <= 0.0
    }
}
