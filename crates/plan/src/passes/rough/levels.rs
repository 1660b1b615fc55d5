//! Levels of `rough`: where a tool fits, place by place.
//!
//! A level is a surface through the channel. A run is a part of a level along the channel in which the tool fits
//! everywhere, with its ends: open where the tool comes in from outside of the stock, closed where it no longer fits.

use super::free_space::{FreeInterval, FreeStrip, strips};
use super::layers::{LayerStation, Level, Roughing, length_of, limit_leads};
use crate::passes::context::maximal_ranges;
use base::progress::Progress;
use nalgebra::{Point3, Vector3};
use nurbs::bracket::Bracket;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::ops::Range;
use wheel::method::Levels;

/// Part of a level in which the tool fits.
pub(crate) struct LevelRun {
    /// Level of the tip.
    pub(crate) level: Level,
    /// Stations from the inlet side to the outlet side, with the leads.
    pub(crate) stations: Vec<LayerStation>,
    /// True where the run begins and ends outside of the stock.
    pub(crate) open: [bool; 2],
}

/// A level with the parts in which the tool fits.
pub(crate) struct RoughLevel {
    /// Number, from 1 at the shroud.
    pub(crate) number: usize,
    /// Parts that the tool enters from outside.
    pub(crate) runs: Vec<LevelRun>,
    /// Length of the channel in which the level lies in the stock, and the length in which the tool cuts it, mm.
    pub(crate) length: [f64; 2],
}

/// Places along the channel at which its height is measured.
const HEIGHT_PLACES: usize = 40;

/// Places across the channel at which its first level is measured.
const ACROSS_SHARES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Points on half of the rim of the cutter.
const HALF_RIM: usize = 12;

/// Distance to the blank at which a place counts as on it, mm.
const ON_BLANK_MM: f64 = 1e-3;

/// Accuracy of the first level, as a share of a step down.
const LEVEL_ACCURACY: f64 = 0.01;

/// Share of a step down that rounding may add to a whole number of levels.
const LEVEL_ROUNDING: f64 = 1e-9;

/// Largest motion of a border of the free space across the channel from one station to the next, over their distance along
/// the channel.
const MAX_BORDER_SLOPE: f64 = 2.0;

/// Most rounds in which borders move inward beside an edge, by the tolerance of the path each time.
const MAX_SETTLING_ROUNDS: usize = 10;

impl Roughing<'_> {
    /// The levels from the shroud down to the hub.
    pub(crate) fn levels(&self, form: Levels, name: &str, progress: &Progress) -> Vec<RoughLevel> {
        let surfaces = self.surfaces(form);
        let work = progress.begin(format!("{name}, levels"), surfaces.len());
        let mut levels = Vec::new();
        for (k, level) in surfaces.iter().enumerate() {
            if progress.is_cancelled() {
                break;
            }
            levels.push(work.step(self.runs(k + 1, *level, k + 1 == surfaces.len())));
        }
        levels
    }

    /// Where the levels lie, from the shroud down to the hub. The lowest one lies on the allowance of the hub.
    fn surfaces(&self, form: Levels) -> Vec<Level> {
        let height = self.highest();
        let lowest = self.hub_allowance().min(0.5 * height);
        let steps = |height: f64| (height / self.depth - LEVEL_ROUNDING).ceil().max(0.0) as usize;
        match form {
            Levels::Hub => {
                let count = steps(height - lowest).max(1);
                (0..count).rev().map(|k| Level::OverHub(lowest + k as f64 * self.depth)).collect()
            }
            Levels::Shroud => {
                let first = self.first(self.depth, Level::UnderShroud);
                let more = steps(height - lowest - first);
                let under = |k: usize| Level::UnderShroud(first + k as f64 * self.depth);
                (0..more).map(under).chain([Level::OverHub(lowest)]).collect()
            }
            Levels::Morph => {
                let share = |under: f64| Level::Share(1.0 - under / height);
                let first = self.first(height / steps(height - lowest).max(1) as f64, share);
                let more = steps(height - lowest - first);
                let under = |k: usize| share(first + (height - first) * k as f64 / more as f64);
                (0..more).map(under).chain([Level::Share(0.0)]).collect()
            }
        }
    }

    /// Largest distance of the shroud from the hub, mm.
    fn highest(&self) -> f64 {
        let over = |u: f64, w: f64| self.chart.part().hub.distance(&self.chart.point(u, 1.0, w));
        (0..=HEIGHT_PLACES)
            .flat_map(|i| [0.0, 0.5, 1.0].map(|w| over(i as f64 / HEIGHT_PLACES as f64, w)))
            .fold(0.0, f64::max)
    }

    /// Distance of the first level from the shroud, mm, at most `largest`, at which the blank nowhere loads the tool more
    /// than a slot as deep as a step down; negative where the level lies above the shroud.
    fn first(&self, largest: f64, level: impl Fn(f64) -> Level + Sync) -> f64 {
        let most = |under: f64| {
            let load = |u: f64, w: f64| self.load_in_blank(level(under), u, w);
            let places = (0..=HEIGHT_PLACES).into_par_iter().map(|i| i as f64 / HEIGHT_PLACES as f64);
            places.map(|u| ACROSS_SHARES.iter().map(|w| load(u, *w)).fold(0.0, f64::max)).reduce(|| 0.0, f64::max)
        };
        if most(largest) <= self.depth {
            return largest;
        }
        // Where the blank slants against the axis, the rim is in it before the tip is.
        let ends = Bracket { holds: -self.blank.over_shroud.get() - self.radius(), fails: largest };
        ends.narrowed(LEVEL_ACCURACY * self.depth, |under| most(under) <= self.depth).holds
    }

    /// Depth of a slot that loads the tool as much as the whole blank does in a cut in the worst direction, mm: the mean
    /// depth of the front half of the rim. Depths are measured along the tool axis, from the plane of the tip to the
    /// outside of the blank.
    fn load_in_blank(&self, level: Level, u: f64, w: f64) -> f64 {
        let v = level.v(&self.chart, u, w);
        let (tip, axis) = (self.chart.point(u, v, w), self.axis(u, v, w));
        let across = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
        let other = axis.cross(&across);
        let depths: [f64; 2 * HALF_RIM] = std::array::from_fn(|k| {
            let (sin, cos) = libm::sincos(PI * k as f64 / HALF_RIM as f64);
            self.depth_in_blank(tip + (across * cos + other * sin) * self.radius(), &axis)
        });
        let half = |first: usize| (first..first + HALF_RIM).map(|k| depths[k % depths.len()]).sum::<f64>();
        (0..depths.len()).map(half).fold(0.0, f64::max) / HALF_RIM as f64
    }

    /// Distance from a place along the tool axis to the outside of the blank, mm, at most the length of the flutes.
    fn depth_in_blank(&self, place: Point3<f64>, axis: &Vector3<f64>) -> f64 {
        // Down along the axis to the last place outside of the blank: no step is longer than the distance to it.
        let mut height = self.flute_length();
        while height > 0.0 {
            let distance = self.blank.distance(&(place + axis * height));
            if distance <= ON_BLANK_MM {
                return height;
            }
            height -= distance;
        }
        0.0
    }

    /// True where a level lies in the stock, between the ends of the channel in the blank; the last level may lie on the hub.
    fn in_stock(&self, level: Level, u: f64, ends: [f64; 2], last: bool) -> bool {
        let v = level.v(&self.chart, u, 0.5);
        let below_top = match level {
            Level::OverHub(_) => v < 1.0,
            _ => self.load_in_blank(level, u, 0.5) > 0.0,
        };
        (ends[0]..=ends[1]).contains(&u) && below_top && (last || v > 0.0)
    }

    /// Moves borders of the free space inward where the tool would not keep its distances on the straight path from one station
    /// to the next: beside an edge, where the borders turn.
    fn settle(&self, level: Level, stations: &mut [LayerStation]) {
        for _ in 0..MAX_SETTLING_ROUNDS {
            let joined = |k: usize| [0, 1].map(|side| self.joined(level, [&stations[k - 1], &stations[k]], side));
            let joined: Vec<[bool; 2]> = (1..stations.len()).into_par_iter().map(joined).collect();
            let mut moved = stations.to_vec();
            for (k, sides) in joined.iter().enumerate() {
                for (side, sign) in [1.0, -1.0].into_iter().enumerate().filter(|(side, _)| !sides[*side]) {
                    for i in [k, k + 1] {
                        let s = &stations[i];
                        let width = self.chart.width(s.u, level.v(&self.chart, s.u, 0.5));
                        moved[i].free[side] = s.free[side] + sign * self.tolerance / width;
                    }
                }
            }
            let mut settled = false;
            for (s, moved) in stations.iter_mut().zip(moved) {
                if moved.free != s.free && moved.free[0] < moved.free[1] {
                    (*s, settled) = (moved, true);
                }
            }
            if !settled {
                break;
            }
        }
    }

    /// Ranges of stations in which the free space goes on from each to the next: its borders move gradually, and the
    /// tool keeps its distances along them. A tool that hardly fits has spaces here and there, which no path joins.
    fn continuous(&self, level: Level, stations: &[LayerStation]) -> Vec<Range<usize>> {
        let goes_on = |k: usize| {
            let (from, to) = (&stations[k], &stations[k + 1]);
            let u = 0.5 * (from.u + to.u);
            let width = self.chart.width(u, level.v(&self.chart, u, 0.5));
            let moved = [0, 1].map(|side: usize| (to.free[side] - from.free[side]).abs() * width);
            from.free[0].max(to.free[0]) <= from.free[1].min(to.free[1])
                && moved.iter().all(|mm| *mm <= MAX_BORDER_SLOPE * self.spacing)
                && [0, 1].iter().all(|side| self.joined(level, [from, to], *side))
        };
        let breaks: Vec<usize> = (1..stations.len()).into_par_iter().filter(|k| !goes_on(k - 1)).collect();
        let borders: Vec<usize> = std::iter::once(0).chain(breaks).chain([stations.len()]).collect();
        borders.windows(2).map(|w| w[0]..w[1]).collect()
    }

    /// True where the end of the tool stands outside of the blank: there it comes down without cutting. On a lead that something cuts
    /// short, the tip alone may be outside.
    fn stands_free(&self, level: Level, station: &LayerStation) -> bool {
        let place = self.cc_point(station.u, level, station.middle());
        let end = place.position + place.normal * self.tool.solid.cutter.tip_radius();
        self.blank.distance(&end) >= self.radius() - self.tolerance
    }

    /// The runs of a level.
    fn runs(&self, number: usize, level: Level, last: bool) -> RoughLevel {
        let at = |u: f64| level.v(&self.chart, u, 0.5);
        // A tool outside of the stock has its whole end there, also where the channel ends at a slant of 60 deg.
        let lead = [self.lead_in, self.lead_out].map(|lead| 2.0 * self.radius() + lead);
        let ends = self.ends(level);
        let from = ends[0] - self.chart.lead(0.0, at(0.0), lead[0]);
        let to = ends[1] + self.chart.lead(1.0, at(1.0), lead[1]);
        let middle = |u: f64| self.chart.point(u, at(u), 0.5);
        let length = length_of(middle, from, to);
        let count = (length / self.spacing).ceil().max(8.0) as usize;
        let grid: Vec<f64> = (0..=count).map(|i| from + (to - from) * i as f64 / count as f64).collect();
        let inside: Vec<bool> = grid.iter().map(|u| self.in_stock(level, *u, ends, last)).collect();
        let places: Vec<Point3<f64>> = grid.iter().map(|u| middle(*u)).collect();
        let step = |i: usize| (places[i + 1] - places[i]).norm();
        let mut wanted = inside.clone();
        for interval in maximal_ranges(count + 1, |i| inside[i]) {
            for (back, reach) in [(true, lead[0]), (false, lead[1])] {
                let (mut i, mut run) = (if back { interval.start } else { interval.end - 1 }, 0.0);
                while run < reach && (if back { i > 0 } else { i < count }) {
                    run += step(if back { i - 1 } else { i });
                    i = if back { i - 1 } else { i + 1 };
                    wanted[i] = true;
                }
            }
        }
        let free_ends = self.free_ends();
        let several = |u: f64| (u < 0.0 && free_ends[0]) || (u > 1.0 && free_ends[1]);
        let free_intervals =
            |i: usize| if wanted[i] { self.free_intervals(grid[i], level, several(grid[i])) } else { Vec::new() };
        let free_intervals: Vec<Vec<FreeInterval>> = (0..=count).into_par_iter().map(free_intervals).collect();
        let mut runs = Vec::new();
        // Steps from station to station in the stock, and whether the tool cuts there.
        let in_stock: Vec<usize> = (0..count).filter(|i| inside[*i] && inside[i + 1]).collect();
        let mut cuts = vec![false; count];
        for FreeStrip { first, free_intervals } in strips(&free_intervals, &inside) {
            let mut stations: Vec<LayerStation> =
                free_intervals.into_iter().zip(&grid[first..]).map(|(free, u)| LayerStation { u: *u, free }).collect();
            if limit_leads(&mut stations, free_ends, |k, _| inside[first + k]).is_ok()
                && self.ease(level, &mut stations).is_ok()
            {
                self.settle(level, &mut stations);
                for part in self.continuous(level, &stations) {
                    let stations: Vec<LayerStation> = stations[part.clone()].to_vec();
                    let inside = |k: usize| inside[first + k];
                    let open = |k: usize| !inside(k) && self.stands_free(level, &stations[k - part.start]);
                    let open = [open(part.start), open(part.end - 1)];
                    let steps = first + part.start..first + part.end - 1;
                    if in_stock.iter().any(|i| steps.contains(i)) && (open[0] || open[1]) {
                        steps.for_each(|i| cuts[i] = true);
                        runs.push(LevelRun { level, stations, open });
                    }
                }
            }
        }
        let [all, cut]: [f64; 2] =
            [false, true].map(|cut| in_stock.iter().filter(|i| !cut || cuts[**i]).map(|i| step(*i)).sum());
        RoughLevel { number, runs, length: [all, cut] }
    }
}
