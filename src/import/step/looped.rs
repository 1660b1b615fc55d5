//! Closed sections of a blade whose edges are surfaces of their own, with the distance of the blade through them from the faces of
//! the file.

use super::blade::StepBlade;
use super::fitted::from_surface;
use super::sheet::StepSheet;
use crate::geom::LoftedSurface;
use crate::sections::loft::{LoftedBlade, loft};
use crate::sections::outline::{DividedSection, Inlet, Known, outline};
use crate::sections::{EdgeForm, LoopEdges, Outline, Section, SectionForm};
use nalgebra::Point3;

/// Distance that is good enough, mm.
const NEAR: f64 = 5e-4;

/// Sections less one, and steps of a section along a face, that are tried, from few to many.
const TRIED: [[usize; 2]; 6] = [[8, 96], [12, 96], [16, 96], [24, 96], [24, 192], [24, 384]];

/// Largest distance of points from the curve of their section, mm: `fit` of the job.
pub(super) const FIT: f64 = 5e-4;

/// Closed sections of a blade.
#[derive(Clone, Debug)]
pub(super) struct LoopedSections {
    /// Points of each section from the root to the tip, with its edges; the first one is not repeated.
    pub(super) loops: Vec<(Vec<Point3<f64>>, LoopEdges)>,
    /// Largest distance of points of the faces of the file from the blade through the sections, mm.
    pub(super) distance: f64,
}

/// Sections of a blade: as many as its surfaces need. `hub` has points (r, z) from inlet to outlet. The error says why there are
/// none.
pub(super) fn sections(blade: &StepBlade, hub: &[[f64; 2]]) -> Result<LoopedSections, String> {
    let mut best: Option<LoopedSections> = None;
    for [rows, steps] in TRIED {
        let loops: Vec<(Vec<Point3<f64>>, LoopEdges)> =
            (0..=rows).map(|j| blade.loop_at(j as f64 / rows as f64, steps)).collect();
        let outlines: Result<Vec<Outline>, String> =
            loops.iter().enumerate().map(|(k, section)| divided(blade, hub, k, section)).collect();
        let made = loft(&outlines?, FIT).map_err(|_| "no surface goes through its sections".to_owned())?;
        let distance = off(blade, &made);
        if best.as_ref().is_none_or(|best| distance < best.distance) {
            best = Some(LoopedSections { loops, distance });
        }
        if distance <= NEAR {
            break;
        }
    }
    best.ok_or_else(|| "it has no sections".to_owned())
}

/// Faces and edges of a section as a job divides it.
fn divided(
    blade: &StepBlade,
    hub: &[[f64; 2]],
    section: usize,
    (points, edges): &(Vec<Point3<f64>>, LoopEdges),
) -> Result<Outline, String> {
    let known = Known { inlet: Inlet::Meridian(hub), pressure: blade.pressure_side() };
    let given = Section { span: None, form: SectionForm::DividedLoop { points: points.clone(), edges: *edges } };
    let fault = |why: &str| format!("section {} from the root: {why}", section + 1);
    let DividedSection { mut outline, edges, .. } =
        outline(&given, &known).map_err(|found| fault(&found.to_string()))?;
    for ((points, found), edge) in outline.edges.iter_mut().zip(edges).zip(&blade.edges) {
        match (found.form, edge.form) {
            (EdgeForm::Sharp, _) => return Err(fault("both faces meet in one point")),
            (EdgeForm::Round, EdgeForm::CutOff) => return Err(fault("an edge that is cut off has no two corners")),
            (EdgeForm::CutOff, EdgeForm::Round) if points.len() < 3 => {
                return Err(fault("an edge that is round is found as cut off"));
            }
            (EdgeForm::CutOff, EdgeForm::CutOff) => {
                *points = points.first().into_iter().chain(points.last()).copied().collect();
            }
            _ => {}
        }
    }
    Ok(outline)
}

/// Largest distance of places of the faces of the file from a blade, mm. Edges that are cut off are not compared.
fn off(blade: &StepBlade, made: &LoftedBlade) -> f64 {
    /// Places along faces, across a face of an edge, and up.
    const ALONG: usize = 97;
    const ACROSS: usize = 11;
    const UP: usize = 35;
    let all: Vec<&LoftedSurface> = made.faces.iter().chain(made.edges.iter().flatten()).collect();
    let mut most = 0.0_f64;
    let mut compare = |sheet: &StepSheet, own: Option<&LoftedSurface>, along: usize| {
        for i in 0..=along {
            for j in 0..=UP {
                let [s, t] = [i as f64 / along as f64, j as f64 / UP as f64];
                let p = sheet.jet(s, t).point;
                let near = own.map_or(f64::INFINITY, |own| from_surface(&p, own, [s, t]));
                // Faces and edges of a section need not end where those of the file do.
                let nearest = || all.iter().map(|surface| anywhere(&p, surface, t)).fold(near, f64::min);
                most = most.max(if near <= most { near } else { nearest() });
            }
        }
    };
    for (sheet, face) in blade.sheets.iter().zip(&made.faces) {
        compare(sheet, Some(face), ALONG);
    }
    for edge in blade.edges.iter().filter(|edge| edge.form == EdgeForm::Round) {
        edge.sheets.iter().for_each(|sheet| compare(sheet, None, ACROSS));
    }
    most
}

/// Distance of a point at a height from a surface, mm.
fn anywhere(p: &Point3<f64>, surface: &LoftedSurface, t: f64) -> f64 {
    /// Places along u at which the search may begin.
    const SEEDS: usize = 24;
    let seeds = (0..=SEEDS).map(|k| k as f64 / SEEDS as f64);
    let far = |u: f64| nalgebra::distance_squared(p, &surface.derivatives(u, t).point);
    let seed = seeds.min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap_or(0.5);
    from_surface(p, surface, [seed, t])
}
