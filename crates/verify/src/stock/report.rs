//! Findings from the simulated stock.

use super::{StockReport, below_surface, load};
use crate::place::describe;
use base::units::length;
use diagnostics::{Diag, Sink, codes::verification};
use ir::{Motion, Program};
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
                "after {}, {:.1} mm3 of the hub disc are missing deeper than {} below its surface",
                declared.name,
                missing.volume.get(),
                length(below_surface(program))
            ),
        )
        .label(declared.span, "in this operation")
        .place(declared.name.clone(), Point3::from(missing.point))
        .note(format!(
            "measured on the simulated stock with rays {} mm apart; the proofs of the surfaces are independent of it",
            stock.cell.get()
        ))
        .help("use leads, links and passes that stay outside the part"),
    );
}

/// Reports collisions as errors: one for each operation and part of the tool, with the deepest place.
pub fn report(program: &Program, motion: &Motion, stock: &StockReport, sink: &mut Sink) {
    report_missing(program, motion, stock, sink);
    for o in &stock.operations {
        let Some(operation) = motion.operations.get(o.operation as usize) else { continue };
        let declared = &program.operations[operation.operation];
        let solid = &program.tools[declared.tool].solid;
        load::report(program, motion, o, stock.cell.get(), sink);
        for part in ["cutter at rapid", "shank", "holder"] {
            let all = o.collisions.iter().filter(|c| c.part == part);
            let Some(worst) = all.clone().max_by(|a, b| a.depth.total_cmp(&b.depth)) else { continue };
            let count = all.count();
            let depth = length(worst.depth.get());
            let first = solid.shank.first().map_or(f64::INFINITY, |s| s.to);
            let (code, text, help) = match part {
                "cutter at rapid" => (
                    verification::RAPID_THROUGH_STOCK,
                    format!("at rapid the cutter is {depth} deep in remaining stock"),
                    "use a longer lead-in or lead-out, or an earlier operation that removes this stock",
                ),
                "shank" if worst.height.get() < first => (
                    verification::ABOVE_FLUTES,
                    format!(
                        "the shank above the {} mm of flutes is {depth} deep in remaining stock",
                        solid.flute_length
                    ),
                    "use longer flutes, a thinner shank, a smaller `depth`, or an earlier operation that removes this stock",
                ),
                _ => (
                    verification::BODY_IN_STOCK,
                    format!("the {part} is {depth} deep in remaining stock"),
                    "use a longer reach, a slimmer holder, or an earlier operation that removes this stock",
                ),
            };
            let diag = Diag::error(code, text)
                .label(declared.span, "in this operation")
                .place(describe(program, motion, Some(worst.at)), Point3::from(worst.point))
                .block(worst.at.operation, worst.at.index)
                .note(format!(
                    "{count} moves of the operation collide; this is the deepest place, {:.2} mm above the tip",
                    worst.height.get()
                ))
                .help(help);
            sink.push(diag);
        }
    }
}
