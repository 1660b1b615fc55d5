//! Four-sided patches that cover the milled part of the wheel: faces, fillets, edges and tips of the blades, and the hub.
//!
//! Neighbouring patches share the points of their borders, to the last bit, so that there are no gaps. Turned surfaces close the part
//! between two circles.

use super::Part;
use super::blade_sheets::{BladeSheets, SheetForm};
use super::chart::charts;
use super::hub_patches::{HubPatch, hub_patches};
use super::patch::{AlongSpacing, PatchDirection, PatchFault, PointRows, Shares, SheetPatch};
use nalgebra::Point3;

/// The patches of all sectors.
pub(super) struct Patches<'a> {
    part: &'a Part,
    /// Patches of the blades, sector 0.
    blades: Vec<SheetPatch>,
    /// Patches over the hub, sector 0.
    hub: Vec<HubPatch>,
    /// Lines on the circles at the inlet and the outlet of the hub, counter-clockwise, sector 0.
    pub(super) rings: [Vec<(PatchDirection, Vec<Point3<f64>>)>; 2],
}

impl<'a> Patches<'a> {
    /// # Errors
    /// [`PatchFault`].
    pub(super) fn new(part: &'a Part, shares: &Shares, spacing: AlongSpacing) -> Result<Self, PatchFault> {
        let charts = charts(part);
        let along = spacing.shares(shares.of(PatchDirection::Along));
        let form = SheetForm { part, charts: &charts, shares, along };
        let sheets = part.blade_ids().map(|blade| BladeSheets::new(&form, blade)).collect::<Result<Vec<_>, _>>()?;
        let mut blades = Vec::new();
        for sheet in &sheets {
            blades.extend(sheet.patches(&form)?);
        }
        let hub = hub_patches(&form, &sheets)?;
        Ok(Self { part, blades, hub: hub.patches, rings: hub.rings })
    }

    /// True when columns about Z and rows from inlet to outlet run clockwise as seen from outside of the hub.
    pub(super) fn turned(&self) -> bool {
        self.hub.iter().any(|hub| hub.patch.directions[1] == PatchDirection::Along && hub.patch.turned)
    }

    /// Patches of a sector, and for each end of the hub the points on its circle, counter-clockwise, without the last.
    pub(super) fn of_sector(&self, sector: u32) -> (Vec<SheetPatch>, [Vec<Point3<f64>>; 2]) {
        let [turn, next] = [sector, (sector + 1) % self.part.vane_count].map(|k| self.part.sector_rotation(k));
        let turned = |patch: &SheetPatch| {
            let rows: PointRows = patch.rows.iter().map(|row| row.iter().map(|p| turn * p).collect()).collect();
            SheetPatch { rows, ..*patch }
        };
        let mut patches: Vec<SheetPatch> = self.blades.iter().map(turned).collect();
        for HubPatch { patch, next: shared } in &self.hub {
            let mut patch = turned(patch);
            for (row, p) in patch.rows.iter_mut().zip(shared.iter().flatten()) {
                row.last_mut().into_iter().for_each(|last| *last = next * p);
            }
            patches.push(patch);
        }
        let ring = |lines: &Vec<(PatchDirection, Vec<Point3<f64>>)>| {
            lines.iter().flat_map(|(_, line)| line[..line.len() - 1].iter().map(|p| turn * p)).collect()
        };
        (patches, self.rings.each_ref().map(ring))
    }
}
