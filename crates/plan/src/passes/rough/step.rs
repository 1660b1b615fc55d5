//! Step along a path, from its curvature (Wei 5 to 7).

use nurbs::NurbsCurve;

/// Chord whose middle lies `epsilon` off a circle of curvature `curvature` (Wei 6), at most `longest`.
pub(crate) fn step_length(curvature: f64, epsilon: f64, longest: f64) -> f64 {
    let radius = 1.0 / curvature;
    if !radius.is_finite() || epsilon >= radius {
        return longest;
    }
    (2.0 * (radius * radius - (radius - epsilon).powi(2)).sqrt()).min(longest)
}

/// Parameters along a curve, ends included, at steps from its curvature (Wei 5 and 7). The last two steps share the
/// rest, so that neither is much shorter than the law requires.
pub(crate) fn stations(curve: &NurbsCurve, epsilon: f64, longest: f64) -> Vec<f64> {
    let [lo, hi] = curve.domain();
    let mut parameters = vec![lo];
    let mut u = lo;
    loop {
        let step = step_length(curve.curvature(u), epsilon, longest);
        let speed = curve.derivatives(u).first.norm();
        // At a point with zero speed the step would be infinite: step by a hundredth of the domain.
        let change = if speed > 0.0 { step / speed } else { (hi - lo) * 0.01 };
        let change = change.max((hi - lo) * 1e-5);
        if u + 2.0 * change >= hi {
            if u + change < hi {
                parameters.push(0.5 * (u + hi));
            }
            parameters.push(hi);
            return parameters;
        }
        u += change;
        parameters.push(u);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;
    use nurbs::interpolate;

    #[test]
    fn chords_of_a_circle_stay_within_epsilon() {
        let points: Vec<_> =
            (0..=40).map(|i| f64::from(i) * 0.05).map(|t| Point3::new(20.0 * t.cos(), 20.0 * t.sin(), 0.0)).collect();
        let circle = interpolate(&points, 3).unwrap();
        let stations = stations(&circle, 0.01, 5.0);
        assert!(stations.len() > 20);
        for pair in stations.windows(2) {
            let middle = circle.point(0.5 * (pair[0] + pair[1]));
            let chord = nalgebra::center(&circle.point(pair[0]), &circle.point(pair[1]));
            assert!((middle - chord).norm() < 0.0102);
        }
    }
}
