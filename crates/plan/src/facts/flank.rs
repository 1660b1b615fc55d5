//! What flank milling would leave on the faces: the least error with one, two and three strips.

use crate::passes::flank::strip::{Surroundings, least_error};
use crate::tolerance_budget::budget;
use base::progress::Progress;
use base::units::length;
use diagnostics::codes::geometry as codes;
use diagnostics::{Diag, Sink};
use ir::{OperationKind, Program};
use rayon::prelude::*;
use tool_stock::collide::Cutter;
use wheel::method::FlankMethod;
use wheel::part::{FaceId, SurfaceKind};

/// Fit of a cutter to a face.
struct Fit {
    side: FaceId,
    cutter: Cutter,
    tool: String,
    allowed: EnoughFit,
}

/// The error on each side at which flank milling is good enough, mm.
#[derive(Clone, Copy)]
enum EnoughFit {
    /// What contracts leave.
    Contracts(f64),
    /// What a finish allows.
    Finish,
    /// As little as an operation leaves that mills the face by points, with this scallop height, mm.
    Scallop(f64),
}

impl EnoughFit {
    fn error(self) -> f64 {
        match self {
            Self::Contracts(error) => error,
            Self::Finish => POINT_MILLED,
            // With `side excess` all of the error is excess, as scallops are.
            Self::Scallop(height) => 0.5 * height,
        }
    }

    /// What follows from the errors with one, two and three strips.
    fn verdict(self, errors: [f64; 3]) -> String {
        let fitting = errors.iter().position(|e| *e <= self.error());
        let strips = fitting.map(|n| ["one strip", "two strips", "three strips"][n]);
        if let Self::Scallop(height) = self {
            let height = length(height);
            return match strips {
                Some(strips) => {
                    format!("with `side excess` flank milling in {strips} leaves no more than the scallops of {height}")
                }
                None => format!(
                    "point milling is better: its scallops are {height} high, flank milling leaves {} in three strips with `side excess`",
                    length(2.0 * errors[2])
                ),
            };
        }
        let whose = match self {
            Self::Contracts(_) => "the contracts leave as tolerance budget on each side",
            _ => "a finish allows",
        };
        let allowed = length(self.error());
        match strips {
            Some(strips) => {
                let are = if fitting == Some(0) { "is" } else { "are" };
                format!("{strips} {are} within the {allowed} that {whose}")
            }
            None => {
                format!("use point milling: even with three strips the error is larger than the {allowed} that {whose}")
            }
        }
    }
}

/// Faces and cutters whose fit is judged: those of `minimax` operations, and those of point milling with balls whose flutes are as
/// long as the face is high.
fn fits(program: &Program) -> Vec<Fit> {
    let part = &program.part;
    let mut fits: Vec<Fit> = Vec::new();
    for (id, operation) in program.operations.iter() {
        let tool = &program.tools[operation.tool];
        let cutter = tool.solid.cutter;
        let faces: Vec<(FaceId, EnoughFit)> = match &operation.kind {
            OperationKind::Flank { faces, flank } if flank.method == FlankMethod::Minimax => {
                let allowed = |side: FaceId| {
                    let budget = budget(program, id, flank.side, SurfaceKind::Face(side), side);
                    budget.map_or(EnoughFit::Finish, |[below, above]| EnoughFit::Contracts(0.5 * (below + above)))
                };
                faces.iter().map(|side| (*side, allowed(*side))).collect()
            }
            OperationKind::Point { surfaces, scallop, .. } if cutter.ends_in_ball() => {
                let reached = |side: FaceId| {
                    let surface = &part.face(side).surface;
                    [0.0, 0.5, 1.0].iter().all(|u| surface.height(*u) <= tool.solid.flute_length)
                };
                let faces =
                    surfaces.iter().filter_map(|s| if let SurfaceKind::Face(side) = s { Some(*side) } else { None });
                faces.filter(|side| reached(*side)).map(|side| (side, EnoughFit::Scallop(scallop.get()))).collect()
            }
            OperationKind::Roughing { .. }
            | OperationKind::Flank { .. }
            | OperationKind::Channel { .. }
            | OperationKind::Point { .. } => Vec::new(),
        };
        for (side, allowed) in faces {
            if !fits.iter().any(|f| f.side == side && f.cutter == cutter) {
                fits.push(Fit { side, cutter, tool: tool.name.clone(), allowed });
            }
        }
    }
    fits
}

/// Reports how well the sides of cutters fit the faces that they finish, or could finish in the place of point milling.
pub fn report(program: &Program, progress: &Progress, sink: &mut Sink) {
    let part = &program.part;
    let around = Surroundings::watched(part, progress);
    let fits = fits(program);
    let work = progress.begin("fits of cutters to faces", 3 * fits.len());
    let fitted = |fit: &Fit, strips| work.do_step(|| least_error(&around, fit.side, strips, fit.cutter, 1)).flatten();
    let errors = |fit: &Fit| [1, 2, 3].map(|strips| fitted(fit, strips));
    let found: Vec<_> = fits.par_iter().map(errors).collect();
    for (fit, errors) in fits.iter().zip(found) {
        let [Some(one), Some(two), Some(three)] = errors.map(|w| w.map(|w| w.error)) else { continue };
        // More strips can follow the paths of fewer, where the search found none that are better.
        let (two, three) = (two.min(one), three.min(two).min(one));
        let of = if part.blades.len() == 1 { String::new() } else { format!("{} ", part.blade(fit.side.blade).name) };
        sink.push(
            Diag::remark(
                codes::FLANK_FIT,
                format!(
                    "flank milling leaves {} on the {of}{} face with {} in one strip, {} in two, {} in three",
                    length(one),
                    fit.side.name(),
                    fit.tool,
                    length(two),
                    length(three)
                ),
            )
            .note("gouge and excess are equal; with `side excess` there is no gouge, and the excess is twice as large")
            .note(fit.allowed.verdict([one, two, three])),
        );
    }
}

/// Allowed error where contracts give none, mm: what a finish allows. A face whose error with three strips is larger is
/// better point milled.
const POINT_MILLED: f64 = 0.02;
