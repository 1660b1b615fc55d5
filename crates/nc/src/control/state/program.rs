//! What the readers of all dialects know of a program at a line of its text: settings, faults, and the moves so far. It knows no
//! machine and no words.

use super::{MAX_FAULTS, Smoothing};
use crate::control::modal::{GROUPS, ModalGroup, Setting};
use crate::nc::{Direction, ENDS_HERE, NcMove, NcRetract, NcSection, NcStation, NcTool, ReadError, ReadResult};
use crate::tool_shape::NcToolShape;
use five_axis::Interpolation;
use nalgebra::Point3;

/// Most moves of one text: it bounds the memory of the checks that follow.
const MAX_MOVES: usize = 4_000_000;

/// State of a program. At its start everything is unknown.
pub(crate) struct ProgramState {
    /// Line, from 1.
    pub(crate) line: usize,
    /// Line of the call that is executed.
    pub(crate) call: Option<usize>,
    /// Modal groups.
    modal: [Setting; GROUPS],
    /// Kinds of moves, a bit each, whose settings are judged and have not changed since: most moves need nothing more.
    pub(crate) judged: u8,
    /// Feed, mm/min.
    pub(crate) feed: Option<f64>,
    /// Spindle speed, rpm.
    pub(crate) speed: Option<f64>,
    /// Tool in the spindle.
    pub(crate) tool: Option<NcTool>,
    /// How far the control may leave the path.
    pub(crate) smoothing: Option<Smoothing>,
    /// The program has ended.
    pub(crate) ended: bool,
    /// Sections so far; their moves are those of the text as long as it has no fault.
    pub(crate) sections: Vec<NcSection>,
    moves: usize,
    /// Faults so far, at most [`MAX_FAULTS`].
    pub(crate) faults: Vec<ReadError>,
    /// The block has a fault already: faults that follow from it are not reported.
    pub(crate) quiet: bool,
    /// All words of the block were understood.
    pub(crate) understood: bool,
    /// Faults that are reported only once, since they would occur in every block.
    reported_once: Vec<&'static str>,
}

impl ProgramState {
    pub(crate) fn new() -> Self {
        Self {
            line: 0,
            call: None,
            modal: [Setting::Unknown; GROUPS],
            judged: 0,
            feed: None,
            speed: None,
            tool: None,
            smoothing: None,
            ended: false,
            sections: Vec::new(),
            moves: 0,
            faults: Vec::new(),
            quiet: false,
            understood: true,
            reported_once: Vec::new(),
        }
    }

    /// Setting of a modal group.
    pub(crate) fn setting(&self, group: ModalGroup) -> Setting {
        self.modal[group as usize]
    }

    /// Sets a modal group by a word of this line.
    pub(crate) fn say(&mut self, group: ModalGroup, word: &'static str) {
        self.set(group, Setting::Said(word, self.line));
    }

    /// A modal group counts as correct from here on: its fault is reported.
    pub(crate) fn reported(&mut self, group: ModalGroup) {
        self.set(group, Setting::Reported);
    }

    fn set(&mut self, group: ModalGroup, setting: Setting) {
        self.modal[group as usize] = setting;
        self.judged = 0;
    }

    /// From here on nobody knows how a modal group is set.
    pub(crate) fn forget(&mut self, group: ModalGroup) {
        self.set(group, Setting::Unknown);
    }

    /// Begins a line, from 1: it has no fault yet.
    pub(crate) fn begin_line(&mut self, line: usize) {
        (self.line, self.quiet, self.understood) = (line, false, true);
    }

    /// Reports a fault of this block unless the block has one already.
    pub(crate) fn fault(&mut self, reason: impl Into<String>) {
        // A line that is called again has the same faults.
        let known = self.call.is_some() && self.faults.iter().any(|f| f.line == self.line);
        if !self.quiet && !known && !self.is_full() {
            let mut reason = reason.into();
            if let Some(call) = self.call {
                reason.push_str(&format!(" (called in line {call})"));
            }
            self.faults.push(ReadError { line: self.line, reason });
        }
        self.quiet = true;
    }

    /// Reports a fault that does not follow from another fault of this block.
    pub(crate) fn independent_fault(&mut self, reason: impl Into<String>) {
        self.quiet = !self.understood;
        self.fault(reason);
    }

    /// Reports once a fault that would occur in every block from here on.
    pub(crate) fn fault_once(&mut self, about: &'static str, reason: impl Into<String>) {
        if self.reported_once.contains(&about) || !self.understood {
            return;
        }
        self.reported_once.push(about);
        self.independent_fault(reason);
    }

    /// Whether no more faults are reported.
    pub(crate) fn is_full(&self) -> bool {
        self.faults.len() >= MAX_FAULTS
    }

    /// Reports a text with more moves than can be checked.
    pub(crate) fn judge_count(&mut self) {
        if self.moves >= MAX_MOVES {
            self.fault_once("moves", format!("more than {MAX_MOVES} moves; divide the program by operations"));
        }
    }

    /// A straight move of this line, at rapid without a feed; the rotary axes turn evenly.
    pub(crate) fn straight(&self, tip: Point3<f64>, direction: Direction, feed: Option<f64>) -> NcMove {
        NcMove {
            line: self.line,
            rapid: feed.is_none(),
            tip,
            direction,
            interpolation: Interpolation::RotaryLinear,
            feed,
            time: None,
            tool: self.tool.clone().unwrap_or(NcTool::Number(0)),
            speed: self.speed.unwrap_or(0.0),
            smoothing: None,
            turn: if let Some(Smoothing::Within(tolerance)) = self.smoothing { tolerance.turn } else { None },
            curve: None,
            frame_turned: false,
        }
    }

    /// The section that is open, as long as the text has no fault.
    pub(crate) fn section(&mut self) -> Option<&mut NcSection> {
        self.sections.last_mut().filter(|_| self.faults.is_empty())
    }

    /// Begins a section.
    pub(crate) fn begin_section(&mut self, start: NcStation, shape: NcToolShape) {
        if self.faults.is_empty() {
            self.sections.push(NcSection { start, moves: Vec::new(), retract: None, shape });
        }
    }

    /// Ends the section by its retract in a line; a section without a move is none.
    pub(crate) fn end_section(&mut self, line: usize, retract: NcRetract) {
        if let Some(section) = self.section() {
            if section.moves.is_empty() {
                self.sections.pop();
            } else {
                section.retract = Some((line, retract));
            }
        }
    }

    /// Keeps a move for the result, as long as the text has no fault.
    pub(crate) fn keep(&mut self, made: NcMove) {
        if let Some(section) = self.section() {
            section.moves.push(made);
            self.moves += 1;
        }
    }

    /// The sections of a text with some lines, which the word `end` has to end.
    ///
    /// # Errors
    /// The faults, in order.
    pub(crate) fn finished(mut self, lines: usize, end: &str) -> ReadResult {
        if !self.ended && !self.is_full() {
            self.begin_line(lines);
            self.fault(format!("{ENDS_HERE}{end}"));
        }
        if self.faults.is_empty() { Ok(self.sections) } else { Err(self.faults) }
    }
}
