//! Roughing passes against the stock that they find, one after the other.
//!
//! Before: the passes of a `rough` operation in all sectors. After: passes that cut, from the first contact with the
//! stock to the last, with their leads. On leads and between two cuts the tool runs through air at link feed. Where the
//! tool reaches the start of a pass from the end of the pass before on straight paths through air, clear of the part, the
//! pass has this link.
//!
//! After rest machining a pass keeps only the intervals in which more than the thickness of the job is left. Where air is far
//! from the end of an interval, the tool ramps in from above or beside the pass.
//!
//! A tool comes down along its axis to the start of a pass. Where the middle of its end has no teeth, the start lies where
//! the middle finds no material: outside of the blank, or where the tool has cut before. The lead goes back to such a place.
//!
//! Sectors that find the same stock as another one, turned, have its passes.
//!
//! The stock is simulated pass by pass, so that each pass finds what all passes before it have left. A cutter that is
//! enlarged by the error between the rays of the stock decides where it is in air; its shank and holder count as well.

use super::clearance_sphere::ClearanceSphere;
use super::cleared::Cleared;
use super::direct_link::DirectLinks;
use super::lifted_lines::{LiftedLines, Line, MAX_LIFTS, is_lifted};
use super::like_sectors::{LikeSectors, turned};
use super::stock_steps::{self, PathPoint, path_length, stations};
use super::through_air::ThroughAir;
use crate::passes::context::maximal_ranges;
use base::progress::Work;
use ir::{ClOperation, ClPass, ClPoint, Operation, Program};
use nalgebra::Vector3;
use std::ops::Range;
use tool_stock::collide::ToolSolid;
use tool_stock::stock::Field;
use wheel::operation::Allowances;

/// Least length at cutting feed before a cut and behind it, mm; the steps of the stock make it longer.
const CUT_MARGIN_MM: f64 = 0.2;

/// Least length of a run through air, mm: on a shorter one the change of feed gains no time.
const MIN_AIR_MM: f64 = 0.4;

/// Shortest path over a thin rest for which the tool leaves the rest, mm: more than two ramps.
const MIN_PAUSE_MM: f64 = 8.0;

/// Longest path over a thin rest to the air that the tool takes rather than a ramp, mm.
const NEAR_AIR_MM: f64 = 2.0;

/// Least length of a ramp along the pass, mm, and the distances over or beside the pass at which it begins.
const MIN_RAMP_MM: f64 = 1.0;
const RAMP_LIFTS: [f64; 3] = [0.5, 1.0, 2.0];

/// Part of the reserve for samples that a ramp need not keep, mm; less with thin tools. The reserve of a link is the larger
/// one, for sharp edges; passes of rounded cutters, which a ramp begins or ends on, have a smaller one.
const RESERVE_MM: f64 = 0.05;

/// Passes of one operation, reduced one after the other.
struct Reduction<'a> {
    program: &'a Program,
    operation: &'a Operation,
    direct: &'a DirectLinks<'a>,
    air: ThroughAir<'a>,
    sphere: ClearanceSphere,
    /// Stock that is no deeper in the tool is left to the next operation, mm.
    thickness: f64,
    cutter: ToolSolid,
    lifted: LiftedLines<'a>,
    cleared: &'a mut Cleared,
    /// Radius of the middle of the end without teeth, mm.
    middle: f64,
}

/// A pass that cuts.
pub(super) struct Reduced {
    pub(super) pass: ClPass,
    /// Length of the path through stock and through air, mm.
    pub(super) lengths: [f64; 2],
}

/// Reduces the passes of an operation, and removes their cuts from the stock.
pub(super) fn reduce(
    operation: &Operation,
    direct: &DirectLinks<'_>,
    like: &LikeSectors<'_>,
    planned: &mut ClOperation,
    field: &mut Field,
    cleared: &mut Cleared,
    work: &Work,
) {
    let program = like.program;
    let tool = &program.tools[operation.tool];
    let solid = &tool.solid;
    let mut reduction = Reduction {
        program,
        operation,
        direct,
        air: ThroughAir::new(program, direct, solid, field),
        sphere: ClearanceSphere::new(program, solid),
        thickness: operation.rest.map_or(0.0, |t| t.get()),
        cutter: solid.cutter_alone(0.0),
        lifted: LiftedLines::new(&program.machine, tool),
        cleared,
        middle: tool.toothless_radius().unwrap_or(0.0),
    };
    let mut kept: Vec<ClPass> = Vec::new();
    let (mut lengths, mut linked) = ([0.0; 2], 0);
    let count = planned.passes.len();
    let mut steady: Option<(u32, Vec<Reduced>)> = None;
    for passes in std::mem::take(&mut planned.passes).chunk_by(|a, b| a.sector == b.sector) {
        let sector = passes[0].sector;
        let before = kept.last().and_then(|p| p.points.last()).copied();
        let repeats = steady.as_ref().and_then(|(from, reduced)| Some((reduced, like.turn(*from, sector)?)));
        let reduced = match repeats {
            Some((reduced, turn)) => {
                work.advance(passes.len());
                let in_sector = |r: &Reduced| Reduced { pass: turned(&r.pass, sector, &turn), ..*r };
                reduction.repeated(reduced.iter().map(in_sector).collect(), before, field)
            }
            None => reduction.in_sector(passes, before, field, work),
        };
        if work.is_cancelled() {
            return;
        }
        for reduced in &reduced {
            linked += usize::from(reduced.pass.link.is_some());
            lengths = [0, 1].map(|k: usize| lengths[k] + reduced.lengths[k]);
            kept.push(reduced.pass.clone());
        }
        if steady.is_none() && like.follows(sector) {
            steady = Some((sector, reduced));
        }
    }
    let [cut, air] = lengths;
    planned.notes.push(format!(
        "{count} passes planned; {} cut, {linked} of them linked to the one before through air; {cut:.0} mm at cutting feed, {air:.0} mm of leads at link feed; stock in cells of {:.2} mm",
        kept.len(),
        field.cell()
    ));
    let lifted = kept.iter().filter(|pass| is_lifted(pass)).count();
    if lifted > 0 {
        planned.notes.push(format!(
            "{lifted} of these passes lie over others along the tool axis: those would load the tool as a slot deeper than its {}",
            tool.max_depth
        ));
    }
    planned.passes = kept;
}

impl Reduction<'_> {
    /// The passes of a sector that cut.
    fn in_sector(
        &mut self,
        passes: &[ClPass],
        mut before: Option<ClPoint>,
        field: &mut Field,
        work: &Work,
    ) -> Vec<Reduced> {
        let mut kept = Vec::new();
        // Loops of a slot have one name.
        for group in passes.chunk_by(|a, b| a.label == b.label) {
            if work.is_cancelled() {
                break;
            }
            let reduced = match group {
                [pass] => work.step(self.within_load(&Line::whole(pass), before, field)),
                loops => self.slots(loops, before, field, work),
            };
            before = reduced.last().and_then(|r| r.pass.points.last()).copied().or(before);
            kept.extend(reduced);
        }
        kept
    }

    /// Passes that are known from another sector, the first one with its own link from the end of the pass before. Removes their
    /// cuts from the stock.
    fn repeated(&mut self, mut passes: Vec<Reduced>, before: Option<ClPoint>, field: &mut Field) -> Vec<Reduced> {
        if let Some(Reduced { pass, .. }) = passes.first_mut() {
            let ends = before.zip(pass.points.first());
            pass.link = ends.and_then(|(end, first)| self.air.link(&end, first, field));
        }
        for Reduced { pass, .. } in &passes {
            self.cut(pass.sector, &stations(&self.program.machine, pass), field);
        }
        passes
    }

    /// Depth of the tool on each step between stations, mm; infinite where it has to cut.
    fn depths(&self, line: &[PathPoint], field: &Field) -> Vec<f64> {
        self.air.depths(line, self.least(), field)
    }

    /// Largest depth of a pass in the stock, mm.
    fn deepest(&self, pass: &ClPass, field: &Field) -> f64 {
        self.depths(&stations(&self.program.machine, pass), field).into_iter().fold(0.0, f64::max)
    }

    /// The loops of a slot that have to cut, each run of them as one pass. A loop takes less than the thickness, so that
    /// the stock before the first loop decides. A run begins with the first loop that touches stock: a loop that has
    /// to cut would otherwise take what those before it leave as well.
    fn slots(&mut self, loops: &[ClPass], mut before: Option<ClPoint>, field: &mut Field, work: &Work) -> Vec<Reduced> {
        let depths = loops.iter().map(|pass| work.do_step(|| self.deepest(pass, field)));
        let Some(depths) = depths.collect::<Option<Vec<f64>>>() else { return Vec::new() };
        let mut slots = Vec::new();
        for run in maximal_ranges(loops.len(), |i| depths[i] > self.air.slivers) {
            let Some(last) = run.clone().rev().find(|i| depths[*i] > self.least()) else { continue };
            // A loop begins at its rear: its lead is the end of the loop before it.
            let slot = self.slot(&loops[run.start.saturating_sub(1)..=last], before, field, work);
            before = slot.pass.points.last().copied();
            slots.push(slot);
        }
        slots
    }

    /// Loops as one pass, from the lead of the first contact with the stock to the lead behind the last one. Removes
    /// their cuts from the stock, one after the other, so that the return of a loop runs through air.
    fn slot(&mut self, loops: &[ClPass], before: Option<ClPoint>, field: &mut Field, work: &Work) -> Reduced {
        let (mut line, mut depths): (Vec<PathPoint>, Vec<f64>) = (Vec::new(), Vec::new());
        let (mut first, mut last, mut link) = (None, 0, None);
        let sector = loops[0].sector;
        // A cancelled run discards its loops.
        for pass in loops.iter().enumerate().take_while(|(k, _)| *k == 0 || !work.is_cancelled()).map(|(_, pass)| pass)
        {
            let of_loop = stations(&self.program.machine, pass);
            let found = self.depths(&of_loop, field);
            // On its return a loop slides along the cuts of the loops before.
            let found = found.into_iter().map(|depth| if depth > self.air.slivers { depth } else { 0.0 });
            // Each loop begins where the one before it ends.
            line.pop();
            let at = line.len();
            line.extend_from_slice(&of_loop);
            depths.extend(found);
            let contact = (at..depths.len()).find(|i| depths[*i] > self.air.slivers);
            last = (at..depths.len()).rfind(|i| depths[*i] > self.air.slivers).unwrap_or(last);
            if let (None, Some(contact)) = (first, contact) {
                let start = self.entry(sector, &line, self.lead(&line, &depths, contact, false));
                link = before.and_then(|end| self.air.link(&end, &line[start].point, field));
                first = Some(start);
            }
            self.cut(sector, &of_loop, field);
        }
        let first = first.unwrap_or(0);
        let end = self.lead(&line, &depths, last + 1, true);
        let mut reduced = assembled(&loops[0], &line[first..=end], &depths[first..end]);
        reduced.pass.link = link;
        reduced
    }

    /// The parts of a line that cut, after those over it that the load on the tool needs.
    fn within_load(&mut self, line: &Line, mut before: Option<ClPoint>, field: &mut Field) -> Vec<Reduced> {
        let mut parts: Vec<Reduced> = Vec::new();
        for round in 0..MAX_LIFTS {
            let over = self.lifted.over(line, round, self.air.slivers, field);
            if over.is_empty() {
                break;
            }
            for over in over {
                parts.extend(self.within_load(&over, before, field));
                before = parts.last().and_then(|r| r.pass.points.last()).copied().or(before);
            }
        }
        parts.extend(self.reduced(line, before, field));
        parts
    }

    /// The parts of a line that cut, with their leads, and with their links from the end of the pass before. Removes
    /// their cuts from the stock.
    fn reduced(&mut self, whole: &Line, mut before: Option<ClPoint>, field: &mut Field) -> Vec<Reduced> {
        let pass = &whole.pass;
        let line = stations(&self.program.machine, pass);
        let cuts = whole.steps(&line);
        let mut depths = self.depths(&line, field);
        let sector = pass.sector;
        let mut parts: Vec<Reduced> = Vec::new();
        let mut done = 0;
        let wanted = |depths: &[f64]| -> Vec<f64> {
            depths.iter().enumerate().map(|(i, depth)| if cuts.contains(&i) { *depth } else { 0.0 }).collect()
        };
        while let Some(interval) = self.cut_intervals(&line[done..], &wanted(&depths)[done..]).first() {
            let interval = interval.start + done..interval.end + done;
            let start = self.end_of(sector, &line, &depths, interval.start, false, field);
            let first = start.ramp.first().unwrap_or(&line[start.station]).point;
            let link = before.and_then(|end| self.air.link(&end, &first, field));
            let mut part = start.ramp;
            let mut found = self.depths(&part, field);
            self.cut(sector, &part, field);
            part.pop();
            let end = self.cut_to_end(sector, &line, start.station, interval.end, &mut depths, field);
            let finish = self.end_of(sector, &line, &depths, end, true, field);
            self.cut(sector, &line[end..=finish.station], field);
            part.extend_from_slice(&line[start.station..=finish.station]);
            found.extend_from_slice(&depths[start.station..finish.station]);
            if let [_, ramp @ ..] = &finish.ramp[..] {
                found.extend(self.depths(&finish.ramp, field));
                self.cut(sector, &finish.ramp, field);
                part.extend_from_slice(ramp);
            }
            let mut reduced = assembled(pass, &part, &found);
            reduced.pass.link = link;
            before = reduced.pass.points.last().copied();
            parts.push(reduced);
            done = finish.station;
        }
        parts
    }

    /// Cuts from a station until nothing is left to cut up to another station, and returns the station where that is.
    /// The rear half of a cutter passes where its front half has cut, so that the tool is done before all of it has left
    /// the stock that it found. Updates the depths behind the returned station.
    fn cut_to_end(
        &mut self,
        sector: u32,
        line: &[PathPoint],
        from: usize,
        to: usize,
        depths: &mut Vec<f64>,
        field: &mut Field,
    ) -> usize {
        let mut rear = 0.0;
        let mut at = to;
        while at > from && rear < 2.0 * self.cutter.radius() {
            at -= 1;
            rear += length(line, at);
        }
        self.cut(sector, &line[from..=at], field);
        while let Some(next) = self.next_cut(&line[at..=to], field) {
            self.cut(sector, &line[at..=at + next], field);
            at += next;
        }
        depths.truncate(at);
        depths.extend(self.depths(&line[at..], field));
        at
    }

    /// End of the first step that cuts.
    fn next_cut(&self, line: &[PathPoint], field: &Field) -> Option<usize> {
        let cuts = |line: &[PathPoint]| {
            self.air.depths(line, self.air.slivers, field).iter().position(|d| *d > self.air.slivers)
        };
        // Mostly the first step cuts, and a look at one step costs little.
        cuts(line.get(..2)?).or_else(|| cuts(line)).map(|step| step + 1)
    }

    /// Removes the cut along stations from the stock.
    fn cut(&mut self, sector: u32, line: &[PathPoint], field: &mut Field) {
        self.cleared.add(sector, line);
        stock_steps::cut(&self.program.machine, line, &self.cutter, field);
    }

    /// Depth in the stock from which the tool has to cut, mm.
    fn least(&self) -> f64 {
        self.thickness.max(self.air.slivers)
    }

    /// Ranges of stations between which the tool has to cut. A tool without rest machining cuts from the first contact
    /// to the last.
    fn cut_intervals(&self, line: &[PathPoint], depths: &[f64]) -> Vec<Range<usize>> {
        let least = self.least();
        let mut cut_intervals: Vec<Range<usize>> = Vec::new();
        for deep in maximal_ranges(depths.len(), |i| depths[i] > least) {
            match cut_intervals.last_mut() {
                Some(last) if self.thickness == 0.0 || path_length(&line[last.end..=deep.start]) < MIN_PAUSE_MM => {
                    last.end = deep.end;
                }
                _ => cut_intervals.push(deep),
            }
        }
        cut_intervals
    }

    /// Where a part of a pass begins or ends: in air, where air is near; else over its first or last station, so that the
    /// tool ramps through a thin rest; else in the air farther on.
    fn end_of(
        &self,
        sector: u32,
        line: &[PathPoint],
        depths: &[f64],
        station: usize,
        at_end: bool,
        field: &mut Field,
    ) -> PassEnd {
        let steps = steps_from(station, depths.len(), at_end);
        let beyond = |step: usize| if at_end { step + 1 } else { step };
        let to_air = steps.iter().position(|i| depths[*i] <= self.air.slivers);
        let length_to_air: f64 = steps[..to_air.unwrap_or(steps.len())].iter().map(|i| length(line, *i)).sum();
        if self.thickness > 0.0
            && length_to_air > NEAR_AIR_MM
            && let Some(place) = self.ramp_end(line, &steps, station, at_end, beyond, field)
            && (at_end || self.holds(sector, &place))
        {
            let here = ClPoint { contact: None, ..line[station].point };
            let ends = if at_end { [here, place] } else { [place, here] };
            return PassEnd { station, ramp: self.air.straight_path(ends) };
        }
        let station = self.lead(line, depths, station, at_end);
        PassEnd { station: if at_end { station } else { self.entry(sector, line, station) }, ramp: Vec::new() }
    }

    /// The last station up to a station of a lead at which the middle of the end finds no material above the floor; this
    /// station where none is known.
    fn entry(&self, sector: u32, line: &[PathPoint], station: usize) -> usize {
        (0..=station).rev().find(|i| self.holds(sector, &line[*i].point)).unwrap_or(station)
    }

    /// True when the middle of the end may come down along the axis to a place.
    fn holds(&self, sector: u32, place: &ClPoint) -> bool {
        self.middle == 0.0 || self.cleared.holds(self.program, sector, place, self.middle, self.cutter.flute_length)
    }

    /// The station in air at which the lead before or behind a station of a cut begins or ends.
    fn lead(&self, line: &[PathPoint], depths: &[f64], station: usize, at_end: bool) -> usize {
        let required = if at_end { self.operation.lead_out } else { self.operation.lead_in }.get();
        let (mut last, mut lead) = (station, 0.0);
        for step in steps_from(station, depths.len(), at_end) {
            if depths[step] <= self.air.slivers {
                lead += length(line, step);
            }
            last = if at_end { step + 1 } else { step };
            // Along a cut that the tool has made before, a lead at cutting feed is needless.
            if lead >= if depths[step] > 0.0 { required.min(CUT_MARGIN_MM) } else { required } {
                break;
            }
        }
        last
    }

    /// A place in air, over or beside a station some way before the first or behind the last of a cut, from which or to
    /// which the tool goes straight, clear of the part, and down no more steeply than it may.
    fn ramp_end(
        &self,
        line: &[PathPoint],
        steps: &[usize],
        station: usize,
        at_end: bool,
        beyond: impl Fn(usize) -> usize,
        field: &mut Field,
    ) -> Option<ClPoint> {
        let here = &line[station].point;
        let steepest = self.program.tools[self.operation.tool].ramp.get();
        let may = |place: &ClPoint| at_end || descent(place, here) <= steepest;
        let kept = self.operation.kind.roughing().unwrap_or(Allowances::NONE);
        let kept = kept.plus(-RESERVE_MM * self.direct.scale());
        for lift in RAMP_LIFTS {
            let over = |i: usize| {
                let from = line[beyond(i)].point;
                ClPoint { tip: from.tip + from.axis * lift, axis: from.axis, contact: None }
            };
            let mut run = 0.0;
            let long = steps.iter().filter(|i| {
                run += length(line, **i);
                run >= MIN_RAMP_MM
            });
            let Some(top) = long.chain(steps.last()).map(|i| (*i, over(*i))).find(|(_, place)| may(place)) else {
                continue;
            };
            let along = (here.tip - line[beyond(top.0)].point.tip).normalize();
            let side = top.1.axis.cross(&along);
            for offset in [0.0, lift, -lift] {
                let place = ClPoint { tip: top.1.tip + side * offset, ..top.1 };
                let above =
                    ClPoint { tip: place.tip + place.axis * self.sphere.exit(&place.tip, &place.axis), ..place };
                if self.air.is_free(&[above, place], 0.0, field) && self.direct.straight(&place, here, kept) {
                    return Some(place);
                }
            }
        }
        None
    }
}

/// Angle at which a tool goes down from one place to another, against the plane of its end, radians; the larger one of both
/// ends.
fn descent(from: &ClPoint, to: &ClPoint) -> f64 {
    let motion = to.tip - from.tip;
    let angle = |axis: &Vector3<f64>| {
        let down = -motion.dot(axis);
        libm::atan2(down, (motion + axis * down).norm())
    };
    angle(&from.axis).max(angle(&to.axis))
}

/// The steps from a station on to the end of a pass of `count` steps, or back to its start.
fn steps_from(station: usize, count: usize, to_end: bool) -> Vec<usize> {
    if to_end { (station..count).collect() } else { (0..station).rev().collect() }
}

/// End of a part of a pass.
struct PassEnd {
    station: usize,
    /// Stations from a place in air to this one, or from this one to the place; empty without a ramp.
    ramp: Vec<PathPoint>,
}

/// A pass from the stations of its part, with the steps that run through air.
pub(super) fn assembled(pass: &ClPass, line: &[PathPoint], depths: &[f64]) -> Reduced {
    let fast = through_air(line, depths);
    let mut reduced =
        ClPass { label: pass.label.clone(), sector: pass.sector, points: Vec::new(), air: Vec::new(), link: None };
    let mut lengths = [0.0; 2];
    for (i, station) in line.iter().enumerate() {
        let [before, after] = [i.checked_sub(1).map(|b| fast[b]), fast.get(i).copied()];
        if let Some(fast) = before {
            lengths[usize::from(fast)] += length(line, i - 1);
        }
        if station.planned || before != after {
            if before == Some(true) {
                reduced.air.push(reduced.points.len());
            }
            reduced.points.push(station.point);
        }
    }
    Reduced { pass: reduced, lengths }
}

/// Length of a step, mm.
fn length(line: &[PathPoint], step: usize) -> f64 {
    (line[step + 1].point.tip - line[step].point.tip).norm()
}

/// For each step whether the tool runs through air at link feed: leads and gaps between cuts, less the margins beside cuts.
fn through_air(line: &[PathPoint], depths: &[f64]) -> Vec<bool> {
    let mut fast = vec![false; depths.len()];
    for Range { start, end } in maximal_ranges(depths.len(), |i| depths[i] == 0.0) {
        let (mut from, mut to) = (start, end);
        let mut margin = 0.0;
        while start > 0 && from < to && margin < CUT_MARGIN_MM {
            margin += length(line, from);
            from += 1;
        }
        margin = 0.0;
        while end < depths.len() && from < to && margin < CUT_MARGIN_MM {
            to -= 1;
            margin += length(line, to);
        }
        if (from..to).map(|i| length(line, i)).sum::<f64>() >= MIN_AIR_MM {
            fast[from..to].fill(true);
        }
    }
    fast
}
