//! Reader of the LinuxCNC dialect: interprets lines with their modal state. Shares nothing with the writer.

use super::{Direction, NcMove, ReadError};
use nalgebra::Point3;

/// Longest line of the interpreter, without its end.
const LONGEST_LINE: usize = 252;

/// Modal state.
#[derive(Default)]
struct Control {
    transformation: bool,
    rapid: Option<bool>,
    feed: Option<f64>,
    tool: String,
    speed: f64,
    ended: bool,
    /// Rotary positions said with the transformation off, radians, ISO.
    parked: Option<(f64, f64)>,
    moves: Vec<NcMove>,
}

/// Reads a program.
pub(super) fn read(text: &str) -> Result<Vec<NcMove>, ReadError> {
    let mut control = Control::default();
    for (i, line) in text.lines().enumerate() {
        let fault = |reason: String| ReadError { line: i + 1, reason };
        if line.len() > LONGEST_LINE {
            return Err(fault(format!("longer than {LONGEST_LINE} characters")));
        }
        let code = without_comments(line).map_err(fault)?;
        if code.trim().is_empty() {
            continue;
        }
        if control.ended {
            return Err(fault("text after the end of the program".to_owned()));
        }
        control.line(&code, i + 1).map_err(fault)?;
    }
    if !control.ended {
        let line = text.lines().count();
        return Err(ReadError { line, reason: "the program does not end with M2".to_owned() });
    }
    Ok(control.moves)
}

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
            (false, c) => code.push(c),
            (true, _) => {}
        }
    }
    if inside { Err("a comment does not end".to_owned()) } else { Ok(code) }
}

/// Letter and number pairs of a line, blanks ignored.
fn words(code: &str) -> Result<Vec<(char, f64, String)>, String> {
    let mut words = Vec::new();
    let code: String = code.chars().filter(|c| !c.is_whitespace()).collect();
    let mut rest = code.as_str();
    while let Some(letter) = rest.chars().next() {
        if !letter.is_ascii_alphabetic() {
            return Err(format!("`{letter}` where a word begins"));
        }
        let tail = &rest[letter.len_utf8()..];
        let end = tail.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+'))).unwrap_or(tail.len());
        let (number, next) = tail.split_at(end);
        let value: f64 = number.parse().map_err(|_| format!("`{letter}{number}` is not a number"))?;
        words.push((letter.to_ascii_uppercase(), value, number.to_owned()));
        rest = next;
    }
    Ok(words)
}

impl Control {
    fn line(&mut self, code: &str, line: usize) -> Result<(), String> {
        let mut coordinates: [Option<f64>; 5] = [None; 5];
        let mut machine_frame = false;
        let mut tool_change = None;
        let mut length = None;
        let mut seen = String::new();
        for (letter, value, text) in words(code)? {
            if !matches!(letter, 'G' | 'M') {
                if seen.contains(letter) {
                    return Err(format!("`{letter}` stands twice on one line"));
                }
                seen.push(letter);
            }
            let slot = match letter {
                'X' => 0,
                'Y' => 1,
                'Z' => 2,
                'A' => 3,
                'C' => 4,
                'F' if value > 0.0 => {
                    self.feed = Some(value);
                    continue;
                }
                'S' if value >= 0.0 => {
                    self.speed = value;
                    continue;
                }
                'T' => {
                    tool_change = Some(text);
                    continue;
                }
                'H' => {
                    length = Some(text);
                    continue;
                }
                'P' | 'Q' => continue,
                'G' => {
                    match text.as_str() {
                        "0" => self.rapid = Some(true),
                        "1" => self.rapid = Some(false),
                        "53" => machine_frame = true,
                        "21" | "17" | "90" | "40" | "49" | "80" | "94" | "54" | "64" | "43" => {}
                        _ => return Err(format!("G{text} is not understood")),
                    }
                    continue;
                }
                'M' => {
                    match text.as_str() {
                        "428" => self.transformation = true,
                        "429" => {
                            self.transformation = false;
                            self.parked = None;
                        }
                        "2" => self.ended = true,
                        "3" | "5" | "6" | "8" | "9" => {}
                        _ => return Err(format!("M{text} is not understood")),
                    }
                    continue;
                }
                _ => return Err(format!("`{letter}{text}` is not understood")),
            };
            coordinates[slot] = Some(value);
        }
        if let Some(tool) = tool_change {
            self.tool = tool;
        }
        if length.is_some_and(|h| h != self.tool) {
            return Err("the length of another tool".to_owned());
        }
        self.moved(coordinates, machine_frame, line)
    }

    fn moved(&mut self, at: [Option<f64>; 5], machine_frame: bool, line: usize) -> Result<(), String> {
        if machine_frame {
            return Ok(());
        }
        // The words have the opposite of the ISO sense.
        match at {
            [None, None, None, None, None] => Ok(()),
            [None, None, None, Some(a), Some(c)] if !self.transformation => {
                self.parked = Some((-a.to_radians(), -c.to_radians()));
                Ok(())
            }
            [Some(x), Some(y), Some(z), Some(a), Some(c)] if self.transformation => {
                let rapid = self.rapid.ok_or("a move before any G0 or G1")?;
                let feed = if rapid { None } else { Some(self.feed.ok_or("G1 without a feed")?) };
                self.moves.push(NcMove {
                    line,
                    rapid,
                    tip: Point3::new(x, y, z),
                    direction: Direction::Rotary(-a.to_radians(), -c.to_radians()),
                    start: self.parked.take(),
                    feed,
                    tool: self.tool.clone(),
                    speed: self.speed,
                });
                Ok(())
            }
            _ => Err("a move needs X Y Z A C, with M428 on".to_owned()),
        }
    }
}
