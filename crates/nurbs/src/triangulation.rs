//! Triangles between points of a surface (Xu 2): the Delaunay triangulation of their places in a chart.
//!
//! Points are inserted one after the other, each into the triangulation so far. Edges are flipped until no circle about
//! a triangle contains a point (Xu 10, 11). The predicates are exact, so that rows of a grid cause no failure.

use super::GeomError;
use nalgebra::{Point3, Vector3};
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation as _};

/// Points of a surface with the triangles between them.
#[derive(Clone, Debug)]
pub struct Triangulation {
    points: Vec<Point3<f64>>,
    faces: Vec<[usize; 3]>,
    /// Neighbours of each point along edges, ascending.
    neighbours: Vec<Vec<usize>>,
}

/// The point of the triangles nearest to a given point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangulationFoot {
    /// The nearest point.
    pub point: Point3<f64>,
    /// Unit normal of its triangle.
    pub normal: Vector3<f64>,
    /// Index of its triangle.
    pub face: usize,
}

/// A place in the chart with the index of its point.
struct Located {
    at: Point2<f64>,
    index: usize,
}

impl HasPosition for Located {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.at
    }
}

impl Triangulation {
    /// The triangulation of points by their places in a chart, mm. A chart that approximately preserves lengths gives
    /// well shaped triangles. Triangles run counter-clockwise in the chart. Where the rim of the surface is hollow,
    /// triangles over its chord do not belong to the surface: triangles with an edge longer than `longest` in space,
    /// mm, are left out.
    ///
    /// # Errors
    /// Fewer than three points, a number that is not finite, two points at one place, or no triangle.
    pub fn delaunay(points: Vec<Point3<f64>>, chart: &[[f64; 2]], longest: f64) -> Result<Self, GeomError> {
        if points.len() < 3 || chart.len() != points.len() {
            return Err(GeomError::TooFewPoints { given: points.len().min(chart.len()), needed: 3 });
        }
        let mut inner: DelaunayTriangulation<Located> = DelaunayTriangulation::new();
        for (index, at) in chart.iter().enumerate() {
            if !points[index].coords.iter().all(|x| x.is_finite()) {
                return Err(GeomError::NotFinite(index));
            }
            let place = Located { at: Point2::new(at[0], at[1]), index };
            inner.insert(place).map_err(|_| GeomError::NotFinite(index))?;
            if inner.num_vertices() != index + 1 {
                return Err(GeomError::CoincidentPoints(index - 1));
            }
        }
        let short = |[a, b, c]: &[usize; 3]| {
            [(a, b), (b, c), (c, a)].iter().all(|(p, q)| (points[**p] - points[**q]).norm() <= longest)
        };
        let faces: Vec<[usize; 3]> =
            inner.inner_faces().map(|f| f.vertices().map(|v| v.data().index)).filter(short).collect();
        if faces.is_empty() {
            return Err(GeomError::Singular);
        }
        let mut neighbours = vec![Vec::new(); points.len()];
        for [a, b, c] in &faces {
            for (p, q) in [(*a, *b), (*b, *c), (*c, *a)] {
                neighbours[p].push(q);
                neighbours[q].push(p);
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        Ok(Self { points, faces, neighbours })
    }

    /// The points in their original order.
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Indices of the corners of each triangle, counter-clockwise in the chart.
    pub fn faces(&self) -> &[[usize; 3]] {
        &self.faces
    }

    /// Neighbours of a point along edges, ascending.
    pub fn neighbours(&self, point: usize) -> &[usize] {
        &self.neighbours[point]
    }

    /// Corners of a triangle.
    pub fn corners(&self, face: usize) -> [Point3<f64>; 3] {
        self.faces[face].map(|i| self.points[i])
    }

    /// Normal of a triangle; its length is twice the area, mm2.
    fn area_normal(&self, face: usize) -> Vector3<f64> {
        let [a, b, c] = self.corners(face);
        (b - a).cross(&(c - a))
    }

    /// Unit normal of every point: the sum of the normals of its triangles, weighted by area (Xu 19). Zero where the
    /// normals cancel out.
    pub fn normals(&self) -> Vec<Vector3<f64>> {
        let mut sums = vec![Vector3::zeros(); self.points.len()];
        for (face, corners) in self.faces.iter().enumerate() {
            let normal = self.area_normal(face);
            for corner in corners {
                sums[*corner] += normal;
            }
        }
        sums.into_iter().map(|n| n.try_normalize(0.0).unwrap_or_default()).collect()
    }

    /// Mean length of the edges at a point, mm; zero without edges.
    pub fn mean_edge(&self, point: usize) -> f64 {
        let lengths = self.neighbours[point].iter().map(|n| (self.points[*n] - self.points[point]).norm());
        lengths.sum::<f64>() / self.neighbours[point].len().max(1) as f64
    }

    /// Points within a radius of a point, with this point first, found along edges: a nearby sheet that is not
    /// connected within the radius is not found.
    pub fn within(&self, point: usize, radius: f64) -> Vec<usize> {
        let mut found = vec![point];
        let mut next = 0;
        let mut seen = std::collections::BTreeSet::from([point]);
        while let Some(at) = found.get(next).copied() {
            next += 1;
            for n in &self.neighbours[at] {
                if (self.points[*n] - self.points[point]).norm() <= radius && seen.insert(*n) {
                    found.push(*n);
                }
            }
        }
        found
    }

    /// The nearest point of all triangles.
    pub fn nearest(&self, p: &Point3<f64>) -> Option<TriangulationFoot> {
        let mut best: Option<(f64, usize, Point3<f64>)> = None;
        for face in 0..self.faces.len() {
            let foot = nearest_on_triangle(p, &self.corners(face));
            let square = (foot - p).norm_squared();
            if best.is_none_or(|b| square < b.0) {
                best = Some((square, face, foot));
            }
        }
        let (_, face, point) = best?;
        Some(TriangulationFoot { point, normal: self.area_normal(face).try_normalize(0.0)?, face })
    }

    /// True when a point lies over the surface: the vector from its foot on the triangles points to the side of the
    /// normal there (Xu 9 and 21).
    pub fn lies_under(&self, p: &Point3<f64>) -> bool {
        self.nearest(p).is_some_and(|foot| (p - foot.point).dot(&foot.normal) > 0.0)
    }
}

/// Point of a triangle nearest to a given point: inside where its foot on the plane lies inside, else on an edge.
fn nearest_on_triangle(p: &Point3<f64>, corners: &[Point3<f64>; 3]) -> Point3<f64> {
    let [a, b, c] = corners;
    let normal = (b - a).cross(&(c - a));
    let inside = |x: &Point3<f64>, y: &Point3<f64>| (y - x).cross(&(p - x)).dot(&normal) >= 0.0;
    if normal.norm_squared() > 0.0 && inside(a, b) && inside(b, c) && inside(c, a) {
        return p - normal * ((p - a).dot(&normal) / normal.norm_squared());
    }
    let on_edge = |x: &Point3<f64>, y: &Point3<f64>| {
        let way = y - x;
        let square = way.norm_squared();
        let t = if square > 0.0 { ((p - x).dot(&way) / square).clamp(0.0, 1.0) } else { 0.0 };
        x + way * t
    };
    let feet = [on_edge(a, b), on_edge(b, c), on_edge(c, a)];
    let gap = |q: &Point3<f64>| (q - p).norm_squared();
    feet.into_iter().min_by(|x, y| gap(x).total_cmp(&gap(y))).unwrap_or(*a)
}
