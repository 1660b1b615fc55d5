//! Curvature of a triangulated surface by moving least squares (Xu 4, formula 18).
//!
//! At each point a patch over its tangent plane is fitted to its neighbourhood with weights exp(-r^2 / h^2). The first
//! and second derivatives of the patch at the point give normal and curvatures as for any surface. The patch of the
//! paper is z = a x^2 + b y^2 + c x y + d x + e y + f. At the rim the neighbourhood lies on one side only, and a change
//! of the curvature would act as curvature. Where there are enough points, the patch therefore has the four cubic terms
//! as well.

use super::triangulation::Triangulation;
use super::{SurfaceCurvature, SurfaceDerivatives};
use nalgebra::{DMatrix, DVector, Point3, Vector3};

/// Singular value of the fit that counts as none.
const SINGULAR: f64 = 1e-10;

/// Width h of the weights, in mean edges of the point. A larger width would remove noise, which points of a design do
/// not have. It would blur the kinks that the curvature of a cubic spline has at its knots.
const WIDTH: f64 = 0.85;

/// Radius of the neighbourhood in widths: points farther away have weights below 1e-4.
const RADIUS: f64 = 3.2;

/// Largest growth of width and radius at rims and corners, where fewer points are near.
const MAX_WIDTH_GROWTH: f64 = 2.0;

/// Terms of the quadratic patch, and of the cubic one.
const TERMS: [usize; 2] = [6, 10];

/// Points that a cubic patch needs: at a corner only far points distinguish its terms.
const CUBIC_POINTS: usize = 24;

/// Order of the patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patch {
    /// Formula 18.
    Quadratic,
    /// With the cubic terms where the neighbourhood has enough points.
    Cubic,
}

/// Normal and curvatures at a point; the normal is on the side from which the triangles run counter-clockwise. `None`
/// where the neighbourhood does not determine a patch.
pub fn curvature(
    mesh: &Triangulation,
    normals: &[Vector3<f64>],
    point: usize,
    patch: Patch,
) -> Option<SurfaceCurvature> {
    let normal = normals[point].try_normalize(0.5)?;
    let mut width = WIDTH * mesh.mean_edge(point);
    let most = MAX_WIDTH_GROWTH * width;
    let mut near = mesh.within(point, RADIUS * width);
    while near.len() < CUBIC_POINTS && width < most {
        width *= 1.1;
        near = mesh.within(point, RADIUS * width);
    }
    let x = normal.cross(&least_axis(&normal)).normalize();
    let y = normal.cross(&x);
    let origin: Point3<f64> = mesh.points()[point];
    let terms = match patch {
        Patch::Cubic if near.len() >= CUBIC_POINTS => TERMS[1],
        _ => TERMS[0],
    };
    if near.len() < terms {
        return None;
    }
    let mut matrix = DMatrix::zeros(near.len(), terms);
    let mut right = DVector::zeros(near.len());
    for (row, index) in near.iter().enumerate() {
        let d = (mesh.points()[*index] - origin) / width;
        let (u, v, w) = (d.dot(&x), d.dot(&y), d.dot(&normal));
        // Square root of the weight, since the normal equations square it.
        let weight = libm::exp(-0.5 * d.norm_squared());
        let row_terms = [u * u, v * v, u * v, u, v, 1.0, u * u * u, u * u * v, u * v * v, v * v * v];
        for (column, term) in row_terms.iter().take(terms).enumerate() {
            matrix[(row, column)] = weight * term;
        }
        right[row] = weight * w;
    }
    let fit = matrix.svd(true, true).solve(&right, SINGULAR).ok()?;
    let [a, b, c] = [fit[0] / width, fit[1] / width, fit[2] / width];
    let patch = SurfaceDerivatives {
        point: origin + normal * (fit[5] * width),
        su: x + normal * fit[3],
        sv: y + normal * fit[4],
        suu: normal * (2.0 * a),
        suv: normal * c,
        svv: normal * (2.0 * b),
    };
    patch.curvature()
}

/// Curvatures at all points of a mesh.
pub fn curvatures(mesh: &Triangulation, patch: Patch) -> Vec<Option<SurfaceCurvature>> {
    let normals = mesh.normals();
    (0..mesh.points().len()).map(|i| curvature(mesh, &normals, i, patch)).collect()
}

/// The coordinate axis with the least component along a vector.
fn least_axis(v: &Vector3<f64>) -> Vector3<f64> {
    let mut axis = Vector3::zeros();
    axis[v.iamin()] = 1.0;
    axis
}
