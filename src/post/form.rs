//! How a dialect writes text, as data.

/// How a dialect writes text.
pub struct TextForm {
    /// Texts before and behind a comment.
    pub comment: [&'static str; 2],
    /// Text between the name of a rotary axis and its angle.
    pub rotary: &'static str,
    /// Block numbers.
    pub numbers: NumberForm,
    /// End of a line whose block goes on in the next line; empty where blocks are lines.
    pub continued: &'static str,
    /// Longest line, characters.
    pub longest: usize,
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
