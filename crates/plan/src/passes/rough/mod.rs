//! Roughing of a channel, layer by layer.

mod best_tilt;
pub(crate) mod channel_levels;
pub(crate) mod expand;
mod floor;
mod free_space;
pub(crate) mod groove;
mod layers;
mod levels;
pub(crate) mod plunge;
mod run_map;
pub(crate) mod short_reach;
mod step;
mod trochoid;
mod wall_tilt;

use crate::passes::context::{PassContext, in_passage};
use base::entity::PrimaryMap;
use diagnostics::{Aborted, Diag, codes::planning};
use ir::{CcOperation, CcPass, CcPoint, ClPoint, Operation, OperationId};
use layers::Roughing;

/// Data of the roughing operations of a program, made once for all passes, for each passage; none for finishing.
pub(crate) type Roughings<'a> = PrimaryMap<OperationId, Vec<Roughing<'a>>>;

/// Passes of one passage, with notes for the report.
pub(crate) struct PassagePlan {
    passes: Vec<CcPass>,
    notes: Vec<String>,
}

/// Stations of a line, with its name. All loops of a slot have one name.
pub(crate) struct NamedLine {
    name: String,
    points: Vec<CcPoint>,
}

/// Makes the data of all roughing operations.
///
/// # Errors
/// The run was cancelled.
pub(crate) fn roughings<'a>(cx: &PassContext<'a>) -> Result<Roughings<'a>, Aborted> {
    let mut roughings = Roughings::new();
    for (_, operation) in cx.program.operations.iter() {
        cx.go_on()?;
        let passages = cx.program.part.passages();
        let made = passages.filter_map(|p| Roughing::new(cx.program, operation, p.id, cx.obstacles, cx.progress));
        roughings.push(made.collect());
    }
    cx.go_on()?;
    Ok(roughings)
}

/// Data of a roughing operation, for each passage.
///
/// # Errors
/// Layers so thin that planning would not end; the sink holds the diagnostic.
pub(crate) fn roughing<'r, 'a>(
    cx: &mut PassContext<'_>,
    roughings: &'r Roughings<'a>,
    id: OperationId,
) -> Result<&'r [Roughing<'a>], Aborted> {
    let operation = &cx.program.operations[id];
    let Some(roughing) = roughings[id].first() else {
        cx.sink.push(Diag::error(
            planning::NO_ROOM,
            format!("`{}` has no layers: it is not a roughing operation", operation.name),
        ));
        return Err(Aborted);
    };
    // A layer takes some ten thousand distance queries, which costs as much time as that many points.
    check_queries(cx, operation, roughing.layer_count(1.0) * QUERIES_PER_LAYER * roughings[id].len() as f64)?;
    Ok(&roughings[id])
}

/// The plan of an operation from the passes and notes of each passage.
///
/// # Errors
/// Those of `plan`; layers so thin that planning would not end.
fn each_passage<'a>(
    cx: &mut PassContext<'_>,
    roughings: &Roughings<'a>,
    id: OperationId,
    mut plan: impl FnMut(&mut PassContext<'_>, &Roughing<'a>) -> Result<PassagePlan, Aborted>,
) -> Result<CcOperation, Aborted> {
    let mut all = CcOperation { operation: id, passes: Vec::new(), notes: Vec::new() };
    for roughing in roughing(cx, roughings, id)? {
        let PassagePlan { passes, notes } = plan(cx, roughing)?;
        all.passes.extend(passes);
        all.notes.extend(notes.into_iter().map(|note| in_passage(&cx.program.part, roughing.passage, note)));
    }
    Ok(all)
}

/// Refuses an operation whose tool fits nowhere in the channel.
fn nothing_to_cut(cx: &mut PassContext<'_>, operation: &Operation, text: String) -> Aborted {
    cx.sink.push(
        Diag::error(planning::NO_ROOM, text)
            .label(operation.span, "this operation has nothing to cut")
            .label(cx.program.tools[operation.tool].span, "this tool is too big for the channel")
            .help("take a thinner tool, a longer reach, or smaller allowances"),
    );
    Aborted
}

/// Distance queries that measuring a layer takes.
const QUERIES_PER_LAYER: f64 = 1e4;

/// Most distance queries for the layers of one operation: some minutes.
const MAX_QUERIES: f64 = 2e7;

/// Refuses an operation whose layers would need too many distance queries.
fn check_queries(cx: &mut PassContext<'_>, operation: &Operation, queries: f64) -> Result<(), Aborted> {
    if queries <= MAX_QUERIES {
        return Ok(());
    }
    cx.sink.push(
        Diag::error(
            planning::TOO_FINE,
            format!(
                "the layers of `{}` need {queries:.1e} distance queries; the limit is {MAX_QUERIES:.1e}",
                operation.name
            ),
        )
        .label(operation.span, "the step down of this operation is too small")
        .help("use a larger `depth`"),
    );
    Err(Aborted)
}

/// Roughing: the tool tip is at the drive point; its normal is the tool axis.
pub(crate) fn channel_points(pass: &CcPass) -> Vec<ClPoint> {
    let point = |p: &CcPoint| ClPoint { tip: p.position, axis: p.normal, contact: None };
    pass.points.iter().map(point).collect()
}
