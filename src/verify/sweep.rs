//! The cutters of a whole program, swept over continuous time.
//!
//! Poses come from the joints by forward kinematics alone. Between moves the tip runs straight in the part frame and
//! the rotary axes run linearly. Moves are cut into pieces of at most one degree of turn; in such a piece the signed
//! distance of a fixed point to the moving convex cutter has one minimum in time (for a pure shift it is convex), which
//! golden section finds.

use crate::collide::{ToolSolid, tool::tool_coordinates};
use crate::ir::{Motion, MoveKind, Program};
use crate::kin::{Machine, transform::axis_at};
use nalgebra::{Point3, Vector3};

/// Largest turn of a piece.
const PIECE_TURN: f64 = std::f64::consts::PI / 180.0;

/// Longest way of the tip in a piece, mm: long links would lie in one node with everything that they pass.
const PIECE_LENGTH: f64 = 3.0;

/// Golden section steps: a piece of some millimetres shrinks to a tenth of a micrometre, where a round minimum is flat
/// far below a nanometre.
const GOLDEN_STEPS: u32 = 24;

/// Pieces in a leaf of the hierarchy.
const LEAF: usize = 4;

/// Length by which directions weigh against positions when pieces are grouped: about half an engaged cutter, mm.
const ARM: f64 = 15.0;

/// Where in the program something happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct At {
    /// Index of the operation in the motion.
    pub operation: u32,
    /// Index of the move that ends the piece.
    pub index: u32,
}

/// A part of one move.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Move that it belongs to.
    pub at: At,
    /// Kind of that move.
    pub kind: MoveKind,
    tips: [Point3<f64>; 2],
    rotary: [(f64, f64); 2],
    /// Middle pose.
    middle: (Point3<f64>, Vector3<f64>),
    /// Axis at both ends.
    axes: [Vector3<f64>; 2],
    /// Half of the tip's way, and half of the turn, radians.
    reach: (f64, f64),
}

impl Piece {
    /// Tip and axis at a share of the piece.
    pub fn pose(&self, t: f64) -> (Point3<f64>, Vector3<f64>) {
        let [(a0, c0), (a1, c1)] = self.rotary;
        (self.tips[0] + (self.tips[1] - self.tips[0]) * t, axis_at(a0 + (a1 - a0) * t, c0 + (c1 - c0) * t))
    }

    fn new(at: At, kind: MoveKind, tips: [Point3<f64>; 2], rotary: [(f64, f64); 2]) -> Self {
        let axes = rotary.map(|(a, c)| axis_at(a, c));
        let mut piece = Self { at, kind, tips, rotary, axes, middle: (tips[0], Vector3::z()), reach: (0.0, 0.0) };
        piece.middle = piece.pose(0.5);
        piece.reach = (0.5 * (tips[1] - tips[0]).norm(), 0.5 * turn(rotary));
        piece
    }

    /// The same for pieces of at most [`PIECE_TURN`]: the axis as the parabola through its ends and its middle, which
    /// leaves the true curve by less than 2e-7 there, 0.01 um at 50 mm over the tip.
    fn quick_pose(&self, t: f64) -> (Point3<f64>, Vector3<f64>) {
        let (w0, w1, w2) = ((1.0 - t) * (1.0 - 2.0 * t), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0));
        let axis = self.axes[0] * w0 + self.middle.1 * w1 + self.axes[1] * w2;
        (self.tips[0] + (self.tips[1] - self.tips[0]) * t, axis)
    }

    /// The two halves.
    pub fn halves(&self) -> [Self; 2] {
        let [(a0, c0), (a1, c1)] = self.rotary;
        let rotary = (0.5 * (a0 + a1), 0.5 * (c0 + c1));
        let tip = self.middle.0;
        [
            Self::new(self.at, self.kind, [self.tips[0], tip], [self.rotary[0], rotary]),
            Self::new(self.at, self.kind, [tip, self.tips[1]], [rotary, self.rotary[1]]),
        ]
    }

    /// Middle pose.
    pub fn middle(&self) -> &(Point3<f64>, Vector3<f64>) {
        &self.middle
    }

    /// Bound on how far a point of the tool at a distance from the tip moves from its middle position.
    pub fn displacement(&self, arm: f64) -> f64 {
        self.reach.0 + self.reach.1 * arm
    }
}

/// Upper bound of the turn of the axis between rotary positions: A and C turn about axes at right angles.
fn turn([(a0, c0), (a1, c1)]: [(f64, f64); 2]) -> f64 {
    (a1 - a0).hypot(c1 - c0)
}

/// Pieces of the moves of an operation, in order.
pub fn pieces(machine: &Machine, motion: &Motion, operation: usize) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let Some(moves) = motion.operations.get(operation).map(|o| &o.moves) else { return pieces };
    for (i, pair) in moves.windows(2).enumerate() {
        let at = At {
            operation: u32::try_from(operation).unwrap_or(u32::MAX),
            index: u32::try_from(i + 1).unwrap_or(u32::MAX),
        };
        let (from, to) = (&pair[0].joints, &pair[1].joints);
        let tips = [machine.forward(from).tip, machine.forward(to).tip];
        let turns = turn([(from.a, from.c), (to.a, to.c)]) / PIECE_TURN;
        let count = turns.max((tips[1] - tips[0]).norm() / PIECE_LENGTH).ceil().max(1.0);
        let tip = |t: f64| tips[0] + (tips[1] - tips[0]) * t;
        let rotary = |t: f64| (from.a + (to.a - from.a) * t, from.c + (to.c - from.c) * t);
        for k in 0..count as usize {
            let (t0, t1) = (k as f64 / count, (k + 1) as f64 / count);
            pieces.push(Piece::new(at, pair[1].kind, [tip(t0), tip(t1)], [rotary(t0), rotary(t1)]));
        }
    }
    pieces
}

/// Node of the hierarchy: the tools of all pieces below lie near one pose.
#[derive(Clone, Copy, Debug)]
struct Node {
    tip: Point3<f64>,
    axis: Vector3<f64>,
    /// Farthest tip, and largest turn (as a chord of unit axes), of any pose below.
    spread: (f64, f64),
    /// Pieces from..to; an inner node has its children at `child` and `child + 1`.
    range: (u32, u32),
    child: u32,
}

/// The cutter of one tool over all pieces of one operation.
#[derive(Clone, Debug)]
pub struct Sweep<'a> {
    solid: &'a ToolSolid,
    pieces: Vec<Piece>,
    nodes: Vec<Node>,
}

/// Least signed distance of a point to a swept cutter.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// Signed distance, negative inside.
    pub distance: f64,
    /// Where in the program.
    pub at: At,
    /// Index of the piece, a good first guess for a neighbouring point.
    pub piece: u32,
}

impl<'a> Sweep<'a> {
    /// Builds the hierarchy over the pieces of an operation.
    pub fn new(program: &'a Program, motion: &Motion, operation: usize) -> Option<Self> {
        let id = motion.operations.get(operation)?.operation;
        let solid = &program.tools[program.operations[id].tool].solid;
        let mut pieces = pieces(&program.machine, motion, operation);
        if pieces.is_empty() {
            return None;
        }
        let mut nodes = Vec::with_capacity(pieces.len());
        let count = pieces.len();
        nodes.push(node(&pieces, 0));
        build(&mut pieces, 0, count, 0, &mut nodes);
        Some(Self { solid, pieces, nodes })
    }

    /// Least distance below `cutoff` of a point to the swept cutter.
    pub fn nearest(&self, p: &Point3<f64>, cutoff: f64) -> Option<Nearest> {
        let mut best: Option<Nearest> = None;
        let mut least = cutoff;
        // Depth of a halving tree over at most 2^32 pieces.
        let mut stack: [(u32, f64); 64] = [(0, 0.0); 64];
        stack[0] = (0, self.bound(&self.nodes[0], p));
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (index, bound) = stack[top];
            if bound >= least {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.child == 0 {
                for index in node.range.0..node.range.1 {
                    self.visit(index, p, &mut least, &mut best);
                }
                continue;
            }
            let (a, b) = (node.child, node.child + 1);
            let (da, db) = (self.bound(&self.nodes[a as usize], p), self.bound(&self.nodes[b as usize], p));
            // The nearer child last, so that it is visited first.
            let (far, near) = if da <= db { ((b, db), (a, da)) } else { ((a, da), (b, db)) };
            for child in [far, near] {
                if child.1 < least && top < stack.len() {
                    stack[top] = child;
                    top += 1;
                }
            }
        }
        best
    }

    fn bound(&self, node: &Node, p: &Point3<f64>) -> f64 {
        let (rho, s) = tool_coordinates(p, &node.tip, &node.axis);
        self.solid.cutter_distance(rho, s) - node.spread.0 - node.spread.1 * (rho * rho + s * s).sqrt()
    }

    fn value(&self, piece: &Piece, t: f64, p: &Point3<f64>) -> f64 {
        let (tip, axis) = piece.quick_pose(t);
        let (rho, s) = tool_coordinates(p, &tip, &axis);
        self.solid.cutter_distance(rho, s)
    }

    /// Distance of a point to the cutter swept over one piece, given by [`Nearest::piece`] of this sweep.
    pub fn distance_to_piece(&self, piece: u32, p: &Point3<f64>) -> Option<Nearest> {
        let (mut least, mut best) = (f64::INFINITY, None);
        if (piece as usize) < self.pieces.len() {
            self.visit(piece, p, &mut least, &mut best);
        }
        best
    }

    /// Improves `least` and `best` by a piece.
    fn visit(&self, index: u32, p: &Point3<f64>, least: &mut f64, best: &mut Option<Nearest>) {
        let piece = &self.pieces[index as usize];
        let (tip, axis) = piece.middle;
        let (rho, s) = tool_coordinates(p, &tip, &axis);
        if self.solid.cutter_distance(rho, s) - piece.displacement((rho * rho + s * s).sqrt()) >= *least {
            return;
        }
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut low, mut high) = (0.0, 1.0);
        let (mut a, mut b) = (1.0 - golden, golden);
        let (mut fa, mut fb) = (self.value(piece, a, p), self.value(piece, b, p));
        let mut found = fa.min(fb).min(self.value(piece, 0.0, p)).min(self.value(piece, 1.0, p));
        // The distance changes at most this much over the whole piece.
        let slope = 2.0 * piece.displacement((rho * rho + s * s).sqrt() + piece.reach.0);
        for _ in 0..GOLDEN_STEPS {
            if found - slope * (high - low) >= *least {
                return;
            }
            if fa < fb {
                (high, b, fb) = (b, a, fa);
                a = high - golden * (high - low);
                fa = self.value(piece, a, p);
            } else {
                (low, a, fa) = (a, b, fb);
                b = low + golden * (high - low);
                fb = self.value(piece, b, p);
            }
            found = found.min(fa).min(fb);
        }
        if found < *least {
            *least = found;
            *best = Some(Nearest { distance: found, at: piece.at, piece: index });
        }
    }
}

/// Bounds of a run of pieces that starts at `start` of all pieces.
fn node(pieces: &[Piece], start: usize) -> Node {
    let count = pieces.len().max(1) as f64;
    let tip = Point3::from(pieces.iter().map(|p| p.middle.0.coords).sum::<Vector3<f64>>() / count);
    let axis = pieces.iter().map(|p| p.middle.1).sum::<Vector3<f64>>().try_normalize(1e-9).unwrap_or_else(Vector3::z);
    let mut spread = (0.0_f64, 0.0_f64);
    for p in pieces {
        spread.0 = spread.0.max((p.middle.0 - tip).norm() + p.reach.0);
        // The chord of unit vectors bounds from below; the displacement of a point at distance l under a turn by an
        // angle is at most the chord of that angle times l.
        spread.1 = spread.1.max((p.middle.1 - axis).norm() + p.reach.1);
    }
    let index = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    Node { tip, axis, spread, range: (index(start), index(start + pieces.len())), child: 0 }
}

/// Splits the pieces from..to of node `own` by the widest of tip and axis coordinates.
fn build(pieces: &mut [Piece], from: usize, to: usize, own: usize, nodes: &mut Vec<Node>) {
    if to - from <= LEAF {
        return;
    }
    let key = |p: &Piece, k: usize| if k < 3 { p.middle.0[k] } else { p.middle.1[k - 3] * ARM };
    let run = &mut pieces[from..to];
    let mut widest = (0, -1.0);
    for k in 0..6 {
        let (low, high) =
            run.iter().map(|p| key(p, k)).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        if high - low > widest.1 {
            widest = (k, high - low);
        }
    }
    let middle = run.len() / 2;
    run.select_nth_unstable_by(middle, |a, b| key(a, widest.0).total_cmp(&key(b, widest.0)).then(a.at.cmp(&b.at)));
    let cut = from + middle;
    let child = nodes.len();
    nodes.push(node(&pieces[from..cut], from));
    nodes.push(node(&pieces[cut..to], cut));
    nodes[own].child = u32::try_from(child).unwrap_or(u32::MAX);
    build(pieces, from, cut, child, nodes);
    build(pieces, cut, to, child + 1, nodes);
}
