//! Lines of chords through points.

use nalgebra::Point3;

/// Distance of a point from a line of chords; infinite from a line without points.
pub fn from_chords(p: &Point3<f64>, line: &[Point3<f64>]) -> f64 {
    let chord = |w: &[Point3<f64>]| {
        let d = w[1] - w[0];
        let square = d.norm_squared();
        let share = if square > 0.0 { ((p - w[0]).dot(&d) / square).clamp(0.0, 1.0) } else { 0.0 };
        nalgebra::distance(p, &(w[0] + d * share))
    };
    let single = line.first().map_or(f64::INFINITY, |q| nalgebra::distance(p, q));
    line.windows(2).map(chord).fold(single, f64::min)
}
