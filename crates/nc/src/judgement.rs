//! The one judgement of NC text, whoever wrote it: first the machine, then the reader of the dialect, then the job.
//!
//! `impellerc verify` judges foreign text by it, a compilation the text that it has written, and the trial of a post file
//! a few small moves. So none of them accepts what another refuses.

use super::dialect::Post;
use super::motion_of::{NcMotion, motion_of};
use super::nc::NcSection;
use super::recognise;
use super::work_frame;
use base::source::{SourceId, Span};
use diagnostics::{Code, Diag, Severity, Sink, codes::post as codes};
use ir::Program;

/// What a text commands.
#[derive(Debug)]
pub struct NcCommands {
    /// As the reader of the dialect has it, in the frame of the words.
    pub sections: Vec<NcSection>,
    /// The motion of the machine.
    pub motion: NcMotion,
}

/// Judges a text. Faults go to the sink with the spans of their lines; `span` gives the span of a line, from 1. `None`
/// when the faults prevent the motion from being known; a text is accepted when the sink has no error of it either.
pub fn judge(
    post: &dyn Post,
    program: &Program,
    text: &str,
    span: &dyn Fn(usize) -> Span,
    sink: &mut Sink,
) -> Option<NcCommands> {
    let before = sink.count();
    post.check_machine(&program.machine, program.post.span, sink);
    if sink.count() > before {
        return None;
    }
    // The text may be for another control than the post of the job.
    let has = |name: &&str| post.dialect().offsets.is_some_and(|offsets| (offsets.has)(name));
    let offset = program.post.work_offset().filter(has);
    let in_words = &*work_frame::program(post.name(), program);
    let sections = match post.read_with_offset(text, &in_words.machine, offset) {
        Ok(sections) => sections,
        Err(faults) => {
            let meant = recognise(text);
            let help = match meant {
                Some(meant) if meant.name() == post.name() => {
                    format!("correct the block; the text was read as {}", post.name())
                }
                Some(meant) => {
                    format!("its words are those of {}, but it was read as {}; use `--post`", meant.name(), post.name())
                }
                None => format!(
                    "give NC text: it was read as {}, and no line has a word of this dialect alone",
                    post.name()
                ),
            };
            // When no dialect is recognised, the text can be anything, and the first fault is enough.
            let shown = if meant.is_some() { faults.len() } else { 1 };
            for fault in faults.into_iter().take(shown) {
                let text = format!("line {}: {}", fault.line, fault.reason);
                sink.push(Diag::error(codes::NC_BLOCK, text).label(span(fault.line), "this block").help(help.clone()));
            }
            return None;
        }
    };
    let mut motion = motion_of(in_words, &sections, span, sink)?;
    motion.motion = work_frame::read(post.name(), program, motion.motion);
    Some(NcCommands { sections, motion })
}

/// Source of a text that is no file: the start of a span in it is the number of a line.
const LINES: SourceId = SourceId(u32::MAX);

/// The first fault of a text that the program itself has written.
#[derive(Debug)]
pub struct TextFault {
    /// Line, from 1; 0 where the text ends too early.
    pub line: usize,
    /// Code of the judgement.
    pub code: Code,
    /// Reason.
    pub reason: String,
    /// A remedy in the text.
    pub help: Option<String>,
}

impl TextFault {
    /// The fault of a diagnostic about a line of [`LINES`].
    fn of(diag: &Diag) -> Self {
        let line = diag.labels.iter().find(|label| label.span.source == LINES).map_or(0, |l| l.span.start as usize);
        let numbered = format!("line {line}: ");
        let reason = diag.message.strip_prefix(&numbered).unwrap_or(&diag.message).to_owned();
        Self { line, code: diag.code, reason, help: diag.help.clone() }
    }
}

/// Judges a text that is no file.
///
/// # Errors
/// The first error.
pub(super) fn judged(post: &dyn Post, program: &Program, text: &str) -> Result<NcCommands, TextFault> {
    let mut sink = Sink::default();
    let commands = judge(post, program, text, &|line| Span::new(LINES, line..line), &mut sink);
    let first = sink.diags().iter().find(|diag| diag.severity == Severity::Error);
    match (commands, first) {
        (Some(commands), None) => Ok(commands),
        (_, Some(diag)) => Err(TextFault::of(diag)),
        (None, None) => Err(TextFault {
            line: 0,
            code: codes::NOT_UNDERSTOOD,
            reason: "the text commands no motion".to_owned(),
            help: None,
        }),
    }
}
