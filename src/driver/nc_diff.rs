//! `impellerc diff`: what differs for the machine between two NC texts of one job.

use super::nc_check::{program, read_motion, read_nc};
use super::{Outcome, RunOptions, Stages, find_post, shown_path};
use crate::nc_text::compare;
use base::source::{SourceFile, SourceId};
use base::units::trim;
use diagnostics::codes::post as codes;
use diagnostics::{Aborted, Diag, Severity, Sink};
use ir::Program;
use nalgebra::Point3;
use nc::compare::{ComparedMotion, Difference, OperationDifference};
use nc::motion_of::NcMotion;
use nc::recognise;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use wheel::contract::clock;

/// Options of a comparison.
#[derive(Clone, Debug, Default)]
pub struct NcDiff {
    /// Both NC texts.
    pub nc: [PathBuf; 2],
    /// Job that both texts fulfil; without it nothing is compared.
    pub job: Option<PathBuf>,
    /// Machine file of the second text, where it is another one.
    pub other_machine: Option<String>,
    /// Shared options; the dialects are those of the texts.
    pub run: RunOptions,
}

/// A text that was read.
struct ReadText {
    source: SourceId,
    shown: String,
    post: &'static str,
    program: Program,
    motion: NcMotion,
}

/// Compares two NC texts. The text of the outcome has a table of all operations; each operation that differs is a finding.
pub fn diff(options: &NcDiff, stages: &mut Stages) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = run(options, stages, &mut outcome);
    outcome
}

fn run(options: &NcDiff, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Aborted> {
    let Some(job) = options.job.as_deref() else {
        let [first, second] = options.nc.each_ref().map(|nc| shown_path(nc));
        outcome.sink.push(
            Diag::error(codes::USAGE, "the job of both texts is not given")
                .note("NC text does not say how long the tools are, where the axes of the machine stand, and what each operation cuts")
                .help(format!("add the job: `impellerc diff {first} {second} --job job.imp`")),
        );
        return Err(Aborted);
    };
    let first = text(options, 0, job, stages, outcome)?;
    let second = text(options, 1, job, stages, outcome)?;
    let found = stages.run("compare", || {
        let sides = [&first, &second].map(|t| ComparedMotion { program: &t.program, motion: &t.motion.motion });
        compare(sides)
    });
    outcome.emitted = Some(table([&first, &second], &found).map_err(|_| Aborted)?);
    let differing = found.iter().enumerate().filter(|(_, o)| !o.is_same());
    let diags: Vec<Diag> = differing.map(|(k, o)| finding([&first, &second], k, o, outcome)).collect();
    diags.into_iter().for_each(|diag| outcome.sink.push(diag));
    Ok(())
}

/// Reads a text with the machine that it is for. Warnings and remarks about the job itself are left out.
fn text(
    options: &NcDiff,
    k: usize,
    job: &Path,
    stages: &mut Stages,
    outcome: &mut Outcome,
) -> Result<ReadText, Aborted> {
    let nc = &options.nc[k];
    let content = read_nc(nc, &mut outcome.sink)?;
    let mut run = options.run.clone();
    if k == 1 && options.other_machine.is_some() {
        run.machine.clone_from(&options.other_machine);
    }
    let mut of_job = Outcome { sources: std::mem::take(&mut outcome.sources), ..Outcome::default() };
    let made = program(&run, job, stages, &mut of_job);
    outcome.sources = of_job.sources;
    of_job.sink.diags().iter().filter(|d| d.severity == Severity::Error).for_each(|d| outcome.sink.push(d.clone()));
    let program = made?;
    let post = match recognise(&content) {
        Some(post) => post,
        None => find_post(&program, &mut outcome.sink)?,
    };
    let disk = nc.canonicalize().ok();
    let shown = shown_path(nc).to_string();
    let source = outcome.sources.add_file(SourceFile { disk, ..SourceFile::text(shown.clone(), content) });
    let (sources, sink): (_, &mut Sink) = (&outcome.sources, &mut outcome.sink);
    let motion = stages.run("read NC", || read_motion(post, &program, sources, source, sink))?;
    Ok(ReadText { source, shown, post: post.name(), program, motion })
}

/// The line of a move.
fn line(text: &ReadText, operation: usize, index: u32) -> Option<usize> {
    text.motion.line(u32::try_from(operation).ok()?, index)
}

/// The finding on an operation that differs.
fn finding(texts: [&ReadText; 2], k: usize, o: &OperationDifference, outcome: &Outcome) -> Diag {
    let times = o.times.map(|t| clock(t.iter().sum()));
    let mut diag = Diag::error(
        codes::DIFFERS,
        format!(
            "`{}` differs: tip by {} mm, tool axis by {} deg, speed by {} %; it takes {} and {}",
            o.name,
            trim(o.tip.value, 4),
            trim(o.axis.value, 4),
            trim(100.0 * o.speed.value, 2),
            times[0],
            times[1]
        ),
    )
    .help("`impellerc explain IMP0830` says what counts");
    for (n, (what, at)) in o.beyond_digits().enumerate() {
        let lines = [0, 1].map(|side: usize| line(texts[side], k, at.moves[side]));
        let [first, second] = lines.map(|line| line.map_or_else(|| "-".to_owned(), |n| n.to_string()));
        diag = diag.note(format!(
            "{what} differ most at line {first} of {} and line {second} of {}",
            texts[0].shown, texts[1].shown
        ));
        if n > 0 {
            continue;
        }
        diag = diag.place(o.name.clone(), Point3::from(at.tip));
        for (text, line) in texts.into_iter().zip(lines) {
            if let Some(span) = line.and_then(|line| outcome.sources.line_span(text.source, line)) {
                diag = diag.label(span, format!("the {what} differ most here"));
            }
        }
    }
    diag
}

/// The table of all operations.
fn table(texts: [&ReadText; 2], found: &[OperationDifference]) -> Result<String, std::fmt::Error> {
    let mut t = String::new();
    for text in texts {
        let moves: usize = text.motion.lines.iter().map(Vec::len).sum();
        writeln!(t, "{}: {moves} moves, {}, machine {}", text.shown, text.post, text.program.machine.name)?;
    }
    writeln!(t)?;
    writeln!(t, "largest differences: tip in mm, tool axis in deg, speed in %; times of cut, link and rapid")?;
    writeln!(
        t,
        "  {:<12} {:>9} {:>9} {:>8} {:>9} {:>9}  {:<26}  {:<26}",
        "operation", "tip", "axis", "speed", "moves", "moves", "times", "times"
    )?;
    let value = |d: &Difference, digits: usize| format!("{:.digits$}", d.value);
    for o in found {
        let times = o.times.map(|t| t.map(clock).join(" "));
        writeln!(
            t,
            "  {:<12} {:>9} {:>9} {:>8.3} {:>9} {:>9}  {:<26}  {:<26}",
            o.name,
            value(&o.tip, 6),
            value(&o.axis, 6),
            100.0 * o.speed.value,
            o.moves[0],
            o.moves[1],
            times[0],
            times[1]
        )?;
    }
    writeln!(t)?;
    writeln!(t, "ranges of the axes over all operations, mm and deg")?;
    for (side, text) in texts.into_iter().enumerate() {
        let names = text.program.machine.names();
        let axes = (0..5).map(|axis| {
            let [low, high] = found.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |range, o| {
                let [low, high] = o.ranges[side][axis];
                [range[0].min(low), range[1].max(high)]
            });
            let unit = |x: f64| if axis < 3 { x } else { x.to_degrees() };
            format!("{} {} .. {}", names[axis], trim(unit(low), 3), trim(unit(high), 3))
        });
        writeln!(t, "  {}: {}", text.shown, axes.collect::<Vec<_>>().join(", "))?;
    }
    let differing = found.iter().filter(|o| !o.is_same()).count();
    writeln!(t)?;
    match differing {
        0 => writeln!(t, "for the machine both texts are the same")?,
        n => writeln!(t, "for the machine {n} of {} operations differ", found.len())?,
    }
    Ok(t)
}
