//! Faces and edges of imported blades, with the diagnostics for sections that have none.

use super::edge_tags;
use super::{ImportedBlade, ImportedRow, Options, Start};
use base::source::Span;
use blade::SectionForm;
use blade::facts::{SectionFact, facts};
use blade::outline::{DividedSection, Inlet, Known, OutlineFault, Side, outline, pressure_side};
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};

/// Most facts of a section that are reported.
const MAX_SHOWN: usize = 5;

/// Divides all sections of the blades of a row. All blades have the pressure face on one side: that of sections which are
/// given as faces, the one that the caller states, or the one that [`pressure_side`] finds for the main blade.
///
/// # Errors
/// A section without two faces and two edges, or a leading edge or a pressure face that nothing tells.
pub fn outlines(
    row: &ImportedRow,
    hub: Option<&[[f64; 2]]>,
    options: &Options,
) -> Result<Vec<Vec<DividedSection>>, Diag> {
    let inlet = match (options.start, hub) {
        (Some(Start::LeadingEdge), _) => Inlet::BeginsThere,
        (Some(Start::TrailingEdge), _) => Inlet::BeginsAtOutlet,
        (None, Some(hub)) => Inlet::Meridian(hub),
        (None, None) => Inlet::Unknown,
    };
    let all = |pressure: Side| -> Result<Vec<Vec<DividedSection>>, Diag> {
        let known = Known { inlet, pressure };
        row.blades.iter().map(|blade| of_blade(blade, &known)).collect()
    };
    if let Some(side) = stated_side(row, options)? {
        return all(side);
    }
    let found = all(Side::Greater)?;
    let Some((main, sections)) = row.blades.first().zip(found.first()) else { return Ok(found) };
    if row.blades.iter().flat_map(|b| &b.sections).all(|s| matches!(s.form, SectionForm::Faces(_))) {
        return Ok(found);
    }
    match pressure_side(sections) {
        Some(Side::Greater) => Ok(found),
        Some(Side::Smaller) => all(Side::Smaller),
        None => Err(Diag::error(codes::SECTION, "the pressure face of the blades is not known")
            .label(place(main, 0), "the face that is ahead is not the concave one, as on turbines")
            .help("state `--pressure greater` or `--pressure smaller`: the side of the pressure face by the angle about Z")),
    }
}

/// The side of the pressure face that the file or the caller states.
fn stated_side(row: &ImportedRow, options: &Options) -> Result<Option<Side>, Diag> {
    let main = row.blades.first();
    let of_file = main.and_then(|blade| blade.pressure);
    match (of_file, options.side) {
        (Some(of_file), Some(given)) if of_file != given => Err(Diag::error(
            codes::CONTRADICTS,
            "the file has the pressure face on the other side than `--pressure` says",
        )
        .label(main.map_or(Span::default(), |blade| place(blade, 0)), "the pressure face of the file")
        .help("leave out `--pressure`, or pick the other face as pressure face")),
        (of_file, given) => Ok(of_file.or(given)),
    }
}

fn of_blade(blade: &ImportedBlade, known: &Known<'_>) -> Result<Vec<DividedSection>, Diag> {
    let numbered = blade.sections.iter().enumerate();
    let divided: Vec<DividedSection> = numbered
        .map(|(k, section)| outline(section, known).map_err(|fault| refused(blade, k, fault)))
        .collect::<Result<_, _>>()?;
    edge_tags::check(blade, &divided)?;
    Ok(divided)
}

/// The fault of a section.
fn refused(blade: &ImportedBlade, section: usize, fault: OutlineFault) -> Diag {
    let help = match fault {
        OutlineFault::NoInlet | OutlineFault::SameInlet => {
            "state `--start leading` or `--start trailing`: the edge at which the points begin; or give hub and shroud"
        }
        _ => "look at the points of this section, and export it again with more of them",
    };
    let name = printable(&blade.name);
    Diag::error(codes::SECTION, format!("section {} of the blade `{name}` has no faces and edges", section + 1))
        .label(place(blade, section), fault.to_string())
        .help(help)
}

fn place(blade: &ImportedBlade, section: usize) -> Span {
    blade.places.get(section).copied().unwrap_or_default()
}

/// Warnings on doubtful points of a blade, one for each section.
pub fn doubtful(blade: &ImportedBlade, divided: &[DividedSection]) -> Vec<Diag> {
    let mut found = Vec::new();
    for (k, section) in blade.sections.iter().enumerate() {
        let facts = facts(section, divided.get(k).map(|d| &d.outline));
        if facts.is_empty() {
            continue;
        }
        let name = printable(&blade.name);
        let mut diag =
            Diag::warning(codes::SECTION_FACTS, format!("section {} of the blade `{name}` has doubtful points", k + 1))
                .label(place(blade, k), format!("{} of them", facts.len()))
                .help("look at these points with the designer; a bump of the face is as large as the error of a point");
        for fact in facts.iter().take(MAX_SHOWN) {
            diag = diag.note(text(fact));
        }
        found.push(diag);
    }
    found
}

/// A fact in words. Points count from 1.
fn text(fact: &SectionFact) -> String {
    match fact {
        SectionFact::Repeated(k) => format!("points {k} and {} are at one place", k + 1),
        SectionFact::Gap(k, length) => format!("the gap behind point {} is {length:.3} mm long", k + 1),
        SectionFact::OffCurve(k, off) => {
            format!("point {} lies {off:.4} mm beside the curve through its neighbours", k + 1)
        }
        SectionFact::Crossing(a, b) => format!("the section crosses itself behind points {} and {}", a + 1, b + 1),
    }
}
