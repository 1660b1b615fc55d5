//! A control as a state machine: the common base of the readers of all dialects. It shares no code with the writers.
//!
//! At the start everything is unknown: modal groups, tool, tool length, offsets, transformation and the positions of
//! all axes. Only the program makes them known. A move with an unknown or wrong setting is a fault, and its message
//! says what to write. After a fault the state changes as the block intended, so that one run reports all faults of a
//! text. A dialect gives its [`Control`] as data and makes a [`NcBlock`] of each line.

mod block_text;
pub(super) mod flow;
pub(super) mod modal;
mod numbers;
pub(super) mod spline;
mod state;

pub(super) use block_text::{CodeName, WordList, has_byte, number_end, trim_start, without_blanks, words};
pub(super) use numbers::{LONGEST_NUMBER, number, shown};
pub(super) use state::{Line, ProgramState, Setup, control_character, read, read_in_order};

use crate::nc::NcTool;
use five_axis::Machine;
use modal::{Modal, ModalGroup, ModalWords};
use numbers::figure;
use spline::SplineWords;
use std::sync::Arc;

/// Most faults of one text that are reported.
pub const MAX_FAULTS: usize = 50;

/// Largest coordinate, mm: larger than any machine.
pub(super) const FARTHEST: f64 = 1e5;

/// Largest feed (mm/min), largest spindle speed (rpm), and largest F in inverse time (1/min).
pub(super) const FASTEST: f64 = 1e6;

/// Widest tolerance of the path that a text may give the control, mm.
pub(super) const WIDEST_TOLERANCE_MM: f64 = 10.0;

/// Widest tolerance of the direction of the tool that a text may give the control, degrees.
pub(super) const WIDEST_TURN_DEG: f64 = 0.1;

/// Slowest feed of a block in inverse time, mm/min. The interpreter of LinuxCNC uses no slower feed, so a slower block
/// takes another time than F says.
pub(super) const SLOWEST_INVERSE: f64 = 0.1;

/// Rounding of positions in words, mm.
const WORD_ROUNDING_MM: f64 = 1e-4;

/// Rounding of positions of rotary axes in words, radians: a step is 1e-5 deg.
pub(super) const WORD_ROUNDING_RAD: f64 = 1e-7;

/// A dialect as data.
pub(super) struct Control {
    /// Modal groups.
    pub(super) modal: &'static [Modal],
    /// Order in which the words of a block act.
    pub(super) order: &'static [Act],
    /// Words that switch tool centre point control on and off.
    pub(super) transformation: [&'static str; 2],
    /// The words before the axis words of a rapid in the machine frame, in which neither offsets nor tool length act.
    pub(super) machine_frame: &'static str,
    /// The words after the axis words.
    pub(super) behind: &'static str,
    /// The word of a rapid.
    pub(super) rapid: &'static str,
    /// The control has words that clamp rotary axes.
    pub(super) clamps: bool,
    /// Motion word with which blocks of polynomials are polynomials.
    pub(super) spline_motion: MotionWord,
    /// The words that bring a tool into the spindle.
    pub(super) change: &'static str,
    /// The words of the direction vector; empty where the control has none.
    pub(super) vector: [&'static str; 3],
    /// The word that activates the length of the tool in the spindle.
    pub(super) length: &'static str,
    /// The word that gives the tolerance of smoothing.
    pub(super) smoothing: &'static str,
    /// The word that ends a program.
    pub(super) end: &'static str,
    /// The work offsets.
    pub(super) offsets: &'static WorkOffsets,
    /// What takes a turn of the work frame back; empty where the reader knows no such turns.
    pub(super) unturned: &'static str,
    /// Words of [`ModalGroup::Turning`] with which the tool axis turns on a great circle. With every other word the rotary
    /// axes run linearly.
    pub(super) great_circle: &'static [&'static str],
    /// In moves in the machine frame the tool length does not act.
    pub(super) machine_frame_drops_length: bool,
    /// Switching the transformation cancels the work offset, its shifts and its rotations.
    pub(super) switching_drops_frames: bool,
    /// The words that switch the transformation activate and cancel the tool length as well.
    pub(super) switching_sets_length: bool,
    /// The control fixes the work frame to the table as the table stands when the transformation is switched on. Rotary
    /// axes that carry the part must then be at zero; they turn to the start of the path after that, in blocks in which the
    /// other axes stand still.
    pub(super) frame_of_switch: bool,
    /// Each word of the feed mode makes the control forget the feed; without it only a change of the mode does.
    pub(super) feed_mode_drops_feed: bool,
    /// A tool change activates a default tool length.
    pub(super) change_drops_length: bool,
    /// A tool change activates the length of the new tool.
    pub(super) change_sets_length: bool,
    /// A rotary axis of more than one turn takes the shorter way to its target.
    pub(super) shorter_way: bool,
    /// A rotary axis whose words the control reduces modulo 360 deg takes the shorter way to each. Without it such axes are
    /// not read.
    pub(super) modulo: bool,
    /// The words that stop spindle and coolant act behind the move of their block; all others act before it.
    pub(super) stops_behind: bool,
    /// A stop of the program switches spindle and coolant off.
    pub(super) wait_switches_off: bool,
    /// The end of a program switches spindle and coolant off.
    pub(super) end_switches_off: bool,
}

impl Control {
    /// What most controls with words of ISO 6983 have; a dialect says its modal groups, the order of its words, and what it has
    /// otherwise.
    pub(super) const ISO: Self = Self {
        modal: &[],
        order: &[],
        transformation: [""; 2],
        machine_frame: "G53 G0",
        behind: "",
        rapid: "G0",
        clamps: true,
        spline_motion: MotionWord::Feed,
        change: "T and M6",
        vector: [""; 3],
        length: "",
        smoothing: "",
        end: "M30",
        offsets: &WorkOffsets { usual: "", all: "", has: |_| false },
        unturned: "",
        great_circle: &[],
        machine_frame_drops_length: false,
        switching_drops_frames: false,
        switching_sets_length: false,
        frame_of_switch: false,
        feed_mode_drops_feed: false,
        change_drops_length: false,
        change_sets_length: false,
        shorter_way: false,
        modulo: true,
        stops_behind: false,
        wait_switches_off: false,
        end_switches_off: false,
    };

    /// The words that bring a tool into the spindle and activate its length.
    fn change_words(&self) -> String {
        if self.change_sets_length {
            self.change.to_owned()
        } else {
            format!("{}, then `{}`,", self.change, self.length)
        }
    }
}

/// Work offsets of a dialect.
pub struct WorkOffsets {
    /// The offset of a post that states none.
    pub usual: &'static str,
    /// All of them, as a message names them.
    pub all: &'static str,
    /// Whether a name is one of them.
    pub has: fn(&str) -> bool,
}

/// Actions of the words of a block, in the order of the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Act {
    /// A modal group is set.
    Set(ModalGroup),
    /// The work frame is turned.
    TurnFrame,
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
    /// The tool length is activated or cancelled.
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
pub(super) enum MotionWord {
    /// G0.
    Rapid,
    /// G1.
    Feed,
    /// POLY: blocks are polynomials.
    Polynomial,
    /// Neither: axis words need a motion word in their block.
    Cancelled,
}

/// Tool length that acts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum LengthWord {
    /// None.
    Off,
    /// The length of the tool in the spindle.
    OfSpindle,
    /// The length under a number in the tool table.
    Of(u32),
}

/// Tolerance that a control may add: from the path, mm, and from the tool direction, radians; `None` where no word states
/// it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SmoothingTolerance {
    /// Of the tip.
    pub(super) path: f64,
    /// Of the tool axis.
    pub(super) turn: Option<f64>,
}

/// Allowed deviation of the control from the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Smoothing {
    /// At most this deviation.
    Within(SmoothingTolerance),
    /// Limited by settings of the control; the text gives no figure.
    AtControl,
    /// Not limited, by this word.
    Left(&'static str),
}

/// Words of one block. Angles in radians, ISO sense.
#[derive(Default)]
pub(super) struct NcBlock {
    /// Motion word.
    pub(super) motion: Option<MotionWord>,
    /// Coordinates are in the machine frame, without any offset.
    pub(super) machine_frame: bool,
    /// X Y Z, mm.
    pub(super) tip: [Option<f64>; 3],
    /// Tool direction.
    pub(super) vector: [Option<f64>; 3],
    /// Second point of the tool axis, mm.
    pub(super) second: [Option<f64>; 3],
    /// Polynomials.
    pub(super) spline: Option<Box<SplineWords>>,
    /// The rotary axes; the first is next to the tool.
    pub(super) rotary: [Option<f64>; 2],
    /// F.
    pub(super) feed: Option<f64>,
    /// rpm.
    pub(super) speed: Option<f64>,
    /// Tool that is selected.
    pub(super) tool: Option<NcTool>,
    /// The selected tool comes into the spindle.
    pub(super) change: bool,
    /// Words of modal groups.
    pub(super) modal: ModalWords,
    /// The work offset that the block selects, as the control names it.
    pub(super) offset: Option<Arc<str>>,
    /// Tool centre point control on or off.
    pub(super) transformation: Option<bool>,
    /// Tool length.
    pub(super) length: Option<LengthWord>,
    /// Tolerance of path smoothing.
    pub(super) smoothing: Option<Smoothing>,
    /// Rotary axes that the block clamps (true) or unclamps.
    pub(super) clamps: [Option<bool>; 2],
    /// A word that the control takes only with the transformation off.
    pub(super) outside: Option<&'static str>,
    /// A word that makes the program wait.
    pub(super) wait: Option<&'static str>,
    /// The program ends, with this word.
    pub(super) end: Option<&'static str>,
    /// The work frame is turned about Z to this angle from its place at zero, radians.
    pub(super) frame_turn: Option<f64>,
    /// The position of a rotary axis is not the written one: it counts with the values of a call.
    pub(super) shifted: bool,
}

/// The rotary axis of a machine with a name.
pub(super) fn rotary_axis(machine: &Machine, name: &str) -> Option<usize> {
    // Byte by byte: almost all names are one letter.
    machine.rotary.iter().position(|axis| axis.name.len() == name.len() && axis.name.bytes().eq(name.bytes()))
}

/// The rotary axis of a machine with a letter of ASCII.
pub(super) fn rotary_letter(machine: &Machine, letter: char) -> Option<usize> {
    machine.rotary.iter().position(|axis| *axis.name.as_bytes() == [letter as u8])
}

/// Stores a value of which a block may hold only one.
pub(super) fn once<T>(slot: &mut Option<T>, address: &str, value: T) -> Result<(), String> {
    if slot.replace(value).is_some() { Err(format!("`{address}` occurs twice in one block")) } else { Ok(()) }
}

/// A coordinate in its range.
pub(super) fn in_range(value: f64) -> Result<f64, String> {
    if value.abs() > FARTHEST { Err(format!("{value} is out of range")) } else { Ok(value) }
}

/// A value whose amount is within a limit.
pub(super) fn within(address: &str, value: f64, limit: f64) -> Result<f64, String> {
    if value.abs() > limit {
        return Err(format!("{address} = {value} is out of range: at most {limit:.0}"));
    }
    Ok(value)
}

fn store(slot: &mut Option<f64>, address: &str, value: f64, limit: f64) -> Result<(), String> {
    once(slot, address, within(address, value, limit)?)
}

impl NcBlock {
    /// X, Y or Z.
    pub(super) fn coordinate(&mut self, axis: usize, value: f64) -> Result<(), String> {
        store(&mut self.tip[axis], ["X", "Y", "Z"][axis], value, FARTHEST)
    }

    /// A component of the direction vector.
    pub(super) fn component(&mut self, control: &Control, axis: usize, value: f64) -> Result<(), String> {
        store(&mut self.vector[axis], control.vector[axis], value, FARTHEST)
    }

    /// A rotary axis, in degrees as in the word. A word beyond the travel of the axis is refused here, so that nothing
    /// is measured with it.
    pub(super) fn angle(&mut self, axis: usize, degrees: f64, machine: &Machine) -> Result<(), String> {
        let limits = &machine.rotary[axis];
        let name = &limits.name;
        let angle = degrees.to_radians() * limits.word_sign;
        once(&mut self.rotary[axis], name, angle)?;
        if limits.modulo.is_some() && !(0.0..360.0).contains(&degrees) {
            return Err(format!(
                "{name} = {degrees} deg: the control reduces words of this axis modulo 360 deg; write a word from 0 to below 360"
            ));
        }
        if angle < limits.min - WORD_ROUNDING_RAD || angle > limits.max + WORD_ROUNDING_RAD {
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

    /// Stores a word that clamps or unclamps rotary axes of the machine; false when the word is none.
    pub(super) fn clamp_word(&mut self, code: &str, machine: &Machine) -> bool {
        let mut found = false;
        for (slot, axis) in self.clamps.iter_mut().zip(&machine.rotary) {
            if let Some(at) = axis.clamp.as_ref().and_then(|words| words.iter().position(|word| word == code)) {
                (*slot, found) = (Some(at == 0), true);
            }
        }
        found
    }

    /// Stores a word of a modal group; `None` when the text is no such word.
    pub(super) fn modal_word(&mut self, control: &Control, text: &str) -> Option<Result<(), String>> {
        let (modal, word) = control.modal.iter().find_map(|m| Some((m, m.word(text)?)))?;
        if modal.group == ModalGroup::WorkOffset {
            return Some(self.select_offset(word));
        }
        Some(match self.modal.set(modal.group, word) {
            Some(before) => Err(format!("`{before}` and `{word}` in one block both set {}", modal.what)),
            None => Ok(()),
        })
    }

    /// Stores a work offset.
    pub(super) fn select_offset(&mut self, name: &str) -> Result<(), String> {
        match self.offset.replace(name.into()) {
            Some(before) => Err(format!("`{before}` and `{name}` in one block both set the work offset")),
            None => Ok(()),
        }
    }

    pub(super) fn has_axis_words(&self) -> bool {
        self.tip != [None; 3]
            || self.rotary != [None; 2]
            || self.vector != [None; 3]
            || self.second != [None; 3]
            || self.spline.is_some()
    }

    /// Whether the block has no words but those of a move: as most blocks.
    pub(super) fn only_moves(&self) -> bool {
        let Self { speed, tool, change, offset, transformation, length, smoothing, .. } = self;
        let Self { clamps, outside, wait, end, frame_turn, modal, .. } = self;
        let switches = *change || transformation.is_some() || length.is_some() || smoothing.is_some();
        let selects = speed.is_some() || tool.is_some() || offset.is_some() || frame_turn.is_some();
        let stops = outside.is_some() || wait.is_some() || end.is_some() || *clamps != [None; 2];
        !(switches || selects || stops) && modal.is_empty()
    }
}

/// Number or name.
impl std::fmt::Display for NcTool {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Name(name) | Self::Capitals(name) => write!(f, "\"{}\"", shown(name, 40)),
        }
    }
}

/// A name from a text.
pub(super) fn name(text: &str) -> NcTool {
    NcTool::Name(Arc::from(text))
}
