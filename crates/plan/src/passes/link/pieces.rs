//! A pass that the travel of the axes does not allow in one go.
//!
//! The tool runs it as far as a branch and a winding permit, leaves along its axis to the clearance surface, turns over
//! there, comes back along its axis to the same place, and goes on. Each piece is as long as possible: the number of
//! pieces is then the least, since the places that a branch and a winding reach in a row do not depend on those before.
//! Where the next piece cannot begin at a station, one more station lies where the travel ends.

use super::branch;
use super::clearance_surface::ClearanceSurface;
use five_axis::{Angles, Machine, between};
use ir::{ClPass, ClPoint, MoveKind};
use nurbs::bracket::{Bracket, last_whole};

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

/// The moves to a place from the clearance surface along the tool axis.
pub(super) fn approach(surface: &ClearanceSurface<'_>, to: &ClPoint, pass: u32, moves: &mut Vec<LinkMove>) {
    let over = surface.lifted(to);
    moves.push(LinkMove { kind: MoveKind::Rapid, to: over, pass });
    if over.tip != to.tip {
        moves.push(LinkMove { kind: MoveKind::Link, to: ClPoint { contact: None, ..*to }, pass });
    }
}

/// The moves from a place along the tool axis to the clearance surface.
pub(super) fn retract(surface: &ClearanceSurface<'_>, from: &ClPoint, pass: u32, moves: &mut Vec<LinkMove>) {
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

/// Halvings in the search of the place in a block where the travel ends.
const TRAVEL_BISECTIONS: usize = 52;

/// A pass on a machine, for a tool of the given length, mm.
struct PassWithin<'a> {
    machine: &'a Machine,
    surface: &'a ClearanceSurface<'a>,
    pass: ClPass,
    index: u32,
    length: f64,
}

/// The pieces of a pass, for a tool of the given length, mm, from the angles `at`. `None` where even a part of a move
/// cannot be made within the travel.
pub(super) fn pieces(
    machine: &Machine,
    surface: &ClearanceSurface<'_>,
    pass: &ClPass,
    index: u32,
    length: f64,
    at: Angles,
) -> Option<Vec<Solved>> {
    let mut within = PassWithin { machine, surface, pass: pass.clone(), index, length };
    let (mut found, mut from, mut at): (Vec<Solved>, usize, Angles) = (Vec::new(), 0, at);
    // Start of the last piece, and the place that was added last.
    let (mut before, mut added) = ((0, at), None);
    while from + 1 < within.pass.points.len() {
        if let Some((solved, to)) = within.longest(from, at) {
            before = (from, at);
            (at, from) = (solved.rotary.last().copied().unwrap_or(at), to);
            found.push(solved);
        } else if added == Some(from) {
            return None;
        } else {
            // Two windings may meet at a single place within a block: where a travel of a whole turn ends.
            within.pass = within.divided(before.0, from, before.1)?;
            added = Some(from + 1);
            found.pop();
            (from, at) = before;
        }
    }
    Some(found)
}

impl PassWithin<'_> {
    /// The longest piece from a station, with the station at its end.
    fn longest(&self, from: usize, at: Angles) -> Option<(Solved, usize)> {
        let mut best = None;
        let last = last_whole(from, self.pass.points.len(), |to| {
            let solved = self.solved(from, to, at);
            let within = solved.is_some();
            best = solved.or(best.take());
            within
        });
        best.map(|solved| (solved, last))
    }

    /// A piece from the clearance surface to a station, to another one, and back to the surface.
    fn solved(&self, from: usize, to: usize, at: Angles) -> Option<Solved> {
        let Self { surface, pass, index, .. } = self;
        let mut moves = Vec::new();
        approach(surface, &pass.points[from], *index, &mut moves);
        along(pass, *index, from + 1..=to, &mut moves);
        retract(surface, &pass.points[to], *index, &mut moves);
        let places: Vec<ClPoint> = moves.iter().map(|m| m.to).collect();
        branch::solve(self.machine, &places, self.length, at).ok().map(|rotary| Solved { moves, rotary })
    }

    /// The pass with one more station, in the block behind a station, where the travel ends for a piece from `start`.
    fn divided(&self, start: usize, behind: usize, at: Angles) -> Option<ClPass> {
        let reach = |branch: usize| {
            let mut found = None;
            let border = Bracket { holds: 0.0, fails: 1.0 }.halved(TRAVEL_BISECTIONS, |share| {
                let within = Self { pass: self.with_station(behind, branch, share), ..*self };
                let solved = within.solved(start, behind + 1, at).is_some();
                if solved {
                    found = Some(within.pass);
                }
                solved
            });
            (border.holds, found)
        };
        let [one, other] = [0, 1].map(reach);
        if other.0 > one.0 { other.1 } else { one.1 }
    }

    /// The pass with a station at a share of the block behind a station: the tip straight, the rotary axes of a branch even.
    fn with_station(&self, behind: usize, branch: usize, share: f64) -> ClPass {
        let chain = &self.machine.chain;
        let mut pass = self.pass.clone();
        let [from, to] = [pass.points[behind], pass.points[behind + 1]];
        let start = chain.unwound(&from.axis, branch, 0.0);
        let end = chain.unwound(&to.axis, branch, start[1]);
        let axis = chain.tool_axis(between(start, end, share));
        pass.points.insert(behind + 1, ClPoint { tip: from.tip + (to.tip - from.tip) * share, axis, contact: None });
        let in_air = pass.air.binary_search(&(behind + 1)).is_ok();
        pass.air.iter_mut().filter(|i| **i > behind).for_each(|i| *i += 1);
        if in_air {
            let place = pass.air.partition_point(|i| *i <= behind);
            pass.air.insert(place, behind + 1);
        }
        pass
    }
}
