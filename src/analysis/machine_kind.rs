//! Whether planning supports the rotary axes of the machine.

use crate::diag::{Aborted, Diag, Sink, codes::kinematics::KIND_NOT_PLANNED};
use crate::ir::Program;
use crate::kin::Carries;

/// Refuses machines for which feeds, poles and branches are not yet planned and judged: machines with a head, and
/// tables whose axes are not perpendicular or whose second axis is not along the tool.
///
/// # Errors
/// The machine is refused; the reason is in the sink.
pub fn check(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    let machine = &program.machine;
    let [first, second] = machine.chain.axes();
    let [.., one, other] = machine.names();
    let upright = second.direction.z == 1.0 && first.direction.z == 0.0;
    let reason = if first.carries == Carries::Tool {
        format!("axis {one} of the machine {} carries the tool", machine.name)
    } else if upright {
        return Ok(());
    } else {
        format!("the axes {one} and {other} of the machine {} do not tilt and turn a level table", machine.name)
    };
    sink.push(
        Diag::error(KIND_NOT_PLANNED, format!("{reason}; such machines are not supported yet"))
            .note("the machine file itself is correct; `--emit ir` prints its kinematics")
            .help("use a machine whose table turns about the vertical and is tilted about a level axis, such as A/C or B/C"),
    );
    Err(Aborted)
}
