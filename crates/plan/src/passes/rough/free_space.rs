//! Free space for the tool across the channel, and strips of it along the channel.
//!
//! Between the walls the free space is one interval of w. Before an inlet that is strongly swept, a vane stands between two free
//! intervals: above the tip the tool is beside the leading edge at the shroud, which lies ahead of that at the hub. The space
//! behind that vane belongs to no other channel, so that it has to be cleared in this one.

use super::layers::{DISTANCE_BISECTIONS, Level, Roughing, StationPlace};
use nurbs::bracket::Bracket;

/// A free interval of w.
pub(super) type FreeInterval = [f64; 2];

impl Roughing<'_> {
    /// The free interval between the walls at u of a level that is nearest to the middle.
    pub(super) fn free_interval(&self, u: f64, level: Level) -> Option<FreeInterval> {
        self.free_interval_at(&StationPlace::new(&self.chart, u), level)
    }

    /// The same at a place that is known.
    pub(super) fn free_interval_at(&self, place: &StationPlace<'_>, level: Level) -> Option<FreeInterval> {
        // The middle first, then outward: the widest place of a twisted channel is near its middle.
        const SEED_SHARES: [f64; 9] = [0.5, 0.45, 0.55, 0.4, 0.6, 0.35, 0.65, 0.3, 0.7];
        let seed = SEED_SHARES.into_iter().find(|w| self.clear(place, level, *w))?;
        Some([0.0, 1.0].map(|wall| self.boundary(place, level, seed, wall)))
    }

    /// All free intervals at u of a level, in ascending order; `several` is false where there is one at most.
    pub(super) fn free_intervals(&self, u: f64, level: Level, several: bool) -> Vec<FreeInterval> {
        let place = StationPlace::new(&self.chart, u);
        let nearest = self.free_interval_at(&place, level);
        if !several {
            return nearest.into_iter().collect();
        }
        let Some([low, high]) = nearest else { return self.free_between(&place, level, [0.0, 1.0]) };
        let [mut all, above] = [[0.0, low], [high, 1.0]].map(|gap| self.free_between(&place, level, gap));
        all.push([low, high]);
        all.extend(above);
        all
    }

    /// Free intervals inside of an interval whose ends are not free.
    fn free_between(&self, place: &StationPlace<'_>, level: Level, [from, to]: FreeInterval) -> Vec<FreeInterval> {
        let count = ((to - from) * place.width(place.v(level, from)) / self.step_across(place)).floor();
        let at = |k: f64| from + (to - from) * k / count;
        let mut free_intervals: Vec<FreeInterval> = Vec::new();
        let mut blocked = from;
        for w in (1..count as usize).map(|k| at(k as f64)) {
            if w <= blocked {
                continue;
            }
            if self.clear(place, level, w) {
                let free_interval = [blocked, to].map(|wall| self.boundary(place, level, w, wall));
                blocked = free_interval[1];
                free_intervals.push(free_interval);
            } else {
                blocked = w;
            }
        }
        free_intervals
    }

    /// Distance of the places across the channel at which the free space is tried, mm.
    fn step_across(&self, place: &StationPlace<'_>) -> f64 {
        // Beside the ends of the walls and on leads, what stands between two places a step apart comes nearer by half of the tolerance at
        // most: the corner of a blade may reach into the way of the tool by less than its radius.
        let chord = 2.0 * libm::sqrt(self.radius() * self.tolerance);
        if self.is_beside_end(place) { chord.min(self.radius()) } else { self.radius() }
    }

    /// Border of the free space from a free place towards a wall, w of both.
    fn boundary(&self, place: &StationPlace<'_>, level: Level, seed: f64, wall: f64) -> f64 {
        let (width, step) = (place.width(place.v(level, seed)), self.step_across(place));
        let mut ends = Bracket { holds: seed, fails: wall };
        loop {
            let free = ends.halved(DISTANCE_BISECTIONS, |w| self.clear(place, level, w)).holds;
            // The space need not be one up to the border that was found.
            let count = ((free - seed).abs() * width / step).ceil().max(1.0);
            let at = |k: f64| seed + (free - seed) * k / count;
            let mut steps = (1..count as usize).map(|k| k as f64);
            let Some(gap) = steps.find(|k| !self.clear(place, level, at(*k))) else { return free };
            ends = Bracket { holds: at(gap - 1.0), fails: at(gap) };
        }
    }
}

/// Free intervals of successive stations, each of which overlaps the next.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FreeStrip {
    /// Number of the first station.
    pub(super) first: usize,
    pub(super) free_intervals: Vec<FreeInterval>,
}

impl FreeStrip {
    /// Number of the station behind the last.
    fn end(&self) -> usize {
        self.first + self.free_intervals.len()
    }

    /// Goes on over the stations before and behind where their free intervals overlap the ends of the strip, no wider than these.
    fn extended(mut self, stations: &[Vec<FreeInterval>]) -> Self {
        let on = |from: FreeInterval, stations: &mut dyn Iterator<Item = &Vec<FreeInterval>>| -> Vec<FreeInterval> {
            let next = |free_interval: &mut FreeInterval, at: &Vec<FreeInterval>| {
                let widest = at
                    .iter()
                    .map(|other| common(*free_interval, *other))
                    .max_by(|a, b| width(*a).total_cmp(&width(*b)));
                *free_interval = widest.filter(|free_interval| width(*free_interval) > 0.0)?;
                Some(*free_interval)
            };
            stations.scan(from, next).collect()
        };
        let [first, last] = [self.free_intervals[0], self.free_intervals[self.free_intervals.len() - 1]];
        let before = on(first, &mut stations[..self.first].iter().rev());
        let behind = on(last, &mut stations[self.end()..].iter());
        self.first -= before.len();
        self.free_intervals.splice(0..0, before.into_iter().rev());
        self.free_intervals.extend(behind);
        self
    }
}

fn common(a: FreeInterval, b: FreeInterval) -> FreeInterval {
    [a[0].max(b[0]), a[1].min(b[1])]
}

fn width([low, high]: FreeInterval) -> f64 {
    high - low
}

/// The strips of all free intervals of successive stations. Where an interval divides or two of them join, the wider one goes on.
/// A strip that neither begins nor ends outside of the stock goes on along its neighbour, so that the tool can come in.
pub(super) fn strips(stations: &[Vec<FreeInterval>], inside: &[bool]) -> Vec<FreeStrip> {
    let mut strips: Vec<FreeStrip> = Vec::new();
    for (k, free_intervals) in stations.iter().enumerate() {
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (i, strip) in strips.iter().enumerate().filter(|(_, strip)| strip.end() == k) {
            let last = strip.free_intervals[strip.free_intervals.len() - 1];
            pairs.extend(
                free_intervals.iter().enumerate().map(|(j, free_interval)| (width(common(last, *free_interval)), i, j)),
            );
        }
        pairs.retain(|pair| pair.0 > 0.0);
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut open: Vec<bool> = vec![true; free_intervals.len()];
        for (_, i, j) in pairs {
            if open[j] && strips[i].end() == k {
                strips[i].free_intervals.push(free_intervals[j]);
                open[j] = false;
            }
        }
        let begin = free_intervals.iter().zip(open).filter(|(_, open)| *open).map(|(free_interval, _)| *free_interval);
        strips.extend(begin.map(|free_interval| FreeStrip { first: k, free_intervals: vec![free_interval] }));
    }
    let closed = |strip: &FreeStrip| inside[strip.first] && inside[strip.end() - 1];
    strips.into_iter().map(|strip| if closed(&strip) { strip.extended(stations) } else { strip }).collect()
}

#[cfg(test)]
mod tests {
    use super::{FreeStrip, strips};

    #[test]
    fn a_vane_between_two_intervals_divides_the_strip() {
        let whole = vec![[0.0, 1.0]];
        let divided = vec![[0.0, 0.6], [0.8, 1.0]];
        let stations = [whole.clone(), divided.clone(), divided, vec![[0.0, 0.6]]];
        let main = FreeStrip { first: 0, free_intervals: vec![[0.0, 1.0], [0.0, 0.6], [0.0, 0.6], [0.0, 0.6]] };
        // Outside of the stock from the first station on: the second strip is open there.
        let behind = FreeStrip { first: 1, free_intervals: vec![[0.8, 1.0]; 2] };
        assert_eq!(strips(&stations, &[false, false, true, true]), [main.clone(), behind]);
        // Inside of the stock the second strip comes in beside the first one.
        let behind = FreeStrip { first: 0, free_intervals: vec![[0.8, 1.0]; 3] };
        assert_eq!(strips(&stations, &[false, true, true, true]), [main, behind]);
    }

    #[test]
    fn intervals_that_do_not_overlap_are_two_strips() {
        let stations = [vec![[0.0, 0.3]], vec![[0.4, 0.6]], vec![], vec![[0.4, 0.6]]];
        let of = |first: usize, free_interval: [f64; 2]| FreeStrip { first, free_intervals: vec![free_interval] };
        assert_eq!(strips(&stations, &[true; 4]), [of(0, [0.0, 0.3]), of(1, [0.4, 0.6]), of(3, [0.4, 0.6])]);
    }
}
