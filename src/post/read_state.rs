//! What the readers of all dialects stand on: numbers with their limits, the state of a control, faults by line.
//! Shares nothing with the writers.
//!
//! A control is strict: a word that is not known, a position that nobody said, or a transformation in the wrong place is
//! a fault, never skipped. What a block leaves unsaid keeps its modal value where the control keeps it.

use super::{Direction, NcMove, ReadError};
use nalgebra::{Point3, Vector3};
use std::sync::Arc;

/// Most faults of one text that are told.
const MOST_FAULTS: usize = 20;

/// Most moves of one text: beyond them the memory of the checks that follow would have no bound.
const MOST_MOVES: usize = 4_000_000;

/// Longest number, in characters.
const LONGEST_NUMBER: usize = 24;

/// Farthest coordinate, mm: beyond any machine.
const FARTHEST: f64 = 1e5;

/// Largest rotary word, degrees: a hundred turns.
const LARGEST_ANGLE: f64 = 36_000.0;

/// Largest feed (mm/min) and spindle speed (rpm).
const FASTEST: f64 = 1e6;

/// Why a block is refused.
pub(super) enum Fault {
    /// It is not in the dialect; told even after other faults.
    Words(String),
    /// It does not fit the state of the control; after another fault the state is no longer known.
    State(String),
}

/// A plain decimal number.
pub(super) fn number(text: &str) -> Result<f64, String> {
    let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
    let plain = digits.bytes().all(|b| b.is_ascii_digit() || b == b'.')
        && digits.bytes().any(|b| b.is_ascii_digit())
        && digits.bytes().filter(|b| *b == b'.').count() <= 1
        && text.len() <= LONGEST_NUMBER;
    let value = if plain { text.parse().ok() } else { None };
    value.filter(|x: &f64| x.is_finite()).ok_or_else(|| match text {
        "" => "a number is missing".to_owned(),
        _ => format!("`{}` is not a number", shown(text, LONGEST_NUMBER)),
    })
}

/// The first characters of a text as a message shows them; what looks like another sign, or like none, by its number.
pub(super) fn shown(text: &str, most: usize) -> String {
    let plain = |c: char| if c.is_ascii() { c.to_string() } else { format!("<U+{:04X}>", u32::from(c)) };
    text.chars().take(most).map(plain).collect()
}

/// What the words of one block say. Angles in radians, ISO sense.
#[derive(Default)]
pub(super) struct Block {
    /// True for rapid, false for feed.
    pub(super) motion: Option<bool>,
    /// Coordinates are those of the machine.
    pub(super) machine_frame: bool,
    /// X Y Z, mm.
    pub(super) tip: [Option<f64>; 3],
    /// Tool direction.
    pub(super) vector: [Option<f64>; 3],
    /// A and C.
    pub(super) rotary: [Option<f64>; 2],
    /// mm/min.
    pub(super) feed: Option<f64>,
    /// rpm.
    pub(super) speed: Option<f64>,
    /// Tool that is made ready.
    pub(super) tool: Option<Arc<str>>,
    /// The tool that is ready comes into the spindle.
    pub(super) change: bool,
    /// Spindle on or off.
    pub(super) spindle: Option<bool>,
    /// Tool centre point control on or off.
    pub(super) transformation: Option<bool>,
    /// Tool length on or off.
    pub(super) length: Option<bool>,
    /// Work offset on or off.
    pub(super) offset: Option<bool>,
    /// Tolerance of path smoothing, mm; `Some(None)` when it is left to the control from here on.
    pub(super) smoothing: Option<Option<f64>>,
    /// Rotary axes run linearly between direction vectors.
    pub(super) axes_linear: bool,
    /// Direction vectors are those of the part.
    pub(super) part_vectors: bool,
    /// Lengths in mm, coordinates absolute, feed a minute.
    pub(super) modes: [bool; 3],
    /// The program ends.
    pub(super) end: bool,
}

/// Stores a coordinate or direction word.
pub(super) fn store(slot: &mut Option<f64>, address: &str, value: f64, limit: f64) -> Result<(), String> {
    if value.abs() > limit {
        return Err(format!("{address} = {value} is out of range: at most {limit:.0}"));
    }
    once(slot, address, value)
}

/// Stores what may stand once in a block.
pub(super) fn once<T>(slot: &mut Option<T>, address: &str, value: T) -> Result<(), String> {
    if slot.replace(value).is_some() { Err(format!("`{address}` stands twice in one block")) } else { Ok(()) }
}

impl Block {
    /// X, Y or Z.
    pub(super) fn coordinate(&mut self, axis: usize, value: f64) -> Result<(), String> {
        store(&mut self.tip[axis], ["X", "Y", "Z"][axis], value, FARTHEST)
    }

    /// A component of the direction vector.
    pub(super) fn component(&mut self, axis: usize, value: f64) -> Result<(), String> {
        store(&mut self.vector[axis], ["A3", "B3", "C3"][axis], value, FARTHEST)
    }

    /// A or C, in degrees of the word, with the sign that the word has against the ISO sense.
    pub(super) fn angle(&mut self, axis: usize, degrees: f64, sign: f64) -> Result<(), String> {
        store(&mut self.rotary[axis], ["A", "C"][axis], degrees, LARGEST_ANGLE)?;
        self.rotary[axis] = Some(degrees.to_radians() * sign);
        Ok(())
    }

    /// F.
    pub(super) fn set_feed(&mut self, value: f64) -> Result<(), String> {
        if value <= 0.0 {
            return Err(format!("a feed of {value}"));
        }
        store(&mut self.feed, "F", value, FASTEST)
    }

    /// S.
    pub(super) fn set_speed(&mut self, value: f64) -> Result<(), String> {
        if value < 0.0 {
            return Err(format!("a spindle speed of {value}"));
        }
        store(&mut self.speed, "S", value, FASTEST)
    }

    fn has_axis_words(&self) -> bool {
        self.tip.iter().chain(&self.vector).chain(&self.rotary).any(Option::is_some)
    }
}

/// State of the control. Nothing is taken for granted at its start.
#[derive(Default)]
pub(super) struct State {
    modes: [bool; 3],
    transformation: bool,
    retracted: bool,
    /// Rotary positions said with the transformation off, radians, ISO.
    parked: Option<[f64; 2]>,
    /// The same, for the first move with the transformation on.
    start: Option<(f64, f64)>,
    axes_linear: bool,
    part_vectors: bool,
    tip: [Option<f64>; 3],
    direction: Option<Direction>,
    rapid: Option<bool>,
    feed: Option<f64>,
    ready: Option<Arc<str>>,
    tool: Option<Arc<str>>,
    length: bool,
    offset: bool,
    speed: f64,
    spindle: bool,
    smoothing: Option<f64>,
    ended: bool,
    moves: Vec<NcMove>,
}

impl State {
    /// The name of the tool in the spindle.
    pub(super) fn tool(&self) -> Option<&str> {
        self.tool.as_deref()
    }

    /// Whether a tool length acts.
    pub(super) fn length(&self) -> bool {
        self.length
    }

    /// Whether rotary words turn the tool under the transformation while nobody said how it turns between them.
    pub(super) fn turns_unsaid(&self, block: &Block) -> bool {
        let before = match self.direction {
            Some(Direction::Rotary(a, c)) => [Some(a), Some(c)],
            _ => [None; 2],
        };
        let same = |(word, before): (&Option<f64>, Option<f64>)| word.is_none_or(|w| Some(w) == before);
        self.transformation && !(self.axes_linear || block.axes_linear) && !block.rotary.iter().zip(before).all(same)
    }

    /// Runs one block.
    pub(super) fn run(&mut self, block: &Block, line: usize) -> Result<(), String> {
        for (set, said) in self.modes.iter_mut().zip(block.modes) {
            *set |= said;
        }
        self.set_tool(block)?;
        self.switch(block)?;
        self.moved(block, line)?;
        self.ended = block.end;
        Ok(())
    }

    fn set_tool(&mut self, block: &Block) -> Result<(), String> {
        if let Some(tool) = &block.tool {
            self.ready = Some(Arc::clone(tool));
        }
        if block.change {
            if self.transformation || !self.retracted {
                return Err("a tool change before the tool is at Z0 of the machine".to_owned());
            }
            self.tool = Some(self.ready.clone().ok_or("M6 before any T")?);
            (self.length, self.spindle) = (false, false);
        }
        if let Some(length) = block.length {
            if self.transformation {
                return Err("the tool length changes with the transformation on".to_owned());
            }
            self.length = length;
        }
        self.speed = block.speed.unwrap_or(self.speed);
        self.spindle = block.spindle.unwrap_or(self.spindle);
        self.feed = block.feed.or(self.feed);
        self.offset = block.offset.unwrap_or(self.offset);
        self.smoothing = block.smoothing.unwrap_or(self.smoothing);
        self.rapid = block.motion.or(self.rapid);
        Ok(())
    }

    /// Transformation on or off.
    fn switch(&mut self, block: &Block) -> Result<(), String> {
        match block.transformation {
            None => {}
            Some(_) if block.has_axis_words() => return Err("the transformation is switched in a move".to_owned()),
            Some(true) => {
                if self.transformation {
                    return Err("the transformation is switched on twice".to_owned());
                }
                if !self.retracted {
                    return Err("the transformation is switched on before the tool is at Z0 of the machine".to_owned());
                }
                let [a, c] = self.parked.ok_or("the transformation is switched on before A and C have a position")?;
                self.transformation = true;
                (self.axes_linear, self.part_vectors) = (false, false);
                self.start = Some((a, c));
                self.tip = [None; 3];
                self.direction = Some(Direction::Rotary(a, c));
            }
            Some(false) => {
                if self.transformation {
                    self.retracted = false;
                }
                self.transformation = false;
                self.parked = None;
            }
        }
        if block.axes_linear {
            if !self.transformation {
                return Err("ORIAXES before TRAORI".to_owned());
            }
            self.axes_linear = true;
        }
        self.part_vectors |= block.part_vectors;
        Ok(())
    }

    fn moved(&mut self, block: &Block, line: usize) -> Result<(), String> {
        if block.machine_frame {
            let home = block.tip == [None, None, Some(0.0)] && block.rotary == [None; 2] && block.vector == [None; 3];
            if self.transformation {
                return Err("a move in the machine frame with the transformation on".to_owned());
            }
            if !home || self.rapid != Some(true) {
                return Err("in the machine frame only the rapid to Z0 is understood".to_owned());
            }
            self.retracted = true;
            return Ok(());
        }
        if !block.has_axis_words() {
            return Ok(());
        }
        if !self.transformation {
            return self.park(block);
        }
        let direction = self.direction(block)?;
        for (k, word) in block.tip.iter().enumerate() {
            self.tip[k] = word.or(self.tip[k]);
        }
        let [Some(x), Some(y), Some(z)] = self.tip else {
            return Err("the first move after the transformation is on needs X Y Z".to_owned());
        };
        let tool = self.ready_to_move()?;
        let rapid = self.rapid.ok_or("a move before any G0 or G1")?;
        let feed = if rapid { None } else { Some(self.feed.ok_or("G1 without a feed")?) };
        if !(rapid || self.spindle && self.speed > 0.0) {
            return Err("a move at feed with the spindle at rest".to_owned());
        }
        let smoothing = match self.smoothing {
            Some(smoothing) => smoothing,
            None if rapid => 0.0,
            None => {
                return Err(
                    "a move at feed before CYCLE832 or G64 P says how far the control may leave the path".into()
                );
            }
        };
        if self.moves.len() >= MOST_MOVES {
            return Err(format!("more than {MOST_MOVES} moves; split the program by operations"));
        }
        self.direction = Some(direction);
        self.retracted = false;
        self.moves.push(NcMove {
            line,
            rapid,
            tip: Point3::new(x, y, z),
            direction,
            start: self.start.take(),
            feed,
            tool,
            speed: self.speed,
            smoothing,
        });
        Ok(())
    }

    /// Rotary positions with the transformation off.
    fn park(&mut self, block: &Block) -> Result<(), String> {
        if block.tip != [None; 3] || block.vector != [None; 3] {
            return Err("a move of the tool with the transformation off".to_owned());
        }
        if !self.retracted || self.rapid != Some(true) {
            return Err(
                "A and C turn with the transformation off, but not at rapid with the tool at Z0 of the machine"
                    .to_owned(),
            );
        }
        let [a, c] = block.rotary;
        let before = self.parked;
        match (a.or(before.map(|p| p[0])), c.or(before.map(|p| p[1]))) {
            (Some(a), Some(c)) => self.parked = Some([a, c]),
            _ => return Err("A and C must both be said before the transformation is switched on".to_owned()),
        }
        Ok(())
    }

    fn direction(&self, block: &Block) -> Result<Direction, String> {
        let before = self.direction.ok_or("no direction of the tool is known")?;
        match (block.vector, block.rotary) {
            ([None, None, None], [None, None]) => Ok(before),
            ([Some(x), Some(y), Some(z)], [None, None]) => {
                if !self.axes_linear {
                    return Err("a direction vector without ORIAXES: how the axis turns is not known".to_owned());
                }
                if !self.part_vectors {
                    return Err("a direction vector without ORIWKS: in which frame it lies is not known".to_owned());
                }
                let axis = Vector3::new(x, y, z);
                Ok(Direction::Axis(axis.try_normalize(1e-6).ok_or("a direction vector of length 0")?))
            }
            ([None, None, None], [a, c]) => match (a, c, before) {
                (Some(a), Some(c), _) => Ok(Direction::Rotary(a, c)),
                (a, c, Direction::Rotary(a0, c0)) => Ok(Direction::Rotary(a.unwrap_or(a0), c.unwrap_or(c0))),
                _ => Err("only one of A and C after a direction vector".to_owned()),
            },
            _ => Err("an incomplete direction: A3 B3 C3 must stand together, and not beside A C".to_owned()),
        }
    }

    /// The tool, when all that a move needs was said.
    fn ready_to_move(&self) -> Result<Arc<str>, String> {
        for (said, what) in self.modes.iter().zip(["lengths in mm", "absolute coordinates", "feed a minute"]) {
            if !said {
                return Err(format!("a move before the text asks for {what}"));
            }
        }
        if !self.offset {
            return Err("a move without the work offset G54".to_owned());
        }
        if !self.length {
            return Err("a move without the length of the tool".to_owned());
        }
        self.tool.clone().ok_or_else(|| "a move without a tool".to_owned())
    }
}

/// Runs a text line by line through a dialect's `block`, which makes a [`Block`] of a line, or none of an empty one.
///
/// # Errors
/// The faults, in order, at most [`MOST_FAULTS`].
pub(super) fn read(
    text: &str,
    end: &str,
    mut block: impl FnMut(&str, &State) -> Result<Option<Block>, Fault>,
) -> Result<Vec<NcMove>, Vec<ReadError>> {
    let mut state = State::default();
    let mut faults: Vec<ReadError> = Vec::new();
    let mut last = 0;
    for (i, line) in text.lines().enumerate() {
        last = i + 1;
        let known = faults.is_empty();
        let outcome = match control_character(line) {
            Some(fault) => Err(fault),
            None => block(line, &state),
        };
        let outcome = outcome.and_then(|b| match b {
            Some(_) if state.ended => Err(Fault::State("text after the end of the program".to_owned())),
            Some(b) if known => state.run(&b, last).map_err(Fault::State),
            _ => Ok(()),
        });
        match outcome {
            Ok(()) => {}
            Err(Fault::State(_)) if !known => {}
            Err(Fault::State(reason) | Fault::Words(reason)) => faults.push(ReadError { line: last, reason }),
        }
        if faults.len() >= MOST_FAULTS {
            return Err(faults);
        }
    }
    if faults.is_empty() && !state.ended {
        faults.push(ReadError { line: last.max(1), reason: format!("the text ends here, without {end}") });
    }
    if faults.is_empty() { Ok(state.moves) } else { Err(faults) }
}

fn control_character(line: &str) -> Option<Fault> {
    let found = line.chars().find(|c| c.is_control() && *c != '\t')?;
    Some(Fault::Words(format!("the control character U+{:04X}", u32::from(found))))
}
