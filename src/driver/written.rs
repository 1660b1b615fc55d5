//! What a run writes: NC text and certificate, each with the hash of the other, and what stands beside them; all files or none.

use super::beside::Accepted;
use super::{Options, RunOptions, Stages, head, inputs, or_reported, report, shown_path};
use crate::nc_text;
use crate::output::Outputs;
use ::report::certificate_file::{self, CertificateFile, HEAD, Inputs, NcText, OperationLines, sha256};
use ::report::setup_sheet::{self, SheetInput};
use ::report::source_map::{SourceMapFile, WrittenLine};
use base::source::Span;
use diagnostics::codes::files;
use diagnostics::{Aborted, Diag, Sink, printable};
use ir::{Motion, Program};
use nc::{NcProgram, Post};
use std::path::{Path, PathBuf};
use verify::Verified;
use verify::certificate::Certificate;

/// Outputs of a program that was accepted.
pub(super) struct Written {
    pub(super) nc: NcProgram,
    /// The NC text.
    pub(super) text: String,
    /// Text of the certificate.
    pub(super) certificate: String,
}

impl Written {
    /// The NC program and its certificate, each with the hash of the other.
    pub(super) fn new(
        program: &Program,
        motion: &Verified<Motion>,
        certificate: &Certificate,
        post: &dyn Post,
        (inputs, library): (Inputs, &[String]),
    ) -> Result<Self, Diag> {
        let head = head::lines(program, certificate, post, (&inputs, library));
        let mut nc = nc_text::write(post, program, motion, &head);
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
        Ok(Self { text: nc.text(), nc, certificate })
    }

    /// Writes every file that the options require. Returns a text that names the files.
    pub(super) fn save(
        &self,
        options: &Options,
        accepted: &Accepted<'_>,
        shown: report::Shown<'_>,
        mut outputs: Outputs,
        stages: &mut Stages,
        sink: &mut Sink,
    ) -> Result<String, Aborted> {
        let Options { output, beside, run, .. } = options;
        if let Some(path) = output {
            or_reported(outputs.stage("-o", path, self.text.as_bytes()), sink)?;
        }
        for file in beside {
            let name = file.output.flag.trim_start_matches('-');
            let bytes = or_reported(stages.run(name, || (file.output.make)(accepted, &file.path)), sink)?;
            or_reported(outputs.stage(file.output.flag, &file.path, &bytes), sink)?;
        }
        let motion = shown.motion;
        if let Some(path) = &run.report {
            let shown = report::Shown { nc: Some(report::NcLines::written(&self.nc, &self.text)), ..shown };
            let html = report::html(&shown, stages, sink);
            or_reported(outputs.stage("--report", path, html.as_bytes()), sink)?;
        }
        or_reported(stages.run("save", || outputs.commit()), sink)?;

        let mut said = match output {
            Some(path) => format!("wrote {}: {} lines\n", shown_path(path), self.text.lines().count()),
            None => "no NC text written: no `-o FILE`\n".to_owned(),
        };
        said.push_str(&meshes_written(run, motion));
        for path in beside.iter().map(|file| &file.path).chain(&run.report) {
            said.push_str(&format!("wrote {}\n", shown_path(path)));
        }
        Ok(said)
    }
}

/// First line of each operation in the text.
pub(super) fn restarts(program: &Program, nc: &NcProgram) -> Vec<usize> {
    let [_, _, start, ..] = &program.post.frames;
    let begins = |line: &nc::NcLine| line.frame.is_some_and(|span| start.iter().any(|t| t.span == span));
    let stations = nc.lines.iter().enumerate().filter(|(_, line)| matches!(line.source, Some((_, 0))));
    stations.map(|(at, _)| at + 1 - nc.lines[..=at].iter().rev().take_while(|line| begins(line)).count() + 1).collect()
}

/// Text of the setup sheet: HTML where the name of its file ends so, otherwise Markdown.
pub(super) fn setup_sheet(accepted: &Accepted<'_>, path: &Path) -> String {
    let &Accepted { program, certificate, post, library, written, .. } = accepted;
    let file = accepted.output.and_then(Path::file_name);
    let file =
        file.map_or_else(|| "not written".to_owned(), |name| printable(&name.display().to_string()).into_owned());
    let body = sha256(certificate_file::body(&written.text).1.as_bytes());
    let input = SheetInput {
        program,
        certificate,
        post: post.name(),
        library,
        assumptions: &nc::assumptions(post, program),
        nc: (&file, written.nc.lines.len(), &body[..SHOWN_HASH]),
        restarts: &restarts(program, &written.nc),
    };
    let html = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm"));
    if html { setup_sheet::html(input) } else { setup_sheet::markdown(input) }
}

/// Digits of a hash that people compare.
pub(super) const SHOWN_HASH: usize = 16;

/// Text of the source map.
pub(super) fn source_map(accepted: &Accepted<'_>) -> Result<String, Diag> {
    let &Accepted { program, motion, sources, written, .. } = accepted;
    let line_of = |span: Span| sources.line_column(span).0;
    let lines = written.nc.lines.iter().map(|line| {
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

/// Lines of the operations in the text: those of their moves with the transformation on.
pub(super) fn operation_lines(program: &Program, motion: &Motion, nc: &NcProgram) -> Vec<OperationLines> {
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

/// Writes the report and the meshes of a program that was refused: they show why. Returns a text about what it wrote.
pub(super) fn save_refused(
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

/// Text that the stock after each operation was written, where the options require it.
pub(super) fn meshes_written(run: &RunOptions, motion: &Motion) -> String {
    let line = |folder: &PathBuf| format!("wrote {}: {} meshes\n", shown_path(folder), motion.operations.len());
    run.stock.as_ref().map(line).unwrap_or_default()
}

/// Writes files together with those that are staged already, all or none.
pub(super) fn save<'a>(
    mut outputs: Outputs,
    files: impl Iterator<Item = (&'a str, &'a Path, &'a [u8])>,
) -> Result<(), Diag> {
    for (flag, path, bytes) in files {
        outputs.stage(flag, path, bytes)?;
    }
    outputs.commit()
}
