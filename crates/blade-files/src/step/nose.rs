//! Edges where the pressure and the suction face meet in a line, as in lofts through closed sections: no face is an edge there. Sections
//! are closed loops through that line, and their curvature tells which points are the edge, as for tables of points.

use super::blade::StepBlade;
use super::sheet::StepSheet;
use blade::outline::{Inlet, Known, outline};
use blade::{CORNER_TURN, EdgeForm, LoopEdges, Section, SectionForm};
use nalgebra::Point3;

/// Why a nose has no edge.
pub(super) const SHARP: &str = "both faces meet in one point: the edge has no thickness";

/// Turn of a row from one step to the next, rad: 4 deg. A round edge has some 40 points.
const ROW_TURN: f64 = 0.07;

/// Shortest step, as a share of a face.
const MIN_STEP: f64 = 1e-5;

/// Growth of the steps along a face, as a share of the way: a step is longer than the one before by a quarter at most.
const STEP_GROWTH: f64 = 0.25;

/// Heights at which a face is sampled.
const HEIGHTS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Shares of the length of a face (0 pressure, 1 suction) from 0 to 1, which hold for all heights: short steps where the face is curved,
/// elsewhere at most one in `most`.
pub(super) fn shares(blade: &StepBlade, face: usize, most: usize) -> Vec<f64> {
    let longest = 1.0 / most.max(1) as f64;
    // Places with the longest step there.
    let mut limits: Vec<[f64; 2]> = Vec::new();
    for t in HEIGHTS {
        curved(&blade.sheets[face], t, longest, &mut limits);
        // An edge with faces of its own has the distances of its points.
        let given = blade.shares(face, t, most);
        limits.extend(given.windows(2).map(|w| [0.5 * (w[0] + w[1]), w[1] - w[0]]));
    }
    let step = |s: f64| limits.iter().map(|[at, step]| step + STEP_GROWTH * (s - at).abs()).fold(longest, f64::min);
    let mut shares = vec![0.0];
    let mut at = 0.0;
    while at < 1.0 {
        at += step(at).max(MIN_STEP);
        shares.push(at);
    }
    shares.iter().map(|s| s / at).collect()
}

/// Halves a row until no step turns or is longer than it may; adds the middles of the steps and their lengths.
fn curved(sheet: &StepSheet, t: f64, longest: f64, limits: &mut Vec<[f64; 2]>) {
    let at = |s: f64| sheet.jet(s, t).point;
    let mut open = vec![[0.0, 1.0]];
    while let Some([from, to]) = open.pop() {
        let middle = 0.5 * (from + to);
        let [a, b, c] = [from, middle, to].map(at);
        let turns = (b - a).angle(&(c - b)) > ROW_TURN && to - from > MIN_STEP;
        if turns || to - from > longest {
            open.extend([[from, middle], [middle, to]]);
        } else {
            limits.push([middle, to - from]);
        }
    }
}

/// Turn of a loop at a point, rad.
fn turn(points: &[Point3<f64>], k: usize) -> f64 {
    let count = points.len();
    let [before, at, next] = [k + count - 1, k, k + 1].map(|k| points[k % count]);
    (at - before).angle(&(next - at))
}

/// The edges of a loop of a blade, found by curvature where both faces meet; `known` has the others.
///
/// # Errors
/// Words for a loop without two edges.
pub(super) fn edges(
    blade: &StepBlade,
    hub: &[[f64; 2]],
    points: &[Point3<f64>],
    known: LoopEdges,
) -> Result<LoopEdges, String> {
    let section = Section { span: None, form: SectionForm::Loop(points.to_vec()) };
    let sides = Known { inlet: Inlet::Meridian(hub), pressure: blade.pressure_side() };
    let found = outline(&section, &sides).map_err(|fault| fault.to_string())?;
    let mut edges = known;
    for (end, edge) in edges.iter_mut().enumerate().filter(|(end, _)| blade.edges[*end].is_nose()) {
        // A corner where both faces meet may be one of two corners of an edge that is cut off. Alone it is a sharp edge.
        let form = found.edges[end].form;
        if form == EdgeForm::Sharp || (form == EdgeForm::Round && turn(points, edge[1]) >= CORNER_TURN) {
            return Err(SHARP.to_owned());
        }
        let line = &found.outline.edges[end];
        let index = |p: Option<&Point3<f64>>| points.iter().position(|q| Some(q) == p);
        let ends = index(line.first()).zip(index(line.last()));
        let (pressure, suction) = ends.ok_or_else(|| "an edge is none of its points".to_owned())?;
        // The loop comes to the inlet from the suction face, and to the outlet from the pressure face.
        *edge = if end == 0 { [suction, pressure] } else { [pressure, suction] };
    }
    Ok(edges)
}
