//! The outside of a turned blank in the meridian plane.

use serde::{Deserialize, Serialize};
use std::ops::Deref;

/// Edges of a run: the search for the nearest edge compares the boxes about runs first.
const RUN_EDGES: usize = 12;

/// A closed profile of (r, z) points, mm; straight between the points.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Vec<[f64; 2]>", into = "Vec<[f64; 2]>")]
pub struct TurnedProfile {
    points: Vec<[f64; 2]>,
    runs: Vec<EdgeRun>,
}

/// Consecutive edges, and the box about them.
#[derive(Clone, Copy, Debug)]
struct EdgeRun {
    /// The first and the last point. The last is the first point of the next run.
    ends: [usize; 2],
    least: [f64; 2],
    most: [f64; 2],
}

impl EdgeRun {
    /// Square of the distance of a point to the box, mm^2; 0 inside of it.
    fn square(&self, point: [f64; 2]) -> f64 {
        let outside = |i: usize| (self.least[i] - point[i]).max(point[i] - self.most[i]).max(0.0);
        let [r, z] = [0, 1].map(outside);
        r * r + z * z
    }
}

/// The edge nearest to a point so far.
#[derive(Clone, Copy)]
struct NearestEdge {
    /// From the nearest place of the edge to the point, mm.
    gap: [f64; 2],
    square: f64,
}

impl From<TurnedProfile> for Vec<[f64; 2]> {
    fn from(profile: TurnedProfile) -> Self {
        profile.points
    }
}

impl TryFrom<Vec<[f64; 2]>> for TurnedProfile {
    type Error = &'static str;

    fn try_from(points: Vec<[f64; 2]>) -> Result<Self, Self::Error> {
        if points.len() > 2 && points.as_flattened().iter().all(|x| x.is_finite()) {
            Ok(Self::new(points))
        } else {
            Err("a turned profile needs three points or more, with finite numbers")
        }
    }
}

impl TurnedProfile {
    /// The closed profile through points; the last one is joined to the first one.
    pub fn new(points: Vec<[f64; 2]>) -> Self {
        let of = |from: usize| {
            let to = (from + RUN_EDGES).min(points.len());
            let mut run = EdgeRun { ends: [from, to], least: [f64::INFINITY; 2], most: [f64::NEG_INFINITY; 2] };
            for k in from..=to {
                let p = points[k % points.len()];
                for (i, x) in p.into_iter().enumerate() {
                    run.least[i] = run.least[i].min(x);
                    run.most[i] = run.most[i].max(x);
                }
            }
            run
        };
        let runs = (0..points.len()).step_by(RUN_EDGES).map(of).collect();
        Self { points, runs }
    }

    /// Distance of a point (r, z) of the meridian plane, mm; negative inside.
    pub fn distance(&self, point: [f64; 2]) -> f64 {
        let mut nearest = NearestEdge { gap: [f64::INFINITY; 2], square: f64::INFINITY };
        let first = (0..self.runs.len()).min_by(|a, b| {
            let [a, b] = [a, b].map(|k| self.runs[*k].square(point));
            a.total_cmp(&b)
        });
        if let Some(run) = first {
            self.search(&self.runs[run], point, &mut nearest);
        }
        let mut inside = false;
        for (k, run) in self.runs.iter().enumerate() {
            if Some(k) != first && run.square(point) <= nearest.square {
                self.search(run, point, &mut nearest);
            }
            inside ^= self.crossed(run, point);
        }
        let distance = libm::hypot(nearest.gap[0], nearest.gap[1]);
        if inside { -distance } else { distance }
    }

    fn at(&self, k: usize) -> [f64; 2] {
        self.points[if k == self.points.len() { 0 } else { k }]
    }

    /// Looks for a nearer edge among those of a run.
    fn search(&self, run: &EdgeRun, [r, z]: [f64; 2], nearest: &mut NearestEdge) {
        let mut a = self.at(run.ends[0]);
        for k in run.ends[0]..run.ends[1] {
            let b = self.at(k + 1);
            let (along, to) = ([b[0] - a[0], b[1] - a[1]], [r - a[0], z - a[1]]);
            let square = along[0] * along[0] + along[1] * along[1];
            let share =
                if square > 0.0 { ((to[0] * along[0] + to[1] * along[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
            let gap = [to[0] - share * along[0], to[1] - share * along[1]];
            let square = gap[0] * gap[0] + gap[1] * gap[1];
            if square < nearest.square {
                *nearest = NearestEdge { gap, square };
            }
            a = b;
        }
    }

    /// True when the ray from a point in the direction of r crosses an odd number of edges of a run.
    fn crossed(&self, run: &EdgeRun, [r, z]: [f64; 2]) -> bool {
        if z < run.least[1] || z > run.most[1] || r >= run.most[0] {
            return false;
        }
        let over = |k: usize| self.at(k)[1] > z;
        if r < run.least[0] {
            // All edges are ahead of the point: the ends of the run tell.
            return over(run.ends[0]) != over(run.ends[1]);
        }
        let crosses = |k: &usize| {
            let [a, b] = [*k, k + 1].map(|k| self.at(k));
            over(*k) != over(k + 1) && r < a[0] + (b[0] - a[0]) * (z - a[1]) / (b[1] - a[1])
        };
        (run.ends[0]..run.ends[1]).filter(crosses).count() % 2 == 1
    }
}

impl Deref for TurnedProfile {
    type Target = [[f64; 2]];

    fn deref(&self) -> &[[f64; 2]] {
        &self.points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_is_near_from_inside_and_outside() {
        let square = TurnedProfile::new(vec![[5.0, 0.0], [5.0, 10.0], [15.0, 10.0], [15.0, 0.0]]);
        for (point, within, expected) in [
            ([10.0, 5.0], 0.1, true),
            ([15.5, 5.0], 0.4, false),
            ([15.5, 5.0], 0.6, true),
            ([3.0, 5.0], 1.0, false),
            // Near the closing edge, from below.
            ([10.0, -0.5], 0.6, true),
            ([18.0, 14.0], 4.9, false),
            ([18.0, 14.0], 5.1, true),
        ] {
            assert_eq!(square.distance(point) <= within, expected, "{point:?} {within}");
        }
    }

    /// A ring between two waved circles, against all of its edges one by one.
    #[test]
    fn boxes_about_runs_hide_no_edge() {
        let waved = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / 203.0;
            let radius = 20.0 + 3.0 * libm::sin(7.0 * angle);
            [40.0 + radius * libm::cos(angle), radius * libm::sin(angle)]
        };
        let points: Vec<[f64; 2]> = (0..203).map(waved).collect();
        let profile = TurnedProfile::new(points.clone());
        let edges = || (0..points.len()).map(|k| [points[k], points[(k + 1) % points.len()]]);
        for k in 0..4000 {
            let p @ [r, z] = [(k % 80) as f64 * 1.013, (k / 80) as f64 * 1.171 - 30.0];
            let to_edge = |[a, b]: [[f64; 2]; 2]| {
                let [a, b, p] = [a, b, p].map(nalgebra::Vector2::from);
                let share = ((p - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
                (p - a - (b - a) * share).norm()
            };
            let nearest = edges().map(to_edge).fold(f64::INFINITY, f64::min);
            let crosses = |[a, b]: &[[f64; 2]; 2]| {
                (a[1] > z) != (b[1] > z) && r < a[0] + (b[0] - a[0]) * (z - a[1]) / (b[1] - a[1])
            };
            let inside = edges().filter(crosses).count() % 2 == 1;
            let expected = if inside { -nearest } else { nearest };
            assert!((profile.distance(p) - expected).abs() < 1e-12, "{p:?}: {} and {expected}", profile.distance(p));
        }
    }
}
