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
        return last;
    }
    let inner = &knots[degree..=last];
    // The index of the first knot above u, minus one; at least the first span.
    degree + inner.partition_point(|k| *k <= u).saturating_sub(1)
}

/// Functions at `u` in span `i` of a degree and of the two degrees below, the highest last: entry j of degree d weights
/// control point i - d + j.
#[inline(always)]
fn functions<const P: usize>(knots: &[f64], degree: usize, i: usize, u: f64) -> [[f64; P]; 3] {
    let mut n = [0.0; P];
    n[0] = 1.0;
    let mut all = [[0.0; P], [0.0; P], n];
    for d in 1..=degree {
        let mut saved = 0.0;
        for j in 0..d {
            let right = knots[i + 1 + j];
            let left = knots[i + 1 + j - d];
            let width = right - left;
            let term = if width > 0.0 { n[j] / width } else { 0.0 };
            n[j] = saved + (right - u) * term;
            saved = (u - left) * term;
        }
        n[d] = saved;
        all = [all[1], all[2], n];
    }
    all
}

/// One differentiation step: from functions of `degree - 1` to the derivative of those of `degree`.
#[inline(always)]
fn derive<const P: usize>(knots: &[f64], degree: usize, i: usize, lower: &[f64; P]) -> [f64; P] {
    let mut d = [0.0; P];
    for j in 0..degree {
        // Function j of the lower degree belongs to control index i - degree + 1 + j.
        let k = i + 1 + j - degree;
        let width = knots[k + degree] - knots[k];
        if width > 0.0 {
            let term = degree as f64 * lower[j] / width;
            d[j] -= term;
            d[j + 1] += term;
        }
    }
    d
}

/// Basis functions at `u` with derivatives up to `order` (at most 2); higher derivatives are zero.
pub fn evaluate(knots: &[f64], degree: usize, u: f64, order: usize) -> Basis {
    // A degree that the compiler knows unrolls the loops.
    match degree {
        3 => of_degree(knots, 3, u, order),
        2 => of_degree(knots, 2, u, order),
        1 => of_degree(knots, 1, u, order),
        _ => of_degree(knots, degree, u, order),
    }
}

/// The same for a degree of at most P - 1.
#[inline(always)]
pub fn of_degree<const P: usize>(knots: &[f64], degree: usize, u: f64, order: usize) -> Basis<P> {
    let i = span(knots, degree, u);
    let mut values = [[0.0; P]; 3];
    let [two_below, below, own] = functions(knots, degree, i, u);
    values[0] = own;
    if order >= 1 && degree >= 1 {
        values[1] = derive(knots, degree, i, &below);
    }
    if order >= 2 && degree >= 2 {
        values[2] = derive(knots, degree, i, &derive(knots, degree - 1, i, &two_below));
    }
    Basis { first: i - degree, values }
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
