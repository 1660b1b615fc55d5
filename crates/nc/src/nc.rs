//! NC text as blocks, and the result of a reader.

use super::tool_shape::NcToolShape;
use base::source::Span;
use five_axis::{Angles, Interpolation, PoseCurve};
use nalgebra::{Point3, Vector3};
use std::sync::Arc;

/// NC text, block by block.
#[derive(Clone, Debug)]
pub struct NcProgram {
    /// Lines without their ends.
    pub lines: Vec<NcLine>,
    /// End of every line.
    pub end: &'static str,
}

/// One line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NcLine {
    /// Text.
    pub text: String,
    /// Operation and move of the motion that the line writes.
    pub source: Option<(u32, u32)>,
    /// Further moves of the operation that the line makes when it is called again, in their order.
    pub again: Vec<u32>,
    /// The template of the post file that made the line.
    pub frame: Option<Span>,
}

impl NcProgram {
    /// The whole text: every line has its end, also the last.
    pub fn text(&self) -> String {
        let mut text = String::with_capacity(self.lines.iter().map(|l| l.text.len() + self.end.len()).sum());
        for line in &self.lines {
            text.push_str(&line.text);
            text.push_str(self.end);
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

/// Name of a tool in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NcTool {
    /// By its number in the tool table.
    Number(u32),
    /// By its name.
    Name(Arc<str>),
    /// By its name in capital letters: the tool table of the control has no others.
    Capitals(Arc<str>),
}

/// Distance by which the linear axes may leave their positions while tables turn to the start of a path, mm. The tip runs
/// on the chord of its circle about the table, so that a block of 1 deg takes axes 600 mm from the centre away by
/// 0.023 mm.
pub(super) const STANDS: f64 = 0.05;

/// Where a section begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NcPlace {
    /// Positions of all axes with the transformation off.
    Axes {
        /// X and Y, and Z of the gauge line of the spindle, machine frame, mm.
        xyz: Vector3<f64>,
        /// The rotary axes, radians, ISO sense. Where the tables turn to the start with the transformation on, their
        /// positions after that.
        rotary: Angles,
        /// X, Y and Z of the tip, machine frame, mm, with which the tables turn to the start with the transformation
        /// on; the axes stand still at `xyz` if these are the positions of the tip of the tool there.
        turned: Option<Vector3<f64>>,
    },
    /// Pose of the tool, in a text that knows no machine.
    Pose(NcPose),
}

/// A pose of the tool, part frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NcPose {
    /// Tool tip, mm.
    pub tip: Point3<f64>,
    /// Vector from the tip to the holder, length 1.
    pub axis: Vector3<f64>,
}

/// Start of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NcStation {
    /// Line of the block after which the tool stands there, from 1.
    pub line: usize,
    /// Place.
    pub place: NcPlace,
}

/// End of a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NcRetract {
    /// Machine Z of the gauge line, mm, with the transformation off; no other axis moves.
    Height(f64),
    /// Pose of the tool, in a text that knows no machine.
    Pose(NcPose),
}

/// Moves from the block that switches the transformation on to the block that switches it off. In a text that knows no
/// machine: the moves with one tool.
#[derive(Clone, Debug, PartialEq)]
pub struct NcSection {
    /// Where the tool stands at the start.
    pub start: NcStation,
    /// The moves with the transformation on.
    pub moves: Vec<NcMove>,
    /// Line of the retract after the transformation is switched off, and its target. Every text that is read without a
    /// fault has this retract.
    pub retract: Option<(usize, NcRetract)>,
    /// Shape of the tool, as far as the text states it.
    pub shape: NcToolShape,
}

/// A move with the transformation on.
#[derive(Clone, Debug, PartialEq)]
pub struct NcMove {
    /// Line, from 1.
    pub line: usize,
    /// Whether the word of a rapid (G0) acts.
    pub rapid: bool,
    /// Tool tip, part frame, mm.
    pub tip: Point3<f64>,
    /// Tool direction.
    pub direction: Direction,
    /// Rule by which the control moves the axes inside of the block.
    pub interpolation: Interpolation,
    /// Feed of the tip in mm/min; `None` at rapid, and in inverse time where the text does not give the start of the
    /// move.
    pub feed: Option<f64>,
    /// Time of the move, s, where the block gives it (inverse time).
    pub time: Option<f64>,
    /// Tool in the spindle; its length acts.
    pub tool: NcTool,
    /// Spindle speed, rpm.
    pub speed: f64,
    /// Largest deviation from the path with which the control may smooth it, mm; `None` where settings of the control
    /// decide and the text gives no figure.
    pub smoothing: Option<f64>,
    /// Largest error of the tool direction through smoothing, radians, where a word states it.
    pub turn: Option<f64>,
    /// Path of the tool in a block of polynomials; `None` for a straight one.
    pub curve: Option<Box<PoseCurve>>,
    /// The block states tip and direction in a turned frame, or positions of rotary axes with a shift.
    pub frame_turned: bool,
}

/// Begin of the reason where a text has no end.
pub(super) const ENDS_HERE: &str = "the text ends here, without ";

/// What a reader makes of a text: the sections, or the faults in order.
pub type ReadResult = Result<Vec<NcSection>, Vec<ReadError>>;

/// A line that a reader does not understand, or that makes the program invalid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// Line, from 1.
    pub line: usize,
    /// Reason.
    pub reason: String,
}
