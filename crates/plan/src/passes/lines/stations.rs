//! Stations of a line, so dense that a ball runs straight from one to the next.

use ir::CcPoint;

/// Share of the chord tolerance by which the centre of a ball may leave the straight line between two stations: round a nose
/// with a radius of 0.1 mm the ball turns far over a short way. Thinning takes the tolerance itself.
const NOSE_SHARE: f64 = 0.1;

/// The same share where surface and line have an even curvature: on a large hub, and round the corners of lines before an edge.
const EVEN_CURVE_SHARE: f64 = 0.25;

/// Most halvings of the line between two stations.
const MAX_STATION_HALVINGS: u32 = 6;

/// Limits of the deviation of a ball from the straight line between two stations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Straightness {
    /// Radius of the ball, mm.
    radius: f64,
    /// Largest turn of the normal, radians: the centre of the ball runs on an arc of its radius.
    turn: f64,
    /// Largest distance of the centre from the line in the middle, mm.
    deviation: f64,
}

impl Straightness {
    /// For a chord tolerance, mm.
    pub(super) fn within(chord: f64, radius: f64) -> Self {
        Self { radius, turn: (8.0 * NOSE_SHARE * chord / radius).sqrt(), deviation: EVEN_CURVE_SHARE * chord }
    }

    fn holds(&self, [before, middle, next]: [&(f64, CcPoint); 3]) -> bool {
        if before.1.normal.angle(&next.1.normal) > self.turn {
            return false;
        }
        // Leads go on straight.
        if before.0 < 0.0 || next.0 > 1.0 {
            return true;
        }
        let [a, m, b] = [before, middle, next].map(|(_, p)| p.position + p.normal * self.radius);
        let chord = b - a;
        (m - a).cross(&chord).norm_squared() <= self.deviation * self.deviation * chord.norm_squared()
    }
}

/// Stations with further ones where a ball would not run straight from one to the next.
pub(super) fn straight(
    stations: Vec<(f64, CcPoint)>,
    point: &impl Fn(f64) -> CcPoint,
    straightness: Straightness,
) -> Vec<(f64, CcPoint)> {
    let mut dense: Vec<(f64, CcPoint)> = Vec::with_capacity(stations.len());
    for station in stations {
        // The next stations, the nearest last, each with the halvings that are left.
        let mut ahead = vec![(station, MAX_STATION_HALVINGS)];
        while let Some((next, left)) = ahead.pop() {
            let Some(before) = dense.last().filter(|_| left > 0) else {
                dense.push(next);
                continue;
            };
            let x = 0.5 * (before.0 + next.0);
            let middle = (x, point(x));
            if straightness.holds([before, &middle, &next]) {
                dense.push(next);
            } else {
                ahead.push((next, left - 1));
                ahead.push((middle, left - 1));
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
        let dense = straight(given.clone(), &point, Straightness::within(chord, radius));
        assert!(leaves(&dense) <= 1.05 * NOSE_SHARE * chord, "{}", leaves(&dense));
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
        let dense = straight(vec![(0.0, point(0.0)), (1.0, point(1.0))], &point, Straightness::within(1e-3, 1.0));
        assert!(dense.len() <= 2 + MAX_STATION_HALVINGS as usize, "{}", dense.len());
    }
}
