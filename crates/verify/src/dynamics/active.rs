//! Active limits: for every moment of a run the limit that faster motion would exceed first.
//!
//! The pace of a limit is the share of its pace at which the run moves: at a pace of 0.75 the same motion, faster by
//! a third, would reach the limit. With the share u of the limit, the pace is u for the process feed, for the feed
//! at which tool or spindle reach a limit of removal, and for the speed of an axis, the square root of u for an acceleration, and the cube root of u for a jerk. The deviation at a corner grows
//! about as the square of the pace. Accelerations and jerks are those of curvature and of changes of speed together.
//!
//! The process feed decides first, so that a block whose feed the planner has lowered counts for the limit that is near
//! there. The reason follows from joints, limits, times and the simulated stock alone.

use super::{Joint5, MotionCell, MovePart, RunLimits, number};
use base::units::Sec;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Least pace of the process feed at which it is active. In the run the speed of the joints as a whole is constant over a
/// corner, and that of the tip is not: where all blocks have one feed, the tip falls a few percent below it before a block
/// in which the joints move less.
const MIN_FEED_PACE: f64 = 0.95;

/// Least pace of any other limit at which it is active. The run is not the fastest: where it begins to speed up again it
/// takes half of the jerk, a pace of 0.79, and its bounds hold over whole pieces of the path.
const MIN_ACTIVE_PACE: f64 = 0.75;

/// Kind of a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MotionLimit {
    /// Process feed for cuts, link feed for links, rapid speed of the tip for rapids.
    Feed,
    /// Speed of an axis.
    Speed,
    /// Acceleration of an axis.
    Acceleration,
    /// Jerk of an axis.
    Jerk,
    /// Rounding of a corner within the tolerance, and between the middles of its blocks.
    Corner,
    /// Removal rate of the tool, or power of the spindle.
    Removal,
    /// Feed of the block: lower than the feed of the job, and than any other limit demands.
    BlockFeed,
    /// None, from one time at the process feed to the next.
    Rest,
}

/// Time in which a limit is active.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActiveLimit {
    /// The limit.
    pub limit: MotionLimit,
    /// Name of the axis; `None` for limits that belong to no axis.
    pub axis: Option<String>,
    /// Time in cuts, links and rapids.
    pub time: [Sec; 3],
}

/// The limit that is active in a move for the longest time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MoveLimit {
    /// Index of the move in its operation.
    pub index: u32,
    /// Index in the limits of the run.
    pub limit: usize,
}

/// A limit and its axis.
pub(super) type LimitOfAxis = (MotionLimit, Option<usize>);

/// No limit of a corner.
pub(super) const NO_CORNER: [(f64, LimitOfAxis); 3] = [(0.0, (MotionLimit::Rest, None)); 3];

/// Motion in a part of a cell.
pub(super) struct Pace<'a> {
    pub(super) cell: &'a MotionCell,
    /// Mean of dtau/dt.
    pub(super) rate: f64,
    /// Largest acceleration and jerk of each axis.
    pub(super) acceleration: Joint5,
    pub(super) jerk: Joint5,
    /// Shares of the limits of the nearer corner of the block.
    pub(super) corner: [(f64, LimitOfAxis); 3],
}

/// Times by limit and axis.
#[derive(Default)]
pub(super) struct ActiveTimes {
    /// Times of all moves.
    whole: BTreeMap<LimitOfAxis, [f64; 3]>,
    /// Times of single moves, in their order.
    moves: Vec<(u32, LimitOfAxis, f64)>,
}

impl ActiveTimes {
    /// Adds time of a move of a kind. The calls are in the order of the moves.
    pub(super) fn add(&mut self, index: u32, limit: LimitOfAxis, kind: usize, time: f64) {
        if time <= 0.0 {
            return;
        }
        self.whole.entry(limit).or_default()[kind] += time;
        let own = self.moves.iter_mut().rev().take_while(|m| m.0 == index).find(|m| m.1 == limit);
        match own {
            Some(entry) => entry.2 += time,
            None => self.moves.push((index, limit, time)),
        }
    }

    /// The times with the names of the axes, without empty ones, and the limit of each move.
    pub(super) fn named(self, names: [&str; 5]) -> (Vec<ActiveLimit>, Vec<MoveLimit>) {
        let name = |axis: Option<usize>| axis.map(|k| names[k].to_owned());
        let order: Vec<LimitOfAxis> = self.whole.keys().copied().collect();
        let longest = |own: &[(u32, LimitOfAxis, f64)]| {
            // Of equal times the first limit counts.
            let longest = own.iter().reduce(|a, b| if b.2 > a.2 { b } else { a })?;
            Some(MoveLimit { index: longest.0, limit: order.binary_search(&longest.1).ok()? })
        };
        let moves = self.moves.chunk_by(|a, b| a.0 == b.0).filter_map(longest).collect();
        let times = self.whole.into_iter();
        (
            times.map(|((limit, axis), time)| ActiveLimit { limit, axis: name(axis), time: time.map(Sec) }).collect(),
            moves,
        )
    }

    /// Times of a run.
    pub(super) fn of_run(
        limits: &RunLimits,
        cells: &[MotionCell],
        parts: &[MovePart],
        corner_shares: impl Fn(usize, f64) -> [(f64, LimitOfAxis); 3],
    ) -> Self {
        let mut moments: Vec<Moment> = Vec::with_capacity(parts.len());
        for block in parts.chunk_by(|a, b| cells[a.cell].block == cells[b.cell].block) {
            let middle = 0.5 * block.iter().map(|p| p.width).sum::<f64>();
            let (first, last) = (block[0].cell, block[block.len() - 1].cell);
            let mut at = 0.0;
            for part in block {
                let (cell, rate) = (&cells[part.cell], part.width / part.time);
                let before = ((middle - at) / part.width).clamp(0.0, 1.0);
                at += part.width;
                let halves = [(before, first, rate / cells[first].ratio), (1.0 - before, last + 1, rate)];
                for (share, corner, at_corner) in halves.into_iter().filter(|h| h.0 > 0.0) {
                    let corner = corner_shares(corner, at_corner);
                    let (acceleration, jerk) = (part.acceleration, part.jerk);
                    let limit = active(limits, &Pace { cell, rate, acceleration, jerk, corner });
                    moments.push(Moment { limit, cell: part.cell, time: share * part.time });
                }
            }
        }
        let mut times = Self::default();
        for (moment, near) in moments.iter().zip(nearest(&moments)) {
            let cell = &cells[moment.cell];
            times.add(cell.block, near.unwrap_or(moment.limit), number(cell.kind), moment.time);
        }
        times
    }
}

/// A part of the run with its active limit.
struct Moment {
    limit: LimitOfAxis,
    /// Index of the cell in which it lies.
    cell: usize,
    time: f64,
}

/// For each part without an active limit the limit from which or towards which it changes its speed: the nearest one in
/// time that the run reaches without the process feed between.
fn nearest(moments: &[Moment]) -> Vec<Option<LimitOfAxis>> {
    let mut found: Vec<Option<(f64, LimitOfAxis)>> = vec![None; moments.len()];
    for backward in [false, true] {
        let mut last: Option<(f64, LimitOfAxis)> = None;
        for i in 0..moments.len() {
            let i = if backward { moments.len() - 1 - i } else { i };
            let Moment { limit, time, .. } = moments[i];
            match limit.0 {
                MotionLimit::Feed => last = None,
                MotionLimit::Rest | MotionLimit::BlockFeed => {
                    let nearer = last.filter(|l| found[i].is_none_or(|f| l.0 < f.0));
                    if limit.0 == MotionLimit::Rest && nearer.is_some() {
                        found[i] = nearer;
                    }
                    last = last.map(|(since, limit)| (since + time, limit));
                }
                _ => last = Some((0.0, limit)),
            }
        }
    }
    found.into_iter().map(|f| f.map(|(_, limit)| limit)).collect()
}

/// The active limit, and its axis.
pub(super) fn active(limits: &RunLimits, run: &Pace) -> LimitOfAxis {
    let cell = run.cell;
    if cell.feed * run.rate >= MIN_FEED_PACE {
        return (MotionLimit::Feed, None);
    }
    let none = if run.rate >= MIN_FEED_PACE { MotionLimit::BlockFeed } else { MotionLimit::Rest };
    let mut most = (MIN_ACTIVE_PACE, (none, None));
    let mut raise = |pace: f64, limit: LimitOfAxis| {
        if pace > most.0 {
            most = (pace, limit);
        }
    };
    raise(cell.removal * run.rate, (MotionLimit::Removal, None));
    for k in 0..5 {
        raise(cell.rate[k] * run.rate / limits.speed[k], (MotionLimit::Speed, Some(k)));
        raise((run.acceleration[k] / limits.acceleration[k]).sqrt(), (MotionLimit::Acceleration, Some(k)));
        raise(libm::cbrt(run.jerk[k] / limits.jerk[k]), (MotionLimit::Jerk, Some(k)));
    }
    // Away from the corner the run may be faster than at the corner: the corner holds it less there.
    for (pace, limit) in run.corner.map(|(share, limit)| (share.sqrt(), limit)) {
        raise(pace.min(1.0 / pace), limit);
    }
    most.1
}
