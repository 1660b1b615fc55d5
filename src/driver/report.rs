//! Writing the report: gathers what the stages made.

use super::stages::Stages;
use crate::diag::{Aborted, Sink};
use crate::export::report::{self, Input};
use crate::ir::{ClPlan, Motion, Program};
use crate::output;
use crate::post::NcProgram;
use crate::verify::Certificate;
use std::path::Path;

/// What a run has to show, whether its NC was accepted or not.
pub(super) struct Shown<'a> {
    pub(super) program: &'a Program,
    pub(super) motion: &'a Motion,
    pub(super) certificate: &'a Certificate,
    pub(super) cl: &'a ClPlan,
    /// NC text by lines; `None` when a fault stopped it.
    pub(super) nc: Option<&'a NcProgram>,
    pub(super) post: &'a str,
    pub(super) hash: &'a str,
}

/// Writes the report whole or not at all.
///
/// # Errors
/// A path that cannot be written; the reason is in the sink.
pub(super) fn write(path: &Path, shown: &Shown<'_>, stages: &mut Stages, sink: &mut Sink) -> Result<(), Aborted> {
    let (samples, deviations) =
        stages.run("deviations", || report::deviations(shown.program, shown.motion, shown.certificate.spacing));
    let lines = shown.nc.map(line_sources).unwrap_or_default();
    let name = |operation| shown.program.operations[operation].name.clone();
    let notes: Vec<(String, String)> =
        shown.cl.operations.iter().flat_map(|o| o.notes.iter().map(move |n| (name(o.operation), n.clone()))).collect();
    let html = stages.run("report", || {
        report::report(&Input {
            program: shown.program,
            motion: shown.motion,
            certificate: shown.certificate,
            samples: &samples,
            deviations: &deviations,
            findings: sink.diags(),
            hash: shown.hash,
            post: shown.post,
            nc_lines: shown.nc.map(|nc| nc.lines.len()),
            lines: &lines,
            notes: &notes,
            stock: &[],
            removal: None,
        })
    });
    output::write_whole(path, html.as_bytes()).map_err(|d| sink.push(d)).map_err(|()| Aborted)
}

/// Operation, move and line (from 1) of every line that says a move.
fn line_sources(nc: &NcProgram) -> Vec<(u32, u32, u32)> {
    let numbered = nc.lines.iter().zip(1..);
    numbered.filter_map(|(line, number)| line.source.map(|(operation, index)| (operation, index, number))).collect()
}
