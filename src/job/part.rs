//! The part: vanes, faces, curves.

use super::context::Context;
use super::curve_file::{self, MAX_POINTS};
use super::eval::{mismatch, suggest, unknown_unit};
use super::files::{Fault, MissingFile};
use super::limits;
use super::model::{BladeSpec, CurveRef, CurveSpec, FaceForm, FaceSpec, PartSpec};
use super::properties::{Properties, Range};
use super::quantity::{Dimension, Quantity};
use crate::diag::Diag;
use crate::diag::codes::{files as file_codes, geometry, job as codes};
use crate::part::{BladeId, FaceId, RulingEnd};
use crate::source::Span;
use crate::syntax::ast::{Block, Name, Path, Spline, SplinePoints, Text, Value};
use crate::units::{Mm, Rad};

/// Largest number of vanes that is read; whether they fit is determined from their thickness.
const MAX_VANES: u32 = 10_000;

/// Most sections of a lofted face between root and tip. Designers give some 5 to 20.
const MAX_SECTIONS: usize = 30;

/// Most splitters between one vane and the next. Impellers have one, seldom two or three.
const MAX_SPLITTERS: usize = 8;

/// Most text of curve files in which the curves of a job are looked up, in total, bytes: some ten seconds. Each curve
/// takes one pass through its file.
const MOST_LOOKED_UP: usize = 2_000_000_000;

pub(super) fn resolve(name: &Name, body: &Block, head: Span, cx: &mut Context<'_>) -> Option<PartSpec> {
    let known = ["vanes", "vane", "splitter", "hub", "shroud"];
    let owner = format!("part {}", name.text);
    let mut p = Properties::repeated(owner, head, body, (&known, &["splitter"]), &mut cx.scope, cx.sink);
    let vanes = vane_count(&mut p);
    let vane = p.take("vane");
    if vane.is_none() {
        p.missing("vane", "vane main { pressure ruled { ... } suction ruled { ... } }");
    }
    let hub = revolved("hub", &mut p);
    let shroud = revolved("shroud", &mut p);
    let vane = named_block(vane?, "vane main { pressure ruled { ... } ... }", &mut p);
    let given = p.take_all("splitter");
    if let Some((word, _)) = given.get(MAX_SPLITTERS) {
        p.out_of_range(word.span, "splitter", &format!("given at most {MAX_SPLITTERS} times"));
        return None;
    }
    let example = "splitter half { pressure ruled { ... } ... }";
    let splitters: Vec<_> = given.into_iter().map(|splitter| named_block(splitter, example, &mut p)).collect();
    let (vane_name, vane_block) = vane?;
    let hub = hub.and_then(|path| curve_ref(path, vane_name, cx));
    let shroud = shroud.and_then(|path| curve_ref(path, vane_name, cx));
    let mut blades = vec![blade("vane", vane_name, vane_block, cx)];
    let mut names: Vec<&Name> = vec![vane_name];
    for splitter in splitters {
        let Some((name, block)) = splitter else {
            blades.push(None);
            continue;
        };
        if let Some(first) = names.iter().find(|n| n.text == name.text) {
            cx.sink.push(
                Diag::error(codes::GIVEN_TWICE, format!("two blades are called `{}`", name.text))
                    .label(name.span, "the same name again")
                    .label(first.span, "first given here")
                    .help("give each blade its own name"),
            );
        }
        names.push(name);
        blades.push(blade("splitter", name, block, cx));
    }
    Some(PartSpec {
        name: name.text.clone(),
        vanes: vanes?,
        blades: blades.into_iter().collect::<Option<Vec<_>>>()?,
        hub: hub?,
        shroud: shroud?,
        span: head,
    })
}

/// Name and block of a blade.
fn named_block<'a>(
    (word, values): (&'a Name, Vec<&'a Value>),
    example: &str,
    p: &mut Properties<'a, '_>,
) -> Option<(&'a Name, &'a Block)> {
    if let [Value::Block(Some(name), block)] = values.as_slice() {
        return Some((name, block));
    }
    p.wrong_form(word.span, &word.text, "a name and a block", example);
    None
}

fn blade(word: &str, name: &Name, block: &Block, cx: &mut Context<'_>) -> Option<BladeSpec> {
    let known: &[&str] = match word {
        "splitter" => &["pressure", "suction", "fillet", "angle"],
        _ => &["pressure", "suction", "fillet"],
    };
    let owner = format!("{word} {}", name.text);
    let mut p = Properties::new(owner, name.span, block, known, &mut cx.scope, cx.sink);
    let fillet = if p.has("fillet") {
        let fillet = p.number("fillet", Dimension::LENGTH, Range::NotNegative(1000.0), "fillet 3 mm");
        fillet.and_then(|(fillet, span)| {
            let real = fillet == 0.0 || fillet >= limits::LEAST_FILLET;
            if !real {
                p.out_of_range(span, "fillet", &format!("0, or at least {} mm", limits::LEAST_FILLET));
            }
            real.then_some(fillet)
        })
    } else {
        Some(0.0)
    };
    let angle = if p.has("angle") {
        p.number("angle", Dimension::ANGLE, Range::Within(std::f64::consts::TAU), "angle 22.5 deg").map(|a| a.0)
    } else {
        Some(0.0)
    };
    let values = FaceId::NAMES.map(|face| {
        let value = p.take(face);
        if value.is_none() {
            p.missing(face, &format!("{face} ruled {{ tip spline [...] mm  root spline [...] mm }}"));
        }
        value
    });
    let [pressure, suction] = values.map(|value| value.and_then(|(word, values)| face(word, &values, cx)));
    Some(BladeSpec {
        name: name.text.clone(),
        faces: [pressure?, suction?],
        fillet: Mm(fillet?),
        angle: Rad(angle?),
        span: name.span,
    })
}

fn vane_count(p: &mut Properties<'_, '_>) -> Option<(u32, Span)> {
    if !p.has("vanes") {
        p.missing("vanes", "vanes 8");
        return None;
    }
    let expr = p.expression("vanes", "vanes 8")?;
    let value = p.scope.value(expr, p.sink)?;
    if value.dimension != Dimension::NONE {
        p.sink.push(mismatch(expr, value, &[Dimension::NONE], "`vanes`"));
        return None;
    }
    let whole = (2..=MAX_VANES).find(|n| f64::from(*n) == value.value);
    match whole {
        Some(n) => Some((n, expr.span)),
        _ => {
            p.sink.push(
                Diag::error(geometry::VANE_COUNT, "the number of vanes is impossible")
                    .label(expr.span, format!("a whole number from 2 to {MAX_VANES} is expected"))
                    .help("give the number of vanes of the whole impeller"),
            );
            None
        }
    }
}

fn revolved<'a>(name: &str, p: &mut Properties<'a, '_>) -> Option<&'a Path> {
    let example = if name == "hub" { "hub revolve main.pressure.root" } else { "shroud revolve main.pressure.tip" };
    let Some((word, values)) = p.take(name) else {
        p.missing(name, example);
        return None;
    };
    match values.as_slice() {
        [Value::Revolve(path, _)] => Some(path),
        _ => {
            p.wrong_form(word.span, name, "a curve to revolve", example);
            None
        }
    }
}

/// `main.pressure.root`
fn curve_ref(path: &Path, vane: &Name, cx: &mut Context<'_>) -> Option<CurveRef> {
    let ends = [RulingEnd::Tip, RulingEnd::Root];
    let end_names = ends.map(RulingEnd::name);
    let allowed: [(&str, &[&str]); 3] =
        [("vane", &[vane.text.as_str()]), ("face", &FaceId::NAMES), ("curve", &end_names)];
    if path.names.len() != allowed.len() {
        cx.sink.push(
            Diag::error(codes::WRONG_FORM, format!("`{}` is not a curve", path.text()))
                .label(path.span, "vane, face and curve are expected")
                .help(format!("write `{}.pressure.root`", vane.text)),
        );
        return None;
    }
    let mut good = true;
    for (name, (kind, known)) in path.names.iter().zip(allowed) {
        if !known.contains(&name.text.as_str()) {
            let diag = Diag::error(codes::UNKNOWN_NAME, format!("no {kind} is called `{}`", name.text));
            cx.sink.push(suggest(diag, &name.text, name.span, kind, known));
            good = false;
        }
    }
    if !good {
        return None;
    }
    let named = |at: usize, name: &str| path.names.get(at).is_some_and(|n| n.text == name);
    let face = BladeId::MAIN.faces().into_iter().find(|face| named(1, face.name()))?;
    let end = ends.into_iter().find(|end| named(2, end.name()))?;
    Some(CurveRef { face, end, span: path.span })
}

fn face(word: &Name, values: &[&Value], cx: &mut Context<'_>) -> Option<FaceSpec> {
    let example = "pressure ruled { tip spline [...] mm  root spline [...] mm }";
    let [Value::Block(Some(kind), block)] = values else {
        cx.sink.push(
            Diag::error(codes::WRONG_FORM, format!("`{}` takes a kind of face and a block", word.text))
                .label(word.span, "`ruled { }` is expected")
                .help(format!("write it like `{example}`")),
        );
        return None;
    };
    let Some((form, _)) = FaceForm::NAMES.into_iter().find(|(_, name)| *name == kind.text) else {
        let diag =
            Diag::error(codes::NOT_IN_LANGUAGE, format!("faces of the kind `{}` are not in the language", kind.text));
        let names = FaceForm::NAMES.map(|(_, name)| name);
        cx.sink.push(suggest(diag, &kind.text, kind.span, "kind of face", &names));
        return None;
    };
    let owner = format!("the {} face", word.text);
    let known: &[&str] = match form {
        FaceForm::Ruled => &["tip", "root"],
        FaceForm::Lofted => &["tip", "root", "sections"],
    };
    let mut p = Properties::new(owner, word.span, block, known, &mut cx.scope, cx.sink);
    let splines = ["tip", "root"].map(|name| match p.take(name) {
        None => {
            p.missing(name, &format!("{name} spline [(x, y, z) ...] mm"));
            None
        }
        Some((_, values)) => match values.as_slice() {
            [Value::Spline(spline)] => Some(spline),
            _ => {
                let span = values.first().map_or(word.span, |v| v.span());
                p.wrong_form(span, name, "a spline", &format!("{name} spline [(x, y, z) ...] mm"));
                None
            }
        },
    });
    let mut between: Vec<Option<&Spline>> = Vec::new();
    if form == FaceForm::Lofted {
        let example = "sections spline [(x, y, z) ...] mm, spline [(x, y, z) ...] mm";
        match p.take("sections") {
            None => p.missing("sections", example),
            Some((_, values)) => between.extend(values.iter().map(|value| match value {
                Value::Spline(spline) => Some(spline),
                other => {
                    p.wrong_form(other.span(), "sections", "a list of splines", example);
                    None
                }
            })),
        }
        if between.len() > MAX_SECTIONS {
            p.out_of_range(word.span, "sections", &format!("at most {MAX_SECTIONS} splines"));
            return None;
        }
    }
    let [tip, root] = splines.map(|s| s.and_then(|s| curve(s, cx)));
    let sections: Vec<Option<CurveSpec>> = between.into_iter().map(|s| s.and_then(|s| curve(s, cx))).collect();
    let sections = sections.into_iter().collect::<Option<Vec<_>>>()?;
    // A lofted face without sections was reported already.
    (form == FaceForm::Ruled || !sections.is_empty()).then_some(())?;
    Some(FaceSpec { form, tip: tip?, root: root?, sections })
}

fn curve(spline: &Spline, cx: &mut Context<'_>) -> Option<CurveSpec> {
    let scale = unit_scale(spline, cx);
    let (points, spans) = match &spline.points {
        SplinePoints::Inline(points) => inline(points, cx)?,
        SplinePoints::File { file, curve } => from_file(file, curve, cx)?,
    };
    if points.len() > MAX_POINTS {
        cx.sink.push(
            Diag::error(geometry::POINTS, format!("the curve has more than {MAX_POINTS} points, the limit"))
                .label(spline.span, "this curve")
                .help("use fewer points; a smooth vane needs fewer than 100"),
        );
        return None;
    }
    let scale = scale?;
    let points = points.into_iter().map(|p| p.map(|x| x * scale)).collect();
    Some(CurveSpec { points, spans, span: spline.span })
}

fn unit_scale(spline: &Spline, cx: &mut Context<'_>) -> Option<f64> {
    let Some(unit) = &spline.unit else {
        let at = Span { start: spline.span.end, ..spline.span };
        cx.sink.push(
            Diag::error(codes::NO_UNIT, "the points of the spline need a unit")
                .label(at, "a unit is expected here")
                .help("write `mm` behind the list; the unit applies to all points")
                .fix(at, " mm"),
        );
        return None;
    };
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

fn inline(points: &[crate::syntax::ast::Point], cx: &mut Context<'_>) -> Option<PointsInText> {
    let mut out = (Vec::new(), Vec::new());
    let mut good = true;
    for point in points {
        let [x, y, z] = point.coordinates.as_slice() else {
            cx.sink.push(
                Diag::error(codes::WRONG_FORM, format!("a point has 3 coordinates, not {}", point.coordinates.len()))
                    .label(point.span, "x, y and z are expected")
                    .help("write it like `(15.0578, -38.5221, 0)`"),
            );
            good = false;
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

/// The fault of a file that the job names and that cannot be read.
pub(super) fn not_read(kind: &str, file: &Text, missing: MissingFile) -> Diag {
    let (code, help) = match missing.fault {
        Fault::Outside => {
            (file_codes::OUTSIDE, "put the file into the folder of the job, or name its folder with `--curves`")
        }
        _ => (file_codes::CANNOT_READ, "give its path relative to the job file"),
    };
    let mut diag = Diag::error(code, format!("the {kind} file `{}` cannot be read", file.text));
    if !missing.known.is_empty() {
        diag = diag.note(format!("the {kind} files are {}", missing.known.join(", ")));
    }
    diag.label(file.span, missing.reason).help(help)
}

fn from_file(file: &Text, curve: &Name, cx: &mut Context<'_>) -> Option<PointsInText> {
    let found = match cx.files.curves(&file.text) {
        Ok(found) => found,
        Err(missing) => {
            cx.sink.push(not_read("curve", file, missing));
            return None;
        }
    };
    let known = cx.sources.files().iter().position(|f| f.name == found.name && f.text == found.text);
    let source = match known {
        Some(at) => crate::source::SourceId(u32::try_from(at).unwrap_or(u32::MAX)),
        None => cx.sources.add_file(found),
    };
    cx.looked_up += cx.sources.get(source).map_or(0, |file| file.text.len());
    if cx.looked_up > MOST_LOOKED_UP {
        cx.sink.push(
            Diag::error(codes::CURVE_FILE, "the curve files of the job are too large for so many curves")
                .label(file.span, "this curve exceeds the limit")
                .help("put the curves of this part into a file without other curves"),
        );
        return None;
    }
    curve_file::read(source, cx.sources, file, curve, cx.sink)
}
