//! Control points of splines by least squares: the smallest sum of squared distances of points to the spline at their parameters
//! (Piegl and Tiller, The NURBS Book, 9.4.1).
//!
//! A control point has a term in common only with its neighbours, so that the normal equations are a band, with corners where the
//! spline is closed.

use super::basis;
use super::bezier::MAX_BEZIER_DEGREE;
use super::envelope_cholesky;
use nalgebra::{DMatrix, SVector};

/// What is known of a spline before its control points are.
pub(super) struct SoughtSpline<'k, const N: usize> {
    /// Knots; those of a closed spline go on beyond both ends of its domain.
    pub(super) knots: &'k [f64],
    /// Degree, at most five.
    pub(super) degree: usize,
    /// Whether its last control points are the first ones again, as many as the degree.
    pub(super) closed: bool,
    /// First and last control point, where they are given.
    pub(super) ends: Option<[SVector<f64, N>; 2]>,
    /// Weight of the squared second differences of control points over their places (Greville), against the squared distances of
    /// points: the spline goes on smoothly where there are no points (penalised splines; Eilers and Marx 1996).
    pub(super) smoothing: f64,
}

/// Normal equations of the control points that are not given; of the symmetric matrix the lower triangle counts.
struct NormalEquations {
    matrix: DMatrix<f64>,
    right: DMatrix<f64>,
}

impl<const N: usize> SoughtSpline<'_, N> {
    /// Number of different control points.
    fn count(&self) -> usize {
        let all = self.knots.len() - self.degree - 1;
        if self.closed { all - self.degree } else { all }
    }

    /// Number of control points that are sought.
    fn unknowns(&self) -> usize {
        self.count() - self.ends.map_or(0, |ends| ends.len())
    }

    /// Control point j where it is given.
    fn given(&self, j: usize) -> Option<SVector<f64, N>> {
        let [first, last] = self.ends?;
        if j == 0 { Some(first) } else { (j + 1 == self.count()).then_some(last) }
    }

    /// Row of control point j in the equations; `None` where it is given.
    fn row(&self, j: usize) -> Option<usize> {
        if self.ends.is_some() { j.checked_sub(1).filter(|row| *row < self.unknowns()) } else { Some(j) }
    }

    /// The different control points of the spline nearest to points at parameters. `None` where the points do not determine it.
    pub(super) fn nearest_to(
        &self,
        points: impl Iterator<Item = SVector<f64, N>>,
        parameters: impl Iterator<Item = f64>,
    ) -> Option<Vec<SVector<f64, N>>> {
        let unknowns = self.unknowns();
        let mut equations =
            NormalEquations { matrix: DMatrix::zeros(unknowns, unknowns), right: DMatrix::zeros(unknowns, N) };
        for (point, u) in points.zip(parameters) {
            self.add_point(&mut equations, point, u);
        }
        if self.smoothing > 0.0 {
            self.add_smoothing(&mut equations);
        }
        let solved = envelope_cholesky::factor(equations.matrix)?.solve(&equations.right);
        let control = (0..self.count()).map(|j| match self.row(j) {
            Some(row) => SVector::from_fn(|k, _| solved[(row, k)]),
            None => self.given(j).unwrap_or_else(SVector::zeros),
        });
        let control: Vec<SVector<f64, N>> = control.collect();
        control.iter().all(|c| c.iter().all(|x| x.is_finite())).then_some(control)
    }

    fn add_point(&self, equations: &mut NormalEquations, point: SVector<f64, N>, u: f64) {
        let basis = basis::of_degree::<{ MAX_BEZIER_DEGREE + 1 }>(self.knots, self.degree, u, 0);
        let mut rest = point;
        // Rows of the control points with a weight at the point, where they are sought.
        let mut rows = [None; MAX_BEZIER_DEGREE + 1];
        for (k, row) in rows[..=self.degree].iter_mut().enumerate() {
            let j = (basis.first + k) % self.count();
            *row = self.row(j);
            if let Some(given) = self.given(j) {
                rest -= given * basis.values[0][k];
            }
        }
        let entries = || rows.iter().zip(&basis.values[0]).filter_map(|(row, w)| Some(((*row)?, *w)));
        for (row, w) in entries() {
            for k in 0..N {
                equations.right[(row, k)] += w * rest[k];
            }
            for (column, v) in entries().filter(|(column, _)| *column <= row) {
                equations.matrix[(row, column)] += w * v;
            }
        }
    }

    fn add_smoothing(&self, equations: &mut NormalEquations) {
        let count = self.count();
        let place = |i: usize| self.knots[i + 1..=i + self.degree].iter().sum::<f64>() / self.degree as f64;
        for i in 0..if self.closed { count } else { count - 2 } {
            let [a, b, c] = [0, 1, 2].map(|k| place(i + k));
            // Zero for control points on a straight line.
            let weights = [(c - b) / (c - a), -1.0, (b - a) / (c - a)];
            let entries = [0, 1, 2].map(|k| ((i + k) % count, weights[k]));
            for (row, w) in entries.into_iter().filter_map(|(j, w)| Some((self.row(j)?, w))) {
                for (l, v) in entries {
                    match self.row(l) {
                        Some(column) => equations.matrix[(row, column)] += self.smoothing * w * v,
                        None => {
                            let given = self.given(l).unwrap_or_else(SVector::zeros);
                            (0..N).for_each(|k| equations.right[(row, k)] -= self.smoothing * w * v * given[k]);
                        }
                    }
                }
            }
        }
    }
}
