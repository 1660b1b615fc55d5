//! A run of a level as a strip along its middle: places by distances along and across the channel.

use super::layers::{LayerStation, Roughing};
use super::levels::LevelRun;
use five_axis::Pose;
use ir::CcPoint;
use nalgebra::{Point3, Vector3};
use nurbs::bracket::Bracket;
use rayon::prelude::*;
use std::ops::Range;

/// Change of w over which tip and axis are measured on both sides of the middle.
const DIFFERENCE_STEP: f64 = 0.05;

/// Largest shift along the channel over a shift across it, on a line of constant u.
const MAX_SLANT: f64 = 2.0;

/// Bisection steps for the free space: half a channel divided by 2^8 is less than 0.1 mm.
const FREE_SPACE_BISECTIONS: usize = 8;

/// A place of the chart: distance along the middle of the run, mm, and w.
pub(super) type Place = [f64; 2];

/// Least tilt of the tool axis in the direction of the loops, sine of the angle: 2 deg. The end of a flat cutter with the opposite
/// tilt would cut the floor of the loops before once more, over its whole width.
const MIN_TILT_SINE: f64 = 0.035;

/// Station of a run.
struct StripStation {
    /// Distance along the middle of the run, mm.
    along: f64,
    u: f64,
    /// Middle of the strip, and the half of its width, in w.
    middle: f64,
    half: f64,
    /// Distance square to the channel, and along the channel, for a change of w by one at constant u, mm.
    across: f64,
    slant: f64,
    /// Ratio of the distance of lines a step down above the tip to that at the tip; at least 1.
    widening: f64,
    /// Tips of lines at w less than the middle by [`DIFFERENCE_STEP`], in the middle, and as much beyond.
    tips: [Point3<f64>; 3],
    /// Tool axis of a line in the middle.
    line_axis: Vector3<f64>,
    /// Tool axis of loops.
    axis: Vector3<f64>,
    /// Height of the tip of loops above the tip of lines in the middle, along the axis of loops, mm.
    lift: f64,
}

impl StripStation {
    /// Tip of loops in the middle.
    fn centre(&self) -> Point3<f64> {
        self.tips[1] + self.axis * self.lift
    }
}

/// The strip of a run in which the tool keeps all allowances with the axes of loops.
pub(super) struct RunMap<'a> {
    roughing: &'a Roughing<'a>,
    run: &'a LevelRun,
    rows: Vec<StripStation>,
}

impl<'a> RunMap<'a> {
    /// The strip for loops that reach `along` (mm) along the channel to both sides of their centre, and `across` over the
    /// shift that lines of constant u have. They go on towards higher stations where `forward` is 1, else towards lower
    /// ones. `None` where two stations are the same place.
    pub(super) fn new(
        roughing: &'a Roughing<'a>,
        run: &'a LevelRun,
        forward: f64,
        [along, across]: [f64; 2],
    ) -> Option<Self> {
        let middles: Vec<f64> = run.stations.iter().map(|s| s.middle()).collect();
        let mut rows = Self::rows(roughing, run, &middles, &vec![0.0; middles.len()])?;
        let slant = rows.iter().map(|row| (row.slant / row.across).abs()).fold(0.0, f64::max);
        let reach = along + slant * across;
        let fits = incline(roughing, &mut rows, forward, reach);
        let near = (reach / roughing.spacing).ceil() as usize;
        let border = |i: usize, side: usize| {
            let s = &run.stations[i];
            if !fits[i] {
                return s.middle();
            }
            let axes = [i.saturating_sub(near), i, (i + near).min(rows.len() - 1)].map(|k| rows[k].axis);
            let clear = |w: f64| {
                let v = run.level.v(&roughing.chart, s.u, w);
                let tip = in_plane(&roughing.chart.point(s.u, v, w), &rows[i].centre(), &rows[i].axis);
                axes.iter().all(|axis| roughing.clears_walls(&tip, axis))
            };
            let most = across / rows[i].across;
            let outermost = s.middle() + (s.free[side] - s.middle()).clamp(-most, most);
            if clear(outermost) {
                return outermost;
            }
            Bracket { holds: s.middle(), fails: outermost }.halved(FREE_SPACE_BISECTIONS, clear).holds
        };
        let borders: Vec<[f64; 2]> = (0..middles.len()).into_par_iter().map(|i| [border(i, 0), border(i, 1)]).collect();
        let distances: Vec<f64> = rows.iter().map(|row| row.along).collect();
        let [low, high] = [0, 1].map(|side: usize| {
            let sign = if side == 0 { 1.0 } else { -1.0 };
            let inward: Vec<f64> = borders.iter().map(|b| sign * b[side]).collect();
            inside(&distances, &inward, reach).into_iter().map(|w| sign * w).collect::<Vec<f64>>()
        });
        let middles: Vec<f64> = low.iter().zip(&high).map(|(low, high)| 0.5 * (low + high)).collect();
        let halves: Vec<f64> = low.iter().zip(&high).map(|(low, high)| (0.5 * (high - low)).max(0.0)).collect();
        let mut rows = Self::rows(roughing, run, &middles, &halves)?;
        incline(roughing, &mut rows, forward, reach);
        Some(Self { roughing, run, rows })
    }

    /// The stations with a given middle and half width of the strip, in w; the axes are those of lines.
    fn rows(roughing: &Roughing<'_>, run: &LevelRun, middles: &[f64], halves: &[f64]) -> Option<Vec<StripStation>> {
        let tool = |u: f64, w: f64| {
            let v = run.level.v(&roughing.chart, u, w);
            Pose { tip: roughing.chart.point(u, v, w), axis: roughing.axis(u, v, w) }
        };
        let tools: Vec<[Pose; 3]> = run
            .stations
            .iter()
            .zip(middles)
            .map(|(s, w)| [w - DIFFERENCE_STEP, *w, w + DIFFERENCE_STEP].map(|w| tool(s.u, w)))
            .collect();
        let mut along = vec![0.0];
        for pair in tools.windows(2) {
            along.push(along[along.len() - 1] + (pair[1][1].tip - pair[0][1].tip).norm());
        }
        if along.len() < 2 || along.windows(2).any(|pair| pair[1] <= pair[0]) {
            return None;
        }
        let row = |i: usize| {
            let (before, next) = (i.saturating_sub(1), (i + 1).min(tools.len() - 1));
            let forward = (tools[next][1].tip - tools[before][1].tip).normalize();
            let [low, middle, high] = tools[i];
            let by_w =
                |above: f64| (high.tip + high.axis * above - low.tip - low.axis * above) / (2.0 * DIFFERENCE_STEP);
            let slant = by_w(0.0).dot(&forward);
            let square = |v: Vector3<f64>| (v - forward * v.dot(&forward)).norm().max(f64::MIN_POSITIVE);
            let across = square(by_w(0.0));
            StripStation {
                along: along[i],
                u: run.stations[i].u,
                middle: middles[i],
                half: halves[i],
                across,
                slant: slant.clamp(-MAX_SLANT * across, MAX_SLANT * across),
                widening: (square(by_w(roughing.depth)) / across).max(1.0),
                tips: [low.tip, middle.tip, high.tip],
                line_axis: middle.axis,
                axis: middle.axis,
                lift: 0.0,
            }
        };
        Some((0..tools.len()).map(row).collect())
    }

    /// Mean tilt of the axes of lines towards higher stations, as the sine of its angle.
    pub(super) fn mean_tilt(roughing: &Roughing<'_>, run: &LevelRun) -> f64 {
        let at = |s: &LayerStation| roughing.cc_point(s.u, run.level, s.middle());
        let tilts = run.stations.windows(2).filter_map(|pair| {
            let [from, to] = [at(&pair[0]), at(&pair[1])];
            Some((to.position - from.position).try_normalize(0.0)?.dot(&from.normal))
        });
        tilts.sum::<f64>() / run.stations.len() as f64
    }

    /// Distances of all stations along the middle, mm.
    pub(super) fn stations(&self) -> Vec<f64> {
        self.rows.iter().map(|row| row.along).collect()
    }

    /// Half of the width of the strip at each station, mm.
    pub(super) fn halves(&self) -> Vec<f64> {
        self.rows.iter().map(|row| row.half * row.across).collect()
    }

    /// Narrows the strip to half widths of at most `most` (mm), and so that neither of its borders moves outward by more than
    /// `growth` over the distance along it in the given order of stations. Returns the number of stations up to the first one
    /// that is then narrower than half of `least` (mm).
    pub(super) fn narrow(&mut self, order: &[usize], [least, most]: [f64; 2], growth: f64) -> usize {
        let mut before: Option<(f64, [f64; 2])> = None;
        for (count, i) in order.iter().enumerate() {
            let row = &mut self.rows[*i];
            let half = row.half.min(most / row.across);
            let mut borders = [row.middle - half, row.middle + half];
            if let Some((along, [low, high])) = before {
                let grown = growth * (row.along - along).abs() / row.across;
                borders = [borders[0].max(low - grown), borders[1].min(high + grown)];
            }
            before = Some((row.along, borders));
            row.half = 0.5 * (borders[1] - borders[0]);
            row.middle = 0.5 * (borders[0] + borders[1]);
            if row.half * row.across < least {
                return count;
            }
        }
        order.len()
    }

    /// For each station the ratio of the distance of lines a step down above the tip to that at the tip; at least 1.
    pub(super) fn widening(&self) -> impl Iterator<Item = f64> + '_ {
        self.rows.iter().map(|row| row.widening)
    }

    /// The stations on both sides of a distance along the middle, and its share between them, which is below 0 or over 1
    /// beyond the ends.
    fn between(&self, along: f64) -> (&StripStation, &StripStation, f64) {
        let next = self.rows.partition_point(|row| row.along < along).clamp(1, self.rows.len() - 1);
        let (a, b) = (&self.rows[next - 1], &self.rows[next]);
        (a, b, (along - a.along) / (b.along - a.along))
    }

    /// A value between the stations; that of the last one beyond the ends.
    fn mixed(&self, along: f64, of: impl Fn(&StripStation) -> f64) -> f64 {
        let (a, b, share) = self.between(along);
        of(a) + (of(b) - of(a)) * share.clamp(0.0, 1.0)
    }

    /// The place at a distance along the channel and a distance across it from a place in the middle, mm; positive
    /// towards the second wall.
    pub(super) fn place(&self, centre: f64, [x, y]: [f64; 2]) -> Place {
        let offset = y / self.mixed(centre, |row| row.across);
        // The middle at the centre: the strip there is free within the reach of the curve.
        [centre + x - offset * self.mixed(centre, |row| row.slant), self.mixed(centre, |row| row.middle) + offset]
    }

    /// Tip and axis of loops at a place, for a centre at a distance along the channel: all places of a loop lie in the plane
    /// square to its axis, so that the end of a flat cutter cuts no floor of this loop again. Between the stations only
    /// about.
    pub(super) fn tool(&self, centre: f64, place: Place) -> Pose {
        let (a, b, share) = self.between(centre);
        let axis = (a.axis + (b.axis - a.axis) * share.clamp(0.0, 1.0)).normalize();
        let middle = a.centre() + (b.centre() - a.centre()) * share;
        Pose { tip: in_plane(&self.tip(place), &middle, &axis), axis }
    }

    /// The tip of a line at a place; between the stations only about, and without the lift over the hub.
    fn tip(&self, [along, w]: Place) -> Point3<f64> {
        let (a, b, share) = self.between(along);
        let at = |row: &StripStation| {
            let t = (w - row.middle) / DIFFERENCE_STEP;
            let [p, q, r] = row.tips.map(|tip| tip.coords);
            q + (r - p) * (0.5 * t) + (p + r - q * 2.0) * (0.5 * t * t)
        };
        Point3::from(at(a) + (at(b) - at(a)) * share)
    }

    /// The station of a loop at a place with a tip and an axis; `None` where the tool does not keep all allowances.
    pub(super) fn cc_point(&self, [along, w]: Place, Pose { tip, axis }: &Pose) -> Option<CcPoint> {
        let (a, b, share) = self.between(along);
        let u = a.u + (b.u - a.u) * share;
        let v = self.run.level.v(&self.roughing.chart, u, w);
        let clear = self.roughing.clears_walls(tip, axis) && self.roughing.clears_hub(tip, axis);
        clear.then_some(CcPoint { u, v, w, position: *tip, normal: *axis })
    }
}

/// Gives rows the axes of loops, which tilt in their direction, and the lift over the tips of lines; false for rows on which
/// the tool does not keep the allowance on the hub. Loops open as deep as the end of a flat cutter goes that runs on
/// the lines.
fn incline(roughing: &Roughing<'_>, rows: &mut [StripStation], forward: f64, reach: f64) -> Vec<bool> {
    /// Axes follow from the path of the tip, and its lift from the axes.
    const TURNS: usize = 2;
    let radius = if roughing.is_flat() { roughing.radius() } else { 0.0 };
    let distances: Vec<f64> = rows.iter().map(|row| row.along).collect();
    let mut fits = vec![true; rows.len()];
    for _ in 0..TURNS {
        let direction = |i: usize| {
            let (before, next) = (i.saturating_sub(1), (i + 1).min(rows.len() - 1));
            ((rows[next].centre() - rows[before].centre()) * forward).normalize()
        };
        let directions: Vec<Vector3<f64>> = (0..rows.len()).map(direction).collect();
        let missing = |i: usize| (MIN_TILT_SINE - rows[i].line_axis.dot(&directions[i])).max(0.0);
        let missing = inside(&distances, &(0..rows.len()).map(missing).collect::<Vec<f64>>(), 0.5 * reach);
        let axes: Vec<Vector3<f64>> = (0..rows.len()).map(|i| rows[i].line_axis + directions[i] * missing[i]).collect();
        let lifted = |i: usize| {
            let axis = axes[near(&distances, i, 0.25 * reach)].iter().sum::<Vector3<f64>>().normalize();
            let lower = radius * (-rows[i].line_axis.dot(&directions[i]) - MIN_TILT_SINE).max(0.0);
            let offset = (directions[i] - axis * directions[i].dot(&axis)) * reach;
            let clear = |lift: f64| {
                let middle = rows[i].tips[1] + axis * lift;
                [-1.0, 0.0, 1.0].iter().all(|k| roughing.clears_hub(&(middle + offset * *k), &axis))
            };
            (axis, least(-lower, roughing.depth + roughing.hub_allowance(), clear))
        };
        let found: Vec<(Vector3<f64>, Option<f64>)> = (0..rows.len()).into_par_iter().map(lifted).collect();
        let lifts: Vec<f64> = found.iter().map(|(_, lift)| lift.unwrap_or(0.0)).collect();
        let lifts = inside(&distances, &lifts, reach);
        for (i, (row, (axis, lift))) in rows.iter_mut().zip(found).enumerate() {
            fits[i] = lift.is_some();
            (row.axis, row.lift) = (axis, lifts[i]);
        }
    }
    fits
}

/// The least value from which on a condition holds, to a small part of the interval; `None` where it holds at no end.
fn least(low: f64, high: f64, holds: impl Fn(f64) -> bool) -> Option<f64> {
    if holds(low) {
        return Some(low);
    }
    if !holds(high) {
        return None;
    }
    Some(Bracket { holds: high, fails: low }.halved(FREE_SPACE_BISECTIONS + 1, holds).holds)
}

/// A point shifted along an axis into the plane square to the axis through another point.
fn in_plane(point: &Point3<f64>, through: &Point3<f64>, axis: &Vector3<f64>) -> Point3<f64> {
    point - axis * (point - through).dot(axis)
}

/// Indices of the stations within a distance of a station.
fn near(along: &[f64], i: usize, by: f64) -> Range<usize> {
    let from = along.partition_point(|x| *x < along[i] - by);
    from..along.partition_point(|x| *x <= along[i] + by)
}

/// A smooth border that is at least the given one within `reach` of each station: the largest value within a quarter more,
/// and the mean of these over a quarter of the reach.
fn inside(along: &[f64], border: &[f64], reach: f64) -> Vec<f64> {
    let largest = |i: usize| border[near(along, i, 1.25 * reach)].iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let largest: Vec<f64> = (0..along.len()).map(largest).collect();
    let mean = |i: usize| {
        let window = &largest[near(along, i, 0.25 * reach)];
        window.iter().sum::<f64>() / window.len() as f64
    };
    (0..along.len()).map(mean).collect()
}
