//! Words of `.geomTurbo` lines and `.bgi` sections: blocks in blocks, without recursion.

use super::lines::{Line, Text, ends};
use diagnostics::Diag;

/// Deepest nesting that is read. The formats have some six.
const MAX_NESTING: usize = 32;

/// The blocks that are open at a line.
#[derive(Debug, Default)]
pub(super) struct Open<'t> {
    blocks: Vec<(&'t str, Line<'t>)>,
}

impl<'t> Open<'t> {
    /// Opens a block.
    pub(super) fn begin(&mut self, name: &'t str, line: Line<'t>) -> Result<(), Diag> {
        if self.blocks.len() >= MAX_NESTING {
            return Err(line.fault("the blocks are nested too deeply", "this block"));
        }
        self.blocks.push((name, line));
        Ok(())
    }

    /// Closes the innermost block, which must have this name where one is given.
    pub(super) fn end(&mut self, name: &str, line: Line<'_>) -> Result<(), Diag> {
        match self.blocks.pop() {
            Some((open, _)) if open.eq_ignore_ascii_case(name) => Ok(()),
            Some((open, begins)) => Err(line
                .fault(format!("`{name}` ends, but `{open}` is open"), "this end")
                .label(begins.span, "it begins here")),
            None => Err(line.fault(format!("`{name}` ends, but did not begin"), "this end")),
        }
    }

    /// Whether no block is open.
    pub(super) fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Whether the innermost block has this name.
    pub(super) fn is_in(&self, name: &str) -> bool {
        self.blocks.last().is_some_and(|(open, _)| open.eq_ignore_ascii_case(name))
    }

    /// Whether the name of the innermost block begins so.
    pub(super) fn innermost_begins(&self, with: &str) -> bool {
        self.blocks.last().and_then(|(open, _)| open.get(..with.len())).is_some_and(|o| o.eq_ignore_ascii_case(with))
    }

    /// Whether some open block has this name.
    pub(super) fn is_within(&self, name: &str) -> bool {
        self.blocks.iter().any(|(open, _)| open.eq_ignore_ascii_case(name))
    }

    /// Refuses a text that ends with an open block.
    pub(super) fn closed(&self, text: Text<'_>) -> Result<(), Diag> {
        match self.blocks.last() {
            None => Ok(()),
            Some((name, begins)) => {
                Err(ends(text, &format!("the end of `{name}`")).label(begins.span, "it begins here"))
            }
        }
    }
}
