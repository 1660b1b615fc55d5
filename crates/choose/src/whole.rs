//! Trials of the whole job: plan and proof of all that was chosen. Loads over a limit of a tool take smaller feeds and steps.

use crate::cutting_data::rounded;
use crate::text::ChosenOperation;
use base::progress::Progress;
use base::units::trim;
use ir::Program;

/// Largest number of trials.
pub(crate) const MAX_TRIALS: usize = 4;

/// Share of a limit that a corrected value aims at: another feed or step moves the places at which the tool is loaded.
const AIM: f64 = 0.95;

/// Least share of a step that one correction leaves.
const LEAST_CORRECTION: f64 = 0.6;

/// Load of an operation, as shares of the limits of its tool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Depth of a slot that loads the tool as much, over `max-depth`.
    pub depth: f64,
    /// Feed per tooth where the tool cuts, at any height over its tip, over `max-chip`.
    pub chip: f64,
}

/// What plan and proof of a whole job say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judgement {
    /// The first fault; `None` for a job that holds.
    pub fault: Option<String>,
    /// Loads of the operations in the order of the job; none without a motion.
    pub loads: Vec<Load>,
}

/// Plans and proves a program.
pub type Judge<'j> = dyn FnMut(&Program, &Progress) -> Judgement + 'j;

/// Lowers feeds and steps of operations whose loads are over a limit; false where nothing can be lowered. What the job fixes is kept:
/// `None` stands for an operation that is fixed as a whole.
pub(crate) fn corrected(operations: &mut [Option<&mut ChosenOperation>], loads: &[Load]) -> bool {
    let mut any = false;
    for (operation, load) in operations.iter_mut().zip(loads) {
        let Some(operation) = operation else { continue };
        let fixed = operation.fixed;
        if load.chip > 1.0 && !fixed.feed {
            let feed = rounded(operation.feed * AIM / load.chip);
            operation.why +=
                &format!("; feed {} mm/min was too much a tooth where the tool turns", trim(operation.feed, 2));
            operation.feed = feed;
            any = true;
        }
        if load.depth > 1.0
            && !(fixed.depth && fixed.stepover)
            && let Some(steps) = &mut operation.steps
        {
            let share = (AIM / load.depth).max(LEAST_CORRECTION);
            operation.why += &format!("; depth {} mm loaded the tool over its limit", trim(steps[0], 3));
            let lower = |step: f64, fixed: bool| if fixed { step } else { rounded(share * step) };
            *steps = [lower(steps[0], fixed.depth), lower(steps[1], fixed.stepover)];
            any = true;
        }
    }
    any
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::Fixed;

    fn operation(steps: Option<[f64; 2]>) -> ChosenOperation {
        let (keyword, why) = ("rough".to_owned(), "why".to_owned());
        ChosenOperation { keyword, speed: 18000.0, feed: 640.0, steps, why, ..ChosenOperation::default() }
    }

    #[test]
    fn what_is_over_a_limit_is_lowered_and_told() {
        let mut operations = [operation(Some([1.3, 1.6])), operation(None), operation(Some([1.0, 1.0]))];
        let load = |depth, chip| Load { depth, chip };
        let mut all: Vec<Option<&mut ChosenOperation>> = operations.iter_mut().map(Some).collect();
        assert!(corrected(&mut all, &[load(1.1, 0.9), load(1.5, 1.25), load(0.9, 1.0)]));
        let [first, second, third] = &operations;
        assert_eq!((first.feed, first.steps), (640.0, Some([1.1, 1.3])));
        assert_eq!((second.feed, second.steps), (480.0, None));
        assert_eq!((third.feed, third.steps, &third.why[..]), (640.0, Some([1.0, 1.0]), "why"));
        assert!(first.why.contains("depth 1.3 mm") && second.why.contains("feed 640 mm/min"));
        // Finishing has no step that would take less, and what the job fixes stays.
        let [_, finishing, roughing] = &mut operations;
        roughing.fixed = Fixed { feed: true, depth: true, stepover: false };
        assert!(!corrected(&mut [Some(finishing), None], &[load(1.5, 0.8), load(2.0, 2.0)]));
        assert!(corrected(&mut [Some(roughing)], &[load(1.5, 2.0)]));
        assert_eq!((roughing.feed, roughing.steps), (640.0, Some([1.0, 0.63])));
    }
}
