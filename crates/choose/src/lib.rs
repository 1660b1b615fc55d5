//! What the job leaves open: which tools of the library, operations, methods and cutting data make a part.
//!
//! What is chosen is text in the language, with the reason of each choice beside it: a person can read and edit it, and the
//! compiler takes it as any other job. Candidates follow from sizes of the part (`sizes`) in the order of their cost; a trial
//! plans each on the text that would be written, until one has free and smooth axes (`trial`).

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

mod candidates;
mod cutting_data;
mod finishing;
mod roughing;
mod sizes;
mod text;
mod trial;
mod whole;

pub use trial::{Tried, first_error};
pub use whole::{Judge, Judgement, Load};

use base::progress::Progress;
use base::units::trim;
use candidates::Candidate;
use diagnostics::{Aborted, Diag, Sink, codes::planning};
use ir::{ContractKind, Program};
use plan::budget;
use sizes::Sizes;
use std::fmt::Write;
use trial::Trials;
use wheel::contract::Guarded;
use wheel::material::Material;

/// From the text of a job to its program; faults go to the sink.
pub type Front<'f> = dyn FnMut(&str, &mut Sink) -> Result<Program, Aborted> + 'f;

/// A stock in the head of a job that stands for one that is chosen: it ends with a blank, and a material may follow. Its back
/// is below every part.
pub const STOCK: &str = "stock turned { over shroud 0 mm  bore 0 mm  back -5000 mm";

/// What is tried of a choice.
pub enum Effort<'e, 'j> {
    /// Nothing: sizes alone decide.
    Sizes,
    /// Tool axes of each operation of finishing, in one sector.
    Axes,
    /// Tool axes, then plan and proof of the whole job, which lowers feeds and steps with which a load is over the limit of a tool.
    Whole(&'e mut Judge<'j>),
}

/// What was chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// The whole job: its head, with a stock in the place of [`STOCK`], then tools, operations and the contracts that it does not state.
    pub job: String,
    /// The operations in a line each: kind, tools, why.
    pub summary: Vec<String>,
    /// Estimated memory of the compile, bytes.
    pub memory: f64,
    /// What was tried, in its order.
    pub tried: Vec<Tried>,
    /// What plan and proof of the job said, where they were wanted.
    pub judged: Option<Judgement>,
}

/// What the choice needs to know of a part and its job.
pub(crate) struct Part<'a> {
    pub(crate) wheel: &'a wheel::part::Part,
    pub(crate) sizes: Sizes,
    pub(crate) material: Material,
    /// Speeds of the spindle, rpm.
    pub(crate) spindle: [f64; 2],
    /// Largest excess, mm.
    pub(crate) excess: f64,
    /// Way before and behind passes, mm.
    pub(crate) lead: f64,
}

/// Contracts on gouge and excess of a wheel of up to this diameter; larger ones have more, as their size is more.
const LIMITS: [f64; 2] = [0.005, 0.02];
const LIMITS_UP_TO: f64 = 200.0;

/// Contract on the clearance, as a share of the diameter, and its largest value, mm.
const CLEARANCE_SHARE: f64 = 0.0075;
const MAX_CLEARANCE: f64 = 0.5;

/// Leads as a share of the diameter of the wheel, with their least and largest value, mm.
const LEAD_SHARE: f64 = 0.02;
const LEADS: [f64; 2] = [1.5, 6.0];

/// Chooses tools and operations for the job `head`, which has none, from tools of its libraries.
///
/// # Errors
/// The job has a fault, the run was cancelled, or no tool serves; the reasons are in the sink.
pub fn choose(
    head: &str,
    library: &[String],
    front: &mut Front<'_>,
    mut effort: Effort<'_, '_>,
    progress: &Progress,
    sink: &mut Sink,
) -> Result<Chosen, Aborted> {
    if library.is_empty() {
        let diag = Diag::error(planning::NO_TOOL, "the libraries of the job have no tools");
        sink.push(diag.help("write `use tools \"five-axis\"` for the tools that ship with the compiler"));
        return Err(Aborted);
    }
    let mut first = Sink::default();
    let program = front(&format!("{head}\n{}", text::all_tools(library)), &mut first);
    let program = program.inspect_err(|_| sink.append(first))?;
    let all = candidates::candidates(&program, library);
    let sizes = Sizes::of(&program);
    if sizes.fillet.is_none() && !states_excess(&program) {
        sink.push(sharp_feet(&sizes, &all));
        return Err(Aborted);
    }
    let (contracts, excess) = contracts(&program, &sizes);
    let part = Part {
        wheel: &program.part,
        material: program.stock.material.unwrap_or(Material::Aluminium),
        spindle: program.machine.spindle,
        excess,
        lead: (LEAD_SHARE * sizes.diameter).clamp(LEADS[0], LEADS[1]),
        sizes,
    };
    let head = head.replace(STOCK, &stock(&program, &sizes, part.lead));
    let assumed = matches!(effort, Effort::Sizes);
    let mut trials = Trials { head: format!("{head}\n{contracts}"), front, progress, assumed, tried: Vec::new() };
    let mut operations = finishing::finishing(&part, &all, &mut trials, sink)?;
    let floor = operations.iter().find(|operation| operation.keyword == "channel");
    let last = floor.and_then(|floor| all.iter().find(|candidate| floor.tool == candidate.name));
    if let Some(last) = last {
        operations.splice(0..0, roughing::needed(roughing::roughing(&part, &all, last), &all, &mut trials));
    }
    let (mut judged, mut trial) = (None, 0);
    let (job, memory) = loop {
        let job = format!("{head}\n{}\n{contracts}", text::items(&operations, &all));
        let mut faults = Sink::default();
        let program = (trials.front)(&job, &mut faults);
        let program = program.inspect_err(|_| sink.append(faults))?;
        let memory = budget::needed(&program);
        let Effort::Whole(judge) = &mut effort else { break (job, memory) };
        trial += 1;
        let Judgement { fault, loads } = judged.insert(judge(&program, progress));
        trials.tried.push(Tried { what: format!("the whole job, trial {trial}"), fault: fault.clone() });
        let ends = fault.is_none() || trial == whole::MAX_TRIALS || progress.is_cancelled();
        if ends || !whole::corrected(&mut operations, loads) {
            break (job, memory);
        }
    };
    let line = |o: &text::ChosenOperation| format!("{:<8} {:<32} {}", o.keyword, o.tool, o.why);
    let summary = operations.iter().map(line).collect();
    Ok(Chosen { job, summary, memory, tried: trials.tried, judged })
}

/// Way from the lowest place of the hub down to the back of the stock, where it is clamped, as a share of the diameter, and at least,
/// mm: room for shank and holder.
const BACK_SHARE: f64 = 0.1;
const LEAST_BACK: f64 = 3.0;

/// Diameters of the largest ball that enters between the tips which a channel needs below an outlet along the axis: a line of roughing
/// ends a diameter and a lead behind the part, and the ball has its own radius.
const BALLS_BELOW: f64 = 1.5;

/// Diameter of the clamping as a share of that of the wheel.
const CLAMPING_SHARE: f64 = 0.5;

/// The start of a stock about a part: solid, with its back below the hub, clamped below its back.
fn stock(program: &Program, sizes: &Sizes, lead: f64) -> String {
    let hub = &program.part.hub;
    let lowest = (0..=HUB_PLACES).map(|k| hub.point(k as f64 / HUB_PLACES as f64, 0.0).z).fold(f64::INFINITY, f64::min);
    // At a radial outlet the tool goes outward, not down.
    let outlet = hub.meridian(1.0).first.normalize();
    let ball = roughing::TOP_SHARE * sizes.top.min(sizes.diameter);
    let below = (-outlet.y).max(0.0) * (BALLS_BELOW * ball + lead);
    let back = trim((lowest - (BACK_SHARE * sizes.diameter).max(LEAST_BACK).max(below)).floor(), 0);
    let clamping = trim((CLAMPING_SHARE * sizes.diameter).ceil(), 0);
    format!(
        "stock turned {{ over shroud 0 mm  bore 0 mm  back {back} mm  clamping {{ below {back} mm  diameter {clamping} mm }}"
    )
}

/// True for a job that says itself how much material may stand.
fn states_excess(program: &Program) -> bool {
    program.contracts.iter().any(|contract| !contract.default && contract.kind == ContractKind::Excess)
        || program.allowed.iter().any(|allowed| allowed.kind == ContractKind::Excess)
}

/// Refuses blades whose feet are sharp, with the radius that a ball of the library mills.
fn sharp_feet(sizes: &Sizes, all: &[Candidate]) -> Diag {
    let most = (SHARE_OF_THROAT * sizes.throat).min(SHARE_OF_HEIGHT * sizes.height).min(sizes.concave);
    let fitting: Vec<&Candidate> = all.iter().filter(|c| c.is_straight() && c.flute() >= sizes.height).collect();
    let ball = fitting.iter().find(|c| c.ball <= most).or(fitting.last()).map(|c| c.ball);
    let diag = Diag::error(planning::NO_TOOL, "the blades meet the hub without a fillet: no tool mills a sharp foot");
    let Some(ball) = ball else {
        let reach =
            format!("no ball of the library has flutes of {} mm, the height of the blades", trim(sizes.height, 1));
        return diag.note(reach).help("add a ball to the library, and state a `fillet` in the vane");
    };
    let fillet = trim(((ball + roughing::ALLOWANCES[0]) * 10.0 - 1e-9).ceil() / 10.0, 1);
    diag.note(format!(
        "a ball leaves its radius in the corner of face and floor, so that `require excess` fails there; one of {} mm of radius enters",
        trim(ball, 2)
    ))
    .help(format!(
        "write `fillet {fillet} mm` in each vane and splitter of the part, or `--fillet {fillet}mm` beside blade files; or state what may stand \
         yourself, as `require excess <= 2 mm`"
    ))
}

/// Radius of a ball that finishes feet, as shares of the throat and of the height of the blades.
const SHARE_OF_THROAT: f64 = 0.2;
const SHARE_OF_HEIGHT: f64 = 0.2;

/// Places along the hub at which its height is measured.
const HUB_PLACES: usize = 100;

/// The contracts that a job does not state, and the largest excess that then holds, mm.
fn contracts(program: &Program, sizes: &Sizes) -> (String, f64) {
    let stated = |is: &dyn Fn(ContractKind) -> bool| {
        let of_kind = program.contracts.iter().filter(|contract| !contract.default && is(contract.kind));
        of_kind.map(|contract| contract.bound.value()).reduce(f64::min)
    };
    let scale = (sizes.diameter / LIMITS_UP_TO).max(1.0);
    let [gouge, excess] = LIMITS.map(|limit| cutting_data::rounded(1000.0 * scale * limit));
    let clearance = cutting_data::rounded((CLEARANCE_SHARE * sizes.diameter).min(MAX_CLEARANCE));
    let mut text = String::new();
    if stated(&|kind| kind == ContractKind::Gouge).is_none() {
        let _ = writeln!(text, "require gouge     <= {} um", trim(gouge, 1));
    }
    let stated_excess = stated(&|kind| kind == ContractKind::Excess);
    if stated_excess.is_none() {
        let _ = writeln!(text, "require excess    <= {} um", trim(excess, 1));
    }
    if stated(&|kind| matches!(kind, ContractKind::Clearance(Guarded::Body))).is_none() {
        let _ = writeln!(text, "require clearance >= {} mm", trim(clearance, 3));
    }
    (text, stated_excess.unwrap_or(excess / 1000.0))
}
