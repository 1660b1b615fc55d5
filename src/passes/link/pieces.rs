//! A pass that the travel of the axes does not allow in one go.
//!
//! The tool runs it as far as a branch and a winding permit, leaves along its axis to the clearance surface, turns over
//! there, comes back along its axis to the same place, and goes on. Each piece is as long as possible: the number of
//! pieces is then the least, since the places that a branch and a winding reach in a row do not depend on those before.

use super::branch;
use super::clearance_surface::ClearanceSurface;
use crate::ir::{ClPass, ClPoint, MoveKind};
use crate::kin::{Angles, Machine};

/// A move to a cutter location.
pub(super) struct LinkMove {
    pub(super) kind: MoveKind,
    pub(super) to: ClPoint,
    /// Index of the pass that the move belongs to or leads to.
    pub(super) pass: u32,
}

/// Moves with the angles of the rotary axes at their ends.
pub(super) struct Solved {
    pub(super) moves: Vec<LinkMove>,
    pub(super) rotary: Vec<Angles>,
}

/// The way to a place from the clearance surface along the tool axis.
pub(super) fn way_in(surface: &ClearanceSurface<'_>, to: &ClPoint, pass: u32, moves: &mut Vec<LinkMove>) {
    let over = surface.lifted(to);
    moves.push(LinkMove { kind: MoveKind::Rapid, to: over, pass });
    if over.tip != to.tip {
        moves.push(LinkMove { kind: MoveKind::Link, to: ClPoint { contact: None, ..*to }, pass });
    }
}

/// The way from a place along the tool axis to the clearance surface.
pub(super) fn way_out(surface: &ClearanceSurface<'_>, from: &ClPoint, pass: u32, moves: &mut Vec<LinkMove>) {
    let out = surface.lifted(from);
    if out.tip != from.tip {
        moves.push(LinkMove { kind: MoveKind::Link, to: out, pass });
    }
}

/// The moves of a pass behind its start.
pub(super) fn along(pass: &ClPass, index: u32, stations: std::ops::RangeInclusive<usize>, moves: &mut Vec<LinkMove>) {
    moves.extend(stations.map(|i| {
        let kind = if pass.air.binary_search(&i).is_ok() { MoveKind::Link } else { MoveKind::Cut };
        LinkMove { kind, to: pass.points[i], pass: index }
    }));
}

/// The pieces of a pass, for a tool of the given length, from the angles `at`. `None` where even a single move of the pass
/// cannot be made within the travel.
pub(super) fn pieces(
    machine: &Machine,
    surface: &ClearanceSurface<'_>,
    (pass, index): (&ClPass, u32),
    length: f64,
    mut at: Angles,
) -> Option<Vec<Solved>> {
    let piece = |from: usize, to: usize| {
        let mut moves = Vec::new();
        way_in(surface, &pass.points[from], index, &mut moves);
        along(pass, index, from + 1..=to, &mut moves);
        way_out(surface, &pass.points[to], index, &mut moves);
        moves
    };
    let solve = |from: usize, to: usize, at: Angles| {
        let moves = piece(from, to);
        let places: Vec<ClPoint> = moves.iter().map(|m| m.to).collect();
        branch::solve(machine, &places, length, at).ok().map(|rotary| Solved { moves, rotary })
    };
    let last = pass.points.len().checked_sub(1)?;
    let (mut found, mut from) = (Vec::new(), 0);
    while from < last {
        // The farthest place that can be reached, by halving.
        let (mut best, mut low, mut high) = (None, from, last + 1);
        while high - low > 1 {
            let to = low + (high - low) / 2;
            match solve(from, to, at) {
                Some(solved) => (best, low) = (Some(solved), to),
                None => high = to,
            }
        }
        let solved = best?;
        at = solved.rotary.last().copied().unwrap_or(at);
        found.push(solved);
        from = low;
    }
    Some(found)
}
