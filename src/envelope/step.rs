//! One step of an optimisation: the best shifts of the control points by the linear model of the deviations, within a
//! trust region, as a linear or quadratic program.
//!
//! Of some thousand bounds few are in the way. A program is solved with those that are worst off, then with those that
//! its solution breaks as well, until none is broken.

use super::target::{Measured, Row, Target};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use nalgebra::{DMatrix, DVector};

/// The linear model about a curve.
pub(super) struct Model<'a> {
    /// Change of each deviation.
    pub(super) rows: &'a [Row],
    /// Deviations where nothing is shifted.
    pub(super) values: &'a [f64],
    /// What they may be.
    pub(super) targets: &'a [Target],
    /// Control points of one curve.
    pub(super) control: usize,
    /// Largest shift of a coordinate, mm.
    pub(super) trust: f64,
}

/// What a step makes least.
pub(super) enum Aim<'a> {
    /// The widening of the bounds; its present size, mm.
    Widening(f64),
    /// Half of shift H shift plus slope shift, the bounds as they are.
    Quadratic { hessian: &'a DMatrix<f64>, slope: &'a DVector<f64> },
}

/// A step.
pub(super) struct Step {
    /// Shifts, mm: three numbers for each control point of the lower curve, then of the upper one.
    pub(super) shift: Vec<f64>,
    /// Widening that the model promises, mm.
    pub(super) widening: f64,
}

/// A bound of one target: `sign` times its change may be at most `room` plus `give` times the widening.
#[derive(Clone, Copy)]
struct Side {
    target: usize,
    sign: f64,
    room: f64,
    give: f64,
}

/// Programs at most for one step.
const ROUNDS: usize = 12;

/// Bounds to begin with, and bounds that join in a round.
const JOIN: usize = 100;

/// Distance of bounds that join together, mm.
const APART: f64 = 1.5;

/// By how much a solution may break a bound that was left out, mm.
const BROKEN: f64 = 1e-5;

/// A bound as near as this is in the way, mm.
const NEAR: f64 = 2e-4;

/// Weight of the shifts themselves beside the aim: the curve may slide along itself, which changes no deviation.
const IDLE: f64 = 1e-4;

/// The best shifts. `None` when a program has no solution. `kept` are the numbers of the targets whose bounds were in
/// the way in the step before; it is brought up to date.
pub(super) fn best(model: &Model<'_>, aim: &Aim<'_>, kept: &mut Vec<usize>) -> Option<Step> {
    let unit = match aim {
        Aim::Widening(now) => now.max(1e-6),
        Aim::Quadratic { .. } => model.trust,
    };
    let mut open = Vec::new();
    for (i, (target, row)) in model.targets.iter().zip(model.rows).enumerate() {
        let reach = row.reach() * model.trust;
        let value = model.values[i];
        let below = Side { target: i, sign: -1.0, room: value - target.low, give: target.give[0] };
        let above = Side { target: i, sign: 1.0, room: target.high - value, give: target.give[1] };
        open.extend([below, above].into_iter().filter(|side| side.room <= reach));
    }
    kept.sort_unstable();
    let was_kept = |side: &Side| kept.binary_search(&side.target).is_ok();
    // Those that were in the way, then those with the least room.
    open.sort_by(|a, b| was_kept(b).cmp(&was_kept(a)).then(a.room.total_cmp(&b.room)));
    let first = open.iter().take_while(|s| was_kept(s)).count().max(JOIN).min(open.len());
    let mut active: Vec<Side> = open.drain(..first).collect();
    for _ in 0..ROUNDS {
        let step = solve(model, aim, &active, unit)?;
        let over = |side: &Side| {
            side.sign * model.rows[side.target].times(&step.shift) - side.room - side.give * step.widening
        };
        let mut broken: Vec<(f64, usize)> =
            open.iter().enumerate().map(|(i, s)| (over(s), i)).filter(|x| x.0 > BROKEN).collect();
        if broken.is_empty() {
            *kept = active.iter().filter(|s| over(s) > -NEAR).map(|s| s.target).collect();
            return Some(step);
        }
        broken.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        // The worst of each neighbourhood: its neighbours mostly follow.
        let mut joining: Vec<usize> = Vec::new();
        for (_, i) in broken {
            let at = model.targets[open[i].target].point;
            let apart = |j: &usize| (model.targets[open[*j].target].point - at).norm_squared() > APART * APART;
            if joining.len() < JOIN && joining.iter().all(apart) {
                joining.push(i);
            }
        }
        joining.sort_unstable();
        for i in joining.into_iter().rev() {
            active.push(open.swap_remove(i));
        }
    }
    // A step that breaks a bound is found out when the curve is measured.
    solve(model, aim, &active, unit)
}

/// Entries of a sparse matrix.
#[derive(Default)]
struct Entries {
    rows: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

impl Model<'_> {
    /// The model whose deviations are those that a shift really has, so that the bend of the deviations counts from
    /// there on (second-order correction).
    pub(super) fn corrected(&self, shift: &[f64], found: &Measured) -> Vec<f64> {
        found.at.iter().zip(self.rows).map(|(d, row)| d.value - row.times(shift)).collect()
    }
}

impl Entries {
    fn put(&mut self, row: usize, column: usize, value: f64) {
        self.rows.push(row);
        self.columns.push(column);
        self.values.push(value);
    }

    fn matrix(self, rows: usize, columns: usize) -> CscMatrix<f64> {
        CscMatrix::new_from_triplets(rows, columns, self.rows, self.columns, self.values)
    }
}

/// Unknowns are the shifts as shares of the trust region and, for a widening, that as a share of `unit`.
fn solve(model: &Model<'_>, aim: &Aim<'_>, active: &[Side], unit: f64) -> Option<Step> {
    let control = model.control;
    let n = 6 * control;
    let widens = matches!(aim, Aim::Widening(_));
    let unknowns = n + usize::from(widens);
    let (mut a, mut right) = (Entries::default(), Vec::new());
    for side in active {
        for (i, change) in model.rows[side.target].entries(control) {
            a.put(right.len(), i, side.sign * change * model.trust / unit);
        }
        if widens {
            a.put(right.len(), n, -side.give);
        }
        right.push(side.room / unit);
    }
    for i in 0..n {
        for sign in [1.0, -1.0] {
            a.put(right.len(), i, sign);
            right.push(1.0);
        }
    }
    let (mut p, mut q) = (Entries::default(), vec![0.0; unknowns]);
    match aim {
        Aim::Widening(_) => {
            a.put(right.len(), n, -1.0);
            right.push(0.0);
            (0..n).for_each(|i| p.put(i, i, IDLE));
            q[n] = 1.0;
        }
        Aim::Quadratic { hessian, slope } => {
            // In shares of the trust region, and of the largest curvature.
            let scale = hessian.diagonal().max();
            for j in 0..n {
                for i in 0..=j {
                    let idle = if i == j { IDLE * 1e-2 } else { 0.0 };
                    p.put(i, j, hessian[(i, j)] / scale + idle);
                }
                q[j] = slope[j] / (scale * model.trust);
            }
        }
    }
    let count = right.len();
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .max_iter(60)
        .tol_gap_rel(1e-4)
        .tol_gap_abs(1e-5)
        .tol_feas(1e-7)
        .iterative_refinement_max_iter(2)
        .build()
        .ok()?;
    let (p, a) = (p.matrix(unknowns, unknowns), a.matrix(count, unknowns));
    let mut solver = DefaultSolver::new(&p, &q, &a, &right, &[NonnegativeConeT(count)], settings).ok()?;
    solver.solve();
    if !matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved) {
        return None;
    }
    let x = &solver.solution.x;
    let widening = if widens { (x[n] * unit).max(0.0) } else { 0.0 };
    Some(Step { shift: x[..n].iter().map(|x| x * model.trust).collect(), widening })
}
