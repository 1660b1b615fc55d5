//! Distances of the stations that the planner lays: rules that follow from part, tool and tolerance before a line is planned.

use ir::{Operation, Program, RoughingStrategy};

/// Deviation of a chord between two stations of `rough` from a circle of half the outlet radius, as a share of the
/// tolerance of roughing: 0.7 mm on a part of 60 mm radius at 50 um.
const OF_TOLERANCE: f64 = 0.04;

/// Distance of the stations of `rough`, mm.
pub(crate) fn rough_spacing(program: &Program) -> f64 {
    let circle = 0.5 * program.part.hub.meridian(1.0).point.x;
    (8.0 * circle * OF_TOLERANCE * program.tolerances.chord_rough.get()).sqrt()
}

/// Stations of a loop of a trochoidal slot.
pub(crate) const LOOP_STATIONS: f64 = 30.0;

/// Distance of the loops of a `rough` operation, mm: about half of the radial depth of cut that a straight line has at the
/// same arc of engagement. `None` without loops.
pub(crate) fn loop_distance(program: &Program, operation: &Operation) -> Option<f64> {
    let Some(RoughingStrategy::Rough { slots, .. }) = operation.kind.strategy() else { return None };
    let radius = program.tools[operation.tool].solid.radius();
    slots.engagement().map(|arc| 0.5 * radius * (1.0 - libm::cos(arc.get())))
}

/// Stations of the loops of a `rough` operation over a length of the channel, mm; none without loops.
pub(crate) fn loop_stations(program: &Program, operation: &Operation, length: f64) -> f64 {
    loop_distance(program, operation).map_or(0.0, |distance| LOOP_STATIONS * length / distance)
}
