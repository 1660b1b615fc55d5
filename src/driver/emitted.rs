//! What `--emit` prints of program and plan, or writes of them.

use super::{Emit, EmitForm, Options, Stages, part_file, stage_file};
use base::source::SourceMap;
use diagnostics::{Aborted, Sink};
use ir::Program;
use ir::print::{self, Detail};
use ir::stage_file::{PlannedMotion, StageValue};
use plan::passes::pipeline::Plan;

/// What is to be printed of the program, or what was written of it; `None` where the run goes on.
pub(super) fn of_program(
    options: &Options,
    program: &Program,
    sources: &SourceMap,
    stages: &mut Stages,
    sink: &mut Sink,
) -> Result<Option<String>, Aborted> {
    match (options.emit, options.form) {
        (Some(Emit::Ir), EmitForm::Text) => Ok(Some(print::program(program))),
        (Some(Emit::Ir), EmitForm::Json) => {
            stage_file::write(options, program, &StageValue::Ir, sources, sink).map(Some)
        }
        (Some(Emit::Part(form)), _) => part_file::write(options, form, program, sources, stages, sink).map(Some),
        _ => Ok(None),
    }
}

/// The stage value of planning that is to be printed, or what was written of it; `None` where the run goes on.
pub(super) fn of_plan(
    options: &Options,
    program: &Program,
    plan: &Plan,
    sources: &SourceMap,
    sink: &mut Sink,
) -> Result<Option<String>, Aborted> {
    if options.form == EmitForm::Json {
        let value = match options.emit {
            Some(Emit::Cc) => StageValue::Cc(plan.cc.clone()),
            Some(Emit::Cl) => StageValue::Cl(plan.cl.clone()),
            Some(Emit::Motion) => StageValue::Motion(PlannedMotion::new(&plan.cl, plan.motion.clone())),
            _ => return Ok(None),
        };
        return stage_file::write(options, program, &value, sources, sink).map(Some);
    }
    Ok(match options.emit {
        Some(Emit::Cc) => Some(print::cc(program, &plan.cc, Detail::Full)),
        Some(Emit::Cl) => Some(print::cl(program, &plan.cl, Detail::Full)),
        Some(Emit::Motion) => Some(print::motion(program, &plan.motion, Detail::Full)),
        _ => None,
    })
}
