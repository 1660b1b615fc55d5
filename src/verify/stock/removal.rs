//! Removal of the steps, averaged over a tip motion of some cells, and what it is of the limits of tool and spindle.

use super::StepPlace;
use crate::ir::{MoveKind, Operation, Program};
use crate::stock::BlockCut;
use std::collections::BTreeMap;

/// Section of a chip from which the tool counts as cutting, mm2: a smaller section is rubbing or rounding.
const CHIP_SECTION: f64 = 1e-3;

/// Removal averaged over a tip motion of some cells around each step.
pub(super) struct StepRemoval {
    /// Whether the tool cuts in each step.
    pub(super) cuts: Vec<bool>,
    /// Rate of each step, mm3/s, over the window that ends with the step.
    pub(super) rates: Vec<f64>,
    /// Speed of the tip over this window, mm/s; zero where the window is not full.
    pub(super) speeds: Vec<f64>,
    /// Largest rate, mm3/s, and its step.
    pub(super) rate: Option<(f64, usize)>,
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
            if sum > CHIP_SECTION * way.max(window) && volume[start..=end].iter().any(|v| *v > 0.0) {
                // Steps without removal between steps with removal count as cutting; steps before and after do not.
                let first = (start..=end).find(|i| volume[*i] > 0.0).unwrap_or(end);
                let last = (start..=end).rev().find(|i| volume[*i] > 0.0).unwrap_or(end);
                found.cuts[first..=last].fill(true);
                let rate = sum / time;
                found.rates[end] = if time > 0.0 { rate } else { 0.0 };
                if way >= window && time > 0.0 {
                    found.speeds[end] = way / time;
                }
                if way >= window && time > 0.0 && found.rate.is_none_or(|(most, _)| rate > most) {
                    let largest = (start..=end).max_by(|a, b| volume[*a].total_cmp(&volume[*b])).unwrap_or(end);
                    found.rate = Some((rate, largest));
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
        (window, count): (f64, usize),
    ) -> Vec<f64> {
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
        let mut shares = vec![0.0_f64; count];
        for end in (0..places.len()).filter(|end| self.speeds[*end] > 0.0 && self.rates[*end] > 0.0) {
            let largest = largest_feed(self.rates[end] / self.speeds[end]);
            let mut way = 0.0;
            for place in places[..=end].iter().rev().filter(|p| p.time > 0.0) {
                if let Some(share) = shares.get_mut(place.index as usize) {
                    *share = share.max(60.0 * place.way / place.time / largest);
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

/// Largest power at the cutter, kW, and its step; `None` without the material.
pub(super) fn power(program: &Program, operation: &Operation, removal: &StepRemoval) -> Option<(f64, u32)> {
    let material = program.stock.material?;
    let teeth = operation.speed.get() * f64::from(program.tools[operation.tool].flutes);
    let powers = removal.rates.iter().zip(&removal.speeds).zip(0_u32..).filter(|((_, speed), _)| **speed > 0.0);
    let powers = powers.map(|((rate, speed), step)| (material.power(rate / speed, speed * 60.0, teeth), step));
    powers.filter(|p| p.0 > 0.0).max_by(|a, b| a.0.total_cmp(&b.0))
}

/// Largest removal rate of a link, mm3/s, and the step that removes most of it, averaged over a tip motion `window`, mm, or
/// over the link where the link is shorter. A long way through air does not lower it. Only moves that remove more than
/// `least`, mm3, count.
pub(super) fn fastest_link(places: &[StepPlace], cuts: &[BlockCut], window: f64, least: f64) -> Option<(f64, u32)> {
    let mut volume = vec![0.0; places.len()];
    let mut of_move: BTreeMap<u32, f64> = BTreeMap::new();
    for c in cuts {
        let step = c.block as usize;
        if let Some(place) = places.get(step).filter(|p| p.kind == MoveKind::Link) {
            volume[step] += c.volume;
            *of_move.entry(place.index).or_default() += c.volume;
        }
    }
    for (step, place) in places.iter().enumerate() {
        if of_move.get(&place.index).is_none_or(|v| *v <= least) {
            volume[step] = 0.0;
        }
    }
    let mut fastest: Option<(f64, u32)> = None;
    let mut next = 0;
    for run in places.chunk_by(|a, b| a.kind == b.kind) {
        let link = next..next + run.len();
        next = link.end;
        if run[0].kind != MoveKind::Link {
            continue;
        }
        let mut last = LastWay::new(link.start);
        for end in link.clone() {
            last.take(end, places, &volume, window);
            let LastWay { start, way, time, sum } = last;
            let full = way >= window || end + 1 == link.end;
            let rate = if full && time > 0.0 { sum / time } else { 0.0 };
            if rate > fastest.map_or(0.0, |f| f.0) {
                let most = (start..=end).max_by(|a, b| volume[*a].total_cmp(&volume[*b])).unwrap_or(end);
                fastest = Some((rate, u32::try_from(most).unwrap_or(u32::MAX)));
            }
        }
    }
    // Differences of sums contain rounding errors.
    fastest.filter(|f| volume.get(f.1 as usize).is_some_and(|v| *v > 0.0))
}
