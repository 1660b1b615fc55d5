//! Spacing of passes from the scallop height.

/// Curvature of the surface, times the radius of the ball, that counts as none.
const ZERO_CURVATURE: f64 = 1e-9;

/// Distance between passes of a ball on a flat surface that leaves ridges of height `h`: 2 sqrt(2 R h - h^2).
pub fn flat_step(radius: f64, h: f64) -> f64 {
    2.0 * (2.0 * radius * h - h * h).max(0.0).sqrt()
}

/// Step of Wei's formula (9), sqrt(2 R h): about half of the exact step for a ball.
pub fn formula_9_step(radius: f64, h: f64) -> f64 {
    (2.0 * radius * h).sqrt()
}

/// Exact distance, along the surface, between passes of a ball of this radius that leave ridges of height `h` on a
/// cylinder. `curvature` is that of the cylinder across the feed, positive where the surface bulges out of the
/// material. Two balls that touch the circle of radius 1/curvature meet at the height h over it.
pub fn curved_step(radius: f64, h: f64, curvature: f64) -> f64 {
    // Below this value the circle and a line differ by less than rounding over the width of a pass.
    if curvature.abs() * radius < ZERO_CURVATURE {
        return flat_step(radius, h);
    }
    let rho = 1.0 / curvature;
    // For a hollow surface rho is negative, and so are all lengths from the centre of curvature.
    let (centre, ridge) = (rho + radius, rho + h);
    // Law of cosines for the quarter angle: avoids the cancellation of an arc cosine near one.
    let quarter = libm::asin(((2.0 * radius * h - h * h) / (4.0 * centre * ridge)).clamp(0.0, 1.0).sqrt());
    4.0 * rho.abs() * quarter
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curved_law_meets_the_flat_one_and_a_measured_ridge() {
        assert!((curved_step(3.0, 0.012, 1e-6) - flat_step(3.0, 0.012)).abs() < 1e-5);
        for rho in [20.0_f64, -20.0] {
            let (radius, h) = (3.0, 0.01);
            let half = curved_step(radius, h, 1.0 / rho) / (2.0 * rho.abs());
            // Ball centre turned by half a step, and the point where the ball cuts the middle line.
            let c = rho + radius;
            let (x, y) = (c * half.sin(), c * half.cos());
            let ridge = y - (radius * radius - x * x).sqrt();
            assert!((ridge - rho - h).abs() < 1e-9, "rho {rho}: {}", ridge - rho);
        }
    }
}
