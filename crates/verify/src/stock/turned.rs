//! Steps that meet the same stock as an earlier step, turned: their chips are the chips of that step.
//!
//! The blank is a body of revolution. What a step meets is then decided by the cuts before it that reach the space which its tool
//! sweeps. Space is divided into bins about the axis of the part that turn into one another by a pitch. Each bin has a sum over
//! the cuts that have reached it: over their classes of partners ([`crate::proof::turns`]) and their sectors, counted from that of
//! the bin. Two partners whose bins have the same sums meet the same stock, turned: the sums do not depend on the order of the
//! cuts, as the stock does not. So the first one of them is simulated with its chips. Other cuts are simulated, without chips, where
//! they reach a bin of a later step that is. A tool outside of the blank meets no stock.
//!
//! Nothing is taken from the planner: a block that was changed in one sector belongs to another class there, so that its chips, and
//! those of all that meet its cut, are its own. Sums of different cuts agree by chance once in 1e30 pairs.
//!
//! The rays of the stock lie differently in each sector: chips are those of the rays of the first partner.

use crate::proof::turns::{PartnerRounding, TurnClasses};
use base::units::Share;
use ir::Program;
use nalgebra::{Point3, Rotation3};
use rayon::prelude::*;
use std::collections::HashMap;
use std::f64::consts::FRAC_1_SQRT_2;
use std::ops::Range;
use tool_stock::collide::ToolSolid;
use tool_stock::stock::{BlockCut, Collision, Outcome, Step, StepKind};
use wheel::part::TurnedProfile;

/// Most steps that are compared as one.
const UNIT: u32 = 8;

/// Bins from the axis to the rim of the blank.
const ACROSS: f64 = 16.0;

/// Reserve about a tool, mm: more than partners differ by.
const RESERVE: f64 = 1e-2;

/// Length of the parts of a tool that are compared with the blank, by its radius.
const SHORT: f64 = 0.5;

/// Share of the steps with the chips of another one from which on it pays.
const LEAST_TURNED: f64 = 0.2;

/// How a step is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Treatment {
    /// With its chips.
    Measured,
    /// Only its cut.
    Cut,
    /// Not at all.
    Left,
}

/// Successive steps of one operation that are compared as one.
struct Unit {
    /// Steps, counted from the first one of the operation.
    steps: Range<usize>,
    class: usize,
    /// First step in time of the class of the first step, and pitches from there.
    first: u32,
    pitches: u32,
    kind: StepKind,
    treatment: Treatment,
    /// The unit of the operation whose chips it has, turned.
    like: Option<usize>,
}

/// The units of a program, operation by operation.
pub(super) struct TurnedSteps {
    operations: Vec<Vec<Unit>>,
    turns: Vec<Rotation3<f64>>,
}

/// Bins about the axis of the part.
struct Bins {
    size: f64,
    low: f64,
    rows: usize,
    columns: usize,
    /// Bins of a pitch, and of a whole turn.
    per_pitch: usize,
    around: usize,
    /// Whether the blank reaches into the bins of a row and a column.
    filled: Vec<bool>,
}

/// A bin: its place around, and its row and column. A tool meets some fifty of them in each step.
type Bin = (u16, u16);

impl Bins {
    fn new(blank: &TurnedProfile, vanes: usize) -> Self {
        let (mut radius, mut low, mut high) = (0.0_f64, f64::INFINITY, f64::NEG_INFINITY);
        for [r, z] in blank.iter() {
            (radius, low, high) = (radius.max(*r), low.min(*z), high.max(*z));
        }
        let size = radius / ACROSS;
        let per_pitch = (std::f64::consts::TAU * ACROSS / vanes as f64).ceil() as usize;
        let (rows, columns) = (((high - low) / size).ceil() as usize, ACROSS as usize + 1);
        let middle = |k: usize| (k as f64 + 0.5) * size;
        let is_filled = |k: usize| {
            blank.distance([middle(k % columns), low + middle(k / columns)]) <= FRAC_1_SQRT_2 * size + RESERVE
        };
        let filled = (0..rows * columns).map(is_filled).collect();
        Self { size, low, rows, columns, per_pitch, around: per_pitch * vanes, filled }
    }

    fn count(&self) -> usize {
        self.around * self.filled.len()
    }

    /// The bins that a ball meets.
    fn add(&self, centre: &Point3<f64>, radius: f64, found: &mut Vec<Bin>) {
        let out = centre.coords.xy().norm();
        let span = |from: f64, to: f64, count: usize| {
            let cell = |x: f64| (x / self.size).floor();
            // Casts saturate at zero.
            (to >= 0.0 && cell(from) < count as f64).then(|| cell(from) as usize..=(cell(to) as usize).min(count - 1))
        };
        let Some(rows) = span(centre.z - radius - self.low, centre.z + radius - self.low, self.rows) else { return };
        let Some(columns) = span(out - radius, out + radius, self.columns) else { return };
        let per_radian = self.around as f64 / std::f64::consts::TAU;
        let (first, count) = if out > radius {
            let (middle, half) = (libm::atan2(centre.y, centre.x), libm::asin(radius / out));
            let first = ((middle - half) * per_radian).floor();
            let count = ((middle + half) * per_radian).floor() - first + 1.0;
            (first.rem_euclid(self.around as f64) as usize, (count as usize).min(self.around))
        } else {
            (0, self.around)
        };
        let places = rows.flat_map(|row| columns.clone().map(move |column| row * self.columns + column));
        for place in places.filter(|place| self.filled[*place]) {
            found.extend((0..count).map(|k| (narrow((first + k) % self.around), narrow(place))));
        }
    }

    /// The bins that parts of a tool meet in a step.
    fn of(&self, parts: &[ToolPart], step: &Step) -> Vec<Bin> {
        let mut found = Vec::new();
        for part in parts {
            part.balls(step, part.radius.max(self.size))
                .for_each(|(centre, radius)| self.add(&centre, radius, &mut found));
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// A step of which the tool is outside of the blank meets no bins.
    fn class(&self, blank: &TurnedProfile, solid: &ToolSolid, steps: &[Step]) -> UnitClass {
        let widest = solid.cutter.widest_below(solid.flute_length);
        let cutter = [ToolPart { from: 0.0, to: solid.flute_length, radius: widest }];
        let sections = solid.shank.iter().chain(&solid.holder);
        let body: Vec<_> =
            sections.map(|s| ToolPart { from: s.from, to: s.to, radius: s.radius_from.max(s.radius_to) }).collect();
        let outside = |step: &Step| {
            let mut parts = cutter.iter().chain(&body);
            parts.all(|part| {
                let mut balls = part.balls(step, (SHORT * part.radius).max(RESERVE));
                balls.all(|(p, radius)| blank.distance([p.coords.xy().norm(), p.z]) > radius)
            })
        };
        let mut found = UnitClass { cutter: vec![Vec::new(); steps.len()], whole: Vec::new() };
        for (step, own) in steps.iter().zip(&mut found.cutter).filter(|(step, _)| !outside(step)) {
            *own = self.of(&cutter, step);
            found.whole.extend(own.iter().copied().chain(self.of(&body, step)));
        }
        found.whole.sort_unstable();
        found.whole.dedup();
        found
    }

    /// Index of a bin that is turned by some pitches.
    fn index(&self, (around, place): Bin, pitches: u32) -> usize {
        let around = (usize::from(around) + pitches as usize * self.per_pitch) % self.around;
        around * self.filled.len() + usize::from(place)
    }

    /// Sector of a bin.
    fn sector(&self, (around, _): Bin) -> u64 {
        (usize::from(around) / self.per_pitch) as u64
    }
}

/// A part of a tool by its heights and its largest radius, mm.
struct ToolPart {
    from: f64,
    to: f64,
    radius: f64,
}

impl ToolPart {
    /// Balls that hold this part of the tool in a step, each about a length of at most `longest`.
    fn balls(&self, step: &Step, longest: f64) -> impl Iterator<Item = (Point3<f64>, f64)> {
        let Self { from, to, radius } = *self;
        let tip = step.tips[0] + (step.tips[1] - step.tips[0]) * 0.5;
        let axis = step.axes[1];
        let way = 0.5 * (step.tips[1] - step.tips[0]).norm();
        let turn = (step.axes[0] - axis).norm().max((step.axes[2] - axis).norm());
        let count = ((to - from) / longest).ceil().max(1.0);
        let length = (to - from) / count;
        (0..count as usize).map(move |k| {
            let height = from + length * (k as f64 + 0.5);
            let moved = way + 1.1 * turn * (height + length);
            (tip + axis * height, libm::hypot(radius, 0.5 * length) + moved + RESERVE)
        })
    }
}

/// Bins of the units of a class where the first one in time is: those that the cutter meets in each step, and those that the
/// tool meets in any.
struct UnitClass {
    cutter: Vec<Vec<Bin>>,
    whole: Vec<Bin>,
}

/// A place of a bin: there are no more than fit, or no bins at all.
fn narrow(place: usize) -> u16 {
    u16::try_from(place).unwrap_or(u16::MAX)
}

/// A number whose bits depend on all bits of another one (the finaliser of splitmix64).
fn mixed(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// The same in 128 bits, of two numbers.
fn mixed_pair(a: u64, b: u64) -> u128 {
    let low = mixed(mixed(a.wrapping_add(0x9e37_79b9_7f4a_7c15)).wrapping_add(b));
    let high = mixed(mixed(b.wrapping_add(0xd1b5_4a32_d192_ed03)) ^ a);
    u128::from(high) << 64 | u128::from(low)
}

impl TurnedSteps {
    /// The units of the steps of all operations, each with its tool. `None` where it does not pay.
    pub(super) fn of(
        program: &Program,
        operations: &[(Vec<Step>, &ToolSolid)],
        rounding: PartnerRounding,
    ) -> Option<Self> {
        let vanes = program.part.vane_count;
        if program.stock.left.is_some() || vanes < 2 {
            return None;
        }
        let turns: Vec<Rotation3<f64>> = (0..vanes).map(|k| program.part.sector_rotation(k)).collect();
        let bins = Bins::new(&program.stock.profile, turns.len());
        if bins.around.max(bins.filled.len()) > usize::from(u16::MAX) {
            return None;
        }
        let mut known: HashMap<(usize, u32, usize), usize> = HashMap::new();
        let mut firsts: Vec<(usize, Range<usize>)> = Vec::new();
        let units = |(steps, _): &(Vec<Step>, &ToolSolid)| units_of(steps, &TurnClasses::of(steps, &turns, rounding));
        let mut all: Vec<Vec<Unit>> = operations.par_iter().map(units).collect();
        for (o, units) in all.iter_mut().enumerate() {
            for unit in units {
                unit.class = *known.entry((o, unit.first, unit.steps.len())).or_insert_with(|| {
                    // Units of one class are in the order of time.
                    let first = unit.first as usize;
                    firsts.push((o, first..first + unit.steps.len()));
                    firsts.len() - 1
                });
            }
        }
        // The first unit of each class has chips of its own.
        let own: usize = firsts.iter().map(|(_, steps)| steps.len()).sum();
        let count: usize = operations.iter().map(|(steps, _)| steps.len()).sum();
        if own as f64 > (1.0 - LEAST_TURNED) * count as f64 {
            return None;
        }
        let class = |(o, steps): &(usize, Range<usize>)| {
            let (all, solid) = &operations[*o];
            bins.class(&program.stock.profile, solid, &all[steps.clone()])
        };
        let classes: Vec<UnitClass> = firsts.par_iter().map(class).collect();
        let mut turned = Self { operations: all, turns };
        turned.find_like(&bins, &classes);
        (turned.share().get() >= LEAST_TURNED).then(|| {
            turned.find_needed(&bins, &classes);
            turned
        })
    }

    /// Finds units that meet the same stock as an earlier one.
    fn find_like(&mut self, bins: &Bins, classes: &[UnitClass]) {
        let mut sums = vec![0_u128; bins.count()];
        for (o, units) in self.operations.iter_mut().enumerate() {
            let mut met: HashMap<(usize, u128), usize> = HashMap::new();
            for (k, unit) in units.iter_mut().enumerate() {
                let class = &classes[unit.class];
                let before = class.whole.iter().fold(0_u128, |sum, bin| {
                    let both = sum ^ sums[bins.index(*bin, unit.pitches)];
                    mixed_pair(both as u64, (both >> 64) as u64)
                });
                let cuts = unit.kind != StepKind::Rapid;
                for (step, own) in (unit.first..).zip(&class.cutter).filter(|_| cuts) {
                    for bin in own {
                        // The sector of the cut, counted from that of the bin, is the same for all partners.
                        let sector = bins.sector(*bin);
                        let sum = &mut sums[bins.index(*bin, unit.pitches)];
                        *sum = sum.wrapping_add(mixed_pair((o as u64) << 32 | u64::from(step), sector));
                    }
                }
                let like = *met.entry((unit.class, before)).or_insert(k);
                unit.like = (like != k).then_some(like);
            }
        }
    }

    /// Share of the steps that have the chips of another one.
    pub(super) fn share(&self) -> Share {
        let units = || self.operations.iter().flatten();
        let all: usize = units().map(|unit| unit.steps.len()).sum();
        let like: usize = units().filter(|unit| unit.like.is_some()).map(|unit| unit.steps.len()).sum();
        Share(if all > 0 { like as f64 / all as f64 } else { 0.0 })
    }

    /// Finds the cuts that have to be in the stock where a step with its own chips meets it.
    fn find_needed(&mut self, bins: &Bins, classes: &[UnitClass]) {
        let mut needed = vec![false; bins.count()];
        for unit in self.operations.iter_mut().rev().flat_map(|units| units.iter_mut().rev()) {
            let class = &classes[unit.class];
            if unit.like.is_none() {
                class.whole.iter().for_each(|bin| needed[bins.index(*bin, unit.pitches)] = true);
                continue;
            }
            let reaches = unit.kind != StepKind::Rapid
                && class.cutter.iter().flatten().any(|bin| needed[bins.index(*bin, unit.pitches)]);
            unit.treatment = if reaches { Treatment::Cut } else { Treatment::Left };
        }
    }

    /// How each step of an operation is simulated.
    pub(super) fn treatments(&self, operation: usize) -> impl Iterator<Item = Treatment> + '_ {
        self.operations[operation].iter().flat_map(|unit| unit.steps.clone().map(|_| unit.treatment))
    }

    /// Adds to the outcome of the simulated steps of an operation, whose blocks are the steps, the chips of the others.
    pub(super) fn complete(&self, operation: usize, outcome: &mut Outcome) {
        let simulated = std::mem::take(outcome);
        let units = &self.operations[operation];
        let of = |steps: &Range<usize>| {
            let [from, to] = [steps.start, steps.end].map(|k| u32::try_from(k).unwrap_or(u32::MAX));
            let cuts =
                simulated.cuts.partition_point(|c| c.block < from)..simulated.cuts.partition_point(|c| c.block < to);
            let met = simulated.collisions.partition_point(|c| c.block < from)
                ..simulated.collisions.partition_point(|c| c.block < to);
            (&simulated.cuts[cuts], &simulated.collisions[met])
        };
        for unit in units {
            let source = unit.like.map_or(unit, |like| &units[like]);
            let (cuts, met) = of(&source.steps);
            let block = |block: u32| block - source.steps.start as u32 + unit.steps.start as u32;
            let turn = self.turns[unit.pitches as usize] * self.turns[source.pitches as usize].inverse();
            outcome.cuts.extend(cuts.iter().map(|c| BlockCut { block: block(c.block), ..c.clone() }));
            outcome.collisions.extend(met.iter().map(|c| Collision {
                block: block(c.block),
                point: turn * c.point,
                ..*c
            }));
        }
    }
}

/// The units of the steps of an operation. Partners are divided alike.
fn units_of(steps: &[Step], members: &TurnClasses) -> Vec<Unit> {
    let mut units: Vec<Unit> = Vec::new();
    for (k, step) in steps.iter().enumerate() {
        let (first, pitches) = members.first_of(u32::try_from(k).unwrap_or(u32::MAX));
        match units.last_mut() {
            Some(unit)
                if unit.pitches == pitches
                    && unit.kind == step.kind
                    && first % UNIT != 0
                    && first as usize == unit.first as usize + unit.steps.len() =>
            {
                unit.steps.end = k + 1;
            }
            _ => units.push(Unit {
                steps: k..k + 1,
                class: 0,
                first,
                pitches,
                kind: step.kind,
                treatment: Treatment::Measured,
                like: None,
            }),
        }
    }
    units
}
