//! The order of the passes, with a reason a line.

use super::layers::Roughing;
use super::{
    Obstacles, assign_feeds, avoid_collision, copy_sectors, exact_stops, link_moves, orient_tool, plan_channel, plan_expand,
    plan_flank, plan_groove, plan_point, rest_machining, sample_to_tolerance, smooth_axis, solve_kinematics,
    time_feeds,
};
use crate::analysis::cost::{self, Stations};
use crate::diag::{Aborted, Diag, Sink, codes::files, codes::planning};
use crate::ir::validate::{self, ClStage, Malformed};
use crate::ir::{CcPlan, ClPlan, Motion, Operation, OperationKind, Program};
use crate::part::sample;
use crate::progress::Progress;
use crate::units;

/// What a pass may look at, and where it reports.
pub(super) struct PassContext<'a> {
    pub(super) program: &'a Program,
    pub(super) obstacles: &'a Obstacles,
    pub(super) progress: &'a Progress,
    pub(super) sink: &'a mut Sink,
    /// Stations that are planned so far.
    stations: Stations,
}

impl<'a> PassContext<'a> {
    /// Refuses to go on from a malformed value: asked after every pass in debug builds, and so in tests.
    fn holds(&mut self, pass: &str, validate: impl FnOnce(&Program) -> Result<(), Malformed>) -> Result<(), Aborted> {
        if !cfg!(debug_assertions) {
            return Ok(());
        }
        validate(self.program).map_err(|malformed| {
            self.sink.push(
                Diag::error(files::INTERNAL, format!("`{pass}` made a malformed value: {malformed}"))
                    .note("this is a fault of the compiler, not of the job")
                    .help("report the job file"),
            );
            Aborted
        })
    }

    /// Room finder of a roughing operation.
    pub(super) fn roughing(&mut self, operation: &Operation) -> Result<Roughing<'a>, Aborted> {
        let roughing = Roughing::new(self.program, operation, self.obstacles);
        if let Some(roughing) = &roughing {
            // A layer takes some ten thousand looks at the part: as long as that many points.
            check_looks(self, operation, roughing.layer_count(1.0) * LOOKS_PER_LAYER)?;
        }
        roughing.ok_or_else(|| {
            self.sink.push(Diag::error(
                planning::NO_ROOM,
                format!("`{}` has no layers: it is no roughing operation", operation.name),
            ));
            Aborted
        })
    }
}

/// Distance queries that measuring a layer takes.
const LOOKS_PER_LAYER: f64 = 1e4;

/// Values of the planning stages.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Contact or drive points.
    pub cc: CcPlan,
    /// Cutter locations with links and feeds.
    pub cl: ClPlan,
    /// Joint motion.
    pub motion: Motion,
}

/// Runs all passes.
///
/// # Errors
/// Any pass that cannot do its work; all operations are tried before giving up, and the reasons are in the sink.
pub fn run(program: &Program, sink: &mut Sink) -> Result<Plan, Aborted> {
    run_with(program, &Progress::default(), sink)
}

/// [`run`], telling how far it is.
///
/// # Errors
/// As [`run`].
pub fn run_with(program: &Program, progress: &Progress, sink: &mut Sink) -> Result<Plan, Aborted> {
    check_size(program, sink)?;
    let obstacles = Obstacles::new(&program.part, &program.machine);
    let mut cx = PassContext { program, obstacles: &obstacles, progress, sink, stations: Stations::default() };
    cx.holds("lower", validate::program)?;
    // Contacts on drive surfaces, operation by operation: roughing first, since each knows how far those before it came.
    let cc = plan(&mut cx)?;
    cx.holds("plan", |program| validate::cc(program, &cc))?;
    let mut cl = orient_tool::run(&mut cx, &cc)?;
    cx.holds("orient-tool", |program| validate::cl(program, &cl, ClStage::Oriented))?;
    // Axes move while all stations are there: thinning and links need the last ones.
    avoid_collision::run(&mut cx, &cc, &mut cl)?;
    cx.holds("avoid-collision", |program| validate::cl(program, &cl, ClStage::Oriented))?;
    smooth_axis::run(&mut cx, &cc, &mut cl)?;
    cx.holds("smooth-axis", |program| validate::cl(program, &cl, ClStage::Oriented))?;
    sample_to_tolerance::run(&cx, &mut cl);
    cx.holds("sample-to-tolerance", |program| validate::cl(program, &cl, ClStage::Oriented))?;
    copy_sectors::run(program, &mut cl);
    cx.holds("copy-sectors", |program| validate::cl(program, &cl, ClStage::InSectors))?;
    // What cuts nothing goes before its ends are linked.
    rest_machining::run(program, &mut cl, cx.progress, cx.sink)?;
    cx.holds("rest-machining", |program| validate::cl(program, &cl, ClStage::InSectors))?;
    link_moves::run(&mut cx, &mut cl)?;
    cx.holds("link-moves", |program| validate::cl(program, &cl, ClStage::Linked))?;
    let needed = cost::of_moves(program, &cl, cx.stations.planned);
    check_memory(&mut cx, None, needed)?;
    assign_feeds::run(program, &mut cl);
    cx.holds("assign-feeds", |program| validate::cl(program, &cl, ClStage::Fed))?;
    let mut motion = solve_kinematics::run(&mut cx, &cl)?;
    cx.holds("solve-kinematics", |program| validate::motion(program, &motion))?;
    time_feeds::run(program, &mut motion);
    cx.holds("time-feeds", |program| validate::motion(program, &motion))?;
    // Where the control leaves the path depends on the speeds of all moves.
    exact_stops::run(program, &mut motion);
    cx.holds("exact-stops", |program| validate::motion(program, &motion))?;
    Ok(Plan { cc, cl, motion })
}

/// Refuses parts that cannot be sampled.
fn check_size(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    let samples = sample::estimate(&program.part, FINEST_SPACING);
    if samples <= sample::MOST_SAMPLES {
        return Ok(());
    }
    let outlet = program.part.hub.meridian(1.0).point.x;
    sink.push(
        Diag::error(
            planning::TOO_LARGE,
            format!(
                "a part of {outlet:.0} mm radius needs {samples:.1e} samples; at most {:.1e} are made",
                sample::MOST_SAMPLES
            ),
        )
        .help("check the units of the points"),
    );
    Err(Aborted)
}

/// Spacing of the samples that verification will need, mm.
const FINEST_SPACING: f64 = 0.25;

/// Refuses an operation whose plan would have more points in a sector than memory may hold beside those before it. The estimate before
/// planning knows sizes of the part only; this knows the lines.
pub(super) fn check_points(cx: &mut PassContext<'_>, operation: &Operation, points: f64) -> Result<(), Aborted> {
    let needed = cost::of_stations(cx.program, cx.stations.and(points, operation));
    check_memory(cx, Some(operation), needed)
}

/// Refuses a plan that needs more memory than it may take, bytes; `operation` is the one that is planned.
fn check_memory(cx: &mut PassContext<'_>, operation: Option<&Operation>, needed: f64) -> Result<(), Aborted> {
    if needed <= cx.program.memory {
        return Ok(());
    }
    let (needed, most) = (units::bytes(needed), units::bytes(cx.program.memory));
    let mut diag = Diag::error(planning::OVER_MEMORY, format!("the plan needs about {needed}; it may take {most}"));
    if let Some(operation) = operation {
        diag = diag.label(operation.span, "planned up to this operation");
    }
    let help =
        "a bigger `depth`, `residual` or `scallop`, fewer `sectors` or operations a job; or allow more: `--memory`";
    cx.sink.push(diag.help(help));
    Err(Aborted)
}

/// Most looks at the part that the layers of one operation take: some minutes.
const MOST_LOOKS: f64 = 2e7;

/// Refuses an operation whose layers would take too many looks at the part.
fn check_looks(cx: &mut PassContext<'_>, operation: &Operation, looks: f64) -> Result<(), Aborted> {
    if looks <= MOST_LOOKS {
        return Ok(());
    }
    cx.sink.push(
        Diag::error(
            planning::TOO_FINE,
            format!(
                "the layers of `{}` take {looks:.1e} looks at the part; at most {MOST_LOOKS:.1e} are made",
                operation.name
            ),
        )
        .label(operation.span, "this operation steps too finely")
        .help("a bigger `depth`"),
    );
    Err(Aborted)
}

/// Refuses a ball that is bigger than the fillet in which it is to roll, or beside which it is to stand; says why on the
/// operation and on its tool.
pub(super) fn check_fillet(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    [at_operation, at_tool]: [&str; 2],
) -> Result<(), Aborted> {
    let tool = &cx.program.tools[operation.tool];
    let radius = tool.solid.cutter.tip_radius();
    let Some(fillet) = cx.program.part.main().fillet.filter(|f| radius > f.get() + 1e-9) else { return Ok(()) };
    cx.sink.push(
        Diag::error(
            planning::BALL_TOO_BIG,
            format!("the ball of {} (radius {radius} mm) is bigger than the fillet ({fillet})", tool.name),
        )
        .label(operation.span, at_operation)
        .label(tool.span, at_tool)
        .help(format!("take a ball of at most {} mm diameter, or declare the bigger fillet", 2.0 * fillet.get())),
    );
    Err(Aborted)
}

/// The `plan-*` passes, in the order of the operations. Roughing goes on from the level that earlier roughing of the
/// same kind reached.
fn plan(cx: &mut PassContext<'_>) -> Result<CcPlan, Aborted> {
    let (mut groove_level, mut expand_level) = (1.0, 1.0);
    let mut cc = CcPlan::default();
    let mut failed = false;
    for (id, operation) in cx.program.operations.iter() {
        let planned = match operation.kind {
            OperationKind::Groove { .. } => plan_groove::plan(cx, id, operation, groove_level).map(|(plan, level)| {
                groove_level = level;
                plan
            }),
            OperationKind::Expand { .. } => plan_expand::plan(cx, id, operation, expand_level).map(|(plan, level)| {
                expand_level = level;
                plan
            }),
            OperationKind::Flank { .. } => plan_flank::plan(cx, id, operation),
            OperationKind::Point { .. } => plan_point::plan(cx, id, operation),
            OperationKind::Channel { .. } => plan_channel::plan(cx, id, operation),
        };
        match planned {
            Ok(plan) => {
                let points = plan.passes.iter().map(|p| p.points.len()).sum::<usize>() as f64;
                cx.stations = cx.stations.and(points, operation);
                cc.operations.push(plan);
                // Each operation alone may fit; together they may not, and no further one will.
                if check_points(cx, operation, 0.0).is_err() {
                    return Err(Aborted);
                }
            }
            Err(Aborted) => failed = true,
        }
    }
    if failed { Err(Aborted) } else { Ok(cc) }
}
