//! The largest oblique elliptic cone inside of a set of clear tool axes (Xu 3).
//!
//! The set is known only through a query: is every axis within an angle of this axis clear? Rays from a clear axis find
//! the boundary of the set. A pattern search finds the ellipse of largest area that contains none of these boundary
//! points. Last comes the proof: caps of clear axes cover the ellipse, or the ellipse shrinks until they do.

use nalgebra::{Matrix2, SymmetricEigen, Vector2, Vector3};
use nurbs::EllipticCone;
use nurbs::bracket::Bracket;
use std::f64::consts::TAU;

/// Least spread of directions that is divided by.
const NO_SPREAD: f64 = 1e-12;

/// Rays from the seed.
const RAYS: usize = 16;

/// Step along a ray in the plane at height one: about 4 deg, less than the narrowest obstacle.
const RAY_STEP: f64 = 0.07;

/// Bisection steps for the boundary of the set: to a twentieth of a degree.
const BORDER_BISECTIONS: usize = 6;

/// Rounds of the pattern search, each with finer steps.
const SEARCH_ROUNDS: usize = 24;

/// Factor by which an ellipse shrinks when its proof fails.
const SHRINK: f64 = 0.9;

/// Least size that is still tried, as a share of the first ellipse.
const LEAST_SHARE: f64 = 0.3;

/// Smallest half axis of a cone, as a tangent: a hundredth of a degree.
const LEAST_HALF_AXIS: f64 = 2e-4;

/// Least angle of a cap that proves a part of a cone, radians.
pub const LEAST_CAP: f64 = 0.005;

/// How a cone is shown to be clear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proof {
    /// Caps of clear axes cover the whole cone.
    Covered,
    /// Only the ends of the rays are known, for callers that check the axis that they take.
    Rays,
}

/// The largest cone of clear axes about the axis at the point `seed` of the plane at height one of `frame`, within
/// `reach` of the seed in this plane. `clear(d, cap)` is true when every axis within the angle `cap` of the unit vector
/// d is clear. `None` where the seed itself is not clear, or where no cone about it is proved.
pub fn inscribe(
    frame: &[Vector3<f64>; 3],
    seed: Vector2<f64>,
    reach: f64,
    proof: Proof,
    clear: &dyn Fn(&Vector3<f64>, f64) -> bool,
) -> Option<EllipticCone> {
    let [x, y, w] = frame;
    let direction = |at: &Vector2<f64>| (w + x * at.x + y * at.y).normalize();
    if !clear(&direction(&seed), 0.0) {
        return None;
    }
    let ends: Vec<Vector2<f64>> = (0..RAYS)
        .map(|k| {
            let (sin, cos) = libm::sincos(TAU * k as f64 / RAYS as f64);
            let along = |r: f64| seed + Vector2::new(cos, sin) * r;
            let mut inside = 0.0;
            while inside < reach && clear(&direction(&along(inside + RAY_STEP)), 0.0) {
                inside += RAY_STEP;
            }
            if inside >= reach {
                return along(reach);
            }
            let border = Bracket { holds: inside, fails: inside + RAY_STEP };
            along(border.halved(BORDER_BISECTIONS, |r| clear(&direction(&along(r)), 0.0)).holds)
        })
        .collect();
    let mut cone = largest_between(frame, seed, &ends)?;
    if proof == Proof::Rays {
        return Some(cone);
    }
    let whole = cone.half_axes;
    let mut share = 1.0;
    while share > LEAST_SHARE {
        cone.half_axes = whole.map(|h| h * share);
        if covered(&cone, clear) {
            return Some(cone);
        }
        share *= SHRINK;
    }
    None
}

/// The ellipse of largest area that contains the seed and none of the points `ends`.
fn largest_between(frame: &[Vector3<f64>; 3], seed: Vector2<f64>, ends: &[Vector2<f64>]) -> Option<EllipticCone> {
    // First guess: centre and principal directions of the star with the corners `ends`.
    let (mut area, mut middle) = (0.0, Vector2::zeros());
    let mut moments = Matrix2::zeros();
    for (k, p) in ends.iter().enumerate() {
        let (p, q) = (p - seed, ends[(k + 1) % ends.len()] - seed);
        let twice = p.x * q.y - p.y * q.x;
        area += 0.5 * twice;
        middle += (p + q) * (twice / 6.0);
        let sum = p + q;
        moments += (p * p.transpose() + q * q.transpose() + sum * sum.transpose()) * (twice / 24.0);
    }
    if area <= 0.0 {
        return None;
    }
    middle /= area;
    let spread = SymmetricEigen::new(moments / area - middle * middle.transpose());
    let main = spread.eigenvalues.imax();
    let lengths = [spread.eigenvalues[main], spread.eigenvalues[1 - main]].map(|e| e.max(0.0).sqrt());
    let towards = spread.eigenvectors.column(main);
    let ratio = (lengths[1] / lengths[0].max(NO_SPREAD)).clamp(0.05, 1.0);
    let sized = |v: &[f64; 4]| {
        let mut cone = EllipticCone {
            frame: *frame,
            centre: Vector2::new(v[0], v[1]),
            half_axes: [1.0, libm::exp(v[2])],
            roll: v[3],
        };
        let m = cone.to_circle();
        let scale = ends.iter().map(|p| (m * (p - cone.centre)).norm()).fold(f64::INFINITY, f64::min);
        cone.half_axes = cone.half_axes.map(|h| h * scale);
        let holds = (cone.to_circle() * (seed - cone.centre)).norm() <= 0.9;
        (if holds { cone.area() } else { 0.0 }, cone)
    };
    let mut at = [seed.x + middle.x, seed.y + middle.y, libm::log(ratio), libm::atan2(towards[1], towards[0])];
    let mut best = sized(&at);
    if best.0 <= 0.0 {
        at = [seed.x, seed.y, 0.0, 0.0];
        best = sized(&at);
    }
    let mut step = [lengths[0] * 0.5, lengths[0] * 0.5, 0.4, 0.3];
    for _ in 0..SEARCH_ROUNDS {
        let mut better = false;
        for k in 0..4 {
            for sign in [1.0, -1.0] {
                let mut next = at;
                next[k] += sign * step[k];
                next[2] = next[2].clamp(-3.0, 3.0);
                let found = sized(&next);
                if found.0 > best.0 {
                    (at, best, better) = (next, found, true);
                }
            }
        }
        if !better {
            step = step.map(|s| 0.6 * s);
        }
    }
    let mut cone = best.1;
    if cone.half_axes[1] > cone.half_axes[0] {
        cone.half_axes.swap(0, 1);
        cone.roll += 0.25 * TAU;
    }
    (cone.half_axes[1] > LEAST_HALF_AXIS && best.0 > 0.0).then_some(cone)
}

/// True when caps of clear axes cover the cone: squares over the unit disc are divided into four until a cap holds
/// each.
pub fn covered(cone: &EllipticCone, clear: &dyn Fn(&Vector3<f64>, f64) -> bool) -> bool {
    let mut squares: Vec<(Vector2<f64>, f64)> = vec![(Vector2::zeros(), 1.0)];
    while let Some((middle, half)) = squares.pop() {
        // Point of the square nearest to the centre of the disc.
        let nearest = Vector2::new((middle.x.abs() - half).max(0.0), (middle.y.abs() - half).max(0.0));
        if nearest.norm() >= 1.0 {
            continue;
        }
        let at = cone.from_disc(&middle);
        // The plane at height one lies outside of the unit sphere: angles are smaller than lengths in the plane.
        let cap = half * libm::hypot(cone.half_axes[0], cone.half_axes[1]);
        if cap <= 1.0 && clear(&cone.direction(&at), cap) {
            continue;
        }
        if cap <= LEAST_CAP {
            return false;
        }
        let quarter = 0.5 * half;
        for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            squares.push((middle + Vector2::new(sx, sy) * quarter, quarter));
        }
    }
    true
}
