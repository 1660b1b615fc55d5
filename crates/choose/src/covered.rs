//! What the operations of a job do already.

use ir::Program;
use std::collections::BTreeSet;
use wheel::operation::{OperationKind, by_lines};
use wheel::part::{Part, SurfaceKind};

/// What the operations of a job do.
#[derive(Debug, Default)]
pub(crate) struct Covered {
    /// Whether one of them roughs.
    pub(crate) roughing: bool,
    floor: bool,
    /// Keyword, word and blade of the surfaces that they finish.
    finished: BTreeSet<(&'static str, &'static str, usize)>,
}

impl Covered {
    /// What the operations of a program do, other than the one with a name.
    pub(crate) fn of(program: &Program, left_out: &str) -> Self {
        let mut covered = Self::default();
        let surfaces = |kind: SurfaceKind| {
            wheel::operation::word(kind).map(|(keyword, word, blade)| (keyword, word, blade.index()))
        };
        for (_, operation) in program.operations.iter().filter(|(_, operation)| operation.name != left_out) {
            match &operation.kind {
                OperationKind::Roughing { .. } => covered.roughing = true,
                OperationKind::Channel { allowance_vane, .. } => covered.floor |= allowance_vane.is_none(),
                OperationKind::Flank { faces, .. } => {
                    covered.finished.extend(faces.iter().filter_map(|face| surfaces(SurfaceKind::Face(*face))));
                }
                OperationKind::Point { surfaces: finished, .. } => {
                    covered.finished.extend(finished.iter().filter_map(|surface| surfaces(*surface)));
                }
            }
        }
        covered
    }

    /// Properties of the operations of a kind that finish what is left; none where nothing is.
    pub(crate) fn left(&self, part: &Part, keyword: &'static str) -> Vec<Vec<(&'static str, String)>> {
        if keyword == "channel" {
            return if self.floor { Vec::new() } else { vec![Vec::new()] };
        }
        let exists = |surface: SurfaceKind| match surface {
            SurfaceKind::Fillet(face) => part.blade(face.blade).fillet.is_some(),
            SurfaceKind::InletEdge(blade) => part.edge(blade, 0).is_some(),
            SurfaceKind::OutletEdge(blade) => part.edge(blade, 1).is_some(),
            // Tips are turned.
            SurfaceKind::Tip(_) => false,
            _ => true,
        };
        // Of each set of words, the blades on which it is left.
        let mut groups: Vec<(Vec<&'static str>, Vec<usize>)> = Vec::new();
        let mut any_done = false;
        for blade in part.blade_ids() {
            let of_kind = by_lines(blade).into_iter().filter(|(surface, kind, _)| *kind == keyword && exists(*surface));
            let (done, left): (Vec<_>, Vec<_>) = of_kind
                .map(|(_, _, word)| word)
                .partition(|word| self.finished.contains(&(keyword, *word, blade.index())));
            any_done |= !done.is_empty();
            if left.is_empty() {
                continue;
            }
            match groups.iter_mut().find(|(words, _)| *words == left) {
                Some((_, blades)) => blades.push(blade.index()),
                None => groups.push((left, vec![blade.index()])),
            }
        }
        let all = part.blades.len();
        // Edges are told at all times, as some blades have one alone.
        let property = if keyword == "edge" { "edges" } else { "faces" };
        let of_group = |(words, of): (Vec<&'static str>, Vec<usize>)| {
            let mut properties = Vec::new();
            if keyword == "edge" || (any_done && words.len() < 2) {
                properties.push((property, words.join(", ")));
            }
            if any_done && of.len() < all {
                let names: Vec<&str> = of.iter().map(|blade| part.blades[*blade].name.as_str()).collect();
                properties.push(("blades", names.join(", ")));
            }
            properties
        };
        if any_done {
            return groups.into_iter().map(of_group).collect();
        }
        // Nothing is done yet: one operation for all blades, which passes over surfaces that a blade does not have.
        let words = groups.into_iter().fold(Vec::new(), |mut words: Vec<&'static str>, (more, _)| {
            words.extend(more.into_iter().filter(|word| !words.contains(word)).collect::<Vec<_>>());
            words
        });
        if words.is_empty() { Vec::new() } else { vec![of_group((words, (0..all).collect()))] }
    }
}
