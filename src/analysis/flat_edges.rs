//! Edges that no ball can finish: flat ones inside of the part.

use crate::diag::{Aborted, Diag, Sink, codes::geometry::FLAT_EDGE};
use crate::ir::{OperationKind, Program};
use crate::part::SurfaceKind;

/// Refuses operations on the edges of a splitter that lie inside of the part and are no surfaces of their own: they run straight
/// from face to face, and no fillet goes round their foot.
///
/// # Errors
/// One for each such edge of an operation, in the sink.
pub fn check(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    let part = &program.part;
    let mut found = false;
    for (_, operation) in program.operations.iter() {
        let OperationKind::Point { surfaces, .. } = &operation.kind else { continue };
        for surface in surfaces {
            let (blade, end) = match *surface {
                SurfaceKind::InletEdge(blade) => (blade, 0),
                SurfaceKind::OutletEdge(blade) => (blade, 1),
                _ => continue,
            };
            if part.edge(blade, end).is_some() || !part.ends_inside(blade, end) {
                continue;
            }
            let (word, form) = [("inlet", "leading-edge"), ("outlet", "trailing-edge")][end];
            let name = &part.blade(blade).name;
            sink.push(
                Diag::error(FLAT_EDGE, format!("the {word} edge of `{name}` is flat and lies inside of the part"))
                    .label(operation.span, "this operation finishes it")
                    .note(
                        "no fillet goes round the foot of a flat edge, so that a ball would cut into the hub before it",
                    )
                    .help(format!(
                        "give `{name}` as closed sections with `{form} round`, or name other `blades` in this operation"
                    )),
            );
            found = true;
        }
    }
    if found { Err(Aborted) } else { Ok(()) }
}
