//! Findings from the simulated stock.

use super::{StockReport, below_surface, load};
use crate::diag::{Diag, Sink, codes::verification};
use crate::ir::{Motion, Program};
use crate::units::length;
use crate::verify::place::describe;
use nalgebra::Point3;

/// Reports missing stock inside of the finished part as an error.
fn report_missing(program: &Program, motion: &Motion, stock: &StockReport, sink: &mut Sink) {
    let Some(missing) = &stock.missing else { return };
    let Some(operation) = motion.operations.get(missing.operation as usize) else { return };
    let declared = &program.operations[operation.operation];
    sink.push(
        Diag::error(
            verification::PART_CUT,
            format!(
                "after {} {:.1} mm3 of the hub disc are gone, more than {} below its surface",
                declared.name,
                missing.volume,
                length(below_surface(program))
            ),
        )
        .label(declared.span, "in this operation")
        .place(declared.name.clone(), Point3::from(missing.point))
        .note(format!(
            "by the simulated stock, whose rays lie {} mm apart; the proofs of the surfaces are apart from it",
            stock.cell
        ))
        .help("leads, links and passes that stay out of the part"),
    );
}

/// Reports collisions as errors: one for each operation and part of the tool, with the deepest place.
pub fn report(program: &Program, motion: &Motion, stock: &StockReport, sink: &mut Sink) {
    report_missing(program, motion, stock, sink);
    for o in &stock.operations {
        let Some(operation) = motion.operations.get(o.operation as usize) else { continue };
        let declared = &program.operations[operation.operation];
        let solid = &program.tools[declared.tool].solid;
        load::report(program, motion, o, sink);
        for part in ["cutter at rapid", "shank", "holder"] {
            let all = o.collisions.iter().filter(|c| c.part == part);
            let Some(worst) = all.clone().max_by(|a, b| a.depth.total_cmp(&b.depth)) else { continue };
            let count = all.count();
            let depth = length(worst.depth);
            let first = solid.shank.first().map_or(f64::INFINITY, |s| s.to);
            let (code, text, help) = match part {
                "cutter at rapid" => (
                    verification::RAPID_THROUGH_STOCK,
                    format!("at rapid the cutter is {depth} deep in stock that is still there"),
                    "a longer lead-in or lead-out, or an operation before that clears the way",
                ),
                "shank" if worst.height < first => (
                    verification::ABOVE_FLUTES,
                    format!(
                        "the shank above the {} mm of flutes is {depth} deep in stock that is still there",
                        solid.flute_length
                    ),
                    "longer flutes, a relieved shank, a smaller `depth`, or an operation before that opens the way",
                ),
                _ => (
                    verification::BODY_IN_STOCK,
                    format!("the {part} is {depth} deep in stock that is still there"),
                    "a longer reach, a slimmer holder, or an operation before that opens the way",
                ),
            };
            let diag = Diag::error(code, text)
                .label(declared.span, "in this operation")
                .place(describe(program, motion, Some(worst.at)), Point3::from(worst.point))
                .block(worst.at.operation, worst.at.index)
                .note(format!("{count} moves of it do; this is the deepest, {:.2} mm over the tip", worst.height))
                .help(help);
            sink.push(diag);
        }
    }
}
