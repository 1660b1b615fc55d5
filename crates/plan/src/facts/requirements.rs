//! Requirements that other values of the job exclude: a scallop height over the excess that a contract allows, and words of the
//! post that are coarser than the gouge. Planning would take minutes, and the contract fail.

use base::units::{Mm, length, trim};
use diagnostics::codes::planning::EXCLUDED;
use diagnostics::{Diag, Severity, Sink};
use ir::{Contract, Operation, OperationId, OperationKind, Program};
use wheel::contract::ContractKind;
use wheel::control::Orientation;
use wheel::method::Spacing;
use wheel::part::{SurfaceClass, SurfaceKind};

/// Share of a scallop that equal shares of the arc leave at least: one line more than the scallop height needs, of two.
const OF_EQUAL_SHARES: f64 = 0.25;

/// Reports both.
pub(super) fn check(program: &Program, sink: &mut Sink) {
    let contracts = program.contracts.iter().filter(|c| c.kind == ContractKind::Excess && !c.default);
    for contract in contracts {
        // One message a contract: the operation with the highest scallops.
        let over = SurfaceClass::ALL.into_iter().filter_map(|class| scallops(program, contract, class));
        let over = over.filter(|found| found.scallop.get() > contract.bound.value());
        if let Some(worst) = over.max_by(|a, b| a.scallop.get().total_cmp(&b.scallop.get())) {
            sink.push(too_high(contract, &worst));
        }
    }
    coarse_words(program, sink);
}

/// An operation that leaves scallops.
struct Scallops<'a> {
    operation: &'a Operation,
    scallop: Mm,
    /// False where the lines are equal shares of an arc, with which scallops are lower.
    whole: bool,
}

/// Surfaces that an operation leaves with scallops.
fn with_scallops(operation: &Operation) -> Option<(Vec<SurfaceClass>, Scallops<'_>)> {
    match &operation.kind {
        OperationKind::Channel { scallop, spacing, .. } => {
            let whole = *spacing == Spacing::ConstantScallop;
            Some((vec![SurfaceClass::Hub], Scallops { operation, scallop: *scallop, whole }))
        }
        OperationKind::Point { surfaces, scallop, .. } => {
            let classes = surfaces.iter().map(|kind: &SurfaceKind| kind.class()).collect();
            Some((classes, Scallops { operation, scallop: *scallop, whole: true }))
        }
        OperationKind::Roughing { .. } | OperationKind::Flank { .. } => None,
    }
}

/// The lowest scallops that any operation leaves on the surfaces of a class, where the contract counts there and nothing else
/// finishes them.
fn scallops<'a>(program: &'a Program, contract: &Contract, class: SurfaceClass) -> Option<Scallops<'a>> {
    let counts = |operations: &[OperationId], surfaces: &[SurfaceClass], operation: OperationId| {
        (operations.is_empty() || operations.contains(&operation)) && (surfaces.is_empty() || surfaces.contains(&class))
    };
    if !contract.kind.surfaces().contains(&class) {
        return None;
    }
    let by_flank = program.operations.iter().any(|(_, operation)| match &operation.kind {
        OperationKind::Flank { faces, .. } => faces.iter().any(|face| SurfaceKind::Face(*face).class() == class),
        OperationKind::Roughing { .. } | OperationKind::Channel { .. } | OperationKind::Point { .. } => false,
    });
    let of_class = program.operations.iter().filter_map(|(id, operation)| {
        let (classes, scallops) = with_scallops(operation)?;
        classes.contains(&class).then_some((id, scallops))
    });
    let all: Vec<(OperationId, Scallops<'_>)> = of_class.collect();
    let waived = |id: OperationId| {
        let of = program.allowed.iter().filter(|a| a.kind == ContractKind::Excess);
        of.into_iter().any(|a| counts(&a.scope.operations, &a.scope.surfaces, id))
    };
    let judged = |id: OperationId| counts(&contract.scope.operations, &contract.scope.surfaces, id) && !waived(id);
    if by_flank || !all.iter().all(|(id, _)| judged(*id)) {
        return None;
    }
    all.into_iter().map(|(_, found)| found).min_by(|a, b| a.scallop.get().total_cmp(&b.scallop.get()))
}

/// A contract as a job states it.
fn stated(contract: &Contract) -> String {
    format!("{} {} {}", contract.kind.name(), contract.kind.relation().sign(), length(contract.bound.value()))
}

/// Scallops over the excess of a contract.
fn too_high(contract: &Contract, found: &Scallops<'_>) -> Diag {
    let Scallops { operation, scallop, whole } = found;
    let bound = contract.bound.value();
    let certain = *whole || OF_EQUAL_SHARES * scallop.get() > bound;
    let statement = stated(contract);
    let leaves = if *whole { "leaves scallops of" } else { "may leave scallops of up to" };
    let message =
        format!("`{}` {leaves} {}, and `require {statement}` allows less", operation.name, length(scallop.get()));
    let severity = if certain { Severity::Error } else { Severity::Warning };
    let diag =
        if severity == Severity::Error { Diag::error(EXCLUDED, message) } else { Diag::warning(EXCLUDED, message) };
    diag.label(contract.span, "this requirement")
        .label(operation.span, format!("`scallop` of {}", length(scallop.get())))
        .help(format!(
            "write `scallop {} um` or less in `{}`, or require what its lines leave: `excess <= {} um`",
            trim(bound * 1e3, 3),
            operation.name,
            trim(scallop.get() * 1e3, 3)
        ))
}

/// Words of the post whose rounding takes more than the gouge that a contract allows.
fn coarse_words(program: &Program, sink: &mut Sink) {
    let waived = program.allowed.iter().any(|a| a.kind == ContractKind::Gouge);
    let contracts = program.contracts.iter().filter(|c| c.kind == ContractKind::Gouge);
    let Some(strictest) = contracts.min_by(|a, b| a.bound.value().total_cmp(&b.bound.value())).filter(|_| !waived)
    else {
        return;
    };
    let (bound, digits) = (strictest.bound.value(), program.control().decimals);
    let half = |digits: usize| 0.5 * 10f64.powi(-i32::try_from(digits).unwrap_or(0));
    let flanks = program.operations.iter().filter(|(_, o)| matches!(o.kind, OperationKind::Flank { .. }));
    let lever = flanks.map(|(_, o)| program.tools[o.tool].solid.flute_length).fold(0.0, f64::max);
    let (key, count, by_direction) = match program.control().orientation {
        Orientation::Angles => ("angle", digits.angle, half(digits.angle).to_radians() * lever),
        Orientation::Vectors => ("vector", digits.vector, half(digits.vector) * lever),
    };
    let by_length = half(digits.length);
    let (key, count, by) =
        if by_length >= by_direction { ("length", digits.length, by_length) } else { (key, count, by_direction) };
    if by <= bound {
        return;
    }
    let name = &program.post.name;
    let statement = stated(strictest);
    let mut diag = Diag::error(
        EXCLUDED,
        format!(
            "the post {name} writes `{key}` with {count} decimals: rounding alone moves the cutter by up to {}, and `require {statement}` allows less",
            length(by)
        ),
    );
    if let Some(span) = program.post.span {
        diag = diag.label(span, "this post");
    }
    if !strictest.default {
        diag = diag.label(strictest.span, "this requirement");
    }
    let enough =
        (count + 1..10).find(|more| by * 10f64.powi(-i32::try_from(more - count).unwrap_or(0)) <= 0.25 * bound);
    sink.push(diag.help(format!(
        "write `{key} = {}` or more under `decimals` in posts/{name}.toml, if the control takes so many",
        enough.unwrap_or(count + 2)
    )));
}
