//! Reader of the 840D dialect: words of blocks. It shares no code with the writer.
//!
//! Modal: G0 and G1, X Y Z, F, S, the direction as a whole. The reader accepts a vector only with all three components:
//! the control takes a missing component as 0, which is never intended. Case matters only in names of tools; words may
//! follow each other without a blank.

use super::repetition;
use super::words::{WordValue, count, is_count, split, upper};
use crate::control::modal::{Modal, ModalGroup, Needed};
use crate::control::spline::SplineWords;
use crate::control::{
    self, Act, CodeName, Control, LengthWord, Line, MotionWord, NcBlock, Setup, Smoothing, SmoothingTolerance,
    WIDEST_TOLERANCE_MM, WIDEST_TURN_DEG, WorkOffsets, in_range, number, once, rotary_axis, shown, trim_start,
};
use crate::nc::{NcTool, ReadResult};
use five_axis::Machine;
use std::collections::BTreeMap;

/// Largest turn of the work frame, degrees.
const MAX_FRAME_TURN_DEG: f64 = 360.0;

/// Most orientation transformations of a channel.
const MAX_TRANSFORMATIONS: u32 = 10;

/// Longest block of the control.
const MAX_BLOCK_LENGTH: usize = 512;

/// The settable work offsets: G54 to G57, and further ones where machine data provide them.
pub(super) const OFFSETS: WorkOffsets =
    WorkOffsets { usual: "G54", all: "G54 to G57 and G505 to G599", has: is_offset };

fn is_offset(name: &str) -> bool {
    let number = name.strip_prefix('G').filter(|digits| digits.len() <= 3 && !digits.starts_with('0'));
    number.and_then(|digits| count(digits).ok()).is_some_and(|n| (54..=57).contains(&n) || (505..=599).contains(&n))
}

/// The control.
const SINUMERIK: Control = Control {
    modal: &[
        Modal::PLANE,
        Modal {
            group: ModalGroup::Units,
            what: "lengths and feeds in mm",
            right: &["G710"],
            wrong: &["G71", "G70", "G700"],
            needed: Needed::Always,
        },
        Modal::DISTANCE,
        Modal { wrong: &["G95", "G96", "G97", "G961", "G962", "G971"], ..Modal::FEED_MODE },
        Modal::COMPENSATION,
        Modal {
            what: "the work offset, which TRAORI and TRAFOOF reset",
            wrong: &["G500", "G55", "G56", "G57"],
            ..Modal::WORK_OFFSET
        },
        Modal {
            group: ModalGroup::Shift,
            what: "no programmable frame",
            right: &["TRANS"],
            wrong: &[],
            needed: Needed::InWorkFrame,
        },
        Modal {
            group: ModalGroup::VectorFrame,
            what: "the frame of tool directions",
            right: &["ORIWKS"],
            wrong: &["ORIMKS"],
            needed: Needed::Transformed,
        },
        Modal {
            group: ModalGroup::Turning,
            what: "the interpolation of the tool direction",
            right: &["ORIAXES", "ORICURVE"],
            wrong: &["ORIVECT", "ORIPLANE", "ORIPATH", "ORIPATHS", "ORICONCW", "ORICONCCW", "ORICONIO", "ORICONTO"],
            needed: Needed::Transformed,
        },
        Modal::SPINDLE,
        Modal::COOLANT,
    ],
    order: &[
        Act::Set(ModalGroup::Plane),
        Act::Set(ModalGroup::Units),
        Act::Set(ModalGroup::Distance),
        Act::Set(ModalGroup::FeedMode),
        Act::Feed,
        Act::Speed,
        Act::Set(ModalGroup::Compensation),
        Act::Select,
        Act::Change,
        Act::Set(ModalGroup::Spindle),
        Act::Set(ModalGroup::Coolant),
        Act::Length,
        Act::Transform,
        Act::Set(ModalGroup::WorkOffset),
        Act::Set(ModalGroup::Shift),
        Act::TurnFrame,
        Act::Set(ModalGroup::VectorFrame),
        Act::Set(ModalGroup::Turning),
        Act::Smooth,
        Act::Wait,
        Act::Move,
        Act::End,
    ],
    transformation: ["TRAORI", "TRAFOOF"],
    machine_frame: "SUPA G0",
    behind: " D0",
    spline_motion: MotionWord::Polynomial,
    vector: ["A3", "B3", "C3"],
    length: "D1",
    smoothing: "CYCLE832 with a tolerance",
    offsets: &OFFSETS,
    unturned: "write ROT alone in a block before",
    great_circle: &["ORIVECT", "ORIPLANE"],
    switching_drops_frames: true,
    change_drops_length: true,
    ..Control::ISO
};

/// Words that change neither the path nor any value that is checked. Words of smoothing keep the tolerance of CYCLE832.
const HARMLESS: [&str; 17] = [
    "SOFT",
    "FFWON",
    "FFWOF",
    "STOPRE",
    "RTLION",
    "COMPCAD",
    "COMPOF",
    "DYNNORM",
    "DYNPOS",
    "DYNROUGH",
    "DYNSEMIFIN",
    "DYNFINISH",
    "G9",
    "G60",
    "G601",
    "G642",
    "G645",
];

/// Reads a program.
pub(super) fn read(text: &str, machine: &Machine, offset: &str) -> ReadResult {
    // Values of the R parameters; at the start they are unknown.
    let mut parameters = BTreeMap::new();
    let mut transformation = None;
    control::read_in_order(
        text,
        Setup { control: &SINUMERIK, machine, part_offset: offset },
        &repetition::flow(text),
        |Line { text: line, number, .. }, faults| {
            let line = line.strip_suffix('\r').unwrap_or(line);
            if line.len() > MAX_BLOCK_LENGTH && !line.trim_start().starts_with(';') {
                faults.push(format!("longer than {MAX_BLOCK_LENGTH} characters"));
                return None;
            }
            // First line of a transferred file.
            if number == 1 && line.starts_with("%_N_") {
                return None;
            }
            let mut reader = BlockReader {
                machine,
                parameters: &mut parameters,
                transformation: &mut transformation,
                block: NcBlock::default(),
                words: 0,
                alone: None,
                frame: None,
                frame_turn: None,
                assigned: 0,
                edge: None,
                polynomials: Default::default(),
            };
            if let Err(reason) = reader.words(line) {
                faults.push(reason);
            }
            if let Err(reason) = reader.together() {
                faults.push(reason);
            }
            (reader.words > 0).then_some(reader.block)
        },
    )
}

struct BlockReader<'a> {
    machine: &'a Machine,
    parameters: &'a mut BTreeMap<u32, f64>,
    /// Number of the transformation of the program.
    transformation: &'a mut Option<u32>,
    block: NcBlock,
    words: usize,
    /// A word that must be the only one in its block.
    alone: Option<&'static str>,
    /// A word that shifts or rotates the work frame.
    frame: Option<&'static str>,
    /// Turn about Z behind ROT, degrees.
    frame_turn: Option<f64>,
    /// Number of R parameters that get a value.
    assigned: usize,
    edge: Option<u32>,
    /// Polynomials of X Y Z and XH YH ZH.
    polynomials: [Option<Vec<f64>>; 6],
}

impl BlockReader<'_> {
    /// All words of a block.
    fn words(&mut self, line: &str) -> Result<(), String> {
        let mut rest = line;
        let mut first = true;
        loop {
            rest = trim_start(rest);
            if matches!(rest.as_bytes().first(), None | Some(b';')) {
                return Ok(());
            }
            let (name, value, next) = split(rest)?;
            rest = next;
            let numbered = first && name == "N" && matches!(value, WordValue::Number(n) if is_count(n));
            first = false;
            if !numbered {
                self.words += 1;
                self.word(&name, &value)?;
            }
        }
    }

    fn word(&mut self, name: &str, value: &WordValue<'_>) -> Result<(), String> {
        match value {
            WordValue::Number(text) => self.valued(name, text),
            WordValue::Computed { number, sum, parameter } => self.computed(name, number, *sum, parameter),
            WordValue::Shorter(text) => match rotary_axis(self.machine, name) {
                Some(k) if self.machine.rotary[k].modulo.is_some() => {
                    let degrees = number(text.trim_matches([' ', '\t']))?;
                    self.block.angle(k, degrees, self.machine)
                }
                _ => Err(format!(
                    "`{0}=DC(...)`: {0} is no axis modulo 360 deg in the machine file; write its position",
                    shown(name, 20)
                )),
            },
            WordValue::Quoted(text) if name == "T" && !text.is_empty() => {
                once(&mut self.block.tool, "T", control::name(text))
            }
            WordValue::Quoted(_) => Err(format!("`{name}` with a text in quotes is not understood")),
            // A text for the screen.
            WordValue::Arguments(_) if name == "MSG" => Ok(()),
            WordValue::Arguments(arguments) if name == "CYCLE832" => {
                self.alone = Some("CYCLE832");
                once(&mut self.block.smoothing, "CYCLE832", smoothing(arguments)?)
            }
            WordValue::Arguments(arguments) if name == "TRAORI" => self.traori(arguments),
            WordValue::Arguments(_) => Err(format!("`{}(...)` is not understood", shown(name, 40))),
            WordValue::Polynomial(coefficients) => self.polynomial(name, coefficients),
            WordValue::None => self.keyword(name),
        }
    }

    /// TRAORI, TRAORI() and TRAORI(1) switch the first orientation transformation on, TRAORI(n) the nth. The machine file
    /// describes one of them.
    fn traori(&mut self, arguments: &str) -> Result<(), String> {
        self.alone = Some("TRAORI");
        once(&mut self.block.transformation, "TRAORI or TRAFOOF", true)?;
        let number = match arguments.trim_matches([' ', '\t']) {
            "" => 1,
            text if text.contains(',') => {
                return Err(format!(
                    "`TRAORI({})` gives the transformation another base orientation or offsets: write TRAORI or TRAORI(n)",
                    shown(text, 40)
                ));
            }
            text => count(text).map_err(|reason| format!("`TRAORI({})`: {reason}", shown(text, 20)))?,
        };
        if !(1..=MAX_TRANSFORMATIONS).contains(&number) {
            return Err(format!("TRAORI({number}): the control has the transformations 1 to {MAX_TRANSFORMATIONS}"));
        }
        match *self.transformation.get_or_insert(number) {
            first if first != number => {
                Err(format!("TRAORI({number}) behind TRAORI({first}): the machine file describes one transformation"))
            }
            _ => Ok(()),
        }
    }

    /// PO[X]=(end, a2, a3, a4, a5): missing coefficients are 0.
    fn polynomial(&mut self, axis: &str, coefficients: &str) -> Result<(), String> {
        const AXES: [&str; 6] = ["X", "Y", "Z", "XH", "YH", "ZH"];
        let Some(k) = AXES.iter().position(|known| *known == axis) else {
            return Err(format!("`PO[{}]` is not understood: X Y Z XH YH ZH have polynomials", shown(axis, 20)));
        };
        let mut numbers = Vec::new();
        for text in coefficients.split(',') {
            let value = number(text.trim_matches([' ', '\t']))?;
            numbers.push(in_range(value).map_err(|reason| format!("`PO[{axis}]`: {reason}"))?);
        }
        if numbers.len() > MAX_POLYNOMIAL_NUMBERS {
            return Err(format!(
                "`PO[{axis}]` has {} numbers: the end and at most {} coefficients",
                numbers.len(),
                MAX_POLYNOMIAL_NUMBERS - 1
            ));
        }
        once(&mut self.polynomials[k], &format!("PO[{axis}]"), numbers)
    }

    fn keyword(&mut self, name: &str) -> Result<(), String> {
        if let Some(done) = self.block.modal_word(&SINUMERIK, name).filter(|_| name != "TRANS") {
            return done;
        }
        match name {
            "TRAORI" => self.traori(""),
            "TRAFOOF" => {
                self.alone = Some("TRAFOOF");
                once(&mut self.block.transformation, "TRAORI or TRAFOOF", false)
            }
            "SUPA" if self.block.machine_frame => Err("`SUPA` occurs twice in one block".to_owned()),
            "SUPA" => {
                self.block.machine_frame = true;
                Ok(())
            }
            "POLY" => match self.block.motion.replace(MotionWord::Polynomial) {
                Some(_) => Err("two of G0, G1 and POLY in one block".to_owned()),
                None => Ok(()),
            },
            "TRANS" => once(&mut self.frame, "TRANS", "TRANS"),
            "ROT" => once(&mut self.frame, "ROT", "ROT"),
            "SCALE" => once(&mut self.frame, "SCALE", "SCALE"),
            "MIRROR" => once(&mut self.frame, "MIRROR", "MIRROR"),
            "ATRANS" | "AROT" | "ASCALE" | "AMIRROR" => {
                Err(format!("`{name}` is not understood: it shifts or turns the work frame"))
            }
            "BRISK" | "DRIVE" => Err(format!("`{name}` is not understood: the axes would move without jerk limit")),
            _ if HARMLESS.contains(&name) => Ok(()),
            _ => Err(format!("`{}` is not understood", shown(name, 40))),
        }
    }

    /// A word of a rotary axis whose position depends on an R parameter.
    fn computed(&mut self, name: &str, text: &str, sum: bool, parameter: &str) -> Result<(), String> {
        let Some(axis) = rotary_axis(self.machine, name) else {
            return Err(format!("`{}` with an expression: expressions are read for rotary axes only", shown(name, 20)));
        };
        let given = count(parameter).ok().and_then(|n| self.parameters.get(&n));
        let given = given.ok_or_else(|| {
            format!("R{} has no value: no block before gives it one in this program", shown(parameter, 9))
        })?;
        let value = number(text)?;
        let position = if sum { value + given } else { value * given };
        plain(axis, self.machine)?;
        self.block.shifted |= position != value;
        self.block.angle(axis, position, self.machine)
    }

    fn valued(&mut self, name: &str, text: &str) -> Result<(), String> {
        let named = |reason: String| format!("`{name}{}`: {reason}", shown(text, 40));
        let value = || number(text).map_err(named);
        if let Some(n) = name.strip_prefix("R").and_then(|n| count(n).ok()) {
            self.assigned += 1;
            self.parameters.insert(n, value()?);
            return Ok(());
        }
        if self.frame == Some("ROT") {
            return match name {
                "Z" if number(text).is_ok_and(|turn| turn.abs() <= MAX_FRAME_TURN_DEG) => {
                    once(&mut self.frame_turn, "Z", value()?)
                }
                _ => Err(format!(
                    "`ROT {}{}`: turns of the work frame are read about Z only, up to {MAX_FRAME_TURN_DEG} deg",
                    shown(name, 20),
                    shown(text, 20)
                )),
            };
        }
        let block = &mut self.block;
        match name {
            "X" => block.coordinate(0, value()?),
            "Y" => block.coordinate(1, value()?),
            "Z" => block.coordinate(2, value()?),
            "XH" => once(&mut block.second[0], "XH", in_range(value()?)?),
            "YH" => once(&mut block.second[1], "YH", in_range(value()?)?),
            "ZH" => once(&mut block.second[2], "ZH", in_range(value()?)?),
            "A3" => block.component(&SINUMERIK, 0, value()?),
            "B3" => block.component(&SINUMERIK, 1, value()?),
            "C3" => block.component(&SINUMERIK, 2, value()?),
            name if let Some(axis) = rotary_axis(self.machine, name) => {
                let value = value()?;
                plain(axis, self.machine)?;
                block.angle(axis, value, self.machine)
            }
            "F" => block.set_feed(value()?),
            "S" => block.set_speed(value()?),
            "T" => once(&mut block.tool, "T", NcTool::Number(count(text).map_err(named)?)),
            "D" => once(&mut self.edge, "D", count(text).map_err(named)?),
            "G" | "M" => {
                let number = count(text).map_err(named)?;
                self.code(&CodeName::new(if name == "G" { 'G' } else { 'M' }, number, None))
            }
            "N" => Err("a block number must be at the start of its block".to_owned()),
            "A" | "B" | "C" => {
                Err(format!("`{name}{}` is not understood: the machine has no axis {name}", shown(text, 20)))
            }
            _ => Err(format!("`{}{}` is not understood", shown(name, 20), shown(text, 20))),
        }
    }

    /// A G or M word.
    fn code(&mut self, code: &str) -> Result<(), String> {
        let block = &mut self.block;
        let motion = |block: &mut NcBlock, motion| match block.motion.replace(motion) {
            Some(_) => Err("two of G0 and G1, or one twice, in one block".to_owned()),
            None => Ok(()),
        };
        match code {
            "G0" => motion(block, MotionWord::Rapid),
            "G1" => motion(block, MotionWord::Feed),
            _ => self.setting_code(code),
        }
    }

    /// A G or M word that is no motion.
    fn setting_code(&mut self, code: &str) -> Result<(), String> {
        let block = &mut self.block;
        if let Some(done) = block.modal_word(&SINUMERIK, code) {
            return done;
        }
        match code {
            "M6" if block.change => Err("`M6` occurs twice in one block".to_owned()),
            "M6" => {
                block.change = true;
                Ok(())
            }
            "M30" => once(&mut block.end, "M30 or M2", "M30"),
            "M2" => once(&mut block.end, "M30 or M2", "M2"),
            "M0" => once(&mut block.wait, "M0 or M1", "M0"),
            "M1" => once(&mut block.wait, "M0 or M1", "M1"),
            "G4" => once(&mut block.wait, "G4", "G4"),
            "G64" => once(&mut block.smoothing, "G64", Smoothing::Left("G64")),
            "G641" => once(&mut block.smoothing, "G641", Smoothing::Left("G641")),
            "G53" | "G153" => Err(format!(
                "`{code}` is not understood: offsets such as those of the handwheel remain active; write SUPA"
            )),
            "G2" | "G3" | "G33" | "G5" => {
                Err(format!("`{code}` is not understood: of motions only G0 and G1 are read"))
            }
            "G74" | "G75" => {
                Err(format!("`{code}` is not understood: its target is set at the control; write SUPA G0 Z"))
            }
            _ if (OFFSETS.has)(code) => block.select_offset(code),
            _ if HARMLESS.contains(&code) || block.clamp_word(code, self.machine) => Ok(()),
            _ => Err(format!("`{code}` is not understood")),
        }
    }

    /// The polynomials of a block: all six, and no other word of an axis.
    fn spline(&mut self) -> Result<(), String> {
        if self.polynomials.iter().all(Option::is_none) {
            return Ok(());
        }
        if self.block.has_axis_words() {
            return Err("polynomials and words of axes in one block".to_owned());
        }
        let [Some(x), Some(y), Some(z), Some(i), Some(j), Some(k)] = std::mem::take(&mut self.polynomials) else {
            return Err("an incomplete polynomial: write PO[X] PO[Y] PO[Z] PO[XH] PO[YH] PO[ZH] together".to_owned());
        };
        self.block.spline = Some(Box::new(SplineWords::Forward { tip: [x, y, z], second: [i, j, k] }));
        Ok(())
    }

    /// Checks the words of a block together.
    fn together(&mut self) -> Result<(), String> {
        self.spline()?;
        let block = &mut self.block;
        if block.wait == Some("G4") {
            // F and S in a block of G4 are the time of the dwell.
            let time = (block.feed.take(), block.speed.take());
            if time == (None, None) {
                return Err("G4 without F or S: the waiting time is unknown".to_owned());
            }
            if block.has_axis_words() {
                return Err("G4 must be alone in its block".to_owned());
            }
        }
        match self.edge {
            None => {}
            Some(0) => block.length = Some(LengthWord::Off),
            Some(1) => block.length = Some(LengthWord::OfSpindle),
            Some(edge) => {
                return Err(format!("D{edge} selects another cutting edge: the tool of the job is D1"));
            }
        }
        if self.assigned > 0 && self.assigned < self.words {
            return Err("R parameters get their values in a block of their own".to_owned());
        }
        if let Some(frame) = self.frame {
            block.frame_turn = Some(self.frame_turn.map_or(0.0, f64::to_radians));
            if self.words > 1 + usize::from(self.frame_turn.is_some()) {
                return Err(format!(
                    "{frame} with other words shifts or turns the work frame; write {frame} alone to reset it"
                ));
            }
            block.modal.set(ModalGroup::Shift, "TRANS");
        }
        match self.alone {
            Some(word) if self.words > 1 => Err(format!("{word} must be alone in its block")),
            _ => Ok(()),
        }
    }
}

/// Most numbers of a polynomial: the end and the coefficients of degrees two to five.
const MAX_POLYNOMIAL_NUMBERS: usize = 5;

/// Reports a plain word of an axis modulo 360 deg.
fn plain(axis: usize, machine: &Machine) -> Result<(), String> {
    let axis = &machine.rotary[axis];
    if axis.modulo.is_some() {
        let name = &axis.name;
        return Err(format!(
            "`{name}=` of an axis modulo 360 deg: machine data decide which way it goes; write `{name}=DC(...)`"
        ));
    }
    Ok(())
}

/// Tolerance of CYCLE832(tolerance, mode, orientation tolerance). When CYCLE832 is off, the control uses its own
/// settings.
fn smoothing(arguments: &str) -> Result<Smoothing, String> {
    if arguments.trim().is_empty() {
        return Ok(Smoothing::Left("CYCLE832()"));
    }
    let parts: Vec<&str> = arguments.split(',').map(|part| part.trim_matches([' ', '\t'])).collect();
    let &[tolerance, mode, turn] = parts.as_slice() else {
        return Err("CYCLE832 needs a tolerance, a mode and a tolerance of the direction".to_owned());
    };
    let (tolerance, turn) = (number(tolerance)?, number(turn)?);
    if !(0.0..=WIDEST_TOLERANCE_MM).contains(&tolerance) || !(0.0..=WIDEST_TOLERANCE_MM).contains(&turn) {
        return Err(format!("a tolerance of CYCLE832 is outside 0..{WIDEST_TOLERANCE_MM}"));
    }
    match &*upper(mode) {
        "_OFF" => Ok(Smoothing::Left("CYCLE832 with _OFF")),
        "_ORI_FINISH" | "_ORI_SEMIFIN" | "_ORI_ROUGH" if turn > WIDEST_TURN_DEG => {
            Err(format!("CYCLE832 allows a tilt error of {turn} deg; the limit is {WIDEST_TURN_DEG} deg"))
        }
        "_ORI_FINISH" | "_ORI_SEMIFIN" | "_ORI_ROUGH" if tolerance == 0.0 || turn == 0.0 => {
            Err("a tolerance of 0 in CYCLE832 makes the control use its own tolerance".to_owned())
        }
        "_ORI_FINISH" | "_ORI_SEMIFIN" | "_ORI_ROUGH" => {
            Ok(Smoothing::Within(SmoothingTolerance { path: tolerance, turn: Some(turn.to_radians()) }))
        }
        _ => Err(format!("the mode {} of CYCLE832 is not understood", shown(mode, 40))),
    }
}

/// Whether a block holds a word that only this dialect has.
pub(super) fn recognises(code: &str) -> bool {
    const OWN_WORDS: [&str; 7] = ["TRAORI", "TRAFOOF", "SUPA", "G710", "G500", "ORIAXES", "ORIWKS"];
    code.split_whitespace().map(str::to_ascii_uppercase).any(|w| {
        OWN_WORDS.contains(&&*w)
            || w.starts_with("CYCLE832")
            || ["A3=", "A=", "B=", "C=", "T=\""].iter().any(|o| w.starts_with(o))
    })
}
