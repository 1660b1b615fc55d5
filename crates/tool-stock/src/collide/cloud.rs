//! Sampled surfaces with a hierarchy, for the least distance of a tool to the samples.
//!
//! The hierarchy is that of parry; the bound and the leaves are our own. The signed distance of a tool at the middle of
//! a box gives a far better bound than the bounding box of the tool. This is the only file that names parry.

use super::tool::tool_coordinates;
use nalgebra::{Point3, Vector3};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode};

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

/// Samples of surfaces, ordered in space.
pub struct Cloud {
    points: Vec<CloudPoint>,
    tree: Bvh,
}

impl Cloud {
    /// Builds the hierarchy.
    pub fn new(mut points: Vec<CloudPoint>) -> Self {
        order(&mut points);
        let boxes: Vec<Aabb> = points
            .chunks(LEAF)
            .map(|chunk| {
                let (mut low, mut high) = (chunk[0].position, chunk[0].position);
                for p in chunk {
                    low = low.inf(&p.position);
                    high = high.sup(&p.position);
                }
                Aabb::new(Vector::new(low.x, low.y, low.z), Vector::new(high.x, high.y, high.z))
            })
            .collect();
        Self { tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes), points }
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
        self.least(
            |p| {
                let (rho, s) = tool_coordinates(p, tip, axis);
                distance(rho, s)
            },
            cutoff,
        )
    }

    /// Least value below `cutoff` of a function of the position; it must change no faster than the position.
    pub fn least(&self, value: impl Fn(&Point3<f64>) -> f64, cutoff: f64) -> Option<(f64, usize)> {
        self.least_of(&value, |_, p| value(p), cutoff)
    }

    /// The same for a value that also depends on the index of the sample. `low` is nowhere above it, and changes no
    /// faster than the position.
    pub fn least_of(
        &self,
        low: impl Fn(&Point3<f64>) -> f64,
        value: impl Fn(usize, &Point3<f64>) -> f64,
        cutoff: f64,
    ) -> Option<(f64, usize)> {
        let bound = |node: &BvhNode, _: f64| bound(node, &low);
        let leaf = |chunk: u32, _: f64| {
            let start = chunk as usize * LEAF;
            let end = (start + LEAF).min(self.points.len());
            let mut best: Option<(f64, usize)> = None;
            for (i, p) in self.points[start..end].iter().enumerate() {
                let d = value(start + i, &p.position);
                if best.is_none_or(|b| d < b.0) {
                    best = Some((d, start + i));
                }
            }
            best.map(|(cost, index)| NearestSample { cost, index })
        };
        self.tree.find_best(cutoff, bound, leaf).map(|(_, found)| (found.cost, found.index))
    }

    /// True when [`Self::least`] would find a sample: the search ends at the first one.
    pub fn any_below(&self, value: impl Fn(&Point3<f64>) -> f64, cutoff: f64) -> bool {
        self.any_below_of(&value, |_, p| value(p), cutoff)
    }

    /// True when [`Self::least_of`] would find a sample: the search ends at the first one.
    pub fn any_below_of(
        &self,
        low: impl Fn(&Point3<f64>) -> f64,
        value: impl Fn(usize, &Point3<f64>) -> f64,
        cutoff: f64,
    ) -> bool {
        let bound = |node: &BvhNode, best: f64| if best < cutoff { f64::INFINITY } else { bound(node, &low) };
        let leaf = |chunk: u32, best: f64| {
            let start = chunk as usize * LEAF;
            let mut points = self.points[start..].iter().take(LEAF).zip(start..);
            let below = |(p, index): (&CloudPoint, usize)| {
                let cost = value(index, &p.position);
                (cost < cutoff).then_some(NearestSample { cost, index })
            };
            if best < cutoff { None } else { points.find_map(below) }
        };
        self.tree.find_best(cutoff, bound, leaf).is_some()
    }
}

/// Lower bound of a value over a box; the value changes no faster than the position.
fn bound(node: &BvhNode, value: impl Fn(&Point3<f64>) -> f64) -> f64 {
    let centre = (node.mins() + node.maxs()) * 0.5;
    let half = (node.maxs() - node.mins()) * 0.5;
    value(&Point3::new(centre.x, centre.y, centre.z)) - half.length()
}

struct NearestSample {
    cost: f64,
    index: usize,
}

impl parry3d_f64::partitioning::BvhLeafCost for NearestSample {
    fn cost(&self) -> f64 {
        self.cost
    }
}

/// Orders points so that each run of [`LEAF`] points is compact: repeated bisection along the longest side.
fn order(points: &mut [CloudPoint]) {
    if points.len() <= LEAF {
        return;
    }
    let (mut low, mut high) = (points[0].position, points[0].position);
    for p in points.iter() {
        low = low.inf(&p.position);
        high = high.sup(&p.position);
    }
    let axis = (high - low).imax();
    // Whole leaves on the left, so that no leaf spans a cut.
    let middle = (points.len() / 2).div_ceil(LEAF) * LEAF;
    points.select_nth_unstable_by(middle.min(points.len() - 1), |a, b| {
        a.position[axis].total_cmp(&b.position[axis]).then(a.tag.cmp(&b.tag))
    });
    let (left, right) = points.split_at_mut(middle.min(points.len()));
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
                assert_eq!(cloud.any_below(value, cutoff), brute < cutoff);
            }
        }
        let far = Point3::new(0.0, 0.0, 500.0);
        assert!(cloud.nearest(&far, &Vector3::z(), ball, 1.0).is_none());
    }
}
