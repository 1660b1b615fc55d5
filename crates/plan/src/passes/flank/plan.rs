//! Plan of the operation `flank`: strips of the vane faces for the side of the cutter (Wei 3.2).
//!
//! Before: an operation. After: per face and strip a pass along the face, in the direction that belongs to the sense of
//! milling, from the strip at the shroud to the strip at the root; face by face, or level by level on both faces. The
//! lowest strip ends where the ball of the tool, which rolls in the fillet, touches the face.
//! `minimax` also finds the path of the tool axis, since contacts and axis together determine the error of the face.
//! `two-point` and `one-point` place each ruling by itself, and leave the axis to `orient-tool`.

use super::refusals::{FittingSize, MAX_STRIPS, NEARLY, fitting, never, no_ball, out_of_tolerance};
use super::strip::{self, LEAVE, Strip, Surroundings, WorstError};
use super::sweep::{self, NO_VIOLATION, StripPath, StripTask};
use crate::passes::context::{
    Obstacles, PassContext, STATIONS, from_outlet, largest_ball::check_fillet, leads_at_ends,
};
use base::progress::Progress;
use base::units::length;
use diagnostics::Aborted;
use ir::{CcOperation, CcPass, CcPoint, Drive, Operation, OperationId, OperationKind, Program};
use nurbs::DualCurve;
use rayon::prelude::*;
use tool_stock::collide::Cutter;
use wheel::method::{FaceOrder, Flank, FlankMethod};
use wheel::part::{FaceId, Part, Surface, SurfaceKind};

/// Rounds that even out the errors of strips by their heights.
const EVENING_ROUNDS: usize = 3;

/// Ratio of error to tolerance budget above which neither further evening of heights nor the number of strips by the
/// cube law will succeed.
const MAX_ERROR_RATIO: f64 = 1.5;

/// A further strip is tried when the last one has reduced the missing clearance or travel to at most this share.
const MAX_MISSING_SHARE: f64 = 0.8;

/// A strip of a face.
struct PlannedStrip {
    side: FaceId,
    strip: u32,
    /// From inlet to outlet.
    points: Vec<CcPoint>,
    /// Its lower edge, as a share of the height of the face.
    lower: f64,
    sweep: Option<StripPath>,
}

/// Strips of an operation, with notes for the report.
struct PlannedStrips {
    strips: Vec<PlannedStrip>,
    notes: Vec<String>,
}

/// Plans a flank operation.
///
/// # Errors
/// The ball of the tool does not fit the fillet; no number of strips keeps the contracts. The sink holds the
/// diagnostic.
pub(crate) fn plan(cx: &mut PassContext<'_>, id: OperationId) -> Result<CcOperation, Aborted> {
    let operation = &cx.program.operations[id];
    let OperationKind::Flank { ref faces, flank } = operation.kind else { return Err(Aborted) };
    let [at_operation, at_tool] =
        ["this operation rolls the ball in the fillet", "this ball leaves more material than the fillet"];
    check_fillet(cx, operation, at_operation, at_tool)?;
    let PlannedStrips { mut strips, mut notes } = match flank.method {
        FlankMethod::Minimax => optimised(cx, id, operation, faces, flank)?,
        FlankMethod::TwoPoint | FlankMethod::OnePoint => by_ruling(cx, operation, faces, flank)?,
    };
    if flank.order == FaceOrder::Levels {
        // The order of the faces stays where their strips end at the same height.
        strips.sort_by(|a, b| b.lower.total_cmp(&a.lower));
        if strips.len() == faces.len() {
            notes.push(
                "order levels: each face is one strip, which leaves nothing to order; `strips 2` makes two levels"
                    .to_owned(),
            );
        }
    }
    let part = &cx.program.part;
    let pass = |mut strip: PlannedStrip| {
        let mut path = strip.sweep.map(|s| s.path);
        if from_outlet(part, strip.side, flank.milling) {
            strip.points.reverse();
            path = path.map(|path| path.reversed());
        }
        CcPass {
            label: format!("{} strip {}", strip.side.name(), strip.strip + 1),
            drive: Drive::Face { side: strip.side, strip: strip.strip },
            points: strip.points,
            path,
        }
    };
    Ok(CcOperation { operation: id, passes: strips.into_iter().map(pass).collect(), notes })
}

/// Strips of one face.
enum StripPaths {
    /// Their paths, from the root. With a number of strips from the job, paths may violate the bounds.
    Found(Vec<StripPath>),
    /// Even the largest number of strips violates the bounds.
    Never {
        /// The largest error with the largest number of strips.
        worst: WorstError,
        /// The error that the bounds allow on each side, mm.
        needed: f64,
        /// For numbers of strips the largest cutter that keeps the bounds.
        fitting: Vec<FittingSize>,
    },
}

/// The axis paths of the strips of a face, from the root, as a flank operation by `minimax` plans them. `None` where no
/// ball rolls along the root, where no number of strips keeps the contracts, and for an operation of another kind.
pub fn axis_paths(
    program: &Program,
    id: OperationId,
    side: FaceId,
    around: &Surroundings<'_>,
    obstacles: &Obstacles,
) -> Option<Vec<DualCurve>> {
    let operation = &program.operations[id];
    let OperationKind::Flank { flank, .. } = operation.kind else { return None };
    let progress = &Progress::default();
    let task = StripTask { progress, program, operation: id, choices: flank, obstacles };
    match strip_paths(&task, around, side, program.tools[operation.tool].solid.cutter)? {
        StripPaths::Found(sweeps) => Some(sweeps.into_iter().map(|s| s.path).collect()),
        StripPaths::Never { .. } => None,
    }
}

/// The paths of the strips of a face. `None` where no ball rolls along the root.
fn strip_paths(task: &StripTask<'_>, around: &Surroundings<'_>, side: FaceId, cutter: Cutter) -> Option<StripPaths> {
    let sweeps = |strips: &[(Strip<'_>, WorstError)]| {
        strips.par_iter().map(|(strip, _)| task.sweep(strip)).collect::<Option<Vec<StripPath>>>()
    };
    let budget = task.budget(SurfaceKind::Face(side), side);
    // One strip where no contract requires anything.
    let given = task.choices.strips.or_else(|| budget.is_none().then_some(1));
    match given {
        // A single strip has no heights to even out.
        Some(1) => return Some(StripPaths::Found(vec![task.sweep(&Strip::new(around, side, [0.0, 1.0], cutter))?])),
        Some(strips) => {
            return sweeps(&strip::strips_of(around, side, strips, cutter, EVENING_ROUNDS)?).map(StripPaths::Found);
        }
        None => {}
    }
    let [below, above] = budget?;
    // The least error lies evenly on both sides and needs half of the sum of both bounds.
    let needed = 0.5 * (below + above);
    // The cube law gives the least number of strips that can succeed.
    let may = |(fewer, error): (u32, f64), strips: u32| {
        error * (f64::from(fewer) / f64::from(strips)).powi(3) <= MAX_ERROR_RATIO * needed
    };
    let mut last: Option<(u32, f64)> = None;
    // Strips that keep the bounds but violate clearances or travel, and the violation.
    let mut crowded: Option<(Vec<StripPath>, f64)> = None;
    for strips in 1..=MAX_STRIPS {
        if last.is_some_and(|last| !may(last, strips)) {
            continue;
        }
        let mut divided = strip::strips_of(around, side, strips, cutter, usize::from(strips > 1))?;
        let mut error = strip::worst(&divided)?.error;
        last = Some((strips, error));
        if strips > 1 && error > needed && error < MAX_ERROR_RATIO * needed {
            divided = strip::strips_of(around, side, strips, cutter, EVENING_ROUNDS)?;
            error = strip::worst(&divided)?.error;
        }
        if error > NEARLY * needed {
            continue;
        }
        let found = sweeps(&divided)?;
        if found.iter().any(|s| s.violation > NO_VIOLATION) {
            continue;
        }
        let missing = found.iter().map(|s| s.crowded).fold(0.0, f64::max);
        if missing == 0.0 {
            return Some(StripPaths::Found(found));
        }
        // More strips of less height may tilt further, which may reduce the violation.
        let before = crowded.as_ref().map_or(f64::INFINITY, |c| c.1);
        if missing < before {
            crowded = Some((found, missing));
        }
        if missing > MAX_MISSING_SHARE * before {
            break;
        }
    }
    if let Some((found, _)) = crowded {
        return Some(StripPaths::Found(found));
    }
    let worst = strip::least_error(around, side, MAX_STRIPS, cutter, 1)?;
    Some(StripPaths::Never { worst, needed, fitting: fitting(around, side, cutter, &[1, MAX_STRIPS], needed) })
}

/// Strips of both faces with paths that keep the contracts or violate them least.
fn optimised(
    cx: &mut PassContext<'_>,
    id: OperationId,
    operation: &Operation,
    faces: &[FaceId],
    choices: Flank,
) -> Result<PlannedStrips, Aborted> {
    let program = cx.program;
    let tool = &program.tools[operation.tool];
    let around = Surroundings::watched(&program.part, cx.progress);
    let task = StripTask { progress: cx.progress, program, operation: id, choices, obstacles: cx.obstacles };
    let work = cx.progress.begin(format!("{}, axis paths", operation.name), faces.len());
    let found: Vec<Option<StripPaths>> =
        faces.par_iter().map(|side| work.step(strip_paths(&task, &around, *side, tool.solid.cutter))).collect();
    drop(work);
    cx.go_on()?;
    let mut planned = Vec::new();
    let mut notes = Vec::new();
    let mut failed = false;
    for (side, found) in faces.iter().zip(found) {
        let sweeps = match found {
            Some(StripPaths::Found(sweeps)) => sweeps,
            Some(StripPaths::Never { worst, needed, fitting }) => {
                failed = true;
                never(cx, operation, *side, &worst, needed, &fitting);
                continue;
            }
            None => {
                let fillet = program.part.fillet(*side);
                let rolling = fillet.map_or(tool.solid.cutter.tip_radius(), |f| f.most().get());
                return Err(no_ball(cx, operation, *side, rolling));
            }
        };
        let strips = sweeps.len() as u32;
        let worst = sweeps
            .iter()
            .fold([0.0_f64; 3], |w, s| [w[0].max(s.error[0]), w[1].max(s.error[1]), w[2].max(s.violation)]);
        notes.push(format!(
            "{} face: {strips} strip{} by minimax, planned with gouge <= {} and excess <= {}",
            side.name(),
            if strips == 1 { "" } else { "s" },
            length(worst[0]),
            length(worst[1])
        ));
        if worst[2] > NO_VIOLATION {
            out_of_tolerance(cx, operation, &task, &around, *side, strips, worst[2]);
        }
        for (end, name) in ["inlet", "outlet"].iter().enumerate() {
            let blocked = sweeps.iter().filter(|s| s.blocked[end]).count();
            if blocked > 0 {
                notes.push(format!(
                    "{} face: {blocked} of the leads at the {name} are straight: no direction is collision-free",
                    side.name()
                ));
            }
        }
        for (strip, sweep) in (0..strips).zip(sweeps).rev() {
            planned.push(PlannedStrip {
                side: *side,
                strip,
                points: stations(&program.part, *side, &sweep),
                lower: sweep.span[0],
                sweep: Some(sweep),
            });
        }
    }
    if failed { Err(Aborted) } else { Ok(PlannedStrips { strips: planned, notes }) }
}

/// Contact stations of an optimised strip, with the ends of both leads.
fn stations(part: &Part, side: FaceId, sweep: &StripPath) -> Vec<CcPoint> {
    let face = part.face(side);
    let at = |t: f64| {
        let tip = sweep.path.at(t).lower;
        let Some([u, v]) = sweep::contact(&sweep.contacts, t) else {
            // Beyond inlet and outlet the tool touches nothing.
            let u = if t < 0.5 { -1.0 } else { 2.0 };
            return CcPoint { u, v: 0.0, w: 1.0, position: tip, normal: nalgebra::Vector3::zeros() };
        };
        let [low, high] = sweep.span;
        // The ruling continues from the lower edge of the strip.
        let upper = v + (1.0 - v) * (high - low) / (1.0 - low);
        CcPoint { u, v, w: upper, position: face.surface.point(u, v), normal: face.normal(u, v) }
    };
    let path = (0..=STATIONS).map(|i| at(i as f64 / STATIONS as f64));
    let [enters, leaves] = [0, 1].map(|end| CcPoint { position: sweep.leads[end], ..at(end as f64) });
    std::iter::once(enters).chain(path).chain(std::iter::once(leaves)).collect()
}

/// Strips along the rulings, each ruling by itself.
fn by_ruling(
    cx: &mut PassContext<'_>,
    operation: &Operation,
    faces: &[FaceId],
    flank: Flank,
) -> Result<PlannedStrips, Aborted> {
    let part = &cx.program.part;
    let cutter = &cx.program.tools[operation.tool].solid.cutter;
    let radius = cutter.tip_radius();
    let strips = flank.strips.unwrap_or(1);
    let mut planned = Vec::new();
    for side in faces {
        let face = part.face(*side);
        // On the face, and on its continuation until the ball has passed hub and edge.
        let (from, to) =
            (-part.root_step(*side, 0.0, LEAVE * radius), 1.0 + part.root_step(*side, 1.0, LEAVE * radius));
        let lowest: Option<Vec<(f64, f64)>> = (0..=STATIONS)
            .map(|i| from + (to - from) * i as f64 / STATIONS as f64)
            .map(|u| Some((u, strip::foot(part, *side, cutter, u)?)))
            .collect();
        let Some(lowest) = lowest else {
            let rolling = part.fillet(*side).map_or(radius, |f| f.most().get());
            return Err(no_ball(cx, operation, *side, rolling));
        };
        // Remainder of the lead, on which the tool moves without turning.
        let rest = |lead: f64| (lead - LEAVE * radius).max(0.0);
        let [at_inlet, at_outlet] = leads_at_ends(part, operation, *side, flank.milling);
        let before = part.root_step(*side, 0.0, rest(at_inlet));
        let after = part.root_step(*side, 1.0, rest(at_outlet));
        for strip in (0..strips).rev() {
            let height = |v: f64, k: u32| v + (1.0 - v) * f64::from(k) / f64::from(strips);
            let point = |u: f64, v: f64| CcPoint {
                u,
                v: height(v, strip),
                w: height(v, strip + 1),
                position: face.surface.point(u, height(v, strip)),
                normal: face.normal(u, height(v, strip)),
            };
            let ends = (lowest.first().map(|x| x.1), lowest.last().map(|x| x.1));
            let (Some(first), Some(last)) = ends else { return Err(Aborted) };
            let mut points = vec![point(from - before, first)];
            points.extend(lowest.iter().map(|(u, v)| point(*u, *v)));
            points.push(point(to + after, last));
            let lower = f64::from(strip) / f64::from(strips);
            planned.push(PlannedStrip { side: *side, strip, points, lower, sweep: None });
        }
    }
    let law = match flank.method {
        FlankMethod::OnePoint => "one-point offsets along the rulings",
        _ => "two-point offsets (formulas 10 to 12)",
    };
    let fillet = part.main().fillet.as_ref().map_or_else(|| format!("{radius} mm"), ToString::to_string);
    let notes = vec![format!("{strips} strips per face by {law}, ball radius {radius} mm, fillet {fillet}")];
    Ok(PlannedStrips { strips: planned, notes })
}
