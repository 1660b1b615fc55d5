//! Surfaces of STEP files, with their first derivatives. Lengths are in mm, angles in rad, in the frame of the file.

use super::curve::StepCurve;
use super::placement::StepPlacement;
use super::spline::{SplineKnots, projected};
use nalgebra::{Matrix2, Point3, Rotation3, Unit, Vector2, Vector3, Vector4};

/// Distance of a point from a surface at which it lies on it, mm: the search for its parameters ends there.
const ON_SURFACE: f64 = 1e-10;

/// Both ends of a parameter of a closed surface are one within this distance, mm.
const CLOSED: f64 = 1e-3;

/// Steps of the search for the parameters of a point.
const MAX_PARAMETER_STEPS: usize = 40;

/// A surface by two parameters.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum StepSurface {
    /// A plane: its placement.
    Plane(StepPlacement),
    /// A cylinder or cone: its placement, its radius at the origin, mm, and the tangent of half of its opening angle.
    Cone(StepPlacement, f64, f64),
    /// A torus: its placement, its radius and that of its tube, mm. The first is zero for a sphere.
    Torus(StepPlacement, f64, f64),
    /// A curve turned about the Z axis of a placement.
    Revolution(StepPlacement, StepCurve),
    /// A curve moved along a way, mm.
    Extrusion(StepCurve, Vector3<f64>),
    /// A spline by its homogeneous control points, row after row of equal u.
    Spline([SplineKnots; 2], Vec<Vector4<f64>>, usize),
}

/// The point of a surface that is nearest to a point: its parameters, and the distance, mm.
#[derive(Clone, Copy)]
pub(super) struct SurfaceFoot {
    pub(super) place: [f64; 2],
    pub(super) far: f64,
}

/// A point of a surface with its derivatives by both parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SurfaceJet {
    pub(super) point: Point3<f64>,
    pub(super) by: [Vector3<f64>; 2],
}

impl SurfaceJet {
    /// Unit normal; `None` where the surface has no area.
    pub(super) fn normal(&self) -> Option<Vector3<f64>> {
        self.by[0].cross(&self.by[1]).try_normalize(1e-12)
    }
}

impl StepSurface {
    /// Point and first derivatives.
    pub(super) fn at(&self, [u, v]: [f64; 2]) -> SurfaceJet {
        let (sin, cos) = libm::sincos(u);
        match self {
            Self::Plane(frame) => {
                let [x, y, _] = frame.axes;
                SurfaceJet { point: frame.origin + x * u + y * v, by: [x, y] }
            }
            Self::Cone(frame, radius, slope) => {
                let [x, y, z] = frame.axes;
                let out = x * cos + y * sin;
                let r = radius + v * slope;
                SurfaceJet { point: frame.origin + out * r + z * v, by: [(y * cos - x * sin) * r, out * *slope + z] }
            }
            Self::Torus(frame, radius, tube) => {
                let [x, y, z] = frame.axes;
                let out = x * cos + y * sin;
                let (up, along) = libm::sincos(v);
                let r = radius + tube * along;
                SurfaceJet {
                    point: frame.origin + out * r + z * (tube * up),
                    by: [(y * cos - x * sin) * r, (z * along - out * up) * *tube],
                }
            }
            Self::Revolution(frame, curve) => {
                let axis = frame.axes[2];
                let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(axis), u);
                let (point, slope) = curve.at(v);
                let offset = turn * (point - frame.origin);
                SurfaceJet { point: frame.origin + offset, by: [axis.cross(&offset), turn * slope] }
            }
            Self::Extrusion(curve, way) => {
                let (point, slope) = curve.at(u);
                SurfaceJet { point: point + way * v, by: [slope, *way] }
            }
            Self::Spline(knots, control, columns) => {
                let [along, across] = [knots[0].at(u), knots[1].at(v)];
                let mut sums = [Vector4::zeros(); 3];
                for (a, (value, slope)) in along.values.iter().zip(&along.slopes).enumerate() {
                    let start = (along.first + a) * columns + across.first;
                    let row = || control[start..].iter();
                    let of = |w: &[f64]| -> Vector4<f64> { row().zip(w).map(|(c, w)| c * *w).sum() };
                    let (at, by_v) = (of(&across.values), of(&across.slopes));
                    sums[0] += at * *value;
                    sums[1] += at * *slope;
                    sums[2] += by_v * *value;
                }
                let (point, by) = projected(sums[0], [sums[1], sums[2]]);
                SurfaceJet { point, by }
            }
        }
    }

    /// Ends of both parameters, where a parameter has ends.
    fn domains(&self) -> [Option<[f64; 2]>; 2] {
        let angle = Some([0.0, std::f64::consts::TAU]);
        match self {
            Self::Plane(_) => [None, None],
            Self::Cone(..) => [angle, None],
            Self::Torus(..) => [angle, angle],
            Self::Revolution(_, curve) => [angle, curve.domain()],
            Self::Extrusion(curve, _) => [curve.domain(), None],
            Self::Spline(knots, ..) => [Some(knots[0].domain()), Some(knots[1].domain())],
        }
    }

    /// Length of a parameter after which the surface comes back to the same points; `None` where it does not.
    pub(super) fn period(&self, k: usize) -> Option<f64> {
        let [lo, hi] = self.domains()[k]?;
        let closed = match self {
            // Decided at the middle of the other parameter.
            Self::Spline(knots, ..) => {
                let other = knots[1 - k].domain();
                let other = 0.5 * (other[0] + other[1]);
                let at = |x: f64| self.at(if k == 0 { [x, other] } else { [other, x] }).point;
                nalgebra::distance(&at(lo), &at(hi)) < CLOSED
            }
            Self::Revolution(_, curve) if k == 1 => nalgebra::distance(&curve.at(lo).0, &curve.at(hi).0) < CLOSED,
            Self::Extrusion(curve, _) => nalgebra::distance(&curve.at(lo).0, &curve.at(hi).0) < CLOSED,
            _ => true,
        };
        closed.then_some(hi - lo)
    }

    /// The place on the other side of the seam, for a place at the end of a closed spline: a search that comes there goes no further.
    pub(super) fn beyond_seam(&self, mut place: [f64; 2]) -> Option<[f64; 2]> {
        let bounded = match self {
            Self::Spline(..) => [true, true],
            Self::Revolution(_, StepCurve::Spline(..)) => [false, true],
            Self::Extrusion(StepCurve::Spline(..), _) => [true, false],
            _ => [false, false],
        };
        let mut at_seam = false;
        for k in (0..2).filter(|k| bounded[*k]) {
            let Some(([lo, hi], period)) = self.domains()[k].zip(self.period(k)) else { continue };
            let x = place[k];
            at_seam |= x <= lo || x >= hi;
            place[k] = if x <= lo {
                (x + period).min(hi)
            } else if x >= hi {
                (x - period).max(lo)
            } else {
                x
            };
        }
        at_seam.then_some(place)
    }

    /// Point and first derivatives, with a closed parameter that may lie beyond its ends.
    pub(super) fn round(&self, place: [f64; 2]) -> SurfaceJet {
        let back = |k: usize| match (self.period(k), self.domains()[k]) {
            (Some(period), Some([lo, hi])) if !(lo..=hi).contains(&place[k]) => lo + (place[k] - lo).rem_euclid(period),
            _ => place[k],
        };
        self.at([back(0), back(1)])
    }

    /// Places of a parameter at which the surface may have a tip: the ends of a curve or spline, and the radius zero of a cone.
    pub(super) fn tips(&self, k: usize) -> Vec<f64> {
        match self {
            Self::Cone(_, radius, slope) if k == 1 && *slope != 0.0 => vec![-radius / slope],
            Self::Revolution(..) | Self::Spline(..) => self.domains()[k].map_or_else(Vec::new, Vec::from),
            _ => Vec::new(),
        }
    }

    /// Parameters near a point, from a table of places of the surface: where the search begins.
    fn seed(&self, p: &Point3<f64>) -> [f64; 2] {
        /// Places in a direction of a spline, a span, and the most of them.
        const A_SPAN: usize = 4;
        const MOST: usize = 200;
        /// Places along a line whose parameter has no ends: they are found exactly by the first step.
        const WITHOUT_ENDS: usize = 0;
        let count = |k: usize| match self {
            Self::Spline(knots, ..) => (A_SPAN * knots[k].spans()).clamp(12, MOST),
            _ if self.domains()[k].is_none() => WITHOUT_ENDS,
            _ => 48,
        };
        let (counts, domains) = ([count(0), count(1)], self.domains());
        let at =
            |k: usize, i: usize| domains[k].map_or(0.0, |[lo, hi]| lo + (hi - lo) * i as f64 / counts[k].max(1) as f64);
        let places = (0..=counts[0]).flat_map(|i| (0..=counts[1]).map(move |j| (i, j)));
        let mut best = (f64::INFINITY, [0.0, 0.0]);
        for (i, j) in places {
            let place = [at(0, i), at(1, j)];
            let jet = self.at(place);
            let mut way = p - jet.point;
            // Straight lines without ends: the distance from the line.
            if domains[1].is_none() && domains[0].is_some() {
                let line = jet.by[1];
                way -= line * (way.dot(&line) / line.norm_squared());
            }
            let far = way.norm_squared();
            if far < best.0 {
                best = (far, place);
            }
        }
        best.1
    }

    /// The point of the surface that is nearest to a point. The search begins at `near`, or
    /// at the nearest of a table of places. Splines are searched within their domain and a little beyond.
    pub(super) fn nearest(&self, p: &Point3<f64>, near: Option<[f64; 2]>) -> SurfaceFoot {
        /// Share of the domain by which a border may lie beyond it.
        const DOMAIN_MARGIN: f64 = 1e-3;
        let bounded = |k: usize, x: f64| match (self, self.domains()[k]) {
            (Self::Spline(..), Some([lo, hi])) => {
                x.clamp(lo - DOMAIN_MARGIN * (hi - lo), hi + DOMAIN_MARGIN * (hi - lo))
            }
            (Self::Revolution(_, StepCurve::Spline(..)), Some([lo, hi])) if k == 1 => x.clamp(lo, hi),
            (Self::Extrusion(StepCurve::Spline(..), _), Some([lo, hi])) if k == 0 => x.clamp(lo, hi),
            _ => x,
        };
        let mut place = near.unwrap_or_else(|| self.seed(p));
        let mut far = (p - self.at(place).point).norm();
        for _ in 0..MAX_PARAMETER_STEPS {
            if far < ON_SURFACE {
                break;
            }
            let jet = self.at(place);
            let way = p - jet.point;
            let [a, b] = jet.by;
            let normal = Matrix2::new(a.norm_squared(), a.dot(&b), a.dot(&b), b.norm_squared());
            let Some(step) = normal.try_inverse().map(|inverse| inverse * Vector2::new(way.dot(&a), way.dot(&b)))
            else {
                break;
            };
            let mut share = 1.0;
            let before = far;
            while share > 1e-3 {
                let next = [bounded(0, place[0] + share * step.x), bounded(1, place[1] + share * step.y)];
                let distance = (p - self.at(next).point).norm();
                if distance < far {
                    (place, far) = (next, distance);
                    break;
                }
                share *= 0.5;
            }
            if before - far < 1e-3 * ON_SURFACE {
                break;
            }
        }
        SurfaceFoot { place, far }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector4;

    fn frame() -> StepPlacement {
        let z = Vector3::new(1.0, 2.0, 2.0) / 3.0;
        let x = Vector3::new(2.0, 1.0, -2.0) / 3.0;
        StepPlacement { origin: Point3::new(1.0, -2.0, 3.0), axes: [x, z.cross(&x), z] }
    }

    fn all() -> Vec<StepSurface> {
        let knots = |degree: usize, count: usize| {
            let inside = count - degree - 1;
            let multiplicities: Vec<usize> =
                std::iter::once(degree + 1).chain(vec![1; inside]).chain(std::iter::once(degree + 1)).collect();
            let values: Vec<f64> = (0..multiplicities.len()).map(|k| k as f64).collect();
            SplineKnots::new(degree, &multiplicities, &values, count).expect("knots")
        };
        let point = |i: usize, j: usize| {
            let (x, y) = (i as f64, j as f64);
            let w = 1.0 + 0.1 * ((3 * i + 5 * j) % 4) as f64;
            Vector4::new(x * w, y * w, (0.3 * x * y + (x - y).sin()) * w, w)
        };
        let control: Vec<Vector4<f64>> = (0..6).flat_map(|i| (0..5).map(move |j| point(i, j))).collect();
        let curve = StepCurve::Spline(knots(4, 6), (0..6).map(|i| point(i, 2 * i % 5)).collect());
        vec![
            StepSurface::Plane(frame()),
            StepSurface::Cone(frame(), 5.0, 0.0),
            StepSurface::Cone(frame(), 5.0, 0.4),
            StepSurface::Torus(frame(), 0.0, 5.0),
            StepSurface::Torus(frame(), 9.0, 2.0),
            StepSurface::Revolution(frame(), StepCurve::Ellipse(frame(), [3.0, 2.0])),
            StepSurface::Revolution(frame(), curve.clone()),
            StepSurface::Extrusion(curve, Vector3::new(0.1, 2.0, 5.0)),
            StepSurface::Spline([knots(5, 6), knots(2, 5)], control, 5),
        ]
    }

    /// Derivatives agree with differences, and the nearest place of a point of the surface is this point.
    #[test]
    fn derivatives_and_nearest_places_are_those_of_differences() {
        for surface in all() {
            let at = |place: [f64; 2]| surface.at(place);
            for place in [[0.3, 0.4], [0.7, 0.9], [0.95, 0.2]] {
                let step = 1e-6;
                for k in 0..2 {
                    let moved = |by: f64| at(std::array::from_fn(|i| place[i] + if i == k { by } else { 0.0 })).point;
                    let difference = (moved(step) - moved(-step)) / (2.0 * step);
                    let off = (difference - at(place).by[k]).norm();
                    assert!(off < 1e-6 * (1.0 + difference.norm()), "{surface:?} {place:?} {off}");
                }
                let p = at(place).point;
                let SurfaceFoot { place: found, far } = surface.nearest(&p, None);
                assert!(far < 1e-8 && nalgebra::distance(&at(found).point, &p) < 1e-8, "{surface:?} {place:?} {far}");
            }
        }
    }

    /// Cylinder, cone, sphere and torus have the distances from axis and middle that their numbers say; a rational quadratic
    /// arc turned about an axis is a sphere.
    #[test]
    fn known_shapes_have_their_radii() {
        let frame = frame();
        let split = |p: Point3<f64>| {
            let way = p - frame.origin;
            let z = way.dot(&frame.axes[2]);
            [(way - frame.axes[2] * z).norm(), z]
        };
        for k in 0..30 {
            let place = [0.2 * f64::from(k), 0.13 * f64::from(k) - 1.0];
            let of = |surface: StepSurface| split(surface.at(place).point);
            assert!((of(StepSurface::Cone(frame, 5.0, 0.0))[0] - 5.0).abs() < 1e-12);
            let [r, z] = of(StepSurface::Cone(frame, 5.0, 0.4));
            assert!((r - 5.0 - 0.4 * z).abs() < 1e-12);
            let [r, z] = of(StepSurface::Torus(frame, 0.0, 5.0));
            assert!((r.hypot(z) - 5.0).abs() < 1e-12);
            let [r, z] = of(StepSurface::Torus(frame, 9.0, 2.0));
            assert!(((r - 9.0).hypot(z) - 2.0).abs() < 1e-12);
        }
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let at = |x: f64, z: f64, w: f64| (frame.origin.coords + frame.axes[0] * x + frame.axes[2] * z).push(1.0) * w;
        let knots = SplineKnots::new(2, &[3, 3], &[0.0, 1.0], 3).expect("knots");
        let arc = StepCurve::Spline(knots, vec![at(4.0, 0.0, 1.0), at(4.0, 4.0, half), at(0.0, 4.0, 1.0)]);
        let sphere = StepSurface::Revolution(frame, arc);
        for k in 0..20 {
            let [r, z] = split(sphere.at([0.3 * f64::from(k), f64::from(k) / 20.0]).point);
            assert!((r.hypot(z) - 4.0).abs() < 1e-12, "{r} {z}");
        }
    }
}
