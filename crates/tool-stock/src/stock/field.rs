//! The tri-dexel field: rays along X, Y and Z through the centres of a grid of cubes, with the intervals of material on
//! them.

use super::mesh::Mesh;
use super::moving::Moving;
use super::slice::{Slices, both};
use super::tile::{SIDE, Tile};
use nalgebra::Point3;
use rayon::prelude::*;

/// Most rays of a field, all families together: about 2 GB.
pub const MAX_RAYS: f64 = 3e7;

/// Share of a cell by which a size may exceed a whole number of cells through rounding.
const CELL_ROUNDING: f64 = 1e-9;

/// Why a field cannot be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldError {
    /// The cell is not a positive number.
    BadCell,
    /// The profile has no inside, or numbers that are not finite.
    BadProfile,
    /// The field would need more than [`MAX_RAYS`] rays.
    TooFine {
        /// Number of rays that the field would need.
        rays: f64,
        /// Least possible cell, mm, slightly rounded up.
        least_cell: f64,
    },
    /// The mesh has more surfaces behind one another than any workpiece.
    Crowded,
}

/// Missing parts of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncut {
    /// Volume by the rays, mean of the three families, mm3.
    pub volume: f64,
    /// Middle of the longest missing interval.
    pub point: Point3<f64>,
}

/// Missing intervals of rays.
struct Missed {
    /// Total length.
    length: f64,
    /// Length of the longest interval, and its middle.
    longest: f64,
    middle: Point3<f64>,
}

impl Missed {
    const NOTHING: Self = Self { length: 0.0, longest: 0.0, middle: Point3::new(0.0, 0.0, 0.0) };

    /// Adds other intervals; of equally long intervals the first remains the longest.
    fn join(&mut self, other: &Self) {
        self.length += other.length;
        if other.longest > self.longest {
            (self.longest, self.middle) = (other.longest, other.middle);
        }
    }
}

/// Stock as three families of parallel rays.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    pub(super) cell: f64,
    /// Lower corner of the grid.
    pub(super) low: [f64; 3],
    /// Cells along each axis.
    pub(super) count: [usize; 3],
    /// Families of rays along X, Y, Z.
    pub(super) families: [Family; 3],
}

/// Rays along one axis, in tiles. Tiles use only the [`frame`] of the family, in which the rays run along Z.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Family {
    /// Numbers of tiles along the next two axes, in cyclic order.
    pub(super) across: [usize; 2],
    /// Tiles; the index along the first of both axes runs first.
    pub(super) tiles: Vec<Tile>,
}

impl Family {
    /// The tiles that the box of a moving body meets, with the lower corner of the rays and their distance.
    pub(super) fn near(&self, low: [f64; 3], cell: f64, moving: &Moving) -> impl Iterator<Item = usize> + use<> {
        let span = |k: usize| {
            let tile = |x: f64| (x - low[k]) / cell / SIDE as f64;
            // Casts saturate at zero.
            tile(moving.low[k]) as usize..=(tile(moving.high[k]) as usize).min(self.across[k] - 1)
        };
        let (columns, row) = (span(0), self.across[0]);
        span(1).flat_map(move |j| columns.clone().map(move |i| j * row + i))
    }
}

/// The axes in the order of the frame of a family of rays: both axes across in cyclic order, then its own axis.
pub(super) fn frame(axis: usize) -> [usize; 3] {
    let [u, v] = across(axis);
    [u, v, axis]
}

/// The two axes across an axis, in cyclic order.
pub(super) fn across(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// Cubes around a profile.
struct FieldGrid {
    cell: f64,
    low: [f64; 3],
    count: [usize; 3],
}

impl FieldGrid {
    fn new(profile: &[[f64; 2]], cell: f64) -> Result<Self, FieldError> {
        if !(cell > 0.0 && cell.is_finite()) {
            return Err(FieldError::BadCell);
        }
        let (mut r, mut bottom, mut top) = (0.0_f64, f64::INFINITY, f64::NEG_INFINITY);
        for p in profile {
            if !(p[0].is_finite() && p[1].is_finite() && p[0] >= 0.0) {
                return Err(FieldError::BadProfile);
            }
            (r, bottom, top) = (r.max(p[0]), bottom.min(p[1]), top.max(p[1]));
        }
        if !(r > 0.0 && top > bottom) {
            return Err(FieldError::BadProfile);
        }
        let size = [2.0 * r, 2.0 * r, top - bottom];
        let middle = [0.0, 0.0, 0.5 * (top + bottom)];
        // A blank thinner than a cell does not change the cell.
        let cell = if size[2] > cell { size[2] / (size[2] / cell - CELL_ROUNDING).ceil().max(1.0) } else { cell };
        let rays = size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
        if rays / (cell * cell) > MAX_RAYS {
            // Reserve for the rounding of grids and heights to whole cells.
            let least_cell = (rays / MAX_RAYS).sqrt() * 1.1;
            return Err(FieldError::TooFine { rays: rays / (cell * cell), least_cell });
        }
        let count = size.map(|s| (s / cell - CELL_ROUNDING).ceil().max(1.0) as usize);
        let low = std::array::from_fn(|k| middle[k] - 0.5 * cell * count[k] as f64);
        Ok(Self { cell, low, count })
    }
}

impl Field {
    /// Stock of revolution about Z: the inside of a closed profile of (r, z) points, r >= 0, with exact intersections
    /// of the rays. The cell shrinks until the height is a whole number of cells, so that the rays across represent
    /// both faces exactly.
    ///
    /// # Errors
    /// [`FieldError`]: a cell that is not positive or too small, or a profile without inside.
    pub fn turned(profile: &[[f64; 2]], cell: f64) -> Result<Self, FieldError> {
        Self::new(profile, None, cell)
    }

    /// As [`Self::turned`]; with a closed mesh only what lies inside of both, with exact intersections of the rays.
    ///
    /// # Errors
    /// As [`Self::turned`], or a mesh with too many surfaces behind one another.
    pub fn new(profile: &[[f64; 2]], mesh: Option<&Mesh>, cell: f64) -> Result<Self, FieldError> {
        let FieldGrid { cell, low, count } = FieldGrid::new(profile, cell)?;
        let body = Turned::new(profile);
        let family = |axis: usize| -> Result<Family, FieldError> {
            let [u, v] = across(axis);
            let across = [count[u].div_ceil(SIDE), count[v].div_ceil(SIDE)];
            let place = |axis: usize, i: usize| low[axis] + cell * (i as f64 + 0.5);
            let slices = mesh.map(|mesh| Slices::new(mesh, frame(axis), [place(u, 0), place(v, 0)], cell, count[v]));
            let depth = [low[axis], low[axis] + cell * count[axis] as f64];
            let tile = |n: usize| {
                let first = [n % across[0] * SIDE, n / across[0] * SIDE];
                let rays = [(count[u] - first[0]).min(SIDE), (count[v] - first[1]).min(SIDE)];
                let inside = slices.as_ref().map(|s| s.tile([0, 1].map(|k: usize| first[k]..first[k] + rays[k])));
                let inside = inside.transpose().map_err(|_| FieldError::Crowded)?;
                let origin = [place(u, first[0]), place(v, first[1])];
                Ok(Tile::new(origin, cell, depth, rays, |i, j| {
                    let (a, b) = (place(u, first[0] + i), place(v, first[1] + j));
                    let turned = body.inside(axis, a, b);
                    match &inside {
                        Some(rows) => both(&turned, &rows[j][i]),
                        None => turned,
                    }
                }))
            };
            let tiles: Result<Vec<Tile>, FieldError> = (0..across[0] * across[1]).into_par_iter().map(tile).collect();
            Ok(Family { across, tiles: tiles? })
        };
        let families = [family(0)?, family(1)?, family(2)?];
        Ok(Self { cell, low, count, families })
    }

    /// The field on some of its rays: with the largest cells of an odd number of its own cells that are no larger than
    /// `cell`, mm.
    #[must_use]
    pub fn coarser(&self, cell: f64) -> Self {
        let whole = (cell / self.cell + CELL_ROUNDING).floor().max(1.0) as usize;
        let cells = if whole.is_multiple_of(2) { whole - 1 } else { whole };
        let count = self.count.map(|n| n.div_ceil(cells));
        // The centre of an odd number of cells is the centre of one of them.
        let own = |i: usize| i * cells + cells / 2;
        let place = |axis: usize, i: usize| self.low[axis] + self.cell * (own(i) as f64 + 0.5);
        let cell = self.cell * cells as f64;
        let families = [0, 1, 2].map(|axis| {
            let [u, v] = across(axis);
            let across = [count[u].div_ceil(SIDE), count[v].div_ceil(SIDE)];
            let depth = [self.low[axis], self.low[axis] + cell * count[axis] as f64];
            let tile = |n: usize| {
                let first = [n % across[0] * SIDE, n / across[0] * SIDE];
                let rays = [(count[u] - first[0]).min(SIDE), (count[v] - first[1]).min(SIDE)];
                Tile::new([place(u, first[0]), place(v, first[1])], cell, depth, rays, |i, j| {
                    self.intervals(axis, own(first[0] + i), own(first[1] + j))
                })
            };
            Family { across, tiles: (0..across[0] * across[1]).into_par_iter().map(tile).collect() }
        });
        Self { cell, low: self.low, count, families }
    }

    /// Edge of the cells.
    pub fn cell(&self) -> f64 {
        self.cell
    }

    /// Number of rays of all families.
    pub fn rays(&self) -> usize {
        let [x, y, z] = self.count;
        x * y + y * z + z * x
    }

    /// Volume by the rays along X, Y and Z.
    pub fn volumes(&self) -> [f64; 3] {
        let area = self.cell * self.cell;
        [0, 1, 2].map(|k| {
            let tiles: Vec<f64> = self.families[k].tiles.par_iter().map(Tile::length).collect();
            tiles.iter().sum::<f64>() * area
        })
    }

    /// Mean volume of the three families.
    pub fn volume(&self) -> f64 {
        self.volumes().iter().sum::<f64>() / 3.0
    }

    /// Intervals of material of the ray along an axis (0 to 2), at a row and column of the grid along the next two axes
    /// in cyclic order.
    pub fn intervals(&self, axis: usize, row: usize, column: usize) -> Vec<[f64; 2]> {
        self.ray(axis, row, column).map_or_else(Vec::new, |r| r.intervals().collect())
    }

    /// Position of cell centre `i` along an axis.
    pub fn centre(&self, axis: usize, i: usize) -> f64 {
        self.low[axis] + self.cell * (i as f64 + 0.5)
    }

    /// Number of cells along each axis.
    pub fn cells(&self) -> [usize; 3] {
        self.count
    }

    pub(super) fn ray(&self, axis: usize, row: usize, column: usize) -> Option<&super::ray::Ray> {
        let family = &self.families[axis % 3];
        let [u, v] = across(axis % 3);
        if row >= self.count[u] || column >= self.count[v] {
            return None;
        }
        let tile = &family.tiles[row / SIDE + family.across[0] * (column / SIDE)];
        tile.ray(row % SIDE, column % SIDE)
    }

    /// Missing parts of a body of revolution about Z, the inside of a closed profile of (r, z) points; with an earlier
    /// field of the same grid only what that one still had. `None` when no missing interval of a ray is longer than
    /// `least`, mm. Between the rays nothing is known.
    pub fn uncut_under(&self, profile: &[[f64; 2]], least: f64, before: Option<&Self>) -> Option<Uncut> {
        let mut all = Missed::NOTHING;
        let body = Turned::new(profile);
        for axis in 0..3 {
            let rows: Vec<Missed> = (0..self.count[across(axis)[0]])
                .into_par_iter()
                .map(|row| self.missed(axis, row, &body, least, before))
                .collect();
            for row in &rows {
                all.join(row);
            }
        }
        let point = all.middle;
        (all.longest > 0.0).then(|| Uncut { volume: all.length * self.cell * self.cell / 3.0, point })
    }

    /// Missing parts of the body on a row of rays along an axis.
    fn missed(&self, axis: usize, row: usize, body: &Turned<'_>, least: f64, before: Option<&Self>) -> Missed {
        let [u, v] = across(axis);
        let mut all = Missed::NOTHING;
        for column in 0..self.count[v] {
            let (a, b) = (self.centre(u, row), self.centre(v, column));
            let mut due = body.inside(axis, a, b);
            if let Some(field) = before {
                due = both(&due, &field.intervals(axis, row, column));
            }
            let ray = self.ray(axis, row, column);
            let there = || ray.into_iter().flat_map(super::ray::Ray::intervals);
            for [from, to] in due.into_iter().flat_map(|due| gaps(due, there())).filter(|gap| gap[1] - gap[0] > least) {
                let mut middle = Point3::origin();
                (middle[u], middle[v], middle[axis]) = (a, b, 0.5 * (from + to));
                all.join(&Missed { length: to - from, longest: to - from, middle });
            }
        }
        all
    }

    /// A hash of the field, FNV-1a over the bits of all interval ends: equal for equal fields, hardly ever for others.
    pub fn fingerprint(&self) -> u64 {
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        for tile in self.families.iter().flat_map(|f| &f.tiles) {
            for [a, b] in tile.rays().flat_map(super::ray::Ray::intervals) {
                for bits in [a.to_bits(), b.to_bits()] {
                    hash = (hash ^ bits).wrapping_mul(0x0100_0000_01b3);
                }
            }
        }
        hash
    }
}

/// The parts of an interval outside of other intervals, which are sorted and disjoint.
fn gaps([from, to]: [f64; 2], others: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut left = Vec::new();
    let mut at = from;
    for [a, b] in others.filter(|o| o[1] > from && o[0] < to) {
        if a > at {
            left.push([at, a]);
        }
        at = at.max(b);
    }
    if at < to {
        left.push([at, to]);
    }
    left
}

/// A body of revolution about Z: a closed profile of (r, z) points, whose edges are found by distance from the axis and by height.
struct Turned<'a> {
    profile: &'a [[f64; 2]],
    by_distance: EdgeBins,
    by_height: EdgeBins,
}

/// Edges of a profile by one coordinate of it: of each bin of values those that reach into it.
struct EdgeBins {
    least: f64,
    per_bin: f64,
    bins: Vec<Vec<u32>>,
}

impl EdgeBins {
    /// The edges by coordinate `k` of their points.
    fn new(profile: &[[f64; 2]], k: usize) -> Self {
        let (least, most) =
            profile.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), p| (l.min(p[k]), m.max(p[k])));
        let count = profile.len().max(1);
        let per_bin = ((most - least) / count as f64).max(f64::MIN_POSITIVE);
        let mut found = Self { least, per_bin, bins: vec![Vec::new(); count] };
        for (i, edge) in (0..).zip(0..profile.len()) {
            let ends = [profile[edge][k], profile[(edge + 1) % profile.len()][k]].map(|value| found.bin(value));
            for bin in ends[0].min(ends[1])..=ends[0].max(ends[1]) {
                found.bins[bin].push(i);
            }
        }
        found
    }

    /// The bin of a value; it does not fall as the value rises, so that a value between the ends of an edge has a bin of the edge.
    fn bin(&self, value: f64) -> usize {
        (((value - self.least) / self.per_bin).max(0.0) as usize).min(self.bins.len() - 1)
    }

    /// The edges that may have a value between their ends.
    fn near(&self, value: f64) -> &[u32] {
        &self.bins[self.bin(value)]
    }
}

impl<'a> Turned<'a> {
    fn new(profile: &'a [[f64; 2]]) -> Self {
        Self { profile, by_distance: EdgeBins::new(profile, 0), by_height: EdgeBins::new(profile, 1) }
    }

    /// Intervals inside on a ray along an axis (0 to 2), at places along the next two axes in cyclic order.
    fn inside(&self, axis: usize, a: f64, b: f64) -> Vec<[f64; 2]> {
        match axis {
            // The ray lies at height b or a, at distance a or b from the axis.
            0 => self.across_axis(a, b),
            1 => self.across_axis(b, a),
            _ => self.along_axis(libm::hypot(a, b)),
        }
    }

    /// Places where some edges cross a line, ascending. The line is given by the side of a point and by the place of its crossing
    /// with an edge.
    fn crossings(
        &self,
        edges: &[u32],
        beyond: impl Fn(&[f64; 2]) -> bool,
        place: impl Fn(&[f64; 2], &[f64; 2]) -> f64,
    ) -> Vec<f64> {
        let ends =
            |edge: &u32| (&self.profile[*edge as usize], &self.profile[(*edge as usize + 1) % self.profile.len()]);
        let crossed = edges.iter().map(ends).filter(|(a, b)| beyond(a) != beyond(b));
        let mut found: Vec<f64> = crossed.map(|(a, b)| place(a, b)).collect();
        found.sort_by(f64::total_cmp);
        found
    }

    /// Intervals of z at a distance from the axis.
    fn along_axis(&self, r: f64) -> Vec<[f64; 2]> {
        let edges = self.by_distance.near(r);
        let z = self.crossings(edges, |p| p[0] > r, |a, b| a[1] + (b[1] - a[1]) * (r - a[0]) / (b[0] - a[0]));
        z.chunks_exact(2).filter(|c| c[1] > c[0]).map(|c| [c[0], c[1]]).collect()
    }

    /// Intervals along a line across the axis at height z and distance y from the axis.
    fn across_axis(&self, y: f64, z: f64) -> Vec<[f64; 2]> {
        let edges = self.by_height.near(z);
        let r = self.crossings(edges, |p| p[1] > z, |a, b| a[0] + (b[0] - a[0]) * (z - a[1]) / (b[1] - a[1]));
        let half = |r: f64| if r > y.abs() { ((r - y.abs()) * (r + y.abs())).sqrt() } else { 0.0 };
        let mut intervals: Vec<[f64; 2]> = Vec::new();
        for pair in r.chunks_exact(2).rev() {
            let (inner, outer) = (half(pair[0]), half(pair[1]));
            if outer > inner {
                intervals.push([-outer, -inner]);
            }
        }
        for k in (0..intervals.len()).rev() {
            let [a, b] = intervals[k];
            let mirrored = [-b, -a];
            match intervals.last_mut() {
                // Both halves meet in the plane through the axis.
                Some(last) if last[1] >= mirrored[0] => last[1] = mirrored[1],
                _ => intervals.push(mirrored),
            }
        }
        intervals
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a line the edges of its bin give the same intervals as all edges.
    #[test]
    fn edges_of_a_bin_are_all_that_a_line_crosses() {
        let wave = (0..97).map(|k| f64::from(k) / 96.0).map(|t| [4.0 + 3.0 * t, 5.0 * t + (9.0 * t).sin()]);
        let profile: Vec<[f64; 2]> =
            [[4.0, -3.0], [1.0, -3.0], [1.0, -1.0], [4.0, -1.0]].into_iter().chain(wave).collect();
        let body = Turned::new(&profile);
        let all: Vec<u32> = (0..u32::try_from(profile.len()).unwrap_or(0)).collect();
        let every = |least| EdgeBins { least, per_bin: f64::INFINITY, bins: vec![all.clone()] };
        let slow = Turned { profile: &profile, by_distance: every(0.0), by_height: every(-3.0) };
        let mut crossed = 0;
        for k in 0..400 {
            let (a, b) = (f64::from(k % 20) * 0.4 - 0.3, f64::from(k / 20) * 0.6 - 4.0);
            for axis in 0..3 {
                let found = body.inside(axis, a, b);
                assert_eq!(found, slow.inside(axis, a, b), "{axis} {a} {b}");
                crossed += found.len();
            }
        }
        assert!(crossed > 500, "{crossed}");
        // The ends of edges lie in the bins of both.
        for p in &profile {
            assert_eq!(body.along_axis(p[0]), slow.along_axis(p[0]));
            assert_eq!(body.across_axis(0.5, p[1]), slow.across_axis(0.5, p[1]));
        }
    }
}
