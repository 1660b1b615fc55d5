//! Lines of `rough` on which the stock would load the tool over its limit.
//!
//! Levels lie one step down apart, measured from hub or shroud. Along a tool axis that leans by 65 deg against this
//! direction the step is 2.4 times as long; and where walls lean, levels leave strips that stand beside the flutes of those
//! below. Where a line would load the tool as a slot deeper than its limit, that part of it runs first some way over the
//! line along the tool axis, and once more over this part where that is not enough. A tool that is nowhere thinner above
//! than below then sweeps only what it sweeps on the line itself, and what lies over its end.
//!
//! The load is the sum over the depth of the share of the arc in 180 deg, which the verifier measures by a simulation of
//! its own.

use super::stock_steps::{PathPoint, leaves_along_axis, path_length, stations, steps_of};
use crate::passes::context::maximal_ranges;
use base::units::trim;
use five_axis::Machine;
use ir::{ClPass, ClPoint, Tool};
use std::f64::consts::PI;
use std::ops::Range;
use tool_stock::collide::{Cutter, ToolSolid};
use tool_stock::stock::{self, Field, SLICES, Sides, Slices, StepKind};

/// Share of the limit that a planned cut may reach: the stock of the planner has larger cells than that of the verifier.
const PLANNED_SHARE: f64 = 0.8;

/// Height of a part of a line over the line, as a share of the limit; each further part lies half as high.
const LIFT_SHARE: f64 = 0.75;

/// Most parts over one place of a line, each of which is cut before the next is found needed.
pub(super) const MAX_LIFTS: i32 = 2;

/// Tip motion over which what is removed counts together, in cells: the rays meet the chips of single steps by chance.
const WINDOW_CELLS: f64 = 2.0;

/// Depth up to which stock beside the flutes is what the tool slides along, in depths of that kind.
const BESIDE_FLUTES: f64 = 2.0;

/// Path between two parts of a line that are one, in radii of the tool.
const JOINED_RADII: f64 = 4.0;

/// What the label of a part over a line has before its height.
const LIFTED: &str = " lifted ";

/// Whether a pass is a part over a line.
pub(super) fn is_lifted(pass: &ClPass) -> bool {
    pass.label.contains(LIFTED)
}

/// A line, as far as the tool cuts it.
pub(super) struct Line {
    pub(super) pass: ClPass,
    /// Its points between which the tool has to cut.
    pub(super) points: Range<usize>,
    /// Height over the line of a level along the tool axes, mm.
    height: f64,
}

impl Line {
    /// A whole pass of a level.
    pub(super) fn whole(pass: &ClPass) -> Self {
        Self { points: 0..pass.points.len(), pass: pass.clone(), height: 0.0 }
    }

    /// The steps between stations of its pass on which the tool has to cut.
    pub(super) fn steps(&self, stations: &[PathPoint]) -> Range<usize> {
        let planned: Vec<usize> = (0..stations.len()).filter(|i| stations[*i].planned).collect();
        let at = |point: usize| planned.get(point).copied().unwrap_or(stations.len());
        at(self.points.start)..at(self.points.end.saturating_sub(1))
    }

    fn raised(&self, by: f64) -> ClPass {
        let points = self.pass.points.iter().map(|p| ClPoint { tip: p.tip + p.axis * by, ..*p }).collect();
        ClPass { points, ..self.pass.clone() }
    }

    /// The part of the line between some of its points, higher along the tool axis.
    fn part(&self, points: Range<usize>, by: f64) -> Self {
        let height = self.height + by;
        let name = self.pass.label.split(LIFTED).next().unwrap_or(&self.pass.label);
        let label = format!("{name}{LIFTED}{} mm", trim(height, 2));
        Self { pass: ClPass { label, ..self.raised(by) }, points, height }
    }
}

/// The tool of an operation, and what loads it.
pub(super) struct LiftedLines<'a> {
    machine: &'a Machine,
    cutter: ToolSolid,
    /// A flat end as wide as that of the cutter: between lines of the level before stand ridges beside a round end.
    wide: ToolSolid,
    /// Limit of the load, mm of a slot.
    limit: f64,
    /// Whether the tool keeps clear over its lines.
    keeps_clear: bool,
}

impl<'a> LiftedLines<'a> {
    pub(super) fn new(machine: &'a Machine, tool: &Tool) -> Self {
        let solid = &tool.solid;
        let limit = tool.max_depth.get();
        let cutter = solid.cutter_alone(0.0);
        let wide = ToolSolid { cutter: Cutter::flat(cutter.cutter.nominal_radius()), ..cutter.clone() };
        Self { machine, cutter, wide, limit, keeps_clear: leaves_along_axis(solid) }
    }

    /// The parts over a line that the tool cuts before the line, after those of earlier rounds; none where the line loads the
    /// tool within its limit. Stock no deeper in the tool than `slivers` is its own cut.
    pub(super) fn over(&self, line: &Line, round: i32, slivers: f64, field: &Field) -> Vec<Line> {
        let lift = LIFT_SHARE * self.limit * 0.5_f64.powi(round);
        if !self.keeps_clear || line.height + lift >= self.cutter.flute_length {
            return Vec::new();
        }
        // A line over which the tool meets no stock cannot load it over its limit. A part over it leaves stock beside its end.
        if round == 0 {
            let above = stations(self.machine, &line.raised(self.limit * PLANNED_SHARE));
            let steps: Vec<stock::Step> = steps_of(self.machine, &above, StepKind::Cut, 0.0).collect();
            if stock::is_free(field, &self.wide, &steps, BESIDE_FLUTES * slivers) {
                return Vec::new();
            }
        }
        self.overloaded(line, field).into_iter().map(|points| line.part(points, lift)).collect()
    }

    /// The parts of a line that load the tool over its limit, by their points.
    fn overloaded(&self, line: &Line, field: &Field) -> Vec<Range<usize>> {
        let places = stations(self.machine, &line.pass);
        // The point of the line at or before each station.
        let mut passed = 0;
        let point: Vec<usize> = places
            .iter()
            .map(|place| {
                passed += usize::from(place.planned);
                passed - 1
            })
            .collect();
        let mut over = vec![false; line.pass.points.len()];
        for (step, load) in self.loads(&places, field) {
            let from = point[step];
            if load > PLANNED_SHARE * self.limit && line.points.contains(&from) {
                over[from] = true;
                over[point[step + 1]] = true;
            }
        }
        let between = |from: usize, to: usize| {
            line.pass.points[from..=to].windows(2).map(|pair| (pair[1].tip - pair[0].tip).norm()).sum::<f64>()
        };
        let mut parts: Vec<Range<usize>> = Vec::new();
        for part in maximal_ranges(over.len(), |k| over[k]) {
            match parts.last_mut() {
                Some(last) if between(last.end - 1, part.start) < JOINED_RADII * self.cutter.radius() => {
                    last.end = part.end;
                }
                _ => parts.push(part),
            }
        }
        parts
    }

    /// The load on each step between stations that removes material, mm of a slot.
    fn loads(&self, places: &[PathPoint], field: &Field) -> Vec<(usize, f64)> {
        let mut field = field.clone();
        let radius = self.cutter.cutter.widest_below(self.cutter.flute_length);
        let slices = Slices::new(self.cutter.flute_length, field.cell());
        let steps = steps_of(self.machine, places, StepKind::Cut, 0.0);
        let cuts = stock::simulate(&mut field, &self.cutter, steps).cuts;
        let load = |last: usize| {
            let end = cuts[last].block as usize;
            let (mut sides, mut path, mut behind) = (Sides::NONE, 0.0, end + 1);
            for cut in cuts[..=last].iter().rev() {
                let step = cut.block as usize;
                path += path_length(&places[step..=behind]);
                if step < end && path > WINDOW_CELLS * field.cell() {
                    break;
                }
                sides.join(&cut.sides);
                behind = step;
            }
            (end, slot(&sides, &slices, radius))
        };
        (0..cuts.len()).map(load).collect()
    }
}

/// Depth of a slot that loads a cutter as much as what is removed to both sides of its axis, mm.
fn slot(sides: &Sides, slices: &Slices, radius: f64) -> f64 {
    let arc = |[from, to]: [f64; 2]| {
        let angle = |side: f64| libm::asin((side / radius).clamp(-1.0, 1.0));
        (angle(to) - angle(from)).max(0.0)
    };
    let of_slice = |k: usize| {
        let [whole, free] = [Some(sides.over(k..=k)), sides.free_between(k)].map(|ends| ends.map_or(0.0, arc));
        (whole - free) / PI * (slices.edge(k + 1) - slices.edge(k))
    };
    (0..SLICES).map(of_slice).sum()
}
