//! V4: travel of the joints, also between the ends of a move; limits of the axis speeds; the feed that is reached; and
//! the deviation of the real motion from the verified motion.

use super::dynamics::{self, Peak, Run};
use super::proof::piece::At;
use super::stock::StockReport;
use base::units::{Deg, Mm, Share};
use five_axis::{Chain, Interpolation, Joints, Machine, between};
use ir::{Motion, MoveKind, Program};
use nalgebra::Point3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// Places inside a move at which the joints are checked. The tip runs straight and the rotary axes evenly. Between two
/// of 16 places a linear joint therefore deviates from its chord by less than 1/256 of its sagitta over the whole move.
const PLACES_PER_MOVE: usize = 16;

/// Excess over a travel that counts as rounding of the conversion from joints to the part and back, mm and radians.
const TRAVEL_ROUNDING: f64 = 1e-9;

/// Excess of an axis speed over its limit that counts as rounding of times and feeds.
const SPEED_ROUNDING: f64 = 1e-3;

/// Range of an axis; `Q` is the unit of its positions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisRange<Q> {
    /// Name.
    pub axis: String,
    /// Least and largest position used.
    pub used: [Q; 2],
    /// Travel; `None` for an axis without limits.
    pub travel: Option<[Q; 2]>,
    /// Largest speed of the run, as a share of the limit.
    pub speed_share: Share,
    /// Largest acceleration inside of blocks at the programmed feeds, as a share of the limit: above 1 the control
    /// slows down.
    pub acceleration_share: Share,
    /// Largest jerk of the run, as a share of the limit; zero without a limit.
    pub jerk_share: Share,
}

/// All axes; in a file a list of five.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "StoredAxes", into = "StoredAxes")]
pub struct Axes {
    /// X, Y and Z.
    pub linear: [AxisRange<Mm>; 3],
    /// The rotary axes, the first next to the tool.
    pub rotary: [AxisRange<Deg>; 2],
}

#[derive(Serialize, Deserialize)]
struct StoredAxes(AxisRange<Mm>, AxisRange<Mm>, AxisRange<Mm>, AxisRange<Deg>, AxisRange<Deg>);

impl From<StoredAxes> for Axes {
    fn from(StoredAxes(x, y, z, first, second): StoredAxes) -> Self {
        Self { linear: [x, y, z], rotary: [first, second] }
    }
}

impl From<Axes> for StoredAxes {
    fn from(Axes { linear: [x, y, z], rotary: [first, second] }: Axes) -> Self {
        Self(x, y, z, first, second)
    }
}

/// Violation of a limit by an axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisFault {
    /// Name.
    pub axis: String,
    /// Position (mm or deg), or the speed as a share of the limit.
    pub value: f64,
    /// Violated limit.
    pub bound: f64,
    /// True for a speed, false for a position.
    pub speed: bool,
    /// Move.
    pub at: At,
}

/// An axis speed of one move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FastestAxis {
    /// Name.
    pub axis: String,
    /// Largest speed as a share of the limit.
    pub share: Share,
    /// Move.
    pub at: At,
    /// Tool tip at the end of the move, part frame, mm.
    pub tip: [f64; 3],
}

/// Deviation of the tool from the verified motion between blocks under other rules of interpolation, from the tip to
/// the end of the flutes; for cuts and links.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct OtherRules {
    /// Tool axis on great circles instead of linear rotary axes.
    pub great_circle: Peak<Mm>,
    /// Without tool centre point control.
    pub joints_linear: Peak<Mm>,
}

/// Figures of the machine check.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MachineReport {
    /// X, Y, Z and both rotary axes.
    pub axes: Axes,
    /// Least angle between the tool axis and rotary axis 2 while cutting.
    pub pole_distance: Deg,
    /// Worst fault of each axis.
    pub faults: Vec<AxisFault>,
    /// For each operation the axis nearest to its speed limit in the run.
    pub fastest: Vec<Option<FastestAxis>>,
    /// Run of each operation.
    pub runs: Vec<Run>,
    /// Deviations under other rules of interpolation in each operation.
    pub other_rules: Vec<OtherRules>,
}

/// Checks every move. The simulated stock says where limits of removal are near; without it none counts.
pub fn check(program: &Program, motion: &Motion, stock: Option<&StockReport>) -> MachineReport {
    let machine = &program.machine;
    let mut axes = AxisUse::new(machine);
    // The largest possible angle to the pole.
    let mut pole = FRAC_PI_2;
    for (o, operation) in motion.operations.iter().enumerate() {
        let length = program.tools[program.operations[operation.operation].tool].length();
        let mut before: Option<(&Joints, [f64; 5])> = None;
        for (i, m) in operation.moves.iter().enumerate() {
            let at =
                At { operation: u32::try_from(o).unwrap_or(u32::MAX), index: u32::try_from(i).unwrap_or(u32::MAX) };
            if m.kind == MoveKind::Cut {
                let first = |j: &Joints| j.rotary[0];
                pole = pole.min(to_pole(
                    &machine.chain,
                    before.map_or(first(&m.joints), |b| first(b.0)),
                    first(&m.joints),
                ));
            }
            let place = machine.positions(&m.joints, length);
            if let Some((from, start)) = before {
                axes.take([from, &m.joints], [start, place], m.time, length, at);
            } else {
                axes.take_places(&[place], 0.0, at);
            }
            before = Some((&m.joints, place));
        }
    }
    let AxisUse { used, travel, mut faults, .. } = axes;
    let name = |k: usize| machine.names()[k].to_owned();
    let shown = |k: usize, x: f64| if k < 3 { x } else { x.to_degrees() };
    let count = motion.operations.len();
    let removal = |o: usize| stock.and_then(|s| s.operations.get(o)).map_or(&[][..], |o| &o.removal);
    let runs: Vec<Run> = (0..count).into_par_iter().map(|o| dynamics::run(program, motion, o, removal(o))).collect();
    for (k, peak) in runs.iter().flat_map(|r| r.speed.iter().enumerate()) {
        // If a block alone exceeds a speed, the block is the fault; the run adds speeds that only successive blocks
        // exceed.
        let worse = peak.value > Share(1.0 + SPEED_ROUNDING) && faults[5 + k].is_none();
        if let Some(at) = peak.at.filter(|_| worse) {
            faults[5 + k] = Some(AxisFault { axis: name(k), value: peak.value.get(), bound: 1.0, speed: true, at });
        }
    }
    for (k, fault) in faults.iter_mut().take(5).enumerate() {
        if let Some(f) = fault {
            (f.value, f.bound) = (shown(k, f.value), shown(k, f.bound));
        }
    }
    let other_rules = (0..count).into_par_iter().map(|o| other_rules(program, motion, o)).collect();
    let range = |k: usize| Positions { name: machine.names()[k], used: used[k], travel: travel[k] };
    MachineReport {
        axes: Axes {
            linear: [0, 1, 2].map(|k| range(k).report(k, &runs, Mm)),
            rotary: [3, 4].map(|k| range(k).report(k, &runs, |angle| Deg(angle.to_degrees()))),
        },
        pole_distance: Deg(pole.to_degrees()),
        faults: faults.into_iter().flatten().collect(),
        fastest: runs.iter().map(|run| fastest(program, motion, run)).collect(),
        runs,
        other_rules,
    }
}

/// What the moves use of the axes.
struct AxisUse<'a> {
    machine: &'a Machine,
    travel: [[f64; 2]; 5],
    speed: [f64; 5],
    used: [[f64; 2]; 5],
    /// Worst fault of the travel of each axis, and of its speed.
    faults: [Option<AxisFault>; 10],
}

impl<'a> AxisUse<'a> {
    fn new(machine: &'a Machine) -> Self {
        Self {
            machine,
            travel: machine.travel(),
            speed: machine.speeds(),
            used: [[f64::INFINITY, f64::NEG_INFINITY]; 5],
            faults: Default::default(),
        }
    }

    /// Takes a move between two poses, given by joints and by positions of the axes.
    fn take(&mut self, joints: [&Joints; 2], ends: [[f64; 5]; 2], time: f64, length: f64, at: At) {
        // Most moves are inside of what the others use, with all that they can bend.
        let bend = bend(self.machine, joints, length);
        let inside = (0..5).all(|k| {
            let bend = if k < 3 { bend } else { 0.0 };
            let [low, high] = [ends[0][k].min(ends[1][k]) - bend, ends[0][k].max(ends[1][k]) + bend];
            let steepest = (ends[1][k] - ends[0][k]).abs() + 4.0 * bend;
            low >= self.used[k][0].max(self.travel[k][0])
                && high <= self.used[k][1].min(self.travel[k][1])
                && (time <= 0.0 || steepest <= time * self.speed[k])
        });
        if !inside {
            self.take_places(&path(self.machine, joints, length), time, at);
        }
    }

    /// Takes places of a move that takes a time.
    fn take_places(&mut self, places: &[[f64; 5]], time: f64, at: At) {
        let Self { machine, travel, speed, used, faults } = self;
        let name = |k: usize| machine.names()[k].to_owned();
        for k in 0..5 {
            for q in places {
                used[k] = [used[k][0].min(q[k]), used[k][1].max(q[k])];
                let beyond = (q[k] - travel[k][1]).max(travel[k][0] - q[k]);
                let worse = faults[k].as_ref().is_none_or(|f| beyond > (f.value - f.bound).abs());
                if beyond > TRAVEL_ROUNDING && worse {
                    let bound = if q[k] > travel[k][1] { travel[k][1] } else { travel[k][0] };
                    faults[k] = Some(AxisFault { axis: name(k), value: q[k], bound, speed: false, at });
                }
            }
            if time > 0.0 {
                let fastest = places
                    .windows(2)
                    .map(|w| (w[1][k] - w[0][k]).abs() * (places.len() - 1) as f64 / time / speed[k])
                    .fold(0.0, f64::max);
                if fastest > 1.0 + SPEED_ROUNDING && faults[5 + k].as_ref().is_none_or(|f| fastest > f.value) {
                    faults[5 + k] = Some(AxisFault { axis: name(k), value: fastest, bound: 1.0, speed: true, at });
                }
            }
        }
    }
}

/// Positions of an axis, mm or radians.
struct Positions<'a> {
    name: &'a str,
    used: [f64; 2],
    travel: [f64; 2],
}

impl Positions<'_> {
    /// The range of axis `k` in its unit, with what the runs take of its limits.
    fn report<Q>(&self, k: usize, runs: &[Run], unit: impl Fn(f64) -> Q) -> AxisRange<Q> {
        let most = |peaks: fn(&Run) -> &[Peak<Share>; 5]| {
            Share(runs.iter().map(|run| peaks(run)[k].value.get()).fold(0.0, f64::max))
        };
        AxisRange {
            axis: self.name.to_owned(),
            used: self.used.map(&unit),
            travel: self.travel.iter().all(|x| x.is_finite()).then(|| self.travel.map(&unit)),
            speed_share: most(|run| &run.speed),
            acceleration_share: most(|run| &run.required_acceleration),
            jerk_share: most(|run| &run.jerk),
        }
    }
}

/// Least angle between the tool and rotary axis 2, in either sense of the tool, while axis 1 turns from one position to
/// another, radians.
fn to_pole(chain: &Chain, from: f64, to: f64) -> f64 {
    if chain.poles_between(from, to) {
        return 0.0;
    }
    let angle = |first: f64| libm::asin(libm::sin(chain.polar_angle(first)).abs());
    angle(from).min(angle(to))
}

/// The axis of a run nearest to its speed limit.
fn fastest(program: &Program, motion: &Motion, run: &Run) -> Option<FastestAxis> {
    let names = program.machine.names();
    let (axis, peak) = names.into_iter().zip(run.speed).max_by(|a, b| a.1.value.total_cmp(&b.1.value))?;
    let at = peak.at?;
    let end = motion.operations.get(at.operation as usize)?.moves.get(at.index as usize)?;
    let tip = program.machine.forward(&end.joints).tip;
    Some(FastestAxis { axis: axis.to_owned(), share: peak.value, at, tip: [tip.x, tip.y, tip.z] })
}

fn other_rules(program: &Program, motion: &Motion, operation: usize) -> OtherRules {
    let mut found = OtherRules { great_circle: Peak::none(), joints_linear: Peak::none() };
    let Some(moves) = motion.operations.get(operation) else { return found };
    let tool = &program.tools[program.operations[moves.operation].tool];
    let (length, height) = (tool.length(), tool.solid.flute_length);
    for (i, pair) in moves.moves.windows(2).enumerate().filter(|(_, pair)| pair[1].kind != MoveKind::Rapid) {
        let at = At {
            operation: u32::try_from(operation).unwrap_or(u32::MAX),
            index: u32::try_from(i + 1).unwrap_or(u32::MAX),
        };
        let by =
            |rule: Interpolation| rule.deviation(&program.machine, [&pair[0].joints, &pair[1].joints], length, height);
        found.great_circle.raise(by(Interpolation::GreatCircle), at);
        found.joints_linear.raise(by(Interpolation::JointsLinear), at);
    }
    found
}

/// Upper bound of the distance of a linear axis from the straight line between its ends in a move, mm: an eighth of its
/// largest second derivative by the share of the move. The tip runs straight, and its distance from a rotary axis, with the
/// tool in a head, is at most the sum below.
fn bend(machine: &Machine, ends: [&Joints; 2], length: f64) -> f64 {
    let tips = ends.map(|joints| machine.forward(joints).tip);
    let turn: f64 = (0..2).map(|k| (ends[1].rotary[k] - ends[0].rotary[k]).abs()).sum();
    let axes: f64 = machine.chain.axes().iter().map(|axis| axis.point.coords.norm()).sum();
    let far = tips[0].coords.norm().max(tips[1].coords.norm()) + axes + machine.part_origin.norm() + length;
    (turn * turn * far + 2.0 * turn * (tips[1] - tips[0]).norm()) / 8.0
}

/// Positions of the axes along a move.
fn path(machine: &Machine, [from, to]: [&Joints; 2], length: f64) -> Vec<[f64; 5]> {
    let tips: [Point3<f64>; 2] = [machine.forward(from).tip, machine.forward(to).tip];
    (0..=PLACES_PER_MOVE)
        .map(|k| {
            let t = k as f64 / PLACES_PER_MOVE as f64;
            let tip = tips[0] + (tips[1] - tips[0]) * t;
            machine.positions(&machine.joints(&tip, between(from.rotary, to.rotary, t)), length)
        })
        .collect()
}
