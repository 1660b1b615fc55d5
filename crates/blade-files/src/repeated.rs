//! Points that repeat the one before: a job cannot have them.

use super::found::Found;
use super::{Imported, ImportedBlade};
use blade::SectionForm;
use diagnostics::printable;
use nalgebra::Point3;

/// Points nearer to each other than this are one point, mm, as for the points of a job (IMP0303).
pub(super) const ONE_POINT: f64 = 1e-5;

/// Leaves out points of sections that repeat the one before, with a note for each section. The tables of a part keep their
/// points of edges, so sections that come with these stay as they are.
pub(super) fn leave_out(imported: &mut Imported, found: &mut Found) {
    for blade in imported.rows.iter_mut().flat_map(|row| &mut row.blades) {
        let ImportedBlade { name, sections, places, .. } = blade;
        for (k, section) in sections.iter_mut().enumerate() {
            let count = match &mut section.form {
                SectionForm::Loop(points) => of_loop(points),
                SectionForm::Faces(faces) => faces.iter_mut().map(of_line).sum(),
                SectionForm::MeanLine { points, .. } => {
                    let given = points.len();
                    points.dedup_by(|b, a| same(&a.position, &b.position) && a.thickness == b.thickness);
                    given - points.len()
                }
                SectionForm::DividedLoop { .. } => 0,
            };
            if count > 0 {
                let left_out = if count == 1 {
                    "1 point repeats the one before and is left out".to_owned()
                } else {
                    format!("{count} points repeat the one before and are left out")
                };
                let text = format!("section {} of the blade `{}`: {left_out}", k + 1, printable(name));
                found.note(places.get(k).copied(), text);
            }
        }
    }
}

fn same(a: &Point3<f64>, b: &Point3<f64>) -> bool {
    nalgebra::distance(a, b) <= ONE_POINT
}

/// Leaves out repeated points of a line; their number.
fn of_line(points: &mut Vec<Point3<f64>>) -> usize {
    let given = points.len();
    points.dedup_by(|b, a| same(a, b));
    given - points.len()
}

/// The same of a loop, whose first point follows its last one.
fn of_loop(points: &mut Vec<Point3<f64>>) -> usize {
    let mut count = of_line(points);
    while let [first, .., last] = points.as_slice()
        && same(first, last)
    {
        points.pop();
        count += 1;
    }
    count
}
