//! Order in which a control executes the lines of a text: subprograms, and parts that are repeated.
//!
//! A dialect finds calls and what they call before the text is executed. A call inside of what is called is refused, so that
//! no text runs in a circle.

use std::collections::BTreeMap;
use std::ops::Range;

/// Most lines that are executed: calls make long programs of short texts.
pub(super) const MAX_EXECUTED: usize = 8_000_000;

/// Most times that a call repeats its lines.
pub(crate) const MAX_TIMES: u32 = 10_000;

/// What the control does in a line that is not a block. Lines count from 0.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Step {
    /// Nothing: the line is a label.
    Label,
    /// The lines up to this one are a subprogram, which runs only when it is called.
    SkipTo(usize),
    /// Lines run some times, with arguments, and the text goes on behind this line.
    Call {
        /// Lines.
        lines: Range<usize>,
        /// How often.
        times: u32,
        /// Values of the parameters 1, 2 ... of a subprogram.
        arguments: Vec<f64>,
    },
    /// The line is at fault.
    Fault(String),
}

/// The steps of a text by their lines.
#[derive(Clone, Debug, Default)]
pub(crate) struct Flow(pub(crate) BTreeMap<usize, Step>);

impl Flow {
    /// Refuses calls that call, since the lines of a call have a call among them.
    pub(crate) fn refuse_nested(&mut self, remedy: &str) {
        let called: Vec<Range<usize>> = self.calls().map(|(_, lines)| lines).collect();
        let nested: Vec<usize> =
            self.calls().map(|(line, _)| line).filter(|line| called.iter().any(|c| c.contains(line))).collect();
        for line in nested {
            let reason = format!("a call inside of lines that are called: {remedy}");
            self.0.insert(line, Step::Fault(reason));
        }
    }

    fn calls(&self) -> impl Iterator<Item = (usize, Range<usize>)> {
        self.0.iter().filter_map(|(line, step)| match step {
            Step::Call { lines, .. } => Some((*line, lines.clone())),
            _ => None,
        })
    }
}
