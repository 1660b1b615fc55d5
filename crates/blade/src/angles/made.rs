//! The surfaces of a blade through enough of its sections.

use super::blade::{AngleBlade, SectionFault};
use crate::Outline;
use crate::loft::{LoftFault, LoftedBlade, loft};
use crate::outline::Side;
use nalgebra::Point3;
use nurbs::proximity::Patch;
use rayon::prelude::*;

/// Intervals between the sections of a blade: as many as its surfaces need between them.
const INTERVALS: [usize; 3] = [8, 16, 32];

/// Every so many points of a section between the others are compared with the surfaces.
const COMPARED_STRIDE: usize = 8;

/// Why a blade has no surfaces.
#[derive(Clone, Debug, PartialEq)]
pub enum MadeFault {
    /// A section cannot be made.
    Section(SectionFault),
    /// No surface goes through the sections.
    Loft(LoftFault),
}

/// Largest distance of a stated point to the surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceResidual {
    /// The distance, mm.
    pub distance: f64,
    /// Share of the span.
    pub span: f64,
    /// The point.
    pub at: Point3<f64>,
    /// Number of sections.
    pub sections: usize,
}

/// Surfaces through 9, 17 or 33 sections at even shares of the span: the first number with which the points of all sections,
/// and points of those in the middle between them, lie within a tolerance, mm; else the largest number.
///
/// # Errors
/// [`MadeFault`].
pub fn made(
    blade: &AngleBlade<'_>,
    pressure: Side,
    tolerance: f64,
) -> Result<(LoftedBlade, SurfaceResidual), MadeFault> {
    let mut best: Option<(LoftedBlade, SurfaceResidual)> = None;
    for intervals in INTERVALS {
        let at = |k: f64| blade.section(k / intervals as f64, pressure).map_err(MadeFault::Section);
        let sections: Vec<Result<Outline, _>> = (0..=intervals).into_par_iter().map(|k| at(k as f64)).collect();
        let sections: Vec<Outline> = sections.into_iter().collect::<Result<_, _>>()?;
        let lofted = loft(&sections, tolerance).map_err(MadeFault::Loft)?;
        let on = lofted.residual;
        let mut residual = SurfaceResidual {
            distance: on.distance,
            span: on.section as f64 / intervals as f64,
            at: on.at,
            sections: intervals + 1,
        };
        let compared = |k: usize| {
            let between = at(k as f64 + 0.5)?;
            let (distance, p) = farthest(&lofted, &between);
            Ok(SurfaceResidual { distance, span: between.span.unwrap_or(0.0), at: p, sections: intervals + 1 })
        };
        let between: Vec<Result<SurfaceResidual, MadeFault>> = (0..intervals).into_par_iter().map(compared).collect();
        for found in between {
            let found = found?;
            if found.distance > residual.distance {
                residual = found;
            }
        }
        // More sections do not help where the points of one section are missed, nor where the error is too large: it falls by a
        // factor of 16 from one number of sections to the next, as that of cubic splines does.
        let far = residual.distance > 1000.0 * tolerance;
        let done = residual.distance <= tolerance || on.distance > tolerance || far;
        if best.as_ref().is_none_or(|(_, b)| residual.distance < b.distance) {
            best = Some((lofted, residual));
        }
        if done {
            break;
        }
    }
    best.ok_or(MadeFault::Loft(LoftFault::Points { section: 0 }))
}

/// The point of a section farthest from the surfaces, and its distance.
fn farthest(lofted: &LoftedBlade, section: &Outline) -> (f64, Point3<f64>) {
    let pieces = [
        (Some(&lofted.faces[0]), &section.faces[0]),
        (Some(&lofted.faces[1]), &section.faces[1]),
        (lofted.edges[0].as_ref(), &section.edges[0]),
        (lofted.edges[1].as_ref(), &section.edges[1]),
    ];
    let whole = Patch { u: [0.0, 1.0], v: [0.0, 1.0] };
    let mut worst = (0.0, Point3::origin());
    // Points at the joints of two pieces are nearest to either.
    let surfaces = || pieces.iter().filter_map(|(surface, _)| *surface);
    for (own, points) in pieces {
        for (k, p) in points.iter().enumerate().filter(|(k, _)| k % COMPARED_STRIDE == 0) {
            let Some(own) = own else { continue };
            let mut distance = own.closest(p, whole).distance;
            if k == 0 || k + 1 == points.len() {
                distance = surfaces().map(|s| s.closest(p, whole).distance).fold(distance, f64::min);
            }
            if distance > worst.0 {
                worst = (distance, *p);
            }
        }
    }
    worst
}
