//! Angles and directions on a circle and on the sphere.

use nalgebra::Vector3;
use std::f64::consts::TAU;

/// An angle with whole turns added, so that it is at most half a turn from another one. Radians.
pub fn nearest_turn(angle: f64, about: f64) -> f64 {
    angle - TAU * ((angle - about) / TAU).round()
}

/// Cosine, either sign, from which the angle comes from the sine as well: there the cosine knows half of the digits.
const NARROW: f64 = 0.9;

/// Sine of the angle between two directions below which the chord is the arc.
const PARALLEL_SINE: f64 = 1e-9;

/// Direction at a share of the even turn from one unit vector to another, on their great circle. Opposite ones have no great
/// circle of their own: of those the first.
pub fn great_arc(from: &Vector3<f64>, to: &Vector3<f64>, share: f64) -> Vector3<f64> {
    let cosine = from.dot(to);
    let narrow = cosine.abs() > NARROW;
    let angle = if narrow { libm::atan2(from.cross(to).norm(), cosine) } else { libm::acos(cosine) };
    let sine = libm::sin(angle);
    // Opposite directions end here too.
    if sine < PARALLEL_SINE {
        return if angle < 1.0 { (from + (to - from) * share).normalize() } else { *from };
    }
    (from * libm::sin((1.0 - share) * angle) + to * libm::sin(share * angle)) / sine
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_great_arc_turns_evenly_in_one_plane() {
        let (p, q) = (Vector3::new(0.3, -0.4, 1.2).normalize(), Vector3::new(-0.6, -0.5, 0.4).normalize());
        let angle = p.angle(&q);
        for k in 0..=10 {
            let t = f64::from(k) / 10.0;
            let v = great_arc(&p, &q, t);
            assert!((v.norm() - 1.0).abs() < 1e-14 && (v.angle(&p) - t * angle).abs() < 1e-7);
            assert!(v.dot(&p.cross(&q)).abs() < 1e-14);
        }
        assert_eq!(great_arc(&p, &-p, 0.3), p);
    }

    #[test]
    fn arcs_of_any_angle_keep_length_and_angle() {
        let p = Vector3::new(0.3, -0.4, 1.2).normalize();
        let across = p.cross(&Vector3::x()).normalize();
        let narrow = [1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.4, 0.46];
        for angle in narrow.into_iter().chain([1.0, 2.0, 2.7, 3.0, 3.13]) {
            let q = p * libm::cos(angle) + across * libm::sin(angle);
            for k in 0..=8 {
                let share = f64::from(k) / 8.0;
                let v = great_arc(&p, &q, share);
                let exact = p * libm::cos(share * angle) + across * libm::sin(share * angle);
                assert!((v - exact).norm() < 1e-11 && (v.norm() - 1.0).abs() < 1e-11, "{angle} at {share}: {v:?}");
            }
        }
    }

    #[test]
    fn turns_are_whole_and_the_nearest() {
        for k in -40..40 {
            let (angle, about) = (0.37 * f64::from(k), 2.0);
            let found = nearest_turn(angle, about);
            let turns = (angle - found) / TAU;
            assert!((turns - turns.round()).abs() < 1e-12 && (found - about).abs() <= 0.5 * TAU + 1e-12);
        }
    }
}
