//! Tables of points: section files of NASA (`X R*THETA R`), files of hub and shroud (`x r`), comma separated values.
//!
//! A table has a point in each line, with the words of the columns in the first line or stated by the caller. What has no
//! column comes from the names of the files: `impeller_main_blade_section_03.txt` is section 3 of the blade `impeller main
//! blade`, a blade with `splitter` in its name is a splitter, and a meridian has `hub` or `shroud` in its name.

mod columns;

use super::found::{Found, within};
use super::frame::Frame;
use super::header_unit;
use super::lines::{Line, Text, ends};
use super::loader::Loader;
use super::loops::{self, PlacedSections, ReadLoop};
use super::stated::{RequiredFacts, not_stated};
use super::{Imported, ImportedBlade, ImportedRow, Options, limits, meridian};
use base::source::{SourceId, Span, Spanned};
use blade::{MeanPoint, Section, SectionForm};
use columns::{Column, Columns, Coordinates};
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};
use nalgebra::Point3;

/// Points of one section, or of one face of it.
#[derive(Debug)]
struct ReadCurve {
    key: Key,
    span_fraction: Option<f64>,
    points: Vec<Point3<f64>>,
    /// Of each point, where the table has them.
    thickness: Vec<f64>,
    begins: Span,
    ends: Span,
}

/// What distinguishes curves: consecutive lines with the same key are one.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Key {
    blade: String,
    section: String,
    /// `pressure` (0), `suction` (1), or the whole loop.
    face: Option<usize>,
}

pub(super) fn read(
    ids: &[SourceId],
    loader: &mut Loader<'_>,
    options: &Options,
    found: &mut Found,
) -> Result<Imported, Diag> {
    let files = with_columns(ids, loader, options, found)?;
    let Some((first, of_first)) = files.first() else { return Ok(Imported::default()) };
    // The axis that the columns name; Cartesian columns name none.
    let named = files.iter().find_map(|(_, columns)| Some(Spanned::new(columns.axis?, columns.at())));
    if let Some(axis) = &named {
        let other = files.iter().find(|(_, c)| c.axis.is_some_and(|a| a != axis.value));
        if let Some((_, other)) = other {
            return Err(Diag::error(codes::CONTRADICTS, "the files have different axes of rotation")
                .label(other.at(), "here")
                .label(axis.span, "and here")
                .help("give files of one part"));
        }
    }
    let mut required = RequiredFacts::of(options, found, of_first.at());
    let in_head = files.iter().find_map(|(id, _)| {
        let (unit, line) = header_unit::stated(loader.text(*id).whole().1)?;
        Some(Spanned::new(unit, Span::new(*id, line)))
    });
    let unit = required.unit(in_head)?;
    let axis = required.axis(named)?;
    let handedness = required.handedness(None)?;
    let count = required.blades(None)?;
    required.end()?;
    let frame = Frame { mm: unit.mm(), axis, handedness };

    let mut meridians: [Option<Vec<[f64; 2]>>; 2] = [None, None];
    let mut curves: Vec<ReadCurve> = Vec::new();
    for (id, columns) in &files {
        let (name, text) = (loader.name(*id), loader.text(*id));
        if matches!(columns.coordinates, Coordinates::Meridian(_)) {
            self::meridians(name, text, columns, &frame, &mut meridians, found)?;
        } else {
            self::curves(name, text, columns, &frame, &mut curves, found)?;
        }
    }
    if curves.is_empty() {
        return Err(ends(loader.text(*first), "the first section of a blade"));
    }
    let blades = blades(curves, options, found)?;
    let [hub, shroud] = meridians;
    let row = ImportedRow { name: String::new(), count, blades };
    Ok(Imported { hub, shroud, rows: vec![row], ..Imported::default() })
}

/// The lines of a table without comments.
fn rows(text: Text<'_>) -> impl Iterator<Item = Line<'_>> {
    text.lines().filter(|line| !line.text.starts_with(['#', '!']))
}

/// The files with their columns. One without a header has those of the files that are given with it, where all of these that
/// have as many columns have the same: some sets lack the header of a file.
fn with_columns(
    ids: &[SourceId],
    loader: &Loader<'_>,
    options: &Options,
    found: &mut Found,
) -> Result<Vec<(SourceId, Columns)>, Diag> {
    let mut read = Vec::new();
    for id in ids {
        let text = loader.text(*id);
        let Some(first) = rows(text).next() else { return Err(ends(text, "the first point")) };
        read.push((*id, first.span, first.fields().len(), columns(first, options, found)?));
    }
    let of_others = |count: usize| {
        let mut same = read.iter().filter_map(|(.., columns)| columns.as_ref()).filter(|c| c.count() == count);
        let first = same.next()?;
        same.all(|other| other.means_the_same(first)).then(|| first.clone())
    };
    let lent = |(id, at, count, own): &(SourceId, Span, usize, Option<Columns>)| match own {
        Some(columns) => Ok((*id, columns.clone())),
        None => {
            let columns = of_others(*count).ok_or_else(|| Columns::missing(*at))?;
            found.note(*at, "the file has no header; the columns are taken to be those of the files with it");
            Ok((*id, columns))
        }
    };
    read.iter().map(lent).collect()
}

/// Columns of a file: those that the caller states, where the file has as many, otherwise those of its header.
fn columns(first: Line<'_>, options: &Options, found: &mut Found) -> Result<Option<Columns>, Diag> {
    let stated = options.columns.as_ref().filter(|words| words.len() == first.fields().len());
    match stated {
        Some(words) => {
            found.note(first.span, format!("the columns are {}, by `--columns`", words.join(", ")));
            Columns::of_words(words, first.span).map(Some)
        }
        None if columns::is_header(first) => Columns::of_header(first, found).map(Some),
        None => Ok(None),
    }
}

/// The points of a table with their lines.
fn points<'t>(text: Text<'t>, columns: &Columns) -> impl Iterator<Item = Result<(Line<'t>, Vec<&'t str>), Diag>> {
    let skipped = usize::from(rows(text).next().is_some_and(columns::is_header));
    let count = columns.count();
    rows(text).skip(skipped).map(move |line| {
        let fields = line.fields();
        if fields.len() != count {
            let message = format!("the line has {} values, not {count}", fields.len());
            return Err(line.fault(message, "a value for each column is expected"));
        }
        Ok((line, fields))
    })
}

/// Reads hub, shroud or both.
fn meridians(
    name: &str,
    text: Text<'_>,
    columns: &Columns,
    frame: &Frame,
    to: &mut [Option<Vec<[f64; 2]>>; 2],
    found: &mut Found,
) -> Result<(), Diag> {
    const NAMES: [&str; 2] = ["hub", "shroud"];
    let of_file = NAMES.iter().position(|n| stem(name).to_ascii_lowercase().contains(n));
    let mut read: [Vec<[f64; 2]>; 2] = [Vec::new(), Vec::new()];
    for row in points(text, columns) {
        let (line, fields) = row?;
        let which = match columns.word(Column::Curve, &fields) {
            Some(word) => Some(
                NAMES
                    .iter()
                    .position(|n| word.eq_ignore_ascii_case(n))
                    .ok_or_else(|| line.fault("there is no such curve", "`hub` or `shroud` is expected"))?,
            ),
            None => of_file,
        };
        let Some(which) = which else {
            return Err(Diag::error(codes::NOT_STATED, "the file has a meridian, but does not state of what")
                .label(line.span, "this point has no angle")
                .help("name the file with `hub` or `shroud`, or give it a column `curve` with these words"));
        };
        let point = columns.point(line, &fields, frame)?;
        read[which].push([point.x, point.z]);
        found.point(read[which].len(), line.span)?;
    }
    for ((place, points), name) in to.iter_mut().zip(read).zip(NAMES) {
        if points.is_empty() {
            continue;
        }
        if place.is_some() {
            return Err(Diag::error(codes::CONTRADICTS, format!("two files have points of the {name}"))
                .label(text.end(), "the second one")
                .help("give one of them"));
        }
        *place = Some(meridian::checked(name, points, text.end(), found)?);
    }
    Ok(())
}

/// Name of a file without folder and ending. A number is no ending, but that of the section.
fn stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let ending = |e: &str| !e.chars().all(|c| c.is_ascii_digit());
    file.rsplit_once('.').filter(|(_, e)| ending(e)).map_or(file, |(stem, _)| stem)
}

/// Blade and section of the name of a file: `main_blade_section_03` is section 3 of `main blade`.
fn of_name(name: &str) -> (String, String) {
    let stem = stem(name);
    let blade = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    let section = stem.get(blade.len()..).unwrap_or_default().to_owned();
    let words = blade.split(['_', '-', ' ', '.']).filter(|w| !w.is_empty() && !w.eq_ignore_ascii_case("section"));
    (words.collect::<Vec<_>>().join(" "), section)
}

/// Reads the curves of a file with points of blades.
fn curves(
    name: &str,
    text: Text<'_>,
    columns: &Columns,
    frame: &Frame,
    to: &mut Vec<ReadCurve>,
    found: &mut Found,
) -> Result<(), Diag> {
    let of_file = of_name(name);
    let before = to.len();
    for row in points(text, columns) {
        let (line, fields) = row?;
        let word = |column: Column| columns.word(column, &fields);
        let key = Key {
            blade: word(Column::Blade).unwrap_or(&of_file.0).to_owned(),
            section: word(Column::Section).unwrap_or(&of_file.1).to_owned(),
            face: word(Column::Face).map(|word| face(word, line)).transpose()?.flatten(),
        };
        if to.len() == before || to.last().is_none_or(|curve| curve.key != key) {
            if let Some(other) = to.iter().find(|curve| curve.key == key) {
                return Err(Diag::error(codes::CONTRADICTS, "the same section again")
                    .label(
                        line.span,
                        format!("section `{}` of blade `{}`", printable(&key.section), printable(&key.blade)),
                    )
                    .label(other.begins, "it stands here as well")
                    .help("the lines of a section follow one another; give each section and file its own number"));
            }
            let span_fraction = match word(Column::Span) {
                None | Some("") => None,
                Some(_) => columns.number(Column::Span, line, &fields)?,
            };
            within(to.len() + 1, 2 * limits::SECTIONS * limits::BLADES, "sections", line.span)?;
            let (points, thickness) = (Vec::new(), Vec::new());
            to.push(ReadCurve { key, span_fraction, points, thickness, begins: line.span, ends: line.span });
        }
        let Some(curve) = to.last_mut() else { continue };
        curve.points.push(columns.point(line, &fields, frame)?);
        if let Some(thickness) = columns.number(Column::Thickness, line, &fields)? {
            if thickness < 0.0 {
                return Err(line.fault("a thickness is negative", "0 or more is expected"));
            }
            curve.thickness.push(frame.length(thickness));
        }
        curve.ends = line.span;
        found.point(curve.points.len(), line.span)?;
    }
    if to.len() == before { Err(ends(text, "the first point")) } else { Ok(()) }
}

/// The face of a word; an empty word stands for the whole loop.
fn face(word: &str, line: Line<'_>) -> Result<Option<usize>, Diag> {
    match word.to_ascii_lowercase().as_str() {
        "" => Ok(None),
        "pressure" => Ok(Some(0)),
        "suction" => Ok(Some(1)),
        _ => Err(line.fault("there is no such face", "`pressure` or `suction` is expected")),
    }
}

/// The blades of all curves, the main blade first.
fn blades(curves: Vec<ReadCurve>, options: &Options, found: &mut Found) -> Result<Vec<ImportedBlade>, Diag> {
    let mut groups: Vec<(String, Vec<ReadCurve>)> = Vec::new();
    for curve in curves {
        let at = curve.begins;
        match groups.iter_mut().find(|(name, _)| *name == curve.key.blade) {
            Some((_, group)) => group.push(curve),
            None => groups.push((curve.key.blade.clone(), vec![curve])),
        }
        within(groups.len(), limits::BLADES, "blades", at)?;
    }
    let is_splitter = |name: &str| name.to_ascii_lowercase().contains("splitter");
    groups.sort_by_key(|(name, _)| is_splitter(name));
    let mains: Vec<_> = groups.iter().filter(|(name, _)| !is_splitter(name)).collect();
    if mains.len() != 1
        && let Some((_, curves)) = groups.first()
        && let Some(curve) = curves.first()
    {
        let names: Vec<_> = groups.iter().map(|(name, _)| format!("`{}`", printable(name))).collect();
        return Err(Diag::error(codes::NOT_STATED, format!("{} blades are no splitters, not one", mains.len()))
            .label(curve.begins, "a blade begins here")
            .note(format!("the blades are {}", names.join(", ")))
            .help(
                "give `splitter` in the names of all blades but the main blade, in the column `blade` or in file names",
            ));
    }
    groups.into_iter().map(|(name, curves)| blade(name, curves, options, found)).collect()
}

/// The sections of a blade in the order of their numbers.
fn blade(
    name: String,
    mut curves: Vec<ReadCurve>,
    options: &Options,
    found: &mut Found,
) -> Result<ImportedBlade, Diag> {
    let numbers: Vec<Option<f64>> =
        curves.iter().map(|c| c.key.section.parse().ok().filter(|n: &f64| n.is_finite())).collect();
    if numbers.iter().all(Option::is_some) {
        let mut order: Vec<(f64, ReadCurve)> = numbers.into_iter().flatten().zip(curves).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        curves = order.into_iter().map(|(_, curve)| curve).collect();
    }
    let at = curves.last().map(|c| c.ends).unwrap_or_default();
    let kinds = |kind: fn(&ReadCurve) -> bool| curves.iter().filter(|c| kind(c)).count();
    let (with_face, with_thickness) = (kinds(|c| c.key.face.is_some()), kinds(|c| !c.thickness.is_empty()));
    let PlacedSections { sections, places } = if with_thickness > 0 {
        mean_lines(curves, options, at)?
    } else if with_face > 0 {
        faces(curves)?
    } else {
        let read = |c: ReadCurve| ReadLoop {
            points: c.points,
            span_fraction: c.span_fraction,
            begins: c.begins,
            ends: c.ends,
        };
        loops::close(curves.into_iter().map(read).collect(), found)?
    };
    loops::enough(sections.len(), &name, at)?;
    within(sections.len(), limits::SECTIONS, "sections of a blade", at)?;
    found.note(
        at,
        format!("blade `{}`: {} sections, taken to run from hub to shroud", printable(&name), sections.len()),
    );
    Ok(ImportedBlade { name, sections, places, ..ImportedBlade::default() })
}

/// Sections as mean lines.
fn mean_lines(curves: Vec<ReadCurve>, options: &Options, at: Span) -> Result<PlacedSections, Diag> {
    let Some(direction) = options.thickness else {
        return Err(not_stated("direction of its thicknesses", "--thickness", "normal or tangential", at));
    };
    let section = |curve: ReadCurve| {
        let points = curve.points.into_iter().zip(curve.thickness);
        let points = points.map(|(position, thickness)| MeanPoint { position, thickness }).collect();
        Section { span: curve.span_fraction, form: SectionForm::MeanLine { points, thickness: direction } }
    };
    let places = curves.iter().map(|c| c.begins).collect();
    Ok(PlacedSections { sections: curves.into_iter().map(section).collect(), places })
}

/// A section whose faces are read one after the other.
#[derive(Debug)]
struct ReadFaces {
    key: Key,
    span_fraction: Option<f64>,
    faces: [Option<Vec<Point3<f64>>>; 2],
    begins: Span,
}

/// Sections as pairs of faces.
fn faces(curves: Vec<ReadCurve>) -> Result<PlacedSections, Diag> {
    let mut sections: Vec<ReadFaces> = Vec::new();
    for curve in curves {
        let Some(face) = curve.key.face else {
            return Err(Diag::error(codes::MALFORMED, "some sections have faces and others have none")
                .label(curve.begins, "this section has no face")
                .help("give each line its face: `pressure` or `suction`"));
        };
        let key = Key { face: None, ..curve.key };
        match sections.iter_mut().find(|s| s.key == key) {
            Some(section) => section.faces[face] = Some(curve.points),
            None => {
                let mut faces = [None, None];
                faces[face] = Some(curve.points);
                sections.push(ReadFaces { key, span_fraction: curve.span_fraction, faces, begins: curve.begins });
            }
        }
    }
    let places = sections.iter().map(|s| s.begins).collect();
    let section = |ReadFaces { key, span_fraction: span, faces, begins }: ReadFaces| match faces {
        [Some(pressure), Some(suction)] => Ok(Section { span, form: SectionForm::Faces([pressure, suction]) }),
        _ => Err(Diag::error(codes::ENDS_EARLY, format!("section `{}` has only one face", printable(&key.section)))
            .label(begins, "its face begins here")
            .help("give points of both faces, each from the leading to the trailing edge")),
    };
    let sections = sections.into_iter().map(section).collect::<Result<_, _>>()?;
    Ok(PlacedSections { sections, places })
}
