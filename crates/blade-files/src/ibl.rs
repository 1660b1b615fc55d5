//! Creo `.ibl`: sections of curves, without unit, axis or number of blades.
//!
//! `Begin section` begins a profile, `Begin curve` a piece of it. The pieces of a section follow one another from end to
//! start, or are two sides that begin at one place. A point has three numbers, or its own number before them; the first point
//! tells which, for all points. The word `Index` in the head does not tell it: most writers put it above three numbers.

use super::found::{Found, within};
use super::frame::Frame;
use super::lines::{Line, Text, ends};
use super::loader::Loader;
use super::loops::{self, PlacedSections, ReadLoop};
use super::stated::RequiredFacts;
use super::{Imported, ImportedBlade, ImportedRow, Options, limits};
use base::source::{SourceId, Span};
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use nalgebra::Point3;

/// Pieces of one place meet within this share of the size of their section.
const SAME_PLACE_SHARE: f64 = 1e-6;

/// A section in the file, and the line that begins it.
struct SectionPieces {
    begins: Span,
    pieces: Vec<Piece>,
}

/// A piece of a section.
#[derive(Debug)]
struct Piece {
    points: Vec<Point3<f64>>,
    begins: Span,
    ends: Span,
}

pub(super) fn read(
    ids: &[SourceId],
    loader: &mut Loader<'_>,
    options: &Options,
    found: &mut Found,
) -> Result<Imported, Diag> {
    let Some(id) = ids.first().copied() else { return Ok(Imported::default()) };
    let text = loader.text(id);
    let mut required = RequiredFacts::of(options, found, text.end());
    let unit = required.unit(None)?;
    let axis = required.axis(None)?;
    let handedness = required.handedness(None)?;
    let count = required.blades(None)?;
    required.end()?;
    let frame = Frame { mm: unit.mm(), axis, handedness };
    let sections = sections(text, &frame, found)?;
    loops::enough(sections.len(), "main", text.end())?;
    let joined = sections.into_iter().map(joined).collect::<Result<Vec<ReadLoop>, Diag>>()?;
    let PlacedSections { sections, places } = loops::close(joined, found)?;
    found.note(text.end(), "all sections are taken for those of one blade, from hub to shroud");
    let blade = ImportedBlade { name: "main".to_owned(), sections, places, ..ImportedBlade::default() };
    let row = ImportedRow { name: String::new(), count, blades: vec![blade] };
    Ok(Imported { rows: vec![row], ..Imported::default() })
}

fn sections(text: Text<'_>, frame: &Frame, found: &mut Found) -> Result<Vec<SectionPieces>, Diag> {
    let mut sections: Vec<SectionPieces> = Vec::new();
    let mut index = false;
    let mut numbered: Option<bool> = None;
    for line in text.lines() {
        // What follows the mark is a comment.
        let said = line.text.split('!').next().unwrap_or_default().to_ascii_lowercase();
        let words: Vec<&str> = said.split_whitespace().collect();
        match words.as_slice() {
            [] => {}
            ["begin", "section", ..] => {
                sections.push(SectionPieces { begins: line.span, pieces: Vec::new() });
                within(sections.len(), limits::SECTIONS, "sections of a blade", line.span)?;
            }
            ["begin", "curve", ..] => {
                let Some(SectionPieces { pieces, .. }) = sections.last_mut() else {
                    return Err(line.fault("a curve before the first section", "`Begin section` is expected"));
                };
                pieces.push(Piece { points: Vec::new(), begins: line.span, ends: line.span });
                within(pieces.len(), limits::SECTIONS, "curves of a section", line.span)?;
            }
            words
                if sections.is_empty()
                    && words.iter().all(|w| ["open", "closed", "index", "arclength"].contains(w)) =>
            {
                index |= words.contains(&"index");
            }
            _ => {
                let Some(piece) = sections.last_mut().and_then(|section| section.pieces.last_mut()) else {
                    return Err(line.fault("a point before the first curve", "`Begin curve` is expected"));
                };
                let with_number = *numbered.get_or_insert_with(|| has_number(line, index, found));
                let point = point(line, with_number)?;
                piece.points.push(frame.point(point, line.span)?);
                piece.ends = line.span;
                found.point(piece.points.len(), line.span)?;
            }
        }
    }
    if sections.is_empty() {
        return Err(ends(text, "the first section"));
    }
    Ok(sections)
}

/// Whether each point has its number before x, y, z. The first point decides; a note says so where the head says otherwise.
fn has_number(line: Line<'_>, index: bool, found: &mut Found) -> bool {
    let with_number = match line.count_of_words() {
        3 => false,
        4 => true,
        _ => index,
    };
    if with_number != index {
        let says = if index { "the head says `Index`" } else { "the head does not say `Index`" };
        let has = if with_number { "the number of a point, x, y and z" } else { "x, y and z alone" };
        found.note(line.span, format!("{says}, but the lines have {has}: they are read so"));
    }
    with_number
}

fn point(line: Line<'_>, with_number: bool) -> Result<[f64; 3], Diag> {
    if !with_number {
        return line.numbers("x, y and z are expected");
    }
    let due = "a number of the point and x, y, z are expected";
    let [number, x, y, z] = line.numbers(due)?;
    if number < 0.0 || number.fract() != 0.0 {
        return Err(line.fault("the first of four numbers is not the number of a point", due));
    }
    Ok([x, y, z])
}

/// Joins the pieces of a section to one line.
fn joined(SectionPieces { begins: at, pieces }: SectionPieces) -> Result<ReadLoop, Diag> {
    let sides = pieces.len() == 2;
    let size = pieces.iter().flat_map(|p| &p.points).map(|p| p.coords.norm()).fold(0.0, f64::max);
    let meet = |a: Option<&Point3<f64>>, b: Option<&Point3<f64>>| {
        a.zip(b).is_some_and(|(a, b)| nalgebra::distance(a, b) <= SAME_PLACE_SHARE * size)
    };
    let mut line: Option<ReadLoop> = None;
    for Piece { mut points, begins, ends } in pieces {
        if points.is_empty() {
            return Err(Diag::error(codes::ENDS_EARLY, "a curve has no points")
                .label(begins, "this curve")
                .help("export the file again"));
        }
        let Some(before) = &mut line else {
            line = Some(ReadLoop { points, span_fraction: None, begins, ends });
            continue;
        };
        if sides && !meet(before.points.last(), points.first()) && meet(before.points.first(), points.first()) {
            // Both sides begin at one edge.
            points.reverse();
            before.points.extend(points);
            before.ends = ends;
            continue;
        }
        if !meet(before.points.last(), points.first()) {
            return Err(Diag::error(codes::CONTRADICTS, "the curves of a section do not meet")
                .label(begins, "this curve does not begin where the one before ends")
                .help("give the curves of a section in their order round the blade, or as one curve"));
        }
        before.points.extend(points.into_iter().skip(1));
        before.ends = ends;
    }
    line.ok_or_else(|| {
        Diag::error(codes::ENDS_EARLY, "a section has no curve")
            .label(at, "this section")
            .help("a section has `Begin curve` and points; export the file again")
    })
}
