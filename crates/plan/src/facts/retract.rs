//! Whether every tool is above all obstacles at the retract height of the machine, at which the axes move from unknown
//! positions.

use base::units::length;
use diagnostics::codes::verification::RETRACT_TOO_LOW;
use diagnostics::{Diag, Sink};
use ir::{Program, ToolId};

/// Reports an error for each tool in use that is too low.
pub(super) fn check(program: &Program, sink: &mut Sink) {
    let (what, height) = program.highest();
    let [.., first, second] = program.machine.names();
    let head = program.machine.chain.has_head();
    // With the stock above the gauge line no tool helps: one message, at the longest tool.
    let hopeless = height > program.machine.retract;
    let lowest = |of: &ToolId| program.tools[*of].lowest(&program.machine);
    let mut used: Vec<ToolId> = Vec::new();
    for (_, operation) in program.operations.iter() {
        if !used.contains(&operation.tool) {
            used.push(operation.tool);
        }
    }
    if hopeless {
        used.sort_by(|a, b| lowest(a).total_cmp(&lowest(b)));
        used.truncate(1);
    }
    for of in used {
        let tool = &program.tools[of];
        let clearance = program.machine.retract + lowest(&of) - height;
        let missing = program.clearance.get() - clearance;
        if missing > 0.0 {
            sink.push(
                Diag::error(
                    RETRACT_TOO_LOW,
                    format!(
                        "at the retract height the {} of {} is {} the highest place that the {what} can reach; required {}",
                        if head { "lowest point" } else { "tip" },
                        tool.name,
                        if clearance < 0.0 {
                            format!("{} below", length(-clearance))
                        } else {
                            format!("{} above", length(clearance))
                        },
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
                .help(if hopeless {
                    "the part stands above the highest place of the gauge line: correct `[part] origin` or `[retract] z` of the \
                     machine file"
                        .to_owned()
                } else {
                    format!(
                    "use a retract height {} higher (`[retract] z` of the machine file), a shorter tool or holder, or mount the part \
                     lower{}",
                    length(missing),
                    if head { String::new() } else { format!(" or nearer to the axis of {first}") }
                )}),
            );
        }
    }
}
