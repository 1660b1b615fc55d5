//! The middle of the floor, which a ball larger than that of the fillets finishes, or a bull nose.
//!
//! Its outer lines keep the allowance of the job from vanes and fillets. Where the tool does not fit, lines end: they
//! come down and rise on arcs along the direction of the channel, in which the walls go apart least.

use super::axes::hub_points;
use super::finished::{Finished, edges};
use super::floor::{ChannelFloor, contacts};
use super::lead::BullNose;
use crate::passes::context::{AxisTilt, ChannelChart, Obstacles, maximal_ranges};
use crate::passes::lines::{DriveSurface, METRIC_STATIONS, SurfaceLine, arc_radius, both_walls, highest_ridge};
use base::units::Mm;
use ir::{CcPass, CcPoint, ClPoint, Drive, Operation, OperationId, Program};
use nalgebra::Vector3;
use nurbs::BandMetric;
use nurbs::angle::nearest_turn;
use std::collections::BTreeMap;
use tool_stock::collide::{Cutter, ToolSolid};
use wheel::part::{FloorBorder, Passage, PassageId, Rolling};

/// Places along the floor and its leads at which the tool is tried.
const FLOOR_PLACES: usize = 240;

/// Height of the place beside a wall, as a share of the vane, up to which a wall counts as continued. A ball may be
/// higher than a vane.
const TOP: f64 = 2.0;

/// Least width of an interval at its widest place, mm. Less is a single line.
const MIN_WIDTH_MM: f64 = 0.1;

/// Layers of the metric of a bull nose, from the first outer line to the second.
const METRIC_LAYERS: usize = 25;

/// Places along an interval at which the range of azimuths is measured, minus one.
const AZIMUTH_INTERVALS: usize = 60;

/// A part of the floor along which the tool fits.
#[derive(Clone, Copy, Debug)]
pub(super) struct FloorInterval {
    /// u of both ends.
    pub(super) ends: [f64; 2],
    /// True at an end where lines run out of the part.
    open: [bool; 2],
}

/// Where the larger tool of an operation finishes the floor.
pub(crate) struct Middle<'a> {
    pub(super) floor: ChannelFloor<'a>,
    pub(super) intervals: Vec<FloorInterval>,
    chart: ChannelChart<'a>,
    /// `None` for a ball.
    bull_nose: Option<BullNose>,
}

/// Distances of the outer lines of a bull nose from the place where its corner is beside the fillet, as shares of its radius:
/// the side of the tool does not tilt with the walls as that of a ball does. The least one is for the errors of samples.
const CORNER_DISTANCE_SHARES: [f64; 11] = [0.02, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];

/// The larger tools of a program, by operation and passage. One that touches vane and hub nowhere is missing.
pub(crate) type Middles<'a> = BTreeMap<(OperationId, PassageId), Middle<'a>>;

/// The operations of larger tools that come before an operation in its item, the last first.
pub(super) fn before(program: &Program, id: OperationId) -> impl Iterator<Item = OperationId> {
    let earlier: Vec<_> = program.operations.iter().take_while(|(other, _)| *other != id).collect();
    earlier.into_iter().rev().take_while(|(_, o)| o.kind.of_larger_tool().is_some()).map(|(id, _)| id)
}

impl<'a> Middle<'a> {
    /// The floor between the outer lines of the tool, without intervals, for each distance of the outer lines that comes into
    /// question. Nothing for operations without a larger tool, and where a ruling has no place for the tool or no
    /// lead keeps its heel out of the hub.
    pub(crate) fn all(program: &'a Program, operation: &Operation, passage: Passage) -> Vec<Self> {
        let cutter = program.tools[operation.tool].solid.cutter;
        let (part, radius) = (&program.part, cutter.nominal_radius());
        let Some(allowance) = operation.kind.of_larger_tool().map(Mm::get) else { return Vec::new() };
        // A rounding smaller than the fillet stands where the fillet ends.
        let rolling =
            part.main().fillet.as_ref().map_or(cutter.tip_radius(), |f| f.most().get().max(cutter.tip_radius()));
        let chart = ChannelChart::new(part, passage.id);
        let bull_nose = if cutter.ends_in_ball() { None } else { Some(BullNose::new(&chart, cutter)) };
        let beyond = match bull_nose {
            None => vec![0.0],
            Some(None) => Vec::new(),
            Some(Some(_)) => CORNER_DISTANCE_SHARES.map(|share| radius - cutter.tip_radius() + share * radius).to_vec(),
        };
        let at = |beyond: f64| {
            let ball = Rolling { wall: rolling + beyond + allowance, floor: rolling, top: TOP };
            let walls = contacts(part, &passage, FloorBorder::Ball(ball), f64::INFINITY)?;
            let floor = ChannelFloor { part, passage, radius, walls, finished: Vec::new() };
            Some(Self { floor, intervals: Vec::new(), chart, bull_nose: bull_nose.flatten() })
        };
        beyond.into_iter().filter_map(at).collect()
    }

    /// Takes the second outer line of another middle.
    pub(crate) fn up_to(&mut self, other: &Self) {
        self.floor.walls[1].clone_from(&other.floor.walls[1]);
    }

    /// What drives the tool of lines in the middle.
    pub(super) fn drive(&self) -> Drive {
        let passage = self.floor.passage.id;
        self.bull_nose.map_or(Drive::Hub(passage), |tool| Drive::HubWithLead(passage, tool.lead))
    }

    /// Places along the floor and its leads where the tool has to fit.
    pub(crate) fn places(&self, operation: &Operation) -> Vec<f64> {
        let lead = operation.lead_in.get().max(operation.lead_out.get());
        let [from, to] = [0.0, 1.0].map(|u| lead / self.speed(u));
        (0..=FLOOR_PLACES).map(|i| i as f64 / FLOOR_PLACES as f64 * (1.0 + from + to) - from).collect()
    }

    fn speed(&self, u: f64) -> f64 {
        self.floor.part.hub.meridian(u).first.norm()
    }

    /// The tool at a place along the floor, and at a share of the distance between the outer lines.
    pub(crate) fn tool_at(
        &self,
        program: &Program,
        operation: &Operation,
        u: f64,
        share: f64,
        tilt: AxisTilt,
    ) -> Option<ClPoint> {
        // Axes on the leads are those of the edge.
        let points = vec![self.contact_at(u.clamp(0.0, 1.0), share), self.contact_at(u, share)];
        let pass = CcPass { label: String::new(), drive: self.drive(), points, path: None };
        hub_points(program, operation, &pass, |_| tilt).pop()
    }

    fn contact_at(&self, u: f64, share: f64) -> CcPoint {
        let (first, angle) = self.floor.walls(u);
        self.floor.point(u, share, first + angle * share)
    }

    /// Width of the floor between both outer lines, mm; negative where they have crossed.
    fn width(&self, u: f64) -> f64 {
        self.width_to(self, u)
    }

    /// Width from the first outer line to the second one of another middle, mm; negative where they have crossed.
    pub(crate) fn width_to(&self, other: &Self, u: f64) -> f64 {
        let (first, (of_other, across)) = (self.floor.walls(u).0, other.floor.walls(u));
        (nearest_turn(of_other, first) - first + across) * self.floor.part.hub.meridian(u).point.x
    }

    /// True where the outer lines of a ball leave floor between them, and the ball is clear of the part on both. A bull nose
    /// is tried with its axis.
    pub(crate) fn has_free_space(&self, obstacles: &Obstacles, u: f64) -> bool {
        let radius = self.floor.radius;
        let ball = ToolSolid {
            cutter: Cutter::lollipop(radius),
            flute_length: 2.0 * radius,
            shank: Vec::new(),
            holder: Vec::new(),
        };
        let clear = |share: f64| {
            let p = self.contact_at(u, share);
            obstacles.cutter_inside(&ball, &p.position, &p.normal).is_none()
        };
        self.width(u) > 0.0 && (self.bull_nose.is_some() || [0.0, 1.0].into_iter().all(clear))
    }

    /// Keeps the intervals along which the tool fits; `fits` is given at `places`. Of an end inside of the floor it keeps
    /// off by the arc on which lines come down, and it leaves out intervals shorter than the tool is wide.
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
            let interval = FloorInterval { ends, open };
            if self.length(interval) > 2.0 * self.floor.radius && self.widest(interval) > MIN_WIDTH_MM {
                self.intervals.push(interval);
            }
        }
    }

    /// Length of the meridian over an interval, mm; zero where the ends have crossed.
    fn length(&self, FloorInterval { ends: [from, to], .. }: FloorInterval) -> f64 {
        let at = |i: usize| self.floor.part.hub.meridian(from + (to - from) * i as f64 / FLOOR_PLACES as f64).point;
        if to > from { (0..FLOOR_PLACES).map(|i| (at(i + 1) - at(i)).norm()).sum() } else { 0.0 }
    }

    fn widest(&self, FloorInterval { ends: [from, to], .. }: FloorInterval) -> f64 {
        (0..=FLOOR_PLACES).map(|i| self.width(from + (to - from) * i as f64 / FLOOR_PLACES as f64)).fold(0.0, f64::max)
    }

    /// True where the tool fits somewhere.
    pub(crate) fn fits(&self) -> bool {
        !self.intervals.is_empty()
    }

    /// What the plan says about the intervals in which the tool fits.
    pub(super) fn note(&self, allowance: f64) -> String {
        let whole = self.length(FloorInterval { ends: [0.0, 1.0], open: [true; 2] });
        let fits: f64 = self.intervals.iter().map(|s| self.length(*s)).sum();
        let radius = self.floor.radius;
        let tool = match self.bull_nose {
            None => format!("a ball of radius {radius} mm"),
            Some(tool) => format!(
                "a bull nose of radius {radius} mm with a lead angle of {:.1} deg, from inlet to outlet on all lines",
                tool.lead.to_degrees()
            ),
        };
        format!(
            "middle of the floor: {tool}, {allowance} mm off vanes and fillets, fits on {fits:.1} of {whole:.1} mm from inlet to outlet"
        )
    }

    /// What the lines of this tool finish, for ridges of a height.
    pub(super) fn finished(&self, height: f64) -> impl Iterator<Item = Finished> {
        self.intervals.iter().map(move |interval| {
            let surface = IntervalFloor { middle: self, interval: *interval, finished: &[] };
            let metric = surface.metric(height);
            let [first, second] = both_walls(&surface, metric.stations());
            Finished::new(metric, interval.ends, interval.open, [&first, &second])
        })
    }
}

/// The middle of the floor along one interval, x from its first end to its last.
pub(super) struct IntervalFloor<'a> {
    pub(super) middle: &'a Middle<'a>,
    pub(super) interval: FloorInterval,
    /// What larger tools have finished.
    pub(super) finished: &'a [Finished],
}

impl IntervalFloor<'_> {
    fn length(&self) -> f64 {
        self.interval.ends[1] - self.interval.ends[0]
    }

    fn u(&self, x: f64) -> f64 {
        self.interval.ends[0] + self.length() * x
    }
}

impl DriveSurface for IntervalFloor<'_> {
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
        self.interval.open
    }

    /// Along the rulings of both walls, blended: so the ball stays as far from them as it is.
    fn rise(&self, _x: f64, at: &CcPoint) -> Vector3<f64> {
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
        // Until the tool has passed the ends, but well before the axis.
        let beyond = [0.0, 1.0].map(|x| {
            let m = hub.meridian(self.u(x));
            self.middle.floor.radius.min(0.5 * m.point.x) / (m.first.norm() * length)
        });
        let (range, count) = ([-beyond[0], 1.0 + beyond[1]], METRIC_STATIONS + 1);
        // Along and around, mm per unit of x and of y.
        let speeds = |u: f64| {
            let m = hub.meridian(u);
            [m.first.norm() * length, m.point.x]
        };
        let Some(tool) = self.middle.bull_nose else {
            return BandMetric::new(range[0], range[1], count, |x| {
                let u = self.u(x);
                let (speeds, steps) = (speeds(u), self.middle.floor.steps(u, height));
                [speeds[0] / steps[0], speeds[1] / steps[1]]
            });
        };
        let [first, second] = both_walls(self, (0..=AZIMUTH_INTERVALS).map(|i| i as f64 / AZIMUTH_INTERVALS as f64));
        let (low, high) = (first.into_iter().reduce(f64::min), second.into_iter().reduce(f64::max));
        let walls = [low.unwrap_or_default(), high.unwrap_or_default()];
        BandMetric::over(range, count, walls, METRIC_LAYERS, |x, y| {
            let u = self.u(x);
            let [along, around] = speeds(u);
            let (first, across) = self.walls(x.clamp(0.0, 1.0));
            let w = ((y - first) / across).clamp(0.0, 1.0);
            let form = tool.ridges(&self.middle.chart, u, w, height);
            let skew = form[(0, 1)] / form[(1, 1)];
            let square = form[(0, 0)] - skew * form[(0, 1)];
            [along * square.max(0.0).sqrt(), around * form[(1, 1)].max(0.0).sqrt(), skew * along / around]
        })
    }

    /// The metric of a ball is exact enough.
    fn highest_ridge(&self, lines: &[SurfaceLine]) -> Option<f64> {
        let tool = self.middle.bull_nose.filter(|_| self.finished.is_empty())?;
        let chart = &self.middle.chart;
        // The lines with their leads: the ridge at an end is cut from beyond it.
        let x = |p: &CcPoint| (p.u - self.interval.ends[0]) / self.length();
        let poses = |line: &SurfaceLine| line.points.iter().filter_map(|p| tool.pose(chart, x(p), p)).collect();
        let place = |x: f64, y: f64| self.middle.floor.part.hub.point(self.u(x), y);
        highest_ridge(tool.cutter(), lines, poses, |x| self.walls(x), place)
    }

    fn least_length(&self, height: f64) -> f64 {
        let floor = &self.middle.floor;
        floor.least_length_over(self.interval.ends, self.finished, |u| match self.middle.bull_nose {
            None => floor.largest_step(u, height),
            Some(tool) => tool.largest_step(&self.middle.chart, u, height),
        })
    }
}
