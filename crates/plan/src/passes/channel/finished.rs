//! Floor that a larger ball has finished, for the lines of smaller balls beside it.

use nurbs::BandMetric;
use nurbs::angle::nearest_turn;

/// Distance beside the outer lines of a larger ball up to which the floor counts as finished, in steps of this ball. Half a
/// step would make the ridge to the next smaller ball as high as all others. The rest is an overlap for the lengths of
/// both tools, which are never the same.
const FINISHED_STEPS: f64 = 0.45;

/// An interval of the floor between two edges.
pub(super) struct Finished {
    /// u of both ends; infinite where the lines run out of the part.
    range: [f64; 2],
    /// u at x = 0 and x = 1 of the metric.
    ends: [f64; 2],
    metric: BandMetric,
    /// Azimuth at the stations of the metric.
    edges: [Vec<f64>; 2],
}

impl Finished {
    /// What lines between two outer ones finish, given at the stations of the metric of their ball. Lines that begin at an
    /// end that is not open finish less than half a step there.
    pub(super) fn new(metric: BandMetric, ends: [f64; 2], open: [bool; 2], outer: [&[f64]; 2]) -> Self {
        let edges = [metric.front(outer[0], -FINISHED_STEPS), metric.front(outer[1], FINISHED_STEPS)];
        let length = ends[1] - ends[0];
        let range = [0, 1].map(|i: usize| {
            let inward = if i == 0 { 1.0 } else { -1.0 };
            let along = [0, 1].map(|k: usize| metric.form(i as f64, metric.at(outer[k], i as f64))[0]);
            if open[i] { -inward * f64::INFINITY } else { ends[i] + inward * length * 0.5 / along[0].min(along[1]) }
        });
        Self { range, ends, metric, edges }
    }

    /// Azimuths of both edges at a place of the meridian.
    fn at(&self, u: f64) -> Option<[f64; 2]> {
        let x = (u - self.ends[0]) / (self.ends[1] - self.ends[0]);
        (self.range[0]..=self.range[1]).contains(&u).then(|| [0, 1].map(|k: usize| self.metric.at(&self.edges[k], x)))
    }
}

/// The outer edges of all that is finished at a place of the meridian, as azimuths near that of the first wall. Each ball
/// has finished the floor up to the edges of the larger one.
pub(super) fn edges(finished: &[Finished], u: f64, first_wall: f64) -> Option<[f64; 2]> {
    let found = finished.iter().filter_map(|f| f.at(u)).map(|[low, high]| {
        let near = nearest_turn(low, first_wall);
        [near, near + high - low]
    });
    found.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}
