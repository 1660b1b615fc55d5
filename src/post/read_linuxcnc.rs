//! Reader of the LinuxCNC dialect: words of lines. Shares nothing with the writer.
//!
//! Modal: G0 and G1, X Y Z A C, F, S. Comments stand in brackets or after a semicolon; blanks mean nothing.

use super::read_state::{self, Block, Fault, State, number, once};
use super::{NcMove, ReadError};

/// Longest line of the interpreter, without its end.
const LONGEST_LINE: usize = 252;

/// Widest tolerance of G64, mm.
const WIDEST: f64 = 10.0;

/// Reads a program.
pub(super) fn read(text: &str) -> Result<Vec<NcMove>, Vec<ReadError>> {
    read_state::read(text, "M2", |line, state| {
        if line.len() > LONGEST_LINE {
            return Err(Fault::Words(format!("longer than {LONGEST_LINE} characters")));
        }
        let code = without_comments(line).map_err(Fault::Words)?;
        if code.is_empty() {
            return Ok(None);
        }
        block(&code, state)
    })
}

/// A line without comments and blanks.
fn without_comments(line: &str) -> Result<String, String> {
    let mut code = String::with_capacity(line.len());
    let mut inside = false;
    for c in line.chars() {
        match (inside, c) {
            (false, ';') => break,
            (false, '(') => inside = true,
            (true, ')') => inside = false,
            (true, '(') => return Err("a comment inside a comment".to_owned()),
            (false, ')') => return Err("a comment ends that did not begin".to_owned()),
            (false, c) if c.is_whitespace() => {}
            (false, c) => code.push(c),
            (true, _) => {}
        }
    }
    if inside { Err("a comment does not end".to_owned()) } else { Ok(code) }
}

/// First word of a text without blanks: its letter, its number as written, and the rest.
fn first_word(code: &str) -> Result<(char, &str, &str), String> {
    let letter = code.chars().next().unwrap_or(' ');
    if !letter.is_ascii_alphabetic() {
        return Err(format!("`{}` where a word begins", read_state::shown(&letter.to_string(), 1)));
    }
    let tail = &code[letter.len_utf8()..];
    let end = tail.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+'))).unwrap_or(tail.len());
    let (number, rest) = tail.split_at(end);
    Ok((letter.to_ascii_uppercase(), number, rest))
}

/// Words that belong to a code of the same line.
#[derive(Default)]
struct Parameters {
    length_of: Option<u32>,
    p: Option<f64>,
    q: Option<f64>,
    blends: bool,
    takes_length: bool,
}

fn block(code: &str, state: &State) -> Result<Option<Block>, Fault> {
    let mut block = Block::default();
    let mut parameters = Parameters::default();
    let mut rest = code;
    let mut first = true;
    let mut empty = true;
    while !rest.is_empty() {
        let (letter, text, next) = first_word(rest).map_err(Fault::Words)?;
        rest = next;
        if !(first && letter == 'N' && count(text).is_ok()) {
            empty = false;
            word(letter, text, &mut block, &mut parameters).map_err(Fault::Words)?;
        }
        first = false;
    }
    if empty {
        return Ok(None);
    }
    let words = |reason: &str| Fault::Words(reason.to_owned());
    let good = |tolerance: f64| (0.0..=WIDEST).contains(&tolerance);
    match (parameters.blends, parameters.p) {
        // Corners are blended within P, and before that moves in line are joined within Q, which is P unless said.
        (true, Some(p)) if good(p) && parameters.q.is_none_or(good) => {
            block.smoothing = Some(Some(p + parameters.q.unwrap_or(p)));
        }
        (true, Some(p)) if good(p) => return Err(words("the tolerance Q of G64 is out of range")),
        (true, Some(_)) => return Err(words("the tolerance P of G64 is out of range")),
        (true, None) => return Err(words("G64 without P: how far the path is left is not known")),
        (false, None) if parameters.q.is_none() => {}
        (false, _) => return Err(words("P or Q without G64")),
    }
    if parameters.takes_length != parameters.length_of.is_some() {
        return Err(words("G43 and H belong together"));
    }
    let wanted = parameters.length_of.map(|h| h.to_string());
    let changed = block.tool.as_deref().filter(|_| block.change);
    if wanted.is_some() && wanted.as_deref() != changed.or(state.tool()) {
        return Err(Fault::State("the length of another tool".to_owned()));
    }
    Ok(Some(block))
}

fn count(text: &str) -> Result<u32, String> {
    text.parse().ok().filter(|_| text.bytes().all(|b| b.is_ascii_digit())).ok_or_else(|| match text {
        "" => "a number is missing".to_owned(),
        _ => format!("`{text}` is not a count"),
    })
}

fn word(letter: char, text: &str, block: &mut Block, parameters: &mut Parameters) -> Result<(), String> {
    let value = || number(text).map_err(|reason| format!("`{letter}{text}`: {reason}"));
    let number_of = || count(text).map_err(|reason| format!("`{letter}{text}`: {reason}"));
    match letter {
        'X' => block.coordinate(0, value()?),
        'Y' => block.coordinate(1, value()?),
        'Z' => block.coordinate(2, value()?),
        // The rotary words have the opposite of the ISO sense.
        'A' => block.angle(0, value()?, -1.0),
        'C' => block.angle(1, value()?, -1.0),
        'F' => block.set_feed(value()?),
        'S' => block.set_speed(value()?),
        'T' => once(&mut block.tool, "T", number_of()?.to_string().into()),
        'H' => once(&mut parameters.length_of, "H", number_of()?),
        'P' => once(&mut parameters.p, "P", value()?),
        'Q' => once(&mut parameters.q, "Q", value()?),
        'G' => match text {
            "0" | "00" => once(&mut block.motion, "G0", true),
            "1" | "01" => once(&mut block.motion, "G1", false),
            "53" => flag(&mut block.machine_frame),
            "21" => flag(&mut block.modes[0]),
            "90" => flag(&mut block.modes[1]),
            "94" => flag(&mut block.modes[2]),
            "54" => once(&mut block.offset, "G54", true),
            "43" => {
                parameters.takes_length = true;
                once(&mut block.length, "G43", true)
            }
            "49" => once(&mut block.length, "G49", false),
            "64" => flag(&mut parameters.blends),
            "17" | "40" | "80" => Ok(()),
            _ => Err(format!("`G{text}` is not understood")),
        },
        'M' => match text {
            "428" => once(&mut block.transformation, "M428", true),
            "429" => once(&mut block.transformation, "M429", false),
            "2" | "02" => flag(&mut block.end),
            "3" | "03" => once(&mut block.spindle, "M3", true),
            "5" | "05" => once(&mut block.spindle, "M5", false),
            "6" | "06" => flag(&mut block.change),
            "8" | "08" | "9" | "09" => Ok(()),
            _ => Err(format!("`M{text}` is not understood")),
        },
        _ => Err(format!("`{letter}{text}` is not understood")),
    }
}

#[expect(clippy::unnecessary_wraps, reason = "stands among words that can be refused")]
fn flag(flag: &mut bool) -> Result<(), String> {
    *flag = true;
    Ok(())
}
