//! Deviation of a face from a developable surface: the angle between the normals at both ends of each ruling, and the distance of
//! the lines of equal u from the rulings.

use wheel::part::{FaceId, Part, Surface};

/// Twist of one face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist {
    /// Face.
    pub side: FaceId,
    /// Largest angle between the normals at root and tip of a ruling, radians.
    pub largest: f64,
    /// Place of the largest angle, from inlet (0) to outlet (1).
    pub at: f64,
    /// Mean angle over the rulings, radians.
    pub mean: f64,
    /// Length of the shortest and of the longest ruling, mm.
    pub ruling: [f64; 2],
    /// Largest distance of a line of equal u from its chord from root to tip, mm: zero for a ruled face.
    pub bulge: f64,
}

/// Number of intervals between the evaluated rulings.
const RULINGS: usize = 400;

/// Number of intervals along a ruling.
const HEIGHTS: usize = 16;

/// Measures one face.
pub fn measure(part: &Part, side: FaceId) -> Twist {
    let face = &part.face(side).surface;
    let mut twist = Twist { side, largest: 0.0, at: 0.0, mean: 0.0, ruling: [f64::INFINITY, 0.0], bulge: 0.0 };
    for i in 0..=RULINGS {
        let u = i as f64 / RULINGS as f64;
        let angle = face.normal(u, 0.0).angle(&face.normal(u, 1.0));
        if angle > twist.largest {
            (twist.largest, twist.at) = (angle, u);
        }
        // Trapezoidal rule.
        twist.mean += angle * if i == 0 || i == RULINGS { 0.5 } else { 1.0 } / RULINGS as f64;
        let root = face.point(u, 0.0);
        let ruling = face.point(u, 1.0) - root;
        let length = ruling.norm();
        let deviation = |k: usize| ((face.point(u, k as f64 / HEIGHTS as f64) - root).cross(&ruling) / length).norm();
        twist.bulge = (1..HEIGHTS).map(deviation).fold(twist.bulge, f64::max);
        twist.ruling = [twist.ruling[0].min(length), twist.ruling[1].max(length)];
    }
    twist
}
