//! Tool files: TOML through serde.

use super::eval::nearest;
use super::library::{LibraryReader, SectionTable, SpannedText};
use super::library_form;
use super::library_schema::LibraryFile;
use super::limits;
use super::model::{CutterKind, LoadLimits, ToolSpec};
use super::quantity::Dimension;
use base::source::{SourceId, SourceMap, Span};
use base::units::{Mm, Mm3PerMin, Rad, trim};
use diagnostics::codes::job as codes;
use diagnostics::{Diag, Sink};
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
    /// True when a file has a fault, which was reported: holders and tools may be missing by it.
    pub(super) faulty: bool,
    /// Sections by holder name: length, lower and upper diameter.
    pub(super) holders: BTreeMap<String, Vec<[Mm; 3]>>,
    /// Tools by name; number and span come from the job.
    pub(super) tools: BTreeMap<String, ToolSpec>,
}

/// Adds a tool file that is already in the source map to the library.
pub(super) fn tools(source: SourceId, sources: &SourceMap, asked: Span, into: &mut ToolLibrary, sink: &mut Sink) {
    let read = library_form::read(LibraryFile::Tools, source, sources, Some(asked), sink);
    let Some(table): Option<ToolsFile> = read else {
        into.faulty = true;
        return;
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
        if let [first, .., last] = &sections[..]
            && !reader.faults
            && is_upside_down(&sections)
        {
            let span = reader.span(&holder.section[0].length);
            reader.sink.push(
                upside_down(&name, first[1], last[2]).label(span, "this section is at the nose, beside the cutter"),
            );
        }
        into.holders.insert(name, sections);
    }
    for (name, tool) in table.tool {
        if let Some(spec) = library_tool(&name, &tool, into, &mut reader) {
            into.tools.insert(name, spec);
        }
    }
    into.faulty |= reader.faults;
}

/// True for sections that never grow from the nose upwards and are thinnest at the spindle, as in a list from the spindle down.
fn is_upside_down(sections: &[[Mm; 3]]) -> bool {
    let ends: Vec<f64> = sections.iter().flat_map(|[_, lower, upper]| [lower.get(), upper.get()]).collect();
    sections.len() > 1 && ends.windows(2).all(|pair| pair[1] <= pair[0]) && ends.first() > ends.last()
}

fn upside_down(name: &str, nose: Mm, top: Mm) -> Diag {
    Diag::warning(
        codes::DOUBTFUL,
        format!("the holder {name} is {nose} wide at its nose and {top} at the spindle: it seems to be listed from the spindle down"),
    )
    .help("list the sections from the nose upwards: the one beside the cutter first; `lower` is the end of a section nearer to the cutter")
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
            wrong_kind(name, (kind, tool), reader);
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
                let known: Vec<&str> = library.holders.keys().map(String::as_str).collect();
                let own = holder.get_ref();
                let help = match nearest(own, known.iter().copied()) {
                    Some(near) => format!("write \"{near}\", or add `[holder.{own}]` with its sections"),
                    None => format!("write one of {}, or add `[holder.{own}]` with its sections", known.join(", ")),
                };
                reader.fault(reader.span(holder), message, "not in this library".to_owned(), &help);
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

/// Kinds of cutters with the properties that each must have, and those that it may have, besides those of every tool.
const KINDS: [(&str, &[&str], &[&str]); 6] = [
    ("flat", &["flute"], &[]),
    ("ball", &["flute"], &[]),
    ("bull", &["corner", "flute"], &[]),
    ("tapered-ball", &["angle", "flute"], &[]),
    ("barrel", &["barrel", "tip", "flute"], &[]),
    ("lollipop", &["neck"], &["neck-end"]),
];

/// Reports a kind of cutter that does not exist, or its first property that is missing or not its own.
fn wrong_kind(name: &str, (kind, tool): (&str, &ToolTable), reader: &mut LibraryReader<'_>) {
    let span = reader.span(&tool.kind);
    let names = KINDS.map(|known| known.0);
    let Some((_, must, may)) = KINDS.into_iter().find(|known| known.0 == kind) else {
        let (label, help) = match nearest(kind, names.into_iter()) {
            Some(near) => (format!("did you mean \"{near}\"?"), format!("write `kind = \"{near}\"`")),
            None => ("not known".to_owned(), format!("kinds are {}", names.join(", "))),
        };
        reader.fault(span, format!("`{kind}` is not a kind of cutter"), label, &help);
        return;
    };
    let given = [
        ("corner", &tool.corner),
        ("angle", &tool.angle),
        ("barrel", &tool.barrel),
        ("tip", &tool.tip),
        ("neck", &tool.neck),
        ("neck-end", &tool.neck_end),
        ("flute", &tool.flute),
    ];
    let has = |key: &&&str| given.iter().any(|(name, value)| name == *key && value.is_some());
    if let Some(missing) = must.iter().find(|key| !has(key)) {
        let example = if *missing == "angle" { "3 deg" } else { "1 mm" };
        let help = format!("add `{missing} = \"{example}\"` with its value");
        reader.fault(
            span,
            format!("tool `{name}` of kind {kind} needs `{missing}`"),
            format!("`{missing}` is missing"),
            &help,
        );
        return;
    }
    let foreign = given.iter().find(|(key, value)| value.is_some() && !must.contains(key) && !may.contains(key));
    if let Some((key, Some(value))) = foreign {
        let of: Vec<&str> =
            KINDS.iter().filter(|known| known.1.contains(key) || known.2.contains(key)).map(|k| k.0).collect();
        let help = format!("remove `{key}`, or correct `kind`: {} has it", of.join(", "));
        reader.fault(
            reader.span(value),
            format!("tool `{name}` of kind {kind} has `{key}`"),
            format!("not of a {kind}"),
            &help,
        );
    }
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
