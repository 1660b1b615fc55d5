//! `time-feeds`: feeds that the axes can follow, and the time of every move.
//!
//! Before: joints with process feeds. After: feeds lowered where an axis would have to go faster than it can, with the
//! speeds inside a move counted, not only its ends.

use crate::ir::{JointMove, Motion, MoveKind, Program};
use crate::kin::{Joints, Machine};
use nalgebra::Point3;

/// Pieces in which the joint speeds of a move are looked at: over a tenth of a block the joints run straight.
const PIECES: usize = 10;

/// Feed unit of the text forms, mm/min: feeds are rounded down to it so that a post never has to round up.
const FEED_STEP: f64 = 1e-3;

/// Sets feeds and times.
pub(super) fn run(program: &Program, motion: &mut Motion) {
    let machine = &program.machine;
    for operation in &mut motion.operations {
        let mut before: Option<Joints> = None;
        for m in &mut operation.moves {
            time_move(machine, before, m);
            before = Some(m.joints);
        }
    }
}

fn time_move(machine: &Machine, before: Option<Joints>, m: &mut JointMove) {
    // The first move positions from an unknown place: its time is the tool change's.
    let Some(before) = before else { return };
    let tips = [before, m.joints].map(|j| machine.forward(&j).tip);
    let length = (tips[1] - tips[0]).norm();
    let least = least_time(machine, &tips, &before, &m.joints);
    m.time = match (m.kind, m.feed) {
        (MoveKind::Rapid, _) | (_, None) => least.max(length / machine.rapid),
        (_, Some(feed)) => {
            let wanted = length / feed * 60.0;
            if wanted < least && length > 0.0 {
                let slower = ((length / least * 60.0) / FEED_STEP).floor() * FEED_STEP;
                let slower = slower.max(FEED_STEP);
                m.feed = Some(slower);
                length / slower * 60.0
            } else {
                wanted.max(least)
            }
        }
    };
}

/// Time that the axes need, each at its own largest speed, for the fastest piece of a move.
fn least_time(machine: &Machine, tips: &[Point3<f64>; 2], from: &Joints, to: &Joints) -> f64 {
    let at = |k: usize| {
        let t = k as f64 / PIECES as f64;
        let tip = tips[0] + (tips[1] - tips[0]) * t;
        machine.joints(&tip, from.a + (to.a - from.a) * t, from.c + (to.c - from.c) * t).xyz
    };
    let mut least = ((to.a - from.a).abs() / machine.tilt.speed).max((to.c - from.c).abs() / machine.turn.speed);
    let mut last = at(0);
    for k in 1..=PIECES {
        let next = at(k);
        for axis in 0..3 {
            least = least.max((next[axis] - last[axis]).abs() * PIECES as f64 / machine.linear[axis].speed);
        }
        last = next;
    }
    least
}
