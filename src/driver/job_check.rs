//! A job judged without planning it: what the front end, the machine, the frames of the post, the memory that a plan
//! needs, and the facts about the part show. Fits of the tools to the faces are found only where they are asked for, since they take
//! most of the time.

use super::{ChoiceEffort, Options, Outcome, Stages, check_before_planning, front};
use diagnostics::{Aborted, Severity};
use ir::Program;
use plan::facts;

/// Checks a job. Options that name outputs and a stage are of no effect. Faults go to the sink of the outcome.
pub fn check(options: &Options, stages: &mut Stages) -> Outcome {
    let mut options = Options { output: None, other_outputs: Vec::new(), emit: None, ..options.clone() };
    options.run.choice.effort = ChoiceEffort::Facts;
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = judge(&options, stages, &mut outcome);
    outcome
}

fn judge(options: &Options, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Aborted> {
    let Some(program) = front(options, stages, outcome)? else { return Ok(()) };
    let Outcome { sources, sink, emitted, .. } = outcome;
    let facts = if options.fits { facts::check_with_fits } else { facts::check };
    check_before_planning(options, &program, facts, sources, stages, sink)?;
    let warnings = sink.diags().iter().filter(|diag| diag.severity == Severity::Warning).count();
    *emitted = Some(verdict(&program, warnings, options.fits));
    Ok(())
}

/// What the check found of a job without errors, and what it cannot find.
fn verdict(program: &Program, warnings: usize, fits: bool) -> String {
    let warned = match warnings {
        0 => String::new(),
        1 => ", one warning".to_owned(),
        count => format!(", {count} warnings"),
    };
    let operations = program.operations.iter().count();
    let required = program.contracts.len();
    let turned = program.machine.part_turned().map_or_else(String::new, |turned| format!("; {turned} of the machine"));
    format!(
        "{}: no fault found before planning{warned}; {} on {}, post {}{turned}\n\
         {}collisions, travel and {} are judged only when the job is compiled\n",
        program.name,
        if operations == 1 { "one operation".to_owned() } else { format!("{operations} operations") },
        program.machine.name,
        program.post.name,
        if fits { "" } else { "`--fits` tells what flank milling would leave; " },
        match required {
            0 => "the default requirements".to_owned(),
            1 => "its requirement".to_owned(),
            count => format!("its {count} requirements"),
        },
    )
}
