//! Strokes along the axis: material that they meet in the middle of the end, which has no teeth.
//!
//! A stroke with material more than [`RIDGE`] above its end presses on it. Thinner layers are ridges between the floors of
//! two strokes, unless a stroke at the same place follows: blocks that divide a stroke press as the whole does.

use super::ramp::MAX_RUN_STEPS;
use super::{StepPlace, StepValue};
use ir::{MoveKind, Tool};
use tool_stock::stock::BlockCut;
use tool_stock::stock::lune::RIDGE;

/// Depth of material in the middle of the end that counts as rubbing on the floor of the stroke before, mm.
pub(super) const MAX_RUBBING_DEPTH: f64 = 0.05;

/// Sum of thin layers at one place, mm, from which they are no ridge: a ridge, and the rest of the step that meets it.
const MAX_RIDGE: f64 = 2.0 * RIDGE;

/// Least share of a step along the axis, as in the simulation.
const MIN_AXIAL_SHARE: f64 = 0.998;

/// How far material reaches into the middle of the end of a tool, mm; `None` where it does not.
pub(super) fn deepest(tool: &Tool, places: &[StepPlace], cuts: &[BlockCut]) -> Option<StepValue> {
    let toothless = tool.toothless_radius().filter(|radius| *radius > MAX_RUBBING_DEPTH)?;
    let whole =
        cuts.iter().filter_map(|c| Some(StepValue { value: toothless - c.lune.as_ref()?.inner(), step: c.block }));
    let mut into = vec![0.0; places.len()];
    for cut in cuts {
        let Some(place) = places.get(cut.block as usize) else { continue };
        let stroke = place.kind != MoveKind::Rapid && place.down > MIN_AXIAL_SHARE * place.way;
        if stroke && toothless - cut.nearest > MAX_RUBBING_DEPTH {
            into[cut.block as usize] = toothless - cut.nearest;
        }
    }
    // A way down that the tool takes sideways is no stroke, however blocks divide it into stairs.
    let slope = libm::tan(tool.ramp.get());
    let thick = |last: usize| {
        let (mut layers, mut across) = (0.0, 0.0);
        for i in (0..=last).rev().take(MAX_RUN_STEPS) {
            layers += if into[i] > 0.0 { places[i].down.min(RIDGE) } else { 0.0 };
            across += places[i].across();
            if layers > MAX_RIDGE + slope * across {
                return true;
            }
            if across >= toothless {
                break;
            }
        }
        false
    };
    let divided = (0_u32..)
        .zip(&into)
        .filter(|(i, into)| **into > 0.0 && thick(*i as usize))
        .map(|(step, into)| StepValue { value: *into, step });
    whole.chain(divided).filter(|found| found.value > 0.0).max_by(|a, b| a.value.total_cmp(&b.value))
}
