//! B-spline basis functions on the stack (Wei 1; Piegl and Tiller, The NURBS Book, A2.1 and A2.2).

/// Largest degree of the kernel; stack arrays have one more place.
pub const MAX_DEGREE: usize = 3;

/// Nonzero basis functions at a parameter, with first and second derivatives; `P` places are enough for a degree of P - 1.
#[derive(Clone, Copy, Debug)]
pub struct Basis<const P: usize = { MAX_DEGREE + 1 }> {
    /// Index of the first control point with a weight.
    pub first: usize,
    /// `values[k][j]`: derivative of order k of function `first + j`.
    pub values: [[f64; P]; 3],
}

/// Index i of the knot span with `knots[i] <= u < knots[i + 1]`, clamped to the domain.
pub fn span(knots: &[f64], degree: usize, u: f64) -> usize {
    let last = knots.len() - degree - 2;
    if u >= knots[last + 1] {
        // Knots that are not clamped may repeat at the end of the domain.
        return (degree..=last).rev().find(|i| knots[*i] < knots[i + 1]).unwrap_or(last);
    }
    let inner = &knots[degree..=last];
    // The index of the first knot above u, minus one; at least the first span.
    degree + inner.partition_point(|k| *k <= u).saturating_sub(1)
}

/// [`span`], which is tried first where that of a place nearby is known.
pub(super) fn span_from(knots: &[f64], degree: usize, u: f64, nearby: usize) -> usize {
    if knots[nearby] <= u && u < knots[nearby + 1] { nearby } else { span(knots, degree, u) }
}

/// From the functions of degree `d - 1` at `u` to those of degree `d`. `around` are the knots round the span, as many on either side as the
/// degree of the spline.
#[inline(always)]
fn raised<const P: usize>(around: &[f64], d: usize, u: f64, mut n: [f64; P]) -> [f64; P] {
    let middle = around.len() / 2;
    let mut saved = 0.0;
    for j in 0..d {
        let right = around[middle + j];
        let left = around[middle + j - d];
        let width = right - left;
        let term = if width > 0.0 { n[j] / width } else { 0.0 };
        n[j] = saved + (right - u) * term;
        saved = (u - left) * term;
    }
    n[d] = saved;
    n
}

/// Functions at `u` of the degree of a spline and of the two degrees below, the highest last: entry j of degree d weights
/// control point i - d + j, where i is the span.
#[inline(always)]
fn functions<const P: usize>(around: &[f64], degree: usize, u: f64) -> [[f64; P]; 3] {
    let mut n = [0.0; P];
    n[0] = 1.0;
    let mut all = [[0.0; P], [0.0; P], n];
    let mut raise = |d: usize| all = [all[1], all[2], raised(around, d, u, all[2])];
    // Written out up to the degree of the kernel: the compiler unrolls a loop whose length it knows, but not one in another.
    if degree >= 1 {
        raise(1);
    }
    if degree >= 2 {
        raise(2);
    }
    if degree >= 3 {
        raise(3);
    }
    (4..=degree).for_each(raise);
    all
}

/// One differentiation step: from functions of degree `d - 1` to the derivative of those of degree `d`.
#[inline(always)]
fn derive<const P: usize>(around: &[f64], d: usize, lower: &[f64; P]) -> [f64; P] {
    let middle = around.len() / 2;
    let mut derived = [0.0; P];
    for j in 0..d {
        let width = around[middle + j] - around[middle + j - d];
        if width > 0.0 {
            let term = d as f64 * lower[j] / width;
            derived[j] -= term;
            derived[j + 1] += term;
        }
    }
    derived
}

/// Basis functions at `u` with derivatives up to `order` (at most 2); higher derivatives are zero.
pub fn evaluate(knots: &[f64], degree: usize, u: f64, order: usize) -> Basis {
    match (degree, order) {
        (3, 0) => known::<3, 0>(knots, u),
        (3, 1) => known::<3, 1>(knots, u),
        (3, _) => known::<3, 2>(knots, u),
        _ => of_degree(knots, degree, u, order),
    }
}

/// Functions of the degree of the kernel with two derivatives in span `i`, as [`evaluate`] gives them.
#[inline(never)]
pub(super) fn cubic_in_span(knots: &[f64], i: usize, u: f64) -> Basis {
    in_span(knots, 3, i, u, 2)
}

/// [`of_degree`] for a degree and an order that the compiler knows: no loop remains. Inlined side by side such functions would be merged
/// to one with loops again.
#[inline(never)]
fn known<const DEGREE: usize, const ORDER: usize>(knots: &[f64], u: f64) -> Basis {
    of_degree(knots, DEGREE, u, ORDER)
}

/// The same for a degree of at most P - 1.
#[inline(always)]
pub fn of_degree<const P: usize>(knots: &[f64], degree: usize, u: f64, order: usize) -> Basis<P> {
    in_span(knots, degree, span(knots, degree, u), u, order)
}

/// The same for the polynomials of span `i`, which go on beyond its ends.
#[inline(always)]
pub fn in_span<const P: usize>(knots: &[f64], degree: usize, i: usize, u: f64, order: usize) -> Basis<P> {
    let around = &knots[i + 1 - degree..][..2 * degree];
    let mut values = [[0.0; P]; 3];
    let [two_below, below, own] = functions(around, degree, u);
    values[0] = own;
    if order >= 1 && degree >= 1 {
        values[1] = derive(around, degree, &below);
    }
    if order >= 2 && degree >= 2 {
        values[2] = derive(around, degree, &derive(around, degree - 1, &two_below));
    }
    Basis { first: i - degree, values }
}

/// Symmetric form, linear in each of its arguments, of the polynomial of span `i` (blossom; Ramshaw 1987): with equal arguments it is
/// the value there. `argument` gives as many as the degree. `control` are the points with a weight in the span, one more than the
/// degree, and `mix` gives a (1 - t) + b t for a, b and t with the rounding that the caller wants.
#[inline(always)]
pub fn blossom<T: Copy, const P: usize>(
    knots: &[f64],
    degree: usize,
    i: usize,
    mut control: [T; P],
    argument: impl Fn(usize) -> f64,
    mix: impl Fn(T, T, f64) -> T,
) -> T {
    for step in 0..degree {
        let u = argument(step);
        for j in (step + 1..=degree).rev() {
            let (left, right) = (knots[i + j - degree], knots[i + j - step]);
            control[j] = mix(control[j - 1], control[j], (u - left) / (right - left));
        }
    }
    control[degree]
}

/// True for knots that ascend, have the right number for `count` control points, are clamped to [0, 1], and contain no
/// inner knot more than `degree` times (there the curve would be discontinuous).
pub fn valid_knots(knots: &[f64], degree: usize, count: usize) -> bool {
    knots.len() == count + degree + 1
        && count > degree
        && knots.iter().all(|k| k.is_finite())
        && knots.windows(2).all(|k| k[0] <= k[1])
        && knots[..=degree].iter().all(|k| *k == 0.0)
        && knots[count..].iter().all(|k| *k == 1.0)
        && knots[degree + 1..count].windows(degree + 1).all(|k| k[0] < k[degree])
        && knots[degree + 1..count].iter().all(|k| 0.0 < *k && *k < 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: usize = 6;

    /// Knots with a repeated one inside, of each degree; the last ones are not clamped and repeat at the end of their domain.
    fn cases() -> Vec<(usize, Vec<f64>)> {
        let clamped = |degree: usize| -> Vec<f64> {
            let end = |u: f64| std::iter::repeat_n(u, degree + 1);
            let inner = [0.2, 0.6, 0.6, 0.7];
            end(0.0).chain(inner.into_iter().skip(usize::from(degree == 1))).chain(end(1.0)).collect()
        };
        let open = vec![-1.0, 0.0, 0.0, 1.0, 2.0, 2.0, 4.0, 5.0];
        (2..P).map(|degree| (degree, clamped(degree))).chain([(2, open)]).collect()
    }

    /// Functions sum up to one and their derivatives to zero, and derivatives agree with differences.
    #[test]
    fn functions_are_a_partition_of_one() {
        for (degree, knots) in cases() {
            let [lo, hi] = [knots[degree], knots[knots.len() - degree - 1]];
            for k in 0..=40 {
                let u = lo + (hi - lo) * f64::from(k) / 40.0;
                let at = of_degree::<P>(&knots, degree, u, 2);
                let sums = at.values.map(|values| values.iter().sum::<f64>());
                assert!((sums[0] - 1.0).abs() < 1e-12 && sums[1].abs() < 1e-9 && sums[2].abs() < 1e-7, "{degree} {u}");
                assert!(at.values[0].iter().all(|n| *n >= 0.0), "{degree} {u}");
                let span = at.first + degree;
                let step = 1e-5;
                let [before, after] = [-step, step].map(|by| in_span::<P>(&knots, degree, span, u + by, 1).values);
                for order in 0..2 {
                    for j in 0..=degree {
                        let difference = (after[order][j] - before[order][j]) / (2.0 * step);
                        let due = at.values[order + 1][j];
                        assert!((due - difference).abs() < 1e-4 * (1.0 + due.abs()), "{degree} {u} {due} {difference}");
                    }
                }
            }
        }
    }

    /// The symmetric form with equal arguments is the weighted sum of the control points.
    #[test]
    fn blossoms_are_values() {
        for (degree, knots) in cases() {
            let [lo, hi] = [knots[degree], knots[knots.len() - degree - 1]];
            for k in 0..=40 {
                let u = lo + (hi - lo) * f64::from(k) / 40.0;
                let basis = of_degree::<P>(&knots, degree, u, 0);
                let control: [f64; P] = std::array::from_fn(|j| libm::sin(3.0 * (basis.first + j) as f64));
                let due: f64 = basis.values[0].iter().zip(control).map(|(n, c)| n * c).sum();
                let found = blossom(&knots, degree, basis.first + degree, control, |_| u, |a, b, t| a + (b - a) * t);
                assert!((found - due).abs() < 1e-12, "{degree} {u}");
            }
        }
    }
}
