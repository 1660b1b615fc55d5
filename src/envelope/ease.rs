//! The path with the least motion of the rotary axes among those that keep all bounds: quadratic programs over shifts
//! within a trust region.
//!
//! Motion is the sum over stations of the squares of dq/ds and of `reach` times d2q/ds2 for both rotary axes, by the
//! way s of the lower curve: its first part is what the axes turn, its second what they speed up.

use super::deviation::Mounted;
use super::step::{Aim, Model, best};
use super::target::{Measured, Row, Target};
use crate::geom::{AxisAt, DualCurve};
use nalgebra::{DMatrix, DVector, Vector3};
use std::f64::consts::TAU;

/// Positions of both rotary axes for a tool axis, radians, each with its change with the tool axis.
pub type Rotary<'a> = dyn Fn(&Vector3<f64>) -> [(f64, Vector3<f64>); 2] + Sync + 'a;

/// Outcome.
#[derive(Clone, Debug)]
pub struct Eased {
    /// The curves.
    pub curve: DualCurve,
    /// Deviations.
    pub measured: Measured,
    /// Motion before and after, rad2/mm.
    pub motion: [f64; 2],
    /// Steps that were made.
    pub steps: usize,
}

/// Stations at which the motion is summed.
const STATIONS: usize = 120;

/// Rows of an axis: speeds between stations, then accelerations at those that have two neighbours.
const ROWS: usize = 2 * STATIONS - 1;

/// Trust region to begin with and to stop at, mm.
const TRUST: [f64; 2] = [0.15, 2e-3];

/// Gain of a step, as a share, to stop at.
const GAIN: f64 = 2e-2;

/// Corrections of a step before its trust region shrinks.
const CORRECTIONS: usize = 2;

/// The curves near `start` with the least motion; `reach` in mm weighs speeding up against turning. No bound is broken
/// by more than `slack`, mm, nor by more than it was at the start. At `most` so many steps are made; some ten take most
/// of the motion away.
pub fn ease(
    start: &DualCurve,
    tool: &Mounted,
    targets: &[Target],
    rotary: &Rotary<'_>,
    reach: f64,
    slack: f64,
    most: usize,
) -> Eased {
    let mut curve = start.clone();
    let mut measured = Measured::new(&curve, tool, targets);
    let [below, above] = measured.lack(targets);
    let slack = slack.max(below).max(above);
    let mut now = Motion::new(&curve, rotary, reach);
    let before = now.sum();
    let mut trust = TRUST[0];
    let mut steps = 0;
    let mut kept = Vec::new();
    while steps < most && trust > TRUST[1] {
        steps += 1;
        let change = now.change(&curve);
        let (hessian, slope) = (change.tr_mul(&change), change.tr_mul(&now.residual));
        let aim = Aim::Quadratic { hessian: &hessian, slope: &slope };
        let rows = Row::all(&curve, &measured);
        let mut values: Vec<f64> = measured.at.iter().map(|d| d.value).collect();
        let mut done = None;
        for _ in 0..=CORRECTIONS {
            let model = Model { rows: &rows, values: &values, targets, control: curve.control_count(), trust };
            let Some(step) = best(&model, &aim, &mut kept) else { break };
            let next = curve.shifted(&step.shift, 1.0);
            let found = measured.again(&next, tool, targets);
            let [below, above] = found.lack(targets);
            let then = Motion::new(&next, rotary, reach);
            if then.sum() >= now.sum() {
                break;
            }
            if below.max(above) <= slack {
                done = Some((next, found, then));
                break;
            }
            values = model.corrected(&step.shift, &found);
        }
        let Some((next, found, then)) = done else {
            trust *= 0.5;
            continue;
        };
        let gain = 1.0 - then.sum() / now.sum();
        (curve, measured, now) = (next, found, then);
        trust *= 1.3;
        if gain < GAIN {
            break;
        }
    }
    let measured = Measured::new(&curve, tool, targets);
    Eased { curve, measured, motion: [before, now.sum()], steps }
}

/// Motion of the rotary axes along a curve.
struct Motion {
    axes: Vec<AxisAt>,
    /// Change of each rotary position with the direction between the points of both curves.
    turns: Vec<[Vector3<f64>; 2]>,
    ways: Vec<f64>,
    reach: f64,
    residual: DVector<f64>,
}

impl Motion {
    fn new(curve: &DualCurve, rotary: &Rotary<'_>, reach: f64) -> Self {
        let axes: Vec<AxisAt> = (0..=STATIONS).map(|i| curve.at(i as f64 / STATIONS as f64)).collect();
        let mut at: Vec<[f64; 2]> = Vec::with_capacity(axes.len());
        let mut turns = Vec::with_capacity(axes.len());
        for axis in &axes {
            let found = rotary(&axis.axis);
            let before = at.last().copied();
            at.push(std::array::from_fn(|k| {
                let (value, last) = (found[k].0, before.map_or(found[k].0, |b| b[k]));
                value - TAU * ((value - last) / TAU).round()
            }));
            turns.push(found.map(|(_, g)| (g - axis.axis * g.dot(&axis.axis)) / axis.length));
        }
        let ways = axes.windows(2).map(|w| (w[1].lower - w[0].lower).norm_squared().sqrt().max(1e-9)).collect();
        let mut motion = Self { axes, turns, ways, reach, residual: DVector::zeros(2 * ROWS) };
        for row in 0..ROWS {
            let weights = motion.weights(row);
            motion.residual[row] = weights.iter().map(|(i, w)| at[*i][0] * w).sum();
            motion.residual[ROWS + row] = weights.iter().map(|(i, w)| at[*i][1] * w).sum();
        }
        motion
    }

    fn sum(&self) -> f64 {
        self.residual.norm_squared()
    }

    /// Stations that count in a row, with their weights: first the speeds, then the accelerations.
    fn weights(&self, row: usize) -> [(usize, f64); 3] {
        if row < STATIONS {
            let w = 1.0 / self.ways[row].sqrt();
            return [(row, -w), (row + 1, w), (row, 0.0)];
        }
        let i = row - STATIONS + 1;
        let (a, b) = (self.ways[i - 1], self.ways[i]);
        let f = self.reach / (0.5 * (a + b)).sqrt();
        [(i - 1, f / a), (i, -f / a - f / b), (i + 1, f / b)]
    }

    /// Change of the residual with the shifts; that of the ways is left out.
    fn change(&self, curve: &DualCurve) -> DMatrix<f64> {
        let control = curve.control_count();
        let mut change = DMatrix::zeros(self.residual.len(), curve.unknowns());
        let last = (self.axes.len() - 1) as f64;
        let bases: Vec<_> = (0..self.axes.len()).map(|i| curve.weights(i as f64 / last)).collect();
        for k in 0..2 {
            for row in 0..ROWS {
                for (i, weight) in self.weights(row) {
                    let (first, basis) = bases[i];
                    for (j, b) in basis.iter().enumerate() {
                        for x in 0..3 {
                            let value = self.turns[i][k][x] * b * weight;
                            let row = k * ROWS + row;
                            change[(row, 3 * (first + j) + x)] -= value;
                            change[(row, 3 * (control + first + j) + x)] += value;
                        }
                    }
                }
            }
        }
        change
    }
}
