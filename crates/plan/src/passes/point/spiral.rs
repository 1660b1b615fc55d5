//! One line round a vane, from the shroud down to the fillets, without leaving it.
//!
//! ```text
//! outlet                                inlet
//!   ---- pressure face, u from 1 to 0 ----\
//!  /                                       | rolls round both corners of the edge
//!   ---- suction face, u from 0 to 1 -----/
//! ```
//!
//! Round the vane the other way, the faces change places: the sense of milling says which.
//!
//! The level falls evenly over each turn. The step of a turn is the one allowed at the place with the longest path from
//! shroud to fillet. No ridge is therefore higher than required, and turns lie closer where vanes are lower. The first
//! turn keeps the level of the shroud, the last turn that of the fillets.

use crate::passes::context::STATIONS;
use crate::passes::lines::{DriveSurface, SurfaceLine};
use ir::CcPoint;
use nalgebra::Vector3;
use wheel::part::chart::{Chart, Shape};

/// Levels at which the steps of a turn are computed.
const TURN_LEVELS: usize = 400;

/// Places along a face at which the steps of a turn are computed.
const TURN_PLACES: usize = 60;

/// Stations of the roll about a corner of an edge, and of the path from corner to corner: 1.5 deg per step, over which
/// a ball of some millimetres leaves its circle by 0.1 um.
const ROLL: [usize; 2] = [64, 16];

/// Surfaces that a spiral runs round: pressure and suction face, edges at inlet and outlet.
pub(crate) struct Around<'a> {
    pub(crate) faces: [&'a dyn DriveSurface; 2],
    pub(crate) edges: &'a [Chart<'a>; 2],
    /// Lowest level.
    pub(crate) low: f64,
    /// True when the tool runs to the inlet on the suction face, and to the outlet on the pressure face.
    pub(crate) other_way: bool,
}

/// A spiral: its stations, and its turns on each face for the measurement of ridges.
pub(crate) struct Spiral {
    pub(crate) points: Vec<CcPoint>,
    pub(crate) turns: [Vec<SurfaceLine>; 2],
}

impl Around<'_> {
    /// Number of turns, and the level after each share of them; `density` gives the steps per unit of y on a face.
    fn levels(&self, density: &(dyn Fn(usize, f64, f64) -> f64 + Sync)) -> (usize, Vec<f64>) {
        let y = |k: usize| 1.0 - (1.0 - self.low) * k as f64 / TURN_LEVELS as f64;
        let steepest = |y: f64| {
            let places = (0..=TURN_PLACES).map(|i| i as f64 / TURN_PLACES as f64);
            places.flat_map(|x| [density(0, x, y), density(1, x, y)]).fold(0.0, f64::max)
        };
        let at: Vec<f64> = (0..=TURN_LEVELS).map(|k| steepest(y(k))).collect();
        let mut sum = vec![0.0];
        for k in 0..TURN_LEVELS {
            sum.push(sum[k] + 0.5 * (at[k] + at[k + 1]) * (y(k) - y(k + 1)));
        }
        let turns = sum[TURN_LEVELS].ceil().max(1.0) as usize;
        let share = |t: f64| {
            let wanted = t * sum[TURN_LEVELS];
            let k = sum.partition_point(|s| *s <= wanted).clamp(1, TURN_LEVELS) - 1;
            let part = (wanted - sum[k]) / (sum[k + 1] - sum[k]).max(f64::MIN_POSITIVE);
            y(k) + (y(k + 1) - y(k)) * part
        };
        (turns, (0..=TURN_LEVELS).map(|k| share(k as f64 / TURN_LEVELS as f64)).collect())
    }

    /// Lays the spiral with leads of the given lengths, mm.
    pub(crate) fn lay(&self, density: &(dyn Fn(usize, f64, f64) -> f64 + Sync), leads: [f64; 2]) -> Spiral {
        let (turns, levels) = self.levels(density);
        // Level after a number of turns; the first and the last turn have constant levels.
        let level = |turn: f64| {
            let at = ((turn - 1.0) / turns as f64).clamp(0.0, 1.0) * TURN_LEVELS as f64;
            let k = (at as usize).min(TURN_LEVELS - 1);
            levels[k] + (levels[k + 1] - levels[k]) * (at - k as f64)
        };
        let shares = self.shares();
        let mut spiral = Spiral { points: Vec::new(), turns: [Vec::new(), Vec::new()] };
        for turn in 0..turns + 2 {
            let mut begin = 0.0;
            for (portion, share) in shares.iter().enumerate() {
                let y = |t: f64| level(turn as f64 + begin + share * t);
                match portion {
                    0 | 2 => {
                        let side = if self.other_way { 1 - portion / 2 } else { portion / 2 };
                        let mut on_surface: Vec<(f64, CcPoint)> = (0..=STATIONS)
                            .map(|i| {
                                let t = i as f64 / STATIONS as f64;
                                // Towards the inlet on the first face, away from it on the second one.
                                let x = if portion == 0 { 1.0 - t } else { t };
                                (x, self.faces[side].contact(x, y(t), 0.0))
                            })
                            .map(|(x, p)| (x, CcPoint { w: 2.0 * side as f64, ..p }))
                            .collect();
                        spiral.points.extend(on_surface.iter().map(|p| p.1));
                        if portion == 0 {
                            on_surface.reverse();
                        }
                        spiral.turns[side].push(SurfaceLine::whole(on_surface));
                    }
                    // The last turn ends on the second face.
                    _ if portion == 3 && turn == turns + 1 => {}
                    _ => self.round_edge(portion / 2, &y, &mut spiral.points),
                }
                begin += share;
            }
        }
        self.lead(&mut spiral.points, leads);
        spiral
    }

    /// Shares of a turn, by the lengths at the middle level: pressure face, inlet edge, suction face, outlet edge.
    fn shares(&self) -> [f64; 4] {
        let middle = 0.5 * (1.0 + self.low);
        let along = |side: usize| {
            let at = |i: usize| self.faces[side].contact(i as f64 / TURN_PLACES as f64, middle, 0.0).position;
            (0..TURN_PLACES).map(|i| (at(i + 1) - at(i)).norm()).sum::<f64>()
        };
        let across = |end: usize| {
            (self.edges[end].place(middle, 1.0).position - self.edges[end].place(middle, 0.0).position).norm()
        };
        let lengths = [along(0), across(0), along(1), across(1)];
        let whole: f64 = lengths.iter().sum();
        lengths.map(|l| l / whole)
    }

    /// Stations round an edge, from the face on which the tool comes.
    fn round_edge(&self, end: usize, y: &dyn Fn(f64) -> f64, points: &mut Vec<CcPoint>) {
        let [roll, path] = ROLL;
        let count = 2 * roll + path;
        let x = if end == 0 { 0.0 } else { 1.0 };
        let [from, to] = if (end == 0) == self.other_way { [1, 0] } else { [0, 1] };
        let normal_of = |side: usize, y: f64| -> Vector3<f64> { self.faces[side].contact(x, y, 0.0).normal };
        for i in 1..count {
            let t = i as f64 / count as f64;
            let level = y(t);
            // From the side of the incoming tool.
            let across = ((i as f64 - roll as f64) / path as f64).clamp(0.0, 1.0);
            let place = self.edges[end].place(level, if from == 0 { across } else { 1.0 - across });
            let normal = if i < roll {
                normal_of(from, level).slerp(&place.normal, i as f64 / roll as f64)
            } else if i > roll + path {
                place.normal.slerp(&normal_of(to, level), (i - roll - path) as f64 / roll as f64)
            } else {
                place.normal
            };
            let v = self.faces[from].contact(x, level, 0.0).v;
            let round = if self.other_way { 1.0 - t } else { t };
            let w = 2.0 * (x + round);
            points.push(CcPoint { u: x, v, w, position: place.position, normal });
        }
    }

    /// Straight leads: extensions of the first and of the last two stations.
    fn lead(&self, points: &mut Vec<CcPoint>, leads: [f64; 2]) {
        let on = |a: &CcPoint, b: &CcPoint, length: f64| {
            let path = (b.position - a.position).normalize() * length;
            self.faces[0].off_hub(CcPoint { position: b.position + path, ..*b })
        };
        let [first, second, .., before, last] = points.as_slice() else { return };
        let (enters, leaves) = (on(second, first, leads[0]), on(before, last, leads[1]));
        points.insert(0, enters);
        points.push(leaves);
    }
}
