//! Tool files: TOML through serde.

use super::library::{LibraryReader, SectionTable, SpannedText, toml_fault};
use super::limits;
use super::model::{CutterKind, LoadLimits, ToolSpec};
use super::quantity::Dimension;
use crate::diag::Sink;
use crate::source::{SourceId, SourceMap, Span};
use crate::units::{Mm, Mm3PerMin, Rad, trim};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ToolsFile {
    #[serde(default)]
    #[expect(dead_code, reason = "for the reader of the file")]
    about: String,
    #[serde(default)]
    holder: BTreeMap<String, HolderTable>,
    #[serde(default)]
    tool: BTreeMap<String, ToolTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HolderTable {
    #[serde(default)]
    #[expect(dead_code, reason = "for the reader of the file")]
    about: String,
    section: Vec<SectionTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ToolTable {
    kind: SpannedText,
    diameter: SpannedText,
    corner: Option<SpannedText>,
    angle: Option<SpannedText>,
    barrel: Option<SpannedText>,
    tip: Option<SpannedText>,
    neck: Option<SpannedText>,
    #[serde(rename = "neck-end")]
    neck_end: Option<SpannedText>,
    flutes: Spanned<u32>,
    flute: Option<SpannedText>,
    shank: Option<SpannedText>,
    reach: SpannedText,
    holder: Option<SpannedText>,
    #[serde(rename = "max-chip")]
    max_chip: Option<SpannedText>,
    #[serde(rename = "max-depth")]
    max_depth: Option<SpannedText>,
    #[serde(rename = "max-rate")]
    max_rate: Option<SpannedText>,
    #[serde(rename = "plunge-width")]
    plunge_width: Option<SpannedText>,
    ramp: Option<SpannedText>,
}

/// Holders and tools of all tool files of a job.
#[derive(Debug, Default)]
pub(super) struct ToolLibrary {
    /// True for a file that is read by itself: its holders may stand in another file.
    pub(super) alone: bool,
    /// Sections by holder name: length, lower and upper diameter.
    pub(super) holders: BTreeMap<String, Vec<[Mm; 3]>>,
    /// Tools by name; number and span come from the job.
    pub(super) tools: BTreeMap<String, ToolSpec>,
}

/// Adds a tool file that is already in the source map to the library.
pub(super) fn tools(source: SourceId, sources: &SourceMap, asked: Span, into: &mut ToolLibrary, sink: &mut Sink) {
    let Some(file) = sources.get(source) else { return };
    let table: ToolsFile = match toml::from_str(&file.text) {
        Ok(table) => table,
        Err(error) => {
            sink.push(toml_fault(&error, source, &file.name).label(asked, "used here"));
            return;
        }
    };
    let mut reader = LibraryReader { source, sink, faults: false };
    for (name, holder) in table.holder {
        let mut sections = Vec::new();
        for section in &holder.section {
            sections.push(
                [&section.length, &section.lower, &section.upper]
                    .map(|t| Mm(reader.quantity(t, Dimension::LENGTH, 0.001, 1000.0))),
            );
        }
        into.holders.insert(name, sections);
    }
    for (name, tool) in table.tool {
        if let Some(spec) = library_tool(&name, &tool, into, &mut reader) {
            into.tools.insert(name, spec);
        }
    }
}

fn library_tool(
    name: &str,
    tool: &ToolTable,
    library: &ToolLibrary,
    reader: &mut LibraryReader<'_>,
) -> Option<ToolSpec> {
    let span = reader.span(&tool.kind);
    let mut size =
        |text: &SpannedText, [least, largest]: [f64; 2]| Mm(reader.quantity(text, Dimension::LENGTH, least, largest));
    let mut given = |text: &Option<SpannedText>, range: [f64; 2]| text.as_ref().map(|t| size(t, range));
    let [corner, tip] = [&tool.corner, &tool.tip].map(|t| given(t, limits::CORNER));
    let [barrel, flute, neck_end] = [&tool.barrel, &tool.flute, &tool.neck_end].map(|t| given(t, limits::LENGTH));
    let [neck, shank] = [&tool.neck, &tool.shank].map(|t| given(t, limits::DIAMETER));
    let [max_chip, max_depth, plunge] =
        [(&tool.max_chip, limits::CHIP), (&tool.max_depth, limits::LENGTH), (&tool.plunge_width, limits::LENGTH)]
            .map(|(t, range)| given(t, range));
    let (reach, diameter) = (size(&tool.reach, limits::LENGTH), size(&tool.diameter, limits::DIAMETER));
    let [least, most] = limits::RATE;
    let max_rate = tool.max_rate.as_ref().map(|t| Mm3PerMin(reader.quantity(t, Dimension::REMOVAL_RATE, least, most)));
    let [least, steepest] = limits::RAMP;
    let ramp = tool.ramp.as_ref().map(|t| Rad(reader.quantity(t, Dimension::ANGLE, least, steepest)));
    let [least, steepest] = limits::TAPER;
    let angle = tool.angle.as_ref().map(|t| Rad(reader.quantity(t, Dimension::ANGLE, least, steepest)));
    let own = (corner, angle, (barrel, tip), (neck, neck_end));
    let kind = match (tool.kind.get_ref().as_str(), own, flute) {
        ("flat", (None, None, (None, None), (None, None)), Some(_)) => CutterKind::Flat,
        ("ball", (None, None, (None, None), (None, None)), Some(_)) => CutterKind::Ball,
        ("bull", (Some(corner), None, (None, None), (None, None)), Some(_)) => CutterKind::Bull(corner),
        ("tapered-ball", (None, Some(angle), (None, None), (None, None)), Some(_)) => CutterKind::TaperedBall(angle),
        ("barrel", (None, None, (Some(barrel), Some(tip)), (None, None)), Some(_)) => {
            CutterKind::Barrel { barrel, tip }
        }
        ("lollipop", (None, None, (None, None), (Some(neck), neck_end)), None) => {
            CutterKind::Lollipop { neck, neck_end: neck_end.unwrap_or(reach) }
        }
        (kind, ..) => {
            reader.fault(
                span,
                format!("tool `{name}` of kind `{kind}` has the wrong properties"),
                "flat, ball, bull with `corner`, tapered-ball with `angle`, barrel with `barrel` and `tip`, all with \
                 `flute`, and lollipop with `neck` exist"
                    .to_owned(),
                "correct the kind, or the properties that do not belong to it",
            );
            return None;
        }
    };
    let holder = match &tool.holder {
        None => None,
        Some(holder) => match library.holders.get(holder.get_ref()) {
            Some(sections) => Some((holder.get_ref().clone(), sections.clone())),
            None if library.alone => None,
            None => {
                let message = format!("no holder is called `{}`", holder.get_ref());
                reader.fault(reader.span(holder), message, "not in this library".to_owned(), "add [holder.NAME] above");
                return None;
            }
        },
    };
    let spec = ToolSpec {
        name: name.to_owned(),
        number: 0,
        kind,
        diameter,
        flutes: *tool.flutes.get_ref(),
        flute: flute.unwrap_or_else(|| Mm(kind.least_flute(diameter).0)),
        shank: shank.unwrap_or(diameter),
        reach,
        holder,
        limits: LoadLimits { chip: max_chip, depth: max_depth, rate: max_rate, plunge, ramp },
        span,
    };
    if let Some(fault) = shape_fault(&spec) {
        reader.fault(span, format!("tool `{name}`: {fault}"), "this tool".to_owned(), "correct its sizes");
        return None;
    }
    Some(spec)
}

/// The first contradiction in the sizes of a tool.
pub(super) fn shape_fault(tool: &ToolSpec) -> Option<String> {
    let radius = tool.diameter.get() / 2.0;
    let fault = match tool.kind {
        CutterKind::Bull(corner) if corner.get() >= radius => {
            "the corner radius must be smaller than half of the diameter"
        }
        CutterKind::Barrel { tip, .. } if tip.get() >= radius => {
            "the tip radius must be smaller than half of the diameter"
        }
        CutterKind::Barrel { barrel, .. } if barrel.get() <= radius => {
            "the barrel radius must be larger than half of the diameter; if both are equal, use a ball"
        }
        CutterKind::Lollipop { neck, .. } if neck.get() >= tool.diameter.get() => {
            "the neck must be thinner than the ball"
        }
        CutterKind::Lollipop { neck_end, .. } if neck_end.get() > tool.reach.get() => {
            "the neck must end within the reach, which goes from the tip to the holder"
        }
        CutterKind::Lollipop { neck_end, .. } if neck_end.get() < tool.flute.get() => {
            "the neck must end above the ball; `neck-end` is measured from the tip"
        }
        kind if tool.limits.plunge.is_some() && kind.corner(radius).is_none() => {
            "only flat, ball and bull tools have a `plunge-width`"
        }
        _ if tool.limits.plunge.is_some_and(|width| width.get() > radius) => {
            "the plunge width, from the rim towards the axis, must be at most half of the diameter"
        }
        _ => "",
    };
    if !fault.is_empty() {
        return Some(fault.to_owned());
    }
    let (least, what) = tool.kind.least_flute(tool.diameter);
    if tool.flute.get() < least {
        return Some(format!("the flutes must reach the {what}, {} mm above the tip", trim(least, 3)));
    }
    if tool.reach.get() < tool.flute.get() {
        return Some("the reach, from the tip to the holder, must be at least the flute length".to_owned());
    }
    let [least, most] = limits::FLUTES;
    (!(least..=most).contains(&tool.flutes)).then(|| format!("it needs {least} to {most} flutes"))
}
