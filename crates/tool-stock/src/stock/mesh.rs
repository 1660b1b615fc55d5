//! Closed triangle meshes.

use nalgebra::Point3;
use std::collections::BTreeMap;

/// Triangles that bound a solid, seen counter-clockwise from outside.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "StoredMesh"))]
pub struct Mesh {
    /// Corners, mm.
    pub vertices: Vec<Point3<f64>>,
    /// Indices of the corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// A mesh that is read.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredMesh {
    vertices: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredMesh> for Mesh {
    type Error = &'static str;

    fn try_from(StoredMesh { vertices, triangles }: StoredMesh) -> Result<Self, Self::Error> {
        if triangles.iter().flatten().any(|i| *i as usize >= vertices.len()) {
            return Err("a triangle of a mesh has a corner that is not there");
        }
        if vertices.iter().any(|p| !p.iter().all(|x| x.is_finite())) {
            return Err("a corner of a mesh has a number that is not finite");
        }
        Ok(Self { vertices, triangles })
    }
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
