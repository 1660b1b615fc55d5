//! The camber surface of a blade: theta over the way from the leading to the trailing edge, and over the span.
//!
//! Theta is the angle about +Z. Beta is the angle of the camber line to the meridian, on its surface of revolution:
//! tan(beta) = r dtheta / dm, where m is the length along the meridian. It is positive where theta grows from the leading to the
//! trailing edge.

use super::distribution::{Distribution, HermiteTable, weights};
use super::meridional::MeridionalPatch;
use nurbs::quadrature::integral;

/// Largest camber angle, rad: 89 deg. A camber line round the axis has no length along the meridian.
pub const MAX_CAMBER_ANGLE: f64 = 89.0 * std::f64::consts::PI / 180.0;

/// Largest error of an integrated theta from one node of its table to the next, rad: 1e-9 mm at a radius of 100 mm.
const THETA_ERROR_RAD: f64 = 1e-11;

/// Cells of a table of theta, at first and at most.
const CELLS: [usize; 2] = [64, 4096];

/// Angles of a camber line, by the share of the way from the leading (0) to the trailing edge (1).
#[derive(Clone, Debug)]
pub enum CamberAngles {
    /// Theta, rad.
    Theta(Distribution),
    /// Beta, rad, and theta at one end.
    Beta {
        /// Beta, rad.
        beta: Distribution,
        /// The end with a stated theta: 0 for the leading, 1 for the trailing edge.
        end: usize,
        /// Theta there, rad.
        theta: f64,
    },
}

/// A stated camber line.
#[derive(Clone, Debug)]
pub struct CamberRow {
    /// Share of the span from hub (0) to shroud (1).
    pub span: f64,
    /// Its angles.
    pub angles: CamberAngles,
}

#[derive(Clone, Debug)]
enum Theta {
    Stated(Distribution),
    Integrated(HermiteTable<1>),
}

impl Theta {
    /// Theta and its derivative by the share of the way.
    fn at(&self, x: f64) -> [f64; 2] {
        match self {
            Self::Stated(theta) => theta.on_tangent(x),
            Self::Integrated(table) => {
                let ([theta], [slope]) = table.at(x);
                [theta, slope]
            }
        }
    }
}

/// Where a camber line is too steep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteepCamber {
    /// Index of the line in the list.
    pub row: usize,
    /// Share of the way from the leading to the trailing edge.
    pub way: f64,
    /// Its beta there, rad.
    pub beta: f64,
}

/// A camber surface: stated lines, and between them the spline of theta over the span.
#[derive(Clone, Debug)]
pub struct CamberSurface {
    patch: MeridionalPatch,
    spans: Vec<f64>,
    rows: Vec<Theta>,
    lean: Distribution,
}

impl CamberSurface {
    /// The surface through camber lines, whose spans ascend from 0 to 1, or one for all spans. `lean` turns each section, rad.
    ///
    /// # Errors
    /// Where a camber line is steeper than [`MAX_CAMBER_ANGLE`].
    pub fn new(patch: MeridionalPatch, given: &[CamberRow], lean: Distribution) -> Result<Self, SteepCamber> {
        let theta = |(k, row): (usize, &CamberRow)| match &row.angles {
            CamberAngles::Theta(theta) => match steep(&patch, row.span, theta) {
                Some(steep) => Err(SteepCamber { row: k, ..steep }),
                None => Ok(Theta::Stated(theta.clone())),
            },
            CamberAngles::Beta { beta, end, theta } => integrated(&patch, row.span, beta)
                .map(|table| Theta::Integrated(from(&table, *end, *theta)))
                .map_err(|steep| SteepCamber { row: k, ..steep }),
        };
        let rows = given.iter().enumerate().map(theta).collect::<Result<_, _>>()?;
        Ok(Self { spans: given.iter().map(|row| row.span).collect(), rows, patch, lean })
    }

    /// The meridional surface on which it lies.
    pub fn patch(&self) -> &MeridionalPatch {
        &self.patch
    }

    /// Angle about +Z at a share of the way and a share of the span, rad.
    pub fn theta(&self, way: f64, span: f64) -> f64 {
        self.line(span).at(way).theta
    }

    /// The camber line at a share of the span.
    pub(super) fn line(&self, span: f64) -> CamberLine<'_> {
        // The spans are checked where the surface is made.
        let weights = weights(&self.spans, span).unwrap_or_default();
        CamberLine { surface: self, span, weights, lean: self.lean.at(span) }
    }
}

/// Where a line of stated theta is too steep.
fn steep(patch: &MeridionalPatch, span: f64, theta: &Distribution) -> Option<SteepCamber> {
    /// Number of intervals of the samples.
    const CAMBER_PLACES: u32 = 256;
    let beta = |x: f64| {
        let ([r, _], [dr, dz]) = patch.at(x, span);
        libm::atan2(r * theta.on_tangent(x)[1], libm::hypot(dr, dz))
    };
    let places = (0..=CAMBER_PLACES).map(|k| f64::from(k) / f64::from(CAMBER_PLACES));
    places.map(|way| SteepCamber { row: 0, way, beta: beta(way) }).find(|at| at.beta.abs() > MAX_CAMBER_ANGLE)
}

/// The table of the integral of tan(beta) / r along the meridian, from the leading edge.
fn integrated(patch: &MeridionalPatch, span: f64, beta: &Distribution) -> Result<HermiteTable<1>, SteepCamber> {
    let slope = |x: f64| {
        let ([r, _], [dr, dz]) = patch.at(x, span);
        libm::tan(beta.at(x)) * libm::hypot(dr, dz) / r
    };
    let mut cells = CELLS[0];
    loop {
        let x = |k: usize| k as f64 / cells as f64;
        if let Some(k) = (0..=cells).find(|k| beta.at(x(*k)).abs() > MAX_CAMBER_ANGLE) {
            return Err(SteepCamber { row: 0, way: x(k), beta: beta.at(x(k)) });
        }
        let mut nodes = vec![([0.0], [slope(0.0)])];
        let (mut sum, mut worst) = (0.0, 0.0_f64);
        for k in 0..cells {
            let (from, to) = (x(k), x(k + 1));
            let middle = 0.5 * (from + to);
            let halves = [integral(from, middle, &slope), integral(middle, to, &slope)];
            let before = sum;
            sum += halves[0] + halves[1];
            nodes.push(([sum], [slope(to)]));
            worst = worst.max((integral(from, to, &slope) - halves[0] - halves[1]).abs());
            let pair = HermiteTable::new(to - from, nodes[k..].to_vec());
            worst = worst.max((pair.at(middle - from).0[0] - before - halves[0]).abs());
        }
        if worst <= THETA_ERROR_RAD || cells >= CELLS[1] {
            return Ok(HermiteTable::new(1.0 / cells as f64, nodes));
        }
        cells *= 2;
    }
}

/// A table moved so that it has a value at its first (0) or last (1) node.
fn from(table: &HermiteTable<1>, end: usize, value: f64) -> HermiteTable<1> {
    let by = value - table.at(end as f64).0[0];
    table.moved([by])
}

/// A place of a camber line.
#[derive(Clone, Copy, Debug)]
pub(super) struct CamberPoint {
    /// Radius, mm.
    pub(super) r: f64,
    /// Length along the meridian by the share of the way, mm.
    pub(super) dm: f64,
    /// Angle about +Z, rad.
    pub(super) theta: f64,
    /// Angle to the meridian, rad.
    pub(super) beta: f64,
}

impl CamberPoint {
    /// Length of the camber line by the share of the way, mm.
    pub(super) fn speed(&self) -> f64 {
        self.dm / libm::cos(self.beta)
    }
}

/// The camber line at a share of the span.
#[derive(Clone, Debug)]
pub(super) struct CamberLine<'a> {
    surface: &'a CamberSurface,
    pub(super) span: f64,
    weights: Vec<f64>,
    lean: f64,
}

impl CamberLine<'_> {
    /// The place at a share of the way. Beyond the edges the line goes on with the beta that it has there.
    pub(super) fn at(&self, x: f64) -> CamberPoint {
        let inside = x.clamp(0.0, 1.0);
        let end = self.at_inside(inside);
        if x == inside {
            return end;
        }
        let metric = |x: f64| {
            let ([r, _], [dr, dz]) = self.surface.patch.at(x, self.span);
            [r, libm::hypot(dr, dz)]
        };
        let ratio = |x: f64| {
            let [r, dm] = metric(x);
            dm / r
        };
        let [r, dm] = metric(x);
        let theta = end.theta + libm::tan(end.beta) * integral(inside, x, &ratio);
        CamberPoint { r, dm, theta, beta: end.beta }
    }

    fn at_inside(&self, x: f64) -> CamberPoint {
        let ([r, _], [dr, dz]) = self.surface.patch.at(x, self.span);
        let mut sum = [self.lean, 0.0];
        for (row, weight) in self.surface.rows.iter().zip(&self.weights) {
            let [theta, slope] = row.at(x);
            sum = [sum[0] + weight * theta, sum[1] + weight * slope];
        }
        let dm = libm::hypot(dr, dz);
        CamberPoint { r, dm, theta: sum[0], beta: libm::atan2(r * sum[1], dm) }
    }

    /// Length of the camber line between two shares of the way, mm.
    pub(super) fn length(&self, from: f64, to: f64) -> f64 {
        /// Pieces over the whole way.
        const CAMBER_PIECES: f64 = 32.0;
        let pieces = ((to - from).abs() * CAMBER_PIECES).ceil().max(1.0);
        let at = |k: f64| from + (to - from) * k / pieces;
        let speed = |x: f64| self.at(x).speed();
        (0..pieces as usize).map(|k| integral(at(k as f64), at(k as f64 + 1.0), &speed)).sum()
    }

    /// The share of the way and theta at a distance from a place of the line, mm, on the straightest line of the surface of
    /// revolution that leaves the camber line at a right angle: towards greater theta for a positive distance.
    ///
    /// Such a line keeps r sin(psi), where psi is its angle to the meridian (Clairaut). Runge-Kutta of order 4.
    pub(super) fn across(&self, x: f64, distance: f64) -> [f64; 2] {
        /// Steps over the distance. For half a thickness of a tenth of the radius the error is below 1e-8 of it.
        const OFFSET_STEPS: u32 = 4;
        let start = self.at(x);
        let turn = |[x, _, psi]: [f64; 3]| {
            let ([r, _], [dr, dz]) = self.surface.patch.at(x, self.span);
            let dm = libm::hypot(dr, dz);
            let (sin, cos) = libm::sincos(psi);
            [cos / dm, sin / r, -sin * dr / (dm * r)]
        };
        let h = distance / f64::from(OFFSET_STEPS);
        let mut at = [x, start.theta, start.beta + std::f64::consts::FRAC_PI_2];
        let ahead = |at: [f64; 3], by: [f64; 3], h: f64| [0, 1, 2].map(|i| at[i] + h * by[i]);
        for _ in 0..OFFSET_STEPS {
            let a = turn(at);
            let b = turn(ahead(at, a, 0.5 * h));
            let c = turn(ahead(at, b, 0.5 * h));
            let d = turn(ahead(at, c, h));
            at = [0, 1, 2].map(|i| at[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        [at[0], at[1]]
    }

    /// Radius and height at a share of the way.
    pub(super) fn meridian(&self, x: f64) -> [f64; 2] {
        self.surface.patch.at(x, self.span).0
    }
}

#[cfg(test)]
mod tests {
    use super::super::meridional::{EdgeLine, MeridianByLength};
    use super::*;
    use nalgebra::Point3;
    use nurbs::interpolate;

    fn meridian(ends: [[f64; 2]; 2]) -> MeridianByLength {
        let points = ends.map(|[r, z]| Point3::new(r, 0.0, z));
        MeridianByLength::new(&interpolate(&points, 1).unwrap()).unwrap()
    }

    fn between(hub: [[f64; 2]; 2], shroud: [[f64; 2]; 2]) -> MeridionalPatch {
        let ends = [hub, shroud].map(meridian);
        let edges = [EdgeLine::straight([0.0; 2]), EdgeLine::straight(ends.each_ref().map(MeridianByLength::length))];
        MeridionalPatch::new(ends, edges)
    }

    fn constant(patch: MeridionalPatch, beta: f64, end: usize, theta: f64) -> CamberSurface {
        let angles = CamberAngles::Beta { beta: Distribution::constant(beta), end, theta };
        CamberSurface::new(patch, &[CamberRow { span: 0.0, angles }], Distribution::constant(0.0)).unwrap()
    }

    /// On a cylinder a line of constant beta is a helix: theta = tan(beta) m / r.
    #[test]
    fn a_cylinder_has_a_helix() {
        let beta = 0.7;
        let surface = constant(between([[20.0, 0.0], [20.0, -30.0]], [[40.0, 0.0], [40.0, -30.0]]), beta, 0, 0.25);
        for k in 0..=30 {
            let x = f64::from(k) / 30.0;
            let at = surface.line(0.0).at(x);
            assert!((at.theta - 0.25 - libm::tan(beta) * 30.0 * x / 20.0).abs() < 1e-10);
            assert!((at.beta - beta).abs() < 1e-9);
        }
    }

    /// On a cone that opens by phi a line of constant beta is a logarithmic spiral: theta = tan(beta) / sin(phi) ln(r / r0).
    #[test]
    fn a_cone_has_a_logarithmic_spiral() {
        let beta: f64 = -1.1;
        let surface = constant(between([[4.0, 0.0], [34.0, -40.0]], [[14.0, 0.0], [44.0, -40.0]]), beta, 1, 0.0);
        let theta = |r: f64| libm::tan(beta) / 0.6 * libm::log(r / 34.0);
        for k in 0..=30 {
            let x = f64::from(k) / 30.0;
            let at = surface.line(0.0).at(x);
            assert!((at.theta - theta(at.r)).abs() < 1e-9, "{}", at.theta - theta(at.r));
            assert!((at.beta - beta).abs() < 1e-8);
            // The length of the spiral is that of the meridian over the cosine.
            let off = surface.line(0.0).length(0.0, x) - 50.0 * x / libm::cos(beta);
            assert!(off.abs() < 1e-7, "{off}");
        }
    }

    /// On a plane, the straightest line across a radial camber line is a chord: r^2 = r0^2 + d^2, tan(theta) = d / r0.
    #[test]
    fn across_a_radial_line_on_a_plane_goes_a_straight_line() {
        let surface = constant(between([[5.0, -10.0], [25.0, -10.0]], [[5.0, 0.0], [25.0, 0.0]]), 0.0, 0, 0.0);
        for distance in [-1.5, -0.2, 0.7, 1.5] {
            let line = surface.line(0.0);
            let [x, theta] = line.across(0.25, distance);
            assert!((line.meridian(x)[0] - libm::hypot(10.0, distance)).abs() < 1e-7);
            assert!((theta - libm::atan(distance / 10.0)).abs() < 1e-7);
        }
    }

    #[test]
    fn a_steep_line_is_refused_where_it_is() {
        let beta = Distribution::through(&[[0.0, 1.5], [0.5, 1.552], [1.0, 1.5]]).unwrap();
        let rows = [0.0, 1.0].map(|span| {
            let beta = if span == 0.0 { Distribution::constant(0.1) } else { beta.clone() };
            CamberRow { span, angles: CamberAngles::Beta { beta, end: 0, theta: 0.0 } }
        });
        let patch = || between([[20.0, 0.0], [20.0, -30.0]], [[40.0, 0.0], [40.0, -30.0]]);
        let lean = || Distribution::constant(0.0);
        assert!(CamberSurface::new(patch(), &rows, lean()).is_ok());
        let over = Distribution::through(&[[0.0, 1.5], [0.4, 1.552], [0.6, 1.552], [1.0, 1.5]]).unwrap();
        let [low, mut high] = rows;
        high.angles = CamberAngles::Beta { beta: over, end: 0, theta: 0.0 };
        let SteepCamber { row, way, beta } = CamberSurface::new(patch(), &[low, high], lean()).err().unwrap();
        assert!(row == 1 && way > 0.4 && way < 0.6 && beta > MAX_CAMBER_ANGLE);
    }
}
