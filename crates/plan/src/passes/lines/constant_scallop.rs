//! Lines of constant scallop between two walls of a floor.
//!
//! The unit of the metric is the step of the scallop law. In this metric each line is the front one step ahead of its
//! predecessor ([`BandMetric::front`]). Such a family of lines starts at each wall, so that both walls are lines. It
//! ends at the seam, where it meets the other family; the points of the seam are equally far from both walls. Where the
//! channel widens, the two lines number k separate at the point of the seam that is k steps from both walls. Where the
//! seam is between half a step and one step beyond the lines k - 1, a single line along the seam is enough; it
//! continues as line k of the first family. Every point therefore lies within half a step of a line, and no place has
//! more lines than this requires.
//!
//! Earlier tools may have finished the floor between two edges. A line is then used only where its strip, half a step to
//! both sides, begins before the edge: up to there no earlier line is as near as half a step of its own tool.
//!
//! ```text
//! first wall ---------------------------------- 0
//!            ---------------------------------- 1
//!                             ----------------- 2      from the seam on
//!                      ------<                         along the seam, then apart
//!                             ----------------- 2
//!            ---------------------------------- 1
//! second wall --------------------------------- 0
//! ```

use nurbs::BandMetric;
use nurbs::bracket::Bracket;
use nurbs::geodesic::cubic_weights;

/// Share of a step over which a line turns from the seam into its family, on both sides of the place where they meet.
/// It is less than half, so that the turn is complete where the next line begins.
const SEAM_TURN_SHARE: f64 = 0.45;

/// Distance of the front of line k of the second family behind the seam where the line begins, in units of [`SEAM_TURN_SHARE`].
/// Up to there the line of the first family has moved off the seam by t^3 / 6 with t = 0.8, and the other side has a
/// reserve of 0.2.
const BEGIN_LAG: f64 = 0.2;

/// Share by which the distance from a point to the nearest line may exceed half a step.
const COVER_TOLERANCE: f64 = 1e-3;

/// One line over the floor.
pub(crate) struct Track {
    /// y at the stations of the metric, also where the line is not used.
    pub(crate) azimuth: Vec<f64>,
    /// Range of x in which the line is used; infinite at an end that continues beyond the end of the floor.
    pub(crate) range: [f64; 2],
}

/// A family of fronts from one wall, with half a step between neighbours.
struct Family {
    sign: f64,
    fronts: Vec<Vec<f64>>,
}

/// Lines over the floor between two walls, for x over `span`, from the first wall to the second. A wall is given as y
/// at the stations of the metric; the second y is greater than the first inside of `span`. The unit of the metric is
/// the step. `finished` has the edges of the floor that earlier tools have finished, station by station; it is empty
/// where there is none. A line that would end less than `short` (in x) from an end of the span, or from its own next piece, is not
/// interrupted. `None` when the families have not met after `most` lines.
pub(crate) fn tracks(
    metric: &BandMetric,
    walls: [&[f64]; 2],
    finished: &[Option<[f64; 2]>],
    span: [f64; 2],
    short: f64,
    most: usize,
) -> Option<Vec<Track>> {
    let x: Vec<f64> = metric.stations().collect();
    let used: Vec<bool> = x.iter().map(|x| (span[0]..=span[1]).contains(x)).collect();
    let mut first = Family { sign: 1.0, fronts: vec![walls[0].to_vec()] };
    let mut second = Family { sign: -1.0, fronts: vec![walls[1].to_vec()] };
    // At least four fronts, which the cubic between them needs.
    while first.fronts.len() < 4 || !met(&first, &second) {
        if first.fronts.len() > 2 * most + 4 {
            return None;
        }
        let halves = [first.half(metric), second.half(metric)];
        // Stations at which the halves have not met yet: behind the seam a family is not used.
        let open: Vec<bool> =
            used.iter().zip(halves[0].iter().zip(&halves[1])).map(|(u, (a, b))| *u && a < b).collect();
        for (family, half) in [&mut first, &mut second].into_iter().zip(halves) {
            family.advance(metric, half, &open);
        }
    }
    let seam: Vec<[f64; 2]> = (0..x.len()).map(|i| seam_at(&first, &second, i)).collect();
    let finished = surely_finished(metric, &x, &seam, finished);
    let turn: Vec<f64> = x.iter().zip(&seam).map(|(x, s)| SEAM_TURN_SHARE / metric.form(*x, s[1])[1]).collect();
    let mut sides: [Vec<Track>; 2] = [Vec::new(), Vec::new()];
    for (end, (side, family)) in sides.iter_mut().zip([&first, &second]).enumerate() {
        for (k, front) in family.fronts.iter().step_by(2).enumerate() {
            if k == 0 {
                let range = [f64::NEG_INFINITY, f64::INFINITY];
                side.push(Track { azimuth: front.clone(), range });
                continue;
            }
            let azimuth: Vec<f64> = (0..x.len())
                .map(|i| seam[i][1] - family.sign * soft_rest(family.sign * (seam[i][1] - front[i]), turn[i]))
                .collect();
            let need = |i: usize| {
                let to_seam = match end {
                    0 => seam[i][0] - (k as f64 - 0.5),
                    _ => family.sign * (seam[i][1] - front[i]) / turn[i] + BEGIN_LAG,
                };
                let Some(edges) = finished[i] else { return to_seam };
                let to_edge = family.sign * (edges[end] - family.fronts[2 * k - 1][i]);
                to_seam.min(to_edge * metric.form(x[i], edges[end])[1])
            };
            let need: Vec<f64> = (0..x.len()).map(need).collect();
            for range in ranges(&x, &need, span, short) {
                side.push(Track { azimuth: azimuth.clone(), range });
            }
        }
    }
    let [mut all, back] = sides;
    all.extend(back.into_iter().rev());
    Some(all)
}

/// The edges of finished floor that lines may rely on. A line that ends covers its strip only up to its end, so the floor
/// counts as finished where it is so over half a step along both ways. The seam has to lie in it, for each family goes no
/// further than that.
fn surely_finished(
    metric: &BandMetric,
    x: &[f64],
    seam: &[[f64; 2]],
    finished: &[Option<[f64; 2]>],
) -> Vec<Option<[f64; 2]>> {
    let holds_seam = |i: usize| {
        let edges = finished.get(i).copied().flatten();
        edges.filter(|[low, high]| (*low..=*high).contains(&seam[i][1]))
    };
    let held: Vec<Option<[f64; 2]>> = (0..x.len()).map(holds_seam).collect();
    let spacing = (x[x.len() - 1] - x[0]) / (x.len() - 1) as f64;
    let sure = |i: usize| {
        let around = (0.5 / (metric.form(x[i], seam[i][1])[0] * spacing)).ceil() as usize;
        let near = &held[i.saturating_sub(around)..(i + around + 1).min(x.len())];
        let all: Option<Vec<[f64; 2]>> = near.iter().copied().collect();
        let [low, high] = all?
            .into_iter()
            .fold([f64::NEG_INFINITY, f64::INFINITY], |[low, high], edges| [low.max(edges[0]), high.min(edges[1])]);
        (low < high).then_some([low, high])
    };
    (0..x.len()).map(sure).collect()
}

/// True when the families have met at all stations.
fn met(first: &Family, second: &Family) -> bool {
    let (Some(a), Some(b)) = (first.fronts.last(), second.fronts.last()) else { return true };
    a.iter().zip(b).all(|(a, b)| a >= b)
}

impl Family {
    /// The front half a step ahead of the last line.
    fn half(&self, metric: &BandMetric) -> Vec<f64> {
        self.fronts.last().map_or_else(Vec::new, |line| metric.front(line, 0.5 * self.sign))
    }

    /// Adds a half front and the next line. Where the half front is hollow, a corner of the next line would lie too far
    /// from parts of it; the line then moves nearer until all of the half front is covered.
    fn advance(&mut self, metric: &BandMetric, half: Vec<f64>, open: &[bool]) {
        const TRIES: usize = 12;
        let mut ahead = 0.5;
        let mut next = metric.front(&half, ahead * self.sign);
        for _ in 0..TRIES {
            let back = metric.front(&next, -0.5 * self.sign);
            let uncovered = metric
                .stations()
                .enumerate()
                .filter(|(i, _)| open[*i])
                .map(|(i, x)| self.sign * (back[i] - half[i]) * metric.form(x, half[i])[1])
                .fold(0.0, f64::max);
            if uncovered < 0.5 * COVER_TOLERANCE || ahead <= 0.0 {
                break;
            }
            ahead = (ahead - 1.2 * uncovered).max(0.0);
            next = metric.front(&half, ahead * self.sign);
        }
        self.fronts.extend([half, next]);
    }

    /// y of the family at station `i`, `steps` steps from its wall.
    fn at(&self, i: usize, steps: f64) -> f64 {
        let at = (2.0 * steps).max(0.0);
        let first = (at.floor().max(1.0) as usize - 1).min(self.fronts.len() - 4);
        let w = cubic_weights(at - first as f64);
        (0..4).map(|j| self.fronts[first + j][i] * w[j]).sum()
    }
}

/// Steps from the walls to the seam at a station, and y of the seam there. Where the walls have crossed, the seam is
/// half way between them.
fn seam_at(first: &Family, second: &Family, i: usize) -> [f64; 2] {
    let gap = |steps: f64| second.at(i, steps) - first.at(i, steps);
    let last = first.fronts.len() - 1;
    if gap(0.0) <= 0.0 {
        return [0.0, 0.5 * (first.at(i, 0.0) + second.at(i, 0.0))];
    }
    let beyond = (1..=last).find(|j| second.fronts[*j][i] <= first.fronts[*j][i]).unwrap_or(last);
    let ends = Bracket { holds: 0.5 * (beyond - 1) as f64, fails: 0.5 * beyond as f64 };
    // To rounding.
    let low = ends.halved(50, |steps| gap(steps) > 0.0).holds;
    [low, 0.5 * (first.at(i, low) + second.at(i, low))]
}

/// Distance that a line keeps from the seam, from the distance of its front before the seam (negative behind). The
/// result is zero behind the seam and the distance itself before it. Over `width` on both sides a smooth curve (twice
/// continuously differentiable) joins both; it is never less than either.
fn soft_rest(distance: f64, width: f64) -> f64 {
    let share = (1.0 - distance.abs() / width).max(0.0);
    distance.max(0.0) + width * share.powi(3) / 6.0
}

/// Ranges of x inside of the span where `need`, given at the stations, is not negative.
fn ranges(x: &[f64], need: &[f64], span: [f64; 2], short: f64) -> Vec<[f64; 2]> {
    let mut found: Vec<[f64; 2]> = Vec::new();
    let mut take = |from: f64, to: f64| {
        let (from, to) = (from.max(span[0]), to.min(span[1]));
        if from >= to {
            return;
        }
        match found.last_mut() {
            Some(last) if from - last[1] <= 2.0 * short => last[1] = to,
            _ => found.push([from, to]),
        }
    };
    for i in 0..x.len() - 1 {
        let (a, b) = (need[i], need[i + 1]);
        let crossing = x[i] + (x[i + 1] - x[i]) * a / (a - b);
        match (a >= 0.0, b >= 0.0) {
            (true, true) => take(x[i], x[i + 1]),
            (true, false) => take(x[i], crossing),
            (false, true) => take(crossing, x[i + 1]),
            (false, false) => {}
        }
    }
    for range in &mut found {
        if range[0] - span[0] <= short {
            range[0] = f64::NEG_INFINITY;
        }
        if span[1] - range[1] <= short {
            range[1] = f64::INFINITY;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPEN: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    /// Distance from a point to the nearest used line, in a plane metric with the given step, by brute force over
    /// pieces.
    fn nearest(metric: &BandMetric, tracks: &[Track], step: f64, x: f64, y: f64) -> f64 {
        let mut least = f64::INFINITY;
        for track in tracks {
            let range = [track.range[0].max(x - step), track.range[1].min(x + step)];
            for i in 0..=200 {
                let t = range[0] + (range[1] - range[0]) * f64::from(i) / 200.0;
                if range[0] <= range[1] {
                    least = least.min((x - t).hypot(y - metric.at(&track.azimuth, t)));
                }
            }
        }
        least / step
    }

    #[test]
    fn parallel_walls_have_parallel_lines() {
        // Width in steps, and the number of lines: one more than the width in steps, rounded up. At 1.95 both middle
        // lines have already begun.
        for (width, lines) in
            [(0.4, 2), (0.95, 2), (1.4, 3), (1.8, 3), (1.95, 4), (2.2, 4), (6.5, 8), (9.7, 11), (10.2, 12)]
        {
            let metric = BandMetric::new(-3.0, 13.0, 161, |_| [2.0, 2.0]);
            let walls = [0.0, 0.5 * width].map(|y| vec![y; 161]);
            let found = tracks(&metric, [&walls[0], &walls[1]], &[], [0.0, 10.0], 0.5, 40).unwrap();
            assert_eq!(found.len(), lines, "{width}");
            assert!(found.iter().all(|t| t.range == OPEN));
            let y: Vec<f64> = found.iter().map(|t| t.azimuth[80]).collect();
            assert!(y[0] == 0.0 && y[lines - 1] == 0.5 * width);
            // Neighbours are at most a step apart.
            assert!(y.windows(2).all(|p| p[0] <= p[1] && 2.0 * (p[1] - p[0]) <= 1.0 + 1e-6), "{width}: {y:?}");
        }
    }

    #[test]
    fn walls_that_open_like_a_wedge_have_the_lines_of_two_parallels() {
        // Walls y = -x sin / cos and mirrored, from where they are 1.2 steps apart; angle of each to the middle.
        let (sin, cos) = 0.2_f64.sin_cos();
        let (step, from, to) = (0.5, 0.6 * 0.5 / 0.2_f64.tan(), 40.0);
        let metric = BandMetric::new(from - 1.0, to + 1.0, 901, |_| [1.0 / step; 2]);
        let walls = [-1.0, 1.0].map(|s| metric.stations().map(|x| s * x * sin / cos).collect::<Vec<f64>>());
        let found = tracks(&metric, [&walls[0], &walls[1]], &[], [from, to], 0.1, 100).unwrap();
        // The seam is the middle, x sin away from both walls.
        let most = (to * sin / step).floor() as usize;
        let half = (to * sin / step - most as f64 >= 0.5) as usize;
        assert_eq!(found.len(), 2 * (most + 1) + half);
        let mut length = 0.0;
        for (k, track) in found.iter().take(most + 1).enumerate().skip(1) {
            // The line starts along the seam, half a step beyond the previous lines.
            let starts = (k as f64 - 0.5) * step / sin;
            let expected = if starts < from { f64::NEG_INFINITY } else { starts };
            assert!((track.range[0] - expected).abs() < 1e-3 || expected == track.range[0], "{k}: {:?}", track.range);
            assert!(track.range[1] == f64::INFINITY);
            // Far from the seam the line is parallel to the wall.
            let at = metric.at(&track.azimuth, to);
            assert!(((at + to * sin / cos) * cos / step - k as f64).abs() < 1e-6, "{k}: {at}");
            length += to - starts.max(from);
        }
        assert!(length > 0.0);
        // Every point lies within half a step of a line.
        let mut worst = 0.0_f64;
        for i in 0..160 {
            let x = from + (to - from) * (f64::from(i) + 0.37) / 160.0;
            for j in 0..=60 {
                let y = x * sin / cos * (f64::from(j) / 30.0 - 1.0);
                worst = worst.max(nearest(&metric, &found, step, x, y));
            }
        }
        assert!(worst < 0.5 + 2e-3 && worst > 0.49, "{worst}");
    }

    #[test]
    fn a_waist_has_lines_that_end_and_begin_again() {
        let metric = BandMetric::new(-1.0, 41.0, 421, |_| [1.0, 1.0]);
        let half = |x: f64| 2.2 + 1.6 * (x / 20.0 * std::f64::consts::PI).cos();
        let walls = [-1.0, 1.0].map(|s| metric.stations().map(|x| s * half(x)).collect::<Vec<f64>>());
        let found = tracks(&metric, [&walls[0], &walls[1]], &[], [0.0, 40.0], 0.3, 100).unwrap();
        let ends = found.iter().filter(|t| t.range[0] == f64::NEG_INFINITY && t.range[1].is_finite()).count();
        let begins = found.iter().filter(|t| t.range[0].is_finite() && t.range[1] == f64::INFINITY).count();
        assert!(ends == begins && ends > 2, "{ends} {begins}");
        let mut worst = 0.0_f64;
        for i in 0..160 {
            let x = 40.0 * (f64::from(i) + 0.37) / 160.0;
            for j in 0..=60 {
                worst = worst.max(nearest(&metric, &found, 1.0, x, half(x) * (f64::from(j) / 30.0 - 1.0)));
            }
        }
        assert!(worst < 0.502, "{worst}");
    }

    #[test]
    fn a_corner_in_a_wall_is_covered_as_well() {
        // The fronts of a wall with a hollow corner have a corner themselves: lines move nearer there.
        let metric = BandMetric::new(-21.0, 21.0, 841, |_| [1.0, 1.0]);
        let low: Vec<f64> = metric.stations().map(|x| 0.5 * x.abs()).collect();
        let high = vec![16.0; 841];
        let found = tracks(&metric, [&low, &high], &[], [-20.0, 20.0], 0.3, 200).unwrap();
        let mut worst = 0.0_f64;
        for i in 0..81 {
            let x = -6.0 + 12.0 * f64::from(i) / 80.0;
            for j in 0..=120 {
                let y = 0.5 * x.abs() + (16.0 - 0.5 * x.abs()) * f64::from(j) / 120.0;
                worst = worst.max(nearest(&metric, &found, 1.0, x, y));
            }
        }
        assert!(worst < 0.505, "{worst}");
    }

    #[test]
    fn lines_go_round_finished_floor_and_cover_all_beside_it() {
        let metric = BandMetric::new(-1.0, 41.0, 421, |_| [1.0, 1.0]);
        let (low, high) = (|x: f64| 0.3 * x, |x: f64| 12.0 + 0.5 * x);
        let edges = |x: f64| (10.0..=30.0).contains(&x).then(|| [low(x) + 3.2, high(x) - 2.4]);
        let walls: [Vec<f64>; 2] = [metric.stations().map(low).collect(), metric.stations().map(high).collect()];
        let finished: Vec<Option<[f64; 2]>> = metric.stations().map(edges).collect();
        let lines_for = |finished: &[Option<[f64; 2]>]| {
            tracks(&metric, [&walls[0], &walls[1]], finished, [0.0, 40.0], 0.3, 100).unwrap()
        };
        let (all, found) = (lines_for(&[]), lines_for(&finished));
        let mut worst = 0.0_f64;
        for i in 0..160 {
            let x = 40.0 * (f64::from(i) + 0.37) / 160.0;
            for j in 0..=80 {
                let y = low(x) + (high(x) - low(x)) * f64::from(j) / 80.0;
                if edges(x).is_none_or(|[a, b]| !(a..=b).contains(&y)) {
                    worst = worst.max(nearest(&metric, &found, 1.0, x, y));
                }
            }
        }
        assert!(worst < 0.502, "{worst}");
        // Lines go half a step into finished floor, and no further but where they end.
        for track in &found {
            for x in (0..=100).map(|i| 12.0 + 16.0 * f64::from(i) / 100.0) {
                let y = metric.at(&track.azimuth, x);
                let inside = edges(x).is_some_and(|[a, b]| (a + 0.7..=b - 0.7).contains(&y));
                assert!(!inside || x < track.range[0] || x > track.range[1], "{x} {y}");
            }
        }
        let length =
            |tracks: &[Track]| -> f64 { tracks.iter().map(|t| t.range[1].min(40.0) - t.range[0].max(0.0)).sum() };
        // The lines have the share of the floor that is not finished, and at most one line more on each side of it.
        let area = |width: &dyn Fn(f64) -> f64| (0..4000).map(|i| 0.01 * width(0.01 * f64::from(i))).sum::<f64>();
        let finished = area(&|x| edges(x).map_or(0.0, |[a, b]| b - a)) / area(&|x| high(x) - low(x));
        let most = (1.0 - finished) * length(&all) + 2.0 * 20.0;
        assert!(length(&found) < most, "{} {most} {}", length(&found), length(&all));
    }

    #[test]
    fn walls_that_never_meet_in_the_lines_allowed_give_none() {
        let metric = BandMetric::new(0.0, 1.0, 11, |_| [1.0, 1.0]);
        assert!(tracks(&metric, [&[0.0; 11], &[50.0; 11]], &[], [0.0, 1.0], 0.1, 10).is_none());
    }
}
