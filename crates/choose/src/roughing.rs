//! Roughing: tools of falling size, from the largest that enters the channel to the ball that finishes the floor, so that the
//! finishing tools find an even allowance.

use crate::Part;
use crate::candidates::Candidate;
use crate::cutting_data::{cutting_data, rounded};
use crate::sizes::Sizes;
use crate::text::{ChosenOperation, items};
use crate::trial::{Trials, Tried};
use base::units::trim;

/// Largest diameter of a roughing tool as a share of the width between the tips.
pub(crate) const TOP_SHARE: f64 = 0.75;

/// A tool is smaller than the one before it by at least this factor.
const FALL: f64 = 0.8;

/// Step down and distance of lines as shares of the diameter of a ball.
const STEPS: [f64; 2] = [0.33, 0.4];

/// Share of the largest depth of a tool that a step takes.
const DEPTH_SHARE: f64 = 0.9;

/// A later tool cuts where more than this share of its diameter stands, at most so much, mm: as the later tools of one `rough` do.
const REST_SHARE: f64 = 0.1;
const MAX_REST: f64 = 0.2;

/// Allowance as a share of the diameter of the ball that finishes the floor, with its least and largest value, mm.
const ALLOWANCE_SHARE: f64 = 0.1;
pub(crate) const ALLOWANCES: [f64; 2] = [0.05, 0.4];

/// Largest number of tools.
const MAX_TOOLS: usize = 4;

/// The roughing before an operation that finishes the floor with a tool: an operation for each tool, with cutting data of its own.
pub(crate) fn roughing(part: &Part<'_>, all: &[Candidate], last: &Candidate) -> Vec<ChosenOperation> {
    let allowance = allowance(&part.sizes, last);
    let tools = ladder(part, all, last);
    let count = tools.len();
    tools.into_iter().enumerate().map(|(k, tool)| operation(part, tool, [k, count], allowance)).collect()
}

/// The operations that find something to cut, in one sector: those between may have nothing left to do.
pub(crate) fn needed(
    mut roughing: Vec<ChosenOperation>,
    all: &[Candidate],
    trials: &mut Trials<'_, '_>,
) -> Vec<ChosenOperation> {
    let mut first = roughing.clone();
    first.iter_mut().for_each(|operation| operation.properties.push_str("  sectors 1"));
    let needless = trials.needless("rough in one sector", &items(&first, all));
    for k in needless.into_iter().rev() {
        let left_out = roughing.remove(k);
        trials.tried.push(Tried {
            what: format!("rough with {} after a larger ball", left_out.tool),
            fault: Some("left out: it finds nothing to cut".to_owned()),
        });
    }
    roughing
}

/// Stock that roughing leaves, mm: in a fillet a ball keeps it only where its radius is as much smaller than the fillet.
fn allowance(sizes: &Sizes, last: &Candidate) -> f64 {
    let room = sizes.fillet.map_or(f64::INFINITY, |fillet| fillet - last.ball);
    let [least, most] = ALLOWANCES;
    (2.0 * ALLOWANCE_SHARE * last.ball).clamp(least, most).min(room.max(least))
}

/// The roughing with one of several tools.
fn operation(part: &Part<'_>, tool: &Candidate, [k, count]: [usize; 2], allowance: f64) -> ChosenOperation {
    let diameter = 2.0 * tool.ball;
    let depth = rounded((STEPS[0] * diameter).min(DEPTH_SHARE * tool.tool.max_depth.get()));
    let stepover = rounded(STEPS[1] * diameter);
    let data = cutting_data(&tool.tool, part.material, part.spindle);
    let allowance = trim(allowance, 3);
    let rest = if k > 0 {
        format!("  rest over {} mm", trim((REST_SHARE * diameter).min(MAX_REST), 3))
    } else {
        String::new()
    };
    let lead = trim(part.lead, 1);
    let properties =
        format!("allowance vane {allowance} mm, hub {allowance} mm  lead-in {lead} mm  lead-out {lead} mm{rest}");
    let top = trim(part.sizes.top, 2);
    let why = match (k, k + 1 == count) {
        (0, true) => format!(
            "roughing with the ball that finishes the floor: no larger one enters between the tips, {top} mm apart"
        ),
        (0, false) => format!("roughing with the largest ball that enters between the tips, {top} mm apart"),
        (_, false) => "roughing where the larger ball does not go".to_owned(),
        (_, true) => "roughing with the ball that finishes the floor, so that it finds an even allowance".to_owned(),
    };
    ChosenOperation {
        keyword: "rough",
        tool: tool.name.clone(),
        speed: data.speed,
        feed: data.rough,
        steps: Some([depth, stepover]),
        properties,
        why,
    }
}

/// The tools, the largest first.
fn ladder<'a>(part: &Part<'_>, all: &'a [Candidate], last: &'a Candidate) -> Vec<&'a Candidate> {
    let mut tools: Vec<&Candidate> = Vec::new();
    let mut most = 0.5 * TOP_SHARE * part.sizes.top;
    while tools.len() + 1 < MAX_TOOLS {
        let fits = |c: &&Candidate| c.ball <= most && FALL * c.ball > last.ball && c.flute() >= part.sizes.height;
        let Some(best) = all.iter().find(fits) else { break };
        most = FALL * best.ball;
        tools.push(best);
    }
    tools.push(last);
    tools
}
