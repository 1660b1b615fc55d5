//! Lines of constant scallop on a surface between two walls: everywhere as far apart as the scallop allows.
//!
//! Ridges are measured in the metric (I / R + II) / 8h of the surface. The unit of this metric is the step in any
//! direction: a ball of radius R that follows a line leaves 4h d^2 at the distance d from it. For other cutters the
//! second fundamental form of the cutter at the contact replaces I / R.

mod constant_scallop;
mod ridges;
pub mod scallop;
mod stations;

use crate::passes::context::{PassContext, STATIONS};
use crate::tolerance_budget::interpolation;
use constant_scallop::{Track, tracks};
use diagnostics::{Aborted, Diag, codes::planning};
use ir::{CcPoint, Operation};
use nalgebra::Vector3;
use nurbs::BandMetric;
pub(crate) use ridges::{CutterPose, highest_ridge};
use stations::{Straightness, straight};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use wheel::method::Lines as Order;

/// Stations of the metric, minus one.
pub(crate) const METRIC_STATIONS: usize = 600;

/// Stations of an arc at the end of a line that begins or ends inside of the surface. They are dense, and thinned to the
/// chord tolerance: corners of the arc bound the feed, so that few large ones would cost more time than many small ones.
const ARC_STATIONS: usize = 64;

/// Width of a surface, in steps, below which one line covers the surface: a ball that rolls along both walls at once.
const MIN_WIDTH_STEPS: f64 = 1e-3;

/// Most rounds of planning the lines, until the ridges have the required height. The metric is correct to second order, and
/// knows only the rounding at the contact of the cutter.
const MAX_ROUNDS: usize = 4;

/// Share of the required height for which lines are planned: ridges are measured in some columns only.
const PLANNED_HEIGHT_SHARE: f64 = 0.99;

/// Ratio of the target to the highest ridge up to which the height counts as well used.
const MAX_TARGET_RATIO: f64 = 1.04;

/// Largest growth of the height per round.
const MAX_GROWTH: f64 = 3.0;

/// A surface with x along its lines, from 0 to 1, and y across them.
pub(crate) trait DriveSurface: Sync {
    /// What a set of lines covers, in words.
    fn name(&self) -> String;

    /// y of the first wall at x, and the difference from it to the second wall.
    fn walls(&self, x: f64) -> (f64, f64);

    /// Contact at (x, y); `share` is the share of the path from wall to wall. x may lie beyond both ends.
    fn contact(&self, x: f64, y: f64, share: f64) -> CcPoint;

    /// True at an end (x = 0, x = 1) where the leads of a line may run on beyond the surface; at other ends lines rise
    /// on an arc.
    fn open(&self) -> [bool; 2] {
        [true; 2]
    }

    /// Direction in which a line that begins or ends inside of the surface, at x, comes down and rises.
    fn rise(&self, _x: f64, at: &CcPoint) -> Vector3<f64> {
        at.normal
    }

    /// A contact of a lead or an arc, moved off the hub where the cutter would cut into it there.
    fn off_hub(&self, at: CcPoint) -> CcPoint {
        at
    }

    /// The edges in y, at x, of what earlier tools have finished; half a step of theirs beside their outer lines. `None`
    /// where they have finished nothing.
    fn finished(&self, _x: f64) -> Option<[f64; 2]> {
        None
    }

    /// Length along a line of a slope dy/dx at (x, y), mm per unit of x.
    fn speed(&self, x: f64, y: f64, slope: f64) -> f64;

    /// Metric whose unit is the step for ridges of the given height.
    fn metric(&self, height: f64) -> BandMetric;

    /// Highest measured ridge between lines; `None` where the metric is exact enough.
    fn highest_ridge(&self, _lines: &[SurfaceLine]) -> Option<f64> {
        None
    }

    /// Lower bound of the length of all lines: each point takes the largest step of any direction.
    fn least_length(&self, height: f64) -> f64;
}

/// y of the first and of the second wall at places x.
pub(crate) fn both_walls(surface: &dyn DriveSurface, places: impl Iterator<Item = f64>) -> [Vec<f64>; 2] {
    let (first, second) = places
        .map(|x| {
            let (y, across) = surface.walls(x);
            (y, y + across)
        })
        .unzip();
    [first, second]
}

/// A line on a surface.
pub(crate) struct SurfaceLine {
    /// True when it is cut towards smaller x.
    back: bool,
    /// Contacts on the surface, on the leads and on the arcs, by ascending x until the line is cut.
    pub(crate) points: Vec<CcPoint>,
    /// Contacts on the surface with their x, ascending.
    pub(crate) on_surface: Vec<(f64, CcPoint)>,
    /// True when the line begins or ends inside of the surface.
    partial: bool,
}

impl SurfaceLine {
    /// A line of contacts on the surface only, by ascending x.
    pub(crate) fn whole(on_surface: Vec<(f64, CcPoint)>) -> Self {
        Self { back: false, points: Vec::new(), on_surface, partial: false }
    }

    /// Length on the surface, mm.
    pub(crate) fn length(&self) -> f64 {
        self.on_surface.windows(2).map(|pair| (pair[1].1.position - pair[0].1.position).norm()).sum()
    }
}

/// Lines over a surface in sector 0, each in its cutting direction, with notes for the report.
pub(crate) struct PlannedLines {
    pub(crate) lines: Vec<Vec<CcPoint>>,
    pub(crate) notes: Vec<String>,
}

/// For lines that are cut in one direction: x of the stations, and the lengths of the leads at x = 0 and x = 1, mm.
pub(crate) struct LineDirection {
    pub(crate) grid: Vec<f64>,
    leads: [f64; 2],
}

/// The directions in which lines are cut.
pub(crate) struct Directions {
    /// Of forward and of backward lines. A backward line has its lead-in at x = 1.
    pub(crate) each: [LineDirection; 2],
    order: Order,
    /// With one direction for all lines: whether they are cut backwards.
    back: bool,
}

impl Directions {
    /// For each line, given by the x of its ends, whether it is cut backwards. With `zigzag` a line begins at the end that is
    /// nearer to the end of the line before.
    fn backwards(&self, ends: impl Iterator<Item = [f64; 2]>) -> Vec<bool> {
        let mut last: Option<(f64, bool)> = None;
        ends.map(|[from, to]| {
            let back = match last {
                Some((at, back)) if self.order == Order::Zigzag => {
                    let [to_from, to_to] = [(at - from).abs(), (at - to).abs()];
                    if to_from == to_to { !back } else { to_to < to_from }
                }
                _ => self.back,
            };
            last = Some((if back { from } else { to }, back));
            back
        })
        .collect()
    }
}

/// The directions of forward and of backward lines, for speeds along x at both ends, mm per unit. `back` is true where the
/// first line is cut backwards.
pub(crate) fn directions(operation: &Operation, radius: f64, speed: [f64; 2], order: Order, back: bool) -> Directions {
    let beyond = speed.map(|s| radius / s);
    let whole = 1.0 + beyond[0] + beyond[1];
    // Dense until the ball has passed the ends, then the leads.
    let direction = |leads: [f64; 2]| {
        let (from, to) = (-leads[0] / speed[0], 1.0 + leads[1] / speed[1]);
        let mut grid: Vec<f64> =
            (0..=STATIONS).map(|i| i as f64 / STATIONS as f64 * whole - beyond[0]).chain([0.0, 1.0]).collect();
        grid.retain(|u| *u > from && *u < to);
        grid.extend([from, to]);
        grid.sort_by(f64::total_cmp);
        grid.dedup();
        LineDirection { grid, leads }
    };
    let leads = [operation.lead_in.get(), operation.lead_out.get()];
    Directions { each: [direction(leads), direction([leads[1], leads[0]])], order, back }
}

/// Reverses every other line for the order `zigzag`; all of them go over the whole surface.
pub(crate) fn turn_back(lines: &mut [Vec<CcPoint>], order: Order) {
    if order == Order::Zigzag {
        lines.iter_mut().skip(1).step_by(2).for_each(|line| line.reverse());
    }
}

/// Scallop height less what the interpolation may lift the tool.
pub(crate) fn left_to_ridges(cx: &PassContext<'_>, height: f64) -> f64 {
    height - interpolation(cx.program).min(0.5 * height)
}

/// Lines over a surface for a ball, or a corner, of a given radius.
///
/// # Errors
/// Lines too dense to be planned; the diagnostic is in the sink.
pub(crate) fn constant_scallop(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    surface: &dyn DriveSurface,
    radius: f64,
    height: f64,
    directions: &Directions,
) -> Result<PlannedLines, Aborted> {
    let target = left_to_ridges(cx, height);
    let (lines, ridge) = refined(target, |planned| {
        let lines = lay(cx, operation, surface, radius, planned, directions)?;
        let ridge = surface.highest_ridge(&lines);
        Ok((lines, ridge))
    })?;
    let length: f64 = lines.iter().map(SurfaceLine::length).sum();
    let least = surface.least_length(height);
    let partial = lines.iter().filter(|l| l.partial).count();
    let name = surface.name();
    let name = if name.starts_with(['i', 'o']) { format!("an {name}") } else { format!("a {name}") };
    let (count, left) = (lines.len(), height - target);
    let mut notes = if count == 1 {
        vec![format!("one line {name}, {length:.1} mm: the ball rolls along both borders at once")]
    } else {
        vec![
            format!(
                "{count} lines {name}, {partial} of them only where the surface is wide, for a scallop of {height:.4} mm including {left:.4} mm for the chord"
            ),
            format!(
                "{length:.1} mm of contact {name}, {:.1} % over the lower bound {least:.1} mm (area over the larger step)",
                100.0 * (length / least - 1.0)
            ),
        ]
    };
    notes.extend(ridge.filter(|_| count > 1).map(|r| format!("highest ridge between lines {r:.4} mm")));
    let cut = |mut line: SurfaceLine| {
        if line.back {
            line.points.reverse();
        }
        line.points
    };
    Ok(PlannedLines { lines: lines.into_iter().map(cut).collect(), notes })
}

/// Plans lines for ridges of a height by `lay`, which also measures the highest ridge, and repeats with another height until the
/// ridge has the height `target`. Without a measured ridge the first result is taken. Returns the result with its ridge.
pub(crate) fn refined<T>(
    target: f64,
    mut lay: impl FnMut(f64) -> Result<(T, Option<f64>), Aborted>,
) -> Result<(T, Option<f64>), Aborted> {
    let (mut result, mut ridge) = lay(target)?;
    let mut planned = target;
    for _ in 1..MAX_ROUNDS {
        let Some(found) = ridge.filter(|r| *r > 0.0) else { break };
        let ratio = PLANNED_HEIGHT_SHARE * target / found;
        if (1.0..MAX_TARGET_RATIO).contains(&ratio) {
            break;
        }
        // Not all ridges follow the height: approach from above in slightly larger steps.
        planned *= if ratio < 1.0 { ratio * ratio.min(0.998) } else { ratio.min(MAX_GROWTH) };
        let next = lay(planned)?;
        if ratio < 1.0 || next.1.is_some_and(|r| r <= PLANNED_HEIGHT_SHARE * target) {
            (result, ridge) = next;
        } else {
            break;
        }
    }
    Ok((result, ridge))
}

/// Radius of the quarter of a circle on which a ball comes down to a line that begins inside of the surface: its length is
/// the lead, at most a quarter turn of the ball.
pub(crate) fn arc_radius(lead: f64, radius: f64) -> f64 {
    lead.min(FRAC_PI_4 * radius) / FRAC_PI_2
}

/// Lines for ridges of a given height by the metric.
fn lay(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    surface: &dyn DriveSurface,
    radius: f64,
    planned: f64,
    directions: &Directions,
) -> Result<Vec<SurfaceLine>, Aborted> {
    cx.go_on()?;
    let grid = &directions.each[0].grid;
    let metric = surface.metric(planned);
    let width = |x: f64| {
        let (a, across) = surface.walls(x);
        let densest =
            [0.0, 0.5, 1.0].map(|share| metric.form(x, a + across * share)[1]).into_iter().fold(0.0, f64::max);
        across * densest
    };
    let steps = grid.iter().map(|x| width(*x)).fold(0.0, f64::max);
    let widest = steps.max(1.0).ceil();
    cx.check_points(operation, widest * grid.len() as f64)?;
    // A line that begins inside of the surface comes down on a quarter of a circle. The circle lifts the ball over
    // stock that roughing left.
    let arcs = [0, 1].map(|back: usize| directions.each[back].leads.map(|lead| arc_radius(lead, radius)));
    let tracks = if steps < MIN_WIDTH_STEPS {
        let middle = |x: f64| {
            let (a, across) = surface.walls(x);
            a + 0.5 * across
        };
        let range = [f64::NEG_INFINITY, f64::INFINITY];
        Some(vec![Track { azimuth: metric.stations().map(middle).collect(), range }])
    } else {
        let [first, second] = both_walls(surface, metric.stations());
        let slowest = grid.iter().map(|x| surface.speed(*x, surface.walls(*x).0, 0.0)).fold(f64::INFINITY, f64::min);
        let short = arcs[0][0].max(arcs[0][1]) / slowest;
        let finished: Vec<Option<[f64; 2]>> = metric.stations().map(|x| surface.finished(x)).collect();
        tracks(&metric, [&first, &second], &finished, [0.0, 1.0], short, 4 * widest as usize + 8)
    };
    let Some(tracks) = tracks else {
        let message = format!("the lines of `{}` do not cover the {}", operation.name, surface.name());
        cx.sink.push(
            Diag::error(planning::TOO_FINE, message)
                .label(operation.span, "the step of this operation is too small")
                .help("use a larger `scallop`"),
        );
        return Err(Aborted);
    };
    let end = |x: f64, i: usize| if x.is_finite() { x } else { i as f64 };
    let chord = cx.program.tolerances.chord.get();
    let straightness = Straightness::within(chord, radius);
    let backwards = directions.backwards(tracks.iter().map(|t| [end(t.range[0], 0), end(t.range[1], 1)]));
    let lines = backwards.into_iter().enumerate().map(|(j, back)| {
        let i = usize::from(back);
        let line = line(surface, &metric, &tracks, j, arcs[i], &directions.each[i].grid, straightness);
        SurfaceLine { back, ..line }
    });
    Ok(lines.collect())
}

/// Contacts of a track with its leads or arcs: at the places of a grid, and between them where a ball does not run straight.
fn line(
    surface: &dyn DriveSurface,
    metric: &BandMetric,
    tracks: &[Track],
    j: usize,
    arcs: [f64; 2],
    grid: &[f64],
    straightness: Straightness,
) -> SurfaceLine {
    let (track, last) = (&tracks[j], tracks.len() - 1);
    // A station very close to an end would give its piece an arbitrary direction.
    let gap = 0.5 / STATIONS as f64;
    let at = |x: f64| {
        let (a, across) = surface.walls(x);
        match j {
            0 if last > 0 => a,
            _ if j == last && last > 0 => a + across,
            _ => metric.at(&track.azimuth, x),
        }
    };
    let point = |x: f64| {
        // On the leads the share is constant.
        let inside = x.clamp(0.0, 1.0);
        let (a, across) = surface.walls(inside);
        surface.contact(x, at(x), ((at(inside) - a) / across).clamp(0.0, 1.0))
    };
    let open = surface.open();
    let end = |i: usize| if open[i] || track.range[i].is_finite() { track.range[i] } else { i as f64 };
    let [from, to] = [end(0), end(1)];
    let ends = [from, to].into_iter().filter(|u| u.is_finite());
    let within = |u: &f64| from + gap < *u && *u < to - gap;
    let mut places: Vec<f64> = grid.iter().copied().filter(within).chain(ends).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let stations = straight(places.into_iter().map(|x| (x, point(x))).collect(), &point, straightness);
    let on_surface = stations.iter().filter(|(x, _)| (0.0..=1.0).contains(x)).copied().collect();
    // Arc from the end of a line, backwards along the line and lifted.
    let arc = |end: f64, radius: f64, direction: f64| {
        let turn = (at(end + 1e-4) - at(end - 1e-4)) / 2e-4;
        let speed = surface.speed(end, at(end), turn);
        (1..=ARC_STATIONS).map(move |i| {
            let (sin, cos) = libm::sincos(FRAC_PI_2 * i as f64 / ARC_STATIONS as f64);
            (end + direction * radius * sin / speed, radius * (1.0 - cos))
        })
    };
    let lifted = |(x, lift): (f64, f64)| {
        let p = point(x);
        surface.off_hub(CcPoint { position: p.position + surface.rise(x, &p) * lift, ..p })
    };
    let mut points: Vec<CcPoint> = Vec::new();
    if from.is_finite() && arcs[0] > 0.0 {
        points.extend(arc(from, arcs[0], -1.0).map(lifted));
        points.reverse();
    }
    points.extend(stations.iter().map(|(_, p)| *p));
    if to.is_finite() && arcs[1] > 0.0 {
        points.extend(arc(to, arcs[1], 1.0).map(lifted));
    }
    SurfaceLine { back: false, points, on_surface, partial: track.range.iter().any(|x| x.is_finite()) }
}
