//! V2: what the whole program leaves on every design surface, proved between samples.
//!
//! For a point p of a surface, g(p) is the least signed distance of p to any cutter at any time, rapids included.
//! Negative is gouge, positive is excess. Each surface is divided into cells without gaps ([`crate::part::chart`]). g is
//! computed at their corners; then every cell is proved to stay within [`SLACK`] of the worst that was found on its
//! surface, or within a contract's limit where that lies closer, by the bounds of [`super::proof`], and divided where
//! they fall short. A deeper place that comes up moves
//! the goal with it.
//!
//! The one quantity that is measured instead of proved is how far a surface leaves the biquadratic through nine points
//! of a cell; it is taken from third differences, with a margin.

pub use super::proof::cells::{CORNER_SLACK, FAR, LEAST_SLACK, PatchCorners, SLACK};
use super::proof::cells::{Found, Goals, Looked, Proved, Task, deviation};
use super::proof::grid::{Grid, Surface};
use super::proof::piece::At;
use super::proof::sweep::Sweep;
use crate::part::{
    Part, SurfaceClass, SurfaceId,
    chart::{self, Shape, charts},
};
use crate::progress::{Progress, Work};
use nalgebra::{Point3, Rotation3, Vector3};
use rayon::prelude::*;
use serde::Serialize;

/// The same for the excess, as a share of it, where that is more.
const SLACK_SHARE: f64 = 0.02;

/// How much deeper than its widest contract a cut is when nothing more is proved of it than that cutters have a radius, mm:
/// the figure that was found says enough, and the proof would look at each of the cutters that overlap there.
pub const BROKEN: f64 = 0.2;

/// g from which a place counts as not reached, mm: no finishing leaves a tenth of a millimetre.
pub const NOT_REACHED: f64 = 0.1;

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
    /// Cells of the first division.
    pub samples: usize,
    /// Points at which g was computed and cells that were proved, for the work done.
    pub points: usize,
    /// Area, mm2.
    pub area: f64,
    /// Deepest cut found: the least g.
    pub gouge: Worst,
    /// No cut into the surface is deeper, mm.
    pub gouge_bound: f64,
    /// Most left that was found: the largest g.
    pub excess: Worst,
    /// Nowhere is more left, mm; [`FAR`] where nothing comes near.
    pub excess_bound: f64,
    /// 5, 50 and 95 percent of the area lie below these g, mm.
    pub percentiles: [f64; 3],
    /// Area where more than [`NOT_REACHED`] is left, mm2.
    pub not_reached: f64,
    /// Operations, by index in the motion, that come nearest to the area not reached, with their shares of it in mm2;
    /// `None` where nothing comes near.
    pub nearest_there: Vec<(Option<u32>, f64)>,
    /// Id of the surface.
    #[serde(skip)]
    pub id: SurfaceId,
    /// What was found at the corners of the cells, for pictures; patches in the order of [`Shape::patches`].
    #[serde(skip)]
    pub corners: Vec<PatchCorners>,
}

/// Figures of all milled surfaces, with the edges of the vanes where these are milled, in the order of surfaces.
pub fn certify(
    part: &Part,
    edges: bool,
    sweeps: &[Sweep<'_>],
    spacing: f64,
    limits: &Limits,
    progress: &Progress,
) -> Vec<SurfaceReport> {
    let mut charts = charts(part);
    if edges {
        charts.extend(chart::edges(part));
    }
    let grids: Vec<Vec<Grid>> = charts.iter().map(|c| grids(c, spacing)).collect();
    let mut surfaces: Vec<(&[Grid], Surface<'_>)> = Vec::new();
    for sector in 0..part.vane_count {
        for (chart, grids) in charts.iter().zip(&grids) {
            let id = SurfaceId { kind: chart.kind, sector };
            surfaces.push((grids, Surface { shape: chart, turn: part.sector_rotation(sector), id }));
        }
    }
    surfaces.sort_by_key(|(_, s)| s.id);
    prove(&surfaces, sweeps, limits, progress)
}

/// Figures of a single shape under any name.
pub fn certify_shape(shape: &dyn Shape, id: SurfaceId, sweeps: &[Sweep<'_>], spacing: f64) -> Option<SurfaceReport> {
    let grids = grids(shape, spacing);
    prove(
        &[(&grids, Surface { shape, turn: Rotation3::identity(), id })],
        sweeps,
        &Limits::default(),
        &Progress::default(),
    )
    .pop()
}

fn grids(shape: &dyn Shape, spacing: f64) -> Vec<Grid> {
    shape.patches(spacing).into_par_iter().map(|p| Grid::new(shape, p)).collect()
}

/// Patches of whole surfaces that are in memory at a time, at least: enough for all threads. Of surfaces that nothing
/// mills each patch has hundreds of pieces that are about as near as each other.
const TOGETHER: usize = 128;

fn prove(
    surfaces: &[(&[Grid], Surface<'_>)],
    sweeps: &[Sweep<'_>],
    limits: &Limits,
    progress: &Progress,
) -> Vec<SurfaceReport> {
    let patches: usize = surfaces.iter().map(|(grids, _)| grids.len()).sum();
    let work = progress.begin("surfaces", 2 * patches);
    let mut reports = Vec::with_capacity(surfaces.len());
    let mut rest = surfaces;
    while !rest.is_empty() {
        let mut patches = 0;
        let few = |(grids, _): &&(&[Grid], Surface<'_>)| {
            let few = patches < TOGETHER;
            patches += grids.len();
            few
        };
        let (these, others) = rest.split_at(rest.iter().take_while(few).count());
        reports.extend(prove_together(these, sweeps, limits, &work));
        rest = others;
    }
    reports
}

fn prove_together(
    surfaces: &[(&[Grid], Surface<'_>)],
    sweeps: &[Sweep<'_>],
    limits: &Limits,
    work: &Work,
) -> Vec<SurfaceReport> {
    let tasks: Vec<(usize, Task<'_>)> = surfaces
        .iter()
        .enumerate()
        .flat_map(|(s, (grids, surface))| grids.iter().map(move |grid| (s, Task { surface, grid, sweeps })))
        .collect();
    let looked: Vec<Looked> = tasks.par_iter().with_max_len(1).map(|(_, task)| work.step(task.look())).collect();
    let mut ranges = vec![[FAR, -FAR]; surfaces.len()];
    for ((s, _), looked) in tasks.iter().zip(&looked) {
        ranges[*s] = [ranges[*s][0].min(looked.range[0]), ranges[*s][1].max(looked.range[1])];
    }
    let goals: Vec<Goals> =
        ranges.iter().zip(surfaces).map(|(range, (_, s))| goals(*range, s.id.kind.class(), limits)).collect();
    let proved: Vec<Proved> = tasks
        .par_iter()
        .zip(&looked)
        .with_max_len(1)
        .map(|((s, task), l)| work.step(task.prove(l, goals[*s])))
        .collect();
    let all: Vec<(usize, &Task<'_>, &Looked, &Proved)> =
        tasks.iter().zip(&looked).zip(&proved).map(|(((s, task), l), p)| (*s, task, l, p)).collect();
    all.par_chunk_by(|a, b| a.0 == b.0).map(|of_one| report(of_one, sweeps)).collect()
}

/// What contracts allow at most, mm, each on its surfaces; bounds are driven below these where what is found allows it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limits {
    /// Deepest gouge.
    pub gouge: Vec<Limit>,
    /// Most excess.
    pub excess: Vec<Limit>,
}

/// A bound of a contract with the surfaces that it speaks of; none named means all.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Bound, mm.
    pub bound: f64,
    /// Surfaces.
    pub surfaces: Vec<SurfaceClass>,
}

/// The bounds that speak of a surface.
fn on(limits: &[Limit], surface: SurfaceClass) -> impl Iterator<Item = f64> + '_ {
    let here = limits.iter().filter(move |l| l.surfaces.is_empty() || l.surfaces.contains(&surface));
    here.map(|l| l.bound)
}

/// The next bound over a value on a surface: a narrower one that is broken already says nothing more.
fn next_over(limits: &[Limit], surface: SurfaceClass, found: f64) -> f64 {
    on(limits, surface).filter(|bound| *bound > found).fold(f64::INFINITY, f64::min)
}

/// What is to be proved of a surface on which g was found between two values.
fn goals([least, most]: [f64; 2], surface: SurfaceClass, limits: &Limits) -> Goals {
    // Beyond what was found by the slack, or by less where a limit lies between.
    let beyond = |found: f64, slack: f64, limits: &[Limit]| {
        (found + slack).min(next_over(limits, surface, found)).max(found + LEAST_SLACK)
    };
    let allowed = on(&limits.gouge, surface).fold(0.0, f64::max);
    Goals {
        low: if -least > allowed + BROKEN { f64::NEG_INFINITY } else { -beyond(-least, SLACK, &limits.gouge) },
        high: beyond(most, SLACK.max(SLACK_SHARE * most), &limits.excess),
    }
}

/// The figures of one surface from those of its patches.
fn report(patches: &[(usize, &Task<'_>, &Looked, &Proved)], sweeps: &[Sweep<'_>]) -> SurfaceReport {
    let surface = patches[0].1.surface;
    let all = patches.iter().fold(Proved::NOTHING, |all, p| all.join(p.3));
    let cells: Vec<(f64, f64, Option<At>)> =
        patches.iter().flat_map(|(_, task, looked, _)| looked.cells(task)).collect();
    let gouge = extreme(surface, all.least, -1.0, sweeps);
    let excess = extreme(surface, all.most, 1.0, sweeps);
    let area: f64 = cells.iter().map(|c| c.1).sum();
    let nearest_there = nearest_there(&cells);
    // A deep cut is proved by its depth: the bound of g says how much more there may be.
    let gouge_bound = (-all.low.min(gouge.value)).max(0.0) + (gouge.depth - (-gouge.value).max(0.0));
    SurfaceReport {
        surface: surface.id.to_string(),
        samples: cells.len(),
        points: all.points,
        area,
        gouge_bound,
        excess_bound: all.high.max(excess.value).clamp(0.0, FAR),
        percentiles: percentiles(&cells, area),
        not_reached: nearest_there.iter().map(|n| n.1).sum(),
        nearest_there,
        gouge,
        excess,
        id: surface.id,
        corners: patches.iter().map(|(_, task, looked, _)| looked.values(task)).collect(),
    }
}

/// g below which 5, 50 and 95 percent of the area lie.
fn percentiles(cells: &[(f64, f64, Option<At>)], area: f64) -> [f64; 3] {
    let mut sorted: Vec<(f64, f64)> = cells.iter().map(|c| (c.0, c.1)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    [0.05, 0.5, 0.95].map(|share| {
        let mut below = 0.0;
        let found = sorted.iter().find(|(_, a)| {
            below += a;
            below >= share * area
        });
        found.or(sorted.last()).map_or(FAR, |f| f.0)
    })
}

/// Operations that come nearest to the area not reached.
fn nearest_there(cells: &[(f64, f64, Option<At>)]) -> Vec<(Option<u32>, f64)> {
    let mut found: Vec<(Option<u32>, f64)> = Vec::new();
    for (_, area, at) in cells.iter().filter(|c| c.0 > NOT_REACHED) {
        let operation = at.map(|a| a.operation);
        match found.iter_mut().find(|n| n.0 == operation) {
            Some(n) => n.1 += area,
            None => found.push((operation, *area)),
        }
    }
    found.sort_by_key(|n| n.0);
    found
}

/// The extreme of g that was found on a surface, followed to where it is most extreme (`sign` -1 for the least).
pub(super) fn extreme(surface: &Surface<'_>, found: Found, sign: f64, sweeps: &[Sweep<'_>]) -> Worst {
    let (value, start) = found.unwrap_or((FAR, [0.5; 2]));
    // Only a cut deeper than any tolerance can be deeper along the normal than in distance.
    let deep = sign < 0.0 && value < -DEEP;
    let mut known = Known { sweeps, last: None };
    let measure = |xy: [f64; 2]| {
        let (p, normal, _) = place(surface, xy);
        if !surface.holds(&p) {
            f64::NEG_INFINITY
        } else if deep {
            depth(&p, &normal, sweeps)
        } else {
            sign * known.deviation(&p)
        }
    };
    let finest = if value < -WRECKED { COARSE } else { FINEST };
    let (best, most) = if value < FAR { climb(surface, start, finest, measure) } else { (start, FAR) };
    let (p, _, parameters) = place(surface, best);
    let (value, at) = deviation(&p, sweeps, FAR);
    let depth = if deep { most } else { (-value).max(0.0) };
    Worst { value, point: [p.x, p.y, p.z], parameters, at, depth }
}

/// g of points near each other: it changes no faster than the point moves, so that the last one says how far to look.
struct Known<'a> {
    sweeps: &'a [Sweep<'a>],
    last: Option<(Point3<f64>, f64)>,
}

impl Known<'_> {
    fn deviation(&mut self, p: &Point3<f64>) -> f64 {
        let cutoff = self.last.map_or(FAR, |(q, g)| g + (p - q).norm() + LEAST_SLACK);
        let (g, _) = deviation(p, self.sweeps, cutoff.min(FAR));
        self.last = Some((*p, g));
        g
    }
}

fn place(surface: &Surface<'_>, [x, y]: [f64; 2]) -> (Point3<f64>, Vector3<f64>, [f64; 2]) {
    let place = surface.shape.place(x, y);
    (surface.turn * place.position, surface.turn * place.normal, place.parameters)
}

/// Depth from which the way along the normal is followed, mm.
const DEEP: f64 = 0.1;

/// Steps of [`depth`]: each goes to the border of the cutter that reaches on deepest.
const DEPTH_STEPS: usize = 400;

/// Length of the way from a surface point against its normal that lies inside of swept cutters.
fn depth(p: &Point3<f64>, normal: &Vector3<f64>, sweeps: &[Sweep<'_>]) -> f64 {
    let mut depth = 0.0;
    let mut cutoff = FAR;
    for _ in 0..DEPTH_STEPS {
        let (g, _) = deviation(&(p - normal * depth), sweeps, cutoff);
        if g > -1e-7 {
            break;
        }
        depth -= g;
        // g changes no faster than the point moves.
        cutoff = LEAST_SLACK;
    }
    depth
}

/// Step at which the search for the worst place ends, mm: g changes by far less than a micrometre over it.
const FINEST: f64 = 1e-4;

/// Depth of a cut of which nobody asks for micrometres, and the step at which the search for its worst place ends, mm.
const WRECKED: f64 = 0.5;
const COARSE: f64 = 0.02;

/// Rounds of that search: some twenty to the finest step and walks over some millimetres.
const ROUNDS: usize = 100;

/// Climbs a measure over a surface by a pattern search in its chart, down to a step.
fn climb(
    surface: &Surface<'_>,
    start: [f64; 2],
    finest: f64,
    mut measure: impl FnMut([f64; 2]) -> f64,
) -> ([f64; 2], f64) {
    const PROBE: f64 = 0.02;
    // Shares of the chart that make a millimetre.
    let unit = [0, 1].map(|k| {
        let mut other = start;
        other[k] += if start[k] > 0.5 { -PROBE } else { PROBE };
        PROBE / (surface.point(start) - surface.point(other)).norm().max(1e-6)
    });
    let (mut best, mut most, mut step) = (start, measure(start), 0.1);
    for _ in 0..ROUNDS {
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
