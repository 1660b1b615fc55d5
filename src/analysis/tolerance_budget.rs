//! What the contracts leave to a plan of flank milling.

use crate::contract::ContractKind;
use crate::ir::{OperationId, Program};
use crate::method::ErrorSide;
use crate::part::{FaceId, SurfaceClass, SurfaceKind};

/// A bound is kept to this much, mm: what easing may overstep.
pub const SLACK: f64 = 1e-4;

/// What the plan keeps from each bound of a contract beside the chord tolerance and [`SLACK`], mm, so that the proof
/// between samples has room.
const RESERVE: f64 = 1e-4;

/// Bounds of gouge and excess on a surface, mm.
#[derive(Clone, Copy)]
struct Bounds {
    gouge: Option<f64>,
    excess: Option<f64>,
}

/// The bounds of the contracts on a surface that count for an operation.
fn bounds(program: &Program, operation: OperationId, class: SurfaceClass) -> Bounds {
    let counts = |operations: &[OperationId], surfaces: &[SurfaceClass]| {
        (operations.is_empty() || operations.contains(&operation)) && (surfaces.is_empty() || surfaces.contains(&class))
    };
    let least = |kind: ContractKind| {
        let left = program.allowed.iter().any(|a| a.kind == kind && counts(&a.scope.operations, &a.scope.surfaces));
        // A default says what no program may pass, not what the job would like to have.
        let asked = program.contracts.iter().filter(|c| c.kind == kind && !c.default);
        let asked = asked.filter(|c| counts(&c.scope.operations, &c.scope.surfaces)).map(|c| c.bound.value());
        asked.reduce(f64::min).filter(|_| !left)
    };
    Bounds { gouge: least(ContractKind::Gouge), excess: least(ContractKind::Excess) }
}

/// What is kept from each bound of a contract, mm.
pub fn kept(program: &Program) -> f64 {
    program.tolerances.chord.get() + SLACK + RESERVE
}

/// Deviations that the contracts leave to the plan on a surface, below and above, mm, for passes along the face of
/// `side`; `None` where they do not say both.
pub fn room(
    program: &Program,
    operation: OperationId,
    errors: ErrorSide,
    kind: SurfaceKind,
    side: FaceId,
) -> Option<[f64; 2]> {
    // What is neither fillet nor hub is beside the face, and asked for as the face is.
    let class = match kind {
        SurfaceKind::Fillet(_) | SurfaceKind::Hub(_) => kind.class(),
        SurfaceKind::Face(_) => SurfaceKind::Face(side).class(),
        _ => SurfaceClass::Hub,
    };
    let bounds = bounds(program, operation, class);
    let kept = kept(program);
    let gouge = match errors {
        ErrorSide::Both => bounds.gouge? - kept,
        ErrorSide::Excess => -kept,
    };
    let excess = bounds.excess? - kept;
    // Bounds closer together than what is kept of them leave the middle.
    let short = 0.5 * (gouge + excess).min(0.0);
    Some([gouge - short, excess - short])
}
