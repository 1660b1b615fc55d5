//! Operations: tool, speed, feed, and the properties of each kind.

mod channel;
mod finishing;
mod plunge;
mod rough;
pub(crate) mod tools;

use crate::block::context::{Context, head};
use crate::block::eval::{mismatch, suggest, unknown};
pub(super) use crate::block::properties::named;
use crate::block::properties::{LabelledValue, Properties, Range};
use crate::model::{MachineSpec, OperationKind, OperationSpec, ToolSpec};
use crate::property::limits;
use crate::property::quantity::Dimension;
use crate::property::{Form, Property, ToolSize};
use crate::vocabulary::operations::{
    ALLOWANCE, DEPTH, EDGES, FEED, FLOOR_SCALLOP, LEAD_IN, LEAD_OUT, LINES, LINES_ROUND, LINK_FEED, METHOD, RESIDUAL,
    REST, SCALLOP, SECTORS, SPACING, SPEED, TOOL,
};
use crate::vocabulary::{self, TopicKind};
use base::source::{Span, Spanned};
use base::units::{Mm, MmPerMin, Rpm, length, trim};
use diagnostics::Diag;
use diagnostics::codes::job as codes;
use finishing::{blades, chosen, faces, flank, levels, milling_of, point_axes};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;
use syntax::ast::{AUTO, Expr, File, Item, ItemKind, Name};
use tools::Declared;
use wheel::material::Material;
use wheel::method::{AxisMethod, Lines, Spacing};
use wheel::operation::{Allowances, RoughingStrategy, VaneAllowance, by_lines};
use wheel::part::SurfaceKind;

/// Kinds of tools that can rough.
pub(super) const ROUGHS: [&str; 4] = ["flat", "ball", "bull", "tapered-ball"];

/// What operations take from part and stock.
pub(super) struct Workpiece {
    /// Number of vanes, where the part is readable.
    pub(super) vanes: Option<u32>,
    /// Names of the blades of a sector, the main blade first; none where the part is not readable.
    pub(super) blades: Vec<String>,
    /// True where a file states what is left of the blank.
    pub(super) cut_before: bool,
    /// Material of the stock.
    pub(super) material: Option<Material>,
}

pub(super) fn resolve(
    file: &File,
    tools: &[Declared],
    machine: Option<&MachineSpec>,
    workpiece: &Workpiece,
    cx: &mut Context<'_>,
) -> Vec<OperationSpec> {
    let mut out = Vec::new();
    let mut used = Used::default();
    let mut layers: Option<Layers> = None;
    let (mut any, mut open) = (false, None);
    let mut cut_before = workpiece.cut_before;
    for item in &file.items {
        if let ItemKind::Operations(word) = &item.kind {
            all_open(item, word, &mut open, cx);
            (any, cut_before) = (true, true);
        }
        let ItemKind::Operation { kind, name, .. } = &item.kind else { continue };
        any = true;
        let kinds = vocabulary::names(TopicKind::Operation);
        if !kinds.contains(&kind.text.as_str()) {
            let message = format!("operation `{}` is not in the language", kind.text);
            let diag = Diag::error(codes::NOT_IN_LANGUAGE, message);
            cx.sink.push(suggest(diag, &kind.text, kind.span, "operation", &kinds));
            continue;
        }
        let name = unique_name(kind, name.as_ref(), &mut used, cx);
        if item.is_open() {
            continue;
        }
        let on_whole_blank = used.names.len() == 1 && !cut_before;
        let mut reader = OperationReader { name, on_whole_blank, tools, machine, workpiece, groove: layers };
        let several = match kind.text.as_str() {
            "rough" => Some(reader.rough(item, cx)),
            _ if OperationReader::has_list(item) => Some(reader.channel(item, cx)),
            _ => None,
        };
        if let Some(planned) = several {
            let mut planned = planned.unwrap_or_default();
            for (k, operation) in planned.iter_mut().enumerate().skip(1) {
                operation.name = numbered(&operation.name, k + 1, kind.span, &mut used);
            }
            out.extend(planned);
            continue;
        }
        let operation = reader.read(item, cx);
        if let Some(OperationKind::Roughing { allowances, strategy: RoughingStrategy::Groove { depth } }) =
            operation.as_ref().map(|o| &o.kind)
        {
            layers = Some(Layers { depth: *depth, allowances: *allowances });
        }
        out.extend(operation);
    }
    if !any && !file.damaged {
        cx.sink.push(Diag::error(codes::MISSING_ITEM, "the job has no operation").help(
            "add `operation rough { ... }`; operations are rough, plunge, groove, expand, flank, point, fillet, edge and channel",
        ));
    }
    out
}

/// Reads `operations auto`, which may stand once; `first` is the place of the first one.
fn all_open(item: &Item, word: &Name, first: &mut Option<Span>, cx: &mut Context<'_>) {
    if word.text != AUTO {
        let message = format!("`operations {}` is not in the language", word.text);
        cx.sink.push(suggest(Diag::error(codes::NOT_IN_LANGUAGE, message), &word.text, word.span, "word", &[AUTO]));
    } else if let Some(first) = first {
        cx.sink.push(
            Diag::error(codes::GIVEN_TWICE, "the job has `operations auto` twice")
                .label(item.span, "given again")
                .label(*first, "first given here")
                .help("keep the one that stands where the operations are to run"),
        );
    } else {
        *first = Some(item.span);
    }
}

/// Names of the operations so far.
#[derive(Default)]
struct Used {
    names: BTreeMap<String, Span>,
    /// Last number in a generated name, by kind.
    numbers: BTreeMap<String, u32>,
}

/// The given name, or the kind, with a number when it is not the first of its kind.
fn unique_name(kind: &Name, name: Option<&Name>, used: &mut Used, cx: &mut Context<'_>) -> String {
    let span = name.map_or(kind.span, |n| n.span);
    let text = match name {
        Some(name) => {
            if let Some(first) = used.names.get(&name.text) {
                cx.sink.push(
                    Diag::error(codes::GIVEN_TWICE, format!("two operations are called `{}`", name.text))
                        .label(name.span, "the second one")
                        .label(*first, "the first one")
                        .help("give the second operation another name"),
                );
            }
            name.text.clone()
        }
        None => {
            let mut text = kind.text.clone();
            while used.names.contains_key(&text) {
                let number = used.numbers.entry(kind.text.clone()).or_insert(1);
                *number += 1;
                text = format!("{}{number}", kind.text);
            }
            text
        }
    };
    used.names.entry(text.clone()).or_insert(span);
    text
}

/// The name with the next free number from `number` on.
fn numbered(name: &str, number: usize, span: Span, used: &mut Used) -> String {
    let text = (number..).map(|n| format!("{name}{n}")).find(|text| !used.names.contains_key(text));
    let text = text.unwrap_or_else(|| name.to_owned());
    used.names.insert(text.clone(), span);
    text
}

pub(super) struct OperationReader<'a> {
    pub(super) name: String,
    /// True for the first operation of a job that starts from the whole blank.
    pub(super) on_whole_blank: bool,
    pub(super) tools: &'a [Declared],
    machine: Option<&'a MachineSpec>,
    workpiece: &'a Workpiece,
    groove: Option<Layers>,
}

/// Properties that both roughing operations have.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Layers {
    /// Largest step down.
    depth: Mm,
    /// What stays on the part.
    allowances: Allowances,
}

impl OperationReader<'_> {
    fn read(&mut self, item: &Item, cx: &mut Context<'_>) -> Option<OperationSpec> {
        let ItemKind::Operation { kind, body, .. } = &item.kind else { return None };
        let known = vocabulary::properties(TopicKind::Operation, &kind.text);
        let owner = format!("operation {}", self.name);
        let mut p = Properties::new(owner, head(item), body, &known, &mut cx.scope, cx.sink);
        let tool = self.tool(kind, &mut p);
        let spec = tool.as_ref().and_then(|tool| self.tools.get(tool.value)).and_then(|t| t.spec.as_ref());
        let speed = self.speed(spec, &mut p);
        let feed = self.feed(spec, speed, &mut p);
        let link_feed = self.link_feed(&mut p);
        let [lead_in, lead_out] = leads(&mut p);
        let rest = self.rest(&mut p);
        let sectors = self.sectors(&mut p);
        let kind = self.kind(kind, spec, &mut p);
        Some(OperationSpec {
            name: self.name.clone(),
            kind: kind?,
            tool: tool?.value,
            speed: speed?,
            feed: feed?,
            link_feed: link_feed?,
            lead_in: lead_in?,
            lead_out: lead_out?,
            rest: rest?,
            sectors: sectors?,
            span: head(item),
        })
    }

    /// Feed of links, or its default.
    pub(super) fn link_feed(&self, p: &mut Properties<'_, '_>) -> Option<MmPerMin> {
        match p.read(&LINK_FEED)? {
            Some((feed, span)) => self.within_axes(LINK_FEED.name, feed, span, p),
            None => LINK_FEED.default().map(MmPerMin),
        }
    }

    fn tool(&mut self, kind: &Name, p: &mut Properties<'_, '_>) -> Option<Spanned<usize>> {
        let words = p.words_of(&TOOL)?;
        let [word] = words.as_slice() else {
            p.wrong_form(words.first()?.span, TOOL.name, "one tool", &TOOL.written());
            return None;
        };
        self.named_tool(kind, word, p)
    }

    /// The declared tool with this name, if its kind suits the operation.
    pub(super) fn named_tool(&self, kind: &Name, word: &Name, p: &mut Properties<'_, '_>) -> Option<Spanned<usize>> {
        let needed: &[&str] = match kind.text.as_str() {
            // Offsets of rulings assume a cylinder that ends in a ball.
            "flank" if p.is_word("method", "two-point") || p.is_word("method", "one-point") => &["ball"],
            "flank" => &["ball", "bull", "flat", "tapered-ball", "barrel"],
            "point" => &["ball", "bull", "barrel", "tapered-ball", "lollipop"],
            // A ball only touches fillet, edge, tip and the floor beside the walls.
            "fillet" | "edge" | "tip" => &["ball", "tapered-ball", "lollipop"],
            "channel" => &["ball", "lollipop"],
            "rough" => &ROUGHS,
            _ => &["flat", "ball", "bull"],
        };
        // In a list of tools, bull noses may finish the middle.
        let place = if kind.text == "channel" { ", beside the walls," } else { "" };
        self.tool_of_kind(word, &format!("operation {}{place}", kind.text), needed, p)
    }

    /// The declared tool with this name, if it has one of the kinds that its user needs.
    pub(super) fn tool_of_kind(
        &self,
        word: &Name,
        user: &str,
        needed: &[&str],
        p: &mut Properties<'_, '_>,
    ) -> Option<Spanned<usize>> {
        let Some(at) = self.tools.iter().position(|t| t.name.text == word.text) else {
            if !p.scope.damaged {
                let known = self.tools.iter().map(|t| t.name.text.as_str());
                p.sink.push(unknown(&word.text, word.span, "tool", known));
            }
            return None;
        };
        let declared = self.tools.get(at)?;
        let suits = |kinds: &[&str]| declared.spec.as_ref().is_none_or(|s| kinds.contains(&s.kind.keyword()));
        if !suits(needed) {
            let has = declared.spec.as_ref().map_or("", |s| s.kind.keyword());
            p.sink.push(
                Diag::error(codes::WRONG_TOOL, format!("operation {} cannot use a {has} tool", self.name))
                    .label(word.span, format!("`{}` is a {has} tool", word.text))
                    .label(declared.name.span, "declared here")
                    .help(format!("{user} needs a tool of the kind {}", needed.join(", "))),
            );
            return None;
        }
        Some(Spanned::new(at, word.span))
    }

    /// Spindle speed, given directly or as the cutting speed at the tool's diameter.
    fn speed(&self, tool: Option<&ToolSpec>, p: &mut Properties<'_, '_>) -> Option<Rpm> {
        let expr = p.expression_of(&SPEED)?;
        self.speed_of(expr, tool, p)
    }

    /// The spindle speed that an expression means for a tool.
    pub(super) fn speed_of(&self, expr: &Expr, tool: Option<&ToolSpec>, p: &mut Properties<'_, '_>) -> Option<Rpm> {
        let value = p.scope.value(expr, p.sink)?;
        let rpm = match value.dimension {
            Dimension::SPINDLE => value.value,
            Dimension::FEED => value.value / (PI * tool?.diameter.get()),
            _ => {
                p.sink.push(mismatch(expr, value, &[Dimension::SPINDLE, Dimension::FEED], "`speed`"));
                return None;
            }
        };
        let [min, max] = self.machine.map_or([Rpm(0.0), Rpm(1e6)], |m| m.spindle);
        if rpm < min.get() || rpm > max.get() || rpm < limits::LEAST_SPINDLE {
            let name = self.machine.map_or("any machine", |m| m.name.as_str());
            p.sink.push(
                Diag::error(
                    codes::MACHINE_RANGE,
                    format!("the spindle of {name} does not turn at {} rpm", trim(rpm, 1)),
                )
                .label(expr.span, format!("the range is {} to {} rpm", min.get().max(limits::LEAST_SPINDLE), max.get()))
                .help("choose a speed within the range of the spindle"),
            );
            return None;
        }
        Some(Rpm(rpm))
    }

    /// Feed, given directly or per tooth.
    fn feed(&self, tool: Option<&ToolSpec>, speed: Option<Rpm>, p: &mut Properties<'_, '_>) -> Option<MmPerMin> {
        let expr = p.expression_of(&FEED)?;
        self.feed_of(expr, tool, speed, p)
    }

    /// The feed that an expression means for a tool at a speed.
    pub(super) fn feed_of(
        &self,
        expr: &Expr,
        tool: Option<&ToolSpec>,
        speed: Option<Rpm>,
        p: &mut Properties<'_, '_>,
    ) -> Option<MmPerMin> {
        let value = p.scope.value(expr, p.sink)?;
        let feed = match value.dimension {
            Dimension::FEED => value.value,
            Dimension::FEED_PER_TOOTH => value.value * speed?.get() * f64::from(tool?.flutes),
            _ => {
                p.sink.push(mismatch(expr, value, &[Dimension::FEED, Dimension::FEED_PER_TOOTH], "`feed`"));
                return None;
            }
        };
        if !limits::FEED.holds(feed) {
            p.out_of_range(expr.span, "feed", &limits::FEED.text(Dimension::FEED));
            return None;
        }
        let feed = self.within_axes("feed", feed, expr.span, p)?;
        match (tool, speed) {
            (Some(tool), Some(speed)) => self.within_chip(feed, expr.span, tool, speed, p),
            _ => Some(feed),
        }
    }

    /// The feed when its feed per tooth is within the limit of the tool.
    fn within_chip(
        &self,
        feed: MmPerMin,
        span: Span,
        tool: &ToolSpec,
        speed: Rpm,
        p: &mut Properties<'_, '_>,
    ) -> Option<MmPerMin> {
        let (teeth, most) = (speed.get() * f64::from(tool.flutes), tool.largest_chip(self.workpiece.material).get());
        let chip = feed.get() / teeth;
        // Room for rounding where the job states the limit itself.
        if chip <= most * (1.0 + 1e-9) {
            return Some(feed);
        }
        let limit = match tool.limits.chip {
            Some(_) => "its `max-chip`".to_owned(),
            None => format!(
                "{} % of its diameter of {} at a stick-out of {} diameters{}",
                trim(100.0 * most / tool.diameter.get(), 2),
                tool.diameter,
                trim(tool.reach.get() / tool.diameter.get(), 1),
                self.workpiece.material.map_or_else(String::new, |m| format!(" in {}", m.name()))
            ),
        };
        p.sink.push(
            Diag::error(
                codes::CHIP,
                format!("operation {} feeds {} by {} a tooth", self.name, tool.name, length(chip)),
            )
            .label(span, format!("the limit is {}", length(most)))
            .note(format!("{} has {} flutes and a limit of {limit}", tool.name, tool.flutes))
            .note(format!(
                "{} are a cutting speed of {} m/min at its diameter",
                speed,
                trim(speed.get() * PI * tool.diameter.get() / 1000.0, 2)
            ))
            .help(format!(
                "use a feed of at most {} mm/min; a higher speed; or, where the maker of the tool allows it, `max-chip {}` \
                 of the tool",
                trim((teeth * most).floor(), 0),
                Mm((chip * 1e4).ceil() / 1e4)
            )),
        );
        None
    }

    fn within_axes(&self, name: &str, feed: f64, span: Span, p: &mut Properties<'_, '_>) -> Option<MmPerMin> {
        let fastest =
            self.machine.map_or(1e6, |m| m.linear.iter().map(|a| a.speed.get()).fold(f64::INFINITY, f64::min));
        if feed <= fastest {
            return Some(MmPerMin(feed));
        }
        p.sink.push(
            Diag::error(
                codes::MACHINE_RANGE,
                format!("the `{name}` of operation {} is too fast for the machine", self.name),
            )
            .label(span, format!("its slowest linear axis reaches {fastest} mm/min"))
            .help("choose a lower feed"),
        );
        None
    }

    /// Thickness of rest machining; `Some(None)` when it is off.
    pub(super) fn rest(&self, p: &mut Properties<'_, '_>) -> Option<Option<Mm>> {
        if !p.has(REST.name) {
            return Some(None);
        }
        if p.is_word(REST.name, "off") {
            p.take(REST.name);
            return Some(None);
        }
        let values = p.labelled(REST.name, &["over"], &REST.written());
        let (label, expr) = values.first()?;
        let thickness =
            p.value_of(expr, "rest over", Dimension::LENGTH, Range::Between(limits::REST[0], limits::REST[1]))?;
        if self.on_whole_blank {
            p.sink.push(
                Diag::error(
                    codes::NO_REST_BEFORE,
                    format!("`{}` uses `rest over`, but no operation comes before it", self.name),
                )
                .label(Span { end: expr.span.end, ..label.span }, "earlier operations leave the rest")
                .help(
                    "remove `rest` from the first operation, or give the stock what is left of it: `from \"left.stl\"`",
                ),
            );
            return None;
        }
        Some(Some(Mm(thickness)))
    }

    pub(super) fn sectors(&self, p: &mut Properties<'_, '_>) -> Option<Vec<u32>> {
        let count = self.workpiece.vanes.unwrap_or(10_000);
        if !p.has(SECTORS.name) {
            return Some((0..count).collect());
        }
        let sectors = p.counts(SECTORS.name, 1, count, &SECTORS.written())?;
        let mut seen = BTreeSet::new();
        for (sector, span) in &sectors {
            if !seen.insert(*sector) {
                p.sink.push(
                    Diag::error(codes::GIVEN_TWICE, format!("sector {sector} is given twice"))
                        .label(*span, "given again")
                        .help("name each sector once"),
                );
                return None;
            }
        }
        // Ascending: an operation works from sector to sector.
        Some(seen.into_iter().map(|s| s - 1).collect())
    }

    pub(super) fn kind(
        &self,
        kind: &Name,
        tool: Option<&ToolSpec>,
        p: &mut Properties<'_, '_>,
    ) -> Option<OperationKind> {
        match kind.text.as_str() {
            "groove" => {
                let Layers { depth, allowances } = self.layers(false, tool, p)?;
                Some(OperationKind::Roughing { allowances, strategy: RoughingStrategy::Groove { depth } })
            }
            "expand" => {
                let layers = self.layers(true, tool, p);
                let residual = length_of(&RESIDUAL, tool, p);
                let Layers { depth, allowances } = layers?;
                let strategy = RoughingStrategy::Expand { depth, residual: residual? };
                Some(OperationKind::Roughing { allowances, strategy })
            }
            "plunge" => self.plunge(tool, p),
            "flank" => flank(&self.workpiece.blades, p),
            "point" | "fillet" | "edge" | "tip" => {
                let scallop = length_of(&SCALLOP, tool, p);
                let blades = blades(&self.workpiece.blades, p)?;
                let given = match kind.text.as_str() {
                    "edge" => chosen(p, &EDGES, "edge", ["inlet", "outlet"]),
                    "tip" => Some(vec!["tip"]),
                    _ => faces(p),
                };
                let of_kind = blades.into_iter().flat_map(by_lines).filter(|s| s.1 == kind.text);
                let faces = given.as_ref().map_or(0, Vec::len);
                let surfaces = given.map(|given| of_kind.filter(|s| given.contains(&s.2)).map(|s| s.0).collect());
                let row = if kind.text == "point" { LINES_ROUND } else { LINES };
                let spiral = p.is_word("lines", "spiral");
                let lines = named(p, &row, &Lines::ROUND, Lines::name);
                if spiral && faces == 1 {
                    p.sink.push(
                        Diag::error(codes::WRONG_FORM, format!("`lines spiral` of {} needs both faces", self.name))
                            .label(kind.span, "this operation finishes one face only")
                            .help("name both faces, `faces pressure, suction`, or use `lines zigzag`"),
                    );
                    return None;
                }
                let milling =
                    if matches!(kind.text.as_str(), "edge" | "tip") { Some(None) } else { milling_of(lines?, p) };
                let (scallop, method) = (scallop?, point_axes(tool, p)?);
                let (surfaces, lines, milling): (Vec<SurfaceKind>, _, _) = (surfaces?, lines?, milling?);
                let levels = if kind.text == "point" { levels(lines, faces, p)? } else { None };
                Some(OperationKind::Point { surfaces, scallop, lines, milling, levels, method })
            }
            _ => {
                let scallop = length_of(&FLOOR_SCALLOP, tool, p);
                let (spacing, lines) =
                    (named(p, &SPACING, &Spacing::ALL, Spacing::name), named(p, &LINES, &Lines::ALL, Lines::name));
                let method = named(p, &METHOD, &AxisMethod::ALL, AxisMethod::name);
                let scallop = scallop?;
                Some(OperationKind::Channel {
                    scallop,
                    spacing: spacing?,
                    lines: lines?,
                    method: method?,
                    allowance_vane: None,
                })
            }
        }
    }

    /// Step down and allowances; `expand` takes missing values from the groove before it.
    fn layers(&self, inherits: bool, tool: Option<&ToolSpec>, p: &mut Properties<'_, '_>) -> Option<Layers> {
        let before = self.groove.filter(|_| inherits);
        let depth = match before {
            Some(before) if !p.has(DEPTH.name) => Some(before.depth),
            _ => length_of(&DEPTH, tool, p),
        };
        let allowances = match before {
            Some(before) if !p.has(ALLOWANCE.name) => before.allowances,
            _ => allowances(p)?,
        };
        Some(Layers { depth: depth?, allowances })
    }
}

/// A length whose largest value is a size of the tool; where the tool is not readable, that of a very large one.
fn length_of(property: &Property, tool: Option<&ToolSpec>, p: &mut Properties<'_, '_>) -> Option<Mm> {
    let Form::LengthTo(least, size) = property.form else { return None };
    let most = match size {
        ToolSize::Radius => tool.map_or(250.0, |tool| tool.diameter.get() / 2.0),
        ToolSize::Flutes => tool.map_or(1000.0, |tool| tool.flute.get()),
    };
    let range = Range::Between(least, most);
    p.required(property.name, Dimension::LENGTH, range, &property.written()).map(|length| Mm(length.0))
}

/// Largest allowance, mm.
pub(super) const ALLOWANCES: Range = Range::NotNegative(100.0);

/// Allowances on vane and hub.
pub(super) fn allowances(p: &mut Properties<'_, '_>) -> Option<Allowances> {
    let (name, example) = (ALLOWANCE.name, &ALLOWANCE.written());
    if !p.given(&ALLOWANCE) {
        return None;
    }
    let values = p.labelled_ranges(name, &["vane", "hub"], example);
    let [vane, hub] = ["vane", "hub"].map(|label| {
        let found = values.iter().copied().find(|(l, _)| l.text == label);
        if found.is_none() {
            p.missing(&format!("{name} {label}"), example);
        }
        found
    });
    let vane = vane.and_then(|(_, of)| vane_allowance(of, p));
    let hub = hub.and_then(|(label, of)| {
        let one = p.single(name, label, of, example)?;
        p.value_of(one, "allowance hub", Dimension::LENGTH, ALLOWANCES).map(Mm)
    });
    Some(Allowances { vane: vane?, hub: hub? })
}

/// Allowance on the vanes: one value, or one at the tip and one at the root.
fn vane_allowance(of: LabelledValue<'_>, p: &mut Properties<'_, '_>) -> Option<VaneAllowance> {
    let mut value = |expr| p.value_of(expr, "allowance vane", Dimension::LENGTH, ALLOWANCES).map(Mm);
    let tip = value(of.first);
    let Some(second) = of.second else { return tip.map(VaneAllowance::even) };
    let (root, tip) = (value(second)?, tip?);
    let allowance = VaneAllowance::growing(tip, root);
    if allowance.is_none() {
        p.sink.push(
            Diag::error(codes::OUT_OF_RANGE, "`allowance vane` is smaller at the root than at the tip")
                .label(of.first.span, "at the tip")
                .label(second.span, "at the root")
                .note("a vane is stiff if it is thicker at the root, where it stands on the hub")
                .help(format!("give the smaller value first, `vane {root} .. {tip}`; or one value, `vane {tip}`")),
        );
    }
    allowance
}

/// Lengths of both leads, or their defaults.
pub(super) fn leads(p: &mut Properties<'_, '_>) -> [Option<Mm>; 2] {
    [LEAD_IN, LEAD_OUT].map(|lead| p.read_or_default(&lead).map(Mm))
}
