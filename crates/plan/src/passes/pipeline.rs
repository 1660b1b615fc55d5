//! The order of the passes, with the reason for each place.

use super::axis::{avoid_collision, clear_floor, orient_tool, smooth_axis};
use super::channel::middle::Middles;
use super::context::{Obstacles, PassContext};
use super::feed::{equal_sectors, exact_stops, removal_feeds, time_feeds};
use super::link::{fast_leads, first_travel, link_moves, rest_machining};
use super::rough::{Roughings, channel_levels, expand, groove, plunge, roughings, short_reach};
use super::{channel, copy_sectors, fit_splines, flank, point, round_to_words, sample_to_tolerance};
use crate::budget::{self, Stations};
use base::progress::Progress;
use diagnostics::codes::planning::NO_REST;
use diagnostics::{Aborted, Diag, Sink};
use ir::stage_file::{PlannedMotion, StageValue};
use ir::validate::{self, ClStage};
use ir::{CcOperation, CcPlan, ClOperation, ClPlan, Motion, OperationId, OperationKind, Program, RoughingStrategy};

/// Values of the planning stages. Those before the start of a run ([`run_from`]) are empty.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Contact or drive points.
    pub cc: CcPlan,
    /// Cutter locations of all passes; of a run that starts at the motion only the notes.
    pub cl: ClPlan,
    /// Joint motion.
    pub motion: Motion,
}

/// Runs all passes.
///
/// # Errors
/// A pass that fails, after the plans of all operations were tried: the sink has the reasons. Or the run was cancelled: then it
/// has none.
pub fn run(program: &Program, sink: &mut Sink) -> Result<Plan, Aborted> {
    run_with(program, &Progress::default(), sink)
}

/// [`run`] with reports of progress.
///
/// # Errors
/// As [`run`].
pub fn run_with(program: &Program, progress: &Progress, sink: &mut Sink) -> Result<Plan, Aborted> {
    run_from(program, StageValue::Ir, progress, sink)
}

/// [`run_with`] from the value of a stage on, with the same result as a run that makes this value.
///
/// # Errors
/// As [`run`].
pub fn run_from(program: &Program, start: StageValue, progress: &Progress, sink: &mut Sink) -> Result<Plan, Aborted> {
    budget::check_size(program, sink)?;
    let obstacles = progress.span("obstacles", || Obstacles::of(program));
    let mut cx = PassContext { program, obstacles: &obstacles, progress, sink, stations: Stations::default() };
    cx.holds("lower", validate::program)?;
    let (cc, cl) = match start {
        StageValue::Ir => {
            let cc = contacts(&mut cx)?;
            let cl = locations(&mut cx, &cc)?;
            (cc, cl)
        }
        StageValue::Cc(cc) => {
            for planned in &cc.operations {
                count(&mut cx, planned)?;
            }
            let cl = locations(&mut cx, &cc)?;
            (cc, cl)
        }
        StageValue::Cl(cl) => (CcPlan::default(), cl),
        StageValue::Motion(PlannedMotion { motion, notes }) => {
            let operations = motion.operations.iter().map(|o| o.operation).zip(notes);
            let with_notes = |(operation, notes)| ClOperation { operation, passes: Vec::new(), notes };
            let cl = ClPlan { operations: operations.map(with_notes).collect() };
            return Ok(Plan { cc: CcPlan::default(), cl, motion });
        }
    };
    let motion = moves(&mut cx, &cl)?;
    Ok(Plan { cc, cl, motion })
}

/// Contacts on drive surfaces, operation by operation.
fn contacts(cx: &mut PassContext<'_>) -> Result<CcPlan, Aborted> {
    let roughings = cx.pass("levels of roughing", |cx| roughings(cx))?;
    // Tools that are too short are reported before their levels are planned without the floor.
    cx.pass("short-reach", |cx| short_reach::check(cx, &roughings))?;
    // Smaller balls of the floor finish what larger ones cannot.
    let middles = cx.pass("clear-floor", |cx| clear_floor::run(cx))?;
    // Roughing comes first, since each roughing starts at the level that the one before reached.
    let cc = plan(cx, &roughings, &middles)?;
    cx.holds("plan", |program| validate::cc(program, &cc))?;
    Ok(cc)
}

/// Plans the contacts and tool axes of all operations in one sector, and nothing else: a trial of what has no answer there. What has
/// one may still be refused by links, by limits of the machine, or by the verifier.
///
/// # Errors
/// As [`run`].
pub fn axes(program: &Program, progress: &Progress, sink: &mut Sink) -> Result<(), Aborted> {
    budget::check_size(program, sink)?;
    let obstacles = Obstacles::of(program);
    let mut cx = PassContext { program, obstacles: &obstacles, progress, sink, stations: Stations::default() };
    cx.holds("lower", validate::program)?;
    let cc = contacts(&mut cx)?;
    smooth_axes(&mut cx, &cc).map(|_| ())
}

/// Plans all operations as far as the stock that each finds, and tells those of rest machining that find nothing to cut. They change
/// nothing for the others.
///
/// # Errors
/// As [`run`].
pub fn needless(program: &Program, progress: &Progress, sink: &mut Sink) -> Result<Vec<OperationId>, Aborted> {
    budget::check_size(program, sink)?;
    let obstacles = Obstacles::of(program);
    let mut found = Sink::default();
    let mut cx =
        PassContext { program, obstacles: &obstacles, progress, sink: &mut found, stations: Stations::default() };
    let planned = contacts(&mut cx).and_then(|cc| locations(&mut cx, &cc));
    if planned.is_err() {
        sink.append(found);
        return Err(Aborted);
    }
    let idle = found.diags().iter().filter(|diag| diag.code == NO_REST);
    let place = |diag: &Diag| diag.labels.first().map(|label| label.span);
    let of = |diag: &Diag| program.operations.iter().find(|(_, o)| Some(o.span) == place(diag)).map(|(id, _)| id);
    Ok(idle.filter_map(of).collect())
}

/// Tool positions at the contacts with smooth axes, in one sector.
fn smooth_axes(cx: &mut PassContext<'_>, cc: &CcPlan) -> Result<ClPlan, Aborted> {
    let mut cl = cx.pass("orient-tool", |cx| orient_tool::run(cx, cc))?;
    cx.holds("orient-tool", |program| validate::cl(program, &cl, ClStage::Oriented))?;
    // A machine that is too small is reported before the axes of finishing are planned.
    cx.pass("first-travel", |cx| first_travel::check(cx, &cl))?;
    // Collision avoidance and smoothing need all stations; thinning and links need the final axes.
    cx.pass("avoid-collision", |cx| avoid_collision::run(cx, short_reach::refusal, cc, &mut cl))?;
    cx.holds("avoid-collision", |program| validate::cl(program, &cl, ClStage::Oriented))?;
    cx.pass("smooth-axis", |cx| smooth_axis::run(cx, cc, &mut cl))?;
    cx.holds("smooth-axis", |program| validate::cl(program, &cl, ClStage::Oriented))?;
    Ok(cl)
}

/// Tool positions at the contacts, in all sectors.
fn locations(cx: &mut PassContext<'_>, cc: &CcPlan) -> Result<ClPlan, Aborted> {
    let mut cl = smooth_axes(cx, cc)?;
    cx.pass("sample-to-tolerance", |cx| sample_to_tolerance::run(cx, &mut cl));
    cx.holds("sample-to-tolerance", |program| validate::cl(program, &cl, ClStage::Oriented))?;
    // The blank is the same in all sectors.
    cx.pass("fast-leads", |cx| fast_leads::run(cx.program, &mut cl));
    cx.holds("fast-leads", |program| validate::cl(program, &cl, ClStage::Oriented))?;
    cx.pass("copy-sectors", |cx| copy_sectors::run(cx.program, &mut cl));
    cx.holds("copy-sectors", |program| validate::cl(program, &cl, ClStage::InSectors))?;
    // Passes that cut nothing are removed before links are made.
    cx.pass("rest-machining", |cx| rest_machining::run(cx.program, cx.obstacles, &mut cl, cx.progress, cx.sink))?;
    cx.holds("rest-machining", |program| validate::cl(program, &cl, ClStage::InSectors))?;
    Ok(cl)
}

/// Moves of the machine through the tool positions.
fn moves(cx: &mut PassContext<'_>, cl: &ClPlan) -> Result<Motion, Aborted> {
    let (program, progress) = (cx.program, cx.progress);
    let mut motion = cx.pass("link-moves", |cx| link_moves::run(cx, cl))?;
    cx.holds("link-moves", |program| validate::motion(program, &motion))?;
    // Splines go through the ends of moves as they are before rounding.
    cx.pass("fit-splines", |cx| fit_splines::run(cx, &mut motion));
    cx.holds("fit-splines", |program| validate::motion(program, &motion))?;
    // What follows counts with the moves that the text says.
    cx.pass("round-to-words", |_| round_to_words::run(program, progress, &mut motion));
    cx.holds("round-to-words", |program| validate::motion(program, &motion))?;
    budget::check_motion(program, &motion, cx.stations.planned, cx.sink)?;
    // Times follow from feeds that tool and spindle can take.
    cx.pass("removal-feeds", |cx| removal_feeds::run(program, &mut motion, progress, cx.sink))?;
    cx.holds("removal-feeds", |program| validate::motion(program, &motion))?;
    cx.pass("time-feeds", |_| time_feeds::run(program, progress, &mut motion));
    cx.holds("time-feeds", |program| validate::motion(program, &motion))?;
    cx.pass("equal-sectors", |_| equal_sectors::feeds(program, &mut motion));
    cx.holds("equal-sectors", |program| validate::motion(program, &motion))?;
    // The deviation of the control from the path depends on the speeds of all moves.
    cx.pass("exact-stops", |_| exact_stops::run(program, progress, &mut motion));
    cx.holds("exact-stops", |program| validate::motion(program, &motion))?;
    cx.pass("equal-sectors", |_| equal_sectors::stops(program, &mut motion));
    Ok(motion)
}

/// Counts the stations of an operation. Each operation may fit into the memory alone, but not all together.
fn count(cx: &mut PassContext<'_>, planned: &CcOperation) -> Result<(), Aborted> {
    let operation = &cx.program.operations[planned.operation];
    let points = planned.passes.iter().map(|p| p.points.len()).sum::<usize>() as f64;
    cx.stations = cx.stations.and(points, operation);
    cx.check_points(operation, 0.0)
}

/// The `plan-*` passes, in the order of the operations. Roughing starts at the level that earlier roughing of the same
/// kind reached.
fn plan(cx: &mut PassContext<'_>, roughings: &Roughings<'_>, middles: &Middles<'_>) -> Result<CcPlan, Aborted> {
    let passages = cx.program.part.passages().count();
    let [mut groove_levels, mut expand_levels] = [1.0, 1.0].map(|shroud| vec![shroud; passages]);
    let mut cc = CcPlan::default();
    let mut failed = false;
    for (id, operation) in cx.program.operations.iter() {
        cx.go_on()?;
        let planned = match operation.kind {
            OperationKind::Roughing { strategy, .. } => cx.pass("plan roughing", |cx| match strategy {
                RoughingStrategy::Groove { .. } => groove::plan(cx, roughings, id, &mut groove_levels),
                RoughingStrategy::Expand { residual, .. } => {
                    expand::plan(cx, roughings, id, residual, &mut expand_levels)
                }
                RoughingStrategy::Rough { .. } => channel_levels::plan(cx, roughings, id),
                RoughingStrategy::Plunge { stepover } => plunge::plan(cx, id, stepover),
            }),
            OperationKind::Flank { .. } => cx.pass("plan flank", |cx| flank::plan::plan(cx, id)),
            OperationKind::Point { .. } => cx.pass("plan point", |cx| point::plan::plan(cx, id)),
            OperationKind::Channel { .. } => cx.pass("plan channel", |cx| channel::plan::plan(cx, id, middles)),
        };
        match planned {
            Ok(plan) => {
                // Where one does not fit, no later operation will.
                count(cx, &plan)?;
                cc.operations.push(plan);
            }
            Err(Aborted) => failed = true,
        }
    }
    if failed { Err(Aborted) } else { Ok(cc) }
}
