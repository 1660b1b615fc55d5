//! What differs for the machine between two motions of one job, operation by operation.
//!
//! Each motion is a way of tool poses in the frame of the part. Each place of one way is compared with the nearest place of
//! the other way that follows the last one found, and the other way round. So it does not matter how a text divides the way
//! into blocks, nor by which joints a machine reaches the poses.

use five_axis::{Machine, between};
use ir::{Motion, MotionOperation, MoveKind, Program};
use nalgebra::{Point3, Vector3};
use serde::Serialize;

/// Largest distance of neighbouring places of a way, mm, and largest turn of the rotary axes between them, radians.
const PLACE_SPACING_MM: f64 = 1.0;
const PLACE_TURN_RAD: f64 = 0.005;

/// Path length within which the nearest place is searched, mm, and the least number of pieces.
const LOOK_AHEAD_MM: f64 = 3.0;
const MIN_PIECES_AHEAD: usize = 8;

/// Distance from which a path counts as lost, mm. At the next change between rapid, link and cut it is searched in the whole
/// rest of the operation.
const LOST_DISTANCE_MM: f64 = 0.5;

/// Length that makes turns and distances alike where the nearest place is chosen, mm.
const TURN_LENGTH_MM: f64 = 10.0;

/// Tip motion of a piece from which its speed is compared, mm.
const MIN_TIP_MOTION_MM: f64 = 0.01;

/// Differences up to which two texts are the same for the machine: distance of tips, mm, angle of axes, degrees, share of the
/// speed, share of the time of an operation. Words of NC texts end at 0.1 um and 1e-8 of a vector; feeds at their third
/// digit.
const EQUAL_WITHIN: [f64; 4] = [5e-4, 1e-3, 5e-3, 2e-3];

/// A motion with its program.
#[derive(Clone, Copy)]
pub struct ComparedMotion<'a> {
    /// Job and machine.
    pub program: &'a Program,
    /// Motion, operation by operation.
    pub motion: &'a Motion,
}

/// A largest difference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Difference {
    /// Value.
    pub value: f64,
    /// The moves of both motions.
    pub moves: [u32; 2],
    /// Tip in the first motion, part frame, mm.
    pub tip: [f64; 3],
}

impl Difference {
    fn or(self, other: Self) -> Self {
        if other.value > self.value { other } else { self }
    }
}

/// What differs in an operation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OperationDifference {
    /// Name.
    pub name: String,
    /// Largest distance of the tips, mm.
    pub tip: Difference,
    /// Largest angle between the tool axes, degrees.
    pub axis: Difference,
    /// Largest difference of the speeds of the tips at feed, as a share of the larger one.
    pub speed: Difference,
    /// Number of moves of both motions.
    pub moves: [usize; 2],
    /// Times of cuts, links and rapids in the runs of both controls, s.
    pub times: [[f64; 3]; 2],
    /// Times that feeds and rapids of both texts command, s: two controls run the same text in different times.
    pub programmed: [f64; 2],
    /// Least and largest position of each axis of both motions, mm and radians; without a head Z is that of the tip.
    pub ranges: [[[f64; 2]; 5]; 2],
}

impl OperationDifference {
    /// The differences that are more than the digits of NC texts, with what differs.
    pub fn beyond_digits(&self) -> impl Iterator<Item = (&'static str, Difference)> {
        let each = [("tips", self.tip), ("tool axes", self.axis), ("speeds", self.speed)];
        each.into_iter().zip(EQUAL_WITHIN).filter(|((_, d), same)| d.value > *same).map(|(d, _)| d)
    }

    /// True where the machine does the same, within the digits of NC texts.
    pub fn is_same(&self) -> bool {
        let all = self.programmed;
        let time = (all[0] - all[1]).abs() <= EQUAL_WITHIN[3] * all[0].max(all[1]).max(1.0);
        time && self.beyond_digits().next().is_none()
    }
}

/// Times of cuts, links and rapids of an operation in the run of the control, s.
pub type RunTimes<'a> = &'a dyn Fn(&ComparedMotion<'_>, usize) -> [f64; 3];

/// Compares two motions of the operations of one job. Operations that only one motion has are left out. `run` gives the
/// times of an operation by its index.
pub fn compare(sides: [ComparedMotion<'_>; 2], run: RunTimes<'_>) -> Vec<OperationDifference> {
    let [first, second] = sides;
    first
        .motion
        .operations
        .iter()
        .zip(&second.motion.operations)
        .enumerate()
        .map(|(index, (a, b))| operation([first, second], [a, b], [first, second].map(|side| run(&side, index))))
        .collect()
}

fn operation(sides: [ComparedMotion<'_>; 2], made: [&MotionOperation; 2], times: [[f64; 3]; 2]) -> OperationDifference {
    let ways = [0, 1].map(|k: usize| way(&sides[k].program.machine, made[k]));
    let [tip, axis, speed] = largest([&ways[0], &ways[1]]);
    let swapped = largest([&ways[1], &ways[0]]).map(|d| Difference { moves: [d.moves[1], d.moves[0]], ..d });
    let range = |k: usize| {
        let (o, Program { machine, tools, operations, .. }) = (made[k], sides[k].program);
        let length = tools[operations[o.operation].tool].length();
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 5];
        for joints in o.moves.iter().map(|m| machine.travelled(&m.joints, length)) {
            for (of_axis, at) in range.iter_mut().zip(joints) {
                *of_axis = [of_axis[0].min(at), of_axis[1].max(at)];
            }
        }
        range
    };
    OperationDifference {
        name: sides[0].program.operations[made[0].operation].name.clone(),
        tip: tip.or(swapped[0]),
        axis: axis.or(swapped[1]),
        speed: speed.or(swapped[2]),
        moves: made.map(|o| o.moves.len()),
        programmed: made.map(|o| o.moves.iter().map(|m| m.time).sum()),
        times,
        ranges: [0, 1].map(range),
    }
}

/// A place of a way, at the end of a piece of a move.
struct WayPlace {
    tip: Point3<f64>,
    axis: Vector3<f64>,
    /// Move to the place, and its kind.
    index: u32,
    kind: MoveKind,
    /// Speed of the tip on the piece before the place, mm/s.
    speed: f64,
}

impl WayPlace {
    /// Tip and axis in one space.
    fn difference(&self, other: &Self) -> (Vector3<f64>, Vector3<f64>) {
        (other.tip - self.tip, (other.axis - self.axis) * TURN_LENGTH_MM)
    }
}

/// The way of an operation in places that are near to each other.
fn way(machine: &Machine, operation: &MotionOperation) -> Vec<WayPlace> {
    let mut places = Vec::new();
    let Some(start) = operation.moves.first() else { return places };
    let pose = machine.forward(&start.joints);
    places.push(WayPlace { tip: pose.tip, axis: pose.axis, index: 0, kind: start.kind, speed: 0.0 });
    for (pair, index) in operation.moves.windows(2).zip(1_u32..) {
        let (from, to) = (pair[0].joints, pair[1].joints);
        let tips = [from, to].map(|joints| machine.forward(&joints).tip);
        let length = (tips[1] - tips[0]).norm();
        let count =
            (length / PLACE_SPACING_MM).max(machine.turn(from.rotary, to.rotary) / PLACE_TURN_RAD).ceil().max(1.0);
        let speed = if pair[1].time > 0.0 { length / pair[1].time } else { 0.0 };
        places.extend((1..=count as usize).map(|k| {
            let t = k as f64 / count;
            let axis = machine.chain.tool_axis(between(from.rotary, to.rotary, t));
            WayPlace { tip: tips[0] + (tips[1] - tips[0]) * t, axis, index, kind: pair[1].kind, speed }
        }));
    }
    places
}

/// Where a way is nearest to a place.
#[derive(Clone, Copy)]
struct Found {
    /// Place at the end of the piece.
    end: usize,
    /// Share of the piece.
    share: f64,
    /// Square of the distance, turns included.
    square: f64,
}

/// The nearest place of a piece of a way.
fn on_piece(way: &[WayPlace], end: usize, place: &WayPlace) -> Found {
    let (from, to) = (&way[end - 1], &way[end]);
    let (a, b) = from.difference(to);
    let (c, d) = from.difference(place);
    let length = a.norm_squared() + b.norm_squared();
    let share = if length > 0.0 { ((a.dot(&c) + b.dot(&d)) / length).clamp(0.0, 1.0) } else { 0.0 };
    let square = (c - a * share).norm_squared() + (d - b * share).norm_squared();
    Found { end, share, square }
}

/// The nearest place of some pieces, of equal ones the first; and the pieces that are as near within the digits of NC texts, in
/// their order. A way that goes back on itself comes to a place twice, and goes on from the first time.
fn nearest(way: &[WayPlace], ends: impl Iterator<Item = usize>, place: &WayPlace) -> Option<(Found, Vec<Found>)> {
    let mut all: Vec<Found> = ends.map(|end| on_piece(way, end, place)).collect();
    let best = all.iter().copied().reduce(|a, b| if b.square < a.square { b } else { a })?;
    let as_near = best.square.sqrt() + EQUAL_WITHIN[0];
    all.retain(|found| found.square.sqrt() <= as_near);
    Some((best, all))
}

/// Largest distance of tips, angle of axes and difference of speeds at the places of the first way.
fn largest([first, second]: [&[WayPlace]; 2]) -> [Difference; 3] {
    let mut found = [Difference::default(); 3];
    if first.is_empty() || second.len() < 2 {
        return found;
    }
    // Places and middles of pieces: speeds are those of pieces.
    let mut last = 1;
    for k in 0..first.len() {
        let middle = k.checked_sub(1).map(|before| {
            let (from, to) = (&first[before], &first[k]);
            let axis = (from.axis + to.axis) * 0.5;
            WayPlace {
                tip: from.tip + (to.tip - from.tip) * 0.5,
                axis,
                index: to.index,
                kind: to.kind,
                speed: to.speed,
            }
        });
        for (place, moves) in middle.iter().map(|m| (m, true)).chain([(&first[k], false)]) {
            let mut run = 0.0;
            let ahead = (last..second.len()).enumerate().take_while(|(n, end)| {
                let within = run <= LOOK_AHEAD_MM || *n < MIN_PIECES_AHEAD;
                run += (second[*end].tip - second[end - 1].tip).norm();
                within
            });
            let Some(mut near) = nearest(second, ahead.map(|a| a.1), place) else { continue };
            let changes = k > 0 && first[k].kind != first[k - 1].kind;
            if near.0.square > LOST_DISTANCE_MM * LOST_DISTANCE_MM && changes {
                near = nearest(second, last..second.len(), place).unwrap_or(near);
            }
            let (at, near) = near;
            last = near.first().map_or(at.end, |first| first.end);
            let (from, to) = (&second[at.end - 1], &second[at.end]);
            let tip = from.tip + (to.tip - from.tip) * at.share;
            let axis = from.axis + (to.axis - from.axis) * at.share;
            let differs =
                |value: f64| Difference { value, moves: [place.index, to.index], tip: place.tip.coords.into() };
            found[0] = found[0].or(differs((place.tip - tip).norm()));
            found[1] = found[1].or(differs(axis.angle(&place.axis).to_degrees()));
            let piece = k.checked_sub(1).map_or(0.0, |before| (first[k].tip - first[before].tip).norm());
            let at_feed = place.kind != MoveKind::Rapid && to.kind != MoveKind::Rapid;
            let inside = |at: &&Found| (0.01..=0.99).contains(&at.share);
            if moves && at_feed && piece > MIN_TIP_MOTION_MM && inside(&&at) {
                let speeds = near.iter().filter(inside).map(|at| second[at.end].speed);
                let share = |speed: f64| (place.speed - speed).abs() / place.speed.max(speed).max(f64::MIN_POSITIVE);
                found[2] = found[2].or(differs(speeds.map(share).fold(f64::INFINITY, f64::min)));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tool that leaves on the way on which it came, faster, is at each place twice. Rounding makes the second time nearer now
    /// and then.
    #[test]
    fn a_way_that_goes_back_on_itself_is_the_same_as_itself() {
        let place = |k: u32, depth: f64, speed: f64| WayPlace {
            tip: Point3::new(0.1 * f64::from(k / 20), 0.3, -0.7 * depth / 3.0),
            axis: Vector3::z(),
            index: k,
            kind: MoveKind::Cut,
            speed,
        };
        let stroke = |n: u32| {
            let down = (0..10).map(move |k| place(20 * n + k, 0.1 * f64::from(k), 1.0));
            down.chain((0..10).map(move |k| place(20 * n + 10 + k, 0.9 - 0.1 * f64::from(k), 5.0)))
        };
        let way: Vec<WayPlace> = (0..5).flat_map(stroke).collect();
        let [tip, axis, speed] = largest([&way, &way]);
        assert!(tip.value < 1e-9 && axis.value < 1e-5 && speed.value < 1e-9, "{tip:?} {axis:?} {speed:?}");
    }
}
