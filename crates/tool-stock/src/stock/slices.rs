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

/// Where material is removed across tip motion and axis in each slice, by its distance from the tool axis, mm. In single
/// precision: within 4 nm for cutters of metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides {
    /// Least and largest distance; infinity and minus infinity where nothing is removed.
    ends: [[f32; 2]; SLICES],
    /// The place about the axis where nothing is removed: the largest distance on its negative side and the least one on
    /// its positive side. No width where material is removed on the axis.
    free: [[f32; 2]; SLICES],
}

impl Sides {
    /// Nothing is removed.
    pub const NONE: Self =
        Self { ends: [[f32::INFINITY, f32::NEG_INFINITY]; SLICES], free: [[f32::NEG_INFINITY, f32::INFINITY]; SLICES] };

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
            let piece = [from.min(to) as f32, from.max(to) as f32];
            join(&mut self.ends[k], &piece);
            narrow(&mut self.free[k], &beside(piece));
            from = to;
        }
    }

    /// Adds what other steps remove.
    pub fn join(&mut self, other: &Self) {
        for (own, other) in self.ends.iter_mut().zip(&other.ends) {
            join(own, other);
        }
        for (own, other) in self.free.iter_mut().zip(&other.free) {
            narrow(own, other);
        }
    }

    /// The sides over all slices from one to another.
    pub fn over(&self, slices: std::ops::RangeInclusive<usize>) -> [f64; 2] {
        let mut all = Self::NONE.ends[0];
        self.ends[slices].iter().for_each(|s| join(&mut all, s));
        all.map(f64::from)
    }

    /// The place about the axis in a slice where nothing is removed although material is removed on both of its sides.
    pub fn free_between(&self, slice: usize) -> Option<[f64; 2]> {
        let free = self.free[slice].map(f64::from);
        (free.iter().all(|side| side.is_finite()) && free[0] < free[1]).then_some(free)
    }
}

/// What a piece leaves free about the axis.
fn beside([from, to]: [f32; 2]) -> [f32; 2] {
    match (from > 0.0, to < 0.0) {
        (true, _) => [f32::NEG_INFINITY, from],
        (_, true) => [to, f32::INFINITY],
        _ => [0.0; 2],
    }
}

fn narrow(own: &mut [f32; 2], other: &[f32; 2]) {
    *own = [own[0].max(other[0]), own[1].min(other[1])];
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

    /// Material on both sides leaves a free place between them, until some is removed on the axis.
    #[test]
    fn what_is_free_lies_between_both_sides() {
        let slices = Slices::new(10.0, 0.2);
        let at = |from: f64, to: f64| {
            let mut sides = Sides::NONE;
            sides.add(&slices, [[4.0, from], [4.0, to]]);
            sides
        };
        let slice = slices.at(4.0);
        let mut sides = at(1.0, 2.0);
        assert_eq!(sides.free_between(slice), None);
        sides.join(&at(-1.5, -1.25));
        sides.join(&at(0.5, 0.75));
        assert_eq!(sides.free_between(slice), Some([-1.25, 0.5]));
        assert_eq!(sides.over(slice..=slice), [-1.5, 2.0]);
        assert_eq!(sides.free_between(slice + 1), None);
        sides.join(&at(-0.25, 0.25));
        assert_eq!(sides.free_between(slice), None);
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
                join(&mut points.ends[slices.at(p[0])], &[p[1] as f32; 2]);
            }
            for (a, b) in sides.ends.iter().zip(&points.ends) {
                assert!((0..2).all(|k| a[k].to_bits() == b[k].to_bits() || (a[k] - b[k]).abs() < 5e-3), "{a:?} {b:?}");
            }
        }
    }
}
