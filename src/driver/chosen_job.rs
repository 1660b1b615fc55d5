//! `impellerc new FILE --from PART`: the tools and operations for a part that has none, as a job. The part is a job without
//! them, or blade files.

use super::before_planning::{check_frames, check_part_and_machine};
use super::new_job::{new_file, write_new};
use super::open_part::{PartInput, PartText, given};
use super::{Outcome, Stages, or_reported, shown_path};
use ::syntax::ast::File;
use base::entity::EntityId;
use base::progress::Progress;
use base::source::SourceId;
use choose::{Chosen, Effort, Judgement, Load, Tried};
use diagnostics::codes::job as codes;
use diagnostics::{Aborted, Diag, Sink};
use ir::program::DEFAULT_MEMORY;
use ir::{OperationId, Program};
use plan::facts;
use plan::passes::pipeline;
use std::path::{Path, PathBuf};
use verify::stock::{OperationStock, Settings};

/// A job that is made for a part.
#[derive(Clone, Debug, Default)]
pub struct FromPart {
    /// File to write; it does not exist.
    pub file: PathBuf,
    /// The part: a job without tools and operations, or blade files.
    pub part: PartInput,
    /// Print all that was tried.
    pub explain: bool,
    /// Plan and prove the whole job, and correct what loads a tool over its limits.
    pub whole: bool,
}

/// Chooses tools and operations for a part, and writes the job.
pub fn new_from(options: &FromPart, stages: &mut Stages) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = run(options, stages, &mut outcome);
    outcome
}

fn run(options: &FromPart, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Aborted> {
    let sink = &mut outcome.sink;
    let file = or_reported(new_file(&options.file), sink)?;
    let part = PartText::read(&options.part, &file, stages, outcome)?;
    // Before the choice takes its time.
    for (path, _) in &part.tables {
        or_reported(new_file(path), &mut outcome.sink)?;
    }
    let ast = part.parsed(outcome)?;
    or_reported(open(&ast), &mut outcome.sink)?;
    let mut judge = |program: &Program, progress: &Progress| judged(program, progress);
    let effort = if options.whole { Effort::Whole(&mut judge) } else { Effort::Axes };
    let chosen = part.choose(&part.with_all(&ast), effort, stages, outcome)?;
    let Outcome { sink, emitted, .. } = outcome;
    // A text that was read without a fault has a usual form.
    let usual = ::syntax::format(&chosen.job, SourceId::default(), &mut Sink::default());
    or_reported(write_new(&file, usual.as_deref().unwrap_or(&chosen.job), &part.tables), sink)?;
    *emitted = Some(part.said + &said(&file, &part.tables, &chosen, options.explain));
    Ok(())
}

/// What plan and proof of a whole job say, as a compile does, with as much memory as it needs.
pub(super) fn judged(program: &Program, progress: &Progress) -> Judgement {
    let mut sink = Sink::default();
    let memory = program.memory.max(plan::budget::needed(program));
    let program = &Program { memory, ..program.clone() };
    let certificate = planned_and_proved(program, progress, &mut sink);
    let fault = (certificate.is_err() || sink.has_errors()).then(|| choose::first_error(&sink));
    let mut loads = vec![Load::default(); program.operations.len()];
    for (k, o) in certificate.iter().flatten() {
        let tool = &program.tools[program.operations[*k].tool];
        let share = |value: Option<f64>, limit: f64| value.map_or(0.0, |value| value / limit);
        loads[k.index()] = Load {
            depth: share(o.slot_depth.map(|load| load.value.get()), tool.max_depth.get()),
            chip: share(o.chip.map(|chip| chip.value.get()), tool.max_chip.get()),
        };
    }
    Judgement { fault, loads }
}

/// The operations of a program with what they do to the stock.
fn planned_and_proved(
    program: &Program,
    progress: &Progress,
    sink: &mut Sink,
) -> Result<Vec<(OperationId, OperationStock)>, Aborted> {
    check_part_and_machine(program, sink)?;
    let post = check_frames(program, sink)?;
    facts::check(program, progress, sink);
    if sink.has_errors() {
        return Err(Aborted);
    }
    let plan = pipeline::run_with(program, progress, sink)?;
    let (judged, certificate) = verify::examine(program, plan.motion, &mut Settings::default(), progress, sink)?;
    let motion = match &judged {
        Ok(verified) => verified,
        Err(refused) => refused,
    };
    post.check(program, motion, sink);
    let of = |o: OperationStock| Some((motion.operations.get(o.operation as usize)?.operation, o));
    Ok(certificate.stock.into_iter().flat_map(|stock| stock.operations).filter_map(of).collect())
}

/// Refuses a job whose tools and operations are there.
fn open(ast: &File) -> Result<(), Diag> {
    let Some(item) = given(ast) else { return Ok(()) };
    Err(Diag::error(codes::GIVEN_TWICE, "the job of the part has tools or operations of its own")
        .label(item.span, "nothing is left to choose")
        .help("give a file with the part alone: remove its tools and operations, or compile it as it is"))
}

/// Memory that a compile is given, over the estimate.
const MEMORY_RESERVE: f64 = 1.25;

/// The option of a compile that allows the memory of what was chosen; nothing where the default is enough.
fn memory_option(chosen: &Chosen) -> String {
    // The lines that are planned may take more than the estimate before.
    let memory = MEMORY_RESERVE * chosen.memory;
    if memory > DEFAULT_MEMORY { format!(" --memory {}GB", (memory / 1e9).ceil()) } else { String::new() }
}

/// What was tried, in a line.
pub(super) fn tried_line(Tried { what, fault }: &Tried) -> String {
    format!("tried {what}: {}", fault.as_deref().unwrap_or("holds"))
}

/// What was chosen, for people.
pub(super) fn said(file: &Path, tables: &[(PathBuf, String)], chosen: &Chosen, explain: bool) -> String {
    let job = shown_path(file);
    let beside: String = tables.iter().map(|(path, _)| format!(", {}", shown_path(path))).collect();
    let mut text = String::new();
    if explain {
        text.extend(chosen.tried.iter().map(|tried| tried_line(tried) + "\n"));
        text.push('\n');
    }
    for line in &chosen.summary {
        text += &format!("{line}\n");
    }
    let memory = memory_option(chosen);
    let verdict = match chosen.judged.as_ref().map(|judged| &judged.fault) {
        None => "\nnot planned as a whole: `--effort whole` does, and corrects feeds and steps\n".to_owned(),
        Some(None) => "\nthe whole job holds: planned and verified in all of its sectors\n".to_owned(),
        Some(Some(fault)) => format!("\nthe whole job does not hold: {fault}\n"),
    };
    text + &verdict
        + &format!(
            "wrote {job}{beside}; {} trials, which `--explain-choices` lists\n\
         impellerc {job}{memory} -o {}    plans all of it, verifies it and writes the NC program\n",
            chosen.tried.len(),
            shown_path(&file.with_extension("nc")),
        )
}
