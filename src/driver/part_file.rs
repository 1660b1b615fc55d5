//! The part as a file for other programs.

use super::file_form::Form;
use super::part_form::{PartFiles, Source};
use super::{Options, PartForm, Stages, or_reported, output_names, shown_path, stage_file};
use crate::output::Outputs;
use base::source::SourceMap;
use diagnostics::{Aborted, Sink};
use ir::Program;
use std::path::Path;

/// Writes the part in a form; returns a text about what was written.
///
/// # Errors
/// The part has no such form, or the file cannot be written; the reason is in the sink.
pub(super) fn write(
    options: &Options,
    form: &'static PartForm,
    program: &Program,
    sources: &SourceMap,
    stages: &mut Stages,
    sink: &mut Sink,
) -> Result<String, Aborted> {
    let path = options.output.as_deref().unwrap_or(Path::new("part.step"));
    let mut outputs = Outputs::default();
    stage_file::protect(options, &mut outputs);
    outputs.protect_sources(sources);
    or_reported(outputs.announce("-o", path), sink)?;
    or_reported(output_names::check("-o", path, Form::Part(form)), sink)?;
    let PartFiles { files, said } = (form.make)(&mut Source { options: options.part, path, program, stages, sink })?;
    for (path, bytes) in &files {
        or_reported(outputs.stage("-o", path, bytes), sink)?;
    }
    stages.go_on()?;
    or_reported(outputs.commit(), sink)?;
    let lines: String = said.iter().map(|line| format!("  {line}\n")).collect();
    Ok(format!("wrote {}\n{lines}", shown_path(path)))
}
