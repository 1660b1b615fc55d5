//! Meshes of the stock for the page, coarsened by clustering of their vertices until they are small enough.

use super::pack::{Bytes, Frame};
use nalgebra::{Matrix3, Point3, Vector3};
use serde::Serialize;
use std::collections::BTreeMap;

/// Twice the area of a triangle below which it has no normal, mm2.
const NO_AREA: f64 = 1e-12;

/// Stock that stands after an operation.
#[derive(Clone, Debug, Default)]
pub struct StockStage {
    /// Name of the stage, such as the operation that it follows.
    pub name: String,
    /// Vertices, part frame, mm.
    pub positions: Vec<Point3<f64>>,
    /// Corners of each triangle, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Edge of the cells of the mesh, mm; zero for a mesh from a file.
    pub cell: f64,
    /// Index of the operation that it follows; `None` for what stands at the start.
    pub after: Option<usize>,
}

/// Most triangles of one mesh, and of all meshes.
const MAX_TRIANGLES: [usize; 2] = [60_000, 360_000];

/// Number of vertices that an index of 16 bit can address.
const MAX_INDEXED_VERTICES: usize = 65_535;

/// Growth of the cells while a mesh is still too large.
const CELL_GROWTH: f64 = 1.25;

/// Enough rounds to grow from the first cell to a cell that holds the whole part.
const MAX_COARSENINGS: usize = 60;

/// One mesh in the form of the page.
#[derive(Serialize)]
pub(super) struct StockData {
    name: String,
    frame: Frame,
    vertices: usize,
    pub(super) triangles: usize,
    /// Edge of the cells in which vertices were joined, mm; zero when no vertices were joined.
    pub(super) cell: f64,
    /// Edge of the cells of the mesh before, mm.
    mesh_cell: f64,
    /// Index of the operation that it follows.
    after: Option<usize>,
    #[serde(skip)]
    pub(super) positions: Bytes,
    #[serde(skip)]
    pub(super) indices: Bytes,
}

/// Content of a cell: vertices, and the planes of their triangles weighted by area.
#[derive(Clone)]
struct Joined {
    sum: Vector3<f64>,
    count: f64,
    planes: Matrix3<f64>,
    at: Vector3<f64>,
}

/// Weight of the mean of the vertices against the planes. It decides the place only where the planes leave it
/// undetermined.
const MEAN_WEIGHT: f64 = 0.02;

impl Joined {
    const EMPTY: Self =
        Self { sum: Vector3::new(0.0, 0.0, 0.0), count: 0.0, planes: ZERO, at: Vector3::new(0.0, 0.0, 0.0) };

    /// The point nearest to all planes in the sense of least squares (Lindstrom 2000), so that edges and corners keep
    /// their place; a mean would round them off. At most `reach` from the mean.
    fn place(&self, reach: f64) -> Point3<f64> {
        let mean = self.sum / self.count.max(1.0);
        let weight = (self.planes.trace() * MEAN_WEIGHT).max(f64::MIN_POSITIVE);
        let left = self.planes + Matrix3::identity() * weight;
        let best = left.cholesky().map_or(mean, |c| c.solve(&(self.at + mean * weight)));
        let off = best - mean;
        Point3::from(mean + off * (reach / off.norm().max(reach)))
    }
}

const ZERO: Matrix3<f64> = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);

/// A mesh with the vertices of each cell joined.
fn clustered(stage: &StockStage, cell: f64) -> (Vec<Point3<f64>>, Vec<[usize; 3]>) {
    let mut cells: BTreeMap<[i64; 3], usize> = BTreeMap::new();
    let mut joined: Vec<Joined> = Vec::new();
    let vertex: Vec<usize> = stage
        .positions
        .iter()
        .map(|p| {
            let key = [p.x, p.y, p.z].map(|x| (x / cell).floor() as i64);
            let next = joined.len();
            let index = *cells.entry(key).or_insert(next);
            if index == next {
                joined.push(Joined::EMPTY);
            }
            joined[index].sum += p.coords;
            joined[index].count += 1.0;
            index
        })
        .collect();
    let corner = |i: u32| Some((*vertex.get(i as usize)?, *stage.positions.get(i as usize)?));
    let mut triangles = Vec::new();
    for t in &stage.triangles {
        let (Some(a), Some(b), Some(c)) = (corner(t[0]), corner(t[1]), corner(t[2])) else { continue };
        // Its length is twice the area.
        let normal = (b.1 - a.1).cross(&(c.1 - a.1));
        if let Some(unit) = normal.try_normalize(NO_AREA) {
            let plane = unit * normal.transpose();
            for own in [a.0, b.0, c.0] {
                joined[own].planes += plane;
                joined[own].at += plane * a.1.coords;
            }
        }
        if a.0 != b.0 && b.0 != c.0 && a.0 != c.0 {
            triangles.push([a.0, b.0, c.0]);
        }
    }
    (joined.iter().map(|j| j.place(0.5 * cell)).collect(), triangles)
}

/// A mesh that is small enough for the page when the page has `stages` meshes in all.
pub(super) fn stock(stage: &StockStage, stages: usize) -> StockData {
    let most = MAX_TRIANGLES[0].min(MAX_TRIANGLES[1] / stages.max(1));
    let frame = Frame::around(stage.positions.iter().map(|p| [p.x, p.y, p.z]));
    let fits = |vertices: usize, triangles: usize| vertices <= MAX_INDEXED_VERTICES && triangles <= most;
    let mut cell = 0.0;
    let whole = fits(stage.positions.len(), stage.triangles.len());
    let (positions, triangles) = if whole {
        (stage.positions.clone(), stage.triangles.iter().map(|t| t.map(|i| i as usize)).collect())
    } else {
        // A surface of n triangles in a box of this size has edges of about this length.
        let edge = frame.size.iter().map(|s| s * s).sum::<f64>().sqrt() / (most.max(1) as f64).sqrt();
        let mut mesh = (Vec::new(), Vec::new());
        cell = edge;
        for _ in 0..MAX_COARSENINGS {
            mesh = clustered(stage, cell);
            if fits(mesh.0.len(), mesh.1.len()) {
                break;
            }
            cell *= CELL_GROWTH;
        }
        mesh
    };
    let mut data = StockData {
        name: stage.name.clone(),
        frame,
        vertices: positions.len(),
        triangles: triangles.len(),
        cell,
        mesh_cell: stage.cell,
        after: stage.after,
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
        StockStage { name: "field".to_owned(), positions, triangles, cell: 1.0, after: None }
    }

    #[test]
    fn small_meshes_stay_and_large_ones_are_coarsened_near_their_surface() {
        let small = stock(&field(20), 1);
        assert_eq!((small.vertices, small.triangles, small.cell), (441, 800, 0.0));
        let large = field(400);
        let coarse = stock(&large, 1);
        assert!(coarse.cell > 0.0 && coarse.triangles <= MAX_TRIANGLES[0] && coarse.triangles > 5000);
        let (positions, _) = clustered(&large, coarse.cell);
        for p in positions {
            // The mean over a cell differs from a surface of this curvature by at most the cell.
            assert!(((p.x * 0.1).sin() * (p.y * 0.1).cos() - p.z).abs() < coarse.cell);
        }
    }

    /// The ridge of a gable runs between the cells and stays in place.
    #[test]
    fn edges_stay_where_they_are() {
        let mut roof = field(400);
        for p in &mut roof.positions {
            p.z = 20.0 - 0.8 * (p.x - 50.3).abs();
        }
        let (positions, _) = clustered(&roof, 1.7);
        let ridge = positions.iter().filter(|p| (p.x - 50.3).abs() < 0.6 && p.y > 2.0 && p.y < 98.0);
        let highest: Vec<f64> = ridge.map(|p| p.z).filter(|z| *z > 19.6).collect();
        assert!(highest.len() > 40, "{} vertices on the ridge", highest.len());
        for z in highest {
            assert!((19.9..20.01).contains(&z), "the ridge is at {z}");
        }
    }
}
