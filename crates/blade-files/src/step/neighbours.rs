//! Which faces of a file meet at an edge.

use super::picks::ListedFace;
use super::table::{Entity, EntityTable};
use diagnostics::Diag;

/// Edges with the faces that they belong to, by the places of these in the list.
#[derive(Clone, Debug)]
pub(super) struct EdgeFaces {
    pairs: Vec<(u64, usize)>,
}

impl EdgeFaces {
    /// Edges of listed faces. A face whose border is not read has none.
    pub(super) fn of(table: &EntityTable<'_>, faces: &[ListedFace<'_>]) -> Self {
        let edges = |face: &ListedFace<'_>| edges(table, &face.entity).unwrap_or_default();
        let with_face = |(k, face)| edges(face).into_iter().map(move |edge| (edge, k));
        let mut pairs: Vec<(u64, usize)> = faces.iter().enumerate().flat_map(with_face).collect();
        pairs.sort_unstable();
        Self { pairs }
    }

    /// Faces with one of these edges.
    pub(super) fn at(&self, edges: &[u64]) -> Vec<usize> {
        let of = |edge: u64| {
            let first = self.pairs.partition_point(|(other, _)| *other < edge);
            self.pairs[first..].iter().take_while(move |(other, _)| *other == edge).map(|(_, face)| *face)
        };
        edges.iter().flat_map(|edge| of(*edge)).collect()
    }
}

/// Numbers of the edges of a face.
fn edges(table: &EntityTable<'_>, face: &Entity<'_>) -> Result<Vec<u64>, Diag> {
    let mut edges = Vec::new();
    for bound in face.arguments("FACE_SURFACE")?.references(1)? {
        let bound = table.entity(bound, face.span)?;
        let border = table.entity(bound.arguments("FACE_BOUND")?.reference(1)?, bound.span)?;
        for oriented in border.arguments("EDGE_LOOP")?.references(1)? {
            let oriented = table.entity(oriented, border.span)?;
            edges.push(oriented.arguments("ORIENTED_EDGE")?.reference(3)?);
        }
    }
    Ok(edges)
}
