//! Statements of spindle and coolant.

use super::{FASTEST, State, listed, positive};
use crate::control::modal::{ModalGroup, Setting};

impl State<'_> {
    pub(super) fn spindle(&mut self, values: &[&str]) -> Result<(), String> {
        let (turned, before) = (self.turns(), self.program.speed);
        let (word, speed) = match values {
            ["OFF"] => ("OFF", None),
            ["RPM", speed, turn @ ("CLW" | "CCLW")] | [speed, "RPM", turn @ ("CLW" | "CCLW")] => {
                (if *turn == "CLW" { "CLW" } else { "CCLW" }, Some(positive("SPINDL", speed, FASTEST)?))
            }
            _ => {
                self.stop_unsaid();
                return Err(format!(
                    "`SPINDL/{}` is not understood: write SPINDL/RPM, the speed, and CLW",
                    listed(values)
                ));
            }
        };
        self.program.say(ModalGroup::Spindle, word);
        self.program.speed = speed;
        // Behind a fault the place of the tool is not known.
        let stops = turned && !self.turns() && self.program.faults.is_empty();
        let changes = before.is_some_and(|before| speed.is_some_and(|speed| speed != before));
        let in_part = self.path.as_ref().is_some_and(|path| path.cuts && !self.is_retracted(&path.at));
        if !stops && changes && in_part && self.program.faults.is_empty() {
            return Err(
                "the speed of the spindle changes with the tool in the part: write SPINDL/RPM before the path, or behind its \
                 last GOTO"
                    .to_owned(),
            );
        }
        if stops && self.path.as_ref().is_some_and(|path| !self.is_retracted(&path.at)) {
            return Err(
                "the spindle stops or turns round with the tool in the part: write SPINDL/OFF behind the last GOTO of the path"
                    .to_owned(),
            );
        }
        Ok(())
    }

    /// Nobody knows whether the spindle turns.
    pub(super) fn stop_unsaid(&mut self) {
        self.program.forget(ModalGroup::Spindle);
        self.program.speed = None;
    }

    /// Whether the spindle turns clockwise.
    pub(super) fn turns(&self) -> bool {
        matches!(self.program.setting(ModalGroup::Spindle), Setting::Said("CLW", _))
    }

    pub(super) fn coolant(&mut self, values: &[&str]) -> Result<(), String> {
        let word = match values {
            ["OFF"] => "OFF",
            ["ON" | "FLOOD" | "MIST" | "THRU"] => "ON",
            _ => {
                self.program.forget(ModalGroup::Coolant);
                return Err(format!("`COOLNT/{}` is not understood: write COOLNT/FLOOD or COOLNT/OFF", listed(values)));
            }
        };
        self.program.say(ModalGroup::Coolant, word);
        Ok(())
    }
}
