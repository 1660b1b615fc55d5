//! Stock that roughing leaves for the finishing operations.
//!
//! Two kinds of points are tested. On the design surfaces, the rest is the distance of the point to the swept cutters.
//! Between part and stock, an island may stand at points of a grid that no cutter has passed; its rest is the distance
//! of the point to the part. Where the job starts from what is left of the blank, both count its surface like a cut.

use super::left::Left;
use super::proof::cells::MIN_SLACK;
use super::proof::piece::At;
use super::proof::sweep::Sweep;
use super::symmetry::Symmetry;
use base::progress::{Progress, Work};
use base::units::{Mm, Share};
use ir::Program;
use nalgebra::Point3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use tool_stock::collide::Cloud;
use wheel::part::{Sample, SurfaceId};

/// Spacing of the grid, mm: an island that the grid misses is thinner than this.
const MIN_GRID_SPACING: f64 = 1.0;

/// Largest number of points of the grid; a larger part has a larger spacing.
const MAX_GRID_POINTS: f64 = 4e6;

/// Every n-th sample is tested: of samples with a spacing of 0.25 mm, rows keep 0.25 mm and columns have nearly 3 mm.
const SAMPLE_STRIDE: usize = 11;

/// Rest after an operation and all earlier ones.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RestReport {
    /// Index of the operation in the motion.
    pub operation: u32,
    /// Least rest on a milled surface; below zero the operation cuts into the design.
    pub least: Mm,
    /// Median of the rest over the samples.
    pub median: Mm,
    /// Largest rest, on a surface or at the grid.
    pub most: Mm,
    /// Place of the largest rest, part frame, mm.
    pub point: [f64; 3],
    /// Surface with the largest rest; `None` for an island inside a channel.
    pub surface: Option<String>,
    /// Share of the grid points that cutters have passed.
    pub cleared: Share,
    /// Largest rest on each milled surface, in the order of the surfaces.
    pub surfaces: Vec<RestOnSurface>,
    /// The largest island inside a channel, by the distance of its farthest point from the part.
    pub island: Option<Island>,
}

/// Largest rest on a surface.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RestOnSurface {
    /// Name of the surface.
    pub surface: String,
    /// Largest rest.
    pub most: Mm,
    /// Its place, part frame, mm.
    pub point: [f64; 3],
    /// Id of the surface; a file has its name.
    #[serde(skip, default = "super::surface::unknown")]
    pub id: SurfaceId,
}

/// Stock that stands inside a channel.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Island {
    /// Distance of its farthest point to the part.
    pub most: Mm,
    /// This point, part frame, mm.
    pub point: [f64; 3],
}

/// Points of the grid inside of the stock and outside of the part, with their distance to the part.
fn void(program: &Program, design: &Cloud, progress: &Progress) -> Vec<(Point3<f64>, f64)> {
    let profile = &program.stock.profile;
    let part = &program.part;
    let (mut r_max, mut low, mut high) = (0.0_f64, f64::INFINITY, f64::NEG_INFINITY);
    for p in profile.iter() {
        (r_max, low, high) = (r_max.max(p[0]), low.min(p[1]), high.max(p[1]));
    }
    let grid = MIN_GRID_SPACING.max(libm::cbrt(4.0 * r_max * r_max * (high - low) / MAX_GRID_POINTS));
    let steps = |length: f64| (length / grid).floor() as i64;
    let n = steps(r_max);
    let levels = steps(high - low);
    let rows = usize::try_from((levels + 1) * (2 * n + 1)).unwrap_or(0);
    let work = progress.begin("room of the channels", rows);
    // Queries that depend only on radius and height are made once for the up to eight points that mirror each other.
    let over_hub = |x: f64, y: f64, z: f64| {
        let r = libm::hypot(x, y);
        r <= r_max && inside(profile, r, z) && part.hub.distance(&Point3::new(x, y, z)) > 0.0
    };
    (0..=levels)
        .into_par_iter()
        .flat_map_iter(|k| {
            let z = low + k as f64 * grid;
            let eighth: Vec<Vec<bool>> =
                (0..=n).map(|i| (0..=i).map(|j| over_hub(i as f64 * grid, j as f64 * grid, z)).collect()).collect();
            let mut level = Vec::new();
            for i in -n..=n {
                if work.do_step(|| ()).is_none() {
                    break;
                }
                for j in -n..=n {
                    let (a, b) = (i.unsigned_abs() as usize, j.unsigned_abs() as usize);
                    if eighth[a.max(b)][a.min(b)] {
                        level.push(Point3::new(i as f64 * grid, j as f64 * grid, z));
                    }
                }
            }
            level
        })
        .filter_map(|p| {
            let (distance, index) = design.least(|q| (q - p).norm(), f64::INFINITY)?;
            let nearest = &design.points()[index];
            ((p - nearest.position).dot(&nearest.normal) > 0.0).then_some((p, distance))
        })
        .collect()
}

/// True when (r, z) lies inside the closed profile.
pub(super) fn inside(profile: &[[f64; 2]], r: f64, z: f64) -> bool {
    let mut within = false;
    for (i, a) in profile.iter().enumerate() {
        let b = &profile[(i + 1) % profile.len()];
        if (a[1] > z) != (b[1] > z) && r < a[0] + (b[0] - a[0]) * (z - a[1]) / (b[1] - a[1]) {
            within = !within;
        }
    }
    within
}

/// What the rest is measured on.
pub struct Measured<'a> {
    /// Samples of the design surfaces.
    pub samples: &'a [Sample],
    /// The same samples, for distances to the part.
    pub design: &'a Cloud,
    /// What is left of the blank, where the job starts from it.
    pub start: Option<&'a Left<'a>>,
}

/// Reports after each roughing operation, in order. `sectors` lists the sectors that any operation machines: other
/// channels remain full and are not tested.
pub fn reports<'a>(
    program: &Program,
    measured: &Measured<'a>,
    sweeps: &[Sweep<'_>],
    roughing: &[usize],
    progress: &Progress,
) -> Vec<RestReport> {
    let Measured { samples, design, start } = *measured;
    let Some(last) = roughing.last() else { return Vec::new() };
    let void = void(program, design, progress);
    if progress.is_cancelled() {
        return Vec::new();
    }
    // The same places of each surface in every sector.
    let sectors = samples.chunk_by(|a, b| a.surface.sector == b.surface.sector);
    let in_sector = |samples: &'a [Sample]| samples.iter().filter(|s| s.surface.milled()).step_by(SAMPLE_STRIDE);
    let at_surface: Vec<&Sample> = sectors.flat_map(in_sector).collect();
    let symmetry = Symmetry::of(sweeps, &program.part);
    let far = super::surface::FAR;
    let thickness = |p: &Point3<f64>| start.map_or(far, |start| start.depth(p).min(far));
    let mut left: Vec<f64> = at_surface.par_iter().map(|s| thickness(&s.position)).collect();
    let mut cleared: Vec<bool> = void.par_iter().map(|(p, _)| thickness(p) <= 0.0).collect();
    let mut reports = Vec::new();
    let work = progress.begin("stock after roughing", (last + 1) * (at_surface.len() + void.len()));
    for (index, sweep) in sweeps.iter().enumerate().take(last + 1) {
        cut(sweep, &symmetry, &at_surface, &mut left, &work);
        cleared.par_chunks_mut(POINTS_IN_TURN).zip(void.par_chunks(POINTS_IN_TURN)).for_each(|(cleared, points)| {
            work.do_step(|| clear_at(sweep, points, cleared));
            work.advance(points.len() - 1);
        });
        if !roughing.contains(&index) {
            continue;
        }
        let standing = void
            .iter()
            .zip(&cleared)
            .filter(|(_, done)| !**done)
            .map(|((p, d), _)| (*d, *p))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let surface = left.iter().zip(&at_surface).map(|(d, s)| (*d, *s)).max_by(|a, b| a.0.total_cmp(&b.0));
        let (Some(surface), island) = (surface, standing.unwrap_or((0.0, Point3::origin()))) else { continue };
        let is_island = island.0 > surface.0;
        let worst = if is_island { island } else { (surface.0, surface.1.position) };
        let mut sorted = left.clone();
        sorted.sort_by(f64::total_cmp);
        reports.push(RestReport {
            operation: u32::try_from(index).unwrap_or(u32::MAX),
            least: Mm(sorted.first().copied().unwrap_or(0.0)),
            median: Mm(sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)),
            most: Mm(worst.0),
            point: [worst.1.x, worst.1.y, worst.1.z],
            surface: (!is_island).then(|| surface.1.surface.to_string()),
            cleared: Share(cleared.iter().filter(|c| **c).count() as f64 / void.len().max(1) as f64),
            surfaces: by_surface(&at_surface, &left),
            island: standing.map(|(most, p)| Island { most: Mm(most), point: [p.x, p.y, p.z] }),
        });
    }
    reports
}

/// Points that are asked in turn, each near the one before.
const POINTS_IN_TURN: usize = 64;

/// Lowers what is left at the samples of all sectors to the distance of the cutter: in the first proved sector, and from there from
/// sector to sector.
fn cut(sweep: &Sweep<'_>, symmetry: &Symmetry<'_>, samples: &[&Sample], left: &mut [f64], work: &Work) {
    let direct = |samples: &[&Sample], left: &mut [f64]| {
        left.par_chunks_mut(POINTS_IN_TURN).zip(samples.par_chunks(POINTS_IN_TURN)).for_each(|(left, samples)| {
            work.do_step(|| cut_at(sweep, samples, left));
            work.advance(samples.len() - 1);
        });
    };
    let sectors: Vec<&[&Sample]> = samples.chunk_by(|a, b| a.surface.sector == b.surface.sector).collect();
    let count = sectors.first().map_or(0, |samples| samples.len());
    let is_whole = sectors.len() == symmetry.vanes as usize && sectors.iter().all(|samples| samples.len() == count);
    let Some(unshared) = symmetry.unshared_in(sweep).filter(|_| is_whole) else {
        return direct(samples, left);
    };
    let mut last: Option<(&[&Sample], Vec<[f64; 2]>)> = None;
    for own in (0..sectors.len()).map(|k| (symmetry.first as usize + k) % sectors.len()) {
        let (samples, left) = (sectors[own], &mut left[own * count..(own + 1) * count]);
        let before = left.to_vec();
        match &last {
            Some((places, values)) => {
                let places = places.par_iter().zip(samples).map(|(last, sample)| [last.position, sample.position]);
                left.par_iter_mut().zip(places).zip(values).for_each(|((left, places), values)| {
                    work.do_step(|| follow(sweep, unshared, places, *values, symmetry.error(), left));
                });
            }
            None => direct(samples, left),
        }
        last = Some((
            samples,
            before.into_iter().zip(left.iter().copied()).map(|(before, after)| [before, after]).collect(),
        ));
    }
}

/// Lowers what is left at a place to the distance of the cutter. `values` are what was left before and after the sweep at the same
/// place of the sector before, where all pieces that both sectors share are as far away.
fn follow(
    sweep: &Sweep<'_>,
    [ahead, behind]: [Option<&Sweep<'_>>; 2],
    [first, place]: [Point3<f64>; 2],
    [before, after]: [f64; 2],
    error: f64,
    left: &mut f64,
) {
    let is_shared = ahead.is_none_or(|ahead| ahead.nearest(&first, after + error).is_none());
    // Where the sweep left nothing less in the sector before, its pieces are only known to be no nearer than that.
    let shared = if after < before { Some(after) } else { (*left <= before).then_some(*left) };
    let by = |sweep: &Sweep<'_>, cutoff: f64| sweep.nearest(&place, cutoff).map_or(cutoff, |n| n.distance);
    *left = match shared.filter(|_| is_shared) {
        Some(shared) => behind.map_or(f64::INFINITY, |behind| by(behind, left.min(shared))).min(shared).min(*left),
        None => by(sweep, *left),
    };
}

/// Lowers what is left at samples to the distance of the cutter.
fn cut_at(sweep: &Sweep<'_>, samples: &[&Sample], left: &mut [f64]) {
    // The distance changes no faster than the point moves, so that the point before gives a cutoff.
    let mut last: Option<(Point3<f64>, f64)> = None;
    for (least, sample) in left.iter_mut().zip(samples) {
        let p = &sample.position;
        let cutoff = last.map_or(f64::INFINITY, |(q, distance)| distance + (p - q).norm() + MIN_SLACK);
        let found = sweep.nearest(p, cutoff.min(*least));
        last = found.map(|n| (*p, n.distance));
        if let Some(n) = found {
            *least = n.distance;
        }
    }
}

/// Marks the points that the cutter passes.
fn clear_at(sweep: &Sweep<'_>, points: &[(Point3<f64>, f64)], cleared: &mut [bool]) {
    let mut last = None;
    for (done, (p, _)) in cleared.iter_mut().zip(points).filter(|(done, _)| !**done) {
        let piece = sweep.holding(p, last);
        *done = piece.is_some();
        last = piece.or(last);
    }
}

/// The largest value on each surface; of equal values the first.
fn by_surface(samples: &[&Sample], left: &[f64]) -> Vec<RestOnSurface> {
    let mut most: BTreeMap<SurfaceId, (f64, Point3<f64>)> = BTreeMap::new();
    for (s, d) in samples.iter().zip(left) {
        let entry = most.entry(s.surface).or_insert((*d, s.position));
        if *d > entry.0 {
            *entry = (*d, s.position);
        }
    }
    most.into_iter()
        .map(|(id, (most, p))| RestOnSurface { surface: id.to_string(), most: Mm(most), point: [p.x, p.y, p.z], id })
        .collect()
}

/// Place of a report in the program, for diagnostics: its operation.
pub fn place(report: &RestReport) -> At {
    At { operation: report.operation, index: 0 }
}
