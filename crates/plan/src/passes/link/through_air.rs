//! Paths of the tool through the air of the simulated stock.
//!
//! A cutter that is enlarged by the error between the rays of the stock decides where it is in air; its shank and holder
//! count as well. A link is a straight path or a smooth curve that leaves the end of a pass along the tool axis and comes
//! down along the tool axis at the start of the next. It keeps a distance to the known stock and is clear of the part.

use super::direct_link::DirectLinks;
use super::stock_steps::{PathPoint, error_between_rays, stations, steps_of};
use crate::passes::axis::run::rotary;
use five_axis::{Machine, between};
use ir::{ClPass, ClPoint, Program};
use tool_stock::collide::ToolSolid;
use tool_stock::stock::{self, Depth, Field, Step, StepKind};
use wheel::operation::Allowances;

/// Depth beyond the error between the rays up to which a cutter that slides along its own cut is in air, mm: the planned
/// stations keep their lines to less.
const OWN_CUT_DEPTH_MM: f64 = 0.02;

/// Distance that the cutter keeps from the known stock on a link, mm: cusps narrower than a cell stand between the rays.
const LINK_FREE: f64 = 0.1;

/// Distances to the part beyond those of every link: stock that is left on purpose is no air.
const THROUGH_AIR: Allowances = Allowances::NONE;

/// Longest link through air, mm.
const LONGEST_LINK: f64 = 80.0;

/// Heights that the tool lifts by on a link, mm.
const LIFTS: [f64; 8] = [0.5, 1.0, 2.0, 4.0, 6.0, 10.0, 18.0, 30.0];

/// Time that a corner between straight paths costs, s: the tool stops there, since finishing rounds corners within the chord
/// tolerance only. Some 50 ms with the jerk of usual axes.
const CORNER_TIME_S: f64 = 0.05;

/// Straight pieces of a curved link: a turn of less than 30 deg lies between two of them.
const LINK_PIECES: usize = 12;

/// Finds air around the tool of an operation.
pub(super) struct ThroughAir<'a> {
    machine: &'a Machine,
    direct: &'a DirectLinks<'a>,
    /// Depth up to which the cutter slides along its own cut, mm.
    pub(super) slivers: f64,
    /// The tool, its cutter enlarged by the error of the depth between the rays of the stock.
    cutting: EnlargedTool,
    /// The tool, its cutter enlarged by this error and by the free distance of links.
    linking: EnlargedTool,
}

/// A tool with an enlarged cutter.
struct EnlargedTool {
    solid: ToolSolid,
    /// Enlargement, mm.
    by: f64,
}

impl EnlargedTool {
    fn new(tool: &ToolSolid, by: f64) -> Self {
        let solid = ToolSolid { shank: tool.shank.clone(), holder: tool.holder.clone(), ..tool.cutter_alone(by) };
        Self { solid, by }
    }
}

impl<'a> ThroughAir<'a> {
    pub(super) fn new(program: &'a Program, direct: &'a DirectLinks<'a>, tool: &ToolSolid, field: &Field) -> Self {
        let by = error_between_rays(field, tool);
        Self {
            machine: &program.machine,
            direct,
            slivers: by + OWN_CUT_DEPTH_MM * direct.scale(),
            cutting: EnlargedTool::new(tool, by),
            linking: EnlargedTool::new(tool, by + LINK_FREE * direct.scale()),
        }
    }

    /// Places between the end of a pass and the start of the next, with straight paths through air between them, clear of
    /// the part; none where the tool needs no lift.
    pub(super) fn link(&self, end: &ClPoint, start: &ClPoint, field: &Field) -> Option<Vec<ClPoint>> {
        if (start.tip - end.tip).norm() > LONGEST_LINK {
            return None;
        }
        let same_place = start.tip == end.tip && start.axis == end.axis;
        if same_place || self.clear(&[*end, *start], field) {
            return Some(Vec::new());
        }
        LIFTS
            .iter()
            .find_map(|lift| self.curve(end, start, *lift, field).or_else(|| self.lifted(end, start, *lift, field)))
    }

    /// As [`Self::link`], on straight paths only: the quickest of all lifts, for a feed of the tip in mm/s.
    pub(super) fn quickest(&self, end: &ClPoint, start: &ClPoint, feed: f64, field: &Field) -> Option<Vec<ClPoint>> {
        if (start.tip - end.tip).norm() > LONGEST_LINK {
            return None;
        }
        let same_place = start.tip == end.tip && start.axis == end.axis;
        if same_place || self.clear(&[*end, *start], field) {
            return Some(Vec::new());
        }
        let angles = rotary(&self.machine.chain, [end.axis, start.axis].into_iter());
        let turn = |k: usize| (angles[1][k] - angles[0][k]).abs() / self.machine.rotary[k].speed;
        let turns = turn(0).max(turn(1));
        let time = |places: &Vec<ClPoint>| {
            let path: Vec<ClPoint> = [*end].into_iter().chain(places.iter().copied()).chain([*start]).collect();
            // The motion during which the axes turn takes as long as they need.
            let times = path.windows(2).map(|w| {
                let time = (w[1].tip - w[0].tip).norm() / feed;
                if w[0].axis == w[1].axis { time } else { time.max(turns) }
            });
            times.sum::<f64>() + places.len() as f64 * CORNER_TIME_S
        };
        let found = LIFTS.iter().filter_map(|lift| self.lifted(end, start, *lift, field));
        let mut timed: Vec<(f64, Vec<ClPoint>)> = found.map(|places| (time(&places), places)).collect();
        timed.sort_by(|a, b| a.0.total_cmp(&b.0));
        timed.into_iter().next().map(|found| found.1)
    }

    /// The places of a link on a cubic Bezier curve whose inner control points lie above its ends. It is a third higher
    /// than the tool has to be in the middle.
    fn curve(&self, end: &ClPoint, start: &ClPoint, lift: f64, field: &Field) -> Option<Vec<ClPoint>> {
        let angles = rotary(&self.machine.chain, [end.axis, start.axis].into_iter());
        let control = [end, start].map(|p| p.tip + p.axis * (lift * 4.0 / 3.0));
        let at = |t: f64| {
            let s = 1.0 - t;
            let tip = end.tip.coords * (s * s * s)
                + control[0].coords * (3.0 * s * s * t)
                + control[1].coords * (3.0 * s * t * t)
                + start.tip.coords * (t * t * t);
            let axis = self.machine.chain.tool_axis(between(angles[0], angles[1], t * t * (3.0 - 2.0 * t)));
            ClPoint { tip: tip.into(), axis, contact: None }
        };
        let places: Vec<ClPoint> = (1..LINK_PIECES).map(|k| at(k as f64 / LINK_PIECES as f64)).collect();
        let (first, last) = (places.first()?, places.last()?);
        let leaves = [[*end, *first], [*last, *start]];
        let clear = places.windows(2).all(|w| self.clear(&[w[0], w[1]], field))
            && leaves.iter().all(|ends| {
                self.direct.straight(&ends[0], &ends[1], THROUGH_AIR) && self.is_free(ends, self.slivers, field)
            });
        clear.then_some(places)
    }

    /// The places of a link straight up, across and straight down. A place over one of both ends is enough where the tool
    /// can rise or come down on its path.
    fn lifted(&self, end: &ClPoint, start: &ClPoint, lift: f64, field: &Field) -> Option<Vec<ClPoint>> {
        let [up, down] = [end, start].map(|p| ClPoint { tip: p.tip + p.axis * lift, axis: p.axis, contact: None });
        // The path up along the axis lies in the space that the tool has just cut.
        if !self.clear(&[up, down], field) || !self.is_free(&[down, *start], self.slivers, field) {
            return None;
        }
        if self.clear(&[*end, down], field) {
            return Some(vec![down]);
        }
        if self.clear(&[up, *start], field) {
            return Some(vec![up]);
        }
        Some(vec![up, down])
    }

    /// True when the tool goes straight from one place to another through air, clear of the part.
    fn clear(&self, places: &[ClPoint; 2], field: &Field) -> bool {
        self.direct.straight(&places[0], &places[1], THROUGH_AIR) && self.passes(&self.linking, places, 0.0, field)
    }

    /// True when the tool meets no stock deeper than `most` on a straight path.
    pub(super) fn is_free(&self, places: &[ClPoint; 2], most: f64, field: &Field) -> bool {
        self.passes(&self.cutting, places, most, field)
    }

    fn passes(&self, tool: &EnlargedTool, places: &[ClPoint; 2], most: f64, field: &Field) -> bool {
        let steps = tool.steps(self.machine, &self.straight_path(*places));
        stock::is_free(field, &tool.solid, &steps, most)
    }

    /// Stations of a straight path.
    pub(super) fn straight_path(&self, ends: [ClPoint; 2]) -> Vec<PathPoint> {
        let pass = ClPass { label: String::new(), sector: 0, points: ends.into(), air: Vec::new(), link: None };
        stations(self.machine, &pass)
    }

    /// Depth of the tool in the stock on each step between stations, mm; infinite where it is more than `enough`.
    pub(super) fn depths(&self, line: &[PathPoint], enough: f64, field: &Field) -> Vec<f64> {
        let steps = self.cutting.steps(self.machine, line);
        stock::depths(field, &self.cutting.solid, &steps, enough).iter().map(|d| self.of_tool(d)).collect()
    }

    /// A shank or a holder that touches stock is never in air.
    fn of_tool(&self, depth: &Depth) -> f64 {
        let body = if depth.body > 0.0 { depth.body.max(2.0 * self.slivers) } else { 0.0 };
        depth.cutter.max(body)
    }
}

impl EnlargedTool {
    /// The steps between stations.
    fn steps(&self, machine: &Machine, line: &[PathPoint]) -> Vec<Step> {
        steps_of(machine, line, StepKind::Rapid, self.by).collect()
    }
}
