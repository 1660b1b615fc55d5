//! Closed triangle mesh of the stock, by surface nets.
//!
//! Cell centres are inside or outside. The ends of the intervals give exactly where the surface crosses the edges
//! between them. Each cube of eight centres that contains part of the surface gets one vertex, the mean of the
//! crossings on its edges. Each crossed edge joins the vertices of the four cubes around it. Every edge of the mesh
//! therefore belongs to an even number of triangles, and planes remain plane; sharp edges are rounded within a cell.

use super::field::across;
use super::{Field, Mesh};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Marks a cube without vertex.
const NO_VERTEX: u32 = u32::MAX;

/// State of one layer of cell centres, inside or outside, with a border outside.
struct MeshLayer {
    inside: Vec<bool>,
    width: usize,
}

impl MeshLayer {
    /// Layer `k` of the grid, from -1 to its height.
    fn new(field: &Field, k: i64) -> Self {
        let [nx, ny, nz] = field.cells();
        let width = nx + 2;
        let mut inside = vec![false; width * (ny + 2)];
        if k >= 0 && (k as usize) < nz {
            let z = field.centre(2, k as usize);
            inside.par_chunks_mut(width).enumerate().skip(1).take(ny).for_each(|(j, row)| {
                for (i, cell) in row.iter_mut().enumerate().skip(1).take(nx) {
                    *cell = field.ray(2, i - 1, j - 1).is_some_and(|r| r.contains(z));
                }
            });
        }
        Self { inside, width }
    }

    fn at(&self, i: usize, j: usize) -> bool {
        self.inside[j * self.width + i]
    }
}

impl Field {
    /// Mesh of the stock.
    pub fn mesh(&self) -> Mesh {
        let [nx, ny, nz] = self.cells();
        let mut mesh = Mesh::default();
        // Centres are numbered with the border, from 0 to n + 1; cube i lies between centres i and i + 1.
        let (width, rows) = (nx + 1, ny + 1);
        let mut below = MeshLayer::new(self, -1);
        let mut cubes_below: Vec<u32> = vec![NO_VERTEX; width * rows];
        for k in 0..=nz {
            let above = MeshLayer::new(self, k as i64);
            let corner = |n: usize, i: usize, j: usize| {
                let layer = if n & 4 == 0 { &below } else { &above };
                layer.at(i + (n & 1), j + (n >> 1 & 1))
            };
            let vertices: Vec<Vec<(usize, Point3<f64>)>> = (0..rows)
                .into_par_iter()
                .map(|j| {
                    let mut row = Vec::new();
                    for i in 0..width {
                        let corners: [bool; 8] = std::array::from_fn(|n| corner(n, i, j));
                        if corners.iter().any(|c| *c != corners[0]) {
                            row.push((j * width + i, self.vertex([i, j, k], &corners)));
                        }
                    }
                    row
                })
                .collect();
            let mut cubes: Vec<u32> = vec![NO_VERTEX; width * rows];
            for (place, point) in vertices.into_iter().flatten() {
                cubes[place] = u32::try_from(mesh.vertices.len()).unwrap_or(NO_VERTEX);
                mesh.vertices.push(point);
            }
            // Edges between the layers, then edges in the lower layer.
            for j in 1..=ny {
                for i in 1..=nx {
                    if below.at(i, j) != above.at(i, j) {
                        let around =
                            [[i - 1, j - 1], [i, j - 1], [i, j], [i - 1, j]].map(|[i, j]| cubes[j * width + i]);
                        quad(&mut mesh, around, below.at(i, j));
                    }
                }
            }
            for j in 1..rows + 1 {
                for i in 0..width {
                    if j <= ny && below.at(i, j) != below.at(i + 1, j) {
                        let (p, q) = ((j - 1) * width + i, j * width + i);
                        quad(&mut mesh, [cubes_below[p], cubes_below[q], cubes[q], cubes[p]], below.at(i, j));
                    }
                }
            }
            for j in 0..rows {
                for i in 1..=nx {
                    if below.at(i, j) != below.at(i, j + 1) {
                        let (p, q) = (j * width + i - 1, j * width + i);
                        quad(&mut mesh, [cubes_below[p], cubes[p], cubes[q], cubes_below[q]], below.at(i, j));
                    }
                }
            }
            (below, cubes_below) = (above, cubes);
        }
        mesh
    }

    /// Mean of the crossings on the edges of a cube; `at` is its index with the border, the corners are in binary
    /// order.
    fn vertex(&self, at: [usize; 3], corners: &[bool; 8]) -> Point3<f64> {
        let mut sum = Vector3::zeros();
        let mut count = 0.0;
        let place = |axis: usize, i: usize| self.low[axis] + self.cell * (i as f64 - 0.5);
        for axis in 0..3 {
            let [u, v] = across(axis);
            for n in 0..8_usize {
                let other = n | 1 << axis;
                if other == n || corners[n] == corners[other] {
                    continue;
                }
                let (iu, iv) = (at[u] + (n >> u & 1), at[v] + (n >> v & 1));
                let (from, to) = (place(axis, at[axis]), place(axis, at[axis] + 1));
                let mut p = Vector3::zeros();
                p[u] = place(u, iu);
                p[v] = place(v, iv);
                // The border is outside: a crossed edge has its row in the grid.
                let ray = iu.checked_sub(1).zip(iv.checked_sub(1)).and_then(|(iu, iv)| self.ray(axis, iu, iv));
                let side = usize::from(corners[n]);
                let end = ray.and_then(|r| r.intervals().map(|x| x[side]).find(|x| (from..=to).contains(x)));
                // Families may differ by the error of an end.
                p[axis] = end.unwrap_or(0.5 * (from + to));
                sum += p;
                count += 1.0;
            }
        }
        Point3::from(sum / f64::max(count, 1.0))
    }
}

/// Two triangles between four cubes around an edge; `forward` when the edge runs out of the material.
fn quad(mesh: &mut Mesh, around: [u32; 4], forward: bool) {
    let [a, b, c, d] = around;
    let (b, d) = if forward { (b, d) } else { (d, b) };
    mesh.triangles.push([a, b, c]);
    mesh.triangles.push([a, c, d]);
}
