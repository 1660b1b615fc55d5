//! Samples of surfaces by squares, for the sample with the least distance.

use nalgebra::Point3;

/// Samples along each side of a square.
const SIDE: usize = 10;

/// Samples of a piece of a surface, each with a value, within a radius of the first one.
pub struct Square<T> {
    radius: f64,
    samples: Vec<(T, Point3<f64>)>,
}

/// The squares of a surface with samples at all indices up to a last one along and across.
pub fn squares<T>([along, across]: [usize; 2], sample: impl Fn(usize, usize) -> (T, Point3<f64>)) -> Vec<Square<T>> {
    let square = |i: usize, j: usize| {
        let [last_i, last_j] = [(i + SIDE - 1).min(along), (j + SIDE - 1).min(across)];
        let mut samples = vec![sample((i + last_i) / 2, (j + last_j) / 2)];
        samples.extend((i..=last_i).flat_map(|i| (j..=last_j).map(move |j| (i, j))).map(|(i, j)| sample(i, j)));
        let radius = samples.iter().map(|s| (s.1 - samples[0].1).norm()).fold(0.0, f64::max);
        Square { radius, samples }
    };
    let corners = (0..=along).step_by(SIDE).flat_map(|i| (0..=across).step_by(SIDE).map(move |j| (i, j)));
    corners.map(|(i, j)| square(i, j)).collect()
}

/// The least distance of all samples, and its sample. The distance changes no faster than the place, so that one sample
/// bounds the distances of its square.
pub fn nearest<T>(squares: &[Square<T>], distance: impl Fn(&Point3<f64>) -> f64) -> (f64, &(T, Point3<f64>)) {
    let mut bounds: Vec<(f64, &Square<T>)> =
        squares.iter().map(|square| (distance(&square.samples[0].1) - square.radius, square)).collect();
    bounds.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = (f64::INFINITY, &bounds[0].1.samples[0]);
    for (bound, square) in bounds {
        if bound >= best.0 {
            break;
        }
        for sample in &square.samples {
            let found = distance(&sample.1);
            if found < best.0 {
                best = (found, sample);
            }
        }
    }
    best
}
