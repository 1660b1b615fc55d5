//! Least squares: shifts of the control points that reduce the sum of squared violations (damped Gauss-Newton).

use super::deviation::Mounted;
use super::measured::{Measured, Row};
use super::target::Target;
use crate::quadratic::Band;
use nurbs::DualCurve;

/// Damping of unknowns that no target changes.
const LEAST_DAMPING: f64 = 1e-12;

/// Largest number of steps; after about ten nothing changes.
const MAX_FIT_STEPS: usize = 15;

/// Damping as a share of the mean of the diagonal. A shift of the curve along itself changes no deviation, so that the
/// problem is singular without it.
const DAMPING: f64 = 1e-6;

/// Signed amount by which a deviation violates its target; zero inside of the bounds.
fn fault(value: f64, target: &Target) -> f64 {
    if value > target.high {
        value - target.high
    } else if value < target.low {
        value - target.low
    } else {
        0.0
    }
}

/// The curve after least squares; the start where its largest violation is smaller. From a start that is near a hollow or
/// twisted face, least squares may end where a few points lie deep in the tool, and minimax does not get them out.
pub fn least_squares(start: &DualCurve, tool: &Mounted<'_>, targets: &[Target]) -> DualCurve {
    with_violation(start, tool, targets).0
}

/// The same, with the largest violation of the curve, mm.
fn with_violation(start: &DualCurve, tool: &Mounted<'_>, targets: &[Target]) -> (DualCurve, f64) {
    let mut curve = start.clone();
    let sum = |m: &Measured| -> f64 { m.at.iter().zip(targets).map(|(d, t)| fault(d.value, t).powi(2)).sum() };
    let mut measured = Measured::new(&curve, tool, targets);
    let mut now = sum(&measured);
    let at_start = measured.worst(targets);
    for _ in 0..MAX_FIT_STEPS {
        let n = curve.unknowns();
        let mut normal = Band::new(n, curve.entries() - 1);
        let mut right = vec![0.0; n];
        for (d, t) in measured.at.iter().zip(targets) {
            let fault = fault(d.value, t);
            if fault == 0.0 {
                continue;
            }
            let row = Row::new(&curve, d);
            normal.add_square(row.first, row.entries(), 1.0);
            for (to, a) in right[row.first..].iter_mut().zip(row.entries()) {
                *to -= a * fault;
            }
        }
        let trace: f64 = (0..n).map(|i| *normal.diagonal(i)).sum();
        (0..n).for_each(|i| *normal.diagonal(i) += DAMPING * trace / n as f64 + LEAST_DAMPING);
        let Some(step) = normal.factor().map(|f| f.solve(&right)) else { break };
        let tried = [1.0, 0.5, 0.25, 0.1].into_iter().find_map(|share| {
            let next = curve.shifted(&step, share);
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
    // Steps search near the last best parameter, here everywhere.
    let worst = Measured::new(&curve, tool, targets).worst(targets);
    if worst > at_start { (start.clone(), at_start) } else { (curve, worst) }
}

/// The best of several starts after least squares, each with its targets: its number and the curve. Least squares and minimax end in
/// the nearest optimum, and a free-form face has many; the largest violation after least squares tells which start leads to a good one.
/// `None` without starts.
pub fn best_least_squares<'a>(
    starts: impl Iterator<Item = (&'a DualCurve, Vec<Target>)>,
    tool: &Mounted<'_>,
) -> Option<(usize, DualCurve)> {
    /// Violation, as a share of that of an earlier start, below which a later one is better.
    const BETTER: f64 = 0.8;
    let mut best: Option<(f64, (usize, DualCurve))> = None;
    for (number, (start, targets)) in starts.enumerate() {
        let (curve, worst) = with_violation(start, tool, &targets);
        if best.as_ref().is_none_or(|(least, _)| worst < BETTER * least) {
            best = Some((worst, (number, curve)));
        }
    }
    best.map(|(_, found)| found)
}
