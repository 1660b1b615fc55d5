//! The spindle: it turns from the first cut to the retract, since no cutter touches stock while it stands or turns round.

use super::{ControlState, Transformation};
use crate::control::modal::{ModalGroup, Setting};
use crate::control::{NcBlock, figure};

/// Words that stop spindle and coolant.
const STOPS: [&str; 2] = ["M5", "M9"];

impl ControlState<'_> {
    /// Whether a word acts behind the move of its block.
    pub(super) fn acts_behind(&self, word: &str) -> bool {
        self.control.stops_behind && STOPS.contains(&word)
    }

    /// Sets what a block stops behind its move, on a control that does so.
    pub(super) fn set_stops(&mut self, block: &NcBlock) {
        for group in [ModalGroup::Spindle, ModalGroup::Coolant] {
            if let Some(word) = block.modal.get(group).filter(|word| self.acts_behind(word)) {
                self.set_to(group, word);
            }
        }
    }

    /// Whether a word stops the turning spindle or turns it round before the retract; reports it.
    pub(super) fn stops_in_part(&mut self, word: &str) -> bool {
        let modal = self.control.modal.iter().find(|modal| modal.group == ModalGroup::Spindle);
        let Setting::Said(now, _) = self.program.setting(ModalGroup::Spindle) else { return false };
        let stops = self.open && now != word && modal.is_some_and(|modal| modal.right.contains(&now));
        if stops {
            self.report_stopped(word);
            self.program.reported(ModalGroup::Spindle);
        }
        stops
    }

    fn report_stopped(&mut self, word: &str) {
        self.fault(format!(
            "`{word}` stops the spindle or turns it round with the tool in the part: write {} before it",
            self.retract_words()
        ));
        // Where the retract is missing, the end of the program would report it again.
        self.open &= self.transformation == Transformation::On;
    }

    /// S.
    pub(super) fn set_speed(&mut self, block: &NcBlock) {
        if block.speed == Some(0.0) && self.open && self.program.speed.is_some_and(|speed| speed > 0.0) {
            return self.report_stopped("S0");
        }
        let cuts = self.open && self.program.sections.last().is_some_and(|section| !section.moves.is_empty());
        if let Some(speed) = block.speed.filter(|speed| cuts && self.program.speed.is_some_and(|now| now != *speed)) {
            self.fault(format!(
                "`S{}` changes the speed of the spindle with the tool in the part: write {} before it",
                figure(speed),
                self.retract_words()
            ));
        }
        self.program.speed = block.speed.or(self.program.speed);
    }

    /// Reports a move at feed without a speed of the spindle.
    pub(super) fn judge_spindle(&mut self) {
        if !self.program.speed.is_some_and(|s| s > 0.0) {
            self.fault_once("speed", "a move at feed with the spindle at rest: no S before this block sets its speed");
        }
    }
}
