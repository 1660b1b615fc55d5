//! What is refused before planning, which takes about a minute: machine, tools and post, outputs, memory.

use super::file_form::Form;
use super::output_names::NamedFile;
use super::{Emit, Options, RunOptions, Stages, or_reported, output_names, rest_stock, stage_file};
use crate::output::Outputs;
use base::progress::Progress;
use base::source::SourceMap;
use diagnostics::codes::post as codes;
use diagnostics::{Aborted, Diag, Sink};
use ir::Program;
use nc::Post;
use plan::facts;

/// Refuses before planning, which takes about a minute, whatever can be refused then, with these facts about the part. Only the
/// dialect and the writing of the outputs are left.
pub(super) fn check_before_planning(
    options: &Options,
    program: &Program,
    facts: fn(&Program, &Progress, &mut Sink),
    sources: &SourceMap,
    stages: &mut Stages,
    sink: &mut Sink,
) -> Result<(&'static dyn Post, Outputs), Aborted> {
    check_part_and_machine(program, sink)?;
    let post = if options.emit.is_none_or(|stage| stage == Emit::Nc) {
        check_frames(program, sink)?
    } else {
        find_post(program, sink)?
    };
    let named = output_names::own(options);
    let mut outputs = Outputs::default();
    stage_file::protect(options, &mut outputs);
    let outputs = or_reported(before_work(outputs, &options.run, &named, sources, program), sink)?;
    or_reported(output_names::check_all(&named), sink)?;
    plan::budget::check(program, sink)?;
    // Tools that cannot do their work are reported here, where the reason is known; planning would only report that it
    // finds no collision-free path.
    stages.watched("facts", |progress| facts(program, progress, sink));
    stages.go_on()?;
    if sink.has_errors() { Err(Aborted) } else { Ok((post, outputs)) }
}

/// Refuses a machine whose axes cannot direct the tool, and operations on edges that cannot be finished.
pub(super) fn check_part_and_machine(program: &Program, sink: &mut Sink) -> Result<(), Aborted> {
    facts::machine_kind::check(program, sink)?;
    facts::flat_edges::check(program, sink)
}

/// The dialect of the post file. Refuses a machine that the control cannot have, and frames that the dialect refuses.
///
/// # Errors
/// There is no such dialect. Other faults are in the sink alone.
pub fn check_frames(program: &Program, sink: &mut Sink) -> Result<&'static dyn Post, Aborted> {
    let post = find_post(program, sink)?;
    nc::trial::check(post, program, sink);
    Ok(post)
}

/// Refuses before planning outputs that cannot be written or that are also a file of the run, and cells of the stock
/// that are too coarse. `outputs` knows inputs that are no sources. `own` are the outputs of the command other than the
/// report and the meshes.
pub(super) fn before_work(
    mut outputs: Outputs,
    run: &RunOptions,
    own: &[NamedFile<'_>],
    sources: &SourceMap,
    program: &Program,
) -> Result<Outputs, Diag> {
    if let Some(cell) = run.stock_cell {
        rest_stock::check_cell(cell, &program.stock.profile)?;
    }
    outputs.protect_sources(sources);
    if let Some(folder) = &run.stock {
        outputs.folder("--stock", folder)?;
        let names = program.operations.iter().map(|(_, o)| o.name.as_str());
        for (o, name) in names.enumerate() {
            outputs.announce("--stock", &rest_stock::path(folder, o, name))?;
        }
    }
    for file in own {
        outputs.announce(file.flag, file.path)?;
    }
    if let Some(path) = &run.report {
        outputs.announce("--report", path)?;
        output_names::check("--report", path, Form::Page)?;
    }
    Ok(outputs)
}

/// The dialect that the post file names.
pub(super) fn find_post(program: &Program, sink: &mut Sink) -> Result<&'static dyn Post, Aborted> {
    let name = &program.post.dialect;
    nc::find(name).ok_or_else(|| {
        let known: Vec<&str> = nc::POSTS.iter().map(|p| p.name()).collect();
        sink.push(
            Diag::error(codes::UNKNOWN_POST, format!("there is no dialect `{name}`"))
                .label(program.post.dialect_span, "not one of the dialects")
                .help(format!(
                    "write one of {}",
                    known.iter().map(|k| format!("\"{k}\"")).collect::<Vec<_>>().join(", ")
                )),
        );
        Aborted
    })
}
