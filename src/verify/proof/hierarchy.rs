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
use super::piece::Piece;
use crate::collide::ToolSolid;
use nalgebra::{Point3, Vector3};

/// Pieces in a leaf.
const LEAF: usize = 4;

/// Length by which directions weigh against positions when pieces are grouped: about half an engaged cutter, mm.
const ARM: f64 = 15.0;

/// Pieces from which on halves of a node are built at once on several threads.
const APART: usize = 4096;

/// Of about how many pieces of a node the ways are looked at along which its box lies.
const SOME: usize = 128;

/// What rounding may take from a box of centres, mm.
const ROUNDING: f64 = 1e-9;

/// The tools of all pieces below lie near one pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// Box that holds the centres of all poses below: its middle, its half sides, and half its diagonal.
    pub(crate) centre: Point3<f64>,
    pub(crate) sides: [Vector3<f64>; 3],
    pub(crate) reach: f64,
    /// Mean axis, and the largest turn of any pose from it, as a chord of unit axes.
    pub(crate) axis: Vector3<f64>,
    pub(crate) turn: f64,
    /// Pieces from..to; an inner node has its children at `child` and `child + 1`.
    pub(crate) range: (u32, u32),
    pub(crate) child: u32,
}

/// Nodes over sorted pieces, the root first.
#[derive(Clone, Debug)]
pub(crate) struct Hierarchy {
    pub(crate) nodes: Vec<Node>,
    pub(crate) size: Size,
}

/// Measures of a cutter, mm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    /// Height of the centres over the tip.
    pub(crate) height: f64,
    /// Length above them.
    pub(crate) length: f64,
    /// Largest radius.
    pub(crate) width: f64,
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

impl Hierarchy {
    /// Over the pieces of a tool, and the order that they are to be sorted into; `centres` are the ways of the middle of
    /// its tip over them.
    pub(crate) fn over(solid: &ToolSolid, pieces: &[Piece], centres: &[Capsule]) -> (Self, Vec<u32>) {
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
