//! Sections of faces such that ruled or lofted faces through them keep to the faces of the file, with the distance measured.

use super::sheet::StepSheet;
use nalgebra::{Matrix2, Point3, Vector2};
use nurbs::{LoftedSurface, interpolate};

/// Distance that is good enough, mm. Coordinates are written to 0.0000001 mm.
const GOOD_FIT_MM: f64 = 2e-4;

/// Distance up to which a face is taken for ruled, mm.
const RULED: f64 = 1e-3;

/// Spaces between sections and steps along them that are tried, from few to many.
const RULED_STEPS: [usize; 3] = [12, 24, 48];
const LOFTED_STEPS: [[usize; 2]; 5] = [[4, 16], [6, 24], [8, 32], [12, 48], [16, 64]];

/// Degree of the curves of the language.
const DEGREE: usize = 3;

/// Sections of the faces of a blade, on common shares of the height.
#[derive(Clone, Debug)]
pub(super) struct FittedSections {
    /// Sections from the root to the tip: of each, the points of both faces.
    pub(super) rows: Vec<[Vec<Point3<f64>>; 2]>,
    /// Largest distance of points of the faces of the file from the surfaces of the part, mm.
    pub(super) distance: f64,
}

/// Sections for two faces: two where ruled faces are near enough, otherwise as many as lofted faces need. `None` where no surface
/// goes through their points.
pub(super) fn sections(faces: &[StepSheet; 2]) -> Option<FittedSections> {
    let of = |rows: usize, steps: usize| -> Option<FittedSections> {
        let mut made: Vec<Vec<Vec<Point3<f64>>>> = Vec::with_capacity(2);
        let mut distance = 0.0_f64;
        for face in faces {
            let row = |j: usize| face.row(j as f64 / rows as f64, steps);
            let points: Vec<Vec<Point3<f64>>> = (0..=rows).map(row).collect();
            let curves: Option<Vec<_>> = points.iter().map(|p| interpolate(p, DEGREE.min(p.len() - 1)).ok()).collect();
            let lofted = LoftedSurface::through(curves?).ok()?;
            distance = distance.max(off(face, &lofted, [3 * steps + 1, 3 * rows.max(4) + 1]));
            made.push(points);
        }
        let (second, first) = (made.pop()?, made.pop()?);
        Some(FittedSections { rows: first.into_iter().zip(second).map(|(a, b)| [a, b]).collect(), distance })
    };
    let better = |best: Option<FittedSections>, next: Option<FittedSections>| match (best, next) {
        (Some(best), Some(next)) => Some(if next.distance < best.distance { next } else { best }),
        (best, next) => best.or(next),
    };
    let enough = |best: &Option<FittedSections>, due: f64| best.as_ref().is_some_and(|b| b.distance <= due);
    let mut best = None;
    for steps in RULED_STEPS {
        best = better(best, of(1, steps));
        if enough(&best, GOOD_FIT_MM) {
            return best;
        }
    }
    if enough(&best, RULED) {
        return best;
    }
    for [rows, steps] in LOFTED_STEPS {
        best = better(best, of(rows, steps));
        if enough(&best, GOOD_FIT_MM) {
            break;
        }
    }
    best
}

/// Largest distance of places of a face from a surface, mm. Each place is near the one of the surface with its parameters.
fn off(face: &StepSheet, lofted: &LoftedSurface, counts: [usize; 2]) -> f64 {
    let mut most = 0.0_f64;
    for i in 0..=counts[0] {
        for j in 0..=counts[1] {
            let [s, t] = [i as f64 / counts[0] as f64, j as f64 / counts[1] as f64];
            most = most.max(from_surface(&face.jet(s, t).point, lofted, [s, t]));
        }
    }
    most
}

/// Distance of a point from a surface within its borders, mm, searched from a place.
pub(super) fn from_surface(p: &Point3<f64>, lofted: &LoftedSurface, [mut u, mut v]: [f64; 2]) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..8 {
        let d = lofted.derivatives(u, v);
        let way = p - d.point;
        if way.norm() >= least {
            break;
        }
        least = way.norm();
        let normal = Matrix2::new(d.su.norm_squared(), d.su.dot(&d.sv), d.su.dot(&d.sv), d.sv.norm_squared());
        let Some(inverse) = normal.try_inverse() else { break };
        let step = inverse * Vector2::new(way.dot(&d.su), way.dot(&d.sv));
        u = (u + step.x).clamp(0.0, 1.0);
        v = (v + step.y).clamp(0.0, 1.0);
    }
    least
}
