//! V2: deviation of the whole program from every design surface, proved between samples.
//!
//! For a point p of a surface, g(p) is the least signed distance of p to any cutter at any time, rapids included.
//! Negative is gouge, positive is excess. Each surface is divided into cells without gaps ([`wheel::part::chart`]), and
//! g is computed at their corners. Then the bounds of [`super::proof`] prove for every cell that g stays within
//! [`SLACK`] of the worst value measured on the surface, or within the limit of a contract where the limit is closer. A
//! cell whose bounds are not sufficient is divided. When a worse value is measured, the goal moves with it.
//!
//! A cell counts as the biquadratic through nine of its points with a thickness ([`nurbs::range::CellThickness`]), which
//! follows from the ranges of the derivatives of the surface over the cell.

pub use super::proof::cells::{CORNER_SLACK, FAR, MIN_SLACK, PatchCorners, SLACK};
use super::proof::cells::{CellFigures, Extreme, Goals, PatchTask, Proved, SampledPatch, deviation};
use super::proof::grid::{Grid, PlacedSurface};
use super::proof::piece::At;
use super::proof::sweep::Sweep;
use super::symmetry::{Step, Symmetry};
use base::progress::{Progress, Work};
use base::units::{Mm, Mm2};
use nalgebra::{Point3, Rotation3, Vector3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use wheel::part::{
    Part, SurfaceClass, SurfaceId, SurfaceKind,
    chart::{Place, Shape, charts},
    kept::MilledTurned,
};

/// Least distance between two probed places, mm: shares are divided by it.
const MIN_PROBE_DISTANCE: f64 = 1e-6;

/// The same for the excess, as a share of the excess, where this is more.
const EXCESS_SLACK_SHARE: f64 = 0.02;

/// Gouge beyond the widest contract, mm, from which on only the radius of the cutters is used as a proved bound. The
/// measured value is then sufficient, and a proof would have to evaluate each of the cutters that overlap there.
pub const UNPROVED_GOUGE: f64 = 0.2;

/// g from which a place counts as not reached, mm: finishing leaves less than 0.1 mm.
pub const NOT_REACHED: f64 = 0.1;

/// A place on a surface with the values measured there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Worst {
    /// g there.
    pub value: Mm,
    /// Position, part frame, mm.
    pub point: [f64; 3],
    /// Parameters of the surface.
    pub parameters: [f64; 2],
    /// Move that is nearest; `None` where no cutter is near.
    pub at: Option<At>,
    /// Depth to which cutters reach into the material from the place, against the normal. For a shallow cut it is -g.
    /// For a cutter that plunges deeper than its radius it is greater, since no point lies deeper inside of a
    /// cutter than the radius.
    pub depth: Mm,
}

impl Worst {
    /// Proved depth of a cut, mm, from a lower bound of g. A deep cut is described by its depth; the bound of g gives the part
    /// of the depth that was not measured.
    pub(super) fn proved_depth(&self, low: f64) -> f64 {
        let (value, depth) = (self.value.get(), self.depth.get());
        (-low.min(value)).max(0.0) + (depth - (-value).max(0.0))
    }
}

/// Figures of one surface.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SurfaceReport {
    /// Name.
    pub surface: String,
    /// The surface in another sector whose proof holds here, turned: near both the program is the same. `None` for a surface
    /// that was proved by itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub follows: Option<String>,
    /// Cells of the first division.
    pub samples: usize,
    /// Number of points at which g was computed, plus number of cells that were proved; none for a surface that follows.
    pub points: usize,
    /// Area.
    pub area: Mm2,
    /// Deepest measured cut: the least g.
    pub gouge: Worst,
    /// Proved bound of the depth of any cut into the surface.
    pub gouge_bound: Mm,
    /// Largest measured excess: the largest g.
    pub excess: Worst,
    /// Proved bound of the excess; [`FAR`] where no cutter is near.
    pub excess_bound: Mm,
    /// The g below which 5, 50 and 95 percent of the area lie.
    pub percentiles: [Mm; 3],
    /// Area where g is more than [`NOT_REACHED`].
    pub not_reached: Mm2,
    /// Operations, by index in the motion, that are nearest to the area not reached, with their shares of this area;
    /// `None` where no cutter is near.
    pub nearest_there: Vec<(Option<u32>, Mm2)>,
    /// Id of the surface; a file has its name.
    #[serde(skip, default = "unknown")]
    pub id: SurfaceId,
    /// g at the corners of the cells, for pictures; patches in the order of [`Shape::patches`].
    #[serde(skip)]
    pub corners: Vec<PatchCorners>,
}

/// The surface of a report that was read, until its name tells it.
pub(crate) fn unknown() -> SurfaceId {
    SurfaceId { kind: SurfaceKind::Rim, sector: 0 }
}

/// Share of the area of a surface that is left where the operations do not machine the surface.
const UNMACHINED_SHARE: f64 = 0.999;

impl SurfaceReport {
    /// Area that is left over [`NOT_REACHED`], as a share of the surface.
    pub fn left_share(&self) -> f64 {
        if self.area.get() > 0.0 { self.not_reached.get() / self.area.get() } else { 0.0 }
    }

    /// The figures of the same surface in another sector, if they follow from these, by a sector `beside` it in which they hold. Deep
    /// cuts do not: their depth is measured beyond the reach of the bounds; nor do bounds that the rounding between sectors would
    /// take over a limit.
    fn in_sector(
        &self,
        [own, beside, other]: [&PlacedSurface<'_>; 3],
        grids: &[&Grid],
        symmetry: &Symmetry<'_>,
        limits: &Limits,
    ) -> Option<Self> {
        let class = other.id.kind.class();
        let crosses = |limits: &[Limit], bound: Mm| {
            on(limits, class).any(|limit| bound.get() <= limit && bound.get() + symmetry.error() > limit)
        };
        if crosses(&limits.gouge, self.gouge_bound) || crosses(&limits.excess, self.excess_bound) {
            return None;
        }
        let reach = self.excess_bound.get() + CORNER_SLACK;
        if reach >= FAR || self.gouge.value.get() < -MIN_DEEP_CUT || !symmetry.follows([beside, other], grids, reach) {
            return None;
        }
        let turn = other.turn * own.turn.inverse();
        let turned = |worst: &Worst| Worst {
            point: (turn * Point3::from(worst.point)).into(),
            at: worst.at.and_then(|at| symmetry.partner(at, [self.id.sector, other.id.sector])),
            ..worst.clone()
        };
        let widened = |bound: Mm| Mm(bound.get() + symmetry.error());
        Some(Self {
            surface: other.id.to_string(),
            follows: Some(self.surface.clone()),
            points: 0,
            gouge: turned(&self.gouge),
            excess: turned(&self.excess),
            gouge_bound: widened(self.gouge_bound),
            excess_bound: widened(self.excess_bound),
            id: other.id,
            ..self.clone()
        })
    }

    /// Whether the operations machine the surface.
    pub fn is_machined(&self) -> bool {
        self.left_share() < UNMACHINED_SHARE
    }
}

/// Figures of all milled surfaces, in the order of surfaces, with the turned surfaces that operations finish.
pub fn certify(
    part: &Part,
    turned: MilledTurned,
    sweeps: &[Sweep<'_>],
    spacing: f64,
    limits: &Limits,
    progress: &Progress,
) -> Vec<SurfaceReport> {
    let mut charts = charts(part);
    charts.extend(turned.charts(part, true));
    let grids: Vec<Vec<Grid>> = charts.iter().map(|c| grids(c, spacing)).collect();
    let mut surfaces: Vec<(&[Grid], PlacedSurface<'_>)> = Vec::new();
    for sector in 0..part.vane_count {
        for (chart, grids) in charts.iter().zip(&grids) {
            let id = SurfaceId { kind: chart.kind, sector };
            surfaces.push((grids, PlacedSurface { shape: chart, turn: part.sector_rotation(sector), id }));
        }
    }
    surfaces.sort_by_key(|(_, s)| s.id);
    let symmetry = Symmetry::of(sweeps, part);
    if !symmetry.is_any() {
        return prove(&surfaces, sweeps, limits, progress);
    }
    // Down to a limit less the rounding where that is possible, so that those that follow keep the limit.
    let goals = limits.clone().narrowed(symmetry.error()).and(limits);
    let ids: Vec<SurfaceId> = surfaces.iter().map(|(_, surface)| surface.id).collect();
    let prove_these = |these: &[usize]| {
        let these: Vec<_> = these.iter().map(|k| surfaces[*k]).collect();
        prove(&these, sweeps, &goals, progress)
    };
    let follow = |step: Step, report: &SurfaceReport| {
        let grids: Vec<&Grid> = surfaces[step.to].0.iter().collect();
        let of = [step.proved, step.beside, step.to].map(|k| &surfaces[k].1);
        report.in_sector(of, &grids, &symmetry, limits)
    };
    symmetry.prove(&ids, prove_these, follow).into_iter().flatten().collect()
}

/// Figures of a single shape.
pub fn certify_shape(shape: &dyn Shape, id: SurfaceId, sweeps: &[Sweep<'_>], spacing: f64) -> Option<SurfaceReport> {
    let grids = grids(shape, spacing);
    prove(
        &[(&grids, PlacedSurface { shape, turn: Rotation3::identity(), id })],
        sweeps,
        &Limits::default(),
        &Progress::default(),
    )
    .pop()
}

fn grids(shape: &dyn Shape, spacing: f64) -> Vec<Grid> {
    shape.patches(spacing).into_par_iter().map(|p| Grid::new(shape, p)).collect()
}

/// Least number of patches of whole surfaces in memory at a time: enough for all threads. A patch of a surface that no
/// operation mills has hundreds of pieces at about the same distance.
const PATCHES_IN_MEMORY: usize = 128;

fn prove(
    surfaces: &[(&[Grid], PlacedSurface<'_>)],
    sweeps: &[Sweep<'_>],
    limits: &Limits,
    progress: &Progress,
) -> Vec<SurfaceReport> {
    let patches: usize = surfaces.iter().map(|(grids, _)| grids.len()).sum();
    let work = progress.begin("surfaces", 2 * patches);
    let mut reports = Vec::with_capacity(surfaces.len());
    let mut rest = surfaces;
    while !rest.is_empty() && !work.is_cancelled() {
        let mut patches = 0;
        let few = |(grids, _): &&(&[Grid], PlacedSurface<'_>)| {
            let few = patches < PATCHES_IN_MEMORY;
            patches += grids.len();
            few
        };
        let (these, others) = rest.split_at(rest.iter().take_while(few).count());
        reports.extend(prove_together(these, sweeps, limits, &work).unwrap_or_default());
        rest = others;
    }
    reports
}

/// `None` when the run was cancelled.
fn prove_together(
    surfaces: &[(&[Grid], PlacedSurface<'_>)],
    sweeps: &[Sweep<'_>],
    limits: &Limits,
    work: &Work,
) -> Option<Vec<SurfaceReport>> {
    let tasks: Vec<(usize, PatchTask<'_>)> = surfaces
        .iter()
        .enumerate()
        .flat_map(|(s, (grids, surface))| grids.iter().map(move |grid| (s, PatchTask { surface, grid, sweeps })))
        .collect();
    let sampled = tasks.par_iter().with_max_len(1).map(|(_, task)| work.do_step(|| task.sample()));
    let sampled = sampled.collect::<Option<Vec<SampledPatch>>>()?;
    let mut ranges = vec![[FAR, -FAR]; surfaces.len()];
    for ((s, _), sampled) in tasks.iter().zip(&sampled) {
        ranges[*s] = [ranges[*s][0].min(sampled.range[0]), ranges[*s][1].max(sampled.range[1])];
    }
    let goals: Vec<Goals> =
        ranges.iter().zip(surfaces).map(|(range, (_, s))| goals(*range, s.id.kind.class(), limits)).collect();
    let proved: Option<Vec<Proved>> = tasks
        .par_iter()
        .zip(&sampled)
        .with_max_len(1)
        .map(|((s, task), l)| work.do_step(|| task.prove(l, goals[*s])))
        .collect();
    let proved = proved?;
    let all = tasks.iter().zip(&sampled).zip(&proved);
    let all: Vec<ProvedPatch<'_>> = all
        .map(|(((surface, task), sampled), proved)| ProvedPatch { surface: *surface, task, sampled, proved })
        .collect();
    Some(all.par_chunk_by(|a, b| a.surface == b.surface).map(|of_one| report(of_one, sweeps)).collect())
}

/// Limits of the contracts, mm, each on its surfaces. Bounds are proved down to these limits where the measured values
/// allow it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limits {
    /// Limits of the gouge.
    pub gouge: Vec<Limit>,
    /// Limits of the excess.
    pub excess: Vec<Limit>,
}

/// The bound of a contract with its surfaces; an empty list means all surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Bound.
    pub bound: Mm,
    /// Surfaces.
    pub surfaces: Vec<SurfaceClass>,
}

/// The bounds that apply to a surface.
fn on(limits: &[Limit], surface: SurfaceClass) -> impl Iterator<Item = f64> + '_ {
    let here = limits.iter().filter(move |l| l.surfaces.is_empty() || l.surfaces.contains(&surface));
    here.map(|l| l.bound.get())
}

/// The least bound above a measured value on a surface; a narrower bound is already violated.
fn next_over(limits: &[Limit], surface: SurfaceClass, found: f64) -> f64 {
    on(limits, surface).filter(|bound| *bound > found).fold(f64::INFINITY, f64::min)
}

/// Goals of the proof for a surface on which g was measured between two values.
fn goals([least, most]: [f64; 2], surface: SurfaceClass, limits: &Limits) -> Goals {
    // The measured value plus the slack; less where a limit lies between.
    let beyond = |found: f64, slack: f64, limits: &[Limit]| {
        (found + slack).min(next_over(limits, surface, found)).max(found + MIN_SLACK)
    };
    let allowed = on(&limits.gouge, surface).fold(0.0, f64::max);
    Goals {
        low: if -least > allowed + UNPROVED_GOUGE { f64::NEG_INFINITY } else { -beyond(-least, SLACK, &limits.gouge) },
        high: beyond(most, SLACK.max(EXCESS_SLACK_SHARE * most), &limits.excess),
    }
}

/// A patch with its results.
struct ProvedPatch<'a> {
    /// Index of its surface.
    surface: usize,
    task: &'a PatchTask<'a>,
    sampled: &'a SampledPatch,
    proved: &'a Proved,
}

/// The figures of a surface, from the results of its patches.
fn report(patches: &[ProvedPatch<'_>], sweeps: &[Sweep<'_>]) -> SurfaceReport {
    let surface = patches[0].task.surface;
    let all = patches.iter().fold(Proved::NO_CELLS, |all, p| all.join(p.proved));
    let cells: Vec<CellFigures> = patches.iter().flat_map(|p| p.sampled.cells(p.task)).collect();
    let gouge = extreme(surface, all.least, -1.0, sweeps);
    let excess = extreme(surface, all.most, 1.0, sweeps);
    let area: f64 = cells.iter().map(|c| c.area).sum();
    let nearest_there = nearest_there(&cells);
    SurfaceReport {
        surface: surface.id.to_string(),
        follows: None,
        samples: cells.len(),
        points: all.points,
        area: Mm2(area),
        gouge_bound: Mm(gouge.proved_depth(all.low)),
        excess_bound: Mm(all.high.max(excess.value.get()).clamp(0.0, FAR)),
        percentiles: percentiles(&cells, area).map(Mm),
        not_reached: Mm2(nearest_there.iter().map(|n| n.1).sum()),
        nearest_there: nearest_there.into_iter().map(|(o, area)| (o, Mm2(area))).collect(),
        gouge,
        excess,
        id: surface.id,
        corners: patches.iter().map(|p| p.sampled.values(p.task)).collect(),
    }
}

/// The g below which 5, 50 and 95 percent of the area lie.
fn percentiles(cells: &[CellFigures], area: f64) -> [f64; 3] {
    let mut sorted: Vec<&CellFigures> = cells.iter().collect();
    sorted.sort_by(|a, b| a.mean.total_cmp(&b.mean));
    [0.05, 0.5, 0.95].map(|share| {
        let mut below = 0.0;
        let found = sorted.iter().find(|c| {
            below += c.area;
            below >= share * area
        });
        found.or(sorted.last()).map_or(FAR, |c| c.mean)
    })
}

/// Operations nearest to the area not reached.
fn nearest_there(cells: &[CellFigures]) -> Vec<(Option<u32>, f64)> {
    let mut found: Vec<(Option<u32>, f64)> = Vec::new();
    for CellFigures { area, at, .. } in cells.iter().filter(|c| c.mean > NOT_REACHED) {
        let operation = at.map(|a| a.operation);
        match found.iter_mut().find(|n| n.0 == operation) {
            Some(n) => n.1 += area,
            None => found.push((operation, *area)),
        }
    }
    found.sort_by_key(|n| n.0);
    found
}

/// The extreme of g on a surface: a search from the measured extreme (`sign` -1 for the least).
pub(super) fn extreme(surface: &PlacedSurface<'_>, found: Extreme, sign: f64, sweeps: &[Sweep<'_>]) -> Worst {
    let (value, start) = found.unwrap_or((FAR, [0.5; 2]));
    // Only for a cut deeper than any tolerance can the depth along the normal exceed the distance.
    let deep = sign < 0.0 && value < -MIN_DEEP_CUT;
    let mut known = Known { sweeps, last: None };
    let measure = |xy: [f64; 2]| {
        let Place { position: p, normal, .. } = place(surface, xy);
        if !surface.holds(xy, &p) {
            f64::NEG_INFINITY
        } else if deep {
            depth(&p, &normal, sweeps)
        } else {
            sign * known.deviation(&p)
        }
    };
    let finest = if value < -COARSE_SEARCH_DEPTH { COARSE_SEARCH_STEP } else { FINEST_SEARCH_STEP };
    let (best, most) = if value < FAR { climb(surface, start, finest, measure) } else { (start, FAR) };
    let Place { position: p, parameters, .. } = place(surface, best);
    let (value, at) = deviation(&p, sweeps, FAR);
    let depth = if deep { most } else { (-value).max(0.0) };
    Worst { value: Mm(value), point: [p.x, p.y, p.z], parameters, at, depth: Mm(depth) }
}

/// g of successive nearby points. g changes no faster than the point moves, so that the last value gives a cutoff.
struct Known<'a> {
    sweeps: &'a [Sweep<'a>],
    last: Option<(Point3<f64>, f64)>,
}

impl Known<'_> {
    fn deviation(&mut self, p: &Point3<f64>) -> f64 {
        let cutoff = self.last.map_or(FAR, |(q, g)| g + (p - q).norm() + MIN_SLACK);
        let (g, _) = deviation(p, self.sweeps, cutoff.min(FAR));
        self.last = Some((*p, g));
        g
    }
}

/// A place of the chart in the sector of the surface.
fn place(surface: &PlacedSurface<'_>, [x, y]: [f64; 2]) -> Place {
    let place = surface.shape.place(x, y);
    Place { position: surface.turn * place.position, normal: surface.turn * place.normal, ..place }
}

/// Depth of a cut from which on the depth along the normal is computed, mm.
const MIN_DEEP_CUT: f64 = 0.1;

/// Steps of [`depth`]; each goes to the far border of the cutter that reaches deepest.
const MAX_DEPTH_STEPS: usize = 400;

/// Length of the path from a surface point against its normal that lies inside of swept cutters.
fn depth(p: &Point3<f64>, normal: &Vector3<f64>, sweeps: &[Sweep<'_>]) -> f64 {
    let mut depth = 0.0;
    let mut cutoff = FAR;
    for _ in 0..MAX_DEPTH_STEPS {
        let (g, _) = deviation(&(p - normal * depth), sweeps, cutoff);
        if g > -1e-7 {
            break;
        }
        depth -= g;
        // g changes no faster than the point moves.
        cutoff = MIN_SLACK;
    }
    depth
}

/// Step at which the search for the worst place ends, mm: over this step g changes by far less than 1 um.
const FINEST_SEARCH_STEP: f64 = 1e-4;

/// Depth of a cut for which micrometres do not matter, and the step at which the search for its worst place ends, mm.
const COARSE_SEARCH_DEPTH: f64 = 0.5;
const COARSE_SEARCH_STEP: f64 = 0.02;

/// Rounds of this search: about twenty down to the finest step, and moves over some millimetres.
const MAX_SEARCH_STEPS: usize = 100;

/// Maximises a measure over a surface by a pattern search in its chart, down to a step.
fn climb(
    surface: &PlacedSurface<'_>,
    start: [f64; 2],
    finest: f64,
    mut measure: impl FnMut([f64; 2]) -> f64,
) -> ([f64; 2], f64) {
    const PROBE_SHARE: f64 = 0.02;
    // Shares of the chart per millimetre.
    let unit = [0, 1].map(|k| {
        let mut other = start;
        other[k] += if start[k] > 0.5 { -PROBE_SHARE } else { PROBE_SHARE };
        PROBE_SHARE / (surface.point(start) - surface.point(other)).norm().max(MIN_PROBE_DISTANCE)
    });
    let (mut best, mut most, mut step) = (start, measure(start), 0.1);
    for _ in 0..MAX_SEARCH_STEPS {
        if step <= finest {
            break;
        }
        let better = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)].into_iter().find_map(|(i, j)| {
            let next = [best[0] + i * step * unit[0], best[1] + j * step * unit[1]];
            if next.iter().any(|c| !(0.0..=1.0).contains(c)) {
                return None;
            }
            let value = measure(next);
            (value > most).then_some((next, value))
        });
        match better {
            Some(found) => (best, most) = found,
            None => step *= 0.5,
        }
    }
    (best, most)
}
