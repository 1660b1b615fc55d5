//! TurboGrid and BladeGen: an `.inf` file that names files with the points of hub, shroud and blades.
//!
//! The `.inf` file has a key and a value in each line. The files of hub and shroud have a point in each line. The file of
//! the blades has `## name` before each blade, where there are several, and `# text` before each section.

use super::edge_tags::{self, EdgeTag};
use super::found::{Found, within};
use super::frame::{Axis, Frame, Handedness, LengthUnit};
use super::lines::{Line, Text, ends};
use super::loader::Loader;
use super::loops::{self, PlacedSections, ReadLoop};
use super::stated::RequiredFacts;
use super::{Imported, ImportedBlade, ImportedRow, Options, limits, meridian};
use base::source::{SourceId, Span, Spanned};
use blade::EdgeForm;
use diagnostics::Diag;
use diagnostics::codes::import as codes;

/// What an `.inf` file states.
#[derive(Debug, Default)]
struct Index {
    axis: Option<Spanned<Axis>>,
    unit: Option<Spanned<LengthUnit>>,
    handedness: Option<Spanned<Handedness>>,
    sets: Option<Spanned<u32>>,
    per_set: Option<Spanned<u32>>,
    hub: Option<Spanned<String>>,
    shroud: Option<Spanned<String>>,
    profile: Option<Spanned<String>>,
    /// Blade, end (leading, trailing), form.
    edges: Vec<(usize, usize, EdgeForm)>,
}

pub(super) fn read(
    ids: &[SourceId],
    loader: &mut Loader<'_>,
    options: &Options,
    found: &mut Found,
) -> Result<Imported, Diag> {
    let Some(id) = ids.first().copied() else { return Ok(Imported::default()) };
    let text = loader.text(id);
    let index = index(text, found)?;
    let at = text.end();
    let mut required = RequiredFacts::of(options, found, at);
    let axis = required.axis(index.axis.clone())?;
    let unit = required.unit(index.unit.clone())?;
    let handedness = required.handedness(index.handedness.clone())?;
    let count = required.blades(index.sets.clone())?;
    required.end()?;
    let frame = Frame { mm: unit.mm(), axis, handedness };

    let mut load = |what: &str, name: &Option<Spanned<String>>| match name {
        Some(name) => loader.in_same_folder(id, &name.value, name.span),
        None => Err(ends(loader.text(id), &format!("the line `{what} Data File: NAME`"))),
    };
    let [hub, shroud, profile] =
        [load("Hub", &index.hub), load("Shroud", &index.shroud), load("Profile", &index.profile)];
    let mut curve = |name: &str, file: Result<SourceId, Diag>| curve(name, loader.text(file?), &frame, found);
    let (hub, shroud) = (curve("hub", hub)?, curve("shroud", shroud)?);
    let mut blades = blades(loader.text(profile?), &frame, found)?;
    if let Some(per_set) = &index.per_set
        && usize::try_from(per_set.value).ok() != Some(blades.len())
    {
        let message =
            format!("{} blades in each set are stated, but the profiles have {}", per_set.value, blades.len());
        return Err(Diag::error(codes::CONTRADICTS, message)
            .label(per_set.span, "stated here")
            .help("the file of the profiles has a line `## name` before each blade; export both files again"));
    }
    for (blade, end, kind) in index.edges {
        if let Some(blade) = blades.get_mut(blade) {
            blade.edges[end] = Some(kind);
        }
    }
    blades.iter_mut().try_for_each(edge_tags::forms)?;
    let row = ImportedRow { name: String::new(), count, blades };
    Ok(Imported { hub: Some(hub), shroud: Some(shroud), rows: vec![row], ..Imported::default() })
}

/// Reads the `.inf` file. The order of its lines is free.
fn index(text: Text<'_>, found: &mut Found) -> Result<Index, Diag> {
    let mut index = Index::default();
    for line in text.lines().filter(|line| !line.text.starts_with('!')) {
        // A path may have a colon as well.
        let Some((key, value)) = line.text.split_once(':').map(|(k, v)| (k.trim(), v.trim())) else {
            return Err(line.fault("the line has no colon", "`key: value` is expected"));
        };
        if value.is_empty() {
            return Err(line.fault(format!("`{key}` has no value"), "`key: value` is expected"));
        }
        entry(&mut index, key, value, line, found)?;
    }
    Ok(index)
}

fn entry(index: &mut Index, key: &str, value: &str, line: Line<'_>, found: &mut Found) -> Result<(), Diag> {
    let whole = || value.parse::<u32>().map_err(|_| line.fault("this is not a whole number", "a count is expected"));
    let name = || Ok(value.to_owned());
    match key.to_ascii_lowercase().as_str() {
        "axis of rotation" => once(&mut index.axis, line, || {
            Axis::named(value).ok_or_else(|| line.fault("there is no such axis", "X, Y or Z is expected"))
        }),
        "geometry units" => once(&mut index.unit, line, || {
            LengthUnit::named(value)
                .ok_or_else(|| line.fault("there is no such unit", "MM, CM, M, IN or FT is expected"))
        }),
        "coordinate system orientation" => once(&mut index.handedness, line, || {
            Handedness::named(value)
                .ok_or_else(|| line.fault("there is no such orientation", "Righthanded or Lefthanded is expected"))
        }),
        "number of blade sets" => once(&mut index.sets, line, whole),
        "number of blades per set" => once(&mut index.per_set, line, whole),
        "hub data file" => once(&mut index.hub, line, name),
        "shroud data file" => once(&mut index.shroud, line, name),
        "profile data file" => once(&mut index.profile, line, name),
        "blade loft direction" => {
            found.note(line.span, format!("the surfaces are lofted {}", value.to_lowercase()));
            Ok(())
        }
        other => match edge(other) {
            Some((blade, end)) => {
                let kind = match value.to_ascii_lowercase().as_str() {
                    "ellipseend" => EdgeForm::Round,
                    "cutoffend" => EdgeForm::CutOff,
                    _ => return Err(line.fault("there is no such edge", "EllipseEnd or CutOffEnd is expected")),
                };
                index.edges.push((blade, end, kind));
                within(index.edges.len(), 2 * limits::BLADES, "edges", line.span)
            }
            None => {
                found.note(line.span, format!("`{key}` is not used"));
                Ok(())
            }
        },
    }
}

/// Blade and end of a key such as `blade 0 le`.
fn edge(key: &str) -> Option<(usize, usize)> {
    let mut words = key.strip_prefix("blade ")?.split_whitespace();
    let blade = words.next()?.parse().ok()?;
    let end = match words.next()? {
        "le" => 0,
        "te" => 1,
        _ => return None,
    };
    words.next().is_none().then_some((blade, end))
}

/// Sets a value that a file states once.
fn once<T>(
    place: &mut Option<Spanned<T>>,
    line: Line<'_>,
    value: impl FnOnce() -> Result<T, Diag>,
) -> Result<(), Diag> {
    if let Some(before) = place {
        return Err(Diag::error(codes::CONTRADICTS, "the same key again")
            .label(line.span, "given here")
            .label(before.span, "and here")
            .help("remove one of the lines"));
    }
    *place = Some(Spanned::new(value()?, line.span));
    Ok(())
}

/// Reads hub or shroud.
fn curve(name: &str, text: Text<'_>, frame: &Frame, found: &mut Found) -> Result<Vec<[f64; 2]>, Diag> {
    let mut points = Vec::new();
    for line in text.lines().filter(|line| !is_comment(line.text)) {
        points.push(frame.point(line.numbers("x, y and z are expected")?, line.span)?);
        found.point(points.len(), line.span)?;
    }
    meridian::reduced(name, &points, text.end(), found)
}

fn is_comment(line: &str) -> bool {
    line.starts_with(['!', '#'])
}

/// A blade as the file has it.
#[derive(Debug)]
struct ReadBlade {
    name: String,
    loops: Vec<ReadLoop>,
    tags: Vec<EdgeTag>,
}

/// Reads the sections of all blades.
fn blades(text: Text<'_>, frame: &Frame, found: &mut Found) -> Result<Vec<ImportedBlade>, Diag> {
    let mut read: Vec<ReadBlade> = Vec::new();
    for line in text.lines().filter(|line| !line.text.starts_with('!')) {
        if let Some(name) = line.text.strip_prefix("##") {
            read.push(ReadBlade { name: name.trim().to_owned(), loops: Vec::new(), tags: Vec::new() });
            within(read.len(), limits::BLADES, "blades", line.span)?;
        } else if let Some(title) = line.text.strip_prefix('#') {
            if read.is_empty() {
                read.push(ReadBlade { name: String::new(), loops: Vec::new(), tags: Vec::new() });
            }
            let Some(blade) = read.last_mut() else { continue };
            let span_fraction = span_fraction(title);
            blade.loops.push(ReadLoop { points: Vec::new(), span_fraction, begins: line.span, ends: line.span });
            within(blade.loops.len(), limits::SECTIONS, "sections of a blade", line.span)?;
        } else {
            let Some((section, tags, at)) = read.last_mut().and_then(|ReadBlade { loops, tags, .. }| {
                let at = loops.len().saturating_sub(1);
                Some((loops.last_mut()?, tags, at))
            }) else {
                return Err(line.fault("a point before the first section", "`# name of the section` is expected"));
            };
            let (numbers, tag) = edge_tags::split(line);
            let point = frame.point(numbers.numbers("x, y and z are expected")?, line.span)?;
            section.points.push(point);
            section.ends = line.span;
            if let Some(word) = tag {
                let (edge, corner) = edge_tags::edge(word, line)?;
                tags.push(EdgeTag { section: at, edge, corner, point, place: line.span });
            }
            found.point(section.points.len(), line.span)?;
        }
    }
    if read.is_empty() {
        return Err(ends(text, "the first section"));
    }
    let names = (0..).map(|k: usize| if k == 0 { "main".to_owned() } else { format!("splitter {k}") });
    read.into_iter()
        .zip(names)
        .map(|(blade, plain)| {
            let name = if blade.name.is_empty() { plain } else { blade.name };
            let last = blade.loops.last().map_or(text.end(), |l| l.ends);
            loops::enough(blade.loops.len(), &name, last)?;
            check_spans(&blade.loops)?;
            let PlacedSections { sections, places } = loops::close(blade.loops, found)?;
            Ok(ImportedBlade { name, sections, places, tags: blade.tags, ..ImportedBlade::default() })
        })
        .collect()
}

/// The share of the height at the end of a title such as `Profile 1 at 25.0000%`.
fn span_fraction(title: &str) -> Option<f64> {
    let number = title.trim().strip_suffix('%')?.trim_end();
    let number = number.rsplit(char::is_whitespace).next()?;
    number.parse::<f64>().ok().filter(|n| n.is_finite()).map(|n| n / 100.0)
}

/// Sections run from hub to shroud.
fn check_spans(loops: &[ReadLoop]) -> Result<(), Diag> {
    for pair in loops.windows(2) {
        let [before, after] = pair else { continue };
        if let (Some(a), Some(b)) = (before.span_fraction, after.span_fraction)
            && b <= a
        {
            return Err(misplaced(before.begins, after.begins));
        }
    }
    Ok(())
}

fn misplaced(before: Span, after: Span) -> Diag {
    Diag::error(codes::CONTRADICTS, "the sections do not run from hub to shroud")
        .label(after, "this section is not above")
        .label(before, "this one")
        .help("order the sections by their share of the height")
}
