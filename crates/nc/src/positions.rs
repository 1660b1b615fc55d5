//! Rotary positions for directions of the tool: what a control does with a vector, and what a post-processor may do with CL
//! data, which leave the choice to it.

use super::control::WORD_ROUNDING_RAD;
use super::nc::{Direction, NcSection};
use five_axis::{Angles, Machine};
use nalgebra::Vector3;
use nurbs::angle::nearest_turn;
use std::f64::consts::TAU;

/// Most turns to either side of zero that are tried.
const MAX_WINDINGS: i32 = 3;

/// Of the rotary positions for a direction within the travel the nearest; where there is none, the nearest of all.
pub(super) fn within_travel(machine: &Machine, axis: &Vector3<f64>, before: Angles) -> Option<Angles> {
    let near = machine.chain.near(axis, before)?;
    if reaches(machine, near) {
        return Some(near);
    }
    let way = |p: &Angles| libm::hypot(p[0] - before[0], p[1] - before[1]);
    let fits = candidates(machine, axis, before[1]).into_iter().filter(|p| reaches(machine, *p));
    Some(fits.min_by(|a, b| way(a).total_cmp(&way(b))).unwrap_or(near))
}

/// Rotary positions at the start of a section of poses: the first of those for its direction from which all moves stay
/// within the travel.
///
/// # Errors
/// There are none; the line up to which most moves stay within the travel.
pub(super) fn at_start(machine: &Machine, section: &NcSection, axis: &Vector3<f64>) -> Result<Angles, usize> {
    let mut line = section.start.line;
    for start in candidates(machine, axis, 0.0).into_iter().filter(|p| reaches(machine, *p)) {
        match section.moves.get(moves_within(machine, section, start)) {
            Some(m) => line = line.max(m.line),
            None => return Ok(start),
        }
    }
    Err(line)
}

/// Number of moves of a section that stay within the travel.
fn moves_within(machine: &Machine, section: &NcSection, start: Angles) -> usize {
    let mut at = start;
    for (k, m) in section.moves.iter().enumerate() {
        let next = match m.direction {
            Direction::Rotary(angles) => Some(angles),
            Direction::Axis(axis) if m.rapid => within_travel(machine, &axis, at),
            Direction::Axis(axis) => machine.chain.near(&axis, at),
        };
        match next.filter(|p| reaches(machine, *p)) {
            Some(angles) => at = angles,
            None => return k,
        }
    }
    section.moves.len()
}

/// Both solutions for a direction, with some turns of axis 2 to either side, the nearest to an angle of axis 2 first.
fn candidates(machine: &Machine, axis: &Vector3<f64>, near: f64) -> Vec<Angles> {
    let Some(solutions) = machine.chain.inverse(axis, near) else { return Vec::new() };
    let turns = (0..=MAX_WINDINGS).flat_map(|k| [k, -k]).skip(1);
    let turned = |k: i32| solutions.map(|[first, second]| [first, nearest_turn(second, near) + f64::from(k) * TAU]);
    turns.flat_map(turned).collect()
}

fn reaches(machine: &Machine, rotary: Angles) -> bool {
    machine
        .rotary
        .iter()
        .zip(rotary)
        .all(|(axis, q)| q >= axis.min - WORD_ROUNDING_RAD && q <= axis.max + WORD_ROUNDING_RAD)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nc::{NcMove, NcPlace, NcPose, NcStation, NcTool};
    use crate::tool_shape::NcToolShape;
    use five_axis::{Chain, RotaryAxis};
    use nalgebra::Point3;

    fn machine(first: [f64; 2], second: [f64; 2]) -> Machine {
        let mut machine = Machine::unlimited(Chain::tilting_table());
        for (axis, [min, max]) in machine.rotary.iter_mut().zip([first, second]) {
            *axis = RotaryAxis { min, max, ..axis.clone() };
        }
        machine
    }

    /// A section through rotary positions, at feed or at rapid.
    fn section(machine: &Machine, through: &[(Angles, bool)]) -> NcSection {
        let axis = |rotary| machine.chain.tool_axis(rotary);
        let tip = Point3::origin();
        let moves = through.iter().map(|(rotary, rapid)| NcMove {
            line: 1,
            rapid: *rapid,
            tip,
            direction: Direction::Axis(axis(*rotary)),
            feed: None,
            time: None,
            tool: NcTool::Number(1),
            speed: 0.0,
            interpolation: five_axis::Interpolation::RotaryLinear,
            smoothing: Some(0.0),
            turn: None,
            curve: None,
            frame_turned: false,
        });
        let place = NcPlace::Pose(NcPose { tip, axis: axis(through[0].0) });
        let start = NcStation { line: 1, place };
        NcSection { start, moves: moves.collect(), retract: None, shape: NcToolShape::default() }
    }

    /// Axis 2 turns on in steps of half a radian.
    fn turning(first: f64, from: f64, to: f64) -> Vec<(Angles, bool)> {
        let steps = ((to - from).abs() / 0.5).ceil();
        (0..=steps as u32).map(|k| ([first, from + (to - from) * f64::from(k) / steps], k == 0)).collect()
    }

    #[test]
    fn the_start_leaves_room_for_all_moves() {
        let start = |machine: &Machine, through: &[(Angles, bool)]| {
            let axis = machine.chain.tool_axis(through[0].0);
            at_start(machine, &section(machine, through), &axis).unwrap()
        };
        let near = |a: Angles, b: Angles| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9;
        // Near zero the travel does not allow a turn of 300 deg upward; a turn lower there is.
        let wide = machine([-1.7, 1.7], [-6.0, 1.0]);
        assert!(near(start(&wide, &turning(0.8, 0.5, 5.5)), [0.8, 0.5 - TAU]));
        assert!(near(start(&wide, &turning(0.8, 0.5, 0.9)), [0.8, 0.5]));
        // Axis 1 tilts to one side alone: the other solution.
        let one_side = machine([-1.7, 0.1], [-4.0, 4.0]);
        assert!(near(start(&one_side, &turning(0.8, 0.5, 0.9)), [-0.8, 0.5 - TAU / 2.0]));
    }

    #[test]
    fn a_rapid_goes_back_where_the_travel_ends() {
        let narrow = machine([0.0, 1.7], [-3.2, 3.2]);
        let axis = narrow.chain.tool_axis([0.8, 3.4]);
        assert!(narrow.chain.near(&axis, [0.8, 3.0]).unwrap()[1] > 3.3);
        let back = within_travel(&narrow, &axis, [0.8, 3.0]).unwrap();
        assert!((back[1] - 3.4 + TAU).abs() < 1e-9, "{back:?}");
    }
}
