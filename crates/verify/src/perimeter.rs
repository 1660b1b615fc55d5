//! The perimeter of a program: the motion before the first and behind the last move of an operation.
//!
//! There, all axes except Z move without tool centre point control, from unknown positions, with the tool of this or of
//! the previous operation in the spindle. Only the height is known. The tip of every tool must therefore stand higher
//! than part, stock, table and fixtures can reach under any angles of the rotary axes within their travel. The approach
//! to the first target and the retract behind the last one are moves of the motion, which all other checks judge.

use super::proof::piece::At;
use base::units::{Mm, length};
use diagnostics::{Diag, Sink, codes::verification};
use five_axis::Joints;
use ir::{Motion, MotionOperation, Program};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Difference of heights that counts as rounding, mm.
const HEIGHT_ROUNDING: f64 = 1e-6;

/// Heights in the machine frame, mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PerimeterReport {
    /// Gauge line for tool changes, from the machine file.
    pub retract: Mm,
    /// The highest solid: `stock`, `table` or `fixture`.
    pub highest: Cow<'static, str>,
    /// Its largest height under any angles of the rotary axes within their travel.
    pub height: Mm,
    /// Least height of a tool tip over it while any axis except Z moves.
    pub clearance: Mm,
    /// Place of the least height: the first or the last move of an operation.
    pub at: Option<At>,
    /// Distance required by the job.
    pub required: Mm,
}

/// Measures the heights of the first and the last station of every operation, with the tool of the operation.
pub fn check(program: &Program, motion: &Motion) -> PerimeterReport {
    let (highest, height) = program.highest();
    let mut report = PerimeterReport {
        retract: Mm(program.machine.retract),
        highest: highest.into(),
        height: Mm(height),
        clearance: Mm(f64::INFINITY),
        at: None,
        required: Mm(program.clearance.get()),
    };
    for (o, operation) in motion.operations.iter().enumerate() {
        let last = operation.moves.len().saturating_sub(1);
        for index in [0, last] {
            let Some(station) = operation.moves.get(index) else { continue };
            let clearance = lowest(program, operation, &station.joints) - height;
            if clearance < report.clearance.get() {
                let number = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
                report.clearance = Mm(clearance);
                report.at = Some(At { operation: number(o), index: number(index) });
            }
        }
    }
    report
}

/// Lowest height of the tool of an operation, machine frame, mm: of its tip, or under any angles of the head.
fn lowest(program: &Program, operation: &MotionOperation, joints: &Joints) -> f64 {
    let (machine, tool) = (&program.machine, &program.tools[program.operations[operation.operation].tool]);
    if !machine.chain.has_head() {
        return joints.xyz.z;
    }
    machine.positions(joints, tool.length())[2] + tool.lowest(machine)
}

/// Reports a tool that does not stand high enough as an error.
pub(super) fn report(program: &Program, motion: &Motion, found: &PerimeterReport, sink: &mut Sink) {
    let Some(at) = found.at.filter(|_| found.clearance < Mm(found.required.get() - HEIGHT_ROUNDING)) else { return };
    let Some(operation) = motion.operations.get(at.operation as usize) else { return };
    let declared = &program.operations[operation.operation];
    let tool = &program.tools[declared.tool];
    let missing = found.required.get() - found.clearance.get();
    let machine = &program.machine;
    let [.., first, second] = machine.names();
    let Some(station) = operation.moves.get(at.index as usize) else { return };
    let head = machine.chain.has_head();
    let [z, below] = [machine.positions(&station.joints, tool.length())[2], -tool.lowest(machine)];
    sink.push(
        Diag::error(
            verification::RETRACT_TOO_LOW,
            format!(
                "while X, Y, {first} and {second} move, the {} of {} is {} above the height that the {} can reach; required {}",
                if head { "lowest point" } else { "tip" },
                tool.name,
                length(found.clearance.get()),
                found.highest,
                length(found.required.get())
            ),
        )
        .label(declared.span, "before or after this operation")
        .place(
            if at.index == 0 { "approach to the first target" } else { "retract after the last move" },
            program.machine.forward(&station.joints).tip,
        )
        .block(at.operation, at.index)
        .note(if head {
            format!(
                "Z {z:.3} of the gauge line, less {below:.3} mm that the tool reaches below it at some angle of the head; the {} \
                 reaches Z {:.3}",
                found.highest, found.height.get()
            )
        } else {
            format!(
                "Z {z:.3} of the gauge line, less {below:.3} mm of tool; the {} reaches Z {:.3} under some {first} and {second}",
                found.highest, found.height.get()
            )
        })
        .help(if head {
            format!("use a retract height {} higher, a shorter tool or holder, or mount the part lower", length(missing))
        } else {
            format!(
                "use a retract height {} higher, a shorter tool or holder, or mount the part lower or nearer to the {first} axis",
                length(missing)
            )
        }),
    );
}
