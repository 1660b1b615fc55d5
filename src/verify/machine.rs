//! V4: joints within their travel, also between the ends of a move, and axis speeds within their limits.

use super::sweep::At;
use crate::ir::{Motion, MoveKind, Program};
use crate::kin::{Joints, Machine};
use nalgebra::Point3;
use serde::Serialize;

/// Places inside a move at which the joints are looked at. The tip runs straight and the rotary axes evenly, so that
/// between two of 16 places a linear joint leaves its chord by less than 1/256 of its sag over the whole move.
const PLACES: usize = 16;

/// Excess of an axis speed over its limit that is rounding of times and feeds.
const SPEED_ROUNDING: f64 = 1e-3;

/// Range of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AxisRange {
    /// Letter.
    pub axis: char,
    /// Least and largest position used, mm or deg.
    pub used: [f64; 2],
    /// Travel, mm or deg.
    pub travel: [f64; 2],
    /// Largest speed used as a share of the limit.
    pub speed_share: f64,
}

/// What an axis does wrong.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AxisFault {
    /// Letter.
    pub axis: char,
    /// Position (mm or deg), or the speed as a share of the limit.
    pub value: f64,
    /// Bound that it breaks.
    pub bound: f64,
    /// True for a speed, false for a position.
    pub speed: bool,
    /// Move.
    pub at: At,
}

/// An axis speed of one move.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FastestAxis {
    /// Letter.
    pub axis: char,
    /// Largest speed as a share of the limit.
    pub share: f64,
    /// Move.
    pub at: At,
    /// Tool tip at the end of the move, part frame, mm.
    pub tip: [f64; 3],
}

/// Figures of the machine check.
#[derive(Clone, Debug, Serialize)]
pub struct MachineReport {
    /// X, Y, Z, A, C.
    pub axes: Vec<AxisRange>,
    /// Least angle between the tool axis and the axis of C while cutting, degrees.
    pub pole_distance: f64,
    /// Worst fault of each axis.
    pub faults: Vec<AxisFault>,
    /// For each operation the axis that comes nearest to its speed limit.
    pub fastest: Vec<Option<FastestAxis>>,
}

const LETTERS: [char; 5] = ['X', 'Y', 'Z', 'A', 'C'];

fn coordinates(j: &Joints) -> [f64; 5] {
    [j.xyz.x, j.xyz.y, j.xyz.z, j.a, j.c]
}

/// Travel and speed limits in the units of the joints.
fn limits(machine: &Machine) -> ([[f64; 2]; 5], [f64; 5]) {
    let l = &machine.linear;
    (
        [
            [l[0].min, l[0].max],
            [l[1].min, l[1].max],
            [l[2].min, l[2].max],
            [machine.tilt.min, machine.tilt.max],
            [machine.turn.min, machine.turn.max],
        ],
        [l[0].speed, l[1].speed, l[2].speed, machine.tilt.speed, machine.turn.speed],
    )
}

/// Checks every move.
pub fn check(program: &Program, motion: &Motion) -> MachineReport {
    let machine = &program.machine;
    let (travel, speed) = limits(machine);
    let mut used = [[f64::INFINITY, f64::NEG_INFINITY]; 5];
    let mut share = [0.0_f64; 5];
    let mut pole = f64::INFINITY;
    let mut faults: [Option<AxisFault>; 10] = Default::default();
    let mut fastest_axes = Vec::new();
    for (o, operation) in motion.operations.iter().enumerate() {
        let mut most: Option<(f64, usize, At)> = None;
        let mut before: Option<&Joints> = None;
        for (i, m) in operation.moves.iter().enumerate() {
            let at =
                At { operation: u32::try_from(o).unwrap_or(u32::MAX), index: u32::try_from(i).unwrap_or(u32::MAX) };
            if m.kind == MoveKind::Cut {
                pole = pole.min(m.joints.a.sin().abs().asin());
            }
            let places = path(machine, before.unwrap_or(&m.joints), &m.joints, before.is_some());
            for k in 0..5 {
                for q in &places {
                    used[k] = [used[k][0].min(q[k]), used[k][1].max(q[k])];
                    let beyond = (q[k] - travel[k][1]).max(travel[k][0] - q[k]);
                    let worse = faults[k].as_ref().is_none_or(|f| beyond > (f.value - f.bound).abs());
                    if beyond > 0.0 && worse {
                        let bound = if q[k] > travel[k][1] { travel[k][1] } else { travel[k][0] };
                        faults[k] = Some(AxisFault { axis: LETTERS[k], value: q[k], bound, speed: false, at });
                    }
                }
                if m.time > 0.0 {
                    let fastest = places
                        .windows(2)
                        .map(|w| (w[1][k] - w[0][k]).abs() * (places.len() - 1) as f64 / m.time / speed[k])
                        .fold(0.0, f64::max);
                    share[k] = share[k].max(fastest);
                    if most.is_none_or(|m| fastest > m.0) {
                        most = Some((fastest, k, at));
                    }
                    if fastest > 1.0 + SPEED_ROUNDING && faults[5 + k].as_ref().is_none_or(|f| fastest > f.value) {
                        faults[5 + k] =
                            Some(AxisFault { axis: LETTERS[k], value: fastest, bound: 1.0, speed: true, at });
                    }
                }
            }
            before = Some(&m.joints);
        }
        fastest_axes.push(most.map(|(share, k, at)| {
            let end = operation.moves.get(at.index as usize).map(|m| machine.forward(&m.joints).tip);
            let tip = end.unwrap_or_else(Point3::origin);
            FastestAxis { axis: LETTERS[k], share, at, tip: [tip.x, tip.y, tip.z] }
        }));
    }
    let shown = |k: usize, x: f64| if k < 3 { x } else { x.to_degrees() };
    let mut faults: Vec<AxisFault> = faults.into_iter().flatten().collect();
    for f in faults.iter_mut().filter(|f| !f.speed && matches!(f.axis, 'A' | 'C')) {
        (f.value, f.bound) = (f.value.to_degrees(), f.bound.to_degrees());
    }
    MachineReport {
        axes: (0..5)
            .map(|k| AxisRange {
                axis: LETTERS[k],
                used: used[k].map(|x| shown(k, x)),
                travel: travel[k].map(|x| shown(k, x)),
                speed_share: share[k],
            })
            .collect(),
        pole_distance: pole.to_degrees(),
        faults,
        fastest: fastest_axes,
    }
}

/// Joints along a move; only its end when it positions from an unknown place.
fn path(machine: &Machine, from: &Joints, to: &Joints, moves: bool) -> Vec<[f64; 5]> {
    if !moves {
        return vec![coordinates(to)];
    }
    let tips: [Point3<f64>; 2] = [machine.forward(from).tip, machine.forward(to).tip];
    (0..=PLACES)
        .map(|k| {
            let t = k as f64 / PLACES as f64;
            let tip = tips[0] + (tips[1] - tips[0]) * t;
            coordinates(&machine.joints(&tip, from.a + (to.a - from.a) * t, from.c + (to.c - from.c) * t))
        })
        .collect()
}
