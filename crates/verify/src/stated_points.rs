//! How far the surfaces that are cut lie from the points that the job states.
//!
//! The points are those of the files or lists of the job, as they were read. They are projected to the surfaces of the part, so the
//! distance shows what fitting, extending and turning did, and a curve that was read as another one.

use base::units::Mm;
use ir::{Program, StatedPoints};
use nalgebra::Point3;
use nurbs::chords::from_chords;
use nurbs::proximity::Patch;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use wheel::part::{Blade, FaceSurface, Surface};

/// Points of a vane against its surfaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StatedReport {
    /// Name of the vane or the splitter in the job.
    pub name: String,
    /// Number of points.
    pub points: usize,
    /// Largest distance of a point from faces and edges, mm.
    pub distance: Mm,
    /// The point with this distance, mm.
    pub point: Point3<f64>,
}

/// What the import states of the files that the part was made from. The verifier has no such file, so it measures none of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ImportedReport {
    /// Names of the files.
    pub files: String,
    /// Largest distance between the points of the files and the job, mm, as the import states it.
    pub within: Mm,
}

/// The files of the part, as the job names them.
pub fn imported(program: &Program) -> Option<ImportedReport> {
    let from = program.imported.as_ref()?;
    Some(ImportedReport { files: from.files.clone(), within: Mm(from.within.get()) })
}

/// The largest distance of each vane that the job states by points.
pub fn check(program: &Program) -> Vec<StatedReport> {
    let report = |stated: &StatedPoints| {
        let blade = program.part.blade(stated.blade);
        let far = |p: &Point3<f64>| (distance(blade, p), *p);
        let (distance, point) = stated.points.par_iter().map(far).max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(StatedReport { name: blade.name.clone(), points: stated.points.len(), distance: Mm(distance), point })
    };
    program.stated.iter().filter_map(report).collect()
}

/// Distance of a point from faces and edges. Where the lathe makes an edge, or it is cut off, straight lines between the ends of the
/// faces count as surface.
fn distance(blade: &Blade, p: &Point3<f64>) -> f64 {
    let surfaces = blade.faces.iter().chain(blade.edges.iter().flatten());
    let mut least = surfaces.map(|face| face.surface.closest(p, Patch::WHOLE).distance).fold(f64::INFINITY, f64::min);
    for (u, edge) in [0.0, 1.0].into_iter().zip(&blade.edges) {
        if edge.is_none() {
            least = least.min(from_chords(p, &blade.faces.each_ref().map(|face| on_end(&face.surface, u, p))));
        }
    }
    least
}

/// The point of an end of a face that is nearest to a point.
fn on_end(face: &FaceSurface, u: f64, p: &Point3<f64>) -> Point3<f64> {
    /// Intervals of the face, at whose ends the search begins.
    const INTERVALS: u32 = 64;
    /// Halvings of the interval around the nearest place.
    const HALVINGS: u32 = 40;
    let from = |v: f64| (face.point(u, v) - p).norm_squared();
    let mut step = 1.0 / f64::from(INTERVALS);
    let places = (0..=INTERVALS).map(|k| f64::from(k) * step);
    let mut v = places.min_by(|a, b| from(*a).total_cmp(&from(*b))).unwrap_or(0.0);
    for _ in 0..HALVINGS {
        step *= 0.5;
        let neighbours = [v - step, v, v + step].map(|v| v.clamp(0.0, 1.0));
        v = neighbours.into_iter().min_by(|a, b| from(*a).total_cmp(&from(*b))).unwrap_or(v);
    }
    face.point(u, v)
}
