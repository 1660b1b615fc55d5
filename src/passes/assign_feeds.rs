//! `assign-feeds`: the process feed on cuts, the link feed on links, none on rapids.

use crate::ir::{ClPlan, MoveKind, Program};

/// Sets the feed of every move.
pub(super) fn run(program: &Program, cl: &mut ClPlan) {
    for planned in &mut cl.operations {
        let operation = &program.operations[planned.operation];
        for m in &mut planned.moves {
            m.feed = match m.kind {
                MoveKind::Rapid => None,
                MoveKind::Link => Some(operation.link_feed.get()),
                MoveKind::Cut => Some(operation.feed.get()),
            };
        }
    }
}
