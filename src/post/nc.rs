//! NC text as blocks, and what a reader makes of it.

use crate::kin::Angles;
use nalgebra::{Point3, Vector3};
use std::sync::Arc;

/// NC text, block by block.
#[derive(Clone, Debug, Default)]
pub struct NcProgram {
    /// Lines without their ends.
    pub lines: Vec<NcLine>,
}

/// One line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NcLine {
    /// Text.
    pub text: String,
    /// Operation and move of the motion that it says.
    pub source: Option<(u32, u32)>,
}

impl NcProgram {
    /// Adds a line that no move stands behind.
    pub(crate) fn line(&mut self, text: impl Into<String>) {
        self.lines.push(NcLine { text: text.into(), source: None });
    }

    /// The whole text: every line ends with a line feed, the last one too.
    pub fn text(&self) -> String {
        let mut text = String::with_capacity(self.lines.iter().map(|l| l.text.len() + 1).sum());
        for line in &self.lines {
            text.push_str(&line.text);
            text.push('\n');
        }
        text
    }
}

/// Direction of the tool in a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Direction {
    /// Vector from the tip to the holder, part frame.
    Axis(Vector3<f64>),
    /// Both rotary axes in the ISO sense, radians.
    Rotary(Angles),
}

/// A tool as a text calls it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NcTool {
    /// By its number in the tool table.
    Number(u32),
    /// By its name.
    Name(Arc<str>),
}

/// Where all axes stand with the transformation off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NcStation {
    /// Line of the block that moved the last of them there, from 1.
    pub line: usize,
    /// X and Y, and Z of the gauge line of the spindle, machine frame, mm.
    pub xyz: Vector3<f64>,
    /// The rotary axes, radians, ISO sense.
    pub rotary: Angles,
}

/// Moves between switching the transformation on and off.
#[derive(Clone, Debug, PartialEq)]
pub struct NcSection {
    /// Where the axes stand when the transformation is switched on.
    pub start: NcStation,
    /// The moves with it on.
    pub moves: Vec<NcMove>,
    /// Line of the retract after it is switched off, and machine Z of the gauge line there, mm. There is one in every text
    /// that is read without a fault.
    pub retract: Option<(usize, f64)>,
}

/// A move with the transformation on.
#[derive(Clone, Debug, PartialEq)]
pub struct NcMove {
    /// Line, from 1.
    pub line: usize,
    /// By the word of a rapid.
    pub rapid: bool,
    /// Tool tip, part frame, mm.
    pub tip: Point3<f64>,
    /// Direction.
    pub direction: Direction,
    /// Feed of the tip in mm/min; `None` at rapid, and in inverse time where the text does not say where the way begins.
    pub feed: Option<f64>,
    /// Time of the move, s, where the block says it (inverse time).
    pub time: Option<f64>,
    /// Tool in the spindle, whose length acts.
    pub tool: NcTool,
    /// Spindle speed, rpm.
    pub speed: f64,
    /// How far the control may leave the path to smooth it, mm.
    pub smoothing: f64,
}

/// A line that a reader does not understand, or that is no sound part of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// Line, from 1.
    pub line: usize,
    /// Why.
    pub reason: String,
}
