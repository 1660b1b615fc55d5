//! Reader of Klartext: blocks of a program. It shares no code with the writer.
//!
//! Modal: F, the speed of TOOL CALL, radius compensation, X Y Z and the rotary axes in L. FMAX acts in its block alone, and
//! LN knows nothing modal. `~` at the end of a line continues the block. A program uses M128 or FUNCTION TCPM, not both:
//! the manuals do not say that the word that switches one off does so for the other.

use super::spline;
use super::straight::{self, PLACES, RATE_PLACES, count, decimal};
use crate::control::modal::{Modal, ModalGroup, Needed};
use crate::control::{
    self, Act, Control, NcBlock, Setup, Smoothing, SmoothingTolerance, WIDEST_TOLERANCE_MM, WIDEST_TURN_DEG, WordList,
    WorkOffsets, once, shown,
};
use crate::nc::{ENDS_HERE, NcTool, ReadError, ReadResult};
use five_axis::Machine;

/// Longest block with its continued lines.
const MAX_BLOCK_LENGTH: usize = 512;

/// Largest tool number of the tool table.
const MAX_TOOL_NUMBER: u32 = 32_767;

/// Longest name in the tool table.
const MAX_TOOL_NAME_LENGTH: usize = 32;

/// The presets, by the number of their row in the table of the control.
pub(super) const OFFSETS: WorkOffsets =
    WorkOffsets { usual: "1", all: "the numbers of presets, \"1\" to \"65535\"", has: is_preset };

fn is_preset(name: &str) -> bool {
    !name.starts_with(['0', '+']) && name.parse().is_ok_and(|number: u32| (1..=65_535).contains(&number))
}

/// The block that activates a preset, as messages name it.
fn preset_block(number: impl std::fmt::Display) -> String {
    format!("CYCL DEF 247 Q339=+{number}")
}

/// Modal groups.
const MODAL: &[Modal] = &[
    Modal { right: &["BEGIN PGM .. MM"], wrong: &[], ..Modal::UNITS },
    Modal {
        group: ModalGroup::Compensation,
        what: "no radius compensation",
        right: &["R0"],
        wrong: &["RL", "RR"],
        needed: Needed::Always,
    },
    // Cycle 247 also takes back datum shift, mirror image, rotation and scaling.
    Modal { group: ModalGroup::WorkOffset, what: "the preset", right: &[], wrong: &[], needed: Needed::InWorkFrame },
    Modal {
        group: ModalGroup::Rotation,
        what: "no tilted working plane",
        right: &["PLANE RESET STAY"],
        wrong: &[],
        needed: Needed::Always,
    },
    // Without M126 a machine parameter decides on the way of an axis of which the display stays below 360 deg.
    Modal {
        group: ModalGroup::Way,
        what: "the shorter way of rotary axes",
        right: &["M126"],
        wrong: &["M127"],
        needed: Needed::Transformed,
    },
    Modal {
        group: ModalGroup::Turning,
        what: "the interpolation of the tool axis",
        right: &["PATHCTRL AXIS", "PATHCTRL VECTOR", "M128"],
        wrong: &[],
        needed: Needed::Transformed,
    },
    Modal::SPINDLE,
    Modal { right: &["M8"], ..Modal::COOLANT },
];

const ORDER: &[Act] = &[
    Act::Set(ModalGroup::Units),
    Act::Feed,
    Act::Speed,
    Act::Select,
    Act::Change,
    Act::Set(ModalGroup::WorkOffset),
    Act::Set(ModalGroup::Rotation),
    Act::Set(ModalGroup::Compensation),
    Act::Set(ModalGroup::Spindle),
    Act::Set(ModalGroup::Coolant),
    Act::Set(ModalGroup::Way),
    Act::Transform,
    Act::Set(ModalGroup::Turning),
    Act::Smooth,
    Act::Move,
    Act::Wait,
    Act::End,
];

/// The control, with the words that switch tool centre point control on and off.
const fn klartext(transformation: [&'static str; 2]) -> Control {
    Control {
        modal: MODAL,
        order: ORDER,
        transformation,
        // In blocks with M91 the tool length is not compensated (user's manual, "Programming machine-referenced
        // coordinates: M91/M92").
        machine_frame: "L",
        behind: " R0 FMAX M91",
        rapid: "FMAX",
        change: "TOOL CALL",
        vector: ["TX", "TY", "TZ"],
        length: "TOOL CALL",
        smoothing: "CYCL DEF 32.1 T with a tolerance",
        offsets: &OFFSETS,
        // M128 has no word for the interpolation: the rotary axes run linearly, as with PATHCTRL AXIS.
        great_circle: &["PATHCTRL VECTOR"],
        machine_frame_drops_length: true,
        change_sets_length: true,
        shorter_way: true,
        // Lists of miscellaneous functions in the manuals (TNC 155, page 15): M5 and M9 act at the end of the block.
        stops_behind: true,
        wait_switches_off: true,
        end_switches_off: true,
        ..Control::ISO
    }
}

static TCPM: Control = klartext(["FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS", "FUNCTION RESET TCPM"]);
static M128: Control = klartext(["M128", "M129"]);

/// Reads a program.
pub(super) fn read(text: &str, machine: &Machine, preset: &str) -> ReadResult {
    let control = if !text.contains("TCPM") && text.contains("M128") { &M128 } else { &TCPM };
    let mut reader = ProgramReader::new(control, machine);
    let sections =
        control::read(text, Setup { control, machine, part_offset: &preset_block(preset) }, |line, _, faults| {
            reader.line(line, faults)
        })?;
    if reader.closed {
        return Ok(sections);
    }
    let end = format!("{ENDS_HERE}`END PGM {} MM`", shown(&reader.name.unwrap_or_default(), 40));
    Err(vec![ReadError { line: text.lines().count().max(1), reason: end }])
}

/// What has been read of a cycle 32.
#[derive(Clone, Copy, PartialEq)]
enum Cycle {
    /// 32.0.
    Named,
    /// 32.1 with this tolerance, mm.
    Tolerance(f64),
}

/// State from block to block of what is not state of the control.
struct ProgramReader<'a> {
    control: &'static Control,
    machine: &'a Machine,
    /// Number of the last block.
    number: Option<u32>,
    /// Begin of a block that goes on in the next line.
    begun: Option<String>,
    /// Name of the program.
    name: Option<String>,
    cycle: Option<Cycle>,
    /// Least corner of the blank, until the other corner.
    blank: Option<[f64; 3]>,
    /// M30 or M2 was read.
    ended: bool,
    /// END PGM was read.
    closed: bool,
}

impl<'a> ProgramReader<'a> {
    fn new(control: &'static Control, machine: &'a Machine) -> Self {
        Self {
            control,
            machine,
            number: None,
            begun: None,
            name: None,
            cycle: None,
            blank: None,
            ended: false,
            closed: false,
        }
    }

    /// The block that ends with a line.
    fn line(&mut self, line: &str, faults: &mut Vec<String>) -> Option<NcBlock> {
        let line = line.strip_suffix('\r').unwrap_or(line).trim_end_matches([' ', '\t']);
        let (code, comment) = line.split_once(';').map_or((line, None), |(code, comment)| (code, Some(comment)));
        let continues = line.ends_with('~');
        let code = if comment.is_none() { code.strip_suffix('~').unwrap_or(code) } else { code };
        let begun = self.begun.take();
        if begun.as_ref().map_or(0, String::len) + code.len() > MAX_BLOCK_LENGTH {
            faults.push(format!("a block of more than {MAX_BLOCK_LENGTH} characters"));
            return None;
        }
        if continues && begun.is_none() && !matches!(code.split_whitespace().nth(1), Some("CYCL" | "SPL")) {
            faults
                .push("`~` continues only the block of a cycle or of a spline: write the block in one line".to_owned());
            return None;
        }
        let whole = begun.map(|text| text + code);
        if continues {
            self.begun = Some(whole.unwrap_or_else(|| code.to_owned()) + " ");
            return None;
        }
        self.numbered(whole.as_deref().unwrap_or(code), comment.is_some(), faults)
    }

    /// A block with its number.
    fn numbered(&mut self, text: &str, comment: bool, faults: &mut Vec<String>) -> Option<NcBlock> {
        let words: WordList<'_> = control::words(text).collect();
        let Some((number, words)) = words.split_first() else {
            if comment {
                faults.push("a comment without a block number: the control numbers every block".to_owned());
            }
            return None;
        };
        match count(number, 9) {
            Ok(number) if self.number.is_none_or(|last| number > last) => self.number = Some(number),
            Ok(number) => faults.push(format!(
                "block {number} after block {}: block numbers must grow",
                self.number.unwrap_or_default()
            )),
            Err(_) => {
                let what = shown(number, 20);
                faults.push(format!("`{what}` instead of a block number: the control numbers every block"));
                return None;
            }
        }
        if words.is_empty() || words[0] == "*" {
            return None;
        }
        match self.block(words) {
            Ok(block) => {
                let block = block?;
                self.ended |= block.end.is_some();
                Some(block)
            }
            Err(reason) => {
                faults.push(reason);
                None
            }
        }
    }

    /// A block from its words; `None` when it changes nothing.
    fn block(&mut self, words: &[&str]) -> Result<Option<NcBlock>, String> {
        if self.name.is_none() && !words.starts_with(&["BEGIN", "PGM"]) {
            return Err("a block before `BEGIN PGM name MM`".to_owned());
        }
        if self.closed {
            // The state reports text after the end.
            return Ok(Some(NcBlock::default()));
        }
        let cycle = self.cycle.take();
        if cycle.is_some() && !words.starts_with(&["CYCL", "DEF"]) {
            return Err("cycle 32 is not complete: write `CYCL DEF 32.1 T..` and `CYCL DEF 32.2 HSC-MODE:0 TA..` \
                        before this block"
                .to_owned());
        }
        match words {
            ["BEGIN", "PGM", rest @ ..] => self.begin(rest).map(Some),
            ["END", "PGM", rest @ ..] => self.end(rest),
            ["BLK", "FORM", rest @ ..] => self.blank(rest).map(|()| None),
            ["TOOL", "CALL", rest @ ..] => self.tool_call(rest).map(Some),
            // Only brings the next tool to the changer.
            ["TOOL", "DEF", tool] => tool_of(tool).map(|_| None),
            ["TOOL", "DEF", ..] => {
                Err("TOOL DEF with data of a tool: only those of the tool table are read".to_owned())
            }
            ["CYCL", "DEF", rest @ ..] => self.cycle(cycle, rest),
            ["FUNCTION", "RESET", "TCPM"] => {
                self.only_tcpm()?;
                Ok(Some(NcBlock { transformation: Some(false), ..NcBlock::default() }))
            }
            ["FUNCTION", "TCPM", rest @ ..] => self.tcpm(rest).map(Some),
            ["PLANE", "RESET", "STAY"] => {
                let mut block = NcBlock { outside: Some("PLANE RESET STAY"), ..NcBlock::default() };
                let _ = block.modal_word(self.control, "PLANE RESET STAY");
                Ok(Some(block))
            }
            ["STOP", rest @ ..] => {
                let mut block = straight::miscellaneous(rest, self.control, self.machine)?;
                once(&mut block.wait, "M0, M1 or STOP", "STOP").map(|()| Some(block))
            }
            ["L", rest @ ..] => straight::line(rest, false, self.control, self.machine).map(Some),
            ["SPL", rest @ ..] => {
                spline::block(rest, std::ptr::eq(self.control, &raw const M128), self.machine).map(Some)
            }
            ["LN", rest @ ..] => straight::line(rest, true, self.control, self.machine).map(Some),
            [first, ..] if is_m(first) => straight::miscellaneous(words, self.control, self.machine).map(Some),
            _ => Err(not_read(words)),
        }
    }

    fn begin(&mut self, words: &[&str]) -> Result<NcBlock, String> {
        let &[name, unit] = words else { return Err("write `BEGIN PGM name MM`".to_owned()) };
        if self.name.is_some() {
            return Err("`BEGIN PGM` inside of a program".to_owned());
        }
        self.name = Some(name.to_owned());
        match unit {
            "MM" => {
                let mut block = NcBlock::default();
                let _ = block.modal_word(self.control, "BEGIN PGM .. MM");
                Ok(block)
            }
            "INCH" => {
                Err("a program in inches, with F in tenths of an inch a minute, is not read: write it in MM".to_owned())
            }
            _ => Err(format!("`{}` is no unit: write MM", shown(unit, 20))),
        }
    }

    fn end(&mut self, words: &[&str]) -> Result<Option<NcBlock>, String> {
        self.closed = true;
        let begun = self.name.clone().unwrap_or_default();
        if words != [begun.as_str(), "MM"] {
            return Err(format!(
                "the program ends with another name or unit: write `END PGM {} MM`",
                shown(&begun, 40)
            ));
        }
        let end = NcBlock { end: Some("END PGM"), ..NcBlock::default() };
        Ok((!self.ended).then_some(end))
    }

    /// The blank is for the simulation at the control alone.
    fn blank(&mut self, words: &[&str]) -> Result<(), String> {
        let corner = |words: &[&str]| -> Result<[f64; 3], String> {
            let &[x, y, z] = words else { return Err("BLK FORM needs X Y Z".to_owned()) };
            let mut corner = [0.0; 3];
            for ((place, word), axis) in corner.iter_mut().zip([x, y, z]).zip(["X", "Y", "Z"]) {
                let value = word.strip_prefix(axis).ok_or("BLK FORM needs X Y Z in this order")?;
                *place = decimal(value, PLACES)?;
            }
            Ok(corner)
        };
        match (words, self.blank) {
            (["0.1", "Z", rest @ ..], _) => {
                self.blank = Some(corner(rest)?);
                Ok(())
            }
            (["0.1", ..], _) => Err("BLK FORM 0.1 names the tool axis: write Z".to_owned()),
            (["0.2", ..], None) => Err("BLK FORM 0.2 without BLK FORM 0.1".to_owned()),
            (["0.2", rest @ ..], Some(least)) => {
                let most = corner(rest)?;
                self.blank = None;
                let grows = (0..3).all(|k| most[k] > least[k]);
                if grows { Ok(()) } else { Err("BLK FORM 0.2 must be the larger corner".to_owned()) }
            }
            (["CYLINDER", "Z", rest @ ..], _) => {
                let value = |word: &&str| word.trim_start_matches(|c: char| c.is_ascii_uppercase()).to_owned();
                rest.iter().map(value).try_for_each(|text| decimal(&text, PLACES).map(|_| ()))
            }
            _ => Err("of BLK FORM only 0.1, 0.2 and CYLINDER are read".to_owned()),
        }
    }

    /// A tool change, or another speed.
    fn tool_call(&self, words: &[&str]) -> Result<NcBlock, String> {
        let mut block = NcBlock::default();
        let (tool, rest) = match words {
            ["Z", rest @ ..] => (None, rest),
            [tool, "Z", rest @ ..] => (Some(tool_of(tool)?), rest),
            [_, "X" | "Y" | "U" | "V" | "W", ..] | ["X" | "Y", ..] => {
                return Err("TOOL CALL with another tool axis than Z".to_owned());
            }
            _ => return Err("TOOL CALL without the tool axis: write `TOOL CALL 1 Z S..`".to_owned()),
        };
        for word in rest {
            let named = |why: String| format!("`{}`: {why}", shown(word, 40));
            match word.as_bytes()[0] {
                b'S' => {
                    if block.speed.is_some() {
                        return Err("`S` occurs twice in one block".to_owned());
                    }
                    block.set_speed(decimal(&word[1..], RATE_PLACES).map_err(named)?)?;
                }
                b'F' => block.set_feed(straight::feed(&word[1..])?)?,
                b'D' => {
                    return Err(format!(
                        "`{}` makes the tool another one than that of the job: oversizes belong into the tool table",
                        shown(word, 40)
                    ));
                }
                _ => return Err(format!("`{}` in TOOL CALL is not understood", shown(word, 40))),
            }
        }
        if block.speed.is_none() {
            return Err("TOOL CALL without S: the spindle speed is unknown".to_owned());
        }
        match tool {
            Some(tool) => (block.tool, block.change) = (Some(tool), true),
            None => block.outside = Some("TOOL CALL Z S.."),
        }
        Ok(block)
    }

    fn cycle(&mut self, before: Option<Cycle>, words: &[&str]) -> Result<Option<NcBlock>, String> {
        let (number, rest) = words.split_first().ok_or("CYCL DEF without a number")?;
        let smoothing = |smoothing| Ok(Some(NcBlock { smoothing: Some(smoothing), ..NcBlock::default() }));
        let is_name = |word: &&&str| word.bytes().all(|b| b.is_ascii_alphabetic());
        // The first block of a cycle has its name, in the language of the control.
        let named = if matches!(*number, "32.1" | "32.2") { 0 } else { rest.iter().take_while(is_name).count() };
        let rest = &rest[named..];
        match (*number, before, rest) {
            ("32.0", None, []) => {
                self.cycle = Some(Cycle::Named);
                Ok(None)
            }
            ("32.1", Some(Cycle::Named), []) => smoothing(Smoothing::Left("CYCL DEF 32.1 without T")),
            ("32.1", Some(Cycle::Named), [word]) => {
                self.cycle = Some(Cycle::Tolerance(tolerance(word, "T", WIDEST_TOLERANCE_MM, "mm")?));
                Ok(None)
            }
            ("32.2", Some(Cycle::Tolerance(within)), ["HSC-MODE:0" | "HSC-MODE:1", word]) => {
                let turn = tolerance(word, "TA", WIDEST_TURN_DEG, "deg")?;
                smoothing(Smoothing::Within(SmoothingTolerance { path: within, turn: Some(turn.to_radians()) }))
            }
            ("32.0" | "32.1" | "32.2", ..) => {
                Err("cycle 32 needs three blocks: `CYCL DEF 32.0 TOLERANCE`, `CYCL DEF 32.1 T..`, \
                     `CYCL DEF 32.2 HSC-MODE:0 TA..`"
                    .to_owned())
            }
            (_, Some(_), _) => Err("another cycle inside of cycle 32".to_owned()),
            ("247", None, [preset]) => {
                let preset = preset.strip_prefix("Q339=").ok_or("cycle 247 needs Q339, the number of the preset")?;
                let number = count(preset.strip_prefix('+').unwrap_or(preset), 5)?;
                let mut block = NcBlock { outside: Some("CYCL DEF 247"), ..NcBlock::default() };
                block.select_offset(&preset_block(number))?;
                Ok(Some(block))
            }
            ("247", ..) => Err("cycle 247 needs Q339 alone: the number of the preset".to_owned()),
            _ => Err(unread_cycle(number)),
        }
    }

    fn only_tcpm(&self) -> Result<(), String> {
        if std::ptr::eq(self.control, &raw const TCPM) {
            return Ok(());
        }
        Err("M128 and FUNCTION TCPM in one program: what is on is not certain".to_owned())
    }

    /// FUNCTION TCPM with its three or four settings.
    fn tcpm(&self, words: &[&str]) -> Result<NcBlock, String> {
        self.only_tcpm()?;
        let due = self.control.transformation[0];
        let (settings, limit) = match words {
            [settings @ .., last] if last.len() > 1 && last.starts_with('F') => (settings, Some(last)),
            _ => (words, None),
        };
        if let Some(limit) = limit {
            straight::compensation(&limit[1..], self.machine)?;
        }
        let path = match settings {
            ["F", "CONT", ..] => {
                return Err(format!("F CONT counts the rotary axes in the feed: write {due}"));
            }
            [_, _, "AXIS", "SPAT", ..] => {
                return Err(format!("with AXIS SPAT rotary words are angles in space, not positions: write {due}"));
            }
            ["F", "TCP", "AXIS", "POS", "PATHCTRL", path @ ("AXIS" | "VECTOR")] => path,
            ["F", "TCP", "AXIS", "POS", "PATHCTRL", path @ ("AXIS" | "VECTOR"), "REFPNT", "TIP-TIP"] => path,
            [.., "REFPNT", _] => {
                return Err("the points of a job are tips of the tool: write REFPNT TIP-TIP".to_owned());
            }
            _ => return Err(format!("FUNCTION TCPM needs all its settings: write {due}")),
        };
        let mut block = NcBlock { transformation: Some(true), ..NcBlock::default() };
        let word = if *path == "AXIS" { "PATHCTRL AXIS" } else { "PATHCTRL VECTOR" };
        let _ = block.modal_word(self.control, word);
        Ok(block)
    }
}

fn is_m(word: &str) -> bool {
    word.strip_prefix('M').is_some_and(|code| code.bytes().all(|b| b.is_ascii_digit()))
}

/// A tool by number or by name. The tool table has names in capital letters alone.
fn tool_of(word: &str) -> Result<NcTool, String> {
    if let Some(name) = word.strip_prefix('"') {
        let name = name.strip_suffix('"').ok_or("a quoted name is not closed, or holds a blank")?;
        let plain = |b: u8| b.is_ascii_uppercase() || b.is_ascii_digit() || b"#$%&,-_.@".contains(&b);
        if name.is_empty() || name.len() > MAX_TOOL_NAME_LENGTH || !name.bytes().all(plain) {
            return Err(format!(
                "the tool table has no name `{}`: at most {MAX_TOOL_NAME_LENGTH} capital letters, digits and #$%&,-_.@",
                shown(name, 40)
            ));
        }
        return Ok(NcTool::Capitals(name.into()));
    }
    let number = count(word, 5).map_err(|why| format!("the tool: {why}"))?;
    if number > MAX_TOOL_NUMBER {
        return Err(format!("tool {number}: the largest number of the control is {MAX_TOOL_NUMBER}"));
    }
    Ok(NcTool::Number(number))
}

/// A tolerance of cycle 32.
fn tolerance(word: &str, address: &str, most: f64, unit: &str) -> Result<f64, String> {
    let text = word.strip_prefix(address).ok_or_else(|| format!("`{}` instead of {address}", shown(word, 40)))?;
    let value = decimal(text, PLACES)?;
    if value > 0.0 && value <= most {
        return Ok(value);
    }
    if value == 0.0 {
        return Err(format!("{address}0 makes the control use its own tolerance"));
    }
    Err(format!("{address}{} is outside of 0 to {most} {unit}", shown(text, 40)))
}

fn unread_cycle(number: &str) -> String {
    let why = match number.split('.').next().unwrap_or_default() {
        "7" | "8" | "10" | "11" | "19" | "26" => ": it shifts, turns, mirrors or scales the work frame",
        "9" => ": the tool would wait",
        "12" => ": it calls another program",
        _ => "",
    };
    format!("cycle {} is not understood{why}", shown(number, 20))
}

fn not_read(words: &[&str]) -> String {
    let first = words.first().copied().unwrap_or_default();
    let why = match first {
        "C" | "CC" | "CR" | "CT" | "CP" | "LP" | "LT" | "CTP" | "CHF" | "RND" | "APPR" | "DEP" | "FL" | "FC"
        | "FLT" | "FCT" | "FPOL" => ": of motions only L, LN and SPL are read",
        "LBL" | "CALL" | "SEL" | "FN" | "IF" => ": the order of blocks would depend on it",
        "PLANE" => ": it tilts the working plane; write PLANE RESET STAY to reset it",
        "TRANS" => ": it shifts the work frame",
        "TCH" => ": the probe is not read",
        "CYCL" => ": cycles are not called",
        _ if first.starts_with('Q') => ": parameters are not read",
        _ if first.starts_with('/') => ": a switch at the control decides whether this block runs",
        _ if first.starts_with('G') || first.starts_with('N') => ": this is no word of Klartext",
        _ if first.bytes().any(|b| b.is_ascii_lowercase()) => ": write words in capital letters",
        _ => "",
    };
    let words = words.join(" ");
    format!("`{}` is not understood{why}", shown(&words, 40))
}

/// Whether a block holds a word that only this dialect has.
pub(super) fn recognises(code: &str) -> bool {
    const OWN_WORDS: [&str; 9] = ["L", "LN", "TOOL", "CYCL", "FUNCTION", "BLK", "BEGIN", "END", "PLANE"];
    let mut words = code.split_whitespace();
    let numbered = words.next().is_some_and(|n| n.bytes().all(|b| b.is_ascii_digit()));
    numbered && words.next().is_some_and(|word| OWN_WORDS.contains(&word))
}
