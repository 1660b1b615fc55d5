//! Least-squares B-splines through points at given parameters, with as few spans as a tolerance allows.
//!
//! First and second derivatives of the spline are continuous, and it begins and ends at the first and the last point. A span that is out of tolerance is halved; when all are within it, the knots are placed
//! anew where the curvature is largest, and fewer of them are tried (Piegl and Tiller, The NURBS Book, 9.4.1; de Boor, A Practical
//! Guide to Splines, XII).

use super::basis;
use super::bezier::MAX_BEZIER_DEGREE;
use super::bracket::last_whole;
use super::knots::{bezier, clamped};
use super::least_squares::SoughtSpline;
use nalgebra::SVector;

/// Points between the knots of a span, at least. With fewer a spline runs through its points and swings between them: with four, a
/// pass round an edge left its path by 4 um there.
const LEAST_POINTS: usize = 8;

/// Spans of a spline, at most: beyond, straight lines are no worse.
const MAX_SPANS: usize = 64;

/// A B-spline of a degree of at least three. Each inner knot stands as often as leaves the second derivative continuous.
struct FittedSpline<const N: usize> {
    degree: usize,
    /// Ends of its spans.
    breaks: Vec<f64>,
    knots: Vec<f64>,
    control: Vec<SVector<f64, N>>,
}

/// The spans of the spline as Bezier curves. `off` gives the error of the spline at a point, by index and value, as a share of
/// the tolerance.
///
/// # Errors
/// No spline with enough points in its spans keeps the tolerance: the index of a point about which it fails.
pub fn fit<const N: usize>(
    points: &[SVector<f64, N>],
    parameters: &[f64],
    degree: usize,
    off: impl Fn(usize, &SVector<f64, N>) -> f64,
) -> Result<Vec<Vec<SVector<f64, N>>>, usize> {
    if points.len() != parameters.len() || points.len() < 3 || !(3..=MAX_BEZIER_DEGREE).contains(&degree) {
        return Err(points.len() / 2);
    }
    let mut inner: Vec<f64> = Vec::new();
    let spline = loop {
        let found = FittedSpline::least_squares(points, parameters, degree, &inner).ok_or(points.len() / 2)?;
        let failing = found.failing(parameters, &inner, &off);
        if failing.is_empty() {
            break found;
        }
        if inner.len() + failing.len() >= MAX_SPANS {
            return Err(points.len() / 2);
        }
        for span in failing {
            inner.push(halving(parameters, span).ok_or_else(|| found.worst(parameters, &off))?);
        }
        inner.sort_by(f64::total_cmp);
    };
    Ok(fewer(points, parameters, spline, &off).spans())
}

/// Inner knots of a spline with a number of spans whose error is about the same in all of them. `parameters` ascend.
pub fn even_knots<const N: usize>(
    points: &[SVector<f64, N>],
    parameters: &[f64],
    degree: usize,
    spans: usize,
) -> Option<Vec<f64>> {
    /// Spans of the spline whose derivatives tell the density, for each span that is required.
    const DENSITY_SPANS: usize = 4;
    let (first, last) = (*parameters.first()?, *parameters.last()?);
    let fine = DENSITY_SPANS * spans;
    let inner: Vec<f64> = (1..fine).map(|k| first + (last - first) * k as f64 / fine as f64).collect();
    let found = FittedSpline::least_squares(points, parameters, degree, &inner)?;
    Some(evened(&found.densities(), spans))
}

/// Parameter that halves a span; `None` where a half would have too few points.
fn halving(parameters: &[f64], [from, to]: [f64; 2]) -> Option<f64> {
    let middle = 0.5 * (from + to);
    let inside = |a: f64, b: f64| parameters.iter().filter(|u| **u > a && **u < b).count();
    (inside(from, middle) >= LEAST_POINTS && inside(middle, to) >= LEAST_POINTS).then_some(middle)
}

/// A spline with fewer spans that keeps the tolerance, or the same spline. Of splines with a number of spans that one is best
/// whose spans all have the same share of the integral of |derivative of order degree + 1| ^ (1 / (degree + 1)) (de Boor, A
/// Practical Guide to Splines, XII); the given spline says where the derivative is large.
fn fewer<const N: usize>(
    points: &[SVector<f64, N>],
    parameters: &[f64],
    spline: FittedSpline<N>,
    off: &impl Fn(usize, &SVector<f64, N>) -> f64,
) -> FittedSpline<N> {
    let densities = spline.densities();
    let candidate = |spans: usize| {
        let inner = evened(&densities, spans);
        let found = FittedSpline::least_squares(points, parameters, spline.degree, &inner)?;
        found.failing(parameters, &inner, off).is_empty().then_some(found)
    };
    // The error falls with the number of spans.
    let mut best = None;
    last_whole(densities.len(), 0, |spans| {
        let found = candidate(spans);
        let keeps = found.is_some();
        best = found.or(best.take());
        keeps
    });
    best.unwrap_or(spline)
}

/// Inner knots of spans with equal integrals over intervals of constant density: each has its length and its density.
fn evened(densities: &[([f64; 2], f64)], spans: usize) -> Vec<f64> {
    let share = |([from, to], density): &([f64; 2], f64)| (to - from) * density;
    let whole: f64 = densities.iter().map(share).sum();
    let mut inner = Vec::with_capacity(spans.saturating_sub(1));
    let mut before = 0.0;
    for interval in densities {
        let here = share(interval);
        while inner.len() + 1 < spans {
            let due = whole * (inner.len() + 1) as f64 / spans as f64;
            if due > before + here {
                break;
            }
            let [from, to] = interval.0;
            inner.push(from + (to - from) * (due - before) / here);
        }
        before += here;
    }
    inner
}

/// Share of the mean density below which no span goes: knots stay apart where a curve is straight.
const LEAST_DENSITY: f64 = 0.1;

impl<const N: usize> FittedSpline<N> {
    /// The spline with inner knots that is nearest to the points, with the first and the last point as its ends.
    fn least_squares(points: &[SVector<f64, N>], parameters: &[f64], degree: usize, inner: &[f64]) -> Option<Self> {
        let (first, last) = (*parameters.first()?, *parameters.last()?);
        let repeated = inner.iter().flat_map(|u| std::iter::repeat_n(*u, degree - 2));
        let knots = clamped([first, last], repeated, degree);
        let breaks = [first].into_iter().chain(inner.iter().copied()).chain([last]).collect();
        let ends = Some([points[0], points[points.len() - 1]]);
        let sought = SoughtSpline { knots: &knots, degree, closed: false, ends, smoothing: 0.0 };
        let control = sought.nearest_to(points.iter().copied(), parameters.iter().copied())?;
        Some(Self { degree, breaks, knots, control })
    }

    fn value(&self, u: f64) -> SVector<f64, N> {
        let basis = basis::of_degree::<{ MAX_BEZIER_DEGREE + 1 }>(&self.knots, self.degree, u, 0);
        (0..=self.degree).map(|j| self.control[basis.first + j] * basis.values[0][j]).sum()
    }

    /// The point with the largest error.
    fn worst(&self, parameters: &[f64], off: &impl Fn(usize, &SVector<f64, N>) -> f64) -> usize {
        let errors = parameters.iter().enumerate().map(|(i, u)| (i, off(i, &self.value(*u))));
        errors.fold((0, 0.0), |most, next| if next.1 > most.1 { next } else { most }).0
    }

    /// Spans with a point out of tolerance.
    fn failing(
        &self,
        parameters: &[f64],
        inner: &[f64],
        off: &impl Fn(usize, &SVector<f64, N>) -> f64,
    ) -> Vec<[f64; 2]> {
        let mut failing: Vec<[f64; 2]> = Vec::new();
        for (i, u) in parameters.iter().enumerate() {
            if off(i, &self.value(*u)) > 1.0 {
                let k = inner.partition_point(|knot| knot <= u);
                let from = k.checked_sub(1).map_or(parameters[0], |k| inner[k]);
                let to = inner.get(k).copied().unwrap_or(parameters[parameters.len() - 1]);
                if failing.last() != Some(&[from, to]) {
                    failing.push([from, to]);
                }
            }
        }
        failing
    }

    /// The spans, each with the density that its knots should have.
    fn densities(&self) -> Vec<([f64; 2], f64)> {
        let spans = self.spans();
        let ends: Vec<[f64; 2]> = self.breaks.windows(2).map(|pair| [pair[0], pair[1]]).collect();
        // The derivative of the order of the degree is constant over a span; its change leads to the next derivative.
        let highest: Vec<SVector<f64, N>> = spans.iter().zip(&ends).map(|(s, e)| highest(s, e[1] - e[0])).collect();
        let change = |k: usize| {
            let way = 0.5 * (ends[k + 1][1] - ends[k][0]);
            (highest[k + 1] - highest[k]).norm() / way
        };
        let power = 1.0 / (self.degree + 1) as f64;
        let mut densities: Vec<f64> = (0..spans.len())
            .map(|k| {
                let behind = k.checked_sub(1).map(change);
                let ahead = (k + 1 < spans.len()).then(|| change(k));
                libm::pow(behind.into_iter().chain(ahead).fold(0.0, f64::max), power)
            })
            .collect();
        let width: f64 = ends.iter().map(|e| e[1] - e[0]).sum();
        let mean = densities.iter().zip(&ends).map(|(d, e)| d * (e[1] - e[0])).sum::<f64>() / width;
        let least = if mean > 0.0 { LEAST_DENSITY * mean } else { 1.0 };
        densities.iter_mut().for_each(|d| *d = d.max(least));
        ends.into_iter().zip(densities).collect()
    }

    /// Bezier control points of each span.
    fn spans(&self) -> Vec<Vec<SVector<f64, N>>> {
        let degree = self.degree;
        let of_span = |k: usize| {
            let span = degree + k * (degree - 2);
            bezier(&self.knots, &self.control[span - degree..=span], span)
        };
        (0..self.breaks.len() - 1).map(of_span).collect()
    }
}

/// Highest derivative of a Bezier curve by a parameter that runs over a width.
fn highest<const N: usize>(control: &[SVector<f64, N>], width: f64) -> SVector<f64, N> {
    let mut row = control.to_vec();
    let mut factor = 1.0;
    while row.len() > 1 {
        factor *= (row.len() - 1) as f64 / width;
        row = row.windows(2).map(|w| w[1] - w[0]).collect();
    }
    row[0] * factor
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bezier;
    use nalgebra::Vector2;

    /// A smooth curve with more bends than one polynomial has.
    fn wave(u: f64) -> Vector2<f64> {
        Vector2::new(u, (0.9 * u).sin() + 0.2 * (2.3 * u).cos())
    }

    #[test]
    fn a_fit_keeps_its_tolerance_with_few_smooth_spans() {
        let parameters: Vec<f64> = (0..=400).map(|k| 0.025 * f64::from(k)).collect();
        let points: Vec<Vector2<f64>> = parameters.iter().map(|u| wave(*u)).collect();
        for (degree, most) in [(3, 31), (5, 17)] {
            let off = |i: usize, at: &Vector2<f64>| (at - points[i]).norm() / 1e-4;
            let spans = fit(&points, &parameters, degree, off).unwrap();
            assert!(spans.len() <= most, "degree {degree}: {} spans", spans.len());
            // x runs with the parameter: between the points too, the curve is the wave.
            let mut worst = 0.0_f64;
            for span in &spans {
                for k in 0..=50 {
                    let p = bezier::value(span, 0.02 * f64::from(k));
                    worst = worst.max((p.y - wave(p.x).y).abs());
                }
            }
            assert!(worst < 2e-4, "degree {degree}: {worst}");
            for pair in spans.windows(2) {
                let (a, b) = (&pair[0], &pair[1]);
                assert!((a[degree] - b[0]).norm() < 1e-12);
                let [_, end] = bezier::end_derivatives(a);
                let [start, _] = bezier::end_derivatives(b);
                assert!((end.normalize() - start.normalize()).norm() < 1e-9);
            }
        }
    }

    #[test]
    fn a_corner_has_no_fit() {
        let parameters: Vec<f64> = (0..=40).map(f64::from).collect();
        let points: Vec<Vector2<f64>> = parameters.iter().map(|u| Vector2::new(*u, (u - 20.0).abs())).collect();
        let found = fit(&points, &parameters, 3, |i, at| (at - points[i]).norm() / 1e-3);
        assert!(found.as_ref().is_err_and(|at| at.abs_diff(20) < 4), "{found:?}");
    }
}
