//! Closed triangle meshes.

use nalgebra::Point3;
use std::collections::BTreeMap;

/// Triangles that bound a solid, seen counter-clockwise from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Corners, mm.
    pub vertices: Vec<Point3<f64>>,
    /// Indices of the corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Enclosed volume by the divergence theorem, mm3.
    pub fn volume(&self) -> f64 {
        // From a corner instead of the origin: the terms are then not larger than the solid.
        let Some(from) = self.vertices.first() else { return 0.0 };
        let terms = self.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|i| self.vertices[i as usize] - from);
            a.dot(&b.cross(&c))
        });
        terms.sum::<f64>() / 6.0
    }

    /// True when each edge is used equally often in both directions: the mesh has no gaps.
    pub fn is_closed(&self) -> bool {
        let mut count: BTreeMap<(u32, u32), i64> = BTreeMap::new();
        for [a, b, c] in &self.triangles {
            for (p, q) in [(*a, *b), (*b, *c), (*c, *a)] {
                *count.entry((p.min(q), p.max(q))).or_default() += if p < q { 1 } else { -1 };
            }
        }
        count.values().all(|n| *n == 0)
    }
}

/// The halves of a triangle across its longest side.
pub fn halves([a, b, c]: &[Point3<f64>; 3]) -> [[Point3<f64>; 3]; 2] {
    let [ab, bc, ca] = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
    let [a, b, c] = if ab >= bc && ab >= ca {
        [a, b, c]
    } else if bc >= ca {
        [b, c, a]
    } else {
        [c, a, b]
    };
    let half = nalgebra::center(a, b);
    [[*a, half, *c], [half, *b, *c]]
}
