//! BladeGen `.rtzt`: mean lines (r, theta, z, thickness) of main blade and splitters, angles in radians.
//!
//! The file has no unit, hub, shroud or edges. It may leave out whether thicknesses are normal or tangential.

use super::found::{Found, within};
use super::frame::{Axis, Frame};
use super::lines::{Line, Text, ends};
use super::loader::Loader;
use super::loops;
use super::stated::{RequiredFacts, not_stated};
use super::{Imported, ImportedBlade, ImportedRow, Options, limits};
use base::source::{SourceId, Spanned};
use blade::{MeanPoint, Section, SectionForm, ThicknessDirection};
use diagnostics::Diag;
use diagnostics::codes::import as codes;

pub(super) fn read(
    ids: &[SourceId],
    loader: &mut Loader<'_>,
    options: &Options,
    found: &mut Found,
) -> Result<Imported, Diag> {
    let Some(id) = ids.first().copied() else { return Ok(Imported::default()) };
    let text = loader.text(id);
    let mut lines = text.lines();
    let line = next(&mut lines, text, "the number of blades")?;
    let count = line.count(line.text, "blades", limits::COUNT as usize)?;
    let count = Spanned::new(u32::try_from(count).unwrap_or(0), line.span);
    let line = next(&mut lines, text, "the number of splitters")?;
    let splitters = line.count(line.text, "splitters", usize::MAX)?;
    within(splitters.saturating_add(1), limits::BLADES, "blades", line.span)?;

    let mut required = RequiredFacts::of(options, found, line.span);
    let unit = required.unit(None)?;
    let axis = required.axis(Some(Spanned::new(Axis::Z, line.span)))?;
    let handedness = required.handedness(None)?;
    let count = required.blades(Some(count))?;
    required.end()?;
    let frame = Frame { mm: unit.mm(), axis, handedness };
    let mut blades = Vec::new();
    for k in 0..=splitters {
        blades.push(blade(k, &mut lines, text, &frame, options, found)?);
    }
    if let Some(line) = lines.next() {
        return Err(line.fault("there is more than the blades that the file announces", "nothing is expected here"));
    }
    let row = ImportedRow { name: String::new(), count, blades };
    Ok(Imported { rows: vec![row], ..Imported::default() })
}

fn next<'t>(lines: &mut impl Iterator<Item = Line<'t>>, text: Text<'_>, missing: &str) -> Result<Line<'t>, Diag> {
    lines.next().ok_or_else(|| ends(text, missing))
}

fn blade<'t>(
    k: usize,
    lines: &mut impl Iterator<Item = Line<'t>>,
    text: Text<'_>,
    frame: &Frame,
    options: &Options,
    found: &mut Found,
) -> Result<ImportedBlade, Diag> {
    let name = if k == 0 { "main".to_owned() } else { format!("splitter {k}") };
    let line = next(lines, text, &format!("the pitch fraction of the blade `{name}`"))?;
    let [pitch] = line.numbers("a pitch fraction is expected")?;
    let pitch_share = (k > 0).then_some(pitch);
    if k > 0 {
        let what = "the splitter stands at this share of the pitch, and its angles do not hold it";
        found.note(line.span, format!("{what} (taken for granted: {pitch})"));
    }
    let line = next(lines, text, &format!("the number of layers of the blade `{name}`"))?;
    let layers = line.count(line.text, "layers", usize::MAX)?;
    within(layers, limits::SECTIONS, "sections of a blade", line.span)?;
    // The direction may be left out, so the next line may be that of the first layer.
    let line = next(lines, text, "the first layer")?;
    let stated = match line.text.to_ascii_uppercase().as_str() {
        "N" => Some(ThicknessDirection::Normal),
        "T" => Some(ThicknessDirection::Tangential),
        _ => None,
    };
    let direction = match (stated, options.thickness) {
        (Some(file), Some(given)) if file != given => {
            return Err(Diag::error(codes::CONTRADICTS, "`--thickness` says something else than the file")
                .label(line.span, "N is normal, T is tangential")
                .help("leave out `--thickness`, or correct the file"));
        }
        (file, given) => file.or(given).ok_or_else(|| {
            not_stated("direction of its thicknesses", "--thickness", "normal or tangential", line.span)
        })?,
    };
    found.note(line.span, format!("thicknesses are {direction:?}").to_lowercase());
    let mut first = stated.is_none().then_some(line);
    let (mut sections, mut places) = (Vec::new(), Vec::new());
    for layer in 0..layers {
        let line = match first.take() {
            Some(line) => line,
            None => next(lines, text, &format!("layer {} of {layers}", layer + 1))?,
        };
        sections.push(self::layer(line, lines, text, direction, frame, found)?);
        places.push(line.span);
    }
    loops::enough(sections.len(), &name, text.end())?;
    Ok(ImportedBlade { name, sections, places, pitch_share, ..ImportedBlade::default() })
}

/// A layer: its head, and a point in each line.
fn layer<'t>(
    head: Line<'t>,
    lines: &mut impl Iterator<Item = Line<'t>>,
    text: Text<'_>,
    direction: ThicknessDirection,
    frame: &Frame,
    found: &mut Found,
) -> Result<Section, Diag> {
    let fields = head.fields();
    let [span, count, uses @ ..] = fields.as_slice() else {
        return Err(head.fault("the head of a layer has too few values", "a span fraction and a number of points"));
    };
    let (span, count) = (head.number(span)?, head.count(count, "points", limits::POINTS_OF_CURVE)?);
    match uses.iter().map(|w| w.to_ascii_lowercase()).collect::<String>().as_str() {
        "" | "b" => {}
        "a" => found.note(head.span, "the layer is used for angles; its thicknesses are taken as well"),
        "t" => {
            return Err(Diag::error(codes::NOT_READ, "a layer for thicknesses alone is not read")
                .label(head.span, "this layer")
                .help("export the blade with layers for angle and thickness, or as points (`.inf`)"));
        }
        _ => return Err(head.fault("the use of a layer is not known", "a, t or b is expected")),
    }
    let mut points = Vec::new();
    for k in 0..count {
        let line = next(lines, text, &format!("point {} of {count}", k + 1))?;
        let [r, theta, z, thickness] = line.numbers("r, theta, z and thickness are expected")?;
        if thickness < 0.0 {
            return Err(line.fault("a thickness is negative", "0 or more is expected"));
        }
        let position = frame.cylindrical(r, theta, z, line.span)?;
        points.push(MeanPoint { position, thickness: frame.length(thickness) });
        found.point(points.len(), line.span)?;
    }
    if points.len() < 2 {
        return Err(head.fault("a layer has fewer than two points", "this layer"));
    }
    Ok(Section { span: Some(span), form: SectionForm::MeanLine { points, thickness: direction } })
}
