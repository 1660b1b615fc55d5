//! Dialects: from a verified motion to NC text, and back.
//!
//! A post decides words, never geometry. [`Post::check`] refuses everything that the dialect cannot say, before
//! anything is written; then [`Post::emit`] cannot fail. [`read_back`] interprets the text with a reader that shares
//! nothing with the writer and compares it with the motion (V5).

mod control;
mod linuxcnc;
mod modal;
pub mod motion_of;
mod read_back;
mod read_linuxcnc;
mod read_siemens_840d;
mod siemens_840d;
pub mod words;

pub use control::MOST_FAULTS;
pub use read_back::{ReadBack, read_back};

use crate::diag::Sink;
use crate::ir::{Motion, Program};
use crate::kin::{Angles, Machine};
use crate::verify::Verified;
use nalgebra::{Point3, Vector3};
use std::sync::Arc;

/// A dialect.
pub trait Post: Sync {
    /// Name in the job language and on the command line.
    fn name(&self) -> &'static str;
    /// One line for the help.
    fn about(&self) -> &'static str;
    /// Refuses a machine that the transformation of the control cannot have.
    fn check_machine(&self, machine: &Machine, sink: &mut Sink);
    /// Refuses what the dialect cannot say, on a machine that it cannot have too.
    fn check(&self, program: &Program, motion: &Motion, sink: &mut Sink);
    /// The program as text. `header` holds lines of the comment block at its head.
    fn emit(&self, program: &Program, motion: &Verified<Motion>, header: &[String]) -> NcProgram;
    /// What a text in this dialect makes the machine do, from where the transformation is switched on to the retract
    /// after it, section by section.
    ///
    /// # Errors
    /// The lines that are not understood or that are no sound program, at least one, at most [`MOST_FAULTS`].
    fn read(&self, text: &str, machine: &Machine) -> Result<Vec<NcSection>, Vec<ReadError>>;
    /// Whether a block holds a word that no other dialect knows. `code` ends where a bracket or a
    /// comment begins.
    fn recognises(&self, code: &str) -> bool;
}

/// The dialects that are built.
pub const POSTS: &[&dyn Post] = &[&siemens_840d::Siemens840d, &linuxcnc::LinuxCnc];

/// The dialect of a name.
pub fn find(name: &str) -> Option<&'static dyn Post> {
    POSTS.iter().copied().find(|p| p.name() == name)
}

/// Lines of a text that are looked at to recognise its dialect.
const LOOKED_AT: usize = 10_000;

/// Lines with words of each dialect alone, over the first lines of a text.
fn own_words(text: &str) -> Vec<usize> {
    let mut counts = vec![0_usize; POSTS.len()];
    for line in text.lines().take(LOOKED_AT) {
        // Either kind of comment.
        let code = line.split([';', '(']).next().unwrap_or_default();
        for (count, post) in counts.iter_mut().zip(POSTS) {
            *count += usize::from(post.recognises(code));
        }
    }
    counts
}

/// The dialect of a text: the one whose own words stand in most of its first lines; `None` when there are none of any
/// dialect, or as many of two.
pub fn recognise(text: &str) -> Option<&'static dyn Post> {
    let counts = own_words(text);
    let most = *counts.iter().max()?;
    let mut best = counts.iter().zip(POSTS).filter(|(n, _)| **n == most && most > 0).map(|(_, p)| *p);
    best.next().filter(|_| best.next().is_none())
}

/// How many times as many lines must have words of another dialect before a text is taken as one of it.
const CLEARLY: usize = 10;

/// The dialect of a text that is clearly not in the one that was to be expected.
pub fn clearly_other(text: &str, expected: &dyn Post) -> Option<&'static dyn Post> {
    let counts = own_words(text);
    let own = counts.iter().zip(POSTS).find(|(_, p)| p.name() == expected.name()).map_or(0, |(n, _)| *n);
    recognise(text).filter(|p| p.name() != expected.name() && counts.iter().max().is_some_and(|n| *n > CLEARLY * own))
}

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
pub struct Station {
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
    pub start: Station,
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
