//! What several sectors repeat: parts of an operation that are the same moves, turned about the axis of the part.
//!
//! All sectors of a part are equal, so most passes of a sector are those of another sector, turned by some pitches. The
//! joints show it: the part lies on rotary axis 2, which turns about the axis of the part. A pass can also have the other
//! branch of the rotary axes: then axis 1 has the opposite sign, and axis 2 another position.
//!
//! An operation is cut into *units* where the caller allows it. Units of the same moves are of one class. Units that
//! follow each other in every place are one *subprogram*, as long as possible: the text says it once.

use crate::{JointMove, Program};
use five_axis::{Carries, Machine, Pose};
use nalgebra::{Rotation3, Vector3};
use std::collections::BTreeMap;
use std::ops::Range;

/// Differences of positions that are rounding of the arithmetic: tip, mm; axis of the tool and rotary axes, radians.
pub const POSITION_ROUNDING: (f64, f64) = (1e-7, 1e-9);

/// Largest component of the direction of rotary axis 2 across Z, and largest distance from the axis of the part, mm.
const ON_AXIS: f64 = 1e-9;

/// Distance of a tip from the axis of the part below which it does not show by how much it is turned, mm.
const NEAR_AXIS: f64 = 1e-3;

/// Steps of the key by which units that may be alike are found, mm. Neighbours of a border of a step are missed; they are
/// as rare as the arithmetic is exact.
const KEY: f64 = 1e-3;

/// Lines that a call adds: frame, shift of the rotary axes, call. A subprogram also has a begin, an end and a comment.
const CALL_LINES: usize = 4;

/// For each item the first one that is alike. Only items of the same key are compared: what is alike but lies beside a border of
/// keys counts as something else.
pub fn first_alike<T, K: Ord>(items: &[T], key: impl Fn(&T) -> K, alike: impl Fn(&T, &T) -> bool) -> Vec<usize> {
    let mut firsts: BTreeMap<K, Vec<usize>> = BTreeMap::new();
    let first = |(i, item): (usize, &T)| {
        let known = firsts.entry(key(item)).or_default();
        known.iter().copied().find(|k| alike(&items[*k], item)).unwrap_or_else(|| {
            known.push(i);
            i
        })
    };
    items.iter().enumerate().map(first).collect()
}

/// How a part of an operation is turned from where it is first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turned {
    /// Turn of the poses about Z, counter-clockwise: number of pitches, less than the sectors of the part.
    pub pitches: u32,
    /// Factor of the positions of rotary axis 1: 1, or -1 on the other branch.
    pub first: f64,
    /// Shift of the positions of rotary axis 2, radians, ISO sense.
    pub second: f64,
}

impl Turned {
    /// No turn.
    pub const NOT: Self = Self { pitches: 0, first: 1.0, second: 0.0 };

    fn is(&self, other: &Self) -> bool {
        self.pitches == other.pitches
            && self.first == other.first
            && (self.second - other.second).abs() <= 2.0 * POSITION_ROUNDING.1
    }
}

/// Moves of an operation that follow each other.
#[derive(Clone, Debug, PartialEq)]
pub struct MoveInterval {
    /// Indices of the moves.
    pub moves: Range<usize>,
    /// Subprogram, counted from 0 in the order of the first places, and its turn from there; `None` for moves that nothing
    /// repeats.
    pub repeats: Option<(usize, Turned)>,
}

/// An operation as intervals in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Division {
    /// All moves between the first and the last one.
    pub intervals: Vec<MoveInterval>,
    /// Number of subprograms.
    pub subprograms: usize,
}

impl Division {
    /// Places of a subprogram, the first one first.
    pub fn places(&self, subprogram: usize) -> impl Iterator<Item = (&Range<usize>, &Turned)> {
        self.intervals.iter().filter_map(move |s| match &s.repeats {
            Some((of, turned)) if *of == subprogram => Some((&s.moves, turned)),
            _ => None,
        })
    }
}

/// Why the sectors of a program do not repeat each other for the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoSymmetry {
    /// Rotary axis 2 does not turn the part about its axis.
    Axis,
    /// The words of the post have too few digits: turned words would be others than those that were proved.
    Digits,
}

/// Compares moves of different sectors.
pub struct Symmetry<'a> {
    machine: &'a Machine,
    /// Turn about Z of 0, 1, 2 ... pitches.
    turns: Vec<Rotation3<f64>>,
    /// Angle between neighbouring sectors, radians.
    pitch: f64,
}

impl<'a> Symmetry<'a> {
    /// The symmetry of a program.
    ///
    /// # Errors
    /// There is none.
    pub fn of(program: &'a Program) -> Result<Self, NoSymmetry> {
        let (machine, part) = (&program.machine, &program.part);
        let table = &machine.chain.axes()[1];
        let to_part = machine.chain.part_axes().inverse();
        let beside = (to_part * (table.point.coords - machine.part_origin)).xy();
        let across = machine.chain.directions_in_part()[1].xy();
        if table.carries != Carries::Part || across.amax() > ON_AXIS || beside.amax() > ON_AXIS {
            return Err(NoSymmetry::Axis);
        }
        if program.post.control.decimals.is_coarse(program.post.control.orientation) {
            return Err(NoSymmetry::Digits);
        }
        let turns = (0..part.vane_count).map(|k| part.sector_rotation(k)).collect();
        Ok(Self { machine, turns, pitch: part.pitch() })
    }

    /// Divides an operation. `cut` tells whether an interval may begin at a move; `same` compares what moves have beside
    /// their joints.
    pub fn divide(
        &self,
        moves: &[JointMove],
        cut: &dyn Fn(usize) -> bool,
        same: &dyn Fn(&JointMove, &JointMove) -> bool,
    ) -> Division {
        let units = Units::new(self, moves, cut, same);
        units.division()
    }

    /// Groups of moves that are the same in several places, each with the indices of its moves. `cut` and `same` as in
    /// [`Self::divide`].
    pub fn groups(
        &self,
        moves: &[JointMove],
        cut: &dyn Fn(usize) -> bool,
        same: &dyn Fn(&JointMove, &JointMove) -> bool,
    ) -> Vec<Vec<usize>> {
        let units = Units::new(self, moves, cut, same);
        let mut of_class: Vec<Vec<usize>> = vec![Vec::new(); units.first.len()];
        for (unit, (class, _)) in units.classes.iter().enumerate() {
            of_class[*class].push(unit);
        }
        let repeated = of_class.into_iter().filter(|of| of.len() > 1);
        repeated
            .flat_map(|of| {
                let starts: Vec<usize> = of.iter().map(|unit| units.ranges[*unit].start).collect();
                let count = units.ranges[of[0]].len();
                (0..count).map(move |k| starts.iter().map(|start| start + k).collect())
            })
            .collect()
    }

    /// The turn that takes a move to another one.
    fn turn_between(&self, [a, b]: [&JointMove; 2], [from, to]: [&Pose; 2]) -> Option<Turned> {
        let azimuth = |v: &Vector3<f64>| libm::atan2(v.y, v.x);
        if libm::hypot(from.tip.x, from.tip.y) < NEAR_AXIS {
            return None;
        }
        let count = self.turns.len() as i64;
        let steps = ((azimuth(&to.tip.coords) - azimuth(&from.tip.coords)) / self.pitch).round() as i64;
        let [a, b] = [a.joints.rotary, b.joints.rotary];
        let first = if (b[0] - a[0]).abs() <= POSITION_ROUNDING.1 { 1.0 } else { -1.0 };
        let pitches = u32::try_from(steps.rem_euclid(count)).ok()?;
        Some(Turned { pitches, first, second: b[1] - a[1] })
    }

    fn takes(&self, turned: &Turned, [a, b]: [&JointMove; 2], [from, to]: [&Pose; 2]) -> bool {
        let turn = &self.turns[turned.pitches as usize];
        let ([a0, a1], [b0, b1]) = (a.joints.rotary, b.joints.rotary);
        (b0 - turned.first * a0).abs() <= POSITION_ROUNDING.1
            && (b1 - a1 - turned.second).abs() <= POSITION_ROUNDING.1
            && (turn * from.tip - to.tip).amax() <= POSITION_ROUNDING.0
            && (turn * from.axis - to.axis).amax() <= POSITION_ROUNDING.1
    }
}

/// An operation in units, with the class of each.
struct Units {
    ranges: Vec<Range<usize>>,
    /// Class of each unit, and its turn from the first unit of the class.
    classes: Vec<(usize, Turned)>,
    /// First unit of each class.
    first: Vec<usize>,
}

impl Units {
    fn new(
        symmetry: &Symmetry<'_>,
        moves: &[JointMove],
        cut: &dyn Fn(usize) -> bool,
        same: &dyn Fn(&JointMove, &JointMove) -> bool,
    ) -> Self {
        let end = moves.len().saturating_sub(1);
        let mut ranges = Vec::new();
        let mut start = 1;
        for i in 2..=end {
            if i == end || cut(i) {
                ranges.push(start..i);
                start = i;
            }
        }
        let poses: Vec<Pose> = moves.iter().map(|m| symmetry.machine.forward(&m.joints)).collect();
        let mut known: BTreeMap<[i64; 4], Vec<usize>> = BTreeMap::new();
        let mut units = Self { ranges, classes: Vec::new(), first: Vec::new() };
        for (unit, range) in units.ranges.iter().enumerate() {
            let of_key = known.entry(key(&poses, range)).or_default();
            let found = of_key.iter().find_map(|class: &usize| {
                let from = &units.ranges[units.first[*class]];
                if from.len() != range.len() {
                    return None;
                }
                let pair =
                    |k: usize| ([&moves[from.start + k], &moves[range.start + k]], [from.start + k, range.start + k]);
                let at = |[a, b]: [usize; 2]| [&poses[a], &poses[b]];
                let (first, places) = pair(0);
                let turned = symmetry.turn_between(first, at(places))?;
                let all = (0..range.len()).all(|k| {
                    let (both, places) = pair(k);
                    same(both[0], both[1]) && symmetry.takes(&turned, both, at(places))
                });
                all.then_some((*class, turned))
            });
            let class = found.unwrap_or_else(|| {
                units.first.push(unit);
                of_key.push(units.first.len() - 1);
                (units.first.len() - 1, Turned::NOT)
            });
            units.classes.push(class);
        }
        units
    }

    /// For each class whether in all its places the same class follows, turned alike, and is nowhere else.
    fn followed(&self) -> Vec<bool> {
        let mut count = vec![0_usize; self.first.len()];
        self.classes.iter().for_each(|(class, _)| count[*class] += 1);
        let next = |class: usize| self.classes.get(self.first[class] + 1).map(|n| n.0);
        let mut followed: Vec<bool> = (0..self.first.len())
            .map(|class| {
                next(class).is_some_and(|n| self.first[n] == self.first[class] + 1 && count[n] == count[class])
            })
            .collect();
        for (unit, (class, turned)) in self.classes.iter().enumerate() {
            let holds = self.classes.get(unit + 1).is_some_and(|(n, t)| Some(*n) == next(*class) && t.is(turned));
            followed[*class] &= holds;
        }
        followed
    }

    fn division(&self) -> Division {
        let followed = self.followed();
        // Stretches of whole subprograms, each with the class that it begins with.
        let mut found: Vec<(Range<usize>, usize, Turned)> = Vec::new();
        let mut goes_on = false;
        for (range, (class, turned)) in self.ranges.iter().zip(&self.classes) {
            match found.last_mut().filter(|_| goes_on) {
                Some((moves, ..)) => moves.end = range.end,
                None => found.push((range.clone(), *class, *turned)),
            }
            goes_on = followed[*class];
        }
        let mut places = vec![0_usize; self.first.len()];
        found.iter().for_each(|(_, class, _)| places[*class] += 1);
        let mut subprograms: BTreeMap<usize, usize> = BTreeMap::new();
        let mut division = Division::default();
        for (moves, class, turned) in found {
            let (count, lines) = (places[class], moves.len());
            if (count - 1) * lines > (count + 1) * CALL_LINES {
                let number = subprograms.len();
                let subprogram = *subprograms.entry(class).or_insert(number);
                division.intervals.push(MoveInterval { moves, repeats: Some((subprogram, turned)) });
            } else {
                match division.intervals.last_mut().filter(|last| last.repeats.is_none()) {
                    Some(last) => last.moves.end = moves.end,
                    None => division.intervals.push(MoveInterval { moves, repeats: None }),
                }
            }
        }
        division.subprograms = subprograms.len();
        division
    }
}

/// What a unit and its turned copies have in common.
fn key(poses: &[Pose], range: &Range<usize>) -> [i64; 4] {
    let steps = |x: f64| (x / KEY).round() as i64;
    let [first, middle] = [range.start, range.start + range.len() / 2].map(|k| poses[k].tip);
    let radius = |p: nalgebra::Point3<f64>| steps(libm::hypot(p.x, p.y));
    [i64::try_from(range.len()).unwrap_or(i64::MAX), radius(first), steps(first.z), radius(middle)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MoveKind;
    use five_axis::Chain;
    use nalgebra::Point3;

    fn symmetry(machine: &Machine, sectors: u32) -> Symmetry<'_> {
        let pitch = std::f64::consts::TAU / f64::from(sectors);
        let turns =
            (0..sectors).map(|k| Rotation3::from_axis_angle(&Vector3::z_axis(), pitch * f64::from(k))).collect();
        Symmetry { machine, turns, pitch }
    }

    /// A course of `count` moves in a sector, from rotary positions on.
    fn course(
        machine: &Machine,
        turn: &Rotation3<f64>,
        [first, second]: [f64; 2],
        seed: f64,
        count: usize,
    ) -> Vec<JointMove> {
        let at = |k: usize| {
            let t = seed + k as f64 * 0.1;
            let sign = if first < 0.0 { -1.0 } else { 1.0 };
            let tip = turn * Point3::new(20.0 + t, 3.0 * t, -t);
            let joints = machine.joints(&tip, [first + sign * 0.01 * t, second + 0.02 * t]);
            JointMove { kind: MoveKind::Cut, joints, feed: Some(200.0), time: 1.0, pass: 0, stop: false }
        };
        (0..count).map(at).collect()
    }

    fn ends(moves: &mut Vec<JointMove>) {
        let (first, last) = (moves[0], moves[moves.len() - 1]);
        moves.insert(0, first);
        moves.push(last);
    }

    #[test]
    fn what_repeats_is_found_with_its_turn_and_its_branch() {
        let machine = Machine::unlimited(Chain::tilting_table());
        let symmetry = symmetry(&machine, 8);
        let pitch = symmetry.pitch;
        let mut moves = Vec::new();
        for k in 0..8 {
            let turn = &symmetry.turns[k];
            let second = 0.3 + pitch * k as f64;
            // Sectors 5 to 7 take the other branch; a full turn of axis 2 is another winding.
            let rotary = if k < 5 {
                [0.7, second - if k == 4 { 2.0 * std::f64::consts::TAU } else { 0.0 }]
            } else {
                [-0.7, second - std::f64::consts::PI]
            };
            moves.extend(course(&machine, turn, rotary, 0.0, 40));
            // What no other sector has.
            moves.extend(course(&machine, turn, rotary, 7.0 + k as f64, 5));
        }
        ends(&mut moves);
        let cut = |i: usize| (i - 1).is_multiple_of(45) || (i - 1) % 45 == 40 || (i - 1) % 45 == 20;
        let division = symmetry.divide(&moves, &cut, &|a, b| a.feed == b.feed);
        assert_eq!(division.subprograms, 1);
        let places: Vec<_> = division.places(0).collect();
        assert_eq!(places.len(), 8);
        for (k, (range, turned)) in places.into_iter().enumerate() {
            assert_eq!(*range, 1 + 45 * k..41 + 45 * k);
            assert_eq!((turned.pitches, turned.first), (k as u32, if k < 5 { 1.0 } else { -1.0 }));
        }
        assert_eq!(division.intervals.len(), 16);
        // All moves, once and in order.
        let mut at = 1;
        for interval in &division.intervals {
            assert_eq!(interval.moves.start, at);
            at = interval.moves.end;
        }
        assert_eq!(at, moves.len() - 1);
        // Another feed in one move divides the subprogram.
        moves[1 + 45 * 3 + 30].feed = Some(199.0);
        let division = symmetry.divide(&moves, &cut, &|a, b| a.feed == b.feed);
        assert_eq!(division.subprograms, 2);
        assert_eq!([0, 1].map(|s| division.places(s).count()), [8, 7]);
        // A tip that is off by more than rounding is no repetition.
        moves[1 + 45 * 2 + 5].joints.xyz.x += 1e-5;
        let division = symmetry.divide(&moves, &cut, &|a, b| a.feed == b.feed);
        assert_eq!([0, 1].map(|s| division.places(s).count()), [7, 7]);
    }

    #[test]
    fn short_parts_stay_where_they_are() {
        let machine = Machine::unlimited(Chain::tilting_table());
        let symmetry = symmetry(&machine, 8);
        let mut moves = Vec::new();
        for k in 0..8 {
            moves.extend(course(&machine, &symmetry.turns[k], [0.7, symmetry.pitch * k as f64], 0.0, 4));
        }
        ends(&mut moves);
        let division = symmetry.divide(&moves, &|i| (i - 1).is_multiple_of(4), &|_, _| true);
        assert_eq!(division.subprograms, 0);
        assert_eq!(division.intervals, [MoveInterval { moves: 1..33, repeats: None }]);
        let groups = symmetry.groups(&moves, &|i| (i - 1).is_multiple_of(4), &|_, _| true);
        assert_eq!(groups.len(), 4);
        assert_eq!(groups[1], (0..8).map(|k| 2 + 4 * k).collect::<Vec<_>>());
    }
}
