//! A job that leaves tools, operations or values open: what the compiler chooses for them, in a run and by `impellerc choose`.

use super::chosen_job::{judged, said, tried_line};
use super::job_file::read_job;
use super::new_job::{new_file, write_new};
use super::open_part::{PartInput, PartText};
use super::{ChoiceEffort, Options, Outcome, RunOptions, Stages, or_reported, shown_path};
use ::syntax::ast::File;
use base::progress::Progress;
use base::source::{SourceFile, SourceMap};
use choose::{Chosen, Effort};
use diagnostics::codes::{job as codes, planning};
use diagnostics::{Aborted, Diag};
use ir::Program;
use std::path::{Path, PathBuf};

/// The job with what was chosen in its open places; what was chosen is told in a remark.
pub(super) fn completed(
    options: &Options,
    text: String,
    ast: &File,
    stages: &mut Stages,
    outcome: &mut Outcome,
) -> Result<File, Aborted> {
    let chosen = chosen(&options.job, &options.run, text, ast, stages, outcome)?;
    outcome.sources = SourceMap::default();
    let source = outcome.sources.add_file(SourceFile {
        disk: options.job.canonicalize().ok(),
        ..SourceFile::text(shown_path(&options.job), chosen.job.clone())
    });
    let ast = ::syntax::parse(&chosen.job, source, &mut outcome.sink);
    outcome.sink.push(told(&options.job, &options.run, &chosen));
    Ok(ast)
}

fn chosen(
    job: &Path,
    run: &RunOptions,
    text: String,
    ast: &File,
    stages: &mut Stages,
    outcome: &mut Outcome,
) -> Result<Chosen, Aborted> {
    let source = PartInput::default();
    let part = PartText::of_job(&source, job, text, run);
    let mut judge = |program: &Program, progress: &Progress| judged(program, progress);
    let effort = match run.choice.effort {
        ChoiceEffort::Facts => Effort::Facts,
        ChoiceEffort::Axes => Effort::Axes,
        ChoiceEffort::Whole => Effort::Whole(&mut judge),
    };
    part.choose(&part.with_stock(ast), effort, stages, outcome)
}

/// What was chosen, as a remark.
fn told(job: &Path, run: &RunOptions, chosen: &Chosen) -> Diag {
    let count = chosen.summary.len();
    let by = match run.choice.effort {
        ChoiceEffort::Facts => "by facts about part and tools alone; a compile tries tool axes, and may choose others",
        ChoiceEffort::Axes | ChoiceEffort::Whole => "after trials of tool axes in one sector",
    };
    let operations = if count == 1 { "one operation".to_owned() } else { format!("{count} operations") };
    let mut diag = Diag::remark(planning::CHOSEN, format!("{operations} of {} chosen {by}", shown_path(job)));
    for line in &chosen.summary {
        diag = diag.note(line.clone());
    }
    if run.choice.explain {
        for tried in &chosen.tried {
            diag = diag.note(tried_line(tried));
        }
    }
    let explain = if run.choice.explain { "" } else { "; `--explain-choices` tells all that was tried" };
    diag.help(format!(
        "`impellerc choose {} -o FILE.imp` writes the job with what was chosen; places of lines are those in that text{explain}",
        shown_path(job)
    ))
}

/// A job that is to be completed, and where it goes.
#[derive(Clone, Debug, Default)]
pub struct ChooseOptions {
    /// The job, which leaves something open.
    pub job: PathBuf,
    /// File to write, which does not exist; without it the text is printed.
    pub output: Option<PathBuf>,
    /// Library, curves, machine and post, and how much is tried.
    pub run: RunOptions,
}

/// Writes a job with what was chosen in its open places.
pub fn choose_job(options: &ChooseOptions, stages: &mut Stages) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = write_chosen(options, stages, &mut outcome);
    outcome
}

fn write_chosen(options: &ChooseOptions, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Aborted> {
    let ChooseOptions { job, output, run } = options;
    let file = match output {
        Some(file) => Some(or_reported(new_file(file), &mut outcome.sink)?),
        None => None,
    };
    let text = read_job(job, &mut outcome.sink)?;
    let source = outcome.sources.add_file(SourceFile::text(shown_path(job), text.clone()));
    let ast = ::syntax::parse(&text, source, &mut outcome.sink);
    if outcome.sink.has_errors() {
        return Err(Aborted);
    }
    if !ast.is_open() {
        let diag = Diag::error(codes::MISSING_ITEM, format!("{} leaves nothing open", shown_path(job)));
        outcome.sink.push(diag.help(
            "write `operations auto`, or `auto` in the place of a value: `tool auto`, `method auto`, `depth auto`",
        ));
        return Err(Aborted);
    }
    let chosen = chosen(job, run, text, &ast, stages, outcome)?;
    let Some(file) = file else {
        outcome.sink.push(told(job, run, &chosen));
        outcome.emitted = Some(chosen.job);
        return Ok(());
    };
    or_reported(write_new(&file, &chosen.job, &[]), &mut outcome.sink)?;
    outcome.emitted = Some(said(&file, &[], &chosen, run.choice.explain));
    Ok(())
}
