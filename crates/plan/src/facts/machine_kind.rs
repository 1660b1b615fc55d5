//! Whether the rotary axes of the machine can direct the tool.

use base::units::trim;
use diagnostics::{Aborted, Diag, Sink, codes::kinematics::NO_REACH};
use ir::Program;
use nalgebra::Vector3;

/// Least angle to Z up to which the tool must take every direction, radians: less than any impeller needs.
const MIN_TILT: f64 = std::f64::consts::PI / 180.0;

/// Refuses a machine whose rotary axes do not give the tool the directions about the axis of the part.
///
/// # Errors
/// The machine is refused; the reason is in the sink.
pub fn check(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    let machine = &program.machine;
    let [.., first, second] = machine.names();
    let tilt = machine.max_tilt();
    if tilt >= MIN_TILT {
        return Ok(());
    }
    let upright = machine.reaches(&Vector3::z());
    let text = if upright {
        format!(
            "{first} and {second} of the machine {} lean the tool to all sides by at most {:.2} deg",
            machine.name,
            tilt.to_degrees()
        )
    } else {
        format!("{first} and {second} of the machine {} do not set the tool along the axis of the part", machine.name)
    };
    let turned = if let Some(other) = machine.reached_from_below() {
        let [x, y, z] = [other.x, other.y, other.z].map(|x| trim(x, 4));
        format!(
            "; they reach the part from below: a part that is clamped the other way has `[part] direction = [{x}, {y}, {z}]`"
        )
    } else {
        String::new()
    };
    sink.push(Diag::error(NO_REACH, text).note("`--emit ir` prints the axes of the machine file").help(format!(
        "correct `travel`, `direction` and `sense` of {first} and {second}, or use another machine{turned}"
    )));
    Err(Aborted)
}
