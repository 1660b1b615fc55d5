//! Words behind points of a section that tell its edges: `le` and `te`, or `le1`, `le2`, `te1`, `te2` at the corners of edges that
//! are cut off, as TurboGrid and CFturbo write them.

use super::ImportedBlade;
use super::lines::{Line, separates};
use base::source::Span;
use blade::EdgeForm;
use blade::outline::DividedSection;
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};
use nalgebra::Point3;
use nurbs::chords::from_chords;

/// Names of the edges, leading and trailing.
const EDGES: [&str; 2] = ["leading", "trailing"];

/// Largest distance of a tagged point from its edge, in widths of the edge: the tag of a round edge may stand where the mean line
/// ends, and the edge may begin behind it.
const WIDTHS: f64 = 2.0;

/// A tagged point.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeTag {
    /// Section, counted from the hub.
    pub section: usize,
    /// Leading (0) or trailing (1) edge.
    pub edge: usize,
    /// The point is a corner of an edge that is cut off.
    pub corner: bool,
    /// The point, mm.
    pub point: Point3<f64>,
    /// Its line.
    pub place: Span,
}

/// Divides a line with a point into its numbers and the word behind them. Numbers keep their own faults.
pub(super) fn split<'t>(line: Line<'t>) -> (Line<'t>, Option<&'t str>) {
    let last = line.text.rsplit(separates).next().unwrap_or_default();
    let letters = last.starts_with(|c: char| c.is_ascii_alphabetic()) && line.count_of_words() == 4;
    if !letters {
        return (line, None);
    }
    let numbers = line.text[..line.text.len() - last.len()].trim_end_matches(separates);
    (Line { text: numbers, span: line.span }, Some(last))
}

/// The edge of a word, and whether it tells a corner.
///
/// # Errors
/// A word of no edge.
pub(super) fn edge(word: &str, line: Line<'_>) -> Result<(usize, bool), Diag> {
    match word.to_ascii_lowercase().as_str() {
        "le" => Ok((0, false)),
        "te" => Ok((1, false)),
        "le1" | "le2" => Ok((0, true)),
        "te1" | "te2" => Ok((1, true)),
        _ => Err(line.fault(
            format!("the word `{}` behind the point is not known", printable(word)),
            "a point of an edge has `le`, `te`, or at the corners of a cut `le1`, `le2`, `te1`, `te2`",
        )),
    }
}

/// The form of the edges that tags tell: corners tell an edge that is cut off.
///
/// # Errors
/// The file states another form.
pub(super) fn forms(blade: &mut ImportedBlade) -> Result<(), Diag> {
    for tag in blade.tags.iter().filter(|tag| tag.corner) {
        if blade.edges[tag.edge].is_some_and(|form| form != EdgeForm::CutOff) {
            let message = format!("the {} edge has corners, and is stated as round", EDGES[tag.edge]);
            return Err(Diag::error(codes::CONTRADICTS, message)
                .label(tag.place, "a corner")
                .help("state `CutOffEnd` in the `.inf` file, or export both files again"));
        }
        blade.edges[tag.edge] = Some(EdgeForm::CutOff);
    }
    Ok(())
}

/// Whether the tags stand at the edges that were found by the shape of the sections.
///
/// # Errors
/// A tag that stands elsewhere.
pub(super) fn check(blade: &ImportedBlade, divided: &[DividedSection]) -> Result<(), Diag> {
    for tag in &blade.tags {
        let Some(section) = divided.get(tag.section) else { continue };
        let distances = section.outline.edges.each_ref().map(|edge| from_chords(&tag.point, edge));
        let [here, other] = [distances[tag.edge], distances[1 - tag.edge]];
        let width = section.edges[tag.edge].width;
        if here <= WIDTHS * width {
            continue;
        }
        let [edge, opposite] = [EDGES[tag.edge], EDGES[1 - tag.edge]];
        let (what, help) = if other <= WIDTHS * section.edges[1 - tag.edge].width {
            let what = format!("it stands at the {opposite} edge, by the direction of the hub");
            (what, "turn the order of the points of hub and shroud, or exchange `le` and `te`")
        } else {
            let what = format!(
                "{here:.3} mm from the {edge} edge that the shape of the section has, which is {width:.3} mm wide"
            );
            (what, "look at the points there; export the file again")
        };
        let message = format!(
            "section {} of the blade `{}` has the tag of its {edge} edge elsewhere",
            tag.section + 1,
            printable(&blade.name)
        );
        return Err(Diag::error(codes::CONTRADICTS, message).label(tag.place, what).help(help));
    }
    Ok(())
}
