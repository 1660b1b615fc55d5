//! NUMECA `.geomTurbo`: blocks `NI_BEGIN name` to `NI_END name` with hub, shroud and faces of blades.
//!
//! The axis of rotation is the third coordinate. The words `suction` and `pressure` say which face is which, in any order;
//! `# section` is a comment or stands before each section. Blocks and words that are not known are passed over.

use super::closed_faces;
use super::found::{Found, too_many, within};
use super::frame::{Axis, Frame};
use super::lines::{Line, Text, ends, malformed};
use super::loader::Loader;
use super::loops;
use super::nested::Open;
use super::stated::{RequiredFacts, same_unit};
use super::{Imported, ImportedBlade, ImportedRow, Options, limits, meridian};
use base::source::{SourceId, Span, Spanned};
use blade::{Section, SectionForm};
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};
use nalgebra::Point3;

/// A face: its sections with their first lines, in the unit of the file.
type ReadFace = Vec<(Vec<[f64; 3]>, Span)>;

/// A blade as the file has it.
#[derive(Debug)]
struct ReadBlade {
    name: String,
    /// Pressure, suction.
    faces: [Option<ReadFace>; 2],
    metres: Option<Spanned<f64>>,
    tip_gap: [Option<f64>; 2],
    begins: Span,
}

/// A row as the file has it.
#[derive(Debug)]
struct ReadRow {
    name: String,
    periodicity: Option<Spanned<u32>>,
    blades: Vec<ReadBlade>,
    begins: Span,
}

/// Hub or shroud by vertices: the curve of each, and its place on it, 0 or 1.
#[derive(Debug)]
struct Channel<'t> {
    name: String,
    vertices: Vec<(&'t str, bool, Span)>,
}

/// What was read so far.
#[derive(Debug, Default)]
struct Reading<'t> {
    open: Open<'t>,
    /// Name of the curve that is open, and all curves with points (z, r).
    curve: String,
    curves: Vec<ReadCurve>,
    /// Hub and shroud as curves that follow one another.
    channels: Vec<Channel<'t>>,
    /// Metres of a unit, stated at the head.
    metres: Option<Spanned<f64>>,
    rows: Vec<ReadRow>,
    /// Face whose sections come next.
    face: Option<usize>,
}

pub(super) fn read(
    ids: &[SourceId],
    loader: &mut Loader<'_>,
    options: &Options,
    found: &mut Found,
) -> Result<Imported, Diag> {
    let Some(id) = ids.first().copied() else { return Ok(Imported::default()) };
    let text = loader.text(id);
    let Reading { curves, channels, metres, rows, .. } = parse(text, found)?;
    if rows.iter().all(|row| row.blades.is_empty()) {
        return Err(ends(text, "the first blade"));
    }
    let of_blades = rows.iter().flat_map(|row| &row.blades).find_map(|blade| blade.metres.clone());
    let stated = metres.or(of_blades);
    let mut required = RequiredFacts::of(options, found, text.end());
    let axis = required.axis(Some(Spanned::new(Axis::Z, text.end())))?;
    let handedness = required.handedness(None)?;
    // The file states metres per unit, which need not be a unit with a name.
    let mm = match &stated {
        Some(metres) => {
            let mm = 1000.0 * metres.value;
            let says = format!("a unit of length of the file is {} m", metres.value);
            same_unit(options, mm, &says, metres.span)?;
            mm
        }
        None => required.unit(None)?.mm(),
    };
    required.end()?;
    if let Some(metres) = &stated {
        found.note(
            metres.span,
            format!("a unit of length is {} m; hub and shroud are taken to have it too", metres.value),
        );
    }
    let frame = Frame { mm, axis, handedness };
    let mut imported = Imported::default();
    for (name, points, at) in flow_path(curves, &channels, &frame, found)? {
        let points = points.into_iter().map(|[z, r]| frame.meridian(r, z, at)).collect::<Result<_, _>>()?;
        let points = meridian::checked(&name, points, at, found)?;
        if name == "hub" { imported.hub = Some(points) } else { imported.shroud = Some(points) }
    }
    for row in rows.into_iter().filter(|row| !row.blades.is_empty()) {
        let at = row.begins;
        let mut row = self::row(row, &frame, options, found)?;
        // Edges of loops are found along the hub.
        if imported.hub.is_some() && imported.shroud.is_some() {
            closed(&mut row, at, found);
        }
        imported.rows.push(row);
    }
    Ok(imported)
}

/// A curve of the file: its name, points (z, r) in the unit of the file, place.
type ReadCurve = (String, Vec<[f64; 2]>, Span);

/// Ends of curves that follow one another are nearer than this, mm.
const MEET: f64 = 0.02;

/// Hub and shroud: the curves that their vertices name, otherwise those with their names.
fn flow_path(
    curves: Vec<ReadCurve>,
    channels: &[Channel<'_>],
    frame: &Frame,
    found: &mut Found,
) -> Result<Vec<ReadCurve>, Diag> {
    let mut path = Vec::new();
    let mut used = vec![false; curves.len()];
    for name in ["hub", "shroud"] {
        let channel = channels.iter().find(|c| c.name == name && !c.vertices.is_empty());
        match channel {
            Some(channel) => path.push(chained(channel, &curves, &mut used, frame, found)?),
            None => {
                if let Some(k) = curves.iter().position(|(n, ..)| n.eq_ignore_ascii_case(name)) {
                    used[k] = true;
                    path.push((name.to_owned(), curves[k].1.clone(), curves[k].2));
                }
            }
        }
    }
    for ((name, _, at), _) in curves.iter().zip(used).filter(|(_, used)| !used) {
        found.note(*at, format!("the curve `{}` is not used", printable(name)));
    }
    Ok(path)
}

/// The curves of the vertices, each from its first vertex to its last one.
fn chained(
    channel: &Channel<'_>,
    curves: &[ReadCurve],
    used: &mut [bool],
    frame: &Frame,
    found: &mut Found,
) -> Result<ReadCurve, Diag> {
    let mut all: Vec<[f64; 2]> = Vec::new();
    let mut place = None;
    let mut names: Vec<String> = Vec::new();
    for group in channel.vertices.chunk_by(|a, b| a.0 == b.0) {
        let Some(&(name, at_end, span)) = group.first() else { continue };
        let Some(k) = curves.iter().position(|(n, ..)| n == name) else {
            return Err(malformed(format!("there is no curve `{}`", printable(name)), span, "named by this vertex"));
        };
        used[k] = true;
        let mut points = curves[k].1.clone();
        // A curve with one vertex alone is taken in its own direction.
        if group.len() > 1 && at_end {
            points.reverse();
        }
        if let Some((before, first)) = all.last().zip(points.first()) {
            let gap = frame.length(libm::hypot(first[0] - before[0], first[1] - before[1]));
            if gap > MEET {
                let message = format!("the curves of the {} do not meet", channel.name);
                return Err(Diag::error(codes::CONTRADICTS, message)
                    .label(span, format!("this curve begins {gap:.3} mm from the end of the one before"))
                    .help("give the vertices of the curves in their order from inlet to outlet"));
            }
        }
        names.push(format!("`{}`", printable(name)));
        place.get_or_insert(curves[k].2);
        all.extend(points);
    }
    let at = place.unwrap_or_default();
    found.note(at, format!("the {} is {}, by its vertices", channel.name, names.join(", then ")));
    Ok((channel.name.clone(), all, at))
}

fn parse<'t>(text: Text<'t>, found: &mut Found) -> Result<Reading<'t>, Diag> {
    let mut reading = Reading::default();
    let mut lines = text.lines().filter(|line| !line.text.starts_with('#'));
    while let Some(line) = lines.next() {
        let (word, rest) = line.text.split_once(char::is_whitespace).unwrap_or((line.text, ""));
        let rest = rest.trim();
        match word.to_ascii_uppercase().as_str() {
            "NI_BEGIN" => reading.begin(rest, line)?,
            // The header has no begin of its own.
            "NI_END" if rest.eq_ignore_ascii_case("GEOMTURBO") && reading.open.is_empty() => {}
            "NI_END" => reading.open.end(rest, line)?,
            "ZR" if reading.open.is_in("zrcurve") => {
                let points = self::points::<2>(&mut lines, text, "z and r are expected", found)?;
                let name = reading.curve.clone();
                reading.curves.push((name, points, line.span));
                within(reading.curves.len(), limits::ROWS, "curves", line.span)?;
            }
            "SECTIONAL" if reading.open.is_in("nibladegeometry") => {
                let Some(face) = reading.face.take() else {
                    return Err(line.fault("sections without a face", "`suction` or `pressure` is expected before"));
                };
                let sections = self::face(&mut lines, text, found)?;
                let Some(blade) = reading.blade() else { continue };
                if blade.faces[face].replace(sections).is_some() {
                    return Err(line.fault("the same face again", "a blade has one of each"));
                }
            }
            _ => reading.entry(word, rest, line)?,
        }
    }
    reading.open.closed(text)?;
    Ok(reading)
}

impl<'t> Reading<'t> {
    fn blade(&mut self) -> Option<&mut ReadBlade> {
        self.rows.last_mut().and_then(|row| row.blades.last_mut())
    }

    fn begin(&mut self, name: &'t str, line: Line<'t>) -> Result<(), Diag> {
        match name.to_ascii_lowercase().as_str() {
            "basic_curve" => self.curve.clear(),
            "nirow" => {
                let row = ReadRow { name: String::new(), periodicity: None, blades: Vec::new(), begins: line.span };
                self.rows.push(row);
                within(self.rows.len(), limits::ROWS, "rows of blades", line.span)?;
            }
            "niblade" => {
                let Some(row) = self.rows.last_mut().filter(|_| self.open.is_within("nirow")) else {
                    return Err(line.fault("a blade outside of a row", "`NI_BEGIN nirow` is expected before"));
                };
                row.blades.push(ReadBlade {
                    name: String::new(),
                    faces: [None, None],
                    metres: None,
                    tip_gap: [None; 2],
                    begins: line.span,
                });
                self.face = None;
                within(row.blades.len(), limits::BLADES, "blades of a row", line.span)?;
            }
            lower => {
                if let Some(of) = lower.strip_prefix("channel_curve") {
                    self.channels.push(Channel { name: of.trim().to_owned(), vertices: Vec::new() });
                    within(self.channels.len(), limits::ROWS, "curves of the channel", line.span)?;
                }
            }
        }
        self.open.begin(name, line)
    }

    /// A vertex of hub or shroud: `CURVE_P name 0` or `CURVE_P name 1`.
    fn vertex(&mut self, rest: &'t str, line: Line<'_>) -> Result<(), Diag> {
        let due = "`VERTEX CURVE_P name 0` or `1` is expected";
        let parts = rest.split_once(char::is_whitespace).filter(|(kind, _)| kind.eq_ignore_ascii_case("CURVE_P"));
        // A name may have blanks.
        let parts = parts.and_then(|(_, of)| of.trim().rsplit_once(char::is_whitespace));
        let Some((name, place)) = parts else {
            return Err(line.fault("this vertex is not on a curve", due));
        };
        let place = line.number(place)?;
        if place != 0.0 && place != 1.0 {
            return Err(line.fault("a vertex inside of a curve is not read", due));
        }
        if let Some(channel) = self.channels.last_mut() {
            channel.vertices.push((name.trim(), place == 1.0, line.span));
            within(channel.vertices.len(), limits::ROWS, "vertices of a curve", line.span)?;
        }
        Ok(())
    }

    /// A line that is neither begin nor end of a block, nor begins a list of points.
    fn entry(&mut self, word: &str, rest: &'t str, line: Line<'_>) -> Result<(), Diag> {
        let upper = word.to_ascii_uppercase();
        if upper == "UNITS-FACTOR" {
            self.metres = Some(Spanned::new(metres(rest, line)?, line.span));
        } else if upper == "VERTEX" && self.open.innermost_begins("channel_curve") {
            self.vertex(rest, line)?;
        } else if upper == "NAME" {
            if self.open.is_in("basic_curve") {
                rest.clone_into(&mut self.curve);
            } else if self.open.is_in("niblade") {
                if let Some(blade) = self.blade() {
                    rest.clone_into(&mut blade.name);
                }
            } else if self.open.is_in("nirow")
                && let Some(row) = self.rows.last_mut()
            {
                rest.clone_into(&mut row.name);
            }
        } else if upper == "PERIODICITY" && self.open.is_in("nirow") {
            let count = u32::try_from(line.count(rest, "blades", limits::COUNT as usize)?).unwrap_or(0);
            if let Some(row) = self.rows.last_mut() {
                row.periodicity = Some(Spanned::new(count, line.span));
            }
        } else if self.open.is_in("nitipgap") {
            let ends = ["WIDTH_AT_LEADING_EDGE", "WIDTH_AT_TRAILING_EDGE"];
            if let Some(end) = ends.iter().position(|e| *e == upper) {
                let gap = line.number(rest)?;
                if let Some(blade) = self.blade() {
                    blade.tip_gap[end] = Some(gap);
                }
            }
        } else if self.open.is_in("nibladegeometry") {
            match upper.as_str() {
                "PRESSURE" | "SUCTION" if rest.is_empty() => self.face = Some(usize::from(upper == "SUCTION")),
                "UNITS" => {
                    let metres = metres(rest, line)?;
                    if let Some(blade) = self.blade() {
                        blade.metres = Some(Spanned::new(metres, line.span));
                    }
                }
                // A list of points that no word announces.
                _ if line.number(word).is_ok() && !rest.is_empty() => {
                    return Err(
                        line.fault("points without a list", "`XYZ` and the number of points are expected before")
                    );
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// Metres of a unit of length.
fn metres(text: &str, line: Line<'_>) -> Result<f64, Diag> {
    let metres = line.number(text)?;
    if metres <= 0.0 {
        return Err(line.fault("a unit of length is not positive", "metres of a unit are expected"));
    }
    Ok(metres)
}

/// The next line, or the fault of a text that ends.
fn next<'t>(lines: &mut impl Iterator<Item = Line<'t>>, text: Text<'_>, missing: &str) -> Result<Line<'t>, Diag> {
    lines.next().ok_or_else(|| ends(text, missing))
}

/// A list: its number of points, and a point in each line.
fn points<'t, const N: usize>(
    lines: &mut impl Iterator<Item = Line<'t>>,
    text: Text<'_>,
    due: &str,
    found: &mut Found,
) -> Result<Vec<[f64; N]>, Diag> {
    let line = next(lines, text, "the number of points")?;
    let count = line.count(line.text, "points", usize::MAX)?;
    if count > limits::POINTS_OF_CURVE {
        return Err(too_many("points of a curve", limits::POINTS_OF_CURVE, line.span));
    }
    let mut points = Vec::new();
    for k in 0..count {
        let line = next(lines, text, &format!("point {} of {count}", k + 1))?;
        points.push(line.numbers::<N>(due)?);
        found.point(points.len(), line.span)?;
    }
    Ok(points)
}

/// The sections of a face: their number, and a list of each.
fn face<'t>(lines: &mut impl Iterator<Item = Line<'t>>, text: Text<'_>, found: &mut Found) -> Result<ReadFace, Diag> {
    let line = next(lines, text, "the number of sections")?;
    let count = line.count(line.text, "sections", usize::MAX)?;
    if count > limits::SECTIONS {
        return Err(too_many("sections of a blade", limits::SECTIONS, line.span));
    }
    let mut sections = Vec::new();
    for k in 0..count {
        let line = next(lines, text, &format!("section {} of {count}", k + 1))?;
        if !line.text.eq_ignore_ascii_case("XYZ") {
            return Err(line.fault(format!("section {} of {count} is missing", k + 1), "`XYZ` is expected"));
        }
        let points = points::<3>(lines, text, "x, y and z are expected", found)?;
        if points.len() < 2 {
            return Err(line.fault("a section has fewer than two points on a face", "these points"));
        }
        sections.push((points, line.span));
    }
    Ok(sections)
}

fn row(row: ReadRow, frame: &Frame, options: &Options, found: &mut Found) -> Result<ImportedRow, Diag> {
    let ReadRow { name, periodicity, blades, begins } = row;
    let mut required = RequiredFacts::of(options, found, begins);
    let count = required.blades(periodicity)?;
    required.end()?;
    let blades =
        blades.into_iter().enumerate().map(|(k, read)| blade(k, read, frame, found)).collect::<Result<_, _>>()?;
    Ok(ImportedRow { name, count, blades })
}

/// Takes the sections of a row as loops where their faces meet.
fn closed(row: &mut ImportedRow, at: Span, found: &mut Found) {
    for blade in &mut row.blades {
        if closed_faces::as_loops(blade) {
            let name = printable(&blade.name);
            found.note(at, format!("blade `{name}`: the faces of its sections meet, so that the sections are closed"));
        }
    }
}

fn blade(k: usize, read: ReadBlade, frame: &Frame, found: &mut Found) -> Result<ImportedBlade, Diag> {
    let ReadBlade { name, faces, tip_gap, begins, metres } = read;
    let name = match name.as_str() {
        "" if k == 0 => "main".to_owned(),
        "" => format!("splitter {k}"),
        _ => name,
    };
    if let Some(metres) = metres
        && (1000.0 * metres.value - frame.mm).abs() > 1e-9 * frame.mm
    {
        return Err(Diag::error(codes::CONTRADICTS, "the file has different units")
            .label(metres.span, "another one than that of the head or of the first blade")
            .help("export the file again with one unit"));
    }
    let [Some(pressure), Some(suction)] = faces else {
        return Err(Diag::error(codes::ENDS_EARLY, format!("the blade `{}` lacks a face", printable(&name)))
            .label(begins, "this blade")
            .help("a blade has sections of `suction` and of `pressure`; export the file again"));
    };
    if pressure.len() != suction.len() {
        return Err(Diag::error(codes::CONTRADICTS, "the faces of a blade have different numbers of sections")
            .label(begins, format!("{} on the pressure face, {} on the suction face", pressure.len(), suction.len()))
            .help("export the file again"));
    }
    loops::enough(pressure.len(), &name, begins)?;
    let convert = |(points, at): &(Vec<[f64; 3]>, Span)| {
        points.iter().map(|p| frame.point(*p, *at)).collect::<Result<Vec<Point3<f64>>, Diag>>()
    };
    let mut sections = Vec::with_capacity(pressure.len());
    for (p, s) in pressure.iter().zip(&suction) {
        sections.push(Section { span: None, form: SectionForm::Faces([convert(p)?, convert(s)?]) });
    }
    let places = pressure.iter().map(|(_, at)| *at).collect();
    found.note(
        begins,
        format!(
            "blade `{}`: {} sections, faces from the leading to the trailing edge",
            printable(&name),
            sections.len()
        ),
    );
    let [leading, trailing] = tip_gap;
    let tip_gap = leading.or(trailing).map(|_| [leading, trailing].map(|gap| frame.length(gap.unwrap_or(0.0))));
    Ok(ImportedBlade { name, sections, places, tip_gap, ..ImportedBlade::default() })
}
