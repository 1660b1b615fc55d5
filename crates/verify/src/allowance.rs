//! Roughing with the smoothing of the control: where the control smooths the path within its tolerance, the cutter may
//! come nearer to the finished part by this tolerance. Even then no roughing cutter may touch a surface of the finished
//! part, milled or kept.
//!
//! The proof is that of gouge (`kept.rs`), for the roughing cutters only, up to the tolerance outside of the part.

use super::kept::{cover, deepest};
use super::place::describe;
use super::proof::sweep::Sweep;
use super::surface::{self, SLACK, Worst};
use super::vane_allowance::{self, VaneReport};
use base::progress::Progress;
use base::units::{Mm, length};
use diagnostics::{Diag, Sink, codes::verification};
use ir::{Motion, Program};
use serde::{Deserialize, Serialize};
use wheel::operation::Allowances;
use wheel::part::kept::{Kept, MilledTurned, kept, milled};

/// Distance of the roughing cutters from the finished part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AllowanceReport {
    /// Smoothing tolerance of the control in roughing, mm.
    pub tolerance: Mm,
    /// The nearest place, if cutters come nearer to the part than the tolerance.
    pub nearest: Option<NearestRough>,
    /// Proved lower bound of the distance to all surfaces, mm; distances beyond the tolerance are cut off.
    pub bound: Mm,
    /// Operations with an allowance on the vanes.
    pub vanes: Vec<VaneReport>,
}

/// The place where a roughing cutter is nearest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NearestRough {
    /// Surface.
    pub surface: String,
    /// Place; its value is the rest there.
    pub place: Worst,
}

/// Least distance of the roughing cutters among the sweeps of all operations to all surfaces of the part; `None` without
/// roughing.
pub fn check(program: &Program, motion: &Motion, sweeps: &[Sweep<'_>], progress: &Progress) -> Option<AllowanceReport> {
    let roughs = |sweep: &&Sweep<'_>| {
        let operation = sweep.operation().and_then(|o| motion.operations.get(o as usize));
        operation.is_some_and(|o| !program.operations[o.operation].kind.finishes())
    };
    let sweeps: Vec<Sweep<'_>> = sweeps.iter().filter(roughs).cloned().collect();
    if sweeps.is_empty() {
        return None;
    }
    let tolerance = program.tolerances.chord_rough.get();
    // Enough beyond the tolerance that the slack of the proof causes no failure.
    let cutoff = tolerance + 2.0 * SLACK;
    let mut shapes: Vec<Kept<'_>> = milled(&program.part);
    shapes.extend(kept(&program.part, &program.stock, MilledTurned::default()));
    let cover = cover(program, &shapes, &sweeps, cutoff);
    let all = deepest(&cover, &sweeps, cutoff, -tolerance, progress, "roughing against the finished part");
    let bound = all.iter().map(|d| d.low).fold(cutoff, f64::min);
    let least = |d: &super::kept::Deepest| d.found.map_or(f64::INFINITY, |f| f.0);
    let nearest = cover.surfaces.iter().zip(&all).filter(|(_, d)| least(d) < tolerance);
    let nearest = nearest.min_by(|a, b| least(a.1).total_cmp(&least(b.1))).map(|(c, d)| NearestRough {
        surface: c.surface.id.to_string(),
        place: surface::extreme(&c.surface, d.found, -1.0, &sweeps),
    });
    Some(AllowanceReport {
        tolerance: Mm(tolerance),
        nearest,
        bound: Mm(bound),
        vanes: vane_allowance::check(program, motion, &sweeps, progress),
    })
}

impl AllowanceReport {
    /// True when a cutter may touch the part because of the smoothing.
    fn fails(&self) -> bool {
        self.bound < self.tolerance
    }
}

/// Reports roughing that reaches the part as an error.
pub(super) fn report(program: &Program, motion: &Motion, found: &AllowanceReport, sink: &mut Sink) {
    vane_allowance::report(program, motion, &found.vanes, sink);
    if !found.fails() {
        return;
    }
    let tolerance = length(found.tolerance.get());
    let left = |value: f64| match value < 0.0 {
        true => format!("goes {} into", length(-value)),
        false => format!("comes within {} of", length(value)),
    };
    let help = "use larger allowances (`allowance vane 0.2 mm, hub 0.5 mm`), or a smaller `tolerance rough`";
    let Some(n) = &found.nearest else {
        let text = format!(
            "the proved distance of roughing from the finished part is only {}; the control may deviate by {tolerance}",
            length(found.bound.get())
        );
        sink.push(Diag::error(verification::ROUGH_TOLERANCE, text).help(help));
        return;
    };
    let text = format!(
        "roughing {} the {}; the control may deviate by {tolerance} (`tolerance rough`)",
        left(n.place.value.get()),
        n.surface
    );
    let mut diag = Diag::error(verification::ROUGH_TOLERANCE, text)
        .place(describe(program, motion, n.place.at), n.place.point.into());
    if let Some((at, operation)) = n.place.at.and_then(|at| Some((at, motion.operations.get(at.operation as usize)?))) {
        let declared = &program.operations[operation.operation];
        diag = diag.block(at.operation, at.index).label(declared.span, "in this operation");
        if let Some(Allowances { vane, hub }) = declared.kind.roughing() {
            diag = diag.note(format!("its allowances are {vane} on vanes and {hub} on the hub"));
        }
    }
    sink.push(diag.help(help));
}
