//! Branch and winding of the rotary axes over sequences of moves.

use five_axis::{Angles, Machine};
use ir::ClPoint;
use std::f64::consts::TAU;

/// Excess over the travel of a rotary axis that is rounding, radians: a tenth of what the verifier takes for rounding.
const AT_LIMIT: f64 = 1e-10;

/// Number of windings below which all of them are tried.
const MAX_TRIED_TURNS: f64 = 8.0;

/// Largest number of whole turns of an axis without limits.
const MAX_TURNS: f64 = 1e6;

/// Why a sequence has no joints within travel.
pub(crate) struct OutOfTravel {
    pub(crate) index: usize,
    /// True for X, Y or Z: another winding of the rotary axes does not help.
    pub(crate) linear: bool,
    pub(crate) axis: String,
    pub(crate) value: f64,
    pub(crate) range: [f64; 2],
    pub(crate) unit: &'static str,
}

/// A sequence of places on a branch, with the whole turns of axis 2 that keep all axes within their travel.
pub(crate) struct OnBranch {
    branch: usize,
    /// Angles at the first and at the last place, without whole turns.
    ends: [Angles; 2],
    /// Least and largest number of whole turns.
    turns: [f64; 2],
}

impl OnBranch {
    /// The number of whole turns that brings the first place nearest to an angle of axis 2.
    fn nearest_turns(&self, at: f64) -> f64 {
        ((at - self.ends[0][1]) / TAU).round().clamp(self.turns[0], self.turns[1])
    }

    /// Numbers of whole turns to choose from, behind these angles of axis 2: all of a short travel, else those near the angles.
    fn choices(&self, before: impl Iterator<Item = f64>) -> Vec<f64> {
        let [fewest, most] = self.turns;
        let mut choices: Vec<f64> = if most - fewest < MAX_TRIED_TURNS {
            (0..=(most - fewest) as u32).map(|k| fewest + f64::from(k)).collect()
        } else {
            before.map(|at| self.nearest_turns(at)).collect()
        };
        choices.sort_by(f64::total_cmp);
        choices.dedup();
        choices
    }

    /// Angles at an end with whole turns.
    fn end(&self, k: usize, turns: f64) -> Angles {
        [self.ends[k][0], self.ends[k][1] + turns * TAU]
    }
}

/// A branch and a winding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Winding {
    branch: usize,
    turns: f64,
}

impl Winding {
    /// Rotary angles of a sequence of places, of which [`on_branches`] with the same angles `at` has this winding.
    pub(crate) fn angles(&self, machine: &Machine, run: &[ClPoint], at: Angles) -> Vec<Angles> {
        let angles = angles_on(machine, run, self.branch, at);
        angles.into_iter().map(|[first, second]| [first, second + self.turns * TAU]).collect()
    }
}

/// Rotary angles of a sequence of places, on one branch and without unwinding, within the travel of all axes for a tool
/// of the given length (mm). Of several solutions the one nearest to the present position `at` is taken.
///
/// # Errors
/// As [`on_branches`].
pub(crate) fn solve(machine: &Machine, run: &[ClPoint], length: f64, at: Angles) -> Result<Vec<Angles>, OutOfTravel> {
    let found = on_branches(machine, run, length, at)?;
    Ok(shortest(machine, &[&found], at).first().map_or(Vec::new(), |winding| winding.angles(machine, run, at)))
}

/// The branches on which all axes stay within their travel over a sequence of places without unwinding, for a tool of the given
/// length (mm). Where axis 2 is not determined at the first place, it stays as in `at`.
///
/// # Errors
/// The first place out of travel, of the attempt that gets farthest: where only X, Y or Z leave their travel with some winding, of
/// those attempts.
pub(crate) fn on_branches(
    machine: &Machine,
    run: &[ClPoint],
    length: f64,
    at: Angles,
) -> Result<Vec<OnBranch>, OutOfTravel> {
    let mut found = Vec::new();
    let second = &machine.rotary[1];
    let mut nearest_miss: Option<OutOfTravel> = None;
    for branch in 0..2 {
        let angles = angles_on(machine, run, branch, at);
        let Some(ends) = angles.first().zip(angles.last()).map(|(first, last)| [*first, *last]) else { break };
        let [low, high] = range(&angles, 1);
        let turns = [
            ((second.min - AT_LIMIT - low) / TAU).ceil().max(-MAX_TURNS),
            ((second.max + AT_LIMIT - high) / TAU).floor().min(MAX_TURNS),
        ];
        let miss = |turns: f64| {
            let turned: Vec<Angles> = angles.iter().map(|a| [a[0], a[1] + turns * TAU]).collect();
            out_of_travel(machine, run, length, &turned)
        };
        if turns[0] <= turns[1] && miss(0.0_f64.clamp(turns[0], turns[1])).is_none() {
            found.push(OnBranch { branch, ends, turns });
            continue;
        }
        let shift = into_travel([low, high], [second.min, second.max]);
        for miss in [0.0, shift, shift - 1.0, shift + 1.0].into_iter().filter_map(miss) {
            if nearest_miss.as_ref().is_none_or(|n| (miss.linear, miss.index) > (n.linear, n.index)) {
                nearest_miss = Some(miss);
            }
        }
    }
    match nearest_miss {
        Some(miss) if found.is_empty() => Err(miss),
        _ => Ok(found),
    }
}

/// Branch and winding of each sequence of an operation: those with which the rotary axes turn for the least time between the
/// sequences, from the angles `at` on.
pub(crate) fn shortest(machine: &Machine, runs: &[&[OnBranch]], at: Angles) -> Vec<Winding> {
    /// A choice for a sequence: the time up to it, and the choice before it.
    struct Choice {
        winding: Winding,
        end: Angles,
        time: f64,
        before: usize,
    }
    let time = |from: &Angles, to: &Angles| -> f64 {
        (0..2).rev().map(|k| (to[k] - from[k]).abs() / machine.rotary[k].speed).sum()
    };
    let start = Choice { winding: Winding { branch: 0, turns: 0.0 }, end: at, time: 0.0, before: 0 };
    let mut layers = vec![vec![start]];
    for run in runs {
        let last = layers.last().map_or(&[][..], Vec::as_slice);
        let mut layer = Vec::new();
        for on_branch in *run {
            for turns in on_branch.choices(last.iter().map(|choice| choice.end[1])) {
                let first = on_branch.end(0, turns);
                let times =
                    last.iter().enumerate().map(|(before, choice)| (choice.time + time(&choice.end, &first), before));
                let Some((time, before)) = times.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
                let winding = Winding { branch: on_branch.branch, turns };
                layer.push(Choice { winding, end: on_branch.end(1, turns), time, before });
            }
        }
        layers.push(layer);
    }
    let ends = layers.last().map_or(&[][..], Vec::as_slice).iter().enumerate();
    let mut at = ends.min_by(|a, b| a.1.time.total_cmp(&b.1.time)).map_or(0, |(k, _)| k);
    let mut chosen: Vec<Winding> = Vec::with_capacity(runs.len());
    for layer in layers.iter().skip(1).rev() {
        let Some(choice) = layer.get(at) else { break };
        chosen.push(choice.winding);
        at = choice.before;
    }
    chosen.reverse();
    chosen
}

/// Angles of a sequence of places on a branch, with axis 1 in its travel, and axis 2 without unwinding from near `at` on.
fn angles_on(machine: &Machine, run: &[ClPoint], branch: usize, at: Angles) -> Vec<Angles> {
    let mut angles: Vec<Angles> = Vec::with_capacity(run.len());
    for p in run {
        let before = angles.last().map_or(at[1], |x| x[1]);
        angles.push(machine.chain.unwound(&p.axis, branch, before));
    }
    // Axis 1 turns less than once.
    let first = &machine.rotary[0];
    let turns = into_travel(range(&angles, 0), [first.min, first.max]);
    angles.iter_mut().for_each(|angles| angles[0] += turns * TAU);
    angles
}

/// Least and largest angle of an axis.
fn range(angles: &[Angles], k: usize) -> [f64; 2] {
    angles.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x[k]), high.max(x[k])])
}

/// Whole turns that bring the middle of a range near the middle of a travel.
fn into_travel([low, high]: [f64; 2], [min, max]: [f64; 2]) -> f64 {
    let middle = 0.5 * (min.max(-1e3) + max.min(1e3));
    ((middle - 0.5 * (low + high)) / TAU).round()
}

/// The first place where an axis leaves its travel; rotary axes are checked first.
fn out_of_travel(machine: &Machine, run: &[ClPoint], length: f64, angles: &[Angles]) -> Option<OutOfTravel> {
    let travel = machine.travel();
    run.iter().zip(angles).enumerate().find_map(|(index, (p, rotary))| {
        let positions = machine.positions(&machine.joints(&p.tip, *rotary), length);
        let beyond = |k: &usize| {
            let most = if *k < 3 { 0.0 } else { AT_LIMIT };
            !(travel[*k][0] - most..=travel[*k][1] + most).contains(&positions[*k])
        };
        let k = [3, 4, 0, 1, 2].into_iter().find(beyond)?;
        let (unit, scale) = if k < 3 { ("mm", 1.0) } else { ("deg", 1.0_f64.to_degrees()) };
        let axis = machine.names()[k].to_owned();
        Some(OutOfTravel {
            index,
            linear: k < 3,
            axis,
            value: positions[k] * scale,
            range: travel[k].map(|x| x * scale),
            unit,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use five_axis::{Chain, LinearAxis, RotaryAxis};
    use nalgebra::{Point3, Vector3};
    use proptest::prelude::*;

    fn place(tilt: f64, azimuth: f64) -> ClPoint {
        let (sin, cos) = libm::sincos(azimuth);
        let axis = Vector3::new(libm::sin(tilt) * cos, libm::sin(tilt) * sin, libm::cos(tilt));
        ClPoint { tip: Point3::origin(), axis, contact: None }
    }

    /// Time between sequences, and whether all angles are within the travel.
    fn judged(machine: &Machine, runs: &[Vec<ClPoint>], windings: &[Winding], start: Angles) -> (f64, bool) {
        let (mut time, mut within, mut at) = (0.0, true, start);
        for (run, winding) in runs.iter().zip(windings) {
            let angles = winding.angles(machine, run, start);
            within &=
                angles.iter().all(|a| (0..2).all(|k| machine.rotary[k].min <= a[k] && a[k] <= machine.rotary[k].max));
            time += (0..2).map(|k| (angles[0][k] - at[k]).abs() / machine.rotary[k].speed).sum::<f64>();
            at = angles[angles.len() - 1];
        }
        (time, within)
    }

    proptest! {
        /// No other choice of branches and windings within the travel turns for less time.
        #[test]
        fn branches_and_windings_are_the_shortest_of_all(
            runs in prop::collection::vec(((0.2..1.2_f64, -3.1..3.1_f64), (0.2..1.2_f64, -2.5..2.5_f64)), 1..4), at in -5.0..5.0_f64
        ) {
            let most = 400.0_f64.to_radians();
            let a = RotaryAxis { min: -1.5, max: 1.5, speed: 0.7, ..RotaryAxis::unlimited("A") };
            let c = RotaryAxis { min: -most, max: most, ..RotaryAxis::unlimited("C") };
            let machine = Machine { rotary: [a, c], ..Machine::unlimited(Chain::tilting_table()) };
            let runs: Vec<Vec<ClPoint>> = runs
                .iter()
                .map(|((tilt, azimuth), (to, turn))| vec![place(*tilt, *azimuth), place(0.5 * (tilt + to), azimuth + 0.5 * turn), place(*to, azimuth + turn)])
                .collect();
            let found: Vec<Vec<OnBranch>> =
                runs.iter().map(|run| on_branches(&machine, run, 0.0, [0.0, at]).ok().unwrap()).collect();
            let slices: Vec<&[OnBranch]> = found.iter().map(Vec::as_slice).collect();
            let (chosen, within) = judged(&machine, &runs, &shortest(&machine, &slices, [0.0, at]), [0.0, at]);
            prop_assert!(within);
            let mut all: Vec<Vec<Winding>> = vec![Vec::new()];
            for _ in &runs {
                let each = |before: &Vec<Winding>| {
                    let before = before.clone();
                    (0..2).flat_map(|branch| (-4..=4).map(move |turns| Winding { branch, turns: f64::from(turns) })).map(move |w| {
                        before.iter().copied().chain([w]).collect()
                    })
                };
                all = all.iter().flat_map(each).collect();
            }
            let times = all.iter().map(|windings| judged(&machine, &runs, windings, [0.0, at])).filter(|x| x.1).map(|x| x.0);
            let least = times.fold(f64::INFINITY, f64::min);
            prop_assert!((chosen - least).abs() < 1e-9, "{chosen} {least}");
        }
    }

    /// Y leaves its travel with every winding. From 340 deg on, the nearest winding of C leaves the travel of C at the first place too.
    #[test]
    fn the_axis_that_no_winding_helps_is_named() {
        let mut linear = [LinearAxis::UNLIMITED; 3];
        (linear[1].min, linear[1].max) = (-1.0, 1.0);
        let most = 350.0_f64.to_radians();
        let c = RotaryAxis { min: -most, max: most, ..RotaryAxis::unlimited("C") };
        let machine =
            Machine { linear, rotary: [RotaryAxis::unlimited("A"), c], ..Machine::unlimited(Chain::tilting_table()) };
        for k in 0..8 {
            let (sin, cos) = libm::sincos(TAU * f64::from(k) / 8.0);
            let axis = Vector3::new(0.5 * cos, 0.5 * sin, 1.0).normalize();
            let places = [30.0, 31.0].map(|r| ClPoint {
                tip: Point3::new(r * (cos - sin), r * (sin + cos), -200.0),
                axis,
                contact: None,
            });
            let miss = solve(&machine, &places, 0.0, [0.5, 340.0_f64.to_radians()]).err().unwrap();
            assert!(miss.linear && miss.axis == "Y", "{} {} {}", miss.axis, miss.value, miss.index);
        }
    }
}
