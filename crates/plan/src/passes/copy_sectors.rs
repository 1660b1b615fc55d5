//! `copy-sectors`: copies the plan of sector 0 to all sectors of each operation.
//!
//! Before: passes of sector 0. After: the same passes in each sector of the job, sector by sector, with the sector in
//! their labels: in the ascending order of the sectors, which is counter-clockwise about Z, so that a blade or a channel is
//! finished before the next one. All sectors of the part are equal, and the rotary axis next to the part turns about the axis of the
//! part. Clearance and tolerance are therefore the same in all sectors. Stock of earlier operations, links and travel
//! differ from sector to sector; later passes handle them.

use ir::{ClPass, ClPlan, Program};

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
                    air: pass.air.clone(),
                    link: None,
                    points: pass.points.iter().map(|p| p.turned(&turn)).collect(),
                })
            })
            .collect();
    }
}
