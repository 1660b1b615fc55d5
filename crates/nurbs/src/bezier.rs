//! Polynomial curves of any degree up to five by their Bezier control points.

use nalgebra::SVector;

/// Largest degree.
pub const MAX_BEZIER_DEGREE: usize = 5;

/// Value at a parameter in [0, 1] (de Casteljau).
pub fn value<const N: usize>(control: &[SVector<f64, N>], t: f64) -> SVector<f64, N> {
    blossom(control, |_| t)
}

/// Value of the symmetric multi-affine form of the curve; `at` gives the argument of each of its steps. With equal arguments
/// it is the value of the curve.
fn blossom<const N: usize>(control: &[SVector<f64, N>], at: impl Fn(usize) -> f64) -> SVector<f64, N> {
    let mut row = [SVector::zeros(); MAX_BEZIER_DEGREE + 1];
    let count = control.len().min(row.len());
    row[..count].copy_from_slice(&control[..count]);
    for step in 1..count {
        let t = at(step - 1);
        for k in 0..count - step {
            row[k] = row[k].lerp(&row[k + 1], t);
        }
    }
    row[0]
}

/// Control points of the part of the curve between two parameters.
pub fn part<const N: usize>(control: &[SVector<f64, N>], [from, to]: [f64; 2]) -> Vec<SVector<f64, N>> {
    let degree = control.len().saturating_sub(1);
    (0..=degree).map(|k| blossom(control, |step| if step < degree - k { from } else { to })).collect()
}

/// Control points of a polynomial by its coefficients, that of the power 0 first.
pub fn of_powers<const N: usize>(coefficients: &[SVector<f64, N>]) -> Vec<SVector<f64, N>> {
    let degree = coefficients.len().saturating_sub(1);
    let point = |j: usize| {
        // C(j, i) / C(n, i), term by term.
        let mut share = 1.0;
        let mut sum = SVector::zeros();
        for (i, a) in coefficients.iter().enumerate().take(j + 1) {
            sum += a * share;
            share *= (j - i) as f64 / (degree - i).max(1) as f64;
        }
        sum
    };
    (0..=degree).map(point).collect()
}

/// Coefficients of the powers of the parameter, that of the power 0 first.
pub fn powers<const N: usize>(control: &[SVector<f64, N>]) -> Vec<SVector<f64, N>> {
    let mut differences = control.to_vec();
    let mut out = Vec::with_capacity(control.len());
    // C(n, i) times the difference of order i at the first point.
    let mut factor = 1.0;
    for i in 0..control.len() {
        out.push(differences[0] * factor);
        differences = differences.windows(2).map(|w| w[1] - w[0]).collect();
        factor *= (control.len() - 1 - i) as f64 / (i + 1) as f64;
    }
    out
}

/// Control points of the same curve with a degree that is not lower.
pub fn elevated<const N: usize>(control: &[SVector<f64, N>], degree: usize) -> Vec<SVector<f64, N>> {
    let mut out = control.to_vec();
    while (2..degree + 1).contains(&out.len()) {
        let n = out.len();
        let between = (1..n).map(|k| out[k].lerp(&out[k - 1], k as f64 / n as f64));
        out = [out[0]].into_iter().chain(between).chain([out[n - 1]]).collect();
    }
    out
}

/// Largest length of a derivative over the whole curve, by its control points: `order` is 1 or 2.
pub fn most_derivative<const N: usize>(control: &[SVector<f64, N>], order: usize) -> f64 {
    let degree = control.len().saturating_sub(1);
    let factor: f64 = (0..order).map(|k| degree.saturating_sub(k) as f64).product();
    let difference = |w: &[SVector<f64, N>]| match order {
        1 => (w[1] - w[0]).norm(),
        _ => (w[0] - w[1] * 2.0 + w[2]).norm(),
    };
    factor * control.windows(order + 1).map(difference).fold(0.0, f64::max)
}

/// First derivative at the start and at the end.
pub fn end_derivatives<const N: usize>(control: &[SVector<f64, N>]) -> [SVector<f64, N>; 2] {
    let n = control.len();
    if n < 2 {
        return [SVector::zeros(); 2];
    }
    let degree = (n - 1) as f64;
    [(control[1] - control[0]) * degree, (control[n - 1] - control[n - 2]) * degree]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;
    use proptest::prelude::*;

    fn control() -> impl Strategy<Value = Vec<Vector2<f64>>> {
        proptest::collection::vec([-9.0..9.0_f64, -9.0..9.0].prop_map(Vector2::from), 2..=MAX_BEZIER_DEGREE + 1)
    }

    /// Sum of control points with Bernstein polynomials.
    fn by_sum(control: &[Vector2<f64>], t: f64) -> Vector2<f64> {
        let n = control.len() - 1;
        let choose = |k: usize| (0..k).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64);
        let term = |k: usize| choose(k) * t.powi(k as i32) * (1.0 - t).powi((n - k) as i32);
        control.iter().enumerate().map(|(k, p)| p * term(k)).sum()
    }

    proptest! {
        #[test]
        fn values_are_sums_of_bernstein_polynomials(control in control(), t in 0.0..1.0_f64) {
            prop_assert!((value(&control, t) - by_sum(&control, t)).norm() < 1e-11);
        }

        #[test]
        fn a_part_is_the_curve_between_its_ends(
            control in control(), a in 0.0..1.0_f64, b in 0.0..1.0_f64, t in 0.0..1.0_f64
        ) {
            let part = part(&control, [a, b]);
            prop_assert!((value(&part, t) - value(&control, a + (b - a) * t)).norm() < 1e-10);
        }

        #[test]
        fn powers_go_forward_and_back(control in control(), t in 0.0..1.0_f64) {
            let powers = powers(&control);
            let sum: Vector2<f64> = powers.iter().enumerate().map(|(i, a)| a * t.powi(i as i32)).sum();
            prop_assert!((sum - value(&control, t)).norm() < 1e-9);
            let back = of_powers(&powers);
            prop_assert!(back.iter().zip(&control).all(|(a, b)| (a - b).norm() < 1e-9));
        }

        #[test]
        fn an_elevated_curve_is_the_same(control in control(), t in 0.0..1.0_f64) {
            let elevated = elevated(&control, MAX_BEZIER_DEGREE);
            prop_assert_eq!(elevated.len(), MAX_BEZIER_DEGREE + 1);
            prop_assert!((value(&elevated, t) - value(&control, t)).norm() < 1e-11);
        }

        /// Finite differences stay below the bounds.
        #[test]
        fn derivatives_are_bounded(control in control(), t in 0.01..0.99_f64) {
            let h = 1e-4;
            let [a, b, c] = [t - h, t, t + h].map(|t| by_sum(&control, t));
            prop_assert!(((c - a) / (2.0 * h)).norm() <= most_derivative(&control, 1) + 1e-4);
            prop_assert!(((c - b * 2.0 + a) / (h * h)).norm() <= most_derivative(&control, 2) + 1e-2);
        }

        #[test]
        fn end_derivatives_are_differences(control in control()) {
            let h = 1e-6;
            let [start, end] = end_derivatives(&control);
            prop_assert!((start - (by_sum(&control, h) - by_sum(&control, 0.0)) / h).norm() < 1e-2);
            prop_assert!((end - (by_sum(&control, 1.0) - by_sum(&control, 1.0 - h)) / h).norm() < 1e-2);
        }
    }
}
