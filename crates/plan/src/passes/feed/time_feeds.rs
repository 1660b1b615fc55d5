//! `time-feeds`: feeds that the axes can follow, and the time of every move.
//!
//! Before: joints with process feeds. After: each feed is at most the process feed, and the largest feed that the tip
//! reaches in this block when the axes run through the operation as fast as their speeds, accelerations and jerks allow
//! ([`five_axis::feedrate`] defines a feasible feed), with a rest before the last rapid of several
//! ([`MotionOperation::rests_before`]). Sectors that run alike from rest to rest are run once. In addition no axis exceeds its speed when the block is run at
//! its feed alone; [`Machine::planned_time`] proves this over the whole block, rapids included. The times of the moves
//! follow from the feeds; the verifier simulates the additional time for acceleration and braking.

use base::progress::Progress;
use five_axis::feedrate::{self, AXES, Limits, Rounding, Station};
use five_axis::{Carries, Joints, Machine, between};
use ir::motion::MotionOperation;
use ir::repeats::{POSITION_ROUNDING, first_alike};
use ir::{JointMove, Motion, MoveKind, Program};
use nalgebra::Point3;
use rayon::prelude::*;

/// Turn between two stations, radians: a joint 100 mm from a rotary axis leaves its chord by 15 um over this turn.
const STATION_TURN: f64 = 2.0 * std::f64::consts::PI / 180.0;

/// Most stations of a move.
const MAX_STATIONS: f64 = 1000.0;

/// Step of the key by which runs that may be alike are found, mm.
const PLACE_STEP: f64 = 1e-3;

/// Feed unit of the texts, mm/min: feeds are rounded down to it so that a post never has to round up.
const FEED_STEP: f64 = 1e-3;

/// Sets feeds and times.
pub(crate) fn run(program: &Program, progress: &Progress, motion: &mut Motion) {
    let machine = &program.machine;
    // The caller ends a cancelled run.
    motion.operations.par_iter_mut().filter(|_| !progress.is_cancelled()).for_each(|operation| {
        let declared = &program.operations[operation.operation];
        let (finishing, t) = (declared.kind.finishes(), &program.tolerances);
        let tool = &program.tools[declared.tool];
        let rounding = Rounding {
            tolerance: if finishing { t.chord.get() } else { t.chord_rough.get() },
            // Corners count the turns of both axes as at a right angle.
            height: tool.solid.flute_length * machine.chain.most_turn_ratio(),
        };
        let mut reached = reached_feeds(machine, tool.length(), &rounding, operation);
        // A spline block has one word: the largest feed of its chords. Between them the control slows down by itself, as
        // within a straight block.
        for spline in &operation.splines {
            let chords = reached.get_mut(spline.chords()).unwrap_or_default();
            let most = chords.iter().flatten().copied().reduce(f64::max);
            chords.fill(most);
        }
        let mut before: Option<Joints> = None;
        for (m, reached) in operation.moves.iter_mut().zip(reached).take_while(|_| !progress.is_cancelled()) {
            time_move(machine, tool.length(), before, m, reached);
            before = Some(m.joints);
        }
        one_feed_a_block(machine, operation);
    });
}

/// Gives all chords of a spline block the least of their feeds: at a larger one an axis would exceed its speed.
fn one_feed_a_block(machine: &Machine, operation: &mut MotionOperation) {
    for spline in &operation.splines {
        let chords = operation.moves.get(spline.chords()).unwrap_or_default();
        let Some(feed) = chords.iter().filter_map(|m| m.feed).reduce(f64::min) else { continue };
        for i in spline.chords() {
            let tips = [i - 1, i].map(|k| machine.forward(&operation.moves[k].joints).tip);
            let m = &mut operation.moves[i];
            m.feed = Some(feed);
            m.time = m.time.max((tips[1] - tips[0]).norm() / feed * 60.0);
        }
    }
}

/// Largest feed of each move in the fastest run through all of them, mm/min; `None` where the tip stands still.
fn reached_feeds(machine: &Machine, length: f64, rounding: &Rounding, operation: &MotionOperation) -> Vec<Option<f64>> {
    let moves = &operation.moves;
    let starts: Vec<usize> = (0..moves.len()).filter(|i| *i == 0 || operation.rests_before(*i)).collect();
    // Each from the joints at which it starts.
    let runs: Vec<&[JointMove]> = starts
        .iter()
        .zip(starts.iter().skip(1).chain([&moves.len()]))
        .map(|(start, end)| &moves[start.saturating_sub(1)..*end])
        .collect();
    // By the number of moves and their places in steps.
    let key = |run: &&[JointMove]| {
        let places: f64 = run.iter().map(|m| m.joints.xyz.sum()).sum();
        (run.len(), (places / PLACE_STEP).round() as i64)
    };
    let like = first_alike(&runs, key, |a, b| run_alike(machine, a, b));
    let own: Vec<Vec<Option<f64>>> = (0..runs.len())
        .into_par_iter()
        .map(|i| if like[i] == i { run_feeds(machine, length, rounding, runs[i]) } else { Vec::new() })
        .collect();
    let mut feeds = Vec::with_capacity(moves.len());
    for (start, like) in starts.iter().zip(like) {
        // The first entry is that of the joints at the start, which belong to the run before.
        feeds.extend_from_slice(&own[like][usize::from(*start > 0)..]);
    }
    feeds
}

/// Whether the axes take the same way. A rotary axis on which the part lies may be turned by a constant.
fn run_alike(machine: &Machine, a: &[JointMove], b: &[JointMove]) -> bool {
    let on_table = machine.chain.axes()[1].carries == Carries::Part;
    let turned =
        |run: &[JointMove], m: &JointMove| m.joints.rotary[1] - if on_table { run[0].joints.rotary[1] } else { 0.0 };
    a.len() == b.len()
        && a.iter().zip(b).enumerate().all(|(i, (p, q))| {
            (i == 0 || (p.kind == q.kind && p.feed == q.feed))
                && (p.joints.xyz - q.joints.xyz).amax() <= POSITION_ROUNDING.0
                && (p.joints.rotary[0] - q.joints.rotary[0]).abs() <= POSITION_ROUNDING.1
                && (turned(a, p) - turned(b, q)).abs() <= POSITION_ROUNDING.1
        })
}

/// The same in a run from rest to rest; the first move only gives the joints at its start.
fn run_feeds(machine: &Machine, length: f64, rounding: &Rounding, moves: &[JointMove]) -> Vec<Option<f64>> {
    let Some(first) = moves.first() else { return Vec::new() };
    let mut tip = machine.forward(&first.joints).tip;
    let mut stations =
        vec![Station { joints: machine.travelled(&first.joints, length), tip: tip.coords.into(), time: 1.0 }];
    // Move of each station.
    let mut of: Vec<usize> = vec![0];
    for (i, pair) in moves.windows(2).enumerate() {
        let (from, to) = (&pair[0].joints, &pair[1].joints);
        let next = machine.forward(to).tip;
        let count = (machine.turn(from.rotary, to.rotary) / STATION_TURN).ceil().clamp(1.0, MAX_STATIONS);
        for k in 1..=count as usize {
            let t = k as f64 / count;
            let at = tip + (next - tip) * t;
            let j = machine.joints(&at, between(from.rotary, to.rotary, t));
            let last = stations[stations.len() - 1];
            let here = Station { joints: machine.travelled(&j, length), tip: at.coords.into(), time: 0.0 };
            // The process feed, or the speed of the axes where the tip stands still.
            let feed = pair[1].feed.map_or(machine.rapid, |f| f / 60.0);
            let speeds = machine.planned_speeds();
            let turn = (0..AXES).map(|k| (here.joints[k] - last.joints[k]).abs() / speeds[k]).fold(0.0, f64::max);
            let time = ((next - tip).norm() / count / feed).max(turn);
            if time > 0.0 {
                stations.push(Station { time, ..here });
                of.push(i + 1);
            }
        }
        tip = next;
    }
    let limits =
        Limits { speed: machine.planned_speeds(), acceleration: machine.accelerations(), jerk: machine.jerks() };
    let shares = feedrate::speed_shares(&stations, &limits, rounding);
    let mut feeds = vec![None; moves.len()];
    for (i, (share, of)) in shares.into_iter().zip(of).enumerate().skip(1) {
        let distance = (Point3::from(stations[i].tip) - Point3::from(stations[i - 1].tip)).norm();
        let feed = distance / stations[i].time * share * 60.0;
        if feed > feeds[of].unwrap_or(0.0) {
            feeds[of] = Some(feed);
        }
    }
    feeds
}

fn time_move(machine: &Machine, length_of_tool: f64, before: Option<Joints>, m: &mut JointMove, reached: Option<f64>) {
    // The first move starts from an unknown place: its time belongs to the tool change.
    let Some(before) = before else { return };
    let tips = [before, m.joints].map(|j| machine.forward(&j).tip);
    let length = (tips[1] - tips[0]).norm();
    let least = machine.planned_time(&before, &m.joints, length_of_tool);
    m.time = match (m.kind, m.feed) {
        (MoveKind::Rapid, _) | (_, None) => least.max(length / machine.rapid),
        (_, Some(feed)) => {
            let wanted = reached.map_or(feed, |r| r.min(feed));
            let followed = if length > 0.0 && least > 0.0 { wanted.min(length / least * 60.0) } else { wanted };
            if followed < feed * (1.0 - FEED_ROUNDING) && length > 0.0 {
                let slower = ((followed / FEED_STEP).floor() * FEED_STEP).max(FEED_STEP);
                m.feed = Some(slower);
                length / slower * 60.0
            } else {
                (length / feed * 60.0).max(least)
            }
        }
    };
}

/// Relative difference of feeds that is only rounding of numbers.
const FEED_ROUNDING: f64 = 1e-9;
