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

/// Widest tolerance of the direction, degrees: that of the writer.
const WIDEST_TURN: f64 = 0.1;

/// Reads a program.
pub(super) fn read(text: &str, machine: &Machine) -> Result<Vec<NcMove>, Vec<ReadError>> {
    read_state::read(text, "M30", |line, state: &State| {
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
        // SUPA takes frames away, not the tool: with its length Z0 is another height.
        if block.machine_frame && block.length.unwrap_or(state.length()) {
            return Err(Fault::State("SUPA without D0: the tool length still acts".to_owned()));
        }
        if state.turns_unsaid(&block) {
            return Err(Fault::State("a turn of A or C without ORIAXES: how the axis turns is not known".to_owned()));
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
        "ORIWKS" => block.part_vectors = true,
        "G17" | "G40" | "M8" | "M9" => {}
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
        // The control takes a digit behind these letters for a part of the name.
        None if ["A3", "B3", "C3"].iter().any(|v| word.starts_with(v)) => {
            return Err(format!("`{}`: `=` is missing behind the address", shown(word)));
        }
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
    read_state::shown(word, 40)
}

/// Tolerance of CYCLE832(tolerance, mode, orientation tolerance); off, the control goes back to settings of its own.
fn smoothing(arguments: &str) -> Result<Option<f64>, String> {
    let parts: Vec<&str> = arguments.split(',').collect();
    let &[tolerance, mode, turn] = parts.as_slice() else {
        return Err("CYCLE832 needs a tolerance, a mode and a tolerance of the direction".to_owned());
    };
    let (tolerance, turn) = (number(tolerance)?, number(turn)?);
    if !(0.0..=WIDEST).contains(&tolerance) || !(0.0..=WIDEST).contains(&turn) {
        return Err(format!("a tolerance of CYCLE832 beyond 0..{WIDEST}"));
    }
    match mode {
        "_OFF" => Ok(None),
        "_ORI_FINISH" | "_ORI_ROUGH" if turn > WIDEST_TURN => {
            Err(format!("CYCLE832 lets the tool lean by {turn} deg; at most {WIDEST_TURN} deg is accepted"))
        }
        "_ORI_FINISH" | "_ORI_ROUGH" => Ok(Some(tolerance)),
        _ => Err(format!("the mode {} of CYCLE832 is not understood", shown(mode))),
    }
}
