//! What g is at most over the blocks of a patch, and which functions lie over it everywhere.
//!
//! The distance to a cutter is convex, so that it lies over its tangent at the middle of the patch. A block lies within
//! its bulge of the hull of its four corners, so that a linear function which is more at these corners than g is over the
//! block, and more by the bulge, is more all over the block. What comes nowhere under the cutoff counts nowhere.

use super::hull::Hull;
use nalgebra::Vector3;

/// Corners that are compared at once.
const LANES: usize = 4;

/// Some corners of blocks.
#[derive(Clone, Copy, Debug)]
struct Lanes {
    /// From the middle of the patch, by coordinate.
    way: [[f64; LANES]; 3],
    /// Most over the blocks that meet there, and their bulge.
    most: [f64; LANES],
}

/// What g is at most over the blocks of a patch.
#[derive(Clone, Debug)]
pub(crate) struct Cutoff<'h> {
    hull: &'h Hull,
    lanes: Vec<Lanes>,
    highest: f64,
    /// Most that any block bulges.
    bulge: f64,
}

impl<'h> Cutoff<'h> {
    /// Over the hull of a patch, by the corners of its blocks: their ways from its middle, and the most that g is over
    /// any block that meets there, its bulge added. No block bulges by more than `bulge`.
    pub(crate) fn new(hull: &'h Hull, corners: &[(Vector3<f64>, f64)], bulge: f64) -> Self {
        let lanes = corners.chunks(LANES).map(|some| {
            let mut lanes = Lanes { way: [[0.0; LANES]; 3], most: [f64::NEG_INFINITY; LANES] };
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

    /// Its highest place, bulges added.
    pub(crate) fn highest(&self) -> f64 {
        self.highest
    }

    /// True if a linear function of a value at the middle and a slope lies nowhere under the cutoff; the slope is no
    /// longer than `steepness`, at least one.
    pub(crate) fn hides(&self, value: f64, slope: &Vector3<f64>, steepness: f64) -> bool {
        if value - steepness * self.hull.radius >= self.highest {
            return true;
        }
        let value = value - (steepness - 1.0) * self.bulge;
        let mut over = [f64::NEG_INFINITY; LANES];
        for lanes in &self.lanes {
            let [x, y, z] = &lanes.way;
            for k in 0..LANES {
                let room = lanes.most[k] - (slope.x * x[k] + slope.y * y[k] + slope.z * z[k]);
                over[k] = if room > over[k] { room } else { over[k] };
            }
        }
        over.iter().all(|room| *room <= value)
    }
}
