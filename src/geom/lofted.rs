//! Lofted surfaces: curves on equal parameters, joined by a spline across them.

use super::basis::{self, MAX_DEGREE};
use super::interpolate::averaged_knots;
use super::proximity::{Patch, Projection};
use super::{GeomError, NurbsCurve, SurfaceDerivatives};
use nalgebra::{DMatrix, Point3, Vector3};

/// S(u, v) = sum over k of `L_k(v)` `C_k(u)`. The `C_k` are the sections at the places `v_k`. The `L_k` are splines of
/// degree 3 (lower for fewer than four sections) that are 1 at `v_k` and 0 at all other places.
///
/// With two sections this is a ruled surface.
#[derive(Clone, Debug, PartialEq)]
pub struct LoftedSurface {
    sections: Vec<NurbsCurve>,
    /// Parameters of the sections, from 0 to 1.
    places: Vec<f64>,
    degree: usize,
    knots: Vec<f64>,
    /// Control values of the splines: entry (j, k) is the weight of section k in control point j.
    weights: DMatrix<f64>,
}

/// Mean distance below which two sections count as coincident, mm.
const SAME_SECTION: f64 = 1e-5;

/// Stations along a section at which its distance to the next section is measured.
const STATIONS: u32 = 16;

impl LoftedSurface {
    /// The surface through sections, the first at v = 0 and the last at v = 1. The places between them follow the mean
    /// distances of neighbouring sections.
    ///
    /// # Errors
    /// Fewer than two sections, or coincident neighbours.
    pub fn through(sections: Vec<NurbsCurve>) -> Result<Self, GeomError> {
        let count = sections.len();
        if count < 2 {
            return Err(GeomError::TooFewPoints { given: count, needed: 2 });
        }
        let mut places = vec![0.0];
        let mut sum = 0.0;
        for (k, pair) in sections.windows(2).enumerate() {
            let apart = (0..=STATIONS).map(|i| f64::from(i) / f64::from(STATIONS));
            let mean =
                apart.map(|u| (pair[1].point(u) - pair[0].point(u)).norm()).sum::<f64>() / f64::from(STATIONS + 1);
            if !(mean > SAME_SECTION && mean.is_finite()) {
                return Err(GeomError::CoincidentPoints(k));
            }
            sum += mean;
            places.push(sum);
        }
        places.iter_mut().for_each(|p| *p /= sum);
        places[count - 1] = 1.0;
        let degree = MAX_DEGREE.min(count - 1);
        let knots = averaged_knots(&places, degree);
        let mut matrix = DMatrix::zeros(count, count);
        for (k, v) in places.iter().enumerate() {
            let basis = basis::evaluate(&knots, degree, *v, 0);
            for j in 0..=degree {
                matrix[(k, basis.first + j)] = basis.values[0][j];
            }
        }
        let weights = matrix.try_inverse().ok_or(GeomError::Singular)?;
        Ok(Self { sections, places, degree, knots, weights })
    }

    /// The sections, from v = 0 to v = 1.
    pub fn sections(&self) -> &[NurbsCurve] {
        &self.sections
    }

    /// Parameters of the sections.
    pub fn places(&self) -> &[f64] {
        &self.places
    }

    /// Values of the spline of section k with first and second derivatives; linear outside of [0, 1].
    fn spline(&self, v: f64) -> impl Fn(usize) -> [f64; 3] + '_ {
        let inside = v.clamp(0.0, 1.0);
        let basis = basis::evaluate(&self.knots, self.degree, inside, 2.min(self.degree));
        move |k| {
            let at = |order: usize| -> f64 {
                let values = if order > self.degree { return 0.0 } else { &basis.values[order] };
                (0..=self.degree).map(|j| values[j] * self.weights[(basis.first + j, k)]).sum()
            };
            let (value, first) = (at(0), at(1));
            if inside == v { [value, first, at(2)] } else { [value + first * (v - inside), first, 0.0] }
        }
    }

    /// Point with first and second derivatives. Outside of u in [0, 1] the sections continue along their tangents;
    /// outside of v in [0, 1] the surface continues straight.
    pub fn derivatives(&self, u: f64, v: f64) -> SurfaceDerivatives {
        let spline = self.spline(v);
        let zero = Vector3::zeros();
        let mut at =
            SurfaceDerivatives { point: Point3::origin(), su: zero, sv: zero, suu: zero, suv: zero, svv: zero };
        for (k, section) in self.sections.iter().enumerate() {
            let [value, first, second] = spline(k);
            let c = section.derivatives_extended(u);
            at.point += c.point.coords * value;
            at.su += c.first * value;
            at.sv += c.point.coords * first;
            at.suu += c.second * value;
            at.suv += c.first * first;
            at.svv += c.point.coords * second;
        }
        at
    }

    /// The surface turned about Z (Wei 18).
    #[must_use]
    pub fn rotated(&self, angle: f64) -> Self {
        Self { sections: self.sections.iter().map(|c| c.rotated(angle)).collect(), ..self.clone() }
    }

    /// Closest point of a patch: distances on a grid, then Newton's method from each local minimum of the grid, inside
    /// the patch.
    pub fn closest(&self, p: &Point3<f64>, patch: Patch) -> Projection {
        /// Seeds along u, as for ruled surfaces.
        const ALONG: usize = 48;
        /// Seeds between two sections.
        const BETWEEN: usize = 4;
        let across = BETWEEN * (self.sections.len() - 1);
        let at = |range: [f64; 2], i: usize, n: usize| range[0] + (range[1] - range[0]) * i as f64 / n as f64;
        // Sections at each u, and their weights at each v, are computed once.
        let rows: Vec<Vec<f64>> = (0..=across)
            .map(|j| {
                let spline = self.spline(at(patch.v, j, across));
                (0..self.sections.len()).map(|k| spline(k)[0]).collect()
            })
            .collect();
        let column = |i: usize| -> Vec<f64> {
            let u = at(patch.u, i, ALONG);
            let points: Vec<_> = self.sections.iter().map(|c| c.derivatives_extended(u).point.coords).collect();
            let distance = |row: &Vec<f64>| {
                let point: Vector3<f64> = points.iter().zip(row).map(|(c, weight)| c * *weight).sum();
                (point - p.coords).norm()
            };
            rows.iter().map(distance).collect()
        };
        let seeds: Vec<Vec<f64>> = (0..=ALONG).map(column).collect();
        let mut best: Option<Projection> = None;
        for i in 0..=ALONG {
            for j in 0..=across {
                let around = (i.saturating_sub(1)..=(i + 1).min(ALONG))
                    .flat_map(|a| (j.saturating_sub(1)..=(j + 1).min(across)).map(move |b| (a, b)));
                if around.into_iter().any(|(a, b)| seeds[a][b] < seeds[i][j]) {
                    continue;
                }
                let found = self.refine(p, [at(patch.u, i, ALONG), at(patch.v, j, across)], patch);
                if best.is_none_or(|b| found.distance < b.distance) {
                    best = Some(found);
                }
            }
        }
        best.unwrap_or_else(|| self.projection(p, [patch.u[0], patch.v[0]]))
    }

    fn projection(&self, p: &Point3<f64>, [u, v]: [f64; 2]) -> Projection {
        let point = self.derivatives(u, v).point;
        Projection { u, v, point, distance: (p - point).norm() }
    }

    /// Newton's method on half the squared distance; Gauss-Newton where its matrix has no minimum. Steps that do not
    /// reduce the distance are halved.
    fn refine(&self, p: &Point3<f64>, start: [f64; 2], patch: Patch) -> Projection {
        /// Largest number of steps; from a seed about six are enough.
        const STEPS: usize = 40;
        let mut best = self.projection(p, start);
        for _ in 0..STEPS {
            let s = self.derivatives(best.u, best.v);
            let gap = s.point - p;
            let (gu, gv) = (gap.dot(&s.su), gap.dot(&s.sv));
            let gauss = [s.su.norm_squared(), s.su.dot(&s.sv), s.sv.norm_squared()];
            let full = [gauss[0] + gap.dot(&s.suu), gauss[1] + gap.dot(&s.suv), gauss[2] + gap.dot(&s.svv)];
            // At a border of the patch only the other parameter moves.
            let held = |x: f64, range: [f64; 2], g: f64| (x <= range[0] && g > 0.0) || (x >= range[1] && g < 0.0);
            let (u_held, v_held) = (held(best.u, patch.u, gu), held(best.v, patch.v, gv));
            let step = |[a, b, c]: [f64; 3]| match (u_held, v_held) {
                (true, true) => Some([0.0, 0.0]),
                (true, false) => (c > 0.0).then(|| [0.0, -gv / c]),
                (false, true) => (a > 0.0).then(|| [-gu / a, 0.0]),
                (false, false) => {
                    let det = a * c - b * b;
                    (a > 0.0 && det > 0.0).then(|| [(b * gv - c * gu) / det, (b * gu - a * gv) / det])
                }
            };
            let Some(step) = step(full).or_else(|| step(gauss)) else { break };
            let mut share = 1.0;
            let nearer = loop {
                let u = (best.u + step[0] * share).clamp(patch.u[0], patch.u[1]);
                let v = (best.v + step[1] * share).clamp(patch.v[0], patch.v[1]);
                let next = self.projection(p, [u, v]);
                if next.distance < best.distance {
                    break Some(next);
                }
                share *= 0.5;
                if share < 1e-3 {
                    break None;
                }
            };
            let Some(nearer) = nearer else { break };
            best = nearer;
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{RuledSurface, interpolate};

    /// An arc about Z from one azimuth to another.
    fn arc(radius: f64, z: f64, from: f64) -> NurbsCurve {
        let points: Vec<Point3<f64>> = (0..9)
            .map(|i| from + 0.1 * f64::from(i))
            .map(|a| Point3::new(radius * a.cos(), radius * a.sin(), z))
            .collect();
        interpolate(&points, 3).unwrap()
    }

    fn twisted(count: u32) -> LoftedSurface {
        let at = |k: u32| f64::from(k) / f64::from(count - 1);
        let section = |k| arc(20.0 + 3.0 * at(k) * at(k), 10.0 * at(k), 0.3 * at(k) * at(k));
        LoftedSurface::through((0..count).map(section).collect()).unwrap()
    }

    #[test]
    fn sections_lie_on_the_surface() {
        for count in 2..8 {
            let surface = twisted(count);
            for (section, v) in surface.sections().iter().zip(surface.places()) {
                for i in 0..=20 {
                    let u = f64::from(i) / 20.0;
                    assert!((surface.derivatives(u, *v).point - section.point(u)).norm() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn two_sections_are_ruled() {
        let surface = twisted(2);
        let ruled = RuledSurface { root: surface.sections()[0].clone(), tip: surface.sections()[1].clone() };
        for (u, v) in [(0.0, 0.0), (0.3, 0.7), (1.0, 1.0), (-0.1, 1.2), (1.1, -0.4)] {
            let (a, b) = (surface.derivatives(u, v), ruled.derivatives(u, v));
            assert!((a.point - b.point).norm() < 1e-12 && (a.suv - b.suv).norm() < 1e-11, "{u} {v}");
            assert!((a.su - b.su).norm() < 1e-11 && (a.sv - b.sv).norm() < 1e-11 && (a.suu - b.suu).norm() < 1e-9);
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let surface = twisted(6);
        let h = 1e-5;
        for (u, v) in [(0.2, 0.3), (0.5, 0.9), (0.71, 0.13), (0.4, 1.3), (1.2, 0.5)] {
            let at = |du: f64, dv: f64| surface.derivatives(u + du, v + dv);
            let d = at(0.0, 0.0);
            let close = |a: Vector3<f64>, b: Vector3<f64>| assert!((a - b).norm() < 1e-6 * (1.0 + a.norm()), "{a} {b}");
            close(d.su, (at(h, 0.0).point - at(-h, 0.0).point) / (2.0 * h));
            close(d.sv, (at(0.0, h).point - at(0.0, -h).point) / (2.0 * h));
            close(d.suu, (at(h, 0.0).su - at(-h, 0.0).su) / (2.0 * h));
            close(d.suv, (at(0.0, h).su - at(0.0, -h).su) / (2.0 * h));
            close(d.svv, (at(0.0, h).sv - at(0.0, -h).sv) / (2.0 * h));
        }
    }

    /// No point of a fine grid is nearer than the closest point, and a point moved along the normal returns to its
    /// foot.
    #[test]
    fn closest_points_against_a_grid() {
        let surface = twisted(5);
        let patch = Patch { u: [0.0, 1.0], v: [0.0, 1.0] };
        for k in 0..40 {
            let (u, v) = (0.05 + 0.9 * f64::from(k % 8) / 7.0, 0.05 + 0.9 * f64::from(k / 8) / 4.0);
            let d = surface.derivatives(u, v);
            let p = d.point + d.su.cross(&d.sv).normalize() * 1.5;
            let found = surface.closest(&p, patch);
            assert!((found.distance - 1.5).abs() < 1e-9, "{k} {}", found.distance);
            assert!((found.u - u).abs() < 1e-6 && (found.v - v).abs() < 1e-6);
            let p = Point3::new(f64::from(k) - 20.0, 15.0 - f64::from(k % 11), f64::from(k % 13));
            let found = surface.closest(&p, patch);
            let grid = (0..=200).flat_map(|i| (0..=100).map(move |j| (f64::from(i) / 200.0, f64::from(j) / 100.0)));
            let least = grid.map(|(u, v)| (surface.derivatives(u, v).point - p).norm()).fold(f64::INFINITY, f64::min);
            assert!(found.distance <= least + 1e-12, "{k}: {} {least}", found.distance);
            assert!(found.distance > least - 0.05);
        }
    }

    #[test]
    fn too_few_or_equal_sections() {
        let c = arc(20.0, 0.0, 0.0);
        assert!(matches!(
            LoftedSurface::through(vec![c.clone()]),
            Err(GeomError::TooFewPoints { given: 1, needed: 2 })
        ));
        assert!(matches!(LoftedSurface::through(vec![c.clone(), c]), Err(GeomError::CoincidentPoints(0))));
    }
}
