//! Statements of spindle and coolant.

use super::{Coolant, FASTEST, Spindle, State, listed};

impl State<'_> {
    pub(super) fn spindle(&mut self, values: &[&str]) -> Result<(), String> {
        let (turned, before) = (self.turns(), self.spindle);
        self.spindle = match values {
            ["OFF"] => Spindle::Off,
            ["RPM", speed, turn @ ("CLW" | "CCLW")] | [speed, "RPM", turn @ ("CLW" | "CCLW")] => {
                Spindle::On(self.positive("SPINDL", speed, FASTEST)?, *turn == "CLW", self.line)
            }
            _ => {
                self.spindle = Spindle::Unknown;
                return Err(format!(
                    "`SPINDL/{}` is not understood: write SPINDL/RPM, the speed, and CLW",
                    listed(values)
                ));
            }
        };
        // Behind a fault the place of the tool is not known.
        let stops = turned && !self.turns() && self.faults.is_empty();
        let changes = match (before, self.spindle) {
            (Spindle::On(a, ..), Spindle::On(b, ..)) => a != b && self.faults.is_empty(),
            _ => false,
        };
        let in_part = self.path.as_ref().is_some_and(|path| path.cuts && !self.is_retracted(&path.at));
        if !stops && changes && in_part {
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

    /// Whether the spindle turns clockwise.
    pub(super) fn turns(&self) -> bool {
        matches!(self.spindle, Spindle::On(_, true, _))
    }

    pub(super) fn coolant(&mut self, values: &[&str]) -> Result<(), String> {
        self.coolant = match values {
            ["OFF"] => Coolant::Off,
            ["ON" | "FLOOD" | "MIST" | "THRU"] => Coolant::On(self.line),
            _ => {
                self.coolant = Coolant::Unknown;
                return Err(format!("`COOLNT/{}` is not understood: write COOLNT/FLOOD or COOLNT/OFF", listed(values)));
            }
        };
        Ok(())
    }
}
