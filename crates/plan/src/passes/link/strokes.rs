//! Strokes of `plunge` against the stock that they find, one after the other.
//!
//! Before: strokes from above the stock to the floor, in all sectors. After: strokes that cut. Each begins above its first
//! contact with the stock, goes down along its axis, moves off the material that it has cut, and goes up along its axis
//! again. It is left out where it would cut nothing, or no more than the thickness of rest machining.
//!
//! A stroke ends before the middle of the end, which has no teeth, meets material. The distance of the strokes keeps the
//! middle over space that earlier strokes have cleared; where their floors are higher than the floor of this stroke, it
//! ends on their height.

use super::direct_link::DirectLinks;
use super::stock_order::{Reduced, assembled};
use super::stock_steps::{PathPoint, cut, stations, steps_of};
use super::through_air::ThroughAir;
use base::progress::Work;
use ir::{ClOperation, ClPass, ClPoint, Operation, Program};
use nalgebra::{Unit, UnitQuaternion, Vector3};
use std::f64::consts::TAU;
use tool_stock::collide::{Cutter, ToolSolid};
use tool_stock::stock::{self, Field, Step, StepKind};
use wheel::operation::Allowances;

/// Distance by which a stroke moves off the material that it has cut, as a share of the radius, and its largest value, mm.
const WITHDRAWAL_SHARE: f64 = 0.1;
const MAX_WITHDRAWAL_MM: f64 = 0.3;

/// Directions across the axis that are tried for this motion.
const DIRECTIONS: usize = 12;

/// Depth of material in the middle of the end that counts as air, mm: teeth rise from the rim towards the middle, and the
/// rays of the stock end within a few micrometres.
const UNDER_MIDDLE: f64 = 0.02;

/// Parts into which the last step of a stroke is divided, for its end: steps are a quarter of a millimetre long.
const LAST_STEP_PARTS: usize = 16;

/// Strokes of one operation.
struct StrokeReduction<'a> {
    program: &'a Program,
    operation: &'a Operation,
    direct: &'a DirectLinks<'a>,
    air: ThroughAir<'a>,
    cutter: ToolSolid,
    /// The middle of the end without teeth; `None` for a tool that cuts at its centre.
    middle: Option<ToolSolid>,
    /// Motion off the material, mm.
    withdrawal: f64,
    thickness: f64,
}

/// Cuts the strokes of an operation one after the other, and removes them from the stock.
pub(super) fn reduce(
    program: &Program,
    operation: &Operation,
    direct: &DirectLinks<'_>,
    planned: &mut ClOperation,
    field: &mut Field,
    work: &Work,
) {
    let tool = &program.tools[operation.tool];
    let cutter = tool.solid.cutter_alone(0.0);
    let radius = tool.solid.radius();
    let toothless = tool.toothless_radius().unwrap_or(0.0);
    let strokes = StrokeReduction {
        program,
        operation,
        direct,
        air: ThroughAir::new(program, direct, &tool.solid, field),
        middle: (toothless > 0.0).then(|| ToolSolid { cutter: Cutter::flat(toothless), ..cutter.clone() }),
        cutter,
        withdrawal: (WITHDRAWAL_SHARE * radius).min(MAX_WITHDRAWAL_MM),
        thickness: operation.rest.map_or(0.0, |t| t.get()),
    };
    let mut kept: Vec<ClPass> = Vec::new();
    let mut count = StrokeCount::default();
    for pass in std::mem::take(&mut planned.passes) {
        if work.do_step(|| ()).is_none() {
            return;
        }
        let before = kept.last().and_then(|p| p.points.last()).copied();
        if let Some(pass) = strokes.cut(&pass, before, field, &mut count) {
            kept.push(pass);
        }
    }
    planned.notes.push(count.text(kept.len(), field.cell()));
    planned.passes = kept;
}

/// What became of the strokes.
#[derive(Default)]
struct StrokeCount {
    /// Strokes before the reduction.
    planned: usize,
    /// Strokes that end above their floor, and the largest height over it, mm.
    short: usize,
    highest: f64,
    /// Strokes that go straight up, and strokes with a link through air from the one before.
    straight: usize,
    linked: usize,
    /// Length of the path at cutting feed and at link feed, mm.
    lengths: [f64; 2],
}

impl StrokeCount {
    fn text(&self, kept: usize, cell: f64) -> String {
        let [cut, air] = self.lengths;
        format!(
            "{} strokes planned; {kept} cut, {} of them linked to the one before through air, {} straight up; {} end up to \
             {:.2} mm over their floor, where the middle of the end would meet material; {cut:.0} mm at cutting feed, \
             {air:.0} mm at link feed; stock in cells of {cell:.2} mm",
            self.planned, self.linked, self.straight, self.short, self.highest
        )
    }
}

impl StrokeReduction<'_> {
    /// A stroke that cuts, with its retraction and its link; its cut is removed from the stock.
    fn cut(
        &self,
        pass: &ClPass,
        before: Option<ClPoint>,
        field: &mut Field,
        count: &mut StrokeCount,
    ) -> Option<ClPass> {
        count.planned += 1;
        let whole = stations(&self.program.machine, pass);
        let line = self.over_middle(&whole, field);
        let least = self.thickness.max(self.air.slivers);
        let depths = self.air.depths(&line, least, field);
        let first = depths.iter().position(|d| *d > least)?;
        let last = depths.iter().rposition(|d| *d > self.air.slivers)? + 1;
        let missing = length(whole.last()?, line.last()?);
        if last == depths.len() && missing > 0.0 {
            count.short += 1;
            count.highest = count.highest.max(missing);
        }
        // The motion down begins above the first contact.
        let lead = self.operation.lead_in.get();
        let start = (0..first).rev().find(|i| length(&line[*i], &line[first]) >= lead).unwrap_or(0);
        let link = before.and_then(|end| self.air.link(&end, &line[start].point, field));
        let mut path = line[start..=last].to_vec();
        // The lower end is a station of the pass also where the tool finds air below it.
        if let Some(end) = path.last_mut() {
            end.planned = true;
        }
        let mut found = depths[start..last].to_vec();
        cut(&self.program.machine, &path, &self.cutter, field);
        let (out, aside) = self.out(&line[start].point, &line[last].point, field);
        count.straight += usize::from(!aside);
        for part in out {
            path.extend_from_slice(&part[1..]);
            found.resize(path.len() - 1, 0.0);
        }
        count.linked += usize::from(link.is_some());
        let Reduced { mut pass, lengths } = assembled(pass, &path, &found);
        count.lengths = [0, 1].map(|k: usize| count.lengths[k] + lengths[k]);
        pass.link = link;
        Some(pass)
    }

    /// The stations of a stroke down to where the middle of the end would meet material.
    fn over_middle(&self, line: &[PathPoint], field: &Field) -> Vec<PathPoint> {
        let Some(middle) = &self.middle else { return line.to_vec() };
        let machine = &self.program.machine;
        let meets = |line: &[PathPoint]| {
            let steps: Vec<Step> = steps_of(machine, line, StepKind::Rapid, 0.0).collect();
            stock::depths(field, middle, &steps, UNDER_MIDDLE).iter().position(|d| d.cutter > UNDER_MIDDLE)
        };
        let Some(step) = meets(line) else { return line.to_vec() };
        let [from, to] = [line[step].point, line[step + 1].point];
        let points = (0..=LAST_STEP_PARTS).map(|k| {
            let tip = from.tip + (to.tip - from.tip) * (k as f64 / LAST_STEP_PARTS as f64);
            ClPoint { tip, ..from }
        });
        let pass = ClPass { label: String::new(), sector: 0, points: points.collect(), air: Vec::new(), link: None };
        let fine = stations(machine, &pass);
        let end = meets(&fine).unwrap_or(LAST_STEP_PARTS);
        let mut short = line[..=step].to_vec();
        if end > 0 {
            short.push(fine[end]);
        }
        short
    }

    /// The path from the end of a stroke to the height of its start: off the material and up, or straight up. True for the
    /// first.
    fn out(&self, start: &ClPoint, end: &ClPoint, field: &Field) -> (Vec<Vec<PathPoint>>, bool) {
        let paths = |places: &[ClPoint]| -> Vec<Vec<PathPoint>> {
            places.windows(2).map(|w| self.air.straight_path([w[0], w[1]])).collect()
        };
        if let Some([aside, up]) = self.aside(start, end, field) {
            return (paths(&[*end, aside, up]), true);
        }
        (paths(&[*end, *start]), false)
    }

    /// A place beside the end of a stroke, away from the material that it has cut, and the place above it, where the tool
    /// reaches both through air and clear of the part.
    fn aside(&self, start: &ClPoint, end: &ClPoint, field: &Field) -> Option<[ClPoint; 2]> {
        let axis = Unit::new_normalize(end.axis);
        let across = end.axis.cross(&Vector3::ith(end.axis.iamin(), 1.0)).normalize();
        let rise = (start.tip - end.tip).norm();
        let places = |direction: Vector3<f64>| {
            let aside = ClPoint { tip: end.tip + direction * self.withdrawal, ..*end };
            [aside, ClPoint { tip: aside.tip + end.axis * rise, ..aside }]
        };
        let kept = self.operation.kind.roughing().unwrap_or(Allowances::NONE);
        let free = |direction: &Vector3<f64>| {
            let [aside, up] = places(*direction);
            self.air.is_free(&[*end, aside], self.air.slivers, field)
                && self.air.is_free(&[aside, up], self.air.slivers, field)
                && self.direct.straight(&aside, &up, kept)
        };
        let sum: Vector3<f64> = (0..DIRECTIONS)
            .map(|k| UnitQuaternion::from_axis_angle(&axis, TAU * k as f64 / DIRECTIONS as f64) * across)
            .filter(free)
            .sum();
        // In a place with material on all sides but opposite ones, the mean direction says nothing.
        let mean = sum.try_normalize(0.1)?;
        free(&mean).then(|| places(mean))
    }
}

/// Distance of two stations, mm.
fn length(a: &PathPoint, b: &PathPoint) -> f64 {
    (a.point.tip - b.point.tip).norm()
}
