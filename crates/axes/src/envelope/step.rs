//! One step of an optimisation: the best shifts of the control points within a trust region, by the linear model of the
//! deviations, as a linear or quadratic program.
//!
//! Of some thousand bounds only few are active. The first program contains the bounds with the least slack. Each
//! further program adds bounds that its predecessor violates, until none is violated.

use super::measured::{MAX_ENTRIES, Measured, Row};
use super::second_derivative;
use super::target::{Of, Target};
use crate::quadratic::{Accuracy, Band, Bound, QuadraticProgram, SharedCost};
use nurbs::DualCurve;

/// Least widening that serves as the unit of the program, mm.
const LEAST_UNIT: f64 = 1e-6;

/// The linear model about a curve.
pub(super) struct Model<'a> {
    /// Derivatives of each deviation.
    pub(super) rows: &'a [Row],
    /// Deviations without a shift.
    pub(super) values: &'a [f64],
    /// Bounds of the deviations.
    pub(super) targets: &'a [Target],
    /// The curve.
    pub(super) curve: &'a DualCurve,
    /// Largest shift of a coordinate, mm.
    pub(super) trust: f64,
}

/// Objective of a step.
pub(super) enum Aim<'a> {
    /// Minimises the widening of the bounds; the value is its present size, mm.
    Widening(f64),
    /// Minimises half of shift H shift plus slope shift; the bounds do not change.
    Quadratic { hessian: &'a Band, slope: &'a [f64] },
}

/// A step.
pub(super) struct ControlStep {
    /// Shifts, mm, of all unknowns.
    pub(super) shift: Vec<f64>,
    /// Widening according to the model, mm.
    pub(super) widening: f64,
}

/// A bound of one target: `sign` times its change must be at most `limit` plus `give` times the widening.
#[derive(Clone, Copy)]
struct Side {
    target: usize,
    sign: f64,
    limit: f64,
    give: f64,
}

/// Largest number of programs for one step.
const MAX_PROGRAMS: usize = 12;

/// Number of bounds in the first program, and of bounds that join per round.
const JOIN: usize = 100;

/// Least distance between points whose bounds join in the same round, mm.
const JOINING_POINTS_DISTANCE_MM: f64 = 1.5;

/// Largest violation of a bound outside of the program, mm; less where the widening itself is small.
const BROKEN: f64 = 1e-5;

/// Slack below which a bound counts as active, mm.
const ACTIVE_SLACK_MM: f64 = 2e-4;

/// Weight of the squares of the shifts. A shift of the curve along itself changes no deviation, so that the optimum is
/// not unique without this weight. The second value applies where targets push the curve along itself.
const IDLE: f64 = 1e-4;
const IDLE_PUSHED: f64 = 1e-5;

/// The same weight for a quadratic objective, as a share of its largest diagonal entry.
const IDLE_IN_MOTION: f64 = 1e-6;

/// Weight of the second derivatives against the widening, where targets push a curve along itself, 1/mm2. Of two equal
/// curves the one with less second derivative wins, and not one that runs to and fro.
const SECOND_DERIVATIVE_WEIGHT: f64 = 1e-6;

/// Accuracy of a program: the curve is measured after each step.
const ACCURACY: Accuracy = Accuracy { gap: [1e-4, 1e-5], slope: 1e-4, at_rest: 1.0 };

/// The best shifts. `None` when a program has no solution. `kept` holds the numbers of the targets with active bounds
/// of the previous step, and is updated.
pub(super) fn best(model: &Model<'_>, aim: &Aim<'_>, kept: &mut Vec<usize>) -> Option<ControlStep> {
    let unit = match aim {
        Aim::Widening(now) => now.max(LEAST_UNIT),
        Aim::Quadratic { .. } => model.trust,
    };
    let broken = BROKEN.min(1e-2 * unit);
    kept.sort_unstable();
    let (mut active, mut open) = (Vec::new(), Vec::new());
    for (i, (target, row)) in model.targets.iter().zip(model.rows).enumerate() {
        let value = model.values[i];
        let below = Side { target: i, sign: -1.0, limit: value - target.low, give: target.give[0] };
        let above = Side { target: i, sign: 1.0, limit: target.high - value, give: target.give[1] };
        let reach = row.reach() * model.trust;
        let list = if kept.binary_search(&i).is_ok() { &mut active } else { &mut open };
        list.extend([below, above].into_iter().filter(|side| side.limit <= reach));
    }
    // First the bounds that were active, then those with the least slack.
    let joining = JOIN.saturating_sub(active.len()).min(open.len());
    if joining > 0 {
        open.select_nth_unstable_by(joining - 1, |a, b| {
            a.limit.total_cmp(&b.limit).then(a.target.cmp(&b.target)).then(a.sign.total_cmp(&b.sign))
        });
        let mut nearest: Vec<Side> = open.drain(..joining).collect();
        nearest.sort_by(|a, b| a.target.cmp(&b.target).then(a.sign.total_cmp(&b.sign)));
        active.extend(nearest);
    }
    for _ in 0..MAX_PROGRAMS {
        let step = solve(model, aim, &active, unit)?;
        let over = |side: &Side| {
            side.sign * model.rows[side.target].times(&step.shift) - side.limit - side.give * step.widening
        };
        let mut missed: Vec<(f64, usize)> =
            open.iter().enumerate().map(|(i, s)| (over(s), i)).filter(|x| x.0 > broken).collect();
        if missed.is_empty() {
            *kept = active.iter().filter(|s| over(s) > -ACTIVE_SLACK_MM).map(|s| s.target).collect();
            return Some(step);
        }
        missed.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        // The worst bound of each neighbourhood: its neighbours mostly follow.
        let mut joining: Vec<usize> = Vec::new();
        for (_, i) in missed {
            let at = model.targets[open[i].target].point;
            let is_far = |j: &usize| {
                (model.targets[open[*j].target].point - at).norm_squared()
                    > JOINING_POINTS_DISTANCE_MM * JOINING_POINTS_DISTANCE_MM
            };
            if joining.len() < JOIN && joining.iter().all(is_far) {
                joining.push(i);
            }
        }
        joining.sort_unstable();
        for i in joining.into_iter().rev() {
            active.push(open.swap_remove(i));
        }
    }
    // If the step still violates a bound, the measurement of the curve detects it.
    solve(model, aim, &active, unit)
}

impl Model<'_> {
    /// Values for a second-order correction: with them the model reproduces the measured deviations at `shift`.
    pub(super) fn corrected(&self, shift: &[f64], found: &Measured) -> Vec<f64> {
        found.at.iter().zip(self.rows).map(|(d, row)| d.value - row.times(shift)).collect()
    }
}

/// Unknowns are the shifts as shares of the trust region, and the widening as a share of `unit`.
fn solve(model: &Model<'_>, aim: &Aim<'_>, active: &[Side], unit: f64) -> Option<ControlStep> {
    let n = model.curve.unknowns();
    let bound = |side: &Side| {
        let row = &model.rows[side.target];
        let scale = side.sign * model.trust / unit;
        Bound { first: row.first, a: row.scaled(scale), limit: side.limit / unit, give: side.give, shared: 0 }
    };
    let bounds: Vec<Bound<MAX_ENTRIES>> = active.iter().map(bound).collect();
    let (quadratic, linear): (Band, Vec<f64>) = match aim {
        Aim::Widening(_) => {
            let (mut hessian, mut slope) = (Band::new(n, second_derivative::WIDTH), vec![0.0; n]);
            // Quintics run to and fro by themselves.
            let pushed = model.curve.degree() > 3 || model.targets.iter().any(|t| t.of != Of::Cutter);
            if pushed {
                second_derivative::add_model(model.curve, SECOND_DERIVATIVE_WEIGHT, &mut hessian, &mut slope);
                hessian.scale(model.trust * model.trust);
            }
            (0..n).for_each(|i| *hessian.diagonal(i) += if pushed { IDLE_PUSHED } else { IDLE });
            (hessian, slope.iter().map(|x| x * model.trust).collect())
        }
        Aim::Quadratic { hessian, slope } => {
            // Scaled by the trust region and by the largest diagonal entry.
            let scale = hessian.largest();
            let mut quadratic = (*hessian).clone();
            quadratic.scale(1.0 / scale);
            (0..n).for_each(|i| *quadratic.diagonal(i) += IDLE_IN_MOTION);
            (quadratic, slope.iter().map(|x| x / (scale * model.trust)).collect())
        }
    };
    let widening = [SharedCost { linear: 1.0, quadratic: 0.0 }];
    let (x, w) = QuadraticProgram {
        bounds: &bounds,
        entries: model.curve.entries(),
        quadratic: &quadratic,
        linear: &linear,
        shared: if matches!(aim, Aim::Widening(_)) { &widening } else { &[] },
        accuracy: ACCURACY,
    }
    .solve()?;
    let w = w.first().copied().unwrap_or(0.0);
    Some(ControlStep { shift: x.iter().map(|x| x * model.trust).collect(), widening: (w * unit).max(0.0) })
}
