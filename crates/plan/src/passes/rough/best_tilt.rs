//! Tilt of the tool axis of `rough` away from the walls of the channel.
//!
//! A tool whose axis follows the ruling of a wall touches a hollow wall with the side of its cutter, high above the floor,
//! before its end is in the fillet. An axis that tilts away from the wall brings the end nearer. Where the opposite wall
//! is near, it costs reach instead. The planner therefore measures the reach at the lowest levels for some tilts, place by
//! place, and takes the least tilt that reaches as far as the best one.

use super::layers::{Level, Roughing, StationPlace};
use super::wall_tilt::WallTilt;
use base::progress::Progress;
use rayon::prelude::*;

/// Tilts that are tried, degrees. Beyond the largest the end of a flat cutter cuts steps.
const TRIED_TILTS_DEG: [f64; 7] = [0.0, 3.0, 6.0, 9.0, 12.0, 15.0, 18.0];

/// Places along the channel at which the reach is measured; between them the tilt changes evenly.
const REACH_PLACES: usize = 40;

/// Lowest levels at which the reach is measured: above them the walls are reached with any tilt.
const LOWEST_LEVELS: usize = 3;

/// Reach that does not justify more tilt, as a share of the radius of the tool, on each level.
const SAME_REACH_SHARE: f64 = 0.05;

impl Roughing<'_> {
    /// The same operation with the tilts that bring the tool nearest to the walls.
    /// Of a cancelled run the tilts are not those that the operation has.
    pub(super) fn tilted(&self, progress: &Progress) -> Self {
        let trials = TRIED_TILTS_DEG.map(|tilt| self.with_tilt(WallTilt::even(tilt.to_radians())));
        let places: Vec<[f64; 2]> = (0..=REACH_PLACES)
            .into_par_iter()
            .map(|i| {
                let u = i as f64 / REACH_PLACES as f64;
                let place = StationPlace::new(&self.chart, u);
                let missed = trials.each_ref().map(|trial| {
                    // A cancelled run needs no best tilt. A trial takes some milliseconds.
                    if progress.is_cancelled() { [0.0; 2] } else { trial.missed(&place) }
                });
                [0, 1].map(|side: usize| {
                    let best = missed.iter().map(|m| m[side]).fold(f64::INFINITY, f64::min);
                    let enough = best + LOWEST_LEVELS as f64 * SAME_REACH_SHARE * self.radius();
                    let least = missed.iter().position(|m| m[side] <= enough);
                    TRIED_TILTS_DEG[least.filter(|_| best.is_finite()).unwrap_or(0)].to_radians()
                })
            })
            .collect();
        self.with_tilt(WallTilt::smooth(&places))
    }

    /// Distance that the tool keeps from each wall at the lowest levels, mm, in sum; infinite where it does not fit.
    fn missed(&self, place: &StationPlace<'_>) -> [f64; 2] {
        let mut missed = [0.0; 2];
        for k in 0..LOWEST_LEVELS {
            let level = Level::OverHub(self.hub_allowance() + k as f64 * self.depth);
            let v = place.v(level, 0.5);
            if v >= 1.0 {
                continue;
            }
            let width = place.width(v);
            let free = self.free_interval_at(place, level).unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
            missed = [missed[0] + free[0] * width, missed[1] + (1.0 - free[1]) * width];
        }
        missed
    }
}
