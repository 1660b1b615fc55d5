//! Cholesky factors of matrices that are zero far from their diagonal.
//!
//! The factor of a row begins at the first column in which the row has an entry (George and Liu, Computer Solution of Large Sparse
//! Positive Definite Systems, chapter 4: the envelope of a matrix). Nothing is computed to the left of it. All other operations are
//! those of the dense method in its order, so that the factors are the same to the last bit.

use nalgebra::{Cholesky, DMatrix, Dyn};

/// Factors a symmetric matrix, of which the lower triangle is read. `None` where it is not positive definite.
pub(super) fn factor(mut matrix: DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    let count = matrix.nrows();
    let first: Vec<usize> = (0..count).map(|i| (0..i).find(|j| matrix[(i, *j)] != 0.0).unwrap_or(i)).collect();
    // Rows that reach a column, in ascending order.
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (i, from) in first.iter().enumerate() {
        below[*from..i].iter_mut().for_each(|rows| rows.push(i));
    }
    for j in 0..count {
        for k in first[j]..j {
            let share = matrix[(j, k)];
            matrix[(j, j)] -= share * share;
            for i in below[j].iter().filter(|i| first[**i] <= k) {
                let from = matrix[(*i, k)];
                matrix[(*i, j)] -= share * from;
            }
        }
        let diagonal = matrix[(j, j)];
        if diagonal.is_nan() || diagonal <= 0.0 {
            return None;
        }
        let root = diagonal.sqrt();
        matrix[(j, j)] = root;
        below[j].iter().for_each(|i| matrix[(*i, j)] /= root);
    }
    Some(Cholesky::pack_dirty(matrix))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix with a band, and with corners as those of closed splines.
    fn matrix(count: usize, band: usize, closed: bool) -> DMatrix<f64> {
        let mut seed = 1_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut half = DMatrix::<f64>::zeros(count, count);
        for i in 0..count {
            for k in 0..=band {
                let j = i + k;
                if j < count || closed {
                    half[(i, j % count)] += next();
                }
            }
        }
        let mut matrix = half.transpose() * &half;
        for i in 0..count {
            matrix[(i, i)] += 1e-3;
        }
        matrix
    }

    #[test]
    fn factors_are_those_of_the_dense_method_to_the_last_bit() {
        for (count, band, closed) in
            [(1, 0, false), (5, 3, true), (12, 3, false), (40, 3, true), (97, 3, false), (120, 5, true)]
        {
            let matrix = matrix(count, band, closed);
            let due = matrix.clone().cholesky().expect("positive definite");
            let found = factor(matrix).expect("positive definite");
            assert_eq!(found.l(), due.l(), "{count} {band} {closed}");
            let right = DMatrix::from_fn(count, 3, |i, k| (i * 3 + k) as f64 * 0.37 - 1.0);
            assert_eq!(found.solve(&right), due.solve(&right), "{count} {band} {closed}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_none() {
        let mut matrix = matrix(12, 3, true);
        matrix[(7, 7)] = -1.0;
        assert!(factor(matrix).is_none());
        assert!(factor(DMatrix::zeros(3, 3)).is_none());
        assert!(factor(DMatrix::from_element(2, 2, f64::NAN)).is_none());
    }
}
