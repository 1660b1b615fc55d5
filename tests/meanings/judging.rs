//! What becomes of a changed text: the reader refuses it, or the verifier finds what it does, or it means the same.

use super::cases::Change;
use super::changes::Dialect;
use crate::support::{self, pinned};
use impellerc::base::progress::Progress;
use impellerc::base::source::Span;
use impellerc::diagnostics::{Severity, Sink};
use impellerc::five_axis::Machine;
use impellerc::ir::{Motion, Program};
use impellerc::nc::{self, Post, motion_of::motion_of};
use impellerc::verify::certify_with;
use impellerc::verify::stock::Settings;
use impellerc::wheel::control::Orientation;

/// What becomes of a changed text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The reader refuses it, or it does not follow the job.
    Refused,
    /// It is read, and the verifier finds what it does.
    Found,
    /// It means the same motion.
    Harmless,
    /// It means another motion, with which nothing is wrong.
    Accepted,
}

impl Verdict {
    /// Those that can be due.
    pub const DUE: [Self; 3] = [Self::Refused, Self::Found, Self::Harmless];

    /// The one that a row states, with the reason behind it.
    pub fn due(row: &toml::Table) -> Result<Self, String> {
        let stated: Vec<Self> = Self::DUE.into_iter().filter(|due| row.contains_key(due.key())).collect();
        match stated[..] {
            [due] => Ok(due),
            _ => Err(format!("a case has one of {}: {row}", Self::DUE.map(Self::key).join(", "))),
        }
    }

    /// As rows of the data state it.
    pub fn key(self) -> &'static str {
        match self {
            Self::Refused => "refused",
            Self::Found => "found",
            Self::Harmless => "harmless",
            Self::Accepted => "accepted",
        }
    }
}

/// Whether two motions are the same but for the rounding of words.
fn same(a: &Motion, b: &Motion) -> bool {
    a.operations.len() == b.operations.len()
        && a.operations.iter().zip(&b.operations).all(|(a, b)| {
            a.moves.len() == b.moves.len()
                && a.moves.iter().zip(&b.moves).all(|(a, b)| {
                    let (p, q) = (&a.joints, &b.joints);
                    a.kind == b.kind
                        && (a.time - b.time).abs() <= 1e-6 * b.time
                        && (p.xyz - q.xyz).amax() < 1e-6
                        && [0, 1].iter().all(|k: &usize| (p.rotary[*k] - q.rotary[*k]).abs() < 1e-8)
                        && (a.feed.unwrap_or(0.0) - b.feed.unwrap_or(0.0)).abs() < 1e-6
                })
        })
}

/// What becomes of a text, with the reason.
fn judged(post: &dyn Post, program: &Program, text: &str, (own, meant): (&Machine, &Motion)) -> (Verdict, String) {
    let mut sink = Sink::default();
    let said = |sink: &Sink| sink.diags().iter().find(|d| d.severity == Severity::Error).map(|d| d.message.clone());
    post.check_machine(&program.machine, None, &mut sink);
    if let Some(reason) = said(&sink) {
        return (Verdict::Refused, reason);
    }
    let sections = match post.read(text, &program.machine) {
        Ok(sections) => sections,
        Err(faults) => return (Verdict::Refused, format!("line {}: {}", faults[0].line, faults[0].reason)),
    };
    let motion = motion_of(program, &sections, &|_| Span::default(), &mut sink);
    if let Some(reason) = said(&sink) {
        return (Verdict::Refused, reason);
    }
    let motion = motion.expect("a motion where nothing is refused").motion;
    if same(&motion, meant) && program.machine.travel() == own.travel() {
        return (Verdict::Harmless, String::new());
    }
    let _ = certify_with(program, &motion, &mut cells(), &Progress::default(), &mut sink);
    said(&sink).map_or((Verdict::Accepted, String::new()), |reason| (Verdict::Found, reason))
}

/// Coarse cells of the stock: what is found is found by the surfaces and the axes.
fn cells() -> Settings<'static> {
    Settings { cell: Some(4.0), ..Settings::default() }
}

/// The text of a job in a dialect, without block numbers.
fn written(post: &dyn Post, program: &Program, motion: &Motion) -> String {
    let text = nc::emit(post, program, motion, &[]).text();
    let prefix = post.dialect().form.numbers.prefix;
    let bare = |line: &str| match line.strip_prefix(prefix).and_then(|l| l.split_once(' ')) {
        Some((number, rest)) if !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()) => rest.to_owned(),
        _ => line.to_owned(),
    };
    text.lines().map(|line| bare(line) + "\n").collect()
}

/// A text with block numbers, where the dialect has one in every block. Blocks keep a number that they have.
fn numbered(post: &dyn Post, text: &str) -> String {
    let form = &post.dialect().form;
    if !form.numbers.always {
        return text.to_owned();
    }
    let mut goes_on = false;
    let mut number = 0;
    let mut lines = Vec::new();
    for line in text.split('\n') {
        let bare = goes_on || line.trim().is_empty();
        goes_on = line.trim_end().ends_with(form.continued);
        let own = line.starts_with(|c: char| c.is_ascii_digit());
        lines.push(if bare || own { line.to_owned() } else { format!("{number} {line}") });
        number += usize::from(!bare);
    }
    lines.join("\n")
}

/// The text of a dialect without a change, and what it means.
pub struct Unchanged {
    post: &'static dyn Post,
    program: Program,
    motion: &'static Motion,
    text: String,
    meant: Motion,
}

impl Unchanged {
    /// Of the short job.
    pub fn new(dialect: &str, orientation: Orientation) -> Self {
        let post = nc::find(dialect).unwrap();
        let (program, motion) = pinned::short(dialect).planned();
        let mut program = support::with_post(dialect, program);
        program.post.control.orientation = orientation;
        let text = written(post, &program, motion);
        let sections = post.read(&numbered(post, &text), &program.machine).unwrap();
        let meant = motion_of(&program, &sections, &|_| Span::default(), &mut Sink::default()).unwrap().motion;
        Self { post, program, motion, text, meant }
    }

    /// What becomes of the text with a change of itself, of the machine or of the job; or why the change cannot be made.
    pub fn changed(&self, change: &Change, dialect: &Dialect) -> Result<(Verdict, String), String> {
        let mut program = self.program.clone();
        let text = numbered(self.post, &change.made(&self.text, dialect, &mut program)?);
        Ok(judged(self.post, &program, &text, (&self.program.machine, &self.meant)))
    }

    /// What becomes of the whole text, with the block numbers that it is written with.
    pub fn whole(&self) -> (Verdict, String) {
        let whole = nc::emit(self.post, &self.program, self.motion, &[]).text();
        judged(self.post, &self.program, &whole, (&self.program.machine, &self.meant))
    }

    /// What the verifier finds in the text as it is: nothing, so that what is found is found for its change.
    pub fn findings(&self) -> Vec<String> {
        let mut sink = Sink::default();
        let _ = certify_with(&self.program, &self.meant, &mut cells(), &Progress::default(), &mut sink);
        sink.diags().iter().filter(|d| d.severity == Severity::Error).map(|d| d.message.clone()).collect()
    }
}
