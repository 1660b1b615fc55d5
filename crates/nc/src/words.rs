//! Numbers of NC words, and checks that all dialects share.

use base::source::Span;
use diagnostics::{Diag, Sink, codes::post};
use five_axis::control::{LengthTo, Planning};
use five_axis::{Angles, Machine};
use ir::{Motion, MoveKind, Program, Tool};
use wheel::control::Orientation;

/// Share of a step of F within which a feed counts as on the step, whatever rounding does.
const ON_STEP: f64 = 1e-6;

/// Turn of rotary axis 2 between blocks, radians, from which on the nearest rotary position is not certain to be the right one.
const CERTAIN_TURN: f64 = std::f64::consts::FRAC_PI_2;

/// Decimals of F in inverse time, in moves a minute.
pub const INVERSE_DECIMALS: i32 = 5;
/// Largest F in inverse time; a move that would need a larger F is written with this value.
const MAX_INVERSE: f64 = 1e5;

/// A number with fixed decimals and without a negative zero.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    if zero { text.trim_start_matches('-').to_owned() } else { text }
}

/// A feed, rounded down, since the proof of the axes holds for no larger feed.
pub fn feed(value: f64, decimals: usize) -> f64 {
    let scale = 10f64.powi(i32::try_from(decimals).unwrap_or(0));
    (value * scale + ON_STEP).floor() / scale
}

/// F of a move in inverse time, rounded down, since the proof of the axes holds for no shorter time. `time` in s.
pub fn inverse_time(time: f64) -> String {
    let scale = 10f64.powi(INVERSE_DECIMALS);
    let per_minute = (60.0 / time).min(MAX_INVERSE);
    fixed((per_minute * scale).floor() / scale, usize::try_from(INVERSE_DECIMALS).unwrap_or(0))
}

/// A text with only such characters as are allowed in a comment of every dialect.
pub fn comment(text: &str) -> String {
    // The sign ends a program of the Fanuc family.
    let spelt = text.replace('%', "percent");
    spelt
        .chars()
        .map(|c| match c {
            '(' | '[' | '{' => '<',
            ')' | ']' | '}' => '>',
            ';' => ',',
            // Klartext goes on in the next line after it.
            '~' => '-',
            c if c.is_ascii() && !c.is_ascii_control() => c,
            _ => '?',
        })
        .take(120)
        .collect()
}

/// Refuses a tool number outside of 1 to the largest one; `takes` begins the remedy.
pub(super) fn check_tool_number(tool: &Tool, largest: u32, takes: &str, sink: &mut Sink) {
    if tool.number == 0 || tool.number > largest {
        sink.push(
            Diag::error(post::TOOL_NUMBER, format!("tool {} has the number {}", tool.name, tool.number))
                .label(tool.span, "declared here")
                .help(format!("{takes} from 1 to {largest}: `number 1`")),
        );
    }
}

/// Whether the rotary position nearest to that of the block before is not certain to be the right one for a vector.
pub(super) fn fits_two_positions(machine: &Machine, before: Angles, to: Angles) -> bool {
    (to[1] - before[1]).abs() >= CERTAIN_TURN || machine.chain.changes_branch(before[0], to[0])
}

/// A diagnostic about a machine that the post does not take, at the place that names the post.
pub(super) fn at(chosen: Option<Span>, diag: Diag) -> Diag {
    match chosen {
        Some(span) => diag.label(span, "the post is chosen here"),
        None => diag,
    }
}

/// Refuses a machine whose motion has what only the dialect of LinuxCNC has words for.
pub(super) fn check_planning(machine: &Machine, chosen: Option<Span>, sink: &mut Sink) {
    if machine.planning == Planning::LinuxCnc {
        sink.push(at(
            chosen,
            Diag::error(
                post::CONTROL,
                format!(
                    "motions of machine {} have exact stops and times of rapids, and this post has no words for both",
                    machine.name
                ),
            )
            .note("without them LinuxCNC leaves the path and the speeds of the joints")
            .help("use the post `linuxcnc`, or the file of a machine without `planning = \"linuxcnc-2.9\"`"),
        ));
    }
}

/// Refuses a machine whose tool lengths no dialect writes yet.
pub(super) fn check_length_to(machine: &Machine, chosen: Option<Span>, sink: &mut Sink) {
    if machine.length_to != LengthTo::Tip {
        let to = machine.length_to.name();
        let text = format!(
            "tool lengths of the machine {} refer to the {to}; this post writes positions of the tip",
            machine.name
        );
        sink.push(at(
            chosen,
            Diag::error(post::CONTROL, text)
                .note("the tool would cut too deep or too high by the radius of its end")
                .help("measure tool lengths to the tip, and write `tool-length = \"tip\"` in the machine file"),
        ));
    }
}

/// Refuses a motion that no dialect can express.
pub fn check(program: &Program, motion: &Motion, sink: &mut Sink) {
    let plain = |name: &str| {
        !name.is_empty() && name.len() <= 24 && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
    };
    if !plain(&program.name) {
        sink.push(
            Diag::error(post::NAME, format!("`{}` cannot be the name of an NC program", program.name))
                .label(program.name_span, "the name of the part is that of the program")
                .help("use at most 24 letters, digits, `-` and `_`"),
        );
    }
    for operation in &motion.operations {
        let declared = &program.operations[operation.operation];
        let tool = &program.tools[declared.tool];
        if !plain(&tool.name) {
            sink.push(
                Diag::error(post::NAME, format!("`{}` cannot be the name of a tool in NC text", tool.name))
                    .label(tool.span, "declared here")
                    .help("use at most 24 letters, digits, `-` and `_`"),
            );
        }
        let mut before = None;
        for m in &operation.moves {
            let tip = program.machine.forward(&m.joints).tip;
            let still = before.is_some_and(|b: nalgebra::Point3<f64>| (tip - b).norm() < 1e-4);
            if still && m.kind != MoveKind::Rapid {
                sink.push(
                    Diag::error(
                        post::STANDSTILL,
                        format!("`{}` turns the tool at feed without moving its tip", declared.name),
                    )
                    .label(declared.span, "in this operation")
                    .place(operation.labels.get(m.pass as usize).cloned().unwrap_or_default(), tip)
                    .note("the feed of such a block means something else in every control")
                    .help("this is a fault of the compiler: report the job file"),
                );
                break;
            }
            before = Some(tip);
        }
    }
}

/// Refuses a motion whose directions, as vectors, do not say which of two rotary positions is meant. Blocks of rapids
/// carry the positions themselves.
pub(super) fn check_vectors(program: &Program, motion: &Motion, sink: &mut Sink) {
    // Positions of the rotary axes leave no choice to the control.
    if program.post.control.orientation == Orientation::Angles {
        return;
    }
    for operation in &motion.operations {
        let declared = &program.operations[operation.operation];
        let unsure = operation.moves.windows(2).find(|m| {
            let [a, b] = [m[0].joints.rotary, m[1].joints.rotary];
            m[1].kind != MoveKind::Rapid && fits_two_positions(&program.machine, a, b)
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_word_comes_back_within_half_a_step(value in -1e4..1e4_f64, decimals in 0..9_usize) {
            let text = fixed(value, decimals);
            let back: f64 = text.parse().unwrap();
            prop_assert!((back - value).abs() <= 0.5000001 * 10f64.powi(-(decimals as i32)));
            let is_negative_zero = back == 0.0 && text.starts_with('-');
            prop_assert!(!is_negative_zero);
        }

        #[test]
        fn a_feed_is_never_rounded_up(value in 0.001..1e5_f64) {
            let back: f64 = fixed(feed(value, 3), 3).parse().unwrap();
            prop_assert!(back <= value + 1e-8 && value - back < 1e-3);
        }
    }
}
