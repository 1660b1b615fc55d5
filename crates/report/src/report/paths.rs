//! Moves for the page: joints and times, thinned within a tolerance when there are too many.

use super::pack::Bytes;
use crate::proof::machine::limit_words;
use ir::{JointMove, Motion, MoveKind, Program};
use serde::Serialize;
use verify::dynamics::Run;
use verify::stock::{Engagement, StockReport};

/// Most moves that the page holds.
const MAX_MOVES: usize = 150_000;

/// First tolerance of thinning, mm; it is doubled until the moves are few enough.
const FIRST_TOLERANCE: f64 = 1e-3;

/// Tolerance from which on thinning may cross the border between passes, mm.
const LAST_TOLERANCE: f64 = 1.0;

/// Distance from the tip at which a turn of the axis is counted as a displacement, mm: a length of engagement.
const TURN_RADIUS: f64 = 20.0;

/// Longest run that is thinned as a whole; it bounds the computing time.
const MAX_RUN_STATIONS: usize = 4096;

/// Limit of a move that takes no time.
const NO_LIMIT: u8 = u8::MAX;

/// Most bytes of pass names; with more, only the operations are named.
const MAX_NAME_BYTES: usize = 600_000;

/// Moves of an operation.
#[derive(Serialize)]
struct OperationData {
    name: String,
    tool: String,
    /// Index of its first move on the page, and number of moves.
    first: usize,
    count: usize,
    /// Passes in order: the index of the first move on the page, and the index in `labels`.
    passes: Vec<[usize; 2]>,
    labels: Vec<String>,
    /// Lines of the NC text: for each run the first move and its line. Within a run the lines are consecutive.
    lines: Vec<[u32; 2]>,
    speed: f64,
    feed: f64,
}

/// All moves.
#[derive(Serialize)]
pub(super) struct PathData {
    operations: Vec<OperationData>,
    /// Number of moves of the program, and of the page.
    pub(super) moves: usize,
    pub(super) kept: usize,
    /// Tolerance of thinning, mm; zero when nothing was thinned.
    pub(super) tolerance: f64,
    /// Whether pass names were left out.
    pub(super) nameless: bool,
    /// Whether `removal` and `arcs` hold values.
    simulated: bool,
    /// X Y Z (mm), rotary axes (rad), time of the move (s): 6 floats per move.
    #[serde(skip)]
    pub(super) joints: Bytes,
    /// Index of the move in its operation; empty when nothing was thinned.
    #[serde(skip)]
    pub(super) indices: Bytes,
    /// 0 is a cut, 1 a link, 2 a rapid.
    #[serde(skip)]
    pub(super) kinds: Bytes,
    /// Mean removal rate over the moves that a kept move represents, mm3/min.
    #[serde(skip)]
    pub(super) removal: Bytes,
    /// Largest arc of engagement over these moves, degrees.
    #[serde(skip)]
    pub(super) arcs: Bytes,
    /// What limits the feed, in words.
    pub(super) limits: Vec<String>,
    /// For each move the index in `limits` of the limit that is active for the longest time.
    #[serde(skip)]
    pub(super) limiting: Bytes,
}

/// Tip and axis as one point: a straight line in these six coordinates is a straight move.
type PathRow = [f64; 6];

fn distance2(a: &PathRow, b: &PathRow) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

/// Squared distance of a station from the chord between two others.
fn off_chord2(p: &PathRow, a: &PathRow, b: &PathRow) -> f64 {
    let (mut along, mut length) = (0.0, 0.0);
    for k in 0..6 {
        along += (p[k] - a[k]) * (b[k] - a[k]);
        length += (b[k] - a[k]) * (b[k] - a[k]);
    }
    let t = if length > 0.0 { (along / length).clamp(0.0, 1.0) } else { 0.0 };
    let mut foot = *a;
    for k in 0..6 {
        foot[k] += (b[k] - a[k]) * t;
    }
    distance2(p, &foot)
}

/// Marks the stations of a run to keep, both ends included, so that all others are within the tolerance of the chords
/// (Douglas and Peucker).
fn mark(stations: &[PathRow], tolerance: f64, keep: &mut [bool]) {
    let Some(last) = stations.len().checked_sub(1) else { return };
    (keep[0], keep[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let farthest = (from + 1..to)
            .map(|i| (off_chord2(&stations[i], &stations[from], &stations[to]), i))
            .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        if let Some((off, middle)) = farthest
            && off > tolerance * tolerance
        {
            keep[middle] = true;
            open.extend([(from, middle), (middle, to)]);
        }
    }
}

/// Whether each move of an operation is kept at a tolerance.
fn thin(stations: &[PathRow], moves: &[JointMove], tolerance: f64) -> Vec<bool> {
    let mut keep = vec![tolerance <= 0.0; moves.len()];
    let mut start = 0;
    for i in 0..moves.len() {
        let border = moves.get(i + 1).is_none_or(|next| {
            (tolerance < LAST_TOLERANCE && (next.pass != moves[i].pass || next.kind != moves[i].kind))
                || i + 1 - start >= MAX_RUN_STATIONS
        });
        if border {
            mark(&stations[start..=i], tolerance, &mut keep[start..=i]);
            // A run begins at the end of the run before.
            start = i;
        }
    }
    keep
}

/// Tip and axis at the end of each move, by operation.
fn stations(program: &Program, motion: &Motion) -> Vec<Vec<PathRow>> {
    let station = |m: &JointMove| {
        let pose = program.machine.forward(&m.joints);
        let (t, a) = (pose.tip, pose.axis * TURN_RADIUS);
        [t.x, t.y, t.z, a.x, a.y, a.z]
    };
    motion.operations.iter().map(|o| o.moves.iter().map(station).collect()).collect()
}

/// Whether each move is kept on the page, by operation, and the smallest tolerance at which they are few enough.
fn kept(program: &Program, motion: &Motion) -> (Vec<Vec<bool>>, f64) {
    let stations = stations(program, motion);
    let mut tolerance = 0.0;
    loop {
        let keep: Vec<Vec<bool>> =
            motion.operations.iter().zip(&stations).map(|(o, s)| thin(s, &o.moves, tolerance)).collect();
        let kept = keep.iter().flatten().filter(|k| **k).count();
        // No part is a kilometre long: at this tolerance every path is reduced to its ends.
        if kept <= MAX_MOVES || tolerance > 1e6 {
            return (keep, tolerance);
        }
        tolerance = if tolerance > 0.0 { 2.0 * tolerance } else { FIRST_TOLERANCE };
    }
}

/// The moves of a motion. `stock` gives the engagement when it was simulated, `runs` the limits of each operation; `lines`
/// gives the NC line (from 1) of each operation and move.
pub(super) fn paths(
    program: &Program,
    motion: &Motion,
    stock: Option<&StockReport>,
    runs: &[Run],
    lines: &[(u32, u32, u32)],
) -> PathData {
    let (keep, tolerance) = kept(program, motion);
    let names: usize = motion.operations.iter().flat_map(|o| &o.labels).map(String::len).sum();
    let mut data = PathData {
        operations: Vec::new(),
        moves: motion.operations.iter().map(|o| o.moves.len()).sum(),
        kept: 0,
        tolerance,
        nameless: names > MAX_NAME_BYTES,
        simulated: stock.is_some(),
        joints: Bytes::default(),
        indices: Bytes::default(),
        kinds: Bytes::default(),
        removal: Bytes::default(),
        arcs: Bytes::default(),
        limits: Vec::new(),
        limiting: Bytes::default(),
    };
    for (index, (operation, keep)) in motion.operations.iter().zip(&keep).enumerate() {
        let declared = &program.operations[operation.operation];
        let first = data.kept;
        let engagement = stock.and_then(|s| s.operations.get(index)).map_or(&[][..], |o| &o.moves);
        let passes = data.add_moves(&operation.moves, keep, engagement, runs.get(index));
        data.add_limits(&operation.moves, keep, runs.get(index));
        data.operations.push(OperationData {
            name: declared.name.clone(),
            tool: program.tools[declared.tool].name.clone(),
            first,
            count: data.kept - first,
            passes: if data.nameless { Vec::new() } else { passes },
            labels: if data.nameless { Vec::new() } else { operation.labels.clone() },
            lines: line_runs(index, lines),
            speed: declared.speed.get(),
            feed: declared.feed.get(),
        });
    }
    data
}

impl PathData {
    /// Adds the moves of an operation that are kept. Returns its passes: the index of the first move of each on the page,
    /// and the index of its label.
    fn add_moves(
        &mut self,
        moves: &[JointMove],
        keep: &[bool],
        engagement: &[Engagement],
        run: Option<&Run>,
    ) -> Vec<[usize; 2]> {
        let mut passes: Vec<[usize; 2]> = Vec::new();
        let (mut time, mut programmed, mut volume, mut arc) = (0.0, 0.0, 0.0, 0.0_f64);
        for (i, m) in moves.iter().enumerate() {
            // Moves between two kept moves count for the time too. It is that of the run, as everywhere in the report.
            time += run.and_then(|run| run.move_times.get(i)).map_or(m.time, |time| time.get());
            programmed += m.time;
            let e = engagement.get(i).copied().unwrap_or_default();
            volume += e.rate.by_minute().get() * m.time;
            arc = arc.max(e.arc.get());
            if !keep[i] {
                continue;
            }
            if passes.last().is_none_or(|p| p[1] != m.pass as usize) {
                passes.push([self.kept, m.pass as usize]);
            }
            let j = &m.joints;
            j.all().into_iter().chain([time]).for_each(|v| self.joints.f32(v));
            if self.tolerance > 0.0 {
                self.indices.u32(u32::try_from(i).unwrap_or(u32::MAX));
            }
            if self.simulated {
                self.removal.f32(if programmed > 0.0 { volume / programmed } else { 0.0 });
                self.arcs.f32(arc);
            }
            self.kinds.u8(kind_number(m.kind));
            (time, programmed, volume, arc) = (0.0, 0.0, 0.0, 0.0);
            self.kept += 1;
        }
        passes
    }

    /// Adds for each kept move the limit that is active for the longest time in the moves that it represents.
    fn add_limits(&mut self, moves: &[JointMove], keep: &[bool], run: Option<&Run>) {
        let mut of_moves = run.map_or(&[][..], |r| &r.of_moves).iter().peekable();
        let mut times: Vec<(u8, f64)> = Vec::new();
        for (i, m) in moves.iter().enumerate() {
            while let Some(own) = of_moves.next_if(|l| l.index as usize <= i) {
                let kind = kind_number(m.kind);
                let words = run.and_then(|r| r.limits.get(own.limit)).map(|l| limit_words(l, usize::from(kind)));
                let Some(limit) = words.map(|w| self.limit_number(w)).filter(|_| own.index as usize == i) else {
                    continue;
                };
                match times.iter_mut().find(|t| t.0 == limit) {
                    Some(time) => time.1 += m.time,
                    None => times.push((limit, m.time)),
                }
            }
            if keep[i] {
                let longest = times.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a });
                self.limiting.u8(longest.map_or(NO_LIMIT, |l| l.0));
                times.clear();
            }
        }
    }

    /// Index of a limit, which is added when it is new.
    fn limit_number(&mut self, words: String) -> u8 {
        let known = self.limits.iter().position(|l| *l == words);
        let place = known.unwrap_or(self.limits.len());
        if known.is_none() {
            self.limits.push(words);
        }
        u8::try_from(place).unwrap_or(NO_LIMIT)
    }
}

/// Number of a kind of moves on the page.
fn kind_number(kind: MoveKind) -> u8 {
    match kind {
        MoveKind::Cut => 0,
        MoveKind::Link => 1,
        MoveKind::Rapid => 2,
    }
}

/// Runs of moves of an operation with consecutive lines.
fn line_runs(operation: usize, lines: &[(u32, u32, u32)]) -> Vec<[u32; 2]> {
    let mut runs: Vec<[u32; 2]> = Vec::new();
    for (_, index, line) in lines.iter().filter(|l| l.0 as usize == operation) {
        if runs.last().is_none_or(|r| i64::from(*line) - i64::from(r[1]) != i64::from(*index) - i64::from(r[0])) {
            runs.push([*index, *line]);
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Brute force: every station is near the chord of the kept stations around it.
        #[test]
        fn thinned_stations_stay_within_the_tolerance(
            heights in prop::collection::vec(-1.0..1.0_f64, 2..60),
            tolerance in 0.01..1.0_f64,
        ) {
            let stations: Vec<PathRow> =
                heights.iter().enumerate().map(|(i, h)| [i as f64, *h, 0.0, h * h, 0.0, 1.0]).collect();
            let mut keep = vec![false; stations.len()];
            mark(&stations, tolerance, &mut keep);
            let kept: Vec<usize> = (0..keep.len()).filter(|i| keep[*i]).collect();
            prop_assert_eq!(kept[0], 0);
            prop_assert_eq!(kept[kept.len() - 1], stations.len() - 1);
            for pair in kept.windows(2) {
                for i in pair[0]..=pair[1] {
                    let off = off_chord2(&stations[i], &stations[pair[0]], &stations[pair[1]]).sqrt();
                    prop_assert!(off <= tolerance + 1e-12);
                }
            }
        }
    }

    #[test]
    fn lines_that_follow_one_another_are_one_run() {
        let lines = [(0, 0, 10), (0, 1, 11), (0, 2, 13), (1, 0, 20), (1, 1, 21)];
        assert_eq!(line_runs(0, &lines), [[0, 10], [2, 13]]);
        assert_eq!(line_runs(1, &lines), [[0, 20]]);
    }
}
