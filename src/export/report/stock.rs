//! Meshes of the stock for the page, coarsened by clustering of their vertices until they are small enough.

use super::pack::{Bytes, Frame};
use nalgebra::{Point3, Vector3};
use serde::Serialize;
use std::collections::BTreeMap;

/// Stock that stands after an operation.
#[derive(Clone, Debug, Default)]
pub struct StockStage {
    /// After what, in words for the reader.
    pub name: String,
    /// Vertices, part frame, mm.
    pub positions: Vec<Point3<f64>>,
    /// Corners of each triangle, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Most triangles of one mesh, and of all of them.
const MOST_TRIANGLES: [usize; 2] = [60_000, 360_000];

/// Vertices that an index of 16 bit reaches.
const MOST_VERTICES: usize = 65_535;

/// Growth of the cells while a mesh is still too large.
const GROWTH: f64 = 1.25;

/// Enough growth from the first cell to one that holds any part whole.
const MOST_ROUNDS: usize = 60;

/// One mesh as the page takes it.
#[derive(Serialize)]
pub(super) struct StockData {
    name: String,
    frame: Frame,
    vertices: usize,
    pub(super) triangles: usize,
    /// Size of the cells in which vertices were joined, mm; zero when none were.
    pub(super) cell: f64,
    #[serde(skip)]
    pub(super) positions: Bytes,
    #[serde(skip)]
    pub(super) indices: Bytes,
}

/// A mesh with the vertices of each cell joined in their mean.
fn clustered(stage: &StockStage, cell: f64) -> (Vec<Point3<f64>>, Vec<[usize; 3]>) {
    let mut cells: BTreeMap<[i64; 3], usize> = BTreeMap::new();
    let mut sums: Vec<(Vector3<f64>, f64)> = Vec::new();
    let vertex: Vec<usize> = stage
        .positions
        .iter()
        .map(|p| {
            let key = [p.x, p.y, p.z].map(|x| (x / cell).floor() as i64);
            let next = sums.len();
            let index = *cells.entry(key).or_insert(next);
            if index == next {
                sums.push((Vector3::zeros(), 0.0));
            }
            sums[index].0 += p.coords;
            sums[index].1 += 1.0;
            index
        })
        .collect();
    let corner = |i: u32| vertex.get(i as usize).copied();
    let triangles = stage
        .triangles
        .iter()
        .filter_map(|t| Some([corner(t[0])?, corner(t[1])?, corner(t[2])?]))
        .filter(|[a, b, c]| a != b && b != c && a != c)
        .collect();
    (sums.into_iter().map(|(sum, n)| Point3::from(sum / n)).collect(), triangles)
}

/// A mesh small enough for the page beside `stages` meshes in all.
pub(super) fn stock(stage: &StockStage, stages: usize) -> StockData {
    let most = MOST_TRIANGLES[0].min(MOST_TRIANGLES[1] / stages.max(1));
    let frame = Frame::around(stage.positions.iter().map(|p| [p.x, p.y, p.z]));
    let fits = |vertices: usize, triangles: usize| vertices <= MOST_VERTICES && triangles <= most;
    let mut cell = 0.0;
    let whole = fits(stage.positions.len(), stage.triangles.len());
    let (positions, triangles) = if whole {
        (stage.positions.clone(), stage.triangles.iter().map(|t| t.map(|i| i as usize)).collect())
    } else {
        // A surface of n triangles in a box of this size has edges of about this length.
        let edge = frame.size.iter().map(|s| s * s).sum::<f64>().sqrt() / (most.max(1) as f64).sqrt();
        let mut mesh = (Vec::new(), Vec::new());
        cell = edge;
        for _ in 0..MOST_ROUNDS {
            mesh = clustered(stage, cell);
            if fits(mesh.0.len(), mesh.1.len()) {
                break;
            }
            cell *= GROWTH;
        }
        mesh
    };
    let mut data = StockData {
        name: stage.name.clone(),
        frame,
        vertices: positions.len(),
        triangles: triangles.len(),
        cell,
        positions: Bytes::default(),
        indices: Bytes::default(),
    };
    for p in &positions {
        frame.place([p.x, p.y, p.z]).into_iter().for_each(|v| data.positions.u16(v));
    }
    for i in triangles.iter().flatten() {
        data.indices.u16(u16::try_from(*i).unwrap_or(u16::MAX));
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A height field of n by n cells over 100 mm.
    fn field(n: u32) -> StockStage {
        let at = |k: u32| f64::from(k) / f64::from(n) * 100.0;
        let positions = (0..=n)
            .flat_map(|i| (0..=n).map(move |j| Point3::new(at(i), at(j), (at(i) * 0.1).sin() * (at(j) * 0.1).cos())))
            .collect();
        let index = |i: u32, j: u32| i * (n + 1) + j;
        let cell = |i: u32, j: u32| {
            let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        let triangles = (0..n).flat_map(|i| (0..n).flat_map(move |j| cell(i, j))).collect();
        StockStage { name: "field".to_owned(), positions, triangles }
    }

    #[test]
    fn small_meshes_stay_and_large_ones_are_coarsened_near_their_surface() {
        let small = stock(&field(20), 1);
        assert_eq!((small.vertices, small.triangles, small.cell), (441, 800, 0.0));
        let large = field(400);
        let coarse = stock(&large, 1);
        assert!(coarse.cell > 0.0 && coarse.triangles <= MOST_TRIANGLES[0] && coarse.triangles > 5000);
        let (positions, _) = clustered(&large, coarse.cell);
        for p in positions {
            // A mean over a cell leaves a surface of this curvature by no more than the cell.
            assert!(((p.x * 0.1).sin() * (p.y * 0.1).cos() - p.z).abs() < coarse.cell);
        }
    }
}
