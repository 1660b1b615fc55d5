//! V3: the simulated stock, operation by operation: the volume that each operation removes, the time of air cuts, and
//! the stock that shank, holder and rapids meet.

pub mod arcs;
mod cells;
mod load;
mod ramp;
mod removal;
mod report;
mod steps;
mod strokes;
mod turned;

pub use arcs::{ArcBound, ArcTimes, TimeAndPath};
pub use cells::{default_cell, memory, usual_cell};
pub use report::report;

use super::proof::piece::At;
use super::proof::turns::PartnerRounding;
use base::progress::{Progress, Work};
use base::units::{Deg, Kw, Mm, Mm3, Mm3PerSec, Sec, Share};
use diagnostics::{Diag, Sink, codes::verification};
use ir::{ContractKind, Motion, MotionOperation, MoveKind, Program};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use tool_stock::collide::ToolSolid;
use tool_stock::stock::{self, BlockCut, Field, FieldError, Outcome, Slices, Step, StepKind, Touched};

use arcs::{Circle, StepArc};
use removal::StepRemoval;
use steps::{StepPlace, StepValue, steps};
use turned::{Treatment, TurnedSteps};

/// Steps that are simulated between two reports of progress.
const STEPS_PER_REPORT: usize = 1 << 11;

/// Tip motion over which removal is averaged, in cells: the rays meet the chips of single steps by chance.
const WINDOW_CELLS: f64 = 4.0;

/// Arc of engagement from which a cutter counts as in full material, degrees. In a slot the arc is 180, but rays at the
/// distance of a cell seldom meet all of it.
pub(super) const MIN_FULL_ARC: f64 = 150.0;

/// Deepest slot that finishing may cut without being allowed by the job, as a share of the diameter. Makers of carbide end
/// mills give one diameter as the depth of a full slot; a finishing tool is slimmer, and no one plans a slot for it.
pub(super) const MAX_SLOT_DEPTH: f64 = 1.0;

/// Depth below the surface of the hub disc from which missing stock is reported, mm: more than any tolerance of
/// finishing, and more than the errors of ray ends and of chords of the profile.
const MIN_MISSING_DEPTH: f64 = 0.1;

/// The same depth where the job allows gouge.
const MIN_MISSING_DEPTH_WITH_GOUGE: f64 = 0.5;

/// Callback with the index of an operation in the motion and the stock after this operation.
pub type AfterOperation<'a> = &'a mut dyn FnMut(usize, &Field);

/// Settings of the stock simulation.
#[derive(Default)]
pub struct Settings<'a> {
    /// Edge of the cells, mm; `None` for [`default_cell`].
    pub cell: Option<f64>,
    /// Called after each operation.
    pub after: Option<AfterOperation<'a>>,
    /// Simulate each sector, also where it meets the same stock as another one, turned.
    pub each_sector: bool,
    /// By how much motions differ that count as the same, turned, in the proof and in the stock.
    pub rounding: PartnerRounding,
}

/// A largest value of a quantity with its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Peak<Q> {
    /// Value.
    pub value: Q,
    /// Move.
    pub at: At,
    /// Tool tip at this move, part frame, mm.
    pub tip: [f64; 3],
}

impl<Q> Peak<Q> {
    /// The peak with another form of its value.
    pub fn map<P>(self, form: impl FnOnce(Q) -> P) -> Peak<P> {
        Peak { value: form(self.value), at: self.at, tip: self.tip }
    }
}

impl Peak<Mm3PerSec> {
    /// The rate in mm3/min.
    pub fn by_minute(self) -> Peak<f64> {
        self.map(|rate| rate.by_minute().get())
    }
}

/// Depth of cut at full width that loads the cutter as much as a cut of another arc.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlotDepth {
    /// Sum over the heights of the share of the arc in 180 degrees.
    pub value: Mm,
    /// Extent along the tool axis.
    pub depth: Mm,
    /// Arc that the rays show at the height with the largest one.
    pub arc: Deg,
    /// Move.
    pub at: At,
    /// Tool tip at this move, part frame, mm.
    pub tip: [f64; 3],
}

/// Feed per tooth at the height over the tip at which it is largest: a tool that turns while it cuts is faster there than at
/// its tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToothFeed {
    /// Way of the axis of the tool at this height for each tooth.
    pub value: Mm,
    /// Height over the tip.
    pub height: Mm,
    /// Move.
    pub at: At,
    /// Tool tip at this move, part frame, mm.
    pub tip: [f64; 3],
}

/// Stock inside a part of the tool that must not touch it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StockCollision {
    /// `cutter at rapid`, `shank`, `holder`.
    pub part: Cow<'static, str>,
    /// Depth of the deepest place below the surface of this part of the tool.
    pub depth: Mm,
    /// The deepest place, part frame, mm.
    pub point: [f64; 3],
    /// Height of this place over the tip.
    pub height: Mm,
    /// Move.
    pub at: At,
}

/// Effect of an operation on the stock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OperationStock {
    /// Index of the operation in the motion.
    pub operation: u32,
    /// Name.
    pub name: String,
    /// Removed volume.
    pub removed: Mm3,
    /// Volume removed by link moves.
    pub by_links: Mm3,
    /// Largest removal rate of links, where they remove as much as a cut.
    #[serde(skip)]
    pub link: Option<Peak<Mm3PerSec>>,
    /// Largest removal rate of the moves at process feed alone.
    #[serde(skip)]
    pub cut_rate: Mm3PerSec,
    /// Stock after the operation.
    pub rest: Mm3,
    /// Time of all moves.
    pub time: Sec,
    /// Time in which nothing is removed.
    pub air: Sec,
    /// Time of the moves at feed, and time of their air cuts.
    pub feed: [Sec; 2],
    /// Time and path of the moves at feed over the arc of engagement.
    pub arcs: ArcTimes,
    /// Largest extent of removed material along the tool axis, without strokes along the axis.
    pub depth: Option<Peak<Mm>>,
    /// Largest extent across tip motion and axis; in a stroke along the axis from the rim towards the axis.
    pub width: Option<Peak<Mm>>,
    /// Largest arc of engagement of the circle of the cutter that the rays show.
    pub arc: Option<Peak<Deg>>,
    /// Largest upper bound of the arc.
    pub arc_bound: Option<ArcBound>,
    /// Largest upper bound of the arc outside of slots.
    pub arc_outside_slots: Option<ArcBound>,
    /// Largest removal rate, averaged over a tip motion of some cells.
    pub rate: Option<Peak<Mm3PerSec>>,
    /// Largest power at the cutter, over the same tip motion, where the job states the material.
    pub power: Option<Peak<Kw>>,
    /// Largest depth of cut at full width that loads the cutter as much: the sum over the heights of the share of the
    /// arc in half a turn.
    pub slot_depth: Option<SlotDepth>,
    /// Steepest angle against the plane of the end at which the tool goes down with material under its middle.
    pub ramp: Option<Peak<Deg>>,
    /// How far material reaches into the middle of the end, which has no teeth, in strokes along the axis.
    #[serde(skip)]
    pub middle: Option<Peak<Mm>>,
    /// Deepest slot of an operation of finishing, as a share of the diameter of its cutter: the sum of the heights at which the
    /// cutter is in full material, over an arc of 150 degrees.
    #[serde(skip)]
    pub slot: Option<Peak<Share>>,
    /// Largest feed per tooth where the cutter meets material.
    #[serde(skip)]
    pub chip: Option<ToothFeed>,
    /// Collisions, the deepest of each move and part of the tool.
    pub collisions: Vec<StockCollision>,
    /// Engagement in each move, for plots.
    #[serde(skip)]
    pub moves: Vec<Engagement>,
    /// For each move its feed as a share of the feed at which the removal rate reaches `max-rate` of the tool, or the power at
    /// the cutter that of the spindle. Empty where neither is limited.
    #[serde(skip)]
    pub removal: Vec<Share>,
}

/// Engagement of the cutter during a move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Engagement {
    /// Removal rate, averaged over a tip motion of some cells that ends with the move.
    pub rate: Mm3PerSec,
    /// Largest arc of the cutter's circle in the stock that the rays show.
    pub arc: Deg,
    /// Largest upper bound of this arc.
    pub arc_bound: Deg,
}

impl OperationStock {
    /// Share of the time of all moves in which nothing is removed.
    pub fn air_share(&self) -> f64 {
        air_share(self.air, self.time)
    }
}

/// Results of the stock simulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StockReport {
    /// Edge of the cells. Smaller features may be missed; ends of rays are exact to [`stock::END_ERROR`].
    pub cell: Mm,
    /// Number of rays.
    pub rays: usize,
    /// Share of the steps whose chips are those of an earlier step that meets the same stock, turned.
    #[serde(default, skip_serializing_if = "is_none")]
    pub turned: Share,
    /// Volume of the blank, or of what is left of it before the first operation.
    pub blank: Mm3,
    /// Operations in order.
    pub operations: Vec<OperationStock>,
    /// Missing stock inside of the hub disc, after the first operation that removes some.
    pub missing: Option<MissingStock>,
}

/// Stock that was removed inside of the finished part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MissingStock {
    /// Index of the operation in the motion.
    pub operation: u32,
    /// Missing volume deeper than 0.1 mm below the surface, 0.5 mm where the job allows gouge.
    pub volume: Mm3,
    /// A place of missing stock, part frame, mm.
    pub point: [f64; 3],
}

impl StockReport {
    /// All collisions.
    pub fn collisions(&self) -> impl Iterator<Item = &StockCollision> {
        self.operations.iter().flat_map(|o| &o.collisions)
    }

    /// Stock at the end.
    pub fn rest(&self) -> Mm3 {
        self.operations.last().map_or(self.blank, |o| o.rest)
    }

    /// Share of the time of all moves in which nothing is removed.
    pub fn air_share(&self) -> f64 {
        let sum = |time: fn(&OperationStock) -> Sec| self.operations.iter().map(time).sum();
        air_share(sum(|o| o.air), sum(|o| o.time))
    }
}

/// A share that a file leaves out.
fn is_none(share: &Share) -> bool {
    share.get() == 0.0
}

/// Time in which nothing is removed, as a share of a time.
fn air_share(air: Sec, time: Sec) -> f64 {
    if time.get() > 0.0 { air.get() / time.get() } else { 0.0 }
}

/// Simulates the stock over the whole program; `None` when the field cannot be made, with the reason in the sink, or when the run
/// was cancelled.
pub fn simulate(
    program: &Program,
    motion: &Motion,
    settings: &mut Settings<'_>,
    progress: &Progress,
    sink: &mut Sink,
) -> Option<StockReport> {
    let turned = if settings.each_sector {
        None
    } else {
        TurnedSteps::of(program, &all_steps(program, motion), settings.rounding)
    };
    let Some(turned) = turned else { return simulate_steps(program, motion, None, settings, progress, sink) };
    let mut without = Settings { cell: settings.cell, ..Settings::default() };
    let found = simulate_steps(program, motion, Some(&turned), &mut without, progress, sink)?;
    if found.missing.is_some() {
        // Missing stock is reported as a whole.
        return simulate_steps(program, motion, None, settings, progress, sink);
    }
    // The figures do not depend on who asks for the stock itself.
    if let Some(after) = &mut settings.after {
        cut_all(program, motion, found.cell, after, progress)?;
    }
    Some(found)
}

/// Cuts the stock in each sector for a caller that asks for it after each operation; `None` when the run was cancelled.
fn cut_all(
    program: &Program,
    motion: &Motion,
    cell: Mm,
    after: &mut AfterOperation<'_>,
    progress: &Progress,
) -> Option<()> {
    let mut field = program.stock.field(cell.get()).ok()?;
    for (o, operation) in motion.operations.iter().enumerate() {
        let declared = &program.operations[operation.operation];
        let work = progress.begin(format!("{}, stock for the outputs", declared.name), operation.moves.len());
        let solid = &program.tools[declared.tool].solid;
        let cutter = solid.cutter_alone(0.0);
        let before = |(place, _): &(StepPlace, Step)| (place.index as usize).saturating_sub(1);
        let cuts = steps(program, &operation.moves, solid.flute_length);
        work.in_pieces(cuts, STEPS_PER_REPORT, before, |piece| {
            let cuts = piece.into_iter().map(|(_, step)| step).filter(|step| step.kind != StepKind::Rapid);
            stock::cut(&mut field, &cutter, cuts);
        });
        if progress.is_cancelled() {
            return None;
        }
        after(o, &field);
    }
    Some(())
}

/// The steps of all operations with their tools.
fn all_steps<'a>(program: &'a Program, motion: &Motion) -> Vec<(Vec<Step>, &'a ToolSolid)> {
    let of = |operation: &MotionOperation| {
        let solid = &program.tools[program.operations[operation.operation].tool].solid;
        let steps: Vec<Step> = steps(program, &operation.moves, solid.flute_length).map(|(_, step)| step).collect();
        (steps, solid)
    };
    motion.operations.par_iter().map(of).collect()
}

/// Simulates the operations; of turned steps only those that have to be.
fn simulate_steps(
    program: &Program,
    motion: &Motion,
    turned: Option<&TurnedSteps>,
    settings: &mut Settings<'_>,
    progress: &Progress,
    sink: &mut Sink,
) -> Option<StockReport> {
    let cell = settings.cell.unwrap_or_else(|| default_cell(program));
    let mut field = match program.stock.field(cell) {
        Ok(field) => field,
        Err(error) => {
            sink.push(refusal(error, cell));
            return None;
        }
    };
    let blank = field.volume();
    let mut before = blank;
    let mut operations = Vec::new();
    let mut missing = None;
    let below = below_surface(program);
    let disc = hub_disc(program, below);
    let start = program.stock.left.is_some().then(|| field.clone());
    for (o, operation) in motion.operations.iter().enumerate() {
        if progress.is_cancelled() {
            return None;
        }
        let name = format!("{}, stock", program.operations[operation.operation].name);
        let work = progress.begin(name, operation.moves.len().saturating_sub(1));
        let milled = Milled::new(program, operation, o, turned, &mut field, &work);
        let mut report = milled.report(program, operation, field.cell());
        drop(work);
        // Without some of the cuts the stock itself has too much.
        let rest = if turned.is_some() { before - milled.volume() } else { field.volume() };
        (report.rest, report.removed) = (Mm3(rest), Mm3(before - rest));
        before = rest;
        if missing.is_none() {
            let uncut = field.uncut_under(&disc, below, start.as_ref());
            missing = uncut.map(|uncut| MissingStock {
                operation: report.operation,
                volume: Mm3(uncut.volume),
                point: uncut.point.coords.into(),
            });
        }
        operations.push(report);
        if let Some(after) = &mut settings.after {
            after(o, &field);
        }
    }
    let (cell, rays) = (Mm(field.cell()), field.rays());
    let turned = turned.map_or(Share(0.0), TurnedSteps::share);
    Some(StockReport { cell, rays, turned, blank: Mm3(blank), operations, missing })
}

/// Depth below the surface of the hub disc from which missing stock is reported, mm.
fn below_surface(program: &Program) -> f64 {
    let allowed = program.allowed.iter().any(|a| a.kind == ContractKind::Gouge);
    if allowed { MIN_MISSING_DEPTH_WITH_GOUGE } else { MIN_MISSING_DEPTH }
}

/// Profile of the part below the hub, reduced by `below`: no operation may remove any of it.
fn hub_disc(program: &Program, below: f64) -> Vec<[f64; 2]> {
    /// Chords of the hub: within a micrometre of a meridian with radii of curvature of centimetres.
    const HUB_CHORDS: usize = 400;
    let (stock, hub) = (&program.stock, &program.part.hub);
    let (bore, back) = (stock.bore_radius.get(), stock.back.get() + below);
    // Without a bore the body extends to the axis.
    let inner = if bore > 0.0 { bore + below } else { 0.0 };
    let outer = stock.profile.last().map_or(0.0, |p| p[0]) - below;
    let front = hub.meridian(0.0).point.y - below;
    let mut profile = vec![[inner, back], [inner, front]];
    for i in 0..=HUB_CHORDS {
        let u = i as f64 / HUB_CHORDS as f64;
        let p = hub.meridian(u).point - hub.meridian_normal(u) * below;
        if (inner..=outer).contains(&p.x) && (back..=front).contains(&p.y) {
            profile.push([p.x, p.y]);
        }
    }
    let end = profile.last().map_or(back, |p| p[1]);
    profile.extend([[outer, end], [outer, back]]);
    profile
}

/// Result of the stock simulation for an operation, with its steps.
struct Milled {
    /// Index of the operation in the motion.
    operation: u32,
    /// Places of the steps. The simulation treats each step as a block of its own, since moves may be long.
    places: Vec<StepPlace>,
    outcome: Outcome,
}

impl Milled {
    /// Simulates the steps of an operation, batch by batch.
    fn new(
        program: &Program,
        operation: &MotionOperation,
        o: usize,
        turned: Option<&TurnedSteps>,
        field: &mut Field,
        work: &Work,
    ) -> Self {
        let solid = &program.tools[program.operations[operation.operation].tool].solid;
        let cutter = solid.cutter_alone(0.0);
        let mut places: Vec<StepPlace> = Vec::new();
        let mut outcome = Outcome::default();
        let stream = steps(program, &operation.moves, solid.flute_length);
        let before = |(place, _): &(StepPlace, Step)| (place.index as usize).saturating_sub(1);
        let mut treatments = turned.map(|turned| turned.treatments(o));
        work.in_pieces(stream, STEPS_PER_REPORT, before, |piece| {
            let first = places.len();
            let mut steps = Vec::with_capacity(piece.len());
            for (n, (place, step)) in piece.into_iter().enumerate() {
                let treatment = treatments.as_mut().and_then(Iterator::next).unwrap_or(Treatment::Measured);
                steps.push((treatment, Step { block: u32::try_from(first + n).unwrap_or(u32::MAX), ..step }));
                places.push(place);
            }
            for alike in steps.chunk_by(|a, b| a.0 == b.0) {
                let steps = alike.iter().map(|(_, step)| *step);
                match alike[0].0 {
                    Treatment::Measured => {
                        let made = stock::simulate(field, solid, steps);
                        outcome.cuts.extend(made.cuts);
                        outcome.collisions.extend(made.collisions);
                    }
                    Treatment::Cut => stock::cut(field, &cutter, steps),
                    Treatment::Left => {}
                }
            }
        });
        if let Some(turned) = turned {
            turned.complete(o, &mut outcome);
        }
        Self { operation: u32::try_from(o).unwrap_or(u32::MAX), places, outcome }
    }

    /// Removed volume, mm3.
    fn volume(&self) -> f64 {
        self.outcome.cuts.iter().map(|c| c.volume).sum()
    }

    /// The move of a step.
    fn at(&self, step: u32) -> At {
        At { operation: self.operation, index: self.places.get(step as usize).map_or(0, |p| p.index) }
    }

    /// A value with the place of its step.
    fn peak_at<Q: From<f64>>(&self, StepValue { value, step }: StepValue) -> Option<Peak<Q>> {
        let tip = self.places.get(step as usize)?.tip;
        Some(Peak { value: Q::from(value), at: self.at(step), tip: [tip.x, tip.y, tip.z] })
    }

    /// The largest value over all steps that remove material.
    fn peak<Q: From<f64>>(&self, value: &dyn Fn(&BlockCut) -> f64) -> Option<Peak<Q>> {
        let cuts = self.outcome.cuts.iter().filter(|c| c.height[0] <= c.height[1]);
        let c = cuts.max_by(|a, b| value(a).total_cmp(&value(b)))?;
        self.peak_at(StepValue { value: value(c), step: c.block })
    }

    /// The largest depth at full width that loads the cutter as much as a step.
    fn slot_depth(&self, arcs: &[StepArc]) -> Option<SlotDepth> {
        let cuts = self.outcome.cuts.iter().filter(|c| c.height[0] <= c.height[1] && c.lune.is_none());
        let loads = cuts.filter_map(|c| {
            let arc = arcs.get(c.block as usize)?;
            Some((arc.load, arc.depth, arc.found, c.block))
        });
        let (value, depth, arc, step) = loads.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let Peak { value, at, tip } = self.peak_at(StepValue { value, step })?;
        Some(SlotDepth { value, depth: Mm(depth), arc: Deg(arc), at, tip })
    }

    /// The largest feed per tooth of the cuts that remove material, where they do, at `teeth` each minute.
    fn chip(&self, removal: &StepRemoval, teeth: f64) -> Option<ToothFeed> {
        let cuts = self.outcome.cuts.iter().filter(|c| c.height[0] <= c.height[1]);
        let feeds = cuts.flat_map(|c| {
            let place = self.places.get(c.block as usize);
            let cuts = removal.cuts.get(c.block as usize).is_some_and(|cuts| *cuts);
            let place = place.filter(|p| cuts && p.kind == MoveKind::Cut && p.time > 0.0);
            place.map(|p| c.height.map(|h| (p.way_at(h) / p.time * 60.0 / teeth, h, c.block)))
        });
        let (value, height, step) = feeds.flatten().max_by(|a, b| a.0.total_cmp(&b.0))?;
        let Peak { value, at, tip } = self.peak_at(StepValue { value, step })?;
        Some(ToothFeed { value, height: Mm(height), at, tip })
    }

    /// The largest upper bound of the arc over the chosen steps.
    fn arc_bound(&self, arcs: &[StepArc], choose: impl Fn(&StepArc) -> bool) -> Option<ArcBound> {
        let steps = (0_u32..).zip(arcs).filter(|(_, a)| a.bound > 0.0 && choose(a));
        let (step, most) = steps.max_by(|a, b| a.1.bound.total_cmp(&b.1.bound))?;
        let Peak { value, at, tip } = self.peak_at(StepValue { value: most.bound, step })?;
        Some(ArcBound { value, found: Deg(most.found), at, tip })
    }

    /// Time of the chosen steps; `choose` gets index and place of a step.
    fn time(&self, choose: &dyn Fn(usize, &StepPlace) -> bool) -> Sec {
        self.places.iter().enumerate().filter(|(i, p)| choose(*i, p)).map(|(_, p)| Sec(p.time)).sum()
    }

    /// Volume removed by link moves.
    fn by_links(&self) -> Mm3 {
        let place = |c: &BlockCut| self.places.get(c.block as usize);
        let links = self.outcome.cuts.iter().filter(|c| place(c).is_some_and(|p| p.kind == MoveKind::Link));
        // Without this start, the sum of an empty list is -0.
        Mm3(links.map(|c| c.volume).fold(0.0, |sum, v| sum + v))
    }

    /// Collisions, the deepest of each move and part of the tool.
    fn collisions(&self) -> Vec<StockCollision> {
        let mut collisions: Vec<StockCollision> = Vec::new();
        for c in &self.outcome.collisions {
            let part = match c.what {
                Touched::Cutter => "cutter at rapid",
                Touched::Shank => "shank",
                Touched::Holder => "holder",
            };
            let (point, at) = (c.point.coords.into(), self.at(c.block));
            let found = StockCollision { part: part.into(), depth: Mm(c.depth), point, height: Mm(c.height), at };
            let same = collisions.iter_mut().rev().take_while(|x| x.at == found.at).find(|x| x.part == part);
            match same {
                Some(x) if x.depth < found.depth => *x = found,
                Some(_) => {}
                None => collisions.push(found),
            }
        }
        collisions
    }
}

impl Milled {
    /// Effect of the operation on a stock with these cells, mm; the caller adds the volumes of the whole stock.
    fn report(&self, program: &Program, operation: &MotionOperation, cell: f64) -> OperationStock {
        let milled = self;
        let Milled { places, outcome, .. } = milled;
        let window = WINDOW_CELLS * cell;
        let removal = StepRemoval::new(places, &outcome.cuts, window);
        let declared = &program.operations[operation.operation];
        let solid = &program.tools[declared.tool].solid;
        let radius = solid.cutter.widest_below(solid.flute_length);
        let slices = Slices::new(solid.flute_length, cell);
        let circle = Circle { radius, cell, window, slices };
        let arcs = arcs::of_steps(places, &removal, &outcome.cuts, &circle);
        let arc = |c: &BlockCut| arcs.get(c.block as usize).map_or(0.0, |a| a.found);
        // A stroke along the axis has no depth: its chips are as long as its way.
        let depth = |c: &BlockCut| if c.lune.is_none() { c.height[1] - c.height[0] } else { 0.0 };
        let width = |c: &BlockCut| {
            let [from, to] = c.sides.over(0..=stock::SLICES - 1);
            c.lune.as_ref().map_or(to - from, |lune| (radius - lune.inner()).max(0.0))
        };
        let diameter = 2.0 * solid.cutter.nominal_radius();
        let slot = |c: &BlockCut| match c.lune {
            None => arcs.get(c.block as usize).map_or(0.0, |a| a.full_depth / diameter),
            Some(_) => 0.0,
        };
        let link = removal::fastest_link(places, &outcome.cuts, window);
        let at_feed = |p: &StepPlace| p.kind != MoveKind::Rapid;
        OperationStock {
            operation: milled.operation,
            name: declared.name.clone(),
            removed: Mm3(0.0),
            by_links: milled.by_links(),
            link: link.and_then(|link| milled.peak_at(link)),
            cut_rate: Mm3PerSec(removal::cut_rate(places, &outcome.cuts, window)),
            rest: Mm3(0.0),
            time: milled.time(&|_, _| true),
            air: milled.time(&|i, _| !removal.cuts[i]),
            feed: [milled.time(&|_, p| at_feed(p)), milled.time(&|i, p| at_feed(p) && !removal.cuts[i])],
            arcs: ArcTimes::new(places, &removal, &arcs),
            depth: milled.peak(&depth).filter(|p: &Peak<Mm>| p.value.get() > 0.0),
            width: milled.peak(&|c| width(c)),
            arc: milled.peak(&arc),
            arc_bound: milled.arc_bound(&arcs, |_| true),
            arc_outside_slots: milled.arc_bound(&arcs, |a| !a.slot),
            slot_depth: milled.slot_depth(&arcs),
            ramp: ramp::steepest(&program.tools[declared.tool], places, &outcome.cuts)
                .and_then(|found| milled.peak_at(found)),
            middle: strokes::deepest(&program.tools[declared.tool], places, &outcome.cuts)
                .and_then(|found| milled.peak_at(found)),
            slot: milled.peak(&slot).filter(|p: &Peak<Share>| p.value.get() > 0.0 && declared.kind.finishes()),
            rate: removal.rate.and_then(|rate| milled.peak_at(rate)),
            power: removal::power(program, declared, &removal).and_then(|power| milled.peak_at(power)),
            chip: milled.chip(&removal, declared.speed.get() * f64::from(program.tools[declared.tool].flutes)),
            collisions: milled.collisions(),
            moves: engagement(operation.moves.len(), places, &removal, &arcs),
            removal: removal.shares(program, declared, places, window, operation.moves.len()),
        }
    }
}

/// Engagement of the moves, from the engagement of their steps.
fn engagement(count: usize, places: &[StepPlace], removal: &StepRemoval, arcs: &[StepArc]) -> Vec<Engagement> {
    let mut moves = vec![Engagement::default(); count];
    let mut times = vec![0.0; count];
    for (p, rate) in places.iter().zip(&removal.rates) {
        for (m, time) in moves[p.moves()].iter_mut().zip(&mut times[p.moves()]) {
            m.rate += Mm3PerSec(rate * p.time);
            *time += p.time;
        }
    }
    for (m, time) in moves.iter_mut().zip(times) {
        m.rate = Mm3PerSec(if time > 0.0 { m.rate.get() / time } else { 0.0 });
    }
    for (p, arc) in places.iter().zip(arcs) {
        for m in &mut moves[p.moves()] {
            m.arc = Deg(m.arc.get().max(arc.found));
            m.arc_bound = Deg(m.arc_bound.get().max(arc.bound));
        }
    }
    moves
}

fn refusal(error: FieldError, cell: f64) -> Diag {
    let (text, help) = match error {
        FieldError::BadCell => (
            format!("the stock cannot have cells of {cell} mm"),
            format!("give `--stock-cell` a length above zero, such as {}", cells::MAX_CELL),
        ),
        FieldError::BadProfile => (
            "the stock has no inside".to_owned(),
            "check the declaration of the stock: its surface must enclose a volume".to_owned(),
        ),
        FieldError::Crowded => (
            "the file of the stock has too many surfaces behind one another".to_owned(),
            "give the closed surface of one workpiece, without inner shells".to_owned(),
        ),
        FieldError::TooFine { rays, least_cell } => (
            format!("cells of {cell} mm need {rays:.1e} rays through the stock, more than fit into memory"),
            format!("use `--stock-cell {:.3}` or more", (least_cell * 1e3).ceil() / 1e3),
        ),
    };
    Diag::error(verification::STOCK_CELL, text).help(help)
}
