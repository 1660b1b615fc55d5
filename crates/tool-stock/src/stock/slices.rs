//! Slices of a cutter along its axis, and how far to both sides the cutter removes material in each of them.

/// Number of slices.
pub const SLICES: usize = 32;

/// Heights over the tip that divide a cutter into slices: thin at the tip, where the radius of many cutters grows
/// quickly, and thicker above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slices {
    /// End of the flutes, mm.
    top: f64,
    /// Thickness of a slice at the tip, as a share of the mean thickness.
    first: f64,
}

impl Slices {
    /// Slices of a cutter with flutes up to the height `top`, in a stock with cells of the edge `cell`, mm. The first
    /// slices are as thick as a diagonal of a cell: thinner ones would meet no more rays.
    pub fn new(top: f64, cell: f64) -> Self {
        let first = (SLICES as f64 * std::f64::consts::SQRT_2 * cell / top).min(1.0);
        Self { top, first }
    }

    /// Height at which the slice `k` begins, mm; that of the number of slices is the end of the flutes.
    pub fn edge(&self, k: usize) -> f64 {
        let x = k as f64 / SLICES as f64;
        self.top * x * (self.first + (1.0 - self.first) * x)
    }

    /// The slice of a height.
    pub fn at(&self, height: f64) -> usize {
        let c = (height / self.top).max(0.0);
        // The root of first x + (1 - first) x^2 = c, without cancellation.
        let x = 2.0 * c / (self.first + (self.first * self.first + 4.0 * (1.0 - self.first) * c).sqrt());
        // Casts saturate; at the tip of a cutter whose slices have no thickness, x is not a number, which gives 0.
        ((x * SLICES as f64) as usize).min(SLICES - 1)
    }
}

/// Least and largest distance from the tool axis, across tip motion and axis, at which material is removed in each
/// slice, mm; infinity and minus infinity where none is removed. In single precision: within 4 nm for cutters of metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides(pub [[f32; 2]; SLICES]);

impl Sides {
    /// Nothing is removed.
    pub const NONE: Self = Self([[f32::INFINITY, f32::NEG_INFINITY]; SLICES]);

    /// Adds all points between two points: height and distance to the side, mm.
    pub fn add(&mut self, slices: &Slices, ends: [[f64; 2]; 2]) {
        let [low, high] = if ends[0][0] <= ends[1][0] { ends } else { [ends[1], ends[0]] };
        let [first, last] = [low, high].map(|p| slices.at(p[0]));
        let rise = high[0] - low[0];
        let mut from = low[1];
        for k in first..=last {
            let to = if k == last {
                high[1]
            } else {
                let share = ((slices.edge(k + 1) - low[0]) / rise).clamp(0.0, 1.0);
                low[1] + share * (high[1] - low[1])
            };
            join(&mut self.0[k], &[from.min(to) as f32, from.max(to) as f32]);
            from = to;
        }
    }

    /// Adds what other steps remove.
    pub fn join(&mut self, other: &Self) {
        for (own, other) in self.0.iter_mut().zip(&other.0) {
            join(own, other);
        }
    }

    /// The sides over all slices from one to another.
    pub fn over(&self, slices: std::ops::RangeInclusive<usize>) -> [f64; 2] {
        let mut all = Self::NONE.0[0];
        self.0[slices].iter().for_each(|s| join(&mut all, s));
        all.map(f64::from)
    }
}

fn join(own: &mut [f32; 2], other: &[f32; 2]) {
    *own = [own[0].min(other[0]), own[1].max(other[1])];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_height_lies_in_its_slice() {
        for (top, cell) in [(40.0, 0.15), (3.0, 0.5), (26.0, 0.35), (8.0, 1e-6)] {
            let slices = Slices::new(top, cell);
            assert!(slices.edge(0).abs() < 1e-12 && (slices.edge(SLICES) - top).abs() < 1e-9);
            for n in 0..=1000 {
                let height = top * f64::from(n) / 1000.0;
                let k = slices.at(height);
                assert!(slices.edge(k) <= height + 1e-9 && height <= slices.edge(k + 1) + 1e-9, "{height}");
            }
        }
    }

    /// A segment across several slices against points on it.
    #[test]
    fn a_segment_fills_the_slices_that_it_crosses() {
        let slices = Slices::new(20.0, 0.2);
        for ends in [[[1.0, -2.0], [9.0, 3.0]], [[9.0, 3.0], [1.0, -2.0]], [[4.0, 1.0], [4.0, -1.0]]] {
            let mut sides = Sides::NONE;
            sides.add(&slices, ends);
            let mut points = Sides::NONE;
            for n in 0..=4000 {
                let p = [0, 1].map(|k| ends[0][k] + (ends[1][k] - ends[0][k]) * f64::from(n) / 4000.0);
                join(&mut points.0[slices.at(p[0])], &[p[1] as f32; 2]);
            }
            for (a, b) in sides.0.iter().zip(&points.0) {
                assert!((0..2).all(|k| a[k].to_bits() == b[k].to_bits() || (a[k] - b[k]).abs() < 5e-3), "{a:?} {b:?}");
            }
        }
    }
}
