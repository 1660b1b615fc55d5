//! The state of a control while it executes a program: the changes of each block, and its faults.

mod modes;
mod moves;
mod program;
mod spindle;
mod splines;
mod switching;

pub(crate) use program::ProgramState;

use super::{Act, Control, LengthWord, MAX_FAULTS, MotionWord, NcBlock, Smoothing, WORD_ROUNDING_MM, figure, has_byte};
use crate::control::flow::{Flow, MAX_EXECUTED, Step};
use crate::control::modal::{ModalGroup, Setting};
use crate::nc::{Direction, NcTool, ReadResult};
use five_axis::{Angles, Machine};
use nalgebra::Vector3;
use std::sync::Arc;

/// Tool centre point control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Transformation {
    Unknown,
    Off,
    On,
}

/// Position of an axis with the transformation off; for X Y Z the gauge line in the machine frame.
#[derive(Clone, Copy, Debug, PartialEq)]
enum AxisPosition {
    /// Not known: where an earlier program left the axis.
    Unknown,
    /// Not known: where the transformation left the axis.
    Left,
    /// mm or radians.
    At(f64),
}

impl AxisPosition {
    fn known(self) -> Option<f64> {
        if let Self::At(x) = self { Some(x) } else { None }
    }
}

/// Tool length that acts.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Length {
    Unknown,
    Off,
    Of(NcTool, usize),
}

/// State of the control. At its start everything is unknown.
struct ControlState<'a> {
    control: &'a Control,
    machine: &'a Machine,
    program: ProgramState,
    offset: Setting<Arc<str>>,
    /// The work offset that holds the part origin.
    part_offset: &'a str,
    /// A block was not understood since the transformation was switched: it may be what switches it.
    doubtful: bool,
    transformation: Transformation,
    axes: [AxisPosition; 5],
    /// Line that last moved an axis with the transformation off.
    placed: usize,
    tip: [Option<f64>; 3],
    direction: Direction,
    /// Positions of the rotary axes with the transformation on, radians, on a machine with an axis modulo 360 deg: only words
    /// of such an axis count from where it stands.
    rotary: Angles,
    /// Second point of the tool axis, where a block has stated it, part frame, mm.
    second: Option<Vector3<f64>>,
    motion: Option<MotionWord>,
    ready: Option<NcTool>,
    length: Length,
    /// Whether rotary axes are clamped; `None` where no block says so.
    clamped: [Option<bool>; 2],
    /// A section has begun, and its retract is still missing.
    open: bool,
    /// The transformation is on, and no block but turns of tables has moved an axis since.
    at_start: bool,
    /// Position of the tip while tables turn at the start, machine frame, mm.
    turned: Option<Vector3<f64>>,
    /// Turn of the work frame about Z, radians.
    frame_turn: f64,
}

/// What a text is read for.
#[derive(Clone, Copy)]
pub(crate) struct Setup<'a> {
    pub(crate) control: &'a Control,
    pub(crate) machine: &'a Machine,
    /// The work offset that holds the part origin.
    pub(crate) part_offset: &'a str,
}

impl<'a> ControlState<'a> {
    fn new(Setup { control, machine, part_offset }: Setup<'a>) -> Self {
        Self {
            control,
            machine,
            program: ProgramState::new(),
            offset: Setting::Unknown,
            part_offset,
            doubtful: false,
            transformation: Transformation::Unknown,
            axes: [AxisPosition::Unknown; 5],
            placed: 0,
            tip: [None; 3],
            direction: Direction::Rotary([0.0; 2]),
            rotary: [0.0; 2],
            second: None,
            motion: None,
            ready: None,
            length: Length::Unknown,
            clamped: [None; 2],
            open: false,
            at_start: false,
            turned: None,
            frame_turn: 0.0,
        }
    }

    fn fault(&mut self, reason: impl Into<String>) {
        self.program.fault(reason);
    }

    fn independent_fault(&mut self, reason: impl Into<String>) {
        self.program.independent_fault(reason);
    }

    fn fault_once(&mut self, about: &'static str, reason: impl Into<String>) {
        self.program.fault_once(about, reason);
    }

    fn retract_words(&self) -> String {
        let Control { machine_frame, behind, .. } = self.control;
        format!("`{machine_frame} Z{}{behind}`", figure(self.machine.retract))
    }

    /// Whether the tool is at the retract height or above.
    fn is_retracted(&self) -> bool {
        self.axes[2].known().is_some_and(|z| z >= self.machine.retract - WORD_ROUNDING_MM)
    }

    /// Executes one block. A move is executed also with a faulty state; the result then does not hold it.
    fn run(&mut self, block: &NcBlock) {
        if self.program.ended {
            return self.fault_once("ended", "text after the end of the program");
        }
        if block.only_moves() {
            // Of all that acts in an order, the feed does so before the move.
            self.program.feed = block.feed.or(self.program.feed);
            return self.moved(block);
        }
        if let Some(word) = block.outside {
            self.judge_outside(word);
        }
        self.clamp(block);
        for act in self.control.order {
            match act {
                Act::Set(group) => self.set(*group, block),
                Act::TurnFrame => {
                    if let Some(turn) = block.frame_turn {
                        self.turn_frame(turn);
                    }
                }
                Act::Feed => self.program.feed = block.feed.or(self.program.feed),
                Act::Speed => self.set_speed(block),
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
                Act::Smooth => self.program.smoothing = block.smoothing.or(self.program.smoothing),
                Act::Wait => {
                    if let Some(word) = block.wait {
                        self.wait(word);
                    }
                }
                Act::Move => {
                    self.moved(block);
                    self.set_stops(block);
                }
                Act::End => {
                    if let Some(word) = block.end {
                        self.end(word);
                    }
                }
                Act::Change => {}
            }
        }
    }

    /// Reports a word that the control takes only with the transformation off.
    fn judge_outside(&mut self, word: &str) {
        self.may_be_off();
        let [_, off] = self.control.transformation;
        match self.transformation {
            Transformation::Off => {}
            Transformation::On => {
                self.fault(format!("`{word}` with the transformation on: write {off} before this block"));
            }
            Transformation::Unknown => self.fault(format!(
                "`{word}` while the transformation may still be on from another program: write {off} alone in a block \
                 before"
            )),
        }
    }

    /// Turns the work frame to an angle about Z, radians.
    fn turn_frame(&mut self, turn: f64) {
        if turn != 0.0 && self.transformation != Transformation::On {
            let [on, _] = self.control.transformation;
            self.fault(format!(
                "the work frame is turned with the transformation off: turn it behind {on}, and back before the transformation ends"
            ));
            return;
        }
        if turn != self.frame_turn {
            // The control counts the place of the tool in the new frame.
            self.tip = [None; 3];
        }
        self.frame_turn = turn;
    }

    fn wait(&mut self, word: &str) {
        self.may_be_off();
        if self.transformation == Transformation::On || self.open {
            return self.fault(format!(
                "`{word}` makes the program wait with the tool in the part: wait with the tool retracted, before {}",
                self.control.transformation[0]
            ));
        }
        if self.control.wait_switches_off {
            for group in [ModalGroup::Spindle, ModalGroup::Coolant] {
                self.program.forget(group);
            }
        }
    }

    fn set(&mut self, group: ModalGroup, block: &NcBlock) {
        if group == ModalGroup::WorkOffset {
            if let Some(offset) = &block.offset {
                self.set_offset(Setting::Said(offset.clone(), self.program.line));
            }
            return;
        }
        let Some(word) = block.modal.get(group) else { return };
        if !self.acts_behind(word) {
            self.set_to(group, word);
        }
    }

    fn set_to(&mut self, group: ModalGroup, word: &'static str) {
        if group == ModalGroup::Spindle && self.stops_in_part(word) {
            return;
        }
        // No manual of Fanuc that the project knows has it under tool centre point control. Other dialects turn sectors there.
        if word == "G69" && self.transformation == Transformation::On {
            let [_, off] = self.control.transformation;
            self.fault(format!("`{word}` with the transformation on: write {off} before this block"));
            return;
        }
        let before = self.program.setting(group);
        // A control forgets the feed when the feed mode changes.
        if group == ModalGroup::FeedMode
            && before != Setting::Unknown
            && (self.control.feed_mode_drops_feed || !matches!(before, Setting::Said(w, _) if w == word))
        {
            self.program.feed = None;
        }
        self.program.say(group, word);
    }

    /// The work offset from here on.
    fn set_offset(&mut self, offset: Setting<Arc<str>>) {
        self.offset = offset;
        self.program.judged = 0;
    }

    fn change(&mut self) {
        self.may_be_off();
        if !self.is_retracted() || self.transformation == Transformation::On {
            self.fault(format!(
                "a tool change before the tool is at the retract height: write {} before this block",
                self.retract_words()
            ));
        }
        if self.ready.is_none() {
            self.fault("a tool change before any T: the next tool is unknown");
        }
        self.program.tool = self.ready.clone().or(Some(NcTool::Number(0)));
        if self.control.change_drops_length {
            self.length = Length::Unknown;
        }
        if self.control.change_sets_length {
            self.set_length(&LengthWord::OfSpindle);
        }
        // A tool change stops the spindle.
        self.program.forget(ModalGroup::Spindle);
    }

    fn set_length(&mut self, word: &LengthWord) {
        self.may_be_off();
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
                // Continue as the block intended.
                self.transformation = Transformation::Off;
            }
            Transformation::Off => {}
        }
        self.length = match word {
            LengthWord::Off => Length::Off,
            LengthWord::OfSpindle => match self.program.tool.clone() {
                Some(tool) => Length::Of(tool, self.program.line),
                None => {
                    self.fault(format!(
                        "the tool length before a tool change: the tool in the spindle is unknown \
                                        before {on}"
                    ));
                    Length::Unknown
                }
            },
            LengthWord::Of(number) => Length::Of(self.own_length(*number), self.program.line),
        };
    }

    /// The tool whose length acts after a word with the number of another one, which is reported.
    fn own_length(&mut self, number: u32) -> NcTool {
        let (given, length) = (NcTool::Number(number), self.control.length);
        match self.program.tool.clone().filter(|tool| *tool != given) {
            None => given,
            Some(tool) => {
                self.fault(format!(
                    "tool {tool} is in the spindle with the length of another tool, {given}: write `{length}`"
                ));
                tool
            }
        }
    }

    /// Clamps and unclamps rotary axes.
    fn clamp(&mut self, block: &NcBlock) {
        for (k, word) in block.clamps.into_iter().enumerate() {
            if word.is_some() {
                if block.has_axis_words() {
                    self.fault(
                        "a word that clamps or unclamps an axis in a block with a move: write it alone in its block",
                    );
                }
                self.clamped[k] = word;
            }
        }
    }

    /// Checks the state at the end of the program.
    fn end(&mut self, word: &str) {
        let [_, off] = self.control.transformation;
        if self.frame_turn != 0.0 {
            self.fault(format!("the program ends with the work frame turned: {}", self.control.unturned));
        }
        match self.transformation {
            _ if self.doubtful => {}
            Transformation::On => self.fault(format!(
                "the program ends with the transformation on: write {off}, then {}",
                self.retract_words()
            )),
            Transformation::Unknown => {
                self.fault(format!("the program ends, and no block has switched the transformation: write {off}"));
            }
            Transformation::Off if self.open => self.fault(format!(
                "the program ends with the tool in the part: write {} after {off}",
                self.retract_words()
            )),
            Transformation::Off => {}
        }
        if !(self.control.end_switches_off && word.starts_with('M')) {
            for (group, due, what) in
                [(ModalGroup::Spindle, "M5", "the spindle"), (ModalGroup::Coolant, "M9", "the coolant")]
            {
                if let Setting::Said(word, line) = self.program.setting(group)
                    && word != due
                {
                    self.fault(format!(
                        "the program ends with {what} on, by {word} in line {line}: write {due} before"
                    ));
                }
            }
        }
        self.program.ended = true;
    }
}

/// A line that is executed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line<'a> {
    /// Text.
    pub(crate) text: &'a str,
    /// Number, from 1.
    pub(crate) number: usize,
    /// Values of the parameters 1, 2 ... of the subprogram.
    pub(crate) arguments: &'a [f64],
}

/// Executes a text line by line. The `block` of a dialect makes a [`NcBlock`] of a line, or `None` of an empty line. It
/// adds whatever it does not understand to the list that it receives.
///
/// # Errors
/// The faults, in order, at most [`MAX_FAULTS`].
pub(crate) fn read(
    text: &str,
    setup: Setup<'_>,
    mut block: impl FnMut(&str, usize, &mut Vec<String>) -> Option<NcBlock>,
) -> ReadResult {
    read_in_order(text, setup, &Flow::default(), |line, reasons| block(line.text, line.number, reasons))
}

/// As [`read`], in the order of the calls of the text.
///
/// # Errors
/// As [`read`].
pub(crate) fn read_in_order(
    text: &str,
    setup: Setup<'_>,
    flow: &Flow,
    mut block: impl FnMut(Line<'_>, &mut Vec<String>) -> Option<NcBlock>,
) -> ReadResult {
    let lines: Vec<&str> = text.strip_suffix('\n').unwrap_or(text).split('\n').collect();
    let mut state = ControlState::new(setup);
    let mut executed = 0_usize;
    let mut at = 0;
    while at < lines.len() {
        let step = flow.0.get(&at);
        state.line_of(lines[at], at, &[], step, &mut block);
        executed += 1;
        at += 1;
        match step {
            Some(Step::SkipTo(next)) => at = at.max(*next),
            Some(Step::Call { lines: called, times, arguments }) if !state.program.is_full() => {
                state.program.call = Some(at);
                executed = executed.saturating_add(called.len().saturating_mul(*times as usize));
                if executed > MAX_EXECUTED {
                    state.fault(format!(
                        "more than {MAX_EXECUTED} lines are executed; divide the program by operations"
                    ));
                    return Err(state.program.faults);
                }
                for line in (0..*times).flat_map(|_| called.clone()) {
                    state.line_of(lines[line], line, arguments, flow.0.get(&line), &mut block);
                    if state.program.is_full() {
                        break;
                    }
                }
                state.program.call = None;
            }
            _ => {}
        }
        if state.program.is_full() {
            return Err(state.program.faults);
        }
    }
    state.program.finished(lines.len(), setup.control.end)
}

impl ControlState<'_> {
    /// Executes a line; `at` counts from 0.
    fn line_of(
        &mut self,
        line: &str,
        at: usize,
        arguments: &[f64],
        step: Option<&Step>,
        block: &mut impl FnMut(Line<'_>, &mut Vec<String>) -> Option<NcBlock>,
    ) {
        self.program.begin_line(at + 1);
        let mut reasons = Vec::new();
        let found = match (control_character(line.strip_suffix('\r').unwrap_or(line)), step) {
            (Some(reason), _) => {
                reasons.push(reason);
                None
            }
            (None, Some(step)) => {
                if let Step::Fault(reason) = step {
                    reasons.push(reason.clone());
                } else if self.program.ended {
                    reasons.push("text after the end of the program".to_owned());
                }
                None
            }
            (None, None) => block(Line { text: line, number: at + 1, arguments }, &mut reasons),
        };
        self.program.understood = reasons.is_empty();
        self.doubtful |= !self.program.understood;
        if let Some(first) = reasons.into_iter().next() {
            self.fault(first);
        }
        if let Some(block) = found {
            self.run(&block);
        }
    }
}

pub(crate) fn control_character(line: &str) -> Option<String> {
    // U+0080 to U+009F begin with the byte C2.
    if !has_byte(line, |byte| byte < b' ' || byte == 0x7f || byte == 0xc2) {
        return None;
    }
    let found = line.chars().find(|c| c.is_control() && *c != '\t')?;
    Some(format!("the control character U+{:04X}", u32::from(found)))
}
