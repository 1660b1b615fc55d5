//! Dialects: from a verified motion to NC text, and back.
//!
//! A post chooses words and changes no geometry. [`Post::check`] refuses every motion that the dialect cannot express,
//! before anything is written; therefore [`emit`] cannot fail. [`trial`] refuses frames of a post file with which the
//! text would not be understood, before anything is planned. [`read_back`] interprets the text with a reader
//! that shares no code with the writer, and compares the result with the motion (V5).

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

mod apt_cl;
pub mod compare;
mod control;
mod dialect;
mod divided;
mod fanuc;
mod form;
mod heidenhain;
mod judgement;
mod linuxcnc;
mod modulo;
pub mod motion_of;
mod nc;
mod positions;
mod read_back;
pub mod sectors;
mod siemens_840d;
mod tool_shape;
pub mod trial;
pub mod words;
mod work_frame;
mod write;

pub use control::{MAX_FAULTS, WorkOffsets};
pub use dialect::{Dialect, Post, WriteBlock};
pub use divided::Divided;
pub use form::{NumberForm, TextForm};
pub use judgement::{NcCommands, TextFault, judge};
pub use nc::{
    Direction, NcLine, NcMove, NcPlace, NcPose, NcProgram, NcRetract, NcSection, NcStation, NcTool, ReadError,
    ReadResult,
};
pub use read_back::{ReadBack, read_back, refused};
pub use tool_shape::{NcCutter, NcToolShape};
pub use write::emit;

use ir::Program;
use wheel::control::Orientation;

/// The available dialects.
pub const POSTS: &[&dyn Post] = &[
    &siemens_840d::Siemens840d,
    &linuxcnc::LinuxCnc,
    &heidenhain::Heidenhain,
    &fanuc::Family::FANUC,
    &fanuc::Family::MITSUBISHI,
    &apt_cl::AptCl,
];

/// What the proof assumes of those who take the text of a program further and of the settings of the control, a line each.
pub fn assumptions(post: &dyn Post, program: &Program) -> Vec<String> {
    let file = &program.post;
    let offset = file.work_offset().or_else(|| Some(post.dialect().offsets?.usual)).unwrap_or_default();
    let transformation = file.transformation[usize::from(file.control.orientation == Orientation::Vectors)].text();
    let filled = |what: &&str| what.replace("{work-offset}", offset).replace("{transformation}", &transformation);
    let own = post.dialect().assumptions.iter().map(filled);
    let turned = work_frame::assumptions(post.name(), program);
    own.chain(turned).chain(modulo::assumptions(&post.dialect().form, &program.machine)).collect()
}

/// The dialect with a name.
pub fn find(name: &str) -> Option<&'static dyn Post> {
    POSTS.iter().copied().find(|p| p.name() == name)
}

/// Number of lines that are examined to recognise the dialect of a text.
const EXAMINED_LINES: usize = 10_000;

/// Number of lines with words that only one dialect has, for each dialect, within the first lines of a text.
fn own_words(text: &str) -> Vec<usize> {
    let mut counts = vec![0_usize; POSTS.len()];
    for line in text.lines().take(EXAMINED_LINES) {
        // The comments of either dialect.
        let code = line.split([';', '(']).next().unwrap_or_default();
        for (count, post) in counts.iter_mut().zip(POSTS) {
            *count += usize::from(post.recognises(code));
        }
    }
    counts
}

/// The dialect of a text: the dialect with the most lines that hold its own words, within the first lines. `None` when
/// no dialect has such lines, or dialects of two families have the same number.
pub fn recognise(text: &str) -> Option<&'static dyn Post> {
    let counts = own_words(text);
    let most = *counts.iter().max()?;
    let mut best = counts.iter().zip(POSTS).filter(|(n, _)| **n == most && most > 0).map(|(_, p)| *p);
    let first = best.next()?;
    best.all(|other| other.dialect().family == first.dialect().family).then_some(first)
}

/// Ratio of the lines of another dialect to those of the expected one from which on the text counts as the other
/// dialect.
const OTHER_DIALECT_RATIO: usize = 10;

/// The dialect of a text that is clearly not in the expected dialect.
pub fn clearly_other(text: &str, expected: &dyn Post) -> Option<&'static dyn Post> {
    let counts = own_words(text);
    let own = counts.iter().zip(POSTS).find(|(_, p)| p.name() == expected.name()).map_or(0, |(n, _)| *n);
    recognise(text)
        .filter(|p| p.name() != expected.name() && counts.iter().max().is_some_and(|n| *n > OTHER_DIALECT_RATIO * own))
}
