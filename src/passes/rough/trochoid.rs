//! Trochoidal slots: loops across the channel, one behind the other, that open it with a bounded arc of engagement.
//!
//! A loop is an ellipse whose centre moves on along the channel, so that all loops make one smooth curve. Its front half
//! cuts, with the material on the side that `milling` names; its rear half returns through what is cut. Each loop goes on
//! as far as its arc of engagement allows, measured against the two loops before it at the tip and a step down above it,
//! since the tool axis turns along the channel. Across it the axis does not turn: rotary axes are slower than a loop.
//!
//! Between two loops with the distance c, a front with the radius of curvature r, whose normal has the angle p to the
//! channel, has the arc acos(1 - c cos(p) (1 + R / r) / R), nearly. A flat front therefore takes more at a time, and a
//! sharp end takes less. With the half axis along the channel two thirds of that across, arc and length of a loop are
//! both near their best: of all ellipses, those with ratios of 0.6 to 0.7 have the least length of path for an opened
//! length, for widths from one to four radii of the tool.

use super::layers::Roughing;
use super::levels::LevelRun;
use super::run_map::{Place, RunMap};
use crate::ir::CcPoint;
use crate::method::Milling;
use crate::passes::context::maximal_ranges;
use nalgebra::{Point2, Point3, Vector3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

/// Half axis of a loop along the channel, over that across it.
const FLATNESS: f64 = 2.0 / 3.0;

/// Half width that the loops open, and the least one for which there are loops, in radii of the tool. A narrower opening
/// needs more and shorter loops, which takes longer; a wider one takes longer than the lines beside it would
/// (`docs/benchmarks.md`).
const OPENED: f64 = 0.75;
const LEAST: f64 = 0.2;

/// Most by which a border of the strip of the loops moves outward along the channel, over the way along it.
const GROWTH: f64 = 0.3;

/// Least and largest distance of two loops, in radii of the tool.
const DISTANCES: [f64; 2] = [0.02, 1.0];

/// Halvings of the interval of distances: to a hundredth of the radius.
const HALVINGS: usize = 7;

/// Share of `tolerance rough` by which chords of a loop leave it at its ends. Two chords as one would leave it by more than
/// the tolerance everywhere, so that thinning keeps the chords for which the arc is computed.
const CHORD: f64 = 0.4;

/// Limits of the loops of an operation.
#[derive(Clone, Copy)]
pub(super) struct Trochoid {
    /// Largest arc of engagement, radians.
    pub(super) engagement: f64,
    pub(super) milling: Milling,
    /// Index of the wall along which a line runs towards higher stations.
    pub(super) wall_forward: usize,
}

/// The loops of a run.
#[derive(Default)]
pub(super) struct Opening {
    /// Half width that the loops open at each station, mm, as the tip of a line moves that opens the same a step down above
    /// the tip; zero where the slot stays.
    pub(super) half: Vec<f64>,
    /// The loops in the order of cutting. Each begins where the loop before it ends.
    pub(super) loops: Vec<Vec<CcPoint>>,
}

/// Loops being laid.
struct Loops<'a> {
    map: RunMap<'a>,
    limits: Trochoid,
    /// Radius of the tool, and how far the machine may leave each loop, mm.
    radius: f64,
    tolerance: f64,
    /// Heights over the tip at which the arc is measured, mm.
    heights: [f64; 2],
    /// Half width at each station, mm.
    half: Vec<f64>,
    stations: Vec<f64>,
    /// Ends of the piece that is being opened, as distances along the channel, mm.
    within: [f64; 2],
    /// 1 where the loops go on towards higher stations, else -1.
    forward: f64,
    /// Number of chords of a loop.
    chords: usize,
}

/// A loop: its places with the tool axes, and the points of the tool axis at both heights.
struct Loop {
    places: Vec<(Place, Vector3<f64>)>,
    paths: [Vec<(Point3<f64>, Vector3<f64>)>; 2],
}

impl Opening {
    /// The loops of a run, from each of its ends that lies outside of the stock.
    pub(super) fn new(roughing: &Roughing<'_>, run: &LevelRun, limits: Trochoid) -> Self {
        let radius = roughing.radius();
        let none = Self { half: vec![0.0; run.stations.len()], loops: Vec::new() };
        let [least, most] = [LEAST * radius, OPENED * radius];
        let Some(mut map) = RunMap::new(roughing, run, FLATNESS * most, most) else { return none };
        let stations = map.stations();
        let free = map.halves();
        let wide = maximal_ranges(free.len(), |i| free[i] >= least);
        let mut pieces = Vec::new();
        for piece in wide {
            let open = [piece.start == 0 && run.open[0], piece.end == free.len() && run.open[1]];
            let forward = match open {
                [false, false] => continue,
                [true, true] => free[piece.start] >= free[piece.end - 1],
                [first, _] => first,
            };
            let order: Vec<usize> = if forward { piece.clone().collect() } else { piece.clone().rev().collect() };
            let count = map.narrow(&order, [least, most], GROWTH);
            if count > 1 {
                let piece = if forward { piece.start..piece.start + count } else { piece.end - count..piece.end };
                pieces.push((piece, forward));
            }
        }
        let halves = map.halves();
        let opened = |i: usize| pieces.iter().any(|(piece, _)| piece.contains(&i));
        let half = (0..halves.len()).map(|i| if opened(i) { halves[i] } else { 0.0 }).collect();
        let chords = (PI / libm::sqrt(2.0 * CHORD * roughing.tolerance / most)).ceil().clamp(12.0, 64.0) as usize;
        let mut loops = Loops {
            map,
            limits,
            radius,
            tolerance: roughing.tolerance,
            heights: [0.0, roughing.depth],
            half,
            stations,
            within: [0.0; 2],
            forward: 1.0,
            chords,
        };
        let mut all = Vec::new();
        for (piece, forward) in pieces {
            loops.forward = if forward { 1.0 } else { -1.0 };
            // At an end outside of the stock the loops go on; at another one they stay in the piece.
            let open = [piece.start == 0 && run.open[0], piece.end == run.stations.len() && run.open[1]];
            all.extend(loops.open(&piece, open.map(|open| if open { 2.0 * most } else { -FLATNESS * most })));
        }
        let half = loops.half.iter().zip(loops.map.widening()).map(|(half, by)| half / by).collect();
        Self { loops: all, half }
    }
}

impl Loops<'_> {
    /// The loops over a piece, from its end outside of the stock to its other end, with the ways beyond both ends, mm.
    fn open(&mut self, piece: &Range<usize>, beyond: [f64; 2]) -> Vec<Vec<CcPoint>> {
        self.within = [self.stations[piece.start], self.stations[piece.end - 1]];
        let ends = [self.within[0] - beyond[0], self.within[1] + beyond[1]];
        let [mut at, to] = if self.forward > 0.0 { ends } else { [ends[1], ends[0]] };
        let [least, most] = DISTANCES.map(|share| share * self.radius);
        let mut before = vec![self.curve(at - self.forward * least, least)];
        let mut all = Vec::new();
        while (to - at) * self.forward > 0.0 {
            let (mut low, mut high) = (least, most);
            let mut found = None;
            for _ in 0..HALVINGS {
                let distance = 0.5 * (low + high);
                let curve = self.curve(at, distance);
                if self.arc(&curve, &before) <= self.limits.engagement {
                    (low, found) = (distance, Some(curve));
                } else {
                    high = distance;
                }
            }
            let found = found.unwrap_or_else(|| self.curve(at, least));
            all.push((at, found.places.clone()));
            at += self.forward * low;
            before.push(found);
            if before.len() > 2 {
                before.remove(0);
            }
        }
        let station = |(place, axis): &(Place, Vector3<f64>)| self.map.cc_point(*place, axis);
        let mut stations: Vec<Option<Vec<CcPoint>>> =
            all.par_iter().map(|(_, places)| places.iter().map(station).collect()).collect();
        // Between the stations of the strip the tool may come too near to a wall: there the loops end.
        if let Some(k) = stations.iter().position(Option::is_none) {
            let end = all[k].0;
            for i in piece.clone().filter(|i| (self.stations[*i] - end) * self.forward >= 0.0) {
                self.half[i] = 0.0;
            }
            stations.truncate(k);
        }
        stations.into_iter().flatten().collect()
    }

    /// The loop that begins with its rear at a distance along the channel, and ends as far beyond as given, mm.
    fn curve(&self, from: f64, distance: f64) -> Loop {
        // The material lies ahead of the front. A line that runs forward has it on the side of its wall; the front runs
        // a quarter turn beside this line.
        let sense = if self.limits.wall_forward == 1 { -1.0 } else { 1.0 };
        let at = |k: usize| {
            let share = k as f64 / self.chords as f64;
            let (sin, cos) = libm::sincos(PI + TAU * share);
            let centre = from + self.forward * distance * share;
            let half = self.half_at(centre);
            let place = [self.forward * FLATNESS * half * cos, self.forward * sense * half * sin];
            (self.map.place(centre, place), self.map.axis(centre))
        };
        let places: Vec<(Place, Vector3<f64>)> = (0..=self.chords).map(at).collect();
        let path = |height: f64| places.iter().map(|(p, axis)| (self.map.tip(*p) + axis * height, *axis)).collect();
        let paths = self.heights.map(path);
        Loop { places, paths }
    }

    /// Half width at a distance along the channel, mm.
    fn half_at(&self, along: f64) -> f64 {
        let along = along.clamp(self.within[0], self.within[1]);
        let next = self.stations.partition_point(|s| *s < along).clamp(1, self.stations.len() - 1);
        let share = (along - self.stations[next - 1]) / (self.stations[next] - self.stations[next - 1]);
        let [a, b] = [self.half[next - 1], self.half[next]];
        a + (b - a) * share
    }

    /// Largest arc of engagement on the front of a loop in what the loops before it leave, radians.
    fn arc(&self, new: &Loop, before: &[Loop]) -> f64 {
        let mut largest = 0.0_f64;
        for k in 0..self.heights.len() {
            let path = &new.paths[k];
            let cut: Vec<&[(Point3<f64>, Vector3<f64>)]> = before.iter().map(|b| b.paths[k].as_slice()).collect();
            for i in self.chords / 4..=3 * self.chords / 4 {
                // At its end a chord leaves the loop by the largest angle, to the side that makes the arc longer.
                let way = path[i].0 - path[i - 1].0;
                largest =
                    largest.max(engagement(&path[i], &way, &cut, [self.radius, self.tolerance], self.limits.milling));
            }
        }
        largest
    }
}

/// Arc from the side of the material to the first place of the circle of the cutter that paths before do not reach,
/// radians; `tolerance` is how much nearer to the material they may end.
fn engagement(
    (centre, axis): &(Point3<f64>, Vector3<f64>),
    way: &Vector3<f64>,
    cut: &[&[(Point3<f64>, Vector3<f64>)]],
    [radius, tolerance]: [f64; 2],
    milling: Milling,
) -> f64 {
    /// Angle behind the direction of feed at which the search begins, and its steps, radians.
    const BEHIND: f64 = PI / 3.0;
    const STEP: f64 = PI / 24.0;
    const BISECTIONS: u32 = 5;
    let Some(feed) = (way - axis * way.dot(axis)).try_normalize(1e-9) else { return 0.0 };
    let right = feed.cross(axis);
    let side = if milling == Milling::Climb { right } else { -right };
    let flat = |p: &Point3<f64>| Point2::new((p - centre).dot(&feed), (p - centre).dot(&side));
    let paths: Vec<Vec<Point2<f64>>> = cut.iter().map(|path| path.iter().map(|p| flat(&p.0)).collect()).collect();
    let reached = |angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        let place = Point2::new(radius * cos, radius * sin);
        let near = radius - tolerance;
        paths.iter().any(|path| path.windows(2).any(|w| distance_squared(&place, w) <= near * near))
    };
    // From the rear on: the first place on the circle with material.
    let count = ((FRAC_PI_2 + BEHIND) / STEP).ceil() as usize;
    let angle = |k: usize| -BEHIND + (FRAC_PI_2 + BEHIND) * k as f64 / count as f64;
    let Some(first) = (0..=count).find(|k| !reached(angle(*k))) else { return 0.0 };
    let (mut free, mut met) = (angle(first.saturating_sub(1)), angle(first));
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (free + met);
        if reached(middle) { free = middle } else { met = middle }
    }
    FRAC_PI_2 - free
}

/// Square of the distance of a point from a chord.
fn distance_squared(p: &Point2<f64>, chord: &[Point2<f64>]) -> f64 {
    let (from, way) = (chord[0], chord[1] - chord[0]);
    let length = way.norm_squared();
    let share = if length > 0.0 { ((p - from).dot(&way) / length).clamp(0.0, 1.0) } else { 0.0 };
    (from + way * share - p).norm_squared()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A round path about a place on the x axis, counter-clockwise, with the axis along z.
    fn circle(centre: f64, radius: f64) -> Vec<(Point3<f64>, Vector3<f64>)> {
        const CHORDS: u32 = 3600;
        let at = |k: u32| {
            let (sin, cos) = libm::sincos(TAU * f64::from(k) / f64::from(CHORDS));
            (Point3::new(centre + radius * cos, radius * sin, 0.0), Vector3::z())
        };
        (0..=CHORDS).map(at).collect()
    }

    /// A cutter of radius 1 on round loops, in front of them: the border of the material is a circle about the centre of the
    /// loop before. On loops of a large radius the arc is that of a straight line, acos(1 - a_e / R).
    #[test]
    fn round_loops_have_the_arc_of_two_circles() {
        for (loops, distance) in [(0.5, 0.1), (1.0, 0.3), (2.0, 0.4), (1000.0, 0.5)] {
            let (before, new) = (circle(0.0, loops), circle(distance, loops));
            let ahead: f64 = loops + distance;
            let closed_form = (((loops + 1.0).powi(2) - ahead * ahead - 1.0) / (2.0 * ahead)).acos();
            for (milling, way) in [(Milling::Climb, Vector3::y()), (Milling::Conventional, -Vector3::y())] {
                let arc = engagement(&new[0], &way, &[before.as_slice()], [1.0, 0.0], milling);
                println!(
                    "{loops} {distance}: {:.2} deg, by closed form {:.2}",
                    arc.to_degrees(),
                    closed_form.to_degrees()
                );
                assert!(arc >= closed_form - 1e-3 && arc < closed_form + 0.01, "{arc} {closed_form}");
            }
            // What the machine leaves of the loop before counts as material.
            let arc = engagement(&new[0], &Vector3::y(), &[before.as_slice()], [1.0, 0.05], Milling::Climb);
            assert!(arc > closed_form + 0.02, "{arc} {closed_form}");
        }
        let straight =
            engagement(&circle(0.5, 1e3)[0], &Vector3::y(), &[&circle(0.0, 1e3)], [1.0, 0.0], Milling::Climb);
        assert!((straight - 0.5_f64.acos()).abs() < 0.01, "{straight}");
    }
}
