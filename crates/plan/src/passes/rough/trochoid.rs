//! Trochoidal slots: loops across the channel, one behind the other, that open it with a bounded arc of engagement.
//!
//! A loop is an ellipse whose centre moves on along the channel, so that all loops make one smooth curve. Its front half
//! cuts, with the material on the side that `milling` names; its rear half returns through what is cut. Each loop goes on
//! as far as its arc of engagement allows, measured against the two loops before it at the tip and a step down above it,
//! since the tool axis turns along the channel. Across it the axis does not turn: rotary axes are slower than a loop.
//! Where no loop keeps to the arc, or the tool does not keep its allowances, the loops end, and the slot stays.
//!
//! Between two loops with the distance c, a front with the radius of curvature r, whose normal has the angle p to the
//! channel, has the arc acos(1 - c cos(p) (1 + R / r) / R), nearly. A flat front therefore takes more at a time, and a
//! sharp end takes less. With the half axis along the channel two thirds of that across, arc and length of a loop are
//! both near their best: of all ellipses, those with ratios of 0.6 to 0.7 have the least length of path for an opened
//! length, for widths from one to four radii of the tool.

use super::layers::Roughing;
use super::levels::LevelRun;
use super::run_map::{Place, RunMap};
use five_axis::Pose;
use ir::CcPoint;
use nalgebra::{Point3, Vector3};
use nurbs::bracket::Bracket;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;
use wheel::method::Milling;

/// Half axis of a loop along the channel, over that across it.
const FLATNESS: f64 = 2.0 / 3.0;

/// Half width that the loops open, and the least one for which there are loops, in radii of the tool. A narrower opening
/// needs more and shorter loops, which takes longer; a wider one takes longer than the lines beside it would.
const OPENED_RADII: f64 = 0.75;
const MIN_OPENED_RADII: f64 = 0.2;

/// Largest motion of a border of the strip of the loops outward, over the distance along the channel.
const MAX_BORDER_SLOPE: f64 = 0.3;

/// Least and largest distance of two loops, in radii of the tool.
const DISTANCES: [f64; 2] = [0.02, 1.0];

/// Halvings of the interval of distances: to a hundredth of the radius.
const DISTANCE_BISECTIONS: usize = 7;

/// Share of `tolerance rough` by which chords of a loop leave it at its ends. Two chords as one would leave it by more than
/// the tolerance everywhere, so that thinning keeps the chords for which the arc is computed.
const CHORD_SHARE: f64 = 0.4;

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
pub(super) struct OpenedSlot {
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
    /// Radius of the tool, and largest deviation of the machine from each loop, mm.
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

/// A loop: its places with tips and tool axes.
struct Loop {
    places: Vec<Place>,
    path: Vec<Pose>,
}

impl OpenedSlot {
    /// The loops of a run, from each of its ends that lies outside of the stock. They begin where the axes of the lines tilt in
    /// their direction.
    pub(super) fn new(roughing: &Roughing<'_>, run: &LevelRun, limits: Trochoid) -> Self {
        let most = OPENED_RADII * roughing.radius();
        let mut opening = Self { half: vec![0.0; run.stations.len()], loops: Vec::new() };
        let first = if RunMap::mean_tilt(roughing, run) < 0.0 { -1.0 } else { 1.0 };
        for forward in [first, -first] {
            let Some(map) = RunMap::new(roughing, run, forward, [FLATNESS * most, most]) else { continue };
            opening.add(map, roughing, run, limits, forward);
        }
        opening
    }

    /// Adds the loops from one end of the run.
    fn add(&mut self, mut map: RunMap<'_>, roughing: &Roughing<'_>, run: &LevelRun, limits: Trochoid, forward: f64) {
        let radius = roughing.radius();
        let [least, most] = [MIN_OPENED_RADII * radius, OPENED_RADII * radius];
        let count = run.stations.len();
        let order: Vec<usize> = if forward > 0.0 { (0..count).collect() } else { (0..count).rev().collect() };
        let open = if forward > 0.0 { run.open } else { [run.open[1], run.open[0]] };
        let free = map.halves();
        let reached = order.iter().take_while(|i| free[**i] >= least && self.half[**i] == 0.0).count();
        let reached = map.narrow(&order[..reached], [least, most], MAX_BORDER_SLOPE);
        if !open[0] || reached < 2 {
            return;
        }
        let piece = if forward > 0.0 { 0..reached } else { count - reached..count };
        let chords = (PI / libm::sqrt(2.0 * CHORD_SHARE * roughing.tolerance / most)).ceil().clamp(12.0, 64.0) as usize;
        let mut loops = Loops {
            half: map.halves(),
            stations: map.stations(),
            map,
            limits,
            radius,
            tolerance: roughing.tolerance,
            heights: [0.0, roughing.depth],
            within: [0.0; 2],
            forward,
            chords,
        };
        // At an end outside of the stock the loops go on; at another one they stay in the piece.
        let beyond = [true, reached == count && open[1]].map(|open| if open { 2.0 * most } else { -FLATNESS * most });
        let (all, to) = loops.open(&piece, if forward > 0.0 { beyond } else { [beyond[1], beyond[0]] });
        self.loops.extend(all);
        for (i, by) in loops.map.widening().enumerate().filter(|(i, _)| piece.contains(i)) {
            if (to - loops.stations[i]) * forward > 0.0 {
                self.half[i] = loops.half[i] / by;
            }
        }
    }
}

impl Loops<'_> {
    /// The loops over a piece, from its end outside of the stock to its other end, with the distances beyond both ends, mm;
    /// and the distance along the channel up to which they open it, mm.
    fn open(&mut self, piece: &Range<usize>, beyond: [f64; 2]) -> (Vec<Vec<CcPoint>>, f64) {
        self.within = [self.stations[piece.start], self.stations[piece.end - 1]];
        let ends = [self.within[0] - beyond[0], self.within[1] + beyond[1]];
        let [mut at, to] = if self.forward > 0.0 { ends } else { [ends[1], ends[0]] };
        let [least, most] = DISTANCES.map(|share| share * self.radius);
        let mut before = vec![self.curve(at - self.forward * least, least)];
        let mut all = Vec::new();
        while (to - at) * self.forward > 0.0 {
            let longest = |goes_on: bool| {
                let mut found = None;
                let border = Bracket { holds: least, fails: most }.halved(DISTANCE_BISECTIONS, |distance| {
                    let curve = self.next(at, distance, &before, goes_on);
                    let fits = curve.is_some();
                    found = curve.or(found.take());
                    fits
                });
                found.map(|curve| (curve, border.holds))
            };
            // In curves of the channel loops become shorter.
            let found = longest(true).or_else(|| longest(false));
            let Some((found, distance)) = found else { break };
            let stations: Option<Vec<CcPoint>> =
                found.places.iter().zip(&found.path).map(|(place, tool)| self.map.cc_point(*place, tool)).collect();
            let Some(stations) = stations else { break };
            all.push(stations);
            at += self.forward * distance;
            before.push(found);
            if before.len() > 2 {
                before.remove(0);
            }
        }
        let whole = (to - at) * self.forward <= 0.0;
        (all, if whole { self.forward * f64::INFINITY } else { at })
    }

    /// The next loop, where it keeps to the arc; if it `goes_on`, another one behind it at the same distance has to keep to the arc
    /// as well. The stock at the front of a loop depends more on the distance of the loop before than on its own.
    fn next(&self, at: f64, distance: f64, before: &[Loop], goes_on: bool) -> Option<Loop> {
        let keeps = |curve: &Loop, before: &[&Loop]| self.arc(curve, before) <= self.limits.engagement;
        let curve = self.curve(at, distance);
        let last: Vec<&Loop> = before.iter().collect();
        if !keeps(&curve, &last) {
            return None;
        }
        if !goes_on {
            return Some(curve);
        }
        let after = self.curve(at + self.forward * distance, distance);
        let both: Vec<&Loop> = before.last().into_iter().chain([&curve]).collect();
        keeps(&after, &both).then_some(curve)
    }

    /// The loop that begins with its rear at a distance along the channel, and ends as far beyond as given, mm.
    fn curve(&self, from: f64, distance: f64) -> Loop {
        // The material lies ahead of the front. A line that runs forward has it on the side of its wall; the front runs
        // a quarter turn beside this line.
        let sense = if self.limits.wall_forward == 1 { -1.0 } else { 1.0 };
        let at = |k: usize| {
            let share = k as f64 / self.chords as f64;
            let centre = from + self.forward * distance * share;
            let [x, y] = on_ellipse(share, self.half_at(centre));
            let place = self.map.place(centre, [self.forward * x, self.forward * sense * y]);
            (place, self.map.tool(centre, place))
        };
        let (places, path) = (0..=self.chords).map(at).unzip();
        Loop { places, path }
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
    fn arc(&self, new: &Loop, before: &[&Loop]) -> f64 {
        let cut: Vec<&[Pose]> = before.iter().map(|b| b.path.as_slice()).collect();
        let mut largest = 0.0_f64;
        for i in self.chords / 4..=3 * self.chords / 4 {
            // At its end a chord leaves the loop by the largest angle, to the side that makes the arc longer.
            let motion = new.path[i].tip - new.path[i - 1].tip;
            for height in self.heights {
                // The machine may leave this loop towards the material, and those before away from it.
                let nearer = 2.0 * self.tolerance;
                let arc = engagement(&new.path[i], &motion, height, &cut, self.radius, nearer, self.limits.milling);
                largest = largest.max(arc);
            }
            if largest > self.limits.engagement {
                break;
            }
        }
        largest
    }
}

/// Place on a loop after a share of its length, along the channel and across it from its centre, for its half width.
fn on_ellipse(share: f64, half: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(PI + TAU * share);
    [FLATNESS * half * cos, half * sin]
}

/// Arc from the side of the material to the first place of the circle of the cutter, `height` above its tip, that paths
/// before do not reach, radians; `tolerance` is how much nearer to the material they may end.
fn engagement(
    Pose { tip, axis }: &Pose,
    motion: &Vector3<f64>,
    height: f64,
    cut: &[&[Pose]],
    radius: f64,
    tolerance: f64,
    milling: Milling,
) -> f64 {
    /// Steps of the angle, radians.
    const STEP: f64 = PI / 24.0;
    const BISECTIONS: usize = 5;
    let Some(feed) = (motion - axis * motion.dot(axis)).try_normalize(1e-9) else { return 0.0 };
    let right = feed.cross(axis);
    let side = if milling == Milling::Climb { right } else { -right };
    let centre = tip + axis * height;
    let reached = |angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        let place = centre + (feed * cos + side * sin) * radius;
        let near = radius - tolerance;
        cut.iter().any(|path| path.windows(2).any(|w| reaches(&w[0], &w[1], &place, near)))
    };
    // From the other side on: the first place on the front of the circle with material.
    let count = (PI / STEP).ceil() as usize;
    let angle = |k: usize| -FRAC_PI_2 + PI * k as f64 / count as f64;
    let Some(first) = (0..=count).find(|k| !reached(angle(*k))) else { return 0.0 };
    let border = Bracket { holds: angle(first.saturating_sub(1)), fails: angle(first) };
    FRAC_PI_2 - border.halved(BISECTIONS, reached).holds
}

/// True when a cylinder above the tip, of a given radius, reaches a place on a chord of its path.
fn reaches(from: &Pose, to: &Pose, place: &Point3<f64>, radius: f64) -> bool {
    /// Thickness of what the end of a cutter leaves of a floor that counts as nothing, mm.
    const FLOOR_MM: f64 = 0.005;
    let axis = from.axis;
    let square = |v: Vector3<f64>| v - axis * v.dot(&axis);
    let (motion, to_place) = (to.tip - from.tip, place - from.tip);
    let flat = square(motion);
    let length = flat.norm_squared();
    let share = if length > 0.0 { (to_place.dot(&flat) / length).clamp(0.0, 1.0) } else { 0.0 };
    let from_tip = to_place - motion * share;
    square(from_tip).norm_squared() <= radius * radius && from_tip.dot(&axis) >= -FLOOR_MM
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A round path about a place on the x axis, counter-clockwise, with the axis along z.
    fn circle(centre: f64, radius: f64) -> Vec<Pose> {
        const CHORDS: u32 = 3600;
        let at = |k: u32| {
            let (sin, cos) = libm::sincos(TAU * f64::from(k) / f64::from(CHORDS));
            Pose { tip: Point3::new(centre + radius * cos, radius * sin, 0.0), axis: Vector3::z() }
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
            for (milling, motion) in [(Milling::Climb, Vector3::y()), (Milling::Conventional, -Vector3::y())] {
                let arc = engagement(&new[0], &motion, 0.0, &[before.as_slice()], 1.0, 0.0, milling);
                assert!(arc >= closed_form - 1e-3 && arc < closed_form + 0.01, "{arc} {closed_form}");
            }
            // What the machine leaves of the loop before counts as material.
            let arc = engagement(&new[0], &Vector3::y(), 0.0, &[before.as_slice()], 1.0, 0.05, Milling::Climb);
            assert!(arc > closed_form + 0.02, "{arc} {closed_form}");
        }
        let straight =
            engagement(&circle(0.5, 1e3)[0], &Vector3::y(), 0.0, &[&circle(0.0, 1e3)], 1.0, 0.0, Milling::Climb);
        assert!((straight - 0.5_f64.acos()).abs() < 0.01, "{straight}");
    }

    /// Loops in a straight channel, cut on a grid of points: at no place the points show a longer arc than the arc of the
    /// fronts, but for their distance.
    #[test]
    fn points_of_a_grid_show_no_longer_arc_than_the_loops_have() {
        const STEP: f64 = 0.02;
        const CHORDS: usize = 48;
        const HALF: f64 = 0.75;
        for distance in [0.1, 0.3] {
            let curve = |from: f64| -> Vec<Pose> {
                let at = |k: usize| {
                    let share = k as f64 / CHORDS as f64;
                    let [x, y] = on_ellipse(share, HALF);
                    Pose { tip: Point3::new(from + distance * share + x, y, 0.0), axis: Vector3::z() }
                };
                (0..=CHORDS).map(at).collect()
            };
            let loops: Vec<Vec<Pose>> = (0..8).map(|k| curve(f64::from(k) * distance)).collect();
            let mut points: Vec<Point3<f64>> = Vec::new();
            for i in 0..200 {
                points.extend((-100..=100).map(|j| Point3::new(f64::from(i) * STEP, f64::from(j) * STEP, 0.0)));
            }
            let (mut largest, mut by_points) = (0.0_f64, 0.0_f64);
            for (k, path) in loops.iter().enumerate() {
                for i in 1..=CHORDS {
                    let motion = path[i].tip - path[i - 1].tip;
                    let feed = motion.normalize();
                    // A climbing tool has the material on its right, seen along its axis from above.
                    let right = feed.cross(&Vector3::z());
                    let cut = |p: &Point3<f64>| reaches(&path[i - 1], &path[i], p, 1.0);
                    // The first loops cut their way in.
                    if k >= 4 {
                        let angle = |p: &Point3<f64>| {
                            let place = p - path[i].tip;
                            libm::atan2(place.dot(&right), place.dot(&feed))
                        };
                        let met = points.iter().filter(|p| cut(p)).map(angle);
                        let found = FRAC_PI_2 - met.fold(FRAC_PI_2, f64::min);
                        by_points = by_points.max(found);
                        let before = [loops[k - 2].as_slice(), loops[k - 1].as_slice()];
                        if (CHORDS / 4..=3 * CHORDS / 4).contains(&i) {
                            let arc = engagement(&path[i], &motion, 0.0, &before, 1.0, 0.0, Milling::Climb);
                            largest = largest.max(arc);
                        }
                    }
                    points.retain(|p| !cut(p));
                }
            }
            // A point counts when the chord reaches it, up to a chord before its end.
            assert!(by_points <= largest + 0.1 && by_points >= largest - 0.15, "{by_points} {largest}");
        }
    }
}
