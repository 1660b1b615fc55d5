//! Faces of STEP files with their borders: points of their edges in order, and the chains of edges between corners.

use super::curve::StepCurve;
use super::picks::ListedFace;
use super::placement::StepGeometry;
use super::surface::{StepSurface, SurfaceFoot};
use super::table::Entity;
use base::source::Span;
use diagnostics::{Diag, printable};
use nalgebra::{Point3, Vector2};

/// Points of an edge less one.
pub(super) const EDGE_STEPS: usize = 512;

/// Largest distance of a curve from the vertices of its edge, and of an edge from its surface, mm. Files of usual accuracy keep
/// 0.001 mm to 0.01 mm.
pub(super) const EDGE_GAP_MM: f64 = 0.02;

/// Most edges of a face that is read.
const MAX_EDGES: usize = 1000;

/// A face that was picked.
#[derive(Clone, Debug)]
pub(super) struct StepFace {
    pub(super) number: u64,
    pub(super) span: Span,
    pub(super) name: String,
    pub(super) surface: StepSurface,
    /// Its borders, the outer one first where it is marked.
    pub(super) borders: Vec<StepBorder>,
}

/// A closed border: edges, of which each ends at the first point of the next one.
pub(super) type StepBorder = Vec<StepEdge>;

/// An edge of a border.
#[derive(Clone, Debug)]
pub(super) struct StepEdge {
    /// The number of its curve: two faces that meet there have the same one.
    pub(super) number: u64,
    pub(super) points: Vec<Point3<f64>>,
}

/// A chain of edges of a border.
#[derive(Clone, Debug)]
pub(super) struct StepChain {
    /// Numbers of its edges.
    pub(super) edges: Vec<u64>,
    pub(super) points: Vec<Point3<f64>>,
}

impl StepFace {
    /// Places inside of the face: one in `every` points of its borders, moved towards their middle. Normals at the very border are less
    /// exact, where a surface has a sharp corner by far.
    pub(super) fn inside(&self, every: usize) -> Vec<[f64; 2]> {
        /// Share of the way from the middle to the border.
        const OUT: f64 = 0.75;
        let mut near = None;
        let points = self.borders.iter().flatten().flat_map(|edge| edge.points.iter().step_by(every));
        let border: Vec<Vector2<f64>> = points
            .map(|p| {
                let SurfaceFoot { place, far } = self.surface.nearest(p, near);
                near = if far < EDGE_GAP_MM { Some(place) } else { None };
                place.into()
            })
            .collect();
        let middle = border.iter().sum::<Vector2<f64>>() / border.len().max(1) as f64;
        border.iter().map(|place| (middle + (place - middle) * OUT).into()).collect()
    }
}

impl StepGeometry<'_, '_> {
    /// A listed face at the first of its places.
    pub(super) fn listed(&self, face: &ListedFace<'_>) -> Result<StepFace, Diag> {
        self.of_part(&face.place()).face(&face.entity)
    }

    /// A face with its surface and its borders.
    pub(super) fn face(&self, entity: &Entity<'_>) -> Result<StepFace, Diag> {
        let arguments = entity.arguments("FACE_SURFACE")?;
        let surface = self.surface(arguments.reference(2)?, entity.span)?;
        let mut borders: Vec<StepBorder> = Vec::new();
        for number in arguments.references(1)? {
            let bound = self.entity(number, entity.span)?;
            let of_bound = bound.arguments("FACE_BOUND")?;
            let mut border = self.border(of_bound.reference(1)?, bound.span)?;
            if of_bound.word(2) == Some("F") {
                border.reverse();
                border.iter_mut().for_each(|edge| edge.points.reverse());
            }
            let outer = bound.part("FACE_OUTER_BOUND").is_some();
            if border.is_empty() {
                continue;
            }
            borders.insert(if outer { 0 } else { borders.len() }, border);
        }
        let name = printable(&arguments.text(0)).into_owned();
        Ok(StepFace { number: entity.number, span: entity.span, name, surface, borders })
    }

    /// The edges of a loop; none for a loop that is a point.
    fn border(&self, number: u64, named_at: Span) -> Result<StepBorder, Diag> {
        let entity = self.entity(number, named_at)?;
        if entity.part("VERTEX_LOOP").is_some() {
            return Ok(Vec::new());
        }
        if entity.part("EDGE_LOOP").is_none() {
            return Err(self.unknown(&entity, "border", "EDGE_LOOP"));
        }
        let edges = entity.arguments("EDGE_LOOP")?.references(1)?;
        if edges.len() > MAX_EDGES {
            return Err(entity.fault(format!("#{number} has {} edges, more than {MAX_EDGES}", edges.len())));
        }
        let mut border = Vec::with_capacity(edges.len());
        for edge in edges {
            let oriented = self.entity(edge, entity.span)?;
            let arguments = oriented.arguments("ORIENTED_EDGE")?;
            let number = arguments.reference(3)?;
            let mut points = self.edge(number, oriented.span)?;
            if arguments.word(4) == Some("F") {
                points.reverse();
            }
            border.push(StepEdge { number, points });
        }
        let open = |k: usize| {
            let [here, next] = [k, k + 1].map(|k| &border[k % border.len()].points);
            here.last().zip(next.first()).is_none_or(|(a, b)| nalgebra::distance(a, b) > EDGE_GAP_MM)
        };
        if (0..border.len()).any(open) {
            return Err(entity.fault(format!("the border #{number} is not closed")));
        }
        Ok(border)
    }

    fn vertex(&self, number: u64, named_at: Span) -> Result<Point3<f64>, Diag> {
        let entity = self.entity(number, named_at)?;
        self.point(entity.arguments("VERTEX_POINT")?.reference(1)?, entity.span)
    }

    /// Points of an edge from its first to its last vertex.
    fn edge(&self, number: u64, named_at: Span) -> Result<Vec<Point3<f64>>, Diag> {
        let entity = self.entity(number, named_at)?;
        let arguments = entity.arguments("EDGE_CURVE")?;
        let ends =
            [self.vertex(arguments.reference(1)?, entity.span)?, self.vertex(arguments.reference(2)?, entity.span)?];
        let curve = self.curve(arguments.reference(3)?, entity.span)?;
        let along = arguments.word(4) != Some("F");
        let range = range(&curve, ends, along);
        for (end, t) in ends.iter().zip(range) {
            let gap = nalgebra::distance(end, &curve.at(t).0);
            if gap > EDGE_GAP_MM {
                return Err(entity
                    .fault(format!("the curve of the edge #{number} is {gap:.3} mm away from an end of the edge")));
            }
        }
        let at = |k: usize| curve.at(range[0] + (range[1] - range[0]) * k as f64 / EDGE_STEPS as f64).0;
        Ok((0..=EDGE_STEPS).map(at).collect())
    }
}

/// Parameters of both ends of an edge on its curve. A closed curve goes once round between equal ends.
fn range(curve: &StepCurve, ends: [Point3<f64>; 2], along: bool) -> [f64; 2] {
    let [from, to] = ends.map(|end| curve.nearest(&end));
    let Some([lo, hi]) = curve.domain() else { return [from, to] };
    let whole = hi - lo;
    let closed = nalgebra::distance(&curve.at(lo).0, &curve.at(hi).0) < EDGE_GAP_MM;
    // Ends nearer than this share of the whole are one.
    let same = 1e-9 * whole;
    match (curve, along) {
        (StepCurve::Ellipse(..), true) if to < from + same => [from, to + whole],
        (StepCurve::Ellipse(..), false) if to > from - same => [from, to - whole],
        (StepCurve::Spline(..), true) if closed && to < from + same => {
            [if hi - from < same { lo } else { from }, if to - lo < same { hi } else { to }]
        }
        (StepCurve::Spline(..), false) if closed && to > from - same => {
            [if from - lo < same { hi } else { from }, if hi - to < same { lo } else { to }]
        }
        _ => [from, to],
    }
}

/// Turn of a border at the start of each edge, rad.
fn turns(border: &StepBorder) -> Vec<f64> {
    let way = |points: &[Point3<f64>]| points.first().zip(points.last()).map(|(a, b)| b - a);
    let count = border.len();
    let turn = |k: usize| {
        let [before, here] = [k + count - 1, k].map(|k| &border[k % count].points);
        let ways = way(&before[before.len().saturating_sub(2)..]).zip(way(&here[..here.len().min(2)]));
        ways.map_or(0.0, |(a, b)| a.angle(&b))
    };
    (0..count).map(turn).collect()
}

/// Chains of the edges of a border that begin at these edges.
fn chains(border: &StepBorder, starts: &[usize]) -> Vec<StepChain> {
    let count = border.len();
    let of = |(i, start): (usize, &usize)| {
        let end = starts.get(i + 1).copied().unwrap_or(starts[0] + count);
        let mut chain = StepChain { edges: Vec::new(), points: Vec::new() };
        for edge in (*start..end).map(|k| &border[k % count]) {
            chain.edges.push(edge.number);
            chain.points.extend(edge.points.iter().skip(usize::from(!chain.points.is_empty())));
        }
        chain
    };
    starts.iter().enumerate().map(of).collect()
}

/// The four sides of a border, between its four sharpest corners; `None` where it has no four.
pub(super) fn four_sides(border: &StepBorder) -> Option<[StepChain; 4]> {
    /// Least turn of a corner, rad: 5 deg.
    const CORNER: f64 = 0.087;
    let turns = turns(border);
    let mut order: Vec<usize> = (0..turns.len()).filter(|k| turns[*k] > CORNER).collect();
    order.sort_by(|a, b| turns[*b].total_cmp(&turns[*a]));
    order.truncate(4);
    order.sort_unstable();
    if order.len() < 4 { None } else { chains(border, &order).try_into().ok() }
}

/// Chains of a border between its corners.
pub(super) fn smooth_chains(border: &StepBorder) -> Vec<StepChain> {
    /// Least turn of a corner, rad: 30 deg.
    const CORNER: f64 = 0.52;
    let turns = turns(border);
    let starts: Vec<usize> = (0..turns.len()).filter(|k| turns[*k] > CORNER).collect();
    chains(border, if starts.is_empty() { &[0] } else { &starts })
}
