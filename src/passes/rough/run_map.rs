//! A run of a level as a strip along its middle: places by distances along and across the channel.

use super::layers::Roughing;
use super::levels::LevelRun;
use crate::ir::CcPoint;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Change of w over which tip and axis are measured on both sides of the middle.
const BESIDE: f64 = 0.05;

/// Largest shift along the channel over a shift across it, on a line of constant u.
const MOST_SLANT: f64 = 2.0;

/// Bisection steps for the free space: half a channel divided by 2^8 is less than 0.1 mm.
const BISECTIONS: u32 = 8;

/// A place of the chart: distance along the middle of the run, mm, and w.
pub(super) type Place = [f64; 2];

/// Station of a run.
struct Row {
    /// Distance along the middle of the run, mm.
    along: f64,
    u: f64,
    /// Middle of the strip, and the half of its width, in w.
    middle: f64,
    half: f64,
    /// Distance square to the channel, and along the channel, for a change of w by one at constant u, mm.
    across: f64,
    slant: f64,
    /// By how much farther apart lines are a step down above the tip, as a multiple; at least 1.
    widening: f64,
    /// Tips at w less than the middle by [`BESIDE`], in the middle, and as much beyond.
    tips: [Point3<f64>; 3],
    /// Tool axis in the middle.
    axis: Vector3<f64>,
}

/// The strip of a run in which the tool keeps all allowances with the axes of the middle.
pub(super) struct RunMap<'a> {
    roughing: &'a Roughing<'a>,
    run: &'a LevelRun,
    rows: Vec<Row>,
}

impl<'a> RunMap<'a> {
    /// The strip for curves that reach `along` (mm) along the channel to both sides of their centre, and `across` over the
    /// shift that lines of constant u have. The axis is that at the centre of a curve. `None` where two stations are the
    /// same place.
    pub(super) fn new(roughing: &'a Roughing<'a>, run: &'a LevelRun, along: f64, across: f64) -> Option<Self> {
        let axis = |u: f64, w: f64| roughing.axis(u, run.level.v(&roughing.chart, u, w), w);
        let middles: Vec<f64> = run.stations.iter().map(|s| s.middle()).collect();
        let rows = Self::rows(roughing, run, &middles, &vec![0.0; middles.len()])?;
        let slant = rows.iter().map(|row| (row.slant / row.across).abs()).fold(0.0, f64::max);
        let reach = along + slant * across;
        let axes: Vec<Vector3<f64>> = run.stations.iter().map(|s| axis(s.u, s.middle())).collect();
        let near = (reach / roughing.spacing).ceil() as usize;
        let border = |i: usize, side: usize| {
            let s = &run.stations[i];
            let axes = [axes[i.saturating_sub(near)], axes[i], axes[(i + near).min(axes.len() - 1)]];
            let clear = |w: f64| axes.iter().all(|a| roughing.cc_point_along(s.u, run.level, w, a).is_some());
            let most = across / rows[i].across;
            let outermost = s.middle() + (s.room[side] - s.middle()).clamp(-most, most);
            if clear(outermost) {
                return outermost;
            }
            let (mut free, mut blocked) = (s.middle(), outermost);
            for _ in 0..BISECTIONS {
                let w = 0.5 * (free + blocked);
                if clear(w) { free = w } else { blocked = w }
            }
            free
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
        Some(Self { roughing, run, rows: Self::rows(roughing, run, &middles, &halves)? })
    }

    /// The stations with a given middle and half width of the strip, in w.
    fn rows(roughing: &Roughing<'_>, run: &LevelRun, middles: &[f64], halves: &[f64]) -> Option<Vec<Row>> {
        let tool = |u: f64, w: f64| {
            let v = run.level.v(&roughing.chart, u, w);
            (roughing.chart.point(u, v, w), roughing.axis(u, v, w))
        };
        let tools: Vec<[(Point3<f64>, Vector3<f64>); 3]> =
            run.stations.iter().zip(middles).map(|(s, w)| [w - BESIDE, *w, w + BESIDE].map(|w| tool(s.u, w))).collect();
        let mut along = vec![0.0];
        for pair in tools.windows(2) {
            along.push(along[along.len() - 1] + (pair[1][1].0 - pair[0][1].0).norm());
        }
        if along.len() < 2 || along.windows(2).any(|pair| pair[1] <= pair[0]) {
            return None;
        }
        let row = |i: usize| {
            let (before, next) = (i.saturating_sub(1), (i + 1).min(tools.len() - 1));
            let forward = (tools[next][1].0 - tools[before][1].0).normalize();
            let [low, middle, high] = tools[i];
            let by_w = |above: f64| (high.0 + high.1 * above - low.0 - low.1 * above) / (2.0 * BESIDE);
            let slant = by_w(0.0).dot(&forward);
            let square = |v: Vector3<f64>| (v - forward * v.dot(&forward)).norm().max(f64::MIN_POSITIVE);
            let across = square(by_w(0.0));
            Row {
                along: along[i],
                u: run.stations[i].u,
                middle: middles[i],
                half: halves[i],
                across,
                slant: slant.clamp(-MOST_SLANT * across, MOST_SLANT * across),
                widening: (square(by_w(roughing.depth)) / across).max(1.0),
                tips: [low.0, middle.0, high.0],
                axis: middle.1,
            }
        };
        Some((0..tools.len()).map(row).collect())
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
    /// `growth` over the way along it in the given order of stations. Returns the number of stations up to the first one
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

    /// For each station by how much farther apart lines are a step down above the tip, as a multiple; at least 1.
    pub(super) fn widening(&self) -> impl Iterator<Item = f64> + '_ {
        self.rows.iter().map(|row| row.widening)
    }

    /// The stations on both sides of a distance along the middle, and its share between them, which is below 0 or over 1
    /// beyond the ends.
    fn between(&self, along: f64) -> (&Row, &Row, f64) {
        let next = self.rows.partition_point(|row| row.along < along).clamp(1, self.rows.len() - 1);
        let (a, b) = (&self.rows[next - 1], &self.rows[next]);
        (a, b, (along - a.along) / (b.along - a.along))
    }

    /// A value between the stations; that of the last one beyond the ends.
    fn mixed(&self, along: f64, of: impl Fn(&Row) -> f64) -> f64 {
        let (a, b, share) = self.between(along);
        of(a) + (of(b) - of(a)) * share.clamp(0.0, 1.0)
    }

    /// The place at a distance along the channel and a distance across it from a place in the middle, mm; positive
    /// towards the second wall.
    pub(super) fn place(&self, centre: f64, [x, y]: [f64; 2]) -> Place {
        let beside = y / self.mixed(centre, |row| row.across);
        // The middle at the centre: the strip there is free within the reach of the curve.
        [centre + x - beside * self.mixed(centre, |row| row.slant), self.mixed(centre, |row| row.middle) + beside]
    }

    /// Tool axis in the middle.
    pub(super) fn axis(&self, along: f64) -> Vector3<f64> {
        let (a, b, share) = self.between(along);
        (a.axis + (b.axis - a.axis) * share.clamp(0.0, 1.0)).normalize()
    }

    /// The tip at a place; between the stations only about, and without the lift over the hub.
    pub(super) fn tip(&self, [along, w]: Place) -> Point3<f64> {
        let (a, b, share) = self.between(along);
        let at = |row: &Row| {
            let t = (w - row.middle) / BESIDE;
            let [p, q, r] = row.tips.map(|tip| tip.coords);
            q + (r - p) * (0.5 * t) + (p + r - q * 2.0) * (0.5 * t * t)
        };
        Point3::from(at(a) + (at(b) - at(a)) * share)
    }

    /// The station of a line at a place, with a tool axis; `None` where the tool does not keep all allowances.
    pub(super) fn cc_point(&self, [along, w]: Place, axis: &Vector3<f64>) -> Option<CcPoint> {
        let (a, b, share) = self.between(along);
        self.roughing.cc_point_along(a.u + (b.u - a.u) * share, self.run.level, w, axis)
    }
}

/// A smooth border that is at least the given one within `reach` of each station: the largest value within a quarter more,
/// and the mean of these over a quarter of the reach.
fn inside(along: &[f64], border: &[f64], reach: f64) -> Vec<f64> {
    let near = |i: usize, by: f64| {
        let from = along.partition_point(|x| *x < along[i] - by);
        from..along.partition_point(|x| *x <= along[i] + by)
    };
    let largest = |i: usize| border[near(i, 1.25 * reach)].iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let largest: Vec<f64> = (0..along.len()).map(largest).collect();
    let mean = |i: usize| {
        let window = &largest[near(i, 0.25 * reach)];
        window.iter().sum::<f64>() / window.len() as f64
    };
    (0..along.len()).map(mean).collect()
}
