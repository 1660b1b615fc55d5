//! What must hold of every imported blade, whatever its format.

use super::frame::LengthUnit;
use super::short_ends::nearest;
use super::{Imported, ImportedBlade, Options};
use base::source::Span;
use base::units::length;
use blade::{Section, SectionForm};
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};
use nalgebra::Point3;

/// Sections run from hub to shroud: the first is nearer to the hub than the last.
pub(super) fn order(imported: &Imported, at: Span) -> Result<(), Diag> {
    imported.rows.iter().flat_map(|row| &row.blades).try_for_each(one_blade)?;
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

/// Largest coordinate below which a wheel is none that a tool cuts, mm.
pub const LEAST_SIZE: f64 = 1.0;

/// Coordinates from which on a wheel is larger than all that are made, mm.
const MAX_SIZE: f64 = 15_000.0;

/// The option `--unit` gives a wheel that can be one: coordinates in metres that are read as millimetres make a wheel of some
/// hundredths of a millimetre. A unit that the file states is taken as it is.
pub(super) fn size(imported: &Imported, options: &Options, at: Span) -> Result<(), Diag> {
    let Some(unit) = options.unit else { return Ok(()) };
    let blades = imported.rows.iter().flat_map(|row| &row.blades);
    let all = blades.flat_map(|blade| &blade.sections).flat_map(points);
    let size = all.map(|p| p.x.abs().max(p.y.abs()).max(p.z.abs())).fold(0.0, f64::max);
    // Size in the number of the file, taken for another unit.
    let as_unit = |other: LengthUnit| (LEAST_SIZE * 5.0..1000.0).contains(&(size / unit.mm() * other.mm()));
    let other = match size {
        s if s > 0.0 && s < LEAST_SIZE => LengthUnit::Metre,
        s if s > MAX_SIZE => LengthUnit::Millimetre,
        _ => return Ok(()),
    };
    let help = if as_unit(other) { format!("state `--unit {other}`") } else { "state the unit of the file".to_owned() };
    Err(Diag::error(codes::CONTRADICTS, format!("the blades reach {} from the origin", length(size)))
        .label(
            at,
            format!(
                "the numbers look like {}, and `--unit` says {unit}",
                if other == LengthUnit::Metre { "metres" } else { "millimetres" }
            ),
        )
        .help(help))
}

fn from_shroud(blade: &ImportedBlade, [first, last]: [f64; 2], at: Span) -> Diag {
    let message = format!("the sections of the blade `{}` do not run from hub to shroud", printable(&blade.name));
    Diag::error(codes::CONTRADICTS, message)
        .label(at, "in this file")
        .note(format!("the first section is {first:.3} mm from the hub, the last one {last:.3} mm"))
        .help("order the sections from hub to shroud; check that hub and shroud are not exchanged")
}

/// A section this share of the way back to the first one begins another blade. Sections of one blade go on.
const BACK: f64 = 0.5;

/// The sections are those of one blade: none goes back to where the first ones are, by its middle in the meridian plane.
fn one_blade(blade: &ImportedBlade) -> Result<(), Diag> {
    let middles: Vec<[f64; 2]> = blade.sections.iter().map(middle).collect();
    let Some(first) = middles.first() else { return Ok(()) };
    for (k, pair) in middles.windows(2).enumerate() {
        let [before, here] = pair else { continue };
        let way = [before[0] - first[0], before[1] - first[1]];
        let step = [here[0] - before[0], here[1] - before[1]];
        let along = way[0] * step[0] + way[1] * step[1];
        let length = libm::hypot(way[0], way[1]);
        if length > 0.0 && along < -BACK * length * length {
            let place = |k: usize| blade.places.get(k).copied().unwrap_or_default();
            let message =
                format!("section {} of the blade `{}` goes back to the first ones", k + 2, printable(&blade.name));
            return Err(Diag::error(codes::CONTRADICTS, message)
                .label(
                    place(k + 1),
                    format!(
                        "by {:.3} of {length:.3} mm: another blade begins here, or the order is lost",
                        -along / length
                    ),
                )
                .label(place(k), "the section before")
                .help("give each blade in a file of its own, with its sections in the order from hub to shroud"));
        }
    }
    Ok(())
}

/// Mean (r, z) of the points of a section, mm.
fn middle(section: &Section) -> [f64; 2] {
    let sum = |[r, z, n]: [f64; 3], p: &Point3<f64>| [r + libm::hypot(p.x, p.y), z + p.z, n + 1.0];
    let [r, z, n] = points(section).fold([0.0; 3], sum);
    if n > 0.0 { [r / n, z / n] } else { [0.0; 2] }
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
    let [a, b] = nearest([x, y], line);
    libm::hypot(x - a, y - b)
}
