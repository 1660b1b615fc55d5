//! Stations of a line, so dense that a ball runs straight from one to the next.

use crate::ir::CcPoint;

/// Share of the chord tolerance by which the centre of a ball may leave the straight line between two stations: round a nose
/// with a radius of 0.1 mm the ball turns far over a short way. Thinning takes the tolerance itself.
const BETWEEN_STATIONS: f64 = 0.1;

/// Times that the way between two stations is halved, at most.
const HALVINGS: u32 = 6;

/// Largest turn of the normal from station to station, radians: the centre of a ball runs on an arc of its radius.
pub(super) fn most_turn(chord: f64, radius: f64) -> f64 {
    (8.0 * BETWEEN_STATIONS * chord / radius).sqrt()
}

/// Stations with further ones where the normal of a surface turns by more than an angle, radians, from one to the next.
pub(super) fn with_small_turns(
    stations: Vec<(f64, CcPoint)>,
    point: &impl Fn(f64) -> CcPoint,
    most_turn: f64,
) -> Vec<(f64, CcPoint)> {
    let mut dense: Vec<(f64, CcPoint)> = Vec::with_capacity(stations.len());
    for station in stations {
        // The way to the next stations, the nearest last, each with the halvings that are left.
        let mut ahead = vec![(station, HALVINGS)];
        while let Some((next, left)) = ahead.pop() {
            match dense.last() {
                Some((x, before)) if left > 0 && before.normal.angle(&next.1.normal) > most_turn => {
                    let middle = 0.5 * (x + next.0);
                    ahead.push((next, left - 1));
                    ahead.push(((middle, point(middle)), left - 1));
                }
                _ => dense.push(next),
            }
        }
    }
    dense
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Vector3};

    /// Round a nose of 0.05 mm, the centre of a ball of 2.5 mm leaves no chord by more than the share of the tolerance.
    #[test]
    fn a_ball_runs_straight_round_a_nose() {
        let [nose, radius, chord] = [0.05, 2.5, 1e-3];
        let point = |x: f64| {
            let (sin, cos) = libm::sincos(3.0 * x);
            let normal = Vector3::new(cos, sin, 0.0);
            CcPoint { u: x, v: 0.0, w: 0.0, position: Point3::from(normal * nose), normal }
        };
        let given: Vec<(f64, CcPoint)> = [0.0, 0.3, 0.35, 0.7, 1.0].map(|x| (x, point(x))).to_vec();
        let centre = |p: &CcPoint| p.position + p.normal * radius;
        let leaves = |stations: &[(f64, CcPoint)]| {
            let chords = stations.windows(2).map(|pair| {
                let middle = nalgebra::center(&centre(&pair[0].1), &centre(&pair[1].1));
                (centre(&point(0.5 * (pair[0].0 + pair[1].0))) - middle).norm()
            });
            chords.fold(0.0, f64::max)
        };
        assert!(leaves(&given) > 0.1, "{}", leaves(&given));
        let dense = with_small_turns(given.clone(), &point, most_turn(chord, radius));
        assert!(leaves(&dense) <= 1.05 * BETWEEN_STATIONS * chord, "{}", leaves(&dense));
        assert!(dense.windows(2).all(|pair| pair[0].0 < pair[1].0));
        assert!(given.iter().all(|(x, _)| dense.iter().any(|(y, _)| x == y)));
        // Halvings may take twice as many as needed.
        assert!(dense.len() < 340, "{}", dense.len());
    }

    /// Where the normal jumps, the stations are bounded in number.
    #[test]
    fn corners_have_an_end() {
        let point = |x: f64| {
            let normal = if x < 0.4 { Vector3::x() } else { Vector3::y() };
            CcPoint { u: x, v: 0.0, w: 0.0, position: Point3::origin(), normal }
        };
        let dense = with_small_turns(vec![(0.0, point(0.0)), (1.0, point(1.0))], &point, 0.01);
        assert!(dense.len() <= 2 + HALVINGS as usize, "{}", dense.len());
    }
}
