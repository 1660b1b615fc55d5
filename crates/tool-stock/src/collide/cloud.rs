//! Sampled surfaces with a hierarchy, for the least distance of a tool to the samples.
//!
//! A node is the ball about its samples. The signed distance of a tool at the centre of the ball gives a far better bound
//! than the bounding box of the tool. The nodes stand in the order of a descent, so that a search needs neither a queue nor
//! an allocation.

use super::tool::tool_coordinates;
use nalgebra::{Point3, Vector3};

/// A sample of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudPoint {
    /// Position, part frame.
    pub position: Point3<f64>,
    /// Unit normal out of the material.
    pub normal: Vector3<f64>,
    /// Free value for the caller, to identify a found point.
    pub tag: u32,
}

/// Points per leaf of the hierarchy: their test takes about as long as that of a box.
const LEAF: usize = 8;

/// Number of points below which one thread orders them alone.
const ALONE: usize = 4096;

/// Most levels of the hierarchy: it halves its samples, so that memory ends before.
const MAX_LEVELS: usize = 64;

/// Samples of surfaces, ordered in space.
pub struct Cloud {
    points: Vec<CloudPoint>,
    /// Each node stands before its nodes, all of the first half before those of the second.
    nodes: Vec<Node>,
}

/// The ball about a run of samples.
#[derive(Clone, Copy)]
struct Node {
    centre: Point3<f64>,
    radius: f64,
    /// First sample of a leaf; of other nodes the place of the second half.
    to: u32,
    is_leaf: bool,
}

impl Cloud {
    /// Builds the hierarchy.
    pub fn new(mut points: Vec<CloudPoint>) -> Self {
        order(&mut points);
        let mut nodes = Vec::with_capacity(2 * points.len().div_ceil(LEAF));
        if !points.is_empty() {
            add_nodes(&points, 0, &mut nodes);
        }
        Self { points, nodes }
    }

    /// The samples, in the order of the indices that queries return.
    pub fn points(&self) -> &[CloudPoint] {
        &self.points
    }

    /// Least value below `cutoff` of a signed tool distance over all samples, and the sample. `distance` takes the
    /// distance from the tool axis and the height over the tip. It must change no faster than the point moves.
    pub fn nearest(
        &self,
        tip: &Point3<f64>,
        axis: &Vector3<f64>,
        distance: impl Fn(f64, f64) -> f64,
        cutoff: f64,
    ) -> Option<(f64, usize)> {
        self.nearest_by(tip, axis, &distance, |rho, s, _| distance(rho, s), cutoff)
    }

    /// As [`Self::nearest`]. `side` takes a limit too, and need not be exact: it is no greater than the distance, and lies on the
    /// same side of the limit.
    pub fn nearest_by(
        &self,
        tip: &Point3<f64>,
        axis: &Vector3<f64>,
        distance: impl Fn(f64, f64) -> f64,
        side: impl Fn(f64, f64, f64) -> f64,
        cutoff: f64,
    ) -> Option<(f64, usize)> {
        self.least_by(
            |p, limit| {
                let (rho, s) = tool_coordinates(p, tip, axis);
                side(rho, s, limit)
            },
            |p| {
                let (rho, s) = tool_coordinates(p, tip, axis);
                distance(rho, s)
            },
            cutoff,
        )
    }

    /// Least value below `cutoff` of a function of the position; it must change no faster than the position.
    pub fn least(&self, value: impl Fn(&Point3<f64>) -> f64, cutoff: f64) -> Option<(f64, usize)> {
        self.least_by(|p, _| value(p), &value, cutoff)
    }

    /// As [`Self::least`], with the side of a limit on which the value lies, as in [`Self::nearest_by`].
    fn least_by(
        &self,
        side: impl Fn(&Point3<f64>, f64) -> f64,
        value: impl Fn(&Point3<f64>) -> f64,
        cutoff: f64,
    ) -> Option<(f64, usize)> {
        let mut best: Option<(f64, usize)> = None;
        let mut limit = cutoff;
        self.descend(cutoff, &side, |limit_of_search, leaf| {
            for (i, p) in self.leaf(leaf) {
                if side(&p.position, limit) >= limit {
                    continue;
                }
                let d = value(&p.position);
                if d < limit {
                    (limit, best) = (d, Some((d, i)));
                }
            }
            *limit_of_search = limit;
            true
        });
        best
    }

    /// True when [`Self::least`] would find a sample of a function: the search ends at the first one. `side` takes a limit, as
    /// in [`Self::nearest_by`].
    pub fn any_below(&self, side: impl Fn(&Point3<f64>, f64) -> f64, cutoff: f64) -> bool {
        self.any_below_of(&side, |_, p, limit| side(p, limit), cutoff)
    }

    /// The same for a value that also depends on the index of the sample. `low` is nowhere above it, and changes no
    /// faster than the position. Both take a limit, as in [`Self::nearest_by`].
    pub fn any_below_of(
        &self,
        low: impl Fn(&Point3<f64>, f64) -> f64,
        value: impl Fn(usize, &Point3<f64>, f64) -> f64,
        cutoff: f64,
    ) -> bool {
        let mut found = false;
        self.descend(cutoff, low, |_, leaf| {
            found = self.leaf(leaf).any(|(i, p)| value(i, &p.position, cutoff) < cutoff);
            !found
        });
        found
    }

    /// The samples of a leaf, with their indices.
    fn leaf(&self, first: usize) -> impl Iterator<Item = (usize, &CloudPoint)> {
        let end = (first + LEAF).min(self.points.len());
        (first..end).zip(&self.points[first..end])
    }

    /// Visits the leaves with samples below a limit, by their first sample, of two halves the lower one first, until a visitor
    /// says false; it may lower the limit. The function changes no faster than the position.
    fn descend(
        &self,
        mut limit: f64,
        low: impl Fn(&Point3<f64>, f64) -> f64,
        mut visit: impl FnMut(&mut f64, usize) -> bool,
    ) {
        let bound = |node: &Node, limit: f64| low(&node.centre, limit + node.radius) - node.radius;
        let mut open = [(0.0, 0_u32); MAX_LEVELS];
        let mut count = 0;
        let Some(root) = self.nodes.first() else { return };
        let mut next = Some((bound(root, limit), 0_u32));
        while let Some((below, at)) = next {
            let node = &self.nodes[at as usize];
            if below < limit && !node.is_leaf {
                let [one, two] = [at + 1, node.to].map(|k| (bound(&self.nodes[k as usize], limit), k));
                let (first, then) = if two.0 < one.0 { (two, one) } else { (one, two) };
                open[count] = then;
                count += 1;
                next = Some(first);
                continue;
            }
            if below < limit && !visit(&mut limit, node.to as usize) {
                return;
            }
            count = count.wrapping_sub(1);
            next = open.get(count).copied();
        }
    }
}

/// Adds the nodes over a run of samples that begins with sample `first`.
fn add_nodes(points: &[CloudPoint], first: usize, nodes: &mut Vec<Node>) {
    let (low, high) = ends(points);
    let centre = low + (high - low) * 0.5;
    let square = points.iter().map(|p| (p.position - centre).norm_squared()).fold(0.0, f64::max);
    let at = nodes.len();
    let is_leaf = points.len() <= LEAF;
    nodes.push(Node { centre, radius: square.sqrt(), to: index(first), is_leaf });
    if !is_leaf {
        let (one, two) = points.split_at(half(points));
        add_nodes(one, first, nodes);
        nodes[at].to = index(nodes.len());
        add_nodes(two, first + one.len(), nodes);
    }
}

/// Samples are at most some millions.
fn index(i: usize) -> u32 {
    u32::try_from(i).unwrap_or(u32::MAX)
}

/// Corners of the box about samples.
fn ends(points: &[CloudPoint]) -> (Point3<f64>, Point3<f64>) {
    let first = points[0].position;
    points.iter().fold((first, first), |(low, high), p| (low.inf(&p.position), high.sup(&p.position)))
}

/// Number of samples in the first half of a run: whole leaves, so that no leaf spans a cut.
fn half(points: &[CloudPoint]) -> usize {
    (points.len() / 2).div_ceil(LEAF) * LEAF
}

/// Orders points so that each run of [`LEAF`] points is compact: repeated bisection along the longest side.
fn order(points: &mut [CloudPoint]) {
    if points.len() <= LEAF {
        return;
    }
    let (low, high) = ends(points);
    let axis = (high - low).imax();
    let middle = half(points);
    points.select_nth_unstable_by(middle.min(points.len() - 1), |a, b| {
        a.position[axis].total_cmp(&b.position[axis]).then(a.tag.cmp(&b.tag))
    });
    let (left, right) = points.split_at_mut(middle);
    if left.len() > ALONE {
        rayon::join(|| order(left), || order(right));
    } else {
        order(left);
        order(right);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equals_brute_force() {
        // Points of a twisted sheet, and an inclined cylinder with a ball end in front of it.
        let points: Vec<CloudPoint> = (0..60 * 45)
            .map(|k| (f64::from(k % 60) * 0.5, f64::from(k / 60) * 0.5))
            .map(|(x, y)| CloudPoint {
                position: Point3::new(x, y, 0.02 * x * y - 0.01 * x * x),
                normal: Vector3::z(),
                tag: 0,
            })
            .collect();
        let cloud = Cloud::new(points.clone());
        let ball = |rho: f64, s: f64| if s < 3.0 { rho.hypot(s - 3.0) - 3.0 } else { rho - 3.0 };
        for k in 0..50 {
            let t = f64::from(k) * 0.1;
            let tip = Point3::new(5.0 + 3.0 * t, 10.0 * t.sin().abs(), 4.0 - t);
            let axis = Vector3::new(t.sin(), 0.3 * t.cos(), 1.0).normalize();
            let brute = points
                .iter()
                .map(|p| {
                    let (rho, s) = tool_coordinates(&p.position, &tip, &axis);
                    ball(rho, s)
                })
                .fold(f64::INFINITY, f64::min);
            let found = cloud.nearest(&tip, &axis, ball, f64::INFINITY).unwrap();
            assert_eq!(found.0, brute);
            let value = |p: &Point3<f64>| {
                let (rho, s) = tool_coordinates(p, &tip, &axis);
                ball(rho, s)
            };
            for cutoff in [brute - 1.0, brute, brute + 1e-9, brute + 1.0, f64::INFINITY] {
                assert_eq!(cloud.any_below(|p, _| value(p), cutoff), brute < cutoff);
            }
        }
        let far = Point3::new(0.0, 0.0, 500.0);
        assert!(cloud.nearest(&far, &Vector3::z(), ball, 1.0).is_none());
    }
}
