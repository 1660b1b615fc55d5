//! Finishing: for each kind of surface the largest ball that reaches all of it with free and smooth axes.

use crate::Part;
use crate::candidates::{Candidate, balls};
use crate::cutting_data::cutting_data;
use crate::roughing::ALLOWANCES;
use crate::text::{ChosenOperation, items};
use crate::trial::Trials;
use base::units::trim;
use diagnostics::{Aborted, Diag, Sink, codes::planning};
use wheel::method::AxisMethod;

/// Share of the excess that ridges may take; the rest is for chords and for what remains between lines and borders.
const SCALLOP_SHARE: f64 = 0.5;

/// The same on the floor, where ridges of two surfaces meet.
const FLOOR_SHARE: f64 = 0.4;

/// Methods in the order in which they are tried.
const METHODS: [AxisMethod; 2] = [AxisMethod::Corridor, AxisMethod::Blend];

/// Height of ridges of a trial with few lines, over that which is wanted: a third of the lines.
const FEW_LINES: f64 = 9.0;

/// A kind of finishing.
#[derive(Clone)]
struct Finish {
    keyword: &'static str,
    /// What it finishes, in its own properties.
    surfaces: String,
    /// The same in words.
    of: &'static str,
    /// Largest radius of a ball, mm.
    most: f64,
    /// Height of the ridges, mm.
    scallop: f64,
}

/// The kinds of finishing that a part needs: those with the narrowest choice of tools first.
fn kinds(part: &Part<'_>) -> Vec<Finish> {
    let sizes = &part.sizes;
    let open = 0.45 * sizes.throat;
    // The same ball roughs, and leaves an allowance in the fillet.
    let fillet = sizes.fillet.map_or(f64::INFINITY, |fillet| fillet - ALLOWANCES[0]);
    let most = fillet.min(open).min(sizes.concave);
    let [ridge, floor] = [SCALLOP_SHARE, FLOOR_SHARE].map(|share| share * part.excess);
    let kind = |keyword, surfaces: String, of, scallop| Finish { keyword, surfaces, of, most, scallop };
    let edges: Vec<&str> = ["inlet", "outlet"]
        .into_iter()
        .enumerate()
        .filter(|(end, _)| part.wheel.blade_ids().any(|blade| part.wheel.edge(blade, *end).is_some()))
        .map(|(_, word)| word)
        .collect();
    let mut kinds = Vec::new();
    if sizes.fillet.is_some() {
        kinds.push(kind("fillet", String::new(), "fillets", ridge));
    }
    kinds.push(kind("channel", String::new(), "floor of the channels", floor));
    kinds.push(kind("point", String::new(), "faces of the blades", ridge));
    if !edges.is_empty() {
        kinds.push(kind("edge", format!("edges {}  ", edges.join(", ")), "edges of the blades", ridge));
    }
    kinds
}

/// Operations in the order in which they are cut.
const ORDER: [&str; 4] = ["point", "edge", "fillet", "channel"];

/// Chooses the finishing of a part.
///
/// # Errors
/// A kind of surface that no tool of the library finishes; the reasons are in the sink.
pub(crate) fn finishing(
    part: &Part<'_>,
    all: &[Candidate],
    trials: &mut Trials<'_, '_>,
    sink: &mut Sink,
) -> Result<Vec<ChosenOperation>, Aborted> {
    let mut chosen: Vec<ChosenOperation> = Vec::new();
    for kind in kinds(part) {
        // A tool that is there already saves a change.
        let mut tools = balls(all, kind.most, part.sizes.height);
        // `channel` takes no tapered ball.
        tools.retain(|tool| kind.keyword != "channel" || tool.is_straight());
        tools.sort_by_key(|tool| !chosen.iter().any(|operation| operation.tool == tool.name));
        let mut failed = false;
        let found = tools.iter().find_map(|tool| {
            METHODS.into_iter().find_map(|method| {
                if trials.progress.is_cancelled() {
                    return None;
                }
                let operation = operation(part, &kind, tool, method);
                let what = format!("{} with {}, {}", kind.keyword, tool.name, method.name());
                let mut has_axes = |scallop: f64, what: &str| {
                    let mut first = self::operation(part, &Finish { scallop, ..kind.clone() }, tool, method);
                    first.properties.push_str("  sectors 1");
                    trials.have_axes(what, &items(&[first], all))
                };
                // What fails with few lines fails with all of them, and sooner.
                let few = !failed || has_axes(FEW_LINES * kind.scallop, &format!("{what}, few lines"));
                let holds = few && has_axes(kind.scallop, &what);
                failed |= !holds;
                holds.then_some(operation)
            })
        });
        let Some(operation) = found else {
            sink.push(none_finishes(&kind, &tools, trials));
            return Err(Aborted);
        };
        chosen.push(operation);
    }
    chosen.sort_by_key(|operation| ORDER.iter().position(|keyword| *keyword == operation.keyword));
    Ok(chosen)
}

fn operation(part: &Part<'_>, kind: &Finish, tool: &Candidate, method: AxisMethod) -> ChosenOperation {
    let data = cutting_data(&tool.tool, part.material, part.spindle);
    let lead = trim(part.lead, 1);
    let properties = format!(
        "{}scallop {} um  method {}\n  lead-in {lead} mm  lead-out {lead} mm",
        kind.surfaces,
        trim(1000.0 * kind.scallop, 1),
        method.name(),
    );
    let [radius, most] = [tool.ball, kind.most].map(|radius| trim(radius, 2));
    let why = format!(
        "{} with a ball of {radius} mm of radius, of at most {most} mm that fit: the largest that has free and smooth axes",
        kind.of
    );
    ChosenOperation {
        keyword: kind.keyword,
        tool: tool.name.clone(),
        speed: data.speed,
        feed: data.finish,
        steps: None,
        properties,
        why,
    }
}

fn none_finishes(kind: &Finish, tools: &[&Candidate], trials: &Trials<'_, '_>) -> Diag {
    let message = format!("no tool of the library finishes the {}", kind.of);
    let mut diag = Diag::error(planning::NO_TOOL, message);
    if tools.is_empty() {
        diag = diag.note(format!(
            "a ball of at most {} mm of radius with flutes as long as the channel is deep is needed; the library has none",
            trim(kind.most, 2)
        ));
    }
    for tried in trials.tried.iter().filter(|tried| tried.what.starts_with(kind.keyword)) {
        if let Some(fault) = &tried.fault {
            diag = diag.note(format!("{}: {fault}", tried.what));
        }
    }
    diag.help("add a smaller ball to the library, or plan this surface by hand")
}
