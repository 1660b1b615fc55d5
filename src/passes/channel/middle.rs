//! The middle of the floor, which a ball larger than that of the fillets finishes.
//!
//! Its outer lines keep the allowance of the job from vanes and fillets. Where walls or tool leave no room for the ball,
//! lines end: they come down and rise on arcs along the direction of the channel, in which the walls go apart least.

use super::axes::hub_points;
use super::finished::{Finished, edges};
use super::floor::{ChannelFloor, contact};
use crate::collide::{Cutter, ToolSolid};
use crate::geom::BandMetric;
use crate::ir::{CcPass, CcPoint, ClPoint, Drive, Operation, OperationId, Program};
use crate::part::Part;
use crate::passes::context::{AxisTilt, ChannelChart, Obstacles, maximal_ranges};
use crate::passes::lines::{DriveSurface, METRIC_STATIONS, arc_radius, both_walls};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Places along the floor and its leads where the room of the ball is looked at.
const PLACES: usize = 240;

/// Height of the place beside a wall, as a share of the vane, up to which a wall counts as continued. A ball may be
/// higher than a vane.
const TOP: f64 = 2.0;

/// Least width of a stretch at its widest place, mm. Less is a single line.
const LEAST_WIDTH: f64 = 0.1;

/// A part of the floor along which the ball fits.
#[derive(Clone, Copy, Debug)]
pub(super) struct FloorStretch {
    /// u of both ends.
    pub(super) ends: [f64; 2],
    /// True at an end where lines run out of the part.
    open: [bool; 2],
}

/// Where the larger ball of an operation finishes the floor.
pub(crate) struct Middle<'a> {
    pub(super) floor: ChannelFloor<'a>,
    pub(super) stretches: Vec<FloorStretch>,
    chart: ChannelChart<'a>,
}

/// The larger balls of a program, by operation. One that touches vane and hub nowhere is missing.
pub(crate) type Middles<'a> = BTreeMap<OperationId, Middle<'a>>;

/// The operations of larger balls that come before an operation in its item, the last first.
pub(super) fn before(program: &Program, id: OperationId) -> impl Iterator<Item = OperationId> {
    let earlier: Vec<_> = program.operations.iter().take_while(|(other, _)| *other != id).collect();
    earlier.into_iter().rev().take_while(|(_, o)| o.kind.of_larger_ball().is_some()).map(|(id, _)| id)
}

impl<'a> Middle<'a> {
    /// The floor between the outer lines of a ball, without stretches. `None` for operations without a larger ball, and
    /// where a ruling has no place for the ball.
    pub(crate) fn new(program: &'a Program, operation: &Operation) -> Option<Self> {
        let radius = program.tools[operation.tool].solid.cutter.tip_radius();
        Self::of_ball(&program.part, radius, operation.kind.of_larger_ball()?.get())
    }

    fn of_ball(part: &'a Part, radius: f64, allowance: f64) -> Option<Self> {
        // A ball smaller than the fillet stands where the fillet ends.
        let rolling = part.main().fillet.map_or(radius, |f| f.get().max(radius));
        let [first, second] =
            part.first_passage().walls.map(|side| contact(part, side, [rolling + allowance, rolling], TOP));
        let floor = ChannelFloor { part, radius, walls: [first?, second?], finished: Vec::new() };
        Some(Self { floor, stretches: Vec::new(), chart: ChannelChart::new(part) })
    }

    /// Places along the floor and its leads where the ball has to fit.
    pub(crate) fn places(&self, operation: &Operation) -> Vec<f64> {
        let lead = operation.lead_in.get().max(operation.lead_out.get());
        let [from, to] = [0.0, 1.0].map(|u| lead / self.speed(u));
        (0..=PLACES).map(|i| i as f64 / PLACES as f64 * (1.0 + from + to) - from).collect()
    }

    fn speed(&self, u: f64) -> f64 {
        self.floor.part.hub.meridian(u).first.norm()
    }

    /// The tool at a place along the floor, and at a share of the way between the outer lines.
    pub(crate) fn tool_at(
        &self,
        program: &Program,
        operation: &Operation,
        (u, share): (f64, f64),
        tilt: AxisTilt,
    ) -> Option<ClPoint> {
        // Axes on the leads are those of the edge.
        let points = vec![self.contact_at(u.clamp(0.0, 1.0), share), self.contact_at(u, share)];
        let pass = CcPass { label: String::new(), drive: Drive::Hub, points, path: None };
        hub_points(program, operation, &pass, tilt).pop()
    }

    fn contact_at(&self, u: f64, share: f64) -> CcPoint {
        let (first, angle) = self.floor.walls(u);
        self.floor.point(u, share, first + angle * share)
    }

    /// True where the ball fits between both outer lines and is clear of the part on them.
    pub(crate) fn has_room(&self, obstacles: &Obstacles, u: f64) -> bool {
        let radius = self.floor.radius;
        let ball = ToolSolid {
            cutter: Cutter::Lollipop { radius },
            flute_length: 2.0 * radius,
            shank: Vec::new(),
            holder: Vec::new(),
        };
        let clear = |share: f64| {
            let p = self.contact_at(u, share);
            obstacles.cutter_inside(&ball, &p.position, &p.normal).is_none()
        };
        self.floor.walls(u).1 > 0.0 && [0.0, 1.0].into_iter().all(clear)
    }

    /// Keeps the stretches along which the ball fits; `fits` is given at `places`. Of an end inside of the floor it keeps
    /// off by the arc on which lines come down, and it leaves out stretches shorter than the ball.
    pub(crate) fn keep(&mut self, operation: &Operation, places: &[f64], fits: &[bool]) {
        let leads = [operation.lead_in, operation.lead_out];
        let arc = leads.map(|lead| arc_radius(lead.get(), self.floor.radius)).into_iter().fold(0.0, f64::max);
        for range in maximal_ranges(places.len(), |i| fits[i]) {
            let (first, last) = (range.start, range.end - 1);
            let open = [first == 0, last + 1 == places.len()];
            let ends = [
                if open[0] { 0.0 } else { places[first] + arc / self.speed(places[first]) },
                if open[1] { 1.0 } else { places[last] - arc / self.speed(places[last]) },
            ]
            .map(|u| u.clamp(0.0, 1.0));
            let stretch = FloorStretch { ends, open };
            if self.length(stretch) > 2.0 * self.floor.radius && self.widest(stretch) > LEAST_WIDTH {
                self.stretches.push(stretch);
            }
        }
    }

    /// Length of the meridian over a stretch, mm; zero where the ends have crossed.
    fn length(&self, FloorStretch { ends: [from, to], .. }: FloorStretch) -> f64 {
        let at = |i: usize| self.floor.part.hub.meridian(from + (to - from) * i as f64 / PLACES as f64).point;
        if to > from { (0..PLACES).map(|i| (at(i + 1) - at(i)).norm()).sum() } else { 0.0 }
    }

    fn widest(&self, FloorStretch { ends: [from, to], .. }: FloorStretch) -> f64 {
        let width = |u: f64| self.floor.walls(u).1 * self.floor.part.hub.meridian(u).point.x;
        (0..=PLACES).map(|i| width(from + (to - from) * i as f64 / PLACES as f64)).fold(0.0, f64::max)
    }

    /// True where the ball fits somewhere.
    pub(crate) fn fits(&self) -> bool {
        !self.stretches.is_empty()
    }

    /// What the plan says about the room of the ball.
    pub(super) fn note(&self, allowance: f64) -> String {
        let whole = self.length(FloorStretch { ends: [0.0, 1.0], open: [true; 2] });
        let fits: f64 = self.stretches.iter().map(|s| self.length(*s)).sum();
        let radius = self.floor.radius;
        format!(
            "middle of the floor: a ball of radius {radius} mm, {allowance} mm off vanes and fillets, fits on {fits:.1} of {whole:.1} mm from inlet to outlet"
        )
    }

    /// What the lines of this ball finish, for ridges of a height.
    pub(super) fn finished(&self, height: f64) -> impl Iterator<Item = Finished> {
        self.stretches.iter().map(move |stretch| {
            let surface = StretchFloor { middle: self, stretch: *stretch, finished: &[] };
            let metric = surface.metric(height);
            let [first, second] = both_walls(&surface, metric.stations());
            Finished::new(metric, stretch.ends, stretch.open, [&first, &second])
        })
    }
}

/// The middle of the floor along one stretch, x from its first end to its last.
pub(super) struct StretchFloor<'a> {
    pub(super) middle: &'a Middle<'a>,
    pub(super) stretch: FloorStretch,
    /// What larger balls have finished.
    pub(super) finished: &'a [Finished],
}

impl StretchFloor<'_> {
    fn length(&self) -> f64 {
        self.stretch.ends[1] - self.stretch.ends[0]
    }

    fn u(&self, x: f64) -> f64 {
        self.stretch.ends[0] + self.length() * x
    }
}

impl DriveSurface for StretchFloor<'_> {
    fn name(&self) -> String {
        self.middle.floor.name()
    }

    fn walls(&self, x: f64) -> (f64, f64) {
        self.middle.floor.walls(self.u(x))
    }

    fn contact(&self, x: f64, y: f64, share: f64) -> CcPoint {
        self.middle.floor.point(self.u(x), share, y)
    }

    fn open(&self) -> [bool; 2] {
        self.stretch.open
    }

    /// Along the rulings of both walls, blended: so the ball stays as far from them as it is.
    fn rise(&self, at: &CcPoint) -> Vector3<f64> {
        self.middle.chart.ruling(at.u.clamp(0.0, 1.0), at.w)
    }

    fn finished(&self, x: f64) -> Option<[f64; 2]> {
        let u = self.u(x);
        edges(self.finished, u, self.middle.floor.walls(u).0)
    }

    fn speed(&self, x: f64, y: f64, slope: f64) -> f64 {
        let length = self.length();
        self.middle.floor.speed(self.u(x), y, slope / length) * length
    }

    fn metric(&self, height: f64) -> BandMetric {
        let hub = &self.middle.floor.part.hub;
        let length = self.length();
        // Until the ball has passed the ends, but well before the axis.
        let beyond = [0.0, 1.0].map(|x| {
            let m = hub.meridian(self.u(x));
            self.middle.floor.radius.min(0.5 * m.point.x) / (m.first.norm() * length)
        });
        BandMetric::new(-beyond[0], 1.0 + beyond[1], METRIC_STATIONS + 1, |x| {
            let m = hub.meridian(self.u(x));
            let [along, across] = self.middle.floor.steps(self.u(x), height);
            [m.first.norm() * length / along, m.point.x / across]
        })
    }

    fn least_length(&self, height: f64) -> f64 {
        self.middle.floor.least_length_over(self.stretch.ends, height, self.finished)
    }
}
