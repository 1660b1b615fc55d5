//! Energy of the field of tool axes over the contact points (Xu 22): the energy of a membrane, from first derivatives,
//! and that of a thin plate, from second derivatives.

use nalgebra::Vector3;

/// Weights of both energies in the sum (22), each in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy {
    /// Weight of the membrane.
    pub membrane: f64,
    /// Weight of the thin plate.
    pub thin_plate: f64,
}

impl Energy {
    /// The energies of a field, membrane and thin plate: `rows` of equal length with values at places that lie
    /// `spacing` apart along a row and across rows, mm. Derivatives are differences of neighbours; integrals are sums
    /// over the places where they exist.
    pub fn parts(rows: &[Vec<Vector3<f64>>], spacing: [f64; 2]) -> [f64; 2] {
        let [hu, hv] = spacing;
        let columns = rows.iter().map(Vec::len).min().unwrap_or(0);
        let at = |i: usize, j: usize| &rows[i][j];
        let (mut membrane, mut plate) = (0.0, 0.0);
        for i in 0..rows.len() {
            for j in 0..columns {
                if j + 1 < columns {
                    membrane += ((at(i, j + 1) - at(i, j)) / hu).norm_squared();
                }
                if i + 1 < rows.len() {
                    membrane += ((at(i + 1, j) - at(i, j)) / hv).norm_squared();
                }
                if j + 2 < columns {
                    plate += ((at(i, j + 2) - at(i, j + 1) * 2.0 + at(i, j)) / (hu * hu)).norm_squared();
                }
                if i + 2 < rows.len() {
                    plate += ((at(i + 2, j) - at(i + 1, j) * 2.0 + at(i, j)) / (hv * hv)).norm_squared();
                }
                if j + 1 < columns && i + 1 < rows.len() {
                    let mixed = at(i + 1, j + 1) - at(i + 1, j) - at(i, j + 1) + at(i, j);
                    plate += 2.0 * (mixed / (hu * hv)).norm_squared();
                }
            }
        }
        let cell = 0.5 * hu * hv;
        [membrane * cell, plate * cell]
    }

    /// The weighed sum (22) of a field.
    pub fn of(&self, rows: &[Vec<Vector3<f64>>], spacing: [f64; 2]) -> f64 {
        let [membrane, plate] = Self::parts(rows, spacing);
        self.membrane * membrane + self.thin_plate * plate
    }

    /// Increase of the sum (22) when `value` is appended to the row `before`, in places `spacing` apart. The greedy
    /// choice takes the axis with the least increase.
    pub fn next(&self, before: &[Vector3<f64>], value: &Vector3<f64>, spacing: f64) -> f64 {
        let [.., last] = before else { return 0.0 };
        let first = ((value - last) / spacing).norm_squared();
        let second = match before {
            [.., p, q] => ((value - q * 2.0 + p) / (spacing * spacing)).norm_squared(),
            _ => 0.0,
        };
        0.5 * spacing * (self.membrane * first + self.thin_plate * second)
    }
}
