//! The item `part` with its curves: vanes, faces, sections, angles; and the file of what is left of the stock.

mod angles;
pub mod curve_file;
mod curves;
mod distributions;
pub(crate) mod stock_file;

use crate::block::context::Context;
use crate::block::eval::{mismatch, suggest};
use crate::block::properties::{Properties, Range, name_of};
use crate::model::{
    AnglesSpec, BladeForm, BladeSpec, CamberSpec, CurveRef, CurveSpec, FaceForm, FaceSpec, Facing, LoopSpec, PartSpec,
    RevolvedSpec, SectionsSpec,
};
use crate::property::limits;
use crate::property::quantity::Dimension;
use crate::vocabulary::items::EXTEND;
use crate::vocabulary::part::FIT_OF_SECTIONS;
use crate::vocabulary::{self, TopicKind};
use angles::AnglesGiven;
use base::source::{Span, Spanned};
use base::units::{Mm, Rad};
use blade::EdgeForm;
use curve_file::MAX_LOOPS;
use curves::{closed, closed_from, curve};
use diagnostics::Diag;
use diagnostics::codes::{geometry, job as codes};
use distributions::distribution;
use syntax::ast::{Block, Name, Path, Revolved, Spline, Value};
use wheel::part::imported::ImportedFrom;
use wheel::part::{BladeId, FaceId, Fillet, RulingEnd};

/// Largest number of vanes that is read; whether they fit is determined from their thickness.
const MAX_VANES: u32 = 10_000;

/// Most sections of a lofted face between root and tip. Designers give some 5 to 20.
const MAX_SECTIONS: usize = 30;

/// Most splitters between one vane and the next. Impellers have one, seldom two or three.
const MAX_SPLITTERS: usize = 8;

pub(super) fn resolve(name: &Name, body: &Block, head: Span, cx: &mut Context<'_>) -> Option<PartSpec> {
    let known = vocabulary::properties(TopicKind::Item, "part");
    let owner = format!("part {}", name.text);
    let mut p = Properties::repeated(owner, head, body, &known, &["splitter"], &mut cx.scope, cx.sink);
    let vanes = vane_count(&mut p);
    let extend = p.read_or_default(&EXTEND);
    let imported = if p.has("imported") { Some(imported(&mut p)?) } else { None };
    let vane = p.take("vane");
    if vane.is_none() {
        p.missing("vane", "vane main { pressure ruled { ... } suction ruled { ... } }");
    }
    let [hub, shroud] = ["hub", "shroud"].map(|name| {
        // Where the entry stands in the block of the vane, its place is the only fault.
        let misplaced = vane
            .iter()
            .flat_map(|(_, values)| values)
            .any(|value| matches!(value, Value::Block(_, block) if has_entry(block, name)));
        if misplaced && !p.has(name) { None } else { revolved(name, &mut p) }
    });
    let (word, values) = vane?;
    let vane = named_block(word, &values, "vane main { pressure ruled { ... } ... }", &mut p);
    let given = p.take_all("splitter");
    if let Some((word, _)) = given.get(MAX_SPLITTERS) {
        p.out_of_range(word.span, "splitter", &format!("given at most {MAX_SPLITTERS} times"));
        return None;
    }
    let example = "splitter half { pressure ruled { ... } ... }";
    let splitters: Vec<_> =
        given.into_iter().map(|(word, values)| named_block(word, &values, example, &mut p)).collect();
    let (vane_name, vane_block) = vane?;
    let by_faces = FormGiven::of(vane_block) == FormGiven::Faces;
    let hub = hub.and_then(|hub| generator(hub, vane_name, by_faces, cx));
    let shroud = shroud.and_then(|shroud| generator(shroud, vane_name, by_faces, cx));
    let row = RowGiven { main: vane_name, vanes: vanes.as_ref().map(|v| v.value) };
    let mut blades = vec![blade("vane", vane_name, vane_block, &row, cx)];
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
        blades.push(blade("splitter", name, block, &row, cx));
    }
    let blades = blades.into_iter().collect::<Option<Vec<_>>>()?;
    of_a_camber_surface(&blades, cx)?;
    Some(PartSpec {
        name: name.text.clone(),
        vanes: vanes?,
        blades,
        extend: Mm(extend?),
        imported,
        hub: hub?,
        shroud: shroud?,
        span: head,
    })
}

/// Files that the part was imported from, and how far from them it lies.
fn imported(p: &mut Properties<'_, '_>) -> Option<ImportedFrom> {
    const EXAMPLE: &str = "imported \"wheel.step\", within 0.3 um";
    /// Largest distance, mm: that of two points within the coordinates that blade files may have.
    const MAX_DISTANCE_MM: f64 = 1e6;
    let (word, values) = p.take("imported")?;
    match values.as_slice() {
        [Value::Text(files), Value::Labelled(label, within)] if label.text == "within" => {
            let within = p.value_of(within, "imported", Dimension::LENGTH, Range::NotNegative(MAX_DISTANCE_MM))?;
            Some(ImportedFrom { files: files.text.clone(), within: Mm(within) })
        }
        _ => {
            let span = values.first().map_or(word.span, |v| v.span());
            p.wrong_form(span, "imported", "quoted names of files, a comma, and `within` with a length", EXAMPLE);
            None
        }
    }
}

/// Name and block of a blade.
fn named_block<'a>(
    word: &'a Name,
    values: &[&'a Value],
    example: &str,
    p: &mut Properties<'a, '_>,
) -> Option<(&'a Name, &'a Block)> {
    if let [Value::Block(Some(name), block)] = values {
        return Some((name, block));
    }
    p.wrong_form(word.span, &word.text, "a name and a block", example);
    None
}

/// Reports a splitter that is part of a main blade without a camber surface.
fn of_a_camber_surface(blades: &[BladeSpec], cx: &mut Context<'_>) -> Option<()> {
    let is_part = |blade: &&BladeSpec| {
        matches!(&blade.form, BladeForm::Angles(AnglesSpec { camber: CamberSpec::OfMain { .. }, .. }))
    };
    let [main, splitters @ ..] = blades else { return None };
    let splitter = splitters.iter().find(is_part).filter(|_| !matches!(main.form, BladeForm::Angles(_)));
    let Some(splitter) = splitter else { return Some(()) };
    cx.sink.push(
        Diag::error(codes::WRONG_FORM, format!("the splitter `{}` cannot be a part of `{}`", splitter.name, main.name))
            .label(splitter.span, "a splitter `of` another blade")
            .label(main.span, "this blade has no angles of a camber surface")
            .help("give the main blade by angles and thicknesses, or the splitter in the form of the main blade"),
    );
    None
}

/// How a block gives the form of its blade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FormGiven {
    Faces,
    Sections,
    Angles,
    OfMain,
}

impl FormGiven {
    fn of(block: &Block) -> Self {
        match block {
            _ if has_entry(block, "of") => Self::OfMain,
            _ if has_entry(block, "span") => Self::Angles,
            _ if has_entry(block, "sections") => Self::Sections,
            _ => Self::Faces,
        }
    }

    /// Names of its entries, and of those that may be repeated.
    fn entries(self) -> (Vec<&'static str>, &'static [&'static str]) {
        let of = |block| vocabulary::properties(TopicKind::Block, block);
        match self {
            Self::Faces => (of("vane"), &[]),
            Self::Sections => (of("sections"), &[]),
            Self::Angles => (of("angles"), &angles::REPEATED),
            Self::OfMain => (of("of"), &angles::REPEATED),
        }
    }
}

/// The row of a blade.
struct RowGiven<'a> {
    main: &'a Name,
    vanes: Option<u32>,
}

fn blade<'a>(word: &str, name: &Name, block: &'a Block, row: &RowGiven<'a>, cx: &mut Context<'_>) -> Option<BladeSpec> {
    let splitter = word == "splitter";
    let given = match FormGiven::of(block) {
        FormGiven::OfMain if !splitter => FormGiven::Angles,
        given => given,
    };
    let (mut known, repeated) = given.entries();
    if splitter {
        known.push("angle");
    }
    let owner = format!("{word} {}", name.text);
    let mut p = Properties::repeated(owner.clone(), name.span, block, &known, repeated, &mut cx.scope, cx.sink);
    let along = p.take_list("fillet");
    let fillet = if p.has("fillet") {
        let fillet = p.number("fillet", Dimension::LENGTH, Range::NotNegative(limits::LARGEST_FILLET), "fillet 3 mm");
        fillet.and_then(|(fillet, span)| {
            let real = fillet == 0.0 || fillet >= limits::LEAST_FILLET;
            if !real {
                p.out_of_range(span, "fillet", &format!("0, or at least {} mm", limits::LEAST_FILLET));
            }
            real.then_some((fillet > 0.0).then(|| Fillet::from(Mm(fillet))))
        })
    } else {
        Some(None)
    };
    let angle = if p.has("angle") { angle(&mut p, row) } else { Some(0.0) };
    let form = match given {
        FormGiven::Faces => {
            let values = FaceId::NAMES.map(|face| {
                let value = p.take(face);
                if value.is_none() {
                    p.missing(face, &format!("{face} ruled {{ tip spline [...] mm  root spline [...] mm }}"));
                }
                value
            });
            let [pressure, suction] = values.map(|value| value.and_then(|(word, values)| face(word, &values, cx)));
            BladeForm::Faces(Box::new([pressure?, suction?]))
        }
        FormGiven::Sections => {
            let given = SectionsGiven::take(&mut p);
            BladeForm::Sections(given?.resolve(cx)?)
        }
        FormGiven::Angles | FormGiven::OfMain => {
            let given = AnglesGiven::take(&mut p, name.span, splitter.then_some(row.main));
            BladeForm::Angles(given?.resolve(cx)?)
        }
    };
    let fillet = match along {
        Some(value) => Some(fillet_along(value, &owner, cx)?),
        None => fillet?,
    };
    Some(BladeSpec { name: name.text.clone(), form, fillet, angle: Rad(angle?), span: name.span })
}

/// A fillet whose radius changes along the foot of the blade.
fn fillet_along(value: &Value, owner: &str, cx: &mut Context<'_>) -> Option<Fillet> {
    let example = "fillet [(0 %, 2 mm) (100 %, 3 mm)]";
    let given = distribution(value, "fillet", Dimension::LENGTH, example, cx)?;
    let fillet = Fillet::along(given.points);
    let [least, most] = [fillet.least(), fillet.most()];
    if least.get() >= limits::LEAST_FILLET && most.get() <= limits::LARGEST_FILLET {
        return Some(fillet);
    }
    let range = format!("from {} mm to {} mm", limits::LEAST_FILLET, limits::LARGEST_FILLET);
    cx.sink.push(
        Diag::error(codes::OUT_OF_RANGE, format!("`fillet` of {owner} must be {range} everywhere"))
            .label(given.span, format!("the radius runs smoothly through these values, from {least} to {most}"))
            .help("give radii in this range that change less from one value to the next"),
    );
    None
}

/// The turn of a splitter: an angle, or a share of the pitch, rad.
fn angle(p: &mut Properties<'_, '_>, row: &RowGiven<'_>) -> Option<f64> {
    let expr = p.expression("angle", "angle 22.5 deg")?;
    let value = p.scope.value(expr, p.sink)?;
    if value.dimension == Dimension::NONE && (0.0..=1.0).contains(&value.value) {
        return row.vanes.map(|vanes| value.value * std::f64::consts::TAU / f64::from(vanes));
    }
    p.value_of(expr, "angle", Dimension::ANGLE, Range::Within(std::f64::consts::TAU))
}

fn has_entry(block: &Block, name: &str) -> bool {
    block.entries.iter().any(|entry| entry.name.text == name)
}

/// What a blade says of its closed sections.
struct SectionsGiven<'a> {
    word: &'a Name,
    values: Vec<&'a Value>,
    fit: f64,
    edges: [Option<EdgeForm>; 2],
    pressure: Option<Facing>,
}

impl<'a> SectionsGiven<'a> {
    fn take(p: &mut Properties<'a, '_>) -> Option<Self> {
        let (word, values) = p.take("sections")?;
        let fit = p.read_or_default(&FIT_OF_SECTIONS);
        let edges = ["leading-edge", "trailing-edge"].map(|edge| name_of(p, edge, &EdgeForm::STATED, EdgeForm::name));
        let pressure = name_of(p, "pressure", &Facing::ALL, Facing::name)?;
        let [leading, trailing] = edges;
        Some(Self { word, values, fit: fit?, edges: [leading?, trailing?], pressure })
    }

    fn resolve(self, cx: &mut Context<'_>) -> Option<SectionsSpec> {
        let Self { word, values, fit, edges, pressure } = self;
        let mut loops: Vec<LoopSpec> = Vec::new();
        for value in &values {
            match value {
                Value::Loops { file, unit, span } => loops.extend(closed_from(file, unit.as_ref(), *span, cx)?),
                Value::Loop(spline) => loops.push(closed(spline, format!("section {}", loops.len() + 1), cx)?),
                other => {
                    cx.sink.push(
                        Diag::error(codes::WRONG_FORM, "`sections` takes closed curves")
                            .label(other.span(), "`loop` or `loops from` is expected")
                            .help("write `sections loops from \"blade.csv\" mm` or `sections loop [(x, y, z) ...] mm, loop [...] mm`"),
                    );
                    return None;
                }
            }
        }
        if !(2..=MAX_LOOPS).contains(&loops.len()) {
            cx.sink.push(
                Diag::error(codes::OUT_OF_RANGE, format!("a blade has 2 to {MAX_LOOPS} sections, not {}", loops.len()))
                    .label(word.span, "these sections")
                    .help("give the sections from hub to shroud, each as a closed curve round the blade"),
            );
            return None;
        }
        let file = match values.as_slice() {
            [Value::Loops { file, unit, .. }] => {
                let unit = unit.as_ref().map_or_else(String::new, |unit| format!(" {}", unit.text));
                Some(format!("loops from \"{}\"{unit}", file.text))
            }
            _ => None,
        };
        Some(SectionsSpec { loops, file, fit: Mm(fit), edges, pressure, span: word.span })
    }
}

fn vane_count(p: &mut Properties<'_, '_>) -> Option<Spanned<u32>> {
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
        Some(n) => Some(Spanned::new(n, expr.span)),
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

fn revolved<'a>(name: &str, p: &mut Properties<'a, '_>) -> Option<&'a Revolved> {
    let example = if name == "hub" { "hub revolve main.pressure.root" } else { "shroud revolve main.pressure.tip" };
    let Some((word, values)) = p.take(name) else {
        p.missing(name, example);
        return None;
    };
    match values.as_slice() {
        [Value::Revolve(revolved, _)] => Some(revolved),
        _ => {
            p.wrong_form(word.span, name, "a curve to revolve", example);
            None
        }
    }
}

/// The curve of a hub or shroud. A blade of closed sections has no curve that could be revolved.
fn generator(given: &Revolved, vane: &Name, by_faces: bool, cx: &mut Context<'_>) -> Option<RevolvedSpec> {
    match given {
        Revolved::Own(spline) => Some(RevolvedSpec::Own(curve(spline, cx)?)),
        Revolved::OfBlade(path) if by_faces => Some(RevolvedSpec::OfBlade(curve_ref(path, vane, cx)?)),
        Revolved::OfBlade(path) => {
            cx.sink.push(
                Diag::error(codes::WRONG_FORM, format!("the blade `{}` has sections, but no curve `{}`", vane.text, path.text()))
                    .label(path.span, "a curve of its own is expected")
                    .help("write the meridian, for example `hub revolve spline from \"flow.csv\" curve hub mm`; its azimuth does not matter"),
            );
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
    let Some(form) = FaceForm::ALL.into_iter().find(|form| form.name() == kind.text) else {
        let diag =
            Diag::error(codes::NOT_IN_LANGUAGE, format!("faces of the kind `{}` are not in the language", kind.text));
        let names = FaceForm::ALL.map(FaceForm::name);
        cx.sink.push(suggest(diag, &kind.text, kind.span, "kind of face", &names));
        return None;
    };
    let owner = format!("the {} face", word.text);
    let known = vocabulary::properties(TopicKind::Block, &kind.text);
    let mut p = Properties::new(owner, word.span, block, &known, &mut cx.scope, cx.sink);
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
