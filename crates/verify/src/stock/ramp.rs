//! Ramps: how steeply a tool goes down, against the plane of its end, while material is under the middle of its end.
//!
//! The simulated stock says where each step cuts: nearest to the axis, at the time of the cut. A step that goes down and
//! cuts within the middle of the end has material below. The angle of a run of such steps is that over the width of the
//! middle, since material under the middle is as high as the tool goes down on this way. A run shorter than that counts
//! as if it went on level. What stands between the steps of a run does not end it before the tool has moved by that width:
//! stairs are as steep as the way that they divide.
//!
//! Strokes along the axis are no ramps: [`super::strokes`] judges them.

use super::{StepPlace, StepValue};
use ir::{MoveKind, Tool};
use tool_stock::stock::BlockCut;

/// Least radius of the middle of an end, as a share of the radius of the tool: also teeth that meet at the axis cut slowly
/// near to it.
const MIN_MIDDLE_SHARE: f64 = 0.25;

/// Most steps of a run: more are no machining of a part, and their number must not decide on the time of a check.
pub(super) const MAX_RUN_STEPS: usize = 1 << 12;

/// Radius of the middle of the end of a tool, mm.
fn middle(tool: &Tool) -> f64 {
    tool.toothless_radius().unwrap_or(0.0).max(MIN_MIDDLE_SHARE * tool.solid.cutter.nominal_radius())
}

/// Steepest angle, degrees; `None` where the tool nowhere goes down with material under its middle.
pub(super) fn steepest(tool: &Tool, places: &[StepPlace], cuts: &[BlockCut]) -> Option<StepValue> {
    let middle = middle(tool);
    let mut below = vec![false; places.len()];
    for cut in cuts.iter().filter(|c| c.lune.is_none() && c.nearest < middle) {
        if let Some(below) = below.get_mut(cut.block as usize) {
            *below = true;
        }
    }
    let goes_down = |i: usize| below[i] && places[i].kind != MoveKind::Rapid && places[i].down > 0.0;
    let width = 2.0 * middle;
    let over = |down: f64, across: f64| libm::atan2(down, across.max(width)).to_degrees();
    let angle = |last: usize| {
        let (mut down, mut across, mut steepest) = (0.0, 0.0, 0.0_f64);
        for i in (0..=last).rev().take(MAX_RUN_STEPS) {
            let step_across = places[i].across();
            if goes_down(i) {
                down += places[i].down;
                across += step_across;
            } else {
                steepest = steepest.max(over(down, across));
                across = (across + step_across).min(width.max(across));
            }
            if across >= width {
                break;
            }
        }
        steepest.max(over(down, across))
    };
    let angles = (0..places.len()).filter(|i| goes_down(*i)).map(|i| (angle(i), i));
    let (value, step) = angles.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(StepValue { value, step: u32::try_from(step).unwrap_or(u32::MAX) })
}
