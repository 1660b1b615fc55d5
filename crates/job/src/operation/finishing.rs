//! Properties of finishing operations: faces, axes, sense and order.

use crate::block::eval::suggest;
use crate::block::properties::{Properties, named};
use crate::model::{CutterKind, OperationKind, ToolSpec};
use crate::property::{Property, Without, limits};
use crate::vocabulary::operations::{
    BLADES, CONFLICT, FACES, FLANK_METHOD, LEVEL_DEPTH, METHOD, MILLING, ORDER, SIDE, STRIPS,
};
use base::units::Mm;
use diagnostics::Diag;
use diagnostics::codes::job as codes;
use wheel::method::{AxisMethod, Conflict, ErrorSide, FaceOrder, Flank, FlankMethod, Lines, Milling};
use wheel::part::{BladeId, FaceId};

/// How tool axes of point milling are chosen: the tool turns about the middle of its ball, or keeps one tilt angle for
/// each line.
pub(super) fn point_axes(tool: Option<&ToolSpec>, p: &mut Properties<'_, '_>) -> Option<AxisMethod> {
    let turns = tool
        .is_none_or(|t| matches!(t.kind, CutterKind::Ball | CutterKind::Lollipop { .. } | CutterKind::TaperedBall(_)));
    if turns {
        return named(p, &METHOD, &AxisMethod::ALL, AxisMethod::name);
    }
    if !p.has("method") {
        return Some(AxisMethod::Blend);
    }
    for method in [AxisMethod::Corridor, AxisMethod::Xu].map(AxisMethod::name) {
        if p.is_word("method", method) {
            let span = p.words("method", "method blend")?.first()?.span;
            p.sink.push(
                Diag::error(
                    codes::WRONG_FORM,
                    format!(
                        "`method {method}` needs a tool with a ball: it tilts the tool about the centre of the ball"
                    ),
                )
                .label(span, "the tool of this operation has no ball")
                .help("use `method blend`, which keeps one tilt angle for each line, or a tool with a ball"),
            );
            return None;
        }
    }
    named(p, &METHOD, &AxisMethod::ALL, AxisMethod::name)
}

/// Sense of milling of lines on faces and fillets; `Some(None)` for `zigzag`, which cannot keep one.
pub(super) fn milling_of(lines: Lines, p: &mut Properties<'_, '_>) -> Option<Option<Milling>> {
    if lines != Lines::Zigzag {
        return named(p, &MILLING, &Milling::ALL, Milling::name).map(Some);
    }
    if !p.has(MILLING.name) {
        return Some(None);
    }
    let span = p.words(MILLING.name, "milling climb")?.first()?.span;
    p.sink.push(
        Diag::error(codes::WRONG_FORM, "`milling` needs lines that all run in one direction")
            .label(span, "`lines zigzag` mills every other line in the other sense")
            .help("add `lines one-way`, which keeps the sense on both faces; or remove `milling`"),
    );
    None
}

/// Order of the faces of a vane: levels go from face to face, so that a single face has none.
pub(super) fn face_order(faces: usize, p: &mut Properties<'_, '_>) -> Option<FaceOrder> {
    if faces > 1 || !p.is_word(ORDER.name, FaceOrder::Levels.name()) {
        return named(p, &ORDER, &FaceOrder::ALL, FaceOrder::name);
    }
    let span = p.words(ORDER.name, "order levels")?.first()?.span;
    p.sink.push(
        Diag::error(codes::WRONG_FORM, "`order levels` needs both faces")
            .label(span, "this operation finishes one face only")
            .help("name both faces, `faces pressure, suction`, or remove `order`"),
    );
    None
}

/// Height of the levels of point milling; `Some(None)` for one face after the other.
pub(super) fn levels(lines: Lines, faces: usize, p: &mut Properties<'_, '_>) -> Option<Option<Mm>> {
    if lines == Lines::Spiral && p.is_word(ORDER.name, FaceOrder::Levels.name()) {
        let span = p.words(ORDER.name, "order levels")?.first()?.span;
        p.sink.push(
            Diag::error(codes::WRONG_FORM, "`order levels` needs lines on each face")
                .label(span, "`lines spiral` falls evenly round both faces already")
                .help("remove `order`, or use `lines zigzag`"),
        );
        return None;
    }
    if face_order(faces, p)? == FaceOrder::Levels {
        let depth = p.read(&LEVEL_DEPTH.without(Without::Required))?;
        return depth.map(|(depth, _)| Some(Mm(depth)));
    }
    if p.has(LEVEL_DEPTH.name) {
        let span = p.expression_of(&LEVEL_DEPTH)?.span;
        p.sink.push(
            Diag::error(codes::WRONG_FORM, "`depth` needs `order levels`")
                .label(span, "the lines of a face follow each other from the tip to the root")
                .help("add `order levels`, which cuts this depth on both faces before it goes on; or remove `depth`"),
        );
        return None;
    }
    Some(None)
}

/// The named blades, by their places among the blades of a sector; all where none is named.
pub(super) fn blades(names: &[String], p: &mut Properties<'_, '_>) -> Option<Vec<BladeId>> {
    if !p.has(BLADES.name) {
        return Some((0..names.len().max(1)).map(BladeId::new).collect());
    }
    let mut chosen = Vec::new();
    for word in p.words_of(&BLADES)? {
        let Some(blade) = names.iter().position(|name| *name == word.text).map(BladeId::new) else {
            // Without a part nothing is known about its blades.
            if !names.is_empty() {
                let known: Vec<&str> = names.iter().map(String::as_str).collect();
                let diag = Diag::error(codes::UNKNOWN_NAME, format!("no blade is called `{}`", word.text));
                p.sink.push(suggest(diag, &word.text, word.span, "blade", &known));
            }
            return None;
        };
        if chosen.contains(&blade) {
            p.sink.push(
                Diag::error(codes::GIVEN_TWICE, format!("blade `{}` is given twice", word.text))
                    .label(word.span, "given again")
                    .help("name each blade once"),
            );
            return None;
        }
        chosen.push(blade);
    }
    Some(chosen)
}

/// The named faces; both where none is named.
pub(super) fn faces(p: &mut Properties<'_, '_>) -> Option<Vec<&'static str>> {
    chosen(p, &FACES, "face", FaceId::NAMES)
}

/// The chosen ones of two words, none twice; both where the property is not given.
pub(super) fn chosen(
    p: &mut Properties<'_, '_>,
    property: &Property,
    what: &str,
    all: [&'static str; 2],
) -> Option<Vec<&'static str>> {
    if !p.has(property.name) {
        return Some(all.to_vec());
    }
    let mut named = Vec::new();
    for word in p.words_of(property)? {
        let Some(found) = all.into_iter().find(|f| *f == word.text) else {
            let diag = Diag::error(codes::UNKNOWN_NAME, format!("no {what} is called `{}`", word.text));
            p.sink.push(suggest(diag, &word.text, word.span, what, &all));
            return None;
        };
        if named.contains(&found) {
            p.sink.push(
                Diag::error(codes::GIVEN_TWICE, format!("{what} `{found}` is given twice"))
                    .label(word.span, "given again")
                    .help(format!("name each {what} once")),
            );
            return None;
        }
        named.push(found);
    }
    Some(named)
}

pub(super) fn flank(names: &[String], p: &mut Properties<'_, '_>) -> Option<OperationKind> {
    let blades = blades(names, p)?;
    let given = faces(p)?;
    let faces = blades.into_iter().flat_map(BladeId::faces).filter(|face| given.contains(&face.name())).collect();
    let method = named(p, &FLANK_METHOD, &FlankMethod::ALL, FlankMethod::name)?;
    let optimised = method == FlankMethod::Minimax;
    for property in [SIDE.name, CONFLICT.name] {
        if p.has(property) && !optimised {
            let span = p.words(property, property)?.first()?.span;
            p.sink.push(
                Diag::error(codes::WRONG_FORM, format!("only `method minimax` has the property `{property}`"))
                    .label(span, format!("`method {}` places each ruling separately", method.name()))
                    .help(format!("remove `{property}`, or use `method minimax`")),
            );
            return None;
        }
    }
    let side = named(p, &SIDE, &ErrorSide::ALL, ErrorSide::name)?;
    let conflict = named(p, &CONFLICT, &Conflict::ALL, Conflict::name)?;
    let strips = if p.is_word(STRIPS.name, "auto") && optimised {
        p.take(STRIPS.name);
        None
    } else if p.has(STRIPS.name) {
        Some(p.count(STRIPS.name, 1, limits::MAX_STRIPS[usize::from(!optimised)], &STRIPS.written())?.0)
    } else {
        (!optimised).then_some(1)
    };
    let milling = named(p, &MILLING, &Milling::ALL, Milling::name)?;
    let order = face_order(given.len(), p)?;
    let flank = Flank { method, strips, side, conflict, milling, order };
    Some(OperationKind::Flank { faces, flank })
}
