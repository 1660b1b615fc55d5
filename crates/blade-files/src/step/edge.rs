//! Edges of a blade: the faces between its pressure and its suction face at one end.

use super::face::EDGE_GAP_MM;
use super::meridian::flat;
use super::sheet::StepSheet;
use blade::EdgeForm;
use nalgebra::{Point3, Vector2};

/// Places along a side at which neighbours are compared.
const SIDE_PLACES: usize = 8;

/// The edge of a blade at one end.
#[derive(Clone, Debug)]
pub(super) struct StepBladeEdge {
    /// Its faces in order from the pressure to the suction face, s in this sense; none where the file has none.
    pub(super) sheets: Vec<StepSheet>,
    /// Round, or cut off between two corners. An edge without faces counts as cut off. `None` where the pressure and the suction face
    /// meet in a line: then the edge is a part of both, and the curvature of closed sections shows where it ends.
    pub(super) form: Option<EdgeForm>,
}

/// A sheet at one of its ends along s, 0 or 1.
#[derive(Clone, Copy)]
pub(super) struct SheetEnd<'a> {
    pub(super) sheet: &'a StepSheet,
    pub(super) end: usize,
}

impl SheetEnd<'_> {
    /// Whether another sheet ends in the same line.
    pub(super) fn meets(self, other: SheetEnd<'_>) -> bool {
        let [here, there] = [self, other].map(|side| side.sheet.end(side.end as f64, SIDE_PLACES));
        here.iter().zip(&there).all(|(a, b)| nalgebra::distance(a, b) < EDGE_GAP_MM)
    }
}

impl StepBladeEdge {
    /// The edge at an end of a blade (0 inlet, 1 outlet) with these pressure and suction faces.
    pub(super) fn new(sheets: Vec<StepSheet>, faces: &[StepSheet; 2], end: usize) -> Self {
        let cut = sheets.is_empty() || is_cut_off(&sheets, faces, end);
        Self { sheets, form: Some(if cut { EdgeForm::CutOff } else { EdgeForm::Round }) }
    }

    /// The edge of two faces that meet in a line.
    pub(super) fn of_nose() -> Self {
        Self { sheets: Vec::new(), form: None }
    }

    /// Whether both faces meet in a line.
    pub(super) fn is_nose(&self) -> bool {
        self.form.is_none()
    }

    /// Points across the edge at a height, from the pressure to the suction face, without those where it meets them.
    pub(super) fn across(&self, t: f64) -> Vec<Point3<f64>> {
        /// Steps across the whole edge.
        const EDGE_STEPS: usize = 108;
        let steps = EDGE_STEPS.div_ceil(self.sheets.len().max(1));
        let mut points: Vec<Point3<f64>> =
            self.sheets.iter().flat_map(|sheet| sheet.row(t, steps).into_iter().skip(1)).collect();
        points.pop();
        points
    }

    /// The same of an edge that is round; none of one that is cut off.
    pub(super) fn rounded_across(&self, t: f64) -> Vec<Point3<f64>> {
        if self.form == Some(EdgeForm::Round) { self.across(t) } else { Vec::new() }
    }

    /// Largest distance of the edge and of the ends of both faces from a straight line through two places (r, z), mm.
    pub(super) fn off_line(&self, faces: &[StepSheet; 2], end: usize, [from, to]: [Vector2<f64>; 2]) -> f64 {
        let way = (to - from).try_normalize(0.0).unwrap_or_default();
        let of_faces = faces.iter().flat_map(|face| face.end(end as f64, 8 * SIDE_PLACES));
        let of_edge = self.sheets.iter().flat_map(|sheet| {
            (0..=SIDE_PLACES).flat_map(move |k| sheet.row(k as f64 / SIDE_PLACES as f64, SIDE_PLACES))
        });
        of_faces.chain(of_edge).map(|p| way.perp(&(flat(&p) - from)).abs()).fold(0.0, f64::max)
    }
}

/// Whether an edge is straight between corners with both faces. Decided at half of the height.
fn is_cut_off(sheets: &[StepSheet], faces: &[StepSheet; 2], end: usize) -> bool {
    /// Step of a direction, as a share of a face.
    const DIRECTION_STEP: f64 = 1e-3;
    let (Some(first), Some(last)) = (sheets.first(), sheets.last()) else { return true };
    let way = |sheet: &StepSheet, from: f64, to: f64| sheet.jet(to, 0.5).point - sheet.jet(from, 0.5).point;
    let [at, inside] = if end == 0 { [0.0, DIRECTION_STEP] } else { [1.0, 1.0 - DIRECTION_STEP] };
    let turns = [
        way(&faces[0], inside, at).angle(&way(first, 0.0, DIRECTION_STEP)),
        way(last, 1.0 - DIRECTION_STEP, 1.0).angle(&way(&faces[1], at, inside)),
    ];
    let [from, to] = [first.jet(0.0, 0.5).point, last.jet(1.0, 0.5).point];
    let chord = to - from;
    let off_chord = |p: Point3<f64>| (p - from).cross(&chord).norm() / chord.norm().max(f64::MIN_POSITIVE);
    let highest = sheets.iter().flat_map(|sheet| sheet.row(0.5, SIDE_PLACES)).map(off_chord).fold(0.0, f64::max);
    blade::is_cut_off(turns, highest, chord.norm())
}
