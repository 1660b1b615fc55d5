//! Curves through points: chord length parameters (Wei 14), averaged knots (16), banded solve (15).

use super::basis::{self, MAX_DEGREE};
use super::knots::clamped;
use super::{GeomError, NurbsCurve, NurbsSurface};
use nalgebra::{Point3, Vector3};

/// Chord length parameters of data points on [0, 1] (Wei 14).
///
/// # Errors
/// Fewer than two points, a coordinate that is not finite, or neighbours that coincide.
pub fn chord_parameters(points: &[Point3<f64>]) -> Result<Vec<f64>, GeomError> {
    if points.len() < 2 {
        return Err(GeomError::TooFewPoints { given: points.len(), needed: 2 });
    }
    if let Some(i) = points.iter().position(|p| !p.coords.iter().all(|x| x.is_finite())) {
        return Err(GeomError::NotFinite(i));
    }
    let mut sum = 0.0;
    let mut parameters = vec![0.0];
    for (i, pair) in points.windows(2).enumerate() {
        let chord = (pair[1] - pair[0]).norm();
        if chord <= 0.0 {
            return Err(GeomError::CoincidentPoints(i));
        }
        if !chord.is_finite() {
            return Err(GeomError::NotFinite(i));
        }
        sum += chord;
        parameters.push(sum);
    }
    for p in &mut parameters {
        *p /= sum;
    }
    if let Some(i) = parameters.windows(2).position(|p| p[0] >= p[1]) {
        return Err(GeomError::CoincidentPoints(i));
    }
    if let Some(last) = parameters.last_mut() {
        *last = 1.0;
    }
    Ok(parameters)
}

/// Averaged knots for interpolation at given parameters (Wei 16).
pub fn averaged_knots(parameters: &[f64], degree: usize) -> Vec<f64> {
    let mean = |j: usize| parameters[j..j + degree].iter().sum::<f64>() / degree as f64;
    clamped([0.0, 1.0], (1..parameters.len().saturating_sub(degree)).map(mean), degree)
}

/// The curve of a degree through data points (Wei 14 to 16).
///
/// # Errors
/// Too few points for the degree, coincident or non-finite points, or a singular system.
pub fn interpolate(points: &[Point3<f64>], degree: usize) -> Result<NurbsCurve, GeomError> {
    if !(1..=MAX_DEGREE).contains(&degree) {
        return Err(GeomError::Degree(degree));
    }
    if points.len() < degree + 1 {
        return Err(GeomError::TooFewPoints { given: points.len(), needed: degree + 1 });
    }
    let parameters = chord_parameters(points)?;
    through(&parameters, points, degree)
}

/// The curve of a degree through points at parameters, which ascend from 0 to 1.
///
/// # Errors
/// Too few points for the degree, parameters that do not ascend from 0 to 1, or a singular system.
pub fn interpolate_at(parameters: &[f64], points: &[Point3<f64>], degree: usize) -> Result<NurbsCurve, GeomError> {
    if points.len() < degree + 1 || parameters.len() != points.len() {
        return Err(GeomError::TooFewPoints { given: parameters.len().min(points.len()), needed: degree + 1 });
    }
    ascend(parameters)?;
    through(parameters, points, degree)
}

fn through(parameters: &[f64], points: &[Point3<f64>], degree: usize) -> Result<NurbsCurve, GeomError> {
    let knots = averaged_knots(parameters, degree);
    let control = solve_banded(&knots, degree, parameters, points)?;
    NurbsCurve::try_new(degree, knots, &control, None)
}

/// The surface through a grid of points at parameters of u and of v, which ascend from 0 to 1: rows of equal v, each from u = 0 to
/// u = 1. Cubic where a direction has enough points. Its border curves depend on the points and parameters of the border alone, so
/// that two surfaces with the same ones on a border have the same curve there, to the last bit.
///
/// # Errors
/// Fewer than two points in a direction, rows of different lengths, parameters that do not ascend from 0 to 1, or points that are not
/// finite.
pub fn interpolate_grid(rows: &[Vec<Point3<f64>>], parameters: [&[f64]; 2]) -> Result<NurbsSurface, GeomError> {
    let counts = [rows.first().map_or(0, Vec::len), rows.len()];
    if let Some(given) = counts.into_iter().find(|n| *n < 2) {
        return Err(GeomError::TooFewPoints { given, needed: 2 });
    }
    if let Some(row) = rows.iter().find(|row| row.len() != counts[0]) {
        return Err(GeomError::TooFewPoints { given: row.len(), needed: counts[0] });
    }
    for (parameters, needed) in parameters.into_iter().zip(counts) {
        if parameters.len() != needed {
            return Err(GeomError::TooFewPoints { given: parameters.len(), needed });
        }
        ascend(parameters)?;
    }
    let degree = counts.map(|n| MAX_DEGREE.min(n - 1));
    let knots = [0, 1].map(|d| averaged_knots(parameters[d], degree[d]));
    let along = |row: &Vec<Point3<f64>>| solve_banded(&knots[0], degree[0], parameters[0], row);
    let by_row = rows.iter().map(along).collect::<Result<Vec<_>, _>>()?;
    let mut control = Vec::with_capacity(counts[0] * counts[1]);
    for i in 0..counts[0] {
        let column: Vec<Point3<f64>> = by_row.iter().map(|row| row[i]).collect();
        control.extend(solve_banded(&knots[1], degree[1], parameters[1], &column)?);
    }
    NurbsSurface::try_new(degree, knots, &control, None)
}

/// An error where parameters do not ascend from 0 to 1.
fn ascend(parameters: &[f64]) -> Result<(), GeomError> {
    if let Some(k) = parameters.windows(2).position(|pair| pair[0] >= pair[1]) {
        return Err(GeomError::CoincidentPoints(k));
    }
    let ends = [parameters.first(), parameters.last()];
    if ends == [Some(&0.0), Some(&1.0)] { Ok(()) } else { Err(GeomError::Knots) }
}

/// Solves N P = Q by elimination inside the band. The matrix of a B-spline interpolation with averaged knots is totally
/// positive, so that elimination without pivoting is stable (de Boor and Pinkus 1977).
fn solve_banded(
    knots: &[f64],
    degree: usize,
    parameters: &[f64],
    points: &[Point3<f64>],
) -> Result<Vec<Point3<f64>>, GeomError> {
    let n = points.len();
    let width = 2 * degree + 1;
    // Row i holds columns i - degree ..= i + degree.
    let mut band = vec![0.0; n * width];
    let mut right: Vec<Vector3<f64>> = points.iter().map(|p| p.coords).collect();
    for (i, u) in parameters.iter().enumerate() {
        let basis = basis::evaluate(knots, degree, *u, 0);
        for j in 0..=degree {
            let column = basis.first + j;
            if basis.values[0][j] != 0.0 {
                let offset = (column + degree).checked_sub(i).filter(|o| *o < width).ok_or(GeomError::Singular)?;
                band[i * width + offset] = basis.values[0][j];
            }
        }
    }
    for k in 0..n {
        let pivot = band[k * width + degree];
        if pivot.abs() < f64::EPSILON {
            return Err(GeomError::Singular);
        }
        for i in k + 1..(k + degree + 1).min(n) {
            let factor = band[i * width + k + degree - i] / pivot;
            if factor != 0.0 {
                for column in k..(k + degree + 1).min(n) {
                    band[i * width + column + degree - i] -= factor * band[k * width + column + degree - k];
                }
                let above = right[k];
                right[i] -= above * factor;
            }
        }
    }
    for k in (0..n).rev() {
        let mut value = right[k];
        for column in k + 1..(k + degree + 1).min(n) {
            value -= right[column] * band[k * width + column + degree - k];
        }
        right[k] = value / band[k * width + degree];
    }
    Ok(right.into_iter().map(Point3::from).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_through_its_points() {
        let points: Vec<_> =
            (0..9).map(|i| f64::from(i) * 0.7).map(|t| Point3::new(t.cos() * 9.0, t * t, t.sin() * 5.0)).collect();
        for degree in 1..=3 {
            let curve = interpolate(&points, degree).expect("valid data");
            for (u, p) in chord_parameters(&points).expect("valid data").iter().zip(&points) {
                assert!((curve.point(*u) - p).norm() < 1e-12);
            }
        }
    }

    /// A surface with polynomial coordinates of degree 3 is found exactly, and neighbours share their border.
    #[test]
    fn surfaces_through_grids() {
        let at = |u: f64, v: f64| Point3::new(9.0 * u + v * v, u * u * u - v, 4.0 * v * v * v + u * v);
        // Unequal steps along u, equal steps along v.
        let u: Vec<f64> = (0..12).map(|i| f64::from(i * (i + 9)) / 220.0).collect();
        let v: Vec<f64> = (0..7).map(|j| f64::from(j) / 6.0).collect();
        let grid = |from: f64| -> Vec<Vec<Point3<f64>>> {
            v.iter().map(|v| u.iter().map(|u| at(*u, from + v)).collect()).collect()
        };
        let (low, mut high) = (grid(0.0), grid(1.0));
        high[0].clone_from(&low[6]);
        let [low, high] = [low, high].map(|rows| interpolate_grid(&rows, [&u, &v]).expect("valid data"));
        for (u, v) in [(0.0, 0.0), (0.31, 0.77), (1.0, 1.0), (0.5, 0.02)] {
            assert!((low.point(u, v) - at(u, v)).norm() < 1e-12, "{u} {v}");
        }
        assert_eq!(low.border(true), high.border(false));
        let four = [0.0, 0.3, 0.6, 1.0];
        let rows = |counts: &[usize]| -> Vec<Vec<Point3<f64>>> {
            counts.iter().map(|n| (0..*n).map(|i| Point3::new(i as f64, 0.0, 0.0)).collect()).collect()
        };
        assert!(interpolate_grid(&rows(&[4, 4]), [&four, &[0.0, 1.0]]).is_ok());
        for (counts, u, v) in [
            (&[4][..], &four[..], &[0.0][..]),
            (&[4, 3], &four, &[0.0, 1.0]),
            (&[4, 4], &four[..3], &[0.0, 1.0]),
            (&[4, 4], &[0.0, 0.6, 0.3, 1.0], &[0.0, 1.0]),
            (&[4, 4], &four, &[0.1, 1.0]),
        ] {
            assert!(interpolate_grid(&rows(counts), [u, v]).is_err(), "{counts:?} {u:?} {v:?}");
        }
    }
}
