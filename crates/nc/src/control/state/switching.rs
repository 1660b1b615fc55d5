//! Tool centre point control is switched on and off: what must be known before, and the section that begins.

use super::{AxisPosition, ControlState, Length, Transformation};
use crate::control::modal::{ModalGroup, Setting};
use crate::control::{Control, LengthWord, NcBlock, WORD_ROUNDING_RAD, figure};
use crate::nc::{Direction, NcPlace, NcStation, NcTool};
use crate::tool_shape::NcToolShape;
use five_axis::{Carries, RotaryAxis};
use nalgebra::Vector3;

impl ControlState<'_> {
    /// Switches the transformation on or off.
    pub(super) fn switch(&mut self, on: bool, block: &NcBlock) {
        let [word, off] = self.control.transformation;
        self.doubtful = false;
        if block.has_axis_words() {
            self.fault("the transformation is switched in a move: write the word alone in its block");
        }
        self.check_turn();
        if self.control.switching_drops_frames {
            // The control cancels the programmable frame and the work offset.
            self.set_offset(Setting::Unknown);
            if let Some(shift) = self.control.modal.iter().find(|m| m.group == ModalGroup::Shift) {
                self.program.say(ModalGroup::Shift, shift.right[0]);
            }
        }
        if !on {
            if self.transformation == Transformation::On {
                self.axes = [AxisPosition::Left; 5];
            }
            self.transformation = Transformation::Off;
            if self.control.switching_sets_length {
                self.length = Length::Off;
            }
            return;
        }
        match self.transformation {
            Transformation::On => self.fault(format!("the transformation is switched on twice: write {off} before")),
            Transformation::Unknown => self.fault(format!(
                "the transformation may still be on from another program: write {off} alone in a block at the start"
            )),
            Transformation::Off => {}
        }
        if self.transformation != Transformation::On && !self.is_retracted() {
            let [.., first, second] = self.machine.names();
            self.independent_fault(format!(
                "the transformation is switched on at an unknown height: write {} before, then {first} and {second}, then X and Y",
                self.retract_words()
            ));
        } else if let Some(k) = (0..5).find(|k| self.axes[*k].known().is_none()) {
            let Control { machine_frame, behind, .. } = self.control;
            let axis = self.machine.names()[k];
            self.fault(format!(
                "the path to the first target depends on an unknown {axis}: move {axis} at the retract height before this \
                 block, `{machine_frame} {axis}...{behind}`"
            ));
        }
        self.check_frame();
        if self.control.switching_sets_length
            && let Some(LengthWord::Of(number)) = block.length
        {
            self.length = Length::Of(NcTool::Number(number), self.program.line);
        }
        let Length::Of(of, _) = &self.length else {
            let length = self.control.length;
            let on_again = self.transformation == Transformation::On;
            match &self.program.tool {
                _ if on_again => {}
                Some(_) => self.independent_fault(format!(
                    "{word} without the length of the tool: write `{length}` before this block"
                )),
                None => self.independent_fault(format!(
                    "{word} before any tool change: the tool in the spindle and its length are unknown; write \
                     {} before this block",
                    self.control.change_words()
                )),
            }
            return self.begin();
        };
        if self.program.tool.as_ref() != Some(of) {
            let tool = self.program.tool.as_ref().map_or("an unknown tool".to_owned(), |t| format!("tool {t}"));
            let reason = format!(
                "{tool} is in the spindle with the length of another tool, {of}: write `{}`",
                self.control.length
            );
            self.fault(reason);
        }
        self.begin();
    }

    /// Reports a work frame that is still turned where the transformation is switched.
    pub(super) fn check_turn(&mut self) {
        if self.frame_turn != 0.0 {
            let turn = figure(self.frame_turn.to_degrees());
            self.fault(format!("the work frame is still turned by {turn} deg here: {}", self.control.unturned));
            self.turn_frame(0.0);
        }
    }

    /// Reports a table that does not stand at zero where the control fixes the work frame to it.
    pub(super) fn check_frame(&mut self) {
        if !self.control.frame_of_switch {
            return;
        }
        let machine = self.machine;
        let turned = (0..2).find(|k| {
            machine.chain.axes()[*k].carries == Carries::Part
                && self.axes[3 + *k].known().is_some_and(|angle| angle.abs() > WORD_ROUNDING_RAD)
        });
        if let Some(k) = turned {
            let Control { machine_frame, behind, .. } = self.control;
            let RotaryAxis { name, word_sign, .. } = &machine.rotary[k];
            let at = figure(self.axes[3 + k].known().unwrap_or(0.0).to_degrees() * word_sign);
            self.independent_fault(format!(
                "the transformation is switched on with {name} at {at} deg: the control fixes the work frame to the table as \
                 the table stands here, so that X Y Z would count in a turned frame; write `{machine_frame} {name}0.{behind}` \
                 before, and turn the table after this block"
            ));
        }
    }

    /// Begins a section at the present axis positions.
    pub(super) fn begin(&mut self) {
        let [x, y, z, first, second] = self.axes.map(|p| p.known().unwrap_or(0.0));
        let rotary = [first, second];
        self.transformation = Transformation::On;
        self.tip = [None; 3];
        self.turn_to(Direction::Rotary(rotary));
        self.second = None;
        (self.at_start, self.turned) = (true, None);
        let place = NcPlace::Axes { xyz: Vector3::new(x, y, z), rotary, turned: None };
        self.program.begin_section(NcStation { line: self.placed, place }, NcToolShape::default());
        self.open = true;
    }
}
