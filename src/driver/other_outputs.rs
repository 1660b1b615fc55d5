//! Outputs of a compilation beside the NC text, a row each: option, help, form of the file, and what makes its bytes.

use super::file_form::Form;
use super::written::{SHOWN_HASH, Written, restarts};
use ::report::certificate_file::{self, sha256};
use ::report::picture;
use ::report::setup_sheet::{self, SheetInput};
use ::report::source_map::{SourceMapFile, WrittenLine};
use base::source::{SourceMap, Span};
use diagnostics::codes::files;
use diagnostics::{Diag, printable};
use ir::{Motion, Program};
use nc::Post;
use std::path::{Path, PathBuf};
use verify::Verified;
use verify::certificate::Certificate;

/// A program that was accepted, with its NC text.
pub(super) struct Accepted<'a> {
    pub(super) program: &'a Program,
    pub(super) motion: &'a Verified<Motion>,
    pub(super) certificate: &'a Certificate,
    pub(super) post: &'a dyn Post,
    /// Files of the library that the job uses, a line each.
    pub(super) library: &'a [String],
    pub(super) sources: &'a SourceMap,
    /// File of the NC text.
    pub(super) output: Option<&'a Path>,
    pub(super) written: &'a Written,
}

/// An output beside the NC text.
#[derive(Debug)]
pub struct Output {
    /// Its option on the command line, with both hyphens; what follows them is its name.
    pub flag: &'static str,
    /// Name of the file in the help.
    pub value: &'static str,
    /// What the option does.
    pub help: &'static str,
    pub(super) form: Form,
    /// Bytes of the file with a path.
    pub(super) make: fn(&Accepted<'_>, &Path) -> Result<Vec<u8>, Diag>,
}

/// The outputs beside the NC text, in the order in which they are written.
pub const OUTPUTS: &[Output] = &[
    Output {
        flag: "--certificate",
        value: "FILE.json",
        help: "Write the certificate to this file, with the hash of the NC text",
        form: Form::Json,
        make: |accepted, _| Ok(accepted.written.certificate.clone().into_bytes()),
    },
    Output {
        flag: "--picture",
        value: "FILE.png",
        help: "Write a picture of the part and the paths to this file",
        form: Form::Picture,
        make: |accepted, _| Ok(picture::picture(accepted.program, accepted.motion)),
    },
    Output {
        flag: "--source-map",
        value: "FILE.json",
        help: "Write the source map to this file: of each block the cutter location, pass, operation and line of the job",
        form: Form::Json,
        make: |accepted, _| source_map(accepted).map(String::into_bytes),
    },
    Output {
        flag: "--setup-sheet",
        value: "FILE.html",
        help: "Write the setup sheet to this file: zero, tools, restart points, checks before the first run; HTML or Markdown",
        form: Form::Sheet,
        make: |accepted, path| Ok(setup_sheet(accepted, path).into_bytes()),
    },
];

/// An output that a compilation writes, and its file.
#[derive(Clone, Debug)]
pub struct OutputFile {
    /// The output.
    pub output: &'static Output,
    /// Its file.
    pub path: PathBuf,
}

impl OutputFile {
    /// The output with an option, such as `--picture`, and its file; `None` where there is no such output.
    pub fn new(flag: &str, path: impl Into<PathBuf>) -> Option<Self> {
        OUTPUTS.iter().find(|output| output.flag == flag).map(|output| Self { output, path: path.into() })
    }
}

/// Text of the setup sheet: HTML where the name of its file ends so, otherwise Markdown.
fn setup_sheet(accepted: &Accepted<'_>, path: &Path) -> String {
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

/// Text of the source map.
fn source_map(accepted: &Accepted<'_>) -> Result<String, Diag> {
    let &Accepted { program, motion, sources, written, .. } = accepted;
    let line_of = |span: Span| sources.line_column(span).0;
    let lines = written.nc.lines.iter().map(|line| {
        let frame = line.frame.and_then(|span| Some((sources.get(span.source)?.name.as_str(), line_of(span))));
        WrittenLine { text: &line.text, source: line.source, again: &line.again, frame }
    });
    let job = sources.files().first().map(|file| file.own_name()).unwrap_or_default();
    SourceMapFile::new(program, motion, &job, line_of, lines).json().map_err(|reason| {
        Diag::error(files::INTERNAL, format!("the source map cannot be written: {reason}"))
            .help("report the job file: this is a fault of the compiler")
    })
}
