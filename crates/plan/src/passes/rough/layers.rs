//! Layers of channel roughing: how deep a tool reaches, and how near to both walls at each place.

use super::wall_tilt::WallTilt;
use crate::passes::context::{ChannelChart, Crossing, Keep, Obstacles, TILT_RESERVE, TableTool, within_tilt};
use crate::spacing;
use base::progress::Progress;
use ir::{CcPoint, Operation, Program};
use nalgebra::{Point3, Vector3};
use nurbs::bracket::Bracket;
use rayon::prelude::*;
use std::cell::{Cell, RefCell};
use wheel::operation::Allowances;
use wheel::part::{BladeId, PassageId, Stock};

/// Share of a layer that rounding may add to a whole number of layers.
const LAYER_ROUNDING: f64 = 1e-9;

/// Spacing of the stations at which a layer is measured, mm. The walls turn slowly: over this distance they leave their
/// chord by a few micrometres, well within the roughing allowance.
const STATION_SPACING: f64 = 0.7;

/// Shares of the path between two stations at which the distances are checked.
const CHECKED_SHARES: [f64; 3] = [0.25, 0.5, 0.75];

/// Largest motion of a border of the free space across the channel beside an edge, over the distance along it (60 deg).
const MAX_EASED_SLOPE: f64 = 1.73;

/// Bisection steps for wall distances and lifts: half a channel divided by 2^10 is about 0.02 mm.
pub(super) const DISTANCE_BISECTIONS: usize = 10;

/// Data and limits of a roughing operation.
#[derive(Clone)]
pub(crate) struct Roughing<'a> {
    pub(crate) chart: ChannelChart<'a>,
    pub(super) passage: PassageId,
    obstacles: &'a Obstacles,
    pub(super) tool: TableTool<'a>,
    /// The turned blank.
    pub(super) blank: &'a Stock,
    /// Distances to keep at the stations, and between them.
    keep: Keep,
    between: Keep,
    /// Tilt of the axis away from the walls.
    tilt: WallTilt,
    /// Largest angle between tool axis and Z that the travel of the rotary axes leaves, radians.
    max_tilt: f64,
    /// u from the inlet, and to the outlet, of a diameter of the tool.
    beside_end: [f64; 2],
    /// The axis does not turn on the leads.
    straight_leads: bool,
    /// The tool may be lifted over the hub by up to a step down.
    lifts: bool,
    /// Spacing of the stations, mm.
    pub(super) spacing: f64,
    pub(super) depth: f64,
    /// Largest deviation of the machine from the path, mm.
    pub(super) tolerance: f64,
    pub(super) lead_in: f64,
    pub(super) lead_out: f64,
}

/// A layer with the free space for the tool at each station.
pub(crate) struct Layer {
    /// Number, from 1 at the shroud.
    pub(crate) number: usize,
    /// Nominal height, 0 at the hub to 1 at the shroud.
    pub(crate) level: f64,
    /// Stations from before the inlet to behind the outlet.
    pub(crate) stations: Vec<LayerStation>,
}

/// Surface on which the tip of a tool runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Level {
    /// At this share of the height from hub (0) to shroud (1).
    Share(f64),
    /// At this distance from the hub, mm.
    OverHub(f64),
    /// At this distance from the shroud, mm, negative above it; nowhere below the hub.
    UnderShroud(f64),
}

impl Level {
    /// Share of the height from hub to shroud at a place of the chart; over 1 above the shroud. On the leads it is that
    /// of the inlet or the outlet, where the hub does not go on below the level.
    pub(crate) fn v(self, chart: &ChannelChart<'_>, u: f64, w: f64) -> f64 {
        let at = if self.goes_on(chart, u) { u } else { u.clamp(0.0, 1.0) };
        self.v_at(&chart.crossing(at), w)
    }

    /// True on the lead of a level over the hub before or behind vanes that end inside of the part: the hub is there as well.
    /// The walls go straight on, and would lead a level that kept its share of the height off the hub.
    fn goes_on(self, chart: &ChannelChart<'_>, u: f64) -> bool {
        let beyond = |end: usize| if end == 0 { u < 0.0 } else { u > 1.0 };
        matches!(self, Self::OverHub(_))
            && (0..2).any(|end| beyond(end) && chart.part().ends_inside(BladeId::MAIN, end))
    }

    /// The same at a crossing.
    fn v_at(self, crossing: &Crossing<'_>, w: f64) -> f64 {
        match self {
            Self::Share(v) => v,
            Self::OverHub(over) => {
                let hub = &crossing.part().hub;
                at_height(over, [0.0, 1.0], |v| hub.distance(&crossing.point(v, w)))
            }
            Self::UnderShroud(depth) => {
                let shroud = &crossing.part().shroud;
                at_height(-depth, [1.0, 0.0], |v| shroud.distance(&crossing.point(v, w))).max(0.0)
            }
        }
    }
}

/// The channel at the u of a station. Tilts, levels and places across the channel are tried there by the hundred.
pub(super) struct StationPlace<'a> {
    at: Crossing<'a>,
    /// The inlet or the outlet, for a station on a lead.
    end: Option<Crossing<'a>>,
    /// Heights of levels that are known: level, w and share of the height.
    known: RefCell<Vec<(Level, f64, f64)>>,
    /// The last lift over the hub, as a share of the height: the next one is near it.
    lift: Cell<f64>,
}

impl<'a> StationPlace<'a> {
    pub(super) fn new(chart: &ChannelChart<'a>, u: f64) -> Self {
        let end = u.clamp(0.0, 1.0);
        let end = (u != end).then(|| chart.crossing(end));
        Self { at: chart.crossing(u), end, known: RefCell::default(), lift: Cell::default() }
    }

    /// u of the place.
    pub(super) fn u(&self) -> f64 {
        self.at.u()
    }

    fn inside(&self) -> &Crossing<'a> {
        self.end.as_ref().unwrap_or(&self.at)
    }

    /// Length of the arc between the walls at a share of the height.
    pub(super) fn width(&self, v: f64) -> f64 {
        self.at.width(v)
    }

    /// [`Level::v`].
    pub(super) fn v(&self, level: Level, w: f64) -> f64 {
        let known = self.known.borrow().iter().find(|k| (k.0, k.1) == (level, w)).map(|k| k.2);
        known.unwrap_or_else(|| {
            let goes_on = level.goes_on(self.at.chart(), self.at.u());
            let v = level.v_at(if goes_on { &self.at } else { self.inside() }, w);
            self.known.borrow_mut().push((level, w, v));
            v
        })
    }
}

/// Error of the height of a level, mm.
const HEIGHT_ERROR: f64 = 1e-3;

/// Share at which the distance from a surface has a given value, by the secant method from two shares. The distance
/// grows along a ruling almost in proportion to the share. On a lead far beyond the end of the part the walls, which go straight
/// on, may have no place at that distance: the share is then that of the nearest distance.
fn at_height(height: f64, [mut a, mut b]: [f64; 2], distance: impl Fn(f64) -> f64) -> f64 {
    const LEVEL_STEPS: usize = 8;
    let (mut at_a, mut at_b) = (distance(a) - height, distance(b) - height);
    for _ in 0..LEVEL_STEPS {
        if at_b.abs() <= HEIGHT_ERROR || at_a == at_b {
            break;
        }
        let next = b - at_b * (b - a) / (at_b - at_a);
        (a, at_a) = (b, at_b);
        (b, at_b) = (next, distance(next) - height);
    }
    let found = at_b.abs() <= HEIGHT_ERROR && (LEVEL_SHARES[0]..=LEVEL_SHARES[1]).contains(&b);
    if found { b } else { nearest_to_height(height, distance) }
}

/// Shares between which a level is sought.
const LEVEL_SHARES: [f64; 2] = [-1.0, 2.0];

/// Share at which the distance from a surface is nearest to a given value.
fn nearest_to_height(height: f64, distance: impl Fn(f64) -> f64) -> f64 {
    const LEVEL_PLACES: usize = 24;
    /// Each takes a third away: down to a millionth of a share.
    const NARROWINGS: usize = 30;
    let step = (LEVEL_SHARES[1] - LEVEL_SHARES[0]) / LEVEL_PLACES as f64;
    let deviation = |v: f64| (distance(v) - height).abs();
    let places = (0..=LEVEL_PLACES).map(|k| LEVEL_SHARES[0] + k as f64 * step);
    let best = places.map(|v| (v, deviation(v))).fold((0.0, f64::INFINITY), |a, b| if b.1 < a.1 { b } else { a }).0;
    let (mut low, mut high) = (best - step, best + step);
    for _ in 0..NARROWINGS {
        let [a, b] = [(2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0];
        if deviation(a) <= deviation(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}

/// Free space for the tool at one u of a layer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LayerStation {
    pub(crate) u: f64,
    /// Least and largest w at which the tool keeps all allowances.
    pub(crate) free: [f64; 2],
}

impl LayerStation {
    /// Middle between the boundaries (Wei: the groove line runs midway between E1 and E2).
    pub(crate) fn middle(&self) -> f64 {
        0.5 * (self.free[0] + self.free[1])
    }
}

/// Layers from a level down, the reason for their end included.
pub(crate) struct Layers {
    pub(crate) top: f64,
    pub(crate) all: Vec<Layer>,
    pub(crate) end: LayersEnd,
}

/// Why the layers end.
pub(crate) enum LayersEnd {
    /// The floor is reached.
    Floor,
    /// The tool does not fit at this station of this level.
    Narrow { level: f64, u: f64 },
}

impl<'a> Roughing<'a> {
    /// `None` for an operation without levels.
    /// Of a cancelled run the tilts are not those that the operation has.
    pub(crate) fn new(
        program: &'a Program,
        operation: &Operation,
        passage: PassageId,
        obstacles: &'a Obstacles,
        progress: &Progress,
    ) -> Option<Self> {
        let depth = operation.kind.step_down()?.get();
        Self::with_depth(program, operation, passage, obstacles, depth, progress)
    }

    /// As [`Self::new`], with levels that lie `depth` apart, mm, whatever the operation says; `None` for finishing.
    pub(super) fn with_depth(
        program: &'a Program,
        operation: &Operation,
        passage: PassageId,
        obstacles: &'a Obstacles,
        depth: f64,
        progress: &Progress,
    ) -> Option<Self> {
        let Allowances { vane, hub } = operation.kind.roughing()?;
        let follows_levels = operation.kind.follows_stock();
        let chart = ChannelChart::new(&program.part, passage);
        let diameter = 2.0 * program.tools[operation.tool].solid.radius();
        let upright = Self {
            tilt: WallTilt::default(),
            chart,
            beside_end: [0.0, 1.0].map(|end| chart.lead(end, 0.5, diameter)),
            passage,
            obstacles,
            tool: TableTool::new(&program.tools[operation.tool].solid),
            blank: &program.stock,
            // The interpolated motion of the machine differs from the planned stations by up to the chord tolerance.
            keep: Keep {
                vane: vane.plus(program.tolerances.chord_rough.get()),
                hub: hub.get() + program.tolerances.chord_rough.get(),
                clearance: program.clearance.get(),
            },
            between: Keep { vane, hub: hub.get(), clearance: program.clearance.get() },
            max_tilt: program.machine.max_tilt() - TILT_RESERVE,
            straight_leads: follows_levels,
            lifts: follows_levels || program.tools[operation.tool].solid.cutter.tip_radius() > 0.0,
            spacing: if follows_levels { spacing::rough_spacing(program) } else { STATION_SPACING },
            depth,
            tolerance: program.tolerances.chord_rough.get(),
            lead_in: operation.lead_in.get(),
            lead_out: operation.lead_out.get(),
        };
        Some(if follows_levels { upright.tilted(progress) } else { upright })
    }

    /// The same with another tilt away from the walls.
    pub(super) fn with_tilt(&self, tilt: WallTilt) -> Self {
        Self { tilt, ..self.clone() }
    }

    /// Distance of the tool axis from a wall at which the allowance is kept at a share of the height.
    fn edge(&self, v: f64) -> f64 {
        self.tool.solid.radius() + self.keep.vane.at(v)
    }

    /// Distance that the tool keeps from the hub, mm.
    pub(super) fn hub_allowance(&self) -> f64 {
        self.keep.hub
    }

    /// Radius of the tool, mm.
    pub(super) fn radius(&self) -> f64 {
        self.tool.solid.radius()
    }

    /// True on leads, and less than a diameter of the tool inside of the inlet or the outlet.
    pub(super) fn is_beside_end(&self, place: &StationPlace<'_>) -> bool {
        let u = place.u();
        u < self.beside_end[0] || u > 1.0 - self.beside_end[1]
    }

    /// Height over the tip up to which the tool cuts, mm.
    pub(super) fn flute_length(&self) -> f64 {
        self.tool.solid.flute_length
    }

    /// True when the end of the cutter is flat.
    pub(super) fn is_flat(&self) -> bool {
        self.tool.solid.cutter.tip_radius() == 0.0
    }

    /// Tool axis at a place of the chart, sector 0. On the leads of `rough` it is that of the inlet or the outlet.
    pub(crate) fn axis(&self, u: f64, v: f64, w: f64) -> Vector3<f64> {
        self.axis_at(&StationPlace::new(&self.chart, u), v, w)
    }

    fn axis_at(&self, place: &StationPlace<'_>, v: f64, w: f64) -> Vector3<f64> {
        let at = if self.straight_leads { place.inside() } else { &place.at };
        within_tilt(at.axis(v, w, self.edge(v), self.tilt.at(at.u())), self.max_tilt)
    }

    /// Station of a line in the chart, sector 0.
    pub(crate) fn cc_point(&self, u: f64, level: Level, w: f64) -> CcPoint {
        let place = StationPlace::new(&self.chart, u);
        let v = place.v(level, w);
        let v = self.lifted(&place, v, w).unwrap_or(v);
        CcPoint { u, v, w, position: place.at.point(v, w), normal: self.axis_at(&place, v, w) }
    }

    /// True when the tool keeps all allowances on the walls.
    pub(super) fn clears_walls(&self, tip: &Point3<f64>, axis: &Vector3<f64>) -> bool {
        self.obstacles.walls_clear(&self.tool, tip, axis, &self.keep)
    }

    /// True when the tool keeps the allowance on the hub.
    pub(super) fn clears_hub(&self, tip: &Point3<f64>, axis: &Vector3<f64>) -> bool {
        self.obstacles.hub_clear(&self.tool, tip, axis, &self.keep)
    }

    /// Number of layers from a level down to the hub.
    pub(crate) fn layer_count(&self, top: f64) -> f64 {
        (self.chart.height() * top / self.depth - LAYER_ROUNDING).ceil().max(1.0)
    }

    /// Layers from `top` (a level already cleared, 1 for the shroud) down, and the reason for their end. `name` is the
    /// name of the operation, for `progress`.
    pub(crate) fn layers(&self, top: f64, name: &str, progress: &Progress) -> Layers {
        let count = self.layer_count(top);
        let work = progress.begin(format!("{name}, layers"), count as usize);
        let mut layers = Layers { top, all: Vec::new(), end: LayersEnd::Floor };
        for number in 1..=count as usize {
            if progress.is_cancelled() {
                break;
            }
            let level = top * (1.0 - number as f64 / count);
            match self.layer(number, level) {
                Ok(layer) => layers.all.push(work.step(layer)),
                Err(u) => {
                    work.rest_is_needless();
                    return Layers { end: LayersEnd::Narrow { level, u }, ..layers };
                }
            }
        }
        layers
    }

    /// Measures a layer; an error is the u at which the tool does not fit.
    fn layer(&self, number: usize, level: f64) -> Result<Layer, f64> {
        let ends = self.ends(Level::Share(level));
        let from = ends[0] - self.chart.lead(0.0, level, self.lead_in);
        let to = ends[1] + self.chart.lead(1.0, level, self.lead_out);
        let length = length_of(|u| self.chart.point(u, level, 0.5), from, to);
        let count = (length / self.spacing).ceil().max(8.0) as usize;
        let stations = (0..=count)
            .into_par_iter()
            .map(|i| {
                let u = from + (to - from) * i as f64 / count as f64;
                self.free_interval(u, Level::Share(level)).map(|free| LayerStation { u, free }).ok_or(u)
            })
            .collect::<Vec<_>>();
        // The first station without space, independent of the thread that found it.
        let mut stations = stations.into_iter().collect::<Result<Vec<_>, f64>>()?;
        limit_leads(&mut stations, self.free_ends(), |_, u| (ends[0]..=ends[1]).contains(&u))?;
        self.ease(Level::Share(level), &mut stations)?;
        Ok(Layer { number, level, stations })
    }

    /// Height of the tip at (u, w) of a level, as a share. A tool with a rounded tip, and every tool of `rough`, is lifted
    /// until it keeps the allowance on the hub. `None` when the lift exceeds the step to the layer above.
    fn lifted(&self, place: &StationPlace<'_>, level: f64, w: f64) -> Option<f64> {
        let clear = |v: f64| {
            let (tip, axis) = (place.at.point(v, w), self.axis_at(place, v, w));
            self.obstacles.hub_clear(&self.tool, &tip, &axis, &self.keep)
        };
        if clear(level) {
            return Some(level);
        }
        if !self.lifts {
            return None;
        }
        let ruling = (place.at.point(1.0, w) - place.at.point(0.0, w)).norm();
        let ends = Bracket { holds: level + (self.depth + self.keep.hub) / ruling, fails: level };
        clear(ends.holds).then(|| {
            let border = ends.halved_near(DISTANCE_BISECTIONS, level + place.lift.get(), clear);
            place.lift.set(border.holds - level);
            border.holds
        })
    }

    /// True when the tool keeps all allowances at w of a level.
    pub(super) fn clear(&self, place: &StationPlace<'_>, level: Level, w: f64) -> bool {
        self.lifted(place, place.v(level, w), w).is_some_and(|v| {
            let (tip, axis) = (place.at.point(v, w), self.axis_at(place, v, w));
            self.obstacles.walls_clear(&self.tool, &tip, &axis, &self.keep)
        })
    }

    /// True at the ends of the channel that lie inside of the part.
    pub(super) fn free_ends(&self) -> [bool; 2] {
        [0, 1].map(|end| self.chart.part().ends_inside(BladeId::MAIN, end))
    }

    /// u at which the middle of a level comes into the blank and leaves it: 0 and 1, but before and behind vanes that end
    /// inside of the part.
    pub(super) fn ends(&self, level: Level) -> [f64; 2] {
        /// Most steps to the outside of the blank.
        const MAX_OUTWARD_STEPS: u32 = 200;
        let free = self.free_ends();
        [0, 1].map(|end: usize| {
            let (u, outward) = (end as f64, if end == 0 { -1.0 } else { 1.0 });
            if !free[end] {
                return u;
            }
            let height = |u: f64| level.v(&self.chart, u, 0.5);
            let step = outward * self.chart.lead(u, height(u), self.spacing);
            let at = |k: u32| u + step * f64::from(k);
            let inside = |k: &u32| self.blank.distance(&self.chart.point(at(*k), height(at(*k)), 0.5)) < 0.0;
            at((0..MAX_OUTWARD_STEPS).take_while(inside).count() as u32)
        })
    }

    /// In a passage with a blade that ends inside of the part, lets the borders of the free space move gradually from station
    /// to station: before the edge of the blade the tool turns off, and behind it the tool comes back. An error is the u of a
    /// station that then has no space.
    pub(super) fn ease(&self, level: Level, stations: &mut [LayerStation]) -> Result<(), f64> {
        let part = self.chart.part();
        if !part.blade_ids().any(|blade| [0, 1].iter().any(|end| part.ends_inside(blade, *end))) {
            return Ok(());
        }
        let step = |station: &LayerStation| {
            MAX_EASED_SLOPE * self.spacing / self.chart.width(station.u, level.v(&self.chart, station.u, 0.5))
        };
        let steps: Vec<f64> = stations.iter().map(step).collect();
        let inner = |a: [f64; 2], b: [f64; 2], step: f64| [a[0].max(b[0] - step), a[1].min(b[1] + step)];
        for i in 1..stations.len() {
            stations[i].free = inner(stations[i].free, stations[i - 1].free, steps[i]);
        }
        for i in (1..stations.len()).rev() {
            stations[i - 1].free = inner(stations[i - 1].free, stations[i].free, steps[i - 1]);
        }
        stations.iter().find(|s| s.free[0] > s.free[1]).map_or(Ok(()), |s| Err(s.u))
    }

    /// True when the tool keeps the allowances on a straight path from a station of a level to the next, along one border
    /// of the free space.
    pub(super) fn joined(&self, level: Level, stations: [&LayerStation; 2], side: usize) -> bool {
        let [from, to] = stations.map(|s| self.cc_point(s.u, level, s.free[side]));
        CHECKED_SHARES.iter().all(|t| {
            let tip = from.position + (to.position - from.position) * *t;
            let axis = (from.normal + (to.normal - from.normal) * *t).normalize();
            self.obstacles.walls_clear(&self.tool, &tip, &axis, &self.between)
                && self.obstacles.hub_clear(&self.tool, &tip, &axis, &self.between)
        })
    }
}

/// Limits the space of the leads, where no walls are, to that of the nearest station inside; a line that widened there
/// would cut across the edges of the vanes. An error is the u of a lead that then has no space. Before a vane that ends inside
/// of the part the lines clear the whole width, and turn off as before a splitter: `free` is true for such ends.
pub(super) fn limit_leads(
    stations: &mut [LayerStation],
    free: [bool; 2],
    inside: impl Fn(usize, f64) -> bool,
) -> Result<(), f64> {
    let inside: Vec<bool> = stations.iter().enumerate().map(|(k, s)| inside(k, s.u)).collect();
    let (Some(first), Some(last)) = (inside.iter().position(|x| *x), inside.iter().rposition(|x| *x)) else {
        return Ok(());
    };
    let edges = [stations[first].free, stations[last].free];
    let limited = |k: usize| (k < first && !free[0]) || (k > last && !free[1]);
    for (k, s) in stations.iter_mut().enumerate().filter(|(k, _)| limited(*k)) {
        let edge = edges[usize::from(k > last)];
        s.free = [s.free[0].max(edge[0]), s.free[1].min(edge[1])];
        if s.free[0] > s.free[1] {
            return Err(s.u);
        }
    }
    Ok(())
}

/// Length of a line in the channel from one u to another, mm.
pub(super) fn length_of(point: impl Fn(f64) -> Point3<f64>, from: f64, to: f64) -> f64 {
    let at = |k: i32| point(from + (to - from) * f64::from(k) / 50.0);
    (0..50).map(|i| (at(i + 1) - at(i)).norm()).sum()
}
