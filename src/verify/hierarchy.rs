//! The hierarchy over the pieces of a sweep: what lies far from a point or a cell is put aside by the node.
//!
//! Each node knows a box about a point of the axis of the tool in all of its poses, the centre of the ball or the corner at
//! the tip. It bounds the distance to the cutter from below in one of two ways, both along one direction n, since passes
//! that follow a surface hardly stray across it:
//!
//! - by the support h of the cutter: f >= n . (p - c) - h for every centre c, where h is the radius of a ball at the tip as
//!   long as the cutter is its ball in that direction in all poses, and elsewhere its width and what its length adds;
//! - by its mean pose: with F the distance to the cutter there, n its slope at a point q as seen from there, and q' the
//!   point as seen from another pose, f >= F + n . (q' - q). The centre strays by the box; a turn by an angle w moves q
//!   by w |n x q| along n, and what is left is of second order.

use super::capsule::Capsule;
use super::ceiling::Ceiling;
use super::sweep::{Nearest, Piece, Sweep, TURN_SLACK};
use crate::collide::{Slope, ToolSolid};
use nalgebra::{Point3, Vector3};

/// Pieces in a leaf.
const LEAF: usize = 4;

/// Length by which directions weigh against positions when pieces are grouped: about half an engaged cutter, mm.
const ARM: f64 = 15.0;

/// Pieces from which on halves of a node are built at once on several threads.
const APART: usize = 4096;

/// How much nearer something may come than what [`Sweep::near`] finds, mm.
const ENOUGH: f64 = 5e-3;

/// Of about how many pieces of a node the ways are looked at along which its box lies.
const SOME: usize = 128;

/// What rounding may take from a box of centres, mm.
const ROUNDING: f64 = 1e-9;

/// Nodes that wait on the way down: a halving tree over at most 2^32 pieces.
const DEPTH: usize = 64;

/// The tools of all pieces below lie near one pose.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Box that holds the centres of all poses below: its middle, its half sides, and half its diagonal.
    centre: Point3<f64>,
    sides: [Vector3<f64>; 3],
    reach: f64,
    /// Mean axis, and the largest turn of any pose from it, as a chord of unit axes.
    axis: Vector3<f64>,
    turn: f64,
    /// Pieces from..to; an inner node has its children at `child` and `child + 1`.
    range: (u32, u32),
    child: u32,
}

/// Nodes over sorted pieces, the root first.
#[derive(Clone, Debug)]
pub(super) struct Hierarchy {
    nodes: Vec<Node>,
    size: Size,
}

/// Measures of a cutter, mm.
#[derive(Clone, Copy, Debug)]
struct Size {
    /// Height of the centres over the tip.
    height: f64,
    /// Length above them.
    length: f64,
    /// Largest radius.
    width: f64,
}

/// What the hierarchy asks of a piece.
#[derive(Clone, Copy, Debug)]
struct Leg {
    /// Tip and axis in the middle.
    middle: Vector3<f64>,
    axis: Vector3<f64>,
    /// Half of the turn.
    turn: f64,
    /// Centres at both ends, and how far those between leave their segment.
    ends: [Vector3<f64>; 2],
    flaw: f64,
    /// Index in the order of time.
    piece: u32,
}

/// What is known of the distance to all poses of a node about a point: at least `value`, and it grows along `slope`.
struct Floor {
    value: f64,
    slope: Vector3<f64>,
}

impl Hierarchy {
    /// Over the pieces of a tool, and the order that they are to be sorted into; `centres` are the ways of the middle of
    /// its tip over them.
    pub(super) fn over(solid: &ToolSolid, pieces: &[Piece], centres: &[Capsule]) -> (Self, Vec<u32>) {
        let height = solid.cutter.tip_radius();
        let width = solid.cutter.widest_below(solid.flute_length);
        let size = Size { height, length: (solid.flute_length - height).max(0.0), width: width.max(height) };
        let of = |(k, (piece, centres)): (usize, (&Piece, &Capsule))| Leg {
            middle: piece.middle().0.coords,
            axis: piece.middle().1,
            turn: piece.reach().1,
            ends: centres.ends().map(|c| c.coords),
            flaw: centres.flaw(),
            piece: u32::try_from(k).unwrap_or(u32::MAX),
        };
        let mut legs: Vec<Leg> = pieces.iter().zip(centres).enumerate().map(of).collect();
        let mut nodes = vec![node(&[], 0); 1 + below(legs.len())];
        if let Some((root, rest)) = nodes.split_first_mut() {
            build(&mut legs, 0, root, rest, 1);
        }
        (Self { nodes, size }, legs.iter().map(|leg| leg.piece).collect())
    }
}

impl Sweep<'_> {
    /// Least distance below `cutoff` of a point to the swept cutter.
    pub fn nearest(&self, p: &Point3<f64>, cutoff: f64) -> Option<Nearest> {
        let mut best = None;
        self.descend(p, cutoff, |index, least| match self.least(index, p, least, TURN_SLACK) {
            Some(touch) => {
                best = Some(Nearest { distance: touch.value, at: self.at(index) });
                touch.value
            }
            None => least,
        });
        best
    }

    /// A piece that comes nearest to a point but for [`ENOUGH`], as far as one look at each shows, the share at which it
    /// does, and the distance; none where none comes nearer than `cutoff`.
    pub(super) fn near(&self, p: &Point3<f64>, cutoff: f64) -> Option<(u32, f64, f64)> {
        let mut best = None;
        self.descend(p, cutoff - ENOUGH, |index, least| {
            let (t, value) = self.quick_distance(index, p);
            if value - ENOUGH < least {
                best = Some((index, t, value));
            }
            value - ENOUGH
        });
        best
    }

    /// About how near a point comes to the cutter over a piece, no nearer than it does, and the share there.
    pub(super) fn quick_distance(&self, index: u32, p: &Point3<f64>) -> (f64, f64) {
        if let Some((ball, _, foot)) = self.bearing_ball(index, p) {
            return (foot.t, foot.length - ball.radius);
        }
        let piece = self.piece(index);
        let touch = self.minimum(piece, self.touch(piece, 0.5, p), p, (0.0, 1.0));
        (touch.t, touch.value)
    }

    /// Visits the pieces that may come nearer to a point than `least`, the nearest first as far as the hierarchy knows;
    /// a visit gets what is least by now and returns what may be less.
    fn descend(&self, p: &Point3<f64>, mut least: f64, mut visit: impl FnMut(u32, f64) -> f64) {
        let nodes = &self.hierarchy.nodes;
        let mut stack = [(0, 0.0); DEPTH];
        stack[0] = (0, self.floor(&nodes[0], p, 0.0, least).value);
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (index, bound) = stack[top];
            if bound >= least {
                continue;
            }
            let node: &Node = &nodes[index as usize];
            if node.child == 0 {
                for index in node.range.0..node.range.1 {
                    least = least.min(visit(index, least));
                }
                continue;
            }
            let [a, b] = [node.child, node.child + 1].map(|c| (c, self.floor(&nodes[c as usize], p, 0.0, least).value));
            // The nearer child last, so that it is visited first.
            for child in if a.1 <= b.1 { [b, a] } else { [a, b] } {
                if child.1 < least && top < stack.len() {
                    stack[top] = child;
                    top += 1;
                }
            }
        }
    }

    /// Visits the pieces that may come under a ceiling anywhere, as far as the hierarchy knows.
    pub(super) fn gather(&self, ceiling: &Ceiling<'_>, visit: &mut impl FnMut(u32)) {
        let hull = ceiling.hull();
        let enough = ceiling.highest() + hull.radius;
        let nodes = &self.hierarchy.nodes;
        let mut stack = [0; DEPTH];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let node: &Node = &nodes[stack[top] as usize];
            let floor = self.floor(node, &hull.centre, hull.radius, enough);
            if ceiling.hides(floor.value, &floor.slope, 1.0) {
                continue;
            }
            if node.child == 0 {
                (node.range.0..node.range.1).for_each(&mut *visit);
            } else if top + 2 <= stack.len() {
                (stack[top], stack[top + 1]) = (node.child + 1, node.child);
                top += 2;
            }
        }
    }

    /// Largest radius of the cutter, mm: no point lies deeper inside of it.
    pub(super) fn widest(&self) -> f64 {
        self.hierarchy.size.width
    }

    /// Bound of the distance to the cutter in all poses of a node, for points within a radius of one, not the best where
    /// one of at least `enough` is at hand.
    fn floor(&self, node: &Node, p: &Point3<f64>, radius: f64, enough: f64) -> Floor {
        let out = p - node.centre;
        let length = out.norm();
        let stray = |slope: &Vector3<f64>| -> f64 { node.sides.iter().map(|side| side.dot(slope).abs()).sum() };
        let mut support = Floor { value: f64::NEG_INFINITY, slope: Vector3::zeros() };
        if length > 0.0 {
            let slope = out / length;
            let upmost = slope.dot(&node.axis) + node.turn;
            let least = length - stray(&slope);
            if let Some(ball) = self.ball().filter(|ball| upmost <= ball.upper) {
                return Floor { value: least - ball.radius, slope };
            }
            let size = &self.hierarchy.size;
            support = Floor { value: least - size.width - size.length * upmost.max(0.0), slope };
            if support.value >= enough {
                return support;
            }
        }
        let s = out.dot(&node.axis);
        let radial = out - node.axis * s;
        let rho = radial.norm();
        let Slope { value, rho: outward, s: upward } = self.solid().cutter_slope(rho, s + self.hierarchy.size.height);
        let slope = radial * (outward / rho.max(1e-12)) + node.axis * upward;
        // The angle of a chord of up to one is less than a twentieth more.
        let turn = if node.turn <= 1.0 { 1.05 * node.turn } else { std::f64::consts::PI };
        let lever = (rho * upward - s * outward).abs() + node.reach + radius;
        let second = 0.5 * turn * turn * (length + node.reach + radius);
        let value = value - stray(&slope) - turn * lever - second;
        if value > support.value { Floor { value, slope } } else { support }
    }
}

/// Nodes below one over a number of pieces.
fn below(count: usize) -> usize {
    if count <= LEAF { 0 } else { 2 + below(count / 2) + below(count - count / 2) }
}

/// Bounds of a run of pieces that starts at `start` of all pieces.
fn node(legs: &[Leg], start: usize) -> Node {
    let axis = legs.iter().map(|l| l.axis).sum::<Vector3<f64>>().try_normalize(1e-9).unwrap_or_else(Vector3::z);
    // The chord of unit vectors bounds from below what the half turns of pieces add to.
    let turn = legs.iter().map(|l| (l.axis - axis).norm() + l.turn).fold(0.0, f64::max);
    let (centre, sides) = bounding_box(legs);
    let reach = sides.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
    let index = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    Node { centre, sides, reach, axis, turn, range: (index(start), index(start + legs.len())), child: 0 }
}

/// A box about the centres of some pieces: along the way from their mean to the farthest of them, and along the farthest
/// way across that. Of many pieces some show these ways; the box holds all.
fn bounding_box(legs: &[Leg]) -> (Point3<f64>, [Vector3<f64>; 3]) {
    let some = || legs.iter().step_by(legs.len().div_ceil(SOME).max(1)).flat_map(|leg| leg.ends);
    let mean = some().sum::<Vector3<f64>>() / some().count().max(1) as f64;
    let longer = |a: Vector3<f64>, b: Vector3<f64>| if b.norm_squared() > a.norm_squared() { b } else { a };
    let farthest = some().map(|c| c - mean).fold(Vector3::zeros(), longer);
    let x = farthest.try_normalize(1e-12).unwrap_or_else(Vector3::x);
    let across = some().map(|c| c - mean).map(|w| w - x * x.dot(&w)).fold(Vector3::zeros(), longer);
    let y = across.try_normalize(1e-12).unwrap_or_else(|| {
        let other = if x.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
        x.cross(&other).normalize()
    });
    let axes = [x, y, x.cross(&y)];
    let ends = legs.iter().flat_map(|leg| leg.ends);
    let ranges = ranges(ends.map(|c| axes.map(|a| a.dot(&(c - mean)))));
    let flaw = legs.iter().map(|l| l.flaw).fold(0.0, f64::max);
    let middle: Vector3<f64> = (0..3).map(|k| axes[k] * (0.5 * (ranges[k][0] + ranges[k][1]))).sum();
    // Axes that are square and of length one but for rounding hold the box but for rounding.
    let sides = std::array::from_fn(|k| axes[k] * (0.5 * (ranges[k][1] - ranges[k][0]) + flaw + ROUNDING));
    (Point3::from(mean + middle), sides)
}

/// Least and most of each of some coordinates.
fn ranges<const N: usize>(places: impl Iterator<Item = [f64; N]>) -> [[f64; 2]; N] {
    places.fold([[f64::INFINITY, f64::NEG_INFINITY]; N], |mut ranges, place| {
        for (range, x) in ranges.iter_mut().zip(place) {
            *range = [if x < range[0] { x } else { range[0] }, if x > range[1] { x } else { range[1] }];
        }
        ranges
    })
}

/// Builds the node `own` of pieces, the first of them `start` of all. More than a leaf is split by the widest of tip and
/// axis coordinates; `rest` takes the nodes below, the first of them `first` of all.
fn build(legs: &mut [Leg], start: usize, own: &mut Node, rest: &mut [Node], first: usize) {
    let count = legs.len();
    *own = node(legs, start);
    let [left, right, rest @ ..] = rest else { return };
    own.child = u32::try_from(first).unwrap_or(u32::MAX);
    let keys = |l: &Leg| {
        let (p, a) = (&l.middle, l.axis * ARM);
        [p.x, p.y, p.z, a.x, a.y, a.z]
    };
    let widths = ranges(legs.iter().map(keys)).map(|[low, high]| high - low);
    // The first of the widest.
    let widest = (0..6).fold(0, |best, k| if widths[k] > widths[best] { k } else { best });
    let half = count / 2;
    let key = |l: &Leg| if widest < 3 { l.middle[widest] } else { l.axis[widest - 3] };
    legs.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.piece.cmp(&b.piece)));
    let (low, high) = legs.split_at_mut(half);
    let (below_left, below_right) = rest.split_at_mut(below(half));
    let next = first + 2;
    let next_right = next + below_left.len();
    let mut one = || build(low, start, left, below_left, next);
    let mut other = || build(high, start + half, right, below_right, next_right);
    if count < APART {
        one();
        other();
    } else {
        rayon::join(one, other);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;
    use crate::collide::{Cutter, tool::tool_coordinates};
    use crate::kin::{AxisLine, Carries, Chain, RotaryPose};
    use nalgebra::Unit;

    fn solids() -> Vec<ToolSolid> {
        let cutters = [
            Cutter::Flat { radius: 4.0 },
            Cutter::Ball { radius: 3.0 },
            Cutter::Bull { radius: 4.0, corner: 1.0 },
            Cutter::TaperedBall { ball: 1.5, half_angle: 0.1 },
            Cutter::Barrel { radius: 5.0, barrel: 40.0, tip: 1.0 },
            Cutter::Lollipop { radius: 3.0 },
        ];
        let solid = |cutter| ToolSolid { cutter, flute_length: 20.0, shank: Vec::new(), holder: Vec::new() };
        cutters.map(solid).to_vec()
    }

    /// Axes at a right angle, and at 45 deg.
    fn chains() -> [Chain; 2] {
        let line = |carries, direction: [f64; 3]| AxisLine {
            carries,
            direction: Unit::new_normalize(Vector3::from(direction)),
            point: Point3::origin(),
        };
        let nutating = [line(Carries::Tool, [1.0, 0.0, 1.0]), line(Carries::Part, [0.0, 0.0, 1.0])];
        [Chain::tilting_table(), Chain::new(nutating).unwrap()]
    }

    /// Lines of a swaying tool, and long ways between them.
    fn poses() -> Vec<RotaryPose> {
        (0..240)
            .map(|k| {
                let (line, x) = (f64::from(k / 24), f64::from(k % 24));
                let tip = Point3::new(x, 1.5 * line + (0.3 * x).sin(), (0.4 * x).cos());
                RotaryPose { tip, rotary: [0.4 + 0.5 * (0.2 * x + line).sin(), 0.3 * line + 0.05 * x] }
            })
            .collect()
    }

    fn points() -> impl Iterator<Item = Point3<f64>> {
        (0..60).map(f64::from).map(|k: f64| {
            Point3::new(
                40.0 * (k * 0.618).fract() - 8.0,
                30.0 * (k * 0.414).fract() - 7.0,
                24.0 * (k * 0.732).fract() - 6.0,
            )
        })
    }

    /// No pose below a node brings the cutter nearer to a point, or to points about it, than its bound.
    #[test]
    fn bounds_of_nodes_against_poses() {
        let mut close = 0;
        for (solid, chain) in solids().iter().flat_map(|s| chains().map(|c| (s.clone(), c))) {
            let sweep = Sweep::through(&solid, &chain, &poses()).unwrap();
            for p in points() {
                for node in &sweep.hierarchy.nodes {
                    let floor = sweep.floor(node, &p, 2.0, f64::INFINITY);
                    assert!(floor.slope.norm() <= 1.0 + 1e-12);
                    let mut least = f64::INFINITY;
                    for index in (node.range.0..node.range.1).step_by(1 + (node.range.1 - node.range.0) as usize / 16) {
                        for t in [0.0, 0.3, 1.0] {
                            let (tip, axis) = sweep.piece(index).pose(t);
                            for way in [Vector3::zeros(), Vector3::x(), -Vector3::y(), Vector3::z(), -floor.slope] {
                                let (rho, s) = tool_coordinates(&(p + way * 2.0), &tip, &axis);
                                let over = solid.cutter_distance(rho, s) - floor.slope.dot(&way) * 2.0;
                                assert!(over >= floor.value - 1e-9, "{:?}: {over} under {}", solid.cutter, floor.value);
                                least = least.min(over);
                            }
                        }
                    }
                    close += u32::from(least - floor.value < 0.1);
                }
            }
        }
        // The bounds are of use.
        assert!(close > 1000, "{close}");
    }

    /// What the hierarchy finds nearest is the nearest of all pieces one by one.
    #[test]
    fn nearest_against_all_pieces() {
        for (solid, chain) in solids().iter().flat_map(|s| chains().map(|c| (s.clone(), c))) {
            let sweep = Sweep::through(&solid, &chain, &poses()).unwrap();
            let count = sweep.hierarchy.nodes[0].range.1;
            for p in points() {
                let one_by_one = (0..count).filter_map(|k| sweep.least(k, &p, f64::INFINITY, TURN_SLACK));
                let least = one_by_one.map(|touch| touch.value).fold(f64::INFINITY, f64::min);
                let found = sweep.nearest(&p, f64::INFINITY).unwrap().distance;
                assert!((found - least).abs() <= TURN_SLACK, "{:?}: {found} for {least}", solid.cutter);
                let (_, _, near) = sweep.near(&p, f64::INFINITY).unwrap();
                assert!((near - least).abs() < 2.0 * ENOUGH, "{:?}: {near} for {least}", solid.cutter);
            }
        }
    }
}
