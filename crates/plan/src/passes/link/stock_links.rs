//! Links of finishing, grooving and expanding through the air of the simulated stock.
//!
//! Before: the passes of an operation in all sectors. After: a link for each pass that the tool reaches from the end of the
//! pass before on straight paths through air, clear of the part; of several the quickest one. A link may go through the
//! channel, over the shroud or round the outside of the blades: the stock and the part decide this, not a rule. Links
//! between neighbouring lines, which direct links prove without any stock, are left to them.
//!
//! The stock is that before the operation, which holds all that the operation may find; for operations that later ones
//! find the rest of, it is the stock that each pass leaves. Sectors that find the same stock as another one, turned, have its
//! links.

use super::direct_link::DirectLinks;
use super::like_sectors::{LikeSectors, are_turned, turned};
use super::stock_steps::{cut, stations};
use super::through_air::ThroughAir;
use base::progress::Work;
use ir::{ClOperation, ClPass, Operation};
use tool_stock::stock::Field;

/// Adds the links of an operation, and removes its cuts from the stock where `cuts` is true.
pub(super) fn add(
    operation: &Operation,
    direct: &DirectLinks<'_>,
    like: &LikeSectors<'_>,
    planned: &mut ClOperation,
    cuts: bool,
    field: &mut Field,
    work: &Work,
) {
    let program = like.program;
    let solid = &program.tools[operation.tool].solid;
    let cutter = solid.cutter_alone(0.0);
    let air = ThroughAir::new(program, direct, solid, field);
    let mut before = None;
    let mut linked = 0;
    let mut steady: Option<Vec<ClPass>> = None;
    for passes in planned.passes.chunk_by_mut(|a, b| a.sector == b.sector) {
        let sector = passes[0].sector;
        let known = steady.as_ref().and_then(|steady: &Vec<ClPass>| {
            let turn = like.turn(steady.first()?.sector, sector)?;
            let links = || steady.iter().map(|pass| turned(pass, sector, &turn).link).collect::<Vec<_>>();
            are_turned(steady, passes, &turn).then(links)
        });
        for (k, pass) in passes.iter_mut().enumerate() {
            if work.do_step(|| ()).is_none() {
                return;
            }
            let ends = pass.points.first().copied().zip(pass.points.last().copied());
            let Some((first, last)) = ends else { continue };
            // The first pass comes from a sector that may have other passes.
            let known = known.as_ref().and_then(|links| links.get(k)).filter(|_| k > 0);
            if let Some(link) = known {
                pass.link.clone_from(link);
            } else if let Some(end) = before
                && !(operation.kind.finishes() && direct.between(&end, &first).is_some())
            {
                pass.link = air.quickest(&end, &first, operation.link_feed.get() / 60.0, field);
            }
            linked += usize::from(pass.link.is_some());
            before = Some(last);
            if cuts {
                cut(&program.machine, &stations(&program.machine, pass), &cutter, field);
            }
        }
        if steady.is_none() && like.follows(sector) {
            steady = Some(passes.to_vec());
        }
    }
    if linked > 0 {
        planned.notes.push(format!("{linked} links through the air of the simulated stock"));
    }
}
