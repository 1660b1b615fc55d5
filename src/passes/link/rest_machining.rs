//! `rest-machining`: removes cuts that would take nothing off the stock of earlier operations.
//!
//! Before: the paths that the machine will interpolate, pass by pass. After: an operation with rest machining keeps
//! only the parts of its passes on which the cutter meets stock deeper than the thickness of the job, each with its
//! leads; `link-moves` connects them. The stock of this pass comes from the planned cuts of earlier operations without
//! links. It may therefore be larger than the true stock, never smaller. It serves planning only; the verifier computes
//! its own.
//!
//! Between the rays of the stock the surface is unknown. Where a rounding of radius R dips by t into the stock, the
//! chip is 2 sqrt(2 R t) wide. Half a diagonal of a cell h beside the deepest place, the depth is less by h^2 / 4R.
//! Cells are so small that this error is at most half of the thickness, and the cutter is enlarged by it before the
//! query. A needle or an edge of stock narrower than a cell may still stand between the rays; contracts on excess and
//! rest judge what is left.

use super::clearance_sphere::ClearanceSphere;
use crate::collide::{Cutter, ToolSolid};
use crate::diag::{Aborted, Diag, Sink, codes::planning};
use crate::ir::{ClOperation, ClPass, ClPlan, ClPoint, Operation, Program};
use crate::kin::{Angles, Machine, between};
use crate::progress::{Progress, Work};
use crate::stock::{self, Collision, Field, FieldError, Step, StepKind, Touched};
use crate::units::trim;
use std::ops::Range;

/// Largest cell, mm, where a thick rest would allow larger ones: the cell of the usual verification.
const MOST_CELL: f64 = 1.0;

/// Longest tip motion in a step, mm; passes are cut to this accuracy.
const STEP_LENGTH: f64 = 1.0;

/// Largest turn of a step, radians; limits the motion at the top of a cutter.
const STEP_TURN: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// Steps between two updates of the progress.
const PIECE: usize = 1 << 11;

/// Thins the passes of all operations with rest machining.
///
/// # Errors
/// An operation with nothing left to cut; a thickness that would need too small cells. The sink holds the reasons.
pub fn run(program: &Program, cl: &mut ClPlan, progress: &Progress, sink: &mut Sink) -> Result<(), Aborted> {
    let asks = |o: &ClOperation| program.operations[o.operation].rest.is_some();
    let Some(last) = cl.operations.iter().rposition(asks) else { return Ok(()) };
    let mut field = field(program, sink)?;
    let mut failed = false;
    for (i, planned) in cl.operations.iter_mut().enumerate().take(last + 1) {
        let operation = &program.operations[planned.operation];
        if let Some(thickness) = operation.rest {
            let work = progress.begin(format!("{}, find rest", operation.name), planned.passes.len());
            failed |= reduce(program, operation, thickness.get(), planned, (&mut field, &work), sink).is_err();
        }
        if i < last {
            let work = progress.begin(format!("{}, rest stock", operation.name), planned.passes.len());
            cut(program, operation, planned, &mut field, &work);
        }
    }
    if failed { Err(Aborted) } else { Ok(()) }
}

/// The blank, with cells for the operation that needs the smallest.
fn field(program: &Program, sink: &mut Sink) -> Result<Field, Aborted> {
    let asked = program.operations.iter().filter_map(|(_, o)| {
        let cutter = &program.tools[o.tool].solid;
        o.rest.map(|t| ((2.0 * rounding(cutter) * t.get()).sqrt(), o))
    });
    let (cell, operation) = asked.min_by(|a, b| a.0.total_cmp(&b.0)).ok_or(Aborted)?;
    Field::turned(&program.stock.profile, cell.min(MOST_CELL)).map_err(|error| {
        let reason = match error {
            FieldError::TooFine { rays, least_cell } => {
                format!("cells of {cell:.3} mm need {rays:.1e} rays; on this stock {least_cell:.3} mm are possible")
            }
            FieldError::BadCell | FieldError::BadProfile => "the stock has no inside".to_owned(),
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

/// Radius of the rounding with which a cutter dips into a surface; for a flat cutter the radius of its side.
fn rounding(solid: &ToolSolid) -> f64 {
    let tip = solid.cutter.tip_radius();
    if tip > 0.0 { tip } else { solid.radius() }
}

/// Removes the cuts of an operation from the stock.
fn cut(program: &Program, operation: &Operation, planned: &ClOperation, field: &mut Field, work: &Work) {
    let solid = cutter_alone(&program.tools[operation.tool].solid, 0.0);
    send(field, &solid, steps(&program.machine, &planned.passes, StepKind::Cut, 0.0), work);
}

/// Sends a tool through the stock; returns its collisions. `work` counts passes.
fn send(
    field: &mut Field,
    solid: &ToolSolid,
    steps: impl Iterator<Item = (usize, Step)>,
    work: &Work,
) -> Vec<Collision> {
    let mut met = Vec::new();
    work.in_pieces(
        steps,
        PIECE,
        |(pass, _)| *pass,
        |piece| met.extend(stock::simulate(field, solid, piece.into_iter().map(|(_, step)| step)).collisions),
    );
    met
}

/// The cutter without shank and holder, enlarged on all sides.
fn cutter_alone(solid: &ToolSolid, by: f64) -> ToolSolid {
    let cutter = match solid.cutter {
        Cutter::Flat { radius } => Cutter::Flat { radius: radius + by },
        Cutter::Ball { radius } => Cutter::Ball { radius: radius + by },
        Cutter::Bull { radius, corner } => Cutter::Bull { radius: radius + by, corner: corner + by },
        Cutter::TaperedBall { ball, half_angle } => Cutter::TaperedBall { ball: ball + by, half_angle },
        Cutter::Barrel { radius, barrel, tip } => {
            Cutter::Barrel { radius: radius + by, barrel: barrel + by, tip: tip + by }
        }
        Cutter::Lollipop { radius } => Cutter::Lollipop { radius: radius + by },
    };
    ToolSolid { cutter, flute_length: solid.flute_length + 2.0 * by, shank: Vec::new(), holder: Vec::new() }
}

/// A place on a pass, with rotary angles that do not jump.
#[derive(Clone, Copy)]
struct PathPoint {
    point: ClPoint,
    rotary: Angles,
    /// False for stations inserted between the planned ones.
    planned: bool,
}

/// Stations of a pass, dense enough that two of them bound a step of the stock. Between planned stations the machine
/// moves the tip straight and both rotary angles evenly.
fn stations(machine: &Machine, pass: &ClPass) -> Vec<PathPoint> {
    let mut found: Vec<PathPoint> = Vec::with_capacity(pass.points.len());
    for point in &pass.points {
        let before = found.last().map_or(0.0, |s| s.rotary[1]);
        let to = PathPoint { point: *point, rotary: machine.chain.unwound(&point.axis, 0, before), planned: true };
        if let Some(from) = found.last().copied() {
            let way = to.point.tip - from.point.tip;
            let turn = machine.turn(from.rotary, to.rotary);
            let count = (turn / STEP_TURN).max(way.norm() / STEP_LENGTH).ceil().max(1.0);
            found.extend((1..count as usize).map(|k| {
                let t = k as f64 / count;
                let rotary = between(from.rotary, to.rotary, t);
                let axis = machine.chain.tool_axis(rotary);
                let point = ClPoint { tip: from.point.tip + way * t, axis, contact: None };
                PathPoint { point, rotary, planned: false }
            }));
        }
        found.push(to);
    }
    found
}

/// The numbered steps of passes, each with the index of its pass, for a cutter whose tip is lower on its axis by
/// `lowered`.
fn steps<'a>(
    machine: &'a Machine,
    passes: &'a [ClPass],
    kind: StepKind,
    lowered: f64,
) -> impl Iterator<Item = (usize, Step)> + 'a {
    passes
        .iter()
        .enumerate()
        .flat_map(move |(i, pass)| {
            let stations = stations(machine, pass);
            let pairs: Vec<(usize, [PathPoint; 2])> = stations.windows(2).map(|w| (i, [w[0], w[1]])).collect();
            pairs
        })
        .enumerate()
        .map(move |(n, (pass, [from, to]))| {
            let axes = [0.0, 0.5, 1.0].map(|t| machine.chain.tool_axis(between(from.rotary, to.rotary, t)));
            let tips = [from.point.tip - axes[0] * lowered, to.point.tip - axes[2] * lowered];
            (pass, Step { block: u32::try_from(n).unwrap_or(u32::MAX), kind, tips, axes })
        })
}

/// Reduces an operation to the parts that cut.
fn reduce(
    program: &Program,
    operation: &Operation,
    thickness: f64,
    planned: &mut ClOperation,
    (field, work): (&mut Field, &Work),
    sink: &mut Sink,
) -> Result<(), Aborted> {
    let solid = &program.tools[operation.tool].solid;
    let grown_by = field.cell() * field.cell() / (4.0 * rounding(solid));
    let grown = cutter_alone(solid, grown_by);
    // For a rapid, the engine reports what the cutter meets and removes nothing.
    let looks = steps(&program.machine, &planned.passes, StepKind::Rapid, grown_by);
    let met = send(field, &grown, looks, work);
    let deep = met.iter().filter(|c| c.what == Touched::Cutter && c.depth > thickness);
    let mut deep = deep.map(|c| c.block as usize).peekable();
    let ways =
        Ways { operation, whole: !leaves_along_axis(solid), sphere: ClearanceSphere::new(program, solid), program };
    let (mut kept, mut before, mut length) = (Vec::new(), 0, [0.0; 2]);
    for pass in &planned.passes {
        let stations = stations(&program.machine, pass);
        let steps = stations.len().saturating_sub(1);
        let mut cuts = vec![false; steps];
        while let Some(n) = deep.next_if(|n| *n < before + steps) {
            cuts[n - before] = true;
        }
        before += steps;
        let runs = ways.runs(&stations, &cuts);
        length[0] += runs.iter().map(|r| way(&stations[r.start..=r.end])).sum::<f64>();
        length[1] += way(&stations);
        let several = runs.len() > 1;
        for (k, run) in runs.into_iter().enumerate() {
            let label = if several { format!("{} rest {}", pass.label, k + 1) } else { pass.label.clone() };
            let inside = stations[run.start..=run.end].iter().enumerate();
            let ends = inside.filter(|(i, s)| s.planned || *i == 0 || *i == run.end - run.start);
            kept.push(ClPass { label, sector: pass.sector, points: ends.map(|(_, s)| s.point).collect() });
        }
    }
    if kept.is_empty() {
        sink.push(
            Diag::error(
                planning::NO_REST,
                format!("`{}` finds no stock thicker than {} mm to cut", operation.name, trim(thickness, 3)),
            )
            .label(operation.span, "this operation has nothing to cut")
            .note("earlier operations have already cut all its passes")
            .help("remove the operation, or give a smaller thickness after `rest over`"),
        );
        return Err(Aborted);
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

/// True when nothing above the cutter is thinner: a tool that leaves along its axis then sweeps only the space it
/// occupies.
fn leaves_along_axis(solid: &ToolSolid) -> bool {
    let widest = solid.cutter.widest_below(solid.flute_length);
    solid.shank.iter().chain(&solid.holder).all(|s| s.radius_from.min(s.radius_to) >= widest)
}

/// Length of the path of the tip, mm.
fn way(stations: &[PathPoint]) -> f64 {
    stations.windows(2).map(|w| (w[1].point.tip - w[0].point.tip).norm()).sum()
}

/// Data for the decision where a pass is left and entered.
struct Ways<'a> {
    program: &'a Program,
    operation: &'a Operation,
    /// True when the tool may leave a pass only at its ends.
    whole: bool,
    sphere: ClearanceSphere,
}

impl Ways<'_> {
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

    /// True when the link over the clearance sphere takes less time than the cut between two stations.
    fn pays(&self, stations: &[PathPoint], gap: Range<usize>) -> bool {
        let (from, to) = (&stations[gap.start].point, &stations[gap.end].point);
        let [out, back] = [from, to].map(|p| self.sphere.exit(&p.tip, &p.axis));
        let over = self.sphere.way(&(from.tip + from.axis * out), &(to.tip + to.axis * back));
        let link = (out + back) / (self.operation.link_feed.get() / 60.0) + over / self.program.machine.rapid;
        link < way(&stations[gap.start..=gap.end]) / (self.operation.feed.get() / 60.0)
    }
}
