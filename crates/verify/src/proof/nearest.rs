//! Queries to the hierarchy of a sweep: the pieces nearest to a point, and the pieces that may be below a cutoff.

use super::cutoff::Cutoff;
use super::hierarchy::Node;
use super::sweep::{MIN_AXIS_DISTANCE, Nearest, Sweep, TURN_SLACK};
use nalgebra::{Point3, Vector3};
use tool_stock::collide::Slope;

/// Largest error of the distance that [`Sweep::near`] finds, mm: it may find nothing where a piece is this much nearer than the
/// cutoff.
pub(crate) const NEAR_ERROR: f64 = 5e-3;

/// Size of the stack of nodes: a binary tree over at most 2^32 pieces.
const STACK_DEPTH: usize = 64;

/// Lower bound of the distance to all poses of a node near a point: `value` at the point, with the gradient `slope`.
struct NodeBound {
    value: f64,
    slope: Vector3<f64>,
}

/// Distance of a point to the cutter over a piece.
#[derive(Clone, Copy)]
pub(crate) struct NearPiece {
    /// Index of the piece.
    pub(crate) index: u32,
    /// Share of the piece.
    pub(crate) t: f64,
    /// Signed distance there, mm.
    pub(crate) distance: f64,
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

    /// A piece over which the cutter holds a point, if there is one; `likely` is tried first.
    pub(crate) fn holding(&self, p: &Point3<f64>, likely: Option<u32>) -> Option<u32> {
        let holds = |index: u32| self.least(index, p, 0.0, TURN_SLACK).is_some();
        if let Some(index) = likely.filter(|index| holds(*index)) {
            return Some(index);
        }
        let mut found = None;
        self.descend(p, 0.0, |index, _| {
            if found.is_none() && holds(index) {
                found = Some(index);
            }
            // The first one is enough.
            if found.is_some() { f64::NEG_INFINITY } else { 0.0 }
        });
        found
    }

    /// A piece nearest to a point up to [`NEAR_ERROR`], by one evaluation per piece; `None` where no piece is nearer than `cutoff`
    /// less this error.
    pub(crate) fn near(&self, p: &Point3<f64>, cutoff: f64) -> Option<NearPiece> {
        let mut best = None;
        self.descend(p, cutoff - NEAR_ERROR, |index, least| {
            let near = self.quick_distance(index, p);
            if near.distance - NEAR_ERROR < least {
                best = Some(near);
            }
            near.distance - NEAR_ERROR
        });
        best
    }

    /// Approximate least distance of a point to the cutter over a piece, never less than the true one.
    pub(crate) fn quick_distance(&self, index: u32, p: &Point3<f64>) -> NearPiece {
        if let Some((ball, _, foot)) = self.bearing_ball(index, p) {
            return NearPiece { index, t: foot.t, distance: foot.length - ball.radius };
        }
        let piece = self.piece(index);
        let touch = self.minimum(piece, self.touch(piece, 0.5, p), p, (0.0, 1.0));
        NearPiece { index, t: touch.t, distance: touch.value }
    }

    /// Visits the pieces that may be nearer to a point than `least`, the nearest first by the bounds of the hierarchy.
    /// `visit` receives the least distance so far and returns a new one.
    fn descend(&self, p: &Point3<f64>, mut least: f64, mut visit: impl FnMut(u32, f64) -> f64) {
        let nodes = &self.hierarchy.nodes;
        let mut stack = [(0, 0.0); STACK_DEPTH];
        stack[0] = (0, self.node_bound(&nodes[0], p, 0.0, least).value);
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
            let [a, b] =
                [node.child, node.child + 1].map(|c| (c, self.node_bound(&nodes[c as usize], p, 0.0, least).value));
            // The nearer child goes on top of the stack and is visited first.
            for child in if a.1 <= b.1 { [b, a] } else { [a, b] } {
                if child.1 < least && top < stack.len() {
                    stack[top] = child;
                    top += 1;
                }
            }
        }
    }

    /// Visits the pieces that may be below a cutoff anywhere, by the bounds of the hierarchy.
    pub(crate) fn gather(&self, cutoff: &Cutoff<'_>, visit: &mut impl FnMut(u32)) {
        let hull = cutoff.hull();
        let enough = cutoff.highest() + hull.radius;
        let nodes = &self.hierarchy.nodes;
        let mut stack = [0; STACK_DEPTH];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let node: &Node = &nodes[stack[top] as usize];
            let lower = self.node_bound(node, &hull.centre, hull.radius, enough);
            if cutoff.hides(lower.value, &lower.slope, 1.0) {
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

    /// Largest radius of the cutter, mm: no point lies deeper inside of the cutter.
    pub(crate) fn widest(&self) -> f64 {
        self.hierarchy.size.width
    }

    /// Lower bound of the distance to the cutter in all poses of a node, for points within a radius of `p`. The search
    /// for a better bound ends at `enough`.
    fn node_bound(&self, node: &Node, p: &Point3<f64>, radius: f64, enough: f64) -> NodeBound {
        let out = p - node.centre;
        let length = out.norm();
        let half_width = |slope: &Vector3<f64>| -> f64 { node.sides.iter().map(|side| side.dot(slope).abs()).sum() };
        let mut support = NodeBound { value: f64::NEG_INFINITY, slope: Vector3::zeros() };
        if length > 0.0 {
            let slope = out / length;
            let max_upward = slope.dot(&node.axis) + node.turn;
            let least = length - half_width(&slope);
            if let Some(ball) = self.ball().filter(|ball| max_upward <= ball.upper) {
                return NodeBound { value: least - ball.radius, slope };
            }
            let size = &self.hierarchy.size;
            support = NodeBound { value: least - size.width - size.length * max_upward.max(0.0), slope };
            if support.value >= enough {
                return support;
            }
        }
        let s = out.dot(&node.axis);
        let radial = out - node.axis * s;
        let rho = radial.norm();
        let Slope { value, rho: outward, s: upward } = self.solid().cutter_slope(rho, s + self.hierarchy.size.height);
        let slope = radial * (outward / rho.max(MIN_AXIS_DISTANCE)) + node.axis * upward;
        // The angle of a chord of at most one exceeds the chord by less than a twentieth.
        let turn = if node.turn <= 1.0 { 1.05 * node.turn } else { std::f64::consts::PI };
        let lever = (rho * upward - s * outward).abs() + node.reach + radius;
        let second = 0.5 * turn * turn * (length + node.reach + radius);
        let value = value - half_width(&slope) - turn * lever - second;
        if value > support.value { NodeBound { value, slope } } else { support }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;
    use five_axis::{AxisLine, Carries, Chain, Pose, RotaryPose};
    use nalgebra::Unit;
    use tool_stock::collide::{Cutter, ToolSolid, tool::tool_coordinates};

    fn solids() -> Vec<ToolSolid> {
        let cutters = [
            Cutter::flat(4.0),
            Cutter::ball(3.0),
            Cutter::bull(4.0, 1.0),
            Cutter::tapered_ball(1.5, 0.1),
            Cutter::barrel(5.0, 40.0, 1.0),
            Cutter::lollipop(3.0),
        ];
        let solid = |cutter| ToolSolid { cutter, flute_length: 20.0, shank: Vec::new(), holder: Vec::new() };
        cutters.map(solid).to_vec()
    }

    /// Two chains: rotary axes at a right angle, and at 45 deg.
    fn chains() -> [Chain; 2] {
        let line = |carries, direction: [f64; 3]| AxisLine {
            carries,
            direction: Unit::new_normalize(Vector3::from(direction)),
            point: Point3::origin(),
        };
        let nutating = [line(Carries::Tool, [1.0, 0.0, 1.0]), line(Carries::Part, [0.0, 0.0, 1.0])];
        [Chain::tilting_table(), Chain::new(nutating).unwrap()]
    }

    /// Lines of a swaying tool, and long paths between them.
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

    /// No pose of a node is nearer to a point, or to points around it, than the bound of the node.
    #[test]
    fn bounds_of_nodes_against_poses() {
        let mut close = 0;
        for (solid, chain) in solids().iter().flat_map(|s| chains().map(|c| (s.clone(), c))) {
            let sweep = Sweep::through(&solid, &chain, &poses()).unwrap();
            for p in points() {
                for node in &sweep.hierarchy.nodes {
                    let lower = sweep.node_bound(node, &p, 2.0, f64::INFINITY);
                    assert!(lower.slope.norm() <= 1.0 + 1e-12);
                    let mut least = f64::INFINITY;
                    for index in (node.range.0..node.range.1).step_by(1 + (node.range.1 - node.range.0) as usize / 16) {
                        for t in [0.0, 0.3, 1.0] {
                            let Pose { tip, axis } = sweep.piece(index).pose(t);
                            for way in [Vector3::zeros(), Vector3::x(), -Vector3::y(), Vector3::z(), -lower.slope] {
                                let (rho, s) = tool_coordinates(&(p + way * 2.0), &tip, &axis);
                                let over = solid.cutter_distance(rho, s) - lower.slope.dot(&way) * 2.0;
                                assert!(over >= lower.value - 1e-9, "{:?}: {over} under {}", solid.cutter, lower.value);
                                least = least.min(over);
                            }
                        }
                    }
                    close += u32::from(least - lower.value < 0.1);
                }
            }
        }
        // The bounds are not trivial.
        assert!(close > 1000, "{close}");
    }

    /// The hierarchy finds the same nearest distance as an evaluation of all pieces.
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
                // A search that goes farther by the error misses no piece.
                assert!(sweep.near(&p, least + 1e-9 + NEAR_ERROR).is_some(), "{:?}: {least}", solid.cutter);
                let near = sweep.near(&p, f64::INFINITY).unwrap().distance;
                assert!((near - least).abs() < 2.0 * NEAR_ERROR, "{:?}: {near} for {least}", solid.cutter);
            }
        }
    }
}
