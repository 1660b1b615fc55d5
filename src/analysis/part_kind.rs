//! Whether planning supports the blades of the part.

use crate::diag::{Aborted, Diag, Sink, codes::geometry::PART_NOT_PLANNED};
use crate::ir::Program;
use crate::part::{BladeId, FaceSurface};

/// Refuses parts whose passages or faces are not planned yet: parts with splitters, or with faces that are not ruled.
///
/// # Errors
/// The part is refused; the reason is in the sink.
pub fn check(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    let part = &program.part;
    let lofted = part.faces().find(|face| !matches!(part.face(*face).surface, FaceSurface::Ruled(_)));
    let splitter = part.blade_ids().find(|blade| *blade != BladeId::MAIN);
    let reason = match (splitter, lofted) {
        (Some(splitter), _) => format!("the part has the splitter `{}`", part.blade(splitter).name),
        (None, Some(face)) => format!("the {} face is {}", face.name(), part.face(face).surface.kind()),
        (None, None) => return Ok(()),
    };
    sink.push(
        Diag::error(PART_NOT_PLANNED, format!("{reason}; such parts are not supported yet"))
            .note("the part itself is correct; `--emit ir` prints it")
            .help("use vanes with ruled faces and no splitters"),
    );
    Err(Aborted)
}
