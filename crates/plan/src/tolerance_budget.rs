//! Tolerance budget that the contracts leave to a plan of flank milling.

use five_axis::pose_curve::MAX_CHORD_ERROR_MM;
use ir::{OperationId, Program};
use wheel::contract::ContractKind;
use wheel::method::ErrorSide;
use wheel::part::{FaceId, SurfaceClass, SurfaceKind};

/// Largest violation of a bound that smoothing may cause, mm.
pub const SLACK: f64 = 1e-4;

/// Reserve of the plan against each bound of a contract, besides the chord tolerance and [`SLACK`], mm, so that the
/// proof between samples succeeds.
const RESERVE: f64 = 1e-4;

/// Bounds of gouge and excess on a surface, mm.
#[derive(Clone, Copy)]
struct Bounds {
    gouge: Option<f64>,
    excess: Option<f64>,
}

/// The bounds of the contracts that apply to a surface and an operation.
fn bounds(program: &Program, operation: OperationId, class: SurfaceClass) -> Bounds {
    let counts = |operations: &[OperationId], surfaces: &[SurfaceClass]| {
        (operations.is_empty() || operations.contains(&operation)) && (surfaces.is_empty() || surfaces.contains(&class))
    };
    let least = |kind: ContractKind| {
        let left = program.allowed.iter().any(|a| a.kind == kind && counts(&a.scope.operations, &a.scope.surfaces));
        // A default is the limit of every program, not a requirement of the job.
        let limits = program.contracts.iter().filter(|c| c.kind == kind && !c.default);
        let limits = limits.filter(|c| counts(&c.scope.operations, &c.scope.surfaces)).map(|c| c.bound.value());
        limits.reduce(f64::min).filter(|_| !left)
    };
    Bounds { gouge: least(ContractKind::Gouge), excess: least(ContractKind::Excess) }
}

/// What the interpolation between stations may take of a bound, mm: the chord tolerance. Spline blocks are proved on chords, whose
/// distance from the curve is in the samples and once more in the bound, which is not as sharp.
pub fn interpolation(program: &Program) -> f64 {
    program.tolerances.chord.get()
        + if program.control().spline_form().is_some() { 3.0 * MAX_CHORD_ERROR_MM } else { 0.0 }
}

/// Difference between each bound of a contract and the budget of the plan, mm.
pub fn kept(program: &Program) -> f64 {
    interpolation(program) + SLACK + RESERVE
}

/// Tolerance budget of the plan on a surface, below and above, mm, for passes along the face of `side`; `None` unless
/// the contracts bound both.
pub fn budget(
    program: &Program,
    operation: OperationId,
    errors: ErrorSide,
    kind: SurfaceKind,
    side: FaceId,
) -> Option<[f64; 2]> {
    // Another face counts as the face of `side`; every other surface counts as the hub.
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
    // Bounds that are nearer to each other than twice the reserve leave their middle.
    let short = 0.5 * (gouge + excess).min(0.0);
    Some([gouge - short, excess - short])
}
