//! Which surfaces of which sectors the operations of a job are to make.

use crate::{Operation, OperationKind, Program};
use std::collections::BTreeSet;
use wheel::part::{SurfaceId, SurfaceKind};

impl Program {
    /// Whether the operations are to make a surface in its sector. A job may limit operations to sectors: what it requires of surfaces
    /// is asked in these sectors. A kind of surface that no operation names is asked wherever any operation finishes.
    pub fn asks_for(&self, id: SurfaceId) -> bool {
        let SurfaceId { kind, sector } = id;
        let SurfaceKind::Fillet(face) = kind else { return self.sectors_of(&|o| makes(o, kind)).contains(&sector) };
        let fillet_of = |o: &Operation| match &o.kind {
            // The fillet round an edge goes with those of the faces.
            OperationKind::Point { surfaces, .. } => surfaces.iter().any(|s| match s {
                SurfaceKind::Fillet(other) => {
                    *other == face || (face.edge_end().is_some() && other.blade == face.blade)
                }
                _ => false,
            }),
            OperationKind::Roughing { .. } | OperationKind::Flank { .. } | OperationKind::Channel { .. } => false,
        };
        if self.operations.iter().any(|(_, o)| fillet_of(o)) {
            return self.sectors_of(&fillet_of).contains(&sector);
        }
        // The ball that finishes face and floor leaves a fillet between them.
        let (passage, side) = self.part.passage_of(face);
        let back = if side == 1 { self.part.passage(passage).sectors } else { 0 };
        let of_floor = (sector + self.part.vane_count - back) % self.part.vane_count;
        self.sectors_of(&|o| makes(o, SurfaceKind::Face(face))).contains(&sector)
            && self.sectors_of(&|o| makes(o, SurfaceKind::Hub(passage))).contains(&of_floor)
    }

    /// Sectors of the operations of finishing that are taken; those of all finishing where none is, and all sectors without finishing.
    fn sectors_of(&self, is_taken: &dyn Fn(&Operation) -> bool) -> BTreeSet<u32> {
        let finishing = || self.operations.iter().map(|(_, o)| o).filter(|o| o.kind.roughing().is_none());
        let sectors = |of: Vec<&Operation>| of.into_iter().flat_map(|o| &o.sectors).copied().collect::<BTreeSet<u32>>();
        let own = sectors(finishing().filter(|o| is_taken(o)).collect());
        if !own.is_empty() {
            return own;
        }
        let all = sectors(finishing().collect());
        if all.is_empty() { (0..self.part.vane_count).collect() } else { all }
    }
}

/// Whether an operation finishes a kind of surface.
fn makes(operation: &Operation, kind: SurfaceKind) -> bool {
    match &operation.kind {
        OperationKind::Roughing { .. } => false,
        OperationKind::Flank { faces, .. } => faces.iter().any(|face| SurfaceKind::Face(*face) == kind),
        OperationKind::Channel { allowance_vane, .. } => {
            allowance_vane.is_none() && matches!(kind, SurfaceKind::Hub(_))
        }
        OperationKind::Point { surfaces, .. } => surfaces.contains(&kind),
    }
}
