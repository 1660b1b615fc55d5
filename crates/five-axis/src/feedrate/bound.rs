//! A lower bound of the time of every run within speeds and accelerations.
//!
//! The square of an axis speed is z = q'^2 y, and z' = 2 q' times its acceleration. Over a part of the path the square
//! of the speed therefore changes by at most 2 a times the travel of the axis there. This condition is necessary for
//! every run, and a larger speed at one end never reduces the allowed speed at the other. One pass forward and one
//! backward therefore give the largest y at every knot, and from it the least time.

use super::path::PathSpan;
use super::{AXES, Limits};

/// An axis over a span: largest and least |q'|, and the upper bound of the change of z.
struct Axis {
    most: f64,
    least: f64,
    change: f64,
}

fn axis(span: &PathSpan, k: usize, limits: &Limits) -> Axis {
    let r = span.rate.map(|r| r[k]);
    let least = if r.iter().all(|x| *x > 0.0) || r.iter().all(|x| *x < 0.0) {
        r.iter().fold(f64::INFINITY, |m, x| m.min(x.abs()))
    } else {
        0.0
    };
    // The travel of a quadratic of one sign is the mean of its coefficients; for any quadratic the mean of their
    // absolute values is an upper bound.
    let travel = span.width * r.iter().map(|x| x.abs()).sum::<f64>() / 3.0;
    Axis { most: span.most_rate(k), least, change: 2.0 * limits.acceleration[k] * travel }
}

/// Largest y at the other end of a span for a y at this end.
fn reached(span: &PathSpan, limits: &Limits, y: f64, backward: bool) -> f64 {
    let (from, to) = if backward { (2, 0) } else { (0, 2) };
    (0..AXES)
        .map(|k| {
            let (a, b) = (span.rate[from][k], span.rate[to][k]);
            (a * a * y + axis(span, k, limits).change) / (b * b)
        })
        .filter(|y| !y.is_nan())
        .fold(f64::INFINITY, f64::min)
}

/// Least time over a span between two upper bounds of y.
fn span_time(span: &PathSpan, limits: &Limits, cap: f64, from: f64, to: f64) -> f64 {
    let mut most = 0.0_f64;
    let fastest = |k: usize| limits.speed[k] / axis(span, k, limits).least;
    let cap = (0..AXES).map(|k| fastest(k).powi(2)).fold(cap, f64::min);
    for k in 0..AXES {
        let a = axis(span, k, limits);
        if a.least <= 0.0 {
            continue;
        }
        // y lies below two straight lines that rise from both ends, and below the cap.
        let square = a.least * a.least;
        let [start, end] = [(span.rate[0][k], from), (span.rate[2][k], to)].map(|(r, y)| r * r * y / square);
        let slope = 2.0 * limits.acceleration[k] * a.most / square;
        let peak = (0.5 * (start + end + slope * span.width)).min(cap);
        let leg = |y: f64| ((peak - y) / slope).clamp(0.0, span.width);
        let (up, down) = (leg(start), leg(end));
        let even = (span.width - up - down).max(0.0);
        let top = peak.sqrt();
        let time = |way: f64, y: f64| if way > 0.0 { 2.0 * way / (y.min(peak).sqrt() + top) } else { 0.0 };
        // Where both lines end above the peak, they overlap, and their shares of the span are reduced.
        let whole = if up + down > span.width { span.width / (up + down) } else { 1.0 };
        most = most.max(whole * (time(up, start) + time(down, end)) + even / top);
    }
    most.max(span.width / cap.sqrt())
}

/// The least time; `caps` are the largest y of each span by process feed.
pub(super) fn least_time(spans: &[PathSpan], limits: &Limits, caps: &[f64]) -> f64 {
    let n = spans.len();
    let pointwise = |i: usize| {
        let own = |span: &PathSpan, end: usize| {
            (0..AXES).map(|k| limits.speed[k] / span.rate[end][k].abs()).fold(f64::INFINITY, f64::min).powi(2)
        };
        if i < n { own(&spans[i], 0).min(caps[i]) } else { f64::INFINITY }.min(if i > 0 {
            own(&spans[i - 1], 2).min(caps[i - 1])
        } else {
            f64::INFINITY
        })
    };
    let mut y: Vec<f64> = (0..=n).map(pointwise).collect();
    for end in [0, n] {
        y[end] = 0.0;
    }
    for i in 0..n {
        y[i + 1] = y[i + 1].min(reached(&spans[i], limits, y[i], false));
    }
    for i in (0..n).rev() {
        y[i] = y[i].min(reached(&spans[i], limits, y[i + 1], true));
    }
    (0..n).map(|i| span_time(&spans[i], limits, caps[i], y[i], y[i + 1])).sum()
}
