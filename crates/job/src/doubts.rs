//! Warnings about jobs that are valid, but hardly what their authors mean.

use crate::model::{ContractSpec, OperationSpec, StockSpec, ToolSpec};
use base::units::{Mm, length, trim};
use diagnostics::codes::job as codes;
use diagnostics::{Diag, Sink};
use wheel::contract::ContractKind;
use wheel::method::Slots;
use wheel::operation::{OperationKind, RoughingStrategy};

/// Longest usual stick-out, in diameters of the cutter or of the shank, whichever is wider.
const MAX_STICK_OUT: f64 = 30.0;

/// Largest usual gouge, mm: a tenth of the thickness of the thinnest usual vanes.
const MAX_GOUGE_MM: f64 = 0.2;

/// Largest usual excess after finishing, mm: more is left by roughing.
const LARGEST_EXCESS: f64 = 2.0;

/// Largest usual rest of roughing, mm: more is not roughed.
const LARGEST_REST: f64 = 10.0;

/// Largest usual deviation of the tool axis, deg.
const MAX_USUAL_ERROR_DEG: f64 = 5.0;

/// Longest usual machining time, s: 1000 h.
const LONGEST_TIME: f64 = 3.6e6;

/// Largest usual removal rate, mm3/min: 2 l/min, what large machines take of aluminium.
const LARGEST_RATE: f64 = 2e6;

/// Largest usual volume beside the part, mm3: a litre.
const LARGEST_VOLUME: f64 = 1e6;

/// Least usual clearance, mm: machines and set-ups are not more exact.
const CLOSEST: f64 = 0.02;

/// Deepest usual slot, in diameters of the cutter: makers of solid end mills permit one, some of them up to two.
const DEEPEST_SLOT: f64 = 3.0;

/// What a job without errors states.
pub(super) struct Stated<'a> {
    pub(super) stock: Option<&'a StockSpec>,
    /// The tools that operations use.
    pub(super) tools: &'a [&'a ToolSpec],
    /// All tools in their order.
    pub(super) all_tools: &'a [Option<&'a ToolSpec>],
    pub(super) operations: &'a [OperationSpec],
    pub(super) contracts: &'a [ContractSpec],
    /// Tolerance of finishing.
    pub(super) chord: Mm,
}

fn warning(message: String) -> Diag {
    Diag::warning(codes::DOUBTFUL, message)
}

/// Reports what is hardly meant.
pub(super) fn warn(stated: &Stated<'_>, sink: &mut Sink) {
    before_roughing(stated, sink);
    for tool in stated.tools {
        stick_out(tool, sink);
        without_holder(tool, sink);
        deep_limit(tool, sink);
    }
    for operation in stated.operations {
        too_deep(operation, stated, sink);
    }
    for contract in stated.contracts.iter().filter(|c| !c.default) {
        bound(contract, stated.chord, sink);
    }
}

fn roughs(operation: &OperationSpec) -> bool {
    operation.kind.roughing().is_some()
}

/// A finishing operation in full material.
fn before_roughing(stated: &Stated<'_>, sink: &mut Sink) {
    let first = stated.operations.first().filter(|o| !roughs(o));
    let Some(first) = first.filter(|_| stated.stock.is_none_or(|stock| stock.left.is_none())) else { return };
    let diag = warning(format!("{} finishes in full material: nothing roughs the channels before it", first.name))
        .label(first.span, "the first operation of the job");
    sink.push(match stated.operations.iter().find(|o| roughs(o)) {
        Some(later) => diag.label(later.span, "roughs what is finished already").help(format!(
            "move `{}` before `{}`: operations run in the order of the job",
            later.name, first.name
        )),
        None => diag.help(
            "add `operation rough { ... }` before it, or state what an earlier program left of the blank: `from \"left.stl\"` of the stock",
        ),
    });
}

/// Depth of the slots of an operation that opens channels at full width.
fn slot_depth(kind: &OperationKind) -> Option<Mm> {
    match kind.strategy()? {
        RoughingStrategy::Groove { depth } | RoughingStrategy::Rough { depth, slots: Slots::Full, .. } => Some(depth),
        RoughingStrategy::Rough { .. } | RoughingStrategy::Expand { .. } | RoughingStrategy::Plunge { .. } => None,
    }
}

/// A depth of cut at full width over the limit that the job or the library states for the tool.
fn too_deep(operation: &OperationSpec, stated: &Stated<'_>, sink: &mut Sink) {
    let Some(depth) = slot_depth(&operation.kind) else { return };
    let tool = stated.all_tools.get(operation.tool).copied().flatten();
    let Some((tool, limit)) = tool.and_then(|tool| Some((tool, tool.limits.depth?))) else { return };
    if depth.get() > limit.get() {
        sink.push(
            warning(format!("{} steps down by {depth}; the limit of {} is {limit}", operation.name, tool.name))
                .label(operation.span, format!("`depth` of {depth}"))
                .label(tool.span, "`max-depth` of this tool")
                .help(format!(
                    "write `depth {limit}` or less: where the cut is a slot, the job is refused after planning"
                )),
        );
    }
}

/// A limit of the depth that hardly forbids anything.
fn deep_limit(tool: &ToolSpec, sink: &mut Sink) {
    let Some(limit) = tool.limits.depth else { return };
    let (flute, usual) = (tool.flute.get(), DEEPEST_SLOT * tool.diameter.get());
    let why = if limit.get() > flute {
        format!("{} has flutes of {}: no cut is deeper", tool.name, tool.flute)
    } else if limit.get() > usual {
        format!(
            "{} diameters: makers of tools permit one or two at full width",
            trim(limit.get() / tool.diameter.get(), 1)
        )
    } else {
        return;
    };
    let most = Mm(usual.min(flute));
    sink.push(
        warning(format!("a slot of {} {limit} deep is allowed", tool.name))
            .label(tool.span, "`max-depth` of this tool hardly forbids anything")
            .note(why)
            .help(format!("write the depth that the maker of the tool states, at most `max-depth {most}`; without it the limit follows from diameter and stick-out")),
    );
}

fn stick_out(tool: &ToolSpec, sink: &mut Sink) {
    let widest = tool.diameter.get().max(tool.shank.get());
    let ratio = tool.reach.get() / widest;
    if ratio > MAX_STICK_OUT {
        sink.push(
            warning(format!("{} sticks out by {} diameters", tool.name, trim(ratio, 0)))
                .label(tool.span, format!("`reach` of {} with a diameter of {}", tool.reach, Mm(widest)))
                .help("compare `reach` with the tool: it is the length from the tip to the holder; a wider `shank` makes the tool stiff"),
        );
    }
}

fn without_holder(tool: &ToolSpec, sink: &mut Sink) {
    if tool.holder.is_none() {
        sink.push(
            warning(format!("{} has no holder: nothing above its reach is checked for collisions, and its length is that of no real tool", tool.name))
                .label(tool.span, "no `holder`")
                .help(
                    "add `holder \"er16-mini\"`, or the name of another holder; `impellerc tools carbide` shows them",
                ),
        );
    }
}

fn bound(contract: &ContractSpec, chord: Mm, sink: &mut Sink) {
    let bound = contract.bound.value();
    match contract.kind {
        ContractKind::Gouge if bound > MAX_GOUGE_MM => sink.push(
            warning(format!("a gouge of {} is allowed", length(bound)))
                .label(contract.span, "this contract hardly forbids anything")
                .help(format!(
                    "write `gouge <= {} um`, or a bound of at most {}",
                    trim(bound, 3),
                    length(MAX_GOUGE_MM)
                )),
        ),
        ContractKind::Gouge if chord.get() > bound => sink.push(
            warning(format!("the tolerance `chord` of {chord} is larger than the gouge that a contract allows"))
                .label(contract.span, format!("{} are allowed", length(bound)))
                .help("use a smaller `tolerance chord`, such as a fifth of the bound"),
        ),
        ContractKind::Clearance(_) if bound < CLOSEST => sink.push(
            warning(format!("a clearance of {} is enough", length(bound)))
                .label(contract.span, "no machine and no set-up is so exact")
                .help("write a bound of at least 0.1 mm, such as `clearance >= 0.5 mm`"),
        ),
        kind => loose(contract, kind, sink),
    }
}

/// A bound of another quantity that hardly forbids anything.
fn loose(contract: &ContractSpec, kind: ContractKind, sink: &mut Sink) {
    let value = contract.bound.value();
    let (over, than) = match kind {
        ContractKind::Excess => (value > LARGEST_EXCESS, format!("`excess <= {LARGEST_EXCESS} mm`")),
        ContractKind::Rest => (value > LARGEST_REST, format!("`rest <= {LARGEST_REST} mm`")),
        ContractKind::ContourError => {
            (value > MAX_GOUGE_MM, format!("`contour-error <= {} um`", trim(MAX_GOUGE_MM * 1e3, 0)))
        }
        ContractKind::OrientationError => {
            (value > MAX_USUAL_ERROR_DEG, format!("`orientation-error <= {MAX_USUAL_ERROR_DEG} deg`"))
        }
        // A cutter has an arc of 180 deg in a slot, and never more.
        ContractKind::Engagement(_) => (value >= 180.0, "an arc below 180 deg".to_owned()),
        // Above it, an axis is refused without a contract.
        ContractKind::AxisSpeed => (value >= 1.0, "a share below 100 %".to_owned()),
        ContractKind::Air => (value >= 1.0, "a share below 100 %".to_owned()),
        // A deeper slot is refused without a contract.
        ContractKind::Slot => (value >= 1.0, "a share below 100 % of the diameter".to_owned()),
        ContractKind::RemovalRate => (value > LARGEST_RATE, "a rate of at most 2000 cm3/min".to_owned()),
        ContractKind::RestVolume => (value > LARGEST_VOLUME, "a volume of at most 1000 cm3".to_owned()),
        ContractKind::Time => (value > LONGEST_TIME, "a time of at most 1000 h".to_owned()),
        _ => (false, String::new()),
    };
    if over {
        let bound = contract.bound.figure();
        sink.push(
            warning(format!("{} of {bound} is allowed", kind.name()))
                .label(contract.span, "this contract hardly forbids anything")
                .help(format!("write {than}, or less")),
        );
    }
}
