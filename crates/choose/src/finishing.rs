//! Finishing: for each kind of surface the largest ball that reaches all of it with free and smooth axes.

use crate::Part;
use crate::candidates::{Candidate, LEAST_SHARE, balls};
use crate::covered::Covered;
use crate::cutting_data::cutting_data;
use crate::open::OpenOperation;
use crate::roughing::ALLOWANCES;
use crate::text::{ChosenOperation, items, named};
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

/// Balls of at least this share of the largest one are tried with all methods before smaller ones: a smaller ball takes more lines.
const LARGE_SHARE: f64 = 0.6;

/// A kind of finishing.
#[derive(Clone)]
struct Finish {
    keyword: String,
    /// What it finishes, in its own properties.
    surfaces: Vec<(&'static str, String)>,
    /// The same in words.
    of: &'static str,
    /// Largest radius of a ball, mm.
    most: f64,
    /// Height of the ridges, mm.
    scallop: f64,
}

/// Kinds of finishing, those with the narrowest choice of tools first: their keyword, and what they finish in words.
pub(crate) const KINDS: [(&str, &str); 5] = [
    ("fillet", "fillets"),
    ("channel", "floor of the channels"),
    ("point", "faces of the blades"),
    ("edge", "edges of the blades"),
    ("tip", "tips of the blades"),
];

impl Finish {
    /// A kind of finishing of a part; `None` for one that is not chosen.
    fn new(part: &Part<'_>, keyword: &str, surfaces: Vec<(&'static str, String)>) -> Option<Self> {
        let (_, of) = KINDS.into_iter().find(|(kind, _)| *kind == keyword)?;
        let open = 0.45 * part.sizes.throat;
        // The same ball roughs, and leaves an allowance in the fillet.
        let fillet = part.sizes.fillet.map_or(f64::INFINITY, |fillet| fillet - ALLOWANCES[0]);
        let most = fillet.min(open).min(part.sizes.concave);
        let scallop = part.excess * if keyword == "channel" { FLOOR_SHARE } else { SCALLOP_SHARE };
        Some(Self { keyword: keyword.to_owned(), surfaces, of, most, scallop })
    }
}

/// Operations in the order in which they are cut.
const ORDER: [&str; 4] = ["point", "edge", "fillet", "channel"];

/// What `operations auto` chooses of finishing: what no operation of the job does.
///
/// # Errors
/// A kind of surface that no tool finishes; the reasons are in the sink.
pub(crate) fn finishing(
    part: &Part<'_>,
    covered: &Covered,
    all: &[Candidate],
    trials: &mut Trials<'_, '_>,
    sink: &mut Sink,
) -> Result<Vec<ChosenOperation>, Aborted> {
    let mut chosen: Vec<ChosenOperation> = Vec::new();
    let taken = trials.taken.clone();
    for (keyword, _) in KINDS {
        for surfaces in covered.left(part.wheel, keyword) {
            let Some(kind) = Finish::new(part, keyword, surfaces) else { continue };
            let used: Vec<usize> = chosen.iter().map(|operation| operation.tool).collect();
            let search = Search { part, kind: &kind, all, tools: &tools(part, &kind, all, &used), methods: &METHODS };
            let text = |operation: &ChosenOperation| {
                let mut first = operation.clone();
                first.properties.push(("sectors", "1".to_owned()));
                let (names, declarations) = named([&first], all, &taken);
                declarations + &items(&[first], &names)
            };
            let Some(operation) = search.first(&text, true, trials) else {
                sink.push(search.none(trials));
                return Err(Aborted);
            };
            chosen.push(operation);
        }
    }
    chosen.sort_by_key(|operation| ORDER.iter().position(|keyword| *keyword == operation.keyword));
    Ok(chosen)
}

/// What is chosen for an operation of finishing that leaves values open; `fixed` is the tool that it names.
///
/// # Errors
/// No tool or method serves; the reasons are in the sink.
pub(crate) fn of_open(
    part: &Part<'_>,
    open: &OpenOperation<'_>,
    fixed: Option<usize>,
    all: &[Candidate],
    trials: &mut Trials<'_, '_>,
    sink: &mut Sink,
) -> Result<ChosenOperation, Aborted> {
    let Some(kind) = Finish::new(part, &open.kind.text, Vec::new()) else { return Err(Aborted) };
    let tools = fixed.map_or_else(|| self::tools(part, &kind, all, &[]), |fixed| vec![fixed]);
    let methods: &[AxisMethod] = if open.leaves("method") { &METHODS } else { &METHODS[..1] };
    let search = Search { part, kind: &kind, all, tools: &tools, methods };
    let (job, taken) = (trials.job, trials.taken.clone());
    // A method that is fixed takes no second trial; without tool and method nothing is to be tried.
    if fixed.is_some() && !open.leaves("method") {
        return tools.first().map(|tool| search.operation(*tool, METHODS[0], kind.scallop)).ok_or(Aborted);
    }
    let text = |operation: &ChosenOperation| {
        let (names, declarations) = named([operation], all, &taken);
        declarations + &open.in_one_sector(job, std::slice::from_ref(operation), &names)
    };
    match search.first(&text, open.leaves("scallop"), trials) {
        Some(operation) => Ok(operation),
        None => {
            sink.push(search.none(trials).label(open.kind.span, "this operation"));
            Err(Aborted)
        }
    }
}

/// Tools for a kind of finishing, in the order in which they are tried. One that is there already saves a change.
fn tools(part: &Part<'_>, kind: &Finish, all: &[Candidate], used: &[usize]) -> Vec<usize> {
    let mut tools = balls(all, kind.most, part.sizes.height);
    // `channel` takes no tapered ball.
    tools.retain(|tool| kind.keyword != "channel" || all[*tool].is_straight());
    tools.sort_by_key(|tool| !used.contains(tool));
    tools
}

/// A search for the tool and the method of a kind of finishing.
struct Search<'a> {
    part: &'a Part<'a>,
    kind: &'a Finish,
    all: &'a [Candidate],
    tools: &'a [usize],
    methods: &'a [AxisMethod],
}

impl Search<'_> {
    /// The first tool and method that have axes. `text` writes an operation in one sector; `few`: whether trials may have fewer lines.
    fn first(
        &self,
        text: &dyn Fn(&ChosenOperation) -> String,
        few: bool,
        trials: &mut Trials<'_, '_>,
    ) -> Option<ChosenOperation> {
        let largest = self.tools.iter().map(|tool| self.all[*tool].ball).fold(0.0, f64::max);
        let (large, small): (Vec<usize>, Vec<usize>) =
            self.tools.iter().partition(|tool| self.all[**tool].ball >= LARGE_SHARE * largest);
        let with_each = |tools: Vec<usize>| {
            let methods = self.methods.iter();
            methods.flat_map(move |method| tools.clone().into_iter().map(move |tool| (tool, *method)))
        };
        let mut failed = false;
        with_each(large).chain(with_each(small)).find_map(|(tool, method)| {
            if trials.progress.is_cancelled() {
                return None;
            }
            let what = format!("{} with {}, {}", self.kind.keyword, self.all[tool].name, method.name());
            let mut has_axes =
                |scallop: f64, what: &str| trials.have_axes(what, &text(&self.operation(tool, method, scallop)));
            // What fails with few lines fails with all of them, and sooner.
            let enough = !(failed && few) || has_axes(FEW_LINES * self.kind.scallop, &format!("{what}, few lines"));
            let holds = enough && has_axes(self.kind.scallop, &what);
            failed |= !holds;
            holds.then(|| self.operation(tool, method, self.kind.scallop))
        })
    }

    fn operation(&self, tool: usize, method: AxisMethod, scallop: f64) -> ChosenOperation {
        let candidate = &self.all[tool];
        let data = cutting_data(&candidate.tool, self.part.material, self.part.spindle);
        let lead = format!("{} mm", trim(self.part.lead, 1));
        let mut properties = self.kind.surfaces.clone();
        properties.extend([
            ("scallop", format!("{} um", trim(1000.0 * scallop, 1))),
            ("method", method.name().to_owned()),
            ("lead-in", lead.clone()),
            ("lead-out", lead),
        ]);
        let [radius, most] = [candidate.ball, self.kind.most].map(|radius| trim(radius, 2));
        let why = format!(
            "{} with a ball of {radius} mm of radius, of at most {most} mm that fit: the largest that has free and smooth axes",
            self.kind.of
        );
        ChosenOperation {
            keyword: self.kind.keyword.clone(),
            tool,
            speed: data.speed,
            feed: data.finish,
            properties,
            why,
            ..ChosenOperation::default()
        }
    }

    /// Says that nothing serves, with what was tried.
    fn none(&self, trials: &Trials<'_, '_>) -> Diag {
        let mut diag = Diag::error(planning::NO_TOOL, format!("no tool of the library finishes the {}", self.kind.of));
        if self.tools.is_empty() {
            diag = diag.note(format!(
                "a ball of {} to {} mm of radius that sticks out by at least {} mm, the height of the blades, is needed; the library has none",
                trim(LEAST_SHARE * self.kind.most, 2),
                trim(self.kind.most, 2),
                trim(self.part.sizes.height, 1)
            ));
        }
        for tried in trials.tried.iter().filter(|tried| tried.what.starts_with(&self.kind.keyword)) {
            if let Some(fault) = &tried.fault {
                diag = diag.note(format!("{}: {fault}", tried.what));
            }
        }
        diag.help(if self.tools.is_empty() {
            "add such a ball to a library of your own, or plan this surface by hand"
        } else {
            "add a smaller ball, or one with a slimmer shank and holder, to a library of your own; or plan this surface by hand"
        })
    }
}
