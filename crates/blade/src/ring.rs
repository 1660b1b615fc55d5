//! A closed line of points with its lengths and turns. Pure geometry.

use nalgebra::Point3;

/// A loop of points without repeated neighbours.
#[derive(Clone, Debug)]
pub(super) struct Ring {
    pub(super) points: Vec<Point3<f64>>,
    /// Distance along the loop from point 0 to each point, then the whole length.
    pub(super) along: Vec<f64>,
    /// Angle between the chords before and behind each point, rad.
    pub(super) turns: Vec<f64>,
}

impl Ring {
    /// A loop; neighbours at the same place count once.
    pub(super) fn new(points: &[Point3<f64>]) -> Self {
        let mut points = points.to_vec();
        points.dedup();
        while points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        let n = points.len();
        let mut along = vec![0.0; n + 1];
        for k in 0..n {
            along[k + 1] = along[k] + nalgebra::distance(&points[k], &points[(k + 1) % n]);
        }
        let turn = |k: usize| {
            let (a, b) = (points[k] - points[(k + n - 1) % n], points[(k + 1) % n] - points[k]);
            libm::atan2(a.cross(&b).norm(), a.dot(&b))
        };
        let turns = (0..n).map(turn).collect();
        Self { points, along, turns }
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    /// Length of the loop, mm.
    pub(super) fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    /// Index of the point `step` places behind another.
    pub(super) fn on(&self, from: usize, step: isize) -> usize {
        let n = self.len().max(1) as isize;
        (from as isize + step).rem_euclid(n) as usize
    }

    /// Length of the chord from a point to the next, mm.
    pub(super) fn chord(&self, k: usize) -> f64 {
        self.along[k + 1] - self.along[k]
    }

    /// Length of the loop from one point on to another, mm.
    pub(super) fn between(&self, from: usize, to: usize) -> f64 {
        let length = self.along[to] - self.along[from];
        if length < 0.0 { length + self.length() } else { length }
    }

    /// Curvature at a point, 1/mm: its turn over the half of both chords.
    pub(super) fn curvature(&self, k: usize) -> f64 {
        let span = 0.5 * (self.chord(self.on(k, -1)) + self.chord(k));
        if span > 0.0 { self.turns[k] / span } else { 0.0 }
    }

    /// The point at a distance along the loop, mm.
    pub(super) fn at(&self, distance: f64) -> Point3<f64> {
        let distance = distance.rem_euclid(self.length());
        let k = self.along.partition_point(|a| *a <= distance).clamp(1, self.len()) - 1;
        let chord = self.chord(k);
        let share = if chord > 0.0 { (distance - self.along[k]) / chord } else { 0.0 };
        let (a, b) = (&self.points[k], &self.points[(k + 1) % self.len()]);
        a + (b - a) * share
    }

    /// The point nearest to a distance along the loop.
    pub(super) fn nearest(&self, distance: f64) -> usize {
        let distance = distance.rem_euclid(self.length());
        let k = self.along.partition_point(|a| *a <= distance).clamp(1, self.len()) - 1;
        if distance - self.along[k] > 0.5 * self.chord(k) { (k + 1) % self.len() } else { k }
    }

    /// Points from one to another in the order of the loop, both with them. From a point to itself it is one point.
    pub(super) fn points_between(&self, from: usize, to: usize) -> Vec<Point3<f64>> {
        let count = (to + self.len() - from) % self.len();
        (0..=count).map(|k| self.points[(from + k) % self.len()]).collect()
    }
}
