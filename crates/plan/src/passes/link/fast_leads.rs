//! `fast-leads`: leads of finishing run at link feed where the tool is outside of the blank.
//!
//! Before: the stations of finishing passes in sector 0. After: a station where a lead leaves the blank, and the moves
//! beyond it marked as moves through air. The blank is all the material there ever was, so that nothing needs to be
//! known about earlier operations.

use super::blank::Blank;
use crate::passes::axis::run::rotary;
use five_axis::{Chain, between};
use ir::{ClPass, ClPlan, ClPoint, Program};
use nurbs::bracket::Bracket;
use rayon::prelude::*;
use std::ops::Range;

/// Distance of the tool from the blank beyond which it runs at link feed, mm.
const OFF_BLANK: f64 = 0.5;

/// Shortest path at link feed, mm: on a shorter one the change of feed gains no time.
const MIN_AIR_LENGTH_MM: f64 = 1.0;

/// Bisection steps for the place where a lead leaves the blank: a lead of 100 mm divided by 2^14 is less than 0.01 mm.
const BLANK_BISECTIONS: usize = 14;

/// Marks the leads of all finishing passes.
pub(crate) fn run(program: &Program, cl: &mut ClPlan) {
    for planned in &mut cl.operations {
        let operation = &program.operations[planned.operation];
        if operation.kind.finishes() {
            let blank = Blank::new(&program.stock, &program.tools[operation.tool].solid);
            planned.passes.par_iter_mut().for_each(|pass| mark(&blank, &program.machine.chain, pass));
        }
    }
}

/// Marks the first and the last moves of a pass that are outside of the blank.
fn mark(blank: &Blank<'_>, chain: &Chain, pass: &mut ClPass) {
    let count = pass.points.len();
    let outside = |p: &ClPoint| blank.clear(p, OFF_BLANK);
    let Some(first) = pass.points.iter().position(|p| !outside(p)) else { return };
    let Some(last) = pass.points.iter().rposition(|p| !outside(p)) else { return };
    let length = |points: &[ClPoint]| points.windows(2).map(|w| (w[1].tip - w[0].tip).norm()).sum::<f64>();
    // The place where a lead leaves the blank, for a lead that is then long enough.
    let leaves = |inside: usize, out: usize, lead: Range<usize>| {
        let place = leaving(&outside, chain, [pass.points[inside], pass.points[out]]);
        let length = (place.tip - pass.points[out].tip).norm() + length(&pass.points[lead]);
        (length >= MIN_AIR_LENGTH_MM).then_some(place)
    };
    let behind = if last + 1 < count { leaves(last, last + 1, last + 1..count) } else { None };
    let before = if first > 0 { leaves(first, first - 1, 0..first) } else { None };
    // The end first, so that the indices at the start stay.
    let mut air = Vec::new();
    if let Some(place) = behind {
        pass.points.insert(last + 1, place);
        air.extend(last + 2..pass.points.len());
    }
    if let Some(place) = before {
        pass.points.insert(first, place);
        air = (1..=first).chain(air.into_iter().map(|i| i + 1)).collect();
    }
    pass.air = air;
}

/// The place on a move between a station inside and one outside from which on the tool is outside.
fn leaving(outside: &impl Fn(&ClPoint) -> bool, chain: &Chain, [inside, out]: [ClPoint; 2]) -> ClPoint {
    let angles = rotary(chain, [inside.axis, out.axis].into_iter());
    let at = |t: f64| {
        let axis = if t >= 1.0 { out.axis } else { chain.tool_axis(between(angles[0], angles[1], t)) };
        ClPoint { tip: inside.tip + (out.tip - inside.tip) * t, axis, contact: None }
    };
    at(Bracket { holds: 1.0, fails: 0.0 }.halved(BLANK_BISECTIONS, |t| outside(&at(t))).holds)
}
