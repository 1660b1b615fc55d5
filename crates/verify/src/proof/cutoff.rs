//! Cutoff over the blocks of a patch: an upper bound of g over each block. Pieces that lie above the cutoff everywhere
//! cannot matter.
//!
//! The distance to a cutter is convex and lies above its tangent at the middle of the patch. A block lies within its
//! bulge of the hull of its four corners. If a linear function exceeds the upper bound of the block at these corners by
//! at least the bulge, the function exceeds the bound over the whole block.

use super::hull::Hull;
use nalgebra::Vector3;

/// Corners that are compared at once.
const LANES: usize = 4;

/// Some corners of blocks.
#[derive(Clone, Copy, Debug)]
struct CornerLanes {
    /// Vectors from the middle of the patch, by coordinate.
    way: [[f64; LANES]; 3],
    /// Largest upper bound of the blocks that meet at each corner, bulge included.
    most: [f64; LANES],
}

/// Upper bound of g over the blocks of a patch.
#[derive(Clone, Debug)]
pub(crate) struct Cutoff<'h> {
    hull: &'h Hull,
    lanes: Vec<CornerLanes>,
    highest: f64,
    /// Largest bulge of any block.
    bulge: f64,
}

impl<'h> Cutoff<'h> {
    /// Over the hull of a patch, from the corners of its blocks. Each corner has its vector from the middle of the
    /// patch and the largest upper bound of g over the blocks that meet there, bulge included. `bulge` bounds the bulge
    /// of every block.
    pub(crate) fn new(hull: &'h Hull, corners: &[(Vector3<f64>, f64)], bulge: f64) -> Self {
        let lanes = corners.chunks(LANES).map(|some| {
            let mut lanes = CornerLanes { way: [[0.0; LANES]; 3], most: [f64::NEG_INFINITY; LANES] };
            for (k, (way, most)) in some.iter().enumerate() {
                lanes.most[k] = *most;
                for (to, from) in lanes.way.iter_mut().zip(way.iter()) {
                    to[k] = *from;
                }
            }
            lanes
        });
        let highest = corners.iter().map(|c| c.1).fold(f64::NEG_INFINITY, f64::max);
        Self { hull, lanes: lanes.collect(), highest, bulge }
    }

    /// The patch.
    pub(crate) fn hull(&self) -> &Hull {
        self.hull
    }

    /// Highest upper bound of all blocks, bulge included.
    pub(crate) fn highest(&self) -> f64 {
        self.highest
    }

    /// True if a linear function, given by its value at the middle and its slope, lies nowhere below the cutoff. The
    /// slope is at most `steepness` long, which is at least one.
    pub(crate) fn hides(&self, value: f64, slope: &Vector3<f64>, steepness: f64) -> bool {
        if value - steepness * self.hull.radius >= self.highest {
            return true;
        }
        let value = value - (steepness - 1.0) * self.bulge;
        let mut over = [f64::NEG_INFINITY; LANES];
        for lanes in &self.lanes {
            let [x, y, z] = &lanes.way;
            for k in 0..LANES {
                let least = lanes.most[k] - (slope.x * x[k] + slope.y * y[k] + slope.z * z[k]);
                over[k] = if least > over[k] { least } else { over[k] };
            }
        }
        over.iter().all(|least| *least <= value)
    }
}
