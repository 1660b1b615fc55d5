//! What must hold of every imported blade, whatever its format.

use super::{Imported, ImportedBlade};
use crate::diag::codes::import as codes;
use crate::diag::{Diag, printable};
use crate::sections::{Section, SectionForm};
use crate::source::Span;
use nalgebra::Point3;

/// Sections run from hub to shroud: the first is nearer to the hub than the last.
pub(super) fn order(imported: &Imported, at: Span) -> Result<(), Diag> {
    let Some(hub) = &imported.hub else { return Ok(()) };
    for blade in imported.rows.iter().flat_map(|row| &row.blades) {
        let ends = blade.sections.first().zip(blade.sections.last());
        if let Some([first, last]) = ends.map(|(a, b)| [a, b].map(|s| height(s, hub)))
            && first >= last
        {
            return Err(from_shroud(blade, [first, last], at));
        }
    }
    Ok(())
}

fn from_shroud(blade: &ImportedBlade, [first, last]: [f64; 2], at: Span) -> Diag {
    let message = format!("the sections of the blade `{}` do not run from hub to shroud", printable(&blade.name));
    Diag::error(codes::CONTRADICTS, message)
        .label(at, "in this file")
        .note(format!("the first section is {first:.3} mm from the hub, the last one {last:.3} mm"))
        .help("order the sections from hub to shroud; check that hub and shroud are not exchanged")
}

/// Points of a section.
fn points(section: &Section) -> Box<dyn Iterator<Item = &Point3<f64>> + '_> {
    match &section.form {
        SectionForm::Loop(points) | SectionForm::DividedLoop { points, .. } => Box::new(points.iter()),
        SectionForm::Faces(faces) => Box::new(faces.iter().flatten()),
        SectionForm::MeanLine { points, .. } => Box::new(points.iter().map(|p| &p.position)),
    }
}

/// Points of a section that its height is taken from.
const SAMPLES: usize = 16;

/// Mean distance of a section from the hub, mm.
fn height(section: &Section, hub: &[[f64; 2]]) -> f64 {
    let step = points(section).count().div_ceil(SAMPLES).max(1);
    let heights = points(section).step_by(step).map(|p| from_line([libm::hypot(p.x, p.y), p.z], hub));
    let (sum, count) = heights.fold((0.0, 0.0), |(sum, count), height| (sum + height, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}

/// Distance of a point from a line of chords.
fn from_line([x, y]: [f64; 2], line: &[[f64; 2]]) -> f64 {
    let chords = line.windows(2).filter_map(|w| <&[[f64; 2]; 2]>::try_from(w).ok());
    let distances = chords.map(|[a, b]| {
        let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
        let square = dx * dx + dy * dy;
        let t = if square > 0.0 { ((x - a[0]) * dx + (y - a[1]) * dy) / square } else { 0.0 };
        let t = t.clamp(0.0, 1.0);
        libm::hypot(x - a[0] - t * dx, y - a[1] - t * dy)
    });
    distances.fold(f64::INFINITY, f64::min)
}
