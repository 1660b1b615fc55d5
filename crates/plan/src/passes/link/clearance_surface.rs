//! The clearance surface: a distance outside of blank and clamping, and the paths at rapid from one place on it to another.
//!
//! Blank and clamping are turned about Z, so that a turn of the table keeps their distances to the tool. The tool leaves
//! along its axis until all of it is on this surface or outside of it. Then all axes go evenly to the place over the next
//! start. To the next sector the table turns, and the tool hardly moves. The distances at places along this motion decide
//! whether the tool can go. Where it cannot, it goes out farther first, at last to the clearance sphere.

use super::blank::Blank;
use super::clearance_sphere::ClearanceSphere;
use five_axis::{Joints, Machine, RotaryPose, between, most_turn};
use ir::{ClPoint, Program};
use nalgebra::Vector3;
use tool_stock::collide::ToolSolid;

/// Distance of the tool from blank and clamping where a rapid begins or ends, mm, and least distance between.
const RAPID_DISTANCE_MM: f64 = 2.0;
const MIN_DISTANCE_MM: f64 = 1.0;

/// Distances by which the tool goes out farther where the path is not free, mm.
const RAISES: [f64; 5] = [0.0, 3.0, 8.0, 18.0, 40.0];

/// Deviation of the chord from the path of the tip round the part over a step, mm, and longest turn of a step, radians.
const PATH_CHORD: f64 = 0.5;
const MAX_STEP_TURN: f64 = 0.35;

/// Places that are checked: largest turn between two of them, radians, and longest motion of the linear axes, mm.
const CHECK_TURN: f64 = 0.04;
const CHECK_DISTANCE_MM: f64 = 2.0;

/// Accuracy of the height of a place over a pass, mm.
const HEIGHT_ERROR_MM: f64 = 0.1;

/// The clearance surface of a tool.
pub(super) struct ClearanceSurface<'a> {
    machine: &'a Machine,
    blank: Blank<'a>,
    sphere: ClearanceSphere,
}

impl<'a> ClearanceSurface<'a> {
    pub(super) fn new(program: &'a Program, tool: &'a ToolSolid) -> Self {
        Self {
            machine: &program.machine,
            blank: Blank::new(&program.stock, tool),
            sphere: ClearanceSphere::new(program, tool),
        }
    }

    /// The place along the tool axis from which on the tool is outside of the surface.
    pub(super) fn lifted(&self, from: &ClPoint) -> ClPoint {
        let at = |height: f64| from.tip + from.axis * height;
        let mut height = self.sphere.exit(&from.tip, &from.axis);
        while height > 0.0 {
            // No point of the tool comes nearer by more than the tool moves.
            let free = self.blank.distance(&at(height), &from.axis).least() - RAPID_DISTANCE_MM;
            if free <= HEIGHT_ERROR_MM {
                break;
            }
            height = (height - free).max(0.0);
        }
        ClPoint { tip: at(height), axis: from.axis, contact: None }
    }

    /// Places from a place outside to one from which the tool rises along Z of the machine to any height, without the first
    /// and with the last: out along the tool axis, and where that is not enough, over the clearance sphere.
    pub(super) fn path_to_rise(&self, from: &RotaryPose) -> Vec<RotaryPose> {
        let to_part = self.machine.part_to_machine(from.rotary).inverse();
        let (up, axis) = (to_part * Vector3::z(), self.axis(from));
        let exit = self.sphere.exit(&from.tip, &axis);
        let raised = |p: &RotaryPose, by: f64, along: &Vector3<f64>| RotaryPose { tip: p.tip + along * by, ..*p };
        // Above the whole blank.
        let rises = |p: &RotaryPose| self.is_free(&[*p, raised(p, self.sphere.size(), &up)]);
        for raise in RAISES.into_iter().map(|raise| raise.min(exit)).chain([exit]) {
            let place = raised(from, raise, &axis);
            if rises(&place) {
                return if raise > 0.0 { vec![place] } else { Vec::new() };
            }
        }
        let out = raised(from, exit, &axis);
        let over = RotaryPose { tip: self.sphere.above(&axis, &up), ..*from };
        let path = self.sphere.around(&self.machine.chain, &out, &over);
        [out].into_iter().chain(path).chain([over]).collect()
    }

    /// Approximate time of the path over the surface from one pose to another, s. On the surface the tool goes at rapid, below
    /// it with a feed, mm/min.
    pub(super) fn time(&self, from: &ClPoint, to: &ClPoint, feed: f64) -> f64 {
        let [out, back] = [from, to].map(|p| self.lifted(p).tip);
        ((out - from.tip).norm() + (back - to.tip).norm()) / (feed / 60.0)
            + self.sphere.path_length(&out, &back) / self.machine.rapid
    }

    /// Places on the path from one place outside to another, without both.
    pub(super) fn path_over(&self, from: &RotaryPose, to: &RotaryPose) -> Vec<RotaryPose> {
        let raised = |p: &RotaryPose, height: f64| RotaryPose { tip: p.tip + self.axis(p) * height, ..*p };
        let exits = [from, to].map(|p| self.sphere.exit(&p.tip, &self.axis(p)));
        for raise in RAISES {
            let ends = [raised(from, raise.min(exits[0])), raised(to, raise.min(exits[1]))];
            let between = self.evenly(&ends);
            let path: Vec<RotaryPose> = [ends[0]].into_iter().chain(between).chain([ends[1]]).collect();
            if self.is_free(&path) {
                return without_ends(path, [from, to]);
            }
        }
        let ends = [raised(from, exits[0]), raised(to, exits[1])];
        let over = self.sphere.around(&self.machine.chain, &ends[0], &ends[1]);
        without_ends([ends[0]].into_iter().chain(over).chain([ends[1]]).collect(), [from, to])
    }

    fn axis(&self, p: &RotaryPose) -> Vector3<f64> {
        self.machine.chain.tool_axis(p.rotary)
    }

    /// Places between two others: the tip straight in the frame of the machine, the rotary axes even. Without a head all axes
    /// have then gone the same share of their way.
    fn evenly(&self, [from, to]: &[RotaryPose; 2]) -> Vec<RotaryPose> {
        let xyz = [from, to].map(|p| self.machine.joints(&p.tip, p.rotary).xyz);
        let radius = [from, to].map(|p| p.tip.coords.norm()).into_iter().fold(0.0, f64::max);
        let step = (8.0 * PATH_CHORD / radius.max(PATH_CHORD)).sqrt().min(MAX_STEP_TURN);
        let count = (most_turn(from.rotary, to.rotary) / step).ceil() as usize;
        (1..count)
            .map(|i| {
                let share = i as f64 / count as f64;
                let rotary = between(from.rotary, to.rotary, share);
                RotaryPose {
                    tip: self.machine.forward(&Joints { xyz: xyz[0].lerp(&xyz[1], share), rotary }).tip,
                    rotary,
                }
            })
            .collect()
    }

    /// True when the tool keeps its distances on the straight paths between places. Beside a clamping it may be as near as
    /// half of its distance at the ends.
    fn is_free(&self, path: &[RotaryPose]) -> bool {
        let distance = |p: &RotaryPose| self.blank.distance(&p.tip, &self.axis(p));
        let (Some(first), Some(last)) = (path.first(), path.last()) else { return true };
        let clamping = MIN_DISTANCE_MM.min(0.5 * distance(first).clamping.min(distance(last).clamping));
        clamping > 0.0
            && path.windows(2).all(|w| {
                let turn = most_turn(w[0].rotary, w[1].rotary);
                let xyz = [0, 1].map(|k: usize| self.machine.joints(&w[k].tip, w[k].rotary).xyz);
                let length = (xyz[1] - xyz[0]).norm();
                let checks = (turn / CHECK_TURN).max(length / CHECK_DISTANCE_MM).ceil().max(1.0) as usize;
                (0..=checks).all(|k| {
                    let found = distance(&w[0].towards(&w[1], k as f64 / checks as f64));
                    found.blank >= MIN_DISTANCE_MM && found.clamping >= clamping
                })
            })
    }
}

/// A path without its ends where they are known.
fn without_ends(mut path: Vec<RotaryPose>, [from, to]: [&RotaryPose; 2]) -> Vec<RotaryPose> {
    if path.first() == Some(from) {
        path.remove(0);
    }
    if path.last() == Some(to) {
        path.pop();
    }
    path
}
