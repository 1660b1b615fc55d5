//! Words of the straight lines L and LN, and M words.
//!
//! The control takes the words of a block in one order: axes, radius compensation, F, M.

use crate::control::{Control, MotionWord, NcBlock, number, once, rotary_axis, shown};
use five_axis::Machine;

/// Most M words of one block of the iTNC 530.
const MAX_M_WORDS: usize = 2;

/// Places before and behind the point of lengths and angles, and of feeds and speeds.
pub(super) const PLACES: Places = Places { before: 5, behind: 4 };
pub(super) const RATE_PLACES: Places = Places { before: 5, behind: 3 };
/// Places of the components of vectors.
const VECTOR_PLACES: Places = Places { before: 1, behind: 8 };

/// Largest error of the length of a vector: it has at least four decimals. The manual asks for a length of 1 and for enough
/// decimals, and says nothing of what the control does with another length.
const VECTOR_LENGTH_ERROR: f64 = 1e-4;

/// Most addresses of a block that has each once.
const MOST_ADDRESSES: usize = 8;

/// Words of a block that are not in [`NcBlock`].
#[derive(Default)]
pub(super) struct Words<'a> {
    pub(super) block: NcBlock,
    /// Addresses of axes and vectors, in the order of the block.
    addresses: [&'static str; MOST_ADDRESSES],
    /// Their number.
    count: usize,
    /// Place of the last word in the order of the control, and that word.
    place: (u8, &'a str),
    /// FMAX.
    rapid: bool,
    /// Number of M words.
    m_words: usize,
    /// A word that acts at the end of the block.
    at_end: Option<&'static str>,
}

/// Most digits of a number about its point.
#[derive(Clone, Copy)]
pub(super) struct Places {
    pub(super) before: usize,
    pub(super) behind: usize,
}

/// A number with as many places as the control takes.
pub(super) fn decimal(text: &str, Places { before, behind }: Places) -> Result<f64, String> {
    let value = number(text).map_err(|reason| match text.contains(',') {
        true => format!("`{}`: write a decimal point", shown(text, 40)),
        false => reason,
    })?;
    let bytes = text.as_bytes();
    let from = bytes.iter().take_while(|byte| matches!(byte, b'-' | b'+' | b'0')).count();
    let point = bytes.iter().position(|byte| *byte == b'.').unwrap_or(bytes.len());
    if point - from > before || (bytes.len() - point).saturating_sub(1) > behind {
        return Err(format!(
            "`{}` has more digits than the control takes: at most {before} and {behind}",
            shown(text, 40)
        ));
    }
    Ok(value)
}

/// A whole number without sign.
pub(super) fn count(text: &str, digits: usize) -> Result<u32, String> {
    let plain = !text.is_empty() && text.len() <= digits && text.bytes().all(|b| b.is_ascii_digit());
    let value = if plain { text.parse().ok() } else { None };
    value.ok_or_else(|| format!("`{}` is not a number of at most {digits} digits", shown(text, 40)))
}

/// A feed in mm/min.
pub(super) fn feed(text: &str) -> Result<f64, String> {
    match text {
        "AUTO" | "" => Err("F AUTO takes the feed from elsewhere: write the feed as a number".to_owned()),
        _ if text.starts_with(['U', 'Z', 'T', 'N', 'P']) => {
            Err(format!("`F{}` is not understood: only F in mm/min and FMAX are read", shown(text, 20)))
        }
        _ => decimal(text, RATE_PLACES).map_err(|why| format!("F: {why}")),
    }
}

/// Reads the words after L or LN.
pub(super) fn line(words: &[&str], vectors: bool, control: &Control, machine: &Machine) -> Result<NcBlock, String> {
    let mut read = Words::default();
    let mut rest = words.iter();
    if words.is_empty() {
        return Err("a straight line without words".to_owned());
    }
    while let Some(word) = rest.next() {
        read.word(word, &mut rest, control, machine)?;
    }
    read.finished(vectors)
}

/// Reads a block of M words alone.
pub(super) fn miscellaneous(words: &[&str], control: &Control, machine: &Machine) -> Result<NcBlock, String> {
    let mut read = Words::default();
    let mut rest = words.iter();
    while let Some(word) = rest.next() {
        match word.strip_prefix('M') {
            Some(code) => read.m_word(code, &mut rest, control, machine)?,
            None => return Err(format!("`{}` after an M word is not understood", shown(word, 40))),
        }
    }
    read.finished(false)
}

impl<'a> Words<'a> {
    fn word(
        &mut self,
        word: &'a str,
        rest: &mut std::slice::Iter<'_, &str>,
        control: &Control,
        machine: &Machine,
    ) -> Result<(), String> {
        let in_number = |byte: u8| byte.is_ascii_digit() || matches!(byte, b'+' | b'-' | b'.' | b',');
        let at = word.bytes().position(in_number).unwrap_or(word.len());
        let (address, value) = word.split_at(at);
        let named = |why: String| format!("`{}`: {why}", shown(word, 40));
        match address {
            "X" | "Y" | "Z" => {
                self.follow(0, word)?;
                let axis = usize::from(address.as_bytes()[0] - b'X');
                self.address(["X", "Y", "Z"][axis]);
                self.block.coordinate(axis, decimal(value, PLACES).map_err(named)?)
            }
            "TX" | "TY" | "TZ" => {
                self.follow(0, word)?;
                let axis = usize::from(address.as_bytes()[1] - b'X');
                self.address(["TX", "TY", "TZ"][axis]);
                self.block.component(control, axis, decimal(value, VECTOR_PLACES).map_err(named)?)
            }
            "NX" | "NY" | "NZ" => Err(format!(
                "`{address}` is not understood: with surface normals the control shifts the path by the oversizes of its \
                 tool table; write LN with TX TY TZ alone"
            )),
            "R" | "RL" | "RR" => {
                self.follow(1, word)?;
                let done = self.block.modal_word(control, word);
                done.unwrap_or_else(|| Err(format!("`{}` is not understood", shown(word, 40))))
            }
            "FMAX" if value.is_empty() => {
                self.follow(2, word)?;
                if self.rapid || self.block.feed.is_some() {
                    return Err("F and FMAX, or one twice, in one block".to_owned());
                }
                self.rapid = true;
                Ok(())
            }
            _ if word.as_bytes().first() == Some(&b'F') => {
                self.follow(2, word)?;
                if self.rapid {
                    return Err("F and FMAX in one block".to_owned());
                }
                self.block.set_feed(feed(&word[1..])?)
            }
            "M" => {
                self.follow(3, word)?;
                self.m_word(value, rest, control, machine)
            }
            _ if let Some(axis) = rotary_axis(machine, address) => {
                self.follow(0, word)?;
                self.address("angle");
                self.block.angle(axis, decimal(value, PLACES).map_err(named)?, machine)
            }
            _ => Err(not_understood(word, address)),
        }
    }

    /// Keeps an address. One that occurs twice is refused.
    fn address(&mut self, name: &'static str) {
        if let Some(place) = self.addresses.get_mut(self.count) {
            *place = name;
            self.count += 1;
        }
    }

    /// Checks the order of words.
    fn follow(&mut self, place: u8, word: &'a str) -> Result<(), String> {
        if place < self.place.0 {
            return Err(format!(
                "`{}` stands behind `{}`: the order of the control is axes, R0, F, M",
                shown(word, 40),
                shown(self.place.1, 40)
            ));
        }
        self.place = (place, word);
        Ok(())
    }

    fn m_word(
        &mut self,
        code: &str,
        rest: &mut std::slice::Iter<'_, &str>,
        control: &Control,
        machine: &Machine,
    ) -> Result<(), String> {
        self.m_words += 1;
        if self.m_words > MAX_M_WORDS {
            return Err(format!("more than {MAX_M_WORDS} M words: the iTNC 530 takes no more in one block"));
        }
        let code = count(code, 3).map_err(|why| format!("M: {why}"))?;
        let words: &[&'static str] = match code {
            3 => &["M3"],
            4 => &["M4"],
            5 => &["M5"],
            8 => &["M8"],
            9 => &["M9"],
            13 => &["M3", "M8"],
            14 => &["M4", "M8"],
            126 => &["M126"],
            127 => &["M127"],
            128 | 129 => return self.switch(code == 128, rest, control, machine),
            _ => return self.other(code, machine),
        };
        self.at_end = words.first().copied().filter(|word| matches!(*word, "M5" | "M9")).or(self.at_end);
        words.iter().try_for_each(|word| self.block.modal_word(control, word).unwrap_or(Ok(())))
    }

    /// An M word that sets no modal group.
    fn other(&mut self, code: u32, machine: &Machine) -> Result<(), String> {
        let block = &mut self.block;
        match code {
            0 => once(&mut block.wait, "M0, M1 or STOP", "M0"),
            1 => once(&mut block.wait, "M0, M1 or STOP", "M1"),
            2 => once(&mut block.end, "M30 or M2", "M2"),
            30 => once(&mut block.end, "M30 or M2", "M30"),
            91 if block.machine_frame => Err("`M91` occurs twice in one block".to_owned()),
            91 => {
                block.machine_frame = true;
                Ok(())
            }
            _ if block.clamp_word(&format!("M{code}"), machine) => Ok(()),
            _ => unread(code, machine),
        }
    }

    /// M128 with the largest feed of its compensating moves, or M129.
    fn switch(
        &mut self,
        on: bool,
        rest: &mut std::slice::Iter<'_, &str>,
        control: &Control,
        machine: &Machine,
    ) -> Result<(), String> {
        let [on_word, off_word] = control.transformation;
        if on_word != "M128" {
            return Err(format!(
                "{} and FUNCTION TCPM in one program: what is on is not certain; write {}",
                if on { "M128" } else { "M129" },
                if on { on_word } else { off_word }
            ));
        }
        if on {
            if let Some(word) = rest.as_slice().first().and_then(|word| word.strip_prefix('F')) {
                compensation(word, machine)?;
                rest.next();
            }
            let _ = self.block.modal_word(control, "M128");
        }
        once(&mut self.block.transformation, "M128 or M129", on)
    }

    /// Checks the words of a block together.
    fn finished(mut self, vectors: bool) -> Result<NcBlock, String> {
        let moves = self.block.has_axis_words();
        if vectors {
            self.check_vector()?;
        } else if self.block.vector.iter().any(Option::is_some) {
            return Err("TX, TY and TZ belong to a block of LN".to_owned());
        }
        if self.rapid && !moves {
            return Err("FMAX without axis words: it acts only in its block".to_owned());
        }
        if let Some(word) = self.at_end.filter(|_| moves && !self.rapid) {
            return Err(format!("{word} acts at the end of its block: write it in a block of its own"));
        }
        if moves {
            self.block.motion = Some(if self.rapid { MotionWord::Rapid } else { MotionWord::Feed });
        }
        Ok(self.block)
    }

    /// The control takes LN only with all components, in one order.
    fn check_vector(&self) -> Result<(), String> {
        const DUE: [&str; 6] = ["X", "Y", "Z", "TX", "TY", "TZ"];
        let addresses = &self.addresses[..self.count];
        if let Some(missing) = DUE.iter().find(|word| !addresses.contains(word)) {
            return Err(format!("LN without {missing}: the control needs X Y Z TX TY TZ in every block of LN"));
        }
        if addresses != DUE {
            return Err("the words of LN must stand in the order X Y Z TX TY TZ, without rotary axes".to_owned());
        }
        let length = self.block.vector.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
        if (length - 1.0).abs() > VECTOR_LENGTH_ERROR {
            return Err(format!(
                "TX, TY and TZ have the length {length:.6}: the control needs a vector of length 1, with four decimals or \
                 more"
            ));
        }
        Ok(())
    }
}

/// Checks the largest feed of compensating moves, which is not the feed of the tool.
pub(super) fn compensation(text: &str, machine: &Machine) -> Result<(), String> {
    let most = feed(text)?;
    let fastest = machine.linear.iter().map(|axis| axis.speed * 60.0).fold(0.0, f64::max);
    if most < fastest {
        return Err(format!(
            "F{} limits the moves with which X, Y and Z follow the rotary axes; it is not the feed of the tool. The axes are \
             as fast as {fastest:.0} mm/min: leave this F out",
            shown(text, 20)
        ));
    }
    Ok(())
}

fn not_understood(word: &str, address: &str) -> String {
    let word = shown(word, 40);
    let why = match address {
        "" => "",
        _ if address.starts_with('I') && address.len() == 2 => ": it is a distance; write the position without I",
        _ if address.starts_with('P') => ": polar coordinates are not read",
        _ if address.contains('Q') => ": parameters are not read",
        "A" | "B" | "C" | "U" | "V" | "W" => ": the machine has no such axis",
        _ if address.bytes().any(|b| b.is_ascii_lowercase()) => ": write words in capital letters",
        _ => "",
    };
    format!("`{word}` is not understood{why}")
}

/// Takes the words of the machine builder that the machine file names, and says why another M word is not read.
fn unread(code: u32, machine: &Machine) -> Result<(), String> {
    let why = match code {
        6 => "tools are changed by TOOL CALL",
        92 => "the machine builder sets its reference; write M91",
        140 => "its way depends on settings of the control; write L Z.. R0 FMAX M91",
        94 => "it changes the position of a rotary axis",
        90 | 112 | 124 | 134 | 135 => "it changes how the control rounds corners; write CYCL DEF 32",
        103 | 109..=111 | 116 | 136 => "it changes the meaning of F",
        114 | 115 | 138 | 144 | 145 => "it changes which axes the control compensates",
        118 => "the handwheel would move the tool during the program",
        89 | 97 | 98 | 99 | 107 | 120 | 130 | 143 | 148 => "it changes the path or the checks of the control",
        _ if machine.own_words.iter().any(|word| *word == format!("M{code}")) => return Ok(()),
        _ => {
            "a word of the machine builder; if it changes neither path, tool, spindle nor coolant, add it to `own-words` of \
             the machine file"
        }
    };
    Err(format!("`M{code}` is not understood: {why}"))
}
