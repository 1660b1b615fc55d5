//! Kept surfaces: how deep cutters go into surfaces that milling must leave as the lathe made them.
//!
//! The proof is that of design surfaces (`lower_bound.rs`, `cells.rs`), with lower bounds only, since excess on a kept
//! surface does not matter. Whole patches without a nearby cutter are excluded at once, so that a back face of 100 cm2
//! takes milliseconds.

use super::SPACING;
use super::place::describe;
use super::proof::cells::{Extreme, Goals, PatchTask, Proved, SampledPatch};
use super::proof::grid::{Grid, PlacedSurface};
use super::proof::nearest::NEAR_ERROR;
use super::proof::sweep::Sweep;
use super::surface::{self, FAR, MIN_SLACK, SLACK, Worst};
use super::symmetry::{Step, Symmetry};
use base::progress::Progress;
use base::units::{Mm, length};
use diagnostics::{Diag, Sink, codes::verification};
use ir::{Motion, Program};
use nalgebra::Rotation3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use wheel::part::{
    Part, SurfaceId, SurfaceKind,
    chart::Shape,
    kept::{Kept, kept},
};

/// Figures of the kept surfaces of one kind, in all sectors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeptReport {
    /// Common name: `rim`, `vanes 1-8 tip`.
    pub surface: String,
    /// The surface with the deepest cut.
    pub worst_on: String,
    /// Deepest measured cut.
    pub gouge: Worst,
    /// Proved bound of the depth of any cut into these surfaces, mm.
    pub gouge_bound: Mm,
    /// Kind of the surfaces; a file has the name of the surface with the deepest cut.
    #[serde(skip, default = "unknown_kind")]
    pub kind: SurfaceKind,
}

fn unknown_kind() -> SurfaceKind {
    surface::unknown().kind
}

/// Result for all kept surfaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeptSurfaces {
    /// Deepest cut that is allowed, mm: the strictest contract on gouge.
    pub allowed: Mm,
    /// Results by kind.
    pub surfaces: Vec<KeptReport>,
}

/// A surface with the patches that cutters may touch.
pub(super) struct Covered<'a> {
    /// The surface in its sector.
    pub(super) surface: PlacedSurface<'a>,
    /// Its patches, as indices into all grids.
    pub(super) grids: Vec<usize>,
}

/// Surfaces with their patches.
pub(super) struct Cover<'a> {
    /// The part.
    pub(super) part: &'a Part,
    /// The surfaces in their sectors.
    pub(super) surfaces: Vec<Covered<'a>>,
    /// Grids of the patches.
    pub(super) grids: Vec<Grid>,
}

/// Least distance of cutters to one surface, if below the cutoff.
#[derive(Clone, Copy)]
pub(super) struct Deepest {
    /// Least measured distance, with its place in the chart; `None` where it is not below the cutoff.
    pub(super) found: Extreme,
    /// Proved lower bound of the distance, mm.
    pub(super) low: f64,
}

/// Measures the cutters of the whole program against all kept surfaces. The bounds include `off`, the largest distance of a
/// cutter from its sweep, mm.
pub fn check(program: &Program, sweeps: &[Sweep<'_>], off: f64, progress: &Progress) -> KeptSurfaces {
    let allowed = super::kept_gouge(program);
    let shapes = kept(&program.part, &program.stock, program.milled_turned());
    let cover = cover(program, &shapes, sweeps, 0.0);
    let deepest = deepest(&cover, sweeps, 0.0, allowed - off, progress, "kept surfaces");
    let mut surfaces: Vec<(KeptReport, Vec<u32>)> = Vec::new();
    for (c, d) in cover.surfaces.iter().zip(&deepest) {
        let gouge = surface::extreme(&c.surface, d.found, -1.0, sweeps);
        let gouge_bound = gouge.proved_depth(d.low) + off;
        let SurfaceId { kind, sector } = c.surface.id;
        let report = KeptReport {
            surface: String::new(),
            worst_on: c.surface.id.to_string(),
            gouge,
            gouge_bound: Mm(gouge_bound),
            kind,
        };
        match surfaces.iter_mut().find(|(known, _)| known.kind == kind) {
            Some((known, sectors)) => {
                sectors.push(sector);
                known.gouge_bound = Mm(known.gouge_bound.get().max(report.gouge_bound.get()));
                let depth = |cut: &Worst| (cut.depth, -cut.value.get());
                if depth(&report.gouge) > depth(&known.gouge) {
                    *known = KeptReport { gouge_bound: known.gouge_bound, ..report };
                }
            }
            None => surfaces.push((report, vec![sector])),
        }
    }
    let named = |(report, mut sectors): (KeptReport, Vec<u32>)| {
        sectors.sort_unstable();
        sectors.dedup();
        KeptReport { surface: report.kind.in_sectors(&sectors), ..report }
    };
    KeptSurfaces { allowed: Mm(allowed), surfaces: surfaces.into_iter().map(named).collect() }
}

/// The surfaces in their sectors, and grids of the patches with a cutter nearer than `reach`.
pub(super) fn cover<'a>(program: &'a Program, shapes: &'a [Kept<'_>], sweeps: &[Sweep<'_>], reach: f64) -> Cover<'a> {
    let mut all = Vec::new();
    let mut covered = Vec::new();
    for shape in shapes {
        let touched = |patch: &wheel::part::chart::Patch| {
            shape.ball(patch).is_none_or(|(middle, radius)| {
                let within = radius + reach + NEAR_ERROR;
                sweeps.iter().any(|sweep| sweep.near(&middle, within).is_some())
            })
        };
        let patches: Vec<_> = shape.patches(SPACING).into_par_iter().filter(touched).collect();
        let first = all.len();
        all.extend(patches.into_par_iter().map(|p| Grid::new(shape, p)).collect::<Vec<_>>());
        let sectors = if shape.is_ring() { 1 } else { program.part.vane_count };
        for sector in 0..sectors {
            let turn = if shape.is_ring() { Rotation3::identity() } else { program.part.sector_rotation(sector) };
            let id = SurfaceId { kind: shape.kind, sector };
            covered.push(Covered { surface: PlacedSurface { shape, turn, id }, grids: (first..all.len()).collect() });
        }
    }
    Cover { part: &program.part, surfaces: covered, grids: all }
}

/// Least distance of cutters to each surface, where it is less than `cutoff`, with its proof. The bound is within
/// [`surface::SLACK`] of the measured value, or `-limit` where this is closer. For a cut more than [`surface::UNPROVED_GOUGE`]
/// beyond the limit, only the radius of the cutters is used as a bound. Sectors in which the program is the same, turned, follow
/// from one of them.
pub(super) fn deepest(
    cover: &Cover<'_>,
    sweeps: &[Sweep<'_>],
    cutoff: f64,
    limit: f64,
    progress: &Progress,
    stage: impl Into<Cow<'static, str>>,
) -> Vec<Deepest> {
    let stage = stage.into();
    let symmetry = Symmetry::of(sweeps, cover.part);
    let error = symmetry.error();
    let prove = |surfaces: &[&Covered<'_>], limits: &[f64]| {
        prove_deepest(surfaces, &cover.grids, sweeps, cutoff, limits, progress, stage.clone())
    };
    let found: Vec<Option<Deepest>> = if symmetry.is_any() {
        let ids: Vec<SurfaceId> = cover.surfaces.iter().map(|c| c.surface.id).collect();
        let prove_these = |these: &[usize]| {
            prove(&these.iter().map(|k| &cover.surfaces[*k]).collect::<Vec<_>>(), &[limit - error, limit])
        };
        let follow = |step: Step, first: &Deepest| {
            let [beside, to] = [step.beside, step.to].map(|k| &cover.surfaces[k]);
            let grids: Vec<&Grid> = to.grids.iter().map(|grid| &cover.grids[*grid]).collect();
            // The rounding between sectors may not take a bound over the limit.
            let keeps = first.low < -limit || first.low - error >= -limit;
            let follows = keeps && symmetry.follows([&beside.surface, &to.surface], &grids, cutoff + MIN_SLACK);
            follows.then_some(Deepest { low: first.low - error, ..*first })
        };
        symmetry.prove(&ids, prove_these, follow)
    } else {
        prove(&cover.surfaces.iter().collect::<Vec<_>>(), &[limit]).into_iter().map(Some).collect()
    };
    // A cancelled run has no value that anybody sees.
    found.into_iter().flatten().map(|deepest| Deepest { low: deepest.low.min(cutoff), ..deepest }).collect()
}

/// [`deepest`] of some surfaces, each by itself; where no cutter is below the cutoff, the bound lies beyond it.
fn prove_deepest(
    covered: &[&Covered<'_>],
    grids: &[Grid],
    sweeps: &[Sweep<'_>],
    cutoff: f64,
    limits: &[f64],
    progress: &Progress,
    stage: Cow<'static, str>,
) -> Vec<Deepest> {
    if covered.is_empty() {
        return Vec::new();
    }
    let tasks: Vec<(usize, PatchTask<'_>)> = covered
        .iter()
        .enumerate()
        .flat_map(|(s, c)| {
            let of_grid = move |grid: &usize| PatchTask { surface: &c.surface, grid: &grids[*grid], sweeps };
            c.grids.iter().map(move |grid| (s, of_grid(grid)))
        })
        .collect();
    let work = progress.begin(stage, 2 * tasks.len());
    // Reserve for rounding: a distance equal to the cutoff is still evaluated.
    let sample = |task: &PatchTask<'_>| task.sample_below(Some(cutoff + MIN_SLACK));
    let sampled: Option<Vec<SampledPatch>> =
        tasks.par_iter().with_max_len(1).map(|(_, task)| work.do_step(|| sample(task))).collect();
    let Some(sampled) = sampled else { return Vec::new() };
    let mut least = vec![FAR; covered.len()];
    for ((s, _), sampled) in tasks.iter().zip(&sampled) {
        least[*s] = least[*s].min(sampled.range[0]);
    }
    let goal = |found: f64| {
        // The measured value plus the slack; less where the limit lies between.
        let found = -found.min(cutoff);
        if found > limits.iter().copied().fold(0.0, f64::max) + surface::UNPROVED_GOUGE {
            return Goals { low: f64::NEG_INFINITY, high: f64::INFINITY };
        }
        let within = limits.iter().copied().filter(|limit| found < *limit).fold(f64::INFINITY, f64::min);
        Goals { low: -(found + SLACK).min(within).max(found + MIN_SLACK), high: f64::INFINITY }
    };
    let proved: Option<Vec<Proved>> = tasks
        .par_iter()
        .zip(&sampled)
        .with_max_len(1)
        .map(|((s, task), l)| work.do_step(|| task.prove(l, goal(least[*s]))))
        .collect();
    let Some(proved) = proved else { return Vec::new() };
    let mut all: Vec<Proved> = vec![Proved::NO_CELLS; covered.len()];
    for ((s, _), p) in tasks.iter().zip(&proved) {
        all[*s] = all[*s].join(p);
    }
    all.into_iter().map(|p| Deepest { found: p.least.filter(|l| l.0 < FAR), low: p.low }).collect()
}

/// Reports cuts into kept surfaces as errors, one per kind.
pub(super) fn report(program: &Program, motion: &Motion, found: &KeptSurfaces, sink: &mut Sink) {
    for s in found.surfaces.iter().filter(|s| s.gouge_bound > found.allowed) {
        let (surface, allowed) = (&s.worst_on, length(found.allowed.get()));
        let text = if s.gouge.depth > found.allowed {
            format!(
                "a cutter goes {} deep into the {surface}, a kept surface; allowed {allowed}",
                length(s.gouge.depth.get())
            )
        } else {
            format!(
                "the deepest cut found in the {surface}, a kept surface, is {}, but the proved bound is {}; allowed \
                 {allowed}",
                length(s.gouge.depth.get()),
                length(s.gouge_bound.get())
            )
        };
        let mut diag =
            Diag::error(verification::KEPT, text).place(describe(program, motion, s.gouge.at), s.gouge.point.into());
        if let Some(at) = s.gouge.at {
            diag = diag.block(at.operation, at.index);
            if let Some(operation) = motion.operations.get(at.operation as usize) {
                diag = diag.label(program.operations[operation.operation].span, "in this operation");
            }
        }
        sink.push(
            diag.note("no operation mills this surface; the strictest contract on gouge applies")
                .help("use leads and links clear of this surface, or a thinner tool; for an edge or a tip of the vanes use an operation `edge` or `tip`"),
        );
    }
}
