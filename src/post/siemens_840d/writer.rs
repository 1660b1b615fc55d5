//! From a motion to NC text.

use crate::diag::{Diag, Sink, codes::post};
use crate::ir::{JointMove, Motion, MotionOperation, MoveKind, Program};
use crate::kin::{Joints, Machine};
use crate::post::nc::{NcLine, NcProgram};
use crate::post::words::{self, LENGTH_DECIMALS, VECTOR_DECIMALS, feed, fixed};

/// Turn of rotary axis 2 between blocks from which on the nearest rotary position is not certain to be the right one.
const CERTAIN_TURN: f64 = std::f64::consts::FRAC_PI_2;

/// Refuses a motion that the dialect cannot express.
pub(super) fn check(program: &Program, motion: &Motion, sink: &mut Sink) {
    words::check(program, motion, sink);
    for operation in &motion.operations {
        let declared = &program.operations[operation.operation];
        let unsure = operation.moves.windows(2).find(|m| {
            let [a, b] = [m[0].joints.rotary, m[1].joints.rotary];
            m[1].kind != MoveKind::Rapid && (a[0] * b[0] < 0.0 || (a[1] - b[1]).abs() >= CERTAIN_TURN)
        });
        if let Some(m) = unsure {
            let label = operation.labels.get(m[1].pass as usize).cloned().unwrap_or_default();
            sink.push(
                Diag::error(
                    post::AMBIGUOUS_VECTOR,
                    format!(
                        "`{}` turns {} by {:.1} deg in one block, or runs through the pole",
                        declared.name,
                        program.machine.rotary[1].name,
                        (m[0].joints.rotary[1] - m[1].joints.rotary[1]).to_degrees().abs()
                    ),
                )
                .label(declared.span, "in this operation")
                .place(label, program.machine.forward(&m[1].joints).tip)
                .note("a direction vector fits two rotary positions; the control takes the nearer one")
                .help("use a finer chord tolerance, or tool axes farther from the pole"),
            );
        }
    }
}

/// The program as text.
pub(super) fn emit(program: &Program, motion: &Motion, header: &[String]) -> NcProgram {
    let mut nc = NcProgram::default();
    nc.line(format!("; %_N_{}_MPF", program.name.to_ascii_uppercase().replace('-', "_")));
    for line in header {
        nc.line(format!("; {}", words::comment(line)));
    }
    let mut number = 0;
    let mut block = |nc: &mut NcProgram, text: String, source: Option<(u32, u32)>| {
        number += 10;
        nc.lines.push(NcLine { text: format!("N{number} {text}"), source });
    };
    for text in ["G17 G710 G90 G94 G40", "TRAFOOF", "TRANS", "G500", "CYCLE832(0,_OFF,1)"] {
        block(&mut nc, text.to_owned(), None);
    }
    for (o, operation) in motion.operations.iter().enumerate() {
        let tool = &program.tools[program.operations[operation.operation].tool];
        let Some((first, rest)) = operation.moves.split_first() else { continue };
        let Some((last, between)) = rest.split_last() else { continue };
        let source = |i: usize| Some((u32::try_from(o).unwrap_or(u32::MAX), u32::try_from(i).unwrap_or(u32::MAX)));
        begin(program, operation, first, &mut |text, placed| block(&mut nc, text, source(0).filter(|_| placed)));
        let mut last_feed = String::new();
        let mut last_kind = None;
        for (i, m) in between.iter().enumerate() {
            let text = match m.kind {
                MoveKind::Rapid => format!("G0 {} {}", tip(program, m), rotary(&program.machine, &m.joints)),
                MoveKind::Link | MoveKind::Cut => {
                    let f = feed(m.feed.unwrap_or(0.0));
                    // After a rapid F is written again, so that every pass can be read by itself.
                    let say = f != last_feed || last_kind == Some(MoveKind::Rapid);
                    let word = if say { format!(" F{f}") } else { String::new() };
                    last_feed = f;
                    format!("G1 {} {}{word}", tip(program, m), vector(program, m))
                }
            };
            last_kind = Some(m.kind);
            block(&mut nc, text, source(i + 1));
        }
        block(&mut nc, "TRAFOOF".to_owned(), None);
        block(&mut nc, "CYCLE832(0,_OFF,1)".to_owned(), None);
        let height = fixed(last.joints.xyz.z + tool.length(), LENGTH_DECIMALS);
        block(&mut nc, format!("SUPA G0 Z{height} D0 M9"), source(between.len() + 1));
        block(&mut nc, "M5".to_owned(), None);
    }
    block(&mut nc, "M30".to_owned(), None);
    nc
}

/// Retract, tool, spindle, moves to the first target, work offset, smoothing, transformation. The block that ends at
/// the first station is marked.
fn begin(program: &Program, operation: &MotionOperation, first: &JointMove, block: &mut dyn FnMut(String, bool)) {
    let declared = &program.operations[operation.operation];
    let tool = &program.tools[declared.tool];
    let finishes = declared.kind.finishes();
    let chord = if finishes { program.tolerances.chord } else { program.tolerances.chord_rough };
    block(format!("SUPA G0 Z{} D0", fixed(program.machine.retract, LENGTH_DECIMALS)), false);
    block(format!("T=\"{}\" M6 ; {}", tool.name, declared.name), false);
    block(format!("S{} M3", fixed(declared.speed.get(), 0)), false);
    block(format!("SUPA G0 {} D0", rotary(&program.machine, &first.joints)), false);
    let [x, y] = [first.joints.xyz.x, first.joints.xyz.y].map(|x| fixed(x, LENGTH_DECIMALS));
    block(format!("SUPA G0 X{x} Y{y} D0"), true);
    block("G54 D1".to_owned(), false);
    let mode = if finishes { "_ORI_FINISH" } else { "_ORI_ROUGH" };
    block(format!("CYCLE832({},{mode},0.1)", fixed(chord.get(), 4)), false);
    block("TRAORI".to_owned(), false);
    block("G54 ORIWKS ORIAXES M8".to_owned(), false);
}

fn tip(program: &Program, m: &JointMove) -> String {
    let p = program.machine.forward(&m.joints).tip;
    let w = |x: f64| fixed(x, LENGTH_DECIMALS);
    format!("X{} Y{} Z{}", w(p.x), w(p.y), w(p.z))
}

fn vector(program: &Program, m: &JointMove) -> String {
    let v = program.machine.forward(&m.joints).axis;
    let w = |x: f64| fixed(x, VECTOR_DECIMALS);
    format!("A3={} B3={} C3={}", w(v.x), w(v.y), w(v.z))
}

fn rotary(machine: &Machine, joints: &Joints) -> String {
    words::rotary(machine, joints, "=")
}
