//! V2: what the whole program leaves on every design surface.
//!
//! For a sample p of a surface, g(p) is the least signed distance of p to any cutter at any time, rapids included.
//! Negative is gouge, positive is excess.

use super::sweep::{At, Sweep};
use crate::ir::design::{Sample, SurfaceId};
use nalgebra::Point3;
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
    if let Some((sweep, piece)) = guess {
        if let Some(n) = sweeps.get(sweep).and_then(|s| s.distance_to_piece(piece, p)).filter(|n| n.distance < FAR) {
            best = (n.distance, Some(n.at), guess);
        }
    }
    // The last operations come nearest: with them first the others are soon out of the question.
    for (index, sweep) in sweeps.iter().enumerate().rev() {
        if let Some(n) = sweep.nearest(p, best.0) {
            best = (n.distance, Some(n.at), Some((index, n.piece)));
        }
    }
    best
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
                Worst { value, point: [coords.x, coords.y, coords.z], parameters: s.parameters, at }
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
