//! Rows of numbers over x in [0, 1] as cubic splines with equal spans: borders, rolling balls, turned edges. Their second
//! derivatives have no jumps, so that the third derivatives bound how far a cell of a chart lies from a parabola.

use nurbs::range::{Interval, Jet};
use std::array::from_fn;

/// Splines of `N` numbers. Span i has the control values i to i + 3.
#[derive(Clone, Debug)]
pub(super) struct ChartRows<const N: usize> {
    control: Vec<[f64; N]>,
}

impl<const N: usize> ChartRows<N> {
    /// Splines through at least four rows, for rows of smooth functions. The error has the fourth order of the distance of rows.
    pub(super) fn through(rows: &[[f64; N]]) -> Self {
        let last = rows.len() - 1;
        // The third derivative has no jump at the second row and at the last but one: that gives their control values.
        let inner = |i: usize| from_fn(|k| rows[i][k] - (rows[i - 1][k] - 2.0 * rows[i][k] + rows[i + 1][k]) / 6.0);
        let mut control = vec![[0.0; N]; rows.len() + 2];
        (control[2], control[last]) = (inner(1), inner(last - 1));
        // Row i is a sixth of the control values i and i + 2 and two thirds of i + 1: elimination of a band.
        let mut shares = vec![0.0; rows.len()];
        for i in 3..last {
            shares[i] = 1.0 / (4.0 - shares[i - 1]);
            control[i] = from_fn(|k| (6.0 * rows[i - 1][k] - control[i - 1][k]) * shares[i]);
        }
        for i in (3..last).rev() {
            control[i] = from_fn(|k| control[i][k] - shares[i] * control[i + 1][k]);
        }
        let outer =
            |row: &[f64; N], [next, second]: [&[f64; N]; 2]| from_fn(|k| 6.0 * row[k] - 4.0 * next[k] - second[k]);
        control[1] = outer(&rows[1], [&control[2], &control[3]]);
        control[0] = outer(&rows[0], [&control[1], &control[2]]);
        control[last + 1] = outer(&rows[last - 1], [&control[last], &control[last - 1]]);
        control[last + 2] = outer(&rows[last], [&control[last + 1], &control[last]]);
        Self { control }
    }

    /// Splines along rows of a border with corners or jumps, from the first to the last row. They never swing beyond neighbouring
    /// rows. At a bend they pass a row by a sixth of its second difference.
    pub(super) fn along(rows: &[[f64; N]]) -> Self {
        let beyond = |end: &[f64; N], next: &[f64; N]| from_fn(|k| 2.0 * end[k] - next[k]);
        let last = rows.len() - 1;
        let mut control = Vec::with_capacity(rows.len() + 2);
        control.push(beyond(&rows[0], &rows[1]));
        control.extend(rows);
        control.push(beyond(&rows[last], &rows[last - 1]));
        Self { control }
    }

    fn spans(&self) -> usize {
        self.control.len() - 3
    }

    /// Span at x, and the share of it.
    fn span(&self, x: f64) -> (usize, f64) {
        let at = x.clamp(0.0, 1.0) * self.spans() as f64;
        let i = (at as usize).min(self.spans() - 1);
        (i, at - i as f64)
    }

    /// The numbers at x; outside of [0, 1] those of the nearest end.
    pub(super) fn at(&self, x: f64) -> [f64; N] {
        let (i, t) = self.span(x);
        let w = weights(t);
        from_fn(|k| (0..4).map(|j| self.control[i + j][k] * w[0][j]).sum())
    }

    /// The numbers over a range of x. Where x does not vary they are constants somewhere in their ranges.
    pub(super) fn jets(&self, range: [f64; 2], varies: bool) -> [Jet; N] {
        let [(first, from), (last, to)] = range.map(|x| self.span(x));
        from_fn(|k| {
            let mut orders = self.over(k, first, [from, if first == last { to } else { 1.0 }]);
            for i in first + 1..=last {
                let own = self.over(k, i, [0.0, if i == last { to } else { 1.0 }]);
                orders = from_fn(|d| orders[d].join(own[d]));
            }
            if varies { Jet { orders, smooth: 2 } } else { Jet::constant(orders[0]) }
        })
    }

    /// Ranges of number k and its derivatives by x over a part of a span, by the control points of Bezier.
    fn over(&self, k: usize, span: usize, [from, to]: [f64; 2]) -> [Interval; 4] {
        let rate = self.spans() as f64;
        let at = |t: f64| weights(t).map(|w| (0..4).map(|j| self.control[span + j][k] * w[j]).sum::<f64>());
        let (a, b, width) = (at(from), at(to), to - from);
        let value = [a[0], a[0] + a[1] * width / 3.0, b[0] - b[1] * width / 3.0, b[0]];
        let first = [a[1], a[1] + a[2] * width / 2.0, b[1]];
        [
            Interval::hull(value),
            Interval::hull(first) * rate,
            Interval::hull([a[2], b[2]]) * (rate * rate),
            Interval::of(a[3]) * (rate * rate * rate),
        ]
    }
}

/// Weights of the four control values of a span at a share of it: of the value and of its derivatives by the share.
fn weights(t: f64) -> [[f64; 4]; 4] {
    let s = 1.0 - t;
    [
        [
            s * s * s / 6.0,
            (3.0 * t - 6.0) * t * t / 6.0 + 2.0 / 3.0,
            (3.0 * s - 6.0) * s * s / 6.0 + 2.0 / 3.0,
            t * t * t / 6.0,
        ],
        [-0.5 * s * s, (1.5 * t - 2.0) * t, (2.0 - 1.5 * s) * s, 0.5 * t * t],
        [s, 3.0 * t - 2.0, 3.0 * s - 2.0, t],
        [-1.0, 3.0, -3.0, 1.0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(count: usize, f: impl Fn(f64) -> f64) -> Vec<[f64; 1]> {
        (0..count).map(|i| [f(i as f64 / (count - 1) as f64)]).collect()
    }

    /// Through cubics without error, also for four rows, and of the fourth order otherwise.
    #[test]
    fn splines_meet_smooth_functions() {
        let cubic = |x: f64| 2.0 - 3.0 * x + 5.0 * x * x - 4.0 * x * x * x;
        for count in [4, 5, 6, 7, 40] {
            let spline = ChartRows::through(&rows(count, cubic));
            for i in 0..=100 {
                let x = f64::from(i) / 100.0;
                assert!((spline.at(x)[0] - cubic(x)).abs() < 1e-12, "{count} rows at {x}");
            }
        }
        let wave = |x: f64| (7.0 * x).sin();
        let error = |count: usize| {
            let spline = ChartRows::through(&rows(count, wave));
            (0..=1000).map(|i| f64::from(i) / 1000.0).map(|x| (spline.at(x)[0] - wave(x)).abs()).fold(0.0, f64::max)
        };
        assert!(error(101) < 2e-6);
        assert!(error(201) < error(101) / 12.0);
    }

    /// A border with a jump stays between its rows, and begins and ends at its ends.
    #[test]
    fn borders_do_not_swing() {
        let jump = rows(41, |x| if x < 0.5 { 1.0 } else { 3.0 });
        let border = ChartRows::along(&jump);
        for i in 0..=1000 {
            let [v] = border.at(f64::from(i) / 1000.0);
            // But for rounding.
            assert!((1.0 - 1e-12..=3.0 + 1e-12).contains(&v), "{v}");
        }
        let line = ChartRows::along(&rows(41, |x| 4.0 - x));
        assert!((line.at(0.0)[0] - 4.0).abs() < 1e-14 && (line.at(1.0)[0] - 3.0).abs() < 1e-14);
    }

    /// Jets contain values and differences at places of their range.
    #[test]
    fn jets_hold_values_and_differences() {
        const DIFFERENCE_STEP: f64 = 1e-4;
        let spline = ChartRows::through(&rows(30, |x| (9.0 * x).sin() + x * x));
        let f = |x: f64| spline.at(x)[0];
        for (from, width) in [(0.11, 0.004), (0.2, 0.1), (0.5, 0.0), (0.93, 0.06)] {
            let [jet] = spline.jets([from, from + width], true);
            for i in 0..=50 {
                let x = from + width * f64::from(i) / 50.0;
                let second = (f(x + DIFFERENCE_STEP) - 2.0 * f(x) + f(x - DIFFERENCE_STEP))
                    / (DIFFERENCE_STEP * DIFFERENCE_STEP);
                let values =
                    [f(x), (f(x + DIFFERENCE_STEP) - f(x - DIFFERENCE_STEP)) / (2.0 * DIFFERENCE_STEP), second];
                for (order, v) in values.into_iter().enumerate() {
                    let Interval { low, high } = jet.orders[order];
                    // Differences reach over neighbouring places.
                    let reserve = [1e-12, 1e-4, 0.5][order];
                    assert!(low - reserve <= v && v <= high + reserve, "order {order} at {x}: {v} in {low}..{high}");
                    assert!(high - low <= 20.0 * width * 9.0_f64.powi(order as i32 + 1) + 1e-12, "too wide");
                }
            }
            let [still] = spline.jets([from, from + width], false);
            assert_eq!(still, Jet::constant(jet.orders[0]));
        }
    }
}
