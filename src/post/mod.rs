//! Dialects: from a verified motion to NC text, and back.
//!
//! A post decides words, never geometry. [`Post::check`] refuses everything that the dialect cannot say, before
//! anything is written; then [`Post::emit`] cannot fail. [`read_back`] interprets the text with a reader that shares
//! nothing with the writer and compares it with the motion (V5).

mod control;
mod dialect;
mod linuxcnc;
pub mod motion_of;
mod nc;
mod read_back;
mod siemens_840d;
pub mod words;

pub use control::MOST_FAULTS;
pub use dialect::Post;
pub use nc::{Direction, NcLine, NcMove, NcProgram, NcSection, NcStation, NcTool, ReadError};
pub use read_back::{ReadBack, read_back};

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
