//! Lofted surfaces: curves on equal parameters, joined by a spline across them.

use super::basis::{self, MAX_DEGREE};
use super::interpolate::averaged_knots;
use super::knots::merge_knots;
use super::proximity::{Patch, Projection};
use super::{GeomError, NurbsCurve, NurbsSurface, SurfaceDerivatives};
use nalgebra::{DMatrix, Point3, Rotation3, Vector3};
use std::borrow::Cow;
use std::sync::OnceLock;

/// S(u, v) = sum over k of `L_k(v)` `C_k(u)`. The `C_k` are the sections at the places `v_k`. The `L_k` are splines of
/// degree 3 (lower for fewer than four sections) that are 1 at `v_k` and 0 at all other places.
///
/// With two sections this is a ruled surface.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "StoredLoft"))]
pub struct LoftedSurface {
    sections: Vec<NurbsCurve>,
    /// Parameters of the sections, from 0 to 1.
    places: Vec<f64>,
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    degree: [usize; 2],
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    knots: [Vec<f64>; 2],
    /// Control points, row after row of equal u.
    control: Vec<Vector3<f64>>,
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    seeds: Seeds,
}

/// Seeds of the whole surface, computed when they are first needed.
#[derive(Clone, Debug, Default)]
struct Seeds(OnceLock<SeedGrid>);

/// Points of a patch from which the search for closest points begins.
#[derive(Clone, Debug)]
struct SeedGrid {
    /// Their coordinates, column after column of equal u.
    coordinates: [Vec<f64>; 3],
    /// Intervals of a column.
    across: usize,
    /// Every point of the patch lies at most this far from a seed, mm.
    reach: f64,
}

/// Seeds follow from the surface: surfaces are equal whether these are computed or not.
impl PartialEq for Seeds {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl SeedGrid {
    /// Squared distances of the seeds from a point.
    fn squares(&self, p: &Point3<f64>) -> Vec<f64> {
        let [x, y, z] = &self.coordinates;
        let square = |((x, y), z): ((&f64, &f64), &f64)| {
            let [x, y, z] = [x - p.x, y - p.y, z - p.z];
            x * x + y * y + z * z
        };
        x.iter().zip(y).zip(z).map(square).collect()
    }
}

/// Seeds along u, as for ruled surfaces.
const U_SEEDS: usize = 48;

/// Seeds between two sections.
const SECTION_SEEDS: usize = 4;

/// Mean distance below which two sections count as coincident, mm.
const SAME_SECTION: f64 = 1e-5;

/// Stations along a section at which its distance to the next section is measured.
const SECTION_STATIONS: u32 = 16;

/// Places of sections from 0 to 1, by the mean distances of neighbours. A section may consist of several curves.
///
/// # Errors
/// Fewer than two sections, or coincident neighbours.
pub fn places(sections: &[Vec<&NurbsCurve>]) -> Result<Vec<f64>, GeomError> {
    if sections.len() < 2 {
        return Err(GeomError::TooFewPoints { given: sections.len(), needed: 2 });
    }
    let mut places = vec![0.0];
    let mut sum = 0.0;
    for (k, pair) in sections.windows(2).enumerate() {
        let mean_distance = |(a, b): (&&NurbsCurve, &&NurbsCurve)| -> f64 {
            let at = (0..=SECTION_STATIONS).map(|i| f64::from(i) / f64::from(SECTION_STATIONS));
            at.map(|u| (b.point(u) - a.point(u)).norm()).sum::<f64>() / f64::from(SECTION_STATIONS + 1)
        };
        let mean = pair[0].iter().zip(&pair[1]).map(mean_distance).sum::<f64>() / pair[0].len().max(1) as f64;
        if !(mean > SAME_SECTION && mean.is_finite()) {
            return Err(GeomError::CoincidentPoints(k));
        }
        sum += mean;
        places.push(sum);
    }
    places.iter_mut().for_each(|p| *p /= sum);
    let last = places.len() - 1;
    places[last] = 1.0;
    Ok(places)
}

/// The end of interval `i` of `n` of a range.
fn between(range: [f64; 2], i: usize, n: usize) -> f64 {
    range[0] + (range[1] - range[0]) * i as f64 / n as f64
}

/// True where the surface does not continue beyond its borders.
fn in_square(u: f64, v: f64) -> bool {
    (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v)
}

impl LoftedSurface {
    /// The surface through sections, the first at v = 0 and the last at v = 1. The places between them follow the mean
    /// distances of neighbouring sections.
    ///
    /// # Errors
    /// Fewer than two sections, or coincident neighbours.
    pub fn through(sections: Vec<NurbsCurve>) -> Result<Self, GeomError> {
        let alone: Vec<Vec<&NurbsCurve>> = sections.iter().map(|c| vec![c]).collect();
        let places = places(&alone)?;
        Self::at(sections, places)
    }

    /// The surface through sections at places, which ascend from 0 to 1.
    ///
    /// # Errors
    /// Fewer than two sections, a rational one, or places that do not ascend.
    pub fn at(sections: Vec<NurbsCurve>, places: Vec<f64>) -> Result<Self, GeomError> {
        let count = sections.len();
        if count < 2 || places.len() != count {
            return Err(GeomError::TooFewPoints { given: count.min(places.len()), needed: 2 });
        }
        if let Some(k) = sections.iter().position(NurbsCurve::is_rational) {
            return Err(GeomError::Weight(k));
        }
        if let Some(k) = places.windows(2).position(|p| p[0] >= p[1]) {
            return Err(GeomError::CoincidentPoints(k));
        }
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
        // All sections on one degree and one knot vector.
        let along = sections.iter().map(NurbsCurve::degree).max().unwrap_or(1);
        let mut same: Vec<NurbsCurve> = sections.clone();
        for curve in &mut same {
            while curve.degree() < along {
                *curve = curve.elevated();
            }
        }
        let merged = same.iter().fold(Vec::new(), |knots, curve| merge_knots(&knots, curve.knots()));
        let same: Vec<NurbsCurve> = same.iter().map(|curve| curve.refined(&merged)).collect();
        let mut control = Vec::with_capacity(count * same[0].control().len());
        for i in 0..same[0].control().len() {
            for j in 0..count {
                control.push((0..count).map(|k| same[k].control()[i].xyz() * weights[(j, k)]).sum());
            }
        }
        Ok(Self { sections, places, degree: [along, degree], knots: [merged, knots], control, seeds: Seeds::default() })
    }

    /// The sections, from v = 0 to v = 1.
    pub fn sections(&self) -> &[NurbsCurve] {
        &self.sections
    }

    /// Parameters of the sections.
    pub fn places(&self) -> &[f64] {
        &self.places
    }

    /// Knots along u and along v.
    pub(super) fn knots(&self) -> [&[f64]; 2] {
        self.knots.each_ref().map(Vec::as_slice)
    }

    /// Degree along u and along v.
    pub(super) fn degree(&self) -> [usize; 2] {
        self.degree
    }

    /// Control points, row after row of equal u.
    #[cfg(feature = "serde")]
    pub(crate) fn control(&self) -> &[Vector3<f64>] {
        &self.control
    }

    /// The surface with control points that are its own to rounding.
    #[cfg(feature = "serde")]
    pub(crate) fn with_control(self, control: Vec<Vector3<f64>>) -> Self {
        Self { control, ..self }
    }

    /// Control point i along u and j along v.
    pub(super) fn control_point(&self, i: usize, j: usize) -> Vector3<f64> {
        self.control[i * self.sections.len() + j]
    }

    /// The same surface as control points on knots.
    pub fn to_surface(&self) -> NurbsSurface {
        let control = self.control.iter().map(|c| c.push(1.0)).collect();
        NurbsSurface::from_homogeneous(self.degree, self.knots.clone(), control)
    }

    /// Sums of the control points with derivatives of the basis, of the first `ORDERS` orders: entry (i, j) has order i in u and
    /// j in v.
    fn sums<const ORDERS: usize>(&self, u: f64, v: f64) -> [[Vector3<f64>; ORDERS]; ORDERS] {
        let basis = |d: usize, t: f64| basis::evaluate(&self.knots[d], self.degree[d], t, ORDERS - 1);
        let [bu, bv] = [basis(0, u), basis(1, v)];
        let columns = self.sections.len();
        let mut sums = [[Vector3::zeros(); ORDERS]; ORDERS];
        for a in 0..=self.degree[0] {
            let start = (bu.first + a) * columns + bv.first;
            let mut row = [Vector3::zeros(); ORDERS];
            for (b, c) in self.control[start..=start + self.degree[1]].iter().enumerate() {
                for (sum, values) in row.iter_mut().zip(&bv.values) {
                    *sum += c * values[b];
                }
            }
            for (by_u, values) in sums.iter_mut().zip(&bu.values) {
                for (sum, r) in by_u.iter_mut().zip(&row) {
                    *sum += r * values[a];
                }
            }
        }
        sums
    }

    /// Point with first and second derivatives. Outside of u in [0, 1] the sections continue along their tangents;
    /// outside of v in [0, 1] the surface continues straight.
    pub fn derivatives(&self, u: f64, v: f64) -> SurfaceDerivatives {
        let inside = [u.clamp(0.0, 1.0), v.clamp(0.0, 1.0)];
        let mut s = self.sums::<3>(inside[0], inside[1]);
        let [du, dv] = [u - inside[0], v - inside[1]];
        if du != 0.0 {
            let [value, first, second] = &mut s;
            for (j, f) in first.iter().enumerate() {
                value[j] += f * du;
                second[j] = Vector3::zeros();
            }
        }
        if dv != 0.0 {
            for [value, first, second] in &mut s {
                *value += *first * dv;
                *second = Vector3::zeros();
            }
        }
        let [[point, sv, svv], [su, suv, _], [suu, _, _]] = s;
        SurfaceDerivatives { point: Point3::from(point), su, sv, suu, suv, svv }
    }

    /// Point, `S_u` and `S_v`, as [`Self::derivatives`].
    pub fn tangents(&self, u: f64, v: f64) -> (Point3<f64>, Vector3<f64>, Vector3<f64>) {
        if !in_square(u, v) {
            let s = self.derivatives(u, v);
            return (s.point, s.su, s.sv);
        }
        let [[point, sv], [su, _]] = self.sums::<2>(u, v);
        (Point3::from(point), su, sv)
    }

    /// Point, as [`Self::derivatives`].
    pub fn point(&self, u: f64, v: f64) -> Point3<f64> {
        if !in_square(u, v) {
            return self.derivatives(u, v).point;
        }
        let [[point]] = self.sums::<1>(u, v);
        Point3::from(point)
    }

    /// Control points of the line of equal u along v.
    fn line(&self, u: f64) -> Vec<Vector3<f64>> {
        let inside = u.clamp(0.0, 1.0);
        let basis = basis::evaluate(&self.knots[0], self.degree[0], inside, 1);
        let columns = self.sections.len();
        let weight = |a: usize| basis.values[0][a] + basis.values[1][a] * (u - inside);
        let at =
            |j: usize| (0..=self.degree[0]).map(|a| self.control[(basis.first + a) * columns + j] * weight(a)).sum();
        (0..columns).map(at).collect()
    }

    /// The surface turned about Z by an angle in radians (Wei 18).
    #[must_use]
    pub fn rotated(&self, angle: f64) -> Self {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
        Self {
            sections: self.sections.iter().map(|c| c.rotated(angle)).collect(),
            control: self.control.iter().map(|c| turn * c).collect(),
            seeds: Seeds::default(),
            ..self.clone()
        }
    }

    /// Points of a patch on a grid.
    fn grid(&self, patch: Patch) -> SeedGrid {
        // A line of equal v has one seed at each u.
        let across = if patch.v[0] < patch.v[1] { SECTION_SEEDS * (self.sections.len() - 1) } else { 0 };
        // The line at each u, and the weights at each v, are computed once.
        let rows: Vec<(usize, [f64; MAX_DEGREE + 1])> = (0..=across)
            .map(|j| {
                let v = between(patch.v, j, across.max(1));
                let inside = v.clamp(0.0, 1.0);
                let basis = basis::evaluate(&self.knots[1], self.degree[1], inside, 1);
                let weight = |k: usize| basis.values[0][k] + basis.values[1][k] * (v - inside);
                (basis.first, std::array::from_fn(weight))
            })
            .collect();
        let mut coordinates = [0; 3].map(|_| Vec::with_capacity((U_SEEDS + 1) * (across + 1)));
        for i in 0..=U_SEEDS {
            let line = self.line(between(patch.u, i, U_SEEDS));
            for (first, weights) in &rows {
                let point: Vector3<f64> = line[*first..].iter().zip(weights).map(|(c, weight)| c * *weight).sum();
                coordinates.iter_mut().zip(point.iter()).for_each(|(all, x)| all.push(*x));
            }
        }
        SeedGrid { coordinates, across, reach: self.reach_of_seeds(patch, across) }
    }

    /// Largest distance of a point of a patch to the nearest of its seeds, mm, by the largest derivatives; these are known of the surface
    /// within its borders alone.
    fn reach_of_seeds(&self, patch: Patch, across: usize) -> f64 {
        if !(in_square(patch.u[0], patch.v[0]) && in_square(patch.u[1], patch.v[1])) {
            return f64::INFINITY;
        }
        let columns = self.sections.len();
        // A derivative is a mean of the differences of neighbouring control points over the mean knots between them.
        let largest = |direction: usize, stride: usize| {
            let (knots, degree) = (&self.knots[direction], self.degree[direction]);
            let index = |i: usize| if direction == 0 { i / columns } else { i % columns };
            let rate = |i: usize| {
                let k = index(i);
                (self.control[i + stride] - self.control[i]).norm() * degree as f64
                    / (knots[k + degree + 1] - knots[k + 1])
            };
            let has_next = |i: &usize| direction == 0 || index(*i) + 1 < columns;
            (0..self.control.len() - stride).filter(has_next).map(rate).fold(0.0, f64::max)
        };
        let half = |range: [f64; 2], intervals: usize| 0.5 * (range[1] - range[0]) / intervals.max(1) as f64;
        largest(0, columns) * half(patch.u, U_SEEDS) + largest(1, 1) * half(patch.v, across)
    }

    /// A search for closest points of a patch, for many points: its seeds are computed once.
    pub fn search(&self, patch: Patch) -> LoftedSearch<'_> {
        let grid = if patch == Patch::WHOLE {
            Cow::Borrowed(self.seeds.0.get_or_init(|| self.grid(Patch::WHOLE)))
        } else {
            Cow::Owned(self.grid(patch))
        };
        LoftedSearch { surface: self, patch, grid }
    }

    /// Closest point of a patch, as [`LoftedSearch::closest`].
    pub fn closest(&self, p: &Point3<f64>, patch: Patch) -> Projection {
        self.search(patch).closest(p)
    }

    fn projection(&self, p: &Point3<f64>, [u, v]: [f64; 2]) -> Projection {
        let point = self.point(u, v);
        Projection { u, v, point, distance: (p - point).norm() }
    }

    /// Newton's method on half the squared distance; Gauss-Newton where its matrix has no minimum. Steps that do not
    /// reduce the distance are halved.
    fn refine(&self, p: &Point3<f64>, start: [f64; 2], patch: Patch) -> Projection {
        /// Largest number of steps; from a seed about six are enough.
        const MAX_PROJECTION_STEPS: usize = 40;
        let mut best = self.projection(p, start);
        for _ in 0..MAX_PROJECTION_STEPS {
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
                // Shorter steps end at the same place as well.
                if [u, v] == [best.u, best.v] {
                    break None;
                }
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

/// A search for closest points of a patch of a lofted surface.
#[derive(Clone, Debug)]
pub struct LoftedSearch<'a> {
    surface: &'a LoftedSurface,
    patch: Patch,
    grid: Cow<'a, SeedGrid>,
}

impl LoftedSearch<'_> {
    /// Closest point: distances on a grid, then Newton's method inside the patch, from each local minimum of the grid that may have a
    /// nearer point around it than the one to which the nearest point of the grid leads.
    pub fn closest(&self, p: &Point3<f64>) -> Projection {
        let Self { surface, patch, grid } = self;
        let squares = grid.squares(p);
        let column = grid.across + 1;
        let refined = |k: usize| {
            let start = [between(patch.u, k / column, U_SEEDS), between(patch.v, k % column, grid.across.max(1))];
            surface.refine(p, start, *patch)
        };
        let nearest = (1..squares.len()).fold(0, |least, k| if squares[k] < squares[least] { k } else { least });
        let first = refined(nearest);
        let limit = (first.distance + grid.reach) * (first.distance + grid.reach);
        let mut best: Option<Projection> = None;
        for k in (0..squares.len()).filter(|k| squares[*k] <= limit) {
            let (i, j) = (k / column, k % column);
            let mut around = (i.saturating_sub(1)..=(i + 1).min(U_SEEDS))
                .flat_map(|a| (j.saturating_sub(1)..=(j + 1).min(grid.across)).map(move |b| a * column + b));
            if around.any(|other| squares[other] < squares[k]) {
                continue;
            }
            let found = if k == nearest { first } else { refined(k) };
            if best.is_none_or(|b| found.distance < b.distance) {
                best = Some(found);
            }
        }
        best.unwrap_or(first)
    }
}

/// A lofted surface. Degrees and knots follow from the sections; control points do so to rounding, since a turned surface has
/// turned ones.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredLoft {
    sections: Vec<NurbsCurve>,
    places: Vec<f64>,
    control: Vec<Vector3<f64>>,
}

/// Most sections of a surface that is read: no blade has as many, and the matrix between them grows by the square.
#[cfg(feature = "serde")]
const MAX_SECTIONS: usize = 1000;

/// Share of the size of a surface to which control points follow from the sections.
#[cfg(feature = "serde")]
const SAME_CONTROL: f64 = 1e-6;

#[cfg(feature = "serde")]
impl TryFrom<StoredLoft> for LoftedSurface {
    type Error = GeomError;

    fn try_from(StoredLoft { sections, places, control }: StoredLoft) -> Result<Self, GeomError> {
        if sections.len() > MAX_SECTIONS {
            return Err(GeomError::TooManySections(sections.len()));
        }
        if places.first() != Some(&0.0) || places.last() != Some(&1.0) {
            return Err(GeomError::Knots);
        }
        let made = Self::at(sections, places)?;
        let due = made.control();
        if due.len() != control.len() {
            return Err(GeomError::TooFewPoints { given: control.len(), needed: due.len() });
        }
        let size = due.iter().map(|p| p.amax()).fold(1.0, f64::max);
        let follows = |(due, given): (&Vector3<f64>, &Vector3<f64>)| (due - given).amax() <= SAME_CONTROL * size;
        match due.iter().zip(&control).position(|pair| !follows(pair)) {
            Some(i) => Err(GeomError::Control(i)),
            None => Ok(made.with_control(control)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RuledSurface, interpolate};

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
