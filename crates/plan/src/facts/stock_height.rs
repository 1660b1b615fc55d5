//! Whether the blank is so high over the shroud that the first level of `rough` would be much deeper than the job says.

use base::units::Mm;
use diagnostics::codes::geometry::STOCK_HIGH;
use diagnostics::{Diag, Sink};
use ir::{Program, RoughingStrategy};

/// Largest height of the blank over the shroud, as a share of the depth of a level: levels begin at the shroud, and the
/// first of them takes what stands over it.
const MAX_OVER_SHARE: f64 = 0.5;

/// Reports an error when the first operation roughs and the blank stands too high.
pub(super) fn check(program: &Program, sink: &mut Sink) {
    let Some((_, operation)) = program.operations.iter().next() else { return };
    let Some(RoughingStrategy::Rough { depth, .. }) = operation.kind.strategy() else { return };
    let over = program.stock.over_shroud;
    let most = Mm(MAX_OVER_SHARE * depth.get());
    if over.get() <= most.get() {
        return;
    }
    let first = Mm(over.get() + depth.get());
    sink.push(
        Diag::error(
            STOCK_HIGH,
            format!(
                "the blank stands {over} over the shroud; the first level of `{}` would be up to {first} deep instead of {depth}",
                operation.name
            ),
        )
        .label(operation.span, "levels begin at the shroud")
        .help(format!("turn the blank to `over shroud {most}` or less")),
    );
}
