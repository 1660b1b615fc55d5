//! The least largest fault: linear programs over shifts within a trust region (sequential linear programming; Ding and
//! Zhu 2009, algorithms reference 1.4).

use super::deviation::Mounted;
use super::step::{Aim, Model, best};
use super::target::{Measured, Row, Target};
use crate::geom::DualCurve;

/// Outcome.
#[derive(Clone, Debug)]
pub struct Best {
    /// The curves.
    pub curve: DualCurve,
    /// Deviations.
    pub measured: Measured,
    /// Least widening of the bounds, each in its share, that makes them hold, mm; zero when they hold.
    pub widening: f64,
    /// Steps that were made.
    pub steps: usize,
}

/// Steps at most.
const STEPS: usize = 40;

/// Trust region to begin with, mm: half of what the deviations of a blade bend less than a micrometre over.
const TRUST: f64 = 0.05;

/// Trust regions to stop at, mm.
const NARROW: f64 = 1e-4;

/// A widening that is none, mm.
const NONE: f64 = 1e-6;

/// The curves near `start` with the least widening of all bounds, until a step gains no more than `gain`, as a share.
/// The start must keep the bounds that do not give way.
pub fn minimax(start: &DualCurve, tool: &Mounted, targets: &[Target], gain: f64) -> Best {
    let mut curve = start.clone();
    let mut measured = Measured::new(&curve, tool, targets);
    let mut now = measured.widening(targets);
    let mut trust = TRUST;
    let mut steps = 0;
    let mut kept = Vec::new();
    while steps < STEPS && now > NONE && trust > NARROW {
        steps += 1;
        let rows = Row::all(&curve, &measured);
        let values: Vec<f64> = measured.at.iter().map(|d| d.value).collect();
        let model = Model { rows: &rows, values: &values, targets, control: curve.control_count(), trust };
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
        let kept_promise = (now - then) / (now - promised).max(NONE);
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
    // Steps look about the last best place; the last word looks everywhere.
    let measured = Measured::new(&curve, tool, targets);
    Best { widening: measured.widening(targets), curve, measured, steps }
}
