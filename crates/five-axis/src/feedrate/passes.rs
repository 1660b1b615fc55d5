//! Time-optimal run within speed and acceleration: one pass backward and one forward over the knots of a path.
//!
//! Let y be the square of the rate of the parameter, linear over a span. The acceleration q'' y + q' y'/2 of an axis is
//! then a quadratic polynomial over the span. It keeps a limit when its three Bernstein coefficients do: six
//! half-planes of (y at the start, y at the end) per axis. The backward pass finds the largest y at each knot from
//! which the end can be reached; the forward pass takes the largest y below these values.

use super::path::PathSpan;
use super::{AXES, Axes, LIMIT_ROUNDING};

/// Coefficients of y at start and end of the span in the Bernstein coefficients of the acceleration of an axis.
fn rows(span: &PathSpan, k: usize) -> [[f64; 2]; 3] {
    let [start, end] = span.second(k);
    let [a, b, c] = span.rate.map(|r| 0.5 * r[k] / span.width);
    [[start - a, a], [0.5 * end - b, 0.5 * start + b], [-c, end + c]]
}

/// The border of a half-plane: y at the end = `offset` + `slope` * y at the start.
#[derive(Clone, Copy)]
struct Edge {
    offset: f64,
    slope: f64,
}

/// Largest and least y at the end of a span for a y at its start, with the half-planes that limit them.
fn ends(span: &PathSpan, limit: &Axes, y: f64, most: f64) -> [(f64, Edge); 2] {
    let mut upper = (most, Edge { offset: most, slope: 0.0 });
    let mut lower = (0.0, Edge { offset: 0.0, slope: 0.0 });
    for (k, limit) in limit.iter().enumerate() {
        for [start, end] in rows(span, k) {
            if end == 0.0 {
                continue;
            }
            // |start y + end z| <= limit
            let (middle, half_width) = (-start / end, limit / end.abs());
            let (top, bottom) = (half_width + middle * y, middle * y - half_width);
            if top < upper.0 {
                upper = (top, Edge { offset: half_width, slope: middle });
            }
            if bottom > lower.0 {
                lower = (bottom, Edge { offset: -half_width, slope: middle });
            }
        }
    }
    [upper, lower]
}

/// Largest y at the start of a span, up to `cap`, from which some y up to `most` at its end can be reached.
fn controllable(span: &PathSpan, limit: &Axes, cap: f64, most: f64) -> f64 {
    let mut y = cap;
    // Half-planes that do not depend on the end.
    for (k, limit) in limit.iter().enumerate() {
        for [start, end] in rows(span, k) {
            if end == 0.0 && start != 0.0 {
                y = y.min(limit / start.abs());
            }
        }
    }
    // The gap between lower and upper bound of the end is convex in y and not positive at y = 0. Newton's method from
    // above therefore converges to the y with zero gap, with one pair of half-planes per step.
    for _ in 0..2 * AXES * 3 {
        let [upper, lower] = ends(span, limit, y, most);
        if lower.0 <= upper.0 {
            return y;
        }
        let steep = lower.1.slope - upper.1.slope;
        let next = (upper.1.offset - lower.1.offset) / steep;
        if steep <= 0.0 || next >= y {
            break;
        }
        y = next.max(0.0);
    }
    // Reserve for rounding where two half-planes cross at a small angle.
    y * (1.0 - LIMIT_ROUNDING)
}

/// Largest y at every knot, zero at both ends; `cap` is the largest y at each knot.
pub(super) fn run(spans: &[PathSpan], limit: &Axes, cap: &[f64]) -> Vec<f64> {
    let mut y = cap.to_vec();
    if let Some(last) = y.last_mut() {
        *last = 0.0;
    }
    for (i, span) in spans.iter().enumerate().rev() {
        y[i] = controllable(span, limit, cap[i], y[i + 1]);
    }
    if let Some(first) = y.first_mut() {
        *first = 0.0;
    }
    for (i, span) in spans.iter().enumerate() {
        let [upper, _] = ends(span, limit, y[i], y[i + 1]);
        y[i + 1] = upper.0.max(0.0);
    }
    y
}
