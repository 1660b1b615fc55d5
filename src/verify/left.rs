//! What is left of the blank before the first operation, where the job gives its mesh: how deep a point lies in it, and
//! what it lacks of the finished part.

use crate::collide::{Cloud, CloudPoint};
use crate::diag::{Diag, Sink, codes::verification};
use crate::ir::Program;
use crate::part::Sample;
use crate::stock::{Mesh, mesh::halves};
use crate::units::length;
use nalgebra::Point3;
use rayon::prelude::*;

/// Longest side of a piece of the surface, mm; the middle of each piece is a sample.
const SPACING: f64 = 0.25;

/// Samples above which they lie farther apart.
const MOST_SAMPLES: f64 = 4e6;

/// Depth below a surface of the part from which what lacks is reported, mm.
const SHOWN: f64 = 0.1;

/// Samples of the surface of what is left, with normals out of the material.
pub struct Left {
    cloud: Cloud,
}

impl Left {
    /// Samples of a closed mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let corners = |t: &[u32; 3]| t.map(|i| mesh.vertices[i as usize]);
        let size = |t: &[u32; 3]| {
            let [a, b, c] = corners(t);
            [0.5 * (b - a).cross(&(c - a)).norm(), (b - a).norm().max((c - b).norm()).max((a - c).norm())]
        };
        let [area, way] = mesh.triangles.iter().map(size).fold([0.0; 2], |sum, t| [sum[0] + t[0], sum[1] + t[1]]);
        // Pieces of half a square each, and two to each side of a needle.
        let spacing = SPACING.max((8.0 * area / MOST_SAMPLES).sqrt()).max(4.0 * way / MOST_SAMPLES);
        let points: Vec<CloudPoint> = mesh
            .triangles
            .par_iter()
            .flat_map_iter(|t| {
                let mut points = Vec::new();
                pieces(&corners(t), spacing, &mut points);
                points
            })
            .collect();
        Self { cloud: Cloud::new(points) }
    }

    /// Distance of a point to the surface, mm, positive in the material; at most half of the spacing of the samples too
    /// large.
    pub fn depth(&self, p: &Point3<f64>) -> f64 {
        let Some((distance, index)) = self.cloud.least(|q| (q - p).norm(), f64::INFINITY) else { return 0.0 };
        let nearest = &self.cloud.points()[index];
        if (p - nearest.position).dot(&nearest.normal) > 0.0 { -distance } else { distance }
    }

    /// Reports what is missing of the part before the first operation.
    pub(super) fn report(&self, program: &Program, samples: &[Sample], sink: &mut Sink) {
        let lacks = samples.par_iter().map(|s| (-self.depth(&s.position), s));
        let Some((depth, sample)) = lacks.reduce_with(|a, b| if b.0 > a.0 { b } else { a }) else { return };
        if depth < SHOWN {
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
