//! Edges that an operation cannot finish: flat ones inside of the part, and round ones by a spiral.

use diagnostics::codes::{geometry::FLAT_EDGE, job::WRONG_FORM};
use diagnostics::{Aborted, Diag, Sink};
use ir::{OperationKind, Program};
use wheel::method::Lines;
use wheel::part::SurfaceKind;

/// Refuses operations on the edges of a splitter that lie inside of the part and are no surfaces of their own: they run straight
/// from face to face, and no fillet goes round their foot. Refuses spirals round edges that are surfaces of their own.
///
/// # Errors
/// One for each such edge, and for each such operation, in the sink.
pub fn check(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    let part = &program.part;
    let mut found = false;
    for (_, operation) in program.operations.iter() {
        let OperationKind::Point { surfaces, lines, .. } = &operation.kind else { continue };
        let round =
            operation.kind.blades(part).find(|blade| [0, 1].iter().any(|end| part.edge(*blade, *end).is_some()));
        if let Some(blade) = round.filter(|_| *lines == Lines::Spiral) {
            let name = &part.blade(blade).name;
            sink.push(
                Diag::error(WRONG_FORM, format!("`lines spiral` does not go round the edges of `{name}`"))
                    .label(operation.span, "this operation runs round both faces")
                    .note("these edges are surfaces of their own; a spiral goes round edges that the lathe makes")
                    .help("use `lines zigzag`, and an operation `edge` for the edges"),
            );
            found = true;
        }
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
