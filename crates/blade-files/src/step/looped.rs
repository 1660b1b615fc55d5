//! Closed sections of a blade whose edges are surfaces of their own, with the distance of the blade through them from the faces of
//! the file.

use super::blade::{ENDS, EdgedLoop, StepBlade};
use super::fitted::from_surface;
use super::nose;
use super::sheet::StepSheet;
use blade::loft::{LoftFault, LoftedBlade, loft};
use blade::outline::{DividedSection, Inlet, Known, outline};
use blade::{EdgeForm, Outline, Section, SectionForm};
use nalgebra::Point3;
use nurbs::LoftedSurface;
use nurbs::chords::from_chords;

/// Distance that is good enough, mm.
const GOOD_FIT_MM: f64 = 5e-4;

/// Sections less one, and steps of a section along a face, that are tried, from few to many.
const TRIED: [[usize; 2]; 6] = [[8, 96], [12, 96], [16, 96], [24, 96], [24, 192], [24, 384]];

/// Largest distance of points from the curve of their section, mm: `fit` of the job.
pub(super) const FIT: f64 = 5e-4;

/// Closed sections of a blade.
#[derive(Clone, Debug)]
pub(super) struct LoopedSections {
    /// Points of each section from the root to the tip, with its edges; the first one is not repeated.
    pub(super) loops: Vec<EdgedLoop>,
    /// Largest distance of points of the faces of the file from the blade through the sections, mm.
    pub(super) distance: f64,
    /// Forms of the leading and of the trailing edge.
    pub(super) forms: [EdgeForm; 2],
}

/// Sections of a blade: as many as its surfaces need. `hub` has points (r, z) from inlet to outlet, `turned` says which ends the
/// lathe makes. The error says why there are none.
pub(super) fn sections(blade: &StepBlade, hub: &[[f64; 2]], turned: [bool; 2]) -> Result<LoopedSections, String> {
    let mut best: Option<LoopedSections> = None;
    for [rows, steps] in TRIED {
        let loops = loops(blade, hub, rows, steps)?;
        let divided: Result<Vec<_>, String> =
            loops.iter().enumerate().map(|(k, section)| divided(blade, hub, k, section)).collect();
        let (outlines, forms): (Vec<Outline>, Vec<[EdgeForm; 2]>) = divided?.into_iter().unzip();
        let made = loft(&outlines, FIT).map_err(|fault| match fault {
            LoftFault::EdgesDiffer { edge, .. } => {
                format!("the {} edge is round in one section and cut off in another", ENDS[edge])
            }
            LoftFault::Points { .. } | LoftFault::Surface(_) => "no surface goes through its sections".to_owned(),
        })?;
        let forms = forms.first().copied().unwrap_or([EdgeForm::CutOff; 2]);
        let distance = off(blade, &made, turned);
        if best.as_ref().is_none_or(|best| distance < best.distance) {
            best = Some(LoopedSections { loops, distance, forms });
        }
        if distance <= GOOD_FIT_MM {
            break;
        }
    }
    best.ok_or_else(|| "it has no sections".to_owned())
}

/// Points of the sections with their edges.
fn loops(blade: &StepBlade, hub: &[[f64; 2]], rows: usize, steps: usize) -> Result<Vec<EdgedLoop>, String> {
    // Where both faces meet, all sections have the same places.
    let common = blade.has_nose().then(|| [0, 1].map(|face| nose::shares(blade, face, steps)));
    let at = |k: usize| {
        let t = k as f64 / rows as f64;
        let Some([pressure, suction]) = &common else {
            let [pressure, suction] = [0, 1].map(|face| blade.shares(face, t, steps));
            return Ok(blade.loop_at(t, [&pressure, &suction]));
        };
        let EdgedLoop { points, edges } = blade.loop_at(t, [pressure, suction]);
        let edges = nose::edges(blade, hub, &points, edges).map_err(|why| of_section(k, &why))?;
        Ok(EdgedLoop { points, edges })
    };
    (0..=rows).map(at).collect()
}

fn of_section(section: usize, why: &str) -> String {
    format!("section {} from the root: {why}", section + 1)
}

/// Faces and edges of a section as a job divides it, and the forms of the edges.
fn divided(
    blade: &StepBlade,
    hub: &[[f64; 2]],
    section: usize,
    given: &EdgedLoop,
) -> Result<(Outline, [EdgeForm; 2]), String> {
    let known = Known { inlet: Inlet::Meridian(hub), pressure: blade.pressure_side() };
    let form = SectionForm::DividedLoop { points: given.points.clone(), edges: given.edges };
    let given = Section { span: None, form };
    let fault = |why: &str| of_section(section, why);
    let DividedSection { mut outline, edges, .. } =
        outline(&given, &known).map_err(|found| fault(&found.to_string()))?;
    for ((points, found), edge) in outline.edges.iter_mut().zip(&edges).zip(&blade.edges) {
        match (found.form, edge.form) {
            (EdgeForm::Sharp, _) => return Err(fault(nose::SHARP)),
            (EdgeForm::Round, Some(EdgeForm::CutOff)) => {
                return Err(fault("an edge that is cut off has no two corners"));
            }
            (EdgeForm::CutOff, Some(EdgeForm::Round)) if points.len() < 3 => {
                return Err(fault("an edge that is round is found as cut off"));
            }
            (EdgeForm::CutOff, Some(EdgeForm::CutOff) | None) => {
                *points = points.first().into_iter().chain(points.last()).copied().collect();
            }
            _ => {}
        }
    }
    Ok((outline, edges.map(|edge| edge.form)))
}

/// Largest distance of places of the faces of the file from a blade, mm. An end that the lathe makes is compared in the meridian
/// plane, and not here.
fn off(blade: &StepBlade, made: &LoftedBlade, turned: [bool; 2]) -> f64 {
    /// Places along faces, across a face of an edge, and up.
    const FACE_PLACES: usize = 97;
    const EDGE_PLACES: usize = 11;
    const UP: usize = 35;
    let all: Vec<&LoftedSurface> = made.faces.iter().chain(made.edges.iter().flatten()).collect();
    let heights: Vec<f64> = (0..=UP).map(|j| j as f64 / UP as f64).collect();
    let starts: Vec<Vec<SearchStarts>> =
        heights.iter().map(|t| all.iter().map(|surface| SearchStarts::new(surface, *t)).collect()).collect();
    let mut most = 0.0_f64;
    let mut compare = |sheet: &StepSheet, own: Option<&LoftedSurface>, along: usize| {
        for i in 0..=along {
            for (t, starts) in heights.iter().zip(&starts) {
                let s = i as f64 / along as f64;
                let p = sheet.jet(s, *t).point;
                let near = own.map_or(f64::INFINITY, |own| from_surface(&p, own, [s, *t]));
                // Faces and edges of a section need not end where those of the file do.
                let nearest = || {
                    let nearby = starts.iter().map(|starts| starts.distance(&p));
                    nearby.chain(across_cuts(blade, made, &p, *t)).fold(near, f64::min)
                };
                most = most.max(if near <= most { near } else { nearest() });
            }
        }
    };
    for (sheet, face) in blade.sheets.iter().zip(&made.faces) {
        compare(sheet, Some(face), FACE_PLACES);
    }
    for edge in blade.edges.iter().filter(|edge| edge.form == Some(EdgeForm::Round)) {
        edge.sheets.iter().for_each(|sheet| compare(sheet, None, EDGE_PLACES));
    }
    let is_cut = |end: usize| blade.edges[end].form == Some(EdgeForm::CutOff) && !turned[end];
    for (end, edge) in blade.edges.iter().enumerate().filter(|(end, _)| is_cut(*end)) {
        let places = edge.sheets.iter().flat_map(|sheet| {
            heights.iter().flat_map(move |t| {
                (0..=EDGE_PLACES).map(move |i| (sheet.jet(i as f64 / EDGE_PLACES as f64, *t).point, *t))
            })
        });
        most = places.map(|(p, t)| across_cut(made, end, &p, t, 1.0 / UP as f64)).fold(most, f64::max);
    }
    most
}

/// Distance of a point from an edge that is cut off, mm: from the straight lines between both faces at the heights beside its own. Beyond
/// root and tip the edge goes on to hub and shroud, which cut it: there the distance is that from its plane.
fn across_cut(made: &LoftedBlade, end: usize, p: &Point3<f64>, mut t: f64, mut step: f64) -> f64 {
    /// Divisions by two of the step.
    const DIVISIONS: usize = 16;
    let ends = |t: f64| made.faces.each_ref().map(|face| face.derivatives(end as f64, t));
    let far = |t: f64| from_chords(p, &ends(t).map(|d| d.point));
    for _ in 0..DIVISIONS {
        let nearby = [t, t - step, t + step].map(|t| t.clamp(0.0, 1.0));
        t = nearby.into_iter().min_by(|a, b| far(*a).total_cmp(&far(*b))).unwrap_or(t);
        step *= 0.5;
    }
    let [a, b] = ends(t);
    let across = (b.point - a.point).normalize();
    let up = a.sv + b.sv;
    let up = (up - across * up.dot(&across)).normalize();
    let beyond = (p - a.point).dot(&up);
    // A step less than the last one is rounding.
    let ends_there = (t <= step && beyond < 0.0) || (t >= 1.0 - step && beyond > 0.0);
    if ends_there { from_chords(&(p - up * beyond), &[a.point, b.point]) } else { far(t) }
}

/// Distances of a point at a height from the straight lines across edges that are cut off, mm, where both faces of the file meet there:
/// the line is a part of them.
fn across_cuts(blade: &StepBlade, made: &LoftedBlade, p: &Point3<f64>, t: f64) -> impl Iterator<Item = f64> {
    let cut = (0..2).filter(|end| blade.edges[*end].is_nose() && made.edges[*end].is_none());
    cut.map(move |end| from_chords(p, &made.faces.each_ref().map(|face| face.derivatives(end as f64, t).point)))
}

/// Places of a surface at a height at which a search for the nearest place may begin.
struct SearchStarts<'a> {
    surface: &'a LoftedSurface,
    t: f64,
    places: Vec<(f64, Point3<f64>)>,
}

impl<'a> SearchStarts<'a> {
    fn new(surface: &'a LoftedSurface, t: f64) -> Self {
        /// Places along u.
        const U_SEEDS: usize = 24;
        let seeds = (0..=U_SEEDS).map(|k| k as f64 / U_SEEDS as f64);
        Self { surface, t, places: seeds.map(|u| (u, surface.derivatives(u, t).point)).collect() }
    }

    /// Distance of a point from the surface, mm.
    fn distance(&self, p: &Point3<f64>) -> f64 {
        let far = |place: &Point3<f64>| nalgebra::distance_squared(p, place);
        let seed = self.places.iter().min_by(|a, b| far(&a.1).total_cmp(&far(&b.1))).map_or(0.5, |(u, _)| *u);
        from_surface(p, self.surface, [seed, self.t])
    }
}
