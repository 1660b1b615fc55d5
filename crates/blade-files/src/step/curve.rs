//! Curves of STEP files: lines, circles, ellipses and splines, with their first derivatives. Lengths are in mm, in the frame of the
//! file.

use super::placement::StepPlacement;
use super::spline::{SplineKnots, projected};
use nalgebra::{Point3, Vector3, Vector4};

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum StepCurve {
    /// A straight line: a point and the way for a parameter of 1.
    Line(Point3<f64>, Vector3<f64>),
    /// An ellipse by its placement and its half axes, mm; a circle has two equal ones. The parameter is the angle, rad.
    Ellipse(StepPlacement, [f64; 2]),
    /// A spline by its homogeneous control points.
    Spline(SplineKnots, Vec<Vector4<f64>>),
}

impl StepCurve {
    /// Point and first derivative at a parameter.
    pub(super) fn at(&self, t: f64) -> (Point3<f64>, Vector3<f64>) {
        match self {
            Self::Line(start, way) => (start + way * t, *way),
            Self::Ellipse(placement, [a, b]) => {
                let (sin, cos) = libm::sincos(t);
                let [x, y, _] = placement.axes;
                (placement.origin + x * (a * cos) + y * (b * sin), y * (b * cos) - x * (a * sin))
            }
            Self::Spline(knots, control) => {
                let weights = knots.at(t);
                let of =
                    |w: &[f64]| -> Vector4<f64> { control[weights.first..].iter().zip(w).map(|(c, w)| c * *w).sum() };
                let (point, [slope]) = projected(of(&weights.values), [of(&weights.slopes)]);
                (point, slope)
            }
        }
    }

    /// Ends of the parameter: those of a spline, a whole turn of an ellipse, none of a line.
    pub(super) fn domain(&self) -> Option<[f64; 2]> {
        match self {
            Self::Line(..) => None,
            Self::Ellipse(..) => Some([0.0, std::f64::consts::TAU]),
            Self::Spline(knots, _) => Some(knots.domain()),
        }
    }

    /// Parameter of the point of the curve that is nearest to a point.
    pub(super) fn nearest(&self, p: &Point3<f64>) -> f64 {
        /// Places between which the search begins, a span.
        const SPAN_SEEDS: usize = 8;
        match self {
            Self::Line(start, way) => (p - start).dot(way) / way.norm_squared(),
            Self::Ellipse(placement, [a, b]) => {
                let [x, y, _] = placement.axes;
                let way = p - placement.origin;
                libm::atan2(way.dot(&y) / b, way.dot(&x) / a)
            }
            Self::Spline(knots, _) => {
                let [lo, hi] = knots.domain();
                let steps = SPAN_SEEDS * knots.spans();
                let seeds = (0..=steps).map(|k| lo + (hi - lo) * k as f64 / steps as f64);
                let far = |t: &f64| (self.at(*t).0 - p).norm_squared();
                let mut t = seeds.min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(lo);
                for _ in 0..20 {
                    let (point, slope) = self.at(t);
                    t = (t + (p - point).dot(&slope) / slope.norm_squared().max(f64::MIN_POSITIVE)).clamp(lo, hi);
                }
                t
            }
        }
    }
}
