//! Least squares: shifts of the control points that lessen the sum of squared faults (Gauss and Newton, damped).

use super::deviation::Mounted;
use super::target::{Measured, Row, Target};
use crate::geom::DualCurve;
use nalgebra::{DMatrix, DVector};

/// Steps at most; after some ten nothing changes.
const STEPS: usize = 15;

/// Damping as a share of the mean of the diagonal: the curve may slide along itself, which changes no deviation.
const DAMPING: f64 = 1e-6;

/// How far a deviation lies outside of what a target allows; inside, nothing.
fn fault(value: f64, target: &Target) -> f64 {
    if value > target.high {
        value - target.high
    } else if value < target.low {
        value - target.low
    } else {
        0.0
    }
}

/// The curve after least squares.
pub fn least_squares(start: &DualCurve, tool: &Mounted, targets: &[Target]) -> DualCurve {
    let mut curve = start.clone();
    let sum = |m: &Measured| -> f64 { m.at.iter().zip(targets).map(|(d, t)| fault(d.value, t).powi(2)).sum() };
    let mut measured = Measured::new(&curve, tool, targets);
    let mut now = sum(&measured);
    for _ in 0..STEPS {
        let n = curve.unknowns();
        let control = curve.control_count();
        let mut normal = DMatrix::<f64>::zeros(n, n);
        let mut right = DVector::<f64>::zeros(n);
        for (d, t) in measured.at.iter().zip(targets) {
            let fault = fault(d.value, t);
            if fault == 0.0 {
                continue;
            }
            let row = Row::new(&curve, d);
            for (i, a) in row.entries(control) {
                right[i] -= a * fault;
                for (j, b) in row.entries(control) {
                    normal[(i, j)] += a * b;
                }
            }
        }
        let damping = DAMPING * normal.trace() / n as f64 + 1e-12;
        for i in 0..n {
            normal[(i, i)] += damping;
        }
        let Some(step) = normal.cholesky().map(|c| c.solve(&right)) else { break };
        let tried = [1.0, 0.5, 0.25, 0.1].into_iter().find_map(|share| {
            let next = curve.shifted(step.as_slice(), share);
            let found = measured.again(&next, tool, targets);
            let then = sum(&found);
            (then < now).then_some((next, found, then))
        });
        let Some((next, found, then)) = tried else { break };
        let gain = 1.0 - then / now;
        (curve, measured, now) = (next, found, then);
        if gain < 1e-3 {
            break;
        }
    }
    curve
}
