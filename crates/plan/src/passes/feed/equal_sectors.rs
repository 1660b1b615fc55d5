//! `equal-sectors`: moves that sectors repeat get equal feeds, times and stops, so that the text can say them once.
//!
//! Before: feeds, times and stops that differ from sector to sector, since the moves before and behind a pass differ, and by
//! rounding. After: of each group of moves that are the same turned about Z, all have the least feed, and all stop where
//! one stops. A lower feed keeps the axes within their limits, and a stop keeps the tool on the path. Rapids that took the
//! same time up to rounding take the longest. The pass runs only when the job asks for subprograms.

use ir::repeats::Symmetry;
use ir::{JointMove, Motion, MoveKind, Program};
use wheel::control::Sectors;

/// Share of the time of a rapid that is rounding.
const RAPID_TIME_ROUNDING: f64 = 1e-6;

/// Makes feeds and times equal.
pub(crate) fn feeds(program: &Program, motion: &mut Motion) {
    each_group(program, motion, |moves, group| {
        let members = || group.iter().map(|i| &moves[*i]);
        let feed = members().filter_map(|m| m.feed).fold(f64::INFINITY, f64::min);
        let [least, most] =
            members().fold([f64::INFINITY, 0.0], |[least, most], m| [m.time.min(least), m.time.max(most)]);
        for i in group {
            let m = &mut moves[*i];
            match m.feed {
                // All moves of a group have the same length.
                Some(own) if own > feed => (m.time, m.feed) = (m.time * own / feed, Some(feed)),
                Some(_) => {}
                None if most - least <= RAPID_TIME_ROUNDING * most => m.time = most,
                None => {}
            }
        }
    });
}

/// Makes stops equal.
pub(crate) fn stops(program: &Program, motion: &mut Motion) {
    each_group(program, motion, |moves, group| {
        let stop = group.iter().any(|i| moves[*i].stop);
        group.iter().for_each(|i| moves[*i].stop = stop);
    });
}

/// Changes every group of moves that sectors repeat. A group lies within passes of cutting or within rapids.
fn each_group(program: &Program, motion: &mut Motion, change: impl Fn(&mut [JointMove], &[usize])) {
    if program.control().sectors == Sectors::Inline {
        return;
    }
    let Ok(symmetry) = Symmetry::of(program) else { return };
    // Splines are not said once: a block keeps its one feed.
    for operation in motion.operations.iter_mut().filter(|o| o.splines.is_empty()) {
        let moves = &operation.moves;
        let rapid = |i: usize| moves[i].kind == MoveKind::Rapid;
        let groups = symmetry.groups(moves, &|i| rapid(i - 1) || rapid(i), &|a, b| a.kind == b.kind);
        groups.iter().for_each(|group| change(&mut operation.moves, group));
    }
}
