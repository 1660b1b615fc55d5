//! Reader of the family: words of blocks. It shares no code with the writer.
//!
//! Modal: G0 and G1, X Y Z, rotary words, F, S. The text has `%` in its first and last line. A number without a decimal
//! point counts in a unit that a setting of the control gives, so that it is refused. The direction of G43.5 needs all three
//! of I J K: the control takes a missing one as 0.

use super::control::{CONTROL, HARMLESS, IN_PLANE, LINEAR, Member, OFFSETS, PRESET, is_offset};
use super::text::{code_name, count, decimal, first_word, program_name, without_comments};
use crate::control::modal::ModalGroup;
use crate::control::{self, LengthWord, MAX_FAULTS, MotionWord, NcBlock, Setup, Smoothing, once, rotary_letter, shown};
use crate::nc::{ENDS_HERE, NcTool, ReadError, ReadResult};
use five_axis::Machine;

/// Largest level of G05.1 Q1.
const MAX_SMOOTHING_LEVEL: u32 = 10;

/// Where the text is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Tape {
    /// Before the first `%`.
    Leader,
    /// After it, before the program number.
    Head,
    /// In the program.
    Program,
    /// After the block that ends the program.
    Ended,
    /// After the last `%`.
    Closed,
}

/// What directs the tool under tool centre point control.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Directed {
    /// Rotary words (G43.4), also with the control off.
    Angles,
    /// I J K (G43.5).
    Vector,
}

/// Reads a program.
pub(super) fn read(text: &str, machine: &Machine, part_offset: &str, member: &Member) -> ReadResult {
    let mut reader = Reader { machine, member, tape: Tape::Leader, directed: Directed::Angles };
    let mut buffer = Vec::new();
    let result = control::read(text, Setup { control: &CONTROL, machine, part_offset }, |line, _, faults| {
        reader.line(line, &mut buffer, faults)
    });
    if reader.tape == Tape::Closed {
        return result;
    }
    let mut faults = result.err().unwrap_or_default();
    if faults.len() < MAX_FAULTS {
        let line = text.strip_suffix('\n').unwrap_or(text).split('\n').count();
        faults.push(ReadError { line, reason: format!("{ENDS_HERE}`%` in its last line") });
    }
    Err(faults)
}

struct Reader<'a> {
    machine: &'a Machine,
    member: &'a Member,
    tape: Tape,
    directed: Directed,
}

/// Words of one block that belong to others, and how many words there are.
#[derive(Default)]
struct Words {
    /// All words but the block number.
    all: usize,
    /// M words.
    m: usize,
    h: Option<u32>,
    d: Option<u32>,
    p: Option<u32>,
    q: Option<u32>,
    r: Option<u32>,
    l: Option<u32>,
    /// G43.4, G43.5 or G49.
    switch: Option<&'static str>,
    /// G05.1 or G05.
    smoothing: Option<&'static str>,
    /// G54.1, whose P is the number of the offset.
    further_offset: bool,
    /// G92.1 or G50.1, whose axis words are no move.
    frame: Option<&'static str>,
    rapid: bool,
}

impl Reader<'_> {
    fn line(&mut self, line: &str, buffer: &mut Vec<u8>, faults: &mut Vec<String>) -> Option<NcBlock> {
        let code = match without_comments(line, buffer) {
            Ok(code) => code,
            Err(reason) => {
                faults.push(reason);
                return None;
            }
        };
        let marked = code == "%";
        match self.tape {
            Tape::Leader | Tape::Head if line.trim().is_empty() => return None,
            Tape::Leader => {
                self.tape = Tape::Head;
                if marked {
                    return None;
                }
                faults.push("the text does not begin with `%`: write `%` alone in the first line".to_owned());
            }
            Tape::Ended if marked => {
                self.tape = Tape::Closed;
                return None;
            }
            Tape::Closed if !line.trim().is_empty() => return Some(NcBlock::default()),
            _ => {}
        }
        if marked {
            faults.push("`%` before M30 ends the text: the control stops with an alarm".to_owned());
            return Some(NcBlock { end: Some("%"), ..NcBlock::default() });
        }
        if self.tape == Tape::Head {
            self.tape = Tape::Program;
            match program_name(&code, self.member) {
                Ok(()) => return None,
                Err(reason) => faults.push(reason),
            }
        }
        if code.is_empty() { None } else { self.block(&code, faults) }
    }

    fn block(&mut self, code: &str, faults: &mut Vec<String>) -> Option<NcBlock> {
        let mut block = NcBlock::default();
        let mut words = Words::default();
        let mut rest = code;
        let mut first = true;
        while !rest.is_empty() {
            let (letter, text, next) = match first_word(rest) {
                Ok(word) => word,
                Err(reason) => {
                    faults.push(reason);
                    words.all += 1;
                    break;
                }
            };
            rest = next;
            let done = if first && letter == 'N' {
                self.block_number(text)
            } else {
                words.all += 1;
                self.word(letter, text, &mut block, &mut words)
            };
            first = false;
            if let Err(reason) = done {
                faults.push(reason);
            }
        }
        if faults.is_empty()
            && let Err(reason) = self.together(&mut block, &words)
        {
            faults.push(reason);
        }
        if block.end.is_some() {
            self.tape = Tape::Ended;
        }
        (words.all > 0).then_some(block)
    }

    fn block_number(&self, text: &str) -> Result<(), String> {
        let most = self.member.block_digits;
        let plain = (1..=most).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
        if plain && text.bytes().any(|b| b != b'0') {
            return Ok(());
        }
        Err(format!("`N{}` is no block number: write 1 to {most} digits that are not all 0", shown(text, 20)))
    }

    fn word(&mut self, letter: char, text: &str, block: &mut NcBlock, words: &mut Words) -> Result<(), String> {
        let named = |reason: String| format!("`{letter}{}`: {reason}", shown(text, 20));
        let value = || decimal(letter, text, self.member).map_err(named);
        let number_of = || count(text).map_err(named);
        match letter {
            'X' => block.coordinate(0, value()?),
            'Y' => block.coordinate(1, value()?),
            'Z' => block.coordinate(2, value()?),
            'I' => block.component(&CONTROL, 0, value()?),
            'J' => block.component(&CONTROL, 1, value()?),
            'K' => block.component(&CONTROL, 2, value()?),
            'A'..='C' if let Some(axis) = rotary_letter(self.machine, letter) => {
                block.angle(axis, value()?, self.machine)
            }
            'F' => block.set_feed(value()?),
            'S' => block.set_speed(f64::from(number_of()?)),
            'T' => once(&mut block.tool, "T", NcTool::Number(number_of()?)),
            'H' => once(&mut words.h, "H", number_of()?),
            'D' => once(&mut words.d, "D", number_of()?),
            'P' => once(&mut words.p, "P", number_of()?),
            'Q' => once(&mut words.q, "Q", number_of()?),
            'R' => once(&mut words.r, "R", number_of()?),
            'L' => once(&mut words.l, "L", number_of()?),
            'G' => preparatory(&code_name('G', text)?, block, words),
            'M' => {
                words.m += 1;
                miscellaneous(&code_name('M', text)?, self.machine, block)
            }
            'N' => Err(format!("`N{}`: a block number must be at the start of its block", shown(text, 20))),
            'O' => Err(format!("`O{}`: another program begins here; give one program", shown(text, 20))),
            _ => Err(format!("`{letter}{}` is not understood", shown(text, 20))),
        }
    }

    /// Checks the words of a block together.
    fn together(&mut self, block: &mut NcBlock, words: &Words) -> Result<(), String> {
        if words.m > 1 {
            return Err(
                "two M words in one block: how many the control executes depends on a setting; write each in a \
                        block of its own"
                    .to_owned(),
            );
        }
        if let Some(frame) = words.frame {
            return self.frame(frame, block, words);
        }
        match words.switch {
            Some("G49") => {
                self.directed = Directed::Angles;
                (block.transformation, block.length) = (Some(false), Some(LengthWord::Off));
                unused(words, "G49", "")?;
            }
            Some(word) => return self.switch(word, block, words),
            None => {}
        }
        if let Some(word) = words.smoothing {
            block.outside = Some(word);
            return self.smoothing(word, block, words);
        }
        if block.wait == Some("G4") {
            return match words.p {
                Some(_) if words.all == 2 => Ok(()),
                _ => Err("G04 needs P in its block, the time in ms, and nothing else".to_owned()),
            };
        }
        if words.further_offset {
            let number = words.p.ok_or("G54.1 without P: write the number of the work offset")?;
            let name = format!("G54.1 P{number}");
            if !is_offset(&name) {
                return Err(format!("{name}: the control has the offsets {}", OFFSETS.all));
            }
            block.select_offset(&name)?;
            unused(words, "G54.1", "P")?;
        } else {
            unused(words, "", "")?;
        }
        self.direction(block)?;
        let coolant = block.modal.get(ModalGroup::Coolant).is_some();
        if words.m > 0 && block.has_axis_words() && !(coolant && words.rapid) {
            return Err(
                "an M word in a block with axis words: whether the word acts before or after the move depends on the \
                        machine; write the M word in a block of its own"
                    .to_owned(),
            );
        }
        Ok(())
    }

    /// Checks rotary words and I J K against the kind of tool centre point control.
    fn direction(&self, block: &NcBlock) -> Result<(), String> {
        let components = block.vector.iter().flatten().count();
        if components > 0 && self.directed == Directed::Angles {
            return Err("I J K give a direction only after G43.5: write rotary words, or G43.5".to_owned());
        }
        if (1..3).contains(&components) {
            return Err("I, J and K are incomplete: the control takes a missing one as 0; write all three".to_owned());
        }
        if block.rotary != [None; 2] && self.directed == Directed::Vector {
            return Err("a rotary word after G43.5, where I J K direct the tool: write I J K, or G43.4".to_owned());
        }
        Ok(())
    }

    /// G43.4 and G43.5.
    fn switch(&mut self, word: &'static str, block: &mut NcBlock, words: &Words) -> Result<(), String> {
        self.directed = if word == "G43.5" { Directed::Vector } else { Directed::Angles };
        let posture = match words.p {
            None if self.member.posture && word == "G43.5" => None,
            None => Some(LINEAR),
            Some(0) if self.member.posture => Some(LINEAR),
            Some(1) if self.member.posture => Some(IN_PLANE),
            Some(_) if self.member.posture => return Err(format!("P in the block of {word} is 0 or 1")),
            Some(_) => return Err(format!("P in the block of {word}: the control has no such word")),
        };
        if let Some(word) = posture {
            block.modal.set(ModalGroup::Turning, word);
        }
        block.transformation = Some(true);
        block.length = match words.h {
            None => return Err(format!("{word} without H: write H and the number of the tool length")),
            Some(0) => return Err(format!("{word} H0 sets no length: write the number of the tool")),
            Some(h) => Some(LengthWord::Of(h)),
        };
        unused(words, word, "HP")?;
        if block.vector != [None; 3] {
            return Err(format!(
                "I J K in the block of {word}: alarm PS5421 on a machine with a rotary table; write them \
                                in the next block"
            ));
        }
        if block.has_axis_words() {
            return Err(format!(
                "axis words in the block of {word}: this move has the tool length, but not tool centre point control; \
                 write {word} and H alone"
            ));
        }
        if words.all != 2 + usize::from(words.p.is_some()) {
            return Err(format!("{word} with other words: write {word} and H alone in their block"));
        }
        Ok(())
    }

    /// G05.1 and G05.
    fn smoothing(&self, word: &str, block: &mut NcBlock, words: &Words) -> Result<(), String> {
        let (on, used) = match (word, words.q, words.p) {
            ("G05.1", Some(on @ 0..=1), None) => (on == 1, 1),
            ("G05.1", Some(_), None) => return Err("G05.1 with another Q than 0 and 1 is not understood".to_owned()),
            ("G05", None, Some(on @ (0 | 10_000))) => (on > 0, 1),
            _ => return Err(format!("{word} is understood as G05.1 Q1, G05.1 Q0, G05 P10000 and G05 P0")),
        };
        let level = match words.r {
            Some(_) if !(self.member.levels && on && word == "G05.1") => {
                return Err(format!("R in the block of {word} is not understood"));
            }
            Some(level) if !(1..=MAX_SMOOTHING_LEVEL).contains(&level) => {
                return Err(format!("the level R of G05.1 Q1 is 1 to {MAX_SMOOTHING_LEVEL}"));
            }
            level => usize::from(level.is_some()),
        };
        if words.all != 1 + used + level {
            return Err(format!("{word} with other words: write {word} alone in its block"));
        }
        block.smoothing = Some(match (on, word) {
            (true, _) => Smoothing::AtControl,
            (false, "G05") => Smoothing::Left("G05 P0"),
            (false, _) => Smoothing::Left("G05.1 Q0"),
        });
        Ok(())
    }

    /// G92.1 and G50.1, whose axis words are no move.
    fn frame(&self, word: &str, block: &mut NcBlock, words: &Words) -> Result<(), String> {
        unused(words, word, "")?;
        let axes = block.tip.iter().chain(&block.rotary);
        let zero = axes.clone().flatten().all(|x| *x == 0.0);
        let count = axes.flatten().count();
        if words.all != 1 + count {
            return Err(format!("{word} with other words: write {word} alone in its block"));
        }
        let all = count == 5 || (word == "G50.1" && count > 0);
        if !(zero && all) {
            let [.., first, second] = self.machine.names();
            return Err(format!("{word} is understood as `{word} X0. Y0. Z0. {first}0. {second}0.`"));
        }
        (block.tip, block.rotary) = ([None; 3], [None; 2]);
        block.outside = Some("G92.1").filter(|_| word == "G92.1");
        if word == "G92.1" {
            block.modal.set(ModalGroup::Shift, PRESET);
        }
        Ok(())
    }
}

/// Reports words that belong to no word of their block. `takes` holds the letters that the word takes.
fn unused(words: &Words, word: &str, takes: &str) -> Result<(), String> {
    let given = [("H", words.h), ("P", words.p), ("Q", words.q), ("R", words.r), ("L", words.l)];
    match given.iter().find(|(letter, value)| value.is_some() && !takes.contains(letter)) {
        Some((letter, _)) if word.is_empty() => Err(format!("{letter} without a word that takes it")),
        Some((letter, _)) => Err(format!("{letter} in the block of {word} is not understood")),
        None => Ok(()),
    }
}

/// A G word.
fn preparatory(code: &str, block: &mut NcBlock, words: &mut Words) -> Result<(), String> {
    if matches!(code, "G0" | "G1") {
        words.rapid |= code == "G0";
        let motion = if code == "G0" { MotionWord::Rapid } else { MotionWord::Feed };
        return match block.motion.replace(motion) {
            Some(_) => Err("two of G0 and G1, or one twice, in one block".to_owned()),
            None => Ok(()),
        };
    }
    if let Some(done) = block.modal_word(&CONTROL, code) {
        return done;
    }
    let refused = |why: &str| Err(format!("`{code}` is not understood: {why}"));
    match code {
        "G4" => once(&mut block.wait, "G04", "G4"),
        "G5" => once(&mut words.smoothing, "G05 or G05.1", "G05"),
        "G5.1" => once(&mut words.smoothing, "G05 or G05.1", "G05.1"),
        "G43.4" => once(&mut words.switch, "G43.4, G43.5 or G49", "G43.4"),
        "G43.5" => once(&mut words.switch, "G43.4, G43.5 or G49", "G43.5"),
        "G49" => once(&mut words.switch, "G43.4, G43.5 or G49", "G49"),
        "G50.1" => once(&mut words.frame, "G50.1 or G92.1", "G50.1"),
        "G92.1" => once(&mut words.frame, "G50.1 or G92.1", "G92.1"),
        "G53" if block.machine_frame => Err("`G53` occurs twice in one block".to_owned()),
        "G53" => {
            block.machine_frame = true;
            Ok(())
        }
        _ if HARMLESS.contains(&code) => Ok(()),
        "G2" | "G3" | "G6.2" | "G33" | "G2.4" | "G3.4" => refused("of motions only G0 and G1 are read"),
        "G27" | "G28" | "G29" | "G30" | "G30.1" | "G53.1" => {
            refused("its target is set at the control; write `G53 G0 Z...`")
        }
        "G43" | "G44" | "G43.1" => {
            refused("it activates the tool length without tool centre point control; write G43.4 H")
        }
        "G54.1" if words.further_offset => Err("`G54.1` occurs twice in one block".to_owned()),
        "G54.1" => {
            words.further_offset = true;
            Ok(())
        }
        "G10" | "G52" | "G54.2" | "G54.4" | "G92" => {
            refused("it changes the work offset; set offsets at the machine and select one")
        }
        "G16" | "G51" | "G51.1" | "G68" | "G68.1" | "G68.2" | "G68.3" | "G68.4" => {
            refused("it turns, mirrors or scales the work frame")
        }
        "G65" | "G66" | "G66.1" => refused("macros are not read"),
        "G73" | "G74" | "G76" | "G81" | "G82" | "G83" | "G84" | "G85" | "G86" | "G87" | "G88" | "G89" => {
            refused("cycles are not read")
        }
        "G96" => refused("the spindle would have no constant speed; write G97"),
        _ => Err(format!("`{code}` is not understood")),
    }
}

/// An M word.
fn miscellaneous(code: &str, machine: &Machine, block: &mut NcBlock) -> Result<(), String> {
    if let Some(done) = block.modal_word(&CONTROL, code) {
        return done;
    }
    match code {
        "M6" => {
            block.change = true;
            Ok(())
        }
        "M2" => once(&mut block.end, "M2 or M30", "M2"),
        "M30" => once(&mut block.end, "M2 or M30", "M30"),
        "M0" => once(&mut block.wait, "M0 or M1", "M0"),
        "M1" => once(&mut block.wait, "M0 or M1", "M1"),
        "M98" | "M99" | "M198" => Err(format!("`{code}` is not understood: subprograms are not read")),
        _ if block.clamp_word(code, machine) || machine.own_words.iter().any(|word| word == code) => Ok(()),
        _ => Err(format!(
            "`{code}` is not understood: a word of the machine builder; if it changes neither path, tool, spindle nor \
             coolant, add it to `own-words` of the machine file"
        )),
    }
}

/// Whether a block holds a word that only this family has.
pub(super) fn recognises(code: &str) -> bool {
    const OWN_WORDS: [&str; 4] = ["G43.4", "G43.5", "G05.1", "G5.1"];
    let mut words = code.split_whitespace();
    let first = words.next().unwrap_or_default();
    let number = |letter: char, word: &str| {
        word.strip_prefix(letter).is_some_and(|n| (1..=8).contains(&n.len()) && n.bytes().all(|b| b.is_ascii_digit()))
    };
    let second = words.next().unwrap_or_default();
    let word = if number('N', first) { second } else { first };
    OWN_WORDS.contains(&word) || (number('O', first) && second.is_empty())
}
