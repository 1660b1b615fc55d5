//! V1: the motion is well formed.
//!
//! Checked: the motion contains every operation of the program once and in order; every number is finite; feeds are
//! positive and not above the process feed; times are not negative; a cut or link has a feed, a rapid has none; an
//! operation begins with a rapid; labels exist. Not checked here: anything about the part.

use diagnostics::{Diag, Sink, codes::verification};
use ir::{Motion, MoveKind, Program};

/// Largest excess of a feed over the process feed that counts as rounding.
const FEED_ROUNDING: f64 = 1e-6;

/// Reports faults of the structure; true when there are none.
pub fn check(program: &Program, motion: &Motion, sink: &mut Sink) -> bool {
    let mut sound = true;
    let mut fault = |text: String| {
        sound = false;
        sink.push(
            Diag::error(verification::MALFORMED_MOTION, text)
                .note("this is a fault of the compiler, not of the job")
                .help("report the job file"),
        );
    };
    let wanted: Vec<_> = program.operations.ids().collect();
    let found: Vec<_> = motion.operations.iter().map(|o| o.operation).collect();
    if wanted != found {
        fault(format!("the motion has {} operations, the job has {}", found.len(), wanted.len()));
        return false;
    }
    for operation in &motion.operations {
        let declared = &program.operations[operation.operation];
        if operation.moves.first().is_none_or(|m| m.kind != MoveKind::Rapid) {
            fault(format!("`{}` does not begin with a rapid move", declared.name));
        }
        for (i, m) in operation.moves.iter().enumerate() {
            let j = &m.joints;
            let finite = j.all().iter().chain([&m.time]).all(|x| x.is_finite());
            let limit = match m.kind {
                MoveKind::Cut => declared.feed.get(),
                MoveKind::Link | MoveKind::Rapid => declared.link_feed.get(),
            };
            let feed_fits = match (m.kind, m.feed) {
                (MoveKind::Rapid, feed) => feed.is_none(),
                (_, Some(feed)) => feed > 0.0 && feed <= limit * (1.0 + FEED_ROUNDING),
                (_, None) => false,
            };
            if !finite || !feed_fits || m.time < 0.0 || m.pass as usize >= operation.labels.len() {
                fault(format!("move {i} of `{}` is malformed: {m:?}", declared.name));
                break;
            }
        }
    }
    sound
}
