//! The campaign of meanings: changes in the words of a program, each with the expected result and the reason by the
//! manual of the control. The reader refuses harmful kinds, or the verifier finds them; harmless kinds mean the same
//! motion.
//!
//! `cargo test --test quick meanings -- --nocapture` prints the counts.

mod apt_cl;
mod certificates;
mod curves_and_calls;
mod fanuc;
mod heidenhain;
mod linuxcnc;
mod operations;
mod siemens;

use crate::support::{self, jobs};
use impellerc::base::progress::Progress;
use impellerc::base::source::Span;
use impellerc::diagnostics::{Severity, Sink};
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::five_axis::Machine;
use impellerc::ir::{Motion, Program};
use impellerc::nc::{self, Post, motion_of::motion_of};
use impellerc::plan::passes::pipeline;
use impellerc::verify::stock::Settings;
use impellerc::verify::{Verified, certify_with, examine};
use impellerc::wheel::post_file::Orientation;
use std::collections::BTreeMap;
use std::sync::LazyLock;

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

/// A change of the text, of the machine or of the job.
pub enum Change {
    /// The first occurrence of a piece.
    First(&'static str, &'static str),
    /// The last one.
    Last(&'static str, &'static str),
    /// All of them.
    All(&'static str, &'static str),
    /// The first one behind the first block at feed.
    Cut(&'static str, &'static str),
    /// A line (without its end) goes behind the first line that begins like this.
    Move(&'static str, &'static str),
    /// In the third block at feed, the word of an address.
    Word(&'static str, How),
    /// The head and the operations, as a function finds them, in this order.
    Operations(&'static str, fn(&str) -> Vec<String>, &'static [usize]),
    /// The text as a whole.
    Text(&'static str, fn(&str) -> String),
    /// The machine that the text is read for.
    Machine(&'static str, fn(&mut Machine)),
    /// The job that the text is read for.
    Job(&'static str, fn(&mut Program)),
}

/// What happens to a word.
#[derive(Clone, Copy, Debug)]
pub enum How {
    /// It stands twice.
    Double,
    /// Another number.
    Number(&'static str),
    /// Another address.
    Address(&'static str),
}

/// A kind of change: its class, what is changed, what has to become of it, and why.
pub type Kind = (&'static str, Change, Verdict, &'static str);

fn replaced(text: &str, at: Option<usize>, from: &str, to: &str) -> String {
    let at = at.unwrap_or_else(|| panic!("{from:?} is not in the text"));
    format!("{}{to}{}", &text[..at], &text[at + from.len()..])
}

/// Start of the third block at feed in a row, so that its words are those of a cut or a link.
fn block_at_feed(text: &str) -> usize {
    let at_feed = |line: &str| {
        line.starts_with("G1 X") || line.starts_with("LN X") || (line.starts_with("L X") && !line.contains("FMAX"))
    };
    let mut starts =
        text.match_indices('\n').map(|(i, _)| i + 1).filter(|i| at_feed(text[*i..].lines().next().unwrap_or("")));
    starts.nth(2).unwrap()
}

fn word_changed(text: &str, address: &str, how: How) -> String {
    let block = block_at_feed(text);
    let line = &text[block..block + text[block..].find('\n').unwrap()];
    let at = line.find(&format!(" {address}")).unwrap_or_else(|| panic!("{address} in {line}"));
    let end = line[at + 1..].find(' ').map_or(line.len(), |n| at + 1 + n);
    let (word, number) = (&line[at..end], &line[at + 1 + address.len()..end]);
    let new = match how {
        How::Double => format!("{word}{word}"),
        How::Number(other) => format!(" {address}{other}"),
        How::Address(other) => format!(" {other}{number}"),
    };
    format!("{}{}{new}{}{}", &text[..block], &line[..at], &line[end..], &text[block + line.len()..])
}

impl Change {
    fn made(&self, text: &str, program: &mut Program) -> String {
        match self {
            Self::First(from, to) => replaced(text, text.find(from), from, to),
            Self::Last(from, to) => replaced(text, text.rfind(from), from, to),
            Self::All(from, to) => {
                assert!(text.contains(from), "{from:?} is not in the text");
                text.replace(from, to)
            }
            Self::Cut(from, to) => {
                let feed = block_at_feed(text) - 1;
                replaced(text, text[feed..].find(from).map(|n| n + feed), from, to)
            }
            Self::Move(line, behind) => {
                let whole = format!("\n{line}\n");
                let rest = replaced(text, text.find(&whole), &whole, "\n");
                let anchor = rest.find(&format!("\n{behind}")).unwrap_or_else(|| panic!("{behind} is not in the text"));
                let end = anchor + 1 + rest[anchor + 1..].find('\n').unwrap();
                format!("{}\n{line}{}", &rest[..end], &rest[end..])
            }
            Self::Word(address, how) => word_changed(text, address, *how),
            Self::Operations(_, parts, order) => {
                let parts = parts(text);
                assert_eq!(parts.len(), 4, "a head and three operations");
                let end = text.lines().last().unwrap();
                order.iter().map(|k| parts[*k].as_str()).chain([end, "\n"]).collect()
            }
            Self::Text(_, change) => change(text),
            Self::Machine(_, change) => {
                change(&mut program.machine);
                text.to_owned()
            }
            Self::Job(_, change) => {
                change(program);
                text.to_owned()
            }
        }
    }

    pub fn shown(&self) -> String {
        match self {
            Self::First(from, to) => format!("{from:?} -> {to:?}"),
            Self::Last(from, to) => format!("the last {from:?} -> {to:?}"),
            Self::All(from, to) => format!("all {from:?} -> {to:?}"),
            Self::Cut(from, to) => format!("in the path {from:?} -> {to:?}"),
            Self::Move(line, behind) => format!("{line:?} behind {behind:?}"),
            Self::Word(address, how) => format!("{address} {how:?}"),
            Self::Operations(what, ..) | Self::Text(what, _) | Self::Machine(what, _) | Self::Job(what, _) => {
                (*what).to_owned()
            }
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

/// What makes the small job short: one face, few lines of the floor, which the tool may then cut deep, and deeper roughing.
const SHORTER: [(&str, &str); 4] = [
    ("faces pressure, suction", "faces pressure"),
    ("scallop 0.2 mm", "scallop 0.8 mm"),
    ("max-depth 4 mm", "max-depth 9 mm"),
    ("depth 3 mm", "depth 4 mm"),
];

/// Coarse cells of the stock: what is found is found by the surfaces and the axes.
fn cells() -> Settings<'static> {
    Settings { cell: Some(4.0), after: None }
}

/// The short job on the machine with the control of a dialect, planned and verified once.
fn short(dialect: &str) -> &'static (Program, Verified<Motion>) {
    static SHORT: [LazyLock<(Program, Verified<Motion>)>; 2] =
        [LazyLock::new(|| compiled(None)), LazyLock::new(|| compiled(jobs::machine_of("linuxcnc")))];
    &SHORT[usize::from(jobs::machine_of(dialect).is_some())]
}

fn compiled(machine: Option<&str>) -> (Program, Verified<Motion>) {
    let text = SHORTER.iter().fold(include_str!("../../../jobs/small/small.imp").to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in the job");
        text.replace(from, to)
    });
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("small.imp"), text).unwrap();
    std::fs::copy("jobs/small/vane_curves.csv", folder.path().join("vane_curves.csv")).unwrap();
    let mut options = Options { job: folder.path().join("small.imp"), ..Options::default() };
    options.run.machine = machine.map(str::to_owned);
    let mut outcome = Outcome::default();
    let program = driver::front(&options, &mut Stages::default(), &mut outcome).unwrap().unwrap();
    let mut sink = Sink::default();
    let plan = pipeline::run(&program, &mut sink).unwrap_or_else(|_| panic!("no plan: {:#?}", sink.diags()));
    let (judged, _) = examine(&program, plan.motion, &mut cells(), &Progress::default(), &mut sink).unwrap();
    let motion = judged.unwrap_or_else(|_| panic!("{:#?}", sink.diags()));
    (program, motion)
}

/// The text of a job in a dialect, without block numbers.
fn written(post: &dyn Post, program: &Program, motion: &Verified<Motion>) -> String {
    let text = nc::emit(post, program, motion, &[]).text();
    let prefix = post.form().numbers.prefix;
    let bare = |line: &str| match line.strip_prefix(prefix).and_then(|l| l.split_once(' ')) {
        Some((number, rest)) if !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()) => rest.to_owned(),
        _ => line.to_owned(),
    };
    text.lines().map(|line| bare(line) + "\n").collect()
}

/// A text with block numbers, where the dialect has one in every block. Blocks keep a number that they have.
fn numbered(post: &dyn Post, text: &str) -> String {
    let form = post.form();
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

/// Prints what became of kinds, by class.
pub fn print_counts(what: &str, kinds: usize, counts: &BTreeMap<(&str, Verdict), usize>) {
    println!("\n{what}: {kinds} kinds\n  {:<18} {:>8} {:>6} {:>9}", "class", "refused", "found", "harmless");
    let classes: std::collections::BTreeSet<&str> = counts.keys().map(|k| k.0).collect();
    let line = |class: &str, count: &dyn Fn(Verdict) -> usize| {
        let (refused, found, harmless) = (count(Verdict::Refused), count(Verdict::Found), count(Verdict::Harmless));
        println!("  {class:<18} {refused:>8} {found:>6} {harmless:>9}");
    };
    for class in classes {
        line(class, &|verdict| counts.get(&(class, verdict)).copied().unwrap_or(0));
    }
    line("all", &|verdict| counts.iter().filter(|(k, _)| k.1 == verdict).map(|(_, n)| n).sum());
}

fn campaign(dialect: &str, orientation: Orientation, kinds: Vec<Kind>, least: usize) {
    let post = nc::find(dialect).unwrap();
    let (program, motion) = short(dialect);
    let mut program = support::with_post(dialect, program);
    program.post.orientation = orientation;
    let program = &program;
    let text = written(post, program, motion);
    let sections = post.read(&numbered(post, &text), &program.machine).unwrap();
    let meant = motion_of(program, &sections, &|_| Span::default(), &mut Sink::default()).unwrap().motion;
    let whole = nc::emit(post, program, motion, &[]).text();
    assert_eq!(judged(post, program, &whole, (&program.machine, &meant)).0, Verdict::Harmless, "block numbers");
    // What is found is found for its change.
    if kinds.iter().any(|kind| kind.2 == Verdict::Found) {
        let mut sink = Sink::default();
        let _ = certify_with(program, &meant, &mut cells(), &Progress::default(), &mut sink);
        assert!(!sink.has_errors(), "{:?}", sink.diags());
    }
    let mut counts: BTreeMap<(&str, Verdict), usize> = BTreeMap::new();
    let mut complaints = Vec::new();
    let mut seen = std::collections::BTreeSet::new();
    for (class, change, due, why) in &kinds {
        assert!(seen.insert(change.shown()), "{} stands twice", change.shown());
        let own = &program.machine;
        let mut program = program.clone();
        let changed = numbered(post, &change.made(&text, &mut program));
        let (found, reason) = judged(post, &program, &changed, (own, &meant));
        *counts.entry((class, found)).or_default() += 1;
        if found != *due {
            complaints.push(format!("{dialect} {class}: {}: {found:?}, due {due:?} ({why}): {reason}", change.shown()));
        } else if std::env::var_os("MEANINGS_LIST").is_some() {
            println!("{class}: {}: {found:?}, {why}\n    {reason}", change.shown());
        }
    }
    print_counts(dialect, kinds.len(), &counts);
    assert!(complaints.is_empty(), "{} complaints\n{}", complaints.len(), complaints.join("\n"));
    assert!(kinds.len() >= least, "only {} kinds", kinds.len());
}

#[test]
fn linuxcnc_means_what_its_manual_says() {
    campaign("linuxcnc", Orientation::Angles, linuxcnc::kinds(), 200);
}

#[test]
fn siemens_840d_means_what_its_manual_says() {
    campaign("siemens-840d", Orientation::Vectors, siemens::kinds(), 200);
}

#[test]
fn heidenhain_means_what_its_manual_says() {
    campaign("heidenhain", Orientation::Angles, heidenhain::kinds(), 200);
    campaign("heidenhain", Orientation::Vectors, heidenhain::vectors(), 20);
}

#[test]
fn fanuc_means_what_its_manual_says() {
    campaign("fanuc", Orientation::Angles, fanuc::kinds(), 200);
}

#[test]
fn mitsubishi_means_what_its_manual_says() {
    campaign("mitsubishi", Orientation::Angles, fanuc::mitsubishi(), 13);
}

#[test]
fn cl_data_mean_the_same_for_every_post_processor() {
    campaign("apt-cl", Orientation::Vectors, apt_cl::kinds(), 100);
}
