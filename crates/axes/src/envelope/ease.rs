//! The path with the least motion of the rotary axes among all paths that keep the bounds: quadratic programs over
//! shifts within a trust region.
//!
//! Motion is a sum over stations for both rotary axes: the squares of dq/ds and of `reach` times d2q/ds2, where s is
//! the length of the lower curve. The first term stands for the turn of the axes, the second for their acceleration.

use super::deviation::Mounted;
use super::measured::{Measured, Row};
use super::second_derivative;
use super::step::{Aim, Model, best};
use super::target::Target;
use crate::quadratic::{Band, dot};
use nalgebra::Vector3;
use nurbs::angle::nearest_turn;
use nurbs::{AxisAt, DualCurve};

/// Least length of the path between two stations, mm: rates are divided by it.
const NO_WAY: f64 = 1e-9;

/// Positions of both rotary axes for a tool axis, radians, each with its derivative by the tool axis.
pub type Rotary<'a> = dyn Fn(&Vector3<f64>) -> [(f64, Vector3<f64>); 2] + Sync + 'a;

/// Result of [`ease`].
#[derive(Clone, Debug)]
pub struct Eased {
    /// The curves.
    pub curve: DualCurve,
    /// Deviations.
    pub measured: Measured,
    /// Motion before and after, rad2/mm.
    pub motion: [f64; 2],
    /// Number of steps.
    pub steps: usize,
}

/// Weight of the second derivatives of quintics against the motion of the rotary axes, rad2/mm3. Without it the ends of a path run to
/// and fro along themselves, which changes no deviation and costs the axes time. From 1e-8 to 1e-6 the time differs by 4 %.
const SECOND_DERIVATIVE_WEIGHT: f64 = 1e-7;

/// Stations at which the motion is summed.
const MOTION_STATIONS: usize = 120;

/// Rows of a rotary axis: speeds between stations, then accelerations at stations with two neighbours.
const AXIS_ROWS: usize = 2 * MOTION_STATIONS - 1;

/// First trust region for few and for many steps, mm, and the number of steps that counts as many.
const TRUST_REGION_MM: [f64; 2] = [0.15, 0.05];
const LONG: usize = 10;

/// Trust region at which the iteration stops, mm.
const NARROW: f64 = 2e-3;

/// Allowed violation of the bounds during the iteration, mm: the next step removes the violation while it reduces the
/// motion.
const LOOSE: f64 = 3e-3;

/// Relative gain below which a step counts as idle, and the number of successive idle steps that end the iteration.
const GAIN: f64 = 2e-2;
const IDLE: usize = 2;

/// Largest number of final steps that bring the path back to its bounds. Each has half of the trust region of its
/// predecessor: the violation is quadratic in the trust region.
const BACK: usize = 8;

/// The curves near `start` with the least motion; `reach` in mm weighs acceleration against turn. No bound is violated
/// by more than `slack`, mm, or by more than at the start. After at most `most` steps the path returns to its bounds;
/// about twenty steps remove most of the motion.
pub fn ease(
    start: &DualCurve,
    tool: &Mounted<'_>,
    targets: &[Target],
    rotary: &Rotary<'_>,
    reach: f64,
    slack: f64,
    most: usize,
) -> Eased {
    let mut curve = start.clone();
    let mut measured = Measured::new(&curve, tool, targets);
    let mut over = measured.worst(targets);
    let slack = slack.max(over);
    let mut now = RotaryMotion::new(&curve, rotary, reach);
    let before = now.sum();
    // The path of the least motion among all paths so far that keep the bounds.
    let mut held = (curve.clone(), before);
    let mut trust = TRUST_REGION_MM[usize::from(most < LONG)];
    let (mut steps, mut idle, mut back) = (0, 0, 0);
    let mut kept = Vec::new();
    while back < BACK && trust > NARROW {
        let returning = steps >= most || idle >= IDLE;
        if returning && over <= slack {
            break;
        }
        steps += 1;
        back += usize::from(returning);
        let (mut hessian, mut slope) = now.change(&curve);
        if curve.degree() > 3 {
            second_derivative::add_model(&curve, SECOND_DERIVATIVE_WEIGHT, &mut hessian, &mut slope);
        }
        let aim = Aim::Quadratic { hessian: &hessian, slope: &slope };
        let rows = Row::all(&curve, &measured);
        let values: Vec<f64> = measured.at.iter().map(|d| d.value).collect();
        let model = Model { rows: &rows, values: &values, targets, curve: &curve, trust };
        let Some(step) = best(&model, &aim, &mut kept) else {
            trust *= 0.5;
            continue;
        };
        let next = curve.shifted(&step.shift, 1.0);
        let found = measured.again(&next, tool, targets);
        let oversteps = found.worst(targets);
        if oversteps > if returning { over.max(slack) } else { LOOSE.max(slack) } {
            trust *= 0.5;
            continue;
        }
        let then = RotaryMotion::new(&next, rotary, reach);
        idle = if then.sum() > (1.0 - GAIN) * now.sum() { idle + 1 } else { 0 };
        (curve, measured, now, over) = (next, found, then, oversteps);
        if over <= slack && now.sum() < held.1 {
            held = (curve.clone(), now.sum());
        }
        trust *= if returning || over > 0.7 * LOOSE {
            0.5
        } else if over < 0.3 * LOOSE {
            1.5
        } else {
            1.0
        };
    }
    let (curve, sum) = held;
    let measured = Measured::new(&curve, tool, targets);
    Eased { curve, measured, motion: [before, sum], steps }
}

/// Motion of the rotary axes along a curve.
struct RotaryMotion {
    axes: Vec<AxisAt>,
    /// Derivative of each rotary position by the vector between the points of both curves.
    turns: Vec<[Vector3<f64>; 2]>,
    ways: Vec<f64>,
    reach: f64,
    residual: Vec<f64>,
}

impl RotaryMotion {
    fn new(curve: &DualCurve, rotary: &Rotary<'_>, reach: f64) -> Self {
        let axes: Vec<AxisAt> = (0..=MOTION_STATIONS).map(|i| curve.at(i as f64 / MOTION_STATIONS as f64)).collect();
        let mut at: Vec<[f64; 2]> = Vec::with_capacity(axes.len());
        let mut turns = Vec::with_capacity(axes.len());
        for axis in &axes {
            let found = rotary(&axis.axis);
            let before = at.last().copied();
            at.push(std::array::from_fn(|k| {
                let (value, last) = (found[k].0, before.map_or(found[k].0, |b| b[k]));
                nearest_turn(value, last)
            }));
            turns.push(found.map(|(_, g)| (g - axis.axis * g.dot(&axis.axis)) / axis.length));
        }
        let ways = axes.windows(2).map(|w| (w[1].lower - w[0].lower).norm_squared().sqrt().max(NO_WAY)).collect();
        let mut motion = Self { axes, turns, ways, reach, residual: vec![0.0; 2 * AXIS_ROWS] };
        for row in 0..AXIS_ROWS {
            let weights = motion.weights(row);
            motion.residual[row] = weights.iter().map(|(i, w)| at[*i][0] * w).sum();
            motion.residual[AXIS_ROWS + row] = weights.iter().map(|(i, w)| at[*i][1] * w).sum();
        }
        motion
    }

    fn sum(&self) -> f64 {
        dot(&self.residual, &self.residual)
    }

    /// Stations in a row, with their weights: first the rows of speed, then the rows of acceleration.
    fn weights(&self, row: usize) -> [(usize, f64); 3] {
        if row < MOTION_STATIONS {
            let w = 1.0 / self.ways[row].sqrt();
            return [(row, -w), (row + 1, w), (row, 0.0)];
        }
        let i = row - MOTION_STATIONS + 1;
        let (a, b) = (self.ways[i - 1], self.ways[i]);
        let f = self.reach / (0.5 * (a + b)).sqrt();
        [(i - 1, f / a), (i, -f / a - f / b), (i + 1, f / b)]
    }

    /// The quadratic model of half the motion: its Hessian and its gradient by the shifts. The change of the lengths is
    /// neglected.
    fn change(&self, curve: &DualCurve) -> (Band, Vec<f64>) {
        let last = (self.axes.len() - 1) as f64;
        let bases: Vec<_> = (0..self.axes.len()).map(|i| curve.weights(i as f64 / last)).collect();
        // Stations of a row lie in neighbouring spans; on a curve with many short spans they lie further apart.
        let spread = bases.windows(3).map(|w| w[2].0 - w[0].0).max().unwrap_or(0);
        let (mut hessian, mut slope) =
            (Band::new(curve.unknowns(), curve.entries() + 6 * spread - 1), vec![0.0; curve.unknowns()]);
        let mut entries = vec![0.0; curve.entries() + 6 * spread];
        for k in 0..2 {
            for row in 0..AXIS_ROWS {
                let weights = self.weights(row);
                let first = 6 * bases[weights[0].0.min(weights[2].0)].0;
                entries.fill(0.0);
                for (i, weight) in weights {
                    let (control, basis) = bases[i];
                    for (j, b) in basis.iter().enumerate().take(curve.degree() + 1) {
                        for x in 0..3 {
                            let value = self.turns[i][k][x] * b * weight;
                            let at = 6 * (control + j) - first + x;
                            entries[at] -= value;
                            entries[at + 3] += value;
                        }
                    }
                }
                let used = entries.len().min(slope.len() - first);
                hessian.add_square(first, &entries[..used], 1.0);
                for (to, a) in slope[first..first + used].iter_mut().zip(&entries) {
                    *to += a * self.residual[k * AXIS_ROWS + row];
                }
            }
        }
        (hessian, slope)
    }
}
