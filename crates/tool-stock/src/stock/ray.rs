//! Intervals of material of one ray.

/// A cut shorter than this along a ray is ignored, mm: contact, not cutting. A remainder shorter than this beside a cut
/// is removed as well; it would otherwise stand as a needle in free space.
pub(super) const SKIN: f64 = 5e-4;

/// Sorted disjoint intervals of material. The first is stored in the struct itself; few rays have more.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ray {
    first: [f64; 2],
    rest: Vec<[f64; 2]>,
}

/// First interval of a ray without material.
const NO_MATERIAL: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

impl Ray {
    /// A ray through sorted disjoint intervals.
    pub(super) fn new(intervals: &[[f64; 2]]) -> Self {
        match intervals {
            [] => Self { first: NO_MATERIAL, rest: Vec::new() },
            [first, rest @ ..] => Self { first: *first, rest: rest.to_vec() },
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.first[0] >= self.first[1]
    }

    /// The intervals in order.
    pub(super) fn intervals(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let first = (!self.is_empty()).then_some(self.first);
        first.into_iter().chain(self.rest.iter().copied())
    }

    /// Total length of the material.
    pub(super) fn length(&self) -> f64 {
        self.intervals().map(|[a, b]| b - a).sum()
    }

    /// True when a place lies in material.
    pub(super) fn contains(&self, x: f64) -> bool {
        self.intervals().any(|[a, b]| a <= x && x < b)
    }

    /// Removes sorted disjoint cuts, each inside one interval.
    pub(super) fn subtract(&mut self, cuts: impl ExactSizeIterator<Item = [f64; 2]>) {
        let mut cuts = cuts.peekable();
        if self.rest.is_empty() && cuts.len() == 1 {
            // By far the most frequent case: one interval that loses one end.
            if let Some(&[a, b]) = cuts.peek() {
                let (head, tail) = (a > self.first[0] + SKIN, b < self.first[1] - SKIN);
                if !(head && tail) {
                    self.first = match (head, tail) {
                        (true, _) => [self.first[0], a],
                        (_, true) => [b, self.first[1]],
                        _ => NO_MATERIAL,
                    };
                    return;
                }
            }
        }
        let mut left: Vec<[f64; 2]> = Vec::with_capacity(self.rest.len() + 1 + cuts.len());
        for [a, b] in self.intervals() {
            let mut from = a;
            while let Some([start, end]) = cuts.next_if(|c| c[0] < b) {
                if start > from + SKIN {
                    left.push([from, start]);
                }
                from = from.max(end);
            }
            if from < b - SKIN {
                left.push([from, b]);
            }
        }
        *self = Self::new(&left);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_away_ends_middles_and_wholes() {
        let cut = |intervals: &[[f64; 2]], cuts: &[[f64; 2]]| {
            let mut ray = Ray::new(intervals);
            ray.subtract(cuts.iter().copied());
            ray.intervals().collect::<Vec<_>>()
        };
        assert_eq!(cut(&[[0.0, 4.0]], &[[0.0, 1.0]]), [[1.0, 4.0]]);
        assert_eq!(cut(&[[0.0, 4.0]], &[[3.0, 4.0]]), [[0.0, 3.0]]);
        assert_eq!(cut(&[[0.0, 4.0]], &[[1.0, 2.0]]), [[0.0, 1.0], [2.0, 4.0]]);
        assert!(cut(&[[0.0, 4.0]], &[[0.0, 4.0]]).is_empty());
        let two = [[0.0, 4.0], [6.0, 9.0]];
        assert_eq!(cut(&two, &[[0.0, 4.0]]), [[6.0, 9.0]]);
        assert_eq!(cut(&two, &[[1.0, 2.0], [7.0, 9.0]]), [[0.0, 1.0], [2.0, 4.0], [6.0, 7.0]]);
        assert_eq!(cut(&two, &[[1.0, 2.0], [3.0, 4.0]]), [[0.0, 1.0], [2.0, 3.0], [6.0, 9.0]]);
    }

    #[test]
    fn lengths() {
        assert_eq!(Ray::new(&[[0.0, 4.0], [6.0, 9.0]]).length(), 7.0);
        assert!(Ray::new(&[]).is_empty());
    }
}
