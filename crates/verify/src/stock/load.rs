//! Feed against spindle speed and engagement: chips that are too thick for the tool, finishing in full material, links
//! that cut.
//!
//! Findings are errors where the tool breaks, otherwise remarks. The limits come from the tool and the job.

use super::cells::{cell_of, default_cell};
use super::strokes::MAX_RUBBING_DEPTH;
use super::{MAX_SLOT_DEPTH, MIN_FULL_ARC, OperationStock};
use crate::place::describe;
use crate::proof::piece::At;
use base::units::{Mm3PerSec, MmPerMin, Rpm, Share, length, trim};
use diagnostics::{Diag, Sink, codes::verification};
use ir::{Allowed, ContractKind, Motion, MotionOperation, MoveKind, Operation, OperationId, Program, Tool};
use nalgebra::Point3;
use std::collections::BTreeSet;
use tool_stock::stock::lune::RIDGE;

/// Depth of a slot from which finishing in full material gives a remark, as a share of the diameter of the cutter.
const SLOT_REMARK_DEPTH: f64 = 0.25;

/// Excess over the largest chip or the largest angle of a ramp that rounding may add, as a share.
const LOAD_ROUNDING: f64 = 1e-3;

/// Findings of one operation, with the cells of the stock, mm.
pub(super) fn report(program: &Program, motion: &Motion, o: &OperationStock, cell: f64, sink: &mut Sink) {
    report_chip(program, motion, o, sink);
    let mut of_stock = Sink::default();
    report_full(program, motion, o, &mut of_stock);
    report_depth(program, motion, o, &mut of_stock);
    report_removal(program, motion, o, &mut of_stock);
    report_middle(program, motion, o, &mut of_stock);
    report_ramp(program, motion, o, &mut of_stock);
    let operation = motion.operations.get(o.operation as usize);
    let fine = operation.map_or(f64::INFINITY, |operation| cell_of(program, operation.operation));
    // Cells of a field are a little smaller or larger than required.
    if cell > fine * (1.0 + MAX_CELL_EXCESS) {
        // The default shows what the cutters of all operations do.
        let fine = default_cell(program);
        of_stock.change_all(|diag| with_cells(diag, cell, fine));
    }
    of_stock.diags().iter().cloned().for_each(|diag| sink.push(diag));
    report_link(program, motion, o, sink);
}

/// Share by which cells may be larger than those that show the engagement of a cutter.
const MAX_CELL_EXCESS: f64 = 0.05;

/// Says of a finding that the cells of the stock are too coarse for it.
fn with_cells(mut diag: Diag, cell: f64, fine: f64) -> Diag {
    // Rounded down: the size must be fine enough.
    let works = trim((fine * 1e3).floor() / 1e3, 3);
    let help = diag.help.take().unwrap_or_default();
    diag.note(format!(
        "the stock has cells of {} mm, too coarse for this cutter: material that is gone can still count; cells of {works} mm \
         show it",
        trim(cell, 4)
    ))
    .help(format!("compile again with `--stock-cell {works}`, or without this option; if the finding remains, {help}"))
}

/// Finding on material in the middle of the end, which has no teeth, of a tool that goes down along its axis.
fn report_middle(program: &Program, motion: &Motion, o: &OperationStock, sink: &mut Sink) {
    let found = o.middle.filter(|middle| middle.value.get() > MAX_RUBBING_DEPTH);
    let Some((middle, operation)) = found.zip(motion.operations.get(o.operation as usize)) else { return };
    let declared = &program.operations[operation.operation];
    let tool = &program.tools[declared.tool];
    let across = 2.0 * tool.toothless_radius().unwrap_or(0.0);
    sink.push(
        Diag::error(
            verification::TOOL_LOAD,
            format!(
                "{} goes down along its axis with material {} inside of the middle of its end",
                tool.name,
                length(middle.value.get())
            ),
        )
        .label(declared.span, "in this operation")
        .label(tool.span, format!("its teeth leave {} in the middle of the end", length(across)))
        .place(describe(program, motion, Some(middle.at)), Point3::from(middle.tip))
        .block(middle.at.operation, middle.at.index)
        .note(format!("layers of less than {} on the floor do not count", length(RIDGE)))
        .help(
            "enter from beside the stock, use a smaller `stepover`, or state `plunge-width` of a tool that cuts at its centre",
        ),
    );
}

/// Finding on a way down with material under the middle of the end that is steeper than the tool permits. The default is an
/// estimate from the form of an end, so that only a stated angle is a limit.
fn report_ramp(program: &Program, motion: &Motion, o: &OperationStock, sink: &mut Sink) {
    let Some((ramp, operation)) = o.ramp.zip(motion.operations.get(o.operation as usize)) else { return };
    let declared = &program.operations[operation.operation];
    let tool = &program.tools[declared.tool];
    let limit = tool.ramp.deg();
    if ramp.value.get() <= limit * (1.0 + LOAD_ROUNDING) {
        return;
    }
    let new = if tool.ramp_stated { Diag::error } else { Diag::remark };
    let (limits, names) = match tool.ramp_stated {
        true => ("its limit", "`ramp` of this tool"),
        false => ("the default for its end", "`ramp` of this tool would be a limit"),
    };
    sink.push(
        new(
            verification::TOOL_LOAD,
            format!(
                "{} goes down at {} deg with material under the middle of its end; {limits} is {} deg",
                tool.name,
                trim(ramp.value.get(), 2),
                trim(limit, 2)
            ),
        )
        .label(declared.span, "in this operation")
        .label(tool.span, names)
        .place(describe(program, motion, Some(ramp.at)), Point3::from(ramp.tip))
        .block(ramp.at.operation, ramp.at.index)
        .note("the angle is that against the plane square to the tool axis, over the width of the middle")
        .help(
            "use a ball or another tool that cuts at its centre, levels or tool axes along which the tool goes down less, \
             or, where the maker of the tool allows it, `ramp` or `plunge-width` of the tool",
        ),
    );
}

/// Finding on the link with the largest removal.
fn report_link(program: &Program, motion: &Motion, o: &OperationStock, sink: &mut Sink) {
    let Some((link, operation)) = o.link.zip(motion.operations.get(o.operation as usize)) else { return };
    let declared = &program.operations[operation.operation];
    let tool = &program.tools[declared.tool];
    let most = o.cut_rate;
    let feed = operation.moves.get(link.at.index as usize).and_then(|m| m.feed).unwrap_or_default();
    let chip = feed / declared.speed.get().max(0.0) / f64::from(tool.flutes);
    let rate = |r: Mm3PerSec| format!("{:.1} mm3/min", r.by_minute().get());
    let removes = format!("at link feed the cutter removes {}", rate(link.value));
    let (harms, text) = if link.value > most {
        (true, format!("{removes}; the largest removal rate of its cuts is {}", rate(most)))
    } else {
        (chip > tool.max_chip.get(), format!("{removes}, with a feed per tooth of {}", length(chip)))
    };
    let new = if harms { Diag::error } else { Diag::remark };
    sink.push(
        new(verification::LINK_CUTS, text)
            .label(declared.span, "in this operation")
            .place(describe(program, motion, Some(link.at)), Point3::from(link.tip))
            .block(link.at.operation, link.at.index)
            .note("a move at feed above `feed` of the operation is a link")
            .help(opened(program, declared).unwrap_or_else(|| {
                "use the process feed in this block, or leads that begin and end outside the stock".to_owned()
            })),
    );
}

/// Finding on a depth of cut over the limit of the tool, or over its diameter where only a stated limit permits it.
fn report_depth(program: &Program, motion: &Motion, o: &OperationStock, sink: &mut Sink) {
    let Some((cut, operation)) = o.slot_depth.zip(motion.operations.get(o.operation as usize)) else { return };
    let declared = &program.operations[operation.operation];
    let tool = &program.tools[declared.tool];
    let limit = tool.max_depth.get();
    let over = cut.value.get() > limit;
    // A slot of finishing that is deeper than the diameter has its own finding.
    let found = o.slot.is_some_and(|p| p.value.get() > MAX_SLOT_DEPTH);
    if !over && (found || cut.value.get() <= 2.0 * MAX_SLOT_DEPTH * tool.solid.cutter.nominal_radius()) {
        return;
    }
    let new = if over { Diag::error } else { Diag::remark };
    let text = format!(
        "{} cuts {} deep over arcs of up to {:.0} deg, which loads it as a slot {} deep, {}; its limit is {}",
        tool.name,
        length(cut.depth.get()),
        cut.arc.get(),
        length(cut.value.get()),
        share(tool, cut.value.get()),
        length(limit)
    );
    sink.push(
        new(verification::TOOL_LOAD, text)
            .label(declared.span, "in this operation")
            .label(tool.span, "`max-depth` of this tool")
            .place(describe(program, motion, Some(cut.at)), Point3::from(cut.tip))
            .block(cut.at.operation, cut.at.index)
            .note("the load is the sum over the depth of the share of the arc in 180 deg")
            .help(
                if over {
                    "use a smaller `depth` or `stepover`, an operation before it that leaves less stock, a stiffer tool, or, \
                     where the maker of the tool allows it, `max-depth` of the tool"
                } else {
                    "compare the stated `max-depth` with the data of the maker of the tool: it alone permits this cut"
                },
            ),
    );
}

/// Findings on more chips than the tool or the spindle takes.
fn report_removal(program: &Program, motion: &Motion, o: &OperationStock, sink: &mut Sink) {
    let Some(operation) = motion.operations.get(o.operation as usize) else { return };
    let declared = &program.operations[operation.operation];
    let tool = &program.tools[declared.tool];
    let slower = feed_within(operation, &o.removal);
    let mut find = |at: At, tip: [f64; 3], text: String, limit: String| {
        sink.push(
            Diag::error(verification::TOOL_LOAD, text)
                .label(declared.span, "in this operation")
                .place(describe(program, motion, Some(at)), Point3::from(tip))
                .block(at.operation, at.index)
                .note(limit)
                .help(slower.map_or_else(
                    || "use a lower feed in this block, or a smaller `depth` or `stepover`".to_owned(),
                    |feed| {
                        format!("use a feed of at most {feed} in this operation, or a smaller `depth` or `stepover`")
                    },
                )),
        );
    };
    let rate = o.rate.zip(tool.max_rate).filter(|(found, limit)| found.value.by_minute() > *limit);
    if let Some((found, limit)) = rate {
        let text = format!("{} removes {} mm3/min", tool.name, trim(found.value.by_minute().get(), 0));
        find(found.at, found.tip, text, format!("`max-rate` of the tool is {limit}"));
    }
    let power = o.power.zip(program.machine.power).filter(|(found, limit)| found.value.get() > *limit);
    if let Some((found, limit)) = power {
        let text = format!("{} needs {} kW at the cutter", tool.name, trim(found.value.get(), 2));
        find(found.at, found.tip, text, format!("the spindle of the machine has {} kW", trim(limit, 2)));
    }
}

/// Share of the limit that a feed in a message leaves: the stock is cut in steps, whose places depend on the feed.
const USED_FEED_SHARE: f64 = 0.95;

/// A feed, in whole mm/min, with which no cut removes more than tool and spindle take. `shares` has the feed of each move as a share of
/// the feed at which one of them reaches its limit.
fn feed_within(operation: &MotionOperation, shares: &[Share]) -> Option<MmPerMin> {
    let over = operation
        .moves
        .iter()
        .zip(shares)
        .filter(|(m, share)| m.kind == MoveKind::Cut && share.get() > USED_FEED_SHARE);
    let least = over.filter_map(|(m, share)| Some(USED_FEED_SHARE * m.feed? / share.get())).reduce(f64::min)?;
    (least >= 1.0).then(|| MmPerMin(least.floor()))
}

/// Feed per tooth of the fastest cut of an operation, mm, with its move; infinite where the spindle stands.
fn thickest_chip(declared: &Operation, operation: &MotionOperation) -> Option<(f64, usize)> {
    let cuts = operation.moves.iter().enumerate().filter(|(_, m)| m.kind == MoveKind::Cut);
    let fastest = cuts.filter_map(|(i, m)| Some((m.feed?, i))).max_by(|a, b| a.0.total_cmp(&b.0));
    fastest.map(|(feed, i)| (feed / declared.speed.get().max(0.0), i))
}

/// Finding on feed against spindle speed: chips that break the tool.
fn report_chip(program: &Program, motion: &Motion, o: &OperationStock, sink: &mut Sink) {
    let Some(operation) = motion.operations.get(o.operation as usize) else { return };
    let declared = &program.operations[operation.operation];
    let tool = &program.tools[declared.tool];
    let limit = tool.max_chip.get() * (1.0 + LOAD_ROUNDING);
    let chip = thickest_chip(declared, operation).map(|(turn, i)| (turn / f64::from(tool.flutes), i));
    let Some((chip, index)) = chip.filter(|(chip, _)| *chip > limit) else {
        return report_turned_chip(program, motion, o, limit, sink);
    };
    let text = match chip.is_finite() {
        true => format!("the feed per tooth of {} is {}, {}", tool.name, length(chip), share(tool, chip)),
        false => format!("{} cuts with a spindle that stands still", tool.name),
    };
    let tip = operation.moves.get(index).map(|m| program.machine.forward(&m.joints).tip).unwrap_or_default();
    let at = At { operation: o.operation, index: u32::try_from(index).unwrap_or(u32::MAX) };
    sink.push(
        Diag::error(verification::TOOL_LOAD, text)
            .label(declared.span, "in this operation")
            .place(describe(program, motion, Some(at)), tip)
            .block(at.operation, at.index)
            .note(format!("the limit of the tool is {}", length(tool.max_chip.get())))
            .help(thinner(program, declared, chip)),
    );
}

/// Finding on a tool that turns so fast while it cuts that its chips are too thick above the tip, where the feed of the tip
/// is not.
fn report_turned_chip(program: &Program, motion: &Motion, o: &OperationStock, limit: f64, sink: &mut Sink) {
    let Some((chip, operation)) = o.chip.zip(motion.operations.get(o.operation as usize)) else { return };
    if chip.value.get() <= limit {
        return;
    }
    let declared = &program.operations[operation.operation];
    let tool = &program.tools[declared.tool];
    let feed = operation.moves.get(chip.at.index as usize).and_then(|m| m.feed).unwrap_or_default();
    let slower = MmPerMin((feed * tool.max_chip.get() / chip.value.get()).floor());
    sink.push(
        Diag::error(
            verification::TOOL_LOAD,
            format!(
                "{} turns while it cuts: {} over the tip its feed per tooth is {}, {}",
                tool.name,
                length(chip.height.get()),
                length(chip.value.get()),
                share(tool, chip.value.get())
            ),
        )
        .label(declared.span, "in this operation")
        .place(describe(program, motion, Some(chip.at)), Point3::from(chip.tip))
        .block(chip.at.operation, chip.at.index)
        .note(format!("the limit of the tool is {}", length(tool.max_chip.get())))
        .help(match slower.get() >= 1.0 {
            true => format!("use a feed of at most {slower} in this block, or a higher `speed`"),
            false => "turn the tool over a longer way, or use a higher `speed`".to_owned(),
        }),
    );
}

/// The remedy for a chip: the feed and the spindle speed that keep the limit of the tool, rounded to whole numbers.
fn thinner(program: &Program, declared: &Operation, chip: f64) -> String {
    let tool = &program.tools[declared.tool];
    let limit = tool.max_chip.get();
    let feed = MmPerMin((limit * declared.speed.get() * f64::from(tool.flutes)).floor());
    let speed = Rpm((declared.speed.get() * chip / limit).ceil());
    let fast = speed.get() <= program.machine.spindle[1];
    match (feed.get() >= 1.0, speed.get().is_finite() && fast) {
        (true, true) => format!("use a feed of at most {feed}, or a spindle speed of at least {speed}"),
        (true, false) => {
            format!("use a feed of at most {feed}; the spindle of the machine cannot turn fast enough for this one")
        }
        (false, _) => "use a lower `feed`, or a higher `speed`".to_owned(),
    }
}

/// A length against the diameter of the cutter.
fn share(tool: &Tool, mm: f64) -> String {
    let diameter = 2.0 * tool.solid.cutter.nominal_radius();
    format!("{:.1} % of the diameter of {diameter:.3} mm", 100.0 * mm / diameter)
}

/// Finding on finishing in full material. A slot deeper than the diameter is an error, unless the job allows it by name.
fn report_full(program: &Program, motion: &Motion, o: &OperationStock, sink: &mut Sink) {
    let found = o.slot.filter(|p| p.value.get() > SLOT_REMARK_DEPTH);
    let Some((full, operation)) = found.zip(motion.operations.get(o.operation as usize)) else { return };
    let declared = &program.operations[operation.operation];
    let tool = &program.tools[declared.tool];
    let deep = full.value.get() > MAX_SLOT_DEPTH;
    let allowed = program.allowed.iter().find(|a| allows_slot(a, operation.operation)).filter(|_| deep);
    let new = if deep && allowed.is_none() { Diag::error } else { Diag::remark };
    let depth = full.value.get() * 2.0 * tool.solid.cutter.nominal_radius();
    let text = format!(
        "finishing cuts in full material: a slot of {} that is {} deep, {}",
        tool.name,
        length(depth),
        share(tool, depth)
    );
    let chip = thickest_chip(declared, operation).map(|(turn, _)| turn / f64::from(tool.flutes));
    let chip = chip.map_or_else(String::new, |chip| format!("; feed per tooth up to {}", length(chip)));
    let mut diag = new(verification::TOOL_LOAD, text)
        .label(declared.span, "in this operation")
        .place(describe(program, motion, Some(full.at)), Point3::from(full.tip))
        .block(full.at.operation, full.at.index)
        .note(format!(
            "engaged over at least {MIN_FULL_ARC:.0} deg, over more than {:.0} % of the diameter{chip}",
            100.0 * if deep { MAX_SLOT_DEPTH } else { SLOT_REMARK_DEPTH }
        ));
    diag = match allowed {
        Some(a) => diag.label(a.span, "allowed here"),
        None => diag,
    };
    let rough = opened(program, declared).unwrap_or_else(|| {
        "use roughing that leaves less stock there: one more `expand`, a smaller `residual`, or a `rough` before it"
            .to_owned()
    });
    let name = &declared.name;
    sink.push(diag.help(match deep && allowed.is_none() {
        true => format!("{rough}; where the tool can take it, allow it with a reason: `allow slot on {name} \"...\"`"),
        false => rough,
    }));
}

/// Whether the job allows deep slots in an operation.
fn allows_slot(allowed: &Allowed, operation: OperationId) -> bool {
    allowed.kind == ContractKind::Slot
        && (allowed.scope.operations.is_empty() || allowed.scope.operations.contains(&operation))
}

/// The remedy where roughing leaves channels full that a finishing operation enters: the sectors to rough.
fn opened(program: &Program, declared: &Operation) -> Option<String> {
    let (first, full) = program.sectors_left_full(declared)?;
    let all: BTreeSet<u32> = first.sectors.iter().copied().chain(full).collect();
    let all: Vec<String> = all.iter().map(|k| (k + 1).to_string()).collect();
    let (name, all) = (&first.name, all.join(", "));
    Some(format!("rough all channels beside the vanes that `{}` finishes: `sectors {all}` in `{name}`", declared.name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_cells_are_reported_with_the_size_that_works() {
        let diag = Diag::error(verification::TOOL_LOAD, "a slot").help("use a smaller `depth`");
        let diag = with_cells(diag, 1.0, 0.3756);
        assert!(diag.notes[0].contains("cells of 1 mm") && diag.notes[0].contains("cells of 0.375 mm"), "{diag:?}");
        let help = diag.help.unwrap();
        assert!(help.contains("`--stock-cell 0.375`") && help.ends_with("use a smaller `depth`"), "{help}");
    }
}
