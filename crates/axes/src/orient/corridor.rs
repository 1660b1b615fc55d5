//! Smooth rotary angles inside a corridor of elliptic cones.
//!
//! The unknowns are the angles of both rotary axes at stations at equal distances along the path. First, second and
//! third differences are minimised, together with the largest turn of each axis per mm, which limits the feed. The axis
//! at each station stays in its cone. A polygon in the ellipse represents the cone, and the map from the rotary axes to
//! the plane of the ellipse is linearised. The convex problem is solved and the map is linearised again at its
//! solution, until the solution no longer changes. Last, each axis is compared with its true ellipse.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, SupportedConeT};
use nalgebra::{Matrix2, Vector2, Vector3};
use nurbs::EllipticCone;
use std::f64::consts::TAU;

/// Sides of the polygon in an ellipse: its area is 95 % of the ellipse.
const SIDES: usize = 12;

/// Largest number of linearisations.
const MAX_LINEARISATIONS: i32 = 14;

/// Largest change of an angle in the first round, radians; the map is nearly linear over this change.
const TRUST_REGION: f64 = 0.2;

/// Factor of the largest change from one round to the next.
const SHORTER: f64 = 0.65;

/// Scale of the polygon in the ellipse.
const POLYGON_SCALE: f64 = 0.98;

/// Change of all angles below which the iteration stops, radians.
const SETTLED: f64 = 1e-5;

/// Cost of an axis out of its cone, as a multiple of the weight of third differences: it exceeds all others.
const OUTSIDE: f64 = 60.0;

/// Weights of the minimised terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// First differences: the membrane of (22) along the path.
    pub first: f64,
    /// Second differences: the thin plate of (22).
    pub second: f64,
    /// Third differences, which cause jerk.
    pub third: f64,
    /// Squares of the largest turns of each rotary axis per mm.
    pub peak: f64,
    /// Least angle of axis 1 to both sides of zero, radians, where the pole is at zero: nearer to it axis 2 turns fast. Zero where
    /// the pole is elsewhere.
    pub least_tilt: f64,
}

/// A corridor: cones at stations at equal distances.
#[derive(Clone, Debug)]
pub struct Corridor {
    /// Clear axes of each station.
    pub cones: Vec<EllipticCone>,
    /// Length of the path between neighbouring stations, mm.
    pub spacing: f64,
    /// Length that weighs differences of higher order against those of lower, mm.
    pub length: f64,
}

/// Why no smooth angles were found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Station.
    pub station: usize,
    /// Level of the last axis in its cone: 1 is on the ellipse, more is outside.
    pub level: f64,
    /// Largest change of an angle in the last round, radians.
    pub change: f64,
    /// True when the convex problem had no solution.
    pub infeasible: bool,
}

impl Corridor {
    /// Rotary angles of each station, starting from angles in or near the corridor; neighbours must be on one winding.
    /// `tool_axis` maps angles to the tool axis.
    ///
    /// # Errors
    /// The iteration ends with an axis outside of its cone: the last residuals.
    pub fn smooth(
        &self,
        start: &[[f64; 2]],
        weights: &Weights,
        tool_axis: &dyn Fn([f64; 2]) -> Vector3<f64>,
    ) -> Result<Vec<[f64; 2]>, Residual> {
        let mut run = start.to_vec();
        let mut change = f64::INFINITY;
        let mut round: i32 = 0;
        while round < MAX_LINEARISATIONS && change > SETTLED {
            round += 1;
            // Smaller steps each round: the error of the linearised map is quadratic in the step.
            let trust = TRUST_REGION * SHORTER.powi(round - 1);
            let Some(next) = self.solve(&run, weights, trust, tool_axis) else {
                let (station, level) = self.worst(&run, tool_axis);
                // What the solver found in the round before may do.
                return if round > 1 && level <= 1.0 {
                    Ok(run)
                } else {
                    Err(Residual { station, level, change, infeasible: true })
                };
            };
            change =
                next.iter().zip(&run).map(|(p, q)| (p[0] - q[0]).abs().max((p[1] - q[1]).abs())).fold(0.0, f64::max);
            run = next;
        }
        let (station, level) = self.worst(&run, tool_axis);
        // The polygon lies inside of the ellipse by more than the error of a settled round.
        if level <= 1.0 { Ok(run) } else { Err(Residual { station, level, change, infeasible: false }) }
    }

    /// The station with the highest level in its cone, and that level.
    pub fn worst(&self, run: &[[f64; 2]], tool_axis: &dyn Fn([f64; 2]) -> Vector3<f64>) -> (usize, f64) {
        let levels = self.cones.iter().zip(run).map(|(cone, q)| cone.level(&tool_axis(*q)));
        levels.enumerate().fold((0, 0.0), |worst, x| if x.1 > worst.1 { x } else { worst })
    }

    fn solve(
        &self,
        run: &[[f64; 2]],
        weights: &Weights,
        trust: f64,
        tool_axis: &dyn Fn([f64; 2]) -> Vector3<f64>,
    ) -> Option<Vec<[f64; 2]>> {
        let n = self.cones.len();
        if n < 4 || run.len() != n {
            return None;
        }
        // Unknowns: axis 1 of all stations, axis 2 of all stations, the largest turn of each, and the distance out of
        // the cones.
        let count = 2 * n + 3;
        let mut square = Triplets::default();
        let (h, length) = (self.spacing, self.length);
        let third = weights.third * length.powi(4) / h.powi(5);
        let orders: [(&[f64], f64); 3] = [
            (&[-1.0, 1.0], weights.first / h),
            (&[1.0, -2.0, 1.0], weights.second * length.powi(2) / h.powi(3)),
            (&[-1.0, 3.0, -3.0, 1.0], third),
        ];
        for axis in 0..2 {
            for (stencil, weight) in orders {
                for first in 0..=n - stencil.len() {
                    for (i, p) in stencil.iter().enumerate() {
                        for (j, q) in stencil.iter().enumerate().skip(i) {
                            square.add(axis * n + first + i, axis * n + first + j, 2.0 * weight * p * q);
                        }
                    }
                }
            }
            square.add(2 * n + axis, 2 * n + axis, 2.0 * weights.peak * h * n as f64);
        }
        let mut rows = CorridorRows::default();
        for (k, (cone, angles)) in self.cones.iter().zip(run).enumerate() {
            self.in_cone(&mut rows, k, cone, *angles, tool_axis)?;
            for (axis, value) in angles.iter().enumerate() {
                rows.at_most(&[(axis * n + k, 1.0)], value + trust);
                rows.at_most(&[(axis * n + k, -1.0)], trust - value);
            }
            // Always feasible: angles that start nearer to zero than the least tilt may only go away from it.
            if weights.least_tilt > 0.0 {
                rows.at_most(&[(k, -angles[0].signum())], -weights.least_tilt.min(angles[0].abs()));
            }
            if k + 1 < n {
                for axis in 0..2 {
                    let (p, q) = (axis * n + k, axis * n + k + 1);
                    rows.at_most(&[(q, 1.0), (p, -1.0), (2 * n + axis, -h)], 0.0);
                    rows.at_most(&[(p, 1.0), (q, -1.0), (2 * n + axis, -h)], 0.0);
                }
            }
        }
        // An axis may leave its cone only where it must.
        let out = 2 * n + 2;
        rows.at_most(&[(out, -1.0)], 0.0);
        let mut linear = vec![0.0; count];
        linear[out] = OUTSIDE * third;
        let solution = solve_quadratic(&square, &linear, &rows, count)?;
        Some((0..n).map(|k| [solution[k], solution[n + k]]).collect())
    }

    /// Rows that keep the axis of a station inside of its cone.
    fn in_cone(
        &self,
        rows: &mut CorridorRows,
        k: usize,
        cone: &EllipticCone,
        [first, second]: [f64; 2],
        tool_axis: &dyn Fn([f64; 2]) -> Vector3<f64>,
    ) -> Option<()> {
        let n = self.cones.len();
        let here = cone.project(&tool_axis([first, second]))?;
        // Central differences: the map is smooth, and the step 1e-5 gives ten digits.
        let step = 1e-5;
        let by = |d1: f64, d2: f64| {
            let [p, q] = [1.0, -1.0].map(|s| cone.project(&tool_axis([first + s * d1, second + s * d2])));
            Some((p? - q?) / (2.0 * step))
        };
        let jacobian = Matrix2::from_columns(&[by(step, 0.0)?, by(0.0, step)?]);
        let to_circle = cone.to_circle();
        let (turned, offset) = (to_circle * jacobian, to_circle * (here - cone.centre));
        let inner = POLYGON_SCALE * libm::cos(TAU / (2.0 * SIDES as f64));
        for side in 0..SIDES {
            let (sin, cos) = libm::sincos(TAU * side as f64 / SIDES as f64);
            let out = Vector2::new(cos, sin);
            let slope = turned.transpose() * out;
            let bound = inner - out.dot(&offset) + slope.x * first + slope.y * second;
            rows.at_most(&[(k, slope.x), (n + k, slope.y), (2 * n + 2, -1.0)], bound);
        }
        Some(())
    }
}

/// Entries of a sparse matrix.
#[derive(Default)]
struct Triplets {
    rows: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

impl Triplets {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        self.rows.push(row);
        self.columns.push(column);
        self.values.push(value);
    }

    fn matrix(&self, rows: usize, columns: usize) -> CscMatrix<f64> {
        CscMatrix::new_from_triplets(rows, columns, self.rows.clone(), self.columns.clone(), self.values.clone())
    }
}

/// Linear constraints.
#[derive(Default)]
struct CorridorRows {
    matrix: Triplets,
    bounds: Vec<f64>,
}

impl CorridorRows {
    /// Sum of factors times unknowns is at most a bound.
    fn at_most(&mut self, terms: &[(usize, f64)], bound: f64) {
        for (column, factor) in terms {
            self.matrix.add(self.bounds.len(), *column, *factor);
        }
        self.bounds.push(bound);
    }
}

/// Minimum of x P x / 2 + q x under the constraints; P is given by its upper half. `None` when the solver finds no
/// solution.
fn solve_quadratic(square: &Triplets, linear: &[f64], rows: &CorridorRows, count: usize) -> Option<Vec<f64>> {
    let p = square.matrix(count, count);
    let a = rows.matrix.matrix(rows.bounds.len(), count);
    let cones: [SupportedConeT<f64>; 1] = [NonnegativeConeT(rows.bounds.len())];
    let settings = DefaultSettings { verbose: false, max_iter: 100, ..DefaultSettings::default() };
    let mut solver = DefaultSolver::new(&p, linear, &a, &rows.bounds, &cones, settings).ok()?;
    solver.solve();
    let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    solved.then(|| solver.solution.x.clone())
}
