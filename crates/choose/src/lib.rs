//! What the job leaves open: which tools of the library, operations, methods and cutting data make a part.
//!
//! What is chosen is text in the language, with the reason of each choice beside it: a person can read and edit it, and the
//! compiler takes it as any other job. Candidates follow from sizes of the part (`sizes`) in the order of their cost; a trial
//! plans each on the text that would be written, until one has free and smooth axes (`trial`).

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

mod candidates;
mod covered;
mod cutting_data;
mod finishing;
mod open;
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
use covered::Covered;
use diagnostics::{Aborted, Diag, Sink, codes::job, codes::planning};
use ir::{ContractKind, Program};
use open::{OpenJob, OpenOperation, Opening};
use plan::budget;
use sizes::Sizes;
use syntax::ast::File;
use text::{ChosenOperation, Fixed};
use trial::{Depth, Trials};
use wheel::contract::Guarded;
use wheel::material::Material;
use wheel::operation::OperationKind;

/// From the text of a job to its program; faults go to the sink.
pub type Front<'f> = dyn FnMut(&str, &mut Sink) -> Result<Program, Aborted> + 'f;

/// A stock in the head of a job that stands for one that is chosen: it ends with a blank, and a material may follow. Its back
/// is below every part.
pub const STOCK: &str = "stock turned { over shroud 0 mm  bore 0 mm  back -5000 mm";

/// What is tried of a choice.
pub enum Effort<'e, 'j> {
    /// Nothing: sizes alone decide.
    Sizes,
    /// Facts about part and tools, as a check finds them.
    Facts,
    /// Tool axes of each operation of finishing, in one sector.
    Axes,
    /// Tool axes, then plan and proof of the whole job, which lowers feeds and steps with which a load is over the limit of a tool.
    Whole(&'e mut Judge<'j>),
}

/// What was chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// The whole job: what was chosen in the open places, with a stock in the place of [`STOCK`], and behind all the contracts that it
    /// does not state.
    pub job: String,
    /// The operations that were chosen in a line each: kind, tool, why.
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

/// A job that leaves something open, and the tools of its libraries.
#[derive(Clone, Copy)]
pub struct OpenText<'a> {
    /// Its text.
    pub text: &'a str,
    /// The same, read.
    pub ast: &'a File,
    /// Names of the tools of its libraries.
    pub library: &'a [String],
}

/// Chooses what a job leaves open, from its tools and those of its libraries.
///
/// # Errors
/// The job has a fault, the run was cancelled, or no tool serves; the reasons are in the sink.
pub fn choose(
    given: OpenText<'_>,
    front: &mut Front<'_>,
    mut effort: Effort<'_, '_>,
    progress: &Progress,
    sink: &mut Sink,
) -> Result<Chosen, Aborted> {
    let open = OpenJob { text: given.text, ast: given.ast };
    let (program, all, covered) = read(&open, given.library, front, sink)?;
    let sizes = Sizes::of(&program);
    let finishes = open.openings().iter().any(|opening| matches!(opening, Opening::Operations(_)));
    if finishes && sizes.fillet.is_none() && !states_excess(&program) {
        sink.push(sharp_feet(&sizes, &all));
        return Err(Aborted);
    }
    let (added, excess) = contracts(&program, &sizes);
    let lines = |is: &dyn Fn(ContractKind) -> bool| -> String {
        added.iter().filter(|(kind, _)| is(*kind)).map(|(_, line)| format!("{line}\n")).collect()
    };
    let contracts = lines(&|_| true);
    let part = Part {
        wheel: &program.part,
        material: program.stock.material.unwrap_or(Material::Aluminium),
        spindle: program.machine.spindle,
        excess,
        lead: (LEAD_SHARE * sizes.diameter).clamp(LEADS[0], LEADS[1]),
        sizes,
    };
    let stock = stock(&program, &sizes, part.lead);
    let whole = |text: String| format!("{}\n{contracts}", text.replace(STOCK, &stock));
    let depth = match effort {
        Effort::Sizes => Depth::Sizes,
        Effort::Facts => Depth::Facts,
        Effort::Axes | Effort::Whole(_) => Depth::Axes,
    };
    let taken: Vec<&str> = open.declared().into_iter().map(|(name, _)| name).collect();
    let of_trials = lines(&|kind| kind != ContractKind::Excess);
    let head = format!("{}\n{of_trials}", open.without_operations().replace(STOCK, &stock));
    let mut trials = Trials { job: open.text, head, taken, front, progress, depth, tried: Vec::new() };
    let mut chosen = Vec::new();
    for opening in open.openings() {
        let operations = match &opening {
            Opening::Operations(_) => missing(&part, &program, &covered, &all, &mut trials, sink)?,
            Opening::Operation(open) => of_operation(&part, open, &all, &mut trials, sink)?,
        };
        chosen.push((opening, operations));
    }
    let (mut judged, mut trial) = (None, 0);
    let (job, memory) = loop {
        let (names, declarations) =
            text::named(chosen.iter().flat_map(|(_, operations)| operations), &all, &trials.taken);
        let job = whole(open.with(&declarations, &chosen, &names));
        let mut faults = Sink::default();
        let program = (trials.front)(&job, &mut faults);
        let program = program.inspect_err(|_| sink.append(faults))?;
        let memory = budget::needed(&program);
        let Effort::Whole(judge) = &mut effort else { break (job, memory) };
        trial += 1;
        let Judgement { fault, loads } = judged.insert(judge(&program, progress));
        trials.tried.push(Tried { what: format!("the whole job, trial {trial}"), fault: fault.clone() });
        let ends = fault.is_none() || trial == whole::MAX_TRIALS || progress.is_cancelled();
        if ends || !whole::corrected(&mut in_order(&open.order(), &mut chosen), loads) {
            break (job, memory);
        }
    };
    let line = |o: &ChosenOperation| format!("{:<8} {:<32} {}", o.keyword, all[o.tool].name, o.why);
    let summary = chosen.iter().flat_map(|(_, operations)| operations).map(line).collect();
    Ok(Chosen { job, summary, memory, tried: trials.tried, judged })
}

/// The part of a job with open places, the tools that it may take, and what its operations do.
fn read(
    open: &OpenJob<'_>,
    library: &[String],
    front: &mut Front<'_>,
    sink: &mut Sink,
) -> Result<(Program, Vec<Candidate>, Covered), Aborted> {
    let refused = |diag: Diag, sink: &mut Sink| {
        sink.push(diag);
        Err(Aborted)
    };
    let declared = open.declared();
    if library.is_empty() && declared.is_empty() {
        let diag = Diag::error(planning::NO_TOOL, "the libraries of the job have no tools");
        return refused(diag.help("write `use tools \"five-axis\"` for the tools that ship with the compiler"), sink);
    }
    if let Some(diag) = open.takes_all_tools() {
        return refused(diag, sink);
    }
    // One that the job declares is not taken twice.
    let others = library.iter().filter(|name| !declared.iter().any(|(_, library)| library == &Some(name.as_str())));
    let stem = open.free_name("library_tool");
    let others: Vec<(String, &str)> =
        others.enumerate().map(|(k, name)| (format!("{stem}_{k}"), name.as_str())).collect();
    let [placeholder, operation] = ["placeholder_tool", "placeholder"].map(|stem| open.free_name(stem));
    let mut faults = Sink::default();
    let program = front(&open.readable(&others, &placeholder, &operation), &mut faults);
    let program = program.inspect_err(|_| sink.append(faults))?;
    let named = |name: &str| {
        let of_library = others.iter().find(|(given, _)| given == name).map(|(_, tool)| ((*tool).to_owned(), false));
        of_library.or_else(|| (name != placeholder).then(|| (name.to_owned(), true)))
    };
    let all = candidates::candidates(&program, &named);
    let covered = Covered::of(&program, &operation);
    Ok((program, all, covered))
}

/// What `operations auto` stands for: what no operation of the job does.
fn missing(
    part: &Part<'_>,
    program: &Program,
    covered: &Covered,
    all: &[Candidate],
    trials: &mut Trials<'_, '_>,
    sink: &mut Sink,
) -> Result<Vec<ChosenOperation>, Aborted> {
    let mut operations = finishing::finishing(part, covered, all, trials, sink)?;
    if covered.roughing {
        return Ok(operations);
    }
    // Roughing ends with the ball that finishes the floor.
    let floor = operations.iter().find(|operation| operation.keyword == "channel").map(|operation| operation.tool);
    if let Some(last) = floor.or_else(|| of_floor(program, all)) {
        operations.splice(0..0, roughing::needed(roughing::roughing(part, all, last), all, trials));
    }
    Ok(operations)
}

/// The ball with which the job finishes the floor.
fn of_floor(program: &Program, all: &[Candidate]) -> Option<usize> {
    let finishes =
        |operation: &&ir::Operation| matches!(operation.kind, OperationKind::Channel { allowance_vane: None, .. });
    let floors = program.operations.iter().map(|(_, operation)| operation).filter(finishes);
    let places =
        floors.filter_map(|floor| all.iter().position(|candidate| candidate.declared && candidate.id == floor.tool));
    places.filter(|place| all[*place].is_ball()).last()
}

/// Properties that are chosen for operations of every kind.
const FOR_ALL: [&str; 5] = ["speed", "feed", "link-feed", "lead-in", "lead-out"];

/// What is chosen for an operation that leaves values open: one for each of its tools.
fn of_operation(
    part: &Part<'_>,
    open: &OpenOperation<'_>,
    all: &[Candidate],
    trials: &mut Trials<'_, '_>,
    sink: &mut Sink,
) -> Result<Vec<ChosenOperation>, Aborted> {
    let keyword = open.kind.text.as_str();
    let finishes = finishing::KINDS.iter().any(|(kind, _)| *kind == keyword);
    let more: &[&str] = match keyword {
        "rough" => &["tools", "depth", "stepover", "allowance"],
        _ if finishes => &["tool", "scallop", "method"],
        _ => &[],
    };
    if let Some(entry) = open.left_beyond(&[&FOR_ALL[..], more].concat()) {
        let known = [more, &FOR_ALL[..]].concat().join(", ");
        sink.push(
            Diag::error(job::WRONG_FORM, format!("`{} auto` of `{keyword}` is not chosen", entry.name.text))
                .label(entry.span, "give a value")
                .help(format!("of `{keyword}`, `auto` may stand for {known}")),
        );
        return Err(Aborted);
    }
    let place = |name: &String| all.iter().position(|candidate| candidate.declared && candidate.name == *name);
    let fixed: Vec<usize> = open.tools().iter().filter_map(place).collect();
    let keeps = Fixed { feed: !open.leaves("feed"), depth: !open.leaves("depth"), stepover: !open.leaves("stepover") };
    let mut operations = match keyword {
        "rough" if fixed.is_empty() => {
            let most = part.sizes.fillet.map_or(f64::INFINITY, |fillet| fillet - roughing::ALLOWANCES[0]);
            let finest = all
                .iter()
                .position(|candidate| candidate.is_ball() && candidate.is_straight() && candidate.ball <= most);
            finest.map_or_else(Vec::new, |last| roughing::roughing(part, all, last))
        }
        _ if finishes && fixed.len() < 2 => {
            vec![finishing::of_open(part, open, fixed.first().copied(), all, trials, sink)?]
        }
        _ => {
            let last = fixed.last().map(|last| &all[*last]);
            last.map_or_else(Vec::new, |last| roughing::with(part, all, &fixed, last))
        }
    };
    if operations.is_empty() {
        sink.push(
            Diag::error(planning::NO_TOOL, format!("no tool of the library serves `{keyword}`"))
                .label(open.kind.span, "this operation")
                .help("name a tool that the job declares"),
        );
        return Err(Aborted);
    }
    for operation in &mut operations {
        operation.keyword = keyword.to_owned();
        operation.fixed = keeps;
        if !fixed.is_empty() {
            operation.why = format!("chosen for what the job fixes of this operation: {}", open.left().join(", "));
        }
    }
    Ok(operations)
}

/// What was chosen in the order of the operations of a program; `None` for an operation that the job has. `order` is that of the job.
fn in_order<'c>(
    order: &[bool],
    chosen: &'c mut [(Opening<'_>, Vec<ChosenOperation>)],
) -> Vec<Option<&'c mut ChosenOperation>> {
    let mut openings = chosen.iter_mut();
    let mut all = Vec::new();
    for is_open in order {
        if *is_open {
            all.extend(openings.next().into_iter().flat_map(|(_, operations)| operations.iter_mut().map(Some)));
        } else {
            all.push(None);
        }
    }
    all
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
    let serves = |c: &&Candidate| c.is_ball() && c.is_straight() && c.flute() >= sizes.height;
    let fitting: Vec<&Candidate> = all.iter().filter(serves).collect();
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

/// The contracts that a job does not state, in a line each, and the largest excess that then holds, mm.
fn contracts(program: &Program, sizes: &Sizes) -> (Vec<(ContractKind, String)>, f64) {
    let stated = |kind: ContractKind| {
        let of_kind = program.contracts.iter().filter(|contract| !contract.default && contract.kind == kind);
        of_kind.map(|contract| contract.bound.value()).reduce(f64::min)
    };
    let scale = (sizes.diameter / LIMITS_UP_TO).max(1.0);
    let [gouge, excess] = LIMITS.map(|limit| cutting_data::rounded(1000.0 * scale * limit));
    let clearance = cutting_data::rounded((CLEARANCE_SHARE * sizes.diameter).min(MAX_CLEARANCE));
    let lines = [
        (ContractKind::Gouge, format!("require gouge     <= {} um", trim(gouge, 1))),
        (ContractKind::Excess, format!("require excess    <= {} um", trim(excess, 1))),
        (ContractKind::Clearance(Guarded::Body), format!("require clearance >= {} mm", trim(clearance, 3))),
    ];
    let added = lines.into_iter().filter(|(kind, _)| stated(*kind).is_none()).collect();
    (added, stated(ContractKind::Excess).unwrap_or(excess / 1000.0))
}
