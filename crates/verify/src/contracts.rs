//! Comparison of the contracts of the job with the measured figures.

use super::certificate::{AllowedReport, Certificate, ContractReport};
use super::measure::{Figure, NarrowMeasure, Unmeasured, measure};
use super::place::describe;
use super::stock::MAX_SLOT_DEPTH;
use super::surface::FAR;
use base::entity::EntityId;
use base::units::trim;
use diagnostics::codes::{self, verification};
use diagnostics::{Code, Diag, Sink};
use ir::{Allowed, Contract, Motion, OperationId, Program};
use nalgebra::Point3;
use std::collections::BTreeSet;
use wheel::contract::{ContractKind, Cuts, Guarded, OfOperations, Region, Relation, Scope};
use wheel::part::{SurfaceClass, SurfaceId};

/// Judges all contracts; failing contracts become errors. Lists what is allowed, with its figure. An `allow` becomes a
/// remark when every contract would hold without it.
pub(super) fn judge(
    program: &Program,
    motion: &Motion,
    certificate: &Certificate,
    narrow: &dyn NarrowMeasure,
    sink: &mut Sink,
) -> (Vec<ContractReport>, Vec<AllowedReport>) {
    let judge = Judge { program, motion, certificate, narrow };
    let contracts = program.contracts.iter().filter_map(|c| judge.contract(c, sink)).collect();
    let allowed = program.allowed.iter().map(|a| judge.allowed(a, sink)).collect();
    (contracts, allowed)
}

/// Most sectors that are named one by one.
const MAX_NAMED_SECTORS: usize = 4;

struct Judge<'a> {
    program: &'a Program,
    motion: &'a Motion,
    certificate: &'a Certificate,
    narrow: &'a dyn NarrowMeasure,
}

impl Judge<'_> {
    fn region(&self, kind: ContractKind, scope: &Scope<OperationId>) -> Region {
        let operations = match kind.of_operations() {
            OfOperations::Done => scope.operations.iter().map(|o| o.index()).collect(),
            OfOperations::After => Vec::new(),
        };
        Region::of(&Scope { operations, surfaces: scope.surfaces.clone() }, self.program.operations.len())
    }

    /// Operation after which a contract is judged, for quantities that are judged after operations.
    fn after(&self, contract: &Contract) -> Option<usize> {
        let last = contract.scope.operations.iter().map(|o| o.index()).max();
        last.filter(|_| contract.kind.of_operations() == OfOperations::After)
    }

    /// The region of a contract without the allowed parts; the item `but` does not count as allowed.
    fn kept(&self, contract: &Contract, but: Option<&Allowed>) -> Region {
        let others = self.program.allowed.iter().filter(|a| a.kind.takes_out_of(contract.kind) && Some(*a) != but);
        let left = others.fold(self.region(contract.kind, &contract.scope), |region, a| {
            region.without(&self.region(a.kind, &a.scope))
        });
        // A default covers only what no stated contract covers.
        let stated = self.program.contracts.iter().filter(|c| contract.default && !c.default);
        stated
            .filter(|c| c.kind.covers(contract.kind))
            .fold(left, |region, c| region.without(&self.region(c.kind, &c.scope)))
    }

    fn figure(&self, contract: &Contract, region: &Region) -> Result<Figure, Unmeasured> {
        measure(contract.kind, region, self.after(contract), self.certificate, self.narrow)
    }

    fn scope_text(&self, scope: &Scope<OperationId>) -> String {
        scope.text(|o| self.program.operations[*o].name.clone())
    }

    /// The sectors in which a contract on material that is left is judged, where these are not all: those in which operations finish.
    fn sectors_text(&self, kind: ContractKind, region: &Region) -> String {
        if kind != ContractKind::Excess {
            return String::new();
        }
        let of_region = |id: &SurfaceId| {
            let rows = SurfaceClass::ALL.into_iter().zip(&region.rows);
            rows.filter(|(_, row)| row.contains(&true)).any(|(class, _)| class == id.kind.class())
        };
        let all = || self.certificate.surfaces.iter().map(|s| s.id).filter(of_region);
        let judged: BTreeSet<u32> = all().filter(|id| self.program.asks_for(*id)).map(|id| id.sector + 1).collect();
        let count = self.program.part.vane_count;
        match judged.len() {
            _ if all().all(|id| self.program.asks_for(id)) => String::new(),
            1..=MAX_NAMED_SECTORS => {
                let many = if judged.len() > 1 { "s" } else { "" };
                let names: Vec<String> = judged.iter().map(u32::to_string).collect();
                format!(" in sector{many} {} of {count}", names.join(", "))
            }
            judged => format!(" in {judged} of {count} sectors"),
        }
    }

    fn contract(&self, contract: &Contract, sink: &mut Sink) -> Option<ContractReport> {
        let region = self.kept(contract, None);
        if contract.default && region.is_empty_on(contract.kind.speaks_of()) {
            return None;
        }
        let figure = match self.figure(contract, &region) {
            Ok(figure) => figure,
            Err(reason) => {
                sink.push(unmeasured(contract, reason));
                return None;
            }
        };
        // A value beyond the range of measurement holds no bound, however large.
        let holds = contract.kind.relation().holds(figure.value, contract.bound.value())
            && !beyond_measure(contract.kind, figure.value);
        if !holds {
            sink.push(self.failure(contract, &figure));
        }
        let blank = self.certificate.stock.as_ref().map(|stock| stock.blank.get());
        if contract.kind == ContractKind::RestVolume && blank.is_some_and(|blank| contract.bound.value() >= blank) {
            sink.push(
                Diag::warning(codes::job::DOUBTFUL, "the rest volume may be as large as the whole blank")
                    .label(contract.span, "this contract forbids nothing")
                    .help(format!("write a bound near what is left: {}", amount(contract.kind, figure.value))),
            );
        }
        Some(ContractReport {
            kind: contract.kind,
            scope: (self.scope_text(&contract.scope) + &self.sectors_text(contract.kind, &region))
                .trim_start()
                .to_owned(),
            relation: contract.kind.relation(),
            unit: contract.bound.unit().into(),
            bound: contract.bound.value(),
            found: figure.value,
            place: self.place(&figure),
            point: figure.point,
            at: figure.at,
            holds,
            default: contract.default,
            computed: figure.found,
            span: contract.span,
        })
    }

    fn allowed(&self, allowed: &Allowed, sink: &mut Sink) -> AllowedReport {
        let own = self.region(allowed.kind, &allowed.scope);
        let figure = measure(allowed.kind, &own, None, self.certificate, self.narrow).ok();
        let excuses = self.program.contracts.iter().filter(|c| allowed.kind.takes_out_of(c.kind)).any(|c| {
            let without = match c.kind {
                // Sums and shares are judged with the operations that were taken out: the contract may fail as a whole.
                ContractKind::Time | ContractKind::Air => self.kept(c, Some(allowed)),
                _ => self.region(c.kind, &c.scope).within(&own),
            };
            !without.is_empty_on(c.kind.speaks_of())
                && self.figure(c, &without).is_ok_and(|f| !c.kind.relation().holds(f.value, c.bound.value()))
        });
        // No contract of the job judges deep slots: the check of the load does.
        let excuses = excuses
            || (allowed.kind == ContractKind::Slot && figure.as_ref().is_some_and(|f| f.value > MAX_SLOT_DEPTH));
        let waives = allowed.scope.is_whole().then(|| allowed.kind.default_bound()).flatten();
        let excuses = excuses
            || waives
                .zip(figure.as_ref())
                .is_some_and(|(bound, f)| !allowed.kind.relation().holds(f.value, bound.value()));
        let name = allowed.kind.name();
        let scope = self.scope_text(&allowed.scope);
        if !excuses {
            let found =
                figure.as_ref().map_or_else(String::new, |f| format!("; measured {}", amount(allowed.kind, f.value)));
            sink.push(
                Diag::remark(
                    verification::NEEDLESS_ALLOW,
                    format!("`allow {name}{scope}` has no effect: all contracts hold without it{found}"),
                )
                .label(allowed.span, "not needed")
                .help("remove the `allow`, so that the contracts cover more"),
            );
        }
        AllowedReport {
            kind: allowed.kind,
            scope: scope.trim_start().to_owned(),
            unit: allowed.kind.bound(0.0).unit().into(),
            found: figure.as_ref().map(|f| f.value),
            place: figure.as_ref().map_or_else(String::new, |f| self.place(f)),
            point: figure.as_ref().and_then(|f| f.point),
            at: figure.as_ref().and_then(|f| f.at),
            reason: allowed.reason.clone(),
            excuses,
            waives: waives.is_some(),
        }
    }

    fn place(&self, figure: &Figure) -> String {
        match figure.at {
            Some(at) => format!("{}: {}", figure.what, describe(self.program, self.motion, Some(at))),
            None => figure.what.clone(),
        }
    }

    /// The largest computed value where a contract judges a proved bound, in words.
    fn computed_note(&self, contract: &Contract, found: f64) -> String {
        let figure = contract.kind.bound(found).figure();
        match (&contract.kind, &self.certificate.stock) {
            (ContractKind::Gouge | ContractKind::Excess, _) => {
                format!("at the computed points {figure} was found; the bound includes the surface between the points")
            }
            (ContractKind::Engagement(_), Some(stock)) => format!(
                "the stock shows {figure}; the bound includes what lies between its rays, {} mm apart: a smaller \
                 `--stock-cell` narrows it",
                trim(stock.cell.get(), 4)
            ),
            _ => format!("the nearest sample is {figure} away; the bound includes the surface between samples"),
        }
    }

    fn failure(&self, contract: &Contract, found: &Figure) -> Diag {
        let Failure { code, text, help } = words(contract, found);
        let side = match contract.kind.relation() {
            Relation::AtMost => "at most",
            Relation::AtLeast => "at least",
        };
        let scope = self.scope_text(&contract.scope);
        let bound = contract.bound;
        let diag = Diag::error(code, text);
        let mut diag = match contract.default {
            true => diag.note(format!(
                "the job has no such contract; the default is {} {} {}",
                contract.kind.name(),
                contract.kind.relation().sign(),
                contract.bound.figure()
            )),
            false => diag.label(contract.span, "this contract fails"),
        }
        .note(format!(
            "{}{scope}: found {}, required {side} {}",
            contract.kind.name(),
            amount(contract.kind, found.value),
            bound.figure()
        ))
        .help(help);
        let computed = found.found.filter(|value| *value < FAR && *value != found.value);
        if let Some(computed) = computed {
            diag = diag.note(self.computed_note(contract, computed));
        }
        if let Some(point) = found.point {
            diag = diag.place(describe(self.program, self.motion, found.at), Point3::from(point));
        }
        if let Some(at) = found.at {
            diag = diag.block(at.operation, at.index);
        }
        if let Some(operation) = found.operation.and_then(|o| self.motion.operations.get(o)) {
            diag = diag.label(self.program.operations[operation.operation].span, "in this operation");
        }
        diag
    }
}

/// Whether a found value is not measured: from [`FAR`] on, the distance of surfaces to cutters is not known.
fn beyond_measure(kind: ContractKind, found: f64) -> bool {
    matches!(kind, ContractKind::Excess | ContractKind::Rest) && found >= FAR
}

/// A found value in words.
pub fn amount(kind: ContractKind, found: f64) -> String {
    if beyond_measure(kind, found) { "all of it".to_owned() } else { kind.bound(found).figure() }
}

/// Codes of contracts that fail.
pub const FAILURES: [Code; 12] = [
    verification::GOUGE,
    verification::EXCESS,
    verification::CLEARANCE,
    verification::REST,
    verification::TIME,
    verification::AXIS_SHARE,
    verification::CONTOUR_ERROR,
    verification::ORIENTATION_ERROR,
    verification::AIR,
    verification::REMOVAL_RATE,
    verification::REST_VOLUME,
    verification::ENGAGEMENT,
];

/// A contract that fails, in words.
struct Failure {
    code: Code,
    text: String,
    help: &'static str,
}

fn words(contract: &Contract, found: &Figure) -> Failure {
    let what = &found.what;
    let is = amount(contract.kind, found.value);
    let wanted = contract.bound.figure();
    let (code, text, help) = match contract.kind {
        ContractKind::Gouge => (
            verification::GOUGE,
            format!("a cutter cuts {is} deep into {what} (allowed gouge {wanted})"),
            "use more strips, a thinner tool, a finer chord tolerance, or a wider contract",
        ),
        ContractKind::Excess => (
            verification::EXCESS,
            if found.value >= FAR {
                format!("{what}: not machined (allowed excess {wanted})")
            } else {
                format!("{what}: {is} of material left (allowed excess {wanted})")
            },
            "use a smaller scallop, more strips, a tool that reaches the place, or all sectors",
        ),
        ContractKind::Clearance(Guarded::Tool) => (
            verification::CLEARANCE,
            format!("the {what} comes within {is} of the stock; required clearance {wanted}"),
            "use a longer lead-in or lead-out, so that passes begin and end farther from the stock",
        ),
        ContractKind::Clearance(_) => (
            verification::CLEARANCE,
            format!("the {what} comes within {is} of the part; required clearance {wanted}"),
            "use a longer reach, a slimmer holder, or a thinner shank",
        ),
        ContractKind::Rest => (
            verification::REST,
            format!("roughing leaves {is} ({what}); allowed {wanted}"),
            "use a smaller `depth` or `residual`, smaller allowances, or another roughing tool that reaches the place",
        ),
        ContractKind::Time => (
            verification::TIME,
            format!("the program takes {is} ({what}); allowed {wanted}"),
            "use larger steps (`depth`, `residual`, `scallop`), higher feeds, or a larger tool in the longest operation",
        ),
        ContractKind::AxisSpeed => (
            verification::AXIS_SHARE,
            format!("{what} uses {is} of its speed; allowed {wanted}"),
            "use a lower `feed` or `link-feed` in this operation, or tool axes farther from the pole",
        ),
        ContractKind::ContourError => (
            verification::CONTOUR_ERROR,
            format!("tip or flutes deviate from the verified motion by {is} ({what}); allowed {wanted}"),
            "use a smaller `tolerance chord` (`rough` for roughing), within which the control rounds corners, or a lower `feed` \
             if the control cycle causes the deviation",
        ),
        ContractKind::OrientationError => (
            verification::ORIENTATION_ERROR,
            format!("the tool axis deviates from the verified motion by {is} ({what}); allowed {wanted}"),
            "use a smaller `tolerance chord` (`rough` for roughing), within which the control rounds corners, or a lower `feed`",
        ),
        ContractKind::Air => (
            verification::AIR,
            format!("{is} of the time at feed is air cut ({what}); allowed {wanted}"),
            "use shorter leads, a higher `link-feed`, or passes that begin at the stock",
        ),
        ContractKind::RemovalRate => (
            verification::REMOVAL_RATE,
            format!("the removal rate is {is} ({what}); allowed {wanted}"),
            "use a lower `feed`, or smaller steps (`depth`, `residual`) in this operation",
        ),
        ContractKind::Engagement(_) | ContractKind::Slot => return load_words(contract, found),
        ContractKind::RestVolume => (
            verification::REST_VOLUME,
            format!("the rest volume is {is} ({what}); allowed {wanted}"),
            "use operations for all faces and sectors, smaller steps, or a tool that reaches the material",
        ),
    };
    Failure { code, text, help }
}

/// As [`words`], of what the stock takes of the cutter.
fn load_words(contract: &Contract, found: &Figure) -> Failure {
    let what = &found.what;
    let is = amount(contract.kind, found.value);
    let wanted = contract.bound.figure();
    let (which, help) = match contract.kind {
        ContractKind::Engagement(Cuts::All) => ("", "use a smaller `stepover`, or require it `outside of slots`"),
        ContractKind::Engagement(Cuts::OutsideSlots) => ("outside of slots ", "use a smaller `stepover`"),
        _ => {
            let text = format!("finishing cuts a slot of {is} of the diameter ({what}); allowed {wanted}");
            let help = "use roughing that leaves less stock there: one more `expand`, a smaller `residual`, or the sectors beside it";
            return Failure { code: verification::TOOL_LOAD, text, help };
        }
    };
    let text = format!("{which}the engagement is up to {is} ({what}); allowed {wanted}");
    Failure { code: verification::ENGAGEMENT, text, help }
}

fn unmeasured(contract: &Contract, reason: Unmeasured) -> Diag {
    let name = contract.kind.name();
    let (why, help) = match reason {
        Unmeasured::NeedsStock => ("it needs the stock simulation, which did not run", "remove the contract"),
        Unmeasured::NoRoughing => {
            ("no roughing operation applies to this place", "require `excess`, or add a groove or expand operation")
        }
        Unmeasured::NoSolid => (
            "the surfaces of the part enclose no volume: a fillet does not reach from inlet to outlet",
            "use a smaller fillet, or `require excess` on surfaces",
        ),
    };
    Diag::error(verification::NOT_MEASURED, format!("`require {name}` cannot be judged: {why}"))
        .label(contract.span, "this contract")
        .help(help)
}
