//! Smooth rotary angles inside a corridor of elliptic cones.
//!
//! The unknowns are the angles of both rotary axes at stations at equal distances along the path. First, second and
//! third differences are minimised, together with the largest turn of each axis per mm, which limits the feed. The axis
//! at each station stays in its cone. A polygon in the ellipse represents the cone, and the map from the rotary axes to
//! the plane of the ellipse is linearised. The convex problem is solved and the map is linearised again at its
//! solution, until the solution no longer changes. Last, each axis is compared with its true ellipse.

use crate::quadratic::{Accuracy, Band, Bound, QuadraticProgram, SharedCost};
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

/// Fewest stations: each has a third difference.
const MIN_STATIONS: usize = 4;

/// Unknowns that a bound joins: an axis at two neighbouring stations, with the other axis between.
const ENTRIES: usize = 3;

/// Accuracy of a program: its terms differ by eight orders, from third differences to the pull to the middle.
const ACCURACY: Accuracy = Accuracy { gap: [1e-10, 1e-10], slope: 1e-9, at_rest: 1e4 };

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
    /// Squares of the distance of the axis from the middle of its cone, as a tangent: of runs that turn equally, which a shift of all
    /// angles changes into each other, the one in the middle is best.
    pub middle: f64,
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

    /// The best angles by the map linearised at `run`, each at most `trust` from there. The unknowns are the changes as
    /// shares of `trust`, both axes of a station side by side: then all terms join near unknowns.
    fn solve(
        &self,
        run: &[[f64; 2]],
        weights: &Weights,
        trust: f64,
        tool_axis: &dyn Fn([f64; 2]) -> Vector3<f64>,
    ) -> Option<Vec<[f64; 2]>> {
        let n = self.cones.len();
        if n < MIN_STATIONS || run.len() != n {
            return None;
        }
        let at = run.as_flattened();
        let mut square = self.differences(weights);
        let mut slope = square.times(at);
        let mut bounds = turns(at, trust);
        let middle = 2.0 * weights.middle * self.spacing / self.length.powi(2);
        for (k, (cone, angles)) in self.cones.iter().zip(run).enumerate() {
            let place = Linearised::new(cone, *angles, tool_axis)?;
            for (row, off) in [0, 1].map(|i| (place.jacobian.row(i), place.off[i])) {
                square.add_square(2 * k, &[row[0], row[1]], middle);
                (0..2).for_each(|axis| slope[2 * k + axis] += middle * row[axis] * off);
            }
            bounds.extend(
                place.sides(cone, trust).map(|(a, limit)| Bound { limit: limit / trust, ..at_station(k, n, a, 0) }),
            );
            // Always feasible: angles that start nearer to zero than the least tilt may only go away from it.
            let room = angles[0].abs() - weights.least_tilt.min(angles[0].abs());
            if weights.least_tilt > 0.0 && room < trust {
                let away = [-angles[0].signum(), 0.0];
                bounds.push(Bound { limit: room / trust, give: 0.0, ..at_station(k, n, away, 0) });
            }
        }
        let unit = square.largest();
        square.scale(1.0 / unit);
        slope.iter_mut().for_each(|x| *x /= unit * trust);
        // An axis may leave its cone only where it must. Distances out of the cones and turns are shares of `trust` as well.
        let out = SharedCost { linear: OUTSIDE * self.third(weights) / (unit * trust), quadratic: 0.0 };
        let peak = SharedCost { linear: 0.0, quadratic: 2.0 * weights.peak * n as f64 / (self.spacing * unit) };
        let program = QuadraticProgram {
            bounds: &bounds,
            entries: ENTRIES,
            quadratic: &square,
            linear: &slope,
            shared: &[out, peak, peak],
            accuracy: ACCURACY,
        };
        let (change, _) = program.solve()?;
        Some((0..n).map(|k| [0, 1].map(|axis| run[k][axis] + trust * change[2 * k + axis])).collect())
    }

    /// Weight of third differences.
    fn third(&self, weights: &Weights) -> f64 {
        weights.third * self.length.powi(4) / self.spacing.powi(5)
    }

    /// Twice the matrix of the squares of first, second and third differences.
    fn differences(&self, weights: &Weights) -> Band {
        let n = self.cones.len();
        let (h, length) = (self.spacing, self.length);
        // Both axes of a station are side by side.
        let orders: [(&[f64], f64); 3] = [
            (&[-1.0, 0.0, 1.0], weights.first / h),
            (&[1.0, 0.0, -2.0, 0.0, 1.0], weights.second * length.powi(2) / h.powi(3)),
            (&[-1.0, 0.0, 3.0, 0.0, -3.0, 0.0, 1.0], self.third(weights)),
        ];
        let mut square = Band::new(2 * n, 6);
        for (stencil, weight) in orders {
            for first in 0..=2 * n - stencil.len() {
                square.add_square(first, stencil, 2.0 * weight);
            }
        }
        square
    }
}

/// Bounds of the turn of each axis between neighbouring stations by the largest turn, as shares of `trust`.
fn turns(at: &[f64], trust: f64) -> Vec<Bound<ENTRIES>> {
    let both = |i: usize| {
        let turn = (at[i + 2] - at[i]) / trust;
        [1.0, -1.0].map(|sign| Bound {
            first: i,
            a: [-sign, 0.0, sign],
            limit: -sign * turn,
            give: 1.0,
            shared: 1 + i % 2,
        })
    };
    (0..at.len() - 2).flat_map(both).collect()
}

/// A bound with two factors at the axes of a station, which gives way.
fn at_station(k: usize, stations: usize, [a, b]: [f64; 2], shared: usize) -> Bound<ENTRIES> {
    // Behind the last station there is no third unknown.
    let (first, a) = if k + 1 < stations { (2 * k, [a, b, 0.0]) } else { (2 * k - 1, [0.0, a, b]) };
    Bound { first, a, limit: 0.0, give: 1.0, shared }
}

/// The map from the rotary angles at a station to the plane of its ellipse, linearised.
struct Linearised {
    jacobian: Matrix2<f64>,
    /// Place of the tool axis from the middle of the ellipse.
    off: Vector2<f64>,
}

impl Linearised {
    fn new(
        cone: &EllipticCone,
        [first, second]: [f64; 2],
        tool_axis: &dyn Fn([f64; 2]) -> Vector3<f64>,
    ) -> Option<Self> {
        let here = cone.project(&tool_axis([first, second]))?;
        // Central differences: the map is smooth, and the step 1e-5 gives ten digits.
        let step = 1e-5;
        let by = |d1: f64, d2: f64| {
            let [p, q] = [1.0, -1.0].map(|s| cone.project(&tool_axis([first + s * d1, second + s * d2])));
            Some((p? - q?) / (2.0 * step))
        };
        let jacobian = Matrix2::from_columns(&[by(step, 0.0)?, by(0.0, step)?]);
        Some(Self { jacobian, off: here - cone.centre })
    }

    /// Factors and limits of the sides of the polygon that the axis can reach by changes of both angles up to `trust`.
    fn sides(&self, cone: &EllipticCone, trust: f64) -> impl Iterator<Item = ([f64; 2], f64)> {
        let to_circle = cone.to_circle();
        let (turned, offset) = (to_circle * self.jacobian, to_circle * self.off);
        let inner = POLYGON_SCALE * libm::cos(TAU / (2.0 * SIDES as f64));
        (0..SIDES).filter_map(move |side| {
            let (sin, cos) = libm::sincos(TAU * side as f64 / SIDES as f64);
            let out = Vector2::new(cos, sin);
            let slope = turned.transpose() * out;
            let limit = inner - out.dot(&offset);
            (limit < trust * slope.abs().sum()).then_some(([slope.x, slope.y], limit))
        })
    }
}
