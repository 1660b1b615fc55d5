//! Writes the report from the values of the stages.

use super::stages::Stages;
use ::report::report::{self, Input, StockStage};
use diagnostics::Sink;
use ir::{ClPlan, Motion, Program};
use nc::NcProgram;
use nc::motion_of::NcMotion;
use verify::Certificate;

/// Content of the report of a run, whether its NC was accepted or not.
pub(super) struct Shown<'a> {
    pub(super) program: &'a Program,
    pub(super) motion: &'a Motion,
    pub(super) certificate: &'a Certificate,
    /// Operation, and a decision of its planning.
    pub(super) notes: &'a [(String, String)],
    /// Stock after each operation.
    pub(super) stock: &'a [StockStage],
    /// The NC text and the lines of its moves; `None` when a fault prevented the text.
    pub(super) nc: Option<NcLines<'a>>,
    pub(super) post: &'a str,
    pub(super) hash: &'a str,
}

/// The report as a text.
pub(super) fn html(shown: &Shown<'_>, stages: &mut Stages, sink: &Sink) -> String {
    stages.run("report", || {
        let (samples, deviations) = report::deviations(shown.program, shown.certificate);
        report::report(&Input {
            program: shown.program,
            motion: shown.motion,
            certificate: shown.certificate,
            samples: &samples,
            deviations: &deviations,
            findings: sink.diags(),
            hash: shown.hash,
            post: shown.post,
            nc_text: shown.nc.as_ref().map(|nc| nc.text),
            lines: shown.nc.as_ref().map_or(&[], |nc| &nc.moves),
            notes: shown.notes,
            stock: shown.stock,
        })
    })
}

/// Lines of the moves in NC text.
pub(super) struct NcLines<'a> {
    /// The text.
    pub(super) text: &'a str,
    /// Operation, move and line (from 1), in order.
    pub(super) moves: Vec<(u32, u32, u32)>,
}

impl<'a> NcLines<'a> {
    /// Lines of a program that was written.
    pub(super) fn written(nc: &NcProgram, text: &'a str) -> Self {
        let mut moves = Vec::with_capacity(nc.lines.len());
        for (line, number) in nc.lines.iter().zip(1..) {
            let Some((operation, index)) = line.source else { continue };
            moves.push((operation, index, number));
            // A line of a subprogram makes several moves.
            moves.extend(line.again.iter().map(|index| (operation, *index, number)));
        }
        moves.sort_unstable();
        Self { text, moves }
    }

    /// Lines of a text that was read.
    pub(super) fn read(nc: &NcMotion, text: &'a str) -> Self {
        let number = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let of = |o: usize, lines: &[usize]| -> Vec<(u32, u32, u32)> {
            lines.iter().enumerate().map(|(i, line)| (number(o), number(i), number(*line))).collect()
        };
        Self { text, moves: nc.lines.iter().enumerate().flat_map(|(o, lines)| of(o, lines)).collect() }
    }
}

/// Decisions of planning by operation.
pub(super) fn notes(program: &Program, cl: &ClPlan) -> Vec<(String, String)> {
    let name = |operation| program.operations[operation].name.clone();
    cl.operations.iter().flat_map(|o| o.notes.iter().map(move |n| (name(o.operation), n.clone()))).collect()
}
