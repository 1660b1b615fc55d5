//! Modal groups, work offset and clamps, as moves need them.

use super::{AxisPosition, ControlState, Length, Transformation};
use crate::control::modal::{ModalGroup, Needed, Setting};

impl ControlState<'_> {
    /// Checks the modal groups that a move needs. All groups that no block has set are reported as one fault.
    pub(super) fn judge_modes(&mut self, transformed: bool, work_frame: bool, feed: bool) {
        let case = 1 << (u8::from(transformed) | u8::from(work_frame) << 1 | u8::from(feed) << 2);
        if !self.program.understood || self.program.judged & case != 0 {
            return;
        }
        self.program.judged |= case;
        let mut unsaid: Vec<String> = Vec::new();
        for modal in self.control.modal {
            let needed = match modal.needed {
                Needed::Always => true,
                Needed::InWorkFrame => work_frame,
                Needed::Transformed => transformed,
                Needed::AtFeed => feed,
            };
            if !needed {
                continue;
            }
            if modal.group == ModalGroup::WorkOffset {
                unsaid.extend(self.judge_offset(modal.what));
                continue;
            }
            let setting = self.program.setting(modal.group);
            let due = modal.right[0];
            match setting {
                Setting::Reported => continue,
                Setting::Said(word, _) if modal.right.contains(&word) => continue,
                Setting::Said(word, line) => self.independent_fault(format!(
                    "a move with {word}, which line {line} sets: {}; write {due} before this block",
                    modal.what
                )),
                Setting::Unknown => unsaid.push(format!("{}: write {due}", modal.what)),
            }
            self.program.reported(modal.group);
        }
        if !unsaid.is_empty() {
            self.independent_fault(format!("no block before this move ensures {}", unsaid.join("; ")));
        }
    }

    /// Reports another work offset than that of the part; gives what is to be written where no block selects any.
    fn judge_offset(&mut self, what: &str) -> Option<String> {
        let due = self.part_offset;
        match std::mem::replace(&mut self.offset, Setting::Reported) {
            Setting::Reported => None,
            Setting::Said(word, line) if *word == *due => {
                self.offset = Setting::Said(word, line);
                None
            }
            Setting::Said(word, line) => {
                let stated = match (self.control.offsets.has)(&word) {
                    true => format!(", or state `work-offset \"{word}\"` in the post"),
                    false => String::new(),
                };
                self.independent_fault(format!(
                    "a move with {word}, which line {line} sets: {what}; write {due} before this block{stated}"
                ));
                None
            }
            Setting::Unknown => Some(format!("{what}: write {due}")),
        }
    }

    /// Reports a rotary axis that moves, or may move, while it is clamped.
    pub(super) fn judge_clamps(&mut self, moves: [bool; 2]) {
        let machine = self.machine;
        for (k, axis) in machine.rotary.iter().enumerate() {
            let Some([clamp, unclamp]) = axis.clamp.as_ref().filter(|_| self.control.clamps && moves[k]) else {
                continue;
            };
            let why = match self.clamped[k] {
                Some(false) => continue,
                Some(true) => format!("{clamp} has clamped it"),
                None => "it may be clamped from another program".to_owned(),
            };
            self.independent_fault(format!("axis {} moves, and {why}: write {unclamp} in a block before", axis.name));
            self.clamped[k] = Some(false);
        }
    }

    /// Switches the transformation as a move means it, behind a block that was not understood and that may have done so: what
    /// follows from that block is not reported.
    pub(super) fn switch_unread(&mut self, on: bool) {
        self.doubtful = false;
        if on {
            // Some controls have it in the block that switches.
            if self.program.setting(ModalGroup::Turning) == Setting::Unknown {
                self.program.reported(ModalGroup::Turning);
            }
            return self.begin();
        }
        self.transformation = Transformation::Off;
        self.axes = [AxisPosition::Left; 5];
        self.frame_turn = 0.0;
        if self.control.switching_sets_length || !self.control.machine_frame_drops_length {
            self.length = Length::Off;
        }
    }

    /// Takes the transformation as off where a block that was not understood may have switched it, before a word that the
    /// control takes only then.
    pub(super) fn may_be_off(&mut self) {
        if self.doubtful && self.transformation == Transformation::On {
            self.switch_unread(false);
        }
    }
}
