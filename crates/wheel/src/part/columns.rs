//! Columns of places across faces and fillets, from the surfaces themselves. Whoever needs some tens of columns does without the tables
//! of charts, which have many hundreds.

use super::chart::Place;
use super::charting::{borders, fillet_range};
use super::{FaceId, Part, SurfaceKind};

/// A face or a fillet of sector 0, column by column. Its x and y are those of its chart.
#[derive(Clone, Copy, Debug)]
pub struct Columns<'a> {
    /// The face, or the face or edge at whose foot the fillet is.
    pub side: FaceId,
    /// Kind of the surface.
    pub kind: SurfaceKind,
    part: &'a Part,
    u: [f64; 2],
}

impl<'a> Columns<'a> {
    /// The faces of all blades, then the fillets.
    pub fn of_faces_and_fillets(part: &'a Part) -> Vec<Self> {
        let faces = part.faces().map(|side| Self { side, kind: SurfaceKind::Face(side), part, u: [0.0, 1.0] });
        let sides = part.blade_ids().flat_map(|blade| part.sides(blade)).filter(|side| part.fillet(*side).is_some());
        let fillet = |side| Some(Self { side, kind: SurfaceKind::Fillet(side), part, u: fillet_range(part, side)? });
        faces.chain(sides.filter_map(fillet)).collect()
    }

    /// Places of the part in the column at x, at values of y.
    pub fn places(&self, x: f64, values: impl Iterator<Item = f64>) -> Vec<Place> {
        let Self { part, side, u: [from, to], kind } = *self;
        let u = from + (to - from) * x;
        if matches!(kind, SurfaceKind::Face(_)) {
            let ends = borders(part, side, u);
            return values.map(|y| Place::on_face(part.face(side), u, ends, y)).collect();
        }
        let Some(arc) = part.fillet_arc(side, u) else { return Vec::new() };
        // Fillets end with their blade.
        let extent = part.extent(side.blade);
        values.map(|y| Place::on_fillet(&arc, u, y)).filter(|place| extent.holds(&place.position)).collect()
    }
}
