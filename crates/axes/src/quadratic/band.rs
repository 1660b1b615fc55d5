//! Symmetric banded matrices and their Cholesky factors.
//!
//! A control point of a spline has a term in common only with its neighbours. With the unknowns in their order along
//! the path, the work therefore grows with their number, and not with its cube.

/// A symmetric matrix: for each row of the lower triangle the diagonal entry and `width` entries before it.
#[derive(Clone, Debug)]
pub(crate) struct Band {
    size: usize,
    width: usize,
    /// Row i starts at i * (width + 1) and ends with its diagonal entry; places before the first column are zero.
    rows: Vec<f64>,
}

/// Sum of products.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Four independent sums.
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

impl Band {
    /// Zero matrix.
    pub(crate) fn new(size: usize, width: usize) -> Self {
        let width = width.min(size.saturating_sub(1));
        Self { size, width, rows: vec![0.0; size * (width + 1)] }
    }

    /// Number of rows and columns.
    pub(crate) fn size(&self) -> usize {
        self.size
    }

    /// The same matrix with space for entries farther from the diagonal.
    pub(crate) fn widened(&self, width: usize) -> Self {
        let mut out = Self::new(self.size, width.max(self.width));
        let gap = out.width - self.width;
        for (to, from) in out.rows.chunks_exact_mut(out.width + 1).zip(self.rows.chunks_exact(self.width + 1)) {
            to[gap..].copy_from_slice(from);
        }
        out
    }

    /// Adds `weight` a a', where `entries` are the entries of a from column `first` on.
    pub(crate) fn add_square(&mut self, first: usize, entries: &[f64], weight: f64) {
        let stride = self.width + 1;
        for (i, a) in entries.iter().enumerate() {
            let diagonal = (first + i) * stride + self.width;
            let factor = weight * a;
            for (to, b) in self.rows[diagonal - i..=diagonal].iter_mut().zip(entries) {
                *to += factor * b;
            }
        }
    }

    /// Entry i of the diagonal.
    pub(crate) fn diagonal(&mut self, i: usize) -> &mut f64 {
        let at = i * (self.width + 1) + self.width;
        &mut self.rows[at]
    }

    /// Largest entry of the diagonal.
    pub(crate) fn largest(&self) -> f64 {
        self.rows.chunks_exact(self.width + 1).map(|row| row[self.width]).fold(0.0, f64::max)
    }

    /// Multiplies all entries by a number.
    pub(crate) fn scale(&mut self, by: f64) {
        self.rows.iter_mut().for_each(|x| *x *= by);
    }

    /// Product with a vector.
    pub(crate) fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.size];
        for i in 0..self.size {
            let (from, row) = self.row(i);
            let (before, diagonal) = (&row[..row.len() - 1], row[row.len() - 1]);
            out[i] += dot(before, &x[from..i]) + diagonal * x[i];
            for (to, a) in out[from..i].iter_mut().zip(before) {
                *to += a * x[i];
            }
        }
        out
    }

    /// First column of a row, and the entries of the row up to the diagonal.
    fn row(&self, i: usize) -> (usize, &[f64]) {
        let from = i.saturating_sub(self.width);
        let end = (i + 1) * (self.width + 1);
        (from, &self.rows[end - (i - from) - 1..end])
    }

    /// The lower Cholesky factor; `None` where the matrix is not positive definite.
    pub(crate) fn factor(mut self) -> Option<Factor> {
        let stride = self.width + 1;
        for i in 0..self.size {
            let (done, current) = self.rows.split_at_mut(i * stride);
            let from = i.saturating_sub(self.width);
            // Column j stands at place j + width - i of row i.
            let place = |row: usize, column: usize| column + self.width - row;
            for j in from..i {
                let start = from.max(j.saturating_sub(self.width));
                let above = &done[j * stride..(j + 1) * stride];
                let sum = dot(&current[place(i, start)..place(i, j)], &above[place(j, start)..self.width]);
                current[place(i, j)] = (current[place(i, j)] - sum) * above[self.width];
            }
            let row = &current[place(i, from)..self.width];
            let left = current[self.width] - dot(row, row);
            if left.is_nan() || left <= 0.0 {
                return None;
            }
            // The factor stores the inverse of its diagonal.
            current[self.width] = 1.0 / left.sqrt();
        }
        Some(Factor(self))
    }
}

/// Cholesky factor of a band matrix; it stores the inverse of each diagonal entry.
pub(crate) struct Factor(Band);

impl Factor {
    /// Solution for a right side.
    pub(crate) fn solve(&self, right: &[f64]) -> Vec<f64> {
        let mut x = right.to_vec();
        for i in 0..x.len() {
            let (from, row) = self.0.row(i);
            let (before, inverse) = (&row[..row.len() - 1], row[row.len() - 1]);
            x[i] = (x[i] - dot(before, &x[from..i])) * inverse;
        }
        for i in (0..x.len()).rev() {
            let (from, row) = self.0.row(i);
            let (before, inverse) = (&row[..row.len() - 1], row[row.len() - 1]);
            let value = x[i] * inverse;
            x[i] = value;
            for (to, a) in x[from..i].iter_mut().zip(before) {
                *to -= a * value;
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// A band matrix as a sum of squares of rows of `width + 1` entries, and the same as a full matrix.
    fn sample(size: usize, width: usize) -> (Band, DMatrix<f64>) {
        let (mut band, mut full) = (Band::new(size, width), DMatrix::zeros(size, size));
        for k in 0..3 * size {
            let entries: Vec<f64> =
                (0..=width).map(|i| ((k * (width + 1) + i) as f64 * 12.9898).sin() * 43_758.545_3 % 1.0).collect();
            let first = k % (size - width);
            band.add_square(first, &entries, 0.5 + k as f64);
            for (i, a) in entries.iter().enumerate() {
                for (j, b) in entries.iter().enumerate() {
                    full[(first + i, first + j)] += (0.5 + k as f64) * a * b;
                }
            }
        }
        (band, full)
    }

    #[test]
    fn products_and_solutions_equal_those_of_the_full_matrix() {
        for (size, width) in [(7, 0), (9, 3), (40, 11), (12, 11)] {
            let (band, full) = sample(size, width);
            let x: Vec<f64> = (0..size).map(|i| (i as f64 * 1.3).cos()).collect();
            let right = &full * DVector::from_column_slice(&x);
            for (a, b) in band.times(&x).iter().zip(&right) {
                assert!((a - b).abs() < 1e-9 * right.amax(), "{size} {width}: {a} {b}");
            }
            for band in [band.clone(), band.widened(width + 2)] {
                let found = band.factor().unwrap().solve(right.as_slice());
                for (a, b) in found.iter().zip(&x) {
                    assert!((a - b).abs() < 1e-7, "{size} {width}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_has_no_factor() {
        let (mut band, _) = sample(9, 3);
        *band.diagonal(5) = -1.0;
        assert!(band.factor().is_none());
    }
}
