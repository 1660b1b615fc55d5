//! Blades whose first or last section does not reach hub or shroud.

use super::BladeSurfaces;
use super::part_source::{PartSource, blade_name};
use super::tip_meridian::TipMeridian;
use base::units::trim;
use blade::outline::DividedSection;
use nalgebra::Point2;
use nurbs::chords;

/// Distance to which faces are extended without a word, mm: what a job extends by itself (`extend`).
pub(super) const WITHOUT_A_WORD: f64 = 0.1;

/// Share of the distance, and length in mm, by which faces are extended further: surfaces run off the points they pass through.
const FURTHER: (f64, f64) = (0.01, 0.01);

/// Name of the curve through the tips.
pub(super) const TIPS: &str = "tips";

type Line = [[f64; 2]];

/// The largest distance between the first sections of the blades and the hub, or the last ones from the shroud, mm;
/// zero where they reach them.
pub(super) fn largest(source: &PartSource<'_>) -> f64 {
    largest_at(source, 0).max(largest_at(source, 1))
}

/// The length of `extend` for a distance, as the language writes it.
pub(super) fn extension(short: f64) -> String {
    trim(short * (1.0 + FURTHER.0) + FURTHER.1, 2)
}

/// Messages about a blade that ends short of hub or shroud.
pub(super) fn sentences(source: &PartSource<'_>, blade: usize) -> Vec<String> {
    let [hub, shroud] = short(source, blade);
    let name = blade_name(blade);
    let mut lines = Vec::new();
    for (gap, section, end) in [(hub, "first", "hub"), (shroud, "last", "shroud")] {
        if gap > WITHOUT_A_WORD {
            let gap = trim(gap, 3);
            lines.push(format!(
                "{name}: the {section} section ends up to {gap} mm short of the {end}; `extend` continues the faces to it."
            ));
        }
    }
    if shroud > WITHOUT_A_WORD {
        lines.push(format!(
            "{name}: if the file gives the casing as the shroud, this is the gap at the tips: {}.",
            remedy(source, hub)
        ));
    }
    lines
}

/// What to do where the shroud is the casing. `hub` is the gap at the hub, mm.
fn remedy(source: &PartSource<'_>, hub: f64) -> String {
    let Some(tips) = casing(source) else {
        return match source.imported.surfaces {
            BladeSurfaces::BySections => "give the shroud through the tips".to_owned(),
            // Of a STEP file.
            _ => "import without a face as shroud; then it goes through the tips".to_owned(),
        };
    };
    let extend = if hub > WITHOUT_A_WORD {
        format!("write `extend {} mm`", extension(largest_at(source, 0)))
    } else {
        "take `extend` out".to_owned()
    };
    format!(
        "take the curve `{TIPS}` for the shroud, which goes through the tips within {} mm, and {extend}",
        trim(tips.within, 4)
    )
}

/// The meridian through the tips, where the blades end short of the shroud.
pub(super) fn casing<'s>(source: &'s PartSource<'_>) -> Option<&'s TipMeridian> {
    source.tips.as_ref().filter(|_| largest_at(source, 1) > WITHOUT_A_WORD)
}

/// The largest distance of all blades at one end, hub (0) or shroud (1), mm.
fn largest_at(source: &PartSource<'_>, end: usize) -> f64 {
    (0..source.divided.len()).map(|blade| short(source, blade)[end]).fold(0.0, f64::max)
}

/// Distance of the first section of a blade from the hub, and of the last one from the shroud, mm.
fn short(source: &PartSource<'_>, blade: usize) -> [f64; 2] {
    let Some((hub, shroud)) = source.imported.hub.as_deref().zip(source.imported.shroud.as_deref()) else {
        return [0.0; 2];
    };
    let sections = source.divided.get(blade).map(Vec::as_slice).unwrap_or_default();
    let of = |section: Option<&DividedSection>, line: &Line, other: &Line| {
        let points = section.into_iter().flat_map(|s| s.outline.faces.iter().chain(&s.outline.edges).flatten());
        points.map(|p| towards([libm::hypot(p.x, p.y), p.z], line, other)).fold(0.0, f64::max)
    };
    [of(sections.first(), hub, shroud), of(sections.last(), shroud, hub)]
}

/// Distance of a point from a line, mm; zero where the point is not on the side of the other line.
fn towards(p: [f64; 2], line: &Line, other: &Line) -> f64 {
    let foot = nearest(p, line);
    let across = nearest(foot, other);
    let way = [p[0] - foot[0], p[1] - foot[1]];
    let inside = way[0] * (across[0] - foot[0]) + way[1] * (across[1] - foot[1]) > 0.0;
    if inside { libm::hypot(way[0], way[1]) } else { 0.0 }
}

/// The point of a line of chords that is nearest to a point; the point itself where the line has none.
pub(super) fn nearest(p: [f64; 2], line: &Line) -> [f64; 2] {
    let line: Vec<Point2<f64>> = line.iter().map(|p| Point2::from(*p)).collect();
    chords::nearest(&Point2::from(p), &line).map_or(p, |near| near.foot.into())
}
