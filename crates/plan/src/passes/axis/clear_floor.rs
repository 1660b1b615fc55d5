//! Where the larger tool of a `channel` operation fits: between the walls, and with clear tool axes.
//!
//! At places along the floor the tool stands on both outer lines and half way between them. It fits where it is clear of the
//! part on all of them, and where the method of the operation finds a clear axis on each. Smaller tools finish all other
//! places, so that a larger tool that fits nowhere is a remark and no error.

use super::avoid_collision::TILTS;
use super::clear_axes::{ClearAxes, StandingBall};
use super::orient_tool::{Middle, Middles};
use super::sequence::CANDIDATE_MARGIN_MM;
use crate::passes::context::SIDE_CLEARANCE;
use crate::passes::context::{AxisTilt, Keep, PassContext, TableTool};
use base::units::Mm;
use diagnostics::{Aborted, Diag, codes::planning};
use ir::{ClPoint, Operation};
use rayon::prelude::*;
use wheel::method::AxisMethod;
use wheel::operation::VaneAllowance;
use wheel::part::Passage;

/// Shares of the distance from the first outer line to the second at which the tool is tried.
const LINE_SHARES: [f64; 3] = [0.0, 0.5, 1.0];

/// Finds the free space of all larger tools.
///
/// # Errors
/// None of its own; a cancelled run ends.
pub(crate) fn run<'a>(cx: &mut PassContext<'a>) -> Result<Middles<'a>, Aborted> {
    let program = cx.program;
    let mut middles = Middles::new();
    for (id, operation) in program.operations.iter() {
        let Some(allowance) = operation.kind.of_larger_tool() else { continue };
        cx.go_on()?;
        let mut fits = false;
        let bull_nose = TableTool::new(&program.tools[operation.tool].solid);
        for passage in program.part.passages() {
            let widest = widest(cx, operation, &bull_nose, passage, allowance);
            let Some(middle) = widest.map(|middle| with_free_space(cx, operation, &bull_nose, middle, allowance))
            else {
                continue;
            };
            fits |= middle.fits();
            middles.insert((id, passage.id), middle);
        }
        cx.go_on()?;
        if !fits {
            let diag = fits_nowhere(cx, operation, allowance);
            cx.sink.push(diag);
        }
    }
    cx.go_on()?;
    Ok(middles)
}

/// The middle of the floor between the outer lines that leave most free space: each tool on its line keeps its distances.
fn widest<'a>(
    cx: &PassContext<'a>,
    operation: &Operation,
    bull_nose: &TableTool<'_>,
    passage: Passage,
    allowance: Mm,
) -> Option<Middle<'a>> {
    let program = cx.program;
    let mut all = Middle::all(program, operation, passage);
    if all.len() < 2 {
        return all.pop();
    }
    let places = all[0].places(operation);
    let clear = |middle: &Middle<'_>, share: f64| -> Vec<bool> {
        let at = |u: &f64| {
            let tool = middle.tool_at(program, operation, *u, share, AxisTilt::Along);
            tool.is_some_and(|p| is_clear(cx, bull_nose, &p, allowance))
        };
        places.par_iter().map(|u| !cx.progress.is_cancelled() && at(u)).collect()
    };
    let each = |share: f64| -> Vec<Vec<bool>> { all.iter().map(|middle| clear(middle, share)).collect() };
    let (first, second) = (each(0.0), each(1.0));
    let width = |(i, j): (usize, usize), k: usize| {
        if first[i][k] && second[j][k] { all[i].width_to(&all[j], places[k]).max(0.0) } else { 0.0 }
    };
    let pairs = (0..all.len()).flat_map(|i| (0..all.len()).map(move |j| (i, j)));
    let area = |pair: (usize, usize)| (0..places.len()).map(|k| width(pair, k)).sum::<f64>();
    let (i, j) = pairs.map(|pair| (pair, area(pair))).reduce(|a, b| if b.1 > a.1 { b } else { a })?.0;
    if let Ok([middle, other]) = all.get_disjoint_mut([i, j]) {
        middle.up_to(other);
    }
    Some(all.swap_remove(i))
}

/// True where a bull nose keeps the allowance from vanes and fillets, its end is out of the hub, and shank and holder keep
/// their clearance.
fn is_clear(cx: &PassContext<'_>, tool: &TableTool<'_>, at: &ClPoint, allowance: Mm) -> bool {
    let solid = tool.solid;
    let clearance = cx.program.clearance.get();
    let keep = Keep { vane: VaneAllowance::even(allowance), hub: 0.0, clearance };
    cx.obstacles.walls_clear(tool, &at.tip, &at.axis, &keep)
        && cx.obstacles.cutter_inside(solid, &at.tip, &at.axis).is_none()
        && cx.obstacles.body_violation(solid, &at.tip, &at.axis, clearance, None).is_none()
}

/// The middle of the floor with the intervals in which the tool fits. Where lines keep one tilt each, the tilt that
/// gives the tool most places decides.
fn with_free_space<'a>(
    cx: &PassContext<'a>,
    operation: &Operation,
    bull_nose: &TableTool<'_>,
    mut middle: Middle<'a>,
    allowance: Mm,
) -> Middle<'a> {
    let (program, obstacles) = (cx.program, cx.obstacles);
    let places = middle.places(operation);
    let work = cx.progress.begin(format!("{}, room of the tool", operation.name), places.len());
    let free: Vec<bool> =
        places.par_iter().map(|u| work.do_step(|| middle.has_free_space(obstacles, *u)).unwrap_or(false)).collect();
    let clear = ClearAxes::new(program, obstacles, operation);
    let solid = bull_nose.solid;
    let radius = solid.cutter.tip_radius();
    let turns = matches!(operation.kind.axis_method(), Some(AxisMethod::Corridor | AxisMethod::Xu));
    let fits = |u: f64, tilt: AxisTilt| {
        LINE_SHARES.iter().all(|share| {
            let Some(p) = middle.tool_at(program, operation, u, *share, tilt) else { return false };
            if operation.kind.axis_method() == Some(AxisMethod::Lead) {
                return is_clear(cx, bull_nose, &p, allowance);
            }
            if turns {
                return clear.has_candidate(&StandingBall::at(&p, radius), &p.axis, clear.scaled(CANDIDATE_MARGIN_MM));
            }
            obstacles.body_violation(solid, &p.tip, &p.axis, program.clearance.get(), Some(SIDE_CLEARANCE)).is_none()
        })
    };
    let with = |tilt: AxisTilt| -> Vec<bool> {
        places.par_iter().zip(&free).map(|(u, free)| *free && !work.is_cancelled() && fits(*u, tilt)).collect()
    };
    let count = |fits: &Vec<bool>| fits.iter().filter(|fits| **fits).count();
    let found = match operation.kind.axis_method() {
        Some(AxisMethod::Ruling) => with(AxisTilt::Along),
        Some(AxisMethod::Blend) => {
            let all = TILTS.into_iter().map(|tilt| with(AxisTilt::Away(tilt.to_radians())));
            all.reduce(|a, b| if count(&b) > count(&a) { b } else { a }).unwrap_or_default()
        }
        _ => with(AxisTilt::Away(0.0)),
    };
    middle.keep(operation, &places, &found);
    middle
}

fn fits_nowhere(cx: &PassContext<'_>, operation: &Operation, allowance: Mm) -> Diag {
    let tool = &cx.program.tools[operation.tool];
    Diag::remark(
        planning::NO_ROOM_ON_FLOOR,
        format!("`{}` cuts nothing: {} fits nowhere between the vanes", operation.name, tool.name),
    )
    .label(operation.span, "smaller tools of this operation finish the floor")
    .label(tool.span, format!("this tool has to stay {allowance} off vanes and fillets, with a clear axis"))
    .help("use a smaller tool, a longer reach or a slimmer holder; or leave this tool out")
}
