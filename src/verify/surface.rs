//! V2: what the whole program leaves on every design surface.
//!
//! For a sample p of a surface, g(p) is the least signed distance of p to any cutter at any time, rapids included.
//! Negative is gouge, positive is excess.

use super::sweep::{At, Sweep};
use crate::ir::design::{self, Sample, SurfaceId, SurfaceKind};
use crate::ir::{Part, Side};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// Distance beyond which a sample counts as not reached, mm; no search goes on beyond it.
pub const FAR: f64 = 20.0;

/// A place on a surface with what was found there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// g there, mm.
    pub value: f64,
    /// Position, part frame, mm.
    pub point: [f64; 3],
    /// Parameters of the surface.
    pub parameters: [f64; 2],
    /// Move that comes nearest; `None` where nothing comes near.
    pub at: Option<At>,
    /// How far cutters reach into the material from there, against the normal, mm. For a shallow cut it is -g; a
    /// cutter that plunges deeper than its radius has no point farther inside than that, but a greater depth.
    pub depth: f64,
}

/// Figures of one surface.
#[derive(Clone, Debug, Serialize)]
pub struct SurfaceReport {
    /// Name.
    pub surface: String,
    /// Samples.
    pub samples: usize,
    /// Area, mm2.
    pub area: f64,
    /// Deepest cut: the least g.
    pub gouge: Worst,
    /// Most left: the largest g.
    pub excess: Worst,
    /// 5, 50 and 95 percent of the samples lie below these g, mm.
    pub percentiles: [f64; 3],
    /// Id of the surface.
    #[serde(skip)]
    pub id: SurfaceId,
}

/// Samples that one thread takes at a time; within them each starts from what its neighbour found.
const RUN: usize = 256;

/// g of every sample, with the move that makes it.
pub fn deviations(samples: &[Sample], sweeps: &[Sweep<'_>]) -> Vec<(f64, Option<At>)> {
    samples
        .par_chunks(RUN)
        .flat_map_iter(|run| {
            let mut guess: Option<(usize, u32)> = None;
            run.iter()
                .map(|s| {
                    let (g, at, found) = deviation(&s.position, sweeps, guess);
                    guess = found.or(guess);
                    (g, at)
                })
                .collect::<Vec<_>>()
        })
        .collect()
}

/// g of a point; `guess` is a sweep and a piece that came near to a neighbour.
fn deviation(
    p: &Point3<f64>,
    sweeps: &[Sweep<'_>],
    guess: Option<(usize, u32)>,
) -> (f64, Option<At>, Option<(usize, u32)>) {
    let mut best = (FAR, None, None);
    let near = guess.and_then(|(sweep, piece)| sweeps.get(sweep)?.distance_to_piece(piece, p));
    if let Some(n) = near.filter(|n| n.distance < FAR) {
        best = (n.distance, Some(n.at), guess);
    }
    // The last operations come nearest: with them first the others are soon out of the question.
    for (index, sweep) in sweeps.iter().enumerate().rev() {
        if let Some(n) = sweep.nearest(p, best.0) {
            best = (n.distance, Some(n.at), Some((index, n.piece)));
        }
    }
    best
}

/// Step at which the search for the worst point of a surface ends, mm: g changes by far less than a micrometre over it.
const FINEST: f64 = 1e-3;

/// Moves the worst places of a surface from the samples to the worst points between them, and measures depths.
pub fn refine(part: &Part, report: &mut SurfaceReport, sweeps: &[Sweep<'_>], spacing: f64) {
    let id = report.id;
    for (worst, sign) in [(&mut report.gouge, 1.0), (&mut report.excess, -1.0)] {
        if worst.value < FAR {
            let start = Point3::from(worst.point);
            let cost = |p: &Point3<f64>, _: &Vector3<f64>| sign * deviation(p, sweeps, None).0;
            if let Some(p) = climb(part, id, &start, spacing, &cost) {
                let (g, at, _) = deviation(&p, sweeps, None);
                (worst.value, worst.at, worst.point) = (g, at, [p.x, p.y, p.z]);
            }
        }
    }
    let gouge = &mut report.gouge;
    gouge.depth = (-gouge.value).max(0.0);
    // Only a cut deeper than any tolerance can be deeper along the normal than in distance.
    if gouge.value < -DEEP {
        let cost = |p: &Point3<f64>, normal: &Vector3<f64>| -depth(p, normal, sweeps);
        let deepest = climb(part, id, &Point3::from(gouge.point), spacing, &cost);
        if let Some((p, normal)) = deepest.and_then(|p| design::project(part, id, &p)) {
            let (g, at, _) = deviation(&p, sweeps, None);
            (gouge.depth, gouge.value, gouge.at) = (depth(&p, &normal, sweeps), g, at);
            gouge.point = [p.x, p.y, p.z];
        }
    }
}

/// Depth from which the way along the normal is followed, mm.
const DEEP: f64 = 0.1;

/// Steps of [`depth`]: each goes to the border of the cutter that reaches on deepest.
const DEPTH_STEPS: usize = 400;

/// Length of the way from a surface point against its normal that lies inside of swept cutters.
fn depth(p: &Point3<f64>, normal: &Vector3<f64>, sweeps: &[Sweep<'_>]) -> f64 {
    let mut depth = 0.0;
    for _ in 0..DEPTH_STEPS {
        let (g, ..) = deviation(&(p - normal * depth), sweeps, None);
        if g > -1e-7 {
            break;
        }
        depth -= g;
    }
    depth
}

/// Pattern search over a surface for the least cost, from a sample; `None` when no point is better than the sample.
fn climb(
    part: &Part,
    id: SurfaceId,
    start: &Point3<f64>,
    spacing: f64,
    cost: &dyn Fn(&Point3<f64>, &Vector3<f64>) -> f64,
) -> Option<Point3<f64>> {
    let (mut at, mut normal) = design::project(part, id, start)?;
    let mut least = cost(&at, &normal);
    let mut moved = false;
    let mut step = 0.5 * spacing;
    // Each round halves the step or walks on; walks end at the rim of the cut.
    for _ in 0..SEARCH_ROUNDS {
        if step <= FINEST {
            break;
        }
        let first = normal.cross(&Vector3::new(normal.y, normal.z, -normal.x)).normalize();
        let second = normal.cross(&first);
        let better = [first, -first, second, -second].into_iter().find_map(|d| {
            let (p, n) = design::project(part, id, &(at + d * step))?;
            let c = cost(&p, &n);
            (c < least && on_sampled(part, id, &p)).then_some((p, n, c))
        });
        match better {
            Some(found) => {
                (at, normal, least) = found;
                moved = true;
            }
            None => step *= 0.5,
        }
    }
    moved.then_some(at)
}

/// Rounds of the search: some twenty to the finest step and walks over some millimetres.
const SEARCH_ROUNDS: usize = 100;

/// True where no fillet takes the place of the surface, and below the tips.
fn on_sampled(part: &Part, id: SurfaceId, p: &Point3<f64>) -> bool {
    let Some((_, normal)) = design::project(part, id, p) else { return false };
    let radius = part.fillet.map_or(0.0, crate::units::Mm::get);
    let centre = p + normal * radius;
    match id.kind {
        SurfaceKind::Face(_) => part.hub.distance(&centre) >= radius && part.shroud.distance(p) <= 1e-9,
        _ => [Side::Pressure, Side::Suction].into_iter().all(|side| {
            (0..part.vane_count).all(|sector| {
                let face = SurfaceId { kind: SurfaceKind::Face(side), sector };
                design::project(part, face, &centre).is_none_or(|(q, _)| (q - centre).norm() >= radius)
            })
        }),
    }
}

/// Figures per surface, in the order of the surfaces.
pub fn reports(samples: &[Sample], deviations: &[(f64, Option<At>)]) -> Vec<SurfaceReport> {
    let mut groups: BTreeMap<SurfaceId, Vec<usize>> = BTreeMap::new();
    for (i, s) in samples.iter().enumerate() {
        groups.entry(s.surface).or_default().push(i);
    }
    groups
        .into_iter()
        .filter_map(|(id, indices)| {
            let worst = |i: usize| {
                let (s, (value, at)) = (&samples[i], deviations[i]);
                let Point3 { coords } = s.position;
                Worst {
                    value,
                    point: [coords.x, coords.y, coords.z],
                    parameters: s.parameters,
                    at,
                    depth: (-value).max(0.0),
                }
            };
            let least = *indices.iter().min_by(|a, b| deviations[**a].0.total_cmp(&deviations[**b].0))?;
            let most = *indices.iter().max_by(|a, b| deviations[**a].0.total_cmp(&deviations[**b].0))?;
            let mut values: Vec<f64> = indices.iter().map(|i| deviations[*i].0).collect();
            values.sort_by(f64::total_cmp);
            let percentile = |p: f64| values[((values.len() - 1) as f64 * p) as usize];
            Some(SurfaceReport {
                surface: id.to_string(),
                samples: indices.len(),
                area: indices.iter().map(|i| samples[*i].area).sum(),
                gouge: worst(least),
                excess: worst(most),
                percentiles: [percentile(0.05), percentile(0.5), percentile(0.95)],
                id,
            })
        })
        .collect()
}
