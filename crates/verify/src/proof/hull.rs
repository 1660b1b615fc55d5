//! A cell of a surface and the hull of its control points.

use nalgebra::{Point3, Vector3};

/// A cell of a surface: the biquadratic through nine of its points, with a thickness.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hull {
    /// Middle point.
    pub(crate) centre: Point3<f64>,
    /// Corners: (low x, low y), (low, high), (high, low), (high, high).
    pub(crate) corners: [Point3<f64>; 4],
    /// Distance of the farthest point of the cell from the middle point.
    pub(crate) radius: f64,
    /// Control points of the biquadratic relative to the middle point; the biquadratic lies in their hull.
    pub(crate) control: [Vector3<f64>; 9],
    /// Control points of edges and middle, relative to those of the bilinear surface through the corners.
    pub(crate) bulge: [Vector3<f64>; 5],
    /// Half sides.
    pub(crate) sides: [Vector3<f64>; 2],
    /// Thickness of the cell about the biquadratic.
    pub(crate) thickness: f64,
}

impl Hull {
    /// Hull through nine points, x by x.
    pub(crate) fn new(points: &[Point3<f64>; 9], thickness: f64) -> Self {
        let centre = points[4];
        let p = points.map(|q| q - centre);
        let middle = |a: Vector3<f64>, m: Vector3<f64>, b: Vector3<f64>| m * 2.0 - (a + b) * 0.5;
        // Along y first, then along x.
        let rows = [0, 3, 6].map(|i| [p[i], middle(p[i], p[i + 1], p[i + 2]), p[i + 2]]);
        let mut control = [Vector3::zeros(); 9];
        for j in 0..3 {
            control[j] = rows[0][j];
            control[3 + j] = middle(rows[0][j], rows[1][j], rows[2][j]);
            control[6 + j] = rows[2][j];
        }
        let (a, b, c, d) = (control[0], control[2], control[6], control[8]);
        let bulge = [
            control[1] - (a + b) * 0.5,
            control[3] - (a + c) * 0.5,
            control[5] - (b + d) * 0.5,
            control[7] - (c + d) * 0.5,
            control[4] - (a + b + c + d) * 0.25,
        ];
        let radius = control.iter().map(Vector3::norm_squared).fold(0.0, f64::max).sqrt() + thickness;
        let corners = [points[0], points[2], points[6], points[8]];
        let sides = [(p[7] - p[1]) * 0.5, (p[5] - p[3]) * 0.5];
        Self { centre, corners, radius, control, bulge, sides, thickness }
    }

    /// Area, mm2.
    pub(crate) fn area(&self) -> f64 {
        let [a, b, c, d] = self.corners;
        0.5 * (d - a).cross(&(c - b)).norm()
    }

    /// Largest distance of the cell from the hull of its corners.
    pub(crate) fn bulges(&self) -> f64 {
        self.bulge.iter().map(Vector3::norm).fold(0.0, f64::max) + self.thickness
    }

    /// Least value over the cell of g . (p - from) + k (e . (p - from))^2, for p in the cell and a place `at` of it,
    /// with the best k up to `most`. Any share of the curvature is valid; the best share balances the curvature of the
    /// surface.
    pub(crate) fn least_curved(&self, at: [f64; 2], gradient: &Vector3<f64>, across: &Vector3<f64>, most: f64) -> f64 {
        const PLACE: [f64; 3] = [-1.0, 0.0, 1.0];
        const SQUARE: [f64; 3] = [1.0, -1.0, 1.0];
        const CURVATURE_SHARES: usize = 4;
        let along = self.at(at).dot(gradient);
        // e . (p - from) is linear apart from the bulge.
        let (a, b) = (across.dot(&self.sides[0]), across.dot(&self.sides[1]));
        let c = -a * at[0] - b * at[1];
        let widest = a.abs() + b.abs() + c.abs();
        let mut deviation = 0.0_f64;
        let parts: [(f64, f64); 9] = std::array::from_fn(|n| {
            let (i, j) = (n / 3, n % 3);
            let (x, y) = (PLACE[i], PLACE[j]);
            let square = a * a * SQUARE[i] + b * b * SQUARE[j] + c * c + 2.0 * (a * b * x * y + c * (a * x + b * y));
            deviation = deviation.max((across.dot(&self.control[n]) - a * x - b * y).abs());
            (self.control[n].dot(gradient) - along, square)
        });
        let loss = 2.0 * widest * (deviation + self.thickness);
        let least = |k: f64| least_of(parts.map(|p| p.0 + k * p.1)) - k * loss;
        let best = (0..=CURVATURE_SHARES)
            .map(|n| least(most * n as f64 / CURVATURE_SHARES as f64))
            .fold(f64::NEG_INFINITY, f64::max);
        best - self.thickness
    }

    pub(crate) fn at(&self, [x, y]: [f64; 2]) -> Vector3<f64> {
        self.sides[0] * x + self.sides[1] * y
    }
}

/// The least of nine numbers; `f64::min` would test each for NaN.
pub(crate) fn least_of(values: [f64; 9]) -> f64 {
    values.into_iter().fold(f64::INFINITY, |least, v| if v < least { v } else { least })
}
