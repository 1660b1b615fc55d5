//! The hierarchy over the pieces of a sweep: excludes pieces far from a point or a cell, node by node.
//!
//! The centre of a pose is the centre of the tip ball, or the corner at the tip. Each node has a box with the centres
//! of all of its poses. Two lower bounds of the distance f to the cutter are available. Each uses one direction n,
//! since passes that follow a surface deviate little across the surface:
//!
//! - From the support h of the cutter: f >= n . (p - c) - h for every centre c. As long as the cutter is its ball in
//!   this direction in all poses, h is the radius of the tip ball; elsewhere h is the width of the cutter plus the
//!   share of its length.
//! - From the mean pose: let F be the distance to the cutter in the mean pose, n its gradient at a point q in the frame
//!   of that pose, and q' the point in the frame of another pose. Then f >= F + n . (q' - q). The box bounds the
//!   deviation of the centre; a turn by an angle w moves q by w |n x q| along n; the rest is of second order.

use super::capsule::Capsule;
use super::piece::Piece;
use nalgebra::{Point3, Vector3};
use tool_stock::collide::ToolSolid;

/// Length of a vector below which any direction serves for the box of a node, mm.
const MIN_VECTOR_LENGTH: f64 = 1e-12;

/// Length of a sum of axes below which they have no mean.
const MIN_AXIS_SUM: f64 = 1e-9;

/// Pieces in a leaf.
const PIECES_PER_LEAF: usize = 4;

/// Length that weighs directions against positions when pieces are grouped: about half an engaged cutter, mm.
const DIRECTION_WEIGHT: f64 = 15.0;

/// Number of pieces from which on both halves of a node are built on several threads.
const MIN_PARALLEL_PIECES: usize = 4096;

/// Approximate number of pieces of a node from which the directions of its box are derived.
const BOX_DIRECTION_PIECES: usize = 128;

/// Reserve of a box of centres for rounding, mm.
const CENTRE_ROUNDING: f64 = 1e-9;

/// A node: the tools of all of its pieces are near one pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// Box with the centres of all poses of the node: its middle, its half sides, and half its diagonal.
    pub(crate) centre: Point3<f64>,
    pub(crate) sides: [Vector3<f64>; 3],
    pub(crate) reach: f64,
    /// Mean axis, and the largest turn of a pose from it, as a chord of unit axes.
    pub(crate) axis: Vector3<f64>,
    pub(crate) turn: f64,
    /// Range of pieces; an inner node has its children at `child` and `child + 1`.
    pub(crate) range: (u32, u32),
    pub(crate) child: u32,
}

/// Nodes over sorted pieces; the root is the first.
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
    /// Length of the cutter above the centres.
    pub(crate) length: f64,
    /// Largest radius.
    pub(crate) width: f64,
}

/// Properties of a piece for the hierarchy.
#[derive(Clone, Copy, Debug)]
struct PieceLeg {
    /// Tip and axis in the middle.
    middle: Vector3<f64>,
    axis: Vector3<f64>,
    /// Half of the turn, radians.
    turn: f64,
    /// Centres at both ends, and the largest distance of the others from this segment.
    ends: [Vector3<f64>; 2],
    flaw: f64,
    /// Index in the order of time.
    piece: u32,
}

impl Hierarchy {
    /// Builds the hierarchy over the pieces of a tool, and returns the order into which they are to be sorted.
    /// `centres` are the paths of the centres over the pieces.
    pub(crate) fn over(solid: &ToolSolid, pieces: &[Piece], centres: &[Capsule]) -> (Self, Vec<u32>) {
        let height = solid.cutter.tip_radius();
        let width = solid.cutter.widest_below(solid.flute_length);
        let size = Size { height, length: (solid.flute_length - height).max(0.0), width: width.max(height) };
        let of = |(k, (piece, centres)): (usize, (&Piece, &Capsule))| PieceLeg {
            middle: piece.middle().tip.coords,
            axis: piece.middle().axis,
            turn: piece.half().turn,
            ends: centres.ends().map(|c| c.coords),
            flaw: centres.flaw(),
            piece: u32::try_from(k).unwrap_or(u32::MAX),
        };
        let mut legs: Vec<PieceLeg> = pieces.iter().zip(centres).enumerate().map(of).collect();
        let mut nodes = vec![node(&[], 0); 1 + below(legs.len())];
        if let Some((root, rest)) = nodes.split_first_mut() {
            build(&mut legs, 0, root, rest, 1);
        }
        (Self { nodes, size }, legs.iter().map(|leg| leg.piece).collect())
    }
}

/// Number of nodes below a node with a number of pieces.
fn below(count: usize) -> usize {
    if count <= PIECES_PER_LEAF { 0 } else { 2 + below(count / 2) + below(count - count / 2) }
}

/// Bounds of a run of pieces; `start` is the index of its first piece.
fn node(legs: &[PieceLeg], start: usize) -> Node {
    let axis = legs.iter().map(|l| l.axis).sum::<Vector3<f64>>().try_normalize(MIN_AXIS_SUM).unwrap_or_else(Vector3::z);
    // The chord of unit vectors is shorter than the angle; the half turns of the pieces are added to the chord.
    let turn = legs.iter().map(|l| (l.axis - axis).norm() + l.turn).fold(0.0, f64::max);
    let (centre, sides) = bounding_box(legs);
    let reach = sides.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
    let index = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    Node { centre, sides, reach, axis, turn, range: (index(start), index(start + legs.len())), child: 0 }
}

/// A box about the centres of pieces. Its first direction points from their mean to the farthest centre, its second to
/// the centre farthest across the first. A selection of many pieces gives the directions; the box holds all of them.
fn bounding_box(legs: &[PieceLeg]) -> (Point3<f64>, [Vector3<f64>; 3]) {
    let some = || legs.iter().step_by(legs.len().div_ceil(BOX_DIRECTION_PIECES).max(1)).flat_map(|leg| leg.ends);
    let mean = some().sum::<Vector3<f64>>() / some().count().max(1) as f64;
    let longer = |a: Vector3<f64>, b: Vector3<f64>| if b.norm_squared() > a.norm_squared() { b } else { a };
    let farthest = some().map(|c| c - mean).fold(Vector3::zeros(), longer);
    let x = farthest.try_normalize(MIN_VECTOR_LENGTH).unwrap_or_else(Vector3::x);
    let across = some().map(|c| c - mean).map(|w| w - x * x.dot(&w)).fold(Vector3::zeros(), longer);
    let y = across.try_normalize(MIN_VECTOR_LENGTH).unwrap_or_else(|| {
        let other = if x.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
        x.cross(&other).normalize()
    });
    let axes = [x, y, x.cross(&y)];
    let ends = legs.iter().flat_map(|leg| leg.ends);
    let ranges = ranges(ends.map(|c| axes.map(|a| a.dot(&(c - mean)))));
    let flaw = legs.iter().map(|l| l.flaw).fold(0.0, f64::max);
    let middle: Vector3<f64> = (0..3).map(|k| axes[k] * (0.5 * (ranges[k][0] + ranges[k][1]))).sum();
    // The axes are orthogonal unit vectors apart from rounding, for which the box has a reserve.
    let sides = std::array::from_fn(|k| axes[k] * (0.5 * (ranges[k][1] - ranges[k][0]) + flaw + CENTRE_ROUNDING));
    (Point3::from(mean + middle), sides)
}

/// Least and greatest value of each coordinate.
fn ranges<const N: usize>(places: impl Iterator<Item = [f64; N]>) -> [[f64; 2]; N] {
    places.fold([[f64::INFINITY, f64::NEG_INFINITY]; N], |mut ranges, place| {
        for (range, x) in ranges.iter_mut().zip(place) {
            *range = [if x < range[0] { x } else { range[0] }, if x > range[1] { x } else { range[1] }];
        }
        ranges
    })
}

/// Builds the node `own` of pieces; `start` is the index of the first piece. More pieces than a leaf holds are split at
/// the median of the widest of the tip and axis coordinates. `rest` takes the nodes below; `first` is the index of the
/// first of them.
fn build(legs: &mut [PieceLeg], start: usize, own: &mut Node, rest: &mut [Node], first: usize) {
    let count = legs.len();
    *own = node(legs, start);
    let [left, right, rest @ ..] = rest else { return };
    own.child = u32::try_from(first).unwrap_or(u32::MAX);
    let keys = |l: &PieceLeg| {
        let (p, a) = (&l.middle, l.axis * DIRECTION_WEIGHT);
        [p.x, p.y, p.z, a.x, a.y, a.z]
    };
    let widths = ranges(legs.iter().map(keys)).map(|[low, high]| high - low);
    // The first of the widest coordinates.
    let widest = (0..6).fold(0, |best, k| if widths[k] > widths[best] { k } else { best });
    let half = count / 2;
    let key = |l: &PieceLeg| if widest < 3 { l.middle[widest] } else { l.axis[widest - 3] };
    legs.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.piece.cmp(&b.piece)));
    let (low, high) = legs.split_at_mut(half);
    let (below_left, below_right) = rest.split_at_mut(below(half));
    let next = first + 2;
    let next_right = next + below_left.len();
    let mut one = || build(low, start, left, below_left, next);
    let mut other = || build(high, start + half, right, below_right, next_right);
    if count < MIN_PARALLEL_PIECES {
        one();
        other();
    } else {
        rayon::join(one, other);
    }
}
