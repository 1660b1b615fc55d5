//! How far the surfaces that are cut lie from the points that the job states.
//!
//! The points are those of the files or lists of the job, as they were read. They are projected to the surfaces of the part, so the
//! distance shows what fitting, extending and turning did, and a curve that was read as another one.

use crate::geom::proximity::Patch;
use crate::ir::{Program, StatedPoints};
use crate::part::{Blade, Surface};
use crate::units::length;
use nalgebra::Point3;
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::Write;

/// Share of the length of a face from its ends within which a point is before an edge that has no surface of its own.
const AT_END: f64 = 1e-6;

/// Points of a vane against its surfaces.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StatedReport {
    /// Name of the vane or the splitter in the job.
    pub name: String,
    /// Number of points.
    pub points: usize,
    /// Largest distance of a point from faces and edges, mm.
    pub distance: f64,
    /// The point with this distance, mm.
    pub point: Point3<f64>,
}

/// The largest distance of each vane that the job states by points.
pub fn check(program: &Program) -> Vec<StatedReport> {
    let report = |stated: &StatedPoints| {
        let blade = program.part.blade(stated.blade);
        let far = |p: &Point3<f64>| (distance(blade, p), *p);
        let (distance, point) = stated.points.par_iter().map(far).max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(StatedReport { name: blade.name.clone(), points: stated.points.len(), distance, point })
    };
    program.stated.iter().filter_map(report).collect()
}

/// Distance of a point from faces and edges. Where the lathe makes an edge, or it is cut off, it lies between the ends of the
/// faces.
fn distance(blade: &Blade, p: &Point3<f64>) -> f64 {
    let on = blade.faces.each_ref().map(|face| face.surface.closest(p, Patch::WHOLE));
    let edges = blade.edges.iter().flatten().map(|edge| edge.surface.closest(p, Patch::WHOLE).distance);
    let mut least = edges.fold(on[0].distance.min(on[1].distance), f64::min);
    for (end, edge) in blade.edges.iter().enumerate() {
        let ends = on.iter().all(|at| (at.u - end as f64).abs() < AT_END);
        if edge.is_none() && ends {
            least = least.min(from_segment(p, on.each_ref().map(|at| at.point)));
        }
    }
    least
}

/// Distance of a point from a line between two points.
fn from_segment(p: &Point3<f64>, [a, b]: [Point3<f64>; 2]) -> f64 {
    let along = b - a;
    let square = along.norm_squared();
    let t = if square > 0.0 { ((p - a).dot(&along) / square).clamp(0.0, 1.0) } else { 0.0 };
    (p - (a + along * t)).norm()
}

/// Writes a line a vane.
pub(super) fn write(reports: &[StatedReport], t: &mut String) -> std::fmt::Result {
    for r in reports {
        let at = r.point.coords.iter().map(|x| format!("{x:.3}")).collect::<Vec<_>>().join(" ");
        writeln!(
            t,
            "  form of {}: its {} stated points lie within {} of the surfaces that are cut; farthest at ({at})",
            r.name,
            r.points,
            length(r.distance)
        )?;
    }
    Ok(())
}
