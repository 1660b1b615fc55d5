//! The operation `channel` with several tools: one item of the job, one operation for each of its tools.

use super::rough::each;
use super::{ALLOWANCES, OperationReader, leads};
use crate::block::context::{Context, head};
use crate::block::properties::Properties;
use crate::model::{OperationKind, OperationSpec, ToolSpec};
use crate::property::quantity::Dimension;
use crate::vocabulary::operations::{ALLOWANCE, FEED, SPACING, SPEED, TOOL, TOOLS};
use crate::vocabulary::{self, TopicKind};
use base::units::Mm;
use diagnostics::Diag;
use diagnostics::codes::job as codes;
use syntax::ast::{Block, Entry, Item, ItemKind, Name};
use wheel::method::{AxisMethod, Spacing};

/// Default of what larger tools leave beside vanes and fillets: a usual allowance of roughing, so that they do not cut the
/// vanes.
const VANE: Mm = Mm(0.2);

const BULL: &str = "bull";

/// The tools of a `channel` item, where it has a list of them.
fn list(body: &Block) -> Option<&Entry> {
    body.entries.iter().find(|entry| entry.name.text == TOOLS.name)
}

impl OperationReader<'_> {
    /// True for a `channel` item with a list of tools.
    pub(super) fn has_list(item: &Item) -> bool {
        matches!(&item.kind, ItemKind::Operation { kind, body, .. } if kind.text == "channel" && list(body).is_some())
    }

    /// The operations of a `channel` item with a list of tools, in the order of the job.
    pub(super) fn channel(&mut self, item: &Item, cx: &mut Context<'_>) -> Option<Vec<OperationSpec>> {
        let ItemKind::Operation { kind, body, .. } = &item.kind else { return None };
        let count = list(body).map_or(0, |entry| entry.values.len());
        // A single tool finishes the whole floor and leaves nothing.
        let allowance: &[&str] = if count > 1 { &[ALLOWANCE.name] } else { &[] };
        let others =
            vocabulary::properties(TopicKind::Operation, "channel").into_iter().filter(|name| *name != TOOL.name);
        let known: Vec<&str> = [TOOLS.name].into_iter().chain(others).chain(allowance.iter().copied()).collect();
        let owner = format!("operation {}", self.name);
        let mut p = Properties::new(owner, head(item), body, &known, &mut cx.scope, cx.sink);
        let words = p.words_of(&TOOLS)?;
        let tools: Option<Vec<usize>> =
            words.iter().enumerate().map(|(k, word)| self.floor_tool(kind, word, k + 1 < count, &mut p)).collect();
        let speeds = each(&mut p, &SPEED, count);
        let feeds = each(&mut p, &FEED, count);
        let link_feed = self.link_feed(&mut p);
        let [lead_in, lead_out] = leads(&mut p);
        let rest = self.rest(&mut p);
        let sectors = self.sectors(&mut p);
        let vane = allowance_vane(&mut p);
        let tools = tools?;
        let specs: Vec<Option<&ToolSpec>> =
            tools.iter().map(|tool| self.tools.get(*tool).and_then(|t| t.spec.as_ref())).collect();
        let fits_list = self.list_holds(&words, &specs, &mut p);
        let of_last = self.kind(kind, specs.last().copied().flatten(), &mut p);
        let (speeds, feeds) = (speeds?, feeds?);
        fits_list?;
        let mut operations = Vec::new();
        for (k, tool) in tools.into_iter().enumerate() {
            let spec = specs[k];
            let speed = self.speed_of(speeds.get(k).copied().flatten()?, spec, &mut p);
            let feed = self.feed_of(feeds.get(k).copied().flatten()?, spec, speed, &mut p);
            let mut kind = of_last.clone()?;
            if let OperationKind::Channel { allowance_vane, method, .. } = &mut kind
                && k + 1 < count
            {
                *allowance_vane = Some(vane?);
                if spec.is_some_and(|tool| tool.kind.keyword() == BULL) {
                    *method = AxisMethod::Lead;
                }
            }
            operations.push(OperationSpec {
                name: self.name.clone(),
                kind,
                tool,
                speed: speed?,
                feed: feed?,
                link_feed: link_feed?,
                lead_in: lead_in?,
                lead_out: lead_out?,
                rest: rest?,
                sectors: sectors.clone()?,
                span: head(item),
            });
        }
        Some(operations)
    }

    /// A tool of the list. Larger ones, which finish the middle of the floor, may be bull noses.
    fn floor_tool(&self, kind: &Name, word: &Name, is_larger: bool, p: &mut Properties<'_, '_>) -> Option<usize> {
        let found = if is_larger {
            self.tool_of_kind(word, "the middle of the floor", &["ball", "lollipop", BULL], p)
        } else {
            self.named_tool(kind, word, p)
        };
        found.map(|tool| tool.value)
    }

    /// Refuses tools that do not get smaller, and a spacing that several tools cannot share.
    fn list_holds(&self, words: &[&Name], specs: &[Option<&ToolSpec>], p: &mut Properties<'_, '_>) -> Option<()> {
        let mut holds = Some(());
        for (pair, names) in specs.windows(2).zip(words.windows(2)) {
            let &[Some(first), Some(second)] = pair else { continue };
            if second.diameter.get() < first.diameter.get() {
                continue;
            }
            p.sink.push(
                Diag::error(codes::WRONG_TOOL, format!("the tools of operation {} do not get smaller", self.name))
                    .label(names[0].span, format!("{} in diameter", first.diameter))
                    .label(names[1].span, format!("{} in diameter", second.diameter))
                    .help(
                        "name the largest tool first: it finishes the middle of the floor, and each smaller one what is \
                         left beside it",
                    ),
            );
            holds = None;
        }
        let whole = Spacing::EqualDivision.name();
        if specs.len() > 1 && p.is_word(SPACING.name, whole) {
            let span = p.words(SPACING.name, "spacing constant-scallop")?.first()?.span;
            p.sink.push(
                Diag::error(codes::WRONG_FORM, format!("`spacing {whole}` of operation {} needs one tool", self.name))
                    .label(span, "it divides the whole floor from wall to wall")
                    .help("use `spacing constant-scallop`, or `tool` with one tool"),
            );
            holds = None;
        }
        holds
    }
}

/// What larger tools leave beside vanes and fillets.
fn allowance_vane(p: &mut Properties<'_, '_>) -> Option<Mm> {
    if !p.has(ALLOWANCE.name) {
        return Some(VANE);
    }
    let values = p.labelled(ALLOWANCE.name, &["vane"], "allowance vane 0.2 mm");
    let (_, expr) = values.first()?;
    p.value_of(expr, "allowance vane", Dimension::LENGTH, ALLOWANCES).map(Mm)
}
