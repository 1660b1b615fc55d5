//! `copy-sectors`: what was planned in sector 0, in all sectors of each operation.
//!
//! Before: passes of sector 0. After: the same passes in each sector that the job asks for, sector by sector, with the
//! sector in their labels. The part looks the same from every sector, and the rotary axis next to the part turns about
//! its axis, so that what is clear and within tolerance in one sector is so in all. What is not the same there comes
//! after it: stock that earlier operations left, links, travel.

use crate::ir::{ClPass, ClPlan, Program};

/// Copies the passes of all operations.
pub(crate) fn run(program: &Program, cl: &mut ClPlan) {
    for planned in &mut cl.operations {
        let sectors = &program.operations[planned.operation].sectors;
        planned.passes = sectors
            .iter()
            .flat_map(|sector| {
                let turn = program.part.sector_rotation(*sector);
                planned.passes.iter().map(move |pass| ClPass {
                    label: format!("sector {} {}", sector + 1, pass.label),
                    sector: *sector,
                    points: pass.points.iter().map(|p| p.turned(&turn)).collect(),
                })
            })
            .collect();
    }
}
