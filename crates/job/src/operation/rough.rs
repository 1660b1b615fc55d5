//! The operation `rough`: one item of the job, one operation for each of its tools.

use super::{OperationReader, ROUGHS, allowances, leads};
use crate::block::context::{Context, head};
use crate::block::properties::{Properties, Range, named};
use crate::model::{CutterKind, OperationKind, OperationSpec, ToolSpec};
use crate::property::limits;
use crate::property::quantity::Dimension;
use crate::property::{Property, Without};
use crate::vocabulary::operations::{
    ENGAGEMENT, FEED, LEVELS, MILLING, REST, ROUGH_DEPTH, SLOTS, SPEED, STEPOVER, TOOLS,
};
use crate::vocabulary::{self, TopicKind};
use base::units::{Mm, Rad};
use diagnostics::{Diag, codes::job as codes};
use syntax::ast::{Expr, Item, ItemKind, Name};
use wheel::method::{Levels, Milling, Slots};
use wheel::operation::RoughingStrategy;

/// Default of `rest over` for the tools after the first: this share of the diameter, at most [`MAX_REST_MM`].
const REST_SHARE: f64 = 0.1;
const MAX_REST_MM: f64 = 0.2;

/// Step of the tool down or across, which has a default for each tool.
struct StepSize {
    property: Property,
    /// Defaults as shares of the diameter, for a tool with a flat end and for one with a ball.
    flat: f64,
    ball: f64,
    /// Largest value for a tool.
    most: fn(&ToolSpec) -> Mm,
}

const DOWN: StepSize = StepSize { property: ROUGH_DEPTH, flat: 0.375, ball: 0.33, most: |tool| tool.flute };
const ACROSS: StepSize = StepSize { property: STEPOVER, flat: 0.75, ball: 0.4, most: |tool| tool.diameter };

impl OperationReader<'_> {
    /// The operations of a `rough` item, one for each tool, in the order of the job.
    pub(super) fn rough(&mut self, item: &Item, cx: &mut Context<'_>) -> Option<Vec<OperationSpec>> {
        let ItemKind::Operation { kind, body, .. } = &item.kind else { return None };
        let owner = format!("operation {}", self.name);
        let mut p = Properties::new(
            owner,
            head(item),
            body,
            &vocabulary::properties(TopicKind::Operation, "rough"),
            &mut cx.scope,
            cx.sink,
        );
        let tools = self.tools_of(kind, &mut p)?;
        let count = tools.len();
        let speeds = each(&mut p, &SPEED, count);
        let feeds = each(&mut p, &FEED.like("1000 mm/min"), count);
        let depths = each(&mut p, &ROUGH_DEPTH, count);
        let stepovers = each(&mut p, &STEPOVER, count);
        let link_feed = self.link_feed(&mut p);
        let [lead_in, lead_out] = leads(&mut p);
        let given_rest = p.has(REST.name);
        // `rest` of the first operation on a whole blank speaks of its later tools.
        let finds_rest = !self.on_whole_blank;
        self.on_whole_blank &= count < 2;
        let rest = self.rest(&mut p);
        let sectors = self.sectors(&mut p);
        let allowances = allowances(&mut p);
        let (levels, milling) =
            (named(&mut p, &LEVELS, &Levels::ALL, Levels::name), named(&mut p, &MILLING, &Milling::ALL, Milling::name));
        let slots = slots(&mut p);
        let mut operations = Vec::new();
        let (speeds, feeds, depths, stepovers) = (speeds?, feeds?, depths?, stepovers?);
        let tools: Vec<usize> = tools.into_iter().collect::<Option<_>>()?;
        for (k, tool) in tools.into_iter().enumerate() {
            let spec = self.tools.get(tool).and_then(|t| t.spec.as_ref());
            let speed = self.speed_of(speeds.get(k).copied().flatten()?, spec, &mut p);
            let feed = self.feed_of(feeds.get(k).copied().flatten()?, spec, speed, &mut p);
            let depth = DOWN.of(&mut p, depths.get(k).copied().flatten(), spec);
            let stepover = ACROSS.of(&mut p, stepovers.get(k).copied().flatten(), spec);
            let slots = match slots.as_ref()? {
                GivenSlots::Full => Slots::Full,
                GivenSlots::Trochoidal(given) => {
                    Slots::Trochoidal { engagement: given.unwrap_or(side_engagement(stepover?, spec?)) }
                }
            };
            let (depth, stepover) = (depth?, stepover?);
            let strategy = RoughingStrategy::Rough { depth, stepover, levels: levels?, milling: milling?, slots };
            let rest = match (k, given_rest) {
                (0, _) => rest?.filter(|_| finds_rest),
                (_, false) => spec.map(|tool| Mm(MAX_REST_MM.min(REST_SHARE * tool.diameter.get()))),
                (_, true) => rest?,
            };
            operations.push(OperationSpec {
                name: self.name.clone(),
                kind: OperationKind::Roughing { allowances: allowances?, strategy },
                tool,
                speed: speed?,
                feed: feed?,
                link_feed: link_feed?,
                lead_in: lead_in?,
                lead_out: lead_out?,
                rest,
                sectors: sectors.clone()?,
                span: head(item),
            });
        }
        Some(operations)
    }

    /// The tools that the job names, `None` in the place of an unreadable one; by default all tools of the job that can
    /// rough, the widest one first; of two as wide as each other the one without a ball.
    fn tools_of(&self, kind: &Name, p: &mut Properties<'_, '_>) -> Option<Vec<Option<usize>>> {
        if p.has(TOOLS.name) {
            let words = p.words_of(&TOOLS)?;
            return Some(words.iter().map(|word| self.named_tool(kind, word, p).map(|found| found.value)).collect());
        }
        let specs = self.tools.iter().map(|declared| declared.spec.as_ref());
        if specs.clone().any(|spec| spec.is_none()) {
            // The fault of a tool is reported where it is declared.
            return None;
        }
        let mut tools: Vec<(usize, &ToolSpec)> = specs.flatten().enumerate().collect();
        tools.retain(|(_, spec)| ROUGHS.contains(&spec.kind.keyword()));
        tools.sort_by(|(_, a), (_, b)| {
            b.diameter.get().total_cmp(&a.diameter.get()).then(has_ball(a).cmp(&has_ball(b)))
        });
        if tools.is_empty() {
            p.missing(TOOLS.name, &TOOLS.written());
            return None;
        }
        Some(tools.into_iter().map(|(at, _)| Some(at)).collect())
    }
}

/// True for a tool with a ball at its end.
fn has_ball(tool: &ToolSpec) -> bool {
    matches!(tool.kind, CutterKind::Ball | CutterKind::TaperedBall(_))
}

/// How the job says that slots are made.
enum GivenSlots {
    Full,
    /// By loops, with their arc of engagement where the job gives one.
    Trochoidal(Option<Rad>),
}

fn slots(p: &mut Properties<'_, '_>) -> Option<GivenSlots> {
    let trochoidal = named(p, &SLOTS, &Slots::NAMES, |name| name)? != Slots::NAMES[0];
    let Some((arc, span)) = p.read(&ENGAGEMENT)? else {
        return Some(if trochoidal { GivenSlots::Trochoidal(None) } else { GivenSlots::Full });
    };
    if !trochoidal {
        p.sink.push(
            Diag::error(codes::WRONG_FORM, "only `slots trochoidal` has the property `engagement`")
                .label(span, "a slot at full width has 180 deg")
                .help("add `slots trochoidal`, or remove `engagement`"),
        );
        return None;
    }
    Some(GivenSlots::Trochoidal(Some(Rad(arc))))
}

/// Arc of engagement of a line beside a straight cut, within the arcs that loops may have.
fn side_engagement(stepover: Mm, tool: &ToolSpec) -> Rad {
    let [least, most] = limits::ENGAGEMENT.bounds();
    Rad(libm::acos(1.0 - 2.0 * stepover.get() / tool.diameter.get()).clamp(least, most))
}

/// One expression for each of `count` tools: a single value holds for all. `None` in the list where an optional property
/// is not given.
pub(super) fn each<'a>(p: &mut Properties<'a, '_>, property: &Property, count: usize) -> Option<Vec<Option<&'a Expr>>> {
    let (name, example) = (property.name, &property.written());
    if !p.given(property) {
        return (property.without != Without::Required).then(|| vec![None; count]);
    }
    let given = p.expressions(name, example)?;
    match given.as_slice() {
        [one] => Some(vec![Some(*one); count]),
        several if several.len() == count => Some(several.iter().map(|e| Some(*e)).collect()),
        several => {
            let due = format!("one value, or one for each of the {count} tools");
            p.wrong_form(several.last()?.span, name, &due, example);
            None
        }
    }
}

impl StepSize {
    /// The value of an expression, or the default of a tool.
    fn of(&self, p: &mut Properties<'_, '_>, expr: Option<&Expr>, tool: Option<&ToolSpec>) -> Option<Mm> {
        let tool = tool?;
        if let Some(expr) = expr {
            let range = Range::Between(limits::LEAST_DEPTH, (self.most)(tool).get());
            return p.value_of(expr, self.property.name, Dimension::LENGTH, range).map(Mm);
        }
        let share = if has_ball(tool) { self.ball } else { self.flat };
        Some(Mm(share * tool.diameter.get()))
    }
}
