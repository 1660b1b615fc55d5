//! Reader of the 840D dialect: interprets blocks with their modal state. Shares nothing with the writer.

use super::{Direction, NcMove, ReadError};
use crate::kin::Machine;
use nalgebra::{Point3, Vector3};

/// Modal state.
struct Control<'a> {
    machine: &'a Machine,
    transformation: bool,
    rapid: Option<bool>,
    feed: Option<f64>,
    tool: String,
    speed: f64,
    running: bool,
    /// Rotary positions said with the transformation off, radians, ISO.
    parked: Option<(f64, f64)>,
    moves: Vec<NcMove>,
}

/// Words of one block.
#[derive(Default)]
struct Block {
    tip: [Option<f64>; 3],
    vector: [Option<f64>; 3],
    rotary: [Option<f64>; 2],
    machine_frame: bool,
    motion: Option<bool>,
}

/// Reads a program.
pub(super) fn read(text: &str, machine: &Machine) -> Result<Vec<NcMove>, ReadError> {
    let mut control = Control {
        machine,
        transformation: false,
        rapid: None,
        feed: None,
        tool: String::new(),
        speed: 0.0,
        running: true,
        parked: None,
        moves: Vec::new(),
    };
    for (i, line) in text.lines().enumerate() {
        let fault = |reason: String| ReadError { line: i + 1, reason };
        let code = line.split(';').next().unwrap_or_default().trim();
        if code.is_empty() {
            continue;
        }
        if !control.running {
            return Err(fault("text after the end of the program".to_owned()));
        }
        control.block(code, i + 1).map_err(fault)?;
    }
    if control.running {
        let line = text.lines().count();
        return Err(ReadError { line, reason: "the program does not end with M30".to_owned() });
    }
    Ok(control.moves)
}

impl Control<'_> {
    fn block(&mut self, code: &str, line: usize) -> Result<(), String> {
        let mut block = Block::default();
        for word in code.split_whitespace() {
            self.word(word, &mut block)?;
        }
        self.moved(&block, line)
    }

    fn word(&mut self, word: &str, block: &mut Block) -> Result<(), String> {
        match word {
            "TRAORI" => self.transformation = true,
            "TRAFOOF" => {
                self.transformation = false;
                self.parked = None;
            }
            "SUPA" => block.machine_frame = true,
            "G0" => block.motion = Some(true),
            "G1" => block.motion = Some(false),
            "G17" | "G710" | "G90" | "G94" | "G40" | "G500" | "G54" | "ORIWKS" | "ORIAXES" | "D0" | "D1" | "M3"
            | "M5" | "M6" | "M8" | "M9" => {}
            "M30" => self.running = false,
            _ => return self.valued_word(word, block),
        }
        Ok(())
    }

    fn valued_word(&mut self, word: &str, block: &mut Block) -> Result<(), String> {
        if word.starts_with("CYCLE832(") && word.ends_with(')') {
            return Ok(());
        }
        if let Some(name) = word.strip_prefix("T=\"").and_then(|w| w.strip_suffix('"')) {
            name.clone_into(&mut self.tool);
            return Ok(());
        }
        let (address, value) = match word.split_once('=') {
            Some(pair) => pair,
            None => word.split_at(word.char_indices().nth(1).map_or(word.len(), |c| c.0)),
        };
        let number = || -> Result<f64, String> {
            let plain = value.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+'));
            value.parse().ok().filter(|x: &f64| plain && x.is_finite()).ok_or(format!("`{word}` is not a number"))
        };
        let slot = match address {
            "N" => return number().map(|_| ()),
            "F" => {
                self.feed = Some(number()?);
                return Ok(());
            }
            "S" => {
                self.speed = number()?;
                return Ok(());
            }
            "X" => &mut block.tip[0],
            "Y" => &mut block.tip[1],
            "Z" => &mut block.tip[2],
            "A3" => &mut block.vector[0],
            "B3" => &mut block.vector[1],
            "C3" => &mut block.vector[2],
            "A" => &mut block.rotary[0],
            "C" => &mut block.rotary[1],
            _ => return Err(format!("`{word}` is not understood")),
        };
        if slot.replace(number()?).is_some() {
            return Err(format!("`{address}` stands twice in one block"));
        }
        Ok(())
    }

    fn moved(&mut self, block: &Block, line: usize) -> Result<(), String> {
        if block.motion.is_some() {
            self.rapid = block.motion;
        }
        if block.machine_frame {
            return Ok(());
        }
        let iso = |a: f64, c: f64| {
            (a.to_radians() * self.machine.tilt.word_sign, c.to_radians() * self.machine.turn.word_sign)
        };
        let direction = match (block.vector, block.rotary) {
            ([None, None, None], [None, None]) => None,
            ([Some(x), Some(y), Some(z)], [None, None]) => {
                let axis = Vector3::new(x, y, z);
                Some(Direction::Axis(axis.try_normalize(1e-6).ok_or("a direction vector of length 0")?))
            }
            ([None, None, None], [Some(a), Some(c)]) => {
                let (a, c) = iso(a, c);
                Some(Direction::Rotary(a, c))
            }
            _ => return Err("an incomplete direction: A3 B3 C3 or A C must stand together".to_owned()),
        };
        match (block.tip, direction) {
            ([None, None, None], None) => Ok(()),
            ([None, None, None], Some(Direction::Rotary(a, c))) if !self.transformation => {
                self.parked = Some((a, c));
                Ok(())
            }
            ([Some(x), Some(y), Some(z)], Some(direction)) if self.transformation => {
                let rapid = self.rapid.ok_or("a move before any G0 or G1")?;
                let feed = if rapid { None } else { Some(self.feed.ok_or("G1 without a feed")?) };
                self.moves.push(NcMove {
                    line,
                    rapid,
                    tip: Point3::new(x, y, z),
                    direction,
                    start: self.parked.take(),
                    feed,
                    tool: self.tool.clone(),
                    speed: self.speed,
                });
                Ok(())
            }
            _ => Err("a move needs X Y Z and a direction, with TRAORI on".to_owned()),
        }
    }
}
