//! Points of curves, in the job or in files.

use super::curve_file::{self, MAX_LOOPS, MAX_POINTS};
use crate::block::context::Context;
use crate::block::eval::unknown_unit;
use crate::files::{Fault, MissingFile};
use crate::model::{CurveSpec, LoopSpec};
use crate::property::quantity::{Dimension, Quantity};
use base::source::{SourceId, Span};
use base::units::length;
use blade_files::{LEAST_SIZE, LengthUnit, header_unit};
use diagnostics::Diag;
use diagnostics::codes::{files as file_codes, geometry, job as codes};
use syntax::ast::{Name, Spline, SplinePoints, Text};

/// Most text of curve files in which the curves of a job are looked up, in total, bytes: some ten seconds. Each curve
/// takes one pass through its file.
const MAX_SEARCHED_BYTES: usize = 2_000_000_000;

/// Points of a curve of the job.
pub(super) fn curve(spline: &Spline, cx: &mut Context<'_>) -> Option<CurveSpec> {
    let scale = unit_scale(spline.unit.as_ref(), spline.span, cx);
    let (points, spans) = match &spline.points {
        SplinePoints::Inline(points) => inline(points, cx)?,
        SplinePoints::File { file, curve } => {
            let source = source_of(file, cx)?;
            let found = curve_file::read(source, cx.sources, file, curve, cx.sink)?;
            unit_is_right(file, source, spline.unit.as_ref(), &found.points, cx)?;
            (found.points, found.spans)
        }
    };
    let points = scaled(points, scale, spline.span, cx)?;
    Some(CurveSpec { points, spans, span: spline.span })
}

/// A closed curve of the job; `name` is its name in messages.
pub(super) fn closed(spline: &Spline, name: String, cx: &mut Context<'_>) -> Option<LoopSpec> {
    let CurveSpec { points, spans, span } = curve(spline, cx)?;
    Some(LoopSpec { name, points, spans, edges: None, span })
}

/// All curves of a file, each of them closed.
pub(super) fn closed_from(file: &Text, unit: Option<&Name>, span: Span, cx: &mut Context<'_>) -> Option<Vec<LoopSpec>> {
    let scale = unit_scale(unit, span, cx);
    let source = source_of(file, cx)?;
    let found = curve_file::read_all(source, cx.sources, file, cx.sink)?;
    let points: Vec<[f64; 3]> = found.iter().flat_map(|curve| &curve.points).copied().collect();
    unit_is_right(file, source, unit, &points, cx)?;
    if found.len() > MAX_LOOPS {
        cx.sink.push(
            Diag::error(geometry::POINTS, format!("the blade has more than {MAX_LOOPS} sections, the limit"))
                .label(span, "these sections")
                .help("use fewer sections: 10 to 30 describe a blade"),
        );
        return None;
    }
    let closed = |curve: curve_file::FileCurve| {
        let edges = curve.edges(file, cx.sink)?;
        let points = scaled(curve.points, scale, span, cx)?;
        Some(LoopSpec { name: curve.name, points, spans: curve.spans, edges, span })
    };
    found.into_iter().map(closed).collect()
}

/// Checks the unit that the job states for the points of a file: it is that of the head of the file, and points that are taken for
/// millimetres have the size of a wheel. One message a file.
fn unit_is_right(
    file: &Text,
    source: SourceId,
    unit: Option<&Name>,
    points: &[[f64; 3]],
    cx: &mut Context<'_>,
) -> Option<()> {
    let Some(unit) = unit else { return Some(()) };
    let head = header_unit::stated(&cx.sources.get(source)?.text);
    if let Some((of_head, line)) = head
        && LengthUnit::named(&unit.text).is_some_and(|of_job| of_job != of_head)
    {
        cx.sink.push_first(
            Diag::error(
                codes::CURVE_FILE,
                format!("the points of `{}` are in {of_head}, and the job says {}", file.text, unit.text),
            )
            .label(unit.span, format!("`{of_head}` is expected"))
            .label(Span::new(source, line), "the head of the file says so")
            .help(format!(
                "write `{of_head}` in the place of `{}` behind each curve of this file, or correct its head",
                unit.text
            )),
        );
        return None;
    }
    let size = points.iter().flatten().map(|x| x.abs()).fold(0.0, f64::max);
    if unit.text == "mm" && size > 0.0 && size < LEAST_SIZE {
        cx.sink.push_first(
            Diag::error(
                codes::CURVE_FILE,
                format!("the points of `{}` look like metres, and the job says mm", file.text),
            )
            .label(unit.span, format!("the points reach only {} from the origin", length(size)))
            .help("write `m` in the place of `mm` behind each curve of this file"),
        );
        return None;
    }
    Some(())
}

/// Points in mm, unless they are too many; without a scale the fault is reported already.
fn scaled(points: Vec<[f64; 3]>, scale: Option<f64>, span: Span, cx: &mut Context<'_>) -> Option<Vec<[f64; 3]>> {
    if points.len() <= MAX_POINTS {
        let scale = scale?;
        return Some(points.into_iter().map(|p| p.map(|x| x * scale)).collect());
    }
    cx.sink.push(
        Diag::error(geometry::POINTS, format!("the curve has more than {MAX_POINTS} points, the limit"))
            .label(span, "this curve")
            .help("use fewer points; a smooth vane needs fewer than 100"),
    );
    None
}

fn unit_scale(unit: Option<&Name>, span: Span, cx: &mut Context<'_>) -> Option<f64> {
    let Some(unit) = unit else {
        let at = Span { start: span.end, ..span };
        cx.sink.push(
            Diag::error(codes::NO_UNIT, "the points of the spline need a unit")
                .label(at, "a unit is expected here")
                .help("write `mm` behind the list; the unit applies to all points")
                .fix(at, " mm"),
        );
        return None;
    };
    if unit.text == "m" {
        return Some(1000.0);
    }
    match Quantity::new(1.0, &unit.text) {
        Some(q) if q.dimension == Dimension::LENGTH => Some(q.value),
        Some(q) => {
            cx.sink.push(
                Diag::error(codes::WRONG_DIMENSION, format!("coordinates must be lengths, not {}", q.dimension))
                    .label(unit.span, "a unit of length is expected")
                    .help("write `mm`"),
            );
            None
        }
        None => {
            cx.sink.push(unknown_unit(unit));
            None
        }
    }
}

type PointsInText = (Vec<[f64; 3]>, Vec<Span>);

fn inline(points: &[syntax::ast::Point], cx: &mut Context<'_>) -> Option<PointsInText> {
    let mut out = (Vec::new(), Vec::new());
    let mut good = true;
    for point in points {
        let [x, y, z] = point.coordinates.as_slice() else {
            // One message a list: its points mostly have the same form.
            let first = std::mem::replace(&mut good, false);
            if first {
                cx.sink.push(coordinates_missing(point, points));
            }
            continue;
        };
        let coordinates = [x, y, z].map(|e| {
            let value = cx.scope.value(e, cx.sink)?;
            if value.dimension != Dimension::NONE {
                cx.sink.push(
                    Diag::error(codes::WRONG_DIMENSION, "the unit behind the list applies to the coordinates")
                        .label(e.span, "a plain number is expected")
                        .help("remove the unit here"),
                );
                return None;
            }
            Some(value.value)
        });
        match coordinates {
            [Some(x), Some(y), Some(z)] => {
                out.0.push([x, y, z]);
                out.1.push(point.span);
            }
            _ => good = false,
        }
    }
    good.then_some(out)
}

/// The fault of a point that has not three coordinates, the first one of a list.
fn coordinates_missing(point: &syntax::ast::Point, points: &[syntax::ast::Point]) -> Diag {
    let count = point.coordinates.len();
    let more = points.iter().filter(|p| p.coordinates.len() != 3).count() - 1;
    let diag = Diag::error(codes::WRONG_FORM, format!("a point has 3 coordinates, not {count}"))
        .label(point.span, "x, y and z are expected");
    let diag =
        if more > 0 { diag.note(format!("so it is with {more} more of the {} points", points.len())) } else { diag };
    diag.help(if count == 2 {
        "write it like `(15.0578, -38.5221, 0)`; a meridian of hub or shroud has points `(RADIUS, 0, HEIGHT)`"
    } else {
        "write it like `(15.0578, -38.5221, 0)`"
    })
}

/// The fault of a file that the job names and that cannot be read.
pub(super) fn not_read(kind: &str, file: &Text, missing: MissingFile) -> Diag {
    let (code, help) = match missing.fault {
        Fault::Outside => {
            (file_codes::OUTSIDE, "put the file into the folder of the job, or name its folder with `--curves`")
        }
        Fault::Unreadable => {
            (file_codes::CANNOT_READ, "correct the file: a table of points is a text in UTF-8, such as a CSV file")
        }
        Fault::Absent => (file_codes::CANNOT_READ, "give its path relative to the job file"),
    };
    let mut diag = Diag::error(code, format!("the {kind} file `{}` cannot be read", file.text));
    if !missing.known.is_empty() {
        diag = diag.note(format!("the {kind} files are {}", missing.known.join(", ")));
    }
    diag.label(file.span, missing.reason).help(help)
}

/// The text of a curve file.
fn source_of(file: &Text, cx: &mut Context<'_>) -> Option<SourceId> {
    let found = match cx.files.curves(&file.text) {
        Ok(found) => found,
        Err(missing) => {
            // Several curves are read from one file.
            cx.sink.push_first(not_read("curve", file, missing));
            return None;
        }
    };
    let known = cx.sources.files().iter().position(|f| f.name == found.name && f.text == found.text);
    let source = match known {
        Some(at) => SourceId(u32::try_from(at).unwrap_or(u32::MAX)),
        None => cx.sources.add_file(found),
    };
    cx.searched_bytes += cx.sources.get(source).map_or(0, |file| file.text.len());
    if cx.searched_bytes > MAX_SEARCHED_BYTES {
        cx.sink.push(
            Diag::error(codes::CURVE_FILE, "the curve files of the job are too large for so many curves")
                .label(file.span, "this curve exceeds the limit")
                .help("put the curves of this part into a file without other curves"),
        );
        return None;
    }
    Some(source)
}
