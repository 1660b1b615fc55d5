//! Tilt angles that change along a pass, where no single tilt clears all of it.
//!
//! Some tilts are clear at each station. The path through them with the least sum of squared changes per length is found on
//! the grid of tilts, and then averaged over a width, so that the tool turns smoothly. Only tilts that are clear all over this
//! width are used: the mean of them is then between tilts that are clear at the station.

/// Half widths of the mean, as shares of the length of the pass, the widest first.
const WIDTHS: [f64; 4] = [0.25, 0.12, 0.06, 0.03];

/// Weight of the tilt against its changes: of equal paths the one with less tilt wins.
const TILT_WEIGHT: f64 = 1e-5;

/// Least distance of two stations, mm: some stand at one place.
const MIN_STATION_DISTANCE_MM: f64 = 1e-6;

/// Tilts that are tried, and which of them are clear at each station.
pub(super) struct ClearTilts<'a> {
    /// Length of the pass up to each station, mm.
    pub(super) lengths: &'a [f64],
    /// Tilts, ascending.
    pub(super) tilts: &'a [f64],
    /// For each tilt whether it is clear at each station.
    pub(super) clear: &'a [Vec<bool>],
}

impl ClearTilts<'_> {
    /// Tilts at lengths of the pass, mm, for each width of the mean that is at least `least` mm and has a path.
    pub(super) fn smooth_paths<'b>(&'b self, least: f64, at: &'b [f64]) -> impl Iterator<Item = Vec<f64>> + 'b {
        let whole = self.lengths.last().copied().unwrap_or(0.0);
        let widths = WIDTHS.into_iter().map(move |share| share * whole).filter(move |width| *width >= least);
        widths.filter_map(|half| {
            let path = self.path(&self.clear_over(half))?;
            let once = self.mean(&path, 0.5 * half, self.lengths);
            Some(self.mean(&once, 0.5 * half, at))
        })
    }

    /// For each tilt whether it is clear at all stations within `half` mm of each station.
    fn clear_over(&self, half: f64) -> Vec<Vec<bool>> {
        let within = |clear: &Vec<bool>| {
            // Number of stations before each one that are not clear.
            let mut blocked = vec![0_usize];
            for clear in clear {
                blocked.push(blocked[blocked.len() - 1] + usize::from(!clear));
            }
            let at = |s: &f64| {
                let from = self.lengths.partition_point(|x| *x < s - half);
                let to = self.lengths.partition_point(|x| *x <= s + half);
                blocked[to] == blocked[from]
            };
            self.lengths.iter().map(at).collect()
        };
        self.clear.iter().map(within).collect()
    }

    /// The cheapest path through clear tilts; between two stations it passes only over tilts that are clear at one of them.
    fn path(&self, clear: &[Vec<bool>]) -> Option<Vec<f64>> {
        let (count, all) = (self.lengths.len(), 0..self.tilts.len());
        let mut cost: Vec<f64> =
            all.clone().map(|t| if clear[t].first() == Some(&true) { 0.0 } else { f64::INFINITY }).collect();
        let mut before: Vec<Vec<usize>> = Vec::with_capacity(count);
        for i in 1..count {
            let length = (self.lengths[i] - self.lengths[i - 1]).max(MIN_STATION_DISTANCE_MM);
            let passes = |from: usize, to: usize| {
                let between = from.min(to)..=from.max(to);
                between.clone().all(|t| clear[t][i]) || between.clone().all(|t| clear[t][i - 1]) && clear[to][i]
            };
            let step = |to: usize| {
                let reach = all.clone().filter(|from| cost[*from].is_finite() && passes(*from, to));
                let total = |from: usize| {
                    let change = self.tilts[to] - self.tilts[from];
                    cost[from] + change * change / length + TILT_WEIGHT * self.tilts[to] * self.tilts[to] * length
                };
                let best = reach.map(|from| (total(from), from)).min_by(|a, b| a.0.total_cmp(&b.0));
                best.unwrap_or((f64::INFINITY, 0))
            };
            let (costs, from): (Vec<f64>, Vec<usize>) = all.clone().map(step).unzip();
            cost = costs;
            before.push(from);
        }
        let mut last = all.filter(|t| cost[*t].is_finite()).min_by(|a, b| cost[*a].total_cmp(&cost[*b]))?;
        let mut path = vec![self.tilts[last]];
        for from in before.iter().rev() {
            last = from[last];
            path.push(self.tilts[last]);
        }
        path.reverse();
        Some(path)
    }

    /// The mean of a path within `half` mm of each of these lengths; at its ends the path goes on as it is there.
    fn mean(&self, path: &[f64], half: f64, at: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0];
        for (s, tilt) in self.lengths.windows(2).zip(path.windows(2)) {
            sums.push(sums[sums.len() - 1] + 0.5 * (tilt[0] + tilt[1]) * (s[1] - s[0]));
        }
        let (Some(first), Some(last)) = (self.lengths.first(), self.lengths.last()) else { return Vec::new() };
        let sum = |s: f64| {
            let beyond = [(s - first).min(0.0) * path[0], (s - last).max(0.0) * path[path.len() - 1]];
            self.sum_to(s.clamp(*first, *last), path, &sums) + beyond[0] + beyond[1]
        };
        at.iter().map(|s| (sum(s + half) - sum(s - half)) / (2.0 * half)).collect()
    }

    /// Integral of a path, linear between stations, up to a length; `sums` are the integrals up to the stations.
    fn sum_to(&self, length: f64, path: &[f64], sums: &[f64]) -> f64 {
        let i = self.lengths.partition_point(|x| *x <= length).clamp(1, self.lengths.len() - 1) - 1;
        let (from, whole) = (length - self.lengths[i], self.lengths[i + 1] - self.lengths[i]);
        let share = if whole > 0.0 { from / whole } else { 0.0 };
        sums[i] + from * (path[i] + 0.5 * share * (path[i + 1] - path[i]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TILTS: [f64; 5] = [0.0, 2.0, 4.0, 6.0, 8.0];

    /// Stations 0.1 mm apart; a tilt is clear where it lies between two limits.
    fn clear(limits: impl Fn(f64) -> [f64; 2]) -> (Vec<f64>, Vec<Vec<bool>>) {
        let lengths: Vec<f64> = (0..=200).map(|i| 0.1 * f64::from(i)).collect();
        let within = |t: f64, s: f64| limits(s)[0] <= t && t <= limits(s)[1];
        let clear = TILTS.iter().map(|t| lengths.iter().map(|s| within(*t, *s)).collect()).collect();
        (lengths, clear)
    }

    /// Small tilts are clear in the first half, large ones in the second, and both for some millimetres in the middle.
    #[test]
    fn a_path_goes_from_small_tilts_to_large_ones() {
        let limits = |s: f64| [if s < 11.0 { 0.0 } else { 6.0 }, if s < 7.0 { 2.0 } else { 8.0 }];
        let (lengths, clear) = clear(limits);
        let tilts = ClearTilts { lengths: &lengths, tilts: &TILTS, clear: &clear };
        let path = tilts.smooth_paths(0.5, &lengths).next().unwrap();
        for (s, tilt) in lengths.iter().zip(&path) {
            let [low, high] = limits(*s);
            assert!(low - 1e-9 <= *tilt && *tilt <= high + 1e-9, "{s}: {tilt}");
        }
        let steepest = path.windows(2).map(|pair| (pair[1] - pair[0]).abs() / 0.1).fold(0.0, f64::max);
        assert!(steepest < 6.0, "{steepest}");
    }

    /// Where small and large tilts are never clear together, there is no path.
    #[test]
    fn a_jump_is_no_path() {
        let (lengths, clear) = clear(|s| if s < 10.0 { [0.0, 2.0] } else { [6.0, 8.0] });
        let tilts = ClearTilts { lengths: &lengths, tilts: &TILTS, clear: &clear };
        assert!(tilts.smooth_paths(0.5, &lengths).next().is_none());
    }
}
