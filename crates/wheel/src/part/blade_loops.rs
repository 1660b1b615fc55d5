//! Closed loops round the blades, at shares of the way along their rulings from hub to shroud.

use super::blade_sheets::{BladeSheets, SheetForm};
use super::chart::charts;
use super::patch::{PatchDirection, PatchFault, Shares};
use super::{BladeId, Part};
use nalgebra::Point3;

/// Steps along a face, across the middle part of an edge, and along each other part of an edge.
const FACE_STEPS: usize = 96;
const EDGE_MIDDLE_STEPS: usize = 16;
const SHOULDER: usize = 6;

/// The loops of a blade of sector 0.
#[derive(Clone, Debug)]
pub struct BladeLoops {
    /// The blade.
    pub blade: BladeId,
    /// True for a leading and a trailing edge that are surfaces of their own. A loop runs straight across another edge.
    pub rounded: [bool; 2],
    /// Loops from hub to shroud, mm. Each begins beside the leading edge, runs round it, and ends with its first point.
    pub loops: Vec<Vec<Point3<f64>>>,
}

/// `count` loops round each blade, the first on the hub, the last on the shroud, at equal steps of the way up each ruling. They are
/// those of sharp roots.
///
/// # Errors
/// [`PatchFault`].
pub fn blade_loops(part: &Part, count: usize) -> Result<Vec<BladeLoops>, PatchFault> {
    let sharp = part.without_fillets();
    let charts = charts(&sharp);
    let shares = Shares::equal([FACE_STEPS, 1, count.max(2) - 1, 1, EDGE_MIDDLE_STEPS, SHOULDER, 1]);
    let along = shares.of(PatchDirection::Along).to_vec();
    let form = SheetForm { part: &sharp, charts: &charts, shares: &shares, along };
    sharp.blade_ids().map(|blade| Ok(round(&sharp, &BladeSheets::new(&form, blade)?, blade))).collect()
}

fn round(part: &Part, sheets: &BladeSheets, blade: BladeId) -> BladeLoops {
    let rounded = [0, 1].map(|end| part.edge(blade, end).is_some());
    let edge = |end: usize, row: usize| -> Vec<Point3<f64>> {
        let parts = sheets.ends[end].parts.iter().map(|(_, grid)| &grid[row]);
        // From the face behind to the face ahead; a part begins where the one before it ends.
        if rounded[end] { parts.flat_map(|part| part[1..].to_vec()).collect() } else { Vec::new() }
    };
    let one = |row: usize| {
        let [ahead, behind] = sheets.faces.each_ref().map(|face| &face[row]);
        let mut points = vec![behind[0]];
        points.extend(edge(0, row));
        points.extend_from_slice(&ahead[usize::from(rounded[0])..]);
        let mut back: Vec<Point3<f64>> = behind[1..].iter().rev().copied().collect();
        let mut trailing = edge(1, row);
        // Its last point is the end of the face ahead, the first one of the face behind is left out as well.
        trailing.pop();
        points.extend(trailing.into_iter().rev());
        points.append(&mut back);
        points.push(behind[0]);
        points
    };
    BladeLoops { blade, rounded, loops: (0..sheets.faces[0].len()).map(one).collect() }
}
