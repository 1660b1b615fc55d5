//! A control as a state machine: what the readers of all dialects stand on. Shares nothing with the writers.
//!
//! Nothing is taken for granted at the start: modal groups, tool, tool length, offsets, transformation and the positions
//! of all axes are unknown until the program says them. A move on what is unknown or wrong is a fault that says what to
//! write. After a fault the state goes on as the block meant it, so that a text with many faults says them all in one
//! run. A dialect gives its [`Control`] as data and makes a [`Block`] of each line.

use super::modal::{GROUPS, Group, Modal, Needed, Setting};
use super::{Direction, NcMove, NcSection, NcTool, ReadError, Station};
use crate::kin::Machine;
use nalgebra::{Point3, Vector3};
use std::sync::Arc;

/// Most faults of one text that are told.
pub const MOST_FAULTS: usize = 50;

/// Most moves of one text: beyond them the memory of the checks that follow would have no bound.
const MOST_MOVES: usize = 4_000_000;

/// Longest number, in characters.
const LONGEST_NUMBER: usize = 24;

/// Farthest coordinate, mm: beyond any machine.
const FARTHEST: f64 = 1e5;

/// Largest feed (mm/min), spindle speed (rpm) and share of a block in a minute.
const FASTEST: f64 = 1e6;

/// Rounding of positions in words: mm, and radians (a step of a rotary word is 1e-5 deg).
const ROUNDING: (f64, f64) = (1e-4, 1e-7);

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
    let plain =
        |c: char| if c.is_ascii_graphic() || c == ' ' { c.to_string() } else { format!("<U+{:04X}>", u32::from(c)) };
    text.chars().take(most).map(plain).collect()
}

/// A figure in a message: no more decimals than it has.
fn figure(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A dialect as data.
pub(super) struct Control {
    /// Its modal groups.
    pub(super) modal: &'static [Modal],
    /// In which order the words of a block act.
    pub(super) order: &'static [Act],
    /// Words that switch tool centre point control on and off.
    pub(super) transformation: [&'static str; 2],
    /// The words of a rapid in the machine frame, with offsets and tool length out, in front of the axis words.
    pub(super) machine_frame: &'static str,
    /// What stands behind them.
    pub(super) behind: &'static str,
    /// The word that takes the tool length of the tool in the spindle.
    pub(super) length: &'static str,
    /// The word that gives the tolerance of smoothing.
    pub(super) smoothing: &'static str,
    /// The word that ends a program.
    pub(super) end: &'static str,
    /// Moves in the machine frame leave the tool length out by themselves.
    pub(super) machine_frame_drops_length: bool,
    /// Switching the transformation drops the work offset and shifts and rotations of it.
    pub(super) switching_drops_frames: bool,
    /// A tool change makes the tool length that of a default.
    pub(super) change_drops_length: bool,
    /// The end of a program switches spindle and coolant off.
    pub(super) end_switches_off: bool,
}

/// What words of a block do, each at its place in the order of the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Act {
    /// A modal group is set.
    Set(Group),
    /// F.
    Feed,
    /// S.
    Speed,
    /// T.
    Select,
    /// M6.
    Change,
    /// The transformation is switched.
    Transform,
    /// The tool length is taken or dropped.
    Length,
    /// The tolerance of smoothing is set.
    Smooth,
    /// A dwell or a stop.
    Wait,
    /// Axes move.
    Move,
    /// The program ends.
    End,
}

/// Modal motion word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    /// G0.
    Rapid,
    /// G1.
    Feed,
    /// None: axis words need a motion word of their own.
    Cancelled,
}

/// Whose length acts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum LengthWord {
    /// None.
    Off,
    /// That of the tool in the spindle.
    OfSpindle,
    /// That of a number in the tool table.
    Of(u32),
}

/// How far the control may leave the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Smoothing {
    /// By so much, mm.
    Within(f64),
    /// As it likes, by this word.
    Left(&'static str),
}

/// What the words of one block say. Angles in radians, ISO sense.
#[derive(Default)]
pub(super) struct Block {
    /// Motion word.
    pub(super) motion: Option<Motion>,
    /// Coordinates are those of the machine, with all offsets out.
    pub(super) machine_frame: bool,
    /// X Y Z, mm.
    pub(super) tip: [Option<f64>; 3],
    /// Tool direction.
    pub(super) vector: [Option<f64>; 3],
    /// A and C.
    pub(super) rotary: [Option<f64>; 2],
    /// F.
    pub(super) feed: Option<f64>,
    /// rpm.
    pub(super) speed: Option<f64>,
    /// Tool that is made ready.
    pub(super) tool: Option<NcTool>,
    /// The tool that is ready comes into the spindle.
    pub(super) change: bool,
    /// Words of modal groups.
    pub(super) modal: [Option<&'static str>; GROUPS],
    /// Tool centre point control on or off.
    pub(super) transformation: Option<bool>,
    /// Tool length.
    pub(super) length: Option<LengthWord>,
    /// Tolerance of path smoothing.
    pub(super) smoothing: Option<Smoothing>,
    /// A word that makes the program wait.
    pub(super) wait: Option<&'static str>,
    /// The program ends, with this word.
    pub(super) end: Option<&'static str>,
}

/// Stores what may stand once in a block.
pub(super) fn once<T>(slot: &mut Option<T>, address: &str, value: T) -> Result<(), String> {
    if slot.replace(value).is_some() { Err(format!("`{address}` stands twice in one block")) } else { Ok(()) }
}

fn store(slot: &mut Option<f64>, address: &str, value: f64, limit: f64) -> Result<(), String> {
    if value.abs() > limit {
        return Err(format!("{address} = {value} is out of range: at most {limit:.0}"));
    }
    once(slot, address, value)
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

    /// A or C, in degrees of the word. A word beyond the travel of the axis is refused here: nothing is measured on it.
    pub(super) fn angle(&mut self, axis: usize, degrees: f64, machine: &Machine) -> Result<(), String> {
        let (name, limits) = [("A", &machine.tilt), ("C", &machine.turn)][axis];
        let angle = degrees.to_radians() * limits.word_sign;
        once(&mut self.rotary[axis], name, angle)?;
        if angle < limits.min - ROUNDING.1 || angle > limits.max + ROUNDING.1 {
            let mut travel = [limits.min, limits.max].map(|x| x.to_degrees() * limits.word_sign);
            travel.sort_by(f64::total_cmp);
            return Err(format!(
                "{name} = {degrees} deg is out of range: the travel of the axis is {} to {} deg",
                figure(travel[0]),
                figure(travel[1])
            ));
        }
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

    /// A word of a modal group, when it is one.
    pub(super) fn modal_word(&mut self, control: &Control, text: &str) -> Option<Result<(), String>> {
        let (modal, word) = control.modal.iter().find_map(|m| Some((m, m.word(text)?)))?;
        let slot = &mut self.modal[modal.group as usize];
        Some(match slot.replace(word) {
            Some(before) => Err(format!("`{before}` and `{word}` in one block both set {}", modal.what)),
            None => Ok(()),
        })
    }

    pub(super) fn has_axis_words(&self) -> bool {
        self.tip.iter().chain(&self.vector).chain(&self.rotary).any(Option::is_some)
    }
}

/// Tool centre point control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Transformation {
    Unknown,
    Off,
    On,
}

/// Position of an axis with the transformation off: of the gauge line in the machine frame for X Y Z.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    /// Wherever the program before left it.
    Unknown,
    /// Where the transformation left it.
    Left,
    /// mm or radians.
    At(f64),
}

impl Place {
    fn known(self) -> Option<f64> {
        if let Self::At(x) = self { Some(x) } else { None }
    }
}

/// Whose length acts.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Length {
    Unknown,
    Off,
    Of(NcTool, usize),
}

const AXES: [&str; 5] = ["X", "Y", "Z", "A", "C"];

/// State of the control. Nothing is taken for granted at its start.
struct State<'a> {
    control: &'a Control,
    machine: &'a Machine,
    line: usize,
    modal: [Setting; GROUPS],
    transformation: Transformation,
    axes: [Place; 5],
    /// Line that last moved an axis with the transformation off.
    placed: usize,
    tip: [Option<f64>; 3],
    direction: Direction,
    motion: Option<Motion>,
    feed: Option<f64>,
    ready: Option<NcTool>,
    tool: Option<NcTool>,
    length: Length,
    speed: Option<f64>,
    smoothing: Option<Smoothing>,
    /// The section under way was left without a retract so far.
    open: bool,
    ended: bool,
    sections: Vec<NcSection>,
    moves: usize,
    faults: Vec<ReadError>,
    /// The block has a fault already: what follows from it is not told.
    quiet: bool,
    /// What was told once and would be told for every block.
    told: Vec<&'static str>,
}

impl<'a> State<'a> {
    fn new(control: &'a Control, machine: &'a Machine) -> Self {
        Self {
            control,
            machine,
            line: 0,
            modal: [Setting::Unknown; GROUPS],
            transformation: Transformation::Unknown,
            axes: [Place::Unknown; 5],
            placed: 0,
            tip: [None; 3],
            direction: Direction::Rotary(0.0, 0.0),
            motion: None,
            feed: None,
            ready: None,
            tool: None,
            length: Length::Unknown,
            speed: None,
            smoothing: None,
            open: false,
            ended: false,
            sections: Vec::new(),
            moves: 0,
            faults: Vec::new(),
            quiet: false,
            told: Vec::new(),
        }
    }

    /// Tells a fault of this block; the first one only.
    fn fault(&mut self, reason: impl Into<String>) {
        if !self.quiet && self.faults.len() < MOST_FAULTS {
            self.faults.push(ReadError { line: self.line, reason: reason.into() });
        }
        self.quiet = true;
    }

    /// Tells a fault that would stand in every block from here on, once.
    fn fault_once(&mut self, about: &'static str, reason: impl Into<String>) {
        if self.told.contains(&about) {
            return;
        }
        if !self.quiet {
            self.told.push(about);
        }
        self.fault(reason);
    }

    fn retract_words(&self) -> String {
        let Control { machine_frame, behind, .. } = self.control;
        format!("`{machine_frame} Z{}{behind}`", figure(self.machine.retract))
    }

    /// Whether the tool stands at the retract height or above.
    fn is_retracted(&self) -> bool {
        self.axes[2].known().is_some_and(|z| z >= self.machine.retract - ROUNDING.0)
    }

    /// Runs one block. A move runs on a state that may be faulty; then it is no move of the result.
    fn run(&mut self, block: &Block) {
        if self.ended {
            return self.fault_once("ended", "text after the end of the program");
        }
        for act in self.control.order {
            match act {
                Act::Set(group) => self.set(*group, block),
                Act::Feed => self.feed = block.feed.or(self.feed),
                Act::Speed => self.speed = block.speed.or(self.speed),
                Act::Select => {
                    if let Some(tool) = &block.tool {
                        self.ready = Some(tool.clone());
                    }
                }
                Act::Change if block.change => self.change(),
                Act::Transform => {
                    if let Some(on) = block.transformation {
                        self.switch(on, block);
                    }
                }
                Act::Length => {
                    if let Some(word) = &block.length {
                        self.set_length(word);
                    }
                }
                Act::Smooth => self.smoothing = block.smoothing.or(self.smoothing),
                Act::Wait => {
                    if let Some(word) = block.wait.filter(|_| self.transformation == Transformation::On) {
                        self.fault(format!(
                            "`{word}` makes the program wait with the tool in the part: wait with the tool retracted, \
                             before {}",
                            self.control.transformation[0]
                        ));
                    }
                }
                Act::Move => self.moved(block),
                Act::End => {
                    if let Some(word) = block.end {
                        self.end(word);
                    }
                }
                Act::Change => {}
            }
        }
    }

    fn set(&mut self, group: Group, block: &Block) {
        let Some(word) = block.modal[group as usize] else { return };
        let before = self.modal[group as usize];
        // A control forgets the feed with its unit.
        if group == Group::FeedMode && before != Setting::Unknown && !matches!(before, Setting::Said(w, _) if w == word)
        {
            self.feed = None;
        }
        self.modal[group as usize] = Setting::Said(word, self.line);
    }

    fn change(&mut self) {
        if !self.is_retracted() || self.transformation == Transformation::On {
            self.fault(format!(
                "a tool change before the tool is at the retract height: write {} before this block",
                self.retract_words()
            ));
        }
        if self.ready.is_none() {
            self.fault("M6 before any T: which tool comes into the spindle is not known");
        }
        self.tool = self.ready.clone().or(Some(NcTool::Number(0)));
        if self.control.change_drops_length {
            self.length = Length::Unknown;
        }
        // A change stops the spindle.
        self.modal[Group::Spindle as usize] = Setting::Unknown;
    }

    fn set_length(&mut self, word: &LengthWord) {
        let [on, off] = self.control.transformation;
        match self.transformation {
            Transformation::On => {
                self.fault(format!(
                    "the tool length changes with the transformation on: the axes jump; write {off} before"
                ));
            }
            Transformation::Unknown => {
                self.fault(format!(
                    "the tool length changes while the transformation may still be on from another program: the axes \
                     would jump; write {off} alone in a block before"
                ));
                // As the block meant it.
                self.transformation = Transformation::Off;
            }
            Transformation::Off => {}
        }
        self.length = match word {
            LengthWord::Off => Length::Off,
            LengthWord::OfSpindle => match self.tool.clone() {
                Some(tool) => Length::Of(tool, self.line),
                None => {
                    self.fault(format!(
                        "the tool length before a tool change: which tool is in the spindle is not known \
                                        before {on}"
                    ));
                    Length::Unknown
                }
            },
            LengthWord::Of(number) => Length::Of(NcTool::Number(*number), self.line),
        };
    }

    /// Transformation on or off.
    fn switch(&mut self, on: bool, block: &Block) {
        let [word, off] = self.control.transformation;
        if block.has_axis_words() {
            self.fault("the transformation is switched in a move: write the word alone in its block");
        }
        if self.control.switching_drops_frames {
            // The programmable frame is taken back, and so is the work offset.
            self.modal[Group::WorkOffset as usize] = Setting::Unknown;
            if let Some(shift) = self.control.modal.iter().find(|m| m.group == Group::Shift) {
                self.modal[Group::Shift as usize] = Setting::Said(shift.right[0], self.line);
            }
        }
        if !on {
            if self.transformation == Transformation::On {
                self.axes = [Place::Left; 5];
            }
            self.transformation = Transformation::Off;
            return;
        }
        match self.transformation {
            Transformation::On => self.fault(format!("the transformation is switched on twice: write {off} before")),
            Transformation::Unknown => self.fault(format!(
                "the transformation may still be on from another program: write {off} alone in a block at the start"
            )),
            Transformation::Off if !self.is_retracted() => self.fault(format!(
                "the transformation is switched on at an unknown height: write {} before, then A and C, then X and Y",
                self.retract_words()
            )),
            Transformation::Off => {}
        }
        if let Some(k) = (0..5).find(|k| self.axes[*k].known().is_none()) {
            let Control { machine_frame, behind, .. } = self.control;
            let axis = AXES[k];
            self.fault(format!(
                "the way to the first target depends on an unknown {axis}: move {axis} at the retract height before this \
                 block, `{machine_frame} {axis}...{behind}`"
            ));
        }
        let Length::Of(of, _) = &self.length else {
            self.fault(format!(
                "{word} without the length of the tool: write `{}` before this block",
                self.control.length
            ));
            return self.begin();
        };
        if self.tool.as_ref() != Some(of) {
            let tool = self.tool.as_ref().map_or("no known tool".to_owned(), |t| format!("tool {t}"));
            let reason = format!(
                "{tool} is in the spindle with the length of another tool, {of}: write `{}`",
                self.control.length
            );
            self.fault(reason);
        }
        self.begin();
    }

    /// A section begins where the axes stand.
    fn begin(&mut self) {
        let [x, y, z, a, c] = self.axes.map(|p| p.known().unwrap_or(0.0));
        self.transformation = Transformation::On;
        self.tip = [None; 3];
        self.direction = Direction::Rotary(a, c);
        if self.faults.is_empty() {
            let start = Station { line: self.placed, xyz: Vector3::new(x, y, z), a, c };
            self.sections.push(NcSection { start, moves: Vec::new(), retract: None });
        }
        self.open = true;
    }

    /// Judges the modal groups that a move needs.
    fn judge_modes(&mut self, transformed: bool, work_frame: bool, feed: bool) {
        for modal in self.control.modal {
            let needed = match modal.needed {
                Needed::Always => true,
                Needed::InWorkFrame => work_frame,
                Needed::Transformed => transformed,
                Needed::AtFeed => feed,
            };
            let setting = self.modal[modal.group as usize];
            if !needed || setting == Setting::Reported {
                continue;
            }
            let due = modal.right[0];
            let reason = match setting {
                Setting::Said(word, _) if modal.right.contains(&word) => continue,
                Setting::Said(word, line) => {
                    format!("a move with {word}, which line {line} sets: {}; write {due} before this block", modal.what)
                }
                _ => format!("no block before this move says {}: write {due}", modal.what),
            };
            let first = !self.quiet;
            self.fault(reason);
            if first {
                self.modal[modal.group as usize] = Setting::Reported;
            }
        }
    }

    fn moved(&mut self, block: &Block) {
        if self.transformation != Transformation::On {
            self.motion = block.motion.or(self.motion);
        }
        if !block.has_axis_words() {
            if block.machine_frame {
                self.fault("the machine frame is asked for without an axis word");
            }
            self.motion = block.motion.or(self.motion);
            return;
        }
        match self.transformation {
            Transformation::On => self.tip_move(block),
            Transformation::Off => self.axis_move(block),
            Transformation::Unknown => {
                let off = self.control.transformation[1];
                self.fault(format!(
                    "a move while the transformation may still be on from another program: write {off} alone in a block \
                     before"
                ));
                self.transformation = Transformation::Off;
                self.axis_move(block);
            }
        }
    }

    /// A move with the transformation off: only at rapid, in the machine frame, and sideways only at the retract height.
    fn axis_move(&mut self, block: &Block) {
        let Control { machine_frame, behind, .. } = self.control;
        if block.vector != [None; 3] {
            self.fault("a direction vector with the transformation off");
        }
        match self.motion {
            Some(Motion::Rapid) => {}
            Some(Motion::Feed) => {
                self.fault("a move at feed with the transformation off: here only rapids are understood, write G0");
            }
            _ => self.fault("a move before any G0: whether it is a rapid is not known"),
        }
        let linear = block.tip.iter().any(Option::is_some);
        if linear && !block.machine_frame {
            self.fault(format!(
                "X, Y or Z in the work frame with the transformation off: where the axes go depends on offsets; write \
                 `{machine_frame} ...{behind}`"
            ));
        }
        if linear && !self.control.machine_frame_drops_length && self.length != Length::Off {
            let length = match &self.length {
                Length::Of(..) => "the tool length still acts",
                _ => "whether a tool length acts is not known",
            };
            self.fault(format!("{machine_frame} without{behind}: {length}; write{behind} in this block"));
            self.length = Length::Off;
        }
        self.judge_modes(false, !block.machine_frame, false);
        let words = [block.tip[0], block.tip[1], block.tip[2], block.rotary[0], block.rotary[1]];
        let sideways = (0..5).find(|k| *k != 2 && words[*k].is_some());
        if let (Some(k), true) = (sideways, words[2].is_some()) {
            self.fault(format!(
                "{} and Z move together with the transformation off: the way is not known to be clear; write {} in a block \
                 before",
                AXES[k],
                self.retract_words()
            ));
        } else if let (Some(k), false) = (sideways, self.is_retracted()) {
            self.fault(format!(
                "{} moves with the transformation off at an unknown height: write {} before this block",
                AXES[k],
                self.retract_words()
            ));
        }
        self.within_travel(&words);
        let retract = self.machine.retract;
        if let Some(z) = words[2] {
            if z < retract - ROUNDING.0 {
                self.fault(format!(
                    "with the transformation off the tool goes to Z{} of the machine; the machine file says that tools are \
                     changed and axes move at Z{}: write {}",
                    figure(z),
                    figure(retract),
                    self.retract_words()
                ));
            }
            self.retracted(z.max(retract));
        }
        for (place, word) in self.axes.iter_mut().zip(words) {
            if let Some(x) = word {
                *place = Place::At(x);
            }
        }
        // As the block meant it.
        self.axes[2] = self.axes[2].known().map_or(Place::At(retract), |z| Place::At(z.max(retract)));
        self.placed = self.line;
    }

    fn within_travel(&mut self, words: &[Option<f64>; 5]) {
        for k in 0..3 {
            let axis = &self.machine.linear[k];
            let Some(x) = words[k] else { continue };
            if x < axis.min - ROUNDING.0 || x > axis.max + ROUNDING.0 {
                self.fault(format!(
                    "{} goes to {} in the machine frame; its travel is {} to {}",
                    AXES[k],
                    figure(x),
                    figure(axis.min),
                    figure(axis.max)
                ));
            }
        }
    }

    /// The tool goes up after a section.
    fn retracted(&mut self, z: f64) {
        if !std::mem::take(&mut self.open) {
            return;
        }
        if let Some(section) = self.sections.last_mut().filter(|_| self.faults.is_empty()) {
            if section.moves.is_empty() {
                self.sections.pop();
            } else {
                section.retract = Some((self.line, z));
            }
        }
    }

    /// A move of the tip.
    fn tip_move(&mut self, block: &Block) {
        let off = self.control.transformation[1];
        if block.machine_frame {
            self.fault(format!(
                "a move in the machine frame with the transformation on: write {off} before this block"
            ));
            // As the block meant it.
            self.switch(false, &Block::default());
            self.motion = block.motion.or(self.motion);
            return self.axis_move(block);
        }
        let direction = self.direction(block);
        self.motion = block.motion.or(self.motion);
        let before = self.tip;
        for (k, word) in block.tip.iter().enumerate() {
            self.tip[k] = word.or(self.tip[k]);
        }
        if let Some(k) = (0..3).find(|k| self.tip[*k].is_none()) {
            self.fault(format!(
                "the first move after {} needs X Y Z, since their values change there: {} is missing",
                self.control.transformation[0], AXES[k]
            ));
        }
        let [x, y, z] = self.tip.map(|x| x.unwrap_or(0.0));
        self.tip = [Some(x), Some(y), Some(z)];
        let tip = Point3::new(x, y, z);
        let rapid = match self.motion {
            Some(Motion::Feed) => false,
            Some(Motion::Rapid) => true,
            Some(Motion::Cancelled) | None => {
                self.fault("a move before any G0 or G1: write the word in this block");
                true
            }
        };
        self.judge_modes(true, true, !rapid);
        let feed = if rapid { None } else { self.feed_of(block, before, &tip) };
        if !rapid && !self.speed.is_some_and(|s| s > 0.0) {
            self.fault_once("speed", "a move at feed with the spindle at rest: no S before this block says its speed");
        }
        let smoothing = match self.smoothing {
            Some(Smoothing::Within(smoothing)) => smoothing,
            _ if rapid => 0.0,
            left => {
                let word = self.control.smoothing;
                let why = match left {
                    Some(Smoothing::Left(word)) => format!("with {word} the control leaves the path as it likes"),
                    _ => "how far the control may leave the path is not known".to_owned(),
                };
                self.fault_once(
                    "smoothing",
                    format!("a move at feed, and {why}: write {word} with a tolerance before"),
                );
                0.0
            }
        };
        if self.moves >= MOST_MOVES {
            self.fault_once("moves", format!("more than {MOST_MOVES} moves; split the program by operations"));
        }
        self.direction = direction;
        self.axes = [Place::Left; 5];
        let tool = self.tool.clone().unwrap_or(NcTool::Number(0));
        let (line, speed) = (self.line, self.speed.unwrap_or(0.0));
        if let Some(section) = self.sections.last_mut().filter(|_| self.faults.is_empty()) {
            section.moves.push(NcMove { line, rapid, tip, direction, feed, tool, speed, smoothing });
            self.moves += 1;
        }
    }

    /// Feed of a block in mm/min; in inverse time from its length.
    fn feed_of(&mut self, block: &Block, before: [Option<f64>; 3], tip: &Point3<f64>) -> Option<f64> {
        let inverse = matches!(self.modal[Group::FeedMode as usize], Setting::Said("G93", _));
        let Some(word) = (if inverse { block.feed } else { self.feed }) else {
            if inverse {
                self.fault("a move at feed in inverse time (G93) needs F in its own block");
            } else {
                self.fault("a move at feed without a feed: write F in this block");
                self.feed = Some(1.0);
            }
            return Some(1.0);
        };
        if !inverse {
            return Some(word);
        }
        let [Some(x), Some(y), Some(z)] = before else { return Some(word) };
        let feed = (tip - Point3::new(x, y, z)).norm() * word;
        // LinuxCNC takes no less: such a block would run in another time than it says.
        if feed < 0.1 {
            self.fault("in inverse time (G93) the tip moves at less than 0.1 mm/min: the control takes another time than F says");
        }
        Some(feed)
    }

    fn direction(&mut self, block: &Block) -> Direction {
        let before = self.direction;
        match (block.vector, block.rotary) {
            ([None, None, None], [None, None]) => before,
            ([Some(x), Some(y), Some(z)], [None, None]) => match Vector3::new(x, y, z).try_normalize(1e-6) {
                Some(axis) => Direction::Axis(axis),
                None => {
                    self.fault("a direction vector of length 0");
                    before
                }
            },
            ([None, None, None], [a, c]) => match (a, c, before) {
                (Some(a), Some(c), _) => Direction::Rotary(a, c),
                (a, c, Direction::Rotary(a0, c0)) => Direction::Rotary(a.unwrap_or(a0), c.unwrap_or(c0)),
                _ => {
                    self.fault("only one of A and C after a direction vector: write both");
                    before
                }
            },
            _ => {
                self.fault("an incomplete direction: A3= B3= C3= must stand together, and not beside A= C=");
                before
            }
        }
    }

    /// What the program leaves behind.
    fn end(&mut self, word: &str) {
        let [_, off] = self.control.transformation;
        match self.transformation {
            Transformation::On => self.fault(format!(
                "the program ends with the transformation on: write {off}, then {}",
                self.retract_words()
            )),
            Transformation::Unknown => {
                self.fault(format!(
                    "the program ends, and no block says whether the transformation is on: write {off}"
                ));
            }
            Transformation::Off if self.open => self.fault(format!(
                "the program ends with the tool in the part: write {} after {off}",
                self.retract_words()
            )),
            Transformation::Off => {}
        }
        if !(self.control.end_switches_off && word.starts_with('M')) {
            for (group, due, what) in [(Group::Spindle, "M5", "the spindle"), (Group::Coolant, "M9", "the coolant")] {
                if let Setting::Said(word, line) = self.modal[group as usize]
                    && word != due
                {
                    self.fault(format!(
                        "the program ends with {what} on, by {word} in line {line}: write {due} before"
                    ));
                }
            }
        }
        self.ended = true;
    }
}

/// Runs a text line by line through a dialect's `block`, which makes a [`Block`] of a line, or none of an empty one. What
/// it does not understand goes to the list that it is given.
///
/// # Errors
/// The faults, in order, at most [`MOST_FAULTS`].
pub(super) fn read(
    text: &str,
    control: &Control,
    machine: &Machine,
    mut block: impl FnMut(&str, usize, &mut Vec<String>) -> Option<Block>,
) -> Result<Vec<NcSection>, Vec<ReadError>> {
    let mut state = State::new(control, machine);
    let mut reasons = Vec::new();
    for (i, line) in text.strip_suffix('\n').unwrap_or(text).split('\n').enumerate() {
        state.line = i + 1;
        state.quiet = false;
        let found = match control_character(line.strip_suffix('\r').unwrap_or(line)) {
            Some(reason) => {
                reasons.push(reason);
                None
            }
            None => block(line, i + 1, &mut reasons),
        };
        if let Some(first) = reasons.drain(..).next() {
            state.fault(first);
        }
        if let Some(block) = found {
            state.run(&block);
        }
        if state.faults.len() >= MOST_FAULTS {
            return Err(state.faults);
        }
    }
    if !state.ended {
        state.quiet = false;
        state.fault(format!("the text ends here, without {}", control.end));
    }
    if state.faults.is_empty() { Ok(state.sections) } else { Err(state.faults) }
}

fn control_character(line: &str) -> Option<String> {
    let found = line.chars().find(|c| c.is_control() && *c != '\t')?;
    Some(format!("the control character U+{:04X}", u32::from(found)))
}

/// A tool by number or by name.
impl std::fmt::Display for NcTool {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Name(name) => write!(f, "\"{}\"", shown(name, 40)),
        }
    }
}

/// A name from a text.
pub(super) fn name(text: &str) -> NcTool {
    NcTool::Name(Arc::from(text))
}
