//! Reader of the 840D dialect: words of blocks. Shares nothing with the writer.
//!
//! Modal: G0 and G1, X Y Z, F, S, the direction as a whole. A vector is taken with all three components only: on the
//! control a missing one counts as 0, which nobody means.

use super::read_state::{self, Block, Fault, State, number, once};
use super::{NcMove, ReadError};
use crate::kin::Machine;

/// Longest block of the control.
const LONGEST_BLOCK: usize = 512;

/// Largest tolerance of CYCLE832, mm and degrees.
const WIDEST: f64 = 10.0;

/// Reads a program.
pub(super) fn read(text: &str, machine: &Machine) -> Result<Vec<NcMove>, Vec<ReadError>> {
    read_state::read(text, "M30", |line, _: &State| {
        let code = line.split(';').next().unwrap_or_default().trim();
        if code.is_empty() {
            return Ok(None);
        }
        if line.len() > LONGEST_BLOCK {
            return Err(Fault::Words(format!("longer than {LONGEST_BLOCK} characters")));
        }
        let mut block = Block::default();
        let mut numbered = false;
        for (i, word) in code.split_whitespace().enumerate() {
            if i == 0 && word.strip_prefix('N').is_some_and(is_count) {
                numbered = true;
                continue;
            }
            self::word(word, machine, &mut block).map_err(Fault::Words)?;
        }
        let empty = numbered && code.split_whitespace().count() == 1;
        Ok((!empty).then_some(block))
    })
}

fn is_count(text: &str) -> bool {
    (1..=9).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit())
}

fn word(word: &str, machine: &Machine, block: &mut Block) -> Result<(), String> {
    match word {
        "TRAORI" => return once(&mut block.transformation, "TRAORI", true),
        "TRAFOOF" => return once(&mut block.transformation, "TRAFOOF", false),
        "SUPA" => block.machine_frame = true,
        "G0" => return once(&mut block.motion, "G0", true),
        "G1" => return once(&mut block.motion, "G1", false),
        "G710" => block.modes[0] = true,
        "G90" => block.modes[1] = true,
        "G94" => block.modes[2] = true,
        "G500" => return once(&mut block.offset, "G500", false),
        "G54" => return once(&mut block.offset, "G54", true),
        "D0" => return once(&mut block.length, "D0", false),
        "D1" => return once(&mut block.length, "D1", true),
        "M3" => return once(&mut block.spindle, "M3", true),
        "M5" => return once(&mut block.spindle, "M5", false),
        "M6" => block.change = true,
        "ORIAXES" => block.axes_linear = true,
        "G17" | "G40" | "ORIWKS" | "M8" | "M9" => {}
        "M30" => block.end = true,
        _ => return valued(word, machine, block),
    }
    Ok(())
}

fn valued(word: &str, machine: &Machine, block: &mut Block) -> Result<(), String> {
    if let Some(arguments) = word.strip_prefix("CYCLE832(").and_then(|w| w.strip_suffix(')')) {
        return once(&mut block.smoothing, "CYCLE832", smoothing(arguments)?);
    }
    if let Some(name) = word.strip_prefix("T=\"").and_then(|w| w.strip_suffix('"')) {
        return once(&mut block.tool, "T", name.into());
    }
    let (address, value) = match word.split_once('=') {
        Some(pair) => pair,
        None => word.split_at(word.char_indices().nth(1).map_or(word.len(), |c| c.0)),
    };
    let value = || number(value).map_err(|reason| format!("`{}`: {reason}", shown(word)));
    match address {
        "F" => block.set_feed(value()?),
        "S" => block.set_speed(value()?),
        "X" => block.coordinate(0, value()?),
        "Y" => block.coordinate(1, value()?),
        "Z" => block.coordinate(2, value()?),
        "A3" => block.component(0, value()?),
        "B3" => block.component(1, value()?),
        "C3" => block.component(2, value()?),
        "A" => block.angle(0, value()?, machine.tilt.word_sign),
        "C" => block.angle(1, value()?, machine.turn.word_sign),
        _ => Err(format!("`{}` is not understood", shown(word))),
    }
}

/// A word as a message shows it.
fn shown(word: &str) -> String {
    word.chars().take(40).collect()
}

/// Tolerance of CYCLE832(tolerance, mode, orientation tolerance).
fn smoothing(arguments: &str) -> Result<f64, String> {
    let parts: Vec<&str> = arguments.split(',').collect();
    let &[tolerance, mode, turn] = parts.as_slice() else {
        return Err("CYCLE832 needs a tolerance, a mode and a tolerance of the direction".to_owned());
    };
    let (tolerance, turn) = (number(tolerance)?, number(turn)?);
    if !(0.0..=WIDEST).contains(&tolerance) || !(0.0..=WIDEST).contains(&turn) {
        return Err(format!("a tolerance of CYCLE832 beyond 0..{WIDEST}"));
    }
    match mode {
        "_OFF" => Ok(0.0),
        "_ORI_FINISH" | "_ORI_ROUGH" => Ok(tolerance),
        _ => Err(format!("the mode {} of CYCLE832 is not understood", shown(mode))),
    }
}
