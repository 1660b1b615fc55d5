//! Whether every tool is above all obstacles at the retract height of the machine, at which the axes move from unknown
//! positions.

use crate::diag::codes::verification::RETRACT_TOO_LOW;
use crate::diag::{Diag, Sink};
use crate::ir::Program;
use crate::units::length;

/// Reports an error for each tool in use that is too low.
pub(super) fn check(program: &Program, sink: &mut Sink) {
    let (what, height) = program.highest();
    let [.., first, second] = program.machine.names();
    let head = program.machine.chain.has_head();
    let mut seen = Vec::new();
    for (_, operation) in program.operations.iter() {
        if seen.contains(&operation.tool) {
            continue;
        }
        seen.push(operation.tool);
        let tool = &program.tools[operation.tool];
        let clearance = program.machine.retract + tool.lowest(&program.machine) - height;
        let missing = program.clearance.get() - clearance;
        if missing > 0.0 {
            sink.push(
                Diag::error(
                    RETRACT_TOO_LOW,
                    format!(
                        "at the retract height the {} of {} is {} above the highest place that the {what} can reach; required {}",
                        if head { "lowest point" } else { "tip" },
                        tool.name,
                        length(clearance),
                        length(program.clearance.get())
                    ),
                )
                .label(tool.span, format!("{} from the tip to the gauge line", length(tool.length())))
                .note(format!(
                    "{}: retract to Z {:.3}; the {what} reaches Z {height:.3} at some {first} and {second} within the travel",
                    program.machine.name, program.machine.retract
                ))
                .note(format!(
                    "before and after an operation X, Y, {first} and {second} move at this height, from unknown positions"
                ))
                .help(format!(
                    "use a retract height {} higher (`[retract] z` of the machine file), a shorter tool or holder, or mount the part \
                     lower{}",
                    length(missing),
                    if head { String::new() } else { format!(" or nearer to the axis of {first}") }
                )),
            );
        }
    }
}
