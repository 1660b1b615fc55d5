//! Minimises the largest violation: linear programs over shifts within a trust region (sequential linear programming;
//! Ding and Zhu 2009, algorithms reference 1.4).

use super::deviation::{Deviation, Mounted};
use super::measured::{Measured, Row, VIOLATION_ROUNDING_MM};
use super::step::{Aim, Model, best};
use super::target::Target;
use nurbs::DualCurve;

/// Result of [`minimax`].
#[derive(Clone, Debug)]
pub struct Best {
    /// The curves.
    pub curve: DualCurve,
    /// Deviations.
    pub measured: Measured,
    /// Least widening, in proportion to the shares `give`, with which all bounds hold, mm; zero when they hold.
    pub widening: f64,
    /// Number of steps.
    pub steps: usize,
}

/// Largest number of steps.
const MAX_MINIMAX_STEPS: usize = 40;

/// First trust region, mm: half of the shift over which the deviations of a blade differ from the linear model by less
/// than 1 um.
const TRUST_REGION_MM: f64 = 0.05;

/// Trust region at which the iteration stops, mm.
const NARROWEST_TRUST_MM: f64 = 1e-4;

/// Widening below which all bounds count as kept, mm.
const NO_WIDENING_MM: f64 = 1e-6;

/// Times that steps begin again because the widening is larger than they found.
const AGAIN: usize = 24;

/// The curves near `start` with the least widening of all bounds. Stops when the relative gain of a step is at most
/// `gain`. The start must keep the bounds that may not give way.
pub fn minimax(start: &DualCurve, tool: &Mounted<'_>, targets: &[Target], gain: f64) -> Best {
    let (mut best, mut seen) = descended(start, tool, targets, gain);
    let mut least = best.clone();
    for _ in 0..AGAIN {
        // Steps search near the last best parameter; the result is measured everywhere.
        if best.widening <= seen + NO_WIDENING_MM {
            break;
        }
        (best, seen) = descended(&best.curve, tool, targets, gain);
        if best.widening < least.widening {
            least = best.clone();
        }
    }
    least
}

/// The curves after steps, and the widening that the last step found.
fn descended(start: &DualCurve, tool: &Mounted<'_>, targets: &[Target], gain: f64) -> (Best, f64) {
    let mut curve = start.clone();
    let mut measured = Measured::new(&curve, tool, targets);
    let mut now = measured.widening(targets);
    let mut trust = TRUST_REGION_MM;
    let mut steps = 0;
    let mut kept = Vec::new();
    while steps < MAX_MINIMAX_STEPS && now > NO_WIDENING_MM && trust > NARROWEST_TRUST_MM {
        steps += 1;
        let rows = Row::all(&curve, &measured);
        let values: Vec<f64> = measured.at.iter().map(|d| d.value).collect();
        let model = Model { rows: &rows, values: &values, targets, curve: &curve, trust };
        let Some(step) = best(&model, &Aim::Widening(now), &mut kept) else {
            trust *= 0.5;
            continue;
        };
        let promised = step.widening;
        let mut next = curve.shifted(&step.shift, 1.0);
        let mut found = measured.again(&next, tool, targets);
        let mut then = found.widening(targets);
        if then > promised + 0.2 * (now - promised) {
            let values = model.corrected(&step.shift, &found);
            let corrected = Model { values: &values, ..model };
            if let Some(step) = best(&corrected, &Aim::Widening(now), &mut kept) {
                let other = curve.shifted(&step.shift, 1.0);
                let again = found.again(&other, tool, targets);
                let value = again.widening(targets);
                if value < then {
                    (next, found, then) = (other, again, value);
                }
            }
        }
        if then >= now {
            if now - promised < 2.0 * gain * now {
                break;
            }
            trust *= 0.35;
            continue;
        }
        let kept_promise = (now - then) / (now - promised).max(NO_WIDENING_MM);
        trust *= if kept_promise > 0.7 {
            1.6
        } else if kept_promise < 0.3 {
            0.5
        } else {
            1.0
        };
        let gained = now - then;
        (curve, measured, now) = (next, found, then);
        if gained < gain * now {
            break;
        }
    }
    let measured = Measured::new(&curve, tool, targets);
    (Best { widening: measured.widening(targets), curve, measured, steps }, now)
}

/// Result of [`finest`].
#[derive(Clone, Debug)]
pub struct Finest {
    /// The curves with their deviations.
    pub best: Best,
    /// Points of the optimisation: the given points, and the dense points that exceeded them.
    pub targets: Vec<Target>,
}

/// Share by which dense points may exceed the widening, and rounds in which such points join.
const OUTSTANDING: f64 = 1e-2;
const EXCHANGES: usize = 5;

/// Relative gain that finer knots must achieve, and the largest number of control points.
const WORTH: f64 = 0.03;
const MAX_CONTROL: usize = 40;

/// Widening that finer knots need not reduce, mm.
const SMALL_WIDENING_MM: f64 = 1e-5;

/// [`minimax`] over dense points, of which few take part: dense points with larger violations than the others join
/// them. Knot spans are halved as long as this reduces the widening by more than 3 %.
pub fn finest(start: &DualCurve, tool: &Mounted<'_>, targets: &[Target], dense: &[Target], gain: f64) -> Finest {
    let exchanged = |start: &DualCurve, mut targets: Vec<Target>| {
        let mut best = minimax(start, tool, &targets, gain);
        for _ in 0..EXCHANGES {
            let all = Measured::new(&best.curve, tool, dense);
            let allowed = best.widening * (1.0 + OUTSTANDING) + NO_WIDENING_MM;
            let stands_out = |(d, t): (&Deviation, &Target)| {
                (t.low - d.value > allowed * t.give[0] + VIOLATION_ROUNDING_MM
                    || d.value - t.high > allowed * t.give[1] + VIOLATION_ROUNDING_MM)
                    .then_some(*t)
            };
            let joining: Vec<Target> = all.at.iter().zip(dense).filter_map(stands_out).collect();
            if joining.is_empty() {
                break;
            }
            targets.extend(joining);
            best = minimax(&best.curve, tool, &targets, gain);
        }
        Finest { best, targets }
    };
    let mut found = exchanged(start, targets.to_vec());
    while found.best.widening > SMALL_WIDENING_MM && found.best.curve.control_count() < MAX_CONTROL {
        let finer = exchanged(&found.best.curve.refined(), found.targets.clone());
        let worth = finer.best.widening < (1.0 - WORTH) * found.best.widening;
        if finer.best.widening < found.best.widening {
            found = finer;
        }
        if !worth {
            break;
        }
    }
    found
}
