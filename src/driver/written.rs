//! What a run writes: NC text and certificate, each with the hash of the other, and what stands beside them; all files or none.

use super::head;
use crate::nc_text;
use ::report::certificate_file::{self, CertificateFile, HEAD, Inputs, NcText, OperationLines, sha256};
use diagnostics::Diag;
use diagnostics::codes::files;
use ir::{Motion, Program};
use nc::{NcProgram, Post};
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
        inputs: Inputs,
        library: &[String],
    ) -> Result<Self, Diag> {
        let head = head::lines(program, certificate, post, &inputs, library);
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
}

/// First line of each operation in the text.
pub(super) fn restarts(program: &Program, nc: &NcProgram) -> Vec<usize> {
    let [_, _, start, ..] = &program.post.frames;
    let begins = |line: &nc::NcLine| line.frame.is_some_and(|span| start.iter().any(|t| t.span == span));
    let stations = nc.lines.iter().enumerate().filter(|(_, line)| matches!(line.source, Some((_, 0))));
    stations.map(|(at, _)| at + 1 - nc.lines[..=at].iter().rev().take_while(|line| begins(line)).count() + 1).collect()
}

/// Digits of a hash that people compare.
pub(super) const SHOWN_HASH: usize = 16;

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
