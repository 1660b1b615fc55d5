//! How a dialect writes text, as data.

use five_axis::control::ModuloWay;

/// How a dialect writes text.
pub struct TextForm {
    /// Texts before and behind a comment.
    pub comment: [&'static str; 2],
    /// Text between the name of a rotary axis and its angle.
    pub rotary: &'static str,
    /// Words of axes modulo 360 deg, or why the dialect has none.
    pub modulo: Result<ModuloForm, &'static str>,
    /// Block numbers.
    pub numbers: NumberForm,
    /// End of a line whose block goes on in the next line; empty where blocks are lines.
    pub continued: &'static str,
    /// Longest line, characters.
    pub longest: usize,
}

/// How a text states positions of a rotary axis whose words the control reduces modulo 360 deg, so that the control goes
/// the shorter way to each.
pub struct ModuloForm {
    /// The ways in machine files with which the control does so.
    pub ways: &'static [ModuloWay],
    /// Texts before and behind the number.
    pub about: [&'static str; 2],
    /// What must be set at the control.
    pub assumed: &'static str,
}

/// Block numbers of a dialect.
pub struct NumberForm {
    /// Text before a number.
    pub prefix: &'static str,
    /// Largest number; the next block has the first number again.
    pub largest: u64,
    /// Every block has a number, in steps of 1 from 0. Otherwise the post file gives the step.
    pub always: bool,
    /// Comments have numbers as well.
    pub comments: bool,
    /// Beginnings of lines that have none.
    pub without: &'static [&'static str],
}
