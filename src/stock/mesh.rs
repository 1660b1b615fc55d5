//! Closed triangle meshes.

use nalgebra::Point3;

/// Triangles that bound a solid, seen counter-clockwise from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Corners, mm.
    pub vertices: Vec<Point3<f64>>,
    /// Indices of the corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Enclosed volume by the divergence theorem.
    pub fn volume(&self) -> f64 {
        let corner = |i: u32| self.vertices[i as usize].coords;
        self.triangles.iter().map(|t| corner(t[0]).dot(&corner(t[1]).cross(&corner(t[2])))).sum::<f64>() / 6.0
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
