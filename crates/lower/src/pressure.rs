//! The side of the pressure face of a blade of sections.

use base::source::Span;
use blade::outline::{Side, side_by_turns};
use diagnostics::codes::geometry as codes;
use diagnostics::{Diag, Sink};
use job::model::Facing;

/// Where a pressure face at a side looks.
pub(super) fn facing(side: Side) -> Facing {
    match side {
        Side::Greater => Facing::CounterClockwise,
        Side::Smaller => Facing::Clockwise,
    }
}

/// Side of the pressure face: as stated, that of the main blade, or that of a blade that takes up work, by its wrap and its
/// turn, rad.
pub(super) fn side(
    stated: Option<Facing>,
    main: Option<Side>,
    [wrap, turn]: [f64; 2],
    name: &str,
    span: Span,
    sink: &mut Sink,
) -> Option<Side> {
    let found = match stated {
        Some(stated) => [Side::Greater, Side::Smaller].into_iter().find(|side| facing(*side) == stated),
        None => main.or_else(|| side_by_turns(wrap, turn)),
    };
    if found.is_none() {
        let (wrap, turn) = (wrap.to_degrees(), turn.to_degrees());
        sink.push(
            Diag::error(codes::PRESSURE_SIDE, format!("the pressure face of {name} cannot be told"))
                .label(span, format!("the blade turns by {wrap:.1} deg about Z, and its mean line bends by {turn:.1} deg"))
                .help("state it: `pressure counter-clockwise` when the pressure face looks counter-clockwise, seen from +Z; or `pressure clockwise`"),
        );
    }
    found
}
