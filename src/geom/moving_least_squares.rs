//! Curvature of a triangulated surface by moving least squares (Xu 4, formula 18).
//!
//! At each point a patch over its tangent plane is fitted to its neighbourhood with weights exp(-r^2 / h^2), and its
//! first and second derivatives at the point give normal and curvatures as those of any surface do. The paper's patch is
//! z = a x^2 + b y^2 + c x y + d x + e y + f. Over a neighbourhood with points on one side only, at the rim, change of
//! the curvature would count as curvature: where there are points enough, the patch has the four cubic terms as well.

use super::triangulation::Triangulation;
use super::{SurfaceCurvature, SurfaceDerivatives};
use nalgebra::{DMatrix, DVector, Point3, Vector3};

/// Width h of the weights in mean edges of the point. Points of a design carry no noise that a wider one would take
/// out, and a cubic spline changes its curvature with a kink at its knots, which the width blurs.
const WIDTH: f64 = 0.85;

/// Radius of the neighbourhood in widths: farther points weigh less than a ten-thousandth.
const RADIUS: f64 = 3.2;

/// Most that width and radius grow at rims and corners, where fewer points lie near.
const GROWTH: f64 = 2.0;

/// Terms of the quadratic patch, and of the cubic one.
const TERMS: [usize; 2] = [6, 10];

/// Points that a cubic patch needs: at a corner the terms are told apart by far points alone.
const CUBIC_POINTS: usize = 24;

/// Order of the patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patch {
    /// Formula 18.
    Quadratic,
    /// With the cubic terms where the neighbourhood bears them.
    Cubic,
}

/// Normal and curvatures at a point; the normal is on the side from which the triangles run counter-clockwise.
/// `None` where the neighbourhood does not fix a patch.
pub fn curvature(
    mesh: &Triangulation,
    normals: &[Vector3<f64>],
    point: usize,
    patch: Patch,
) -> Option<SurfaceCurvature> {
    let normal = normals[point].try_normalize(0.5)?;
    let mut width = WIDTH * mesh.mean_edge(point);
    let most = GROWTH * width;
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
        // Square root of the weight: it is squared in the normal equations.
        let weight = libm::exp(-0.5 * d.norm_squared());
        let row_terms = [u * u, v * v, u * v, u, v, 1.0, u * u * u, u * u * v, u * v * v, v * v * v];
        for (column, term) in row_terms.iter().take(terms).enumerate() {
            matrix[(row, column)] = weight * term;
        }
        right[row] = weight * w;
    }
    let fit = matrix.svd(true, true).solve(&right, 1e-10).ok()?;
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

/// The coordinate axis that is least along a vector.
fn least_axis(v: &Vector3<f64>) -> Vector3<f64> {
    let mut axis = Vector3::zeros();
    axis[v.iamin()] = 1.0;
    axis
}
