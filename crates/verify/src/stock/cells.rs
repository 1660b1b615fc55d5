//! Cells of the simulated stock: fine enough to find stock that the shank meets, and the arcs of the smallest cutter.

use ir::{OperationId, Program};
use tool_stock::stock::field::MAX_RAYS;
use wheel::contract::ContractKind;

/// Largest cell of an impeller of up to 200 mm, mm.
pub(super) const MAX_CELL: f64 = 1.0;

/// Most cells across a stock with the largest cells.
const MAX_CELLS_ACROSS: f64 = 200.0;

/// Cells in the radius of the smallest cutter. Material that the rays do not show may reach 18 % of the radius farther.
const CELLS_IN_RADIUS: f64 = 8.0;

/// The same for cutters whose engagement the job limits: 7 % of the radius, 6 deg where an arc ends 45 deg from the
/// direction of feed.
const CELLS_IN_JUDGED_RADIUS: f64 = 20.0;

/// Memory of a ray with its intervals and its share of the maps, bytes.
const RAY_BYTES: f64 = 70.0;

/// Share of the memory of the program that the rays may take.
const MEMORY_SHARE: f64 = 0.25;

/// Largest cell of a stock with a profile of (r, z) points, mm: larger ones could miss a collision of the shank.
pub fn usual_cell(profile: &[[f64; 2]]) -> f64 {
    let [across, height] = size(profile);
    MAX_CELL.max(across.max(height) / MAX_CELLS_ACROSS)
}

/// Default cell of a program, mm: a share of the radius of the smallest cutter, as far as the memory permits.
pub fn default_cell(program: &Program) -> f64 {
    let usual = usual_cell(&program.stock.profile);
    let fine = program.operations.iter().map(|(id, _)| cell_of(program, id));
    fine.fold(usual, f64::min).max(least_cell(program).min(usual))
}

/// Largest cell that shows the engagement of the cutter of an operation, mm.
pub(super) fn cell_of(program: &Program, operation: OperationId) -> f64 {
    let solid = &program.tools[program.operations[operation].tool].solid;
    let cells = if is_judged(program, operation) { CELLS_IN_JUDGED_RADIUS } else { CELLS_IN_RADIUS };
    solid.cutter.widest_below(solid.flute_length) / cells
}

/// Memory of the rays with the default cell, bytes.
pub fn memory(program: &Program) -> f64 {
    RAY_BYTES * rays(program) / default_cell(program).powi(2)
}

/// Whether the job limits the engagement of an operation.
fn is_judged(program: &Program, operation: OperationId) -> bool {
    let contracts = program.contracts.iter().filter(|c| matches!(c.kind, ContractKind::Engagement(_)));
    contracts.map(|c| &c.scope.operations).any(|o| o.is_empty() || o.contains(&operation))
}

/// Least cell whose rays fit into their share of the memory, mm.
fn least_cell(program: &Program) -> f64 {
    let most = MAX_RAYS.min(MEMORY_SHARE * program.memory / RAY_BYTES);
    // A twentieth is the reserve for whole numbers of cells.
    1.05 * (rays(program) / most).sqrt()
}

/// Number of rays of a stock with cells of 1 mm.
fn rays(program: &Program) -> f64 {
    let [across, height] = size(&program.stock.profile);
    across * across + 2.0 * across * height
}

/// Diameter and height of a profile, mm.
fn size(profile: &[[f64; 2]]) -> [f64; 2] {
    let (mut r, mut low, mut high) = (0.0_f64, f64::INFINITY, f64::NEG_INFINITY);
    for p in profile {
        (r, low, high) = (r.max(p[0]), low.min(p[1]), high.max(p[1]));
    }
    [2.0 * r, high - low]
}
