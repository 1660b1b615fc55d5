//! `impellerc verify`: checks NC text against its job.

use super::{
    Options, Outcome, RunOptions, Stages, before_work, find_post, front, judged_operations, meshes_written,
    or_reported, reading, report, rest_stock, save, shown_path,
};
use super::{certificate_figures, certificate_text, head};
use crate::output::Outputs;
use ::report::certificate_file::{self, CertificateFile, HEAD, InputFile, Inputs};
use ::report::source_map::{LaidMap, SourceMapFile};
use base::source::{SourceFile, SourceId, SourceMap, Span};
use base::units::trim;
use diagnostics::codes::post as codes;
use diagnostics::{Aborted, Diag, Sink, printable};
use ir::Program;
use nc::Post;
use nc::motion_of::{NcMotion, READ_PASS};
use plan::facts;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use verify::Certificate;
use verify::proof::turns::PartnerRounding;

/// Options of a check of NC text.
#[derive(Clone, Debug, Default)]
pub struct NcCheck {
    /// NC text.
    pub nc: PathBuf,
    /// Job that the text must fulfil.
    pub job: Option<PathBuf>,
    /// Certificate that the text must belong to.
    pub certificate: Option<PathBuf>,
    /// Source map of the text, or of the text that it was before it was edited.
    pub source_map: Option<PathBuf>,
    /// Shared options; the dialect is that of the text.
    pub run: RunOptions,
}

/// Largest NC text, bytes.
const MAX_TEXT_BYTES: u64 = 256 << 20;

/// Largest certificate, bytes.
const MAX_CERTIFICATE_BYTES: u64 = 64 << 20;

/// Checks NC text. Faults go to the sink of the outcome; the text of the outcome is the measured certificate.
pub fn verify(check: &NcCheck, stages: &mut Stages) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = run(check, stages, &mut outcome);
    outcome
}

fn run(check: &NcCheck, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Aborted> {
    if check.job.is_none() && check.certificate.is_none() {
        outcome.sink.push(
            Diag::error(codes::USAGE, "neither a job nor a certificate is given")
                .help("add `--job job.imp`, `--certificate part.json`, or both"),
        );
        return Err(Aborted);
    }
    let text = read_nc(&check.nc, &mut outcome.sink)?;
    let file = check.certificate.as_deref().map(|path| read_certificate(path, &mut outcome.sink)).transpose()?;
    let mut report = String::new();
    // Without another word the post file is the one with which the text was written.
    let of_certificate = file.as_ref().and_then(|read| post_of(&read.file.inputs));
    let run = RunOptions { post: check.run.post.clone().or(of_certificate), ..check.run.clone() };
    let program = check.job.as_ref().map(|job| program(&run, job, stages, outcome)).transpose()?;
    let inputs = super::inputs(&outcome.sources);
    let disk = |path: &Path| path.canonicalize().ok();
    let nc = SourceFile { disk: disk(&check.nc), ..SourceFile::text(shown_path(&check.nc), text) };
    let nc = outcome.sources.add_file(nc);
    if let Some(ReadCertificate { shown, text, file }) = &file {
        let belong = Belonging { sources: &outcome.sources, nc, shown, bytes: text, file };
        report.push_str(&belong.check(program.is_some().then_some(&inputs), &mut outcome.sink));
    }
    let map = check.source_map.as_deref().map(|path| read_source_map(path, &mut outcome.sink)).transpose()?;
    let map = map.map(|map| LaidMap::new(map, outcome.sources.get(nc).map_or("", |f| f.text.as_str())));
    if let Some(map) = &map {
        let [lines, known] = map.known();
        report.push_str(&format!("the source map knows {known} of {lines} lines\n"));
    }
    let read = outcome.sink.diags().len();
    let text = CheckedText {
        nc,
        inputs: &inputs,
        map: map.as_ref(),
        certificate: file.as_ref().map(|read| (read.shown.as_str(), &read.file)),
    };
    let measured = program.map(|program| measure(check, &program, &text, stages, outcome)).transpose();
    if let Some(map) = &map {
        let Outcome { sources, sink, .. } = &mut *outcome;
        let mut index = 0;
        sink.change_all(|diag| {
            index += 1;
            if index > read { with_map(diag, map, sources, nc) } else { diag }
        });
    }
    let text = outcome.emitted.take().unwrap_or_default();
    let together = [text, report].into_iter().filter(|t| !t.is_empty()).collect::<Vec<_>>().join("\n");
    outcome.emitted = (!together.is_empty()).then_some(together);
    measured.map(|_| ())
}

/// Name of the post file among the inputs of a certificate.
fn post_of(inputs: &Inputs) -> Option<String> {
    let name = |file: &InputFile| file.name.strip_prefix("posts/")?.strip_suffix(".toml").map(str::to_owned);
    inputs.files.iter().find_map(name)
}

/// The program of the job, on a machine and for a part that a text can be measured with.
pub(super) fn program(
    run: &RunOptions,
    job: &Path,
    stages: &mut Stages,
    outcome: &mut Outcome,
) -> Result<Program, Aborted> {
    let options = Options { job: job.to_path_buf(), run: run.clone(), ..Options::default() };
    let program = front(&options, stages, outcome)?.ok_or(Aborted)?;
    facts::machine_kind::check(&program, &mut outcome.sink)?;
    facts::flat_edges::check(&program, &mut outcome.sink)?;
    Ok(program)
}

/// The NC text with what belongs to it.
struct CheckedText<'a> {
    nc: SourceId,
    inputs: &'a Inputs,
    map: Option<&'a LaidMap>,
    /// Path of a certificate that belongs to the text, and its content.
    certificate: Option<(&'a str, &'a CertificateFile)>,
}

/// Adds to a finding what the source map says of its block.
fn with_map(diag: Diag, map: &LaidMap, sources: &SourceMap, nc: SourceId) -> Diag {
    let block = diag.labels.iter().find(|label| label.span.source == nc);
    let says = block.and_then(|label| map.says(sources.line_column(label.span).0));
    match says {
        Some(says) => diag.note(says),
        None => diag,
    }
}

/// Names the passes of a motion that was read as the source map names them.
fn name_passes(motion: &mut NcMotion, map: &LaidMap) {
    for (made, lines) in motion.motion.operations.iter_mut().zip(&motion.lines) {
        // A line of a subprogram is executed several times.
        let mut executed: BTreeMap<usize, usize> = BTreeMap::new();
        for (m, line) in made.moves.iter().zip(lines) {
            let times = executed.entry(*line).or_default();
            let time = std::mem::replace(times, *times + 1);
            if map.block(*line).is_none_or(|(block, _)| block.kind != "cut") {
                continue;
            }
            // The first cut of a pass names it.
            if let (Some(label), Some(planned)) = (made.labels.get_mut(m.pass as usize), map.pass(*line, time))
                && label.starts_with(READ_PASS)
            {
                *label = format!("{planned}, {label}");
            }
        }
    }
}

/// Measures the text against the job; the measured certificate becomes the text of the outcome.
fn measure(
    check: &NcCheck,
    program: &Program,
    &CheckedText { nc: source, inputs, map, certificate: stated }: &CheckedText<'_>,
    stages: &mut Stages,
    outcome: &mut Outcome,
) -> Result<(), Aborted> {
    let Outcome { sources, sink, emitted, contracts, operations, .. } = outcome;
    let mut outputs = Outputs::default();
    for (what, path) in [("certificate", &check.certificate), ("source map", &check.source_map)] {
        if let Some(path) = path {
            outputs.protect(format!("the {what} `{}`", path.display()), path);
        }
    }
    let mut outputs = or_reported(before_work(outputs, &check.run, &[], sources, program), sink)?;
    let shown = check.nc.display().to_string();
    let text = sources.get(source).map_or("", |f| f.text.as_str());
    // The dialect is that of the command line, or else of the job, unless the text clearly has the words of another
    // dialect.
    let post = find_post(program, sink)?;
    let post = if check.run.post.is_some() { post } else { nc::clearly_other(text, post).unwrap_or(post) };
    let mut motion = stages.run("read NC", || read_motion(post, program, sources, source, sink))?;
    if let Some(map) = map {
        name_passes(&mut motion, map);
    }
    let known = sink.diags().len();
    let fits = verify::memory::check(program, &motion.motion, sink);
    let mut stock = Vec::from_iter(rest_stock::at_start(program).filter(|_| check.run.report.is_some()));
    let stages_wanted = check.run.report.is_some().then_some(&mut stock);
    let request = rest_stock::StockRequest {
        cell: check.run.stock_cell.or_else(|| cell_of_certificate(program, stated?.1)),
        usual: verify::stock::usual_cell(&program.stock.profile),
        folder: check.run.stock.as_deref(),
        outputs: &mut outputs,
        stages: stages_wanted,
    };
    let names = rest_stock::names(program, &motion.motion);
    let certificate = fits.and_then(|()| {
        stages.watched("verify", |progress| {
            rest_stock::simulated(request, &names, sink, |settings, sink| {
                settings.rounding = PartnerRounding::of_words(&program.post.control);
                verify::certify_with(program, &motion.motion, settings, progress, sink)
            })
        })
    });
    let mut index = 0;
    sink.change_all(|diag| {
        index += 1;
        if index > known { with_line(diag, program, &motion, sources, source, &shown) } else { diag }
    });
    let certificate = certificate?;
    contracts.clone_from(&certificate.contracts);
    *operations = judged_operations(program, &certificate);
    let mut compared = head::compare(program, &certificate, post, inputs, sources, source, sink);
    if let Some((path, file)) = stated {
        if check.run.stock_cell.is_none() {
            refuse_cells(path, file, program, sink);
        }
        compared.push_str(compare_figures(path, file, &certificate, sink));
        compare_conditions(path, file, post, program, sink);
    }
    let nc = sources.get(source).map_or("", |f| f.text.as_str());
    let shown = report::Shown {
        program,
        motion: &motion.motion,
        certificate: &certificate,
        notes: &[],
        stock: &stock,
        nc: check.run.report.as_ref().map(|_| report::NcLines::read(&motion, nc)),
        post: post.name(),
        hash: &inputs.sha256,
    };
    let html = check.run.report.as_ref().map(|_| report::html(&shown, stages, sink));
    let file = check.run.report.as_deref().zip(html.as_deref());
    let file = file.map(|(path, html)| ("--report", path, html.as_bytes()));
    or_reported(save(outputs, file.into_iter()), sink)?;
    let text = certificate_text::text(&check.run, &shown, Some(&check.nc), sources, sink);
    *emitted = Some(text + &done(check, &motion, post, &compared));
    Ok(())
}

/// The cells of the stock of a certificate, mm, so that its figures can be compared: unless they are much finer or coarser than
/// those of this check, which could not be simulated here, or would show nothing.
fn cell_of_certificate(program: &Program, file: &CertificateFile) -> Option<f64> {
    let usual = verify::stock::default_cell(program);
    let taken = usual / MAX_TIMES_FINER..=usual * MAX_TIMES_COARSER;
    certificate_figures::cell(&file.measured).filter(|cell| taken.contains(cell))
}

/// Refuses a certificate whose stock this check does not simulate as it was simulated there.
fn refuse_cells(shown: &str, file: &CertificateFile, program: &Program, sink: &mut Sink) {
    let stated = certificate_figures::cell(&file.measured);
    let Some(cell) = stated.filter(|_| cell_of_certificate(program, file).is_none()) else { return };
    let default = verify::stock::default_cell(program);
    sink.push(
        Diag::error(
            codes::CERTIFICATE_FIGURES,
            format!(
                "{shown} has stock in cells of {cell} mm, where {} mm are the default: its stock is not compared",
                trim(default, 4)
            ),
        )
        .help(format!("state `--stock-cell {cell}` where the job was compiled so")),
    );
}

/// How many times finer and coarser than the default the cells of a certificate may be.
const MAX_TIMES_FINER: f64 = 2.0;
const MAX_TIMES_COARSER: f64 = 16.0;

/// What was read, compared and written, in lines.
fn done(check: &NcCheck, motion: &NcMotion, post: &dyn Post, compared: &str) -> String {
    let moves: usize = motion.lines.iter().map(Vec::len).sum();
    let mut text = format!("\n{}: {moves} moves read as {}\n{compared}", shown_path(&check.nc), post.name());
    text.push_str(&meshes_written(&check.run, &motion.motion));
    if let Some(path) = &check.run.report {
        text.push_str(&format!("wrote {}\n", shown_path(path)));
    }
    text
}

/// A certificate that a text is compared with.
struct Belonging<'a> {
    sources: &'a SourceMap,
    nc: SourceId,
    /// Path of the certificate.
    shown: &'a str,
    bytes: &'a str,
    file: &'a CertificateFile,
}

impl Belonging<'_> {
    /// Whether body, head, compiler and inputs are those of the certificate. Returns a text that says so, or reports
    /// the differences to the sink.
    fn check(&self, inputs: Option<&Inputs>, sink: &mut Sink) -> String {
        let Self { shown, file, .. } = *self;
        let Some(text) = self.sources.get(self.nc) else { return String::new() };
        let of_text = certificate_file::sha256(certificate_file::body(&text.text).1.as_bytes());
        let mut differences = Vec::new();
        differences.extend(self.other_body(&text.text, &of_text));
        differences.extend(self.other_head(&text.text));
        differences.extend(self.nameless_head(&text.text));
        differences.extend(self.other_hashes(&text.text, &of_text));
        differences.extend(self.other_inputs(inputs));
        if !differences.is_empty() {
            for diag in differences {
                sink.push(diag.help(
                    "measure the text again with `impellerc verify part.nc --job job.imp`, or compile the job again to write both files",
                ));
            }
            return String::new();
        }
        format!(
            "{} and {} belong together: {} lines, body sha256 {}, inputs sha256 {}, {}{}\n",
            printable(&text.name),
            printable(shown),
            file.nc.body_lines,
            file.nc.body_sha256,
            file.inputs.sha256,
            file.compiler,
            if inputs.is_some() { "; job and library are those of the certificate" } else { "" }
        )
    }

    /// The span of a line of the NC text.
    fn line(&self, line: usize) -> Span {
        self.sources.line_span(self.nc, line).unwrap_or(Span::new(self.nc, 0..0))
    }

    /// The first lines of the body that differ from the body of the certificate; `of_text` is the hash of the body.
    fn other_body(&self, text: &str, of_text: &str) -> Option<Diag> {
        let Self { shown, file, .. } = *self;
        let (first, last, operation) = file.nc.first_difference(text)?;
        let place = operation.map_or(String::new(), |o| format!(", `{o}` in the text of the certificate"));
        let lines = if first == last {
            format!("line {first} is the first that differs")
        } else {
            format!("lines {first} to {last} are the first that differ")
        };
        Some(
            Diag::error(codes::CERTIFICATE_OTHER, format!("{shown} was written for another text: {lines}{place}"))
                .label(self.line(first), "the first difference is here or below")
                .note(format!("body sha256 {} in the certificate", file.nc.body_sha256))
                .note(format!("body sha256 {of_text} of the text"))
                .note(format!(
                    "{} lines in the certificate, {} in the text",
                    file.nc.body_lines,
                    certificate_file::body(text).1.lines().count()
                )),
        )
    }

    /// The first line of the head that differs from the head of the certificate.
    fn other_head(&self, text: &str) -> Option<Diag> {
        let edited = self.file.nc.head_difference(text)?;
        let shown = self.shown;
        Some(
            Diag::error(
                codes::CERTIFICATE_OTHER,
                format!("{shown} was written for another head of the text: line {edited} differs"),
            )
            .label(self.line(edited), "here or below")
            .note("the comments before the first block state tools, zero, machine and figures"),
        )
    }

    /// The hashes that are missing in the head.
    fn nameless_head(&self, text: &str) -> Option<Diag> {
        let missing = HEAD.into_iter().filter(|word| certificate_file::named(text, word).is_none());
        let missing: Vec<&str> = missing.map(str::trim).collect();
        (!missing.is_empty()).then(|| {
            Diag::error(codes::CERTIFICATE_OTHER, format!("the head of the text lacks {}", missing.join(", ")))
                .label(self.line(1), "in the comments from here on")
                .note("without these hashes an edited certificate cannot be recognised")
        })
    }

    /// The hashes in the head that differ from those of body, certificate and inputs.
    fn other_hashes(&self, text: &str, of_text: &str) -> Vec<Diag> {
        let Self { shown, bytes, file, .. } = *self;
        let [of_inputs, of_body, of_certificate] = HEAD;
        let own = certificate_file::sha256(bytes.as_bytes());
        let other = |word: &str, due: &str| certificate_file::named(text, word).filter(|named| **named != *due);
        let differs = |message: String| {
            Diag::error(codes::CERTIFICATE_OTHER, message).label(self.line(1), "in the comments from here on")
        };
        let body = other(of_body, of_text).map(|other| {
            differs("the text was edited: its hash differs from the one in its head".to_owned())
                .note(format!("body sha256 {other} in the head"))
                .note(format!("body sha256 {of_text} of the text"))
        });
        let certificate = other(of_certificate, &own).map(|other| {
            differs(format!("the head of the text names another certificate than {shown}"))
                .note(format!("certificate sha256 {other} in the head"))
                .note(format!("certificate sha256 {own} of the file: it was edited, or is from another run"))
        });
        let inputs = other(of_inputs, &file.inputs.sha256).map(|other| {
            differs("the text was made from other inputs than the certificate".to_owned())
                .note(format!("inputs sha256 {other} in the head"))
                .note(format!("inputs sha256 {} in the certificate", file.inputs.sha256))
        });
        [body, certificate, inputs].into_iter().flatten().collect()
    }

    /// The inputs that differ from those with which the certificate was made.
    fn other_inputs(&self, now: Option<&Inputs>) -> Option<Diag> {
        let Self { shown, file, .. } = *self;
        let changed = file.inputs.differences(now?);
        let message = format!("{shown} was made from another job or library than the given one");
        let diag = Diag::error(codes::CERTIFICATE_OTHER, message);
        (!changed.is_empty()).then(|| changed.into_iter().fold(diag, Diag::note))
    }
}

/// Difference of a figure that the digits of the words explain: absolute, and as a share of the figure.
const FIGURE_ROUNDING: (f64, f64) = (1e-3, 1e-3);

/// Largest absolute difference as a share of the bound of the contract.
const OF_BOUND: f64 = 0.1;

/// Compares dialect and conditions that a certificate states with those of the text.
fn compare_conditions(shown: &str, file: &CertificateFile, post: &dyn Post, program: &Program, sink: &mut Sink) {
    let help = "compile the job again, and do not rely on an edited certificate";
    if file.nc.post != post.name() {
        let text =
            format!("{shown} is that of a text in {}; the text was read as {}", printable(&file.nc.post), post.name());
        sink.push(Diag::error(codes::CERTIFICATE_FIGURES, text).help(help));
        return;
    }
    let due = nc::assumptions(post, program);
    let [missing, more] = [(&due, &file.nc.assumed), (&file.nc.assumed, &due)]
        .map(|(all, other)| all.iter().find(|line| !other.contains(line)));
    let text = match (missing, more) {
        (Some(line), _) => format!("{shown} does not state the condition `{line}` of the proof"),
        (None, Some(line)) => {
            format!("{shown} states the condition `{}`, which the proof does not have", printable(line))
        }
        (None, None) => return,
    };
    sink.push(Diag::error(codes::CERTIFICATE_FIGURES, text).help(help));
}

/// Compares contracts and figures of a certificate with those measured on the text. Returns a text that says what was compared.
fn compare_figures(shown: &str, file: &CertificateFile, measured: &Certificate, sink: &mut Sink) -> &'static str {
    let says = certificate_file::contracts(&file.measured).unwrap_or_default();
    let measured = serde_json::to_value(measured).unwrap_or_default();
    let compared = if certificate_figures::same_cells(&file.measured, &measured) {
        certificate_figures::COMPARED
    } else {
        certificate_figures::OTHER_CELLS
    };
    if let Some((text, others)) = certificate_figures::difference(&file.measured, &measured) {
        sink.push(
            Diag::error(codes::CERTIFICATE_FIGURES, format!("{shown} {text}"))
                .note(format!("{others} other figures differ too"))
                .help("compile the job again, and do not rely on an edited certificate"),
        );
    }
    let Some(found) = certificate_file::contracts(&measured) else {
        sink.push(
            Diag::error(codes::CERTIFICATE_FIGURES, "a contract measured on the text has no figure to compare")
                .help("do not rely on this certificate: the text cannot be measured"),
        );
        return compared;
    };
    for (kind, bound, value, _) in says.iter().skip(found.len()) {
        sink.push(
            Diag::error(
                codes::CERTIFICATE_FIGURES,
                format!("{shown} states {kind} of {value} for {bound}; the job has no such contract"),
            )
            .help("compile the job again, and do not rely on an edited certificate"),
        );
    }
    for (k, (kind, bound, value, holds)) in found.iter().enumerate() {
        let same = says.get(k).is_some_and(|(kind_said, bound_said, value_said, holds_said)| {
            kind_said == kind
                && bound_said == bound
                && holds_said == holds
                && (value_said - value).abs()
                    <= FIGURE_ROUNDING.0.min(OF_BOUND * bound) + FIGURE_ROUNDING.1 * value.abs()
        });
        if !same {
            let said = says.get(k).map_or("no such contract".to_owned(), |s| format!("{} of {} for {}", s.0, s.2, s.1));
            sink.push(
                Diag::error(
                    codes::CERTIFICATE_FIGURES,
                    format!("{shown} states {said}; measured on the text is {kind} of {value} for {bound}"),
                )
                .help("compile the job again, and do not rely on an edited certificate"),
            );
        }
    }
    compared
}

/// A certificate that was read.
struct ReadCertificate {
    /// Its path, as messages show it.
    shown: String,
    text: String,
    file: CertificateFile,
}

fn read_certificate(path: &Path, sink: &mut Sink) -> Result<ReadCertificate, Aborted> {
    let shown = path.display().to_string();
    let due = "give the JSON file that `--certificate` wrote beside the NC text";
    let broken =
        |reason: &str| Diag::error(codes::CERTIFICATE_FORM, format!("{shown} is not a known certificate: {reason}"));
    let diag = match reading::read(path, MAX_CERTIFICATE_BYTES).map(|bytes| bytes.map(String::from_utf8)) {
        Ok(Some(Ok(text))) => match CertificateFile::read(&text) {
            Ok(file) => return Ok(ReadCertificate { shown, text, file }),
            Err(reason) => broken(&reason).help(due),
        },
        Ok(Some(Err(error))) => {
            broken(&format!("it is not text: byte {} is not UTF-8", error.utf8_error().valid_up_to())).help(due)
        }
        Ok(None) => broken(&format!("it is larger than {} MB", MAX_CERTIFICATE_BYTES >> 20)).help(due),
        Err(error) => reading::unreadable(path, &error, due),
    };
    sink.push(diag);
    Err(Aborted)
}

/// The motion that a text commands.
pub(super) fn read_motion(
    post: &dyn Post,
    program: &Program,
    sources: &SourceMap,
    source: SourceId,
    sink: &mut Sink,
) -> Result<NcMotion, Aborted> {
    let text = sources.get(source).map_or("", |f| f.text.as_str());
    let span = |line: usize| sources.line_span(source, line).unwrap_or(Span::new(source, 0..0));
    nc::judge(post, program, text, &span, sink).map(|commands| commands.motion).ok_or(Aborted)
}

/// Puts a label at the NC block of a finding first, and adds a label at the operation in the job.
fn with_line(
    mut diag: Diag,
    program: &Program,
    motion: &NcMotion,
    sources: &SourceMap,
    source: SourceId,
    shown: &str,
) -> Diag {
    let Some((operation, index)) = diag.place.as_ref().and_then(|p| p.block) else { return diag };
    let Some(line) = motion.line(operation, index) else { return diag };
    if let Some(place) = &mut diag.place {
        place.what = format!("{shown} line {line}: {}", place.what);
    }
    if let Some(made) = motion.motion.operations.get(operation as usize) {
        let span = program.operations[made.operation].span;
        if diag.labels.iter().all(|l| l.span != span) {
            diag = diag.label(span, "in this operation");
        }
    }
    if let Some(span) = sources.line_span(source, line) {
        let label = diagnostics::Label { span, text: "this block".to_owned() };
        diag.labels.insert(0, label);
    }
    diag
}

/// The source map of a file.
fn read_source_map(path: &Path, sink: &mut Sink) -> Result<SourceMapFile, Aborted> {
    let due = "give the file that `--source-map` wrote together with the NC text";
    let diag = match reading::read(path, MAX_TEXT_BYTES).map(|bytes| bytes.map(String::from_utf8)) {
        Ok(Some(Ok(text))) => match SourceMapFile::read(&text) {
            Ok(map) => return Ok(map),
            Err(reason) => Diag::error(codes::SOURCE_MAP, format!("{}: {reason}", path.display())).help(due),
        },
        Ok(Some(Err(_))) => Diag::error(codes::SOURCE_MAP, format!("{} is not a text file", path.display())).help(due),
        Ok(None) => {
            Diag::error(codes::SOURCE_MAP, format!("{} has more than {} MB", path.display(), MAX_TEXT_BYTES >> 20))
                .help(due)
        }
        Err(error) => reading::unreadable(path, &error, due),
    };
    sink.push(diag);
    Err(Aborted)
}

/// The NC text.
pub(super) fn read_nc(path: &Path, sink: &mut Sink) -> Result<String, Aborted> {
    let shown = path.display();
    let due = "give the NC text that the control would run";
    let diag = match reading::read(path, MAX_TEXT_BYTES).map(|bytes| bytes.map(String::from_utf8)) {
        Ok(Some(Ok(text))) if certificate_file::body(&text).1.trim().is_empty() => {
            Diag::error(codes::NC_FILE, format!("{shown} has no block: it is empty or contains only comments"))
                .help(due)
        }
        Ok(Some(Ok(text))) => return Ok(text),
        Ok(Some(Err(error))) => {
            let valid = error.utf8_error().valid_up_to();
            let line = error.as_bytes().iter().take(valid).filter(|b| **b == b'\n').count() + 1;
            Diag::error(codes::NC_FILE, format!("{shown} is not a text file: line {line} is not UTF-8")).help(due)
        }
        Ok(None) => Diag::error(codes::NC_FILE, format!("{shown} is larger than {} MB", MAX_TEXT_BYTES >> 20))
            .help("divide the program by operations, or use fewer digits or comments"),
        Err(error) => reading::unreadable(path, &error, due),
    };
    sink.push(diag);
    Err(Aborted)
}
