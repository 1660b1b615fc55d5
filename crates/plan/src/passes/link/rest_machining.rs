//! `rest-machining`: removes cuts that would take nothing off the stock of earlier operations.
//!
//! Before: the paths that the machine will interpolate, pass by pass. After: an operation with rest machining keeps
//! only the parts of its passes on which the cutter meets stock deeper than the thickness of the job, each with its
//! leads; `link-moves` connects them. The stock of this pass comes from the planned cuts of earlier operations without
//! links. It may therefore be larger than the true stock, never smaller. It serves planning only; the verifier computes
//! its own. Links of all operations are searched in it (`stock_links`).
//!
//! Between the rays of the stock the surface is unknown. Where a rounding of radius R dips by t into the stock, the
//! chip is 2 sqrt(2 R t) wide. Half a diagonal of a cell h beside the deepest place, the depth is less by h^2 / 4R.
//! Cells are so small that this error is at most half of the thickness, and the cutter is enlarged by it before the
//! query. A needle or an edge of stock narrower than a cell may still stand between the rays; contracts on excess and
//! rest judge what is left.

use super::clearance_surface::ClearanceSurface;
use super::cleared::Cleared;
use super::direct_link::DirectLinks;
use super::like_sectors::LikeSectors;
use super::stock_steps::{PathPoint, error_between_rays, leaves_along_axis, path_length, rounding, stations, steps};
use super::{stock_links, stock_order, strokes};
use crate::passes::context::Obstacles;
use crate::spacing;
use base::progress::{Progress, Work};
use base::units::trim;
use diagnostics::{Aborted, Diag, Sink, codes::planning};
use ir::{ClOperation, ClPass, ClPlan, Operation, Program, RoughingStrategy};
use std::ops::Range;
use tool_stock::collide::ToolSolid;
use tool_stock::stock::{self, Field, FieldError, Step, StepKind};

/// Largest cell, mm, where a thick rest would allow larger ones: the cell of the usual verification.
const MAX_CELL_MM: f64 = 1.0;

/// Largest cell for `rough`, mm: its passes end where the stock ends, so that its error is time in air. On a part of more
/// than [`USUAL_RADIUS_MM`] radius, cells grow in proportion, as its passes do.
const MAX_ROUGH_CELL_MM: f64 = 0.5;
const USUAL_RADIUS_MM: f64 = 60.0;

/// Largest cell for `plunge`, as a share of the distance of its strokes: what a stroke cuts is no wider.
const CELL_PER_STEP: f64 = 0.25;

/// Steps between two updates of the progress.
const PIECE: usize = 1 << 11;

/// Thins the passes of all operations with rest machining.
///
/// # Errors
/// An operation with nothing left to cut; a thickness that would need too small cells. The sink holds the reasons.
pub fn run(
    program: &Program,
    obstacles: &Obstacles,
    cl: &mut ClPlan,
    progress: &Progress,
    sink: &mut Sink,
) -> Result<(), Aborted> {
    let uses_stock = |o: &ClOperation| follows_stock(&program.operations[o.operation]);
    let Some(last) = cl.operations.iter().rposition(uses_stock) else { return Ok(()) };
    let mut field = field(program, sink)?;
    let sectors: Vec<&[u32]> = cl.operations.iter().map(|o| &program.operations[o.operation].sectors[..]).collect();
    let mut cleared = Cleared::default();
    let mut failed = false;
    for (i, planned) in cl.operations.iter_mut().enumerate() {
        let operation = &program.operations[planned.operation];
        let direct = DirectLinks::new(program, obstacles, operation);
        let like = LikeSectors::new(program, &sectors[..=i]);
        cleared.change_tool(program.tools[operation.tool].solid.cutter_alone(0.0));
        if let Some(strategy) = operation.kind.strategy().filter(|strategy| strategy.follows_stock()) {
            let work = progress.begin(format!("{}, stock", operation.name), planned.passes.len());
            match strategy {
                RoughingStrategy::Plunge { .. } => {
                    strokes::reduce(program, operation, &direct, planned, &mut field, &work);
                    add_cuts(program, planned, &mut cleared);
                }
                RoughingStrategy::Rough { .. } => {
                    stock_order::reduce(operation, &direct, &like, planned, &mut field, &mut cleared, &work);
                }
                RoughingStrategy::Groove { .. } | RoughingStrategy::Expand { .. } => {}
            }
            unless_cancelled(progress)?;
            if planned.passes.is_empty() {
                sink.push(nothing_left(operation));
                failed |= operation.rest.is_none();
            }
            continue;
        }
        // A ball that fits nowhere on the floor has no passes.
        if let Some(thickness) = operation.rest.filter(|_| !planned.passes.is_empty()) {
            let work = progress.begin(format!("{}, find rest", operation.name), planned.passes.len());
            failed |= reduce(program, operation, thickness.get(), planned, &field, &work, sink).is_err();
            unless_cancelled(progress)?;
        }
        let cuts = i < last;
        let what = if cuts { "rest stock" } else { "links" };
        let work = progress.begin(format!("{}, {what}", operation.name), planned.passes.len());
        stock_links::add(operation, &direct, &like, planned, cuts, &mut field, &work);
        if cuts {
            add_cuts(program, planned, &mut cleared);
        }
        unless_cancelled(progress)?;
    }
    if failed { Err(Aborted) } else { Ok(()) }
}

/// Ends a run that was cancelled; nothing goes to the sink.
fn unless_cancelled(progress: &Progress) -> Result<(), Aborted> {
    if progress.is_cancelled() { Err(Aborted) } else { Ok(()) }
}

/// Adds the cuts of an operation to the space without material.
fn add_cuts(program: &Program, planned: &ClOperation, cleared: &mut Cleared) {
    for pass in &planned.passes {
        cleared.add(pass.sector, &stations(&program.machine, pass));
    }
}

/// True for operations whose passes depend on the stock that they find.
fn follows_stock(operation: &Operation) -> bool {
    operation.rest.is_some() || operation.kind.follows_stock()
}

/// Of rest machining a warning: the program changes the tool and cuts nothing.
fn nothing_left(operation: &Operation) -> Diag {
    let (new, thicker): (fn(_, _) -> Diag, _) = match operation.rest {
        Some(thickness) => (Diag::warning, format!(" thicker than {} mm", trim(thickness.get(), 3))),
        None => (Diag::error, String::new()),
    };
    let remedy = if operation.rest.is_some() { ", or give a smaller thickness after `rest over`" } else { "" };
    new(planning::NO_REST, format!("`{}` finds no stock{thicker} to cut", operation.name))
        .label(operation.span, "this operation has nothing to cut")
        .note("earlier operations have already cut all its passes")
        .help(format!("remove the operation{remedy}"))
}

/// The stock before the first operation, with cells for the operation that needs the smallest.
fn field(program: &Program, sink: &mut Sink) -> Result<Field, Aborted> {
    let outlet = program.part.hub.meridian(1.0).point.x;
    let most_rough = (MAX_ROUGH_CELL_MM * (outlet / USUAL_RADIUS_MM).max(1.0)).min(MAX_CELL_MM);
    let cells = program.operations.iter().filter_map(|(_, o)| {
        let cutter = &program.tools[o.tool].solid;
        let most = match o.kind.strategy() {
            Some(RoughingStrategy::Rough { .. }) => most_rough,
            Some(RoughingStrategy::Plunge { stepover }) => most_rough.min(CELL_PER_STEP * stepover.get()),
            Some(RoughingStrategy::Groove { .. } | RoughingStrategy::Expand { .. }) | None => MAX_CELL_MM,
        };
        // The error between the rays is an eighth of the thickness that a loop takes: a loop that is not seen is left out.
        let thinnest = [o.rest.map(|t| t.get()), spacing::loop_distance(program, o).map(|d| 0.25 * d)];
        let seen = |t: f64| (2.0 * rounding(cutter) * t).sqrt();
        let cell = thinnest.into_iter().flatten().map(seen).fold(most, f64::min);
        follows_stock(o).then_some((cell, o))
    });
    let (cell, operation) = cells.min_by(|a, b| a.0.total_cmp(&b.0)).ok_or(Aborted)?;
    program.stock.field(cell.min(MAX_CELL_MM)).map_err(|error| {
        let reason = match error {
            FieldError::TooFine { rays, least_cell } => {
                format!("cells of {cell:.3} mm need {rays:.1e} rays; on this stock {least_cell:.3} mm are possible")
            }
            FieldError::BadCell | FieldError::BadProfile => "the stock has no inside".to_owned(),
            FieldError::Crowded => "its file has too many surfaces behind one another".to_owned(),
        };
        sink.push(
            Diag::error(
                planning::REST_TOO_FINE,
                format!("the rest stock before `{}` cannot be simulated with the required cells", operation.name),
            )
            .label(operation.span, "rest machining required here")
            .note(reason)
            .help("use a larger thickness after `rest over`, or remove `rest`"),
        );
        Aborted
    })
}

/// For each step of passes whether stock lies deeper than the thickness inside of a tool. `work` counts passes.
fn find_rest(
    field: &Field,
    solid: &ToolSolid,
    steps: impl Iterator<Item = (usize, Step)>,
    thickness: f64,
    work: &Work,
) -> Vec<bool> {
    let mut deep = Vec::new();
    work.in_pieces(
        steps,
        PIECE,
        |(pass, _)| *pass,
        |piece| {
            let steps: Vec<Step> = piece.into_iter().map(|(_, step)| step).collect();
            deep.extend(stock::depths(field, solid, &steps, thickness).iter().map(|d| d.cutter > thickness));
        },
    );
    deep
}

/// Reduces an operation to the parts that cut.
fn reduce(
    program: &Program,
    operation: &Operation,
    thickness: f64,
    planned: &mut ClOperation,
    field: &Field,
    work: &Work,
    sink: &mut Sink,
) -> Result<(), Aborted> {
    let solid = &program.tools[operation.tool].solid;
    let grown_by = error_between_rays(field, solid);
    let grown = solid.cutter_alone(grown_by);
    let steps = steps(&program.machine, &planned.passes, StepKind::Rapid, grown_by);
    let deep = find_rest(field, &grown, steps, thickness, work);
    if work.is_cancelled() {
        return Err(Aborted);
    }
    let limits =
        PassLimits { operation, whole: !leaves_along_axis(solid), surface: ClearanceSurface::new(program, solid) };
    let (mut kept, mut before, mut length) = (Vec::new(), 0, [0.0; 2]);
    for pass in &planned.passes {
        let stations = stations(&program.machine, pass);
        let steps = stations.len().saturating_sub(1);
        let runs = limits.runs(&stations, &deep[before..before + steps]);
        before += steps;
        length[0] += runs.iter().map(|r| path_length(&stations[r.start..=r.end])).sum::<f64>();
        length[1] += path_length(&stations);
        let several = runs.len() > 1;
        for (k, run) in runs.into_iter().enumerate() {
            let label = if several { format!("{} rest {}", pass.label, k + 1) } else { pass.label.clone() };
            let inside = stations[run.start..=run.end].iter().enumerate();
            let ends = inside.filter(|(i, s)| s.planned || *i == 0 || *i == run.end - run.start);
            let points = ends.map(|(_, s)| s.point).collect();
            kept.push(ClPass { label, sector: pass.sector, points, air: Vec::new(), link: None });
        }
    }
    if kept.is_empty() {
        sink.push(nothing_left(operation));
    }
    planned.notes.push(format!(
        "rest machining over {} mm: {:.0} of {:.0} mm cut, in {} passes of {}; stock in cells of {:.2} mm",
        trim(thickness, 3),
        length[0],
        length[1],
        kept.len(),
        planned.passes.len(),
        field.cell()
    ));
    planned.passes = kept;
    Ok(())
}

/// Where the tool may leave and enter a pass.
struct PassLimits<'a> {
    operation: &'a Operation,
    /// True when the tool may leave a pass only at its ends.
    whole: bool,
    surface: ClearanceSurface<'a>,
}

impl PassLimits<'_> {
    /// Parts of a pass that remain, by their first and last station; `cuts` is true for each step that cuts.
    fn runs(&self, stations: &[PathPoint], cuts: &[bool]) -> Vec<Range<usize>> {
        let last = cuts.len();
        if self.whole {
            return if cuts.contains(&true) { std::iter::once(0..last).collect() } else { Vec::new() };
        }
        let mut runs: Vec<Range<usize>> = Vec::new();
        for n in (0..last).filter(|n| cuts[*n]) {
            let (mut start, mut end) = (n, n + 1);
            let step = |n: usize| (stations[n + 1].point.tip - stations[n].point.tip).norm();
            let mut lead = 0.0;
            while start > 0 && lead < self.operation.lead_in.get() {
                start -= 1;
                lead += step(start);
            }
            lead = 0.0;
            while end < last && lead < self.operation.lead_out.get() {
                lead += step(end);
                end += 1;
            }
            match runs.last_mut() {
                Some(run) if run.end >= start || !self.pays(stations, run.end..start) => run.end = end,
                _ => runs.push(start..end),
            }
        }
        runs
    }

    /// True when the link over the clearance surface takes less time than the cut between two stations.
    fn pays(&self, stations: &[PathPoint], gap: Range<usize>) -> bool {
        let (from, to) = (&stations[gap.start].point, &stations[gap.end].point);
        self.surface.time(from, to, self.operation.link_feed.get())
            < path_length(&stations[gap.start..=gap.end]) / (self.operation.feed.get() / 60.0)
    }
}
