//! V4: joints within their travel, also between the ends of a move, axis speeds within their limits, the feed really
//! reached, and how far the real motion leaves the one that was verified.

use super::dynamics::{self, Peak, Run};
use super::sweep::At;
use crate::ir::{Motion, MoveKind, Program};
use crate::kin::{Interpolation, Joints, Machine};
use nalgebra::Point3;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::FRAC_PI_2;

/// Places inside a move at which the joints are looked at. The tip runs straight and the rotary axes evenly, so that
/// between two of 16 places a linear joint leaves its chord by less than 1/256 of its sag over the whole move.
const PLACES: usize = 16;

/// Excess over a travel that is rounding of the way from joints to the part and back, mm and radians.
const TRAVEL_ROUNDING: f64 = 1e-9;

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
    /// Largest speed that is reached, as a share of the limit.
    pub speed_share: f64,
    /// Largest acceleration inside of blocks that the programmed feeds would take, as a share of the limit: above 1 the
    /// control slows down.
    pub acceleration_share: f64,
    /// Largest jerk that is reached, as a share of the limit; zero where there is none.
    pub jerk_share: f64,
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

/// How far the tool would leave the verified motion between blocks if the control filled in by another rule, from the
/// tip to the end of the flutes, mm. While cutting and linking.
#[derive(Clone, Debug, Serialize)]
pub struct OtherRules {
    /// Tool axis on great circles instead of linear rotary axes.
    pub great_circle: Peak,
    /// Without tool centre point control.
    pub joints_linear: Peak,
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
    /// For each operation the axis that comes nearest to its speed limit, as it is reached.
    pub fastest: Vec<Option<FastestAxis>>,
    /// How each operation runs.
    pub runs: Vec<Run>,
    /// What other rules of interpolation would do in each operation.
    pub other_rules: Vec<OtherRules>,
}

const LETTERS: [char; 5] = ['X', 'Y', 'Z', 'A', 'C'];

/// Positions of the axes; Z is that of the gauge line, `length` over the tip.
fn coordinates(j: &Joints, length: f64) -> [f64; 5] {
    [j.xyz.x, j.xyz.y, j.xyz.z + length, j.a, j.c]
}

/// Travel in the units of the joints.
fn travel(machine: &Machine) -> [[f64; 2]; 5] {
    let l = &machine.linear;
    [
        [l[0].min, l[0].max],
        [l[1].min, l[1].max],
        [l[2].min, l[2].max],
        [machine.tilt.min, machine.tilt.max],
        [machine.turn.min, machine.turn.max],
    ]
}

/// Checks every move.
pub fn check(program: &Program, motion: &Motion) -> MachineReport {
    let machine = &program.machine;
    let (travel, speed) = (travel(machine), machine.speeds());
    let mut used = [[f64::INFINITY, f64::NEG_INFINITY]; 5];
    // No axis is farther from the pole.
    let mut pole = FRAC_PI_2;
    let mut faults: [Option<AxisFault>; 10] = Default::default();
    for (o, operation) in motion.operations.iter().enumerate() {
        let length = program.tools[program.operations[operation.operation].tool].length();
        let mut before: Option<&Joints> = None;
        for (i, m) in operation.moves.iter().enumerate() {
            let at =
                At { operation: u32::try_from(o).unwrap_or(u32::MAX), index: u32::try_from(i).unwrap_or(u32::MAX) };
            if m.kind == MoveKind::Cut {
                pole = pole.min(to_pole(before.map_or(m.joints.a, |b| b.a), m.joints.a));
            }
            let places = path(machine, before.unwrap_or(&m.joints), &m.joints, before.is_some(), length);
            for k in 0..5 {
                for q in &places {
                    used[k] = [used[k][0].min(q[k]), used[k][1].max(q[k])];
                    let beyond = (q[k] - travel[k][1]).max(travel[k][0] - q[k]);
                    let worse = faults[k].as_ref().is_none_or(|f| beyond > (f.value - f.bound).abs());
                    if beyond > TRAVEL_ROUNDING && worse {
                        let bound = if q[k] > travel[k][1] { travel[k][1] } else { travel[k][0] };
                        faults[k] = Some(AxisFault { axis: LETTERS[k], value: q[k], bound, speed: false, at });
                    }
                }
                if m.time > 0.0 {
                    let fastest = places
                        .windows(2)
                        .map(|w| (w[1][k] - w[0][k]).abs() * (places.len() - 1) as f64 / m.time / speed[k])
                        .fold(0.0, f64::max);
                    if fastest > 1.0 + SPEED_ROUNDING && faults[5 + k].as_ref().is_none_or(|f| fastest > f.value) {
                        faults[5 + k] =
                            Some(AxisFault { axis: LETTERS[k], value: fastest, bound: 1.0, speed: true, at });
                    }
                }
            }
            before = Some(&m.joints);
        }
    }
    let shown = |k: usize, x: f64| if k < 3 { x } else { x.to_degrees() };
    let mut faults: Vec<AxisFault> = faults.into_iter().flatten().collect();
    for f in faults.iter_mut().filter(|f| !f.speed && matches!(f.axis, 'A' | 'C')) {
        (f.value, f.bound) = (f.value.to_degrees(), f.bound.to_degrees());
    }
    let count = motion.operations.len();
    let runs: Vec<Run> = (0..count).into_par_iter().map(|o| dynamics::run(program, motion, o)).collect();
    for (k, peak) in runs.iter().flat_map(|r| r.speed.iter().enumerate()) {
        let worse = peak.value > 1.0 + SPEED_ROUNDING && faults.iter().all(|f| !(f.speed && f.axis == LETTERS[k]));
        if let Some(at) = peak.at.filter(|_| worse) {
            faults.push(AxisFault { axis: LETTERS[k], value: peak.value, bound: 1.0, speed: true, at });
        }
    }
    let other_rules = (0..count).into_par_iter().map(|o| other_rules(program, motion, o)).collect();
    let most = |peaks: &dyn Fn(&Run) -> Peak| runs.iter().map(|r| peaks(r).value).fold(0.0, f64::max);
    MachineReport {
        axes: (0..5)
            .map(|k| AxisRange {
                axis: LETTERS[k],
                used: used[k].map(|x| shown(k, x)),
                travel: travel[k].map(|x| shown(k, x)),
                speed_share: most(&|r| r.speed[k]),
                acceleration_share: most(&|r| r.asked[k]),
                jerk_share: most(&|r| r.jerk[k]),
            })
            .collect(),
        pole_distance: pole.to_degrees(),
        faults,
        fastest: runs.iter().map(|run| fastest(program, motion, run)).collect(),
        runs,
        other_rules,
    }
}

/// Least angle to the pole between two positions of A, radians.
fn to_pole(from: f64, to: f64) -> f64 {
    let half_turns = |a: f64| (a / std::f64::consts::PI).floor();
    if half_turns(from) != half_turns(to) {
        return 0.0;
    }
    libm::asin(libm::sin(from).abs()).min(libm::asin(libm::sin(to).abs()))
}

/// The axis of a run that comes nearest to its limit.
fn fastest(program: &Program, motion: &Motion, run: &Run) -> Option<FastestAxis> {
    let (axis, peak) = LETTERS.into_iter().zip(run.speed).max_by(|a, b| a.1.value.total_cmp(&b.1.value))?;
    let at = peak.at?;
    let end = motion.operations.get(at.operation as usize)?.moves.get(at.index as usize)?;
    let tip = program.machine.forward(&end.joints).tip;
    Some(FastestAxis { axis, share: peak.value, at, tip: [tip.x, tip.y, tip.z] })
}

fn other_rules(program: &Program, motion: &Motion, operation: usize) -> OtherRules {
    let mut found = OtherRules { great_circle: Peak::NONE, joints_linear: Peak::NONE };
    let Some(moves) = motion.operations.get(operation) else { return found };
    let height = program.tools[program.operations[moves.operation].tool].solid.flute_length;
    for (i, pair) in moves.moves.windows(2).enumerate().filter(|(_, pair)| pair[1].kind != MoveKind::Rapid) {
        let at = At {
            operation: u32::try_from(operation).unwrap_or(u32::MAX),
            index: u32::try_from(i + 1).unwrap_or(u32::MAX),
        };
        let by = |rule: Interpolation| rule.deviation(&program.machine, &pair[0].joints, &pair[1].joints, height);
        found.great_circle.raise(by(Interpolation::GreatCircle), at);
        found.joints_linear.raise(by(Interpolation::JointsLinear), at);
    }
    found
}

/// Positions of the axes along a move; only its end when it positions from an unknown place.
fn path(machine: &Machine, from: &Joints, to: &Joints, moves: bool, length: f64) -> Vec<[f64; 5]> {
    if !moves {
        return vec![coordinates(to, length)];
    }
    let tips: [Point3<f64>; 2] = [machine.forward(from).tip, machine.forward(to).tip];
    (0..=PLACES)
        .map(|k| {
            let t = k as f64 / PLACES as f64;
            let tip = tips[0] + (tips[1] - tips[0]) * t;
            coordinates(&machine.joints(&tip, from.a + (to.a - from.a) * t, from.c + (to.c - from.c) * t), length)
        })
        .collect()
}
