//! The pipeline on one page: from a job file to verified NC, stage by stage. Only the driver reads files.

mod before_planning;
mod certificate_figures;
mod certificate_text;
mod choice_options;
mod chosen_job;
mod emit;
mod emitted;
mod file_form;
mod file_stamps;
mod front;
mod head;
mod import;
mod job_check;
mod job_file;
mod job_format;
mod language_service;
mod library;
mod library_list;
mod nc_check;
mod nc_diff;
mod new_job;
mod open_job;
mod open_part;
mod options;
mod other_outputs;
mod output_names;
mod part_file;
mod part_form;
mod quoted;
mod reading;
mod report;
mod rest_stock;
mod run_options;
mod saved;
mod section_files;
mod stage_file;
mod stages;
mod written;

pub use before_planning::check_frames;
pub use choice_options::{ChoiceEffort, ChoiceOptions};
pub use chosen_job::{FromPart, new_from};
pub use emit::{Emit, EmitForm};
pub use file_stamps::FileStamps;
pub use front::front;
pub use import::{Import, import};
pub use job_check::check;
pub use job_format::{Format, format};
pub use language_service::serve;
pub use library::DiskFiles;
pub use library_list::{LibraryKind, library_schema, list_library};
pub use nc_check::{NcCheck, verify};
pub use nc_diff::{NcDiff, diff};
pub use new_job::{BEGINNINGS, Beginning, new_job};
pub use open_job::{ChooseOptions, choose_job};
pub use open_part::PartInput;
pub use options::{Options, Outcome};
pub use other_outputs::{OUTPUTS, Output, OutputFile};
pub use part_form::{PartForm, PartOptions};
pub use quoted::{QuoteOptions, quoted};
pub use run_options::RunOptions;
pub use stages::{RunState, Stages};

use ::report::certificate_file::Inputs;
use base::source::{SourceMap, Span};
use before_planning::{before_work, check_before_planning, find_post};
use diagnostics::{Aborted, Diag, Sink, printable};
use front::start;
use ir::Program;
use ir::stage_file::StageValue;
use job_file::{MAX_JOB, read_job};
use other_outputs::Accepted;
use plan::facts;
use plan::passes::pipeline;
use saved::{meshes_written, save, save_accepted, save_refused};
use std::path::Path;
use verify::certificate::{Certificate, OperationReport};
use written::Written;

/// Compiles a job. Faults go to the sink of the outcome.
pub fn compile(options: &Options, stages: &mut Stages) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = run(options, stages, &mut outcome);
    outcome
}

fn run(options: &Options, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Aborted> {
    let Some((program, start)) = start(options, stages, outcome)? else { return Ok(()) };
    let Outcome { sources, sink, emitted, contracts, operations, notes, .. } = outcome;
    *emitted = emitted::of_program(options, &program, sources, stages, sink)?;
    if emitted.is_some() {
        return Ok(());
    }

    // A plan that was made shows that the part can be made.
    let facts = if matches!(start, StageValue::Ir) { facts::check } else { |_: &_, _: &_, _: &mut _| () };
    let (post, mut outputs) = check_before_planning(options, &program, facts, sources, stages, sink)?;
    let plan = stages.watched("plan", |progress| pipeline::run_from(&program, start, progress, sink))?;
    *emitted = emitted::of_plan(options, &program, &plan, sources, sink)?;
    if emitted.is_some() {
        return Ok(());
    }

    let mut stock = Vec::new();
    let (judged, certificate) = stages.watched("verify", |progress| {
        rest_stock::examine(&options.run, &program, plan.motion, &mut stock, &mut outputs, progress, sink)
    })?;
    stages.go_on()?;
    contracts.clone_from(&certificate.contracts);
    *operations = judged_operations(&program, &certificate);
    *notes = report::notes(&program, &plan.cl);
    let inputs = inputs(sources);
    let shown = report::Shown {
        program: &program,
        motion: match &judged {
            Ok(verified) => verified,
            Err(refused) => refused,
        },
        certificate: &certificate,
        notes,
        stock: &stock,
        nc: None,
        post: post.name(),
        hash: &inputs.sha256,
    };
    post.check(&program, shown.motion, sink);
    let Some(motion) = judged.as_ref().ok().filter(|_| !sink.has_errors()) else {
        let files = save_refused(&options.run, &shown, outputs, stages, sink)?;
        let unwritten = output_names::not_written(&output_names::own(options));
        *emitted = Some(certificate_text::text(&options.run, &shown, None, sources, sink) + "\n" + &files + &unwritten);
        return Err(Aborted);
    };

    nc::sectors::remark(post, &program, motion, sink);
    let library = certificate_text::library_lines(sources);
    let written = stages.run("write", || Written::new(&program, motion, &certificate, post, inputs.clone(), &library));
    let written = or_reported(written, sink)?;
    let read = stages.run("read back", || nc::read_back(post, &program, motion, &written.text));
    let read = or_reported(read.map_err(|fault| nc::refused(&program, &written.nc, &fault)), sink)?;
    if options.emit == Some(Emit::Nc) {
        *emitted = Some(written.text);
        return Ok(());
    }
    let mut text = certificate_text::text(&options.run, &shown, None, sources, sink);
    text.push_str(&format!(
        "\n{} text read back: {} moves, tip within {:.6} mm, tool axis within {:.1e} rad of the motion\n",
        post.name(),
        read.moves,
        read.tip,
        read.axis
    ));
    stages.go_on()?;
    let (certificate, library, output) = (&certificate, library.as_slice(), options.output.as_deref());
    let accepted =
        Accepted { program: &program, motion, certificate, post, library, sources, output, written: &written };
    text.push_str(&save_accepted(options, &accepted, shown, outputs, stages, sink)?);
    *emitted = Some(text);
    Ok(())
}

/// The operations of a certificate with their places in the job.
fn judged_operations(program: &Program, certificate: &Certificate) -> Vec<(Span, OperationReport)> {
    let span = |name: &str| program.operations.iter().find(|(_, o)| o.name == name).map(|(_, o)| o.span);
    certificate.operations.iter().filter_map(|report| Some((span(&report.name)?, report.clone()))).collect()
}

/// Reports the fault that stops a run.
fn or_reported<T>(made: Result<T, Diag>, sink: &mut Sink) -> Result<T, Aborted> {
    made.map_err(|fault| {
        sink.push(fault);
        Aborted
    })
}

/// A path as it is printed.
fn shown_path(path: &Path) -> String {
    printable(&path.display().to_string()).into_owned()
}

/// Hashes of all files that the run has read. Of the path of the job only the file name is kept, so that the same job gives the
/// same bytes from another folder or by another path.
fn inputs(sources: &SourceMap) -> Inputs {
    Inputs::new(sources.files().iter().map(|file| (file.own_name(), file.origin, file.bytes())))
}
