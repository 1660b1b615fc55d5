//! A blade of a wheel: its two faces, and the faces of its edges.

use super::edge::{SheetEnd, StepBladeEdge};
use super::face::StepFace;
use super::meridian::{StepMeridian, flat};
use super::neighbours::EdgeFaces;
use super::picks::{ListedFace, PickedFaces, missing};
use super::placement::StepGeometry;
use super::sheet::StepSheet;
use crate::found::Found;
use crate::{BladeFace, FaceRole};
use base::source::Span;
use base::units::trim;
use blade::LoopEdges;
use blade::outline::Side;
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use nalgebra::Point3;
use nurbs::angle::nearest_turn;

/// Most faces of an edge.
const MAX_EDGE_FACES: usize = 12;

/// Names of both ends.
pub(super) const ENDS: [&str; 2] = ["inlet", "outlet"];

/// Points of a section round the blade, the first one not repeated, with its edges.
#[derive(Clone, Debug)]
pub(super) struct EdgedLoop {
    pub(super) points: Vec<Point3<f64>>,
    pub(super) edges: LoopEdges,
}

/// A blade. Its sheets go from inlet to outlet and from root to tip.
#[derive(Clone, Debug)]
pub(super) struct StepBlade {
    /// Pressure and suction face.
    pub(super) faces: [StepFace; 2],
    pub(super) sheets: [StepSheet; 2],
    /// Edges at inlet and outlet.
    pub(super) edges: [StepBladeEdge; 2],
    /// A face below its root that is none of the hub, by its place in the list: a fillet, where the file has them.
    pub(super) below: Option<usize>,
}

impl StepBlade {
    /// Side of its pressure face by the angle about Z.
    pub(super) fn pressure_side(&self) -> Side {
        let [pressure, suction] = self.sheets.each_ref().map(|sheet| angle(&sheet.jet(0.5, 0.5).point));
        if nearest_turn(pressure - suction, 0.0) > 0.0 { Side::Greater } else { Side::Smaller }
    }

    /// Angle about Z of the middle of the blade at its outlet, rad.
    pub(super) fn angle(&self) -> f64 {
        angle(&self.sheets[0].jet(1.0, 0.5).point)
    }

    /// Whether its faces meet in a line at an end.
    pub(super) fn has_nose(&self) -> bool {
        self.edges.iter().any(StepBladeEdge::is_nose)
    }

    /// A closed loop round the blade at a height, without the first point again: along the suction face from the outlet, round the
    /// inlet, along the pressure face, round the outlet. It runs straight across an edge that is cut off. With it the leading and the
    /// trailing edge; an edge at which both faces meet is the point in which they do. `shares` are the places on the pressure and on the
    /// suction face, from inlet to outlet.
    pub(super) fn loop_at(&self, t: f64, shares: [&[f64]; 2]) -> EdgedLoop {
        let [mut inlet, outlet] = self.edges.each_ref().map(|edge| edge.rounded_across(t));
        let face = |face: usize| shares[face].iter().map(|s| self.sheets[face].jet(*s, t).point).collect::<Vec<_>>();
        let [pressure, mut points] = [face(0), face(1)];
        inlet.reverse();
        points.reverse();
        let [at_inlet, at_outlet] = self.edges.each_ref().map(StepBladeEdge::is_nose);
        if at_inlet {
            points.pop();
        }
        let inlet_from = points.len() - usize::from(!at_inlet);
        points.extend(inlet);
        let inlet_to = points.len();
        points.extend(pressure);
        if at_outlet {
            points.pop();
        }
        let outlet_from = if at_outlet { 0 } else { points.len() - 1 };
        points.extend(outlet);
        EdgedLoop { points, edges: [[inlet_from, inlet_to], [outlet_from, 0]] }
    }

    /// Shares of the length of a face (0 pressure, 1 suction) at a height: the places of the points of a loop, in steps of at most one in
    /// `most`.
    pub(super) fn shares(&self, face: usize, t: f64, most: usize) -> Vec<f64> {
        let sheet = &self.sheets[face];
        let near = |edge: &[Point3<f64>]| if face == 0 { edge.first().copied() } else { edge.last().copied() };
        // Along a face from its ends, at which the edges have these points.
        let ends = [0, 1].map(|end| {
            let next = near(&self.edges[end].rounded_across(t));
            let at = sheet.jet(end as f64, t).point;
            next.map_or(f64::INFINITY, |next| nalgebra::distance(&at, &next)) / sheet.length(t)
        });
        graded(ends, most)
    }

    /// The meridian of its tips: along the pressure face, and on to the ends of the edges.
    pub(super) fn tip(&self, steps: usize) -> Option<StepMeridian> {
        let along: Vec<_> = self.sheets[0].row(1.0, steps).iter().map(flat).collect();
        let (first, last) = (along.first()?, along.last()?);
        let outward = [first - along.get(1)?, last - along.get(along.len().checked_sub(2)?)?];
        let [before, behind] = [0, 1].map(|end| {
            let mut reached = *[first, last][end];
            let mut points = Vec::new();
            let edge = &self.edges[end];
            // Where both faces meet, the suction face may go on beyond the line in which they do.
            let suction = || {
                let mut row = self.sheets[1].row(1.0, steps);
                if end == 1 {
                    row.reverse();
                }
                row
            };
            let across = if edge.is_nose() { suction() } else { edge.across(1.0) };
            for p in across.iter().map(flat) {
                if (p - reached).dot(&outward[end]) <= 0.0 {
                    break;
                }
                points.push(p);
                reached = p;
            }
            points
        });
        StepMeridian::new(before.into_iter().rev().chain(along.iter().copied()).chain(behind).collect())
    }
}

/// Shares from 0 to 1 in steps of at most one in `most`. Their first and last steps are those that are given, and no step is longer
/// than its neighbour towards an end by more than a third: a spline through points whose distance jumps makes waves.
fn graded(ends: [f64; 2], most: usize) -> Vec<f64> {
    const STEP_GROWTH: f64 = 4.0 / 3.0;
    /// Shortest step: points of an edge may be nearer to each other.
    const MIN_STEP: f64 = 1e-4;
    let longest = 1.0 / most.max(1) as f64;
    let half = |first: f64| {
        let (mut step, mut at) = (first.clamp(MIN_STEP, longest), 0.0);
        let mut places = vec![0.0];
        while at + step < 0.5 {
            at += step;
            places.push(at);
            step = (step * STEP_GROWTH).min(longest);
        }
        places
    };
    let [mut first, last] = ends.map(half);
    // Both halves may meet in a step that is much shorter than its neighbours.
    let gap = 1.0 - last.last().copied().unwrap_or(0.0) - first.last().copied().unwrap_or(0.0);
    if gap < 0.5 * longest && first.len() > 1 {
        first.pop();
    }
    first.into_iter().chain(last.into_iter().rev().map(|s| 1.0 - s)).collect()
}

/// Angle about Z, rad.
fn angle(p: &Point3<f64>) -> f64 {
    libm::atan2(p.y, p.x)
}

/// What blades are read from.
pub(super) struct BladeReader<'a, 't> {
    pub(super) geometry: StepGeometry<'a, 't>,
    pub(super) faces: &'a [ListedFace<'t>],
    pub(super) picked: &'a PickedFaces,
    pub(super) meeting: &'a EdgeFaces,
    /// The hub from inlet to outlet.
    pub(super) hub: &'a StepMeridian,
    /// Angle between neighbouring main blades, rad.
    pub(super) pitch: f64,
    pub(super) end: Span,
}

impl BladeReader<'_, '_> {
    /// A blade of the sector: 0 is the main blade.
    ///
    /// # Errors
    /// A face that is missing, has not four sides, or belongs to another blade.
    pub(super) fn blade(&self, blade: usize, found: &mut Found) -> Result<StepBlade, Diag> {
        let places = [BladeFace::Pressure, BladeFace::Suction].map(|face| {
            let role = FaceRole::OfBlade(blade, face);
            self.picked.only(role, self.faces)?.ok_or_else(|| missing(self.faces, role, self.end))
        });
        let [pressure, suction] = places;
        let places = [pressure?, suction?];
        let [pressure, suction] = places.map(|k| self.geometry.listed(&self.faces[k]));
        let faces = [pressure?, suction?];
        let along = |p: &Point3<f64>| self.hub.nearest(&flat(p))[0];
        let sheets = [self.sheet(&faces[0], along)?, self.sheet(&faces[1], along)?];
        for (sheet, face) in sheets.iter().zip(&faces) {
            let gap = trim(1e3 * sheet.gap, 2);
            found.note(
                face.span,
                format!("#{} `{}`: its edges lie within {gap} um of its surface", face.number, face.name),
            );
        }
        self.of_one_blade(&faces, &sheets)?;
        let edges = [0, 1].map(|end| self.edge(blade, end, places, &sheets));
        let hub = self.picked.of(FaceRole::Hub);
        let below = sheets
            .iter()
            .zip(places)
            .flat_map(|(sheet, own)| self.meeting.at(sheet.root_edges()).into_iter().filter(move |k| *k != own));
        let below = below.filter(|k| !hub.contains(k)).min();
        Ok(StepBlade { faces, sheets, edges, below })
    }

    fn sheet(&self, face: &StepFace, from_start: impl Fn(&Point3<f64>) -> f64) -> Result<StepSheet, Diag> {
        StepSheet::new(face, |p| self.hub.nearest(&flat(p))[1], from_start)
    }

    /// Refuses faces that are farther from each other than half of the way to the next main blade.
    fn of_one_blade(&self, faces: &[StepFace; 2], sheets: &[StepSheet; 2]) -> Result<(), Diag> {
        let [pressure, suction] = sheets.each_ref().map(|sheet| angle(&sheet.jet(0.5, 0.5).point));
        let between = nearest_turn(pressure - suction, 0.0).abs();
        if between < 0.5 * self.pitch {
            return Ok(());
        }
        let [between, pitch] = [between, self.pitch].map(|angle| trim(angle.to_degrees(), 2));
        Err(Diag::error(codes::CONTRADICTS, "the pressure and the suction face belong to different blades")
            .label(faces[1].span, format!("#{} is {between} deg away from the pressure face", faces[1].number))
            .label(faces[0].span, format!("#{} is the pressure face", faces[0].number))
            .note(format!("the main blades are {pitch} deg apart"))
            .help("pick the suction face of the same blade"))
    }

    /// The edge at an end. Its faces lead from the pressure to the suction face: those that are picked, and those that meet their
    /// neighbours in one edge. It has none where such faces do not lead to the suction face, or where both meet.
    fn edge(&self, blade: usize, end: usize, faces: [usize; 2], sheets: &[StepSheet; 2]) -> StepBladeEdge {
        let role = FaceRole::OfBlade(blade, [BladeFace::Inlet, BladeFace::Outlet][end]);
        let mut used = faces.to_vec();
        let mut chain: Vec<StepSheet> = Vec::new();
        while chain.len() < MAX_EDGE_FACES {
            let side = chain.last().map_or(SheetEnd { sheet: &sheets[0], end }, |sheet| SheetEnd { sheet, end: 1 });
            if side.meets(SheetEnd { sheet: &sheets[1], end }) {
                return if chain.is_empty() {
                    StepBladeEdge::of_nose()
                } else {
                    StepBladeEdge::new(chain, sheets, end)
                };
            }
            let start = side.sheet.jet(side.end as f64, 0.0).point;
            let candidates = self.picked.of(role).into_iter().chain(self.meeting.at(side.sheet.edges(side.end)));
            let next = candidates.filter(|k| !used.contains(k)).find_map(|k| {
                let face = self.geometry.listed(&self.faces[k]).ok()?;
                let sheet = self.sheet(&face, |p| nalgebra::distance(p, &start)).ok()?;
                side.meets(SheetEnd { sheet: &sheet, end: 0 }).then_some((k, sheet))
            });
            let Some((k, sheet)) = next else { break };
            used.push(k);
            chain.push(sheet);
        }
        StepBladeEdge::new(Vec::new(), sheets, end)
    }
}
