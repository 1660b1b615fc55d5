//! What is left of the blank before the first operation, where the job gives its mesh: the depth of a point in it, and
//! material of the finished part that is missing from it.

use base::units::length;
use diagnostics::{Diag, Sink, codes::verification};
use ir::Program;
use nalgebra::Point3;
use rayon::prelude::*;
use tool_stock::collide::{Cloud, CloudPoint};
use tool_stock::stock::{Mesh, mesh::halves};
use wheel::part::Sample;

/// Longest side of a piece of the surface, mm; the middle of each piece is a sample.
const MAX_PIECE_SIDE: f64 = 0.25;

/// Largest number of samples; a larger surface has a larger spacing.
const MAX_SAMPLES: f64 = 4e6;

/// Depth below a surface of the part from which missing material is reported, mm.
const MIN_REPORTED_DEPTH: f64 = 0.1;

/// What is left: samples of its surface, and its triangles over a grid in the plane of X and Y.
pub struct Left<'a> {
    cloud: Cloud,
    columns: Columns<'a>,
}

impl<'a> Left<'a> {
    /// Of a closed mesh.
    pub fn new(mesh: &'a Mesh) -> Self {
        let corners = |t: &[u32; 3]| t.map(|i| mesh.vertices[i as usize]);
        let size = |t: &[u32; 3]| {
            let [a, b, c] = corners(t);
            [0.5 * (b - a).cross(&(c - a)).norm(), (b - a).norm().max((c - b).norm()).max((a - c).norm())]
        };
        let [area, way] = mesh.triangles.iter().map(size).fold([0.0; 2], |sum, t| [sum[0] + t[0], sum[1] + t[1]]);
        // Pieces of half a square each, and two to each side of a needle.
        let spacing = MAX_PIECE_SIDE.max((8.0 * area / MAX_SAMPLES).sqrt()).max(4.0 * way / MAX_SAMPLES);
        let points: Vec<CloudPoint> = mesh
            .triangles
            .par_iter()
            .flat_map_iter(|t| {
                let mut points = Vec::new();
                pieces(&corners(t), spacing, &mut points);
                points
            })
            .collect();
        Self { cloud: Cloud::new(points), columns: Columns::new(mesh) }
    }

    /// Distance of a point to the surface, mm, positive in the material; at most half of the spacing of the samples too
    /// large.
    pub fn depth(&self, p: &Point3<f64>) -> f64 {
        let Some((distance, _)) = self.cloud.least(|q| (q - p).norm(), f64::INFINITY) else { return 0.0 };
        if self.columns.inside(p) { distance } else { -distance }
    }

    /// Reports what is missing of the part before the first operation.
    pub(super) fn report(&self, program: &Program, samples: &[Sample], sink: &mut Sink) {
        // Distances take long where they are large, and most samples lie deep in the material.
        let outside = samples.par_iter().filter(|s| !self.columns.inside(&s.position));
        let missing = outside.map(|s| (-self.depth(&s.position), s));
        let Some((depth, sample)) = missing.reduce_with(|a, b| if b.0 > a.0 { b } else { a }) else { return };
        if depth < MIN_REPORTED_DEPTH {
            return;
        }
        let cell = super::stock::usual_cell(&program.stock.profile);
        let new = if depth > cell { Diag::error } else { Diag::remark };
        sink.push(
            new(
                verification::LEFT_LACKS,
                format!(
                    "before the first operation the stock ends up to {} below a surface of the part",
                    length(depth)
                ),
            )
            .place(sample.surface.to_string(), sample.position)
            .note(format!("meshes of `--stock` round edges within a cell; more than {} are an error", length(cell)))
            .help("give the stock after the last operation that was done, or a finer mesh of it: `--stock-cell`"),
        );
    }
}

/// The triangles of a mesh in the columns along Z over a square grid.
///
/// Normals of the nearest sample do not tell the side of a point near a sharp edge; the surfaces above the point do.
struct Columns<'a> {
    mesh: &'a Mesh,
    low: [f64; 2],
    cell: f64,
    /// Number of columns along X and Y.
    count: [usize; 2],
    /// Triangles over each column, column by column along X.
    over: Vec<Vec<u32>>,
}

impl<'a> Columns<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in &mesh.vertices {
            for k in 0..2 {
                (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
            }
        }
        let size = [0, 1].map(|k: usize| high[k] - low[k]);
        // About as many columns as triangles.
        let cell = (size[0].max(size[1]) / (mesh.triangles.len() as f64).sqrt()).max(f64::MIN_POSITIVE);
        let count = size.map(|size| (size / cell).ceil().max(1.0) as usize);
        let mut columns = Self { mesh, low, cell, count, over: vec![Vec::new(); count[0] * count[1]] };
        for (n, triangle) in (0_u32..).zip(&mesh.triangles) {
            let corners = triangle.map(|i| columns.column(&mesh.vertices[i as usize]));
            let range = |k: usize| {
                let [a, b, c] = corners.map(|corner| corner[k]);
                a.min(b).min(c)..=a.max(b).max(c)
            };
            for j in range(1) {
                for i in range(0) {
                    columns.over[j * count[0] + i].push(n);
                }
            }
        }
        columns
    }

    /// Column of a point; the nearest column for a point outside of the grid.
    fn column(&self, p: &Point3<f64>) -> [usize; 2] {
        [0, 1].map(|k| (((p[k] - self.low[k]) / self.cell) as usize).min(self.count[k] - 1))
    }

    /// True when more surfaces above the point face up than down.
    fn inside(&self, p: &Point3<f64>) -> bool {
        let [i, j] = self.column(p);
        self.over[j * self.count[0] + i].iter().map(|n| self.above(*n, p)).sum::<i32>() > 0
    }

    /// 1 when a triangle that faces up lies above the point, -1 when one that faces down does, else 0.
    fn above(&self, triangle: u32, p: &Point3<f64>) -> i32 {
        let t = self.mesh.triangles[triangle as usize];
        let turns: i32 = [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])].map(|(a, b)| self.turn(a, b, p)).iter().sum();
        if turns == 0 {
            return 0;
        }
        let [a, b, c] = t.map(|i| self.mesh.vertices[i as usize]);
        let normal = (b - a).cross(&(c - a));
        // Height of the surface over the point, times the Z component of the normal.
        let over = normal.dot(&(a - p));
        if (over > 0.0) == (normal.z > 0.0) { turns } else { 0 }
    }

    /// Half of a turn of an edge round a point, seen against Z: 1 where the edge runs up in Y to the right of the point,
    /// -1 where it runs down there, else 0. Both triangles at an edge compute it from its ends in the same order, so that
    /// no point between them is lost or counted twice.
    fn turn(&self, from: u32, to: u32, p: &Point3<f64>) -> i32 {
        let [a, b] = [from.min(to), from.max(to)].map(|i| self.mesh.vertices[i as usize]);
        if (a.y > p.y) == (b.y > p.y) {
            return 0;
        }
        let left = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
        let right_of_point = (left < 0.0) != (b.y > a.y);
        if !right_of_point {
            return 0;
        }
        if (b.y > p.y) == (from < to) { 1 } else { -1 }
    }
}

/// Samples of a triangle: middles of its pieces.
fn pieces(corners: &[Point3<f64>; 3], spacing: f64, points: &mut Vec<CloudPoint>) {
    let [a, b, c] = corners;
    if (b - a).norm().max((c - b).norm()).max((a - c).norm()) > spacing {
        halves(corners).iter().for_each(|half| pieces(half, spacing, points));
        return;
    }
    // A triangle without an area has a neighbour at the same place.
    if let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) {
        points.push(CloudPoint { position: Point3::from((a.coords + b.coords + c.coords) / 3.0), normal, tag: 0 });
    }
}
