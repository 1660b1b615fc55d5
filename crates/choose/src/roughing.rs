//! Roughing: tools of falling size, from the largest that enters the channel to the ball that finishes the floor, so that the
//! finishing tools find an even allowance.

use crate::Part;
use crate::candidates::Candidate;
use crate::cutting_data::{cutting_data, rounded};
use crate::sizes::Sizes;
use crate::text::{ChosenOperation, items, named};
use crate::trial::{Trials, Tried};
use base::units::trim;

/// Largest diameter of a roughing tool as a share of the width between the tips.
pub(crate) const TOP_SHARE: f64 = 0.75;

/// A tool is smaller than the one before it by at least this factor.
const FALL: f64 = 0.8;

/// Step down and distance of lines as shares of the diameter of a ball.
const STEPS: [f64; 2] = [0.33, 0.4];

/// The same for a tool with a flat end, as the defaults of `rough` have them.
const FLAT_STEPS: [f64; 2] = [0.375, 0.75];

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
pub(crate) fn roughing(part: &Part<'_>, all: &[Candidate], last: usize) -> Vec<ChosenOperation> {
    with(part, all, &ladder(part, all, last), &all[last])
}

/// Roughing with these tools, the largest first, before a ball that finishes the floor.
pub(crate) fn with(part: &Part<'_>, all: &[Candidate], tools: &[usize], last: &Candidate) -> Vec<ChosenOperation> {
    let allowance = allowance(&part.sizes, last);
    let of = |(k, tool): (usize, &usize)| ChosenOperation {
        tool: *tool,
        ..operation(part, &all[*tool], [k, tools.len()], allowance)
    };
    tools.iter().enumerate().map(of).collect()
}

/// The operations that find something to cut, in one sector: those between may have nothing left to do.
pub(crate) fn needed(
    mut roughing: Vec<ChosenOperation>,
    all: &[Candidate],
    trials: &mut Trials<'_, '_>,
) -> Vec<ChosenOperation> {
    let mut first = roughing.clone();
    first.iter_mut().for_each(|operation| operation.properties.push(("sectors", "1".to_owned())));
    let (names, declarations) = named(&first, all, &trials.taken);
    let needless = trials.needless("rough in one sector", &format!("{declarations}{}", items(&first, &names)));
    for k in needless.into_iter().rev() {
        let left_out = roughing.remove(k);
        trials.tried.push(Tried {
            what: format!("rough with {} after a larger ball", all[left_out.tool].name),
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
    let diameter = 2.0 * if tool.is_ball() { tool.ball } else { tool.tool.solid.cutter.nominal_radius() };
    let [down, across] = if tool.is_ball() { STEPS } else { FLAT_STEPS };
    let depth = rounded((down * diameter).min(DEPTH_SHARE * tool.tool.max_depth.get()));
    let stepover = rounded(across * diameter);
    let data = cutting_data(&tool.tool, part.material, part.spindle);
    let allowance = trim(allowance, 3);
    let lead = format!("{} mm", trim(part.lead, 1));
    let mut properties = vec![
        ("allowance", format!("vane {allowance} mm, hub {allowance} mm")),
        ("lead-in", lead.clone()),
        ("lead-out", lead),
    ];
    if k > 0 {
        properties.push(("rest", format!("over {} mm", trim((REST_SHARE * diameter).min(MAX_REST), 3))));
    }
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
        keyword: "rough".to_owned(),
        speed: data.speed,
        feed: data.rough,
        steps: Some([depth, stepover]),
        properties,
        why,
        ..ChosenOperation::default()
    }
}

/// The tools, the largest first.
pub(crate) fn ladder(part: &Part<'_>, all: &[Candidate], last: usize) -> Vec<usize> {
    let mut tools = Vec::new();
    let mut most = 0.5 * TOP_SHARE * part.sizes.top;
    while tools.len() + 1 < MAX_TOOLS {
        let fits = |k: &usize| {
            let c = &all[*k];
            c.is_ball() && c.ball <= most && FALL * c.ball > all[last].ball && c.flute() >= part.sizes.height
        };
        let Some(best) = (0..all.len()).find(fits) else { break };
        most = FALL * all[best].ball;
        tools.push(best);
    }
    tools.push(last);
    tools
}
