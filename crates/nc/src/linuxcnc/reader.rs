//! Reader of the LinuxCNC dialect: words of lines. It shares no code with the writer.
//!
//! Modal: G0 and G1, X Y Z and the rotary axes of the machine, F, S. Comments stand in brackets or after a semicolon; blanks and case have no meaning.
//! The reader accepts the words that the interpreter accepts, and they act in the same order (manual, "Order of
//! Execution").

use super::comments::{COMMENT, behind_number, code_of};
use super::subprograms;
use crate::control::modal::{Modal, ModalGroup, Needed};
use crate::control::{
    self, Act, CodeName, Control, LengthWord, Line, MotionWord, NcBlock, Setup, Smoothing, SmoothingTolerance,
    WIDEST_TOLERANCE_MM, WorkOffsets, number, number_end, once, rotary_letter, shown,
};
use crate::nc::{NcTool, ReadError, ReadResult};
use five_axis::Machine;

/// Rounding of ten times the number of a G word: G61.1 is one code, G61.11 is none.
const CODE_ROUNDING: f64 = 1e-6;

/// Most M words of a block.
const MAX_M_WORDS: usize = 4;

/// Largest turn of the work offset, degrees.
const MAX_OFFSET_TURN_DEG: f64 = 360.0;

/// The word for a work offset without rotation, as a message names it.
const NO_ROTATION: &str = "G10 L2 P1 R0";

/// Names of the work offsets by their number in G10 L2, from 1.
const OFFSET_NAMES: [&str; 9] = ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"];

/// The work offsets.
pub(super) const OFFSETS: WorkOffsets =
    WorkOffsets { usual: "G54", all: "G54 to G59 and G59.1 to G59.3", has: |name| OFFSET_NAMES.contains(&name) };

/// Number of a work offset in G10 L2.
pub(super) fn offset_number(name: &str) -> Option<u32> {
    OFFSET_NAMES.iter().zip(1..).find(|(known, _)| **known == name).map(|(_, number)| number)
}

/// The control.
const LINUXCNC: Control = Control {
    modal: &[
        Modal { what: "the plane", wrong: &["G18", "G19", "G17.1", "G18.1", "G19.1"], ..Modal::PLANE },
        Modal::UNITS,
        Modal::DISTANCE,
        Modal {
            group: ModalGroup::Diameter,
            what: "X as a coordinate, not as a diameter",
            right: &["G8"],
            wrong: &["G7"],
            needed: Needed::Always,
        },
        Modal::FEED_MODE,
        Modal {
            group: ModalGroup::SpindleMode,
            what: "spindle speed in rpm",
            right: &["G97"],
            wrong: &["G96"],
            needed: Needed::AtFeed,
        },
        Modal { wrong: &["G41", "G42", "G41.1", "G42.1"], ..Modal::COMPENSATION },
        Modal { wrong: &["G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"], ..Modal::WORK_OFFSET },
        Modal {
            group: ModalGroup::Shift,
            what: "no remaining offset of G92 or G52",
            right: &["G92.1", "G92.2"],
            wrong: &["G92.3"],
            needed: Needed::InWorkFrame,
        },
        Modal {
            group: ModalGroup::Rotation,
            what: "no rotation of the work offset",
            right: &[NO_ROTATION],
            wrong: &[],
            needed: Needed::InWorkFrame,
        },
        Modal::SPINDLE,
        Modal::COOLANT,
    ],
    order: &[
        Act::Set(ModalGroup::FeedMode),
        Act::Feed,
        Act::Speed,
        Act::Select,
        Act::Change,
        Act::Set(ModalGroup::SpindleMode),
        Act::Set(ModalGroup::Spindle),
        Act::Set(ModalGroup::Coolant),
        Act::Transform,
        Act::Wait,
        Act::Set(ModalGroup::Plane),
        Act::Set(ModalGroup::Units),
        Act::Set(ModalGroup::Diameter),
        Act::Set(ModalGroup::Compensation),
        Act::Length,
        Act::Set(ModalGroup::WorkOffset),
        Act::Smooth,
        Act::Set(ModalGroup::Distance),
        Act::Set(ModalGroup::Shift),
        Act::Set(ModalGroup::Rotation),
        Act::TurnFrame,
        Act::Move,
        Act::End,
    ],
    transformation: ["M428", "M429"],
    clamps: false,
    length: "G43",
    smoothing: "G64 P with a tolerance",
    end: "M2",
    offsets: &OFFSETS,
    unturned: "write `G10 L2 P1 R0` before this block",
    machine_frame_drops_length: true,
    feed_mode_drops_feed: true,
    modulo: false,
    end_switches_off: true,
    ..Control::ISO
};

/// State of the `%` lines.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Tape {
    /// Before any block.
    Start,
    /// After the first `%`.
    Open,
    /// The text has blocks and no `%`.
    None,
}

/// Reads a program.
pub(super) fn read(text: &str, machine: &Machine, offset: &str) -> ReadResult {
    let mut tape = Tape::Start;
    let mut ended = false;
    let mut buffer = Vec::new();
    let mut selected: Option<(usize, NcTool)> = None;
    let number = offset_number(offset).unwrap_or(1);
    let sections = control::read_in_order(
        text,
        Setup { control: &LINUXCNC, machine, part_offset: offset },
        &subprograms::flow(text),
        |Line { text: line, arguments, number: at }, faults| {
            let code = match code_of(line, &mut buffer) {
                Ok(code) => code,
                Err(reason) => {
                    faults.push(reason);
                    return None;
                }
            };
            if code.is_empty() {
                return None;
            }
            if code == "%" {
                let end = NcBlock { end: Some("%"), ..NcBlock::default() };
                return match std::mem::replace(&mut tape, Tape::Open) {
                    Tape::Start => None,
                    // The control reads nothing behind M2 and M30.
                    Tape::Open if ended => None,
                    Tape::Open => Some(end),
                    Tape::None => {
                        faults
                            .push("`%` after blocks: it must be in the first and the last line, or nowhere".to_owned());
                        None
                    }
                };
            }
            if tape == Tape::Start {
                tape = Tape::None;
            }
            let block = block(&code, arguments, number, machine, faults)?;
            if let Some(tool) = &block.tool
                && let Some((_, before)) = selected.replace((at, tool.clone())).filter(|(_, before)| before != tool)
            {
                faults.push(never_changed(&before));
            }
            if block.change {
                selected = None;
            }
            ended |= block.end.is_some();
            Some(block)
        },
    );
    let sections = match selected {
        Some((line, tool)) if sections.is_ok() => Err(vec![ReadError { line, reason: never_changed(&tool) }]),
        _ => sections,
    };
    // The words of the group name the first offset.
    let named = format!("G10 L2 P{number} R0");
    sections.map_err(|faults| {
        let renamed = |fault: ReadError| ReadError { reason: fault.reason.replace(NO_ROTATION, &named), ..fault };
        faults.into_iter().map(renamed).collect()
    })
}

/// Why a T word without M6 is refused.
fn never_changed(tool: &NcTool) -> String {
    format!(
        "T{tool} is selected and never comes into the spindle: the control stops where its tool table has no such tool"
    )
}

/// Number of a word.
#[derive(Clone, Copy)]
enum Number<'a> {
    /// As written.
    Plain(&'a str),
    /// Inside of square brackets.
    Computed(&'a str),
}

/// First word of a text without blanks: its letter, its number, and the rest.
fn first_word(code: &str) -> Result<(char, Number<'_>, &str), String> {
    let letter = code.chars().next().unwrap_or(' ');
    if !letter.is_ascii_alphabetic() {
        let why = match letter {
            '/' => ": whether a deleted block runs depends on a switch at the control",
            '#' | '[' | '<' => ": parameters and expressions are not read",
            _ => "",
        };
        return Err(format!("`{}` is not understood at the beginning of a word{why}", shown(code, 1)));
    }
    let tail = &code[1..];
    if let Some((inside, rest)) = tail.strip_prefix('[').and_then(|t| t.split_once(']')) {
        return Ok((letter, Number::Computed(inside), rest));
    }
    let (number, rest) = tail.split_at(number_end(tail));
    Ok((letter, Number::Plain(number), rest))
}

/// Words that belong to a code of the same line.
#[derive(Default)]
struct Parameters {
    h: Option<u32>,
    p: Option<f64>,
    q: Option<f64>,
    l: Option<u32>,
    r: Option<f64>,
    path: Option<&'static str>,
    length: Option<bool>,
    data: bool,
    /// Words of the groups that [`ModalGroup`] does not have.
    others: [Option<&'static str>; OTHER_GROUPS],
    m_words: usize,
}

/// Groups of the interpreter of which a block has one word at most, and that are no group of [`ModalGroup`].
#[derive(Clone, Copy, PartialEq, Eq)]
enum OtherGroup {
    /// G4, G10, G53: group 0.
    NonModal,
    /// G91.1: group 4.
    ArcDistance,
    /// G98, G99: group 10.
    Retract,
    /// M0, M1, M2, M30: M group 4.
    Stopping,
    /// M48: M group 9.
    Overrides,
}

/// Number of these groups.
const OTHER_GROUPS: usize = OtherGroup::Overrides as usize + 1;

impl Parameters {
    /// Takes a word of a group of which a block has one word at most.
    fn other(&mut self, group: OtherGroup, word: &'static str) -> Result<(), String> {
        let place = &mut self.others[group as usize];
        match *place {
            None => {
                *place = Some(word);
                Ok(())
            }
            Some(before) if before == word => Err(format!("`{word}` occurs twice in one block")),
            Some(before) => Err(format!("`{before}` and `{word}` in one block: the control takes one of them")),
        }
    }
}

/// The block of a line in a call with some values, where the part is in the work offset with a number.
fn block(code: &str, arguments: &[f64], offset: u32, machine: &Machine, faults: &mut Vec<String>) -> Option<NcBlock> {
    let mut block = NcBlock::default();
    let mut parameters = Parameters::default();
    let mut rest = behind_number(code).unwrap_or(code);
    let mut empty = true;
    while !rest.is_empty() {
        if let Some(behind) = rest.strip_prefix(COMMENT) {
            rest = behind;
            continue;
        }
        let (letter, found, next) = match first_word(rest) {
            Ok(word) => word,
            Err(reason) => {
                faults.push(reason);
                break;
            }
        };
        rest = next;
        let done = match found {
            Number::Plain(text) => word(letter, text, machine, &mut block, &mut parameters),
            Number::Computed(text) => turned_word(letter, text, arguments, machine, &mut block),
        };
        empty = false;
        faults.extend(done.err());
    }
    if let Err(reason) = together(&mut block, &parameters, offset) {
        faults.push(reason);
    }
    (!empty).then_some(block)
}

/// Checks the codes and parameters of one block together.
fn together(block: &mut NcBlock, parameters: &Parameters, offset: u32) -> Result<(), String> {
    let good = |tolerance: f64| tolerance > 0.0 && tolerance <= WIDEST_TOLERANCE_MM;
    let Parameters { p, q, .. } = *parameters;
    let mut used = [false; 2];
    match parameters.path {
        Some("G64") => {
            let Some(p) = p else {
                block.smoothing = Some(Smoothing::Left("G64 without P"));
                return q.map_or(Ok(()), |_| Err("G64 Q without P: the tolerance of corners is unknown".to_owned()));
            };
            used = [true, true];
            if p == 0.0 {
                block.smoothing = Some(Smoothing::Left("G64 P0"));
            } else if !good(p) {
                return Err(format!("the tolerance P of G64 must be above 0 and at most {WIDEST_TOLERANCE_MM}"));
            } else if q.is_some_and(|q| q != 0.0 && !good(q)) {
                return Err(format!("the tolerance Q of G64 must be at most {WIDEST_TOLERANCE_MM}"));
            } else {
                // P is the tolerance of blending at corners. Before blending, moves nearly in line are joined within Q;
                // without Q the interpreter uses P.
                block.smoothing = Some(Smoothing::Within(SmoothingTolerance { path: p + q.unwrap_or(p), turn: None }));
            }
        }
        Some(_) => block.smoothing = Some(Smoothing::Within(SmoothingTolerance { path: 0.0, turn: None })),
        None => {}
    }
    if parameters.data {
        used[0] = true;
        let (Some(2), true, Some(turn)) = (parameters.l, p == Some(f64::from(offset)), parameters.r) else {
            return Err(format!("of G10 only {NO_ROTATION} is understood; set offsets at the machine"));
        };
        if turn.abs() > MAX_OFFSET_TURN_DEG {
            return Err(format!("G10 turns the work offset by {turn} deg; at most {MAX_OFFSET_TURN_DEG} deg are read"));
        }
        block.frame_turn = Some(turn.to_radians());
        if block.tip != [None; 3] || block.rotary != [None; 2] {
            return Err("G10 with axis words changes the work offset: set offsets at the machine".to_owned());
        }
        block.modal.set(ModalGroup::Rotation, NO_ROTATION);
    }
    if block.wait == Some("G4") {
        used[0] = true;
        match p {
            None => return Err("G4 without P: the waiting time is unknown".to_owned()),
            Some(p) if p < 0.0 => return Err("the waiting time of G4 is negative".to_owned()),
            Some(_) => {}
        }
    }
    if (p.is_some() && !used[0]) || (q.is_some() && !used[1]) {
        return Err("P or Q without G64".to_owned());
    }
    if (parameters.l.is_some() || parameters.r.is_some()) && !parameters.data {
        return Err("L or R without G10".to_owned());
    }
    block.length = match (parameters.length, parameters.h) {
        (None, None) => None,
        (Some(true), None) => Some(LengthWord::OfSpindle),
        (Some(true), Some(0)) => return Err("G43 H0 sets no length: write the number of the tool".to_owned()),
        (Some(true), Some(h)) => Some(LengthWord::Of(h)),
        (Some(false), None) => Some(LengthWord::Off),
        (_, Some(_)) => return Err("H without G43".to_owned()),
    };
    if parameters.m_words > MAX_M_WORDS {
        return Err(format!("more than {MAX_M_WORDS} M words in one block: the control refuses the line"));
    }
    if block.motion == Some(MotionWord::Feed) && !block.has_axis_words() {
        return Err(
            "G1 without an axis word: the control takes it as a move at feed; write it with its target".to_owned()
        );
    }
    if block.modal.get(ModalGroup::SpindleMode) == Some("G96") && block.speed.is_none() {
        return Err("G96 without S: the control refuses the block".to_owned());
    }
    if parameters.data && matches!(block.motion, Some(MotionWord::Rapid | MotionWord::Feed)) {
        return Err("G10 in a block with G0 or G1: write it in a block of its own".to_owned());
    }
    Ok(())
}

/// A word of a rotary axis whose position depends on the call.
fn turned_word(
    letter: char,
    text: &str,
    arguments: &[f64],
    machine: &Machine,
    block: &mut NcBlock,
) -> Result<(), String> {
    let Some(axis) = rotary_letter(machine, letter) else {
        return Err(format!("`{letter}[{}]`: expressions are read for rotary axes only", shown(text, 20)));
    };
    let [written, value] = subprograms::computed(text, arguments)?;
    block.shifted |= value != written;
    block.angle(axis, value, machine)
}

/// A whole number as the interpreter accepts it: leading zeros and a decimal point are allowed.
fn count(text: &str) -> Result<u32, String> {
    let value = number(text)?;
    if value.fract() == 0.0 && (0.0..=1e9).contains(&value) {
        Ok(value as u32)
    } else {
        Err(format!("`{}` is not a whole number", shown(text, 20)))
    }
}

fn word(
    letter: char,
    text: &str,
    machine: &Machine,
    block: &mut NcBlock,
    parameters: &mut Parameters,
) -> Result<(), String> {
    let named = |reason: String| format!("`{letter}{}`: {reason}", shown(text, 20));
    let value = || number(text).map_err(named);
    let number_of = || count(text).map_err(named);
    match letter {
        'X' => block.coordinate(0, value()?),
        'Y' => block.coordinate(1, value()?),
        'Z' => block.coordinate(2, value()?),
        'A'..='C' if let Some(axis) = rotary_letter(machine, letter) => block.angle(axis, value()?, machine),
        'F' => block.set_feed(value()?),
        'S' => block.set_speed(value()?),
        'T' => once(&mut block.tool, "T", NcTool::Number(number_of()?)),
        'H' => once(&mut parameters.h, "H", number_of()?),
        'P' => once(&mut parameters.p, "P", value()?),
        'Q' => once(&mut parameters.q, "Q", value()?),
        'L' => once(&mut parameters.l, "L", number_of()?),
        'R' => once(&mut parameters.r, "R", value()?),
        'G' => preparatory(&code_name('G', value()?)?, block, parameters),
        'M' => {
            parameters.m_words += 1;
            miscellaneous(&code_name('M', value()?)?, block, parameters)
        }
        'N' => Err(format!("`N{}`: a block number must be at the start of its block", shown(text, 20))),
        'O' => Err("an O word must be at the start of its line".to_owned()),
        _ => Err(format!("`{letter}{}` is not understood", shown(text, 20))),
    }
}

/// The name of a code in one spelling: G01 and G1.0 are G1.
fn code_name(letter: char, value: f64) -> Result<CodeName, String> {
    let tenths = (value * 10.0).round();
    if (tenths - value * 10.0).abs() > CODE_ROUNDING || !(0.0..1e5).contains(&tenths) {
        return Err(format!("`{letter}{value}` is not understood"));
    }
    let tenths = tenths as u32;
    Ok(CodeName::new(letter, tenths / 10, Some((tenths % 10) as u8).filter(|tenth| *tenth > 0)))
}

fn preparatory(code: &str, block: &mut NcBlock, parameters: &mut Parameters) -> Result<(), String> {
    match code {
        "G0" => return motion(block, MotionWord::Rapid),
        "G1" => return motion(block, MotionWord::Feed),
        _ => {}
    }
    if let Some(done) = block.modal_word(&LINUXCNC, code) {
        return done;
    }
    let mut path = |word| match parameters.path.replace(word) {
        Some(before) => Err(format!("`{before}` and `{word}` in one block both set the path mode")),
        None => Ok(()),
    };
    match code {
        "G80" => motion(block, MotionWord::Cancelled),
        "G53" => {
            block.machine_frame = true;
            parameters.other(OtherGroup::NonModal, "G53")
        }
        "G43" => once(&mut parameters.length, "G43 or G49", true),
        "G49" => once(&mut parameters.length, "G43 or G49", false),
        "G61" => path("G61"),
        "G61.1" => path("G61.1"),
        "G64" => path("G64"),
        "G10" => {
            parameters.data = true;
            parameters.other(OtherGroup::NonModal, "G10")
        }
        "G4" => {
            block.wait = Some("G4");
            parameters.other(OtherGroup::NonModal, "G4")
        }
        // These concern arcs and the retract of cycles; the reader accepts neither.
        "G91.1" => parameters.other(OtherGroup::ArcDistance, "G91.1"),
        "G98" => parameters.other(OtherGroup::Retract, "G98"),
        "G99" => parameters.other(OtherGroup::Retract, "G99"),
        "G2" | "G3" | "G5" | "G5.1" | "G5.2" | "G5.3" => {
            Err(format!("`{code}` is not understood: of motions only G0 and G1 are read"))
        }
        "G28" | "G30" => Err(format!(
            "`{code}` is not understood: its target is set at the control; write \
                                      `G53 G0 Z...`"
        )),
        "G52" | "G92" => Err(format!("`{code}` is not understood: it shifts the work frame")),
        "G43.1" | "G43.2" => {
            Err(format!("`{code}` is not understood: it changes the tool length beside the tool table"))
        }
        "G73" | "G81" | "G82" | "G83" | "G84" | "G85" | "G86" | "G89" => {
            Err(format!("`{code}` is not understood: cycles are not read"))
        }
        _ => Err(format!("`{code}` is not understood")),
    }
}

fn motion(block: &mut NcBlock, motion: MotionWord) -> Result<(), String> {
    match block.motion.replace(motion) {
        Some(_) => Err("two of G0, G1 and G80, or one twice, in one block".to_owned()),
        None => Ok(()),
    }
}

fn miscellaneous(code: &str, block: &mut NcBlock, parameters: &mut Parameters) -> Result<(), String> {
    if let Some(done) = block.modal_word(&LINUXCNC, code) {
        return done;
    }
    match code {
        "M428" => once(&mut block.transformation, "M428 or M429", true),
        "M429" => once(&mut block.transformation, "M428 or M429", false),
        "M2" | "M30" => {
            let word = if code == "M2" { "M2" } else { "M30" };
            block.end = Some(word);
            parameters.other(OtherGroup::Stopping, word)
        }
        "M0" | "M1" => {
            let word = if code == "M0" { "M0" } else { "M1" };
            block.wait = Some(word);
            parameters.other(OtherGroup::Stopping, word)
        }
        "M6" if block.change => Err("`M6` occurs twice in one block".to_owned()),
        "M6" => {
            block.change = true;
            Ok(())
        }
        // These permit overrides of feed and spindle by hand, as at the start of a program.
        "M48" => parameters.other(OtherGroup::Overrides, "M48"),
        _ => Err(format!("`{code}` is not understood")),
    }
}

/// Whether a block holds a word that only this dialect has.
pub(super) fn recognises(code: &str) -> bool {
    // Rotary words, G49 and G92.1 are those of other controls as well.
    const OWN_WORDS: [&str; 2] = ["M428", "M429"];
    let mut words = code.split_whitespace();
    let (first, second) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    OWN_WORDS.contains(&first) || (first == "G64" && second.starts_with('P')) || (first == "G10" && second == "L2")
}
