//! Geodesic distance from a line on a chart.
//!
//! A chart has coordinates (x, y) and lengths ds^2 = (along dx)^2 + (across (dy + skew dx))^2, where each coefficient
//! may depend on x and y. On a surface of revolution, with x along the meridian and y the azimuth, they do not depend
//! on y and the skew is zero. By Huygens, the front at a distance c ahead of a line y(x) is
//!
//! ```text
//! front(x) = max over t of  y(t) + height of the disk of radius c around t, over x
//! ```
//!
//! This is the first arrival; waves that cross behind it do not matter. The result depends on no order of updates, the
//! step has no limit, and the front of a graph is a graph. Disks are taken as ellipses with the metric half way to
//! their border. Their error is of third order in c: on a plane in polar coordinates a step c at the radius r has the
//! error c^3 / 24 r^2.

use super::bracket::greatest;
use rayon::prelude::*;

/// Metric of a chart over a range of x; beyond both ends the metric is constant.
#[derive(Clone, Debug)]
pub struct BandMetric {
    from: f64,
    step: f64,
    /// y of the first layer, and the distance between layers.
    layers: [f64; 2],
    /// Length per unit of x, per unit of y, and skew: layer by layer, station by station.
    forms: Vec<Vec<[f64; 3]>>,
}

/// Places over a disk at which the maximum is searched, before its refinement.
const DISK_PLACES: usize = 12;

/// Share of a disk to which the place of the maximum is known; its height is known to the square of that.
const DISK_SHARE: f64 = 3e-6;

/// Fewest stations of a piece of work.
const STATIONS_PER_PIECE: usize = 16;

impl BandMetric {
    /// Tabulates a metric with the lengths per unit of x and of y (both positive) as functions of x, at `count` (at
    /// least 4) equally spaced stations from `from` to `to`.
    pub fn new(from: f64, to: f64, count: usize, metric: impl Fn(f64) -> [f64; 2]) -> Self {
        let form = |x: f64, _: f64| {
            let [along, across] = metric(x);
            [along, across, 0.0]
        };
        Self::over([from, to], count, [0.0, 0.0], 1, form)
    }

    /// Tabulates a metric that depends on both coordinates: along, across (both positive) and skew at (x, y), at
    /// `count` (at least 4) equally spaced stations over a range of x and on equally spaced layers over a range of y.
    /// Between layers the metric is linear, beyond them constant.
    pub fn over(
        [from, to]: [f64; 2],
        count: usize,
        [low, high]: [f64; 2],
        layers: usize,
        metric: impl Fn(f64, f64) -> [f64; 3],
    ) -> Self {
        let count = count.max(4);
        let step = (to - from) / (count - 1) as f64;
        let spacing = if layers > 1 { (high - low) / (layers - 1) as f64 } else { 0.0 };
        let row = |y: f64| (0..count).map(|i| metric(from + step * i as f64, y)).collect();
        let forms = (0..layers.max(1)).map(|k| row(low + spacing * k as f64)).collect();
        Self { from, step, layers: [low, spacing], forms }
    }

    /// Number of stations.
    fn count(&self) -> usize {
        self.forms[0].len()
    }

    /// The stations, ascending.
    pub fn stations(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.count()).map(|i| self.from + self.step * i as f64)
    }

    /// First of four stations around x, and the distance of x from it in steps.
    fn four(&self, x: f64) -> (usize, f64) {
        let at = (x - self.from) / self.step;
        let first = (at.floor().max(1.0) as usize - 1).min(self.count() - 4);
        (first, at - first as f64)
    }

    /// Value at x of values at the stations: a cubic through four of them, linear beyond the ends.
    pub fn at(&self, values: &[f64], x: f64) -> f64 {
        let last = self.count() - 1;
        let end = self.from + self.step * last as f64;
        if x < self.from {
            return values[0] + (values[1] - values[0]) * ((x - self.from) / self.step);
        }
        if x > end {
            return values[last] + (values[last] - values[last - 1]) * ((x - end) / self.step);
        }
        let (first, t) = self.four(x);
        let w = cubic_weights(t);
        (0..4).map(|k| values[first + k] * w[k]).sum()
    }

    /// Length per unit of x, per unit of y, and skew at (x, y).
    pub fn form(&self, x: f64, y: f64) -> [f64; 3] {
        self.form_on(&self.column(x), y)
    }

    /// The four stations around x, with their weights.
    fn column(&self, x: f64) -> (usize, [f64; 4]) {
        let end = self.from + self.step * (self.count() - 1) as f64;
        let (first, t) = self.four(x.clamp(self.from, end));
        (first, cubic_weights(t))
    }

    /// [`Self::form`] at the x of a column.
    fn form_on(&self, (first, w): &(usize, [f64; 4]), y: f64) -> [f64; 3] {
        let on = |layer: &[[f64; 3]]| std::array::from_fn(|k| (0..4).map(|j| layer[first + j][k] * w[j]).sum());
        if self.forms.len() == 1 {
            return on(&self.forms[0]);
        }
        let at = ((y - self.layers[0]) / self.layers[1]).clamp(0.0, (self.forms.len() - 1) as f64);
        let below = (at as usize).min(self.forms.len() - 2);
        let share = at - below as f64;
        let lower: [f64; 3] = on(&self.forms[below]);
        let upper: [f64; 3] = on(&self.forms[below + 1]);
        std::array::from_fn(|k| lower[k] + (upper[k] - lower[k]) * share)
    }

    /// The front at a distance ahead of a line, which is given by its y at the stations: towards greater y for a
    /// positive distance, towards smaller y for a negative distance.
    pub fn front(&self, line: &[f64], distance: f64) -> Vec<f64> {
        let (sign, radius) = (distance.signum(), distance.abs());
        if radius == 0.0 {
            return line.to_vec();
        }
        // With layers, the metric half way to the border of the disk depends on the border: a second round is needed.
        let rounds = if self.forms.len() > 1 { 2 } else { 1 };
        let of_station = |i: usize| {
            let x = self.from + self.step * i as f64;
            let half = radius / self.form(x, line[i])[0];
            // y over x of a disk around the point of the line at t.
            let height = |t: f64| {
                let start = self.at(line, t);
                let column = self.column(0.5 * (x + t));
                let (mut middle, mut reached) = (start, f64::NEG_INFINITY);
                for _ in 0..rounds {
                    let [along, across, skew] = self.form_on(&column, middle);
                    let run = along * (x - t);
                    let rise = radius * radius - run * run;
                    if rise < 0.0 {
                        return f64::NEG_INFINITY;
                    }
                    reached = sign * (start - skew * (x - t)) + rise.sqrt() / across;
                    middle = 0.5 * (start + sign * reached);
                }
                reached
            };
            let place = |i: usize| x + half * (2.0 * i as f64 / DISK_PLACES as f64 - 1.0);
            let heights: [f64; DISK_PLACES + 1] = std::array::from_fn(|i| height(place(i)));
            let best = (0..=DISK_PLACES).max_by(|a, b| heights[*a].total_cmp(&heights[*b])).unwrap_or(0);
            let (low, high) = (place(best.saturating_sub(1)), place((best + 1).min(DISK_PLACES)));
            sign * greatest(height, [low, high], DISK_SHARE * half).max(height(x))
        };
        (0..self.count()).into_par_iter().with_min_len(STATIONS_PER_PIECE).map(of_station).collect()
    }
}

/// Weights of the cubic through values at 0, 1, 2 and 3.
pub fn cubic_weights(t: f64) -> [f64; 4] {
    [
        -(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0,
        t * (t - 2.0) * (t - 3.0) / 2.0,
        -t * (t - 1.0) * (t - 3.0) / 2.0,
        t * (t - 1.0) * (t - 2.0) / 6.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Marches in `count` steps to a distance.
    fn march(metric: &BandMetric, line: &[f64], distance: f64, count: usize) -> Vec<f64> {
        (0..count).fold(line.to_vec(), |line, _| metric.front(&line, distance / count as f64))
    }

    #[test]
    fn plane_in_polar_coordinates_from_a_ray() {
        // Distance from the ray y = 0 is x sin y: rays of the front come from inside of the range only for y < 90 deg.
        let metric = BandMetric::new(4.0, 30.0, 261, |x| [1.0, x]);
        let mut worst = [0.0_f64; 2];
        for (worst, count) in worst.iter_mut().zip([10, 40]) {
            let front = march(&metric, &[0.0; 261], 5.0, count);
            for (x, y) in metric.stations().zip(&front).filter(|(x, _)| (12.0..28.0).contains(x)) {
                let exact = (5.0 / x).asin();
                // Across the front.
                *worst = worst.max((y - exact).abs() * x * exact.cos());
            }
        }
        // The bound of the error at the least radius that the rays run through, and its order.
        assert!(worst[0] < 10.0 * 0.5_f64.powi(3) / 24.0 / (12.0 * 12.0 - 25.0), "{worst:?}");
        assert!(worst[1] < worst[0] / 12.0, "{worst:?}");
    }

    #[test]
    fn plane_in_polar_coordinates_from_a_slanted_line_both_ways() {
        // The line r cos(y - 1) = 10, read as y(r), and its parallels.
        let metric = BandMetric::new(14.0, 40.0, 401, |x| [1.0, x]);
        let line: Vec<f64> = metric.stations().map(|x| 1.0 - (10.0 / x).acos()).collect();
        for c in [-2.0, 2.0] {
            let front = march(&metric, &line, c, 20);
            for (x, y) in metric.stations().zip(&front).filter(|(x, _)| (18.0..36.0).contains(x)) {
                // Towards greater y the foot of the perpendicular comes nearer: farther out from the origin.
                let exact = 1.0 - ((10.0 + c) / x).acos();
                assert!((y - exact).abs() * x < 1e-5, "at {x}, {c}: {}", (y - exact) * x);
            }
        }
    }

    #[test]
    fn cylinder_and_cone_are_flat() {
        // A helix on a cylinder of radius 7: parallels of a straight line.
        let metric = BandMetric::new(0.0, 20.0, 201, |_| [1.0, 7.0]);
        let line: Vec<f64> = metric.stations().map(|x| 0.05 * x).collect();
        let front = march(&metric, &line, 3.0, 6);
        let slope = 0.05 * 7.0_f64;
        for (y, y0) in front.iter().zip(&line) {
            assert!(((y - y0) * 7.0 - 3.0 * slope.hypot(1.0)).abs() < 1e-7, "{}", (y - y0) * 7.0);
        }
        // A cone of 30 deg, x along its generators: unrolled, azimuths shrink to a half.
        let metric = BandMetric::new(8.0, 40.0, 321, |x| [1.0, 0.5 * x]);
        let front = march(&metric, &[0.0; 321], 4.0, 32);
        for (x, y) in metric.stations().zip(&front).filter(|(x, _)| (12.0..38.0).contains(x)) {
            let off = (0.5 * y - (4.0 / x).asin()).abs() * x;
            assert!(off < 4e-5, "at {x}: {off}");
        }
    }

    #[test]
    fn sphere_from_a_meridian() {
        // Great circles: sin of the distance from the meridian y = 0 is sin x sin y.
        let metric = BandMetric::new(0.5, 2.6, 421, |x| [1.0, x.sin()]);
        let front = march(&metric, &[0.0; 421], 0.4, 40);
        for (x, y) in metric.stations().zip(&front).filter(|(x, _)| (0.9..2.2).contains(x)) {
            let exact = (0.4_f64.sin() / x.sin()).asin();
            assert!((y - exact).abs() < 2e-6, "at {x}: {}", y - exact);
        }
    }

    #[test]
    fn scaled_metric_scales_the_distance_in_one_direction() {
        // Lengths along count three times: the parallel of y = x is that of y' = x / 3 in the stretched plane.
        let metric = BandMetric::new(0.0, 10.0, 101, |_| [3.0, 1.0]);
        let line: Vec<f64> = metric.stations().collect();
        let front = metric.front(&line, 0.7);
        let rise = 0.7 * (1.0_f64 / 3.0).hypot(1.0);
        assert!(front.iter().zip(&line).all(|(y, y0)| (y - y0 - rise).abs() < 1e-9));
    }

    /// The plane in a skewed chart whose scale grows with y: X = x + y + y^2 / 20, Y = y + y^2 / 20.
    #[test]
    fn plane_in_a_skewed_and_stretched_chart() {
        let form = |_: f64, y: f64| {
            // dX = dx + g dy, dY = g dy with g = 1 + y / 10: ds^2 = dx^2 / 2 + 2 g^2 (dy + dx / 2g)^2.
            let g = 1.0 + 0.1 * y;
            [0.5_f64.sqrt(), 2.0_f64.sqrt() * g, 0.5 / g]
        };
        let metric = BandMetric::over([-20.0, 20.0], 401, [-1.0, 7.0], 161, form);
        let straight = |height: f64| (100.0 + 20.0 * height).sqrt() - 10.0;
        for (slope, distance) in [(0.0, 3.0), (0.3, 3.0), (0.3, -1.0)] {
            // The line Y = 1.5 + slope X, met at x by Y (1 - slope) = 1.5 + slope x.
            let y = |x: f64, above: f64| straight((1.5 + above + slope * x) / (1.0 - slope));
            let line: Vec<f64> = metric.stations().map(|x| y(x, 0.0)).collect();
            let front = march(&metric, &line, distance, 12);
            let lifted = distance * slope.hypot(1.0);
            for (x, found) in metric.stations().zip(&front).filter(|(x, _)| x.abs() < 2.0) {
                assert!((found - y(x, lifted)).abs() < 2e-3, "{slope} {distance} at {x}: {found} {}", y(x, lifted));
            }
        }
    }

    #[test]
    fn first_arrival_where_waves_cross() {
        // Two plane waves from the legs of a V meet on its axis; from the other side there is a round corner.
        let metric = BandMetric::new(-10.0, 10.0, 401, |_| [1.0, 1.0]);
        let line: Vec<f64> = metric.stations().map(f64::abs).collect();
        let (up, down) = (march(&metric, &line, 2.0, 8), march(&metric, &line, -2.0, 8));
        let root = 2.0_f64.sqrt();
        for ((x, up), down) in metric.stations().zip(&up).zip(&down) {
            assert!((up - x.abs() - 2.0 * root).abs() < 0.02, "up at {x}: {up}");
            let exact = if x.abs() < root { -(4.0 - x * x).sqrt() } else { x.abs() - 2.0 * root };
            assert!((down - exact).abs() < 0.02, "down at {x}: {down}, {exact}");
        }
    }
}
