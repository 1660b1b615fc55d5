//! Branch and winding of the rotary axes over a sequence of moves.

use crate::ir::ClPoint;
use crate::kin::{Angles, Machine};
use std::f64::consts::TAU;

/// Excess over the travel of a rotary axis that is rounding, radians: a tenth of what the verifier takes for rounding.
const AT_LIMIT: f64 = 1e-10;

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

/// Rotary angles of a sequence of places, on one branch and without unwinding, within the travel of all axes for a tool
/// of the given length (mm). Of several solutions the one nearest to the present position `at` is taken.
///
/// # Errors
/// The first place out of travel, of the attempt that gets farthest: where only X, Y or Z leave their travel with some winding, of
/// those attempts.
pub(crate) fn solve(machine: &Machine, run: &[ClPoint], length: f64, at: Angles) -> Result<Vec<Angles>, OutOfTravel> {
    let mut best: Option<(f64, Vec<Angles>)> = None;
    let [first, last] = &machine.rotary;
    let mut nearest_miss: Option<OutOfTravel> = None;
    for branch in 0..2 {
        let mut angles: Vec<Angles> = Vec::with_capacity(run.len());
        for p in run {
            let before = angles.last().map_or(at[1], |x| x[1]);
            angles.push(machine.chain.unwound(&p.axis, branch, before));
        }
        // Whole turns that bring the sequence into the travel, among them the turns near the middle of the travel. Axis 1
        // turns less than once.
        let [of_first, shift] = [(0, first), (1, last)].map(|(k, axis)| {
            let ends = angles.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x[k]), h.max(x[k])));
            let middle = 0.5 * (axis.min.max(-1e3) + axis.max.min(1e3));
            TAU * ((middle - 0.5 * (ends.0 + ends.1)) / TAU).round()
        });
        for turns in [0.0, shift, shift - TAU, shift + TAU] {
            let moved: Vec<Angles> = angles.iter().map(|[first, second]| [first + of_first, second + turns]).collect();
            if let Some(miss) = out_of_travel(machine, run, length, &moved) {
                if nearest_miss.as_ref().is_none_or(|n| (miss.linear, miss.index) > (n.linear, n.index)) {
                    nearest_miss = Some(miss);
                }
                continue;
            }
            let time = |k: usize| (moved[0][k] - at[k]).abs() / machine.rotary[k].speed;
            let cost = time(1) + time(0);
            if best.as_ref().is_none_or(|b| cost < b.0) {
                best = Some((cost, moved));
            }
        }
    }
    match (best, nearest_miss) {
        (Some((_, angles)), _) => Ok(angles),
        (None, Some(miss)) => Err(miss),
        (None, None) => Ok(Vec::new()),
    }
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
    use crate::kin::{Chain, LinearAxis, RotaryAxis};
    use nalgebra::{Point3, Vector3};

    /// Y leaves its travel with every winding. From 340 deg on, the nearest winding of C leaves the travel of C at the first place too.
    #[test]
    fn the_axis_that_no_winding_helps_is_named() {
        let mut linear = [LinearAxis::WIDE; 3];
        (linear[1].min, linear[1].max) = (-1.0, 1.0);
        let most = 350.0_f64.to_radians();
        let c = RotaryAxis { min: -most, max: most, ..RotaryAxis::wide("C") };
        let machine = Machine { linear, rotary: [RotaryAxis::wide("A"), c], ..Machine::wide(Chain::tilting_table()) };
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
