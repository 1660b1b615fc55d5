//! The pipeline on one page: from a job file to verified NC, stage by stage. Only the driver reads files.

mod certificate_figures;
mod certificate_text;
mod file_stamps;
mod head;
mod import;
mod job_check;
mod job_format;
mod language_service;
mod library;
mod library_list;
mod nc_check;
mod nc_diff;
mod new_job;
mod output_names;
mod part_file;
mod reading;
mod report;
mod rest_stock;
mod section_files;
mod stage_file;
mod stages;

use crate::output::Outputs;
use ::report::certificate_file::{self, CertificateFile, HEAD, Inputs, NcText, OperationLines, sha256};
use ::report::picture;
use ::report::setup_sheet::{self, SheetInput};
use ::report::source_map::{SourceMapFile, WrittenLine};
use ::report::step::StepProtocol;
use ::syntax::ast::{File, ItemKind};
use base::progress::Progress;
use base::source::{SourceFile, SourceMap, Span};
use diagnostics::codes::{files, post as post_codes, syntax};
use diagnostics::junit::Judged;
use diagnostics::{Aborted, Diag, Sink, printable};
pub use file_stamps::FileStamps;
pub use import::{Import, import};
use ir::print::{self, Detail};
use ir::stage_file::{PlannedMotion, StageValue};
use ir::{Motion, Program};
use job::{Fault, Files, Job, MissingFile};
pub use job_check::check;
pub use job_format::{Format, format};
pub use language_service::serve;
pub use library::DiskFiles;
pub use library_list::{LibraryKind, library_schema, list_library};
use nc::{NcProgram, Post};
pub use nc_check::{NcCheck, verify};
pub use nc_diff::{NcDiff, diff};
pub use new_job::{BEGINNINGS, Beginning, new_job};
use plan::facts;
use plan::passes::pipeline::{self, Plan};
pub use stages::{Emit, EmitForm, PartForm, RunState, Stages};
use std::path::{Path, PathBuf};
use verify::Verified;
use verify::certificate::{Certificate, ContractReport, OperationReport};

/// Options that a compilation and a check of NC text share.
#[derive(Clone, Debug, Default)]
pub struct RunOptions {
    /// Folder with `machines` and `tools`, searched before any other.
    pub library: Option<PathBuf>,
    /// Folder with curve files, in addition to the folder of the job.
    pub curves: Option<PathBuf>,
    /// Dialect instead of the job's.
    pub post: Option<String>,
    /// Name of the machine file instead of the job's.
    pub machine: Option<String>,
    /// File to write the report to, also when a contract fails.
    pub report: Option<PathBuf>,
    /// Edge of the cells of the stock simulation, mm, instead of the default.
    pub stock_cell: Option<f64>,
    /// Folder for a mesh of the stock after each operation.
    pub stock: Option<PathBuf>,
    /// Memory that planning may use, bytes, instead of the default.
    pub memory: Option<f64>,
    /// Whether all figures of the proof are printed.
    pub details: bool,
}

/// How the part is written for other programs.
#[derive(Clone, Copy, Debug)]
pub struct PartOptions {
    /// Protocol of a STEP file.
    pub protocol: StepProtocol,
    /// Largest chord error of triangles, mm.
    pub chord: f64,
    /// Number of sections of a blade.
    pub sections: usize,
}

impl Default for PartOptions {
    fn default() -> Self {
        Self { protocol: StepProtocol::default(), chord: 0.01, sections: 11 }
    }
}

/// Options of a compilation.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Job file; of no effect with a stage file.
    pub job: PathBuf,
    /// Stage file to go on from, in the place of a job.
    pub from: Option<PathBuf>,
    /// File to write the NC text to.
    pub output: Option<PathBuf>,
    /// File to write a picture of part and paths to.
    pub picture: Option<PathBuf>,
    /// File to write the source map of the NC text to.
    pub source_map: Option<PathBuf>,
    /// File to write the setup sheet to: HTML where its name ends so, otherwise Markdown; other endings are refused.
    pub setup_sheet: Option<PathBuf>,
    /// File to write the certificate to.
    pub certificate: Option<PathBuf>,
    /// Stage value to print; the compilation stops after this stage.
    pub emit: Option<Emit>,
    /// How a stage value is written.
    pub form: EmitForm,
    /// How the part is written.
    pub part: PartOptions,
    /// Shared options.
    pub run: RunOptions,
}

/// Result of a run.
#[derive(Debug, Default)]
pub struct Outcome {
    /// All texts of the run.
    pub sources: SourceMap,
    /// All diagnostics.
    pub sink: Sink,
    /// The stage value to print, as text.
    pub emitted: Option<String>,
    /// Contracts that were judged, including those that failed.
    pub contracts: Vec<ContractReport>,
    /// Operations that were judged, each with its place in the job. An item with several tools is as many operations.
    pub operations: Vec<(Span, OperationReport)>,
    /// Name of an operation, and a decision of its planning.
    pub notes: Vec<(String, String)>,
    /// Files that the front end looked for and did not find: one that is made later is another job.
    pub looked_for: Vec<PathBuf>,
}

impl Outcome {
    /// The contracts as cases of a test report. Their names come from the job, so they are the same in every run.
    pub fn judged(&self) -> Vec<Judged> {
        let judged = |c: &ContractReport| Judged {
            name: format!("{} {} {}", c.name(), c.relation, c.figures[0]),
            found: c.figures[1].clone(),
            span: c.span,
            holds: c.holds,
        };
        self.contracts.iter().map(judged).collect()
    }
}

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
    *emitted = emit_program(options, &program, sources, stages, sink)?;
    if emitted.is_some() {
        return Ok(());
    }

    // A plan that was made shows that the part can be made.
    let facts = if matches!(start, StageValue::Ir) { facts::check_with } else { |_: &_, _: &_, _: &mut _| () };
    let (post, mut outputs) = check_before_planning(options, &program, facts, sources, stages, sink)?;
    let plan = stages.watched("plan", |progress| pipeline::run_from(&program, start, progress, sink))?;
    *emitted = emit_plan(options, &program, &plan, sources, sink)?;
    if emitted.is_some() {
        return Ok(());
    }

    let mut stock = Vec::new();
    let (judged, certificate) = stages.watched("verify", |progress| {
        rest_stock::examine(&options.run, &program, plan.motion, (&mut stock, &mut outputs), progress, sink)
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
    let written =
        stages.run("write", || Written::new(&program, motion, &certificate, post, (inputs.clone(), &library)));
    let mut written = or_reported(written, sink)?;
    if options.source_map.is_some() {
        written.source_map = Some(or_reported(source_map(&program, motion, sources, &written.nc), sink)?);
    }
    written.setup_sheet = options.setup_sheet.as_ref().map(|path| {
        let html = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm"));
        setup_sheet(options, &program, (&certificate, &library), post, &written, html)
    });
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
    text.push_str(&written.save(options, shown, outputs, stages, sink)?);
    *emitted = Some(text);
    Ok(())
}

/// The program and the value that a run begins at; `None` when the stage value to print comes before the program.
fn start(
    options: &Options,
    stages: &mut Stages,
    outcome: &mut Outcome,
) -> Result<Option<(Program, StageValue)>, Aborted> {
    match &options.from {
        Some(path) => {
            let texts = (&mut outcome.sources, &mut outcome.sink);
            stage_file::read(options, path, stages, texts).map(Some)
        }
        None => Ok(front(options, stages, outcome)?.map(|program| (program, StageValue::Ir))),
    }
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

/// Refuses before planning, which takes about a minute, whatever can be refused then, with these facts about the part. Only the
/// dialect and the writing of the outputs are left.
fn check_before_planning(
    options: &Options,
    program: &Program,
    facts: fn(&Program, &Progress, &mut Sink),
    sources: &SourceMap,
    stages: &mut Stages,
    sink: &mut Sink,
) -> Result<(&'static dyn Post, Outputs), Aborted> {
    facts::machine_kind::check(program, sink)?;
    facts::flat_edges::check(program, sink)?;
    let post = if options.emit.is_none_or(|stage| stage == Emit::Nc) {
        check_frames(program, sink)?
    } else {
        find_post(program, sink)?
    };
    let named = output_names::own(options);
    let own = named.map(|(flag, path, _)| (flag, path));
    let mut outputs = Outputs::default();
    stage_file::protect(options, &SourceMap::default(), &mut outputs);
    let outputs = or_reported(before_work(outputs, &options.run, &own, sources, program), sink)?;
    or_reported(output_names::check_all(&named), sink)?;
    plan::memory::check(program, sink)?;
    // Tools that cannot do their work are reported here, where the reason is known; planning would only report that it
    // finds no collision-free path.
    stages.watched("facts", |progress| facts(program, progress, sink));
    stages.go_on()?;
    if sink.has_errors() { Err(Aborted) } else { Ok((post, outputs)) }
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

/// What is to be printed of the program, or what was written of it; `None` where the run goes on.
fn emit_program(
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
fn emit_plan(
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

/// Writes the report and the meshes of a program that was refused: they show why. Returns a text about what it wrote.
fn save_refused(
    run: &RunOptions,
    shown: &report::Shown<'_>,
    mut outputs: Outputs,
    stages: &mut Stages,
    sink: &mut Sink,
) -> Result<String, Aborted> {
    if let Some(path) = &run.report {
        let html = report::html(shown, stages, sink);
        or_reported(outputs.stage("--report", path, html.as_bytes()), sink)?;
    }
    or_reported(outputs.commit(), sink)?;
    let meshes = meshes_written(run, shown.motion);
    Ok(match &run.report {
        Some(path) => format!("{meshes}wrote {}; no NC text\n", shown_path(path)),
        None => format!("{meshes}no NC text written\n"),
    })
}

/// A path as it is printed.
fn shown_path(path: &Path) -> String {
    printable(&path.display().to_string()).into_owned()
}

/// Text that the stock after each operation was written, where the options require it.
fn meshes_written(run: &RunOptions, motion: &Motion) -> String {
    let line = |folder: &PathBuf| format!("wrote {}: {} meshes\n", shown_path(folder), motion.operations.len());
    run.stock.as_ref().map(line).unwrap_or_default()
}

/// Writes files together with those that are staged already, all or none.
fn save<'a>(mut outputs: Outputs, files: impl Iterator<Item = (&'a str, &'a Path, &'a [u8])>) -> Result<(), Diag> {
    for (flag, path, bytes) in files {
        outputs.stage(flag, path, bytes)?;
    }
    outputs.commit()
}

/// Refuses before planning outputs that cannot be written or that are also a file of the run, and cells of the stock
/// that are too coarse. `outputs` knows inputs that are no sources. `own` are the outputs of the command other than the
/// report and the meshes.
fn before_work(
    mut outputs: Outputs,
    run: &RunOptions,
    own: &[(&str, &Option<PathBuf>)],
    sources: &SourceMap,
    program: &Program,
) -> Result<Outputs, Diag> {
    if let Some(cell) = run.stock_cell {
        rest_stock::check_cell(cell, &program.stock.profile)?;
    }
    for file in sources.files() {
        if let Some(path) = &file.disk {
            outputs.protect(format!("`{}`", file.name), path);
        }
    }
    if let Some(folder) = &run.stock {
        outputs.folder("--stock", folder)?;
        let names = program.operations.iter().map(|(_, o)| o.name.as_str());
        for (o, name) in names.enumerate() {
            outputs.announce("--stock", &rest_stock::path(folder, o, name))?;
        }
    }
    for (flag, path) in own.iter().chain(&[("--report", &run.report)]) {
        if let Some(path) = path {
            outputs.announce(flag, path)?;
        }
    }
    run.report.iter().try_for_each(|path| output_names::check("--report", path, output_names::Form::Page))?;
    Ok(outputs)
}

/// The stages from the text to the program; `None` when the stage value to print comes before the program.
///
/// # Errors
/// [`Aborted`] when the job is faulty; the faults are in the sink of the outcome.
pub fn front(options: &Options, stages: &mut Stages, outcome: &mut Outcome) -> Result<Option<Program>, Aborted> {
    let Outcome { sources, sink, emitted, looked_for, .. } = outcome;

    let text = read_job(&options.job, sink)?;
    let source = sources.add_file(SourceFile {
        disk: options.job.canonicalize().ok(),
        ..SourceFile::text(shown_path(&options.job), text.clone())
    });
    let mut ast = stages.run("read", || ::syntax::parse(&text, source, sink));
    if options.emit == Some(Emit::Ast) {
        *emitted = Some(::syntax::print::print(&ast));
        return Ok(None);
    }

    let files = DiskFiles::new(&options.job, options.run.library.as_deref(), options.run.curves.as_deref());
    let mut files = or_reported(files, sink)?;
    if let Some(name) = &options.run.machine {
        take_machine(name, &mut ast, &mut files, sink)?;
    }
    if let Some(name) = &options.run.post {
        take_post(name, &mut ast, &mut files, sink)?;
    }
    let resolved = stages.run("resolve", || job::resolve(&ast, &mut files, sources, sink));
    *looked_for = files.looked_for();
    let mut job: Job = resolved?;
    if options.run.post.is_some() {
        job.post.span = None;
    }
    if options.emit == Some(Emit::Job) {
        *emitted = Some(job::print::print(&job));
        return Ok(None);
    }

    let mut program: Program = stages.run("lower", || lower::lower(&job, sink))?;
    program.memory = options.run.memory.unwrap_or(program.memory);
    Ok(Some(program))
}

/// Refuses a file of the library that the command line names and that does not exist.
fn in_library(
    found: Result<SourceFile, MissingFile>,
    (kind, name): (&str, &str),
    sink: &mut Sink,
) -> Result<(), Aborted> {
    let Err(missing) = found else { return Ok(()) };
    let (code, fault) = match missing.fault {
        Fault::Absent => (files::NOT_IN_LIBRARY, format!("there is no {kind} file `{name}`")),
        Fault::Unreadable | Fault::Outside => (files::CANNOT_READ, format!("the {kind} file `{name}` cannot be read")),
    };
    let mut diag = Diag::error(code, fault).note(missing.reason).note(format!("required by `--{kind}`"));
    if !missing.known.is_empty() {
        diag = diag.help(format!("the {kind}s are {}", missing.known.join(", ")));
    }
    sink.push(diag);
    Err(Aborted)
}

/// Replaces the post of the job by the post of the command line. The properties of the post of the job go with it.
fn take_post(name: &str, ast: &mut File, library: &mut DiskFiles, sink: &mut Sink) -> Result<(), Aborted> {
    in_library(library.post(name), ("post", name), sink)?;
    for item in &mut ast.items {
        if let ItemKind::Post { name: of_job, body } = &mut item.kind {
            name.clone_into(&mut of_job.text);
            *body = None;
        }
    }
    Ok(())
}

/// Replaces the machine of the job by the machine of the command line.
fn take_machine(name: &str, ast: &mut File, library: &mut DiskFiles, sink: &mut Sink) -> Result<(), Aborted> {
    in_library(library.machine(name), ("machine", name), sink)?;
    for item in &mut ast.items {
        if let ItemKind::Use { kind, what } = &mut item.kind
            && kind.text == "machine"
        {
            name.clone_into(&mut what.text);
        }
    }
    Ok(())
}

/// The dialect that the post file names.
fn find_post(program: &Program, sink: &mut Sink) -> Result<&'static dyn Post, Aborted> {
    let name = &program.post.dialect;
    nc::find(name).ok_or_else(|| {
        let known: Vec<&str> = nc::POSTS.iter().map(|p| p.name()).collect();
        sink.push(
            Diag::error(post_codes::UNKNOWN_POST, format!("there is no dialect `{name}`"))
                .label(program.post.dialect_span, "not one of the dialects")
                .help(format!(
                    "write one of {}",
                    known.iter().map(|k| format!("\"{k}\"")).collect::<Vec<_>>().join(", ")
                )),
        );
        Aborted
    })
}

/// Hashes of all files that the run has read. Of the path of the job only the file name is kept, so that the same job gives the
/// same bytes from another folder or by another path.
fn inputs(sources: &SourceMap) -> Inputs {
    Inputs::new(sources.files().iter().map(|file| (file.own_name(), file.origin, file.bytes())))
}

/// Outputs of a program that was accepted.
struct Written {
    nc: NcProgram,
    /// The NC text.
    text: String,
    /// Text of the certificate.
    certificate: String,
    /// Text of the source map, where the options require it.
    source_map: Option<String>,
    /// Text of the setup sheet, where the options require it.
    setup_sheet: Option<String>,
}

/// First line of each operation in the text.
fn restarts(program: &Program, nc: &NcProgram) -> Vec<usize> {
    let [_, _, start, ..] = &program.post.frames;
    let begins = |line: &nc::NcLine| line.frame.is_some_and(|span| start.iter().any(|t| t.span == span));
    let stations = nc.lines.iter().enumerate().filter(|(_, line)| matches!(line.source, Some((_, 0))));
    stations.map(|(at, _)| at + 1 - nc.lines[..=at].iter().rev().take_while(|line| begins(line)).count() + 1).collect()
}

/// Text of the setup sheet.
fn setup_sheet(
    options: &Options,
    program: &Program,
    (certificate, library): (&Certificate, &[String]),
    post: &dyn Post,
    written: &Written,
    html: bool,
) -> String {
    let file = options.output.as_ref().and_then(|path| path.file_name());
    let file =
        file.map_or_else(|| "not written".to_owned(), |name| printable(&name.display().to_string()).into_owned());
    let body = sha256(certificate_file::body(&written.text).1.as_bytes());
    let restarts = restarts(program, &written.nc);
    let input = SheetInput {
        program,
        certificate,
        post: post.name(),
        library,
        assumptions: &nc::assumptions(post, program),
        nc: (&file, written.nc.lines.len(), &body[..SHOWN_HASH]),
        restarts: &restarts,
    };
    if html { setup_sheet::html(input) } else { setup_sheet::markdown(input) }
}

/// Digits of a hash that people compare.
const SHOWN_HASH: usize = 16;

/// Text of the source map.
fn source_map(program: &Program, motion: &Motion, sources: &SourceMap, nc: &NcProgram) -> Result<String, Diag> {
    let line_of = |span: Span| sources.line_column(span).0;
    let lines = nc.lines.iter().map(|line| {
        let frame = line.frame.and_then(|span| Some((sources.get(span.source)?.name.as_str(), line_of(span))));
        WrittenLine { text: &line.text, source: line.source, again: &line.again, frame }
    });
    let inputs = inputs(sources);
    let job = inputs.files.first().map_or("", |file| file.name.as_str());
    SourceMapFile::new(program, motion, job, line_of, lines).json().map_err(|reason| {
        Diag::error(files::INTERNAL, format!("the source map cannot be written: {reason}"))
            .help("report the job file: this is a fault of the compiler")
    })
}

impl Written {
    /// The NC program and its certificate, each with the hash of the other.
    fn new(
        program: &Program,
        motion: &Verified<Motion>,
        certificate: &Certificate,
        post: &dyn Post,
        (inputs, library): (Inputs, &[String]),
    ) -> Result<Self, Diag> {
        let head = head::lines(program, certificate, post, (&inputs, library));
        let mut nc = crate::nc_text::write(post, program, motion, &head);
        // Order: the body, then the head without the line of the certificate, then the certificate.
        let [_, of_body, of_certificate] = HEAD;
        let fill = |nc: &mut NcProgram, word: &str, hash: &str| {
            nc.lines.iter_mut().any(|line| certificate_file::fill(&mut line.text, word, hash))
        };
        let body = sha256(certificate_file::body(&nc.text()).1.as_bytes());
        fill(&mut nc, of_body, &body);
        let assumed = nc::assumptions(post, program);
        let text = NcText::new(post.name(), &nc.text(), operation_lines(program, motion, &nc));
        let text = NcText { assumed, ..text };
        let certificate = CertificateFile::new(certificate, inputs, text).and_then(|file| file.json());
        let certificate = certificate.map_err(|reason| {
            Diag::error(files::INTERNAL, format!("the certificate cannot be written: {reason}"))
                .help("report the job file: this is a fault of the compiler")
        })?;
        fill(&mut nc, of_certificate, &sha256(certificate.as_bytes()));
        Ok(Self { text: nc.text(), nc, certificate, source_map: None, setup_sheet: None })
    }

    /// Writes every file that the options require. Returns a text that names the files.
    fn save(
        &self,
        options: &Options,
        shown: report::Shown<'_>,
        outputs: Outputs,
        stages: &mut Stages,
        sink: &mut Sink,
    ) -> Result<String, Aborted> {
        let Options { output, picture, certificate, run, source_map, setup_sheet, .. } = options;
        let image = picture.as_ref().map(|_| stages.run("picture", || picture::picture(shown.program, shown.motion)));
        let motion = shown.motion;
        let shown = report::Shown { nc: Some(report::NcLines::written(&self.nc, &self.text)), ..shown };
        let html = run.report.as_ref().map(|_| report::html(&shown, stages, sink));
        let texts = [
            ("-o", output, Some(self.text.as_bytes())),
            ("--certificate", certificate, Some(self.certificate.as_bytes())),
            ("--picture", picture, image.as_deref()),
            ("--source-map", source_map, self.source_map.as_deref().map(str::as_bytes)),
            ("--setup-sheet", setup_sheet, self.setup_sheet.as_deref().map(str::as_bytes)),
            ("--report", &run.report, html.as_deref().map(str::as_bytes)),
        ];
        let files = texts.into_iter().filter_map(|(flag, path, bytes)| Some((flag, path.as_deref()?, bytes?)));
        or_reported(stages.run("save", || save(outputs, files)), sink)?;

        let mut said = match output {
            Some(path) => format!("wrote {}: {} lines\n", shown_path(path), self.text.lines().count()),
            None => "no NC text written: no `-o FILE`\n".to_owned(),
        };
        said.push_str(&meshes_written(run, motion));
        for path in [certificate, picture, source_map, setup_sheet, &run.report].into_iter().flatten() {
            said.push_str(&format!("wrote {}\n", shown_path(path)));
        }
        Ok(said)
    }
}

/// Lines of the operations in the text: those of their moves with the transformation on.
fn operation_lines(program: &Program, motion: &Motion, nc: &NcProgram) -> Vec<OperationLines> {
    let mut found: Vec<OperationLines> = Vec::new();
    for (i, line) in nc.lines.iter().enumerate() {
        let Some((operation, index)) = line.source else { continue };
        let Some(operation) = motion.operations.get(operation as usize) else { continue };
        if index == 0 || index as usize + 1 == operation.moves.len() {
            continue;
        }
        match found.last_mut() {
            Some(lines) if index > 1 => lines.last = i + 1,
            _ => {
                let name = program.operations[operation.operation].name.clone();
                found.push(OperationLines { name, first: i + 1, last: i + 1 });
            }
        }
    }
    found
}

/// Largest job file, bytes. The parser refuses far smaller files, with a reason.
const MAX_JOB: u64 = 64 << 20;

/// Text of the job file.
fn read_job(path: &Path, sink: &mut Sink) -> Result<String, Aborted> {
    let shown = path.display();
    let beside = path.with_extension("imp");
    let due = if path.extension().is_none() && beside.is_file() {
        format!("there is a job `{}`", beside.display())
    } else {
        "a job is a text file; `impellerc new part.imp` writes one".to_owned()
    };
    let diag = match reading::read(path, MAX_JOB).map(|bytes| bytes.map(String::from_utf8)) {
        Ok(Some(Ok(text))) if ir::stage_file::recognise(&text) => {
            Diag::error(syntax::NOT_TEXT, format!("{shown} is a stage file, not a job"))
                .help(format!("go on from it: `impellerc --from {shown}`"))
        }
        Ok(Some(Ok(text))) => match nc::recognise(&text).filter(|_| !text.contains("edition")) {
            None => return Ok(text),
            Some(post) => Diag::error(syntax::NOT_TEXT, format!("{shown} is NC text of {}, not a job", post.name()))
                .help("give the job file: `impellerc job.imp`, or `impellerc verify part.nc --job job.imp`"),
        },
        Ok(Some(Err(error))) => Diag::error(syntax::NOT_TEXT, format!("{shown} is not a text file"))
            .note(reading::no_text(&error))
            .help("give the job file itself, a text file; `impellerc new part.imp` writes one"),
        Ok(None) => Diag::error(syntax::TOO_LARGE, format!("{shown} has more than {} MB", MAX_JOB >> 20))
            .help(format!("give the job file itself: {due}")),
        Err(error) => reading::unreadable(path, &error, &due),
    };
    sink.push(diag);
    Err(Aborted)
}
