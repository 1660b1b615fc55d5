//! Removal of the steps, averaged over a tip motion of some cells, and what it is of the limits of tool and spindle.

use super::{StepPlace, StepValue};
use base::units::Share;
use ir::{MoveKind, Operation, Program};
use tool_stock::stock::BlockCut;

/// Section of a chip from which the tool counts as cutting, mm2: a smaller section is rubbing or rounding.
const MIN_CHIP_SECTION: f64 = 1e-3;

/// Removal averaged over a tip motion of some cells around each step.
pub(super) struct StepRemoval {
    /// Whether the tool cuts in each step.
    pub(super) cuts: Vec<bool>,
    /// Rate of each step, mm3/s, over the window that ends with the step.
    pub(super) rates: Vec<f64>,
    /// Speed of the tip over this window, mm/s; zero where the window is not full.
    pub(super) speeds: Vec<f64>,
    /// Largest rate, mm3/s.
    pub(super) rate: Option<StepValue>,
}

/// The steps up to one of them that just cover a tip motion.
#[derive(Clone, Copy)]
struct LastWay {
    /// First step.
    start: usize,
    /// Tip motion, mm, time, s, and removed volume, mm3.
    way: f64,
    time: f64,
    sum: f64,
}

impl LastWay {
    fn new(start: usize) -> Self {
        Self { start, way: 0.0, time: 0.0, sum: 0.0 }
    }

    /// Takes the next step, and leaves out the first ones that the tip motion `window` does not need.
    fn take(&mut self, end: usize, places: &[StepPlace], volume: &[f64], window: f64) {
        self.way += places[end].way;
        self.time += places[end].time;
        self.sum += volume[end];
        while self.start < end && self.way - places[self.start].way >= window {
            self.way -= places[self.start].way;
            self.time -= places[self.start].time;
            self.sum -= volume[self.start];
            self.start += 1;
        }
    }
}

impl StepRemoval {
    pub(super) fn new(places: &[StepPlace], cuts: &[BlockCut], window: f64) -> Self {
        let mut volume = vec![0.0; places.len()];
        for c in cuts {
            if let Some(v) = volume.get_mut(c.block as usize) {
                *v += c.volume;
            }
        }
        let mut found = Self {
            cuts: vec![false; places.len()],
            rates: vec![0.0; places.len()],
            speeds: vec![0.0; places.len()],
            rate: None,
        };
        let mut last = LastWay::new(0);
        for end in 0..places.len() {
            last.take(end, places, &volume, window);
            let LastWay { start, way, time, sum } = last;
            // Differences of sums contain rounding errors.
            if sum > MIN_CHIP_SECTION * way.max(window) && volume[start..=end].iter().any(|v| *v > 0.0) {
                // Steps without removal between steps with removal count as cutting; steps before and after do not.
                let first = (start..=end).find(|i| volume[*i] > 0.0).unwrap_or(end);
                let last = (start..=end).rev().find(|i| volume[*i] > 0.0).unwrap_or(end);
                found.cuts[first..=last].fill(true);
                let rate = sum / time;
                found.rates[end] = if time > 0.0 { rate } else { 0.0 };
                if way >= window && time > 0.0 {
                    found.speeds[end] = way / time;
                }
                if way >= window && time > 0.0 && found.rate.is_none_or(|most| rate > most.value) {
                    let largest = (start..=end).max_by(|a, b| volume[*a].total_cmp(&volume[*b])).unwrap_or(end);
                    found.rate = Some(StepValue { value: rate, step: u32::try_from(largest).unwrap_or(u32::MAX) });
                }
            }
        }
        found
    }

    /// For each of `count` moves its feed as a share of the feed at which tool or spindle reach a limit; empty without a limit.
    /// The largest section of the windows that a move touches decides.
    pub(super) fn shares(
        &self,
        program: &Program,
        operation: &Operation,
        places: &[StepPlace],
        window: f64,
        count: usize,
    ) -> Vec<Share> {
        let tool = &program.tools[operation.tool];
        let (rate, power) = (tool.max_rate, program.stock.material.zip(program.machine.power));
        if rate.is_none() && power.is_none() {
            return Vec::new();
        }
        let teeth = operation.speed.get() * f64::from(tool.flutes);
        let largest_feed = |section: f64| {
            let by_rate = rate.map_or(f64::INFINITY, |rate| rate.get() / section);
            by_rate.min(power.map_or(f64::INFINITY, |(material, power)| material.feed_at(power, section, teeth)))
        };
        let mut shares = vec![Share(0.0); count];
        for end in (0..places.len()).filter(|end| self.speeds[*end] > 0.0 && self.rates[*end] > 0.0) {
            let largest = largest_feed(self.rates[end] / self.speeds[end]);
            let mut way = 0.0;
            for place in places[..=end].iter().rev().filter(|p| p.time > 0.0) {
                for share in &mut shares[place.moves()] {
                    *share = Share(share.get().max(60.0 * place.way / place.time / largest));
                }
                way += place.way;
                if way >= window {
                    break;
                }
            }
        }
        shares
    }
}

/// Largest power at the cutter, kW; `None` without the material.
pub(super) fn power(program: &Program, operation: &Operation, removal: &StepRemoval) -> Option<StepValue> {
    let material = program.stock.material?;
    let teeth = operation.speed.get() * f64::from(program.tools[operation.tool].flutes);
    let powers = removal.rates.iter().zip(&removal.speeds).zip(0_u32..).filter(|((_, speed), _)| **speed > 0.0);
    let power = |rate: &f64, speed: &f64| material.power(rate / speed, speed * 60.0, teeth);
    let powers = powers.map(|((rate, speed), step)| StepValue { value: power(rate, speed), step });
    powers.filter(|p| p.value > 0.0).max_by(|a, b| a.value.total_cmp(&b.value))
}

/// Volume that links remove over [`LINK_WINDOW`] from which they count as cutting, mm3: less comes from rubbing beside a wall
/// that was cut before.
const MIN_LINK_VOLUME: f64 = 1.0;

/// Tip motion over which the removal of links adds up, mm: a path on a small wheel, so that a cut at link feed counts however
/// many blocks divide it. Over this way the least volume is a section of ten times [`MIN_CHIP_SECTION`].
const LINK_WINDOW: f64 = 100.0;

/// Steps of one kind of move in their order, as if nothing stood between them.
struct OfKind {
    /// Index of each among all steps.
    steps: Vec<usize>,
    /// Tip motion, mm, time, s, and removed volume, mm3, of the steps before each, and of all.
    way: Vec<f64>,
    time: Vec<f64>,
    sum: Vec<f64>,
}

impl OfKind {
    fn new(places: &[StepPlace], cuts: &[BlockCut], kind: MoveKind) -> Self {
        let mut volume = vec![0.0; places.len()];
        for c in cuts {
            if let Some(v) = volume.get_mut(c.block as usize) {
                *v += c.volume;
            }
        }
        let steps: Vec<usize> = (0..places.len()).filter(|i| places[*i].kind == kind).collect();
        let before = |value: &dyn Fn(usize) -> f64| {
            let mut sums = vec![0.0];
            sums.extend(steps.iter().scan(0.0, |sum, i| {
                *sum += value(*i);
                Some(*sum)
            }));
            sums
        };
        let way = before(&|i| places[i].way);
        let time = before(&|i| places[i].time);
        let sum = before(&|i| volume[i]);
        Self { steps, way, time, sum }
    }

    /// The first of the steps up to `end`, not included, that just cover a tip motion; `None` where all of them cover less.
    fn start(&self, end: usize, way: f64) -> Option<usize> {
        let first = self.way[..=end].partition_point(|w| self.way[end] - w >= way);
        first.checked_sub(1)
    }

    /// Removal rate of steps, mm3/s.
    fn rate(&self, [start, end]: [usize; 2]) -> f64 {
        let time = self.time[end] - self.time[start];
        if time > 0.0 { (self.sum[end] - self.sum[start]) / time } else { 0.0 }
    }

    /// Whether steps remove as much as a cut, alone or with those around them.
    fn removes(&self, [start, end]: [usize; 2]) -> bool {
        let [before, after] = [self.start(end, LINK_WINDOW).unwrap_or(0), self.within(start, LINK_WINDOW)];
        self.sum[end] - self.sum[before.min(start)] > MIN_LINK_VOLUME
            || self.sum[after.max(end)] - self.sum[start] > MIN_LINK_VOLUME
    }

    /// The end of the steps from `start` on that cover no more than a tip motion.
    fn within(&self, start: usize, way: f64) -> usize {
        self.way.partition_point(|w| w - self.way[start] <= way) - 1
    }

    /// The step with the largest removal.
    fn largest(&self, [start, end]: [usize; 2]) -> usize {
        let most = (start..end).max_by(|a, b| {
            let volume = |i: usize| self.sum[i + 1] - self.sum[i];
            volume(*a).total_cmp(&volume(*b))
        });
        self.steps[most.unwrap_or(start)]
    }
}

/// Largest removal rate of the moves at process feed, mm3/s, averaged over a tip motion `window`, mm. Links between them do not
/// count, and moves that are shorter together are no measure: zero.
pub(super) fn cut_rate(places: &[StepPlace], cuts: &[BlockCut], window: f64) -> f64 {
    let moves = OfKind::new(places, cuts, MoveKind::Cut);
    let rates = (1..=moves.steps.len()).filter_map(|end| Some(moves.rate([moves.start(end, window)?, end])));
    rates.fold(0.0, f64::max)
}

/// Largest removal rate of links, mm3/s, with the step that removes most of it, averaged over a tip motion `window`, mm, or
/// over the link where the link is shorter and cuts alone. A long way through air does not lower it. Links that remove little
/// do not count; their removal adds up over their way, whatever stands between them, so that the division of a motion into
/// blocks does not matter.
pub(super) fn fastest_link(places: &[StepPlace], cuts: &[BlockCut], window: f64) -> Option<StepValue> {
    let links = OfKind::new(places, cuts, MoveKind::Link);
    let mut fastest: Option<StepValue> = None;
    let mut first = 0;
    for end in 1..=links.steps.len() {
        let ends = links.steps.get(end).is_none_or(|next| *next != links.steps[end - 1] + 1);
        let short = links.way[end] - links.way[first] < window;
        let alone = (ends && short && links.sum[end] - links.sum[first] > MIN_LINK_VOLUME).then_some([first, end]);
        let window = links.start(end, window).map(|start| [start, end]).filter(|steps| links.removes(*steps));
        for steps in [alone, window].into_iter().flatten() {
            let value = links.rate(steps);
            if value > fastest.map_or(0.0, |f| f.value) {
                fastest = Some(StepValue { value, step: u32::try_from(links.largest(steps)).unwrap_or(u32::MAX) });
            }
        }
        if ends {
            first = end;
        }
    }
    fastest
}
