//! The meridian of turned faces: by their surfaces where these are turned about Z, otherwise by the chains of their edges.

use super::face::{StepFace, smooth_chains};
use super::meridian::{StepMeridian, flat};
use super::turned_surface;
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use nalgebra::{Point3, Vector2};

/// Largest distance of a surface of revolution from its meridian, mm.
pub(super) const REVOLVED: f64 = 0.02;

/// The meridian of faces of a surface of revolution.
pub(super) struct TurnedMeridian {
    pub(super) line: StepMeridian,
    /// Largest distance of the borders of the faces from it, mm: zero for exact surfaces.
    pub(super) spread: f64,
}

/// The meridian of faces of a surface of revolution about Z.
pub(super) fn meridian(faces: &[StepFace]) -> Result<TurnedMeridian, Diag> {
    let mut lines: Vec<StepMeridian> = faces.iter().filter_map(of_face).collect();
    lines.sort_by(|a, b| b.length().total_cmp(&a.length()));
    let mut rest = lines.into_iter();
    let Some(mut line) = rest.next() else { return Err(no_meridian(faces)) };
    let mut rest: Vec<StepMeridian> = rest.collect();
    // Faces behind each other, and faces of which one goes beyond the other.
    while let Some((k, longer)) = rest.iter().enumerate().find_map(|(k, other)| Some((k, line.continued(other)?))) {
        line = longer;
        rest.swap_remove(k);
    }
    let spread = faces.iter().map(|face| spread(&line, face)).fold(0.0, f64::max);
    Ok(TurnedMeridian { line, spread })
}

/// Largest distance of all points of the borders of faces from a meridian, mm.
pub(super) fn distance(line: &StepMeridian, faces: &[StepFace]) -> f64 {
    let edges = faces.iter().flat_map(|face| face.borders.iter().flatten());
    edges.flat_map(|edge| &edge.points).map(|p| line.nearest(&flat(p))[1]).fold(0.0, f64::max)
}

/// The meridian of one face. A spline has it by its edges, which are exact where it is trimmed; by the surface where no chain of
/// edges runs from one end of the face to the other.
fn of_face(face: &StepFace) -> Option<StepMeridian> {
    if let Some(line) = turned_surface::exact(face) {
        return Some(line);
    }
    let chain = longest_chain(face).map(|line| (spread(&line, face), line));
    if let Some((spread, line)) = &chain
        && *spread <= REVOLVED
    {
        return Some(line.clone());
    }
    let traced = turned_surface::traced(face).map(|line| (spread(&line, face), line));
    let all = chain.into_iter().chain(traced);
    all.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, line)| line)
}

/// Largest distance of the borders of a face from a meridian, mm.
fn spread(line: &StepMeridian, face: &StepFace) -> f64 {
    /// Of the points of borders, one in so many is checked.
    const CHECKED: usize = 16;
    let checked = face.borders.iter().flatten().flat_map(|edge| edge.points.iter().step_by(CHECKED));
    checked.map(|p| line.nearest(&flat(p))[1]).fold(0.0, f64::max)
}

/// The longest part of a chain of edges that does not fold back.
fn longest_chain(face: &StepFace) -> Option<StepMeridian> {
    let chains = face.borders.iter().flat_map(smooth_chains);
    let lines = chains.flat_map(|chain| without_folds(&chain.points)).filter_map(StepMeridian::new);
    lines.max_by(|a, b| a.length().total_cmp(&b.length()))
}

/// Parts of a chain of edges in the meridian plane between the places where it turns back. The foot of a blade runs to an edge of the
/// blade and back; a meridian does not.
fn without_folds(points: &[Point3<f64>]) -> Vec<Vec<Vector2<f64>>> {
    /// A way of this length has a direction, mm: below it, rings and splines are not exact.
    const MIN_WAY_MM: f64 = 0.01;
    let mut parts: Vec<Vec<Vector2<f64>>> = vec![Vec::new()];
    let (mut kept, mut way): (Option<Vector2<f64>>, Option<Vector2<f64>>) = (None, None);
    for p in points.iter().map(flat) {
        let last = *kept.get_or_insert(p);
        let step = p - last;
        if step.norm() >= MIN_WAY_MM {
            if way.is_some_and(|way| way.dot(&step) < 0.0) {
                parts.push(vec![last]);
            }
            (kept, way) = (Some(p), Some(step));
        }
        if let Some(part) = parts.last_mut() {
            part.push(p);
        }
    }
    parts
}

fn no_meridian(faces: &[StepFace]) -> Diag {
    let mut diag = Diag::error(codes::NOT_READ, "the faces have no meridian")
        .help("pick faces of the hub that are surfaces of revolution with edges from inlet to outlet");
    if let Some(face) = faces.first() {
        diag = diag.label(face.span, format!("#{}", face.number));
    }
    diag
}
