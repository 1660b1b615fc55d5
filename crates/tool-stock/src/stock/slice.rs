//! Intervals of material on parallel rays through a closed mesh.
//!
//! A row of rays lies in a plane. The plane cuts each triangle in no segment or in one, from an edge that the triangle
//! follows upward to an edge that it follows downward; a corner in the plane counts as below it. Both triangles at an
//! edge compute its point in the plane from the same two corners in the same order, so the segments form closed lines
//! without gap or overlap, rounded or not. A ray crosses a segment when one end of it lies beyond the ray and the other
//! does not. So each ray enters the solid as often as it leaves it, also through edges and vertices, and no crossing is
//! lost or counted twice. Material is where more surfaces were entered than left.

use super::mesh::Mesh;
use super::tile::SIDE;
use std::ops::Range;

/// Most surfaces behind one another, as a mean over the rays of a row: it bounds the memory.
const MAX_CROSSINGS: usize = 200;

/// A row of a tile with more than [`MAX_CROSSINGS`] surfaces behind one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crowded;

/// Intervals of material on each ray of a row.
type Row = Vec<Vec<[f64; 2]>>;

/// A mesh in the frame of a family of rays, with the triangles of each band of rows.
pub(super) struct Slices<'a> {
    mesh: &'a Mesh,
    /// Axes of the frame: the two across the rays, then that of the rays.
    frame: [usize; 3],
    /// Place of the first ray across, and the distance of the rays.
    first: [f64; 2],
    cell: f64,
    /// Triangles of each band of [`SIDE`] rows.
    bands: Vec<Vec<u32>>,
}

/// A place across the rays, and along them.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cut {
    across: f64,
    along: f64,
}

impl<'a> Slices<'a> {
    /// `first` is the place of the first ray across, `rows` the number of rows.
    pub(super) fn new(mesh: &'a Mesh, frame: [usize; 3], first: [f64; 2], cell: f64, rows: usize) -> Self {
        let mut bands = vec![Vec::new(); rows.div_ceil(SIDE)];
        let last = bands.len().saturating_sub(1);
        let band = |row: f64| ((row.max(0.0) / SIDE as f64) as usize).min(last);
        for (n, triangle) in (0_u32..).zip(&mesh.triangles) {
            let v = triangle.map(|i| mesh.vertices[i as usize][frame[1]]);
            let [low, high] = [v[0].min(v[1]).min(v[2]), v[0].max(v[1]).max(v[2])].map(|v| (v - first[1]) / cell);
            // One row more on both sides than rounding may need.
            if high >= -1.0 && low <= rows as f64 {
                (band(low - 1.0)..=band(high + 1.0)).for_each(|b| bands[b].push(n));
            }
        }
        Self { mesh, frame, first, cell, bands }
    }

    /// Position of a ray across: `k` is 0 along a row and 1 from row to row.
    fn place(&self, k: usize, i: usize) -> f64 {
        self.first[k] + self.cell * i as f64
    }

    /// Intervals on the rays of a tile, row by row; `rays` are its columns and rows in the grid.
    pub(super) fn tile(&self, [columns, rows]: [Range<usize>; 2]) -> Result<Vec<Row>, Crowded> {
        let Some(band) = self.bands.get(rows.start / SIDE) else { return Ok(Vec::new()) };
        let (from, to) = (self.place(0, columns.start), self.place(0, columns.end));
        let near: Vec<u32> = band.iter().copied().filter(|n| self.meets(*n, from, to)).collect();
        rows.map(|row| self.row(&near, self.place(1, row), columns.clone())).collect()
    }

    fn corners(&self, triangle: u32) -> [[f64; 3]; 3] {
        self.mesh.triangles[triangle as usize].map(|i| {
            let p = &self.mesh.vertices[i as usize];
            self.frame.map(|k| p[k])
        })
    }

    fn meets(&self, triangle: u32, from: f64, to: f64) -> bool {
        let u = self.corners(triangle).map(|p| p[0]);
        u.iter().any(|u| *u >= from - self.cell) && u.iter().any(|u| *u <= to + self.cell)
    }

    fn row(&self, triangles: &[u32], at: f64, columns: Range<usize>) -> Result<Row, Crowded> {
        let mut crossings: Vec<Vec<(f64, i32)>> = vec![Vec::new(); columns.len()];
        let most = MAX_CROSSINGS * SIDE;
        let mut count = 0;
        for [up, down] in triangles.iter().filter_map(|n| segment(&self.corners(*n), at)) {
            let [low, high] = [up.across.min(down.across), up.across.max(down.across)];
            let index = |u: f64| (u - self.first[0]) / self.cell - columns.start as f64;
            // Casts saturate; the comparison below decides, whatever rounding says here.
            let span = index(low).floor().max(0.0) as usize..((index(high).ceil() + 1.0) as usize).min(columns.len());
            for i in span {
                let u = self.place(0, columns.start + i);
                let [beyond_up, beyond_down] = [up.across > u, down.across > u];
                if beyond_up == beyond_down {
                    continue;
                }
                let share = (u - up.across) / (down.across - up.across);
                let along = (up.along + (down.along - up.along) * share)
                    .clamp(up.along.min(down.along), up.along.max(down.along));
                crossings[i].push((along, if beyond_up { -1 } else { 1 }));
                count += 1;
            }
            if count > most {
                return Err(Crowded);
            }
        }
        Ok(crossings.into_iter().map(material).collect())
    }
}

/// Segment in which a plane cuts a triangle: its points on the edge that runs upward and on the edge that runs downward.
fn segment(corners: &[[f64; 3]; 3], at: f64) -> Option<[Cut; 2]> {
    let above = corners.map(|p| p[1] > at);
    let edge = |from: bool| (0..3).find(|k| above[*k] == from && above[(*k + 1) % 3] != from);
    let point = |k: usize| {
        let (a, b) = (&corners[k], &corners[(k + 1) % 3]);
        // From the corner below to the corner above, for both triangles at the edge.
        let (a, b) = if above[k] { (b, a) } else { (a, b) };
        let share = (at - a[1]) / (b[1] - a[1]);
        Cut { across: a[0] + (b[0] - a[0]) * share, along: a[2] + (b[2] - a[2]) * share }
    };
    Some([point(edge(false)?), point(edge(true)?)])
}

/// Intervals between entering and leaving.
fn material(mut crossings: Vec<(f64, i32)>) -> Vec<[f64; 2]> {
    crossings.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    let mut intervals: Vec<[f64; 2]> = Vec::new();
    let (mut depth, mut start) = (0, 0.0);
    for (along, step) in crossings {
        if depth == 0 && step > 0 {
            start = along;
        }
        depth += step;
        if depth == 0 && step < 0 {
            match intervals.last_mut() {
                Some(last) if last[1] >= start => last[1] = along,
                _ if along > start => intervals.push([start, along]),
                _ => {}
            }
        }
    }
    intervals
}

/// Intervals in both of two lists, each sorted and disjoint.
pub(super) fn both(a: &[[f64; 2]], b: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let (mut i, mut j, mut out) = (0, 0, Vec::new());
    while let (Some(x), Some(y)) = (a.get(i), b.get(j)) {
        let (from, to) = (x[0].max(y[0]), x[1].min(y[1]));
        if to > from {
            out.push([from, to]);
        }
        if x[1] < y[1] { i += 1 } else { j += 1 }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_both_have() {
        assert_eq!(
            both(&[[0.0, 4.0], [5.0, 9.0]], &[[1.0, 2.0], [3.0, 6.0], [8.0, 12.0]]),
            [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0], [8.0, 9.0]]
        );
        assert!(both(&[[0.0, 1.0]], &[[1.0, 2.0]]).is_empty());
        assert!(both(&[], &[[1.0, 2.0]]).is_empty());
    }

    #[test]
    fn shells_in_and_beside_each_other() {
        let found = |c: &[(f64, i32)]| material(c.to_vec());
        assert_eq!(found(&[(0.0, 1), (4.0, -1)]), [[0.0, 4.0]]);
        // A hollow, two solids that overlap, two that touch.
        assert_eq!(found(&[(0.0, 1), (1.0, -1), (3.0, 1), (4.0, -1)]), [[0.0, 1.0], [3.0, 4.0]]);
        assert_eq!(found(&[(0.0, 1), (1.0, 1), (3.0, -1), (4.0, -1)]), [[0.0, 4.0]]);
        assert_eq!(found(&[(0.0, 1), (2.0, -1), (2.0, 1), (4.0, -1)]), [[0.0, 4.0]]);
        assert_eq!(found(&[(2.0, 1), (2.0, -1)]), [[0.0; 2]; 0]);
    }
}
